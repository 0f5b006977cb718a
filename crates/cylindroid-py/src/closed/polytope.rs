//! The class `Polytope`: velocity and force polytopes within the limits of the actuated joints.

use cylindroid::linalg::{Hull, Interval};
use cylindroid::manipulability::{Polytope, force_polytope, velocity_polytope};
use pyo3::prelude::*;

use super::PyConstraint;
use super::metrics::limits;
use crate::arrays::{self, Array, Numbers};
use crate::error::Result;

/// A velocity or force polytope: all twists or wrenches within the limits of the actuated joints.
///
/// Attributes
/// ----------
/// vertices : ndarray, (V, d)
/// facets : list of list of int
///     Simplices of the boundary, as indices of vertices.
/// normals : ndarray, (F, d)
///     Outward unit normals of the facets.
/// offsets : ndarray, (F,)
///     Points x of the polytope satisfy `normals @ x <= offsets`.
/// span : ndarray, (d, k)
///     An orthonormal basis of the space spanned by the polytope.
/// unbounded : ndarray, (d, k)
///     A basis of the unbounded directions.
/// complete : bool
///     False if the computation was stopped at the maximum number of facets.
#[pyclass(frozen, name = "Polytope", module = "cylindroid")]
#[derive(Debug)]
pub(crate) struct PyPolytope {
    inner: Polytope,
    dimension: usize,
}

impl PyPolytope {
    pub(super) fn of(
        py: Python<'_>,
        constraint: &PyConstraint,
        given: Option<&Numbers<'_>>,
        task: Option<&Bound<'_, PyAny>>,
        force: bool,
    ) -> Result<Self> {
        let symmetric = |all: &[f64]| all.iter().map(|l| Interval::symmetric(*l)).collect();
        let limits: Vec<Interval> = match given {
            None => symmetric(&limits(constraint, force)?),
            Some(given) => match given.values().as_chunks().0 {
                pairs if given.shape() == [pairs.len(), 2] => pairs
                    .iter()
                    .map(|[lower, upper]| Interval { lower: *lower, upper: *upper })
                    .collect(),
                _ => symmetric(given.vector("limits")?),
            },
        };
        let map = task.map(|task| constraint.task(task)).transpose()?.map(|(map, _)| map);
        py.detach(|| {
            let relation = constraint.relation(map.as_ref())?;
            let inner = match force {
                true => force_polytope(&relation, &limits)?,
                false => velocity_polytope(&relation, &limits)?,
            };
            Ok(Self { inner, dimension: relation.object() })
        })
    }

    fn hull(&self) -> &Hull {
        &self.inner.hull
    }
}

#[pymethods]
impl PyPolytope {
    #[getter]
    fn vertices<'py>(&self, py: Python<'py>) -> Result<Array<'py>> {
        let all = &self.hull().vertices;
        arrays::rows(py, Some(all.len()), self.dimension, all.iter())
    }

    #[getter]
    fn facets(&self) -> Vec<Vec<usize>> {
        self.hull().facets.iter().map(|f| f.vertices.clone()).collect()
    }

    #[getter]
    fn normals<'py>(&self, py: Python<'py>) -> Result<Array<'py>> {
        let all = &self.hull().facets;
        arrays::rows(py, Some(all.len()), self.dimension, all.iter().map(|f| &f.normal))
    }

    #[getter]
    fn offsets<'py>(&self, py: Python<'py>) -> Array<'py> {
        let all: Vec<f64> = self.hull().facets.iter().map(|f| f.offset).collect();
        arrays::vector(py, &all)
    }

    #[getter]
    fn span<'py>(&self, py: Python<'py>) -> Result<Array<'py>> {
        arrays::matrix(py, &self.hull().span)
    }

    #[getter]
    fn unbounded<'py>(&self, py: Python<'py>) -> Result<Array<'py>> {
        arrays::matrix(py, &self.inner.unbounded)
    }

    #[getter]
    fn complete(&self) -> bool {
        self.hull().complete
    }

    fn __repr__(&self) -> String {
        format!(
            "<Polytope of {} vertices, {} facets, {} directions without limit>",
            self.hull().vertices.len(),
            self.hull().facets.len(),
            self.inner.unbounded.cols()
        )
    }
}

#[pymethods]
impl PyConstraint {
    /// Velocity polytope: all twists of the object within the velocity limits of the actuated
    /// joints.
    ///
    /// Parameters
    /// ----------
    /// limits : array_like, (a,) or (a, 2), optional
    ///     Velocity limits [rad/s or m/s], or intervals that contain zero. Default: those of the
    ///     mechanism.
    /// task : str, list of str or array_like, (k, d), optional
    ///     Components of the twist, or a linear map of it; more than three give many facets.
    ///
    /// Returns
    /// -------
    /// Polytope
    ///
    /// Raises
    /// ------
    /// DimensionError, UnknownNameError
    /// InvalidOptionError
    ///     For missing limits, and intervals that do not contain zero.
    #[pyo3(signature = (limits = None, task = None))]
    fn velocity_polytope(
        &self,
        py: Python<'_>,
        limits: Option<Numbers<'_>>,
        task: Option<Bound<'_, PyAny>>,
    ) -> Result<PyPolytope> {
        PyPolytope::of(py, self, limits.as_ref(), task.as_ref(), false)
    }

    /// Force polytope: all wrenches on the object balanced by torques of the actuated joints within
    /// their limits.
    ///
    /// Parameters
    /// ----------
    /// limits : array_like, (a,) or (a, 2), optional
    ///     Torque limits [N m or N], or intervals that contain zero. Default: those of the
    ///     mechanism.
    /// task : str, list of str or array_like, (k, d), optional
    ///     As for `velocity_polytope`.
    ///
    /// Returns
    /// -------
    /// Polytope
    ///
    /// Raises
    /// ------
    /// DimensionError, UnknownNameError, InvalidOptionError
    ///     As for `velocity_polytope`.
    #[pyo3(signature = (limits = None, task = None))]
    fn force_polytope(
        &self,
        py: Python<'_>,
        limits: Option<Numbers<'_>>,
        task: Option<Bound<'_, PyAny>>,
    ) -> Result<PyPolytope> {
        PyPolytope::of(py, self, limits.as_ref(), task.as_ref(), true)
    }
}
