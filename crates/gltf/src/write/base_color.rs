//! Base colour textures in the JSON of a draft, and samplers of their own.

use serde_json::{Value, json};

use super::draft::Draft;
use super::drop_unreferenced::drop_extension;
use super::plant::png_bytes;
use super::references::as_index;
use crate::material::{base_color_pointer, base_color_texture};
use crate::material_images::for_each_texture;
use secateur_model::Texture;

/// Whether the JSON of an object is of a format.
type IsFormat = fn(&Value) -> bool;

/// Formats of images that no texture here is written in.
const FORMATS: [(&str, IsFormat); 2] = [
    ("EXT_texture_webp", |root| {
        uses_format(root, "EXT_texture_webp")
    }),
    ("KHR_texture_basisu", |root| {
        uses_format(root, "KHR_texture_basisu")
    }),
];

pub(super) fn textures_of(root: &Value) -> impl Iterator<Item = &Value> {
    let textures = root.get("textures").and_then(Value::as_array);
    textures.into_iter().flatten()
}

pub(super) fn base_color_texture_mut(material: &mut Value) -> Option<&mut Value> {
    let place = base_color_pointer(material);
    material.pointer_mut(place)
}

/// The images of a texture, in whatever format.
pub(super) fn sources(texture: &Value) -> Vec<usize> {
    let extensions = texture.get("extensions").and_then(Value::as_object);
    let extensions = extensions.into_iter().flat_map(|all| all.values());
    let holders = std::iter::once(texture).chain(extensions);
    holders
        .filter_map(|holder| holder.get("source").and_then(as_index))
        .collect()
}

/// The number of a new PNG image; that of `instead_of`, whose place and name it then takes, where there is one.
pub(super) fn png_image(draft: &mut Draft, texture: &Texture, instead_of: Option<usize>) -> usize {
    let view = draft.push_bytes(png_bytes(texture));
    put_png(draft, view, instead_of)
}

/// Puts the image of a PNG in this buffer view.
pub(super) fn put_png(draft: &mut Draft, view: usize, instead_of: Option<usize>) -> usize {
    let mut image = json!({"bufferView": view, "mimeType": "image/png"});
    // A texture may name an image that the file does not have, beside one in another format.
    let before = instead_of.and_then(|old| Some((old, draft.root.get("images")?.get(old)?)));
    let Some((old, before)) = before else {
        return draft.push("images", image);
    };
    for kept in ["name", "extras"] {
        if let Some(value) = before.get(kept) {
            image[kept] = value.clone();
        }
    }
    draft.root["images"][old] = image;
    old
}

/// Leaves out the images of `old`, copies in another format of what `new` replaces, that no texture shows any
/// more: their extension may go. One that is not the last of its list becomes the new image under its number.
pub(super) fn drop_copies(draft: &mut Draft, mut old: Vec<usize>, new: usize) {
    let shown: Vec<usize> = textures_of(&draft.root).flat_map(sources).collect();
    let Some(images) = draft.root.get_mut("images").and_then(Value::as_array_mut) else {
        return;
    };
    old.retain(|image| !shown.contains(image) && *image < images.len());
    old.sort_unstable();
    for image in old.into_iter().rev() {
        if image + 1 == images.len() {
            images.pop();
        } else {
            images[image] = images[new].clone();
        }
    }
}

/// Leaves out the extensions for image formats that no texture uses any more.
pub(super) fn drop_unused_formats(draft: &mut Draft) {
    for (name, is_used) in FORMATS {
        drop_extension(&mut draft.root, name, is_used);
    }
}

fn uses_format(root: &Value, name: &str) -> bool {
    textures_of(root).any(|texture| {
        let extensions = texture.get("extensions");
        extensions.is_some_and(|all| all.get(name).is_some())
    })
}

/// How many places of materials name a texture.
pub(super) fn texture_users(root: &Value, texture: usize) -> usize {
    let mut count = 0;
    let materials = root.get("materials").and_then(Value::as_array);
    for material in materials.into_iter().flatten() {
        for_each_texture(material, &mut |number| {
            count += usize::from(number == texture);
        });
    }
    count
}

/// The number of a sampler with these fields: one that is there already, or a new one. `old` is the
/// sampler of the only texture that is to have it instead: where no other texture uses that, it is
/// changed in place. Two samplers may then be equal, but none is left over.
pub(super) fn sampler_number(draft: &mut Draft, sampler: Value, old: Option<usize>) -> usize {
    let samplers = textures_of(&draft.root).map(|one| one.get("sampler").and_then(as_index));
    let is_last = samplers.filter(|other| *other == old).count() == 1;
    if let Some(old) = old.filter(|_| is_last) {
        draft.root["samplers"][old] = sampler;
        return old;
    }
    let known = draft.root.get("samplers").and_then(Value::as_array);
    let known = known.and_then(|all| all.iter().position(|other| *other == sampler));
    known.unwrap_or_else(|| draft.push("samplers", sampler))
}

/// Changes the sampler of a material's base colour texture for that material alone: others that show
/// the texture, and other textures, keep theirs.
pub(super) fn change_sampler(draft: &mut Draft, material: usize, change: impl FnOnce(&mut Value)) {
    let fields = &draft.root["materials"][material];
    let number = base_color_texture(fields).and_then(|info| info.get("index"));
    let Some(number) = number.and_then(as_index) else {
        return;
    };
    let is_alone = texture_users(&draft.root, number) == 1;
    let mut texture = draft.root["textures"][number].clone();
    let old = texture.get("sampler").and_then(as_index);
    let mut sampler = match old {
        Some(old) => draft.root["samplers"][old].clone(),
        None => json!({}),
    };
    change(&mut sampler);
    texture["sampler"] = sampler_number(draft, sampler, old.filter(|_| is_alone)).into();
    if is_alone {
        draft.root["textures"][number] = texture;
        return;
    }
    let own = draft.push("textures", texture);
    if let Some(info) = base_color_texture_mut(&mut draft.root["materials"][material]) {
        info["index"] = own.into();
    }
}
