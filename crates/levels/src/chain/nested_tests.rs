//! Levels that are nested, and say how one becomes the next.

use std::collections::BTreeSet;

use secateur_gltf::WholeTree;
use secateur_model::LeafId;
use secateur_plant::Species;
use secateur_raster::OpenEngine;

use super::tests::{go_on, grown, options};
use super::*;
use crate::impostor::Choice;

/// Leaves and pieces of wood of each level of a chain finest first; and the chain.
fn left(tree: &WholeTree, chosen: &ChainOptions) -> (Vec<BTreeSet<LeafId>>, Chain) {
    let chain = chain(tree, chosen, &OpenEngine::cpu(), &mut go_on).unwrap();
    let of_level = |level: &ChainLevel| match &level.shape {
        Shape::Original(lod) | Shape::Mesh(lod) => {
            let originals = lod.leaves().map(|(leaf, _)| leaf);
            originals
                .chain(lod.made().map(|(made, _)| made.donor))
                .collect()
        }
        Shape::Impostor(_) => BTreeSet::new(),
    };
    (chain.levels.iter().map(of_level).collect(), chain)
}

fn wanted(wanted: Wanted) -> ChainOptions {
    let mut usual = options(&[20.0]);
    usual.leaves.effort = secateur_simplify::Effort::Fast;
    ChainOptions {
        wanted,
        original: true,
        impostor: Some(Choice::None),
        morph: true,
        max_difference: 0.5,
        ..usual
    }
}

fn comes_back(left: &[BTreeSet<LeafId>]) -> usize {
    let pairs = left.windows(2);
    pairs.map(|pair| pair[1].difference(&pair[0]).count()).sum()
}

/// And all are within the limits; each but the last has a way to the next.
#[test]
fn what_is_gone_from_a_level_does_not_come_back() {
    let oak = grown(Species::Oak, 120);
    let shares = [0.5, 0.3, 0.17, 0.1].map(secateur_simplify::Amount::Share);
    let chosen = wanted(Wanted::Triangles(shares.to_vec()));
    let (nested, chain) = left(&oak, &chosen);
    assert!(nested.len() > 2, "{} levels", nested.len());
    assert_eq!(comes_back(&nested), 0);
    for level in &chain.levels {
        assert!(level.difference.over(chosen.limits()) <= 1.0);
    }
    let has_morph = chain.levels.iter().map(|level| level.morph.is_some());
    let last = nested.len() - 1;
    assert!(has_morph.eq((0..=last).map(|k| k < last)));
}
