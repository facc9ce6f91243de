//! What pruning each leaf of the original foliage costs.
//!
//! The cost of a leaf is `sum_v |I(v;F) - I(v;F without l)|` (Entropy 2018, 20,
//! 213, Eq. 4, for the first step). With an A-buffer the areas without the leaf
//! are known without drawing: the pixels that leaf l owns go to the leaves right
//! behind, or to the background. Costs are `P * I` in units of 2^-27 bits, as in
//! [`vmi`](crate::vmi), so both twins give the same bits.

#[cfg(feature = "gpu")]
mod on_gpu;

use rayon::prelude::*;
use secateur_raster::{AreaTable, RevealEdge};

#[cfg(feature = "gpu")]
pub use on_gpu::on_gpu;

use crate::lg::LgTable;

/// The first cost of each leaf, leaf 1 first; 0 for a leaf that no view sees.
///
/// `edges` and `areas` are those of one scene, `edges` in order (see
/// [`reveal_edges`](secateur_raster::cpu::reveal_edges)). The twin is
/// `first_costs.wgsl`.
///
/// # Panics
/// If an edge names a leaf or a view that `areas` lacks.
pub fn on_cpu(edges: &[RevealEdge], areas: &AreaTable, table: &LgTable) -> Vec<u64> {
    let totals = totals(areas);
    let mut costs = vec![0; areas.leaf_count()];
    let seen: Vec<&[RevealEdge]> = edges.chunk_by(|a, b| a.front == b.front).collect();
    let found: Vec<(usize, u64)> = seen
        .into_par_iter()
        .map(|edges| {
            let leaf = edges[0].front as usize;
            (leaf, cost_of(leaf, edges, areas, &totals, table))
        })
        .collect();
    for (leaf, cost) in found {
        costs[leaf - 1] = cost;
    }
    costs
}

/// `edges` are those of the leaf.
fn cost_of(
    leaf: usize,
    edges: &[RevealEdge],
    areas: &AreaTable,
    totals: &[u32],
    table: &LgTable,
) -> u64 {
    let term = |area: u32, total: u32| table.term(area, table.lg(total));
    let mut changes: Vec<i64> = areas
        .rows()
        .map(|row| -term(row[leaf], totals[leaf]))
        .collect();
    for to in edges.chunk_by(|a, b| a.second == b.second) {
        let second = to[0].second as usize;
        let total_px: u32 = to.iter().map(|edge| edge.pixels).sum();
        let mut of_view = to.iter().peekable();
        for (view, row) in areas.rows().enumerate() {
            let here = of_view.next_if(|edge| edge.view as usize == view);
            let pixels = here.map_or(0, |edge| edge.pixels);
            changes[view] += term(row[second] + pixels, totals[second] + total_px)
                - term(row[second], totals[second]);
        }
    }
    changes.iter().map(|change| change.unsigned_abs()).sum()
}

/// Areas over all views in pixels, the background first.
fn totals(areas: &AreaTable) -> Vec<u32> {
    let mut totals = vec![0; areas.leaf_count() + 1];
    for row in areas.rows() {
        for (total, area_px) in totals.iter_mut().zip(row) {
            *total += area_px;
        }
    }
    totals
}
