//! Maps: the workspace in the coordinates of the platform, with singularity loci.

use cylindroid::sweep::{Locus, LocusKind, Map, MapOptions, Surface, WorkingMode};
use cylindroid::{Error, Mechanism};
use numpy::{IntoPyArray, PyArrayMethods};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyList};

use crate::arrays::{self, Numbers};
use crate::coordinates::Coordinates;
use crate::error::{Result, argument, count, entry};
use crate::mechanism::PyMechanism;
use crate::sweep::{axes, count_of, go_on};

/// The workspace of a mechanism over components of its platform's pose.
///
/// Attributes
/// ----------
/// axes : dict of str to (float, float, int)
///     First and last value and the number of values of each axis; the last one changes fastest.
/// held : dict of str to float
///     Components that keep a value (m or rad).
/// free_motions : int
///     Motions that axes and held components leave: with some, modes are not distinguished,
///     configurations are one of many, and there are no loci.
/// signed : tuple of bool
///     Whether the distances to singularities of type I and II have a sign.
/// modes : list of dict of str to ndarray, (N,)
///     The working modes. Columns with a number for each cell, NaN where the mode does not reach it:
///     the axes, the coordinates by name, 'type_one' and 'type_two' (smallest generic over largest
///     singular value of the loops, the platform or the actuated joints at rest), 'limit_distance'.
/// size_unit : str
///     The unit of sizes of regions, such as 'm^2': of the axes with several values.
/// loci : list of dict
///     Curves, for two axes: 'kind' ('type I', 'type II', 'passive' or 'limit'), 'limit' (the
///     coordinate or None), 'modes' (indices), 'closed', 'points' (values of the axes, (K, 2)) and 'q'
///     (configurations, (K, n)).
/// surfaces : list of dict
///     Singularities of type II, for three axes: 'kind' ('type II' or 'passive', at most of the
///     vertices), 'mode' (an index), 'closed' (each side of a triangle is one of another), 'vertices'
///     (values of the axes, (K, 3)), 'triangles' (indices of vertices, (T, 3), counterclockwise as
///     seen from where 'type_two' is positive) and 'q' (configurations, (K, n)).
#[pyclass(frozen, module = "cylindroid", name = "WorkspaceMap")]
#[derive(Debug)]
pub(crate) struct PyWorkspaceMap {
    map: Map,
    names: Vec<String>,
}

#[pymethods]
impl PyWorkspaceMap {
    #[getter]
    fn axes<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let axes = PyDict::new(py);
        for axis in &self.map.axes {
            axes.set_item(&axis.name, (axis.from, axis.to, axis.count))?;
        }
        Ok(axes)
    }

    #[getter]
    fn held<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let held = PyDict::new(py);
        for (name, value) in &self.map.held {
            held.set_item(name, value)?;
        }
        Ok(held)
    }

    #[getter]
    fn free_motions(&self) -> usize {
        self.map.free_motions
    }

    #[getter]
    fn signed(&self) -> (bool, bool) {
        (self.map.signed[0], self.map.signed[1])
    }

    #[getter]
    fn modes<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyList>> {
        let modes = self.map.modes.iter().map(|mode| self.columns(py, mode));
        PyList::new(py, modes.collect::<PyResult<Vec<_>>>()?)
    }

    #[getter]
    fn loci<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyList>> {
        let loci = self.map.loci.iter().map(|locus| self.locus(py, locus));
        PyList::new(py, loci.collect::<PyResult<Vec<_>>>()?)
    }

    #[getter]
    fn surfaces<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyList>> {
        let surfaces = self.map.surfaces.iter().map(|surface| self.surface(py, surface));
        PyList::new(py, surfaces.collect::<PyResult<Vec<_>>>()?)
    }

    #[getter]
    fn size_unit(&self) -> String {
        self.map.size_unit()
    }

    /// What the modes reach together, or one of them: its size, and its holes.
    ///
    /// To the resolution of the grid: a hole is a set of cells that are not reached, connected along the
    /// axes and across, none of them at the border of the grid.
    ///
    /// Parameters
    /// ----------
    /// mode : int, optional
    ///     One of `modes`, from 0. Default: all together.
    ///
    /// Returns
    /// -------
    /// dict
    ///     'cells', 'size' (in `size_unit`), 'is_cut' (True if it ends at the border of the grid) and
    ///     'holes', the largest first: dicts of 'cells', 'size' and 'center' (a value for each axis).
    ///
    /// Raises
    /// ------
    /// InvalidOptionError
    ///     For a mode that there is not.
    ///
    /// Examples
    /// --------
    /// >>> import cylindroid as cy
    /// >>> found = cy.workspace_map(cy.load("five-bar"), {"x": (-1, 3.5, 46), "y": (-2.6, 2.6, 53)})
    /// >>> [hole["center"].round(1).tolist() for hole in found.workspace()["holes"]]
    /// [[2.0, 0.0]]
    #[pyo3(signature = (mode = None))]
    fn workspace<'py>(
        &self,
        py: Python<'py>,
        #[pyo3(from_py_with = argument)] mode: Option<usize>,
    ) -> Result<Bound<'py, PyDict>> {
        let region = match mode {
            None => self.map.workspace(),
            Some(mode) => self.map.workspace_of(mode)?,
        };
        let holes = region.holes.into_iter().map(|hole| {
            let dict = PyDict::new(py);
            dict.set_item("cells", hole.cells)?;
            dict.set_item("size", hole.size)?;
            dict.set_item("center", hole.center.into_pyarray(py))?;
            PyResult::Ok(dict)
        });
        let dict = PyDict::new(py);
        dict.set_item("cells", region.cells)?;
        dict.set_item("size", region.size)?;
        dict.set_item("is_cut", region.is_cut)?;
        dict.set_item("holes", PyList::new(py, holes.collect::<PyResult<Vec<_>>>()?)?)?;
        Ok(dict)
    }

    /// The sections of the surfaces of a mode with the plane of the cells at a place along the third axis.
    ///
    /// They separate the cells of both signs of 'type_two'.
    ///
    /// Parameters
    /// ----------
    /// mode : int
    ///     One of `modes`, from 0.
    /// place : int
    ///     The number of the value on the third axis, from 0.
    ///
    /// Returns
    /// -------
    /// dict of str to ndarray, (S, 2, 2)
    ///     For each kind the segments: the values of the first two axes at both ends.
    ///
    /// Raises
    /// ------
    /// InvalidOptionError
    ///     For a mode or a place that there is not.
    fn section<'py>(
        &self,
        py: Python<'py>,
        #[pyo3(from_py_with = argument)] mode: usize,
        #[pyo3(from_py_with = argument)] place: usize,
    ) -> Result<Bound<'py, PyDict>> {
        let segments = self.map.section(mode, place as u64)?;
        let dict = PyDict::new(py);
        for kind in LocusKind::ALL {
            let own = segments.iter().filter(|segment| segment.0 == kind);
            let ends: Vec<f64> = own.flat_map(|segment| segment.1).flatten().collect();
            if !ends.is_empty() {
                let count = ends.len() / 4;
                dict.set_item(kind.name(), ends.into_pyarray(py).reshape([count, 2, 2])?)?;
            }
        }
        Ok(dict)
    }

    fn __repr__(&self) -> String {
        let names: Vec<&str> = self.map.axes.iter().map(|a| a.name.as_str()).collect();
        let modes = self.map.modes.len();
        let loci = match names.len() {
            3 => format!("{} surfaces", self.map.surfaces.len()),
            _ => format!("{} loci", self.map.loci.len()),
        };
        format!("WorkspaceMap(over {}, {modes} modes, {loci})", names.join(", "))
    }
}

impl PyWorkspaceMap {
    fn columns<'py>(&self, py: Python<'py>, mode: &WorkingMode) -> PyResult<Bound<'py, PyDict>> {
        let columns = PyDict::new(py);
        let values: Vec<Vec<f64>> = (0..self.map.cells()).map(|c| self.map.values(c)).collect();
        for (k, axis) in self.map.axes.iter().enumerate() {
            let column: Vec<f64> = values.iter().map(|v| v[k]).collect();
            columns.set_item(&axis.name, column.into_pyarray(py))?;
        }
        let n = self.names.len();
        for (i, name) in self.names.iter().enumerate() {
            let column: Vec<f64> = mode.q.iter().skip(i).step_by(n.max(1)).copied().collect();
            columns.set_item(name, column.into_pyarray(py))?;
        }
        let measures = [
            ("type_one", &mode.type_one),
            ("type_two", &mode.type_two),
            ("limit_distance", &mode.limit_distance),
        ];
        for (name, values) in measures {
            columns.set_item(name, values.clone().into_pyarray(py))?;
        }
        Ok(columns)
    }

    fn locus<'py>(&self, py: Python<'py>, locus: &Locus) -> PyResult<Bound<'py, PyDict>> {
        let dict = PyDict::new(py);
        let rows = |rows: &[Vec<f64>], width: usize| {
            arrays::rows(py, Some(rows.len()), width, rows.iter()).map_err(PyErr::from)
        };
        dict.set_item("kind", locus.kind.name())?;
        dict.set_item("limit", locus.limit.as_deref())?;
        dict.set_item("modes", locus.modes.clone())?;
        dict.set_item("closed", locus.closed)?;
        dict.set_item("points", rows(&locus.points, self.map.axes.len())?)?;
        dict.set_item("q", rows(&locus.q, self.names.len())?)?;
        Ok(dict)
    }

    fn surface<'py>(&self, py: Python<'py>, surface: &Surface) -> PyResult<Bound<'py, PyDict>> {
        let dict = PyDict::new(py);
        let count = surface.vertices.len();
        let vertices = arrays::rows(py, Some(count), 3, surface.vertices.iter())?;
        let q = arrays::rows(py, Some(count), self.names.len(), surface.q.iter())?;
        let triangles: Vec<usize> = surface.triangles.iter().flatten().copied().collect();
        let triangles = triangles.into_pyarray(py).reshape([surface.triangles.len(), 3])?;
        dict.set_item("kind", surface.kind.name())?;
        dict.set_item("mode", surface.mode)?;
        dict.set_item("closed", surface.closed)?;
        dict.set_item("vertices", vertices)?;
        dict.set_item("triangles", triangles)?;
        dict.set_item("q", q)?;
        Ok(dict)
    }
}

/// The workspace of an arm or a parallel robot over components of its platform's pose, for each
/// working mode, with the loci of its singularities.
///
/// Every working mode is followed from cell to cell by steps that pass no singularity of type I.
/// Points of the loci are refined by Newton's method and followed by predictor and corrector.
///
/// Parameters
/// ----------
/// mechanism : Mechanism
/// over : dict of str to (float, float, int)
///     One to three axes: first and last value [m or rad] and number of values of 'x', 'y', 'z',
///     'roll', 'pitch', 'yaw' (`R = Rz(yaw) Ry(pitch) Rx(roll)`); in the plane 'x', 'y', 'rz'. The last
///     one changes fastest.
/// at : dict of str to float, optional
///     Values of other components [m or rad]. Components that are not named keep their value at `q` as
///     far as the mechanism has freedoms for them, and follow otherwise.
/// free : sequence of str, optional
///     Components that may have any value.
/// frame : str, optional
///     The platform. Default: the reference of a closed chain, otherwise the tool.
/// tool : array_like, (4, 4), optional
///     `frame_from_tool`, a tool point fixed to the frame.
/// q : array_like, (n,), optional
///     A configuration in the workspace. Default: home.
/// starts : int
///     Random restarts that look for working modes at the start; others look in other cells.
/// seed : int
///     Selects other random restarts.
/// loci : bool
///     Follow the curves, for two axes, or find the surfaces, for three.
/// threads : int, optional
///     Default: as many as the machine has. The map does not depend on it.
///
/// Returns
/// -------
/// WorkspaceMap
///
/// Raises
/// ------
/// InvalidOptionError, UnknownNameError, DimensionError, NotFiniteError
///
/// Examples
/// --------
/// >>> import cylindroid as cy
/// >>> five_bar = cy.load("five-bar")
/// >>> found = cy.workspace_map(five_bar, {"x": (-1, 3, 17), "y": (0, 3, 13)})
/// >>> len(found.modes), found.modes[0]["q1"].shape
/// (4, (221,))
#[pyfunction]
#[pyo3(signature = (mechanism, over, at = None, free = None, frame = None, tool = None, q = None,
    starts = 64, seed = 0, loci = true, threads = None))]
#[expect(clippy::too_many_arguments, reason = "they have names in Python")]
pub(crate) fn workspace_map<'py>(
    py: Python<'py>,
    #[pyo3(from_py_with = argument)] mechanism: PyRef<'py, PyMechanism>,
    #[pyo3(from_py_with = argument)] over: Bound<'py, PyDict>,
    #[pyo3(from_py_with = argument)] at: Option<Bound<'py, PyDict>>,
    #[pyo3(from_py_with = argument)] free: Option<Vec<String>>,
    #[pyo3(from_py_with = argument)] frame: Option<&str>,
    tool: Option<Numbers<'py>>,
    q: Option<Coordinates<'py>>,
    #[pyo3(from_py_with = count)] starts: usize,
    #[pyo3(from_py_with = argument)] seed: u64,
    #[pyo3(from_py_with = argument)] loci: bool,
    #[pyo3(from_py_with = argument)] threads: Option<usize>,
) -> Result<PyWorkspaceMap> {
    let robot = &*mechanism;
    let mechanism = robot.inner.clone();
    let options = MapOptions {
        axes: axes(&over)?,
        held: held(at.as_ref(), free)?,
        end_effector: Some(robot.reference_or_tool(frame, tool.as_ref())?),
        start: start(q.as_ref(), &mechanism)?,
        starts,
        seed,
        loci,
    };
    let threads = count_of(threads)?;
    let mut raised = None;
    let found = py.detach(|| Map::run(&mechanism, options, threads, |_| go_on(&mut raised)));
    if let Some(error) = raised {
        return Err(error.into());
    }
    let Some(map) = found.map_err(of_start)? else {
        return Err(pyo3::exceptions::PyKeyboardInterrupt::new_err(()).into());
    };
    let names = mechanism.coordinates().iter().map(|c| c.name.clone()).collect();
    Ok(PyWorkspaceMap { map, names })
}

/// The components that are held, and those that are free.
pub(crate) fn held(
    at: Option<&Bound<'_, PyDict>>,
    free: Option<Vec<String>>,
) -> Result<Vec<(String, Option<f64>)>> {
    let mut held = Vec::new();
    for (name, value) in at.iter().flat_map(|at| at.iter()) {
        held.push((entry("at", &name)?, Some(entry("at", &value)?)));
    }
    held.extend(free.unwrap_or_default().into_iter().map(|name| (name, None)));
    Ok(held)
}

/// The configuration to start at, which is called `q`.
pub(crate) fn start(
    q: Option<&Coordinates<'_>>,
    mechanism: &Mechanism,
) -> Result<Option<Vec<f64>>> {
    let Some(q) = q else { return Ok(None) };
    let start = q.vector(mechanism, "q")?;
    mechanism.check_q("q", start)?;
    Ok(Some(start.to_vec()))
}

/// An error about the start, named as the argument.
pub(crate) fn of_start(error: Error) -> Error {
    match error {
        Error::InvalidOption { option: "start", value, reason } => {
            Error::InvalidOption { option: "q", value, reason }
        }
        other => other,
    }
}
