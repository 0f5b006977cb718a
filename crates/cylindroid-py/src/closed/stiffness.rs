//! The classes `Stiffness` and `Deflection`: elastic joints, contacts and links.

use cylindroid::manipulability::{Deflection, Stiffness};
use cylindroid::model::{ElasticBody, ElasticElement, ElasticKind, Elasticity, Mechanism};
use cylindroid::screws::Eigenscrew;
use cylindroid::{Error, Matrix};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use super::PyTransmittedWrench;
use super::object::object;
use crate::arrays::{self, Array, Many, Numbers};
use crate::coordinates::{Coordinates, Rows};
use crate::error::{Result, argument, entry};
use crate::mechanism::PyMechanism;
use crate::screws::PyScrew;
use crate::table;

/// The stiffness of a mechanism at its reference frame.
///
/// Twists and wrenches are taken at the origin of the reference frame, in world axes, linear part
/// first; d is 6, in the plane 3.
///
/// Attributes
/// ----------
/// matrix : ndarray, (d, d), or None
///     K, the wrench for a small displacement; None if some direction is rigid.
/// compliance : ndarray, (d, d), or None
///     C, the small displacement for a wrench; None if some motion is free.
/// cholesky : ndarray, (d, d), or None
///     Lower triangular L with `K = L @ L.T`.
/// eigenscrews : list of (float, Screw), or None
///     Solutions of `K s = x D s` with the matrix D of the screw inner product (Patterson and
///     Lipkin): eigenvalue x [N/rad], the force for a rotation by 1 rad, and screw in the world. If
///     K is positive definite, three are positive and three negative. None in the plane, and where
///     K is None.
/// free : ndarray, (n, d)
///     Twists without deflection, as rows.
/// rigid : ndarray, (n, d)
///     Wrenches that deflect nothing, as rows.
/// undetermined : int
///     Forces in loops and contacts that neither equilibrium nor elasticity determines.
#[pyclass(frozen, name = "Stiffness", module = "cylindroid")]
#[derive(Debug)]
pub(crate) struct PyStiffness {
    inner: Stiffness,
}

/// The deflection of a mechanism under a wrench.
///
/// Attributes
/// ----------
/// twist : ndarray, (d,)
///     Small displacement of the reference frame (m, rad).
/// unbalanced : ndarray, (d,)
///     The part of the wrench that a free motion gives way to; the deflection is that of the rest.
/// parts : list of (str, ndarray)
///     Of the elastic parts: of each coordinate of a joint, or the twist in the frame of a
///     compliance.
/// torques : ndarray, (a,)
///     Of the actuated joints [N m or N].
/// forces : list of TransmittedWrench
///     Of each loop joint and contact.
/// energy : float
///     Elastic energy (J).
#[pyclass(frozen, name = "Deflection", module = "cylindroid")]
#[derive(Debug)]
pub(crate) struct PyDeflection {
    inner: Deflection,
}

#[pymethods]
impl PyStiffness {
    #[getter]
    fn matrix<'py>(&self, py: Python<'py>) -> Result<Option<Array<'py>>> {
        self.inner.stiffness.as_ref().map(|k| arrays::matrix(py, k)).transpose()
    }

    #[getter]
    fn compliance<'py>(&self, py: Python<'py>) -> Result<Option<Array<'py>>> {
        self.inner.compliance.as_ref().map(|c| arrays::matrix(py, c)).transpose()
    }

    #[getter]
    fn cholesky<'py>(&self, py: Python<'py>) -> Result<Option<Array<'py>>> {
        self.inner.cholesky().as_ref().map(|l| arrays::matrix(py, l)).transpose()
    }

    #[getter]
    fn eigenscrews(&self) -> Option<Vec<(f64, PyScrew)>> {
        let all = self.inner.eigenscrews()?;
        let one = |e: &Eigenscrew| Some((e.eigenvalue, PyScrew::from(&e.screw()?)));
        Some(all.screws.iter().filter_map(one).collect())
    }

    #[getter]
    fn free<'py>(&self, py: Python<'py>) -> Result<Array<'py>> {
        arrays::columns(py, &self.inner.free)
    }

    #[getter]
    fn rigid<'py>(&self, py: Python<'py>) -> Result<Array<'py>> {
        arrays::columns(py, &self.inner.rigid)
    }

    #[getter]
    fn undetermined(&self) -> usize {
        self.inner.undetermined
    }

    /// The stiffness matrix at another point and in other axes.
    ///
    /// Parameters
    /// ----------
    /// frame : array_like, (4, 4)
    ///     Pose in the world of a frame fixed to the body of the reference frame.
    ///
    /// Returns
    /// -------
    /// ndarray, (d, d), or None
    #[pyo3(signature = (frame))]
    fn at<'py>(&self, py: Python<'py>, frame: Numbers<'py>) -> Result<Option<Array<'py>>> {
        let found = self.inner.at(frame.pose("frame")?);
        found.as_ref().map(|k| arrays::matrix(py, k)).transpose()
    }

    /// The compliance matrix at another point and in other axes, as `at`.
    ///
    /// Parameters
    /// ----------
    /// frame : array_like, (4, 4)
    ///
    /// Returns
    /// -------
    /// ndarray, (d, d), or None
    #[pyo3(signature = (frame))]
    fn compliance_at<'py>(
        &self,
        py: Python<'py>,
        frame: Numbers<'py>,
    ) -> Result<Option<Array<'py>>> {
        let found = self.inner.compliance_at(frame.pose("frame")?);
        found.as_ref().map(|c| arrays::matrix(py, c)).transpose()
    }

    /// The deflection under an external wrench on the reference frame.
    ///
    /// Parameters
    /// ----------
    /// wrench : array_like, (d,)
    ///     At the origin of the frame, world axes, force first.
    ///
    /// Returns
    /// -------
    /// Deflection
    #[pyo3(signature = (wrench))]
    fn deflection(&self, py: Python<'_>, wrench: Numbers<'_>) -> Result<PyDeflection> {
        let wrench = wrench.vector("wrench")?;
        Ok(PyDeflection { inner: py.detach(|| self.inner.deflection(wrench))? })
    }

    fn __repr__(&self) -> String {
        let (free, rigid) = (self.inner.free.cols(), self.inner.rigid.cols());
        format!("<stiffness: {free} free motions, {rigid} rigid wrenches>")
    }
}

#[pymethods]
impl PyDeflection {
    #[getter]
    fn twist<'py>(&self, py: Python<'py>) -> Array<'py> {
        arrays::vector(py, &self.inner.twist)
    }

    #[getter]
    fn unbalanced<'py>(&self, py: Python<'py>) -> Array<'py> {
        arrays::vector(py, &self.inner.unbalanced)
    }

    #[getter]
    fn parts<'py>(&self, py: Python<'py>) -> Vec<(String, Array<'py>)> {
        let all = self.inner.parts.iter();
        all.map(|p| (p.name.clone(), arrays::vector(py, &p.deflection))).collect()
    }

    #[getter]
    fn torques<'py>(&self, py: Python<'py>) -> Array<'py> {
        arrays::vector(py, &self.inner.torques)
    }

    #[getter]
    fn forces(&self) -> Vec<PyTransmittedWrench> {
        self.inner.forces.iter().map(|w| PyTransmittedWrench { inner: w.clone() }).collect()
    }

    #[getter]
    fn energy(&self) -> f64 {
        self.inner.energy
    }

    fn __repr__(&self) -> String {
        format!("Deflection(twist={})", table::list(&self.inner.twist))
    }
}

/// The elasticity of the file with what a call adds.
fn elasticity(
    mechanism: &Mechanism,
    stiffness: Option<&Bound<'_, PyAny>>,
    compliance: Option<&Bound<'_, PyDict>>,
) -> Result<Elasticity> {
    let mut elasticity = mechanism.elasticity().clone();
    match stiffness {
        None => {}
        Some(given) if given.is_instance_of::<PyDict>() => {
            for (name, k) in entry::<Bound<'_, PyDict>>("stiffness", given)? {
                let name: String = entry("stiffness", &name)?;
                elasticity.stiffness(&name, entry("stiffness", &k)?);
            }
        }
        Some(given) => {
            let k: f64 = entry("stiffness", given)?;
            let tree = mechanism.coordinates().iter().filter(|c| c.actuated).map(|c| &c.name);
            let loops = mechanism.loops().iter().filter(|l| l.actuated).map(|l| &l.name);
            for name in tree.chain(loops) {
                elasticity.stiffness(name, k);
            }
        }
    }
    let Some(compliance) = compliance else { return Ok(elasticity) };
    let d = mechanism.dimension().freedoms();
    for (name, given) in compliance {
        let name: String = entry("compliance", &name)?;
        let (matrix, frame) = match given.extract::<(Numbers<'_>, Numbers<'_>)>() {
            Ok((matrix, frame)) => (matrix, Some(frame)),
            Err(_) => (entry("compliance", &given)?, None),
        };
        let compliance = match matrix.shape() {
            [n] if *n == d => Matrix::diagonal(matrix.vector("compliance")?),
            _ => matrix.matrix("compliance")?,
        };
        let closings = mechanism.loops().iter().map(|l| &l.name);
        let closings = closings.chain(mechanism.contacts().iter().map(|c| &c.name));
        let joints: Vec<&String> =
            mechanism.joints().iter().map(|j| &j.name).chain(closings).collect();
        let links: Vec<&String> = mechanism.links().iter().map(|l| &l.name).collect();
        let of_joint = joints.contains(&&name);
        if !of_joint && !links.contains(&&name) {
            let known = joints.into_iter().chain(links);
            return Err(Error::unknown("joint, contact or link", &name, known).into());
        }
        let carrier = if of_joint { first_link(mechanism, &name) } else { name.clone() };
        let frame = match frame {
            None => None,
            Some(pose) => Some((carrier, pose.pose("frame of a compliance")?)),
        };
        let body = ElasticBody { compliance, frame };
        let kind = if of_joint { ElasticKind::Joint(body) } else { ElasticKind::Link(body) };
        elasticity.elements.push(ElasticElement { name, kind });
    }
    Ok(elasticity)
}

/// The parent link of a joint, the first link of a loop joint or contact.
fn first_link(mechanism: &Mechanism, name: &str) -> String {
    let tree = mechanism.joints().iter().find(|j| j.name == name).map(|j| j.parent);
    let closing = || mechanism.loops().iter().find(|l| l.name == name).map(|l| l.a);
    let contact = || mechanism.contacts().iter().find(|c| c.name == name).map(|c| c.a);
    let link = tree.or_else(closing).or_else(contact).unwrap_or(0);
    mechanism.links()[link].name.clone()
}

#[pymethods]
impl PyMechanism {
    /// The stiffness of the reference frame with elastic joints, contacts and links.
    ///
    /// Actuated joints without a stiffness are locked, passive ones give way. What the file makes
    /// elastic (`[[elasticity]]`) is elastic too.
    ///
    /// Parameters
    /// ----------
    /// q, actuated, reference, length
    ///     As for `constraint`.
    /// stiffness : float or dict of str to float, optional
    ///     Along the motion of joints [N m/rad or N/m]: of all actuated joints, or by name.
    /// compliance : dict, optional
    ///     By name of a joint, contact or link: a matrix (d, d) or its diagonal (linear part first,
    ///     m/N, rad/(N m)), in the frame of the joint or link; or a pair of it and a pose (4, 4) on
    ///     the link (for joints: on the parent link, for loop joints and contacts on the first).
    ///
    /// Returns
    /// -------
    /// Stiffness, or list of Stiffness
    ///
    /// Raises
    /// ------
    /// DimensionError, NotFiniteError, UnknownNameError, InvalidOptionError, ModelError
    ///
    /// Notes
    /// -----
    /// With elastic actuators alone, the stiffness of a parallel manipulator is `J.T @ k @ J`
    /// (Gosselin 1990), J from twists to joint velocities.
    ///
    /// Examples
    /// --------
    /// >>> import cylindroid as cy
    /// >>> k = cy.load("stewart").stiffness(stiffness=2e7)
    /// >>> k.matrix.shape, k.undetermined
    /// ((6, 6), 0)
    #[pyo3(signature = (q = None, actuated = None, reference = None, length = None,
        stiffness = None, compliance = None))]
    #[expect(clippy::too_many_arguments, reason = "they have names in Python")]
    fn stiffness<'py>(
        &self,
        py: Python<'py>,
        q: Option<Coordinates<'py>>,
        #[pyo3(from_py_with = argument)] actuated: Option<Vec<String>>,
        #[pyo3(from_py_with = argument)] reference: Option<&str>,
        #[pyo3(from_py_with = argument)] length: Option<f64>,
        #[pyo3(from_py_with = argument)] stiffness: Option<Bound<'py, PyAny>>,
        #[pyo3(from_py_with = argument)] compliance: Option<Bound<'py, PyDict>>,
    ) -> Result<Bound<'py, PyAny>> {
        let actuated = actuated.map(|names| self.inner.with_actuated(&names)).transpose()?;
        let mechanism = actuated.as_ref().unwrap_or(&self.inner);
        let elasticity = elasticity(mechanism, stiffness.as_ref(), compliance.as_ref())?;
        let frame = reference.map(|name| mechanism.frame(name)).transpose()?;
        let one = |q: &[f64]| -> Result<PyStiffness> {
            let inner = Stiffness::of(&mechanism.state(q)?, frame, length, &elasticity)?;
            Ok(PyStiffness { inner })
        };
        let Some(q) = &q else {
            return Ok(object(py, Many::One(py.detach(|| one(mechanism.home()))?))?);
        };
        let rows = Rows::of(mechanism, "q", q)?;
        let all = py.detach(|| -> Result<Many<PyStiffness>> {
            Ok(match rows.count {
                None => Many::One(one(rows.row(0))?),
                Some(n) => Many::All((0..n).map(|i| one(rows.row(i))).collect::<Result<_>>()?),
            })
        })?;
        Ok(object(py, all)?)
    }
}
