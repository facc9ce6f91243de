//! Plans: lists of cases that answer one question each.

use secateur_simplify::meshopt::Borders;
use secateur_simplify::vds::{Resize, Ties};
use secateur_simplify::{FieldOfView, Views};

use crate::named_cases::{
    by_branches, by_metrics, coverage_kept, fsa, fsa_of_surfaces, fsa_without_slivers, information,
    look, meshopt, other_chains, resized, shared_deficit, stochastic, stochastic_of_half_area,
    stochastic_of_seed,
};
use crate::{Case, Perturbation, fairness, paper};

/// A set of cases that answers one question.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "cli", derive(clap::ValueEnum))]
pub enum Plan {
    /// Every method, one setting each, and variants that explain them.
    Methods,
    /// vds from fewer views and at other resolutions, beside the other methods.
    Speed,
    /// Methods under turned views, jittered corners, shuffled leaves and other settings.
    Stability,
    /// Small scenes made for one failure each, and what to do about it.
    Failures,
    /// The paper's studies: its figures beside those of plants with as many leaves.
    Paper,
    /// Whole plants at shares of all triangles, beside leaves alone and gltfpack on the whole file, where that
    /// is found.
    Whole,
    /// A walk through grown woods, frame by frame: the two schemes of merging and the branch chain beside full
    /// geometry.
    Walk,
    /// The branch chain by each of its four metrics, on five grown species.
    Metrics,
    /// The default and other methods as they are, with fitted sizes, with chosen alpha cutoffs and colours of
    /// clear texels, and with both.
    Fairness,
    /// Whole plants at distances: levels for these beside fixed shares, impostors beside meshes of as many
    /// triangles.
    Scene,
}

fn methods() -> Vec<Case> {
    vec![
        look(),
        look().unfitted(),
        information(),
        resized(Resize::None),
        shared_deficit(),
        coverage_kept(),
        look().of_triangles(),
        look().of_triangles().unfitted(),
        information().of_triangles(),
        information().of_triangles().unfitted(),
        fsa(),
        fsa_of_surfaces(),
        fsa_without_slivers(),
        stochastic(),
        stochastic_of_half_area(),
        meshopt(Borders::Stay),
        meshopt(Borders::PreserveArea),
        meshopt(Borders::Dilate),
        fsa().fitted(),
        stochastic().fitted(),
        meshopt(Borders::PreserveArea).fitted(),
        meshopt(Borders::Dilate).fitted(),
    ]
}

/// Cases that trade time for accuracy.
fn speed() -> Vec<Case> {
    let mut cases = vec![look(), look().unfitted(), information()];
    let fewer = [
        Views::Octahedron,
        Views::Cube,
        Views::Icosahedron,
        Views::Variable,
    ];
    cases.extend(fewer.map(|views| information().views(views)));
    cases.extend([64, 128, 256, 512, 1024].map(|pixels| information().pixels(pixels)));
    let more = [Views::Dodecahedron, Views::Both, Views::Dodecahedra];
    cases.extend(more.map(|views| information().views(views)));
    // As many pixels for each leaf as 256 of 60 degrees have, and as many in all.
    let tight = |pixels| information().seen_by(FieldOfView::Tight).pixels(pixels);
    cases.extend([tight(160), tight(256), look().seen_by(FieldOfView::Tight)]);
    cases.extend([
        look().views(Views::Turning),
        look().of_triangles(),
        information().of_triangles(),
        information().of_triangles().unfitted(),
        fsa(),
        stochastic(),
        meshopt(Borders::PreserveArea),
    ]);
    cases
}

/// Methods under every perturbation, then settings that should matter little.
fn stability(by_branches: &[Case]) -> Vec<Case> {
    let methods = [
        look(),
        information(),
        look().of_triangles(),
        information().of_triangles(),
        fsa(),
        stochastic(),
        meshopt(Borders::PreserveArea),
    ];
    let perturbed = |case: &Case| Perturbation::ALL.map(|change| case.clone().perturbed(change));
    let mut cases: Vec<Case> = (methods.iter().chain(by_branches))
        .flat_map(perturbed)
        .collect();
    cases.extend([64, 256, 1024].map(|pixels| information().pixels(pixels)));
    let views = [Views::Octahedron, Views::Icosahedron, Views::Geodesic];
    cases.extend(views.map(|views| information().views(views)));
    cases.extend([
        information().with_vds(|vds| vds.ties = Ties::Spread),
        information().solid_leaves(),
        stochastic_of_seed(1),
        stochastic_of_seed(2),
    ]);
    cases
}

/// The cases of plans on trees of the user's, each once. `knows_branches`: whether the tree has a
/// skeleton, so that methods that need one can be run on it.
pub(crate) fn cases(plans: &[Plan], knows_branches: bool) -> Vec<Case> {
    let by_branches = match knows_branches {
        true => by_branches().to_vec(),
        false => Vec::new(),
    };
    let planned = plans.iter().flat_map(|plan| match plan {
        Plan::Methods => {
            let chains = match knows_branches {
                true => other_chains().to_vec(),
                false => Vec::new(),
            };
            [methods(), by_branches.clone(), chains].concat()
        }
        Plan::Speed => [speed(), by_branches.clone()].concat(),
        Plan::Stability => stability(&by_branches),
        Plan::Fairness => fairness::cases(),
        Plan::Metrics if knows_branches => by_metrics(),
        // None is of cases on leaves.
        Plan::Failures | Plan::Whole | Plan::Scene | Plan::Walk | Plan::Metrics => Vec::new(),
        Plan::Paper => [paper::cases(), paper::fewer_views().to_vec()].concat(),
    });
    each_once(planned)
}

/// Cases that ask for the same have the same label.
pub(crate) fn each_once(cases: impl IntoIterator<Item = Case>) -> Vec<Case> {
    let mut different: Vec<Case> = Vec::new();
    for case in cases {
        if !different.iter().any(|known| known.label() == case.label()) {
            different.push(case);
        }
    }
    different
}

#[cfg(test)]
mod tests {
    use super::*;
    use secateur_simplify::{Fitting, LeafTriangles, Options, Target};
    use std::path::Path;

    use crate::LevelOf;

    const ALL: [Plan; 5] = [
        Plan::Methods,
        Plan::Speed,
        Plan::Stability,
        Plan::Fairness,
        Plan::Paper,
    ];

    /// Rows of studies that were made before are found by these words.
    #[test]
    fn settings_are_spelled_as_in_committed_rows() {
        let labels: Vec<String> = methods().iter().map(Case::label).collect();
        let expected = [
            "vds",
            "vds fit=none",
            "vds preset information",
            "vds preset information resize none",
            "vds preset information reference previous resize deficit neighbours 4",
            "vds preset information reference previous resize deficit neighbours 4 max-coverage 1",
            "vds triangles",
            "vds triangles fit=none",
            "vds triangles preset information",
            "vds triangles preset information fit=none",
            "fsa corners furthest",
            "fsa corners furthest hausdorff surface",
            "fsa",
            "stochastic",
            "stochastic area-weight 0.5",
            "meshopt",
            "meshopt preserve-area",
            "meshopt dilate-borders",
            "fsa corners furthest fit=coverage",
            "stochastic fit=coverage",
            "meshopt preserve-area fit=coverage",
            "meshopt dilate-borders fit=coverage",
        ];
        assert_eq!(labels, expected);
        let labels: Vec<String> = speed()[3..12].iter().map(Case::setting).collect();
        let expected = [
            "views 6",
            "views 8",
            "views 12",
            "views vnc",
            "resolution 64",
            "resolution 128",
            "resolution 256",
            "resolution 512",
            "resolution 1024",
        ];
        assert_eq!(labels, expected.map(|s| format!("preset information {s}")));
        let labels: Vec<String> = speed()[12..19].iter().map(Case::setting).collect();
        let expected = [
            "preset information views dodecahedron",
            "preset information views 32",
            "preset information views 60",
            "preset information field-of-view tight resolution 160",
            "preset information field-of-view tight resolution 256",
            "field-of-view tight",
            "views turning",
        ];
        assert_eq!(labels, expected);
        let settings: Vec<String> = stability(&[]).iter().map(Case::label).collect();
        let expected = [
            "vds preset information views 92",
            "vds preset information ties spread",
            "vds preset information alpha ignore",
            "stochastic seed 1",
            "stochastic seed 2",
        ];
        assert_eq!(settings[settings.len() - 5..], expected);
        assert_eq!(settings[1], "vds views turned 1");
        assert_eq!(settings[9], "vds preset information, views turned 1");
        let labels = by_branches().map(|case| case.label());
        assert_eq!(labels, ["chain", "merge", "merge cluster-size area"]);
        let labels = other_chains().map(|case| case.setting());
        let expected = ["children", "descendants", "longest-path"];
        assert_eq!(labels, expected.map(|m| format!("branch-metric {m}")));
    }

    #[test]
    fn cases_of_every_plan_can_be_told_apart() {
        for plan in ALL {
            let [without, with] = [false, true].map(|b| cases(&[plan], b));
            assert_eq!(each_once(with.clone()), with, "{plan:?}");
            assert!(without.len() <= with.len());
        }
        // What two plans have in common is run once.
        assert!(cases(&ALL, true).len() < ALL.iter().map(|p| cases(&[*p], true).len()).sum());
    }

    #[test]
    fn methods_by_branches_are_for_trees_that_know_them() {
        let count = |plan, knows_branches| {
            let cases = cases(&[plan], knows_branches);
            cases.iter().filter(|case| case.needs_skeleton()).count()
        };
        let methods = by_branches().len();
        for (plan, expected) in [
            (Plan::Methods, methods + other_chains().len()),
            (Plan::Speed, methods),
            (Plan::Stability, methods * Perturbation::ALL.len()),
        ] {
            assert_eq!(count(plan, false), 0, "{plan:?}");
            assert_eq!(count(plan, true), expected, "{plan:?}");
        }
    }

    /// What the study takes for one run to the coarsest level is cut where each run of its own
    /// ends.
    #[test]
    fn only_orders_that_levels_share_are_cut() {
        for case in by_branches() {
            assert!(case.has_prefixes() && !case.takes_seeds());
        }
        let with = |change: fn(&mut Options)| {
            let mut options = look().options(1.0, None).unwrap();
            change(&mut options);
            Case::new(options, LevelOf::Leaves)
        };
        for case in [
            meshopt(Borders::Stay),
            look().of_triangles(),
            look(),
            with(|options| options.leaf_triangles = LeafTriangles::AtMost(2)),
            with(|options| options.fit = Fitting::Weight(3.0)),
        ] {
            assert!(!case.has_prefixes(), "{}", case.label());
        }
        for case in [look().unfitted(), information().unfitted(), fsa()] {
            assert!(case.has_prefixes(), "{}", case.label());
        }
        assert!(stochastic().takes_seeds() && !stochastic_of_seed(1).takes_seeds());
    }

    #[test]
    fn levels_of_a_case_of_triangles_are_shares_of_them() {
        let case = look().with_vds(|vds| vds.neighbours = 4).of_triangles();
        assert_eq!(case.setting(), "triangles neighbours 4");
        for share in [0.25, 1.0] {
            let options = case.options(share, None).unwrap();
            assert_eq!(options.target, Target::triangle_share(share));
        }
        let command = case.command(Path::new("a.glb"), 1.0, None);
        assert!(
            command
                .contains("--triangles 1.0 --wood ignore --no-audit --method vds --neighbours 4")
        );
    }

    #[test]
    fn a_command_gives_a_level_again() {
        let case = resized(Resize::None);
        let command = case.command(Path::new("a.glb"), 0.25, Some(3));
        let expected = "secateur simplify a.glb -o out.glb --ratio 0.25 --no-audit --method vds \
             --preset information --resize none --seed 3";
        assert_eq!(command, expected);
        let near = information().seen_from("near", Path::new("trees/a-cameras.json"));
        assert_eq!(near.setting(), "preset information views near");
        let command = near.command(Path::new("a.glb"), 0.5, None);
        assert!(command.ends_with("--preset information --views trees/a-cameras.json"));
    }
}
