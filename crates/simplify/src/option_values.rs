//! Values of options that more than one method has, each with one spelling.

use std::borrow::Cow;
use std::fmt;
use std::str::FromStr;

use secateur_model::{Facing, Foliage, Leaf};
use secateur_raster::{MAX_RESOLUTION, View, ViewSet};
use serde::{Deserialize, Serialize};

use crate::fit::{DEFAULT_OUTLINE_WEIGHT, MAX_OUTLINE_WEIGHT};

/// Width and height of the images that areas are counted in. Spelled `auto` or as a number.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(try_from = "String", into = "String")]
pub enum Resolution {
    /// 256; and for [`Preset::Information`](crate::Preset::Information) and methods other than VDS more where the leaves need it.
    #[default]
    Auto,
    /// This many pixels, 1 to [`MAX_RESOLUTION`].
    Pixels(u32),
}

/// How much the built-in sets of views see. Spelled `tight` or as a number of degrees.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "String", into = "String")]
pub enum FieldOfView {
    /// The crown's bounding sphere just fits: 38.9 degrees.
    Tight,
    /// This many, above 0 and below 180. The paper's judge has 60, which leaves most of each image
    /// empty.
    Degrees(f64),
    /// [`Self::Tight`] as the presets of this program have it, 60 degrees for the paper's.
    #[default]
    Auto,
}

/// How many triangles of its own a leaf keeps at most. Spelled `auto`, `keep` or as a number.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(try_from = "String", into = "String")]
pub enum LeafTriangles {
    /// Where triangles are the target, as many as show the most over all leaves while as few
    /// as possible of them go; but no fewer than show the same, or two, where it has a
    /// cut-out. For other targets, all.
    #[default]
    Auto,
    /// Every leaf keeps all of its triangles.
    Keep,
    /// This many, at least 1.
    AtMost(u32),
}

/// How needles grow: flat leaves without a cut-out that are more than four times as long as wide.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "cli", derive(clap::ValueEnum, schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum Needles {
    /// Across: before sizes are fitted one is no longer than the original was, or than .85 of that if it became coarser,
    /// and as much wider.
    Widen,
    /// As every leaf does.
    #[default]
    Scale,
}

/// Whether the sizes of what is left are fitted to the original at the end, whatever
/// the method made of them: see [`mod@crate::fit`]. Spelled `auto`, `none`, `coverage` or as the
/// weight.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "String", into = "String")]
#[non_exhaustive]
pub enum Fitting {
    /// As the [`Preset`](crate::Preset) has it, for [`Method::Vds`](crate::Method::Vds) and [`Method::VdsReference`](crate::Method::VdsReference) where leaves
    /// grow as the preset has it; never for other methods.
    ///
    /// [`Preset::Look`](crate::Preset::Look): as [`Self::Coverage`], but none where all leaves are left and one triangle
    /// of a card shows all of it. [`Preset::Information`](crate::Preset::Information): to leaves or triangles at
    /// [`Resolution::Auto`] as [`Self::Weight`] of
    /// [`INFORMATION_OUTLINE_WEIGHT`](crate::fit::INFORMATION_OUTLINE_WEIGHT), else none; nor where all leaves are left, one
    /// triangle of a card shows all of it, and the driving views say so to a 400th of their
    /// information. None for the paper's presets.
    #[default]
    Auto,
    /// Sizes stay as the method left them.
    None,
    /// To the coverage of small blocks of 12 views from which no leaf was chosen, or, with
    /// [`Views::Cameras`](crate::Views::Cameras), of these.
    Coverage,
    /// To the outline and the information in 30 views from which no leaf was chosen, or, with
    /// [`Views::Cameras`](crate::Views::Cameras), in these; with this weight of a pixel of outline against a bit of
    /// VMI times a pixel, 0 to [`MAX_OUTLINE_WEIGHT`].
    Weight(f64),
}

/// Whether holes of leaf textures count.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "cli", derive(clap::ValueEnum, schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum Alpha {
    /// What an alpha mask cuts out is not there.
    #[default]
    Mask,
    /// Leaves are solid polygons.
    Ignore,
}

/// From which sides leaves are seen.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "cli", derive(clap::ValueEnum, schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum Sides {
    /// As the material says: clients cull back faces where it is not doubleSided.
    #[default]
    Material,
    /// Every leaf is seen from both sides.
    Both,
}

/// The foliage as it is to be looked at: with or without holes, culled or not.
pub fn as_seen(foliage: &Foliage, alpha: Alpha, sides: Sides) -> Cow<'_, Foliage> {
    let is_single_sided = |leaf: &Leaf| leaf.facing() != Facing::Both;
    let mut seen = Cow::Borrowed(foliage);
    if alpha == Alpha::Ignore {
        seen = Cow::Owned(seen.without_cutouts());
    }
    if sides == Sides::Both && foliage.leaves().iter().any(is_single_sided) {
        seen = Cow::Owned(seen.seen_from_both_sides());
    }
    seen
}

impl fmt::Display for Resolution {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Auto => f.write_str("auto"),
            Self::Pixels(pixels) => pixels.fmt(f),
        }
    }
}

impl fmt::Display for FieldOfView {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Auto => f.write_str("auto"),
            Self::Tight => f.write_str("tight"),
            Self::Degrees(degrees) => degrees.fmt(f),
        }
    }
}

impl FromStr for FieldOfView {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        match (text, text.parse()) {
            ("auto", _) => Ok(Self::Auto),
            ("tight", _) => Ok(Self::Tight),
            (_, Ok(degrees)) if 0.0 < degrees && degrees < 180.0 => Ok(Self::Degrees(degrees)),
            _ => Err("write tight or degrees above 0 and below 180".to_owned()),
        }
    }
}

impl FieldOfView {
    /// The tangent of its half.
    pub(crate) fn tan_half(self) -> f64 {
        match self {
            Self::Auto | Self::Tight => ViewSet::TAN_TIGHT,
            // To the last bit, as everywhere.
            Self::Degrees(60.0) => View::TAN_30_DEGREES,
            Self::Degrees(degrees) => (degrees / 2.0).to_radians().tan(),
        }
    }
}

impl fmt::Display for LeafTriangles {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Auto => f.write_str("auto"),
            Self::Keep => f.write_str("keep"),
            Self::AtMost(most) => most.fmt(f),
        }
    }
}

impl fmt::Display for Fitting {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Auto => f.write_str("auto"),
            Self::None => f.write_str("none"),
            Self::Coverage => f.write_str("coverage"),
            Self::Weight(weight) => weight.fmt(f),
        }
    }
}

impl FromStr for Resolution {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        match text.parse::<u32>() {
            _ if text == "auto" => Ok(Self::Auto),
            Ok(n) if (1..=MAX_RESOLUTION).contains(&n) => Ok(Self::Pixels(n)),
            _ => Err(format!("write auto or a number from 1 to {MAX_RESOLUTION}")),
        }
    }
}

impl FromStr for LeafTriangles {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        match (text, text.parse::<u32>()) {
            ("auto", _) => Ok(Self::Auto),
            ("keep", _) => Ok(Self::Keep),
            (_, Ok(n)) if n >= 1 => Ok(Self::AtMost(n)),
            _ => Err("write auto, keep or a number from 1 upwards".to_owned()),
        }
    }
}

impl FromStr for Fitting {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        match (text, text.parse()) {
            ("auto", _) => Ok(Self::Auto),
            ("none", _) => Ok(Self::None),
            ("coverage", _) => Ok(Self::Coverage),
            (_, Ok(weight)) if (0.0..=MAX_OUTLINE_WEIGHT).contains(&weight) => {
                Ok(Self::Weight(weight))
            }
            _ => Err(format!(
                "write auto, none, coverage or a weight of the outline from 0 to \
                 {MAX_OUTLINE_WEIGHT}, such as {DEFAULT_OUTLINE_WEIGHT}"
            )),
        }
    }
}

/// For serde: a value of one spelling, from and to text.
macro_rules! spelled {
    ($($type:ty),+) => { $(
        impl TryFrom<String> for $type {
            type Error = String;

            fn try_from(text: String) -> Result<Self, String> {
                text.parse()
            }
        }

        impl From<$type> for String {
            fn from(value: $type) -> Self {
                value.to_string()
            }
        }
    )+ };
}

spelled!(Resolution, FieldOfView, LeafTriangles, Fitting);
