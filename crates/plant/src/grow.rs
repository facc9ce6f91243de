//! From rules to a plant with wood and leaves.

use std::sync::Arc;

use secateur_model::{AlphaMode, Material, Plant, PlantHolds};

use crate::bark_texture::bark_texture;
use crate::holds::{leaf_holds, starts_m};
use crate::language::Shrinks;
use crate::leaf_surface::leaf_surface;
use crate::leaf_texture::leaf_texture;
use crate::wood::wood_surface;
use crate::{LeafPose, Random, Rules, RulesError, Segment, Skeleton, Species, Word, draw};

/// The most leaves a plant can be asked for.
pub const MAX_LEAVES: u32 = 1_000_000;
/// The most vertices of wood and leaves together.
const MAX_VERTICES: u64 = 40_000_000;
/// A plant of few leaves is still a whole plant.
const LEAST_DETAIL: f64 = 0.4;
/// A crown of few leaves is a sparse one, not one of giant leaves.
const MOST_LEAF_SCALE: f64 = 3.0;
/// Tries to find the detail that bears enough leaves.
const TRIES: u32 = 12;

/// How many leaves a plant gets, and which sibling it is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct GrowOptions {
    /// How many leaves the plant has, exactly: 1 to [`MAX_LEAVES`].
    pub leaves: u32,
    /// Which sibling: equal seeds grow equal plants.
    pub seed: u64,
}

impl Default for GrowOptions {
    fn default() -> Self {
        Self {
            leaves: 3000,
            seed: 3,
        }
    }
}

/// Why a plant cannot be grown.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum GrowError {
    /// A number of leaves outside 1 to the limit.
    #[error("cannot grow {name} with {leaves} leaves: ask for 1 to {MAX_LEAVES}")]
    LeafCount {
        /// Name of the species or rule file.
        name: String,
        /// How many were asked for.
        leaves: u32,
    },
    /// The rules do not bear as many leaves.
    #[error(
        "{name} bears {most} leaves, not {leaves}: use `detail` in its rules so that more can be \
         asked for"
    )]
    TooFewLeaves {
        /// Name of the species or rule file.
        name: String,
        /// How many were asked for.
        leaves: u32,
        /// How many there are at most.
        most: usize,
    },
    /// More vertices than a file should hold.
    #[error(
        "{name} has more than {MAX_VERTICES} vertices: ask for fewer leaves, segments or sides"
    )]
    TooLarge {
        /// Name of the species or rule file.
        name: String,
    },
    /// The rules cannot be derived or drawn.
    #[error("{name}: {source}")]
    Rules {
        /// Name of the species or rule file.
        name: String,
        /// What went wrong, and where.
        source: RulesError,
    },
}

/// Grows a plant of this species, upright (y) on the origin, in metres.
///
/// The rules are divided finely enough to bear the leaves that are asked for
/// (`detail`); of those they bear, an even share is kept. A leaf's area goes with
/// 1 / `leaves`, so crowns stay as dense as with [`Species::default_leaves`], but
/// leaves are at most three times as long as with those. The same options give
/// the same bits on every platform.
///
/// Worst case: time and memory in proportion to the number of leaves, plus one
/// small plant.
///
/// # Errors
/// [`GrowError::LeafCount`] for 0 or more than [`MAX_LEAVES`] leaves. The other
/// errors would be a mistake in the species' rules.
pub fn grow(species: Species, options: &GrowOptions) -> Result<Plant, GrowError> {
    let wanted = Some(options.leaves);
    grow_rules(species.rules(), species.name(), wanted, options.seed)
}

/// The branches and leaves of the plant that [`grow`] gives a surface, leaves in
/// the same order.
///
/// # Errors
/// As [`grow`].
pub fn grow_skeleton(species: Species, options: &GrowOptions) -> Result<Skeleton, GrowError> {
    let wanted = Some(options.leaves);
    rules_skeleton(species.rules(), species.name(), wanted, options.seed)
}

/// Grows a plant from rules, as [`grow`] does; `name` is for its parts and for
/// errors. Without a number of leaves it has those that the file sets, or else
/// all that its rules bear.
///
/// # Errors
/// [`GrowError`]: a number of leaves that cannot be had, or what the rules do
/// wrong, with its place in the file.
pub fn grow_rules(
    rules: &Rules,
    name: &str,
    leaves: Option<u32>,
    seed: u64,
) -> Result<Plant, GrowError> {
    let skeleton = rules_skeleton(rules, name, leaves, seed)?;
    plant_of(skeleton, rules, name, seed)
}

/// The plant of a skeleton that these rules drew, or of a level of detail of one.
///
/// # Errors
/// [`GrowError::TooLarge`].
pub fn plant_of(
    skeleton: Skeleton,
    rules: &Rules,
    name: &str,
    seed: u64,
) -> Result<Plant, GrowError> {
    check_size(&skeleton, name)?;
    Ok(surfaces(skeleton, rules, name, seed))
}

/// The branches and leaves of the plant that [`grow_rules`] gives a surface.
///
/// # Errors
/// As [`grow_rules`].
pub fn rules_skeleton(
    rules: &Rules,
    name: &str,
    leaves: Option<u32>,
    seed: u64,
) -> Result<Skeleton, GrowError> {
    let usual = rules.settings().leaves;
    let Some(wanted) = leaves.or(usual) else {
        return drawn(rules, name, &derived(rules, name, 1.0, seed)?);
    };
    if !(1..=MAX_LEAVES).contains(&wanted) {
        return Err(GrowError::LeafCount {
            name: name.into(),
            leaves: wanted,
        });
    }
    let word = bearing(rules, name, wanted, seed)?;
    let mut skeleton = drawn(rules, name, &word)?;
    keep_evenly(&mut skeleton.leaves, wanted, seed);
    if let Some(usual) = usual {
        let scale = libm::sqrt(f64::from(usual) / f64::from(wanted)).min(MOST_LEAF_SCALE);
        let [width, length] = match rules.settings().leaf_shrinks {
            Shrinks::Both => [scale; 2],
            Shrinks::Width => [scale * scale, 1.0],
        };
        for leaf in &mut skeleton.leaves {
            leaf.width_m *= width;
            leaf.length_m *= length;
        }
    }
    Ok(skeleton)
}

/// Refuses what would not fit a file, before any of it is made.
fn check_size(skeleton: &Skeleton, name: &str) -> Result<(), GrowError> {
    let of_segment = |segment: &Segment| 2 * (u64::from(segment.sides) + 1);
    let of_leaf = |leaf: &LeafPose| u64::from(leaf.kind.triangles()) + 8;
    let wood: u64 = skeleton.segments.iter().map(of_segment).sum();
    let leaves: u64 = skeleton.leaves.iter().map(of_leaf).sum();
    if wood + leaves > MAX_VERTICES {
        return Err(GrowError::TooLarge { name: name.into() });
    }
    Ok(())
}

/// The surface of a skeleton that these rules drew.
pub(crate) fn surfaces(skeleton: Skeleton, rules: &Rules, name: &str, seed: u64) -> Plant {
    let settings = rules.settings();
    let mut tints = Random::new(!seed);
    let leaf_texture = leaf_texture(settings);
    let bark_texture = bark_texture(settings);
    let leaf_material = Arc::new(Material {
        name: format!("{name} leaf"),
        base_color: color_beside(leaf_texture.is_some(), settings.leaf_colour),
        alpha_mode: match leaf_texture {
            Some(_) => AlphaMode::Mask(0.5),
            None => AlphaMode::Opaque,
        },
        texture: leaf_texture.map(Arc::new),
        double_sided: true,
        finish: secateur_model::Finish::default(),
    });
    let bark_material = Arc::new(Material {
        name: format!("{name} bark"),
        base_color: color_beside(bark_texture.is_some(), settings.bark_colour),
        texture: bark_texture.map(Arc::new),
        alpha_mode: AlphaMode::Opaque,
        double_sided: false,
        finish: secateur_model::Finish::default(),
    });
    let triangles = skeleton.leaves.iter().map(|leaf| leaf.kind.triangles());
    let starts_m = starts_m(&skeleton.segments);
    let (wood, wood_holds) = wood_surface(&skeleton, &starts_m, bark_material);
    Plant {
        name: name.into(),
        wood,
        leaves: leaf_surface(&skeleton.leaves, settings, leaf_material, &mut tints),
        triangles_per_leaf: triangles.collect(),
        holds: Some(PlantHolds {
            leaves: leaf_holds(&skeleton, &starts_m),
            wood: wood_holds,
        }),
        skeleton: Some(skeleton.into_plant_skeleton()),
    }
}

/// The base colour of a material: white beside a texture, else this sRGB colour
/// made linear.
fn color_beside(has_texture: bool, srgb: [f64; 3]) -> [f32; 4] {
    if has_texture {
        return [1.0; 4];
    }
    let linear = |c: f64| match c {
        c if c <= 0.04045 => c / 12.92,
        c => libm::pow((c + 0.055) / 1.055, 2.4),
    };
    let [r, g, b] = srgb.map(|c| linear(c) as f32);
    [r, g, b, 1.0]
}

/// A word with at least this many leaves, and not many more.
fn bearing(rules: &Rules, name: &str, wanted: u32, seed: u64) -> Result<Word, GrowError> {
    let target = f64::from(wanted);
    let usual = rules.settings().leaves.map_or(target, f64::from);
    let mut detail = libm::sqrt(target / usual).max(LEAST_DETAIL);
    let mut most = 0;
    for _ in 0..TRIES {
        let word = derived(rules, name, detail, seed)?;
        let leaves = word.leaf_count(rules);
        most = most.max(leaves);
        let share = target / leaves.max(1) as f64;
        let is_coarsest = detail <= LEAST_DETAIL || !rules.uses_detail();
        if share <= 1.0 && (share > 0.55 || is_coarsest) {
            return Ok(word);
        }
        if !rules.uses_detail() {
            break;
        }
        // Leaves go about with the square of the detail: on branches and along them.
        detail = (1.04 * detail * libm::sqrt(share)).max(LEAST_DETAIL);
    }
    Err(GrowError::TooFewLeaves {
        name: name.into(),
        leaves: wanted,
        most,
    })
}

fn derived(rules: &Rules, name: &str, detail: f64, seed: u64) -> Result<Word, GrowError> {
    let word = rules.derive(detail, &mut Random::new(seed));
    word.map_err(|source| GrowError::Rules {
        name: name.into(),
        source,
    })
}

fn drawn(rules: &Rules, name: &str, word: &Word) -> Result<Skeleton, GrowError> {
    draw(rules, word).map_err(|source| GrowError::Rules {
        name: name.into(),
        source,
    })
}

/// Keeps this number of the poses, evenly spaced in their order, which runs along the
/// branches; the seed says where the first is.
fn keep_evenly(poses: &mut Vec<LeafPose>, kept: u32, seed: u64) {
    let (grown, kept) = (poses.len() as u64, u64::from(kept));
    let offset = Random::new(seed).bits() % grown;
    // Strictly increasing, as grown / kept is at least 1, and below grown.
    *poses = (0..kept)
        .map(|leaf| poses[((leaf * grown + offset) / kept) as usize])
        .collect();
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec3;
    use sha2::{Digest, Sha256};

    fn oak(leaves: u32, seed: u64) -> Plant {
        grow(Species::Oak, &GrowOptions { leaves, seed }).unwrap()
    }

    /// Over the bits of all positions and corners, wood first.
    fn sha256(plant: &Plant) -> String {
        let mut hash = Sha256::new();
        for surface in [&plant.wood, &plant.leaves] {
            for position in &surface.positions {
                hash.update(position.to_array().map(f64::to_le_bytes).as_flattened());
            }
            for triangle in &surface.triangles {
                hash.update(triangle.map(u32::to_le_bytes).as_flattened());
            }
        }
        secateur_model::hex(&hash.finalize())
    }

    #[test]
    fn leaf_counts_are_hit_exactly() {
        for leaves in [1, 2, 100, 3000, 20_376] {
            let plant = oak(leaves, 11);
            assert_eq!(plant.triangles_per_leaf, vec![2; leaves as usize]);
            assert_eq!(plant.leaves.triangles.len(), 2 * leaves as usize);
            assert_eq!(plant.leaves.positions.len(), 4 * leaves as usize);
        }
    }

    #[test]
    fn every_leaf_is_finite_has_area_and_its_own_vertices() {
        let leaves = oak(3000, 2).leaves;
        assert!(leaves.positions.iter().all(|p| p.is_finite()));
        assert!(leaves.normals.iter().all(|n| n.is_normalized()));
        for (leaf, triangles) in leaves.triangles.chunks(2).enumerate() {
            for triangle in triangles {
                let [a, b, c] = triangle.map(|i| leaves.positions[i as usize]);
                assert!(
                    (b - a).cross(c - a).length() > 1e-4,
                    "leaf {leaf} has no area"
                );
                // Four vertices a leaf, in leaf order: none is another leaf's.
                assert!(triangle.iter().all(|&i| i as usize / 4 == leaf));
            }
        }
    }

    #[test]
    fn wood_is_finite_and_whole() {
        let wood = oak(3000, 2).wood;
        let count = wood.positions.len();
        assert!(wood.positions.iter().all(|p| p.is_finite()));
        assert!(wood.normals.iter().all(|n| n.is_normalized()));
        assert_eq!((wood.normals.len(), wood.uvs.len()), (count, count));
        assert!(
            wood.triangles
                .iter()
                .flatten()
                .all(|&i| (i as usize) < count)
        );
    }

    #[test]
    fn an_oak_stands_on_the_origin_and_is_about_8_m_high() {
        for seed in 0..8 {
            let plant = oak(3000, seed);
            let heights = plant.leaves.positions.iter().map(|p| p.y);
            let top = heights.clone().fold(0.0, f64::max);
            assert!((7.0..9.3).contains(&top), "seed {seed} is {top} m high");
            let foot = plant.wood.positions[..15].iter();
            assert!(foot.clone().all(|p| p.y.abs() < 1e-12));
            let middle = foot.take(14).sum::<DVec3>() / 14.0;
            assert!(middle.length() < 1e-12);
        }
    }

    #[test]
    fn the_same_seed_grows_the_same_bits_everywhere() {
        let plant = oak(3000, 7);
        assert_eq!(plant, oak(3000, 7));
        assert_eq!(
            sha256(&plant),
            "5436ca9d1633c6afaa15f7d48ab1e254ddbcfed3f81eecba459bfe2612f7876b"
        );
        assert_ne!(plant.leaves.positions, oak(3000, 8).leaves.positions);
    }

    #[test]
    fn crowns_of_different_counts_have_the_same_leaf_area() {
        let area = |leaves| -> f64 {
            let poses = grow_skeleton(Species::Oak, &GrowOptions { leaves, seed: 4 });
            let lengths = poses.unwrap().leaves.into_iter().map(|pose| pose.length_m);
            lengths.map(|length| length * length).sum()
        };
        // Lengths vary by 22 %: squares sum to within a few per cent.
        assert!((area(20_000) / area(3000) - 1.0).abs() < 0.03);
    }

    #[test]
    fn counts_out_of_range_are_refused() {
        for leaves in [0, 1_000_001, u32::MAX] {
            let error = grow(Species::Oak, &GrowOptions { leaves, seed: 0 }).unwrap_err();
            assert_eq!(
                error.to_string(),
                format!("cannot grow oak with {leaves} leaves: ask for 1 to 1000000")
            );
        }
    }
}
