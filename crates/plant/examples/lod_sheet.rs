//! Draws four levels of detail of a species, by its chain of branches and by
//! merging: `cargo run --release -p secateur-plant --example lod_sheet -- OUT.png
//! [SPECIES [LEAVES]]`.

use std::error::Error;

use image::{RgbaImage, imageops};
use secateur_eval::{Panel, RenderOptions, contact_sheet, framing, render};
use secateur_model::Plant;
use secateur_plant::{
    Chain, ClusterSize, GrowOptions, Metric, Scheme, Skeleton, Species, grow_skeleton,
    merge_levels, plant_of,
};

const PANEL_PX: [u32; 2] = [260, 290];
const SEED: u64 = 7;

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments = std::env::args().skip(1);
    let path = arguments.next().ok_or("say where the sheet goes")?;
    let species: Species = arguments.next().as_deref().unwrap_or("oak").parse()?;
    let leaves = arguments.next().as_deref().unwrap_or("5000").parse()?;
    let whole = grow_skeleton(species, &GrowOptions { leaves, seed: SEED })?;
    let plant = plant_of(whole.clone(), species.rules(), species.name(), SEED)?;
    // All levels are looked at as the whole plant is, so that heights compare.
    let [width, height] = PANEL_PX;
    let surfaces = [&plant.wood, &plant.leaves];
    let camera = framing(&surfaces, f64::from(width) / f64::from(height));
    let panel = |title: String, skeleton: Skeleton| -> Result<Panel, Box<dyn Error>> {
        let plant: Plant = plant_of(skeleton, species.rules(), species.name(), SEED)?;
        let surfaces = [&plant.wood, &plant.leaves];
        let triangles = plant.wood.triangles.len() + plant.leaves.triangles.len();
        let leaves = plant.triangles_per_leaf.len();
        Ok(Panel {
            title,
            subtitle: format!("{leaves} leaves\n{triangles} triangles"),
            image: render(&surfaces, &camera, &RenderOptions::panel(width, height)),
        })
    };

    let chain = Chain::of(&whole, Metric::BranchingLength);
    let mut above = Vec::new();
    for share in [1.0, 0.25, 0.05, 0.01] {
        let levels = (share * chain.levels() as f64).ceil() as usize;
        let title = format!("chain {levels} of {}", chain.levels());
        above.push(panel(title, chain.skeleton(levels))?);
    }
    let mut below = Vec::new();
    let scheme = Scheme::halving();
    let levels = merge_levels(&whole, &scheme, ClusterSize::Paper);
    for (k, level) in levels.into_iter().enumerate() {
        let gone = 100.0 * scheme.shares_gone()[k];
        below.push(panel(format!("merge -{gone} %"), level.skeleton)?);
    }
    stacked(&[contact_sheet(&above), contact_sheet(&below)]).save(&path)?;
    println!("{path}");
    Ok(())
}

fn stacked(rows: &[RgbaImage]) -> RgbaImage {
    let width = rows.iter().map(RgbaImage::width).max().unwrap_or(1);
    let height = rows.iter().map(RgbaImage::height).sum::<u32>().max(1);
    let mut sheet = RgbaImage::new(width, height);
    let mut y = 0;
    for row in rows {
        imageops::replace(&mut sheet, row, 0, y);
        y += i64::from(row.height());
    }
    sheet
}
