//! Cards: a plant as pictures of its flat layers.
//!
//! Crossed planes show the whole plant on each of a few quads: what lies before or behind moves with them. Cards
//! show a part each, where it is, so that a few hundred look like a crown from all around. They are ordinary
//! quads with one cut-out texture, which any client draws.

mod layers;
mod packing;

use std::borrow::Borrow;
use std::collections::BTreeMap;

use glam::{DVec2, DVec3, Vec2};
use rayon::prelude::*;
use secateur_eval::{ParallelView, SeenTexel, seen_along};
use secateur_model::{Mips, Surface};

use super::atlas::Atlas;
use super::cell::{Cell, Place};
use super::quads::Quads;
use layers::{Facet, Layer, facets, layers};
use packing::{Packed, packed};

/// Texels of the atlas on a side, at most.
const MOST_ATLAS: u32 = 2048;

/// Bytes that a texel of the atlas takes with its mip maps and a normal map of half as many texels a side.
const BYTES_A_TEXEL: f64 = 4.0 * (4.0 / 3.0) * 1.25;

/// How fine the pictures of cards are, and what they may take.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Texels {
    /// The length of a texel in pixels where there is room.
    pub finest_px: f64,
    /// The largest length of a texel in pixels.
    pub coarsest_px: f64,
    /// Bytes of the pictures on the GPU, at most.
    pub most_bytes: u64,
}

impl Texels {
    /// The finest texels for where the screen shows the plant so many pixels high, to those of `coarsest_px`, without a
    /// bound but that of the largest atlas.
    ///
    /// Leaves that are thinner than a pixel are seen by texels of half a pixel; where the plant is hardly more than a
    /// few pixels, by those of a quarter, which cost next to nothing. Where all of it `is_thin`, they are half as long.
    pub fn up_to(coarsest_px: f64, pixels_high: f64, is_thin: bool) -> Self {
        let finest_px = match (pixels_high <= 16.0, is_thin) {
            (true, true) => 0.125,
            (true, false) | (false, true) => 0.25,
            (false, false) => 0.5,
        };
        Self {
            finest_px,
            coarsest_px,
            most_bytes: u64::MAX,
        }
    }
}

/// What alpha is tested against, 0 to 1: cards that are seen from aside show less of thin leaves than there is.
pub(super) const CUTOFF: f32 = 0.35;

/// Rays along a side of a texel.
const SAMPLES: u32 = 2;

/// Clear texels about what a card shows: the outer half of them lies beyond its quad, so that filters find
/// nothing of its neighbours in the texture itself and its first mip.
const RIM: u32 = 2;

/// Texels are made larger by this until the atlas holds all cards.
const COARSER: f64 = 1.1;

/// A layer is of a trunk if its branches have this many times the area of a layer in the mean.
const TRUNK: f64 = 2.0;

/// Turns of a card within its plane that are tried, over a right angle.
const TURNS: u32 = 16;

/// A plant in flat layers, of which cards of any size can be baked.
pub struct Cards<'a, S> {
    surfaces: &'a [S],
    cards: Vec<Card>,
    /// From the lowest to the highest corner.
    height: f64,
}

/// A layer with its rectangle.
struct Card {
    /// What lies in it: triangles by surface.
    triangles: BTreeMap<u32, Vec<u32>>,
    centre: DVec3,
    /// Right, up and toward who sees its front.
    axes: [DVec3; 3],
    /// Half of its width and height.
    half: DVec2,
}

/// How cards lie in an atlas.
struct LaidOut {
    packed: Packed,
    /// Width and height of each card in texels.
    sides: Vec<[u32; 2]>,
    /// The length of a texel in units of the file, and in pixels.
    texel: f64,
    texel_px: f64,
}

/// Cards with their pictures.
pub(super) struct Baked {
    pub(super) surface: Surface,
    /// How many pixels a texel is long where the screen shows the plant as high as was asked for.
    pub(super) texel_px: f64,
}

impl<'a, S: Borrow<Surface> + Sync> Cards<'a, S> {
    /// Sorts what is drawn of a plant into at most `count` layers. A layer has one card, a part of a trunk two
    /// that cross. There are no cards where there is nothing to see.
    pub fn new(surfaces: &'a [S], count: usize) -> Self {
        Self::of(surfaces, count, |_| false)
    }

    /// As [`new`](Self::new), but all pieces of stems have two cards: with as many triangles they look nearer where few
    /// layers do.
    pub fn with_crossed_stems(surfaces: &'a [S], count: usize) -> Self {
        Self::of(surfaces, count, |layer| layer.is_stem)
    }

    fn of(surfaces: &'a [S], count: usize, crosses: impl Fn(&Layer) -> bool + Sync) -> Self {
        let facets = facets(surfaces);
        let ys = || facets.iter().flat_map(|f| f.corners).map(|c| c.y);
        let height = ys().fold(f64::MIN, f64::max) - ys().fold(f64::MAX, f64::min);
        let layers = layers(&facets, count);
        let area: f64 = layers.iter().map(|layer| layer.area).sum();
        let much = TRUNK * area / layers.len() as f64;
        let of_layer = |layer: &Layer| {
            let is_stem = crosses(layer) || layer.area_of_bodies > much;
            Card::of_layer(&facets, layer, is_stem)
        };
        Self {
            surfaces,
            cards: layers.par_iter().flat_map_iter(of_layer).collect(),
            height,
        }
    }

    /// How many there are.
    pub fn count(&self) -> usize {
        self.cards.len()
    }

    /// Whether one atlas holds cards for where the screen shows the plant at this height.
    pub fn fit(&self, pixels_high: f64, texels: Texels) -> bool {
        self.laid_out(pixels_high, texels).is_some()
    }

    /// How cards lie in an atlas with the finest texels that it has room for.
    fn laid_out(&self, pixels_high: f64, texels: Texels) -> Option<LaidOut> {
        let pixel = self.height / pixels_high;
        if self.cards.is_empty() || !(pixel > 0.0 && pixel.is_finite()) {
            return None;
        }
        let is_small = |packed: &Packed| {
            let [width, height] = packed.size.map(f64::from);
            width * height * BYTES_A_TEXEL <= texels.most_bytes as f64
        };
        // A plant of two texels is none: where those have no room, none has.
        let coarsest_px = texels.coarsest_px.min(2.0 * pixels_high.max(1.0));
        let mut texel_px = texels.finest_px;
        while texel_px <= coarsest_px {
            let texel = pixel * texel_px;
            let sides: Vec<[u32; 2]> = self.cards.iter().map(|card| card.sides(texel)).collect();
            if let Some(packed) = packed(&sides, MOST_ATLAS).filter(is_small) {
                return Some(LaidOut {
                    packed,
                    sides,
                    texel,
                    texel_px,
                });
            }
            texel_px *= COARSER;
        }
        None
    }

    /// The cards with their pictures where the screen shows the plant at this height; none if an atlas has no room for
    /// them.
    pub(super) fn baked(&self, pixels_high: f64, texels: Texels) -> Option<Baked> {
        let LaidOut {
            packed,
            sides,
            texel,
            texel_px,
        } = self.laid_out(pixels_high, texels)?;
        let baked: Vec<Vec<SeenTexel>> = (self.cards.par_iter().zip(&sides))
            .map(|(card, sides)| {
                let parts = card.parts(self.surfaces);
                seen_along(&parts, &card.view(texel), *sides, SAMPLES)
            })
            .collect();
        let places: Vec<Place> = (packed.places.iter().zip(&sides))
            .map(|(corner, sides)| Place {
                corner: *corner,
                size: *sides,
            })
            .collect();
        let [width, height] = packed.size;
        let mut seen = vec![SeenTexel::default(); (width * height) as usize];
        for (texels, place) in baked.into_iter().zip(&places) {
            let rows = texels.chunks(place.size[0] as usize).enumerate();
            for (row, texels) in rows {
                let first = (place.corner[1] as usize + row) * width as usize;
                seen[first + place.corner[0] as usize..][..texels.len()].copy_from_slice(texels);
            }
        }
        let mut atlas = Atlas::new(packed.size);
        atlas.put(
            &Cell::of_texels(seen, packed.size, &places, Mips::None),
            [0, 0],
        );
        let mut quads = Quads::default();
        for (card, place) in self.cards.iter().zip(&places) {
            // The texels at the rim are whole.
            let half = card.half + texel;
            let in_texels = (half / texel).as_vec2();
            let [corner, size] =
                [place.corner, place.size].map(|[x, y]| Vec2::new(x as f32, y as f32));
            let middle = corner + size / 2.0;
            let uvs = [-1.0, 1.0].map(|side| atlas.uv(middle + in_texels * side));
            quads.push(card.centre, card.axes, half, uvs);
        }
        Some(Baked {
            surface: quads.surface(atlas.material(Mips::None)),
            texel_px,
        })
    }
}

impl Card {
    /// The card of a layer; of a stem two, which would be gone where one is seen from the edge.
    fn of_layer(facets: &[Facet], layer: &Layer, is_stem: bool) -> Vec<Self> {
        let mut triangles: BTreeMap<u32, Vec<u32>> = BTreeMap::new();
        for member in &layer.members {
            let [surface, triangle] = facets[*member as usize].at;
            triangles.entry(surface).or_default().push(triangle);
        }
        let corners: Vec<DVec3> = (layer.members.iter())
            .flat_map(|member| facets[*member as usize].corners)
            .collect();
        let [off, narrow, wide] = layer.axes;
        let faced = match is_stem {
            true => vec![[off, narrow, wide], [narrow, off, wide]],
            false => vec![[off, narrow, wide]],
        };
        faced
            .into_iter()
            .map(|axes| Self::facing(axes, layer.mean, &corners, triangles.clone()))
            .collect()
    }

    /// What lies in it.
    fn parts<S: Borrow<Surface>>(&self, surfaces: &[S]) -> Vec<Surface> {
        let of_surface = |(surface, triangles): (&u32, &Vec<u32>)| {
            part(surfaces[*surface as usize].borrow(), triangles)
        };
        self.triangles.iter().map(of_surface).collect()
    }

    /// A card that faces the first of these axes, turned such that it is as small as can be.
    fn facing(
        axes: [DVec3; 3],
        mean: DVec3,
        corners: &[DVec3],
        triangles: BTreeMap<u32, Vec<u32>>,
    ) -> Self {
        let turned = (0..TURNS).map(|turn| turned(axes, mean, corners, turn));
        let area = |half: DVec2| half.x * half.y;
        let smallest = turned.min_by(|a, b| area(a.2).total_cmp(&area(b.2)));
        let (centre, axes, half) =
            smallest.unwrap_or_else(|| unreachable!("there is a turn of every card"));
        Self {
            triangles,
            centre,
            axes,
            half,
        }
    }

    fn view(&self, texel: f64) -> ParallelView {
        let [_, up, toward] = self.axes;
        ParallelView {
            centre: self.centre,
            toward,
            up,
            texel,
        }
    }

    /// Width and height of its picture in texels.
    fn sides(&self, texel: f64) -> [u32; 2] {
        // More than any atlas has is no number of texels.
        let side = |half: f64| (2.0 * half / texel).ceil().min(f64::from(MOST_ATLAS)) as u32;
        [side(self.half.x), side(self.half.y)].map(|side| side + 2 * RIM)
    }
}

/// The rectangle about corners in a plane: its middle, axes, and half of its width and height.
fn turned(
    [toward, narrow, wide]: [DVec3; 3],
    mean: DVec3,
    corners: &[DVec3],
    turn: u32,
) -> (DVec3, [DVec3; 3], DVec2) {
    let part = f64::from(turn) / f64::from(TURNS);
    let up = (wide * (1.0 - part) + narrow * part).normalize();
    let axes = [up.cross(toward), up, toward];
    let (mut low, mut high) = (DVec2::INFINITY, DVec2::NEG_INFINITY);
    for corner in corners {
        let away = *corner - mean;
        let at = DVec2::new(away.dot(axes[0]), away.dot(axes[1]));
        (low, high) = (low.min(at), high.max(at));
    }
    let middle = (low + high) / 2.0;
    let centre = mean + axes[0] * middle.x + axes[1] * middle.y;
    (centre, axes, (high - low) / 2.0)
}

/// Some triangles of a surface.
fn part(surface: &Surface, triangles: &[u32]) -> Surface {
    let corners = || {
        let corners = triangles.iter().map(|t| surface.triangles[*t as usize]);
        corners.flatten().map(|corner| corner as usize)
    };
    Surface {
        positions: corners().map(|k| surface.positions[k]).collect(),
        normals: corners()
            .filter_map(|k| surface.normals.get(k).copied())
            .collect(),
        uvs: corners()
            .filter_map(|k| surface.uvs.get(k).copied())
            .collect(),
        colors: corners()
            .filter_map(|k| surface.colors.get(k).copied())
            .collect(),
        holds: Vec::new(),
        triangles: (0..triangles.len() as u32)
            .map(|t| [3 * t, 3 * t + 1, 3 * t + 2])
            .collect(),
        material: surface.material.clone(),
    }
}

#[cfg(test)]
mod tests;
