//! Rows as CSV, for spreadsheets.

use crate::{COLUMNS, Column, DIFFERENCE_COLUMN, DRAWN_COLUMNS, Row, Values, WalkFrame};

/// Rows as CSV: a line of names, a line each; no per-view values. Text that a spreadsheet would
/// take for a formula has an apostrophe before it.
pub fn to_csv(rows: &[Row]) -> String {
    let mut text = "tree,method,setting,change,seed,level,leaves_original,leaves_final,triangles_final,seconds,peak_rss_bytes,resolution,kept_overlap,overlap_with,max_area_scale,judged_by,judged_leaves".to_owned();
    for prefix in ["", "worst_"] {
        for column in COLUMNS.iter() {
            text += &format!(",{prefix}{}", column.key);
        }
    }
    for column in DRAWN_COLUMNS {
        text += &format!(",{}", column.key);
    }
    // Rows of before stay as they were written.
    let with_difference: Vec<Column> = (rows.iter())
        .any(|row| row.values.contains_key(DIFFERENCE_COLUMN.key))
        .then_some(DIFFERENCE_COLUMN)
        .into_iter()
        .collect();
    for column in &with_difference {
        text += &format!(",{}", column.key);
    }
    let has_walk = rows.iter().any(|row| row.walk.is_some());
    if has_walk {
        text += ",triangles_original,switches,step,step_original,pop";
    }
    text += ",engine,adapter,version,commit,machine,command\n";
    for row in rows {
        let mut cells = vec![
            quoted(&row.tree),
            bare(&row.method),
            quoted(&row.setting),
            quoted(&row.change),
            row.seed.to_string(),
            row.level.to_string(),
            row.leaves_original.to_string(),
            row.leaves_final.to_string(),
            row.triangles_final.to_string(),
            row.seconds.to_string(),
            row.peak_rss_bytes.map_or(String::new(), |b| b.to_string()),
            row.resolution.to_string(),
            row.kept_overlap.map_or(String::new(), |o| o.to_string()),
            quoted(&row.overlap_with),
            row.max_area_scale.map_or(String::new(), |s| s.to_string()),
            row.judged_by.name().to_owned(),
            row.judged_leaves.name().to_owned(),
        ];
        let cell = |values: &Values, column: &Column| {
            let value = values.get(column.key).copied().flatten();
            value.map_or(String::new(), |value| value.to_string())
        };
        for values in [&row.values, &row.worst] {
            cells.extend(COLUMNS.iter().map(|column| cell(values, column)));
        }
        cells.extend(DRAWN_COLUMNS.map(|column| cell(&row.values, &column)));
        cells.extend(
            with_difference
                .iter()
                .map(|column| cell(&row.values, column)),
        );
        if has_walk {
            cells.extend(cells_of_walk(row.walk.as_ref()));
        }
        cells.push(bare(&row.engine));
        cells.push(quoted(row.adapter.as_deref().unwrap_or("")));
        cells.extend([bare(&row.version), bare(&row.commit)]);
        cells.extend([quoted(&row.machine), quoted(&row.command)]);
        text += &cells.join(",");
        text.push('\n');
    }
    text
}

/// What was seen in a frame of a walk; empty cells of other rows.
fn cells_of_walk(frame: Option<&WalkFrame>) -> [String; 5] {
    let of = |value: fn(&WalkFrame) -> Option<f64>| {
        let value = frame.and_then(value);
        value.map_or(String::new(), |value| value.to_string())
    };
    [
        of(|frame| Some(frame.triangles_original as f64)),
        of(|frame| Some(frame.switches as f64)),
        of(|frame| frame.step),
        of(|frame| frame.step_original),
        of(|frame| frame.pop),
    ]
}

/// A cell of text in quotes.
fn quoted(text: &str) -> String {
    format!("\"{}\"", defused(text).replace('"', "\"\""))
}

/// A cell of text without quotes where it needs none: names that a study writes have no commas.
fn bare(text: &str) -> String {
    match text.contains([',', '"', '\n', '\r']) {
        true => quoted(text),
        false => defused(text),
    }
}

/// The text with an apostrophe before it if a spreadsheet would take it for a formula: names come
/// from files, and nobody vouches for them.
fn defused(text: &str) -> String {
    match text.starts_with(['=', '+', '-', '@', '\t', '\r']) {
        true => format!("'{text}"),
        false => text.to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rows::tests::row;

    #[test]
    fn infinite_values_are_empty_cells() {
        let mut row = row("a", 0.5, 1.0, 2.0);
        row.values.insert("vmi_error_percent".into(), None);
        let csv = to_csv(&[row]);
        let lines: Vec<&str> = csv.lines().collect();
        assert_eq!(lines.len(), 2);
        assert!(
            lines[1].contains(",256,,\"\",,held-out,as-in-file,,0.5,"),
            "{}",
            lines[1]
        );
        assert!(lines[1].contains("\"a \"\"machine\"\"\""));
    }

    #[test]
    fn frames_of_a_walk_have_columns_of_their_own() {
        let mut frame = row("merge", 1.0, 0.0, 2.0);
        frame.walk = Some(WalkFrame {
            frame: 3,
            is_turn: false,
            has_panorama: false,
            triangles_original: 70,
            switches: 2,
            step: Some(0.5),
            step_original: Some(0.25),
            pop: None,
        });
        let other = row("vds", 0.5, 1.0, 2.0);
        let csv = to_csv(&[frame, other.clone()]);
        let lines: Vec<&str> = csv.lines().collect();
        assert!(lines[0].contains(",triangles_original,switches,step,step_original,pop,engine,"));
        assert!(lines[1].contains(",70,2,0.5,0.25,,cpu,") && lines[2].contains(",,,,,,cpu,"));
        assert!(!to_csv(&[other]).contains("switches"));
    }

    /// Rows can come from elsewhere: every column of text is defused, and none adds cells.
    #[test]
    fn a_spreadsheet_computes_nothing() {
        let formula = "=HYPERLINK(\"x\",1)";
        let mut row = row("a", 0.5, 1.0, 2.0);
        let columns = to_csv(std::slice::from_ref(&row));
        let commas = |csv: &str| csv.lines().nth(1).unwrap().matches(',').count();
        let plain = commas(&columns);
        for text in [
            &mut row.tree,
            &mut row.method,
            &mut row.setting,
            &mut row.change,
            &mut row.overlap_with,
            &mut row.engine,
            &mut row.version,
            &mut row.commit,
            &mut row.machine,
            &mut row.command,
        ] {
            *text = formula.into();
        }
        row.adapter = Some(formula.into());
        let csv = to_csv(&[row]);
        assert_eq!(csv.matches("\"'=HYPERLINK(\"\"x\"\",1)\"").count(), 11);
        assert_eq!(csv.matches("=HYPERLINK").count(), 11);
        assert_eq!(commas(&csv), plain + 11, "one within each quoted cell");
        for formula in ["+cmd", "-x", "@sum", "\t=1"] {
            assert_eq!(quoted(formula), format!("\"'{formula}\""));
        }
        assert_eq!(bare("vds"), "vds");
    }
}
