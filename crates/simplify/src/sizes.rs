//! The pass that fits the sizes of what is left to the original.

use std::ops::ControlFlow;

use secateur_model::{BoundingSphere, Budget, Foliage, Lod};
use secateur_raster::ViewSet;

use crate::fit::{Fit, Objective, fit_within};
use crate::select::Steps;
use crate::{Error, FieldOfView, Fitting, Options, Shared, Views};

/// Sizes are fitted in images of at least this many pixels a side, that of the
/// judging views: what is good for coarser ones is too large in finer ones.
const LEAST_RESOLUTION: u32 = 512;

/// But of no more pixels over all views, those of 48 views of 1024 x 1024.
const MOST_PIXELS: u64 = 48 << 20;

/// And in the tight field of view, where the crown is as large in fewer pixels: 320, rounded up to
/// whole blocks of 8.
const LEAST_TIGHT_RESOLUTION: u32 = 320;

/// What a fit to information gives for nothing: a 400th of it.
const FREE_ERROR_PERCENT: f64 = 0.25;

/// Where cards show all that was there no fit is tried unasked; one to information only if the
/// driving views say so too.
pub(crate) fn is_fit_spared(
    fit: Fitting,
    objective: Objective,
    shows_the_same: bool,
    unfitted_percent: Option<f64>,
) -> bool {
    let is_enough = match objective {
        Objective::Information { .. } => {
            unfitted_percent.is_some_and(|percent| percent <= FREE_ERROR_PERCENT)
        }
        Objective::Coverage => true,
    };
    fit == Fitting::Auto && shows_the_same && is_enough
}

/// How sizes are fitted.
pub(crate) struct SizePass {
    pub(crate) views: Vec<ViewSet>,
    pub(crate) objective: Objective,
    /// Image width and height in pixels.
    pub(crate) resolution: u32,
}

impl SizePass {
    /// How a run about this sphere fits sizes; `shown` are the last views that drove, in images
    /// of `driving_resolution` pixels a side. Information is lost at other resolutions than
    /// that of the driving views; coverage is not.
    pub(crate) fn new(
        options: &Options,
        sphere: BoundingSphere,
        shown: &ViewSet,
        objective: Objective,
        driving_resolution: u32,
    ) -> Self {
        let views = fitting_views(options, sphere, shown, objective);
        let tan_half = |set: &ViewSet| set.views()[0].tan_half_fov();
        let is_tight = !options.views.are_cameras() && tan_half(&views[0]) == ViewSet::TAN_TIGHT;
        let least = match is_tight {
            true => LEAST_TIGHT_RESOLUTION,
            false => LEAST_RESOLUTION,
        };
        let wished = match objective {
            // As large as leaves are in the driving views.
            Objective::Information { .. } => {
                let wider = tan_half(&views[0]) / tan_half(shown);
                let pixels = f64::from(driving_resolution) * wider;
                least.max((pixels / 8.0).ceil() as u32 * 8)
            }
            Objective::Coverage => {
                let most = options.most_fit_px.min(LEAST_RESOLUTION);
                (least * most / LEAST_RESOLUTION).max(1)
            }
        };
        Self {
            resolution: resolution(wished, &views),
            views,
            objective,
        }
    }

    /// By what the area of each leaf that is left is to be multiplied, in the order of
    /// [`Lod::all_leaves`]; nothing if all leaves keep their sizes. What fits of other levels
    /// drew is taken from `shared`. `steps` gets leaves tried and
    /// to be tried at most.
    pub(crate) fn factors(
        &self,
        foliage: &Foliage,
        lod: &Lod,
        occluders: Option<&Foliage>,
        budget: Budget,
        shared: Option<&mut Shared>,
        steps: &mut Steps<'_>,
    ) -> Result<Option<Vec<f64>>, Error> {
        let way = Fit {
            original: foliage,
            left: &lod.foliage(foliage),
            views: &self.views,
            resolution: self.resolution,
            objective: self.objective,
            occluders,
        };
        let originals = shared.map(|shared| &mut shared.originals);
        match fit_within(&way, budget, originals, steps)? {
            ControlFlow::Continue(factors) => {
                Ok(factors.iter().any(|f| *f != 1.0).then_some(factors))
            }
            ControlFlow::Break(()) => Err(Error::Stopped),
        }
    }
}

/// Where from sizes are fitted: one's own cameras; or views from which no leaf was chosen,
/// since what is left was kept for what it shows in those. For coverage 12 are enough: blocks of
/// pixels are fitted to chance less easily than pixels. For information 30, in sets of 12, 6 and
/// 12, since VMI depends on how many views there are; each just holds the crown. `shown` are the last
/// views that drove.
pub(crate) fn fitting_views(
    options: &Options,
    sphere: BoundingSphere,
    shown: &ViewSet,
    objective: Objective,
) -> Vec<ViewSet> {
    if options.views.are_cameras() {
        return vec![shown.clone()];
    }
    let sets = unframed_views(&options.views, sphere, objective);
    let frame = |set: &ViewSet| match (objective, options.field_of_view) {
        (Objective::Information { .. }, FieldOfView::Auto) => {
            options.framed_as(set, FieldOfView::Tight)
        }
        _ => options.framed_as(set, options.field_of_view()),
    };
    sets.iter().map(frame).collect()
}

fn unframed_views(views: &Views, sphere: BoundingSphere, objective: Objective) -> Vec<ViewSet> {
    if let Views::Turned { views, turn } = views {
        let sets = unframed_views(views, sphere, objective);
        let turned = sets.iter().map(|set| set.turned(sphere.centre, *turn));
        return turned.collect();
    }
    let mut sets = match objective {
        Objective::Information { .. } => vec![
            ViewSet::driving_icosahedron(sphere),
            ViewSet::octahedron(sphere),
        ],
        Objective::Coverage => Vec::new(),
    };
    sets.push(ViewSet::cuboctahedron(sphere));
    let driving = views.driving(sphere);
    let is_driving = |set: &ViewSet| {
        let of = |view| driving.iter().any(|d| d.views().contains(view));
        set.views().iter().all(of)
    };
    sets.retain(|set| !is_driving(set));
    sets
}

/// The resolution at which sizes are fitted, of one that is wished for.
fn resolution(wished: u32, sets: &[ViewSet]) -> u32 {
    let views: usize = sets.iter().map(ViewSet::len).sum();
    let most = (MOST_PIXELS / views as u64).isqrt();
    u64::from(wished).min(most) as u32
}

#[cfg(test)]
mod tests {
    use secateur_plant::{EllipsoidCrown, ellipsoid_crown};

    use glam::{DQuat, EulerRot};
    use secateur_raster::View;

    use super::*;
    use crate::fsa::FsaOptions;
    use crate::stochastic::StochasticOptions;
    use crate::{
        Fitting, LeafTriangles, Method, Options, Passes, Resolution, Simplified, Target, Warning,
        simplify,
    };

    const INFORMATION: Objective = Objective::Information {
        outline_weight: 1.0,
    };

    fn crown() -> Foliage {
        ellipsoid_crown(200, 11, &EllipsoidCrown::default()).unwrap()
    }

    fn to(target: Target) -> Options {
        Options {
            resolution: Resolution::Pixels(32),
            fit: Fitting::Weight(2.0),
            audit: true,
            ..Options::to(target)
        }
    }

    fn stochastic() -> Method {
        Method::Stochastic(StochasticOptions::default())
    }

    fn fsa() -> Method {
        Method::Fsa(FsaOptions::default())
    }

    fn run(settings: &Options) -> Simplified {
        simplify(&crown(), settings).unwrap()
    }

    /// The result, and what the same run is without a fit.
    fn with_and_without(settings: Options) -> (Simplified, Simplified) {
        let without = Options {
            fit: Fitting::None,
            ..settings.clone()
        };
        (run(&settings), run(&without))
    }

    #[test]
    fn no_fit_is_tried_unasked_where_cards_and_views_show_the_same() {
        let information = Objective::Information {
            outline_weight: 0.95,
        };
        let is_spared = |fit, shows_the_same, percent| {
            is_fit_spared(fit, information, shows_the_same, Some(percent))
        };
        assert!(is_spared(Fitting::Auto, true, 0.25));
        assert!(!is_spared(Fitting::Auto, true, 0.26));
        assert!(!is_spared(Fitting::Auto, false, 0.0));
        assert!(!is_spared(Fitting::Weight(0.95), true, 0.0));
        let of_coverage = |fit, same| is_fit_spared(fit, Objective::Coverage, same, None);
        assert!(of_coverage(Fitting::Auto, true));
        assert!(!of_coverage(Fitting::Auto, false));
        assert!(!of_coverage(Fitting::Coverage, true));
    }

    #[test]
    fn it_is_a_step_more_in_which_no_leaf_goes() {
        let triangles = Options {
            leaf_triangles: LeafTriangles::AtMost(1),
            ..to(Target::leaf_share(0.25))
        };
        let stochastic = Options {
            method: stochastic(),
            ..to(Target::leaf_share(0.25))
        };
        let fsa = Options {
            method: fsa(),
            ..to(Target::leaf_share(0.25))
        };
        let share = to(Target::triangle_share(0.25));
        for settings in [
            to(Target::leaf_share(0.25)),
            share,
            triangles,
            stochastic,
            fsa,
        ] {
            let (fitted, plain) = with_and_without(settings);
            assert!(fitted.passes.sizes.is_some() && plain.passes.sizes.is_none());
            let [with, without] = [&fitted, &plain].map(|run| run.passes.in_one_order());
            assert_eq!(with.len(), without.len() + 1);
            let last = with.steps().last().unwrap();
            assert!(last.removed.is_empty() && last.made.is_empty());
            // All before is as it was.
            assert_eq!(fitted.passes.order, plain.passes.order);
            assert_eq!(Lod::after(&with, without.len()), plain.lod);
            assert_eq!(fitted.lod.leaf_count(), plain.lod.leaf_count());
            assert_eq!(fitted.stopped, plain.stopped);
            assert_eq!(fitted.costs, plain.costs);
        }
    }

    #[test]
    fn factors_apply_to_the_sizes_that_leaves_have() {
        // Leaves of FSA are made, and go again.
        for method in [stochastic(), fsa()] {
            let (_, plain) = with_and_without(Options {
                method,
                ..to(Target::leaves(20))
            });
            let factors: Vec<f64> = (1..=20).map(f64::from).collect();
            let sized = Passes {
                sizes: Some(factors.clone()),
                ..plain.passes.clone()
            };
            let sized = sized.lod();
            let areas = |lod: &Lod| {
                let left = lod.foliage(&crown());
                left.leaves().iter().map(|l| l.area()).collect::<Vec<_>>()
            };
            for (k, (before, after)) in areas(&plain.lod).iter().zip(areas(&sized)).enumerate() {
                assert!((after / before / factors[k] - 1.0).abs() < 1e-9, "{k}");
            }
        }
    }

    #[test]
    fn an_error_that_is_asked_for_is_kept() {
        let mut refused = 0;
        for percent in [0.5, 5.0, 40.0] {
            // An outline alone may cost information.
            let (fitted, plain) = with_and_without(Options {
                fit: Fitting::Weight(100.0),
                ..to(Target::MaxErrorPercent(percent))
            });
            assert!(fitted.driving_error_percent().unwrap() <= percent);
            if fitted.passes.sizes.is_none() {
                refused += 1;
                assert_eq!(fitted.passes.order, plain.passes.order);
                assert!(fitted.warnings.contains(&Warning::NothingToFit));
            }
        }
        assert!(refused > 0);
    }

    #[test]
    fn images_are_at_least_as_fine_as_the_judging_ones() {
        let views = ViewSet::dodecahedron(crown().bounding_sphere().unwrap());
        assert_eq!(
            [512, 1024].map(|n| resolution(n, &[views.clone(), views.clone()])),
            [512, 1024]
        );
        let sphere = crown().bounding_sphere().unwrap();
        let pass = |objective, field_of_view, driving_px| {
            let options = Options {
                field_of_view,
                ..to(Target::leaves(1))
            };
            let shown = options.first_views(sphere);
            SizePass::new(&options, sphere, &shown, objective, driving_px).resolution
        };
        let [auto, tight] = [FieldOfView::Auto, FieldOfView::Tight];
        let wide = FieldOfView::Degrees(60.0);
        for (driving_px, expected) in [(64, [512, 512, 320, 512]), (1024, [512, 1024, 632, 1024])] {
            let found = [
                pass(Objective::Coverage, auto, driving_px),
                pass(INFORMATION, wide, driving_px),
                pass(INFORMATION, auto, driving_px),
                // What is tight throughout is as fine throughout.
                pass(INFORMATION, tight, driving_px).max(512),
            ];
            assert_eq!(found, expected);
        }
        // In fewer pixels, where that is asked for, and never in more.
        for (most_fit_px, expected) in [(256, [256, 160]), (1024, [512, 320])] {
            let found = [auto, tight].map(|field_of_view| {
                let options = Options {
                    field_of_view,
                    most_fit_px,
                    ..to(Target::leaves(1))
                };
                let shown = options.first_views(sphere);
                SizePass::new(&options, sphere, &shown, Objective::Coverage, 64).resolution
            });
            assert_eq!(found, expected);
        }
        let many = ViewSet::new(vec![views.views()[0]; 4096]);
        assert_eq!(
            [64, 200].map(|n| resolution(n, std::slice::from_ref(&many))),
            [64, 110]
        );
    }

    #[test]
    fn other_views_look_but_where_cameras_are_ones_own() {
        let sphere = crown().bounding_sphere().unwrap();
        let octahedron = ViewSet::octahedron(sphere);
        for (views, driving, sizes) in [
            (Views::Cube, ViewSet::cube(sphere), &[12, 6, 12][..]),
            (Views::Octahedron, octahedron.clone(), &[12, 12]),
        ] {
            let options = Options {
                views,
                ..to(Target::leaves(1))
            };
            let others = fitting_views(&options, sphere, &driving, INFORMATION);
            let found: Vec<usize> = others.iter().map(ViewSet::len).collect();
            assert_eq!(found, sizes);
            let is_driving = |view| driving.views().contains(view);
            assert!(!others.iter().flat_map(ViewSet::views).any(is_driving));
        }
        let cameras = Options {
            views: Views::Cameras(octahedron.clone()),
            ..to(Target::leaves(1))
        };
        let own = fitting_views(&cameras, sphere, &octahedron, INFORMATION);
        assert_eq!(own, [octahedron]);
    }

    #[test]
    fn turned_views_are_fitted_in_the_others_turned_alike() {
        let sphere = crown().bounding_sphere().unwrap();
        let turn = DQuat::from_euler(EulerRot::XYZ, 0.3, 1.1, -0.7);
        for views in [Views::Dodecahedron, Views::Octahedron] {
            let driving = views.around(sphere);
            let with = |views| Options {
                views,
                ..to(Target::leaves(1))
            };
            let upright = fitting_views(&with(views.clone()), sphere, &driving, INFORMATION);
            let turned = Views::Turned {
                views: Box::new(views),
                turn,
            };
            let driving_turned = turned.around(sphere);
            let no_turn = driving.turned(sphere.centre, DQuat::from_xyzw(0.0, 0.0, 0.0, 0.0));
            assert_eq!(no_turn, driving);
            let others = fitting_views(&with(turned), sphere, &driving_turned, INFORMATION);
            assert_eq!(others.len(), upright.len());
            for (a, b) in upright.iter().zip(&others) {
                let turned = a.turned(sphere.centre, turn);
                assert_eq!(turned, *b);
                // As far from the driving views as before.
                let cosine = |a: &View, b: &View| a.forward().dot(b.forward());
                let before = cosine(&a.views()[0], &driving.views()[1]);
                let after = cosine(&b.views()[0], &driving_turned.views()[1]);
                assert!((before - after).abs() < 1e-12);
            }
        }
    }

    #[test]
    fn a_weight_out_of_range_is_refused() {
        for weight in [-1.0, 100.5, f64::NAN] {
            let settings = Options {
                fit: Fitting::Weight(weight),
                ..to(Target::leaves(20))
            };
            let error = simplify(&crown(), &settings);
            let error = error.unwrap_err().to_string();
            assert!(error.contains("weight of the outline"), "{error}");
        }
    }
}
