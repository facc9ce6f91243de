//! Unit vectors of three bytes as the two that meshopt's octahedral filter makes them of.

use crate::meshopt::octahedral_of_bytes;

/// The nearest vector that the filter can make, each component times 127. Zero has none.
pub(super) fn nearest(vector: [f64; 3]) -> Option<[i8; 3]> {
    code(vector).map(octahedral_of_bytes)
}

/// What the filter makes these vectors of, four bytes each, of which it keeps the last.
/// `None` where it cannot make one.
pub(super) fn codes(bytes: &[u8]) -> Option<Vec<u8>> {
    let mut coded = Vec::with_capacity(bytes.len());
    let mut last: Option<([i8; 3], [i8; 2])> = None;
    for &[x, y, z, kept] in bytes.as_chunks::<4>().0 {
        let vector = [x, y, z].map(|byte| byte as i8);
        let [a, b] = match last {
            Some((same, code)) if same == vector => code,
            _ => code_of(vector)?,
        };
        last = Some((vector, [a, b]));
        coded.extend([a as u8, b as u8, ONE as u8, kept]);
    }
    Some(coded)
}

/// 1 in the precision of a code.
const ONE: i8 = 127;

/// The code of which the filter makes this very vector.
fn code_of(vector: [i8; 3]) -> Option<[i8; 2]> {
    let [a, b] = code(vector.map(f64::from))?;
    let around = |n: i8| [0, -1, 1, -2, 2].map(|step| n.saturating_add(step).max(-ONE));
    let mut all = around(a)
        .into_iter()
        .flat_map(|a| around(b).map(|b| [a, b]));
    all.find(|&code| octahedral_of_bytes(code) == vector)
}

fn code([x, y, z]: [f64; 3]) -> Option<[i8; 2]> {
    let length = x.abs() + y.abs() + z.abs();
    if length <= 0.0 {
        return None;
    }
    let (x, y) = (x / length, y / length);
    let [x, y] = match z < 0.0 {
        true => [(1.0 - y.abs()).copysign(x), (1.0 - x.abs()).copysign(y)],
        false => [x, y],
    };
    Some([x, y].map(|part| (part * f64::from(ONE)).round() as i8))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn vectors_of_the_filter_have_their_codes() {
        let mut vectors = Vec::new();
        for a in 0..40 {
            for b in 0..20 {
                let (a, b) = (f64::from(a) * 0.16, f64::from(b) * 0.16);
                let unit = [a.cos() * b.sin(), a.sin() * b.sin(), b.cos()];
                let near = nearest(unit).unwrap();
                for (near, exact) in near.iter().zip(unit) {
                    assert!((f64::from(*near) / 127.0 - exact).abs() < 0.02);
                }
                vectors.extend([near[0] as u8, near[1] as u8, near[2] as u8, 7]);
            }
        }
        let coded = codes(&vectors).unwrap();
        assert_eq!(coded.len(), vectors.len());
        assert!(coded.as_chunks::<4>().0.iter().all(|c| c[2..] == [127, 7]));
        assert_eq!(codes(&[0, 0, 0, 0]), None);
    }
}
