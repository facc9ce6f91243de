//! The point of a triangle that is nearest to a point.

use glam::DVec3;

/// A point of a triangle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Nearest {
    /// The nearest place on the triangle, in world space.
    pub point: DVec3,
    /// How much of each corner it is; they add up to 1.
    pub weights: [f64; 3],
}

/// By the region of the triangle's plane in which the point lies (Ericson, Real-Time Collision
/// Detection, 5.1.5).
pub fn nearest([a, b, c]: [DVec3; 3], p: DVec3) -> Nearest {
    let of = |v: f64, w: f64| Nearest {
        point: a + (b - a) * v + (c - a) * w,
        weights: [1.0 - v - w, v, w],
    };
    let at = |k: usize| Nearest {
        point: [a, b, c][k],
        weights: [0, 1, 2].map(|other| f64::from(u8::from(other == k))),
    };
    let (ab, ac, ap) = (b - a, c - a, p - a);
    let (d1, d2) = (ab.dot(ap), ac.dot(ap));
    if d1 <= 0.0 && d2 <= 0.0 {
        return at(0);
    }
    let bp = p - b;
    let (d3, d4) = (ab.dot(bp), ac.dot(bp));
    if d3 >= 0.0 && d4 <= d3 {
        return at(1);
    }
    let vc = d1 * d4 - d3 * d2;
    if vc <= 0.0 && d1 >= 0.0 && d3 <= 0.0 {
        return of(d1 / (d1 - d3), 0.0);
    }
    let cp = p - c;
    let (d5, d6) = (ab.dot(cp), ac.dot(cp));
    if d6 >= 0.0 && d5 <= d6 {
        return at(2);
    }
    let vb = d5 * d2 - d1 * d6;
    if vb <= 0.0 && d2 >= 0.0 && d6 <= 0.0 {
        return of(0.0, d2 / (d2 - d6));
    }
    let va = d3 * d6 - d5 * d4;
    if va <= 0.0 && d4 - d3 >= 0.0 && d5 - d6 >= 0.0 {
        let along = (d4 - d3) / ((d4 - d3) + (d5 - d6));
        return Nearest {
            point: b + (c - b) * along,
            weights: [0.0, 1.0 - along, along],
        };
    }
    let inverse = 1.0 / (va + vb + vc);
    match inverse.is_finite() {
        true => of(vb * inverse, vc * inverse),
        false => at(0),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_nearest_point_of_a_triangle_is_in_it() {
        let triangle = [DVec3::ZERO, DVec3::X, DVec3::Y];
        let at = |x, y, z| {
            let found = nearest(triangle, DVec3::new(x, y, z));
            let of_weights = triangle.iter().zip(found.weights);
            let sum: DVec3 = of_weights.map(|(corner, w)| *corner * w).sum();
            assert!((sum - found.point).length() < 1e-12);
            found.point
        };
        assert_eq!(at(0.25, 0.25, 3.0), DVec3::new(0.25, 0.25, 0.0));
        assert_eq!(at(-1.0, -1.0, 0.0), DVec3::ZERO);
        assert_eq!(at(2.0, 0.0, 0.0), DVec3::X);
        assert_eq!(at(0.5, -1.0, 0.0), DVec3::new(0.5, 0.0, 0.0));
        assert_eq!(at(1.0, 1.0, 0.0), DVec3::new(0.5, 0.5, 0.0));
        assert_eq!(nearest([DVec3::ONE; 3], DVec3::ZERO).point, DVec3::ONE);
    }
}
