//! Triangle strips, made from the coarse to the fine.
//!
//! As in GeoTool (Ripolles et al., section 2.1): triangles come in the order in which refinement makes
//! them. One that shares the open edge of a strip goes to its end; any other begins a strip. So strips
//! of a coarse level are beginnings of those of a fine one. Orientations stay.

use std::collections::HashMap;

/// An edge in the direction in which the triangle that goes on from it has it.
type Edge = [u32; 2];

/// The strips of triangles, in the order of their first triangles: vertices, of which each three in a row
/// are a triangle, every second one turned around. Triangles that name a vertex twice are left out.
pub fn strips(triangles: &[[u32; 3]]) -> Vec<Vec<u32>> {
    let mut strips: Vec<Vec<u32>> = Vec::new();
    let mut open: HashMap<Edge, usize> = HashMap::new();
    for &[a, b, c] in triangles {
        if a == b || b == c || c == a {
            continue;
        }
        let edges = [([a, b], c), ([b, c], a), ([c, a], b)];
        let found = edges
            .iter()
            .find_map(|(edge, tip)| Some((*edge, *tip, *open.get(edge)?)));
        let number = match found {
            Some((edge, tip, number)) => {
                close(&mut open, &strips[number], number);
                turn_to(edge, &mut strips[number]);
                strips[number].push(tip);
                number
            }
            None => {
                strips.push(vec![a, b, c]);
                strips.len() - 1
            }
        };
        for edge in open_edges(&strips[number]) {
            open.entry(edge).or_insert(number);
        }
    }
    strips
}

/// One strip of several: between two of them vertices are named again, which makes triangles without area. After an
/// odd number of vertices it is one more, so that the next strip is not turned around.
pub fn joined_strips(strips: &[Vec<u32>]) -> Vec<u32> {
    let mut joined: Vec<u32> = Vec::new();
    for strip in strips {
        if let (Some(&last), Some(&first)) = (joined.last(), strip.first()) {
            joined.extend([last, first]);
            if joined.len() % 2 == 1 {
                joined.push(first);
            }
        }
        joined.extend(strip);
    }
    joined
}

/// Where a strip may go on: at its end, and a single triangle at each of its edges.
fn open_edges(strip: &[u32]) -> Vec<Edge> {
    match *strip {
        [a, b, c] => vec![[b, a], [c, b], [a, c]],
        [.., a, b] if strip.len().is_multiple_of(2) => vec![[a, b]],
        [.., a, b] => vec![[b, a]],
        [] | [_] => Vec::new(),
    }
}

fn close(open: &mut HashMap<Edge, usize>, strip: &[u32], number: usize) {
    for edge in open_edges(strip) {
        if open.get(&edge) == Some(&number) {
            open.remove(&edge);
        }
    }
}

/// Turns a single triangle so that it ends with this edge.
fn turn_to([from, to]: Edge, strip: &mut [u32]) {
    if strip.len() == 3 {
        while [strip[2], strip[1]] != [from, to] {
            strip.rotate_left(1);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The triangles that a client draws of one strip, without those that name a vertex twice, each from its least vertex
    /// on.
    fn drawn(strip: &[u32]) -> Vec<[u32; 3]> {
        let turned = |(k, corners): (usize, &[u32])| match k % 2 {
            0 => [corners[0], corners[1], corners[2]],
            _ => [corners[1], corners[0], corners[2]],
        };
        let all = strip.windows(3).enumerate().map(turned);
        let mut proper: Vec<[u32; 3]> =
            all.filter(|[a, b, c]| a != b && b != c && c != a).collect();
        proper.iter_mut().for_each(from_least);
        proper.sort_unstable();
        proper
    }

    fn from_least(triangle: &mut [u32; 3]) {
        while triangle[0] != *triangle.iter().min().expect("three") {
            triangle.rotate_left(1);
        }
    }

    #[track_caller]
    fn assert_same(triangles: &[[u32; 3]]) {
        let mut expected = triangles.to_vec();
        expected.iter_mut().for_each(from_least);
        expected.sort_unstable();
        assert_eq!(drawn(&joined_strips(&strips(triangles))), expected);
    }

    /// A fan of quads: two triangles along their diagonal are four indices, and two quads joined are ten.
    #[test]
    fn quads_apart_are_joined_by_two_indices() {
        let quads = [[0, 1, 2], [0, 2, 3], [4, 5, 6], [4, 6, 7]];
        let apart = strips(&quads);
        assert_eq!(apart, [[1, 2, 0, 3], [5, 6, 4, 7]]);
        assert_eq!(joined_strips(&apart), [1, 2, 0, 3, 3, 5, 5, 6, 4, 7]);
        assert_same(&quads);
    }

    /// Two quads in a row are one strip of six; triangles apart need a third index between them.
    #[test]
    fn what_shares_no_edge_begins_a_strip() {
        let row = [[0, 1, 2], [2, 1, 3], [2, 3, 4], [4, 3, 5]];
        assert_eq!(strips(&row), [[0, 1, 2, 3, 4, 5]]);
        assert_same(&row);
        let apart = [[0, 1, 2], [3, 4, 5]];
        assert_eq!(joined_strips(&strips(&apart)), [0, 1, 2, 2, 3, 3, 3, 4, 5]);
        assert_same(&apart);
        // Of the other side: it has the edge in the same direction, so no strip goes on with it.
        assert_eq!(strips(&[[0, 1, 2], [0, 1, 3]]).len(), 2);
        assert_same(&[[0, 1, 2], [0, 1, 3], [1, 0, 4]]);
        assert!(strips(&[[0, 0, 1]]).is_empty());
    }

    /// Triangles of a grid in a shuffled order, so that strips end and begin everywhere.
    #[test]
    fn every_triangle_is_drawn_once_as_it_was() {
        let at = |x: u32, y: u32| 9 * y + x;
        let quad = |k: u32| {
            let (x, y) = (k % 8, k / 8);
            let [a, b, c, d] = [at(x, y), at(x + 1, y), at(x + 1, y + 1), at(x, y + 1)];
            [[a, b, c], [a, c, d]]
        };
        let grid: Vec<[u32; 3]> = (0..64).flat_map(quad).collect();
        for step in [1, 3, 37, 101] {
            let shuffled: Vec<[u32; 3]> = (0..128).map(|k| grid[k * step % 128]).collect();
            assert_same(&shuffled);
            // A coarse level is a beginning of the fine one.
            let [coarse, fine] = [&shuffled[..40], &shuffled].map(strips);
            let begins = |(a, b): (&Vec<u32>, &Vec<u32>)| a.len() == 3 || b.starts_with(a);
            assert!(coarse.iter().zip(&fine).all(begins), "{step}");
        }
    }
}
