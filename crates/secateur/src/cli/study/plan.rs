//! What a study runs: methods with settings, each written as it would be on the
//! command line of `simplify`.

use std::path::Path;

use clap::Parser;
use secateur::{Method, Simplify};

use super::super::args::{Cli, Command, PlanName};
use super::super::failure::Failure;
use super::super::simplify;
use super::perturb::Perturbation;

/// A method with settings, on a tree as it is or changed a little.
#[derive(Clone, Debug)]
pub(super) struct Case {
    /// The method's name.
    pub(super) method: String,
    /// Its options, as they are written.
    pub(super) options: Vec<String>,
    pub(super) perturbation: Perturbation,
}

/// All methods, one setting each, and the variants that explain them.
const METHODS: [&str; 8] = [
    "vds",
    "vds --resize none",
    "vds --reference previous --resize deficit --neighbours 4",
    "fsa",
    "stochastic",
    "stochastic --area-weight 0.5",
    "meshopt",
    "meshopt --preserve-area",
];

/// How time buys accuracy.
const SPEED: [&str; 13] = [
    "vds",
    "vds --views 6",
    "vds --views 8",
    "vds --views 12",
    "vds --views vnc",
    "vds --resolution 64",
    "vds --resolution 128",
    "vds --resolution 256",
    "vds --resolution 512",
    "vds --resolution 1024",
    "fsa",
    "stochastic",
    "meshopt --preserve-area",
];

/// What is looked at under every perturbation.
const STABILITY: [&str; 4] = ["vds", "fsa", "stochastic", "meshopt --preserve-area"];

/// Settings whose spread is looked at beside the perturbations.
const STABILITY_SETTINGS: [&str; 9] = [
    "vds --resolution 64",
    "vds --resolution 256",
    "vds --resolution 1024",
    "vds --views 6",
    "vds --views 12",
    "vds --ties spread",
    "vds --alpha ignore",
    "stochastic --seed 1",
    "stochastic --seed 2",
];

/// The cases of a study, those given by hand or else those of its plan.
///
/// # Errors
/// [`Failure`] if one is no method with options.
pub(super) fn cases(plan: PlanName, by_hand: &[String]) -> Result<Vec<Case>, Failure> {
    let plain = |text: &&str| Case::parse(text, Perturbation::None);
    if !by_hand.is_empty() {
        return by_hand.iter().map(|text| plain(&text.as_str())).collect();
    }
    match plan {
        PlanName::Methods => METHODS.iter().map(plain).collect(),
        PlanName::Speed => SPEED.iter().map(plain).collect(),
        PlanName::Stability => {
            let mut cases = Vec::new();
            for text in STABILITY {
                for perturbation in Perturbation::ALL {
                    cases.push(Case::parse(text, perturbation)?);
                }
            }
            let settings: Result<Vec<Case>, Failure> =
                STABILITY_SETTINGS.iter().map(plain).collect();
            cases.extend(settings?);
            Ok(cases)
        }
    }
}

impl Case {
    fn parse(text: &str, perturbation: Perturbation) -> Result<Self, Failure> {
        let mut words = text.split_whitespace().map(str::to_owned);
        let case = Self {
            method: words.next().unwrap_or_default(),
            options: words.collect(),
            perturbation,
        };
        case.settings(1.0, None)?;
        Ok(case)
    }

    /// What is not the method's default, in words.
    pub(super) fn setting(&self) -> String {
        self.options.join(" ").replace("--", "")
    }

    /// Method, setting and change, as [`Row::label`](secateur::eval::study::Row::label).
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
        words.extend(["-o", "out.glb", "--ratio"].map(str::to_owned));
        words.push(level.to_string());
        words.extend(["--no-audit", "--method"].map(str::to_owned));
        words.push(self.method.clone());
        words.extend(self.options.iter().cloned());
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

    /// The settings of a run to a level.
    ///
    /// # Errors
    /// [`Failure`] if the options are wrong.
    pub(super) fn settings(&self, level: f64, seed: Option<u64>) -> Result<Simplify, Failure> {
        let words = self.arguments(Path::new("tree.glb"), level, seed);
        let of_this_case = |e: &dyn std::fmt::Display| {
            let first = e.to_string();
            let first = first.lines().next().unwrap_or_default().to_owned();
            let first = first.trim_start_matches("error: ").to_owned();
            Failure(format!(
                "the case `{} {}` is no method with options of `simplify`: {first}",
                self.method,
                self.options.join(" ")
            ))
        };
        match Cli::try_parse_from(words)
            .map_err(|e| of_this_case(&e))?
            .command
        {
            Command::Simplify(args) => simplify::settings(&args),
            _ => Err(of_this_case(&"it is another command")),
        }
    }

    /// Whether one run to the coarsest level gives all finer ones.
    pub(super) fn has_prefixes(settings: &Simplify) -> bool {
        settings.method != Method::Meshopt
    }

    /// Whether it gives something else for another seed.
    pub(super) fn draws_lots(settings: &Simplify) -> bool {
        settings.method == Method::Stochastic
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use secateur::Resize;

    #[test]
    fn every_plan_is_of_cases_that_can_be_run_and_told_apart() {
        for plan in [PlanName::Methods, PlanName::Speed, PlanName::Stability] {
            let cases = cases(plan, &[]).unwrap();
            let mut names: Vec<[String; 3]> = cases
                .iter()
                .map(|c| [c.method.clone(), c.setting(), c.perturbation.name()])
                .collect();
            names.sort();
            names.dedup();
            assert_eq!(names.len(), cases.len(), "{plan:?}");
        }
    }

    #[test]
    fn a_case_is_what_its_command_says() {
        let case = Case::parse("vds --resize none", Perturbation::None).unwrap();
        assert_eq!(case.setting(), "resize none");
        assert_eq!(case.settings(0.5, None).unwrap().resize, Resize::None);
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
