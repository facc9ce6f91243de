//! Levels of a whole plant, wood and leaves.

use super::clusters::{Card, ClusterSize, Disc};
use super::merging::Merging;
use super::scheme::Scheme;
use super::sticks::{in_order, replaced_below, thresholds};
use super::thresholds::{StickSize, Thresholds};
use crate::{LeafPose, Segment, SegmentIndex, Skeleton};

/// A level of detail.
#[derive(Clone, Debug, PartialEq)]
pub struct MergedLevel {
    /// The HR above which sticks were replaced, minus infinity if all that can be were; by
    /// [`merge_below`] the threshold as it was given.
    pub threshold: f64,
    /// How many sticks were.
    pub replaced: usize,
    /// What is left: sticks, some of them extended; leaves that stand as they did,
    /// in their order, then clusters as leaves of the same kind.
    pub skeleton: Skeleton,
}

/// The levels of a plant by a scheme, the finest first. The plant itself is none of
/// them.
///
/// Time: sticks and leaves times depth, for all levels together.
///
/// # Panics
/// If a segment's parent is not an earlier one.
pub fn merge_levels(skeleton: &Skeleton, scheme: &Scheme, size: ClusterSize) -> Vec<MergedLevel> {
    let sticks = in_order(&replaced_below(
        &skeleton.segments,
        StickSize::HeightOverRadius,
    ));
    let shares = scheme.shares_gone();
    let thresholds = thresholds(&sticks, skeleton.segments.len(), &shares);
    levels(skeleton, &sticks, &thresholds, size)
}

/// The levels of a plant at thresholds of HR of one's own.
///
/// # Panics
/// If the thresholds rise or one is NaN, or a segment's parent is not an earlier
/// one.
pub fn merge_at(skeleton: &Skeleton, thresholds: &[f64], size: ClusterSize) -> Vec<MergedLevel> {
    let fall = thresholds.is_sorted_by(|a, b| a >= b);
    assert!(
        fall && !thresholds.iter().any(|t| t.is_nan()),
        "thresholds fall"
    );
    let sticks = in_order(&replaced_below(
        &skeleton.segments,
        StickSize::HeightOverRadius,
    ));
    levels(skeleton, &sticks, thresholds, size)
}

/// The levels of a plant at thresholds of HR or of thickness, the finest first.
///
/// # Panics
/// If a segment's parent is not an earlier one.
pub fn merge_below(
    skeleton: &Skeleton,
    thresholds: &Thresholds,
    size: ClusterSize,
) -> Vec<MergedLevel> {
    let sticks = in_order(&replaced_below(&skeleton.segments, thresholds.of()));
    let signed = thresholds.values().iter().map(|t| thresholds.signed(*t));
    let signed: Vec<f64> = signed.collect();
    let mut levels = levels(skeleton, &sticks, &signed, size);
    for level in &mut levels {
        level.threshold = thresholds.signed(level.threshold);
    }
    levels
}

fn levels(
    skeleton: &Skeleton,
    sticks: &[(f64, u32)],
    thresholds: &[f64],
    size: ClusterSize,
) -> Vec<MergedLevel> {
    let disc = |leaf: &LeafPose| disc_of(leaf, &skeleton.segments);
    let discs = skeleton.leaves.iter().map(disc).collect();
    let leaf_sticks = skeleton.leaves.iter().map(|leaf| leaf.segment);
    let mut merging = Merging::new(&skeleton.segments, discs, size, leaf_sticks);
    let mut levels = Vec::new();
    let mut replaced = 0;
    for &threshold in thresholds {
        while let Some(&(_, stick)) = sticks.get(replaced).filter(|s| s.0 > threshold) {
            merging.replace(stick, &mut |_| {});
            replaced += 1;
        }
        levels.push(MergedLevel {
            threshold,
            replaced,
            skeleton: left(skeleton, &merging),
        });
    }
    levels
}

fn disc_of(leaf: &LeafPose, sticks: &[Segment]) -> Disc {
    Disc {
        anchor: leaf.segment.map_or(leaf.base, |s| sticks[s.index()].end),
        centre: leaf.base + leaf.along * (0.5 * leaf.length_m),
        radius_m: radius_of(leaf),
    }
}

/// From the middle of a card to its corners.
fn radius_of(leaf: &LeafPose) -> f64 {
    0.5 * libm::hypot(leaf.length_m, leaf.width_m)
}

fn left(skeleton: &Skeleton, merging: &Merging<'_>) -> Skeleton {
    let mut level = Skeleton::default();
    let mut new_places = vec![None; skeleton.segments.len()];
    let mut is_single = vec![false; skeleton.leaves.len()];
    let mut clusters = Vec::new();
    for (index, segment) in skeleton.segments.iter().enumerate() {
        if !merging.is_kept(index) {
            new_places[index] = segment.parent.and_then(|p| new_places[p.index()]);
            continue;
        }
        let place = SegmentIndex::from_index(level.segments.len());
        new_places[index] = Some(place);
        let stick = merging.stick(index);
        level.segments.push(Segment {
            parent: stick.parent.and_then(|parent| new_places[parent.index()]),
            ..stick
        });
        for leaf in merging.single(index) {
            is_single[leaf as usize] = true;
        }
        clusters.extend(merging.card(index as u32).map(|card| (place, card)));
    }
    for (leaf, is_single) in skeleton.leaves.iter().zip(is_single) {
        let place = leaf.segment.and_then(|segment| new_places[segment.index()]);
        if is_single || leaf.segment.is_none() {
            level.leaves.push(LeafPose {
                segment: place,
                ..*leaf
            });
        }
    }
    let pose = |(place, card): (SegmentIndex, Card)| {
        let donor = skeleton.leaves[card.donor as usize];
        clustered(&donor, place, &card)
    };
    level.leaves.extend(clusters.into_iter().map(pose));
    level
}

/// The donor with its middle at the cluster's centre and its corners at its radius.
fn clustered(donor: &LeafPose, place: SegmentIndex, card: &Card) -> LeafPose {
    let radius_m = radius_of(donor);
    let scale = match radius_m > 0.0 {
        true => card.radius_m / radius_m,
        false => 1.0,
    };
    let length_m = donor.length_m * scale;
    LeafPose {
        segment: Some(place),
        base: card.centre - donor.along * (0.5 * length_m),
        length_m,
        width_m: donor.width_m * scale,
        ..*donor
    }
}
