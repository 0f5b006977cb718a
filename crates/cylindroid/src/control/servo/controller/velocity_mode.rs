//! A servo step that follows a twist.
//!
//! Checked  tests/it/servo/twist.rs

use super::super::stall::Stall;
use super::super::step::Aim;
use super::super::twist_step::{NEAR_SINGULAR, TwistStatus, TwistStep};
use super::Servo;
use crate::error::{Error, Result};
use crate::kinematics::ReferenceFrame;
use crate::linalg::norm;
use crate::spatial::{Pose, Twist};
use crate::tolerance::MAX_MAGNITUDE;

impl Servo {
    /// One step of velocity mode: the tool follows a twist (world axes, at the tool) within all
    /// limits, without a target pose ([`Servo::step_twist_actuated`] from the actuated joints alone).
    /// `command` is the twist that arrived since the last step, if
    /// any. Without a new command the last one holds for [`ServoOptions::command_timeout`], then the
    /// joints brake: a lost connection stops the arm. Secondary tasks pause while the twist is zero.
    ///
    /// ```
    /// use cylindroid::control::TwistStatus;
    /// use cylindroid::{Servo, ServoOptions, Twist, Vec3};
    ///
    /// let robot = cylindroid::load("panda")?;
    /// let mut servo = Servo::new(&robot, ServoOptions::new(&robot))?;
    /// let mut q = robot.home().to_vec();
    /// let up = Twist { linear: Vec3::Z * 0.05, angular: Vec3::ZERO };
    /// for step in 0..500 {
    ///     // Commands arrive every 20 ms, for 0.2 s.
    ///     let command = (step % 20 == 0 && step < 200).then_some(up);
    ///     let now = servo.step_twist(&q, command)?; // command servo.joint_velocities()
    ///     servo.advance(&mut q); // in a simulation
    ///     if step == 499 {
    ///         assert!(now.timed_out && now.status == TwistStatus::AtRest);
    ///     }
    /// }
    /// # Ok::<(), cylindroid::Error>(())
    /// ```
    ///
    /// [`ServoOptions::command_timeout`]: crate::ServoOptions::command_timeout
    ///
    /// # Errors
    /// As [`Servo::step`]; the servo is unchanged.
    pub fn step_twist(&mut self, q: &[f64], command: Option<Twist>) -> Result<TwistStep> {
        self.mechanism.check_q("q", q)?;
        if let Some(twist) = command {
            Error::check_within("commanded twist", &twist.to_array(), MAX_MAGNITUDE)?;
        }
        let (dt, timeout) = (self.options.dt, self.options.command_timeout);
        let (mut desired, timed_out) = self.twist_follower.desired(command, dt, timeout);
        // Nothing is left to follow of a twist out of the plane of a planar mechanism.
        let task = self.options.task;
        if task.axes != ReferenceFrame::Local && task.seen(Pose::IDENTITY, desired) == Twist::ZERO {
            desired = Twist::ZERO;
        }
        let at_rest = desired == Twist::ZERO;
        let paused = if at_rest { std::mem::take(&mut self.options.secondary) } else { Vec::new() };
        let result = self.step_towards(q, Aim::Twist(desired), &[]);
        if at_rest {
            self.options.secondary = paused;
        }
        let step = result?;
        self.load_achieved_twist();
        // The stall is classified by the twist, in place of an error.
        self.space.scale(self.options.task.seen(step.pose, desired), &mut self.error);
        self.projected_error.copy_from_slice(&self.error);
        self.step_projection.apply(&mut self.projected_error);
        self.twist_follower.record(command, &self.error, &self.achieved_twist, dt);
        let stalled = self.twist_follower.is_stalled;
        let status = match (at_rest, stalled || self.is_stopped()) {
            (true, _) if self.is_at_rest() => TwistStatus::AtRest,
            (true, _) => TwistStatus::Braking,
            (false, true) => TwistStatus::Stalled,
            (false, false) => TwistStatus::Following,
        };
        let seen = self.space.twist(&self.achieved_twist);
        let achieved = match self.options.task.axes {
            ReferenceFrame::Local => Twist {
                linear: step.pose.rotation * seen.linear,
                angular: step.pose.rotation * seen.angular,
            },
            _ => seen,
        };
        Ok(TwistStep { status, desired, achieved, timed_out, step })
    }

    /// True if no joint is commanded to move, of closed chains but to close the measured loops.
    fn is_at_rest(&self) -> bool {
        let motion = self.coupled.as_ref().map_or(&self.rates, |c| &c.coupling.actuation);
        motion.iter().all(|rate| *rate == 0.0)
    }

    /// The reason of a stall; in velocity mode near a singularity, the singularity.
    pub(super) fn twist_stall(&self, stall: Stall) -> Stall {
        let ratio = self.svd.singular_ratio();
        if stall != Stall::Slow || !self.twist_follower.is_stalled || ratio >= NEAR_SINGULAR {
            return stall;
        }
        let size = norm(&self.error).max(f64::MIN_POSITIVE);
        Stall::Singular { ratio, direction: self.error.iter().map(|x| x / size).collect() }
    }
}
