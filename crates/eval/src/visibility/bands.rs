//! Bands of rows of the raster, each of which is drawn by itself.

use std::sync::Arc;

use secateur_model::Surface;

use super::{Alpha, AlphaFrom, BAND_ROWS, Band, Culling, NOTHING, Seek, is_front};
use crate::cut_mask::CutMask;
use crate::lens::Lens;
use crate::mips::MipChains;
use crate::screen_triangle::{ScreenTriangle, screen_triangles};

/// What a lens sees of surfaces, ready to be drawn in bands of rows.
pub(crate) struct Bands<'a> {
    surfaces: &'a [&'a Surface],
    mips: Option<&'a MipChains>,
    /// By surface, what is known of its alpha.
    masks: Vec<Option<Arc<CutMask>>>,
    seek: Seek,
    /// Width and height of the raster in samples.
    size: [usize; 2],
    /// Rows of samples in a band; the last may have fewer.
    rows: usize,
    pub(crate) triangles: Vec<ScreenTriangle>,
    /// By band, the places in `triangles` of those that may be seen in it.
    members: Vec<Vec<u32>>,
}

/// Some rows of samples of what is seen.
#[derive(Clone, Copy)]
pub(crate) struct SeenRows<'a> {
    pub(crate) first_row: usize,
    /// Samples in a row.
    pub(crate) width: usize,
    /// Row by row: a place in a list of triangles, or [`NOTHING`].
    pub(crate) frontmost: &'a [u32],
}

impl SeenRows<'_> {
    /// The frontmost triangle at a column and row of the raster.
    pub(crate) fn at(&self, column: u32, row: u32) -> u32 {
        self.frontmost[(row as usize - self.first_row) * self.width + column as usize]
    }
}

/// Memory for the samples of a band.
#[derive(Default)]
pub(crate) struct BandSamples {
    frontmost: Vec<u32>,
    nearness: Vec<f32>,
}

impl<'a> Bands<'a> {
    pub(super) fn of(
        surfaces: &'a [&'a Surface],
        lens: &Lens,
        (culling, seek): (Culling, Seek),
        alpha: AlphaFrom<'a>,
        rows: usize,
    ) -> Self {
        let mut triangles = screen_triangles(surfaces, lens);
        if culling == Culling::Material {
            triangles.retain(|triangle| {
                let surface = surfaces[triangle.face.surface as usize];
                surface.material.double_sided || is_front(triangle)
            });
        }
        let mask = |surface: &&Surface| alpha.masks?.of(&surface.material);
        Self {
            surfaces,
            mips: alpha.mips,
            masks: surfaces.iter().map(mask).collect(),
            seek,
            size: [lens.width as usize, lens.height as usize],
            rows,
            members: triangles_by_band(&triangles, (lens.height as usize, rows), seek),
            triangles,
        }
    }

    /// As [`visibility`] draws, in bands of about [`BAND_ROWS`] rows, which are whole pixels of `samples` rows each.
    pub(crate) fn of_pixels(
        surfaces: &'a [&'a Surface],
        lens: &Lens,
        alpha: AlphaFrom<'a>,
        samples: usize,
    ) -> Self {
        let rows = (BAND_ROWS / samples).max(1) * samples;
        let how = (Culling::Material, Seek::Frontmost);
        Self::of(surfaces, lens, how, alpha, rows)
    }

    /// Rows of samples in a band.
    pub(crate) fn rows(&self) -> usize {
        self.rows
    }

    /// What is seen in a band, drawn into memory that may have been used before; nothing where no triangle lies in it.
    pub(crate) fn seen<'m>(
        &self,
        band: usize,
        memory: &'m mut BandSamples,
    ) -> Option<SeenRows<'m>> {
        if self.members.get(band)?.is_empty() {
            return None;
        }
        let BandSamples {
            frontmost,
            nearness,
        } = memory;
        let ([width, height], first_row) = (self.size, band * self.rows);
        let samples = width * self.rows.min(height - first_row);
        frontmost.clear();
        frontmost.resize(samples, NOTHING);
        nearness.clear();
        nearness.resize(samples, f32::NEG_INFINITY);
        self.draw(band, (frontmost, nearness));
        Some(SeenRows {
            first_row,
            width,
            frontmost,
        })
    }

    /// Draws a band into samples where nothing is seen yet.
    pub(super) fn draw(&self, band: usize, samples: (&mut [u32], &mut [f32])) {
        let mut drawn = Band::new(band * self.rows, self.size[0], self.seek, samples);
        for &member in &self.members[band] {
            let triangle = &self.triangles[member as usize];
            let number = triangle.face.surface;
            let alpha = Alpha {
                mips: self.mips.and_then(|mips| mips.of_surface(number)),
                mask: self.masks[number as usize].as_deref(),
            };
            let surface = self.surfaces[number as usize];
            drawn.draw(member, triangle, surface, alpha);
        }
    }
}

/// Places in `triangles`, the nearest first: of what is hidden little is then looked at closely. In any
/// order where nothing is hidden.
pub(super) fn triangles_by_band(
    triangles: &[ScreenTriangle],
    (height, rows): (usize, usize),
    seek: Seek,
) -> Vec<Vec<u32>> {
    let nearest = |triangle: &ScreenTriangle| {
        let corners = triangle.corners.iter().map(|corner| corner.nearness);
        corners.fold(f32::MIN, f32::max)
    };
    let nearest = triangles.iter().map(nearest).zip(0..);
    let mut nearest_first: Vec<(f32, u32)> = nearest.collect();
    if seek == Seek::Frontmost {
        nearest_first.sort_unstable_by(|a, b| b.0.total_cmp(&a.0));
    }
    let mut bands = vec![Vec::new(); height.div_ceil(rows)];
    for (_, index) in nearest_first {
        let [a, b, c] = triangles[index as usize].corners.map(|corner| corner.at.y);
        let (low, high) = (a.min(b).min(c), a.max(b).max(c));
        let first = low.max(0.0) as usize / rows;
        let last = (high as usize / rows).min(bands.len().saturating_sub(1));
        for band in bands.iter_mut().take(last + 1).skip(first) {
            band.push(index);
        }
    }
    bands
}
