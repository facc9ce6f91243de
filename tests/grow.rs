//! Growing plants, as input to everything else.

use serde_json::Value;

use crate::program::Bench;

#[test]
fn a_grown_tree_has_its_leaves_and_every_command_takes_it() {
    let bench = Bench::new();
    let grow = [
        "grow", "oak", "-o", "tree.glb", "--leaves", "321", "--seed", "7",
    ];
    let more = ["--report", "grow.json", "--picture", "tree.png"];
    let ran = bench.run(&[&grow[..], &more].concat()).succeeded();
    assert!(ran.stdout.contains("oak with 321 leaves"), "{}", ran.stdout);
    assert!(bench.read("tree.png").starts_with(b"\x89PNG"));
    let report = bench.json("grow.json");
    assert_eq!(report["leaves"], 321);
    assert_eq!(report["bytes"], bench.read("tree.glb").len());
    assert!(report["size_m"]["y"].as_f64().unwrap() > 5.0);

    let inspected = bench.run(&["inspect", "tree.glb"]).succeeded().stdout;
    assert!(inspected.contains("leaves       321 of"), "{inspected}");
    bench
        .simplify(&["tree.glb", "-o", "out.glb", "--leaves", "100"])
        .succeeded();
    let measured = bench
        .run(&["measure", "tree.glb", "out.glb", "--format", "json"])
        .succeeded();
    assert!(measured.stdout.contains("\"simplified\": 100"));
}

#[test]
fn equal_seeds_grow_equal_bytes_and_others_siblings() {
    let bench = Bench::new();
    for (name, seed) in [
        ("a", "9"),
        ("b", "9"),
        ("c", "0"),
        ("d", "18446744073709551615"),
    ] {
        let file = format!("{name}.glb");
        let grow = [
            "-q", "grow", "oak", "-o", &file, "--leaves", "60", "--seed", seed,
        ];
        assert_eq!(bench.run(&grow).succeeded().stdout, "");
    }
    let [a, b, c, d] = ["a.glb", "b.glb", "c.glb", "d.glb"].map(|name| bench.read(name));
    assert_eq!(a, b);
    assert!(a != c && c != d);
}

#[test]
fn what_cannot_be_grown_is_said_in_one_sentence() {
    let bench = Bench::new();
    for count in ["0", "-1", "10000000", "4294967297"] {
        let grow = ["grow", "oak", "-o", "out.glb", "--leaves", count];
        let said = format!("{count} is not in 1..=1000000");
        bench.run(&grow).misused_saying(&[&said]);
    }
    bench
        .run(&["grow", "yew", "-o", "out.glb"])
        .failed_saying(&["no species is called 'yew': choose one of oak, carya, birch, alder, maple, rowan, pine, palmetto, willow, bush"]);
    bench
        .run(&["grow", "oak", "-o", "out.gltf"])
        .failed_saying(&["out.gltf: cannot be written: its name must end in .glb"]);
    bench
        .run(&["grow", "oak", "-o", "no/out.glb"])
        .failed_saying(&["its folder `no` does not exist"]);
    let usage = bench.run(&["grow", "oak", "-o", "a.glb", "--seed", "-1"]);
    assert_eq!(usage.code, Some(2));
    assert_eq!(bench.names(), ["oak.glb"]);
}

#[test]
fn a_rule_file_of_ones_own_grows() {
    let bench = Bench::new();
    let rules = "axiom: Stem(9); Stem(n) if n > 0 -> F(1) [ &(60) leaf(0.5) ] /(90) Stem(n - 1);";
    bench.put("mine.lsys", rules.as_bytes());
    let ran = bench.run(&["grow", "mine.lsys", "-o", "a.glb"]).succeeded();
    assert!(
        ran.stdout.contains("mine with 9 leaves, 9.3 m high"),
        "{}",
        ran.stdout
    );
    let three = ["grow", "./mine.lsys", "-o", "b.glb", "--leaves", "3"];
    let ran = bench.run(&three).succeeded();
    assert!(ran.stdout.contains("mine with 3 leaves"), "{}", ran.stdout);
    bench
        .run(&["grow", "mine.lsys", "-o", "c.glb", "--leaves", "10"])
        .failed_saying(&["mine bears 9 leaves, not 10: use `detail` in its rules"]);
}

#[test]
fn mistakes_in_a_rule_file_are_shown_with_line_and_column() {
    let bench = Bench::new();
    for (text, said) in [
        (
            &b"axiom: F(1);\nF(x) -> G;"[..],
            "bad.lsys: line 2, column 9: unknown symbol `G`",
        ),
        (b"axiom: F(1", "bad.lsys: line 1, column 11: expected"),
        (
            b"axiom: F(1/0);",
            "bad.lsys: line 1, column 11: division by zero",
        ),
        (
            b"axiom: F(-1);",
            "bad.lsys: line 1, column 8: a length cannot be negative",
        ),
        (
            b"axiom: A; A -> A A;",
            "bad.lsys: line 1, column 18: the rules make more than 24000000",
        ),
        (
            b"axiom: sides(64) A(19); A(n) if n > 0 -> A(n - 1) A(n - 1); A(n) if n <= 0 -> F(0);",
            "bad has more than 40000000 vertices: ask for fewer leaves, segments or sides",
        ),
        (b"\xff\xfe", "bad.lsys: the rules are not UTF-8 text"),
    ] {
        bench.put("bad.lsys", text);
        bench
            .run(&["grow", "bad.lsys", "-o", "out.glb"])
            .failed_saying(&[said]);
    }
    bench
        .run(&["grow", "none.lsys", "-o", "out.glb"])
        .failed_saying(&["none.lsys: cannot be read: "]);
    assert_eq!(bench.names(), ["bad.lsys", "oak.glb"]);
}

#[test]
fn levels_of_detail_are_trees_with_fewer_branches() {
    let bench = Bench::new();
    let level = |lod: &[&str]| {
        let grow = ["grow", "oak", "-o", "lod.glb", "--leaves", "300"];
        let rest = ["--report", "r.json", "--lod"];
        bench.run(&[&grow[..], &rest, lod].concat()).succeeded();
        secateur::Tree::open(&bench.path("lod.glb"), &[]).unwrap();
        crate::validator::assert_valid(&[bench.path("lod.glb")]);
        let report = bench.json("r.json");
        let number = |pointer: &str| report.pointer(pointer).unwrap().as_u64().unwrap();
        assert_eq!(number("/lod/leaves_original"), 300);
        [
            number("/lod/level"),
            number("/leaves"),
            number("/triangles/wood"),
        ]
    };
    let [first, leaves, wood] = level(&["9"]);
    assert_eq!(first, 9);
    let [levels, share, more_wood] = level(&["0.5"]);
    assert!(leaves < share && wood < more_wood && levels > 9);
    assert!((130..=150).contains(&share), "{share}");
    let scheme = ["--lod-method", "merge", "--scheme", "25-25-25-25"];
    let [two, merged, merged_wood] = level(&[&["2"], &scheme[..]].concat());
    assert_eq!(two, 2);
    let [_, last, last_wood] = level(&[&["4"], &scheme[..]].concat());
    assert!(last < merged && last_wood < merged_wood);
    assert_eq!(last, 1);
}

/// Thicknesses in metres, the finest level first however they are written, and the paper's heights over radii.
#[test]
fn thresholds_of_ones_own_stand_in_place_of_a_scheme() {
    let bench = Bench::new();
    let grow = ["grow", "oak", "-o", "lod.glb", "--leaves", "300"];
    let rest = ["--report", "r.json", "--lod-method", "merge", "--lod"];
    let level = |number: &str, thresholds: &str| {
        let own = [number, "--thresholds", thresholds];
        bench.run(&[&grow[..], &rest, &own].concat()).succeeded();
        let report = bench.json("r.json");
        [report["lod"].clone(), report["leaves"].clone()]
    };
    let [fine, leaves] = level("1", "0.02,0.01");
    assert_eq!(fine["levels"], 2);
    assert_eq!(
        (&fine["thickness_m"], &fine["threshold"]),
        (&0.01.into(), &Value::Null)
    );
    let [coarse, fewer] = level("2", "0.01,0.02");
    assert_eq!(coarse["thickness_m"], 0.02);
    assert!(coarse["sticks_replaced"].as_u64() > fine["sticks_replaced"].as_u64());
    assert!(fewer.as_u64() < leaves.as_u64());
    let [by_hr, _] = level("2", "hr:500,250");
    assert_eq!(
        (&by_hr["threshold"], &by_hr["thickness_m"]),
        (&250.0.into(), &Value::Null)
    );
    let misused = |own: &[&str], said: &str| {
        let lod = ["--lod", "1", "--lod-method", "merge"];
        bench
            .run(&[&grow[..], &lod, own].concat())
            .misused_saying(&[said]);
    };
    for bad in ["0.01,0.03,0.02", "-0.01,-0.02", "nan", "0"] {
        misused(
            &["--thresholds", bad],
            "are no thresholds: write thicknesses in metres",
        );
    }
    misused(
        &["--thresholds", "0.01", "--scheme", "50-50"],
        "cannot be used with",
    );
    let by_chain = ["--lod", "1", "--thresholds", "0.01"];
    bench
        .run(&[&grow[..], &by_chain].concat())
        .failed_with(2, &["--thresholds is for --lod-method merge"]);
}

#[test]
fn levels_that_there_are_not_are_refused() {
    let bench = Bench::new();
    let grow = ["grow", "oak", "-o", "lod.glb", "--leaves", "300", "--lod"];
    bench
        .run(&[&grow[..], &["5", "--lod-method", "merge"]].concat())
        .failed_saying(&["oak has 4 levels of detail, not 5"]);
    let many = bench.run(&[&grow[..], &["1000000"]].concat());
    many.failed_saying(&["levels of detail, not 1000000"]);
    assert_eq!(bench.names(), ["oak.glb"]);
}

/// What takes the time of leaves times depth is not begun where depth has no end.
#[test]
fn a_stem_without_end_has_no_levels_by_branches() {
    let bench = Bench::new();
    let rules = "axiom: A(14) leaf(0.1); A(n) if n > 0 -> A(n - 1) A(n - 1); \
                 A(n) if n <= 0 -> F(0.001);";
    bench.put("deep.lsys", rules.as_bytes());
    let said = "segment 10000 of the skeleton grows 10001 segments above its root";
    let grow = ["grow", "deep.lsys", "-o", "deep.glb"];
    for method in ["chain", "merge"] {
        let lod = ["--lod", "1", "--lod-method", method];
        bench
            .run(&[&grow[..], &lod].concat())
            .failed_saying(&["deep: ", said]);
    }
    bench.run(&grow).succeeded();
    for method in ["chain", "merge"] {
        let rest = ["--leaves", "1", "--method", method];
        bench
            .simplify(&[&["deep.glb", "-o", "out.glb"], &rest[..]].concat())
            .failed_saying(&["deep.glb: ", said]);
    }
}
