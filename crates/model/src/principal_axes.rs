//! The axes along which things spread.

use glam::{DMat3, DVec3};

/// Sweeps over the off-diagonal entries: each about squares what is left of them.
const SWEEPS: usize = 12;

/// What a vector adds to a matrix of second moments.
pub fn moment(v: DVec3) -> DMat3 {
    DMat3::from_cols(v * v.x, v * v.y, v * v.z)
}

/// The eigenvectors of a symmetric matrix, unit, that of the smallest eigenvalue first (Jacobi's rotations).
pub fn principal_axes(symmetric: DMat3) -> [DVec3; 3] {
    let (mut left, mut axes) = (symmetric, DMat3::IDENTITY);
    for _ in 0..SWEEPS {
        for (p, q) in [(0, 1), (0, 2), (1, 2)] {
            let off = left.col(q)[p];
            if off == 0.0 {
                continue;
            }
            // The smaller of the two angles that make the entry vanish.
            let theta = (left.col(q)[q] - left.col(p)[p]) / (2.0 * off);
            let tangent = theta.signum() / (theta.abs() + (theta * theta + 1.0).sqrt());
            let cosine = 1.0 / (tangent * tangent + 1.0).sqrt();
            let sine = tangent * cosine;
            let mut turn = DMat3::IDENTITY;
            (turn.col_mut(p)[p], turn.col_mut(q)[q]) = (cosine, cosine);
            (turn.col_mut(p)[q], turn.col_mut(q)[p]) = (-sine, sine);
            left = turn.transpose() * left * turn;
            axes *= turn;
        }
    }
    let mut order = [0, 1, 2];
    order.sort_by(|&j, &k| left.col(j)[j].total_cmp(&left.col(k)[k]));
    order.map(|k| axes.col(k))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn axes_come_from_the_least_spread_to_the_most() {
        let own = [
            DVec3::new(1.0, 2.0, 2.0) / 3.0,
            DVec3::new(2.0, 1.0, -2.0) / 3.0,
            DVec3::new(2.0, -2.0, 1.0) / 3.0,
        ];
        let spread = moment(own[0]) * 5.0 + moment(own[1]) * 0.5 + moment(own[2]) * 2.0;
        let found = principal_axes(spread);
        for (found, wanted) in found.iter().zip([own[1], own[2], own[0]]) {
            assert!((found.dot(wanted).abs() - 1.0).abs() < 1e-12, "{found}");
        }
        // What is the same in all directions, or nowhere, still has three axes.
        for alike in [DMat3::IDENTITY, DMat3::ZERO] {
            let [a, b, c] = principal_axes(alike);
            assert!((a.cross(b).dot(c).abs() - 1.0).abs() < 1e-12);
        }
    }
}
