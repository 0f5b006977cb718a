//! Parts of a sweep on several threads.
//!
//! Why so   each thread takes the next part, alone, so that memory is that of as many parts as there
//!          are threads, and numbers do not depend on how many there are
//! Checked  tests/sweep/folder.rs::threads_change_nothing, tests/sweep/errors.rs

use std::num::NonZeroUsize;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::mpsc::{self, RecvTimeoutError};
use std::thread::{self, Builder};
use std::time::Duration;

use crate::error::{Error, Result};

/// Between two calls of `tick` at most.
const TICK: Duration = Duration::from_millis(100);

/// Runs `work` on the parts 0 to `count`, as many at a time as there are threads, each with memory of
/// its own. On the thread of the caller, `finished` takes each result as it comes and `tick` says
/// whether to go on; after false, parts that have been started are finished, no others begin and
/// `tick` is not called again. An error ends the run in the same way.
///
/// Of several parts with an error that of the first is returned, whatever the threads: parts begin
/// in their order, so all before it have begun, and end.
pub(super) fn run_parts<M: Default, T: Send>(
    count: usize,
    threads: Option<NonZeroUsize>,
    work: impl Fn(&mut M, usize) -> Result<T> + Sync,
    mut finished: impl FnMut(usize, T),
    mut tick: impl FnMut() -> Result<bool>,
) -> Result<()> {
    let threads = threads.or_else(|| thread::available_parallelism().ok());
    let threads = threads.map_or(1, NonZeroUsize::get).min(count.max(1));
    let (next, stop) = (AtomicUsize::new(0), AtomicBool::new(false));
    let (sender, receiver) = mpsc::channel();
    let mut failed: Option<(usize, Error)> = None;
    let mut ticked = Ok(true);
    thread::scope(|scope| {
        for started in 0..threads {
            let sender = sender.clone();
            let (next, stop, work) = (&next, &stop, &work);
            let spawned = Builder::new().spawn_scoped(scope, move || {
                let mut memory = M::default();
                while !stop.load(Ordering::Relaxed) {
                    let part = next.fetch_add(1, Ordering::Relaxed);
                    // The receiver outlives the threads.
                    if part >= count || sender.send((part, work(&mut memory, part))).is_err() {
                        return;
                    }
                }
            });
            // Those that the system permits do the work.
            if let Err(error) = spawned {
                if started == 0 {
                    let reason = format!("no thread could be started: {error}");
                    let value = threads.to_string();
                    failed = Some((0, Error::InvalidOption { option: "threads", value, reason }));
                }
                break;
            }
        }
        drop(sender);
        loop {
            match receiver.recv_timeout(TICK) {
                Ok((part, Ok(own))) => finished(part, own),
                Ok((part, Err(error))) => {
                    if failed.as_ref().is_none_or(|(first, _)| part < *first) {
                        failed = Some((part, error));
                    }
                }
                Err(RecvTimeoutError::Timeout) => {}
                Err(RecvTimeoutError::Disconnected) => break,
            }
            if matches!(ticked, Ok(true)) {
                ticked = tick();
            }
            if failed.is_some() || !matches!(ticked, Ok(true)) {
                stop.store(true, Ordering::Relaxed);
            }
        }
    });
    failed.map_or(ticked.map(|_| ()), |(_, error)| Err(error))
}
