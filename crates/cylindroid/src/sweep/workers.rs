//! Workers: threads that compute the parts of a search or of a map, count what they do, and end where
//! the observer stops them.
//!
//! Checked  tests/sweep/optimise.rs, tests/map/threads.rs

use std::num::NonZeroUsize;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};

use super::Progress;
use super::parts::run_parts;
use crate::error::Result;

/// What the threads count, and whether the observer wants them to go on.
#[derive(Debug, Default)]
pub(super) struct Watch {
    done: AtomicU64,
    stopped: AtomicBool,
}

impl Watch {
    /// Counts what was done.
    pub(super) fn count(&self, more: u64) {
        self.done.fetch_add(more, Ordering::Relaxed);
    }

    /// False once the observer has stopped the run: results are no longer needed.
    pub(super) fn goes_on(&self) -> bool {
        !self.stopped.load(Ordering::Relaxed)
    }

    fn stop(&self) {
        self.stopped.store(true, Ordering::Relaxed);
    }

    /// Asks the observer whether to go on; one that has said no is not asked again.
    fn asked(
        &self,
        (unit, rows): (&'static str, u64),
        observe: &mut dyn FnMut(&Progress) -> bool,
    ) -> bool {
        let done = self.done.load(Ordering::Relaxed);
        let go_on = self.goes_on() && observe(&Progress { unit, rows, done, computed: done });
        if !go_on {
            self.stop();
        }
        go_on
    }
}

/// The threads and their observer.
pub(super) struct Workers<'a> {
    threads: Option<NonZeroUsize>,
    observe: &'a mut dyn FnMut(&Progress) -> bool,
    watch: Watch,
    /// What is counted, and how many there are.
    counted: (&'static str, u64),
}

impl<'a> Workers<'a> {
    /// As many threads as the machine has by default.
    pub(super) fn new(
        threads: Option<NonZeroUsize>,
        observe: &'a mut dyn FnMut(&Progress) -> bool,
    ) -> Self {
        Self { threads, observe, watch: Watch::default(), counted: ("", 0) }
    }

    /// Begins to count in this unit: `all` of them, of which some are `done` already.
    pub(super) fn begin(&mut self, unit: &'static str, all: u64, done: u64) {
        self.counted = (unit, all);
        *self.watch.done.get_mut() = done;
    }

    /// False once the observer has stopped the run.
    pub(super) fn goes_on(&self) -> bool {
        self.watch.goes_on()
    }

    /// The results of all parts in their order; `None` if the observer stopped them. Each thread has
    /// memory of its own.
    pub(super) fn run<M: Default, T: Send>(
        &mut self,
        count: usize,
        work: impl Fn(&mut M, usize, &Watch) -> Result<T> + Sync,
    ) -> Result<Option<Vec<T>>> {
        let mut all: Vec<Option<T>> = (0..count).map(|_| None).collect();
        let (counted, watch, observe) = (self.counted, &self.watch, &mut *self.observe);
        run_parts(
            count,
            self.threads,
            // After an error nobody needs the other parts.
            |memory: &mut M, part| work(memory, part, watch).inspect_err(|_| watch.stop()),
            |part, result| all[part] = Some(result),
            || Ok(watch.asked(counted, observe)),
        )?;
        Ok(all.into_iter().collect::<Option<Vec<T>>>().filter(|_| self.watch.goes_on()))
    }

    /// The result of work on the thread of the caller, which is shorter than the start of threads;
    /// `None` if the observer stopped it.
    pub(super) fn run_here<T>(
        &mut self,
        work: impl FnOnce(&Watch) -> Result<T>,
    ) -> Result<Option<T>> {
        let result = work(&self.watch)?;
        Ok(self.watch.asked(self.counted, self.observe).then_some(result))
    }
}
