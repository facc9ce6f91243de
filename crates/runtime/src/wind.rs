//! How a plant sways, the original and every level alike.
//!
//! A vertex hangs on a point of the wood's axis, its pivot ([`Hold`]): `secateur grow` writes it as
//! vertex attributes, and every level keeps them. The wood moves by where it is and how far along it
//! a point is, so what hangs on one point moves together, a branch and the twig on it, a leaf and its
//! twig. A leaf turns about its pivot besides. So the motion of a leaf is a rigid one that depends on
//! what it hangs on and not on its vertices: a leaf that has grown, or is made of fewer triangles, makes
//! the very motion of the original.
//!
//! The shader is `wind.wgsl` of `secateur-shaders` (`wind.glsl` for GLSL). Waves are integers and the
//! motion of the wood is products only: both twins agree on them bit for bit, and on positions but
//! for how the last sum is rounded.

use glam::{DVec2, IVec2, IVec3, Vec2, Vec3};
use secateur_model::{Hold, SegmentIndex};

/// The height of a wave.
const UNIT: i32 = 16_384;
/// What a unit vector of integers has.
const UNIT_TOWARD: f64 = 256.0;
/// The most that [`Wind::new`] makes of the wave sums, in [`UNIT`]s: the lean, the gusts, the shiver.
const MOST_WAVES: f64 = 5.0;

/// A wind, as the shader has it.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Wind {
    /// Where it blows to, x and z, a unit vector in 1/256.
    pub toward: IVec2,
    /// What leaves turn about, x and z, a unit vector.
    pub axis: Vec2,
    /// The time in 1/65536 turns of the slow wave; it may wrap.
    pub turns: u32,
    /// How far wood moves, in metres for each square metre along it, by 16384 and by 256.
    pub bend: f32,
    /// The tangent of half the angle by which a leaf turns at most, by 16384; 0 to draw wood.
    pub flutter: f32,
}

impl Wind {
    /// A wind that blows to `toward` (x and z), moves what is `along_m` metres along the wood by at
    /// most `bend_m`, and turns leaves by at most `flutter_degrees`, less than 180.
    ///
    /// # Panics
    /// If `toward` has no length, or `along_m` is not positive.
    pub fn new(toward: DVec2, along_m: f64, bend_m: f64, flutter_degrees: f64) -> Self {
        let unit = toward.try_normalize().expect("a direction has a length");
        assert!(along_m > 0.0, "{along_m} m along the wood");
        let waves = MOST_WAVES * f64::from(UNIT) * UNIT_TOWARD;
        Self {
            toward: (unit * UNIT_TOWARD).round().as_ivec2(),
            // A leaf to the lee of its pivot goes down first.
            axis: DVec2::new(unit.y, -unit.x).as_vec2(),
            turns: 0,
            bend: (bend_m / (along_m * along_m * waves)) as f32,
            flutter: ((0.5 * flutter_degrees.to_radians()).tan() / f64::from(UNIT)) as f32,
        }
    }

    /// This wind at a time: a gust takes `gust_s` seconds to pass.
    #[must_use]
    pub fn at(self, seconds: f64, gust_s: f64) -> Self {
        let turns = (seconds / gust_s).rem_euclid(65_536.0) * 65_536.0;
        Self {
            turns: turns as u32,
            ..self
        }
    }

    /// This wind for wood, which does not turn about itself.
    #[must_use]
    pub fn for_wood(self) -> Self {
        Self {
            flutter: 0.0,
            ..self
        }
    }

    fn downwind(&self, at: IVec3) -> u32 {
        ((self.toward.x * at.x + self.toward.y * at.z) >> 8) as u32
    }

    /// How far a point of the wood moves, in metres: the twin of `bend` of the shader.
    pub fn bend(&self, hold: &Hold) -> Vec3 {
        let at = self.downwind(cells(hold.pivot));
        let gust = wave(self.turns.wrapping_sub(at));
        let shiver = wave((3u32.wrapping_mul(self.turns)).wrapping_sub(8u32.wrapping_mul(at)));
        let along = hold.along_m;
        let amount = (2 * UNIT + 2 * gust + shiver) as f32 * (self.bend * (along * along));
        Vec3::new(
            amount * self.toward.x as f32,
            0.0,
            amount * self.toward.y as f32,
        )
    }

    /// The tangent of half the angle by which a leaf turns: the twin of `half_turn` of the shader.
    pub fn half_turn(&self, hold: &Hold) -> f32 {
        let at = cells(hold.pivot);
        let own = number(hold)
            .wrapping_mul(0x9e37_79b1)
            .wrapping_add((at.x as u32).wrapping_mul(0x85eb_ca77))
            .wrapping_add((at.y as u32).wrapping_mul(0xc2b2_ae3d))
            .wrapping_add((at.z as u32).wrapping_mul(0x27d4_eb2f));
        let turns = 7u32.wrapping_mul(self.turns).wrapping_add(own >> 16);
        wave(turns) as f32 * self.flutter
    }

    /// Where a vertex is that hangs there, in metres: the twin of `swayed` of the shader.
    pub fn swayed(&self, position: Vec3, hold: &Hold) -> Vec3 {
        let arm = position - hold.pivot;
        let h = self.half_turn(hold);
        let axis = Vec3::new(self.axis.x, 0.0, self.axis.y);
        let across = axis.cross(arm);
        let turn = (2.0 / (1.0 + h * h)) * (h * across + h * h * axis.cross(across));
        hold.pivot + self.bend(hold) + (arm + turn)
    }
}

/// The number of what a vertex hangs on, as the attribute `_WIND_SEGMENT` has it.
fn number(hold: &Hold) -> u32 {
    hold.segment.map_or(0, |segment| segment.index() as u32 + 1)
}

/// How many words a vertex's hold takes in pages and streams.
pub const HOLD_WORDS: usize = 5;

/// What a vertex hangs on that hangs on nothing.
pub const NOTHING: Hold = Hold {
    segment: None,
    pivot: Vec3::ZERO,
    along_m: 0.0,
};

/// A hold as pages and streams have it: the bits of the pivot and of the distance along the wood as
/// f32, and the number of what it hangs on.
pub fn hold_words(hold: &Hold) -> [u32; HOLD_WORDS] {
    let [x, y, z] = hold.pivot.to_array().map(f32::to_bits);
    [x, y, z, hold.along_m.to_bits(), number(hold)]
}

/// The hold of such words; none where one is not finite.
pub fn hold_of([x, y, z, along, number]: [u32; HOLD_WORDS]) -> Option<Hold> {
    let hold = Hold {
        segment: number
            .checked_sub(1)
            .map(|index| SegmentIndex::from_index(index as usize)),
        pivot: Vec3::from_array([x, y, z].map(f32::from_bits)),
        along_m: f32::from_bits(along),
    };
    (hold.pivot.is_finite() && hold.along_m.is_finite()).then_some(hold)
}

/// From -[`UNIT`] to [`UNIT`] in 65,536 steps a turn: two parabolas.
fn wave(turns: u32) -> i32 {
    let half = (turns & 0x7fff) as i32;
    let height = (half * (32_768 - half)) >> 14;
    match turns & 0x8000 {
        0 => height,
        _ => -height,
    }
}

/// A point in 1/1024 m.
fn cells(point: Vec3) -> IVec3 {
    let near = point.clamp(Vec3::splat(-1000.0), Vec3::splat(1000.0));
    (near * 1024.0).floor().as_ivec3()
}

#[cfg(test)]
mod tests;
