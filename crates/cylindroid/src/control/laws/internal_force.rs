//! Internal forces of cooperating arms, hands and redundantly actuated mechanisms: the squeeze on
//! an object is regulated independently of its motion.
//!
//! Formula  the page of [`InternalForceController`]
//! Shapes   torques and velocities: an entry for each actuated joint
//! Units    gain 1/s; stiffness N m/rad (N/m for prismatic joints), torques N m (N)
//! Valid    actuators controlled in position or velocity that yield like springs; gain * dt < 2.
//!          Mechanisms without internal torques get zero velocities
//! Why so   velocities C P tau are orthogonal, in the stiffness, to every motion that the loops
//!          permit: the object stays at rest, and only the internal torques converge to their
//!          set-point, as exp(-gain t). Another metric would move the object, or mix its load into
//!          the squeeze
//! Source   Bicchi & Prattichizzo 1998, eq. 13 (active internal torques); elastic actuators as in
//!          their earlier work on stiffness of cooperating limbs
//! Checked  tests/it/servo/internal_force.rs

use crate::closure::Relation;
use crate::error::{Error, Result};
use crate::linalg::Qr;

/// Regulates internal torques to a set-point; its output is added to the joint velocities of a
/// servo.
///
/// ```text
/// joint velocities = gain C P (tau_d - tau)
/// ```
///
/// C is the compliance of the actuators (the inverse of their stiffness), P the projection on the
/// internal torques, orthogonal in C. An entry for each actuated joint: torques in N m (N),
/// stiffness in N m/rad (N/m). The object stays at rest, and the internal torques converge to their
/// set-point as `exp(-gain t)`. Requires actuators that yield like springs, and `gain * dt < 2`.
///
/// Source: Bicchi & Prattichizzo 1998, eq. 13.
#[derive(Debug, Clone, PartialEq)]
pub struct InternalForceController {
    gain: f64,
    /// Square roots of the compliances.
    roots: Vec<f64>,
}

/// Output of one step of internal-force control.
#[derive(Debug, Clone, PartialEq)]
pub struct InternalForceCommand {
    /// Velocities to be added to those of the actuated joints [rad/s or m/s].
    pub joint_velocities: Vec<f64>,
    /// The internal part of the measured torques.
    pub internal: Vec<f64>,
    /// The internal part of desired minus measured torques.
    pub error: Vec<f64>,
}

impl InternalForceController {
    /// A controller with a gain [1/s] and the stiffness of each actuated joint [N m/rad or N/m].
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

    /// The joint velocities that bring the internal part of the `measured` torques to that of the
    /// `desired` ones; both as exerted by the joints. For a squeeze t at the contacts (a column of
    /// [`internal_forces`](crate::closure::internal_forces)) the desired torques are -J_a^T t.
    ///
    /// ```
    /// use cylindroid::closure::{ClosedChain, MotionSpace, internal_forces};
    /// use cylindroid::control::InternalForceController;
    ///
    /// // Two arms squeeze their object as in the first internal force at the contacts.
    /// let arms = cylindroid::load("two-arm")?;
    /// let chain = ClosedChain::of(&arms.state(arms.home())?, None, None)?;
    /// let relation = MotionSpace::of(&chain.constraint).relation();
    /// let squeeze = internal_forces(&chain.constraint).basis;
    /// let torques = chain.constraint.blocks().actuated.transpose().mul_vec(squeeze.column(0));
    /// let desired: Vec<f64> = torques.iter().map(|torque| -torque).collect();
    /// let measured = vec![0.0; desired.len()];
    /// let controller = InternalForceController::new(10.0, &vec![1e4; desired.len()])?;
    /// let command = controller.command(&relation, &desired, &measured)?;
    /// assert!(command.joint_velocities.iter().any(|velocity| *velocity != 0.0));
    /// # Ok::<(), cylindroid::Error>(())
    /// ```
    ///
    /// # Errors
    /// Torques or stiffnesses that are non-finite, or whose number is not that of the actuated
    /// joints.
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
