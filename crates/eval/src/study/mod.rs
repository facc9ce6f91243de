//! Studies: many runs, judged alike, as raw rows; charts and a report are drawn
//! from the rows alone.
//!
//! Methods and settings are names here: what they stand for only the rows'
//! maker knows.

mod beaten;
mod chart;
mod columns;
mod held_out;
mod published;
mod readme;
mod report;
mod rows;
mod shares;
mod summary;
mod table;
mod trial;
mod which;
mod whole;
mod words;

pub use chart::chart;
pub use columns::{COLUMNS, Column};
pub use published::{Paper, Published};
pub use readme::readme;
pub use report::{Picture, Study, report};
pub use rows::{Row, RowKey, Values, read_rows, to_csv, to_line};
pub use summary::{Group, Point, Spread, groups, overlap, pareto, spread, summarise};
pub use trial::Trial;
