//! Where work is done, who is told of it, and what ends it.

use std::fmt;
use std::ops::ControlFlow;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use secateur_model::Memory;
use secateur_raster::{Engine, OpenEngine};
use secateur_simplify::{Error as SimplifyError, Observer, Progress};

use crate::Error;

/// What any number of calls share: engine, memory and threads, who is told of progress, and what breaks them off. Copies
/// are of one session.
///
/// ```
/// # use secateur::{LevelOptions, Plant, Session, plant::{GrowOptions, Species}};
/// let session = Session::default().with_progress(|progress| println!("{progress:?}"));
/// // Another thread may end the work: `session.cancel()` on a copy.
/// let oak = Plant::grow(Species::Oak, &GrowOptions { leaves: 40, seed: 1 })?;
/// let level = oak.level_in(&session, &LevelOptions::triangles(0.5))?;
/// # session.cancel();
/// # assert!(oak.level_in(&session, &LevelOptions::triangles(0.5)).unwrap_err().is_stopped());
/// # Ok::<(), secateur::Error>(())
/// ```
#[derive(Clone, Default)]
pub struct Session {
    engine: Option<Arc<OpenEngine>>,
    memory: Memory,
    threads: Option<Arc<rayon::ThreadPool>>,
    progress: Option<Arc<dyn Fn(Progress) + Send + Sync>>,
    is_cancelled: Arc<AtomicBool>,
}

impl Session {
    /// With an engine that is open already, whatever options say: calls do not open it again.
    #[must_use]
    pub fn with_engine(mut self, engine: OpenEngine) -> Self {
        self.engine = Some(Arc::new(engine));
        self
    }

    /// With so much memory for each call, beside what the plant itself takes, where options do not say how much.
    #[must_use]
    pub fn with_memory(mut self, memory: Memory) -> Self {
        self.memory = memory;
        self
    }

    /// With so many threads of its own, at least 1, in place of those of the process.
    ///
    /// # Errors
    /// [`Error::Threads`] if they can't be started.
    pub fn with_threads(mut self, threads: usize) -> Result<Self, Error> {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads.max(1));
        self.threads = Some(Arc::new(pool.build()?));
        Ok(self)
    }

    /// With this called for every step of progress, from the thread that works.
    #[must_use]
    pub fn with_progress(mut self, progress: impl Fn(Progress) + Send + Sync + 'static) -> Self {
        self.progress = Some(Arc::new(progress));
        self
    }

    /// Breaks off what is done in this session, from whichever thread, and refuses what is asked of it later.
    pub fn cancel(&self) {
        self.is_cancelled.store(true, Ordering::Relaxed);
    }

    /// How much memory a call may take; [`Memory::Auto`] where the session does not say.
    pub(crate) fn memory(&self) -> Memory {
        self.memory
    }

    /// The session's engine, or else the one that options ask for.
    pub(crate) fn engine(&self, asked: Engine) -> Result<Arc<OpenEngine>, SimplifyError> {
        match &self.engine {
            Some(engine) => Ok(Arc::clone(engine)),
            None => Ok(Arc::new(OpenEngine::open(asked)?)),
        }
    }

    /// Does work on the session's threads, with an observer that tells progress and breaks off.
    pub(crate) fn watched<T: Send>(&self, work: impl FnOnce(&mut Observer<'_>) -> T + Send) -> T {
        let watched = || {
            work(&mut |progress| {
                if let Some(told) = &self.progress {
                    told(progress);
                }
                match self.is_cancelled.load(Ordering::Relaxed) {
                    true => ControlFlow::Break(()),
                    false => ControlFlow::Continue(()),
                }
            })
        };
        match &self.threads {
            Some(pool) => pool.install(watched),
            None => watched(),
        }
    }
}

impl fmt::Debug for Session {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Session")
            .field("engine", &self.engine)
            .field("memory", &self.memory)
            .field(
                "threads",
                &self.threads.as_ref().map(|pool| pool.current_num_threads()),
            )
            .field("is_cancelled", &self.is_cancelled)
            .finish_non_exhaustive()
    }
}
