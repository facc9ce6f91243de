//! What the parts of a plant are, for files that were made of it: nothing is guessed twice.

use std::collections::{HashMap, HashSet};

use super::level_names::{of_unnamed_material, without_level};
use super::parts::Part;
use super::roles::Role;
use super::selector::{Label, Labels};
use super::{Document, Selector, Tree};

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
            let role = role_of_most(tree, part);
            let is_leaf = role == Role::Leaf;
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
            let add = |known: &mut Option<Role>| *known = known.filter(|other| *other == role);
            add(known.of_parts.entry([material, node]).or_insert(Some(role)));
            // Numbers of materials are those of one file.
            if let Some(material) = in_levels {
                if part.wood_pieces.is_some() && !has_named_pieces(tree, part) {
                    known.mixed.insert(material.clone());
                }
                add(known.of_materials.entry(material).or_insert(Some(role)));
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

/// Whether pieces of a part were named.
fn has_named_pieces(tree: &Tree, part: &Part) -> bool {
    let own = [part.mesh, part.primitive];
    tree.document().selectors().iter().any(|selector| {
        matches!(selector, Selector::Pieces { mesh, primitive, .. } if [*mesh, *primitive].map(|k| k as usize) == own)
    })
}

/// The role of a part; that of most of its pieces where some were named, which other files can't tell apart.
fn role_of_most(tree: &Tree, part: &Part) -> Role {
    let Some(is_wood) = part
        .wood_pieces
        .as_ref()
        .filter(|_| has_named_pieces(tree, part))
    else {
        return part.role;
    };
    let wood = is_wood.iter().filter(|is_wood| **is_wood).count();
    match 2 * wood > is_wood.len() {
        true => Role::Wood,
        false => Role::Leaf,
    }
}

impl Document {
    /// The selectors that decide what leaves are: none in files that were made of a plant where pieces are named, whose
    /// numbers are those of the plant.
    pub(crate) fn deciding<'s>(&self, selectors: &'s [Selector]) -> &'s [Selector] {
        let of_another = self.known_roles.is_some();
        match of_another && selectors.iter().any(Selector::is_of_pieces) {
            true => &[],
            false => selectors,
        }
    }

    /// With the leaves and the wood of the plant that it was made of, by the names of materials and nodes: where no
    /// selector names the leaves, evidence decides for other parts alone. What was named as not the plant is not.
    pub fn with_roles_of(mut self, original: &Tree) -> Self {
        self.known_roles = Some(KnownRoles::of(original));
        self.not_plant.clone_from(&original.document().not_plant);
        self
    }
}
