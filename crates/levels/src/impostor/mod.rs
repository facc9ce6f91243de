//! Impostors: pictures of a plant that stand for it far off.
//!
//! [`crossed`] planes are a few quads that any client draws; [`cards`] are some dozens to hundreds, each with a
//! layer of the plant; [`octahedral`] views are pictures of which a sampler blends those that are nearest
//! to where the eye is. All are baked from the original with colour, alpha and normals: `cell` makes the picture of
//! one view, `coverage` its alpha, and `atlas` puts them side by side. [`judge`] says how far they look from
//! the plant, and [`fewest_cards`] how many cards are enough.

mod atlas;
pub mod cards;
mod cell;
mod coverage;
pub mod crossed;
pub mod fewest_cards;
pub mod judge;
pub mod octahedral;
mod quads;

use std::borrow::Borrow;
use std::sync::Arc;

use glam::DVec3;
use secateur_eval::{LINEAR_FROM_SRGB, srgb_byte};
use secateur_model::{AlphaMode, Mips, Surface};
use secateur_simplify::{Error, Observer, Progress};
use serde_json::{Map, Value, json};

use crate::chain::bytes_of;
use atlas::{Atlas, BORDER, halved_normals};
use cards::{Baked, Cards, Texels};
use crossed::Planes;
use octahedral::{CELLS, FRAMES, Octahedral};

/// Which impostor a chain ends in.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[cfg_attr(feature = "cli", derive(clap::ValueEnum))]
#[serde(rename_all = "kebab-case")]
pub enum Choice {
    /// No impostor: the chain ends in a mesh.
    #[default]
    None,
    /// Planes that cross along the main axes of the crown, each with a picture.
    Crossed,
    /// Cards, as few as are within `--max-difference`.
    ///
    /// Each has a flat layer of the plant.
    Cards,
    /// Views from all directions in one texture, laid out as an octahedron that is folded open.
    Octahedral,
    /// Crossed planes where they look no worse, cards where they are lighter.
    ///
    /// Crossed planes look no worse than what they take the place of; cards are within the difference and lighter
    /// than a mesh by a third.
    Auto,
}

impl Choice {
    /// Whether the chain ends in an impostor whatever it looks like beside a mesh.
    pub fn is_demanded(self) -> bool {
        matches!(self, Self::Crossed | Self::Cards | Self::Octahedral)
    }
}

/// The least and the largest texels a side of a cell.
const CELL: [u32; 2] = [32, 512];

/// The least and the largest texels a side of an octahedral view, of which there are many.
const VIEW_CELL: [u32; 2] = [32, 128];

/// An impostor of a plant.
#[derive(Clone, Debug)]
pub struct Impostor {
    /// What any client draws: quads with a texture of their own, in world space.
    pub surface: Surface,
    look: Look,
}

#[derive(Clone, Debug)]
enum Look {
    Crossed(Planes, u32),
    Cards { texel_px: f64 },
    Octahedral(Octahedral),
}

impl Impostor {
    /// Crossed planes for a height on the screen, `None` of a plant of which nothing can be seen.
    pub fn crossed<S: Borrow<Surface> + Sync>(
        surfaces: &[S],
        wanted: Planes,
        pixels_high: f64,
    ) -> Option<Self> {
        let planes = crossed::planes(surfaces, wanted)?;
        let cell = cell_for(pixels_high, CELL);
        let across = 2;
        let down = wanted.count().div_ceil(across);
        let places: Vec<[u32; 2]> = (0..wanted.count())
            .map(|k| [k % across, k / across])
            .collect();
        let mut atlas = Atlas::new([across, down].map(|cells| cells * cell));
        let quads = crossed::quads(surfaces, &planes, cell, &places, &mut atlas);
        Some(Self {
            surface: quads.surface(atlas.material(Mips::Blended)),
            look: Look::Crossed(wanted, cell),
        })
    }

    /// Octahedral views for a height on the screen, and two crossed planes for clients without a
    /// sampler; `None` of a plant of which nothing can be seen.
    pub fn octahedral<S: Borrow<Surface> + Sync>(surfaces: &[S], pixels_high: f64) -> Option<Self> {
        let planes = crossed::planes(surfaces, Planes::ALL[0])?;
        let (centre, radius) = sphere_of(surfaces)?;
        let cell = cell_for(pixels_high, VIEW_CELL);
        let mut atlas = Atlas::new([CELLS * cell; 2]);
        octahedral::bake_views(surfaces, (centre, radius), cell, &mut atlas);
        let places = [[0, FRAMES], [1, FRAMES]];
        let quads = crossed::quads(surfaces, &planes, cell, &places, &mut atlas);
        Some(Self {
            surface: quads.surface(atlas.material(Mips::Blended)),
            look: Look::Octahedral(Octahedral::new(centre, radius, cell, atlas)),
        })
    }

    /// Cards for a height on the screen. Their texels are as fine as may be and one texture has room for; `None` if
    /// there is no room, or nothing to see.
    pub fn cards<S: Borrow<Surface> + Sync>(
        cards: &Cards<'_, S>,
        pixels_high: f64,
        texels: Texels,
    ) -> Option<Self> {
        let Baked { surface, texel_px } = cards.baked(pixels_high, texels)?;
        let made = Self {
            surface,
            look: Look::Cards { texel_px },
        };
        Some(made.with_cutoff(cards::CUTOFF))
    }

    /// This impostor without its normals: each quad is lit as the plane that it is.
    pub fn flat(&self) -> Self {
        let mut flat = self.clone();
        Arc::make_mut(&mut flat.surface.material).finish.normal_map = None;
        flat
    }

    /// This impostor with a normal map of half as many texels a side; none without a normal map.
    pub fn with_half_normals(&self) -> Option<Self> {
        let mut half = self.clone();
        let material = Arc::make_mut(&mut half.surface.material);
        let map = material.finish.normal_map.as_mut()?;
        map.texture = Arc::new(halved_normals(&map.texture));
        Some(half)
    }

    /// This impostor, tested against this alpha.
    pub fn with_cutoff(&self, cutoff: f32) -> Self {
        let mut other = self.clone();
        Arc::make_mut(&mut other.surface.material).alpha_mode = AlphaMode::Mask(cutoff);
        other
    }

    /// This impostor with colours so many times as bright in linear light, as far as they can be.
    pub fn with_brightness(&self, times: f32) -> Self {
        let mut other = self.clone();
        let material = Arc::make_mut(&mut other.surface.material);
        if let Some(texture) = material.texture.as_mut() {
            for (at, byte) in Arc::make_mut(texture).rgba.iter_mut().enumerate() {
                if at % 4 < 3 {
                    *byte = srgb_byte(LINEAR_FROM_SRGB[usize::from(*byte)] * times);
                }
            }
        }
        other
    }

    /// This impostor, read with these mips.
    pub fn with_mips(&self, mips: Mips) -> Self {
        let mut other = self.clone();
        let material = Arc::make_mut(&mut other.surface.material);
        let normals = material
            .finish
            .normal_map
            .as_mut()
            .map(|map| &mut map.texture);
        for texture in material.texture.as_mut().into_iter().chain(normals) {
            if texture.filters.mips != mips {
                Arc::make_mut(texture).filters.mips = mips;
            }
        }
        other
    }

    /// What its pictures take on the GPU, in bytes.
    pub fn texture_bytes(&self) -> u64 {
        let material = &self.surface.material;
        let normals = material.finish.normal_map.as_ref().map(|map| &map.texture);
        let textures = material.texture.iter().chain(normals);
        textures.map(|texture| bytes_of(texture)).sum()
    }

    /// How many pixels a texel of cards is long where they begin; none of other impostors.
    pub fn texel_px(&self) -> Option<f64> {
        match self.look {
            Look::Cards { texel_px } => Some(texel_px),
            Look::Crossed(..) | Look::Octahedral(_) => None,
        }
    }

    /// Whether only a sampler of its own draws it as it is meant.
    pub fn needs_sampler(&self) -> bool {
        matches!(self.look, Look::Octahedral(_))
    }

    /// What an eye sees of it: octahedral views as their sampler shows them.
    pub fn seen_from(&self, eye: DVec3) -> Surface {
        match &self.look {
            Look::Crossed(..) | Look::Cards { .. } => self.surface.clone(),
            Look::Octahedral(views) => {
                let mut facing = views.facing(eye - views.centre);
                if self.surface.material.finish.normal_map.is_none() {
                    Arc::make_mut(&mut facing.material).finish.normal_map = None;
                }
                facing
            }
        }
    }

    /// What samplers and reports need to know.
    pub fn facts(&self) -> Map<String, Value> {
        let texture = self.surface.material.texture.as_ref();
        let size = texture.map(|texture| [texture.width, texture.height]);
        let facts = match &self.look {
            Look::Crossed(planes, cell) => json!({
                "layout": "crossed",
                "planes": planes.count(),
                "normal_map": self.surface.material.finish.normal_map.is_some(),
                "atlas": size,
                "cell": cell,
            }),
            Look::Cards { texel_px } => json!({
                "layout": "cards",
                "cards": self.surface.triangles.len() / 2,
                "normal_map": self.surface.material.finish.normal_map.is_some(),
                "atlas": size,
                "texel_px": texel_px,
            }),
            Look::Octahedral(views) => json!({
                "layout": "octahedral",
                "hemisphere": "upper",
                "frames": FRAMES,
                "cells": CELLS,
                "atlas": size,
                "cell": views.cell,
                "border": BORDER,
                "centre": views.centre.to_array(),
                "radius": views.radius,
            }),
        };
        facts.as_object().cloned().unwrap_or_default()
    }
}

/// Says that another impostor is about to be baked or looked at, and asks whether to go on.
///
/// # Errors
/// [`Error::Stopped`] if not.
pub(crate) fn poll(observer: &mut Observer<'_>) -> Result<(), Error> {
    Progress::Impostor.tell(observer)
}

/// Texels a side: as many as pixels show the plant, up to a power of two.
fn cell_for(pixels_high: f64, [least, most]: [u32; 2]) -> u32 {
    let pixels = pixels_high.ceil().clamp(f64::from(least), f64::from(most));
    (pixels as u32).next_power_of_two()
}

/// The middle of the box about all that is drawn, and the distance of the farthest corner from it.
fn sphere_of<S: Borrow<Surface>>(surfaces: &[S]) -> Option<(DVec3, f64)> {
    let corners = || {
        surfaces.iter().flat_map(|surface| {
            let surface = surface.borrow();
            let corners = surface.triangles.iter().flatten();
            corners.map(|corner| surface.positions[*corner as usize])
        })
    };
    let finite = || corners().filter(|corner| corner.is_finite());
    let (low, high) = finite().fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(low, high), c| {
        (low.min(c), high.max(c))
    });
    let centre = (low + high) / 2.0;
    let radius = finite().map(|c| c.distance(centre)).fold(0.0, f64::max);
    (radius > 0.0).then_some((centre, radius))
}
