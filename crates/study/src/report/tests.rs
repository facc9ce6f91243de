//! What reports of studies say.

use super::*;
use crate::rows::tests::row;

fn of(rows: &[Row]) -> Study<'_> {
    Study {
        rows,
        failure_cases: &[],
        paper: None,
    }
}

#[test]
fn a_report_has_every_level_and_method_and_asks_no_network() {
    let mut rows = vec![
        row("vds", 0.5, 2.0, 1.0),
        row("fsa", 0.5, 1.0, 9.0),
        row("vds", 0.01, 3.0, 2.0),
    ];
    rows[0].picture = "pictures/a.jpg".into();
    rows.iter_mut().for_each(|row| row.tree = "<oak>".into());
    let pictures = [("pictures/a.jpg".to_owned(), vec![1, 2, 3])];
    let html = report(&of(&rows), &pictures);
    for part in [
        "50 % of the leaves",
        "1 % of the leaves",
        "AQID",
        "&lt;oak&gt;",
        "class=\"best\"",
    ] {
        assert!(html.contains(part), "{part}");
    }
    assert_eq!(html.matches("<svg").count(), 1 + 2 * COLUMNS.len());
    // The name of SVG's own namespace is all that looks like an address.
    let addresses = html.matches("http:").count() + html.matches("https:").count();
    assert_eq!(
        addresses,
        html.matches("http://www.w3.org/2000/svg").count()
    );
    assert!(!html.contains("<oak>"));
}

#[test]
fn means_are_of_what_ran_on_every_tree() {
    let mut rows = ["vds", "fsa", "vds"].map(|method| row(method, 0.5, 1.0, 1.0));
    rows[2].tree = "pine".into();
    let html = report(&of(&rows), &[]);
    let note = "because not run on every tree: fsa.";
    assert!(html.contains(note));
    assert!(html.contains("<p>2 trees: oak, pine."));
    assert!(super::super::readme(&of(&rows)).contains(note));
    assert!(!report(&of(&rows[..2]), &[]).contains("because not run"));
}

/// The level nearest a tenth, what looks best there, and what loses the least information.
#[test]
fn a_report_opens_with_a_picture_and_advice() {
    let of = |method: &str, tree: &str, error: f64, flip: f64| {
        let mut row = row(method, 0.12, 1.0, error);
        row.tree = tree.into();
        row.values.insert("flip_mean".into(), Some(flip));
        row.picture = format!("pictures/{method}-{tree}.jpg");
        row
    };
    let mut rows = vec![
        of("vds", "oak", 3.0, 0.02),
        of("fsa", "oak", 9.0, 0.03),
        of("vds", "elm", 3.0, 0.08),
        of("fsa", "elm", 1.0, 0.09),
        of("vds", "ash", 3.0, 0.05),
        of("fsa", "ash", 9.0, 0.09),
    ];
    rows.push(row("vds", 0.5, 1.0, 1.0));
    let pictures =
        ["oak", "elm", "ash"].map(|tree| (format!("pictures/vds-{tree}.jpg"), tree.into()));
    let html = report(&self::of(&rows), &pictures);
    let lead =
        &html[html.find("class=\"lead\"").unwrap()..html.find("<div class=\"lead-chart").unwrap()];
    assert!(lead.contains(&STANDARD.encode("ash")), "of the middle one");
    for part in [
        "<em>vds</em>. With 12 % left",
        "is 0.0500 in the mean of 3 trees",
        "the best of the other methods, fsa spread, has 0.0700",
        "its error is 3.00 %",
        "the best of the other methods, fsa spread, has 6.33 %",
        "(IoU) on 0 of 3 trees",
    ] {
        assert!(lead.contains(part), "{part}: {lead}");
    }
    assert!(html.find("<div class=\"lead-chart") < html.find("<h2>"));
}

/// Three jittered runs of 4 %, 9 % and 6 % beside one of 3 %: the second is
/// shown, and none of them is among the methods' own pictures.
#[test]
fn the_worst_change_is_shown_beside_the_first_run() {
    let mut rows = [3.0, 4.0, 9.0, 6.0].map(|error| row("vds", 0.5, 1.0, error));
    for (k, row) in rows.iter_mut().enumerate() {
        row.picture = format!("pictures/{k}.jpg");
        if k > 0 {
            row.change = format!("jitter {k}");
            row.kept_overlap = Some(0.5 + 0.1 * k as f64);
        }
    }
    let pictures = [0, 1, 2, 3].map(|k| (format!("pictures/{k}.jpg"), vec![0, 0, k]));
    let html = report(&of(&rows), &pictures);
    let shown = |base64: &str| html.matches(&format!("base64,{base64}")).count();
    // At the head, in the sheet and as the first run; as the worst.
    assert_eq!(["AAAA", "AAAB", "AAAC", "AAAD"].map(shown), [3, 0, 1, 0]);
    assert!(html.contains("0.700 (0.600)"), "overlaps of 0.6, 0.7, 0.8");
}

/// A scene has its verdict and pictures, and is no part of the means.
#[test]
fn scenes_made_for_failures_stand_apart() {
    let mut rows = [20.0, 8.0, 4.0].map(|error| row("vds", 0.5, 1.0, error));
    rows[0].tree = "scene".into();
    rows[0].setting = "resolution 64".into();
    rows[1].tree = "scene".into();
    rows[0].picture = "pictures/0.jpg".into();
    let failure_cases = [FailureCase {
        tree: "scene".into(),
        title: "Small <leaves>".into(),
        about: "Too small.".into(),
        suspect: "vds resolution 64".into(),
    }];
    let study = Study {
        failure_cases: &failure_cases,
        ..of(&rows)
    };
    let html = report(&study, &[("pictures/0.jpg".into(), vec![1, 2, 3])]);
    for part in [
        "Small &lt;leaves&gt;",
        "vds (VMI error 8.0 %, IoU 0.500) is better",
        "AQID",
    ] {
        assert!(html.contains(part), "{part}");
    }
    assert_eq!(html.matches("class=\"tree\"").count(), 1);
}

/// Fewer methods run on a paper's models: their rows would bend means.
#[test]
fn trees_that_stand_for_a_papers_models_are_no_part_of_means() {
    let mut rows = [2.0, 40.0].map(|error| row("vds", 0.5, 1.0, error));
    rows[1].tree = "grown".into();
    let figure = crate::Published {
        source: "Table 1".into(),
        model: "Oak".into(),
        tree: "grown".into(),
        label: "vds".into(),
        level: 0.5,
        error_percent: 3.0,
        seconds: 9.0,
    };
    let paper = Paper {
        about: "What compares.".into(),
        figures: vec![figure],
        comparisons: vec![("m".into(), vec!["vds".into()])],
    };
    let study = Study {
        paper: Some(&paper),
        ..of(&rows)
    };
    assert_eq!(study.given_rows().len(), 1);
    let html = report(&study, &[]);
    assert!(html.contains("<td>3.00 %</td><td>40.00 %</td>"));
    assert!(html.contains("What compares."));
}

#[test]
fn nothing_is_a_report_too() {
    assert!(report(&of(&[]), &[]).ends_with("</html>\n"));
}
