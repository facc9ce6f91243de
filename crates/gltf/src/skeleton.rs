//! The skeleton of a grown plant within its file: accessors that the root's
//! `extras` name.
//!
//! ```text
//! "extras": {"secateur_skeleton": {"version": 1, "accessors": {
//!   "segment_parent":    VEC2 of UNSIGNED_SHORT, a number (see below) of a segment
//!   "segment_continues": SCALAR of UNSIGNED_BYTE, 1 where it is its parent's branch
//!   "segment_sides":     SCALAR of UNSIGNED_BYTE, 3 to 64
//!   "segment_start":     VEC3 of FLOAT, metres, y up; y is the height
//!   "segment_end":       VEC3 of FLOAT; its distance from the start is the length
//!   "segment_radius":    VEC2 of FLOAT, metres, at start and end
//!   "leaf_segment":      VEC2 of UNSIGNED_SHORT, for each leaf of the foliage
//! }}}
//! ```
//!
//! A number is the low and the high 16 bits of 1 + its place, and 0 for none:
//! glTF allows UNSIGNED_INT for indices of primitives only.

use glam::DVec3;
use serde_json::Value;

use super::accessor::{Component, Elements, Shape};
use super::error::{At, Fault, Problem};
use super::property;
use super::tree::Tree;
use super::{Document, GltfError};
use secateur_model::{PlantSkeleton, Segment, SegmentIndex};

/// Where in the root the accessors are named.
pub(super) const ACCESSORS_POINTER: &str = "/extras/secateur_skeleton/accessors";
/// The name within the root's extras.
pub(super) const EXTRAS_NAME: &str = "secateur_skeleton";
/// The version of what it holds.
pub(super) const VERSION: u64 = 1;

pub(super) const SEGMENT_PARENT: &str = "segment_parent";
pub(super) const SEGMENT_CONTINUES: &str = "segment_continues";
pub(super) const SEGMENT_SIDES: &str = "segment_sides";
pub(super) const SEGMENT_START: &str = "segment_start";
pub(super) const SEGMENT_END: &str = "segment_end";
pub(super) const SEGMENT_RADIUS: &str = "segment_radius";
pub(super) const LEAF_SEGMENT: &str = "leaf_segment";

/// A segment, or none, as the file has it.
pub(super) fn number_of(segment: Option<SegmentIndex>) -> [u16; 2] {
    let number = segment.map_or(0, |segment| segment.index() as u32 + 1);
    [number as u16, (number >> 16) as u16]
}

impl Tree {
    /// What the foliage has grown on, where the file says it: `secateur grow`
    /// writes it, and [`write_lod`](Self::write_lod) keeps it for the leaves that
    /// are left.
    ///
    /// # Errors
    /// [`GltfError`] if the file has a skeleton that is damaged, of an unknown
    /// version, or of another number of leaves than the foliage.
    pub fn skeleton(&self) -> Result<Option<PlantSkeleton>, GltfError> {
        self.document.skeleton_of(self.foliage.leaves().len())
    }
}

impl Document {
    /// Whether the file says that it has a skeleton, sound or not: enough to know
    /// before its leaves are found.
    pub fn has_skeleton(&self) -> bool {
        let extras = self.root.get("extras");
        extras.is_some_and(|extras| extras.get(EXTRAS_NAME).is_some())
    }

    /// The skeleton in the file, if there is one and it is of a plant of `leaves` leaves.
    pub(crate) fn skeleton_of(&self, leaves: usize) -> Result<Option<PlantSkeleton>, GltfError> {
        let read = self.read_skeleton(leaves);
        read.map_err(|fault| self.error(fault))
    }

    fn read_skeleton(&self, leaves: usize) -> Result<Option<PlantSkeleton>, Fault> {
        let Some(json) = self.root.get("extras").and_then(|e| e.get(EXTRAS_NAME)) else {
            return Ok(None);
        };
        let place = || format!("extras.{EXTRAS_NAME}");
        let version = property::whole(json, "version").at(place)?;
        if version != Some(VERSION) {
            return Err(Problem::BadProperty {
                property: "version",
                expected: "1",
                found: version.map_or_else(|| "missing".to_owned(), |v| v.to_string()),
            })
            .at(place);
        }
        let accessors = json.get("accessors").unwrap_or(&Value::Null);
        let numbers = |name| self.skeleton_vectors::<2>(accessors, name, Component::U16);
        let bytes = |name| self.skeleton_vectors::<1>(accessors, name, Component::U8);
        let points = |name| self.skeleton_vectors::<3>(accessors, name, Component::F32);

        let parents = numbers(SEGMENT_PARENT)?;
        let (continues, sides) = (bytes(SEGMENT_CONTINUES)?, bytes(SEGMENT_SIDES)?);
        let (starts, ends) = (points(SEGMENT_START)?, points(SEGMENT_END)?);
        let radii = self.skeleton_vectors::<2>(accessors, SEGMENT_RADIUS, Component::F32)?;
        for (name, found) in [
            (SEGMENT_CONTINUES, continues.len()),
            (SEGMENT_SIDES, sides.len()),
            (SEGMENT_START, starts.len()),
            (SEGMENT_END, ends.len()),
            (SEGMENT_RADIUS, radii.len()),
        ] {
            if found != parents.len() {
                return Err(Problem::CountMismatch {
                    attribute: name.to_owned(),
                    found,
                    other: SEGMENT_PARENT.to_owned(),
                    expected: parents.len(),
                })
                .at(place);
            }
        }
        let segment = |k: usize| Segment {
            parent: segment_of(parents[k]),
            continues_parent: continues[k][0] != 0.0,
            start: DVec3::from_array(starts[k]),
            end: DVec3::from_array(ends[k]),
            start_radius_m: radii[k][0],
            end_radius_m: radii[k][1],
            sides: sides[k][0] as u32,
        };
        let leaf_segments = numbers(LEAF_SEGMENT)?.into_iter().map(segment_of);
        let skeleton = PlantSkeleton {
            segments: (0..parents.len()).map(segment).collect(),
            leaf_segments: leaf_segments.collect(),
        };
        skeleton
            .check(leaves)
            .map_err(Problem::Skeleton)
            .at(place)?;
        Ok(Some(skeleton))
    }

    /// The elements of one of the skeleton's accessors, which must be of this type.
    fn skeleton_vectors<const N: usize>(
        &self,
        accessors: &Value,
        name: &'static str,
        component: Component,
    ) -> Result<Vec<[f64; N]>, Fault> {
        let place = || format!("extras.{EXTRAS_NAME}.accessors");
        let index = property::required_index(accessors, name).at(place)?;
        let elements: Elements<'_> = self.elements(index)?;
        let shape = match N {
            1 => Shape::Scalar,
            n => Shape::Vector(n),
        };
        let accessor = &elements.accessor;
        if accessor.shape != shape || accessor.component != component || accessor.normalized {
            return Err(Problem::WrongKind {
                found: accessor.kind(),
                role: name.to_owned(),
            })
            .at(|| self.place("accessors", index));
        }
        Ok(elements.vectors::<N>().collect())
    }
}

fn segment_of([low, high]: [f64; 2]) -> Option<SegmentIndex> {
    let number = low as usize + ((high as usize) << 16);
    number.checked_sub(1).map(SegmentIndex::from_index)
}
