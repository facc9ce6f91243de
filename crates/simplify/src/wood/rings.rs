//! A tube by its rings, and what is left of it with fewer rings and sides.
//!
//! A ring is all places of a piece that are as many edges away from one of its ends. Few of them,
//! with a few places of each, make tubes of fewer sides, down to three, and flat strips. All
//! corners are corners of the piece, so textures stay where they are along it and weights of skins
//! with their vertices. What is no tube gets poor levels, which their losses say.

use glam::{DQuat, DVec2, DVec3};
use secateur_model::LeafTriangle;

use super::welded::Welded;

/// What goes from each place of a ring to which other place of it, on the way around: tubes of few sides.
const TUBES: [&[[usize; 2]]; 3] = [
    &[[0, 1], [1, 2], [2, 3], [3, 4], [4, 5], [5, 0]],
    &[[0, 1], [1, 2], [2, 3], [3, 0]],
    &[[0, 1], [1, 2], [2, 0]],
];

/// Two strips that cross, and a flat strip, where both faces of a strip are seen. Two that cross
/// are still seen where one of them is edge on.
const STRIPS: [(usize, &[[usize; 2]]); 2] = [(4, &[[0, 2], [1, 3]]), (2, &[[0, 1]])];

/// A flat strip where only the front of a triangle is seen. Two that cross would have more triangles than
/// a tube of three sides.
const BACKED_STRIP: &[[usize; 2]] = &[[0, 1], [1, 0]];

/// The most sides of tubes that may end in a point.
const MOST_POINTED: usize = 3;

/// A tube may end in a point where it is no thicker than this share of its other end. Of .5, .6 and .8, tried at a
/// tenth of all triangles on five plants, .5 had the least FLIP on a palmetto, .0391 for .0396, and else they were
/// alike.
const POINTED: f64 = 0.5;

/// The most segments that a strip or tube of few sides is tried with.
const MOST_SEGMENTS: usize = 64;

/// The most corners of different texture at a place that are told apart.
const MOST_WEDGES: usize = 3;

/// A place of a ring, with one corner of the piece for each of its texture coordinates.
struct Place {
    at: DVec3,
    corners: Vec<u32>,
}

/// The rings of a piece.
struct Rings {
    /// From one end to the other.
    rings: Vec<Ring>,
    /// By corner, the number of its ring.
    of_corners: Vec<usize>,
    /// Whether its triangles face inward.
    is_inward: bool,
}

struct Ring {
    places: Vec<Place>,
    centre: DVec3,
    radius: f64,
}

/// Levels of few sides and rings, as corners of the piece; none of a piece without rings. A strip
/// has its triangles twice, front and back, unless both sides of each are seen.
pub(super) fn tubes(
    triangles: &[LeafTriangle],
    is_seen_from_both_sides: bool,
) -> Vec<Vec<[u32; 3]>> {
    let Some(Rings {
        rings, is_inward, ..
    }) = rings(triangles)
    else {
        return Vec::new();
    };
    let mut levels = Vec::new();
    let mut shapes: Vec<(usize, &[[usize; 2]])> = TUBES.map(|faces| (faces.len(), faces)).to_vec();
    match is_seen_from_both_sides {
        true => shapes.extend(STRIPS),
        false => shapes.push((2, BACKED_STRIP)),
    }
    let point = thin_end(&rings);
    for cuts in cuts(&rings) {
        for &shape in &shapes {
            let pointed = point.filter(|_| shape.0 <= MOST_POINTED).map(Some);
            for point in std::iter::once(None).chain(pointed) {
                let mut level = tube(triangles, &rings, &cuts, shape, point);
                if is_inward {
                    level.iter_mut().for_each(|t| t.swap(1, 2));
                }
                if !level.is_empty() && level.len() < triangles.len() {
                    levels.push(level);
                }
            }
        }
    }
    levels
}

/// By corner of a piece the centre of its ring; none of a piece without rings.
pub(super) fn ring_centres(triangles: &[LeafTriangle]) -> Option<Vec<DVec3>> {
    let found = rings(triangles)?;
    let centre = |ring: &usize| found.rings[*ring].centre;
    Some(found.of_corners.iter().map(centre).collect())
}

/// The rings of a piece, if it is longer than it is wide.
fn rings(triangles: &[LeafTriangle]) -> Option<Rings> {
    let mesh = Welded::of(triangles);
    let place = |at: &DVec3| Place {
        at: *at,
        corners: Vec::new(),
    };
    let mut places: Vec<Place> = mesh.places.iter().map(place).collect();
    for (t, numbers) in mesh.triangles.iter().enumerate() {
        for (k, number) in numbers.iter().enumerate() {
            let known = &mut places[*number].corners;
            let uv = triangles[t].uvs[k];
            let is_new = known.iter().all(|c| uv_of(triangles, *c) != uv);
            if is_new && known.len() < MOST_WEDGES {
                known.push((3 * t + k) as u32);
            }
        }
    }
    let hops = mesh.hops(&end(&mesh));
    let last = *hops.iter().max()?;
    if last == 0 || last == usize::MAX {
        return None;
    }
    let mut rings: Vec<Vec<Place>> = (0..=last).map(|_| Vec::new()).collect();
    for (place, &hop) in places.into_iter().zip(&hops) {
        rings[hop].push(place);
    }
    let rings: Vec<Ring> = rings.into_iter().map(Ring::of).collect();
    let steps = rings.windows(2);
    let length: f64 = steps
        .map(|pair| pair[0].centre.distance(pair[1].centre))
        .sum();
    let widest = rings.iter().map(|ring| ring.radius).fold(0.0, f64::max);
    // What is no longer than it is wide is no tube.
    if length < 2.0 * widest {
        return None;
    }
    let mut facing = 0.0;
    for (triangle, places) in triangles.iter().zip(&mesh.triangles) {
        let [a, b, c] = triangle.corners;
        let centre = places.map(|place| rings[hops[place]].centre);
        let outward = a + b + c - centre.iter().sum::<DVec3>();
        facing += (b - a).cross(c - a).dot(outward);
    }
    let of_corners = mesh.triangles.iter().flatten().map(|place| hops[*place]);
    Some(Rings {
        of_corners: of_corners.collect(),
        rings,
        is_inward: facing < 0.0,
    })
}

/// The places of one end: of the border that reaches furthest from the middle; of a piece without
/// a border the one place that does.
fn end(mesh: &Welded) -> Vec<usize> {
    let middle = mesh.places.iter().sum::<DVec3>() / mesh.places.len() as f64;
    let distance = |place: usize| mesh.places[place].distance_squared(middle);
    let reach = |places: &[usize]| places.iter().map(|p| distance(*p)).fold(0.0, f64::max);
    let borders = mesh.borders().into_iter().rev();
    if let Some(border) = borders.max_by(|a, b| reach(a).total_cmp(&reach(b))) {
        return border;
    }
    let all = (0..mesh.places.len()).rev();
    let furthest = all.max_by(|a, b| distance(*a).total_cmp(&distance(*b)));
    furthest.into_iter().collect()
}

impl Ring {
    fn of(places: Vec<Place>) -> Self {
        let count = places.len() as f64;
        let centre = places.iter().map(|p| p.at).sum::<DVec3>() / count;
        let radius = places.iter().map(|p| p.at.distance(centre)).sum::<f64>() / count;
        Self {
            places,
            centre,
            radius,
        }
    }
}

/// Ever more rings, from the two ends on, each list rising: the next one is where the line of the
/// centres, or the radius, is off the most.
fn cuts(rings: &[Ring]) -> Vec<Vec<usize>> {
    let mut chosen = vec![0, rings.len() - 1];
    let mut lists = vec![chosen.clone()];
    let most = (rings.len() - 1).min(MOST_SEGMENTS);
    let mut wanted = 2;
    while chosen.len() <= most {
        let mut worst = (-1.0, 0);
        for pair in chosen.windows(2) {
            let [from, to] = [&rings[pair[0]], &rings[pair[1]]];
            let along = to.centre - from.centre;
            for (ring, number) in rings[pair[0]..pair[1]].iter().zip(pair[0]..).skip(1) {
                let share = (ring.centre - from.centre).dot(along) / along.length_squared();
                let share = if share.is_finite() {
                    share.clamp(0.0, 1.0)
                } else {
                    0.0
                };
                let off = ring.centre.distance(from.centre + share * along);
                let radius = from.radius + share * (to.radius - from.radius);
                let off = off + (ring.radius - radius).abs();
                if off > worst.0 {
                    worst = (off, number);
                }
            }
        }
        let at = chosen.partition_point(|number| *number < worst.1);
        chosen.insert(at, worst.1);
        if chosen.len() > wanted {
            lists.push(chosen.clone());
            wanted += wanted.div_ceil(2);
        }
    }
    lists
}

/// The end of a tube that may be a point: the thin one, if it is not one already.
fn thin_end(rings: &[Ring]) -> Option<usize> {
    let last = rings.len() - 1;
    let (thin, thick) = match rings[0].radius < rings[last].radius {
        true => (0, last),
        false => (last, 0),
    };
    let is_thin = rings[thin].radius <= POINTED * rings[thick].radius;
    (is_thin && rings[thin].places.len() > 1).then_some(thin)
}

/// The tube through some places of some rings, this many of each. `faces` are pairs of these places that
/// one side goes through. Of the ring `point` there is but one place.
fn tube(
    triangles: &[LeafTriangle],
    rings: &[Ring],
    cuts: &[usize],
    (sides, faces): (usize, &[[usize; 2]]),
    point: Option<usize>,
) -> Vec<[u32; 3]> {
    let chosen: Vec<&Ring> = cuts.iter().map(|cut| &rings[*cut]).collect();
    let mut directions: Vec<DVec3> = Vec::new();
    let mut rows: Vec<Vec<&Place>> = Vec::new();
    let Some(first) = chosen.iter().position(|ring| ring.places.len() >= sides) else {
        return Vec::new();
    };
    let [before, after] = [first.saturating_sub(1), (first + 1).min(chosen.len() - 1)];
    let axis = (chosen[after].centre - chosen[before].centre).normalize_or(DVec3::Y);
    let from = chosen[first];
    let start = seam(from).unwrap_or(&from.places[0]).at - from.centre;
    let start = start.reject_from_normalized(axis);
    let start = start.normalize_or(axis.any_orthonormal_vector());
    for side in 0..sides {
        let angle = std::f64::consts::TAU * side as f64 / sides as f64;
        directions.push(DQuat::from_axis_angle(axis, angle) * start);
    }
    for (ring, cut) in chosen.into_iter().zip(cuts) {
        let mut row = row(ring, &directions);
        if point == Some(*cut) {
            let tip = row[0];
            row.fill(tip);
        }
        if ring.places.len() >= sides && point != Some(*cut) {
            for (direction, place) in directions.iter_mut().zip(&row) {
                *direction = (place.at - ring.centre).normalize_or(*direction);
            }
        }
        rows.push(row);
    }
    let mut made = Vec::new();
    for pair in rows.windows(2) {
        for &[side, next] in faces {
            let quad = [pair[0][side], pair[0][next], pair[1][next], pair[1][side]];
            let corners = corners_of_one_texture(triangles, quad);
            for [a, b, c] in [[0, 1, 2], [0, 2, 3]] {
                let places = [a, b, c].map(|k| quad[k].at);
                if places[0] != places[1] && places[1] != places[2] && places[2] != places[0] {
                    made.push([a, b, c].map(|k| corners[k]));
                }
            }
        }
    }
    made
}

/// A place where two textures meet.
fn seam(ring: &Ring) -> Option<&Place> {
    ring.places.iter().find(|place| place.corners.len() > 1)
}

/// For each direction the place of a ring that lies that way, each place once where there are
/// enough; the first is at a seam of the texture where there is one.
fn row<'a>(ring: &'a Ring, directions: &[DVec3]) -> Vec<&'a Place> {
    let mut is_taken = vec![false; ring.places.len()];
    let has_all = ring.places.len() >= directions.len();
    let has_seam = seam(ring).is_some();
    let mut row = Vec::new();
    for (side, direction) in directions.iter().enumerate() {
        let mut best = (f64::NEG_INFINITY, 0);
        for (number, place) in ring.places.iter().enumerate() {
            let is_out =
                (has_all && is_taken[number]) || (side == 0 && has_seam && place.corners.len() < 2);
            let likeness = (place.at - ring.centre).normalize_or_zero().dot(*direction);
            if !is_out && likeness > best.0 {
                best = (likeness, number);
            }
        }
        is_taken[best.1] = true;
        row.push(&ring.places[best.1]);
    }
    row
}

/// A corner of each of four places in a circle, so that texture coordinates along it change the
/// least: on one side of a seam.
fn corners_of_one_texture(triangles: &[LeafTriangle], quad: [&Place; 4]) -> [u32; 4] {
    let mut best = (f64::INFINITY, quad.map(|place| place.corners[0]));
    for &a in &quad[0].corners {
        for &b in &quad[1].corners {
            for &c in &quad[2].corners {
                for &d in &quad[3].corners {
                    let uvs = [a, b, c, d].map(|corner| uv_of(triangles, corner));
                    let change: f64 = (0..4).map(|k| uvs[k].distance(uvs[(k + 1) % 4])).sum();
                    if change < best.0 {
                        best = (change, [a, b, c, d]);
                    }
                }
            }
        }
    }
    best.1
}

fn uv_of(triangles: &[LeafTriangle], corner: u32) -> DVec2 {
    triangles[corner as usize / 3].uvs[corner as usize % 3]
}

#[cfg(test)]
mod tests {
    use super::super::tests::tube as round;
    use super::*;

    fn places(triangles: &[LeafTriangle], level: &[[u32; 3]]) -> Vec<[DVec3; 3]> {
        let at = |c: u32| triangles[c as usize / 3].corners[c as usize % 3];
        level.iter().map(|t| t.map(at)).collect()
    }

    /// A straight tube of eight sides needs no ring between its ends.
    #[test]
    fn a_straight_tube_becomes_three_sides_and_then_a_strip() {
        let all = round(DVec3::ZERO, 8.0 * DVec3::Y, 0.5, 10);
        let levels = tubes(&all, true);
        let counts: Vec<usize> = levels.iter().map(Vec::len).collect();
        assert_eq!(counts[..5], [12, 8, 6, 4, 2]);
        for level in &levels[..5] {
            let corners = places(&all, level);
            for corner in corners.as_flattened() {
                assert!(corner.y == 0.0 || corner.y == 8.0, "{corner}");
            }
        }
        // Seen from one side only, a strip needs a back.
        assert_eq!(tubes(&all, false)[3].len(), 4);
    }

    /// A tube that is less than half as thick at its upper end.
    fn thinner() -> Vec<LeafTriangle> {
        let mut all = round(DVec3::ZERO, 8.0 * DVec3::Y, 0.5, 4);
        for corner in all.iter_mut().flat_map(|t| &mut t.corners) {
            let share = 1.0 - 0.6 * corner.y / 8.0;
            *corner = DVec3::new(share * corner.x, corner.y, share * corner.z);
        }
        all
    }

    #[test]
    fn a_tube_that_gets_thinner_may_end_in_a_point() {
        let all = thinner();
        let levels = tubes(&all, true);
        let pointed = levels.iter().find(|level| level.len() == 3);
        let pointed = places(&all, pointed.expect("a tube of three sides"));
        let corners = pointed.as_flattened();
        let mut tips: Vec<DVec3> = corners.iter().copied().filter(|c| c.y == 8.0).collect();
        assert_eq!(tips.len(), 3);
        tips.dedup();
        assert_eq!(tips.len(), 1);
        // One that is as thick all along may not.
        let all = round(DVec3::ZERO, 8.0 * DVec3::Y, 0.5, 4);
        assert!(tubes(&all, true).iter().all(|level| level.len() != 3));
    }

    /// Seen along the ground from any side: a flat strip is edge on from one.
    #[test]
    fn strips_that_cross_are_seen_from_all_sides() {
        let all = round(DVec3::ZERO, 8.0 * DVec3::Y, 0.5, 10);
        let levels = tubes(&all, true);
        let width = |level: &[[u32; 3]], from: f64| {
            let across = DVec3::new(from.cos(), 0.0, from.sin());
            let corners = places(&all, level);
            let along = corners.as_flattened().iter().map(|c| c.dot(across));
            let most = along.clone().fold(f64::NEG_INFINITY, f64::max);
            most - along.fold(f64::INFINITY, f64::min)
        };
        let least = |level: &[[u32; 3]]| {
            let widths = (0..32).map(|k| width(level, f64::from(k) * 0.1));
            widths.fold(f64::INFINITY, f64::min)
        };
        assert_eq!((levels[3].len(), levels[4].len()), (4, 2));
        assert!(least(&levels[3]) > 0.7, "{}", least(&levels[3]));
        assert!(least(&levels[4]) < 0.1, "{}", least(&levels[4]));
    }

    #[test]
    fn sides_face_as_those_of_the_tube_do() {
        let mut all = round(DVec3::ZERO, 8.0 * DVec3::Y, 0.5, 4);
        for is_turned in [false, true] {
            if is_turned {
                for triangle in &mut all {
                    triangle.corners.swap(1, 2);
                    triangle.uvs.swap(1, 2);
                }
            }
            let outward = |[a, b, c]: [DVec3; 3]| {
                let middle = (a + b + c) / 3.0;
                (b - a)
                    .cross(c - a)
                    .dot(DVec3::new(middle.x, 0.0, middle.z))
            };
            let first = outward(all[0].corners);
            for level in &tubes(&all, false)[..3] {
                for triangle in places(&all, level) {
                    assert!(outward(triangle) * first > 0.0);
                }
            }
        }
    }

    /// Its texture goes once around: across a seam it would run back over the whole width.
    #[test]
    fn no_side_has_the_texture_run_back_across_a_seam() {
        let mut all = round(DVec3::ZERO, 8.0 * DVec3::Y, 0.5, 6);
        for triangle in &mut all {
            let last = triangle.uvs.iter().any(|uv| uv.x > 0.8);
            for uv in &mut triangle.uvs {
                if last && uv.x == 0.0 {
                    uv.x = 1.0;
                }
            }
        }
        for level in tubes(&all, true) {
            for corners in &level {
                let uvs = corners.map(|corner| uv_of(&all, corner));
                let width = |k: usize| (uvs[k].x - uvs[(k + 1) % 3].x).abs();
                let widest = (0..3).map(width).fold(0.0, f64::max);
                assert!(widest <= 0.5, "{widest} of {} triangles", level.len());
            }
        }
    }

    /// A tube that ends in a point, bent at a right angle in the middle.
    #[test]
    fn the_first_ring_between_the_ends_is_at_the_bend() {
        let mut all = round(DVec3::ZERO, 4.0 * DVec3::Y, 0.2, 4);
        let bend = |corner: DVec3| match corner.y > 2.0 {
            true => DVec3::new(corner.x + corner.y - 2.0, 2.0 - corner.x, corner.z),
            false => corner,
        };
        for triangle in &mut all {
            triangle.corners = triangle.corners.map(bend);
        }
        let found = rings(&all).unwrap();
        assert_eq!((found.rings.len(), found.is_inward), (5, false));
        assert_eq!(cuts(&found.rings)[..2], [vec![0, 4], vec![0, 2, 4]]);
    }

    #[test]
    fn what_has_no_rings_has_no_levels() {
        let triangle = LeafTriangle::plain([DVec3::ZERO, DVec3::X, DVec3::Y]);
        assert!(tubes(&[triangle], true).is_empty());
        let point = LeafTriangle::plain([DVec3::ONE; 3]);
        assert!(tubes(&[point, point], true).is_empty());
        // As wide as it is long.
        assert!(tubes(&round(DVec3::ZERO, DVec3::Y, 0.6, 4), true).is_empty());
    }
}
