//! The breeze of the page: off at first, and by the formula of `secateur_runtime::wind`.

use image::RgbaImage;
use secateur::Surface;
use secateur::glam::DVec2;
use secateur::{Hold, plant_to_glb};
use secateur_eval::pictures::flip_mean;
use secateur_plant::{GrowOptions, Species, grow};
use secateur_runtime::wind::Wind;
use serde_json::Value;

use super::{differing, page_of_surfaces, surfaces_of};
use crate::program::Bench;
use crate::tab::{DESKTOP, Tab, decoded};

/// How long the wind has blown.
const SECONDS: f64 = 3.3;

/// The most mean FLIP between what the page sways and what was swayed before: both round positions, each
/// in its own box.
const MOST_FLIP: f64 = 0.006;

/// A maple, whose leaves and wood say what they hang on, and a level of it.
fn maple(bench: &Bench) -> [Vec<(Surface, bool)>; 2] {
    let options = GrowOptions {
        leaves: 150,
        seed: 2,
    };
    let plant = grow(Species::Maple, &options).unwrap();
    bench.put("maple.glb", &plant_to_glb(&plant));
    let level = ["maple.glb", "-o", "level.glb", "--ratio", "0.3"];
    bench.simplify(&level).succeeded();
    ["maple.glb", "level.glb"].map(|name| surfaces_of(&bench.read(name)))
}

/// The surfaces as the wind has moved them. They hang on nothing any more.
fn swayed(surfaces: &[(Surface, bool)], wind: Wind) -> Vec<(Surface, bool)> {
    let mut surfaces = surfaces.to_vec();
    for (surface, is_foliage) in &mut surfaces {
        let wind = match is_foliage {
            true => wind,
            false => wind.for_wood(),
        };
        let holds = std::mem::take(&mut surface.holds);
        assert_eq!(holds.len(), surface.positions.len());
        for (position, hold) in surface.positions.iter_mut().zip(&holds) {
            *position = wind.swayed(position.as_vec3(), hold).as_dvec3();
        }
        for (normal, hold) in surface.normals.iter_mut().zip(&holds) {
            let unmoved = Hold {
                along_m: 0.0,
                ..*hold
            };
            *normal = wind.swayed(hold.pivot + *normal, &unmoved) - hold.pivot;
        }
    }
    surfaces
}

fn picture(tab: &mut Tab, level: usize, camera: &Value, seconds: &Value) -> RgbaImage {
    let url = tab.ask(&format!(
        "preview.pictureOf({level}, {camera}, 384, 384, null, {seconds})"
    ));
    decoded(url.as_str().unwrap())
}

#[test]
fn the_original_and_its_level_sway_by_the_formula() {
    let Some(mut tab) = Tab::open(DESKTOP) else {
        return;
    };
    let bench = Bench::new();
    let trees = maple(&bench);
    bench.put("maple.html", page_of_surfaces(&trees).as_bytes());
    tab.visit(&bench.path("maple.html"));
    let camera = tab.ask("preview.chain.closeUp(preview.orbit, 1)");
    let height = tab.ask("preview.chain.size[1]").as_f64().unwrap();
    let still = [0, 1].map(|level| picture(&mut tab, level, &camera, &Value::Null));
    let found = [0, 1].map(|level| picture(&mut tab, level, &camera, &SECONDS.into()));

    // Nothing blows until it is asked to.
    assert_eq!(tab.ask("document.querySelector('#wind').hidden"), false);
    assert_eq!(tab.ask("preview.state.isWindy"), false);
    tab.click("#wind");
    let blown = "new Promise((done) => { const look = () => preview.state.windSeconds > 0 ? done(1) : setTimeout(look, 20); look(); })";
    assert_eq!(tab.ask(blown), 1);
    let pressed = "document.querySelector('#wind').ariaPressed";
    assert_eq!(tab.ask(pressed), "true");
    tab.press("#canvas", "b");
    assert_eq!(tab.ask("preview.state.isWindy"), false);
    assert_eq!(tab.complaints(), [""; 0]);

    let wind = Wind::new(DVec2::new(0.8, 0.6), height, 0.06 * height, 25.0);
    let moved = trees
        .each_ref()
        .map(|surfaces| swayed(surfaces, wind.at(SECONDS, 5.0)));
    bench.put("moved.html", page_of_surfaces(&moved).as_bytes());
    tab.visit(&bench.path("moved.html"));
    // What says nothing of what it hangs on cannot be swayed.
    assert_eq!(tab.ask("document.querySelector('#wind').hidden"), true);
    for level in 0..2 {
        let expected = picture(&mut tab, level, &camera, &Value::Null);
        let flip = flip_mean(&expected, &found[level]);
        let changed = differing(&still[level], &expected);
        eprintln!("level {level}: FLIP {flip:.5}, {changed:.3} of the picture moved");
        assert!(changed > 0.02, "level {level}: {changed}");
        assert!(flip < MOST_FLIP, "level {level}: {flip}");
    }
}
