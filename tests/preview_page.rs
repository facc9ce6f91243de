//! The page to look at levels of detail, in a real browser, used as people use
//! it; and its pictures against those of three.js.

mod continuous;
mod labels;
mod odd_card;
mod wind;

use std::path::Path;
use std::sync::OnceLock;

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use image::RgbaImage;
use secateur::{Detail, Difference, Document, Surface};
use secateur_eval::pictures::flip_mean;
use secateur_levels::chain::{LevelKind, LevelReport};
use secateur_pages::preview::{Facts, Level, Preview, page};
use secateur_runtime::Screen;
use serde_json::{Value, json};

use crate::program::{Bench, oak, shared_tree};
use crate::tab::{DESKTOP, Device, PHONE, Tab, decoded};

/// The most mean FLIP between a picture of the page and one of three.js.
const MOST_FLIP: f64 = 0.03;

fn surfaces_of(glb: &[u8]) -> Vec<(Surface, bool)> {
    let document = Document::from_bytes("tree.glb", glb.to_vec(), None).unwrap();
    document.surfaces_with(Detail::Full, &[]).unwrap()
}

/// A page of trees from fine to coarse, each half as high on the screen as the
/// one before, from 600 pixels on.
fn page_of(trees: &[&[u8]]) -> String {
    let surfaces: Vec<_> = trees.iter().map(|glb| surfaces_of(glb)).collect();
    page_of_surfaces(&surfaces)
}

/// The page of what is drawn of each tree.
fn page_of_surfaces(surfaces: &[Vec<(Surface, bool)>]) -> String {
    let heights = || {
        surfaces[0]
            .iter()
            .flat_map(|(s, _)| s.positions.iter().map(|p| p.y))
    };
    let height = heights().fold(f64::MIN, f64::max) - heights().fold(f64::MAX, f64::min);
    let screen = Screen::default();
    let levels = surfaces.iter().enumerate().map(|(k, surfaces)| {
        let triangles = |which: bool| -> u64 {
            let of = surfaces
                .iter()
                .filter(|(_, is_foliage)| *is_foliage == which);
            of.map(|(s, _)| s.triangles.len() as u64).sum()
        };
        let pixels_high = (k > 0).then(|| 600.0 / f64::powi(2.0, k as i32 - 1));
        let report = LevelReport {
            kind: match k {
                0 => LevelKind::Original,
                _ => LevelKind::Mesh,
            },
            triangles: triangles(true) + triangles(false),
            foliage_triangles: triangles(true),
            wood_triangles: triangles(false),
            distance: pixels_high.map_or(0.0, |pixels| screen.distance(height, pixels)),
            pixels_high: pixels_high.unwrap_or(f64::INFINITY),
            difference: Difference {
                difference: 0.123,
                ..Difference::default()
            },
            silhouette_iou: Some(0.987),
            pop: (k > 1).then_some(0.456),
            ..LevelReport::default()
        };
        let name = format!("LOD{k}");
        let facts = Facts { name, report };
        Level {
            surfaces,
            ends: None,
            facts,
        }
    });
    let levels: Vec<Level<'_>> = levels.collect();
    let preview = Preview {
        title: "A small <oak>",
        screen,
        levels: &levels,
        continuous: None,
    };
    page(&preview).unwrap()
}

/// A small oak, and the same with half and a tenth of its leaves.
fn oak_page() -> &'static str {
    static PAGE: OnceLock<String> = OnceLock::new();
    PAGE.get_or_init(|| {
        let bench = Bench::new();
        for (name, ratio) in [("half.glb", "0.5"), ("tenth.glb", "0.1")] {
            let arguments = ["oak.glb", "-o", name, "--ratio", ratio];
            bench.simplify(&arguments).succeeded();
        }
        page_of(&[oak(), &bench.read("half.glb"), &bench.read("tenth.glb")])
    })
}

/// Of all pixels, those that differ.
fn differing(a: &RgbaImage, b: &RgbaImage) -> f64 {
    if a.dimensions() != b.dimensions() {
        return 1.0;
    }
    let pairs = a.pixels().zip(b.pixels());
    let is_other = |a: &image::Rgba<u8>, b: &image::Rgba<u8>| {
        a.0.iter().zip(b.0).any(|(&a, b)| a.abs_diff(b) > 8)
    };
    let other = pairs.filter(|(a, b)| is_other(a, b)).count();
    other as f64 / (f64::from(a.width()) * f64::from(a.height()))
}

/// Of all pixels, those that are not background: the colour of most of the rim.
fn drawn(picture: &RgbaImage) -> f64 {
    let background = image::RgbaImage::from_pixel(
        picture.width(),
        picture.height(),
        *picture.get_pixel(picture.width() - 6, 6),
    );
    differing(picture, &background)
}

/// The parts of the window in which trees are drawn. What lies over them is the
/// same in every picture, or small.
const PARTS: [&str; 4] = [
    "#half-original",
    "#half-level",
    "#inset-original",
    "#inset-level",
];

/// The four pictures of the tree, once they no longer change: a busy machine draws them frames
/// after what was asked for.
fn parts(tab: &mut Tab) -> [RgbaImage; 4] {
    const MOST_PICTURES: usize = 12;
    tab.ask("scrollTo(0, 0)");
    let mut picture = tab.picture();
    for _ in 0..MOST_PICTURES {
        let again = tab.picture();
        let is_settled = PARTS
            .iter()
            .all(|part| tab.part(&again, part) == tab.part(&picture, part));
        picture = again;
        if is_settled {
            break;
        }
    }
    PARTS.map(|selector| tab.part(&picture, selector))
}

fn opened(device: Device) -> Option<(Tab, tempfile::TempDir)> {
    let mut tab = Tab::open(device)?;
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("preview.html");
    std::fs::write(&path, oak_page()).unwrap();
    tab.visit(&path);
    Some((tab, folder))
}

/// What must be true of a page at any size, after anything was done with it.
fn check_manners(tab: &mut Tab) {
    assert_eq!(tab.complaints(), [""; 0], "nothing reaches the console");
    let asked_for = tab.asked_for();
    assert_eq!(asked_for.len(), 1, "only the page itself: {asked_for:?}");
    let overhang = "document.documentElement.scrollWidth - innerWidth";
    assert!(
        tab.ask(overhang).as_f64().unwrap() <= 0.0,
        "nothing is too wide"
    );
}

fn is_all_drawn(device: Device) {
    let Some((mut tab, _folder)) = opened(device) else {
        return;
    };
    for (part, name) in parts(&mut tab).iter().zip(PARTS) {
        let share = drawn(part);
        assert!((0.04..0.9).contains(&share), "{name}: {share} is drawn");
    }
    let text = tab.ask("document.body.innerText");
    for expected in [
        "A small <oak>",
        "Original",
        "LOD2",
        ".12",
        "98.7 %",
        "300 px",
    ] {
        assert!(
            text.as_str().unwrap().contains(expected),
            "{expected}: {text}"
        );
    }
    check_manners(&mut tab);
}

#[test]
fn a_preview_draws_everything_on_a_desktop() {
    is_all_drawn(DESKTOP);
}

#[test]
fn a_preview_draws_everything_on_a_phone() {
    is_all_drawn(PHONE);
}

#[test]
fn levels_are_chosen_by_hand_and_by_distance() {
    let Some((mut tab, _folder)) = opened(DESKTOP) else {
        return;
    };
    tab.press("#level", "Home");
    let finest = parts(&mut tab);
    assert_eq!(tab.ask("preview.state.level"), 0);
    assert!(
        differing(&finest[0], &finest[1]) < 0.1,
        "the same but for the words"
    );
    tab.press("#level", "End");
    let coarsest = parts(&mut tab);
    assert_eq!(
        differing(&finest[0], &coarsest[0]),
        0.0,
        "the original stays"
    );
    assert!(differing(&finest[1], &coarsest[1]) > 0.02);
    assert!(differing(&finest[3], &coarsest[3]) > 0.02);
    assert_eq!(
        tab.ask("document.querySelector('#auto').ariaPressed"),
        "false"
    );

    // A distance chooses again; far off, the true picture is smaller.
    tab.press("#distance", "Home");
    assert_eq!(tab.ask("preview.state.level"), 0);
    let near = parts(&mut tab);
    tab.press("#distance", "End");
    assert_eq!(tab.ask("preview.state.level"), 2);
    let far = parts(&mut tab);
    assert!(drawn(&far[2]) < 0.3 * drawn(&near[2]));
    assert!(drawn(&far[2]) > 0.0);
    assert_eq!(
        tab.ask("document.querySelector('#auto').ariaPressed"),
        "true"
    );

    // Just before and just at the distance from which a level is used.
    let level_at = |tab: &mut Tab, factor: f64| {
        tab.ask(&format!(
            "preview.chain.levelAt(preview.chain.facts[1].distance * {factor})"
        ))
    };
    assert_eq!(level_at(&mut tab, 0.999), 0);
    assert_eq!(level_at(&mut tab, 1.0), 1);
    // The table's names choose too, and keys anywhere.
    tab.click("#levels tr:nth-child(2) button");
    assert_eq!(tab.ask("preview.state.level"), 1);
    tab.press("#leaves", "2");
    assert_eq!(tab.ask("preview.state.level"), 2);
    check_manners(&mut tab);
}

/// At true size the tree is as many pixels high as the page says.
#[test]
fn true_size_is_true() {
    let Some((mut tab, _folder)) = opened(DESKTOP) else {
        return;
    };
    tab.ask("preview.orbit.pitch = 0; preview.orbit.turn(0, 0)");
    let [_, _, original, _] = parts(&mut tab);
    let pixels = tab.ask("preview.chain.pixelsHigh(preview.state.distance)");
    let background = *original.get_pixel(original.width() - 6, 6);
    let is_tree = |y: &u32| {
        // Beside the caption at the lower left.
        let from = original.width() / 3;
        (from..original.width() - 2).any(|x| *original.get_pixel(x, *y) != background)
    };
    let rows: Vec<u32> = (2..original.height() - 2).filter(is_tree).collect();
    let high = f64::from(rows.last().unwrap() - rows[0] + 1);
    let expected = pixels.as_f64().unwrap();
    // The lowest and highest parts lie before or behind the middle.
    assert!((high / expected - 1.0).abs() < 0.06, "{high} {expected}");
}

fn wood_and_leaves_hide(device: Device) {
    let Some((mut tab, _folder)) = opened(device) else {
        return;
    };
    let all = parts(&mut tab);
    tab.click("#leaves");
    let wood = parts(&mut tab);
    tab.click("#wood");
    let none = parts(&mut tab);
    tab.click("#leaves");
    let leaves = parts(&mut tab);
    for k in 0..4 {
        let shares = [&wood, &leaves].map(|parts| differing(&parts[k], &none[k]));
        let whole = differing(&all[k], &none[k]);
        for share in shares {
            assert!(
                share > 0.002 && share < whole,
                "{}: {shares:?} of {whole}",
                PARTS[k]
            );
        }
    }
    tab.click("#wood");
    tab.click("#wire");
    let wire = parts(&mut tab);
    assert!(differing(&wire[0], &all[0]) > 0.05 && differing(&wire[1], &all[1]) > 0.05);
    assert_eq!(
        differing(&wire[2], &all[2]),
        0.0,
        "true size stays as it is"
    );
    tab.click("#true-size");
    let shown = tab.ask("document.querySelector('#true-size').ariaPressed");
    assert_eq!(shown, "true");
    check_manners(&mut tab);
}

#[test]
fn wood_and_leaves_hide_on_a_desktop() {
    wood_and_leaves_hide(DESKTOP);
}

#[test]
fn wood_and_leaves_hide_on_a_phone() {
    wood_and_leaves_hide(PHONE);
}

fn one_camera_turns_both(device: Device) {
    let Some((mut tab, _folder)) = opened(device) else {
        return;
    };
    let before = parts(&mut tab);
    let mut turned = |act: &dyn Fn(&mut Tab), what: &str, least: f64| {
        act(&mut tab);
        let after = parts(&mut tab);
        for k in 0..2 {
            let share = differing(&before[k], &after[k]);
            assert!(share > least, "{what}: {share} of {} changed", PARTS[k]);
        }
        tab.click("#reset");
        let again = parts(&mut tab);
        assert_eq!(differing(&before[0], &again[0]), 0.0, "after {what}");
    };
    turned(
        &|tab| tab.drag_from("#half-level", [60.0, 0.0]),
        "a drag",
        0.05,
    );
    turned(&|tab| tab.zoom_in("#half-level"), "a zoom", 0.05);
    turned(
        &|tab| tab.press("#canvas", "ArrowLeft"),
        "an arrow key",
        0.03,
    );
    turned(&|tab| tab.press("#canvas", "+"), "a plus", 0.03);
    let zoom = |tab: &mut Tab| tab.ask("preview.orbit.zoom").as_f64().unwrap();
    tab.zoom_in("#half-original");
    assert!(zoom(&mut tab) > 1.3);
    let y = tab.ask("scrollY");
    assert_eq!(y, 0, "the page does not move along");
    check_manners(&mut tab);
}

#[test]
fn mouse_and_keys_turn_the_trees() {
    one_camera_turns_both(DESKTOP);
}

#[test]
fn fingers_turn_the_trees() {
    one_camera_turns_both(PHONE);
}

#[test]
fn spinning_shows_frames_per_second_and_everything_has_a_name() {
    let Some((mut tab, _folder)) = opened(DESKTOP) else {
        return;
    };
    let yaw = |tab: &mut Tab| tab.ask("preview.orbit.yaw").as_f64().unwrap();
    let before = yaw(&mut tab);
    tab.click("#spin");
    let shown = "new Promise((done) => { const look = () => { const t = document.querySelector('#fps').textContent; t ? done(t) : setTimeout(look, 100); }; look(); })";
    let fps = tab.ask(shown);
    assert!(fps.as_str().unwrap().ends_with(" fps"), "{fps}");
    assert!(yaw(&mut tab) != before);
    tab.click("#spin");
    let controls = tab.controls();
    let sliders = controls.iter().filter(|(role, _)| role == "slider");
    assert_eq!(sliders.count(), 2, "{controls:?}");
    for (role, name) in &controls {
        assert!(!name.is_empty(), "a {role} has a name: {controls:?}");
    }
    check_manners(&mut tab);
}

/// Away from the tree, through all levels; whoever chooses a level stops it.
#[test]
fn a_walk_plays_through_the_levels() {
    let Some((mut tab, _folder)) = opened(DESKTOP) else {
        return;
    };
    tab.press("#distance", "Home");
    tab.click("#walk");
    let reached = "new Promise((done) => { const seen = new Set(); const look = () => { seen.add(preview.state.level); preview.state.isGoingAway && seen.size < 3 ? setTimeout(look, 20) : done([...seen]); }; look(); })";
    assert_eq!(tab.ask(reached), json!([0, 1, 2]), "level after level");
    tab.press("#level", "Home");
    assert_eq!(tab.ask("preview.state.isWalking"), false);
    let distance = |tab: &mut Tab| tab.ask("preview.state.distance").as_f64().unwrap();
    let stood = distance(&mut tab);
    tab.ask("new Promise((done) => setTimeout(() => done(0), 200))");
    assert_eq!(distance(&mut tab), stood, "it stands still again");
    tab.press("#level", "End");
    let text = tab.ask("document.querySelector('#switch').innerText");
    assert!(text.as_str().unwrap().contains(".46"), "{text}");
    check_manners(&mut tab);
}

/// How pictures of the page's first level by its own renderer and by three.js
/// differ under the same light and cameras, given by yaw and pitch.
fn flip_against_three(glb: &[u8], views: &[[f64; 2]]) -> Option<Vec<f64>> {
    let modules =
        Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/browser/node_modules/three");
    if !modules.is_dir() {
        let hint = "three.js is missing; npm ci --prefix tests/browser";
        let is_required = std::env::var("SECATEUR_REQUIRE_THREE").is_ok_and(|v| v == "1");
        assert!(!is_required, "{hint}");
        eprintln!("SKIPPED comparison with three.js: {hint}");
        return None;
    }
    let mut tab = Tab::open(DESKTOP)?;
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name);
    std::fs::write(path("preview.html"), page_of(&[glb])).unwrap();
    let base = format!("file://{}", modules.canonicalize().unwrap().display());
    let map = json!({"imports": {
        "three": format!("{base}/build/three.module.js"),
        "three/addons/": format!("{base}/examples/jsm/"),
    }});
    let script = include_str!("browser/three.js");
    let harness = format!(
        "<!DOCTYPE html><script type=\"importmap\">{map}</script><script type=\"module\">{script}</script>"
    );
    std::fs::write(path("three.html"), harness).unwrap();

    tab.visit(&path("preview.html"));
    let light = tab.ask("preview.light");
    let mut ours = Vec::new();
    for [yaw, pitch] in views {
        let camera = tab.ask(&format!(
            "(Object.assign(preview.orbit, {{ yaw: {yaw}, pitch: {pitch} }}), preview.chain.closeUp(preview.orbit, 1))"
        ));
        let url = tab.ask(&format!("preview.pictureOf(0, {camera}, 512, 512)"));
        ours.push((camera, decoded(url.as_str().unwrap())));
    }
    tab.visit(&path("three.html"));
    let glb = STANDARD.encode(glb);
    tab.ask(&format!("window.glb = '{glb}', 0"));
    let compare = |(camera, ours): (Value, RgbaImage)| {
        let url = tab.ask(&format!("drawWithThree(glb, {camera}, {light}, 512, 512)"));
        let theirs = decoded(url.as_str().unwrap());
        let share = drawn(&theirs);
        assert!((0.04..0.9).contains(&share), "three.js drew {share}");
        flip_mean(&theirs, &ours)
    };
    Some(ours.into_iter().map(compare).collect())
}

const VIEWS: [[f64; 2]; 3] = [[0.6, 0.12], [3.6, -0.3], [5.0, 1.1]];

#[track_caller]
fn agrees_with_three(name: &str, glb: &[u8]) {
    for flip in flip_against_three(glb, &VIEWS).unwrap_or_default() {
        eprintln!("{name}: FLIP {flip:.4} against three.js");
        assert!(flip < MOST_FLIP, "{name}: {flip}");
    }
}

/// Cut-outs, wood with a texture and leaves with vertex colours.
#[test]
fn a_grown_tree_looks_as_in_three_js() {
    agrees_with_three("oak", oak());
}

#[test]
fn instances_transforms_colours_and_normal_maps_look_as_in_three_js() {
    agrees_with_three("odd card", &odd_card::glb());
}

#[test]
fn real_trees_look_as_in_three_js() {
    for name in [
        "ez_bush2.glb",
        "quat_commontree_1.glb",
        "sap_birch_hex_9k.glb",
    ] {
        if let Some(tree) = shared_tree(name) {
            agrees_with_three(name, &std::fs::read(tree).unwrap());
        }
    }
}
