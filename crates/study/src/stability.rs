//! How far results spread over changes that should not matter, and over settings that should matter little.

use crate::columns::column;
use crate::format::{number, percent};
use crate::table::Table;
use crate::{Column, Row, groups, overlap, spread};

/// What reports say of the tables of [`by_method`] and [`by_change`].
pub(crate) const WHAT_IS_SPREAD: &str = "Mean over trees of a method's runs, the one without a change included; ± their standard deviation about each tree's own mean (root mean square over trees); in brackets by how much the worst run is off from the one without a change on its tree. Shared leaves: mean overlap (Jaccard) of the original leaves left with those of the method's first run, and the least.";

/// The metrics of the tables, of which rows of before lack some.
const SHOWN: [&str; 5] = [
    "flip_mean",
    "difference_300",
    "silhouette_iou",
    "coverage_ratio",
    "vmi_error_percent",
];

/// Words of settings that a plan changes where this should matter little, and what tables call that.
const SETTINGS: [(&str, &str); 5] = [
    ("resolution", "resolution"),
    ("views", "number of views"),
    ("ties", "order of ties"),
    ("alpha", "leaves without holes"),
    ("seed", "seeds"),
];

/// What tables call all changes of the tree and the views together.
const EVERY_CHANGE: &str = "views, corners and order";

fn shown(rows: &[Row]) -> Vec<&'static Column> {
    let columns = SHOWN.into_iter().map(column);
    let has = |by: &&Column| rows.iter().any(|row| by.value_of(row).is_finite());
    columns.filter(has).collect()
}

/// A method under changes of one kind at a level.
struct Line<'r> {
    label: String,
    kind: String,
    level: f64,
    /// Of each tree the run without a change, and those with one.
    of_trees: Vec<(&'r Row, Vec<&'r Row>)>,
}

/// Of one kind: a line for each method and level, all changes of tree and views together.
pub(crate) fn by_method(rows: &[Row]) -> Option<Table> {
    let merged = lines(rows, |own, base| {
        let is_changed = own.label() != base.label() && own.setting == base.setting;
        is_changed.then(|| EVERY_CHANGE.to_owned())
    });
    table(rows, &merged, &["method", "left"], |line| {
        vec![line.label.clone(), percent(line.level)]
    })
}

/// A line for each method, level and kind of change or setting.
pub(crate) fn by_change(rows: &[Row]) -> Option<Table> {
    let lines = lines(rows, kind_of);
    table(rows, &lines, &["method", "left", "what changes"], |line| {
        let level = percent(line.level);
        vec![line.label.clone(), level, line.kind.clone()]
    })
}

/// In what a row differs from one without a change; nothing if it is no run of that method, or the same.
fn kind_of(own: &Row, base: &Row) -> Option<String> {
    let is_same_setting = own.setting == base.setting;
    if is_same_setting && !own.change.is_empty() {
        return Some(match own.change.strip_prefix("jitter ") {
            Some(radii) => format!("corners moved by {radii} radii"),
            None => own.change.trim_end_matches(numbered).to_owned(),
        });
    }
    if is_same_setting {
        return (own.seed != base.seed).then(|| "seeds".to_owned());
    }
    let added = own.setting.strip_prefix(&base.setting)?.trim_start();
    let word = added.split(' ').next()?;
    let known = SETTINGS.iter().find(|(first, _)| *first == word);
    known.map(|(_, name)| (*name).to_owned())
}

fn numbered(c: char) -> bool {
    c.is_ascii_digit() || c == ' '
}

/// Lines of the methods that were run with changes of tree or views, in the order of their rows.
fn lines(rows: &[Row], kind_of: fn(&Row, &Row) -> Option<String>) -> Vec<Line<'_>> {
    let is_changed = |row: &Row| !row.change.is_empty();
    let is_base = |base: &&Row| {
        !is_changed(base)
            && base.seed == 0
            && rows
                .iter()
                .any(|row| is_changed(row) && is_beside(row, base) && row.setting == base.setting)
    };
    let mut lines: Vec<Line<'_>> = Vec::new();
    for base in rows.iter().filter(is_base) {
        for own in rows.iter().filter(|row| is_beside(row, base)) {
            let Some(kind) = kind_of(own, base) else {
                continue;
            };
            let (label, level) = (base.label(), base.level);
            let known =
                (lines.iter()).position(|l| l.label == label && l.kind == kind && l.level == level);
            let place = known.unwrap_or(lines.len());
            if known.is_none() {
                lines.push(Line {
                    label,
                    kind,
                    level,
                    of_trees: Vec::new(),
                });
            }
            let of_trees = &mut lines[place].of_trees;
            match of_trees
                .iter_mut()
                .find(|(known, _)| known.tree == base.tree)
            {
                Some((_, changed)) => changed.push(own),
                None => of_trees.push((base, vec![own])),
            }
        }
    }
    lines
}

/// Whether two rows are of one method on one tree at one level.
fn is_beside(row: &Row, base: &Row) -> bool {
    row.tree == base.tree && row.method == base.method && row.level == base.level
}

fn table(
    rows: &[Row],
    lines: &[Line<'_>],
    first: &[&str],
    named: impl Fn(&Line<'_>) -> Vec<String>,
) -> Option<Table> {
    let columns = shown(rows);
    let mut head = first.to_vec();
    head.push("trees, runs");
    head.extend(columns.iter().map(|by| by.title));
    head.push("shared leaves (least)");
    let mut table = Table::new(&head);
    for line in lines {
        let changed: Vec<&Row> = (line.of_trees.iter())
            .flat_map(|(_, changed)| changed.iter().copied())
            .collect();
        let mut cells = named(line);
        let trees = line.of_trees.len();
        cells.push(format!("{trees}, {}", trees + changed.len()));
        cells.extend(columns.iter().map(|by| line.spread(by)));
        cells.push(shared(&changed));
        table.push(cells);
    }
    (!table.body.is_empty()).then_some(table)
}

impl Line<'_> {
    /// Mean, deviation and how far off the worst run is.
    fn spread(&self, by: &Column) -> String {
        let (mut mean, mut squares) = (0.0, 0.0);
        let (mut most, mut worst) = (f64::NEG_INFINITY, 0.0);
        for (base, changed) in &self.of_trees {
            let own = spread(&[&[*base], &changed[..]].concat(), by);
            mean += own.mean;
            squares += own.deviation * own.deviation;
            let badness = |row: &Row| by.direction.badness(by.value_of(row));
            for row in changed {
                let rise = badness(row) - badness(base);
                if rise > most {
                    (most, worst) = (rise, by.value_of(row) - by.value_of(base));
                }
            }
        }
        let trees = self.of_trees.len() as f64;
        let [mean, deviation, off] =
            [mean / trees, (squares / trees).sqrt(), worst.abs()].map(|v| number(v, by));
        let sign = match worst < 0.0 {
            true => '-',
            false => '+',
        };
        format!("{mean} ± {deviation} ({sign}{off})")
    }
}

fn shared(rows: &[&Row]) -> String {
    overlap(rows).map_or(String::new(), |(mean, least)| {
        format!("{mean:.3} ({least:.3})")
    })
}

/// A line for each tree, method and level; the worst run's own value in brackets.
pub(crate) fn by_tree(rows: &[Row]) -> Option<Table> {
    let columns = shown(rows);
    let mut head = vec!["tree", "method", "left", "runs", "shared leaves (least)"];
    head.extend(columns.iter().map(|by| by.title));
    let mut table = Table::new(&head);
    for ((tree, method, setting, level), rows) in &groups(rows) {
        let mut cells = vec![
            (*tree).to_owned(),
            format!("{method} {setting}").trim_end().to_owned(),
            percent(*level as f64 / 1e6),
            rows.len().to_string(),
            shared(rows),
        ];
        cells.extend(columns.iter().map(|by| {
            let found = spread(rows, by);
            let [mean, deviation, worst] =
                [found.mean, found.deviation, found.worst].map(|v| number(v, by));
            format!("{mean} ± {deviation} ({worst})")
        }));
        table.push(cells);
    }
    (!table.body.is_empty()).then_some(table)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rows::tests::row;

    fn changed(tree: &str, change: &str, flip: f64) -> Row {
        let mut row = row("vds", 0.1, 1.0, 9.0);
        (row.tree, row.change) = (tree.into(), change.into());
        row.values.insert("flip_mean".into(), Some(flip));
        row
    }

    /// On the oak .1, .1 and .4 about a mean of .2: a deviation of sqrt(.03). On the elm .2 and .2. The mean of trees is
    /// .2, the spread sqrt(.03 / 2), the worst run is .3 off its own tree's.
    #[test]
    fn spreads_are_about_each_trees_own_mean() {
        let rows = [
            changed("oak", "", 0.1),
            changed("oak", "views turned 1", 0.1),
            changed("oak", "jitter 1e-4", 0.4),
            changed("elm", "", 0.2),
            changed("elm", "views turned 2", 0.2),
        ];
        let table = by_method(&rows).unwrap();
        assert_eq!(table.body.len(), 1);
        assert_eq!(table.body[0][..3], ["vds", "10 %", "2, 5"]);
        assert_eq!(table.body[0][3], "0.2000 ± 0.1225 (+0.3000)");
        let table = by_change(&rows).unwrap();
        let kinds: Vec<&str> = table.body.iter().map(|cells| &*cells[2]).collect();
        assert_eq!(kinds, ["views turned", "corners moved by 1e-4 radii"]);
        assert_eq!(table.body[0][3], "2, 4");
    }

    /// Only settings that the plan changes stand beside a method, and only a method with changes has lines.
    #[test]
    fn settings_stand_beside_the_method_without_them() {
        let set = |setting: &str, seed: u64| Row {
            setting: setting.into(),
            seed,
            ..changed("oak", "", 0.1)
        };
        let mut rows = vec![
            set("", 0),
            set("views 92", 0),
            set("triangles", 0),
            set("", 1),
        ];
        assert!(by_change(&rows).is_none(), "nothing was changed");
        rows.push(changed("oak", "leaves shuffled 1", 0.1));
        let table = by_change(&rows).unwrap();
        let kinds: Vec<&str> = table.body.iter().map(|cells| &*cells[2]).collect();
        assert_eq!(kinds, ["number of views", "seeds", "leaves shuffled"]);
    }
}
