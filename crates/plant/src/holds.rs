//! What leaves and wood hang on: where, and how far along the wood.

use glam::DVec3;
use secateur_model::{Hold, Segment, SegmentIndex};

use crate::Skeleton;

/// How far along the wood each segment starts, in metres from the ground.
pub(crate) fn starts_m(segments: &[Segment]) -> Vec<f64> {
    let mut starts: Vec<f64> = Vec::with_capacity(segments.len());
    for segment in segments {
        let start = match segment.parent {
            None => 0.0,
            Some(parent) => {
                let below = starts[parent.index()];
                below + along_axis(&segments[parent.index()], segment.start).1
            }
        };
        starts.push(start);
    }
    starts
}

/// The point of a segment's axis that is nearest to a point, and how far it is from the start.
fn along_axis(segment: &Segment, point: DVec3) -> (DVec3, f64) {
    let length = segment.length_m();
    let axis = (segment.end - segment.start).normalize_or_zero();
    let along = (point - segment.start).dot(axis).clamp(0.0, length);
    (segment.start + axis * along, along)
}

/// The hold of what is on a segment, at a point of its axis.
pub(crate) fn hold(segment: usize, pivot: DVec3, along_m: f64) -> Hold {
    Hold {
        segment: Some(SegmentIndex::from_index(segment)),
        pivot: pivot.as_vec3(),
        along_m: along_m as f32,
    }
}

/// What each leaf hangs on. A leaf on no segment hangs on its own base, which does not move.
pub(crate) fn leaf_holds(skeleton: &Skeleton, starts_m: &[f64]) -> Vec<Hold> {
    let of_leaf = |leaf: &crate::LeafPose| match leaf.segment {
        Some(on) => {
            let (pivot, along) = along_axis(&skeleton.segments[on.index()], leaf.base);
            hold(on.index(), pivot, starts_m[on.index()] + along)
        }
        None => Hold {
            segment: None,
            pivot: leaf.base.as_vec3(),
            along_m: 0.0,
        },
    };
    skeleton.leaves.iter().map(of_leaf).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Random, Rules, draw};

    #[test]
    fn leaves_hang_on_the_axis_and_count_the_wood_below_them() {
        // A stem of 2 m, a branch to the left after the first, and a leaf half way along that.
        let rules =
            Rules::parse("axiom: F(1) [+(90) F(0.5) leaf(0.1) F(0.5)] F(1) leaf(0.1);").unwrap();
        let word = rules.derive(1.0, &mut Random::new(0)).unwrap();
        let skeleton = draw(&rules, &word).unwrap();
        let starts = starts_m(&skeleton.segments);
        assert_eq!(starts, [0.0, 1.0, 1.5, 1.0]);
        let holds = leaf_holds(&skeleton, &starts);
        let found: Vec<(usize, f32)> = holds
            .iter()
            .map(|hold| (hold.segment.unwrap().index(), hold.along_m))
            .collect();
        assert_eq!(found, [(1, 1.5), (3, 2.0)]);
        for (hold, leaf) in holds.iter().zip(&skeleton.leaves) {
            assert!(hold.pivot.distance(leaf.base.as_vec3()) < 1e-6);
        }
    }
}
