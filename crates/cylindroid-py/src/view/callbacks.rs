//! Functions of Python that are called when somebody moves something on a page.

use std::collections::VecDeque;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError, Weak};
use std::time::Duration;

use cylindroid_cli::show::{Drag, Viewer};
use pyo3::prelude::*;
use pyo3::types::PyTuple;

use crate::arrays;

/// How long the thread waits at a time.
const PATIENCE: Duration = Duration::from_secs(1);

/// The functions that are called, by what is moved.
#[derive(Debug, Default)]
pub(super) struct Callbacks(Mutex<Functions>);

#[derive(Debug, Default)]
struct Functions {
    target: Vec<Py<PyAny>>,
    configuration: Vec<Py<PyAny>>,
    obstacle: Vec<Py<PyAny>>,
    is_running: bool,
}

/// What a function is called for.
#[derive(Debug, Clone, Copy)]
pub(super) enum Moved {
    Target,
    Configuration,
    Obstacle,
}

impl Callbacks {
    fn lock(&self) -> MutexGuard<'_, Functions> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Calls this function from now on, in a thread of its own.
    pub(super) fn add(
        self: &Arc<Self>,
        py: Python<'_>,
        viewer: &Arc<Viewer>,
        moved: Moved,
        function: Py<PyAny>,
    ) -> PyResult<()> {
        let mut functions = self.lock();
        match moved {
            Moved::Target => functions.target.push(function),
            Moved::Configuration => functions.configuration.push(function),
            Moved::Obstacle => functions.obstacle.push(function),
        }
        let is_running = std::mem::replace(&mut functions.is_running, true);
        // The lock is free while Python runs.
        drop(functions);
        if !is_running {
            let viewer = Arc::downgrade(viewer);
            let calls = Calls { callbacks: Arc::clone(self), viewer, waiting: Mutex::default() };
            let started = py
                .import("cylindroid._show")
                .and_then(|show| show.call_method1("start_calls", (calls,)));
            if let Err(error) = started {
                self.lock().is_running = false;
                return Err(error);
            }
        }
        Ok(())
    }

    /// The functions for this drag, with their arguments.
    fn calls(&self, py: Python<'_>, drag: &Drag) -> PyResult<Vec<Call>> {
        let copies = |all: &[Py<PyAny>]| all.iter().map(|f| f.clone_ref(py)).collect::<Vec<_>>();
        // The lock is free while Python makes the arguments.
        let arguments = match drag {
            Drag::Target(pose) => (arrays::pose(py, *pose)?,).into_pyobject(py)?,
            Drag::Configuration(q) => (arrays::vector(py, q),).into_pyobject(py)?,
            Drag::Obstacle { name, pose } => (name, arrays::pose(py, *pose)?).into_pyobject(py)?,
            _ => return Ok(Vec::new()),
        };
        let functions = {
            let functions = self.lock();
            match drag {
                Drag::Target(_) => copies(&functions.target),
                Drag::Configuration(_) => copies(&functions.configuration),
                _ => copies(&functions.obstacle),
            }
        };
        Ok(functions.into_iter().map(|f| (f, arguments.clone().unbind())).collect())
    }
}

/// A function and its arguments.
type Call = (Py<PyAny>, Py<PyTuple>);

/// The calls to be made, one after the other; waits for each until the viewer is closed.
///
/// Python makes them: at the end of a program it ends threads that wait for it, which no frame of
/// Rust below the function would survive.
#[pyclass(frozen)]
#[derive(Debug)]
struct Calls {
    callbacks: Arc<Callbacks>,
    viewer: Weak<Viewer>,
    waiting: Mutex<VecDeque<Call>>,
}

impl Calls {
    fn waiting(&self) -> MutexGuard<'_, VecDeque<Call>> {
        self.waiting.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

#[pymethods]
impl Calls {
    fn __iter__(slf: PyRef<'_, Self>) -> PyRef<'_, Self> {
        slf
    }

    fn __next__(&self, py: Python<'_>) -> PyResult<Option<Call>> {
        loop {
            let next = self.waiting().pop_front();
            if next.is_some() {
                return Ok(next);
            }
            // The viewer is held while it is waited for: closing it wakes.
            let wait = || self.viewer.upgrade().and_then(|viewer| viewer.next_drags(PATIENCE));
            let Some(drags) = py.detach(wait) else {
                // Functions may hold the view, whose cycle ends here.
                let functions = std::mem::take(&mut *self.callbacks.lock());
                drop(functions);
                return Ok(None);
            };
            for drag in &drags {
                let calls = self.callbacks.calls(py, drag)?;
                self.waiting().extend(calls);
            }
        }
    }

    /// Says that a function has failed; the next calls are made none the less.
    #[expect(clippy::unused_self, reason = "a method in Python")]
    fn failed(&self, py: Python<'_>, function: &Bound<'_, PyAny>, error: Bound<'_, PyAny>) {
        PyErr::from_value(error).write_unraisable(py, Some(function));
    }
}
