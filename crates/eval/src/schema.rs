//! The schema of values by the keys of metrics.

use schemars::{Schema, json_schema};
use serde_json::{Map, Value, json};

/// An object with a number for each metric of this key, title and unit; null where it is infinite.
pub(crate) fn of_metrics(
    metrics: impl Iterator<Item = (&'static str, &'static str, &'static str)>,
) -> Schema {
    let mut properties = Map::new();
    for (key, title, unit) in metrics {
        let what = match unit {
            "" => title.to_owned(),
            unit => format!("{title}, {unit}"),
        };
        let value = json!({ "description": what, "type": ["number", "null"] });
        properties.insert(key.to_owned(), value);
    }
    let required: Vec<Value> = properties.keys().map(|key| json!(key)).collect();
    json_schema!({ "type": "object", "properties": properties, "required": required })
}
