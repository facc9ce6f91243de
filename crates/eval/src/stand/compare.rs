//! How far a picture of a stand is from another of the same places.

use super::StandPicture;
use crate::difference::{judged_pixels, of_picture};
use crate::flip::FlipPicture;
use crate::visibility::NOTHING;

/// How far a picture of a stand is from that of the stand itself.
#[derive(Clone, Debug, PartialEq)]
pub struct StandDifference {
    /// Mean FLIP over the whole picture, 0 to 1.
    pub flip_mean: f64,
    /// As the difference of a level, over the pixels of plants in this picture alone: max(B, 1.75 M), 0 to 1.75.
    pub difference: f64,
    /// By place, the sum of FLIP over the pixels that show it, in pixels.
    pub flip_px: Vec<f64>,
}

/// A picture, and what FLIP sees of it.
#[derive(Clone, Debug)]
pub struct JudgedStand {
    /// The picture.
    pub picture: StandPicture,
    flip: FlipPicture,
}

impl JudgedStand {
    /// What other pictures are held against.
    pub fn new(picture: StandPicture) -> Self {
        let flip = FlipPicture::of(&picture.image);
        Self { picture, flip }
    }

    /// How far another picture by the same camera is from this one; with the other's places in the same order.
    ///
    /// # Panics
    /// If the pictures are of other sizes.
    pub fn difference(&self, other: &StandPicture) -> StandDifference {
        let errors = self.flip.errors(&FlipPicture::of(&other.image));
        let width = self.picture.image.width() as usize;
        let mut flip_px = vec![0.0; self.picture.seen_px.len().max(other.seen_px.len())];
        let shown = self.picture.shown.iter().zip(&other.shown);
        for ((own, others), error) in shown.zip(&errors) {
            let place = if *own == NOTHING { *others } else { *own };
            if let Some(sum) = flip_px.get_mut(place as usize) {
                *sum += f64::from(*error);
            }
        }
        let judged = judged_pixels(&self.picture.coverage, &other.coverage, width);
        let errors_there: Vec<f32> = judged.iter().map(|k| errors[*k as usize]).collect();
        let sum: f64 = errors.iter().copied().map(f64::from).sum();
        StandDifference {
            flip_mean: sum / errors.len().max(1) as f64,
            difference: of_picture(&judged, &errors_there, [width, errors.len() / width.max(1)]),
            flip_px,
        }
    }
}
