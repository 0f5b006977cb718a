//! Metrics of twists and joint velocities, and limits of actuated joints, from Python arguments.

use cylindroid::closure::{Unit, Units};
use cylindroid::linalg::Metric;
use cylindroid::manipulability::Metrics;
use cylindroid::{Error, Matrix};
use pyo3::prelude::*;

use super::PyConstraint;
use crate::arrays::Numbers;
use crate::error::{Failure, Result};

/// Arguments of a manipulability analysis: components of the object's twist, and metrics.
#[derive(Debug)]
pub(super) struct Question {
    pub(super) map: Option<Matrix>,
    pub(super) components: Vec<String>,
    pub(super) preset: String,
    /// Metrics that override those of the preset.
    given: Metrics,
    /// Of contact forces.
    contact: Option<Metric>,
    /// True if joint velocities are measured by the inertia of the mechanism.
    joint_inertia: bool,
}

/// A metric of joint velocities: numbers, or 'inertia'.
#[derive(Debug, FromPyObject)]
pub(super) enum JointMetric<'py> {
    Name(String),
    Numbers(Numbers<'py>),
}

impl<'py> JointMetric<'py> {
    /// The numbers, if there are any.
    pub(super) fn numbers(given: Option<&Self>) -> Option<&Numbers<'py>> {
        match given? {
            Self::Numbers(numbers) => Some(numbers),
            Self::Name(_) => None,
        }
    }
}

impl Question {
    /// For constraints of the shape and units of this one; `weights` are Wu, Wq, Ww, Wtau.
    pub(super) fn about(
        constraint: &PyConstraint,
        task: Option<&Bound<'_, PyAny>>,
        weights: [Option<&Numbers<'_>>; 4],
        preset: &str,
    ) -> Result<Self> {
        const PRESETS: [&str; 3] = ["unit", "length", "limits"];
        if !PRESETS.contains(&preset) {
            return Err(Error::unknown("metric", preset, PRESETS).into());
        }
        let (map, components) = match task {
            None => (None, constraint.component_names()),
            Some(task) => {
                let (map, names) = constraint.task(task)?;
                (Some(map), names)
            }
        };
        let [object, joint, wrench, torque] = weights;
        let of = |name, given: Option<&Numbers<'_>>| given.map(|w| w.metric(name)).transpose();
        let given = Metrics {
            object: of("Wu", object)?,
            joint: of("Wq", joint)?,
            wrench: of("Ww", wrench)?,
            torque: of("Wtau", torque)?,
        };
        Ok(Self {
            map,
            components,
            preset: preset.to_owned(),
            given,
            contact: None,
            joint_inertia: false,
        })
    }

    /// With the inertia of the mechanism as the metric of joint velocities, if that is asked for.
    pub(super) fn with_joint_metric(mut self, given: Option<&JointMetric<'_>>) -> Result<Self> {
        if let Some(JointMetric::Name(name)) = given {
            if name != "inertia" {
                return Err(Error::unknown("metric of joint velocities", name, ["inertia"]).into());
            }
            self.joint_inertia = true;
        }
        Ok(self)
    }

    /// With a metric of contact forces, Wt.
    pub(super) fn with_contact_metric(mut self, given: Option<&Numbers<'_>>) -> Result<Self> {
        self.contact = given.map(|w| w.metric("Wt")).transpose()?;
        Ok(self)
    }

    /// The metric of contact forces: with a preset other than 'unit', moments are divided by the
    /// characteristic length.
    pub(super) fn contact_metric(&self, constraint: &PyConstraint) -> Result<Option<Metric>> {
        if self.contact.is_some() || self.preset == "unit" {
            return Ok(self.contact.clone());
        }
        let length = constraint.inner.length();
        let weight = |unit: &Unit| match unit {
            Unit::Length => 1.0,
            Unit::Angle => (length * length).recip(),
        };
        let weights: Vec<f64> = constraint.units.rows.iter().map(weight).collect();
        Ok(Some(Metric::diagonal("Wt", &weights)?))
    }

    /// The metrics for this constraint.
    pub(super) fn metrics(&self, constraint: &PyConstraint) -> Result<Metrics> {
        let mut metrics = Metrics::UNIT;
        if self.preset != "unit" {
            let units = task_units(constraint, self.map.as_ref())?;
            metrics = Metrics::characteristic_length(&units, constraint.inner.length())?;
            if self.preset == "limits" {
                metrics = metrics.with_velocity_limits(&limits(constraint, false)?)?;
            }
        }
        if self.joint_inertia {
            let Some(origin) = &constraint.origin else {
                let reason = "bare matrices have no masses; give a matrix";
                return Err(Failure::option("Wq", "inertia", reason));
            };
            metrics = metrics.with_joint_inertia(&origin.state)?;
        }
        let given = self.given.clone();
        Ok(Metrics {
            object: given.object.or(metrics.object),
            joint: given.joint.or(metrics.joint),
            wrench: given.wrench.or(metrics.wrench),
            torque: given.torque.or(metrics.torque),
        })
    }
}

/// The units with those of the task in place of the object's; a row must not mix lengths and
/// angles.
fn task_units(constraint: &PyConstraint, map: Option<&Matrix>) -> Result<Units> {
    let Some(map) = map else { return Ok(constraint.units.clone()) };
    let row = |i: usize| {
        let mut used = (0..map.cols()).filter(|&j| map[(i, j)] != 0.0);
        let first = used.next().map_or(Unit::Angle, |j| constraint.units.object[j]);
        if used.all(|j| constraint.units.object[j] == first) {
            return Ok(first);
        }
        let reason = "a row of the task mixes lengths and angles; give Wu and Wq";
        Err(Failure::option("metric", "length", reason))
    };
    let object = (0..map.rows()).map(row).collect::<Result<Vec<Unit>>>()?;
    Ok(Units { object, ..constraint.units.clone() })
}

/// The velocity or torque limits of the actuated joints, all finite.
pub(super) fn limits(constraint: &PyConstraint, torque: bool) -> Result<Vec<f64>> {
    let what = if torque { "effort" } else { "velocity" };
    let Some(origin) = &constraint.origin else {
        return Err(Failure::option("limits", "", "bare matrices have none; give them"));
    };
    let mechanism = origin.state.mechanism();
    let limit = |name: &String| {
        let limit = mechanism.limits_of(name).map(|l| if torque { l.effort } else { l.velocity });
        limit.filter(|v| v.is_finite() && *v > 0.0).ok_or_else(|| {
            Failure::option("limits", name, format!("the joint has no {what} limit; give limits"))
        })
    };
    constraint.actuated.iter().map(limit).collect()
}
