//! Options as files and pages keep them.

use serde::{Deserialize, Serialize};

/// Options with the version of their shape: `{"version": 1, "options": {...}}`. Another version is refused, and so is a
/// key that is not known. Cameras of one's own are no options: see [`Surroundings`](crate::Surroundings).
///
/// ```
/// use secateur::{LevelOptions, Versioned};
///
/// let text = serde_json::to_string(&Versioned::new(LevelOptions::triangles(0.1)))?;
/// let again: Versioned<LevelOptions> = serde_json::from_str(&text)?;
/// assert_eq!(again.options, LevelOptions::triangles(0.1));
/// # let old = text.replace("\"version\":1", "\"version\":0");
/// # assert!(serde_json::from_str::<Versioned<LevelOptions>>(&old).is_err());
/// # Ok::<(), serde_json::Error>(())
/// ```
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Versioned<T> {
    version: Version,
    /// The options.
    pub options: T,
}

impl<T> Versioned<T> {
    /// Options of this version.
    pub fn new(options: T) -> Self {
        Self {
            version: Version,
            options,
        }
    }
}

/// The version that is written, and the only one that is read.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "u32", into = "u32")]
struct Version;

const VERSION: u32 = 1;

impl From<Version> for u32 {
    fn from(Version: Version) -> Self {
        VERSION
    }
}

impl TryFrom<u32> for Version {
    type Error = String;

    fn try_from(version: u32) -> Result<Self, String> {
        match version {
            VERSION => Ok(Self),
            other => Err(format!(
                "options of version {other}: only version {VERSION} can be read"
            )),
        }
    }
}
