//! A forest: 100 to 2,000 instances of a plant, each at its own level, drawn offscreen through wgpu.
//!
//! ```text
//! cargo run --release --package secateur-levels --example forest -- OUT.png [TREES [METHOD [TREE.glb]]]
//! cargo run --release --package secateur-levels --example forest -- figures [PART]
//! ```
//!
//! The environment's `FRAMES` is the number of frames of a method that figures count, one where it says nothing.
//!
//! METHOD: full, chain, continuous, fading, spheres, boxes or mix, which is the default. The plant is an oak
//! of 20,000 leaves where no other is named. Figures go to `benches/results`; pictures of what was
//! compared to the folder for temporary files.
//!
//! What is where: `species` makes the plant and its levels, `geometry` and `uploaded` bring them to
//! the GPU, `methods` decides what each tree is drawn as, `draw_list` collects it, `renderer` draws it
//! with `pipelines` and `forest.wgsl`; `placing` has trees and cameras, `figures` measures.

mod clock;
mod draw_list;
mod figures;
mod geometry;
mod gpu;
mod methods;
mod pipelines;
mod placing;
mod renderer;
#[path = "../../../../benches/rows.rs"]
#[allow(dead_code, reason = "benches use more of it")]
mod rows;
mod species;
mod uploaded;

use std::error::Error;
use std::process::ExitCode;

use secateur_runtime::stand;
use secateur_runtime::view_dependent::ViewDependent;

use figures::Figures;
use gpu::Gpu;
use methods::{Method, RULE, Stand};
use pipelines::Pipelines;
use renderer::Renderer;
use rows::{Rows, Wanted};
use species::Species;
use uploaded::Uploaded;

const USAGE: &str = "usage: forest OUT.png [TREES [METHOD [TREE.glb]]], or forest figures [PART]; \
     TREES from 1 to 10000, METHOD one of full, chain, continuous, fading, spheres, boxes, mix";

/// Width and height of the picture in pixels.
const SIZE: [u32; 2] = [1280, 720];

const DEFAULT_TREES: usize = 2000;
const MOST_TREES: usize = 10_000;

/// What the command line asks for.
enum Task {
    Figures(Wanted),
    Picture {
        output: String,
        trees: usize,
        method: Method,
        file: Option<String>,
    },
}

fn task(arguments: &[String]) -> Option<Task> {
    if arguments.first()? == "figures" {
        return (arguments.len() <= 2)
            .then(|| Task::Figures(Wanted::of(arguments.get(1).cloned())));
    }
    let trees = match arguments.get(1) {
        None => DEFAULT_TREES,
        Some(text) => text.parse().ok().filter(|n| (1..=MOST_TREES).contains(n))?,
    };
    let method = match arguments.get(2).map_or("mix", String::as_str) {
        "full" => Method::Full,
        "chain" => Method::Chain,
        "continuous" => Method::Continuous,
        "fading" => Method::Fading,
        "spheres" => Method::Spheres,
        "boxes" => Method::Boxes,
        "mix" => Method::Mix,
        _ => return None,
    };
    (arguments.len() <= 4).then(|| Task::Picture {
        output: arguments[0].clone(),
        trees,
        method,
        file: arguments.get(3).cloned(),
    })
}

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let Some(task) = task(&arguments) else {
        eprintln!("{USAGE}");
        return ExitCode::from(2);
    };
    match run(task) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("forest: {error}");
            ExitCode::FAILURE
        }
    }
}

fn run(task: Task) -> Result<(), Box<dyn Error>> {
    let gpu = Gpu::open()?;
    let file = match &task {
        Task::Picture { file, .. } => file.as_deref(),
        Task::Figures(_) => None,
    };
    let species = Species::new(file)?;
    let leaf_indices = species.leaves.most_indices();
    let pipelines = Pipelines::new(&gpu, leaf_indices);
    let uploaded = Uploaded::new(&gpu, &pipelines, &species);
    let cut = ViewDependent::new(&species.leaves.model, &species.leaves.foliage);
    eprintln!(
        "{}: {} leaves, {} triangles of leaves and {} of wood, {} boxes with pictures; {}",
        species.name,
        species.leaves.model.most_leaves(),
        species.leaves.foliage.triangles().len(),
        species.wood.foliage.triangles().len(),
        species.boxes.len(),
        gpu.adapter,
    );
    match task {
        Task::Figures(wanted) => {
            let mut figures = Figures {
                gpu: &gpu,
                pipelines: &pipelines,
                species: &species,
                uploaded: &uploaded,
                cut,
                leaf_indices,
                rows: Rows::create("forest"),
            };
            figures.all(&wanted);
        }
        Task::Picture {
            output,
            trees,
            method,
            ..
        } => {
            let radius = species.sphere.radius;
            let instances = placing::square(trees, radius, 1);
            stand::check(&instances, &species.leaves.model)?;
            if method == Method::Boxes && uploaded.boxes.is_none() {
                return Err(
                    format!("{}: there is no skeleton to make boxes of", species.name).into(),
                );
            }
            let camera = placing::overlook(trees, radius, SIZE);
            let mut stand = Stand {
                species: &species,
                uploaded: &uploaded,
                instances: &instances,
                cut,
                rule: RULE,
            };
            let renderer = Renderer::new(&gpu, &pipelines, &uploaded, leaf_indices, SIZE);
            let (drawn, seconds) = clock::timed(|| {
                let list = stand.frame(method, &camera, camera.eye);
                renderer.draw(&list, &camera)
            });
            renderer.picture().save(&output)?;
            println!(
                "{output}: {trees} trees, {}: {} triangles, {:.0} ms",
                method.name(),
                drawn.triangles,
                1e3 * seconds.wall,
            );
        }
    }
    Ok(())
}
