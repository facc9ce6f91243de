//! Rules by what they are called: a species, or a rule file of one's own.

use std::borrow::Cow;
use std::fs::File;
use std::io::{self, Read};
use std::path::{Path, PathBuf};

use secateur_model::Plant;

use crate::branch_level::{BranchLevel, BranchLevelOptions};
use crate::grow::{GrowError, grow_rules, plant_of, rules_skeleton};
use crate::language::{Rules, RulesError};
use crate::species::{Species, UnknownSpecies};

/// Rules, and what a plant of them is called.
///
/// ```
/// use secateur_plant::RuleSource;
///
/// let oak = RuleSource::named("oak")?.grow(Some(100), 3)?;
/// assert_eq!(oak.triangles_per_leaf.len(), 100);
/// assert!(RuleSource::named("no-such-tree").is_err());
/// # Ok::<(), secateur_plant::RuleSourceError>(())
/// ```
#[derive(Clone, Debug)]
pub struct RuleSource {
    name: String,
    rules: Cow<'static, Rules>,
    /// The user's own file.
    file: Option<PathBuf>,
}

/// Why there are no rules of a name, or no plant of them.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum RuleSourceError {
    /// There is no such species.
    #[error("{0}; a rule file of your own ends in .lsys")]
    Unknown(UnknownSpecies),
    /// The file can't be read.
    #[error("{}: cannot be read: {source}", .file.display())]
    Read {
        /// The rule file.
        file: PathBuf,
        /// What the operating system says.
        source: io::Error,
    },
    /// The file has more than [`Rules::MAX_BYTES`].
    #[error("{}: a rule file has at most {} bytes", .0.display(), Rules::MAX_BYTES)]
    TooLong(PathBuf),
    /// The file is no text.
    #[error("{}: the rules are not UTF-8 text", .0.display())]
    NotText(PathBuf),
    /// The file breaks the language, or its rules do when they are followed.
    #[error("{}: {source}", .file.display())]
    Rules {
        /// The rule file.
        file: PathBuf,
        /// What is wrong, with its place.
        source: RulesError,
    },
    /// The plant can't be grown.
    #[error(transparent)]
    Grow(#[from] GrowError),
    /// The plant has no such level.
    #[error("{name} has {levels} levels of detail, not {level}")]
    NoLevel {
        /// What the plant is called.
        name: String,
        /// How many levels it has.
        levels: usize,
        /// The number of the level, from 1.
        level: usize,
    },
    /// The plant's branches are too deep for levels.
    #[error("{name}: {source}")]
    TooDeep {
        /// What the plant is called.
        name: String,
        /// Where.
        source: crate::TooDeep,
    },
}

impl RuleSource {
    /// A species by its name, or else a file: what ends in .lsys or has a folder in its name.
    ///
    /// # Errors
    /// [`RuleSourceError`] if there is no such species, or the file is no rule file.
    pub fn named(text: &str) -> Result<Self, RuleSourceError> {
        let file = Path::new(text);
        let is_file =
            file.extension().is_some_and(|e| e == "lsys") || file.components().count() > 1;
        match is_file {
            true => Self::open(file),
            false => {
                let species: Species = text.parse().map_err(RuleSourceError::Unknown)?;
                Ok(Self {
                    name: species.name().to_owned(),
                    rules: Cow::Borrowed(species.rules()),
                    file: None,
                })
            }
        }
    }

    /// The rules in a file, called as the file is without its extension.
    ///
    /// # Errors
    /// [`RuleSourceError`] if it is no rule file.
    pub fn open(file: &Path) -> Result<Self, RuleSourceError> {
        let text = text_of(file)?;
        let rules = Rules::parse(&text).map_err(|source| RuleSourceError::Rules {
            file: file.to_owned(),
            source,
        })?;
        let name = file.file_stem().unwrap_or_default().to_string_lossy();
        Ok(Self {
            name: name.into_owned(),
            rules: Cow::Owned(rules),
            file: Some(file.to_owned()),
        })
    }

    /// What plants of these rules are called.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Grows a plant, as [`grow_rules`] does.
    ///
    /// # Errors
    /// [`RuleSourceError::Grow`], or [`RuleSourceError::Rules`] where the user's own rules can't be followed.
    pub fn grow(&self, leaves: Option<u32>, seed: u64) -> Result<Plant, RuleSourceError> {
        let plant = grow_rules(&self.rules, &self.name, leaves, seed);
        plant.map_err(|error| self.failed(error))
    }

    /// A level of detail of the plant that [`grow`](Self::grow) grows, and what it is.
    ///
    /// # Errors
    /// As [`grow`](Self::grow), [`RuleSourceError::NoLevel`] or [`RuleSourceError::TooDeep`].
    pub fn grow_level(
        &self,
        leaves: Option<u32>,
        seed: u64,
        options: &BranchLevelOptions,
    ) -> Result<(Plant, BranchLevel), RuleSourceError> {
        let (rules, name) = (&*self.rules, &*self.name);
        let skeleton = rules_skeleton(rules, name, leaves, seed);
        let skeleton = skeleton.map_err(|error| self.failed(error))?;
        let (skeleton, level) = options.level(name, &skeleton)?;
        let plant = plant_of(skeleton, rules, name, seed);
        Ok((plant.map_err(|error| self.failed(error))?, level))
    }

    /// Of a rule file it is said where in the file.
    fn failed(&self, error: GrowError) -> RuleSourceError {
        match (&self.file, error) {
            (Some(file), GrowError::Rules { source, .. }) => RuleSourceError::Rules {
                file: file.clone(),
                source,
            },
            (_, error) => error.into(),
        }
    }
}

/// The text of a rule file, of which no more is read than can be one.
fn text_of(file: &Path) -> Result<String, RuleSourceError> {
    let mut bytes = Vec::new();
    let most = Rules::MAX_BYTES as u64 + 1;
    let read = File::open(file).and_then(|opened| opened.take(most).read_to_end(&mut bytes));
    read.map_err(|source| RuleSourceError::Read {
        file: file.to_owned(),
        source,
    })?;
    if bytes.len() > Rules::MAX_BYTES {
        return Err(RuleSourceError::TooLong(file.to_owned()));
    }
    String::from_utf8(bytes).map_err(|_| RuleSourceError::NotText(file.to_owned()))
}
