//! What views show of the wood, and by how much a collapse changes the information in it.

use secateur_model::Foliage;
use secateur_raster::abuffer::{ABuffer, Event, Undo};
use secateur_raster::cpu::LeafFragments;
use secateur_raster::measure::incremental::IncrementalVmi;
use secateur_raster::{Rasteriser, Scene, ViewSet};

use super::mesh::{Effect, Mesh};
use crate::Error;
use crate::lg::LgTable;

/// What collapses cost: the sum over the views of by how much the information in them changes.
pub(super) trait Cost {
    /// The cost of a collapse of the mesh as it is, in the units of scaled VMI.
    fn of(&mut self, mesh: &Mesh<'_>, effect: &Effect) -> i64;

    /// Takes note of a collapse that the mesh has made.
    fn commit(&mut self, mesh: &Mesh<'_>, effect: &Effect);
}

/// The A-buffer of triangles with their areas: each triangle is an item.
#[derive(Clone)]
pub(super) struct Seen<'a> {
    views: &'a ViewSet,
    pixels_per_view: u32,
    fragments: LeafFragments,
    buffer: ABuffer,
    vmi: IncrementalVmi<'a>,
    undo: Undo,
    before: Vec<i64>,
}

/// Each triangle of the wood as a leaf.
pub(super) fn triangles_as_leaves(mesh: &Mesh<'_>) -> Foliage {
    let wood = mesh.wood();
    let mut triangles = Foliage::new(wood.cutouts().to_vec());
    for (number, triangle) in wood.triangles().iter().enumerate() {
        let like = wood.leaf(mesh.piece_of(number as u32));
        let pushed = triangles.push_leaf_like(&[*triangle], like);
        pushed.expect("a triangle of the wood");
    }
    triangles
}

impl<'a> Seen<'a> {
    /// Draws the wood.
    ///
    /// # Errors
    /// [`Error::Gpu`] if the rasteriser fails.
    pub(super) fn new(
        mesh: &Mesh<'_>,
        views: &'a ViewSet,
        resolution: u32,
        rasteriser: &dyn Rasteriser,
        table: &'a LgTable,
    ) -> Result<Self, Error> {
        let leaves = triangles_as_leaves(mesh);
        let count = leaves.leaves().len();
        let scene = Scene {
            foliage: &leaves,
            lod: &secateur_model::Lod::original(count),
            views,
            resolution,
        };
        let found = rasteriser.fragments(&scene)?;
        let areas = secateur_raster::cpu::areas_of_heads(&found, count);
        let fragments = LeafFragments::new(resolution);
        Ok(Self {
            views,
            pixels_per_view: resolution * resolution,
            fragments: match rasteriser.occlusions(views, resolution) {
                Some(occlusions) => fragments.among(&occlusions),
                None => fragments,
            },
            buffer: ABuffer::new(found.into_views(), count),
            vmi: IncrementalVmi::new(&areas, table),
            undo: Undo::default(),
            before: Vec::new(),
        })
    }

    /// Edits the pixels as a collapse has it.
    fn edit(&mut self, mesh: &Mesh<'_>, effect: &Effect, is_trial: bool) {
        let Self {
            views,
            pixels_per_view,
            fragments,
            buffer,
            vmi,
            undo,
            ..
        } = self;
        let mut changed = |pixel: u32, before, after| {
            vmi.record(&Event {
                view: pixel / *pixels_per_view,
                pixels: 1,
                before,
                after,
            });
        };
        for &triangle in &effect.removed {
            match is_trial {
                true => buffer.try_out(triangle + 1, &[], undo, &mut changed),
                false => buffer.remove(triangle + 1, &mut changed),
            }
        }
        for &(triangle, corners) in &effect.changed {
            let wood = mesh.wood();
            let like = wood.leaf(mesh.piece_of(triangle));
            let after = [mesh.triangle(corners)];
            let found = fragments.of_triangles(&after, like, wood.cutouts(), views.views());
            match is_trial {
                true => buffer.try_out(triangle + 1, found, undo, &mut changed),
                false => buffer.replace(triangle + 1, found, &mut changed),
            }
        }
    }
}

impl Cost for Seen<'_> {
    fn of(&mut self, mesh: &Mesh<'_>, effect: &Effect) -> i64 {
        self.before.clear();
        self.before.extend_from_slice(self.vmi.deviations());
        self.edit(mesh, effect, true);
        self.vmi.settle();
        let pairs = self.vmi.deviations().iter().zip(&self.before);
        let cost = pairs.map(|(after, before)| (after - before).abs()).sum();
        self.vmi.undo();
        self.buffer.undo(&mut self.undo, |_, _, _| ());
        cost
    }

    fn commit(&mut self, mesh: &Mesh<'_>, effect: &Effect) {
        self.edit(mesh, effect, false);
        self.vmi.settle();
        self.vmi.forget_step();
    }
}
