//! VDS as settings ask for it: on leaves as they are or coarser ones, down to a
//! number of leaves or of triangles, or to an error.

use secateur_model::{Foliage, LeafId, RemovalOrder};
use secateur_simplify::coarsen::{Coarse, Shapes, coarsen, shared_out};
use secateur_simplify::vds::{Stop, Stopped, VdsOptions, VdsOutcome, ViewPlan, final_views};

use crate::baseline;
use crate::settings::Goal;
use crate::{Error, LeafTriangles, OpenEngine};

/// What VDS is asked for.
pub(crate) struct Driven {
    pub(crate) leaf_triangles: LeafTriangles,
    pub(crate) goal: Goal,
    /// How; when to stop is as the goal says.
    pub(crate) options: VdsOptions,
}

/// What came of it.
pub(crate) struct Found {
    /// On the leaves, or on coarser ones.
    pub(crate) outcome: VdsOutcome,
    /// What leads to the goal from the leaves as they are, where that is another order.
    pub(crate) order: Option<RemovalOrder>,
    /// Whether what is left shows all that was there: no leaf is gone, and one triangle
    /// of a card that shows all of it is all that became coarser.
    pub(crate) shows_the_same: bool,
}

impl Driven {
    /// What `vds` finds.
    pub(crate) fn order(
        &self,
        foliage: &Foliage,
        vds: impl FnOnce(&Foliage, &VdsOptions) -> Result<VdsOutcome, Error>,
    ) -> Result<Found, Error> {
        let coarse = coarser(foliage, self.leaf_triangles, self.goal);
        let driving = coarse.as_ref().map_or(foliage, Coarse::foliage);
        let (leaves, max_error_percent) = match self.goal {
            Goal::Leaves(leaves) => (leaves, None),
            Goal::Triangles(at_most) => (fewest_leaves(driving, at_most), None),
            // The error that counts is the one against the leaves as they are.
            Goal::MaxError(_) if coarse.is_some() => (0, None),
            Goal::MaxError(percent) => (0, Some(percent)),
        };
        let options = VdsOptions {
            stop: Stop {
                leaves,
                max_error_percent,
            },
            ..self.options.clone()
        };
        let mut found = vds(driving, &options)?;
        let is_coarse_the_same = coarse.as_ref().is_none_or(Coarse::shows_the_same);
        let mut order = coarse.map(|coarse| coarse.order(&found.order));
        if let Goal::Triangles(at_most) = self.goal {
            found.stopped = Stopped::AtTriangles;
            let whole = order.as_ref().unwrap_or(&found.order);
            // Coarser leaves that are asked for are no matter of the budget.
            let least = match self.leaf_triangles {
                LeafTriangles::AtMost(_) => usize::from(order.is_some()),
                LeafTriangles::Auto | LeafTriangles::Keep => 0,
            };
            let steps = whole.steps_to_triangles(foliage, at_most).max(least);
            if steps < whole.len() {
                order
                    .get_or_insert_with(|| found.order.clone())
                    .truncate(steps);
            }
        }
        let whole = order.as_ref().unwrap_or(&found.order);
        let are_all_left = whole.leaves_after(whole.len()) == foliage.leaves().len();
        Ok(Found {
            shows_the_same: are_all_left && is_coarse_the_same,
            outcome: found,
            order,
        })
    }

    /// What the views of its last step show of an order.
    pub(crate) fn outcome(
        &self,
        foliage: &Foliage,
        order: RemovalOrder,
        found: VdsOutcome,
        engine: &OpenEngine,
    ) -> Result<VdsOutcome, Error> {
        let is_coarser = order
            .steps()
            .next()
            .is_some_and(|step| !step.made.is_empty());
        let mut options = self.options.clone();
        // Where the error has still to say how many leaves are left, the first views.
        if !matches!(self.goal, Goal::MaxError(_)) {
            let left = order.leaves_after(order.len());
            let count = foliage.leaves().len();
            options.views = ViewPlan::Fixed(final_views(&options, count, left)?);
        }
        let mut outcome = baseline::outcome(foliage, order, self.goal, &options, engine)?;
        // To make leaves coarser is a step without a cost.
        outcome.costs_scaled = vec![0; usize::from(is_coarser)];
        outcome.costs_scaled.extend(found.costs_scaled);
        outcome.costs_scaled.truncate(outcome.order.len());
        Ok(outcome)
    }
}

/// Coarser leaves for a goal; nothing if they stay as they are.
fn coarser(foliage: &Foliage, leaf_triangles: LeafTriangles, goal: Goal) -> Option<Coarse> {
    match (leaf_triangles, goal) {
        (LeafTriangles::AtMost(most), _) => {
            let most = vec![most as usize; foliage.leaves().len()];
            coarsen(foliage, &Shapes::of(foliage), &most)
        }
        (LeafTriangles::Auto, Goal::Triangles(at_most)) if at_most < foliage.triangles().len() => {
            let shapes = Shapes::of(foliage);
            coarsen(foliage, &shapes, &shared_out(foliage, at_most, &shapes))
        }
        (LeafTriangles::Auto | LeafTriangles::Keep, _) => None,
    }
}

/// The number of leaves at which no more than so many triangles are left, whichever
/// leaves are.
fn fewest_leaves(foliage: &Foliage, at_most: usize) -> usize {
    let leaves = (0..foliage.leaves().len()).map(LeafId::from_index);
    let mut counts: Vec<usize> = leaves.map(|l| foliage.triangles_of(l).len()).collect();
    counts.sort_unstable_by(|a, b| b.cmp(a));
    let mut sum = 0;
    let fits = counts.iter().take_while(|&&count| {
        sum += count;
        sum <= at_most
    });
    fits.count()
}

#[cfg(test)]
mod tests {
    use std::ops::ControlFlow;

    use glam::DVec3;
    use secateur_model::LeafTriangle;

    use super::*;
    use crate::{Fitting, Preset, Resolution, Simplified, Simplify, Target, simplify};

    /// Upright leaves side by side, of 1 and of 3 triangles in turn, the latter small
    /// and so the first to go.
    fn uneven(leaves: usize) -> Foliage {
        let mut foliage = Foliage::default();
        for k in 0..leaves {
            let at = DVec3::new(k as f64, 0.1 * (k * k % 7) as f64, 0.2 * (k % 3) as f64);
            let fan = |t: usize| {
                let size = if k % 2 == 0 { 1.0 } else { 0.25 };
                let corner = |t: usize| size * DVec3::new(0.5, 0.4 * t as f64, 0.0);
                LeafTriangle::plain([DVec3::ZERO, corner(t), corner(t + 1)].map(|p| at + p))
            };
            let triangles: Vec<LeafTriangle> = (0..1 + 2 * (k % 2)).map(fan).collect();
            foliage.push_leaf(&triangles, None).unwrap();
        }
        foliage
    }

    fn to(foliage: &Foliage, triangles: u64, leaf_triangles: LeafTriangles) -> Simplified {
        let settings = Simplify {
            resolution: Resolution::Pixels(64),
            leaf_triangles,
            audit: true,
            ..Simplify::to(Target::Triangles(triangles))
        };
        simplify(foliage, &settings, &mut |_| ControlFlow::Continue(())).unwrap()
    }

    fn is_fit_tried(foliage: &Foliage, triangles: u64, fit: Fitting) -> bool {
        let settings = Simplify {
            fit,
            ..Simplify::with_preset(Preset::Information, Target::Triangles(triangles))
        };
        let result = simplify(foliage, &settings, &mut |_| ControlFlow::Continue(()));
        let seconds = result.unwrap().seconds;
        seconds.iter().any(|(stage, _)| *stage == "fit")
    }

    #[test]
    fn leaves_of_many_and_few_triangles_end_at_the_first_level_within_the_budget() {
        let foliage = uneven(12);
        assert_eq!(foliage.triangles().len(), 24);
        for triangles in 0..=24 {
            let result = to(&foliage, triangles, LeafTriangles::Keep);
            let left = |steps| {
                let lod = secateur_model::Lod::after(&result.order, steps);
                lod.foliage(&foliage).triangles().len() as u64
            };
            let steps = result.order.len();
            assert!(left(steps) <= triangles);
            assert!(steps == 0 || left(steps - 1) > triangles, "{triangles}");
            assert_eq!(
                result.lod.foliage(&foliage).triangles().len() as u64,
                left(steps)
            );
            assert_eq!(result.costs_scaled.len(), steps);
            assert_eq!(result.stopped, Stopped::AtTriangles);
        }
    }

    /// VDS went on to fewer views before the order was cut.
    #[test]
    fn what_is_left_is_looked_at_from_the_views_of_its_last_step() {
        let foliage = uneven(12);
        let settings = Simplify {
            resolution: Resolution::Pixels(64),
            leaf_triangles: LeafTriangles::Keep,
            views: crate::Views::Variable,
            audit: true,
            ..Simplify::to(Target::Triangles(18))
        };
        let result = simplify(&foliage, &settings, &mut |_| ControlFlow::Continue(())).unwrap();
        let pruned_percent = 100 * result.order.len() / 12;
        let expected = [(10, 20), (30, 12), (50, 8), (100, 6)];
        let (_, views) = expected
            .into_iter()
            .find(|(most, _)| pruned_percent <= *most)
            .unwrap();
        assert_eq!(result.views.len(), views, "{pruned_percent} % are gone");
        assert!(fewest_leaves(&foliage, 18) < result.lod.leaf_count());
    }

    #[test]
    fn only_the_step_that_makes_leaves_coarser_has_no_cost() {
        let foliage = uneven(12);
        let coarser = to(&foliage, 14, LeafTriangles::Auto);
        assert_eq!((coarser.order.len(), coarser.lod.leaf_count()), (1, 12));
        assert_eq!(coarser.costs_scaled, [0]);
        // Coarser leaves without a texture do not show all that they did.
        let is_tried = |triangles| is_fit_tried(&foliage, triangles, Fitting::Auto);
        assert!(is_tried(14) && !is_tried(24));
        let fewer = to(&foliage, 5, LeafTriangles::Auto);
        assert_eq!((fewer.order.len(), fewer.lod.leaf_count()), (8, 5));
        assert_eq!(fewer.costs_scaled.len(), 8);
        assert!(fewer.costs_scaled[7] > 0);
    }

    /// Cards whose textures are empty at their borders: half of the triangles show all of
    /// them, each at its place, as it was.
    #[test]
    fn all_cards_stay_where_every_one_may_keep_a_triangle() {
        use std::sync::Arc;

        use glam::DVec2;
        use secateur_model::{Cutout, Wrap};

        let middle = |x: u32| (8..24).contains(&x);
        let mask = Cutout::from_fn([32, 32], [Wrap::ClampToEdge; 2], |x, y| {
            middle(x) && middle(y)
        });
        let mut foliage = Foliage::new(vec![Arc::new(mask)]);
        for k in 0..9 {
            let at = DVec3::new((k % 3) as f64, (k / 3) as f64, 0.1 * k as f64);
            let corner = |(u, v): (f64, f64)| (at + DVec3::new(u, v, 0.2 * u), DVec2::new(u, v));
            let triangle = |corners: [(f64, f64); 3]| LeafTriangle {
                corners: corners.map(|c| corner(c).0),
                uvs: corners.map(|c| corner(c).1),
            };
            let [a, b, c, d] = [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)];
            let card = [triangle([a, b, c]), triangle([a, c, d])];
            foliage.push_leaf(&card, Some(0)).unwrap();
        }
        let result = to(&foliage, 9, LeafTriangles::Auto);
        assert_eq!(result.lod.leaf_count(), 9);
        assert_eq!(result.lod.foliage(&foliage).triangles().len(), 9);
        let measured = crate::measure(&foliage, &result.lod.foliage(&foliage)).unwrap();
        assert!(
            measured.silhouette_iou() > 0.99,
            "{}",
            measured.silhouette_iou()
        );
        assert!(measured.vmi_error_percent() < 0.5);

        // There is nothing to fit where all is shown, unless one insists. The borders of one
        // triangle are drawn otherwise than those of two: in nine leaves that shows.
        let auto = [9, 18, 8].map(|count| is_fit_tried(&foliage, count, Fitting::Auto));
        assert_eq!(auto, [true, false, true]);
        assert!(is_fit_tried(&foliage, 18, Fitting::Weight(1.0)));

        let fewer = to(&foliage, 5, LeafTriangles::Auto);
        assert_eq!(fewer.lod.leaf_count(), 5);
        let kept = to(&foliage, 9, LeafTriangles::Keep);
        assert_eq!(kept.lod.leaf_count(), 4);
    }
}
