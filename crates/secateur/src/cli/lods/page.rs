//! The page to look at a chain.

use secateur_gltf::chain::LevelTexture;
use secateur_gltf::{Detail, Document, GltfError, WholeTree};
use secateur_model::Surface;
use secateur_scene::chain::{Chain, ChainOptions, Shape, show};
use secateur_scene::preview::{Facts, Level as Shown, Preview, page};

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
        let drawn = document.drawn(Detail::NormalMaps, &[])?;
        let surfaces = drawn.into_iter().map(|mut drawn| {
            show(&mut drawn.surface, drawn.material, textures);
            (drawn.surface, drawn.is_foliage)
        });
        Ok::<_, GltfError>(surfaces.collect())
    };
    let original = items.document();
    let memory = original.memory();
    let mut surfaces: Vec<Vec<(Surface, bool)>> = vec![draw(original, &[])?];
    for level in &made.levels {
        let lod = match &level.shape {
            Shape::Mesh(lod) => lod,
            Shape::Impostor(made) => {
                surfaces.push(vec![(made.impostor.surface.clone(), true)]);
                continue;
            }
        };
        let bytes = items.lod_to_bytes(lod)?;
        let document =
            Document::from_bytes_within(original.name(), bytes, original.folder(), memory)?;
        surfaces.push(draw(&document, &level.textures)?);
    }
    let first = Facts {
        name: "original".to_owned(),
        leaves: Some(tree.leaves().leaves().len() as u64),
        triangles: items.foliage().triangles().len() as u64,
        foliage_triangles: tree.leaves().triangles().len() as u64,
        wood_triangles: tree.wood().triangles().len() as u64,
        distance: 0.0,
        pixels_high: None,
        flip_mean: None,
        silhouette_iou: None,
        pop_flip: None,
    };
    let rest = made.levels.iter().enumerate().map(|(k, level)| Facts {
        name: format!("LOD{k}"),
        leaves: matches!(level.shape, Shape::Mesh(_)).then_some(level.leaves),
        triangles: level.triangles(),
        foliage_triangles: level.foliage_triangles,
        wood_triangles: level.wood_triangles,
        distance: level.distance,
        pixels_high: Some(level.pixels_high),
        flip_mean: Some(level.flip_mean),
        silhouette_iou: level.silhouette_iou,
        pop_flip: level.pop_flip,
    });
    let facts: Vec<Facts> = std::iter::once(first).chain(rest).collect();
    let levels: Vec<Shown<'_>> = surfaces
        .iter()
        .zip(facts)
        .map(|(surfaces, facts)| Shown { surfaces, facts })
        .collect();
    let preview = Preview {
        title: &job.name,
        screen: options.screen,
        levels: &levels,
    };
    page(&preview).map_err(|error| Failure(about(job.tree, &error.to_string())))
}
