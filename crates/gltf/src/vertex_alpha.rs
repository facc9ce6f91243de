//! The alpha of vertex colours: whether it is part of the look.
//!
//! By the specification it is a factor of the material's alpha. But many plants keep wind data in COLOR_0, whose
//! alpha then hides all leaves. One reading holds for a whole file and for everybody who looks at it.

use std::fmt;
use std::str::FromStr;

use secateur_model::{NamedOption, Note};

use super::Document;
use super::cutouts::cutoff;
use super::error::Fault;
use super::survey::{Group, Survey};

/// Whether the alpha of vertex colours hides leaves. Spelled `auto`, `keep` or `ignore`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum VertexAlpha {
    /// Alpha counts, unless it would hide most of a primitive: then it is ignored in the whole file, with a
    /// warning.
    #[default]
    Auto,
    /// Alpha counts, as glTF has it.
    Keep,
    /// Alpha does not count: it is something else, such as wind data.
    Ignore,
}

impl FromStr for VertexAlpha {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        match text {
            "auto" => Ok(Self::Auto),
            "keep" => Ok(Self::Keep),
            "ignore" => Ok(Self::Ignore),
            _ => Err("write auto, keep or ignore".to_owned()),
        }
    }
}

impl fmt::Display for VertexAlpha {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Auto => "auto",
            Self::Keep => "keep",
            Self::Ignore => "ignore",
        })
    }
}

/// From which share of a primitive's triangles on alpha that hides them is taken for something else.
const MOST: f64 = 0.5;

impl Document {
    /// The document with the alpha of its vertex colours read so, by all that look at it.
    #[must_use]
    pub fn with_vertex_alpha(mut self, alpha: VertexAlpha) -> Self {
        self.vertex_alpha_counts = match alpha {
            VertexAlpha::Auto => None,
            VertexAlpha::Keep => Some(true),
            VertexAlpha::Ignore => Some(false),
        };
        self
    }

    /// The primitives of which the alpha of vertex colours would hide most, as their places in the survey; it is
    /// ignored in the whole file if there are any.
    pub(crate) fn hidden_by_vertices(&self, survey: &Survey) -> Result<Vec<usize>, Fault> {
        let mut hidden = Vec::new();
        for (number, group) in survey.groups.iter().enumerate() {
            let Some(alphas) = self.vertex_alphas(group)? else {
                continue;
            };
            let triangles = &group.geometry.triangles;
            let count = triangles
                .iter()
                .filter(|corners| alphas.hide(*corners))
                .count();
            if count as f64 > MOST * triangles.len() as f64 {
                hidden.push(number);
            }
        }
        Ok(hidden)
    }

    /// Whether the alpha of vertex colours is a part of the look.
    pub(crate) fn vertex_alpha_counts(&self, survey: &Survey) -> Result<bool, Fault> {
        match self.vertex_alpha_counts {
            Some(known) => Ok(known),
            None => Ok(self.hidden_by_vertices(survey)?.is_empty()),
        }
    }

    /// The alphas of a primitive's vertices, where its material tests them.
    pub(crate) fn vertex_alphas(&self, group: &Group) -> Result<Option<VertexAlphas>, Fault> {
        let Some(cutoff) = cutoff(&group.look) else {
            return Ok(None);
        };
        let colors = self.colors(group.mesh, group.primitive)?;
        let factor = group.look.base_color[3];
        // What the material hides by itself is no matter of vertices.
        Ok(
            (!colors.is_empty() && factor >= cutoff).then(|| VertexAlphas {
                alphas: colors.iter().map(|color| color.w * factor).collect(),
                cutoff,
            }),
        )
    }
}

/// The alphas of vertices, the material's factor in them.
pub(crate) struct VertexAlphas {
    alphas: Vec<f32>,
    cutoff: f32,
}

impl VertexAlphas {
    /// Whether nothing can be seen of what these vertices span, however opaque its texture is.
    pub(crate) fn hide<'v>(&self, vertices: impl IntoIterator<Item = &'v u32>) -> bool {
        let mut vertices = vertices.into_iter();
        vertices.all(|&vertex| self.alphas[vertex as usize] < self.cutoff)
    }
}

/// The warning where the alpha of vertices is ignored.
pub(crate) fn warning(place: &str) -> Note {
    Note::from(format!(
        "{place}: the alpha of its COLOR_0 would hide most of it and is ignored, as if it were wind data ("
    ))
    .naming(NamedOption::KeepVertexAlpha)
    .then(" counts it); engines that follow glTF hide it")
}
