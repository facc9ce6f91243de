//! How wood gets coarser: levels of whole plants by pictures.
//!
//! Of each tree the budgets are shares of all triangles. A row is the mean FLIP, SSIM or outline over
//! twelve held-out views of the whole plant, the first of four sets that `secateur measure` judges by;
//! with it the triangles that wood has, and how far leaves and pieces of wood then hang in the air.
//! Times are those of finding the levels of the wood, with drawing it to see how much of it shows;
//! everything else comes out alike from `--profile dev`.
//!
//! `cargo bench --bench wood`, or with parts of names only the trees whose names have one of them:
//! `cargo bench --bench wood -- bush maple`

mod rows;

use std::ops::ControlFlow;
use std::time::Instant;

use rows::{Rows, shared_tree};
use secateur::plant::{GrowOptions, Species, grow};
use secateur::{
    Document, Foliage, OpenEngine, Options, Target, WholePlant, WholeTree, plant_to_glb,
};
use secateur_eval::Judging;
use secateur_eval::pictures::WholePictures;
use secateur_simplify::wood::{leaf_gaps, leaf_wood_gaps, wood_gaps};

const TREES: [&str; 5] = [
    "ez_oak_20k.glb",
    "sap_birch_hex_9k.glb",
    "quat_commontree_1.glb",
    "ez_bush2.glb",
    "sap_pine_needles_48k.glb",
];
/// Species, leaves and seed of grown trees. The oak has about 60,000 triangles of wood.
const GROWN: [(Species, u32, u64); 4] = [
    (Species::Oak, 12_000, 3),
    (Species::Willow, 3_000, 1),
    (Species::Maple, 3_000, 1),
    (Species::Palmetto, 3_000, 1),
];
/// Shares of all triangles, 0 to 1.
const BUDGETS: [f64; 3] = [0.5, 0.25, 0.1];
const COMMAND: &str = "cargo bench --bench wood";

fn main() {
    let mut rows = Rows::create("wood");
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let parts = arguments.iter().filter(|part| !part.starts_with('-'));
    let parts: Vec<&String> = parts.collect();
    let is_out =
        |name: &str| !parts.is_empty() && !parts.iter().any(|part| name.contains(part.as_str()));
    for name in TREES.into_iter().filter(|name| !is_out(name)) {
        if let Some(path) = shared_tree(name) {
            let tree = WholeTree::open(&path, &[]).expect("a tree");
            compare(&mut rows, name, &tree);
        }
    }
    for (species, leaves, seed) in GROWN {
        let plant = grow(species, &GrowOptions { leaves, seed }).expect("a species grows");
        let document = Document::from_bytes("grown.glb", plant_to_glb(&plant), None);
        let tree = document.expect("a plant").into_whole_tree(&[]);
        let name = format!("grown {} {leaves} seed {seed}", plant.name);
        if !is_out(&name) {
            compare(&mut rows, &name, &tree.expect("a tree"));
        }
    }
}

fn compare(rows: &mut Rows, name: &str, tree: &WholeTree) {
    let engine = OpenEngine::cpu();
    let surfaces = tree.items().surfaces().expect("surfaces");
    let surfaces: Vec<_> = surfaces.into_iter().map(|(surface, _)| surface).collect();
    let mut judging = Judging::held_out(tree.leaves()).expect("leaves that can be judged");
    judging.rigs.truncate(1);
    let original = WholePictures::of(&surfaces, &judging.rigs);
    let (leaves, wood) = (tree.leaves(), tree.wood());
    let at_first = hanging(rows, &format!("{name}: as it is"), leaves, wood, None);
    let count = wood.triangles().len() as f64;
    let case = format!("{name}: as it is");
    rows.note(&case, "wood triangles", "", count, COMMAND);
    let mut options = Options::to(Target::triangle_share(1.0));
    options.audit = false;
    let start = Instant::now();
    let items = tree.items().foliage();
    let plant = WholePlant::within(items, leaves, wood, &options, &engine);
    let plant = plant.expect("a plant that can be simplified");
    let seconds = start.elapsed().as_secs_f64();
    rows.note(name, "levels of wood", "s", seconds, COMMAND);
    for budget in BUDGETS {
        options.target = Target::triangle_share(budget);
        let made = plant.simplified(&options, &engine, &mut |_| ControlFlow::Continue(()));
        let made = made.expect("a plant that can be simplified");
        let lod = tree.joined(&made.leaves.lod, &made.wood);
        let glb = tree.items().lod_to_bytes(&lod).expect("a level");
        let document = Document::from_bytes("level.glb", glb, None).expect("a level");
        let drawn = document.surfaces(&[]).expect("surfaces");
        let drawn: Vec<_> = drawn.into_iter().map(|(surface, _)| surface).collect();
        let seen = original.measure(&WholePictures::of(&drawn, &judging.rigs));
        let case = format!("{name}: {budget}");
        let triangles: usize = drawn.iter().map(|s| s.triangles.len()).sum();
        rows.note(&case, "triangles", "", triangles as f64, COMMAND);
        let of_wood = made.wood_triangles as f64;
        rows.note(&case, "wood triangles", "", of_wood, COMMAND);
        for key in ["flip_mean", "ssim"] {
            let value = seen.pictures.overall.get(key).expect("a metric");
            rows.note(&case, key, "", value, COMMAND);
        }
        rows.note(&case, "outline_iou", "", seen.outline_iou[0], COMMAND);
        let [leaves, wood] = [made.leaves.lod.foliage(leaves), made.wood.foliage(wood)];
        hanging(rows, &case, &leaves, &wood, Some(at_first));
    }
}

/// Largest distances, in units of the file: of leaves from wood; of leaves from wood or lower leaves; of
/// pieces from what they grow on.
type Gaps = [f64; 3];

/// The largest distances of what hangs in the air, and how many leaves and pieces are beyond those that
/// a plant had at first.
fn hanging(
    rows: &mut Rows,
    case: &str,
    leaves: &Foliage,
    wood: &Foliage,
    at_first: Option<Gaps>,
) -> Gaps {
    let all = [
        ("leaf gap to wood", leaf_wood_gaps(leaves, wood)),
        ("leaf gap", leaf_gaps(leaves, wood)),
        ("wood gap", wood_gaps(wood)),
    ];
    let mut largest = [0.0; 3];
    for (index, (what, gaps)) in all.into_iter().enumerate() {
        let finite = gaps.iter().copied().filter(|gap| gap.is_finite());
        largest[index] = finite.fold(0.0, f64::max);
        rows.note(
            case,
            &format!("largest {what}"),
            "",
            largest[index],
            COMMAND,
        );
        if let Some(at_first) = at_first {
            // Files have numbers of 32 bits.
            let bound = at_first[index] * (1.0 + 1e-4);
            let beyond = gaps.iter().filter(|gap| **gap > bound).count() as f64;
            rows.note(
                case,
                &format!("beyond the first {what}"),
                "",
                beyond,
                COMMAND,
            );
        }
    }
    largest
}
