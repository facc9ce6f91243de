//! What the parts of a plant are, for files that were made of it: nothing is guessed twice.

use std::collections::{HashMap, HashSet};

use super::level_names::{of_unnamed_material, without_level};
use super::roles::Role;
use super::selector::{Label, Labels};
use super::{Document, Tree};

/// Roles by names, which files of one plant share.
#[derive(Clone, Debug, Default)]
pub(crate) struct KnownRoles {
    /// The role of all parts of a material and a node; none where they differ.
    of_parts: HashMap<[String; 2], Option<Role>>,
    /// The role of all parts of a named material; none where they differ.
    of_materials: HashMap<String, Option<Role>>,
    /// Materials of leaves whose primitives have pieces of wood.
    mixed: HashSet<String>,
}

impl KnownRoles {
    fn of(tree: &Tree) -> Self {
        let document = tree.document();
        let mut known = Self::default();
        let mut seen = HashSet::new();
        for part in &tree.parts {
            let is_leaf = part.role == Role::Leaf;
            if !seen.insert((part.mesh, part.primitive, part.node, is_leaf)) {
                continue;
            }
            let Ok(look) = document.look(part.mesh, part.primitive) else {
                continue;
            };
            let material = Label {
                name: &look.name,
                index: look.material,
            };
            let in_levels = match (material.name, material.index) {
                ("", Some(index)) => Some(of_unnamed_material(index)),
                ("", None) => None,
                (name, _) => Some(name.to_owned()),
            };
            let material = material.to_string();
            let node = document.label("nodes", part.node).to_string();
            let add = |known: &mut Option<Role>| *known = known.filter(|role| *role == part.role);
            add(known
                .of_parts
                .entry([material, node])
                .or_insert(Some(part.role)));
            // Numbers of materials are those of one file.
            if let Some(material) = in_levels {
                if part.wood_pieces.is_some() {
                    known.mixed.insert(material.clone());
                }
                add(known
                    .of_materials
                    .entry(material)
                    .or_insert(Some(part.role)));
            }
        }
        known
    }

    /// Whether leaves of a material are known to have pieces of wood among them.
    pub(crate) fn is_mixed(&self, material: &str) -> bool {
        self.mixed.contains(material) || self.mixed.contains(without_level(material))
    }

    /// What a part with these labels is, where that is known: by its own names, else by those without the number of
    /// a level.
    pub(crate) fn role(&self, labels: Labels<'_>) -> Option<Role> {
        let [material, node] = [labels.material, labels.node].map(|label| label.to_string());
        let in_plant = without_level(&material).to_owned();
        [material, in_plant].into_iter().find_map(|material| {
            let of_part = self.of_parts.get(&[material.clone(), node.clone()]);
            let of_part = of_part.copied().flatten();
            of_part.or_else(|| self.of_materials.get(&material).copied().flatten())
        })
    }
}

impl Document {
    /// With the leaves and the wood of the plant that it was made of, by the names of materials and nodes: where no
    /// selector names the leaves, evidence decides for other parts alone.
    pub fn with_roles_of(mut self, original: &Tree) -> Self {
        self.known_roles = Some(KnownRoles::of(original));
        self
    }
}
