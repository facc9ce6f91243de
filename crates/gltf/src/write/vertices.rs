//! Which vertices a primitive still needs, and which of them move.

use glam::DVec3;
use rustc_hash::FxHashMap;

/// A leaf that changes size, in the primitive's local space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Resize {
    /// What its vertices are scaled about.
    pub(super) centre_local: DVec3,
    /// The linear factor, the square root of the area's.
    pub(super) linear_scale: f64,
}

/// A triangle that stays: the numbers of its corners among the old vertices,
/// and which of the primitive's resizes moves each, if one does.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct KeptTriangle {
    pub(super) corners: [u32; 3],
    pub(super) resizes: [Option<u32>; 3],
}

/// The vertices of a rewritten primitive.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Vertices {
    /// For each new vertex the old one that it is a copy of.
    pub(super) sources: Vec<u32>,
    /// New vertices that move, with the number of their resize.
    pub(super) moved: Vec<(u32, u32)>,
    /// Corners as new vertices; `None` where the primitive has no indices.
    pub(super) triangles: Option<Vec<[u32; 3]>>,
}

impl Vertices {
    /// Its vertices, each before those that later corners use first: indices in that order
    /// take the fewest bytes when they are compressed.
    pub(super) fn in_order_of_use(mut self) -> Self {
        const UNUSED: u32 = u32::MAX;
        let Some(triangles) = &mut self.triangles else {
            return self;
        };
        let mut new_number = vec![UNUSED; self.sources.len()];
        let mut sources = Vec::with_capacity(self.sources.len());
        for corner in triangles.as_flattened_mut() {
            let number = &mut new_number[*corner as usize];
            if *number == UNUSED {
                *number = sources.len() as u32;
                sources.push(self.sources[*corner as usize]);
            }
            *corner = *number;
        }
        self.sources = sources;
        for (vertex, _) in &mut self.moved {
            *vertex = new_number[*vertex as usize];
        }
        self.moved.sort_unstable();
        self
    }
}

/// The vertices of a primitive without indices: every corner its own, in order.
pub(super) fn corner_vertices(kept: &[KeptTriangle]) -> Vertices {
    let mut vertices = Vertices::default();
    vertices.sources.reserve(3 * kept.len());
    for triangle in kept {
        for (corner, resize) in triangle.corners.into_iter().zip(triangle.resizes) {
            if let Some(resize) = resize {
                let number = vertices.sources.len() as u32;
                vertices.moved.push((number, resize));
            }
            vertices.sources.push(corner);
        }
    }
    vertices
}

/// The vertices of an indexed primitive of `vertex_count` old vertices, in
/// their old order. An old vertex that is used at several sizes is split: the
/// copies come last.
pub(super) fn shared_vertices(vertex_count: usize, kept: &[KeptTriangle]) -> Vertices {
    // Many primitives may share a long list of vertices, each using a few.
    const FEW: usize = 16;
    if kept.len() > vertex_count / FEW {
        return vertices_in_list(vertex_count, kept);
    }
    let mut used: Vec<u32> = kept.iter().flat_map(|triangle| triangle.corners).collect();
    used.sort_unstable();
    used.dedup();
    let place = |corner: u32| used.partition_point(|&vertex| vertex < corner) as u32;
    let compact: Vec<KeptTriangle> = kept
        .iter()
        .map(|triangle| KeptTriangle {
            corners: triangle.corners.map(place),
            ..*triangle
        })
        .collect();
    let mut vertices = vertices_in_list(used.len(), &compact);
    for source in &mut vertices.sources {
        *source = used[*source as usize];
    }
    vertices
}

fn vertices_in_list(vertex_count: usize, kept: &[KeptTriangle]) -> Vertices {
    const UNUSED: u32 = u32::MAX;
    const AS_IT_WAS: u32 = u32::MAX - 1;
    let sizes_of = |triangle: &KeptTriangle| triangle.resizes.map(|r| r.unwrap_or(AS_IT_WAS));

    let mut first_size = vec![UNUSED; vertex_count];
    let mut copies: Vec<(u32, u32)> = Vec::new();
    let mut copy_of: FxHashMap<(u32, u32), usize> = FxHashMap::default();
    for triangle in kept {
        for (corner, size) in triangle.corners.into_iter().zip(sizes_of(triangle)) {
            let first = &mut first_size[corner as usize];
            if *first == UNUSED {
                *first = size;
            } else if *first != size {
                copy_of.entry((corner, size)).or_insert_with(|| {
                    copies.push((corner, size));
                    copies.len() - 1
                });
            }
        }
    }

    let mut vertices = Vertices::default();
    let mut new_number = vec![UNUSED; vertex_count];
    let mut push = |source: u32, size: u32| {
        let number = vertices.sources.len() as u32;
        vertices.sources.push(source);
        if size != AS_IT_WAS {
            vertices.moved.push((number, size));
        }
        number
    };
    for (old, &size) in first_size.iter().enumerate() {
        if size != UNUSED {
            new_number[old] = push(old as u32, size);
        }
    }
    let copy_number: Vec<u32> = copies
        .iter()
        .map(|&(source, size)| push(source, size))
        .collect();

    let renumber = |triangle: &KeptTriangle| {
        let sizes = sizes_of(triangle);
        [0, 1, 2].map(|k| {
            let (corner, size) = (triangle.corners[k], sizes[k]);
            if first_size[corner as usize] == size {
                new_number[corner as usize]
            } else {
                copy_number[copy_of[&(corner, size)]]
            }
        })
    };
    vertices.triangles = Some(kept.iter().map(renumber).collect());
    vertices
}

#[cfg(test)]
mod tests {
    use super::*;

    fn kept(corners: [u32; 3], resize: Option<u32>) -> KeptTriangle {
        KeptTriangle {
            corners,
            resizes: [resize; 3],
        }
    }

    #[test]
    fn vertices_of_removed_triangles_go() {
        // Of seven vertices 0, 3 and 6 are not used.
        let vertices = shared_vertices(7, &[kept([4, 1, 2], None), kept([2, 5, 4], None)]);
        assert_eq!(vertices.sources, [1, 2, 4, 5]);
        assert_eq!(vertices.triangles, Some(vec![[2, 0, 1], [1, 3, 2]]));
        assert_eq!(vertices.moved, []);
    }

    #[test]
    fn a_vertex_between_two_sizes_is_split() {
        // Vertex 2 belongs to a leaf as it was, to a resized one and to another
        // resized one: three copies, the first in its old place.
        let vertices = shared_vertices(
            7,
            &[
                kept([0, 1, 2], None),
                kept([2, 3, 4], Some(0)),
                kept([5, 6, 2], Some(1)),
                kept([4, 3, 2], Some(0)),
            ],
        );
        assert_eq!(vertices.sources, [0, 1, 2, 3, 4, 5, 6, 2, 2]);
        assert_eq!(
            vertices.triangles,
            Some(vec![[0, 1, 2], [7, 3, 4], [5, 6, 8], [4, 3, 7]])
        );
        assert_eq!(
            vertices.moved,
            [(3, 0), (4, 0), (5, 1), (6, 1), (7, 0), (8, 1)]
        );
    }

    #[test]
    fn in_order_of_use_vertices_are_the_same_ones() {
        let kept = [kept([4, 1, 2], None), kept([2, 5, 4], Some(0))];
        let vertices = shared_vertices(7, &kept).in_order_of_use();
        assert_eq!(vertices.sources, [4, 1, 2, 2, 5, 4]);
        assert_eq!(vertices.triangles, Some(vec![[0, 1, 2], [3, 4, 5]]));
        assert_eq!(vertices.moved, [(3, 0), (4, 0), (5, 0)]);
    }

    #[test]
    fn few_triangles_of_many_vertices_are_no_other_case() {
        let kept = [kept([900, 10, 20], None), kept([20, 500, 900], Some(0))];
        let few = shared_vertices(1000, &kept);
        assert_eq!(few, vertices_in_list(1000, &kept));
        assert_eq!(few.sources, [10, 20, 500, 900, 20, 900]);
    }

    #[test]
    fn without_indices_corners_stay_apart() {
        let vertices = corner_vertices(&[kept([3, 4, 5], Some(0)), kept([4, 5, 6], None)]);
        assert_eq!(vertices.sources, [3, 4, 5, 4, 5, 6]);
        assert_eq!(vertices.moved, [(0, 0), (1, 0), (2, 0)]);
        assert_eq!(vertices.triangles, None);
    }
}
