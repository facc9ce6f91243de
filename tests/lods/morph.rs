//! Levels that say how one becomes the next.

use secateur::{Detail, Document, Surface};
use secateur_eval::{DifferenceJudge, ViewCount};
use serde_json::Value;

use super::levels;
use crate::program::Bench;

/// Larger than levels are switched at: at 17 pixels the shading of twigs is all that there is, and it stays.
const HEIGHT_PX: f64 = 400.0;

fn surfaces(document: &Document) -> Vec<Surface> {
    let drawn = document.drawn_as_one(Detail::Color).unwrap();
    drawn.into_iter().map(|drawn| drawn.surface).collect()
}

/// The textures of the plant are kept, so that geometry alone tells levels apart.
fn made(bench: &Bench, options: &[&str]) -> Value {
    let usual = [
        "lods",
        "oak.glb",
        "--effort=fast",
        "--textures=keep",
        "--impostor=none",
        "--overwrite",
    ];
    let asked = ["--levels", "0.5,0.25,0.12", "--report", "r.json"];
    bench
        .run(&[&usual[..], &asked, options].concat())
        .succeeded();
    bench.json("r.json")
}

#[test]
fn at_the_end_of_its_way_a_level_looks_like_the_next() {
    let bench = Bench::for_small_screen();
    let record = made(&bench, &["-o", "m", "--morph"]);
    let made = levels(&record);
    assert!(made.len() > 2);
    let documents: Vec<Document> = made
        .iter()
        .map(|level| Document::open(&bench.path(level["file"].as_str().unwrap())).unwrap())
        .collect();
    for (k, pair) in documents.windows(2).enumerate() {
        let next = surfaces(&pair[1]);
        let judge = DifferenceJudge::new(next, &[]);
        let off = |surfaces: &[Surface]| {
            judge
                .difference(surfaces, HEIGHT_PX, ViewCount::All)
                .difference
        };
        let begin = off(&surfaces(&pair[0]));
        let end = off(&surfaces(&pair[0].at_end_of_morph()));
        eprintln!("{k}: {begin:.3} at the beginning, {end:.3} at the end");
        // Normals and the shading of wood stay those of the level, so that the end is no copy of the next.
        assert!(
            end < 0.9 * begin,
            "{k}: {begin} at the beginning, {end} at the end"
        );
    }
    let has = |document: &Document| document.json().to_string().contains("\"_MORPH\"");
    let found: Vec<bool> = documents.iter().map(has).collect();
    assert!(found[..found.len() - 1].iter().all(|has| *has) && !found[found.len() - 1]);
}

/// All levels in one file share vertices; each has a way of its own.
#[test]
fn levels_in_one_file_have_their_ways() {
    let bench = Bench::for_small_screen();
    let record = made(&bench, &["-o", "one.glb", "--morph", "--compress"]);
    let document = Document::open(&bench.path("one.glb")).unwrap();
    let json = document.json();
    for (k, level) in levels(&record).iter().enumerate() {
        let nodes = json["nodes"].as_array().unwrap();
        let node = nodes
            .iter()
            .find(|node| node["name"] == level["node"])
            .unwrap();
        let mesh = &json["meshes"][node["mesh"].as_u64().unwrap() as usize];
        let is_last = k + 1 == levels(&record).len();
        for primitive in mesh["primitives"].as_array().unwrap() {
            let of = |name: &str| {
                let accessor = primitive["attributes"].get(name)?.as_u64()? as usize;
                json["accessors"][accessor]["count"].as_u64()
            };
            let expected = of("POSITION").filter(|_| !is_last);
            assert_eq!(of("_MORPH"), expected, "level {k}");
        }
    }
}
