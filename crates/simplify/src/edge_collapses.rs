//! meshoptimizer's simplifiers, as the crate `meshoptimizer-rs` has them in plain Rust.
//!
//! The simplifier counts in f32, rounding after each operation, and gives the index lists of the C++ original on
//! every processor (`tests/meshoptimizer.rs` compares them).

use meshoptimizer_rs::{
    Attributes, Error, Limits, Positions, SimplifiedMesh, SimplifyOptions, SimplifySettings,
    VertexFlags, Workspace, simplify, simplify_sloppy, simplify_with_attributes,
};

/// Triangles as numbers of vertices, three each, and where vertices are.
#[derive(Clone, Copy)]
pub(crate) struct IndexedTriangles<'a> {
    pub(crate) positions: &'a [[f32; 3]],
    pub(crate) indices: &'a [u32],
}

/// What vertices have beside their positions, and how much each of it counts.
#[derive(Clone, Copy)]
pub(crate) struct VertexAttributes<'a, const COUNT: usize> {
    pub(crate) values: &'a [[f32; COUNT]],
    pub(crate) weights: &'a [f32; COUNT],
    /// By vertex, whether it stays.
    pub(crate) is_locked: &'a [bool],
}

impl IndexedTriangles<'_> {
    /// As many indices as the target or fewer, or as near as collapses come, without an error limit.
    pub(crate) fn collapsed(self, target: usize, options: SimplifyOptions) -> Vec<u32> {
        let settings = settings(target, options);
        let positions = Positions::from_packed(self.positions);
        self.kept(|space| simplify(self.indices, positions, settings, space))
    }

    /// As [`Self::collapsed`], but attributes count too.
    pub(crate) fn collapsed_with<const COUNT: usize>(
        self,
        attributes: VertexAttributes<'_, COUNT>,
        target: usize,
        options: SimplifyOptions,
    ) -> Vec<u32> {
        let flag = |is_locked: &bool| match is_locked {
            true => VertexFlags::LOCK,
            false => VertexFlags::EMPTY,
        };
        let flags: Vec<VertexFlags> = attributes.is_locked.iter().map(flag).collect();
        let values = attributes.values.as_flattened();
        let values = Attributes::from_interleaved(values, flags.len(), COUNT, COUNT, 0)
            .expect("as many attributes as vertices");
        let positions = Positions::from_packed(self.positions);
        self.kept(|space| {
            simplify_with_attributes(
                self.indices,
                positions,
                values,
                attributes.weights,
                Some(&flags),
                settings(target, options),
                space,
            )
        })
    }

    /// As [`Self::collapsed`], where vertices that share a cell of a grid become one.
    pub(crate) fn joined_in_cells(self, target: usize) -> Vec<u32> {
        let positions = Positions::from_packed(self.positions);
        self.kept(|space| simplify_sloppy(self.indices, positions, None, target, f32::MAX, space))
    }

    /// What it cannot count with stays as it is: a mesh whose areas leave the range of f32.
    fn kept(self, run: impl FnOnce(&mut Workspace) -> Result<SimplifiedMesh, Error>) -> Vec<u32> {
        let mut space = Workspace::new(Limits {
            max_bytes: usize::MAX,
            max_work: u64::MAX,
        });
        match run(&mut space) {
            Ok(SimplifiedMesh { indices, .. }) => indices,
            Err(error) => {
                tracing::debug!(%error, "a mesh is not simplified");
                self.indices.to_vec()
            }
        }
    }
}

fn settings(target_index_count: usize, options: SimplifyOptions) -> SimplifySettings {
    SimplifySettings {
        target_index_count,
        target_error: f32::MAX,
        options,
    }
}
