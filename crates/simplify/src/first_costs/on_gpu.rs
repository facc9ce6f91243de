//! The twin of [`on_cpu`](super::on_cpu) in `first_costs.wgsl`.

use std::ops::Range;

use secateur_raster::gpu::{Device, Dispatch, GpuError, Stage, wgpu};
use secateur_raster::{AreaTable, RevealEdge};

use super::totals;
use crate::lg::{LG_FRACTION_BITS, LgTable};

/// Lanes of a workgroup.
const WORKGROUP: u32 = 64;

/// Logarithms of counts below this are looked up, others computed.
const TABLE_LEN: u32 = 1 << 16;

/// The most leaves at a time: a dispatch stays short.
const MAX_LEAVES: u64 = 1 << 16;

/// Bytes of a cost, and of a leaf's change in one view.
const COST_BYTES: u64 = 8;

/// As [`on_cpu`](super::on_cpu), with the same bits.
///
/// # Errors
/// [`GpuError`] if the device fails, or the areas do not fit it.
///
/// # Panics
/// As [`on_cpu`](super::on_cpu).
pub fn on_gpu(
    device: &Device,
    edges: &[RevealEdge],
    areas: &AreaTable,
    table: &LgTable,
) -> Result<Vec<u64>, GpuError> {
    let leaf_count = areas.leaf_count();
    let view_count = areas.view_count();
    if leaf_count == 0 || view_count == 0 {
        return Ok(vec![0; leaf_count]);
    }
    let last = edges.iter().map(|e| e.front.max(e.second)).max();
    assert!(
        last.unwrap_or(0) as usize <= leaf_count
            && edges.iter().all(|e| (e.view as usize) < view_count),
        "edges and areas are of one scene"
    );
    check(device, "the areas of all views", areas.as_slice().len())?;
    let most = device.binding_limit() / (COST_BYTES * view_count as u64);
    let most = most.clamp(1, MAX_LEAVES) as usize;
    let run = Run::new(device, areas, table);
    let mut costs = Vec::with_capacity(leaf_count);
    for first in (1..=leaf_count).step_by(most) {
        let end = (first + most).min(leaf_count + 1);
        let before = |leaf: usize| edges.partition_point(|e| (e.front as usize) < leaf);
        let edges = &edges[before(first)..before(end)];
        costs.extend(run.costs_of(first..end, edges)?);
    }
    Ok(costs)
}

fn check(device: &Device, what: &'static str, words: usize) -> Result<(), GpuError> {
    let (bytes, limit) = (4 * words as u64, device.binding_limit());
    if bytes > limit {
        return Err(GpuError::TooLarge { what, bytes, limit });
    }
    Ok(())
}

/// What serves all leaves.
struct Run<'a> {
    device: &'a Device,
    leaf_count: usize,
    view_count: usize,
    changes: Stage,
    sum_views: Stage,
    areas: wgpu::Buffer,
    totals: wgpu::Buffer,
    lg_table: wgpu::Buffer,
}

impl<'a> Run<'a> {
    fn new(device: &'a Device, areas: &AreaTable, table: &LgTable) -> Self {
        let stage = |entry, overrides: &[(&str, u32)]| {
            Stage::new(device, secateur_shaders::FIRST_COSTS, entry, overrides)
        };
        let lanes = ("WORKGROUP", WORKGROUP);
        let logarithms: Vec<u32> = (0..TABLE_LEN).map(|n| table.lg(n) as u32).collect();
        Self {
            device,
            leaf_count: areas.leaf_count(),
            view_count: areas.view_count(),
            changes: stage("changes", &[lanes, ("LG_FRACTION_BITS", LG_FRACTION_BITS)]),
            sum_views: stage("sum_views", &[lanes]),
            areas: device.storage_of("areas", areas.as_slice()),
            totals: device.storage_of("totals", &totals(areas)),
            lg_table: device.storage_of("logarithms", &logarithms),
        }
    }

    fn costs_of_halves(
        &self,
        leaves: Range<usize>,
        edges: &[RevealEdge],
        too_large: GpuError,
    ) -> Result<Vec<u64>, GpuError> {
        if leaves.len() == 1 {
            return Err(too_large);
        }
        let middle = leaves.start + leaves.len() / 2;
        let cut = edges.partition_point(|e| (e.front as usize) < middle);
        let mut costs = self.costs_of(leaves.start..middle, &edges[..cut])?;
        costs.extend(self.costs_of(middle..leaves.end, &edges[cut..])?);
        Ok(costs)
    }

    /// Costs of a run of leaves, by number; `edges` are theirs.
    fn costs_of(&self, leaves: Range<usize>, edges: &[RevealEdge]) -> Result<Vec<u64>, GpuError> {
        let device = self.device;
        let count = leaves.len() as u32;
        let views = self.view_count as u32;
        let reveals = Reveals::of(leaves.clone(), edges);
        let words = reveals.reveals.len().max(reveals.edges.len());
        if let Err(error) = check(device, "the leaves behind one leaf", words) {
            return self.costs_of_halves(leaves, edges, error);
        }
        let row = self.leaf_count as u32 + 1;
        let shape = device.uniform(&[count, views, leaves.start as u32, row]);
        let first_reveal = device.storage_of("first reveals", &reveals.firsts);
        let to = device.storage_of("reveals", &reveals.reveals);
        let edges = device.storage_of("edges", &reveals.edges);
        let moved = device.storage("changes", COST_BYTES * u64::from(count) * u64::from(views));
        let costs = device.storage("costs", COST_BYTES * u64::from(count));
        let workgroups = count.div_ceil(WORKGROUP);
        let changes = Dispatch {
            stage: &self.changes,
            bindings: &[
                (0, &shape),
                (1, &first_reveal),
                (2, &to),
                (3, &edges),
                (4, &self.areas),
                (5, &self.totals),
                (6, &self.lg_table),
                (7, &moved),
            ],
            workgroups: [workgroups, views, 1],
        };
        let sum_views = Dispatch {
            stage: &self.sum_views,
            bindings: &[(0, &shape), (7, &moved), (8, &costs)],
            workgroups: [workgroups, 1, 1],
        };
        let bytes = COST_BYTES * u64::from(count);
        let words = device.run(&[changes, sum_views], &costs, bytes)?;
        let cost = |pair: &[u32]| u64::from(pair[1]) << 32 | u64::from(pair[0]);
        Ok(words.chunks_exact(2).map(cost).collect())
    }
}

/// A run of leaves' edges in the layout that the shader reads.
struct Reveals {
    firsts: Vec<u32>,
    /// Three words each, and a last one for the end.
    reveals: Vec<u32>,
    /// Two words each.
    edges: Vec<u32>,
}

impl Reveals {
    fn of(leaves: Range<usize>, edges: &[RevealEdge]) -> Self {
        let mut own = Self {
            firsts: Vec::with_capacity(leaves.len() + 1),
            reveals: Vec::new(),
            edges: Vec::with_capacity(2 * edges.len()),
        };
        let mut groups = edges
            .chunk_by(|a, b| (a.front, a.second) == (b.front, b.second))
            .peekable();
        for leaf in leaves {
            own.firsts.push(own.reveals.len() as u32 / 3);
            while let Some(group) = groups.next_if(|group| group[0].front as usize == leaf) {
                let total_px = group.iter().map(|edge| edge.pixels).sum();
                let first_edge = own.edges.len() as u32 / 2;
                own.reveals.extend([group[0].second, total_px, first_edge]);
                own.edges
                    .extend(group.iter().flat_map(|edge| [edge.view, edge.pixels]));
            }
        }
        own.firsts.push(own.reveals.len() as u32 / 3);
        own.reveals.extend([0, 0, own.edges.len() as u32 / 2]);
        own
    }
}
