//! Odd plants as files: flat, single, coincident, tiny, huge, far away, in one piece, instanced, of many materials,
//! with odd textures, broken.

mod choices;
mod file;
mod shapes;
mod texture;

use std::fmt::Write as _;

use secateur::glam::DVec3;

pub(crate) use choices::{Choices, bytes_of};
use file::PlantFile;
use shapes::{Direction, Leaf, Place, Triangle, Wood, leaf_at, place_of, wood_of};
use texture::Picture;

/// A plant as a file, and what it is.
#[derive(Debug)]
pub(crate) struct OddPlant {
    pub(crate) about: String,
    pub(crate) glb: Vec<u8>,
}

/// How many leaves there are.
const COUNTS: [usize; 10] = [8, 1, 2, 3, 3, 20, 20, 60, 120, 0];

/// How large a plant is, and how far off, in multiples of its size.
const SCALES: [f64; 16] = [
    1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1e-3, 1e3, 1e-9, 1e9, 1e-20, 1e20,
];
const OFFSETS: [f64; 9] = [0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1e2, 1e5, 1e10];

/// What the node does to it.
const NODE_SCALES: [[f64; 3]; 9] = [
    [1.0, 1.0, 1.0],
    [1.0, 1.0, 1.0],
    [1.0, 1.0, 1.0],
    [1.0, 1.0, 1.0],
    [1.0, 1.0, 1.0],
    [1.0, 0.0, 1.0],
    [0.0, 0.0, 0.0],
    [-1.0, 1.0, 1.0],
    [1.0, 1e-7, 1.0],
];

/// Texture coordinates, as a leaf's own are changed.
#[derive(Clone, Copy, Debug)]
enum Uvs {
    Own,
    Missing,
    Constant,
    Tiled,
    Negative,
    Huge,
}

/// How parts share materials.
#[derive(Clone, Copy, Debug)]
enum Materials {
    /// One of leaves, one of wood.
    Two,
    /// One of all.
    One,
    /// Each leaf has its own, up to 24.
    EachLeaf,
}

/// What is chosen from; what stands there several times is chosen as often.
const PLACES: [Place; 10] = {
    use Place as P;
    [
        P::Crown,
        P::Crown,
        P::Crown,
        P::Flat,
        P::Wall,
        P::Line,
        P::Joined,
        P::Column,
        P::OnePoint,
        P::FarApart,
    ]
};
const LEAVES: [Leaf; 9] = {
    use Leaf as L;
    [
        L::Card,
        L::Card,
        L::Card,
        L::Triangle,
        L::Cross,
        L::Sliver,
        L::Sheet,
        L::Soup,
        L::NoArea,
    ]
};
const WOODS: [Wood; 9] = {
    use Wood as W;
    [
        W::None,
        W::Trunk,
        W::Trunk,
        W::ThinTrunk,
        W::Pot,
        W::Ground,
        W::Triangle,
        W::Soup,
        W::OnePoint,
    ]
};
const UVS: [Uvs; 8] = {
    use Uvs as U;
    [
        U::Own,
        U::Own,
        U::Own,
        U::Missing,
        U::Constant,
        U::Tiled,
        U::Negative,
        U::Huge,
    ]
};

/// The plant of these choices.
pub(crate) fn odd_plant(choices: &mut Choices<'_>) -> OddPlant {
    use Direction as D;
    let (place, leaf, wood) = (
        choices.one_of(&PLACES),
        choices.one_of(&LEAVES),
        choices.one_of(&WOODS),
    );
    let direction = choices.one_of(&[D::Any, D::Any, D::Up, D::Front]);
    let count = choices.one_of(&COUNTS);
    let [scale, offset] = [choices.one_of(&SCALES), choices.one_of(&OFFSETS)];
    let uvs = choices.one_of(&UVS);
    use Materials as M;
    let materials = choices.one_of(&[M::Two, M::Two, M::Two, M::One, M::EachLeaf]);
    let is_broken = choices.one_in(24);
    let mut random = choices.random();
    let mut parts: Vec<Vec<Triangle>> = vec![Vec::new(); 2];
    for index in 0..count {
        let at = place_of(place, index, &mut random);
        let part = match materials {
            Materials::One => 1,
            Materials::Two => 0,
            Materials::EachLeaf => 2 + index % 24,
        };
        if parts.len() <= part {
            parts.resize(part + 1, Vec::new());
        }
        parts[part].extend(leaf_at(leaf, at, direction, &mut random));
    }
    parts[1].extend(wood_of(wood, &mut random));
    for (corners, of_corners) in parts.iter_mut().flatten() {
        for corner in corners {
            *corner = scale * (*corner + offset * DVec3::new(1.0, 0.0, -1.0));
        }
        for uv in of_corners {
            *uv = uvs.of(*uv);
        }
    }
    if let (true, Some((corners, _))) = (is_broken, parts.iter_mut().flatten().next()) {
        corners[0].y = f64::NAN;
    }
    let mut about = format!(
        "{count} leaves, {leaf:?}, {direction:?}, {place:?}, {wood:?}, scale {scale:e}, offset {offset:e}, \
         uvs {uvs:?}, materials {materials:?}, broken {is_broken}, "
    );
    let file = PlantFile::of(choices, parts, !matches!(uvs, Uvs::Missing));
    write!(about, "{file}").expect("a string");
    OddPlant {
        about,
        glb: file.to_glb(),
    }
}

impl Uvs {
    fn of(self, [u, v]: [f64; 2]) -> [f64; 2] {
        match self {
            Self::Own | Self::Missing => [u, v],
            Self::Constant => [0.5, 0.5],
            Self::Tiled => [3.0 * u - 1.0, 3.0 * v - 1.0],
            Self::Negative => [-u, -v],
            Self::Huge => [1e6 * u, 1e6 * v],
        }
    }
}
