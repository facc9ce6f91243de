//! What a LOD does to each leaf: keeps, removes or resizes it, or puts new leaves
//! beside it; and which of the places that draw a mesh are edited alike, so that
//! they can share one.

use std::collections::BTreeMap;

use glam::{DMat3, DMat4, DVec3};
use rustc_hash::FxHashMap;

use super::references::len;
use super::vertices::Resize;
use crate::tree::Tree;
use secateur_model::{LeafId, Lod, NewCorner, NewLeaf, Place, centroid_of};

/// What a LOD does to one leaf of a part.
#[derive(Clone, Copy, Debug)]
pub(super) struct LeafEdit<'t> {
    pub(super) leaf: LeafId,
    /// Numbers in the triangle list of the part's primitive.
    pub(super) triangles: &'t [u32],
    /// Its new area as a multiple of the old one, or `None` if the leaf goes.
    pub(super) area_scale: Option<f64>,
}

impl LeafEdit<'_> {
    fn is_unchanged(&self) -> bool {
        self.area_scale == Some(1.0)
    }
}

/// The edits of all leaves, by the part that a leaf belongs to.
pub(super) struct LeafEdits<'t> {
    tree: &'t Tree,
    lod: &'t Lod,
    /// Leaf indices, those of part p at `starts[p]..starts[p + 1]`.
    leaves: Vec<u32>,
    starts: Vec<u32>,
    /// New leaves by the part of their donor, with their area scales.
    made: FxHashMap<usize, Vec<(&'t NewLeaf, f64)>>,
}

/// A corner of a new leaf in its part's primitive.
#[derive(Clone, Copy, Debug)]
pub(super) struct MadeCorner {
    /// A triangle of the primitive's list and which of its corners: the vertex
    /// to be copied.
    pub(super) like: (u32, usize),
    /// The vertex whose normal, colours, bones and morph displacements the copy has, where wood has
    /// texture coordinates of another one.
    pub(super) surface_of: Option<(u32, usize)>,
    /// Where the copy goes, in the primitive's local space.
    pub(super) position_local: DVec3,
    /// What the copy's texture coordinates, normal and morph displacements are, where they are
    /// not the vertex's.
    pub(super) blend: Option<Blend>,
}

/// A sum of three vertices, by weights.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Blend {
    /// Triangles of the primitive's list, and which corner of each.
    pub(super) corners: [(u32, usize); 3],
    pub(super) weights: [f64; 3],
}

impl<'t> LeafEdits<'t> {
    pub(super) fn new(tree: &'t Tree, lod: &'t Lod) -> Self {
        let mut starts = vec![0u32; tree.parts.len() + 1];
        for source in &tree.leaf_sources {
            starts[source.part as usize + 1] += 1;
        }
        for part in 0..tree.parts.len() {
            starts[part + 1] += starts[part];
        }
        let mut next = starts.clone();
        let mut leaves = vec![0; tree.leaf_sources.len()];
        for (leaf, source) in tree.leaf_sources.iter().enumerate() {
            let slot = &mut next[source.part as usize];
            leaves[*slot as usize] = leaf as u32;
            *slot += 1;
        }
        let mut made: FxHashMap<usize, Vec<(&NewLeaf, f64)>> = FxHashMap::default();
        for (leaf, area_scale) in lod.made() {
            let part = tree.leaf_sources[leaf.donor.index()].part as usize;
            made.entry(part).or_default().push((leaf, area_scale));
        }
        Self {
            tree,
            lod,
            leaves,
            starts,
            made,
        }
    }

    /// The one new leaf that is all of an instance from now on, with its area scale: instances with it are scaled.
    pub(super) fn only_made(&self, place: &Use) -> Option<(&'t NewLeaf, f64)> {
        let ([part], Some(_)) = (&place.parts[..], place.instance) else {
            return None;
        };
        let [only] = self.made.get(part)?[..] else {
            return None;
        };
        let is_gone = |edit: LeafEdit| edit.area_scale.is_none();
        let (mesh, primitive) = (
            self.tree.parts[*part].mesh,
            self.tree.parts[*part].primitive,
        );
        let of_leaves: usize = self.of_part(*part).map(|edit| edit.triangles.len()).sum();
        let document = &self.tree.document;
        let is_whole = len(&document.root["meshes"][mesh], "primitives") == 1
            && document.triangles(mesh, primitive).ok()?.len() == of_leaves;
        (is_whole && self.of_part(*part).all(is_gone)).then_some(only)
    }

    /// By how much an instance that has one new leaf is scaled beside another with the same.
    pub(super) fn scale_beside(&self, first: &Use, other: &Use) -> Option<Resize> {
        let ((_, of_first), (leaf, scale)) = (self.only_made(first)?, self.only_made(other)?);
        if of_first == scale {
            return None;
        }
        let placed = leaf.triangles_in(&self.tree.foliage, scale);
        let centre_world = centroid_of(&placed);
        let world_from_local = &self.tree.parts[other.parts[0]].world_from_local;
        Some(Resize {
            centre_local: origin_of_point(world_from_local, centre_world),
            linear_scale: (scale / of_first).sqrt(),
        })
    }

    /// The triangles of new leaves that belong to a part, at the sizes at which they were made.
    fn made_as_designed(&self, part: usize) -> Vec<[MadeCorner; 3]> {
        self.made_at(part, |_| 1.0)
    }

    /// The triangles of new leaves that belong to a part.
    pub(super) fn made_in(&self, part: usize) -> Vec<[MadeCorner; 3]> {
        self.made_at(part, |area_scale| area_scale)
    }

    fn made_at(&self, part: usize, size: impl Fn(f64) -> f64) -> Vec<[MadeCorner; 3]> {
        let world_from_local = &self.tree.parts[part].world_from_local;
        let corner = |donor: LeafId, corner: &NewCorner, position_world: DVec3| {
            let source = &self.tree.leaf_sources[donor.index()];
            let triangles = self.tree.triangles_of(source);
            let in_list = |corner: u32| (triangles[corner as usize / 3], corner as usize % 3);
            let blend = match corner.place {
                Place::InPlaneOf { corners, weights } => Some(Blend {
                    corners: corners.map(in_list),
                    weights,
                }),
                Place::Of(_) | Place::At(_) => None,
            };
            let is_wood = donor >= self.tree.first_of_wood;
            let surface_of = match corner.place {
                Place::Of(at) if is_wood && at.leaf == donor && at.corner != corner.like => {
                    Some(at.corner)
                }
                Place::Of(_) | Place::At(_) | Place::InPlaneOf { .. } => None,
            };
            MadeCorner {
                like: in_list(corner.like),
                surface_of: surface_of.map(in_list),
                position_local: origin_of_point(world_from_local, position_world),
                blend,
            }
        };
        let mut triangles = Vec::new();
        for &(leaf, area_scale) in self.made.get(&part).into_iter().flatten() {
            let placed = leaf.triangles_in(&self.tree.foliage, size(area_scale));
            triangles.extend(leaf.triangles.iter().zip(placed).map(|(t, placed)| {
                [0, 1, 2].map(|k| corner(leaf.donor, &t[k], placed.corners[k]))
            }));
        }
        triangles
    }

    /// The leaves of a part, in leaf order.
    pub(super) fn of_part(&self, part: usize) -> impl Iterator<Item = LeafEdit<'t>> + '_ {
        let range = self.starts[part] as usize..self.starts[part + 1] as usize;
        self.leaves[range].iter().map(|&index| {
            let leaf = LeafId::from_index(index as usize);
            LeafEdit {
                leaf,
                triangles: self
                    .tree
                    .triangles_of(&self.tree.leaf_sources[index as usize]),
                area_scale: self.lod.area_scale(leaf),
            }
        })
    }

    /// Whether a leaf of the part goes or changes size, or one is new.
    pub(super) fn is_changed(&self, part: usize) -> bool {
        self.has_made(part) || self.of_part(part).any(|edit| !edit.is_unchanged())
    }

    /// Whether a new leaf belongs to the part.
    pub(super) fn has_made(&self, part: usize) -> bool {
        self.made.contains_key(&part)
    }

    /// The resize of a leaf of a part, in the space of the part's primitive, or
    /// `None` if its size stays.
    pub(super) fn resize(&self, part: usize, edit: &LeafEdit) -> Option<Resize> {
        let area_scale = edit.area_scale.filter(|&scale| scale != 1.0)?;
        let centre_world = self.tree.foliage.leaf(edit.leaf).centre();
        let world_from_local = &self.tree.parts[part].world_from_local;
        Some(Resize {
            centre_local: origin_of_point(world_from_local, centre_world),
            linear_scale: area_scale.sqrt(),
        })
    }
}

/// A local point that a transform takes to `point_world`; where the transform
/// flattens space and there are many, about the one nearest to the origin.
fn origin_of_point(world_from_local: &DMat4, point_world: DVec3) -> DVec3 {
    let exact = world_from_local.inverse().transform_point3(point_world);
    if exact.is_finite() {
        return exact;
    }
    // Least squares, with a weight on the length too small to be seen.
    let linear = DMat3::from_mat4(*world_from_local);
    let square = linear.transpose() * linear;
    let weight = 1e-12 * (square.x_axis.x + square.y_axis.y + square.z_axis.z);
    let offset = point_world - world_from_local.w_axis.truncate();
    let nearest = (square + weight * DMat3::IDENTITY).inverse() * (linear.transpose() * offset);
    if nearest.is_finite() {
        nearest
    } else {
        DVec3::ZERO
    }
}

/// One place where a mesh is drawn: a node, or one instance of it.
#[derive(Clone, Debug)]
pub(super) struct Use {
    pub(super) node: usize,
    pub(super) instance: Option<usize>,
    /// The parts of this place that hold leaves.
    pub(super) parts: Vec<usize>,
}

/// The places where each mesh is drawn, by mesh; those in file order.
pub(super) fn uses_by_mesh(tree: &Tree) -> BTreeMap<usize, Vec<Use>> {
    let mut holds_leaves = vec![false; tree.parts.len()];
    for source in &tree.leaf_sources {
        holds_leaves[source.part as usize] = true;
    }
    let mut places: BTreeMap<(usize, usize, Option<usize>), Vec<usize>> = BTreeMap::new();
    for (number, part) in tree.parts.iter().enumerate() {
        let place = places
            .entry((part.mesh, part.node, part.instance))
            .or_default();
        if holds_leaves[number] {
            place.push(number);
        }
    }
    let mut uses: BTreeMap<usize, Vec<Use>> = BTreeMap::new();
    for ((mesh, node, instance), parts) in places {
        uses.entry(mesh).or_default().push(Use {
            node,
            instance,
            parts,
        });
    }
    uses
}

/// Leaves that change: their primitive, triangles and area scale (its bits, or
/// `None` where they go).
type Changes<'t> = Vec<(usize, &'t [u32], Option<u64>)>;

/// New leaves: their primitive, area scale (its bits) and the vertices that they copy.
type MadeLeaves = Vec<(usize, u64, Vec<(u32, usize)>)>;

/// Of places that change alike, with how many it is tried to share a mesh.
const MOST_TRIED: usize = 64;

/// Sorts the places of a mesh into groups whose leaves are edited alike, so
/// that one mesh serves each group. Groups come in the order of their first
/// place and hold numbers of `places`.
pub(super) fn group_by_edits(tree: &Tree, edits: &LeafEdits, places: &[&Use]) -> Vec<Vec<usize>> {
    let mut groups: Vec<Vec<usize>> = Vec::new();
    let mut known: FxHashMap<(Changes, MadeLeaves), Vec<usize>> = FxHashMap::default();
    for (number, place) in places.iter().enumerate() {
        let key = (changes(tree, edits, place), made(tree, edits, place));
        let alike = known.entry(key).or_default();
        let same = alike.iter().copied().take(MOST_TRIED).find(|&group| {
            let first = places[groups[group][0]];
            scale_alike(tree, edits, first, place) && are_made_alike(edits, first, place)
        });
        match same {
            Some(group) => groups[group].push(number),
            None => {
                alike.push(groups.len());
                groups.push(vec![number]);
            }
        }
    }
    groups
}

fn changes<'t>(tree: &Tree, edits: &LeafEdits<'t>, place: &Use) -> Changes<'t> {
    let mut changes = Changes::new();
    for &part in &place.parts {
        let changed = edits.of_part(part).filter(|edit| !edit.is_unchanged());
        changes.extend(changed.map(|edit| {
            let scale = edit.area_scale.map(f64::to_bits);
            (tree.parts[part].primitive, edit.triangles, scale)
        }));
    }
    changes
}

fn made(tree: &Tree, edits: &LeafEdits, place: &Use) -> MadeLeaves {
    let mut made = MadeLeaves::new();
    let is_scaled_as_whole = edits.only_made(place).is_some();
    for &part in &place.parts {
        for &(leaf, area_scale) in edits.made.get(&part).into_iter().flatten() {
            let triangles = tree.triangles_of(&tree.leaf_sources[leaf.donor.index()]);
            let vertex = |c: &NewCorner| (triangles[c.like as usize / 3], c.like as usize % 3);
            let corners = leaf.triangles.iter().flatten().map(vertex).collect();
            let area_scale = if is_scaled_as_whole { 1.0 } else { area_scale };
            made.push((tree.parts[part].primitive, area_scale.to_bits(), corners));
        }
    }
    made
}

/// Whether the new leaves of two places that copy the same vertices are at the same
/// place in the space of their primitive.
fn are_made_alike(edits: &LeafEdits, first: &Use, other: &Use) -> bool {
    const TOLERANCE: f64 = 1e-5;
    first.parts.iter().zip(&other.parts).all(|(&a, &b)| {
        let [made_in_a, made_in_b] = match (edits.only_made(first), edits.only_made(other)) {
            (Some(_), Some(_)) => [a, b].map(|part| edits.made_as_designed(part)),
            (_, _) => [a, b].map(|part| edits.made_in(part)),
        };
        let pairs = made_in_a.into_iter().zip(made_in_b);
        let places = |t: [MadeCorner; 3]| t.map(|corner| corner.position_local);
        pairs.map(|(a, b)| (places(a), places(b))).all(|(a, b)| {
            let size = a[0].distance(a[1]) + a[0].distance(a[2]);
            (0..3).all(|k| a[k].distance(b[k]) <= TOLERANCE * size)
        })
    })
}

/// Whether the resized leaves of one place, scaled as those of another of the
/// same changes, still have their own centres. Where a transform is not
/// uniform, the centre of a bent leaf depends on it.
fn scale_alike(tree: &Tree, edits: &LeafEdits, first: &Use, other: &Use) -> bool {
    const TOLERANCE: f64 = 1e-5;
    first.parts.iter().zip(&other.parts).all(|(&a, &b)| {
        edits
            .of_part(a)
            .zip(edits.of_part(b))
            .all(|(edit_a, edit_b)| {
                let Some(resize) = edits.resize(a, &edit_a) else {
                    return true;
                };
                let leaf = tree.foliage.leaf(edit_b.leaf);
                let world_from_local = tree.parts[b].world_from_local;
                let centre: DVec3 = world_from_local.transform_point3(resize.centre_local);
                centre.distance(leaf.centre()) <= TOLERANCE * leaf.area().sqrt()
            })
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_flat_transform_still_has_origins() {
        // The z axis is lost; x is doubled, y kept, all moved by (5, 6, 7).
        let flat = DMat4::from_translation(DVec3::new(5.0, 6.0, 7.0))
            * DMat4::from_scale(DVec3::new(2.0, 1.0, 0.0));
        let local = origin_of_point(&flat, DVec3::new(7.0, 9.0, 7.0));
        assert!(local.distance(DVec3::new(1.0, 3.0, 0.0)) < 1e-9);
        assert_eq!(origin_of_point(&DMat4::ZERO, DVec3::ONE), DVec3::ZERO);
    }
}
