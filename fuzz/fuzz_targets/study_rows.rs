//! Whatever the rows of a study, they end in its tables, charts and report, or in an error. An input is a row, or rows in
//! lines; mutations know the JSON of one.

#![no_main]

use libfuzzer_sys::{fuzz_mutator, fuzz_target};
use secateur_study::{
    COLUMNS, Row, Study, chart, current_rows, read_rows, readme, report, summarise, to_csv,
};

fuzz_target!(|text: &str| {
    let Ok(rows) = read_rows(&format!("{text}\n")) else {
        return;
    };
    let rows = current_rows(rows);
    if rows.is_empty() {
        return;
    }
    let _ = to_csv(&rows);
    let study = Study {
        rows: &rows,
        failure_cases: &[],
        paper: None,
    };
    let _ = readme(&study);
    let _ = report(&study, &[]);
    let all: Vec<&Row> = rows.iter().collect();
    for column in COLUMNS.iter() {
        let _ = chart(&summarise(&all, column), column, "title");
    }
});

fuzz_mutator!(|data: &mut [u8], size: usize, max_size: usize, seed: u32| {
    secateur_fuzz::mutate_gltf(data, size, max_size, seed)
});
