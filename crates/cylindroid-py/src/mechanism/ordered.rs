//! Configurations in the order of the coordinates, and with their names.

use pyo3::prelude::*;

use super::PyMechanism;
use crate::arrays::{self, Array};
use crate::columns::{self, PyColumns};
use crate::coordinates::{Coordinates, Rows};
use crate::error::Result;

#[pymethods]
impl PyMechanism {
    /// Configurations as an array, in the order of `joint_names`.
    ///
    /// Parameters
    /// ----------
    /// q : array_like, (n,) or (N, n), or columns with names
    ///     A dict, a frame or row of pandas, a frame of polars, a table of pyarrow or whatever else
    ///     hands out Arrow tables is read by its names, in any order: those of the coordinates, or
    ///     'q.' before them. Other columns are ignored.
    ///
    /// Returns
    /// -------
    /// ndarray, (n,) or (N, n)
    ///     A new array [rad or m].
    ///
    /// Raises
    /// ------
    /// InvalidOptionError
    ///     For a coordinate without a column, with the columns that are no coordinates.
    /// DimensionError, NotFiniteError
    ///
    /// Notes
    /// -----
    /// Every `q` of the package is read so.
    ///
    /// Examples
    /// --------
    /// >>> import cylindroid as cy
    /// >>> arm = cy.load("3r")
    /// >>> a, b, c = arm.joint_names
    /// >>> arm.ordered({c: 3.0, b: 2.0, a: 1.0})
    /// array([1., 2., 3.])
    #[pyo3(signature = (q))]
    fn ordered<'py>(&self, py: Python<'py>, q: Coordinates<'py>) -> Result<Array<'py>> {
        let rows = Rows::of(&self.inner, "q", &q)?;
        arrays::written(py, rows.count, &[rows.width], |out| out.copy_from_slice(rows.values))
    }

    /// Configurations as columns with the names of the coordinates, for libraries of frames: the
    /// reverse of `ordered`.
    ///
    /// Parameters
    /// ----------
    /// q : array_like, (n,) or (N, n)
    ///     Coordinates in the order of `joint_names` [rad or m].
    ///
    /// Returns
    /// -------
    /// Columns
    ///     A column for each coordinate; one row for one configuration.
    ///
    /// Raises
    /// ------
    /// DimensionError, NotFiniteError
    ///
    /// Examples
    /// --------
    /// >>> import cylindroid as cy
    /// >>> arm = cy.load("3r")
    /// >>> columns = arm.columns([[1.0, 2.0, 3.0], [4.0, 5.0, 6.0]])
    /// >>> columns
    /// <Columns of 2 rows: joint1, joint2, joint3>
    /// >>> columns["joint2"]
    /// array([2., 5.])
    #[pyo3(signature = (q))]
    fn columns(&self, q: Coordinates<'_>) -> Result<PyColumns> {
        let rows = Rows::of(&self.inner, "q", &q)?;
        let about = self.inner.coordinates().iter().map(|c| (c.name.clone(), c.kind.unit()));
        PyColumns::of(
            columns::transposed(rows.values, rows.width, about).collect(),
            rows.count.unwrap_or(1),
        )
    }
}
