//! Batches: planned once, done by whoever is given an item, once each.

use serde_json::Value;

use crate::program::{Bench, Ran};

const OPTIONS: [&str; 6] = [
    "--levels",
    "0.5,0.2",
    "--no-original",
    "--impostor=none",
    "--effort=fast",
    "--screen-height=270",
];

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
    // What a worker that died left of it goes with the next.
    let left = format!("b/.secateur-{}-dead/made", key(oak));
    std::fs::create_dir_all(bench.path(&left)).unwrap();
    run(&bench, oak).succeeded();
    assert!(!bench.path(&left).exists());
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
/// The recipes of docs/batch.md, by the engine's name.
#[cfg(unix)]
fn recipes() -> Vec<(&'static str, String)> {
    let lines = include_str!("../docs/batch.md").lines();
    let rows = lines.filter_map(|line| line.strip_prefix("| ")?.strip_suffix("` |"));
    rows.filter_map(|row| row.split_once(" | `"))
        .map(|(engine, recipe)| (engine, recipe.replace("\\|", "|")))
        .collect()
}

/// Stand-ins for what hands work to machines: they read the words that the recipes give them, and do it here.
#[cfg(unix)]
const SBATCH: &str = r#"#!/bin/sh
last=${1#--array=1-}
[ "$2" = --wrap ] || exit 9
for SLURM_ARRAY_TASK_ID in $(seq 1 "$last"); do
  export SLURM_ARRAY_TASK_ID
  sh -c "$3" || exit 1
done
"#;
#[cfg(unix)]
const HQ: &str = r#"#!/bin/sh
[ "$1 $2 $4 $5 $6" = "submit --each-line --cpus 2 --" ] || exit 9
items=$3
shift 6
while read -r HQ_ENTRY; do
  export HQ_ENTRY
  "$@" < /dev/null || exit 1
done < "$items"
"#;

/// Each recipe as it is written down, with the engine where it can be had.
#[cfg(unix)]
#[test]
fn recipes_do_each_item_of_a_plan() {
    use std::os::unix::fs::PermissionsExt;
    let bench = Bench::new();
    let plants = ["1.glb", "2.glb"];
    for (plant, seed) in plants.iter().zip(["1", "2"]) {
        let grow = ["grow", "palmetto", "--leaves", "12", "--seed", seed];
        bench.run(&[&grow[..], &["-o", plant]].concat()).succeeded();
    }
    let options = ["-o", "b", "--levels", "0.3", "--no-original"];
    let plan = [&["batch", "plan"], &plants[..], &options].concat();
    let plan = bench.run(&plan).succeeded();
    let items: Vec<&str> = plan.stdout.lines().collect();
    std::fs::create_dir(bench.path("bin")).unwrap();
    for (name, script) in [("sbatch", SBATCH), ("hq", HQ)] {
        let name = format!("bin/{name}");
        bench.put(&name, script.as_bytes());
        let all = std::fs::Permissions::from_mode(0o755);
        std::fs::set_permissions(bench.path(&name), all).unwrap();
    }
    let is_there = |line: &str| bench.run_in_shell(line).code == Some(0);
    let all = recipes();
    assert_eq!(all.len(), 4, "{all:?}");
    for (engine, recipe) in all {
        let line = match engine {
            "GNU parallel" if !is_there("parallel --version") => {
                eprintln!("SKIPPED: there is no GNU parallel");
                continue;
            }
            "Dask" => {
                let python = format!(
                    "import subprocess\nfrom dask.distributed import Client\nwith Client(n_workers=1, threads_per_worker=2, \
                     processes=False, dashboard_address=None) as client:\n    assert {recipe} == [0, 0]\n"
                );
                bench.put("dask_batch.py", python.as_bytes());
                let packages = std::env::var("SECATEUR_DASK_PACKAGES").unwrap_or_default();
                let line = format!("PYTHONPATH='{packages}' python3");
                if !is_there(&format!("{line} -c 'import distributed'")) {
                    eprintln!("SKIPPED: there is no Dask");
                    continue;
                }
                format!("{line} dask_batch.py")
            }
            _ => recipe,
        };
        // Each recipe into a folder of its own.
        let folder = format!("b_{}", engine.replace(' ', "_"));
        let [from, to] = ["b", &folder].map(|name| format!("{}\"", bench.path(name).display()));
        let own: Vec<String> = items.iter().map(|item| item.replace(&from, &to)).collect();
        bench.put("items.jsonl", format!("{}\n", own.join("\n")).as_bytes());
        let path = "PATH=\"$PWD/bin:$(dirname \"$SECATEUR\"):$PATH\"; export PATH";
        bench.run_in_shell(&format!("{path}; {line}")).succeeded();
        for item in &own {
            let record = bench.json(&format!("{folder}/{}/record.json", key(item)));
            assert_eq!(record["key"], key(item), "{engine}");
        }
    }
}

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
