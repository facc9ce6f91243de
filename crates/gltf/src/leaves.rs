//! Leaves: triangles that hang together by edges.
//!
//! Two triangles belong to one leaf when they share two positions. Indices
//! don't decide: exporters split a vertex where normals or texture coordinates
//! change, which would part a leaf. Neither does one shared position: leaves
//! that grow from one point would become one.

use glam::DVec3;

/// The leaves of a primitive, each as triangle numbers, ascending; leaves by
/// their lowest triangle number.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(crate) struct Leaves {
    triangles: Vec<u32>,
    /// `triangles[ends[k - 1]..ends[k]]` is leaf k.
    ends: Vec<u32>,
}

impl Leaves {
    /// How many there are.
    pub(crate) fn len(&self) -> usize {
        self.ends.len()
    }

    /// The triangle numbers of each leaf.
    pub(crate) fn iter(&self) -> impl ExactSizeIterator<Item = &[u32]> + '_ {
        (0..self.len()).map(|k| {
            let start = if k == 0 { 0 } else { self.ends[k - 1] };
            &self.triangles[start as usize..self.ends[k] as usize]
        })
    }
}

/// Numbers positions so that equal ones have equal numbers; -0 equals 0.
///
/// Sorting rather than hashing: a file made to collide can't slow it down.
fn weld(positions: &[DVec3]) -> Vec<u32> {
    // Adding zero turns -0 into 0. Positions come from f32 or shorter integers,
    // so that f32 tells them all apart.
    let bits = |x: f64| u128::from((x as f32 + 0.0).to_bits());
    let mut keys: Vec<u128> = positions
        .iter()
        .zip(0u128..)
        .map(|(p, index)| bits(p.x) << 96 | bits(p.y) << 64 | bits(p.z) << 32 | index)
        .collect();
    keys.sort_unstable();
    let mut welded = vec![0; positions.len()];
    let mut number = 0;
    for (k, key) in keys.iter().enumerate() {
        if k > 0 && keys[k - 1] >> 32 != key >> 32 {
            number += 1;
        }
        welded[*key as u32 as usize] = number;
    }
    welded
}

/// A forest over triangles; the root of each tree is its lowest triangle.
struct Forest(Vec<u32>);

impl Forest {
    fn root(&mut self, mut t: u32) -> u32 {
        while self.0[t as usize] != t {
            let grandparent = self.0[self.0[t as usize] as usize];
            self.0[t as usize] = grandparent;
            t = grandparent;
        }
        t
    }

    fn join(&mut self, a: u32, b: u32) {
        let (a, b) = (self.root(a), self.root(b));
        self.0[a.max(b) as usize] = a.min(b);
    }
}

/// An edge seen from its lower end.
type HalfEdge = (u32, u32);

/// Joins triangles that share an edge. Edges are gathered by their lower end,
/// so that only those of one vertex are ever sorted together.
fn join_by_edges(triangles: &[[u32; 3]], welded: &[u32]) -> Forest {
    let edges = |t: &[u32; 3]| {
        let [a, b, c] = t.map(|v| welded[v as usize]);
        [(a, b), (b, c), (c, a)]
            .map(|(p, q)| (p.min(q), p.max(q)))
            .into_iter()
            .filter(|(low, high)| low != high)
    };
    let mut starts = vec![0u32; welded.len() + 1];
    for (low, _) in triangles.iter().flat_map(edges) {
        starts[low as usize + 1] += 1;
    }
    for k in 1..starts.len() {
        starts[k] += starts[k - 1];
    }
    let mut half_edges: Vec<HalfEdge> = vec![(0, 0); starts[welded.len()] as usize];
    let mut next = starts.clone();
    for (triangle, number) in triangles.iter().zip(0..) {
        for (low, high) in edges(triangle) {
            let slot = &mut next[low as usize];
            half_edges[*slot as usize] = (high, number);
            *slot += 1;
        }
    }
    let mut forest = Forest((0..triangles.len() as u32).collect());
    for range in starts.windows(2) {
        let around = &mut half_edges[range[0] as usize..range[1] as usize];
        around.sort_unstable();
        for pair in around.windows(2).filter(|pair| pair[0].0 == pair[1].0) {
            forest.join(pair[0].1, pair[1].1);
        }
    }
    forest
}

/// The leaves of a primitive's triangles.
///
/// A triangle without area joins by its edges that have length; one that has
/// none is a leaf of its own.
pub(crate) fn find_leaves(positions: &[DVec3], triangles: &[[u32; 3]]) -> Leaves {
    let mut forest = join_by_edges(triangles, &weld(positions));
    let mut leaf_of = vec![0u32; triangles.len()];
    let mut sizes: Vec<u32> = Vec::new();
    for t in 0..triangles.len() as u32 {
        let root = forest.root(t);
        if root == t {
            leaf_of[t as usize] = sizes.len() as u32;
            sizes.push(0);
        } else {
            leaf_of[t as usize] = leaf_of[root as usize];
        }
        sizes[leaf_of[t as usize] as usize] += 1;
    }
    let mut ends = sizes;
    let mut total = 0;
    for end in &mut ends {
        let start = total;
        total += *end;
        *end = start;
    }
    let mut grouped = vec![0; triangles.len()];
    for (t, &leaf) in leaf_of.iter().enumerate() {
        let end = &mut ends[leaf as usize];
        grouped[*end as usize] = t as u32;
        *end += 1;
    }
    Leaves {
        triangles: grouped,
        ends,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn points(list: &[[f64; 3]]) -> Vec<DVec3> {
        list.iter().copied().map(DVec3::from_array).collect()
    }

    fn leaves(positions: &[[f64; 3]], triangles: &[[u32; 3]]) -> Vec<Vec<u32>> {
        let found = find_leaves(&points(positions), triangles);
        found.iter().map(<[u32]>::to_vec).collect()
    }

    #[test]
    fn split_vertices_make_one_leaf() {
        // Two triangles of a square with all six vertices their own; one corner
        // of the shared edge is written as -0 in one of them.
        let square = [
            [0.0, 0.0, 0.0],
            [1.0, 0.0, 0.0],
            [1.0, 1.0, 0.0],
            [-0.0, -0.0, 0.0],
            [1.0, 1.0, -0.0],
            [0.0, 1.0, 0.0],
        ];
        assert_eq!(leaves(&square, &[[0, 1, 2], [3, 4, 5]]), [vec![0, 1]]);
    }

    #[test]
    fn leaves_that_touch_in_one_point_stay_apart() {
        let touching = [
            [0.0, 0.0, 0.0],
            [1.0, 0.0, 0.0],
            [1.0, 1.0, 0.0],
            [-1.0, 0.0, 0.0],
            [-1.0, -1.0, 0.0],
        ];
        // Both triangles even share the vertex by index.
        assert_eq!(
            leaves(&touching, &[[0, 1, 2], [0, 3, 4]]),
            [vec![0], vec![1]]
        );
    }

    #[test]
    fn a_reversed_back_face_belongs_to_its_front() {
        let corners = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
        assert_eq!(leaves(&corners, &[[0, 1, 2], [2, 1, 0]]), [vec![0, 1]]);
    }

    #[test]
    fn triangles_without_area_join_by_edges_that_have_length() {
        let corners = [
            [0.0, 0.0, 0.0],
            [1.0, 0.0, 0.0],
            [0.0, 1.0, 0.0],
            [5.0, 5.0, 5.0],
        ];
        // 1 shares the edge 0-1 of triangle 0; 2 and 3 are points: they have no
        // edge to share, even with each other.
        let triangles = [[0, 1, 2], [0, 1, 1], [3, 3, 3], [3, 3, 3]];
        assert_eq!(leaves(&corners, &triangles), [vec![0, 1], vec![2], vec![3]]);
    }

    #[test]
    fn leaves_are_in_the_order_of_their_lowest_triangle() {
        // Triangles 0 and 2 make a square, 1 lies apart.
        let corners = [
            [0.0, 0.0, 0.0],
            [1.0, 0.0, 0.0],
            [1.0, 1.0, 0.0],
            [0.0, 1.0, 0.0],
            [9.0, 0.0, 0.0],
            [9.0, 1.0, 0.0],
            [8.0, 0.0, 0.0],
        ];
        let triangles = [[0, 1, 2], [4, 5, 6], [0, 2, 3]];
        assert_eq!(leaves(&corners, &triangles), [vec![0, 2], vec![1]]);
    }

    #[test]
    fn no_triangles_are_no_leaves() {
        assert_eq!(find_leaves(&[], &[]).len(), 0);
    }
}
