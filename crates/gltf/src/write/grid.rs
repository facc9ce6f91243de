//! New numbers in place of old ones that are quantised.

use super::draft::{NewElements, Role};
use crate::accessor::{Accessor, Component, Shape};

/// Fewer steps over the numbers of an accessor than this are too coarse a grid for new ones.
const FEWEST_STEPS: f64 = 4096.0;

/// What becomes of numbers on a grid.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Grid {
    /// Values were f32 and are.
    AsFloats,
    /// The nearest ones on the grid.
    Kept,
    /// f32, since the grid is too coarse for them, or ends before them.
    BecameFloats,
}

/// Elements of vectors that replace some of an accessor: on its grid, where they can be.
pub(super) fn elements_like<const N: usize>(
    old: &Accessor,
    vectors: &[[f64; N]],
    bounded: bool,
) -> (NewElements, Grid) {
    let flat = vectors.as_flattened();
    let Some(steps) = steps_per_unit(old).filter(|steps| is_fine(old, flat, *steps)) else {
        let is_float = old.component == Component::F32;
        let grid = match is_float {
            true => Grid::AsFloats,
            false => Grid::BecameFloats,
        };
        return (
            new_elements(old, floats(flat), Component::F32, bounded),
            grid,
        );
    };
    let on_grid: Vec<f64> = flat.iter().map(|x| (x * steps).round()).collect();
    let fits = |component: &Component| {
        let (least, most) = range(*component);
        on_grid.iter().all(|x| (least..=most).contains(x))
    };
    // Whole numbers mean the same with a sign.
    let signed = (!old.normalized).then_some(Component::I16);
    let mut components = [Some(old.component), signed].into_iter().flatten();
    if let Some(component) = components.find(fits) {
        let mut bytes = Vec::with_capacity(on_grid.len() * component.bytes());
        for &number in &on_grid {
            component.push(number, &mut bytes);
        }
        return (new_elements(old, bytes, component, bounded), Grid::Kept);
    }
    // On a grid of a power of two still, a finer one, which compresses well.
    let steps = libm::exp2(libm::log2(steps).ceil() + 1.0);
    let rounded: Vec<f64> = flat.iter().map(|x| rounded(*x, steps)).collect();
    let new = new_elements(old, floats(&rounded), Component::F32, bounded);
    (new, Grid::BecameFloats)
}

/// The nearest multiple of `1 / steps_per_unit`; zero is never negative.
pub(super) fn rounded(number: f64, steps_per_unit: f64) -> f64 {
    (number * steps_per_unit).round() / steps_per_unit + 0.0
}

/// The steps of an accessor's grid, per unit; none of floats.
pub(super) fn steps_per_unit(accessor: &Accessor) -> Option<f64> {
    match accessor.component {
        Component::F32 | Component::U32 => None,
        _ if accessor.normalized => Some(range(accessor.component).1),
        _ => Some(1.0),
    }
}

/// Whether new numbers may grid on the grid: any of 16 bits that has steps enough, and that of
/// vectors of unit length, which 8 bits are made for.
fn is_fine(old: &Accessor, numbers: &[f64], steps: f64) -> bool {
    let is_byte = matches!(old.component, Component::I8 | Component::U8);
    let is_direction = old.component == Component::I8 && old.shape == Shape::Vector(3);
    if is_byte {
        return is_direction && old.normalized;
    }
    let least = numbers.iter().copied().fold(f64::INFINITY, f64::min);
    let most = numbers.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    (most - least) * steps >= FEWEST_STEPS
}

fn range(component: Component) -> (f64, f64) {
    match component {
        Component::I8 => (-127.0, 127.0),
        Component::U8 => (0.0, 255.0),
        Component::I16 => (-32767.0, 32767.0),
        Component::U16 => (0.0, 65535.0),
        Component::U32 | Component::F32 => (f64::NEG_INFINITY, f64::INFINITY),
    }
}

fn floats(numbers: &[f64]) -> Vec<u8> {
    let in_range = |x: &f64| (*x as f32).clamp(f32::MIN, f32::MAX);
    let all = numbers.iter().map(in_range);
    all.flat_map(f32::to_le_bytes).collect()
}

fn new_elements(
    old: &Accessor,
    bytes: Vec<u8>,
    component: Component,
    bounded: bool,
) -> NewElements {
    NewElements {
        component,
        shape: old.shape,
        normalized: old.normalized && component != Component::F32,
        count: bytes.len() / old.shape.bytes(component),
        bytes: Some(bytes),
        bounded,
        role: Role::Vertex,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn like(component: Component, normalized: bool, vectors: &[[f64; 2]]) -> (NewElements, Grid) {
        let old = Accessor {
            index: 0,
            count: vectors.len(),
            component,
            shape: Shape::Vector(2),
            normalized,
            view: None,
            byte_offset: 0,
            is_sparse: false,
        };
        elements_like(&old, vectors, false)
    }

    #[test]
    fn numbers_stay_on_their_grid_where_they_can() {
        let (new, grid) = like(Component::U16, true, &[[0.5, 1.0]]);
        assert_eq!((grid, new.component), (Grid::Kept, Component::U16));
        assert_eq!(new.bytes.unwrap(), [0x00, 0x80, 0xff, 0xff]);
        // Beyond its end.
        let (new, grid) = like(Component::U16, false, &[[-1.2, 9000.0]]);
        assert_eq!((grid, new.component), (Grid::Kept, Component::I16));
        assert_eq!(new.bytes.unwrap()[..2], (-1i16).to_le_bytes());
        let (new, grid) = like(Component::U16, true, &[[-0.25, 1.0]]);
        assert_eq!((grid, new.component), (Grid::BecameFloats, Component::F32));
        assert_eq!(new.bytes.unwrap()[..4], (-0.25f32).to_le_bytes());
        // Too coarse.
        let (new, grid) = like(Component::U16, false, &[[0.25, 100.0]]);
        assert_eq!((grid, new.component), (Grid::BecameFloats, Component::F32));
        assert_eq!(new.bytes.unwrap()[..4], 0.25f32.to_le_bytes());
        let (_, grid) = like(Component::F32, false, &[[0.25, 100.0]]);
        assert_eq!(grid, Grid::AsFloats);
    }
}
