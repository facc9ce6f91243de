//! Alpha cutoffs with which clients show as much of a level as there is.
//!
//! Mip maps mix what a texture shows with the nothing around it, so that masks of leaves fade, or
//! close, where the screen shows them small. The alpha of most leaf textures is near 0 or near 1: near
//! by it hardly matters which cutoff between them is asked for, and from afar it decides how much is
//! left. Where a texture's mip maps all have nearly the same alpha, a cutoff shows all of them or
//! nothing. Such textures are read without mip maps: then each pixel shows what is at its middle, and
//! all together as much as there is.

mod range;
mod specks;

use std::collections::BTreeMap;
use std::sync::Arc;

use secateur_eval::{MipMaps, Outlines, Strengths};
use secateur_gltf::{Cutoffs, Detail, DrawnSurface, GltfError, Tree};
use secateur_model::{AlphaMode, Lod, Material, Mips, Surface};
use secateur_raster::ViewSet;

use self::range::range;
use self::specks::DrawnOriginal;

/// Width of the largest pictures that are looked at, in pixels; the crown takes a little more than
/// half of it.
const WIDTH_PX: u32 = 512;

/// The pictures are this many times smaller.
const STEPS: [u32; 3] = [1, 2, 4];

/// Corners of a cube that make a tetrahedron: views from four sides.
const SIDES: [usize; 4] = [0, 3, 5, 6];

/// Coverage that is no farther off than this at any size is left as it is.
const NEAR_ENOUGH: f64 = 0.03;

/// Mip maps are left out, if they may be, where with the best cutoffs coverage is farther off than
/// this at some size.
const FAR_OFF: f64 = 0.08;

/// How many cutoffs are tried between one and its double.
const TRIES_PER_OCTAVE: f32 = 8.0;

/// How many specks a view a level may show beyond those that there truly are, if it did not before.
const MOST_MORE_SPECKS: f64 = 2.0;

/// What may be done to materials.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MaterialChange {
    /// They may have other cutoffs.
    Cutoffs,
    /// They may have other cutoffs, or be read without mip maps.
    CutoffsOrMips,
}

/// Cutoffs that were chosen, and what they do.
#[derive(Clone, Debug, PartialEq)]
pub struct ChosenCutoffs {
    /// Those that differ from what the level has without.
    pub cutoffs: Cutoffs,
    /// By what all cutoffs were multiplied.
    pub times: f64,
    /// Width and height of pictures in pixels, and in them the pixels that a client shows over those
    /// that the original truly covers: without and with these cutoffs.
    pub coverage: Vec<(u32, [f64; 2])>,
}

/// Chooses the cutoffs of a level of a tree, and whether its mip maps are read; none where nothing needs
/// another, and of the tree as it is, from which nothing is gone.
///
/// # Errors
/// [`GltfError`] if the tree or the level can't be drawn.
pub fn choose_cutoffs(
    tree: &Tree,
    lod: &Lod,
    change: MaterialChange,
) -> Result<Option<ChosenCutoffs>, GltfError> {
    if *lod == Lod::original(tree.foliage().leaves().len()) {
        return Ok(None);
    }
    let free = tree.cut_out_materials();
    let Some(sphere) = tree
        .foliage()
        .bounding_sphere()
        .filter(|_| !free.is_empty())
    else {
        return Ok(None);
    };
    let level = tree.lod_document(lod)?.drawn_as_one(Detail::Color)?;
    let is_free = |drawn: &DrawnSurface| drawn.material.is_some_and(|m| free.contains(&m));
    let ratios = range(level.iter().filter(|drawn| is_free(drawn)));
    let Some(ratios) = ratios else {
        return Ok(None);
    };
    let all = ViewSet::cube(sphere);
    let views = ViewSet::new(SIDES.map(|side| all.views()[side]).into());
    let original = tree.document().drawn_as_one(Detail::Color)?;
    let original: Vec<&Surface> = original.iter().map(|drawn| &drawn.surface).collect();
    let truth = Outlines::of_truth(&original, &views, WIDTH_PX);
    let sizes = |level: &[DrawnSurface], enough: f32| {
        let surfaces: Vec<&Surface> = level.iter().map(|drawn| &drawn.surface).collect();
        let known = MipMaps::of_cut_outs(&surfaces);
        STEPS.map(|step| {
            let width_px = WIDTH_PX / step;
            let is_free = |surface: usize| is_free(&level[surface]);
            Size {
                width_px,
                truth: truth.every(step),
                level: Strengths::new(&surfaces, is_free, &views, width_px, enough, &known),
            }
        })
    };
    let with_mips = sizes(&level, ratios[1]);
    let best_with_mips = best(&with_mips, ratios);
    let chosen = |cutoffs, times: f32, after: &dyn Fn(usize) -> f64| ChosenCutoffs {
        cutoffs,
        times: times.into(),
        coverage: (with_mips.iter().enumerate())
            .map(|(k, size)| (size.width_px, [size.coverage(1.0), after(k)]))
            .collect(),
    };
    let cutoffs = |times: Option<f32>| {
        let cutoff = |drawn: &DrawnSurface| match drawn.surface.material.alpha_mode {
            AlphaMode::Mask(cutoff) if is_free(drawn) => {
                Some((drawn.material?, f64::from(cutoff * times?)))
            }
            _ => None,
        };
        Cutoffs::new(level.iter().filter_map(cutoff))
    };
    let times_with_mips = best_with_mips.unwrap_or(1.0);
    let off = farthest_off(&with_mips, times_with_mips);
    if change == MaterialChange::CutoffsOrMips && off > FAR_OFF {
        let (level, changed) = without_mips(&level, is_free);
        let without = sizes(&level, ratios[1]);
        // Some clients make mip maps whatever a file says: the cutoffs that are best with them stay where
        // they do no harm.
        let best = match farthest_off(&without, times_with_mips) <= FAR_OFF {
            true => best_with_mips,
            false => best(&without, ratios),
        };
        let now = best.unwrap_or(1.0);
        let tolerable = |size: &Size| specks::is_tolerable(size.coverage(times_with_mips));
        let original = DrawnOriginal::new(&original, &views, with_mips.iter().all(tolerable));
        let has_more_specks = |(with, without): (&Size, &Size)| {
            let before = with.level.shown(times_with_mips).specks_per_view();
            let after = without.level.shown(now).specks_per_view();
            after > before && after > original.most_specks(&with.truth, with.width_px)
        };
        let is_better = farthest_off(&without, now) < off
            && !with_mips.iter().zip(&without).any(has_more_specks);
        if is_better {
            let cutoffs = cutoffs(best).without_mips(changed);
            return Ok(Some(chosen(cutoffs, now, &|k| without[k].coverage(now))));
        }
    }
    Ok(best_with_mips.map(|times| {
        let after = |k: usize| with_mips[k].coverage(times);
        chosen(cutoffs(Some(times)), times, &after)
    }))
}

/// By how much coverage is off at the size where it is farthest off, with cutoffs `times` as high.
fn farthest_off(sizes: &[Size], times: f32) -> f64 {
    let off = |size: &Size| (size.coverage(times) - 1.0).abs();
    sizes.iter().map(off).fold(0.0, f64::max)
}

/// The same surfaces, but those that are free are read without mip maps; and the numbers of their
/// materials.
fn without_mips(
    level: &[DrawnSurface],
    is_free: impl Fn(&DrawnSurface) -> bool,
) -> (Vec<DrawnSurface>, Vec<usize>) {
    let mut level = level.to_vec();
    let mut changed: BTreeMap<usize, Arc<Material>> = BTreeMap::new();
    for drawn in &mut level {
        let Some(number) = drawn.material.filter(|_| is_free(drawn)) else {
            continue;
        };
        let material = &mut drawn.surface.material;
        let without = changed.entry(number).or_insert_with(|| {
            let mut without = Material::clone(material);
            if let Some(texture) = &mut without.texture {
                Arc::make_mut(texture).filters.mips = Mips::None;
            }
            Arc::new(without)
        });
        *material = without.clone();
    }
    (level, changed.into_keys().collect())
}

/// Pictures of one size.
struct Size {
    width_px: u32,
    truth: Outlines,
    level: Strengths,
}

impl Size {
    fn coverage(&self, times: f32) -> f64 {
        let truth = self.truth.covered_px().max(1);
        self.level.shown(times).covered_px() as f64 / truth as f64
    }

    fn specks_too_many(&self, times: f32) -> f64 {
        let more = self.level.shown(times).specks_per_view() - self.truth.specks_per_view();
        (more - MOST_MORE_SPECKS).max(0.0)
    }
}

/// By what cutoffs are to be multiplied; none where they are best as they are.
fn best(sizes: &[Size], [low, high]: [f32; 2]) -> Option<f32> {
    let off = |times: f32| -> f64 {
        let of_size = |size: &Size| size.coverage(times).max(1e-3).ln().powi(2);
        sizes.iter().map(of_size).sum()
    };
    let is_near = |size: &Size| (size.coverage(1.0) - 1.0).abs() <= NEAR_ENOUGH;
    if sizes.iter().all(is_near) {
        return None;
    }
    let before: Vec<f64> = sizes.iter().map(|size| size.specks_too_many(1.0)).collect();
    let has_no_more_specks = |times: f32| {
        let mut pairs = sizes.iter().zip(&before);
        pairs.all(|(size, before)| size.specks_too_many(times) <= *before)
    };
    let first = (low.log2() * TRIES_PER_OCTAVE).ceil() as i32;
    let last = (high.log2() * TRIES_PER_OCTAVE).floor() as i32;
    let tried = (first..=last).map(|step| (step as f32 / TRIES_PER_OCTAVE).exp2());
    let mut found: Vec<(f64, f32)> = tried.map(|times| (off(times), times)).collect();
    found.sort_by(|a, b| a.0.total_cmp(&b.0));
    let now = off(1.0);
    let better = found.into_iter().take_while(|(off, _)| *off < now);
    let mut better = better.map(|(_, times)| times);
    better.find(|times| has_no_more_specks(*times))
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::{DQuat, DVec3, EulerRot, Vec2};
    use secateur_gltf::{Document, plant_to_glb};
    use secateur_model::{Filters, Finish, Material, Plant, Texture, Wrap};
    use std::sync::Arc;

    /// Cards of a unit side in a ball of radius 10, whose texture of 256 x 256 texels shows what
    /// `is_there`.
    fn crown(is_there: impl Fn(u32, u32) -> bool) -> Tree {
        let texel = |k: u32| [60, 140, 40, 255 * u8::from(is_there(k % 256, k / 256))];
        let texture = Texture {
            width: 256,
            height: 256,
            rgba: (0..256 * 256).flat_map(texel).collect(),
            wrap: [Wrap::Repeat; 2],
            filters: Filters::default(),
        };
        let material = |name: &str, texture: Option<Texture>| {
            Arc::new(Material {
                name: name.to_owned(),
                base_color: [1.0; 4],
                alpha_mode: match texture {
                    Some(_) => AlphaMode::Mask(0.5),
                    None => AlphaMode::Opaque,
                },
                texture: texture.map(Arc::new),
                double_sided: true,
                finish: Finish::default(),
            })
        };
        let surface = |material| Surface {
            positions: Vec::new(),
            normals: Vec::new(),
            uvs: Vec::new(),
            colors: Vec::new(),
            holds: Vec::new(),
            triangles: Vec::new(),
            material,
        };
        let mut leaves = surface(material("leaves", Some(texture)));
        for k in 0..CARDS {
            let part = (f64::from(k) + 0.5) / f64::from(CARDS);
            let [a, b] = [2.4, 1.7].map(|angle| angle * f64::from(k));
            let turn = DQuat::from_euler(EulerRot::YXZ, a, b, 0.0);
            let centre = DVec3::Y * 12.0 + turn * DVec3::X * 9.0 * part.cbrt();
            let first = leaves.positions.len() as u32;
            for [u, v] in [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]] {
                let corner = turn * DVec3::new(u - 0.5, 0.5 - v, 0.0);
                leaves.positions.push(centre + corner);
                leaves.uvs.push(Vec2::new(u as f32, v as f32));
            }
            let quad = [[0, 1, 2], [0, 2, 3]];
            let quad = quad.map(|corners| corners.map(|corner| first + corner));
            leaves.triangles.extend(quad);
        }
        let mut wood = surface(material("bark", None));
        wood.positions = [[-0.1, 0.0], [0.1, 0.0], [0.0, 12.0]]
            .map(|[x, y]| DVec3::new(x, y, 0.0))
            .into();
        wood.triangles = vec![[0, 1, 2]];
        let plant = Plant {
            name: "crown".to_owned(),
            wood,
            leaves,
            triangles_per_leaf: vec![2; CARDS as usize],
            skeleton: None,
            holds: None,
        };
        let document = Document::from_bytes("crown.glb", plant_to_glb(&plant), None).unwrap();
        document.into_tree(&[]).unwrap()
    }

    const CARDS: u32 = 400;

    /// All leaves but the first.
    fn level(tree: &Tree) -> Lod {
        let count = tree.foliage().leaves().len();
        let mut order = secateur_model::RemovalOrder::new(count as u32);
        order.push_step(secateur_model::Step {
            removed: &[secateur_model::LeafId::from_index(0)],
            grown: &[],
            made: &[],
            survivors_area_scale: 1.0,
        });
        Lod::after(&order, 1)
    }

    fn chosen(tree: &Tree, lod: &Lod) -> Option<ChosenCutoffs> {
        choose_cutoffs(tree, lod, MaterialChange::Cutoffs).unwrap()
    }

    /// Stripes that get wider from one side to the other, up to a half: all mips are below that.
    #[test]
    fn a_crown_that_fades_gets_a_lower_cutoff() {
        let tree = crown(|x, _| x % 16 < x / 32);
        let found = chosen(&tree, &level(&tree)).unwrap();
        let own: Vec<(usize, f64)> = found.cutoffs.of_materials().collect();
        let [(1, cutoff)] = own[..] else {
            panic!("of the leaves alone: {own:?}");
        };
        assert!((0.1..0.45).contains(&cutoff), "{cutoff}");
        assert!((found.times - cutoff / 0.5).abs() < 1e-3);
        let far = found.coverage[2].1;
        assert!(far[0] < 0.5 && (0.7..1.2).contains(&far[1]), "{far:?}");
        // From a level that is the tree nothing is gone.
        let original = Lod::original(CARDS as usize);
        assert_eq!(chosen(&tree, &original), None);
    }

    /// Nearly half of each square of 8 x 8 texels is there: all coarse mip maps have that mean, and each
    /// cutoff shows cards whole or not at all.
    #[test]
    fn what_no_cutoff_helps_is_read_without_mip_maps() {
        let tree = crown(|x, y| x % 8 < 6 && y % 8 < 5);
        let by = |change| choose_cutoffs(&tree, &level(&tree), change).unwrap();
        let off = |found: &ChosenCutoffs| {
            let off = |(_, [_, after]): &(u32, [f64; 2])| (after - 1.0).abs();
            found.coverage.iter().map(off).fold(0.0, f64::max)
        };
        let found = by(MaterialChange::CutoffsOrMips).unwrap();
        let without: Vec<usize> = found.cutoffs.materials_without_mips().collect();
        assert_eq!(without, [1], "the leaves alone");
        assert!(off(&found) < 0.05, "{found:?}");
        // The level that is written shows that much.
        let bytes = tree.lod_to_bytes_with(&level(&tree), &found.cutoffs);
        let document = Document::from_bytes("level.glb", bytes.unwrap(), None).unwrap();
        let drawn = document.drawn_as_one(Detail::Color).unwrap();
        let texture = |one: &DrawnSurface| one.surface.material.texture.clone();
        let textures: Vec<_> = drawn.iter().filter_map(texture).collect();
        assert_eq!(textures.len(), 1);
        assert_eq!(textures[0].filters.mips, Mips::None);
        // With mip maps some size stays far off, whatever the cutoff.
        let kept = by(MaterialChange::Cutoffs);
        assert!(kept.is_none_or(|kept| {
            kept.cutoffs.materials_without_mips().count() == 0 && off(&kept) > FAR_OFF
        }));

        // Two thirds are there: clients close the holes of the original too, and so show no specks of it.
        let tree = crown(|x, y| x % 8 < 6 && y % 8 < 7);
        let found = choose_cutoffs(&tree, &level(&tree), MaterialChange::CutoffsOrMips).unwrap();
        let without = found.unwrap().cutoffs;
        assert_eq!(without.materials_without_mips().count(), 1);
    }

    /// Wide stripes: close by clients show no more of them than there is, with fewer specks than without mip maps.
    #[test]
    fn mip_maps_stay_where_there_would_be_more_specks_than_of_the_original() {
        let tree = crown(|x, _| x % 128 < 72);
        let found = choose_cutoffs(&tree, &level(&tree), MaterialChange::CutoffsOrMips).unwrap();
        let without = |found: ChosenCutoffs| found.cutoffs.materials_without_mips().count();
        assert_eq!(found.map_or(0, without), 0);
    }

    /// Squares, of which clients show a third from afar, and larger ones, of which they show a quarter too much:
    /// that outweighs some more specks close by.
    #[test]
    fn a_crown_that_vanishes_or_closes_may_show_more_specks_than_the_original() {
        for (side, shown) in [(64, 0.0..0.4), (96, 1.2..1.3)] {
            let tree = crown(|x, y| x % 128 < side && y % 128 < side);
            let found = choose_cutoffs(&tree, &level(&tree), MaterialChange::CutoffsOrMips);
            let found = found.unwrap().unwrap();
            assert_eq!(found.cutoffs.materials_without_mips().count(), 1);
            let [before, after] = found.coverage[2].1;
            assert!(shown.contains(&before), "{before}");
            assert!((after - 1.0).abs() < 0.05, "{after}");
        }
    }

    /// Large blots: a lower cutoff helps fine mip maps, and not the coarsest.
    #[test]
    fn cutoffs_stay_where_mip_maps_are_left_out() {
        let tree = crown(|x, y| x % 64 < 28 && y % 64 < 28);
        let by = |change| choose_cutoffs(&tree, &level(&tree), change).unwrap();
        let with = by(MaterialChange::Cutoffs).unwrap();
        let without = by(MaterialChange::CutoffsOrMips).unwrap();
        assert_eq!(without.cutoffs.materials_without_mips().count(), 1);
        assert_eq!(with.cutoffs.materials_without_mips().count(), 0);
        let cutoffs = |found: &ChosenCutoffs| found.cutoffs.of_materials().collect::<Vec<_>>();
        assert!(cutoffs(&with).len() == 1 && with.times != 1.0, "{with:?}");
        assert_eq!(cutoffs(&without), cutoffs(&with));
        assert_eq!(without.times, with.times);
    }

    /// What is hardly cut out fades nowhere.
    #[test]
    fn a_crown_that_does_not_fade_stays_as_it_is() {
        let tree = crown(|x, _| x > 0);
        assert_eq!(chosen(&tree, &level(&tree)), None);
    }
}
