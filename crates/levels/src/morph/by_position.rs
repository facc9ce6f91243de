//! Corners that go to the nearest place of what is left.
//!
//! What lies far from it, such as a bough that is gone from a trunk, would spread over whatever is near to each corner.
//! So it goes where the nearest corner along its edges goes that lies near.

use std::cmp::Ordering;
use std::collections::BinaryHeap;

use glam::DVec3;
use rstar::primitives::GeomWithData;
use rstar::{PointDistance, RTree};
use rustc_hash::FxHashMap;
use secateur_model::LeafTriangle;

use super::Form;
use super::surface::Surface;

/// A corner is near to what is left within this many times its shortest edge: a tube of few sides is about as thick.
const NEAR_EDGES: f64 = 2.0;

/// And within this many times what the triangle there is off from the form: a bow that became its chord. Twigs of
/// `ez_bush2` were torn without; other values of both were not tried.
const NEAR_OFF: f64 = 1.5;

/// The corners of a form, each place once.
struct Mesh {
    places: Vec<DVec3>,
    /// By corner of the form's triangles, its place.
    corners: Vec<[usize; 3]>,
    /// By place, the places at the other ends of its edges.
    edges: Vec<Vec<usize>>,
}

impl Mesh {
    fn of(form: &Form<'_>) -> Self {
        let mut mesh = Self {
            places: Vec::new(),
            corners: Vec::new(),
            edges: Vec::new(),
        };
        let mut known: FxHashMap<[u64; 3], usize> = FxHashMap::default();
        for triangle in form.triangles.iter() {
            let corners = triangle.corners.map(|corner| {
                let key = corner.to_array().map(|x| (x + 0.0).to_bits());
                *known.entry(key).or_insert_with(|| {
                    mesh.places.push(corner);
                    mesh.edges.push(Vec::new());
                    mesh.places.len() - 1
                })
            });
            for k in 0..3 {
                let [from, to] = [corners[k], corners[(k + 1) % 3]];
                mesh.edges[from].push(to);
                mesh.edges[to].push(from);
            }
            mesh.corners.push(corners);
        }
        mesh
    }

    fn length(&self, from: usize, to: usize) -> f64 {
        self.places[from].distance(self.places[to])
    }

    /// Up to how far off something is near to a place, in world units.
    fn reach(&self, place: usize) -> f64 {
        let lengths = self.edges[place].iter().map(|to| self.length(place, *to));
        NEAR_EDGES
            * lengths
                .filter(|length| *length > 0.0)
                .fold(f64::INFINITY, f64::min)
    }
}

/// Where the triangles go of a form of which something is left.
pub(super) fn moved_onto(form: &Form<'_>, next: &[Form<'_>]) -> Vec<[DVec3; 3]> {
    let surface = Surface::of(next.iter());
    let off = off_from(form, next);
    let mesh = Mesh::of(form);
    let mut to: Vec<Option<DVec3>> = vec![None; mesh.places.len()];
    // Of places that reach nothing, how far what is left is, and where.
    let mut far: Vec<(f64, DVec3)> = Vec::with_capacity(to.len());
    for (place, to) in to.iter_mut().enumerate() {
        let Some(found) = surface.nearest(mesh.places[place]) else {
            return form.triangles.iter().map(|t| t.corners).collect();
        };
        let there = next[found.form].placed(found.point);
        let reach = mesh.reach(place).max(NEAR_OFF * off[found.triangle]);
        *to = (found.distance <= reach).then_some(there);
        far.push((found.distance, there));
    }
    meet_corners(&mesh, next, &off, &mut to);
    follow_edges(&mesh, &mut to);
    gather_rest(&mesh, &far, &mut to);
    let at = |place: usize| to[place].unwrap_or(mesh.places[place]);
    mesh.corners.iter().map(|corners| corners.map(at)).collect()
}

/// By triangle of what is left, how far it is off from the form at its corners, on its sides and in its middle, in
/// world units.
fn off_from(form: &Form<'_>, next: &[Form<'_>]) -> Vec<f64> {
    let surface = Surface::of(std::iter::once(form));
    let off = |point: DVec3| surface.nearest(point).map_or(0.0, |found| found.distance);
    let triangles = next.iter().flat_map(|form| form.triangles.iter());
    let of_triangle = |t: &LeafTriangle| {
        let [a, b, c] = t.corners;
        let points = [
            a,
            b,
            c,
            a.midpoint(b),
            b.midpoint(c),
            c.midpoint(a),
            (a + b + c) / 3.0,
        ];
        points.map(off).into_iter().fold(0.0, f64::max)
    };
    triangles.map(of_triangle).collect()
}

/// Has the place nearest to each corner of what is left go there: else the level would end within the next.
fn meet_corners(mesh: &Mesh, next: &[Form<'_>], off: &[f64], to: &mut [Option<DVec3>]) {
    let places = mesh.places.iter().enumerate();
    let places = places.map(|(place, at)| GeomWithData::new(at.to_array(), place));
    let places = RTree::bulk_load(places.collect());
    let mut nearest = vec![f64::INFINITY; to.len()];
    let triangles = next
        .iter()
        .flat_map(|form| form.triangles.iter().map(move |t| (form, t)));
    for ((form, triangle), off) in triangles.zip(off) {
        for corner in triangle.corners {
            let Some(found) = places.nearest_neighbor(corner.to_array()) else {
                return;
            };
            let distance = found.distance_2(&corner.to_array()).sqrt();
            let place = found.data;
            if distance < nearest[place] && distance <= mesh.reach(place).max(NEAR_OFF * off) {
                nearest[place] = distance;
                to[place] = Some(form.placed(corner));
            }
        }
    }
}

/// A place on the way along edges, the least way first out of a heap.
struct Way {
    length: f64,
    place: usize,
}

impl PartialEq for Way {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}

impl Eq for Way {}

impl PartialOrd for Way {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for Way {
    fn cmp(&self, other: &Self) -> Ordering {
        let by_length = other.length.total_cmp(&self.length);
        by_length.then(other.place.cmp(&self.place))
    }
}

/// Has places that go nowhere go with the nearest along edges that goes somewhere.
fn follow_edges(mesh: &Mesh, to: &mut [Option<DVec3>]) {
    let near = (0..to.len()).filter(|place| to[*place].is_some());
    let mut ways: BinaryHeap<Way> = near.map(|place| Way { length: 0.0, place }).collect();
    let mut shortest = vec![f64::INFINITY; to.len()];
    for way in &ways {
        shortest[way.place] = 0.0;
    }
    while let Some(Way { length, place }) = ways.pop() {
        if length > shortest[place] {
            continue;
        }
        for &other in &mesh.edges[place] {
            let length = length + mesh.length(place, other);
            if length < shortest[other] {
                shortest[other] = length;
                to[other] = to[place];
                ways.push(Way {
                    length,
                    place: other,
                });
            }
        }
    }
}

/// Has what hangs together and is nowhere near go to one point: the nearest of what is left.
fn gather_rest(mesh: &Mesh, far: &[(f64, DVec3)], to: &mut [Option<DVec3>]) {
    for first in 0..to.len() {
        if to[first].is_some() {
            continue;
        }
        let mut all = vec![first];
        to[first] = Some(far[first].1);
        let mut next = 0;
        while let Some(&place) = all.get(next) {
            for &other in &mesh.edges[place] {
                if to[other].is_none() {
                    to[other] = Some(far[other].1);
                    all.push(other);
                }
            }
            next += 1;
        }
        let nearest = all.iter().map(|place| far[*place]);
        let nearest = nearest.min_by(|a, b| a.0.total_cmp(&b.0));
        for place in all {
            to[place] = nearest.map(|(_, there)| there);
        }
    }
}

/// Where the triangles go of a piece of wood that is gone: to the point of other wood that is nearest to it, or where
/// there is none to its centre.
pub(super) fn drawn_back(form: &Form<'_>, others: &Surface) -> Vec<[DVec3; 3]> {
    let corners = form.triangles.iter().flat_map(|t| t.corners);
    let found = corners.filter_map(|corner| others.nearest(corner));
    let nearest = found.min_by(|a, b| a.distance.total_cmp(&b.distance));
    let point = nearest.map_or(form.centre, |found| found.point);
    vec![[point; 3]; form.triangles.len()]
}
