//! Fragments to what each leaf hides.

use rayon::prelude::*;

use crate::{Fragments, RevealEdge};

/// For each front leaf, leaf right behind it and view the number of such
/// pixels, in order. The twin is `reveal_edges.wgsl`.
pub fn reveal_edges(fragments: &Fragments) -> Vec<RevealEdge> {
    let mut edges: Vec<RevealEdge> = (0..fragments.views().len())
        .into_par_iter()
        .flat_map_iter(|view| edges_of_view(fragments, view))
        .collect();
    edges.par_sort_unstable();
    edges
}

fn edges_of_view(fragments: &Fragments, view: usize) -> Vec<RevealEdge> {
    let mut pairs: Vec<[u32; 2]> = fragments.views()[view]
        .pixels()
        .filter_map(|list| match list {
            [] => None,
            [front] => Some([front.leaf(), 0]),
            [front, second, ..] => Some([front.leaf(), second.leaf()]),
        })
        .collect();
    pairs.sort_unstable();
    pairs
        .chunk_by(|a, b| a == b)
        .map(|same| RevealEdge {
            front: same[0][0],
            second: same[0][1],
            view: view as u32,
            pixels: same.len() as u32,
        })
        .collect()
}
