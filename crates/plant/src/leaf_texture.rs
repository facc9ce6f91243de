//! Leaves drawn texel by texel: an outline to be cut out, and veins.

use std::f64::consts::PI;

use secateur_model::{Texture, Wrap};

use crate::language::{Outline, Settings};
use crate::outline::{Blade, Drawing, drawing};

/// Width and height of the drawing, in texels.
const SIZE: u32 = 128;
/// Samples along each side of a texel for the soft edge of the outline.
const SAMPLES: u32 = 4;

/// A leaf, its stalk at the bottom middle: sRGB and alpha, cut out at 0.5; none
/// for [`Outline::Plain`]. Colour goes on outside the outline, so that filtering
/// brings in no dark edge.
pub(crate) fn leaf_texture(settings: &Settings) -> Option<Texture> {
    if settings.leaf_outline == Outline::Plain {
        return None;
    }
    let leaf = drawing(settings.leaf_outline, settings.leaf_width);
    let mut rgba = Vec::with_capacity(4 * (SIZE * SIZE) as usize);
    for y in 0..SIZE {
        for x in 0..SIZE {
            let at = coordinates(&leaf, f64::from(x) + 0.5, f64::from(y) + 0.5);
            rgba.extend(color(&leaf, settings.leaf_colour, at).map(to_byte));
            rgba.push(to_byte(coverage(&leaf, x, y)));
        }
    }
    Some(Texture {
        width: SIZE,
        height: SIZE,
        rgba,
        wrap: [Wrap::ClampToEdge; 2],
        filters: secateur_model::Filters::default(),
    })
}

pub(crate) fn to_byte(value: f64) -> u8 {
    (value.clamp(0.0, 1.0) * 255.0 + 0.5) as u8
}

/// Texels to leaf coordinates in units of the leaf's length: x from the middle,
/// y from base to tip.
fn coordinates(leaf: &Drawing, x: f64, y: f64) -> [f64; 2] {
    let size = f64::from(SIZE);
    [(x / size - 0.5) * leaf.width, 1.0 - y / size]
}

fn coverage(leaf: &Drawing, x: u32, y: u32) -> f64 {
    let at =
        |texel: u32, sample: u32| f64::from(texel) + (f64::from(sample) + 0.5) / f64::from(SAMPLES);
    let samples = (0..SAMPLES).flat_map(|i| (0..SAMPLES).map(move |j| (i, j)));
    let inside = samples.filter(|&(i, j)| leaf.contains(coordinates(leaf, at(x, i), at(y, j))));
    inside.count() as f64 / f64::from(SAMPLES * SAMPLES)
}

/// sRGB: lighter veins, a shade darker towards midrib and base.
fn color(leaf: &Drawing, ground: [f64; 3], [x, y]: [f64; 2]) -> [f64; 3] {
    let line = |distance: f64, width: f64| libm::exp(-(distance * distance) / (width * width));
    let vein = |blade: &Blade| {
        let [along, aside] = blade.coordinates([x, y]);
        if !(-0.02..=1.0).contains(&along) || aside.abs() > blade.half_width {
            return 0.0;
        }
        let share = aside.abs() / blade.half_width;
        let midrib = line(aside, 0.012 + 0.012 * blade.length * (1.0 - along));
        let phase =
            blade.side_veins * (along - 0.42 * share * blade.half_width / blade.length) - 0.42;
        let from_side_vein = (phase - libm::round(phase)).abs() / blade.side_veins.max(1.0);
        let side = if blade.side_veins > 0.0 {
            0.5 * line(from_side_vein, 0.014) * (1.0 - 0.6 * share)
        } else {
            0.0
        };
        midrib.max(side)
    };
    let vein = leaf.blades.iter().map(vein).fold(0.0, f64::max);
    let mottle = 0.03 * libm::sin(11.0 * PI * x + 9.0 * y) * libm::sin(17.0 * y - 5.0 * x);
    let light = 0.84 + 0.2 * x.abs() / leaf.width + 0.1 * y + mottle;
    let pale = ground.map(|c| c + 0.32 * (1.0 - c));
    std::array::from_fn(|i| ground[i] * light * (1.0 - 0.8 * vein) + pale[i] * 0.8 * vein)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn texture(leaf_outline: Outline, leaf_width: f64) -> Texture {
        let settings = Settings {
            leaf_outline,
            leaf_width,
            ..Settings::default()
        };
        leaf_texture(&settings).unwrap()
    }

    fn texel(texture: &Texture, x: u32, y: u32) -> [u8; 4] {
        let start = 4 * (y * texture.width + x) as usize;
        texture.rgba[start..start + 4].try_into().unwrap()
    }

    #[test]
    fn leaves_are_inside_and_their_corners_are_cut_out() {
        for (outline, width, least, most) in [
            (Outline::Lobed, 0.74, 0.4, 0.75),
            (Outline::Ovate, 0.75, 0.35, 0.75),
            (Outline::Round, 0.9, 0.45, 0.85),
            (Outline::Palmate, 1.1, 0.25, 0.7),
            (Outline::Lanceolate, 0.18, 0.4, 0.8),
            (Outline::Pinnate, 0.9, 0.2, 0.65),
            (Outline::PinnateFine, 0.55, 0.25, 0.75),
            (Outline::Fan, 1.2, 0.25, 0.75),
            (Outline::Elliptic, 0.5, 0.4, 0.85),
        ] {
            let leaf = texture(outline, width);
            assert_eq!(leaf.rgba.len(), 128 * 128 * 4);
            assert_eq!(texel(&leaf, 64, 126)[3], 255, "{outline:?}: the stalk");
            for (x, y) in [(0, 0), (127, 0), (0, 127), (127, 127)] {
                assert_eq!(texel(&leaf, x, y)[3], 0, "{outline:?} at {x}, {y}");
            }
            let set = leaf.rgba.chunks(4).filter(|t| t[3] >= 128).count();
            let share = set as f64 / (128.0 * 128.0);
            assert!(
                (least..most).contains(&share),
                "{outline:?} fills {share} of its card"
            );
        }
    }

    #[test]
    fn colour_goes_on_outside_the_outline() {
        for t in texture(Outline::Lobed, 0.74).rgba.chunks(4) {
            assert!(
                t[1] > 60 && t[1] > t[0] && t[0] > t[2],
                "green everywhere: {t:?}"
            );
        }
    }
}
