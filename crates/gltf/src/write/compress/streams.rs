//! Streams of meshopt's codecs that give back the very bytes, but for which corner of a
//! triangle is its first.

use std::borrow::Cow;

use meshoptimizer_rs::Workspace;
use meshoptimizer_rs::codec::{
    IndexEncoding, VertexEncoding, encode_index_buffer, encode_index_sequence, encode_vertex_buffer,
};
use serde_json::{Value, json};

use super::octahedral::codes;

/// What the bytes of a buffer view are, which decides the codec.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Bytes {
    /// Elements of as many bytes each, a multiple of four.
    Elements { stride: usize, numbers: Numbers },
    /// Indices of two or four bytes each; whether each three of them are a triangle.
    Indices { stride: usize, is_triangles: bool },
}

/// What the components of elements are, as far as a filter is for them.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Numbers {
    Floats,
    /// Unit vectors times 127, four bytes each.
    Directions,
    Others,
}

/// A stream, and what its extension says beside where it is.
pub(super) struct Stream {
    pub(super) bytes: Vec<u8>,
    pub(super) fields: Value,
}

/// About what the JSON of a compressed view has more.
const JSON_BYTES: usize = 256;

/// Compresses the bytes of a view. `None` where that does not make the file smaller. `version` is
/// that of the attribute codec: 0 or 1.
pub(super) fn encode(bytes: &[u8], kind: Bytes, version: u8) -> Option<Stream> {
    let mut workspace = Workspace::default();
    let (stream, stride, mode, filter) = match kind {
        Bytes::Elements { stride, numbers } => {
            let (filtered, name) = match numbers {
                Numbers::Floats => (exponential(bytes, stride), "EXPONENTIAL"),
                Numbers::Directions => (codes(bytes), "OCTAHEDRAL"),
                Numbers::Others => (None, "NONE"),
            };
            let filter = filtered.is_some().then_some(name);
            let source = filtered.map_or(Cow::Borrowed(bytes), Cow::Owned);
            let encoding = VertexEncoding::new(version, 2).ok()?;
            let count = source.len() / stride;
            let stream =
                encode_vertex_buffer(&source, count, stride, encoding, &mut workspace).ok()?;
            (stream, stride, "ATTRIBUTES", filter)
        }
        Bytes::Indices {
            stride,
            is_triangles,
        } => {
            let numbers = wide(bytes, stride);
            let encoding = IndexEncoding::DEFAULT;
            let (stream, mode) = match is_triangles {
                true => {
                    let stream = encode_index_buffer(&numbers, encoding, &mut workspace);
                    (stream.ok()?, "TRIANGLES")
                }
                false => {
                    let stream = encode_index_sequence(&numbers, encoding, &mut workspace);
                    (stream.ok()?, "INDICES")
                }
            };
            (stream, stride, mode, None)
        }
    };
    let mut fields = json!({
        "buffer": 0,
        "byteOffset": 0,
        "byteLength": stream.len(),
        "byteStride": stride,
        "count": bytes.len() / stride,
        "mode": mode,
    });
    if let Some(filter) = filter {
        fields["filter"] = filter.into();
    }
    (stream.len() + JSON_BYTES < bytes.len()).then_some(Stream {
        bytes: stream,
        fields,
    })
}

fn wide(bytes: &[u8], stride: usize) -> Vec<u32> {
    let number = |b: &[u8]| match *b {
        [a, b] => u32::from(u16::from_le_bytes([a, b])),
        [a, b, c, d] => u32::from_le_bytes([a, b, c, d]),
        _ => unreachable!("indices of two or four bytes"),
    };
    bytes.chunks_exact(stride).map(number).collect()
}

/// What the exponential filter makes these floats of: a whole number of 24 bits and the
/// exponent of two, one for each component of an element. `None` where a component's
/// floats do not lie on one grid that is as coarse.
fn exponential(bytes: &[u8], stride: usize) -> Option<Vec<u8>> {
    let components = stride / 4;
    let floats = || {
        let all = bytes.chunks_exact(4);
        all.map(|b| f32::from_le_bytes([b[0], b[1], b[2], b[3]]))
    };
    let mut exponents = vec![i32::MAX; components];
    for (place, float) in floats().enumerate() {
        if !float.is_finite() || float.is_sign_negative() && float == 0.0 {
            return None;
        }
        let exponent = &mut exponents[place % components];
        *exponent = lowest_bit(float).map_or(*exponent, |low| low.min(*exponent));
    }
    for exponent in &mut exponents {
        *exponent = if *exponent == i32::MAX { 0 } else { *exponent };
    }
    let mut filtered = Vec::with_capacity(bytes.len());
    for (place, float) in floats().enumerate() {
        let exponent = exponents[place % components];
        let whole = f64::from(float) * libm::exp2(-f64::from(exponent));
        let fits = whole.abs() < f64::from(1 << 23) && (-100..=100).contains(&exponent);
        if !fits {
            return None;
        }
        let mantissa = (whole as i32) & 0x00ff_ffff;
        filtered.extend((mantissa | exponent << 24).to_le_bytes());
    }
    Some(filtered)
}

/// The exponent of two of the lowest bit of a finite float that is set; none of zero.
fn lowest_bit(float: f32) -> Option<i32> {
    let bits = float.to_bits();
    let fraction = bits & 0x007f_ffff;
    let exponent = ((bits >> 23) & 0xff) as i32;
    let (mantissa, exponent) = match exponent {
        0 => (fraction, -149),
        _ => (fraction | 0x0080_0000, exponent - 150),
    };
    (mantissa != 0).then(|| exponent + mantissa.trailing_zeros() as i32)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn floats_on_a_grid_are_whole_numbers_and_an_exponent() {
        let bytes = |floats: &[f32]| -> Vec<u8> {
            let all = floats.iter().flat_map(|x| x.to_le_bytes());
            all.collect()
        };
        let filtered = exponential(&bytes(&[0.75, 8.0, -0.5, 0.0]), 8).unwrap();
        let (quarter, eight) = ((-2i32) << 24, 3i32 << 24);
        let expected = [quarter | 3, eight | 1, quarter | 0x00ff_fffe, eight];
        let expected: Vec<u8> = expected.iter().flat_map(|x| x.to_le_bytes()).collect();
        assert_eq!(filtered, expected);
        assert_eq!(exponential(&bytes(&[1.0e-6, 1000.0]), 4), None);
        assert_eq!(exponential(&bytes(&[f32::NAN]), 4), None);
    }
}
