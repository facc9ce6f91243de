//! Levels inside a file whose names say nothing: plants under one parent that fill the same box, of the same materials,
//! with fewer and fewer triangles.

use std::collections::{BTreeMap, BTreeSet};

use glam::DVec3;
use serde_json::Value;

use super::Document;
use super::levels_inside::LevelsInside;
use super::node::PlacedNode;
use super::property;

/// How far sides of boxes may be apart, as a share of the finest one's extent on that axis. Those of a public tree of
/// three levels are up to .03 apart.
const SAME_BOX: f64 = 0.05;

/// A level has at most this share of the triangles of the next finer one. Levels of that tree have .38 and .35.
const FEWER: f64 = 0.8;

/// A level is a whole plant, so it has several materials: two layers of leaves on one crown have one.
const FEWEST_MATERIALS: usize = 2;

/// What a node and all below it draw.
struct Drawn {
    node: usize,
    /// The lowest corner of its box, in world space.
    min: DVec3,
    /// The highest corner of its box, in world space.
    max: DVec3,
    triangles: u64,
    materials: BTreeSet<Option<u64>>,
}

impl Drawn {
    fn may_be_level(&self) -> bool {
        self.materials.len() >= FEWEST_MATERIALS && self.triangles > 0
    }

    fn is_level_of(&self, finest: &Self, next_finer: &Self) -> bool {
        let most_apart = SAME_BOX * (finest.max - finest.min);
        let is_near = |a: DVec3, b: DVec3| (a - b).abs().cmple(most_apart).all();
        self.materials == finest.materials
            && is_near(self.min, finest.min)
            && is_near(self.max, finest.max)
            && self.triangles as f64 <= FEWER * next_finer.triangles as f64
    }
}

impl Document {
    /// Finds levels that stand in one place, under one parent.
    pub(super) fn find_levels_in_one_place(&self, placed: &[PlacedNode], found: &mut LevelsInside) {
        let mut families: BTreeMap<Option<usize>, Vec<Drawn>> = BTreeMap::new();
        for node in placed {
            if !found.nodes.contains(&node.index)
                && let Some(drawn) = self.drawn_below(node.index, placed)
                && drawn.may_be_level()
            {
                families.entry(node.parent).or_default().push(drawn);
            }
        }
        for mut left in families.into_values() {
            left.sort_by_key(|drawn| std::cmp::Reverse(drawn.triangles));
            while !left.is_empty() {
                let mut levels = vec![left.remove(0)];
                for drawn in std::mem::take(&mut left) {
                    match drawn.is_level_of(&levels[0], &levels[levels.len() - 1]) {
                        true => levels.push(drawn),
                        false => left.push(drawn),
                    }
                }
                let [finest, coarser @ ..] = &levels[..] else {
                    unreachable!("there is one at least")
                };
                if !coarser.is_empty() {
                    found.finest.insert(finest.node);
                }
                for level in coarser {
                    found.coarser.insert(level.node);
                    found.nodes.extend(self.nodes_below(level.node));
                }
            }
        }
    }

    /// What is drawn by a node and all below it; nothing where nothing is, or its accessors do not say where.
    fn drawn_below(&self, node: usize, placed: &[PlacedNode]) -> Option<Drawn> {
        let below = self.nodes_below(node);
        let mut drawn = Drawn {
            node,
            min: DVec3::INFINITY,
            max: DVec3::NEG_INFINITY,
            triangles: 0,
            materials: BTreeSet::new(),
        };
        for part in placed.iter().filter(|part| below.contains(&part.index)) {
            let Some(mesh) = self.root["nodes"][part.index].get("mesh") else {
                continue;
            };
            let mesh = usize::try_from(mesh.as_u64()?).ok()?;
            let mesh = property::entry(&self.root, "meshes", mesh).ok()?;
            for primitive in property::list(mesh, "primitives").ok()? {
                let positions = self.accessor_of(&primitive["attributes"]["POSITION"])?;
                let corners = match primitive.get("indices") {
                    Some(indices) => self.accessor_of(indices)?,
                    None => positions,
                };
                drawn.triangles += corners["count"].as_u64()? / 3;
                drawn.materials.insert(primitive["material"].as_u64());
                let [low, high] = ["min", "max"].map(|end| property::numbers::<3>(positions, end));
                let ends = [low.ok()??, high.ok()??].map(DVec3::from_array);
                for corner in 0..8 {
                    let side = |axis: usize| ends[corner >> axis & 1][axis];
                    let corner = DVec3::new(side(0), side(1), side(2));
                    let corner = part.world_from_node.transform_point3(corner);
                    drawn.min = drawn.min.min(corner);
                    drawn.max = drawn.max.max(corner);
                }
            }
        }
        Some(drawn)
    }

    fn accessor_of(&self, index: &Value) -> Option<&Value> {
        let index = usize::try_from(index.as_u64()?).ok()?;
        property::entry(&self.root, "accessors", index).ok()
    }
}
