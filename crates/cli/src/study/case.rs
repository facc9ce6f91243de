//! Cases by hand: a method and options of `simplify`, as one argument.

use std::fmt::Display;
use std::path::Path;

use clap::Parser;
use secateur::{Memory, Views};
use secateur_study::{Case, LevelOf};

use super::super::args::{self, Cli, Command};
use super::super::failure::Failure;
use super::super::simplify;

/// Without a number after it: the levels of the case are shares of triangles.
const OF_TRIANGLES: &str = "--triangles";

/// Reads `vds --views 8` with the parser of `simplify`.
///
/// # Errors
/// [`Failure`] if it is no method with options, or an option is the study's own.
pub(super) fn parse(text: &str) -> Result<Case, Failure> {
    let words: Vec<&str> = text.split_whitespace().collect();
    let level_of = match words.contains(&OF_TRIANGLES) {
        true => LevelOf::Triangles,
        false => LevelOf::Leaves,
    };
    // A level, a tree and an output are the study's; a parser wants to see some.
    let level = match level_of {
        LevelOf::Triangles => OF_TRIANGLES,
        LevelOf::Leaves => "--ratio",
    };
    let usual = ["secateur", "simplify", "tree.glb", "-o", "out.glb"];
    let level = [level, "1.0", "--no-audit", "--method"];
    let own = words.iter().filter(|word| **word != OF_TRIANGLES);
    let arguments = usual.iter().chain(&level).chain(own);
    let is_no_case = |why: &dyn Display| {
        let why = why.to_string();
        let why = why.lines().next().unwrap_or_default();
        let why = why.trim_start_matches("error: ");
        Failure::input(format!(
            "the case `{text}` is no method with options of `simplify`: {why}"
        ))
    };
    let cli = Cli::try_parse_from(arguments).map_err(|e| is_no_case(&e))?;
    let Command::Simplify(args) = cli.command else {
        return Err(is_no_case(&"it is another command"));
    };
    if let Some(option) = option_of_the_study(&args, &cli.common) {
        return Err(is_no_case(&format!("`{option}` is not for cases")));
    }
    if let Some(sentence) = simplify::contradiction(&args) {
        return Err(is_no_case(&sentence));
    }
    let options = simplify::options(&args).map_err(|e| is_no_case(&e))?;
    let cutoffs = args.cutoffs.unwrap_or_default();
    let case = Case::new(options.clone(), level_of).with_cutoffs(cutoffs);
    Ok(match (options.views, &args.views) {
        (Views::Cameras(_), Some(name)) => case.seen_from(name, Path::new(name)),
        _ => case,
    })
}

/// An option that a case can't have: a study has it itself, or writes no such file.
fn option_of_the_study(args: &args::Simplify, common: &args::Common) -> Option<&'static str> {
    let given = [
        ("--wood", args.wood.is_some()),
        ("--scene", args.scene.scene.is_some()),
        ("--occluder", !args.scene.occluder.is_empty()),
        ("--colors", args.colors.is_some()),
        ("--foliage", !args.foliage.foliage.is_empty()),
        ("--level-of", !args.level_of.is_empty()),
        ("--strips", args.packing.strips),
        ("--report", args.report.is_some()),
        ("--picture", args.picture.is_some()),
        ("--debug-images", args.debug_images.is_some()),
        ("--memory", args.memory.memory != Memory::Auto),
        ("--threads", common.threads.is_some()),
        ("--quiet", common.quiet),
        ("--verbose", common.verbose > 0),
        ("--format", common.format != args::Format::Pretty),
    ];
    given.iter().find(|(_, is)| *is).map(|(option, _)| *option)
}

#[cfg(test)]
mod tests {
    use super::*;
    use secateur::{Method, Resize, Target};

    /// The words of a row's command after the method.
    fn words_of(case: &Case) -> String {
        let command = case.command(Path::new("a.glb"), 0.5, None);
        let (_, words) = command.split_once("--method ").unwrap();
        match case.level_of() {
            LevelOf::Triangles => format!("{words} --triangles"),
            LevelOf::Leaves => words.to_owned(),
        }
    }

    /// What a row says of how it was made makes it again.
    #[test]
    fn a_command_is_read_as_the_same_case() {
        for text in [
            "vds",
            "vds --triangles --fit",
            "vds --fit=4 --triangles --preset information --leaf-triangles 2",
            "vds --preset information --max-coverage 1.5 --reference previous --resize none",
            "vds --max-coverage none --neighbours 4 --ties spread --views icosahedron",
            "vds-reference --views 92 --resolution 64 --engine cpu --alpha ignore",
            "fsa --distance-weight 0.25 --planarity-weight 0 --views 20",
            "fsa --corners furthest --hausdorff surface",
            "vds --preset paper --views vnc",
            "vds --preset paper-normalised --resolution 256 --engine cpu",
            "chain --branch-metric longest-path",
            "stochastic --seed 7 --area-weight 0.5",
            "meshopt --meshopt-mode sloppy --preserve-area --fit=coverage",
            "meshopt --dilate-borders",
            "merge --cluster-size area",
            "chain --audit",
            "fsa --corners furthest --fit=coverage --cutoffs fit",
            "vds --triangles --cutoffs keep",
        ] {
            let case = parse(text).unwrap();
            let words = words_of(&case);
            assert_eq!(parse(&words).unwrap(), case, "{text}: {words}");
            assert_eq!(
                case.options(0.5, None).unwrap(),
                parse(&words).unwrap().options(0.5, None).unwrap()
            );
        }
    }

    /// Each option that differs is a word of the setting, in one order.
    #[test]
    fn a_setting_says_what_differs() {
        for (text, setting) in [
            ("vds --views auto --ties order --seed 3", ""),
            ("vds --views 20", "views dodecahedron"),
            ("vds --fit=none --triangles", "triangles fit=none"),
            ("vds --fit", "fit"),
            ("vds --views 6 --neighbours 4", "neighbours 4 views 6"),
            (
                "vds --ties spread --resolution 64",
                "resolution 64 ties spread",
            ),
            (
                "vds --engine gpu --resolution 256",
                "resolution 256 engine gpu",
            ),
            ("meshopt --fit --preserve-area", "preserve-area fit"),
            ("stochastic --fit --cutoffs fit", "fit cutoffs fit"),
            ("merge --cluster-size area", "cluster-size area"),
            ("fsa --hausdorff surface", "hausdorff surface"),
            ("chain --branch-metric children", "branch-metric children"),
            (
                "vds --preset paper --alpha ignore --resolution 256 --resize literal",
                "preset paper",
            ),
        ] {
            assert_eq!(parse(text).unwrap().setting(), setting, "{text}");
        }
    }

    #[test]
    fn a_case_has_what_its_words_say() {
        let case = parse("vds --triangles --resize none").unwrap();
        let options = case.options(0.25, None).unwrap();
        assert_eq!(options.target, Target::triangle_share(0.25));
        assert_eq!(options.method.vds().unwrap().resize, Resize::None);
        assert!(!options.audit);
        let lots = parse("stochastic").unwrap().options(0.5, Some(3)).unwrap();
        assert!(matches!(lots.method, Method::Stochastic(own) if own.seed == 3));
    }

    #[test]
    fn what_is_no_case_is_a_failure_of_one_line() {
        for text in [
            "nonsense",
            "vds --no-such-thing",
            "",
            "vds --leaves 3",
            "vds --triangles --wood auto",
            "vds --report r.json",
            "vds --memory 1G",
            "vds --views no.json",
            "vds -q",
            "vds --preset paper --resolution 512",
            "fsa --preset paper",
        ] {
            let failure = parse(text).unwrap_err().to_string();
            assert!(!failure.contains('\n'), "{failure}");
            assert!(failure.contains("no method with options"), "{failure}");
        }
    }
}
