//! Grows an oak, thins its leaves by plain skipping and draws the results side
//! by side: `cargo run --release -p secateur-plant --example contact_sheet`.
//!
//! Arguments: number of leaves (3000), seed (7), output (target/contact_sheet.png).

use std::error::Error;
use std::time::Instant;

use secateur_eval::{Panel, RenderOptions, contact_sheet, framing, render};
use secateur_model::{Plant, Surface};
use secateur_plant::{GrowOptions, Species, grow};

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments = std::env::args().skip(1);
    let defaults = GrowOptions::default();
    let leaves = arguments
        .next()
        .map_or(Ok(defaults.leaves), |a| a.parse())?;
    let seed = arguments.next().map_or(Ok(defaults.seed), |a| a.parse())?;
    let path = arguments.next();
    let path = path.unwrap_or_else(|| "target/contact_sheet.png".into());

    let start = Instant::now();
    let oak = grow(Species::Oak, &GrowOptions { leaves, seed })?;
    println!("grown in {:.3} s", start.elapsed().as_secs_f64());
    let options = RenderOptions::panel(640, 800);
    let camera = framing(&[&oak.wood, &oak.leaves], 640.0 / 800.0);
    let mut panels = Vec::new();
    for (title, keep_one_of) in [("original", 1), ("50 %", 2), ("25 %", 4), ("10 %", 10)] {
        let kept = thinned(&oak, keep_one_of);
        let start = Instant::now();
        let image = render(&[&oak.wood, &kept], &camera, &options);
        println!("{title}: drawn in {:.3} s", start.elapsed().as_secs_f64());
        panels.push(Panel {
            title: title.into(),
            subtitle: format!(
                "{} leaves\n{} triangles of leaves, {} of wood",
                kept.triangles.len() / 2,
                kept.triangles.len(),
                oak.wood.triangles.len()
            ),
            image,
        });
    }
    contact_sheet(&panels).save(&path)?;
    println!("{path}");
    Ok(())
}

/// Every so many-th leaf.
fn thinned(plant: &Plant, keep_one_of: usize) -> Surface {
    let mut surface = plant.leaves.clone();
    let leaves = surface.triangles.chunks(2).step_by(keep_one_of);
    surface.triangles = leaves.flatten().copied().collect();
    surface
}
