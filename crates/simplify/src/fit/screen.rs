//! What one view shows while leaves change their size.

use secateur_model::{Foliage, LeafId};
use secateur_raster::cpu::LeafFragments;
use secateur_raster::{Fragment, LeafIdImage, View};
use smallvec::SmallVec;

/// A leaf that changes its size, by factors of its area.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Change {
    pub leaf: LeafId,
    pub from: f64,
    pub to: f64,
}

/// What a leaf of some size does in a view.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Seen {
    /// Pixels that only it covers: those within the outline less those outside.
    pub outline_px: i64,
    /// Pixels, seen or not, that it covers now or at this size and not both.
    pub changed_px: u32,
    /// Pixels that it owns.
    pub area_px: u32,
    /// What these would be worth to who owns them without it, scaled.
    pub worth_to_others: i64,
}

/// Leaves, 0 for the background, and by how many pixels their areas in a view changed;
/// each once, in order.
pub(super) type Moved = Vec<(u32, i32)>;

/// One view: the outline that it should have, and what covers its pixels.
pub(super) struct Screen<'a> {
    view: &'a View,
    /// Whether a pixel shows foliage in the original.
    outline: Vec<bool>,
    pixels: Vec<Pixel>,
    /// Pixels that show foliage where they should not, or none where they should.
    outline_error_px: u32,
    at_size: LeafFragments,
    at_other: LeafFragments,
}

/// The leaves that cover a pixel, nearest first.
type Pixel = SmallVec<[Fragment; 2]>;

/// The one that is seen, 0 where none is.
fn owner(pixel: &Pixel) -> u32 {
    pixel.first().map_or(0, |fragment| fragment.leaf())
}

/// The nearest but for a leaf: behind everything where there is none.
fn nearest_but(pixel: &Pixel, leaf: u32) -> Fragment {
    let mut others = pixel.iter().filter(|fragment| fragment.leaf() != leaf);
    *others.next().unwrap_or(&Fragment::new(u32::MAX, 0))
}

impl<'a> Screen<'a> {
    pub(super) fn new(view: &'a View, original: &LeafIdImage) -> Self {
        Self {
            view,
            outline: original.leaf_ids.iter().map(|leaf| *leaf != 0).collect(),
            pixels: vec![Pixel::new(); original.leaf_ids.len()],
            outline_error_px: original.leaf_ids.iter().filter(|l| **l != 0).count() as u32,
            at_size: LeafFragments::new(original.resolution),
            at_other: LeafFragments::new(original.resolution),
        }
    }

    /// Draws leaves in their sizes on nothing.
    pub(super) fn draw(&mut self, left: &Foliage) {
        for index in 0..left.leaves().len() {
            self.put(left, LeafId::from_index(index), 1.0, |_, _| ());
        }
    }

    /// The areas of so many leaves in pixels, the background first.
    pub(super) fn areas_px(&self, leaf_count: usize) -> Vec<u32> {
        let mut areas_px = vec![0; leaf_count + 1];
        for pixel in &self.pixels {
            areas_px[owner(pixel) as usize] += 1;
        }
        areas_px
    }

    /// Pixels that show foliage in the original.
    pub(super) fn outline_px(&self) -> u32 {
        self.outline
            .iter()
            .filter(|is_foliage| **is_foliage)
            .count() as u32
    }

    /// Pixels that show foliage where they should not, or none where they should.
    pub(super) fn outline_error_px(&self) -> u32 {
        self.outline_error_px
    }

    /// What a leaf does here at these sizes, the first being the one that it has.
    pub(super) fn seen(
        &mut self,
        left: &Foliage,
        leaf: LeafId,
        scales: [f64; 3],
        pixel_values: &[i64],
    ) -> [Seen; 3] {
        let view = std::slice::from_ref(self.view);
        let now = self.at_size.of(left, leaf, scales[0], view);
        let mut seen = [Seen::default(); 3];
        for (seen, (k, &scale)) in seen.iter_mut().zip(scales.iter().enumerate()) {
            let then = match k {
                0 => now,
                _ => self.at_other.of(left, leaf, scale, view),
            };
            seen.changed_px = (now.len() + then.len()) as u32;
            let mut own = now.iter().map(|(pixel, _)| *pixel).peekable();
            for &(index, depth) in then {
                while own.next_if(|pixel| *pixel < index).is_some() {}
                let is_there = own.peek() == Some(&index);
                seen.changed_px -= 2 * u32::from(is_there);
                let pixel = &self.pixels[index as usize];
                if pixel.len() == usize::from(is_there) {
                    seen.outline_px += if self.outline[index as usize] { 1 } else { -1 };
                }
                let other = nearest_but(pixel, leaf.get());
                if Fragment::new(depth, leaf.get()) < other {
                    seen.area_px += 1;
                    seen.worth_to_others += pixel_values[other.leaf() as usize];
                }
            }
        }
        seen
    }

    /// Makes leaves larger or smaller.
    pub(super) fn change(&mut self, left: &Foliage, changes: &[Change]) -> Moved {
        let mut moved: Vec<(u32, i32)> = Vec::new();
        let mut note = |from: u32, to: u32| {
            if from != to {
                moved.extend([(from, -1), (to, 1)]);
            }
        };
        for change in changes {
            self.take(left, change.leaf, change.from, &mut note);
            self.put(left, change.leaf, change.to, &mut note);
        }
        moved.sort_unstable_by_key(|(leaf, _)| *leaf);
        let mut areas_px = Moved::new();
        for (leaf, px) in moved {
            match areas_px.last_mut() {
                Some(sum) if sum.0 == leaf => sum.1 += px,
                _ => areas_px.push((leaf, px)),
            }
        }
        areas_px.retain(|(_, px)| *px != 0);
        areas_px
    }

    /// Takes a leaf of this size away; tells of each pixel who owned it and who does.
    fn take(&mut self, left: &Foliage, leaf: LeafId, scale: f64, mut note: impl FnMut(u32, u32)) {
        let view = std::slice::from_ref(self.view);
        for &(index, _) in self.at_size.of(left, leaf, scale, view) {
            let pixel = &mut self.pixels[index as usize];
            let before = owner(pixel);
            let place = pixel
                .iter()
                .position(|fragment| fragment.leaf() == leaf.get());
            pixel.remove(place.expect("the leaf covered the pixel at this size"));
            if pixel.is_empty() {
                match self.outline[index as usize] {
                    true => self.outline_error_px += 1,
                    false => self.outline_error_px -= 1,
                }
            }
            note(before, owner(pixel));
        }
    }

    /// Adds a leaf of this size; tells of each pixel who owned it and who does.
    fn put(&mut self, left: &Foliage, leaf: LeafId, scale: f64, mut note: impl FnMut(u32, u32)) {
        let view = std::slice::from_ref(self.view);
        for &(index, depth) in self.at_size.of(left, leaf, scale, view) {
            let pixel = &mut self.pixels[index as usize];
            let before = owner(pixel);
            if pixel.is_empty() {
                match self.outline[index as usize] {
                    true => self.outline_error_px -= 1,
                    false => self.outline_error_px += 1,
                }
            }
            let fragment = Fragment::new(depth, leaf.get());
            let place = pixel.partition_point(|nearer| *nearer < fragment);
            pixel.insert(place, fragment);
            note(before, owner(pixel));
        }
    }
}
