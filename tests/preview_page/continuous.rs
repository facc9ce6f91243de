//! The slider over any number of leaves, by its pictures.

use image::RgbaImage;
use secateur::{Detail, Document};
use secateur_eval::pictures::flip_mean;
use secateur_levels::chain::{LevelKind, LevelReport};
use secateur_model::LodModel;
use secateur_pages::preview::{Continuous, Facts, Level, Preview, page};
use secateur_runtime::Screen;
use secateur_runtime::order_file::read_order;
use serde_json::{Value, json};

use super::{differing, drawn, page_of, surfaces_of};
use crate::program::{Bench, oak};
use crate::tab::{DESKTOP, Device, PHONE, Tab, decoded};

/// The most mean FLIP between a level as the page draws it from the order, and from its file: both
/// round positions, each in its own box.
const MOST_FLIP: f64 = 0.004;

/// An oak's order down to few leaves, with coarser ones and sizes where a run made them, beside it.
fn ordered(bench: &Bench, options: &[&str]) -> LodModel {
    let arguments = ["oak.glb", "-o", "few.glb", "--order", "oak.order"];
    bench
        .simplify(&[&arguments[..], options].concat())
        .succeeded();
    let tree = Document::from_bytes("oak.glb", oak().to_vec(), None);
    let tree = tree.unwrap().into_tree(&[]).unwrap();
    read_order(&bench.read("oak.order"), tree.foliage()).unwrap()
}

/// A page of the oak alone and of this order.
fn page_with(model: &LodModel) -> String {
    let tree = Document::from_bytes("oak.glb", oak().to_vec(), None);
    let tree = tree.unwrap().into_tree(&[]).unwrap();
    let of_leaves = tree.leaf_surfaces(Detail::Full).unwrap();
    let of_leaves: Vec<_> = of_leaves.into_iter().filter(|s| s.is_foliage).collect();
    let surfaces = surfaces_of(oak());
    let levels = [Level {
        surfaces: &surfaces,
        ends: None,
        facts: Facts {
            name: "original".to_owned(),
            report: LevelReport {
                kind: LevelKind::Original,
                leaves: tree.foliage().leaves().len() as u64,
                triangles: tree.triangle_count(),
                foliage_triangles: tree.leaf_triangle_count(),
                wood_triangles: tree.wood_triangle_count(),
                pixels_high: f64::INFINITY,
                ..LevelReport::default()
            },
        },
    }];
    let preview = Preview {
        title: "An oak",
        screen: Screen::default(),
        levels: &levels,
        continuous: Some(Continuous {
            surfaces: &of_leaves,
            foliage: tree.foliage(),
            model,
        }),
    };
    page(&preview).unwrap()
}

fn picture(tab: &mut Tab, camera: &Value, steps: &Value) -> RgbaImage {
    let url = tab.ask(&format!(
        "preview.pictureOf(0, {camera}, 384, 384, {steps})"
    ));
    decoded(url.as_str().unwrap())
}

/// Steps of the order, leaves and the picture of each of these levels, from the order and from the
/// file that `lod` writes of it.
#[track_caller]
fn check(options: &[&str]) {
    let Some(mut tab) = Tab::open(DESKTOP) else {
        return;
    };
    let bench = Bench::new();
    let model = ordered(&bench, options);
    bench.put("order.html", page_with(&model).as_bytes());
    tab.visit(&bench.path("order.html"));
    let camera = tab.ask("preview.chain.closeUp(preview.orbit, 1)");
    let [most, fewest] = [model.most_leaves(), model.fewest_leaves()];
    let mut pictures = Vec::new();
    for leaves in [most, most - 1, most / 2, most / 5, fewest] {
        let steps = model.steps_to(leaves);
        let of_page = tab.ask(&format!("preview.order.leaves[{steps}]"));
        assert_eq!(of_page, leaves, "after {steps} steps");
        let triangles = tab.ask(&format!("preview.order.triangles[{steps}]"));
        pictures.push((leaves, triangles, picture(&mut tab, &camera, &json!(steps))));
    }
    for (leaves, triangles, from_order) in &pictures {
        let leaves = leaves.to_string();
        let arguments = ["--order", "oak.order", "--leaves", &leaves, "--overwrite"];
        let report = ["--report", "level.json"];
        let lod = ["lod", "oak.glb", "-o", "level.glb"];
        bench
            .run(&[&lod[..], &arguments, &report].concat())
            .succeeded();
        assert_eq!(
            bench.json("level.json")["foliage_triangles"]["final"],
            *triangles
        );
        bench.put(
            "level.html",
            page_of(&[&bench.read("level.glb")]).as_bytes(),
        );
        tab.visit(&bench.path("level.html"));
        let from_file = picture(&mut tab, &camera, &Value::Null);
        let share = drawn(&from_file);
        assert!((0.04..0.9).contains(&share), "{share} is drawn");
        let flip = flip_mean(&from_file, from_order);
        eprintln!("{options:?}, {leaves} leaves: FLIP {flip:.5}");
        assert!(flip < MOST_FLIP, "{leaves} leaves: {flip}");
    }
    let [finest, .., coarsest] = &pictures[..] else {
        unreachable!("five levels")
    };
    assert!(differing(&finest.2, &coarsest.2) > 0.02);
    assert_eq!(tab.complaints(), [""; 0]);
}

/// At first each becomes one triangle; then each step removes a leaf and lets one grow.
#[test]
fn any_number_of_leaves_is_drawn_as_its_file() {
    check(&["--leaves", "30", "--fit=none", "--leaf-triangles", "1"]);
}

/// Two leaves become one that is new.
#[test]
fn leaves_that_are_made_are_drawn_as_in_their_file() {
    check(&["--leaves", "30", "--method", "fsa"]);
}

fn is_chosen_by_its_slider(device: Device) {
    let Some(mut tab) = Tab::open(device) else {
        return;
    };
    let bench = Bench::new();
    let model = ordered(&bench, &["--leaves", "30", "--fit=none"]);
    bench.put("order.html", page_with(&model).as_bytes());
    tab.visit(&bench.path("order.html"));
    assert_eq!(tab.ask("preview.state.steps"), Value::Null);
    let last = model.order().len();
    for (key, steps) in [("End", last), ("ArrowLeft", last - 1), ("Home", 0)] {
        tab.press("#steps", key);
        assert_eq!(tab.ask("preview.state.steps"), steps, "{key}");
        let text = tab.ask("document.querySelector('#steps-text').textContent");
        let leaves = tab.ask("preview.order.leaves[preview.state.steps]");
        assert_eq!(text.as_str().unwrap(), leaves.to_string(), "{key}");
    }
    tab.drag_from("#steps", [12.0, 0.0]);
    let middle = tab.ask("preview.state.steps").as_u64().unwrap() as usize;
    assert!((last / 4..last).contains(&middle), "{middle} of {last}");
    tab.press("#canvas", ",");
    assert!(tab.ask("preview.state.steps").as_u64().unwrap() < middle as u64);
    // A level takes the leaves' place, also one that its slider stands on already.
    tab.click("#levels button");
    assert_eq!(tab.ask("preview.state.steps"), Value::Null);
    tab.press("#steps", "Home");
    assert_eq!(tab.ask("preview.state.steps"), 0);
    assert_eq!(tab.ask("document.querySelector('#level').value"), "0");
    tab.press("#level", "Home");
    assert_eq!(tab.ask("preview.state.steps"), Value::Null);
    tab.press("#steps", "Home");
    tab.press("#level", "Shift");
    assert_eq!(tab.ask("preview.state.steps"), 0, "no key of a slider");
    // A touch of a slider makes no click.
    if !device.has_touch {
        tab.click("#level");
        assert_eq!(tab.ask("preview.state.steps"), Value::Null);
    }
    super::check_manners(&mut tab);
}

#[test]
fn the_slider_of_leaves_takes_keys_and_the_mouse() {
    is_chosen_by_its_slider(DESKTOP);
}

#[test]
fn the_slider_of_leaves_takes_fingers() {
    is_chosen_by_its_slider(PHONE);
}
