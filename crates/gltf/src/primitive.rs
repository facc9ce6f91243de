//! Primitives: positions and triangles.

use glam::DVec3;
use serde_json::Value;

use super::Document;
use super::accessor::{Accessor, Component, Shape, is_index};
use super::error::{At, Fault, Problem};
use super::property;

/// How indices become triangles.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Topology {
    /// Points or lines: none.
    None,
    /// Mode 4: every three corners are a triangle.
    List,
    /// Mode 5: every corner makes a triangle with the two before it.
    Strip,
    /// Mode 6: every corner makes a triangle with the one before it and the first.
    Fan,
}

impl Topology {
    /// An upper bound of the triangles of this many indices; exact for a list.
    fn triangle_count(self, indices: usize) -> usize {
        match self {
            Self::None => 0,
            Self::List => indices / 3,
            Self::Strip | Self::Fan => indices.saturating_sub(2),
        }
    }

    /// The triangles of a run of indices. Strips join their pieces by triangles
    /// that name a vertex twice; those are left out.
    pub(crate) fn triangles(self, indices: &[u32]) -> Vec<[u32; 3]> {
        let proper = |t: &[u32; 3]| t[0] != t[1] && t[1] != t[2] && t[2] != t[0];
        match self {
            Self::None => Vec::new(),
            Self::List => indices.as_chunks().0.to_vec(),
            Self::Strip => (0..indices.len().saturating_sub(2))
                .map(|i| [indices[i], indices[i + 1 + i % 2], indices[i + 2 - i % 2]])
                .filter(proper)
                .collect(),
            Self::Fan => (1..indices.len().saturating_sub(1))
                .map(|i| [indices[i], indices[i + 1], indices[0]])
                .filter(proper)
                .collect(),
        }
    }
}

impl Document {
    /// What errors call a primitive, such as `meshes[0] "tree".primitives[1]`.
    pub(crate) fn primitive_place(&self, mesh: usize, primitive: usize) -> String {
        format!("{}.primitives[{primitive}]", self.place("meshes", mesh))
    }

    /// The JSON of a primitive.
    pub(crate) fn primitive(&self, mesh: usize, primitive: usize) -> Result<&Value, Fault> {
        let json = property::entry(&self.root, "meshes", mesh)?;
        property::entry(json, "primitives", primitive).at(|| self.place("meshes", mesh))
    }

    /// The accessor of a primitive's attribute, such as `POSITION`.
    pub(crate) fn attribute(
        &self,
        mesh: usize,
        primitive: usize,
        name: &str,
    ) -> Result<Option<usize>, Fault> {
        let json = self.primitive(mesh, primitive)?;
        let Some(value) = json.get("attributes").and_then(|a| a.get(name)) else {
            return Ok(None);
        };
        property::list_index("attributes", value)
            .map(Some)
            .at(|| self.primitive_place(mesh, primitive))
    }

    /// How the primitive's indices become triangles.
    pub(crate) fn topology(&self, mesh: usize, primitive: usize) -> Result<Topology, Fault> {
        let json = self.primitive(mesh, primitive)?;
        let read = || -> Result<Topology, Problem> {
            Ok(match property::whole(json, "mode")?.unwrap_or(4) {
                0..=3 => Topology::None,
                4 => Topology::List,
                5 => Topology::Strip,
                6 => Topology::Fan,
                other => {
                    return Err(Problem::BadProperty {
                        property: "mode",
                        expected: "0 to 6",
                        found: other.to_string(),
                    });
                }
            })
        };
        read().at(|| self.primitive_place(mesh, primitive))
    }

    fn position_accessor(&self, mesh: usize, primitive: usize) -> Result<Option<Accessor>, Fault> {
        let Some(index) = self.attribute(mesh, primitive, "POSITION")? else {
            return Ok(None);
        };
        let place = || self.primitive_place(mesh, primitive);
        let accessor = self.accessor(index)?;
        if accessor.shape != Shape::Vector(3) || accessor.component == Component::U32 {
            return Err(Problem::WrongKind {
                found: format!("{} ({})", self.place("accessors", index), accessor.kind()),
                role: "POSITION".to_owned(),
            })
            .at(place);
        }
        Ok(Some(accessor))
    }

    fn index_accessor(&self, mesh: usize, primitive: usize) -> Result<Option<Accessor>, Fault> {
        let json = self.primitive(mesh, primitive)?;
        let place = || self.primitive_place(mesh, primitive);
        let Some(index) = property::index(json, "indices").at(place)? else {
            return Ok(None);
        };
        let accessor = self.accessor(index)?;
        if !is_index(&accessor) {
            return Err(Problem::WrongKind {
                found: format!("{} ({})", self.place("accessors", index), accessor.kind()),
                role: "indices".to_owned(),
            })
            .at(place);
        }
        Ok(Some(accessor))
    }

    /// At most how many triangles a primitive has, without reading its data.
    pub(crate) fn triangle_bound(&self, mesh: usize, primitive: usize) -> Result<usize, Fault> {
        let Some(positions) = self.position_accessor(mesh, primitive)? else {
            return Ok(0);
        };
        let indices = self.index_accessor(mesh, primitive)?;
        let count = indices.map_or(positions.count, |accessor| accessor.count);
        Ok(self.topology(mesh, primitive)?.triangle_count(count))
    }

    /// How many vertices a primitive has, without reading its data.
    pub(crate) fn vertex_count(&self, mesh: usize, primitive: usize) -> Result<usize, Fault> {
        let positions = self.position_accessor(mesh, primitive)?;
        Ok(positions.map_or(0, |accessor| accessor.count))
    }

    /// How many bytes of positions and indices a primitive has that are not in the
    /// file, but zeros for want of a bufferView.
    pub(crate) fn zero_bytes(&self, mesh: usize, primitive: usize) -> Result<u64, Fault> {
        let positions = self.position_accessor(mesh, primitive)?;
        let indices = self.index_accessor(mesh, primitive)?;
        let without_data = [positions, indices]
            .into_iter()
            .flatten()
            .filter(|a| a.view.is_none());
        Ok(without_data
            .map(|a| (a.count * a.element_bytes()) as u64)
            .sum())
    }

    /// The positions of a primitive's vertices in its own space, dequantised;
    /// none where it has no POSITION. All are finite.
    pub(crate) fn positions(&self, mesh: usize, primitive: usize) -> Result<Vec<DVec3>, Fault> {
        let Some(accessor) = self.position_accessor(mesh, primitive)? else {
            return Ok(Vec::new());
        };
        let elements = self.elements(accessor.index)?;
        let positions: Vec<DVec3> = elements.vectors().map(DVec3::from_array).collect();
        match positions.iter().position(|p| !p.is_finite()) {
            None => Ok(positions),
            Some(index) => Err(Problem::NotFinite {
                what: "position",
                index,
            })
            .at(|| self.place("accessors", accessor.index)),
        }
    }

    /// A primitive's triangles as indices into its vertices, whatever its mode:
    /// the triangle numbers of leaves count in this list. None where it has no
    /// POSITION or is points or lines. All indices are in range.
    pub(crate) fn triangles(&self, mesh: usize, primitive: usize) -> Result<Vec<[u32; 3]>, Fault> {
        let Some(positions) = self.position_accessor(mesh, primitive)? else {
            return Ok(Vec::new());
        };
        let topology = self.topology(mesh, primitive)?;
        let place = || self.primitive_place(mesh, primitive);
        let indices = match self.index_accessor(mesh, primitive)? {
            Some(accessor) => self.elements(accessor.index)?.indices(),
            None => {
                let count = u32::try_from(positions.count).map_err(|_| Problem::TooMuch {
                    what: "vertices",
                    limit: u64::from(u32::MAX),
                });
                (0..count.at(place)?).collect()
            }
        };
        let stray = indices.iter().position(|&v| v as usize >= positions.count);
        if let Some(position) = stray {
            return Err(Problem::NoSuchVertex {
                position,
                vertex: indices[position],
                count: positions.count,
            })
            .at(place);
        }
        Ok(topology.triangles(&indices))
    }
}
