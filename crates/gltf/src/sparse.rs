//! Sparse accessors: elements that replace others.

use std::borrow::Cow;

use super::Document;
use super::accessor::{Accessor, Component, Elements, Shape, is_index};
use super::error::{At, Fault, Problem};
use super::property;

/// Where the replacing elements are, from an accessor's `sparse`.
struct Sparse {
    count: usize,
    component: Component,
    index_view: usize,
    index_offset: usize,
    value_view: usize,
    value_offset: usize,
}

impl Document {
    /// Puts the elements of an accessor's `sparse` into its tightly packed
    /// bytes.
    pub(super) fn substitute_sparse(
        &self,
        accessor: &Accessor,
        bytes: &mut [u8],
    ) -> Result<(), Fault> {
        let place = || format!("{}.sparse", self.place("accessors", accessor.index));
        let sparse = self.sparse(accessor.index).at(place)?;
        let index_accessor = Accessor {
            count: sparse.count,
            component: sparse.component,
            shape: Shape::Scalar,
            ..*accessor
        };
        if !is_index(&index_accessor) {
            return Err(Problem::WrongKind {
                found: index_accessor.kind(),
                role: "sparse indices".to_owned(),
            })
            .at(place);
        }
        let size = accessor.element_bytes();
        let packed = |view, offset: usize, size: usize| -> Result<Cow<'_, [u8]>, Fault> {
            let held = self.held_view(view)?;
            let end = offset as u128 + sparse.count as u128 * size as u128;
            self.check_range(view, offset as u128, end, held.len() as u64)
                .at(place)?;
            let bytes = held.bytes(offset..end as usize);
            bytes.at(place)
        };
        let index_bytes = packed(
            sparse.index_view,
            sparse.index_offset,
            sparse.component.bytes(),
        )?;
        let values = packed(sparse.value_view, sparse.value_offset, size)?;
        let indices = Elements {
            accessor: index_accessor,
            bytes: index_bytes,
        }
        .indices();
        put_in(bytes, size, accessor.count, &indices, &values).at(place)
    }

    fn sparse(&self, accessor: usize) -> Result<Sparse, Problem> {
        let json = &self.root["accessors"][accessor]["sparse"];
        let part = |name| json.get(name).ok_or(Problem::Missing(name));
        let (indices, values) = (part("indices")?, part("values")?);
        Ok(Sparse {
            count: property::required_index(json, "count")?,
            component: Component::from_code(indices)?,
            index_view: property::required_index(indices, "bufferView")?,
            index_offset: property::index(indices, "byteOffset")?.unwrap_or(0),
            value_view: property::required_index(values, "bufferView")?,
            value_offset: property::index(values, "byteOffset")?.unwrap_or(0),
        })
    }
}

fn put_in(
    bytes: &mut [u8],
    size: usize,
    count: usize,
    indices: &[u32],
    values: &[u8],
) -> Result<(), Problem> {
    let mut least = 0u64;
    for (&index, value) in indices.iter().zip(values.chunks_exact(size)) {
        let index = u64::from(index);
        if index < least || index >= count as u64 {
            return Err(Problem::BadSparseIndex { index, count });
        }
        least = index + 1;
        let at = index as usize * size;
        bytes[at..at + size].copy_from_slice(value);
    }
    Ok(())
}
