//! Bark that is cut into charts: where a coarser surface has its texture from.
//!
//! On scanned, unwrapped or baked bark neighbouring triangles have texture coordinates far from each
//! other; a *chart* is a set of triangles among which they go on across edges. Collapses that keep the
//! edges of charts cannot touch such a surface, so it is simplified as if it had no texture. Each triangle
//! that is left then has its texture from one chart near it: the bark may be drawn out, but no triangle
//! runs across the atlas.

use glam::{DVec2, DVec3};
use rstar::RTree;
use rstar::primitives::GeomWithData;
use rustc_hash::FxHashMap;
use secateur_model::LeafTriangle;

use super::welded::Welded;

/// A piece is cut into charts where more than this share of its places have three texture coordinates or
/// more, which no collapse can keep. Along a tube with one seam, and at its pointed ends, few have.
const CUT: f64 = 0.125;

/// So many such places do not make a piece one of charts: the pointed ends of a twig.
const UNCUT_PLACES: usize = 2;

/// Texture coordinates that differ by less are one: tools count them anew for each triangle.
const SAME_UV: f64 = 1e-5;

/// The most places near a corner that are looked at for charts.
const MOST_NEAR: usize = 24;

/// A triangle whose texture is thinner than this, its height over its longest side, shows streaks.
const THINNEST: f64 = 0.05;

/// A number at a point.
type Numbered = GeomWithData<[f64; 3], u32>;

/// The charts of a piece, whose corners are numbered as in [`secateur_model::CornerRef`].
#[derive(Clone, Debug)]
pub(super) struct Charts {
    triangles: Vec<LeafTriangle>,
    /// By triangle, its chart: a triangle of it.
    chart_of: Vec<u32>,
    /// By place, the corners there.
    corners_at: Vec<Vec<u32>>,
    places: RTree<Numbered>,
    centroids: RTree<Numbered>,
}

impl Charts {
    /// Nothing of a piece that collapses can keep the charts of.
    pub(super) fn of(triangles: &[LeafTriangle]) -> Option<Self> {
        let mesh = Welded::of(triangles);
        let mut corners_at: Vec<Vec<u32>> = vec![Vec::new(); mesh.places.len()];
        for (corner, place) in (0..).zip(mesh.triangles.as_flattened()) {
            corners_at[*place].push(corner);
        }
        let is_cut = |corners: &&Vec<u32>| {
            let mut uvs: Vec<[u64; 2]> = Vec::new();
            for corner in *corners {
                let uv = uv_of(triangles, *corner).to_array();
                let uv = uv.map(|x| (x + 0.0).to_bits());
                if !uvs.contains(&uv) {
                    uvs.push(uv);
                }
                if uvs.len() > 2 {
                    return true;
                }
            }
            false
        };
        let cut = corners_at.iter().filter(is_cut).count();
        if cut as f64 <= UNCUT_PLACES as f64 + CUT * mesh.places.len() as f64 {
            return None;
        }
        let numbered = |points: Vec<DVec3>| {
            let points = points.into_iter().zip(0..);
            let points = points.map(|(at, number)| Numbered::new(at.to_array(), number));
            RTree::bulk_load(points.collect())
        };
        Some(Self {
            chart_of: charts(triangles, &mesh),
            corners_at,
            centroids: numbered(triangles.iter().map(|t| centroid(t.corners)).collect()),
            places: numbered(mesh.places),
            triangles: triangles.to_vec(),
        })
    }

    /// The corners, all of one chart, whose texture coordinates a triangle of these corners has: those
    /// that are nearest to it, each to each; its own where they are of one chart.
    pub(super) fn texture_of(&self, corners: [u32; 3]) -> [u32; 3] {
        let [a, b, c] = corners.map(|corner| corner / 3);
        if a == b && b == c {
            return corners;
        }
        let at = corners.map(|corner| self.position(corner));
        let of_triangle = self.of_nearest_triangle(at);
        let distance = |found: [u32; 3]| -> f64 {
            (0..3)
                .map(|k| self.position(found[k]).distance(at[k]))
                .sum()
        };
        let mut best = (distance(of_triangle), of_triangle);
        let near = at.map(|at| self.near(at));
        for &(chart, a) in &near[0] {
            let in_chart =
                |near: &[(u32, u32)]| near.iter().find(|found| found.0 == chart).copied();
            let (Some((_, b)), Some((_, c))) = (in_chart(&near[1]), in_chart(&near[2])) else {
                continue;
            };
            let found = (distance([a, b, c]), [a, b, c]);
            if found.0 < best.0 && !self.is_thin(found.1) {
                best = found;
            }
        }
        best.1
    }

    /// Charts near a point, each with its corner that is nearest to it.
    fn near(&self, point: DVec3) -> Vec<(u32, u32)> {
        let mut found: Vec<(u32, u32)> = Vec::new();
        let places = self.places.nearest_neighbor_iter(point.to_array());
        for place in places.take(MOST_NEAR) {
            for &corner in &self.corners_at[place.data as usize] {
                let chart = self.chart_of[corner as usize / 3];
                if found.iter().all(|known| known.0 != chart) {
                    found.push((chart, corner));
                }
            }
        }
        found
    }

    /// The corners of the triangle that is nearest to three points, turned so that each is near its own.
    fn of_nearest_triangle(&self, at: [DVec3; 3]) -> [u32; 3] {
        let middle = centroid(at).to_array();
        let nearest = self.centroids.nearest_neighbor(middle);
        let triangle = nearest.expect("a piece has triangles").data;
        let turned = |by: u32| [0, 1, 2].map(|k| 3 * triangle + (k + by) % 3);
        let distance = |corners: &[u32; 3]| -> f64 {
            (0..3)
                .map(|k| self.position(corners[k]).distance(at[k]))
                .sum()
        };
        let all = [0, 1, 2].map(turned).into_iter();
        all.min_by(|a, b| distance(a).total_cmp(&distance(b)))
            .expect("three turns")
    }

    /// Whether a triangle of these corners would show streaks.
    fn is_thin(&self, corners: [u32; 3]) -> bool {
        let [a, b, c] = corners.map(|corner| uv_of(&self.triangles, corner));
        let longest = [b - a, c - b, a - c].map(DVec2::length_squared);
        let longest = longest.into_iter().fold(0.0, f64::max);
        (b - a).perp_dot(c - a).abs() <= THINNEST * longest
    }

    fn position(&self, corner: u32) -> DVec3 {
        self.triangles[corner as usize / 3].corners[corner as usize % 3]
    }
}

/// By triangle, the first one of its chart.
fn charts(triangles: &[LeafTriangle], mesh: &Welded) -> Vec<u32> {
    let mut chart_of: Vec<u32> = (0..triangles.len() as u32).collect();
    // By edge, what has it: the corners of a triangle at the smaller place and at the other.
    let mut sides: FxHashMap<[usize; 2], Vec<[u32; 2]>> = FxHashMap::default();
    for (first, places) in (0..).step_by(3).zip(&mesh.triangles) {
        for k in 0..3 {
            let [from, to] = [k, (k + 1) % 3].map(|k| (places[k], first + k as u32));
            let [low, high] = if from.0 < to.0 {
                [from, to]
            } else {
                [to, from]
            };
            let side = [low.1, high.1];
            let beside = sides.entry([low.0, high.0]).or_default();
            for other in beside.iter() {
                let goes_on = |k: usize| {
                    let [a, b] = [side[k], other[k]].map(|corner| uv_of(triangles, corner));
                    a.distance(b) <= SAME_UV
                };
                if goes_on(0) && goes_on(1) {
                    join(&mut chart_of, side[0] / 3, other[0] / 3);
                }
            }
            beside.push(side);
        }
    }
    (0..triangles.len() as u32)
        .map(|triangle| first_of(&mut chart_of, triangle))
        .collect()
}

/// The first triangle of a chart; the way there gets shorter.
fn first_of(chart_of: &mut [u32], mut triangle: u32) -> u32 {
    while chart_of[triangle as usize] != triangle {
        let next = chart_of[triangle as usize];
        chart_of[triangle as usize] = chart_of[next as usize];
        triangle = next;
    }
    triangle
}

fn join(chart_of: &mut [u32], a: u32, b: u32) {
    let [a, b] = [a, b].map(|triangle| first_of(chart_of, triangle));
    chart_of[a.max(b) as usize] = a.min(b);
}

fn centroid([a, b, c]: [DVec3; 3]) -> DVec3 {
    (a + b + c) / 3.0
}

fn uv_of(triangles: &[LeafTriangle], corner: u32) -> DVec2 {
    triangles[corner as usize / 3].uvs[corner as usize % 3]
}
