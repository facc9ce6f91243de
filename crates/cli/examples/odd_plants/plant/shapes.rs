//! Where leaves are, and what leaves and wood are made of.

use std::f64::consts::TAU;

use secateur::glam::DVec3;
use secateur_plant::Random;

/// A triangle, and its texture coordinates.
pub(crate) type Triangle = ([DVec3; 3], [[f64; 2]; 3]);

#[derive(Clone, Copy, Debug)]
pub(crate) enum Place {
    Crown,
    Flat,
    Wall,
    Line,
    /// Cards side by side, which share their edges: one piece.
    Joined,
    Column,
    OnePoint,
    FarApart,
}

#[derive(Clone, Copy, Debug)]
pub(crate) enum Direction {
    Any,
    Up,
    Front,
}

#[derive(Clone, Copy, Debug)]
pub(crate) enum Leaf {
    Card,
    Triangle,
    Cross,
    Sliver,
    Sheet,
    Soup,
    NoArea,
}

#[derive(Clone, Copy, Debug)]
pub(crate) enum Wood {
    None,
    Trunk,
    ThinTrunk,
    Pot,
    Ground,
    Triangle,
    Soup,
    OnePoint,
}

/// The side of a leaf.
const SIDE: f64 = 0.3;

pub(crate) fn place_of(place: Place, index: usize, random: &mut Random) -> DVec3 {
    let k = index as f64;
    let [x, y, z] = [(); 3].map(|()| random.between(-1.0, 1.0));
    match place {
        Place::Crown => DVec3::new(x, 2.0 + y, z),
        Place::Flat => DVec3::new(x, 0.0, z),
        Place::Wall => DVec3::new(x, y, 0.0),
        Place::Line => DVec3::new(k, 0.0, 0.0),
        Place::Joined => DVec3::new(SIDE * k, 0.0, 0.0),
        Place::Column => DVec3::new(0.0, 40.0 * k, 0.0),
        Place::OnePoint => DVec3::Y,
        Place::FarApart => 1e4 * DVec3::new(x, y, z),
    }
}

pub(crate) fn leaf_at(
    leaf: Leaf,
    at: DVec3,
    direction: Direction,
    random: &mut Random,
) -> Vec<Triangle> {
    let angle = TAU * random.unit();
    let [right, up] = match direction {
        Direction::Any => [
            DVec3::new(angle.cos(), 0.0, angle.sin()),
            DVec3::new(0.6 * angle.sin(), 0.8, -0.6 * angle.cos()),
        ],
        Direction::Up => [DVec3::X, DVec3::Z],
        Direction::Front => [DVec3::X, DVec3::Y],
    };
    let placed = |[x, y]: [f64; 2], right: DVec3| at + SIDE * (x * right + y * up);
    let triangle = |corners: [[f64; 2]; 3]| (corners.map(|c| placed(c, right)), corners);
    let card = |width: f64, right: DVec3| {
        let corners = |uvs: [[f64; 2]; 3]| (uvs.map(|[u, v]| placed([width * u, v], right)), uvs);
        [
            corners([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0]]),
            corners([[0.0, 0.0], [1.0, 1.0], [0.0, 1.0]]),
        ]
    };
    match leaf {
        Leaf::Card => card(1.0, right).to_vec(),
        Leaf::Triangle => vec![triangle([[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]])],
        Leaf::Cross => [card(1.0, right), card(1.0, right.cross(up))].concat(),
        Leaf::Sliver => card(0.01, right).to_vec(),
        Leaf::NoArea => vec![triangle([[0.0, 0.0], [1.0, 0.0], [2.0, 0.0]])],
        Leaf::Sheet => sheet(triangle),
        Leaf::Soup => {
            let mut all = sheet(triangle);
            for (_, uvs) in &mut all {
                *uvs = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]];
            }
            all
        }
    }
}

/// A square of 50 triangles.
fn sheet(triangle: impl Fn([[f64; 2]; 3]) -> Triangle) -> Vec<Triangle> {
    let cells = (0..25).map(|k| [f64::from(k % 5), f64::from(k / 5)].map(|x| 0.2 * x));
    let squares = cells.flat_map(|[x, y]| {
        let [a, b, c, d] = [[x, y], [x + 0.2, y], [x + 0.2, y + 0.2], [x, y + 0.2]];
        [[a, b, c], [a, c, d]]
    });
    squares.map(triangle).collect()
}

pub(crate) fn wood_of(wood: Wood, random: &mut Random) -> Vec<Triangle> {
    let uvs = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]];
    match wood {
        Wood::None => Vec::new(),
        Wood::Trunk => tube(0.1, 2.0),
        Wood::ThinTrunk => tube(1e-5, 2.0),
        Wood::Pot => tube(0.5, 0.4),
        Wood::Ground => {
            let [a, b, c, d] = [[-9.0, -9.0], [9.0, -9.0], [9.0, 9.0], [-9.0, 9.0]]
                .map(|[x, z]| DVec3::new(x, 0.0, z));
            vec![([a, c, b], uvs), ([a, d, c], uvs)]
        }
        Wood::Triangle => vec![([DVec3::ZERO, DVec3::X, DVec3::Y], uvs)],
        Wood::Soup => {
            let mut corner = || {
                let [x, y, z] = [(); 3].map(|()| random.between(-1.0, 1.0));
                DVec3::new(x, y, z)
            };
            (0..60)
                .map(|_| ([corner(), corner(), corner()], uvs))
                .collect()
        }
        Wood::OnePoint => vec![([DVec3::ZERO; 3], uvs); 10],
    }
}

fn tube(radius: f64, height: f64) -> Vec<Triangle> {
    let at = |k: u32, y: f64| {
        let angle = TAU * f64::from(k % 12) / 12.0;
        DVec3::new(radius * angle.cos(), y, radius * angle.sin())
    };
    let uv = |k: u32, v: f64| [f64::from(k) / 12.0, v];
    let sides = (0..12).flat_map(|k| {
        let [a, b, c, d] = [at(k, 0.0), at(k + 1, 0.0), at(k + 1, height), at(k, height)];
        let [ta, tb, tc, td] = [uv(k, 0.0), uv(k + 1, 0.0), uv(k + 1, 1.0), uv(k, 1.0)];
        [([a, d, b], [ta, td, tb]), ([b, d, c], [tb, td, tc])]
    });
    sides.collect()
}
