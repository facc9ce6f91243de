//! Alpha cutoffs with which clients show as much of a level as there is.
//!
//! Mip maps mix what a texture shows with the nothing around it, so that masks of leaves fade, or
//! close, where the screen shows them small. The alpha of most leaf textures is near 0 or near 1: near
//! by it hardly matters which cutoff between them is asked for, and from afar it decides how much is
//! left. Where a texture's mip maps all have nearly the same alpha, a cutoff shows all of them or
//! nothing. Such textures are read without mip maps: then each pixel shows what is at its middle, and
//! all together as much as there is. Where mip maps stay, as that would show too many specks or is not asked
//! for, what still fades gets [raised] texels.

mod choice;
mod raised;
mod range;
mod specks;

use std::collections::BTreeMap;
use std::sync::Arc;

use secateur_eval::{MipMaps, Outlines, Strengths};
use secateur_gltf::{Cutoffs, Detail, DrawnSurface, GltfError, Tree};
use secateur_model::{AlphaMode, Lod, Material, Mips, Surface};
use secateur_raster::ViewSet;

pub use self::choice::CutoffChoice;
pub use self::raised::Raised;
use self::raised::{Raisable, with_raised};
use self::range::range;
use self::specks::DrawnOriginal;

/// Width of the largest pictures that are looked at, in pixels; the crown takes a little more than
/// half of it.
const WIDTH_PX: u32 = 512;

/// The pictures are this many times smaller.
const STEPS: [u32; 3] = [1, 2, 4];

/// Corners of a cube that make a tetrahedron: views from four sides.
const SIDES: [usize; 4] = [0, 3, 5, 6];

/// Coverage that is no farther off than this at any size is left as it is. Mip maps are left out, if they may be,
/// where it is farther off at some size with the best cutoffs.
const NEAR_ENOUGH: f64 = 0.03;

/// Coverage that is no farther off than this at any size is borne with, for cutoffs that are better where a client makes
/// mip maps of its own, and for raised texels.
const FAR_OFF: f64 = 0.08;

/// How many cutoffs are tried between one and its double.
const TRIES_PER_OCTAVE: f32 = 8.0;

/// How many shares of the cutoff, as alpha of raised texels, there are up to 1.
const SHARE_STEPS: f64 = 10.0;

/// The first share that is tried, in steps, and the last: rounding, compressed textures and samplers must not show
/// raised texels.
const MIDDLE_STEP: i32 = 5;
const LAST_STEP: i32 = 8;

/// Texels are raised where coverage is then less than this times as far off, by squares of logarithms.
const MUCH_LESS: f64 = 0.5;

/// How many specks a view a level may show beyond those that there truly are, if it did not before.
const MOST_MORE_SPECKS: f64 = 2.0;

/// What may be done to materials.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MaterialChange {
    /// Materials may have other cutoffs, or textures whose clear texels have another alpha.
    Cutoffs,
    /// Textures may be read without mip maps, too.
    CutoffsOrMips,
}

/// Cutoffs that were chosen, and what they do.
#[derive(Clone, Debug, PartialEq)]
pub struct ChosenCutoffs {
    /// Cutoffs that differ from what the level has without. [`material_changes`](crate::material_changes) has all
    /// that changes.
    pub cutoffs: Cutoffs,
    /// By what all cutoffs were multiplied.
    pub times: f64,
    /// Textures with raised clear texels.
    pub raised: Vec<Raised>,
    /// The alpha of these texels over the tree's cutoff; none where no texture has any.
    pub raised_share: Option<f64>,
    /// Width and height of pictures in pixels, and in them the pixels that a client shows over those
    /// that the original truly covers: without and with these cutoffs.
    pub coverage: Vec<(u32, [f64; 2])>,
}

/// Chooses the cutoffs of a level of a tree, and whether its mip maps are read; none where nothing needs
/// another, and of the tree as it is, from which nothing is gone.
///
/// # Errors
/// [`GltfError`] if the tree or the level can't be drawn.
pub fn choose_cutoffs(
    tree: &Tree,
    lod: &Lod,
    change: MaterialChange,
) -> Result<Option<ChosenCutoffs>, GltfError> {
    if *lod == Lod::original(tree.foliage().leaves().len()) {
        return Ok(None);
    }
    let free = tree.cut_out_materials();
    let Some(sphere) = tree
        .foliage()
        .bounding_sphere()
        .filter(|_| !free.is_empty())
    else {
        return Ok(None);
    };
    let level = tree.lod_document(lod)?.drawn_as_one(Detail::Color)?;
    let is_free = |drawn: &&DrawnSurface| drawn.material.is_some_and(|m| free.contains(&m));
    let ratios = range(level.iter().filter(is_free));
    let Some(ratios) = ratios else {
        return Ok(None);
    };
    let all = ViewSet::cube(sphere);
    let views = ViewSet::new(SIDES.map(|side| all.views()[side]).into());
    let original = tree.document().drawn_as_one(Detail::Color)?;
    let original: Vec<&Surface> = original.iter().map(|drawn| &drawn.surface).collect();
    let truth = Outlines::of_truth(&original, &views, WIDTH_PX);
    let client = Client {
        views: &views,
        truth: &truth,
        free: &free,
    };
    let with_mips = client.sizes(&level, ratios[1]);
    let drawn = WithMips {
        best: best(&with_mips, ratios),
        level: &level,
        ratios,
        sizes: with_mips,
        client,
    };
    if change == MaterialChange::CutoffsOrMips
        && let Some(without) = drawn.without_mips(&original)
    {
        return Ok(Some(without));
    }
    if let Some(raised) = drawn.raised(tree) {
        return Ok(Some(raised));
    }
    Ok(drawn.best.map(|times| {
        let after = |k: usize| drawn.sizes[k].coverage(times);
        drawn.chosen(drawn.cutoffs(Some(times)), times, &after)
    }))
}

/// A level as clients draw it with mip maps.
struct WithMips<'a> {
    client: Client<'a>,
    level: &'a [DrawnSurface],
    /// Between which multiples of the cutoffs anything changes.
    ratios: [f32; 2],
    sizes: [Size; STEPS.len()],
    /// By what cutoffs are best multiplied; none where they are best as they are.
    best: Option<f32>,
}

impl WithMips<'_> {
    /// Cutoffs that were chosen, and the coverage that they lead to, by the number of the size.
    fn chosen(&self, cutoffs: Cutoffs, times: f32, after: &dyn Fn(usize) -> f64) -> ChosenCutoffs {
        ChosenCutoffs {
            cutoffs,
            times: times.into(),
            raised: Vec::new(),
            raised_share: None,
            coverage: (self.sizes.iter().enumerate())
                .map(|(k, size)| (size.width_px, [size.coverage(1.0), after(k)]))
                .collect(),
        }
    }

    /// The cutoffs of all materials that may change, multiplied by `times`; no cutoff changes where that is none.
    fn cutoffs(&self, times: Option<f32>) -> Cutoffs {
        let cutoff = |drawn: &DrawnSurface| match drawn.surface.material.alpha_mode {
            AlphaMode::Mask(cutoff) if self.client.is_free(drawn) => {
                Some((drawn.material?, f64::from(cutoff * times?)))
            }
            _ => None,
        };
        Cutoffs::new(self.level.iter().filter_map(cutoff))
    }

    /// The cutoffs without mip maps, where coverage is off with them, less so without, and there are no more specks.
    fn without_mips(&self, original: &[&Surface]) -> Option<ChosenCutoffs> {
        let times_with_mips = self.best.unwrap_or(1.0);
        let off = farthest_off(&self.sizes, times_with_mips);
        if off <= NEAR_ENOUGH {
            return None;
        }
        let client = &self.client;
        let (level, changed) = changed(self.level, |number, material| {
            client
                .free
                .contains(&number)
                .then(|| without_mips(material))
        });
        let without = client.sizes(&level, self.ratios[1]);
        // Some clients make mip maps whatever a file says: the cutoffs that are best with them stay where
        // they do no harm.
        let best = match do_no_harm(farthest_off(&without, times_with_mips), off) {
            true => self.best,
            false => best(&without, self.ratios),
        };
        let now = best.unwrap_or(1.0);
        let tolerable = |size: &Size| specks::is_tolerable(size.coverage(times_with_mips));
        let are_tolerable = self.sizes.iter().all(tolerable);
        let original = DrawnOriginal::new(original, client.views, are_tolerable);
        let has_more_specks = |(with, without): (&Size, &Size)| {
            let before = with.level.shown(times_with_mips).specks_per_view();
            let after = without.level.shown(now).specks_per_view();
            after > before && after > original.most_specks(&with.truth, with.width_px)
        };
        let is_better = farthest_off(&without, now) < off
            && !self.sizes.iter().zip(&without).any(has_more_specks);
        is_better.then(|| {
            let cutoffs = self.cutoffs(best).without_mips(changed);
            self.chosen(cutoffs, now, &|k| without[k].coverage(now))
        })
    }

    /// Raised texels instead of other cutoffs, where a level fades and coverage is much less off with them.
    fn raised(&self, tree: &Tree) -> Option<ChosenCutoffs> {
        let times = self.best.unwrap_or(1.0);
        let fades = |size: &Size| size.coverage(times) < 1.0 - NEAR_ENOUGH;
        if !self.sizes.iter().any(fades) {
            return None;
        }
        let (after, found) = self.client.best_raised(tree, self.level, &self.sizes)?;
        let is_better = after < MUCH_LESS * off_by_logarithm(&self.sizes, times);
        is_better.then(|| ChosenCutoffs {
            raised: found.raised,
            raised_share: Some(found.share),
            ..self.chosen(self.cutoffs(None), 1.0, &|k| found.coverage[k])
        })
    }
}

/// How levels are drawn: the views, the true outlines that they are compared with, and the numbers of the materials
/// whose cutoffs may change.
struct Client<'a> {
    views: &'a ViewSet,
    truth: &'a Outlines,
    free: &'a [usize],
}

/// Raised textures, and what is shown with them.
struct FoundRaised {
    /// The alpha of clear texels away from leaves over the cutoff.
    share: f64,
    raised: Vec<Raised>,
    /// Pixels that a client shows over those that there truly are, at each of the sizes that are looked at.
    coverage: [f64; STEPS.len()],
}

impl Client<'_> {
    fn is_free(&self, drawn: &DrawnSurface) -> bool {
        let material = drawn.material;
        material.is_some_and(|material| self.free.contains(&material))
    }

    /// A level at all sizes. Ratios of alpha to cutoff are exact up to `enough`.
    fn sizes(&self, level: &[DrawnSurface], enough: f32) -> [Size; STEPS.len()] {
        let surfaces: Vec<&Surface> = level.iter().map(|drawn| &drawn.surface).collect();
        let known = MipMaps::of_cut_outs(&surfaces);
        let is_free = |surface: usize| self.is_free(&level[surface]);
        STEPS.map(|step| {
            let width_px = WIDTH_PX / step;
            Size {
                width_px,
                truth: self.truth.every(step),
                level: Strengths::new(&surfaces, is_free, self.views, width_px, enough, &known),
            }
        })
    }

    /// The raised textures with which coverage is the least off, and how far off it is then. None if no share is
    /// allowed, or if the images can't be read a second time within the memory.
    fn best_raised(
        &self,
        tree: &Tree,
        level: &[DrawnSurface],
        plain: &[Size],
    ) -> Option<(f64, FoundRaised)> {
        let raisable = Raisable::of(tree).ok()?;
        let specks = Specks::of(plain);
        best_share(|share| {
            let raised = raisable.by(share)?;
            let of = |number, material: &Material| {
                let one = raised.iter().find(|one| one.material == number)?;
                with_raised(material, one)
            };
            let sizes = self.sizes(&changed(level, of).0, 1.0);
            let closes = |(raised, plain): (&Size, &Size)| {
                raised.coverage(1.0) > plain.coverage(1.0).max(1.0 + FAR_OFF)
            };
            if !specks.are_no_more(&sizes, 1.0) || sizes.iter().zip(plain).any(closes) {
                return None;
            }
            let coverage = sizes.each_ref().map(|size| size.coverage(1.0));
            let found = FoundRaised {
                share,
                raised,
                coverage,
            };
            Some((off_by_logarithm(&sizes, 1.0), found))
        })
    }
}

/// The share at which what is tried is the least off: from the middle on, up or down, as long as it gets better.
/// Where the middle is not allowed, the highest share below it that is allowed comes first.
fn best_share<T>(tried: impl Fn(f64) -> Option<(f64, T)>) -> Option<(f64, T)> {
    let share = |step: i32| f64::from(step) / SHARE_STEPS;
    let off = |of: &Option<(f64, T)>| of.as_ref().map_or(f64::INFINITY, |(off, _)| *off);
    let mut best = tried(share(MIDDLE_STEP));
    let mut step = MIDDLE_STEP;
    while best.is_some() && step < LAST_STEP {
        let found = tried(share(step + 1));
        if off(&found) >= off(&best) {
            break;
        }
        best = found;
        step += 1;
    }
    if step > MIDDLE_STEP {
        return best;
    }
    while step > 1 {
        let found = tried(share(step - 1));
        if best.is_some() && off(&found) >= off(&best) {
            break;
        }
        best = found;
        step -= 1;
    }
    best
}

/// Whether the cutoffs that are best with mip maps are good enough without them, where coverage is so much off without and
/// with them.
fn do_no_harm(off_without: f64, off_with: f64) -> bool {
    off_without <= FAR_OFF && off_without < off_with
}

/// By how much coverage is off at the size where it is farthest off, with cutoffs `times` as high.
fn farthest_off(sizes: &[Size], times: f32) -> f64 {
    let off = |size: &Size| (size.coverage(times) - 1.0).abs();
    sizes.iter().map(off).fold(0.0, f64::max)
}

/// The surfaces with changed materials, and the numbers of these. `change` gets a material and its number, and
/// returns nothing where it stays.
fn changed(
    level: &[DrawnSurface],
    change: impl Fn(usize, &Material) -> Option<Material>,
) -> (Vec<DrawnSurface>, Vec<usize>) {
    let mut level = level.to_vec();
    let mut made: BTreeMap<usize, Option<Arc<Material>>> = BTreeMap::new();
    for drawn in &mut level {
        let Some(number) = drawn.material else {
            continue;
        };
        let material = &mut drawn.surface.material;
        let made = made.entry(number);
        if let Some(made) = made.or_insert_with(|| change(number, material).map(Arc::new)) {
            *material = made.clone();
        }
    }
    let is_changed = |(number, made): (usize, Option<Arc<Material>>)| made.map(|_| number);
    (level, made.into_iter().filter_map(is_changed).collect())
}

/// A material, read without mip maps.
fn without_mips(material: &Material) -> Material {
    let mut without = material.clone();
    if let Some(texture) = &mut without.texture {
        Arc::make_mut(texture).filters.mips = Mips::None;
    }
    without
}

/// Pictures of one size.
struct Size {
    width_px: u32,
    truth: Outlines,
    level: Strengths,
}

impl Size {
    fn coverage(&self, times: f32) -> f64 {
        let truth = self.truth.covered_px().max(1);
        self.level.shown(times).covered_px() as f64 / truth as f64
    }

    fn specks_too_many(&self, times: f32) -> f64 {
        let more = self.level.shown(times).specks_per_view() - self.truth.specks_per_view();
        (more - MOST_MORE_SPECKS).max(0.0)
    }
}

/// How many specks a level has too many as it is, at each size.
struct Specks(Vec<f64>);

impl Specks {
    fn of(sizes: &[Size]) -> Self {
        Self(sizes.iter().map(|size| size.specks_too_many(1.0)).collect())
    }

    /// Whether there are no more with these cutoffs.
    fn are_no_more(&self, sizes: &[Size], times: f32) -> bool {
        let mut pairs = sizes.iter().zip(&self.0);
        pairs.all(|(size, before)| size.specks_too_many(times) <= *before)
    }
}

/// By what cutoffs are to be multiplied; none where they are best as they are.
fn best(sizes: &[Size], ratios: [f32; 2]) -> Option<f32> {
    let is_near = |size: &Size| (size.coverage(1.0) - 1.0).abs() <= NEAR_ENOUGH;
    if sizes.iter().all(is_near) {
        return None;
    }
    let (off, times) = least_off(sizes, ratios)?;
    (off < off_by_logarithm(sizes, 1.0)).then_some(times)
}

/// How far coverage is off with cutoffs `times` as high: the squares of logarithms, summed over the sizes.
fn off_by_logarithm(sizes: &[Size], times: f32) -> f64 {
    let of_size = |size: &Size| size.coverage(times).max(1e-3).ln().powi(2);
    sizes.iter().map(of_size).sum()
}

/// How far coverage is off with the best cutoffs that show no more specks than before, and by what they are
/// multiplied.
fn least_off(sizes: &[Size], [low, high]: [f32; 2]) -> Option<(f64, f32)> {
    let before = Specks::of(sizes);
    let first = (low.log2() * TRIES_PER_OCTAVE).ceil() as i32;
    let last = (high.log2() * TRIES_PER_OCTAVE).floor() as i32;
    let tried = (first..=last).map(|step| (step as f32 / TRIES_PER_OCTAVE).exp2());
    let off = |times| (off_by_logarithm(sizes, times), times);
    let mut found: Vec<(f64, f32)> = tried.map(off).collect();
    found.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut found = found.into_iter();
    found.find(|(_, times)| before.are_no_more(sizes, *times))
}

#[cfg(test)]
mod tests;
