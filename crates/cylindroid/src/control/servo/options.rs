//! Options of a servo: frame, task, gains, limits, inverse.
//!
//! Checked  tests/it/servo/steps.rs, tests/it/servo/limits.rs

use std::borrow::Cow;

use super::plant::Plant;
use super::projection::{ProjectionChoice, TaskProjection};
use super::secondary::SecondaryTask;
use super::task_space::TaskScaling;
use crate::error::{Error, Result};
use crate::inverse::Method;
use crate::kinematics::{Chain, EndEffector};
use crate::model::{Dimension, Mechanism};
use crate::task::{Task, check_pose};
use crate::tolerance;

/// Proportional gains [1/s].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ServoGains {
    /// Of the position error.
    pub position: f64,
    /// Of the orientation error.
    pub orientation: f64,
}

impl ServoGains {
    /// The smaller one [1/s].
    pub(super) fn least(&self) -> f64 {
        self.position.min(self.orientation)
    }
}

/// Errors below which a target counts as reached.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PoseTolerance {
    /// Of the position (m).
    pub position: f64,
    /// Of the orientation (rad).
    pub orientation: f64,
}

/// Largest speeds of the end effector.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SpeedLimit {
    /// Of the tool point [m/s].
    pub linear: f64,
    /// Of the tool [rad/s].
    pub angular: f64,
}

/// The null space that secondary tasks may use.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum SecondaryNullSpace {
    /// The null space of the Jacobian at machine precision: the task is never disturbed.
    Exact,
    /// The complement of the directions retained by the inverse: secondary motions may use the
    /// directions that were cut, and disturb the task there.
    Retained,
}

/// Options of a servo. Start from [`ServoOptions::new`].
#[derive(Debug, Clone, PartialEq)]
pub struct ServoOptions {
    /// The controlled frame and tool point.
    pub end_effector: EndEffector,
    /// The components of its motion that form the task.
    pub task: Task,
    /// Time between steps (s).
    pub dt: f64,
    /// Proportional gains; `gain * dt` must be below 2.
    pub gain: ServoGains,
    /// Tolerance within which the target counts as reached.
    pub tolerance: PoseTolerance,
    /// The inverse of the Jacobian; its parameters refer to linear rows divided by `length`.
    pub method: Method,
    /// The part of a motion to realise if the arm cannot perform all of it.
    pub projection: TaskProjection,
    /// The projection used where `projection` does not exist or enlarges a motion too much
    /// (`largest_projection`); `None`: the arm stops and reports the reason.
    pub fallback: Option<TaskProjection>,
    /// A projection that enlarges motions by more than this factor counts as non-existent [-].
    pub largest_projection: f64,
    /// Characteristic length that scales the linear rows (m).
    pub length: f64,
    /// A weight for each coordinate of the mechanism (a large weight keeps it still) [-, or 1/m^2 of
    /// a length]; empty for 1, and for 1/L^2 of slides beside joints that turn, with the
    /// characteristic length L of the mechanism.
    pub joint_weights: Vec<f64>,
    /// Weights from the masses of the model in place of `joint_weights`: the diagonal of the mass
    /// matrix, evaluated at the configuration of every step.
    pub inertia_weights: bool,
    /// Largest speeds of the end effector.
    pub speed: SpeedLimit,
    /// Acceleration limit of coordinates without one in the model [rad/s^2 or m/s^2]; `None` for the
    /// default ramp, [`tolerance::DEFAULT_RAMP`], infinite for none.
    pub acceleration: Option<f64>,
    /// Jerk limit of coordinates without one in the model [rad/s^3 or m/s^3]; infinite, the default,
    /// for none. Joints without drives have none.
    pub jerk: f64,
    /// The lag, the delay and the noise of the robot.
    pub plant: Plant,
    /// Time for which a twist of [`Servo::step_twist`](super::controller::Servo::step_twist) holds
    /// without a new command (s); infinite for no watchdog.
    pub command_timeout: f64,
    /// Secondary tasks: their joint velocities are added and projected onto the null space.
    pub secondary: Vec<SecondaryTask>,
    /// The null space available to the secondary tasks.
    pub null_space: SecondaryNullSpace,
}

impl ServoOptions {
    /// The defaults for a mechanism: its tool, or the reference of a closed chain; complete poses
    /// (x, y and rz in the plane); 1 kHz; gains of 5/s; the truncated inverse; the characteristic
    /// length of the mechanism; the default ramp where the model has no acceleration limit; twists that
    /// hold for 0.1 s.
    #[must_use]
    pub fn new(mechanism: &Mechanism) -> Self {
        let closed = mechanism.is_closed();
        let end_effector = if closed { mechanism.reference() } else { mechanism.tool() };
        let planar = closed && mechanism.dimension() == Dimension::Planar;
        Self {
            end_effector: end_effector.into(),
            task: if planar { Task::PLANAR } else { Task::POSE },
            dt: 1e-3,
            gain: ServoGains { position: 5.0, orientation: 5.0 },
            tolerance: PoseTolerance {
                position: tolerance::POSITION,
                orientation: tolerance::ORIENTATION,
            },
            method: Method::default(),
            projection: TaskProjection::Orthogonal,
            fallback: None,
            largest_projection: tolerance::MAX_PROJECTION_NORM,
            length: mechanism.reach(),
            joint_weights: Vec::new(),
            inertia_weights: false,
            speed: SpeedLimit { linear: f64::INFINITY, angular: f64::INFINITY },
            acceleration: None,
            jerk: f64::INFINITY,
            plant: Plant::IDEAL,
            command_timeout: 0.1,
            secondary: Vec::new(),
            null_space: SecondaryNullSpace::Exact,
        }
    }

    /// Default secondary tasks: joint-limit avoidance with default parameters for redundant arms
    /// and for closed chains; none otherwise.
    ///
    /// ```
    /// use cylindroid::{ServoOptions, catalogue};
    ///
    /// let (panda, ur5e) = (catalogue::load("panda")?, catalogue::load("ur5e")?);
    /// let default = ServoOptions::new(&panda).default_secondary(&panda)?;
    /// assert_eq!(default[0].name(), "limit-avoidance");
    /// assert!(ServoOptions::new(&ur5e).default_secondary(&ur5e)?.is_empty());
    /// # Ok::<(), cylindroid::Error>(())
    /// ```
    ///
    /// # Errors
    /// A frame of another mechanism.
    pub fn default_secondary(&self, mechanism: &Mechanism) -> Result<Vec<SecondaryTask>> {
        mechanism.check_frame(self.end_effector.frame)?;
        let components = self.task.components.iter().filter(|c| **c).count();
        let joints = Chain::of(mechanism, self.end_effector).n();
        if joints > components || mechanism.is_closed() {
            return Ok(vec![SecondaryTask::named("limit-avoidance", &[])?]);
        }
        Ok(Vec::new())
    }

    /// The scales of the task space.
    pub(super) fn scaling<'a>(&self, joint_weights: &'a [f64]) -> TaskScaling<'a> {
        let (task, length) = (self.task, self.length);
        TaskScaling { task, length, joint_weights }
    }

    /// The weights of the coordinates. By default those of slides among joints that turn are 1/L^2, so
    /// that the motion depends on no unit of length; empty where all are one.
    pub(super) fn weights(&self, mechanism: &Mechanism) -> Cow<'_, [f64]> {
        let all = mechanism.coordinates();
        let slides = all.iter().filter(|c| c.kind.is_length()).count();
        if !self.joint_weights.is_empty() || slides == 0 || slides == all.len() {
            return Cow::Borrowed(&self.joint_weights);
        }
        (0..all.len()).map(|i| mechanism.unit_of(i).powi(-2)).collect()
    }

    /// The projection and its fallback.
    pub(super) fn projection_choice(&self) -> ProjectionChoice<'_> {
        ProjectionChoice {
            projection: &self.projection,
            fallback: self.fallback.as_ref(),
            largest: self.largest_projection,
        }
    }

    /// Checks that the options define a controller.
    ///
    /// # Errors
    /// [`Error::InvalidOption`] naming the option and its value, [`Error::NotFinite`].
    pub fn check(&self, mechanism: &Mechanism) -> Result<()> {
        let positive = Error::check_positive;
        mechanism.check_frame(self.end_effector.frame)?;
        check_pose("frame_from_tool of the end effector", &self.end_effector.frame_from_tool)?;
        positive("dt", self.dt)?;
        mechanism.length_or(Some(self.length))?;
        for (option, gain) in
            [("position gain", self.gain.position), ("orientation gain", self.gain.orientation)]
        {
            positive(option, gain)?;
            if gain * self.dt >= 2.0 {
                return Err(Error::InvalidOption {
                    option,
                    value: format!("{gain} 1/s with dt = {} s", self.dt),
                    reason: format!(
                        "gain * dt = {} must be below 2, or the error grows with every step; at \
                         most 1 is free of overshoot: use a gain up to {}",
                        gain * self.dt,
                        1.0 / self.dt
                    ),
                });
            }
        }
        for (option, value) in [
            ("position tolerance", self.tolerance.position),
            ("orientation tolerance", self.tolerance.orientation),
            ("linear speed", self.speed.linear),
            ("angular speed", self.speed.angular),
            ("acceleration", self.acceleration.unwrap_or(f64::INFINITY)),
            ("jerk", self.jerk),
            ("largest projection", self.largest_projection),
            ("command timeout", self.command_timeout),
        ] {
            if value.is_nan() || value <= 0.0 {
                return Err(Error::InvalidOption {
                    option,
                    value: value.to_string(),
                    reason: "it must be positive; infinity means no limit".to_owned(),
                });
            }
        }
        self.plant.check(self.dt)?;
        self.task.check()?;
        if self.inertia_weights && !self.joint_weights.is_empty() {
            return Err(Error::InvalidOption {
                option: "joint weights",
                value: "inertia".to_owned(),
                reason: "weights are given too; keep one of them".to_owned(),
            });
        }
        if !self.joint_weights.is_empty() {
            mechanism.check_q("joint weights", &self.joint_weights)?;
            for &w in &self.joint_weights {
                positive("joint weight", w)?;
            }
        }
        for secondary in &self.secondary {
            secondary.check(mechanism)?;
        }
        for projection in [Some(&self.projection), self.fallback.as_ref()].into_iter().flatten() {
            projection.check()?;
            if *projection != TaskProjection::Orthogonal && self.task.components != [true; 6] {
                return Err(Error::InvalidOption {
                    option: "projection",
                    value: projection.name().to_owned(),
                    reason: "it needs whole poses as task: forms of twists have six components"
                        .to_owned(),
                });
            }
        }
        self.method.check()
    }
}

#[cfg(test)]
mod tests {
    use super::ServoGains;

    #[test]
    fn the_smaller_gain_is_the_least() {
        for (position, orientation) in [(2.0, 3.0), (3.0, 2.0)] {
            assert_eq!(ServoGains { position, orientation }.least(), 2.0);
        }
    }
}
