//! Studies of a walk through woods.

use serde_json::{Value, json};

use super::{readme, rows, study};
use crate::program::Bench;

/// Of a walk's rows alone its page is drawn, on which its frames are no levels of leaves.
#[test]
fn a_walk_has_its_page_of_its_rows() {
    let bench = Bench::new();
    study(&bench, &["--case", "fsa --views 6 --resolution 64"]).succeeded();
    let mut frame: Value = rows(&bench)[0].clone();
    for (key, value) in [
        ("tree", json!("walk")),
        ("method", json!("merge")),
        ("level", json!(1.0)),
        ("triangles_final", json!(300)),
        ("values", json!({"flip_mean": 0.125})),
        ("picture", json!("walk/frame-00.png")),
    ] {
        frame[key] = value;
    }
    let mut text = String::new();
    for number in 0..2 {
        frame["setting"] = json!(format!("25-25-25-25 panorama frame 0{number}"));
        frame["walk"] = json!({
            "frame": number, "is_turn": false, "has_panorama": true, "triangles_original": 1200,
            "switches": number, "step": 0.25, "step_original": 0.125, "pop": 0.0625,
        });
        text += &format!("{frame}\n");
    }
    bench.put("s/rows.jsonl", text.as_bytes());
    std::fs::create_dir_all(bench.path("s/walk")).unwrap();
    bench.put("s/walk/frame-00.png", b"a picture");
    bench.run(&["study", "--redraw", "-o", "s"]).succeeded();
    let line = "| merge 25-25-25-25 panorama | 2 | 300 | 25.0 % |  | 0.1250 |  | 0.1250 | 0.2500 | 0.1250 |";
    let readme = readme(&bench);
    assert!(readme.contains(line), "{readme}");
    assert!(!readme.contains("of the leaves:") && !readme.contains("held-out views"));
    let page = String::from_utf8(bench.read("s/report.html")).unwrap();
    assert!(page.contains("A walk through woods") && page.contains("data:image/png;base64,"));
    let commands = page.matches(frame["command"].as_str().unwrap()).count();
    assert_eq!(commands, 1, "both frames are of one command");
}
