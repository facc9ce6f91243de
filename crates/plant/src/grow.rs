//! From a species to a plant with wood and leaves.

use std::sync::Arc;

use secateur_model::{AlphaMode, Material, Plant};

use crate::leaf_card::{CardStyle, leaf_surface};
use crate::leaf_texture::oak_leaf_texture;
use crate::oak::{self, OakDetail};
use crate::wood::wood_surface;
use crate::{DeriveError, LeafPose, Random, Skeleton, Species, TurtleError, draw};

/// The most leaves a plant can be asked for.
const MAX_LEAVES: u32 = 1_000_000;
/// Leaves of the crown after which density is judged, and their length.
const REFERENCE_LEAVES: f64 = 3000.0;
const REFERENCE_LEAF_LENGTH_M: f64 = 0.215;
/// A crown of few leaves is a sparse one, not one of giant leaves.
const LONGEST_LEAF_M: f64 = 0.3;

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
            seed: 7,
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
/// of those they bear, an even share is kept. From 1,500 leaves on, a leaf's area
/// goes with 1 / `leaves`, so crowns stay equally dense. The same options give
/// the same bits on every platform.
///
/// Worst case: time and memory in proportion to the number of leaves, plus one
/// tree of about 4,000.
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
    // Leaves grow with about the cube of the fineness: three levels of the rules
    // divide by it.
    let per_reference = f64::from(options.leaves) / REFERENCE_LEAVES;
    let mut fineness = libm::cbrt(per_reference).max(1.0);
    loop {
        let mut skeleton = oak_skeleton(fineness, options)?;
        if skeleton.leaves.len() >= options.leaves as usize {
            keep_evenly(&mut skeleton.leaves, options);
            return Ok(skeleton);
        }
        fineness *= 1.06;
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
        .map(|leaf| poses[((leaf * grown + offset) / kept).min(grown - 1) as usize])
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
