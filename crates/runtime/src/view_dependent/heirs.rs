//! Which leaf takes the place of one that goes without another growing for it: the nearest.

use glam::DVec3;
use rstar::RTree;
use rstar::primitives::GeomWithData;
use secateur_model::{Foliage, Heirs, LeafId, RemovalOrder};

type Site = GeomWithData<[f64; 3], LeafId>;

/// The leaves that are there, by their centres.
pub(super) struct Nearest {
    tree: RTree<Site>,
    /// By names, of made leaves too.
    centres: Vec<DVec3>,
}

impl Nearest {
    pub(super) fn new(order: &RemovalOrder, foliage: &Foliage) -> Self {
        let mut centres: Vec<DVec3> = foliage.leaves().iter().map(|l| l.centre()).collect();
        let originals = (0..).map(LeafId::from_index).zip(&centres);
        let sites = originals.map(|(leaf, centre)| Site::new(centre.to_array(), leaf));
        let tree = RTree::bulk_load(sites.collect());
        centres.extend(order.made().iter().map(|made| {
            let triangles = made.triangles_in(foliage, 1.0);
            let corners = triangles.iter().flat_map(|t| t.corners);
            corners.sum::<DVec3>() / (3 * triangles.len()) as f64
        }));
        Self { tree, centres }
    }

    fn site(&self, leaf: LeafId) -> Site {
        Site::new(self.centres[leaf.index()].to_array(), leaf)
    }
}

impl Heirs for Nearest {
    fn take(&mut self, leaf: LeafId) {
        let site = self.site(leaf);
        self.tree.remove(&site);
    }

    fn add(&mut self, leaf: LeafId) {
        let site = self.site(leaf);
        self.tree.insert(site);
    }

    /// Of several as near the one of the lowest name.
    fn heir_of(&mut self, leaf: LeafId) -> Option<LeafId> {
        let at = self.centres[leaf.index()].to_array();
        let mut near = self.tree.nearest_neighbor_iter_with_distance_2(at);
        let (first, least) = near.next()?;
        let as_near = near.take_while(|(_, distance_2)| *distance_2 <= least);
        as_near.map(|(site, _)| site.data).chain([first.data]).min()
    }
}
