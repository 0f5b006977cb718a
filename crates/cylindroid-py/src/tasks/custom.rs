//! A task whose error and Jacobian a function of Python computes.

use std::sync::{Arc, Mutex, PoisonError};

use cylindroid::control::CustomTask;
use cylindroid::{Error, Matrix, State};
use pyo3::prelude::*;

use crate::arrays::{self, Numbers};
use crate::error::{Failure, entry};

/// The exception of a function, for the call that made the step.
pub(super) type Raised = Arc<Mutex<Option<PyErr>>>;

#[derive(Debug, Clone)]
pub(super) struct FunctionTask {
    pub(super) function: Arc<Py<PyAny>>,
    pub(super) rows: usize,
    pub(super) name: String,
    pub(super) raised: Raised,
}

impl FunctionTask {
    fn call(
        &self,
        py: Python<'_>,
        q: &[f64],
        error: &mut [f64],
        jacobian: &mut Matrix,
    ) -> Result<(), Failure> {
        let name = &self.name;
        let returned = self.function.bind(py).call1((arrays::vector(py, q),))?;
        let pair: Result<(Bound<'_, PyAny>, Bound<'_, PyAny>), _> = returned.extract();
        let Ok((e, j)) = pair else {
            let kind = returned.get_type();
            return Err(Failure::kind(format!(
                "the function of the task '{name}' returned {kind}, not (error, jacobian)"
            )));
        };
        let e: Numbers<'_> = entry("error", &e)?;
        let j: Numbers<'_> = entry("jacobian", &j)?;
        for (part, numbers, shape) in
            [("error", &e, &[self.rows][..]), ("Jacobian", &j, &[self.rows, q.len()])]
        {
            if numbers.shape() != shape {
                let reason = format!(
                    "the function of the task '{name}' must return an {part} of shape {}",
                    arrays::shape_text(shape)
                );
                return Err(Failure::option("tasks", numbers.shape_text(), reason));
            }
        }
        error.copy_from_slice(e.values());
        *jacobian = j.matrix("jacobian")?;
        Ok(())
    }
}

impl CustomTask for FunctionTask {
    fn rows(&self) -> usize {
        self.rows
    }

    fn evaluate(
        &mut self,
        state: &State,
        error: &mut [f64],
        jacobian: &mut Matrix,
    ) -> cylindroid::Result<()> {
        let called = Python::attach(|py| self.call(py, state.q(), error, jacobian));
        called.map_err(|failure| {
            let mut raised = self.raised.lock().unwrap_or_else(PoisonError::into_inner);
            *raised = Some(failure.into());
            Error::InvalidOption {
                option: "tasks",
                value: self.name.clone(),
                reason: "its function raised an exception".to_owned(),
            }
        })
    }

    fn boxed(&self) -> Box<dyn CustomTask> {
        Box::new(self.clone())
    }
}
