//! What is drawn in a frame: records for the GPU, and the calls that use them.

use std::collections::BTreeMap;
use std::ops::Range;

/// An instance, as the shader reads it.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
pub(crate) struct Item {
    pub(crate) position: [f32; 3],
    pub(crate) scale: f32,
    pub(crate) turn: [f32; 2],
    /// Of the order that its mesh is a prefix of.
    pub(crate) steps: u32,
    pub(crate) fade_steps: u32,
    pub(crate) common_scale: f32,
    pub(crate) shown: f32,
    pub(crate) seed: u32,
    pub(crate) padding: u32,
}

/// A leaf of a list, as the shader reads it.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
pub(crate) struct Listed {
    pub(crate) item: u32,
    pub(crate) place: u32,
    pub(crate) scale: f32,
    pub(crate) first_index: u32,
    pub(crate) indices: u32,
}

/// Which chain of levels.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum ChainKind {
    Halvings,
    Shares,
}

/// One draw call: what is drawn, and for which instances.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Call {
    /// A level of a chain, for items.
    Level {
        chain: ChainKind,
        level: usize,
        items: Range<u32>,
    },
    /// The first indices of the leaves' index buffer, for one item.
    Leaves { indices: u32, item: u32 },
    /// The first indices of the wood's index buffer, for one item.
    Wood { indices: u32, item: u32 },
    /// The planes of a box, for items.
    Box { index: usize, items: Range<u32> },
    /// All leaves of the list.
    Listed,
}

/// All draw calls of one frame, with the records of their instances.
#[derive(Clone, Debug, Default)]
pub(crate) struct DrawList {
    pub(crate) items: Vec<Item>,
    pub(crate) listed: Vec<Listed>,
    pub(crate) calls: Vec<Call>,
    levels: BTreeMap<(ChainKind, usize), Vec<Item>>,
    boxes: BTreeMap<usize, Vec<Item>>,
}

impl DrawList {
    /// Adds an item and returns its place.
    pub(crate) fn item(&mut self, item: Item) -> u32 {
        self.items.push(item);
        self.items.len() as u32 - 1
    }

    /// Leaves and wood of a level of a chain.
    pub(crate) fn level(&mut self, chain: ChainKind, level: usize, item: Item) {
        self.levels.entry((chain, level)).or_default().push(item);
    }

    /// The planes of a box.
    pub(crate) fn box_planes(&mut self, index: usize, item: Item) {
        self.boxes.entry(index).or_default().push(item);
    }

    /// Puts items that are drawn alike next to each other: one call for all of them.
    pub(crate) fn finish(mut self) -> Self {
        for ((chain, level), items) in std::mem::take(&mut self.levels) {
            let items = self.appended(items);
            self.calls.push(Call::Level {
                chain,
                level,
                items,
            });
        }
        if !self.listed.is_empty() {
            self.calls.push(Call::Listed);
        }
        for (index, items) in std::mem::take(&mut self.boxes) {
            let items = self.appended(items);
            self.calls.push(Call::Box { index, items });
        }
        self
    }

    fn appended(&mut self, items: Vec<Item>) -> Range<u32> {
        let first = self.items.len() as u32;
        self.items.extend(items);
        first..self.items.len() as u32
    }
}
