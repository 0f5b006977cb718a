//! The tables of inverses and secondary tasks: what may be named, with which parameters.

use cylindroid::control::{NamedInverse, SecondaryTask};
use cylindroid::inverse::Parameter;
use pyo3::prelude::*;
use pyo3::types::PyDict;

/// A table of the library as a list of a docstring.
macro_rules! documented {
    ($(
        $(#[doc = $doc:literal])+
        $variant:ident = $name:literal $(($($own:tt)*))? {
            $(
                $(#[doc = $about:literal])+
                $parameter:ident: $unit:literal in $domain:ident = $default:expr;
            )+
        } => |$($argument:ident),+| $body:expr,
    )+) => {
        concat!($(
            "'", $name, "' :", $($doc,)+ "\n\n",
            $("    - ", stringify!($parameter), " [", $unit, "]:", $($about,)+ "\n",)+ "\n",
        )+)
    };
}
pub(crate) use documented;

/// The inverses that `inverse` and `Servo` take by name, and their parameters.
///
/// Returns
/// -------
/// list of dict
///     `name`, `description` and `parameters`: for each its `name` (a keyword argument), `unit`,
///     `default` (None where it must be given), `domain` and `description`.
///
/// Examples
/// --------
/// >>> import cylindroid as cy
/// >>> [p["name"] for p in cy.inverse_methods()[2]["parameters"]]
/// ['onset', 'damping']
#[pyfunction]
pub(crate) fn inverse_methods(py: Python<'_>) -> PyResult<Vec<Bound<'_, PyDict>>> {
    NamedInverse::all().map(|i| row(py, [i.name, i.description], i.parameters)).collect()
}

/// The secondary tasks that `Servo` takes by name, and their parameters.
///
/// Returns
/// -------
/// list of dict
///     As `inverse_methods`; the parameters are keys of the dict that `Servo` takes for each task.
///
/// Examples
/// --------
/// >>> import cylindroid as cy
/// >>> [task["name"] for task in cy.secondary_tasks()]
/// ['posture', 'centring', 'limit-avoidance', 'manipulability']
#[pyfunction]
pub(crate) fn secondary_tasks(py: Python<'_>) -> PyResult<Vec<Bound<'_, PyDict>>> {
    let all = SecondaryTask::all(&[]);
    all.iter().map(|t| row(py, [t.name(), t.description()], t.parameters())).collect()
}

fn row<'py>(
    py: Python<'py>,
    [name, description]: [&str; 2],
    parameters: &[Parameter],
) -> PyResult<Bound<'py, PyDict>> {
    let parameters = parameters.iter().map(|p| {
        let row = PyDict::new(py);
        // Python reserves the word.
        row.set_item("name", if p.name == "lambda" { "lam" } else { p.name })?;
        row.set_item("unit", p.unit)?;
        row.set_item("default", (!p.required).then_some(p.default))?;
        row.set_item("domain", p.domain.describe())?;
        row.set_item("description", p.description)?;
        Ok(row)
    });
    let row = PyDict::new(py);
    row.set_item("name", name)?;
    row.set_item("description", description)?;
    row.set_item("parameters", parameters.collect::<PyResult<Vec<_>>>()?)?;
    Ok(row)
}
