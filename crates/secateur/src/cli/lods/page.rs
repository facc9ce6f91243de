//! The page to look at a chain.

use secateur_gltf::chain::LevelTexture;
use secateur_gltf::{Detail, Document, GltfError, LeafSurface, WholeTree};
use secateur_model::{LodModel, Surface};
use secateur_scene::chain::{Chain, ChainLevel, ChainOptions, LevelReport, Shape, show};
use secateur_scene::preview::{Continuous, Facts, Level as Shown, Preview, page};

use super::super::failure::Failure;
use super::job::{Job, about};

/// The page, from the levels as a client would draw them.
pub(crate) fn preview(
    tree: &WholeTree,
    job: &Job<'_>,
    options: &ChainOptions,
    made: &Chain,
) -> Result<String, Failure> {
    let items = tree.items();
    let draw = |document: &Document, textures: &[LevelTexture]| {
        let drawn = document.drawn(Detail::Full, &[])?;
        let surfaces = drawn.into_iter().map(|mut drawn| {
            show(&mut drawn.surface, drawn.material, textures);
            (drawn.surface, drawn.is_foliage)
        });
        Ok::<_, GltfError>(surfaces.collect())
    };
    let original = items.document();
    let mut surfaces: Vec<Vec<(Surface, bool)>> = vec![draw(original, &[])?];
    for level in &made.levels {
        let lod = match &level.shape {
            Shape::Original(_) => continue,
            Shape::Mesh(lod) => lod,
            Shape::Impostor(made) => {
                surfaces.push(vec![(made.impostor.surface.clone(), true)]);
                continue;
            }
        };
        let document = items.lod_document(lod)?;
        surfaces.push(draw(&document, &level.textures)?);
    }
    let first = Facts {
        name: "original".to_owned(),
        report: LevelReport::of_plant(tree),
    };
    // The original is there already.
    let is_lighter = |(_, level): &(usize, &ChainLevel)| !matches!(level.shape, Shape::Original(_));
    let rest = made.levels.iter().enumerate().filter(is_lighter);
    let rest = rest.map(|(k, level)| Facts {
        name: format!("LOD{k}"),
        report: level.report.clone(),
    });
    let facts: Vec<Facts> = std::iter::once(first).chain(rest).collect();
    let levels: Vec<Shown<'_>> = surfaces
        .iter()
        .zip(facts)
        .map(|(surfaces, facts)| Shown { surfaces, facts })
        .collect();
    let of_order = removal_order(tree, made)?;
    let continuous = of_order.as_ref().map(|(surfaces, model)| Continuous {
        surfaces,
        foliage: tree.leaves(),
        model,
    });
    let preview = Preview {
        title: &job.name,
        screen: options.screen,
        levels: &levels,
        continuous,
    };
    page(&preview).map_err(|error| Failure(about(job.tree, &error.to_string())))
}

/// The order that led to the coarsest level, and the leaves that it is of; none where no level has
/// one.
fn removal_order(
    tree: &WholeTree,
    made: &Chain,
) -> Result<Option<(Vec<LeafSurface>, LodModel)>, Failure> {
    let orders = made.levels.iter().filter_map(|level| level.order.clone());
    let Some(order) = orders.max_by_key(|order| order.len()) else {
        return Ok(None);
    };
    let leaves = tree.leaves().leaves().len();
    let mut surfaces = tree.items().leaf_surfaces(Detail::Full)?;
    // Behind the leaves come pieces of wood, which are in surfaces of their own.
    surfaces.retain(|of| of.leaves.iter().any(|leaf| leaf.leaf.index() < leaves));
    let model = LodModel::new(order, tree.leaves());
    let model = model.map_err(|error| Failure(error.to_string()))?;
    Ok(Some((surfaces, model)))
}
