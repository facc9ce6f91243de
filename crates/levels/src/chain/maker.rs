//! What levels are made of.

use std::cell::RefCell;
use std::ops::RangeInclusive;
use std::sync::Arc;

use secateur_eval::Original as Measured;
use secateur_gltf::WholeTree;
use secateur_gltf::chain::LevelTexture;
use secateur_model::{Budget as MemoryBudget, Lod, Memory, NamedOption, Note};
use secateur_raster::OpenEngine;
use secateur_simplify::whole::{
    Budget, Sharing, WholeLevel, WoodMode, simplify_keeping_wood_sharing,
};
use secateur_simplify::{FinerLevel, Observer, Options, Shared, Target};

use super::charts::Charts;
use super::error::ChainError;
use super::level::{ChainLevel, Shape};
use super::level_choice::in_pixels;
use super::level_report::{ClearTexels, LevelReport};
use super::level_surfaces::{LevelSurfaces, retextured};
use super::look::{Drawn, LevelPicture, Look};
use super::memory::take_levels;
use super::options::{ChainOptions, Wanted};
use super::placed::Placed;
use super::smaller_images::SmallerImages;
use super::stage_clock::{ChainStage, StageClock};
use super::stands::Stands;
use super::texture_bytes::texture_bytes;
use super::textures::{Client, Textures};
use crate::{Dilated, dilated_textures};

/// Heights of plants that are taken for metres without a remark.
const USUAL_HEIGHTS_M: RangeInclusive<f64> = 0.2..=60.0;

/// A level before its distance is known.
#[derive(Clone)]
pub(super) struct Made {
    /// Of each plant of the file that is made lighter by itself.
    pub(super) parts: Vec<WholeLevel>,
    pub(super) leaves: Lod,
    pub(super) lod: Lod,
    pub(super) drawn: Drawn,
    pub(super) foliage_triangles: usize,
    /// Textures that it shows where no others are chosen: with other colours beside their charts.
    pub(super) filled: Vec<LevelTexture>,
}

impl Made {
    pub(super) fn triangles(&self) -> usize {
        self.foliage_triangles + self.wood_triangles()
    }

    pub(super) fn wood_triangles(&self) -> usize {
        self.parts.iter().map(|part| part.wood_triangles).sum()
    }
}

/// What all levels are made of and judged by.
pub(super) struct Maker<'a> {
    pub(super) tree: &'a WholeTree,
    /// Nothing where the wood stays as it is.
    stands: Option<Stands<'a>>,
    pub(super) options: &'a ChainOptions,
    /// How leaves are simplified, with the memory that the tree leaves for it.
    leaf_options: Options,
    engine: &'a OpenEngine,
    /// Triangles of the whole plant.
    pub(super) all: usize,
    pub(super) look: Look,
    /// Textures of the tree in whose place levels show the same with the colours of leaves in clear texels.
    dilated: Vec<LevelTexture>,
    /// What the plant shows of opaque textures.
    charts: Charts,
    /// Images beside base colours, as small as levels need them.
    pub(super) smaller_images: SmallerImages,
    /// The leaves, drawn in the held-out views.
    leaves: Measured<'a>,
    /// What levels share of the leaves' simplification.
    shared: RefCell<Shared>,
    /// The level in which the next ones are nested, where the wood stays as it is.
    finer: RefCell<Option<Arc<FinerLevel>>>,
}

impl<'a> Maker<'a> {
    pub(super) fn new(
        tree: &'a WholeTree,
        options: &'a ChainOptions,
        engine: &'a OpenEngine,
    ) -> Result<Self, ChainError> {
        let clock = StageClock::start();
        let items = tree.items();
        let mut memory = MemoryBudget::new(match options.leaves.memory {
            Memory::Auto => items.memory_left(),
            own => own,
        });
        take_levels(&mut memory, tree, options)?;
        // Every level shows them.
        items.document().keep_images();
        let [leaves, wood] = [tree.leaves(), tree.wood()];
        let of_leaves = &options.leaves;
        let (look, judging) = Look::new(tree, options, clock)?;
        let shared = match &options.wanted {
            Wanted::Triangles(_) => Shared::default,
            Wanted::UsualHeights | Wanted::Heights(_) | Wanted::Distances(_) => Shared::for_search,
        };
        let stands = match options.wood {
            WoodMode::Keep | WoodMode::Ignore => None,
            _ => Some(Stands::of(tree, look.judge(), of_leaves, engine, shared)?),
        };
        let dilated = match options.textures {
            Textures::Fit => dilated_textures(items)?,
            Textures::Keep => Vec::new(),
        };
        let dilated = dilated.into_iter().map(own_texture);
        let charts = match options.textures {
            Textures::Fit => Charts::of(items.document(), look.original.with_materials()),
            Textures::Keep => Charts::default(),
        };
        Ok(Self {
            charts,
            dilated: dilated.collect(),
            smaller_images: SmallerImages::default(),
            all: leaves.triangles().len() + wood.triangles().len(),
            shared: RefCell::new(shared()),
            finer: RefCell::default(),
            leaf_options: Options {
                memory: memory.memory(),
                most_fit_px: match &options.wanted {
                    Wanted::Triangles(_) => options.leaves.most_fit_px,
                    Wanted::UsualHeights | Wanted::Heights(_) | Wanted::Distances(_) => {
                        options.leaves.effort.work().search_fit_px
                    }
                },
                ..options.leaves.clone()
            },
            tree,
            stands,
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
            &look.original.surfaces,
            views,
            look.sphere,
            self.options.screen,
            look.size,
        )
        .with_dilated(self.dilated.clone())
    }

    pub(super) fn level(
        &self,
        budget: impl Into<Budget>,
        observer: &mut Observer<'_>,
    ) -> Result<Made, ChainError> {
        let budget = budget.into();
        let make = || self.level_within(budget, observer);
        self.look.clock.time(ChainStage::Simplify, make)
    }

    fn level_within(
        &self,
        budget: Budget,
        observer: &mut Observer<'_>,
    ) -> Result<Made, ChainError> {
        let options = &self.leaf_options;
        let parts = match &self.stands {
            Some(stands) => stands.level(budget, options, self.engine, observer)?,
            None => {
                let (leaves, wood) = (self.tree.leaves(), self.tree.wood());
                let options = Options {
                    target: Target::triangles(budget.triangles as u64),
                    finer: self.finer.borrow().clone(),
                    ..options.clone()
                };
                let shared = &mut *self.shared.borrow_mut();
                let level = simplify_keeping_wood_sharing(
                    leaves,
                    wood,
                    &options,
                    self.engine,
                    Some(shared),
                    observer,
                )?;
                vec![level]
            }
        };
        self.made(parts)
    }

    /// The ways to share triangles that are worth trying, where these are for plants of leaves and wood. Levels that are
    /// nested have no others: even collapses know nothing of what is gone.
    pub(super) fn sharings(&self, of_leaves_and_wood: &[Sharing]) -> Vec<Sharing> {
        let is_nested = self.options.morph && !self.tree.leaves().leaves().is_empty();
        match self.stands.as_ref().filter(|_| !is_nested) {
            Some(stands) => stands.sharings(of_leaves_and_wood),
            None => of_leaves_and_wood.to_vec(),
        }
    }

    /// From now on levels have only what this one has; anything where there is none. For levels that are to be nested:
    /// what others share is of no use then.
    pub(super) fn nest_in(&self, finer: Option<&Made>) {
        match &self.stands {
            Some(stands) => stands.nest_in(finer.map(|made| &made.parts[..])),
            None => {
                let leaves = self.tree.leaves();
                let finer = finer.map(|made| FinerLevel::of(&made.parts[0], leaves));
                self.finer.replace(finer.map(Arc::new));
                self.shared.borrow_mut().forget_orders();
            }
        }
    }

    /// Levels of the plants of the file as a level of the whole.
    pub(super) fn made(&self, parts: Vec<WholeLevel>) -> Result<Made, ChainError> {
        let [leaves, wood] = match (&self.stands, &parts[..]) {
            (Some(stands), parts) => stands.joined(parts),
            (None, parts) => [parts[0].leaves.lod.clone(), parts[0].wood.clone()],
        };
        let lod = self.tree.joined(&leaves, &wood);
        let document = self.tree.items().lod_document(&lod)?;
        let left = leaves.foliage(self.tree.leaves());
        let mut drawn = Drawn::of(&document)?;
        let filled = self.charts.filled_for(drawn.level.with_materials());
        let filled: Vec<LevelTexture> = filled.into_iter().map(own_texture).collect();
        drawn.level.surfaces = retextured(&drawn.level, &filled);
        Ok(Made {
            foliage_triangles: left.triangles().len(),
            drawn,
            filled,
            parts,
            leaves,
            lod,
        })
    }

    /// The mesh of at most this many triangles that an impostor is compared with; none if the plant cannot be made so
    /// light.
    ///
    /// # Errors
    /// [`ChainError`] for anything else that keeps it from being made.
    pub(super) fn level_if_any(
        &self,
        triangles: usize,
        observer: &mut Observer<'_>,
    ) -> Result<Option<Made>, ChainError> {
        match self.level(triangles, observer) {
            Ok(made) => Ok(Some(made)),
            Err(error) if error.is_not_so_light() => Ok(None),
            Err(error) => Err(error),
        }
    }

    /// Of how many triangles a level has more: all of the wood, where it stays as it is.
    pub(super) fn least_triangles(&self) -> usize {
        match self.stands {
            Some(_) => 0,
            None => self.tree.wood().triangles().len(),
        }
    }

    /// What has to be said of a plant before levels of it are made.
    ///
    /// # Errors
    /// [`ChainError::InsidePlant`] if a distance is inside the crown.
    pub(super) fn remarks(&self) -> Result<Vec<Note>, ChainError> {
        let unit_m = self.size_m() / self.look.size;
        if let Wanted::Distances(distances) = &self.options.wanted
            && let Some(nearest) = distances.first()
        {
            let reach_m = self.look.reach * unit_m;
            if *nearest <= reach_m {
                return Err(ChainError::InsidePlant {
                    distance_m: *nearest,
                    reach_m,
                    least_m: (reach_m * 11.0).ceil() / 10.0,
                });
            }
        }
        let height_m = self.look.height * unit_m;
        let (extent_m, way) = match self.size_m() > 1.01 * height_m {
            true => (self.size_m(), "wide"),
            false => (height_m, "high"),
        };
        let is_usual = USUAL_HEIGHTS_M.contains(&extent_m);
        let mut remarks = match self.look.judge().plant_count() {
            1 => Vec::new(),
            count => vec![
                Note::from(format!(
                    "{count} plants stand apart: each is judged by itself, and the worst one speaks; "
                ))
                .naming(NamedOption::AsOne)
                .then(" takes them for one"),
            ],
        };
        if self.options.plant_height_m.is_none() && !is_usual {
            remarks.push(
                Note::from(format!(
                    "the plant is {extent_m:.3} units {way}, taken for metres: "
                ))
                .naming(NamedOption::PlantHeight)
                .then(" says how high it really is"),
            );
        }
        Ok(remarks)
    }

    /// The largest extent of the plant in metres: units of the file, unless its height was given.
    pub(super) fn size_m(&self) -> f64 {
        let unit_m = self.options.plant_height_m.map(|m| m / self.look.height);
        self.look.size * unit_m.filter(|unit| unit.is_finite()).unwrap_or(1.0)
    }

    /// From how far off the screen shows the plant at this height in pixels, in metres.
    pub(super) fn distance_m(&self, pixels_high: f64) -> f64 {
        self.options.screen.distance(self.size_m(), pixels_high)
    }

    /// The heights that levels are sought for, and where each is, in words.
    pub(super) fn heights(&self) -> Vec<(f64, String)> {
        match &self.options.wanted {
            Wanted::Triangles(_) => Vec::new(),
            Wanted::UsualHeights | Wanted::Heights(_) => {
                let heights = self.options.heights_px();
                let words = |height| (height, in_pixels(height));
                heights.into_iter().map(words).collect()
            }
            Wanted::Distances(distances) => {
                let screen = self.options.screen;
                let words = |distance: &f64| {
                    let pixels_high = screen.pixels_high(self.size_m(), *distance);
                    (pixels_high, format!("{distance} m"))
                };
                distances.iter().map(words).collect()
            }
        }
    }

    /// A level of the chain, and what is drawn of it.
    pub(super) fn finished(
        &self,
        placed: Placed,
    ) -> Result<(LevelPicture, ChainLevel), ChainError> {
        let Placed {
            made,
            chosen,
            range: [height, _],
            difference,
        } = placed;
        let leaves = self.tree.leaves();
        let left = made.leaves.foliage(leaves);
        let seen = self.leaves.measure(&left);
        // Several plants have an order each, and none together.
        let [of_first, ..] = &made.parts[..] else {
            unreachable!("a level is one of at least one plant")
        };
        let order = of_first.leaves.passes.in_one_order();
        let is_alone = made.parts.len() == 1;
        let materials = &made.drawn.level.materials;
        let document = self.tree.items().document();
        let texture_bytes = texture_bytes(document, materials, &chosen.textures);
        let picture = LevelPicture::Mesh(LevelSurfaces {
            surfaces: retextured(&made.drawn.level, &chosen.textures),
            materials: materials.clone(),
        });
        let [of_leaves, of_wood] =
            [made.foliage_triangles, made.wood_triangles()].map(|count| count as u64);
        let report = LevelReport {
            leaves: left.leaves().len() as u64,
            triangles: of_leaves + of_wood,
            foliage_triangles: of_leaves,
            wood_triangles: of_wood,
            distance: self.distance_m(height),
            pixels_high: height,
            flip_mean: self.look.flip_mean(&picture, (height, self.options.screen)),
            difference,
            silhouette_iou: Some(seen.silhouette_iou()),
            vmi_error_percent: Some(seen.vmi_error_percent()),
            order_sha256: is_alone.then(|| order.sha256()),
            view_count: Some(of_first.leaves.views.len()),
            leaf_textures: match chosen.keeps_textures {
                true => Textures::Keep,
                false => Textures::Fit,
            },
            clear_texels: Some(clear_texels(&chosen.textures)),
            texture_bytes,
            as_drawn: Some(chosen.as_drawn),
            ..LevelReport::default()
        };
        let level = ChainLevel {
            report,
            shadow: 0,
            order: is_alone.then_some(order),
            textures: chosen.textures,
            morph: None,
            shape: Shape::Mesh(made.lod),
        };
        Ok((picture, level))
    }

    /// The plant itself as a level, from distance 0 on.
    pub(super) fn original(&self) -> ChainLevel {
        let items = self.tree.items();
        let textures = self.dilated.clone();
        let materials = &self.look.original.materials;
        let wood_triangles = self.tree.wood().triangles().len() as u64;
        ChainLevel {
            report: LevelReport {
                clear_texels: Some(clear_texels(&textures)),
                texture_bytes: texture_bytes(items.document(), materials, &textures),
                ..LevelReport::of_plant(self.tree.leaves(), wood_triangles)
            },
            shadow: 0,
            order: None,
            textures,
            morph: None,
            shape: Shape::Original(Lod::original(items.foliage().leaves().len())),
        }
    }
}

/// A texture in which colours were spread, as that of a level.
fn own_texture(spread: Dilated) -> LevelTexture {
    LevelTexture {
        image: None,
        material: spread.material,
        texture: spread.texture,
        keeps_sampler: true,
    }
}

/// Which colours clear texels have in a level of these textures of its own; opaque ones have no clear texels.
fn clear_texels(textures: &[LevelTexture]) -> ClearTexels {
    let is_clear = |texel: &[u8]| texel[3] < u8::MAX;
    let has_clear = |own: &LevelTexture| own.texture.rgba.chunks_exact(4).any(is_clear);
    let mut base_colors = textures.iter().filter(|own| own.image.is_none());
    match base_colors.any(has_clear) {
        true => ClearTexels::Dilate,
        false => ClearTexels::Keep,
    }
}
