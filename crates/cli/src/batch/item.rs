//! An item of a batch: a plant, what is to be made of it, and the key that names the result.

use std::path::{Path, PathBuf};

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::super::args::{Cli, Command, Lods};
use super::super::failure::Failure;
use super::super::lods;
use super::super::record::SCHEMA_VERSION;

/// A plant, and what is to be made of it: a line of `secateur batch plan`.
#[derive(Clone, Debug, Deserialize, Serialize, JsonSchema)]
pub(crate) struct Item {
    pub(super) schema_version: u32,
    /// SHA-256 of the plant's files, the options and the program.
    pub(super) key: String,
    /// Path of the plant's file as the call gives it.
    pub(super) input: PathBuf,
    /// The folder of the batch; the result is its folder KEY.
    pub(super) output: PathBuf,
    /// Options of `secateur lods`.
    pub(super) options: Vec<String>,
}

impl Item {
    /// The item of a plant.
    pub(super) fn of(
        input: PathBuf,
        output: PathBuf,
        options: Vec<String>,
    ) -> Result<Self, Failure> {
        let mut item = Self {
            schema_version: SCHEMA_VERSION,
            key: String::new(),
            input,
            output,
            options,
        };
        item.key = item.key_now()?;
        Ok(item)
    }

    /// An item as `batch plan` wrote it.
    pub(super) fn parsed(text: &str) -> Result<Self, Failure> {
        let item: Self = serde_json::from_str(text)
            .map_err(|e| Failure::input(format!("the item is no line of `batch plan`: {e}")))?;
        let is_key = item.key.len() == 64 && item.key.bytes().all(|b| b.is_ascii_hexdigit());
        match (item.schema_version == SCHEMA_VERSION, is_key) {
            (true, true) => Ok(item),
            (false, _) => Err(Failure::input(
                "the item was planned by another version of secateur: plan again",
            )),
            (true, false) => Err(Failure::input("the item's key is no SHA-256: plan again")),
        }
    }

    /// What its levels depend on, as it is now.
    pub(super) fn key_now(&self) -> Result<String, Failure> {
        let args = self.args(&self.output)?;
        lods::key_of_first(&args)
    }

    /// The options with which its levels are made into a folder.
    pub(super) fn args(&self, folder: &Path) -> Result<Box<Lods>, Failure> {
        let mut words = vec!["secateur".into(), "lods".into(), self.input.clone()];
        words.extend(["--output".into(), folder.to_owned()]);
        words.extend(self.options.iter().map(PathBuf::from));
        match Cli::of(words).map(|cli| cli.command) {
            Ok(Command::Lods(args)) => Ok(args),
            Ok(other) => unreachable!("lods were asked for, not {other:?}"),
            Err(error) => Err(Failure::of_parser(&error)),
        }
    }

    /// The folder of its result.
    pub(super) fn place(&self) -> PathBuf {
        self.output.join(&self.key)
    }

    /// What says that it could not be done.
    pub(super) fn failed_file(&self) -> PathBuf {
        self.output.join(format!("{}.failed.json", self.key))
    }
}
