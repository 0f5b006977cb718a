//! Mobility of grasped objects to second order.

use cylindroid::Vec3;
use cylindroid::closure::{
    self, ContactProperties, FingerContact, GraspMobility, WrenchSpace, grasp_contacts,
};
use pyo3::prelude::*;

use super::grasp::PyFingerContact;
use crate::arrays::{self, Array, Numbers};
use crate::coordinates::Coordinates;
use crate::error::{Result, argument};
use crate::mechanism::PyMechanism;

/// Mobility of an object between fixed frictionless fingers, to second order.
///
/// Attributes
/// ----------
/// immobilisation : str
///     "immobile to first order" (form closure), "immobile to second order" (by curvature),
///     "mobile", "undecided: higher order" or "undecided: not proved".
/// immobile : bool or None
///     None if undecided.
/// explanation : str
///     The reason of the verdict.
/// first_order_mobility : int
///     Dimension of the cone of first-order free motions.
/// second_order_mobility : int or None
///     Number of eigenvalues of the relative curvature form that are not negative; None without
///     equilibrium.
/// equilibria : ndarray, (k, r)
///     Extreme equilibrium forces as columns: normal forces of the k contacts that sum to 1.
/// forces : ndarray, (k,)
///     Equilibrium forces of the form: the mean of the extreme ones, or, if their form is not
///     negative definite and others block all free motions, the first that do on the way to the
///     form with the least largest eigenvalue; empty without equilibrium.
/// free_motions : ndarray, (d, m)
///     Principal free motions as columns: twists at `point` in world axes.
/// curvatures : ndarray, (m,)
///     The eigenvalue of the form for each free motion (1/m), largest first; empty without
///     equilibrium.
/// escape : (ndarray, ndarray) or None
///     Velocity and acceleration, twists, of a motion that opens all gaps of a mobile object: it is
///     displaced by exp(t velocity + t^2/2 acceleration).
/// ambiguous : bool
///     True if the rank of the contact normals is numerically ambiguous.
#[pyclass(frozen, name = "GraspMobility", module = "cylindroid")]
#[derive(Debug)]
pub(crate) struct PyGraspMobility {
    inner: GraspMobility,
}

#[pymethods]
impl PyGraspMobility {
    #[getter]
    fn immobilisation(&self) -> &'static str {
        self.inner.immobilisation.name()
    }

    #[getter]
    fn immobile(&self) -> Option<bool> {
        self.inner.immobilisation.is_immobile()
    }

    #[getter]
    fn explanation(&self) -> &'static str {
        self.inner.immobilisation.explanation()
    }

    #[getter]
    fn first_order_mobility(&self) -> usize {
        self.inner.first_order_mobility
    }

    #[getter]
    fn second_order_mobility(&self) -> Option<usize> {
        self.inner.second_order_mobility
    }

    #[getter]
    fn equilibria<'py>(&self, py: Python<'py>) -> Result<Array<'py>> {
        arrays::matrix(py, &self.inner.equilibria)
    }

    #[getter]
    fn forces<'py>(&self, py: Python<'py>) -> Array<'py> {
        arrays::vector(py, &self.inner.forces)
    }

    #[getter]
    fn free_motions<'py>(&self, py: Python<'py>) -> Result<Array<'py>> {
        arrays::matrix(py, &self.inner.free_motions)
    }

    #[getter]
    fn curvatures<'py>(&self, py: Python<'py>) -> Array<'py> {
        arrays::vector(py, &self.inner.curvatures)
    }

    #[getter]
    fn escape<'py>(&self, py: Python<'py>) -> Option<(Array<'py>, Array<'py>)> {
        let escape = self.inner.escape.as_ref()?;
        Some((arrays::vector(py, &escape.velocity), arrays::vector(py, &escape.acceleration)))
    }

    #[getter]
    fn ambiguous(&self) -> bool {
        self.inner.ambiguous
    }

    fn __repr__(&self) -> String {
        let first = self.inner.first_order_mobility;
        let second = self.inner.second_order_mobility;
        let second = second.map_or_else(|| "none".to_owned(), |m| m.to_string());
        format!(
            "<GraspMobility: {}, first-order mobility {first}, second-order {second}>",
            self.inner.immobilisation
        )
    }
}

/// The mobility of an object between fixed frictionless fingers: first order, and second order by
/// the curvatures of both bodies.
///
/// Parameters
/// ----------
/// contacts : list of FingerContact
///     Their curvatures count; friction and strength do not.
/// point : array_like, (3,), optional
///     The point at which twists are taken (m). Default: the origin.
/// planar : bool
///     True for objects in the plane x-y.
///
/// Returns
/// -------
/// GraspMobility
///
/// Raises
/// ------
/// InvalidOptionError, NotFiniteError
///
/// Notes
/// -----
/// Rimon and Burdick 1998. A definite form is a proof of immobilisation, an escape one of mobility.
///
/// Examples
/// --------
/// Three sharp fingers at the midpoints of the edges of an equilateral triangle:
///
/// >>> import cylindroid as cy
/// >>> import numpy as np
/// >>> out = [np.array([np.cos(a), np.sin(a), 0]) for a in np.radians([30, 150, 270])]
/// >>> cy.grasp_mobility([cy.FingerContact(p, -p) for p in out], planar=True).immobilisation
/// 'immobile to second order'
#[pyfunction]
#[pyo3(signature = (contacts, point = None, planar = false))]
pub(crate) fn grasp_mobility(
    py: Python<'_>,
    #[pyo3(from_py_with = argument)] contacts: Vec<PyRef<'_, PyFingerContact>>,
    point: Option<Numbers<'_>>,
    #[pyo3(from_py_with = argument)] planar: bool,
) -> Result<PyGraspMobility> {
    let point = match &point {
        None => Vec3::ZERO,
        Some(point) => Vec3::from_array(point.entries("point")?),
    };
    let contacts: Vec<FingerContact> = contacts.iter().map(|c| c.inner).collect();
    let space = WrenchSpace { point, length: 1.0, planar };
    let inner = py.detach(|| closure::grasp_mobility(&contacts, space))?;
    Ok(PyGraspMobility { inner })
}

#[pymethods]
impl PyMechanism {
    /// The mobility of an object between the contacts that the mechanism file names on it, with
    /// fixed fingers and without friction.
    ///
    /// Parameters
    /// ----------
    /// q : array_like, (n,), optional
    ///     Default: home.
    /// reference : str, optional
    ///     A frame of the object, at whose origin twists are taken. Default: the reference.
    ///
    /// Returns
    /// -------
    /// GraspMobility
    ///
    /// Raises
    /// ------
    /// DimensionError, NotFiniteError, UnknownNameError
    /// InvalidOptionError
    ///     Also for contacts other than points.
    #[pyo3(signature = (q = None, reference = None))]
    fn grasp_mobility(
        &self,
        py: Python<'_>,
        q: Option<Coordinates<'_>>,
        #[pyo3(from_py_with = argument)] reference: Option<&str>,
    ) -> Result<PyGraspMobility> {
        let m = &self.inner;
        let state = m.state(self.or_home("q", q.as_ref())?)?;
        let object = reference.map_or(Ok(m.reference()), |name| m.frame(name))?;
        // Friction does not count.
        let properties = ContactProperties { mu: Some(0.0), torsion: Some(0.0), strength: 1.0 };
        let fingers = grasp_contacts(&state, object, |_| properties)?;
        let fingers: Vec<FingerContact> = fingers.into_iter().map(|(_, finger)| finger).collect();
        let space = WrenchSpace::about(&state, object, &fingers)?;
        let inner = py.detach(|| closure::grasp_mobility(&fingers, space))?;
        Ok(PyGraspMobility { inner })
    }
}
