//! All pieces of a plant without leaves at once, coarser by collapses over all of them.
//!
//! Crowns of low-poly trees are a few closed blobs, on a trunk of which a tenth of a blob's size is all. So an error
//! counts more in a thin piece, and what is left of a ball has corners outside of it: vertices move to where the surface
//! is off least.

use glam::{DVec2, DVec3};
use rustc_hash::FxHashSet;
use secateur_model::{CornerRef, Foliage, LeafId, LeafTriangle, Lod, NewCorner, NewLeaf, Place};

use super::Wood;
use super::fullness::outwards;
use super::hanging::Holds;
use super::levels::{EVEN_NORMAL_WEIGHT, UV_WEIGHT, joints};
use super::thickness::thickness;
use crate::coarsen::leaf_mesh::{Kept, MovedCorner, collapsed_moving};

/// An error counts by this power of how many times thinner its piece is than the thickest. The differences of 18 public
/// plants at .6 and .4 of their triangles are 16.4 together by 0, 15.9 by .5 and 16.9 by 1.
const THINNESS_POWER: f64 = 0.5;

/// Pieces count as no thinner than this share of the thickest.
const THINNEST: f64 = 1e-3;

impl Wood {
    /// The wood that this was made of with at most this many triangles, after collapses over all pieces in the order of
    /// what they put off; none if they do not get there, or leave more than a little in the air.
    pub fn evenly(&self, wood: &Foliage, at_most: usize) -> Option<Lod> {
        let lod = self.collapsed_evenly(wood, at_most)?;
        Holds::of(wood).without_hanging(wood, lod)
    }

    fn collapsed_evenly(&self, wood: &Foliage, at_most: usize) -> Option<Lod> {
        let scales = scales(wood);
        let (triangles, locked) = self.scaled(wood, &scales);
        let is_locked = |place: DVec3| locked.contains(&key(place));
        let collapsed = |triangles: &[LeafTriangle]| {
            let kept = Kept {
                uv_weight: UV_WEIGHT,
                normal_weight: EVEN_NORMAL_WEIGHT,
                is_locked: &is_locked,
            };
            let left = collapsed_moving(triangles, kept, at_most)?;
            (left.len() <= at_most).then_some(left)
        };
        if let Some(left) = collapsed(&triangles) {
            let texture = |piece, corners| self.parts.texture_of(piece, corners);
            return Some(joined(wood, &scales, &left, texture));
        }
        // Where collapses along textures stall, corners are welded by position alone, and a face has one face's texture.
        let mut welded = triangles;
        for (piece, own) in pieces(wood).zip(of_pieces(wood, &mut welded)) {
            for triangle in own {
                triangle.uvs = [apart(piece); 3];
            }
        }
        Some(joined(
            wood,
            &scales,
            &collapsed(&welded)?,
            |_, [a, _, _]| [0, 1, 2].map(|k| a - a % 3 + (a + k) % 3),
        ))
    }

    /// The triangles of all pieces, scaled, and the places that stay.
    fn scaled(&self, wood: &Foliage, scales: &[Scale]) -> (Vec<LeafTriangle>, FxHashSet<[u64; 3]>) {
        let is_joint = joints(&self.parts);
        let mut locked = FxHashSet::default();
        let mut all: Vec<LeafTriangle> = Vec::with_capacity(wood.triangles().len());
        for (piece, scale) in pieces(wood).zip(scales) {
            let is_cut = self.parts.has_charts(piece);
            for triangle in wood.triangles_of(piece) {
                let joints = triangle.corners.into_iter().filter(|at| is_joint(*at));
                locked.extend(joints.map(|at| key(scale.scaled(at))));
                all.push(LeafTriangle {
                    corners: triangle.corners.map(|at| scale.scaled(at)),
                    uvs: triangle.uvs.map(|uv| match is_cut {
                        true => apart(piece),
                        false => uv + apart(piece),
                    }),
                });
            }
        }
        (all, locked)
    }
}

/// Pieces that touch share no vertex: each has its own part of the texture's plane, from here on.
fn apart(piece: LeafId) -> DVec2 {
    DVec2::new(2.0 * piece.index() as f64, 0.0)
}

fn pieces(wood: &Foliage) -> impl Iterator<Item = LeafId> + Clone + use<> {
    (0..wood.leaves().len()).map(LeafId::from_index)
}

/// The triangles of each piece among those of all.
fn of_pieces<'t>(
    wood: &Foliage,
    mut all: &'t mut [LeafTriangle],
) -> impl Iterator<Item = &'t mut [LeafTriangle]> {
    pieces(wood).map(move |piece| {
        let count = wood.triangles_of(piece).len();
        all.split_off_mut(..count).expect("triangles of all pieces")
    })
}

/// How a piece is scaled before the collapses, and the box that it fills.
#[derive(Clone, Copy, Debug)]
struct Scale {
    by: f64,
    low: DVec3,
    high: DVec3,
}

impl Scale {
    fn scaled(&self, at: DVec3) -> DVec3 {
        self.low + self.by * (at - self.low)
    }

    /// Where a vertex that moved is: not beyond what the piece fills, so that no foot sinks into the ground.
    fn unscaled(&self, at: DVec3) -> DVec3 {
        (self.low + (at - self.low) / self.by).clamp(self.low, self.high)
    }
}

fn scales(wood: &Foliage) -> Vec<Scale> {
    let thickness_of = |piece| thickness(wood, piece);
    let thickest = pieces(wood).map(thickness_of).fold(0.0, f64::max);
    let scale = |piece: LeafId| {
        let corners = wood.triangles_of(piece).iter().flat_map(|t| t.corners);
        let (low, high) = corners.fold(
            (DVec3::INFINITY, DVec3::NEG_INFINITY),
            |(low, high), corner| (low.min(corner), high.max(corner)),
        );
        let share = (thickness_of(piece) / thickest).max(THINNEST);
        Scale {
            by: share.powf(-THINNESS_POWER),
            low,
            high,
        }
    };
    pieces(wood).map(scale).collect()
}

/// What is left of all pieces. `texture` says which corners of a piece a triangle of these has its texture from.
fn joined(
    wood: &Foliage,
    scales: &[Scale],
    left: &[[MovedCorner; 3]],
    texture: impl Fn(LeafId, [u32; 3]) -> [u32; 3],
) -> Lod {
    let mut firsts = Vec::with_capacity(scales.len());
    let mut end = 0;
    for piece in pieces(wood) {
        firsts.push(end);
        end += 3 * wood.triangles_of(piece).len() as u32;
    }
    let mut made: Vec<Vec<[NewCorner; 3]>> = vec![Vec::new(); scales.len()];
    for triangle in left {
        let index = firsts.partition_point(|first| *first <= triangle[0].like) - 1;
        let leaf = LeafId::from_index(index);
        let corners = triangle.map(|corner| corner.like - firsts[index]);
        let like = texture(leaf, corners);
        made[index].push([0, 1, 2].map(|k| NewCorner {
            place: match triangle[k].moved_to {
                Some(at) => Place::At(scales[index].unscaled(at)),
                None => Place::Of(CornerRef {
                    leaf,
                    corner: corners[k],
                }),
            },
            like: like[k],
        }));
    }
    let mut lod = Lod::original(scales.len());
    for (donor, triangles) in pieces(wood).zip(made) {
        if triangles.len() == wood.triangles_of(donor).len() {
            continue;
        }
        lod.remove(donor);
        if !triangles.is_empty() {
            let triangles = as_full(wood, donor, triangles, &scales[donor.index()]);
            lod.make(NewLeaf { donor, triangles });
        }
    }
    lod
}

/// What is left of a piece, as full as the piece was.
fn as_full(
    wood: &Foliage,
    piece: LeafId,
    mut triangles: Vec<[NewCorner; 3]>,
    scale: &Scale,
) -> Vec<[NewCorner; 3]> {
    let place = |corner: &NewCorner| match &corner.place {
        Place::At(at) => *at,
        Place::Of(corner) => corner.position(wood),
        Place::InPlaneOf { .. } => unreachable!("collapses move corners or keep them"),
    };
    let left: Vec<[DVec3; 3]> = triangles
        .iter()
        .map(|corners| [0, 1, 2].map(|k| place(&corners[k])))
        .collect();
    let own = wood.triangles_of(piece);
    if let Some(moved) = outwards(own, &left, thickness(wood, piece)) {
        for (corners, places) in triangles.iter_mut().zip(moved) {
            for (corner, at) in corners.iter_mut().zip(places) {
                corner.place = Place::At(at.clamp(scale.low, scale.high));
            }
        }
    }
    triangles
}

pub(super) fn key(place: DVec3) -> [u64; 3] {
    place.to_array().map(|v| (v + 0.0).to_bits())
}
