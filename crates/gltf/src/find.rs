//! Finding the leaves of a document.

use glam::DVec2;

use super::accessor::{Component, Shape};
use super::choice;
use super::error::{At, Fault, Problem};
use super::found_leaves::FoundLeaves;
use super::levels_inside::LevelsInside;
use super::parts::Part;
use super::picture::Pictures;
use super::report;
use super::role_groups::Judged;
use super::roles::Role;
use super::survey::Survey;
use super::vertex_alpha;
use super::write::check_references;
use super::write::old_normals::NormalsOfParts;
use super::{Document, GltfError, Inspection, Selector, Tree, WholeTree};
use secateur_model::{Foliage, LeafId, Note};

/// What is found in a document.
struct Found {
    parts: Vec<Part>,
    /// The parts that are not the plant.
    others: Vec<Part>,
    levels_inside: LevelsInside,
    vertex_alpha_counts: bool,
    leaves: FoundLeaves,
    /// The pieces of wood, where they are wanted.
    wood: FoundLeaves,
}

/// What a document is searched for.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Wanted {
    /// What its leaves are, if it has any.
    Look,
    Leaves,
    /// Leaves, if it has any, and pieces of wood.
    Whole,
}

impl Document {
    /// Says what is in the file and what would be taken for foliage, and why.
    /// Never fails: what is wrong is told in [`Inspection::problem`].
    pub fn inspect(&self, selectors: &[Selector]) -> Inspection {
        let mut inspection = self.blank_inspection();
        if let Err(fault) = self.find(selectors, Wanted::Look, &mut inspection) {
            inspection.problem = Some(self.error(fault).to_string());
        }
        inspection
    }

    /// Finds the leaves: those of the primitives that the selectors name, or,
    /// without selectors, of those whose evidence is clear (as
    /// [`inspect`](Self::inspect) shows).
    ///
    /// # Errors
    /// [`GltfError`] if the geometry can't be read, a selector matches nothing,
    /// no foliage is found, or anything in the file, read or not, names an accessor,
    /// a buffer view, a mesh or a node that is not there.
    pub fn into_tree(mut self, selectors: &[Selector]) -> Result<Tree, GltfError> {
        let mut inspection = self.blank_inspection();
        let found = self.find(selectors, Wanted::Leaves, &mut inspection);
        let checked = check_references(&mut self.root);
        match found.and_then(|found| checked.map(|()| found).map_err(Fault::from)) {
            Err(fault) => Err(self.error(fault)),
            Ok(Found {
                parts,
                others,
                levels_inside,
                vertex_alpha_counts,
                leaves: found,
                ..
            }) => Ok(Tree {
                document: self.decided(selectors, vertex_alpha_counts),
                old_normals: NormalsOfParts::of(parts.len()),
                parts,
                others,
                levels_inside,
                first_of_wood: LeafId::from_index(found.foliage.leaves().len()),
                foliage: found.foliage,
                leaf_sources: found.leaf_sources,
                leaf_triangles: found.leaf_triangles,
                inspection,
            }),
        }
    }

    /// Finds the leaves as [`into_tree`](Self::into_tree) does, and the pieces of wood: the sets of
    /// triangles of everything else that hang together. A plant may have no leaves: all of it is wood then.
    ///
    /// # Errors
    /// As [`into_tree`](Self::into_tree), or if the plant has no triangle.
    pub fn into_whole_tree(mut self, selectors: &[Selector]) -> Result<WholeTree, GltfError> {
        let mut inspection = self.blank_inspection();
        let found = self.find(selectors, Wanted::Whole, &mut inspection);
        let checked = check_references(&mut self.root);
        let found = found.and_then(|found| checked.map(|()| found).map_err(Fault::from));
        let Found {
            parts,
            others,
            levels_inside,
            vertex_alpha_counts,
            leaves,
            wood,
        } = found.map_err(|fault| self.error(fault))?;
        let items = leaves.joined(&wood);
        let items = items.map_err(|problem| self.error(Fault::from(problem)))?;
        let tree = Tree {
            document: self.decided(selectors, vertex_alpha_counts),
            old_normals: NormalsOfParts::of(parts.len()),
            parts,
            others,
            levels_inside,
            first_of_wood: LeafId::from_index(leaves.foliage.leaves().len()),
            foliage: items.foliage,
            leaf_sources: items.leaf_sources,
            leaf_triangles: items.leaf_triangles,
            inspection,
        };
        Ok(WholeTree {
            tree,
            leaves: leaves.foliage,
            wood: wood.foliage,
        })
    }

    /// What was decided about it goes along.
    fn decided(mut self, selectors: &[Selector], vertex_alpha_counts: bool) -> Self {
        self.selectors = selectors.to_vec();
        self.vertex_alpha_counts = Some(vertex_alpha_counts);
        self
    }

    /// The parts, the foliage and its sources, and the wood likewise where that is wanted. Fills the
    /// inspection as far as it gets.
    fn find(
        &self,
        selectors: &[Selector],
        wanted: Wanted,
        inspection: &mut Inspection,
    ) -> Result<Found, Fault> {
        let Judged {
            mut parts,
            others,
            survey,
            mut pictures,
            evidence,
            verdicts,
        } = self.judged(selectors)?;
        let choice = choice::choose(self, &survey, &verdicts, selectors, &mut parts);
        let are_found = choice.is_ok() && parts.iter().any(|part| part.role == Role::Leaf);
        if self.deciding(selectors).is_empty() && are_found {
            self.find_wood_pieces(&mut parts, &survey, &mut pictures)?;
        }
        report::primitives(inspection, self, &survey, &parts, evidence, selectors);
        report::extents(inspection, &survey, &parts);
        report::others(inspection, self, &others)?;
        let levels_inside = self.levels_inside()?;
        inspection.notes.extend(self.note_of_levels(&levels_inside));
        inspection.warnings = self.warnings(&survey, &verdicts, selectors);
        let of_pictures = pictures.warnings().into_iter().map(Note::from);
        inspection.warnings.extend(of_pictures);
        let hidden = match self.vertex_alpha_counts {
            Some(_) => Vec::new(),
            None => self.hidden_by_vertices(&survey)?,
        };
        for group in hidden.iter().map(|&number| &survey.groups[number]) {
            let place = self.primitive_place(group.mesh, group.primitive);
            inspection.warnings.push(vertex_alpha::warning(&place));
        }
        inspection
            .warnings
            .extend(self.warnings_of_mixed(&survey, &parts));
        choice?;
        if !are_found {
            let candidates = choice::advice(self, &survey, &verdicts);
            inspection.candidates.clone_from(&candidates);
            let is_refused = wanted == Wanted::Leaves || candidates.is_empty();
            if is_refused {
                return Err(Problem::NoFoliage { candidates }.into());
            }
            let note = "no leaves were found: all of it is taken for solid surface";
            inspection.notes.push(note.to_owned());
        }
        let surveyed = (&survey, &parts[..]);
        let leaves = match are_found {
            true => {
                let warnings = &mut inspection.warnings;
                self.collect(surveyed, Role::Leaf, &mut pictures, warnings)?
            }
            false => FoundLeaves::default(),
        };
        report::foliage(inspection, &leaves.foliage);
        let has_wood = parts.iter().any(|part| part.has(Role::Wood));
        let wood = match wanted == Wanted::Whole && has_wood {
            // Warnings about textures of wood are no matter of leaves.
            true => self.collect(surveyed, Role::Wood, &mut pictures, &mut Vec::new())?,
            false => FoundLeaves::default(),
        };
        Ok(Found {
            parts,
            others,
            levels_inside,
            vertex_alpha_counts: self.vertex_alpha_counts.unwrap_or(hidden.is_empty()),
            leaves,
            wood,
        })
    }

    /// `TEXCOORD_n` as the file has it, one per position, or `None`.
    pub(crate) fn texture_coordinates(
        &self,
        mesh: usize,
        primitive: usize,
        set: usize,
    ) -> Result<Option<Vec<DVec2>>, Fault> {
        let name = format!("TEXCOORD_{set}");
        let uvs = self.vectors_of::<2>(mesh, primitive, &name)?;
        Ok(uvs.map(|uvs| uvs.into_iter().map(DVec2::from_array).collect()))
    }

    /// An attribute as arrays of numbers, one per position, or `None` where the
    /// primitive doesn't have it.
    pub(crate) fn vectors_of<const N: usize>(
        &self,
        mesh: usize,
        primitive: usize,
        name: &str,
    ) -> Result<Option<Vec<[f64; N]>>, Fault> {
        let Some(index) = self.attribute(mesh, primitive, name)? else {
            return Ok(None);
        };
        let place = || self.primitive_place(mesh, primitive);
        let accessor = self.accessor(index)?;
        if accessor.shape != Shape::Vector(N) || accessor.component == Component::U32 {
            return Err(Problem::WrongKind {
                found: format!("{} ({})", self.place("accessors", index), accessor.kind()),
                role: name.to_owned(),
            })
            .at(place);
        }
        let positions = self.attribute(mesh, primitive, "POSITION")?;
        let expected = positions.map_or(Ok(0), |p| self.accessor(p).map(|a| a.count))?;
        if accessor.count != expected {
            return Err(Problem::CountMismatch {
                attribute: name.to_owned(),
                found: accessor.count,
                other: "POSITION".to_owned(),
                expected,
            })
            .at(place);
        }
        Ok(Some(self.elements(index)?.vectors().collect()))
    }
}

impl Document {
    /// The pieces of the parts with a role, as leaves, with the part of each.
    pub(crate) fn pieces_of(
        &self,
        surveyed: (&Survey, &[Part]),
        role: Role,
        pictures: &mut Pictures<'_>,
    ) -> Result<(Foliage, Vec<u32>), Fault> {
        let found = self.collect(surveyed, role, pictures, &mut Vec::new())?;
        let parts = found.leaf_sources.iter().map(|source| source.part);
        Ok((found.foliage, parts.collect()))
    }
}

/// Everything that is drawn, ground too, piece by piece as if it were foliage.
pub(crate) fn triangles_of_all(document: &Document) -> Result<Foliage, Fault> {
    let (parts, survey, budget) = document.scene_parts()?;
    if survey
        .groups
        .iter()
        .all(|group| group.geometry.triangles.is_empty())
    {
        return Ok(Foliage::default());
    }
    let mut pictures = Pictures::new(document, budget);
    let surveyed = (&survey, &parts[..]);
    let (foliage, _) = document.pieces_of(surveyed, Role::Wood, &mut pictures)?;
    Ok(foliage)
}
