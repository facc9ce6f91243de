//! The turtle: walks over a string of modules and leaves a skeleton behind.
//!
//! Prusinkiewicz and Lindenmayer: The Algorithmic Beauty of Plants (1990),
//! sections 1.5 (three dimensions), 1.6 (branches) and 2.4 (tropism).

use glam::DVec3;

use crate::derive::Module;
use crate::language::{Command, Rules, RulesError, command_of};
use crate::{LeafKind, LeafPose, Segment, SegmentIndex, Skeleton, Word};

/// The most branches within one another.
const MAX_DEPTH: usize = 100_000;
/// The farthest from the origin that a plant may reach, in metres.
const FARTHEST_M: f64 = 1e6;

#[derive(Clone, Copy)]
struct Turtle {
    position: DVec3,
    heading: DVec3,
    left: DVec3,
    up: DVec3,
    radius_m: f64,
    sides: u32,
    /// The width of leaves as a share of their length.
    leaf_width: f64,
    tropism: f64,
    /// What the heading bends towards, a unit vector.
    attraction: DVec3,
    segment: Option<SegmentIndex>,
    /// Whether the next segment goes on from the end of `segment`.
    continues: bool,
}

impl Turtle {
    /// At the origin, heading skyward, its left to +x and its up to -z.
    fn new(leaf_width: f64) -> Self {
        Self {
            position: DVec3::ZERO,
            heading: DVec3::Y,
            left: DVec3::X,
            up: DVec3::NEG_Z,
            radius_m: 0.01,
            sides: 6,
            leaf_width,
            tropism: 0.0,
            attraction: DVec3::Y,
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

    /// Turns the heading towards what attracts it by the tropism times the sine
    /// of the angle between them, about the axis that is square to both.
    fn bend(&mut self) {
        let axis = self.heading.cross(self.attraction);
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

/// Draws a word, from the origin upwards (y is up, metres). Modules whose symbol
/// is none of the turtle's are passed over.
///
/// # Errors
/// [`RulesError`], at the place in the rules of a module that cannot be drawn: a
/// negative length or radius, a number of sides or triangles out of range, a
/// plant that reaches beyond 1000 km.
pub fn draw(rules: &Rules, word: &Word) -> Result<Skeleton, RulesError> {
    let mut skeleton = Skeleton::default();
    let mut turtle = Turtle::new(rules.settings().leaf_width);
    let mut stack = Vec::new();
    for module in word.modules(rules) {
        let Some(command) = command_of(module.symbol) else {
            continue;
        };
        let obeyed = match command {
            Command::Push if stack.len() == MAX_DEPTH => {
                Err(format!("more than {MAX_DEPTH} branches within one another"))
            }
            Command::Push => {
                stack.push(turtle);
                turtle.continues = false;
                Ok(())
            }
            Command::Pop => {
                turtle = stack.pop().expect("brackets of a word match");
                Ok(())
            }
            _ => obey(&mut turtle, command, &module, &mut skeleton),
        };
        obeyed.map_err(|message| {
            let place = rules.templates[module.template as usize].place;
            RulesError::at(place, message)
        })?;
    }
    Ok(skeleton)
}

fn obey(
    turtle: &mut Turtle,
    command: Command,
    module: &Module<'_>,
    skeleton: &mut Skeleton,
) -> Result<(), String> {
    let parameters = module.parameters;
    match command {
        Command::Segment => {
            let radius_m = turtle.radius_m;
            draw_segment(turtle, length(parameters[0])?, radius_m, skeleton);
        }
        Command::SegmentTo => {
            let radius_m = not_negative("a radius", parameters[1])?;
            draw_segment(turtle, length(parameters[0])?, radius_m, skeleton);
        }
        Command::Move => {
            turtle.advance(length(parameters[0])?);
            turtle.continues = false;
        }
        Command::Radius => turtle.radius_m = not_negative("a radius", parameters[0])?,
        Command::Sides => turtle.sides = whole("a number of sides", parameters[0], 3, 64)?,
        Command::TurnLeft => turtle.turn(parameters[0]),
        Command::TurnRight => turtle.turn(-parameters[0]),
        Command::PitchDown => turtle.pitch_down(parameters[0]),
        Command::PitchUp => turtle.pitch_down(-parameters[0]),
        Command::RollLeft => turtle.roll_right(-parameters[0]),
        Command::RollRight => turtle.roll_right(parameters[0]),
        Command::TurnAround => turtle.turn(180.0),
        Command::Level => turtle.level(),
        Command::Tropism => {
            turtle.tropism = parameters[0];
            turtle.attraction = DVec3::Y;
        }
        Command::TropismTo => {
            let direction = DVec3::new(parameters[1], parameters[2], parameters[3]);
            turtle.tropism = parameters[0];
            turtle.attraction = direction
                .try_normalize()
                .ok_or("a tropism needs a direction with a length that is not 0")?;
        }
        Command::Leaf | Command::Crossed | Command::Blade | Command::Needle => {
            let kind = leaf_kind(command, parameters)?;
            let length_m = length(parameters[0])?;
            skeleton.leaves.push(LeafPose {
                segment: turtle.segment,
                base: turtle.position,
                along: turtle.heading,
                facing: turtle.up,
                length_m,
                width_m: turtle.leaf_width * length_m,
                kind,
            });
        }
        Command::Push | Command::Pop => {}
    }
    if turtle.position.abs().max_element() > FARTHEST_M {
        return Err("the plant reaches more than 1000 km from its foot".to_owned());
    }
    Ok(())
}

fn leaf_kind(command: Command, parameters: &[f64]) -> Result<LeafKind, String> {
    Ok(match command {
        Command::Blade => {
            let triangles = whole("a number of triangles", parameters[1], 2, 18)?;
            if triangles % 2 == 1 {
                return Err(format!(
                    "a blade has an even number of triangles, not {triangles}"
                ));
            }
            LeafKind::Blade {
                triangles: triangles as u8,
            }
        }
        Command::Crossed => LeafKind::Crossed,
        Command::Needle => LeafKind::Needle,
        _ => LeafKind::Quad,
    })
}

fn length(value: f64) -> Result<f64, String> {
    not_negative("a length", value)
}

fn not_negative(what: &str, value: f64) -> Result<f64, String> {
    match value >= 0.0 {
        true => Ok(value),
        false => Err(format!("{what} cannot be negative: {value}")),
    }
}

fn whole(what: &str, value: f64, low: u32, high: u32) -> Result<u32, String> {
    let rounded = libm::round(value);
    match (f64::from(low)..=f64::from(high)).contains(&rounded) {
        true => Ok(rounded as u32),
        false => Err(format!("{what} is {low} to {high}, not {value}")),
    }
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
    use crate::Random;

    fn drawn(word: &str) -> Result<Skeleton, RulesError> {
        let rules = Rules::parse(&format!("axiom: {word};"))?;
        let word = rules.derive(1.0, &mut Random::new(0))?;
        draw(&rules, &word)
    }

    /// Where a leaf drawn last is, and how it points and faces.
    fn pose(word: &str) -> LeafPose {
        let skeleton = drawn(&format!("{word} leaf(1)")).unwrap();
        *skeleton.leaves.last().unwrap()
    }

    fn assert_near(found: DVec3, expected: DVec3) {
        assert!(
            (found - expected).length() < 1e-14,
            "{found} is not {expected}"
        );
    }

    #[test]
    fn forward_goes_up_and_tapers() {
        let skeleton = drawn("!(0.5) F(2, 0.25) F(1, 0)").unwrap();
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
        let even = drawn("!(0.5) sides(9) F(2)").unwrap().segments[0];
        assert_eq!((even.end_radius_m, even.sides), (0.5, 9));
    }

    #[test]
    fn push_and_pop_return_to_the_fork() {
        let skeleton = drawn("F(1, 0.1) [ &(90) F(1, 0.1) ] F(1, 0.1)").unwrap();
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
        let start = pose("");
        assert_eq!((start.along, start.facing), (DVec3::Y, DVec3::NEG_Z));
        // Left is +x: a quarter turn left heads there and keeps up.
        let turned = pose("+(90)");
        assert_near(turned.along, DVec3::X);
        assert_near(turned.facing, DVec3::NEG_Z);
        // Heading for -up, the old heading becomes up.
        let pitched = pose("&(90)");
        assert_near(pitched.along, DVec3::Z);
        assert_near(pitched.facing, DVec3::Y);
        // Rolling right drops the right wing (-x): up leans to the right.
        let rolled = pose("/(90)");
        assert_near(rolled.along, DVec3::Y);
        assert_near(rolled.facing, DVec3::NEG_X);
        assert_near(pose("|").along, DVec3::NEG_Y);
    }

    #[test]
    fn opposite_rotations_undo_each_other() {
        for there_and_back in ["+(35) -(35)", "&(35) ^(35)", "/(35) \\(35)", "| |"] {
            let pose = pose(there_and_back);
            assert_near(pose.along, DVec3::Y);
            assert_near(pose.facing, DVec3::NEG_Z);
        }
    }

    #[test]
    fn levelling_faces_the_sky() {
        let level = pose("/(37) &(60) /(100) $");
        // 60 degrees from the vertical: the face leans back by 60 from the sky.
        assert!((level.along.y - 0.5).abs() < 1e-14);
        assert!((level.facing.y - 3f64.sqrt() / 2.0).abs() < 1e-14);
        assert!(level.along.dot(level.facing).abs() < 1e-14);
    }

    #[test]
    fn tropism_lifts_a_level_heading_by_its_strength() {
        let bent = pose("&(90) tropism(0.25) f(1)");
        assert_near(bent.base, DVec3::Z);
        assert_near(bent.along, DVec3::new(0.0, 0.25f64.sin(), 0.25f64.cos()));
        assert_eq!(pose("tropism(0.25) f(1)").along, DVec3::Y);
        // Towards +x instead, whatever the length of the direction.
        let aside = pose("tropism(0.25, 7, 0, 0) f(1)");
        assert_near(aside.along, DVec3::new(0.25f64.sin(), 0.25f64.cos(), 0.0));
    }

    #[test]
    fn leaves_are_of_the_kind_that_was_asked_for() {
        let leaves = drawn("leaf(1) crossed(1) blade(1, 18) needle(1)").unwrap();
        let triangles = leaves.leaves.iter().map(|leaf| leaf.kind.triangles());
        assert_eq!(triangles.collect::<Vec<_>>(), [2, 8, 18, 2]);
    }

    #[test]
    fn what_cannot_be_drawn_is_shown_in_the_rules() {
        let said = |word: &str| drawn(word).unwrap_err().to_string();
        assert_eq!(
            said("F(1) F(0 - 1)"),
            "line 1, column 13: a length cannot be negative: -1"
        );
        assert!(said("!(-0.5)").contains("a radius cannot be negative"));
        assert!(said("sides(2)").contains("a number of sides is 3 to 64, not 2"));
        assert!(said("blade(1, 20)").contains("2 to 18, not 20"));
        assert!(said("blade(1, 3)").contains("even number of triangles, not 3"));
        assert!(said("tropism(1, 0, 0, 0)").contains("direction"));
        assert!(said("f(1e7)").contains("more than 1000 km"));
    }
}
