//! GLB or JSON: taking a file apart.

use std::borrow::Cow;

use gltf::binary::Glb;
use serde_json::Value;

use super::error::Problem;
use super::property;

/// The pieces of a file.
pub(crate) struct Unpacked<'a> {
    pub(crate) root: Value,
    /// The GLB's binary chunk.
    pub(crate) chunk: Option<Cow<'a, [u8]>>,
}

const GLB_HEADER_BYTES: usize = 12;

/// Tells GLB from JSON and parses the JSON.
pub(crate) fn unpack(bytes: &[u8]) -> Result<Unpacked<'_>, Problem> {
    let (json, chunk) = if bytes.starts_with(b"glTF") {
        let glb = split_glb(bytes)?;
        (glb.json, glb.bin)
    } else {
        (Cow::Borrowed(bytes), None)
    };
    let root = parse_json(&json)?;
    check_version(&root)?;
    Ok(Unpacked { root, chunk })
}

fn split_glb(bytes: &[u8]) -> Result<Glb<'_>, Problem> {
    let word = |at: usize| -> Option<u32> {
        Some(u32::from_le_bytes(bytes.get(at..at + 4)?.try_into().ok()?))
    };
    let (Some(version), Some(length)) = (word(4), word(8)) else {
        return Err(Problem::Truncated {
            expected: GLB_HEADER_BYTES as u64,
            found: bytes.len() as u64,
        });
    };
    if version != 2 {
        return Err(Problem::Version(version.to_string()));
    }
    // The parser subtracts the header from the length unchecked.
    if (length as usize) < GLB_HEADER_BYTES {
        return Err(Problem::DamagedGlb(format!(
            "its header gives a length of {length} bytes"
        )));
    }
    let whole = bytes.get(..length as usize).ok_or(Problem::Truncated {
        expected: u64::from(length),
        found: bytes.len() as u64,
    })?;
    Glb::from_slice(whole).map_err(|error| Problem::DamagedGlb(error.to_string()))
}

fn parse_json(bytes: &[u8]) -> Result<Value, Problem> {
    let bytes = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes);
    if bytes.is_empty() {
        return Err(Problem::NotGltf("it is empty".to_owned()));
    }
    let root: Value = serde_json::from_slice(bytes)
        .map_err(|error| Problem::NotGltf(format!("its JSON cannot be parsed ({error})")))?;
    if root.get("asset").is_none_or(|asset| !asset.is_object()) {
        return Err(Problem::NotGltf("its JSON has no `asset`".to_owned()));
    }
    Ok(root)
}

fn check_version(root: &Value) -> Result<(), Problem> {
    let asset = &root["asset"];
    let major_minor = |text: &str| -> Option<(u32, u32)> {
        let (major, minor) = text.split_once('.')?;
        Some((major.parse().ok()?, minor.parse().ok()?))
    };
    let version = property::text(asset, "version")?.ok_or(Problem::Missing("asset.version"))?;
    if major_minor(version).is_none_or(|(major, _)| major != 2) {
        return Err(Problem::Version(super::error::shortened(version)));
    }
    if let Some(least) = property::text(asset, "minVersion")?
        && major_minor(least).is_none_or(|least| least > (2, 0))
    {
        return Err(Problem::Version(super::error::shortened(least)));
    }
    Ok(())
}
