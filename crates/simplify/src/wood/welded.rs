//! The triangles of one piece as a mesh whose corners at one position are one place.

use std::collections::VecDeque;

use glam::DVec3;
use rustc_hash::FxHashMap;
use secateur_model::LeafTriangle;

/// A mesh of places, the positions that corners have.
pub(super) struct Welded {
    pub(super) places: Vec<DVec3>,
    /// The places of each triangle.
    pub(super) triangles: Vec<[usize; 3]>,
    /// By place, the places that share an edge with it; some more than once.
    pub(super) around: Vec<Vec<usize>>,
    /// By edge, the smaller place first, how many triangles have it.
    uses: FxHashMap<[usize; 2], u32>,
}

impl Welded {
    pub(super) fn of(triangles: &[LeafTriangle]) -> Self {
        let mut number_of: FxHashMap<[u64; 3], usize> = FxHashMap::default();
        let mut places = Vec::new();
        let mut place_of = |corner: DVec3| {
            let key = corner.to_array().map(|x| (x + 0.0).to_bits());
            *number_of.entry(key).or_insert_with(|| {
                places.push(corner);
                places.len() - 1
            })
        };
        let triangles: Vec<[usize; 3]> = triangles
            .iter()
            .map(|t| t.corners.map(&mut place_of))
            .collect();
        let mut around: Vec<Vec<usize>> = vec![Vec::new(); places.len()];
        let mut uses: FxHashMap<[usize; 2], u32> = FxHashMap::default();
        for &[a, b, c] in &triangles {
            for (from, to) in [(a, b), (b, c), (c, a)] {
                if from != to {
                    around[from].push(to);
                    around[to].push(from);
                    *uses.entry([from.min(to), from.max(to)]).or_default() += 1;
                }
            }
        }
        Self {
            places,
            triangles,
            around,
            uses,
        }
    }

    /// The places of each border: those that edges of one triangle connect.
    pub(super) fn borders(&self) -> Vec<Vec<usize>> {
        let is_border = |a: usize, b: usize| self.uses.get(&[a.min(b), a.max(b)]) == Some(&1);
        let mut is_found = vec![false; self.places.len()];
        let mut borders = Vec::new();
        for first in 0..self.places.len() {
            let is_at_border = self.around[first].iter().any(|b| is_border(first, *b));
            if !is_at_border || is_found[first] {
                continue;
            }
            is_found[first] = true;
            let mut found = vec![first];
            let mut next = 0;
            while next < found.len() {
                let place = found[next];
                for &other in &self.around[place] {
                    if is_border(place, other) && !std::mem::replace(&mut is_found[other], true) {
                        found.push(other);
                    }
                }
                next += 1;
            }
            borders.push(found);
        }
        borders
    }

    /// For each place how many edges it is away from the nearest of some; `usize::MAX` where no edges lead
    /// there.
    pub(super) fn hops(&self, from: &[usize]) -> Vec<usize> {
        let mut hops = vec![usize::MAX; self.places.len()];
        let mut queue = VecDeque::new();
        for &place in from {
            hops[place] = 0;
            queue.push_back(place);
        }
        while let Some(place) = queue.pop_front() {
            for &next in &self.around[place] {
                if hops[next] == usize::MAX {
                    hops[next] = hops[place] + 1;
                    queue.push_back(next);
                }
            }
        }
        hops
    }
}
