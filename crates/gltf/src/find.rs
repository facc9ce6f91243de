//! Finding the leaves of a document.

use std::collections::HashMap;

use glam::DVec2;

use super::accessor::{Component, Shape};
use super::choice;
use super::cutouts::Cutouts;
use super::error::{ALLOW_MORE, At, Fault, Problem};
use super::levels_inside::LevelsInside;
use super::parts::Part;
use super::picture::Pictures;
use super::property;
use super::report;
use super::role_groups::Judged;
use super::roles::Role;
use super::survey::{Group, Survey};
use super::tree::LeafSource;
use super::vertex_alpha::{self, VertexAlphas};
use super::write::check_references;
use super::write::old_normals::NormalsOfParts;
use super::{Document, GltfError, Inspection, Selector, Tree, WholeTree};
use secateur_model::{Budget, Facing, Foliage, Leaf, LeafId, LeafTriangle, Note};

/// The most triangles of leaves, every instance counted: two gibibytes.
const MAX_LEAF_TRIANGLES: u64 = 16 << 20;

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

/// Leaves and where they come from.
#[derive(Default)]
struct FoundLeaves {
    foliage: Foliage,
    leaf_sources: Vec<LeafSource>,
    leaf_triangles: Vec<u32>,
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
        inspection.notes.extend(self.note_of_draco());
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

    /// The pieces of the parts with a role.
    fn collect(
        &self,
        (survey, parts): (&Survey, &[Part]),
        role: Role,
        pictures: &mut Pictures<'_>,
        warnings: &mut Vec<Note>,
    ) -> Result<FoundLeaves, Fault> {
        check_size((survey, parts), role, &mut pictures.budget)?;
        let alpha_counts = self.vertex_alpha_counts(survey)?;
        let mut cutouts = Cutouts::default();
        let mut skins: HashMap<usize, Skin> = HashMap::new();
        for (part, &index) in parts.iter().zip(&survey.group_of_part) {
            if part.has(role) && !skins.contains_key(&index) {
                let group = &survey.groups[index];
                let mut skin = self.skin(group, &mut cutouts, pictures, warnings)?;
                if alpha_counts && let Some(alphas) = self.vertex_alphas(group)? {
                    let corners = group.geometry.triangles.as_flattened();
                    if corners.iter().any(|corner| alphas.hide([corner])) {
                        skin.hidden = Some((alphas, cutouts.of_nothing(pictures)?));
                    }
                }
                skins.insert(index, skin);
            }
        }
        let mut found = FoundLeaves {
            foliage: Foliage::new(cutouts.masks),
            ..FoundLeaves::default()
        };
        for (number, (part, index)) in parts.iter().zip(&survey.group_of_part).enumerate() {
            if part.has(role) {
                let group = &survey.groups[*index];
                found
                    .push_part(number as u32, (part, role), group, &skins[index])
                    .at(|| {
                        format!(
                            "{} at {}",
                            self.primitive_place(part.mesh, part.primitive),
                            self.place("nodes", part.node)
                        )
                    })?;
                // Instances that become other shapes would have to be written one by one.
                let mesh = &self.root["meshes"][group.mesh];
                let is_alone = property::list(mesh, "primitives").is_ok_and(|all| all.len() == 1);
                let is_whole = is_alone && group.geometry.pieces().len() == 1;
                if role == Role::Leaf && part.instance.is_some() && is_whole {
                    let last = found.foliage.leaves().len() - 1;
                    let shape = *index as u32;
                    found.foliage.set_shape(LeafId::from_index(last), shape);
                }
            }
        }
        Ok(found)
    }

    /// Texture coordinates and mask of a foliage group.
    fn skin(
        &self,
        group: &Group,
        cutouts: &mut Cutouts,
        pictures: &mut Pictures<'_>,
        warnings: &mut Vec<Note>,
    ) -> Result<Skin, Fault> {
        let Some(texture) = group.look.texture else {
            let cutout = cutouts.index(&group.look, pictures)?;
            return Ok(Skin {
                uvs: Vec::new(),
                cutout,
                hidden: None,
            });
        };
        let uvs = self.texture_coordinates(group.mesh, group.primitive, texture.uv_set)?;
        let Some(uvs) = uvs else {
            let place = self.primitive_place(group.mesh, group.primitive);
            let set = texture.uv_set;
            let opaque = "its leaves are taken for opaque";
            warnings
                .push(format!("{place}: has no TEXCOORD_{set} for its texture; {opaque}").into());
            return Ok(Skin {
                uvs: Vec::new(),
                cutout: None,
                hidden: None,
            });
        };
        // NaN in a texture coordinate hides nothing that matters: zero serves.
        let apply = |uv: DVec2| {
            let uv = texture.transform.apply(uv);
            if uv.is_finite() { uv } else { DVec2::ZERO }
        };
        Ok(Skin {
            uvs: uvs.into_iter().map(apply).collect(),
            cutout: cutouts.index(&group.look, pictures)?,
            hidden: None,
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

/// What a group's leaves look like.
struct Skin {
    /// One per position, or none.
    uvs: Vec<DVec2>,
    cutout: Option<u32>,
    /// Alphas of vertices that may hide leaves, and the mask of those that they hide.
    hidden: Option<(VertexAlphas, Option<u32>)>,
}

/// What a triangle of a leaf takes, with room for more behind it, and once more where leaves and
/// wood are joined.
const BYTES_A_TRIANGLE: u64 = 2 * (size_of::<LeafTriangle>() + size_of::<u32>()) as u64;

/// What a leaf takes, likewise.
const BYTES_A_LEAF: u64 = 2 * (size_of::<Leaf>() + size_of::<LeafSource>()) as u64;

fn check_size(
    (survey, parts): (&Survey, &[Part]),
    role: Role,
    budget: &mut Budget,
) -> Result<(), Problem> {
    let (mut triangles, mut leaves) = (0, 0);
    for (part, &group) in parts.iter().zip(&survey.group_of_part) {
        if part.has(role) {
            let geometry = &survey.groups[group].geometry;
            if part.wood_pieces.is_none() {
                triangles += geometry.triangles.len() as u64;
                leaves += geometry.pieces().len() as u64;
                continue;
            }
            for (number, piece) in geometry.pieces().iter().enumerate() {
                if part.role_of(number) == role {
                    triangles += piece.len() as u64;
                    leaves += 1;
                }
            }
        }
    }
    let bytes = BYTES_A_TRIANGLE * triangles + BYTES_A_LEAF * leaves;
    let what = || format!("{leaves} leaves of {triangles} triangles in all");
    budget.take(bytes, what, ALLOW_MORE)?;
    match triangles {
        0 => Err(Problem::EmptyFoliage),
        n if n > MAX_LEAF_TRIANGLES => Err(Problem::TooMuch {
            what: "leaf triangles",
            limit: MAX_LEAF_TRIANGLES,
        }),
        _ => Ok(()),
    }
}

impl FoundLeaves {
    /// These items, then those.
    fn joined(&self, others: &Self) -> Result<Self, Problem> {
        let first = self.leaf_triangles.len() as u32;
        let moved = others.leaf_sources.iter().map(|source| LeafSource {
            part: source.part,
            triangles: first + source.triangles.start..first + source.triangles.end,
        });
        Ok(Self {
            foliage: self.foliage.followed_by(&others.foliage)?,
            leaf_sources: self.leaf_sources.iter().cloned().chain(moved).collect(),
            leaf_triangles: [&self.leaf_triangles[..], &others.leaf_triangles].concat(),
        })
    }

    fn push_part(
        &mut self,
        part_number: u32,
        (part, role): (&Part, Role),
        group: &Group,
        skin: &Skin,
    ) -> Result<(), Problem> {
        let geometry = &group.geometry;
        // Corner by corner: a primitive may use few vertices of a large buffer.
        let place = |v: u32| part.place_vertex(v as usize, geometry.positions[v as usize]);
        let corner_uv = |v: u32| skin.uvs.get(v as usize).copied().unwrap_or_default();
        // A mirror turns the triangles around, and clients cull them the other way.
        let facing = match group.look.double_sided {
            true => Facing::Both,
            false if part.world_from_local.determinant() < 0.0 => Facing::Clockwise,
            false => Facing::Counterclockwise,
        };
        let mut triangles: Vec<LeafTriangle> = Vec::new();
        for (number, leaf) in geometry.pieces().iter().enumerate() {
            if part.role_of(number) != role {
                continue;
            }
            triangles.clear();
            for &t in leaf {
                let [a, b, c] = geometry.triangles[t as usize];
                triangles.push(LeafTriangle {
                    corners: [place(a)?, place(b)?, place(c)?],
                    uvs: [a, b, c].map(corner_uv),
                });
            }
            let corners = leaf.iter().flat_map(|&t| &geometry.triangles[t as usize]);
            let cutout = match &skin.hidden {
                Some((alphas, of_nothing)) if alphas.hide(corners) => *of_nothing,
                Some(_) | None => skin.cutout,
            };
            self.foliage.push_leaf_facing(&triangles, cutout, facing)?;
            let first = self.leaf_triangles.len() as u32;
            self.leaf_triangles.extend_from_slice(leaf);
            self.leaf_sources.push(LeafSource {
                part: part_number,
                triangles: first..self.leaf_triangles.len() as u32,
            });
        }
        Ok(())
    }
}
