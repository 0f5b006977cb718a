//! Force closure of grasps.

use cylindroid::Vec3;
use cylindroid::closure::{
    self, ContactProperties, EpsilonQuality, FingerContact, Friction, GraspMetric, GraspQuality,
    WrenchSpace, grasp_contacts,
};
use cylindroid::model::ContactCurvature;
use pyo3::prelude::*;

use super::curvature::Curvature;
use crate::arrays::{self, Array, Numbers};
use crate::coordinates::Coordinates;
use crate::error::{Result, argument};
use crate::mechanism::PyMechanism;
use crate::options;
use crate::table;

/// A finger on an object.
///
/// Parameters
/// ----------
/// point : array_like, (3,)
///     The point of contact (m).
/// normal : array_like, (3,)
///     Unit normal into the object: the direction in which the finger pushes.
/// mu : float
///     Coefficient of friction; 0 for a contact without friction.
/// torsion : float
///     Largest moment about the normal over the normal force (m); 0 for a hard finger.
/// strength : float
///     Largest normal force (N), for the metric 'linf'.
/// finger_curvature, object_curvature : float, or (principal, direction)
///     Curvature of each body at the point (1/m), for `grasp_mobility`: positive for a convex body,
///     negative for a concave one, `inf` for a sharp point; or two principal curvatures and the
///     direction of the first. Default: a sharp finger on a flat face.
#[pyclass(frozen, name = "FingerContact", module = "cylindroid")]
#[derive(Debug, Clone, Copy)]
pub(crate) struct PyFingerContact {
    pub(crate) inner: FingerContact,
}

#[pymethods]
impl PyFingerContact {
    #[new]
    #[pyo3(signature = (point, normal, mu = 0.0, torsion = 0.0, strength = 1.0,
        finger_curvature = Curvature::Uniform(f64::INFINITY),
        object_curvature = Curvature::Uniform(0.0)))]
    #[expect(clippy::needless_pass_by_value, reason = "arguments of Python are values")]
    fn new(
        point: Numbers<'_>,
        normal: Numbers<'_>,
        #[pyo3(from_py_with = argument)] mu: f64,
        #[pyo3(from_py_with = argument)] torsion: f64,
        #[pyo3(from_py_with = argument)] strength: f64,
        #[pyo3(from_py_with = argument)] finger_curvature: Curvature,
        #[pyo3(from_py_with = argument)] object_curvature: Curvature,
    ) -> Result<Self> {
        let friction = match (mu, torsion) {
            (0.0, 0.0) => Friction::None,
            (mu, 0.0) => Friction::Hard { mu },
            (mu, torsion) => Friction::Soft { mu, torsion },
        };
        let inner = FingerContact {
            point: Vec3::from_array(point.entries("point")?),
            normal: Vec3::from_array(normal.entries("normal")?),
            friction,
            strength,
            curvature: ContactCurvature {
                finger: finger_curvature.surface(),
                object: object_curvature.surface(),
            },
        };
        Ok(Self { inner })
    }

    fn __repr__(&self) -> String {
        format!(
            "FingerContact(point={}, normal={}, {:?})",
            table::list(&self.inner.point.to_array()),
            table::list(&self.inner.normal.to_array()),
            self.inner.friction
        )
    }
}

/// Force closure and quality of a grasp.
///
/// Attributes
/// ----------
/// closed : bool
///     True if every wrench can be resisted with enough effort.
/// epsilon : (float, float)
///     Bounds of the least wrench, in its worst direction, that exceeds the effort.
/// weakest : ndarray, (d,)
///     The least resisted direction, moments over the length.
#[pyclass(frozen, name = "GraspQuality", module = "cylindroid")]
#[derive(Debug)]
pub(crate) struct PyGraspQuality {
    inner: GraspQuality,
}

#[pymethods]
impl PyGraspQuality {
    #[getter]
    fn closed(&self) -> bool {
        self.inner.closed
    }

    #[getter]
    fn epsilon(&self) -> (f64, f64) {
        (self.inner.epsilon.lower, self.inner.epsilon.upper)
    }

    #[getter]
    fn weakest<'py>(&self, py: Python<'py>) -> Array<'py> {
        arrays::vector(py, &self.inner.weakest)
    }

    fn __repr__(&self) -> String {
        let EpsilonQuality { lower, upper } = self.inner.epsilon;
        format!(
            "<GraspQuality: {}, epsilon {} to {}>",
            if self.inner.closed { "force closure" } else { "no force closure" },
            table::number(lower),
            table::number(upper)
        )
    }
}

/// The quality of a grasp by fingers with friction: force closure and epsilon.
///
/// Parameters
/// ----------
/// contacts : list of FingerContact
/// point : array_like, (3,), optional
///     The point about which moments are taken (m). Default: the origin.
/// length : float
///     Characteristic length that divides moments (m).
/// planar : bool
///     True for objects in the plane x-y.
/// metric : str
///     'l1' (Q1: the normal forces of all fingers sum to 1) or 'linf' (Q-infinity: each normal force
///     is at most the finger's strength).
///
/// Returns
/// -------
/// GraspQuality
///
/// Raises
/// ------
/// InvalidOptionError, NotFiniteError, UnknownNameError
///
/// Notes
/// -----
/// Ferrari and Canny 1992; round cones, not pyramids.
///
/// Examples
/// --------
/// Two fingers press a disc between them:
///
/// >>> import cylindroid as cy
/// >>> left = cy.FingerContact([-1, 0, 0], [1, 0, 0], mu=0.5)
/// >>> right = cy.FingerContact([1, 0, 0], [-1, 0, 0], mu=0.5)
/// >>> cy.grasp_quality([left, right], planar=True).closed
/// True
#[pyfunction]
#[pyo3(signature = (contacts, point = None, length = 1.0, planar = false, metric = "l1"))]
pub(crate) fn grasp_quality(
    py: Python<'_>,
    #[pyo3(from_py_with = argument)] contacts: Vec<PyRef<'_, PyFingerContact>>,
    point: Option<Numbers<'_>>,
    #[pyo3(from_py_with = argument)] length: f64,
    #[pyo3(from_py_with = argument)] planar: bool,
    #[pyo3(from_py_with = argument)] metric: &str,
) -> Result<PyGraspQuality> {
    let metric = metric_of(metric)?;
    let point = match &point {
        None => Vec3::ZERO,
        Some(point) => Vec3::from_array(point.entries("point")?),
    };
    let contacts: Vec<FingerContact> = contacts.iter().map(|c| c.inner).collect();
    let space = WrenchSpace { point, length, planar };
    let inner = py.detach(|| closure::grasp_quality(&contacts, space, metric))?;
    Ok(PyGraspQuality { inner })
}

fn metric_of(name: &str) -> Result<GraspMetric> {
    options::named("metric", name, &[("l1", GraspMetric::L1), ("linf", GraspMetric::LInf)])
}

#[pymethods]
impl PyMechanism {
    /// The quality of the grasp by the contacts that the mechanism file names on an object.
    ///
    /// Parameters
    /// ----------
    /// q : array_like, (n,), optional
    ///     Default: home.
    /// reference : str, optional
    ///     A frame of the object. Default: the reference.
    /// mu, torsion : float, optional
    ///     Coefficient of friction, and largest moment about the normal over the normal force (m),
    ///     in place of those of the file.
    /// strength : float
    ///     Largest normal force of each finger (N), for the metric 'linf'.
    /// metric : str
    ///     'l1' or 'linf', as in the function `grasp_quality`.
    ///
    /// Returns
    /// -------
    /// GraspQuality
    ///
    /// Raises
    /// ------
    /// DimensionError, NotFiniteError, UnknownNameError
    /// InvalidOptionError
    ///     Also for contacts other than points, and for missing coefficients.
    #[pyo3(signature = (q = None, reference = None, mu = None, torsion = None, strength = 1.0,
        metric = "l1"))]
    #[expect(clippy::too_many_arguments, reason = "they have names in Python")]
    fn grasp_quality(
        &self,
        py: Python<'_>,
        q: Option<Coordinates<'_>>,
        #[pyo3(from_py_with = argument)] reference: Option<&str>,
        #[pyo3(from_py_with = argument)] mu: Option<f64>,
        #[pyo3(from_py_with = argument)] torsion: Option<f64>,
        #[pyo3(from_py_with = argument)] strength: f64,
        #[pyo3(from_py_with = argument)] metric: &str,
    ) -> Result<PyGraspQuality> {
        let m = &self.inner;
        let state = m.state(self.or_home("q", q.as_ref())?)?;
        let object = reference.map_or(Ok(m.reference()), |name| m.frame(name))?;
        let metric = metric_of(metric)?;
        let fingers =
            grasp_contacts(&state, object, |_| ContactProperties { mu, torsion, strength })?;
        let fingers: Vec<FingerContact> = fingers.into_iter().map(|(_, finger)| finger).collect();
        let space = WrenchSpace::about(&state, object, &fingers)?;
        let inner = py.detach(|| closure::grasp_quality(&fingers, space, metric))?;
        Ok(PyGraspQuality { inner })
    }
}
