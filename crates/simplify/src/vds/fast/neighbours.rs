//! The nearest leaves that are left.

use rstar::{AABB, PointDistance, RTree, RTreeObject};
use secateur_model::{Foliage, LeafId, Lod};

/// A leaf by its centre in world space.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Site {
    centre: [f64; 3],
    leaf: LeafId,
}

impl RTreeObject for Site {
    type Envelope = AABB<[f64; 3]>;

    fn envelope(&self) -> Self::Envelope {
        AABB::from_point(self.centre)
    }
}

impl PointDistance for Site {
    fn distance_2(&self, point: &[f64; 3]) -> f64 {
        let [x, y, z] = std::array::from_fn(|k| self.centre[k] - point[k]);
        x * x + y * y + z * z
    }
}

pub(super) struct Neighbours {
    tree: RTree<Site>,
    /// By leaf number: whether it is gone. Those that are stay in the tree until
    /// they are as many as the others.
    is_gone: Vec<bool>,
    gone: usize,
}

impl Neighbours {
    pub(super) fn new(foliage: &Foliage, lod: &Lod) -> Self {
        let site = |(leaf, _)| site(foliage, leaf);
        Self {
            tree: RTree::bulk_load(lod.leaves().map(site).collect()),
            is_gone: vec![false; foliage.leaves().len() + 1],
            gone: 0,
        }
    }

    /// Takes a leaf away that is there.
    pub(super) fn remove(&mut self, leaf: LeafId) {
        self.is_gone[leaf.get() as usize] = true;
        self.gone += 1;
        if 2 * self.gone > self.tree.size() {
            let left = self.tree.iter().filter(|site| self.is_left(site));
            self.tree = RTree::bulk_load(left.copied().collect());
            self.gone = 0;
        }
    }

    fn is_left(&self, site: &Site) -> bool {
        !self.is_gone[site.leaf.get() as usize]
    }

    /// The `count` leaves nearest to where `leaf` is or was, nearest first, at
    /// equal distance the lowest number first.
    pub(super) fn nearest(&self, foliage: &Foliage, leaf: LeafId, count: usize) -> Vec<LeafId> {
        let point = foliage.leaf(leaf).centre().to_array();
        let mut found: Vec<(f64, LeafId)> = Vec::with_capacity(count + 1);
        for (other, distance) in self.tree.nearest_neighbor_iter_with_distance_2(point) {
            if found.len() >= count && distance > found[count - 1].0 {
                break;
            }
            if self.is_left(other) {
                found.push((distance, other.leaf));
            }
        }
        found.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        found.truncate(count);
        found.into_iter().map(|(_, leaf)| leaf).collect()
    }
}

fn site(foliage: &Foliage, leaf: LeafId) -> Site {
    Site {
        centre: foliage.leaf(leaf).centre().to_array(),
        leaf,
    }
}
