//! What the fuzzer starts from: bodies of small streams, each behind its length, and some that are
//! refused. `SECATEUR_WRITE_SEEDS=1 cargo test -p secateur-pages seeds` writes them.

use std::path::Path;
use std::sync::Arc;

use secateur_gltf::{Detail, Document, LeafSurface, Tree, plant_to_glb};
use secateur_model::{AlphaMode, Material};
use secateur_plant::{GrowOptions, Species, grow};
use secateur_simplify::fsa::{self, FsaOptions};

use super::bytes::unpacked;
use super::tests::pruned;
use super::*;

/// A tree of few leaves without pictures.
fn tree() -> (Tree, Vec<LeafSurface>) {
    let options = GrowOptions { leaves: 5, seed: 1 };
    let mut plant = grow(Species::Oak, &options).unwrap();
    for surface in [&mut plant.leaves, &mut plant.wood] {
        surface.material = Arc::new(Material {
            texture: None,
            alpha_mode: AlphaMode::Opaque,
            ..(*surface.material).clone()
        });
    }
    // A few pieces of wood are enough.
    plant.wood.triangles.truncate(40);
    let document = Document::from_bytes("tree.glb", plant_to_glb(&plant), None).unwrap();
    let tree = document
        .into_tree(&["mesh:Leaves".parse().unwrap()])
        .unwrap();
    let surfaces = tree.leaf_surfaces(Detail::Full).unwrap();
    (tree, surfaces)
}

/// The bodies of a stream.
fn bodies(stream: &Stream) -> Vec<Vec<u8>> {
    let mut at = START_BYTES;
    let mut bodies = Vec::new();
    for piece in &stream.pieces {
        let word = |k: usize| {
            let bytes = stream.bytes[at + k..][..4].try_into().unwrap();
            u32::from_le_bytes(bytes)
        };
        let packed = &stream.bytes[at + PIECE_HEAD_BYTES..piece.bytes as usize];
        bodies.push(unpacked(packed, word(12)).unwrap());
        at = piece.bytes as usize;
    }
    bodies
}

/// Each body behind its length: what the target takes apart.
fn in_a_row(bodies: &[Vec<u8>]) -> Vec<u8> {
    let with_length = |body: &Vec<u8>| [&(body.len() as u32).to_le_bytes()[..], body].concat();
    bodies.iter().flat_map(with_length).collect()
}

/// File names and bodies; what starts with `broken` is refused.
fn seeds() -> Vec<(&'static str, Vec<Vec<u8>>)> {
    let (tree, surfaces) = tree();
    let of = |model: &_| bodies(&write_stream("oak", &surfaces, tree.foliage(), model).unwrap());
    let pruned = of(&pruned(&tree));
    let go_on = &mut |_| std::ops::ControlFlow::Continue(());
    let order = fsa::simplify(tree.foliage(), 2, &FsaOptions::default(), go_on).unwrap();
    let model = secateur_model::LodModel::new(order, tree.foliage()).unwrap();
    let collapsed = of(&model);
    let with = |body: usize, at: usize, byte: u8| {
        let mut bodies = collapsed.clone();
        let length = bodies[body].len();
        bodies[body][at.min(length - 1)] = byte;
        bodies
    };
    let mut short = pruned.clone();
    short[0].truncate(600);
    let mut long = pruned.clone();
    long[1].extend([0; 4]);
    vec![
        ("broken_head", with(0, 12, b'!')),
        ("broken_head_length", with(0, 3, 0x7f)),
        ("broken_gone", with(1, 12, 0xff)),
        ("broken_name", with(1, 20, 0xff)),
        ("broken_corner", with(0, usize::MAX, 0xff)),
        ("broken_short", short),
        ("broken_long", long),
        (
            "broken_twice",
            vec![pruned[0].clone(), pruned[1].clone(), pruned[1].clone()],
        ),
        ("first", vec![pruned[0].clone()]),
        ("collapsed", collapsed),
        ("pruned", pruned),
    ]
}

#[test]
fn seeds_are_in_the_corpus_and_end_as_their_names_say() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../fuzz/corpus/plant_stream");
    for (name, bodies) in seeds() {
        let read = read_stream(&stream_of_bodies(bodies.iter().map(Vec::as_slice)));
        let is_broken = name.starts_with("broken");
        assert_eq!(read.is_err(), is_broken, "{name}: {:?}", read.err());
        let (path, bytes) = (folder.join(name), in_a_row(&bodies));
        if std::env::var_os("SECATEUR_WRITE_SEEDS").is_some() {
            std::fs::create_dir_all(&folder).unwrap();
            std::fs::write(&path, &bytes).unwrap();
        }
        assert_eq!(std::fs::read(&path).unwrap(), bytes, "{name}");
    }
}
