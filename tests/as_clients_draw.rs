//! Levels as three.js draws them, with the settings that files ask for.

use std::sync::Arc;

use secateur::glam::{DQuat, DVec3, Vec2};
use secateur::{
    AlphaMode, Filters, Finish, GrownPlant, Material, Surface, Texture, Wrap, plant_to_glb,
};
use secateur_plant::{GrowOptions, Species, grow};
use serde_json::{Value, json};

use crate::clients;
use crate::program::{Bench, shared_tree};

/// Makes levels of the bush as [`levels_of`] does.
fn levels_of_bush(bench: &Bench, levels: &str) -> Option<Value> {
    levels_of(bench, "ez_bush2.glb", levels)
}

/// Makes these levels of a shared tree beside a copy of it, `original.glb`; what the program says of them. None where
/// the tree is not there.
fn levels_of(bench: &Bench, tree: &str, levels: &str) -> Option<Value> {
    let tree = shared_tree(tree)?;
    bench.put("original.glb", &std::fs::read(&tree).unwrap());
    let wanted = ["lods", "original.glb", "-o", ".", "--levels", levels];
    let more = ["--no-original", "--report", "r.json"];
    let run = bench.run(&[&wanted[..], &more].concat());
    run.succeeded();
    Some(bench.json("r.json"))
}

/// From one and from the other side of each switch, a level covers what the original truly does.
///
/// The bush's own cut-outs fade away in a client: without textures made for the distance its
/// levels would cover a tenth and less of that.
#[test]
fn levels_cover_what_the_original_truly_does_at_each_switch() {
    let bench = Bench::new();
    let Some(record) = levels_of_bush(&bench, "0.25,0.1") else {
        return;
    };
    let levels = record["levels"].as_array().unwrap();
    let distance = |level: &Value| level["distance"].as_f64().unwrap();
    let shown = |(k, level): (usize, &Value)| {
        let end = levels.get(k + 1).map(distance);
        let distances: Vec<f64> = [Some(distance(level)), end].into_iter().flatten().collect();
        json!({ "file": format!("original_LOD{k}.glb"), "distances": distances })
    };
    let levels: Vec<Value> = levels.iter().enumerate().map(shown).collect();
    let jobs = json!([{
        "name": "bush",
        "original": "original.glb",
        "screen": record["screen"],
        "most_px": 128,
        "levels": levels,
    }]);
    bench.put("jobs.json", jobs.to_string().as_bytes());
    let Some(seen) = clients::show("coverage.js", &bench.path("jobs.json")) else {
        return;
    };
    assert_eq!(seen.len(), 3);
    for level in &seen {
        let coverage = level["coverage_over_truth"].as_f64().unwrap();
        assert!((0.9..=1.1).contains(&coverage), "{level}");
    }
    // What a client makes of the original itself at the switch.
    let original = seen[2]["original_coverage_over_truth"].as_f64().unwrap();
    assert!(original < 0.7, "{original}");
}

/// Textures for where this level begins twinkle where it ends, at an eighth of that height: 179 specks a view more
/// than the original has.
#[test]
fn a_level_of_a_wide_range_does_not_twinkle_at_its_end() {
    let bench = Bench::new();
    let Some(record) = levels_of_bush(&bench, "0.5,0.1") else {
        return;
    };
    let levels = &record["levels"];
    let [begins, ends] = [0, 1].map(|level| levels[level]["pixels_high"].as_f64().unwrap());
    assert!(ends < begins / 7.0);
    let more_specks = levels[0]["more_specks_as_drawn"].as_f64().unwrap();
    assert!(more_specks < 20.0, "{more_specks}");
}

/// A tenth of the oak is made for pictures of it 68 pixels high, by textures of 8 x 8 texels. Where it is 300 pixels high it has up
/// to two specks a view more than the original; with the exact outlines of such textures it would have seven more.
#[test]
fn a_level_seen_from_nearer_than_it_is_for_shows_no_specks() {
    let bench = Bench::new();
    if levels_of(&bench, "ez_oak_20k.glb", "0.1").is_none() {
        return;
    }
    let measure = ["measure", "original.glb", "original_LOD0.glb"];
    let wanted = [
        "--as-drawn",
        "512",
        "--views",
        "icosahedron",
        "--pixels-high",
        "16",
        "--report",
        "m.json",
    ];
    bench.run(&[&measure[..], &wanted].concat()).succeeded();
    let drawn = bench.json("m.json")["as_drawn"].clone();
    let [level, original] =
        ["specks_per_view", "original_specks_per_view"].map(|key| drawn[key].as_f64().unwrap());
    assert!(level <= original + 2.0, "{drawn}");
}

/// Twigs that are gone from a level are missing from its outline. Leaves without holes have no texture that
/// could make up for them: they grow. As their sizes are fitted this pine would cover .81 to .85.
#[test]
fn leaves_without_holes_make_up_for_twigs_that_are_gone() {
    let bench = Bench::new();
    let options = GrowOptions {
        leaves: 300,
        seed: 1,
    };
    bench.put(
        "pine.glb",
        &plant_to_glb(&grow(Species::Pine, &options).unwrap()),
    );
    let wanted = ["lods", "pine.glb", "-o", ".", "--levels", "0.2"];
    let more = ["--no-original", "--report", "r.json"];
    bench.run(&[&wanted[..], &more].concat()).succeeded();
    let level = bench.json("r.json")["levels"][0].clone();
    for key in ["coverage_as_drawn", "coverage_as_drawn_at_end"] {
        let coverage = level[key].as_f64().unwrap();
        assert!((0.9..=1.1).contains(&coverage), "{level}");
    }
    assert!(level["difference"].as_f64().unwrap() <= 0.28, "{level}");
}

/// A crown of cards 60 cm wide, whose texture repeats and is a disc in the middle: .2 of it, which passes the
/// cutoff in the coarsest mips.
fn crown_of_discs(cutoff: f32) -> GrownPlant {
    crown(cutoff, |x, y| {
        let [x, y] = [x, y].map(|at| f64::from(at) - 31.5);
        x * x + y * y < 256.0
    })
}

/// Such a crown whose texture of 64 x 64 texels shows what `is_there`.
fn crown(cutoff: f32, is_there: impl Fn(u32, u32) -> bool) -> GrownPlant {
    const CARDS: u32 = 240;
    let texel = |k: u32| [60, 140, 40, 255 * u8::from(is_there(k % 64, k / 64))];
    let texture = Texture {
        width: 64,
        height: 64,
        rgba: (0..64 * 64).flat_map(texel).collect(),
        wrap: [Wrap::Repeat; 2],
        filters: Filters::default(),
    };
    let material = |name: &str, texture: Option<Texture>| {
        Arc::new(Material {
            name: name.to_owned(),
            base_color: [1.0; 4],
            alpha_mode: match texture {
                Some(_) => AlphaMode::Mask(cutoff),
                None => AlphaMode::Opaque,
            },
            texture: texture.map(Arc::new),
            double_sided: true,
            finish: Finish::default(),
        })
    };
    let surface = |material| Surface::empty(material);
    let mut leaves = surface(material("leaves", Some(texture)));
    for k in 0..CARDS {
        // Evenly over a ball of radius 3, each turned another way.
        let part = (f64::from(k) + 0.5) / f64::from(CARDS);
        let turn = DQuat::from_euler(
            Default::default(),
            2.4 * f64::from(k),
            1.7 * f64::from(k),
            0.0,
        );
        let centre = DVec3::Y * 4.0 + turn * DVec3::X * 3.0 * part.cbrt();
        let first = leaves.positions.len() as u32;
        for [u, v] in [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]] {
            let corner = turn * DVec3::new(u - 0.5, 0.5 - v, 0.0) * 0.6;
            leaves.positions.push(centre + corner);
            leaves.uvs.push(Vec2::new(u as f32, v as f32));
        }
        let quad = [[0, 1, 2], [0, 2, 3]];
        leaves
            .triangles
            .extend(quad.map(|corners| corners.map(|corner| first + corner)));
    }
    let mut wood = surface(material("bark", None));
    wood.positions = [[-0.1, 0.0], [0.1, 0.0], [0.0, 4.0]]
        .map(|[x, y]| DVec3::new(x, y, 0.0))
        .into();
    wood.triangles = vec![[0, 1, 2]];
    GrownPlant {
        name: "discs".to_owned(),
        wood,
        leaves,
        triangles_per_leaf: vec![2; CARDS as usize],
        skeleton: None,
        holds: None,
    }
}

/// A triangle around a card reaches beyond it, where coarse mips show what a client wraps in: its tips must
/// not be seen as specks. With the tree's own cutoff and sampler they are, 10 to 20 a view. The look reads these cards
/// without mip maps, so that discs come and go as the original's do.
#[test]
fn cards_that_became_triangles_show_no_specks_in_a_client() {
    let bench = Bench::new();
    bench.put("discs.glb", &plant_to_glb(&crown_of_discs(0.1)));
    let few = ["--triangles", "0.5", "--views", "6", "--resolution", "64"];
    let made = |name: &str, cutoffs: &str| {
        let files = ["simplify", "discs.glb", "-o", name, "--report", "r.json"];
        bench
            .run(&[&files[..], &few, &["--cutoffs", cutoffs]].concat())
            .succeeded();
        let left = bench.json("r.json")["leaves"]["final"].as_u64().unwrap();
        assert!(left > 200, "cards became triangles: {left}");
    };
    made("fit.glb", "fit");
    made("mips.glb", "fit-with-mips");
    let level = |file| json!({ "file": file, "distances": [15, 60] });
    let jobs = json!([{
        "name": "discs",
        "original": "discs.glb",
        "screen": { "height_px": 1080, "fov_degrees": 60 },
        "most_px": 512,
        "levels": [level("fit.glb"), level("mips.glb")],
    }]);
    bench.put("jobs.json", jobs.to_string().as_bytes());
    let Some(seen) = clients::show("coverage.js", &bench.path("jobs.json")) else {
        return;
    };
    assert_eq!(seen.len(), 4);
    for level in &seen {
        let number = |key: &str| level[key].as_f64().unwrap();
        let more = number("specks_per_view") - number("original_specks_per_view");
        assert!(more <= 2.0, "{level}");
        let keeps_mips = level["level"] == 1;
        assert!(!keeps_mips || number("specks_per_view") < 5.0, "{level}");
    }
}

/// With a cutoff of .5 a mask of a fifth fades away from afar: the look chooses another, and says so. Near
/// by the cards show what they did.
#[test]
fn a_simplified_crown_does_not_fade() {
    let bench = Bench::new();
    bench.put("discs.glb", &plant_to_glb(&crown_of_discs(0.5)));
    let few = ["--ratio", "0.5", "--views", "6", "--resolution", "64"];
    let made = |name: &str, more: &[&str]| {
        let files = ["simplify", "discs.glb", "-o", name, "--report", "r.json"];
        let run = bench.run(&[&files[..], &few, more].concat());
        run.succeeded();
        let document = secateur::Document::open(&bench.path(name)).unwrap();
        let cutoff = document.json()["materials"][1]["alphaCutoff"].as_f64();
        (bench.json("r.json"), cutoff.unwrap())
    };
    let (record, cutoff) = made("fit.glb", &[]);
    let chosen = &record["cutoffs"];
    assert_eq!(chosen["of_materials"], json!([[1, cutoff]]));
    assert_eq!(chosen["raised"], Value::Null);
    assert!(cutoff < 0.4, "{cutoff}");
    for shown in chosen["as_drawn"].as_array().unwrap() {
        let off = |key: &str| (shown[key].as_f64().unwrap() - 1.0).abs();
        let (before, after) = (
            off("coverage_over_truth_before"),
            off("coverage_over_truth"),
        );
        assert!(after < before.max(0.1), "{shown}");
    }
    let notes = record["notes"].to_string();
    assert!(notes.contains("instead of 0.5"), "{notes}");

    let (record, cutoff) = made("kept.glb", &["--cutoffs", "keep"]);
    assert_eq!((&record["cutoffs"], cutoff), (&Value::Null, 0.5));
    // What looks for information, and methods of others, leave materials alone.
    let (record, _) = made("others.glb", &["--method", "stochastic"]);
    assert_eq!(record["cutoffs"], Value::Null);
    let papers = ["simplify", "discs.glb", "-o", "p.glb", "--preset", "paper"];
    let run = bench.run(
        &[
            &papers[..],
            &["--ratio", "0.5", "--cutoffs", "fit-with-mips"],
        ]
        .concat(),
    );
    run.misused_saying(&["--cutoffs", "contradicts", "--preset paper"]);
    assert!(!bench.path("p.glb").exists());
}

/// Over black, mip maps darken leaves from afar: their clear texels get the colours of leaves, and that is said.
#[test]
fn leaves_over_black_do_not_darken_from_afar() {
    let bench = Bench::new();
    let mut plant = crown(0.5, |x, y| x < 45 && y < 45);
    let material = Arc::make_mut(&mut plant.leaves.material);
    let texture = Arc::make_mut(material.texture.as_mut().unwrap());
    for texel in texture.rgba.chunks_exact_mut(4).filter(|t| t[3] == 0) {
        texel[..3].fill(0);
    }
    bench.put("black.glb", &plant_to_glb(&plant));
    let made = |name: &str, more: &[&str]| {
        let files = ["simplify", "black.glb", "-o", name, "--report", "r.json"];
        let few = ["--ratio", "0.5", "--views", "6", "--resolution", "64"];
        bench.run(&[&files[..], &few, more].concat()).succeeded();
        bench.json("r.json")
    };
    let measured = |name: &str| {
        let measure = ["measure", "black.glb", name, "--as-drawn", "64"];
        let quickly = ["--views", "icosahedron", "--pixels-high", "16"];
        let json = ["--format", "json"];
        let measure = bench.run(&[&measure[..], &quickly, &json].concat());
        let seen: Value = serde_json::from_str(&measure.succeeded().stdout).unwrap();
        seen["as_drawn"].clone()
    };
    let with_mips = ["--cutoffs", "fit-with-mips"];
    let record = made("dilated.glb", &with_mips);
    let dilated = measured("dilated.glb");
    let [one] = &record["colors"].as_array().unwrap()[..] else {
        panic!("one texture: {record}");
    };
    assert_eq!(one["material"], 1);
    assert!(one["difference"].as_f64().unwrap() > 5.0, "{one}");
    let notes = record["notes"].to_string();
    assert!(notes.contains("clear texels"), "{notes}");

    let keep = [&with_mips[..], &["--colors", "keep"]].concat();
    let record = made("kept.glb", &keep);
    let kept = measured("kept.glb");
    assert_eq!(record["colors"], Value::Null);
    // Nothing but colours differs.
    assert_eq!(dilated["coverage_over_truth"], kept["coverage_over_truth"]);
    let flip = |seen: &Value| seen["flip_mean"].as_f64().unwrap();
    assert!(flip(&dilated) < 0.95 * flip(&kept), "{dilated} {kept}");

    // Where cutoffs stay so do colours, if nobody asks for them; and a tree of which nothing is gone stays.
    let record = made("both_kept.glb", &["--cutoffs", "keep"]);
    assert_eq!(record["colors"], Value::Null);
    let record = made("asked.glb", &["--cutoffs", "keep", "--colors", "dilate"]);
    assert_eq!(record["colors"].as_array().unwrap().len(), 1);
    let all = ["simplify", "black.glb", "-o", "all.glb", "--ratio", "1"];
    bench
        .run(&[&all[..], &["--report", "all.json"]].concat())
        .succeeded();
    assert_eq!(bench.json("all.json")["colors"], Value::Null);
    let papers = ["simplify", "black.glb", "-o", "p.glb", "--preset", "paper"];
    let run = bench.run(&[&papers[..], &["--ratio", "0.5", "--colors", "dilate"]].concat());
    run.misused_saying(&["--colors", "contradicts", "--preset paper"]);

    // Whoever asks for colours where there is nothing to do is told.
    bench.put("green.glb", &plant_to_glb(&crown_of_discs(0.5)));
    let told = |more: &[&str]| {
        let files = ["simplify", "green.glb", "-o", "g.glb", "--overwrite"];
        let few = ["--ratio", "0.5", "--views", "6", "--resolution", "64"];
        let run = bench.run(&[&files[..], &few, &["--report", "g.json"], more].concat());
        run.succeeded();
        bench.json("g.json")["warnings"].to_string()
    };
    assert!(told(&["--colors", "dilate"]).contains("changes no texture"));
    assert!(!told(&[]).contains("texture"));

    // Levels of a chain that keep the tree's texture do so too.
    let lods = ["lods", "black.glb", "-o", "chain", "--distances", "8,16"];
    let report = [
        "--no-original",
        "--max-difference",
        "1",
        "--report",
        "chain.json",
    ];
    bench.run(&[&lods[..], &report].concat()).succeeded();
    let level = bench.json("chain.json")["levels"][0].clone();
    assert_eq!(
        [&level["textures"], &level["colors"]],
        ["keep", "dilate"],
        "{level}"
    );
    let texels = |file: &str| {
        let document = secateur::Document::open(&bench.path(file)).unwrap();
        let mut drawn = document.surfaces(&[]).unwrap().into_iter();
        let texture = drawn.find_map(|(surface, _)| surface.material.texture.clone());
        texture.unwrap()
    };
    let level = texels("chain/black_LOD0.glb");
    let is_black = |texel: &[u8]| texel[..3] == [0; 3];
    assert!(texels("black.glb").rgba.chunks(4).any(is_black));
    assert!(!level.rgba.chunks(4).any(is_black));
}

/// Where coarse mip maps have the same alpha all over, any cutoff shows cards whole or not at all: the look
/// reads no mip maps then, and says so.
#[test]
fn a_crown_that_no_cutoff_helps_is_read_without_mip_maps() {
    let bench = Bench::new();
    let holes = crown(0.5, |x, y| x % 8 < 6 && y % 8 < 5);
    bench.put("holes.glb", &plant_to_glb(&holes));
    let made = |more: &[&str]| {
        let files = [
            "simplify",
            "holes.glb",
            "-o",
            "out.glb",
            "--report",
            "r.json",
        ];
        let few = ["--ratio", "0.5", "--views", "6", "--resolution", "64"];
        let run = bench.run(&[&files[..], &few, more].concat());
        run.succeeded();
        let document = secateur::Document::open(&bench.path("out.glb")).unwrap();
        let min_filter = document.json()["samplers"][0]["minFilter"].as_u64();
        (bench.json("r.json"), min_filter.unwrap())
    };
    let (record, min_filter) = made(&[]);
    let chosen = &record["cutoffs"];
    assert_eq!(chosen["without_mips"], json!([1]));
    // Engines that make mip maps whatever a file says have the cutoff that is best with them.
    assert_eq!(chosen["of_materials"][0][0], 1);
    assert_eq!(min_filter, 9729);
    for shown in chosen["as_drawn"].as_array().unwrap() {
        let after = shown["coverage_over_truth"].as_f64().unwrap();
        assert!((after - 1.0).abs() < 0.1, "{shown}");
    }
    let notes = record["notes"].to_string();
    assert!(notes.contains("without mip maps"), "{notes}");

    let (record, min_filter) = made(&["--cutoffs", "fit-with-mips"]);
    assert_eq!(min_filter, 9987);
    let without = &record["cutoffs"]["without_mips"];
    assert!(without.is_null() || *without == json!([]), "{record}");
    let (record, min_filter) = made(&["--cutoffs", "keep"]);
    assert_eq!((&record["cutoffs"], min_filter), (&Value::Null, 9987));
}
