//! The bytes of buffer views, laid out anew while some become streams.

use std::ops::Range;

use serde_json::Value;

use super::super::references::{as_index, items};

/// Streams and views start on multiples of four bytes.
const ALIGNMENT: usize = 4;

/// A buffer in the making. First come the streams, then what stays as it is.
pub(super) struct Layout<'a> {
    packed: &'a [u8],
    /// By view, in `packed`.
    places: Vec<Range<usize>>,
    is_alone: Vec<bool>,
    is_stream: Vec<bool>,
    new: Vec<u8>,
}

impl<'a> Layout<'a> {
    /// Of a file whose only buffer is `packed`.
    pub(super) fn new(root: &mut Value, packed: &'a [u8]) -> Self {
        let places: Vec<Range<usize>> = items(root, "bufferViews")
            .map(|view| {
                let number = |name| view.get(name).and_then(as_index).unwrap_or(0);
                let start = number("byteOffset");
                start..start + number("byteLength")
            })
            .collect();
        Self {
            packed,
            is_alone: alone(&places),
            is_stream: vec![false; places.len()],
            places,
            new: Vec::new(),
        }
    }

    pub(super) fn bytes(&self, view: usize) -> &'a [u8] {
        &self.packed[self.places[view].clone()]
    }

    /// Whether no other view has any of its bytes.
    pub(super) fn is_alone(&self, view: usize) -> bool {
        self.is_alone[view]
    }

    /// Puts the stream of a view into the buffer; where it is.
    pub(super) fn push_stream(&mut self, view: usize, stream: &[u8]) -> usize {
        let start = self.align(0);
        self.new.extend_from_slice(stream);
        self.is_stream[view] = true;
        start
    }

    /// Puts in what no stream stands for. Bytes that views share stay shared.
    pub(super) fn finish(mut self, root: &mut Value) -> Vec<u8> {
        let mut rest: Vec<usize> = (0..self.places.len()).collect();
        rest.retain(|&view| !self.is_stream[view]);
        rest.sort_by_key(|&view| (self.places[view].start, self.places[view].end));
        // What was copied last, and where to.
        let mut copied = 0..0;
        let mut copied_to = 0;
        for view in rest {
            let place = self.places[view].clone();
            if place.start >= copied.end {
                copied_to = self.align(place.start);
                copied = place.start..place.start;
            }
            if place.end > copied.end {
                self.new
                    .extend_from_slice(&self.packed[copied.end..place.end]);
                copied.end = place.end;
            }
            let start = copied_to + place.start - copied.start;
            root["bufferViews"][view]["byteOffset"] = start.into();
        }
        self.new
    }

    /// Grows the buffer until its end is on the same place modulo four as `like`.
    fn align(&mut self, like: usize) -> usize {
        let gap = (like + ALIGNMENT - self.new.len() % ALIGNMENT) % ALIGNMENT;
        self.new.resize(self.new.len() + gap, 0);
        self.new.len()
    }
}

/// For each range whether it overlaps no other.
fn alone(places: &[Range<usize>]) -> Vec<bool> {
    let mut order: Vec<usize> = (0..places.len()).collect();
    order.sort_by_key(|&number| (places[number].start, places[number].end));
    let mut is_alone = vec![true; places.len()];
    let mut furthest: Option<usize> = None;
    for number in order {
        if let Some(before) = furthest
            && places[before].end > places[number].start
        {
            is_alone[before] = false;
            is_alone[number] = false;
        }
        if furthest.is_none_or(|before| places[number].end > places[before].end) {
            furthest = Some(number);
        }
    }
    is_alone
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn shared_bytes_stay_shared_beside_streams() {
        let packed: Vec<u8> = (0..20).collect();
        let mut root = json!({"bufferViews": [
            {"byteOffset": 0, "byteLength": 8},
            {"byteOffset": 8, "byteLength": 6},
            {"byteOffset": 10, "byteLength": 9}]});
        let mut layout = Layout::new(&mut root, &packed);
        let is_alone = [0, 1, 2].map(|view| layout.is_alone(view));
        assert_eq!(is_alone, [true, false, false]);
        assert_eq!(layout.push_stream(0, &[7; 3]), 0);
        let buffer = layout.finish(&mut root);
        assert_eq!(
            buffer,
            [7, 7, 7, 0, 8, 9, 10, 11, 12, 13, 14, 15, 16, 17, 18]
        );
        assert_eq!(root["bufferViews"][1]["byteOffset"], 4);
        assert_eq!(root["bufferViews"][2]["byteOffset"], 6);
    }
}
