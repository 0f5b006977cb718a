//! Why a motion ended, in full sentences: what happened, with names and numbers, and what to try.

use cylindroid::ReferenceFrame;
use cylindroid::control::{MotionResult, Stall, Task};
use cylindroid::model::Mechanism;

use super::job::Job;
use crate::output::number;

/// The cause as one word: "reached", a [`Stall::name`], or "time-limit".
pub(super) fn reason(outcome: &MotionResult) -> &'static str {
    match &outcome.stall {
        _ if outcome.reached => "reached",
        Some(stall) => stall.name(),
        None => "time-limit",
    }
}

/// Why the joints went straight to another posture.
pub(super) fn round(job: &Job, stalled: &MotionResult) -> String {
    let what = match &stalled.stall {
        Some(Stall::Limits { coordinates }) => {
            let names: Vec<&str> =
                coordinates.iter().map(|&i| job.robot.coordinates()[i].name.as_str()).collect();
            format!("at the limit of {}", names.join(", "))
        }
        Some(Stall::Singular { .. }) => "in a singular pose".to_owned(),
        Some(Stall::NoInverse(_)) => "where the inverse does not exist".to_owned(),
        Some(Stall::Projected { .. }) => "left with what the inverse gives up".to_owned(),
        Some(Stall::TypeII { .. }) => "where a motion escapes the drives".to_owned(),
        Some(Stall::Slow | Stall::TooFewJoints { .. } | Stall::OutOfReach { .. }) | None => {
            "for want of progress".to_owned()
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
    format!(
        "Going straight at the target, the servo would stall {} before it, {what}. So every joint \
         moved straight to another posture that reaches it (--no-reconfigure keeps the servo's motion).",
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
            return format!("The target was reached.{}", without_inverse(outcome));
        }
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
    text.push_str(&without_inverse(outcome));
    if let Some(q) = other_configuration {
        text.push_str(&format!(
            " Another posture does reach it: --q \"{0}\" to start there, or --joint-to \"{0}\" to \
             move there first.",
            pasteable(job, q)
        ));
    }
    text
}

/// Why a servo got no nearer at `q`, without what the command line offers against it.
pub(crate) fn cause(robot: &Mechanism, task: Task, q: &[f64], stall: &Stall) -> String {
    match stall {
        Stall::OutOfReach { distance, length } => format!(
            "The target is out of reach: it is {} m from the first joint, but the arm stretched \
             is {} m long from there. Bring the target nearer by at least {} m.",
            number(*distance),
            number(*length),
            number(distance - length)
        ),
        Stall::Limits { coordinates } => limits(robot, q, coordinates),
        Stall::Singular { ratio, direction } => format!(
            "The arm is in a singular pose: its smallest singular value is {} of the largest, and \
             the remaining error ({}) lies along a direction that is lost there.",
            number(*ratio),
            along(task, direction)
        ),
        Stall::TooFewJoints { rank, task: components, direction } => format!(
            "The arm has {rank} independent motion{} here, the task asks for {components} \
             components; the remaining error ({}) is outside of what it can do.",
            if *rank == 1 { "" } else { "s" },
            along(task, direction)
        ),
        Stall::NoInverse(reason) => {
            format!("The inverse that was asked for does not exist here: {reason}.")
        }
        Stall::Projected { direction } => format!(
            "The remaining error ({}) is what the inverse gives up; the arm itself could lessen \
             it.",
            along(task, direction)
        ),
        Stall::TypeII { share, direction } => format!(
            "A motion of the object ({}) is about to escape the drives: {} of it still belongs to \
             them (type II singularity), and beyond it passive joints would choose the way.",
            along(task, direction),
            number(*share)
        ),
        Stall::Slow => "The error fell by less than 0.1 % in the last second, and neither limits \
             nor a singular pose stop it: the inverse is damped too much or a rate limit is too \
             tight."
            .to_owned(),
    }
}

/// What the options of `move` can do about it.
fn way_out(stall: &Stall) -> &'static str {
    match stall {
        Stall::OutOfReach { .. } => "",
        Stall::Limits { .. } => {
            "Start from another posture (--q), keep the joints away from their limits (--secondary \
             centring), or leave components free (--task)."
        }
        Stall::Singular { .. } => {
            "Start from another posture (--q), or let a damped inverse through (--inverse damped)."
        }
        Stall::TooFewJoints { .. } => {
            "Leave components free with --task (position, pointing, or a list like x,y,rz), or \
             change the target."
        }
        Stall::NoInverse(_) => "Or name what shall take over there (--fallback truncated).",
        Stall::Projected { .. } => {
            "Choose another --h, other motions to give up, or another --inverse."
        }
        Stall::TypeII { .. } => "Move on another way, or drive other joints (--actuated).",
        Stall::Slow => {
            "Try less damping (--damping), another --inverse, or a higher --gain or --speed."
        }
    }
}

/// A sentence about the steps that the fallback took, if any.
pub(super) fn without_inverse(outcome: &MotionResult) -> String {
    match &outcome.no_inverse {
        Some(reason) if outcome.steps_without_inverse > 0 && outcome.steps > 0 => format!(
            " {} of {} steps were taken by the fallback, since the inverse that was asked for did \
             not exist there: {reason}.",
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
    let stands = match &ends[..] {
        [(name, end, limit, unit)] => {
            format!("Joint {name} stands at its {end} limit, {limit} {unit}")
        }
        several => {
            let list = several
                .iter()
                .map(|(name, end, limit, unit)| format!("{name} ({end}, {limit} {unit})"));
            format!("Joints stand at their limits: {}", list.collect::<Vec<_>>().join(", "))
        }
    };
    format!(
        "{stands}. Without that the tool would get nearer; the other joints cannot do it alone."
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
