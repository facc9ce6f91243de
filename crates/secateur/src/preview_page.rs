//! The page to look at a plant beside its levels.

use glam::DVec3;
use secateur_gltf::chain::{Layout, LevelTexture};
use secateur_gltf::{Detail, Document, DrawnSurface, GltfError, LeafSurface};
use secateur_levels::chain::{LevelReport, Shape, show, texture_bytes};
use secateur_model::{LodModel, RemovalOrder, Surface};
use secateur_pages::preview::{
    Continuous, Facts, Level as Shown, Packed, Pictures, Preview, PreviewError, packed, page,
};
use secateur_runtime::Screen;

use crate::{Error, Level, Levels, Plant};

/// What is drawn of a plant or a level of it.
struct Drawn {
    /// Each with whether it is foliage.
    surfaces: Vec<(Surface, bool)>,
    /// By surface where its vertices are when the next level takes over, where they go on a way there.
    ends: Option<Vec<Vec<DVec3>>>,
}

impl From<Vec<(Surface, bool)>> for Drawn {
    /// What stays as it is.
    fn from(surfaces: Vec<(Surface, bool)>) -> Self {
        Self {
            surfaces,
            ends: None,
        }
    }
}

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
        for (k, level) in self.chain.levels.iter().enumerate() {
            let surfaces = match (&level.shape, &level.morph) {
                // The original is there already, but for its way to the next level.
                (Shape::Original(_), morph) => {
                    if morph.is_some() {
                        shown[0].0 = self.going_on(k)?;
                        shown[0].1.report.blend = level.blend;
                    }
                    continue;
                }
                (Shape::Impostor(made), _) => vec![(made.impostor.surface.clone(), true)].into(),
                (Shape::Mesh(_), Some(_)) => self.going_on(k)?,
                (Shape::Mesh(lod), None) => {
                    let document = items.lod_document(lod)?.with_roles_of(items);
                    drawn(document.drawn(Detail::Full, &[])?, &level.textures).into()
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

    /// A level as it is written, with the way to the next one.
    fn going_on(&self, level: usize) -> Result<Drawn, GltfError> {
        let document = self.document_of(level)?;
        let surfaces = drawn(document.drawn(Detail::Full, &[])?, &[]);
        let ends = document.at_end_of_morph().drawn(Detail::Full, &[])?;
        let ends = ends.into_iter().map(|drawn| drawn.surface.positions);
        Ok(Drawn {
            ends: Some(ends.collect()),
            surfaces,
        })
    }

    /// A level as a file of its own.
    fn document_of(&self, level: usize) -> Result<Document, GltfError> {
        let items = self.tree().items();
        let levels = self.written_levels();
        let mut chain = items.chain_to_bytes(self.name(), &levels[level..=level], Layout::Files)?;
        let file = chain.files.remove(0);
        let document = Document::from_bytes(&file.name, file.bytes, None)?;
        Ok(document.with_roles_of(items))
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
        let shown = vec![original(plant)?, (drawn(surfaces, &[]).into(), facts)];
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
    Ok((surfaces.into(), facts))
}

fn drawn(surfaces: Vec<DrawnSurface>, textures: &[LevelTexture]) -> Vec<(Surface, bool)> {
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
        .map(|(drawn, facts)| Shown {
            surfaces: &drawn.surfaces,
            ends: drawn.ends.as_deref(),
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
