//! What has to be said of parts that could be something else.

use super::choice::Verdict;
use super::parts::Part;
use super::roles::Role;
use super::survey::Survey;
use super::{Document, Selector, property, shape_evidence};

impl Document {
    /// A sentence for each primitive that looks like leaves and wood in one and is taken for one or the other.
    pub(crate) fn warnings_of_mixed(&self, survey: &Survey, parts: &[Part]) -> Vec<String> {
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
        mixed.collect()
    }

    /// What of each primitive is read otherwise than one may think, or could be something else; a sentence each.
    pub(crate) fn warnings(
        &self,
        survey: &Survey,
        verdicts: &[Verdict],
        selectors: &[Selector],
    ) -> Vec<String> {
        let mut warnings = Vec::new();
        for (group, verdict) in survey.groups.iter().zip(verdicts) {
            let place = self.primitive_place(group.mesh, group.primitive);
            let is_skinned = |&node: &usize| self.root["nodes"][node].get("skin").is_some();
            if group.nodes.iter().any(is_skinned) {
                warnings.push(format!("{place}: is skinned; its bind pose is read"));
            }
            let json = &self.root["meshes"][group.mesh]["primitives"][group.primitive];
            if property::list(json, "targets").is_ok_and(|targets| !targets.is_empty()) {
                warnings.push(format!(
                    "{place}: has morph targets; its shape at rest is read"
                ));
            }
            match verdict {
                Verdict::NoTriangles => warnings.push(format!("{place}: has no triangles")),
                Verdict::Unclear if selectors.is_empty() => warnings.push(format!(
                    "{place}: could be foliage, is left as wood; to choose it use `--foliage`"
                )),
                Verdict::FoliageForWantOfOther if selectors.is_empty() => warnings.push(format!(
                    "{place}: is taken for foliage since its texture is cut out and nothing else looks like leaves; to choose others use `--foliage`"
                )),
                Verdict::Foliage
                | Verdict::FoliageForWantOfOther
                | Verdict::Unclear
                | Verdict::Wood => {}
            }
        }
        warnings
    }
}
