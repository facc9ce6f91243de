//! Bark drawn texel by texel; it repeats in both directions.

use std::f64::consts::TAU;

use secateur_model::{Texture, Wrap};

use crate::language::{Bark, Settings};
use crate::leaf_texture::to_byte;

const WIDTH: u32 = 64;
const HEIGHT: u32 = 128;

/// The bark of these settings: sRGB; none for [`Bark::Plain`].
pub(crate) fn bark_texture(settings: &Settings) -> Option<Texture> {
    let pattern = settings.bark_pattern;
    if pattern == Bark::Plain {
        return None;
    }
    let mut rgba = Vec::with_capacity((4 * WIDTH * HEIGHT) as usize);
    for y in 0..HEIGHT {
        for x in 0..WIDTH {
            let u = (f64::from(x) + 0.5) / f64::from(WIDTH);
            let v = (f64::from(y) + 0.5) / f64::from(HEIGHT);
            let light = light(pattern, u, v);
            rgba.extend(settings.bark_colour.map(|c| to_byte(c * light)));
            rgba.push(255);
        }
    }
    Some(Texture {
        width: WIDTH,
        height: HEIGHT,
        rgba,
        wrap: [Wrap::Repeat; 2],
        filters: secateur_model::Filters::default(),
    })
}

/// How light the bark is, 1 for its own colour; u goes around and v along.
fn light(pattern: Bark, u: f64, v: f64) -> f64 {
    let wave = |a: f64, b: f64, phase: f64| libm::sin(TAU * (a * u + b * v) + phase);
    match pattern {
        Bark::Plain => 1.0,
        Bark::Ridged => {
            let bent = 0.6 * wave(1.0, 2.0, 0.4) + 0.4 * wave(2.0, -3.0, 1.9);
            let ridge = libm::sin(TAU * 7.0 * u + 1.6 * bent);
            let cracks = wave(5.0, 9.0, 0.7) * wave(3.0, -7.0, 2.1);
            0.86 + 0.2 * ridge + 0.1 * cracks
        }
        Bark::Banded => {
            // Rows of dashes, each at its own place around.
            let row = libm::floor(v * 22.0);
            let hash = |salt: f64| {
                let x = libm::sin(row * 12.9898 + salt) * 43758.5453;
                x - libm::floor(x)
            };
            let within = v * 22.0 - row;
            let mut around = u - hash(1.0);
            around -= libm::floor(around);
            let is_dash = around < 0.12 + 0.4 * hash(2.0) && within < 0.3 + 0.3 * hash(3.0);
            let scar = hash(4.0) > 0.86 && around < 0.5;
            match (is_dash, scar) {
                (_, true) => 0.26,
                (true, _) => 0.42,
                _ => 0.97 + 0.04 * wave(1.0, 3.0, 0.0),
            }
        }
        Bark::Plated => {
            let column = libm::floor(5.0 * u);
            let shift = 0.37 * column - libm::floor(0.37 * column);
            let across = 5.0 * u - column;
            let along = 6.0 * (v + shift) - libm::floor(6.0 * (v + shift));
            let seam = across.min(1.0 - across).min(1.6 * along.min(1.0 - along));
            0.55 + 0.5 * (seam * 5.0).min(1.0) + 0.06 * wave(3.0, 5.0, 1.0)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bark_is_opaque_and_birch_has_light_and_dark() {
        let settings = Settings {
            bark_pattern: Bark::Banded,
            bark_colour: [0.9, 0.9, 0.88],
            ..Settings::default()
        };
        let bark = bark_texture(&settings).unwrap();
        assert!(bark.rgba.chunks(4).all(|t| t[3] == 255));
        let dark = bark.rgba.chunks(4).filter(|t| t[0] < 120).count();
        let share = dark as f64 / f64::from(WIDTH * HEIGHT);
        assert!((0.05..0.35).contains(&share), "{share} of it is dark");
        let plain = Settings {
            bark_pattern: Bark::Plain,
            ..settings
        };
        assert_eq!(bark_texture(&plain), None);
    }
}
