//! The help and wrong usage.

use crate::program::Bench;

const COMMON: [&str; 5] = ["--format", "--threads", "--quiet", "--verbose", "--help"];

#[test]
fn help_names_every_flag() {
    let bench = Bench::new();
    let commands: [(&str, &[&str]); 9] = [
        (
            "grow",
            &[
                "SPECIES",
                "--output",
                "--leaves",
                "--seed",
                "--scheme",
                "--thresholds",
                "--report",
                "--picture",
            ],
        ),
        (
            "demo",
            &["--output", "--leaves", "--seed", "--engine", "--memory"],
        ),
        (
            "lods",
            &[
                "TREE.glb",
                "--output",
                "--levels",
                "--triangles",
                "--layout",
                "--max-difference",
                "--screen-height",
                "--fov",
                "--scene",
                "--occluder",
                "--foliage",
                "--memory",
                "--preset",
                "--preview",
                "--overwrite",
                "--compress",
                "--strips",
                "--report",
            ],
        ),
        (
            "lod",
            &[
                "TREE.glb",
                "--output",
                "--order",
                "--leaves",
                "--ratio",
                "--steps",
                "--foliage",
                "--overwrite",
                "--report",
            ],
        ),
        (
            "stream",
            &[
                "TREE.glb|STREAM",
                "--output",
                "--read",
                "--bytes",
                "--order",
                "--ratio",
                "--leaves",
                "--chain",
                "--preview",
                "--engine",
                "--foliage",
                "--memory",
                "--report",
            ],
        ),
        (
            "inspect",
            &["TREE.glb", "--foliage", "--memory", "--report"],
        ),
        (
            "simplify",
            &[
                "TREE.glb",
                "--output",
                "--leaves",
                "--ratio",
                "--max-error",
                "--triangles",
                "--wood",
                "--method",
                "--engine",
                "--views",
                "--scene",
                "--occluder",
                "--resolution",
                "--reference",
                "--resize",
                "--neighbours",
                "--max-coverage",
                "--fit",
                "--ties",
                "--foliage",
                "--memory",
                "--alpha",
                "--seed",
                "--audit",
                "--no-audit",
                "--report",
                "--picture",
                "--order",
                "--debug-images",
                "vds-reference",
                "normalised",
                "dodecahedron",
                "rounded",
                "--area-weight",
                "--distance-weight",
                "--planarity-weight",
                "--meshopt-mode",
                "--preserve-area",
                "--dilate-borders",
                "fsa",
                "stochastic",
                "meshopt",
            ],
        ),
        (
            "measure",
            &[
                "ORIGINAL.glb",
                "SIMPLIFIED.glb",
                "--foliage",
                "--memory",
                "--alpha",
                "--report",
            ],
        ),
        (
            "study",
            &[
                "TREE.glb",
                "--output",
                "--foliage",
                "--memory",
                "--plan",
                "--case",
                "--levels",
                "--seeds",
                "--redraw",
                "--distances",
                "stability",
                "walk",
                "metrics",
                "scene",
            ],
        ),
    ];
    for (command, flags) in commands {
        let help = bench.run(&[command, "--help"]).succeeded().stdout;
        for flag in flags.iter().chain(&COMMON) {
            assert!(help.contains(flag), "{command} --help has no {flag}");
        }
    }
    let all = bench.run(&["--help"]).succeeded().stdout;
    for command in [
        "demo", "inspect", "simplify", "measure", "study", "grow", "schema",
    ] {
        assert!(all.contains(command), "{all}");
    }
    assert!(
        bench
            .run(&["--version"])
            .succeeded()
            .stdout
            .starts_with("secateur ")
    );
}

#[test]
fn wrong_usage_is_exit_code_2() {
    let bench = Bench::new();
    let out = ["simplify", "oak.glb", "-o", "out.glb"];
    let one = ["simplify", "oak.glb", "-o", "out.glb", "--leaves", "5"];
    for (base, more) in [
        (&[][..], &[][..]),
        (&[], &["prune"]),
        (&["inspect"], &[]),
        (&["inspect", "oak.glb"], &["--foliage", "leaves"]),
        (&["inspect", "oak.glb"], &["-q", "-v"]),
        (&out, &[]),
        (&out, &["--leaves", "many"]),
        (&one, &["--ratio", "0.5"]),
        (&one, &["--max-error", "3"]),
        (&one, &["--resolution", "0"]),
        (&one, &["--resolution", "4096"]),
        (&one, &["--neighbours", "0"]),
        (&one, &["--method", "magic"]),
        (&one, &["--engine", "tpu"]),
        (&one, &["--threads", "0"]),
        (&one, &["--format", "xml"]),
        (&one, &["--meshopt-mode", "best"]),
        (&["study"], &["-o", "s"]),
        (&["study", "oak.glb"], &["-o", "s", "--redraw"]),
        (&["study", "oak.glb"], &["-o", "s", "--levels", "0.5,2"]),
    ] {
        let arguments = [base, more].concat();
        let ran = bench.run(&arguments);
        assert_eq!(ran.code, Some(2), "{arguments:?}: {}", ran.stderr);
        assert_eq!(ran.stdout, "", "{arguments:?}");
        assert!(!ran.stderr.is_empty(), "{arguments:?}");
    }
    assert_eq!(bench.names(), ["oak.glb"]);
}
