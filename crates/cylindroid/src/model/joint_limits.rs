//! Limits of joints in place of those of the model, by name.
//!
//! Valid    positions are narrowed only: the file knows where a joint stops. Velocities, accelerations,
//!          jerks and efforts may also be larger than those of the model, and given where it has none
//! Why so   MJCF has no limits of velocities and accelerations, URDF none of accelerations, and an
//!          application rarely permits what the maker does
//! Checked  tests/formats/joint_limits.rs

use std::sync::Arc;

use super::joint::{Joint, JointKind, Limits};
use super::joint_spec::fault;
use super::mechanism::{Data, Mechanism};
use crate::error::{Error, Result};
use crate::scalar::clamp;

/// Limits of a joint that replace those of its model; `None` keeps the model's.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct JointLimits {
    /// Smallest position, not below that of the model [rad or m].
    pub lower: Option<f64>,
    /// Largest position, not above that of the model [rad or m].
    pub upper: Option<f64>,
    /// Largest speed [rad/s or m/s].
    pub velocity: Option<f64>,
    /// Largest acceleration [rad/s^2 or m/s^2].
    pub acceleration: Option<f64>,
    /// Largest jerk [rad/s^3 or m/s^3].
    pub jerk: Option<f64>,
    /// Largest torque or force [N m or N].
    pub effort: Option<f64>,
}

impl JointLimits {
    /// The names of the limits, in the order of the fields.
    pub const NAMES: [&'static str; 6] =
        ["lower", "upper", "velocity", "acceleration", "jerk", "effort"];

    /// The limit of this name; infinite for no limit.
    ///
    /// # Errors
    /// [`Error::UnknownName`] with the nearest names.
    pub fn with(mut self, name: &str, value: f64) -> Result<Self> {
        let limit = match name {
            "lower" => &mut self.lower,
            "upper" => &mut self.upper,
            "velocity" => &mut self.velocity,
            "acceleration" => &mut self.acceleration,
            "jerk" => &mut self.jerk,
            "effort" => &mut self.effort,
            _ => return Err(Error::unknown("limit", name, Self::NAMES)),
        };
        *limit = Some(value);
        Ok(self)
    }

    fn replace(&self, limits: &mut Limits) {
        let set = |to: &mut f64, value: Option<f64>| *to = value.unwrap_or(*to);
        set(&mut limits.lower, self.lower);
        set(&mut limits.upper, self.upper);
        set(&mut limits.velocity, self.velocity);
        set(&mut limits.acceleration, self.acceleration);
        set(&mut limits.jerk, self.jerk);
        set(&mut limits.effort, self.effort);
    }
}

impl Mechanism {
    /// The same mechanism with other limits of joints of the tree, of their coordinates, or of loop
    /// joints. Positions can only be narrowed; the home configuration of a tree is moved within
    /// them. Joints that follow another one keep their velocity, acceleration and jerk limits.
    ///
    /// ```
    /// use cylindroid::model::JointLimits;
    ///
    /// let slow = JointLimits { velocity: Some(0.5), acceleration: Some(5.0), ..Default::default() };
    /// let ur5e = cylindroid::load("ur5e")?.with_limits(&[("wrist_1_joint", slow)])?;
    /// assert_eq!(ur5e.limits_of("wrist_1_joint").unwrap().acceleration, 5.0);
    /// let error = ur5e.with_limits(&[("wrist_1", slow)]).unwrap_err().to_string();
    /// assert!(error.contains("nearest: wrist_1_joint"));
    /// # Ok::<(), cylindroid::Error>(())
    /// ```
    ///
    /// # Errors
    /// [`Error::UnknownName`] with the nearest names; [`Error::InvalidOption`] for positions beyond
    /// those of the model, contradictory limits, a fixed joint or a mimic joint.
    pub fn with_limits<S: AsRef<str>>(&self, limits: &[(S, JointLimits)]) -> Result<Self> {
        let mut data = Data::clone(&self.data);
        for (name, given) in limits {
            data.limit(name.as_ref(), given)?;
        }
        if !self.is_closed() {
            for (x, c) in data.home.iter_mut().zip(&data.coordinates) {
                *x = clamp(*x, c.limits.lower, c.limits.upper);
            }
        }
        Ok(Self { data: Arc::new(data) })
    }

    /// The same mechanism without position limits.
    pub(crate) fn without_position_limits(&self) -> Self {
        let mut data = Data::clone(&self.data);
        let joints = data.joints.iter_mut().map(|j| &mut j.limits);
        for limits in joints.chain(data.coordinates.iter_mut().map(|c| &mut c.limits)) {
            (limits.lower, limits.upper) = (f64::NEG_INFINITY, f64::INFINITY);
        }
        Self { data: Arc::new(data) }
    }
}

impl Data {
    fn limit(&mut self, name: &str, given: &JointLimits) -> Result<()> {
        let refuse = |reason: String| {
            Err(Error::InvalidOption { option: "limits", value: name.to_owned(), reason })
        };
        let dimension = self.dimension;
        let check = |kind: JointKind, axis, old: &Limits, new: &Limits| {
            if new.lower < old.lower || new.upper > old.upper {
                return refuse(format!(
                    "its position limits are {} and {}; they can be narrowed only",
                    old.lower, old.upper
                ));
            }
            fault(name, kind, axis, new, dimension).map_or(Ok(()), refuse)
        };
        if let Some(joint) = self.joints.iter_mut().find(|j| j.name == name) {
            if let Some(mimic) = &joint.mimic {
                return refuse(format!("it follows '{}'; name that joint", mimic.joint));
            }
            if joint.kind.dof() == 0 {
                return refuse("it is fixed; name a movable joint".to_owned());
            }
            let own = &mut self.coordinates[joint.coordinates.clone()];
            for c in own.iter_mut() {
                let old = c.limits;
                given.replace(&mut c.limits);
                check(joint.kind, joint.axis, &old, &c.limits)?;
            }
            given.replace(&mut joint.limits);
        } else if let Some(joint) = self.loops.iter_mut().find(|l| l.name == name) {
            if joint.kind.dof() == 0 {
                return refuse("it is fixed; name a movable joint".to_owned());
            }
            let old = joint.limits;
            given.replace(&mut joint.limits);
            return check(joint.kind, joint.axis, &old, &joint.limits);
        } else if let Some(c) = self.coordinates.iter_mut().find(|c| c.name == name) {
            let old = c.limits;
            given.replace(&mut c.limits);
            let joint = &self.joints[c.joint];
            check(joint.kind, joint.axis, &old, &c.limits)?;
        } else {
            let moving = self.joints.iter().filter(|j| j.kind.dof() > 0 && j.mimic.is_none());
            let known = moving.map(|j| &j.name).chain(self.loops.iter().map(|l| &l.name));
            return Err(Error::unknown("joint", name, known));
        }
        // Joints that follow have limits of their own.
        let Self { joints, coordinates, .. } = self;
        for follower in joints.iter() {
            let Joint { limits, mimic: Some(mimic), .. } = follower else { continue };
            if mimic.joint == name {
                let ratio = mimic.multiplier.abs();
                for c in &mut coordinates[follower.coordinates.clone()] {
                    c.limits.velocity = c.limits.velocity.min(limits.velocity / ratio);
                    c.limits.acceleration = c.limits.acceleration.min(limits.acceleration / ratio);
                    c.limits.jerk = c.limits.jerk.min(limits.jerk / ratio);
                }
            }
        }
        Ok(())
    }
}
