//! Results on standard output, in the format that is asked for.

use std::fmt::Write as _;
use std::io::{self, Write};

use serde_json::Value;

use super::args::Format;
use super::escape;
use super::failure::Failure;

/// What a command prints.
pub(crate) struct Printed {
    /// Lines for a reader (`--format pretty`).
    pub(crate) pretty: String,
    /// The records as `--format json` prints them.
    pub(crate) records: Records,
    /// The records that make the rows of tables.
    pub(crate) rows: Vec<Value>,
    /// Whether some of several inputs failed; the exit code is then 3.
    pub(crate) some_failed: bool,
}

/// What a command says for programs.
pub(crate) enum Records {
    /// A record, indented.
    One(Value),
    /// A record for each plant, one a line (JSON lines), however many there are.
    Lines(Vec<Value>),
}

impl Records {
    pub(crate) fn as_text(&self) -> String {
        match self {
            Self::One(record) => format!("{record:#}\n"),
            Self::Lines(records) => records.iter().map(|record| format!("{record}\n")).collect(),
        }
    }
}

impl Printed {
    /// Nothing more: the result is on standard output.
    pub(crate) fn nothing() -> Self {
        Self {
            pretty: String::new(),
            records: Records::Lines(Vec::new()),
            rows: Vec::new(),
            some_failed: false,
        }
    }

    /// A result that is one record.
    pub(crate) fn single(pretty: String, record: Value) -> Self {
        Self {
            pretty,
            rows: vec![record.clone()],
            records: Records::One(record),
            some_failed: false,
        }
    }

    pub(crate) fn as_text(&self, format: Format) -> String {
        match format {
            Format::Pretty => self.pretty.clone(),
            Format::Json => self.records.as_text(),
            Format::Csv => csv(&self.table()),
            Format::Md => markdown(&self.table()),
        }
    }

    /// A row of names, then a row of values for each record.
    fn table(&self) -> Vec<Vec<String>> {
        let rows: Vec<Vec<(String, String)>> = self.rows.iter().map(flat).collect();
        let mut names: Vec<String> = Vec::new();
        for (name, _) in rows.iter().flatten() {
            if !names.contains(name) {
                names.push(name.clone());
            }
        }
        let values = rows.iter().map(|row| {
            let value = |name: &String| row.iter().find(|(n, _)| n == name);
            let text = |name| value(name).map(|(_, v)| v.clone()).unwrap_or_default();
            names.iter().map(text).collect()
        });
        let values: Vec<Vec<String>> = values.collect();
        std::iter::once(names).chain(values).collect()
    }
}

/// Names with dots and values of all that is a scalar or a list of scalars.
fn flat(record: &Value) -> Vec<(String, String)> {
    let mut pairs = Vec::new();
    push_flat("", record, &mut pairs);
    pairs
}

fn push_flat(name: &str, value: &Value, pairs: &mut Vec<(String, String)>) {
    match value {
        Value::Object(entries) => {
            for (key, value) in entries {
                let dot = if name.is_empty() { "" } else { "." };
                push_flat(&format!("{name}{dot}{key}"), value, pairs);
            }
        }
        Value::Array(items) if items.iter().any(|i| i.is_object() || i.is_array()) => {}
        Value::Array(items) => {
            let texts: Vec<String> = items.iter().map(scalar).collect();
            pairs.push((name.to_owned(), texts.join(" ")));
        }
        other => pairs.push((name.to_owned(), scalar(other))),
    }
}

fn scalar(value: &Value) -> String {
    match value {
        Value::String(text) => text.clone(),
        Value::Null => String::new(),
        other => other.to_string(),
    }
}

/// RFC 4180, lines ending in a line feed.
fn csv(table: &[Vec<String>]) -> String {
    let field = |text: &String| {
        let text = escape::cell(text);
        match text.contains([',', '"', '\n', '\r']) {
            true => format!("\"{}\"", text.replace('"', "\"\"")),
            false => text,
        }
    };
    let line = |row: &Vec<String>| row.iter().map(field).collect::<Vec<_>>().join(",") + "\n";
    table.iter().map(line).collect()
}

/// A table with records as rows, or, for one record, a row for each name.
fn markdown(table: &[Vec<String>]) -> String {
    let turned: Vec<Vec<String>>;
    let rows = match table {
        [names, values] => {
            let pairs = names.iter().zip(values);
            let head = vec!["name".to_owned(), "value".to_owned()];
            let body = pairs.map(|(n, v)| vec![n.clone(), v.clone()]);
            turned = std::iter::once(head).chain(body).collect();
            &turned
        }
        _ => table,
    };
    let mut text = String::new();
    for (k, row) in rows.iter().enumerate() {
        let cells: Vec<String> = row
            .iter()
            .map(|cell| secateur_study::markdown_escaped(cell))
            .collect();
        let _ = writeln!(text, "| {} |", cells.join(" | "));
        if k == 0 {
            let _ = writeln!(text, "|{}", "---|".repeat(row.len()));
        }
    }
    text
}

/// Prints to standard output, control characters escaped; a reader that has gone away is no failure.
pub(crate) fn to_stdout(text: &str) -> Result<(), Failure> {
    let mut stdout = io::stdout().lock();
    let result = stdout
        .write_all(escape::escaped(text).as_bytes())
        .and_then(|()| stdout.flush());
    match result {
        Err(e) if e.kind() != io::ErrorKind::BrokenPipe => Err(Failure::machine(format!(
            "standard output cannot be written: {e}"
        ))),
        _ => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    fn printed() -> Printed {
        Printed::single(
            String::new(),
            json!({"a": {"b": 1, "c": "x,\"y\""}, "l": [1.5, 2], "o": [{}], "n": null}),
        )
    }

    #[test]
    fn records_become_lines_of_names_and_values() {
        let expected = "a.b,a.c,l,n\n1,\"x,\"\"y\"\"\",1.5 2,\n";
        assert_eq!(printed().as_text(Format::Csv), expected);
    }

    #[test]
    fn one_record_is_a_table_of_names_and_several_are_rows() {
        let one = printed().as_text(Format::Md);
        assert!(one.starts_with("| name | value |\n|---|---|\n| a.b | 1 |\n"));
        let mut two = printed();
        two.rows = vec![json!({"a": "p|q"}), json!({"a": 2, "b": 3})];
        let expected = "| a | b |\n|---|---|\n| p\\|q |  |\n| 2 | 3 |\n";
        assert_eq!(two.as_text(Format::Md), expected);
    }
}
