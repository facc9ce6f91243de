//! Writes beside the vertices of an opened plant what they hang on, as `wind.rs` has it.

use std::collections::HashMap;
use std::collections::hash_map::Entry;
use std::sync::OnceLock;

use glam::{DMat4, DVec3};
use secateur_model::{Hold, LeafId};
use serde_json::{Value, json};

use crate::buffer::{Buffer, distinct_bytes};
use crate::error::{ALLOW_MORE, Fault, Problem};
use crate::parts::Part;
use crate::property::{push, remove};
use crate::survey::Survey;
use crate::{Document, GltfError, Tree, WholeTree, instances, wind};

const ARRAY_BUFFER: u32 = 34962;
const F32: u32 = 5126;
const U16: u32 = 5123;

impl WholeTree {
    /// Whether the file itself says what any of the plant hangs on.
    pub fn says_what_it_hangs_on(&self) -> bool {
        let Tree {
            document, parts, ..
        } = &self.tree;
        parts
            .iter()
            .any(|part| document.says_what_it_hangs_on(part.mesh, part.primitive))
    }

    /// The plant with attributes that say what its vertices hang on, in world space: a hold for each leaf, and for each
    /// corner of each triangle of the wood. Instances become nodes, and nodes that share a mesh get one each, of the
    /// same vertices.
    ///
    /// # Errors
    /// [`GltfError`] if the attributes take too much memory.
    ///
    /// # Panics
    /// If these are holds of another plant.
    pub fn hung(mut self, leaves: &[Hold], wood: &[[Hold; 3]]) -> Result<Self, GltfError> {
        assert_eq!(leaves.len(), self.leaves.leaves().len(), "one hold a leaf");
        assert_eq!(
            wood.len(),
            self.wood.triangles().len(),
            "three holds a triangle"
        );
        let hung = self.tree.hang(leaves, wood);
        hung.map_err(|fault| self.tree.document.error(fault))?;
        Ok(self)
    }

    /// The glTF document, with the attributes that [`hung`](Self::hung) added.
    pub fn into_document(self) -> Document {
        self.tree.document
    }
}

impl Tree {
    fn hang(&mut self, leaves: &[Hold], wood: &[[Hold; 3]]) -> Result<(), Fault> {
        self.spread_instances()?;
        let document = &self.document;
        let mut budget = document.budget;
        let survey = document.survey(&self.parts, &mut budget)?;
        let vertices = |part: usize| {
            survey.groups[survey.group_of_part[part]]
                .geometry
                .positions
                .len()
        };
        let count: usize = (0..self.parts.len()).map(vertices).sum();
        let bytes = (size_of::<Hold>() + wind::BYTES_A_VERTEX) as u64 * count as u64;
        let what = || format!("what its {count} vertices hang on");
        budget
            .take(bytes, what, ALLOW_MORE)
            .map_err(Problem::from)?;
        let holds = self.holds_of_parts(&survey, leaves, wood);
        self.part_meshes();
        self.document.put_holds(&self.parts, &holds);
        Ok(())
    }

    /// What each vertex of each part hangs on, in the part's own space.
    fn holds_of_parts(
        &self,
        survey: &Survey,
        leaves: &[Hold],
        wood: &[[Hold; 3]],
    ) -> Vec<Vec<Hold>> {
        let geometry = |part: usize| &survey.groups[survey.group_of_part[part]].geometry;
        // What no triangle has stays where it is.
        let on_itself = |position: &DVec3| Hold {
            segment: None,
            pivot: position.as_vec3(),
            along_m: 0.0,
        };
        let mut holds: Vec<Vec<Hold>> = (0..self.parts.len())
            .map(|part| geometry(part).positions.iter().map(on_itself).collect())
            .collect();
        let mut of_wood = wood.iter();
        for (index, source) in self.leaf_sources.iter().enumerate() {
            let part = source.part as usize;
            let is_wood = LeafId::from_index(index) >= self.first_of_wood;
            let into_part = IntoPart::of(&self.parts[part]);
            for &triangle in self.triangles_of(source) {
                let corners = geometry(part).triangles[triangle as usize];
                let held = match is_wood {
                    true => *of_wood.next().expect("holds of this wood"),
                    false => [leaves[index]; 3],
                };
                for (vertex, hold) in corners.into_iter().zip(held) {
                    if let Some(hold) = into_part.as_ref().and_then(|into| into.hold(hold)) {
                        holds[part][vertex as usize] = hold;
                    }
                }
            }
        }
        holds
    }

    /// Makes nodes of instances: vertices that they share cannot each hang on a place of their own.
    fn spread_instances(&mut self) -> Result<(), Fault> {
        let mut made: HashMap<(usize, usize), usize> = HashMap::new();
        let mut spread: HashMap<usize, Vec<DMat4>> = HashMap::new();
        for number in 0..self.parts.len() {
            let (node, Some(instance)) = (self.parts[number].node, self.parts[number].instance)
            else {
                continue;
            };
            if let Entry::Vacant(matrices) = spread.entry(node) {
                let instancing = self.document.instancing(node)?;
                let placed = instancing.map(|of| self.document.node_from_instances(&of));
                matrices.insert(placed.transpose()?.unwrap_or_default());
                let instanced = &mut self.document.root["nodes"][node];
                remove(instanced, "mesh");
                remove(&mut instanced["extensions"], instances::EXTENSION);
            }
            let root = &mut self.document.root;
            let part = &mut self.parts[number];
            part.node = *made.entry((node, instance)).or_insert_with(|| {
                let matrix = spread[&node][instance].to_cols_array();
                let own = json!({"mesh": part.mesh, "matrix": matrix});
                let own = push(root, "nodes", own);
                push(&mut root["nodes"][node], "children", own.into());
                own
            });
            part.instance = None;
        }
        Ok(())
    }

    /// Gives each node that draws a part of the plant a mesh of its own.
    fn part_meshes(&mut self) {
        let root = &mut self.document.root;
        let mut first_of_mesh: HashMap<usize, usize> = HashMap::new();
        let mut copies: HashMap<(usize, usize), usize> = HashMap::new();
        for part in &mut self.parts {
            match first_of_mesh.entry(part.mesh) {
                Entry::Vacant(first) => {
                    first.insert(part.node);
                }
                Entry::Occupied(first) if *first.get() == part.node => {}
                Entry::Occupied(_) => {
                    let copy = copies.entry((part.mesh, part.node)).or_insert_with(|| {
                        let mesh = root["meshes"][part.mesh].clone();
                        let copy = push(root, "meshes", mesh);
                        root["nodes"][part.node]["mesh"] = copy.into();
                        copy
                    });
                    part.mesh = *copy;
                }
            }
        }
    }
}

/// From world space to the space of a part.
struct IntoPart {
    local_from_world: DMat4,
    /// What becomes of lengths.
    lengths: f64,
}

impl IntoPart {
    /// None where the part is flattened.
    fn of(part: &Part) -> Option<Self> {
        let local_from_world = part.world_from_local.inverse();
        let lengths = local_from_world.determinant().abs().cbrt();
        local_from_world.is_finite().then_some(Self {
            local_from_world,
            lengths,
        })
    }

    /// None where that is no number.
    fn hold(&self, hold: Hold) -> Option<Hold> {
        let pivot = self
            .local_from_world
            .transform_point3(hold.pivot.as_dvec3());
        let local = Hold {
            pivot: pivot.as_vec3(),
            along_m: (f64::from(hold.along_m) * self.lengths) as f32,
            ..hold
        };
        (local.pivot.is_finite() && local.along_m.is_finite()).then_some(local)
    }
}

impl Document {
    /// Adds the attributes to the primitives of these parts, which have a mesh each.
    fn put_holds(&mut self, parts: &[Part], holds: &[Vec<Hold>]) {
        let mut bytes = Vec::new();
        let buffer = self.buffers.len();
        for (part, holds) in parts.iter().zip(holds) {
            let columns: [(&str, &str, u32, Vec<u8>); 3] = [
                (
                    wind::PIVOT,
                    "VEC3",
                    F32,
                    of_floats(holds.iter().flat_map(|hold| hold.pivot.to_array())),
                ),
                (
                    wind::ALONG,
                    "SCALAR",
                    F32,
                    of_floats(holds.iter().map(|hold| hold.along_m)),
                ),
                (
                    wind::SEGMENT,
                    "VEC2",
                    U16,
                    holds.iter().flat_map(number).collect(),
                ),
            ];
            for (name, shape, component, column) in columns {
                let view = json!({
                    "buffer": buffer,
                    "byteOffset": bytes.len(),
                    "byteLength": column.len(),
                    "target": ARRAY_BUFFER,
                });
                bytes.extend(column);
                self.decompressed_views.push(OnceLock::new());
                let accessor = json!({
                    "bufferView": push(&mut self.root, "bufferViews", view),
                    "componentType": component,
                    "count": holds.len(),
                    "type": shape,
                });
                let accessor = push(&mut self.root, "accessors", accessor);
                let primitive = &mut self.root["meshes"][part.mesh]["primitives"][part.primitive];
                primitive["attributes"][name] = Value::from(accessor);
            }
        }
        push(
            &mut self.root,
            "buffers",
            json!({"byteLength": bytes.len()}),
        );
        self.buffers.push(Buffer::of(bytes));
        self.data_bytes = distinct_bytes(&self.buffers);
        // As it came it has no such attributes.
        self.undecoded = None;
    }
}

fn of_floats(numbers: impl Iterator<Item = f32>) -> Vec<u8> {
    numbers.flat_map(f32::to_le_bytes).collect()
}

/// 1 + the number of the piece of wood, 0 for none, in 4 bytes.
fn number(hold: &Hold) -> [u8; 4] {
    let number = hold.segment.map_or(0, |segment| segment.index() as u32 + 1);
    number.to_le_bytes()
}
