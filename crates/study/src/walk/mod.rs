//! A walk through woods along a fixed path, after L-plants: levels by its two schemes and by the branch chain, each
//! frame beside that of full geometry.

mod frames;
mod levels;
mod panorama;
mod scene;
mod table;

use std::path::Path;

use image::{ImageFormat, RgbaImage};
use secateur_eval::{JudgingViews, Panel, contact_sheet};
use serde::{Deserialize, Serialize};

use crate::files::make_folder;
use crate::job::{Finished, lacks_pictures};
use crate::row_file::RowFile;
use crate::rows::millionths;
use crate::{Error, Host, Identity, JudgedLeaves, Plan, Provenance, Row, RowKey, StudyOptions};
use frames::{Case, Drawn, Frame, Outcome, Walker};
use levels::LevelsBy;
use scene::{FRAMES, is_turn};
pub(crate) use table::{WHAT_IS_COMPARED, tables};

/// What rows call the woods.
pub(crate) const NAME: &str = "walk";

/// One frame in ten is kept as a picture: a folder of all 60 would be 10 times as large.
const PICTURE_EVERY: usize = 10;

/// Which frame of a walk a row is of, and what was seen there.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "cli", derive(schemars::JsonSchema))]
pub struct WalkFrame {
    /// Its number, from 0.
    pub frame: u32,
    /// Whether the camera turns, at the end of the path, rather than goes ahead.
    pub is_turn: bool,
    /// Whether plants that are always far off are a panorama behind the others.
    pub has_panorama: bool,
    /// Triangles of full geometry, of the plants in view.
    pub triangles_original: u64,
    /// How many plants have got another level since the frame before.
    pub switches: u64,
    /// FLIP between the frame before and this.
    pub step: Option<f64>,
    /// FLIP between the frame before and this, of full geometry.
    pub step_original: Option<f64>,
    /// FLIP of the frame against itself with the levels of the frame before, where some have switched.
    pub pop: Option<f64>,
}

/// Whether a study is asked for the walk.
pub(crate) fn is_asked_for(options: &StudyOptions) -> bool {
    let has_name = options.only.is_empty() || options.only.iter().any(|name| name == NAME);
    options.cases.is_empty() && options.plans.contains(&Plan::Walk) && has_name
}

/// A walk that is to be made.
pub(crate) struct WalkJob {
    pub(crate) identity: Identity,
}

impl WalkJob {
    /// How many rows it has.
    pub(crate) const ROWS: usize = FRAMES * 2 * LevelsBy::ALL.len();

    /// The walk, if it is asked for and some of its rows or pictures are missing.
    pub(crate) fn missing(
        options: &StudyOptions,
        provenance: &Provenance,
        finished: &Finished<'_>,
    ) -> Result<Option<Self>, Error> {
        if !is_asked_for(options) {
            return Ok(None);
        }
        let sha256 = levels::plants_sha256()?;
        let judged = (JudgingViews::HeldOut, JudgedLeaves::AsInFile);
        let identity = Identity::new(NAME, &sha256, provenance, judged.0, judged.1);
        let is_there = |case: Case, frame| {
            let row = finished.get(&key(&identity, case, frame));
            row.is_some_and(|row| !lacks_pictures(row, &options.folder))
        };
        let is_whole = Case::all().all(|case| (0..FRAMES).all(|frame| is_there(case, frame)));
        Ok((!is_whole).then_some(Self { identity }))
    }

    /// Draws every frame and writes the rows that are missing, and the pictures.
    pub(crate) fn run(
        &self,
        options: &StudyOptions,
        finished: &Finished<'_>,
        file: &mut RowFile,
        host: &dyn Host,
    ) -> Result<(), Error> {
        make_folder(&options.folder.join(NAME))?;
        host.working_on("walk: levels");
        let mut walker = Walker::new()?;
        let panorama = walker.panorama.picture();
        write_png(&panorama, "walk/panorama.png", &options.folder, host)?;
        let leaves = walker.leaves();
        for number in 0..FRAMES {
            host.working_on(&format!("walk: frame {number}"));
            let frame = walker.frame(number);
            if host.is_stop_asked() {
                return Err(Error::Stopped(options.folder.clone()));
            }
            if let Some(path) = picture_of(number) {
                write_png(&sheet(&frame), &path, &options.folder, host)?;
            }
            for of_case in Case::all().zip(&frame.outcomes) {
                let row = self.row(number, &frame, of_case, leaves, host);
                if !finished.contains_key(&row.key()) {
                    file.append(&row)?;
                }
                host.row_is_done();
            }
        }
        Ok(())
    }

    fn row(
        &self,
        number: usize,
        frame: &Frame,
        (case, outcome): (Case, &Outcome),
        leaves: u64,
        host: &dyn Host,
    ) -> Row {
        let key = key(&self.identity, case, number);
        Row {
            method: key.method,
            setting: key.setting,
            leaves_original: leaves,
            leaves_final: outcome.drawn.leaves,
            triangles_final: outcome.drawn.triangles,
            walk: Some(WalkFrame {
                frame: number as u32,
                is_turn: is_turn(number),
                has_panorama: case.has_panorama,
                triangles_original: frame.original.triangles,
                switches: outcome.switches,
                step: outcome.step,
                step_original: frame.step_original,
                pop: outcome.pop,
            }),
            values: [("flip_mean".to_owned(), Some(outcome.flip))].into(),
            command: "secateur study --plan walk -o .".to_owned(),
            picture: picture_of(number).unwrap_or_default(),
            ..Row::blank(&self.identity, host.provenance())
        }
    }
}

fn key(identity: &Identity, case: Case, frame: usize) -> RowKey {
    let [method, setting] = case.by.method_and_setting();
    let panorama = match case.has_panorama {
        true => " panorama",
        false => "",
    };
    RowKey {
        identity: identity.clone(),
        method: method.to_owned(),
        setting: format!("{setting}{panorama} frame {frame:02}"),
        change: String::new(),
        seed: 0,
        level_millionths: millionths(1.0),
    }
}

/// The path of a frame's picture, if it is kept.
fn picture_of(frame: usize) -> Option<String> {
    frame
        .is_multiple_of(PICTURE_EVERY)
        .then(|| format!("walk/frame-{frame:02}.png"))
}

/// Full geometry, then each case, side by side.
fn sheet(frame: &Frame) -> RgbaImage {
    let panel = |title: &str, drawn: &Drawn, more: String| Panel {
        title: title.to_owned(),
        subtitle: format!("{} triangles{more}", drawn.triangles),
        image: drawn.picture.image.clone(),
    };
    let mut panels = vec![panel("full geometry", &frame.original, String::new())];
    for (case, outcome) in Case::all().zip(&frame.outcomes) {
        let [method, setting] = case.by.method_and_setting();
        let panorama = match case.has_panorama {
            true => ", panorama",
            false => "",
        };
        let more = format!(", FLIP {:.3}\n{setting}{panorama}", outcome.flip);
        panels.push(panel(method, &outcome.drawn, more));
    }
    contact_sheet(&panels)
}

fn write_png(image: &RgbaImage, path: &str, folder: &Path, host: &dyn Host) -> Result<(), Error> {
    let mut bytes = std::io::Cursor::new(Vec::new());
    let encoded = image.write_to(&mut bytes, ImageFormat::Png);
    encoded.map_err(|e| Error::Refused(format!("the picture cannot be encoded: {e}")))?;
    let written = host.write_file(&folder.join(path), bytes.get_ref());
    written.map_err(Error::Refused)
}
