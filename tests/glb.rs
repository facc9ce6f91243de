//! The two chunks of a GLB.

use serde_json::Value;

/// The JSON and the buffer of a GLB.
pub(crate) fn chunks(glb: &[u8]) -> (&[u8], &[u8]) {
    let length = u32::from_le_bytes(glb[12..16].try_into().unwrap()) as usize;
    (&glb[20..20 + length], &glb[28 + length..])
}

/// A GLB of a JSON and a buffer.
pub(crate) fn joined(root: &Value, bin: &[u8]) -> Vec<u8> {
    let mut json = root.to_string().into_bytes();
    json.resize(json.len().next_multiple_of(4), b' ');
    let word = |n: usize| (n as u32).to_le_bytes();
    let mut glb = b"glTF".to_vec();
    glb.extend([word(2), word(28 + json.len() + bin.len()), word(json.len())].concat());
    glb.extend(b"JSON");
    glb.extend(json);
    glb.extend(word(bin.len()));
    glb.extend(b"BIN\0");
    glb.extend(bin);
    glb
}
