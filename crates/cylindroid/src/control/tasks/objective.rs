//! Objectives of tasks: an error and a Jacobian.
//!
//! Formula  J q' = K e + feed-forward, with
//!          frame               e = [p_d - p; log(R_d R^T)] in the axes of the task
//!          relative frame      `task/relative_frame.rs`
//!          centre of mass      e = c_d - c,  J = sum m_i J_i / m
//!          gaze                `task/gaze.rs`
//!          posture             K (q_d - q), rotations on their group
//! Shapes   e: rows; J: rows x n
//! Units    m and rad; rows of lengths are divided by the characteristic length by the servo
//! Checked  tests/it/servo/tasks.rs::jacobians_are_derivatives_of_errors

use std::fmt;

use super::gradient::Gradient;
use crate::control::servo::{SecondaryTask, SecondaryVelocities, Target, posture_ways};
use crate::error::{Error, Result};
use crate::kinematics::{EndEffector, MassMatrix, State};
use crate::linalg::Matrix;
use crate::model::Mechanism;
use crate::spatial::{Pose, Twist, Vec3};
use crate::task::{Gaze, RelativeFrame, Task, check_pose};
use crate::tolerance::MAX_MAGNITUDE;

/// A task defined by its user: an error and its Jacobian.
pub trait CustomTask: fmt::Debug + Send + Sync {
    /// Number of rows.
    fn rows(&self) -> usize;

    /// Writes the error e (rows) and the Jacobian J (rows x n) at `state`, such that joint
    /// velocities q' change the error by `-J q'`: the servo makes `J q' = gain * e`.
    ///
    /// # Errors
    /// Its own; the step then fails and leaves the servo as it was.
    fn evaluate(&mut self, state: &State, error: &mut [f64], jacobian: &mut Matrix) -> Result<()>;

    /// A copy in a box.
    fn boxed(&self) -> Box<dyn CustomTask>;
}

impl Clone for Box<dyn CustomTask> {
    fn clone(&self) -> Self {
        (**self).boxed()
    }
}

/// The motion that a task asks for.
#[derive(Debug, Clone)]
#[non_exhaustive]
pub enum TaskObjective {
    /// A frame at a pose in the world.
    Frame {
        /// The frame and the tool point.
        end_effector: EndEffector,
        /// The components of the task.
        components: Task,
        /// Pose and feed-forward twist (world axes, at the tool).
        target: Target,
    },
    /// A frame at a pose relative to another one: two hands on one object, a tool beside a tool.
    RelativeFrame {
        /// The frame.
        end_effector: EndEffector,
        /// The frame from which its pose is seen.
        reference: EndEffector,
        /// The components of the task, in the axes of the reference.
        components: Task,
        /// Desired pose `reference_from_tool`.
        target: Pose,
    },
    /// The centre of mass of the moving links at a point of the world (m).
    CenterOfMass {
        /// The axes that count.
        axes: [bool; 3],
        /// The point.
        target: Vec3,
        /// Its velocity (m/s), added as a feed-forward; with a gain of zero the task is this velocity.
        velocity: Vec3,
    },
    /// The z axis of a frame towards a point of the world.
    Gaze {
        /// The frame that looks along its z axis.
        end_effector: EndEffector,
        /// The point.
        point: Vec3,
    },
    /// A preferred configuration. Always of the lowest level: what all other tasks leave free.
    Posture {
        /// The configuration.
        q: Vec<f64>,
    },
    /// Desired velocities of all joints [rad/s or m/s]. Always of the lowest level.
    JointVelocities {
        /// The velocities.
        velocities: Vec<f64>,
    },
    /// Towards larger manipulability (Yoshikawa) of a frame, the gain times its gradient. Always of
    /// the lowest level. Trees only.
    Manipulability {
        /// The frame and the tool point.
        end_effector: EndEffector,
        /// The components of its task.
        components: Task,
    },
    /// Away from joint limits that are near, with the gain as velocity at the limit [rad/s or m/s].
    /// Always of the lowest level.
    LimitAvoidance {
        /// Distance at which it sets in, as a share of the range [-].
        margin: f64,
    },
    /// A task of one's own.
    Custom(Box<dyn CustomTask>),
}

/// Memory for the Jacobians of frames.
#[derive(Debug, Clone)]
pub(super) struct Scratch {
    jacobian: Matrix,
    center: Matrix,
    masses: Option<MassMatrix>,
}

impl Scratch {
    pub(super) fn new(mechanism: &Mechanism, needs_masses: bool) -> Self {
        let n = mechanism.n();
        Self {
            jacobian: Matrix::zeros(6, n),
            center: Matrix::zeros(3, n),
            masses: needs_masses.then(|| MassMatrix::new(mechanism)),
        }
    }
}

/// The rows of a task: error, feed-forward velocity and Jacobian.
#[derive(Debug)]
pub(super) struct Rows<'a> {
    pub(super) error: &'a mut [f64],
    pub(super) feed_forward: &'a mut [f64],
    pub(super) jacobian: &'a mut Matrix,
}

impl TaskObjective {
    /// Number of rows; 0 for tasks of the lowest level.
    pub(super) fn rows(&self) -> usize {
        let count = |components: &[bool]| components.iter().filter(|c| **c).count();
        match self {
            Self::Frame { components, .. } | Self::RelativeFrame { components, .. } => {
                count(&components.components)
            }
            Self::CenterOfMass { axes, .. } => count(axes),
            Self::Gaze { .. } => 3,
            Self::Posture { .. }
            | Self::JointVelocities { .. }
            | Self::Manipulability { .. }
            | Self::LimitAvoidance { .. } => 0,
            Self::Custom(task) => task.rows(),
        }
    }

    /// True if row `i` is a length.
    pub(super) fn is_length(&self, i: usize) -> bool {
        match self {
            Self::Frame { components, .. } | Self::RelativeFrame { components, .. } => {
                i < components.components[..3].iter().filter(|c| **c).count()
            }
            Self::CenterOfMass { .. } => true,
            _ => false,
        }
    }

    /// True if the target is another one than `last`, which it replaces; of custom tasks it is not
    /// known.
    pub(super) fn has_moved(&self, last: &mut Vec<f64>) -> bool {
        let (mut place, mut moved) = (0, false);
        let mut note = |x: &f64| {
            match last.get_mut(place) {
                Some(before) => {
                    moved |= *before != *x;
                    *before = *x;
                }
                None => last.push(*x),
            }
            place += 1;
        };
        match self {
            Self::Frame { target: Target { pose, .. }, .. }
            | Self::RelativeFrame { target: pose, .. } => {
                pose.translation.to_array().iter().for_each(&mut note);
                pose.rotation.matrix().to_rows().as_flattened().iter().for_each(&mut note);
            }
            Self::CenterOfMass { target: point, .. } | Self::Gaze { point, .. } => {
                point.to_array().iter().for_each(&mut note);
            }
            Self::Posture { q } => q.iter().for_each(&mut note),
            Self::JointVelocities { .. }
            | Self::Manipulability { .. }
            | Self::LimitAvoidance { .. }
            | Self::Custom(_) => {}
        }
        moved
    }

    /// True for postures, joint velocities and gradients, which are of the lowest level in any case.
    #[must_use]
    pub const fn is_of_lowest_level(&self) -> bool {
        matches!(
            self,
            Self::Posture { .. }
                | Self::JointVelocities { .. }
                | Self::Manipulability { .. }
                | Self::LimitAvoidance { .. }
        )
    }

    /// The gradient of the task, with a gain of 1.
    fn secondary(&self) -> Option<SecondaryTask> {
        match *self {
            Self::Manipulability { .. } => Some(SecondaryTask::Manipulability { gain: 1.0 }),
            Self::LimitAvoidance { margin } => {
                Some(SecondaryTask::LimitAvoidance { gain: 1.0, margin })
            }
            _ => None,
        }
    }

    /// Memory for the gradient of the task.
    pub(super) fn gradient(&self, mechanism: &Mechanism, length: f64) -> Option<Gradient> {
        let velocities = match *self {
            Self::Manipulability { end_effector, components } => {
                SecondaryVelocities::new(mechanism, (end_effector, components), length)
            }
            Self::LimitAvoidance { .. } => SecondaryVelocities::of_all(mechanism),
            _ => return None,
        };
        Some(Gradient { velocities, now: vec![0.0; mechanism.n()] })
    }

    pub(super) fn needs_masses(&self) -> bool {
        matches!(self, Self::CenterOfMass { .. })
    }

    /// Refuses what does not belong to the mechanism, and non-finite numbers.
    pub(super) fn check(&self, mechanism: &Mechanism) -> Result<()> {
        match self {
            Self::Frame { end_effector, components, target } => {
                mechanism.check_frame(end_effector.frame)?;
                check_pose("tool of the frame", &end_effector.frame_from_tool)?;
                components.check()?;
                target.check()
            }
            Self::RelativeFrame { end_effector, reference, components, target } => {
                let (end_effector, reference) = (*end_effector, *reference);
                let (components, target) = (*components, *target);
                RelativeFrame { end_effector, reference, components, target }.check(mechanism)
            }
            Self::CenterOfMass { target, velocity, .. } => {
                let what = "target of the centre of mass";
                Error::check_within(what, &target.to_array(), MAX_MAGNITUDE)?;
                let what = "velocity of the centre of mass";
                Error::check_within(what, &velocity.to_array(), MAX_MAGNITUDE)
            }
            Self::Manipulability { end_effector, components } => {
                mechanism.check_frame(end_effector.frame)?;
                check_pose("tool of the frame", &end_effector.frame_from_tool)?;
                components.check()?;
                SecondaryTask::Manipulability { gain: 1.0 }.check(mechanism)
            }
            Self::LimitAvoidance { margin } => {
                SecondaryTask::LimitAvoidance { gain: 1.0, margin: *margin }.check(mechanism)
            }
            Self::Gaze { end_effector, point } => {
                Gaze { end_effector: *end_effector, point: *point }.check(mechanism)
            }
            Self::Posture { q } => mechanism.check_q("posture", q),
            Self::JointVelocities { velocities } => {
                mechanism.check_q("desired joint velocities", velocities)
            }
            Self::Custom(_) => Ok(()),
        }
    }

    /// Adds desired joint velocities of the lowest level; `stops` is the share of a gain at which a joint
    /// stops at a goal, of its way and the gain.
    pub(super) fn add_velocities(
        &self,
        state: &State,
        gradient: Option<&mut Gradient>,
        (gain, share): (f64, f64),
        stops: impl Fn(usize, f64, f64) -> f64,
        out: &mut [f64],
    ) {
        match (self, gradient) {
            (Self::Posture { q }, _) => {
                let ways = |each: &mut dyn FnMut(usize, f64)| {
                    posture_ways(state.mechanism(), state.q(), q, each);
                };
                let mut slowed = 1.0_f64;
                ways(&mut |i, way| slowed = slowed.min(stops(i, way, gain)));
                ways(&mut |i, way| out[i] += slowed * (share * gain) * way);
            }
            (Self::JointVelocities { velocities }, _) => {
                out.iter_mut().zip(velocities).for_each(|(o, v)| *o += share * v);
            }
            (_, Some(gradient)) => {
                let Some(secondary) = self.secondary() else { return };
                gradient.load(&secondary, state);
                out.iter_mut().zip(&gradient.now).for_each(|(o, v)| *o += share * gain * v);
            }
            _ => {}
        }
    }

    /// Writes the joint velocities that are still desired at `rates`: the way to a posture, the part
    /// of desired velocities that is not realised, or the gradient. False for other tasks.
    pub(super) fn remainder(
        &self,
        state: &State,
        gradient: Option<&Gradient>,
        rates: &[f64],
        out: &mut [f64],
    ) -> bool {
        out.fill(0.0);
        match (self, gradient) {
            (Self::Posture { q }, _) => {
                posture_ways(state.mechanism(), state.q(), q, |i, way| out[i] = way);
            }
            (Self::JointVelocities { velocities }, _) => {
                let parts = out.iter_mut().zip(velocities.iter().zip(rates));
                parts.for_each(|(o, (desired, rate))| *o = desired - rate);
            }
            (_, Some(gradient)) => out.copy_from_slice(&gradient.now),
            _ => return false,
        }
        true
    }

    /// Writes the rows at `state`; `name` is for errors.
    pub(super) fn evaluate(
        &mut self,
        name: &str,
        state: &State,
        scratch: &mut Scratch,
        rows: &mut Rows<'_>,
    ) -> Result<()> {
        rows.feed_forward.fill(0.0);
        match self {
            Self::Frame { end_effector, components, target } => {
                let pose = state.pose_of(*end_effector);
                let seen = |twist| components.seen(pose, twist);
                let error = seen(pose.error_to(target.pose));
                let forward = seen(target.feed_forward);
                state.tip(*end_effector).jacobian_into(components.axes, &mut scratch.jacobian);
                write(components.components, error, forward, &scratch.jacobian, rows);
            }
            Self::RelativeFrame { end_effector, reference, components, target } => {
                let (end_effector, reference) = (*end_effector, *reference);
                let (components, target) = (*components, *target);
                let task = RelativeFrame { end_effector, reference, components, target };
                let error = task.error(state);
                task.jacobian_into(state, &mut scratch.jacobian);
                write(components.components, error, Twist::ZERO, &scratch.jacobian, rows);
            }
            Self::CenterOfMass { axes, target, velocity } => {
                let Some(masses) = &mut scratch.masses else {
                    return Err(Error::InvalidOption {
                        option: "objective",
                        value: "centre of mass".to_owned(),
                        reason: "the servo was made without one; make another servo".to_owned(),
                    });
                };
                let (_, center) = masses.center_of_mass(state, &mut scratch.center)?;
                let error = (*target - center).to_array();
                let forward = velocity.to_array();
                for (row, axis) in (0..3).filter(|&axis| axes[axis]).enumerate() {
                    rows.error[row] = error[axis];
                    rows.feed_forward[row] = forward[axis];
                    for j in 0..scratch.center.cols() {
                        rows.jacobian[(row, j)] = scratch.center[(axis, j)];
                    }
                }
            }
            Self::Gaze { end_effector, point } => {
                let task = Gaze { end_effector: *end_effector, point: *point };
                rows.error.copy_from_slice(&task.error(state).to_array());
                task.jacobian_into(state, &mut scratch.jacobian, rows.jacobian);
            }
            Self::Posture { .. }
            | Self::JointVelocities { .. }
            | Self::Manipulability { .. }
            | Self::LimitAvoidance { .. } => {}
            Self::Custom(task) => {
                task.evaluate(state, rows.error, rows.jacobian)?;
                check_rows(name, rows, state.mechanism().n())?;
            }
        }
        Ok(())
    }
}

/// Checks the rows that a custom task wrote.
fn check_rows(name: &str, rows: &Rows<'_>, n: usize) -> Result<()> {
    let (m, jacobian) = (rows.error.len(), &rows.jacobian);
    let within = |x: &f64| x.abs() <= MAX_MAGNITUDE;
    if (jacobian.rows(), jacobian.cols()) == (m, n)
        && rows.error.iter().chain(jacobian.as_slice()).all(within)
    {
        return Ok(());
    }
    let what = |part: &str| format!("{part} of the task '{name}'");
    Error::check_len(&what("rows of the Jacobian"), m, jacobian.rows())?;
    Error::check_len(&what("columns of the Jacobian"), n, jacobian.cols())?;
    Error::check_within(&what("error"), rows.error, MAX_MAGNITUDE)?;
    Error::check_within(&what("Jacobian"), jacobian.as_slice(), MAX_MAGNITUDE)
}

/// The selected rows.
fn write(
    components: [bool; 6],
    error: Twist,
    forward: Twist,
    jacobian: &Matrix,
    rows: &mut Rows<'_>,
) {
    let (error, forward) = (error.to_array(), forward.to_array());
    for (row, i) in (0..6).filter(|&i| components[i]).enumerate() {
        rows.error[row] = error[i];
        rows.feed_forward[row] = forward[i];
        for j in 0..jacobian.cols() {
            rows.jacobian[(row, j)] = jacobian[(i, j)];
        }
    }
}
