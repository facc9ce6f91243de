//! How many sticks each level loses.

use std::str::FromStr;

/// The shares of all sticks, in per cent, that each level takes away beyond the
/// one before it: written `50-25-12.5-12.5`.
#[derive(Clone, Debug, PartialEq)]
pub struct Scheme {
    percents: Vec<f64>,
}

/// Why a text is no scheme.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error(
    "`{0}` is no reduction scheme: write shares in per cent, above 0 and 100 together at most, \
     such as 50-25-12.5-12.5"
)]
pub struct SchemeError(String);

impl Scheme {
    /// The paper's faster one: 50-25-12.5-12.5.
    pub fn halving() -> Self {
        Self {
            percents: vec![50.0, 25.0, 12.5, 12.5],
        }
    }

    /// The paper's slower one: 25-25-25-25.
    pub fn even() -> Self {
        Self {
            percents: vec![25.0; 4],
        }
    }

    /// The shares gone at each level, 0 to 1, rising.
    pub fn shares_gone(&self) -> Vec<f64> {
        let gone = |percent: &f64, sum: &mut f64| {
            *sum += percent / 100.0;
            Some(sum.min(1.0))
        };
        let mut sum = 0.0;
        let shares = self.percents.iter();
        shares
            .filter_map(|percent| gone(percent, &mut sum))
            .collect()
    }
}

impl FromStr for Scheme {
    type Err = SchemeError;

    fn from_str(text: &str) -> Result<Self, SchemeError> {
        let percents: Option<Vec<f64>> = text
            .split('-')
            .map(|share| share.trim().parse().ok().filter(|p: &f64| *p > 0.0))
            .collect();
        percents
            .filter(|percents| percents.iter().sum::<f64>() <= 100.0 + 1e-9)
            .map(|percents| Self { percents })
            .ok_or_else(|| SchemeError(text.chars().take(60).collect()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shares_add_up() {
        assert_eq!(Scheme::halving().shares_gone(), [0.5, 0.75, 0.875, 1.0]);
        assert_eq!(Scheme::even().shares_gone(), [0.25, 0.5, 0.75, 1.0]);
        assert_eq!("50-25-12.5-12.5".parse(), Ok(Scheme::halving()));
    }

    #[test]
    fn what_is_no_scheme_is_refused() {
        for text in ["", "50-", "0-50", "-5", "60-60", "nan", "inf", "a"] {
            assert!(text.parse::<Scheme>().is_err(), "{text}");
        }
    }
}
