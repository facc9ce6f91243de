//! Plants of arrays, for those who have no glTF.

use std::collections::BTreeMap;
use std::sync::Arc;

use glam::{DVec3, Vec2};
use numpy::{PyReadonlyArray1, PyReadonlyArray2, PyUntypedArrayMethods};
use pyo3::prelude::*;
use secateur::{
    AlphaMode, Filters, Finish, Material, Opening, Selector, Surface, Texture, Wrap,
    surfaces_to_glb,
};

use crate::errors::usage;
use crate::plant::{PyPlant, Source};

/// Corners of a mesh as they came, checked.
struct Corners<'a> {
    positions: &'a [[f32; 3]],
    uv: Option<&'a [[f32; 2]]>,
}

impl Corners<'_> {
    /// A surface of these triangles with corners of their own.
    fn surface(&self, triangles: &[[u32; 3]], material: Arc<Material>) -> Surface {
        let mut surface = Surface::empty(material);
        let mut numbers = BTreeMap::new();
        for corners in triangles {
            surface.triangles.push(corners.map(|corner| {
                *numbers.entry(corner).or_insert_with(|| {
                    let at = self.positions[corner as usize];
                    surface.positions.push(DVec3::from(at.map(f64::from)));
                    if let Some(uv) = self.uv {
                        surface.uvs.push(Vec2::from(uv[corner as usize]));
                    }
                    surface.positions.len() as u32 - 1
                })
            }));
        }
        surface
    }
}

#[pyfunction]
#[pyo3(signature = (positions, triangles, leaf_ids, *, uv=None, mask=None, cutoff=0.5))]
pub(crate) fn from_arrays(
    py: Python<'_>,
    positions: PyReadonlyArray2<'_, f32>,
    triangles: PyReadonlyArray2<'_, u32>,
    leaf_ids: PyReadonlyArray1<'_, u32>,
    uv: Option<PyReadonlyArray2<'_, f32>>,
    mask: Option<PyReadonlyArray2<'_, u8>>,
    cutoff: f32,
) -> PyResult<PyPlant> {
    let positions: &[[f32; 3]] = rows("positions", &positions)?;
    let triangles: &[[u32; 3]] = rows("triangles", &triangles)?;
    let leaf_ids = leaf_ids.as_slice()?;
    let uv = uv.as_ref().map(|uv| rows("uv", uv)).transpose()?;
    check(positions, triangles, leaf_ids, uv)?;
    let leaf_material = match (&mask, uv) {
        (None, _) => material("leaves", None, cutoff),
        (Some(_), None) => return Err(usage("mask needs uv, which says where it lies")),
        (Some(mask), Some(_)) => material("leaves", Some(texture(mask)?), cutoff),
    };
    let corners = Corners { positions, uv };
    let (glb, sizes) = py.detach(|| glb(&corners, triangles, leaf_ids, leaf_material));
    let opening = Opening {
        foliage: vec!["material:leaves".parse::<Selector>().expect("a selector")],
        ..Opening::default()
    };
    let plant = PyPlant::of(py, Source::Bytes("plant.glb".to_owned(), glb), opening)?;
    check_leaves(&plant, &sizes)?;
    Ok(plant)
}

/// The mesh as a GLB, leaves by their numbers, and how many triangles each number has.
fn glb(
    corners: &Corners<'_>,
    triangles: &[[u32; 3]],
    leaf_ids: &[u32],
    leaf_material: Material,
) -> (Vec<u8>, Vec<(u32, usize)>) {
    let mut of_leaf: BTreeMap<u32, Vec<[u32; 3]>> = BTreeMap::new();
    for (corners, leaf) in triangles.iter().zip(leaf_ids) {
        of_leaf.entry(*leaf).or_default().push(*corners);
    }
    let wood = of_leaf.remove(&0).unwrap_or_default();
    let sizes = of_leaf.iter().map(|(id, leaf)| (*id, leaf.len())).collect();
    let leaves: Vec<[u32; 3]> = of_leaf.into_values().flatten().collect();
    let surfaces = [
        (corners.surface(&leaves, Arc::new(leaf_material)), true),
        (
            corners.surface(&wood, Arc::new(material("wood", None, 0.5))),
            false,
        ),
    ];
    (surfaces_to_glb("plant", &surfaces), sizes)
}

/// Refuses arrays that are no mesh.
fn check(
    positions: &[[f32; 3]],
    triangles: &[[u32; 3]],
    leaf_ids: &[u32],
    uv: Option<&[[f32; 2]]>,
) -> PyResult<()> {
    if leaf_ids.len() != triangles.len() {
        return Err(usage(format!(
            "leaf_ids has {} numbers for {} triangles; give one for each",
            leaf_ids.len(),
            triangles.len()
        )));
    }
    if let Some(uv) = uv
        && uv.len() != positions.len()
    {
        return Err(usage(format!(
            "uv has {} rows for {} positions; give one for each",
            uv.len(),
            positions.len()
        )));
    }
    if let Some(k) = positions
        .iter()
        .position(|at| !at.iter().all(|x| x.is_finite()))
    {
        return Err(usage(format!("positions[{k}] is not finite")));
    }
    let is_outside = |corners: &[u32; 3]| corners.iter().any(|c| *c as usize >= positions.len());
    if let Some(k) = triangles.iter().position(is_outside) {
        return Err(usage(format!(
            "triangles[{k}] names a position that is not there: there are {}",
            positions.len()
        )));
    }
    match leaf_ids.iter().any(|id| *id != 0) {
        true => Ok(()),
        false => Err(usage(
            "leaf_ids has no leaf: 0 is wood, leaves are numbered from 1",
        )),
    }
}

/// Refuses leaves that are other pieces in the plant than their numbers say.
fn check_leaves(plant: &PyPlant, sizes: &[(u32, usize)]) -> PyResult<()> {
    let leaves = plant.plant().leaves();
    let mut found = (0..leaves.leaves().len()).map(|k| {
        let id = secateur::LeafId::from_index(k);
        leaves.triangles_of(id).len()
    });
    for (id, size) in sizes {
        if found.next() != Some(*size) {
            return Err(usage(format!(
                "leaf {id} is not one piece, or shares an edge with another: a leaf's triangles hang together by edges, \
                 and two leaves share none"
            )));
        }
    }
    Ok(())
}

fn material(name: &str, texture: Option<Texture>, cutoff: f32) -> Material {
    Material {
        name: name.to_owned(),
        base_color: [1.0; 4],
        alpha_mode: match texture {
            Some(_) => AlphaMode::Mask(cutoff),
            None => AlphaMode::Opaque,
        },
        texture: texture.map(Arc::new),
        double_sided: true,
        finish: Finish::default(),
    }
}

/// A leaf's alpha as a texture of its outline.
fn texture(mask: &PyReadonlyArray2<'_, u8>) -> PyResult<Texture> {
    let [height, width] = [mask.shape()[0], mask.shape()[1]];
    let is_size = |side: usize| (1..=16_384).contains(&side);
    if !is_size(height) || !is_size(width) {
        return Err(usage(format!(
            "mask is {height} x {width}; its sides must be 1 to 16384"
        )));
    }
    let alpha = mask.as_slice()?.iter();
    Ok(Texture {
        width: width as u32,
        height: height as u32,
        rgba: alpha.flat_map(|alpha| [255, 255, 255, *alpha]).collect(),
        wrap: [Wrap::ClampToEdge; 2],
        filters: Filters::default(),
    })
}

/// The rows of an array, as they lie.
fn rows<'a, T, const N: usize>(
    what: &str,
    array: &'a PyReadonlyArray2<'_, T>,
) -> PyResult<&'a [[T; N]]>
where
    T: numpy::Element,
{
    if array.shape()[1] != N {
        let [height, width] = [array.shape()[0], array.shape()[1]];
        return Err(usage(format!(
            "{what} has the shape ({height}, {width}), not (n, {N})"
        )));
    }
    Ok(array.as_slice()?.as_chunks().0)
}
