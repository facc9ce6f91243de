//! Thresholds of one's own, at which levels are merged.

use std::str::FromStr;

use super::sticks::height_over_radius;
use crate::Segment;

/// Which sticks each level replaces, the finest level first.
#[derive(Clone, Debug, PartialEq)]
pub struct Thresholds {
    of: StickSize,
    values: Vec<f64>,
}

/// What a threshold is held against.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum StickSize {
    /// HR, the paper's: sticks of a larger one are replaced.
    HeightOverRadius,
    /// The diameter of a stick at its start, in metres: thinner ones are replaced.
    Thickness,
}

/// Why a text has no thresholds.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error(
    "`{0}` are no thresholds: write thicknesses in metres such as 0.01,0.02, or heights over radii such as \
     hr:400,200, all above 0 and either rising or falling"
)]
pub struct ThresholdsError(String);

impl StickSize {
    /// The larger it is, the sooner the stick goes.
    pub(super) fn slenderness(self, stick: &Segment, ground_m: f64) -> f64 {
        match self {
            Self::HeightOverRadius => height_over_radius(stick, ground_m),
            Self::Thickness => -2.0 * stick.start_radius_m,
        }
    }
}

impl Thresholds {
    /// What they are held against.
    pub fn of(&self) -> StickSize {
        self.of
    }

    /// The thresholds, the finest level's first.
    pub fn values(&self) -> &[f64] {
        &self.values
    }

    /// A threshold as [`StickSize::slenderness`] has sticks, above which they go; and back.
    pub(super) fn signed(&self, threshold: f64) -> f64 {
        match self.of {
            StickSize::HeightOverRadius => threshold,
            StickSize::Thickness => -threshold,
        }
    }
}

impl FromStr for Thresholds {
    type Err = ThresholdsError;

    fn from_str(text: &str) -> Result<Self, ThresholdsError> {
        let (of, numbers) = match text.strip_prefix("hr:") {
            Some(numbers) => (StickSize::HeightOverRadius, numbers),
            None => (StickSize::Thickness, text),
        };
        let sound = |t: &f64| t.is_finite() && *t > 0.0;
        let values: Option<Vec<f64>> = (numbers.split(','))
            .map(|number| number.trim().parse().ok().filter(sound))
            .collect();
        let no_thresholds = || ThresholdsError(text.chars().take(60).collect());
        let mut values = values.ok_or_else(no_thresholds)?;
        let rise = values.is_sorted_by(|a, b| a < b);
        let fall = values.is_sorted_by(|a, b| a > b);
        let is_finest_first = match of {
            StickSize::HeightOverRadius => fall,
            StickSize::Thickness => rise,
        };
        match rise || fall {
            false => return Err(no_thresholds()),
            true if !is_finest_first => values.reverse(),
            true => {}
        }
        Ok(Self { of, values })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_finest_level_comes_first_however_they_are_written() {
        for text in ["0.01,0.02", "0.02, 0.01"] {
            let read: Thresholds = text.parse().unwrap();
            assert_eq!(
                (read.of(), read.values()),
                (StickSize::Thickness, &[0.01, 0.02][..])
            );
        }
        for text in ["hr:400,200", "hr:200,400"] {
            let read: Thresholds = text.parse().unwrap();
            let expected = (StickSize::HeightOverRadius, &[400.0, 200.0][..]);
            assert_eq!((read.of(), read.values()), expected);
        }
        assert_eq!("0.5".parse::<Thresholds>().unwrap().values(), [0.5]);
    }

    #[test]
    fn numbers_that_are_no_thresholds_are_refused() {
        for text in [
            "",
            "0.01,",
            "-0.01",
            "0",
            "nan",
            "inf",
            "0.01,0.01",
            "0.01,0.03,0.02",
            "a",
            "hr:",
        ] {
            assert!(text.parse::<Thresholds>().is_err(), "{text}");
        }
    }
}
