//! Tables that compare a paper's printed figures with those of rows.

use super::{Row, held_out};
use crate::format::{duration, percent};
use crate::table::Table;

/// A printed figure of a model, a method and a level.
#[derive(Clone, Debug, PartialEq)]
pub struct Published {
    /// Where it is printed: "Table 1".
    pub source: String,
    /// The paper's model: "English oak, 20,376 leaves".
    pub model: String,
    /// The tree that stands for the model here, as [`Row::tree`].
    pub tree: String,
    /// The case that compares with it, as [`Row::label`].
    pub label: String,
    /// The share of leaves left.
    pub level: f64,
    /// VMI error over the views that judge, in per cent.
    pub error_percent: f64,
    /// Time of the method, in seconds.
    pub seconds: f64,
}

/// A paper that a study is compared with.
#[derive(Clone, Debug, PartialEq)]
pub struct Paper {
    /// What can be compared and what cannot, in a few sentences.
    pub about: String,
    /// The figures that it prints.
    pub figures: Vec<Published>,
    /// Title, and labels of which the first is the one that others are given
    /// as multiples of.
    pub comparisons: Vec<(String, Vec<String>)>,
}

/// VMI error and time of a run.
struct Pair {
    error_percent: f64,
    seconds: f64,
    is_driven_by_judging_views: bool,
}

/// All tables of a paper that the rows have figures for, with their titles.
pub(crate) fn beside(paper: &Paper, rows: &[Row]) -> Vec<(String, Table)> {
    let base = paper
        .comparisons
        .first()
        .and_then(|(_, labels)| labels.first());
    let printed = base.and_then(|base| side_by_side(&paper.figures, rows, base));
    let printed = printed.map(|table| ("What the paper prints, and rows here".to_owned(), table));
    let comparisons = paper.comparisons.iter();
    let multiples =
        comparisons.filter_map(|(title, labels)| Some((title.clone(), multiples(rows, labels)?)));
    let nearest = nearest(paper, rows).map(|table| {
        (
            "Which reading comes nearest to the printed errors".to_owned(),
            table,
        )
    });
    (printed.into_iter().chain(nearest).chain(multiples)).collect()
}

/// Errors and times of two sources, each as they are and as multiples of the
/// source's own first method: only the multiples can be compared.
fn side_by_side(published: &[Published], rows: &[Row], base: &str) -> Option<Table> {
    let of_base = |what: &str| format!("{what}, times {base}'s");
    let (error_times, seconds_times) = (of_base("error: paper"), of_base("time: paper"));
    let mut table = Table::new(&[
        "printed in",
        "model",
        "leaves left",
        "method",
        "error: paper",
        "here",
        &error_times,
        "here",
        "time: paper",
        "here",
        &seconds_times,
        "here",
    ]);
    for figure in published {
        let Some(here) = find(rows, &figure.tree, &figure.label, figure.level) else {
            continue;
        };
        let paper_base = published.iter().find(|p| {
            (&p.tree, &p.source) == (&figure.tree, &figure.source)
                && p.label == base
                && p.level == figure.level
        });
        let here_base = find(rows, &figure.tree, base, figure.level);
        let paper = Pair {
            error_percent: figure.error_percent,
            seconds: figure.seconds,
            is_driven_by_judging_views: false,
        };
        let paper_base = paper_base.map(|p| Pair {
            error_percent: p.error_percent,
            seconds: p.seconds,
            is_driven_by_judging_views: false,
        });
        table.push(vec![
            figure.source.clone(),
            figure.model.clone(),
            percent(figure.level),
            held_out::shown(&figure.label, here.is_driven_by_judging_views),
            format!("{:.2} %", paper.error_percent),
            format!("{:.2} %", here.error_percent),
            times(
                paper_base
                    .as_ref()
                    .map(|b| paper.error_percent / b.error_percent),
            ),
            times(
                here_base
                    .as_ref()
                    .map(|b| here.error_percent / b.error_percent),
            ),
            duration(paper.seconds),
            duration(here.seconds),
            times(paper_base.as_ref().map(|b| paper.seconds / b.seconds)),
            times(here_base.as_ref().map(|b| here.seconds / b.seconds)),
        ]);
    }
    (!table.body.is_empty()).then_some(table)
}

/// How near each reading of a paper's method comes to the errors that it prints: for each label
/// that begins with `vds`, here over printed as geometric means over all printed figures of the
/// method.
pub(crate) fn nearest(paper: &Paper, rows: &[Row]) -> Option<Table> {
    let base = &paper.comparisons.first()?.1;
    let printed = paper.figures.iter().filter(|f| f.label == base[0]);
    let printed: Vec<&Published> = printed.collect();
    let mut table = Table::new(&[
        "method",
        "figures",
        "error: here over the paper's",
        "times apart, mean",
        "times apart, at most",
        "within a factor of 2",
    ]);
    for label in base.iter().filter(|label| label.starts_with("vds")) {
        let ratios: Vec<f64> = (printed.iter())
            .filter_map(|figure| {
                let here = find(rows, &figure.tree, label, figure.level)?;
                Some((here.error_percent / figure.error_percent).ln())
            })
            .filter(|ratio| ratio.is_finite())
            .collect();
        if ratios.is_empty() {
            continue;
        }
        let mean = |of: fn(f64) -> f64| {
            let sum: f64 = ratios.iter().map(|ratio| of(*ratio)).sum();
            (sum / ratios.len() as f64).exp()
        };
        let most = ratios.iter().map(|ratio| ratio.abs()).fold(0.0, f64::max);
        let near = ratios.iter().filter(|r| r.abs() <= 2f64.ln()).count();
        table.push(vec![
            label.clone(),
            ratios.len().to_string(),
            format!("{:.2}", mean(|ratio| ratio)),
            format!("{:.2}", mean(f64::abs)),
            format!("{:.2}", most.exp()),
            near.to_string(),
        ]);
    }
    (!table.body.is_empty()).then_some(table)
}

/// What rows alone say: errors and times of methods as multiples of one's, for
/// every tree and level that has it and one other at least.
fn multiples(rows: &[Row], labels: &[String]) -> Option<Table> {
    let mut table = Table::new(&[
        "tree",
        "leaves left",
        "run",
        "error",
        "times",
        "time",
        "times",
    ]);
    let mut seen: Vec<(&str, f64)> = Vec::new();
    for row in rows {
        let at = (row.tree.as_str(), row.level);
        if seen.contains(&at) {
            continue;
        }
        seen.push(at);
        let Some(base) = find(rows, at.0, &labels[0], at.1) else {
            continue;
        };
        let others: Vec<(&str, Pair)> = (labels[1..].iter())
            .filter_map(|label| Some((label.as_str(), find(rows, at.0, label, at.1)?)))
            .collect();
        if others.len() + 1 < labels.len() {
            continue;
        }
        let first = find(rows, at.0, &labels[0], at.1).map(|pair| (labels[0].as_str(), pair));
        for (label, pair) in first.into_iter().chain(others) {
            table.push(vec![
                at.0.to_owned(),
                percent(at.1),
                held_out::shown(label, pair.is_driven_by_judging_views),
                format!("{:.2} %", pair.error_percent),
                times(Some(pair.error_percent / base.error_percent)),
                duration(pair.seconds),
                times(Some(pair.seconds / base.seconds)),
            ]);
        }
    }
    (!table.body.is_empty()).then_some(table)
}

fn find(rows: &[Row], tree: &str, label: &str, level: f64) -> Option<Pair> {
    let is_it = |row: &&Row| row.tree == tree && row.label() == label && row.level == level;
    let row = rows.iter().find(is_it)?;
    Some(Pair {
        error_percent: row.values.get("vmi_error_percent").copied().flatten()?,
        seconds: row.seconds,
        is_driven_by_judging_views: row.is_driven_by_judging_views,
    })
}

fn times(ratio: Option<f64>) -> String {
    match ratio {
        Some(ratio) if ratio.is_finite() && ratio >= 0.01 => format!("{ratio:.2}"),
        Some(ratio) if ratio.is_finite() => format!("{ratio:.1e}"),
        _ => String::new(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rows::tests::row;

    fn printed(label: &str, error_percent: f64, seconds: f64) -> Published {
        Published {
            source: "Table 1".into(),
            model: "Oak".into(),
            tree: "oak".into(),
            label: label.into(),
            level: 0.1,
            error_percent,
            seconds,
        }
    }

    /// The paper: 45 % of 5 % is nine times, 106 s of 5300 s a fiftieth. Here: 20
    /// of 2 is ten times, 1 s of 4 s a quarter.
    #[test]
    fn figures_are_compared_as_multiples_of_one_method() {
        let published = [printed("vds", 5.0, 5300.0), printed("fsa", 45.0, 106.0)];
        let rows = [row("vds", 0.1, 4.0, 2.0), row("fsa", 0.1, 1.0, 20.0)];
        let table = side_by_side(&published, &rows, "vds").unwrap();
        let fsa: Vec<&str> = table.body[1].iter().map(String::as_str).collect();
        assert_eq!(
            fsa[3..],
            [
                "fsa", "45.00 %", "20.00 %", "9.00", "10.00", "106.00 s", "1.00 s", "0.02", "0.25"
            ]
        );
        assert_eq!(side_by_side(&published, &[], "vds"), None);
    }

    /// Half and twice the printed error: right in the geometric mean, a factor of two apart.
    #[test]
    fn readings_are_held_against_all_printed_figures() {
        let mut figures = vec![printed("vds", 5.0, 1.0), printed("vds", 6.0, 1.0)];
        figures[1].tree = "pine".into();
        figures.push(printed("fsa", 40.0, 1.0));
        let paper = Paper {
            about: String::new(),
            figures,
            comparisons: vec![(
                String::new(),
                ["vds", "vds none", "fsa"].map(str::to_owned).into(),
            )],
        };
        let mut rows = [row("vds", 0.1, 1.0, 2.5), row("vds", 0.1, 1.0, 12.0)];
        rows[1].tree = "pine".into();
        let table = nearest(&paper, &rows).unwrap();
        assert_eq!(table.body, [["vds", "2", "1.00", "2.00", "2.00", "2"]]);
        assert_eq!(nearest(&paper, &[]), None);
    }

    #[test]
    fn multiples_are_of_trees_that_have_all_runs() {
        let mut alone = row("vds", 0.1, 1.0, 1.0);
        alone.tree = "pine".into();
        let rows = [row("vds", 0.1, 4.0, 2.0), row("fsa", 0.1, 1.0, 20.0), alone];
        let table = multiples(&rows, &["vds", "fsa"].map(str::to_owned)).unwrap();
        assert_eq!(table.body.len(), 2);
        assert_eq!(table.body[1][4], "10.00");
        assert_eq!(multiples(&rows, &["vds", "none"].map(str::to_owned)), None);
    }
}
