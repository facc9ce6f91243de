//! Levels that are no edit of the tree, such as impostors: a mesh of its own with textures of its
//! own.

use glam::{DVec3, Vec3};
use serde_json::{Map, Value, json};

use super::super::content::{Content, finished};
use super::super::draft::{Draft, NewElements, Role};
use super::super::drop_unreferenced::References;
use super::super::plant::{LINEAR, LINEAR_MIPMAP_LINEAR, png_bytes, wrap_code};
use super::Level;
use super::placement::move_node;
use super::vertices::push_indices;
use crate::Document;
use crate::accessor::{Component, Shape};
use crate::container::glb_bytes;
use crate::error::{Fault, Problem};
use secateur_model::{AlphaMode, Material, Mips, Surface, Texture};

/// The node of a level that is made of this surface, its mesh about this point of the scene.
pub(super) fn push_node(
    draft: &mut Draft,
    level: &Level,
    surface: &Surface,
    pivot: DVec3,
) -> usize {
    let mut node = json!({"name": level.name});
    if !surface.triangles.is_empty() {
        node["mesh"] = push_mesh(draft, &level.name, surface, pivot).into();
    }
    if !level.facts.is_empty() {
        node["extras"] = level.facts.clone().into();
    }
    draft.push("nodes", node)
}

/// A file with nothing but such a level, which stands there; who made the tree is said in it too.
pub(super) fn alone(
    document: &Document,
    level: &Level,
    surface: &Surface,
    pivot: DVec3,
) -> Result<Content, Fault> {
    let asset = document.root.get("asset").cloned();
    let asset = asset.unwrap_or_else(|| json!({"version": "2.0"}));
    let root = json!({"asset": asset, "scene": 0, "scenes": [{}]});
    let glb = glb_bytes(&root, Vec::new())
        .ok_or(Problem::from(crate::write_problem::WriteProblem::TooLarge))?;
    let empty = Document::from_bytes(&document.name, glb, None);
    let empty = empty.unwrap_or_else(|error| unreachable!("a scene of nothing is read: {error}"));
    let mut draft = Draft::new(&empty);
    let before = References::of(&mut draft.root);
    let node = push_node(&mut draft, level, surface, pivot);
    move_node(&mut draft.root["nodes"][node], pivot);
    draft.root["scenes"][0]["nodes"] = json!([node]);
    finished(draft, &before, surface.triangles.len() as u64)
}

fn push_mesh(draft: &mut Draft, name: &str, surface: &Surface, pivot: DVec3) -> usize {
    let mut attributes = Map::new();
    let positions = surface
        .positions
        .iter()
        .map(|p| (p - pivot).as_vec3().to_array());
    let bounded = true;
    let accessor = push_floats(draft, positions.collect(), bounded);
    attributes.insert("POSITION".into(), accessor.into());
    if !surface.normals.is_empty() {
        let unit = |n: &Vec3| n.normalize_or(Vec3::Z).to_array();
        let normals = surface.normals.iter().map(unit).collect();
        attributes.insert("NORMAL".into(), push_floats(draft, normals, false).into());
        if surface.material.finish.normal_map.is_some() && !surface.uvs.is_empty() {
            let tangents = push_floats(draft, tangents(surface), false);
            attributes.insert("TANGENT".into(), tangents.into());
        }
    }
    if !surface.uvs.is_empty() {
        let uvs = surface.uvs.iter().map(|uv| uv.to_array()).collect();
        attributes.insert("TEXCOORD_0".into(), push_floats(draft, uvs, false).into());
    }
    let corners = surface.triangles.as_flattened();
    let indices = push_indices(draft, None, corners, surface.positions.len());
    let material = push_material(draft, name, &surface.material);
    let primitive = json!({"attributes": attributes, "indices": indices, "material": material});
    draft.push("meshes", json!({"name": name, "primitives": [primitive]}))
}

/// Along u, square to the normal, with the side on which the picture's top is (the specification's
/// `TANGENT`).
fn tangents(surface: &Surface) -> Vec<[f32; 4]> {
    let mut along = vec![(DVec3::ZERO, DVec3::ZERO); surface.positions.len()];
    for corners in &surface.triangles {
        let [a, b, c] = corners.map(|corner| surface.positions[corner as usize]);
        let [ua, ub, uc] = corners.map(|corner| surface.uvs[corner as usize].as_dvec2());
        let (ab, ac, du, dv) = (b - a, c - a, ub - ua, uc - ua);
        let side = du.perp_dot(dv).signum();
        let of_u = (ab * dv.y - ac * du.y) * side;
        let upward = (ab * dv.x - ac * du.x) * side;
        for corner in corners {
            along[*corner as usize].0 += of_u;
            along[*corner as usize].1 += upward;
        }
    }
    let tangent = |((of_u, upward), normal): (&(DVec3, DVec3), &Vec3)| {
        let normal = normal.as_dvec3().normalize_or(DVec3::Z);
        let flat = *of_u - normal * normal.dot(*of_u);
        let tangent = flat.normalize_or(normal.any_orthonormal_vector());
        let side = match normal.cross(tangent).dot(*upward) < 0.0 {
            true => -1.0,
            false => 1.0,
        };
        let [x, y, z] = tangent.as_vec3().to_array();
        [x, y, z, side]
    };
    along.iter().zip(&surface.normals).map(tangent).collect()
}

fn push_floats<const N: usize>(draft: &mut Draft, vectors: Vec<[f32; N]>, bounded: bool) -> usize {
    let new = NewElements {
        component: Component::F32,
        shape: Shape::Vector(N),
        normalized: false,
        count: vectors.len(),
        bytes: Some(
            vectors
                .iter()
                .flatten()
                .flat_map(|x| x.to_le_bytes())
                .collect(),
        ),
        bounded,
        role: Role::Vertex,
    };
    draft.push_accessor(None, new)
}

fn push_material(draft: &mut Draft, name: &str, material: &Material) -> usize {
    let mut pbr = json!({
        "baseColorFactor": material.base_color,
        "metallicFactor": 0,
        "roughnessFactor": material.finish.roughness,
    });
    if let Some(texture) = &material.texture {
        pbr["baseColorTexture"] = json!({"index": push_texture(draft, name, texture)});
    }
    let mut fields = json!({"name": name, "pbrMetallicRoughness": pbr});
    if let Some(map) = &material.finish.normal_map {
        let index = push_texture(draft, &format!("{name}_normal"), &map.texture);
        fields["normalTexture"] = json!({"index": index, "scale": map.scale});
    }
    match material.alpha_mode {
        AlphaMode::Opaque => {}
        AlphaMode::Mask(cutoff) => {
            fields["alphaMode"] = "MASK".into();
            fields["alphaCutoff"] = json!(cutoff);
        }
        AlphaMode::Blend => fields["alphaMode"] = "BLEND".into(),
    }
    if material.double_sided {
        fields["doubleSided"] = true.into();
    }
    draft.push("materials", fields)
}

fn push_texture(draft: &mut Draft, name: &str, texture: &Texture) -> usize {
    let view = draft.push_bytes(png_bytes(texture));
    let source = draft.push(
        "images",
        json!({"name": name, "bufferView": view, "mimeType": "image/png"}),
    );
    let [wrap_s, wrap_t] = texture.wrap.map(wrap_code);
    let far = match texture.filters.mips {
        Mips::None => LINEAR,
        Mips::Nearest | Mips::Blended => LINEAR_MIPMAP_LINEAR,
    };
    let sampler = json!({
        "magFilter": LINEAR,
        "minFilter": far,
        "wrapS": wrap_s,
        "wrapT": wrap_t,
    });
    let known = draft.root.get("samplers").and_then(Value::as_array);
    let known = known.and_then(|all| all.iter().position(|other| *other == sampler));
    let sampler = known.unwrap_or_else(|| draft.push("samplers", sampler));
    draft.push("textures", json!({"sampler": sampler, "source": source}))
}
