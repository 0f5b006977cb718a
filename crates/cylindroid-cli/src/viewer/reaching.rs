//! Configurations requested by a client, for one coordinate or all, with closed loops.

use cylindroid::closure::{ContinuationOptions, PathEnd, assemble, track_path};
use cylindroid::model::{Coordinate, CoordinateKind, Mechanism};
use cylindroid::{Error, Result, State};

use super::messages::Complaint;
use crate::commands::shared::within_limits;
use crate::output::number;

/// True if the coordinate can be set individually.
pub(super) fn is_adjustable(mechanism: &Mechanism, c: &Coordinate) -> bool {
    !mechanism.is_closed() || matches!(c.kind, CoordinateKind::Angle | CoordinateKind::Length)
}

/// The configuration reached, and the reason why a joint stopped early.
#[derive(Debug)]
pub(super) struct Reached {
    pub(super) q: Vec<f64>,
    pub(super) complaint: Option<Complaint>,
}

/// Moves the coordinate `name` to `value`, within limits and with closed loops; the other actuated
/// joints stay at rest if possible.
pub(super) fn reach(
    state: &State,
    name: &str,
    value: f64,
) -> std::result::Result<Reached, Complaint> {
    let mechanism = state.mechanism();
    let names = || mechanism.coordinates().iter().map(|c| c.name.as_str());
    let Some(i) = names().position(|n| n == name) else {
        return Err(Complaint::of("joint.name", &Error::unknown("joint", name, names())));
    };
    let c = &mechanism.coordinates()[i];
    if !is_adjustable(mechanism, c) {
        let what = format!(
            "coordinate '{name}' belongs to a multi-DOF joint and cannot be set individually"
        );
        return Err(Complaint::new("joint.name", name, &what, "move another joint, or the target"));
    }
    let (lower, upper, unit) = (c.limits.lower, c.limits.upper, c.kind.unit());
    // Path tracking through closed configurations takes steps, so their number is bounded.
    let most = match (mechanism.is_closed(), c.kind.is_length()) {
        (false, _) => f64::INFINITY,
        (true, true) => 2.0 * mechanism.reach(),
        (true, false) => std::f64::consts::TAU,
    };
    let here = state.q()[i];
    let (lower, upper) = (lower.max(here - most), upper.min(here + most));
    let goal = value.max(lower).min(upper);
    let beyond = (goal != value).then(|| {
        let what =
            format!("{name} = {value} is outside its limits or too far away for one message");
        let way_out = format!("give a value from {lower} to {upper} {unit}");
        Complaint::new("joint.value", &value.to_string(), &what, &way_out)
    });
    let (q, complaint) = if mechanism.is_closed() {
        let (q, end) = along(state, i, goal).map_err(|e| Complaint::of("joint.value", &e))?;
        let stop = sentence(mechanism, name, &end);
        let stop = stop.map(|(what, way_out)| {
            Complaint::new("joint.value", &value.to_string(), &what, way_out)
        });
        (q, stop.or(beyond))
    } else {
        let mut q = state.q().to_vec();
        q[i] = goal;
        (q, beyond)
    };
    let nearest = Some(q[i]);
    Ok(Reached { complaint: complaint.map(|c| Complaint { nearest, ..c }), q })
}

/// Path tracking on the branch of closed configurations, with the other actuated joints at rest or,
/// if that is contradictory, with only this coordinate prescribed.
fn along(state: &State, i: usize, goal: f64) -> Result<(Vec<f64>, PathEnd)> {
    let (mechanism, q) = (state.mechanism(), state.q());
    let mut prescribed: Vec<usize> = Vec::new();
    if mechanism.coordinates()[i].actuated {
        let whole = |&c: &usize| is_adjustable(mechanism, &mechanism.coordinates()[c]);
        prescribed = mechanism.actuated().filter(whole).collect();
    }
    for prescribed in [prescribed, vec![i]] {
        if !prescribed.contains(&i) {
            continue;
        }
        let goals: Vec<f64> =
            prescribed.iter().map(|&c| if c == i { goal } else { q[c] }).collect();
        let way = track_path(mechanism, q, &prescribed, &goals, ContinuationOptions::default())?;
        let contradicted = matches!(way.end, PathEnd::Contradiction | PathEnd::Open);
        if !contradicted || prescribed.len() == 1 {
            let closed = way.closure_error.is_closed(mechanism.reach());
            return Ok((if closed { way.q } else { q.to_vec() }, way.end));
        }
    }
    Ok((q.to_vec(), PathEnd::Contradiction))
}

/// Why a joint stopped, and what to do.
fn sentence(mechanism: &Mechanism, name: &str, end: &PathEnd) -> Option<(String, &'static str)> {
    Some(match end {
        PathEnd::Reached => return None,
        PathEnd::Singular(s) => (
            format!(
                "{name} stops before a singularity (distance {}), at which the other joints \
                 would no longer be determined ({})",
                number(s.distance),
                s.kind
            ),
            "approach from another side, or actuate other joints",
        ),
        PathEnd::Limit { coordinate } => {
            let c = &mechanism.coordinates()[*coordinate];
            let what = format!(
                "{name} stops because {} would exceed its limits, {} to {} {}",
                c.name,
                number(c.limits.lower),
                number(c.limits.upper),
                c.kind.unit()
            );
            (what, "move another joint first")
        }
        PathEnd::Open => (
            format!("the loops do not close with {name} at this value"),
            "reset, or move another joint first",
        ),
        PathEnd::Contradiction => (
            format!("the loops do not allow {name} to move"),
            "actuate fewer joints, or move the target",
        ),
        PathEnd::StepTooSmall => (
            format!("path tracking of {name} stopped: the step became too small"),
            "move it in smaller steps, or another joint first",
        ),
    })
}

/// Assembles loops and contacts starting from `q`, which must lie within the limits.
pub(super) fn assembled(mechanism: &Mechanism, q: &[f64]) -> Result<Vec<f64>> {
    mechanism.check_q("q", q)?;
    within_limits(mechanism, "q", q)?;
    closed(mechanism, q)
}

/// Assembles loops and contacts starting from `q`.
pub(super) fn closed(mechanism: &Mechanism, q: &[f64]) -> Result<Vec<f64>> {
    if !mechanism.is_closed() {
        return Ok(q.to_vec());
    }
    let found = assemble(mechanism, q, &[])?;
    if found.closed {
        return Ok(found.q);
    }
    Err(Error::InvalidOption {
        option: "q",
        value: format!(
            "loops open by {} m, {} rad",
            number(found.closure_error.distance),
            number(found.closure_error.angle)
        ),
        reason: "no closed configuration was found near it; start closer to a closed one"
            .to_owned(),
    })
}
