//! The page to look at a plant beside its levels.

use secateur_gltf::chain::LevelTexture;
use secateur_gltf::{Detail, DrawnSurface, GltfError, LeafSurface};
use secateur_levels::chain::{ChainLevel, LevelReport, Shape, show, texture_bytes};
use secateur_model::{LodModel, RemovalOrder, Surface};
use secateur_pages::preview::{
    Continuous, Facts, Level as Shown, Packed, Pictures, Preview, PreviewError, packed, page,
};
use secateur_runtime::Screen;

use crate::{Error, Level, Levels, Plant};

/// What is drawn of a plant or a level of it: surfaces, each with whether it is foliage.
type Drawn = Vec<(Surface, bool)>;

impl Levels {
    /// A page to look at the plant and its levels side by side, as a client would draw them; it needs nothing else.
    ///
    /// # Errors
    /// [`Error::Gltf`] if what is drawn can't be read, [`Error::Preview`] if there is nothing to look at.
    pub fn preview_html(&self) -> Result<String, Error> {
        self.previewed(page)
    }

    /// What such a page draws, for who has the page already.
    ///
    /// # Errors
    /// As [`preview_html`](Self::preview_html).
    pub fn preview_packed(&self, pictures: Pictures) -> Result<Packed, Error> {
        self.previewed(|preview| packed(preview, pictures))
    }

    fn previewed<T>(&self, make: impl MakePage<T>) -> Result<T, Error> {
        let items = self.tree().items();
        let mut shown = vec![original(self.plant())?];
        // The original is there already.
        let is_lighter =
            |(_, level): &(usize, &ChainLevel)| !matches!(level.shape, Shape::Original(_));
        for (k, level) in self.chain.levels.iter().enumerate().filter(is_lighter) {
            let surfaces = match &level.shape {
                Shape::Impostor(made) => vec![(made.impostor.surface.clone(), true)],
                Shape::Original(lod) | Shape::Mesh(lod) => {
                    let document = items.lod_document(lod)?.with_roles_of(items);
                    drawn(document.drawn(Detail::Full, &[])?, &level.textures)
                }
            };
            let facts = Facts {
                name: format!("LOD{k}"),
                report: level.report.clone(),
            };
            shown.push((surfaces, facts));
        }
        let orders = self.chain.levels.iter();
        let orders = orders.filter_map(|level| level.order.clone());
        let longest = orders.max_by_key(|order| order.len());
        let title = (self.name(), self.screen);
        page_of(self.plant(), title, shown, longest, make)
    }
}

impl Level {
    /// A page to look at the plant and this level side by side, as [`Levels::preview_html`].
    ///
    /// # Errors
    /// As [`Levels::preview_html`].
    pub fn preview_html(&self) -> Result<String, Error> {
        self.previewed(page)
    }

    /// What such a page draws, for who has the page already.
    ///
    /// # Errors
    /// As [`Levels::preview_html`].
    pub fn preview_packed(&self, pictures: Pictures) -> Result<Packed, Error> {
        self.previewed(|preview| packed(preview, pictures))
    }

    fn previewed<T>(&self, make: impl MakePage<T>) -> Result<T, Error> {
        let plant = self.plant();
        let changes = self.material_changes();
        let document = plant.tree().lod_document_with(&self.lod, &changes)?;
        let document = document.with_roles_of(plant.tree());
        let surfaces = document.drawn(Detail::Full, &[])?;
        let materials: Vec<Option<usize>> = surfaces.iter().map(|drawn| drawn.material).collect();
        let report = LevelReport {
            texture_bytes: texture_bytes(&document, &materials, &[]),
            ..self.report()
        };
        let facts = Facts {
            name: "level".to_owned(),
            report,
        };
        let shown = vec![original(plant)?, (drawn(surfaces, &[]), facts)];
        let order = self.simplified.passes.in_one_order();
        let title = (&*plant.name(), Screen::default());
        page_of(plant, title, shown, Some(order), make)
    }
}

/// The plant itself.
fn original(plant: &Plant) -> Result<(Drawn, Facts), GltfError> {
    let facts = Facts {
        name: "original".to_owned(),
        report: plant.report(),
    };
    let surfaces = drawn(plant.tree().drawn(Detail::Full)?, &[]);
    Ok((surfaces, facts))
}

fn drawn(surfaces: Vec<DrawnSurface>, textures: &[LevelTexture]) -> Drawn {
    let shown = surfaces.into_iter().map(|mut drawn| {
        show(&mut drawn.surface, drawn.material, textures);
        (drawn.surface, drawn.is_foliage)
    });
    shown.collect()
}

/// What makes a page of what is shown, or a part of one.
trait MakePage<T>: FnOnce(&Preview<'_>) -> Result<T, PreviewError> {}

impl<T, F: FnOnce(&Preview<'_>) -> Result<T, PreviewError>> MakePage<T> for F {}

fn page_of<T>(
    plant: &Plant,
    (title, screen): (&str, Screen),
    shown: Vec<(Drawn, Facts)>,
    order: Option<RemovalOrder>,
    make: impl MakePage<T>,
) -> Result<T, Error> {
    let levels: Vec<Shown<'_>> = shown
        .iter()
        .map(|(surfaces, facts)| Shown {
            surfaces,
            facts: facts.clone(),
        })
        .collect();
    let of_order = match order {
        Some(order) => Some(with_leaves(plant, order)?),
        None => None,
    };
    let continuous = of_order.as_ref().map(|(surfaces, model)| Continuous {
        surfaces,
        foliage: plant.leaves(),
        model,
    });
    Ok(make(&Preview {
        title,
        screen,
        levels: &levels,
        continuous,
    })?)
}

/// An order, and the leaves that it is of.
fn with_leaves(
    plant: &Plant,
    order: RemovalOrder,
) -> Result<(Vec<LeafSurface>, LodModel), GltfError> {
    let leaves = plant.leaves().leaves().len();
    let mut surfaces = plant.tree().leaf_surfaces(Detail::Full)?;
    // Behind the leaves come pieces of wood, which are in surfaces of their own.
    surfaces.retain(|of| of.leaves.iter().any(|leaf| leaf.leaf.index() < leaves));
    let model = LodModel::new(order, plant.leaves()).expect("levels have orders of their leaves");
    Ok((surfaces, model))
}
