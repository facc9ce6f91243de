//! Runs a case, and measures the time and memory to each level.

use std::ops::ControlFlow;
use std::sync::Arc;
use std::time::Instant;

use secateur_gltf::Tree;
use secateur_model::Lod;
use secateur_raster::OpenEngine;
use secateur_raster::ViewSet;
use secateur_simplify::{
    Error as SimplifyError, Options, Progress, Resolution, Stage, simplify_on,
};

use crate::job::Job;
use crate::{Error, Host};

/// A level that a run reached.
pub(crate) struct Ran {
    pub(crate) level: f64,
    pub(crate) lod: Lod,
    /// The largest multiple of its area that a leaf has grown to.
    pub(crate) max_area_scale: f64,
    /// Wall time of the method alone, without observing and judging.
    pub(crate) seconds: f64,
    /// The largest resident set of the process while the method ran.
    pub(crate) peak_rss_bytes: Option<u64>,
    /// Width and height of the driving images in pixels; 0 for methods that see none.
    pub(crate) resolution: u32,
    /// All sets of views that chose or sized leaves; none for methods that see none.
    pub(crate) driving: Vec<ViewSet>,
    pub(crate) engine: String,
    pub(crate) adapter: Option<String>,
}

/// One run at a time, so that times are of nothing else: one for all levels where every prefix of
/// an order is a level, else one for each.
pub(crate) fn runs(tree: &Tree, job: &Job<'_>, host: &dyn Host) -> Result<Vec<Ran>, Error> {
    if !job.run.case.has_prefixes() {
        let alone = job
            .levels
            .iter()
            .map(|level| timed(tree, job, &[*level], host));
        let ran: Result<Vec<Vec<Ran>>, Error> = alone.collect();
        return Ok(ran?.into_iter().flatten().collect());
    }
    timed(tree, job, &job.levels, host)
}

fn sees_pixels(options: &Options) -> bool {
    options.method.vds().is_some() || options.objective().is_some()
}

/// The options of a case with what the tree has of what they lack.
fn options(tree: &Tree, mut options: Options) -> Result<Options, Error> {
    if !sees_pixels(&options) {
        // A method that sees no pixels does not have to choose how many.
        options.resolution = Resolution::Pixels(1);
    }
    options.memory = tree.memory_left();
    if options.method.needs_skeleton() {
        options.skeleton = tree.skeleton()?.map(Arc::new);
    }
    Ok(options)
}

fn timed(tree: &Tree, job: &Job<'_>, levels: &[f64], host: &dyn Host) -> Result<Vec<Ran>, Error> {
    let case = job.run.case;
    let coarsest = levels.iter().copied().fold(1.0, f64::min);
    let options = options(tree, case.options(coarsest, job.run.seed)?)?;
    let sees_pixels = sees_pixels(&options);
    let changed = case.perturbation().apply(tree.foliage(), &options);
    let count = tree.foliage().leaves().len();
    let has_prefixes = case.has_prefixes();
    let steps: Vec<usize> = levels
        .iter()
        .map(|level| match has_prefixes {
            true => count - (level * count as f64).round() as usize,
            false => usize::MAX,
        })
        .collect();
    let mut watch = Watch::new(&steps, host);
    host.forget_peak_rss();
    let engine = OpenEngine::open(changed.options.engine).map_err(SimplifyError::from)?;
    let result = simplify_on(
        &engine,
        &changed.foliage,
        &changed.options,
        &mut |progress| watch.see(progress),
    )?;
    let Watch {
        reached,
        end,
        fitting,
        ..
    } = watch;
    let order = changed.order_of_tree(&result.passes.in_one_order());
    let of_stage = |name: Stage| {
        let stage = result.seconds.iter().find(|(stage, _)| *stage == name);
        stage.map_or(0.0, |(_, seconds)| *seconds)
    };
    let choosing = if sees_pixels {
        of_stage(Stage::Resolution)
    } else {
        0.0
    };
    let driving = match changed.foliage.bounding_sphere() {
        Some(sphere) if sees_pixels => result.driving(&changed.options, sphere),
        _ => Vec::new(),
    };
    let fitted = fitting.map_or(0.0, |(from, to)| (to - from).as_secs_f64());
    let whole = Reached {
        seconds: of_stage(Stage::Select),
        peak_rss_bytes: host.peak_rss_bytes(),
    };
    let fitting_peak = fitting.and(whole.peak_rss_bytes);
    let ran = |(level, (steps, reached)): (&f64, (&usize, Option<Reached>))| {
        let reached = reached.or(end).unwrap_or(whole);
        let lod = Lod::after(&order, (*steps).min(order.len()));
        Ran {
            level: *level,
            max_area_scale: match result.passes.needles.is_empty() {
                true => lod.max_area_scale(),
                false => result.passes.max_area_scale(),
            },
            lod,
            seconds: choosing + reached.seconds + fitted,
            peak_rss_bytes: reached.peak_rss_bytes.max(fitting_peak),
            resolution: if sees_pixels { result.resolution } else { 0 },
            driving: driving.clone(),
            engine: result.engine.to_owned(),
            adapter: result.adapter.clone(),
        }
    };
    let levels = levels.iter().zip(steps.iter().zip(reached));
    Ok(levels.map(ran).collect())
}

/// What a run's progress says of time and memory.
struct Watch<'a> {
    host: &'a dyn Host,
    /// After how many steps each level is reached.
    steps: &'a [usize],
    begun: Instant,
    reached: Vec<Option<Reached>>,
    /// Where the method ended.
    end: Option<Reached>,
    /// From when to when sizes were fitted.
    fitting: Option<(Instant, Instant)>,
}

impl<'a> Watch<'a> {
    fn new(steps: &'a [usize], host: &'a dyn Host) -> Self {
        Self {
            host,
            steps,
            begun: Instant::now(),
            reached: vec![None; steps.len()],
            end: None,
            fitting: None,
        }
    }

    fn see(&mut self, progress: Progress) -> ControlFlow<()> {
        let (begun, host) = (self.begun, self.host);
        match progress {
            Progress::Stage(Stage::Select) => self.begun = Instant::now(),
            // All that comes after is no part of the method.
            Progress::Stage(Stage::Observe) => self.end = Some(Reached::now(begun, host)),
            Progress::Stage(Stage::Fit) => {
                self.end.get_or_insert_with(|| Reached::now(begun, host));
                self.fitting = Some((Instant::now(), Instant::now()));
            }
            Progress::Step { done, .. } => match &mut self.fitting {
                Some((_, until)) => *until = Instant::now(),
                None => {
                    for (at, steps) in self.reached.iter_mut().zip(self.steps) {
                        if done == *steps {
                            *at = Some(Reached::now(begun, host));
                        }
                    }
                }
            },
            _ => {}
        }
        match host.is_stop_asked() {
            false => ControlFlow::Continue(()),
            true => ControlFlow::Break(()),
        }
    }
}

/// Time and memory up to a moment of a run.
#[derive(Clone, Copy, Debug)]
struct Reached {
    seconds: f64,
    peak_rss_bytes: Option<u64>,
}

impl Reached {
    fn now(begun: Instant, host: &dyn Host) -> Self {
        Self {
            seconds: begun.elapsed().as_secs_f64(),
            peak_rss_bytes: host.peak_rss_bytes(),
        }
    }
}
