//! Rows of what is drawn at distances, as tables.

use super::{DIFFERENCE, DistanceCase};
use crate::Row;
use crate::table::Table;

/// What stands above the tables.
pub(crate) const WHAT_IS_COMPARED: &str = "A plant from which one walks away, on a screen of 1080 pixels and 60 degrees. `for the distances` is `lods --distances` with those of the walk, which takes cards (docs/impostors.md) where they are within the difference and lighter, and `meshes alone` the same with `--impostor none`. Of fixed shares of all triangles (`lods --triangles`) the coarsest level is drawn that is within the difference of .28 and the coverage of .20 at the distance, or as far beyond as the level for the distance if that is; and the original if none is. Differences are of the whole plant as large as the screen shows it there. Crossed planes are two to four, lit by normals or flat, whichever looks nearest. Where cards and crossed planes are judged, normals of double-sided leaves are turned to the viewer. Beside crossed planes stands a mesh of as many triangles (`simplify --triangles`), where one can be made.";

/// What is drawn of a tree at a distance, if there are rows of it. Of several the last counts.
pub(super) fn drawn<'r>(
    rows: &'r [Row],
    tree: &str,
    case: DistanceCase,
    distance_m: f64,
) -> Option<&'r Row> {
    let is_it = |row: &&Row| {
        let seen = row.seen_from.filter(|seen| seen.case == case);
        row.tree == tree && seen.is_some_and(|seen| seen.distance_m == distance_m)
    };
    rows.iter().rev().find(is_it)
}

pub(super) fn difference_of(row: &Row) -> f64 {
    let value = row.values.get(DIFFERENCE).copied().flatten();
    value.unwrap_or(f64::NAN)
}

/// The trees that were seen from distances, in the order of running.
pub(super) fn trees(rows: &[Row]) -> Vec<&str> {
    let mut trees: Vec<&str> = Vec::new();
    for row in rows.iter().filter(|row| row.seen_from.is_some()) {
        if !trees.contains(&row.tree.as_str()) {
            trees.push(&row.tree);
        }
    }
    trees
}

/// The distances of the last walk of a tree, in metres, rising.
pub(super) fn walk_of(rows: &[Row], tree: &str) -> Vec<f64> {
    // The setting of a row says which walk it is of, and where on it.
    let walk = |row: &Row| {
        let seen = row.seen_from?;
        let (walk, _) = row.setting.rsplit_once(" at ")?;
        let is_of_walk = row.tree == tree && seen.case == DistanceCase::ForDistances;
        is_of_walk.then(|| (walk.to_owned(), seen.distance_m))
    };
    let all: Vec<(String, f64)> = rows.iter().filter_map(walk).collect();
    let last = all.last().map(|(walk, _)| walk.clone());
    let of_last = all
        .into_iter()
        .filter(|(walk, _)| Some(walk) == last.as_ref());
    let mut distances_m: Vec<f64> = of_last.map(|(_, distance_m)| distance_m).collect();
    distances_m.sort_by(f64::total_cmp);
    distances_m.dedup();
    distances_m
}

/// Triangles that are drawn over the walk, each metre counted alike, and the largest difference; none if a
/// distance has no row, or there is but one.
fn over_walk(rows: &[Row], tree: &str, case: DistanceCase) -> Option<(f64, f64)> {
    let walk = walk_of(rows, tree);
    let (mut sum, mut largest) = (0.0, 0.0_f64);
    for (k, distance_m) in walk.iter().enumerate() {
        let row = drawn(rows, tree, case, *distance_m)?;
        let end = walk.get(k + 1).unwrap_or(distance_m);
        sum += row.triangles_final as f64 * (end - distance_m);
        largest = largest.max(difference_of(row));
    }
    match walk[..] {
        [first, .., last] => Some((sum / (last - first), largest)),
        _ => None,
    }
}

/// A line for each tree: triangles over the walk. Nothing if no tree has all its rows.
pub(crate) fn walks(rows: &[Row]) -> Option<Table> {
    let mut table = Table::new(&[
        "tree",
        "triangles",
        "metres",
        "for the distances",
        "most",
        "meshes alone",
        "most",
        "fixed shares",
        "most",
        "times the fixed shares'",
    ]);
    for tree in trees(rows) {
        let of = |case| over_walk(rows, tree, case);
        let (ours, fixed) = (
            of(DistanceCase::ForDistances),
            of(DistanceCase::FixedShares),
        );
        let original = rows.iter().filter(|row| row.tree == tree);
        let original = original.filter_map(|row| row.seen_from).next_back();
        if let (Some((ours, our_most)), Some((fixed, fixed_most)), Some(seen)) =
            (ours, fixed, original)
        {
            let meshes = of(DistanceCase::MeshesForDistances);
            table.push(vec![
                tree.to_owned(),
                seen.triangles_original.to_string(),
                of_range(&walk_of(rows, tree)),
                format!("{ours:.0}"),
                format!("{our_most:.3}"),
                meshes.map_or(String::new(), |(triangles, _)| format!("{triangles:.0}")),
                meshes.map_or(String::new(), |(_, most)| format!("{most:.3}")),
                format!("{fixed:.0}"),
                format!("{fixed_most:.3}"),
                format!("{:.2}", ours / fixed),
            ]);
        }
    }
    (!table.body.is_empty()).then_some(table)
}

/// From where to where a walk goes, in metres.
fn of_range(walk: &[f64]) -> String {
    match walk {
        [first, .., last] => format!("{first} to {last}"),
        _ => String::new(),
    }
}

/// A title and a table: triangles over the walk, then what each tree shows at each distance.
pub(crate) fn tables(rows: &[Row]) -> Vec<(String, Table)> {
    let walk = walks(rows).map(|table| {
        let title = "Triangles drawn over the walk, and the largest difference";
        (title.to_owned(), table)
    });
    let of_tree = |tree: &str| (format!("{tree} at each distance"), at_distances(rows, tree));
    walk.into_iter()
        .chain(trees(rows).into_iter().map(of_tree))
        .collect()
}

fn at_distances(rows: &[Row], tree: &str) -> Table {
    let mut table = Table::new(&[
        "metres",
        "pixels high",
        "for the distances",
        "difference",
        "meshes alone",
        "difference",
        "fixed shares",
        "difference",
        "crossed planes",
        "difference",
        "mesh of as many",
        "difference",
    ]);
    for distance_m in walk_of(rows, tree) {
        let of = |case| drawn(rows, tree, case, distance_m);
        let cases = [
            DistanceCase::ForDistances,
            DistanceCase::MeshesForDistances,
            DistanceCase::FixedShares,
            DistanceCase::Impostor,
            DistanceCase::MeshOfSameCost,
        ];
        let Some(seen) = cases
            .iter()
            .find_map(|case| of(*case))
            .and_then(|row| row.seen_from)
        else {
            continue;
        };
        let mut cells = vec![distance_m.to_string(), format!("{:.0}", seen.pixels_high)];
        for case in cases {
            let row = of(case);
            cells.push(row.map_or(String::new(), |row| row.triangles_final.to_string()));
            cells.push(row.map_or(String::new(), |row| format!("{:.3}", difference_of(row))));
        }
        table.push(cells);
    }
    table
}

#[cfg(test)]
mod tests {
    use super::super::DISTANCES_M;
    use super::super::tests::seen;
    use super::*;
    use crate::rows::tests::row;
    use crate::{Study, readme};

    /// 40 triangles for 5 m and for 10, then 20 for 20 m and 10 for 40 m; 80 m is the end.
    fn walk() -> Vec<Row> {
        let ours = [(40, 0.05), (40, 0.04), (20, 0.05), (10, 0.03), (1, 0.01)];
        let ours = DISTANCES_M.iter().zip(ours);
        let ours = ours
            .map(|(d, (triangles, most))| seen(DistanceCase::ForDistances, *d, triangles, most));
        let fixed = DISTANCES_M.map(|d| seen(DistanceCase::FixedShares, d, 50, 0.02));
        ours.chain(fixed).collect()
    }

    #[test]
    fn each_metre_of_a_walk_counts_alike() {
        let rows = walk();
        let table = walks(&rows).unwrap();
        // (5 x 40 + 10 x 40 + 20 x 20 + 40 x 10) / 75.
        let expected = [
            "oak", "1000", "5 to 80", "19", "0.050", "", "", "50", "0.020", "0.37",
        ];
        assert_eq!(table.body, [expected]);
        assert!(walks(&rows[..9]).is_none(), "a distance has no row");
        // A later walk counts, and goes no farther than it went.
        let mut rows = rows;
        for (distance_m, triangles) in [(10.0, 9), (20.0, 1)] {
            let mut row = seen(DistanceCase::ForDistances, distance_m, triangles, 0.01);
            row.setting = format!("distances 10,20 at {distance_m} m");
            rows.push(row);
        }
        let line = &walks(&rows).unwrap().body[0];
        assert_eq!(line[2..4], ["10 to 20", "9"]);
    }

    #[test]
    fn a_distance_has_a_line_with_what_there_is() {
        let mut rows = walk();
        rows.push(seen(DistanceCase::Impostor, 20.0, 8, 0.5));
        let tables = tables(&rows);
        assert_eq!(tables.len(), 2);
        let line = &tables[1].1.body[2];
        let expected = [
            "20", "270", "20", "0.050", "", "", "50", "0.020", "8", "0.500", "", "",
        ];
        assert_eq!(line[..], expected);
        // A later run of the same name counts.
        rows.push(seen(DistanceCase::Impostor, 20.0, 12, 0.4));
        assert_eq!(super::tables(&rows)[1].1.body[2][8], "12");
    }

    /// What is drawn at a distance is no level of leaves.
    #[test]
    fn rows_at_distances_have_tables_of_their_own() {
        let mut rows = walk();
        let text = |rows: &[Row]| {
            readme(&Study {
                rows,
                failure_cases: &[],
                paper: None,
            })
        };
        let alone = text(&rows);
        assert!(
            alone.contains("| oak | 1000 | 5 to 80 | 19 |") && !alone.contains("of the leaves:")
        );
        rows.push(row("vds", 0.5, 1.0, 1.0));
        let both = text(&rows);
        assert!(both.contains("## 50 % of the leaves") && !both.contains("## 100 %"));
        assert!(!both.contains("Levels are shares of the leaves, but"));
        rows.drain(..10);
        assert!(!text(&rows).contains("walk"));
    }
}
