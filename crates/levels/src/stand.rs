//! Which level each plant of a stand has: the least of one figure of all while another stays within a limit.
//!
//! Every place has options, its levels. One factor L turns both figures into one: each place takes the option with the
//! least *figure + L x limited figure*, and L is sought by halving, as small as the limit lets it be (Lagrange). That
//! is the best choice there is for the sum that it has.

/// What a level would mean where a plant stands.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct LevelThere {
    /// What it costs the scene, 0 or more.
    pub cost: f64,
    /// How far the pictures of the scene get from the plants' own by it, 0 or more.
    pub error: f64,
}

/// How often the interval of the factor is halved.
const HALVINGS: usize = 60;

/// The factors that are tried, as powers of ten.
const FACTORS: [f64; 2] = [-30.0, 30.0];

/// The cheapest levels whose errors come to no more than this, by place; those of the least error where that cannot be.
///
/// # Panics
/// If a place has no level.
pub fn cheapest_within_error(places: &[Vec<LevelThere>], most_error: f64) -> Vec<usize> {
    least(places, most_error, |level| [level.cost, level.error])
}

/// The levels nearest to the plants that cost no more than this, by place; those of the least cost where that cannot be.
///
/// # Panics
/// If a place has no level.
pub fn nearest_within_cost(places: &[Vec<LevelThere>], most_cost: f64) -> Vec<usize> {
    least(places, most_cost, |level| [level.error, level.cost])
}

fn least(
    places: &[Vec<LevelThere>],
    limit: f64,
    figures: impl Fn(&LevelThere) -> [f64; 2],
) -> Vec<usize> {
    let by = |key: &dyn Fn([f64; 2]) -> [f64; 2]| -> Vec<usize> {
        let of_place = |levels: &Vec<LevelThere>| {
            let keys = levels.iter().map(|level| key(figures(level)));
            let least = keys
                .enumerate()
                .min_by(|(_, a), (_, b)| a[0].total_cmp(&b[0]).then(a[1].total_cmp(&b[1])));
            least.expect("every place has a level").0
        };
        places.iter().map(of_place).collect()
    };
    let is_within = |chosen: &[usize]| {
        let pairs = places.iter().zip(chosen);
        pairs
            .map(|(levels, k)| figures(&levels[*k])[1])
            .sum::<f64>()
            <= limit
    };
    let free = by(&|[figure, limited]| [figure, limited]);
    if is_within(&free) {
        return free;
    }
    let mut best = by(&|[figure, limited]| [limited, figure]);
    let [mut low, mut high] = FACTORS;
    for _ in 0..HALVINGS {
        let power = 0.5 * (low + high);
        let factor = 10f64.powf(power);
        let chosen = by(&|[figure, limited]| [figure + factor * limited, limited]);
        if is_within(&chosen) {
            (best, high) = (chosen, power);
        } else {
            low = power;
        }
    }
    best
}

/// How far a level looks from its plant per pixel of it, shown so many pixels high, from the mean FLIP `mean` that it has
/// at the height it was made for: more where it is shown higher, since more of it can be told, by the square root.
pub fn error_a_pixel(mean: f64, made_for_px: f64, pixels_high: f64) -> f64 {
    match made_for_px.is_finite() && made_for_px > 0.0 {
        true => mean * (pixels_high.min(MOST_PX) / made_for_px).sqrt(),
        false => mean,
    }
}

/// Plants that a camera stands in are taken for this many pixels high.
const MOST_PX: f64 = 1e5;

#[cfg(test)]
mod tests {
    use super::*;

    fn place(levels: &[[f64; 2]]) -> Vec<LevelThere> {
        let level = |[cost, error]: &[f64; 2]| LevelThere {
            cost: *cost,
            error: *error,
        };
        levels.iter().map(level).collect()
    }

    /// A near plant that shows every error, and a far one that shows little: within an error of 2 the far one is made
    /// lighter, within one of 12 both are.
    #[test]
    fn what_shows_least_for_what_it_saves_is_made_lighter_first() {
        let near = place(&[[100.0, 0.0], [50.0, 10.0]]);
        let far = place(&[[100.0, 0.0], [50.0, 1.0], [10.0, 2.0]]);
        let places = [near, far];
        assert_eq!(cheapest_within_error(&places, 0.0), [0, 0]);
        assert_eq!(cheapest_within_error(&places, 2.0), [0, 2]);
        assert_eq!(cheapest_within_error(&places, 12.0), [1, 2]);
        // And 150 pays for the near one whole, with the far one at half.
        assert_eq!(nearest_within_cost(&places, 150.0), [0, 1]);
        assert_eq!(nearest_within_cost(&places, 110.0), [0, 2]);
        // Nothing is as cheap as that: the cheapest there is.
        assert_eq!(nearest_within_cost(&places, 1.0), [1, 2]);
    }

    #[test]
    fn a_level_shown_larger_than_it_was_made_for_is_farther_off() {
        assert_eq!(error_a_pixel(0.1, 100.0, 100.0), 0.1);
        assert_eq!(error_a_pixel(0.1, 100.0, 400.0), 0.2);
        assert_eq!(error_a_pixel(0.0, f64::INFINITY, 400.0), 0.0);
    }
}
