//! What of a study is still to be run.

use std::collections::BTreeMap;
use std::path::Path;

use crate::columns::{DRAWN_WIDTHS_PX, column};
use crate::files::is_picture;
use crate::rows::millionths;
use crate::subject::Subject;
use crate::{Case, Identity, Row, RowKey, StudyOptions};

/// One case with one seed on one tree, and the levels that are missing.
pub(crate) struct Job<'a> {
    pub(crate) run: StudyRun<'a>,
    pub(crate) levels: Vec<f64>,
}

/// What is run, and the run whose survivors its own are held against.
#[derive(Clone, Copy)]
pub(crate) struct StudyRun<'a> {
    pub(crate) case: &'a Case,
    /// For a case that takes seeds.
    pub(crate) seed: Option<u64>,
    /// The first case of the same method on this tree; with seed 0.
    pub(crate) reference: &'a Case,
}

impl StudyRun<'_> {
    pub(crate) fn is_reference(&self) -> bool {
        std::ptr::eq(self.case, self.reference) && self.seed.unwrap_or(0) == 0
    }

    /// The key of a row that this makes.
    fn key(&self, identity: &Identity, level: f64) -> RowKey {
        RowKey {
            identity: identity.clone(),
            method: self.case.method().to_owned(),
            setting: self.case.setting(),
            change: self.case.perturbation().name(),
            seed: self.seed.unwrap_or(0),
            level_millionths: millionths(level),
        }
    }
}

/// The rows that a folder has, by their keys.
pub(crate) type Finished<'a> = BTreeMap<RowKey, &'a Row>;

/// What is missing of a tree: levels without a row, levels whose pictures are gone, which only
/// another run can draw, and levels that were not judged over all frames that are asked for.
pub(crate) fn jobs<'a>(
    options: &StudyOptions,
    subject: &'a Subject,
    identity: &Identity,
    finished: &Finished<'_>,
) -> Vec<Job<'a>> {
    let mut jobs = Vec::new();
    for case in &subject.cases {
        let of_method = |other: &&Case| other.method() == case.method();
        let reference = subject.cases.iter().find(of_method).unwrap_or(case);
        let seeds: Vec<Option<u64>> = match case.takes_seeds() {
            true => (0..u64::from(options.seeds)).map(Some).collect(),
            false => vec![None],
        };
        for seed in seeds {
            let run = StudyRun {
                case,
                seed,
                reference,
            };
            let mut levels = match options.levels.is_empty() {
                true => subject.levels().to_vec(),
                false => options.levels.clone(),
            };
            levels.retain(|level| {
                let row = finished.get(&run.key(identity, *level));
                row.is_none_or(|row| {
                    lacks_pictures(row, &options.folder) || lacks_frames(row, options)
                })
            });
            if !levels.is_empty() {
                jobs.push(Job { run, levels });
            }
        }
    }
    jobs
}

/// Whether the original's picture is gone of a tree that has rows.
pub(crate) fn lacks_original_picture(
    identity: &Identity,
    finished: &Finished<'_>,
    folder: &Path,
) -> bool {
    let has_rows = finished.keys().any(|key| key.identity == *identity);
    has_rows && !folder.join(identity.original_picture()).is_file()
}

/// Whether a row was judged as drawn, but not over all frames that are asked for.
pub(crate) fn lacks_frames(row: &Row, options: &StudyOptions) -> bool {
    let is_asked_for = |px: &u32| *px <= options.frames_up_to_px;
    let has = |how, px| {
        column(&format!("flip_{how}_{px}"))
            .value_of(row)
            .is_finite()
    };
    let mut widths = DRAWN_WIDTHS_PX.into_iter().filter(is_asked_for);
    widths.any(|px| has("as_drawn", px) && !has("over_frames", px))
}

pub(crate) fn lacks_pictures(row: &Row, folder: &Path) -> bool {
    let mut pictures = [&row.picture, &row.difference].into_iter();
    pictures.any(|path| is_picture(path) && !folder.join(path).is_file())
}
