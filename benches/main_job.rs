//! The whole command, from file to file, as a user runs it: seconds, peak
//! memory, and how time grows with the number of leaves.
//!
//! `cargo bench --bench main_job [-- PART]`; PART picks cases by name.

mod program;
mod rows;

use std::ffi::OsStr;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use program::TimedRun;
use rows::{Rows, Wanted, exponent, shared_tree};
use secateur_gltf::plant_to_glb;
use secateur_model::{AlphaMode, Material, Plant, Surface};
use secateur_plant::{EllipsoidCrown, ellipsoid_crown};
use secateur_raster::gpu::{Device, Preference};

fn main() {
    let wanted = Wanted::from_command_line();
    let folder = tempfile::tempdir().expect("a temporary folder");
    let mut bench = Bench {
        rows: Rows::create("main_job"),
        folder: folder.path().to_owned(),
    };
    if wanted.has("ez_oak_20k")
        && let Some(tree) = shared_tree("ez_oak_20k.glb")
    {
        bench.case(
            "ez_oak_20k to 2016 at 256",
            &tree,
            &["--leaves", "2016", "--resolution", "256"],
        );
    }
    if wanted.has("sap_pine")
        && let Some(tree) = shared_tree("sap_pine_needles_48k.glb")
    {
        bench.case("sap_pine to 4861, auto", &tree, &["--leaves", "4861"]);
        bench.case(
            "sap_pine to 4861 at 256",
            &tree,
            &["--leaves", "4861", "--resolution", "256"],
        );
    }
    if wanted.has("crown_105688") {
        let tree = bench.crown(105_688);
        bench.case(
            "crown_105688 to 1057 at 256",
            &tree,
            &["--leaves", "1057", "--resolution", "256"],
        );
        bench.case("crown_105688 to 1057, auto", &tree, &["--leaves", "1057"]);
    }
    if wanted.has("growth") {
        bench.growth();
    }
    if wanted.has("engines") {
        bench.engines();
    }
}

struct Bench {
    rows: Rows,
    folder: PathBuf,
}

impl Bench {
    /// Runs the command on a tree and notes its figures; least seconds.
    fn case(&mut self, case: &str, tree: &Path, target: &[&str]) -> f64 {
        self.case_on("cpu", case, tree, target)
    }

    fn case_on(&mut self, engine: &str, case: &str, tree: &Path, target: &[&str]) -> f64 {
        let line = format!(
            "secateur simplify {} {} --engine {engine}",
            tree.file_name().unwrap_or_default().to_string_lossy(),
            target.join(" ")
        );
        let output = self.folder.join("out.glb");
        let mut arguments = vec![OsStr::new("simplify"), tree.as_os_str()];
        arguments.extend([OsStr::new("-o"), output.as_os_str()]);
        arguments.extend(target.iter().map(OsStr::new));
        arguments.extend(["--engine", engine].map(OsStr::new));
        let run = TimedRun {
            case,
            line: &line,
            arguments: &arguments,
            stages: &[],
        };
        run.note(&mut self.rows, &self.folder)
    }

    /// The CPU and a GPU that is no software driver, by cores at work.
    fn engines(&mut self) {
        if let Err(reason) = Device::find(Preference::Hardware) {
            eprintln!("SKIPPED: engines: {reason}");
            return;
        }
        let mut trees = vec![(self.crown(100_000), "256")];
        if let Some(oak) = shared_tree("ez_oak_20k.glb") {
            trees.extend(["256", "1024"].map(|resolution| (oak.clone(), resolution)));
        }
        let all = std::thread::available_parallelism().map_or(1, usize::from);
        for (tree, resolution) in &trees {
            let mut cores = vec![2.min(all), all];
            cores.dedup();
            for threads in cores.iter().map(usize::to_string) {
                for engine in ["cpu", "gpu"] {
                    let name = tree.file_stem().unwrap_or_default().to_string_lossy();
                    let case = format!(
                        "engines: {name} to 10 % at {resolution}, {threads} threads, {engine}"
                    );
                    let target = ["--ratio", "0.1", "--resolution", resolution];
                    let target = [&target[..], &["--threads", &threads]].concat();
                    self.case_on(engine, &case, tree, &target);
                }
            }
        }
    }

    /// A crown of small quads in a file.
    fn crown(&self, leaves: u32) -> PathBuf {
        let foliage = ellipsoid_crown(leaves, 1, &EllipsoidCrown::default()).expect("a crown");
        let surface = |name: &str, positions, triangles| Surface {
            positions,
            normals: Vec::new(),
            uvs: Vec::new(),
            colors: Vec::new(),
            holds: Vec::new(),
            triangles,
            material: Arc::new(Material {
                name: name.to_owned(),
                base_color: [0.3, 0.5, 0.2, 1.0],
                texture: None,
                alpha_mode: AlphaMode::Opaque,
                double_sided: true,
                finish: secateur::Finish::default(),
            }),
        };
        let mut positions = Vec::new();
        let mut triangles = Vec::new();
        for pair in foliage.triangles().chunks_exact(2) {
            let first = positions.len() as u32;
            positions.extend(pair[0].corners);
            positions.push(pair[1].corners[2]);
            triangles.extend([[first, first + 1, first + 2], [first, first + 2, first + 3]]);
        }
        let wood = [[0.0, -4.0, 0.0], [0.1, -4.0, 0.0], [0.0, 0.0, 0.0]];
        let plant = Plant {
            name: format!("crown of {leaves}"),
            wood: surface(
                "bark",
                wood.map(glam::DVec3::from_array).to_vec(),
                vec![[0, 1, 2]],
            ),
            leaves: surface("leaves", positions, triangles),
            triangles_per_leaf: vec![2; leaves as usize],
            skeleton: None,
            holds: None,
        };
        let path = self.folder.join(format!("crown_{leaves}.glb"));
        std::fs::write(&path, plant_to_glb(&plant)).expect("the crown can be written");
        path
    }

    /// The exponent of time over leaves at equal crown density, by least
    /// squares of the logarithms.
    fn growth(&mut self) {
        let counts = [5_000u32, 10_000, 20_000, 50_000, 100_000];
        let points: Vec<(f64, f64)> = counts
            .iter()
            .map(|&leaves| {
                let tree = self.crown(leaves);
                let case = format!("growth: crown_{leaves} to 10 % at 256");
                let seconds = self.case(&case, &tree, &["--ratio", "0.1", "--resolution", "256"]);
                (f64::from(leaves), seconds)
            })
            .collect();
        self.rows.note(
            "growth of time with leaves",
            "exponent",
            "",
            exponent(points.into_iter()),
            "log-log fit of the least wall times above",
        );
    }
}
