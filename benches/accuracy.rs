//! What simplification loses, over the held-out views: `cargo bench --bench
//! accuracy`. Leaves as solid cards, as the figures of the project have it; and
//! the oak with its cut-outs, by what keeps its crown from getting dense.

mod rows;

use std::ops::ControlFlow;

use rows::{Row, Rows, shared_tree};
use secateur_eval::{Judging, measure_lod};
use secateur_gltf::Tree;
use secateur_model::{Foliage, Lod};
use secateur_plant::{EllipsoidCrown, ellipsoid_crown};
use secateur_raster::{CpuRasteriser, ViewSet};
use secateur_simplify::vds::{Progress, Reference, Resize, VdsOptions, VdsRun, fast};

fn main() {
    let mut rows = Rows::create("accuracy");
    let mut cases: Vec<(String, Foliage, u32)> = Vec::new();
    for name in [
        "ez_oak_20k",
        "ez_bush2",
        "quat_commontree_1",
        "sap_birch_hex_9k",
        "sap_pine_needles_48k",
    ] {
        if let Some(path) = shared_tree(&format!("{name}.glb")) {
            let tree = Tree::open(&path, &[]).expect("the tree loads");
            let foliage = tree.foliage().without_cutouts();
            let resolution = automatic(&foliage);
            if name == "ez_oak_20k" && resolution != 256 {
                cases.push((name.to_owned(), foliage.clone(), 256));
            }
            cases.push((name.to_owned(), foliage, resolution));
        }
    }
    let crown = ellipsoid_crown(20_376, 1, &EllipsoidCrown::default()).expect("a crown");
    let resolution = automatic(&crown);
    cases.push(("crown_20376".to_owned(), crown, resolution));
    for (name, foliage, resolution) in &cases {
        judge(&mut rows, name, foliage, &defaults(foliage, *resolution));
    }
    if let Some((name, foliage, _)) = cases.first().filter(|(name, ..)| name == "ez_oak_20k") {
        let job = shared(&defaults(foliage, 256), None);
        judge(&mut rows, &format!("{name} by {SHARED}"), foliage, &job);
    }
    if let Some(path) = shared_tree("ez_oak_20k.glb") {
        let tree = Tree::open(&path, &[]).expect("the tree loads");
        let foliage = tree.foliage();
        for resolution in [256, 512] {
            let plain = defaults(foliage, resolution);
            let mut literal = plain.clone();
            literal.options.resize = Resize::Literal;
            let mut kept = plain.clone();
            kept.options.max_coverage = Some(1.0);
            for (by, job) in [
                ("defaults", plain.clone()),
                ("literal", literal),
                ("defaults, max coverage 1", kept),
                (SHARED, shared(&plain, None)),
                (SHARED_KEPT, shared(&plain, Some(1.0))),
            ] {
                judge(
                    &mut rows,
                    &format!("ez_oak_20k with cut-outs by {by}"),
                    foliage,
                    &job,
                );
            }
        }
    }
}

/// `--reference previous --resize deficit --neighbours 4`.
const SHARED: &str = "previous, deficit, 4 neighbours";

const SHARED_KEPT: &str = "previous, deficit, 4 neighbours, max coverage 1";

fn shared(plain: &VdsRun, max_coverage: Option<f64>) -> VdsRun {
    VdsRun {
        options: VdsOptions {
            reference: Reference::Previous,
            resize: Resize::Deficit,
            neighbours: 4,
            max_coverage,
            ..plain.options
        },
        ..plain.clone()
    }
}

fn defaults(foliage: &Foliage, resolution: u32) -> VdsRun {
    let views = ViewSet::dodecahedron(foliage.bounding_sphere().expect("leaves"));
    VdsRun::to_leaves(views, resolution, foliage.leaves().len() as u64 / 10)
}

fn automatic(foliage: &Foliage) -> u32 {
    let views = ViewSet::dodecahedron(foliage.bounding_sphere().expect("leaves"));
    let chosen = secateur_simplify::resolution::choose(foliage, &views, &CpuRasteriser);
    chosen.expect("the CPU does not fail").resolution
}

fn judge(rows: &mut Rows, name: &str, foliage: &Foliage, job: &VdsRun) {
    let leaves = foliage.leaves().len();
    let resolution = job.resolution;
    let go_on = &mut |_: Progress| ControlFlow::Continue(());
    let outcome = fast::simplify(foliage, job, &CpuRasteriser, go_on).expect("a run");
    let judging = Judging::held_out(foliage).expect("leaves");
    for percent in [50, 25, 10] {
        let lod = Lod::after(&outcome.order, leaves - leaves * percent / 100);
        let measured = measure_lod(foliage, &lod, &judging).expect("a measurement");
        let case = format!("{name} to {percent} % at {resolution}");
        for (quantity, unit, value) in [
            ("vmi_error", "%", measured.vmi_error_percent()),
            ("silhouette_iou", "", measured.silhouette_iou()),
            ("coverage_ratio", "", measured.coverage_ratio()),
            ("max_area_scale", "", lod.max_area_scale()),
        ] {
            rows.add(&Row {
                case: &case,
                quantity,
                unit,
                value,
                repeat: 0,
                adapter: "cpu",
                command: "cargo bench --bench accuracy",
            });
        }
    }
}
