//! Singularity-free zones: the largest ball or box around a configuration.

use cylindroid::sweep::{Zone, ZoneOptions, ZoneShape};
use numpy::IntoPyArray;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyList};

use crate::arrays::Numbers;
use crate::coordinates::Coordinates;
use crate::error::{Result, argument, count};
use crate::mechanism::PyMechanism;
use crate::workspace_map::{held, of_start, start};

/// A ball or box without singularities.
///
/// Attributes
/// ----------
/// shape : str
///     'ball' or 'box'.
/// size : float
///     Radius of the ball, or half the side of the box, in multiples of the scales.
/// centre, scales : dict of str to float
///     The components in the centre and their scales (m or rad).
/// held : dict of str to float
///     Components of the pose that keep a value (m or rad).
/// bounds : list of dict
///     Singularities and limits nearest to the centre among their neighbours, the nearest first: 'kind'
///     ('type I', 'type II', 'passive' or 'limit'), 'limit' (the coordinate or None), 'distance' (in
///     multiples of the scales), 'point' (the components) and 'q' (the configuration). Empty if nothing
///     was met up to half a turn or four characteristic lengths.
/// confirmed, certified : int
///     Rays from the centre of this length that met nothing, and those on each step of which the
///     Jacobians change by less than their smallest singular values: none vanishes if they change
///     linearly within a step.
/// q : ndarray, (n,)
///     The configuration in the centre.
#[pyclass(frozen, module = "cylindroid", name = "Zone")]
#[derive(Debug)]
pub(crate) struct PyZone {
    zone: Zone,
}

#[pymethods]
impl PyZone {
    #[getter]
    fn shape(&self) -> &'static str {
        self.zone.shape.name()
    }

    #[getter]
    fn size(&self) -> f64 {
        self.zone.size
    }

    #[getter]
    fn centre<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let all = self.zone.components.iter().map(|c| (c.name.as_str(), c.centre));
        named(py, &all.collect::<Vec<_>>())
    }

    #[getter]
    fn scales<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let all = self.zone.components.iter().map(|c| (c.name.as_str(), c.scale));
        named(py, &all.collect::<Vec<_>>())
    }

    #[getter]
    fn held<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let all = self.zone.held.iter().map(|(name, value)| (name.as_str(), *value));
        named(py, &all.collect::<Vec<_>>())
    }

    #[getter]
    fn bounds<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyList>> {
        let bounds = PyList::empty(py);
        for bound in &self.zone.bounds {
            let dict = PyDict::new(py);
            dict.set_item("kind", bound.kind.name())?;
            dict.set_item("limit", bound.limit.as_deref())?;
            dict.set_item("distance", bound.distance)?;
            dict.set_item("point", bound.point.clone().into_pyarray(py))?;
            dict.set_item("q", bound.q.clone().into_pyarray(py))?;
            bounds.append(dict)?;
        }
        Ok(bounds)
    }

    #[getter]
    fn confirmed(&self) -> usize {
        self.zone.confirmed
    }

    #[getter]
    fn certified(&self) -> usize {
        self.zone.certified
    }

    #[getter]
    fn q<'py>(&self, py: Python<'py>) -> Bound<'py, numpy::PyArray1<f64>> {
        self.zone.q.clone().into_pyarray(py)
    }

    fn __repr__(&self) -> String {
        let names: Vec<&str> = self.zone.components.iter().map(|c| c.name.as_str()).collect();
        let (shape, size) = (self.zone.shape.name(), self.zone.size);
        let bound = self.zone.bounds.first().map_or("nothing", |bound| bound.kind.name());
        format!("Zone({shape} over {}: {size:.6}, bounded by {bound})", names.join(", "))
    }
}

fn named<'py>(py: Python<'py>, values: &[(&str, f64)]) -> PyResult<Bound<'py, PyDict>> {
    let dict = PyDict::new(py);
    for (name, value) in values {
        dict.set_item(name, value)?;
    }
    Ok(dict)
}

/// The largest ball or box around a configuration without singularities, in components of the
/// platform's pose or in coordinates of actuated joints.
///
/// Rays from the centre follow the mode of `q` to the first singularity or position limit; from there
/// the nearest point is found by descent on the locus, to rounding. The smallest distance is the size:
/// nothing larger is free. That nothing is nearer is checked only along rays.
///
/// Parameters
/// ----------
/// mechanism : Mechanism
/// components : sequence of str
///     Of 'x', 'y', 'z', 'roll', 'pitch', 'yaw' (`R = Rz(yaw) Ry(pitch) Rx(roll)`), in the plane 'x',
///     'y', 'rz'; or names of actuated joints.
/// shape : str
///     'ball', or 'box' with sides along the components.
/// scales : sequence of float, optional
///     The lengths of the ball's axes, or half the sides of the box, for a size of 1 (m or rad).
///     Default: 1; of lengths beside angles the characteristic length.
/// at : dict of str to float, optional
///     Values of components in the centre [m or rad], of the zone or others; other components as for
///     `workspace_map`.
/// free : sequence of str, optional
///     Components of the pose that may have any value.
/// frame : str, optional
///     The platform. Default: the reference of a closed chain, otherwise the tool.
/// tool : array_like, (4, 4), optional
///     `frame_from_tool`, a tool point fixed to the frame.
/// q : array_like, (n,), optional
///     The configuration in the centre. Default: home.
/// limits : bool
///     Position limits are bounds too.
/// rays : int
///     Number of rays beside those along the components. Of one component those are all.
/// seed : int
///     Selects other rays.
///
/// Returns
/// -------
/// Zone
///
/// Raises
/// ------
/// InvalidOptionError, UnknownNameError, DimensionError, NotFiniteError
///
/// Examples
/// --------
/// >>> import cylindroid as cy
/// >>> cy.singularity_free_zone(cy.load("3r"), ["joint2", "joint3"], rays=32)
/// Zone(ball over joint2, joint3: 1.000000, bounded by type I)
#[pyfunction]
#[pyo3(signature = (mechanism, components, shape = "ball", scales = None, at = None, free = None,
    frame = None, tool = None, q = None, limits = true, rays = 256, seed = 0))]
#[expect(clippy::too_many_arguments, reason = "they have names in Python")]
pub(crate) fn singularity_free_zone<'py>(
    py: Python<'py>,
    #[pyo3(from_py_with = argument)] mechanism: PyRef<'py, PyMechanism>,
    #[pyo3(from_py_with = argument)] components: Vec<String>,
    #[pyo3(from_py_with = argument)] shape: &str,
    #[pyo3(from_py_with = argument)] scales: Option<Vec<f64>>,
    #[pyo3(from_py_with = argument)] at: Option<Bound<'py, PyDict>>,
    #[pyo3(from_py_with = argument)] free: Option<Vec<String>>,
    #[pyo3(from_py_with = argument)] frame: Option<&str>,
    tool: Option<Numbers<'py>>,
    q: Option<Coordinates<'py>>,
    #[pyo3(from_py_with = argument)] limits: bool,
    #[pyo3(from_py_with = count)] rays: usize,
    #[pyo3(from_py_with = argument)] seed: u64,
) -> Result<PyZone> {
    let robot = &*mechanism;
    let mechanism = robot.inner.clone();
    let options = ZoneOptions {
        components,
        scales: scales.unwrap_or_default(),
        shape: ZoneShape::named(shape)?,
        held: held(at.as_ref(), free)?,
        end_effector: Some(robot.reference_or_tool(frame, tool.as_ref())?),
        start: start(q.as_ref(), &mechanism)?,
        limits,
        rays,
        seed,
    };
    let zone = py.detach(|| Zone::of(&mechanism, options)).map_err(of_start)?;
    Ok(PyZone { zone })
}
