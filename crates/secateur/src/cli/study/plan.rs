//! What a study runs: methods with settings, each written as it would be on the
//! command line of `simplify`.

use std::path::{Path, PathBuf};

use clap::Parser;
use secateur::Options;

use super::super::args::{Cli, Command, PlanName};
use super::super::failure::Failure;
use super::super::simplify;
use super::paper;
use super::perturb::Perturbation;

/// A method with settings, on a tree as it is or changed a little.
#[derive(Clone, Debug)]
pub(super) struct Case {
    /// The method's name.
    pub(super) method: String,
    /// Its options, as they are written.
    pub(super) words: Vec<String>,
    pub(super) perturbation: Perturbation,
    /// A word of the options that stands for this file of cameras.
    cameras: Option<(String, PathBuf)>,
}

/// Without a number after it: the levels of a case are shares of triangles.
const OF_TRIANGLES: &str = "--triangles";

/// All methods, one setting each, and the variants that explain them.
const METHODS: [&str; 15] = [
    "vds",
    "vds --fit=none",
    "vds --preset information",
    "vds --preset information --resize none",
    "vds --preset information --reference previous --resize deficit --neighbours 4",
    "vds --preset information --reference previous --resize deficit --neighbours 4 --max-coverage 1",
    "vds --triangles",
    "vds --triangles --fit=none",
    "vds --triangles --preset information",
    "vds --triangles --preset information --fit=none",
    "fsa",
    "stochastic",
    "stochastic --area-weight 0.5",
    "meshopt",
    "meshopt --preserve-area",
];

/// What trees that know their branches get beside those, in every plan that
/// compares methods.
const BY_BRANCHES: [&str; 3] = ["chain", "merge", "merge --cluster-size area"];

/// How time buys accuracy.
const SPEED: [&str; 18] = [
    "vds",
    "vds --fit=none",
    "vds --preset information",
    "vds --preset information --views 6",
    "vds --preset information --views 8",
    "vds --preset information --views 12",
    "vds --preset information --views vnc",
    "vds --preset information --resolution 64",
    "vds --preset information --resolution 128",
    "vds --preset information --resolution 256",
    "vds --preset information --resolution 512",
    "vds --preset information --resolution 1024",
    "vds --triangles",
    "vds --triangles --preset information",
    "vds --triangles --preset information --fit=none",
    "fsa",
    "stochastic",
    "meshopt --preserve-area",
];

/// What is looked at under every perturbation.
const STABILITY: [&str; 7] = [
    "vds",
    "vds --preset information",
    "vds --triangles",
    "vds --triangles --preset information",
    "fsa",
    "stochastic",
    "meshopt --preserve-area",
];

/// Settings whose spread is looked at beside the perturbations.
const STABILITY_SETTINGS: [&str; 10] = [
    "vds --preset information --resolution 64",
    "vds --preset information --resolution 256",
    "vds --preset information --resolution 1024",
    "vds --preset information --views 6",
    "vds --preset information --views 12",
    "vds --preset information --views 92",
    "vds --preset information --ties spread",
    "vds --preset information --alpha ignore",
    "stochastic --seed 1",
    "stochastic --seed 2",
];

/// What is run on trees of the user's: cases given by hand, or else those of
/// plans, each once. `knows_branches`: whether the tree has a skeleton, so that the
/// plans' methods that need one can be run on it.
///
/// # Errors
/// [`Failure`] if one is no method with options.
pub(super) fn cases(
    plans: &[PlanName],
    by_hand: &[String],
    knows_branches: bool,
) -> Result<Vec<Case>, Failure> {
    let by_branches = match knows_branches {
        true => &BY_BRANCHES[..],
        false => &[],
    };
    if !by_hand.is_empty() {
        let texts: Vec<&str> = by_hand.iter().map(String::as_str).collect();
        return parsed(&texts);
    }
    let mut cases: Vec<Case> = Vec::new();
    for plan in plans {
        let planned = match plan {
            PlanName::Methods => parsed(&[&METHODS[..], by_branches].concat())?,
            PlanName::Speed => parsed(&[&SPEED[..], by_branches].concat())?,
            PlanName::Stability => stability(by_branches)?,
            PlanName::Failures => Vec::new(),
            PlanName::Paper => parsed(&[&paper::CASES[..], &paper::FEWER_VIEWS].concat())?,
        };
        for case in planned {
            if !cases.iter().any(|known| known.label() == case.label()) {
                cases.push(case);
            }
        }
    }
    Ok(cases)
}

fn stability(by_branches: &[&str]) -> Result<Vec<Case>, Failure> {
    let mut cases = Vec::new();
    for text in STABILITY.iter().chain(by_branches) {
        for perturbation in Perturbation::ALL {
            cases.push(Case::parse(text, perturbation)?);
        }
    }
    cases.extend(parsed(&STABILITY_SETTINGS)?);
    Ok(cases)
}

/// Cases as they are written, on trees as they are.
pub(super) fn parsed(texts: &[&str]) -> Result<Vec<Case>, Failure> {
    let plain = |text: &&str| Case::parse(text, Perturbation::None);
    texts.iter().map(plain).collect()
}

impl Case {
    fn parse(text: &str, perturbation: Perturbation) -> Result<Self, Failure> {
        let mut words = text.split_whitespace().map(str::to_owned);
        let case = Self {
            method: words.next().unwrap_or_default(),
            words: words.collect(),
            perturbation,
            cameras: None,
        };
        case.options(1.0, None)?;
        Ok(case)
    }

    /// A case one word of which stands for a file of cameras, which need not be
    /// there yet.
    pub(super) fn with_cameras(text: &str, word: &str, file: &Path) -> Result<Self, Failure> {
        let has_word = text.split_whitespace().any(|w| w == word);
        // Checked as if it were another set of views.
        let mut case = Self::parse(&text.replace(word, "12"), Perturbation::None)?;
        if has_word {
            case.words = text.split_whitespace().skip(1).map(str::to_owned).collect();
            case.cameras = Some((word.to_owned(), file.to_owned()));
        }
        Ok(case)
    }

    /// What is not the method's default, in words.
    pub(super) fn setting(&self) -> String {
        let setting = self.words.join(" ").replace("--", "");
        match &self.cameras {
            Some((word, _)) => setting.replace(word, "near"),
            None => setting,
        }
    }

    /// Method, setting and change, as [`Row::label`](secateur_eval::study::Row::label).
    pub(super) fn label(&self) -> String {
        let change = self.perturbation.name();
        let variant = [self.setting(), change];
        let variant: Vec<String> = variant.into_iter().filter(|v| !v.is_empty()).collect();
        match variant.is_empty() {
            true => self.method.clone(),
            false => format!("{} {}", self.method, variant.join(", ")),
        }
    }

    /// The arguments of `simplify` for one level.
    fn arguments(&self, tree: &Path, level: f64, seed: Option<u64>) -> Vec<String> {
        let mut words: Vec<String> = ["secateur", "simplify"].map(str::to_owned).to_vec();
        words.push(tree.display().to_string());
        words.extend(["-o", "out.glb"].map(str::to_owned));
        // Never a whole number, which would be one of triangles.
        words.extend(match self.is_of_triangles() {
            true => [OF_TRIANGLES.to_owned(), format!("{level:?}")],
            false => ["--ratio".to_owned(), level.to_string()],
        });
        words.extend(["--no-audit", "--method"].map(str::to_owned));
        words.push(self.method.clone());
        let options = self.words.iter().filter(|option| *option != OF_TRIANGLES);
        words.extend(options.map(|option| match &self.cameras {
            Some((word, file)) if word == option => file.display().to_string(),
            _ => option.clone(),
        }));
        if let Some(seed) = seed {
            words.extend(["--seed".to_owned(), seed.to_string()]);
        }
        words
    }

    /// How to get one level again; of a changed tree, without the change.
    pub(super) fn command(&self, tree: &Path, level: f64, seed: Option<u64>) -> String {
        let command = self.arguments(tree, level, seed).join(" ");
        match self.perturbation {
            Perturbation::None => command,
            change => format!("{command} (on the tree with: {})", change.name()),
        }
    }

    /// What a run to a level is to do.
    ///
    /// # Errors
    /// [`Failure`] if the options are wrong.
    pub(super) fn options(&self, level: f64, seed: Option<u64>) -> Result<Options, Failure> {
        let words = self.arguments(Path::new("tree.glb"), level, seed);
        let of_this_case = |e: &dyn std::fmt::Display| {
            let first = e.to_string();
            let first = first.lines().next().unwrap_or_default().to_owned();
            let first = first.trim_start_matches("error: ").to_owned();
            Failure(format!(
                "the case `{} {}` is no method with options of `simplify`: {first}",
                self.method,
                self.words.join(" ")
            ))
        };
        match Cli::try_parse_from(words)
            .map_err(|e| of_this_case(&e))?
            .command
        {
            Command::Simplify(args) => simplify::options(&args),
            _ => Err(of_this_case(&"it is another command")),
        }
    }

    /// Whether levels are shares of the triangles, not of the leaves.
    pub(super) fn is_of_triangles(&self) -> bool {
        self.words.iter().any(|option| option == OF_TRIANGLES)
    }

    /// Whether one run to the coarsest level gives all finer ones, a leaf a step.
    ///
    /// # Errors
    /// [`Failure`] if the options are wrong.
    pub(super) fn has_prefixes(&self) -> Result<bool, Failure> {
        Ok(self.options(1.0, None)?.levels_share_one_order())
    }

    /// Whether it gives something else for another seed.
    pub(super) fn draws_lots(&self) -> bool {
        self.method == "stochastic"
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use secateur::{Resize, Target};

    #[test]
    fn every_plan_is_of_cases_that_can_be_run_and_told_apart() {
        let all = [
            PlanName::Methods,
            PlanName::Speed,
            PlanName::Stability,
            PlanName::Paper,
        ];
        for plans in [&all[..1], &all[1..2], &all[2..3], &all[3..], &all] {
            let [without, with] = [false, true].map(|b| cases(plans, &[], b).unwrap());
            let mut names: Vec<[String; 3]> = with
                .iter()
                .map(|c| [c.method.clone(), c.setting(), c.perturbation.name()])
                .collect();
            names.sort();
            names.dedup();
            assert_eq!(names.len(), with.len(), "{plans:?}");
            assert!(without.len() <= with.len());
        }
    }

    #[test]
    fn methods_by_branches_are_for_trees_that_know_them() {
        let by_branches = |case: &&Case| case.options(0.5, None).unwrap().method.needs_skeleton();
        let count = |plan, knows_branches| {
            let cases = cases(&[plan], &[], knows_branches).unwrap();
            cases.iter().filter(by_branches).count()
        };
        for (plan, expected) in [
            (PlanName::Methods, BY_BRANCHES.len()),
            (PlanName::Speed, BY_BRANCHES.len()),
            (
                PlanName::Stability,
                BY_BRANCHES.len() * Perturbation::ALL.len(),
            ),
        ] {
            assert_eq!(count(plan, false), 0, "{plan:?}");
            assert_eq!(count(plan, true), expected, "{plan:?}");
        }
    }

    /// What the study takes for one run to the coarsest level is cut where each
    /// run of its own ends.
    #[test]
    fn methods_by_branches_have_prefixes_and_draw_no_lots() {
        for text in BY_BRANCHES {
            let case = Case::parse(text, Perturbation::None).unwrap();
            assert!(case.has_prefixes().unwrap());
            assert!(!case.draws_lots());
        }
        for text in [
            "meshopt",
            "vds --triangles",
            "vds --leaf-triangles=2",
            "vds",
            "vds --fit",
            "fsa --fit=3",
        ] {
            let case = Case::parse(text, Perturbation::None).unwrap();
            assert!(!case.has_prefixes().unwrap(), "{text}");
        }
        for text in ["vds --fit=none", "vds --preset information", "fsa"] {
            let unfitted = Case::parse(text, Perturbation::None).unwrap();
            assert!(unfitted.has_prefixes().unwrap(), "{text}");
        }
    }

    #[test]
    fn levels_of_a_case_of_triangles_are_shares_of_them() {
        let text = "vds --triangles --neighbours 4";
        let case = Case::parse(text, Perturbation::None).unwrap();
        assert_eq!(case.setting(), "triangles neighbours 4");
        for share in [0.25, 1.0] {
            let settings = case.options(share, None).unwrap();
            assert_eq!(settings.target, Target::triangle_share(share));
            assert_eq!(settings.method.vds().unwrap().neighbours, 4);
        }
    }

    #[test]
    fn a_case_is_what_its_command_says() {
        let case = Case::parse("vds --resize none", Perturbation::None).unwrap();
        assert_eq!(case.setting(), "resize none");
        assert_eq!(
            case.options(0.5, None)
                .unwrap()
                .method
                .vds()
                .unwrap()
                .resize,
            Resize::None
        );
        let command = case.command(Path::new("a.glb"), 0.25, Some(3));
        assert!(command.contains("a.glb -o out.glb --ratio 0.25"));
        assert!(command.ends_with("--method vds --resize none --seed 3"));
    }

    #[test]
    fn what_is_no_case_is_a_failure_of_one_line() {
        for text in ["nonsense", "vds --no-such-thing", ""] {
            let failure = Case::parse(text, Perturbation::None).unwrap_err();
            assert!(!failure.to_string().contains('\n'), "{failure}");
        }
    }
}
