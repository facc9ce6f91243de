//! Coarser wood by half-edge collapses that change the information of the views least.
//!
//! As in Castello et al., *Viewpoint-driven simplification using mutual information* (Computers &
//! Graphics 32, 2008), and section 4 of VDS, each triangle has an ID of its own, and a collapse costs
//! the sum over the views of by how much their mutual information changes. A collapse moves a vertex
//! onto a neighbour, so vertices only go: what is left keeps its attributes. All wood is looked at
//! at once, so that a piece hides another; leaves are not.

mod greedy;
mod mesh;
mod seen;

use rayon::prelude::*;
use secateur_model::{Foliage, LeafId};
use secateur_raster::Rasteriser;

use super::loss::Judges;
use crate::Error;
use crate::lg::LgTable;
use greedy::{Candidate, cheapest, collapse_all};
use mesh::Mesh;
use seen::Seen;

/// Of all pieces what was left when it had half of its triangles, a quarter and so on, and last.
///
/// # Errors
/// [`Error::Gpu`] if the rasteriser fails.
pub(super) fn collapsed(
    wood: &Foliage,
    judges: Judges<'_>,
    rasteriser: &dyn Rasteriser,
) -> Result<Vec<Vec<Vec<[u32; 3]>>>, Error> {
    let mut left: Vec<Vec<Vec<[u32; 3]>>> = vec![Vec::new(); wood.leaves().len()];
    if wood.leaves().is_empty() {
        return Ok(left);
    }
    let table = LgTable::new();
    let mut mesh = Mesh::new(wood);
    let mut seen = Seen::new(&mesh, judges.views, judges.resolution, rasteriser, &table)?;
    let count_of = |piece: usize| wood.triangles_of(LeafId::from_index(piece)).len();
    let mut counts: Vec<usize> = (0..left.len())
        .map(|piece| mesh.left_of(LeafId::from_index(piece)).len())
        .collect();
    let mut wanted: Vec<usize> = (0..left.len()).map(|piece| count_of(piece) / 2).collect();
    let firsts = firsts(&mesh, &seen);
    collapse_all(&mut mesh, &mut seen, firsts, |mesh, _, effect| {
        let piece = mesh.piece_of(effect.removed[0]);
        let count = &mut counts[piece.index()];
        *count -= effect.removed.len();
        if *count <= wanted[piece.index()] {
            wanted[piece.index()] = *count / 2;
            left[piece.index()].push(mesh.left_of(piece));
        }
    });
    for (piece, of_piece) in left.iter_mut().enumerate() {
        let last = mesh.left_of(LeafId::from_index(piece));
        let before = of_piece.last().map_or(count_of(piece), Vec::len);
        if !last.is_empty() && last.len() < before {
            of_piece.push(last);
        }
    }
    Ok(left)
}

/// The first look at all places, each thread with a buffer of its own.
fn firsts(mesh: &Mesh<'_>, seen: &Seen<'_>) -> Vec<Option<Candidate>> {
    let places = mesh.place_count() as usize;
    let shards = rayon::current_num_threads().min(places).max(1);
    let size = places.div_ceil(shards).max(1);
    let of_shard = |shard: usize| {
        let mut seen = seen.clone();
        let of_shard = (shard * size).min(places)..((shard + 1) * size).min(places);
        of_shard
            .map(|place| cheapest(mesh, place as u32, &mut seen))
            .collect::<Vec<_>>()
    };
    let all: Vec<Vec<_>> = (0..shards).into_par_iter().map(of_shard).collect();
    all.concat()
}

#[cfg(test)]
mod tests;
