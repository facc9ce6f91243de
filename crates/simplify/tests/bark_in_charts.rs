//! Bark that is cut into charts, as on scanned and unwrapped trees: wood of as many triangles looks as it
//! does where texture coordinates are shared, and shows no part of the atlas that is not its own.

use std::collections::HashMap;
use std::f64::consts::TAU;
use std::sync::Arc;

use glam::{DVec2, DVec3, Vec2};
use secateur_eval::Judging;
use secateur_eval::pictures::WholePictures;
use secateur_gltf::{Document, WholeTree, surfaces_to_glb};
use secateur_model::{AlphaMode, Filters, Finish, Foliage, Lod, Material, Surface, Texture, Wrap};
use secateur_raster::ViewSet;
use secateur_simplify::wood::{Parts, Wood};

const SIDES: usize = 8;
const RINGS: usize = 20;
const LENGTH: f64 = 6.0;

/// Texels along a side of the part of the texture that a triangle's half of a quad has.
const CELL_PX: usize = 8;
/// Cells along a side of the texture: two for each quad.
const CELLS: [usize; 2] = [2 * SIDES, RINGS];

/// How the texture of a trunk is cut.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Cut {
    /// Quads go on from each other, but for one seam along the trunk.
    Nowhere,
    AtQuads,
    AtTriangles,
}

/// The cell of the texture in which a triangle is drawn: with charts anywhere.
fn cell(cut: Cut, ring: usize, side: usize, half: usize) -> [usize; 2] {
    let quad = ring * SIDES + side;
    // 37 and 127 have no divisor with the numbers of quads and of triangles, and neighbours part.
    match cut {
        Cut::Nowhere => [2 * side + half, ring],
        Cut::AtQuads => {
            let moved = 37 * quad % (SIDES * RINGS);
            [2 * (moved % SIDES) + half, moved / SIDES]
        }
        Cut::AtTriangles => {
            let moved = 127 * (2 * quad + half) % (2 * SIDES * RINGS);
            [moved % CELLS[0], moved / CELLS[0]]
        }
    }
}

/// The bark of a cell: brown, lighter on one side of the trunk and upward, and somewhat lighter or darker
/// from texel to texel. A chart shows what is around it: bark looks alike all over.
fn bark(ring: usize, side: usize, half: usize, [x, y]: [usize; 2]) -> [u8; 4] {
    let number = 1000 * (ring * SIDES + side) + 100 * half + CELL_PX * y + x;
    let of_texel = (number.wrapping_mul(2_654_435_761) >> 7) % 6;
    let around = TAU * (side as f64 + 0.5) / SIDES as f64;
    let light = 90.0 + 12.0 * around.sin() + 20.0 * ring as f64 / RINGS as f64;
    let light = light as u8 + of_texel as u8;
    [light + 30, light, light - 40, 255]
}

fn texture(cut: Cut) -> Texture {
    let [width, height] = CELLS.map(|count| count * CELL_PX);
    let mut rgba = vec![255; 4 * width * height];
    for (ring, side, half) in halves() {
        let [left, top] = cell(cut, ring, side, half).map(|cell| cell * CELL_PX);
        for (x, y) in (0..CELL_PX).flat_map(|x| (0..CELL_PX).map(move |y| (x, y))) {
            let at = 4 * ((top + y) * width + left + x);
            rgba[at..at + 4].copy_from_slice(&bark(ring, side, half, [x, y]));
        }
    }
    Texture {
        width: width as u32,
        height: height as u32,
        rgba,
        wrap: [Wrap::Repeat; 2],
        filters: Filters::default(),
    }
}

fn halves() -> impl Iterator<Item = (usize, usize, usize)> {
    let quads = (0..RINGS).flat_map(|ring| (0..SIDES).map(move |side| (ring, side)));
    quads.flat_map(|(ring, side)| [0, 1].map(|half| (ring, side, half)))
}

/// A trunk that bends and gets thinner.
fn place(ring: usize, side: usize) -> (DVec3, DVec3) {
    let share = ring as f64 / RINGS as f64;
    let angle = TAU * (side % SIDES) as f64 / SIDES as f64;
    let outward = DVec3::new(angle.cos(), 0.0, angle.sin());
    let bend = DVec3::new(0.8 * (2.0 * share).sin(), LENGTH * share, 0.3 * share);
    (bend + (0.5 - 0.25 * share) * outward, outward)
}

fn trunk(cut: Cut) -> Surface {
    let mut surface = empty("Bark", Some(texture(cut)));
    let mut known: HashMap<([usize; 2], [u32; 2]), u32> = HashMap::new();
    for (ring, side, half) in halves() {
        let [column, row] = cell(cut, ring, side, half);
        // Both halves of a quad have a half of its width.
        let corners = [[(0, 0), (1, 1), (0, 1)], [(0, 0), (1, 0), (1, 1)]][half];
        let triangle = corners.map(|(across, up)| {
            let x = match cut {
                Cut::AtTriangles => (column + across) as f64,
                Cut::Nowhere | Cut::AtQuads => (column - half + 2 * across) as f64,
            };
            let uv = DVec2::new(x / CELLS[0] as f64, (row + up) as f64 / CELLS[1] as f64).as_vec2();
            let at = [ring + up, (side + across) % SIDES];
            *known
                .entry((at, uv.to_array().map(f32::to_bits)))
                .or_insert_with(|| {
                    let (position, normal) = place(at[0], at[1]);
                    surface.positions.push(position);
                    surface.normals.push(normal.as_vec3());
                    surface.uvs.push(uv);
                    surface.positions.len() as u32 - 1
                })
        });
        surface.triangles.push(triangle);
    }
    surface
}

fn empty(name: &str, texture: Option<Texture>) -> Surface {
    Surface::empty(Arc::new(Material {
        name: name.to_owned(),
        base_color: [1.0; 4],
        texture: texture.map(Arc::new),
        alpha_mode: AlphaMode::Opaque,
        double_sided: name == "Leaves",
        finish: Finish::default(),
    }))
}

/// Sixteen leaves about the top.
fn leaves() -> Surface {
    let mut surface = empty("Leaves", None);
    let (top, _) = place(RINGS, 0);
    for k in 0..16_u32 {
        let angle = TAU * f64::from(k) / 16.0;
        let along = DVec3::new(angle.cos(), 0.3, angle.sin());
        let across = 0.15 * DVec3::new(-angle.sin(), 0.0, angle.cos());
        let first = surface.positions.len() as u32;
        for at in [-across, across, along] {
            surface.positions.push(top + at);
            surface.normals.push(glam::Vec3::Y);
            surface.uvs.push(Vec2::ZERO);
        }
        surface.triangles.push([0, 1, 2].map(|k| first + k));
    }
    surface
}

fn tree(cut: Cut) -> WholeTree {
    let glb = surfaces_to_glb("tree", &[(trunk(cut), false), (leaves(), true)]);
    let document = Document::from_bytes("tree.glb", glb, None).unwrap();
    document.into_whole_tree(&[]).unwrap()
}

/// The wood of as many triangles or fewer, and the tree with it as a client gets it.
fn level(tree: &WholeTree, triangles: usize) -> (Lod, Vec<Surface>) {
    let views = ViewSet::dodecahedron(tree.wood().bounding_sphere().unwrap());
    let pieces = tree.wood().leaves().len();
    let wood = Wood::by_geometry(Parts::of(tree.wood()), &vec![1000.0; pieces], &views, 256);
    let (lod, _) = wood.within(triangles);
    let leaves = Lod::original(tree.leaves().leaves().len());
    let joined = tree.joined(&leaves, &lod);
    let glb = tree.items().lod_to_bytes(&joined).unwrap();
    let level = Document::from_bytes("level.glb", glb, None).unwrap();
    let surfaces = level.surfaces(&[]).unwrap().into_iter();
    (lod, surfaces.map(|(surface, _)| surface).collect())
}

/// The FLIP of a level, and how far its outlines agree, 0 to 1.
fn looks(tree: &WholeTree, level: &[Surface]) -> [f64; 2] {
    let mut judging = Judging::held_out(tree.items().foliage()).unwrap();
    judging.rigs.truncate(1);
    let surfaces = tree.items().surfaces().unwrap().into_iter();
    let surfaces: Vec<Surface> = surfaces.map(|(surface, _)| surface).collect();
    let original = WholePictures::of(&surfaces, &judging.rigs);
    let seen = original.measure(&WholePictures::of(level, &judging.rigs));
    let flip = seen.pictures.overall.get("flip_mean").unwrap();
    [flip, seen.outline_iou[0]]
}

#[test]
fn a_trunk_in_charts_looks_as_good_as_one_whose_texture_is_shared() {
    let all = 2 * SIDES * RINGS;
    for triangles in [all / 2, all / 4, all / 8] {
        let [shared, others @ ..] = [Cut::Nowhere, Cut::AtQuads, Cut::AtTriangles].map(|cut| {
            let tree = tree(cut);
            let (_, level) = level(&tree, triangles);
            looks(&tree, &level)
        });
        for [flip, outline_iou] in others {
            let report = format!("{flip}, {outline_iou}; shared {shared:?} at {triangles}");
            println!("{report}");
            // Where shapes are all but the same, that texels are others still shows.
            assert!(flip <= 1.1 * shared[0] + 0.0005, "{report}");
            // As near as a pixel in a thousand: collapses go other ways.
            let most = 1.1 * (1.0 - shared[1]) + 0.001;
            assert!(1.0 - outline_iou <= most, "{report}");
        }
    }
}

/// Edges that one triangle has, where corners at one place are one: the two ends of the trunk.
fn border_length(wood: &Foliage) -> f64 {
    let mut uses: HashMap<[[u64; 3]; 2], (u32, f64)> = HashMap::new();
    for triangle in wood.triangles() {
        for k in 0..3 {
            let [a, b] = [k, (k + 1) % 3].map(|k| triangle.corners[k]);
            let mut edge = [a, b].map(|place| place.to_array().map(f64::to_bits));
            edge.sort_unstable();
            let (count, length) = uses.entry(edge).or_default();
            *count += 1;
            *length = a.distance(b);
        }
    }
    let single = uses.values().filter(|(count, _)| *count == 1);
    single.map(|(_, length)| length).sum()
}

#[test]
fn no_crack_opens_along_charts() {
    for cut in [Cut::AtQuads, Cut::AtTriangles] {
        let tree = tree(cut);
        let at_first = border_length(tree.wood());
        for triangles in [160, 80, 40] {
            let (lod, _) = level(&tree, triangles);
            let left = lod.foliage(tree.wood());
            let count = left.triangles().len();
            assert!((triangles / 2..=triangles).contains(&count), "{count}");
            let length = border_length(&left);
            assert!(length <= 1.001 * at_first, "{cut:?}: {length}, {at_first}");
        }
    }
}

/// Each chart has a quad's part of the texture, or a triangle's.
#[test]
fn no_triangle_runs_across_the_atlas() {
    for cut in [Cut::AtQuads, Cut::AtTriangles] {
        let tree = tree(cut);
        for triangles in [160, 80, 40, 12] {
            let (_, level) = level(&tree, triangles);
            let bark = level.iter().find(|s| s.material.name == "Bark").unwrap();
            let cell = Vec2::new(CELLS[0] as f32, CELLS[1] as f32);
            for triangle in &bark.triangles {
                let uvs = triangle.map(|vertex| cell * bark.uvs[vertex as usize]);
                let low = uvs.into_iter().fold(Vec2::INFINITY, Vec2::min);
                let high = uvs.into_iter().fold(Vec2::NEG_INFINITY, Vec2::max);
                let [wide, high] = (high - low).to_array();
                let widest = if cut == Cut::AtQuads { 2.0 } else { 1.0 };
                let report = format!("{wide} x {high} cells at {triangles}");
                assert!(wide < widest + 1e-3 && high < 1.0 + 1e-3, "{report}");
                assert!(wide > 0.5 && high > 0.5, "{report}: streaks");
            }
        }
    }
}

/// Normals are of the place where a vertex is, not of the chart that its texture is from: triangles meet
/// smoothly as they did.
#[test]
fn vertices_keep_the_normals_of_their_places() {
    let tree = tree(Cut::AtTriangles);
    let (_, level) = level(&tree, 80);
    let bark = level.iter().find(|s| s.material.name == "Bark").unwrap();
    for (position, normal) in bark.positions.iter().zip(&bark.normals) {
        let places = (0..=RINGS).flat_map(|ring| (0..SIDES).map(move |side| place(ring, side)));
        let nearest = places.min_by(|a, b| {
            let distance = |p: DVec3| p.distance_squared(*position);
            distance(a.0).total_cmp(&distance(b.0))
        });
        let off = nearest.unwrap().1.as_vec3().distance(*normal);
        assert!(off < 1e-5, "{off} at {position}");
    }
}
