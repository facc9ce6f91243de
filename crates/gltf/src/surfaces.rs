//! What a tree looks like: textured triangles in world space, for renderers.

use std::sync::Arc;

use glam::{DMat3, DMat4, DVec2, DVec3, Vec2, Vec3, Vec4};

use super::accessor::Shape;
use super::choice;
use super::error::{ALLOW_MORE, At, Fault, Problem};
use super::material::TextureUse;
use super::parts::{Part, check_limit};
use super::picture::Pictures;
use super::role_groups::Judged;
use super::survey::{Group, Survey};
use super::{Document, GltfError, Selector, Tree};
use secateur_model::{Finish, Hold, Material, NormalMap, Surface, Texture};

/// The most triangles that surfaces are made of, every instance counted.
const MAX_TRIANGLES: u64 = 16 << 20;

/// The most vertices of surfaces, every instance counted.
const MAX_VERTICES: u64 = 3 * MAX_TRIANGLES;

/// What a triangle to draw takes, with room for more behind it.
const BYTES_A_TRIANGLE: u64 = 2 * size_of::<[u32; 3]>() as u64;

/// What a vertex takes, likewise: position, normal, texture coordinates and colour.
const BYTES_A_VERTEX: u64 =
    2 * (2 * size_of::<Vec3>() + size_of::<Vec2>() + size_of::<Vec4>()) as u64;

/// And of what a vertex hangs on, where the file says it.
const BYTES_A_HOLD: u64 = 2 * size_of::<Hold>() as u64;

/// How much of a look is read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Detail {
    /// Colours, as the renders that judge need them.
    Color,
    /// Colours, normal maps and what vertices hang on, as a renderer with lights and wind needs them.
    Full,
}

/// A surface, and what of the file it is.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct DrawnSurface {
    /// The surface in world space, with its material.
    pub surface: Surface,
    /// Whether it is foliage.
    pub is_foliage: bool,
    /// The number of its material; none for glTF's default material.
    pub material: Option<usize>,
    /// The place of its primitive, as in [`PrimitiveReport::place`](crate::PrimitiveReport::place).
    pub place: String,
}

impl Document {
    /// Everything of the plant, as textured triangles in world space: a
    /// surface for each primitive, all its instances in it, with whether it is
    /// foliage (as the selectors say or the evidence shows; nothing is, where
    /// it can't be told).
    ///
    /// Triangles of mirrored nodes are turned, so that front faces stay front
    /// faces. Images that can't be decoded are left out.
    ///
    /// # Errors
    /// [`GltfError`] if the geometry can't be read or there is too much of it.
    pub fn surfaces(&self, selectors: &[Selector]) -> Result<Vec<(Surface, bool)>, GltfError> {
        self.surfaces_with(Detail::Color, selectors)
    }

    /// As [`Document::surfaces`], in more or less detail.
    ///
    /// # Errors
    /// As [`Document::surfaces`].
    pub fn surfaces_with(
        &self,
        detail: Detail,
        selectors: &[Selector],
    ) -> Result<Vec<(Surface, bool)>, GltfError> {
        let drawn = self.drawn(detail, selectors)?;
        Ok(drawn
            .into_iter()
            .map(|d| (d.surface, d.is_foliage))
            .collect())
    }

    /// As [`Document::surfaces_with`], with the material of each.
    ///
    /// # Errors
    /// As [`Document::surfaces`].
    pub fn drawn(
        &self,
        detail: Detail,
        selectors: &[Selector],
    ) -> Result<Vec<DrawnSurface>, GltfError> {
        let read = || -> Result<_, Fault> {
            let Judged {
                mut parts,
                survey,
                mut pictures,
                verdicts,
                ..
            } = self.judged(selectors)?;
            // Where a selector matches nothing a tree can still be looked at.
            let _ = choice::choose(self, &survey, &verdicts, selectors, &mut parts);
            if self.deciding(selectors).is_empty() {
                self.find_wood_pieces(&mut parts, &survey, &mut pictures)?;
            }
            self.surfaces_of(&parts, &survey, &mut pictures, detail)
        };
        read().map_err(|fault| self.error(fault))
    }

    /// As [`Document::drawn`], where it does not matter what is foliage: nothing is said to be.
    ///
    /// # Errors
    /// As [`Document::surfaces`].
    pub fn drawn_as_one(&self, detail: Detail) -> Result<Vec<DrawnSurface>, GltfError> {
        let read = || -> Result<_, Fault> {
            let sorted = self.sorted_parts(&[])?;
            let mut pictures = Pictures::new(self, sorted.budget);
            self.surfaces_of(&sorted.plant, &sorted.survey, &mut pictures, detail)
        };
        read().map_err(|fault| self.error(fault))
    }

    /// As [`Document::drawn_as_one`], of a scene that may be anything: ground is drawn too.
    ///
    /// # Errors
    /// As [`Document::surfaces`].
    pub fn drawn_scene(&self, detail: Detail) -> Result<Vec<DrawnSurface>, GltfError> {
        let read = || -> Result<_, Fault> {
            let (parts, survey, budget) = self.scene_parts()?;
            let mut pictures = Pictures::new(self, budget);
            self.surfaces_of(&parts, &survey, &mut pictures, detail)
        };
        read().map_err(|fault| self.error(fault))
    }

    pub(super) fn surfaces_of(
        &self,
        parts: &[Part],
        survey: &Survey,
        pictures: &mut Pictures<'_>,
        detail: Detail,
    ) -> Result<Vec<DrawnSurface>, Fault> {
        let all = |count: fn(&Group) -> usize| -> u64 {
            let placed = |group: &Group| group.placements as u64 * count(group) as u64;
            survey.groups.iter().map(placed).sum()
        };
        let triangles = all(|g| g.geometry.triangles.len());
        check_limit("triangles to draw", triangles, MAX_TRIANGLES)?;
        let vertices = all(|g| g.geometry.positions.len());
        check_limit("vertices to draw", vertices, MAX_VERTICES)?;
        let mut bytes = BYTES_A_TRIANGLE * triangles + BYTES_A_VERTEX * vertices;
        if detail == Detail::Full {
            let sways = |g: &&Group| self.says_what_it_hangs_on(g.mesh, g.primitive);
            let swaying = survey.groups.iter().filter(sways);
            bytes += swaying
                .map(|g| BYTES_A_HOLD * g.placements as u64 * g.geometry.positions.len() as u64)
                .sum::<u64>();
        }
        let what = || format!("{triangles} triangles of {vertices} vertices to draw");
        let taken = pictures.budget.take(bytes, what, ALLOW_MORE);
        taken.map_err(Problem::from)?;
        let alpha_counts = self.vertex_alpha_counts(survey)?;
        let mut surfaces = Vec::new();
        for (index, group) in survey.groups.iter().enumerate() {
            if group.geometry.triangles.is_empty() {
                continue;
            }
            let mut template = self.template(group, pictures, detail)?;
            if !alpha_counts {
                template.colors.iter_mut().for_each(|color| color.w = 1.0);
            }
            for is_foliage in [false, true] {
                let placed = parts.iter().zip(&survey.group_of_part);
                let mut surface = template.empty_surface();
                for (part, _) in placed.filter(|(_, of)| **of == index) {
                    let triangles = part.triangles_that(is_foliage, &group.geometry);
                    if !triangles.is_empty() {
                        template
                            .place(part, group, &triangles, &mut surface)
                            .at(|| self.place("nodes", part.node))?;
                    }
                }
                if !surface.triangles.is_empty() {
                    surfaces.push(DrawnSurface {
                        surface,
                        is_foliage,
                        material: group.look.material,
                        place: self.primitive_place(group.mesh, group.primitive),
                    });
                }
            }
        }
        Ok(surfaces)
    }

    fn template(
        &self,
        group: &Group,
        pictures: &mut Pictures<'_>,
        detail: Detail,
    ) -> Result<Template, Fault> {
        let (mesh, primitive) = (group.mesh, group.primitive);
        let normals = self.vectors_of::<3>(mesh, primitive, "NORMAL")?;
        let normal_map = match (detail, group.look.normal_map) {
            (Detail::Full, Some((texture, _))) => Some(texture),
            _ => None,
        };
        let texture = group.look.texture.or(normal_map);
        let uvs = match texture {
            Some(texture) => self
                .texture_coordinates(mesh, primitive, texture.uv_set)?
                .map(|uvs| (uvs, texture.transform)),
            None => None,
        };
        let to_uv = |uv: DVec2| {
            if uv.is_finite() {
                uv.as_vec2()
            } else {
                Vec2::ZERO
            }
        };
        Ok(Template {
            normals: normals.unwrap_or_default(),
            uvs: uvs.map_or_else(Vec::new, |(uvs, transform)| {
                uvs.into_iter()
                    .map(|uv| to_uv(transform.apply(uv)))
                    .collect()
            }),
            colors: match group.look.is_emission {
                true => Vec::new(),
                false => self.colors(mesh, primitive)?,
            },
            holds: match detail {
                Detail::Full => self.holds_of(mesh, primitive, group.geometry.positions.len())?,
                Detail::Color => Vec::new(),
            },
            material: Arc::new(self.material(group, pictures, detail)?),
        })
    }

    /// COLOR_0, with an alpha of 1 where it has none.
    pub(crate) fn colors(&self, mesh: usize, primitive: usize) -> Result<Vec<Vec4>, Fault> {
        let Some(index) = self.attribute(mesh, primitive, "COLOR_0")? else {
            return Ok(Vec::new());
        };
        if self.accessor(index)?.shape == Shape::Vector(3) {
            let colors = self.vectors_of::<3>(mesh, primitive, "COLOR_0")?;
            let opaque = |[r, g, b]: [f64; 3]| Vec4::new(r as f32, g as f32, b as f32, 1.0);
            return Ok(colors.unwrap_or_default().into_iter().map(opaque).collect());
        }
        let colors = self.vectors_of::<4>(mesh, primitive, "COLOR_0")?;
        let color = |c: [f64; 4]| Vec4::from_array(c.map(|x| x as f32));
        Ok(colors.unwrap_or_default().into_iter().map(color).collect())
    }

    fn material(
        &self,
        group: &Group,
        pictures: &mut Pictures<'_>,
        detail: Detail,
    ) -> Result<Material, Fault> {
        let look = &group.look;
        let texture = match look.texture {
            Some(texture) => texture_of(texture, pictures)?,
            None => None,
        };
        let normal_map = match (detail, look.normal_map) {
            // A surface has one set of texture coordinates.
            (Detail::Full, Some((normals, scale)))
                if look.texture.is_none_or(|t| t.is_placed_as(&normals)) =>
            {
                texture_of(normals, pictures)?.map(|texture| NormalMap { texture, scale })
            }
            _ => None,
        };
        Ok(Material {
            name: look.name.clone(),
            base_color: look.base_color,
            texture,
            alpha_mode: look.alpha_mode,
            double_sided: look.double_sided,
            finish: Finish {
                roughness: look.roughness,
                is_unlit: look.is_unlit,
                normal_map,
            },
        })
    }
}

pub(crate) fn texture_of(
    texture: TextureUse,
    pictures: &mut Pictures<'_>,
) -> Result<Option<Arc<Texture>>, Fault> {
    let Some(image) = texture.image else {
        return Ok(None);
    };
    pictures.texture(image, texture.wrap, texture.filters)
}

impl Tree {
    /// Everything of the plant, as [`Document::surfaces`] with this tree's
    /// choice of foliage.
    ///
    /// # Errors
    /// [`GltfError`] if there is too much of it.
    pub fn surfaces(&self) -> Result<Vec<(Surface, bool)>, GltfError> {
        self.surfaces_with(Detail::Color)
    }

    /// As [`Tree::surfaces`], in more or less detail.
    ///
    /// # Errors
    /// As [`Tree::surfaces`].
    pub fn surfaces_with(&self, detail: Detail) -> Result<Vec<(Surface, bool)>, GltfError> {
        let drawn = self.drawn(detail)?.into_iter();
        Ok(drawn.map(|d| (d.surface, d.is_foliage)).collect())
    }

    /// As [`Tree::surfaces_with`], with the material of each.
    ///
    /// # Errors
    /// As [`Tree::surfaces`].
    pub fn drawn(&self, detail: Detail) -> Result<Vec<DrawnSurface>, GltfError> {
        let document = &self.document;
        let read = || -> Result<_, Fault> {
            let mut budget = document.budget;
            let survey = document.survey(&self.parts, &mut budget)?;
            let mut pictures = Pictures::new(document, budget);
            document.surfaces_of(&self.parts, &survey, &mut pictures, detail)
        };
        read().map_err(|fault| document.error(fault))
    }
}

/// What all placements of a primitive share.
struct Template {
    normals: Vec<[f64; 3]>,
    uvs: Vec<Vec2>,
    colors: Vec<Vec4>,
    holds: Vec<Hold>,
    material: Arc<Material>,
}

impl Template {
    fn empty_surface(&self) -> Surface {
        Surface::empty(Arc::clone(&self.material))
    }

    /// Adds triangles of a part, by their numbers.
    fn place(
        &self,
        part: &Part,
        group: &Group,
        triangles: &[u32],
        surface: &mut Surface,
    ) -> Result<(), Problem> {
        let first = surface.positions.len() as u32;
        for (vertex, position) in group.geometry.positions.iter().enumerate() {
            surface
                .positions
                .push(part.place_vertex(vertex, *position)?);
        }
        let (cofactor, is_mirrored) = normal_matrix(&part.world_from_local);
        let to_world = |n: &[f64; 3]| {
            let turned = cofactor * DVec3::from_array(*n);
            turned.normalize_or_zero().as_vec3().normalize_or(Vec3::Y)
        };
        surface.normals.extend(self.normals.iter().map(to_world));
        surface.uvs.extend_from_slice(&self.uvs);
        surface.colors.extend_from_slice(&self.colors);
        // Of a placement that scales evenly, what it makes of lengths.
        let lengths = part.world_from_local.determinant().abs().cbrt();
        for (vertex, hold) in self.holds.iter().enumerate() {
            let pivot = part.place_vertex(vertex, hold.pivot.as_dvec3())?;
            surface.holds.push(Hold {
                pivot: pivot.as_vec3(),
                along_m: hold.along_m * lengths as f32,
                ..*hold
            });
        }
        surface.triangles.extend(triangles.iter().map(|&number| {
            let [a, b, c] = group.geometry.triangles[number as usize];
            let corners = if is_mirrored { [a, c, b] } else { [a, b, c] };
            corners.map(|v| first + v)
        }));
        Ok(())
    }
}

/// The matrix that turns normals, up to a positive factor, and whether the
/// transform mirrors. Cofactors, unlike the inverse, exist for flat transforms
/// too.
fn normal_matrix(world_from_local: &DMat4) -> (DMat3, bool) {
    let linear = DMat3::from_mat4(*world_from_local);
    let (x, y, z) = (linear.x_axis, linear.y_axis, linear.z_axis);
    let is_mirrored = linear.determinant() < 0.0;
    let cofactor = DMat3::from_cols(y.cross(z), z.cross(x), x.cross(y));
    (
        if is_mirrored {
            cofactor * -1.0
        } else {
            cofactor
        },
        is_mirrored,
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_mirror_keeps_the_normal_of_the_plane_it_lies_in() {
        // Mirrored in x: a normal along y stays, one along x turns round.
        let (matrix, is_mirrored) = normal_matrix(&DMat4::from_scale(DVec3::new(-2.0, 1.0, 1.0)));
        assert!(is_mirrored);
        assert_eq!((matrix * DVec3::Y).normalize(), DVec3::Y);
        assert_eq!((matrix * DVec3::X).normalize(), -DVec3::X);
    }
}
