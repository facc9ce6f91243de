//! How soon a plant of 10,000 triangles has something to show for it. Times are printed: they are the machine's.

use serde_json::json;

use super::{check_manners, opened, wait_for};
use crate::tab::DESKTOP;

/// A bush of 11,600 triangles: until a first level is drawn, and until Cancel has an end.
#[test]
fn a_first_level_is_drawn_long_before_the_levels_are_made() {
    let Some(mut tab) = opened(DESKTOP) else {
        return;
    };
    tab.ask("void page.open({ grown: { species: 'bush', leaves: 300, seed: 3 } })");
    wait_for(&mut tab, "!page.state.isBusy && page.state.source !== null");
    let triangles = tab.ask(
        "page.state.inspection.primitives.reduce((sum, p) => sum + p.triangles * p.placements, 0)",
    );
    assert!(triangles.as_u64().unwrap() >= 10_000, "{triangles}");
    tab.ask("void (window.begun = performance.now(), page.make())");
    wait_for(&mut tab, "page.state.coarse !== null || !page.state.isBusy");
    let shown = tab.ask("new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(() => done(performance.now() - window.begun))))");
    assert!(tab.ask("page.stage.levels === page.state.coarse?.taken") == json!(true));
    let cancelled = tab.ask("(async () => { const start = performance.now(); document.querySelector('#cancel').click(); while (page.state.isBusy) await new Promise((done) => setTimeout(done, 5)); return performance.now() - start; })()");
    eprintln!(
        "{triangles} triangles: a first level after {shown} ms, cancelled after {cancelled} ms"
    );
    assert!(cancelled.as_f64().unwrap() < 1000.0, "{cancelled} ms");
    check_manners(&mut tab);
}
