//! What is promised of any plant: levels, or one sentence.

use secateur::chain::{Layout, LevelReport, LevelsOptions, Screen, Wanted};
use secateur::{
    Amount, GltfError, LevelOptions, Opening, Options, Plant, Preset, Resolution, Target, WoodMode,
};

use super::plant::{Choices, odd_plant};

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

impl std::ops::AddAssign for Answers {
    fn add_assign(&mut self, other: Self) {
        self.levels += other.levels;
        self.sentences += other.sentences;
    }
}

/// Opens the plant of these choices, inspects it, and asks for levels of it.
///
/// # Panics
/// If what comes is neither a plant nor one sentence.
pub(crate) fn check(choices: &[u8]) -> Answers {
    let mut choices = Choices::new(choices);
    let plant = odd_plant(&mut choices);
    let mut answers = Answers::default();
    let opening = Opening {
        foliage: match choices.one_of(&["", "material:leaf*", "material:*"]) {
            "" => Vec::new(),
            selector => vec![selector.parse().expect("a selector")],
        },
        wood: choices.one_of(&[WoodMode::Auto, WoodMode::Geometry, WoodMode::Keep]),
        ..Opening::default()
    };
    match Plant::from_bytes("odd.glb", plant.glb, &opening) {
        Ok(plant) => {
            assert_in_words(&plant.inspection().to_string());
            answers.simplified(&plant, choices.one_of(&SHARES));
            answers.levels_of(&plant, &mut choices);
        }
        Err(error) => answers.refused(&error.to_string()),
    }
    answers
}

/// A figure that is none of a plant is not printed.
fn assert_in_words(text: &str) {
    let words = text.split(|c: char| !c.is_alphanumeric());
    let mut wrong = words.filter(|word| ["NaN", "inf"].contains(word));
    assert_eq!(wrong.next(), None, "{text}");
}

impl Answers {
    fn refused(&mut self, sentence: &str) {
        assert!(
            !sentence.is_empty() && !sentence.contains('\n'),
            "{sentence:?}"
        );
        assert_in_words(sentence);
        self.sentences += 1;
    }

    fn simplified(&mut self, plant: &Plant, share: f64) {
        let options = LevelOptions::of(Options {
            target: Target::triangle_share(share),
            ..leaf_options()
        });
        let level = match plant.level(&options) {
            Ok(level) => level,
            Err(error) => return self.refused(&error.to_string()),
        };
        let of_leaves = level.simplified.lod.foliage(plant.leaves());
        let left = of_leaves.triangles().len() + level.wood_triangles as usize;
        let asked = Amount::Share(share).of(plant.triangle_count() as usize);
        // Wood that stays as it is may be more than was asked for.
        if plant.wood_mode() != WoodMode::Keep {
            assert!(left > 0 && left <= asked, "{left} of {asked}");
            assert!(left as f64 >= 0.9 * asked as f64, "{left} of {asked}");
        }
        if let Some(seen) = level.difference {
            assert!(seen.difference.is_finite() && seen.block_coverage.is_finite());
        }
        assert_is_file(level.to_bytes());
        self.levels += 1;
    }

    fn levels_of(&mut self, plant: &Plant, choices: &mut Choices<'_>) {
        let wanted = match choices.one_of(&[0, 1, 2, 3]) {
            0 => Wanted::Heights(vec![100.0, 40.0]),
            1 => Wanted::Distances(vec![5.0, 20.0]),
            2 => Wanted::Distances(vec![1000.0]),
            _ => Wanted::Triangles(vec![Amount::Share(0.5), Amount::Share(0.1)]),
        };
        let options = LevelsOptions {
            wanted,
            screen: Screen {
                height_px: 100.0,
                ..Screen::default()
            },
            original: choices.one_of(&[true, false]),
            leaves: leaf_options(),
            wood: plant.wood_mode(),
            ..LevelsOptions::default()
        };
        let levels = match plant.levels(&options) {
            Ok(levels) => levels,
            Err(error) => return self.refused(&error.to_string()),
        };
        assert!(!levels.chain.levels.is_empty());
        for level in &levels.chain.levels {
            assert!(
                level.triangles > 0,
                "an empty level: {:?} {:?}",
                level.report,
                levels.chain.notes
            );
            assert_figures(&level.report);
        }
        for note in &levels.chain.notes {
            assert_in_words(note);
        }
        let layout = choices.one_of(&[Layout::Files, Layout::Siblings, Layout::Msft]);
        let files = levels.to_bytes(layout).expect("levels are written");
        for file in files.files {
            assert_is_file(Ok(file.bytes));
        }
        self.levels += levels.chain.levels.len();
    }
}

/// Every figure of a level is a number; only the height of a plant that is stood in has no bound.
fn assert_figures(report: &LevelReport) {
    let drawn = report.as_drawn.iter();
    let drawn = drawn.flat_map(|drawn| {
        [
            drawn.begin.coverage_over_truth,
            drawn.begin.specks_per_view,
            drawn.end.coverage_over_truth,
            drawn.end.specks_per_view,
            drawn.more_specks_per_view,
        ]
    });
    let impostor = report.impostor.iter();
    let impostor = impostor
        .flat_map(|of| [Some(of.mesh_difference), of.same_cost_difference])
        .flatten();
    let optional = [report.pop, report.silhouette_iou, report.vmi_error_percent];
    let always = [
        report.distance,
        report.screen_coverage,
        report.difference.difference,
        report.difference.block_coverage,
        report.flip_mean,
    ];
    let optional = optional.into_iter().flatten();
    let mut all = drawn.chain(impostor).chain(optional).chain(always);
    assert!(all.all(f64::is_finite), "{report:?}");
    assert!(!report.pixels_high.is_nan(), "{report:?}");
}

fn assert_is_file(bytes: Result<Vec<u8>, GltfError>) {
    let bytes = bytes.expect("a level is written");
    let written = secateur::Document::from_bytes("written.glb", bytes, None);
    written.expect("what is written can be read");
}

fn leaf_options() -> Options {
    Options {
        resolution: Resolution::Pixels(RESOLUTION),
        engine: secateur::Engine::Cpu,
        audit: false,
        ..Options::with_preset(Preset::Look, Target::triangle_share(1.0))
    }
}
