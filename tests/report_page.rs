//! The report of a study in a real browser.

use serde_json::Value;

use crate::browser::visit;
use crate::program::Bench;

const CASES: [&str; 8] = [
    "--case",
    "vds --views 6 --resolution 64",
    "--case",
    "vds --reference previous --resize deficit --neighbours 4 --views 6 --resolution 64",
    "--case",
    "fsa",
    "--case",
    "stochastic",
];

#[test]
fn a_report_works_in_a_browser() {
    let bench = Bench::new();
    let run = ["study", "oak.glb", "-o", "s", "--levels", "0.5,0.1"];
    let quickly = ["--views", "icosahedron"];
    bench
        .run(&[&run[..], &quickly, &CASES].concat())
        .succeeded();
    let Some((visits, console)) = visit(&bench.path("s/report.html"), &[390, 1440]) else {
        return;
    };
    assert_eq!(console, [""; 0], "nothing reaches the console");
    for visit in &visits {
        let (width, found) = (visit.width_px, &visit.found);
        for nothing in ["errors", "too_wide", "cut_text", "asked_for"] {
            assert_eq!(found[nothing], Value::Array(vec![]), "{nothing} at {width}");
        }
        // One at the head, and one for each of seven metrics and two levels.
        assert_eq!(found["charts"], 15);
        let trees = found["trees"].as_array().unwrap();
        assert_eq!(trees.len(), 1);
        check_slider(trees[0].as_array().unwrap());
    }
    let mut widths: Vec<u64> = visits.iter().map(|v| v.width_px).collect();
    widths.sort_unstable();
    assert_eq!(widths, [390, 1440]);
}

/// Every method and level shows a picture of its own, with its own caption.
fn check_slider(shown: &[Value]) {
    assert_eq!(shown.len(), 4 * 2);
    let text = |value: &Value, key: &str| value[key].as_str().unwrap().to_owned();
    for (k, one) in shown.iter().enumerate() {
        let level = ["50 %", "10 %"][k % 2];
        let caption = text(one, "caption");
        assert_eq!(one["level"], level);
        assert!(caption.starts_with(&text(one, "method")), "{caption}");
        assert!(caption.contains(level), "{caption}");
        assert_eq!(one["is_visible"], true);
        for other in &shown[..k] {
            for picture in ["picture", "difference"] {
                assert_ne!(one[picture], other[picture], "{caption}");
            }
        }
        assert!(text(one, "picture").starts_with("data:image/jpeg;base64,"));
    }
}
