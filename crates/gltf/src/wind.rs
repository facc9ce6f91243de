//! What vertices hang on, as attributes that a vertex shader sways them by.
//!
//! ```text
//! _WIND_PIVOT    VEC3 of FLOAT, metres: the point of the wood's axis that a leaf hangs on; of wood
//!                the middle of the ring that the vertex is on
//! _WIND_ALONG    SCALAR of FLOAT, metres: from the ground to that point along the wood
//! _WIND_SEGMENT  VEC2 of UNSIGNED_SHORT: the low and the high 16 bits of 1 + the place of the piece
//!                of wood in the plant's skeleton, 0 for none
//! ```
//!
//! All vertices of a leaf have the same. Levels keep them as they keep every attribute: a leaf that
//! grows does so about its own centre, and hangs on where it hung; the vertices of a leaf that is
//! made hang on what those hang on that they are copies of.

use crate::accessor::{Component, Shape};
use crate::error::Fault;
use crate::{Document, GltfError};
use glam::Vec3;
use secateur_model::{Hold, SegmentIndex};

/// The attribute of the point.
pub(crate) const PIVOT: &str = "_WIND_PIVOT";
/// The attribute of the distance.
pub(crate) const ALONG: &str = "_WIND_ALONG";
/// The attribute of the piece of wood.
pub(crate) const SEGMENT: &str = "_WIND_SEGMENT";
/// What the three take.
pub(crate) const BYTES_A_VERTEX: usize = 20;

impl Document {
    /// What each vertex of a primitive hangs on, where the file says it: `secateur grow` writes it,
    /// and every level keeps it.
    ///
    /// # Errors
    /// [`GltfError`] if there is no such primitive, or its attributes are damaged.
    pub fn holds(&self, mesh: usize, primitive: usize) -> Result<Option<Vec<Hold>>, GltfError> {
        let read = self.read_holds(mesh, primitive);
        read.map_err(|fault| self.error(fault))
    }

    /// Whether a primitive has what [`Document::holds`] reads, without reading it.
    pub(crate) fn says_what_it_hangs_on(&self, mesh: usize, primitive: usize) -> bool {
        [PIVOT, ALONG, SEGMENT]
            .iter()
            .all(|name| matches!(self.attribute(mesh, primitive, name), Ok(Some(_))))
    }

    /// What each vertex of a primitive hangs on. The list is empty where the file does not say it of all
    /// `vertices`, or says something that is not finite.
    pub(crate) fn holds_of(
        &self,
        mesh: usize,
        primitive: usize,
        vertices: usize,
    ) -> Result<Vec<Hold>, Fault> {
        let holds = self.read_holds(mesh, primitive)?.unwrap_or_default();
        let is_finite = |hold: &Hold| hold.pivot.is_finite() && hold.along_m.is_finite();
        match holds.len() == vertices && holds.iter().all(is_finite) {
            true => Ok(holds),
            false => Ok(Vec::new()),
        }
    }

    fn read_holds(&self, mesh: usize, primitive: usize) -> Result<Option<Vec<Hold>>, Fault> {
        let pivots = self.vectors_of::<3>(mesh, primitive, PIVOT)?;
        let segments = self.vectors_of::<2>(mesh, primitive, SEGMENT)?;
        let along = self.attribute(mesh, primitive, ALONG)?;
        let (Some(pivots), Some(segments), Some(along)) = (pivots, segments, along) else {
            return Ok(None);
        };
        let elements = self.elements(along)?;
        let is_expected = elements.accessor.shape == Shape::Scalar
            && elements.accessor.component == Component::F32;
        if !is_expected {
            return Ok(None);
        }
        let along = elements.vectors::<1>().map(|[metres]| metres as f32);
        let holds = pivots.into_iter().zip(segments).zip(along);
        let hold = |((pivot, [low, high]), along_m): (([f64; 3], [f64; 2]), f32)| Hold {
            segment: (usize::from(low as u16) | usize::from(high as u16) << 16)
                .checked_sub(1)
                .map(SegmentIndex::from_index),
            pivot: Vec3::from_array(pivot.map(|x| x as f32)),
            along_m,
        };
        Ok(Some(holds.map(hold).collect()))
    }
}
