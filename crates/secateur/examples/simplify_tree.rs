//! Load, choose the foliage, simplify, look at the order, write.
//!
//! `cargo run --release --example simplify_tree [TREE.glb [SELECTOR]]`; without a
//! tree it grows one. The result goes to the system's folder for temporary files.

use std::error::Error;
use std::path::Path;

use secateur::plant::{GrowOptions, Species, grow};
use secateur::{Document, Options, Selector, Target, plant_to_glb, simplify};

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments = std::env::args().skip(1);
    let document = match arguments.next() {
        Some(path) => Document::open(Path::new(&path))?,
        None => {
            let options = GrowOptions {
                leaves: 800,
                seed: 1,
            };
            let oak = grow(Species::Oak, &options)?;
            Document::from_bytes("oak.glb", plant_to_glb(&oak), None)?
        }
    };
    // Without selectors the evidence decides; this shows what it says.
    let selectors: Vec<Selector> = arguments
        .map(|text| text.parse())
        .collect::<Result<_, _>>()?;
    println!("{}", document.inspect(&selectors));
    let tree = document.into_tree(&selectors)?;

    let options = Options::to(Target::leaf_share(0.1));
    let result = simplify(tree.foliage(), &options)?;
    let pixels_per_view = result.resolution * result.resolution;
    let removals = result.passes.order.steps().zip(&result.costs);
    for (step, cost) in removals.take(5) {
        println!(
            "{} goes at a cost of {:.2e} bits; {} grow for it",
            step.removed[0],
            cost.bits(pixels_per_view),
            step.grown.len()
        );
    }

    // Every prefix of the removal order is a LOD: here half of the leaves, from the same run.
    let half = result.passes.lod_after(tree.foliage().leaves().len() / 2);
    for (name, lod) in [("half", &half), ("tenth", &result.lod)] {
        let path = std::env::temp_dir().join(format!("secateur-{name}.glb"));
        let written = tree.write_lod(lod, &path)?;
        println!(
            "{}: {} leaves, {} triangles",
            path.display(),
            lod.leaf_count(),
            written.triangles
        );
    }
    Ok(())
}
