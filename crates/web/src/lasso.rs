//! What a loop drawn over the picture holds: the pieces, or parts, of which most pixels of our own leaf-ID buffer lie in it.

use std::collections::{BTreeMap, BTreeSet};

use secateur::glam::{DVec2, DVec3};
use secateur::{LeafId, Lod, ScenePieces, View, ViewSet};
use secateur_raster::{MAX_RESOLUTION, Scene, cpu};

/// A piece by the number of the place of its primitive and its own, or a whole part.
pub(crate) type Key<'p> = (&'p str, Option<u32>);

/// The camera of the picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Camera {
    eye: DVec3,
    target: DVec3,
    /// The tangent of half the field of view up.
    tangent: f64,
    /// The picture's width over its height.
    aspect: f64,
    /// Nothing nearer is seen, in metres.
    near: f64,
    /// The picture's height, in pixels.
    height_px: f64,
}

impl Camera {
    /// A camera of ten numbers: the eye, the target, half the field of view up as a tangent, width over height, the
    /// nearest distance in metres, and the height in pixels.
    pub(crate) fn of(numbers: &[f64]) -> Result<Self, String> {
        let &[
            eye_x,
            eye_y,
            eye_z,
            target_x,
            target_y,
            target_z,
            tangent,
            aspect,
            near,
            height_px,
        ] = numbers
        else {
            return Err(format!("a camera is ten numbers, not {}", numbers.len()));
        };
        Ok(Self {
            eye: DVec3::new(eye_x, eye_y, eye_z),
            target: DVec3::new(target_x, target_y, target_z),
            tangent,
            aspect,
            near,
            height_px,
        })
    }

    /// How much larger the square leaf-ID buffer is than the picture, across and up, and its side in pixels.
    fn square(&self) -> (DVec2, u32) {
        let larger = DVec2::new((1.0 / self.aspect).max(1.0), self.aspect.max(1.0));
        let side = (self.height_px * larger.y).round();
        (larger, (side as u32).clamp(1, MAX_RESOLUTION))
    }

    fn view(&self) -> Result<View, String> {
        let tangent = self.tangent * self.aspect.max(1.0);
        let view = View::look_at(self.eye, self.target, DVec3::Y, tangent, self.near);
        view.map_err(|error| error.to_string())
    }
}

/// What a loop holds, rising. `corners` are in the picture, from -1, -1 at the lower left to 1, 1 at the upper right.
pub(crate) fn held<'p>(
    pieces: &'p ScenePieces,
    camera: &Camera,
    corners: &[DVec2],
    of_parts: bool,
) -> Result<BTreeSet<Key<'p>>, String> {
    let (larger, side) = camera.square();
    let foliage = pieces.foliage();
    let ids = cpu::draw_leaf_ids(
        &Scene {
            foliage,
            lod: &Lod::original(foliage.leaves().len()),
            views: &ViewSet::new(Vec::new()),
            resolution: side,
        },
        &camera.view()?,
    );
    let corners = corners.iter().map(|corner| *corner / larger);
    let corners: Vec<DVec2> = corners
        .map(|corner| DVec2::new(1.0 + corner.x, 1.0 - corner.y) * (0.5 * f64::from(side)))
        .collect();
    let mut seen: BTreeMap<Key<'p>, [u32; 2]> = BTreeMap::new();
    for (y, row) in ids.leaf_ids.chunks(side as usize).enumerate() {
        let inside = inside_of_row(&corners, y as f64 + 0.5);
        for (x, leaf) in row.iter().enumerate() {
            let Some(leaf) = LeafId::new(*leaf) else {
                continue;
            };
            let (place, number) = pieces.source(leaf);
            let [within, all] = seen
                .entry((place, (!of_parts).then_some(number)))
                .or_default();
            *within += u32::from(is_within(&inside, x as f64 + 0.5));
            *all += 1;
        }
    }
    let most = seen
        .into_iter()
        .filter(|(_, [within, all])| 2 * within > *all);
    Ok(most.map(|(key, _)| key).collect())
}

/// Where a row crosses the loop, from the left, each with whether the loop goes up there.
fn inside_of_row(corners: &[DVec2], y: f64) -> Vec<(f64, i32)> {
    let before = corners.iter().cycle().skip(corners.len().saturating_sub(1));
    let mut crossings: Vec<(f64, i32)> = before
        .zip(corners)
        .filter(|(a, b)| (a.y <= y) != (b.y <= y))
        .map(|(a, b)| {
            let x = a.x + (y - a.y) / (b.y - a.y) * (b.x - a.x);
            (x, if b.y > a.y { 1 } else { -1 })
        })
        .collect();
    crossings.sort_by(|(a, _), (b, _)| a.total_cmp(b));
    crossings
}

/// Whether the loop winds about a place of a row: where it crosses itself, what it goes around twice is within it.
fn is_within(crossings: &[(f64, i32)], x: f64) -> bool {
    let left = crossings.iter().take_while(|(crossing, _)| *crossing <= x);
    left.map(|(_, turn)| turn).sum::<i32>() != 0
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_loop_holds_what_it_goes_around_once_or_twice() {
        let square = [[1.0, 1.0], [4.0, 1.0], [4.0, 4.0], [1.0, 4.0]].map(DVec2::from_array);
        let twice = [square, square].concat();
        for corners in [&square[..], &twice] {
            let row = inside_of_row(corners, 2.5);
            let within = [0.5, 1.5, 3.5, 4.5].map(|x| is_within(&row, x));
            assert_eq!(within, [false, true, true, false]);
            assert!(inside_of_row(corners, 5.5).is_empty());
        }
        assert!(inside_of_row(&[], 1.0).is_empty());
    }

    /// A picture twice as wide as high, of 100 pixels: the square about it has 200, and the picture fills its width.
    #[test]
    fn the_square_buffer_holds_a_wide_picture_and_a_high_one() {
        let of = |aspect| Camera::of(&[0.0, 0.0, 5.0, 0.0, 0.0, 0.0, 0.5, aspect, 1.0, 100.0]);
        assert_eq!(of(2.0).unwrap().square(), (DVec2::new(1.0, 2.0), 200));
        assert_eq!(of(0.5).unwrap().square(), (DVec2::new(2.0, 1.0), 100));
        assert_eq!(of(2.0).unwrap().view().unwrap().tan_half_fov(), 1.0);
        assert!(Camera::of(&[1.0]).is_err());
    }
}
