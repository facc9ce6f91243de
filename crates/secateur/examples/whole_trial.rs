//! Scratch.
use secateur_eval::{Judging, Pictures};
use secateur_gltf::{Document, WholeTree};
use secateur_model::Surface;
use secateur_raster::OpenEngine;
use secateur_simplify::whole::WholePlant;
use secateur_simplify::{Options, Target};
use std::ops::ControlFlow;
use std::time::Instant;
fn main() {
    let mut args = std::env::args().skip(1);
    let path = args.next().unwrap();
    let shares: Vec<f64> = args
        .next()
        .unwrap()
        .split(',')
        .map(|s| s.parse().unwrap())
        .collect();
    let woods: Vec<f64> = args
        .next()
        .unwrap()
        .split(',')
        .map(|s| s.parse().unwrap())
        .collect();
    let out = args.next();
    let whole = WholeTree::open(path.as_ref(), &[]).unwrap();
    let engine = OpenEngine::cpu();
    let t = Instant::now();
    let plant = WholePlant::new(
        whole.items().foliage(),
        whole.leaves(),
        whole.wood(),
        &engine,
    )
    .unwrap();
    eprintln!("look {:.2}s", t.elapsed().as_secs_f64());
    let judging = Judging::held_out(whole.leaves()).unwrap();
    let surf = |d: &Document| -> Vec<Surface> {
        d.surfaces(&[])
            .unwrap()
            .into_iter()
            .map(|(s, _)| s)
            .collect()
    };
    let original = Pictures::of(&surf(whole.items().document()), &judging.views);
    let all = plant.triangle_count();
    let wt = whole.wood().triangles().len();
    for share in &shares {
        for w in &woods {
            let t = Instant::now();
            let budget = (share * all as f64) as usize;
            let wb = if *w >= 1.0 {
                plant.wood_share(budget, w / 100.0)
            } else {
                ((w * wt as f64) as usize).min(budget)
            };
            let mut o = Options::to(Target::triangles(1));
            o.audit = false;
            let level = plant
                .level(budget, wb, &o, &engine, &mut |_| ControlFlow::Continue(()))
                .unwrap();
            let secs = t.elapsed().as_secs_f64();
            let lod = whole.joined(&level.leaves.lod, &level.wood);
            let bytes = whole.items().lod_to_bytes(&lod).unwrap();
            if let Some(out) = &out {
                std::fs::write(format!("{out}_{share}_{w}.glb"), &bytes).unwrap();
            }
            let doc = Document::from_bytes("x.glb", bytes, None).unwrap();
            let m = original.measure(&Pictures::of(&surf(&doc), &judging.views));
            let left = level.leaves.lod.foliage(whole.leaves());
            let seen = secateur_eval::measure(whole.leaves(), &left, &judging).unwrap();
            println!(
                "{path} all {share} wood {w}: {} + {} tri, flip {:.4} ssim {:.4} leaf-iou {:.3} cov {:.3} {:.1}s",
                left.triangles().len(),
                level.wood_triangles,
                m.overall.get("flip_mean").unwrap(),
                m.overall.get("ssim").unwrap(),
                seen.silhouette_iou(),
                seen.coverage_ratio(),
                secs
            );
        }
    }
}
