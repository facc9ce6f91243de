//! Which textures the leaves of a level have, so that a client shows as much of them as there is.

use std::cell::RefCell;
use std::collections::BTreeMap;

use glam::DQuat;
use secateur_eval::{AsDrawnCoverage, MipMaps, Shown};
use secateur_gltf::chain::LevelTexture;
use secateur_model::{BoundingSphere, Mips, Surface};
use secateur_raster::{View, ViewSet};

use super::cards::FAR_PX;
use super::fitted_textures::FittedTextures;
use super::leaf_texture::{Make, Outline};
use super::level_as_drawn::{LevelAsDrawn, WITHIN};
use super::level_surfaces::{LevelSurfaces, retextured};
use secateur_runtime::Screen;

/// Coverage that is no farther off than this is not worth another try.
const NEAR_ENOUGH: f64 = 0.04;

/// Above this error textures that are less sharp are tried: coverage is out of its bounds, or shows about 20
/// specks more than it may.
const POOR: f64 = 0.2;

/// How often more or less of the leaves is cut out, until as much is seen as should be: leaves that
/// hide each other answer less than in proportion.
const TRIES: usize = 4;

/// Coverage is looked at in every other view: from side to side it hardly differs.
const VIEW_STEP: usize = 2;

/// And in every third where pictures have as many pixels as these have at most.
const LARGE_VIEW_STEP: usize = 3;

/// Pictures of fewer pixels a side are drawn from more sides, as many pixels in all: what few pixels
/// cover is a matter of chance, and sizes and textures would be fitted to that.
const ENOUGH_PX: f64 = 64.0;

/// From how many times as many sides at most.
const MOST_TURNS: f64 = 12.0;

/// The last level is taken to be seen down to this height.
const LAST_END_PX: f64 = 64.0;

/// Views stand at least this many radii off.
const LEAST_RADII: f64 = 3.0;

/// The most pixels a side that pictures have: of what the screen shows larger they show the
/// middle.
const MOST_PX: f64 = 256.0;

/// Specks are counted for a picture of this many pixels a side at most, from the middle of larger
/// ones.
const SPECKS_PX: f64 = 384.0;

/// What leaves of a level show.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[cfg_attr(feature = "cli", derive(clap::ValueEnum, schemars::JsonSchema))]
#[serde(rename_all = "lowercase")]
pub enum Textures {
    /// Made for the distance of each level: texels of about a pixel, which cover what the tree's do.
    #[default]
    Fit,
    /// Textures of the tree.
    Keep,
}

/// Where a level ends that begins at this height, and the next at that.
pub(super) fn end_of(begin: f64, next: Option<f64>) -> f64 {
    next.unwrap_or((begin / 2.0).min(LAST_END_PX))
}

/// Which mips textures for this height are made for, the best first. They are smoother where they keep the coverage; of
/// far plants texels are as large as pixels, and without mips they show what they were judged by.
pub(super) fn mips_to_try(begin_px: f64) -> [Mips; 2] {
    match begin_px <= FAR_PX {
        true => [Mips::None, Mips::Blended],
        false => [Mips::Blended, Mips::None],
    }
}

/// Textures of a level, and what a client shows with them.
#[derive(Clone)]
pub(super) struct Chosen {
    pub(super) textures: Vec<LevelTexture>,
    /// Whether they are those of the tree, but for the colours of clear texels.
    pub(super) keeps_textures: bool,
    pub(super) as_drawn: LevelAsDrawn,
}

/// What levels are held against.
pub(super) struct Client<'a> {
    original: &'a [Surface],
    directions: &'a ViewSet,
    sphere: BoundingSphere,
    screen: Screen,
    plant_height: f64,
    /// By height on the screen: the end of a level is where the next begins.
    truths: RefCell<BTreeMap<u64, AsDrawnCoverage>>,
    /// The mip maps of the tree's own textures.
    mips: MipMaps,
    /// What levels show instead of textures of the tree that they keep.
    dilated: Vec<LevelTexture>,
}

impl<'a> Client<'a> {
    pub(super) fn new(
        original: &'a [Surface],
        directions: &'a ViewSet,
        sphere: BoundingSphere,
        screen: Screen,
        plant_height: f64,
    ) -> Self {
        let or = |size: f64, other: f64| if size > 0.0 { size } else { other };
        // All of a plant may be one point.
        let radius = or(sphere.radius, 1.0);
        Self {
            original,
            directions,
            sphere: BoundingSphere { radius, ..sphere },
            screen,
            // A plant that lies flat is as high as it is wide.
            plant_height: or(plant_height, 2.0 * radius),
            truths: RefCell::default(),
            mips: MipMaps::of_cut_outs(original),
            dilated: Vec::new(),
        }
    }

    /// This client, but levels that keep textures of the tree show these instead: their alpha is the same, but not
    /// the colours of clear texels, which mip maps mix in.
    pub(super) fn with_dilated(self, dilated: Vec<LevelTexture>) -> Self {
        Self { dilated, ..self }
    }

    /// How a level looks with its surfaces as they are.
    pub(super) fn as_drawn(&self, surfaces: &[Surface], range: [f64; 2]) -> LevelAsDrawn {
        self.as_drawn_with(surfaces, &self.mips, range)
    }

    /// How a level looks with the mip maps of its textures, where they are known.
    pub(super) fn as_drawn_with(
        &self,
        surfaces: &[Surface],
        mips: &MipMaps,
        range: [f64; 2],
    ) -> LevelAsDrawn {
        let [begin, end] = range.map(|h| self.shown(surfaces, mips, h));
        let more = [begin, end].into_iter().filter_map(more_specks);
        LevelAsDrawn {
            begin: begin.0,
            end: end.0,
            more_specks_per_view: more.reduce(f64::max).unwrap_or(0.0),
        }
    }

    /// Specks in a view of a level at this height, beyond those of the original; none where a client fades that.
    pub(super) fn more_specks_at(&self, surfaces: &[Surface], pixels_high: f64) -> f64 {
        more_specks(self.shown(surfaces, &self.mips, pixels_high)).unwrap_or(0.0)
    }

    /// The textures with which a level covers what it should from one height to another. The first
    /// level keeps those of the tree if they do: it is what is seen from near by, too.
    pub(super) fn choose(
        &self,
        level: &LevelSurfaces,
        range: [f64; 2],
        wanted: Textures,
        is_first: bool,
    ) -> Chosen {
        let of = |textures| self.with_textures(level, textures, range);
        // Colours of clear texels change nothing of what is covered.
        let kept = |textures| Chosen {
            as_drawn: self.as_drawn(&level.surfaces, range),
            textures,
            keeps_textures: true,
        };
        if wanted == Textures::Keep {
            return kept(Vec::new());
        }
        let dilated = || self.kept(level, range);
        let mut best: Option<Chosen> = None;
        if is_first {
            let kept = dilated();
            if kept.as_drawn.is_within() {
                return kept;
            }
            best = Some(kept);
        }
        // Textures for the middle of the range are less sharp, and change less from its beginning to its end.
        let middle = (range[0] * range[1]).sqrt();
        for height in [range[0], middle] {
            let fits = FittedTextures::of(level, self.pixels_a_unit(height));
            for mips in mips_to_try(range[0]) {
                let with = |outline: Outline| with_least_error(&fits, mips, outline, of);
                let Some(tried) = with(Outline::Exact) else {
                    continue;
                };
                if tried.as_drawn.is_within() {
                    return self.calmer(level, range[0], tried, || with(Outline::Smooth));
                }
                let is_better = |best: &Chosen| tried.as_drawn.error() < best.as_drawn.error();
                if best.as_ref().is_none_or(is_better) {
                    best = Some(tried);
                }
            }
            if best
                .as_ref()
                .is_none_or(|best| best.as_drawn.error() <= POOR)
            {
                break;
            }
        }
        let best_error = best.as_ref().map(|best| best.as_drawn.error());
        let kept = match is_first {
            true => None,
            false => Some(dilated()),
        };
        let is_better = |kept: &Chosen| best_error.is_none_or(|e| kept.as_drawn.error() <= e);
        kept.filter(is_better)
            .or(best)
            .expect("a first level was looked at as it is")
    }

    fn with_textures(
        &self,
        level: &LevelSurfaces,
        textures: Vec<LevelTexture>,
        range: [f64; 2],
    ) -> Chosen {
        let surfaces = retextured(level, &textures);
        Chosen {
            as_drawn: self.as_drawn(&surfaces, range),
            textures,
            keeps_textures: false,
        }
    }

    /// How many pixels a unit of length is where the screen shows the plant so high.
    pub(super) fn pixels_a_unit(&self, pixels_high: f64) -> f64 {
        pixels_high / self.plant_height
    }

    /// A level with textures of so many texels along a pixel where it begins, which show what they show there at any
    /// distance; none where it has none to make.
    pub(super) fn fitted_without_mips(
        &self,
        level: &LevelSurfaces,
        range: [f64; 2],
        texels_a_pixel: f64,
    ) -> Option<Chosen> {
        let fits = FittedTextures::of(level, texels_a_pixel * self.pixels_a_unit(range[0]));
        let of = |textures| self.with_textures(level, textures, range);
        with_least_error(&fits, Mips::None, Outline::Exact, of)
    }

    /// A level with the textures of the tree, but for the colours of clear texels.
    pub(super) fn kept(&self, level: &LevelSurfaces, range: [f64; 2]) -> Chosen {
        let is_shown = |own: &&LevelTexture| level.materials.contains(&Some(own.material));
        Chosen {
            as_drawn: self.as_drawn(&level.surfaces, range),
            textures: self.dilated.iter().filter(is_shown).cloned().collect(),
            keeps_textures: true,
        }
    }

    /// What a client shows of a level, and of the original.
    fn shown(&self, surfaces: &[Surface], mips: &MipMaps, pixels_high: f64) -> (Shown, Shown) {
        // What lies flat is no pixel high, or any number of them.
        let pixels_high = match pixels_high > 0.0 && pixels_high.is_finite() {
            true => pixels_high,
            false => 1.0,
        };
        let mut truths = self.truths.borrow_mut();
        let truth = truths.entry(pixels_high.to_bits());
        let truth = truth.or_insert_with(|| {
            let (views, side) = self.views(pixels_high);
            AsDrawnCoverage::new(self.original, &views, side, &self.mips)
        });
        let per_picture = (self.side_of_whole(pixels_high).min(SPECKS_PX) / MOST_PX).powi(2);
        let of_picture = |shown: Shown| Shown {
            specks_per_view: shown.specks_per_view * per_picture.max(1.0),
            ..shown
        };
        let shown = [truth.shown(surfaces, mips), truth.original_shown()];
        let [level, original] = shown.map(of_picture);
        (level, original)
    }

    /// How far off the screen shows the plant so high, and the tangent of half the field of view that
    /// then just holds it.
    fn frame(&self, pixels_high: f64) -> (f64, f64) {
        let radius = self.sphere.radius;
        let distance = self.screen.distance(self.plant_height, pixels_high);
        let distance = distance.max(LEAST_RADII * radius);
        let tangent = radius / (distance * distance - radius * radius).sqrt();
        (distance, tangent)
    }

    /// Pixels a side of a picture of the whole plant there.
    fn side_of_whole(&self, pixels_high: f64) -> f64 {
        let (distance, tangent) = self.frame(pixels_high);
        pixels_high * 2.0 * distance * tangent / self.plant_height
    }

    /// Views from where the screen shows the plant so high, and pixels a side of their pictures.
    fn views(&self, pixels_high: f64) -> (ViewSet, u32) {
        let (distance, tangent) = self.frame(pixels_high);
        let radius = self.sphere.radius;
        let whole = self.side_of_whole(pixels_high);
        let side = whole.clamp(1.0, MOST_PX).ceil();
        let tangent = tangent * side / whole;
        let from_afar = |(view, turn): (&View, DQuat)| {
            let eye = self.sphere.centre - turn * view.forward() * distance;
            let near = 0.5 * (distance - radius);
            let up = turn * view.up();
            View::look_at(eye, self.sphere.centre, up, tangent, near).unwrap_or(*view)
        };
        let turns = turns_for(side);
        let step = match side < MOST_PX {
            true => VIEW_STEP,
            false => LARGE_VIEW_STEP,
        };
        let views = self.directions.views().iter().step_by(step);
        let views = views.flat_map(|view| turns.iter().map(move |turn| (view, *turn)));
        let views = views.map(from_afar).collect();
        (ViewSet::new(views), side as u32)
    }
}

/// Specks in a view of what is shown of a level, beyond those of the original. None where a client does not
/// show as much of that as there is: what fades away has no specks.
fn more_specks((level, original): (Shown, Shown)) -> Option<f64> {
    let is_whole = original.coverage_over_truth >= WITHIN[0];
    is_whole.then_some(level.specks_per_view - original.specks_per_view)
}

/// Turns about the vertical from which pictures of `side` pixels are taken, more where they are small;
/// the first leaves the plant as it stands.
fn turns_for(side: f64) -> Vec<DQuat> {
    /// No two of them are near each other, however many there are.
    const GOLDEN_ANGLE: f64 = 2.399_963_229_728_653;
    let count = (ENOUGH_PX / side).powi(2).clamp(1.0, MOST_TURNS).ceil() as u32;
    let turn = |k: u32| DQuat::from_rotation_y(GOLDEN_ANGLE * f64::from(k));
    (0..count).map(turn).collect()
}

/// Of textures that cover more or less those with the least error; `of` shows them to a client. None where there are no
/// textures to make.
fn with_least_error(
    fits: &FittedTextures,
    mips: Mips,
    outline: Outline,
    of: impl Fn(Vec<LevelTexture>) -> Chosen,
) -> Option<Chosen> {
    if fits.is_empty() {
        return None;
    }
    let mut best: Option<Chosen> = None;
    let mut gain = 1.0;
    for _ in 0..TRIES {
        let next = of(fits.textures(Make {
            mips,
            outline,
            gain,
        }));
        gain *= next.as_drawn.wanted_gain();
        let error = next.as_drawn.error();
        // A gain is found for the coverage: specks hardly answer to it.
        let is_near = next.as_drawn.coverage_error() <= NEAR_ENOUGH;
        let is_enough = is_near || next.as_drawn.is_hopeless();
        if best
            .as_ref()
            .is_none_or(|best| error < best.as_drawn.error())
        {
            best = Some(next);
        }
        if is_enough || !gain.is_finite() {
            break;
        }
    }
    best
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;
    use glam::{DVec3, Vec2};
    use secateur_model::{AlphaMode, Filters, Finish, Material, Texture, Wrap};

    /// A card of 1 x 1 whose mask is a quarter of all texels, here and there.
    fn sparse_card() -> Surface {
        let alpha = |k: u32| match k.wrapping_mul(2_654_435_761) >> 30 {
            0 => 255,
            _ => 0,
        };
        let texture = Texture {
            width: 64,
            height: 64,
            rgba: (0..64 * 64)
                .flat_map(|k| [80, 160, 60, alpha(k * k + 7)])
                .collect(),
            wrap: [Wrap::Repeat; 2],
            filters: Filters::default(),
        };
        let corners = [[-0.5, -0.5], [0.5, -0.5], [0.5, 0.5], [-0.5, 0.5]];
        Surface {
            positions: corners.map(|[x, y]| DVec3::new(x, y, 0.0)).into(),
            normals: Vec::new(),
            uvs: corners
                .map(|[x, y]| Vec2::new(x as f32 + 0.5, 0.5 - y as f32))
                .into(),
            colors: Vec::new(),
            holds: Vec::new(),
            triangles: vec![[0, 1, 2], [0, 2, 3]],
            material: Arc::new(Material {
                name: String::new(),
                base_color: [1.0; 4],
                texture: Some(Arc::new(texture)),
                alpha_mode: AlphaMode::Mask(0.5),
                double_sided: true,
                finish: Finish::default(),
            }),
        }
    }

    #[test]
    fn small_pictures_are_drawn_from_more_sides() {
        let counts = [256.0, 64.0, 32.0, 25.0, 4.0].map(|side| turns_for(side).len());
        assert_eq!(counts, [1, 1, 4, 7, 12]);
        let ahead: Vec<DVec3> = turns_for(4.0).iter().map(|t| *t * DVec3::Z).collect();
        assert_eq!(ahead[0], DVec3::Z);
        let pairs = (0..12).flat_map(|a| (0..a).map(move |b| (a, b)));
        for (a, b) in pairs {
            assert!(ahead[a].distance(ahead[b]) > 0.3, "{a} is beside {b}");
        }
    }

    #[test]
    fn a_mask_that_fades_under_mips_is_made_to_stay() {
        let eyes = [
            [0.0, 0.0, 1.0],
            [0.3, 0.2, 1.0],
            [-0.2, 0.4, -1.0],
            [0.5, -0.3, 1.0],
        ];
        let view = |eye: [f64; 3]| {
            let eye = DVec3::from_array(eye) * 5.0;
            View::look_at(eye, DVec3::ZERO, DVec3::Y, 0.5, 0.1).unwrap()
        };
        let directions = ViewSet::new(eyes.map(view).into());
        let sphere = BoundingSphere {
            centre: DVec3::ZERO,
            radius: 0.5f64.sqrt(),
        };
        let card = [sparse_card()];
        let client = Client::new(&card, &directions, sphere, Screen::default(), 1.0);
        let level = LevelSurfaces {
            surfaces: card.to_vec(),
            materials: vec![Some(3)],
        };
        let range = [48.0, 24.0];
        let kept = client.choose(&level, range, Textures::Keep, false);
        assert!(kept.textures.is_empty());
        let faded = kept.as_drawn.end.coverage_over_truth;
        assert!(faded < 0.5, "{faded}");
        let made = client.choose(&level, range, Textures::Fit, false);
        assert!(made.as_drawn.is_within(), "{:?}", made.as_drawn);
        // A texel for a pixel is enough: 48 of them, which is 64 as a power of two.
        let [own] = &made.textures[..] else {
            panic!("one texture for one material")
        };
        assert_eq!((own.material, own.texture.width), (3, 64));
        // The first level, too, gets a texture where that of the tree fades.
        let first = client.choose(&level, range, Textures::Fit, true);
        assert_eq!(first.textures, made.textures);
        // Where nothing fades, the first level keeps it: it is seen from near by as well.
        let near = client.choose(&level, [600.0, 300.0], Textures::Fit, true);
        assert!(near.textures.is_empty() && near.as_drawn.is_within());
    }
}
