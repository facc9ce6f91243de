//! One view of the leaves that are left, in sizes that can be tried and taken back.

use secateur_model::{Foliage, LeafId};
use secateur_raster::abuffer::{ABuffer, FrontTwo, Undo};
use secateur_raster::cpu::LeafFragments;
use secateur_raster::occluders::Occlusion;
use secateur_raster::{View, ViewFragments};

/// A leaf that changes its size.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Change {
    pub leaf: LeafId,
    /// The factor of its area that it takes.
    pub to: f64,
}

pub(super) struct SizedView<'a> {
    left: &'a Foliage,
    view: &'a View,
    /// Of the leaves in their sizes.
    pub a_buffer: ABuffer,
    in_other_size: LeafFragments,
    tried: Undo,
}

impl<'a> SizedView<'a> {
    /// `fragments` are those of the leaves as they are, among what hides some of them.
    pub(super) fn new(
        left: &'a Foliage,
        view: &'a View,
        fragments: ViewFragments,
        occlusion: &[Occlusion],
        resolution: u32,
    ) -> Self {
        Self {
            left,
            view,
            a_buffer: ABuffer::new(vec![fragments], left.leaves().len()),
            in_other_size: LeafFragments::new(resolution).among(occlusion),
            tried: Undo::default(),
        }
    }

    /// Pixels and depths of a leaf at some size, beside what there is now.
    pub(super) fn at_size(&mut self, leaf: LeafId, scale: f64) -> (&ABuffer, &[(u32, u32)]) {
        let view = std::slice::from_ref(self.view);
        let fragments = self.in_other_size.of(self.left, leaf, scale, view);
        (&self.a_buffer, fragments)
    }

    /// Gives leaves other sizes; of each leaf `changed` hears what the
    /// [A-buffer](ABuffer) tells.
    pub(super) fn try_out(
        &mut self,
        changes: &[Change],
        mut changed: impl FnMut(u32, FrontTwo, FrontTwo),
    ) {
        self.tried.clear();
        let view = std::slice::from_ref(self.view);
        for change in changes {
            let then = self
                .in_other_size
                .of(self.left, change.leaf, change.to, view);
            let leaf = change.leaf.get();
            self.a_buffer
                .try_out(leaf, then, &mut self.tried, &mut changed);
        }
    }

    /// Takes back what was tried out last.
    pub(super) fn take_back(&mut self, changed: impl FnMut(u32, FrontTwo, FrontTwo)) {
        self.a_buffer.undo(&mut self.tried, changed);
    }
}
