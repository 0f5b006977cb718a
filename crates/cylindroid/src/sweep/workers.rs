//! Workers: threads that compute the parts of a search or of a map, count what they do, and end where
//! the observer stops them.
//!
//! Checked  tests in this file, tests/sweep/optimise.rs, tests/map/threads.rs

use std::num::NonZeroUsize;
use std::sync::atomic::{AtomicBool, AtomicU64, AtomicUsize, Ordering};

use super::Progress;
use super::parts::run_parts;
use crate::error::Result;

/// What the threads count, whether the observer wants them to go on, and the first part with an error.
#[derive(Debug)]
struct Shared {
    done: AtomicU64,
    stopped: AtomicBool,
    failed: AtomicUsize,
}

/// What a part sees of them.
#[derive(Debug, Clone, Copy)]
pub(super) struct Watch<'a> {
    shared: &'a Shared,
    part: usize,
}

impl Watch<'_> {
    /// Counts what was done.
    pub(super) fn count(&self, more: u64) {
        self.shared.done.fetch_add(more, Ordering::Relaxed);
    }

    /// False once the result is no longer needed: the observer has stopped the run, or a part before
    /// this one has an error. Those before that part go on, for their errors come first.
    pub(super) fn goes_on(&self) -> bool {
        self.shared.goes_on() && self.part <= self.shared.failed.load(Ordering::Relaxed)
    }
}

impl Shared {
    fn goes_on(&self) -> bool {
        !self.stopped.load(Ordering::Relaxed)
    }

    /// Asks the observer whether to go on; one that has said no is not asked again.
    fn asked(
        &self,
        Counted { unit, all: rows, at_most }: Counted,
        observe: &mut dyn FnMut(&Progress) -> bool,
    ) -> bool {
        let done = self.done.load(Ordering::Relaxed);
        let progress = Progress { unit, rows, at_most, done, computed: done };
        let go_on = self.goes_on() && observe(&progress);
        if !go_on {
            self.stopped.store(true, Ordering::Relaxed);
        }
        go_on
    }
}

/// What is counted.
#[derive(Debug, Clone, Copy)]
pub(super) struct Counted {
    pub(super) unit: &'static str,
    /// How many there are.
    pub(super) all: u64,
    /// True if there may be fewer.
    pub(super) at_most: bool,
}

/// The threads and their observer.
pub(super) struct Workers<'a> {
    threads: Option<NonZeroUsize>,
    observe: &'a mut dyn FnMut(&Progress) -> bool,
    shared: Shared,
    counted: Counted,
}

impl<'a> Workers<'a> {
    /// As many threads as the machine has by default.
    pub(super) fn new(
        threads: Option<NonZeroUsize>,
        observe: &'a mut dyn FnMut(&Progress) -> bool,
    ) -> Self {
        let shared = Shared {
            done: AtomicU64::new(0),
            stopped: AtomicBool::new(false),
            failed: AtomicUsize::new(usize::MAX),
        };
        let counted = Counted { unit: "", all: 0, at_most: false };
        Self { threads, observe, shared, counted }
    }

    /// Begins to count; some are `done` already.
    pub(super) fn begin(&mut self, counted: Counted, done: u64) {
        self.counted = counted;
        *self.shared.done.get_mut() = done;
    }

    /// False once the observer has stopped the run.
    pub(super) fn goes_on(&self) -> bool {
        self.shared.goes_on()
    }

    /// The results of all parts in their order; `None` if the observer stopped them. Each thread has
    /// memory of its own.
    pub(super) fn run<M: Default, T: Send>(
        &mut self,
        count: usize,
        work: impl Fn(&mut M, usize, Watch<'_>) -> Result<T> + Sync,
    ) -> Result<Option<Vec<T>>> {
        let mut all: Vec<Option<T>> = (0..count).map(|_| None).collect();
        let (counted, shared, observe) = (self.counted, &self.shared, &mut *self.observe);
        run_parts(
            count,
            self.threads,
            |memory: &mut M, part| {
                let result = work(memory, part, Watch { shared, part });
                if result.is_err() {
                    shared.failed.fetch_min(part, Ordering::Relaxed);
                }
                result
            },
            |part, result| all[part] = Some(result),
            || Ok(shared.asked(counted, observe)),
        )?;
        Ok(all.into_iter().collect::<Option<Vec<T>>>().filter(|_| self.shared.goes_on()))
    }

    /// The result of work on the thread of the caller, which is shorter than the start of threads;
    /// `None` if the observer stopped it.
    pub(super) fn run_here<T>(
        &mut self,
        work: impl FnOnce(Watch<'_>) -> Result<T>,
    ) -> Result<Option<T>> {
        let result = work(Watch { shared: &self.shared, part: 0 })?;
        Ok(self.shared.asked(self.counted, self.observe).then_some(result))
    }
}

#[cfg(test)]
mod tests {
    use std::thread;
    use std::time::Duration;

    use super::*;
    use crate::error::Error;

    /// A part with an error, which it has after some time, is waited for where others have one earlier;
    /// it is not asked to stop before it has it, those after it are.
    #[test]
    fn of_several_errors_that_of_the_first_part_is_returned() {
        for threads in [1, 2, 8] {
            let mut go_on = |_: &Progress| true;
            let mut workers = Workers::new(NonZeroUsize::new(threads), &mut go_on);
            let found = workers.run(100, |(): &mut (), part, watch| match part {
                3 => {
                    for _ in 0..20 {
                        thread::sleep(Duration::from_millis(1));
                        if !watch.goes_on() {
                            return Ok(());
                        }
                    }
                    Err(Error::unknown("part", "3", [""]))
                }
                5.. => Err(Error::unknown("part", &part.to_string(), [""])),
                _ => Ok(()),
            });
            let error = found.unwrap_err().to_string();
            assert!(error.contains("'3'"), "{threads} threads: {error}");
            assert!(workers.goes_on());
        }
    }
}
