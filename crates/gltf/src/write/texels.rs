//! Base colour textures with other texels, read as they were.

use std::collections::{BTreeMap, HashMap};
use std::sync::Arc;

use super::base_color::{
    base_color_texture_mut, drop_copies, drop_unused_formats, png_image, sources, texture_users,
    textures_of,
};
use super::draft::Draft;
use super::drop_unreferenced::remove_field;
use super::references::{as_index, knows_all_extensions};
use crate::material::base_color_texture;
use secateur_model::Texture;

/// Gives materials, by their numbers, base colour images with these texels; samplers stay. What nothing else shows is
/// replaced under its number, so that nothing is left that nobody needs; else a copy goes to the end of the list.
pub(super) fn replace(draft: &mut Draft, texels: &BTreeMap<usize, Arc<Texture>>) {
    if texels.is_empty() {
        return;
    }
    let mut materials_of: BTreeMap<usize, Vec<usize>> = BTreeMap::new();
    for material in texels.keys() {
        if let Some(texture) = base_texture(draft, *material) {
            materials_of.entry(texture).or_default().push(*material);
        }
    }
    let is_known = knows_all_extensions(&draft.root);
    let is_ours: Vec<usize> = materials_of
        .iter()
        .filter(|(texture, own)| is_known && texture_users(&draft.root, **texture) == own.len())
        .map(|(texture, _)| *texture)
        .collect();
    let mut images: HashMap<usize, usize> = HashMap::new();
    for (number, materials) in &materials_of {
        let mut texture = draft.root["textures"][*number].clone();
        let Some(&old) = sources(&texture).first() else {
            continue;
        };
        let source = match images.get(&old) {
            Some(made) => *made,
            None => {
                let is_alone = textures_of(&draft.root)
                    .enumerate()
                    .filter(|(_, other)| sources(other).contains(&old))
                    .all(|(user, _)| is_ours.contains(&user));
                png_image(draft, &texels[&materials[0]], is_alone.then_some(old))
            }
        };
        images.insert(old, source);
        let all_sources = sources(&texture);
        texture["source"] = source.into();
        // A copy in another format would show the texels as they were.
        remove_field(&mut texture, "extensions");
        if is_ours.contains(number) {
            draft.root["textures"][*number] = texture;
            drop_copies(draft, all_sources, source);
            continue;
        }
        let own = draft.push("textures", texture);
        for material in materials {
            if let Some(info) = base_color_texture_mut(&mut draft.root["materials"][*material]) {
                info["index"] = own.into();
            }
        }
    }
    drop_unused_formats(draft);
}

fn base_texture(draft: &Draft, material: usize) -> Option<usize> {
    let fields = draft.root.get("materials")?.get(material)?;
    as_index(base_color_texture(fields)?.get("index")?)
}
