//! Cameras that an animation moves: a path that is walked or flown, as views along it.
//!
//! An animation sampler holds times and what a property of a node is at each (glTF 2.0, 3.11 and
//! appendix C). Views stand where the camera is in the middle of equal parts of the time, so a
//! place counts for as long as the camera stays there.

use std::collections::{BTreeMap, HashMap};

use glam::{DQuat, DVec3, DVec4};
use serde_json::Value;

use super::Document;
use super::accessor::{Component, Shape};
use super::error::{At, Fault, Problem};
use super::node::Pose;
use super::property::{self, bad};

/// Views along a path where its camera does not say how many.
pub const VIEWS_OF_A_PATH: u32 = 16;

/// The most views along one path.
pub const MAX_VIEWS_OF_A_PATH: u32 = 256;

/// What an animation does to the nodes that cameras hang on.
pub(crate) struct Motion {
    channels: Vec<Channel>,
    /// From its first key to its last, in seconds.
    span: [f64; 2],
}

/// One property of a node over time.
struct Channel {
    node: usize,
    property: Property,
    interpolation: Interpolation,
    /// Rising; at least one.
    times: Vec<f64>,
    /// One for each time, or in-tangent, value and out-tangent for each; three numbers have a zero
    /// behind them.
    values: Vec<DVec4>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Property {
    Translation,
    Rotation,
    Scale,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Interpolation {
    Step,
    Linear,
    CubicSpline,
}

impl Motion {
    /// The nodes where they are in the middle of each of `count` equal parts of its time; at one
    /// place only where it takes no time.
    pub(crate) fn poses(&self, count: u32) -> Vec<HashMap<usize, Pose>> {
        let [start, end] = self.span;
        let count = if end > start { count } else { 1 };
        let time = |k: u32| start + (f64::from(k) + 0.5) / f64::from(count) * (end - start);
        (0..count).map(|k| self.pose_at(time(k))).collect()
    }

    fn pose_at(&self, time: f64) -> HashMap<usize, Pose> {
        let mut poses: HashMap<usize, Pose> = HashMap::new();
        for channel in &self.channels {
            let pose = poses.entry(channel.node).or_default();
            let value = channel.at(time);
            match channel.property {
                Property::Translation => pose.translation = Some(value.truncate().to_array()),
                Property::Rotation => pose.rotation = Some(value.to_array()),
                Property::Scale => pose.scale = Some(value.truncate().to_array()),
            }
        }
        poses
    }
}

impl Channel {
    fn at(&self, time: f64) -> DVec4 {
        let after = self.times.partition_point(|key| *key <= time);
        let last = self.times.len() - 1;
        if after == 0 || after > last {
            // Before the first key and after the last, these hold.
            return self.value(after.saturating_sub(1).min(last));
        }
        let (from, to) = (after - 1, after);
        let duration = self.times[to] - self.times[from];
        let t = (time - self.times[from]) / duration;
        match self.interpolation {
            Interpolation::Step => self.value(from),
            Interpolation::Linear => self.between(self.value(from), self.value(to), t),
            Interpolation::CubicSpline => {
                let out_of = self.values[3 * from + 2] * duration;
                let into = self.values[3 * to] * duration;
                let (t2, t3) = (t * t, t * t * t);
                let sum = self.value(from) * (2.0 * t3 - 3.0 * t2 + 1.0)
                    + out_of * (t3 - 2.0 * t2 + t)
                    + self.value(to) * (3.0 * t2 - 2.0 * t3)
                    + into * (t3 - t2);
                match self.property {
                    Property::Rotation => sum.normalize_or(DVec4::W),
                    _ => sum,
                }
            }
        }
    }

    fn value(&self, key: usize) -> DVec4 {
        match self.interpolation {
            Interpolation::CubicSpline => self.values[3 * key + 1],
            _ => self.values[key],
        }
    }

    fn between(&self, a: DVec4, b: DVec4, t: f64) -> DVec4 {
        let [qa, qb] = [a, b].map(|q| DQuat::from_vec4(q.normalize_or(DVec4::W)));
        match self.property {
            Property::Rotation => DVec4::from(qa.slerp(qb, t)),
            _ => a.lerp(b, t),
        }
    }
}

impl Document {
    /// For each of these nodes that an animation moves, itself or one above it, the first
    /// animation that does.
    pub(crate) fn motions(&self, nodes: &[usize]) -> Result<BTreeMap<usize, Motion>, Fault> {
        let animations = property::list(&self.root, "animations")?;
        if animations.is_empty() {
            return Ok(BTreeMap::new());
        }
        let parents = self.parents()?;
        let mut motions = BTreeMap::new();
        for &node in nodes {
            let line: Vec<usize> =
                std::iter::successors(Some(node), |n| parents.get(n).copied()).collect();
            for (index, animation) in animations.iter().enumerate() {
                let place = || self.place("animations", index);
                let channels = self.channels(animation, &line, &place)?;
                let keys = || channels.iter().flat_map(|channel| &channel.times);
                let span = keys().fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], t| {
                    [low.min(*t), high.max(*t)]
                });
                if !channels.is_empty() {
                    motions.insert(node, Motion { channels, span });
                    break;
                }
            }
        }
        Ok(motions)
    }

    /// The node that each node is a child of; those of the scene are no node's child twice.
    fn parents(&self) -> Result<HashMap<usize, usize>, Fault> {
        let mut parents = HashMap::new();
        for placed in self.placed_nodes()? {
            let json = property::entry(&self.root, "nodes", placed.index)?;
            for child in property::list(json, "children")? {
                parents.insert(property::list_index("children", child)?, placed.index);
            }
        }
        Ok(parents)
    }

    /// What an animation does to any of these nodes.
    fn channels(
        &self,
        animation: &Value,
        nodes: &[usize],
        place: &impl Fn() -> String,
    ) -> Result<Vec<Channel>, Fault> {
        let mut channels = Vec::new();
        for json in property::list(animation, "channels").at(place)? {
            let target = json.get("target").ok_or(Problem::Missing("target"));
            let target = target.at(place)?;
            let node = property::index(target, "node").at(place)?;
            let Some(node) = node.filter(|node| nodes.contains(node)) else {
                continue;
            };
            let (property, size) = match property::text(target, "path").at(place)? {
                Some("translation") => (Property::Translation, 3),
                Some("rotation") => (Property::Rotation, 4),
                Some("scale") => (Property::Scale, 3),
                // Weights of morph targets, and what extensions animate, move no camera.
                _ => continue,
            };
            let sampler = property::required_index(json, "sampler").at(place)?;
            let sampler = property::entry(animation, "samplers", sampler).at(place)?;
            let interpolation = match property::text(sampler, "interpolation").at(place)? {
                None | Some("LINEAR") => Interpolation::Linear,
                Some("STEP") => Interpolation::Step,
                Some("CUBICSPLINE") => Interpolation::CubicSpline,
                Some(_) => {
                    let found = &sampler["interpolation"];
                    let what = "LINEAR, STEP or CUBICSPLINE";
                    return Err(bad("interpolation", what, found)).at(place);
                }
            };
            let input = property::required_index(sampler, "input").at(place)?;
            let output = property::required_index(sampler, "output").at(place)?;
            let times = self.times(input)?;
            let values = self.values(output, size)?;
            let wanted = match interpolation {
                Interpolation::CubicSpline => 3 * times.len(),
                _ => times.len(),
            };
            if values.len() != wanted {
                return Err(Problem::BadAnimation(
                    "has another number of values than of times",
                ))
                .at(place);
            }
            channels.push(Channel {
                node,
                property,
                interpolation,
                times,
                values,
            });
        }
        Ok(channels)
    }

    /// The times of keys, in seconds.
    fn times(&self, accessor: usize) -> Result<Vec<f64>, Fault> {
        let place = || self.place("accessors", accessor);
        let elements = self.elements(accessor)?;
        let is_time = elements.accessor.shape == Shape::Scalar
            && elements.accessor.component == Component::F32;
        if !is_time {
            return Err(Problem::BadAnimation(
                "has times that are not SCALAR of FLOAT",
            ))
            .at(place);
        }
        let times: Vec<f64> = elements.vectors::<1>().map(|[time]| time).collect();
        let is_rising = times.windows(2).all(|pair| pair[0] < pair[1]);
        if times.is_empty() || !is_rising || !times.iter().all(|time| time.is_finite()) {
            return Err(Problem::BadAnimation("has times that do not rise")).at(place);
        }
        Ok(times)
    }

    /// Values of keys of three or four numbers.
    fn values(&self, accessor: usize, size: usize) -> Result<Vec<DVec4>, Fault> {
        let place = || self.place("accessors", accessor);
        let elements = self.elements(accessor)?;
        if elements.accessor.shape != Shape::Vector(size) {
            let what = "has values of another kind than what they move";
            return Err(Problem::BadAnimation(what)).at(place);
        }
        let values: Vec<DVec4> = match size {
            3 => {
                let vectors = elements.vectors::<3>();
                vectors.map(|v| DVec3::from_array(v).extend(0.0)).collect()
            }
            _ => elements.vectors::<4>().map(DVec4::from_array).collect(),
        };
        match values.iter().all(|value| value.is_finite()) {
            true => Ok(values),
            false => Err(Problem::BadAnimation("has a value that is not finite")).at(place),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn channel(property: Property, interpolation: Interpolation, values: &[[f64; 4]]) -> Channel {
        let times = match interpolation {
            Interpolation::CubicSpline => values.len() / 3,
            _ => values.len(),
        };
        Channel {
            node: 0,
            property,
            interpolation,
            times: (0..times).map(|k| 2.0 * k as f64).collect(),
            values: values.iter().map(|v| DVec4::from_array(*v)).collect(),
        }
    }

    #[test]
    fn keys_hold_and_what_is_between_follows_the_interpolation() {
        let (a, b) = ([1.0, 0.0, 0.0, 0.0], [5.0, 0.0, 4.0, 0.0]);
        let x = |channel: &Channel, time: f64| channel.at(time).x;
        let linear = channel(Property::Translation, Interpolation::Linear, &[a, b]);
        let at = [-1.0, 0.0, 0.5, 2.0, 9.0].map(|time| x(&linear, time));
        assert_eq!(at, [1.0, 1.0, 2.0, 5.0, 5.0]);
        let step = channel(Property::Translation, Interpolation::Step, &[a, b]);
        assert_eq!([0.0, 1.9, 2.0].map(|time| x(&step, time)), [1.0, 1.0, 5.0]);
        // Tangents of the straight line make it one.
        let slope = [2.0, 0.0, 2.0, 0.0];
        let keys = [slope, a, slope, slope, b, slope];
        let cubic = channel(Property::Translation, Interpolation::CubicSpline, &keys);
        for time in [0.0, 0.5, 1.3, 2.0] {
            assert!(
                (cubic.at(time) - linear.at(time)).length() < 1e-12,
                "{time}"
            );
        }
        // Flat ends leave late: after a quarter of the time 3 t^2 - 2 t^3 = 5/32 of the way.
        let flat = [0.0; 4];
        let keys = [flat, a, flat, flat, b, flat];
        let eased = channel(Property::Translation, Interpolation::CubicSpline, &keys);
        assert_eq!(x(&eased, 0.5), 1.0 + 4.0 * 0.15625);
    }

    #[test]
    fn turns_go_the_shorter_way_round() {
        let half = 0.5f64.sqrt();
        let (none, quarter) = ([0.0, 0.0, 0.0, -1.0], [0.0, half, 0.0, half]);
        let turning = channel(Property::Rotation, Interpolation::Linear, &[none, quarter]);
        let turned = DQuat::from_vec4(turning.at(1.0)).mul_vec3(DVec3::NEG_Z);
        // An eighth of a turn about y.
        assert!(
            (turned - DVec3::new(-half, 0.0, -half)).length() < 1e-12,
            "{turned}"
        );
    }

    #[test]
    fn views_stand_in_the_middle_of_equal_times() {
        let values = [[0.0; 4], [8.0, 0.0, 0.0, 0.0]];
        let channels = vec![channel(
            Property::Translation,
            Interpolation::Linear,
            &values,
        )];
        let motion = Motion {
            channels,
            span: [0.0, 2.0],
        };
        let xs: Vec<f64> = motion
            .poses(4)
            .iter()
            .map(|poses| poses[&0].translation.unwrap()[0])
            .collect();
        assert_eq!(xs, [1.0, 3.0, 5.0, 7.0]);
        let still = Motion {
            span: [1.0, 1.0],
            ..motion
        };
        assert_eq!(still.poses(4).len(), 1);
    }
}
