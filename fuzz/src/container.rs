//! A glTF as its JSON and its BIN chunk.

use serde_json::Value;

const MAGIC: &[u8; 4] = b"glTF";
const JSON: &[u8; 4] = b"JSON";
const BIN: &[u8; 4] = b"BIN\0";

/// A `.glb`, or the text of a `.gltf`.
pub struct Container {
    /// All of its JSON.
    pub json: Value,
    /// The BIN chunk; empty where there is none.
    pub bin: Vec<u8>,
    is_text: bool,
}

impl Container {
    /// Reads as much as is there: what is cut off is taken for empty.
    pub fn parse(bytes: &[u8]) -> Option<Self> {
        if !bytes.starts_with(MAGIC) {
            let json = serde_json::from_slice(bytes).ok()?;
            return Some(Self {
                json,
                bin: Vec::new(),
                is_text: true,
            });
        }
        let (text, rest) = chunk(bytes.get(12..)?)?;
        let bin = chunk(rest).map(|(bin, _)| bin.to_vec());
        Some(Self {
            json: serde_json::from_slice(text).ok()?,
            bin: bin.unwrap_or_default(),
            is_text: false,
        })
    }

    /// As it was, text or chunks.
    pub fn to_bytes(&self) -> Vec<u8> {
        match self.is_text {
            true => self.json.to_string().into_bytes(),
            false => glb(&self.json, &self.bin),
        }
    }
}

/// The first chunk of some bytes, and what comes after it.
fn chunk(bytes: &[u8]) -> Option<(&[u8], &[u8])> {
    let length = bytes.first_chunk::<4>()?;
    let body = bytes.get(8..)?;
    let length = u32::from_le_bytes(*length) as usize;
    Some(body.split_at(length.min(body.len())))
}

/// The bytes of a `.glb`.
pub fn glb(json: &Value, bin: &[u8]) -> Vec<u8> {
    let mut text = json.to_string().into_bytes();
    text.resize(text.len().next_multiple_of(4), b' ');
    let mut chunks = Vec::new();
    let mut push = |kind: &[u8; 4], body: &[u8]| {
        chunks.extend((body.len().next_multiple_of(4) as u32).to_le_bytes());
        chunks.extend(kind);
        chunks.extend(body);
        chunks.resize(chunks.len().next_multiple_of(4), 0);
    };
    push(JSON, &text);
    if !bin.is_empty() {
        push(BIN, bin);
    }
    let length = 12 + chunks.len() as u32;
    [
        &MAGIC[..],
        &2u32.to_le_bytes(),
        &length.to_le_bytes(),
        &chunks,
    ]
    .concat()
}
