//! What a study runs on a tree: a method with its options.

use std::path::{Path, PathBuf};

use secateur_levels::{CutoffChoice, MaterialChange};
use secateur_raster::read_cameras;
use secateur_simplify::vds::VdsOptions;
use secateur_simplify::{
    Alpha, FieldOfView, Fitting, Method, Options, Preset, Resolution, Sides, Target, Views,
};
use serde::{Deserialize, Serialize};

use crate::flags::{TRIANGLES, flags};
use crate::shell;
use crate::{Error, Perturbation};

/// What the levels of a case are shares of.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "cli", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum LevelOf {
    /// The leaves of the original.
    #[default]
    Leaves,
    /// The triangles of its leaves.
    Triangles,
}

impl LevelOf {
    fn target(self, share: f64) -> Target {
        match self {
            Self::Leaves => Target::leaf_share(share),
            Self::Triangles => Target::triangle_share(share),
        }
    }
}

/// A method with options, on a tree as it is or changed a little.
#[derive(Clone, Debug, PartialEq)]
pub struct Case {
    /// All but the target, which is the level's.
    options: Options,
    level_of: LevelOf,
    /// Which cutoffs its levels have; with chosen ones clear texels get the colours of leaves.
    cutoffs: CutoffChoice,
    perturbation: Perturbation,
    /// Where views come from, if they are cameras of a file.
    cameras: Option<CameraFile>,
}

/// A file of cameras, read when a run begins: a study may have to write it first.
#[derive(Clone, Debug, PartialEq)]
struct CameraFile {
    /// What rows call it.
    name: String,
    path: PathBuf,
}

impl Case {
    /// A case of these options on trees as they are; their target is left aside.
    pub fn new(options: Options, level_of: LevelOf) -> Self {
        Self {
            options: Options {
                target: level_of.target(1.0),
                skeleton: None,
                ..options
            },
            level_of,
            cutoffs: CutoffChoice::Auto,
            perturbation: Perturbation::None,
            cameras: None,
        }
    }

    /// This case, seen from the cameras of a file, by what rows call it.
    pub fn seen_from(mut self, name: &str, path: &Path) -> Self {
        self.options.views = self.options.preset.views();
        self.cameras = Some(CameraFile {
            name: name.to_owned(),
            path: path.to_owned(),
        });
        self
    }

    /// This case with levels that have these alpha cutoffs, and the colours that `simplify` gives with them.
    pub fn with_cutoffs(mut self, cutoffs: CutoffChoice) -> Self {
        self.cutoffs = cutoffs;
        self
    }

    /// What may be done to the cutoffs of its levels; none where they stay.
    pub(crate) fn material_change(&self) -> Option<MaterialChange> {
        self.cutoffs.change(&self.options)
    }

    /// The method as `--method` spells it.
    pub fn method(&self) -> &'static str {
        self.options.method.name()
    }

    /// What its levels are shares of.
    pub fn level_of(&self) -> LevelOf {
        self.level_of
    }

    /// What of a tree or its views is changed a little.
    pub fn perturbation(&self) -> Perturbation {
        self.perturbation
    }

    /// What differs from the method's defaults, as on the command line without dashes.
    pub fn setting(&self) -> String {
        let cameras = self.cameras.as_ref().map(|file| file.name.as_str());
        flags(&self.options, self.level_of, self.cutoffs, cameras).join(" ")
    }

    /// Method, setting and change, as [`Row::label`](crate::Row::label).
    pub fn label(&self) -> String {
        let variant = [self.setting(), self.perturbation.name()];
        let variant: Vec<String> = variant.into_iter().filter(|v| !v.is_empty()).collect();
        match variant.is_empty() {
            true => self.method().to_owned(),
            false => format!("{} {}", self.method(), variant.join(", ")),
        }
    }

    /// How to get one level again; of a changed tree, without the change.
    pub fn command(&self, tree: &Path, level: f64, seed: Option<u64>) -> String {
        let mut command = format!("secateur simplify {} -o out.glb ", shell::path(tree));
        command += &match self.level_of {
            // Never a whole number, which would be one of triangles.
            LevelOf::Triangles => format!("--triangles {level:?} --wood ignore"),
            LevelOf::Leaves => format!("--ratio {level}"),
        };
        command += &format!(" --no-audit --method {}", self.method());
        let cameras = self.cameras.as_ref();
        let cameras = cameras.map(|file| shell::path(&file.path));
        let flags = flags(
            &self.options,
            self.level_of,
            self.cutoffs,
            cameras.as_deref(),
        );
        for flag in flags.iter().filter(|flag| *flag != TRIANGLES) {
            command += &format!(" --{flag}");
        }
        if let Some(seed) = seed {
            command += &format!(" --seed {seed}");
        }
        match self.perturbation {
            Perturbation::None => command,
            change => format!("{command} (on the tree with: {})", change.name()),
        }
    }

    /// What a run to a level is to do.
    ///
    /// # Errors
    /// [`Error::Cameras`] if its cameras can't be read.
    pub fn options(&self, level: f64, seed: Option<u64>) -> Result<Options, Error> {
        let mut options = self.options.clone();
        options.target = self.level_of.target(level);
        if let (Some(seed), Method::Stochastic(own)) = (seed, &mut options.method) {
            own.seed = seed;
        }
        if let Some(file) = &self.cameras {
            options.views = Views::Cameras(read_cameras(&file.path)?);
        }
        Ok(options)
    }

    /// Whether one run to the coarsest level gives all finer ones, a leaf a step.
    pub fn has_prefixes(&self) -> bool {
        self.options.levels_share_one_order()
    }

    /// Whether each seed of the study is a run of its own: its method draws lots, and it names
    /// no seed itself.
    pub fn takes_seeds(&self) -> bool {
        matches!(&self.options.method, Method::Stochastic(own) if own.seed == 0)
    }

    /// Whether it is only for trees with a skeleton.
    pub fn needs_skeleton(&self) -> bool {
        self.options.method.needs_skeleton()
    }

    /// Whether its views are cameras of a file.
    pub(crate) fn has_cameras(&self) -> bool {
        self.cameras.is_some()
    }
}

/// Cases by what sets them apart from the defaults, for plans.
impl Case {
    /// A method with its usual options.
    pub(crate) fn of(method: Method) -> Self {
        let mut case = Self::vds(Preset::default());
        case.options.method = method;
        case
    }

    pub(crate) fn vds(preset: Preset) -> Self {
        let options = Options {
            audit: false,
            ..Options::with_preset(preset, Target::leaf_share(1.0))
        };
        Self::new(options, LevelOf::Leaves)
    }

    pub(crate) fn of_triangles(self) -> Self {
        Self::new(self.options, LevelOf::Triangles)
    }

    pub(crate) fn unfitted(mut self) -> Self {
        self.options.fit = Fitting::None;
        self
    }

    /// Sizes fitted at the end as the default of VDS has it.
    pub(crate) fn fitted(mut self) -> Self {
        self.options.fit = Fitting::Coverage;
        self
    }

    pub(crate) fn views(mut self, views: Views) -> Self {
        self.options.views = views;
        self
    }

    pub(crate) fn seen_by(mut self, field_of_view: FieldOfView) -> Self {
        self.options.field_of_view = field_of_view;
        self
    }

    pub(crate) fn pixels(mut self, resolution: u32) -> Self {
        self.options.resolution = Resolution::Pixels(resolution);
        self
    }

    /// With other options of VDS.
    ///
    /// # Panics
    /// If its method is another.
    pub(crate) fn with_vds(mut self, change: impl FnOnce(&mut VdsOptions)) -> Self {
        change(self.options.method.vds_mut().expect("a case of VDS"));
        self
    }

    pub(crate) fn solid_leaves(mut self) -> Self {
        self.options.alpha = Alpha::Ignore;
        self
    }

    /// Leaves as the paper has them: whole polygons, seen from both sides.
    pub(crate) fn with_leaves_of_paper(mut self) -> Self {
        self.options.sides = Sides::Both;
        self.solid_leaves()
    }

    pub(crate) fn perturbed(mut self, perturbation: Perturbation) -> Self {
        self.perturbation = perturbation;
        self
    }
}
