//! How options are written on the command line of `simplify`: what differs from the defaults, in
//! one order. Rows name their settings by these words, and commands are made of them.

use secateur_levels::CutoffChoice;
use secateur_plant::{ClusterSize, Metric};
use secateur_raster::Engine;
use secateur_simplify::fit::DEFAULT_OUTLINE_WEIGHT;
use secateur_simplify::fsa::FsaOptions;
use secateur_simplify::meshopt::{Borders, MeshoptOptions, Mode};
use secateur_simplify::stochastic::StochasticOptions;
use secateur_simplify::vds::{Ties, VdsOptions};
use secateur_simplify::{FieldOfView, Fitting, Method, Options, Preset, Views};
use serde::Serialize;

use crate::LevelOf;

/// The options that differ from those of their method and preset, without dashes: `views 6`,
/// `fit=none`. `cameras` stands for cameras from a file.
pub(crate) fn flags(
    options: &Options,
    level_of: LevelOf,
    cutoffs: CutoffChoice,
    cameras: Option<&str>,
) -> Vec<String> {
    let mut flags = Flags(Vec::new());
    if level_of == LevelOf::Triangles {
        flags.push(TRIANGLES.to_owned());
    }
    flags.differing("preset", options.preset, Preset::default());
    flags.of_method(&options.method, options.preset);
    if options.leaf_triangles != options.preset.leaf_triangles() {
        flags.push(format!("leaf-triangles {}", options.leaf_triangles));
    }
    flags.differing("needles", options.needles, options.preset.needles());
    match cameras {
        Some(name) => flags.push(format!("views {name}")),
        None if options.views != options.preset.views() => {
            flags.push(format!("views {}", name_of(&options.views)));
        }
        None => {}
    }
    if options.field_of_view != FieldOfView::Auto {
        flags.push(format!("field-of-view {}", options.field_of_view));
    }
    if options.resolution != options.preset.resolution() {
        flags.push(format!("resolution {}", options.resolution));
    }
    if let Some(own) = options.method.vds() {
        flags.differing("ties", own.ties, Ties::default());
    }
    flags.differing("alpha", options.alpha, options.preset.alpha());
    flags.differing("sides", options.sides, options.preset.sides());
    flags.differing("engine", options.engine, Engine::default());
    match options.fit {
        Fitting::Auto => {}
        Fitting::Weight(DEFAULT_OUTLINE_WEIGHT) => flags.push("fit".to_owned()),
        fit => flags.push(format!("fit={fit}")),
    }
    flags.differing("cutoffs", cutoffs, CutoffChoice::Auto);
    if options.audit {
        flags.push("audit".to_owned());
    }
    flags.0
}

/// Says that levels are shares of triangles; on the command line a number follows.
pub(crate) const TRIANGLES: &str = "triangles";

/// The words gathered so far.
struct Flags(Vec<String>);

impl Flags {
    fn push(&mut self, flag: String) {
        self.0.push(flag);
    }

    /// What differs in the method's own options.
    fn of_method(&mut self, method: &Method, preset: Preset) {
        match method {
            Method::Vds(own) | Method::VdsReference(own) => self.of_vds(own, preset.vds()),
            Method::Fsa(own) => {
                let usual = FsaOptions::default();
                self.number(
                    "distance-weight",
                    own.distance_weight,
                    usual.distance_weight,
                );
                self.number(
                    "planarity-weight",
                    own.planarity_weight,
                    usual.planarity_weight,
                );
                self.differing("corners", own.corners, usual.corners);
                self.differing("hausdorff", own.hausdorff, usual.hausdorff);
            }
            Method::Stochastic(own) => {
                let usual = StochasticOptions::default();
                if own.seed != usual.seed {
                    self.push(format!("seed {}", own.seed));
                }
                self.number("area-weight", own.area_weight, usual.area_weight);
            }
            Method::Meshopt(MeshoptOptions { mode, borders }) => {
                self.differing("meshopt-mode", *mode, Mode::default());
                match borders {
                    Borders::Stay => {}
                    Borders::PreserveArea => self.push("preserve-area".to_owned()),
                    Borders::Dilate => self.push("dilate-borders".to_owned()),
                }
            }
            Method::Chain(own) if own.branch_metric != Metric::default() => {
                self.push(format!(
                    "branch-metric {}",
                    name_of_metric(own.branch_metric)
                ));
            }
            Method::Merge(own) if own.cluster_size == ClusterSize::Area => {
                self.push("cluster-size area".to_owned());
            }
            _ => {}
        }
    }

    /// A value of a list of names.
    fn differing<T: PartialEq + Serialize>(&mut self, flag: &str, value: T, usual: T) {
        if value != usual {
            let name = serde_json::to_value(value).ok();
            let name = name.as_ref().and_then(|name| name.as_str());
            let name = name.expect("names are spelled as text");
            self.push(format!("{flag} {name}"));
        }
    }

    fn number(&mut self, flag: &str, value: f64, usual: f64) {
        if value != usual {
            self.push(format!("{flag} {value}"));
        }
    }

    /// How leaves are chosen and grow; of equal costs see `ties` behind the views.
    fn of_vds(&mut self, own: &VdsOptions, usual: VdsOptions) {
        self.differing("reference", own.reference, usual.reference);
        self.differing("resize", own.resize, usual.resize);
        if own.neighbours != usual.neighbours {
            self.push(format!("neighbours {}", own.neighbours));
        }
        match own.max_coverage {
            same if same == usual.max_coverage => {}
            Some(limit) => self.push(format!("max-coverage {limit}")),
            None => self.push("max-coverage none".to_owned()),
        }
    }
}

/// Sets of views go by how many views they have, but for the variable number.
fn name_of(views: &Views) -> &'static str {
    match views {
        Views::Icosahedron => "12",
        other => other.name(),
    }
}

fn name_of_metric(metric: Metric) -> &'static str {
    match metric {
        Metric::Children => "children",
        Metric::Descendants => "descendants",
        Metric::LongestPath => "longest-path",
        Metric::BranchingLength => "branching-length",
    }
}
