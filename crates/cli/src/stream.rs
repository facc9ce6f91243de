//! Runs `secateur stream`: writes a plant as a stream, or reads what has arrived of one.

use std::fs::File;
use std::io::Read as _;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use schemars::JsonSchema;
use secateur::{
    ChainOptions, Counts, Document, LodModel, Memory, Method, OpenEngine, Options, SimplifyError,
    Target, Tree, simplify_on, surfaces_to_glb,
};
use secateur_gltf::{Detail, read_within};
use secateur_pages::stream::{Piece, Stream, not_sent, read_stream, stream_page, write_stream};
use serde::Serialize;
use serde_json::json;

use super::advice::warn_all;
use super::args::{self, Common};
use super::failure::Failure;
use super::output::{self, Outputs};
use super::print::Printed;
use super::progress_bar::RunProgress;
use super::record::{Bytes, bytes_of, shown_if};
use super::summary::{columns, grouped, share, size};
use super::work::Work;
use super::{advice, interrupt, order};

/// Of the leaves, what the first piece has where nothing else is said.
const FIRST_SHARE: f64 = 0.02;

/// What of a stream a summary shows: the level when this share of its bytes is there.
const SHARES: [f64; 6] = [0.0, 0.1, 0.25, 0.5, 0.75, 1.0];

/// A stream that was written.
#[derive(Serialize, JsonSchema)]
pub(crate) struct StreamRecord {
    /// Path of the plant's file as the call gives it.
    input: String,
    /// The stream.
    output: String,
    /// The page that shows the plant as it arrives, if one was asked for.
    preview: Option<String>,
    bytes: Bytes,
    leaves: OfFirst,
    /// Triangles of the whole plant.
    triangles: OfFirst,
    /// Pieces of the stream, the coarsest level first.
    pieces: Vec<Piece>,
    /// What the plant has and the stream has not, by the names of the file format.
    not_sent: Vec<String>,
    order_sha256: String,
}

/// A number of the original and of the first piece.
#[derive(Serialize, JsonSchema)]
struct OfFirst {
    original: u64,
    first: u64,
}

/// The plant of a stream, or of as much as there is of one.
#[derive(Serialize, JsonSchema)]
pub(crate) struct StreamReadRecord {
    /// The stream.
    input: String,
    /// Path of the plant's file as the call gives it.
    output: String,
    bytes: BytesRead,
    leaves: Counts,
    triangles: Counts,
    pieces: PiecesRead,
    steps: Counts,
    order_sha256: String,
    is_whole: bool,
}

/// Bytes that were read, those of whole pieces, and those of the file that was written.
#[derive(Serialize, JsonSchema)]
struct BytesRead {
    read: u64,
    used: u64,
    #[serde(rename = "final")]
    written: u64,
}

/// Pieces of a stream, and how many of them were there.
#[derive(Serialize, JsonSchema)]
struct PiecesRead {
    all: u64,
    read: u64,
}

/// Reads a tree and writes a stream, or the other way round.
pub(crate) fn run(args: &args::Stream, common: &Common) -> Result<Printed, Failure> {
    match args.read {
        true => read(args),
        false => write(args, common),
    }
}

fn write(args: &args::Stream, common: &Common) -> Result<Printed, Failure> {
    let mut work = Work::on("stream");
    let inputs = std::iter::once(&args.input).chain(&args.coarsest.order);
    let outputs = Outputs::beside(inputs.map(PathBuf::as_path))
        .and(&args.output, output::check_file)?
        .maybe(args.preview.as_ref(), output::check_file)?
        .maybe(args.report.as_ref(), output::check_file)?
        .distinct()?;
    let tree = work.timed("load", |_| {
        let memory = args.plant.memory();
        let document = interrupt::reading(|| Document::open_within(&args.input, memory))?;
        let document = document.with_vertex_alpha(args.plant.vertex_alpha());
        let document = document.with_not_plant(args.plant.not_plant())?;
        Ok(document.into_tree(args.plant.selectors())?)
    })?;
    output::check_spares(tree.document(), &outputs)?;
    warn_all(&advice::sentences(&tree.inspection().warnings));
    let not_sent = not_sent(tree.document().json());
    if !not_sent.is_empty() {
        let names = not_sent.join(", ");
        tracing::warn!(
            "{}: the plant is sent as it stands, without: {names}",
            args.input.display()
        );
    }
    interrupt::check()?;
    let model = work.timed("order", |_| model(args, common, &tree))?;
    let surfaces = work.timed("surfaces", |_| Ok(tree.leaf_surfaces(Detail::Full)?))?;
    interrupt::writing()?;
    let name = args.input.file_stem().unwrap_or_default().to_string_lossy();
    let stream = work.timed("stream", |_| {
        write_stream(&name, &surfaces, tree.foliage(), &model)
            .map_err(|error| Failure::input(format!("{}: {error}", args.input.display())))
    })?;
    output::stage(&mut work.files, &args.output, &stream.bytes)?;
    if let Some(page) = &args.preview {
        let beside = is_beside(page, &args.output).then(|| args.output.file_name());
        let beside = beside.flatten().map(|name| name.to_string_lossy());
        let html = stream_page(&name, &stream, beside.as_deref());
        output::stage(&mut work.files, page, html.as_bytes())?;
    }
    let first = stream.pieces[0];
    let record = StreamRecord {
        input: args.input.display().to_string(),
        output: args.output.display().to_string(),
        preview: shown_if(args.preview.as_deref()),
        bytes: Bytes {
            original: bytes_of(&args.input),
            written: stream.bytes.len() as u64,
        },
        leaves: OfFirst {
            original: model.most_leaves() as u64,
            first: first.leaves.into(),
        },
        triangles: OfFirst {
            original: tree.triangle_count(),
            first: first.triangles,
        },
        pieces: stream.pieces.clone(),
        not_sent,
        order_sha256: model.order().sha256(),
    };
    let (record, _) = work.record(record);
    work.finish(args.report.as_deref(), &record)?;
    let rows = stream.pieces.iter().map(|piece| json!(piece)).collect();
    Ok(Printed {
        pretty: pretty(args, &tree, &stream),
        rows,
        ..Printed::single(String::new(), record)
    })
}

/// Whether two files lie in one folder.
fn is_beside(page: &Path, other: &Path) -> bool {
    let folder = |path: &Path| {
        let folder = path.parent().unwrap_or(Path::new(""));
        let folder = if folder.as_os_str().is_empty() {
            Path::new(".")
        } else {
            folder
        };
        std::fs::canonicalize(folder).ok()
    };
    folder(page).is_some_and(|of_page| Some(of_page) == folder(other))
}

/// The order in which leaves go: one that is there already, or that of a run.
fn model(args: &args::Stream, common: &Common, tree: &Tree) -> Result<LodModel, Failure> {
    let coarsest = &args.coarsest;
    let asks_for_a_run = coarsest.chain || coarsest.ratio.is_some() || coarsest.leaves.is_some();
    if coarsest.order.is_some() || (tree.order_base64().is_some() && !asks_for_a_run) {
        return order::read(coarsest.order.as_deref(), tree);
    }
    let target = match (coarsest.leaves, coarsest.ratio) {
        (Some(leaves), _) => Target::leaves(leaves),
        (None, ratio) => Target::leaf_share(ratio.unwrap_or(FIRST_SHARE)),
    };
    let mut options = Options::to(target);
    options.engine = args.engine;
    options.memory = tree.memory_left();
    options.audit = false;
    if coarsest.chain {
        options.method = Method::Chain(ChainOptions::default());
        options.skeleton = tree.skeleton()?.map(Arc::new);
    }
    let progress_bar = RunProgress::new(common, &args.input.display().to_string());
    let engine = OpenEngine::open(options.engine).map_err(SimplifyError::from)?;
    let result = simplify_on(&engine, tree.foliage(), &options, &mut |p| {
        progress_bar.show(p)
    });
    let result = result.map_err(Failure::about(&args.input))?;
    drop(progress_bar);
    warn_all(&advice::of_all_of_run(&result));
    let model = LodModel::new(result.passes.in_one_order(), tree.foliage());
    model.map_err(|error| Failure::input(format!("{}: {error}", args.input.display())))
}

fn pretty(args: &args::Stream, tree: &Tree, stream: &Stream) -> String {
    let all = stream.bytes.len() as u64;
    let mut text = format!("{} -> {}\n", args.input.display(), args.output.display());
    let mut rows = vec![
        ["", "bytes", "leaves", "triangles", ""]
            .map(str::to_owned)
            .to_vec(),
    ];
    let mut shown = usize::MAX;
    for part in SHARES {
        let there = (part * all as f64).round() as u64;
        let whole = stream.pieces.partition_point(|piece| piece.bytes <= there);
        let index = whole.saturating_sub(1);
        if index == shown {
            continue;
        }
        shown = index;
        let piece = stream.pieces[index];
        let named = match index {
            0 => "first piece".to_owned(),
            last if last + 1 == stream.pieces.len() => "all".to_owned(),
            piece => format!("piece {}", piece + 1),
        };
        rows.push(vec![
            named,
            size(piece.bytes),
            grouped(piece.leaves.into()),
            grouped(piece.triangles),
            share(piece.bytes, all),
        ]);
    }
    text += &columns(&rows);
    let pieces = stream.pieces.len();
    text += &format!("  pieces     {pieces}; every prefix from the first one on is a plant\n");
    if let Some(file) = bytes_of(&args.input) {
        text += &format!("  the tree   {} as a file\n", size(file));
    }
    if let Some(page) = &args.preview {
        text += &format!("  page       {}\n", page.display());
    }
    debug_assert_eq!(
        stream.pieces.last().map(|piece| piece.triangles),
        Some(tree.triangle_count())
    );
    text
}

fn read(args: &args::Stream) -> Result<Printed, Failure> {
    let mut work = Work::on("stream");
    Outputs::beside([args.input.as_path()])
        .and(&args.output, output::check_glb)?
        .maybe(args.report.as_ref(), output::check_file)?
        .distinct()?;
    let memory = args.plant.memory();
    let bytes = work.timed("load", |_| {
        interrupt::reading(|| first_bytes(&args.input, args.bytes, memory))
    })?;
    let (plant, used) = work.timed("read", |_| {
        read_stream(&bytes)
            .map_err(|error| Failure::input(format!("{}: {error}", args.input.display())))
    })?;
    interrupt::writing()?;
    let glb = work.timed("write", |files| {
        let glb = surfaces_to_glb(plant.name(), &plant.surfaces());
        output::stage(files, &args.output, &glb)?;
        Ok(glb)
    })?;
    let [leaves, of_leaves] = plant.leaves();
    let [triangles, of_triangles] = plant.triangles();
    let [pieces, of_pieces] = plant.pieces();
    let [steps, of_steps] = plant.steps();
    let record = StreamReadRecord {
        input: args.input.display().to_string(),
        output: args.output.display().to_string(),
        bytes: BytesRead {
            read: bytes.len() as u64,
            used,
            written: glb.len() as u64,
        },
        leaves: Counts::of(of_leaves, leaves),
        triangles: Counts::of(of_triangles, triangles),
        pieces: PiecesRead {
            all: of_pieces.into(),
            read: pieces.into(),
        },
        steps: Counts::of(of_steps, steps),
        order_sha256: plant.order_sha256().to_owned(),
        is_whole: plant.is_whole(),
    };
    let (record, _) = work.record(record);
    work.finish(args.report.as_deref(), &record)?;
    let text = format!(
        "{} -> {}\n  read       {} of {} pieces, {}\n  leaves     {} of {}\n  triangles  {} of {}\n",
        args.input.display(),
        args.output.display(),
        pieces,
        of_pieces,
        size(used),
        grouped(leaves.into()),
        grouped(of_leaves.into()),
        grouped(triangles),
        grouped(of_triangles),
    );
    Ok(Printed::single(text, record))
}

/// The first bytes of a file, all where no number is said; of what has no end no more than `memory` allows.
fn first_bytes(path: &Path, most: Option<u64>, memory: Memory) -> Result<Vec<u8>, Failure> {
    let Some(most) = most else {
        return Ok(read_within(path, memory)?);
    };
    let read = || {
        let mut bytes = Vec::new();
        File::open(path)?.take(most).read_to_end(&mut bytes)?;
        Ok(bytes)
    };
    read().map_err(|e: std::io::Error| Failure::of_file(path, "cannot be read", &e))
}
