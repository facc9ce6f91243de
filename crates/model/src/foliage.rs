//! The leaves of a plant in world space.

use std::borrow::Cow;
use std::ops::Range;
use std::sync::Arc;

use glam::{DVec2, DVec3};
use sha2::{Digest, Sha256};

use crate::{Cutout, LeafId};

/// One triangle of a leaf: corners in world space and their texture
/// coordinates (after any texture transform).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LeafTriangle {
    /// World-space corners. Leaves are two-sided: winding does not matter.
    pub corners: [DVec3; 3],
    /// Texture coordinates of the corners, v downwards as in glTF.
    pub uvs: [DVec2; 3],
}

impl LeafTriangle {
    /// A triangle without texture.
    pub fn plain(corners: [DVec3; 3]) -> Self {
        Self {
            corners,
            uvs: [DVec2::ZERO; 3],
        }
    }

    fn area(&self) -> f64 {
        let [a, b, c] = self.corners;
        0.5 * (b - a).cross(c - a).length()
    }
}

/// A leaf: the triangles that are removed or scaled as one.
#[derive(Clone, Debug, PartialEq)]
pub struct Leaf {
    triangles: Range<u32>,
    cutout: Option<u32>,
    facing: Facing,
    shape: Option<u32>,
    centre: DVec3,
    area: f64,
}

impl Leaf {
    /// The index of its alpha mask in [`Foliage::cutouts`], if it has one.
    pub fn cutout(&self) -> Option<u32> {
        self.cutout
    }

    /// From which side its triangles are seen.
    pub fn facing(&self) -> Facing {
        self.facing
    }

    /// The number of the mesh of which it is an instance, where it is all of that mesh: leaves of one number have one
    /// shape, and should keep one.
    pub fn shape(&self) -> Option<u32> {
        self.shape
    }

    /// Its centre in world space: the centroid of its area, or the mean of its
    /// corners where it has none. A resized leaf is scaled about this point.
    pub fn centre(&self) -> DVec3 {
        self.centre
    }

    /// Its surface in squared world units, one side, cut-outs not subtracted.
    pub fn area(&self) -> f64 {
        self.area
    }
}

/// From which side the triangles of a leaf are seen.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Facing {
    /// From both sides, as a glTF material with `doubleSided` has it.
    #[default]
    Both,
    /// From the side on which their corners run counterclockwise.
    Counterclockwise,
    /// From the side on which their corners run clockwise: those of a mirrored node.
    Clockwise,
}

/// A sphere in world space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BoundingSphere {
    /// World-space centre.
    pub centre: DVec3,
    /// Radius in world units.
    pub radius: f64,
}

/// Why a set of triangles is no foliage.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum FoliageError {
    /// A corner or texture coordinate is NaN or infinite.
    #[error("{0} has a corner that is not a finite number")]
    NotFinite(LeafId),
    /// A leaf without triangles.
    #[error("{0} has no triangle")]
    NoTriangle(LeafId),
    /// A leaf names a cut-out that does not exist.
    #[error("{leaf} uses cut-out {cutout}, of {count}")]
    NoSuchCutout {
        /// The leaf that names it.
        leaf: LeafId,
        /// The cut-out it names.
        cutout: u32,
        /// How many there are.
        count: usize,
    },
    /// More leaves or triangles than 32-bit numbers can name.
    #[error("the foliage has more than {max} triangles")]
    TooLarge {
        /// The largest number of triangles.
        max: u32,
    },
}

/// All leaves of a plant, in world space, in file order. May be empty.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Foliage {
    triangles: Vec<LeafTriangle>,
    leaves: Vec<Leaf>,
    cutouts: Vec<Arc<Cutout>>,
}

impl<'a> From<&'a Foliage> for Cow<'a, Foliage> {
    fn from(foliage: &'a Foliage) -> Self {
        Cow::Borrowed(foliage)
    }
}

impl From<Foliage> for Cow<'_, Foliage> {
    fn from(foliage: Foliage) -> Self {
        Cow::Owned(foliage)
    }
}

impl Foliage {
    /// The most triangles a foliage can hold.
    pub const MAX_TRIANGLES: u32 = 1 << 28;

    /// A foliage without leaves, whose leaves may use these cut-outs.
    pub fn new(cutouts: Vec<Arc<Cutout>>) -> Self {
        Self {
            cutouts,
            ..Self::default()
        }
    }

    /// Adds a leaf that is seen from both sides, and returns its name.
    ///
    /// # Errors
    /// As [`Self::push_leaf_facing`].
    pub fn push_leaf(
        &mut self,
        triangles: &[LeafTriangle],
        cutout: Option<u32>,
    ) -> Result<LeafId, FoliageError> {
        self.push_leaf_facing(triangles, cutout, Facing::Both)
    }

    /// Adds a leaf with the cut-out, facing and shape of another, which may be one of another foliage
    /// with the same cut-outs, and returns its name.
    ///
    /// # Errors
    /// As [`Self::push_leaf_facing`].
    pub fn push_leaf_like(
        &mut self,
        triangles: &[LeafTriangle],
        like: &Leaf,
    ) -> Result<LeafId, FoliageError> {
        let id = self.push_leaf_facing(triangles, like.cutout, like.facing)?;
        self.leaves[id.index()].shape = like.shape;
        Ok(id)
    }

    /// Adds a leaf and returns its name.
    ///
    /// # Errors
    /// [`FoliageError`] if it has no triangle, a number that is not finite, or
    /// an unknown cut-out; the foliage is then unchanged.
    pub fn push_leaf_facing(
        &mut self,
        triangles: &[LeafTriangle],
        cutout: Option<u32>,
        facing: Facing,
    ) -> Result<LeafId, FoliageError> {
        let id = LeafId::from_index(self.leaves.len());
        if triangles.is_empty() {
            return Err(FoliageError::NoTriangle(id));
        }
        let finite = |t: &LeafTriangle| {
            t.corners.iter().all(|p| p.is_finite()) && t.uvs.iter().all(|p| p.is_finite())
        };
        if !triangles.iter().all(finite) {
            return Err(FoliageError::NotFinite(id));
        }
        if let Some(cutout) = cutout.filter(|&c| c as usize >= self.cutouts.len()) {
            return Err(FoliageError::NoSuchCutout {
                leaf: id,
                cutout,
                count: self.cutouts.len(),
            });
        }
        if self.triangles.len() + triangles.len() > Self::MAX_TRIANGLES as usize {
            return Err(FoliageError::TooLarge {
                max: Self::MAX_TRIANGLES,
            });
        }
        let start = self.triangles.len() as u32;
        self.triangles.extend_from_slice(triangles);
        let (centre, area) = centroid_and_area(triangles);
        self.leaves.push(Leaf {
            triangles: start..self.triangles.len() as u32,
            cutout,
            facing,
            shape: None,
            centre,
            area,
        });
        Ok(id)
    }

    /// Says of which mesh a leaf is an instance, see [`Leaf::shape`].
    ///
    /// # Panics
    /// If there is no such leaf.
    pub fn set_shape(&mut self, id: LeafId, shape: u32) {
        self.leaves[id.index()].shape = Some(shape);
    }

    /// These leaves and then those of another foliage, with their cut-outs.
    ///
    /// # Errors
    /// [`FoliageError::TooLarge`] if there are too many.
    pub fn followed_by(&self, other: &Self) -> Result<Self, FoliageError> {
        let mut joined = self.clone();
        joined.cutouts.extend(other.cutouts.iter().cloned());
        let cutouts_before = self.cutouts.len() as u32;
        for (index, leaf) in other.leaves.iter().enumerate() {
            let triangles = other.triangles_of(LeafId::from_index(index));
            let cutout = leaf.cutout.map(|c| cutouts_before + c);
            let id = joined.push_leaf_facing(triangles, cutout, leaf.facing)?;
            joined.leaves[id.index()].shape = leaf.shape;
        }
        Ok(joined)
    }

    /// The leaves of these names alone, in the order of the names.
    ///
    /// # Panics
    /// If there is no leaf of one of these names.
    pub fn only(&self, names: &[LeafId]) -> Self {
        let mut only = Self::new(self.cutouts.clone());
        for &name in names {
            let pushed = only.push_leaf_like(self.triangles_of(name), self.leaf(name));
            pushed.expect("a leaf of the foliage");
        }
        only
    }

    /// The leaves, leaf 1 first.
    pub fn leaves(&self) -> &[Leaf] {
        &self.leaves
    }

    /// The leaf with this ID.
    ///
    /// # Panics
    /// If there is no such leaf.
    pub fn leaf(&self, id: LeafId) -> &Leaf {
        &self.leaves[id.index()]
    }

    /// The triangles of one leaf, at its original size.
    ///
    /// # Panics
    /// If there is no such leaf.
    pub fn triangles_of(&self, id: LeafId) -> &[LeafTriangle] {
        let range = &self.leaf(id).triangles;
        &self.triangles[range.start as usize..range.end as usize]
    }

    /// The triangles of all leaves, in leaf order.
    pub fn triangles(&self) -> &[LeafTriangle] {
        &self.triangles
    }

    /// The alpha masks that leaves refer to.
    pub fn cutouts(&self) -> &[Arc<Cutout>] {
        &self.cutouts
    }

    /// These leaves as solid polygons (`--alpha ignore`).
    pub fn without_cutouts(&self) -> Self {
        let mut plain = self.clone();
        plain.cutouts.clear();
        for leaf in &mut plain.leaves {
            leaf.cutout = None;
        }
        plain
    }

    /// These leaves, all seen from both sides (`--sides both`).
    pub fn seen_from_both_sides(&self) -> Self {
        let mut both = self.clone();
        for leaf in &mut both.leaves {
            leaf.facing = Facing::Both;
        }
        both
    }

    /// SHA-256 over the shapes of its leaves: how many triangles each has, and all corners and
    /// texture coordinates as f64 little-endian. Cut-outs do not count.
    pub fn sha256(&self) -> [u8; 32] {
        let mut hash = Sha256::new();
        for leaf in &self.leaves {
            hash.update((leaf.triangles.end - leaf.triangles.start).to_le_bytes());
        }
        for triangle in &self.triangles {
            let mut bytes = [0; 15 * 8];
            let corners = triangle.corners.iter().flat_map(|p| p.to_array());
            let uvs = triangle.uvs.iter().flat_map(|p| p.to_array());
            for (place, number) in bytes
                .as_chunks_mut::<8>()
                .0
                .iter_mut()
                .zip(corners.chain(uvs))
            {
                *place = number.to_le_bytes();
            }
            hash.update(bytes);
        }
        hash.finalize().into()
    }

    /// The sphere about the centre of the foliage's bounding box that holds
    /// every corner, or `None` for an empty foliage. The radius is zero where
    /// all corners coincide.
    pub fn bounding_sphere(&self) -> Option<BoundingSphere> {
        let corners = || self.triangles.iter().flat_map(|t| t.corners);
        let first = corners().next()?;
        let (min, max) = corners().fold((first, first), |(lo, hi), p| (lo.min(p), hi.max(p)));
        let centre = min + 0.5 * (max - min);
        let radius = corners()
            .map(|p| (p - centre).length_squared())
            .fold(0.0, f64::max)
            .sqrt();
        Some(BoundingSphere { centre, radius })
    }
}

/// Triangles grown about a point until they have this multiple of their area.
pub(crate) fn scaled_about(centre: DVec3, area_scale: f64, triangles: &mut [LeafTriangle]) {
    let linear_scale = area_scale.sqrt();
    for corner in triangles.iter_mut().flat_map(|t| &mut t.corners) {
        *corner = centre + (*corner - centre) * linear_scale;
    }
}

/// The centre of these triangles, as [`Leaf::centre`] is that of a leaf's.
///
/// # Panics
/// If there is no triangle.
pub fn centroid_of(triangles: &[LeafTriangle]) -> DVec3 {
    centroid_and_area(triangles).0
}

/// As [`Leaf::centre`] and [`Leaf::area`]; there is a triangle.
pub(crate) fn centroid_and_area(triangles: &[LeafTriangle]) -> (DVec3, f64) {
    let mean = |t: &LeafTriangle| (t.corners[0] + t.corners[1] + t.corners[2]) / 3.0;
    // Relative to a corner, so that a leaf far from the origin keeps its bits.
    let origin = triangles[0].corners[0];
    let mut area = 0.0;
    let mut moment = DVec3::ZERO;
    let mut sum = DVec3::ZERO;
    for triangle in triangles {
        let a = triangle.area();
        area += a;
        moment += a * (mean(triangle) - origin);
        sum += mean(triangle) - origin;
    }
    let offset = if area > 0.0 && (moment / area).is_finite() {
        moment / area
    } else {
        sum / triangles.len() as f64
    };
    (origin + offset, area)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn quad(at: DVec3, side: f64) -> [LeafTriangle; 2] {
        let [a, b, c, d] = [
            at,
            at + DVec3::X * side,
            at + (DVec3::X + DVec3::Y) * side,
            at + DVec3::Y * side,
        ];
        [
            LeafTriangle::plain([a, b, c]),
            LeafTriangle::plain([a, c, d]),
        ]
    }

    #[test]
    fn a_square_has_its_middle_as_centre() {
        let mut foliage = Foliage::default();
        let id = foliage.push_leaf(&quad(DVec3::ZERO, 2.0), None).unwrap();
        assert_eq!(id.get(), 1);
        assert!((foliage.leaf(id).centre() - DVec3::new(1.0, 1.0, 0.0)).length() < 1e-15);
        assert_eq!(foliage.leaf(id).area(), 4.0);
    }

    #[test]
    fn a_point_like_leaf_is_an_ordinary_leaf() {
        let mut foliage = Foliage::default();
        let point = LeafTriangle::plain([DVec3::ONE; 3]);
        let id = foliage.push_leaf(&[point], None).unwrap();
        assert_eq!(foliage.leaf(id).area(), 0.0);
        assert_eq!(foliage.leaf(id).centre(), DVec3::ONE);
        assert_eq!(foliage.bounding_sphere().unwrap().radius, 0.0);
    }

    #[test]
    fn leaves_by_name_come_in_the_order_of_the_names_and_keep_their_shapes() {
        let mut foliage = Foliage::default();
        for side in [1.0, 2.0, 3.0] {
            foliage.push_leaf(&quad(DVec3::ZERO, side), None).unwrap();
        }
        foliage.set_shape(LeafId::from_index(2), 7);
        let only = foliage.only(&[2, 0].map(LeafId::from_index));
        let areas: Vec<f64> = only.leaves().iter().map(Leaf::area).collect();
        assert_eq!(areas, [9.0, 1.0]);
        assert_eq!(only.leaves()[0].shape(), Some(7));
    }

    #[test]
    fn numbers_that_are_not_finite_are_refused() {
        for bad in [f64::NAN, f64::INFINITY] {
            let mut foliage = Foliage::default();
            let triangle = LeafTriangle::plain([DVec3::splat(bad), DVec3::X, DVec3::Y]);
            assert!(matches!(
                foliage.push_leaf(&[triangle], None),
                Err(FoliageError::NotFinite(_))
            ));
            assert!(foliage.leaves().is_empty());
        }
    }
}
