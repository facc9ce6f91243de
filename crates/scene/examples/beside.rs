//! Draws plants and levels beside each other at a true size: `beside OUT.png PIXELS AZIMUTH A.glb B.glb ...`.
use glam::DVec3;
use image::{RgbaImage, imageops};
use secateur_eval::{Camera, DifferenceJudge, RenderOptions, ViewCount, render};
use secateur_gltf::{Detail, Document};
use secateur_model::Surface;
use std::path::Path;

fn main() {
    let args: Vec<String> = std::env::args().collect();
    let px: f64 = args[2].parse().unwrap();
    let azimuth: f64 = args[3].parse::<f64>().unwrap().to_radians();
    let all: Vec<Vec<Surface>> = args[4..]
        .iter()
        .map(|p| {
            let document = Document::open(Path::new(p)).unwrap();
            document
                .drawn_as_one(Detail::Color)
                .unwrap()
                .into_iter()
                .map(|d| d.surface)
                .collect()
        })
        .collect();
    let points = || {
        all[0].iter().flat_map(|s| {
            s.triangles
                .iter()
                .flatten()
                .map(|c| s.positions[*c as usize])
        })
    };
    let (low, high) = points().fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(a, b), p| {
        (a.min(p), b.max(p))
    });
    let centre = 0.5 * (low + high);
    let radius = points().map(|p| p.distance(centre)).fold(0.0, f64::max);
    let size = (high - low).max_element();
    let judge = DifferenceJudge::new(all[0].clone(), &[]);
    let (width, height) = ((px * 1.15) as u32, (px * 1.1) as u32);
    let fov = 2.0 * (0.5 * f64::from(height) / (px / size * 3.0 * radius)).atan();
    let mut sheet = RgbaImage::new(width * all.len() as u32, height);
    for (k, surfaces) in all.iter().enumerate() {
        let away = DVec3::new(azimuth.sin(), 0.1, azimuth.cos()).normalize();
        let camera = Camera {
            eye: centre + away * 3.0 * radius,
            target: centre,
            up: DVec3::Y,
            fov_y_rad: fov,
        };
        let options = RenderOptions {
            width,
            height,
            samples: 3,
            shadows: false,
            turns_normals: false,
        };
        imageops::replace(
            &mut sheet,
            &render(surfaces, &camera, &options),
            i64::from(width) * k as i64,
            0,
        );
        let triangles: usize = surfaces.iter().map(|s| s.triangles.len()).sum();
        println!(
            "{}: {triangles} triangles, {:?}",
            args[4 + k],
            judge.difference(surfaces, px, ViewCount::All)
        );
    }
    sheet.save(&args[1]).unwrap();
}
