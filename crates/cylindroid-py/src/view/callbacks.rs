//! Functions of Python that are called when somebody moves something on a page.

use std::sync::{Arc, Mutex, MutexGuard, PoisonError, Weak};
use std::thread;
use std::time::Duration;

use cylindroid_cli::show::{Drag, Viewer};
use pyo3::prelude::*;

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
    pub(super) fn add(self: &Arc<Self>, viewer: &Arc<Viewer>, moved: Moved, function: Py<PyAny>) {
        let mut functions = self.lock();
        match moved {
            Moved::Target => functions.target.push(function),
            Moved::Configuration => functions.configuration.push(function),
            Moved::Obstacle => functions.obstacle.push(function),
        }
        if !functions.is_running {
            functions.is_running = true;
            let (own, viewer) = (Arc::clone(self), Arc::downgrade(viewer));
            thread::spawn(move || own.run(&viewer));
        }
    }

    /// Until the viewer is closed, or Python ends.
    fn run(&self, viewer: &Weak<Viewer>) {
        // The viewer is held while it is waited for: closing it wakes.
        while let Some(drags) = viewer.upgrade().and_then(|viewer| viewer.next_drags(PATIENCE)) {
            let called = drags.iter().map(|drag| Python::try_attach(|py| self.call(py, drag)));
            if called.flatten().count() < drags.len() {
                return;
            }
        }
        // Functions may hold the view, whose cycle ends here.
        let functions = std::mem::take(&mut *self.lock());
        let _ = Python::try_attach(|_| drop(functions));
    }

    fn call(&self, py: Python<'_>, drag: &Drag) {
        let copies = |all: &[Py<PyAny>]| all.iter().map(|f| f.clone_ref(py)).collect::<Vec<_>>();
        // The lock is free while Python runs.
        let functions = match drag {
            Drag::Target(_) => copies(&self.lock().target),
            Drag::Configuration(_) => copies(&self.lock().configuration),
            Drag::Obstacle { .. } => copies(&self.lock().obstacle),
            _ => Vec::new(),
        };
        for function in functions {
            let told = || -> PyResult<()> {
                match drag {
                    Drag::Target(pose) => function.call1(py, (arrays::pose(py, *pose)?,))?,
                    Drag::Configuration(q) => function.call1(py, (arrays::vector(py, q),))?,
                    Drag::Obstacle { name, pose } => {
                        function.call1(py, (name, arrays::pose(py, *pose)?))?
                    }
                    _ => return Ok(()),
                };
                Ok(())
            };
            if let Err(error) = told() {
                error.write_unraisable(py, Some(function.bind(py)));
            }
        }
    }
}
