//! Growing plants, as input to everything else.

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
        let said = format!("cannot grow oak with {count} leaves: ask for 1 to 1000000");
        bench.run(&grow).failed_saying(&[&said]);
    }
    bench
        .run(&["grow", "yew", "-o", "out.glb"])
        .failed_saying(&["no species is called 'yew': choose one of oak"]);
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
