//! Parts: every primitive as every node or instance draws it.

use std::sync::Arc;

use glam::{DMat4, DVec3};

use super::Document;
use super::error::{ALLOW_MORE, At, Fault, Problem};
use super::property;
use super::roles::Role;
use super::survey::Geometry;

/// The most parts a file may have.
pub(crate) const MAX_PARTS: u64 = 1 << 20;

/// The most triangles a file may draw, every instance counted.
pub(crate) const MAX_TRIANGLES: u64 = 64 << 20;

/// What a part takes while it is made: itself, its matrix and what that is composed of.
pub(crate) const BYTES_A_PART: u64 = 2 * size_of::<Part>() as u64 + 256;

/// One primitive as one node (or one instance of it) draws it.
#[derive(Clone, Debug)]
pub(crate) struct Part {
    /// Index in `nodes` of the node that draws it.
    pub(crate) node: usize,
    /// Which instance, where the node has EXT_mesh_gpu_instancing.
    pub(crate) instance: Option<usize>,
    /// Index in `meshes` of the mesh that it belongs to.
    pub(crate) mesh: usize,
    /// Index in the mesh's `primitives`.
    pub(crate) primitive: usize,
    /// From the primitive's own space to world space.
    pub(crate) world_from_local: DMat4,
    /// What it is.
    pub(crate) role: Role,
    /// Which pieces of its primitive are wood, where it is one of leaves that has some.
    pub(crate) wood_pieces: Option<Arc<[bool]>>,
}

impl Part {
    /// What a piece of its primitive is.
    pub(crate) fn role_of(&self, piece: usize) -> Role {
        match &self.wood_pieces {
            Some(is_wood) if is_wood[piece] => Role::Wood,
            Some(_) | None => self.role,
        }
    }

    /// The triangles that are leaves, or those that are not, as numbers in its primitive's list.
    pub(crate) fn triangles_that(&self, are_leaves: bool, geometry: &Geometry) -> Vec<u32> {
        let all = geometry.triangles.len() as u32;
        let Some(is_wood) = &self.wood_pieces else {
            let has_all = (self.role == Role::Leaf) == are_leaves;
            return if has_all {
                (0..all).collect()
            } else {
                Vec::new()
            };
        };
        let pieces = geometry.pieces().iter().zip(&**is_wood);
        let chosen = pieces.filter(|(_, is_wood)| **is_wood != are_leaves);
        let mut triangles: Vec<u32> = chosen.flat_map(|(piece, _)| piece).copied().collect();
        triangles.sort_unstable();
        triangles
    }

    /// Whether a piece of it has this role, leaf or wood.
    pub(crate) fn has(&self, role: Role) -> bool {
        self.role == role || (role == Role::Wood && self.wood_pieces.is_some())
    }

    /// A vertex in world space.
    pub(super) fn place_vertex(&self, vertex: usize, local: DVec3) -> Result<DVec3, Problem> {
        let world = self.world_from_local.transform_point3(local);
        if world.is_finite() {
            return Ok(world);
        }
        Err(Problem::NotFinite {
            what: "the world position of vertex",
            index: vertex,
        })
    }
}

impl Document {
    /// The parts of the scene, without those of coarser levels, in depth-first order of the nodes, instance by
    /// instance, primitive by primitive; all are taken for wood yet. Their number and
    /// that of their triangles are within the limits.
    pub(crate) fn parts(&self) -> Result<Vec<Part>, Fault> {
        let mut parts = Vec::new();
        let mut budget = self.budget;
        let mut triangles = 0u64;
        let levels = self.levels_inside()?;
        let placed = self.placed_nodes()?.into_iter();
        for node in placed.filter(|node| !levels.nodes.contains(&node.index)) {
            let json = property::entry(&self.root, "nodes", node.index)?;
            let place = || self.place("nodes", node.index);
            let Some(mesh) = property::index(json, "mesh").at(place)? else {
                continue;
            };
            let mesh_json = property::entry(&self.root, "meshes", mesh).at(place)?;
            let primitives = property::list(mesh_json, "primitives")
                .at(|| self.place("meshes", mesh))?
                .len();
            if primitives == 0 {
                continue;
            }
            let instancing = self.instancing(node.index)?;
            let placements = instancing.as_ref().map_or(1, |i| i.count as u64);
            check_limit(
                "parts (nodes x instances x primitives)",
                parts.len() as u64 + placements.saturating_mul(primitives as u64),
                MAX_PARTS,
            )
            .at(place)?;
            let new_parts = placements * primitives as u64;
            budget
                .take(
                    BYTES_A_PART * new_parts,
                    || format!("{new_parts} placements of its primitives"),
                    ALLOW_MORE,
                )
                .map_err(Problem::from)
                .at(place)?;
            for primitive in 0..primitives {
                let bound = self.triangle_bound(mesh, primitive)? as u64;
                triangles += bound.saturating_mul(placements);
                check_limit("triangles", triangles, MAX_TRIANGLES).at(place)?;
            }
            let matrices = match &instancing {
                None => vec![(None, node.world_from_node)],
                Some(instancing) => self
                    .node_from_instances(instancing)?
                    .into_iter()
                    .enumerate()
                    .map(|(i, matrix)| (Some(i), node.world_from_node * matrix))
                    .collect(),
            };
            for (instance, world_from_local) in matrices {
                parts.extend((0..primitives).map(|primitive| Part {
                    node: node.index,
                    instance,
                    mesh,
                    primitive,
                    world_from_local,
                    role: Role::Wood,
                    wood_pieces: None,
                }));
            }
        }
        Ok(parts)
    }
}

/// Refuses more than a limit.
pub(super) fn check_limit(what: &'static str, found: u64, limit: u64) -> Result<(), Problem> {
    if found > limit {
        return Err(Problem::TooMuch { what, limit });
    }
    Ok(())
}
