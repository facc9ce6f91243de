//! What is promised of any plant: levels, or one sentence.

use std::ops::ControlFlow;

use secateur_gltf::{Document, WholeTree};
use secateur_levels::chain::{ChainOptions, Textures, Wanted, chain};
use secateur_levels::impostor::Choice;
use secateur_model::Lod;
use secateur_raster::OpenEngine;
use secateur_runtime::Screen;
use secateur_simplify::whole::{WholePlant, WoodMode};
use secateur_simplify::{Amount, Options, Preset, Progress, Resolution, Target};

use crate::plants::OddPlant;

/// What is asked of `simplify`.
const SHARES: [f64; 3] = [0.5, 0.1, 0.02];

/// Pixels along a side of the views.
const RESOLUTION: u32 = 32;

/// How many of the answers were levels, and how many were sentences.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Answers {
    pub(crate) levels: usize,
    pub(crate) sentences: usize,
}

/// Asks for levels of a plant in several ways.
///
/// # Panics
/// If what comes is neither a plant nor one sentence.
pub(crate) fn check(plant: &OddPlant, number: u64) -> Answers {
    let mut answers = Answers::default();
    let tree = Document::from_bytes("odd.glb", plant.glb.clone(), None).and_then(|document| {
        document.into_whole_tree(&["material:leaf".parse().expect("a selector")])
    });
    let tree = match tree {
        Ok(tree) => tree,
        Err(error) => {
            answers.refused(&error.to_string());
            return answers;
        }
    };
    let modes = [WoodMode::Auto, WoodMode::Vmi, WoodMode::Keep];
    let mode = modes[number as usize % modes.len()];
    simplified(&tree, &mut answers);
    let distances = |of: &[f64]| Wanted::Distances(of.to_vec());
    let wanted = match number % 4 {
        0 => Wanted::Heights(vec![1080.0, 135.0]),
        1 => distances(&[5.0, 20.0]),
        2 => distances(&[1000.0]),
        _ => Wanted::Triangles(vec![Amount::Share(0.5), Amount::Share(0.1)]),
    };
    levels(&tree, wanted, mode, &mut answers);
    answers
}

impl Answers {
    fn refused(&mut self, sentence: &str) {
        assert!(
            !sentence.is_empty() && !sentence.contains('\n'),
            "{sentence:?}"
        );
        self.sentences += 1;
    }
}

fn leaf_options() -> Options {
    Options {
        resolution: Resolution::Pixels(RESOLUTION),
        audit: false,
        ..Options::with_preset(Preset::Look, Target::triangle_share(1.0))
    }
}

fn go_on(_: Progress) -> ControlFlow<()> {
    ControlFlow::Continue(())
}

/// A plant is not empty, is finite, and can be written.
fn assert_is_plant(tree: &WholeTree, lod: &Lod) -> usize {
    let left = lod.foliage(tree.items().foliage());
    let corners = left.triangles().iter().flat_map(|t| t.corners);
    assert!(corners.into_iter().all(|corner| corner.is_finite()));
    tree.items().lod_document(lod).expect("a level is written");
    left.triangles().len()
}

fn simplified(tree: &WholeTree, answers: &mut Answers) {
    let engine = OpenEngine::cpu();
    let (items, leaves, wood) = (tree.items().foliage(), tree.leaves(), tree.wood());
    let options = leaf_options();
    let plant = match WholePlant::by(WoodMode::Auto, items, leaves, wood, &options, &engine) {
        Ok(plant) => plant,
        Err(error) => return answers.refused(&error.to_string()),
    };
    for share in SHARES {
        let options = Options {
            target: Target::triangle_share(share),
            ..options.clone()
        };
        match plant.simplified(&options, &engine, &mut go_on) {
            Ok(level) => {
                let lod = tree.joined(&level.leaves.lod, &level.wood);
                let left = assert_is_plant(tree, &lod);
                let asked = Amount::Share(share).of(plant.triangle_count());
                assert!(left > 0 && left <= asked, "{left} of {asked}");
                assert!(left as f64 >= 0.9 * asked as f64, "{left} of {asked}");
                answers.levels += 1;
            }
            Err(error) => answers.refused(&error.to_string()),
        }
    }
}

fn levels(tree: &WholeTree, wanted: Wanted, wood: WoodMode, answers: &mut Answers) {
    let options = ChainOptions {
        wanted,
        screen: Screen::default(),
        max_difference: 0.28,
        original: false,
        plant_height_m: None,
        leaves: leaf_options(),
        wood,
        impostor: Choice::Auto,
        shadow_steps: 0,
        max_pop: None,
        textures: Textures::Fit,
        scene: None,
    };
    match chain(tree, &options, &OpenEngine::cpu(), &mut go_on) {
        Ok(chain) => {
            assert!(!chain.levels.is_empty());
            for level in &chain.levels {
                assert!(level.triangles > 0, "an empty level");
                let figures = [
                    level.distance,
                    level.pixels_high,
                    level.difference.difference,
                    level.difference.block_coverage,
                    level.flip_mean,
                ];
                assert!(figures.iter().all(|f| f.is_finite()), "{figures:?}");
            }
            answers.levels += chain.levels.len();
        }
        Err(error) => answers.refused(&error.to_string()),
    }
}
