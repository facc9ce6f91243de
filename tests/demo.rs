//! What a newcomer sees first.

use crate::program::Bench;

#[test]
fn a_demo_leaves_trees_a_report_and_a_picture() {
    let bench = Bench::new();
    let ran = bench
        .run(&["demo", "-o", "new/folder", "--leaves", "200"])
        .succeeded();
    for part in ["original", "50 %", "25 %", "10 %", "contact-sheet.png"] {
        assert!(ran.stdout.contains(part), "{}", ran.stdout);
    }
    let report = bench.json("new/folder/report.json");
    let levels = report["levels"].as_array().unwrap();
    assert_eq!(levels.len(), 4);
    let triangles = |level: &serde_json::Value| level["triangles"].as_u64().unwrap();
    let all = triangles(&levels[0]);
    // Budgets count the wood too, which has most of the triangles of such an oak.
    for (k, percent) in [(1, 50), (2, 25), (3, 10)] {
        let level = &levels[k];
        // Shares are rounded to the nearest whole triangle.
        assert!(100 * triangles(level) <= all * percent + 50, "{level}");
        assert!(level["vmi_error_percent"].is_f64(), "{level}");
        let inspected = bench.run(&["inspect", &format!("new/folder/tree_LOD{}.glb", k - 1)]);
        inspected.succeeded();
    }
    bench.run(&["inspect", "new/folder/tree.glb"]).succeeded();
    let page = String::from_utf8(bench.read("new/folder/preview.html")).unwrap();
    assert!(page.contains("<canvas") && page.contains("LOD2"));
    let picture = bench.read("new/folder/contact-sheet.png");
    assert!(picture.starts_with(b"\x89PNG"));
}

#[test]
fn a_file_in_the_folders_place_is_refused() {
    let bench = Bench::new();
    bench
        .run(&["demo", "-o", "oak.glb"])
        .failed_saying(&["oak.glb: cannot be written: `oak.glb` is no folder"]);
}
