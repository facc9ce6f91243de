use secateur_gltf::{Detail, Document, LeafSurface, Tree, plant_to_glb, surfaces_to_glb};
use secateur_model::{Growth, LeafId, LodModel, RemovalOrder, Surface};
use secateur_plant::{GrowOptions, Species, grow};
use secateur_simplify::{Options, Resolution, Target, simplify};

use super::*;

/// A small tree: its leaves, its surfaces.
pub(super) fn tree(species: Species, leaves: u32) -> (Tree, Vec<LeafSurface>) {
    let plant = grow(species, &GrowOptions { leaves, seed: 5 }).unwrap();
    let document = Document::from_bytes("tree.glb", plant_to_glb(&plant), None).unwrap();
    let tree = document.into_tree(&[]).unwrap();
    let surfaces = tree.leaf_surfaces(Detail::Full).unwrap();
    (tree, surfaces)
}

fn simplified(tree: &Tree, target: Target) -> LodModel {
    let mut options = Options::to(target);
    options.resolution = Resolution::Pixels(48);
    let result = simplify(tree.foliage(), &options).unwrap();
    LodModel::new(result.passes.in_one_order(), tree.foliage()).unwrap()
}

/// One leaf after the other goes, and the next one grows.
pub(super) fn pruned(tree: &Tree) -> LodModel {
    let count = tree.foliage().leaves().len();
    let mut order = RemovalOrder::new(count as u32);
    for k in 0..count - 2 {
        let leaf = LeafId::from_index(k + 1);
        let area_scale = 1.0 + k as f64 / 8.0;
        order.push(LeafId::from_index(k), &[Growth { leaf, area_scale }]);
    }
    LodModel::new(order, tree.foliage()).unwrap()
}

/// The corners of all triangles with their looks, in an order that does not depend on the surface's.
fn soup(surfaces: &[(Surface, bool)]) -> Vec<Vec<u32>> {
    let mut soup = Vec::new();
    for (surface, is_foliage) in surfaces {
        for triangle in &surface.triangles {
            let mut corners = vec![u32::from(*is_foliage)];
            for corner in triangle.map(|c| c as usize) {
                let position = surface.positions[corner].as_vec3();
                corners.extend(position.to_array().map(f32::to_bits));
                corners.extend(surface.uvs[corner].to_array().map(f32::to_bits));
                corners.extend(secateur_runtime::wind::hold_words(&surface.holds[corner]));
            }
            soup.push(corners);
        }
    }
    soup.sort_unstable();
    soup
}

fn drawn(glb: Vec<u8>) -> Vec<(Surface, bool)> {
    let document = Document::from_bytes("level.glb", glb, None).unwrap();
    document.surfaces_with(Detail::Full, &[]).unwrap()
}

#[test]
fn the_whole_stream_is_the_original_bit_for_bit() {
    let (tree, surfaces) = tree(Species::Oak, 120);
    let models = [
        pruned(&tree),
        simplified(&tree, Target::leaf_share(0.1)),
        simplified(&tree, Target::triangle_share(0.2)),
    ];
    for model in models {
        let stream = write_stream("oak", &surfaces, tree.foliage(), &model).unwrap();
        let (plant, used) = read_stream(&stream.bytes).unwrap();
        assert_eq!(used, stream.bytes.len() as u64);
        assert!(plant.is_whole());
        assert_eq!(plant.leaves(), [120, 120]);
        let original = tree.surfaces_with(Detail::Full).unwrap();
        assert_eq!(soup(&plant.surfaces()), soup(&original));
        let last = stream.pieces.last().unwrap();
        assert_eq!(last.triangles, tree.triangle_count());
        // As a file too.
        let glb = surfaces_to_glb(plant.name(), &plant.surfaces());
        assert_eq!(soup(&drawn(glb)), soup(&original));
    }
}

/// The leaves of every piece's level are those that a run to it writes, but for what single
/// precision rounds.
#[test]
fn every_piece_ends_in_a_level_of_the_order() {
    for (species, target) in [
        (Species::Oak, Target::leaf_share(0.1)),
        (Species::Maple, Target::triangle_share(0.3)),
    ] {
        let (tree, surfaces) = tree(species, 120);
        let model = simplified(&tree, target);
        let stream = write_stream("tree", &surfaces, tree.foliage(), &model).unwrap();
        assert!(stream.pieces.len() > 3);
        for piece in &stream.pieces {
            let (plant, used) = read_stream(&stream.bytes[..piece.bytes as usize]).unwrap();
            assert_eq!(used, piece.bytes);
            assert_eq!(plant.leaves()[0], piece.leaves);
            assert_eq!(plant.triangles()[0], piece.triangles);
            let lod = model.lod_after(piece.steps as usize);
            let expected = drawn(tree.lod_to_bytes(&lod).unwrap());
            let corners = |surfaces: &[(Surface, bool)]| {
                let foliage = surfaces.iter().filter(|(_, is_foliage)| *is_foliage);
                let corners = foliage.flat_map(|(surface, _)| {
                    surface.triangles.iter().flatten().map(|corner| {
                        let at = surface.positions[*corner as usize];
                        let uv = surface.uvs[*corner as usize].as_dvec2();
                        [at.x, at.y, at.z, uv.x, uv.y]
                    })
                });
                let mut corners: Vec<_> = corners.collect();
                // Far coarser than what is rounded, and finer than leaves are apart.
                corners.sort_by_key(|c| c.map(|x| (x * 1e4).round() as i64));
                corners
            };
            let (found, expected) = (corners(&plant.surfaces()), corners(&expected));
            assert_eq!(found.len(), expected.len());
            let sums = [found, expected].map(|corners| {
                corners
                    .iter()
                    .fold([0.0; 5], |sum, c| std::array::from_fn(|k| sum[k] + c[k]))
            });
            for (a, b) in sums[0].iter().zip(sums[1]) {
                assert!((a - b).abs() < 1e-3, "{} leaves: {sums:?}", piece.leaves);
            }
        }
    }
}

#[test]
fn a_cut_anywhere_is_the_plant_of_the_pieces_before() {
    let (tree, surfaces) = tree(Species::Birch, 40);
    let stream = write_stream("birch", &surfaces, tree.foliage(), &pruned(&tree)).unwrap();
    let first = stream.pieces[0].bytes as usize;
    for length in (0..stream.bytes.len()).step_by(97) {
        let read = read_stream(&stream.bytes[..length]);
        let whole = stream
            .pieces
            .iter()
            .filter(|p| p.bytes as usize <= length)
            .count();
        match read {
            Ok((plant, _)) => {
                assert_eq!(plant.pieces(), [whole as u32, stream.pieces.len() as u32]);
                assert_eq!(plant.triangles()[0], stream.pieces[whole - 1].triangles);
            }
            Err(error) => {
                assert!(length < first, "{length}: {error}");
                assert!(error.to_string().starts_with("the stream is cut short"));
            }
        }
    }
}

#[test]
fn bytes_that_trickle_in_make_the_same_plant() {
    let (tree, surfaces) = tree(Species::Oak, 30);
    let stream = write_stream("oak", &surfaces, tree.foliage(), &pruned(&tree)).unwrap();
    let mut reader = StreamReader::default();
    let mut pieces = 0;
    for chunk in stream.bytes.chunks(1000) {
        pieces += reader.push(chunk).unwrap();
        let expected = stream
            .pieces
            .partition_point(|p| p.bytes <= reader.bytes_used());
        assert_eq!(pieces as usize, expected);
    }
    let whole = read_stream(&stream.bytes).unwrap().0;
    assert_eq!(
        soup(&reader.finish().unwrap().surfaces()),
        soup(&whole.surfaces())
    );
}

/// Twigs come no later than the leaves that are nearest to them, and what bears the crown comes first.
#[test]
fn no_leaf_comes_before_its_twig() {
    let (tree, surfaces) = tree(Species::Oak, 200);
    let wood = wood::pieces(&surfaces);
    let points: Vec<Vec<glam::Vec3>> = wood
        .iter()
        .map(|piece| {
            let part = piece.part(&surfaces);
            let corners = |t: &[u32; 3]| t.map(|corner| part.vertices[corner as usize].position);
            let and_middle = |[a, b, c]: [glam::Vec3; 3]| [a, b, c, (a + b + c) / 3.0];
            let triangles = part.triangles.iter().map(corners);
            triangles.flat_map(and_middle).collect()
        })
        .collect();
    let count = 9;
    let comes: Vec<u32> = (0..200).map(|k| k * 7 % count).collect();
    let arrivals = wood::arrivals(&wood, &surfaces, tree.foliage(), &comes, count);
    assert!(arrivals.iter().all(|arrival| *arrival < count));
    assert!(arrivals.contains(&0) && arrivals.iter().any(|arrival| *arrival > 0));
    for (index, comes) in comes.iter().enumerate() {
        let triangles = tree.foliage().triangles_of(LeafId::from_index(index));
        let corners = || {
            triangles
                .iter()
                .flat_map(|t| t.corners.map(|c| c.as_vec3()))
        };
        let nearest = |points: &Vec<glam::Vec3>| {
            let distances = points
                .iter()
                .flat_map(|at| corners().map(|c| c.distance_squared(*at)));
            distances.fold(f32::INFINITY, f32::min)
        };
        let nearest: Vec<f32> = points.iter().map(nearest).collect();
        let least = nearest.iter().copied().fold(f32::INFINITY, f32::min);
        // Of those that are as near, one.
        let twigs = (0..wood.len()).filter(|twig| nearest[*twig] <= least * 1.0001 + 1e-12);
        let first = twigs.map(|twig| arrivals[twig]).min().unwrap();
        assert!(first <= *comes, "{first} after {comes}");
    }
    // What is there hangs on what is there: the branches of a branch are never without it.
    let pieces = wood::as_foliage(&wood, &surfaces);
    for (piece, support) in secateur_simplify::wood::supports(&pieces)
        .iter()
        .enumerate()
    {
        assert!(support.is_none_or(|support| arrivals[support] <= arrivals[piece]));
    }
    let stream = write_stream("oak", &surfaces, tree.foliage(), &pruned(&tree)).unwrap();
    let [first, last] = [0, stream.pieces.len() - 1].map(|k| stream.pieces[k]);
    assert!(first.triangles * 2 < last.triangles);
}

#[test]
fn streams_that_are_none_are_refused_with_a_sentence() {
    let (tree, surfaces) = tree(Species::Oak, 30);
    let model = pruned(&tree);
    let stream = write_stream("oak", &surfaces, tree.foliage(), &model).unwrap();
    let with = |at: usize, byte: u8| {
        let mut bytes = stream.bytes.clone();
        bytes[at] = byte;
        bytes
    };
    let why = |bytes: &[u8]| read_stream(bytes).unwrap_err().to_string();
    assert_eq!(
        why(b"glTF"),
        "this is no stream of a plant: it does not start with \"secateur stream\""
    );
    assert_eq!(
        why(&with(16, 9)),
        "the stream is of version 9; this program reads version 2"
    );
    assert_eq!(
        why(&stream.bytes[..99]),
        format!(
            "the stream is cut short within its first piece: 99 bytes of at least {} that are \
             needed for a plant",
            stream.pieces[0].bytes
        )
    );
    assert!(why(b"").starts_with("the stream is cut short within its first piece: 0 bytes"));
    let second = stream.pieces[0].bytes as usize;
    assert_eq!(
        why(&with(second + 4, !stream.bytes[second + 4])),
        "piece 1 of the stream is of another tree, or of another removal order"
    );
    assert_eq!(
        why(&[&stream.bytes[..second], &stream.bytes[36..]].concat()),
        "the stream has piece 0 where piece 1 should be"
    );
    assert_eq!(
        why(&with(second + 20, 0x5a)),
        "piece 1 of the stream cannot be unpacked"
    );
    assert_eq!(
        why(&[&stream.bytes[..], &stream.bytes[second..]].concat()),
        "the stream goes on after its last piece"
    );
    // A body of 4 GiB is never made.
    assert_eq!(
        why(&with(36 + 15, 0xff)),
        "piece 0 of the stream cannot be unpacked"
    );
}
