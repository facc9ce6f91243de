//! Where a node of the forest is, with all that it stands for.

use glam::DVec3;
use secateur_model::{Foliage, Forest, LeafId, LodModel};

/// Room for rounding: a sphere holds those within it whatever the last bits are.
const ROOM: f64 = 1.0 + 1e-9;

/// A sphere that holds a node's leaf and all leaves that it stands for, in world space. The region
/// of a result holds the regions of its sources.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Region {
    /// Its centre; of an original leaf the leaf's.
    pub centre: DVec3,
    /// Its radius in world units.
    pub radius: f64,
}

impl Region {
    /// A sphere that holds both.
    fn joined(self, other: Self) -> Self {
        let between = other.centre - self.centre;
        let distance = between.length();
        if distance + other.radius <= self.radius {
            return self;
        }
        if distance + self.radius <= other.radius {
            return other;
        }
        let radius = 0.5 * (distance + self.radius + other.radius);
        Self {
            centre: self.centre + between * ((radius - self.radius) / distance),
            radius: radius * ROOM,
        }
    }

    fn about(centre: DVec3, corners: impl Iterator<Item = DVec3>) -> Self {
        let radius_2 = corners.map(|corner| corner.distance_squared(centre));
        Self {
            centre,
            radius: radius_2.fold(0.0, f64::max).sqrt(),
        }
    }
}

/// The regions of all nodes, in their order.
pub(super) fn regions(forest: &Forest, model: &LodModel, foliage: &Foliage) -> Vec<Region> {
    let own = |leaf: LeafId, area_scale: f64| match leaf.index().checked_sub(forest.leaf_count()) {
        None => {
            let corners = foliage.triangles_of(leaf).iter().flat_map(|t| t.corners);
            let region = Region::about(foliage.leaf(leaf).centre(), corners);
            Region {
                radius: region.radius * area_scale.sqrt(),
                ..region
            }
        }
        Some(made) => {
            let triangles = model.order().made()[made].triangles_in(foliage, area_scale);
            let corners = || triangles.iter().flat_map(|t| t.corners);
            let sum: DVec3 = corners().sum();
            Region::about(sum / (3 * triangles.len()) as f64, corners())
        }
    };
    let mut regions: Vec<Region> = Vec::with_capacity(forest.nodes().len());
    for (index, node) in forest.nodes().iter().enumerate() {
        let of_leaf = node.leaf.map(|leaf| own(leaf, node.area_scale));
        let maker = forest.maker(secateur_model::NodeIndex::from_index(index));
        let sources = maker.map(|maker| forest.sources(maker)).unwrap_or_default();
        let held = sources.iter().map(|source| regions[source.index()]);
        let all = held.chain(of_leaf).reduce(Region::joined);
        regions.push(all.expect("a node has a leaf or sources"));
    }
    regions
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_joined_sphere_holds_both_and_is_no_larger_than_it_must_be() {
        let sphere = |x: f64, radius| Region {
            centre: DVec3::X * x,
            radius,
        };
        let joined = sphere(0.0, 1.0).joined(sphere(4.0, 2.0));
        assert!((joined.radius - 3.5).abs() < 1e-6);
        assert!((joined.centre.x - 2.5).abs() < 1e-6);
        let large = sphere(0.5, 9.0);
        assert_eq!(sphere(0.0, 1.0).joined(large), large);
        assert_eq!(large.joined(sphere(0.0, 1.0)), large);
        let point = sphere(1.0, 0.0);
        assert_eq!(point.joined(point), point);
    }
}
