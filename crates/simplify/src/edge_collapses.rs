//! meshoptimizer's simplifiers, as the crate `meshoptimizer-rs` has them in plain Rust.
//!
//! The simplifier counts in f32, rounding after each operation, and gives the index lists of the C++ original on
//! every processor (`tests/meshoptimizer.rs` compares them).

use meshoptimizer_rs::{
    Attributes, AttributesMut, Error, Limits, Positions, PositionsMut, SimplifyOptions,
    SimplifySettings, VertexFlags, Workspace, simplify, simplify_sloppy, simplify_with_attributes,
    simplify_with_update,
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

impl<const COUNT: usize> VertexAttributes<'_, COUNT> {
    fn flags(&self) -> Vec<VertexFlags> {
        let flag = |is_locked: &bool| match is_locked {
            true => VertexFlags::LOCK,
            false => VertexFlags::EMPTY,
        };
        self.is_locked.iter().map(flag).collect()
    }
}

impl IndexedTriangles<'_> {
    /// As many indices as the target or fewer, or as near as collapses come, without an error limit.
    pub(crate) fn collapsed(self, target: usize, options: SimplifyOptions) -> Vec<u32> {
        let settings = settings(target, options);
        let positions = Positions::from_packed(self.positions);
        self.kept(|space| Ok(simplify(self.indices, positions, settings, space)?.indices))
    }

    /// As [`Self::collapsed`], but attributes count too.
    pub(crate) fn collapsed_with<const COUNT: usize>(
        self,
        attributes: VertexAttributes<'_, COUNT>,
        target: usize,
        options: SimplifyOptions,
    ) -> Vec<u32> {
        let flags = attributes.flags();
        let values = attributes.values.as_flattened();
        let values = Attributes::from_interleaved(values, flags.len(), COUNT, COUNT, 0)
            .expect("as many attributes as vertices");
        let positions = Positions::from_packed(self.positions);
        self.kept(|space| {
            let left = simplify_with_attributes(
                self.indices,
                positions,
                values,
                attributes.weights,
                Some(&flags),
                settings(target, options),
                space,
            )?;
            Ok(left.indices)
        })
    }

    /// As [`Self::collapsed_with`], but vertices that are left move to where the surface is off least: the indices, and
    /// where all vertices are then.
    pub(crate) fn collapsed_moving<const COUNT: usize>(
        self,
        attributes: VertexAttributes<'_, COUNT>,
        target: usize,
    ) -> (Vec<u32>, Vec<[f32; 3]>) {
        let flags = attributes.flags();
        let mut positions = self.positions.to_vec();
        let mut values = attributes.values.as_flattened().to_vec();
        let settings = settings(target, SimplifyOptions::ERROR_ABSOLUTE);
        let kept = self.kept(|space| {
            let mut indices = self.indices.to_vec();
            let mut values =
                AttributesMut::from_interleaved(&mut values, flags.len(), COUNT, COUNT, 0)?;
            let done = simplify_with_update(
                &mut indices,
                &mut PositionsMut::from_packed(&mut positions),
                Some(&mut values),
                attributes.weights,
                Some(&flags),
                settings,
                space,
            )?;
            indices.truncate(done.index_count);
            Ok(indices)
        });
        (kept, positions)
    }

    /// As [`Self::collapsed`], where vertices that share a cell of a grid become one.
    pub(crate) fn joined_in_cells(self, target: usize) -> Vec<u32> {
        let positions = Positions::from_packed(self.positions);
        self.kept(|space| {
            let left = simplify_sloppy(self.indices, positions, None, target, f32::MAX, space)?;
            Ok(left.indices)
        })
    }

    /// What it cannot count with stays as it is: a mesh whose areas leave the range of f32.
    fn kept(self, run: impl FnOnce(&mut Workspace) -> Result<Vec<u32>, Error>) -> Vec<u32> {
        let mut space = Workspace::new(Limits {
            max_bytes: usize::MAX,
            max_work: u64::MAX,
        });
        match run(&mut space) {
            Ok(indices) => indices,
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
