//! The class `Screw`.

use cylindroid::screws::Screw;
use cylindroid::{Error, Twist};
use pyo3::prelude::*;

use crate::arrays::{self, Array, Numbers};
use crate::error::{Failure, Result};
use crate::table;

/// A line with a pitch and an amplitude: a twist in the words of geometry.
///
/// Parameters
/// ----------
/// twist : array_like, (6,)
///     Linear part first, not zero [m/s, rad/s].
///
/// Attributes
/// ----------
/// point : ndarray, (3,)
///     The point of the axis nearest to the origin (m); zero for a translation.
/// direction : ndarray, (3,)
///     Unit vector.
/// pitch : float
///     Advance by angle [m/rad]; infinite for a translation.
/// amplitude : float
///     [rad/s], of a translation [m/s].
/// twist : ndarray, (6,)
/// is_translation : bool
///
/// Raises
/// ------
/// NotFiniteError, DimensionError
/// InvalidOptionError
///     For the zero twist, which has no axis.
///
/// Examples
/// --------
/// >>> import cylindroid as cy
/// >>> cy.Screw([0, -1, 0.1, 0, 0, 1])
/// Screw(point=[1, 0, 0], direction=[0, 0, 1], pitch=0.1, amplitude=1)
#[pyclass(frozen, name = "Screw", module = "cylindroid")]
#[derive(Debug, Clone)]
pub(crate) struct PyScrew {
    inner: Screw,
}

impl From<&Screw> for PyScrew {
    fn from(screw: &Screw) -> Self {
        Self { inner: *screw }
    }
}

pub(crate) fn screw_list(screws: &[Screw]) -> Vec<PyScrew> {
    screws.iter().map(PyScrew::from).collect()
}

#[pymethods]
impl PyScrew {
    #[new]
    #[pyo3(signature = (twist))]
    fn new(twist: Numbers<'_>) -> Result<Self> {
        let entries = twist.entries::<6>("twist")?;
        Error::check_finite("twist", &entries)?;
        match Screw::of(Twist::from_array(entries)) {
            Some(inner) => Ok(Self { inner }),
            None => Err(Failure::option("twist", table::list(&entries), "it has no axis")),
        }
    }

    #[getter]
    fn point<'py>(&self, py: Python<'py>) -> Array<'py> {
        arrays::vector(py, &self.inner.axis.point.to_array())
    }

    #[getter]
    fn direction<'py>(&self, py: Python<'py>) -> Array<'py> {
        arrays::vector(py, &self.inner.axis.direction.to_array())
    }

    #[getter]
    fn pitch(&self) -> f64 {
        self.inner.pitch
    }

    #[getter]
    fn amplitude(&self) -> f64 {
        self.inner.amplitude
    }

    #[getter]
    fn twist<'py>(&self, py: Python<'py>) -> Array<'py> {
        arrays::vector(py, &self.inner.twist().to_array())
    }

    #[getter]
    fn is_translation(&self) -> bool {
        self.inner.is_translation()
    }

    fn __repr__(&self) -> String {
        format!(
            "Screw(point={}, direction={}, pitch={}, amplitude={})",
            table::list(&self.inner.axis.point.to_array()),
            table::list(&self.inner.axis.direction.to_array()),
            table::number(self.inner.pitch),
            table::number(self.inner.amplitude)
        )
    }
}
