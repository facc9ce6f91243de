//! Batches: planned once, done by whoever is given an item, once each.

use serde_json::Value;

use crate::program::{Bench, Ran};

const OPTIONS: [&str; 4] = ["--levels", "0.5,0.2", "--no-original", "--impostor=none"];

/// Three plants, the last of which is none, and a plan for them.
fn planned() -> (Bench, Vec<String>) {
    let bench = Bench::new();
    let more = ["--leaves", "60", "-o", "bush.glb"];
    bench
        .run(&[&["grow", "bush"], &more[..]].concat())
        .succeeded();
    bench.put("wrong.gltf", br#"{"asset": {"version": "2.0"}}"#);
    let trees = [
        "batch",
        "plan",
        "oak.glb",
        "bush.glb",
        "wrong.gltf",
        "-o",
        "b",
    ];
    let plan = bench.run(&[&trees[..], &OPTIONS].concat()).succeeded();
    bench.put("items.jsonl", plan.stdout.as_bytes());
    let items: Vec<String> = plan.stdout.lines().map(str::to_owned).collect();
    assert_eq!(items.len(), 3);
    (bench, items)
}

fn run(bench: &Bench, item: &str) -> Ran {
    bench.run(&["batch", "run", item])
}

fn key(item: &str) -> String {
    let item: Value = serde_json::from_str(item).unwrap();
    item["key"].as_str().unwrap().to_owned()
}

#[test]
fn an_item_is_done_once_with_the_bytes_of_lods() {
    let (bench, items) = planned();
    let oak = &items[0];
    run(&bench, oak).succeeded();
    bench
        .run(&[&["lods", "oak.glb", "-o", "alone"], &OPTIONS[..]].concat())
        .succeeded();
    let place = format!("b/{}", key(oak));
    for file in ["oak_LOD0.glb", "oak_LOD1.glb"] {
        assert_eq!(
            bench.read(&format!("{place}/{file}")),
            bench.read(&format!("alone/{file}"))
        );
    }
    let record = bench.json(&format!("{place}/record.json"));
    assert_eq!(record["key"], key(oak));
    let file = record["files"][0].as_str().unwrap();
    assert!(file.ends_with("oak_LOD0.glb") && std::path::Path::new(file).exists());
    // Done again it is only looked at.
    let again = run(&bench, oak).succeeded();
    assert!(again.stdout.contains("is done"));
    assert_eq!(record, bench.json(&format!("{place}/record.json")));
    // A plan of the same is the same plan.
    let again = ["batch", "plan", "oak.glb", "-o", "b"];
    let again = bench.run(&[&again[..], &OPTIONS].concat()).succeeded();
    assert_eq!(again.stdout.trim_end(), oak);
}

#[test]
fn what_changed_or_fails_is_told_and_gathered() {
    let (bench, items) = planned();
    let parts = ["wrong.gltf"];
    run(&bench, &items[2]).failed_saying(&parts);
    // An item by a file and by standard input is the same item.
    bench.put("bush.json", items[1].as_bytes());
    run(&bench, "bush.json").succeeded();
    bench.put("oak.glb", &bench.read("bush.glb"));
    run(&bench, &items[0]).failed_saying(&["oak.glb", "plan again"]);
    let collect = [
        "batch",
        "collect",
        "b",
        "-o",
        "report",
        "--plan",
        "items.jsonl",
    ];
    let gathered = bench.run(&collect);
    assert_eq!(gathered.code, Some(3), "{}", gathered.stderr);
    let lines = String::from_utf8(bench.read("report.jsonl")).unwrap();
    let lines: Vec<Value> = lines
        .lines()
        .map(|l| serde_json::from_str(l).unwrap())
        .collect();
    assert_eq!(lines.len(), 3);
    assert!(lines[0]["error"].is_string() && lines[1]["error"].is_string());
    assert_eq!(lines[2]["levels"].as_array().unwrap().len(), 2);
    let page = String::from_utf8(bench.read("report.html")).unwrap();
    let first = page.find("wrong.gltf").unwrap();
    assert!(first < page.find("bush.glb").unwrap());
    assert!(page.contains(&key(&items[1])) && page.contains("picture.png"));
    run(&bench, "{}").failed_saying(&["batch plan"]);
    let wrong = ["batch", "plan", "bush.glb", "-o", "b", "--report", "r.json"];
    bench.run(&wrong).failed_with(2, &["--report"]);
}

/// Two workers with the same item leave one result, and nothing else.
#[cfg(unix)]
#[test]
fn two_workers_may_be_given_the_same_item() {
    let (bench, items) = planned();
    bench.put("item.json", items[1].as_bytes());
    let line = "\"$SECATEUR\" batch run item.json & \"$SECATEUR\" batch run - < item.json; a=$?; wait $! && exit $a";
    bench.run_in_shell(line).succeeded();
    let entries = std::fs::read_dir(bench.path("b")).unwrap();
    let names: Vec<_> = entries.map(|e| e.unwrap().file_name()).collect();
    assert_eq!(names, [key(&items[1]).as_str()]);
}
