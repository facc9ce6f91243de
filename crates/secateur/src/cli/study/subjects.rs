//! What is studied: trees of the user's, and those that a plan makes itself.

use std::path::{Path, PathBuf};

use secateur::{BoundingSphere, Document, Plant, Selector, Tree, plant_to_glb};
use secateur_plant::{GrowOptions, grow};

use super::super::args::{self, PlanName};
use super::super::failure::Failure;
use super::super::output;
use super::paper::{self, Model};
use super::plan::{self, Case};
use super::scenes::{NEAR, SCENES, Scene, near_cameras};

const LEVELS: [f64; 4] = [0.5, 0.25, 0.1, 0.01];
/// A hundredth of so few leaves is none.
const SCENE_LEVELS: [f64; 2] = [0.5, 0.1];

/// A tree and what is run on it.
pub(super) struct Subject {
    /// Tells trees apart in rows and files.
    pub(super) name: String,
    pub(super) path: PathBuf,
    pub(super) cases: Vec<Case>,
    /// From how many radii it is judged; nothing for the held-out views as they
    /// are.
    pub(super) judged_from_radii: Option<f64>,
    made: Made,
}

/// Where a tree comes from.
enum Made {
    ByOthers,
    Scene(&'static Scene),
    Grown(&'static Model),
}

/// Everything that is asked for; names differ.
///
/// # Errors
/// [`Failure`] if there is nothing to study, two trees have one name or a case
/// is no method with options.
pub(super) fn subjects(args: &args::Study) -> Result<Vec<Subject>, Failure> {
    let mut subjects = Vec::new();
    let has = |plan: PlanName| args.case.is_empty() && args.plan.contains(&plan);
    let cases = plan::cases(&args.plan, &args.case, false)?;
    let with_branches = plan::cases(&args.plan, &args.case, true)?;
    if cases.is_empty() && !args.trees.is_empty() {
        return Err(Failure(
            "no plan for trees of one's own was asked for: add methods, speed, stability or paper to --plan".to_owned(),
        ));
    }
    for path in &args.trees {
        let name = path.file_stem().unwrap_or(path.as_os_str());
        subjects.push(Subject {
            name: name.to_string_lossy().into_owned(),
            path: path.clone(),
            cases: match knows_branches(path, &args.foliage.foliage) {
                true => with_branches.clone(),
                false => cases.clone(),
            },
            judged_from_radii: None,
            made: Made::ByOthers,
        });
    }
    let folder = args.output.join("trees");
    if has(PlanName::Failures) {
        for scene in &SCENES {
            let cameras = folder.join(format!("{}-cameras.json", scene.name));
            let cases: Result<Vec<Case>, Failure> = (scene.cases.iter())
                .map(|text| Case::with_cameras(text, NEAR, &cameras))
                .collect();
            subjects.push(Subject {
                name: scene.name.to_owned(),
                path: folder.join(format!("{}.glb", scene.name)),
                cases: cases?,
                judged_from_radii: Some(scene.judged_from_radii).filter(|radii| *radii != 3.0),
                made: Made::Scene(scene),
            });
        }
    }
    if has(PlanName::Paper) {
        for model in &paper::MODELS {
            let mut cases = paper::CASES.to_vec();
            if model.is_of_fig_5() {
                cases.extend(paper::FEWER_VIEWS);
            }
            subjects.push(Subject {
                path: folder.join(format!("{}.glb", model.tree())),
                name: model.tree(),
                cases: plan::parsed(&cases)?,
                judged_from_radii: None,
                made: Made::Grown(model),
            });
        }
    }
    if subjects.is_empty() {
        return Err(Failure(
            "no tree was given: name one, or ask for --plan failures or paper, which make their own".to_owned(),
        ));
    }
    check_names(&subjects)?;
    let is_there = |name: &&String| subjects.iter().any(|s| s.name == **name);
    if let Some(unknown) = args.only.iter().find(|name| !is_there(name)) {
        return Err(Failure(format!(
            "no tree of this study is called {unknown}"
        )));
    }
    subjects.retain(|s| args.only.is_empty() || args.only.contains(&s.name));
    Ok(subjects)
}

/// Whether a tree has a sound skeleton. What else may be wrong with it is said by
/// [`Subject::check`].
fn knows_branches(path: &Path, selectors: &[Selector]) -> bool {
    let Some(document) = Document::open(path).ok().filter(Document::has_skeleton) else {
        return false;
    };
    let skeleton = document.into_tree(selectors).and_then(|t| t.skeleton());
    if let Err(error) = &skeleton {
        tracing::warn!("{error}: methods that need a skeleton are left out");
    }
    skeleton.is_ok_and(|skeleton| skeleton.is_some())
}

fn check_names(subjects: &[Subject]) -> Result<(), Failure> {
    for (k, subject) in subjects.iter().enumerate() {
        let same = |other: &&Subject| other.name == subject.name;
        if let Some(other) = subjects[..k].iter().find(same) {
            let (a, b, name) = (other.path.display(), subject.path.display(), &subject.name);
            return Err(Failure(format!(
                "{a} and {b} would both be called {name}: rename one"
            )));
        }
    }
    Ok(())
}

impl Subject {
    /// Shares of the leaves, if none are asked for.
    pub(super) fn levels(&self) -> &'static [f64] {
        match self.made {
            Made::Scene(_) => &SCENE_LEVELS,
            _ => &LEVELS,
        }
    }

    /// How its foliage is found: what the user says is of the user's trees.
    pub(super) fn selectors<'s>(&self, of_user: &'s [Selector]) -> &'s [Selector] {
        match self.made {
            Made::ByOthers => of_user,
            _ => &[],
        }
    }

    /// Says now, not when its turn comes, that a tree of the user's cannot be read.
    pub(super) fn check(&self, of_user: &[Selector]) -> Result<(), Failure> {
        if matches!(self.made, Made::ByOthers) {
            Tree::open(&self.path, of_user)?;
        }
        Ok(())
    }

    /// Writes the tree, if the study makes it, and cameras that go with it.
    pub(super) fn prepare(&self) -> Result<(), Failure> {
        let plant = match self.made {
            Made::ByOthers => return Ok(()),
            Made::Scene(scene) => scene.plant(),
            Made::Grown(model) => grown(model)?,
        };
        output::make_folder(self.path.parent().unwrap_or(Path::new(".")))?;
        output::write_file(&self.path, &plant_to_glb(&plant))?;
        if let Made::Scene(scene) = self.made
            && scene.cases.iter().any(|case| case.contains(NEAR))
        {
            let cameras = self
                .path
                .with_file_name(format!("{}-cameras.json", scene.name));
            let text = near_cameras(sphere_of_leaves(&plant));
            output::write_file(&cameras, text.as_bytes())?;
        }
        Ok(())
    }
}

fn grown(model: &Model) -> Result<Plant, Failure> {
    let options = GrowOptions {
        leaves: model.leaves,
        seed: paper::SEED,
    };
    grow(model.species(), &options).map_err(|e| Failure(format!("{}: {e}", model.tree())))
}

/// Near enough for cameras: about the middle of the leaves' box.
fn sphere_of_leaves(plant: &Plant) -> BoundingSphere {
    let places = &plant.leaves.positions;
    let first = places.first().copied().unwrap_or_default();
    let (low, high) = places
        .iter()
        .fold((first, first), |(low, high), p| (low.min(*p), high.max(*p)));
    let centre = 0.5 * (low + high);
    let reach = |p: &glam::DVec3| p.distance(centre);
    BoundingSphere {
        centre,
        radius: places.iter().map(reach).fold(0.0, f64::max),
    }
}

#[cfg(test)]
mod tests {
    use super::super::super::args::{Cli, Command};
    use super::*;
    use clap::Parser;
    use secateur_plant::Species;

    /// A tree that has lost its skeleton does without rule-based levels, in the same
    /// study as one that has them beside the other methods.
    #[test]
    fn a_plan_has_methods_by_branches_where_there_are_branches() {
        let options = GrowOptions {
            leaves: 12,
            seed: 1,
        };
        let whole = grow(Species::Oak, &options).unwrap();
        let bare = Plant {
            skeleton: None,
            ..whole.clone()
        };
        let glb = plant_to_glb(&whole);
        let mut damaged = glb.clone();
        let name = b"segment_sides";
        let at = glb.windows(name.len()).position(|w| w == name).unwrap();
        damaged[at] = b'S';
        let folder = tempfile::tempdir().unwrap();
        let bare = plant_to_glb(&bare);
        let files = [("whole", glb), ("bare", bare), ("damaged", damaged)];
        let paths = files.map(|(name, bytes)| {
            let path = folder.path().join(format!("{name}.glb"));
            std::fs::write(&path, bytes).unwrap();
            path.display().to_string()
        });
        let study = ["secateur", "study", "-o", "s"].map(str::to_owned);
        let words = study.into_iter().chain(paths);
        let Command::Study(args) = Cli::try_parse_from(words).unwrap().command else {
            panic!("a study");
        };
        let subjects = subjects(&args).unwrap();
        let by_branches = subjects.iter().map(|subject| {
            let methods = subject.cases.iter().map(|case| case.method.as_str());
            let found: Vec<&str> = methods.filter(|m| ["chain", "merge"].contains(m)).collect();
            (subject.name.as_str(), found)
        });
        let expected = [
            ("whole", vec!["chain", "merge", "merge"]),
            ("bare", vec![]),
            ("damaged", vec![]),
        ];
        assert_eq!(by_branches.collect::<Vec<_>>(), expected);
    }
}
