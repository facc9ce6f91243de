//! Chains of levels of detail of whole plants: which levels, and for which distances.

use std::cell::RefCell;
use std::collections::BTreeMap;

use secateur_eval::{Judging, Original as Measured, Pictures};
use secateur_gltf::chain::LevelTexture;
use secateur_gltf::{Detail, Document, WholeTree};
use secateur_model::{Lod, Surface};
use secateur_raster::{OpenEngine, View, ViewSet};
use secateur_simplify::whole::{WholeLevel, WholePlant};
use secateur_simplify::{Amount, Error as SimplifyError, Observer, Options, Shared};

mod ladder;
mod leaf_texture;
mod textures;

use crate::Screen;
use crate::impostor::judge::{Judge, best_crossed, flip, largest_flip};
use crate::impostor::{Choice, Impostor};
use ladder::Ladder;
use textures::{Chosen, Client, LevelSurfaces, bytes_of, end_of, texture_bytes};
pub use textures::{LevelAsDrawn, Textures, show};

/// Pictures that levels are judged by have at most this many pixels a side, those of `measure`: to
/// draw larger ones would take longer than to make the level.
const MOST_PICTURE_PX: f64 = 256.0;

/// Least height of such a picture in pixels: in fewer, FLIP has no room for its filters.
const LEAST_PICTURE_PX: f64 = 48.0;

/// The tangent of half the field of view that just holds a sphere from 3 radii away: 1 / sqrt 8.
const TIGHT_TANGENT: f64 = 0.353_553_390_593_273_8;

/// Every how many of the 48 held-out views a level is judged from: six, of all four sets.
const VIEW_STEP: usize = 8;

/// A level that is sought has at most this share of the triangles of the one before it: to switch
/// for less would not pay.
const MOST_OF_BEFORE: f64 = 2.0 / 3.0;

/// Heights on the screen for which levels are made where nothing else is asked for.
pub const HEIGHTS_PX: [f64; 4] = [1080.0, 540.0, 270.0, 135.0];

/// The FLIP that a level may have at the height from which it is seen.
pub const MAX_FLIP: f64 = 0.05;

/// Which levels a chain has.
#[derive(Clone, Debug, PartialEq)]
pub enum Wanted {
    /// Levels of these numbers of triangles of the whole plant, finest first.
    Triangles(Vec<Amount>),
    /// For each of these heights on the screen in pixels, the largest first, the fewest triangles
    /// within the difference.
    Heights(Vec<f64>),
    /// The same for these distances in units of the file (metres), the nearest first.
    Distances(Vec<f64>),
}

/// How a chain is made.
#[derive(Clone, Debug, PartialEq)]
pub struct ChainOptions {
    /// Which levels are made: shares, numbers of triangles, or heights.
    pub wanted: Wanted,
    /// The screen and camera that distances are for.
    pub screen: Screen,
    /// The FLIP that a level may have at the height from which it is seen, 0 to 1.
    pub max_flip: f64,
    /// How leaves are simplified; its target is not looked at.
    pub leaves: Options,
    /// Which impostor the chain ends in.
    pub impostor: Choice,
    /// How many levels coarser what casts a level's shadow is, 0 to 2.
    pub shadow_steps: usize,
    /// The largest FLIP in any view between a level and the next where they switch; a level that
    /// would differ more from the one before it is left out.
    pub max_pop: Option<f64>,
    /// Which textures leaves have.
    pub textures: Textures,
}

/// A level of a chain, and from where it is to be seen.
#[derive(Clone, Debug)]
pub struct ChainLevel {
    /// What is drawn.
    pub shape: Shape,
    /// Leaves that are left.
    pub leaves: u64,
    /// Triangles that leaves have in this level.
    pub foliage_triangles: u64,
    /// Triangles that wood has in this level.
    pub wood_triangles: u64,
    /// From how far off it is used, in units of the file (metres).
    pub distance: f64,
    /// How many pixels high the screen shows the plant there.
    pub pixels_high: f64,
    /// The least share of the screen's height at which it is drawn, before the next level takes
    /// over; 0 for the last.
    pub screen_coverage: f64,
    /// Mean FLIP of the whole plant against the original at that height.
    pub flip_mean: f64,
    /// The largest FLIP of any view between it and the level before where they switch; none for
    /// the first.
    pub pop_flip: Option<f64>,
    /// The level that casts its shadow, counted from 0.
    pub shadow: usize,
    /// Outline of the leaves against the original's, by six of the held-out views in 256 x 256
    /// pixels; none for impostors.
    pub silhouette_iou: Option<f64>,
    /// VMI error of the leaves by the same, in per cent; none for impostors.
    pub vmi_error_percent: Option<f64>,
    /// SHA-256 of all that was done to the leaves; none for impostors.
    pub order_sha256: Option<String>,
    /// Base colour textures of its own; empty where it has those of the tree.
    pub textures: Vec<LevelTexture>,
    /// What all images of its materials take, four bytes a texel, with mips where they are read.
    pub texture_bytes: u64,
    /// How much of it a client shows; none for octahedral views, which only their sampler shows.
    pub as_drawn: Option<LevelAsDrawn>,
}

/// What a level is.
#[derive(Clone, Debug)]
pub enum Shape {
    /// The plant with fewer triangles: a LOD of [`WholeTree::items`].
    Mesh(Lod),
    /// A picture of it.
    Impostor(Box<ImpostorLevel>),
}

/// An impostor, and what it was chosen against.
#[derive(Clone, Debug)]
pub struct ImpostorLevel {
    /// What is drawn.
    pub impostor: Impostor,
    /// Triangles of the mesh that would be drawn there instead.
    pub mesh_triangles: u64,
    /// That mesh's FLIP by the judge of the impostor, who stands as far off as it is seen from.
    pub mesh_flip_mean: f64,
}

impl ChainLevel {
    /// Triangles of the whole plant.
    pub fn triangles(&self) -> u64 {
        match &self.shape {
            Shape::Mesh(_) => self.foliage_triangles + self.wood_triangles,
            Shape::Impostor(level) => level.impostor.surface.triangles.len() as u64,
        }
    }
}

/// A chain, finest level first.
#[derive(Clone, Debug)]
pub struct Chain {
    /// The levels, finest first; at most 8.
    pub levels: Vec<ChainLevel>,
    /// What was asked for and left out, and the like, a sentence each.
    pub notes: Vec<String>,
}

/// Why there is no chain.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ChainError {
    /// The plant can't be simplified.
    #[error(transparent)]
    Simplify(#[from] SimplifyError),
    /// A level can't be written or drawn.
    #[error(transparent)]
    Gltf(#[from] secateur_gltf::GltfError),
    /// A level can't be judged.
    #[error(transparent)]
    Measure(#[from] secateur_eval::MeasureError),
    /// The levels that are asked for are none, too many or in no order.
    #[error("{0}")]
    Wanted(String),
}

/// The most levels of a chain, as engines have it.
pub const MAX_LEVELS: usize = 8;

impl ChainOptions {
    /// Whether there are levels, not too many, ever coarser ones, and all numbers are in range.
    ///
    /// # Errors
    /// [`ChainError::Wanted`] if not.
    pub fn check(&self) -> Result<(), ChainError> {
        let refused = |what: &str| Err(ChainError::Wanted(what.to_owned()));
        let (count, falls) = match &self.wanted {
            Wanted::Triangles(amounts) => {
                let of = |amount: &Amount| match amount {
                    Amount::Count(count) => *count as f64,
                    Amount::Share(share) => *share,
                };
                (
                    amounts.len(),
                    amounts.windows(2).all(|w| of(&w[0]) > of(&w[1])),
                )
            }
            Wanted::Heights(heights) => (heights.len(), heights.windows(2).all(|w| w[0] > w[1])),
            Wanted::Distances(distances) => {
                (distances.len(), distances.windows(2).all(|w| w[0] < w[1]))
            }
        };
        let is_above_zero = |x: f64| x.is_finite() && x > 0.0;
        if let Wanted::Heights(all) | Wanted::Distances(all) = &self.wanted
            && !all.iter().all(|x| is_above_zero(*x))
        {
            return refused("heights and distances of levels must be above 0");
        }
        if !is_above_zero(self.screen.height_px) {
            return refused("a screen must be higher than 0 pixels");
        }
        let degrees = self.screen.field_of_view_degrees;
        if !(is_above_zero(degrees) && degrees < 180.0) {
            return refused("a field of view must be above 0 and below 180 degrees");
        }
        match (count, falls) {
            (0, _) => refused("a chain needs at least one level"),
            (count, _) if count > MAX_LEVELS => Err(ChainError::Wanted(format!(
                "{count} levels were asked for: a chain has at most {MAX_LEVELS}"
            ))),
            // After numbers of triangles an impostor is a level more.
            (MAX_LEVELS, _)
                if self.impostor != Choice::None && matches!(self.wanted, Wanted::Triangles(_)) =>
            {
                Err(ChainError::Wanted(format!(
                    "an impostor after {MAX_LEVELS} levels is one too many: a chain has at most {MAX_LEVELS}"
                )))
            }
            (_, false) if matches!(self.wanted, Wanted::Distances(_)) => {
                refused("distances must rise: each level is farther off than the one before")
            }
            (_, false) => {
                refused("levels go from fine to coarse: each must be less than the one before")
            }
            _ if self.shadow_steps > 2 => {
                refused("what casts a shadow is at most two levels coarser")
            }
            _ if self.max_pop.is_some_and(|pop| !(pop > 0.0 && pop <= 1.0)) => {
                refused("the FLIP that a switch may show must be above 0 and at most 1")
            }
            _ if !(self.max_flip > 0.0 && self.max_flip <= 1.0) => {
                refused("the FLIP that a level may have must be above 0 and at most 1")
            }
            _ => Ok(()),
        }
    }
}

/// Makes a chain of a tree.
///
/// # Errors
/// [`ChainError`] if the levels are none, or the tree can't be simplified.
pub fn chain(
    tree: &WholeTree,
    options: &ChainOptions,
    engine: &OpenEngine,
    observer: &mut Observer<'_>,
) -> Result<Chain, ChainError> {
    options.check()?;
    let maker = Maker::new(tree, options, engine)?;
    let mut notes = Vec::new();
    let mut made: Vec<(Made, f64, f64)> = Vec::new();
    match &options.wanted {
        Wanted::Triangles(amounts) => {
            for amount in amounts {
                let level = maker.level(amount.of(maker.all), observer)?;
                if is_no_less(&level, made.last().map(|(level, ..)| level), maker.all) {
                    notes.push(format!(
                        "a level of {} triangles is left out: it would be as large as the one before",
                        level.triangles()
                    ));
                    continue;
                }
                let before = made.last().map_or(f64::INFINITY, |(_, height, _)| *height);
                let (height, flip) = maker.height_for(&level, before)?;
                made.push((level, height, flip));
            }
        }
        Wanted::Heights(_) | Wanted::Distances(_) => {
            let mut ladder = Ladder::new(&maker);
            let mut first = 0;
            for (height, place) in maker.heights() {
                let rung = ladder.lightest(height, first, observer)?;
                let level = ladder.level(rung, observer)?;
                if let Some((before, ..)) = made.last()
                    && level.triangles() as f64 > MOST_OF_BEFORE * before.triangles() as f64
                {
                    notes.push(format!(
                        "no level begins at {place}: the lightest within the difference has {} triangles, which saves less than a third of the {} before",
                        level.triangles(),
                        before.triangles()
                    ));
                    continue;
                }
                let flip = maker.flip(level, height)?;
                made.push((level.clone(), height, flip));
                first = rung;
            }
        }
    }
    let impostor = maker.impostor(&made, &mut notes)?;
    if let Some((_, height, _)) = &impostor {
        made.retain(|(_, begins, _)| begins > height);
    }
    let mut levels = Vec::new();
    for (level, height, flip) in made {
        let pictured = Pictured::Mesh(level.drawn.clone());
        levels.push((pictured, maker.finished(level, height, flip)?));
    }
    if let Some((level, height, flip)) = impostor {
        let pictured = Pictured::Impostor(level.impostor.clone());
        levels.push((pictured, maker.finished_impostor(level, height, flip)));
    }
    let levels = maker.without_pops(levels, &mut notes)?;
    let mut levels = maker.with_textures(levels)?;
    let ends: Vec<f64> = levels
        .iter()
        .skip(1)
        .map(|level| level.pixels_high)
        .collect();
    let is_mesh = |level: &ChainLevel| matches!(level.shape, Shape::Mesh(_));
    let last_mesh = levels.iter().rposition(is_mesh).unwrap_or(0);
    for (index, level) in levels.iter_mut().enumerate() {
        let end = ends.get(index).copied().unwrap_or(0.0);
        level.screen_coverage = end / options.screen.height_px;
        // A picture casts the shadow of a picture.
        level.shadow = match level.shape {
            Shape::Mesh(_) => (index + options.shadow_steps).min(last_mesh),
            Shape::Impostor(_) => index,
        };
    }
    if levels.is_empty() {
        return Err(ChainError::Wanted(
            "no level would have fewer triangles than the tree has".to_owned(),
        ));
    }
    Ok(Chain { levels, notes })
}

/// What of a level a picture is drawn of.
enum Pictured {
    Mesh(LevelSurfaces),
    Impostor(Impostor),
}

impl Pictured {
    fn pictures(&self, judge: &Judge) -> Pictures {
        match self {
            Self::Mesh(level) => judge.of_surfaces(&level.surfaces),
            Self::Impostor(impostor) => judge.of_impostor(impostor),
        }
    }
}

fn is_no_less(level: &Made, before: Option<&Made>, all: usize) -> bool {
    match before {
        Some(before) => level.triangles() >= before.triangles(),
        // The first level may be the tree as it is.
        None => level.triangles() > all,
    }
}

/// A level before its distance is known.
#[derive(Clone)]
struct Made {
    level: WholeLevel,
    lod: Lod,
    drawn: LevelSurfaces,
    foliage_triangles: usize,
    /// Mean FLIP by the side of the pictures in pixels, as far as it is known.
    flips: RefCell<BTreeMap<u32, f64>>,
}

impl Made {
    fn triangles(&self) -> usize {
        self.foliage_triangles + self.level.wood_triangles
    }
}

/// What all levels are made of and judged by.
struct Maker<'a> {
    tree: &'a WholeTree,
    plant: WholePlant<'a>,
    options: &'a ChainOptions,
    /// How leaves are simplified, with the memory that the tree leaves for it.
    leaf_options: Options,
    engine: &'a OpenEngine,
    /// Triangles of the whole plant.
    all: usize,
    original: Vec<Surface>,
    /// Pictures of that by their side in pixels: most heights need the same.
    originals: RefCell<BTreeMap<u32, Pictures>>,
    /// The leaves, drawn in the held-out views.
    leaves: Measured<'a>,
    /// For pictures: one set of some views of each.
    views: [ViewSet; 1],
    /// What levels share of the leaves' simplification.
    shared: RefCell<Shared>,
    /// The plant's height, and how much of a picture's height it takes, as shares of the side.
    height: f64,
    picture_share: f64,
}

impl<'a> Maker<'a> {
    fn new(
        tree: &'a WholeTree,
        options: &'a ChainOptions,
        engine: &'a OpenEngine,
    ) -> Result<Self, ChainError> {
        let plant = WholePlant::new(tree.items().foliage(), tree.leaves(), tree.wood(), engine)?;
        let items = tree.items().foliage();
        let held_out = Judging::held_out(items)?;
        let held_out = held_out.rigs.iter().flat_map(ViewSet::views);
        let held_out: Vec<View> = held_out.step_by(VIEW_STEP).copied().collect();
        let views = held_out.iter().map(tight).collect();
        let judging = Judging {
            rigs: vec![ViewSet::new(held_out)],
            resolution: MOST_PICTURE_PX as u32,
        };
        let corners = items.triangles().iter().flat_map(|t| t.corners);
        let (low, high) = corners.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), c| {
            (low.min(c.y), high.max(c.y))
        });
        let radius = items.bounding_sphere().map_or(0.0, |sphere| sphere.radius);
        // The views stand at 3 radii.
        let seen = 6.0 * radius * TIGHT_TANGENT;
        Ok(Self {
            all: plant.triangle_count(),
            original: surfaces(tree.items().document())?.surfaces,
            originals: RefCell::default(),
            shared: RefCell::default(),
            views: [ViewSet::new(views)],
            height: high - low,
            picture_share: (high - low) / seen,
            leaf_options: Options {
                memory: tree.items().memory_left(),
                ..options.leaves.clone()
            },
            tree,
            plant,
            options,
            engine,
            leaves: Measured::new(tree.leaves(), judging)?,
        })
    }

    fn level(&self, triangles: usize, observer: &mut Observer<'_>) -> Result<Made, ChainError> {
        let mut shared = self.shared.borrow_mut();
        let level = self.plant.level(
            triangles,
            &self.leaf_options,
            self.engine,
            Some(&mut *shared),
            observer,
        )?;
        let lod = self.tree.joined(&level.leaves.lod, &level.wood);
        let bytes = self.tree.items().lod_to_bytes(&lod)?;
        let original = self.tree.items().document();
        let memory = original.memory();
        let document =
            Document::from_bytes_within(original.name(), bytes, original.folder(), memory)?;
        let left = level.leaves.lod.foliage(self.tree.leaves());
        Ok(Made {
            foliage_triangles: left.triangles().len(),
            drawn: surfaces(&document)?,
            flips: RefCell::default(),
            level,
            lod,
        })
    }

    /// The heights that levels are sought for, and where each is, in words.
    fn heights(&self) -> Vec<(f64, String)> {
        match &self.options.wanted {
            Wanted::Triangles(_) => Vec::new(),
            Wanted::Heights(heights) => {
                let words = |height: &f64| (*height, format!("{height} pixels"));
                heights.iter().map(words).collect()
            }
            Wanted::Distances(distances) => {
                let screen = self.options.screen;
                let words = |distance: &f64| {
                    let pixels_high = screen.pixels_high(self.height, *distance);
                    (pixels_high, format!("{distance} m"))
                };
                distances.iter().map(words).collect()
            }
        }
    }

    /// Mean FLIP of a level where the screen shows the plant at this height in pixels.
    fn flip(&self, level: &Made, pixels_high: f64) -> Result<f64, ChainError> {
        let side = (pixels_high / self.picture_share).clamp(LEAST_PICTURE_PX, MOST_PICTURE_PX);
        let side = side.round() as u32;
        if let Some(flip) = level.flips.borrow().get(&side) {
            return Ok(*flip);
        }
        let mut originals = self.originals.borrow_mut();
        let original = originals
            .entry(side)
            .or_insert_with(|| Pictures::of_size(&self.original, &self.views, side));
        let found = original.measure(&Pictures::of_size(&level.drawn.surfaces, &self.views, side));
        let flip = found.overall.get("flip_mean").unwrap_or(f64::NAN);
        level.flips.borrow_mut().insert(side, flip);
        Ok(flip)
    }

    /// The largest of the usual heights below that of the level before at which a level is within
    /// the difference, and its FLIP there; the least if none is.
    fn height_for(&self, level: &Made, below: f64) -> Result<(f64, f64), ChainError> {
        let mut height = f64::from(1 << 11).min(below / 2.0).min(HEIGHTS_PX[0]);
        loop {
            let flip = self.flip(level, height)?;
            if flip <= self.options.max_flip || height <= 32.0 {
                return Ok((height, flip));
            }
            height /= 2.0;
        }
    }

    fn judge(&self, pixels_high: f64) -> Result<Judge, ChainError> {
        let sphere = self.tree.items().foliage().bounding_sphere();
        let sphere = sphere.ok_or(secateur_eval::MeasureError::NoFoliage)?;
        let screen = self.options.screen;
        Ok(Judge::new(
            &self.views[0],
            sphere,
            self.height,
            screen,
            pixels_high,
        ))
    }

    /// The impostor that a chain ends in, from which height on, and its FLIP there.
    fn impostor(
        &self,
        made: &[(Made, f64, f64)],
        notes: &mut Vec<String>,
    ) -> Result<Option<(ImpostorLevel, f64, f64)>, ChainError> {
        let choice = self.options.impostor;
        let Some((mesh, begins, _)) = made.last().filter(|_| choice != Choice::None) else {
            return Ok(None);
        };
        // Where heights are asked for, the last of them; else where the last level is half as high.
        let (height, place) = self.heights().pop().unwrap_or_else(|| {
            let height = begins / 2.0;
            (height, format!("{height} pixels"))
        });
        let judge = self.judge(height)?;
        let original = judge.of_surfaces(&self.original);
        let of_mesh = flip(&original, &judge.of_surfaces(&mesh.drawn.surfaces));
        let found = match choice {
            Choice::Octahedral => Impostor::octahedral(&self.original, height).map(|made| {
                let flip = flip(&original, &judge.of_impostor(&made));
                (made, flip)
            }),
            _ => best_crossed(&self.original, &original, &judge, height),
        };
        let Some((impostor, flip)) = found else {
            return Ok(None);
        };
        let is_lighter = impostor.surface.triangles.len() < mesh.triangles();
        let is_near = flip <= self.options.max_flip || flip <= of_mesh;
        if choice == Choice::Auto && !(is_lighter && is_near) {
            notes.push(format!(
                "no impostor at {place}: crossed planes have a FLIP of {flip:.3} there, the mesh of {} triangles {of_mesh:.3}",
                mesh.triangles()
            ));
            return Ok(None);
        }
        let level = ImpostorLevel {
            impostor,
            mesh_triangles: mesh.triangles() as u64,
            mesh_flip_mean: of_mesh,
        };
        Ok(Some((level, height, flip)))
    }

    /// The levels with what switching to each shows, but for those that show more than is wanted.
    fn without_pops(
        &self,
        levels: Vec<(Pictured, ChainLevel)>,
        notes: &mut Vec<String>,
    ) -> Result<Vec<(Pictured, ChainLevel)>, ChainError> {
        let mut kept: Vec<(Pictured, ChainLevel)> = Vec::new();
        for (pictured, mut level) in levels {
            if let Some((before, _)) = kept.last() {
                let judge = self.judge(level.pixels_high)?;
                let pop = largest_flip(&before.pictures(&judge), &pictured.pictures(&judge));
                if self.options.max_pop.is_some_and(|most| pop > most) {
                    notes.push(format!(
                        "a level of {} triangles is left out: to switch to it at {:.0} pixels would show a FLIP of {pop:.3}",
                        level.triangles(),
                        level.pixels_high
                    ));
                    continue;
                }
                level.pop_flip = Some(pop);
            }
            kept.push((pictured, level));
        }
        Ok(kept)
    }

    /// The levels with textures for where they are seen.
    fn with_textures(
        &self,
        levels: Vec<(Pictured, ChainLevel)>,
    ) -> Result<Vec<ChainLevel>, ChainError> {
        let items = self.tree.items();
        let sphere = items.foliage().bounding_sphere();
        let sphere = sphere.ok_or(secateur_eval::MeasureError::NoFoliage)?;
        let [views] = &self.views;
        let client = Client::new(
            &self.original,
            views,
            sphere,
            self.options.screen,
            self.height,
        );
        let begins: Vec<f64> = levels.iter().map(|(_, level)| level.pixels_high).collect();
        let mut finished = Vec::new();
        for (number, (pictured, mut level)) in levels.into_iter().enumerate() {
            let begin = level.pixels_high;
            let range = [begin, end_of(begin, begins.get(number + 1).copied())];
            match pictured {
                Pictured::Mesh(drawn) => {
                    let wanted = self.options.textures;
                    let Chosen { textures, as_drawn } =
                        client.choose(&drawn, range, wanted, number == 0);
                    level.texture_bytes =
                        texture_bytes(items.document(), &drawn.materials, &textures);
                    level.textures = textures;
                    level.as_drawn = Some(as_drawn);
                }
                Pictured::Impostor(impostor) => {
                    let material = &impostor.surface.material;
                    let normals = material.finish.normal_map.as_ref();
                    let all = material
                        .texture
                        .iter()
                        .chain(normals.map(|map| &map.texture));
                    level.texture_bytes = all.map(|texture| bytes_of(texture)).sum();
                    if !impostor.needs_sampler() {
                        let surfaces = [impostor.surface];
                        level.as_drawn = Some(client.as_drawn(&surfaces, range));
                    }
                }
            }
            finished.push(level);
        }
        Ok(finished)
    }

    fn finished_impostor(&self, level: ImpostorLevel, height: f64, flip_mean: f64) -> ChainLevel {
        ChainLevel {
            shape: Shape::Impostor(Box::new(level)),
            leaves: 0,
            foliage_triangles: 0,
            wood_triangles: 0,
            distance: self.options.screen.distance(self.height, height),
            pixels_high: height,
            screen_coverage: 0.0,
            flip_mean,
            pop_flip: None,
            shadow: 0,
            silhouette_iou: None,
            vmi_error_percent: None,
            order_sha256: None,
            textures: Vec::new(),
            texture_bytes: 0,
            as_drawn: None,
        }
    }

    fn finished(&self, made: Made, height: f64, flip_mean: f64) -> Result<ChainLevel, ChainError> {
        let leaves = self.tree.leaves();
        let left = made.level.leaves.lod.foliage(leaves);
        let seen = self.leaves.measure(&left);
        let screen = self.options.screen;
        Ok(ChainLevel {
            leaves: left.leaves().len() as u64,
            foliage_triangles: made.foliage_triangles as u64,
            wood_triangles: made.level.wood_triangles as u64,
            distance: screen.distance(self.height, height),
            pixels_high: height,
            screen_coverage: 0.0,
            flip_mean,
            pop_flip: None,
            shadow: 0,
            silhouette_iou: Some(seen.silhouette_iou()),
            vmi_error_percent: Some(seen.vmi_error_percent()),
            order_sha256: Some(made.level.leaves.passes.in_one_order().sha256()),
            textures: Vec::new(),
            texture_bytes: 0,
            as_drawn: None,
            shape: Shape::Mesh(made.lod),
        })
    }
}

/// The same view with a field of view that just holds the plant: what is far from it on the screen
/// is no part of how it looks.
fn tight(view: &View) -> View {
    let ahead = view.eye() + view.forward() * (view.near() * 1e3);
    let tight = View::look_at(view.eye(), ahead, view.up(), TIGHT_TANGENT, view.near());
    tight.unwrap_or(*view)
}

/// All that is drawn of a file.
fn surfaces(document: &Document) -> Result<LevelSurfaces, ChainError> {
    let drawn = document.drawn(Detail::Color, &[])?;
    let materials = drawn.iter().map(|drawn| drawn.material).collect();
    let surfaces = drawn.into_iter().map(|drawn| drawn.surface).collect();
    Ok(LevelSurfaces {
        surfaces,
        materials,
    })
}
