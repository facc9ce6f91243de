//! `secateur batch`: levels of many plants, each an item that an engine for batches hands to a worker. An item's result
//! is named by its key, and is there whole or not at all: who does an item twice finds it done.

mod collect;
mod item;
mod plan;
mod run;

use super::args::{Batch, Common};
use super::failure::Failure;
use super::print::Printed;

pub(crate) use item::Item;

/// Plans, does an item, or gathers what was done.
pub(crate) fn run(args: &Batch, common: &Common) -> Result<Printed, Failure> {
    match args {
        Batch::Plan(args) => plan::run(args),
        Batch::Run(args) => run::run(args, common),
        Batch::Collect(args) => collect::run(args),
    }
}
