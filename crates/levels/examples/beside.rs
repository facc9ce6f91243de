//! Draws a plant and levels of it side by side at a true size, each with its triangles and its difference there, to be
//! graded by eye:
//!
//! ```text
//! cargo run --release --package secateur-levels --example beside -- \
//!     [--plain] OUT.png PIXELS_HIGH AZIMUTH_DEGREES PLANT.glb LEVEL.glb...
//! ```
//!
//! The captions say what the eye should not know before it has graded: with `--plain` there are none.

use std::error::Error;
use std::fs::File;
use std::io::BufWriter;
use std::path::Path;
use std::process::ExitCode;

use glam::DVec3;
use image::DynamicImage;
use image::codecs::png::{CompressionType, FilterType, PngEncoder};
use secateur_eval::{
    Camera, DifferenceJudge, Panel, RenderOptions, ViewCount, contact_sheet, render,
};
use secateur_gltf::{Detail, Document, WholeTree};
use secateur_model::Surface;

/// How far off cameras stand, in radii of the plant.
const RADII: f64 = 3.0;

/// Width and height of a panel over those of the plant.
const ROOM: [f64; 2] = [1.15, 1.1];

fn main() -> ExitCode {
    let mut arguments: Vec<String> = std::env::args().skip(1).collect();
    let is_plain = arguments.first().is_some_and(|first| first == "--plain");
    if is_plain {
        arguments.remove(0);
    }
    let [output, pixels_high, azimuth, plant, levels @ ..] = &arguments[..] else {
        eprintln!(
            "usage: beside [--plain] OUT.png PIXELS_HIGH AZIMUTH_DEGREES PLANT.glb LEVEL.glb..."
        );
        return ExitCode::from(2);
    };
    match write((output, is_plain), [pixels_high, azimuth], plant, levels) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("{error}");
            ExitCode::FAILURE
        }
    }
}

fn write(
    (output, is_plain): (&str, bool),
    [pixels_high, azimuth]: [&String; 2],
    plant: &str,
    levels: &[String],
) -> Result<(), Box<dyn Error>> {
    let (pixels_high, azimuth): (f64, f64) = (pixels_high.parse()?, azimuth.parse()?);
    let (original, is_wood) = surfaces_and_wood(plant)?;
    let judge = DifferenceJudge::new(original.clone(), &is_wood);
    let (camera, size_px) = camera(&original, judge.size(), pixels_high, azimuth.to_radians());
    let options = RenderOptions {
        samples: 3,
        turns_normals: true,
        shadows: false,
        ..RenderOptions::panel(size_px[0], size_px[1])
    };
    let mut panels = Vec::new();
    for file in [&plant.to_owned()].into_iter().chain(levels) {
        let surfaces = surfaces(file)?;
        let triangles: usize = surfaces.iter().map(|s| s.triangles.len()).sum();
        let difference = judge.difference(&surfaces, pixels_high, ViewCount::All);
        println!("{file}: {triangles} triangles, {difference:?}");
        let (title, subtitle) = match is_plain {
            true => Default::default(),
            false => (
                format!("{:.2}", difference.difference),
                format!("{triangles} triangles"),
            ),
        };
        panels.push(Panel {
            title,
            subtitle,
            image: render(&surfaces, &camera, &options),
        });
    }
    let file = BufWriter::new(File::create(output)?);
    let smallest = (CompressionType::Best, FilterType::Adaptive);
    let encoder = PngEncoder::new_with_quality(file, smallest.0, smallest.1);
    DynamicImage::from(contact_sheet(&panels))
        .to_rgb8()
        .write_with_encoder(encoder)?;
    Ok(())
}

fn surfaces(file: &str) -> Result<Vec<Surface>, Box<dyn Error>> {
    let drawn = Document::open(Path::new(file))?.drawn_as_one(Detail::Color)?;
    Ok(drawn.into_iter().map(|drawn| drawn.surface).collect())
}

/// What a plant shows, and which of it is wood, if leaves are found.
fn surfaces_and_wood(file: &str) -> Result<(Vec<Surface>, Vec<bool>), Box<dyn Error>> {
    let Ok(tree) = WholeTree::open(Path::new(file), &[]) else {
        return Ok((surfaces(file)?, Vec::new()));
    };
    let drawn = tree.items().drawn(Detail::Color)?;
    let is_wood = drawn.iter().map(|drawn| !drawn.is_foliage).collect();
    let surfaces = drawn.into_iter().map(|drawn| drawn.surface).collect();
    Ok((surfaces, is_wood))
}

/// A camera that shows `size`, in world units, as `pixels_high` pixels; and the width and height of its pictures in
/// pixels.
fn camera(
    surfaces: &[Surface],
    size: f64,
    pixels_high: f64,
    azimuth_rad: f64,
) -> (Camera, [u32; 2]) {
    let points = || {
        surfaces.iter().flat_map(|surface| {
            let corners = surface.triangles.iter().flatten();
            corners.map(|corner| surface.positions[*corner as usize])
        })
    };
    let (low, high) = points().fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(low, high), p| {
        (low.min(p), high.max(p))
    });
    let centre = 0.5 * (low + high);
    let radius = points().map(|p| p.distance(centre)).fold(0.0, f64::max);
    let size_px = ROOM.map(|room| (pixels_high * room) as u32);
    let px_at_plant = pixels_high / size * RADII * radius;
    let away = DVec3::new(azimuth_rad.sin(), 0.1, azimuth_rad.cos()).normalize();
    let camera = Camera {
        eye: centre + away * RADII * radius,
        target: centre,
        up: DVec3::Y,
        fov_y_rad: 2.0 * (0.5 * f64::from(size_px[1]) / px_at_plant).atan(),
    };
    (camera, size_px)
}
