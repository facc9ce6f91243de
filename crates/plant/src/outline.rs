//! The shapes of leaves: one blade or several, and a stalk.

use std::f64::consts::{PI, TAU};

use crate::language::Outline;

/// A leaf to be drawn, in units of its length: x from the middle, y from 0 at the
/// base to 1 at the tip.
#[derive(Clone, Debug)]
pub(crate) struct Drawing {
    pub(crate) width: f64,
    pub(crate) blades: Vec<Blade>,
    /// How far up the stalk reaches, and half its width.
    stalk: [f64; 2],
    /// How deep the tip is notched.
    notch: f64,
}

/// How the half width of a blade goes from base to tip.
#[derive(Clone, Copy, Debug)]
enum Profile {
    /// Widest where `along ^ skew` is a half; blunt with a small `power`; with a
    /// number of teeth of this depth.
    Egg {
        skew: f64,
        power: f64,
        teeth: f64,
        depth: f64,
    },
    /// Round lobes that point towards the tip.
    Lobed { lobes: f64 },
    /// A pointed lobe with a shoulder on each side, as maples have.
    Shouldered,
}

/// A part of a leaf about a midrib.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Blade {
    base: [f64; 2],
    direction: [f64; 2],
    pub(crate) length: f64,
    pub(crate) half_width: f64,
    pub(crate) side_veins: f64,
    profile: Profile,
}

impl Blade {
    /// A blade from a point on the middle line, leaning by this angle to the right.
    fn new(y: f64, degrees: f64, length: f64, half_width: f64, profile: Profile) -> Self {
        let (sin, cos) = libm::sincos(degrees.to_radians());
        Self {
            base: [0.0, y],
            direction: [sin, cos],
            length,
            half_width,
            side_veins: 0.0,
            profile,
        }
    }

    fn with_side_veins(self, side_veins: f64) -> Self {
        Self { side_veins, ..self }
    }

    /// How far along the midrib a point is, 0 to 1, and how far aside, in units of
    /// the leaf's length.
    pub(crate) fn coordinates(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        let [dx, dy] = [x - self.base[0], y - self.base[1]];
        let [right, up] = self.direction;
        [(dx * right + dy * up) / self.length, dx * up - dy * right]
    }

    fn contains(&self, point: [f64; 2]) -> bool {
        let [along, aside] = self.coordinates(point);
        let share = aside.abs() / self.half_width;
        (0.0..1.0).contains(&along) && share < 1.0 && share < self.profile.half_width(along, share)
    }
}

impl Profile {
    fn half_width(self, along: f64, share: f64) -> f64 {
        match self {
            Self::Egg {
                skew,
                power,
                teeth,
                depth,
            } => {
                let egg = libm::pow(libm::sin(PI * libm::pow(along, skew)), power);
                let tooth = teeth * along - libm::floor(teeth * along);
                egg * (1.0 - depth * tooth)
            }
            Self::Lobed { lobes } => {
                // Lobes point towards the tip: heights are read lower the farther
                // from the midrib.
                let along = along - 0.16 * share * (1.0 - along);
                if along <= 0.0 {
                    return 0.0;
                }
                // Widest above the middle, as English oak is.
                let envelope = libm::pow(libm::sin(PI * libm::pow(along, 1.3)), 0.62);
                let wave = 0.5 + 0.5 * libm::cos(TAU * (lobes * along - 0.62));
                let deep = 0.42 * libm::pow(1.0 - wave, 1.2);
                0.97 * envelope * (1.0 - deep * (1.0 - 0.75 * along * along * along))
            }
            Self::Shouldered => {
                let taper = if along < 0.58 {
                    0.55 + 0.45 * along / 0.58
                } else {
                    (1.0 - along) / 0.42 * 0.72
                };
                taper.max(0.0)
            }
        }
    }
}

impl Drawing {
    /// Whether a point is leaf rather than cut out.
    pub(crate) fn contains(&self, point: [f64; 2]) -> bool {
        let [x, y] = point;
        if y < self.stalk[0] && x.abs() < self.stalk[1] {
            return true;
        }
        if y > 1.0 - self.notch + x.abs() {
            return false;
        }
        self.blades.iter().any(|blade| blade.contains(point))
    }
}

/// The drawing of an outline on a card of this width.
pub(crate) fn drawing(outline: Outline, width: f64) -> Drawing {
    let half = 0.5 * width;
    let egg = |skew, power| Profile::Egg {
        skew,
        power,
        teeth: 1.0,
        depth: 0.0,
    };
    let toothed = |skew, power, teeth, depth| Profile::Egg {
        skew,
        power,
        teeth,
        depth,
    };
    let (blades, stalk, notch) = match outline {
        Outline::Plain => (
            vec![Blade::new(0.0, 0.0, 1.0, half, egg(1.0, 0.01))],
            0.0,
            0.0,
        ),
        Outline::Lobed => {
            let profile = Profile::Lobed { lobes: 4.0 };
            let blade = Blade::new(0.1, 0.0, 0.885, half, profile).with_side_veins(4.0);
            (vec![blade], 0.2, 0.0)
        }
        Outline::Ovate => {
            let profile = toothed(0.62, 0.95, 13.0, 0.11);
            let blade = Blade::new(0.16, 0.0, 0.83, half, profile).with_side_veins(6.0);
            (vec![blade], 0.2, 0.0)
        }
        Outline::Round => {
            let profile = toothed(1.18, 0.52, 11.0, 0.07);
            let blade = Blade::new(0.14, 0.0, 0.86, half, profile).with_side_veins(6.0);
            (vec![blade], 0.2, 0.09)
        }
        Outline::Elliptic => {
            let blade = Blade::new(0.06, 0.0, 0.93, half, egg(0.95, 0.75)).with_side_veins(5.0);
            (vec![blade], 0.1, 0.0)
        }
        Outline::Lanceolate => {
            let blade = Blade::new(0.05, 0.0, 0.95, half, egg(0.8, 0.9));
            (vec![blade], 0.1, 0.0)
        }
        Outline::Palmate => (palmate(), 0.3, 0.0),
        Outline::Pinnate => (pinnate(2, 0.42, 0.34, 0.1, 0.5, 62.0), 0.62, 0.0),
        Outline::PinnateFine => (pinnate(7, 0.22, 0.12, 0.033, 0.27, 66.0), 0.82, 0.0),
        Outline::Fan => (fan(), 0.42, 0.0),
    };
    Drawing {
        width,
        blades,
        stalk: [stalk, 0.022 * width.max(0.5)],
        notch,
    }
}

/// Five lobes from one point.
fn palmate() -> Vec<Blade> {
    let lobes = [
        (0.0, 0.74, 0.125),
        (48.0, 0.64, 0.11),
        (-48.0, 0.64, 0.11),
        (98.0, 0.42, 0.075),
        (-98.0, 0.42, 0.075),
    ];
    let lobe = |(degrees, length, half_width)| {
        Blade::new(0.25, degrees, length, half_width, Profile::Shouldered)
    };
    let web = Profile::Egg {
        skew: 1.0,
        power: 0.5,
        teeth: 1.0,
        depth: 0.0,
    };
    let web = Blade::new(0.2, 0.0, 0.42, 0.24, web);
    lobes.map(lobe).into_iter().chain([web]).collect()
}

/// Leaflets in pairs along the upper part of a stalk and one at its end.
fn pinnate(
    pairs: u32,
    longest: f64,
    first_at: f64,
    half_width: f64,
    spread: f64,
    degrees: f64,
) -> Vec<Blade> {
    let profile = Profile::Egg {
        skew: 0.9,
        power: 0.85,
        teeth: 9.0,
        depth: 0.06,
    };
    let mut blades = Vec::new();
    for pair in 0..pairs {
        let share = f64::from(pair) / f64::from((pairs - 1).max(1));
        let y = first_at + share * (if pairs > 4 { 0.68 } else { 0.26 });
        // The lowest pair is smaller than those above it.
        let length = longest * (0.78 + 0.22 * libm::sin(PI * (0.25 + 0.6 * share)));
        for side in [-1.0, 1.0] {
            let angle = side * (degrees - 14.0 * share);
            blades.push(Blade::new(
                y,
                angle,
                length,
                half_width * length / longest,
                profile,
            ));
        }
    }
    let end: f64 = if pairs > 4 { 0.78 } else { 0.6 };
    let terminal = (0.99 - end).min(spread);
    let wide = if pairs > 4 { 1.0 } else { 1.15 };
    blades.push(Blade::new(end, 0.0, terminal, half_width * wide, profile));
    blades
}

/// Narrow segments from one point, like a hand fan.
fn fan() -> Vec<Blade> {
    let segments = 19;
    let profile = Profile::Egg {
        skew: 0.8,
        power: 0.8,
        teeth: 1.0,
        depth: 0.0,
    };
    let segment = |k: u32| {
        let share = f64::from(k) / f64::from(segments - 1);
        let degrees = -128.0 + 256.0 * share;
        let length = 0.58 - 0.16 * (2.0 * share - 1.0).abs();
        Blade::new(0.4, degrees, length, 0.042, profile)
    };
    let web = Blade::new(0.28, 0.0, 0.4, 0.2, Profile::Shouldered);
    (0..segments).map(segment).chain([web]).collect()
}
