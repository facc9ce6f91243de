//! What a person reads of a chain.

use secateur_gltf::WholeTree;
use secateur_gltf::chain::WrittenChain;
use secateur_scene::chain::Chain;

use super::super::args;
use super::super::summary::{columns, grouped, size};
use super::job::Job;

pub(super) fn pretty(
    tree: &WholeTree,
    job: &Job<'_>,
    args: &args::Lods,
    made: &Chain,
    written: &WrittenChain,
    seconds: f64,
) -> String {
    let heads = [
        "",
        "triangles",
        "leaves",
        "wood",
        "from",
        "pixels high",
        "difference",
        "covers",
        "textures",
    ];
    let mut rows = vec![heads.map(str::to_owned).to_vec()];
    rows.push(vec![
        "original".to_owned(),
        grouped(tree.items().foliage().triangles().len() as u64),
        grouped(tree.leaves().triangles().len() as u64),
        grouped(tree.wood().triangles().len() as u64),
        String::new(),
        String::new(),
        String::new(),
        String::new(),
        String::new(),
    ]);
    for (k, level) in made.levels.iter().enumerate() {
        rows.push(vec![
            format!("LOD{k}"),
            grouped(level.triangles()),
            grouped(level.foliage_triangles),
            grouped(level.wood_triangles),
            format!("{:.1} m", level.distance),
            match level.pixels_high.is_finite() {
                true => format!("{:.0}", level.pixels_high),
                false => String::new(),
            },
            format!("{:.2}", level.difference.difference),
            level.as_drawn.map_or_else(String::new, |seen| {
                let [begin, end] = [seen.begin, seen.end].map(|shown| shown.coverage_over_truth);
                format!("{begin:.2} to {end:.2}")
            }),
            size(level.texture_bytes),
        ]);
    }
    let mut text = format!("{} -> {}\n", job.tree.display(), args.output.display());
    text += &columns(&rows);
    let mut say = |name: &str, what: String| text += &format!("  {name:<9}  {what}\n");
    for file in &written.files {
        say("wrote", file.display().to_string());
    }
    if let Some(file) = &args.preview {
        say("look", format!("open {} in a browser", file.display()));
    }
    say(
        "cost",
        format!("{seconds:.2} s, {} in all", size(written.bytes)),
    );
    for note in made.notes.iter().chain(&written.notes) {
        say("note", note.clone());
    }
    text
}
