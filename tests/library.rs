//! What the library writes, held against the files of the program.

use secateur::chain::{BadOptions, ChainError, Layout, LevelsOptions, Wanted};
use secateur::plant::{GrowOptions, Species};
use secateur::{Error, LevelOptions, Memory, Opening, Plant, Target, WoodMode, judge};
use serde_json::Value;

use crate::program::{Bench, shared_tree};

/// The bytes of a level as the library and as the program make them, and the library's warnings.
fn both(bench: &Bench, target: Target, arguments: &[&str]) -> [Vec<u8>; 2] {
    let simplify = ["simplify", "plant.glb", "-o", "of-program.glb"];
    bench.run(&[&simplify[..], arguments].concat()).succeeded();
    let opening = Opening {
        wood: LevelOptions::usual_wood(target),
        ..Opening::default()
    };
    let plant = Plant::open_with(bench.path("plant.glb"), &opening).unwrap();
    let level = plant.level(&LevelOptions::to(target)).unwrap();
    let file = bench.path("of-library.glb");
    let written = level.write(&file).unwrap();
    let bytes = bench.read("of-library.glb");
    assert_eq!(level.to_bytes().unwrap(), bytes);
    assert_eq!(written.bytes, bytes.len() as u64);
    assert!(level.difference.is_some());
    for name in ["of-library.glb", "of-program.glb"] {
        assert!(bench.names().iter().any(|there| there == name));
    }
    let of_program = bench.read("of-program.glb");
    for name in ["of-library.glb", "of-program.glb"] {
        std::fs::remove_file(bench.path(name)).unwrap();
    }
    [bytes, of_program]
}

#[test]
fn a_level_has_the_bytes_of_the_program() {
    let bench = Bench::new();
    bench.put("plant.glb", &bench.read("oak.glb"));
    let quarter = Target::leaf_share(0.25);
    for (target, arguments) in [
        (Target::triangle_share(0.1), ["--triangles", "0.1"]),
        (quarter, ["--ratio", "0.25"]),
    ] {
        let [ours, of_program] = both(&bench, target, &arguments);
        assert!(ours == of_program, "{arguments:?}");
    }
}

/// Its textures are cut out: cutoffs and colours change with the level.
#[test]
fn a_tenth_of_a_real_oak_has_the_bytes_of_the_program() {
    let Some(oak) = shared_tree("ez_oak_20k.glb") else {
        return;
    };
    let bench = Bench::new();
    bench.put("plant.glb", &std::fs::read(oak).unwrap());
    let [ours, of_program] = both(&bench, Target::triangle_share(0.1), &["--triangles", "0.1"]);
    assert!(ours == of_program);
}

#[test]
fn levels_have_the_bytes_of_the_program() {
    let bench = Bench::new();
    bench
        .run(&["lods", "oak.glb", "-o", "of-program"])
        .succeeded();
    let plant = Plant::open(bench.path("oak.glb")).unwrap();
    let levels = plant.levels(&LevelsOptions::default()).unwrap();
    levels
        .write(bench.path("of-library"), Layout::Files)
        .unwrap();
    let files = levels.to_bytes(Layout::Files).unwrap().files;
    assert!(files.len() > 1 && files.len() == levels.chain.levels.len());
    for file in files {
        let of = |folder: &str| bench.read(&format!("{folder}/{}", file.name));
        assert!(of("of-library") == file.bytes, "{}", file.name);
        assert!(of("of-program") == file.bytes, "{}", file.name);
    }
}

/// Levels are of wood and leaves.
#[test]
fn a_plant_without_its_wood_has_no_levels() {
    let bench = Bench::new();
    let opening = Opening {
        wood: WoodMode::Ignore,
        ..Opening::default()
    };
    let plant = Plant::open_with(bench.path("oak.glb"), &opening).unwrap();
    let refused = plant.levels(&LevelsOptions::default()).unwrap_err();
    assert!(refused.to_string().contains("without ignoring its wood"));
}

/// A page shows a level as it is written: the plant beside it, and any number of its leaves.
#[test]
fn a_level_has_a_page_of_its_own() {
    let oak = Plant::grow(
        Species::Oak,
        &GrowOptions {
            leaves: 60,
            seed: 2,
        },
    )
    .unwrap();
    let level = oak.level(&LevelOptions::triangles(0.3)).unwrap();
    let page = level.preview_html().unwrap();
    let facts = page.split("\"name\":\"level\"").nth(1).unwrap();
    let triangles = format!("\"triangles\":{}", level.report().triangles);
    assert!(facts.contains(&triangles));
    assert!(page.contains("\"name\":\"original\"") && page.contains("\"continuous\":{"));
    assert!(level.report().triangles < oak.report().triangles);
}

#[test]
fn the_library_judges_as_the_program_does() {
    let bench = Bench::new();
    bench
        .run(&["simplify", "oak.glb", "-o", "out.glb", "--triangles", "0.2"])
        .succeeded();
    let heights = ["--pixels-high", "540,100"];
    let measure = ["measure", "oak.glb", "out.glb", "--format", "json"];
    let ran = bench.run(&[&measure[..], &heights].concat());
    let record: Value = serde_json::from_str(&ran.succeeded().stdout).unwrap();
    let [plant, other] = ["oak.glb", "out.glb"].map(|file| Plant::open(bench.path(file)).unwrap());
    let judged = judge(&plant, &other).unwrap();
    let figures = serde_json::to_value(judged.figures().unwrap()).unwrap();
    for (key, figure) in figures.as_object().unwrap() {
        assert_eq!(record[key], *figure, "{key}");
    }
    for (k, pixels_high) in [540.0, 100.0].into_iter().enumerate() {
        let seen = serde_json::to_value(judged.difference_at(pixels_high)).unwrap();
        for (key, figure) in seen.as_object().unwrap() {
            assert_eq!(record["differences"][k][key], *figure, "{key}");
        }
    }
    assert!(judged.misplaced().is_none());
}

/// What went wrong is told by types, in words that name no option of the program.
#[test]
fn errors_can_be_matched() {
    let missing = Plant::open("no.glb").unwrap_err();
    let cause = std::error::Error::source(&missing).unwrap();
    let cause: &std::io::Error = cause.downcast_ref().unwrap();
    assert_eq!(cause.kind(), std::io::ErrorKind::NotFound);

    let oak = Plant::grow(
        Species::Oak,
        &GrowOptions {
            leaves: 60,
            seed: 2,
        },
    )
    .unwrap();
    let none = LevelsOptions {
        wanted: Wanted::Heights(Vec::new()),
        ..LevelsOptions::default()
    };
    let refused = oak.levels(&none).unwrap_err();
    let no_level = ChainError::Options(BadOptions::NoLevel);
    assert!(matches!(refused, Error::Levels(error) if error.to_string() == no_level.to_string()));

    let mut few = LevelOptions::triangles(0.3);
    few.simplify.memory = Memory::Bytes(1 << 16);
    let refused = oak.level(&few).unwrap_err();
    assert!(refused.over_memory().is_some(), "{refused}");
    assert!(!refused.to_string().contains("--"), "{refused}");
    let none = Plant::grow(Species::Oak, &GrowOptions { leaves: 0, seed: 2 });
    assert!(matches!(none, Err(Error::Grow(_))));
}
