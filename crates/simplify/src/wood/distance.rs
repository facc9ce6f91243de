//! How far a piece of wood is from a level of it.

use glam::DVec3;
use secateur_model::LeafTriangle;

use super::nearest::nearest;

/// Largest number of corners of a piece of which the distance from a level is taken.
const MOST_CORNERS: usize = 192;

/// By how much a ball is larger than it must be, as a share of its radius: far more than rounding moves.
const SLACK: f64 = 1e-9;

/// And as a share of how far it is from the origin.
const ROUNDING: f64 = 1e-12;

/// The triangles of a level, each within a ball, and runs of them within balls: what is far off is not looked at closely.
pub(super) struct Shape {
    triangles: Vec<InBall>,
    /// About as many triangles as there are runs; the last run may have fewer.
    run_len: usize,
    runs: Vec<Ball>,
}

struct InBall {
    corners: [DVec3; 3],
    ball: Ball,
}

#[derive(Clone, Copy)]
struct Ball {
    middle: DVec3,
    radius: f64,
}

impl Shape {
    /// The whole of a piece.
    pub(super) fn of(all: &[LeafTriangle]) -> Self {
        Self::of_corners(all.iter().map(|t| t.corners))
    }

    /// A level of a piece, each triangle as three corners counted over all of the piece.
    pub(super) fn of_level(all: &[LeafTriangle], level: &[[u32; 3]]) -> Self {
        Self::of_corners(corners_of(all, level))
    }

    fn of_corners(triangles: impl Iterator<Item = [DVec3; 3]>) -> Self {
        let in_ball = |corners: [DVec3; 3]| InBall {
            corners,
            ball: Ball::about(corners.map(|corner| (corner, 0.0))),
        };
        let triangles: Vec<InBall> = triangles.map(in_ball).collect();
        let run_len = triangles.len().isqrt().max(1);
        let run = |run: &[InBall]| Ball::about(run.iter().map(|t| (t.ball.middle, t.ball.radius)));
        Self {
            runs: triangles.chunks(run_len).map(run).collect(),
            run_len,
            triangles,
        }
    }

    pub(super) fn corners(&self) -> impl Iterator<Item = DVec3> {
        self.triangles.iter().flat_map(|triangle| triangle.corners)
    }

    /// The distance of a point from the nearest triangle, in world units.
    pub(super) fn distance(&self, point: DVec3) -> f64 {
        let mut least = f64::INFINITY;
        for (run, triangles) in self.runs.iter().zip(self.triangles.chunks(self.run_len)) {
            if run.is_beyond(point, least) {
                continue;
            }
            for triangle in triangles {
                if !triangle.ball.is_beyond(point, least) {
                    least = least.min(triangle.distance(point));
                }
            }
        }
        least
    }

    /// Whether the point is no farther than this from a triangle, in world units.
    pub(super) fn is_within(&self, point: DVec3, most: f64) -> bool {
        let is_near = |t: &InBall| !t.ball.is_beyond(point, most) && t.distance(point) <= most;
        let mut runs = self.runs.iter().zip(self.triangles.chunks(self.run_len));
        runs.any(|(run, triangles)| !run.is_beyond(point, most) && triangles.iter().any(is_near))
    }
}

impl Ball {
    /// Of balls, by their middles and radii, at least one.
    fn about(balls: impl IntoIterator<Item = (DVec3, f64)> + Clone) -> Self {
        let (mut sum, mut count) = (DVec3::ZERO, 0.0);
        for (middle, _) in balls.clone() {
            sum += middle;
            count += 1.0;
        }
        let middle = sum / count;
        let reach = balls
            .into_iter()
            .map(|(at, radius)| at.distance(middle) + radius);
        let radius = reach.fold(0.0, f64::max);
        Self {
            middle,
            radius: radius * (1.0 + SLACK) + ROUNDING * middle.length(),
        }
    }

    /// Whether all of it is surely farther from a point than this.
    fn is_beyond(&self, point: DVec3, distance: f64) -> bool {
        let reach = (distance + self.radius) * (1.0 + SLACK) + ROUNDING * point.length();
        self.middle.distance_squared(point) > reach * reach
    }
}

impl InBall {
    fn distance(&self, point: DVec3) -> f64 {
        nearest(self.corners, point).point.distance(point)
    }
}

/// Where the corners of a level are.
pub(super) fn corners_of(
    all: &[LeafTriangle],
    level: &[[u32; 3]],
) -> impl Iterator<Item = [DVec3; 3]> {
    let at = |corner: u32| all[corner as usize / 3].corners[corner as usize % 3];
    level.iter().map(move |t| t.map(at))
}

/// The mean distance of corners of a piece from a level, in world units.
pub(super) fn mean_distance(all: &[LeafTriangle], level: &Shape) -> f64 {
    let step = (3 * all.len()).div_ceil(MOST_CORNERS);
    let samples = all.iter().flat_map(|t| t.corners).step_by(step);
    let (mut sum, mut count) = (0.0, 0);
    for corner in samples {
        sum += level.distance(corner);
        count += 1;
    }
    sum / f64::from(count)
}

#[cfg(test)]
mod tests {
    use super::*;
    use secateur_model::Random;

    /// A thousand triangles about a far place, against each looked at closely.
    #[test]
    fn balls_change_no_distance() {
        let mut random = Random::new(7);
        let origin = DVec3::new(5e6, -3e6, 2e6);
        let mut at =
            |size: f64| origin + DVec3::from_array([(); 3].map(|()| random.between(-size, size)));
        let all: Vec<LeafTriangle> = (0..1000)
            .map(|_| {
                let first = at(10.0);
                LeafTriangle::plain([
                    first,
                    first + (at(1.0) - origin),
                    first + (at(0.1) - origin),
                ])
            })
            .collect();
        let shape = Shape::of(&all);
        for _ in 0..200 {
            let point = at(15.0);
            let each = all
                .iter()
                .map(|t| nearest(t.corners, point).point.distance(point));
            let expected = each.fold(f64::INFINITY, f64::min);
            assert_eq!(shape.distance(point), expected);
            assert!(shape.is_within(point, expected));
            assert!(!shape.is_within(point, expected * 0.999_999));
        }
        assert_eq!(Shape::of(&[]).distance(origin), f64::INFINITY);
    }
}
