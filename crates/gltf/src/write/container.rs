//! The two chunks of a GLB file (glTF 2.0, section 4.4).

use serde_json::Value;

/// Chunks start and end at multiples of four bytes.
const ALIGNMENT: usize = 4;
const HEADER_BYTES: usize = 12;
const CHUNK_HEADER_BYTES: usize = 8;

/// The bytes of a GLB with this JSON and, unless it is empty, this buffer, or
/// `None` if its length does not fit the format's 32 bits.
pub(crate) fn glb_bytes(root: &Value, buffer: &[u8]) -> Option<Vec<u8>> {
    glb_around(root, buffer.to_vec())
}

/// The same in the buffer's own memory, for one that is large.
pub(crate) fn glb_around(root: &Value, mut buffer: Vec<u8>) -> Option<Vec<u8>> {
    let mut json = serde_json::to_vec(root).expect("a JSON value can be written");
    json.resize(json.len().next_multiple_of(ALIGNMENT), b' ');
    let has_buffer = !buffer.is_empty();
    buffer.resize(buffer.len().next_multiple_of(ALIGNMENT), 0);
    let chunk_headers = if has_buffer { 2 } else { 1 } * CHUNK_HEADER_BYTES;
    let total = HEADER_BYTES + chunk_headers + json.len() + buffer.len();
    let total = u32::try_from(total).ok()?;

    let mut head = Vec::with_capacity(HEADER_BYTES + chunk_headers + json.len());
    head.extend_from_slice(b"glTF");
    head.extend_from_slice(&2u32.to_le_bytes());
    head.extend_from_slice(&total.to_le_bytes());
    push_chunk_header(&mut head, *b"JSON", json.len());
    head.extend_from_slice(&json);
    if has_buffer {
        push_chunk_header(&mut head, *b"BIN\0", buffer.len());
    }
    buffer.splice(0..0, head);
    Some(buffer)
}

fn push_chunk_header(glb: &mut Vec<u8>, kind: [u8; 4], bytes: usize) {
    glb.extend_from_slice(&(bytes as u32).to_le_bytes());
    glb.extend_from_slice(&kind);
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
