//! What levels are made of.

use std::cell::RefCell;

use secateur_eval::Original as Measured;
use secateur_gltf::WholeTree;
use secateur_gltf::chain::LevelTexture;
use secateur_model::Lod;
use secateur_raster::OpenEngine;
use secateur_simplify::whole::{WholeLevel, WholePlant, WoodMode, simplify_keeping_wood_sharing};
use secateur_simplify::{Error, Observer, Options, Shared, Target};

use super::error::ChainError;
use super::level::{ChainLevel, Shape};
use super::look::{Drawn, Enough, Look};
use super::options::{ChainOptions, HEIGHTS_PX, Wanted};
use super::textures::{Client, Textures};
use crate::dilated_textures;

/// A level before its distance is known.
#[derive(Clone)]
pub(super) struct Made {
    pub(super) level: WholeLevel,
    pub(super) lod: Lod,
    pub(super) drawn: Drawn,
    pub(super) foliage_triangles: usize,
}

impl Made {
    pub(super) fn triangles(&self) -> usize {
        self.foliage_triangles + self.level.wood_triangles
    }
}

/// What all levels are made of and judged by.
pub(super) struct Maker<'a> {
    pub(super) tree: &'a WholeTree,
    /// Nothing where the wood stays as it is.
    plant: Option<WholePlant<'a>>,
    pub(super) options: &'a ChainOptions,
    /// How leaves are simplified, with the memory that the tree leaves for it.
    leaf_options: Options,
    engine: &'a OpenEngine,
    /// Triangles of the whole plant.
    pub(super) all: usize,
    pub(super) look: Look,
    /// Textures of the tree in whose place levels show the same with the colours of leaves in clear texels.
    dilated: Vec<LevelTexture>,
    /// The leaves, drawn in the held-out views.
    leaves: Measured<'a>,
    /// What levels share of the leaves' simplification.
    shared: RefCell<Shared>,
}

impl<'a> Maker<'a> {
    pub(super) fn new(
        tree: &'a WholeTree,
        options: &'a ChainOptions,
        engine: &'a OpenEngine,
    ) -> Result<Self, ChainError> {
        let items = tree.items();
        // Every level shows them.
        items.document().keep_images();
        let [leaves, wood] = [tree.leaves(), tree.wood()];
        let of_leaves = &options.leaves;
        let foliage = items.foliage();
        let plant = match options.wood {
            WoodMode::Keep | WoodMode::Ignore => None,
            mode => Some(WholePlant::by(
                mode, foliage, leaves, wood, of_leaves, engine,
            )?),
        };
        let (look, judging) = Look::new(items.document(), items.foliage(), leaves, options)?;
        let dilated = match options.textures {
            Textures::Fit => dilated_textures(items)?,
            Textures::Keep => Vec::new(),
        };
        let dilated = dilated.into_iter().map(|one| LevelTexture {
            material: one.material,
            texture: one.texture,
            keeps_sampler: true,
        });
        Ok(Self {
            dilated: dilated.collect(),
            all: leaves.triangles().len() + wood.triangles().len(),
            shared: RefCell::default(),
            leaf_options: Options {
                memory: items.memory_left(),
                ..options.leaves.clone()
            },
            tree,
            plant,
            options,
            engine,
            look,
            leaves: Measured::new(tree.leaves(), judging)?,
        })
    }

    /// What a client shows of levels.
    pub(super) fn client(&self) -> Client<'_> {
        let (look, [views]) = (&self.look, &self.look.views);
        Client::new(
            &look.original,
            views,
            look.sphere,
            self.options.screen,
            look.height,
        )
        .with_dilated(self.dilated.clone())
    }

    pub(super) fn level(
        &self,
        triangles: usize,
        observer: &mut Observer<'_>,
    ) -> Result<Made, ChainError> {
        let mut shared = self.shared.borrow_mut();
        let (options, shared) = (&self.leaf_options, Some(&mut *shared));
        let level = match &self.plant {
            Some(plant) => plant.level(triangles, options, self.engine, shared, observer)?,
            None => {
                let (leaves, wood) = (self.tree.leaves(), self.tree.wood());
                let options = Options {
                    target: Target::triangles(triangles as u64),
                    ..options.clone()
                };
                simplify_keeping_wood_sharing(
                    leaves,
                    wood,
                    &options,
                    self.engine,
                    shared,
                    observer,
                )?
            }
        };
        let lod = self.tree.joined(&level.leaves.lod, &level.wood);
        let document = self.tree.items().lod_document(&lod)?;
        let left = level.leaves.lod.foliage(self.tree.leaves());
        Ok(Made {
            foliage_triangles: left.triangles().len(),
            drawn: Drawn::of(&document)?,
            level,
            lod,
        })
    }

    /// The mesh of at most this many triangles that an impostor is compared with; none if the plant cannot be made so
    /// light.
    ///
    /// # Errors
    /// [`ChainError`] if the observer breaks it off.
    pub(super) fn level_if_any(
        &self,
        triangles: usize,
        observer: &mut Observer<'_>,
    ) -> Result<Option<Made>, ChainError> {
        match self.level(triangles, observer) {
            Ok(made) => Ok(Some(made)),
            Err(stopped @ ChainError::Simplify(Error::Stopped)) => Err(stopped),
            Err(_) => Ok(None),
        }
    }

    /// Of how many triangles a level has more: all of the wood, where it stays as it is.
    pub(super) fn least_triangles(&self) -> usize {
        match self.plant {
            Some(_) => 0,
            None => self.tree.wood().triangles().len(),
        }
    }

    /// The heights that levels are sought for, and where each is, in words.
    pub(super) fn heights(&self) -> Vec<(f64, String)> {
        match &self.options.wanted {
            Wanted::Triangles(_) => Vec::new(),
            Wanted::Heights(heights) => {
                let words = |height: &f64| (*height, format!("{height} pixels"));
                heights.iter().map(words).collect()
            }
            Wanted::Distances(distances) => {
                let screen = self.options.screen;
                let words = |distance: &f64| {
                    let pixels_high = screen.pixels_high(self.look.height, *distance);
                    (pixels_high, format!("{distance} m"))
                };
                distances.iter().map(words).collect()
            }
        }
    }

    /// Mean FLIP of a level where the screen shows the plant at this height in pixels, near enough to be
    /// held against the bound.
    pub(super) fn flip(&self, level: &Made, pixels_high: f64) -> f64 {
        self.flip_from(level, pixels_high, Enough::ToDecide)
    }

    /// The same as it is put down.
    pub(super) fn flip_mean(&self, level: &Made, pixels_high: f64) -> f64 {
        self.flip_from(level, pixels_high, Enough::AllViews)
    }

    fn flip_from(&self, level: &Made, pixels_high: f64, enough: Enough) -> f64 {
        let at = (pixels_high, self.options.screen);
        let most = self.options.max_flip;
        self.look.flip(&level.drawn, at, most, enough)
    }

    /// The largest of the usual heights below that of the level before at which a level is within
    /// the difference, and its FLIP there; the least if none is.
    pub(super) fn height_for(&self, level: &Made, below: f64) -> (f64, f64) {
        let mut height = f64::from(1 << 11).min(below / 2.0).min(HEIGHTS_PX[0]);
        loop {
            let flip = self.flip(level, height);
            if flip <= self.options.max_flip || height <= 32.0 {
                return (height, self.flip_mean(level, height));
            }
            height /= 2.0;
        }
    }

    pub(super) fn finished(
        &self,
        made: Made,
        height: f64,
        flip_mean: f64,
    ) -> Result<ChainLevel, ChainError> {
        let leaves = self.tree.leaves();
        let left = made.level.leaves.lod.foliage(leaves);
        let seen = self.leaves.measure(&left);
        let order = made.level.leaves.passes.in_one_order();
        let screen = self.options.screen;
        Ok(ChainLevel {
            leaves: left.leaves().len() as u64,
            foliage_triangles: made.foliage_triangles as u64,
            wood_triangles: made.level.wood_triangles as u64,
            distance: screen.distance(self.look.height, height),
            pixels_high: height,
            screen_coverage: 0.0,
            flip_mean,
            pop_flip: None,
            shadow: 0,
            silhouette_iou: Some(seen.silhouette_iou()),
            vmi_error_percent: Some(seen.vmi_error_percent()),
            order_sha256: Some(order.sha256()),
            view_count: Some(made.level.leaves.views.len()),
            order: Some(order),
            textures: Vec::new(),
            keeps_textures: true,
            texture_bytes: 0,
            as_drawn: None,
            shape: Shape::Mesh(made.lod),
        })
    }
}
