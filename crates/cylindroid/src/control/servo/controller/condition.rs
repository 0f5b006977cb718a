//! Condition of a configuration: singular values of the task, its weakest direction, and the
//! self-motions that leave the tool at rest.
//!
//! Formula  J_task = U S V^T (`task_space.rs`, for closed chains `coupled.rs`): the weakest motion
//!          is the last column of U; self-motions are ker J_task, continued from step to step by
//!          projecting the previous one onto the next kernel
//! Shapes   J_task: m x n; self-motions have the n coordinates of the mechanism
//! Units    singular values scaled as in the servo; the weakest motion in m and rad
//! Frame    the weakest motion at the tool, world axes
//! Valid    any rank. A self-motion is scaled such that the fastest joint moves at its velocity
//!          limit (1 rad/s or m/s if it has none); its sign is arbitrary, the largest entry is
//!          positive
//! Checked  tests/it/servo/condition.rs

use super::Servo;
use crate::error::{Error, Result};
use crate::inverse::Inverse;
use crate::kinematics::ReferenceFrame;
use crate::linalg::{RowSpace, Svd, norm};
use crate::spatial::Twist;
use crate::tolerance::UNACTUATED;

/// The condition of a configuration for the task of a servo: singular values and weakest direction.
///
/// ```text
/// J_task = U S V^T,   singular_ratio = s_min / s_max,   weakest = the column of U of s_min
/// ```
///
/// J_task is the m x n Jacobian of the task, scaled as in the servo.
#[derive(Debug, Clone, PartialEq)]
pub struct ConditionReport {
    /// The servo's inverse of the scaled task Jacobian, with its report.
    pub inverse: Inverse,
    /// Ratio of the smallest to the largest singular value.
    pub singular_ratio: f64,
    /// The tool's motion of the smallest singular value, of unit length in scaled units (m, rad):
    /// at the tool, world axes, its sign arbitrary. `None` if no motion is possible.
    pub weakest: Option<Twist>,
}

impl Servo {
    /// Evaluates a configuration as a step would; the joint velocities, the target and the stall
    /// detector are unchanged.
    ///
    /// ```
    /// use cylindroid::{Servo, ServoOptions};
    ///
    /// // With a straight elbow the arm cannot retract.
    /// let robot = cylindroid::load("ur5e")?;
    /// let mut servo = Servo::new(&robot, ServoOptions::new(&robot))?;
    /// let regular = servo.condition(&[0.0, -1.1, 1.4, 0.2, 1.0, 0.0])?;
    /// let singular = servo.condition(&[0.0, -0.6, 0.0, 0.4, 1.0, 0.0])?;
    /// assert!(singular.singular_ratio < 1e-12 && regular.singular_ratio > 0.01);
    /// # Ok::<(), cylindroid::Error>(())
    /// ```
    ///
    /// # Errors
    /// As [`Servo::step`].
    pub fn condition(&mut self, q: &[f64]) -> Result<ConditionReport> {
        let svd = self.decomposed(q)?;
        let weakest = (svd.largest() > 0.0).then(|| {
            let twist = self.space.twist(svd.u(svd.len() - 1));
            if self.options.task.axes == ReferenceFrame::Local {
                let turn = self.chain.pose().rotation;
                Twist { linear: turn * twist.linear, angular: turn * twist.angular }
            } else {
                twist
            }
        });
        let singular_ratio = svd.singular_ratio();
        Ok(ConditionReport {
            inverse: self.options.method.inverse(&self.task)?,
            singular_ratio,
            weakest,
        })
    }

    /// Number of independent self-motions at non-singular configurations.
    #[must_use]
    pub fn redundancy(&self) -> usize {
        let unknowns = match &self.coupled {
            Some(coupled) => coupled.actuated_motions(),
            None => self.free_coordinates().count(),
        };
        unknowns.saturating_sub(self.generic_rank)
    }

    /// A basis of the self-motions at `q`, ker J_task, which leave the tool at rest: velocities of
    /// all n coordinates [rad/s or m/s]. Each is scaled such that the fastest joint moves at its
    /// velocity limit (1 rad/s or m/s without one), with a positive largest entry.
    ///
    /// ```
    /// use cylindroid::{ReferenceFrame, Servo, ServoOptions};
    ///
    /// // The elbow of a 7R arm moves with the tool at rest.
    /// let robot = cylindroid::load("panda")?;
    /// let q = [0.3, -0.4, 0.1, -2.0, 0.2, 1.7, 0.5];
    /// let mut servo = Servo::new(&robot, ServoOptions::new(&robot))?;
    /// let motions = servo.self_motions(&q)?;
    /// let frame = ReferenceFrame::LocalWorldAligned;
    /// let twist = robot.state(&q)?.twist(&motions[0], robot.tool(), frame)?;
    /// assert!(motions.len() == 1 && twist.linear.norm() < 1e-12);
    /// assert!(servo.next_self_motion(&q, &motions[0])?.is_some());
    /// # Ok::<(), cylindroid::Error>(())
    /// ```
    ///
    /// # Errors
    /// As [`Servo::step`].
    pub fn self_motions(&mut self, q: &[f64]) -> Result<Vec<Vec<f64>>> {
        let svd = self.decomposed(q)?;
        let basis = RowSpace::exact(&svd).null_space_basis();
        let motions = (0..basis.cols()).filter_map(|j| self.at_full_speed(basis.column(j)));
        let upwards = |mut motion: Vec<f64>| {
            let largest =
                motion.iter().fold(0.0, |m: f64, x| if x.abs() > m.abs() { *x } else { m });
            motion.iter_mut().for_each(|x| *x *= 1_f64.copysign(largest));
            motion
        };
        Ok(motions.map(upwards).collect())
    }

    /// The self-motion at `q` closest to `last`, that of the previous step: its projection onto ker
    /// J_task, scaled as in [`Servo::self_motions`]; `None` if the projection vanishes.
    ///
    /// # Errors
    /// As [`Servo::step`]; a motion of the wrong size or non-finite.
    pub fn next_self_motion(&mut self, q: &[f64], last: &[f64]) -> Result<Option<Vec<f64>>> {
        self.mechanism.check_q("last self-motion", last)?;
        let svd = self.decomposed(q)?;
        let mut x = if let Some(coupled) = &self.coupled {
            let mut rates = last.to_vec();
            rates.resize(self.limits.len(), 0.0);
            coupled.actuation_of(&rates, &self.space)
        } else {
            let own = self.chain.coordinates().iter().enumerate();
            own.map(|(i, &c)| self.space.scaled_rate(i, last[c])).collect()
        };
        RowSpace::exact(&svd).project_out(&mut x);
        Ok(self.at_full_speed(&x))
    }

    /// Singular value decomposition of the task Jacobian at `q`.
    fn decomposed(&mut self, q: &[f64]) -> Result<Svd> {
        self.mechanism.check_q("q", q)?;
        self.load_configuration(q)?;
        self.load_jacobian(q)?;
        Error::check_finite("Jacobian of the task", self.task.as_slice())?;
        Ok(Svd::of(&self.task))
    }

    /// Velocities of all coordinates for the unknowns `x` of the servo, the fastest joint at its
    /// limit; `None` if nothing moves.
    fn at_full_speed(&self, x: &[f64]) -> Option<Vec<f64>> {
        if norm(x) <= UNACTUATED {
            return None;
        }
        let mut own = vec![0.0; self.limits.len()];
        match &self.coupled {
            Some(coupled) => coupled.coupling.expand(x, &mut own),
            None => own.copy_from_slice(x),
        }
        own.iter_mut().zip(&self.space.columns).for_each(|(rate, scale)| *rate *= scale);
        let share = |(rate, l): (&f64, &crate::model::Limits)| {
            rate.abs() / if l.velocity.is_finite() { l.velocity } else { 1.0 }
        };
        let fastest = own.iter().zip(&self.limits).map(share).fold(0.0, f64::max);
        if !(fastest > UNACTUATED && fastest.is_finite()) {
            return None;
        }
        let mut rates = vec![0.0; self.mechanism.n()];
        for (rate, &c) in own.iter().zip(self.chain.coordinates()) {
            rates[c] = rate / fastest;
        }
        Some(rates)
    }

    /// Distances prove nothing unless the task constrains the whole position.
    pub(super) fn offset_of_free_position(&self) -> f64 {
        if self.options.task.components[..3] == [true; 3] { 0.0 } else { f64::INFINITY }
    }
}
