//! Parts of a plant with a level of their own: bark as fine as it is, say, and leaves at a tenth.
//!
//! Each part is made lighter as a plant of its own that all others hide, as they were; what is left of all of them
//! is the level.

use std::fmt;
use std::str::FromStr;
use std::sync::Arc;

use secateur_gltf::{Selector, Tree};
use secateur_model::{Foliage, LeafId, Lod, PlantSkeleton};
use secateur_raster::OpenEngine;
use secateur_simplify::whole::{WholeLevel, WholePlant, WoodMode, simplify_keeping_wood};
use secateur_simplify::{
    Error as SimplifyError, Observer, Options, Simplified, Target, simplify_on,
};
use serde::{Deserialize, Serialize};

use crate::Error;

/// Parts of a plant, and the share of their triangles that they keep. Written `material:bark=0.1`.
///
/// ```
/// use secateur::PartLevel;
///
/// let bark: PartLevel = "material:bark=0.1".parse().unwrap();
/// assert_eq!(bark.to_string(), "material:bark=0.1");
/// assert!("material:bark=2".parse::<PartLevel>().is_err());
/// ```
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "String", into = "String")]
pub struct PartLevel {
    /// What is meant, leaves and wood.
    pub parts: Selector,
    /// The share of its triangles, from 0 to 1.
    pub share: f64,
}

/// Why a text is no [`PartLevel`].
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error(
    "`{0}` is no level of parts; write a selector, = and a share from 0 to 1, such as material:bark=0.1"
)]
pub struct PartLevelError(String);

impl FromStr for PartLevel {
    type Err = PartLevelError;

    fn from_str(text: &str) -> Result<Self, PartLevelError> {
        let error = || PartLevelError(text.to_owned());
        let (parts, share) = text.rsplit_once('=').ok_or_else(error)?;
        let share = share
            .parse()
            .ok()
            .filter(|share| (0.0..=1.0).contains(share));
        Ok(Self {
            parts: parts.parse().map_err(|_| error())?,
            share: share.ok_or_else(error)?,
        })
    }
}

impl fmt::Display for PartLevel {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}={}", self.parts, self.share)
    }
}

impl TryFrom<String> for PartLevel {
    type Error = PartLevelError;

    fn try_from(text: String) -> Result<Self, PartLevelError> {
        text.parse()
    }
}

impl From<PartLevel> for String {
    fn from(level: PartLevel) -> Self {
        level.to_string()
    }
}

/// Which leaves and pieces of wood belong together, and the level that they get: none for the rest's target.
struct Group<'l> {
    level: Option<&'l PartLevel>,
    /// Of leaves, and of wood.
    names: [Vec<LeafId>; 2],
}

/// The parts that each level names, the last one counting, and the rest; groups of nothing are left out.
fn groups<'l>(
    tree: &Tree,
    leaves: usize,
    levels: &'l [PartLevel],
) -> Result<Vec<Group<'l>>, Error> {
    let mut level_of: Vec<Option<usize>> = vec![None; tree.foliage().leaves().len()];
    for (number, level) in levels.iter().enumerate() {
        for item in tree.selected(&level.parts)? {
            level_of[item.index()] = Some(number);
        }
    }
    let group = |number: Option<usize>| {
        let is_of = |item: &usize| level_of[*item] == number;
        let names = |items: std::ops::Range<usize>, first: usize| {
            let items = items.filter(is_of);
            items.map(|item| LeafId::from_index(item - first)).collect()
        };
        Group {
            level: number.map(|number| &levels[number]),
            names: [names(0..leaves, 0), names(leaves..level_of.len(), leaves)],
        }
    };
    let all = (0..levels.len()).map(Some).chain([None]).map(group);
    Ok(all
        .filter(|group| group.names.iter().any(|names| !names.is_empty()))
        .collect())
}

/// These leaves of a foliage, in their order.
fn only(foliage: &Foliage, names: &[LeafId]) -> Foliage {
    let all = Lod::original(names.len());
    Lod::of_parts(foliage.leaves().len(), &[(&all, names)]).foliage(foliage)
}

fn skeleton_of(skeleton: &PlantSkeleton, names: &[LeafId]) -> PlantSkeleton {
    let segment = |leaf: &LeafId| skeleton.leaf_segments.get(leaf.index()).copied().flatten();
    PlantSkeleton {
        segments: skeleton.segments.clone(),
        leaf_segments: names.iter().map(segment).collect(),
    }
}

/// A plant whose parts get levels of their own.
pub(crate) struct Parted<'a> {
    /// Of leaves, and of wood.
    pub(crate) all: [&'a Foliage; 2],
    /// The leaves and pieces of wood as the file has them.
    pub(crate) tree: &'a Tree,
    /// What becomes of wood that no level names.
    pub(crate) mode: WoodMode,
    pub(crate) options: &'a Options,
    pub(crate) engine: &'a OpenEngine,
}

impl Parted<'_> {
    /// What is left of each part. What the run over leaves says is of the group with the most leaves.
    pub(crate) fn level(
        &self,
        levels: &[PartLevel],
        observer: &mut Observer<'_>,
    ) -> Result<WholeLevel, Error> {
        let counts = self.all.map(|foliage| foliage.leaves().len());
        let groups = groups(self.tree, counts[0], levels)?;
        let mut made = Vec::with_capacity(groups.len());
        for group in &groups {
            let level = self.level_of(group, &groups, observer);
            made.push(level.map_err(|source| match group.level {
                Some(level) => Error::Part {
                    parts: level.parts.clone(),
                    source,
                },
                None => Error::Simplify(source),
            })?);
        }
        let joined = [0, 1].map(|which| {
            let parts = groups.iter().zip(&made).map(|(group, level)| {
                let lods = [&level.leaves.lod, &level.wood];
                (lods[which], &group.names[which][..])
            });
            Lod::of_parts(counts[which], &parts.collect::<Vec<_>>())
        });
        let wood_triangles = made.iter().map(|level| level.wood_triangles).sum();
        let warnings = made.iter().flat_map(|level| level.leaves.warnings.clone());
        let warnings = warnings.collect();
        let leaves_of = |(group, _): &(&Group<'_>, WholeLevel)| group.names[0].len();
        let most = groups.iter().zip(made).max_by_key(leaves_of);
        let (_, most) = most.ok_or(SimplifyError::NoLeaf)?;
        let [leaves, wood] = joined;
        Ok(WholeLevel {
            leaves: Simplified {
                lod: leaves,
                warnings,
                ..most.leaves
            },
            wood,
            wood_triangles,
            wood_gone: Vec::new(),
            leaf_gap: most.leaf_gap,
        })
    }

    fn level_of(
        &self,
        group: &Group<'_>,
        groups: &[Group<'_>],
        observer: &mut Observer<'_>,
    ) -> Result<WholeLevel, SimplifyError> {
        let [leaves, wood] = [0, 1].map(|which| only(self.all[which], &group.names[which]));
        let mut options = self.options.clone();
        options.occluders = self.others(group, groups)?;
        let skeleton = options.skeleton.as_deref();
        options.skeleton = skeleton.map(|s| Arc::new(skeleton_of(s, &group.names[0])));
        let counts_triangles = matches!(options.target, Target::Triangles(_));
        match group.level {
            Some(level) => options.target = Target::triangle_share(level.share),
            // Wood alone, and a target of leaves: it stays.
            None if leaves.leaves().is_empty() && !counts_triangles => {
                options.target = Target::triangle_share(1.0);
            }
            None => {}
        }
        if group.level.is_none() && self.mode == WoodMode::Keep {
            let there = leaves.triangles().len() + wood.triangles().len();
            let kept = simplify_keeping_wood(&leaves, &wood, &options, self.engine, observer)?;
            let left = kept.leaves.lod.foliage(&leaves).triangles().len() + kept.wood_triangles;
            options.check_met(left, there)?;
            return Ok(kept);
        }
        if self.mode == WoodMode::Ignore {
            let left = simplify_on(self.engine, &leaves, &options, observer)?;
            let count = left.lod.foliage(&leaves).triangles().len();
            options.check_met(count, leaves.triangles().len())?;
            return Ok(WholeLevel {
                leaves: left,
                wood: Lod::original(0),
                wood_triangles: 0,
                wood_gone: Vec::new(),
                leaf_gap: None,
            });
        }
        let items = leaves.followed_by(&wood)?;
        let plant = WholePlant::within(&items, leaves, wood, &options, self.engine)?;
        plant.simplified(&options, self.engine, observer)
    }

    /// What hides a group: all other parts, and what the options have.
    fn others(
        &self,
        group: &Group<'_>,
        groups: &[Group<'_>],
    ) -> Result<Option<Arc<Foliage>>, SimplifyError> {
        let mut hiding: Option<Foliage> = self.options.occluders.as_deref().cloned();
        for other in groups.iter().filter(|other| !std::ptr::eq(*other, group)) {
            for (all, names) in self.all.iter().zip(&other.names) {
                let part = only(all, names);
                hiding = Some(match hiding {
                    Some(before) => before.followed_by(&part)?,
                    None => part,
                });
            }
        }
        Ok(hiding.map(Arc::new))
    }
}
