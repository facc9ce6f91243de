//! The multiresolution chain: a skeleton's branches in order of what they
//! matter, so that every prefix is a plant.
//!
//! Lluch et al. (Hybrid), section 4.1.3. A path leads from a branch that is not
//! out yet to a tip, by the heaviest child at each fork; a level of detail is one
//! path more. Each path starts from the root down the largest branching length
//! that is still to come, which is what the paper's update of the lengths of
//! branches that are out already is for. Equal weights go in the order drawn.
//!
//! The paper's branches fork at their ends; these fork along their length, so a
//! state is saved at the segment that bears something, and a path restores one
//! wherever it does not go on from the segment before.

use std::collections::HashMap;

use crate::branches::{BranchIndex, Branches, Metric};
use crate::chain_paths::paths;
use crate::{LeafPose, Segment, SegmentIndex, Skeleton};

/// A module of the chain.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Record {
    /// A level of detail begins: the records up to the next one are its path.
    Level,
    /// SAVE: the turtle is at the end of a segment, and will come back.
    Save(SegmentIndex),
    /// RESTORE: the turtle goes back to where this was saved.
    Restore(SegmentIndex),
    /// A segment that grows where the turtle is; `parent` is the turtle's to say
    /// and `None` here.
    Segment(Segment),
    /// The leaf of this number, from 0, in the original skeleton, which grows
    /// where the turtle is; `segment` is the turtle's to say and `None` here.
    Leaf(u32, LeafPose),
}

/// A plant as a row of branches, longest first, of which every prefix is a plant (Lluch et al.
/// 2010).
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Chain {
    records: Vec<Record>,
    /// `records[..ends[k]]` are the levels up to and with k.
    ends: Vec<usize>,
    paths: Vec<Vec<BranchIndex>>,
}

impl Chain {
    /// The chain of a skeleton by a metric.
    ///
    /// By [`Metric::BranchingLength`] weights fall as paths go out, as in the
    /// paper; for the others it gives no such rule, and they stay.
    ///
    /// Time: branches times depth, times a logarithm.
    pub fn of(skeleton: &Skeleton, metric: Metric) -> Self {
        let branches = Branches::of(skeleton);
        let paths = paths(&branches, metric);
        write_records(skeleton, &branches, paths)
    }

    /// How many levels there are: one for each tip.
    pub fn levels(&self) -> usize {
        self.ends.len()
    }

    /// All records, the coarsest level first.
    pub fn records(&self) -> &[Record] {
        &self.records
    }

    /// The records of the first `levels` levels (all if there are fewer).
    pub fn prefix(&self, levels: usize) -> &[Record] {
        let end = match levels.min(self.levels()) {
            0 => 0,
            levels => self.ends[levels - 1],
        };
        &self.records[..end]
    }

    /// The branches of each level, in the order of [`Branches::all`].
    pub fn paths(&self) -> &[Vec<BranchIndex>] {
        &self.paths
    }

    /// The plant of the first `levels` levels. Time in proportion to the records
    /// of those levels, whatever follows them.
    ///
    /// # Panics
    /// Never: a chain that was made from a skeleton can be drawn.
    pub fn skeleton(&self, levels: usize) -> Skeleton {
        let records = self.prefix(levels);
        let mut turtle = Turtle::with_room_for(records);
        for record in records {
            turtle.obey(record);
        }
        turtle.skeleton
    }
}

/// Draws a chain record by record: after each there is a plant.
#[derive(Default)]
struct Turtle {
    skeleton: Skeleton,
    at: Option<SegmentIndex>,
    saved: HashMap<SegmentIndex, SegmentIndex>,
}

impl Turtle {
    /// Growing while it draws would cost a large level more a record than a small
    /// one.
    fn with_room_for(records: &[Record]) -> Self {
        let count = |is: fn(&Record) -> bool| records.iter().filter(|r| is(r)).count();
        let leaves = count(|record| matches!(record, Record::Leaf(..)));
        let segments = count(|record| matches!(record, Record::Segment(_)));
        let saves = count(|record| matches!(record, Record::Save(_)));
        Self {
            skeleton: Skeleton {
                segments: Vec::with_capacity(segments),
                leaves: Vec::with_capacity(leaves),
            },
            at: None,
            saved: HashMap::with_capacity(saves),
        }
    }

    /// Draws one record more of a chain that [`write_records`] made: it saves where a segment ends, and restores what
    /// it saved.
    fn obey(&mut self, record: &Record) {
        match *record {
            Record::Level => {}
            Record::Save(id) => {
                let at = self.at.expect("a segment was drawn");
                self.saved.insert(id, at);
            }
            Record::Restore(id) => self.at = Some(self.saved[&id]),
            Record::Segment(segment) => {
                let index = SegmentIndex::from_index(self.skeleton.segments.len());
                self.skeleton.segments.push(Segment {
                    parent: self.at,
                    continues_parent: segment.continues_parent && self.at.is_some(),
                    ..segment
                });
                self.at = Some(index);
            }
            Record::Leaf(_, pose) => self.skeleton.leaves.push(LeafPose {
                segment: self.at,
                ..pose
            }),
        }
    }
}

fn write_records(skeleton: &Skeleton, branches: &Branches, paths: Vec<Vec<BranchIndex>>) -> Chain {
    let segments = &skeleton.segments;
    let mut is_fork = vec![false; segments.len()];
    for branch in branches.all() {
        if let Some(parent) = segments[branch.segments[0].index()].parent {
            is_fork[parent.index()] = true;
        }
    }
    let mut leaves_of = vec![Vec::new(); segments.len()];
    let mut loose = Vec::new();
    for (number, leaf) in skeleton.leaves.iter().enumerate() {
        let record = Record::Leaf(
            number as u32,
            LeafPose {
                segment: None,
                ..*leaf
            },
        );
        match leaf.segment {
            Some(segment) => leaves_of[segment.index()].push(record),
            None => loose.push(record),
        }
    }
    let mut chain = Chain::default();
    let mut at = None;
    if paths.is_empty() && !loose.is_empty() {
        chain.records.push(Record::Level);
        chain.records.append(&mut loose);
        chain.ends.push(chain.records.len());
        chain.paths.push(Vec::new());
    }
    for path in &paths {
        chain.records.push(Record::Level);
        chain.records.append(&mut loose);
        for &index in path
            .iter()
            .flat_map(|b| &branches.all()[b.index()].segments)
        {
            let segment = segments[index.index()];
            if let Some(parent) = segment.parent.filter(|_| segment.parent != at) {
                chain.records.push(Record::Restore(parent));
            }
            chain.records.push(Record::Segment(Segment {
                parent: None,
                ..segment
            }));
            chain.records.append(&mut leaves_of[index.index()]);
            if is_fork[index.index()] {
                chain.records.push(Record::Save(index));
            }
            at = Some(index);
        }
        chain.ends.push(chain.records.len());
    }
    chain.paths.extend(paths);
    chain
}
