//! What a chain is to be like.

use secateur::{Amount, Options};
use secateur_levels::chain::{ChainOptions, Wanted};

use super::super::args;

pub(crate) fn options(args: &args::Lods) -> ChainOptions {
    let wanted = match (&args.levels[..], &args.triangles[..], &args.distances) {
        (.., Some(distances)) => Wanted::Distances(distances.0.clone()),
        ([], [], None) => Wanted::UsualHeights,
        ([], counts, _) => Wanted::Triangles(counts.iter().map(|n| Amount::Count(*n)).collect()),
        (shares, ..) => Wanted::Triangles(shares.iter().map(|r| Amount::Share(*r)).collect()),
    };
    let usual = ChainOptions::default();
    let leaves = Options {
        alpha: args.alpha,
        sides: args.sides,
        engine: args.engine,
        effort: args.effort,
        audit: usual.leaves.audit,
        shows_what_is_left: usual.leaves.shows_what_is_left,
        ..Options::with_preset(args.preset.into(), usual.leaves.target)
    };
    ChainOptions {
        wanted,
        impostor: args.impostor,
        shadow_steps: usize::from(args.shadow_steps),
        max_pop: args.max_pop,
        morph: args.morph,
        textures: args.textures.unwrap_or_default(),
        cost: args.cost,
        impostor_texture_bytes: args.impostor_textures,
        screen: args.screen,
        max_difference: args.max_difference,
        original: !args.no_original,
        as_one: args.as_one,
        plant_height_m: args.plant_height,
        leaves,
        wood: args.wood.into(),
        ..usual
    }
}
