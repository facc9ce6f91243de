//! `batch run`: the levels of one item.

use std::fs;
use std::io::Read;
use std::path::Path;
use std::time::Instant;

use serde_json::{Value, json};

use super::super::args::{self, Common};
use super::super::failure::Failure;
use super::super::print::Printed;
use super::super::record::Record;
use super::super::streams::{is_stream, renamed};
use super::super::{interrupt, lods, output};
use super::Item;

/// The longest item that is read, in bytes.
const MOST_BYTES: u64 = 1 << 20;

/// The record of a result, in its folder.
pub(super) const RECORD: &str = "record.json";

/// The picture of a plant and its levels, in the same folder.
pub(super) const PICTURE: &str = "picture.png";

/// Makes the levels of an item into a folder of its key, unless that is there.
pub(super) fn run(args: &args::BatchRun, common: &Common) -> Result<Printed, Failure> {
    let start = Instant::now();
    let item = Item::parsed(&text(&args.item)?)?;
    let place = item.place();
    let is_done = |record| Printed::single(format!("{}: is done\n", item.input.display()), record);
    if let Some(record) = known(&place) {
        return Ok(is_done(record));
    }
    match made(&item, common, start) {
        Ok(record) => {
            let _ = fs::remove_file(item.failed_file());
            let pretty = format!("{} -> {}\n", item.input.display(), place.display());
            Ok(Printed::single(pretty, record))
        }
        Err(failure) => {
            if let Some(record) = known(&place) {
                // Another worker was given the same item, and was faster.
                return Ok(is_done(record));
            }
            if failure.kind != secateur::ErrorKind::Interrupted {
                let record = lods::FailureRecord::of(&item.input, &failure);
                let seconds = start.elapsed().as_secs_f64();
                let record = with_key(Record::new("batch", record, &[], seconds).to_value(), &item);
                output::write_file(&item.failed_file(), format!("{record}\n").as_bytes())?;
            }
            Err(failure)
        }
    }
}

/// The record of a result that is there.
fn known(place: &Path) -> Option<Value> {
    let text = fs::read(place.join(RECORD)).ok()?;
    serde_json::from_slice(&text).ok()
}

/// Makes all files beside their place, then gives the folder its name.
fn made(item: &Item, common: &Common, start: Instant) -> Result<Value, Failure> {
    if item.key_now()? != item.key {
        return Err(Failure::input(format!(
            "{}: the plant, the options or secateur changed since the item was planned: plan again",
            item.input.display()
        )));
    }
    fs::create_dir_all(&item.output)
        .map_err(|e| Failure::of_file(&item.output, "cannot be made", &e))?;
    let beside = tempfile::Builder::new()
        .prefix(&beginning(item))
        .tempdir_in(&item.output)
        .map_err(|e| Failure::of_file(&item.output, "cannot be written into", &e))?;
    let folder = beside.path().join("made");
    fs::create_dir(&folder).map_err(|e| Failure::of_file(&folder, "cannot be made", &e))?;
    let args = item.args(&folder)?;
    let picture = folder.join(PICTURE);
    let (record, mut files) = lods::made_of_first(&args, common, &picture, start)?;
    let place = item.place();
    let [from, to] = [folder.as_path(), place.as_path()].map(|path| path.display().to_string());
    let record = with_key(renamed(record, &from, &to), item);
    output::stage(
        &mut files,
        &folder.join(RECORD),
        format!("{record:#}\n").as_bytes(),
    )?;
    interrupt::writing()?;
    files.commit()?;
    fs::rename(&folder, &place).map_err(|e| Failure::of_file(&place, "cannot be made", &e))?;
    drop(beside);
    remove_leftovers(item);
    Ok(record)
}

/// How the names of folders begin in which an item is made.
fn beginning(item: &Item) -> String {
    format!(".secateur-{}-", item.key)
}

/// Removes what workers that died left of an item that is done. One that is at it still finds the item done.
fn remove_leftovers(item: &Item) {
    let beginning = beginning(item);
    for entry in fs::read_dir(&item.output).into_iter().flatten().flatten() {
        if entry.file_name().to_string_lossy().starts_with(&beginning) {
            let _ = fs::remove_dir_all(entry.path());
        }
    }
}

fn with_key(mut record: Value, item: &Item) -> Value {
    record["key"] = json!(item.key);
    record
}

/// The item's text: the word itself, a file, or standard input.
fn text(item: &Path) -> Result<String, Failure> {
    let word = item.to_string_lossy();
    if word.trim_start().starts_with('{') {
        return Ok(word.into_owned());
    }
    let mut text = String::new();
    let read = match is_stream(item) {
        true => interrupt::reading(|| std::io::stdin().take(MOST_BYTES).read_to_string(&mut text)),
        false => {
            fs::File::open(item).and_then(|file| file.take(MOST_BYTES).read_to_string(&mut text))
        }
    };
    read.map_err(|e| Failure::of_file(item, "cannot be read", &e))?;
    Ok(text)
}
