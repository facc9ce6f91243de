//! The rules of the oak: a trunk that bears limbs, limbs that bear branches,
//! branches that bear twigs, twigs that bear leaves.
//!
//! In the notation of L-systems, `i` counting the nodes of an axis of `n`:
//!
//! ```text
//! T(i, phase)             -> + & F T(i + 1, phase + 137.5)                      in the bole
//! T(i, phase)             -> + & F [ / & L(0, length, radius, p) ] T(i + 1, phase + 137.5)
//! L(i, length, radius, p) -> + & F [ / & B(0, length', radius', 0) ] L(i + 1, ...)
//! B(i, length, radius, p) -> + & F [ / & W(length') ] B(i + 1, ...)
//! W(length)               -> F [ / & $ / ~ ]... F [ / & $ / ~ ]...
//! ```

use crate::{LSystem, Module, Predecessor, Production, Random, Symbol};

const TRUNK: Symbol = Symbol::new('T');
const LIMB: Symbol = Symbol::new('L');
const BRANCH: Symbol = Symbol::new('B');
const TWIG: Symbol = Symbol::new('W');

/// The angle between one bud and the next around an axis, in degrees.
const GOLDEN_ANGLE: f64 = 137.508;
const TRUNK_NODES: u32 = 25;
const TRUNK_LENGTH_M: f64 = 5.9;
const TRUNK_RADIUS_M: f64 = 0.20;
/// The share of the trunk below the first limb.
const BOLE: f64 = 0.24;
/// The share of the trunk up to where two limbs may share a node.
const LOW_CROWN: f64 = 0.55;
/// The outline that limbs reach for: an ellipsoid on the trunk's axis.
const CROWN_CENTRE_M: f64 = 4.25;
const CROWN_HALF_HEIGHT_M: f64 = 3.5;
const CROWN_HALF_WIDTH_M: f64 = 3.4;
/// The height of the trunk's widened foot.
const FLARE_M: f64 = 0.3;
/// How far a limb bends up over its length, in radians at most.
const LIMB_TROPISM: f64 = 0.62;
/// By how much a limb's end is steeper, seen from its start, than its first step.
const LIMB_LIFT_DEGREES: f64 = 13.0;
const BRANCH_TROPISM: f64 = 0.3;
/// How many leaves an oak has at fineness 1, within a few per cent.
pub(crate) const LEAVES_AT_FINENESS_1: f64 = 5900.0;
/// The power of the fineness that leaves grow with: limbs and branches each
/// divide by it.
pub(crate) const LEAVES_EXPONENT: f64 = 2.0;
/// More derivation steps than the longest path of nodes, at any fineness.
pub(crate) const ITERATIONS: u32 = 1000;
/// More than the most leaves that may be asked for need.
const MAX_MODULES: usize = 24_000_000;

/// How finely an oak is divided. The tree keeps its size.
#[derive(Clone, Copy, Debug)]
pub(crate) struct OakDetail {
    /// Multiplies the nodes of limbs and branches and the leaves of twigs; at 1
    /// an oak has about 4,000 leaves.
    pub(crate) fineness: f64,
    /// The mean length of a leaf, in metres.
    pub(crate) leaf_length_m: f64,
}

impl OakDetail {
    fn count(self, at_fineness_1: f64) -> u32 {
        libm::round(at_fineness_1 * self.fineness).max(1.0) as u32
    }
}

/// The L-system of an oak.
pub(crate) fn oak(detail: OakDetail) -> LSystem {
    LSystem {
        axiom: axiom(),
        productions: vec![
            Production::new(TRUNK, move |p, random, out| {
                grow_trunk(detail, 0, p, random, out)
            })
            .when(|p| along_trunk(p) < BOLE),
            Production::new(TRUNK, move |p, random, out| {
                grow_trunk(detail, 1, p, random, out)
            })
            .when(|p| along_trunk(p) >= BOLE && node_of(p) < TRUNK_NODES),
            Production::new(TRUNK, move |p, random, out| {
                grow_trunk(detail, 2, p, random, out)
            })
            .when(|p| (BOLE..LOW_CROWN).contains(&along_trunk(p)))
            .with_weight(0.8),
            Production::new(TRUNK, move |_, random, out| {
                fork(detail, random, out, 1.1, 0.026)
            })
            .when(|p| node_of(p) >= TRUNK_NODES),
            Production::new(LIMB, move |p, random, out| {
                grow_limb(detail, p, random, out)
            })
            .when(move |p| node_of(p) < limb_nodes(detail, p.parameters[1])),
            Production::new(LIMB, move |p, random, out| end_limb(detail, p, random, out))
                .when(move |p| node_of(p) >= limb_nodes(detail, p.parameters[1])),
            Production::new(BRANCH, move |p, random, out| {
                grow_branch(detail, p, random, out)
            }),
            Production::new(TWIG, move |p, random, out| {
                grow_twig(detail, p, random, out)
            }),
        ],
        max_modules: MAX_MODULES,
    }
}

fn limb_nodes(detail: OakDetail, length_m: f64) -> u32 {
    detail.count(1.5 + 3.3 * length_m)
}

fn branch_nodes(detail: OakDetail, length_m: f64) -> u32 {
    detail.count(2.2 + 3.2 * length_m)
}

fn node_of(p: Predecessor<'_>) -> u32 {
    p.parameters[0] as u32
}

fn put(out: &mut Vec<Module>, symbol: Symbol, parameters: &[f64]) {
    out.push(Module::new(symbol, parameters));
}

fn axiom() -> Vec<Module> {
    let flare = TRUNK_RADIUS_M * 1.55;
    vec![
        Module::new(Symbol::SIDES, &[14.0]),
        Module::new(Symbol::RADIUS, &[flare]),
        Module::new(Symbol::SEGMENT, &[0.35 * FLARE_M, TRUNK_RADIUS_M * 1.25]),
        Module::new(Symbol::SEGMENT, &[0.65 * FLARE_M, TRUNK_RADIUS_M * 1.06]),
        Module::new(TRUNK, &[0.0, 0.0]),
    ]
}

/// One crooked step along an axis.
fn step(random: &mut Random, out: &mut Vec<Module>, crook: f64, length_m: f64, end_radius_m: f64) {
    put(out, Symbol::TURN, &[random.normal(0.0, crook)]);
    put(out, Symbol::PITCH, &[random.normal(0.0, crook)]);
    put(out, Symbol::SEGMENT, &[length_m, end_radius_m]);
}

/// A side shoot: it leaves its axis at `angle` degrees, turned by `phase` about it.
#[derive(Clone, Copy)]
struct Shoot {
    phase: f64,
    angle: f64,
    sides: f64,
    radius_m: f64,
    tropism: f64,
}

fn shoot(out: &mut Vec<Module>, shoot: Shoot, bud: Module) {
    put(out, Symbol::PUSH, &[]);
    put(out, Symbol::ROLL, &[shoot.phase]);
    put(out, Symbol::PITCH, &[shoot.angle]);
    put(out, Symbol::SIDES, &[shoot.sides]);
    put(out, Symbol::RADIUS, &[shoot.radius_m]);
    put(out, Symbol::TROPISM, &[shoot.tropism]);
    out.push(bud);
    put(out, Symbol::POP, &[]);
}

fn trunk_radius_m(along: f64) -> f64 {
    TRUNK_RADIUS_M * (1.0 - 0.88 * libm::pow(along, 0.9))
}

/// How far it is from the trunk's axis at a height to the crown's outline, at
/// this angle from the vertical.
fn reach_m(height_m: f64, angle_degrees: f64) -> f64 {
    let (sin, cos) = libm::sincos(angle_degrees.to_radians());
    let height = (height_m - CROWN_CENTRE_M) / CROWN_HALF_HEIGHT_M;
    let (rise, aside) = (cos / CROWN_HALF_HEIGHT_M, sin / CROWN_HALF_WIDTH_M);
    // (aside d)^2 + (height + rise d)^2 = 1 for the distance d.
    let (a, b, c) = (
        aside * aside + rise * rise,
        rise * height,
        height * height - 1.0,
    );
    (libm::sqrt((b * b - a * c).max(0.0)) - b) / a
}

/// Where the next node of the trunk is, as a share of its length.
fn along_trunk(p: Predecessor<'_>) -> f64 {
    f64::from(node_of(p) + 1) / f64::from(TRUNK_NODES)
}

fn grow_trunk(
    detail: OakDetail,
    limbs: u32,
    p: Predecessor<'_>,
    random: &mut Random,
    out: &mut Vec<Module>,
) {
    let (along, phase) = (along_trunk(p), p.parameters[1]);
    let crook = if limbs == 0 { 1.6 } else { 4.8 };
    put(out, Symbol::TROPISM, &[0.25]);
    step(
        random,
        out,
        crook,
        TRUNK_LENGTH_M / f64::from(TRUNK_NODES),
        trunk_radius_m(along),
    );
    for limb in 0..limbs {
        bear_limb(detail, along, phase + 165.0 * f64::from(limb), random, out);
    }
    let next_phase = phase + GOLDEN_ANGLE + random.normal(0.0, 12.0);
    put(out, TRUNK, &[f64::from(node_of(p) + 1), next_phase]);
}

fn bear_limb(
    detail: OakDetail,
    along: f64,
    phase: f64,
    random: &mut Random,
    out: &mut Vec<Module>,
) {
    let along_crown = (along - BOLE) / (1.0 - BOLE);
    let angle = 74.0 - 28.0 * along_crown + random.normal(0.0, 6.0);
    let reach_m = reach_m(FLARE_M + along * TRUNK_LENGTH_M, angle - LIMB_LIFT_DEGREES);
    let length_m = 0.84 * reach_m * random.between(0.86, 1.06);
    let limb = Shoot {
        phase,
        angle,
        sides: 8.0,
        radius_m: (0.022 * length_m).min(0.6 * trunk_radius_m(along)),
        tropism: LIMB_TROPISM / f64::from(limb_nodes(detail, length_m)),
    };
    let first_phase = random.between(0.0, 360.0);
    shoot(
        out,
        limb,
        Module::new(LIMB, &[0.0, length_m, limb.radius_m, first_phase]),
    );
}

/// The end of a leading axis: it goes on as a branch beside two others.
fn fork(
    detail: OakDetail,
    random: &mut Random,
    out: &mut Vec<Module>,
    length_m: f64,
    radius_m: f64,
) {
    let turn = random.between(0.0, 360.0);
    for (part, angle) in [(0.0, 8.0), (1.0, 34.0), (2.0, 40.0)] {
        let length_m = length_m * random.between(0.8, 1.05);
        let branch = Shoot {
            phase: turn + part * GOLDEN_ANGLE,
            angle: angle + random.normal(0.0, 5.0),
            sides: 5.0,
            radius_m: radius_m * (1.0 - 0.15 * part),
            tropism: BRANCH_TROPISM / f64::from(branch_nodes(detail, length_m)),
        };
        let bud = Module::new(BRANCH, &[0.0, length_m, branch.radius_m, branch.phase]);
        shoot(out, branch, bud);
    }
}

fn grow_limb(detail: OakDetail, p: Predecessor<'_>, random: &mut Random, out: &mut Vec<Module>) {
    let &[_, length_m, radius_m, phase] = p.parameters else {
        return;
    };
    let nodes = f64::from(limb_nodes(detail, length_m));
    let node = node_of(p);
    let along = f64::from(node + 1) / nodes;
    let radius_here_m = radius_m * (1.0 - 0.72 * along);
    step(
        random,
        out,
        23.0 / libm::sqrt(nodes),
        length_m / nodes,
        radius_here_m,
    );
    if along > 0.25 {
        let full_m = (0.42 + 0.33 * length_m) * (1.05 - 0.42 * along);
        let length_m = full_m * random.between(0.8, 1.15);
        let branch = Shoot {
            phase,
            angle: random.normal(52.0, 8.0),
            sides: 5.0,
            radius_m: (0.013 * length_m + 0.002).min(0.7 * radius_here_m),
            tropism: BRANCH_TROPISM / f64::from(branch_nodes(detail, length_m)),
        };
        let bud = Module::new(BRANCH, &[0.0, length_m, branch.radius_m, phase]);
        shoot(out, branch, bud);
    }
    let next_phase = phase + GOLDEN_ANGLE + random.normal(0.0, 14.0);
    put(
        out,
        LIMB,
        &[f64::from(node + 1), length_m, radius_m, next_phase],
    );
}

fn end_limb(detail: OakDetail, p: Predecessor<'_>, random: &mut Random, out: &mut Vec<Module>) {
    let (length_m, radius_m) = (p.parameters[1], p.parameters[2]);
    fork(detail, random, out, 0.3 + 0.2 * length_m, 0.28 * radius_m);
}

fn grow_branch(detail: OakDetail, p: Predecessor<'_>, random: &mut Random, out: &mut Vec<Module>) {
    let &[_, length_m, radius_m, phase] = p.parameters else {
        return;
    };
    let nodes = f64::from(branch_nodes(detail, length_m));
    let node = node_of(p);
    let along = f64::from(node + 1) / nodes;
    let radius_here_m = radius_m * (1.0 - 0.8 * along);
    step(
        random,
        out,
        24.0 / libm::sqrt(nodes),
        length_m / nodes,
        radius_here_m,
    );
    let ends = f64::from(node + 1) >= nodes;
    if along > 0.3 {
        let twig = Shoot {
            phase,
            angle: if ends { 12.0 } else { random.normal(50.0, 9.0) },
            sides: 3.0,
            radius_m: (0.8 * radius_here_m).min(0.007),
            tropism: 0.1,
        };
        shoot(out, twig, Module::new(TWIG, &[random.between(0.24, 0.42)]));
    }
    if !ends {
        let next_phase = phase + GOLDEN_ANGLE + random.normal(0.0, 14.0);
        put(
            out,
            BRANCH,
            &[f64::from(node + 1), length_m, radius_m, next_phase],
        );
    }
}

/// Oak leaves crowd at the end of a twig.
fn grow_twig(detail: OakDetail, p: Predecessor<'_>, random: &mut Random, out: &mut Vec<Module>) {
    let length_m = p.parameters[0];
    let leaves = libm::round(5.0 * libm::pow(detail.fineness, 0.25)) as u32;
    let below = leaves / 3;
    let phase = random.between(0.0, 360.0);
    step(random, out, 6.0, 0.55 * length_m, 0.004);
    for leaf in 0..leaves {
        if leaf == below {
            step(random, out, 8.0, 0.45 * length_m, 0.0);
        }
        let spread = if leaf < below { 62.0 } else { 46.0 };
        let turn = phase + f64::from(leaf) * GOLDEN_ANGLE;
        grow_leaf(detail, turn, spread, random, out);
    }
}

fn grow_leaf(
    detail: OakDetail,
    phase: f64,
    spread: f64,
    random: &mut Random,
    out: &mut Vec<Module>,
) {
    put(out, Symbol::PUSH, &[]);
    put(out, Symbol::ROLL, &[phase]);
    put(out, Symbol::PITCH, &[random.normal(spread, 12.0)]);
    put(out, Symbol::LEVEL, &[]);
    put(out, Symbol::ROLL, &[random.normal(0.0, 28.0)]);
    put(
        out,
        Symbol::LEAF,
        &[detail.leaf_length_m * random.between(0.78, 1.22)],
    );
    put(out, Symbol::POP, &[]);
}
