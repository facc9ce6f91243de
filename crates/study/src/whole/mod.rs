//! Whole plants: wood and leaves under one budget, beside leaves alone and beside gltfpack on the
//! whole file, each at as many triangles, judged by pictures of the whole plant.

mod gltfpack;
mod judge;
mod ours;
mod table;

use std::path::Path;

use secateur_gltf::WholeTree;
use secateur_model::{Memory, Surface};
use serde::{Deserialize, Serialize};

use crate::job::Finished;
use crate::row_file::RowFile;
use crate::rows::millionths;
use crate::subject::Subject;
use crate::{Error, Host, Identity, RowKey, StudyOptions};

pub(crate) use gltfpack::Gltfpack;
use judge::PlantJudge;
pub(crate) use table::{WHAT_IS_COMPARED, tables};

/// The levels that are run if the user names none.
const LEVELS: [f64; 3] = [0.5, 0.25, 0.1];

/// What a row of a whole plant counts beside what other rows do.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "cli", derive(schemars::JsonSchema))]
pub struct WholeCounts {
    /// Triangles of the original, wood and leaves.
    pub triangles_original: u64,
    /// Triangles of wood that are left; unknown of files of other programs.
    pub wood_triangles_final: Option<u64>,
}

/// What makes a level of a whole plant.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum WholeCase {
    /// `simplify --triangles`, as it is by default.
    Auto,
    /// Leaves alone; the wood stays as it was.
    LeavesOnly,
    /// gltfpack on the whole file.
    Gltfpack,
}

impl WholeCase {
    const ALL: [Self; 3] = [Self::Auto, Self::LeavesOnly, Self::Gltfpack];

    /// The method and what is said of it, as rows have them.
    pub(crate) fn method_and_setting(self) -> [&'static str; 2] {
        match self {
            Self::Auto => ["vds", "wood auto"],
            Self::LeavesOnly => ["vds", "wood keep"],
            Self::Gltfpack => ["gltfpack", "sa"],
        }
    }

    fn key(self, identity: &Identity, level: f64) -> RowKey {
        let [method, setting] = self.method_and_setting().map(str::to_owned);
        RowKey {
            identity: identity.clone(),
            method,
            setting,
            change: String::new(),
            seed: 0,
            level_millionths: millionths(level),
        }
    }
}

/// A level that is still to be made.
#[derive(Clone, Copy, Debug)]
pub(crate) struct WholeJob {
    case: WholeCase,
    level: f64,
}

/// What came of one.
struct PlantOutcome {
    surfaces: Vec<Surface>,
    /// As a row's of the same names; 0 leaves in files of other programs, which know none.
    leaves_final: u64,
    wood_triangles_final: Option<u64>,
    seconds: f64,
    peak_rss_bytes: Option<u64>,
    resolution: u32,
    engine: String,
    adapter: Option<String>,
    /// The command that makes it, given a tree.
    command: String,
}

impl PlantOutcome {
    fn triangles(&self) -> u64 {
        count(&self.surfaces)
    }
}

fn count(surfaces: &[Surface]) -> u64 {
    surfaces.iter().map(|s| s.triangles.len() as u64).sum()
}

/// The levels of whole plants that a tree lacks. Without gltfpack its own are not asked for.
pub(crate) fn jobs(
    options: &StudyOptions,
    subject: &Subject,
    identity: &Identity,
    finished: &Finished<'_>,
    has_gltfpack: bool,
) -> Vec<WholeJob> {
    if !subject.is_seen_whole {
        return Vec::new();
    }
    let levels = match options.levels.is_empty() {
        true => &LEVELS[..],
        false => &options.levels,
    };
    let cases = WholeCase::ALL.into_iter();
    let cases = cases.filter(|case| has_gltfpack || *case != WholeCase::Gltfpack);
    cases
        .flat_map(|case| levels.iter().map(move |&level| WholeJob { case, level }))
        .filter(|job| {
            let row = finished.get(&job.case.key(identity, job.level));
            row.is_none_or(|row| crate::job::lacks_pictures(row, &options.folder))
        })
        .collect()
}

/// What the levels of a tree are made with and go to.
pub(crate) struct Bench<'a> {
    pub(crate) options: &'a StudyOptions,
    pub(crate) gltfpack: Option<&'a Gltfpack>,
    pub(crate) finished: &'a Finished<'a>,
    pub(crate) host: &'a dyn Host,
}

impl Bench<'_> {
    /// Makes levels of a tree, judges them and writes their rows. A budget that the wood alone
    /// exceeds has none of leaves alone.
    pub(crate) fn run(
        &self,
        subject: &Subject,
        identity: &Identity,
        jobs: &[WholeJob],
        file: &mut RowFile,
    ) -> Result<(), Error> {
        if jobs.is_empty() {
            return Ok(());
        }
        let (options, host) = (self.options, self.host);
        let path: &Path = &subject.path;
        let tree = open(path, subject, options, options.memory)?;
        let judge = PlantJudge::new(subject, &tree, identity, &options.folder, host)?;
        for job in jobs {
            let [method, setting] = job.case.method_and_setting();
            host.working_on(&format!("{}: {method} {setting}", subject.name));
            let made = match (job.case, self.gltfpack) {
                (WholeCase::Gltfpack, Some(gltfpack)) => {
                    let budget = (job.level * judge.triangles_original as f64).round() as u64;
                    let memory = tree.items().memory_left();
                    Some(gltfpack.made(path, job.level, budget, memory, host)?)
                }
                (WholeCase::Gltfpack, None) => None,
                (case, _) => ours::made(&tree, path, case, job.level, host)?,
            };
            if host.is_stop_asked() {
                return Err(Error::Stopped(options.folder.clone()));
            }
            if let Some(made) = made {
                let row = judge.row(*job, &made)?;
                if !self.finished.contains_key(&row.key()) {
                    file.append(&row)?;
                }
            }
            host.row_is_done();
        }
        Ok(())
    }
}

fn open(
    path: &Path,
    subject: &Subject,
    options: &StudyOptions,
    memory: Memory,
) -> Result<WholeTree, Error> {
    let selectors = subject.selectors(&options.selectors);
    Ok(WholeTree::open_within(path, selectors, memory)?)
}
