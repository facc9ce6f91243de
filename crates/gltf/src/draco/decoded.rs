//! Decoding what accessors of compressed primitives stand for.

use std::panic::{AssertUnwindSafe, catch_unwind};

use draco_core::{DataType, Mesh, PointAttribute, PointIndex};

use super::{Compressed, Decoded, Key, Part};
use crate::accessor::{Accessor, Component};
use crate::error::Problem;

impl Decoded {
    /// Decodes what accessors of a primitive stand for and is not known yet.
    pub(super) fn add(&mut self, one: &Compressed, stream: &[u8]) -> Result<(), Problem> {
        // The decoder is no code of ours, and hostile files must not end the program.
        let added = catch_unwind(AssertUnwindSafe(|| {
            let mesh = one.mesh(stream)?;
            for ((name, id, accessor), key) in one.attributes.iter().zip(one.keys()) {
                if self.known.insert(key) {
                    let attribute = mesh.attribute_by_unique_id(*id);
                    let attribute = attribute.ok_or_else(|| wrong_kind(accessor, name))?;
                    self.add_attribute(key, name, accessor, attribute, mesh.num_points())?;
                }
            }
            if let Some(key) = one.keys().last().filter(|key| self.known.insert(*key)) {
                self.add_indices(key, one.indices.as_ref(), &mesh);
            }
            Ok(())
        }));
        added.unwrap_or_else(|_| Err(Problem::Draco("it is damaged".to_owned())))
    }

    fn add_attribute(
        &mut self,
        key: Key,
        name: &str,
        accessor: &Accessor,
        attribute: &PointAttribute,
        count: usize,
    ) -> Result<(), Problem> {
        let components = accessor.shape.components();
        let kind = attribute.data_type();
        let is_float = matches!(kind, DataType::Float32 | DataType::Float64);
        if usize::from(attribute.num_components()) != components
            || is_float != (accessor.component == Component::F32)
        {
            return Err(wrong_kind(accessor, name));
        }
        let stride = stride(accessor);
        let start = self.bytes.len();
        let mut bounds = [
            vec![f64::INFINITY; components],
            vec![f64::NEG_INFINITY; components],
        ];
        let data = attribute.buffer().data();
        let size = kind.byte_length();
        for point in 0..count {
            let value = attribute.mapped_index(PointIndex(point as u32)).0 as usize;
            let at = value.checked_mul(components * size);
            let bytes = at.and_then(|at| data.get(at..at.checked_add(components * size)?));
            let bytes = bytes.ok_or_else(|| Problem::Draco(format!("{name} ends too early")))?;
            for (component, bytes) in bytes.chunks_exact(size.max(1)).enumerate() {
                let number = number(kind, bytes);
                accessor.component.push(number, &mut self.bytes);
                bounds[0][component] = bounds[0][component].min(number);
                bounds[1][component] = bounds[1][component].max(number);
            }
            let end = start + (point + 1) * stride;
            self.bytes.resize(end, 0);
        }
        self.finish(Part {
            key,
            component: accessor.component,
            count,
            range: start..self.bytes.len(),
            stride: (stride != accessor.element_bytes()).then_some(stride),
            bounds: (name == "POSITION" && count > 0).then_some(bounds),
        });
        Ok(())
    }

    fn add_indices(&mut self, key: Key, accessor: Option<&Accessor>, mesh: &Mesh) {
        // The greatest number of a type is not allowed as an index.
        let largest = match accessor.map(|accessor| accessor.component) {
            Some(Component::U8) => usize::from(u8::MAX),
            Some(Component::U16) => usize::from(u16::MAX),
            Some(Component::I8 | Component::I16 | Component::U32 | Component::F32) | None => 0,
        };
        let component = accessor.map(|accessor| accessor.component);
        let component = component.filter(|_| mesh.num_points() <= largest);
        let component = component.unwrap_or(Component::U32);
        let start = self.bytes.len();
        for corner in mesh.faces().iter().flatten() {
            component.push(f64::from(corner.0), &mut self.bytes);
        }
        self.finish(Part {
            key,
            component,
            count: 3 * mesh.num_faces(),
            range: start..self.bytes.len(),
            stride: None,
            bounds: None,
        });
    }

    fn finish(&mut self, part: Part) {
        self.parts.push(part);
        self.bytes.resize(self.bytes.len().next_multiple_of(4), 0);
    }
}

/// Bytes from one vertex to the next, a multiple of four as glTF wants it.
pub(super) fn stride(accessor: &Accessor) -> usize {
    accessor.element_bytes().next_multiple_of(4)
}

/// A number of this type from its little-endian bytes.
fn number(kind: DataType, bytes: &[u8]) -> f64 {
    let mut wide = [0; 8];
    wide[..bytes.len()].copy_from_slice(bytes);
    let unsigned = u64::from_le_bytes(wide);
    match kind {
        DataType::Int8 => f64::from(unsigned as i8),
        DataType::Int16 => f64::from(unsigned as i16),
        DataType::Int32 => f64::from(unsigned as i32),
        DataType::Int64 => unsigned as i64 as f64,
        DataType::Float32 => f64::from(f32::from_bits(unsigned as u32)),
        DataType::Float64 => f64::from_bits(unsigned),
        DataType::Uint8
        | DataType::Uint16
        | DataType::Uint32
        | DataType::Uint64
        | DataType::Bool
        | DataType::Invalid => unsigned as f64,
    }
}

pub(super) fn wrong_kind(accessor: &Accessor, name: &str) -> Problem {
    Problem::WrongKind {
        found: format!("accessors[{}] ({})", accessor.index, accessor.kind()),
        role: format!("{name} of its Draco data"),
    }
}
