//! What the pieces of a primitive look like: leaves or wood.

use glam::DVec3;

use super::leaves::Leaves;

/// The least number of pieces, all placements counted, that are taken for the leaves of a plant by their shape.
/// Other values were not tried.
pub(crate) const MANY: usize = 16;

/// Pieces with more triangles than this are no single leaves.
const MOST_TRIANGLES: usize = 64;

/// The least flatness (see [`flatness`]) of a leaf. A card bent by 52 degrees
/// has 0.69, a tube at most 0.5.
const LEAST_FLATNESS: f64 = 0.6;

/// The pieces of a primitive, summed up.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Pieces {
    pub(crate) count: usize,
    /// Pieces of at most 64 triangles that are flat or nearly so.
    pub(crate) leaf_like: usize,
    /// The share of all triangles, 0 to 1, that lie in those.
    pub(crate) leaf_like_share: f64,
    /// The share of the leaf-like pieces, 0 to 1, that have the most common
    /// number of triangles.
    pub(crate) alike_share: f64,
    /// Pieces of more than 64 triangles that are round, as stems are.
    pub(crate) stem_like: usize,
    /// The share of all triangles, 0 to 1, that lie in those.
    pub(crate) stem_like_share: f64,
}

impl Pieces {
    /// Whether they look like the leaves and the wood of a plant in one, `placements` times: many leaves,
    /// a tenth of the triangles or more, beside stems of as many.
    pub(crate) fn are_leaves_and_wood(&self, placements: usize) -> bool {
        const LEAST_SHARE: f64 = 0.1;
        self.leaf_like * placements >= MANY
            && self.leaf_like_share.min(self.stem_like_share) >= LEAST_SHARE
    }

    /// Whether they are a few large round ones, placed `placements` times, as crowns are that are modelled as a solid:
    /// no leaves, whatever their name.
    pub(crate) fn are_lumps(&self, placements: usize) -> bool {
        const MOST: f64 = 0.95;
        self.count * placements < MANY && self.stem_like_share >= MOST
    }
}

/// Sums the pieces up.
pub(crate) fn sum_up(positions: &[DVec3], triangles: &[[u32; 3]], pieces: &Leaves) -> Pieces {
    let mut leaf_like = 0;
    let mut leaf_like_triangles = 0;
    let mut stem_like = 0;
    let mut stem_like_triangles = 0;
    let mut by_size = [0usize; MOST_TRIANGLES + 1];
    for piece in pieces.iter() {
        match (!is_large(piece), is_flat(positions, triangles, piece)) {
            (true, true) => {
                leaf_like += 1;
                leaf_like_triangles += piece.len();
                by_size[piece.len()] += 1;
            }
            (false, false) => {
                stem_like += 1;
                stem_like_triangles += piece.len();
            }
            _ => {}
        }
    }
    let share = |part: usize, whole: usize| part as f64 / whole.max(1) as f64;
    let most_common = by_size.into_iter().max().unwrap_or(0);
    Pieces {
        count: pieces.len(),
        leaf_like,
        leaf_like_share: share(leaf_like_triangles, triangles.len()),
        alike_share: share(most_common, leaf_like),
        stem_like,
        stem_like_share: share(stem_like_triangles, triangles.len()),
    }
}

/// Whether a piece has more triangles than a single leaf has.
pub(crate) fn is_large(piece: &[u32]) -> bool {
    piece.len() > MOST_TRIANGLES
}

/// Whether a piece is flat or nearly so, as leaves are.
pub(crate) fn is_flat(positions: &[DVec3], triangles: &[[u32; 3]], piece: &[u32]) -> bool {
    flatness(positions, triangles, piece) >= LEAST_FLATNESS
}

/// How much the normals of a piece lie along one line, whichever way each
/// points: with M the mean of n n^T weighted by area, the sum of M's squared
/// entries (the sum of its squared eigenvalues). 1 for a plane, also one with
/// back faces; 1/2 for a tube around any axis; 1/3 for a ball.
fn flatness(positions: &[DVec3], triangles: &[[u32; 3]], piece: &[u32]) -> f64 {
    let mut moments = [0.0; 6];
    let mut total_area = 0.0;
    for &t in piece {
        let [a, b, c] = triangles[t as usize].map(|v| positions[v as usize]);
        let normal = (b - a).cross(c - a);
        let area = normal.length();
        if area > 0.0 && area.is_finite() {
            let n = normal / area;
            total_area += area;
            let products = [
                n.x * n.x,
                n.y * n.y,
                n.z * n.z,
                n.x * n.y,
                n.y * n.z,
                n.z * n.x,
            ];
            for (moment, product) in moments.iter_mut().zip(products) {
                *moment += area * product;
            }
        }
    }
    if total_area <= 0.0 {
        return 0.0;
    }
    let [xx, yy, zz, xy, yz, zx] = moments.map(|m| m / total_area);
    xx * xx + yy * yy + zz * zz + 2.0 * (xy * xy + yz * yz + zx * zx)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::leaves::find_leaves;

    /// The sides of a prism around z as quads of two triangles.
    fn prism(sides: u32) -> (Vec<DVec3>, Vec<[u32; 3]>) {
        let corner = |k: u32, z: f64| {
            let angle = f64::from(k) / f64::from(sides) * std::f64::consts::TAU;
            DVec3::new(angle.cos(), angle.sin(), z)
        };
        let positions = (0..sides)
            .flat_map(|k| [corner(k, 0.0), corner(k, 5.0)])
            .collect();
        let triangles = (0..sides)
            .flat_map(|k| {
                let (a, b) = (2 * k, 2 * k + 1);
                let (c, d) = (2 * ((k + 1) % sides), 2 * ((k + 1) % sides) + 1);
                [[a, c, b], [b, c, d]]
            })
            .collect();
        (positions, triangles)
    }

    fn flatness_of_all(positions: &[DVec3], triangles: &[[u32; 3]]) -> f64 {
        let all: Vec<u32> = (0..triangles.len() as u32).collect();
        flatness(positions, triangles, &all)
    }

    #[test]
    fn a_tube_is_not_flat_however_few_its_triangles() {
        for sides in [3, 4, 5, 8] {
            let (positions, triangles) = prism(sides);
            let tube = flatness_of_all(&positions, &triangles);
            assert!((tube - 0.5).abs() < 1e-12, "{sides} sides: {tube}");
        }
    }

    #[test]
    fn a_card_is_flat_with_back_faces_and_bent() {
        let bend = 52f64.to_radians();
        let far = DVec3::new(1.0 + bend.cos(), 0.0, bend.sin());
        let positions = [
            DVec3::ZERO,
            DVec3::Y,
            DVec3::X,
            DVec3::X + DVec3::Y,
            far,
            far + DVec3::Y,
        ];
        let plane = [[0, 2, 1], [1, 2, 3], [1, 2, 0]];
        assert!((flatness_of_all(&positions, &plane) - 1.0).abs() < 1e-12);
        // Two equal halves: eigenvalues cos^2 and sin^2 of 26 degrees.
        let bent = [[0, 2, 1], [1, 2, 3], [2, 4, 3], [3, 4, 5]];
        let (s, c) = 26f64.to_radians().sin_cos();
        let expected = s.powi(4) + c.powi(4);
        assert!((flatness_of_all(&positions, &bent) - expected).abs() < 1e-12);
        assert!(expected > LEAST_FLATNESS);
    }

    #[test]
    fn shares_are_of_triangles_and_of_leaf_like_pieces() {
        let (mut positions, mut triangles) = prism(4);
        for k in 0..3 {
            let first = positions.len() as u32;
            let at = DVec3::splat(10.0 + f64::from(k));
            positions.extend([at, at + DVec3::X, at + DVec3::Y]);
            triangles.push([first, first + 1, first + 2]);
        }
        let pieces = find_leaves(&positions, &triangles);
        let found = sum_up(&positions, &triangles, &pieces);
        // One tube of 8 triangles and three single triangles.
        assert_eq!(
            found,
            Pieces {
                count: 4,
                leaf_like: 3,
                leaf_like_share: 3.0 / 11.0,
                alike_share: 1.0,
                ..Pieces::default()
            }
        );
    }

    #[test]
    fn many_leaves_beside_stems_are_leaves_and_wood() {
        let with = |sides: u32, leaves: u32| {
            let (mut positions, mut triangles) = prism(sides);
            for k in 0..leaves {
                let first = positions.len() as u32;
                let at = DVec3::splat(10.0 + f64::from(k));
                positions.extend([at, at + DVec3::X, at + DVec3::Y]);
                triangles.push([first, first + 1, first + 2]);
            }
            let pieces = find_leaves(&positions, &triangles);
            sum_up(&positions, &triangles, &pieces)
        };
        let mixed = with(40, 20);
        assert_eq!((mixed.leaf_like, mixed.stem_like), (20, 1));
        assert_eq!(mixed.stem_like_share, 0.8);
        assert!(mixed.are_leaves_and_wood(1));
        // Too few leaves, but for a shrub that is drawn often; next to no leaves; and stalks of leaves.
        assert!(!with(40, 10).are_leaves_and_wood(1));
        assert!(with(40, 10).are_leaves_and_wood(2));
        assert!(!with(400, 20).are_leaves_and_wood(1));
        assert!(!with(40, 2000).are_leaves_and_wood(1));
        assert!(!with(8, 20).are_leaves_and_wood(1));
    }
}
