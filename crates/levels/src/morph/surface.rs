//! The nearest place of many triangles.

use glam::DVec3;
use rstar::{AABB, PointDistance, RTree, RTreeObject};
use secateur_simplify::wood::nearest;

use super::Form;

/// A triangle of a form, before it was scaled.
#[derive(Clone, Debug)]
struct Face {
    corners: [DVec3; 3],
    /// The form's place among those of the surface.
    form: usize,
    /// Its own among all triangles of the surface.
    number: usize,
}

impl RTreeObject for Face {
    type Envelope = AABB<[f64; 3]>;

    fn envelope(&self) -> Self::Envelope {
        AABB::from_points(&self.corners.map(|corner| corner.to_array()))
    }
}

impl PointDistance for Face {
    fn distance_2(&self, point: &[f64; 3]) -> f64 {
        let point = DVec3::from_array(*point);
        nearest(self.corners, point).point.distance_squared(point)
    }
}

/// The triangles of several forms, before they were scaled.
pub(super) struct Surface(RTree<Face>);

/// A place of a surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Found {
    pub(super) point: DVec3,
    /// The place of its form among those that the surface was made of.
    pub(super) form: usize,
    /// The number of its triangle among all of the surface.
    pub(super) triangle: usize,
    /// How far it is off, in world units.
    pub(super) distance: f64,
}

impl Surface {
    pub(super) fn of<'a>(forms: impl Iterator<Item = &'a Form<'a>>) -> Self {
        let triangles = forms.enumerate().flat_map(|(form, of)| {
            let triangles = of.triangles.iter();
            triangles.map(move |t| (form, t.corners))
        });
        let face = |(number, (form, corners))| Face {
            corners,
            form,
            number,
        };
        Self(RTree::bulk_load(triangles.enumerate().map(face).collect()))
    }

    /// None of a surface without triangles.
    pub(super) fn nearest(&self, point: DVec3) -> Option<Found> {
        let face = self.0.nearest_neighbor(point.to_array())?;
        let found = nearest(face.corners, point).point;
        Some(Found {
            point: found,
            form: face.form,
            triangle: face.number,
            distance: found.distance(point),
        })
    }
}
