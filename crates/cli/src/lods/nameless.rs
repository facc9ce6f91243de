//! What is noted beside levels names no folder of the machine: people pass levels on.

use serde_json::Value;

use super::super::args;
use super::job::Job;

/// What belongs to one call: the next has its own.
const OF_CALL: [&str; 3] = ["run", "seconds", "peak_rss_bytes"];

/// The absolute paths of a call, the longest first, each with what stands for it.
fn stand_ins(args: &args::Lods, job: &Job<'_>) -> Vec<(String, String)> {
    let of_scene = args.scene.files().enumerate();
    let of_scene = of_scene.map(|(k, path)| (format!("{{scene {k}}}"), path.to_owned()));
    let own = [
        ("{output}", Some(&*args.output)),
        ("{input}", Some(job.tree)),
        ("{preview}", args.preview.as_deref()),
    ];
    let own = own
        .into_iter()
        .filter_map(|(name, path)| Some((name.to_owned(), path?.to_owned())));
    let mut all: Vec<(String, String)> = own
        .chain(of_scene)
        .filter(|(_, path)| path.is_absolute())
        .map(|(name, path)| (name, path.display().to_string()))
        .collect();
    all.sort_by_key(|(_, path)| std::cmp::Reverse(path.len()));
    all
}

/// Takes absolute paths out of a record and its text, and what belongs to the call.
pub(super) fn nameless(record: &mut Value, pretty: &mut String, args: &args::Lods, job: &Job<'_>) {
    if let Some(fields) = record.as_object_mut() {
        fields.retain(|name, _| !OF_CALL.contains(&name.as_str()));
    }
    for (stand_in, path) in stand_ins(args, job) {
        for_each_text(record, &mut |text| *text = text.replace(&path, &stand_in));
        *pretty = pretty.replace(&path, &stand_in);
    }
}

/// Puts the paths of this call where [`nameless`] took those of another out.
pub(super) fn named(record: &mut Value, pretty: &mut String, args: &args::Lods, job: &Job<'_>) {
    for (stand_in, path) in stand_ins(args, job) {
        for_each_text(record, &mut |text| *text = text.replace(&stand_in, &path));
        *pretty = pretty.replace(&stand_in, &path);
    }
}

fn for_each_text(value: &mut Value, see: &mut dyn FnMut(&mut String)) {
    match value {
        Value::String(text) => see(text),
        Value::Array(items) => items.iter_mut().for_each(|item| for_each_text(item, see)),
        Value::Object(fields) => fields
            .values_mut()
            .for_each(|field| for_each_text(field, see)),
        Value::Null | Value::Bool(_) | Value::Number(_) => {}
    }
}
