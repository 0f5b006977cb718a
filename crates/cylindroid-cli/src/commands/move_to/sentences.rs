//! The end of a motion in full sentences: the cause, with names and values, and the remedy.

use std::collections::BTreeSet;

use cylindroid::ReferenceFrame;
use cylindroid::control::{LimitKind, MotionResult, Plant, Stall, Task};
use cylindroid::model::Mechanism;

use super::job::{Goal, Job};
use crate::output::number;

/// The cause as one word: "reached", a [`Stall::name`], "slowed" of a twist, or "time-limit".
pub(super) fn reason(outcome: &MotionResult) -> &'static str {
    match &outcome.stall {
        _ if outcome.reached => "reached",
        Some(stall) => stall.name(),
        None if outcome.is_slowed() => "slowed",
        None => "time-limit",
    }
}

/// The reason of a reconfiguration.
pub(super) fn reconfigured(job: &Job, stalled: &MotionResult) -> String {
    let what = match &stalled.stall {
        Some(Stall::Limits { coordinates }) => {
            let names: Vec<&str> =
                coordinates.iter().map(|&i| job.robot.coordinates()[i].name.as_str()).collect();
            format!("at the limit of {}", names.join(", "))
        }
        Some(Stall::Singular { .. }) => "in a singular configuration".to_owned(),
        Some(Stall::NoInverse(_)) => "where the inverse does not exist".to_owned(),
        Some(Stall::Projected { .. }) => {
            "with only the component left that the inverse discards".to_owned()
        }
        Some(Stall::TypeII { .. }) => "before a type II singularity".to_owned(),
        Some(Stall::Slow | Stall::TooFewJoints { .. } | Stall::OutOfReach { .. }) | None => {
            "without progress".to_owned()
        }
    };
    let components = job.options.task.components;
    let mut left = Vec::new();
    if components[..3].contains(&true) {
        left.push(format!("{} m", number(stalled.last.position_error)));
    }
    if components[3..].contains(&true) {
        left.push(format!("{} rad", number(stalled.last.orientation_error)));
    }
    let ideal = match job.options.plant {
        Plant::IDEAL => "",
        _ => {
            " The joint motion is that of an ideal robot; delay, time constant and noise act on the \
             servo at its end."
        }
    };
    format!(
        "Moving straight towards the target, the servo would stall {} before it, {what}. The robot \
         reconfigured instead: every joint moved straight to another configuration that reaches \
         the target (--no-reconfigure keeps the motion of the servo).{ideal}",
        left.join(" and "),
    )
}

/// The cause as sentences.
pub(super) fn explanation(
    job: &Job,
    outcome: &MotionResult,
    other_configuration: Option<&[f64]>,
) -> String {
    let mut text = match &outcome.stall {
        _ if outcome.reached => {
            let end = match &job.goal {
                Goal::Twist(_) => "The tool followed the twist, then stopped.",
                _ => "The target was reached.",
            };
            return format!("{end}{}", without_inverse(outcome));
        }
        None if outcome.is_slowed() => format!(
            "The tool made {} % of the motion that the twist asks for: limits slowed it ({}). Command \
             a slower twist, for a longer time (--duration).",
            number(100.0 * outcome.followed.unwrap_or_default()),
            limits_met(&job.robot, &outcome.limits_hit)
        ),
        None => format!(
            "The time limit of {} s ran out before the target was reached; allow more with \
             --time-limit, or move faster (--gain, --speed).",
            job.time_limit
        ),
        Some(stall) => {
            let cause = cause(&job.robot, job.options.task, &outcome.q, stall);
            format!("{cause} {}", way_out(stall)).trim_end().to_owned()
        }
    };
    let noise = job.options.plant.noise;
    if noise > 0.0 && matches!(outcome.stall, Some(Stall::Slow)) {
        text.push_str(&format!(
            " Encoders with errors of {} may not let it nearer (--noise): accept that with \
             --tolerance-position and --tolerance-orientation.",
            number(noise)
        ));
    }
    text.push_str(&without_inverse(outcome));
    if let Some(q) = other_configuration {
        text.push_str(&format!(
            " Another configuration reaches it: --q \"{0}\" to start there, or --joint-to \
             \"{0}\" to move there first.",
            pasteable(job, q)
        ));
    }
    text
}

/// The reason why a servo stalled at `q`, without the remedies of the command line.
pub(crate) fn cause(robot: &Mechanism, task: Task, q: &[f64], stall: &Stall) -> String {
    match stall {
        Stall::OutOfReach { distance, length } => format!(
            "The target is out of reach: it is {} m from the first joint, but the stretched arm is \
             only {} m long from there. Bring the target nearer by at least {} m.",
            number(*distance),
            number(*length),
            number(distance - length)
        ),
        Stall::Limits { coordinates } => limits(robot, q, coordinates),
        Stall::Singular { ratio, direction } => format!(
            "The arm is in a singular configuration: its smallest singular value is {} of the \
             largest, and the remaining error ({}) lies along a lost direction.",
            number(*ratio),
            along(task, direction)
        ),
        Stall::TooFewJoints { rank, task: components, direction } => format!(
            "The arm has {rank} independent motion{} here, but the task has {components} components; \
             the remaining error ({}) lies outside the span of its motions.",
            if *rank == 1 { "" } else { "s" },
            along(task, direction)
        ),
        Stall::NoInverse(reason) => {
            format!("The requested inverse does not exist here: {reason}.")
        }
        Stall::Projected { direction } => format!(
            "The remaining error ({}) is the component discarded by the inverse; the arm itself \
             could reduce it.",
            along(task, direction)
        ),
        Stall::TypeII { share, direction } => format!(
            "The object is about to gain an uncontrolled motion ({}), in a type II singularity: the \
             actuated share of this motion has fallen to {}.",
            along(task, direction),
            number(*share)
        ),
        Stall::Slow => "The error fell by less than 0.1 % in the last second, and neither limits nor a singular \
             configuration block it: the damping is too strong or a velocity limit too tight."
            .to_owned(),
    }
}

/// Options of `move` that may help.
fn way_out(stall: &Stall) -> &'static str {
    match stall {
        Stall::OutOfReach { .. } => "",
        Stall::Limits { .. } => {
            "Start from another configuration (--q), keep the joints away from their limits \
             (--secondary centring), or leave components free (--task)."
        }
        Stall::Singular { .. } => {
            "Start from another configuration (--q), or use a damped inverse (--inverse damped)."
        }
        Stall::TooFewJoints { .. } => {
            "Leave components free with --task (position, pointing, or a list like x,y,rz), or \
             change the target."
        }
        Stall::NoInverse(_) => "Give an inverse to use there instead (--fallback truncated).",
        Stall::Projected { .. } => {
            "Choose another --h, other twists for --give-up, or another --inverse."
        }
        Stall::TypeII { .. } => "Take another path, or actuate other joints (--actuated).",
        Stall::Slow => {
            "Try less damping (--damping), another --inverse, or a higher --gain or --speed."
        }
    }
}

/// A sentence about the steps taken by the fallback, if any.
pub(super) fn without_inverse(outcome: &MotionResult) -> String {
    match &outcome.no_inverse {
        Some(reason) if outcome.steps_without_inverse > 0 && outcome.steps > 0 => format!(
            " {} of {} steps were taken by the fallback, since the requested inverse did not exist \
             there: {reason}.",
            outcome.steps_without_inverse,
            outcome.steps + 1
        ),
        _ => String::new(),
    }
}

/// A configuration that can be pasted back as an argument: six digits, all of them where six would
/// be beyond a limit.
fn pasteable(job: &Job, q: &[f64]) -> String {
    let entries = job.robot.coordinates().iter().zip(q).map(|(c, x)| {
        let short = number(*x);
        let within = |x: f64| (c.limits.lower..=c.limits.upper).contains(&x);
        if short.parse().is_ok_and(within) { short } else { x.to_string() }
    });
    entries.collect::<Vec<_>>().join(", ")
}

fn limits(robot: &Mechanism, q: &[f64], coordinates: &[usize]) -> String {
    let ends = coordinates.iter().map(|&i| {
        let (c, q) = (&robot.coordinates()[i], q[i]);
        let is_lower = q - c.limits.lower < c.limits.upper - q;
        let (end, limit) =
            if is_lower { ("lower", c.limits.lower) } else { ("upper", c.limits.upper) };
        (&c.name, end, number(limit), c.kind.unit())
    });
    let ends: Vec<_> = ends.collect();
    let at_limits = match &ends[..] {
        [(name, end, limit, unit)] => {
            format!("Joint {name} is at its {end} limit, {limit} {unit}")
        }
        several => {
            let list = several
                .iter()
                .map(|(name, end, limit, unit)| format!("{name} ({end}, {limit} {unit})"));
            format!("Joints are at their limits: {}", list.collect::<Vec<_>>().join(", "))
        }
    };
    format!(
        "{at_limits}. They block the motion of the tool towards the target; the other joints cannot \
         perform it alone."
    )
}

/// The larger components of a unit vector in task space, in words.
fn along(task: Task, direction: &[f64]) -> String {
    /// Components below this are not named.
    const SMALL: f64 = 0.1;
    let names = Task::COMPONENTS.iter().zip(task.components).filter(|(_, on)| *on);
    let parts: Vec<String> = names
        .zip(direction)
        .filter(|(_, share)| share.abs() >= SMALL)
        .map(|((name, _), share)| format!("{share:.2} {name}"))
        .collect();
    let axes = if task.axes == ReferenceFrame::Local { "tool" } else { "world" };
    format!("{}, {axes} axes", parts.join(", "))
}

/// `joint (kind, kind), ...`
pub(super) fn limits_met(robot: &Mechanism, hit: &BTreeSet<(usize, LimitKind)>) -> String {
    let mut parts: Vec<String> = Vec::new();
    for (i, coordinate) in robot.coordinates().iter().enumerate() {
        let kinds: Vec<&str> =
            hit.iter().filter(|(c, _)| *c == i).map(|(_, kind)| kind.name()).collect();
        if !kinds.is_empty() {
            parts.push(format!("{} ({})", coordinate.name, kinds.join(", ")));
        }
    }
    if parts.is_empty() { "none".to_owned() } else { parts.join(", ") }
}
