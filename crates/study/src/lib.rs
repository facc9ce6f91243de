//! Studies: methods, settings and levels on many trees, each run judged alike and kept as a row;
//! charts and reports are drawn from the rows alone.
//!
//! - [`run()`] runs what a study's folder does not have yet, and draws; [`redraw`] only draws.
//! - A [`Case`] is a method with its options, typed; a [`Plan`] is a list of cases. The setting
//!   that a row names and the command that gives it again are spelled by the case.
//! - [`Row`] is one judged run at one level, as a line of JSON. [`readme()`], [`report()`],
//!   [`to_csv`] and [`chart()`] are made of rows, without the trees.
//! - [`FailureCase`] is a scene made for one failure, [`Paper`] what a paper printed.
//!
//! What a study needs of the program that runs it is a [`Host`]: progress, a wish to stop,
//! writing files, and facts of the machine.

#![forbid(unsafe_code)]

mod as_options;
mod better_rivals;
mod branch_metrics;
mod case;
mod chart;
mod columns;
mod complete_cases;
mod csv;
mod distances;
mod dominance;
mod draw;
mod error;
mod failure_case;
mod fairness;
mod files;
mod flags;
mod format;
mod fsa_time;
mod held_out;
mod host;
mod job;
mod judge;
mod judged_leaves;
mod lead;
mod line_chart;
mod lock;
mod named_cases;
mod older_rows;
mod pages;
mod paper;
mod perturb;
mod plan;
mod published;
mod random;
mod readme;
mod recommend;
mod report;
mod row_file;
mod row_fit;
mod rows;
mod run;
mod scenes;
mod shell;
mod short_names;
mod stability;
mod subject;
mod summary;
mod survivor_bits;
mod table;
mod timed;
mod tree_hash;
mod tree_itself;
mod triangle_levels;
mod walk;
mod whole;

pub use case::{Case, LevelOf};
pub use chart::chart;
pub use columns::{
    COLUMNS, Column, DIFFERENCE_COLUMN, DIFFERENCE_PX, DRAWN_COLUMNS, DRAWN_WIDTHS_PX,
    FRAMES_UP_TO_PX,
};
pub use csv::to_csv;
pub use distances::{DistanceCase, SeenFrom};
pub use draw::DrawnFiles;
pub use error::Error;
pub use failure_case::FailureCase;
pub use host::{Host, Provenance};
pub use judged_leaves::JudgedLeaves;
pub use pages::fill_tables;
pub use perturb::Perturbation;
pub use plan::Plan;
pub use published::{Paper, Published};
pub use readme::readme;
pub use report::{Picture, Study, report};
pub use rows::{Identity, Row, RowKey, Values, current_rows, read_rows, to_line};
pub use run::{StudyOptions, redraw, run};
pub use summary::{Group, Point, Spread, groups, overlap, pareto, spread, summarise};
pub use table::markdown_escaped;
pub use tree_hash::{file_sha256, tree_sha256};
pub use walk::WalkFrame;
pub use whole::WholeCounts;
