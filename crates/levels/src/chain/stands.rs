//! The plants of a file, each made lighter by itself: one of several is as light as it would be alone.

use std::cell::RefCell;
use std::sync::Arc;

use secateur_eval::DifferenceJudge;
use secateur_gltf::WholeTree;
use secateur_model::{Foliage, LeafId, Lod};
use secateur_raster::OpenEngine;
use secateur_simplify::whole::{Budget, Sharing, WholeLevel, WholePlant};
use secateur_simplify::{Error, FinerLevel, Observer, Options, Shared};

/// A plant of a file.
struct Stand<'a> {
    plant: WholePlant<'a>,
    /// Which of the file's leaves, and which pieces of its wood, it has; nothing where it has all.
    names: Option<[Vec<LeafId>; 2]>,
    /// What its levels share.
    shared: RefCell<Shared>,
    /// The level in which the next ones are nested.
    finer: RefCell<Option<Arc<FinerLevel>>>,
}

/// The plants of a file.
pub(super) struct Stands<'a> {
    stands: Vec<Stand<'a>>,
    triangles: usize,
    /// How many leaves, and pieces of wood, the file has.
    counts: [usize; 2],
}

impl<'a> Stands<'a> {
    /// The plants that a judge tells apart, if each has leaves and wood of its own; else all as one. `shared` makes what
    /// the levels of one share.
    pub(super) fn of(
        tree: &'a WholeTree,
        judge: &DifferenceJudge,
        options: &Options,
        engine: &OpenEngine,
        shared: fn() -> Shared,
    ) -> Result<Self, Error> {
        let all = [tree.leaves(), tree.wood()];
        let counts = all.map(|foliage| foliage.leaves().len());
        let triangles = all.iter().map(|foliage| foliage.triangles().len()).sum();
        let apart = match judge.plant_count() {
            1 => Vec::new(),
            count => (0..count)
                .map(|k| all.map(|f| standing_at(f, judge, k)))
                .collect(),
        };
        let has_all = |names: &[Vec<LeafId>; 2]| names.iter().all(|names| !names.is_empty());
        let stands = match !apart.is_empty() && apart.iter().all(has_all) {
            true => {
                let stand = |names: [Vec<LeafId>; 2]| {
                    let [leaves, wood] = [0, 1].map(|k| all[k].only(&names[k]));
                    let items = leaves.followed_by(&wood)?;
                    Ok(Stand {
                        plant: WholePlant::within(&items, leaves, wood, options, engine)?,
                        names: Some(names),
                        shared: RefCell::new(shared()),
                        finer: RefCell::default(),
                    })
                };
                apart.into_iter().map(stand).collect::<Result<_, Error>>()?
            }
            false => {
                let [leaves, wood] = all;
                let items = tree.items().foliage();
                vec![Stand {
                    plant: WholePlant::within(items, leaves, wood, options, engine)?,
                    names: None,
                    shared: RefCell::new(shared()),
                    finer: RefCell::default(),
                }]
            }
        };
        Ok(Self {
            stands,
            triangles,
            counts,
        })
    }

    /// A level of each plant, all with the same share of their triangles.
    pub(super) fn level(
        &self,
        budget: Budget,
        options: &Options,
        engine: &OpenEngine,
        observer: &mut Observer<'_>,
    ) -> Result<Vec<WholeLevel>, Error> {
        let mut levels = Vec::with_capacity(self.stands.len());
        let (mut before, mut given) = (0, 0);
        for stand in &self.stands {
            // Shares are rounded so that they come to the whole.
            before += stand.plant.triangle_count();
            let until = (budget.triangles as u128 * before as u128 / self.triangles.max(1) as u128)
                as usize;
            let shared = &mut *stand.shared.borrow_mut();
            let own = Budget {
                triangles: until - given,
                ..budget
            };
            let options = &Options {
                finer: stand.finer.borrow().clone(),
                ..options.clone()
            };
            let level = stand
                .plant
                .level(own, options, engine, Some(shared), observer)?;
            given = until;
            levels.push(level);
        }
        Ok(levels)
    }

    /// [`WholePlant::sharings`] of the plant that has the most.
    pub(super) fn sharings(&self, of_leaves_and_wood: &[Sharing]) -> Vec<Sharing> {
        let all = self.stands.iter();
        let sharings = all.map(|stand| stand.plant.sharings(of_leaves_and_wood));
        sharings.max_by_key(Vec::len).unwrap_or_default()
    }

    /// From now on levels are nested in these of each plant; in none where there is nothing.
    pub(super) fn nest_in(&self, levels: Option<&[WholeLevel]>) {
        for (k, stand) in self.stands.iter().enumerate() {
            let finer = levels.map(|levels| FinerLevel::of(&levels[k], stand.plant.leaves()));
            stand.finer.replace(finer.map(Arc::new));
            stand.shared.borrow_mut().forget_orders();
        }
    }

    /// The leaves, and the wood, of levels of each plant as those of the whole file.
    pub(super) fn joined(&self, levels: &[WholeLevel]) -> [Lod; 2] {
        if let [only] = levels {
            return [only.leaves.lod.clone(), only.wood.clone()];
        }
        let of = |which: usize| {
            let part = |(stand, level): (&'_ Stand<'a>, &'_ WholeLevel)| {
                let lod = [&level.leaves.lod, &level.wood][which].clone();
                let names = stand.names.as_ref().map(|names| names[which].clone());
                (lod, names.unwrap_or_default())
            };
            let parts: Vec<(Lod, Vec<LeafId>)> = self.stands.iter().zip(levels).map(part).collect();
            let parts: Vec<(&Lod, &[LeafId])> =
                parts.iter().map(|(lod, names)| (lod, &names[..])).collect();
            Lod::of_parts(self.counts[which], &parts)
        };
        [of(0), of(1)]
    }
}

/// The leaves of a plant of a judge, by their middles.
fn standing_at(foliage: &Foliage, judge: &DifferenceJudge, plant: usize) -> Vec<LeafId> {
    let ids = (0..foliage.leaves().len()).map(LeafId::from_index);
    ids.filter(|id| judge.plant_at(foliage.leaf(*id).centre()) == plant)
        .collect()
}

#[cfg(test)]
mod tests {
    use std::ops::ControlFlow;

    use glam::DVec3;
    use secateur_gltf::{Detail, Document, plant_to_glb};
    use secateur_model::{Plant, Surface};
    use secateur_plant::{GrowOptions, Species, grow};
    use secateur_simplify::{Preset, Target};

    use super::*;

    fn oak() -> Plant {
        let options = GrowOptions {
            leaves: 40,
            seed: 5,
        };
        let mut oak = grow(Species::Oak, &options).unwrap();
        (oak.skeleton, oak.holds) = (None, None);
        for surface in [&mut oak.wood, &mut oak.leaves] {
            surface.holds = Vec::new();
        }
        oak
    }

    /// A plant, and 40 m from it a quarter as large.
    fn beside_a_small_one(mut plant: Plant) -> Plant {
        let double = |surface: &mut Surface| {
            let count = surface.positions.len();
            let beside: Vec<DVec3> = surface
                .positions
                .iter()
                .map(|p| 0.25 * *p + 40.0 * DVec3::X)
                .collect();
            surface.positions.extend(beside);
            surface.normals.extend_from_within(..);
            surface.uvs.extend_from_within(..);
            surface.colors.extend_from_within(..);
            let triangles: Vec<[u32; 3]> = surface
                .triangles
                .iter()
                .map(|corners| corners.map(|corner| corner + count as u32))
                .collect();
            surface.triangles.extend(triangles);
        };
        double(&mut plant.wood);
        double(&mut plant.leaves);
        plant.triangles_per_leaf.extend_from_within(..);
        plant
    }

    /// How many triangles of leaves and of wood a level of this many has in the plant at the origin, and beyond it.
    fn level(plant: &Plant, triangles: usize) -> [[usize; 2]; 2] {
        let document = Document::from_bytes("oak.glb", plant_to_glb(plant), None).unwrap();
        let tree = document.into_whole_tree(&[]).unwrap();
        let drawn = tree.items().drawn(Detail::Color).unwrap();
        let is_wood: Vec<bool> = drawn.iter().map(|drawn| !drawn.is_foliage).collect();
        let surfaces = drawn.into_iter().map(|drawn| drawn.surface).collect();
        let judge = DifferenceJudge::new(surfaces, &is_wood);
        let options = Options {
            audit: false,
            ..Options::with_preset(Preset::Look, Target::triangle_share(1.0))
        };
        let engine = OpenEngine::cpu();
        let stands = Stands::of(&tree, &judge, &options, &engine, Shared::default).unwrap();
        let mut go_on = |_| ControlFlow::Continue(());
        let levels = stands
            .level(triangles.into(), &options, &engine, &mut go_on)
            .unwrap();
        let lods = stands.joined(&levels);
        let left = [lods[0].foliage(tree.leaves()), lods[1].foliage(tree.wood())];
        [false, true].map(|is_beyond| {
            left.each_ref().map(|foliage| {
                let triangles = foliage.triangles().iter();
                let there = triangles.filter(|t| (t.corners[0].x > 20.0) == is_beyond);
                there.count()
            })
        })
    }

    /// Made lighter together, the small one would go first.
    #[test]
    fn of_two_plants_each_is_made_as_light_as_alone() {
        let oak = oak();
        let [one, none] = level(&oak, 900);
        assert!(one[0] > 0 && one[1] > 0 && one[0] + one[1] <= 900);
        assert_eq!(none, [0, 0]);
        assert_eq!(level(&beside_a_small_one(oak), 1_800), [one; 2]);
    }
}
