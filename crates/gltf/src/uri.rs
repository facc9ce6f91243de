//! URIs: data in place, or files in the glTF's own folder, and nothing else.

use std::borrow::Cow;
use std::path::PathBuf;

use base64::Engine;
use base64::engine::{DecodePaddingMode, GeneralPurpose, GeneralPurposeConfig};
use percent_encoding::percent_decode_str;

use super::error::{Problem, shortened};

/// What a URI leads to.
pub(crate) enum Target<'a> {
    /// The bytes of a data URI.
    Data(Vec<u8>),
    /// A path below the glTF's own folder.
    File {
        /// Without `..`, not absolute.
        relative: PathBuf,
        /// As it is written in the file.
        uri: &'a str,
    },
}

/// Reads a URI as glTF allows them.
///
/// # Errors
/// [`Problem::ForeignUri`] for another scheme, an absolute path or one that
/// climbs with `..`, looked at after percent-decoding and with backslashes as
/// separators; [`Problem::BadUri`] for bad escapes or bad base64.
pub(crate) fn resolve(uri: &str) -> Result<Target<'_>, Problem> {
    if has_prefix_ignoring_case(uri, "data:") {
        return Ok(Target::Data(decode_data(uri, &uri["data:".len()..])?));
    }
    let decoded = percent_decode(uri)?;
    let path = String::from_utf8(decoded).map_err(|_| malformed(uri, "it is not UTF-8"))?;
    if path.is_empty() {
        return Err(malformed(uri, "it is empty"));
    }
    if path.chars().any(char::is_control) {
        return Err(malformed(uri, "it has a control character"));
    }
    let separated = path.replace('\\', "/");
    let climbs = separated.split('/').any(|part| part == "..");
    if climbs || separated.starts_with('/') || separated.contains(':') {
        return Err(Problem::ForeignUri(shortened(uri)));
    }
    Ok(Target::File {
        relative: PathBuf::from(separated),
        uri,
    })
}

/// The path below the glTF's own folder that a URI names, if it names one; data
/// is not decoded to find out.
pub(crate) fn file(uri: &str) -> Option<PathBuf> {
    if has_prefix_ignoring_case(uri, "data:") {
        return None;
    }
    match resolve(uri) {
        Ok(Target::File { relative, .. }) => Some(relative),
        _ => None,
    }
}

fn has_prefix_ignoring_case(text: &str, prefix: &str) -> bool {
    text.get(..prefix.len())
        .is_some_and(|start| start.eq_ignore_ascii_case(prefix))
}

fn malformed(uri: &str, why: &str) -> Problem {
    Problem::BadUri {
        uri: shortened(uri),
        why: why.to_owned(),
    }
}

/// Unlike the lenient rule of browsers, a `%` must be followed by two digits.
fn percent_decode(uri: &str) -> Result<Vec<u8>, Problem> {
    let bytes = uri.as_bytes();
    let escaped = |at: usize| {
        let digits = bytes.get(at + 1..at + 3);
        digits.is_some_and(|two| two.iter().all(u8::is_ascii_hexdigit))
    };
    if (0..bytes.len()).any(|at| bytes[at] == b'%' && !escaped(at)) {
        return Err(malformed(
            uri,
            "a `%` is not followed by two hexadecimal digits",
        ));
    }
    Ok(Cow::from(percent_decode_str(uri)).into_owned())
}

const BASE64: GeneralPurpose = GeneralPurpose::new(
    &base64::alphabet::STANDARD,
    GeneralPurposeConfig::new().with_decode_padding_mode(DecodePaddingMode::Indifferent),
);

fn decode_data(uri: &str, rest: &str) -> Result<Vec<u8>, Problem> {
    let (kind, payload) = rest
        .split_once(',')
        .ok_or_else(|| malformed(uri, "a data URI has a comma before its data"))?;
    if !kind.to_ascii_lowercase().ends_with(";base64") {
        return percent_decode(payload).map_err(|_| malformed(uri, "its escapes are damaged"));
    }
    let decoded = if payload.contains('%') {
        BASE64.decode(percent_decode(payload)?)
    } else {
        BASE64.decode(payload)
    };
    decoded.map_err(|error| malformed(uri, &format!("its base64 is damaged ({error})")))
}
