//! Names of a level's own for what only that level shows: importers that file materials and images by name
//! would else give all levels those of one. A level that is the plant as it is keeps the names of the plant.

use std::collections::{BTreeMap, BTreeSet};

use serde_json::Value;

use super::super::base_color::sources;
use super::super::draft::Draft;
use super::super::references::as_index;
use super::materials::{meshes_below, visit_materials};
use super::{Level, LevelContent};
use crate::level_names::{of_unnamed_material, with_level};
use crate::material_images::for_each_texture;
use secateur_model::Lod;

/// Numbers of one list of the file, each with the only owner that uses it; none where there are several.
type Owners = BTreeMap<usize, Option<usize>>;

/// Gives materials, images, and named meshes and textures that one level alone shows the number of that level.
/// `others` are nodes of the scene that belong to no level.
pub(super) fn name_levels(draft: &mut Draft, levels: &[Level], nodes: &[usize], others: &[usize]) {
    let own_names: Vec<bool> = levels.iter().map(has_own_names).collect();
    let mut owners = [const { Owners::new() }; 4];
    for (owner, &node) in nodes.iter().chain(others).enumerate() {
        for (list, used) in owners.iter_mut().zip(used_below(draft, node)) {
            for number in used {
                let known = list.entry(number).or_insert(Some(owner));
                *known = known.filter(|known| *known == owner);
            }
        }
    }
    let lists = ["meshes", "materials", "textures", "images"];
    for (list, owners) in lists.into_iter().zip(owners) {
        for (number, owner) in owners {
            let Some(owner) = owner.filter(|&owner| own_names.get(owner) == Some(&true)) else {
                continue;
            };
            let entry = &mut draft.root[list][number];
            let name = entry.get("name").and_then(Value::as_str);
            let name = name.filter(|name| !name.is_empty()).map(str::to_owned);
            let level = &levels[owner];
            let name = name.or_else(|| default_name(list, number));
            // A level's mesh is called after its level already.
            if let Some(name) = name.filter(|name| *name != level.name) {
                entry["name"] = with_level(&name, level.number).into();
            }
        }
    }
}

/// Whether it is made of the plant, and not the plant as it is.
fn has_own_names(level: &Level) -> bool {
    match level.content {
        LevelContent::Tree(lod) => {
            *lod != Lod::original(lod.area_scales().len()) || !level.textures.is_empty()
        }
        LevelContent::Surface(_) => false,
    }
}

/// What it is called in the plant, where it has no name; textures and meshes need none.
fn default_name(list: &str, number: usize) -> Option<String> {
    match list {
        "materials" => Some(of_unnamed_material(number)),
        "images" => Some(format!("image{number}")),
        _ => None,
    }
}

/// The meshes, materials, textures and images that a node and those below it show. Images in files of their own are
/// left out: all levels show the same file.
fn used_below(draft: &mut Draft, node: usize) -> [BTreeSet<usize>; 4] {
    let meshes = meshes_below(&draft.root, node);
    let mut materials = BTreeSet::new();
    for &mesh in &meshes {
        visit_materials(&mut draft.root["meshes"][mesh], &mut |number| {
            materials.extend(as_index(number));
        });
    }
    let mut textures = BTreeSet::new();
    for &material in &materials {
        if let Some(material) = entry(&draft.root, "materials", material) {
            for_each_texture(material, &mut |texture| {
                textures.insert(texture);
            });
        }
    }
    textures.retain(|&texture| entry(&draft.root, "textures", texture).is_some());
    let images = textures
        .iter()
        .filter_map(|&texture| entry(&draft.root, "textures", texture));
    let images = images.flat_map(sources).filter(|&image| {
        entry(&draft.root, "images", image).is_some_and(|image| image.get("bufferView").is_some())
    });
    let images = images.collect();
    materials.retain(|&material| entry(&draft.root, "materials", material).is_some());
    [meshes, materials, textures, images]
}

fn entry<'r>(root: &'r Value, list: &str, number: usize) -> Option<&'r Value> {
    root.get(list)?.get(number)
}
