//! What a person reads of levels.

use secateur_gltf::chain::WrittenChain;
use secateur_levels::chain::{Chain, LevelReport};

use super::super::args;
use super::super::summary::{columns, grouped, percent, size};
use super::job::Job;

/// A column of tables of levels.
pub(crate) struct Column {
    head: &'static str,
    cell: fn(&LevelReport) -> String,
    /// Whether the original has a figure there, too.
    is_of_original: bool,
}

impl Column {
    const fn new(head: &'static str, cell: fn(&LevelReport) -> String) -> Self {
        Self {
            head,
            cell,
            is_of_original: false,
        }
    }

    const fn of_original(head: &'static str, cell: fn(&LevelReport) -> String) -> Self {
        Self {
            is_of_original: true,
            ..Self::new(head, cell)
        }
    }
}

const DIFFERENCE: Column = Column::new("difference", |of| {
    format!("{:.2}", of.difference.difference)
});
const TEXTURES: Column = Column::new("textures", |of| size(of.texture_bytes));

/// Triangles of a level, of its leaves and of its wood.
const COUNTS: [Column; 3] = [
    Column::of_original("triangles", |of| grouped(of.triangles)),
    Column::of_original("leaves", |of| grouped(of.foliage_triangles)),
    Column::of_original("wood", |of| grouped(of.wood_triangles)),
];

/// The columns of `lods`.
const OF_LODS: [Column; 5] = [
    Column::new("from", |of| format!("{:.1} m", of.distance)),
    Column::new("pixels high", |of| match of.pixels_high.is_finite() {
        true => format!("{:.0}", of.pixels_high),
        false => String::new(),
    }),
    DIFFERENCE,
    Column::new("covers", |of| {
        of.as_drawn.map_or_else(String::new, |seen| {
            let [begin, end] = [seen.begin, seen.end].map(|shown| shown.coverage_over_truth);
            format!("{begin:.2} to {end:.2}")
        })
    }),
    TEXTURES,
];

/// The columns of `demo`.
pub(crate) const OF_DEMO: [Column; 4] = [
    DIFFERENCE,
    Column::new("outline IoU", |of| {
        of.silhouette_iou
            .map_or_else(String::new, |iou| format!("{iou:.3}"))
    }),
    Column::new("VMI error", |of| {
        of.vmi_error_percent.map_or_else(String::new, percent)
    }),
    TEXTURES,
];

/// A table of an original and levels with their names: their triangles, then these columns.
pub(crate) fn table<'a>(
    more: &[Column],
    original: &LevelReport,
    levels: impl Iterator<Item = (String, &'a LevelReport)>,
) -> String {
    let all = || COUNTS.iter().chain(more);
    let heads = all().map(|column| column.head.to_owned());
    let of_original = all().map(|column| match column.is_of_original {
        true => (column.cell)(original),
        false => String::new(),
    });
    let named = |name: String, cells: Vec<String>| [vec![name], cells].concat();
    let mut rows = vec![
        named(String::new(), heads.collect()),
        named("original".to_owned(), of_original.collect()),
    ];
    rows.extend(levels.map(|(name, level)| {
        let cells = all().map(|column| (column.cell)(level));
        named(name, cells.collect())
    }));
    columns(&rows)
}

pub(super) fn pretty(
    original: &LevelReport,
    job: &Job<'_>,
    args: &args::Lods,
    (made, written): (&Chain, &WrittenChain),
    notes: &[String],
    seconds: f64,
) -> String {
    let levels = made.levels.iter().enumerate();
    let named = levels.map(|(k, level)| (format!("LOD{k}"), &level.report));
    let mut text = format!("{} -> {}\n", job.tree.display(), args.output.display());
    text += &table(&OF_LODS, original, named);
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
    for note in notes {
        say("note", note.clone());
    }
    text
}
