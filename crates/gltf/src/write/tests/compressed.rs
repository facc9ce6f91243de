//! The plainest stream that EXT_meshopt_compression allows: its appendix A,
//! mode ATTRIBUTES, every group of sixteen deltas stored as bytes.

use serde_json::json;

use super::fixture::Fixture;

/// Compresses a buffer view of at most 256 elements. Its own bytes are then in a
/// buffer that has none.
pub(super) fn compress_view(fixture: &mut Fixture, view: usize, stride: usize) {
    let fields = &fixture.root["bufferViews"][view];
    let start = fields["byteOffset"].as_u64().unwrap() as usize;
    let length = fields["byteLength"].as_u64().unwrap() as usize;
    let stream = encode(&fixture.bin[start..start + length], stride);
    fixture.bin[start..start + length].fill(0xee);

    fixture.bin.resize(fixture.bin.len().next_multiple_of(4), 0);
    let offset = fixture.bin.len();
    fixture.bin.extend_from_slice(&stream);
    let fallback = json!({"EXT_meshopt_compression": {"fallback": true}});
    fixture.root["buffers"] = json!([{}, {"byteLength": 1 << 16, "extensions": fallback}]);
    let fields = &mut fixture.root["bufferViews"][view];
    fields["buffer"] = 1.into();
    fields["byteStride"] = stride.into();
    fields["extensions"] = json!({"EXT_meshopt_compression": {
        "buffer": 0,
        "byteOffset": offset,
        "byteLength": stream.len(),
        "byteStride": stride,
        "count": length / stride,
        "mode": "ATTRIBUTES",
    }});
}

fn encode(bytes: &[u8], stride: usize) -> Vec<u8> {
    const GROUP: usize = 16;
    const ALL_BYTES: u8 = 0xff;
    const TAIL: usize = 32;
    let elements: Vec<&[u8]> = bytes.chunks_exact(stride).collect();
    let groups = elements.len().div_ceil(GROUP);
    let mut stream = vec![0xa0];
    for k in 0..stride {
        stream.resize(stream.len() + groups.div_ceil(4), ALL_BYTES);
        let mut last = elements[0][k];
        for place in 0..groups * GROUP {
            let value = elements.get(place).map_or(last, |element| element[k]);
            let delta = value.wrapping_sub(last) as i8;
            stream.push(((delta << 1) ^ (delta >> 7)) as u8);
            last = value;
        }
    }
    stream.resize(stream.len() + TAIL - stride, 0);
    stream.extend_from_slice(elements[0]);
    stream
}
