//! The page to look at levels.

use secateur_gltf::chain::LevelTexture;
use secateur_gltf::{Detail, Document, GltfError, LeafSurface, WholeTree};
use secateur_model::{LodModel, Surface};
use secateur_scene::chain::{Chain, ChainLevel, LevelReport, Shape, show};
use secateur_scene::preview::{
    Continuous, Facts, Level as Shown, Packed, Pictures, Preview, PreviewError, packed, page,
};

use crate::{Error, Levels};

impl Levels<'_> {
    /// A page to look at the plant and its levels side by side, as a client would draw them; it needs nothing else.
    ///
    /// # Errors
    /// [`Error::Gltf`] if what is drawn can't be read, [`Error::Preview`] if there is nothing to look at.
    pub fn page(&self) -> Result<String, Error> {
        previewed(self, page)
    }

    /// What such a page draws, for who has the page already.
    ///
    /// # Errors
    /// As [`page`](Self::page).
    pub fn packed(&self, pictures: Pictures) -> Result<Packed, Error> {
        previewed(self, |preview| packed(preview, pictures))
    }
}

fn previewed<T>(
    levels: &Levels<'_>,
    make: impl FnOnce(&Preview<'_>) -> Result<T, PreviewError>,
) -> Result<T, Error> {
    let (tree, made) = (levels.tree(), &levels.chain);
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
    let all: Vec<Shown<'_>> = surfaces
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
        title: levels.name(),
        screen: levels.screen,
        levels: &all,
        continuous,
    };
    Ok(make(&preview)?)
}

/// The order that led to the coarsest level, and the leaves that it is of; none where no level has
/// one.
fn removal_order(
    tree: &WholeTree,
    made: &Chain,
) -> Result<Option<(Vec<LeafSurface>, LodModel)>, GltfError> {
    let orders = made.levels.iter().filter_map(|level| level.order.clone());
    let Some(order) = orders.max_by_key(|order| order.len()) else {
        return Ok(None);
    };
    let leaves = tree.leaves().leaves().len();
    let mut surfaces = tree.items().leaf_surfaces(Detail::Full)?;
    // Behind the leaves come pieces of wood, which are in surfaces of their own.
    surfaces.retain(|of| of.leaves.iter().any(|leaf| leaf.leaf.index() < leaves));
    let model = LodModel::new(order, tree.leaves()).expect("levels have orders of their leaves");
    Ok(Some((surfaces, model)))
}
