//! Joint moves: all joints move straight to another configuration, starting and stopping together.
//!
//! Formula  the page of [`JointMove`]
//! Shapes   n positions, n velocities, n bounds        Units  rad or m by the kind of the joint
//! Valid    any displacement; joints at rest impose no bound, and if all rest the law has duration
//!          zero. Time-optimal along the straight line in joint space
//! Fails    on inconsistent lengths, non-finite values, bounds that `TimeLaw` rejects
//! Why so   one law for all joints keeps the path straight; a law for each joint, scaled to the
//!          slowest, can be faster if different joints limit velocity and acceleration, but it
//!          curves the path, and collision checks and teaching assume a straight one
//! Source   Biagiotti & Melchiorri 2008, chapter 3
//! Checked  tests/motion/moves.rs::joint_*

use super::path::within;
use super::time_law::{KinematicBounds, LawSample, TimeLaw};
use crate::control::servo::SpeedLimit;
use crate::error::{Error, Result};
use crate::kinematics::{Chain, EndEffector, ReferenceFrame};
use crate::linalg::{Matrix, norm};
use crate::model::{CoordinateKind, Mechanism};
use crate::scalar::clamp;

/// Sum of the turns of all joints between two places at which the speed of the tool is computed (rad), and
/// number of these places.
const TURN: f64 = 0.01;
const PLACES: (f64, f64) = (100.0, 1e5);

/// Share by which the tool may be faster between two of them [-].
const BETWEEN: f64 = 1e-3;

/// The longest duration of a move (s): sums of a few do not overflow.
const LONGEST: f64 = 1e307;

/// The straight motion of all joints from one configuration to another, over s in [0, 1].
#[derive(Debug, Clone, PartialEq)]
pub struct JointPath {
    from: Vec<f64>,
    to: Vec<f64>,
    displacement: Vec<f64>,
}

impl JointPath {
    /// From one configuration to another, n joints each [rad or m].
    ///
    /// # Errors
    /// Different lengths, or a non-finite entry (or difference).
    pub fn new(from: &[f64], to: &[f64]) -> Result<Self> {
        Error::check_len("end of the joint path", from.len(), to.len())?;
        Error::check_finite("start of the joint path", from)?;
        Error::check_finite("end of the joint path", to)?;
        let displacement: Vec<f64> = to.iter().zip(from).map(|(b, a)| b - a).collect();
        Error::check_finite("displacement of the joint path", &displacement)?;
        Ok(Self { from: from.to_vec(), to: to.to_vec(), displacement })
    }

    /// Number of joints.
    #[must_use]
    pub fn dof(&self) -> usize {
        self.from.len()
    }

    /// `d positions / ds`, from start to end: n entries [rad or m], the same at every s.
    #[must_use]
    pub fn displacement(&self) -> &[f64] {
        &self.displacement
    }

    /// The positions [rad or m] at `s`, clamped to [0, 1]; NaN counts as 0.
    ///
    /// # Errors
    /// A slice whose length is not [`Self::dof`].
    pub fn position_into(&self, s: f64, positions: &mut [f64]) -> Result<()> {
        Error::check_len("positions", self.dof(), positions.len())?;
        let s = within(s);
        for (i, position) in positions.iter_mut().enumerate() {
            // From the closer end: exact at both, without overshoot.
            *position = if s > 0.5 {
                self.to[i] - self.displacement[i] * (1.0 - s)
            } else {
                self.from[i] + self.displacement[i] * s
            };
        }
        Ok(())
    }
}

/// All joints moving straight to another configuration, starting and stopping together.
///
/// ```text
/// q_i = from_i + s d_i,   s' <= v_i / |d_i|,   s'' <= a_i / |d_i|,   s''' <= j_i / |d_i|
/// ```
///
/// One time law s from 0 to 1 for all joints, bounded by the most restrictive one: the path is
/// straight in joint space, and time-optimal along it. Units: rad or m.
///
/// Source: Biagiotti & Melchiorri 2008, chapter 3.
#[derive(Debug, Clone, PartialEq)]
pub struct JointMove {
    path: JointPath,
    law: TimeLaw,
}

/// Default bounds of joints without limits in the model, and the jerk of all joints.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct JointDefaults {
    /// For revolute joints (rad).
    pub angle: KinematicBounds,
    /// For prismatic joints (m).
    pub length: KinematicBounds,
}

/// Output of [`JointMove::sample_into`], n entries each.
#[derive(Debug)]
pub struct JointSample<'a> {
    /// Positions [rad or m].
    pub positions: &'a mut [f64],
    /// Velocities [rad/s or m/s].
    pub velocities: &'a mut [f64],
}

impl JointMove {
    /// The move along `path` within the bounds of each joint (n of them, in the joint's unit).
    ///
    /// ```
    /// use cylindroid::control::{JointMove, JointPath, JointSample, KinematicBounds};
    ///
    /// // The second joint moves farther: it bounds the speed of both.
    /// let path = JointPath::new(&[0.0, 0.0], &[0.5, 1.0])?;
    /// let bound = KinematicBounds { velocity: 1.0, acceleration: 2.0, jerk: f64::INFINITY };
    /// let motion = JointMove::new(path, &[bound, bound])?;
    /// assert_eq!(motion.law().duration(), 1.5); // 1 / v + v / a
    /// let (mut positions, mut velocities) = ([0.0; 2], [0.0; 2]);
    /// let out = JointSample { positions: &mut positions, velocities: &mut velocities };
    /// motion.sample_into(0.75, out)?;
    /// assert_eq!((positions, velocities), ([0.25, 0.5], [0.5, 1.0]));
    /// # Ok::<(), cylindroid::Error>(())
    /// ```
    ///
    /// # Errors
    /// A number of bounds other than the number of joints; bounds that are NaN, zero or negative,
    /// or that leave both acceleration and jerk infinite.
    pub fn new(path: JointPath, bounds: &[KinematicBounds]) -> Result<Self> {
        Error::check_len("bounds", path.dof(), bounds.len())?;
        Self::named(path, bounds, |i| format!("joint {i}"))
    }

    fn named(
        path: JointPath,
        bounds: &[KinematicBounds],
        name: impl Fn(usize) -> String,
    ) -> Result<Self> {
        let mut tightest = KinematicBounds::NONE;
        for (i, (bound, displacement)) in bounds.iter().zip(path.displacement()).enumerate() {
            bound.check(&name(i))?;
            tightest = tightest.tightest(bound.over(displacement.abs()));
        }
        Ok(Self { path, law: TimeLaw::along(tightest)? })
    }

    /// The fastest straight move from `q` to `to` within the joint limits of a mechanism: position
    /// limits form a box, so a path between two points within it stays within it. The limits of
    /// joints at rest, which may be 0, are ignored.
    ///
    /// ```
    /// use cylindroid::control::{JointDefaults, JointMove, KinematicBounds};
    ///
    /// let robot = cylindroid::load("ur5e")?;
    /// let default = KinematicBounds { velocity: 1.0, acceleration: 4.0, jerk: 40.0 };
    /// let defaults = JointDefaults { angle: default, length: default };
    /// let to = [0.5, -1.0, 1.2, 0.3, 0.4, 0.5];
    /// let motion = JointMove::within_limits(&robot, robot.home(), &to, &defaults)?;
    /// assert!(motion.scaled_to_duration(20.0)?.law().duration() > 19.9);
    /// # Ok::<(), cylindroid::Error>(())
    /// ```
    ///
    /// # Errors
    /// Configurations of the wrong size, non-finite or outside position limits; a displacement of a
    /// spherical or free joint, which has no straight path, or of a joint whose limits permit no
    /// motion; default bounds that are not positive.
    pub fn within_limits(
        mechanism: &Mechanism,
        q: &[f64],
        to: &[f64],
        defaults: &JointDefaults,
    ) -> Result<Self> {
        mechanism.check_q("start of the joint move", q)?;
        mechanism.check_q("end of the joint move", to)?;
        for (option, end) in [("start of the joint move", q), ("end of the joint move", to)] {
            check_limits(mechanism, option, end)?;
        }
        let path = JointPath::new(q, to)?;
        let mut bounds = Vec::with_capacity(path.dof());
        for (coordinate, displacement) in mechanism.coordinates().iter().zip(path.displacement()) {
            let default = match coordinate.kind {
                CoordinateKind::Angle => defaults.angle,
                CoordinateKind::Length => defaults.length,
                CoordinateKind::RotationVector | CoordinateKind::Position
                    if *displacement != 0.0 =>
                {
                    return Err(Error::InvalidOption {
                        option: "joint move",
                        value: coordinate.name.clone(),
                        reason: "spherical and free joints have no straight motion between two \
                                 configurations; drive a frame instead"
                            .to_owned(),
                    });
                }
                CoordinateKind::RotationVector | CoordinateKind::Position => defaults.angle,
            };
            let own = |limit: f64, default: f64| {
                if limit.is_finite() && *displacement != 0.0 { limit } else { default }
            };
            bounds.push(KinematicBounds {
                velocity: own(coordinate.limits.velocity, default.velocity),
                acceleration: own(coordinate.limits.acceleration, default.acceleration),
                jerk: own(coordinate.limits.jerk, default.jerk).min(default.jerk),
            });
        }
        Self::named(path, &bounds, |i| format!("joint '{}'", mechanism.coordinates()[i].name))
    }

    /// The same move slowed down to end at `duration` (s).
    ///
    /// # Errors
    /// A duration shorter than that of the move, or not finite.
    pub fn scaled_to_duration(self, duration: f64) -> Result<Self> {
        Ok(Self { law: self.law.scaled_to_duration(duration)?, ..self })
    }

    /// The same move slowed down, if need be, such that the tool keeps its largest speeds: the duration
    /// grows as they shrink.
    ///
    /// ```
    /// use cylindroid::control::{JointDefaults, JointMove, KinematicBounds, SpeedLimit};
    ///
    /// let robot = cylindroid::load("ur5e")?;
    /// let default = KinematicBounds { velocity: 1.0, acceleration: 4.0, jerk: 40.0 };
    /// let defaults = JointDefaults { angle: default, length: default };
    /// let to = [0.5, -1.0, 1.2, 0.3, 0.4, 0.5];
    /// let motion = JointMove::within_limits(&robot, robot.home(), &to, &defaults)?;
    /// let speed = SpeedLimit { linear: 0.05, angular: f64::INFINITY };
    /// let slow = motion.clone().within_tool_speed(&robot, robot.tool(), speed)?;
    /// assert!(slow.law().duration() > 2.0 * motion.law().duration());
    /// # Ok::<(), cylindroid::Error>(())
    /// ```
    ///
    /// # Errors
    /// A path or a frame of another mechanism.
    pub fn within_tool_speed(
        self,
        mechanism: &Mechanism,
        end_effector: impl Into<EndEffector>,
        speed: SpeedLimit,
    ) -> Result<Self> {
        if speed.linear == f64::INFINITY && speed.angular == f64::INFINITY {
            return Ok(self);
        }
        let (duration, fastest) = (self.law.duration(), self.law.extrema().velocity);
        let excess = fastest * self.largest_speed(mechanism, end_effector.into(), speed)?;
        if !(excess > 1.0) {
            return Ok(self);
        }
        self.scaled_to_duration((duration * excess).min(LONGEST.max(duration)))
    }

    /// The largest speed of the tool where s' = 1, over the speeds that it may have (s).
    fn largest_speed(
        &self,
        mechanism: &Mechanism,
        end_effector: EndEffector,
        speed: SpeedLimit,
    ) -> Result<f64> {
        let (path, d) = (&self.path, self.path.displacement());
        mechanism.check_q("displacement of the joint path", d)?;
        let mut chain = Chain::new(mechanism, end_effector)?;
        let own: Vec<f64> = chain.coordinates().iter().map(|&c| d[c]).collect();
        let turns = chain.coordinates().iter().zip(&own);
        let turns =
            turns.filter(|(c, _)| mechanism.coordinates()[**c].kind == CoordinateKind::Angle);
        let turn: f64 = turns.map(|(_, d)| d.abs()).sum();
        let places = clamp((turn / TURN).ceil(), PLACES.0, PLACES.1);
        let (mut jacobian, mut twist) = (Matrix::zeros(6, chain.n()), [0.0; 6]);
        let (mut q, mut most) = (vec![0.0; path.dof()], 0.0_f64);
        for place in 0..=places as u32 {
            path.position_into(f64::from(place) / places, &mut q)?;
            chain.set(&q);
            chain.jacobian_into(ReferenceFrame::LocalWorldAligned, &mut jacobian);
            jacobian.mul_vec_into(&own, &mut twist);
            let (linear, angular) = twist.split_at(3);
            most = most.max(norm(linear) / speed.linear).max(norm(angular) / speed.angular);
        }
        Ok(most * (1.0 + BETWEEN))
    }

    /// The path.
    #[must_use]
    pub fn path(&self) -> &JointPath {
        &self.path
    }

    /// The law of the path coordinate, from 0 to 1.
    #[must_use]
    pub fn law(&self) -> &TimeLaw {
        &self.law
    }

    /// Computes the state at time `t` (s), without allocation; at rest at the start before 0 and at
    /// the end after the duration. Returns the path coordinate s and its derivatives.
    ///
    /// # Errors
    /// A slice whose length is not the number of joints; the output is then unchanged.
    pub fn sample_into(&self, t: f64, out: JointSample<'_>) -> Result<LawSample> {
        Error::check_len("velocities", self.path.dof(), out.velocities.len())?;
        let s = self.law.at(t);
        self.path.position_into(s.position, out.positions)?;
        for (velocity, displacement) in out.velocities.iter_mut().zip(self.path.displacement()) {
            *velocity = displacement * s.velocity;
        }
        Ok(s)
    }
}

/// Rejects positions outside the limits, naming the first joint.
fn check_limits(mechanism: &Mechanism, option: &'static str, q: &[f64]) -> Result<()> {
    let Some(i) = mechanism.outside_limits(q).next() else { return Ok(()) };
    let c = &mechanism.coordinates()[i];
    let (lower, upper, unit) = (c.limits.lower, c.limits.upper, c.kind.unit());
    Err(Error::InvalidOption {
        option,
        value: format!("{} at {} {unit}", c.name, q[i]),
        reason: format!("its limits are {lower} and {upper} {unit}; move it within them"),
    })
}
