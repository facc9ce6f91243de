//! Runs `secateur stream`: writes a plant as a stream, or reads what has arrived of one.

use std::fs::File;
use std::io::Read as _;
use std::path::Path;
use std::sync::Arc;
use std::time::Instant;

use secateur::{
    ChainOptions, Document, LodModel, Method, Options, StagedFiles, Target, Tree, simplify_with,
    surfaces_to_glb,
};
use secateur_gltf::Detail;
use secateur_scene::stream::{Stream, read_stream, stream_page, write_stream};
use serde_json::{Value, json};

use super::args::{self, Common};
use super::failure::Failure;
use super::not_sent::not_sent;
use super::print::Printed;
use super::progress_bar::RunProgress;
use super::simplify::{sentences, share, timed, warn_all};
use super::summary::{columns, grouped, size};
use super::{interrupt, machine, order, output, record};

/// Of the leaves, what the first piece has where nothing else is said.
const FIRST_SHARE: f64 = 0.02;

/// What of a stream a summary shows: the level when this share of its bytes is there.
const SHARES: [f64; 6] = [0.0, 0.1, 0.25, 0.5, 0.75, 1.0];

/// Reads a tree and writes a stream, or the other way round.
pub(crate) fn run(args: &args::Stream, common: &Common) -> Result<Printed, Failure> {
    match args.read {
        true => read(args),
        false => write(args, common),
    }
}

fn write(args: &args::Stream, common: &Common) -> Result<Printed, Failure> {
    let start = Instant::now();
    let mut inputs = vec![args.input.as_path()];
    inputs.extend(args.coarsest.order.as_deref());
    let mut outputs = vec![args.output.as_path()];
    outputs.extend(args.preview.as_deref());
    outputs.extend(args.report.as_deref());
    for path in &outputs {
        output::check_file(path, &inputs)?;
    }
    output::check_distinct(&outputs)?;

    let mut stages = Vec::new();
    let tree = timed(&mut stages, "load", || {
        let document = Document::open_within(&args.input, args.memory.memory)?;
        let document = document.with_vertex_alpha(args.vertex_alpha.vertex_alpha);
        Ok::<_, Failure>(document.into_tree(&args.foliage.foliage)?)
    })?;
    output::check_spares(tree.document(), &outputs)?;
    warn_all(&tree.inspection().warnings);
    let not_sent = not_sent(tree.document().json());
    if !not_sent.is_empty() {
        let names = not_sent.join(", ");
        tracing::warn!(
            "{}: the plant is sent as it stands, without: {names}",
            args.input.display()
        );
    }
    interrupt::check()?;
    let model = timed(&mut stages, "order", || model(args, common, &tree))?;
    let surfaces = timed(&mut stages, "surfaces", || {
        let surfaces = tree.leaf_surfaces(Detail::Full);
        surfaces.map_err(Failure::from)
    })?;
    interrupt::writing()?;
    let name = args.input.file_stem().unwrap_or_default().to_string_lossy();
    let stream = timed(&mut stages, "stream", || {
        write_stream(&name, &surfaces, tree.foliage(), &model)
            .map_err(|error| Failure(format!("{}: {error}", args.input.display())))
    })?;
    let mut staged = StagedFiles::new();
    output::stage(&mut staged, &args.output, &stream.bytes)?;
    if let Some(page) = &args.preview {
        let beside = is_beside(page, &args.output).then(|| args.output.file_name());
        let beside = beside.flatten().map(|name| name.to_string_lossy());
        let html = stream_page(&name, &stream, beside.as_deref());
        output::stage(&mut staged, page, html.as_bytes())?;
    }
    let pieces: Vec<Value> = stream.pieces.iter().map(|piece| json!(piece)).collect();
    let record = json!({
        "input": args.input.display().to_string(),
        "output": args.output.display().to_string(),
        "preview": args.preview.as_ref().map(|page| page.display().to_string()),
        "bytes": { "original": record::bytes_of(&args.input), "final": stream.bytes.len() },
        "leaves": { "original": model.most_leaves(), "first": stream.pieces[0].leaves },
        "triangles": { "original": tree.triangle_count(), "first": stream.pieces[0].triangles },
        "pieces": pieces,
        "not_sent": not_sent,
        "order_sha256": model.order().sha256(),
        "seconds": record::seconds(&stages, start.elapsed().as_secs_f64()),
        "peak_rss_bytes": machine::peak_rss_bytes(),
        "run": record::provenance("stream"),
    });
    record::stage(&mut staged, args.report.as_deref(), &record)?;
    staged.commit()?;
    Ok(Printed {
        pretty: pretty(args, &tree, &stream),
        record,
        rows: pieces,
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
    options.engine = args.engine.into();
    options.memory = tree.memory_left();
    options.audit = false;
    if coarsest.chain {
        options.method = Method::Chain(ChainOptions::default());
        options.skeleton = tree.skeleton()?.map(Arc::new);
    }
    let progress_bar = RunProgress::new(common);
    let result = simplify_with(tree.foliage(), &options, &mut |p| progress_bar.show(p));
    let result = result.map_err(Failure::about(&args.input))?;
    drop(progress_bar);
    warn_all(&sentences(&result));
    let model = LodModel::new(result.passes.in_one_order(), tree.foliage());
    model.map_err(|error| Failure(format!("{}: {error}", args.input.display())))
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
            share(piece.bytes as usize, all as usize),
        ]);
    }
    text += &columns(&rows);
    let pieces = stream.pieces.len();
    text += &format!("  pieces     {pieces}; every prefix from the first one on is a plant\n");
    if let Some(file) = record::bytes_of(&args.input) {
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
    let start = Instant::now();
    let inputs = [args.input.as_path()];
    output::check_glb(&args.output, &inputs)?;
    let mut outputs = vec![args.output.as_path()];
    if let Some(report) = &args.report {
        output::check_file(report, &inputs)?;
        outputs.push(report);
    }
    output::check_distinct(&outputs)?;
    let mut stages = Vec::new();
    let bytes = timed(&mut stages, "load", || first_bytes(&args.input, args.bytes))?;
    let (plant, used) = timed(&mut stages, "read", || {
        read_stream(&bytes).map_err(|error| Failure(format!("{}: {error}", args.input.display())))
    })?;
    interrupt::writing()?;
    let mut staged = StagedFiles::new();
    let glb = timed(&mut stages, "write", || {
        let glb = surfaces_to_glb(plant.name(), &plant.surfaces());
        output::stage(&mut staged, &args.output, &glb)?;
        Ok(glb)
    })?;
    let [leaves, of_leaves] = plant.leaves();
    let [triangles, of_triangles] = plant.triangles();
    let [pieces, of_pieces] = plant.pieces();
    let [steps, of_steps] = plant.steps();
    let record = json!({
        "input": args.input.display().to_string(),
        "output": args.output.display().to_string(),
        "bytes": { "read": bytes.len(), "used": used, "final": glb.len() },
        "leaves": { "original": of_leaves, "final": leaves },
        "triangles": { "original": of_triangles, "final": triangles },
        "pieces": { "all": of_pieces, "read": pieces },
        "steps": { "original": of_steps, "final": steps },
        "order_sha256": plant.order_sha256(),
        "is_whole": plant.is_whole(),
        "seconds": record::seconds(&stages, start.elapsed().as_secs_f64()),
        "peak_rss_bytes": machine::peak_rss_bytes(),
        "run": record::provenance("stream"),
    });
    record::stage(&mut staged, args.report.as_deref(), &record)?;
    staged.commit()?;
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

/// The first bytes of a file, all where no number is said.
fn first_bytes(path: &Path, most: Option<u64>) -> Result<Vec<u8>, Failure> {
    let read = || {
        let mut bytes = Vec::new();
        let file = File::open(path)?;
        file.take(most.unwrap_or(u64::MAX))
            .read_to_end(&mut bytes)?;
        Ok(bytes)
    };
    read().map_err(|e: std::io::Error| Failure::of_file(path, "cannot be read", &e))
}
