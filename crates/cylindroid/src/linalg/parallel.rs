//! Runs independent jobs on the threads of rayon; one after the other without the feature
//! `parallel`. Results are in the order of the jobs either way.
//!
//! Checked  tests/it/batch.rs::does_not_depend_on_threads_or_places,
//!          tests/it/inverse_batch.rs::threads_change_nothing

/// The results of `run` on every job.
#[cfg(feature = "parallel")]
pub(crate) fn run_all<J: Send, R: Send>(
    jobs: Vec<J>,
    run: impl Fn(J) -> R + Send + Sync,
) -> Vec<R> {
    use rayon::prelude::*;
    jobs.into_par_iter().map(run).collect()
}

/// The results of `run` on every job.
#[cfg(not(feature = "parallel"))]
pub(crate) fn run_all<J, R>(jobs: Vec<J>, run: impl Fn(J) -> R) -> Vec<R> {
    jobs.into_iter().map(run).collect()
}
