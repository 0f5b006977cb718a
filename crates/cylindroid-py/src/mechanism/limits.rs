//! Limits of the coordinates.

use pyo3::prelude::*;

use super::{Origin, PyMechanism};
use crate::arrays::{self, Array};
use crate::coordinates::Coordinates;
use crate::error::Result;
use crate::options;

impl PyMechanism {
    fn limits<'py>(
        &self,
        py: Python<'py>,
        of: impl Fn(&cylindroid::model::Limits) -> f64,
    ) -> Array<'py> {
        let all: Vec<f64> = self.inner.coordinates().iter().map(|c| of(&c.limits)).collect();
        arrays::vector(py, &all)
    }
}

#[pymethods]
impl PyMechanism {
    #[getter]
    fn lower<'py>(&self, py: Python<'py>) -> Array<'py> {
        self.limits(py, |l| l.lower)
    }

    #[getter]
    fn upper<'py>(&self, py: Python<'py>) -> Array<'py> {
        self.limits(py, |l| l.upper)
    }

    #[getter]
    fn velocity_limit<'py>(&self, py: Python<'py>) -> Array<'py> {
        self.limits(py, |l| l.velocity)
    }

    #[getter]
    fn acceleration_limit<'py>(&self, py: Python<'py>) -> Array<'py> {
        self.limits(py, |l| l.acceleration)
    }

    #[getter]
    fn jerk_limit<'py>(&self, py: Python<'py>) -> Array<'py> {
        self.limits(py, |l| l.jerk)
    }

    #[getter]
    fn effort_limit<'py>(&self, py: Python<'py>) -> Array<'py> {
        self.limits(py, |l| l.effort)
    }

    /// The same mechanism with other limits of some joints.
    ///
    /// Parameters
    /// ----------
    /// limits : dict of str to dict of str to float
    ///     For each joint, coordinate or loop joint the limits that replace those of the model:
    ///     'lower' and 'upper' (narrower than in the model), 'velocity', 'acceleration', 'jerk',
    ///     'effort' [rad or m, /s, /s^2, /s^3, N m or N].
    ///
    /// Returns
    /// -------
    /// Mechanism
    ///
    /// Raises
    /// ------
    /// UnknownNameError
    ///     For an unknown joint or limit, with the nearest names.
    /// InvalidOptionError
    ///     For positions beyond those of the model, contradictory limits, a joint that is fixed or
    ///     follows another.
    ///
    /// Examples
    /// --------
    /// >>> import cylindroid as cy
    /// >>> robot = cy.load("ur5e").with_limits({"elbow_joint": {"acceleration": 5.0}})
    /// >>> float(robot.acceleration_limit[2])
    /// 5.0
    #[pyo3(signature = (limits))]
    fn with_limits(&self, limits: &Bound<'_, PyAny>) -> Result<Self> {
        let limits = options::limits(limits)?;
        let inner = self.inner.with_limits(&limits)?;
        Ok(Self::new(inner, Origin::Limited { of: Box::new(self.clone()), limits }))
    }

    /// The names of coordinates outside their position limits.
    ///
    /// Parameters
    /// ----------
    /// q : array_like, (n,)
    ///
    /// Returns
    /// -------
    /// list of str
    ///
    /// Raises
    /// ------
    /// DimensionError, NotFiniteError
    #[pyo3(signature = (q))]
    fn outside_limits(&self, q: Coordinates<'_>) -> Result<Vec<&str>> {
        let q = q.vector(&self.inner, "q")?;
        self.inner.check_q("q", q)?;
        let outside = self.inner.outside_limits(q);
        Ok(outside.map(|i| self.inner.coordinates()[i].name.as_str()).collect())
    }
}
