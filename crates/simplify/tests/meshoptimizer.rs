//! The port of meshoptimizer to Rust against the C++ original: the same index lists, to the last index.
//!
//! The meshes are of the kinds that the product simplifies, the options those that it uses; for wood with
//! seams of the texture, permissive collapses too.

use std::collections::HashMap;

use glam::{DVec3, Vec3};
use meshoptimizer_rs::{
    Attributes, Limits, Positions, SimplifyOptions, SimplifySettings, VertexFlags, Workspace,
};
use secateur_plant::{GrowOptions, Species, grow};

/// Texture coordinates and normal of a vertex.
const ATTRIBUTES: usize = 5;

/// Shares of the triangles that are left.
const SHARES: [f64; 5] = [0.75, 0.5, 0.25, 0.1, 0.02];

struct Mesh {
    name: String,
    positions: Vec<[f32; 3]>,
    attributes: Vec<[f32; ATTRIBUTES]>,
    is_locked: Vec<bool>,
    indices: Vec<u32>,
}

impl Mesh {
    /// Corners of one place and texture coordinate are one vertex; each seventh vertex is locked.
    fn of(name: &str, triangles: &[[(Vec3, [f32; 2]); 3]]) -> Self {
        let mut mesh = Self {
            name: name.to_owned(),
            positions: Vec::new(),
            attributes: Vec::new(),
            is_locked: Vec::new(),
            indices: Vec::new(),
        };
        let mut known: HashMap<[u32; 5], u32> = HashMap::new();
        for triangle in triangles {
            let [a, b, c] = triangle.map(|(at, _)| at);
            let normal = (b - a).cross(c - a).normalize_or_zero();
            for (at, [u, v]) in triangle {
                let key = [at.x, at.y, at.z, *u, *v].map(f32::to_bits);
                let vertex = *known.entry(key).or_insert_with(|| {
                    mesh.is_locked.push(mesh.positions.len() % 7 == 3);
                    mesh.positions.push(at.to_array());
                    mesh.attributes.push([*u, *v, normal.x, normal.y, normal.z]);
                    mesh.positions.len() as u32 - 1
                });
                mesh.indices.push(vertex);
            }
        }
        mesh
    }

    fn in_rust(&self, run: Run, target: usize) -> Vec<u32> {
        let mut space = Workspace::new(Limits {
            max_bytes: usize::MAX,
            max_work: u64::MAX,
        });
        let settings = |options| SimplifySettings {
            target_index_count: target,
            target_error: f32::MAX,
            options,
        };
        let positions = Positions::from_packed(&self.positions);
        let indices = &self.indices;
        let with_attributes = |options, space: &mut Workspace| {
            let flag = |locked: &bool| match locked {
                true => VertexFlags::LOCK,
                false => VertexFlags::EMPTY,
            };
            let flags: Vec<VertexFlags> = self.is_locked.iter().map(flag).collect();
            let values = self.attributes.as_flattened();
            let values =
                Attributes::from_interleaved(values, flags.len(), ATTRIBUTES, ATTRIBUTES, 0)
                    .unwrap();
            meshoptimizer_rs::simplify_with_attributes(
                indices,
                positions,
                values,
                &WEIGHTS,
                Some(&flags),
                settings(options),
                space,
            )
        };
        let space = &mut space;
        let kept = match run {
            Run::Plain => meshoptimizer_rs::simplify(
                indices,
                positions,
                settings(SimplifyOptions::EMPTY),
                space,
            ),
            Run::Prune => meshoptimizer_rs::simplify(
                indices,
                positions,
                settings(SimplifyOptions::PRUNE),
                space,
            ),
            Run::Sloppy => {
                meshoptimizer_rs::simplify_sloppy(indices, positions, None, target, f32::MAX, space)
            }
            Run::Attributes => with_attributes(SimplifyOptions::ERROR_ABSOLUTE, space),
            Run::Permissive => with_attributes(
                SimplifyOptions::ERROR_ABSOLUTE | SimplifyOptions::PERMISSIVE,
                space,
            ),
        };
        kept.unwrap_or_else(|error| panic!("{}: {error}", self.name))
            .indices
    }

    fn in_cpp(&self, run: Run, target: usize) -> Vec<u32> {
        use meshopt::SimplifyOptions;
        let bytes = meshopt::typed_to_bytes(&self.positions);
        let vertices = meshopt::VertexDataAdapter::new(bytes, size_of::<[f32; 3]>(), 0).unwrap();
        let (indices, no_limit) = (&self.indices, f32::MAX);
        let simplified =
            |options| meshopt::simplify(indices, &vertices, target, no_limit, options, None);
        let with_attributes = |options| {
            meshopt::simplify_with_attributes_and_locks(
                indices,
                &vertices,
                self.attributes.as_flattened(),
                &WEIGHTS,
                size_of::<[f32; ATTRIBUTES]>(),
                &self.is_locked,
                target,
                no_limit,
                options,
                None,
            )
        };
        match run {
            Run::Plain => simplified(SimplifyOptions::None),
            Run::Prune => simplified(SimplifyOptions::Prune),
            Run::Sloppy => meshopt::simplify_sloppy(indices, &vertices, target, no_limit, None),
            Run::Attributes => with_attributes(SimplifyOptions::ErrorAbsolute),
            Run::Permissive => {
                with_attributes(SimplifyOptions::ErrorAbsolute | SimplifyOptions::Permissive)
            }
        }
    }
}

const WEIGHTS: [f32; ATTRIBUTES] = [0.01, 0.01, 0.002, 0.002, 0.002];

/// A way in which the product simplifies.
#[derive(Clone, Copy, Debug)]
enum Run {
    Plain,
    Prune,
    Sloppy,
    Attributes,
    Permissive,
}

const RUNS: [Run; 5] = [
    Run::Plain,
    Run::Prune,
    Run::Sloppy,
    Run::Attributes,
    Run::Permissive,
];

/// How texture coordinates of a tube are given to its corners.
#[derive(Clone, Copy, Debug)]
enum Charts {
    Shared,
    OfQuads,
    OfTriangles,
}

/// A bent tube that gets thinner, of 10 sides and 24 rings.
fn tube(charts: Charts) -> Mesh {
    let at = |ring: usize, side: usize| {
        let share = ring as f64 / 24.0;
        let angle = std::f64::consts::TAU * (side % 10) as f64 / 10.0;
        let radius = 0.5 - 0.3 * share;
        let bend = (4.0 * share).sin();
        DVec3::new(
            radius * angle.cos() + bend,
            6.0 * share,
            radius * angle.sin(),
        )
        .as_vec3()
    };
    let mut triangles = Vec::new();
    for ring in 0..24 {
        for side in 0..10 {
            let quad = [(0, 0), (0, 1), (1, 1), (1, 0)];
            for (number, t) in [[0, 1, 2], [0, 2, 3]].into_iter().enumerate() {
                triangles.push(t.map(|corner: usize| {
                    let (up, along) = quad[corner];
                    let chart = match charts {
                        Charts::Shared => 0,
                        Charts::OfQuads => 7 * (10 * ring + side) % 101,
                        Charts::OfTriangles => 7 * (20 * ring + 2 * side + number) % 101,
                    };
                    let uv = [side + along, ring + up].map(|x| 0.05 * x as f32 + chart as f32);
                    (at(ring + up, side + along), uv)
                }));
            }
        }
    }
    Mesh::of(&format!("tube with charts {charts:?}"), &triangles)
}

/// 40 cards of 3 x 2 quads that turn with their numbers.
fn cards() -> Mesh {
    let mut triangles = Vec::new();
    for card in 0..40_u8 {
        let turn = glam::DQuat::from_rotation_y(0.7 * f64::from(card));
        let at = |x: u8, y: u8| {
            let local = DVec3::new(f64::from(x), f64::from(y), 0.1 * f64::from(x * y));
            let place = turn * local + DVec3::new(0.0, 0.4 * f64::from(card), 1.0);
            (place.as_vec3(), [f32::from(x) / 3.0, f32::from(y) / 2.0])
        };
        for (x, y) in (0..3).flat_map(|x| [(x, 0), (x, 1)]) {
            let [a, b, c, d] = [at(x, y), at(x + 1, y), at(x + 1, y + 1), at(x, y + 1)];
            triangles.extend([[a, b, c], [a, c, d]]);
        }
    }
    Mesh::of("cards", &triangles)
}

/// The wood and the leaves of a plant that was grown.
fn grown(species: Species) -> [Mesh; 2] {
    let plant = grow(
        species,
        &GrowOptions {
            leaves: 200,
            seed: 3,
        },
    )
    .unwrap();
    [("wood", &plant.wood), ("leaves", &plant.leaves)].map(|(part, surface)| {
        let corner = |&vertex: &u32| {
            let at = surface.positions[vertex as usize].as_vec3();
            (at, surface.uvs[vertex as usize].to_array())
        };
        let triangles: Vec<_> = surface
            .triangles
            .iter()
            .map(|t| [corner(&t[0]), corner(&t[1]), corner(&t[2])])
            .collect();
        Mesh::of(&format!("{part} of {species:?}"), &triangles)
    })
}

#[test]
fn the_port_gives_the_index_lists_of_the_original() {
    let tubes = [Charts::Shared, Charts::OfQuads, Charts::OfTriangles].map(tube);
    let grown = [Species::Oak, Species::Birch].map(grown);
    let meshes = tubes.into_iter().chain([cards()]);
    let mut simplified = 0;
    for mesh in meshes.chain(grown.into_iter().flatten()) {
        for run in RUNS {
            for share in SHARES {
                let target = 3 * (share * (mesh.indices.len() / 3) as f64) as usize;
                let [ours, theirs] = [mesh.in_rust(run, target), mesh.in_cpp(run, target)];
                assert!(ours == theirs, "{}, {run:?}, {share}", mesh.name);
                simplified += usize::from(ours.len() < mesh.indices.len());
            }
        }
    }
    // What leaves all meshes as they are would be equal too.
    assert!(simplified > 120, "{simplified} of 200 runs simplify");
}
