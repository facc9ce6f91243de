//! Strips against indexed lists, at each level of a tree: bytes of indices, and what a vertex cache
//! makes of them.
//!
//! GeoTool (Ripolles et al., sections 2.1 and 2.3) keeps every level as triangle strips (LODStrips),
//! since strips name fewer vertices than lists. Here both are made by meshoptimizer, a level at a time: a
//! list that is optimised for the vertex cache, one that is optimised and then made into strips with
//! restarts, and strips of a list that was optimised for them. Levels are those of `vds`; a list can be a
//! prefix of one buffer for all levels, as `PrefixBuffers` has it, and so its bytes are those of the
//! original once; strips cannot. No time is taken: `--profile dev` gives the same figures.
//!
//! `cargo bench --bench strips`

mod rows;

use meshoptimizer_rs::{
    Workspace, analyze_vertex_cache, optimize_vertex_cache, optimize_vertex_cache_strip, stripify,
    unstripify,
};
use rows::{Rows, shared_tree};
use secateur::{Detail, Document, Surface, Tree};
use secateur_simplify::{Options, Resolution, Target, simplify};

const TREES: [&str; 5] = [
    "ez_bush2.glb",
    "ez_oak_20k.glb",
    "quat_commontree_1.glb",
    "sap_birch_hex_9k.glb",
    "sap_pine_needles_48k.glb",
];
/// Shares of the leaves that levels keep, 0 to 1.
const LEVELS: [f64; 4] = [1.0, 0.5, 0.25, 0.1];
const COMMAND: &str = "cargo bench --bench strips";
/// The cache that ACMR and ATVR are of: first in, first out, 16 vertices, as meshoptimizer's own
/// tool has it; and one of a GPU that shades 32 vertices at once.
const CACHES: [(&str, u32, u32, u32); 2] = [("fifo 16", 16, 0, 0), ("warp 32", 32, 32, 32)];

fn main() {
    let mut rows = Rows::create("strips");
    for name in TREES {
        let Some(path) = shared_tree(name) else {
            continue;
        };
        let tree = Tree::open(&path, &[]).expect("a tree");
        let mut options = Options::to(Target::leaf_share(0.1));
        options.resolution = Resolution::Pixels(128);
        let result = simplify(tree.foliage(), &options).expect("a tree that can be simplified");
        let order = result.passes.in_one_order();
        for level in LEVELS {
            let count = tree.foliage().leaves().len();
            let wanted = (level * count as f64).round() as usize;
            let steps = (0..=order.len()).find(|steps| order.leaves_after(*steps) <= wanted);
            let lod = secateur::Lod::after(&order, steps.expect("an order to a tenth"));
            let glb = tree.lod_to_bytes(&lod).expect("a level");
            let document = Document::from_bytes("level.glb", glb, None).expect("a level");
            let surfaces = document.surfaces_with(Detail::Color, &[]);
            let surfaces = surfaces.expect("surfaces");
            for (part, is_foliage) in [("leaves", true), ("wood", false)] {
                // Orders are of leaves: the wood of all levels is the same.
                if !is_foliage && level < 1.0 {
                    continue;
                }
                let of_part = surfaces.iter().filter(|(_, is)| *is == is_foliage);
                let of_part: Vec<&Surface> = of_part.map(|(surface, _)| surface).collect();
                compare(&mut rows, &format!("{name} {level} {part}"), &of_part);
            }
        }
    }
}

/// The indices of a part of a tree in some form.
struct Form {
    name: &'static str,
    /// As they are in the buffer.
    stored: usize,
    bytes: usize,
    /// As a list, in the order in which they are drawn.
    drawn: Vec<Vec<u32>>,
}

impl Form {
    fn new(name: &'static str) -> Self {
        Self {
            name,
            stored: 0,
            bytes: 0,
            drawn: Vec::new(),
        }
    }

    /// 16 bits hold the number of any vertex, and that of a restart, or else 32 do.
    fn add(&mut self, stored: usize, vertices: usize, drawn: Vec<u32>) {
        let bytes = if vertices < 0xffff { 2 } else { 4 };
        self.stored += stored;
        self.bytes += bytes * stored;
        self.drawn.push(drawn);
    }
}

fn compare(rows: &mut Rows, case: &str, surfaces: &[&Surface]) {
    let mut forms = ["list as is", "list", "strips", "strips of a list for them"].map(Form::new);
    let mut space = Workspace::default();
    let mut triangles = 0;
    let mut vertices = Vec::new();
    for surface in surfaces {
        let count = surface.positions.len();
        let indices = surface.triangles.as_flattened();
        if indices.is_empty() {
            continue;
        }
        triangles += surface.triangles.len();
        vertices.push(count);
        forms[0].add(indices.len(), count, indices.to_vec());
        let list = optimize_vertex_cache(indices, count, &mut space).expect("a list");
        let for_strips = optimize_vertex_cache_strip(indices, count, &mut space).expect("a list");
        for (form, of) in [(2, &list), (3, &for_strips)] {
            let strips = stripify(of, count, u32::MAX, &mut space).expect("strips");
            let drawn = unstripify(&strips, u32::MAX, &mut space).expect("a list");
            assert_eq!(drawn.len(), indices.len(), "strips draw every triangle");
            forms[form].add(strips.len(), count, drawn);
        }
        forms[1].add(list.len(), count, list);
    }
    if triangles == 0 {
        return;
    }
    rows.note(case, "triangles", "", triangles as f64, COMMAND);
    for form in &forms {
        let case = format!("{case}: {}", form.name);
        let a_triangle = form.stored as f64 / triangles as f64;
        rows.note(&case, "indices a triangle", "", a_triangle, COMMAND);
        rows.note(&case, "index bytes", "B", form.bytes as f64, COMMAND);
        for (cache, size, warp, group) in CACHES {
            let mut shaded = 0;
            for (drawn, count) in form.drawn.iter().zip(&vertices) {
                let found = analyze_vertex_cache(drawn, *count, size, warp, group, &mut space);
                shaded += u64::from(found.expect("figures").vertices_transformed);
            }
            let acmr = shaded as f64 / triangles as f64;
            let atvr = shaded as f64 / vertices.iter().sum::<usize>() as f64;
            rows.note(&case, &format!("ACMR ({cache})"), "", acmr, COMMAND);
            rows.note(&case, &format!("ATVR ({cache})"), "", atvr, COMMAND);
        }
    }
}
