//! The pass that chooses leaves: one interface for every method.

use std::ops::ControlFlow;

use secateur_model::{Foliage, PlantSkeleton, RemovalOrder};
use secateur_raster::Rasteriser;
use secateur_raster::measure::vmi::ScaledBits;

use crate::observe::Shown;
use crate::vds::ViewPlan;
use crate::{Error, Target};

/// Is told the number of steps that are done and the largest number that there may be, and may break
/// off the run.
pub type Steps<'a> = dyn FnMut(usize, usize) -> ControlFlow<()> + 'a;

/// The first steps of an order, made by an earlier run.
#[derive(Clone, Debug)]
pub struct Begun {
    /// The steps of the order.
    pub order: RemovalOrder,
    /// The cost of each step, in bits.
    pub costs: Vec<ScaledBits>,
}

/// What a method is asked to do.
pub struct Task<'a> {
    /// The original foliage, all leaves of it.
    pub foliage: &'a Foliage,
    /// How far it should go. A method that knows only leaves goes on to the last one for another
    /// target; what is too much is cut off afterwards.
    pub target: Target,
    /// Steps of an earlier run, which this one continues; a method that cannot do so starts over.
    pub begun: Option<&'a Begun>,
    /// What the leaves have grown on, where that is known.
    pub skeleton: Option<&'a PlantSkeleton>,
    /// From where a method that is driven by views looks.
    pub views: &'a ViewPlan,
    /// Width and height of its images in pixels.
    pub resolution: u32,
    /// The twin that draws those images (the GPU's or the CPU's), with what hides leaves.
    pub rasteriser: &'a dyn Rasteriser,
    /// What hides leaves, if anything does.
    pub occluders: Option<&'a Foliage>,
}

/// What a method chose.
#[derive(Clone, Debug)]
pub struct Selection {
    /// Which leaves go, in order, and what grows or is made for them.
    pub order: RemovalOrder,
    /// The cost of each step, for a method that has such costs; else empty.
    pub costs: Vec<ScaledBits>,
    /// What the views show at the end, for a method that is driven by them.
    pub shown: Option<Shown>,
    /// Whether the order ended since the next step would have exceeded the error asked for.
    pub is_at_max_error: bool,
}

impl Selection {
    /// Of a method that looks from nowhere.
    pub fn unseen(order: RemovalOrder) -> Self {
        Self {
            order,
            costs: Vec::new(),
            shown: None,
            is_at_max_error: false,
        }
    }
}

/// A method: which leaves go, and in which order.
pub trait Select {
    /// Whether the method's options are in range, and the plant has what it needs.
    ///
    /// # Errors
    /// [`Error`] with the first that is not.
    fn check(&self, foliage: &Foliage, skeleton: Option<&PlantSkeleton>) -> Result<(), Error>;

    /// The removal order towards the task's target. `steps` is called after every step and may
    /// break off.
    ///
    /// # Errors
    /// [`Error::Stopped`] if it was broken off; [`Error`] if the views are out of range or the
    /// rasteriser fails.
    fn select(&self, task: &Task<'_>, steps: &mut Steps<'_>) -> Result<Selection, Error>;
}

/// [`Error::Setting`] for a number that is out of range.
pub(crate) fn refuse(name: &str, value: f64, range: &'static str) -> Result<(), Error> {
    Err(Error::Setting(format!("the {name} of {value}"), range))
}
