//! Every engine gives the same bits.

use crate::program::{Bench, has_gpu, shared_tree};

fn hashes(bench: &Bench, tree: &str, engine: &str, more: &[&str]) -> [String; 2] {
    let arguments = [
        "simplify", tree, "-o", "out.glb", "--engine", engine, "--report", "r.json", "--audit",
    ];
    bench.run(&[&arguments, more].concat()).succeeded();
    let report = bench.json("r.json");
    assert_eq!(report["engine"], engine);
    assert_eq!(report["adapter"].is_string(), engine == "gpu");
    ["order_sha256", "areas_sha256"].map(|key| report[key].as_str().unwrap().to_owned())
}

#[test]
fn gpu_and_cpu_agree_on_a_grown_tree() {
    if !has_gpu() {
        return;
    }
    let bench = Bench::new();
    for settings in [
        &["--ratio", "0.2", "--resolution", "128"][..],
        &["--max-error", "3", "--resolution", "100", "--views", "8"],
        &["--ratio", "0.3", "--resolution", "64", "--views", "vnc"],
    ] {
        let [cpu, gpu] = ["cpu", "gpu"].map(|e| hashes(&bench, "oak.glb", e, settings));
        assert_eq!(cpu, gpu, "{settings:?}");
    }
}

#[test]
fn gpu_and_cpu_agree_on_real_trees() {
    for name in ["ez_bush2.glb", "quat_commontree_1.glb"] {
        let Some(tree) = shared_tree(name).filter(|_| has_gpu()) else {
            continue;
        };
        let bench = Bench::new();
        let settings = ["--ratio", "0.5", "--resolution", "64", "--views", "6"];
        let tree = tree.to_str().unwrap();
        let [cpu, gpu] = ["cpu", "gpu"].map(|e| hashes(&bench, tree, e, &settings));
        assert_eq!(cpu, gpu, "{name}");
    }
}

#[test]
fn a_gpu_that_is_not_there_is_one_sentence() {
    // Without drivers there is no adapter; other platforms always have theirs.
    if !cfg!(target_os = "linux") {
        return;
    }
    let bench = Bench::new();
    let arguments = [
        "simplify",
        "oak.glb",
        "-o",
        "out.glb",
        "--ratio",
        "0.5",
        "--resolution",
        "32",
        "--engine",
    ];
    let run = |engine: &str| {
        let arguments = [&arguments[..], &[engine]].concat();
        let mut command = std::process::Command::new(env!("CARGO_BIN_EXE_secateur"));
        command
            .args(&arguments)
            .current_dir(bench.path("."))
            .env("VK_DRIVER_FILES", "/nonexistent.json")
            .env("VK_ICD_FILENAMES", "/nonexistent.json");
        crate::program::Ran::of(&arguments, command.output().unwrap())
    };
    run("gpu").lacked_saying(&["no GPU adapter was found", "or run on the CPU"]);
    assert_eq!(bench.names(), ["oak.glb"]);
}
