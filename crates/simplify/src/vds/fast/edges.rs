//! Reveal edges: which leaf hands how many pixels to which.

use rustc_hash::FxHashMap;
use smallvec::SmallVec;

use super::split::Split;

pub(super) const NO_EDGE: u32 = u32::MAX;

/// Pixels by view, only those that are not zero.
pub(super) type Reveals = SmallVec<[(u32, u32); 3]>;

/// What leaf `from` would hand to leaf `to` behind it if it went.
#[repr(align(64))]
pub(super) struct Edge {
    pub from: u32,
    pub to: u32,
    /// Pixels over all views.
    pub total: u32,
    /// Where the list of those that lead to `to` holds this edge.
    place: u32,
    /// Where the list of touched edges holds it during a step.
    touched: u32,
    pub reveals: Reveals,
}

impl Edge {
    pub(super) fn is_touched(&self) -> bool {
        self.touched != NO_EDGE
    }

    fn add(&mut self, view: u32, by: i32) {
        self.total = self.total.wrapping_add_signed(by);
        let known = self.reveals.iter().position(|(v, _)| *v == view);
        let at = known.unwrap_or_else(|| {
            self.reveals.push((view, 0));
            self.reveals.len() - 1
        });
        let pixels = &mut self.reveals[at].1;
        *pixels = pixels.wrapping_add_signed(by);
        if *pixels == 0 {
            self.reveals.swap_remove(at);
        }
    }
}

/// An edge of the step, as it was before.
pub(super) struct TouchedEdge {
    pub edge: u32,
    pub total_before: u32,
    pub reveals_before: Reveals,
}

/// All edges; those that lead to the background are apart.
pub(super) struct Edges {
    split: Split,
    all: Vec<Edge>,
    free: Vec<u32>,
    by_ends: FxHashMap<(u32, u32), u32>,
    /// By leaf they lead to, then shard of the leaf they come from.
    incoming: Vec<Vec<u32>>,
    /// By leaf number.
    to_background: Vec<u32>,
    /// By shard of the leaf they come from.
    touched: Vec<Vec<TouchedEdge>>,
}

impl Edges {
    pub(super) fn new(leaf_count: usize, split: Split) -> Self {
        Self {
            split,
            all: Vec::new(),
            free: Vec::new(),
            by_ends: FxHashMap::default(),
            incoming: vec![Vec::new(); (leaf_count + 1) << split.shards().ilog2()],
            to_background: vec![NO_EDGE; leaf_count + 1],
            touched: (0..split.shards()).map(|_| Vec::new()).collect(),
        }
    }

    pub(super) fn split(&self) -> Split {
        self.split
    }

    pub(super) fn all(&self) -> &[Edge] {
        &self.all
    }

    #[inline(always)]
    pub(super) fn get(&self, index: u32) -> &Edge {
        &self.all[index as usize]
    }

    /// What a leaf would hand to the background.
    #[inline]
    pub(super) fn to_background(&self, leaf: u32) -> Option<&Edge> {
        match self.to_background[leaf as usize] {
            NO_EDGE => None,
            index => Some(self.get(index)),
        }
    }

    /// The edges from leaves of a shard to a leaf.
    #[inline]
    pub(super) fn incoming(&self, to: u32, shard: usize) -> &[u32] {
        &self.incoming[to as usize * self.split.shards() + shard]
    }

    /// The edges from leaves of a shard that the step changed.
    pub(super) fn touched(&self, shard: usize) -> &[TouchedEdge] {
        &self.touched[shard]
    }

    /// The edge between two leaves, which may be new.
    pub(super) fn between(&mut self, from: u32, to: u32) -> u32 {
        let Self {
            split,
            all,
            free,
            by_ends,
            incoming,
            to_background,
            ..
        } = self;
        *by_ends.entry((from, to)).or_insert_with(|| {
            let list = &mut incoming[to as usize * split.shards() + split.shard(from)];
            let edge = Edge {
                from,
                to,
                total: 0,
                place: list.len() as u32,
                touched: NO_EDGE,
                reveals: Reveals::new(),
            };
            let index = match free.pop() {
                Some(index) => {
                    all[index as usize] = edge;
                    index
                }
                None => {
                    all.push(edge);
                    all.len() as u32 - 1
                }
            };
            match to {
                0 => to_background[from as usize] = index,
                _ => list.push(index),
            }
            index
        })
    }

    /// Adds pixels in a view before the first step.
    pub(super) fn fill(&mut self, index: u32, view: u32) {
        self.all[index as usize].add(view, 1);
    }

    /// Adds pixels in a view, and remembers what was before.
    pub(super) fn add(&mut self, index: u32, view: u32, by: i32) {
        let edge = &mut self.all[index as usize];
        if edge.touched == NO_EDGE {
            let touched = &mut self.touched[self.split.shard(edge.from)];
            edge.touched = touched.len() as u32;
            touched.push(TouchedEdge {
                edge: index,
                total_before: edge.total,
                reveals_before: edge.reveals.clone(),
            });
        }
        edge.add(view, by);
    }

    /// Forgets what was before the step, and edges that have no pixels left.
    pub(super) fn forget_step(&mut self) {
        for shard in 0..self.touched.len() {
            while let Some(touched) = self.touched[shard].pop() {
                let edge = &mut self.all[touched.edge as usize];
                edge.touched = NO_EDGE;
                if edge.total == 0 {
                    self.drop(touched.edge, shard);
                }
            }
        }
    }

    fn drop(&mut self, index: u32, shard: usize) {
        let Edge {
            from, to, place, ..
        } = self.all[index as usize];
        self.by_ends.remove(&(from, to));
        self.free.push(index);
        if to == 0 {
            self.to_background[from as usize] = NO_EDGE;
            return;
        }
        let list = &mut self.incoming[to as usize * self.split.shards() + shard];
        list.swap_remove(place as usize);
        if let Some(&moved) = list.get(place as usize) {
            self.all[moved as usize].place = place;
        }
    }
}
