//! A tree of a study: the user's, or one that a plan makes itself.

use std::path::{Path, PathBuf};

use secateur_eval::JudgingViews;
use secateur_gltf::{Document, Selector, Tree, plant_to_glb};
use secateur_model::{BoundingSphere, Memory, Plant};
use secateur_plant::{GrowOptions, Species, grow};

use crate::distances;
use crate::files::make_folder;
use crate::named_cases::by_metrics;
use crate::paper::{self, Model};
use crate::scenes::{FailureScene, SCENES, near_cameras};
use crate::{Case, Error, Host, JudgedLeaves, Plan, StudyOptions, plan, walk};

const LEVELS: [f64; 4] = [0.5, 0.25, 0.1, 0.01];
/// Scenes have too few leaves for a hundredth of them.
const SCENE_LEVELS: [f64; 2] = [0.5, 0.1];

/// The levels at which metrics of branches are compared, and on what.
const METRIC_LEVELS: [f64; 3] = [0.5, 0.25, 0.1];
const METRIC_LEAVES: u32 = 2000;
const METRIC_SPECIES: [Species; 5] = [
    Species::Oak,
    Species::Birch,
    Species::Maple,
    Species::Alder,
    Species::Willow,
];

/// A tree and the cases that are run on it.
pub(crate) struct Subject {
    /// What rows and files call it; no two trees of a study have one name.
    pub(crate) name: String,
    pub(crate) path: PathBuf,
    pub(crate) cases: Vec<Case>,
    /// Which views judge it.
    pub(crate) judged_by: JudgingViews,
    /// As what its leaves are judged.
    pub(crate) judged_leaves: JudgedLeaves,
    /// The distance of the judging views in radii, if it is not the usual one.
    pub(crate) judged_from_radii: Option<f64>,
    /// Whether it is studied as a whole plant too.
    pub(crate) is_seen_whole: bool,
    /// Whether it is studied at the distances of a walk too.
    pub(crate) is_seen_from_distances: bool,
    origin: Origin,
}

/// Where a tree comes from.
enum Origin {
    ByOthers,
    Scene(&'static FailureScene),
    Grown(&'static Model),
    Species(Species),
}

/// The trees that a study is asked for.
///
/// # Errors
/// [`Error`] if there is nothing to study, or two trees have one name.
pub(crate) fn subjects(options: &StudyOptions) -> Result<Vec<Subject>, Error> {
    let has = |plan: Plan| options.cases.is_empty() && options.plans.contains(&plan);
    if has(Plan::Scene) {
        distances::check(options)?;
    }
    let mut subjects = of_user(options)?;
    let folder = options.folder.join("trees");
    let views_or = |of_plan| options.views.unwrap_or(of_plan);
    if has(Plan::Failures) {
        let judged_by = views_or(JudgingViews::HeldOut);
        subjects.extend(
            SCENES
                .iter()
                .map(|scene| of_scene(scene, &folder, judged_by)),
        );
    }
    if has(Plan::Paper) {
        let judged_by = views_or(JudgingViews::Icosahedron);
        let models = paper::MODELS.iter();
        subjects.extend(models.map(|model| of_model(model, &folder, judged_by)));
    }
    if has(Plan::Metrics) {
        let judged_by = views_or(JudgingViews::HeldOut);
        let species = METRIC_SPECIES.into_iter();
        subjects.extend(species.map(|species| of_species(species, &folder, judged_by)));
    }
    let has_walk = has(Plan::Walk);
    if subjects.is_empty() && !has_walk {
        return Err(Error::Refused(
            "no tree was given: name one, or ask for --plan failures, paper, walk or metrics, which make their own".to_owned(),
        ));
    }
    check_names(&subjects)?;
    if let Some(same) = (subjects.iter()).find(|s| has_walk && s.name == walk::NAME) {
        let path = same.path.display();
        let why = format!("{path} would be called as the woods of --plan walk are: rename it");
        return Err(Error::Refused(why));
    }
    let is_there = |name: &&String| {
        subjects.iter().any(|s| s.name == **name) || has_walk && **name == walk::NAME
    };
    if let Some(unknown) = options.only.iter().find(|name| !is_there(name)) {
        return Err(Error::Refused(format!(
            "no tree of this study is called {unknown}"
        )));
    }
    subjects.retain(|s| options.only.is_empty() || options.only.contains(&s.name));
    Ok(subjects)
}

/// The user's own trees.
fn of_user(options: &StudyOptions) -> Result<Vec<Subject>, Error> {
    let has = |plan: Plan| options.cases.is_empty() && options.plans.contains(&plan);
    // Where nothing else is asked for, the paper's plan alone is judged as the paper judges.
    let is_papers = options.cases.is_empty() && options.plans == [Plan::Paper];
    let (judged_by, judged_leaves) = match is_papers {
        true => (JudgingViews::Icosahedron, JudgedLeaves::Solid),
        false => (JudgingViews::HeldOut, JudgedLeaves::AsInFile),
    };
    let cases_of = |knows_branches| match options.cases.is_empty() {
        true => plan::cases(&options.plans, knows_branches),
        false => plan::each_once(options.cases.iter().cloned()),
    };
    let (cases, with_branches) = (cases_of(false), cases_of(true));
    let has_other = has(Plan::Whole) || has(Plan::Scene);
    if cases.is_empty() && !has_other && !options.trees.is_empty() {
        return Err(Error::Refused(
            "no plan for trees of one's own was asked for: add methods, speed, stability, paper, whole, scene or metrics to --plan".to_owned(),
        ));
    }
    let subject = |path: &PathBuf| Subject {
        name: path
            .file_stem()
            .unwrap_or(path.as_os_str())
            .to_string_lossy()
            .into_owned(),
        path: path.clone(),
        cases: match knows_branches(path, &options.selectors, options.memory) {
            true => with_branches.clone(),
            false => cases.clone(),
        },
        judged_by: options.views.unwrap_or(judged_by),
        judged_leaves,
        judged_from_radii: None,
        is_seen_whole: has(Plan::Whole),
        is_seen_from_distances: has(Plan::Scene),
        origin: Origin::ByOthers,
    };
    Ok(options.trees.iter().map(subject).collect())
}

/// A scene on which methods fail.
fn of_scene(scene: &'static FailureScene, folder: &Path, judged_by: JudgingViews) -> Subject {
    let path = folder.join(format!("{}.glb", scene.name));
    Subject {
        name: scene.name.to_owned(),
        cases: (scene.cases)(&cameras_beside(&path)),
        path,
        judged_by,
        judged_leaves: JudgedLeaves::AsInFile,
        judged_from_radii: Some(scene.judged_from_radii).filter(|radii| *radii != 3.0),
        is_seen_whole: false,
        is_seen_from_distances: false,
        origin: Origin::Scene(scene),
    }
}

/// A plant such as those of the paper.
fn of_model(model: &'static Model, folder: &Path, judged_by: JudgingViews) -> Subject {
    let mut cases = paper::cases();
    if model.is_of_fig_5() {
        cases.extend(paper::fewer_views());
    }
    Subject {
        path: folder.join(format!("{}.glb", model.tree())),
        name: model.tree(),
        cases,
        judged_by,
        judged_leaves: JudgedLeaves::Solid,
        judged_from_radii: None,
        is_seen_whole: false,
        is_seen_from_distances: false,
        origin: Origin::Grown(model),
    }
}

/// A plant on whose branches metrics are compared.
fn of_species(species: Species, folder: &Path, judged_by: JudgingViews) -> Subject {
    let name = format!("{}-{METRIC_LEAVES}", species.name());
    Subject {
        path: folder.join(format!("{name}.glb")),
        name,
        cases: by_metrics(),
        judged_by,
        judged_leaves: JudgedLeaves::AsInFile,
        judged_from_radii: None,
        is_seen_whole: false,
        is_seen_from_distances: false,
        origin: Origin::Species(species),
    }
}

/// Whether a tree has a sound skeleton. What else may be wrong with it is said by
/// [`Subject::check`].
fn knows_branches(path: &Path, selectors: &[Selector], memory: Memory) -> bool {
    let document = Document::open_within(path, memory).ok();
    let Some(document) = document.filter(Document::has_skeleton) else {
        return false;
    };
    let skeleton = document.into_tree(selectors).and_then(|t| t.skeleton());
    if let Err(error) = &skeleton {
        tracing::warn!("{error}: methods that need a skeleton are left out");
    }
    skeleton.is_ok_and(|skeleton| skeleton.is_some())
}

fn check_names(subjects: &[Subject]) -> Result<(), Error> {
    for (k, subject) in subjects.iter().enumerate() {
        let same = |other: &&Subject| other.name == subject.name;
        if let Some(other) = subjects[..k].iter().find(same) {
            let (a, b, name) = (other.path.display(), subject.path.display(), &subject.name);
            return Err(Error::Refused(format!(
                "{a} and {b} would both be called {name}: rename one"
            )));
        }
    }
    Ok(())
}

impl Subject {
    /// The levels that are run if the user names none.
    pub(crate) fn levels(&self) -> &'static [f64] {
        match self.origin {
            Origin::Scene(_) => &SCENE_LEVELS,
            Origin::Species(_) => &METRIC_LEVELS,
            Origin::ByOthers | Origin::Grown(_) => &LEVELS,
        }
    }

    /// The selectors of its foliage: the user's for the user's trees, none for trees that the
    /// study makes.
    pub(crate) fn selectors<'s>(&self, of_user: &'s [Selector]) -> &'s [Selector] {
        match self.origin {
            Origin::ByOthers => of_user,
            Origin::Scene(_) | Origin::Grown(_) | Origin::Species(_) => &[],
        }
    }

    /// Fails if a tree of the user's can't be read, so that a study does not find out in the
    /// middle.
    pub(crate) fn check(&self, of_user: &[Selector], memory: Memory) -> Result<(), Error> {
        if matches!(self.origin, Origin::ByOthers) {
            Tree::open_within(&self.path, of_user, memory)?;
        }
        Ok(())
    }

    /// Writes the tree, if the study makes it, and cameras that go with it.
    pub(crate) fn prepare(&self, host: &dyn Host) -> Result<(), Error> {
        let plant = match self.origin {
            Origin::ByOthers => return Ok(()),
            Origin::Scene(scene) => scene.plant(),
            Origin::Grown(model) => grown(&model.tree(), model.species(), model.leaves)?,
            Origin::Species(species) => grown(&self.name, species, METRIC_LEAVES)?,
        };
        let write = |path: &Path, bytes: &[u8]| host.write_file(path, bytes);
        make_folder(self.path.parent().unwrap_or(Path::new(".")))?;
        write(&self.path, &plant_to_glb(&plant)).map_err(Error::Refused)?;
        if self.cases.iter().any(Case::has_cameras) {
            let text = near_cameras(sphere_of_leaves(&plant));
            write(&cameras_beside(&self.path), text.as_bytes()).map_err(Error::Refused)?;
        }
        Ok(())
    }
}

/// The file of near cameras beside a scene's tree.
fn cameras_beside(tree: &Path) -> PathBuf {
    let name = tree.file_stem().unwrap_or_default().to_string_lossy();
    tree.with_file_name(format!("{name}-cameras.json"))
}

fn grown(name: &str, species: Species, leaves: u32) -> Result<Plant, Error> {
    let options = GrowOptions {
        leaves,
        seed: paper::SEED,
    };
    grow(species, &options).map_err(|e| Error::Refused(format!("{name}: {e}")))
}

/// A sphere about the leaves, with its centre in the middle of their box; not the least one, but
/// near enough to place cameras.
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
    use super::*;

    fn options_of(trees: &[PathBuf], folder: &Path, plan: Plan) -> StudyOptions {
        StudyOptions {
            trees: trees.to_vec(),
            folder: folder.join("s"),
            selectors: Vec::new(),
            plans: vec![plan],
            cases: Vec::new(),
            views: None,
            levels: Vec::new(),
            distances_m: Vec::new(),
            only: Vec::new(),
            frames_up_to_px: 128,
            seeds: 1,
            memory: Memory::Auto,
        }
    }

    /// What drives in the paper's plan is what is judged, of the user's trees too.
    #[test]
    fn the_papers_plan_judges_the_leaves_that_drive_it() {
        let folder = tempfile::tempdir().unwrap();
        let glb = plant_to_glb(
            &grow(
                Species::Oak,
                &GrowOptions {
                    leaves: 12,
                    seed: 1,
                },
            )
            .unwrap(),
        );
        let path = folder.path().join("oak.glb");
        std::fs::write(&path, glb).unwrap();
        let judged = |plan| {
            let of_plan = subjects(&options_of(
                std::slice::from_ref(&path),
                folder.path(),
                plan,
            ));
            let judged = of_plan
                .unwrap()
                .into_iter()
                .map(|subject| subject.judged_leaves);
            judged.collect::<Vec<_>>()
        };
        assert_eq!(
            judged(Plan::Paper),
            [JudgedLeaves::Solid; 1 + paper::MODELS.len()]
        );
        assert_eq!(judged(Plan::Methods), [JudgedLeaves::AsInFile]);
        let tree = Tree::open(&path, &[]).unwrap();
        let is_cut_out = |leaves: &secateur_model::Foliage| {
            leaves.leaves().iter().any(|leaf| leaf.cutout().is_some())
        };
        assert!(is_cut_out(&JudgedLeaves::AsInFile.of(tree.foliage())));
        assert!(!is_cut_out(&JudgedLeaves::Solid.of(tree.foliage())));
    }

    /// Five grown species with the chain by each metric, at three levels; a walk has no tree of its own.
    #[test]
    fn plans_that_grow_their_own_need_no_tree() {
        let folder = tempfile::tempdir().unwrap();
        let of = |plan| subjects(&options_of(&[], folder.path(), plan)).unwrap();
        let grown = of(Plan::Metrics);
        assert_eq!(grown.len(), 5);
        for subject in &grown {
            let methods: Vec<&str> = subject.cases.iter().map(Case::method).collect();
            assert_eq!(methods, ["chain"; 4]);
            assert_eq!(subject.levels(), [0.5, 0.25, 0.1]);
        }
        assert!(of(Plan::Walk).is_empty());
        let named = |name: &str| {
            let only = vec![name.to_owned()];
            let options = options_of(&[], folder.path(), Plan::Walk);
            subjects(&StudyOptions { only, ..options }).is_ok()
        };
        assert!(named("walk") && !named("elm"));
    }

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
            path
        });
        let subjects = subjects(&options_of(&paths, folder.path(), Plan::Methods)).unwrap();
        let by_branches = subjects.iter().map(|subject| {
            let methods = subject.cases.iter().map(Case::method);
            let found: Vec<&str> = methods.filter(|m| ["chain", "merge"].contains(m)).collect();
            (subject.name.as_str(), found)
        });
        let expected = [
            (
                "whole",
                vec!["chain", "merge", "merge", "chain", "chain", "chain"],
            ),
            ("bare", vec![]),
            ("damaged", vec![]),
        ];
        assert_eq!(by_branches.collect::<Vec<_>>(), expected);
    }
}
