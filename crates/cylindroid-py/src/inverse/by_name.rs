//! Inverses by name, with their parameters and metrics.

use cylindroid::control::{InverseSelection, NamedInverse};
use cylindroid::inverse::{self, Weights};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use super::{PyInverse, by_method, of_each};
use crate::arrays::Numbers;
use crate::error::{Failure, Result, argument, entry};
use crate::parameter_tables::documented;

/// Values of parameters by name, from keyword arguments: `lam` stands for `lambda`, which Python
/// reserves.
pub(crate) fn parameters_of(
    function: &str,
    keywords: Option<&Bound<'_, PyDict>>,
) -> Result<Vec<(&'static str, f64)>> {
    let mut given = Vec::new();
    for (name, value) in keywords.into_iter().flatten() {
        let name: String = entry(function, &name)?;
        let meant = if name == "lam" { "lambda" } else { name.as_str() };
        let all = || NamedInverse::all().flat_map(|i| i.parameters).map(|p| p.name);
        let Some(known) = all().find(|known| *known == meant && name != "lambda") else {
            let message = format!("{function}() got an unexpected keyword argument '{name}'");
            return Err(Failure::kind(message));
        };
        // None is as if it were not given.
        if let Some(value) = entry(&name, &value)? {
            given.push((known, value));
        }
    }
    Ok(given)
}

/// An inverse by name, in the metrics of joints and task.
///
/// Parameters
/// ----------
/// J : array_like, (m, n) or (N, m, n)
///     One matrix or a stack of them.
/// method : str
///     A name of the list below.
/// joint_weights, task_weights : array_like, (n,), (n, n) and (m,), (m, m), optional
///     Symmetric and positive definite: a large joint weight keeps a joint still, a large task
///     weight a direction exact.
/// **parameters : float
///     Parameters of the method; the others keep their defaults (`inverse_methods` lists both).
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
///     For a parameter of another method, or outside its domain.
/// TypeError
///     For a keyword that is no parameter of any method.
/// NotFiniteError, DimensionError
///     For entries that are not finite, weights of the wrong size.
///
/// Examples
/// --------
/// >>> import cylindroid as cy
/// >>> cy.inverse([[1.0, 0.0], [0.0, 1e-3]], 'variable-damping').rank
/// 1
///
/// Methods
/// -------
#[doc = cylindroid::inverse_methods!(documented)]
#[pyfunction]
#[pyo3(name = "inverse")]
#[pyo3(signature = (J, method = "truncated", *, joint_weights = None, task_weights = None,
    **parameters))]
#[expect(non_snake_case, reason = "the field's name")]
pub(crate) fn inverse_by_name(
    py: Python<'_>,
    J: Numbers<'_>,
    #[pyo3(from_py_with = argument)] method: &str,
    joint_weights: Option<Numbers<'_>>,
    task_weights: Option<Numbers<'_>>,
    parameters: Option<&Bound<'_, PyDict>>,
) -> Result<PyInverse> {
    let parameters = parameters_of("inverse", parameters)?;
    let method = InverseSelection { name: method, parameters, ..Default::default() }.method()?;
    let weights = Weights {
        joint: joint_weights.map(|w| w.metric("joint_weights")).transpose()?,
        task: task_weights.map(|w| w.metric("task_weights")).transpose()?,
    };
    if weights == Weights::NONE {
        return by_method(py, &J, method);
    }
    of_each(py, &J, |j| inverse::weighted(j, method, &weights))
}
