//! What a result is for: the values that options begin with.

use serde::{Deserialize, Serialize};

use crate::vds::{Reference, Resize, VdsOptions};
use crate::{Alpha, FieldOfView, LeafTriangles, Needles, Resolution, Sides, Views};

/// What a result is for. Each option can be changed afterwards.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "cli", derive(clap::ValueEnum, schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
#[non_exhaustive]
pub enum Preset {
    /// Pictures that look like the original: the crown stays as dense as it was.
    ///
    /// Costs are measured against the foliage before each
    /// step, a neighbour takes over all of a pruned leaf's area while the views show less
    /// foliage than at first, and at the end sizes are fitted so that each part of the crown is
    /// as dense as it was.
    #[default]
    Look,
    /// The least VMI error, at the price of a crown that gets too dense.
    ///
    /// Costs are measured against the original in
    /// views that turn from stage to stage, growth is in proportion to cost, and sizes are fitted to
    /// outline and information in other views.
    Information,
    /// The paper as it is written: 20 views of 256 x 256, solid leaves, costs against the original, growth by
    /// the cost in bits; options that say otherwise are refused.
    ///
    /// Entropy 2018, 20, 213, section 4. Of Eq. 5, whose share is only said to be from 0 to 1, it has
    /// the plainest reading: the cost in bits, at most 1. Nothing is fitted.
    ///
    /// The paper's dodecahedron has "one unit of radius" and surrounds the object; how far that
    /// is in radii of the crown it does not say, so views stand where those of its judge do, at 3
    /// radii with 60 degrees.
    Paper,
    /// The paper's algorithm, but a leaf's growth is its cost over the largest cost of the step.
    ///
    /// [`Self::Paper`] with [`Resize::Normalised`].
    PaperNormalised,
    /// The paper's algorithm, but a neighbour takes over all of the area.
    ///
    /// [`Self::Paper`] with [`Resize::Full`].
    PaperFull,
    /// The paper's algorithm, but a neighbour takes over all of the area only while the views have lost information.
    ///
    /// [`Self::Paper`] with [`Resize::Deficit`].
    PaperDeficit,
    /// The paper's algorithm, but no leaf grows.
    ///
    /// [`Self::Paper`] with [`Resize::None`].
    PaperNone,
}

impl Preset {
    /// The paper in all readings of its Eq. 5, the plainest first.
    pub const PAPER: [Self; 5] = [
        Self::Paper,
        Self::PaperNormalised,
        Self::PaperFull,
        Self::PaperDeficit,
        Self::PaperNone,
    ];

    /// The name by which it is asked for.
    pub fn name(self) -> &'static str {
        match self {
            Self::Look => "look",
            Self::Information => "information",
            Self::Paper => "paper",
            Self::PaperNormalised => "paper-normalised",
            Self::PaperFull => "paper-full",
            Self::PaperDeficit => "paper-deficit",
            Self::PaperNone => "paper-none",
        }
    }

    /// Whether it is the paper's, in some reading.
    pub fn is_paper(self) -> bool {
        Self::PAPER.contains(&self)
    }

    /// How VDS chooses leaves and lets others grow.
    pub fn vds(self) -> VdsOptions {
        let resize = match self {
            Self::Look => {
                return VdsOptions {
                    reference: Reference::Previous,
                    resize: Resize::Full,
                    max_coverage: Some(1.0),
                    ..VdsOptions::default()
                };
            }
            Self::Information | Self::PaperNormalised => Resize::Normalised,
            Self::Paper => Resize::Literal,
            Self::PaperFull => Resize::Full,
            Self::PaperDeficit => Resize::Deficit,
            Self::PaperNone => Resize::None,
        };
        VdsOptions {
            resize,
            ..VdsOptions::default()
        }
    }

    /// The view set that the preset drives from.
    pub fn views(self) -> Views {
        match self {
            Self::Look => Views::Auto,
            Self::Information => Views::Turning,
            Self::Paper
            | Self::PaperNormalised
            | Self::PaperFull
            | Self::PaperDeficit
            | Self::PaperNone => Views::Dodecahedron,
        }
    }

    /// How much views see.
    pub fn field_of_view(self) -> FieldOfView {
        FieldOfView::Degrees(60.0)
    }

    /// How finely views look.
    pub fn resolution(self) -> Resolution {
        match self.is_paper() {
            true => Resolution::Pixels(256),
            false => Resolution::Auto,
        }
    }

    /// Whether holes of leaf textures count.
    pub fn alpha(self) -> Alpha {
        match self.is_paper() {
            true => Alpha::Ignore,
            false => Alpha::Mask,
        }
    }

    /// From which sides leaves are seen.
    pub fn sides(self) -> Sides {
        match self.is_paper() {
            true => Sides::Both,
            false => Sides::Material,
        }
    }

    /// How many triangles of its own a leaf keeps.
    pub fn leaf_triangles(self) -> LeafTriangles {
        match self.is_paper() {
            true => LeafTriangles::Keep,
            false => LeafTriangles::Auto,
        }
    }

    /// Whether long thin leaves get wider where they grow, or longer and wider alike.
    pub fn needles(self) -> Needles {
        match self {
            Self::Look => Needles::Widen,
            Self::Information
            | Self::Paper
            | Self::PaperNormalised
            | Self::PaperFull
            | Self::PaperDeficit
            | Self::PaperNone => Needles::Scale,
        }
    }
}
