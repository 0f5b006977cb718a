//! The threads of long batches.
//!
//! A process that forks takes none of its threads along. A pool of its own is therefore made for
//! each process, on the first batch; that of the parent is left alone in its children.

use std::sync::{Arc, Mutex, PoisonError};

use cylindroid::kinematics::KinematicsBatch;
use pyo3::prelude::*;
use rayon::{ThreadPool, ThreadPoolBuilder};

use crate::arrays::{self, Array};
use crate::error::{Failure, Result};

/// The pool, and the process that it is of.
static POOL: Mutex<Option<(u32, Arc<ThreadPool>)>> = Mutex::new(None);

/// [`arrays::written_to`] by a batch of the library.
pub(crate) fn written_to<'py>(
    py: Python<'py>,
    out: Option<Bound<'py, PyAny>>,
    count: Option<usize>,
    shape: &[usize],
    write: impl FnOnce(&mut [f64]) -> cylindroid::Result<()> + Send,
) -> Result<Array<'py>> {
    // Short ones stay on the thread that asks.
    let pool = if count.unwrap_or(1) > KinematicsBatch::CHUNK { Some(pool()?) } else { None };
    let mut result = Ok(());
    let array = arrays::written_to(py, out, count, shape, |out| {
        result = match pool {
            Some(pool) => pool.install(|| write(out)),
            None => write(out),
        };
    })?;
    result?;
    Ok(array)
}

/// What `work` gives, without the interpreter; on all threads where it is long.
pub(crate) fn run<T: Send>(
    py: Python<'_>,
    is_long: bool,
    work: impl FnOnce() -> T + Send,
) -> Result<T> {
    let pool = if is_long { Some(pool()?) } else { None };
    Ok(py.detach(|| match pool {
        Some(pool) => pool.install(work),
        None => work(),
    }))
}

fn pool() -> Result<Arc<ThreadPool>> {
    let process = std::process::id();
    let mut kept = POOL.lock().unwrap_or_else(PoisonError::into_inner);
    if let Some((of, pool)) = &*kept
        && *of == process
    {
        return Ok(Arc::clone(pool));
    }
    let pool = ThreadPoolBuilder::new().build().map_err(|e| {
        Failure::kind(format!("no threads for a batch: {e}; set RAYON_NUM_THREADS=1"))
    })?;
    let pool = Arc::new(pool);
    // Dropping that of the parent would wait for threads that are not there.
    std::mem::forget(kept.replace((process, Arc::clone(&pool))));
    Ok(pool)
}
