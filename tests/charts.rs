//! Textures of opaque charts: what a coarser surface shows between them.

use std::sync::Arc;

use glam::{DVec3, Vec2};
use secateur::{ColorChoice, Document, LevelOptions, Opening, Plant, surfaces_to_glb};
use secateur_model::{Filters, Material, Surface, Texture, Wrap};
use secateur_plant::{GrowOptions, Species, grow};

/// A ball in two charts, its upper and its lower half: brown discs on a black texture.
fn ball_in_charts() -> Vec<u8> {
    const RINGS: u32 = 40;
    const STEPS: u32 = 96;
    const SIDE_PX: u32 = 128;
    let texel = |at: u32| {
        let [x, y] = [at % (2 * SIDE_PX), at / (2 * SIDE_PX)].map(|k| k % SIDE_PX);
        let middle = f64::from(SIDE_PX - 1) / 2.0;
        let from_middle = (f64::from(x) - middle).hypot(f64::from(y) - middle);
        match from_middle < 0.46 * f64::from(SIDE_PX) {
            true => [120, 80, 50, 255],
            false => [0, 0, 0, 255],
        }
    };
    let oak = grow(Species::Oak, &GrowOptions { leaves: 1, seed: 1 }).unwrap();
    let mut material = Material::clone(&oak.wood.material);
    material.texture = Some(Arc::new(Texture {
        width: 2 * SIDE_PX,
        height: SIDE_PX,
        rgba: (0..2 * SIDE_PX * SIDE_PX).flat_map(texel).collect(),
        wrap: [Wrap::Repeat; 2],
        filters: Filters::default(),
    }));
    let mut ball = Surface::empty(Arc::new(material));
    for half in [0, 1] {
        let first = ball.positions.len() as u32;
        for ring in 0..=RINGS {
            for step in 0..STEPS {
                let down = f64::from(ring) / f64::from(RINGS);
                let (up, around) = (
                    down * std::f64::consts::FRAC_PI_2,
                    f64::from(step) / f64::from(STEPS) * std::f64::consts::TAU,
                );
                let reach = 1.0 + 0.03 * (9.0 * around).sin() * up.sin();
                let sign = if half == 0 { 1.0 } else { -1.0 };
                let point = DVec3::new(
                    around.cos() * up.sin(),
                    sign * up.cos(),
                    around.sin() * up.sin(),
                );
                ball.normals.push(point.as_vec3());
                ball.positions.push(reach * point);
                let [u, v] = [around.cos(), around.sin()].map(|at| 0.5 + 0.44 * down * at);
                let u = (f64::from(half) + u) / 2.0;
                ball.uvs.push(Vec2::new(u as f32, v as f32));
            }
        }
        for (ring, step) in (0..RINGS).flat_map(|ring| (0..STEPS).map(move |step| (ring, step))) {
            let at = |ring: u32, step: u32| first + ring * STEPS + step % STEPS;
            let [a, b] = [step, step + 1].map(|step| at(ring, step));
            let [c, d] = [step, step + 1].map(|step| at(ring + 1, step));
            let corners = [[a, b, c], [b, d, c]];
            let turned = corners.map(|[a, b, c]| if half == 0 { [a, b, c] } else { [a, c, b] });
            ball.triangles.extend(turned);
        }
    }
    surfaces_to_glb("ball", &[(ball, false)])
}

/// The share of points, evenly over the texture coordinates of each triangle, at which a file shows black.
fn black(glb: Vec<u8>) -> f64 {
    const STEPS: u32 = 12;
    let document = Document::from_bytes("ball.glb", glb, None).unwrap();
    let (mut count, mut all) = (0, 0);
    for (surface, _) in document.surfaces(&[]).unwrap() {
        let texture = surface.material.texture.as_ref().unwrap();
        let size = Vec2::new(texture.width as f32, texture.height as f32);
        for corners in &surface.triangles {
            let [a, b, c] = corners.map(|corner| surface.uvs[corner as usize]);
            for (i, j) in (0..STEPS).flat_map(|i| (0..STEPS - i).map(move |j| (i, j))) {
                let [s, t] = [i, j].map(|k| (k as f32 + 0.3) / STEPS as f32);
                let at = (a + (b - a) * s + (c - a) * t) * size;
                let [x, y] = [at.x, at.y].map(|at| at as usize);
                let texel = 4 * (y * texture.width as usize + x);
                all += 1;
                count += usize::from(texture.rgba[texel] < 20);
            }
        }
    }
    f64::from(count as u32) / f64::from(all as u32)
}

/// A seam of few corners cuts across the texture between its charts: what lies there is as what is near.
#[test]
fn a_level_shows_nothing_of_what_lies_between_charts() {
    let plant = Plant::from_bytes("ball.glb", ball_in_charts(), &Opening::default()).unwrap();
    let level = |colors| {
        let options = LevelOptions {
            colors,
            ..LevelOptions::triangles(0.02)
        };
        black(plant.level(&options).unwrap().to_bytes().unwrap())
    };
    let [as_it_was, filled] = [ColorChoice::Keep, ColorChoice::default()].map(level);
    assert!(as_it_was > 0.005 && filled == 0.0, "{as_it_was} {filled}");
    assert_eq!(black(ball_in_charts()), 0.0);
}
