//! Batched mobility and manipulability measures of many configurations.

use cylindroid::manipulability::{BatchOptions, ManipulabilityBatch};
use numpy::IntoPyArray;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use super::PyConstraint;
use super::metrics::Question;
use crate::arrays::Numbers;
use crate::coordinates::{Coordinates, Rows};
use crate::error::{Result, argument};
use crate::mechanism::PyMechanism;
use crate::threads;

/// The Python type of a measure.
enum Kind {
    Truth,
    Count,
    Number,
}

fn kind(name: &str) -> Kind {
    match name {
        "closed" => Kind::Truth,
        "dof" | "redundancy" | "indeterminacy" | "coordinate" | "internal" | "zero_torque"
        | "hyperstatic" | "idle" => Kind::Count,
        _ => Kind::Number,
    }
}

#[pymethods]
impl PyMechanism {
    /// Batched mobility and manipulability measures of many configurations.
    ///
    /// The values of `mobility` and `manipulability` without bases and directions: at least ten
    /// times as fast, and on all cores.
    ///
    /// Parameters
    /// ----------
    /// q : array_like, (n,) or (N, n)
    ///     Coordinates in the order of `joint_names` [rad or m].
    /// actuated, reference
    ///     As for `constraint`.
    /// task : str, list of str or array_like, (k, d), optional
    ///     Components of the twist that form the task ('x,y'), or a linear map of the twist, as for
    ///     `manipulability`: counts, distances of type I and II and efficiencies are then its own.
    /// Wu, Wq : array_like, square or their diagonals, optional
    ///     Metrics of twists (or the task) and joint velocities, as for `manipulability`.
    /// metric : str
    ///     'unit', 'length' or 'limits', as for `manipulability`.
    /// length : float, optional
    ///     Characteristic length (m). Default: that of the mechanism, `reach`.
    ///
    /// Returns
    /// -------
    /// dict of str to ndarray, (N,), or to a number for one configuration
    ///     `closure_distance` [m], `closure_angle` [rad], `closed`: the loop-closure error;
    ///     `dof`, `redundancy`, `indeterminacy`, `coordinate`, `internal`, `zero_torque`,
    ///     `hyperstatic`, `idle`: the counts of `mobility`;
    ///     `type_i`, `type_ii`, `configuration_space`, `passive`: distances to singularities of
    ///     these kinds, 0 at a singularity, infinite if the kind cannot occur;
    ///     `volume`, `largest`, `smallest`, `anisotropy` of the kinematic efficiencies, the last
    ///     three NaN if no efficiency is finite.
    ///
    /// Raises
    /// ------
    /// DimensionError, NotFiniteError, UnknownNameError, InvalidOptionError, ModelError
    ///
    /// Notes
    /// -----
    /// A configuration is singular if its counts differ from the generic counts of the branches
    /// through home, which the first call determines (up to tens of milliseconds).
    ///
    /// Examples
    /// --------
    /// >>> import cylindroid as cy
    /// >>> found = cy.load("stewart").measures([[0.0] * 21] * 2)
    /// >>> found["dof"]
    /// array([6, 6])
    #[pyo3(signature = (q, actuated = None, reference = None, Wu = None, Wq = None,
        metric = "unit", length = None, task = None))]
    #[expect(non_snake_case, reason = "the field's names")]
    #[expect(clippy::too_many_arguments, reason = "they have names in Python")]
    fn measures<'py>(
        &self,
        py: Python<'py>,
        q: Coordinates<'py>,
        #[pyo3(from_py_with = argument)] actuated: Option<Vec<String>>,
        #[pyo3(from_py_with = argument)] reference: Option<&str>,
        Wu: Option<Numbers<'py>>,
        Wq: Option<Numbers<'py>>,
        #[pyo3(from_py_with = argument)] metric: &str,
        #[pyo3(from_py_with = argument)] length: Option<f64>,
        #[pyo3(from_py_with = argument)] task: Option<Bound<'py, PyAny>>,
    ) -> Result<Bound<'py, PyDict>> {
        let actuated = actuated.map(|names| self.inner.with_actuated(&names)).transpose()?;
        let mechanism = actuated.as_ref().unwrap_or(&self.inner);
        let rows = Rows::of(mechanism, "q", &q)?;
        let home = PyConstraint::of(mechanism, mechanism.home(), reference, length)?;
        let weights = [Wu.as_ref(), Wq.as_ref(), None, None];
        let question = Question::about(&home, task.as_ref(), weights, metric)?;
        let metrics = question.metrics(&home)?;
        let reference = match &home.origin {
            Some(origin) => origin.reference,
            None => mechanism.reference(),
        };
        let about = (reference, home.inner.length());
        let count = rows.count.unwrap_or(1);
        let numbers = threads::run(py, count > ManipulabilityBatch::CHUNK, || {
            let task = question.map;
            let options = BatchOptions { metrics, task, ..BatchOptions::default() };
            let mut numbers = vec![0.0; count * ManipulabilityBatch::WIDTH];
            let batch = self.ordinary.batch(mechanism, about, options)?;
            batch.analyse_into(rows.values, &mut numbers).map(|()| numbers)
        })??;
        let found = PyDict::new(py);
        for (i, name) in ManipulabilityBatch::COLUMNS.into_iter().enumerate() {
            let column = || numbers.iter().skip(i).step_by(ManipulabilityBatch::WIDTH).copied();
            #[expect(clippy::cast_possible_truncation, reason = "small whole numbers")]
            match (kind(name), rows.count) {
                (Kind::Truth, None) => found.set_item(name, numbers[i] > 0.0),
                (Kind::Count, None) => found.set_item(name, numbers[i] as i64),
                (Kind::Number, None) => found.set_item(name, numbers[i]),
                (Kind::Truth, _) => {
                    let all: Vec<bool> = column().map(|x| x > 0.0).collect();
                    found.set_item(name, all.into_pyarray(py))
                }
                (Kind::Count, _) => {
                    let all: Vec<i64> = column().map(|x| x as i64).collect();
                    found.set_item(name, all.into_pyarray(py))
                }
                (Kind::Number, _) => {
                    found.set_item(name, column().collect::<Vec<f64>>().into_pyarray(py))
                }
            }?;
        }
        Ok(found)
    }
}
