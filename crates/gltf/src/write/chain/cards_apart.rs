//! In a file of several levels, leaves that kept their cards have the tree's material, and leaves that
//! became triangles beyond their cards one of their own.

use std::collections::{BTreeMap, BTreeSet};

use super::super::beyond_cards::{Remedies, reaching};
use super::super::draft::Draft;
use super::super::references::as_index;
use super::materials::{meshes_below, visit_materials};
use super::{Level, LevelContent};
use crate::error::Fault;
use crate::tree::Tree;

/// Changes the materials of leaves that reach beyond their cards. Returns for each level the materials that
/// took the place of the tree's, by the numbers of those.
pub(super) fn clear_levels(
    draft: &mut Draft,
    tree: &Tree,
    levels: &[Level],
    nodes: &[usize],
) -> Result<Vec<BTreeMap<usize, usize>>, Fault> {
    let mut of_levels = Vec::new();
    for level in levels {
        of_levels.push(match level.content {
            LevelContent::Tree(lod) => reaching(tree, lod)?,
            LevelContent::Surface(_) => BTreeMap::new(),
        });
    }
    let all: BTreeMap<usize, [usize; 2]> =
        of_levels.iter().flatten().map(|(m, p)| (*m, *p)).collect();
    let meshes: Vec<BTreeSet<usize>> = (nodes.iter())
        .map(|node| meshes_below(&draft.root, *node))
        .collect();
    let mut copies = vec![BTreeMap::new(); levels.len()];
    let mut remedies = Remedies::new(tree);
    for (material, shown_by) in all {
        let remedy = remedies.of(material, shown_by)?;
        if remedy.is_nothing() {
            continue;
        }
        let [ours, others]: [BTreeSet<usize>; 2] = [true, false].map(|is_ours| {
            let is_it = |of_level: &BTreeMap<usize, _>| of_level.contains_key(&material) == is_ours;
            let of_side = of_levels
                .iter()
                .zip(&meshes)
                .filter(|(of_level, _)| is_it(of_level));
            of_side.flat_map(|(_, meshes)| meshes).copied().collect()
        });
        // What all levels show alike has no leaves of a level's own.
        let ours: BTreeSet<usize> = ours.difference(&others).copied().collect();
        if !show(draft, &others, material) {
            remedy.apply(draft, tree, material, material);
            continue;
        }
        let fields = draft.root["materials"][material].clone();
        let copy = draft.push("materials", fields);
        remedy.apply(draft, tree, material, copy);
        for mesh in ours {
            visit_materials(&mut draft.root["meshes"][mesh], &mut |number| {
                if as_index(number) == Some(material) {
                    *number = copy.into();
                }
            });
        }
        for (of_level, copies) in of_levels.iter().zip(&mut copies) {
            if of_level.contains_key(&material) {
                copies.insert(material, copy);
            }
        }
    }
    Ok(copies)
}

/// Whether one of these meshes shows a material.
fn show(draft: &mut Draft, meshes: &BTreeSet<usize>, material: usize) -> bool {
    let mut does = false;
    for mesh in meshes {
        visit_materials(&mut draft.root["meshes"][*mesh], &mut |number| {
            does |= as_index(number) == Some(material);
        });
    }
    does
}
