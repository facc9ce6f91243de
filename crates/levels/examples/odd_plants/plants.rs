//! Odd plants as files: flat, single, coincident, tiny, huge, far away, broken.

use glam::DVec3;
use secateur_model::Random;
use serde_json::{Value, json};

/// A plant as a file, and what it is.
pub(crate) struct OddPlant {
    pub(crate) about: String,
    pub(crate) glb: Vec<u8>,
}

/// How many leaves there are.
const COUNTS: [usize; 9] = [0, 1, 2, 3, 3, 8, 8, 20, 60];

/// How large a plant is, and how far off, in multiples of its size.
const SCALES: [f64; 9] = [1.0, 1.0, 1.0, 1e-3, 1e-9, 1e-20, 1e3, 1e9, 1e20];
const OFFSETS: [f64; 6] = [0.0, 0.0, 0.0, 1e2, 1e5, 1e10];

/// What its node does to it.
const NODE_SCALES: [[f64; 3]; 6] = [
    [1.0, 1.0, 1.0],
    [1.0, 1.0, 1.0],
    [1.0, 0.0, 1.0],
    [0.0, 0.0, 0.0],
    [-1.0, 1.0, 1.0],
    [1.0, 1e-7, 1.0],
];

#[derive(Clone, Copy, Debug)]
enum Place {
    Crown,
    Flat,
    Line,
    Column,
    OnePoint,
    FarApart,
}

#[derive(Clone, Copy, Debug)]
enum Leaf {
    Triangle,
    Card,
    Sheet,
    Soup,
    NoArea,
}

#[derive(Clone, Copy, Debug)]
enum Wood {
    None,
    Trunk,
    Pot,
    Ground,
    Triangle,
}

/// A triangle, and its texture coordinates.
type Triangle = ([DVec3; 3], [[f64; 2]; 3]);

/// The plant of this number.
pub(crate) fn odd_plant(number: u64) -> OddPlant {
    let mut random = Random::new(number);
    let place = one_of(
        &mut random,
        &[
            Place::Crown,
            Place::Flat,
            Place::Line,
            Place::Column,
            Place::OnePoint,
            Place::FarApart,
        ],
    );
    let leaf = one_of(
        &mut random,
        &[
            Leaf::Triangle,
            Leaf::Card,
            Leaf::Card,
            Leaf::Sheet,
            Leaf::Soup,
            Leaf::NoArea,
        ],
    );
    let wood = one_of(
        &mut random,
        &[
            Wood::None,
            Wood::None,
            Wood::Trunk,
            Wood::Trunk,
            Wood::Pot,
            Wood::Ground,
            Wood::Triangle,
        ],
    );
    let count = one_of(&mut random, &COUNTS);
    let [scale, offset] = [one_of(&mut random, &SCALES), one_of(&mut random, &OFFSETS)];
    let node_scale = one_of(&mut random, &NODE_SCALES);
    let alpha = one_of(&mut random, &["OPAQUE", "MASK", "BLEND"]);
    let is_double_sided = random.unit() < 0.7;
    let is_broken = random.unit() < 0.05;
    let mut leaves: Vec<Triangle> = Vec::new();
    for index in 0..count {
        let at = place_of(place, index, &mut random);
        leaves.extend(leaf_at(leaf, at, &mut random));
    }
    let put = |triangles: &mut Vec<Triangle>| {
        for corner in triangles.iter_mut().flat_map(|(corners, _)| corners) {
            *corner = scale * (*corner + offset * DVec3::new(1.0, 0.0, -1.0));
        }
    };
    let mut of_wood = wood_of(wood);
    put(&mut leaves);
    put(&mut of_wood);
    if let (true, Some((corners, _))) = (is_broken, leaves.first_mut()) {
        corners[0].y = f64::NAN;
    }
    let about = format!(
        "number {number}: {count} leaves, {leaf:?}, {place:?}, {wood:?}, {alpha}, double sided {is_double_sided}, \
         scale {scale:e}, offset {offset:e}, node {node_scale:?}, broken {is_broken}"
    );
    let materials = json!([
        { "name": "leaf", "alphaMode": alpha, "doubleSided": is_double_sided,
          "pbrMetallicRoughness": { "baseColorFactor": [0.1, 0.4, 0.1, 1.0] } },
        { "name": "bark", "doubleSided": is_double_sided },
    ]);
    OddPlant {
        about,
        glb: glb(&[leaves, of_wood], &materials, node_scale),
    }
}

fn one_of<T: Copy>(random: &mut Random, of: &[T]) -> T {
    of[(random.unit() * of.len() as f64) as usize]
}

fn place_of(place: Place, index: usize, random: &mut Random) -> DVec3 {
    let k = index as f64;
    let [x, y, z] = [(); 3].map(|()| random.between(-1.0, 1.0));
    match place {
        Place::Crown => DVec3::new(x, 2.0 + y, z),
        Place::Flat => DVec3::new(x, 0.0, z),
        Place::Line => DVec3::new(k, 0.0, 0.0),
        Place::Column => DVec3::new(0.0, 40.0 * k, 0.0),
        Place::OnePoint => DVec3::Y,
        Place::FarApart => 1e4 * DVec3::new(x, y, z),
    }
}

fn leaf_at(leaf: Leaf, at: DVec3, random: &mut Random) -> Vec<Triangle> {
    let [right, up] = match random.unit() < 0.5 {
        true => [DVec3::X, DVec3::Z],
        false => [DVec3::X, DVec3::new(0.0, 0.8, 0.6)],
    };
    let corner = |[x, y]: [f64; 2]| at + 0.3 * (x * right + y * up);
    let triangle = |places: [[f64; 2]; 3]| (places.map(corner), places);
    let square = |x: f64, y: f64, side: f64| {
        let [a, b, c, d] = [[x, y], [x + side, y], [x + side, y + side], [x, y + side]];
        [triangle([a, b, c]), triangle([a, c, d])]
    };
    match leaf {
        Leaf::Triangle => vec![triangle([[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]])],
        Leaf::Card => square(0.0, 0.0, 1.0).to_vec(),
        Leaf::NoArea => vec![triangle([[0.0, 0.0], [1.0, 0.0], [2.0, 0.0]])],
        Leaf::Sheet | Leaf::Soup => {
            let cells = (0..100).map(|k| [f64::from(k % 10), f64::from(k / 10)]);
            let mut all: Vec<Triangle> = cells
                .flat_map(|[x, y]| square(0.1 * x, 0.1 * y, 0.1))
                .collect();
            if let Leaf::Soup = leaf {
                for (_, uvs) in &mut all {
                    *uvs = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]];
                }
            }
            all
        }
    }
}

fn wood_of(wood: Wood) -> Vec<Triangle> {
    let uvs = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]];
    let tube = |radius: f64, height: f64| {
        let at = |k: u32, y: f64| {
            let angle = std::f64::consts::TAU * f64::from(k) / 12.0;
            DVec3::new(radius * angle.cos(), y, radius * angle.sin())
        };
        let sides = (0..12).flat_map(move |k| {
            let [a, b, c, d] = [at(k, 0.0), at(k + 1, 0.0), at(k + 1, height), at(k, height)];
            [([a, d, b], uvs), ([b, d, c], uvs)]
        });
        sides.collect()
    };
    match wood {
        Wood::None => Vec::new(),
        Wood::Trunk => tube(0.1, 2.0),
        Wood::Pot => tube(0.5, 0.4),
        Wood::Ground => {
            let [a, b, c, d] = [[-9.0, -9.0], [9.0, -9.0], [9.0, 9.0], [-9.0, 9.0]]
                .map(|[x, z]| DVec3::new(x, 0.0, z));
            vec![([a, c, b], uvs), ([a, d, c], uvs)]
        }
        Wood::Triangle => vec![([DVec3::ZERO, DVec3::X, DVec3::Y], uvs)],
    }
}

/// One primitive a material, of triangles that share no vertex.
fn glb(parts: &[Vec<Triangle>; 2], materials: &Value, node_scale: [f64; 3]) -> Vec<u8> {
    let (mut buffer, mut views, mut accessors) = (Vec::<u8>::new(), Vec::new(), Vec::new());
    let mut primitives = Vec::new();
    for (material, part) in parts.iter().enumerate() {
        if part.is_empty() {
            continue;
        }
        let corners = part.iter().flat_map(|(corners, _)| corners);
        let positions: Vec<f32> = corners.flat_map(|c| c.as_vec3().to_array()).collect();
        let uvs = part.iter().flat_map(|(_, uvs)| uvs.as_flattened());
        let uvs: Vec<f32> = uvs.map(|uv| *uv as f32).collect();
        let bound = |most: fn(f32, f32) -> f32, axis: usize| {
            let all = positions.iter().skip(axis).step_by(3).copied();
            all.filter(|x| x.is_finite()).reduce(most).unwrap_or(0.0)
        };
        let [low, high] = [f32::min, f32::max].map(|most| [0, 1, 2].map(|axis| bound(most, axis)));
        let first = accessors.len();
        for (values, kind) in [(&positions, "VEC3"), (&uvs, "VEC2")] {
            let bytes: Vec<u8> = values.iter().flat_map(|x| x.to_le_bytes()).collect();
            views.push(
                json!({ "buffer": 0, "byteOffset": buffer.len(), "byteLength": bytes.len() }),
            );
            buffer.extend(bytes);
            accessors.push(
                json!({ "bufferView": views.len() - 1, "componentType": 5126,
                "count": 3 * part.len(), "type": kind }),
            );
        }
        accessors[first]["min"] = json!(low);
        accessors[first]["max"] = json!(high);
        primitives.push(json!({ "material": material,
            "attributes": { "POSITION": first, "TEXCOORD_0": first + 1 } }));
    }
    let mut root = json!({ "asset": { "version": "2.0" }, "scene": 0, "materials": materials,
        "scenes": [{ "nodes": [] }] });
    if !primitives.is_empty() {
        root["scenes"] = json!([{ "nodes": [0] }]);
        root["nodes"] = json!([{ "mesh": 0, "name": "plant", "scale": node_scale }]);
        root["meshes"] = json!([{ "name": "plant", "primitives": primitives }]);
        root["accessors"] = json!(accessors);
        root["bufferViews"] = json!(views);
        root["buffers"] = json!([{ "byteLength": buffer.len() }]);
    }
    joined(&root, &buffer)
}

/// A GLB of a JSON and a buffer.
fn joined(root: &Value, buffer: &[u8]) -> Vec<u8> {
    let mut json = root.to_string().into_bytes();
    json.resize(json.len().next_multiple_of(4), b' ');
    let word = |n: usize| (n as u32).to_le_bytes();
    let mut glb = b"glTF".to_vec();
    glb.extend(
        [
            word(2),
            word(28 + json.len() + buffer.len()),
            word(json.len()),
        ]
        .concat(),
    );
    glb.extend(b"JSON");
    glb.extend(json);
    glb.extend(word(buffer.len()));
    glb.extend(b"BIN\0");
    glb.extend(buffer);
    glb
}
