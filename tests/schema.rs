//! Records and their schemas.

use serde_json::{Map, Value, json};

use crate::program::Bench;

/// Why a value is not what a schema says, with the place; nothing where it is. Knows the words that schemas of the
/// program have, and takes a key that an object's schema does not name for an error.
fn fault(value: &Value, schema: &Value, root: &Value, at: &str) -> Option<String> {
    let Some(schema) = schema.as_object() else {
        return (schema == &json!(false)).then(|| format!("{at}: nothing may be here"));
    };
    let schema = &resolved(schema, root);
    if let Some(types) = schema.get("type") {
        let is_one = |name: &Value| is_of_type(value, name.as_str().unwrap());
        let is_right = match types {
            Value::Array(names) => names.iter().any(is_one),
            name => is_one(name),
        };
        if !is_right {
            return Some(format!("{at}: {value} is not {types}"));
        }
    }
    if let Some(all) = schema.get("enum").and_then(Value::as_array)
        && !all.contains(value)
    {
        return Some(format!("{at}: {value} is none of {all:?}"));
    }
    if schema.get("const").is_some_and(|only| only != value) {
        return Some(format!("{at}: {value} is another word"));
    }
    if let Value::Object(entries) = value {
        for key in schema
            .get("required")
            .and_then(Value::as_array)
            .into_iter()
            .flatten()
        {
            if !entries.contains_key(key.as_str().unwrap()) {
                return Some(format!("{at}: has no {key}"));
            }
        }
        let named = named_keys(schema, root);
        for (key, value) in entries {
            let at = format!("{at}.{key}");
            match (named.get(key), rest(schema)) {
                (Some(schema), _) | (None, Some(schema)) => {
                    if let Some(fault) = fault(value, schema, root, &at) {
                        return Some(fault);
                    }
                }
                // Branches name their own.
                (None, None) if !schema.contains_key("properties") => {}
                (None, None) => return Some(format!("{at}: no schema names it")),
            }
        }
    }
    if let (Value::Array(items), Some(of_items)) = (value, schema.get("items")) {
        let faults = items.iter().enumerate();
        let mut faults =
            faults.filter_map(|(k, item)| fault(item, of_items, root, &format!("{at}[{k}]")));
        if let Some(fault) = faults.next() {
            return Some(fault);
        }
    }
    for word in ["anyOf", "oneOf"] {
        if let Some(branches) = schema.get(word).and_then(Value::as_array) {
            let faults = branches.iter().map(|branch| {
                let mut branch = branch.clone();
                // A branch beside other keys of an object names its own alone.
                if schema.contains_key("properties")
                    && let Some(branch) = branch.as_object_mut()
                {
                    branch.insert("additionalProperties".to_owned(), json!(true));
                }
                fault(value, &branch, root, at)
            });
            let faults: Vec<Option<String>> = faults.collect();
            if faults.iter().all(Option::is_some) {
                return faults.into_iter().next().flatten();
            }
        }
    }
    None
}

/// A schema with what its `$ref` refers to.
fn resolved(schema: &Map<String, Value>, root: &Value) -> Map<String, Value> {
    let Some(place) = schema.get("$ref").and_then(Value::as_str) else {
        return schema.clone();
    };
    let target = root.pointer(place.trim_start_matches('#'));
    let target = target.unwrap_or_else(|| panic!("{place} is not there"));
    let mut all = target.as_object().unwrap().clone();
    all.extend(
        schema
            .clone()
            .into_iter()
            .filter(|(word, _)| word != "$ref"),
    );
    all
}

fn is_of_type(value: &Value, name: &str) -> bool {
    match name {
        "object" => value.is_object(),
        "array" => value.is_array(),
        "string" => value.is_string(),
        "integer" => value.is_u64() || value.is_i64(),
        "number" => value.is_number(),
        "boolean" => value.is_boolean(),
        "null" => value.is_null(),
        other => panic!("{other} is no type"),
    }
}

/// The keys that a schema names, those of its branches too.
fn named_keys(schema: &Map<String, Value>, root: &Value) -> Map<String, Value> {
    let mut keys = Map::new();
    for word in ["anyOf", "oneOf", "allOf"] {
        for branch in schema
            .get(word)
            .and_then(Value::as_array)
            .into_iter()
            .flatten()
        {
            let branch = resolved(branch.as_object().unwrap(), root);
            keys.extend(named_keys(&branch, root));
        }
    }
    let own = schema.get("properties").and_then(Value::as_object);
    keys.extend(own.cloned().unwrap_or_default());
    keys
}

/// What keys may hold that a schema does not name, if there may be any.
fn rest(schema: &Map<String, Value>) -> Option<&Value> {
    schema
        .get("additionalProperties")
        .filter(|rest| *rest != &json!(false))
}

/// A record without keys or values that its schema does not have.
pub(crate) fn checked(bench: &Bench, name: &str, record: &Value) {
    let schema = bench.run(&["schema", name]).succeeded().stdout;
    let schema: Value = serde_json::from_str(&schema).unwrap();
    assert_eq!(
        schema["$schema"],
        "https://json-schema.org/draft/2020-12/schema"
    );
    assert_eq!(fault(record, &schema, &schema, name), None);
    let entries = record.as_object().unwrap();
    let first = entries.iter().next().unwrap();
    assert_eq!(
        (first.0.as_str(), first.1),
        ("schema_version", &json!(1)),
        "{name}"
    );
    // The check itself: a key too many, and one too few.
    let mut more = entries.clone();
    more.insert("colour".to_owned(), json!("green"));
    assert!(
        fault(&json!(more), &schema, &schema, name).is_some(),
        "{name}"
    );
    let mut fewer = entries.clone();
    fewer.remove("schema_version");
    assert!(
        fault(&json!(fewer), &schema, &schema, name).is_some(),
        "{name}"
    );
}

fn lines(text: &[u8]) -> Vec<Value> {
    let text = str::from_utf8(text).unwrap();
    text.lines()
        .map(|line| serde_json::from_str(line).unwrap())
        .collect()
}

#[test]
fn all_records_are_listed() {
    let bench = Bench::new();
    let listed = bench.run(&["schema"]).succeeded().stdout;
    for name in ["inspect", "lods", "simplify", "stream-read", "study-row"] {
        assert!(listed.contains(name), "{listed}");
    }
    let as_json = bench
        .run(&["schema", "--format", "json"])
        .succeeded()
        .stdout;
    let all: Value = serde_json::from_str(&as_json).unwrap();
    for one in all.as_array().unwrap() {
        bench
            .run(&["schema", one["name"].as_str().unwrap()])
            .succeeded();
    }
    assert_eq!(bench.run(&["schema", "nothing"]).code, Some(2));
}

#[test]
fn records_of_one_level_are_what_their_schemas_say() {
    let bench = Bench::new();
    let target = [
        "simplify",
        "oak.glb",
        "-o",
        "out.glb",
        "--triangles",
        "0.4",
        "--report",
        "s.json",
    ];
    bench.run(&target).succeeded();
    checked(&bench, "simplify", &bench.json("s.json"));
    let few = [
        "simplify",
        "oak.glb",
        "-o",
        "few.glb",
        "--leaves",
        "200",
        "--method",
        "stochastic",
        "--report",
        "f.json",
        "--order",
        "o",
    ];
    bench.run(&few).succeeded();
    checked(&bench, "simplify", &bench.json("f.json"));
    let lod = [
        "lod", "oak.glb", "-o", "l.glb", "--order", "o", "--steps", "3", "--report", "l.json",
    ];
    bench.run(&lod).succeeded();
    checked(&bench, "lod", &bench.json("l.json"));
    bench
        .run(&["inspect", "oak.glb", "--report", "i.json"])
        .succeeded();
    checked(&bench, "inspect", &bench.json("i.json"));
    let measure = [
        "measure",
        "oak.glb",
        "out.glb",
        "--as-drawn",
        "64",
        "--report",
        "m.json",
    ];
    bench.run(&measure).succeeded();
    checked(&bench, "measure", &bench.json("m.json"));
    let grow = [
        "grow", "birch", "-o", "b.glb", "--leaves", "90", "--report", "g.json",
    ];
    bench.run(&grow).succeeded();
    checked(&bench, "grow", &bench.json("g.json"));
    bench
        .run(&[&grow[..], &["--lod", "0.5"]].concat())
        .succeeded();
    checked(&bench, "grow", &bench.json("g.json"));
    let write = [
        "stream", "oak.glb", "-o", "o.stream", "--order", "o", "--report", "w.json",
    ];
    bench.run(&write).succeeded();
    checked(&bench, "stream", &bench.json("w.json"));
    let read = [
        "stream", "o.stream", "-o", "r.glb", "--read", "--report", "r.json",
    ];
    bench.run(&read).succeeded();
    checked(&bench, "stream-read", &bench.json("r.json"));
}

/// One tree and two: a record each, one a line, of one shape.
#[test]
fn records_of_levels_are_what_their_schema_says() {
    let bench = Bench::for_small_screen();
    std::fs::copy(bench.path("oak.glb"), bench.path("ash.glb")).unwrap();
    let more = [
        "--effort=fast",
        "--levels",
        "0.3",
        "--impostor",
        "crossed",
        "--format",
        "json",
    ];
    let keys =
        |record: &Value| -> Vec<String> { record.as_object().unwrap().keys().cloned().collect() };
    let mut shapes = Vec::new();
    for (trees, folder) in [(&["oak.glb"][..], "one"), (&["oak.glb", "ash.glb"], "two")] {
        let out = ["-o", folder, "--report", "r.json"];
        let ran = bench
            .run(&[&["lods"], trees, &out, &more].concat())
            .succeeded();
        assert_eq!(ran.stdout.as_bytes(), bench.read("r.json"));
        let records = lines(ran.stdout.as_bytes());
        assert_eq!(records.len(), trees.len());
        for record in &records {
            checked(&bench, "lods", record);
            shapes.push(keys(record));
        }
    }
    assert!(shapes.iter().all(|shape| *shape == shapes[0]), "{shapes:?}");
    let one_file = ["lods", "oak.glb", "-o", "all.glb", "--levels", "0.3"];
    let ran = bench
        .run(&[&one_file[..], &["--format", "json"]].concat())
        .succeeded();
    checked(&bench, "lods", &lines(ran.stdout.as_bytes())[0]);
    // What is kept is said in the same shape.
    let again = ["lods", "oak.glb", "-o", "one", "--report", "k.json"];
    bench.run(&[&again[..], &more].concat()).succeeded();
    let kept = &lines(&bench.read("k.json"))[0];
    assert_eq!(kept["kept"], true);
    checked(&bench, "lods", kept);
}

#[test]
fn records_of_many_runs_are_what_their_schemas_say() {
    let bench = Bench::new();
    bench
        .run(&["demo", "-o", "demo", "--leaves", "150"])
        .succeeded();
    checked(&bench, "demo", &bench.json("demo/report.json"));
    let study = [
        "study",
        "oak.glb",
        "-o",
        "s",
        "--case",
        "stochastic",
        "--levels",
        "0.5",
    ];
    let ran = bench
        .run(&[&study[..], &["--format", "json"]].concat())
        .succeeded();
    checked(&bench, "study", &serde_json::from_str(&ran.stdout).unwrap());
    for row in lines(&bench.read("s/rows.jsonl")) {
        checked(&bench, "study-row", &row);
    }
}
