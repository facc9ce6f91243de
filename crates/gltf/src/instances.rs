//! EXT_mesh_gpu_instancing: many placements of one node's mesh.

use glam::{DMat4, DVec3};

use super::Document;
use super::accessor::{Component, Shape};
use super::error::{At, Fault, Problem};
use super::node::compose;
use super::property;

/// The glTF extension that draws a node's mesh in many places.
pub(crate) const EXTENSION: &str = "EXT_mesh_gpu_instancing";

/// The accessors of a node's instances.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Instancing {
    node: usize,
    /// How many instances there are.
    pub(crate) count: usize,
    translation: Option<usize>,
    rotation: Option<usize>,
    scale: Option<usize>,
}

impl Document {
    /// How a node's mesh is instanced, or `None` where it is drawn once. No
    /// data is read.
    pub(crate) fn instancing(&self, node: usize) -> Result<Option<Instancing>, Fault> {
        let json = property::entry(&self.root, "nodes", node)?;
        let Some(attributes) =
            property::extension(json, EXTENSION).and_then(|e| e.get("attributes"))
        else {
            return Ok(None);
        };
        let place = || format!("{}.{EXTENSION}", self.place("nodes", node));
        let mut count = None;
        let mut find = |name: &str, width: usize| -> Result<Option<usize>, Fault> {
            let Some(value) = attributes.get(name) else {
                return Ok(None);
            };
            let index = property::list_index("attributes", value).at(place)?;
            let accessor = self.accessor(index)?;
            if accessor.shape != Shape::Vector(width) || accessor.component == Component::U32 {
                return Err(Problem::WrongKind {
                    found: accessor.kind(),
                    role: name.to_owned(),
                })
                .at(place);
            }
            match *count.get_or_insert(accessor.count) {
                same if same == accessor.count => Ok(Some(index)),
                other => Err(Problem::CountMismatch {
                    attribute: name.to_owned(),
                    found: accessor.count,
                    other: "the attribute before it".to_owned(),
                    expected: other,
                })
                .at(place),
            }
        };
        let translation = find("TRANSLATION", 3)?;
        let rotation = find("ROTATION", 4)?;
        let scale = find("SCALE", 3)?;
        Ok(count.map(|count| Instancing {
            node,
            count,
            translation,
            rotation,
            scale,
        }))
    }

    /// From each instance's space to the node's.
    pub(crate) fn node_from_instances(&self, instancing: &Instancing) -> Result<Vec<DMat4>, Fault> {
        let place = || format!("{}.{EXTENSION}", self.place("nodes", instancing.node));
        let count = instancing.count;
        let translations = self.vectors_or(instancing.translation, [0.0; 3], count)?;
        let rotations = self.vectors_or(instancing.rotation, [0.0, 0.0, 0.0, 1.0], count)?;
        let scales = self.vectors_or(instancing.scale, [1.0; 3], count)?;
        (0..count)
            .map(|i| {
                let matrix = compose(
                    DVec3::from_array(translations[i]),
                    rotations[i],
                    DVec3::from_array(scales[i]),
                );
                if matrix.is_finite() && rotations[i].iter().all(|x| x.is_finite()) {
                    Ok(matrix)
                } else {
                    Err(Problem::NotFinite {
                        what: "the transform of instance",
                        index: i,
                    })
                    .at(place)
                }
            })
            .collect()
    }

    fn vectors_or<const N: usize>(
        &self,
        accessor: Option<usize>,
        otherwise: [f64; N],
        count: usize,
    ) -> Result<Vec<[f64; N]>, Fault> {
        match accessor {
            Some(index) => Ok(self.elements(index)?.vectors().collect()),
            None => Ok(vec![otherwise; count]),
        }
    }
}
