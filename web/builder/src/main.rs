//! Makes of the compiled engine what browsers and Node load.
//!
//! - `secateur-web-builder wrap ENGINE.wasm no-modules|nodejs|bundler FOLDER`: the engine with its JavaScript and
//!   TypeScript types, as the program `wasm-bindgen` wraps it; this compiles in a fraction of that program's time.
//! - `secateur-web-builder page FOLDER REPOSITORY OUT.html`: the engine that was wrapped into a folder, and the page,
//!   in one file.

use std::env::args;
use std::fs;
use std::io::Write as _;
use std::path::Path;
use std::process::ExitCode;

use anyhow::{Context as _, Result, bail};
use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use flate2::Compression;
use flate2::write::ZlibEncoder;
use wasm_bindgen_cli_support::Bindgen;

/// Scripts of the pages that look at levels, which draw here too.
const OF_PREVIEW: [&str; 7] = [
    "matrices.js",
    "unpack.js",
    "continuous.js",
    "wind.js",
    "renderer.js",
    "orbit.js",
    "levels.js",
];

/// Scripts of this page, in the order in which they build on each other.
const OF_PAGE: [&str; 15] = [
    "words.js",
    "fit.js",
    "leaves.js",
    "decisions.js",
    "engine.js",
    "heat.js",
    "stage.js",
    "panel.js",
    "plants.js",
    "memory.js",
    "any_number.js",
    "lasso.js",
    "choosing.js",
    "controls.js",
    "page.js",
];

fn main() -> ExitCode {
    let arguments: Vec<String> = args().skip(1).collect();
    let arguments: Vec<&str> = arguments.iter().map(String::as_str).collect();
    let done = match arguments[..] {
        ["wrap", engine, target, folder] => wrap(engine, target, folder),
        ["page", folder, repository, output] => page(folder, repository, output),
        _ => {
            eprintln!("usage: wrap ENGINE.wasm TARGET FOLDER, or page FOLDER REPOSITORY OUT.html");
            return ExitCode::from(2);
        }
    };
    match done {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("{error:?}");
            ExitCode::FAILURE
        }
    }
}

fn wrap(engine: &str, target: &str, folder: &str) -> Result<()> {
    let mut bindgen = Bindgen::new();
    bindgen
        .input_path(engine)
        .out_name("secateur")
        .remove_name_section(true)
        .remove_producers_section(true)
        .typescript(true);
    match target {
        "no-modules" => bindgen.no_modules(true)?,
        "nodejs" => bindgen.nodejs(true)?,
        "bundler" => bindgen.bundler(true)?,
        other => bail!("there is no target {other}"),
    };
    bindgen.generate(folder)
}

fn page(folder: &str, repository: &str, output: &str) -> Result<()> {
    let [folder, repository] = [folder, repository].map(Path::new);
    let preview = repository.join("crates/pages/src/preview/page");
    let page = repository.join("web/page");
    let engine = fs::read(folder.join("secateur_bg.wasm")).context("the engine")?;
    let worker = read(&folder.join("secateur.js"))? + &read(&page.join("worker.js"))?;
    let mut script = String::new();
    for file in OF_PREVIEW {
        script += &read(&preview.join(file))?;
    }
    for file in OF_PAGE {
        script += &read(&page.join(file))?;
    }
    let [wind, morph] =
        ["wind", "morph"].map(|name| read(&repository.join(format!("shaders/{name}.glsl"))));
    let (wind, morph) = (wind?, morph?);
    let parts = [
        ("style", read(&page.join("page.css"))?),
        (
            "vertex shader",
            read(&preview.join("tree.vert"))?
                .replace("%%wind%%", &wind)
                .replace("%%morph%%", &morph),
        ),
        ("fragment shader", read(&preview.join("tree.frag"))?),
        ("heat vertex shader", read(&page.join("heat.vert"))?),
        ("heat fragment shader", read(&page.join("heat.frag"))?),
        ("engine", STANDARD.encode(deflated(&engine)?)),
        ("worker", worker),
        ("script", script),
    ];
    let mut html = String::new();
    for (k, piece) in read(&page.join("page.html"))?.split("%%").enumerate() {
        if k % 2 == 0 {
            html.push_str(piece);
            continue;
        }
        let part = parts.iter().find(|(name, _)| *name == piece);
        let (_, text) = part.with_context(|| format!("the page has no part {piece}"))?;
        // Nothing within a script may end it.
        if text.contains("</script") {
            bail!("{piece} would end its element");
        }
        html.push_str(text);
    }
    fs::write(output, html).with_context(|| output.to_owned())
}

fn read(path: &Path) -> Result<String> {
    fs::read_to_string(path).with_context(|| path.display().to_string())
}

/// In zlib's format, which browsers call `deflate`.
fn deflated(bytes: &[u8]) -> Result<Vec<u8>> {
    let mut encoder = ZlibEncoder::new(Vec::new(), Compression::best());
    encoder.write_all(bytes)?;
    Ok(encoder.finish()?)
}
