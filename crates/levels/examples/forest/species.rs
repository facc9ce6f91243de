//! A plant with all that it can be drawn as.

use std::error::Error;
use std::path::Path;

use secateur_gltf::{Document, WholeTree, plant_to_glb};
use secateur_levels::leaf_boxes::{BoxLimits, LeafBox, leaf_boxes};
use secateur_model::{BoundingSphere, LodModel, Surface};
use secateur_plant::{GrowOptions, Species as Kind, grow};
use secateur_raster::OpenEngine;
use secateur_simplify::whole::WholePlant;
use secateur_simplify::{Fitting, Options, Preset, Resolution, Target, simplify, sphere_of};

use crate::geometry::PlantPart;

/// Leaves of the plant that is grown where no other is named.
pub(crate) const LEAVES: u32 = 20_000;
pub(crate) const SEED: u64 = 3;

/// The coarsest level has this share of the leaves.
const COARSEST: f64 = 0.005;

/// How far down boxes have pictures. Of the grown oak that makes about forty boxes; each takes six
/// pictures.
const BOXES: BoxLimits = BoxLimits {
    top_level: 2,
    least_volume: 0.01,
};

/// Wood is looked up for numbers of leaves that rise by this factor.
const WOOD_STEP: f64 = 1.3;

/// A species of the forest: one plant with all that its instances share.
pub(crate) struct Species {
    pub(crate) name: String,
    pub(crate) leaves: PlantPart,
    pub(crate) wood: PlantPart,
    /// About leaves and wood.
    pub(crate) sphere: BoundingSphere,
    /// Empty for a plant without a skeleton.
    pub(crate) boxes: Vec<LeafBox>,
    /// Steps of the wood's order for numbers of leaves, falling.
    wood_steps: Vec<(usize, usize)>,
}

impl Species {
    /// A file's plant, or an oak.
    pub(crate) fn new(file: Option<&str>) -> Result<Self, Box<dyn Error>> {
        let (name, tree) = match file {
            Some(file) => (file.to_owned(), WholeTree::open(Path::new(file), &[])?),
            None => {
                let options = GrowOptions {
                    leaves: LEAVES,
                    seed: SEED,
                };
                let oak = plant_to_glb(&grow(Kind::Oak, &options)?);
                let document = Document::from_bytes("oak.glb", oak, None)?;
                (format!("oak, seed {SEED}"), document.into_whole_tree(&[])?)
            }
        };
        let surfaces = tree.items().document().surfaces(&[])?;
        let only = |is_foliage: bool, what: &str| -> Result<Surface, String> {
            let mut found = surfaces.iter().filter(|(_, leaf)| *leaf == is_foliage);
            match (found.next(), found.next()) {
                (Some((surface, _)), None) => Ok(surface.clone()),
                _ => Err(format!(
                    "{name}: the example draws plants whose {what} is one mesh"
                )),
            }
        };
        let (leaf_surface, wood_surface) = (only(true, "foliage")?, only(false, "wood")?);
        let options = Options {
            resolution: Resolution::Pixels(256),
            fit: Fitting::None,
            ..Options::with_preset(Preset::Look, Target::leaf_share(COARSEST))
        };
        let simplified = simplify(tree.leaves(), &options)?;
        let engine = OpenEngine::cpu();
        let whole = WholePlant::new(tree.items().foliage(), tree.leaves(), tree.wood(), &engine)?;
        let leaf_model = LodModel::new(simplified.passes.in_one_order(), tree.leaves())?;
        let wood_model = LodModel::new(whole.wood_order(), tree.wood())?;
        let wood_steps = wood_steps(&whole, &leaf_model, &tree);
        let boxes = match tree.skeleton()? {
            Some(skeleton) => leaf_boxes(tree.leaves(), &skeleton, &BOXES),
            None => Vec::new(),
        };
        Ok(Self {
            sphere: sphere_of(tree.items().foliage())?,
            leaves: PlantPart::new(tree.leaves().clone(), leaf_model, leaf_surface)?,
            wood: PlantPart::new(tree.wood().clone(), wood_model, wood_surface)?,
            name,
            boxes,
            wood_steps,
        })
    }

    /// Steps of the wood's order beside a crown of this many leaves.
    pub(crate) fn wood_steps(&self, leaves: usize) -> usize {
        let at = self.wood_steps.partition_point(|(n, _)| *n > leaves);
        // From both sides, in proportion: wood changes as continuously as leaves do.
        let [before, after] = [at.saturating_sub(1), at.min(self.wood_steps.len() - 1)];
        let [(n0, s0), (n1, s1)] = [before, after].map(|k| self.wood_steps[k]);
        if n0 == n1 {
            return s0;
        }
        let share = (n0.saturating_sub(leaves)) as f64 / (n0 - n1) as f64;
        (s0 as f64 + (s1 as f64 - s0 as f64) * share.min(1.0)) as usize
    }
}

/// The wood that [`WholePlant::wood_budget`] gives beside numbers of leaves, from all down.
fn wood_steps(whole: &WholePlant<'_>, model: &LodModel, tree: &WholeTree) -> Vec<(usize, usize)> {
    let all = tree.leaves().triangles().len() as f64;
    let (most, order) = (model.most_leaves(), whole.wood_order());
    let mut found = vec![(most, 0)];
    let mut leaves = most as f64 / WOOD_STEP;
    while leaves >= 1.0 {
        let triangles = all * leaves / most as f64;
        // A budget that leaves and wood share: found where what the wood leaves is what leaves take.
        let mut budget = 1.5 * triangles;
        for _ in 0..4 {
            budget = triangles + whole.wood_budget(budget as usize) as f64;
        }
        let wood = (budget - triangles) as usize;
        found.push((leaves as usize, order.steps_to_triangles(tree.wood(), wood)));
        leaves /= WOOD_STEP;
    }
    found
}
