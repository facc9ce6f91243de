//! Pieces of wood in primitives of leaves: bark and leaves often share one atlas and one primitive.

use std::sync::Arc;

use glam::{DVec2, DVec3};

use super::Document;
use super::cutouts::Cutouts;
use super::error::Fault;
use super::leaves::Leaves;
use super::parts::Part;
use super::picture::Pictures;
use super::roles::Role;
use super::shape_evidence::{is_flat, is_large, sum_up};
use super::survey::{Group, Survey};
use secateur_model::Cutout;

/// The least share of a piece's texels, 0 to 1, that wood keeps: edges of islands in an atlas may be clear.
const LEAST_OPAQUE: f64 = 0.98;

/// A round piece of few triangles is no leaf if it is this many times as long as the median leaf.
const LONGER_THAN_LEAVES: f64 = 1.25;

/// How high over the lowest point of the plant something may end that stands on the ground, as a share of the height.
const GROUND_SHARE: f64 = 0.05;

impl Document {
    /// Finds the wood in parts of leaves, where other wood or the ground is there to bear it: pieces that are round
    /// and large, and whose texels are nearly all opaque. What is not cut out needs many leaves beside large stems.
    pub(crate) fn find_wood_pieces(
        &self,
        parts: &mut [Part],
        survey: &Survey,
        pictures: &mut Pictures<'_>,
    ) -> Result<(), Fault> {
        let has_wood = parts.iter().any(|part| part.role == Role::Wood);
        let [low, high] = heights(parts, survey);
        let ground = low + GROUND_SHARE * (high - low);
        for (number, group) in survey.groups.iter().enumerate() {
            let of_group = parts.iter().zip(&survey.group_of_part);
            let mut leaves = of_group
                .filter(|(part, of)| **of == number && part.role == Role::Leaf)
                .map(|(part, _)| part);
            let Some(first) = leaves.next() else {
                continue;
            };
            let Some(is_wood) = self.wood_pieces_of(group, pictures)? else {
                continue;
            };
            let stands = |part: &Part| lowest_of(part, group, &is_wood) <= ground;
            if !has_wood && !stands(first) && !leaves.any(stands) {
                continue;
            }
            let is_wood: Arc<[bool]> = is_wood.into();
            for (part, of) in parts.iter_mut().zip(&survey.group_of_part) {
                if *of == number && part.role == Role::Leaf {
                    part.wood_pieces = Some(Arc::clone(&is_wood));
                }
            }
        }
        Ok(())
    }

    /// Which pieces of a primitive of leaves look like wood; nothing where none does, or all do.
    fn wood_pieces_of(
        &self,
        group: &Group,
        pictures: &mut Pictures<'_>,
    ) -> Result<Option<Vec<bool>>, Fault> {
        let (positions, triangles) = (&group.geometry.positions, &group.geometry.triangles);
        let pieces = group.geometry.pieces();
        let mut cutouts = Cutouts::default();
        let uvs = match group.look.texture {
            Some(texture) => {
                let uvs = self.texture_coordinates(group.mesh, group.primitive, texture.uv_set)?;
                uvs.map(|uvs| (uvs, texture.transform))
            }
            None => None,
        };
        let mask = match (&uvs, cutouts.index(&group.look, pictures)?) {
            (Some((uvs, transform)), Some(index)) => {
                let placed = |uv: &DVec2| transform.apply(*uv);
                let uvs: Vec<DVec2> = uvs.iter().map(placed).collect();
                Some((uvs, &*cutouts.masks[index as usize]))
            }
            _ => None,
        };
        let longest_of_leaves = LONGER_THAN_LEAVES * median_length(positions, triangles, pieces);
        let looks_mixed =
            || sum_up(positions, triangles, pieces).are_leaves_and_wood(group.placements);
        if mask.is_none() && !looks_mixed() {
            return Ok(None);
        }
        let known = self.known_roles.as_ref();
        let is_known = known.is_some_and(|known| known.is_mixed(&group.look.name));
        let is_wood = |piece: &[u32]| {
            // Coarser wood may be flat strips.
            if let (true, Some((uvs, mask))) = (is_known, &mask) {
                return opaque_share(mask, uvs, triangles, piece) >= LEAST_OPAQUE;
            }
            if is_flat(positions, triangles, piece) {
                return false;
            }
            match &mask {
                Some((uvs, mask)) => {
                    let is_large =
                        is_large(piece) || length(positions, triangles, piece) > longest_of_leaves;
                    is_large && opaque_share(mask, uvs, triangles, piece) >= LEAST_OPAQUE
                }
                None => is_large(piece),
            }
        };
        let is_wood: Vec<bool> = pieces.iter().map(is_wood).collect();
        let differ = is_wood.contains(&true) && is_wood.contains(&false);
        Ok(differ.then_some(is_wood))
    }
}

/// The lowest and the highest of all that is drawn, in world units.
fn heights(parts: &[Part], survey: &Survey) -> [f64; 2] {
    let mut extent = [f64::INFINITY, f64::NEG_INFINITY];
    for (part, &group) in parts.iter().zip(&survey.group_of_part) {
        let geometry = &survey.groups[group].geometry;
        for &corner in geometry.triangles.as_flattened() {
            let height = height_of(part, geometry.positions[corner as usize]);
            extent = [extent[0].min(height), extent[1].max(height)];
        }
    }
    extent
}

fn height_of(part: &Part, local: DVec3) -> f64 {
    part.world_from_local.transform_point3(local).y
}

/// The lowest point of the pieces of wood of a part, in world units.
fn lowest_of(part: &Part, group: &Group, is_wood: &[bool]) -> f64 {
    let geometry = &group.geometry;
    let of_wood = geometry.pieces().iter().zip(is_wood);
    let corners = of_wood
        .filter(|(_, is_wood)| **is_wood)
        .flat_map(|(piece, _)| piece)
        .flat_map(|&t| geometry.triangles[t as usize]);
    let heights = corners.map(|corner| height_of(part, geometry.positions[corner as usize]));
    heights.fold(f64::INFINITY, f64::min)
}

/// The diagonal of a piece's box, in units of the primitive.
fn length(positions: &[DVec3], triangles: &[[u32; 3]], piece: &[u32]) -> f64 {
    let corners = piece.iter().flat_map(|&t| triangles[t as usize]);
    let (low, high) = corners.fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(low, high), v| {
        let position = positions[v as usize];
        (low.min(position), high.max(position))
    });
    low.distance(high)
}

/// The median of the lengths of flat pieces; 0 where there are none.
fn median_length(positions: &[DVec3], triangles: &[[u32; 3]], pieces: &Leaves) -> f64 {
    let flat = pieces
        .iter()
        .filter(|piece| !is_large(piece) && is_flat(positions, triangles, piece));
    let mut lengths: Vec<f64> = flat
        .map(|piece| length(positions, triangles, piece))
        .collect();
    let middle = lengths.len() / 2;
    match lengths.is_empty() {
        true => 0.0,
        false => *lengths.select_nth_unstable_by(middle, f64::total_cmp).1,
    }
}

/// The share of a piece, 0 to 1, that a mask keeps: of seven points of each triangle, weighted by its area in
/// texture coordinates. A piece without such area is looked at in its points alone.
fn opaque_share(mask: &Cutout, uvs: &[DVec2], triangles: &[[u32; 3]], piece: &[u32]) -> f64 {
    const POINTS: [[f64; 3]; 7] = [
        [1.0 / 3.0, 1.0 / 3.0, 1.0 / 3.0],
        [0.8, 0.1, 0.1],
        [0.1, 0.8, 0.1],
        [0.1, 0.1, 0.8],
        [0.45, 0.45, 0.1],
        [0.45, 0.1, 0.45],
        [0.1, 0.45, 0.45],
    ];
    let size = DVec2::new(f64::from(mask.width()), f64::from(mask.height()));
    let (mut kept, mut all) = (0.0, 0.0);
    for &t in piece {
        let [a, b, c] = triangles[t as usize].map(|v| uvs[v as usize]);
        let area = (b - a).perp_dot(c - a).abs();
        let weight = if area.is_finite() {
            area + f64::MIN_POSITIVE
        } else {
            0.0
        };
        for [u, v, w] in POINTS {
            let texel = ((u * a + v * b + w * c) * size).floor();
            all += weight;
            if mask.is_opaque(texel.x as i32, texel.y as i32) {
                kept += weight;
            }
        }
    }
    if all > 0.0 { kept / all } else { 0.0 }
}
