//! Textures of a level's own, where it has some.
//!
//! What only levels with textures of their own use is replaced under its number, so that nothing
//! is left that nobody needs; else a copy with the new texture goes to the end of the list.

use std::collections::{BTreeMap, HashMap};
use std::sync::Arc;

use serde_json::{Value, json};

use super::super::base_color::{
    base_color_texture_mut, drop_copies, drop_unused_formats, put_png, sampler_number, sources,
    texture_users, textures_of,
};
use super::super::draft::Draft;
use super::super::drop_unreferenced::remove_field;
use super::super::plant::{LINEAR, LINEAR_MIPMAP_LINEAR, png_bytes, wrap_code};
use super::super::references::{as_index, items, knows_all_extensions};
use super::materials::{meshes_below, visit_materials};
use super::{Level, LevelTexture, undrawn_meshes};
use crate::material::base_color_texture;
use crate::material_images::{for_each_texture, rename_texture};
use secateur_model::{Mips, Texture};

/// Gives each level the textures that it brings along. `copies` are the materials that took the place
/// of others in a level, by the numbers of those.
pub(super) fn retexture(
    draft: &mut Draft,
    levels: &[Level],
    nodes: &[usize],
    copies: &[BTreeMap<usize, usize>],
) {
    if levels.iter().all(|level| level.textures.is_empty()) {
        return;
    }
    let undrawn = undrawn_meshes(draft);
    let mut images = Images::default();
    for ((level, &node), copies) in levels.iter().zip(nodes).zip(copies) {
        let meshes = meshes_below(&draft.root, node);
        let mut made: HashMap<usize, usize> = HashMap::new();
        let mut by_material: BTreeMap<usize, Vec<&LevelTexture>> = BTreeMap::new();
        for own in level.textures {
            by_material.entry(own.material).or_default().push(own);
        }
        for (material, own) in by_material {
            let material = *copies.get(&material).unwrap_or(&material);
            let all = users(&mut draft.root, material, |mesh| !undrawn.contains(&mesh));
            let ours = users(&mut draft.root, material, |mesh| meshes.contains(&mesh));
            if ours == 0 {
                continue;
            }
            let is_alone = all == ours && knows_all_extensions(&draft.root);
            if let Some(retextured) = push_material(draft, &mut images, material, &own, is_alone) {
                made.insert(material, retextured);
            }
        }
        for &mesh in &meshes {
            visit_materials(&mut draft.root["meshes"][mesh], &mut |number| {
                if let Some(new) = as_index(number).and_then(|n| made.get(&n)) {
                    *number = (*new).into();
                }
            });
        }
    }
    drop_unused_formats(draft);
}

/// How often meshes name a material.
fn users(root: &mut Value, material: usize, counts: impl Fn(usize) -> bool) -> usize {
    let mut count = 0;
    for (number, mesh) in items(root, "meshes").enumerate() {
        if counts(number) {
            visit_materials(mesh, &mut |n| {
                count += usize::from(as_index(n) == Some(material));
            });
        }
    }
    count
}

/// The material with its new textures, under its own number if nobody else uses it; nothing where it shows none that they
/// could take the place of.
fn push_material(
    draft: &mut Draft,
    images: &mut Images,
    material: usize,
    own: &[&LevelTexture],
    is_alone: bool,
) -> Option<usize> {
    let mut fields = draft.root.get("materials")?.get(material)?.clone();
    let mut is_changed = false;
    for own in own {
        let users = users_of(&fields, &draft.root, own.image);
        for (old, users) in users {
            let is_only_user = is_alone && texture_users(&draft.root, old) == users;
            let texture = push_texture(draft, images, old, own, is_only_user);
            match own.image {
                None => base_color_texture_mut(&mut fields)?["index"] = texture.into(),
                Some(_) => rename_texture(&mut fields, (old, texture)),
            }
            is_changed = true;
        }
    }
    if !is_changed {
        return None;
    }
    if !is_alone {
        return Some(draft.push("materials", fields));
    }
    draft.root["materials"][material] = fields;
    Some(material)
}

/// The textures of a material that show this image, each with how many places name it; of no image that of the base
/// colour.
fn users_of(fields: &Value, root: &Value, image: Option<usize>) -> BTreeMap<usize, usize> {
    let base = base_color_texture(fields);
    let base = base.and_then(|info| info.get("index").and_then(as_index));
    let Some(image) = image else {
        return base.into_iter().map(|texture| (texture, 1)).collect();
    };
    let mut users = BTreeMap::new();
    for_each_texture(fields, &mut |texture| {
        let shows = |fields: &Value| sources(fields).contains(&image);
        if Some(texture) != base && root["textures"].get(texture).is_some_and(shows) {
            *users.entry(texture).or_insert(0) += 1;
        }
    });
    users
}

fn push_texture(
    draft: &mut Draft,
    images: &mut Images,
    old: usize,
    own: &LevelTexture,
    is_alone: bool,
) -> usize {
    let mut fields = draft.root["textures"][old].clone();
    let own_sources = sources(&fields);
    let image_of = |image: &usize| draft.root["images"].get(*image);
    let name = own_sources
        .iter()
        .find_map(|image| image_of(image)?.get("name").cloned());
    let all_sources = textures_of(&draft.root).flat_map(sources);
    let all_sources: Vec<usize> = all_sources.collect();
    let is_last = |&image: &usize| all_sources.iter().filter(|other| **other == image).count() == 1;
    let old_image = sources(&fields).into_iter().find(is_last);
    let source = images.put(draft, &own.texture, old_image.filter(|_| is_alone));
    if let (Some(name), None) = (name, draft.root["images"][source].get("name")) {
        draft.root["images"][source]["name"] = name;
    }
    fields["source"] = source.into();
    // A copy in another format would show the texture as it was.
    remove_field(&mut fields, "extensions");
    if !own.keeps_sampler {
        let old_sampler = fields.get("sampler").and_then(as_index);
        let sampler = sampler_of(&own.texture);
        fields["sampler"] = sampler_number(draft, sampler, old_sampler.filter(|_| is_alone)).into();
    }
    if !is_alone {
        return draft.push("textures", fields);
    }
    draft.root["textures"][old] = fields;
    drop_copies(draft, own_sources, source);
    old
}

fn sampler_of(texture: &Texture) -> Value {
    let [wrap_s, wrap_t] = texture.wrap.map(wrap_code);
    json!({
        "magFilter": LINEAR,
        "minFilter": match texture.filters.mips {
            Mips::None => LINEAR,
            Mips::Nearest | Mips::Blended => LINEAR_MIPMAP_LINEAR,
        },
        "wrapS": wrap_s,
        "wrapT": wrap_t,
    })
}

/// The images that levels brought along, by their texels, each with its buffer view: what several materials or levels
/// show lies in the file once.
#[derive(Default)]
struct Images(HashMap<*const Texture, (usize, usize)>);

impl Images {
    /// The number of the image; that of `instead_of`, where there is one to replace.
    fn put(
        &mut self,
        draft: &mut Draft,
        texture: &Arc<Texture>,
        instead_of: Option<usize>,
    ) -> usize {
        let Some(&(view, image)) = self.0.get(&Arc::as_ptr(texture)) else {
            let view = draft.push_bytes(png_bytes(texture));
            let image = put_png(draft, view, instead_of);
            self.0.insert(Arc::as_ptr(texture), (view, image));
            return image;
        };
        if instead_of.is_none() {
            return image;
        }
        // Else the old image would stay behind.
        let kept = put_png(draft, view, instead_of);
        for texture in items(&mut draft.root, "textures") {
            if texture.get("source").and_then(as_index) == Some(image) {
                texture["source"] = kept.into();
            }
        }
        let images = draft.root.get_mut("images").and_then(Value::as_array_mut);
        if let Some(images) = images.filter(|all| all.len() == image + 1) {
            images.pop();
        }
        self.0.insert(Arc::as_ptr(texture), (view, kept));
        kept
    }
}
