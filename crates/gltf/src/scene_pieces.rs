//! All connected pieces that a scene draws, as leaves, for who chooses among them by where they are drawn.

use std::collections::HashMap;

use super::error::Fault;
use super::parts::Part;
use super::picture::Pictures;
use super::roles::Role;
use super::{Document, GltfError};
use secateur_model::{Foliage, LeafId};

/// The connected pieces of a scene: of the plant, and of what is not the plant but for helpers.
#[derive(Clone, Debug, Default)]
pub struct ScenePieces {
    foliage: Foliage,
    /// By piece: which of the places, and its number in the primitive there.
    sources: Vec<(u32, u32)>,
    places: Vec<String>,
}

impl ScenePieces {
    /// The pieces as leaves in world space. A piece that is drawn several times is as many leaves.
    pub fn foliage(&self) -> &Foliage {
        &self.foliage
    }

    /// The place of a piece's primitive, as in [`PrimitiveReport::place`](crate::PrimitiveReport::place), and the
    /// piece's number in the file.
    ///
    /// # Panics
    /// If the leaf is none of the foliage's.
    pub fn source(&self, leaf: LeafId) -> (&str, u32) {
        let (place, number) = self.sources[leaf.index()];
        (&self.places[place as usize], number)
    }
}

impl Document {
    /// The connected pieces that the scene draws.
    ///
    /// # Errors
    /// [`GltfError`] if the geometry can't be read or there is too much of it.
    pub fn scene_pieces(&self) -> Result<ScenePieces, GltfError> {
        self.read_scene_pieces().map_err(|fault| self.error(fault))
    }

    fn read_scene_pieces(&self) -> Result<ScenePieces, Fault> {
        let (parts, survey, budget) = self.scene_parts()?;
        let groups = survey.groups.iter();
        let places = groups.map(|group| self.primitive_place(group.mesh, group.primitive));
        let mut pieces = ScenePieces {
            places: places.collect(),
            ..ScenePieces::default()
        };
        let mut pictures = Pictures::new(self, budget);
        let surveyed = (&survey, &parts[..]);
        let (foliage, of_leaves) = self.pieces_of(surveyed, Role::Wood, &mut pictures)?;
        pieces.foliage = foliage;
        let mut next: HashMap<u32, usize> = HashMap::new();
        for part in of_leaves {
            // Leaves of a part are its pieces, in their order.
            let piece = next.entry(part).or_default();
            let group = survey.group_of_part[part as usize];
            let Part {
                mesh, primitive, ..
            } = parts[part as usize];
            let number = self.piece_number(mesh, primitive, *piece);
            pieces.sources.push((group as u32, number));
            *piece += 1;
        }
        Ok(pieces)
    }
}
