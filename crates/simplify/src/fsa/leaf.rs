//! A leaf as the collapse sees it: its corners, where they are and what they
//! look like.

use glam::DVec3;
use secateur_model::{CornerRef, Foliage, LeafId, LeafTriangle, NewCorner, NewLeaf, Place};
use smallvec::SmallVec;

use super::{Corners, Hausdorff};

/// A corner of the foliage and where it is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Vertex {
    pub(super) position: DVec3,
    corner: CornerRef,
}

/// Four corners around a leaf, and the donor's corners that they look like.
#[derive(Clone, Copy, Debug)]
struct Outline {
    positions: [DVec3; 4],
    like: [u32; 4],
}

/// A leaf that is still there.
#[derive(Clone, Debug)]
pub(super) struct ActiveLeaf {
    /// Its corners, each place once.
    pub(super) vertices: SmallVec<[Vertex; 4]>,
    /// Its triangles, where distances are to them.
    surface: Vec<[DVec3; 3]>,
    /// Of length 1, or 0 where the leaf has no area. Either side.
    pub(super) normal: DVec3,
    pub(super) low: DVec3,
    pub(super) high: DVec3,
    area: f64,
    donor: LeafId,
    /// The side that the donor's first triangle faces.
    facing: DVec3,
    outline: Outline,
}

/// What the cost of a pair depends on: where the vertices are, the normal,
/// either side, and the surface where distances are to it. Leaves that have it in common cost the same to the last bit with
/// any third leaf.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub(super) struct Shape {
    /// Bits, ascending, each place once.
    places: SmallVec<[[u64; 3]; 4]>,
    normal: [u64; 3],
    /// Bits of its triangles, where distances are to them.
    surface: Vec<[[u64; 3]; 3]>,
}

/// Leaves of more corners are compared by the outermost in 26 directions: that
/// bounds the work for one pair.
const MAX_VERTICES: usize = 26;

impl ActiveLeaf {
    pub(super) fn original(foliage: &Foliage, leaf: LeafId, hausdorff: Hausdorff) -> Self {
        let triangles = foliage.triangles_of(leaf);
        let vertices = outermost(distinct_corners(leaf, triangles));
        let normal = normal(triangles);
        let outline = outline_of(&vertices, normal);
        let (low, high) = bounds(&vertices);
        let facing = triangles.iter().map(twice_area).find(|n| *n != DVec3::ZERO);
        Self {
            normal,
            low,
            high,
            area: foliage.leaf(leaf).area(),
            donor: leaf,
            facing: facing.unwrap_or(DVec3::ZERO),
            surface: match hausdorff {
                Hausdorff::Corners => Vec::new(),
                Hausdorff::Surface => triangles.iter().map(|t| t.corners).collect(),
            },
            outline,
            vertices,
        }
    }

    pub(super) fn shape(&self) -> Shape {
        let mut places: SmallVec<[[u64; 3]; 4]> =
            self.vertices.iter().map(|v| bits(v.position)).collect();
        places.sort_unstable();
        places.dedup();
        Shape {
            places,
            normal: bits(self.normal).min(bits(-self.normal)),
            surface: self.surface.iter().map(|t| t.map(bits)).collect(),
        }
    }

    pub(super) fn middle(&self) -> DVec3 {
        0.5 * self.low + 0.5 * self.high
    }

    /// From a point to the nearest place of the leaf, squared.
    pub(super) fn distance_squared(&self, point: DVec3, hausdorff: Hausdorff) -> f64 {
        let distances: &mut dyn Iterator<Item = f64> = match hausdorff {
            Hausdorff::Corners => &mut self
                .vertices
                .iter()
                .map(|v| v.position.distance_squared(point)),
            Hausdorff::Surface => &mut self
                .surface
                .iter()
                .map(|triangle| point.distance_squared(nearest_in(triangle, point))),
        };
        distances.fold(f64::INFINITY, f64::min)
    }

    /// The new leaf that takes the place of two: of each two vertices, as `corners` says, in the
    /// order that encloses most. It looks like the larger; of equals, the first.
    pub(super) fn collapse(a: &Self, b: &Self, corners: Corners, hausdorff: Hausdorff) -> Self {
        let (own, other) = if b.area > a.area { (b, a) } else { (a, b) };
        let ([p, q], [r, s]) = match corners {
            Corners::Spread => {
                let middle = other.middle();
                let [p, q] = furthest_two(own, |v| v.distance_squared(middle));
                let of_other = furthest_two(other, |v| {
                    v.distance_squared(p.position)
                        .min(v.distance_squared(q.position))
                });
                ([p, q], of_other)
            }
            Corners::Furthest => (
                furthest_two(own, |v| other.distance_squared(v, hausdorff)),
                furthest_two(other, |v| own.distance_squared(v, hausdorff)),
            ),
        };
        let mut corners = [p, q, r, s];
        for turned in [[p, q, s, r], [p, r, q, s]] {
            if twice_area_of(&turned).length_squared() > twice_area_of(&corners).length_squared() {
                corners = turned;
            }
        }
        let twice = twice_area_of(&corners);
        let vertices = SmallVec::from(corners);
        let (low, high) = bounds(&vertices);
        Self {
            normal: twice.normalize_or_zero(),
            low,
            high,
            area: 0.5 * twice.length(),
            surface: match hausdorff {
                Hausdorff::Corners => Vec::new(),
                Hausdorff::Surface => {
                    let [a, b, c, d] = corners.map(|v| v.position);
                    vec![[a, b, c], [a, c, d]]
                }
            },
            donor: own.donor,
            facing: own.facing,
            outline: Outline {
                positions: corners.map(|v| v.position),
                like: own
                    .outline
                    .like_around(corners[0].position, corners[1].position),
            },
            vertices,
        }
    }

    /// As a leaf of the model: two triangles that face the donor's side.
    pub(super) fn new_leaf(&self) -> NewLeaf {
        let corner = |k: usize| NewCorner {
            place: Place::Of(self.vertices[k].corner),
            like: self.outline.like[k],
        };
        let triangles = match self.normal.dot(self.facing) < 0.0 {
            false => [[0, 1, 2], [0, 2, 3]],
            true => [[0, 2, 1], [0, 3, 2]],
        };
        NewLeaf {
            donor: self.donor,
            triangles: triangles.map(|t| t.map(corner)).to_vec(),
        }
    }
}

impl Outline {
    /// What the corners of a new outline look like that begins with these two:
    /// this outline's corners in turn, so that all of the texture is shown.
    fn like_around(&self, first: DVec3, second: DVec3) -> [u32; 4] {
        let nearest = |to: DVec3| {
            let distance = |k: &usize| self.positions[*k].distance_squared(to);
            let all = 0..4;
            all.min_by(|a, b| distance(a).total_cmp(&distance(b)))
                .unwrap_or(0)
        };
        let start = nearest(first);
        let step = if nearest(second) == (start + 3) % 4 {
            3
        } else {
            1
        };
        [0, 1, 2, 3].map(|k| self.like[(start + k * step) % 4])
    }
}

/// Of a place, the same for both zeros.
fn bits(place: DVec3) -> [u64; 3] {
    place.to_array().map(|x| (x + 0.0).to_bits())
}

fn distinct_corners(leaf: LeafId, triangles: &[LeafTriangle]) -> Vec<Vertex> {
    let corners = triangles.iter().flat_map(|t| t.corners).zip(0..);
    let mut all: Vec<Vertex> = corners
        .map(|(position, corner)| Vertex {
            position,
            corner: CornerRef { leaf, corner },
        })
        .collect();
    let key = |v: &Vertex| bits(v.position);
    all.sort_by_key(|v| (key(v), v.corner.corner));
    all.dedup_by_key(|v| key(v));
    all.sort_by_key(|v| v.corner.corner);
    all
}

fn outermost(vertices: Vec<Vertex>) -> SmallVec<[Vertex; 4]> {
    if vertices.len() <= MAX_VERTICES {
        return SmallVec::from_vec(vertices);
    }
    let mut kept: Vec<usize> = Vec::with_capacity(MAX_VERTICES);
    for code in (0..27).filter(|code| *code != 13) {
        let axis = |k: u32| f64::from((code / 3i32.pow(k)) % 3 - 1);
        let direction = DVec3::new(axis(0), axis(1), axis(2));
        let reach = |k: &usize| vertices[*k].position.dot(direction);
        let all = 0..vertices.len();
        kept.extend(all.max_by(|a, b| reach(a).total_cmp(&reach(b)).then(b.cmp(a))));
    }
    kept.sort_unstable();
    kept.dedup();
    kept.into_iter().map(|k| vertices[k]).collect()
}

fn twice_area(triangle: &LeafTriangle) -> DVec3 {
    let [a, b, c] = triangle.corners;
    (b - a).cross(c - a)
}

fn twice_area_of(outline: &[Vertex; 4]) -> DVec3 {
    let [a, b, c, d] = outline.map(|v| v.position);
    (c - a).cross(d - b)
}

/// The mean direction of the triangles by area, each turned to the side of the
/// largest: back faces that are doubled do not cancel.
fn normal(triangles: &[LeafTriangle]) -> DVec3 {
    let size = |n: &DVec3| n.length_squared();
    let all = || triangles.iter().map(twice_area);
    let largest = all().max_by(|a, b| size(a).total_cmp(&size(b)));
    let largest = largest.unwrap_or(DVec3::ZERO);
    let turned = |n: DVec3| if n.dot(largest) < 0.0 { -n } else { n };
    all().map(turned).sum::<DVec3>().normalize_or_zero()
}

fn bounds(vertices: &[Vertex]) -> (DVec3, DVec3) {
    let first = vertices[0].position;
    let wider = |(lo, hi): (DVec3, DVec3), v: &Vertex| (lo.min(v.position), hi.max(v.position));
    vertices.iter().fold((first, first), wider)
}

/// The two ends of a leaf, and on each side of the line between them the vertex
/// that is furthest from it.
fn outline_of(vertices: &[Vertex], normal: DVec3) -> Outline {
    let mut ends = (vertices[0], vertices[0], -1.0);
    for (k, a) in vertices.iter().enumerate() {
        for b in &vertices[k + 1..] {
            let length = a.position.distance_squared(b.position);
            if length > ends.2 {
                ends = (*a, *b, length);
            }
        }
    }
    let (p, q) = (ends.0, ends.1);
    let sideways = normal.cross(q.position - p.position);
    let side = |sign: f64, none: Vertex| {
        let mut best = (none, 0.0);
        for v in vertices {
            let reach = sign * (v.position - p.position).dot(sideways);
            if reach > best.1 {
                best = (*v, reach);
            }
        }
        best.0
    };
    let corners = [p, side(1.0, q), q, side(-1.0, p)];
    Outline {
        positions: corners.map(|v| v.position),
        like: corners.map(|v| v.corner.corner),
    }
}

/// The two vertices of a leaf that are furthest, the furthest first, of equals
/// the first.
fn furthest_two(leaf: &ActiveLeaf, distance: impl Fn(DVec3) -> f64) -> [Vertex; 2] {
    let vertices = leaf.vertices.iter();
    let mut by_distance: SmallVec<[(f64, Vertex); 4]> =
        vertices.map(|v| (distance(v.position), *v)).collect();
    by_distance.sort_by(|a, b| b.0.total_cmp(&a.0));
    let first = by_distance[0].1;
    [first, by_distance.get(1).map_or(first, |v| v.1)]
}

/// The point of a triangle that is nearest to another: within it, on an edge or a corner. A
/// triangle without area is its edges.
fn nearest_in([a, b, c]: &[DVec3; 3], point: DVec3) -> DVec3 {
    let normal = (b - a).cross(c - a);
    let size = normal.length_squared();
    if size > 0.0 {
        let foot = point - normal * ((point - a).dot(normal) / size);
        let is_inside =
            |from: &DVec3, to: &DVec3| (*to - *from).cross(foot - *from).dot(normal) >= 0.0;
        if is_inside(a, b) && is_inside(b, c) && is_inside(c, a) {
            return foot;
        }
    }
    let on_edges = [(a, b), (b, c), (c, a)].map(|(from, to)| nearest_on(*from, *to, point));
    let [first, others @ ..] = on_edges;
    others.into_iter().fold(first, |best, next| {
        match next.distance_squared(point) < best.distance_squared(point) {
            true => next,
            false => best,
        }
    })
}

fn nearest_on(from: DVec3, to: DVec3, point: DVec3) -> DVec3 {
    let along = to - from;
    let length = along.length_squared();
    if length > 0.0 {
        from + along * ((point - from).dot(along) / length).clamp(0.0, 1.0)
    } else {
        from
    }
}
