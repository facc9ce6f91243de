//! What simplification loses, over the held-out views: `cargo bench --bench
//! accuracy`. Leaves as solid cards, as the figures of the project have it.

mod rows;

use std::ops::ControlFlow;

use rows::{Row, Rows, shared_tree};
use secateur_eval::{Judging, measure_lod};
use secateur_model::gltf::Tree;
use secateur_model::{Foliage, Lod};
use secateur_plant::{EllipsoidCrown, ellipsoid_crown};
use secateur_raster::{CpuRasteriser, ViewSet};
use secateur_simplify::vds::{Progress, VdsOptions, fast};

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
        judge(&mut rows, name, foliage, *resolution);
    }
}

fn automatic(foliage: &Foliage) -> u32 {
    let views = ViewSet::dodecahedron(foliage.bounding_sphere().expect("leaves"));
    let chosen = secateur_simplify::resolution::choose(foliage, &views, &CpuRasteriser);
    chosen.expect("the CPU does not fail").resolution
}

fn judge(rows: &mut Rows, name: &str, foliage: &Foliage, resolution: u32) {
    let views = ViewSet::dodecahedron(foliage.bounding_sphere().expect("leaves"));
    let leaves = foliage.leaves().len();
    let options = VdsOptions::new(views, resolution, leaves / 10);
    let go_on = &mut |_: Progress| ControlFlow::Continue(());
    let outcome = fast::simplify(foliage, &options, &CpuRasteriser, go_on).expect("a run");
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
