//! Filters: what decoded attributes are turned into.

/// The filter of a compressed view.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Filter {
    None,
    /// Unit vectors folded into a square.
    Octahedral,
    /// Unit quaternions without their largest component.
    Quaternion,
    /// Floats as whole numbers times powers of two.
    Exponential,
    /// Colours as luma and chroma (KHR only).
    Color,
}

impl Filter {
    pub(super) fn from_name(name: &str) -> Option<Self> {
        Some(match name {
            "NONE" => Self::None,
            "OCTAHEDRAL" => Self::Octahedral,
            "QUATERNION" => Self::Quaternion,
            "EXPONENTIAL" => Self::Exponential,
            "COLOR" => Self::Color,
            _ => return None,
        })
    }

    /// Whether elements of this many bytes can be filtered.
    pub(super) fn fits(self, stride: usize) -> bool {
        match self {
            Self::None => true,
            Self::Octahedral | Self::Color => matches!(stride, 4 | 8),
            Self::Quaternion => stride == 8,
            Self::Exponential => stride.is_multiple_of(4),
        }
    }

    /// Turns elements of `stride` bytes into what they stand for, in place.
    pub(super) fn apply(self, bytes: &mut [u8], stride: usize) {
        match (self, stride) {
            (Self::None, _) => {}
            (Self::Octahedral, 4) => each_of_bytes(bytes, |v| {
                let signed = v.map(|b| i32::from(b as i8));
                octahedral(signed, 127.0).map(|x| x as i8 as u8)
            }),
            (Self::Octahedral, _) => each_of_words(bytes, |v| {
                let signed = v.map(|w| i32::from(w as i16));
                octahedral(signed, 32767.0).map(|x| x as i16 as u16)
            }),
            (Self::Quaternion, _) => each_of_words(bytes, |v| {
                quaternion(v.map(|w| i32::from(w as i16))).map(|x| x as i16 as u16)
            }),
            (Self::Exponential, _) => {
                for word in bytes.as_chunks_mut::<4>().0 {
                    *word = exponential(i32::from_le_bytes(*word)).to_le_bytes();
                }
            }
            (Self::Color, 4) => each_of_bytes(bytes, |v| {
                let [y, co, cg, a] = v;
                let chroma = [co, cg].map(|b| i32::from(b as i8));
                color(i32::from(y), chroma, u32::from(a), 255.0).map(|x| x as u8)
            }),
            (Self::Color, _) => each_of_words(bytes, |v| {
                let [y, co, cg, a] = v;
                let chroma = [co, cg].map(|w| i32::from(w as i16));
                color(i32::from(y), chroma, u32::from(a), 65535.0).map(|x| x as u16)
            }),
        }
    }
}

fn each_of_bytes(bytes: &mut [u8], turn: impl Fn([u8; 4]) -> [u8; 4]) {
    for element in bytes.as_chunks_mut::<4>().0 {
        *element = turn(*element);
    }
}

fn each_of_words(bytes: &mut [u8], turn: impl Fn([u16; 4]) -> [u16; 4]) {
    for element in bytes.as_chunks_mut::<8>().0 {
        let word = |k: usize| u16::from_le_bytes([element[2 * k], element[2 * k + 1]]);
        let turned = turn([word(0), word(1), word(2), word(3)]);
        for (k, word) in turned.into_iter().enumerate() {
            element[2 * k..2 * k + 2].copy_from_slice(&word.to_le_bytes());
        }
    }
}

/// What the octahedral filter makes of a code of bytes that has full precision: a unit vector
/// times 127.
pub(crate) fn octahedral_of_bytes([a, b]: [i8; 2]) -> [i8; 3] {
    let [x, y, z, _] = octahedral([a.into(), b.into(), 127, 0], 127.0);
    [x, y, z].map(|component| component as i8)
}

/// `input[2]` is 1 in the precision of the first two; the fourth is kept.
fn octahedral(input: [i32; 4], largest: f32) -> [i32; 4] {
    let one = input[2] as f32;
    let (mut x, mut y) = (input[0] as f32 / one, input[1] as f32 / one);
    let z = 1.0 - x.abs() - y.abs();
    let fold = z.min(0.0);
    x -= fold.copysign(x);
    y -= fold.copysign(y);
    let length = (x * x + y * y + z * z).sqrt();
    let stored = |v: f32| (v / length * largest).round() as i32;
    [stored(x), stored(y), stored(z), input[3]]
}

/// `input[3]` is 1 in the precision of the others, but for its lowest two bits,
/// which name the component left out.
fn quaternion(input: [i32; 4]) -> [i32; 4] {
    let one = (input[3] | 3) as f32;
    let part = |k: usize| input[k] as f32 / one * std::f32::consts::FRAC_1_SQRT_2;
    let (x, y, z) = (part(0), part(1), part(2));
    let w = (1.0 - x * x - y * y - z * z).max(0.0).sqrt();
    let largest = (input[3] & 3) as usize;
    let mut out = [0; 4];
    for (k, component) in [w, x, y, z].into_iter().enumerate() {
        out[(largest + k) % 4] = (component * 32767.0).round() as i32;
    }
    out
}

/// Eight bits of exponent, 24 of mantissa, both signed.
fn exponential(input: i32) -> f32 {
    let exponent = input >> 24;
    let mantissa = input << 8 >> 8;
    (f64::from(mantissa) * f64::from(exponent).exp2()) as f32
}

/// The highest bit of `a` gives the precision; `largest` is that of the result.
fn color(y: i32, [co, cg]: [i32; 2], a: u32, largest: f32) -> [u32; 4] {
    let one = (2u32 << a.checked_ilog2().unwrap_or(0)) - 1;
    let (r, g, b) = (y + co - cg, y + cg, y - co - cg);
    let alpha = (a & (one >> 1)) as i32;
    let alpha = alpha << 1 | alpha & 1;
    let stored = |v: i32| (v as f32 * (largest / one as f32)).round() as u32;
    [stored(r), stored(g), stored(b), stored(alpha)]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_corners_of_the_octahedron() {
        // +x, and -z, which is any corner of the folded square.
        assert_eq!(octahedral([127, 0, 127, 9], 127.0), [127, 0, 0, 9]);
        assert_eq!(octahedral([0, 0, 127, 9], 127.0), [0, 0, 127, 9]);
        assert_eq!(octahedral([127, 127, 127, 9], 127.0), [0, 0, -127, 9]);
    }

    #[test]
    fn the_component_left_out_comes_first_in_the_turn() {
        // w is left out (3), the others are zero.
        assert_eq!(quaternion([0, 0, 0, 0x7ffc | 3]), [0, 0, 0, 32767]);
        assert_eq!(quaternion([0, 0, 0, 0x7ffc | 1]), [0, 32767, 0, 0]);
        // A quarter turn about x: x left out, w = x = sqrt(1/2); w is third
        // after x.
        let half = quaternion([0, 0, 32767, 0x7ffc]);
        assert_eq!(half, [23170, 0, 0, 23170]);
    }

    #[test]
    fn mantissa_times_power_of_two() {
        assert_eq!(exponential(3), 3.0);
        assert_eq!(exponential(-1 << 24 | 3), 1.5);
        assert_eq!(exponential(2 << 24 | 0xff_ffff), -4.0);
        assert!(exponential(i32::MIN).is_finite());
    }

    #[test]
    fn grey_has_no_chroma() {
        // Precision of eight bits: alpha's highest bit is bit 7, its value
        // 127 of 127.
        assert_eq!(color(200, [0, 0], 255, 255.0), [200, 200, 200, 255]);
        assert_eq!(color(100, [50, 10], 255, 255.0), [140, 110, 40, 255]);
    }
}
