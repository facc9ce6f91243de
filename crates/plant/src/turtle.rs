//! The turtle: walks over a string of modules and leaves a skeleton behind.
//!
//! Prusinkiewicz and Lindenmayer: The Algorithmic Beauty of Plants (1990),
//! sections 1.5 (three dimensions), 1.6 (branches) and 2.4 (tropism).

use glam::DVec3;

use crate::{LeafPose, Module, Segment, SegmentIndex, Skeleton, Symbol};

/// Why a string of modules cannot be drawn.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum TurtleError {
    /// A `]` without its `[`.
    #[error("module {position} is a ] without a [ before it")]
    UnmatchedPop {
        /// Its place in the string, from 0.
        position: usize,
    },
    /// A `[` without its `]`.
    #[error("{count} [ have no ] after them")]
    UnmatchedPush {
        /// How many.
        count: usize,
    },
    /// Too few parameters.
    #[error("module {position}, {symbol}, needs {needed} parameters")]
    MissingParameter {
        /// Its place in the string, from 0.
        position: usize,
        /// Its symbol.
        symbol: Symbol,
        /// How many it needs.
        needed: usize,
    },
    /// A parameter outside its range, or a position that became infinite.
    #[error("module {position}, {symbol}, has a parameter out of range")]
    OutOfRange {
        /// Its place in the string, from 0.
        position: usize,
        /// Its symbol.
        symbol: Symbol,
    },
}

#[derive(Clone, Copy)]
struct Turtle {
    position: DVec3,
    heading: DVec3,
    left: DVec3,
    up: DVec3,
    radius_m: f64,
    sides: u32,
    tropism: f64,
    segment: Option<SegmentIndex>,
    /// Whether the next segment goes on from the end of `segment`.
    continues: bool,
}

impl Turtle {
    /// At the origin, heading skyward, its left to +x and its up to -z.
    fn new() -> Self {
        Self {
            position: DVec3::ZERO,
            heading: DVec3::Y,
            left: DVec3::X,
            up: DVec3::NEG_Z,
            radius_m: 0.01,
            sides: 6,
            tropism: 0.0,
            segment: None,
            continues: false,
        }
    }

    fn turn(&mut self, degrees: f64) {
        (self.heading, self.left) = rotated(self.heading, self.left, degrees.to_radians());
    }

    fn pitch_down(&mut self, degrees: f64) {
        (self.up, self.heading) = rotated(self.up, self.heading, degrees.to_radians());
    }

    fn roll_right(&mut self, degrees: f64) {
        (self.up, self.left) = rotated(self.up, self.left, -degrees.to_radians());
    }

    fn level(&mut self) {
        let left = DVec3::Y.cross(self.heading);
        // A heading straight up or down has no level roll: keep the one it has.
        if left.length_squared() > 1e-12 {
            self.left = left.normalize();
            self.up = self.heading.cross(self.left);
        }
    }

    fn advance(&mut self, length_m: f64) {
        self.position += self.heading * length_m;
        self.bend();
    }

    /// Turns the heading towards the sky by the tropism times the sine of the
    /// angle between them, about the axis that is square to both.
    fn bend(&mut self) {
        let axis = self.heading.cross(DVec3::Y);
        let sine = axis.length();
        if self.tropism == 0.0 || sine < 1e-9 {
            return;
        }
        let (axis, angle_rad) = (axis / sine, self.tropism * sine);
        for direction in [&mut self.heading, &mut self.left, &mut self.up] {
            *direction = rotated_about(*direction, axis, angle_rad);
        }
    }
}

/// Two unit vectors at right angles, both turned from the first to the second.
fn rotated(first: DVec3, second: DVec3, angle_rad: f64) -> (DVec3, DVec3) {
    let (sin, cos) = libm::sincos(angle_rad);
    (first * cos + second * sin, second * cos - first * sin)
}

/// Rodrigues' rotation about a unit axis.
fn rotated_about(vector: DVec3, axis: DVec3, angle_rad: f64) -> DVec3 {
    let (sin, cos) = libm::sincos(angle_rad);
    vector * cos + axis.cross(vector) * sin + axis * (axis.dot(vector) * (1.0 - cos))
}

/// Draws a string of modules, from the origin upwards (y is up, metres).
/// Modules whose symbol is no turtle command are passed over.
///
/// # Errors
/// [`TurtleError`] names the module that cannot be drawn.
pub fn draw(modules: &[Module]) -> Result<Skeleton, TurtleError> {
    let mut skeleton = Skeleton::default();
    let mut turtle = Turtle::new();
    let mut stack = Vec::new();
    for (position, module) in modules.iter().enumerate() {
        match module.symbol() {
            Symbol::PUSH => {
                stack.push(turtle);
                turtle.continues = false;
            }
            Symbol::POP => {
                turtle = stack.pop().ok_or(TurtleError::UnmatchedPop { position })?;
            }
            _ => obey(&mut turtle, module, position, &mut skeleton)?,
        }
    }
    match stack.len() {
        0 => Ok(skeleton),
        count => Err(TurtleError::UnmatchedPush { count }),
    }
}

fn obey(
    turtle: &mut Turtle,
    module: &Module,
    position: usize,
    skeleton: &mut Skeleton,
) -> Result<(), TurtleError> {
    let symbol = module.symbol();
    let parameter = |index: usize| {
        let needed = index + 1;
        module
            .parameters()
            .get(index)
            .copied()
            .ok_or(TurtleError::MissingParameter {
                position,
                symbol,
                needed,
            })
    };
    let checked = |value: f64, in_range: bool| {
        if value.is_finite() && in_range {
            Ok(value)
        } else {
            Err(TurtleError::OutOfRange { position, symbol })
        }
    };
    let any = |index| parameter(index).and_then(|value| checked(value, true));
    let not_negative = |index| parameter(index).and_then(|value| checked(value, value >= 0.0));
    match symbol {
        Symbol::SEGMENT => {
            let end_radius_m = not_negative(1)?;
            draw_segment(turtle, not_negative(0)?, end_radius_m, skeleton);
        }
        Symbol::MOVE => {
            turtle.advance(not_negative(0)?);
            turtle.continues = false;
        }
        Symbol::RADIUS => turtle.radius_m = not_negative(0)?,
        Symbol::SIDES => {
            let sides = any(0)?;
            turtle.sides = checked(sides, (3.0..=64.0).contains(&sides))? as u32;
        }
        Symbol::TURN => turtle.turn(any(0)?),
        Symbol::PITCH => turtle.pitch_down(any(0)?),
        Symbol::ROLL => turtle.roll_right(any(0)?),
        Symbol::LEVEL => turtle.level(),
        Symbol::TROPISM => turtle.tropism = any(0)?,
        Symbol::LEAF => skeleton.leaves.push(LeafPose {
            segment: turtle.segment,
            base: turtle.position,
            along: turtle.heading,
            facing: turtle.up,
            length_m: not_negative(0)?,
        }),
        _ => {}
    }
    checked(turtle.position.length_squared(), true).map(|_| ())
}

fn draw_segment(turtle: &mut Turtle, length_m: f64, end_radius_m: f64, skeleton: &mut Skeleton) {
    let start = turtle.position;
    turtle.advance(length_m);
    let index = SegmentIndex::from_index(skeleton.segments.len());
    skeleton.segments.push(Segment {
        parent: turtle.segment,
        continues_parent: turtle.continues,
        start,
        end: turtle.position,
        start_radius_m: turtle.radius_m,
        end_radius_m,
        sides: turtle.sides,
    });
    turtle.segment = Some(index);
    turtle.continues = true;
    turtle.radius_m = end_radius_m;
}

#[cfg(test)]
mod tests {
    use super::*;

    fn m(letter: char, parameters: &[f64]) -> Module {
        Module::new(Symbol::new(letter), parameters)
    }

    /// Where a leaf drawn last is, and how it points and faces.
    fn pose(modules: &[Module]) -> LeafPose {
        let mut all = modules.to_vec();
        all.push(m('~', &[1.0]));
        *draw(&all).unwrap().leaves.last().unwrap()
    }

    fn assert_near(found: DVec3, expected: DVec3) {
        assert!(
            (found - expected).length() < 1e-14,
            "{found} is not {expected}"
        );
    }

    #[test]
    fn forward_goes_up_and_tapers() {
        let skeleton = draw(&[m('!', &[0.5]), m('F', &[2.0, 0.25]), m('F', &[1.0, 0.0])]).unwrap();
        let [first, second] = skeleton.segments[..] else {
            panic!("two segments");
        };
        assert_eq!((first.start, first.end), (DVec3::ZERO, DVec3::Y * 2.0));
        assert_eq!((first.start_radius_m, first.end_radius_m), (0.5, 0.25));
        assert_eq!((first.parent, first.continues_parent), (None, false));
        assert_eq!(second.end, DVec3::Y * 3.0);
        assert_eq!(second.start_radius_m, 0.25);
        assert_eq!(second.parent, Some(SegmentIndex::from_index(0)));
        assert!(second.continues_parent);
    }

    #[test]
    fn push_and_pop_return_to_the_fork() {
        let skeleton = draw(&[
            m('F', &[1.0, 0.1]),
            m('[', &[]),
            m('&', &[90.0]),
            m('F', &[1.0, 0.1]),
            m(']', &[]),
            m('F', &[1.0, 0.1]),
        ])
        .unwrap();
        let [_, side, top] = skeleton.segments[..] else {
            panic!("three segments");
        };
        // Pitching down from the vertical heads away from where up points: +z.
        assert_near(side.end, DVec3::new(0.0, 1.0, 1.0));
        assert_near(top.end, DVec3::Y * 2.0);
        assert_eq!(side.parent, top.parent);
        assert!(!side.continues_parent && top.continues_parent);
    }

    #[test]
    fn rotations_follow_the_right_hand() {
        let start = pose(&[]);
        assert_eq!((start.along, start.facing), (DVec3::Y, DVec3::NEG_Z));
        // Left is +x: a quarter turn left heads there and keeps up.
        let turned = pose(&[m('+', &[90.0])]);
        assert_near(turned.along, DVec3::X);
        assert_near(turned.facing, DVec3::NEG_Z);
        // Heading for -up, the old heading becomes up.
        let pitched = pose(&[m('&', &[90.0])]);
        assert_near(pitched.along, DVec3::Z);
        assert_near(pitched.facing, DVec3::Y);
        // Rolling right drops the right wing (-x): up leans to the right.
        let rolled = pose(&[m('/', &[90.0])]);
        assert_near(rolled.along, DVec3::Y);
        assert_near(rolled.facing, DVec3::NEG_X);
    }

    #[test]
    fn levelling_faces_the_sky() {
        let level = pose(&[
            m('/', &[37.0]),
            m('&', &[60.0]),
            m('/', &[100.0]),
            m('$', &[]),
        ]);
        // 60 degrees from the vertical: the face leans back by 60 from the sky.
        assert!((level.along.y - 0.5).abs() < 1e-14);
        assert!((level.facing.y - 3f64.sqrt() / 2.0).abs() < 1e-14);
        assert!(level.along.dot(level.facing).abs() < 1e-14);
    }

    #[test]
    fn tropism_lifts_a_level_heading_by_its_strength() {
        let bent = pose(&[m('&', &[90.0]), m('^', &[0.25]), m('f', &[1.0])]);
        assert_near(bent.base, DVec3::Z);
        assert_near(bent.along, DVec3::new(0.0, 0.25f64.sin(), 0.25f64.cos()));
        let upright = pose(&[m('^', &[0.25]), m('f', &[1.0])]);
        assert_eq!(upright.along, DVec3::Y);
    }

    #[test]
    fn what_cannot_be_drawn_is_named() {
        let pop = draw(&[m('[', &[]), m(']', &[]), m(']', &[])]);
        assert_eq!(pop, Err(TurtleError::UnmatchedPop { position: 2 }));
        let push = draw(&[m('[', &[])]);
        assert_eq!(push, Err(TurtleError::UnmatchedPush { count: 1 }));
        let symbol = Symbol::SEGMENT;
        let missing = TurtleError::MissingParameter {
            position: 0,
            symbol,
            needed: 2,
        };
        assert_eq!(draw(&[m('F', &[1.0])]), Err(missing));
        for bad in [[-1.0, 0.0], [f64::NAN, 0.0], [1.0, -0.5], [1e200, 0.0]] {
            let range = TurtleError::OutOfRange {
                position: 0,
                symbol,
            };
            assert_eq!(draw(&[m('F', &bad)]), Err(range));
        }
        assert!(draw(&[m('#', &[2.0])]).is_err());
    }
}
