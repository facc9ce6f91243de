//! Colours as bytes of sRGB and as light (IEC 61966-2-1).

use std::sync::LazyLock;

/// The light of each sRGB byte, 0 to 1.
pub static LINEAR_FROM_SRGB: LazyLock<[f32; 256]> =
    LazyLock::new(|| std::array::from_fn(|byte| light_of(byte as f64)));

/// The light from which on each sRGB byte but the last is rounded up to the next: a table, since powers are not the same
/// bits on every machine.
static NEXT_BYTE_FROM: LazyLock<[f32; 255]> =
    LazyLock::new(|| std::array::from_fn(|byte| light_of(byte as f64 + 0.5)));

/// The light of an sRGB value of 0 to 255.
fn light_of(value: f64) -> f32 {
    let s = value / 255.0;
    let linear = match s <= 0.04045 {
        true => s / 12.92,
        false => ((s + 0.055) / 1.055).powf(2.4),
    };
    linear as f32
}

/// A light of 0 to 1 as an sRGB byte; what is outside is taken for the nearer end.
pub fn srgb_byte(linear: f32) -> u8 {
    NEXT_BYTE_FROM.partition_point(|from| *from <= linear) as u8
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bytes_survive_the_way_to_light_and_back() {
        for byte in 0..=255u8 {
            assert_eq!(srgb_byte(LINEAR_FROM_SRGB[usize::from(byte)]), byte);
        }
        assert_eq!([-1.0, 2.0, f32::NAN].map(srgb_byte), [0, 255, 0]);
    }
}
