//! Closed chains: constraint, mobility, manipulability, statics, assembly.
//!
//! A serial arm is a mechanism without loops: the same functions serve it.

mod assembly;
mod assembly_modes;
mod constraint;
mod continuation;
mod curvature;
mod ellipsoid;
mod finite_mobility;
mod gradient;
pub(crate) mod grasp;
pub(crate) mod grasp_mobility;
mod limbs;
mod manipulability;
mod measures;
mod metrics;
mod mobility;
mod object;
mod operation_modes;
mod polytope;
mod singularity;
mod spectrum;
mod statics;
mod stiffness;
mod transmitted;

use pyo3::prelude::*;

use crate::arrays::Many;
use crate::coordinates::{Coordinates, Rows};
use crate::error::Result;
use crate::mechanism::PyMechanism;

pub(crate) use assembly::{PyAssembly, PyLoopClosureError};
pub(crate) use assembly_modes::PyAssemblyModes;
pub(crate) use constraint::PyConstraint;
pub(crate) use continuation::PyContinuationResult;
pub(crate) use ellipsoid::PyEllipsoid;
pub(crate) use finite_mobility::{PyBranch, PyFiniteMobility};
pub(crate) use gradient::PyGradient;
pub(crate) use grasp::{PyFingerContact, PyGraspQuality};
pub(crate) use grasp_mobility::PyGraspMobility;
pub(crate) use limbs::{PyActuatorTransmission, PyLimb, PyTransmission};
pub(crate) use manipulability::PyManipulability;
pub(crate) use mobility::{PyJointMobility, PyMobility};
pub(crate) use operation_modes::{PyModeMeeting, PyOperationMode, PyOperationModes};
pub(crate) use polytope::PyPolytope;
pub(crate) use singularity::PySingularity;
pub(crate) use spectrum::{PyDirection, PySpectrum};
pub(crate) use statics::{PyContactForces, PyJointTorques};
pub(crate) use stiffness::{PyDeflection, PyStiffness};
pub(crate) use transmitted::PyTransmittedWrench;

impl PyMechanism {
    /// The constraints at one or many configurations.
    fn constraints(
        &self,
        py: Python<'_>,
        q: Option<&Coordinates<'_>>,
        actuated: Option<&[String]>,
        reference: Option<&str>,
        length: Option<f64>,
    ) -> Result<Many<PyConstraint>> {
        let actuated = actuated.map(|names| self.inner.with_actuated(names)).transpose()?;
        let mechanism = actuated.as_ref().unwrap_or(&self.inner);
        let one = |q: &[f64]| PyConstraint::of(mechanism, q, reference, length);
        let Some(q) = q else { return Ok(Many::One(one(mechanism.home())?)) };
        let rows = Rows::of(mechanism, "q", q)?;
        Ok(match rows.count {
            None => Many::One(one(rows.row(0))?),
            Some(n) => {
                let all = || (0..n).map(|i| one(rows.row(i))).collect::<Result<_>>();
                Many::All(py.detach(all)?)
            }
        })
    }
}
