//! `secateur schema`: JSON Schemas of the records that commands write.

use clap::ValueEnum;
use schemars::generate::SchemaSettings;
use schemars::{JsonSchema, Schema};
use secateur::Inspection;
use secateur_study::Row;
use serde_json::{Value, json};

use super::args;
use super::batch::Item;
use super::demo::DemoRecord;
use super::failure::Failure;
use super::grow::GrowRecord;
use super::lod::LodRecord;
use super::lods::{FailureRecord, LodsRecord};
use super::measure::MeasureRecord;
use super::names::text;
use super::print::{Printed, Records};
use super::record::Record;
use super::simplify::SimplifyRecord;
use super::stand::StandRecord;
use super::stream::{StreamReadRecord, StreamRecord};
use super::study::StudyRecord;

/// A record of the program.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum RecordName {
    /// A plant of a batch, and what is to be made of it: a line of `batch plan`
    BatchItem,
    /// An oak that was grown, and levels of it: report.json of `demo`
    Demo,
    /// A plant that was grown
    Grow,
    /// What is in a file, and what was taken for foliage and why
    Inspect,
    /// A level along a removal order
    Lod,
    /// The levels of a plant; for each plant a record, one a line
    Lods,
    /// A plant of several that could not be done: in the place of its record of `lods`
    LodsFailure,
    /// How a simplified tree compares with its original
    Measure,
    /// A plant and a level of it
    Simplify,
    /// A scene of many plants, and the level of each: stand.json of `stand`
    Stand,
    /// A stream that was written
    Stream,
    /// The plant of a stream that was read
    StreamRead,
    /// What a study has drawn
    Study,
    /// A run of a study, judged at one level: a line of rows.jsonl
    StudyRow,
}

/// Prints the schema of a record, or which records there are.
pub(crate) fn run(args: &args::Schema) -> Result<Printed, Failure> {
    if let Some(name) = args.name {
        let schema = Value::from(schema(name));
        return Ok(Printed::single(format!("{schema:#}\n"), schema));
    }
    let all = RecordName::value_variants();
    let named = |name: &RecordName| format!("  {:<12} {}\n", text(*name), what(*name));
    let rows = all
        .iter()
        .map(|name| json!({ "name": text(*name), "what": what(*name) }));
    let rows: Vec<Value> = rows.collect();
    Ok(Printed {
        pretty: all.iter().map(named).collect(),
        records: Records::One(json!(rows)),
        rows,
        some_failed: false,
    })
}

/// What a record says, as `--help` has it.
fn what(name: RecordName) -> String {
    let value = name.to_possible_value();
    let help = value.as_ref().and_then(|value| value.get_help());
    help.map(ToString::to_string).unwrap_or_default()
}

fn schema(name: RecordName) -> Schema {
    let mut schema = match name {
        RecordName::BatchItem => of::<Item>(),
        RecordName::Demo => of::<Record<DemoRecord>>(),
        RecordName::Grow => of::<Record<GrowRecord>>(),
        RecordName::Inspect => of::<Record<Inspection>>(),
        RecordName::Lod => of::<Record<LodRecord>>(),
        RecordName::Lods => of::<Record<LodsRecord>>(),
        RecordName::LodsFailure => of::<Record<FailureRecord>>(),
        RecordName::Measure => of::<Record<MeasureRecord>>(),
        RecordName::Simplify => of::<Record<SimplifyRecord>>(),
        RecordName::Stand => of::<Record<StandRecord>>(),
        RecordName::Stream => of::<Record<StreamRecord>>(),
        RecordName::StreamRead => of::<Record<StreamReadRecord>>(),
        RecordName::Study => of::<Record<StudyRecord>>(),
        RecordName::StudyRow => of::<Row>(),
    };
    schema.insert(
        "title".to_owned(),
        json!(format!("secateur {}", text(name))),
    );
    schema.insert("description".to_owned(), json!(what(name)));
    schema
}

/// The schema of what a type is written as.
fn of<T: JsonSchema>() -> Schema {
    let settings = SchemaSettings::draft2020_12().for_serialize();
    settings.into_generator().into_root_schema_for::<T>()
}
