//! The parts of a connected piece of wood between its forks.
//!
//! Where a trunk and its boughs are one connected mesh, places that are as many edges away from its
//! foot are rings, one for each bough that goes on there (a Reeb graph of the number of edges). Where
//! two rings follow on one, the one with more area above it goes on as the same part; the other begins
//! a part of its own, if it is long enough to be a bough. A part is closed where others grow on it, so
//! that none of them leaves a hole when it goes.

use glam::DVec3;
use rustc_hash::FxHashMap;
use secateur_model::LeafTriangle;

use super::welded::Welded;

/// A piece of fewer triangles is one part: forks take more.
const LEAST_TRIANGLES: usize = 32;

/// A bough has at least this many rings. What is shorter, or no longer than it and what it grows on are
/// wide, is a bump.
const LEAST_RINGS: usize = 2;

/// A part of a piece.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Part {
    /// The part that it grows on; nothing for the first one.
    pub(super) on: Option<usize>,
    /// Corners of the piece, numbered as in [`secateur_model::CornerRef`]; what closes it comes last.
    pub(super) triangles: Vec<[u32; 3]>,
}

/// Places of one number of edges from the foot that edges connect.
struct Ring {
    /// The ring that it follows on.
    below: Option<usize>,
    centre: DVec3,
    radius: f64,
    /// Of the triangles whose furthest place is in this ring, and in those above it.
    area: f64,
    /// To the furthest end above it, along the centres of rings.
    length: f64,
    /// Number of rings to the end that is the most of them away, with this one.
    rings: usize,
}

/// The parts of a piece, each after the one that it grows on; nothing of a piece without forks.
pub(super) fn parts(triangles: &[LeafTriangle]) -> Option<Vec<Part>> {
    if triangles.len() < LEAST_TRIANGLES {
        return None;
    }
    let mesh = Welded::of(triangles);
    let hops = mesh.hops(&foot(&mesh));
    if hops.contains(&usize::MAX) {
        return None;
    }
    let (rings, ring_of) = rings(&mesh, &hops);
    let (part_of_ring, mut grows_on) = boughs(&rings);
    if grows_on.len() < 2 {
        return None;
    }
    let part_of = |place: usize| part_of_ring[ring_of[place]];
    let of_triangles: Vec<usize> = mesh
        .triangles
        .iter()
        .map(|places| part_of_triangle(places.map(part_of), &grows_on))
        .collect();
    let mut parts: Vec<Vec<[u32; 3]>> = vec![Vec::new(); grows_on.len()];
    for (t, part) in of_triangles.iter().enumerate() {
        parts[*part].push([0, 1, 2].map(|k| (3 * t + k) as u32));
    }
    let closing = closing(&mesh, &of_triangles, &grows_on);
    for (part, closing) in parts.iter_mut().zip(closing) {
        part.extend(closing);
    }
    // A part may have lost all triangles to those that meet in it.
    for part in 0..parts.len() {
        while let Some(on) = grows_on[part]
            && parts[on].is_empty()
        {
            grows_on[part] = grows_on[on];
        }
    }
    let mut count = 0;
    let mut names = vec![None; parts.len()];
    for (name, part) in names.iter_mut().zip(&parts) {
        if !part.is_empty() {
            *name = Some(count);
            count += 1;
        }
    }
    let left = parts.into_iter().zip(grows_on);
    let left = left.filter(|(triangles, _)| !triangles.is_empty());
    let parts: Vec<Part> = left
        .map(|(triangles, on)| Part {
            on: on.and_then(|on| names[on]),
            triangles,
        })
        .collect();
    (parts.len() > 1).then_some(parts)
}

/// The places that a piece begins at: of its longest border; of a piece without a border its lowest
/// place.
fn foot(mesh: &Welded) -> Vec<usize> {
    let length = |border: &Vec<usize>| {
        let middle = border.iter().map(|p| mesh.places[*p]).sum::<DVec3>() / border.len() as f64;
        let distances = border.iter().map(|p| mesh.places[*p].distance(middle));
        distances.fold(0.0, f64::max)
    };
    let borders = mesh.borders().into_iter().rev();
    if let Some(border) = borders.max_by(|a, b| length(a).total_cmp(&length(b))) {
        return border;
    }
    let height = |place: &usize| mesh.places[*place].y;
    let lowest = (0..mesh.places.len()).min_by(|a, b| height(a).total_cmp(&height(b)));
    lowest.into_iter().collect()
}

/// All rings, each after those of fewer edges; and the ring of each place.
fn rings(mesh: &Welded, hops: &[usize]) -> (Vec<Ring>, Vec<usize>) {
    let mut upward: Vec<usize> = (0..hops.len()).collect();
    upward.sort_by_key(|place| hops[*place]);
    let mut ring_of = vec![usize::MAX; hops.len()];
    let mut rings: Vec<Ring> = Vec::new();
    let mut sizes: Vec<usize> = Vec::new();
    for first in upward {
        if ring_of[first] != usize::MAX {
            continue;
        }
        ring_of[first] = rings.len();
        let mut found = vec![first];
        let mut below: Option<usize> = None;
        let mut next = 0;
        while next < found.len() {
            for &other in &mesh.around[found[next]] {
                if hops[other] == hops[first] && ring_of[other] == usize::MAX {
                    ring_of[other] = rings.len();
                    found.push(other);
                }
                // Where several go together it follows on the largest.
                let is_larger = |known: usize| sizes[ring_of[other]] > sizes[known];
                if hops[other] < hops[first] && below.is_none_or(is_larger) {
                    below = Some(ring_of[other]);
                }
            }
            next += 1;
        }
        let at = || found.iter().map(|place| mesh.places[*place]);
        let centre = at().sum::<DVec3>() / found.len() as f64;
        rings.push(Ring {
            below,
            centre,
            radius: at().map(|p| p.distance(centre)).sum::<f64>() / found.len() as f64,
            area: 0.0,
            length: 0.0,
            rings: 1,
        });
        sizes.push(found.len());
    }
    for places in &mesh.triangles {
        let [a, b, c] = places.map(|place| mesh.places[place]);
        let last = places.iter().max_by_key(|place| hops[**place]);
        let ring = ring_of[*last.expect("three places")];
        rings[ring].area += 0.5 * (b - a).cross(c - a).length();
    }
    for ring in (0..rings.len()).rev() {
        if let Some(below) = rings[ring].below {
            let step = rings[ring].centre.distance(rings[below].centre);
            rings[below].area += rings[ring].area;
            rings[below].length = rings[below].length.max(rings[ring].length + step);
            rings[below].rings = rings[below].rings.max(rings[ring].rings + 1);
        }
    }
    (rings, ring_of)
}

/// The part of each ring; and of each part the one that it grows on.
fn boughs(rings: &[Ring]) -> (Vec<usize>, Vec<Option<usize>>) {
    // By ring, the one of the most area that follows on it.
    let mut goes_on: Vec<Option<usize>> = vec![None; rings.len()];
    for (ring, Ring { below, area, .. }) in rings.iter().enumerate() {
        if let Some(below) = *below
            && goes_on[below].is_none_or(|known| *area > rings[known].area)
        {
            goes_on[below] = Some(ring);
        }
    }
    let mut parts = vec![0; rings.len()];
    let mut grows_on = vec![None];
    for (number, ring) in rings.iter().enumerate() {
        let Some(below) = ring.below else {
            continue;
        };
        let widest = 2.0 * ring.radius.max(rings[below].radius);
        let is_bough = ring.rings >= LEAST_RINGS && ring.length > widest;
        parts[number] = parts[below];
        if goes_on[below] != Some(number) && is_bough {
            parts[number] = grows_on.len();
            grows_on.push(Some(parts[below]));
        }
    }
    (parts, grows_on)
}

/// The part of a triangle by those of its places: the one that grows on the others, or what they grow on
/// where two of them do.
fn part_of_triangle(places: [usize; 3], grows_on: &[Option<usize>]) -> usize {
    let grows_on_all = |part: &usize| {
        let mut others = places.iter();
        others.all(|other| other == part || grows_on[*part] == Some(*other))
    };
    let least = places.into_iter().min().expect("three places");
    match places.into_iter().find(grows_on_all) {
        Some(part) => part,
        None => grows_on[least].unwrap_or(least),
    }
}

/// By part, triangles that close it where others of the same piece grow on it, as fans of their border.
fn closing(
    mesh: &Welded,
    of_triangles: &[usize],
    grows_on: &[Option<usize>],
) -> Vec<Vec<[u32; 3]>> {
    let edges = |t: usize| {
        let places = mesh.triangles[t];
        let corner = move |k: usize| (places[k % 3], (3 * t + k % 3) as u32);
        [0, 1, 2].map(|k| [corner(k), corner(k + 1)])
    };
    let mut parts_at: FxHashMap<[usize; 2], Vec<usize>> = FxHashMap::default();
    for (t, part) in of_triangles.iter().enumerate() {
        for [(a, _), (b, _)] in edges(t) {
            parts_at
                .entry([a.min(b), a.max(b)])
                .or_default()
                .push(*part);
        }
    }
    let mut borders = vec![Vec::new(); grows_on.len()];
    for (t, part) in of_triangles.iter().enumerate() {
        for edge in edges(t) {
            let [a, b] = edge.map(|(place, _)| place);
            let mut others = parts_at[&[a.min(b), a.max(b)]].iter();
            if a != b && others.any(|other| other != part && grows_on[*part] != Some(*other)) {
                borders[*part].push(edge);
            }
        }
    }
    borders.into_iter().map(fans).collect()
}

/// A place, and a corner there.
type Corner = (usize, u32);

/// Triangles that close borders, which face as those on the other side of their edges do.
fn fans(border: Vec<[Corner; 2]>) -> Vec<[u32; 3]> {
    let mut from: FxHashMap<usize, Vec<usize>> = FxHashMap::default();
    for (number, [(place, _), _]) in border.iter().enumerate().rev() {
        from.entry(*place).or_default().push(number);
    }
    let mut is_taken = vec![false; border.len()];
    let mut fans = Vec::new();
    for first in 0..border.len() {
        let [(apex, apex_corner), _] = border[first];
        let mut next = Some(first).filter(|edge| !is_taken[*edge]);
        while let Some(edge) = next {
            is_taken[edge] = true;
            let [(a, a_corner), (b, b_corner)] = border[edge];
            if a != apex && b != apex {
                fans.push([b_corner, a_corner, apex_corner]);
            }
            let going_on = from.get_mut(&b).filter(|_| b != apex);
            next = going_on.and_then(|edges| {
                edges.retain(|edge| !is_taken[*edge]);
                edges.pop()
            });
        }
    }
    fans
}

#[cfg(test)]
pub(super) mod tests {
    use super::super::tests::tube;
    use super::*;

    /// A tube of eight sides upward with a bough of four sides on one of them, one connected mesh.
    pub(in super::super) fn forked() -> Vec<LeafTriangle> {
        let mut triangles = tube(DVec3::ZERO, 8.0 * DVec3::Y, 0.4, 8);
        // The two triangles of the first side of the fourth ring make way.
        let hole = 3 * 16;
        let [lower, upper] = [triangles[hole].corners, triangles[hole + 1].corners];
        let quad = [lower[0], lower[1], lower[2], upper[2]];
        triangles.drain(hole..hole + 2);
        let centre = quad.iter().sum::<DVec3>() / 4.0;
        let along = DVec3::new(centre.x, 0.0, centre.z).normalize() + 0.2 * DVec3::Y;
        let at = |ring: usize, side: usize| match ring {
            0 => quad[side % 4],
            ring => {
                let narrower = centre + 0.3 * (quad[side % 4] - centre);
                narrower + ring as f64 * 0.6 * along
            }
        };
        for ring in 0..6 {
            for side in 0..4 {
                let [a, b] = [at(ring, side), at(ring, side + 1)];
                let [c, d] = [at(ring + 1, side + 1), at(ring + 1, side)];
                triangles.extend([[a, b, c], [a, c, d]].map(LeafTriangle::plain));
            }
        }
        triangles
    }

    fn places(triangles: &[LeafTriangle], part: &Part) -> Vec<[DVec3; 3]> {
        let at = |c: u32| triangles[c as usize / 3].corners[c as usize % 3];
        part.triangles.iter().map(|t| t.map(at)).collect()
    }

    #[test]
    fn a_bough_of_a_connected_mesh_is_a_part_of_its_own() {
        let all = forked();
        let parts = parts(&all).unwrap();
        assert_eq!(parts.len(), 2);
        assert_eq!([parts[0].on, parts[1].on], [None, Some(0)]);
        let reach = |part| {
            let places = places(&all, part);
            let corners = places.as_flattened().iter();
            corners.map(|c| c.x.hypot(c.z)).fold(0.0, f64::max)
        };
        assert!(reach(&parts[0]) < 1.5 && reach(&parts[1]) > 3.0);
        let closing: usize = parts.iter().map(|part| part.triangles.len()).sum();
        let closing = closing - all.len();
        assert!(
            (1..8).contains(&closing),
            "{closing} triangles close the trunk"
        );
    }

    /// Without its bough the trunk has no borders but its two ends, and all edges are run through once
    /// in either direction.
    #[test]
    fn a_trunk_without_its_bough_has_no_hole() {
        let all = forked();
        let trunk = &parts(&all).unwrap()[0];
        let mut runs: FxHashMap<[[u64; 3]; 2], i32> = FxHashMap::default();
        for triangle in places(&all, trunk) {
            let key = |k: usize| triangle[k % 3].to_array().map(f64::to_bits);
            for k in 0..3 {
                *runs.entry([key(k), key(k + 1)]).or_default() += 1;
            }
        }
        let mut open = Vec::new();
        for ([a, b], count) in &runs {
            assert_eq!(*count, 1, "an edge of more than two triangles");
            if !runs.contains_key(&[*b, *a]) {
                open.push(f64::from_bits(a[1]));
            }
        }
        assert_eq!(open.len(), 16);
        assert!(open.iter().all(|y| *y == 0.0 || *y == 8.0), "{open:?}");
    }

    #[test]
    fn a_tube_is_no_fork_and_neither_is_a_bump() {
        assert_eq!(parts(&tube(DVec3::ZERO, 8.0 * DVec3::Y, 0.4, 8)), None);
        let mut bump = forked();
        // Only the first ring of the bough is left.
        bump.truncate(16 * 8 - 2 + 8);
        assert_eq!(parts(&bump), None);
        assert_eq!(parts(&forked()[..20]), None);
    }
}
