//! The page that makes levels, as `web/build.sh` builds it: opened from a disk in a real browser, and used by mouse,
//! fingers and keys as people use it.

mod bytes;
mod first_answer;
mod lasso;
mod roles;
mod wind;

use std::path::PathBuf;

use serde_json::{Value, json};

use crate::glb;
use crate::program::{Bench, oak};
use crate::tab::{DESKTOP, Device, PHONE, Tab};

/// The page, or nothing where it is not built, unless the environment has `SECATEUR_REQUIRE_WEB=1`: then it panics.
fn built() -> Option<PathBuf> {
    let target = std::env::var_os("CARGO_TARGET_DIR").map_or_else(
        || PathBuf::from(concat!(env!("CARGO_MANIFEST_DIR"), "/../../target")),
        PathBuf::from,
    );
    let page = target.join("web-quick/secateur.html");
    if page.is_file() {
        return Some(page);
    }
    let hint = "the page is not built: bash web/build.sh quick";
    let is_required = std::env::var("SECATEUR_REQUIRE_WEB").is_ok_and(|v| v == "1");
    assert!(!is_required, "{hint}");
    eprintln!("SKIPPED: {hint}");
    None
}

fn opened(device: Device) -> Option<Tab> {
    let page = built()?;
    let mut tab = Tab::open(device)?;
    tab.visit(&page);
    Some(tab)
}

/// Waits until something is true of the page.
#[track_caller]
fn wait_for(tab: &mut Tab, condition: &str) {
    let question = format!(
        "new Promise((done) => {{ const end = performance.now() + 100000; const look = () => ({condition}) ? done(true) : performance.now() > end ? done(document.querySelector('aside').innerText) : setTimeout(look, 30); look(); }})"
    );
    let answer = tab.ask(&question);
    assert_eq!(answer, json!(true), "{condition}");
}

fn opens(tab: &mut Tab, bench: &Bench, files: &[&str]) {
    let paths: Vec<PathBuf> = files.iter().map(|name| bench.path(name)).collect();
    tab.choose_files("#files", &paths);
    wait_for(
        tab,
        "!page.state.isBusy && (page.state.source !== null || document.querySelector('#error').innerText)",
    );
}

/// What must be true of the page after anything was done with it.
#[track_caller]
fn check_manners(tab: &mut Tab) {
    assert_eq!(tab.complaints(), [""; 0], "nothing reaches the console");
    assert_eq!(tab.asked_for().len(), 1, "only the page itself");
    let overhang = "document.documentElement.scrollWidth - innerWidth";
    assert!(tab.ask(overhang).as_f64().unwrap() <= 0.0, "too wide");
    for (role, name) in tab.controls() {
        assert!(!name.is_empty(), "a {role} has a name");
    }
}

/// Which share of the picture is not its background, and of its height the share that has such pixels.
fn drawn(tab: &mut Tab) -> [f64; 2] {
    let picture = tab.picture();
    let part = tab.part(&picture, "#canvas");
    let background = *part.get_pixel(2, 2);
    let differs = part.enumerate_pixels();
    let rows: Vec<u32> = differs
        .filter(|(.., pixel)| **pixel != background)
        .map(|(_, y, _)| y)
        .collect();
    let high = rows
        .iter()
        .max()
        .zip(rows.iter().min())
        .map_or(0, |(last, first)| last - first);
    let pixels = f64::from(part.width() * part.height());
    [
        rows.len() as f64 / pixels,
        f64::from(high) / f64::from(part.height()),
    ]
}

fn text_of(tab: &mut Tab, selector: &str) -> String {
    let text = tab.ask(&format!("document.querySelector('{selector}').innerText"));
    text.as_str().unwrap().to_owned()
}

/// Opens, corrects what a part is, takes it back, simplifies, compares, and has something to take home.
#[test]
fn a_plant_is_opened_corrected_made_lighter_and_compared() {
    let Some(mut tab) = opened(DESKTOP) else {
        return;
    };
    let bench = Bench::new();
    opens(&mut tab, &bench, &["oak.glb"]);
    let [_, high] = drawn(&mut tab);
    assert!(
        (0.75..0.99).contains(&high),
        "the plant fills the picture: {high}"
    );
    assert!(text_of(&mut tab, "#counts").contains("240 leaves"));

    // The trunk becomes leaves, and wood again.
    tab.click("#roles");
    let trunk =
        "[...document.querySelectorAll('#parts button')].find((b) => b.innerText.includes('Wood'))";
    tab.ask(&format!("void ({trunk}.id = 'trunk')"));
    tab.click("#trunk");
    assert!(text_of(&mut tab, "#why").contains("pieces"));
    tab.click("#is-leaf");
    let is_settled = |leaves: bool| {
        format!(
            "!page.state.isBusy && page.engine.open === page.decisions.opening && (page.decisions.now.leaves.length > 0) === {leaves}"
        )
    };
    wait_for(&mut tab, &is_settled(true));
    assert!(!text_of(&mut tab, "#parts").contains("Wood"));
    tab.press_with_control("z");
    wait_for(&mut tab, &is_settled(false));
    assert!(text_of(&mut tab, "#parts").contains("Wood"));

    tab.click("[data-kind=level]");
    tab.click("#make");
    wait_for(
        &mut tab,
        "document.querySelector('#of-home').hidden === false",
    );
    let triangles = tab.ask("page.state.results.get(page.decisions.key).levels[0].triangles");
    let all = tab.ask("page.state.results.get(page.decisions.key).original.triangles");
    let [left, all] = [triangles, all].map(|count| count.as_f64().unwrap());
    assert!(left <= 0.25 * all && left > 0.15 * all, "{left} of {all}");
    for mode in ["beside", "wipe", "blink", "difference"] {
        tab.click(&format!("[data-mode={mode}]"));
        let [share, _] = drawn(&mut tab);
        assert!(share > 0.03, "{mode}: {share}");
    }
    tab.ask("page.stage.set({ level: 0 })");
    let [only_the_legend, _] = drawn(&mut tab);
    assert!(
        only_the_legend < 0.025,
        "the plant is equal to itself: {only_the_legend}"
    );
    tab.ask("page.stage.set({ level: 1 })");
    tab.click("#true-size");
    assert!(drawn(&mut tab)[0] > 0.0);
    let command = text_of(&mut tab, "#command");
    assert_eq!(
        command,
        "secateur simplify oak.glb -o oak_lighter.glb --triangles 0.25"
    );

    // What was made is there again after undo and redo.
    tab.press_with_control("z");
    assert_eq!(tab.ask("page.decisions.now.kind"), "chain");
    assert_eq!(
        tab.ask("document.querySelector('#of-home').hidden"),
        json!(true)
    );
    tab.click("#redo");
    assert_eq!(
        tab.ask("document.querySelector('#of-home').hidden"),
        json!(false)
    );
    check_manners(&mut tab);
}

/// A part that is clicked in the picture is the part that is drawn there.
#[test]
fn a_click_picks_what_is_under_it() {
    let Some(mut tab) = opened(DESKTOP) else {
        return;
    };
    opens(&mut tab, &Bench::new(), &["oak.glb"]);
    let found = tab.ask(
        "(() => { const r = document.querySelector('#canvas').getBoundingClientRect(); const roles = {}; for (let y = 0; y < 20; y++) for (let x = 0; x < 20; x++) { const part = page.stage.partAt(r.x + (x + .5) * r.width / 20, r.y + (y + .5) * r.height / 20); const role = part?.role ?? 'none'; roles[role] = (roles[role] ?? 0) + 1; } return roles; })()",
    );
    for role in ["leaf", "wood", "none"] {
        assert!(found[role].as_u64().unwrap_or(0) > 3, "{role}: {found}");
    }
    tab.click("#canvas");
    let picked = tab.ask("page.stage.view.picked");
    assert!(
        picked
            .as_str()
            .is_some_and(|place| place.starts_with("meshes[")),
        "{picked}"
    );
    check_manners(&mut tab);
}

/// All of it by fingers, in a window 390 pixels wide.
#[test]
fn a_plant_is_grown_and_made_lighter_by_fingers() {
    let Some(mut tab) = opened(PHONE) else {
        return;
    };
    tab.ask("void page.open({ grown: { species: 'bush', leaves: 150, seed: 1 } })");
    wait_for(&mut tab, "!page.state.isBusy && page.state.source !== null");
    assert!(drawn(&mut tab)[0] > 0.1);
    tab.click("[data-kind=level]");
    tab.ask("page.decisions.decide({ level: { amount: 'triangles', value: 200 } })");
    tab.click("#make");
    wait_for(
        &mut tab,
        "document.querySelector('#of-home').hidden === false",
    );
    assert!(text_of(&mut tab, "#command").starts_with("secateur grow bush --leaves 150"));
    let small = tab.ask(
        "[...document.querySelectorAll('button, select, input, summary')].filter((e) => e.offsetParent && e.type !== 'checkbox').map((e) => [e.id || e.innerText, e.getBoundingClientRect()]).filter(([, r]) => r.height < 43.5 || r.width < 43.5).map(([name]) => name)",
    );
    assert_eq!(small, json!([]), "touch targets are at least 44 pixels");

    // Any number of leaves of that level, from all to its own.
    let leaves = text_of(&mut tab, "#leaves-text");
    tab.ask("void (document.querySelector('#leaves').value = 1, document.querySelector('#leaves').dispatchEvent(new Event('input')))");
    let [few, many] = [leaves, text_of(&mut tab, "#leaves-text")].map(|text| text.parse::<u32>());
    assert!(
        few.clone().unwrap() < many.clone().unwrap(),
        "{few:?} {many:?}"
    );
    let caption = text_of(&mut tab, "#captions");
    assert!(
        caption.contains(&format!("{} leaves", many.unwrap())),
        "{caption}"
    );
    assert!(drawn(&mut tab)[0] > 0.05);
    check_manners(&mut tab);
}

/// A chain by keys alone; it is broken off within a second, and made afterwards.
#[test]
fn a_chain_is_cancelled_at_once_and_made_by_keys() {
    let Some(mut tab) = opened(DESKTOP) else {
        return;
    };
    tab.ask("void page.open({ grown: { species: 'rowan', leaves: 12, seed: 2 } })");
    wait_for(&mut tab, "!page.state.isBusy && page.state.source !== null");
    tab.press("#make", "Enter");
    wait_for(
        &mut tab,
        "page.state.isBusy && document.querySelector('#doing').innerText !== 'Getting ready'",
    );
    let waited = tab.ask("(async () => { const start = performance.now(); dispatchEvent(new KeyboardEvent('keydown', { key: 'Escape' })); while (page.state.isBusy) await new Promise((done) => setTimeout(done, 5)); return performance.now() - start; })()");
    assert!(waited.as_f64().unwrap() < 1000.0, "{waited} ms");
    assert!(tab.ask("page.state.results.size") == json!(0));

    tab.ask("page.decisions.decide({ levels: 'shares', shares: [0.4, 0.1] })");
    wait_for(&mut tab, "!page.state.isBusy");
    tab.press("#make", "Enter");
    wait_for(
        &mut tab,
        "document.querySelector('#of-home').hidden === false",
    );
    assert_eq!(
        tab.ask("document.querySelectorAll('#list button').length"),
        3
    );
    tab.press("#canvas", "2");
    assert_eq!(tab.ask("page.stage.view.level"), 2);
    tab.press("#canvas", "b");
    let original = drawn(&mut tab);
    tab.press("#canvas", "b");
    assert_ne!(drawn(&mut tab), original, "the level looks different");
    assert!(text_of(&mut tab, "#list").contains("\u{a0}m on"));
    check_manners(&mut tab);
}

/// While a chain is made, a level that was made fast stands beside the plant; the chain takes its place. Fast, normal or
/// best is decided like all else.
#[test]
fn a_first_answer_is_shown_until_the_chain_is_there() {
    let Some(mut tab) = opened(DESKTOP) else {
        return;
    };
    tab.ask("void page.open({ grown: { species: 'oak', leaves: 120, seed: 2 } })");
    wait_for(&mut tab, "!page.state.isBusy && page.state.source !== null");
    tab.ask("page.decisions.decide({ levels: 'shares', shares: [0.5, 0.1] })");
    tab.ask("void (window.seen = [], new MutationObserver(() => page.state.coarse && window.seen.push([page.stage.view.mode, page.stage.levels === page.state.coarse.taken, document.querySelector('#of-home').hidden, document.querySelector('#notes').innerText])).observe(document.querySelector('#notes'), { childList: true }))");
    tab.click("#make");
    wait_for(&mut tab, "window.seen.length > 0");
    let seen = tab.ask("window.seen[0]");
    assert_eq!(seen[0], "beside");
    assert_eq!(seen[1], true, "it is drawn");
    assert_eq!(seen[2], true, "it is not to be taken home");
    assert!(seen[3].as_str().unwrap().contains("first answer"), "{seen}");
    wait_for(&mut tab, "!page.state.isBusy");
    assert_eq!(tab.ask("page.state.coarse"), Value::Null);
    let levels = "page.state.results.get(page.decisions.key).levels.length";
    assert_eq!(tab.ask(levels), 3);
    assert!(!text_of(&mut tab, "#notes").contains("first answer"));
    check_manners(&mut tab);

    assert!(!text_of(&mut tab, "#command").contains("--effort"));
    tab.click("[data-effort=fast]");
    assert_eq!(
        tab.ask("location.hash")
            .as_str()
            .unwrap()
            .split('&')
            .next_back(),
        Some("effort=fast")
    );
    assert!(tab.ask("page.decisions.settings.effort") == "fast");
    tab.click("#make");
    wait_for(
        &mut tab,
        "page.state.results.size === 2 && !page.state.isBusy",
    );
    assert!(text_of(&mut tab, "#command").contains(" --effort fast"));
    tab.press_with_control("z");
    assert_eq!(tab.ask("page.decisions.now.effort"), "normal");
    assert!(!text_of(&mut tab, "#command").contains("--effort"));
    check_manners(&mut tab);
}

/// Bad files get a sentence, and the plant that was open stays.
#[test]
fn what_cannot_be_opened_is_said_in_a_sentence() {
    let Some(mut tab) = opened(DESKTOP) else {
        return;
    };
    let bench = Bench::new();
    bench.put("broken.glb", b"glTF, or so");
    bench.put("tree.fbx", b"Kaydara");
    let gltf =
        json!({"asset": {"version": "2.0"}, "buffers": [{"uri": "tree.bin", "byteLength": 4}]});
    bench.put("tree.gltf", gltf.to_string().as_bytes());
    opens(&mut tab, &bench, &["oak.glb"]);
    for (file, says) in [
        ("broken.glb", "broken.glb"),
        ("tree.fbx", "no .glb or .gltf"),
        ("tree.gltf", "it needs tree.bin"),
    ] {
        opens(&mut tab, &bench, &[file]);
        wait_for(&mut tab, "!document.querySelector('#error').hidden");
        let said = text_of(&mut tab, "#error");
        assert!(said.contains(says), "{file}: {said}");
        assert_eq!(tab.ask("page.state.name"), Value::from("oak.glb"));
    }
    check_manners(&mut tab);
}

/// Of files that are chosen together each is a plant, but what a .gltf names; a plant keeps its decisions and levels
/// while another is shown, and its decisions when the page is loaded again.
#[test]
fn several_plants_are_open_and_what_is_decided_outlives_the_page() {
    let Some(mut tab) = opened(DESKTOP) else {
        return;
    };
    let bench = Bench::new();
    let (root, bin) = glb::chunks(oak());
    let mut root: Value = serde_json::from_slice(root).unwrap();
    root["buffers"][0]["uri"] = "tree.bin".into();
    bench.put("tree.gltf", root.to_string().as_bytes());
    bench.put("tree.bin", bin);
    bench.put("broken.glb", b"glTF, or so");
    opens(
        &mut tab,
        &bench,
        &["oak.glb", "tree.bin", "tree.gltf", "broken.glb"],
    );
    let choose = |tab: &mut Tab, number: u32| {
        tab.click(&format!("#plants li:nth-child({number}) button"));
        wait_for(tab, "!page.state.isBusy");
    };
    assert_eq!(
        tab.ask("document.querySelectorAll('#plants button').length"),
        3
    );
    tab.ask("page.decisions.decide({ kind: 'level', level: { amount: 'share', value: 0.07 } })");
    tab.click("#make");
    wait_for(&mut tab, "page.state.results.size === 1");
    let whole = drawn(&mut tab);

    choose(&mut tab, 2);
    assert_eq!(text_of(&mut tab, "#name"), "tree.gltf");
    assert!(text_of(&mut tab, "#counts").contains("240 leaves"));
    assert_eq!(tab.ask("page.decisions.past.length"), 0);
    tab.ask("page.decisions.decide({ kind: 'chain' })");
    choose(&mut tab, 3);
    assert!(text_of(&mut tab, "#error").contains("broken.glb"));
    assert_eq!(text_of(&mut tab, "#name"), "tree.gltf");
    choose(&mut tab, 1);
    assert_eq!(drawn(&mut tab), whole, "the level is there still");
    assert_eq!(tab.ask("location.hash"), "#one=7%");
    check_manners(&mut tab);

    let page = built().unwrap();
    tab.visit(&page);
    opens(&mut tab, &bench, &["tree.gltf", "tree.bin"]);
    assert_eq!(tab.ask("page.decisions.now.kind"), "chain");
    opens(&mut tab, &bench, &["oak.glb"]);
    assert_eq!(tab.ask("page.decisions.now.level.value"), 0.07);
    assert_eq!(tab.ask("page.decisions.now.kind"), "level");

    // What a link asks for goes before what is remembered; what is wrong in it is passed over.
    tab.ask("void (location.hash = 'metres=3,9&difference=some&pictures=no')");
    wait_for(&mut tab, "page.decisions.now.levels === 'distances'");
    assert_eq!(tab.ask("page.decisions.now.distances"), json!([3, 9]));
    assert_eq!(tab.ask("page.decisions.now.maxDifference"), 0.28);
    assert_eq!(tab.ask("page.decisions.now.impostor"), json!(false));
    assert_eq!(tab.complaints(), [""; 0]);
}
