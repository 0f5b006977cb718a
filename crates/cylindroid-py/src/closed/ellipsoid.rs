//! The class `Ellipsoid`: an ellipsoid of velocities or forces seen in some components.

use cylindroid::Error;
use cylindroid::manipulability::{Ellipsoid, EllipsoidView};
use pyo3::prelude::*;

use super::PySpectrum;
use crate::arrays::{self, Array};
use crate::error::{Result, argument, entry};
use crate::table;

/// The velocities (forces) for inputs of norm at most one, seen in some components.
///
/// Attributes
/// ----------
/// semi_axes : ndarray, (d, k)
///     Principal semi-axes as columns, longest first; fewer than components if it is flat.
/// unbounded : ndarray, (i, d)
///     Directions without bound, as rows.
/// components : list of str
/// others : list of str
///     The components that are not seen: free in a projection, zero in a section.
/// view : str
///     'projection' or 'section'.
/// quantity : str
///     'velocity' or 'force'.
#[pyclass(frozen, name = "Ellipsoid", module = "cylindroid")]
#[derive(Debug)]
pub(crate) struct PyEllipsoid {
    inner: Ellipsoid,
    names: [Vec<String>; 2],
    view: EllipsoidView,
    quantity: &'static str,
}

#[pymethods]
impl PyEllipsoid {
    #[getter]
    fn semi_axes<'py>(&self, py: Python<'py>) -> Result<Array<'py>> {
        arrays::matrix(py, &self.inner.semi_axes)
    }

    #[getter]
    fn unbounded<'py>(&self, py: Python<'py>) -> Result<Array<'py>> {
        arrays::columns(py, &self.inner.unbounded)
    }

    #[getter]
    fn components(&self) -> Vec<String> {
        self.names[0].clone()
    }

    #[getter]
    fn others(&self) -> Vec<String> {
        self.names[1].clone()
    }

    #[getter]
    fn view(&self) -> &'static str {
        self.view.name()
    }

    #[getter]
    fn quantity(&self) -> &'static str {
        self.quantity
    }

    fn __repr__(&self) -> String {
        let axes = &self.inner.semi_axes;
        let size = |j: usize| axes.column(j).iter().map(|x| x * x).sum::<f64>().sqrt();
        let sizes: Vec<f64> = (0..axes.cols()).map(size).collect();
        format!(
            "<Ellipsoid of {} in {} ({}): semi-axes {}, {} unbounded>",
            self.quantity,
            table::names(&self.names[0]),
            self.view.name(),
            table::list(&sizes),
            self.inner.unbounded.cols()
        )
    }
}

#[pymethods]
impl PySpectrum {
    /// The ellipsoid of velocities (forces) for joint velocities (torques) of norm one, seen in
    /// some of the components.
    ///
    /// Parameters
    /// ----------
    /// components : str or list of str, optional
    ///     As of a task: 'x,y'. Default: all.
    /// view : str
    ///     'projection' (the other components are free) or 'section' (the others are zero).
    ///
    /// Returns
    /// -------
    /// Ellipsoid
    ///
    /// Raises
    /// ------
    /// UnknownNameError
    ///     For an unknown component or view.
    ///
    /// Examples
    /// --------
    /// >>> import cylindroid as cy
    /// >>> k = cy.load("five-bar").manipulability().kinematic
    /// >>> k.ellipsoid("x,y")
    /// <Ellipsoid of velocity in x, y (projection): semi-axes [2.28825, 0.87403], 0 unbounded>
    /// >>> k.ellipsoid("x,y", view="section").semi_axes.shape
    /// (2, 1)
    #[pyo3(signature = (components = None, view = "projection"))]
    fn ellipsoid(
        &self,
        components: Option<&Bound<'_, PyAny>>,
        #[pyo3(from_py_with = argument)] view: &str,
    ) -> Result<PyEllipsoid> {
        let Some(&view) = EllipsoidView::ALL.iter().find(|v| v.name() == view) else {
            let known = EllipsoidView::ALL.map(EllipsoidView::name);
            return Err(Error::unknown("view", view, known).into());
        };
        let chosen = match components {
            None => self.components.clone(),
            Some(given) => match given.extract::<String>() {
                Ok(text) => text.split(',').map(|s| s.trim().to_owned()).collect(),
                Err(_) => entry::<Vec<String>>("components", given)?,
            },
        };
        let place = |name: &String| {
            let found = self.components.iter().position(|c| c == name);
            found.ok_or_else(|| Error::unknown("component", name, &self.components))
        };
        let places = chosen.iter().map(place).collect::<cylindroid::Result<Vec<usize>>>()?;
        let others = self.components.iter().filter(|c| !chosen.contains(c)).cloned().collect();
        Ok(PyEllipsoid {
            inner: Ellipsoid::of(&self.inner).seen(view, &places)?,
            names: [chosen, others],
            view,
            quantity: self.quantity(),
        })
    }
}
