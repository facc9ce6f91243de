//! Draws species side by side, each as large as its panel:
//! `cargo run --release -p secateur-plant --example species_sheet -- OUT.png`.
//!
//! Further arguments: species or rule files (all species), `--seed S` (3),
//! `--leaves N` (as many as suit each), `--columns N` (5).

use std::error::Error;
use std::path::Path;
use std::time::Instant;

use image::{Rgba, RgbaImage, imageops};
use secateur_eval::{Panel, RenderOptions, contact_sheet, framing, render};
use secateur_model::Plant;
use secateur_plant::{Random, Rules, Species, grow_rules};

const PANEL_PX: [u32; 2] = [400, 460];

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments = std::env::args().skip(1);
    let path = arguments.next().ok_or("say where the sheet goes")?;
    let (mut seed, mut leaves, mut columns, mut sources) = (3, None, 5, Vec::new());
    while let Some(argument) = arguments.next() {
        let mut value = || arguments.next().ok_or("an option without its value");
        match argument.as_str() {
            "--seed" => seed = value()?.parse()?,
            "--leaves" => leaves = Some(value()?.parse()?),
            "--columns" => columns = value()?.parse::<usize>()?.max(1),
            _ => sources.push(argument),
        }
    }
    if sources.is_empty() {
        sources.extend(Species::ALL.iter().map(|species| species.name().to_owned()));
    }
    let mut panels = Vec::new();
    for source in &sources {
        let plant = grown(source, leaves, seed)?;
        panels.push(panel(&plant));
    }
    let rows: Vec<RgbaImage> = panels.chunks(columns).map(contact_sheet).collect();
    stacked(&rows).save(&path)?;
    println!("{path}");
    Ok(())
}

fn grown(source: &str, leaves: Option<u32>, seed: u64) -> Result<Plant, Box<dyn Error>> {
    let (rules, name) = match source.parse::<Species>() {
        Ok(species) => (species.rules().clone(), source.to_owned()),
        Err(_) => {
            let stem = Path::new(source).file_stem().unwrap_or_default();
            let text = std::fs::read_to_string(source)?;
            (Rules::parse(&text)?, stem.to_string_lossy().into_owned())
        }
    };
    let start = Instant::now();
    let plant = grow_rules(&rules, &name, leaves, seed)?;
    let seconds = start.elapsed().as_secs_f64();
    let word = rules.derive(1.0, &mut Random::new(seed))?;
    let natural = word.leaf_count(&rules);
    println!("{name}: {seconds:.3} s; {natural} leaves at detail 1");
    Ok(plant)
}

fn panel(plant: &Plant) -> Panel {
    let [width, height] = PANEL_PX;
    let surfaces = [&plant.wood, &plant.leaves];
    let camera = framing(&surfaces, f64::from(width) / f64::from(height));
    let all = || surfaces.iter().flat_map(|surface| &surface.positions);
    let height_m = all().map(|p| p.y).fold(0.0, f64::max);
    Panel {
        title: plant.name.clone(),
        subtitle: format!(
            "{height_m:.1} m, {} leaves\n{} triangles of leaves, {} of wood",
            plant.triangles_per_leaf.len(),
            plant.leaves.triangles.len(),
            plant.wood.triangles.len()
        ),
        image: render(&surfaces, &camera, &RenderOptions::panel(width, height)),
    }
}

fn stacked(rows: &[RgbaImage]) -> RgbaImage {
    let width = rows.iter().map(|row| row.width()).max().unwrap_or(1);
    let height = rows.iter().map(|row| row.height()).sum::<u32>().max(1);
    let paper = rows
        .first()
        .map_or(Rgba([255; 4]), |row| *row.get_pixel(0, 0));
    let mut sheet = RgbaImage::from_pixel(width, height, paper);
    let mut y = 0;
    for row in rows {
        imageops::replace(&mut sheet, row, 0, y);
        y += i64::from(row.height());
    }
    sheet
}
