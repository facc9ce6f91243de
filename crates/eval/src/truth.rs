//! What an original truly looks like: many samples a pixel, without mip maps.

use image::RgbaImage;
use secateur_model::Surface;
use secateur_raster::ViewSet;

use crate::averaged::AveragedPicture;
use crate::cut_mask::CutMasks;
use crate::flip::FlipPicture;
use crate::visibility::AlphaFrom;

/// What FLIP sees of the truth is kept from level to level in pictures of at most this many pixels a side.
const MOST_KEPT_PX: u32 = 512;

/// The true picture of a view.
#[derive(Debug)]
pub(crate) struct Truth {
    pub(crate) picture: AveragedPicture,
    /// Where it is no larger than [`MOST_KEPT_PX`]: it takes five times the memory of the picture.
    for_flip: Option<FlipPicture>,
}

impl Truth {
    /// Of each view, `width_px` x `width_px` pixels.
    pub(crate) fn of(original: &[&Surface], views: &ViewSet, width_px: u32) -> Vec<Self> {
        let masks = CutMasks::default();
        let alpha = AlphaFrom::masks(&masks);
        // One after another: of all samples of a view there is a list.
        let views = views.views().iter();
        views
            .map(|view| {
                let picture = AveragedPicture::of(original, view, width_px, alpha);
                Self {
                    for_flip: (width_px <= MOST_KEPT_PX).then(|| picture.for_flip()),
                    picture,
                }
            })
            .collect()
    }

    /// The FLIP of a picture of this view.
    pub(crate) fn flip(&self, image: &RgbaImage) -> f64 {
        let drawn = FlipPicture::of(image);
        match &self.for_flip {
            Some(truth) => truth.mean_error(&drawn),
            None => self.picture.for_flip().mean_error(&drawn),
        }
    }
}

/// Covered pixels over those that truly are. Where no sample of the truth shows the plant it is 1 if
/// nothing is covered, else as for a truth of one sample a pixel that is covered: a finite number.
pub(crate) fn coverage_over_truth(covered_px: f64, truth_px: f64) -> f64 {
    match truth_px > 0.0 {
        true => covered_px / truth_px,
        false => covered_px.max(1.0),
    }
}

/// Pixels that show the plant, over all views, parts of pixels counted.
pub(crate) fn covered_px(truth: &[Truth]) -> f64 {
    truth.iter().map(|truth| truth.picture.covered_px()).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn coverage_of_a_truth_that_no_sample_shows_is_a_number() {
        assert_eq!(coverage_over_truth(3.0, 6.0), 0.5);
        assert_eq!(coverage_over_truth(0.0, 6.0), 0.0);
        assert_eq!(coverage_over_truth(0.0, 0.0), 1.0);
        assert_eq!(coverage_over_truth(3.0, 0.0), 3.0);
    }
}
