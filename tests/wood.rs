//! What becomes of the wood: one budget for the plant, or wood that stays.

use std::ops::ControlFlow;

use glam::Vec3;
use secateur::{
    Document, Foliage, LeafId, OpenEngine, Options, Target, Tree, WholePlant, WholeTree,
};
use secateur_simplify::wood::{hanging_on, leaf_wood_gaps};
use serde_json::Value;

use crate::program::{Bench, OAK_LEAVES, shared_tree};

fn simplified(bench: &Bench, options: &[&str]) -> Value {
    let files = ["oak.glb", "-o", "out.glb", "--report", "r.json"];
    bench.simplify(&[&files, options].concat()).succeeded();
    bench.json("r.json")
}

/// What the report says of this key: the count before and the count after.
fn counts(report: &Value, key: &str) -> [u64; 2] {
    ["original", "final"].map(|when| report[key][when].as_u64().unwrap())
}

/// The figures of a report are those of the file.
fn assert_adds_up(bench: &Bench, report: &Value) {
    let [all, foliage, wood] =
        ["triangles", "foliage_triangles", "wood_triangles"].map(|key| counts(report, key));
    for when in 0..2 {
        assert_eq!(all[when], foliage[when] + wood[when], "{report}");
    }
    let tree = Tree::open(&bench.path("out.glb"), &[]).unwrap();
    assert_eq!(tree.leaf_triangle_count(), foliage[1]);
    assert_eq!(tree.triangle_count(), all[1]);
}

#[test]
fn a_budget_of_triangles_is_the_whole_plants() {
    let bench = Bench::new();
    for method in ["vds", "fsa", "stochastic", "chain"] {
        for budget in ["0.5", "0.1", "300"] {
            let report = simplified(&bench, &["--method", method, "--triangles", budget]);
            assert_adds_up(&bench, &report);
            let [before, after] = counts(&report, "triangles");
            let most = match budget.parse::<u64>() {
                Ok(count) => count,
                Err(_) => (budget.parse::<f64>().unwrap() * before as f64).round() as u64,
            };
            assert!(after <= most, "{method} {budget}: {after}");
            // Leaves of several triangles may not use the last ones, and leaves that hang in the air at
            // the sizes which are fitted last go: no others stay for them any more.
            let least = most - most / 100 - 3;
            assert!(after >= least || method != "vds", "{budget}: {after}");
            let wood = counts(&report, "wood_triangles");
            assert!(wood[1] > 0 && wood[1] < wood[0], "{method} {budget}");
            assert_eq!(report["settings"]["wood"], "geometry");
        }
    }
    crate::validator::assert_valid(&[bench.path("out.glb")]);
}

/// A twig that is left as a flat strip is lit as what it faces, not as if from its edges.
#[test]
fn coarse_wood_has_normals_that_follow_it() {
    let bench = Bench::new();
    simplified(&bench, &["--triangles", "0.1"]);
    let least_along = |file: &str| {
        let document = Document::open(&bench.path(file)).unwrap();
        let surfaces = document.surfaces(&[]).unwrap();
        let wood = surfaces
            .iter()
            .filter(|(surface, _)| surface.material.name.contains("bark"));
        let along = wood.flat_map(|(surface, _)| {
            surface.triangles.iter().map(|corners| {
                let [a, b, c] = corners.map(|k| surface.positions[k as usize]);
                let own = (b - a).cross(c - a).normalize_or_zero().as_vec3();
                let normals = corners.map(|k| surface.normals[k as usize]);
                normals.iter().sum::<Vec3>().dot(own) / 3.0
            })
        });
        let along: Vec<f32> = along.collect();
        assert!(!along.is_empty());
        along.into_iter().fold(1.0, f32::min)
    };
    let [before, after] = ["oak.glb", "out.glb"].map(least_along);
    assert!(after > 0.39 && before > 0.39, "{before} {after}");
}

/// Eleven stems, each of which carries a tenth of the crown: from the ground up to it, whatever pixels they save.
#[test]
fn a_bush_of_few_triangles_stands() {
    let Some(bush) = shared_tree("ez_bush2.glb") else {
        return;
    };
    let tree = WholeTree::open(&bush, &[]).unwrap();
    let (leaves, wood) = (tree.leaves(), tree.wood());
    let engine = OpenEngine::cpu();
    let plant = WholePlant::new(tree.items().foliage(), leaves, wood, &engine).unwrap();
    let heights = |wood: &Foliage, piece: usize| {
        let corners = wood.triangles_of(LeafId::from_index(piece)).iter();
        let heights = corners.flat_map(|t| t.corners).map(|c| c.y);
        let low = heights.clone().fold(f64::INFINITY, f64::min);
        [low, heights.fold(f64::NEG_INFINITY, f64::max)]
    };
    let whole = wood.bounding_sphere().unwrap();
    let all = (0..wood.leaves().len()).map(|piece| heights(wood, piece)[0]);
    let ground = all.fold(f64::INFINITY, f64::min);
    for triangles in [300, 476] {
        let options = Options::to(Target::triangles(triangles));
        let level = plant.simplified(&options, &engine, &mut |_| ControlFlow::Continue(()));
        let level = level.unwrap();
        let left = level.wood.foliage(wood);
        let stems = (0..left.leaves().len()).filter(|piece| {
            let [low, high] = heights(&left, *piece);
            low < ground + 0.05 * whole.radius && high > whole.centre.y
        });
        assert_eq!(stems.count(), 11, "{triangles}");
        let of_all = level.wood_triangles as u64;
        assert!(5 * of_all < 2 * triangles, "{of_all} of {triangles}");
    }
}

/// The largest gaps that levels allow are those of the tree at first, twice these, four times and so on.
#[test]
fn no_leaf_hangs_further_in_the_air_than_a_level_says() {
    let bench = Bench::new();
    let tree = WholeTree::open(&bench.path("oak.glb"), &[]).unwrap();
    let (leaves, wood) = (tree.leaves(), tree.wood());
    let engine = OpenEngine::cpu();
    let items = tree.items().foliage();
    let plant = WholePlant::new(items, leaves, wood, &engine).unwrap();
    let at_first = leaf_wood_gaps(leaves, wood).into_iter().fold(0.0, f64::max);
    for share in [0.5, 0.1] {
        let options = Options::to(Target::triangle_share(share));
        let level = plant.simplified(&options, &engine, &mut |_| ControlFlow::Continue(()));
        let level = level.unwrap();
        let gap = level.leaf_gap.unwrap();
        let doubled = (gap / at_first).log2();
        assert!(doubled > -0.01 && (doubled - doubled.round()).abs() < 0.01);
        let left = level.leaves.lod.foliage(leaves);
        let hanging = hanging_on(&left, &level.wood.foliage(wood), gap);
        assert!(hanging.iter().all(Option::is_none), "{share}");
        // More of the others stayed for those that went.
        let triangles = left.triangles().len() + level.wood_triangles;
        let asked = (share * plant.triangle_count() as f64) as usize;
        assert!(
            triangles <= asked + 1 && 50 * triangles > 49 * asked,
            "{triangles}"
        );
    }
}

#[test]
fn wood_gets_coarser_by_geometry_where_nothing_is_said() {
    let bench = Bench::new();
    let of = |wood: &str| {
        let report = simplified(&bench, &["--wood", wood, "--triangles", "0.25"]);
        assert_adds_up(&bench, &report);
        let [before, after] = counts(&report, "triangles");
        assert!(4 * after <= before + 2, "{wood}: {after} of {before}");
        let left = counts(&report, "wood_triangles");
        assert!(left[1] > 0 && left[1] < left[0], "{wood}: {left:?}");
        (report, std::fs::read(bench.path("out.glb")).unwrap())
    };
    let [auto, geometry] = ["auto", "geometry"].map(of);
    crate::validator::assert_valid(&[bench.path("out.glb")]);
    assert_eq!(geometry.0["settings"]["wood"], "geometry");
    // What `auto` runs is named.
    assert_eq!(auto.0["settings"]["wood"], "geometry");
    assert_eq!(auto.1, geometry.1);
}

#[test]
fn wood_that_is_kept_leaves_the_rest_of_the_budget() {
    let bench = Bench::new();
    let ignored = simplified(&bench, &["--ratio", "1"]);
    let [wood, _] = counts(&ignored, "wood_triangles");
    let budget = (wood + 100).to_string();
    let report = simplified(&bench, &["--wood", "keep", "--triangles", &budget]);
    assert_adds_up(&bench, &report);
    assert_eq!(counts(&report, "wood_triangles"), [wood, wood]);
    assert_eq!(counts(&report, "foliage_triangles")[1], 100);

    let least = wood.to_string();
    let none = simplified(&bench, &["--wood", "keep", "--triangles", &least]);
    assert_eq!(counts(&none, "foliage_triangles")[1], 0);
    let below = (wood - 1).to_string();
    let files = ["oak.glb", "-o", "small.glb"];
    let small = ["--wood", "keep", "--triangles", &below];
    let says = format!("ask for {wood} or more");
    let run = bench.simplify(&[&files[..], &small].concat());
    run.failed_saying(&["the wood alone has", &says]);
    assert!(!bench.names().contains(&"small.glb".to_owned()));
}

#[test]
fn targets_of_leaves_leave_the_wood_alone_unless_it_is_said() {
    let bench = Bench::new();
    for target in [["--ratio", "0.25"], ["--leaves", "60"]] {
        let of = |wood: &[&str]| simplified(&bench, &[&target[..], wood].concat());
        let [default, ignored] = [&[][..], &["--wood", "ignore"]].map(of);
        assert_eq!(default["order_sha256"], ignored["order_sha256"]);
        assert_eq!(default["settings"]["wood"], "ignore");
        let [before, after] = counts(&default, "wood_triangles");
        assert_eq!(before, after);
        let auto = of(&["--wood", "auto"]);
        assert_adds_up(&bench, &auto);
        assert_eq!(counts(&auto, "leaves"), [OAK_LEAVES, OAK_LEAVES / 4]);
        let wood = counts(&auto, "wood_triangles");
        assert!(wood[1] > 0 && 4 * wood[1] < wood[0], "{wood:?}");
        // Wood hides leaves where it is looked at.
        assert_ne!(auto["order_sha256"], ignored["order_sha256"]);
    }
}

#[test]
fn a_plant_may_have_no_wood() {
    let bench = Bench::new();
    for wood in ["auto", "keep", "geometry"] {
        let all = ["--foliage", "material:*", "--wood", wood];
        let report = simplified(&bench, &[&all[..], &["--triangles", "0.5"]].concat());
        assert_eq!(counts(&report, "wood_triangles"), [0, 0]);
        let [before, after] = counts(&report, "triangles");
        assert!(2 * after <= before + 1 && after > 0);
    }
}
