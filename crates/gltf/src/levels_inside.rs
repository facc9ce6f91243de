//! Levels that a file has already. The finest is the plant; the others are left out.
//!
//! They are known by the extension MSFT_lod, by names of nodes under one parent (else of their meshes) such
//! as `Oak_LOD0`, `Oak_LOD1` and `Oak_LOD2_Billboard`, or as they stand [in one place](super::levels_in_one_place).

use std::collections::{BTreeMap, BTreeSet};

use serde_json::Value;

use super::Document;
use super::error::Fault;
use super::node::PlacedNode;
use super::property;

/// The coarser levels of a file.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(crate) struct LevelsInside {
    /// The nodes of the finest levels of which there are coarser ones.
    pub(super) finest: BTreeSet<usize>,
    /// The node of each coarser level.
    pub(crate) coarser: BTreeSet<usize>,
    /// These and all nodes below them.
    pub(crate) nodes: BTreeSet<usize>,
}

/// What the name of a level says.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct LevelName<'a> {
    /// What it is a level of.
    stem: &'a str,
    /// Its number, 0 being the finest.
    number: u32,
}

/// Reads a name such as `Oak_LOD1`, `oak-lod_2_billboard` or `LOD0.001`.
fn level_name(name: &str) -> Option<LevelName<'_>> {
    const WORD: &str = "LOD";
    let upper = name.to_ascii_uppercase();
    upper.rmatch_indices(WORD).find_map(|(start, _)| {
        let (before, after) = (&name[..start], &name[start + WORD.len()..]);
        let last = before.chars().next_back();
        let begins_a_word = match name[start..].starts_with(WORD) {
            true => last.is_none_or(|c| !c.is_uppercase()),
            false => last.is_none_or(|c| !c.is_alphabetic()),
        };
        let after = after.strip_prefix(['_', '-', ' ', '.']).unwrap_or(after);
        let digits = after.len() - after.trim_start_matches(|c: char| c.is_ascii_digit()).len();
        let number = after[..digits].parse().ok().filter(|_| digits <= 3)?;
        begins_a_word.then_some(LevelName {
            stem: before.trim_end_matches(['_', '-', ' ', '.']),
            number,
        })
    })
}

/// Whether a name is that of a picture of the plant.
fn is_picture_name(name: &str) -> bool {
    let lower = name.to_ascii_lowercase();
    let words = ["billboard", "impostor", "imposter"];
    words.iter().any(|word| lower.contains(word))
}

impl Document {
    /// The levels inside the scene.
    pub(crate) fn levels_inside(&self) -> Result<LevelsInside, Fault> {
        let placed = self.placed_nodes()?;
        let mut found = LevelsInside::default();
        self.find_linked_levels(&placed, &mut found)?;
        self.find_named_levels(&placed, &mut found);
        self.find_levels_in_one_place(&placed, &mut found);
        Ok(found)
    }

    /// Levels by MSFT_lod.
    fn find_linked_levels(
        &self,
        placed: &[PlacedNode],
        found: &mut LevelsInside,
    ) -> Result<(), Fault> {
        for node in placed {
            let json = property::entry(&self.root, "nodes", node.index)?;
            let ids = json.pointer("/extensions/MSFT_lod/ids");
            let ids = ids.and_then(Value::as_array).into_iter().flatten();
            for id in ids.filter_map(|id| usize::try_from(id.as_u64()?).ok()) {
                let below = self.nodes_below(id);
                // A level that holds a finer one is none.
                if !below.contains(&node.index) && below.is_disjoint(&found.finest) {
                    found.finest.insert(node.index);
                    found.coarser.insert(id);
                    found.nodes.extend(below);
                }
            }
        }
        Ok(())
    }

    /// Levels by the names of nodes under one parent.
    fn find_named_levels(&self, placed: &[PlacedNode], found: &mut LevelsInside) {
        let mut families: BTreeMap<Option<usize>, Vec<usize>> = BTreeMap::new();
        for node in placed
            .iter()
            .filter(|node| !found.nodes.contains(&node.index))
        {
            families.entry(node.parent).or_default().push(node.index);
        }
        for siblings in families.into_values().filter(|nodes| nodes.len() > 1) {
            let named: Vec<(usize, LevelName<'_>)> = siblings
                .iter()
                .filter_map(|&node| Some((node, self.level_name_of(node)?)))
                .filter(|(node, _)| self.draws(*node))
                .collect();
            let mut finest_of: BTreeMap<&str, u32> = BTreeMap::new();
            let mut coarsest_of: BTreeMap<&str, u32> = BTreeMap::new();
            for (_, level) in &named {
                let finest = finest_of.entry(level.stem).or_insert(level.number);
                *finest = level.number.min(*finest);
                let coarsest = coarsest_of.entry(level.stem).or_insert(level.number);
                *coarsest = level.number.max(*coarsest);
            }
            // `Oak` beside `Oak_LOD1` is the finest where there is no `Oak_LOD0`.
            for &node in &siblings {
                let is_named = named.iter().any(|(other, _)| *other == node);
                if let Some(number) = finest_of.get_mut(self.label("nodes", node).name)
                    && !is_named
                    && *number > 0
                    && self.draws(node)
                {
                    *number = 0;
                    found.finest.insert(node);
                }
            }
            let has_levels = |stem: &str| finest_of[stem] < coarsest_of[stem];
            let stems = coarsest_of.keys().filter(|stem| has_levels(stem));
            let Some(coarsest) = stems.map(|stem| coarsest_of[stem]).max() else {
                continue;
            };
            let of_siblings = siblings.iter().map(|&node| {
                let level = named.iter().find(|(other, _)| *other == node);
                (node, level.map(|(_, level)| *level))
            });
            for (node, level) in of_siblings {
                let is_coarser = match level {
                    Some(level) if has_levels(level.stem) => level.number > finest_of[level.stem],
                    // `Billboard_LOD3` beside `Bark_LOD0` to `Bark_LOD2`.
                    Some(level) => level.number > coarsest || self.is_picture(node),
                    None => self.is_picture(node),
                };
                if is_coarser {
                    found.coarser.insert(node);
                    found.nodes.extend(self.nodes_below(node));
                } else if level.is_some_and(|level| has_levels(level.stem)) {
                    found.finest.insert(node);
                }
            }
        }
    }

    fn level_name_of(&self, node: usize) -> Option<LevelName<'_>> {
        level_name(self.label("nodes", node).name).or_else(|| {
            let mesh = self.root["nodes"][node].get("mesh")?.as_u64()?;
            level_name(self.label("meshes", usize::try_from(mesh).ok()?).name)
        })
    }

    fn is_picture(&self, node: usize) -> bool {
        self.draws(node) && is_picture_name(self.label("nodes", node).name)
    }

    /// Whether a node, or one below it, draws something.
    fn draws(&self, node: usize) -> bool {
        let mut below = self.nodes_below(node).into_iter();
        below.any(|node| self.root["nodes"][node].get("mesh").is_some())
    }

    /// A node and all below it; none where there is no such node.
    pub(super) fn nodes_below(&self, node: usize) -> BTreeSet<usize> {
        let mut below = BTreeSet::new();
        let mut left = vec![node];
        while let Some(node) = left.pop() {
            let Some(json) = self.root.get("nodes").and_then(|nodes| nodes.get(node)) else {
                continue;
            };
            if below.insert(node) {
                let children = json.get("children").and_then(Value::as_array);
                let children = children.into_iter().flatten().filter_map(Value::as_u64);
                left.extend(children.filter_map(|child| usize::try_from(child).ok()));
            }
        }
        below
    }

    /// Which nodes are coarser levels, in a sentence; none where there are none.
    pub(crate) fn note_of_levels(&self, levels: &LevelsInside) -> Option<String> {
        const SHOWN: usize = 12;
        let names = |nodes: &BTreeSet<usize>| {
            let shown = nodes.iter().take(SHOWN);
            let mut names: Vec<String> = shown
                .map(|&node| self.label("nodes", node).to_string())
                .collect();
            if nodes.len() > SHOWN {
                names.push(format!("and {} more", nodes.len() - SHOWN));
            }
            names.join(", ")
        };
        let (finest, coarser) = (names(&levels.finest), names(&levels.coarser));
        match levels.coarser.len() {
            0 => None,
            1 => Some(format!(
                "1 node is a coarser level of {finest} and is left out: {coarser}"
            )),
            many => Some(format!(
                "{many} nodes are coarser levels of {finest} and are left out: {coarser}"
            )),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_of_levels() {
        let read = |name| level_name(name).map(|level| (level.stem, level.number));
        for (name, expected) in [
            ("Oak_LOD0", Some(("Oak", 0))),
            ("Oak_LOD3_Billboard", Some(("Oak", 3))),
            ("oak-lod_12.001", Some(("oak", 12))),
            ("OakLOD1", Some(("Oak", 1))),
            ("LOD2", Some(("", 2))),
            ("Eiche 5 LOD 1", Some(("Eiche 5", 1))),
            ("Oak_LOD2_LOD0", Some(("Oak_LOD2", 0))),
            ("äöü_LOD1_äöü", Some(("äöü", 1))),
            // No level, or no word of its own.
            ("Oak_LOD", None),
            ("Oak", None),
            ("explod1", None),
            ("EXPLOD1", None),
            ("Oak_LOD2024", None),
            ("", None),
        ] {
            assert_eq!(read(name), expected, "{name}");
        }
    }
}
