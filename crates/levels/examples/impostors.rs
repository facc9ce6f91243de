//! Bakes every impostor of a tree and says how far each looks from it.
//!
//! cargo run --release -p secateur-levels --example impostors -- TREE.glb FOLDER

use std::error::Error;
use std::path::Path;
use std::time::Instant;

use secateur_eval::Judging;
use secateur_eval::pictures::share_of_tight_frame;
use secateur_gltf::WholeTree;
use secateur_levels::impostor::Impostor;
use secateur_levels::impostor::cards::{Cards, Texels};
use secateur_levels::impostor::crossed::Planes;
use secateur_levels::impostor::judge::Judge;
use secateur_model::{Surface, Texture};
use secateur_raster::ViewSet;
use secateur_runtime::Screen;

const HEIGHTS_PX: [f64; 3] = [64.0, 128.0, 256.0];

const CARDS: [usize; 3] = [30, 100, 300];

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments = std::env::args().skip(1);
    let (Some(tree), Some(folder)) = (arguments.next(), arguments.next()) else {
        return Err("usage: impostors TREE.glb FOLDER".into());
    };
    let folder = Path::new(&folder);
    std::fs::create_dir_all(folder)?;
    let tree = WholeTree::open(Path::new(&tree), &[])?;
    let items = tree.items();
    let surfaces = items.document().surfaces(&[])?;
    let surfaces: Vec<Surface> = surfaces.into_iter().map(|(s, _)| s).collect();
    let views = Judging::held_out(items.foliage())?.rigs.swap_remove(0);
    let views = ViewSet::new(views.views().iter().copied().step_by(2).collect());
    let sphere = items.foliage().bounding_sphere().ok_or("nothing to see")?;
    let of_leaves = tree.leaves().bounding_sphere().unwrap_or(sphere);
    let ys = || {
        surfaces
            .iter()
            .flat_map(|s| s.positions.iter().map(|p| p.y))
    };
    let tall = ys().fold(f64::MIN, f64::max) - ys().fold(f64::MAX, f64::min);
    println!("pixels,impostor,atlas,seconds,flip_normal_map,flip_flat,coverage_of_mips");
    for height in HEIGHTS_PX {
        let judge = Judge::new(&views, sphere, tall, Screen::default(), height);
        let judge = judge.with_frame_share(share_of_tight_frame(sphere, of_leaves));
        let original = judge.of_surfaces(&surfaces);
        let mut all: Vec<(String, f64, Impostor)> = Vec::new();
        for planes in Planes::ALL {
            let start = Instant::now();
            if let Some(made) = Impostor::crossed(&surfaces, planes, height) {
                let name = format!("crossed-{}", planes.count());
                all.push((name, start.elapsed().as_secs_f64(), made));
            }
        }
        for count in CARDS {
            let start = Instant::now();
            let cards = Cards::new(&surfaces, count);
            if let Some(made) =
                Impostor::cards(&cards, height, Texels::up_to(f64::INFINITY, height, false))
            {
                let name = format!("cards-{}", cards.count());
                all.push((name, start.elapsed().as_secs_f64(), made));
            }
        }
        let start = Instant::now();
        if let Some(made) = Impostor::octahedral(&surfaces, height) {
            all.push(("octahedral".to_owned(), start.elapsed().as_secs_f64(), made));
        }
        for (name, seconds, made) in &all {
            let pictures = judge.of_impostor(made);
            let bent = judge.flip(&original, &pictures);
            let flat = judge.flip(&original, &judge.of_impostor(&made.flat()));
            let material = &made.surface.material;
            let texture = material.texture.as_deref().ok_or("no texture")?;
            println!(
                "{height},{name},{}x{},{seconds:.2},{bent:.4},{flat:.4},{}",
                texture.width,
                texture.height,
                mips(texture)
            );
            save(texture, &folder.join(format!("{name}-{height}.png")))?;
            if let Some(map) = &material.finish.normal_map {
                save(
                    &map.texture,
                    &folder.join(format!("{name}-{height}-normals.png")),
                )?;
            }
            for (k, (a, b)) in original.images().zip(pictures.images()).enumerate().take(4) {
                a.save(folder.join(format!("original-{height}-{k}.png")))?;
                b.save(folder.join(format!("{name}-{height}-seen-{k}.png")))?;
            }
        }
    }
    Ok(())
}

fn save(texture: &Texture, path: &Path) -> Result<(), Box<dyn Error>> {
    let (width, height) = (texture.width, texture.height);
    let image = image::RgbaImage::from_raw(width, height, texture.rgba.clone());
    Ok(image.ok_or("a broken texture")?.save(path)?)
}

/// The texels of each mip that pass the alpha test, as shares of those of the first.
fn mips(texture: &Texture) -> String {
    let mut alpha: Vec<u8> = texture.rgba.chunks_exact(4).map(|t| t[3]).collect();
    let (mut width, mut height) = (texture.width as usize, texture.height as usize);
    let share =
        |alpha: &[u8]| alpha.iter().filter(|a| **a >= 128).count() as f64 / alpha.len() as f64;
    let first = share(&alpha);
    let mut text = Vec::new();
    while width.min(height) > 8 {
        let (w, h) = (width / 2, height / 2);
        alpha = (0..w * h)
            .map(|at| {
                let first = 2 * (at / w) * width + 2 * (at % w);
                let four = [first, first + 1, first + width, first + width + 1];
                ((four.iter().map(|&k| u32::from(alpha[k])).sum::<u32>() + 2) / 4) as u8
            })
            .collect();
        (width, height) = (w, h);
        text.push(format!("{:.2}", share(&alpha) / first));
    }
    text.join(" ")
}
