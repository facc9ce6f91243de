//! What the library writes, held against the files of the program.

use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

use secateur::chain::{BadOptions, ChainError, Layout, LevelsOptions, Wanted};
use secateur::plant::{GrowOptions, Species};
use secateur::{
    Amount, Effort, Error, LevelOptions, Memory, OpenEngine, Opening, Plant, Session, Target,
    Versioned, WoodMode, judge,
};
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

/// A fast level is made of fewer pictures, and the report says so.
#[test]
fn an_effort_has_the_bytes_of_the_program() {
    let bench = Bench::new();
    let plant = Plant::open(bench.path("oak.glb")).unwrap();
    let mut different = Vec::new();
    for (effort, views) in [(Effort::Fast, 12), (Effort::Normal, 20), (Effort::Best, 20)] {
        let flag = ["--effort", effort.name()];
        let out = [
            "-o",
            "out.glb",
            "--triangles",
            "0.1",
            "--report",
            "out.json",
        ];
        let simplify = [&["simplify", "oak.glb"], &out[..], &flag].concat();
        bench.run(&simplify).succeeded();
        let report: Value = serde_json::from_slice(&bench.read("out.json")).unwrap();
        assert_eq!(report["settings"]["effort"], effort.name());
        assert_eq!(report["settings"]["view_count"], views);
        let mut options = LevelOptions::triangles(0.1);
        options.simplify.effort = effort;
        let text = serde_json::to_string(&Versioned::new(options)).unwrap();
        let options: Versioned<LevelOptions> = serde_json::from_str(&text).unwrap();
        let level = plant.level(&options.options).unwrap();
        assert!(
            level.to_bytes().unwrap() == bench.read("out.glb"),
            "{effort:?}"
        );
        let budget = report["triangles"]["original"].as_f64().unwrap() / 10.0;
        let left = level.report().triangles as f64;
        assert!(
            (0.9 * budget..=budget + 1.0).contains(&left),
            "{left} of {budget}"
        );
        different.push(level.difference.unwrap().difference);
    }
    // Best is chosen for larger pictures.
    let [fast, normal, best] = different[..] else {
        unreachable!("three efforts")
    };
    assert!(
        fast <= 1.2 * normal && best <= 1.1 * normal,
        "{different:?}"
    );
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
    let bush = ["grow", "bush", "--leaves", "40", "-o", "bush.glb"];
    bench.run(&bush).succeeded();
    // Heights follow the screen; on the usual one it is a user of README who compares.
    let mut small = LevelsOptions::default();
    small.screen.height_px = 270.0;
    let of_small = ["--screen-height", "270"];
    levels_of_both(&bench, "bush.glb", &of_small, &small);

    let mut fast = small;
    fast.leaves.effort = Effort::Fast;
    let arguments = [&of_small[..], &["--effort", "fast"]].concat();
    levels_of_both(&bench, "oak.glb", &arguments, &fast);

    // No picture is put after numbers of triangles that nobody asked for one after.
    let shares = LevelsOptions {
        wanted: Wanted::Triangles(vec![Amount::Share(0.5), Amount::Share(0.2)]),
        max_difference: 1.0,
        ..fast
    };
    let few = ["--levels", "0.5,0.2", "--max-difference", "1"];
    levels_of_both(&bench, "oak.glb", &[&arguments[..], &few].concat(), &shares);
}

fn levels_of_both(bench: &Bench, plant: &str, arguments: &[&str], options: &LevelsOptions) {
    let lods = ["lods", plant, "-o", "of-program"];
    let record = ["--report", "lods.json", "--overwrite"];
    let run = [&lods[..], arguments, &record].concat();
    bench.run(&run).succeeded();
    let report: Value = serde_json::from_slice(&bench.read("lods.json")).unwrap();
    assert_eq!(report["effort"], options.leaves.effort.name());
    let plant = Plant::open(bench.path(plant)).unwrap();
    let levels = plant.levels(options).unwrap();
    let within =
        |level: &secateur::chain::LevelReport| level.difference.over(options.limits()) <= 1.0;
    assert!(
        levels
            .chain
            .levels
            .iter()
            .all(|level| within(&level.report))
    );
    let folder = tempfile::tempdir().unwrap();
    levels.write(folder.path(), Layout::Files).unwrap();
    let files = levels.to_bytes(Layout::Files).unwrap().files;
    assert!(files.len() > 1 && files.len() == levels.chain.levels.len());
    for file in files {
        let of_library = std::fs::read(folder.path().join(&file.name)).unwrap();
        assert!(of_library == file.bytes, "{}", file.name);
        let of_program = bench.read(&format!("of-program/{}", file.name));
        assert!(of_program == file.bytes, "{}", file.name);
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

/// Whoever works, and on however many threads: the bytes are the same. Who cancels is heard at once.
#[test]
fn a_session_tells_progress_and_changes_no_byte() {
    let oak = Plant::grow(
        Species::Oak,
        &GrowOptions {
            leaves: 60,
            seed: 2,
        },
    )
    .unwrap();
    let options = LevelOptions::triangles(0.3);
    let told = Arc::new(AtomicUsize::new(0));
    let count = Arc::clone(&told);
    let session = Session::default()
        .with_engine(OpenEngine::cpu())
        .with_threads(1)
        .unwrap()
        .with_progress(move |_| {
            count.fetch_add(1, Ordering::Relaxed);
        });
    let made = [oak.level(&options), oak.level_in(&session, &options)];
    let [usual, own] = made.map(|level| level.unwrap().to_bytes().unwrap());
    assert!(usual == own);
    assert!(told.load(Ordering::Relaxed) > 0);

    session.clone().cancel();
    assert!(oak.level_in(&session, &options).unwrap_err().is_stopped());
    let levels = oak.levels_in(&session, &LevelsOptions::default());
    assert!(levels.unwrap_err().is_stopped());
    let little = Session::default().with_memory(Memory::Bytes(1 << 16));
    let refused = oak.level_in(&little, &options).unwrap_err();
    assert!(refused.over_memory().is_some(), "{refused}");
}

/// A level in a file of its own has that file's bytes; in one file nothing counts twice.
#[test]
fn levels_say_what_they_cost() {
    let bench = Bench::new();
    let oak = Plant::grow(
        Species::Oak,
        &GrowOptions {
            leaves: 120,
            seed: 2,
        },
    )
    .unwrap();
    let mut options = LevelsOptions::default();
    options.screen.height_px = 270.0;
    let levels = oak.levels(&options).unwrap();
    for (layout, place) in [
        (Layout::Files, "files"),
        (Layout::Siblings, "one.glb"),
        (Layout::Usd, "one.usda"),
    ] {
        let written = levels.write(bench.path(place), layout).unwrap();
        let placed = levels.placed(layout, &written);
        assert!(placed.len() > 1);
        let bytes: u64 = placed.iter().map(|level| level.bytes).sum();
        match layout {
            Layout::Files => assert_eq!(bytes, written.bytes),
            // The rest is JSON, or what a layer says beside its levels.
            Layout::Siblings | Layout::Msft | Layout::Usd => {
                assert!(bytes < written.bytes && bytes + (64 << 10) > written.bytes);
            }
        }
        for level in &placed {
            // Leaves and wood are a primitive each.
            let draws = if level.report.impostor.is_none() {
                2
            } else {
                1
            };
            assert_eq!(level.draws, draws, "{level:?}");
            // A corner has 12 bytes of position and 2 of an index at least, and shares both with few others.
            assert!(level.gpu_bytes > level.report.texture_bytes + 6 * level.report.triangles);
        }
    }
}

/// What a page or a script keeps is read again as it was; another version is refused.
#[test]
fn options_come_back_from_text() {
    let options = LevelsOptions {
        max_pop: Some(0.25),
        wanted: Wanted::Distances(vec![5.0, 20.0]),
        ..LevelsOptions::default()
    };
    let mut kept = serde_json::to_value(Versioned::new(options.clone())).unwrap();
    let again: Versioned<LevelsOptions> = serde_json::from_value(kept.clone()).unwrap();
    assert_eq!(again.options.wanted, options.wanted);
    assert_eq!(again.options.max_pop, options.max_pop);
    kept["version"] = 2.into();
    let refused = serde_json::from_value::<Versioned<LevelsOptions>>(kept).unwrap_err();
    assert!(refused.to_string().contains("version 2"), "{refused}");
}
