//! A study from its options to its report.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use secateur_eval::JudgingViews;
use secateur_gltf::{Selector, Tree};
use secateur_model::Memory;

use crate::distances::{self, Walk};
use crate::draw::{DrawnFiles, draw};
use crate::files::make_folder;
use crate::job::{Finished, Job, jobs, lacks_frames, lacks_original_picture};
use crate::judge::LevelJudge;
use crate::lock::Lock;
use crate::row_file::{self, RowFile};
use crate::subject::{Subject, subjects};
use crate::timed::runs;
use crate::tree_hash::tree_sha256;
use crate::walk::WalkJob;
use crate::whole::{self, Gltfpack, WholeJob};
use crate::{Case, Error, Host, Identity, Plan, Row, current_rows};

/// What a study is asked to do.
#[derive(Clone, Debug)]
pub struct StudyOptions {
    /// Trees of the user's, .glb or .gltf.
    pub trees: Vec<PathBuf>,
    /// Where rows, charts and report are; rows that are there are not run again.
    pub folder: PathBuf,
    /// What is foliage in the user's trees.
    pub selectors: Vec<Selector>,
    /// The plans whose cases are run, each case once.
    pub plans: Vec<Plan>,
    /// What is run instead of plans, if there is any.
    pub cases: Vec<Case>,
    /// Which views judge every tree; none for those that suit each plan.
    pub views: Option<JudgingViews>,
    /// Shares from 0 to 1; none for those that suit each tree.
    pub levels: Vec<f64>,
    /// The distances of [`Plan::Scene`] in units of the files (metres), rising; none for 5, 10, 20, 40 and 80.
    pub distances_m: Vec<f64>,
    /// The names of the trees that are studied, of all those; none for all.
    pub only: Vec<String>,
    /// Up to which width pictures as drawn are judged over frames too, in pixels: [`FRAMES_UP_TO_PX`](crate::FRAMES_UP_TO_PX), or
    /// the largest of [`DRAWN_WIDTHS_PX`](crate::DRAWN_WIDTHS_PX), which takes longer than all other judging. Rows that lack
    /// such frames are run anew.
    pub frames_up_to_px: u32,
    /// How many seeds of cases that draw lots.
    pub seeds: u32,
    /// How much memory each tree and what is made of it may take.
    pub memory: Memory,
}

/// Runs what is missing, then draws everything from the rows.
///
/// # Errors
/// [`Error`]; rows that are finished by then are kept.
pub fn run(options: &StudyOptions, host: &dyn Host) -> Result<DrawnFiles, Error> {
    let subjects = subjects(options)?;
    if !options.folder.exists() {
        // Not even a folder is left behind by a study that can't begin.
        subjects
            .iter()
            .try_for_each(|s| s.check(&options.selectors, options.memory))?;
    }
    make_folder(&options.folder)?;
    let _lock = Lock::take(&options.folder)?;
    run_all(options, &subjects, host).map_err(|error| match host.is_stop_asked() {
        false => error,
        true => Error::Stopped(options.folder.clone()),
    })?;
    draw_rows(&options.folder, host)
}

/// Draws charts and report from the rows of a folder again.
///
/// # Errors
/// [`Error`] if there are no rows, or a file can't be read or written.
pub fn redraw(folder: &Path, host: &dyn Host) -> Result<DrawnFiles, Error> {
    let _lock = match folder.exists() {
        true => Some(Lock::take(folder)?),
        false => None,
    };
    draw_rows(folder, host)
}

fn draw_rows(folder: &Path, host: &dyn Host) -> Result<DrawnFiles, Error> {
    draw(folder, &current_rows(row_file::read(folder)?), host)
}

/// What is to be done about a tree.
struct Todo<'a> {
    subject: &'a Subject,
    identity: Identity,
    jobs: Vec<Job<'a>>,
    whole_jobs: Vec<WholeJob>,
    /// Whether rows at the distances of a walk are missing.
    lacks_distances: bool,
    lacks_original_picture: bool,
}

impl Todo<'_> {
    fn is_nothing(&self) -> bool {
        self.jobs.is_empty()
            && self.whole_jobs.is_empty()
            && !self.lacks_distances
            && !self.lacks_original_picture
    }

    /// Whether what is to be done draws the picture of the original, without any run on leaves.
    fn is_of_whole_plants(&self) -> bool {
        self.jobs.is_empty() && (!self.whole_jobs.is_empty() || self.lacks_distances)
    }

    fn row_count(&self, options: &StudyOptions) -> usize {
        let of_jobs: usize = self.jobs.iter().map(|job| job.levels.len()).sum();
        let of_distances = match self.lacks_distances {
            true => distances::row_count(options),
            false => 0,
        };
        of_jobs + self.whole_jobs.len() + of_distances
    }
}

fn run_all(options: &StudyOptions, subjects: &[Subject], host: &dyn Host) -> Result<(), Error> {
    let provenance = host.provenance();
    let rows = row_file::read(&options.folder)?;
    let finished: Finished = rows.iter().map(|row| (row.key(), row)).collect();
    let gltfpack = gltfpack(subjects);
    let mut todo = Vec::new();
    for subject in subjects {
        if host.is_stop_asked() {
            return Err(Error::Stopped(options.folder.clone()));
        }
        subject.prepare(host)?;
        let sha256 = tree_sha256(&subject.path, options.memory)?;
        let identity = Identity::new(
            &subject.name,
            &sha256,
            &provenance,
            subject.judged_by,
            subject.judged_leaves,
        );
        todo.push(Todo {
            jobs: jobs(options, subject, &identity, &finished),
            whole_jobs: whole::jobs(options, subject, &identity, &finished, gltfpack.is_some()),
            lacks_distances: distances::is_missing(options, subject, &identity, &finished),
            lacks_original_picture: lacks_original_picture(&identity, &finished, &options.folder),
            subject,
            identity,
        });
    }
    for of_tree in todo.iter().filter(|of_tree| !of_tree.is_nothing()) {
        of_tree.subject.check(&options.selectors, options.memory)?;
    }
    let woods = WalkJob::missing(options, &provenance, &finished)?;
    let of_woods = woods.iter().map(|job| job.identity.clone());
    let of_trees = todo.iter().map(|t| t.identity.clone());
    let studied: BTreeSet<Identity> = of_trees.chain(of_woods).collect();
    let mut file = RowFile::after(&rows, &studied, &options.folder, host)?;
    let of_trees: usize = todo.iter().map(|t| t.row_count(options)).sum();
    host.begin(of_trees + woods.iter().len() * WalkJob::ROWS);
    let bench = whole::Bench {
        options,
        gltfpack: gltfpack.as_ref(),
        finished: &finished,
        host,
    };
    let walk = Walk {
        options,
        finished: &finished,
        host,
    };
    for of_tree in todo.iter().filter(|of_tree| !of_tree.is_nothing()) {
        let path = &of_tree.subject.path;
        run_tree(options, of_tree, &finished, &mut file, host).map_err(|e| e.about(path))?;
        let whole = bench.run(
            of_tree.subject,
            &of_tree.identity,
            &of_tree.whole_jobs,
            &mut file,
        );
        whole.map_err(|e| e.about(path))?;
        if of_tree.lacks_distances {
            let walked = walk.run(of_tree.subject, &of_tree.identity, &mut file);
            walked.map_err(|e| e.about(path))?;
        }
    }
    if let Some(job) = &woods {
        job.run(options, &finished, &mut file, host)?;
    }
    host.end();
    Ok(())
}

/// gltfpack, if a plan wants it; without it the plan goes on.
fn gltfpack(subjects: &[Subject]) -> Option<Gltfpack> {
    if !subjects.iter().any(|subject| subject.is_seen_whole) {
        return None;
    }
    let found = Gltfpack::find();
    if found.is_none() {
        tracing::warn!(
            "no gltfpack is on the PATH, so whole plants are not held against it: `npm install -g gltfpack` fetches it"
        );
    }
    found
}

fn run_tree(
    options: &StudyOptions,
    todo: &Todo<'_>,
    finished: &Finished<'_>,
    file: &mut RowFile,
    host: &dyn Host,
) -> Result<(), Error> {
    if todo.is_of_whole_plants() {
        // The original is drawn with the whole plants.
        return Ok(());
    }
    let selectors = todo.subject.selectors(&options.selectors);
    let tree = Tree::open_within(&todo.subject.path, selectors, options.memory)?;
    let counted = todo.subject.judged_leaves.of(tree.foliage());
    let judge = LevelJudge::new(todo.subject, &tree, &counted, &todo.identity, options, host)?;
    for job in &todo.jobs {
        let case = job.run.case;
        host.working_on(&format!(
            "{}: {} {}",
            todo.subject.name,
            case.method(),
            case.setting()
        ));
        for ran in runs(&tree, job, host)? {
            if host.is_stop_asked() {
                return Err(Error::Stopped(options.folder.clone()));
            }
            let row: Row = judge.row(job.run, &ran)?;
            // Where only its pictures were gone the row stays as it was, with its time.
            let known = finished.get(&row.key());
            if known.is_none_or(|known| lacks_frames(known, options)) {
                file.append(&row)?;
            }
            host.row_is_done();
        }
    }
    Ok(())
}
