//! Values at the ends of their ranges.

use secateur_plant::Random;
use serde_json::{Value, json};

use crate::{below, pick};

/// Numbers where widths, signs and precisions end.
const WHOLE: [i64; 22] = [
    0,
    1,
    2,
    3,
    4,
    -1,
    7,
    64,
    127,
    128,
    255,
    256,
    32_767,
    65_535,
    65_536,
    0x7FFF_FFFF,
    0x8000_0000,
    0xFFFF_FFFF,
    0x1_0000_0000,
    1 << 53,
    i64::MAX,
    i64::MIN,
];
const REAL: [f64; 10] = [
    -0.0, 0.5, -1.5, 1e-320, 1e-45, 3.4e38, 3.5e38, 1e308, -1e308, 0.1,
];

/// Words that mean something to a reader of glTF.
const WORDS: [&str; 24] = [
    "",
    ".",
    "../x",
    "/x",
    "a%2f..%2fb",
    "data:,",
    "data:application/octet-stream;base64,AAAA",
    "SCALAR",
    "VEC2",
    "VEC3",
    "VEC4",
    "MAT4",
    "POSITION",
    "TEXCOORD_0",
    "MASK",
    "BLEND",
    "ATTRIBUTES",
    "TRIANGLES",
    "INDICES",
    "OCTAHEDRAL",
    "EXPONENTIAL",
    "KHR_mesh_quantization",
    "EXT_meshopt_compression",
    "EXT_mesh_gpu_instancing",
];

/// Patterns of four bytes: floats that are no numbers, huge or tiny, and the ends
/// of whole numbers.
const PATTERNS: [u32; 12] = [
    0,
    1,
    0xFFFF_FFFF,
    0x7FFF_FFFF,
    0x8000_0000,
    0x7F80_0000,
    0xFF80_0000,
    0x7FC0_0000,
    0x7F7F_FFFF,
    0x0000_0100,
    0x3F80_0000,
    0x0001_0001,
];

/// Numbers of component types, targets and modes that glTF knows.
const CODES: [i64; 8] = [5120, 5121, 5122, 5123, 5125, 5126, 34_962, 34_963];

pub fn value(random: &mut Random) -> Value {
    match below(random, 10) {
        0..=3 => json!(pick(random, &WHOLE)),
        4 => json!(pick(random, &REAL)),
        5 => json!(pick(random, &CODES)),
        6 => json!(pick(random, &WORDS)),
        7 => json!(below(random, 8)),
        8 => json!("x".repeat(below(random, 300))),
        _ => pick(
            random,
            &[Value::Null, json!([]), json!({}), json!(true), json!([0])],
        )
        .clone(),
    }
}

/// Changes a few bytes, or how many there are.
pub fn put_into(bin: &mut Vec<u8>, random: &mut Random) {
    if bin.is_empty() {
        bin.resize(4, 0);
    }
    let at = below(random, bin.len());
    match below(random, 8) {
        0 => bin.truncate(at),
        1 => bin.resize(bin.len() + below(random, 64), 0),
        2 => bin[at] ^= 1 << below(random, 8),
        3 => bin[at] = random.bits() as u8,
        4 => {
            let piece = bin[at..(at + 16).min(bin.len())].to_vec();
            let to = below(random, bin.len() + 1 - piece.len());
            bin[to..to + piece.len()].copy_from_slice(&piece);
        }
        _ => {
            let word = pick(random, &PATTERNS).to_le_bytes();
            let at = at & !3;
            let end = (at + 4).min(bin.len());
            bin[at..end].copy_from_slice(&word[..end - at]);
        }
    }
}
