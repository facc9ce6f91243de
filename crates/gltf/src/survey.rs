//! The primitives of a scene, each looked at once however often it is drawn.

use std::collections::HashMap;
use std::sync::OnceLock;

use glam::DVec3;

use super::Document;
use super::error::{ALLOW_MORE, Fault, Problem};
use super::leaves::{Leaves, find_leaves};
use super::material::MaterialLook;
use super::parts::{BYTES_A_PART, Part, check_limit};
use super::selector::{Label, Labels};
use secateur_model::Budget;

/// A primitive and where it is drawn.
pub(crate) struct Group {
    pub(crate) mesh: usize,
    pub(crate) primitive: usize,
    /// The nodes that draw it, in traversal order.
    pub(crate) nodes: Vec<usize>,
    /// How often it is drawn, instances counted.
    pub(crate) placements: usize,
    pub(crate) look: MaterialLook,
    pub(crate) geometry: Geometry,
}

/// A primitive's triangles in its own space.
pub(crate) struct Geometry {
    pub(crate) positions: Vec<DVec3>,
    pub(crate) triangles: Vec<[u32; 3]>,
    /// Found when they are first asked for: what is only drawn does without.
    pieces: OnceLock<Leaves>,
}

impl Geometry {
    /// Its connected pieces, which are its leaves if it is foliage.
    pub(crate) fn pieces(&self) -> &Leaves {
        let find = || find_leaves(&self.positions, &self.triangles);
        self.pieces.get_or_init(find)
    }
}

/// The groups of a scene.
pub(crate) struct Survey {
    pub(crate) groups: Vec<Group>,
    /// The group of each part.
    pub(crate) group_of_part: Vec<usize>,
}

/// What a vertex or a triangle takes while pieces are looked for.
const BYTES_A_CORNER: u64 = 100;

/// The most vertices of all primitives that are drawn, each primitive counted
/// once: a buffer that primitives share counts for each of them.
const MAX_VERTICES: u64 = 64 << 20;

impl Document {
    /// Reads every primitive that is drawn.
    ///
    /// # Errors
    /// [`Problem::Memory`] and whatever is wrong with the geometry.
    pub(crate) fn survey(&self, parts: &[Part], budget: &mut Budget) -> Result<Survey, Fault> {
        let of_parts = || "the placements of its primitives".to_owned();
        let taken = budget.take(BYTES_A_PART * parts.len() as u64, of_parts, ALLOW_MORE);
        taken.map_err(Problem::from)?;
        let mut known: HashMap<(usize, usize), usize> = HashMap::new();
        let mut groups: Vec<Group> = Vec::new();
        let mut group_of_part = Vec::with_capacity(parts.len());
        let mut vertices = 0;
        let mut zero_bytes = 0;
        for part in parts {
            let key = (part.mesh, part.primitive);
            let index = match known.get(&key) {
                Some(&index) => index,
                None => {
                    vertices += self.vertex_count(part.mesh, part.primitive)? as u64;
                    check_limit("vertices", vertices, MAX_VERTICES)?;
                    zero_bytes += self.zero_bytes(part.mesh, part.primitive)?;
                    let what = "bytes of vertices and indices without data";
                    check_limit(what, zero_bytes, self.max_zero_bytes())?;
                    let corners = self.triangle_bound(part.mesh, part.primitive)? as u64
                        + self.vertex_count(part.mesh, part.primitive)? as u64;
                    let geometry = || "its vertices and triangles".to_owned();
                    let taken = budget.take(BYTES_A_CORNER * corners, geometry, ALLOW_MORE);
                    taken.map_err(Problem::from)?;
                    groups.push(self.group(part)?);
                    known.insert(key, groups.len() - 1);
                    groups.len() - 1
                }
            };
            let group = &mut groups[index];
            group.placements += 1;
            // Parts of one node follow each other, but for its other primitives.
            if group.nodes.last() != Some(&part.node) {
                group.nodes.push(part.node);
            }
            group_of_part.push(index);
        }
        Ok(Survey {
            groups,
            group_of_part,
        })
    }

    fn group(&self, part: &Part) -> Result<Group, Fault> {
        let positions = self.positions(part.mesh, part.primitive)?;
        let triangles = self.triangles(part.mesh, part.primitive)?;
        Ok(Group {
            mesh: part.mesh,
            primitive: part.primitive,
            nodes: Vec::new(),
            placements: 0,
            look: self.look(part.mesh, part.primitive)?,
            geometry: Geometry {
                positions,
                triangles,
                pieces: OnceLock::new(),
            },
        })
    }

    /// What an entry of a list is called.
    pub(crate) fn label(&self, list: &str, index: usize) -> Label<'_> {
        let entry = self.root.get(list).and_then(|l| l.get(index));
        let name = entry.and_then(|e| e.get("name")).and_then(|n| n.as_str());
        Label {
            name: name.unwrap_or(""),
            index: Some(index),
        }
    }

    /// What a group is called where this node draws it.
    pub(crate) fn labels<'a>(&'a self, group: &'a Group, node: usize) -> Labels<'a> {
        Labels {
            material: Label {
                name: &group.look.name,
                index: group.look.material,
            },
            mesh: self.label("meshes", group.mesh),
            node: self.label("nodes", node),
        }
    }
}
