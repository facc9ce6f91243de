//! The rules of the oak: a trunk that bears limbs, limbs that bear branches,
//! branches that bear twigs, twigs that bear leaves.
//!
//! In the notation of L-systems, `i` counting the nodes of an axis of `n`:
//!
//! ```text
//! T(i, phase)             -> + & F [ / & L(0, length, radius, 0) ] T(i + 1, phase + 137.5)
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
const TRUNK_NODES: u32 = 18;
const TRUNK_LENGTH_M: f64 = 6.3;
const TRUNK_RADIUS_M: f64 = 0.19;
/// The share of the trunk below the first limb.
const BOLE: f64 = 0.26;
const LONGEST_LIMB_M: f64 = 3.0;
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
            Production::new(TRUNK, grow_trunk).when(|p| node_of(p) < TRUNK_NODES),
            Production::new(TRUNK, |_, random, out| fork(random, out, 0.9, 0.03))
                .when(|p| node_of(p) >= TRUNK_NODES),
            Production::new(LIMB, move |p, random, out| grow_limb(detail, p, random, out))
                .when(move |p| node_of(p) < limb_nodes(detail)),
            Production::new(LIMB, end_limb).when(move |p| node_of(p) >= limb_nodes(detail)),
            Production::new(BRANCH, move |p, random, out| grow_branch(detail, p, random, out)),
            Production::new(TWIG, move |p, random, out| grow_twig(detail, p, random, out)),
        ],
        max_modules: MAX_MODULES,
    }
}

fn limb_nodes(detail: OakDetail) -> u32 {
    detail.count(10.0)
}

fn branch_nodes(detail: OakDetail) -> u32 {
    detail.count(6.0)
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
        Module::new(Symbol::SEGMENT, &[0.1, TRUNK_RADIUS_M * 1.25]),
        Module::new(Symbol::SEGMENT, &[0.2, TRUNK_RADIUS_M * 1.06]),
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

/// Limbs reach for the outline of a dome that is widest below its middle.
fn limb_length_m(along_crown: f64) -> f64 {
    let from_widest = (along_crown - 0.22) / 0.92;
    LONGEST_LIMB_M * libm::sqrt((1.0 - from_widest * from_widest).max(0.0))
}

fn grow_trunk(p: Predecessor<'_>, random: &mut Random, out: &mut Vec<Module>) {
    let (node, phase) = (node_of(p), p.parameters[1]);
    let along = f64::from(node + 1) / f64::from(TRUNK_NODES);
    let radius_m = trunk_radius_m(along);
    let crook = if along < BOLE { 2.0 } else { 6.5 };
    put(out, Symbol::TROPISM, &[0.25]);
    step(random, out, crook, TRUNK_LENGTH_M / f64::from(TRUNK_NODES), radius_m);
    if along >= BOLE {
        let along_crown = (along - BOLE) / (1.0 - BOLE);
        let length_m = limb_length_m(along_crown) * random.between(0.85, 1.1);
        let limb = Shoot {
            phase,
            angle: 82.0 - 44.0 * along_crown + random.normal(0.0, 6.0),
            sides: 8.0,
            radius_m: (0.026 * length_m).min(0.62 * radius_m),
            tropism: 0.085,
        };
        let bud = Module::new(LIMB, &[0.0, length_m, limb.radius_m, random.between(0.0, 360.0)]);
        shoot(out, limb, bud);
    }
    let next_phase = phase + GOLDEN_ANGLE + random.normal(0.0, 12.0);
    put(out, TRUNK, &[f64::from(node + 1), next_phase]);
}

/// The end of a leading axis: it goes on as a branch beside two others.
fn fork(random: &mut Random, out: &mut Vec<Module>, length_m: f64, radius_m: f64) {
    let turn = random.between(0.0, 360.0);
    for (part, angle) in [(0.0, 8.0), (1.0, 34.0), (2.0, 40.0)] {
        let branch = Shoot {
            phase: turn + part * GOLDEN_ANGLE,
            angle: angle + random.normal(0.0, 5.0),
            sides: 5.0,
            radius_m: radius_m * (1.0 - 0.15 * part),
            tropism: 0.05,
        };
        let length_m = length_m * random.between(0.8, 1.05);
        let bud = Module::new(BRANCH, &[0.0, length_m, branch.radius_m, branch.phase]);
        shoot(out, branch, bud);
    }
}

fn grow_limb(detail: OakDetail, p: Predecessor<'_>, random: &mut Random, out: &mut Vec<Module>) {
    let &[_, length_m, radius_m, phase] = p.parameters else {
        return;
    };
    let nodes = f64::from(limb_nodes(detail));
    let node = node_of(p);
    let along = f64::from(node + 1) / nodes;
    let radius_here_m = radius_m * (1.0 - 0.72 * along);
    step(random, out, 26.0 / libm::sqrt(nodes), length_m / nodes, radius_here_m);
    if along > 0.25 {
        let branch_length_m = (0.30 + 0.30 * length_m) * (1.05 - 0.45 * along);
        let branch = Shoot {
            phase,
            angle: random.normal(52.0, 8.0),
            sides: 5.0,
            radius_m: (0.014 * branch_length_m + 0.002).min(0.7 * radius_here_m),
            tropism: 0.06,
        };
        let length_m = branch_length_m * random.between(0.8, 1.15);
        let bud = Module::new(BRANCH, &[0.0, length_m, branch.radius_m, phase]);
        shoot(out, branch, bud);
    }
    let next_phase = phase + GOLDEN_ANGLE + random.normal(0.0, 14.0);
    put(out, LIMB, &[f64::from(node + 1), length_m, radius_m, next_phase]);
}

fn end_limb(p: Predecessor<'_>, random: &mut Random, out: &mut Vec<Module>) {
    let (length_m, radius_m) = (p.parameters[1], p.parameters[2]);
    fork(random, out, 0.18 + 0.2 * length_m, 0.28 * radius_m);
}

fn grow_branch(detail: OakDetail, p: Predecessor<'_>, random: &mut Random, out: &mut Vec<Module>) {
    let &[_, length_m, radius_m, phase] = p.parameters else {
        return;
    };
    let nodes = f64::from(branch_nodes(detail));
    let node = node_of(p);
    let along = f64::from(node + 1) / nodes;
    let radius_here_m = radius_m * (1.0 - 0.8 * along);
    step(random, out, 24.0 / libm::sqrt(nodes), length_m / nodes, radius_here_m);
    let ends = node + 1 >= branch_nodes(detail);
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
        put(out, BRANCH, &[f64::from(node + 1), length_m, radius_m, next_phase]);
    }
}

/// Oak leaves crowd at the end of a twig.
fn grow_twig(detail: OakDetail, p: Predecessor<'_>, random: &mut Random, out: &mut Vec<Module>) {
    let length_m = p.parameters[0];
    let leaves = detail.count(6.0);
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
    put(out, Symbol::LEAF, &[detail.leaf_length_m * random.between(0.78, 1.22)]);
    put(out, Symbol::POP, &[]);
}
