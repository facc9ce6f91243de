//! What a setting loses where it looked from, and elsewhere: `cargo bench --bench judges`.
//!
//! For each tree, level and case: VMI error from the views that drove, from the dual icosahedron,
//! from the three turned ones (mean, worst of the four), IoU, coverage, seconds, and, with
//! `--pictures`, FLIP, and what a client draws
//! 512 and 128 pixels wide: FLIP and overlap with the truth, coverage over it, specks. After them means over all, and
//! how often a case of another method is better.
//!
//! ```text
//! cargo bench --bench judges -- [--trees NAMES] [--levels 0.5,0.25,0.1] [--pictures] [CASE]...
//! ```
//!
//! A tree is a file of `../shared/trees` by its name, or a grown species with its number of leaves,
//! as `oak-20376`. A case is words in quotation marks: a method or preset (`look`, `information`,
//! `paper`, `fsa`, `stochastic`, `meshopt`), `triangles` where levels are shares of the foliage's
//! triangles, and `views=60`, `field=tight`, `resolution=256`, `resize=deficit`,
//! `reference=previous`, `coverage=1`, `fit=none`, `cutoffs=keep`, `cutoffs=fit-with-mips`, as the program has them.

mod rows;

use std::collections::BTreeMap;
use std::time::Instant;

use rows::{Row, Rows, shared_tree};
use secateur::plant::{GrowOptions, Species, grow};
use secateur::{Document, Options, Preset, Target, plant_to_glb, simplify};
use secateur_eval::{AsDrawn, Judging, Original, Pictures};
use secateur_gltf::Tree;
use secateur_levels::{MaterialChange, choose_cutoffs, dilated_textures, material_changes};
use secateur_model::Surface;
use secateur_raster::ViewSet;
use secateur_simplify::fsa::FsaOptions;
use secateur_simplify::meshopt::{Borders, MeshoptOptions};
use secateur_simplify::stochastic::StochasticOptions;
use secateur_simplify::{Method, Simplified, Views};

const TREES: [&str; 12] = [
    "ez_bush2",
    "quat_commontree_1",
    "ez_oak_20k",
    "sap_birch_hex_9k",
    "sap_pine_needles_48k",
    "rowan-2760",
    "carya-8140",
    "birch-16100",
    "birch-20280",
    "oak-20376",
    "alder-41155",
    "maple-105688",
];

const CASES: [&str; 9] = [
    "look triangles",
    "look",
    "information triangles",
    "information",
    "fsa",
    "stochastic",
    "meshopt",
    "meshopt preserve-area",
    "meshopt dilate-borders",
];

/// The widths of pictures as they are drawn, in pixels.
const DRAWN_PX: [u32; 2] = [512, 128];

/// Of each width what is found there.
const DRAWN_KEYS: [[&str; 4]; 2] = [
    [
        "flip_drawn_512",
        "truth_iou_drawn_512",
        "coverage_drawn_512",
        "specks_drawn_512",
    ],
    [
        "flip_drawn_128",
        "truth_iou_drawn_128",
        "coverage_drawn_128",
        "specks_drawn_128",
    ],
];

fn main() {
    let asked = Asked::from_arguments();
    let mut rows = Rows::create("judges");
    let mut scores: BTreeMap<(String, String), BTreeMap<&'static str, f64>> = BTreeMap::new();
    for name in &asked.trees {
        let Some(tree) = tree(name) else {
            eprintln!("SKIPPED: {name} is not there");
            continue;
        };
        let judge = JudgedTree::new(&tree, asked.with_pictures);
        for level in &asked.levels {
            for case in &asked.cases {
                let found = judge.score(case, *level);
                let of = format!("{name} {:.0} %", 100.0 * level);
                for (quantity, value) in &found {
                    rows.add(&Row {
                        case: &format!("{of} {case}"),
                        quantity,
                        unit: "",
                        value: *value,
                        repeat: 0,
                        adapter: "cpu",
                        command: "cargo bench --bench judges",
                    });
                }
                scores.insert((of, case.clone()), found);
            }
        }
    }
    summary(&asked.cases, &scores);
}

/// What is asked for on the command line.
struct Asked {
    trees: Vec<String>,
    levels: Vec<f64>,
    cases: Vec<String>,
    with_pictures: bool,
}

impl Asked {
    fn from_arguments() -> Self {
        let mut asked = Self {
            trees: TREES.map(String::from).to_vec(),
            levels: vec![0.5, 0.25, 0.1],
            cases: Vec::new(),
            with_pictures: false,
        };
        let mut arguments = std::env::args().skip(1);
        while let Some(argument) = arguments.next() {
            let mut list = || -> Vec<String> {
                let value = arguments.next().expect("a value after the option");
                value.split(',').map(String::from).collect()
            };
            match argument.as_str() {
                // Cargo adds it.
                "--bench" => {}
                "--trees" => asked.trees = list(),
                "--levels" => {
                    let levels = list();
                    let level = |text: &String| text.parse().expect("levels are numbers");
                    asked.levels = levels.iter().map(level).collect();
                }
                "--pictures" => asked.with_pictures = true,
                _ => asked.cases.push(argument),
            }
        }
        if asked.cases.is_empty() {
            asked.cases = CASES.map(String::from).to_vec();
        }
        asked
    }
}

fn tree(name: &str) -> Option<Tree> {
    if let Some(path) = shared_tree(&format!("{name}.glb")) {
        return Some(Tree::open(&path, &[]).expect("the tree loads"));
    }
    let (species, leaves) = name.split_once('-')?;
    let species = Species::ALL.iter().find(|s| s.name() == species)?;
    let options = GrowOptions {
        leaves: leaves.parse().expect("a number of leaves"),
        ..GrowOptions::default()
    };
    let plant = grow(*species, &options).expect("it grows");
    let document = Document::from_bytes("grown.glb", plant_to_glb(&plant), None);
    let tree = document.expect("it is glTF").into_tree(&[]);
    Some(tree.expect("it has leaves"))
}

/// The options of a case at a level.
fn options(case: &str, level: f64) -> Options {
    let words: Vec<&str> = case.split_whitespace().collect();
    let target = match words.contains(&"triangles") {
        true => Target::triangle_share(level),
        false => Target::leaf_share(level),
    };
    let preset = match () {
        () if words.contains(&"information") => Preset::Information,
        () if words.contains(&"paper") => Preset::Paper,
        () => Preset::Look,
    };
    let mut options = Options::with_preset(preset, target);
    options.audit = false;
    for word in words {
        let value = word.split_once('=').map_or("", |(_, value)| value);
        let name = || serde_json::Value::from(value);
        let known = "a case as the file's head says";
        match word.split('=').next().expect(known) {
            "look" | "information" | "paper" | "triangles" | "cutoffs" => {}
            "fsa" => options.method = Method::Fsa(FsaOptions::published()),
            "stochastic" => options.method = Method::Stochastic(StochasticOptions::default()),
            "meshopt" => options.method = Method::Meshopt(MeshoptOptions::default()),
            "preserve-area" => {
                options.method = Method::Meshopt(MeshoptOptions {
                    borders: Borders::PreserveArea,
                    ..MeshoptOptions::default()
                });
            }
            "dilate-borders" => {
                options.method = Method::Meshopt(MeshoptOptions {
                    borders: Borders::Dilate,
                    ..MeshoptOptions::default()
                });
            }
            "views" => options.views = Views::by_name(value).expect(known),
            "field" => options.field_of_view = value.parse().expect(known),
            "resolution" => options.resolution = value.parse().expect(known),
            "fit" => options.fit = value.parse().expect(known),
            of_vds => {
                let vds = options.method.vds_mut().expect(known);
                match of_vds {
                    "resize" => vds.resize = serde_json::from_value(name()).expect(known),
                    "reference" => vds.reference = serde_json::from_value(name()).expect(known),
                    "neighbours" => vds.neighbours = value.parse().expect(known),
                    "coverage" => vds.max_coverage = value.parse().ok(),
                    other => panic!("{other}: {known}"),
                }
            }
        }
    }
    options
}

/// A tree that all cases are held against.
struct JudgedTree<'a> {
    tree: &'a Tree,
    held_out: Original<'a>,
    pictures: Option<(Pictures, [AsDrawn; 2])>,
}

impl<'a> JudgedTree<'a> {
    fn new(tree: &'a Tree, with_pictures: bool) -> Self {
        let judging = Judging::held_out(tree.foliage()).expect("leaves");
        let pictures = with_pictures.then(|| {
            let surfaces = surfaces_of(tree.surfaces(), "the tree");
            let of = |width_px| AsDrawn::new(&surfaces, &judging.rigs[0], width_px);
            let drawn = DRAWN_PX.map(of);
            (Pictures::of(&surfaces, &judging.rigs), drawn)
        });
        Self {
            tree,
            pictures,
            held_out: Original::new(tree.foliage(), judging).expect("a judge"),
        }
    }

    fn score(&self, case: &str, level: f64) -> BTreeMap<&'static str, f64> {
        let options = options(case, level);
        let begin = Instant::now();
        let foliage = self.tree.foliage();
        let result = simplify(foliage, &options).expect("a run");
        let seconds = begin.elapsed().as_secs_f64();
        let measured = self.held_out.measure_lod(&result.lod);
        let of_rigs: Vec<f64> = (measured.rigs.iter())
            .map(|rig| rig.overall.get("vmi_error_percent").expect("a metric"))
            .collect();
        let turned = &of_rigs[1..];
        let mut found = BTreeMap::from([
            ("dual_vmi_error", of_rigs[0]),
            ("turned_vmi_error", turned.iter().sum::<f64>() / 3.0),
            (
                "worst_vmi_error",
                of_rigs.iter().copied().fold(0.0, f64::max),
            ),
            ("vmi_error", measured.vmi_error_percent()),
            ("silhouette_iou", measured.silhouette_iou()),
            ("coverage_ratio", measured.coverage_ratio()),
            ("seconds", seconds),
            ("resolution", f64::from(result.resolution)),
        ]);
        if options.method.vds().is_some() {
            found.insert("own_vmi_error", self.own_error(&result));
        }
        if let Some((pictures, drawn)) = &self.pictures {
            let change = match case.contains("cutoffs=fit-with-mips") {
                true => MaterialChange::Cutoffs,
                false => MaterialChange::CutoffsOrMips,
            };
            let chosen = match options.chooses_cutoffs() && !case.contains("cutoffs=keep") {
                true => choose_cutoffs(self.tree, &result.lod, change).expect("it is drawn"),
                false => None,
            };
            let dilated = match options.chooses_cutoffs() && !case.contains("cutoffs=keep") {
                true => dilated_textures(self.tree).expect("its images are read"),
                false => Vec::new(),
            };
            let changes = material_changes(chosen.as_ref(), &dilated);
            let bytes = self.tree.lod_to_bytes_with(&result.lod, &changes);
            let bytes = bytes.expect("it is written");
            let document = Document::from_bytes("level.glb", bytes, None).expect("it is glTF");
            let surfaces = surfaces_of(document.surfaces(&[]), "a level");
            let rigs = &self.held_out.judging().rigs;
            let measured = pictures.measure(&Pictures::of(&surfaces, rigs));
            let flip = measured.overall.get("flip_mean").expect("a metric");
            found.insert("flip_mean", flip);
            for (drawn, keys) in drawn.iter().zip(DRAWN_KEYS) {
                let drawn = drawn.measure(&surfaces);
                let values = [
                    drawn.flip_mean,
                    drawn.truth_iou,
                    drawn.coverage_over_truth,
                    drawn.specks_per_view,
                ];
                found.extend(keys.into_iter().zip(values));
            }
        }
        found
    }

    /// VMI error from each set that drove, as the others judge: 60 degrees, 512 pixels; the mean.
    fn own_error(&self, result: &Simplified) -> f64 {
        let foliage = self.tree.foliage();
        let sphere = foliage.bounding_sphere().expect("leaves");
        let sets = result.driven_by.driving(sphere);
        let judging = Judging {
            rigs: sets.into_iter().map(ViewSet::with_exact_textures).collect(),
            resolution: Judging::RESOLUTION,
        };
        let measured = secateur_eval::measure_lod(foliage, &result.lod, &judging);
        measured.expect("a measurement").vmi_error_percent()
    }
}

fn surfaces_of<E: std::fmt::Debug, M>(
    surfaces: Result<Vec<(Surface, M)>, E>,
    what: &str,
) -> Vec<Surface> {
    let surfaces = surfaces.unwrap_or_else(|error| panic!("{what} is drawn: {error:?}"));
    surfaces.into_iter().map(|(surface, _)| surface).collect()
}

/// Means of each case, and in how many of its runs a case of another method is better.
fn summary(cases: &[String], scores: &BTreeMap<(String, String), BTreeMap<&'static str, f64>>) {
    for case in cases {
        let own: Vec<_> = scores.iter().filter(|((_, c), _)| c == case).collect();
        let mean = |of: &dyn Fn(&BTreeMap<&'static str, f64>) -> Option<f64>| {
            let values: Vec<f64> = own.iter().filter_map(|(_, found)| of(found)).collect();
            values.iter().sum::<f64>() / values.len() as f64
        };
        println!("\n{case}, {} runs", own.len());
        let of_dual = |found: &BTreeMap<&'static str, f64>| {
            Some(found["dual_vmi_error"] / found.get("own_vmi_error")?)
        };
        println!(
            "  dual over own VMI error, mean of ratios {:.2}",
            mean(&of_dual)
        );
        let keys: Vec<&'static str> = own
            .first()
            .map_or_else(Vec::new, |(_, f)| f.keys().copied().collect());
        for key in keys {
            println!("  mean {key} {:.4}", mean(&|found| found.get(key).copied()));
        }
        for (key, sign) in [
            ("turned_vmi_error", 1.0),
            ("silhouette_iou", -1.0),
            ("flip_mean", 1.0),
            ("flip_drawn_512", 1.0),
            ("truth_iou_drawn_512", -1.0),
            ("flip_drawn_128", 1.0),
            ("truth_iou_drawn_128", -1.0),
        ] {
            let mut beaten = Vec::new();
            for ((of, _), found) in &own {
                let Some(value) = found.get(key) else {
                    continue;
                };
                for rival in cases.iter().filter(|rival| method(rival) != method(case)) {
                    let there = scores.get(&(of.clone(), rival.clone()));
                    if there.is_some_and(|there| sign * there[key] < sign * value) {
                        beaten.push(format!("{of} by {rival}"));
                    }
                }
            }
            if !beaten.is_empty() {
                println!("  {key} beaten {}: {}", beaten.len(), beaten.join("; "));
            }
        }
    }
}

/// Cases of VDS are no rivals of each other.
fn method(case: &str) -> &str {
    let others = ["fsa", "stochastic", "meshopt"];
    others
        .into_iter()
        .find(|m| case.contains(m))
        .unwrap_or("vds")
}
