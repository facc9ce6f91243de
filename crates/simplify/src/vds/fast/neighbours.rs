//! The nearest leaves that are left: those that grow into a gap.
//!
//! One query a step, on the one core that leads: a k-d tree from which leaves
//! go is several times faster here than a tree that also takes new ones.

use secateur_model::{Foliage, LeafId, Lod};

/// Leaves of a bucket when the tree is made, at most.
const BUCKET: usize = 8;

/// A leaf by its centre in world space.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Site {
    centre: [f64; 3],
    leaf: LeafId,
}

pub(super) struct Neighbours {
    tree: KdTree,
    /// By leaf number: the bucket of those that are left.
    bucket_of: Vec<u32>,
    left: usize,
}

impl Neighbours {
    pub(super) fn new(foliage: &Foliage, lod: &Lod) -> Self {
        let site = |(leaf, _)| Site {
            centre: foliage.leaf(leaf).centre().to_array(),
            leaf,
        };
        Self::of(lod.leaves().map(site).collect(), foliage.leaves().len())
    }

    fn of(sites: Vec<Site>, leaf_count: usize) -> Self {
        let mut neighbours = Self {
            tree: KdTree::default(),
            bucket_of: vec![0; leaf_count + 1],
            left: 0,
        };
        neighbours.plant(sites);
        neighbours
    }

    fn plant(&mut self, sites: Vec<Site>) {
        self.left = sites.len();
        self.tree = KdTree::new(sites);
        for (bucket, range) in self.tree.buckets.iter().enumerate() {
            for site in &self.tree.sites[range.start..range.start + range.len] {
                self.bucket_of[site.leaf.get() as usize] = bucket as u32;
            }
        }
    }

    /// Takes a leaf away that is there.
    pub(super) fn remove(&mut self, leaf: LeafId) {
        self.tree
            .remove(leaf, self.bucket_of[leaf.get() as usize] as usize);
        self.left -= 1;
        if 2 * self.left < self.tree.sites.len() {
            let left = self.tree.left().collect();
            self.plant(left);
        }
    }

    /// The `count` leaves nearest to where `leaf` is or was, nearest first, at
    /// equal distance the lowest number first.
    pub(super) fn nearest(&self, foliage: &Foliage, leaf: LeafId, count: usize) -> Vec<LeafId> {
        self.nearest_to(foliage.leaf(leaf).centre().to_array(), count)
    }

    fn nearest_to(&self, point: [f64; 3], count: usize) -> Vec<LeafId> {
        let count = count.min(self.left);
        let mut nearest = Nearest {
            point,
            count,
            found: Vec::with_capacity(count + 1),
        };
        if count > 0 {
            self.tree.search(1, [0.0; 3], &mut nearest);
        }
        nearest.found.into_iter().map(|(_, leaf)| leaf).collect()
    }
}

/// The best so far of a query.
struct Nearest {
    point: [f64; 3],
    count: usize,
    /// Squared distance and leaf, in order.
    found: Vec<(f64, LeafId)>,
}

impl Nearest {
    /// Squared distance within which a leaf may still be among them.
    fn reach(&self) -> f64 {
        match self.found.get(self.count - 1) {
            Some((distance, _)) => *distance,
            None => f64::INFINITY,
        }
    }

    fn offer(&mut self, site: &Site) {
        let [x, y, z] = std::array::from_fn(|k| site.centre[k] - self.point[k]);
        let offered = (x * x + y * y + z * z, site.leaf);
        if offered.0 > self.reach() {
            return;
        }
        let place = self.found.partition_point(|known| *known < offered);
        self.found.insert(place, offered);
        self.found.truncate(self.count);
    }
}

/// Sites split in halves along their widest side, down to buckets.
#[derive(Default)]
struct KdTree {
    sites: Vec<Site>,
    /// Axis and place of each split, from 1, the root, on: those of k are 2 k,
    /// below, and 2 k + 1.
    splits: Vec<(usize, f64)>,
    buckets: Vec<Bucket>,
}

#[derive(Clone, Copy, Default)]
struct Bucket {
    start: usize,
    len: usize,
}

impl KdTree {
    fn new(mut sites: Vec<Site>) -> Self {
        let bucket_count = sites.len().div_ceil(BUCKET).next_power_of_two();
        let mut splits = vec![(0, 0.0); bucket_count];
        let mut buckets = vec![Bucket::default(); bucket_count];
        // Ranges of the nodes from the root on, in the order of their numbers.
        let mut ranges = vec![0..0, 0..sites.len()];
        for node in 1..2 * bucket_count {
            let range = ranges[node].clone();
            if node >= bucket_count {
                buckets[node - bucket_count] = Bucket {
                    start: range.start,
                    len: range.len(),
                };
                continue;
            }
            let part = &mut sites[range.clone()];
            let (axis, middle) = (widest_axis(part), part.len() / 2);
            if middle < part.len() {
                let along = |a: &Site, b: &Site| a.centre[axis].total_cmp(&b.centre[axis]);
                let (_, site, _) = part.select_nth_unstable_by(middle, along);
                splits[node] = (axis, site.centre[axis]);
            }
            let middle = range.start + middle;
            ranges.extend([range.start..middle, middle..range.end]);
        }
        Self {
            sites,
            splits,
            buckets,
        }
    }

    fn in_bucket(&self, bucket: usize) -> &[Site] {
        let Bucket { start, len } = self.buckets[bucket];
        &self.sites[start..start + len]
    }

    fn left(&self) -> impl Iterator<Item = Site> + '_ {
        (0..self.buckets.len()).flat_map(|bucket| self.in_bucket(bucket).iter().copied())
    }

    fn remove(&mut self, leaf: LeafId, bucket: usize) {
        let sites = self.in_bucket(bucket);
        let at = sites.iter().position(|site| site.leaf == leaf);
        let at = at.expect("the leaf is there");
        let Bucket { start, len } = &mut self.buckets[bucket];
        *len -= 1;
        self.sites.swap(*start + at, *start + *len);
    }

    /// Offers what may be near from a node down, whose sites lie at least `away`
    /// from the point along each axis.
    fn search(&self, node: usize, away: [f64; 3], nearest: &mut Nearest) {
        if node >= self.buckets.len() {
            let sites = self.in_bucket(node - self.buckets.len());
            sites.iter().for_each(|site| nearest.offer(site));
            return;
        }
        let (axis, split) = self.splits[node];
        let beyond = nearest.point[axis] - split;
        let near = 2 * node + usize::from(beyond >= 0.0);
        self.search(near, away, nearest);
        let mut far = away;
        far[axis] = beyond.abs();
        let [x, y, z] = far;
        // Rounding never turns round which of two distances is less.
        if x * x + y * y + z * z <= nearest.reach() {
            self.search(near ^ 1, far, nearest);
        }
    }
}

fn widest_axis(sites: &[Site]) -> usize {
    let width = |axis: usize| {
        let along = sites.iter().map(|site| site.centre[axis]);
        let (lo, hi) = along.fold((f64::INFINITY, f64::NEG_INFINITY), |(lo, hi), at| {
            (lo.min(at), hi.max(at))
        });
        hi - lo
    };
    let widths = [0, 1, 2].map(width);
    (0..3)
        .max_by(|a, b| widths[*a].total_cmp(&widths[*b]))
        .expect("space has axes")
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    /// Places some of which are the same and some equally far from each other.
    fn any_sites() -> impl Strategy<Value = Vec<[f64; 3]>> {
        let on_a_lattice = prop::array::uniform3((-2i32..3).prop_map(f64::from));
        let anywhere = prop::array::uniform3(-2.0..2.0f64);
        let far_off = prop::array::uniform3(-1e9..1e9f64);
        let any = prop_oneof![4 => on_a_lattice, 4 => anywhere, 1 => far_off];
        prop::collection::vec(any, 1..200)
    }

    proptest! {
        #[test]
        fn the_nearest_are_found_while_leaves_go(
            centres in any_sites(),
            order in prop::collection::vec(any::<prop::sample::Index>(), 200),
            count in 0usize..12,
        ) {
            let site = |(k, centre): (usize, &[f64; 3])| Site {
                centre: *centre,
                leaf: LeafId::from_index(k),
            };
            let mut left: Vec<Site> = centres.iter().enumerate().map(site).collect();
            let mut neighbours = Neighbours::of(left.clone(), left.len());
            for index in order.iter().take(centres.len()) {
                let gone = left.remove(index.index(left.len()));
                neighbours.remove(gone.leaf);
                let distance = |site: &Site| {
                    let [x, y, z] = [0, 1, 2].map(|k| site.centre[k] - gone.centre[k]);
                    x * x + y * y + z * z
                };
                let mut expected: Vec<_> = left.iter().map(|s| (distance(s), s.leaf)).collect();
                expected.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
                let expected: Vec<_> = expected.into_iter().map(|e| e.1).take(count).collect();
                prop_assert_eq!(neighbours.nearest_to(gone.centre, count), expected);
            }
        }
    }
}
