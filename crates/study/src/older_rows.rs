//! Rows of older versions, which lack some columns.

use serde_json::{Value, json};

use crate::LevelOf;

/// Adds the columns that a row may lack because the program that wrote it did not know them: it
/// said the same by words of the setting.
pub(crate) fn complete(row: &mut Value) {
    let Some(columns) = row.as_object_mut() else {
        return;
    };
    let setting = columns.get("setting").and_then(Value::as_str);
    let words: Vec<&str> = setting.unwrap_or_default().split_whitespace().collect();
    let level_of = match words.contains(&"triangles") {
        true => LevelOf::Triangles,
        false => LevelOf::Leaves,
    };
    let views = words.windows(2).find(|pair| pair[0] == "views");
    let is_driven_by_judging_views =
        views.is_some_and(|pair| ["12", "icosahedron"].contains(&pair[1]));
    let known = json!({
        "level_of": level_of,
        "is_driven_by_judging_views": is_driven_by_judging_views,
    });
    for (name, value) in known.as_object().into_iter().flatten() {
        columns.entry(name.clone()).or_insert_with(|| value.clone());
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_setting_tells_what_older_rows_do_not() {
        let told = |setting: &str| {
            let mut row = json!({ "setting": setting });
            complete(&mut row);
            let is_driven = row["is_driven_by_judging_views"].as_bool().unwrap();
            (row["level_of"].as_str().unwrap().to_owned(), is_driven)
        };
        let leaves = "leaves".to_owned();
        for setting in ["", "views 92", "resolution 12"] {
            assert_eq!(told(setting), (leaves.clone(), false), "{setting}");
        }
        for setting in ["resolution 64 views 12", "views icosahedron", "views 12"] {
            assert_eq!(told(setting), (leaves.clone(), true), "{setting}");
        }
        assert_eq!(told("triangles fit=4"), ("triangles".to_owned(), false));
    }

    #[test]
    fn what_a_row_says_itself_stays() {
        let mut row = json!({ "setting": "triangles", "level_of": "leaves" });
        complete(&mut row);
        assert_eq!(row["level_of"], "leaves");
    }
}
