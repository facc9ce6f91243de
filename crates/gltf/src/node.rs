//! Nodes: from a node's own space to world space.

use std::collections::HashMap;

use glam::{DMat4, DQuat, DVec3};
use serde_json::Value;

use super::Document;
use super::error::{At, Fault, Problem};
use super::property;

/// The deepest node hierarchy that is followed.
pub(crate) const MAX_DEPTH: usize = 1024;

/// A node of the scene.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PlacedNode {
    /// Its index in the file's `nodes`.
    pub(crate) index: usize,
    /// The index of the node that it is a child of; none of roots.
    pub(crate) parent: Option<usize>,
    /// From the node's own space to world space.
    pub(crate) world_from_node: DMat4,
}

/// Where an animation puts a node at one time; what it leaves alone stays as the node says.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Pose {
    pub(crate) translation: Option<[f64; 3]>,
    pub(crate) rotation: Option<[f64; 4]>,
    pub(crate) scale: Option<[f64; 3]>,
}

/// The node's own matrix, or `None` where it has no transform: multiplying by
/// the identity would be exact too, but for the sign of zeros.
fn parent_from_node(json: &Value, pose: Option<&Pose>) -> Result<Option<DMat4>, Problem> {
    // A node that an animation moves has no matrix (glTF 2.0, 3.5.3).
    if pose.is_none()
        && let Some(columns) = property::numbers::<16>(json, "matrix")?
    {
        return Ok(Some(DMat4::from_cols_array(&columns)));
    }
    let pose = pose.copied().unwrap_or_default();
    let translation = match pose.translation {
        Some(moved) => Some(moved),
        None => property::numbers(json, "translation")?,
    };
    let rotation = match pose.rotation {
        Some(turned) => Some(turned),
        None => property::numbers(json, "rotation")?,
    };
    let scale = match pose.scale {
        Some(scaled) => Some(scaled),
        None => property::numbers(json, "scale")?,
    };
    if translation.is_none() && rotation.is_none() && scale.is_none() {
        return Ok(None);
    }
    Ok(Some(compose(
        translation.map_or(DVec3::ZERO, DVec3::from_array),
        rotation.unwrap_or([0.0, 0.0, 0.0, 1.0]),
        scale.map_or(DVec3::ONE, DVec3::from_array),
    )))
}

/// Translation x rotation x scale. A rotation of length zero is none.
pub(crate) fn compose(translation: DVec3, rotation: [f64; 4], scale: DVec3) -> DMat4 {
    let rotation = DQuat::from_array(rotation);
    let length = rotation.length();
    let unit = if length > 0.0 && length.is_finite() {
        rotation / length
    } else {
        DQuat::IDENTITY
    };
    DMat4::from_scale_rotation_translation(scale, unit, translation)
}

impl Document {
    /// The nodes of the default scene (else scene 0, else all nodes that are no
    /// node's child), parents before children, in depth-first order.
    pub(crate) fn placed_nodes(&self) -> Result<Vec<PlacedNode>, Fault> {
        self.posed_nodes(&HashMap::new())
    }

    /// [`Self::placed_nodes`] with some nodes where an animation puts them.
    pub(crate) fn posed_nodes(
        &self,
        poses: &HashMap<usize, Pose>,
    ) -> Result<Vec<PlacedNode>, Fault> {
        let nodes = property::list(&self.root, "nodes")?;
        let mut visited = vec![false; nodes.len()];
        let mut placed = Vec::new();
        let roots = self.root_nodes(nodes)?;
        let mut stack: Vec<(usize, Option<usize>, DMat4, usize)> = Vec::new();
        let of_root = |&root: &usize| (root, None, DMat4::IDENTITY, 1);
        stack.extend(roots.iter().rev().map(of_root));
        while let Some((index, parent, world_from_parent, depth)) = stack.pop() {
            let json = property::entry(&self.root, "nodes", index)?;
            let place = || self.place("nodes", index);
            if std::mem::replace(&mut visited[index], true) {
                return Err(Problem::NodeTwice).at(place);
            }
            if depth > MAX_DEPTH {
                return Err(Problem::TooDeep(MAX_DEPTH)).at(place);
            }
            let world_from_node = match parent_from_node(json, poses.get(&index)).at(place)? {
                Some(parent_from_node) => world_from_parent * parent_from_node,
                None => world_from_parent,
            };
            placed.push(PlacedNode {
                index,
                parent,
                world_from_node,
            });
            for child in property::list(json, "children").at(place)?.iter().rev() {
                let child = property::list_index("children", child).at(place)?;
                stack.push((child, Some(index), world_from_node, depth + 1));
            }
        }
        Ok(placed)
    }

    fn root_nodes(&self, nodes: &[Value]) -> Result<Vec<usize>, Fault> {
        let scenes = property::list(&self.root, "scenes")?;
        let scene = property::index(&self.root, "scene")?;
        if let Some(scene) = scene.or((!scenes.is_empty()).then_some(0)) {
            let json = property::entry(&self.root, "scenes", scene)?;
            let read = || -> Result<Vec<usize>, Problem> {
                let roots = property::list(json, "nodes")?;
                let index = |root| property::list_index("nodes", root);
                roots.iter().map(index).collect()
            };
            return read().at(|| self.place("scenes", scene));
        }
        let mut is_child = vec![false; nodes.len()];
        for (index, node) in nodes.iter().enumerate() {
            let place = || self.place("nodes", index);
            for child in property::list(node, "children").at(place)? {
                let child = property::list_index("children", child).at(place)?;
                if let Some(flag) = is_child.get_mut(child) {
                    *flag = true;
                }
            }
        }
        Ok((0..nodes.len()).filter(|&node| !is_child[node]).collect())
    }
}
