//! Rows of what is drawn at distances, as charts over the distance.

use super::DistanceCase;
use super::table::{difference_of, drawn, trees, walk_of};
use crate::Row;
use crate::line_chart::{Line, line_chart};

/// Two charts of each tree, triangles and difference over the distance: the name of a file, and the chart as SVG.
pub(crate) fn charts(rows: &[Row]) -> Vec<(String, String)> {
    let of_tree = |tree: &str| {
        let line = |name: &str, case, value: fn(&Row) -> f64| {
            let point = |d: f64| Some((d, value(drawn(rows, tree, case, d)?)));
            Line {
                name: name.to_owned(),
                points: walk_of(rows, tree).into_iter().filter_map(point).collect(),
            }
        };
        let triangles = |row: &Row| row.triangles_final as f64;
        let levels = [
            line("for the distances", DistanceCase::ForDistances, triangles),
            line("meshes alone", DistanceCase::MeshesForDistances, triangles),
            line("fixed shares", DistanceCase::FixedShares, triangles),
        ];
        let looks = [
            line(
                "for the distances",
                DistanceCase::ForDistances,
                difference_of,
            ),
            line("crossed planes", DistanceCase::Impostor, difference_of),
            line(
                "a mesh as light",
                DistanceCase::MeshOfSameCost,
                difference_of,
            ),
        ];
        let chart = |what: &str, title: &str, lines: &[Line]| {
            let title = format!("{tree}: {title}");
            let svg = line_chart(&title, "distance in metres", what, lines);
            (format!("distances-{}-{what}.svg", plain(tree)), svg)
        };
        [
            chart("triangles", "triangles at the same difference", &levels),
            chart("difference", "difference of meshes and impostors", &looks),
        ]
    };
    trees(rows).into_iter().flat_map(of_tree).collect()
}

/// A name as a part of a file's: names of trees come from elsewhere.
fn plain(name: &str) -> String {
    let plain = |c: char| match c.is_ascii_alphanumeric() || ['.', '_', '-'].contains(&c) {
        true => c,
        false => '-',
    };
    name.chars().map(plain).collect()
}

#[cfg(test)]
mod tests {
    use super::super::DISTANCES_M;
    use super::super::tests::seen;
    use super::*;

    #[test]
    fn a_tree_has_a_chart_of_triangles_and_one_of_difference() {
        let mut rows: Vec<Row> = DISTANCES_M
            .map(|d| seen(DistanceCase::ForDistances, d, (400.0 / d) as u64, 0.04))
            .into();
        rows.push(seen(DistanceCase::Impostor, 80.0, 8, 0.06));
        for row in &mut rows {
            row.tree = "an <oak>/..".into();
        }
        let charts = charts(&rows);
        let names: Vec<&str> = charts.iter().map(|(name, _)| name.as_str()).collect();
        let expected = [
            "distances-an--oak--..-triangles.svg",
            "distances-an--oak--..-difference.svg",
        ];
        assert_eq!(names, expected);
        for (_, svg) in &charts {
            assert!(svg.contains("an &lt;oak&gt;/..: ") && !svg.contains("NaN"));
        }
        // Of what has no rows there is no line.
        assert!(charts[1].1.contains("crossed planes") && !charts[1].1.contains("as light"));
        assert!(super::charts(&[]).is_empty());
    }
}
