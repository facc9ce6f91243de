use std::ops::ControlFlow;

use proptest::prelude::*;
use secateur_model::{Foliage, Growth, LodModel, RemovalOrder, Step};
use secateur_plant::{EllipsoidCrown, ellipsoid_crown};
use secateur_simplify::fsa::{self, FsaOptions};
use secateur_simplify::meshopt::{self, Borders, MeshoptOptions, Mode};
use secateur_simplify::stochastic::{self, StochasticOptions};
use secateur_simplify::{
    Fitting, LeafTriangles, Method, Options, Preset, Resolution, Target, simplify,
};

use super::*;

const LEAVES: u32 = 300;

fn crown() -> Foliage {
    ellipsoid_crown(LEAVES, 7, &EllipsoidCrown::default()).unwrap()
}

fn fsa_order(foliage: &Foliage) -> RemovalOrder {
    let options = FsaOptions::default();
    fsa::simplify(foliage, 3, &options, &mut |_| ControlFlow::Continue(())).unwrap()
}

fn vds_order(foliage: &Foliage, change: impl FnOnce(&mut Options)) -> RemovalOrder {
    let mut options = Options {
        resolution: Resolution::Pixels(48),
        ..Options::with_preset(Preset::Look, Target::leaf_share(0.1))
    };
    change(&mut options);
    simplify(foliage, &options).unwrap().passes.in_one_order()
}

/// One order of each way, by its name.
fn orders(foliage: &Foliage) -> Vec<(&'static str, RemovalOrder)> {
    let several = |options: &mut Options| {
        if let Method::Vds(vds) = &mut options.method {
            vds.neighbours = 3;
        }
    };
    let triangles = |options: &mut Options| {
        options.target = Target::triangle_share(0.2);
        options.leaf_triangles = LeafTriangles::AtMost(1);
    };
    let no_fit = |options: &mut Options| options.fit = Fitting::None;
    let sloppy = MeshoptOptions {
        mode: Mode::Sloppy,
        borders: Borders::PreserveArea,
    };
    let pruned = StochasticOptions::default();
    vec![
        ("nothing", RemovalOrder::new(LEAVES)),
        ("vds", vds_order(foliage, no_fit)),
        ("vds, fitted", vds_order(foliage, |_| ())),
        ("vds, three neighbours", vds_order(foliage, several)),
        ("vds, coarser leaves", vds_order(foliage, triangles)),
        ("fsa", fsa_order(foliage)),
        ("stochastic", stochastic::simplify(foliage, 9, &pruned)),
        (
            "meshopt",
            meshopt::simplify(foliage, 0.3, MeshoptOptions::default()),
        ),
        ("meshopt, sloppy", meshopt::simplify(foliage, 0.3, sloppy)),
    ]
}

#[test]
fn orders_of_every_method_come_back() {
    let foliage = crown();
    for (name, order) in orders(&foliage) {
        let model = LodModel::new(order, &foliage).unwrap();
        let bytes = write_order(&model, &foliage);
        let read = read_order(&bytes, &foliage);
        assert_eq!(read.as_ref(), Ok(&model), "{name}");
        assert_eq!(write_order(&model, &foliage), bytes, "{name}");
        let text = order_to_base64(&model, &foliage);
        assert_eq!(order_from_base64(&text, &foliage).as_ref(), Ok(&model));
    }
}

#[test]
fn a_leaf_takes_less_than_16_bytes() {
    let foliage = ellipsoid_crown(3000, 7, &EllipsoidCrown::default()).unwrap();
    let bytes = |order| write_order(&LodModel::new(order, &foliage).unwrap(), &foliage).len();
    let full = |options: &mut Options| {
        // Every leaf that goes lets another grow.
        if let Method::Vds(vds) = &mut options.method {
            vds.max_coverage = None;
        }
    };
    for (name, order) in [
        ("vds", vds_order(&foliage, full)),
        ("fsa", fsa_order(&foliage)),
        (
            "stochastic",
            stochastic::simplify(&foliage, 0, &StochasticOptions::default()),
        ),
    ] {
        let a_leaf = bytes(order) as f64 / 3000.0;
        assert!(a_leaf < 14.0, "{name}: {a_leaf} bytes");
    }
}

/// A small order with all kinds of steps.
fn small() -> (Foliage, Vec<u8>) {
    let foliage = ellipsoid_crown(24, 7, &EllipsoidCrown::default()).unwrap();
    let mut order = fsa_order(&foliage);
    let leaf = |n| LeafId::new(n).unwrap();
    let last = order.name_count() as u32;
    order.push_step(Step {
        removed: &[],
        grown: &[Growth {
            leaf: leaf(last),
            area_scale: 1.25,
        }],
        made: &[],
        survivors_area_scale: 1.5,
    });
    let bytes = write_order(&LodModel::new(order, &foliage).unwrap(), &foliage);
    (foliage, bytes)
}

fn why(bytes: &[u8], foliage: &Foliage) -> String {
    read_order(bytes, foliage).unwrap_err().to_string()
}

#[test]
fn whatever_is_cut_off_is_missed() {
    let (foliage, bytes) = small();
    for length in 0..bytes.len() {
        let why = why(&bytes[..length], &foliage);
        let expected = match length {
            0 => "this is no removal order",
            1..64 => "cut short",
            _ => "cut short: it ends in step",
        };
        assert!(why.contains(expected), "{length}: {why}");
    }
    let mut longer = bytes;
    longer.push(0);
    assert!(why(&longer, &foliage).contains("goes on for 1 bytes"));
}

#[test]
fn heads_that_are_wrong_are_refused() {
    let (foliage, bytes) = small();
    let with = |at: usize, byte: u8| {
        let mut bytes = bytes.clone();
        bytes[at] = byte;
        why(&bytes, &foliage)
    };
    assert!(with(0, b'S').contains("does not start with"));
    assert!(with(12, 3).contains("of version 3"));
    assert!(with(16, !bytes[16]).contains("of another tree"));
    assert!(with(48, 25).contains("of another tree"));
    // Counts that claim more than the file holds.
    assert!(with(55, 0xff).contains("cut short: it ends in step"));
    assert!(with(63, 0xff).contains("ends in shape"));
    let more_made = with(57, 1);
    assert!(!more_made.is_empty());
    let other = ellipsoid_crown(24, 8, &EllipsoidCrown::default()).unwrap();
    assert!(why(&bytes, &other).contains("of another tree"));
}

proptest! {
    /// Bits that are flipped behind the head end in an order that can be followed, or in an error.
    #[test]
    fn whatever_the_bits_say(flips in prop::collection::vec((60_usize..2000, 0_u8..8), 1..6)) {
        let (foliage, mut bytes) = small();
        for (at, bit) in flips {
            let at = 60 + at % (bytes.len() - 60);
            bytes[at] ^= 1 << bit;
        }
        if let Ok(model) = read_order(&bytes, &foliage) {
            let mut level = model.finest();
            level.go_to(model.order().len());
            let _ = level.lod().foliage(&foliage);
            level.go_to(0);
            prop_assert_eq!(level.lod(), secateur_model::Lod::original(24));
        }
    }
}
