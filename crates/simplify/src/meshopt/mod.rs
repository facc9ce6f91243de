//! What most people use today: a mesh simplifier on the mesh of all leaves.
//!
//! meshoptimizer (Arseny Kapoulkine, MIT) collapses edges by quadric error; its port to Rust is
//! called as it is (`edge_collapses`). It knows triangles, not leaves: a level
//! is asked for as a share of the triangles, and how many leaves are left is
//! what comes of it. The border of what is left may be moved outwards to give back lost area:
//! once, afterwards (`dilate`), or after each halving of the triangles, as meshoptimizer's
//! own example does (`halving`). That example itself, with clusters, is `clusters`.
//!
//! The order has one step: the foliage, and the level in its place.

mod clusters;
mod dilate;
mod halving;

use meshoptimizer_rs::SimplifyOptions;
use rustc_hash::FxHashMap;
use secateur_model::{
    CornerRef, Foliage, LeafId, LeafTriangle, NewCorner, NewLeaf, Place, PlantSkeleton,
    RemovalOrder, Step,
};
use serde::{Deserialize, Serialize};

use crate::Error;
use crate::edge_collapses::IndexedTriangles;
use crate::select::{Select, Selection, Steps, Task};

/// Which of meshoptimizer's simplifiers.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "cli", derive(clap::ValueEnum))]
#[serde(rename_all = "kebab-case")]
pub enum Mode {
    /// `simplify`, then small parts are dropped.
    #[default]
    Prune,
    /// `simplify` alone, which only collapses edges.
    ///
    /// A leaf goes when its last triangle loses an edge.
    Plain,
    /// `simplify_sloppy`, which joins vertices that share a cell of a grid.
    Sloppy,
    /// `clusterlod`, the example of cluster LODs, at one error for the whole crown. Its own dilation is
    /// [`Borders::Dilate`].
    Clusters,
}

/// What becomes of the border of what is left.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Borders {
    /// The border stays where it was.
    #[default]
    Stay,
    /// The border grows once, by the area that was lost.
    PreserveArea,
    /// The border grows after each halving of the triangles, by what that lost, as meshoptimizer's example
    /// of cluster LODs has it (`simplify_dilate_borders`, pull request 1093, merged in 2026). With
    /// [`Mode::Clusters`] that example does it itself, group by group.
    Dilate,
}

/// What can be chosen about the mesh simplifier.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct MeshoptOptions {
    /// Which of meshoptimizer's simplifiers is used.
    pub mode: Mode,
    /// What becomes of the border of what is left.
    pub borders: Borders,
}

impl Select for MeshoptOptions {
    fn check(&self, _: &Foliage, _: Option<&PlantSkeleton>) -> Result<(), Error> {
        Ok(())
    }

    /// A target of leaves is one of as large a share of the triangles.
    fn select(&self, task: &Task<'_>, _: &mut Steps<'_>) -> Result<Selection, Error> {
        let (count, left) = match task.target.triangle_count(task.foliage) {
            Some(left) => (task.foliage.triangles().len(), left),
            None => (
                task.foliage.leaves().len(),
                task.target.leaves_to_stop_at(task.foliage),
            ),
        };
        let share = left as f64 / count as f64;
        Ok(Selection::unseen(simplify(task.foliage, share, *self)))
    }
}

/// Reduces the foliage's triangles to this share, or as near to it as the
/// simplifier comes; without an error limit. A share of 1 or more changes nothing.
///
/// Positions pass through f32, relative to the middle of the foliage and in
/// units of its radius; vertices stay where they were unless the border grows.
/// A triangle that joins vertices of several leaves has the look of the leaf of
/// its first corner.
///
/// # Panics
/// If the foliage's positions leave the range of f64.
pub fn simplify(foliage: &Foliage, share: f64, options: MeshoptOptions) -> RemovalOrder {
    let count = foliage.leaves().len();
    let mut order = RemovalOrder::new(count as u32);
    if share >= 1.0 {
        return order;
    }
    let mut mesh = Mesh::of(foliage);
    let goal = 3 * (share * (mesh.indices.len() / 3) as f64).round() as usize;
    let kept = match (options.mode, options.borders) {
        (Mode::Clusters, Borders::Dilate) => clusters::dilated(&mut mesh, goal),
        (mode, Borders::Dilate) => halving::simplified(&mut mesh, goal, mode),
        (mode, Borders::Stay | Borders::PreserveArea) => mesh.simplified(&mesh.indices, goal, mode),
    };
    let (mut removed, mut made) = mesh.leaves_of(foliage, &kept);
    if options.borders == Borders::PreserveArea {
        dilate::dilate(foliage, &mut removed, &mut made);
    }
    order.push_step(Step {
        removed: &removed,
        grown: &[],
        made: &made,
        survivors_area_scale: 1.0,
    });
    order
}

/// The leaves as one indexed mesh. Corners of one leaf at one place with the
/// same texture coordinates are one vertex; no two leaves share any.
struct Mesh {
    /// Relative to the middle of the foliage, in units of its radius.
    positions: Vec<[f32; 3]>,
    is_moved: Vec<bool>,
    corners: Vec<CornerRef>,
    indices: Vec<u32>,
    centre: glam::DVec3,
    unit: f64,
}

impl Mesh {
    fn of(foliage: &Foliage) -> Self {
        let sphere = foliage.bounding_sphere();
        let (centre, radius) = sphere.map_or((glam::DVec3::ZERO, 1.0), |s| (s.centre, s.radius));
        let unit = if radius > 0.0 { radius } else { 1.0 };
        let mut mesh = Self {
            positions: Vec::new(),
            is_moved: Vec::new(),
            corners: Vec::new(),
            indices: Vec::with_capacity(3 * foliage.triangles().len()),
            centre,
            unit,
        };
        let mut known: FxHashMap<[u64; 5], u32> = FxHashMap::default();
        for leaf in (0..foliage.leaves().len()).map(LeafId::from_index) {
            known.clear();
            let corners = foliage.triangles_of(leaf).iter().flat_map(corners_of);
            for ((position, uv), corner) in corners.zip(0..) {
                let [x, y, z] = position.to_array();
                let key = [x, y, z, uv.x, uv.y].map(|v| (v + 0.0).to_bits());
                let vertex = *known.entry(key).or_insert_with(|| {
                    let relative = ((position - centre) / unit).as_vec3();
                    mesh.positions.push(relative.to_array());
                    mesh.corners.push(CornerRef { leaf, corner });
                    mesh.positions.len() as u32 - 1
                });
                mesh.indices.push(vertex);
            }
        }
        mesh.is_moved = vec![false; mesh.positions.len()];
        mesh
    }

    /// The vertices of triangles, three each: of these, as many as the target or fewer.
    fn simplified(&self, indices: &[u32], target: usize, mode: Mode) -> Vec<u32> {
        // meshoptimizer takes a mesh of at least a triangle.
        if target == 0 {
            return Vec::new();
        }
        let triangles = IndexedTriangles {
            positions: &self.positions,
            indices,
        };
        match mode {
            Mode::Plain => triangles.collapsed(target, SimplifyOptions::EMPTY),
            Mode::Prune => triangles.collapsed(target, SimplifyOptions::PRUNE),
            Mode::Sloppy => triangles.joined_in_cells(target),
            Mode::Clusters => clusters::cut(triangles, target, false).indices,
        }
    }

    fn place_of(&self, vertex: usize) -> Place {
        match self.is_moved[vertex] {
            true => {
                let position = glam::Vec3::from(self.positions[vertex]).as_dvec3();
                Place::At(self.centre + self.unit * position)
            }
            false => Place::Of(self.corners[vertex]),
        }
    }

    /// The leaves that changed and what is left of them, a new leaf for each
    /// that has something left.
    fn leaves_of(&self, foliage: &Foliage, kept: &[u32]) -> (Vec<LeafId>, Vec<NewLeaf>) {
        let mut of_leaf: Vec<Vec<[NewCorner; 3]>> = vec![Vec::new(); foliage.leaves().len()];
        for triangle in kept.as_chunks::<3>().0 {
            let donor = self.corners[triangle[0] as usize].leaf;
            let new = |vertex: u32| NewCorner {
                place: self.place_of(vertex as usize),
                // Another leaf's corner has the look of the one of its number,
                // which is the same corner where leaves are copies of a card.
                like: self.corners[vertex as usize].corner
                    % (3 * foliage.triangles_of(donor).len() as u32),
            };
            of_leaf[donor.index()].push(triangle.map(new));
        }
        let mut changed = (Vec::new(), Vec::new());
        for (index, triangles) in of_leaf.into_iter().enumerate() {
            let leaf = LeafId::from_index(index);
            let is_own = |c: &NewCorner| matches!(c.place, Place::Of(at) if at.leaf == leaf);
            if triangles.len() == foliage.triangles_of(leaf).len()
                && triangles.iter().flatten().all(is_own)
            {
                continue;
            }
            changed.0.push(leaf);
            if !triangles.is_empty() {
                let donor = leaf;
                changed.1.push(NewLeaf { donor, triangles });
            }
        }
        changed
    }
}

fn corners_of(triangle: &LeafTriangle) -> [(glam::DVec3, glam::DVec2); 3] {
    [0, 1, 2].map(|k| (triangle.corners[k], triangle.uvs[k]))
}

#[cfg(test)]
mod tests;
