//! Boxes about the leaves of a plant's branches, and pictures that stand for what is in them.
//!
//! Lluch, Camahort, Hidalgo, Vivó: A Hybrid Multiresolution Representation for Fast Tree Modeling
//! and Rendering (ICCS 2010, section 4.2). A branch has a box about its leaves and those of all
//! branches that grow from it, along the branch (`hierarchy`). For each box six pictures are made, of
//! what is seen square to its diagonal planes (`planes`). A renderer draws the planes of a box where
//! it is no larger on the screen than its pictures, else what is below: boxes of branches, and
//! leaves that are in none of these ([`cut`]).
//!
//! Where the paper leaves it open: the volume of a box is held against that of the whole plant's, and
//! the planes of a box are blended by how squarely the eye looks on them ([`weights`]). Of pictures
//! that each cover a share c, together they shall cover c, however many there are: each is drawn
//! with 1 - (1 - c)^w, and the weights w of all planes are 1 together.

mod hierarchy;
mod planes;

use glam::DVec3;
use secateur_model::LeafId;

pub use hierarchy::{BoxLimits, leaf_boxes};
pub use planes::{DiagonalPlane, PLANES, PlanePicture, diagonal_planes, picture, weights};

/// A box that may be turned.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OrientedBox {
    /// The middle of the box, in the plant's own space.
    pub centre: DVec3,
    /// Unit vectors, square to each other, right-handed.
    pub axes: [DVec3; 3],
    /// Half of its lengths along these.
    pub half: DVec3,
}

impl OrientedBox {
    /// The volume of the box, in cubic units of the plant.
    pub fn volume(&self) -> f64 {
        8.0 * self.half.element_product()
    }

    /// Half of its diagonal.
    pub fn radius(&self) -> f64 {
        self.half.length()
    }
}

/// The box of a branch.
#[derive(Clone, Debug, PartialEq)]
pub struct LeafBox {
    /// About all of `leaves`.
    pub bounds: OrientedBox,
    /// How many branches up to the whole plant's box, which has 0.
    pub level: u32,
    /// The boxes of branches that grow from it, by their places in the list.
    pub children: Vec<usize>,
    /// All leaves of the branch and of what grows from it.
    pub leaves: Vec<LeafId>,
    /// Leaves of them that are in no child.
    pub own: Vec<LeafId>,
}

/// What stands for a plant at a size on the screen.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct BoxCut {
    /// Boxes to draw, each with how much it counts, above 0 and up to 1.
    pub boxes: Vec<(usize, f64)>,
    /// Boxes of which the own leaves are drawn, likewise.
    pub own_leaves: Vec<(usize, f64)>,
}

/// Chooses from the boxes of a plant, the whole one's first. `pixels_high` says how many pixels high
/// a box shows. One of up to `most_px` pixels is drawn, of a larger one what is below; up to
/// (1 + `blend`) times as many both, the box less and less.
pub fn cut(
    boxes: &[LeafBox],
    most_px: f64,
    blend: f64,
    pixels_high: impl Fn(&OrientedBox) -> f64,
) -> BoxCut {
    let mut cut = BoxCut::default();
    let mut open = vec![(0, 1.0)];
    while let Some((index, weight)) = open.pop() {
        let Some(this) = boxes.get(index) else {
            continue;
        };
        let over = pixels_high(&this.bounds) / most_px - 1.0;
        let below = match blend > 0.0 {
            true => (over / blend).clamp(0.0, 1.0),
            false => f64::from(u8::from(over > 0.0)),
        };
        if below < 1.0 {
            cut.boxes.push((index, weight * (1.0 - below)));
        }
        if below > 0.0 {
            if !this.own.is_empty() {
                cut.own_leaves.push((index, weight * below));
            }
            open.extend(this.children.iter().map(|child| (*child, weight * below)));
        }
    }
    cut
}

#[cfg(test)]
mod tests;
