//! Optimal designs and trade-offs.

use cylindroid::control::Task;
use cylindroid::sweep::{
    DesignObjective, Optimisation, OptimisationOptions, Optimum, Sense, SweepOptions,
    VelocityMetric,
};
use numpy::IntoPyArray;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyList};

use crate::arrays::Numbers;
use crate::coordinates::Coordinates;
use crate::error::{Result, argument, count, entry};
use crate::mechanism::PyMechanism;
use crate::sweep::{Chosen, count_of, go_on, ranges};

/// Optimal designs.
///
/// Attributes
/// ----------
/// best : dict of str to float or None
///     The parameters of the first design, for `load(path, parameters=found.best)`.
/// designs : dict of str to ndarray, (K,)
///     Columns: the parameters, the indices ('anisotropy:largest', ...) and 'refined'. One row, or for
///     several objectives the designs that no other one found dominates, by the first objective, best
///     first. No row if no design has the indices.
/// refinements : list of dict
///     'start' and 'values' (parameters by name), 'indices' at the end, 'evaluated' (number of designs)
///     and 'converged' (new simplices no longer improved it).
/// evaluated : int
///     Number of designs that were evaluated.
/// invalid : int
///     Those without a mechanism: a value out of range, loops that do not close.
/// without_index : int
///     Those with a mechanism, but without a finite index.
/// reason : str or None
///     The reason of the first of these.
#[pyclass(frozen, module = "cylindroid", name = "OptimalDesigns")]
#[derive(Debug)]
pub(crate) struct PyOptimalDesigns {
    found: Optimum,
}

impl PyOptimalDesigns {
    fn parameters<'py>(&self, py: Python<'py>, values: &[f64]) -> PyResult<Bound<'py, PyDict>> {
        let own = PyDict::new(py);
        for ((name, _), value) in self.found.parameters.iter().zip(values) {
            own.set_item(name, value)?;
        }
        Ok(own)
    }

    fn indices<'py>(&self, py: Python<'py>, values: &[f64]) -> PyResult<Bound<'py, PyDict>> {
        let own = PyDict::new(py);
        for (objective, value) in self.found.objectives.iter().zip(values) {
            own.set_item(objective.name(), value)?;
        }
        Ok(own)
    }
}

#[pymethods]
impl PyOptimalDesigns {
    #[getter]
    fn best<'py>(&self, py: Python<'py>) -> PyResult<Option<Bound<'py, PyDict>>> {
        let first = self.found.designs.first();
        first.map(|design| self.parameters(py, &design.values)).transpose()
    }

    #[getter]
    fn designs<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let columns = PyDict::new(py);
        let designs = &self.found.designs;
        for (i, (name, _)) in self.found.parameters.iter().enumerate() {
            let column: Vec<f64> = designs.iter().map(|d| d.values[i]).collect();
            columns.set_item(name, column.into_pyarray(py))?;
        }
        for (i, objective) in self.found.objectives.iter().enumerate() {
            let column: Vec<f64> = designs.iter().map(|d| d.indices[i]).collect();
            columns.set_item(objective.name(), column.into_pyarray(py))?;
        }
        let refined: Vec<bool> = designs.iter().map(|d| d.refined).collect();
        columns.set_item("refined", refined.into_pyarray(py))?;
        Ok(columns)
    }

    #[getter]
    fn refinements<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyList>> {
        let one = |refinement: &cylindroid::sweep::Refinement| {
            let own = PyDict::new(py);
            own.set_item("start", self.parameters(py, &refinement.start)?)?;
            own.set_item("values", self.parameters(py, &refinement.values)?)?;
            own.set_item("indices", self.indices(py, &refinement.indices)?)?;
            own.set_item("evaluated", refinement.evaluated)?;
            own.set_item("converged", refinement.converged)?;
            Ok(own)
        };
        PyList::new(py, self.found.refinements.iter().map(one).collect::<PyResult<Vec<_>>>()?)
    }

    #[getter]
    const fn evaluated(&self) -> u64 {
        self.found.evaluated
    }

    #[getter]
    const fn invalid(&self) -> u64 {
        self.found.invalid
    }

    #[getter]
    const fn without_index(&self) -> u64 {
        self.found.without_index
    }

    #[getter]
    fn reason(&self) -> Option<&str> {
        self.found.reason.as_deref()
    }

    fn __repr__(&self) -> String {
        let objectives: Vec<String> = self
            .found
            .objectives
            .iter()
            .map(|o| format!("{} {}", o.sense.name(), o.name()))
            .collect();
        let (designs, evaluated) = (self.found.designs.len(), self.found.evaluated);
        format!("OptimalDesigns({}: {designs} of {evaluated} designs)", objectives.join(", "))
    }
}

/// Optimal designs: parameters of a mechanism file that minimise or maximise indices, and their
/// trade-offs.
///
/// Designs are sampled within the ranges, and the best of them are refined by the Nelder-Mead method,
/// restarted until it improves nothing. With several indices the result is a Pareto front, and each
/// refinement improves a sample in all indices. Optima are those found: nothing proves that there are
/// no better ones. Results depend neither on the number of threads nor on the order of parameters and
/// indices.
///
/// Parameters
/// ----------
/// mechanism : Mechanism
///     Of a mechanism file with parameters.
/// vary : dict of str to (float, float)
///     The range of each parameter, in the unit of the file.
/// minimise, maximise : str or sequence of str
///     Columns of numbers of `sweep`, such as 'condition', 'yoshikawa', 'anisotropy' or 'type_ii', with
///     a statistic over the configurations: 'condition:mean', 'condition:smallest',
///     'condition:largest'. Default: that of the worst configuration.
/// designs : int
///     Number of sampled designs.
/// starts : int
///     How many of them are refined: the best, for several indices some along the front.
/// evaluations : int
///     Designs that a refinement evaluates at most.
/// seed : int
///     Selects one of the sequences of designs and of configurations.
/// samples, over, q, configurations
///     The configurations of each design, as for `sweep`; home by default. Parameters in `over` are a
///     workspace, at each point of which designs are evaluated.
/// frame, tool, relative_to, task, metric, length, threads
///     As for `sweep`.
///
/// Returns
/// -------
/// OptimalDesigns
///
/// Raises
/// ------
/// InvalidOptionError, UnknownNameError, DimensionError, NotFiniteError
///
/// Examples
/// --------
/// >>> import cylindroid as cy
/// >>> arm = cy.parse('''
/// ... dimension = 2
/// ... reference = "hand"
/// ... reference_point = ["1 + b", 0]
/// ... [parameters]
/// ... b = 0.9
/// ... [[joint]]
/// ... name = "shoulder"
/// ... type = "revolute"
/// ... between = ["ground", "arm"]
/// ... origin = [0, 0]
/// ... [[joint]]
/// ... name = "elbow"
/// ... type = "revolute"
/// ... between = ["arm", "hand"]
/// ... origin = [1, 0]
/// ... ''', "toml")
/// >>> found = cy.optimise(arm, {"b": (0.2, 2.0)}, minimise="condition", q=[0, 2.356], task="x,y")
/// >>> print(f"{found.best['b']:.3f}")
/// 0.707
#[pyfunction]
#[pyo3(signature = (mechanism, vary, minimise = None, maximise = None, designs = 64, starts = 4,
    evaluations = 2000, seed = 0, samples = None, over = None, q = None, configurations = None,
    frame = None, tool = None, task = None, metric = "unit", length = None, threads = None,
    relative_to = None))]
#[expect(clippy::too_many_arguments, reason = "they have names in Python")]
pub(crate) fn optimise<'py>(
    py: Python<'py>,
    #[pyo3(from_py_with = argument)] mechanism: PyRef<'py, PyMechanism>,
    #[pyo3(from_py_with = argument)] vary: Bound<'py, PyDict>,
    minimise: Option<Bound<'py, PyAny>>,
    maximise: Option<Bound<'py, PyAny>>,
    #[pyo3(from_py_with = argument)] designs: u64,
    #[pyo3(from_py_with = count)] starts: usize,
    #[pyo3(from_py_with = argument)] evaluations: u64,
    #[pyo3(from_py_with = argument)] seed: u64,
    #[pyo3(from_py_with = argument)] samples: Option<u64>,
    #[pyo3(from_py_with = argument)] over: Option<Bound<'py, PyDict>>,
    q: Option<Coordinates<'py>>,
    configurations: Option<Bound<'py, PyAny>>,
    #[pyo3(from_py_with = argument)] frame: Option<&str>,
    tool: Option<Numbers<'py>>,
    #[pyo3(from_py_with = argument)] task: Option<&str>,
    #[pyo3(from_py_with = argument)] metric: &str,
    #[pyo3(from_py_with = argument)] length: Option<f64>,
    #[pyo3(from_py_with = argument)] threads: Option<usize>,
    #[pyo3(from_py_with = argument)] relative_to: Option<&str>,
) -> Result<PyOptimalDesigns> {
    let robot = &*mechanism;
    let mechanism = robot.inner.clone();
    let chosen = Chosen {
        samples,
        seed,
        over: over.as_ref(),
        q: q.as_ref(),
        configurations,
        designs: true,
        reach: None,
        poses: None,
        task: None,
    };
    let (source, workspace) = chosen.source(robot)?;
    let objectives = [
        objectives("minimise", minimise.as_ref(), Sense::Minimise)?,
        objectives("maximise", maximise.as_ref(), Sense::Maximise)?,
    ];
    let named = frame.is_some() || tool.is_some();
    let end_effector = if named { Some(robot.end_effector(frame, tool.as_ref())?) } else { None };
    let options = OptimisationOptions {
        ranges: ranges(&vary)?,
        objectives: objectives.concat(),
        workspace,
        designs,
        starts,
        evaluations,
        seed,
        sweep: SweepOptions {
            source,
            end_effector,
            relative_to: relative_to.map(|name| mechanism.frame(name)).transpose()?,
            task: task.map(|name| Task::named(name, &mechanism)).transpose()?,
            metric: VelocityMetric::named(metric)?,
            length,
            ..SweepOptions::default()
        },
    };
    let threads = count_of(threads)?;
    let search = Optimisation::new(&robot.parametric()?, options)?;
    let mut raised = None;
    let found = py.detach(|| search.run(threads, |_| go_on(&mut raised)));
    if let Some(error) = raised {
        return Err(error.into());
    }
    let Some(found) = found? else {
        return Err(pyo3::exceptions::PyKeyboardInterrupt::new_err(()).into());
    };
    Ok(PyOptimalDesigns { found })
}

/// One name or several.
fn objectives(
    name: &str,
    given: Option<&Bound<'_, PyAny>>,
    sense: Sense,
) -> Result<Vec<DesignObjective>> {
    let Some(given) = given else { return Ok(Vec::new()) };
    let names = match given.extract::<String>() {
        Ok(one) => vec![one],
        Err(_) => entry::<Vec<String>>(name, given)?,
    };
    Ok(names
        .iter()
        .map(|name| DesignObjective::named(name, sense))
        .collect::<cylindroid::Result<_>>()?)
}
