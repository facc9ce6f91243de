//! All bytes that are still named, packed into one buffer.

use std::borrow::Cow;
use std::collections::{BTreeMap, HashMap, HashSet};
use std::ops::Range;

use serde_json::Value;

use super::references::{as_index, items, len};
use crate::buffer::Buffer;
use crate::error::Problem;

/// Bytes keep their place modulo this, so that every component stays aligned.
const ALIGNMENT: usize = 4;

/// Where the bytes of a view come from.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Source {
    Buffer(usize),
    /// Bytes made for this view alone.
    View(usize),
}

/// The bytes behind a file's buffer views.
pub(super) struct ViewBytes<'a> {
    /// The buffers of the input, in its order.
    pub(super) buffers: Vec<&'a Buffer>,
    /// Bytes that replace what a view has in its buffer.
    pub(super) own: HashMap<usize, Cow<'a, [u8]>>,
    /// Views that lost an accessor: of these only what the remaining accessors
    /// name is packed.
    pub(super) partly_used: HashSet<usize>,
}

/// Why the bytes of buffer views can't be packed.
#[derive(Debug)]
pub(super) enum PackProblem {
    /// The bytes of this view are not there.
    OutOfRange(usize),
    /// A buffer can't be read.
    Unreadable(Problem),
}

/// Packs what the buffer views of `root` name into one buffer and points them
/// to it. Bytes that several views share stay shared.
pub(super) fn pack(root: &mut Value, bytes: &ViewBytes) -> Result<Vec<u8>, PackProblem> {
    let views = (0..len(root, "bufferViews"))
        .map(|view| source_range(root, bytes, view))
        .collect::<Result<Vec<_>, _>>()?;
    let live = live_ranges(root, bytes, &views);
    let copied = copy_ranges(bytes, &views, &live);
    let (packed, map) = copied.map_err(PackProblem::Unreadable)?;
    for (view, fields) in items(root, "bufferViews").enumerate() {
        let (source, range) = &views[view];
        let (Some(first), Some(last)) = (live[view].first(), live[view].last()) else {
            continue;
        };
        let start = map.new_offset(*source, range.start + first.start);
        let end = map.new_offset(*source, range.start + last.end - 1) + 1;
        fields["buffer"] = 0.into();
        fields["byteOffset"] = start.into();
        fields["byteLength"] = (end - start).into();
    }
    move_accessors(root, bytes, |view, offset| {
        let (source, range) = &views[view];
        let start = map.new_offset(*source, range.start + live[view].first()?.start);
        Some(map.new_offset(*source, range.start + offset) - start)
    });
    Ok(packed)
}

/// The source of a view's bytes and their place in it.
fn source_range(
    root: &Value,
    bytes: &ViewBytes,
    view: usize,
) -> Result<(Source, Range<usize>), PackProblem> {
    if let Some(own) = bytes.own.get(&view) {
        return Ok((Source::View(view), 0..own.len()));
    }
    let fields = &root["bufferViews"][view];
    let range = || {
        let buffer = as_index(&fields["buffer"])?;
        let start = as_index(fields.get("byteOffset").unwrap_or(&Value::from(0)))?;
        let end = start.checked_add(as_index(&fields["byteLength"])?)?;
        let available = bytes.buffers.get(buffer)?.len();
        (start < end && end <= available).then_some((Source::Buffer(buffer), start..end))
    };
    range().ok_or(PackProblem::OutOfRange(view))
}

/// For each view what has to stay of it: sorted, disjoint, relative to it.
fn live_ranges(
    root: &mut Value,
    bytes: &ViewBytes,
    views: &[(Source, Range<usize>)],
) -> Vec<Vec<Range<usize>>> {
    let mut live: Vec<Vec<Range<usize>>> = vec![Vec::new(); views.len()];
    for part in accessor_parts(root) {
        if let (true, Some(range)) = (bytes.partly_used.contains(&part.view), part.range) {
            live[part.view].push(range);
        }
    }
    for (view, ranges) in live.iter_mut().enumerate() {
        let whole = 0..views[view].1.len();
        for range in ranges.iter_mut() {
            *range = range.start.min(whole.end)..range.end.min(whole.end);
        }
        ranges.retain(|range| !range.is_empty());
        if ranges.is_empty() {
            ranges.push(whole);
        }
        merge(ranges);
    }
    live
}

/// What an accessor, or a part of a sparse one, names of its view.
struct AccessorPart {
    view: usize,
    /// `None` where it can't be told.
    range: Option<Range<usize>>,
}

fn accessor_parts(root: &mut Value) -> Vec<AccessorPart> {
    let strides: Vec<Option<usize>> = items(root, "bufferViews")
        .map(|view| view.get("byteStride").and_then(as_index))
        .collect();
    let mut parts = Vec::new();
    for accessor in items(root, "accessors") {
        let element = element_bytes(&accessor["componentType"], &accessor["type"]);
        push_part(&mut parts, accessor, &accessor["count"], element, &strides);
        let Some(sparse) = accessor.get("sparse") else {
            continue;
        };
        let (indices, values) = (&sparse["indices"], &sparse["values"]);
        let index = element_bytes(&indices["componentType"], &Value::from("SCALAR"));
        push_part(&mut parts, indices, &sparse["count"], index, &[]);
        push_part(&mut parts, values, &sparse["count"], element, &[]);
    }
    parts
}

fn push_part(
    parts: &mut Vec<AccessorPart>,
    fields: &Value,
    count: &Value,
    element_bytes: Option<usize>,
    strides: &[Option<usize>],
) {
    let Some(view) = fields.get("bufferView").and_then(as_index) else {
        return;
    };
    let offset = fields.get("byteOffset").and_then(as_index).unwrap_or(0);
    let stride = strides.get(view).copied().flatten();
    let range = || match stride.filter(|&stride| stride > 0) {
        // Whole strides, so that the view stays longer than its stride.
        Some(stride) => {
            let first = offset / stride;
            let end = first.checked_add(as_index(count)?)?.checked_mul(stride)?;
            Some(first * stride..end)
        }
        None => {
            let length = as_index(count)?.checked_mul(element_bytes?)?;
            Some(offset..offset.checked_add(length)?)
        }
    };
    parts.push(AccessorPart {
        view,
        range: range(),
    });
}

/// Bytes of one element, the columns of matrices padded to four bytes.
fn element_bytes(component_type: &Value, kind: &Value) -> Option<usize> {
    let component = match component_type.as_u64()? {
        5120 | 5121 => 1,
        5122 | 5123 => 2,
        5125 | 5126 => 4,
        _ => return None,
    };
    let columns = |n: usize| n * (n * component).next_multiple_of(ALIGNMENT);
    Some(match kind.as_str()? {
        "SCALAR" => component,
        "VEC2" => 2 * component,
        "VEC3" => 3 * component,
        "VEC4" => 4 * component,
        "MAT2" => columns(2),
        "MAT3" => columns(3),
        "MAT4" => columns(4),
        _ => return None,
    })
}

fn merge(ranges: &mut Vec<Range<usize>>) {
    ranges.sort_by_key(|range| (range.start, range.end));
    ranges.dedup_by(|next, kept| {
        let touches = next.start <= kept.end;
        if touches {
            kept.end = kept.end.max(next.end);
        }
        touches
    });
}

/// Where the ranges that were copied went.
struct OffsetMap(BTreeMap<Source, Vec<(Range<usize>, usize)>>);

impl OffsetMap {
    fn new_offset(&self, source: Source, offset: usize) -> usize {
        let moves = &self.0[&source];
        let next = moves.partition_point(|(range, _)| range.start <= offset);
        let (range, new_start) = &moves[next.saturating_sub(1)];
        new_start + offset.saturating_sub(range.start)
    }
}

fn copy_ranges(
    bytes: &ViewBytes,
    views: &[(Source, Range<usize>)],
    live: &[Vec<Range<usize>>],
) -> Result<(Vec<u8>, OffsetMap), Problem> {
    let mut wanted: BTreeMap<Source, Vec<Range<usize>>> = BTreeMap::new();
    for ((source, view), ranges) in views.iter().zip(live) {
        let absolute = ranges
            .iter()
            .map(|range| view.start + range.start..view.start + range.end);
        wanted.entry(*source).or_default().extend(absolute);
    }
    let mut packed = Vec::new();
    let mut map: BTreeMap<Source, Vec<_>> = BTreeMap::new();
    for (source, mut ranges) in wanted {
        merge(&mut ranges);
        let moves = map.entry(source).or_default();
        for range in ranges {
            let gap = (range.start + ALIGNMENT - packed.len() % ALIGNMENT) % ALIGNMENT;
            packed.resize(packed.len() + gap, 0);
            moves.push((range.clone(), packed.len()));
            match source {
                Source::Buffer(buffer) => bytes.buffers[buffer].append_to(&mut packed, range)?,
                Source::View(view) => packed.extend_from_slice(&bytes.own[&view][range]),
            }
        }
    }
    Ok((packed, OffsetMap(map)))
}

/// Gives the accessors of partly used views their new offsets.
fn move_accessors(
    root: &mut Value,
    bytes: &ViewBytes,
    new_offset: impl Fn(usize, usize) -> Option<usize>,
) {
    let move_part = |fields: &mut Value| {
        let view = fields.get("bufferView").and_then(as_index);
        let Some(view) = view.filter(|view| bytes.partly_used.contains(view)) else {
            return;
        };
        let offset = fields.get("byteOffset").and_then(as_index).unwrap_or(0);
        if let Some(moved) = new_offset(view, offset).filter(|&moved| moved != offset) {
            fields["byteOffset"] = moved.into();
        }
    };
    for accessor in items(root, "accessors") {
        move_part(accessor);
        if let Some(sparse) = accessor.get_mut("sparse") {
            for part in ["indices", "values"] {
                if let Some(part) = sparse.get_mut(part) {
                    move_part(part);
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    fn view_bytes(buffer: &Buffer) -> ViewBytes<'_> {
        ViewBytes {
            buffers: vec![buffer],
            own: HashMap::new(),
            partly_used: HashSet::new(),
        }
    }

    #[test]
    fn bytes_that_no_view_names_go_and_shared_ones_stay_shared() {
        // Views 4..8 and 6..10 overlap, 0..4 and 10..12 are nobody's.
        let buffer = Buffer::of((0..12).collect());
        let mut root = json!({"bufferViews": [
            {"buffer": 0, "byteOffset": 4, "byteLength": 4},
            {"buffer": 0, "byteOffset": 6, "byteLength": 4}]});
        let packed = pack(&mut root, &view_bytes(&buffer)).unwrap();
        assert_eq!(packed, [4, 5, 6, 7, 8, 9]);
        assert_eq!(root["bufferViews"][0]["byteOffset"], 0);
        assert_eq!(root["bufferViews"][1]["byteOffset"], 2);
        assert_eq!(root["bufferViews"][1]["byteLength"], 4);
    }

    #[test]
    fn a_partly_used_view_keeps_what_its_accessors_name() {
        // Of five floats the first and the fourth are still used.
        let buffer = Buffer::of((0..20).collect());
        let mut root = json!({
            "bufferViews": [{"buffer": 0, "byteLength": 20}],
            "accessors": [
                {"bufferView": 0, "componentType": 5126, "type": "SCALAR", "count": 1},
                {"bufferView": 0, "byteOffset": 12, "componentType": 5126, "type": "SCALAR", "count": 1}],
        });
        let mut bytes = view_bytes(&buffer);
        bytes.partly_used.insert(0);
        let packed = pack(&mut root, &bytes).unwrap();
        assert_eq!(packed, [0, 1, 2, 3, 12, 13, 14, 15]);
        assert_eq!(root["bufferViews"][0]["byteLength"], 8);
        assert_eq!(root["accessors"][0].get("byteOffset"), None);
        assert_eq!(root["accessors"][1]["byteOffset"], 4);
    }

    #[test]
    fn interleaved_accessors_keep_whole_strides() {
        // Two accessors of stride 8 over elements 1 and 2 of three.
        let all: Vec<u8> = (0..24).collect();
        let buffer = Buffer::of(all.clone());
        let mut root = json!({
            "bufferViews": [{"buffer": 0, "byteLength": 24, "byteStride": 8}],
            "accessors": [
                {"bufferView": 0, "byteOffset": 8, "componentType": 5126, "type": "SCALAR", "count": 2},
                {"bufferView": 0, "byteOffset": 12, "componentType": 5126, "type": "SCALAR", "count": 2}],
        });
        let mut bytes = view_bytes(&buffer);
        bytes.partly_used.insert(0);
        let packed = pack(&mut root, &bytes).unwrap();
        assert_eq!(packed, all[8..]);
        assert_eq!(root["accessors"][0]["byteOffset"], 0);
        assert_eq!(root["accessors"][1]["byteOffset"], 4);
    }

    #[test]
    fn new_bytes_follow_the_old_ones_aligned() {
        let mut root = json!({"bufferViews": [
            {"buffer": 0, "byteLength": 8},
            {"buffer": 0, "byteOffset": 5, "byteLength": 1}]});
        let buffer = Buffer::of(vec![1, 2, 3, 4, 5, 6, 7]);
        let mut bytes = view_bytes(&buffer);
        bytes.own.insert(0, Cow::Borrowed(&[9; 8]));
        let packed = pack(&mut root, &bytes).unwrap();
        // Byte 5 keeps its place modulo 4.
        assert_eq!(packed, [0, 6, 0, 0, 9, 9, 9, 9, 9, 9, 9, 9]);
        assert_eq!(root["bufferViews"][0]["byteOffset"], 4);
        assert_eq!(root["bufferViews"][1]["byteOffset"], 1);
    }

    #[test]
    fn a_view_beyond_its_buffer_is_refused() {
        for (offset, length) in [(4, 4), (u64::MAX, 2), (0, 0)] {
            let mut root = json!({"bufferViews":
                [{"buffer": 0, "byteOffset": offset, "byteLength": length}]});
            let packed = pack(&mut root, &view_bytes(&Buffer::of(vec![0; 6])));
            assert!(matches!(packed, Err(PackProblem::OutOfRange(0))));
        }
    }
}
