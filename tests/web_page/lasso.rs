//! Loops drawn around pieces and parts, by mouse, by finger, and the same by keys.

use std::collections::BTreeSet;

use serde_json::json;

use super::roles::{assert_same_bytes, settle, with_oak};
use super::{check_manners, opened, text_of, wait_for};
use crate::tab::{PHONE, Tab};

/// Draws a rectangular loop over the picture, from shares of its width and height, 0 to 1.
fn draw_around(tab: &mut Tab, [left, top]: [f64; 2], [right, bottom]: [f64; 2]) {
    let rect = tab.ask("(({ x, y, width, height }) => [x, y, width, height])(document.querySelector('#canvas').getBoundingClientRect())");
    let [x, y, width, height] = [0, 1, 2, 3].map(|k| rect[k].as_f64().unwrap());
    let corners = [
        [left, top],
        [right, top],
        [right, bottom],
        [left, bottom],
        [left, top],
    ];
    let mut places = vec![[x + left * width, y + top * height]];
    for pair in corners.windows(2) {
        let along = (1..=4).map(|step| f64::from(step) / 4.0);
        places.extend(along.map(|share| {
            let at = |k: usize| pair[0][k] + share * (pair[1][k] - pair[0][k]);
            [x + at(0) * width, y + at(1) * height]
        }));
    }
    tab.drag_along(&places);
    wait_for(tab, "!page.state.isBusy");
}

/// The pieces that are chosen, as place and number.
fn chosen(tab: &mut Tab) -> BTreeSet<(String, u64)> {
    let items = tab.ask("page.stage.view.chosen?.items ?? {}");
    let items = items.as_object().unwrap().iter();
    let pieces = items.flat_map(|(place, numbers)| {
        let numbers = numbers.as_array().unwrap().iter();
        numbers.map(|number| (place.clone(), number.as_u64().unwrap()))
    });
    pieces.collect()
}

#[test]
fn a_loop_chooses_the_pieces_that_lie_in_it_for_the_most_part() {
    let Some((mut tab, bench)) = with_oak() else {
        return;
    };
    tab.press("#canvas", "l");
    assert_eq!(tab.ask("page.stage.view.mode"), "plant");
    let halves = [[0.01, 0.5], [0.5, 0.99]].map(|[left, right]| {
        draw_around(&mut tab, [left, 0.01], [right, 0.99]);
        chosen(&mut tab)
    });
    draw_around(&mut tab, [0.01, 0.01], [0.99, 0.99]);
    let all = chosen(&mut tab);
    let both: BTreeSet<_> = halves[0].union(&halves[1]).cloned().collect();
    assert!(halves.iter().all(|half| half.len() > 50), "{halves:?}");
    assert!(halves[0].is_disjoint(&halves[1]));
    assert!(both.is_subset(&all));
    // A piece may lie in neither half for the most part, but seldom does.
    assert!(
        all.len() - both.len() < 5,
        "{} of {}",
        both.len(),
        all.len()
    );

    // By parts, all of the plant is two of them.
    tab.ask("void (document.querySelector('#lasso-level').value = 'part')");
    draw_around(&mut tab, [0.01, 0.01], [0.99, 0.99]);
    let items = tab.ask("Object.values(page.stage.view.chosen.items)");
    assert_eq!(items, json!([null, null]));
    tab.ask("void (document.querySelector('#lasso-level').value = 'piece')");

    // What is decided of all is one step.
    draw_around(&mut tab, [0.5, 0.01], [0.99, 0.5]);
    let some = tab.ask("page.stage.view.chosen.items");
    let wood =
        tab.ask("page.state.inspection.primitives.find((p) => p.taken_for === 'wood').place");
    let is_wood = |(place, _): &&(String, u64)| wood == place.as_str();
    let count = chosen(&mut tab)
        .iter()
        .filter(|piece| !is_wood(piece))
        .count();
    assert!(count > 20, "{some}");
    let left = format!("{} leaves", 240 - count);
    for (button, option) in [
        ("#is-wood", "--foliage piece:"),
        ("#is-other", "--not-plant piece:"),
    ] {
        let before = tab.ask("page.decisions.past.length").as_u64().unwrap();
        draw_around(&mut tab, [0.5, 0.01], [0.99, 0.5]);
        assert_eq!(tab.ask("page.stage.view.chosen.items"), some);
        tab.click(button);
        settle(&mut tab);
        assert_eq!(tab.ask("page.decisions.past.length"), before + 1);
        assert!(
            text_of(&mut tab, "#counts").contains(&left),
            "{button}: {left}"
        );
        assert_same_bytes(&mut tab, &bench);
        assert!(text_of(&mut tab, "#command").contains(option));
        while tab.ask("page.decisions.past.length") != json!(before) {
            tab.press_with_control("z");
            settle(&mut tab);
        }
        assert!(text_of(&mut tab, "#counts").contains("240 leaves"));
        tab.press("#canvas", "l");
    }
    tab.press("#canvas", "Escape");
    assert_eq!(
        tab.ask("document.querySelector('#loop').hasAttribute('hidden')"),
        true
    );
    assert_eq!(
        tab.ask("document.querySelector('#lasso').getAttribute('aria-pressed')"),
        "false"
    );
    check_manners(&mut tab);
}

#[test]
fn a_loop_is_drawn_by_a_finger() {
    let Some(mut tab) = opened(PHONE) else {
        return;
    };
    tab.ask("void page.open({ grown: { species: 'bush', leaves: 150, seed: 1 } })");
    wait_for(&mut tab, "!page.state.isBusy && page.state.source !== null");
    tab.click("#lasso");
    let turned = tab.ask("page.stage.orbit.yaw");
    draw_around(&mut tab, [0.1, 0.1], [0.9, 0.5]);
    assert!(!chosen(&mut tab).is_empty());
    assert_eq!(tab.ask("page.stage.orbit.yaw"), turned, "the plant stays");
    assert!(text_of(&mut tab, "#why").contains("You chose"));
    let small = tab.ask(
        "[...document.querySelectorAll('button, select, input, summary')].filter((e) => e.offsetParent && e.type !== 'checkbox').map((e) => [e.id || e.innerText, e.getBoundingClientRect()]).filter(([, r]) => r.height < 43.5 || r.width < 43.5).map(([name]) => name)",
    );
    assert_eq!(small, json!([]), "touch targets are at least 44 pixels");
    tab.click("#is-other");
    settle(&mut tab);
    assert!(text_of(&mut tab, "#parts").contains("Not the plant"));
    check_manners(&mut tab);
}

#[test]
fn keys_choose_pieces_in_a_list() {
    let Some((mut tab, _bench)) = with_oak() else {
        return;
    };
    tab.press("#parts li:first-child button", "Enter");
    tab.press("#of-pieces summary", "Enter");
    wait_for(
        &mut tab,
        "document.querySelector('#pieces').options.length > 0",
    );
    let listed = tab.ask("document.querySelector('#pieces').options.length");
    let pieces = tab.ask("page.state.inspection.primitives[0].pieces");
    assert_eq!(listed, pieces);
    let before = text_of(&mut tab, "#counts");
    tab.press("#pieces", "ArrowDown");
    wait_for(
        &mut tab,
        "page.stage.view.chosen !== null && !page.state.isBusy",
    );
    assert!(text_of(&mut tab, "#why").contains("You chose 1 piece of 1 part"));
    tab.press("#is-other", "Enter");
    settle(&mut tab);
    assert_ne!(text_of(&mut tab, "#counts"), before);
    assert!(text_of(&mut tab, "#parts").contains("Not the plant"));
    check_manners(&mut tab);
}
