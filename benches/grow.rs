//! Growing: seconds, peak memory and how time grows with leaves, by the whole
//! command; and whether species are plausible, beside real trees and figures from
//! botany.
//!
//! `cargo bench --bench grow [-- PART]`; PART is `time`, `growth` or `species`, or
//! picks cases of `time` by name. `species` also writes `species.md`.

mod program;
mod rows;

use std::ffi::OsStr;
use std::fmt::Write as _;
use std::path::PathBuf;
use std::time::Instant;

use glam::DVec3;
use program::TimedRun;
use rows::{Rows, Wanted, exponent, repeats, shared_tree};
use secateur_gltf::{Document, Tree, plant_to_glb};
use secateur_model::{Foliage, Lod};
use secateur_plant::{GrowOptions, Species, grow, grow_skeleton};
use secateur_raster::{CpuRasteriser, Rasteriser, Scene, ViewSet};

/// What is taken from botany: heights of grown trees and lengths of leaves.
const BOTANY: [(Species, &str, &str); 10] = [
    (Species::Oak, "20 to 40", "leaf 7 to 14 cm"),
    (Species::Carya, "25 to 40", "leaf 30 to 60 cm, 5 leaflets"),
    (Species::Birch, "15 to 25", "leaf 3 to 7 cm"),
    (Species::Alder, "20 to 30", "leaf 5 to 10 cm"),
    (Species::Maple, "20 to 30", "leaf 7 to 14 cm"),
    (
        Species::Rowan,
        "5 to 15",
        "leaf 10 to 22 cm, 9 to 17 leaflets",
    ),
    (Species::Pine, "20 to 35", "needle 3 to 7 cm"),
    (Species::Palmetto, "up to 20", "fan up to 2 m across"),
    (Species::Willow, "up to 20", "leaf 8 to 16 cm"),
    (Species::Bush, "1 to 4", "leaf 1 to 6 cm"),
];

fn main() {
    let wanted = Wanted::from_command_line();
    let folder = tempfile::tempdir().expect("a temporary folder");
    let mut bench = Bench {
        rows: Rows::create("grow"),
        folder: folder.path().to_owned(),
    };
    for leaves in [20_376, 105_688, 1_000_000] {
        for species in [Species::Oak, Species::Rowan, Species::Pine] {
            if wanted.has(&format!("time {species} {leaves}")) {
                bench.timed(species, leaves);
            }
        }
    }
    if wanted.has("growth") {
        bench.growth();
    }
    if wanted.has("species") {
        bench.species();
    }
}

struct Bench {
    rows: Rows,
    folder: PathBuf,
}

impl Bench {
    /// Runs the command and notes its figures; modules or leaves, and least seconds.
    fn timed(&mut self, species: Species, leaves: u32) -> f64 {
        let case = format!("{species} with {leaves} leaves");
        let line = format!("secateur grow {species} --leaves {leaves} --seed 7");
        let count = leaves.to_string();
        let output = self.folder.join("out.glb");
        let mut arguments = [
            "grow",
            species.name(),
            "--seed",
            "7",
            "--leaves",
            &count,
            "-o",
        ]
        .map(OsStr::new)
        .to_vec();
        arguments.push(output.as_os_str());
        let run = TimedRun {
            case: &case,
            line: &line,
            arguments: &arguments,
            stages: &["grow", "write"],
        };
        run.note(&mut self.rows, &self.folder)
    }

    /// The exponent of time over modules, by least squares of the logarithms.
    fn growth(&mut self) {
        let mut points = Vec::new();
        for leaves in [50_000u32, 100_000, 200_000, 400_000, 800_000] {
            let case = format!("growth: oak with {leaves} leaves");
            let (mut least, mut modules) = (f64::INFINITY, 0);
            for _ in 0..repeats() {
                let start = Instant::now();
                let detail = (f64::from(leaves) / f64::from(Species::Oak.default_leaves())).sqrt();
                let rules = Species::Oak.rules();
                let word = rules.derive(detail, &mut secateur_plant::Random::new(7));
                let word = word.expect("the rules of the oak derive");
                let skeleton = secateur_plant::draw(rules, &word).expect("and draw");
                least = least.min(start.elapsed().as_secs_f64());
                modules = word.modules_made();
                drop(skeleton);
            }
            for (quantity, unit, value) in [
                ("modules", "", modules as f64),
                ("derive and draw", "s", least),
            ] {
                self.rows
                    .note(&case, quantity, unit, value, "derive, draw; seed 7");
            }
            points.push((modules as f64, least));
        }
        let fit = "log-log fit of the least times above";
        self.rows.note(
            "growth of time with modules",
            "exponent",
            "",
            exponent(points.into_iter()),
            fit,
        );
    }

    /// Every species at its own number of leaves, seed 3, and the real trees.
    fn species(&mut self) {
        let mut table = String::from(
            "| plant | leaves | wood triangles | height m | crown m | leaf cm | leaf-area index | \
             depth complexity | grown trees (botany) |\n|---|---|---|---|---|---|---|---|---|\n",
        );
        for (species, height, leaf) in BOTANY {
            let options = GrowOptions {
                leaves: species.default_leaves(),
                seed: 3,
            };
            let plant = grow(species, &options).expect("every species grows");
            let document = Document::from_bytes("grown.glb", plant_to_glb(&plant), None);
            let tree = document.and_then(|d| d.into_tree(&[])).expect("a tree");
            let botany = format!("{height} m high; {leaf}");
            let command = format!("secateur grow {species} --seed 3");
            self.plausible(
                &mut table,
                species.name(),
                &command,
                &tree,
                Some(leaf_length(species, &options)),
                &botany,
            );
        }
        for name in [
            "ez_oak_20k.glb",
            "sap_birch_hex_9k.glb",
            "sap_pine_needles_48k.glb",
            "ez_bush2.glb",
        ] {
            if let Some(path) = shared_tree(name) {
                let tree = Tree::open(&path, &[]).expect("the tree loads");
                self.plausible(&mut table, name, name, &tree, None, "another tool's tree");
            }
        }
        let path = self.rows.folder().join("species.md");
        std::fs::write(&path, table).expect("the table can be written");
        println!("{}", path.display());
    }

    fn plausible(
        &mut self,
        table: &mut String,
        case: &str,
        command: &str,
        tree: &Tree,
        leaf_length: Option<f64>,
        botany: &str,
    ) {
        let figures = Figures::of(tree, leaf_length);
        let named = figures.named();
        for (quantity, unit, value) in named.into_iter().filter(|(.., value)| value.is_finite()) {
            self.rows.note(case, quantity, unit, value, command);
        }
        let _ = writeln!(
            table,
            "| {case} | {} | {} | {:.1} | {:.1} x {:.1} | {} | {:.1} | {:.1} | {botany} |",
            figures.leaves,
            figures.wood_triangles,
            figures.size.y,
            figures.size.x,
            figures.size.z,
            figures
                .leaf_length
                .map_or("-".to_owned(), |m| format!("{:.0}", 100.0 * m)),
            figures.leaf_area_index,
            figures.depth_complexity,
        );
    }
}

struct Figures {
    leaves: usize,
    wood_triangles: u64,
    /// Width of the crown, height above the ground, depth of the crown.
    size: DVec3,
    /// The mean from base to tip, stalk included, in metres; of grown plants.
    leaf_length: Option<f64>,
    /// Leaf area, one side, cut-outs subtracted, over the ground below the crown:
    /// the ellipse that its width and depth span.
    leaf_area_index: f64,
    /// Leaves behind a pixel that has any, over 20 views of 256 x 256.
    depth_complexity: f64,
}

impl Figures {
    fn of(tree: &Tree, leaf_length: Option<f64>) -> Self {
        let foliage = tree.foliage();
        let corners = || foliage.triangles().iter().flat_map(|t| t.corners);
        let low = corners().fold(DVec3::INFINITY, DVec3::min);
        let high = corners().fold(DVec3::NEG_INFINITY, DVec3::max);
        let size = high - low;
        let ground = std::f64::consts::FRAC_PI_4 * size.x * size.z;
        let area = |leaf: &secateur_model::Leaf| {
            let cutout = leaf.cutout().map(|c| &foliage.cutouts()[c as usize]);
            leaf.area() * cutout.map_or(1.0, |cutout| cutout.coverage())
        };
        let leaf_area: f64 = foliage.leaves().iter().map(area).sum();
        Self {
            leaves: foliage.leaves().len(),
            wood_triangles: tree.wood_triangle_count(),
            size: DVec3::new(size.x, high.y, size.z),
            leaf_length,
            leaf_area_index: leaf_area / ground,
            depth_complexity: depth_complexity(foliage),
        }
    }

    fn named(&self) -> [(&'static str, &'static str, f64); 8] {
        [
            ("leaves", "", self.leaves as f64),
            ("wood_triangles", "", self.wood_triangles as f64),
            ("height", "m", self.size.y),
            ("crown_width", "m", self.size.x),
            ("crown_depth", "m", self.size.z),
            ("leaf_length", "m", self.leaf_length.unwrap_or(f64::NAN)),
            ("leaf_area_index", "", self.leaf_area_index),
            ("depth_complexity", "", self.depth_complexity),
        ]
    }
}

fn leaf_length(species: Species, options: &GrowOptions) -> f64 {
    let skeleton = grow_skeleton(species, options).expect("every species grows");
    let sum: f64 = skeleton.leaves.iter().map(|leaf| leaf.length_m).sum();
    sum / skeleton.leaves.len() as f64
}

fn depth_complexity(foliage: &Foliage) -> f64 {
    let views = ViewSet::dodecahedron(foliage.bounding_sphere().expect("leaves"));
    let lod = Lod::original(foliage.leaves().len());
    let scene = Scene {
        foliage,
        lod: &lod,
        views: &views,
        resolution: 256,
    };
    let fragments = CpuRasteriser.fragments(&scene).expect("fragments");
    let lists = fragments.views().iter().flat_map(|view| view.pixels());
    let covered = lists.filter(|list| !list.is_empty()).count();
    fragments.len() as f64 / covered.max(1) as f64
}
