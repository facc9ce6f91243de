//! What has to be said of parts that could be something else.

use secateur_model::{NamedOption, Note};

use super::choice::Verdict;
use super::parts::Part;
use super::roles::Role;
use super::survey::Survey;
use super::{Document, Selector, property, shape_evidence};

impl Document {
    /// A sentence for each primitive that looks like leaves and wood in one and is taken for one or the other.
    pub(crate) fn warnings_of_mixed(&self, survey: &Survey, parts: &[Part]) -> Vec<Note> {
        let mut are_leaves = vec![false; survey.groups.len()];
        let mut are_split = vec![false; survey.groups.len()];
        for (part, group) in parts.iter().zip(&survey.group_of_part) {
            are_leaves[*group] |= part.role == Role::Leaf;
            are_split[*group] |= part.wood_pieces.is_some();
        }
        let groups = survey.groups.iter().zip(are_leaves).zip(are_split);
        let taken_for_one = groups.filter(|(_, is_split)| !is_split);
        let mixed = taken_for_one.filter_map(|((group, are_leaves), _)| {
            let geometry = &group.geometry;
            let (positions, triangles) = (&geometry.positions, &geometry.triangles);
            let pieces = shape_evidence::sum_up(positions, triangles, geometry.pieces());
            let taken_for = if are_leaves { "leaves" } else { "wood" };
            pieces.are_leaves_and_wood(group.placements).then(|| {
                format!(
                    "{}: {} of its pieces are small and flat and {} large and round, like leaves and wood in one primitive; all of it is taken for {taken_for}",
                    self.primitive_place(group.mesh, group.primitive),
                    pieces.leaf_like,
                    pieces.stem_like
                )
            })
        });
        mixed.map(Note::from).collect()
    }

    /// What of primitives is read otherwise than one may think, or could be something else; a sentence for all that
    /// it is true of.
    pub(crate) fn warnings(
        &self,
        survey: &Survey,
        verdicts: &[Verdict],
        selectors: &[Selector],
    ) -> Vec<Note> {
        let mut about: Vec<(Oddity, Vec<String>)> = Vec::new();
        for (group, verdict) in survey.groups.iter().zip(verdicts) {
            let is_skinned = |&node: &usize| self.root["nodes"][node].get("skin").is_some();
            let json = &self.root["meshes"][group.mesh]["primitives"][group.primitive];
            let has_targets = property::list(json, "targets").is_ok_and(|t| !t.is_empty());
            let of_verdict = match verdict {
                Verdict::NoTriangles => Some(Oddity::NoTriangles),
                Verdict::Unclear if selectors.is_empty() => Some(Oddity::Unclear),
                Verdict::FoliageForWantOfOther if selectors.is_empty() => {
                    Some(Oddity::FoliageForWantOfOther)
                }
                Verdict::Foliage
                | Verdict::FoliageForWantOfOther
                | Verdict::Unclear
                | Verdict::Wood => None,
            };
            let of_shape = [
                group
                    .nodes
                    .iter()
                    .any(is_skinned)
                    .then_some(Oddity::Skinned),
                has_targets.then_some(Oddity::MorphTargets),
            ];
            for oddity in of_shape.into_iter().chain([of_verdict]).flatten() {
                let place = self.primitive_place(group.mesh, group.primitive);
                match about.iter_mut().find(|(known, _)| *known == oddity) {
                    Some((_, places)) => places.push(place),
                    None => about.push((oddity, vec![place])),
                }
            }
        }
        about.iter().map(|(oddity, at)| oddity.of(at)).collect()
    }
}

/// Most primitives that a sentence names.
const MOST_NAMED: usize = 3;

/// What may surprise of a primitive.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Oddity {
    Skinned,
    MorphTargets,
    NoTriangles,
    Unclear,
    FoliageForWantOfOther,
}

impl Oddity {
    /// A sentence about the primitives at these places, at least one.
    fn of(self, places: &[String]) -> Note {
        let (one, several) = match self {
            Self::Skinned => (
                "is skinned; its bind pose is read",
                "are skinned; their bind pose is read",
            ),
            Self::MorphTargets => (
                "has morph targets; its shape at rest is read",
                "have morph targets; their shape at rest is read",
            ),
            Self::NoTriangles => ("has no triangles", "have no triangles"),
            Self::Unclear => (
                "could be foliage, is left as wood; to choose it use ",
                "could be foliage, are left as wood; to choose them use ",
            ),
            Self::FoliageForWantOfOther => (
                "is taken for foliage since its texture is cut out and nothing else looks like leaves; to choose others use ",
                "are taken for foliage since their textures are cut out and nothing else looks like leaves; to choose others use ",
            ),
        };
        let named = places[..places.len().min(MOST_NAMED)].join(", ");
        let note = Note::from(match places.len() - places.len().min(MOST_NAMED) {
            0 if places.len() == 1 => format!("{named}: {one}"),
            0 => format!("{named}: {several}"),
            more => format!("{named} and {more} more: {several}"),
        });
        match self {
            Self::Unclear | Self::FoliageForWantOfOther => note.naming(NamedOption::Foliage),
            Self::Skinned | Self::MorphTargets | Self::NoTriangles => note,
        }
    }
}
