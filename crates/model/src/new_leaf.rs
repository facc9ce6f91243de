//! Leaves that a method makes out of others.

use glam::DVec3;

use crate::foliage::{centroid_and_area, scaled_about};
use crate::{Foliage, LeafId, LeafTriangle};

/// A corner of an original leaf: `corner % 3` of triangle `corner / 3` of
/// [`Foliage::triangles_of`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct CornerRef {
    /// The leaf, one of the original foliage.
    pub leaf: LeafId,
    /// Which of its corners.
    pub corner: u32,
}

impl CornerRef {
    /// Where it is, in world space.
    ///
    /// # Panics
    /// If there is no such leaf or corner.
    pub fn position(self, foliage: &Foliage) -> DVec3 {
        let triangle = &foliage.triangles_of(self.leaf)[self.corner as usize / 3];
        triangle.corners[self.corner as usize % 3]
    }
}

/// Where a corner of a [`NewLeaf`] is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Place {
    /// At a corner of an original leaf.
    Of(CornerRef),
    /// Anywhere, in world space.
    At(DVec3),
    /// In the plane of three corners of the donor, within their triangle or not. The texture goes
    /// on there: texture coordinates are of the same weights, as are, in files, normals and
    /// displacements of morph targets.
    InPlaneOf {
        /// Numbered as in [`CornerRef`].
        corners: [u32; 3],
        /// Of its corners; together 1, some may be negative.
        weights: [f64; 3],
    },
}

/// A corner of a [`NewLeaf`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NewCorner {
    /// How its position follows from original corners.
    pub place: Place,
    /// The corner of the donor, numbered as in [`CornerRef`], whose texture
    /// coordinates and other attributes it has, but for those of [`Place::InPlaneOf`]. Wood
    /// at [another of its corners](Place::Of) has texture coordinates only, and in files
    /// tangents, of this one, and all else of that one.
    pub like: u32,
}

/// A leaf that takes the place of others. It has the material, the cut-out and
/// the attributes of one original leaf, its donor, and belongs to the donor's
/// part of the file.
#[derive(Clone, Debug, PartialEq)]
pub struct NewLeaf {
    /// The leaf that it looks like, one of the original foliage.
    pub donor: LeafId,
    /// Its triangles, at least one.
    pub triangles: Vec<[NewCorner; 3]>,
}

impl NewLeaf {
    /// Its triangles in world space, with texture coordinates of the donor, grown
    /// about its centre to this multiple of its area.
    ///
    /// # Panics
    /// If it names a leaf or corner that is not there.
    pub fn triangles_in(&self, foliage: &Foliage, area_scale: f64) -> Vec<LeafTriangle> {
        let like = foliage.triangles_of(self.donor);
        let corner = |c: &NewCorner| {
            let uv = like[c.like as usize / 3].uvs[c.like as usize % 3];
            match c.place {
                Place::Of(corner) => (corner.position(foliage), uv),
                Place::At(position) => (position, uv),
                Place::InPlaneOf { corners, weights } => {
                    let at = |corner: u32| {
                        let triangle = &like[corner as usize / 3];
                        let k = corner as usize % 3;
                        (triangle.corners[k], triangle.uvs[k])
                    };
                    let [a, b, c] = weights;
                    let [of_a, of_b, of_c] = corners.map(at);
                    (
                        a * of_a.0 + b * of_b.0 + c * of_c.0,
                        a * of_a.1 + b * of_b.1 + c * of_c.1,
                    )
                }
            }
        };
        let triangle = |t: &[NewCorner; 3]| {
            let [a, b, c] = [corner(&t[0]), corner(&t[1]), corner(&t[2])];
            LeafTriangle {
                corners: [a.0, b.0, c.0],
                uvs: [a.1, b.1, c.1],
            }
        };
        let mut triangles: Vec<LeafTriangle> = self.triangles.iter().map(triangle).collect();
        if area_scale != 1.0 {
            let (centre, _) = centroid_and_area(&triangles);
            scaled_about(centre, area_scale, &mut triangles);
        }
        triangles
    }
}
