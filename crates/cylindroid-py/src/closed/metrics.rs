//! Metrics and limits of the driven joints from what Python gives.

use cylindroid::closure::{Unit, Units};
use cylindroid::manipulability::Metrics;
use cylindroid::{Error, Matrix};

use super::PyConstraint;
use crate::arrays::Numbers;
use crate::error::{Failure, Result};

/// The metrics of a preset, and those that were given in its place.
pub(super) fn metrics(
    constraint: &PyConstraint,
    map: Option<&Matrix>,
    weights: [Option<&Numbers<'_>>; 4],
    metric: &str,
) -> Result<Metrics> {
    const PRESETS: [&str; 3] = ["unit", "length", "limits"];
    let mut metrics = Metrics::UNIT;
    if !PRESETS.contains(&metric) {
        return Err(Error::unknown("metric", metric, PRESETS).into());
    }
    if metric != "unit" {
        let units = task_units(constraint, map)?;
        metrics = Metrics::characteristic_length(&units, constraint.inner.length())?;
        if metric == "limits" {
            metrics = metrics.with_rate_limits(&limits(constraint, false)?)?;
        }
    }
    let [object, joint, wrench, torque] = weights;
    let set = |to: &mut Option<_>, name: &'static str, given: Option<&Numbers<'_>>| {
        if let Some(given) = given {
            *to = Some(given.metric(name)?);
        }
        Ok::<(), Failure>(())
    };
    set(&mut metrics.object, "Wu", object)?;
    set(&mut metrics.joint, "Wq", joint)?;
    set(&mut metrics.wrench, "Ww", wrench)?;
    set(&mut metrics.torque, "Wtau", torque)?;
    Ok(metrics)
}

/// Units with those of the task in place of the object's: each of its rows is of one kind.
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

/// The limits of the driven joints, of rates or torques, all finite.
pub(super) fn limits(constraint: &PyConstraint, torque: bool) -> Result<Vec<f64>> {
    let what = if torque { "effort" } else { "velocity" };
    let Some(origin) = &constraint.origin else {
        return Err(Failure::option("limits", "missing", "bare matrices have none; give them"));
    };
    let mechanism = origin.state.mechanism();
    let limit = |name: &String| {
        let tree = mechanism.coordinates().iter().find(|c| c.name == *name).map(|c| c.limits);
        let closing = mechanism.loops().iter().find(|l| l.name == *name).map(|l| l.limits);
        let limit = tree.or(closing).map(|l| if torque { l.effort } else { l.velocity });
        limit.filter(|v| v.is_finite() && *v > 0.0).ok_or_else(|| {
            Failure::option("limits", name, format!("the joint has no {what} limit; give limits"))
        })
    };
    constraint.actuated.iter().map(limit).collect()
}
