//! What a chain is to be like.

use secateur::{Amount, Options, Target};
use secateur_scene::Screen;
use secateur_scene::chain::{ChainOptions, HEIGHTS_PX, Textures, Wanted};
use secateur_scene::impostor::Choice;

use super::super::args;

pub(super) fn options(args: &args::Lods) -> ChainOptions {
    let wanted = match (&args.levels[..], &args.triangles[..], &args.distances) {
        (.., Some(distances)) => Wanted::Distances(distances.0.clone()),
        ([], [], None) => {
            let screen = args.screen_height / HEIGHTS_PX[0];
            Wanted::Heights(HEIGHTS_PX.map(|height| height * screen).to_vec())
        }
        ([], counts, _) => Wanted::Triangles(counts.iter().map(|n| Amount::Count(*n)).collect()),
        (shares, ..) => Wanted::Triangles(shares.iter().map(|r| Amount::Share(*r)).collect()),
    };
    let mut leaves = Options::with_preset(args.preset.into(), Target::triangle_share(1.0));
    leaves.alpha = args.alpha.into();
    leaves.sides = args.sides.into();
    leaves.engine = args.engine.into();
    leaves.audit = false;
    // Levels have figures of their own, from views that drove none of them.
    leaves.shows_what_is_left = false;
    let impostor = match (args.impostor, &wanted) {
        (Some(name), _) => name.into(),
        (None, Wanted::Triangles(_)) => Choice::None,
        (None, _) => Choice::Auto,
    };
    ChainOptions {
        wanted,
        impostor,
        shadow_steps: usize::from(args.shadow_steps),
        max_pop: args.max_pop,
        textures: args.textures.map_or(Textures::Fit, Into::into),
        screen: Screen {
            height_px: args.screen_height,
            field_of_view_degrees: args.fov,
        },
        max_difference: args.max_difference,
        original: !args.no_original,
        plant_height_m: args.plant_height,
        scene: None,
        leaves,
        wood: args.wood.into(),
    }
}
