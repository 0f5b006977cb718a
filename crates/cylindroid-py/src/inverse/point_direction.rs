//! All joint velocities that move a point along a line.

use cylindroid::inverse::point_direction as all_rates;
use cylindroid::{Error, Matrix, Vec3};
use pyo3::prelude::*;

use crate::arrays::{self, Array, Numbers, entries_of};
use crate::error::Result;
use crate::table;

/// The joint velocities that move a point along a line.
///
/// Attributes
/// ----------
/// along : ndarray, (m,), or None
///     The smallest joint velocities that move the point at 1 m/s along the direction; None if
///     none do.
/// still : ndarray, (m, d)
///     Joint velocities that keep the point at rest: an orthonormal basis.
#[pyclass(frozen, name = "PointDirection", module = "cylindroid")]
#[derive(Debug)]
pub(crate) struct PyPointDirection {
    along: Option<Vec<f64>>,
    still: Matrix,
}

#[pymethods]
impl PyPointDirection {
    #[getter]
    fn along<'py>(&self, py: Python<'py>) -> Option<Array<'py>> {
        self.along.as_ref().map(|a| arrays::vector(py, a))
    }

    #[getter]
    fn still<'py>(&self, py: Python<'py>) -> Result<Array<'py>> {
        arrays::matrix(py, &self.still)
    }

    fn __repr__(&self) -> String {
        let along = self.along.as_ref().map_or_else(|| "None".to_owned(), |a| table::list(a));
        format!("PointDirection(along={along}, still of {} rates)", self.still.cols())
    }
}

/// All joint velocities that move a point of the end effector along a direction.
///
/// Parameters
/// ----------
/// J : array_like, (6, m)
///     Twists as columns, linear part first.
/// point : array_like, (3,)
///     In the frame of J (m).
/// direction : array_like, (3,)
///     Of any length but zero.
///
/// Returns
/// -------
/// PointDirection
///
/// Raises
/// ------
/// DimensionError, NotFiniteError, InvalidOptionError
#[pyfunction]
#[pyo3(signature = (J, point, direction))]
#[expect(non_snake_case, reason = "the field's name")]
pub(crate) fn point_direction(
    J: Numbers<'_>,
    point: Numbers<'_>,
    direction: Numbers<'_>,
) -> Result<PyPointDirection> {
    let (point, direction) = (point.entries("point")?, direction.entries("direction")?);
    Error::check_finite("direction", &direction)?;
    Error::check_finite("point", &point)?;
    let twists = J.twist_columns("J")?;
    let found = all_rates(&twists, Vec3::from_array(point), Vec3::from_array(direction))
        .map_err(|error| entries_of("J", error))?;
    Ok(PyPointDirection { along: found.along, still: found.still })
}
