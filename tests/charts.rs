//! Textures of opaque charts: what a coarser surface shows between them.

use std::sync::Arc;

use glam::{DVec3, Vec2};
use secateur::{ColorChoice, Document, LevelOptions, Opening, Plant, surfaces_to_glb};
use secateur_model::{Filters, Material, Surface, Texture, Wrap};
use secateur_plant::{GrowOptions, Species, grow};

/// A trunk whose bark is bent to a ring in its texture, brown on black.
fn trunk_in_a_ring() -> Vec<u8> {
    const RINGS: u32 = 40;
    const STEPS: u32 = 64;
    const SIDE_PX: u32 = 256;
    let texel = |at: u32| {
        let [x, y] = [at % SIDE_PX, at / SIDE_PX].map(|k| (f64::from(k) + 0.5) / 256.0 - 0.5);
        match (0.2465..0.485).contains(&x.hypot(y)) {
            true => [120, 80, 50, 255],
            false => [0, 0, 0, 255],
        }
    };
    let oak = grow(Species::Oak, &GrowOptions { leaves: 1, seed: 1 }).unwrap();
    let mut material = Material::clone(&oak.wood.material);
    material.texture = Some(Arc::new(Texture {
        width: SIDE_PX,
        height: SIDE_PX,
        rgba: (0..SIDE_PX * SIDE_PX).flat_map(texel).collect(),
        wrap: [Wrap::Repeat; 2],
        filters: Filters::default(),
    }));
    let mut trunk = Surface::empty(Arc::new(material));
    for (ring, step) in (0..=RINGS).flat_map(|ring| (0..=STEPS).map(move |step| (ring, step))) {
        let up = f64::from(ring) / f64::from(RINGS);
        let around = f64::from(step % STEPS) / f64::from(STEPS) * std::f64::consts::TAU;
        let [x, z] = [around.cos(), around.sin()];
        trunk.normals.push(DVec3::new(x, 0.0, z).as_vec3());
        let thickness = 1.0 - 0.4 * up;
        trunk
            .positions
            .push(DVec3::new(thickness * x, 6.0 * up, thickness * z));
        let from_middle = 0.25 + 0.23 * up;
        let [u, v] = [x, z].map(|at| (0.5 + from_middle * at) as f32);
        trunk.uvs.push(Vec2::new(u, v));
    }
    for (ring, step) in (0..RINGS).flat_map(|ring| (0..STEPS).map(move |step| (ring, step))) {
        let at = |ring: u32, step: u32| ring * (STEPS + 1) + step;
        let [a, b] = [step, step + 1].map(|step| at(ring, step));
        let [c, d] = [step, step + 1].map(|step| at(ring + 1, step));
        trunk.triangles.extend([[a, c, b], [b, c, d]]);
    }
    surfaces_to_glb("trunk", &[(trunk, false)])
}

/// The share of points, evenly over the texture coordinates of each triangle, at which a file shows black.
fn black(glb: Vec<u8>) -> f64 {
    const STEPS: u32 = 12;
    let document = Document::from_bytes("trunk.glb", glb, None).unwrap();
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

/// The foot of a trunk with few corners cuts across what is black: what lies there is as what is near.
#[test]
fn a_level_shows_nothing_of_what_lies_between_charts() {
    let plant = Plant::from_bytes("trunk.glb", trunk_in_a_ring(), &Opening::default()).unwrap();
    let level = |colors| {
        let options = LevelOptions {
            colors,
            ..LevelOptions::triangles(0.003)
        };
        black(plant.level(&options).unwrap().to_bytes().unwrap())
    };
    let [as_it_was, filled] = [ColorChoice::Keep, ColorChoice::default()].map(level);
    assert!(as_it_was > 0.03 && filled == 0.0, "{as_it_was} {filled}");
    assert_eq!(black(trunk_in_a_ring()), 0.0);
}
