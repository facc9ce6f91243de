//! Geometry as few bytes that a browser unpacks in a few lines.
//!
//! Positions are 16-bit steps within the surface's box, normals 16-bit
//! octahedral coordinates (Cigolle et al., A Survey of Efficient Representations
//! for Independent Unit Vectors, JCGT 2014), colours 16 bits; texture coordinates
//! stay floats, since bark repeats. All integers are stored as differences from
//! the vertex (or corner) before, which compress well.

use glam::{DVec3, Vec2, Vec3};
use secateur_model::{Hold, Surface};
use serde::Serialize;

use secateur_runtime::wind::{HOLD_WORDS, hold_words};

/// Components of a position, the last one idle: vertices then lie on words.
const POSITION_STRIDE: usize = 4;

/// Where a surface lies in the bytes, and how to read it. Offsets are in bytes
/// and multiples of four.
#[derive(Debug, Serialize)]
pub(super) struct Packed {
    is_foliage: bool,
    material: usize,
    vertices: usize,
    triangles: usize,
    /// A position is `origin + steps * step`.
    origin: [f64; 3],
    step: [f64; 3],
    positions: usize,
    indices: usize,
    normals: Option<usize>,
    uvs: Option<usize>,
    colors: Option<usize>,
    /// By vertex the words of what it hangs on.
    holds: Option<usize>,
    /// Where vertices are when the next level takes over, as `positions`.
    #[serde(skip_serializing_if = "Option::is_none")]
    ends: Option<usize>,
}

/// What a surface's vertices have: all lists of every vertex, integers as they are stored.
pub(super) struct Arrays {
    pub(super) positions: Vec<DVec3>,
    /// Two a vertex.
    pub(super) normals: Option<Vec<u16>>,
    pub(super) uvs: Option<Vec<Vec2>>,
    /// Four a vertex.
    pub(super) colors: Option<Vec<u16>>,
    pub(super) holds: Option<Vec<Hold>>,
    pub(super) ends: Option<Vec<DVec3>>,
    pub(super) triangles: Vec<[u32; 3]>,
}

/// Appends a surface to the bytes; `ends` is where its vertices go. `is_foliage` and `material` say what it is.
pub(super) fn pack(
    surface: &Surface,
    ends: Option<&[DVec3]>,
    (is_foliage, material): (bool, usize),
    bytes: &mut Vec<u8>,
) -> Packed {
    let of_every_vertex = |count: usize| count == surface.positions.len();
    let arrays = Arrays {
        positions: surface.positions.clone(),
        normals: of_every_vertex(surface.normals.len()).then(|| {
            let normals = surface.normals.iter().map(|&n| octahedral(n));
            normals.flatten().collect()
        }),
        uvs: of_every_vertex(surface.uvs.len()).then(|| surface.uvs.clone()),
        colors: of_every_vertex(surface.colors.len()).then(|| {
            let colors = surface.colors.iter().map(|c| c.to_array());
            let parts = colors.flatten().map(|x| unorm16(f64::from(x)));
            parts.collect()
        }),
        holds: (of_every_vertex(surface.holds.len()) && !surface.holds.is_empty())
            .then(|| surface.holds.clone()),
        ends: ends
            .filter(|ends| of_every_vertex(ends.len()))
            .map(<[DVec3]>::to_vec),
        triangles: surface.triangles.clone(),
    };
    pack_arrays(&arrays, is_foliage, material, bytes)
}

/// [`pack`] of what is laid out already.
pub(super) fn pack_arrays(
    arrays: &Arrays,
    is_foliage: bool,
    material: usize,
    bytes: &mut Vec<u8>,
) -> Packed {
    let (low, high) = bounds(arrays.positions.iter().chain(arrays.ends.iter().flatten()));
    let extent = high - low;
    let step = extent / f64::from(u16::MAX);
    let steps = |p: DVec3| {
        let [x, y, z] = [0, 1, 2].map(|axis| {
            let share = (p[axis] - low[axis]) / extent[axis];
            if share.is_finite() { unorm16(share) } else { 0 }
        });
        [x, y, z, 0]
    };
    let in_steps = |of: &[DVec3]| -> Vec<u16> { of.iter().flat_map(|&p| steps(p)).collect() };
    let positions = in_steps(&arrays.positions);
    let ends = arrays.ends.as_ref().map(|ends| in_steps(ends));
    let normals = arrays.normals.as_ref();
    let colors = arrays.colors.as_ref();
    Packed {
        is_foliage,
        material,
        vertices: arrays.positions.len(),
        triangles: arrays.triangles.len(),
        origin: low.to_array(),
        step: step.to_array(),
        positions: push_differences(bytes, &positions, POSITION_STRIDE),
        indices: push_words(bytes, arrays.triangles.as_flattened(), 1),
        normals: normals.map(|n| push_differences(bytes, n, 2)),
        uvs: arrays.uvs.as_ref().map(|uvs| push_floats(bytes, uvs)),
        colors: colors.map(|c| push_differences(bytes, c, 4)),
        holds: arrays.holds.as_ref().map(|holds| {
            let words: Vec<u32> = holds.iter().flat_map(hold_words).collect();
            push_words(bytes, &words, HOLD_WORDS)
        }),
        ends: ends.map(|ends| push_differences(bytes, &ends, POSITION_STRIDE)),
    }
}

/// The corners of the box about some points; of none, the origin twice.
pub(crate) fn bounds<'a>(positions: impl IntoIterator<Item = &'a DVec3>) -> (DVec3, DVec3) {
    positions
        .into_iter()
        .fold(None, |bounds: Option<(DVec3, DVec3)>, &p| match bounds {
            Some((low, high)) => Some((low.min(p), high.max(p))),
            None => Some((p, p)),
        })
        .unwrap_or_default()
}

/// 0 to 1 as 0 to 65,535.
fn unorm16(share: f64) -> u16 {
    (share.clamp(0.0, 1.0) * f64::from(u16::MAX)).round() as u16
}

/// The unit sphere folded onto a square of signed 16-bit coordinates.
pub(crate) fn octahedral(normal: Vec3) -> [u16; 2] {
    let flat = normal / (normal.x.abs() + normal.y.abs() + normal.z.abs());
    let sign = |x: f32| if x < 0.0 { -1.0 } else { 1.0 };
    let [u, v] = if flat.z >= 0.0 {
        [flat.x, flat.y]
    } else {
        [
            (1.0 - flat.y.abs()) * sign(flat.x),
            (1.0 - flat.x.abs()) * sign(flat.y),
        ]
    };
    [u, v].map(|x| (x * f32::from(i16::MAX)).round() as i16 as u16)
}

/// Appends each value less the one a stride before it.
fn push_differences(bytes: &mut Vec<u8>, values: &[u16], stride: usize) -> usize {
    let offset = align(bytes);
    for (k, &value) in values.iter().enumerate() {
        let before = k.checked_sub(stride).map_or(0, |b| values[b]);
        bytes.extend(value.wrapping_sub(before).to_le_bytes());
    }
    offset
}

/// Appends each word, such as a corner, less the one a stride before it.
pub(super) fn push_words(bytes: &mut Vec<u8>, words: &[u32], stride: usize) -> usize {
    let offset = align(bytes);
    for (k, &word) in words.iter().enumerate() {
        let before = k.checked_sub(stride).map_or(0, |b| words[b]);
        bytes.extend(word.wrapping_sub(before).to_le_bytes());
    }
    offset
}

fn push_floats(bytes: &mut Vec<u8>, uvs: &[Vec2]) -> usize {
    let offset = align(bytes);
    for x in uvs.iter().flat_map(|uv| uv.to_array()) {
        bytes.extend(x.to_le_bytes());
    }
    offset
}

fn align(bytes: &mut Vec<u8>) -> usize {
    bytes.resize(bytes.len().next_multiple_of(4), 0);
    bytes.len()
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use glam::Vec4;
    use secateur_model::{AlphaMode, Finish, Material};

    use super::*;

    fn unfolded([u, v]: [u16; 2]) -> Vec3 {
        let [u, v] = [u, v].map(|x| f32::from(x as i16) / 32767.0);
        let z = 1.0 - u.abs() - v.abs();
        let below = (-z).max(0.0);
        Vec3::new(u - below.copysign(u), v - below.copysign(v), z).normalize()
    }

    #[test]
    fn normals_come_back_from_both_halves_of_the_octahedron() {
        for normal in [
            Vec3::X,
            Vec3::NEG_Y,
            Vec3::Z,
            Vec3::NEG_Z,
            Vec3::new(0.6, -0.64, 0.48),
            Vec3::new(-0.6, 0.64, -0.48),
        ] {
            let back = unfolded(octahedral(normal));
            assert!(back.distance(normal) < 1e-4, "{normal} {back}");
        }
    }

    #[test]
    fn positions_are_steps_in_the_box_and_stored_as_differences() {
        let surface = Surface {
            positions: vec![DVec3::new(1.0, 5.0, 0.0), DVec3::new(3.0, 5.0, -1.0)],
            normals: Vec::new(),
            uvs: vec![Vec2::new(0.5, 20.0), Vec2::ONE],
            colors: vec![Vec4::ONE, Vec4::new(0.0, 1.0, 2.0, 1.0)],
            holds: Vec::new(),
            triangles: vec![[1, 0, 1]],
            material: Arc::new(Material {
                name: String::new(),
                base_color: [1.0; 4],
                texture: None,
                alpha_mode: AlphaMode::Opaque,
                double_sided: true,
                finish: Finish::default(),
            }),
        };
        let mut bytes = vec![9];
        let packed = pack(&surface, None, (true, 3), &mut bytes);
        assert_eq!((packed.vertices, packed.triangles), (2, 1));
        assert_eq!(packed.origin, [1.0, 5.0, -1.0]);
        assert_eq!(packed.normals, None);
        let words = |offset: usize, count: usize| -> Vec<u16> {
            let words = bytes[offset..].chunks_exact(2).take(count);
            words.map(|w| u16::from_le_bytes([w[0], w[1]])).collect()
        };
        assert_eq!(packed.positions, 4, "on a word");
        // From (0, 0, 65535) to (65535, 0, 0): a flat box has no steps in y.
        let expected = [0, 0, 65535, 0, 65535, 0, 1, 0];
        assert_eq!(words(packed.positions, 8), expected);
        // 1, then 0 - 1, then 1 - 0, each of 32 bits.
        assert_eq!(words(packed.indices, 6), [1, 0, 65535, 65535, 1, 0]);
        // A colour above 1 is 1.
        let colors = [65535, 65535, 65535, 65535, 1, 0, 0, 0];
        assert_eq!(words(packed.colors.unwrap(), 8), colors);
    }
}
