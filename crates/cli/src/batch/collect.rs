//! `batch collect`: what became of a batch, failures first.

use std::collections::HashSet;
use std::fmt::Write as _;
use std::fs;
use std::path::{Path, PathBuf};

use secateur::StagedFiles;
use serde_json::{Value, json};

use super::super::args;
use super::super::failure::Failure;
use super::super::output;
use super::super::print::{Printed, Records};
use super::Item;
use super::run::{PICTURE, RECORD};

/// Writes the lines and the page of a batch.
pub(super) fn run(args: &args::BatchCollect) -> Result<Printed, Failure> {
    let [lines, page] = ["jsonl", "html"].map(|ending| {
        let mut name = args.output.clone().into_os_string();
        name.push(format!(".{ending}"));
        PathBuf::from(name)
    });
    for file in [&lines, &page] {
        output::check_file(file, &[])?;
    }
    let (mut failed, mut done) = records(&args.folder)?;
    if let Some(plan) = &args.plan {
        failed.extend(missing(plan, &failed, &done)?);
    }
    for records in [&mut failed, &mut done] {
        records.sort_by_key(|record| record["input"].to_string());
    }
    let counts = [failed.len(), done.len()];
    let html = html(&args.folder, &failed, &done);
    let records = Records::Lines(failed.into_iter().chain(done).collect());
    let mut staged = StagedFiles::new();
    output::stage(&mut staged, &lines, records.as_text().as_bytes())?;
    output::stage(&mut staged, &page, html.as_bytes())?;
    staged.commit()?;
    let summary = json!({ "failed": counts[0], "done": counts[1], "report": lines, "page": page });
    let pretty = format!(
        "{} of {} failed; {} and {} say all\n",
        counts[0],
        counts[0] + counts[1],
        lines.display(),
        page.display()
    );
    Ok(Printed {
        some_failed: counts[0] > 0,
        ..Printed::single(pretty, summary)
    })
}

/// The records of what could not be done, and of what was done.
fn records(folder: &Path) -> Result<(Vec<Value>, Vec<Value>), Failure> {
    let cannot = |e: &std::io::Error| Failure::of_file(folder, "cannot be read", e);
    let (mut failed, mut done) = (Vec::new(), Vec::new());
    for entry in fs::read_dir(folder).map_err(|e| cannot(&e))? {
        let entry = entry.map_err(|e| cannot(&e))?;
        let name = entry.file_name().to_string_lossy().into_owned();
        let read =
            |path: PathBuf| -> Option<Value> { serde_json::from_slice(&fs::read(path).ok()?).ok() };
        if name.ends_with(".failed.json") {
            failed.extend(read(entry.path()));
        } else if !name.starts_with('.') {
            done.extend(read(entry.path().join(RECORD)));
        }
    }
    let keys: HashSet<String> = done
        .iter()
        .map(|record| record["key"].to_string())
        .collect();
    failed.retain(|record| !keys.contains(&record["key"].to_string()));
    Ok((failed, done))
}

/// Records of items of which nothing is there.
fn missing(plan: &Path, failed: &[Value], done: &[Value]) -> Result<Vec<Value>, Failure> {
    let text =
        fs::read_to_string(plan).map_err(|e| Failure::of_file(plan, "cannot be read", &e))?;
    let known: HashSet<&str> = failed
        .iter()
        .chain(done)
        .filter_map(|record| record["key"].as_str())
        .collect();
    let items = text.lines().filter(|line| !line.trim().is_empty());
    let items = items.map(Item::parsed).collect::<Result<Vec<Item>, _>>()?;
    let missing = items.into_iter().filter(|item| !known.contains(&*item.key));
    Ok(missing
        .map(|item| json!({ "input": item.input, "key": item.key, "error": "was not done yet" }))
        .collect())
}

/// The page: a row for each plant, with its picture.
fn html(folder: &Path, failed: &[Value], done: &[Value]) -> String {
    let mut text = format!(
        "<!doctype html>\n<meta charset=utf-8>\n<title>Batch {}</title>\n<style>body{{font:15px sans-serif;margin:2em}}\
         table{{border-collapse:collapse}}td,th{{padding:.3em .8em;border-top:1px solid #ccc;text-align:left}}\
         .failed td{{background:#fdd}}img{{max-height:230px}}</style>\n<h1>{} failed, {} done</h1>\n<table>\n\
         <tr><th>plant<th>triangles<th>levels\n",
        escaped(&folder.display().to_string()),
        failed.len(),
        done.len()
    );
    for record in failed {
        let _ = writeln!(
            text,
            "<tr class=failed><td>{}<td colspan=2>{}",
            cell(&record["input"]),
            cell(&record["error"])
        );
    }
    for record in done {
        let levels = record["levels"].as_array();
        let of = |level: &Value| {
            let difference = level["difference"].as_f64().unwrap_or_default();
            format!("{} ({difference:.2})", cell(&level["triangles"]))
        };
        let levels: Vec<String> = levels.into_iter().flatten().map(of).collect();
        let picture = folder
            .join(record["key"].as_str().unwrap_or_default())
            .join(PICTURE);
        let picture = std::path::absolute(&picture).unwrap_or(picture);
        let _ = writeln!(
            text,
            "<tr><td>{}<td>{}<td>{}<br><img loading=lazy alt=levels src=\"{}\">",
            cell(&record["input"]),
            cell(&record["triangles"]["original"]),
            levels.join(", "),
            escaped(&picture.display().to_string())
        );
    }
    text + "</table>\n"
}

fn cell(value: &Value) -> String {
    match value {
        Value::String(text) => escaped(text),
        other => escaped(&other.to_string()),
    }
}

fn escaped(text: &str) -> String {
    let text = text.replace('&', "&amp;").replace('<', "&lt;");
    text.replace('"', "&quot;")
}
