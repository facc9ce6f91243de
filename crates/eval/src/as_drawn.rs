//! What a client draws: textures with mip maps, the alpha test at the middle of each pixel, back
//! faces culled. The truth that it is held against is the original, many samples a pixel,
//! without mip maps.

use std::borrow::Borrow;

use image::RgbaImage;
use rayon::prelude::*;
use secateur_model::Surface;
use secateur_raster::{View, ViewSet};
use serde::Serialize;

use crate::averaged::{Overlap, options};
use crate::mips::MipChains;
use crate::over_frames::OverFrames;
use crate::pictures::camera_of;
use crate::render::{DrawnPicture, draw};
use crate::surface_references::references;
use crate::truth::{Truth, coverage_over_truth, covered_px};
use crate::visibility::AlphaFrom;

/// Islands of at most this many pixels are specks.
const SPECK_PX: usize = 3;

/// The original, drawn as a client does and as it truly is.
#[derive(Debug)]
pub struct AsDrawn {
    views: ViewSet,
    width_px: u32,
    truth: Vec<Truth>,
    original: ViewPictures,
    original_shown: OriginalAsDrawn,
    original_without_mips: OriginalAsDrawn,
    /// If pictures over frames are compared too.
    original_over_frames: Option<OverFrames>,
}

#[derive(Debug)]
struct ViewPictures(Vec<(RgbaImage, Vec<bool>)>);

/// How a client's picture of a tree compares with what the original truly looks like; means over
/// the views.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[cfg_attr(feature = "cli", derive(schemars::JsonSchema))]
pub struct AsDrawnMeasurement {
    /// Width and height of the pictures in pixels.
    pub width_px: u32,
    /// Pixels that the simplified tree covers over those that the original truly covers.
    pub coverage_over_truth: f64,
    /// Pixels that the original covers, drawn by the same client, over those that it truly covers.
    pub original_coverage_over_truth: f64,
    /// Overlap of the simplified tree's outline with the original's, both as drawn, 0 to 1. What a client
    /// does not show of the original is not missed here; [`Self::truth_iou`] misses it.
    pub silhouette_iou: f64,
    /// Overlap of the simplified tree as drawn with what the original truly covers, 0 to 1: of each
    /// pixel the smaller share that one of the two covers, over the larger, summed over all pixels.
    pub truth_iou: f64,
    /// Islands of up to 3 pixels in a view of the simplified tree.
    pub specks_per_view: f64,
    /// Islands of up to 3 pixels in a view of the original.
    pub original_specks_per_view: f64,
    /// FLIP of the simplified tree as drawn against the truth, 0 to 1.
    pub flip_mean: f64,
    /// FLIP of the original as drawn against the truth, 0 to 1.
    pub original_flip_mean: f64,
    /// Overlap of the original as drawn with what it truly covers, 0 to 1.
    pub original_truth_iou: f64,
    /// The original as the same client would draw it if it read its textures without mip maps: the error of
    /// one sample a pixel alone.
    pub original_without_mips: OriginalAsDrawn,
    /// The simplified tree as a client with temporal anti-aliasing shows it, if that was asked for.
    pub over_frames: Option<OverFrames>,
    /// The original as such a client shows it, if that was asked for.
    pub original_over_frames: Option<OverFrames>,
}

/// How a client's picture of an original compares with what it truly looks like; means over the views.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[cfg_attr(feature = "cli", derive(schemars::JsonSchema))]
pub struct OriginalAsDrawn {
    /// Pixels that it covers over those that it truly covers.
    pub coverage_over_truth: f64,
    /// Overlap with what it truly covers, 0 to 1.
    pub truth_iou: f64,
    /// Islands of up to 3 pixels in a view.
    pub specks_per_view: f64,
    /// FLIP against the truth, 0 to 1.
    pub flip_mean: f64,
}

impl AsDrawnMeasurement {
    /// The original as the same client draws it.
    pub fn original(&self) -> OriginalAsDrawn {
        OriginalAsDrawn {
            coverage_over_truth: self.original_coverage_over_truth,
            truth_iou: self.original_truth_iou,
            specks_per_view: self.original_specks_per_view,
            flip_mean: self.original_flip_mean,
        }
    }
}

impl AsDrawn {
    /// Draws an original from views, in pictures of `width_px` x `width_px` pixels.
    ///
    /// # Panics
    /// If `width_px` is 0, or there is no view.
    pub fn new<S: Borrow<Surface> + Sync>(original: &[S], views: &ViewSet, width_px: u32) -> Self {
        let original = &references(original)[..];
        assert!(width_px > 0 && !views.is_empty());
        let truth = Truth::of(original, views, width_px);
        let mips = MipChains::of(original);
        let drawn = |mips| ViewPictures::of(original, views, width_px, AlphaFrom::mips(mips));
        let [with_mips, without_mips] = [Some(&mips), None].map(drawn);
        let shown = |drawn: &ViewPictures| OriginalAsDrawn {
            coverage_over_truth: coverage_over_truth(drawn.covered_px(), covered_px(&truth)),
            truth_iou: truth_iou(&truth, drawn),
            specks_per_view: drawn.specks_per_view(width_px as usize),
            flip_mean: flip(&truth, drawn),
        };
        Self {
            original_shown: shown(&with_mips),
            original_without_mips: shown(&without_mips),
            original_over_frames: None,
            original: with_mips,
            truth,
            views: views.clone(),
            width_px,
        }
    }

    /// This original, which compares the means of many frames as well: each further picture of the original
    /// and of what is measured takes as long as one of the truth.
    pub fn over_frames<S: Borrow<Surface> + Sync>(mut self, original: &[S]) -> Self {
        let original = &references(original)[..];
        self.original_over_frames = Some(self.frames_of(original, &MipChains::of(original)));
        self
    }

    fn frames_of(&self, surfaces: &[&Surface], mips: &MipChains) -> OverFrames {
        OverFrames::of(surfaces, mips, &self.views, self.width_px, &self.truth)
    }

    /// Draws a simplified tree from the same views, and compares.
    pub fn measure<S: Borrow<Surface> + Sync>(&self, simplified: &[S]) -> AsDrawnMeasurement {
        let simplified = &references(simplified)[..];
        let mips = MipChains::of(simplified);
        let alpha = AlphaFrom::mips(Some(&mips));
        let drawn = ViewPictures::of(simplified, &self.views, self.width_px, alpha);
        let (mut both, mut any) = (0, 0);
        for ((_, a), (_, b)) in self.original.0.iter().zip(&drawn.0) {
            for (a, b) in a.iter().zip(b) {
                both += usize::from(*a && *b);
                any += usize::from(*a || *b);
            }
        }
        AsDrawnMeasurement {
            width_px: self.width_px,
            coverage_over_truth: coverage_over_truth(drawn.covered_px(), covered_px(&self.truth)),
            original_coverage_over_truth: self.original_shown.coverage_over_truth,
            silhouette_iou: if any == 0 {
                1.0
            } else {
                both as f64 / any as f64
            },
            truth_iou: truth_iou(&self.truth, &drawn),
            specks_per_view: drawn.specks_per_view(self.width_px as usize),
            original_specks_per_view: self.original_shown.specks_per_view,
            flip_mean: flip(&self.truth, &drawn),
            original_flip_mean: self.original_shown.flip_mean,
            original_truth_iou: self.original_shown.truth_iou,
            original_without_mips: self.original_without_mips,
            over_frames: (self.original_over_frames).map(|_| self.frames_of(simplified, &mips)),
            original_over_frames: self.original_over_frames,
        }
    }
}

/// Of each pixel the smaller share that one of the two covers, over the larger, summed over all pixels.
fn truth_iou(truth: &[Truth], drawn: &ViewPictures) -> f64 {
    let mut overlap = Overlap::default();
    for (truth, (_, is_covered)) in truth.iter().zip(&drawn.0) {
        let drawn = is_covered.iter().map(|is| f32::from(u8::from(*is)));
        overlap.add(&truth.picture.shares, drawn);
    }
    overlap.iou()
}

/// The mean over the views.
fn flip(truth: &[Truth], drawn: &ViewPictures) -> f64 {
    let of = |(truth, (image, _)): (&Truth, &(RgbaImage, Vec<bool>))| truth.flip(image);
    let of_views: Vec<f64> = truth.par_iter().zip(&drawn.0).map(of).collect();
    of_views.iter().sum::<f64>() / truth.len() as f64
}

/// [`AsDrawn::measure`] for one measurement alone, over frames too.
///
/// # Panics
/// As [`AsDrawn::new`].
pub fn measure_as_drawn<S: Borrow<Surface> + Sync>(
    original: &[S],
    simplified: &[S],
    views: &ViewSet,
    width_px: u32,
) -> AsDrawnMeasurement {
    let original = &references(original)[..];
    let simplified = &references(simplified)[..];
    let original_drawn = AsDrawn::new(original, views, width_px);
    original_drawn.over_frames(original).measure(simplified)
}

impl ViewPictures {
    fn of(surfaces: &[&Surface], views: &ViewSet, width_px: u32, alpha: AlphaFrom<'_>) -> Self {
        let drawn = |view: &View| {
            let DrawnPicture { image, is_covered } =
                draw(surfaces, &camera_of(view), &options(width_px, 1), alpha);
            (image, is_covered)
        };
        Self(views.views().par_iter().map(drawn).collect())
    }

    fn covered_px(&self) -> f64 {
        let of = |(_, is_covered): &(_, Vec<bool>)| is_covered.iter().filter(|is| **is).count();
        self.0.iter().map(of).sum::<usize>() as f64
    }

    fn specks_per_view(&self, width: usize) -> f64 {
        let of = |(_, is_covered): &(_, Vec<bool>)| specks(is_covered, width);
        self.0.iter().map(of).sum::<usize>() as f64 / self.0.len() as f64
    }
}

/// Number of islands of at most [`SPECK_PX`] pixels; pixels that touch at a corner belong together.
pub(crate) fn specks(is_covered: &[bool], width: usize) -> usize {
    let mut is_seen = vec![false; is_covered.len()];
    let mut island = Vec::new();
    let mut count = 0;
    for first in 0..is_covered.len() {
        if !is_covered[first] || is_seen[first] {
            continue;
        }
        let mut size = 0;
        is_seen[first] = true;
        island.push(first);
        while let Some(pixel) = island.pop() {
            size += 1;
            let (x, y) = (pixel % width, pixel / width);
            for row in y.saturating_sub(1)..(y + 2).min(is_covered.len() / width) {
                for column in x.saturating_sub(1)..(x + 2).min(width) {
                    let next = row * width + column;
                    if is_covered[next] && !is_seen[next] {
                        is_seen[next] = true;
                        island.push(next);
                    }
                }
            }
        }
        count += usize::from(size <= SPECK_PX);
    }
    count
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;
    use glam::{DVec3, Vec2, Vec3};
    use secateur_model::{AlphaMode, Filters, Finish, Material, Mips, Texture, Wrap};
    use secateur_raster::View;
    use std::sync::Arc;

    #[test]
    fn islands_of_up_to_three_pixels_are_specks() {
        let picture = [
            "##.....#", //
            "##....#.", //
            "........", //
            "#.####.#", //
            "........",
        ];
        let is_covered: Vec<bool> = picture
            .iter()
            .flat_map(|row| row.bytes().map(|b| b == b'#'))
            .collect();
        // Two at a corner of each other, and one at either side of the row; four are none.
        assert_eq!(specks(&is_covered, 8), 3);
        assert_eq!(specks(&[], 8), 0);
    }

    /// A card of 1 x 1 that faces +z, whose texture shows thin stripes: a quarter of it.
    pub(crate) fn striped(mips: Mips) -> Surface {
        let stripe = |x: u32| if x.is_multiple_of(4) { 255 } else { 0 };
        let texture = Texture {
            width: 64,
            height: 64,
            rgba: (0..64 * 64)
                .flat_map(|k| [255, 255, 255, stripe(k % 64)])
                .collect(),
            wrap: [Wrap::ClampToEdge; 2],
            filters: Filters {
                is_smooth_near: false,
                is_smooth_far: true,
                mips,
            },
        };
        let material = Material {
            name: String::new(),
            base_color: [1.0; 4],
            texture: Some(Arc::new(texture)),
            alpha_mode: AlphaMode::Mask(0.5),
            double_sided: true,
            finish: Finish::default(),
        };
        let corners = [[-0.5, -0.5], [0.5, -0.5], [0.5, 0.5], [-0.5, 0.5]];
        Surface {
            positions: corners.map(|[x, y]| DVec3::new(x, y, 0.0)).into(),
            normals: vec![Vec3::Z; 4],
            uvs: corners
                .map(|[x, y]| Vec2::new(x as f32 + 0.5, 0.5 - y as f32))
                .into(),
            colors: Vec::new(),
            holds: Vec::new(),
            triangles: vec![[0, 1, 2], [0, 2, 3]],
            material: Arc::new(material),
        }
    }

    /// A view that holds the card exactly: 64 pixels are a texel each, 16 are four.
    pub(crate) fn card_view() -> ViewSet {
        let view = View::look_at(DVec3::Z, DVec3::ZERO, DVec3::Y, 0.5, 0.01).unwrap();
        ViewSet::new(vec![view])
    }

    #[test]
    fn stripes_fade_away_with_mips_and_not_in_truth() {
        let views = card_view();
        let measured = |mips: Mips, width_px: u32| {
            let card = [striped(mips)];
            measure_as_drawn(&card, &card, &views, width_px)
        };
        let near = measured(Mips::Blended, 64);
        assert_eq!(near.coverage_over_truth, 1.0);
        assert_eq!((near.silhouette_iou, near.specks_per_view), (1.0, 0.0));
        assert_eq!(near.truth_iou, 1.0);
        // A mean alpha of a quarter is below the cutoff: nothing is left.
        let far = measured(Mips::Blended, 16);
        assert_eq!(far.coverage_over_truth, 0.0);
        assert_eq!(far.original_coverage_over_truth, 0.0);
        // The original has faded alike, so that nothing differs, but for the truth.
        assert_eq!((far.silhouette_iou, far.truth_iou), (1.0, 0.0));
        assert!(far.flip_mean > near.flip_mean);
    }

    #[test]
    fn an_original_without_mips_is_what_a_sampler_without_them_shows() {
        // Pixels of 2.67 texels: their middles meet stripes, and what is between them.
        let measured =
            |mips: Mips| measure_as_drawn(&[striped(mips)], &[striped(mips)], &card_view(), 24);
        let [with, without] = [Mips::Blended, Mips::None].map(measured);
        assert_ne!(with.original_without_mips.flip_mean, with.flip_mean);
        assert_eq!(with.original_without_mips, without.original_without_mips);
        let of_level = OriginalAsDrawn {
            coverage_over_truth: without.coverage_over_truth,
            truth_iou: without.truth_iou,
            specks_per_view: without.specks_per_view,
            flip_mean: without.flip_mean,
        };
        assert_eq!(with.original_without_mips, of_level);
        assert!(of_level.coverage_over_truth > 0.0);
        assert_eq!(with.original_truth_iou, with.truth_iou);
    }

    /// Of each pixel of four texels a quarter is truly covered: an opaque card has four times that.
    #[test]
    fn parts_of_pixels_count_in_the_overlap_with_the_truth() {
        let truth = AsDrawn::new(&[striped(Mips::Blended)], &card_view(), 16);
        let mut full = striped(Mips::None);
        Arc::make_mut(&mut full.material).alpha_mode = AlphaMode::Opaque;
        assert_eq!(truth.measure(&[full]).truth_iou, 0.25);
    }
}
