//! The leaves, or the pieces of wood, of parts: their triangles in world space, and where in the file these come from.

use std::collections::HashMap;

use glam::DVec2;
use secateur_model::{Budget, Facing, Foliage, Leaf, LeafId, LeafTriangle, Note};

use super::Document;
use super::cutouts::Cutouts;
use super::error::{ALLOW_MORE, At, Fault, Problem};
use super::parts::Part;
use super::picture::Pictures;
use super::property;
use super::roles::Role;
use super::survey::{Group, Survey};
use super::tree::LeafSource;
use super::vertex_alpha::VertexAlphas;

/// The most triangles of leaves, every instance counted: two gibibytes.
const MAX_LEAF_TRIANGLES: u64 = 16 << 20;

/// Leaves and where they come from.
#[derive(Default)]
pub(super) struct FoundLeaves {
    pub(super) foliage: Foliage,
    pub(super) leaf_sources: Vec<LeafSource>,
    pub(super) leaf_triangles: Vec<u32>,
}

impl Document {
    /// The pieces of the parts with a role.
    pub(super) fn collect(
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

/// What a leaf takes, with as much room.
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
    /// Its leaves, then those of others.
    pub(super) fn joined(&self, others: &Self) -> Result<Self, Problem> {
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
