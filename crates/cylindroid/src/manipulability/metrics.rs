//! The four metrics of efficiencies (twists, joint velocities, wrenches, torques), and presets of
//! them.
//!
//! Formula  the page of [`Metrics`]
//! Shapes   W_u, W_w: d x d; W_q, W_tau: q_a x q_a
//! Units    an efficiency has the unit of `|u|^2 / |q|^2`; with lengths and angles only metrics
//!          that make both norms dimensionless (limits, a characteristic length) give efficiencies
//!          that do not change with the unit
//! Valid    positive definite. To leave components out use [`Relation::task`], not zero weights.
//! Source   Bicchi & Prattichizzo 1998, section 3; Doty, Melchiorri & Bonivento 1993 on units
//! Checked  tests/it/manipulability/metrics.rs
//!
//! [`Relation::task`]: crate::closure::Relation::task

use super::inertia::body_inertia;
use crate::closure::{Unit, Units};
use crate::error::{Error, Result};
use crate::kinematics::State;
use crate::linalg::{Matrix, Metric};
use crate::model::FrameId;
use crate::tolerance::LENGTHS;

/// Metrics of twists, joint velocities, wrenches and joint torques. `None` is the identity for
/// twists and velocities, and the dual for wrenches and torques.
///
/// ```text
/// |u|^2 = u^T W_u u,   |qd_a|^2 = qd_a^T W_q qd_a
/// |w|^2 = w^T W_w w,   |tau|^2 = tau^T W_tau tau,   by default W_w = W_u^-1, W_tau = W_q^-1
/// ```
///
/// `W_u` and `W_w` are d x d, `W_q` and `W_tau` have a row for each actuated joint; all are
/// symmetric and positive definite. With lengths beside angles, only metrics that make both norms
/// dimensionless (limits, a characteristic length) give efficiencies independent of the unit.
///
/// Source: Bicchi & Prattichizzo 1998, section 3; Doty, Melchiorri & Bonivento 1993 on units.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Metrics {
    /// W_u, of the object's twist or of the task.
    pub object: Option<Metric>,
    /// W_q, of the actuated joints.
    pub joint: Option<Metric>,
    /// W_w, of the wrench.
    pub wrench: Option<Metric>,
    /// W_tau, of the torques of the actuated joints.
    pub torque: Option<Metric>,
}

impl Metrics {
    /// The identity everywhere.
    pub const UNIT: Self = Self { object: None, joint: None, wrench: None, torque: None };

    /// With W_u, symmetric and positive definite: an inertia matrix measures twists by energy.
    ///
    /// ```
    /// use cylindroid::Matrix;
    /// use cylindroid::manipulability::Metrics;
    ///
    /// let metrics = Metrics::UNIT.with_object(&Matrix::diagonal(&[4.0, 4.0, 1.0]))?;
    /// assert!(metrics.is_dual()); // wrenches are measured by W_u^-1
    /// assert!(Metrics::UNIT.with_object(&Matrix::diagonal(&[1.0, -1.0])).is_err());
    /// # Ok::<(), cylindroid::Error>(())
    /// ```
    ///
    /// # Errors
    /// A matrix that is not symmetric and positive definite.
    pub fn with_object(mut self, w: &Matrix) -> Result<Self> {
        self.object = Some(Metric::new("Wu", w)?);
        Ok(self)
    }

    /// With W_q.
    ///
    /// # Errors
    /// As [`Metrics::with_object`].
    pub fn with_joint(mut self, w: &Matrix) -> Result<Self> {
        self.joint = Some(Metric::new("Wq", w)?);
        Ok(self)
    }

    /// With a separate W_w.
    ///
    /// # Errors
    /// As [`Metrics::with_object`].
    pub fn with_wrench(mut self, w: &Matrix) -> Result<Self> {
        self.wrench = Some(Metric::new("Ww", w)?);
        Ok(self)
    }

    /// With a separate W_tau.
    ///
    /// # Errors
    /// As [`Metrics::with_object`].
    pub fn with_torque(mut self, w: &Matrix) -> Result<Self> {
        self.torque = Some(Metric::new("Wtau", w)?);
        Ok(self)
    }

    /// Lengths measured in `length` (m), as are angles: efficiencies without unit. Of the units
    /// those of the object and of the actuated joints are read.
    ///
    /// ```
    /// use cylindroid::closure::{ClosedChain, MotionSpace};
    /// use cylindroid::manipulability::{Manipulability, Metrics};
    ///
    /// let arm = cylindroid::load("ur5e")?;
    /// let chain = ClosedChain::of(&arm.state(&[0.3, -1.1, 1.4, 0.2, 1.0, 0.4])?, None, None)?;
    /// let relation = MotionSpace::of(&chain.constraint).relation();
    /// let metrics = Metrics::characteristic_length(&chain.units, arm.reach())?;
    /// assert_eq!(Manipulability::of(&relation, &metrics)?.kinematic.values().len(), 6);
    /// # Ok::<(), cylindroid::Error>(())
    /// ```
    ///
    /// # Errors
    /// A length that is not one of [`LENGTHS`].
    pub fn characteristic_length(units: &Units, length: f64) -> Result<Self> {
        Error::check_range("length", length, &LENGTHS)?;
        let weight = (length * length).recip();
        let weights = |units: &[Unit]| -> Vec<f64> {
            units.iter().map(|u| if *u == Unit::Length { weight } else { 1.0 }).collect()
        };
        Ok(Self {
            object: Some(Metric::diagonal("Wu", &weights(&units.object))?),
            joint: Some(Metric::diagonal("Wq", &weights(&units.actuated))?),
            ..Self::UNIT
        })
    }

    /// Joint velocities relative to their limits: `|q| <= 1` is an ellipsoid within all of them.
    ///
    /// ```
    /// use cylindroid::manipulability::Metrics;
    ///
    /// let robot = cylindroid::load("panda")?;
    /// let limits: Vec<f64> = robot.coordinates().iter().map(|c| c.limits.velocity).collect();
    /// let metrics = Metrics::UNIT.with_velocity_limits(&limits)?;
    /// assert!(metrics.joint.is_some());
    /// # Ok::<(), cylindroid::Error>(())
    /// ```
    ///
    /// # Errors
    /// A limit that is not positive and finite.
    pub fn with_velocity_limits(mut self, limits: &[f64]) -> Result<Self> {
        self.joint = Some(of_limits("velocity limit", limits)?);
        Ok(self)
    }

    /// Torques relative to their limits. Forces are then no longer dual to motions: an actuator may
    /// be fast and weak.
    ///
    /// # Errors
    /// A limit that is not positive and finite.
    pub fn with_torque_limits(mut self, limits: &[f64]) -> Result<Self> {
        self.torque = Some(of_limits("torque limit", limits)?);
        Ok(self)
    }

    /// With W_u the inertia of the body that carries `frame` at the state, about the frame's
    /// origin and in world axes: twists are measured by twice their kinetic energy, wrenches by
    /// the accelerations that they give the free body.
    ///
    /// # Errors
    /// A frame of another mechanism; a body without mass, or whose inertia about some axis is
    /// zero.
    pub fn with_inertia(self, state: &State, frame: FrameId) -> Result<Self> {
        let mechanism = state.mechanism();
        mechanism.check_frame(frame)?;
        let link = &mechanism.links()[mechanism.frame_of(frame).link].name;
        let refuse = |what: &str| Error::Model {
            model: mechanism.name().to_owned(),
            culprit: link.clone(),
            message: format!(
                "link '{link}' {what}; write mass and inertia into the file ([[link]] in mechanism \
                 files), or give a metric Wu of twists"
            ),
        };
        let inertia = body_inertia(state, frame)?.ok_or_else(|| refuse("has no mass"))?;
        self.with_object(&inertia).map_err(|_| refuse("has no inertia about an axis"))
    }

    /// The same metrics for the task `T u` of [`Relation::task`]: the norm of a task velocity is
    /// that of the smallest twist with it, that of a task force is that of the wrench `T^T f`.
    /// Metrics of joints are unchanged.
    ///
    /// ```text
    /// W_u' = (T W_u^-1 T^T)^-1,   W_w' = T W_w T^T
    /// ```
    ///
    /// ```
    /// use cylindroid::Matrix;
    /// use cylindroid::closure::{ClosedChain, MotionSpace};
    /// use cylindroid::manipulability::{Manipulability, Metrics};
    ///
    /// // The position of the reference of a five-bar, two of the three components of its twist.
    /// let five_bar = cylindroid::load("five-bar")?;
    /// let chain = ClosedChain::of(&five_bar.state(five_bar.home())?, None, None)?;
    /// let position = Matrix::from_rows(&[[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]).unwrap();
    /// let relation = MotionSpace::of(&chain.constraint).relation().task(&position)?;
    /// let metrics = Metrics::characteristic_length(&chain.units, five_bar.reach())?;
    /// let found = Manipulability::of(&relation, &metrics.for_task(&position)?)?;
    /// assert_eq!(found.kinematic.values().len(), 2);
    /// # Ok::<(), cylindroid::Error>(())
    /// ```
    ///
    /// [`Relation::task`]: crate::closure::Relation::task
    ///
    /// # Errors
    /// A map of the wrong number of columns, with non-finite entries or with dependent rows.
    pub fn for_task(&self, map: &Matrix) -> Result<Self> {
        let unit = || Metric::diagonal("Wu", &vec![1.0; map.cols()]);
        let object = self.object.clone().map_or_else(unit, Ok)?;
        let wrench = match &self.wrench {
            Some(wrench) => Some(wrench.restricted("task", &map.transpose())?),
            None => None,
        };
        Ok(Self { object: Some(object.of_images("task", map)?), wrench, ..self.clone() })
    }

    /// True if wrenches and torques are measured by the duals of the metrics of motions: none of
    /// their own given, or just these.
    #[must_use]
    pub fn is_dual(&self) -> bool {
        let dual = |given: &Option<Metric>, of: &Option<Metric>| {
            given.is_none() || *given == of.as_ref().map(Metric::dual)
        };
        dual(&self.wrench, &self.object) && dual(&self.torque, &self.joint)
    }

    /// Diagonal ratio of the metrics of motions: a lower bound of their condition.
    pub(super) fn diagonal_ratio(&self) -> f64 {
        [&self.object, &self.joint].into_iter().flatten().map(Metric::diagonal_ratio).product()
    }

    /// Refuses metrics of the wrong size.
    pub(super) fn check(&self, joints: usize, object: usize) -> Result<()> {
        let all = [
            ("Wu", &self.object, object),
            ("Wq", &self.joint, joints),
            ("Ww", &self.wrench, object),
            ("Wtau", &self.torque, joints),
        ];
        for (name, metric, expected) in all {
            if let Some(metric) = metric {
                Error::check_len(name, expected, metric.len())?;
            }
        }
        Ok(())
    }

    /// W_w in effect.
    pub(super) fn of_wrench(&self) -> Option<Metric> {
        self.wrench.clone().or_else(|| self.object.as_ref().map(Metric::dual))
    }

    /// W_tau in effect.
    pub(super) fn of_torque(&self) -> Option<Metric> {
        self.torque.clone().or_else(|| self.joint.as_ref().map(Metric::dual))
    }
}

fn of_limits(name: &'static str, limits: &[f64]) -> Result<Metric> {
    for &limit in limits {
        if !(limit > 0.0 && limit.is_finite()) {
            return Err(Error::InvalidOption {
                option: name,
                value: limit.to_string(),
                reason: "limits used as a metric must be positive and finite; give one for each \
                         actuated joint"
                    .to_owned(),
            });
        }
    }
    Metric::diagonal(name, &limits.iter().map(|l| (l * l).recip()).collect::<Vec<_>>())
}
