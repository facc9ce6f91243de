//! Leaves of fewer triangles, so that a budget of triangles shows more leaves.
//!
//! Half of the leaves in all their detail leave more holes in a crown than all of
//! them with half of their triangles. So triangles are shared out before leaves
//! go: every leaf may keep as many as every other, and what that leaves over
//! goes to the largest. A leaf becomes coarser by collapses of its edges
//! (meshoptimizer, by quadric error, in f32: another processor may choose other
//! triangles), and is then grown and moved so that its area and its centre stay.

use ::meshopt::{SimplifyOptions, VertexDataAdapter};
use glam::{DVec2, DVec3};
use rayon::prelude::*;
use rustc_hash::FxHashMap;
use secateur_model::{
    Foliage, Growth, LeafId, LeafTriangle, NewCorner, NewLeaf, Place, RemovalOrder, Step,
};

/// What is left of a leaf grows at most by this to give back its area: a sliver
/// would become a spike.
const MOST_LINEAR_SCALE: f64 = 3.0;

/// How many triangles each leaf may keep so that all together have `at_most`, as
/// evenly as that goes, none below `least` of it; the last over go to the largest
/// leaves, one each. More than `at_most` only if all have the least.
pub fn shared_out(
    foliage: &Foliage,
    at_most: usize,
    least: impl Fn(LeafId) -> usize,
) -> Vec<usize> {
    let leaves = || (0..foliage.leaves().len()).map(LeafId::from_index);
    let own: Vec<usize> = leaves().map(|l| foliage.triangles_of(l).len()).collect();
    let least: Vec<usize> = leaves().map(|leaf| least(leaf).max(1)).collect();
    let share = |leaf: LeafId, level: usize| own[leaf.index()].min(level.max(least[leaf.index()]));
    let sum = |level: usize| leaves().map(|leaf| share(leaf, level)).sum::<usize>();
    let (mut fits, mut is_too_much) = (0, own.iter().max().map_or(1, |most| most + 1));
    while is_too_much - fits > 1 {
        let level = fits + (is_too_much - fits) / 2;
        match sum(level) <= at_most {
            true => fits = level,
            false => is_too_much = level,
        }
    }
    let mut shares: Vec<usize> = leaves().map(|leaf| share(leaf, fits)).collect();
    let could_have_more = |leaf: &LeafId| share(*leaf, fits + 1) > shares[leaf.index()];
    let mut by_area: Vec<LeafId> = leaves().filter(could_have_more).collect();
    let area = |leaf: &LeafId| foliage.leaf(*leaf).area();
    by_area.sort_by(|a, b| area(b).total_cmp(&area(a)));
    by_area.truncate(at_most.saturating_sub(shares.iter().sum()));
    by_area.iter().for_each(|leaf| shares[leaf.index()] += 1);
    shares
}

/// A foliage with coarser leaves.
#[derive(Clone, Debug)]
pub struct Coarse {
    foliage: Foliage,
    /// For each leaf what takes its place; nothing where it stays as it is.
    made: Vec<Option<NewLeaf>>,
}

/// Makes the leaves coarser that have more triangles than they may keep, on the
/// threads of the current rayon pool; nothing if none becomes coarser.
///
/// A leaf keeps more than it may where collapses of edges do not get that far: of a
/// leaf of front and back faces a triangle of each is left. It stays as it is where
/// no edge can collapse, or what would be left has no area.
///
/// # Panics
/// If `triangles_at_most` is not of one number for each leaf.
pub fn coarsen(foliage: &Foliage, triangles_at_most: &[usize]) -> Option<Coarse> {
    assert_eq!(triangles_at_most.len(), foliage.leaves().len());
    let coarser = |(index, &at_most)| coarser_leaf(foliage, LeafId::from_index(index), at_most);
    let made: Vec<Option<NewLeaf>> = triangles_at_most
        .par_iter()
        .enumerate()
        .map(coarser)
        .collect();
    if made.iter().all(Option::is_none) {
        return None;
    }
    let mut coarse = Foliage::new(foliage.cutouts().to_vec());
    for (index, made) in made.iter().enumerate() {
        let leaf = LeafId::from_index(index);
        let triangles = match made {
            Some(made) => made.triangles_in(foliage, 1.0),
            None => foliage.triangles_of(leaf).to_vec(),
        };
        let pushed = coarse.push_leaf(&triangles, foliage.leaf(leaf).cutout());
        pushed.expect("a leaf that is coarser than one that was there");
    }
    Some(Coarse {
        foliage: coarse,
        made,
    })
}

impl Coarse {
    /// The leaves, by the same names as before.
    pub fn foliage(&self) -> &Foliage {
        &self.foliage
    }

    /// An order over the coarser leaves as one over those before: a first step puts
    /// them in the place of those, the others go by their new names.
    ///
    /// # Panics
    /// If the order is of other leaves, or makes some itself.
    pub fn order(&self, of_coarse: &RemovalOrder) -> RemovalOrder {
        let mut removed: Vec<LeafId> = Vec::new();
        let mut made: Vec<NewLeaf> = Vec::new();
        let mut name_of: Vec<LeafId> = Vec::with_capacity(self.made.len());
        for (index, coarser) in self.made.iter().enumerate() {
            let leaf = LeafId::from_index(index);
            name_of.push(match coarser {
                Some(_) => LeafId::from_index(self.made.len() + made.len()),
                None => leaf,
            });
            removed.extend(coarser.as_ref().map(|_| leaf));
            made.extend(coarser.clone());
        }
        let mut order = RemovalOrder::new(of_coarse.leaf_count());
        order.push_step(Step {
            removed: &removed,
            grown: &[],
            made: &made,
            survivors_area_scale: 1.0,
        });
        for step in of_coarse.steps() {
            let name = |leaf: &LeafId| name_of[leaf.index()];
            let grown = step.grown.iter().map(|growth| Growth {
                leaf: name(&growth.leaf),
                ..*growth
            });
            order.push_step(Step {
                removed: &step.removed.iter().map(name).collect::<Vec<_>>(),
                grown: &grown.collect::<Vec<_>>(),
                ..step
            });
        }
        order
    }
}

/// What takes the place of a leaf, if anything does.
fn coarser_leaf(foliage: &Foliage, leaf: LeafId, at_most: usize) -> Option<NewLeaf> {
    let triangles = foliage.triangles_of(leaf);
    if triangles.len() <= at_most {
        return None;
    }
    let kept = collapsed(triangles, at_most)?;
    let position = |corner: u32| triangles[corner as usize / 3].corners[corner as usize % 3];
    let mut left = Foliage::default();
    let plain = |t: &[u32; 3]| LeafTriangle::plain(t.map(position));
    let plain: Vec<LeafTriangle> = kept.iter().map(plain).collect();
    let left = left
        .push_leaf(&plain, None)
        .ok()
        .map(|id| left.leaf(id).clone())?;
    let (before, after) = (foliage.leaf(leaf), left);
    let linear_scale = (before.area() / after.area()).sqrt();
    if !(linear_scale.is_finite() && linear_scale > 0.0) {
        return None;
    }
    let linear_scale = linear_scale.min(MOST_LINEAR_SCALE);
    let placed = |corner: u32| NewCorner {
        place: Place::At(before.centre() + linear_scale * (position(corner) - after.centre())),
        like: corner,
    };
    Some(NewLeaf {
        donor: leaf,
        triangles: kept.iter().map(|t| t.map(placed)).collect(),
    })
}

/// How many more triangles than asked for are tried where collapses leave none.
const TRIES: usize = 4;

/// The corners, numbered as in [`secateur_model::CornerRef`], of the triangles that
/// collapses leave; nothing if they leave none, or all.
fn collapsed(triangles: &[LeafTriangle], at_most: usize) -> Option<Vec<[u32; 3]>> {
    let mesh = Mesh::of(triangles)?;
    let counts = at_most..triangles.len().min(at_most + TRIES);
    let mut left = counts.map(|count| mesh.collapsed(count));
    let kept = left.find(|kept| !kept.is_empty())?;
    (kept.len() < triangles.len()).then(|| mesh.corners_of(triangles, &kept))
}

/// A leaf by its vertices: corners at one place of one texture coordinate.
struct Mesh {
    /// Relative to the first corner, the furthest at 1.
    positions: Vec<[f32; 3]>,
    /// Vertices by corner.
    indices: Vec<u32>,
}

impl Mesh {
    /// Nothing of a leaf that is a point.
    fn of(triangles: &[LeafTriangle]) -> Option<Self> {
        let corners = || triangles.iter().flat_map(|t| t.corners);
        let origin = triangles[0].corners[0];
        let size = corners()
            .map(|corner| (corner - origin).length())
            .fold(0.0, f64::max);
        let mut positions: Vec<[f32; 3]> = Vec::new();
        let mut known: FxHashMap<[u64; 5], u32> = FxHashMap::default();
        let uvs = triangles.iter().flat_map(|t| t.uvs);
        let vertex = |(position, uv): (DVec3, DVec2)| {
            let DVec3 { x, y, z } = position;
            let key = [x, y, z, uv.x, uv.y].map(|v| (v + 0.0).to_bits());
            *known.entry(key).or_insert_with(|| {
                positions.push(((position - origin) / size).as_vec3().to_array());
                positions.len() as u32 - 1
            })
        };
        let indices = corners().zip(uvs).map(vertex).collect();
        let is_sound = positions.as_flattened().iter().all(|x| x.is_finite());
        is_sound.then_some(Self { positions, indices })
    }

    /// Triangles, as vertices, that collapses to this number leave.
    fn collapsed(&self, triangles: usize) -> Vec<[u32; 3]> {
        let bytes = ::meshopt::typed_to_bytes(&self.positions);
        let vertices = VertexDataAdapter::new(bytes, size_of::<[f32; 3]>(), 0)
            .expect("positions are whole vectors");
        let (count, options) = (3 * triangles, SimplifyOptions::None);
        let kept = ::meshopt::simplify(&self.indices, &vertices, count, f32::MAX, options, None);
        kept.as_chunks().0.to_vec()
    }

    /// For each vertex of each triangle that is left a corner of the leaf: of those at
    /// that vertex, the one whose own triangle faces the most like it, so that fronts
    /// do not get the normals of backs.
    fn corners_of(&self, triangles: &[LeafTriangle], kept: &[[u32; 3]]) -> Vec<[u32; 3]> {
        let mut corners_at: Vec<Vec<u32>> = vec![Vec::new(); self.positions.len()];
        for (vertex, corner) in self.indices.iter().zip(0..) {
            corners_at[*vertex as usize].push(corner);
        }
        let position = |corner: u32| triangles[corner as usize / 3].corners[corner as usize % 3];
        let normal = |[a, b, c]: [DVec3; 3]| (b - a).cross(c - a).normalize_or_zero();
        let of_triangle = |t: &[u32; 3]| {
            let facing = normal(t.map(|vertex| position(corners_at[vertex as usize][0])));
            t.map(|vertex| {
                let mut best = (f64::NEG_INFINITY, 0);
                for &corner in &corners_at[vertex as usize] {
                    let likeness = facing.dot(normal(triangles[corner as usize / 3].corners));
                    if likeness > best.0 {
                        best = (likeness, corner);
                    }
                }
                best.1
            })
        };
        kept.iter().map(of_triangle).collect()
    }
}

#[cfg(test)]
mod tests;
