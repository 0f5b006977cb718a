//! The batch of mobility and efficiencies that a sweep has as `measures`, and its metrics.
//!
//! Checked  tests/sweep/quantities.rs

use super::options::{SweepOptions, VelocityMetric};
use crate::closure::ClosedChain;
use crate::error::{Error, Result};
use crate::kinematics::EndEffector;
use crate::linalg::Matrix;
use crate::manipulability::{BatchOptions, ManipulabilityBatch, Metrics};
use crate::model::Mechanism;

/// Velocity limits of the actuated joints, which a metric of limits needs.
pub(super) fn velocity_limits(mechanism: &Mechanism, names: &[String]) -> Result<Vec<f64>> {
    let limit = |name: &String| {
        let limit = mechanism.limits_of(name).map(|l| l.velocity);
        limit.filter(|l| l.is_finite() && *l > 0.0).ok_or_else(|| Error::InvalidOption {
            option: "metric",
            value: "limits".to_owned(),
            reason: format!("joint '{name}' has no velocity limit; give it one, or use 'length'"),
        })
    };
    names.iter().map(limit).collect()
}

pub(super) fn measures(
    mechanism: &Mechanism,
    options: &SweepOptions,
    (end_effector, task): (EndEffector, &[usize]),
    length: f64,
) -> Result<ManipulabilityBatch> {
    let refuse = |option: &'static str, value: String, reason: &str| {
        Err(Error::InvalidOption { option, value, reason: reason.to_owned() })
    };
    if end_effector.frame_from_tool != crate::spatial::Pose::IDENTITY {
        let reason = "measures are those of a frame of the model; define one at this point";
        return refuse("tool", String::new(), reason);
    }
    let home = mechanism.state(mechanism.home())?;
    let chain = ClosedChain::of(&home, Some(end_effector.frame), Some(length))?;
    let mut metrics = match options.metric {
        VelocityMetric::Unit => Metrics::UNIT,
        _ => Metrics::characteristic_length(&chain.units, length)?,
    };
    if options.metric == VelocityMetric::Limits {
        metrics = metrics.with_velocity_limits(&velocity_limits(mechanism, &chain.actuated)?)?;
    }
    let task = options.task.map(|_| task_map(task, mechanism.dimension().components()));
    // The unit metric of a task is that of its own numbers.
    if let (Some(map), true) = (&task, options.metric != VelocityMetric::Unit) {
        metrics = metrics.for_task(map)?;
    }
    let reference = Some(end_effector.frame);
    let options = BatchOptions { reference, length: Some(length), metrics, task, generic: None };
    ManipulabilityBatch::new(mechanism, &options)
}

/// Components of the twist `all`, three in the plane, as a map.
fn task_map(components: &[usize], all: &[usize]) -> Matrix {
    let entry = |i: usize, j: usize| f64::from(u8::from(components[i] == all[j]));
    Matrix::from_fn(components.len(), all.len(), entry)
}
