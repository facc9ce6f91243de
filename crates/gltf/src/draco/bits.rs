//! How finely a file's compressed numbers were rounded, told by the numbers.

use super::Compressed;
use crate::accessor::{Component, Elements};
use crate::document::Document;
use crate::error::Fault;

/// To how many bits an encoder rounds the numbers of vertices: with 14, the longest side of a primitive's box has 2^14
/// places.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct DracoBits {
    pub(crate) positions: i32,
    pub(crate) texture_coordinates: i32,
}

impl DracoBits {
    /// Of a plant of 16 metres a millimetre; of a texture of 4,096 texels one.
    const USUAL: Self = Self {
        positions: 14,
        texture_coordinates: 12,
    };

    /// Fewer bits would show: a plant of 16 metres would be rounded to 6 centimetres.
    const FEWEST: i32 = 8;

    /// Those of a file of one primitive; the usual ones where several may span more together than each does alone, and
    /// where numbers lie on no grid.
    pub(super) fn of(document: &Document, replaced: &[Compressed]) -> Result<Self, Fault> {
        let [one] = replaced else {
            return Ok(Self::USUAL);
        };
        let primitive = &document.root["meshes"][one.mesh]["primitives"][one.primitive];
        let bits = |name: &str, usual: i32| -> Result<i32, Fault> {
            let number = primitive["attributes"][name].as_u64();
            let Some(number) = number else {
                return Ok(usual);
            };
            let elements = document.elements(number as usize)?;
            let fewest = (Self::FEWEST..usual).find(|bits| is_on_grid(&elements, *bits));
            Ok(fewest.unwrap_or(usual))
        };
        Ok(Self {
            positions: bits("POSITION", Self::USUAL.positions)?,
            texture_coordinates: bits("TEXCOORD_0", Self::USUAL.texture_coordinates)?,
        })
    }
}

/// Whether numbers were rounded to so few bits: whether each lies on one of 2^`bits` places along the longest side.
fn is_on_grid(elements: &Elements<'_>, bits: i32) -> bool {
    /// How far from a step a number may be, in steps, as it is rounded to 24 bits.
    const OFF: f64 = 0.02;

    if elements.accessor.component != Component::F32 {
        return false;
    }
    let components = elements.accessor.shape.components();
    let numbers = elements.bytes.as_chunks::<4>().0.iter();
    let numbers: Vec<f64> = numbers
        .map(|bytes| f64::from(f32::from_le_bytes(*bytes)))
        .collect();
    let sides = (0..components).map(|component| {
        let of_component = || numbers.iter().skip(component).step_by(components);
        let least = of_component().copied().fold(f64::INFINITY, f64::min);
        (
            least,
            of_component().copied().fold(f64::NEG_INFINITY, f64::max) - least,
        )
    });
    let sides: Vec<(f64, f64)> = sides.collect();
    let longest = sides.iter().map(|(_, side)| *side).fold(0.0, f64::max);
    let step = longest / f64::from((1 << bits) - 1);
    step > 0.0
        && numbers.iter().enumerate().all(|(number, value)| {
            let steps = (value - sides[number % components].0) / step;
            (steps - steps.round()).abs() < OFF
        })
}
