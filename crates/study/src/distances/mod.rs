//! Plants at the distances of a walk: levels that are made for them beside shares that are the same for
//! every plant, and impostors beside meshes of as many triangles.

mod charts;
mod drawn_levels;
mod judge;
mod table;

use secateur_eval::{Difference, Limits};
use secateur_gltf::WholeTree;
use secateur_raster::OpenEngine;
use serde::{Deserialize, Serialize};

use crate::job::Finished;
use crate::judge::in_folder;
use crate::row_file::RowFile;
use crate::rows::millionths;
use crate::subject::Subject;
use crate::{Error, Host, Identity, Row, RowKey, StudyOptions};

pub(crate) use charts::charts;
use drawn_levels::{LevelSet, Maker};
use judge::{DistanceJudge, Place};
pub(crate) use table::{WHAT_IS_COMPARED, tables, walks};

/// The walk that is made if the user names none, away from a plant along a straight line: where levels may
/// begin, in metres.
const DISTANCES_M: [f64; 5] = [5.0, 10.0, 20.0, 40.0, 80.0];

/// The shares of all triangles that levels for no distance have if the user names none.
const SHARES: [f64; 3] = [0.5, 0.25, 0.1];

/// Keys of the values that rows at distances have.
const DIFFERENCE: &str = "difference";
const BLOCK_COVERAGE: &str = "block_coverage";

/// No share is asked for of what is made for a distance.
const NO_LEVEL: f64 = 1.0;

/// How many rows a tree gets, if a mesh can be made as light as each impostor.
pub(crate) fn row_count(options: &StudyOptions) -> usize {
    DistanceCase::ALL.len() * WalkPlan::of(options).distances_m.len()
}

/// What is made of every tree.
struct WalkPlan {
    /// Distances to judge at, in metres, rising.
    distances_m: Vec<f64>,
    /// The shares of levels for no distance, the finest first.
    shares: Vec<f64>,
}

impl WalkPlan {
    fn of(options: &StudyOptions) -> Self {
        let mut shares = options.levels.clone();
        shares.sort_by(|a, b| b.total_cmp(a));
        shares.dedup();
        Self {
            distances_m: match options.distances_m.is_empty() {
                true => DISTANCES_M.to_vec(),
                false => options.distances_m.clone(),
            },
            shares: match shares.is_empty() {
                true => SHARES.to_vec(),
                false => shares,
            },
        }
    }
}

/// From where a row's plant is seen, and what is drawn there.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "cli", derive(schemars::JsonSchema))]
pub struct SeenFrom {
    /// Which kind of level stands for the plant.
    pub case: DistanceCase,
    /// How far off it is, in metres.
    pub distance_m: f64,
    /// How many pixels high a screen of 1080 pixels and 60 degrees shows it.
    pub pixels_high: f64,
    /// Triangles of the original, wood and leaves.
    pub triangles_original: u64,
}

/// What is drawn of a plant at a distance.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "cli", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
#[non_exhaustive]
pub enum DistanceCase {
    /// The level that `lods --distances` has there.
    ForDistances,
    /// The level that `lods --distances --impostor none` has there.
    MeshesForDistances,
    /// The coarsest level of fixed shares that differs no more than may be.
    FixedShares,
    /// A mesh of as many triangles as the impostor.
    MeshOfSameCost,
    /// Crossed planes with pictures of the plant.
    Impostor,
}

impl DistanceCase {
    /// In the order of running: the impostor's row says that its mesh was tried.
    const ALL: [Self; 5] = [
        Self::ForDistances,
        Self::MeshesForDistances,
        Self::FixedShares,
        Self::MeshOfSameCost,
        Self::Impostor,
    ];

    /// The method and what is said of it, as rows have them.
    fn method_and_setting(self, plan: &WalkPlan, distance_m: f64) -> [String; 2] {
        let (method, what) = match self {
            Self::ForDistances => ("lods", format!("distances {}", joined(&plan.distances_m))),
            Self::MeshesForDistances => (
                "lods",
                format!("distances {} impostor none", joined(&plan.distances_m)),
            ),
            Self::FixedShares => ("lods", format!("levels {}", joined(&plan.shares))),
            Self::MeshOfSameCost => ("vds", "triangles of the impostor".to_owned()),
            Self::Impostor => ("lods", "impostor crossed".to_owned()),
        };
        [method.to_owned(), format!("{what} at {distance_m} m")]
    }

    fn key(self, identity: &Identity, plan: &WalkPlan, distance_m: f64) -> RowKey {
        let [method, setting] = self.method_and_setting(plan, distance_m);
        RowKey {
            identity: identity.clone(),
            method,
            setting,
            change: String::new(),
            seed: 0,
            level_millionths: millionths(NO_LEVEL),
        }
    }
}

/// Numbers with commas between them, as options have them.
fn joined(numbers: &[f64]) -> String {
    let words: Vec<String> = numbers.iter().map(f64::to_string).collect();
    words.join(",")
}

/// Whether there can be levels for the distances and of the shares that are asked for.
pub(crate) fn check(options: &StudyOptions) -> Result<(), Error> {
    let plan = WalkPlan::of(options);
    drawn_levels::check(&plan.distances_m, &plan.shares)
}

/// Whether rows of a tree at the distances are missing. There may be no mesh as light as an impostor.
pub(crate) fn is_missing(
    options: &StudyOptions,
    subject: &Subject,
    identity: &Identity,
    finished: &Finished<'_>,
) -> bool {
    let plan = WalkPlan::of(options);
    let is_there = |case: DistanceCase, distance_m: &f64| {
        finished.contains_key(&case.key(identity, &plan, *distance_m))
    };
    let needed = (DistanceCase::ALL.into_iter()).filter(|c| *c != DistanceCase::MeshOfSameCost);
    let are_there = |case| (plan.distances_m.iter()).all(|distance_m| is_there(case, distance_m));
    subject.is_seen_from_distances && !needed.into_iter().all(are_there)
}

/// What is drawn at a distance, and how far it looks from the original.
struct Drawn {
    case: DistanceCase,
    leaves: u64,
    triangles: u64,
    difference: Difference,
    /// What it took to make it and, of a chain, all other levels.
    seconds: f64,
    /// The command that makes it again, given in the folder of the program's call.
    command: String,
}

/// What the rows of a tree at the distances are made with and go to.
pub(crate) struct Walk<'a> {
    pub(crate) options: &'a StudyOptions,
    pub(crate) finished: &'a Finished<'a>,
    pub(crate) host: &'a dyn Host,
}

impl Walk<'_> {
    /// Makes what is drawn of a tree at each distance, judges it, and writes the rows that are missing.
    pub(crate) fn run(
        &self,
        subject: &Subject,
        identity: &Identity,
        file: &mut RowFile,
    ) -> Result<(), Error> {
        let (options, host) = (self.options, self.host);
        let selectors = subject.selectors(&options.selectors);
        let tree = WholeTree::open_within(&subject.path, selectors, options.memory)?;
        let judge = DistanceJudge::new(&tree, identity, &options.folder, host)?;
        let mut maker = Maker::new(&tree, &subject.path, host)?;
        let plan = WalkPlan::of(options);
        host.working_on(&format!("{}: levels for distances", subject.name));
        let for_distances = maker.for_distances(&plan.distances_m)?;
        let meshes = maker.meshes_for_distances(&plan.distances_m)?;
        host.working_on(&format!("{}: levels of fixed shares", subject.name));
        let of_shares = maker.of_shares(&plan.shares)?;
        for &distance_m in &plan.distances_m {
            host.working_on(&format!("{}: at {distance_m} m", subject.name));
            let place = judge.at(distance_m);
            let ours = maker.level_for(&for_distances, DistanceCase::ForDistances, &place);
            let meshes = maker.level_for(&meshes, DistanceCase::MeshesForDistances, &place);
            let most_over = ours.difference.over(Limits::GOOD).max(1.0);
            let fixed = maker.coarsest(&of_shares, &place, most_over)?;
            let mut all = vec![ours, meshes, fixed];
            all.extend(maker.impostor_and_mesh(&place)?);
            if host.is_stop_asked() {
                return Err(Error::Stopped(options.folder.clone()));
            }
            for drawn in all {
                let row = self.row((&tree, &maker.engine), identity, &plan, &place, &drawn);
                if !self.finished.contains_key(&row.key()) {
                    file.append(&row)?;
                }
                host.row_is_done();
            }
        }
        Ok(())
    }

    fn row(
        &self,
        (tree, engine): (&WholeTree, &OpenEngine),
        identity: &Identity,
        plan: &WalkPlan,
        place: &Place<'_>,
        drawn: &Drawn,
    ) -> Row {
        let [method, setting] = drawn.case.method_and_setting(plan, place.distance_m);
        let Difference {
            difference,
            block_coverage,
            ..
        } = drawn.difference;
        let values = [(DIFFERENCE, difference), (BLOCK_COVERAGE, block_coverage)];
        let (leaves, wood) = (tree.leaves(), tree.wood());
        Row {
            method,
            setting,
            leaves_original: leaves.leaves().len() as u64,
            leaves_final: drawn.leaves,
            triangles_final: drawn.triangles,
            seen_from: Some(SeenFrom {
                case: drawn.case,
                distance_m: place.distance_m,
                pixels_high: place.pixels_high,
                triangles_original: (leaves.triangles().len() + wood.triangles().len()) as u64,
            }),
            seconds: drawn.seconds,
            values: values
                .map(|(key, value)| (key.to_owned(), Some(value)))
                .into(),
            engine: engine.name().to_owned(),
            adapter: engine.adapter(),
            command: in_folder(&drawn.command, &self.options.folder),
            ..Row::blank(identity, self.host.provenance())
        }
    }
}

impl LevelSet {
    /// The level to be drawn at a distance: the last that has begun there, but not before the first.
    fn begun_at(&self, distance_m: f64) -> usize {
        // What is computed from a height in pixels may be a little farther off.
        let has_begun = |begin: &f64| *begin <= distance_m * (1.0 + 1e-6);
        let begun = self.begins_m.iter().rposition(has_begun);
        begun.unwrap_or(0)
    }
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;
    use crate::rows::tests::row;

    /// A row of what is drawn at a distance.
    pub(crate) fn seen(
        case: DistanceCase,
        distance_m: f64,
        triangles: u64,
        difference: f64,
    ) -> Row {
        let plan = WalkPlan {
            distances_m: DISTANCES_M.to_vec(),
            shares: SHARES.to_vec(),
        };
        let [method, setting] = case.method_and_setting(&plan, distance_m);
        let mut row = row(&method, NO_LEVEL, 1.0, 1.0);
        row.setting = setting;
        row.triangles_final = triangles;
        row.values = [(DIFFERENCE.to_owned(), Some(difference))].into();
        row.seen_from = Some(SeenFrom {
            case,
            distance_m,
            pixels_high: 5400.0 / distance_m,
            triangles_original: 1000,
        });
        row
    }

    /// Rows of one tree that are drawn at several distances, in several ways, are all kept.
    #[test]
    fn every_case_and_distance_has_a_key_of_its_own() {
        let all = DistanceCase::ALL
            .iter()
            .flat_map(|case| DISTANCES_M.map(|d| seen(*case, d, 9, 0.1)));
        let text: String = all.map(|row| crate::to_line(&row)).collect();
        let rows = crate::read_rows(&text).unwrap();
        assert_eq!(rows.len(), 25);
        let setting = |k: usize| rows[k].label();
        assert_eq!(setting(0), "lods distances 5,10,20,40,80 at 5 m");
        assert_eq!(
            setting(9),
            "lods distances 5,10,20,40,80 impostor none at 80 m"
        );
        assert_eq!(setting(14), "lods levels 0.5,0.25,0.1 at 80 m");
    }

    #[test]
    fn a_level_is_drawn_from_where_it_begins() {
        let set = LevelSet::with_begins(&[5.0, 20.0 * (1.0 + 1e-12), 80.0]);
        let found = [1.0, 5.0, 10.0, 20.0, 79.0, 900.0].map(|d| set.begun_at(d));
        assert_eq!(found, [0, 0, 0, 1, 1, 2]);
    }
}
