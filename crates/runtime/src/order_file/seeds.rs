//! What the fuzzer starts from: one small file for each kind of step, and some that are refused.
//! `SECATEUR_WRITE_SEEDS=1 cargo test -p secateur-runtime seeds` writes them.

use std::ops::ControlFlow;
use std::path::Path;

use glam::{DVec2, DVec3};
use secateur_model::{
    Foliage, Growth, LeafId, LeafTriangle, LodModel, NewCorner, NewLeaf, Place, RemovalOrder, Step,
};
use secateur_simplify::fsa::{self, FsaOptions};
use secateur_simplify::stochastic::{self, StochasticOptions};

use super::{read_order, write_order};

/// The foliage of the fuzz target: squares of two triangles in rows of six.
fn foliage() -> Foliage {
    let mut foliage = Foliage::default();
    for index in 0..24 {
        let at = DVec3::new((index % 6) as f64, (index / 6) as f64, 0.1 * index as f64);
        let corner = |(x, y): (f64, f64)| (at + 0.5 * DVec3::new(x, y, 0.0), DVec2::new(x, y));
        let square = [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)].map(corner);
        let triangle = |numbers: [usize; 3]| LeafTriangle {
            corners: numbers.map(|k| square[k].0),
            uvs: numbers.map(|k| square[k].1),
        };
        let leaf = [[0, 1, 2], [0, 2, 3]].map(triangle);
        foliage.push_leaf(&leaf, None).unwrap();
    }
    foliage
}

/// File names and bytes; names that start with `broken` are refused.
fn seeds(foliage: &Foliage) -> Vec<(&'static str, Vec<u8>)> {
    let bytes = |order| write_order(&LodModel::new(order, foliage).unwrap(), foliage);
    let leaf = |n| LeafId::new(n).unwrap();
    let grown = |n, area_scale| Growth {
        leaf: leaf(n),
        area_scale,
    };
    let go_on = &mut |_| ControlFlow::Continue(());
    let collapsed = fsa::simplify(foliage, 8, &FsaOptions::default(), go_on).unwrap();
    let mut pruned = RemovalOrder::new(24);
    for n in 1..12 {
        pruned.push(leaf(n), &[grown(n + 12, 2.0)]);
    }
    pruned.push(leaf(24), &[]);
    let corner = |place| NewCorner { place, like: 1 };
    let in_plane = |x: f64| {
        let weights = [x, 1.0, -x];
        corner(Place::InPlaneOf {
            corners: [3, 4, 5],
            weights,
        })
    };
    let card = |n| NewLeaf {
        donor: leaf(n),
        triangles: vec![[0.0, 1.0, 2.0].map(in_plane)],
    };
    let anywhere = NewLeaf {
        donor: leaf(9),
        triangles: vec![[DVec3::ZERO, DVec3::X, DVec3::Y].map(|p| corner(Place::At(p)))],
    };
    let mut coarse = RemovalOrder::new(24);
    let all: Vec<LeafId> = (1..=24).map(leaf).collect();
    coarse.push_step(Step {
        removed: &all,
        grown: &[],
        made: &(1..=24).map(card).collect::<Vec<_>>(),
        survivors_area_scale: 1.0,
    });
    coarse.push_step(Step {
        removed: &[leaf(25), leaf(26)],
        grown: &[grown(27, 1.5)],
        made: &[anywhere],
        survivors_area_scale: 2.0,
    });
    coarse.push_step(Step {
        removed: &[],
        grown: &[grown(28, 1.25), grown(29, 0.75), grown(49, 3.0)],
        made: &[],
        survivors_area_scale: 2.0,
    });
    let mut flattened = RemovalOrder::new(24);
    let sheet = |n: u32| NewLeaf {
        donor: leaf(n),
        triangles: vec![[0.0, 1.0, 2.0].map(|x| {
            corner(Place::InPlaneOf {
                corners: [1, n % 2, 5],
                weights: [x, 1.0, -x],
            })
        })],
    };
    flattened.push_step(Step {
        removed: &all,
        grown: &[],
        made: &(1..=24).map(sheet).collect::<Vec<_>>(),
        survivors_area_scale: 1.0,
    });
    let [pruned, collapsed, coarse] = [pruned, collapsed, coarse].map(bytes);
    let flattened = bytes(flattened);
    let lots = bytes(stochastic::simplify(
        foliage,
        6,
        &StochasticOptions::default(),
    ));
    let with = |at: usize, byte: u8| {
        let mut bytes = collapsed.clone();
        bytes[at] = byte;
        bytes
    };
    vec![
        ("nothing", bytes(RemovalOrder::new(24))),
        ("broken_version", with(12, 3)),
        ("broken_leaves", with(48, 25)),
        ("broken_steps", with(55, 0x7f)),
        ("broken_made", with(56, 3)),
        ("broken_shapes", with(60, 9)),
        ("broken_cut", collapsed[..90].to_vec()),
        ("broken_long", [&pruned[..], &[0; 9]].concat()),
        ("broken_circle", with(64, 0xfb)),
        ("pruned", pruned),
        ("collapsed", collapsed),
        ("coarse", coarse),
        ("flattened", flattened),
        ("by_lot", lots),
    ]
}

#[test]
fn seeds_are_in_the_corpus_and_end_as_their_names_say() {
    let foliage = foliage();
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../fuzz/corpus/removal_order");
    for (name, bytes) in seeds(&foliage) {
        let read = read_order(&bytes, &foliage);
        let is_broken = name.starts_with("broken");
        assert_eq!(read.is_err(), is_broken, "{name}: {:?}", read.err());
        let path = folder.join(name);
        if std::env::var_os("SECATEUR_WRITE_SEEDS").is_some() {
            std::fs::create_dir_all(&folder).unwrap();
            std::fs::write(&path, &bytes).unwrap();
        }
        assert_eq!(std::fs::read(&path).unwrap(), bytes, "{name}");
    }
}
