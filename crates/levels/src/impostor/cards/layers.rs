//! Triangles of a plant sorted into flat layers.
//!
//! Billboard clouds (Décoret, Durand, Sillion, Dorsey: Billboard clouds for extreme model simplification, 2003)
//! show a model by pictures on a few planes. Which triangles lie on which plane is found here as shapes are
//! approximated by planes (Cohen-Steiner, Alliez, Desbrun: Variational shape approximation, 2004): each
//! triangle goes to the layer that is nearest, each layer gets the plane of its triangles, and again.

use std::borrow::Borrow;

use glam::{DMat3, DVec3};
use rayon::prelude::*;
use secateur_model::{Random, Surface, moment, principal_axes};

/// How much more a distance off a layer's plane counts than one along it, squared: a card shows what lies off its
/// plane in the wrong place from aside. With less, cards have more FLIP; with three times as much, they are as
/// much larger as one layer reaches through the whole crown.
const OFF_PLANE: f64 = 32.0;

/// What a triangle that is square to its layer counts, in squared sizes of the plant: the card shows nothing
/// of its face.
const TURNED: f64 = 0.05;

/// Stems spread along themselves this many times as much as across, squared: they are twice as long as wide.
const LONG: f64 = 4.0;

/// And through them this part of that across, squared: blades and boards are flatter.
const DEEP: f64 = 0.1;

/// How often triangles are sorted into layers and planes fitted to them.
const ROUNDS: usize = 12;

/// Of plants of more triangles some are sorted in each round, all in the last.
const MOST_IN_ROUNDS: usize = 40_000;

/// More than is lost in rounding of distances, as a share of them and of the square of the plant's size.
const ROUNDING: f64 = 1e-9;

/// The seed of the first layers' places.
const SEED: u64 = 1;

/// A triangle that has a face.
pub(super) struct Facet {
    /// Which surface, and which triangle of it.
    pub(super) at: [u32; 2],
    pub(super) corners: [DVec3; 3],
    centre: DVec3,
    normal: DVec3,
    area: f64,
    /// Whether it is flat by itself, not a side of a body such as a branch.
    is_flat: bool,
}

impl Facet {
    fn new(at: [u32; 2], corners: [DVec3; 3], is_flat: bool) -> Option<Self> {
        let [a, b, c] = corners;
        let across = (b - a).cross(c - a);
        let area = across.length();
        (area > 0.0 && area.is_finite()).then(|| Self {
            at,
            corners,
            centre: (a + b + c) / 3.0,
            normal: across / area,
            area,
            is_flat,
        })
    }
}

/// All triangles of surfaces that have a face.
pub(super) fn facets<S: Borrow<Surface>>(surfaces: &[S]) -> Vec<Facet> {
    let mut facets = Vec::new();
    for (s, surface) in surfaces.iter().enumerate() {
        let surface = surface.borrow();
        for (t, corners) in surface.triangles.iter().enumerate() {
            let corners = corners.map(|corner| surface.positions[corner as usize]);
            // Bodies have no inner side to be seen.
            let is_flat = surface.material.double_sided;
            facets.extend(Facet::new([s as u32, t as u32], corners, is_flat));
        }
    }
    facets
}

/// The largest side of the box about triangles.
pub(super) fn size(facets: &[Facet]) -> f64 {
    let corners = facets.iter().flat_map(|facet| facet.corners);
    let (low, high) = corners.fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(low, high), c| {
        (low.min(c), high.max(c))
    });
    (high - low).max_element()
}

/// A layer while triangles are sorted.
#[derive(Clone, Copy)]
struct Plane {
    mean: DVec3,
    normal: DVec3,
}

impl Plane {
    fn through(facet: &Facet) -> Self {
        Self {
            mean: facet.centre,
            normal: facet.normal,
        }
    }

    /// How far a triangle is from this layer, squared; `size` is the plant's.
    fn distance(&self, facet: &Facet, size: f64) -> f64 {
        let away = (facet.centre - self.mean) / size;
        let off = away.dot(self.normal);
        let along = match facet.is_flat {
            true => facet.normal.dot(self.normal),
            // A body shows as much to all sides.
            false => 1.0,
        };
        away.length_squared() + OFF_PLANE * off * off + TURNED * (1.0 - along * along)
    }
}

/// A layer of triangles.
pub(super) struct Layer {
    /// Which of the triangles lie in it.
    pub(super) members: Vec<u32>,
    pub(super) mean: DVec3,
    /// Square to it, and along it where it is narrow and where it is wide.
    pub(super) axes: [DVec3; 3],
    /// The area of its triangles, and of those that are sides of bodies, which show as much to all sides.
    pub(super) area: f64,
    pub(super) area_of_bodies: f64,
    /// Whether it is a piece of a stem: long, nearly as deep as it is wide, and the sides of bodies.
    pub(super) is_stem: bool,
}

/// Sorts triangles into `count` layers, or fewer where some would be empty.
pub(super) fn layers(facets: &[Facet], count: usize) -> Vec<Layer> {
    let size = size(facets);
    let step = facets.len().div_ceil(MOST_IN_ROUNDS).max(1);
    let some: Vec<&Facet> = facets.iter().step_by(step).collect();
    let mut planes = seeds(&some, count, size);
    for _ in 0..ROUNDS {
        let sorted = nearest(&some, &planes, size);
        let members = members(&sorted, planes.len());
        planes = members
            .into_par_iter()
            .filter(|members| !members.is_empty())
            .map(|members| {
                let layer = layer(members, |k| some[k as usize]);
                Plane {
                    mean: layer.mean,
                    normal: layer.axes[0],
                }
            })
            .collect();
    }
    let all: Vec<&Facet> = facets.iter().collect();
    let sorted = nearest(&all, &planes, size);
    let of_planes = members(&sorted, planes.len()).into_par_iter();
    of_planes
        .filter(|members| !members.is_empty())
        .map(|members| layer(members, |k| all[k as usize]))
        .collect()
}

/// Where layers begin: on triangles far from the layers before (Arthur, Vassilvitskii: k-means++, 2007).
fn seeds(facets: &[&Facet], count: usize, size: f64) -> Vec<Plane> {
    let mut random = Random::new(SEED);
    let mut planes: Vec<Plane> = facets.iter().take(1).map(|f| Plane::through(f)).collect();
    let mut left: Vec<f64> = vec![f64::INFINITY; facets.len()];
    while let Some(last) = planes.last().filter(|_| planes.len() < count) {
        let all = left.par_iter_mut().zip(facets);
        all.for_each(|(left, facet)| *left = left.min(last.distance(facet, size) * facet.area));
        let mut lot = random.unit() * left.iter().sum::<f64>();
        let drawn = left.iter().position(|left| {
            lot -= left;
            *left > 0.0 && lot <= 0.0
        });
        // All triangles lie in the layers that there are.
        let Some(drawn) = drawn else { break };
        planes.push(Plane::through(facets[drawn]));
    }
    planes
}

/// The nearest plane of each triangle, the first of several.
fn nearest(facets: &[&Facet], planes: &[Plane], size: f64) -> Vec<u32> {
    let of_facet = |facet: &&Facet| {
        let (mut nearest, mut least) = (0, f64::INFINITY);
        // No layer is nearer than its middle is, but for what is lost in rounding.
        let mut most_away = f64::INFINITY;
        for (k, plane) in planes.iter().enumerate() {
            if (facet.centre - plane.mean).length_squared() > most_away {
                continue;
            }
            let distance = plane.distance(facet, size);
            if distance < least {
                (nearest, least) = (k as u32, distance);
                most_away = (least * (1.0 + ROUNDING) + ROUNDING) * size * size;
            }
        }
        nearest
    };
    facets.par_iter().map(of_facet).collect()
}

fn members(sorted: &[u32], planes: usize) -> Vec<Vec<u32>> {
    let mut members = vec![Vec::new(); planes];
    for (facet, plane) in sorted.iter().enumerate() {
        members[*plane as usize].push(facet as u32);
    }
    members
}

/// The plane of triangles: that off which they spread least.
fn layer<'a>(members: Vec<u32>, facet: impl Fn(u32) -> &'a Facet) -> Layer {
    let (mut area, mut area_of_bodies, mut sum) = (0.0, 0.0, DVec3::ZERO);
    let mut faced = DVec3::ZERO;
    for facet in members.iter().map(|k| facet(*k)) {
        area += facet.area;
        sum += facet.centre * facet.area;
        if !facet.is_flat {
            area_of_bodies += facet.area;
            faced += facet.normal * facet.area;
        }
    }
    let mean = sum / area;
    let mut spread = DMat3::ZERO;
    for facet in members.iter().map(|k| facet(*k)) {
        for corner in facet.corners {
            spread += moment(corner - mean) * facet.area;
        }
    }
    let axes = principal_axes(spread);
    let [through, across, along] = axes.map(|axis| (spread * axis).dot(axis));
    let is_body = area_of_bodies > area / 2.0;
    Layer {
        is_stem: is_body && along > LONG * across && through > DEEP * across,
        // What has one side is seen from there.
        axes: axes.map(|axis| match axis.dot(faced) < 0.0 {
            true => -axis,
            false => axis,
        }),
        area,
        area_of_bodies,
        members,
        mean,
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use super::*;

    /// Squares of side .1 at places of a plane, each of two triangles.
    fn sheet(height: f64, normal: DVec3) -> Vec<Facet> {
        let [u, v] = [
            normal.any_orthonormal_vector(),
            normal.cross(normal.any_orthonormal_vector()),
        ];
        let square = |k: u32| {
            let [x, y] = [k % 8, k / 8].map(|k| f64::from(k) / 8.0 - 0.5);
            let a = normal * height + u * x + v * y;
            let [b, c, d] = [a + u * 0.1, a + (u + v) * 0.1, a + v * 0.1];
            [[a, b, c], [a, c, d]]
        };
        let triangles = (0..64).flat_map(square).enumerate();
        triangles
            .filter_map(|(t, corners)| Facet::new([0, t as u32], corners, true))
            .collect()
    }

    #[test]
    fn sheets_are_found_as_layers() {
        let mut facets = sheet(0.0, DVec3::Y);
        facets.extend(sheet(0.5, DVec3::Y));
        facets.extend(sheet(2.0, DVec3::X));
        let found = layers(&facets, 3);
        let mut of_sheets: Vec<Vec<u32>> = found.iter().map(|l| l.members.clone()).collect();
        of_sheets.sort();
        let wanted: Vec<Vec<u32>> = (0..3u32)
            .map(|k| (128 * k..128 * (k + 1)).collect())
            .collect();
        assert_eq!(of_sheets, wanted);
        for layer in &found {
            let normal = facets[layer.members[0] as usize].normal;
            assert!((layer.axes[0].dot(normal).abs() - 1.0).abs() < 1e-9);
        }
    }

    /// Planes that are left out since their middle is far are none that is nearest.
    #[test]
    fn the_nearest_plane_is_the_least_of_all_distances() {
        let mut random = Random::new(5);
        let mut place = |size: f64| DVec3::from([0; 3].map(|_| random.between(-size, size)));
        let mut facets = Vec::new();
        for t in 0..300 {
            let at = place(1.0);
            let corners = [at, at + place(0.1), at + place(0.1)];
            facets.extend(Facet::new([0, t], corners, t % 3 > 0));
        }
        let all: Vec<&Facet> = facets.iter().collect();
        let planes: Vec<Plane> = all.iter().step_by(4).map(|f| Plane::through(f)).collect();
        for (facet, found) in all.iter().zip(nearest(&all, &planes, 2.0)) {
            let distances = planes.iter().map(|plane| plane.distance(facet, 2.0));
            let least = distances.enumerate().min_by(|a, b| a.1.total_cmp(&b.1));
            assert_eq!(Some(found as usize), least.map(|(k, _)| k));
        }
    }

    #[test]
    fn there_are_no_more_layers_than_places_and_each_triangle_lies_in_one() {
        let facets = sheet(0.0, DVec3::Y);
        let found = layers(&facets[..2], 9);
        assert!((1..=2).contains(&found.len()));
        let found = layers(&facets, 20);
        let mut all: Vec<u32> = found.iter().flat_map(|l| l.members.clone()).collect();
        all.sort_unstable();
        assert_eq!(all, (0..128).collect::<Vec<u32>>());
        assert!(layers(&[], 5).is_empty());
    }

    /// A tube without ends, of this width and depth, 1 high.
    fn tube(width: f64, depth: f64) -> Vec<Facet> {
        let corner = |side: u32, y: f64| {
            let (sin, cos) = (f64::from(side) * TAU / 8.0).sin_cos();
            DVec3::new(width / 2.0 * cos, y, depth / 2.0 * sin)
        };
        let square = |k: u32| {
            let [a, b] = [k, k + 1].map(|side| corner(side, 0.0));
            let [c, d] = [k, k + 1].map(|side| corner(side, 1.0));
            [[a, b, c], [b, d, c]]
        };
        let facet = |(t, corners): (usize, [DVec3; 3])| Facet::new([0, t as u32], corners, false);
        (0..8)
            .flat_map(square)
            .enumerate()
            .filter_map(facet)
            .collect()
    }

    #[test]
    fn stems_are_long_and_round() {
        let is_stem = |facets: &[Facet]| layers(facets, 1)[0].is_stem;
        assert!(is_stem(&tube(0.1, 0.1)));
        assert!(!is_stem(&tube(0.8, 0.8)), "a stump");
        assert!(!is_stem(&tube(0.1, 0.01)), "a board");
        let leaves = tube(0.1, 0.1).into_iter();
        let leaves = leaves.map(|facet| Facet {
            is_flat: true,
            ..facet
        });
        let leaves: Vec<Facet> = leaves.collect();
        assert!(!is_stem(&leaves), "leaves along a stem");
    }
}
