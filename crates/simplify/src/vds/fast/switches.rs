//! What the ablation bench can switch off: short cuts without which the engine
//! finds the same, later.
//!
//! Without the feature `ablation` every switch is a constant, and nothing is left
//! of it in the program.

#[cfg(feature = "ablation")]
use secateur_raster::prefetch::switches as prefetch;

macro_rules! mechanisms {
    ($($(#[$doc:meta])* $name:ident = $text:literal,)*) => {
        /// A short cut of the exact engine.
        #[cfg_attr(
            not(feature = "ablation"),
            expect(
                unreachable_pub,
                dead_code,
                reason = "only the ablation bench names it, and what is switched off elsewhere"
            )
        )]
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        pub enum Mechanism {
            $($(#[$doc])* $name,)*
        }

        #[cfg(feature = "ablation")]
        impl Mechanism {
            /// Every one, in the order of the engine's files.
            pub const ALL: &[Self] = &[$(Self::$name),*];

            /// What it is called in the rows of the bench.
            pub fn name(self) -> &'static str {
                match self {
                    $(Self::$name => $text,)*
                }
            }
        }
    };
}

mechanisms! {
    /// Unless there are very many leaves, tables have a row for each.
    RowsOfAll = "rows for all leaves",
    /// Leaves whose deltas are all zero wait outside the blocks.
    ZeroLeavesWait = "leaves without effect wait outside",
    /// Leaves that hand as many pixels of one view to the background, and change nothing else, have one cost.
    AlikeTogether = "leaves alike have one cost",
    /// Leaves that no pixel shows go one after the other without a search for each.
    HiddenTogether = "hidden leaves go together",
    /// The two cheapest leaves of the last step are evaluated first.
    SeedCheapest = "last cheapest leaves first",
    /// The dearest leaf of the last step is evaluated first.
    SeedDearest = "last dearest leaf first",
    /// The cheapest leaf of a block is known exactly while no deviation changes its sign.
    ExactFirst = "exact cheapest leaf of a block",
    /// What is known exactly of a block becomes its bound.
    ExactFirstAsBound = "exact cheapest leaf as bound",
    /// Exact sums are renewed only after a while without a change of sign.
    ExactFirstWhenSteady = "exact sums only when steady",
    /// Small changes lower a block's bounds instead of being read at once.
    LazyReading = "small changes widen bounds",
    /// Leaves read too long ago are read again before they are evaluated exactly.
    ReadAgain = "stale leaves read again",
    /// Blocks are ruled out from being the dearest by a bound of their own first.
    Tops = "first bound on the dearest",
    /// The bounds of all blocks are compared sixteen at a time with one limit.
    FilterGroups = "filter: sixteen blocks at a time",
    /// Then each with that of its own epoch.
    FilterEach = "filter: each block",
    /// The filter compares the sum of the deltas without their signs.
    FilterBySize = "filter: by size",
    /// The filter compares the sum of the deltas with the signs of the deviations.
    FilterBySignedSum = "filter: by signed sum",
    /// A block compares the sum of its deltas without their signs.
    BlockBySize = "block: by size",
    /// A block compares the sum of its deltas with the signs of the deviations.
    BlockBySignedSum = "block: by signed sum",
    /// A block compares its last excess less what it may have lost.
    BlockByLoss = "block: by last excess",
    /// What an excess may have lost is bounded view by view.
    LossByWidth = "loss bounded by widths",
    /// How far the background has drifted is bounded by derivatives.
    BackgroundDrift = "background: drift",
    /// Bounds about to be forgotten are carried over to the current epoch.
    Rebase = "bounds carried over",
    /// Shards share the least and largest cost found.
    SharedLimits = "limits shared by cores",
    /// Leaves of about the same size share a block.
    SortedBlocks = "blocks of like leaves",
    /// Blocks are built anew when an eighth of the leaves is gone.
    Rebuild = "blocks built anew",
    /// How the logarithm of the background's total rises is tabulated each step.
    RiseTable = "table of rises",
    /// Wide instructions: excesses of a block.
    WideExcess = "AVX2: excesses",
    /// Wide instructions: the filter.
    WideFilter = "AVX2: filter",
    /// Wide instructions: what an excess may have lost.
    WideLoss = "AVX2: loss",
    /// Memory is asked for ahead: everywhere.
    Prefetch = "prefetch: all",
    /// Memory is asked for ahead: blocks and their leaves.
    PrefetchBlocks = "prefetch: blocks",
    /// Memory is asked for ahead: reveal edges.
    PrefetchEdges = "prefetch: edges",
    /// Memory is asked for ahead: deltas.
    PrefetchDeltas = "prefetch: deltas",
    /// Memory is asked for ahead: areas.
    PrefetchAreas = "prefetch: areas",
    /// Memory is asked for ahead: pixel lists.
    PrefetchPixels = "prefetch: pixel lists",
}

#[cfg(feature = "ablation")]
static OFF: std::sync::atomic::AtomicU64 = std::sync::atomic::AtomicU64::new(0);

/// Switches these mechanisms off and all others on, for runs that begin later.
#[cfg(feature = "ablation")]
pub fn switch_off(off: &[Mechanism]) {
    let bits = off.iter().fold(0, |bits, m| bits | 1 << *m as u32);
    let relaxed = std::sync::atomic::Ordering::Relaxed;
    OFF.store(bits, relaxed);
    // What the A-buffer does is switched off where it is.
    prefetch::IS_OFF.store(off.contains(&Mechanism::Prefetch), relaxed);
    prefetch::IS_OFF_FOR_LISTS.store(off.contains(&Mechanism::PrefetchPixels), relaxed);
}

/// Whether a mechanism is in use.
#[cfg(feature = "ablation")]
#[inline(always)]
pub(super) fn is_on(mechanism: Mechanism) -> bool {
    OFF.load(std::sync::atomic::Ordering::Relaxed) >> mechanism as u32 & 1 == 0
}

/// Whether a mechanism is in use.
#[cfg(not(feature = "ablation"))]
#[inline(always)]
pub(super) const fn is_on(_: Mechanism) -> bool {
    true
}
