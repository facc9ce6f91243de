//! How fine the images must be for the measure to see the leaves.
//!
//! A leaf that is seen in one view only adds `a log2 (a / S) = 0` to the VMI,
//! and one of a pixel comes and goes with the grid: where most leaves are that
//! small the measure is blind to most of the crown. The paper's 256 x 256 pixels
//! are enough for leaves of several pixels; more than that costs time and gains
//! nothing (DESIGN: measured), so the resolution doubles only while too many of
//! the visible leaves cover at most a pixel in every view.

use secateur_model::{BoundingSphere, Foliage, Lod};
use secateur_raster::{AreaTable, MAX_TOTAL_PIXELS, OpenEngine, Rasteriser, Scene, ViewSet};

use crate::shared::Shared;
use crate::vds::VdsError;
use crate::{Error, Options, Resolution};

/// Resolutions that are tried, in pixels, in order.
pub const CANDIDATES: [u32; 3] = [256, 512, 1024];

/// The share of visible leaves that may cover at most a pixel in every view.
pub const MAX_SHARE_AT_MOST_A_PIXEL: f64 = 0.3;

/// A resolution and why it was chosen.
#[derive(Clone, Debug, PartialEq)]
pub struct ChosenResolution {
    /// Image width and height in pixels.
    pub resolution: u32,
    /// Leaves that own a pixel in some view, at this resolution.
    pub visible_leaves: usize,
    /// Of those, leaves that own at most one pixel in every view.
    pub at_most_a_pixel: usize,
    /// One sentence for a report.
    pub reason: String,
}

/// Chooses the resolution for a foliage and views: the least of [`CANDIDATES`]
/// at which at most [`MAX_SHARE_AT_MOST_A_PIXEL`] of the visible leaves cover at
/// most a pixel in every view, or the largest.
///
/// Draws all views once for each resolution tried.
///
/// # Errors
/// [`VdsError::Raster`] if the rasteriser fails.
pub fn choose(
    foliage: &Foliage,
    views: &ViewSet,
    rasteriser: &dyn Rasteriser,
) -> Result<ChosenResolution, VdsError> {
    let mut tried = Vec::new();
    for resolution in CANDIDATES {
        let seen = visibility_at(foliage, views, resolution, rasteriser)?;
        let share = seen.share_at_most_a_pixel();
        tried.push(format!("{:.0} % at {resolution}", 100.0 * share));
        let is_enough = share <= MAX_SHARE_AT_MOST_A_PIXEL;
        if is_enough || resolution == CANDIDATES[CANDIDATES.len() - 1] {
            return Ok(ChosenResolution {
                resolution,
                visible_leaves: seen.leaves,
                at_most_a_pixel: seen.at_most_a_pixel,
                reason: format!(
                    "of the visible leaves {} cover at most a pixel in every view; {:.0} % may",
                    tried.join(", "),
                    100.0 * MAX_SHARE_AT_MOST_A_PIXEL
                ),
            });
        }
    }
    unreachable!("the largest candidate is always taken")
}

/// The resolution of a run, and why: that which is asked for, that of the effort for the look, and else
/// [`choose`], or the least of [`CANDIDATES`] where there are too many views for the largest.
pub(crate) fn resolution_for(
    foliage: &Foliage,
    options: &Options,
    sphere: BoundingSphere,
    engine: &OpenEngine,
    shared: Option<&mut Shared>,
) -> Result<(u32, String), Error> {
    match options.resolution {
        Resolution::Pixels(n) => return Ok((n, "as asked".to_owned())),
        Resolution::Auto if options.is_for_the_look() => {
            let px = options.effort.work().look_px;
            return Ok((px, format!("{px} pixels are what the look takes")));
        }
        Resolution::Auto => {}
    }
    let mut none = None;
    let known = shared.map_or(&mut none, |shared| &mut shared.resolution);
    if known.is_none() {
        *known = Some(chosen(foliage, &options.first_views(sphere), engine)?);
    }
    Ok(known.clone().expect("chosen above"))
}

/// The least resolution that a run may have.
pub(crate) fn least_resolution(options: &Options) -> u32 {
    match options.resolution {
        Resolution::Pixels(n) => n,
        Resolution::Auto if options.is_for_the_look() => options.effort.work().look_px,
        Resolution::Auto => CANDIDATES[0],
    }
}

fn chosen(foliage: &Foliage, views: &ViewSet, engine: &OpenEngine) -> Result<(u32, String), Error> {
    let [least, .., most] = CANDIDATES;
    if u64::from(most).pow(2) * views.len() as u64 > MAX_TOTAL_PIXELS {
        return Ok((least, "there are too many views to try more".to_owned()));
    }
    let chosen = choose(foliage, views, engine)?;
    Ok((chosen.resolution, chosen.reason))
}

/// How large the leaves of a foliage are in images.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Visibility {
    /// Leaves with an area in some view.
    leaves: usize,
    /// Leaves of them with at most a pixel in every view.
    at_most_a_pixel: usize,
}

impl Visibility {
    /// The share of the visible leaves that cover at most a pixel in every view, 0 to 1.
    pub(crate) fn share_at_most_a_pixel(self) -> f64 {
        self.at_most_a_pixel as f64 / self.leaves.max(1) as f64
    }
}

/// How large the leaves of a foliage are in images of `resolution` x `resolution` pixels. Draws all views once.
///
/// # Errors
/// [`VdsError::Raster`] if the rasteriser fails.
pub(crate) fn visibility_at(
    foliage: &Foliage,
    views: &ViewSet,
    resolution: u32,
    rasteriser: &dyn Rasteriser,
) -> Result<Visibility, VdsError> {
    let scene = Scene {
        foliage,
        lod: &Lod::original(foliage.leaves().len()),
        views,
        resolution,
    };
    let areas = rasteriser.areas(&scene).map_err(VdsError::from_raster)?;
    Ok(visibility(&areas))
}

fn visibility(areas: &AreaTable) -> Visibility {
    let mut largest_px = vec![0u32; areas.leaf_count() + 1];
    for row in areas.rows() {
        for (largest, area_px) in largest_px.iter_mut().zip(row) {
            *largest = (*largest).max(*area_px);
        }
    }
    let leaves = &largest_px[1..];
    Visibility {
        leaves: leaves.iter().filter(|a| **a > 0).count(),
        at_most_a_pixel: leaves.iter().filter(|a| **a == 1).count(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec3;
    use secateur_model::LeafTriangle;
    use secateur_raster::CpuRasteriser;

    #[test]
    fn a_leaf_counts_by_its_largest_area() {
        // Two views of 16 pixels: leaf 1 is seen twice, leaf 2 with one pixel
        // each time, leaf 3 never.
        let areas = AreaTable::from_rows(3, vec![13, 2, 1, 0, 14, 1, 1, 0]);
        let expected = Visibility {
            leaves: 2,
            at_most_a_pixel: 1,
        };
        assert_eq!(visibility(&areas), expected);
    }

    /// A grid of square leaves across the middle of a sphere of radius 1, which
    /// at 256 pixels is about 74 pixels in radius, 0.0135 a pixel.
    fn grid(side: f64) -> Foliage {
        let mut foliage = Foliage::default();
        for k in 0..400 {
            let at = DVec3::new(
                f64::from(k % 20) / 14.5 - 0.65,
                0.2 * f64::from(k % 3) - 0.2,
                f64::from(k / 20) / 14.5 - 0.65,
            );
            let (a, b) = (DVec3::new(1.0, 0.5, 0.0), DVec3::new(0.0, 0.5, 1.0));
            let corners = [at, at + a * side, at + (a + b) * side, at + b * side];
            let triangles =
                [[0, 1, 2], [0, 2, 3]].map(|t| LeafTriangle::plain(t.map(|i: usize| corners[i])));
            foliage.push_leaf(&triangles, None).unwrap();
        }
        foliage
    }

    #[test]
    fn small_leaves_ask_for_more_pixels() {
        let resolution = |side: f64| {
            let foliage = grid(side);
            let views = ViewSet::dodecahedron(foliage.bounding_sphere().unwrap());
            choose(&foliage, &views, &CpuRasteriser).unwrap().resolution
        };
        // Leaves of about five pixels, of three quarters of one, and of a tenth.
        assert_eq!(resolution(0.06), 256);
        assert_eq!(resolution(0.008), 512);
        assert_eq!(resolution(0.001), 1024);
    }
}
