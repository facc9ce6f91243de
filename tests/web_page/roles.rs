//! Roles that people correct in the page: of parts, and of connected pieces; with the bytes of the program.

use serde_json::{Value, json};

use super::bytes::{of_page, of_program};
use super::{check_manners, opened, opens, text_of, wait_for};
use crate::program::Bench;
use crate::tab::{DESKTOP, Tab};

/// The page with an oak in it, and a folder with that oak as `plant.glb`; none where there is no browser.
pub(super) fn with_oak() -> Option<(Tab, Bench)> {
    let mut tab = opened(DESKTOP)?;
    let bench = Bench::new();
    bench.put("plant.glb", crate::program::oak());
    opens(&mut tab, &bench, &["plant.glb"]);
    Some((tab, bench))
}

/// Clicks the picture where a part of this role is drawn, well inside of it.
fn click_on(tab: &mut Tab, role: &str) {
    let found = tab.ask(&format!(
        "(() => {{
            const canvas = document.querySelector('#canvas');
            const r = canvas.getBoundingClientRect();
            for (let y = 0; y < 60; y++) for (let x = 0; x < 60; x++) {{
                const at = [r.x + (x + .5) * r.width / 60, r.y + (y + .5) * r.height / 60].map(Math.round);
                const roles = [-2, 0, 2].map((by) => page.stage.partAt(at[0] + by, at[1] + by)?.role);
                if (!roles.every((role) => role === '{role}')) continue;
                return at;
            }}
            return null;
        }})()"
    ));
    let at = [0, 1].map(|k| found[k].as_f64().expect("a part of this role is drawn"));
    tab.click_at(at);
}

/// Roles are given to the piece that was clicked, not to its part.
fn mean_the_piece(tab: &mut Tab) {
    wait_for(tab, "page.stage.view.met !== null");
    tab.ask("void (document.querySelector('#scope').value = 'piece', document.querySelector('#scope').dispatchEvent(new Event('change')))");
}

pub(super) fn settle(tab: &mut Tab) {
    wait_for(
        tab,
        "!page.state.isBusy && page.engine.open === page.decisions.opening && page.state.opening === page.decisions.opening",
    );
}

/// The options of the command line that the page shows, behind its output.
fn words(tab: &mut Tab) -> Vec<String> {
    let command = text_of(tab, "#command");
    // Every other part between quotes is one word.
    let parts = command.split('\'').enumerate();
    let words = parts.flat_map(|(k, part)| match k % 2 {
        0 => part.split_whitespace().map(str::to_owned).collect(),
        _ => vec![part.to_owned()],
    });
    let mut words = words.collect::<Vec<String>>().into_iter();
    assert_eq!(words.next().as_deref(), Some("secateur"));
    let [command, input, _, _] = [(); 4].map(|()| words.next().unwrap());
    assert_eq!(input, "plant.glb");
    std::iter::once(command).chain(words).collect()
}

/// What the page makes and what the program makes by the page's command line.
pub(super) fn assert_same_bytes(tab: &mut Tab, bench: &Bench) -> Vec<String> {
    let level = json!({"kind": "level", "level": {"amount": "share", "value": 0.3}});
    assert_same_bytes_of(tab, bench, level)
}

/// As [`assert_same_bytes`], of what is decided, made fast.
fn assert_same_bytes_of(tab: &mut Tab, bench: &Bench, mut decided: Value) -> Vec<String> {
    decided["effort"] = "fast".into();
    let page = of_page(tab, &decided);
    let words = words(tab);
    let words: Vec<&str> = words.iter().map(String::as_str).collect();
    assert_eq!(page, of_program(bench, &words), "{words:?}");
    page
}

#[test]
fn a_connected_piece_is_clicked_and_becomes_wood_or_leaves() {
    let Some((mut tab, bench)) = with_oak() else {
        return;
    };
    for (role, button, left) in [
        ("leaf", "#is-wood", "239 leaves"),
        ("wood", "#is-leaf", "241 leaves"),
    ] {
        click_on(&mut tab, role);
        wait_for(&mut tab, "page.stage.view.met !== null");
        assert!(text_of(&mut tab, "#why").contains("You clicked piece"));
        mean_the_piece(&mut tab);
        tab.click(button);
        settle(&mut tab);
        assert!(text_of(&mut tab, "#counts").contains(left), "{role}");
        assert_same_bytes(&mut tab, &bench);
        assert!(text_of(&mut tab, "#command").contains("--foliage piece:"));
        // What was decided before is taken back, and made again.
        let undo = |tab: &mut Tab, key: &str| {
            tab.ask(&format!("page.decisions.{key}()"));
            settle(tab);
        };
        while tab.ask("page.decisions.now.leaves.length") != 0 {
            undo(&mut tab, "undo");
        }
        assert!(text_of(&mut tab, "#counts").contains("240 leaves"));
        undo(&mut tab, "redo");
        assert!(text_of(&mut tab, "#counts").contains(left), "{role}");
        undo(&mut tab, "undo");
    }
    check_manners(&mut tab);
}

#[test]
fn a_part_that_is_not_the_plant_is_neither_counted_nor_changed() {
    let Some((mut tab, bench)) = with_oak() else {
        return;
    };
    let whole = tab.ask("page.state.inspection.wood_triangles");
    click_on(&mut tab, "wood");
    tab.click("#is-other");
    settle(&mut tab);
    assert!(text_of(&mut tab, "#counts").contains("240 leaves"));
    assert!(text_of(&mut tab, "#counts").ends_with(" 0 of wood"));
    assert!(text_of(&mut tab, "#parts").contains("Not the plant"));
    assert_eq!(
        tab.ask("page.decisions.now.leaves"),
        json!([]),
        "evidence decides still"
    );
    let level = assert_same_bytes(&mut tab, &bench);
    let command = text_of(&mut tab, "#command");
    assert!(command.contains("--not-plant"), "{command}");

    // The wood is there still, as it was, and drawn under the plant.
    let report = ["inspect", "out.glb", "--report", "r.json"];
    bench.run(&report).succeeded();
    let report: Value = bench.json("r.json");
    assert_eq!(report["wood_triangles"], whole);
    tab.click("#undo");
    tab.click("#undo");
    settle(&mut tab);
    assert_eq!(tab.ask("page.state.inspection.wood_triangles"), whole);
    assert_ne!(assert_same_bytes(&mut tab, &bench), level);
    check_manners(&mut tab);
}

#[test]
fn a_piece_that_is_not_the_plant_is_kept_by_page_and_program_alike() {
    let Some((mut tab, bench)) = with_oak() else {
        return;
    };
    click_on(&mut tab, "leaf");
    mean_the_piece(&mut tab);
    tab.click("#is-other");
    settle(&mut tab);
    assert!(text_of(&mut tab, "#counts").contains("239 leaves"));
    assert!(text_of(&mut tab, "#parts").contains("Not the plant"));
    assert_eq!(
        tab.ask("page.decisions.now.leaves"),
        json!([]),
        "evidence decides still"
    );
    assert_same_bytes(&mut tab, &bench);
    let command = text_of(&mut tab, "#command");
    assert!(command.contains("--not-plant piece:"), "{command}");

    // Who reads the level knows it for what it is.
    let report = ["inspect", "out.glb", "--report", "r.json"];
    bench.run(&report).succeeded();
    let report: Value = bench.json("r.json");
    let parts = report["primitives"].as_array().unwrap().iter();
    let roles: Vec<&Value> = parts.map(|part| &part["taken_for"]).collect();
    assert!(roles.contains(&&json!("not_plant")), "{roles:?}");
    let levels = json!({"kind": "chain", "levels": "shares", "shares": [0.5, 0.1]});
    assert_eq!(assert_same_bytes_of(&mut tab, &bench, levels).len(), 3);

    // The part is listed still, and can become a leaf again.
    tab.click("[data-mode=plant]");
    tab.ask("void ([...document.querySelectorAll('#parts button')].find((b) => b.innerText.includes('Not the plant')).id = 'other')");
    tab.click("#other");
    tab.click("#is-leaf");
    settle(&mut tab);
    assert!(text_of(&mut tab, "#counts").contains("240 leaves"));
    assert_eq!(tab.ask("page.decisions.now.notPlant"), json!([]));
    check_manners(&mut tab);
}
