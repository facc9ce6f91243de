//! meshoptimizer's example of cluster LODs (`demo/clusterlod.h`), as the crate has it in plain Rust.
//!
//! Triangles are put into clusters and clusters into groups; each group is halved and put into clusters
//! again, until nothing can be halved. A level is a cut through all clusters at one error e: a cluster
//! is part of it if the group that it was made of is off by no more than e, and its own group, once
//! halved, is off by more.
//!
//! A step halves nearly: it leaves such a share that a whole number of steps leaves what is asked for, as small crowns
//! are one group. All other settings are the example's own, but collapses across seams of the texture are forbidden, as
//! by the other simplifiers here.

use meshoptimizer_rs::clusterlod::{
    Config, DagBuffers, DagCounts, FlatDagCluster, FlatDagGroup, Mesh as ClusteredMesh, Node,
    build_dag_into, default_config,
};
use meshoptimizer_rs::{Error, Limits, Workspace};

use super::Mesh;
use crate::edge_collapses::IndexedTriangles;

/// Triangles of a cluster, at most, as in the example.
const CLUSTER_TRIANGLES: usize = 128;

/// All halvings together have less than this times the indices of the mesh: what a halving leaves above
/// 0.85 is not taken, and 1 / (1 - 0.85) < 7.
const ALL_HALVINGS: usize = 7;

/// A share that a step leaves, at most: less than the 0.85 above.
const MOST_OF_A_STEP: f64 = 0.8;

/// Of the trees of bounds, which nothing here asks for.
const NODE_WIDTH: usize = 8;

/// A level, and where all vertices of the mesh are in it.
pub(super) struct Cut {
    pub(super) indices: Vec<u32>,
    positions: Vec<[f32; 3]>,
}

/// The vertices of as many triangles as the goal or fewer, three each, as near below it as one error
/// comes. Vertices of borders move.
pub(super) fn dilated(mesh: &mut Mesh, goal: usize) -> Vec<u32> {
    let triangles = IndexedTriangles {
        positions: &mesh.positions,
        indices: &mesh.indices,
    };
    let cut = cut(triangles, goal, true);
    for (k, position) in cut.positions.into_iter().enumerate() {
        mesh.is_moved[k] |= position != mesh.positions[k];
        mesh.positions[k] = position;
    }
    cut.indices
}

/// The level of as many indices as the goal or fewer; a mesh that cannot be counted with stays as it is.
pub(super) fn cut(triangles: IndexedTriangles<'_>, goal: usize, dilates: bool) -> Cut {
    let share = goal as f64 / triangles.indices.len().max(1) as f64;
    match Clusters::of(triangles, share_of_a_step(share), dilates) {
        Ok(clusters) => clusters.cut(triangles.positions, goal),
        Err(error) => {
            tracing::debug!(%error, "a mesh is not put into clusters");
            Cut {
                indices: triangles.indices.to_vec(),
                positions: triangles.positions.to_vec(),
            }
        }
    }
}

/// What a step leaves, as near to a half as it can be if a whole number of steps is to leave this share.
fn share_of_a_step(share: f64) -> f32 {
    let steps = (-share.log2()).round().max(1.0);
    let of_a_step = share.powf(1.0 / steps);
    match of_a_step <= MOST_OF_A_STEP {
        true => of_a_step as f32,
        false => 0.5,
    }
}

/// The clusters of all halvings.
struct Clusters {
    /// By the numbers in `indices`: the vertex of the mesh, and where it was when its cluster was made.
    sources: Vec<u32>,
    places: Vec<[f32; 3]>,
    indices: Vec<u32>,
    clusters: Vec<FlatDagCluster>,
    groups: Vec<FlatDagGroup>,
}

impl Clusters {
    fn of(triangles: IndexedTriangles<'_>, of_a_step: f32, dilates: bool) -> Result<Self, Error> {
        let config = Config {
            simplify_ratio: of_a_step,
            simplify_permissive: false,
            simplify_dilate_borders: dilates,
            ..default_config(CLUSTER_TRIANGLES)?
        };
        let most = ALL_HALVINGS * triangles.indices.len();
        let mut all = Self {
            sources: vec![0; most],
            places: vec![[0.0; 3]; most],
            indices: vec![0; most],
            clusters: vec![FlatDagCluster::default(); most / 3],
            groups: vec![FlatDagGroup::default(); most / 3],
        };
        let counts = all.fill(config, triangles)?;
        all.sources.truncate(counts.vertices);
        all.places.truncate(counts.vertices);
        all.indices.truncate(counts.indices);
        all.clusters.truncate(counts.clusters);
        all.groups.truncate(counts.groups);
        Ok(all)
    }

    fn fill(
        &mut self,
        config: Config,
        triangles: IndexedTriangles<'_>,
    ) -> Result<DagCounts, Error> {
        let mut nodes = vec![Node::default(); 2 * self.groups.len() + NODE_WIDTH];
        let mut positions = triangles.positions.to_vec();
        let mesh = ClusteredMesh {
            indices: triangles.indices,
            positions: &mut positions,
            attributes: None,
            vertex_lock: None,
            attribute_weights: &[],
            attribute_protect_mask: 0,
        };
        let buffers = DagBuffers {
            vertex_source: &mut self.sources,
            vertex_positions: &mut self.places,
            indices: &mut self.indices,
            clusters: &mut self.clusters,
            groups: &mut self.groups,
            nodes: &mut nodes,
        };
        let mut space = Workspace::new(Limits {
            max_bytes: usize::MAX,
            max_work: u64::MAX,
        });
        build_dag_into(config, mesh, NODE_WIDTH, buffers, &mut space)
    }

    /// The level at this error; below 0 it is the mesh itself.
    fn at(&self, error: f32) -> impl Iterator<Item = &FlatDagCluster> {
        let of = |group: usize| self.groups[group].error;
        self.clusters.iter().filter(move |cluster| {
            let made_of = usize::try_from(cluster.refined);
            made_of.map_or(true, |group| of(group) <= error) && of(cluster.group as usize) > error
        })
    }

    /// The level of the least error that has as many indices as the goal or fewer; if none has, that of the largest.
    fn cut(&self, positions: &[[f32; 3]], goal: usize) -> Cut {
        let halved = self.groups.iter().map(|group| group.error);
        let mut errors: Vec<f32> = halved.filter(|error| *error < f32::MAX).collect();
        errors.push(-1.0);
        errors.sort_by(f32::total_cmp);
        let count = |error| -> usize { self.at(error).map(|c| c.index_count as usize).sum() };
        let first = errors.partition_point(|error| count(*error) > goal);
        let error = errors[first.min(errors.len() - 1)];
        let mut cut = Cut {
            indices: Vec::new(),
            positions: positions.to_vec(),
        };
        for cluster in self.at(error) {
            let range = cluster.first_index as usize..;
            for &vertex in &self.indices[range][..cluster.index_count as usize] {
                let source = self.sources[vertex as usize];
                cut.positions[source as usize] = self.places[vertex as usize];
                cut.indices.push(source);
            }
        }
        cut
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Unit squares in a row, three apart, two triangles each: more than a cluster has.
    fn squares(count: usize) -> (Vec<[f32; 3]>, Vec<u32>) {
        let corners = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
        let square = |k: usize| corners.map(|[x, y]| [x + 3.0 * k as f32, y, 0.0]);
        let triangles = |k: usize| [0, 1, 2, 0, 2, 3].map(|vertex| 4 * k as u32 + vertex);
        let positions = (0..count).flat_map(square).collect();
        (positions, (0..count).flat_map(triangles).collect())
    }

    fn cut_of(count: usize, goal: usize, dilates: bool) -> Cut {
        let (positions, indices) = squares(count);
        let triangles = IndexedTriangles {
            positions: &positions,
            indices: &indices,
        };
        cut(triangles, goal, dilates)
    }

    fn area(cut: &Cut) -> f32 {
        let area = |t: &[u32; 3]| {
            let [a, b, c] = t.map(|vertex| glam::Vec3::from(cut.positions[vertex as usize]));
            0.5 * (b - a).cross(c - a).length()
        };
        cut.indices.as_chunks().0.iter().map(area).sum()
    }

    /// 800 triangles cut to at most 400, 200 and 80 of them: without dilation nothing moves and area is lost; with it some
    /// of that comes back. A step is one of whole clusters, so that of few triangles far fewer may be left: 25 for 400.
    #[test]
    fn the_crate_gives_area_back() {
        for goal in [1200, 600, 240] {
            let [plain, dilated] = [false, true].map(|dilates| cut_of(400, goal, dilates));
            assert_eq!(plain.positions, squares(400).0);
            for cut in [&plain, &dilated] {
                let count = cut.indices.len();
                assert!(0 < count && count <= goal, "{count} of {goal}");
            }
            assert!(area(&dilated) > area(&plain), "{goal}");
        }
    }

    /// Every triangle is in it once, in whatever order.
    #[test]
    fn the_level_of_all_triangles_is_the_mesh() {
        let (positions, indices) = squares(400);
        let cut = cut_of(400, indices.len(), true);
        assert_eq!(cut.positions, positions);
        let sorted = |indices: &[u32]| {
            let mut triangles = indices.as_chunks::<3>().0.to_vec();
            triangles.iter_mut().for_each(|t| t.sort_unstable());
            triangles.sort_unstable();
            triangles
        };
        assert_eq!(sorted(&cut.indices), sorted(&indices));
    }

    /// Three steps of 0.464 leave a tenth, one of 0.8 itself; where a step would leave too much it is a half.
    #[test]
    fn steps_leave_the_share() {
        let near = |share: f64, expected: f32| (share_of_a_step(share) - expected).abs() < 1e-3;
        for (share, expected) in [
            (0.1, 0.464),
            (0.25, 0.5),
            (0.8, 0.8),
            (0.9, 0.5),
            (0.0, 0.5),
        ] {
            assert!(near(share, expected), "{share}");
        }
    }

    /// What fits into one cluster is not halved, as in the example.
    #[test]
    fn one_cluster_stays_whole() {
        assert_eq!(cut_of(16, 12, true).indices.len(), 96);
        assert!(cut_of(0, 0, true).indices.is_empty());
    }
}
