//! Inverses by name, with their numbers and metrics.

use cylindroid::inverse::{self, Method, Weights};
use pyo3::prelude::*;

use super::{PyInverse, by_method, of_each};
use crate::arrays::Numbers;
use crate::error::{Failure, Result};

/// The numbers of an inverse, as they are named on the command line.
#[derive(Debug, Default)]
pub(crate) struct MethodNumbers {
    pub(crate) eps: Option<f64>,
    pub(crate) damping: Option<f64>,
    pub(crate) onset: Option<f64>,
    pub(crate) filter: Option<f64>,
    pub(crate) max_rate: Option<f64>,
    pub(crate) shape: Option<f64>,
    pub(crate) floor: Option<f64>,
}

impl MethodNumbers {
    /// The method of this name with the numbers that were given; others are refused.
    pub(crate) fn apply(&self, mut method: Method) -> Result<Method> {
        let name = method.name();
        let mut own = method.numbers_mut();
        let given = [
            ("eps", self.eps),
            ("damping", self.damping),
            ("onset", self.onset),
            ("filter", self.filter),
            ("max_rate", self.max_rate),
            ("shape", self.shape),
            ("floor", self.floor),
        ];
        for (option, value) in given.into_iter().filter_map(|(o, v)| Some((o, v?))) {
            let Some((_, number)) = own.iter_mut().find(|(o, _)| *o == option) else {
                let names: Vec<&str> = own.iter().map(|(o, _)| *o).collect();
                let reason =
                    format!("the inverse '{name}' has no such number but {}", names.join(", "));
                return Err(Failure::option(option, value.to_string(), reason));
            };
            **number = value;
        }
        Ok(method)
    }
}

/// An inverse by name, in the metrics of joints and task.
///
/// Parameters
/// ----------
/// J : array_like, (m, n) or (N, m, n)
///     One matrix or a stack of them.
/// method : str
///     'truncated' (eps), 'damped' (damping), 'variable-damping' (onset, damping),
///     'numerical-filtering' (onset, damping, filter), 'selectively-damped' (max_rate),
///     'singular-value-filtering' (shape, floor).
/// joint_weights, task_weights : array_like, (n,), (n, n) and (m,), (m, m), optional
///     Symmetric and positive definite: a large joint weight keeps a joint still, a large task
///     weight a direction exact.
/// eps, damping, onset, filter, max_rate, shape, floor : float, optional
///     The numbers of the method, else their defaults.
///
/// Returns
/// -------
/// Inverse
///
/// Raises
/// ------
/// UnknownNameError
///     For a method that there is not, with the nearest names.
/// InvalidOptionError
///     For a number that the method has not, or outside of its interval.
/// NotFiniteError, DimensionError
///     For entries that are not finite, weights of the wrong size.
///
/// Examples
/// --------
/// >>> import cylindroid as cy
/// >>> cy.inverse([[1.0, 0.0], [0.0, 1e-3]], 'variable-damping').rank
/// 1
#[pyfunction]
#[pyo3(name = "inverse")]
#[pyo3(signature = (J, method = "truncated", *, joint_weights = None, task_weights = None,
    eps = None, damping = None, onset = None, filter = None, max_rate = None, shape = None,
    floor = None))]
#[expect(non_snake_case, reason = "the field's name")]
#[expect(clippy::too_many_arguments, reason = "they have names in Python")]
pub(crate) fn inverse_by_name(
    py: Python<'_>,
    J: Numbers<'_>,
    method: &str,
    joint_weights: Option<Numbers<'_>>,
    task_weights: Option<Numbers<'_>>,
    eps: Option<f64>,
    damping: Option<f64>,
    onset: Option<f64>,
    filter: Option<f64>,
    max_rate: Option<f64>,
    shape: Option<f64>,
    floor: Option<f64>,
) -> Result<PyInverse> {
    let numbers = MethodNumbers { eps, damping, onset, filter, max_rate, shape, floor };
    let method = numbers.apply(Method::named(method)?)?;
    let weights = Weights {
        joint: joint_weights.map(|w| w.metric("joint_weights")).transpose()?,
        task: task_weights.map(|w| w.metric("task_weights")).transpose()?,
    };
    if weights == Weights::NONE {
        return by_method(py, &J, method);
    }
    of_each(py, &J, |j| inverse::weighted(j, method, &weights))
}
