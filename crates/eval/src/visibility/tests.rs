//! What is seen is what a plain z-buffer shows.

use super::bands::triangles_by_band;
use super::*;
use crate::lens::Projected;
use crate::screen_triangle::Face;
use proptest::prelude::*;

fn triangle(corners: [[f32; 2]; 3]) -> ScreenTriangle {
    ScreenTriangle {
        face: Face {
            surface: 0,
            triangle: 0,
        },
        corners: corners.map(|[x, y]| Projected {
            at: Vec2::new(x, y),
            nearness: 1.0,
            inverse_w: 1.0,
        }),
        shares: [Vec2::ZERO, Vec2::X, Vec2::Y],
    }
}

/// What is seen where each sample is held against each triangle in scene order.
fn literal(triangles: &[ScreenTriangle], surface: &Surface, side: usize) -> Vec<u32> {
    let mut frontmost = vec![NOTHING; side * side];
    let mut nearness = vec![f32::NEG_INFINITY; side * side];
    for (index, triangle) in triangles.iter().enumerate() {
        let Some(place) = PointInTriangle::within(triangle) else {
            continue;
        };
        let cutout = Cut::of(triangle, surface, Alpha::default());
        let corners = triangle.corners.map(|corner| corner.at);
        let [low, high] = [
            corners.into_iter().fold(Vec2::MAX, Vec2::min),
            corners.into_iter().fold(Vec2::MIN, Vec2::max),
        ];
        for row in sample_range(low.y, high.y, 0..side) {
            for column in sample_range(low.x, high.x, 0..side) {
                let at = Vec2::new(column as f32 + 0.5, row as f32 + 0.5);
                let weights = place.weights(at);
                let near = weighted(triangle.corners.map(|c| c.nearness), weights);
                let sample = row * side + column;
                if weights.iter().all(|weight| *weight >= EDGE_SLACK)
                    && near > nearness[sample]
                    && cutout.strength(triangle, &place, at, weights) >= 1.0
                {
                    nearness[sample] = near;
                    frontmost[sample] = index as u32;
                }
            }
        }
    }
    frontmost
}

/// One triangle of a card whose mask is a chessboard.
fn chessboard() -> Surface {
    card(8, 3.0, |x, y| (x + y).is_multiple_of(2))
}

/// One of a card that is clear but for a large round leaf: blocks of samples are clear, opaque, or neither.
fn round_leaf() -> Surface {
    card(256, 1.1, |x, y| {
        (f64::from(x) - 110.0).hypot(f64::from(y) - 90.0) < 70.0
    })
}

/// One triangle of a card on which a texture of `side` x `side` texels repeats `repeats` times, opaque where
/// `is_opaque` says so of a column and row.
fn card(side: u32, repeats: f32, is_opaque: impl Fn(u32, u32) -> bool) -> Surface {
    let alpha = |k: u32| match is_opaque(k % side, k / side) {
        true => 255,
        false => 0,
    };
    Surface {
        positions: vec![glam::DVec3::ZERO; 3],
        normals: Vec::new(),
        uvs: vec![Vec2::ZERO, repeats * Vec2::X, repeats * Vec2::Y],
        colors: Vec::new(),
        holds: Vec::new(),
        triangles: vec![[0, 1, 2]],
        material: std::sync::Arc::new(secateur_model::Material {
            name: String::new(),
            base_color: [1.0; 4],
            texture: Some(std::sync::Arc::new(secateur_model::Texture {
                width: side,
                height: side,
                rgba: (0..side * side)
                    .flat_map(|k| [255, 255, 255, alpha(k)])
                    .collect(),
                wrap: [secateur_model::Wrap::Repeat; 2],
                filters: secateur_model::Filters::default(),
            })),
            alpha_mode: secateur_model::AlphaMode::Mask(0.5),
            double_sided: true,
            finish: secateur_model::Finish::default(),
        }),
    }
}

fn corner() -> impl Strategy<Value = [f32; 2]> {
    [-40f32..120.0, -40f32..120.0]
}

proptest! {
    /// Nearest first and block by block, with ties: what is seen is what a plain z-buffer shows.
    #[test]
    fn what_is_seen_does_not_depend_on_the_order_of_drawing(
        corners in prop::collection::vec([corner(), corner(), corner()], 1..40),
        depths in prop::collection::vec([0u8..4, 0u8..4, 0u8..4], 40),
        is_round in prop::bool::ANY,
        perspective in 0f32..1.0,
    ) {
        // No whole number of blocks.
        const SIDE: usize = 77;
        let surface = if is_round { round_leaf() } else { chessboard() };
        let masks = CutMasks::default();
        let mask = masks.of(&surface.material);
        let alpha = Alpha { mips: None, mask: mask.as_deref() };
        let triangles: Vec<ScreenTriangle> = corners.iter().zip(&depths).map(|(corners, depths)| {
            let mut made = triangle(*corners);
            for (corner, depth) in made.corners.iter_mut().zip(depths) {
                corner.nearness = f32::from(*depth);
                corner.inverse_w = 1.0 + 30.0 * perspective * f32::from(*depth);
            }
            made
        }).collect();
        let drawn = |seek| {
            let mut frontmost = vec![NOTHING; SIDE * SIDE];
            let mut nearness = vec![f32::NEG_INFINITY; SIDE * SIDE];
            for (number, members) in triangles_by_band(&triangles, (SIDE, BAND_ROWS), seek).iter().enumerate() {
                let first = number * BAND_ROWS;
                let samples = first * SIDE..SIDE * SIDE.min(first + BAND_ROWS);
                let rows = (&mut frontmost[samples.clone()], &mut nearness[samples]);
                let mut band = Band::new(first, SIDE, seek, rows);
                for &member in members {
                    band.draw(member, &triangles[member as usize], &surface, alpha);
                }
            }
            frontmost
        };
        let expected = literal(&triangles, &surface, SIDE);
        let is_covered = |seen: &[u32]| seen.iter().map(|index| *index != NOTHING).collect::<Vec<_>>();
        prop_assert_eq!(is_covered(&drawn(Seek::Any)), is_covered(&expected));
        prop_assert_eq!(drawn(Seek::Frontmost), expected);
    }

    /// Slivers and large triangles, on the raster and beyond it, alone.
    #[test]
    fn no_sample_that_a_sliver_covers_is_left_out(
        a in corner(), b in corner(), c in corner(), thin in 0f32..1.0,
    ) {
        // As thin grows the third corner comes to lie on the edge between the others.
        let c = [0, 1].map(|k| c[k] + (0.5 * (a[k] + b[k]) - c[k]) * thin.powf(0.01));
        const SIDE: usize = 31;
        let triangles = [triangle([a, b, c])];
        let mut frontmost = vec![NOTHING; SIDE * SIDE];
        let mut nearness = vec![f32::NEG_INFINITY; SIDE * SIDE];
        let surface = chessboard();
        let mut band = Band::new(0, SIDE, Seek::Frontmost, (&mut frontmost, &mut nearness));
        band.draw(0, &triangles[0], &surface, Alpha::default());
        prop_assert_eq!(frontmost, literal(&triangles, &surface, SIDE));
    }
}
