//! From a species to a plant with wood and leaves.

use std::sync::Arc;

use secateur_model::{AlphaMode, Material, Plant};

use crate::leaf_card::{CardStyle, leaf_surface};
use crate::leaf_texture::oak_leaf_texture;
use crate::oak::{self, OakDetail};
use crate::wood::wood_surface;
use crate::{DeriveError, LeafPose, Random, Skeleton, Species, TurtleError, draw};

/// The most leaves a plant can be asked for.
pub const MAX_LEAVES: u32 = 1_000_000;
/// Leaves of the crown after which density is judged, and their length.
const REFERENCE_LEAVES: f64 = 3000.0;
const REFERENCE_LEAF_LENGTH_M: f64 = 0.32;
/// A tree of few leaves is still a whole tree.
const COARSEST: f64 = 0.7;
/// A crown of few leaves is a sparse one, not one of giant leaves.
const LONGEST_LEAF_M: f64 = 0.36;

/// What to grow.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct GrowOptions {
    /// How many leaves the plant has, exactly: 1 to 1,000,000.
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
pub enum GrowError {
    /// A number of leaves outside 1 to the limit.
    #[error("cannot grow {species} with {leaves} leaves: ask for 1 to {max}")]
    LeafCount {
        /// The species.
        species: Species,
        /// How many were asked for.
        leaves: u32,
        /// The most that can be asked for.
        max: u32,
    },
    /// The rules made too much or something that is no number.
    #[error("the rules of {species} do not grow: {source}")]
    Derive {
        /// The species.
        species: Species,
        /// What went wrong.
        source: DeriveError,
    },
    /// The rules made a string that cannot be drawn.
    #[error("the rules of {species} cannot be drawn: {source}")]
    Draw {
        /// The species.
        species: Species,
        /// What went wrong.
        source: TurtleError,
    },
}

/// Grows a plant of this species, upright (y) on the origin, in metres: an oak
/// is about 8 m high.
///
/// The rules are divided finely enough to bear the leaves that are asked for;
/// of those they bear, an even share is kept. From 2,400 leaves on, a leaf's area
/// goes with 1 / `leaves`, so crowns stay equally dense. The same options give
/// the same bits on every platform.
///
/// Worst case: time and memory in proportion to the number of leaves, plus one
/// tree of about 3,000.
///
/// # Errors
/// [`GrowError::LeafCount`] for 0 or more than 1,000,000 leaves. The other
/// errors would be a mistake in the species' rules.
pub fn grow(species: Species, options: &GrowOptions) -> Result<Plant, GrowError> {
    let skeleton = grow_skeleton(species, options)?;
    let mut tints = Random::new(!options.seed);
    let style = CardStyle {
        width: 0.74,
        outward: 0.45,
    };
    let leaves = leaf_surface(&skeleton.leaves, style, leaf_material(), &mut tints);
    Ok(Plant {
        name: species.name().into(),
        wood: wood_surface(&skeleton, bark_material()),
        leaves,
        triangles_per_leaf: vec![2; skeleton.leaves.len()],
    })
}

/// The branches and leaves of the plant that [`grow`] gives a surface, leaves in
/// the same order.
///
/// # Errors
/// As [`grow`].
pub fn grow_skeleton(species: Species, options: &GrowOptions) -> Result<Skeleton, GrowError> {
    if !(1..=MAX_LEAVES).contains(&options.leaves) {
        return Err(GrowError::LeafCount {
            species,
            leaves: options.leaves,
            max: MAX_LEAVES,
        });
    }
    let share = f64::from(options.leaves) / oak::LEAVES_AT_FINENESS_1;
    let mut fineness = libm::pow(share, 1.0 / oak::LEAVES_EXPONENT).max(COARSEST);
    loop {
        let mut skeleton = oak_skeleton(fineness, options)?;
        if skeleton.leaves.len() >= options.leaves as usize {
            keep_evenly(&mut skeleton.leaves, options);
            return Ok(skeleton);
        }
        let wanted = f64::from(options.leaves) / skeleton.leaves.len().max(1) as f64;
        fineness *= 1.01 * libm::pow(wanted, 1.0 / oak::LEAVES_EXPONENT);
    }
}

fn oak_skeleton(fineness: f64, options: &GrowOptions) -> Result<Skeleton, GrowError> {
    let species = Species::Oak;
    let density_length_m =
        REFERENCE_LEAF_LENGTH_M * libm::sqrt(REFERENCE_LEAVES / f64::from(options.leaves));
    let rules = oak::oak(OakDetail {
        fineness,
        leaf_length_m: density_length_m.min(LONGEST_LEAF_M),
    });
    let modules = rules
        .derive(oak::ITERATIONS, &mut Random::new(options.seed))
        .map_err(|source| GrowError::Derive { species, source })?;
    draw(&modules).map_err(|source| GrowError::Draw { species, source })
}

/// Keeps `options.leaves` of the poses, evenly spaced in their order, which runs
/// along the branches; the seed says where the first is.
fn keep_evenly(poses: &mut Vec<LeafPose>, options: &GrowOptions) {
    let (grown, kept) = (poses.len() as u64, u64::from(options.leaves));
    let offset = Random::new(options.seed).bits() % grown;
    // Strictly increasing, as grown / kept is at least 1, and below grown.
    *poses = (0..kept)
        .map(|leaf| poses[((leaf * grown + offset) / kept) as usize])
        .collect();
}

fn bark_material() -> Arc<Material> {
    Arc::new(Material {
        name: "oak bark".into(),
        base_color: [0.16, 0.11, 0.075, 1.0],
        texture: None,
        alpha_mode: AlphaMode::Opaque,
        double_sided: false,
    })
}

fn leaf_material() -> Arc<Material> {
    Arc::new(Material {
        name: "oak leaf".into(),
        base_color: [1.0; 4],
        texture: Some(Arc::new(oak_leaf_texture())),
        alpha_mode: AlphaMode::Mask(0.5),
        double_sided: true,
    })
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
        hash.finalize().iter().map(|b| format!("{b:02x}")).collect()
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
            "99197fa8cdb971a9ed2d22e4efa24e293e7f67d88af3e8965a568573ef720aa8"
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
