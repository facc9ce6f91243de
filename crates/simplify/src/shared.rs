//! What runs to several targets over one foliage share.
//!
//! An order of removals does not depend on where it ends, so a run to fewer triangles goes on where
//! one to more ended, and one to more takes the beginning of it: as long as their leaves became
//! coarser alike before. What is made is the same, bit for bit, as by runs of their own.

use secateur_raster::ViewSet;
use secateur_raster::measure::vmi::Vmi;

use crate::auto_views::ChosenViews;
use crate::coarsen::{Coarse, LossCurves};
use crate::fit::DrawnOriginals;
use crate::select::{Begun, Selection, Task};
use crate::{Target, Views};

/// What earlier runs over the same foliage, by the same options but for the target, found.
#[derive(Debug, Default)]
pub struct Shared {
    pub(crate) resolution: Option<(u32, String)>,
    /// What [`Views::Auto`] stands for with a budget of triangles.
    pub(crate) views: Option<ChosenViews>,
    pub(crate) curves: Option<LossCurves>,
    /// What the views showed of the original.
    pub(crate) original: Option<(ViewSet, Vmi)>,
    /// What the views in which sizes are fitted show of the original.
    pub(crate) originals: Option<DrawnOriginals>,
    found: Vec<KeptOrder>,
}

/// An order, and what it is of.
#[derive(Clone, Debug)]
pub(crate) struct KeptOrder {
    /// The views that it was chosen from.
    pub(crate) views: Views,
    /// How many triangles each leaf could keep; nothing where they kept all.
    pub(crate) shares: Option<Vec<usize>>,
    pub(crate) coarse: Option<Coarse>,
    pub(crate) begun: Begun,
}

impl KeptOrder {
    /// Whether the order goes as far as a run of this task would.
    pub(crate) fn reaches(&self, task: &Task<'_>) -> bool {
        let order = &self.begun.order;
        let left = order.leaf_count() as usize - order.len();
        matches!(task.target, Target::Triangles(_) | Target::Leaves(_))
            && left <= task.target.fewest_leaves(task.foliage)
    }

    /// All of it, as a method that chose it again would hand it over.
    pub(crate) fn selection(&self) -> Selection {
        Selection {
            order: self.begun.order.clone(),
            costs: self.begun.costs.clone(),
            shown: None,
            is_at_max_error: false,
        }
    }
}

impl Shared {
    /// Takes out the order of leaves that became coarser in this way, chosen from these views.
    pub(crate) fn take(&mut self, views: &Views, shares: &Option<Vec<usize>>) -> Option<KeptOrder> {
        let is_it = |found: &KeptOrder| found.views == *views && found.shares == *shares;
        let known = self.found.iter().position(is_it);
        known.map(|index| self.found.swap_remove(index))
    }

    /// Keeps an order for later runs.
    pub(crate) fn keep(&mut self, found: KeptOrder) {
        self.found.push(found);
    }
}
