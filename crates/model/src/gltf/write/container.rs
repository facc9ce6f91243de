//! The two chunks of a GLB file (glTF 2.0, section 4.4).

use serde_json::Value;

/// Chunks start and end at multiples of four bytes.
const ALIGNMENT: usize = 4;
const HEADER_BYTES: usize = 12;
const CHUNK_HEADER_BYTES: usize = 8;

/// The bytes of a GLB with this JSON and, unless it is empty, this buffer, or
/// `None` if its length does not fit the format's 32 bits.
pub(crate) fn glb_bytes(root: &Value, buffer: &[u8]) -> Option<Vec<u8>> {
    let json = serde_json::to_vec(root).expect("a JSON value can be written");
    let json_bytes = json.len().next_multiple_of(ALIGNMENT);
    let buffer_bytes = buffer.len().next_multiple_of(ALIGNMENT);
    let mut total = HEADER_BYTES + CHUNK_HEADER_BYTES + json_bytes;
    if !buffer.is_empty() {
        total += CHUNK_HEADER_BYTES + buffer_bytes;
    }
    let total_u32 = u32::try_from(total).ok()?;

    let mut glb = Vec::with_capacity(total);
    glb.extend_from_slice(b"glTF");
    glb.extend_from_slice(&2u32.to_le_bytes());
    glb.extend_from_slice(&total_u32.to_le_bytes());
    push_chunk(&mut glb, *b"JSON", &json, b' ');
    if !buffer.is_empty() {
        push_chunk(&mut glb, *b"BIN\0", buffer, 0);
    }
    Some(glb)
}

fn push_chunk(glb: &mut Vec<u8>, kind: [u8; 4], bytes: &[u8], padding: u8) {
    let padded = bytes.len().next_multiple_of(ALIGNMENT);
    glb.extend_from_slice(&(padded as u32).to_le_bytes());
    glb.extend_from_slice(&kind);
    glb.extend_from_slice(bytes);
    glb.resize(glb.len() + padded - bytes.len(), padding);
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn chunks_are_padded_and_counted() {
        // {"a":1} is 7 bytes, so one space; the buffer of 5 gets three zeros.
        let glb = glb_bytes(&json!({"a": 1}), &[1, 2, 3, 4, 5]).unwrap();
        assert_eq!(glb.len(), 12 + 8 + 8 + 8 + 8);
        assert_eq!(glb[8..12], 44u32.to_le_bytes());
        assert_eq!(&glb[12..28], b"\x08\0\0\0JSON{\"a\":1} ");
        assert_eq!(&glb[28..], b"\x08\0\0\0BIN\0\x01\x02\x03\x04\x05\0\0\0");
    }

    #[test]
    fn no_buffer_no_chunk() {
        let glb = glb_bytes(&json!({}), &[]).unwrap();
        assert_eq!(&glb[12..], b"\x04\0\0\0JSON{}  ");
    }
}
