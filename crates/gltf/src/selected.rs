//! Which leaves, and which pieces of wood, a selector names.

use super::error::Problem;
use super::parts::Part;
use super::selector::{Label, Labels};
use super::{GltfError, Selector, Tree};
use secateur_model::LeafId;

/// Errors stay sentences: longer lists end in `...`.
const LONGEST_LIST: usize = 12;

impl Tree {
    /// The leaves, and of [`WholeTree::items`](crate::WholeTree::items) the pieces of wood, that a selector names, in
    /// rising order.
    ///
    /// # Errors
    /// [`GltfError`] if it names none; it says what could be named.
    pub fn selected(&self, selector: &Selector) -> Result<Vec<LeafId>, GltfError> {
        let is_named: Vec<bool> = (self.parts.iter())
            .map(|part| selector.matches(self.labels(part)))
            .collect();
        let sources = self.leaf_sources.iter().enumerate();
        let named: Vec<LeafId> = sources
            .filter(|(_, source)| is_named[source.part as usize])
            .map(|(leaf, _)| LeafId::from_index(leaf))
            .collect();
        match named.is_empty() {
            false => Ok(named),
            true => {
                let problem = Problem::SelectorMatchesNothing {
                    selector: selector.to_string(),
                    known: self.known_like(selector),
                };
                Err(GltfError::new(self.document.name(), problem))
            }
        }
    }

    fn labels(&self, part: &Part) -> Labels<'_> {
        let json = &self.document.root["meshes"][part.mesh]["primitives"][part.primitive];
        let material = json["material"].as_u64().map(|index| index as usize);
        Labels {
            material: match material {
                Some(index) => self.document.label("materials", index),
                None => Label {
                    name: "",
                    index: None,
                },
            },
            mesh: self.document.label("meshes", part.mesh),
            node: self.document.label("nodes", part.node),
        }
    }

    /// What a selector of this kind could name.
    fn known_like(&self, selector: &Selector) -> Vec<String> {
        let mut known: Vec<String> = Vec::new();
        for source in &self.leaf_sources {
            let labels = self.labels(&self.parts[source.part as usize]);
            let text = selector.same_kind(labels).to_string();
            if !known.contains(&text) {
                known.push(text);
            }
            if known.len() > LONGEST_LIST {
                known[LONGEST_LIST] = "...".to_owned();
                break;
            }
        }
        known
    }
}
