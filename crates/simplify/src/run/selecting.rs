//! The first passes of a run: leaves get coarser, the method chooses leaves, and what goes beyond the target is cut.

use secateur_raster::MAX_RESOLUTION;

use super::{Draft, PassContext};
use crate::coarsen::{Coarse, LossCurves, coarsen};
use crate::fill::fill;
use crate::hanging_leaves::cut;
use crate::observe::seen_px;
use crate::passes::Passes;
use crate::select::{Begun, Selection, Task};
use crate::shared::{KeptOrder, Shared};
use crate::stage::{Clock, Stage};
use crate::{Error, LeafTriangles, Stopped, Target};

/// Where a view shows fewer pixels of a leaf, in the mean, chance decides which are seen. Three public crowns of opaque
/// quads show 6.4 to 29, a grown palmetto 6.1, quads of a fiftieth of their length in the tests of needles below 1.
const LEAST_SEEN_PX: f64 = 2.0;

/// How coarse leaves may get, and what an earlier run found with the same.
#[derive(Default)]
struct Coarsening {
    /// How many triangles each leaf may keep; nothing where they keep all.
    shares: Option<Vec<usize>>,
    known: Option<KeptOrder>,
    coarse: Option<Coarse>,
}

/// What is left after the cut, before anything is looked at.
struct Cut {
    passes: Passes,
    /// Steps of the order that stay.
    chosen: usize,
    /// Whether triangles that were over went back to leaves.
    is_filled: bool,
    /// Whether what is left is what the method chose, and nothing else.
    is_as_found: bool,
}

impl PassContext<'_> {
    /// Makes leaves coarser, has the method choose leaves, and cuts what goes beyond the target.
    pub(super) fn select(
        &self,
        mut shared: Option<&mut Shared>,
        clock: &mut Clock<'_>,
    ) -> Result<Draft, Error> {
        clock.begin(Stage::Select)?;
        let is_driven = self.options.method.vds().is_some();
        let Coarsening {
            shares,
            known,
            coarse,
        } = self.coarsening(shared.as_deref_mut())?;
        let target = match &mut shared {
            Some(shared) => {
                let mut curves = shared.curves.take();
                let is_as_coarse = |target| Ok(self.shares(target, &mut curves)? == shares);
                let target = shared.selection_target(self.target, is_as_coarse)?;
                shared.curves = curves;
                target
            }
            None => self.target,
        };
        let selection = self.selection(target, known.as_ref(), coarse.as_ref(), clock)?;
        if let (Some(shared), true) = (&mut shared, is_driven) {
            shared.keep(KeptOrder {
                views: self.options.views.clone(),
                shares,
                coarse: coarse.clone(),
                begun: Begun {
                    order: selection.order.clone(),
                    costs: selection.costs.clone(),
                },
            });
        }
        let Selection {
            order,
            costs,
            shown,
            is_at_max_error,
        } = selection;
        let mut cut = self.cut(Passes {
            coarse,
            order,
            needles: Vec::new(),
            sizes: None,
        });
        let mut stopped = match self.target {
            Target::Triangles(_) => Stopped::AtTriangles,
            Target::MaxErrorPercent(_) if is_at_max_error => Stopped::AtMaxError,
            Target::Leaves(_) | Target::MaxErrorPercent(_) => Stopped::AtLeafCount,
        };
        let shown = match shown {
            Some(shown) if cut.is_as_found => shown.into(),
            _ => {
                clock.begin(Stage::Observe)?;
                if let Target::MaxErrorPercent(percent) = self.target
                    && self.cut_at_error(&mut cut.passes, percent)?
                {
                    stopped = Stopped::AtMaxError;
                }
                self.look(&cut.passes, is_driven, shared)?
            }
        };
        let mut costs = costs;
        costs.truncate(cut.passes.order.len().min(cut.chosen));
        Ok(Draft {
            shows_the_same: is_driven && self.shows_the_same(&cut),
            costs,
            passes: cut.passes,
            shown,
            stopped,
        })
    }

    /// How coarse leaves get. Only methods that are driven by views make them coarser.
    fn coarsening(&self, mut shared: Option<&mut Shared>) -> Result<Coarsening, Error> {
        let mut coarsening = Coarsening::default();
        if self.options.method.vds().is_none() {
            return Ok(coarsening);
        }
        let mut curves = shared.as_mut().and_then(|shared| shared.curves.take());
        let target = match &shared {
            Some(shared) => shared.coarsening_target(self.target, self.foliage.leaves().len()),
            None => self.target,
        };
        coarsening.shares = self.shares(target, &mut curves)?;
        coarsening.known = shared
            .as_mut()
            .and_then(|shared| shared.take(&self.options.views, &coarsening.shares));
        coarsening.coarse = match (&coarsening.known, &coarsening.shares) {
            (Some(known), _) => known.coarse.clone(),
            (None, Some(shares)) => {
                let curves = curves.get_or_insert_with(|| LossCurves::of(self.foliage));
                coarsen(self.foliage, curves, shares)
            }
            (None, None) => None,
        };
        if let Some(shared) = shared {
            shared.curves = curves;
        }
        Ok(coarsening)
    }

    /// How many triangles each leaf may keep for a target; nothing where they keep all. `curves` are kept for the next.
    fn shares(
        &self,
        target: Target,
        curves: &mut Option<LossCurves>,
    ) -> Result<Option<Vec<usize>>, Error> {
        let (limit, finer) = (self.options.leaf_triangles, self.options.finer.as_deref());
        limit.shares(self.foliage, target, finer, curves, || {
            let curves = LossCurves::of(self.foliage);
            // Cards lose little as triangles, and hide little: counted as seen `ez_bush2` has levels of 1,446, 1,326
            // and 534 triangles at 1,080, 135 and 32 pixels, of their areas 1,385, 1,140 and 449. What is out of range
            // is refused by the method.
            let is_in_range = (1..=MAX_RESOLUTION).contains(&self.resolution);
            if !is_in_range || !self.foliage.cutouts().is_empty() {
                return Ok(curves);
            }
            let views = self.views.first();
            let seen_px = seen_px(self.foliage, &views, self.resolution, self.rasteriser)?;
            let of_a_leaf = seen_px.iter().sum::<f64>() / (seen_px.len() * views.len()) as f64;
            Ok(match of_a_leaf < LEAST_SEEN_PX {
                true => curves,
                false => curves.seen(seen_px),
            })
        })
    }

    /// What the method chooses, or chose in an earlier run.
    fn selection(
        &self,
        target: Target,
        known: Option<&KeptOrder>,
        coarse: Option<&Coarse>,
        clock: &mut Clock<'_>,
    ) -> Result<Selection, Error> {
        let target = match target {
            // The error that counts is the one against the leaves as they are.
            Target::MaxErrorPercent(_) if coarse.is_some() => Target::leaves(0),
            target => target,
        };
        let foliage = coarse.map_or(self.foliage, Coarse::foliage);
        let nested = match (known, &self.options.finer) {
            (None, Some(finer)) => finer.begun(foliage),
            (Some(_), _) | (None, None) => None,
        };
        let task = Task {
            foliage,
            target,
            begun: known.map(|known| &known.begun).or(nested.as_ref()),
            skeleton: self.options.skeleton.as_deref(),
            views: &self.views,
            resolution: self.resolution,
            rasteriser: self.rasteriser,
            occluders: self.occluders,
        };
        let own = Task {
            target: self.target,
            ..task
        };
        match known.filter(|known| known.reaches(&own)) {
            Some(known) => Ok(known.selection()),
            None => self
                .options
                .method
                .select(&task, &mut |done, at_most| clock.step(done, at_most)),
        }
    }

    /// Cuts what goes beyond the target; needles get wider, and triangles that are over go back to leaves.
    fn cut(&self, mut passes: Passes) -> Cut {
        let at_most = self.target.triangle_count(self.foliage);
        let ordered = passes.coarse.as_ref().map_or(self.foliage, Coarse::foliage);
        let held_by = self.options.held_by.as_deref();
        let found = passes.order.len();
        let gone = self
            .options
            .finer
            .as_ref()
            .map_or(0, |finer| finer.gone_count());
        let chosen = cut(&mut passes.order, ordered, held_by, at_most, gone);
        if self.options.widens_needles() {
            passes.widen_needles(self.foliage, held_by);
        }
        let is_as_chosen = passes.coarse.is_none()
            && held_by.is_none()
            && chosen == found
            && passes.needles.is_empty();
        let is_filled = match (at_most, self.options.leaf_triangles) {
            (Some(at_most), LeafTriangles::Auto) => {
                fill(&mut passes, self.foliage, at_most, gone..chosen)
            }
            _ => false,
        };
        Cut {
            passes,
            chosen,
            is_filled,
            is_as_found: is_as_chosen && !is_filled,
        }
    }

    /// Whether what is left shows all that was there.
    fn shows_the_same(&self, cut: &Cut) -> bool {
        let passes = &cut.passes;
        let is_coarse_the_same = passes.coarse.as_ref().is_none_or(Coarse::shows_the_same);
        !cut.is_filled
            && passes.needles.is_empty()
            && passes.lod().leaf_count() == self.foliage.leaves().len()
            && is_coarse_the_same
    }
}
