//! Wind: levels that say what they hang on, as the page makes and shows them.

use secateur_plant::{GrowOptions, Species, grow};
use serde_json::json;

use super::bytes::{of_page, of_program};
use super::{check_manners, opened, opens, wait_for};
use crate::program::Bench;
use crate::tab::DESKTOP;
use crate::wind::silent;

/// A plant that does not say what it hangs on: with the box ticked its levels have the bytes of `--wind`, and a button
/// lets them sway.
#[test]
fn levels_of_a_silent_plant_sway() {
    let Some(mut tab) = opened(DESKTOP) else {
        return;
    };
    let leaves = GrowOptions {
        leaves: 12,
        seed: 7,
    };
    let bench = Bench::new();
    let grown = secateur::plant_into_glb(grow(Species::Rowan, &leaves).unwrap());
    bench.put("plant.glb", &silent(&grown));
    opens(&mut tab, &bench, &["plant.glb"]);
    let is_hidden = "document.querySelector('#wind').hidden";
    let decided =
        json!({"kind": "level", "level": {"amount": "share", "value": 0.3}, "effort": "fast"});
    let words = ["simplify", "--triangles", "0.3", "--effort", "fast"];
    assert_eq!(of_page(&mut tab, &decided), of_program(&bench, &words));
    assert_eq!(
        tab.ask(is_hidden),
        json!(true),
        "nothing says what it hangs on"
    );
    tab.ask("document.querySelector('#sways').click()");
    wait_for(&mut tab, "page.decisions.now.wind && !page.state.isBusy");
    let words = [&words[..], &["--wind", "--overwrite"]].concat();
    assert_eq!(of_page(&mut tab, &decided), of_program(&bench, &words));
    let command = tab.ask("document.querySelector('#command').innerText");
    assert!(command.as_str().unwrap().contains(" --wind"), "{command}");
    assert_eq!(tab.ask(is_hidden), json!(false));
    let frames = "(async () => { const { stage } = page; let frames = 0; const draw = stage.draw; stage.draw = function () { frames += 1; draw.call(this); }; await new Promise((done) => setTimeout(done, 600)); stage.draw = draw; return frames; })()";
    tab.ask("document.querySelector('#wind').click()");
    assert!(
        tab.ask(frames).as_u64().unwrap() > 2,
        "it is drawn again and again"
    );
    tab.ask("document.querySelector('#wind').click()");
    tab.ask("new Promise((done) => setTimeout(done, 200))");
    assert_eq!(tab.ask(frames), json!(0), "it stands still");
    check_manners(&mut tab);
}
