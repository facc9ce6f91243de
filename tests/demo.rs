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
    for (name, leaves) in [
        ("tree", 200),
        ("tree-50", 100),
        ("tree-25", 50),
        ("tree-10", 20),
    ] {
        let file = format!("new/folder/{name}.glb");
        let inspected = bench.run(&["inspect", &file]).succeeded().stdout;
        let words = format!("leaves       {leaves} of");
        assert!(inspected.contains(&words), "{inspected}");
    }
    let report = bench.json("new/folder/report.json");
    assert_eq!(report["levels"].as_array().unwrap().len(), 4);
    assert!(report["levels"][3]["vmi_error_percent"].is_f64());
    let page = String::from_utf8(bench.read("new/folder/preview.html")).unwrap();
    assert!(page.contains("<canvas") && page.contains("10 %"));
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
