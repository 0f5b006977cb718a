//! The classes `Limb`, `Transmission` and `ActuatorTransmission`.

use cylindroid::closure::{ActuatorTransmission, Limb, Transmission};
use pyo3::prelude::*;

use crate::screws::{PyScrew, PyScrewSystem};

/// A limb: a connection of joints between ground and platform (the link of the reference frame).
///
/// Wrenches are given as screws of their axes, force in place of the angular velocity (world frame).
///
/// Attributes
/// ----------
/// joints : list of str
///     Joints and contacts, from ground to platform if the limb is serial.
/// actuated : list of str
/// serial : bool
///     False if it has loops of its own, such as a parallelogram.
/// connectivity : int
///     Number of independent twists that the limb permits to the platform.
/// twists : ScrewSystem
///     Twists that the limb permits to the platform.
/// constraint : ScrewSystem
///     Wrenches on the platform that the limb resists whatever its actuators do.
/// actuation : ScrewSystem
///     Wrenches on the platform that its actuators balance, beyond the constraint wrenches.
#[pyclass(frozen, name = "Limb", module = "cylindroid")]
#[derive(Debug)]
pub(crate) struct PyLimb {
    inner: Limb,
}

impl From<&Limb> for PyLimb {
    fn from(inner: &Limb) -> Self {
        Self { inner: inner.clone() }
    }
}

#[pymethods]
impl PyLimb {
    #[getter]
    fn joints(&self) -> Vec<String> {
        self.inner.joints.clone()
    }

    #[getter]
    fn actuated(&self) -> Vec<String> {
        self.inner.actuated.clone()
    }

    #[getter]
    fn serial(&self) -> bool {
        self.inner.serial
    }

    #[getter]
    fn connectivity(&self) -> usize {
        self.inner.twists.order()
    }

    #[getter]
    fn twists(&self) -> PyScrewSystem {
        PyScrewSystem { inner: self.inner.twists.clone() }
    }

    #[getter]
    fn constraint(&self) -> PyScrewSystem {
        PyScrewSystem { inner: self.inner.constraint.clone() }
    }

    #[getter]
    fn actuation(&self) -> PyScrewSystem {
        PyScrewSystem { inner: self.inner.actuation.clone() }
    }

    fn __repr__(&self) -> String {
        format!(
            "<Limb {}: connectivity {}, {} constraint wrenches>",
            self.inner.joints.join(", "),
            self.inner.twists.order(),
            self.inner.constraint.order()
        )
    }
}

/// The transmission indices of a parallel mechanism, from 0 to 1.
///
/// Attributes
/// ----------
/// local : float or None
///     Local transmission index: the smallest input or output index.
/// constraint : float or None
///     Smallest index of the constraint wrenches: 0 at constraint singularities; None without
///     constraint wrenches, and where they depend on each other or a limb has several.
/// actuators : list of ActuatorTransmission
#[pyclass(frozen, name = "Transmission", module = "cylindroid")]
#[derive(Debug)]
pub(crate) struct PyTransmission {
    inner: Transmission,
}

impl From<Transmission> for PyTransmission {
    fn from(inner: Transmission) -> Self {
        Self { inner }
    }
}

#[pymethods]
impl PyTransmission {
    #[getter]
    fn local(&self) -> Option<f64> {
        self.inner.local
    }

    #[getter]
    fn constraint(&self) -> Option<f64> {
        self.inner.constraint
    }

    #[getter]
    fn actuators(&self) -> Vec<PyActuatorTransmission> {
        self.inner.actuators.iter().map(PyActuatorTransmission::from).collect()
    }

    fn __repr__(&self) -> String {
        let index = |x: Option<f64>| x.map_or("None".to_owned(), |x| format!("{x:.6}"));
        let (local, constraint) = (index(self.inner.local), index(self.inner.constraint));
        format!("<Transmission: local {local}, constraint {constraint}>")
    }
}

/// The transmission indices of an actuator.
///
/// Attributes
/// ----------
/// name : str
/// limb : int
///     Index of its limb.
/// input : float or None
///     Input transmission index: 0 at type I singularities of the limb.
/// output : float or None
///     Output transmission index: 0 at type II singularities.
/// wrench : Screw or None
///     Its transmission wrench.
#[pyclass(frozen, name = "ActuatorTransmission", module = "cylindroid")]
#[derive(Debug)]
pub(crate) struct PyActuatorTransmission {
    inner: ActuatorTransmission,
}

impl From<&ActuatorTransmission> for PyActuatorTransmission {
    fn from(inner: &ActuatorTransmission) -> Self {
        Self { inner: inner.clone() }
    }
}

#[pymethods]
impl PyActuatorTransmission {
    #[getter]
    fn name(&self) -> String {
        self.inner.name.clone()
    }

    #[getter]
    fn limb(&self) -> usize {
        self.inner.limb
    }

    #[getter]
    fn input(&self) -> Option<f64> {
        self.inner.input
    }

    #[getter]
    fn output(&self) -> Option<f64> {
        self.inner.output
    }

    #[getter]
    fn wrench(&self) -> Option<PyScrew> {
        self.inner.wrench.as_ref().map(PyScrew::from)
    }

    fn __repr__(&self) -> String {
        let index = |x: Option<f64>| x.map_or("None".to_owned(), |x| format!("{x:.6}"));
        let (input, output) = (index(self.inner.input), index(self.inner.output));
        format!("<{}: input {input}, output {output}>", self.inner.name)
    }
}
