//! Labels of the preview page lie on no tree.

use super::{drawn, opened, parts};
use crate::tab::{DESKTOP, Device, PHONE};

/// Where a label stands the canvas shows nothing but its background; the trees stand so far off that there is room.
fn labels_lie_on_no_tree(device: Device) {
    let Some((mut tab, _folder)) = opened(device) else {
        return;
    };
    const LABELS: [&str; 4] = [
        "#name-original",
        "#name-level",
        "#inset-original p",
        "#inset-level p",
    ];
    tab.ask("preview.state.distance = preview.chain.distance(100)");
    for is_true_size in ["false", "true"] {
        tab.ask(&format!(
            "preview.state.isTrueSize = {is_true_size}; preview.draw()"
        ));
        parts(&mut tab);
        for label in LABELS {
            tab.ask(&format!(
                "document.querySelector('{label}').style = 'color: transparent; background: none'; \
                 document.querySelectorAll('{label} *').forEach((e) => e.style = 'color: transparent')"
            ));
        }
        let picture = tab.picture();
        for label in LABELS {
            let bare = tab.part(&picture, label);
            assert_eq!(drawn(&bare), 0.0, "{label} at true size: {is_true_size}");
        }
    }
}

#[test]
fn labels_lie_on_no_tree_on_a_desktop() {
    labels_lie_on_no_tree(DESKTOP);
}

#[test]
fn labels_lie_on_no_tree_on_a_phone() {
    labels_lie_on_no_tree(PHONE);
}
