//! How much work goes into a level. What each effort comes to is the table [`Effort::work`]; the points were chosen by
//! the table in `docs/simplify.md`.

use serde::{Deserialize, Serialize};

use crate::Views;
use crate::whole::Sharing::{self, ByNumber, LeafMargin};

/// How much work goes into a level: it decides what other options leave to the program (`auto`).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "cli", derive(clap::ValueEnum, schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum Effort {
    /// A first look: few and small pictures, no sizes fitted, no cutoffs chosen, few levels tried.
    Fast,
    /// What suits most plants.
    #[default]
    Normal,
    /// Several ways to share triangles between leaves and wood are tried, and what looks nearest is taken.
    Best,
}

/// What an effort comes to.
#[derive(Clone, Debug, PartialEq)]
pub struct Work {
    /// What [`Views::Auto`] stands for; nothing where a run decides by its leaves.
    pub(crate) views: Option<Views>,
    /// What [`Resolution::Auto`](crate::Resolution::Auto) stands for in the look, in pixels a side. On three trees with
    /// leaves so small that 512 are chosen for information (a grown oak and birch, a pine), at a tenth of the leaves, FLIP
    /// with 256 is .99, 1.03 and 1.02 of what it is there, in half of the time (`benches/judges.rs`).
    pub(crate) look_px: u32,
    /// Pixels a side of views that say how much of each piece of wood is seen, and of those in which its levels are
    /// judged, where there are few enough of these: with 256 FLIP was .0138 instead of .0127 on `ez_bush2` at a quarter of
    /// all triangles.
    pub(crate) wood_px: [u32; 2],
    /// Pixels a side of the pictures in which the leaves of a level of a chain that is searched for get their sizes, at
    /// most. With 256 for 512 a level that is tried takes .43 of the time on `ez_bush2` and on `quat_commontree_1`, and
    /// the first level that is taken has as many triangles as before (1,683 and 644).
    pub search_fit_px: u32,
    /// Whether [`Fitting::Auto`](crate::Fitting::Auto) fits sizes, and cutoffs are chosen where nothing is said of them.
    pub(crate) fits: bool,
    /// How triangles may be shared between leaves and wood in one level: the nearest to the plant is taken.
    pub sharings_of_one: &'static [Sharing],
    /// How triangles may be shared at each step of a search for a level of a chain; the first is tried first.
    pub sharings: &'static [Sharing],
    /// The most levels of a chain that are made whole, with their textures, for one place.
    pub placed: usize,
    /// Levels of a chain are compared in pictures in which the plant is at most this many pixels high, and only what is
    /// found in those of its size.
    pub search_px: f64,
    /// How far levels of a chain look from the plant is estimated where the screen shows them higher than this many
    /// pixels: from pictures of a search, and two views of that size.
    pub exact_up_to_px: f64,
}

impl Effort {
    /// The name by which it is asked for.
    pub fn name(self) -> &'static str {
        match self {
            Self::Fast => "fast",
            Self::Normal => "normal",
            Self::Best => "best",
        }
    }

    /// What it comes to.
    pub fn work(self) -> Work {
        match self {
            Self::Fast => Work {
                views: Some(Views::Icosahedron),
                look_px: 128,
                wood_px: [128, 256],
                search_fit_px: 256,
                fits: false,
                sharings_of_one: &[ByNumber],
                sharings: &[LeafMargin(0.15)],
                placed: 2,
                search_px: 160.0,
                exact_up_to_px: 96.0,
            },
            // Pictures of 1,024 pixels take seven times as long as those of 384.
            Self::Normal => Work {
                views: None,
                look_px: 256,
                wood_px: [256, 512],
                search_fit_px: 256,
                fits: true,
                sharings_of_one: &[ByNumber],
                sharings: &[LeafMargin(0.15), LeafMargin(0.05), LeafMargin(0.3)],
                placed: 3,
                search_px: 384.0,
                exact_up_to_px: f64::INFINITY,
            },
            Self::Best => Work {
                search_fit_px: 512,
                sharings_of_one: &[
                    ByNumber,
                    LeafMargin(0.02),
                    LeafMargin(0.05),
                    LeafMargin(0.1),
                    LeafMargin(0.15),
                    LeafMargin(0.5),
                    LeafMargin(1.0),
                ],
                sharings: &[
                    LeafMargin(0.15),
                    LeafMargin(0.02),
                    LeafMargin(0.05),
                    LeafMargin(0.1),
                    LeafMargin(0.3),
                    LeafMargin(0.6),
                ],
                placed: 6,
                search_px: 768.0,
                ..Self::Normal.work()
            },
        }
    }
}
