//! Levels as words of the command line ask for them, for other faces of the program. Whoever takes options by these
//! words has the program's names, defaults and refusals.

use super::args::{Cli, Command};
use super::failure::Failure;
use super::{lods, simplify};
use secateur::chain::LevelsOptions;
use secateur::{ErrorKind, LevelOptions, Memory, Surroundings, WoodMode};

/// A level, as options of `secateur simplify` ask for it.
#[derive(Clone, Debug)]
pub struct LevelRequest {
    /// What becomes of the wood, which is decided when a plant is [opened](secateur::Opening::wood).
    pub wood: WoodMode,
    /// How the level is made.
    pub options: LevelOptions,
    /// What stands about the plant.
    pub surroundings: Surroundings,
}

/// Why words ask for nothing that can be made.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{sentence}")]
pub struct RequestError {
    /// Who can help.
    pub kind: ErrorKind,
    /// What is wrong.
    pub sentence: String,
}

/// Options of the program that name files to be written, or say how: other faces write by calls of their own.
const OF_OUTPUT: [&str; 19] = [
    "for",
    "dry-run",
    "output",
    "overwrite",
    "compress",
    "strips",
    "report",
    "picture",
    "order",
    "debug-images",
    "preview",
    "layout",
    "keep-going",
    "format",
    "quiet",
    "verbose",
    "threads",
    "help",
    "version",
];

/// What is decided when a plant is opened, not when its levels are made.
const OF_OPENING: [&str; 4] = ["foliage", "not-plant", "vertex-alpha", "memory"];

impl LevelRequest {
    /// The level of these options, such as `--triangles=0.1`; `memory` is what files of a scene may take.
    ///
    /// # Errors
    /// [`RequestError`] if a word is no option of `simplify` or has a wrong value, or a file of a scene can't be read.
    pub fn of(words: &[String], memory: Memory) -> Result<Self, RequestError> {
        let args = match parsed("simplify", words)?.command {
            Command::Simplify(args) => args,
            other => unreachable!("simplify was asked for, not {other:?}"),
        };
        if let Some(sentence) = simplify::contradiction(&args) {
            return Err(usage(sentence));
        }
        let simplify = simplify::options(&args)?;
        Ok(Self {
            wood: args
                .wood
                .unwrap_or_else(|| LevelOptions::usual_wood(simplify.target)),
            options: simplify::level_options(&args, simplify),
            surroundings: args.scene.read(memory, &[])?,
        })
    }
}

/// Levels, and what stands about the plant: these options of `secateur lods`, such as `--max-difference=0.18`; `memory` is what files of a scene
/// may take.
///
/// # Errors
/// [`RequestError`] if a word is no option of `lods` or has a wrong value, or a file of a scene can't be read.
pub fn levels_options(
    words: &[String],
    memory: Memory,
) -> Result<(LevelsOptions, Surroundings), RequestError> {
    let args = match parsed("lods", words)?.command {
        Command::Lods(args) => args,
        other => unreachable!("lods were asked for, not {other:?}"),
    };
    let surroundings = args.scene.read(memory, &[])?;
    let drawn = args.scene.drawn(&surroundings, memory)?;
    Ok((lods::options(&args), drawn))
}

/// The options of a command that these words give it.
fn parsed(command: &str, words: &[String]) -> Result<Cli, RequestError> {
    for word in words {
        let name = word.strip_prefix("--").unwrap_or(word);
        let name = name.split_once('=').map_or(name, |(name, _)| name);
        if !word.starts_with("--") || OF_OUTPUT.contains(&name) {
            return Err(usage(format!("`{name}` is no option of a level")));
        }
        if OF_OPENING.contains(&name) {
            return Err(usage(format!(
                "`{name}` is decided when the plant is opened"
            )));
        }
    }
    let first = ["secateur", command, "plant.glb", "--output=level.glb"].map(str::to_owned);
    Cli::of(first.iter().chain(words)).map_err(|error| Failure::of_parser(&error).into())
}

fn usage(sentence: String) -> RequestError {
    RequestError {
        kind: ErrorKind::Usage,
        sentence,
    }
}

impl From<Failure> for RequestError {
    fn from(failure: Failure) -> Self {
        Self {
            kind: failure.kind,
            sentence: failure.to_string(),
        }
    }
}
