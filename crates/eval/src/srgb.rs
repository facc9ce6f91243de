//! Colours as bytes of sRGB and as light (IEC 61966-2-1).

use std::sync::LazyLock;

/// The light of each sRGB byte, 0 to 1.
pub static LINEAR_FROM_SRGB: LazyLock<[f32; 256]> = LazyLock::new(|| {
    std::array::from_fn(|byte| {
        let s = byte as f64 / 255.0;
        let linear = match s <= 0.04045 {
            true => s / 12.92,
            false => ((s + 0.055) / 1.055).powf(2.4),
        };
        linear as f32
    })
});

/// A light of 0 to 1 as an sRGB byte; what is outside is taken for the nearer end.
pub fn srgb_byte(linear: f32) -> u8 {
    let linear = linear.clamp(0.0, 1.0);
    let s = match linear <= 0.003_130_8 {
        true => linear * 12.92,
        false => 1.055 * linear.powf(1.0 / 2.4) - 0.055,
    };
    (s * 255.0 + 0.5) as u8
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bytes_survive_the_way_to_light_and_back() {
        for byte in 0..=255u8 {
            assert_eq!(srgb_byte(LINEAR_FROM_SRGB[usize::from(byte)]), byte);
        }
        assert_eq!([srgb_byte(-1.0), srgb_byte(2.0)], [0, 255]);
    }
}
