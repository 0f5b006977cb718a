//! Internal forces of cooperating arms, hands and over-actuated mechanisms: how hard an object is
//! squeezed, apart from how it moves.
//!
//! Formula  rates = gain C P (desired - measured), C the compliance of the drives, P the projection
//!          on the internal torques (those that do no work on any motion of the drives),
//!          orthogonal in C
//! Shapes   torques and rates: an entry for each driven joint
//! Units    gain 1/s; stiffness N m/rad (N/m for slides), torques N m (N)
//! Valid    drives that follow positions or rates and give way like springs; gain * dt < 2.
//!          Mechanisms without internal torques get no rates
//! Why so   rates C P tau are orthogonal, in the stiffness, to every motion that the loops allow:
//!          the object stays where it is, and the internal torques alone go to their set-point, as
//!          exp(-gain t). Another metric would move the object, or mix its load into the squeeze
//! Source   Bicchi & Prattichizzo 1998, eq. 13 (active internal torques); elastic drives as in
//!          their earlier work on stiffness of cooperating limbs
//! Checked  tests/it/servo/internal_force.rs

use crate::closure::Relation;
use crate::error::{Error, Result};
use crate::linalg::Qr;

/// Drives an internal load to a set-point, to be added to the rates of a servo.
#[derive(Debug, Clone, PartialEq)]
pub struct InternalForceController {
    gain: f64,
    /// Roots of the compliances.
    roots: Vec<f64>,
}

/// What to do.
#[derive(Debug, Clone, PartialEq)]
pub struct InternalForceCommand {
    /// To be added to those of the driven joints [rad/s or m/s].
    pub joint_velocities: Vec<f64>,
    /// The internal part of the measured torques.
    pub internal: Vec<f64>,
    /// The internal part of desired less measured torques.
    pub error: Vec<f64>,
}

impl InternalForceController {
    /// With a gain [1/s] and the stiffness of each driven joint [N m/rad or N/m].
    ///
    /// # Errors
    /// A gain or a stiffness that is not positive and finite.
    pub fn new(gain: f64, stiffness: &[f64]) -> Result<Self> {
        Error::check_positive("gain", gain)?;
        for &k in stiffness {
            Error::check_positive("stiffness", k)?;
        }
        Ok(Self { gain, roots: stiffness.iter().map(|k| 1.0 / k.sqrt()).collect() })
    }

    /// The rates that bring the internal part of the `measured` torques to that of the `desired`
    /// ones; both as the joints exert them. For a squeeze t at the contacts (a column of
    /// [`internal_forces`](crate::closure::internal_forces)) the desired torques are -J_a^T t.
    ///
    /// # Errors
    /// Torques or stiffnesses of another number than driven joints, or not finite.
    pub fn command(
        &self,
        relation: &Relation,
        desired: &[f64],
        measured: &[f64],
    ) -> Result<InternalForceCommand> {
        let n = relation.joints();
        Error::check_len("stiffness", n, self.roots.len())?;
        Error::check_len("desired torques", n, desired.len())?;
        Error::check_len("measured torques", n, measured.len())?;
        Error::check_finite("desired torques", desired)?;
        Error::check_finite("measured torques", measured)?;
        let mut basis = relation.forces().zero;
        for j in 0..basis.cols() {
            basis.column_mut(j).iter_mut().zip(&self.roots).for_each(|(x, r)| *x *= r);
        }
        let basis = Qr::plain(basis).basis();
        // P torque = C^(-1/2) Q Q^T C^(1/2) torque
        let part = |torques: &[f64]| -> Vec<f64> {
            let scaled: Vec<f64> = torques.iter().zip(&self.roots).map(|(t, r)| t * r).collect();
            let along = basis.transpose().mul_vec(&scaled);
            basis.mul_vec(&along).iter().zip(&self.roots).map(|(x, r)| x / r).collect()
        };
        let (desired, internal) = (part(desired), part(measured));
        let error: Vec<f64> = desired.iter().zip(&internal).map(|(w, m)| w - m).collect();
        let joint_velocities: Vec<f64> =
            error.iter().zip(&self.roots).map(|(e, r)| self.gain * r * r * e).collect();
        Error::check_finite("joint velocities", &joint_velocities)?;
        Ok(InternalForceCommand { joint_velocities, internal, error })
    }
}
