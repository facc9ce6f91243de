//! The levels that are compared on a walk, of every kind of plant in the woods.

use secateur_eval::StandKind;
use secateur_gltf::plant_to_glb;
use secateur_model::Plant;
use secateur_plant::{
    BranchAmount, BranchLevelOptions, BranchMethod, ClusterSize, RuleSource, RuleSourceError,
    Scheme,
};
use sha2::{Digest, Sha256};

use super::scene::{KINDS, RANGES_M, SEED};
use crate::Error;

/// What makes the levels.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum LevelsBy {
    /// Merging by the scheme of L-plants that takes away more at first.
    Halving,
    /// Merging by the one that takes away as much each time.
    Even,
    /// The branch chain of Hybrid, with as large shares of the leaves left as the first scheme leaves of the sticks.
    Chain,
}

impl LevelsBy {
    pub(super) const ALL: [Self; 3] = [Self::Halving, Self::Even, Self::Chain];

    fn scheme(self) -> Scheme {
        match self {
            Self::Halving | Self::Chain => Scheme::halving(),
            Self::Even => Scheme::even(),
        }
    }

    /// The method and what is said of it, as rows have them.
    pub(super) fn method_and_setting(self) -> [&'static str; 2] {
        match self {
            Self::Halving => ["merge", "50-25-12.5-12.5"],
            Self::Even => ["merge", "25-25-25-25"],
            Self::Chain => ["chain", "50-25-12.5-12.5"],
        }
    }

    /// The level for a range, from 1: what `grow --lod` makes.
    fn options(self, number: usize) -> BranchLevelOptions {
        let scheme = self.scheme();
        let left = 1.0 - scheme.shares_gone()[number - 1];
        let (method, amount) = match self {
            Self::Halving | Self::Even => (BranchMethod::Merge, BranchAmount::Level(number)),
            // Where nothing would be left the first branch is.
            Self::Chain if left > 0.0 => (BranchMethod::Chain, BranchAmount::Share(left)),
            Self::Chain => (BranchMethod::Chain, BranchAmount::Level(1)),
        };
        BranchLevelOptions {
            amount,
            method,
            scheme,
            thresholds: None,
            cluster_size: ClusterSize::Paper,
        }
    }
}

/// A plant or a level of it, as it is drawn.
pub(super) struct Drawable {
    pub(super) kind: StandKind,
    pub(super) leaves: u64,
    pub(super) triangles: u64,
}

impl Drawable {
    fn of(plant: Plant) -> Self {
        let surfaces = vec![plant.wood, plant.leaves];
        Self {
            leaves: plant.triangles_per_leaf.len() as u64,
            triangles: surfaces.iter().map(|s| s.triangles.len() as u64).sum(),
            kind: StandKind::new(surfaces),
        }
    }
}

/// Plants of each of [`KINDS`], and their levels.
pub(super) struct Plants {
    pub(super) originals: Vec<Drawable>,
    /// By [`LevelsBy::ALL`], then by kind, then by range.
    levels: Vec<Vec<Vec<Drawable>>>,
}

impl Plants {
    pub(super) fn grow() -> Result<Self, Error> {
        let originals = originals()?.into_iter().map(Drawable::of).collect();
        let of_kind = |by: LevelsBy, kind: usize| -> Result<Vec<Drawable>, Error> {
            let level = |number| level(kind, &by.options(number));
            (1..=RANGES_M.len()).map(level).collect()
        };
        let of_method = |by| (0..KINDS.len()).map(|kind| of_kind(by, kind)).collect();
        let levels: Result<_, Error> = LevelsBy::ALL.into_iter().map(of_method).collect();
        Ok(Self {
            originals,
            levels: levels?,
        })
    }

    /// What stands for a plant of a kind in a range; in none, 0, it is the plant itself.
    pub(super) fn level(&self, by: LevelsBy, kind: usize, range: usize) -> &Drawable {
        match range.checked_sub(1) {
            Some(level) => &self.levels[by as usize][kind][level],
            None => &self.originals[kind],
        }
    }
}

/// The range that something at a distance is in, from 1; nearer than the first it is in none, 0.
pub(super) fn range_at(distance_m: f64) -> usize {
    RANGES_M.partition_point(|begin| *begin <= distance_m)
}

/// SHA-256 of the woods' plants as files, in hexadecimal.
pub(super) fn plants_sha256() -> Result<String, Error> {
    let mut hasher = Sha256::new();
    for plant in originals()? {
        hasher.update(plant_to_glb(&plant));
    }
    Ok(secateur_model::hex(&hasher.finalize()))
}

fn originals() -> Result<Vec<Plant>, Error> {
    let grown = KINDS.iter().map(|kind| {
        let source = RuleSource::named(kind.species.name());
        source.and_then(|source| source.grow(Some(kind.leaves), SEED))
    });
    grown.map(|plant| plant.map_err(refused)).collect()
}

fn level(kind: usize, options: &BranchLevelOptions) -> Result<Drawable, Error> {
    let kind = &KINDS[kind];
    let source = RuleSource::named(kind.species.name()).map_err(refused)?;
    let level = source.grow_level(Some(kind.leaves), SEED, options);
    Ok(Drawable::of(level.map_err(refused)?.0))
}

fn refused(error: RuleSourceError) -> Error {
    Error::Refused(error.to_string())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_range_begins_where_it_says() {
        let found = [0.0, 7.9, 8.0, 15.0, 24.0, 32.0, 900.0].map(range_at);
        assert_eq!(found, [0, 0, 1, 1, 3, 4, 4]);
    }

    /// Each level is lighter than the one before, and the scheme that halves is the lighter of the two.
    #[test]
    fn levels_get_lighter_as_their_schemes_say() {
        let plants = Plants::grow().unwrap();
        let triangles = |by, kind, range| plants.level(by, kind, range).triangles;
        for by in LevelsBy::ALL {
            for (kind, range) in (0..KINDS.len()).flat_map(|k| (1..=4).map(move |r| (k, r))) {
                assert!(triangles(by, kind, range) <= triangles(by, kind, range - 1));
            }
            assert!(triangles(by, 0, 4) < triangles(by, 0, 0) / 10);
        }
        for range in 1..4 {
            assert!(triangles(LevelsBy::Halving, 0, range) < triangles(LevelsBy::Even, 0, range));
        }
    }
}
