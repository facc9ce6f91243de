//! A lobed oak leaf, drawn texel by texel.

use std::f64::consts::{PI, TAU};

use secateur_model::{Texture, Wrap};

/// Width and height of the drawing, in texels.
const SIZE: u32 = 128;
/// Samples along each side of a texel for the soft edge of the outline.
const SAMPLES: u32 = 4;
/// Where the blade starts, as a share of the height; the stalk is below.
const BLADE_START: f64 = 0.1;
/// Lobes on each side.
const LOBES: f64 = 4.0;

/// An oak leaf, its stalk at the bottom middle: sRGB and alpha, cut out at 0.5.
/// Colour goes on outside the outline, so that filtering brings in no dark edge.
pub(crate) fn oak_leaf_texture() -> Texture {
    let mut rgba = Vec::with_capacity(4 * (SIZE * SIZE) as usize);
    for y in 0..SIZE {
        for x in 0..SIZE {
            let (across, up) = leaf_coordinates(f64::from(x) + 0.5, f64::from(y) + 0.5);
            rgba.extend(color(across, up).map(to_byte));
            rgba.push(to_byte(coverage(x, y)));
        }
    }
    Texture {
        width: SIZE,
        height: SIZE,
        rgba,
        wrap: [Wrap::ClampToEdge; 2],
    }
}

fn to_byte(value: f64) -> u8 {
    (value.clamp(0.0, 1.0) * 255.0 + 0.5) as u8
}

/// Texels to leaf coordinates: -1 to 1 from edge to edge, 0 to 1 from base to tip.
fn leaf_coordinates(x: f64, y: f64) -> (f64, f64) {
    let size = f64::from(SIZE);
    (2.0 * x / size - 1.0, 1.0 - y / size)
}

fn coverage(x: u32, y: u32) -> f64 {
    let at =
        |texel: u32, sample: u32| f64::from(texel) + (f64::from(sample) + 0.5) / f64::from(SAMPLES);
    let samples = (0..SAMPLES).flat_map(|i| (0..SAMPLES).map(move |j| (i, j)));
    let inside = samples.filter(|&(i, j)| {
        let (across, up) = leaf_coordinates(at(x, i), at(y, j));
        across.abs() < half_width(across.abs(), up)
    });
    inside.count() as f64 / f64::from(SAMPLES * SAMPLES)
}

/// Half the leaf's width at a height. Lobes point towards the tip, so heights
/// are read lower the farther from the midrib.
fn half_width(across: f64, up: f64) -> f64 {
    let stalk = if up < BLADE_START + 0.1 { 0.035 } else { 0.0 };
    let blade = (up - BLADE_START) / (0.985 - BLADE_START);
    let along = blade - 0.16 * across * (1.0 - blade);
    if !(0.0..1.0).contains(&along) || blade >= 1.0 {
        return stalk;
    }
    // Widest above the middle, as English oak is.
    let envelope = libm::pow(libm::sin(PI * libm::pow(along, 1.3)), 0.62);
    let wave = 0.5 + 0.5 * libm::cos(TAU * (LOBES * along - 0.62));
    let lobed = 1.0 - 0.42 * libm::pow(1.0 - wave, 1.2) * (1.0 - 0.75 * along * along * along);
    (0.97 * envelope * lobed).max(stalk)
}

/// sRGB green: lighter veins, a shade darker towards midrib and base.
fn color(across: f64, up: f64) -> [f64; 3] {
    let blade = (up - BLADE_START) / (0.985 - BLADE_START);
    let distance = across.abs();
    let side_vein_phase = LOBES * (blade - 0.42 * distance) - 0.42;
    let from_side_vein = (side_vein_phase - libm::round(side_vein_phase)).abs() / LOBES;
    let line = |distance: f64, width: f64| libm::exp(-(distance * distance) / (width * width));
    let midrib = line(distance, 0.035);
    let side_vein = 0.6 * line(from_side_vein, 0.014) * (1.0 - 0.6 * distance);
    let vein = midrib.max(side_vein);
    let mottle = 0.03 * libm::sin(23.0 * across + 9.0 * up) * libm::sin(17.0 * up - 5.0 * across);
    let light = 0.82 + 0.14 * distance + 0.1 * up + mottle;
    let green = [0.33, 0.50, 0.16];
    let vein_green = [0.60, 0.70, 0.36];
    std::array::from_fn(|i| (green[i] * light) * (1.0 - vein) + vein_green[i] * vein)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn texel(texture: &Texture, x: u32, y: u32) -> [u8; 4] {
        let start = 4 * (y * texture.width + x) as usize;
        texture.rgba[start..start + 4].try_into().unwrap()
    }

    #[test]
    fn the_leaf_is_inside_and_its_corners_are_cut_out() {
        let leaf = oak_leaf_texture();
        assert_eq!(leaf.rgba.len(), 128 * 128 * 4);
        assert_eq!(texel(&leaf, 64, 64)[3], 255, "the middle is leaf");
        assert_eq!(texel(&leaf, 64, 126)[3], 255, "the stalk reaches the base");
        for (x, y) in [(0, 0), (127, 0), (0, 127), (127, 127)] {
            assert_eq!(texel(&leaf, x, y)[3], 0);
        }
        let set = leaf.rgba.chunks(4).filter(|t| t[3] >= 128).count();
        let share = set as f64 / (128.0 * 128.0);
        assert!(
            (0.4..0.8).contains(&share),
            "a leaf fills {share} of its card"
        );
    }

    #[test]
    fn colour_goes_on_outside_the_outline() {
        let leaf = oak_leaf_texture();
        for t in leaf.rgba.chunks(4) {
            assert!(
                t[1] > 60 && t[1] > t[0] && t[0] > t[2],
                "green everywhere: {t:?}"
            );
        }
    }
}
