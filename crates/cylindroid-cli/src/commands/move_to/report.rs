//! What `move` prints: the table and the JSON object.

use std::collections::BTreeMap;
use std::io::Write;

use cylindroid::closure::LoopClosureError;
use cylindroid::control::{MotionResult, Task};
use serde::Serialize;

use super::job::{Goal, Job};
use super::{inverse, sentences};
use crate::commands::closed::ClosureErrorJson;
use crate::commands::shared::Style;
use crate::commands::target::errors;
use crate::output::{self, PoseJson};

/// The result of a job.
#[derive(Debug)]
pub(super) struct Result {
    pub(super) outcome: MotionResult,
    pub(super) deviation: Option<Deviation>,
    /// The largest closure error of the loops during the motion.
    pub(super) closure_error: Option<LoopClosureError>,
    pub(super) way: Way,
}

/// The motion that was executed.
#[derive(Debug)]
pub(super) enum Way {
    /// As requested.
    Direct,
    /// As requested, and it stalled; this configuration reaches the target.
    Offered { configuration: Vec<f64> },
    /// By reconfiguration through joint space, since the servo alone would have ended like this.
    Reconfigured { stalled: Box<MotionResult> },
}

impl Way {
    fn offered(&self) -> Option<&[f64]> {
        match self {
            Self::Offered { configuration } => Some(configuration),
            Self::Direct | Self::Reconfigured { .. } => None,
        }
    }
}

/// The largest distances from the path.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize)]
pub(super) struct Deviation {
    /// [m]
    pub(super) position: f64,
    /// [rad]; nothing where the orientation is not controlled.
    pub(super) orientation: Option<f64>,
}

#[derive(Debug, Serialize)]
struct MoveJson<'a> {
    model: &'a str,
    frame: &'a str,
    /// The tool point, in axes of the frame [m].
    tool: [f64; 3],
    joint_names: Vec<&'a str>,
    reached: bool,
    /// "reached", "out-of-reach", "limits", "singular", "too-few-joints", "no-inverse",
    /// "projected", "type-ii", "slow", "time-limit".
    reason: &'static str,
    explanation: String,
    /// The last configuration.
    q: &'a [f64],
    /// Of the components that are controlled [m].
    position_error: f64,
    /// Of the components that are controlled [rad].
    orientation_error: f64,
    steps: usize,
    time: f64,
    /// The largest time that the tool was behind a moving target (s).
    largest_lag: f64,
    /// The share of a twist's motion that the tool made.
    #[serde(skip_serializing_if = "Option::is_none")]
    followed: Option<f64>,
    /// Smallest on the way.
    min_singular_ratio: f64,
    /// Divides the linear rows for the singular values [m].
    length: f64,
    limits_hit: Vec<LimitJson<'a>>,
    /// The actuated joints of a mechanism with loops or contacts.
    #[serde(skip_serializing_if = "Option::is_none")]
    actuated: Option<Vec<&'a str>>,
    /// By how much its loops were open at most.
    #[serde(skip_serializing_if = "Option::is_none")]
    closure_error: Option<ClosureErrorJson>,
    /// The last `world_from_tool`.
    pose: PoseJson,
    /// Where the tool should be; what is not controlled is as at the start.
    target: PoseJson,
    /// The components that are controlled, and their axes: "local" or "local_world_aligned".
    task: Vec<&'static str>,
    task_axes: &'static str,
    inverse: &'static str,
    /// Pitch of the form of a hyperbolic inverse [m/rad]; null for the limit at infinity.
    #[serde(skip_serializing_if = "Option::is_none")]
    h: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    fallback: Option<&'static str>,
    /// Steps in which that inverse did not exist, and why in the first of them.
    steps_without_inverse: usize,
    #[serde(skip_serializing_if = "Option::is_none")]
    no_inverse: Option<String>,
    secondary: Vec<SecondaryJson>,
    start: &'a [f64],
    /// Duration of the time law [s].
    #[serde(skip_serializing_if = "Option::is_none")]
    law_duration: Option<f64>,
    /// Largest distance from the path.
    #[serde(skip_serializing_if = "Option::is_none")]
    path_deviation: Option<Deviation>,
    /// After a stall: a configuration that reaches the target, absent if none was found.
    #[serde(skip_serializing_if = "Option::is_none")]
    other_configuration: Option<&'a [f64]>,
    /// True if the robot reconfigured because the servo alone would stall.
    reconfigured: bool,
    /// The reason why the servo alone would have stalled.
    #[serde(skip_serializing_if = "Option::is_none")]
    reconfiguration_reason: Option<&'static str>,
}

#[derive(Debug, Serialize)]
struct LimitJson<'a> {
    joint: &'a str,
    kind: &'static str,
}

#[derive(Debug, Serialize)]
struct SecondaryJson {
    name: &'static str,
    #[serde(flatten)]
    parameters: BTreeMap<&'static str, f64>,
}

pub(super) fn write(
    job: &Job,
    result: &Result,
    style: Style,
    out: &mut dyn Write,
) -> anyhow::Result<()> {
    match style {
        Style::Json => output::json(out, &describe(job, result)),
        Style::Table => print(out, job, result),
    }
}

fn describe<'a>(job: &'a Job, result: &'a Result) -> MoveJson<'a> {
    let Result { outcome, deviation, closure_error, way } = result;
    let (robot, options) = (&job.robot, &job.options);
    let names = Task::COMPONENTS.iter().zip(options.task.components).filter(|(_, on)| *on);
    MoveJson {
        model: robot.name(),
        frame: &job.frame,
        tool: options.end_effector.frame_from_tool.translation.to_array(),
        joint_names: output::joint_names(robot),
        reached: outcome.reached,
        reason: sentences::reason(outcome),
        explanation: match way {
            Way::Reconfigured { stalled } if outcome.reached => {
                sentences::reconfigured(job, stalled)
            }
            _ => sentences::explanation(job, outcome, way.offered()),
        },
        q: &outcome.q,
        position_error: outcome.last.position_error,
        orientation_error: outcome.last.orientation_error,
        steps: outcome.steps,
        time: outcome.time,
        largest_lag: outcome.largest_lag,
        followed: outcome.followed,
        min_singular_ratio: outcome.min_singular_ratio,
        length: options.length,
        limits_hit: outcome
            .limits_hit
            .iter()
            .map(|(i, kind)| LimitJson { joint: &robot.coordinates()[*i].name, kind: kind.name() })
            .collect(),
        actuated: robot.is_closed().then(|| actuated_joints(job)),
        closure_error: closure_error.map(Into::into),
        pose: outcome.last.pose.into(),
        target: job.target_pose.into(),
        task: names.map(|(name, _)| *name).collect(),
        task_axes: options.task.axes.name(),
        inverse: inverse::name(&options.projection, &options.method),
        h: options.projection.pitch(),
        fallback: options.fallback.as_ref().map(|f| inverse::name(f, &options.method)),
        steps_without_inverse: outcome.steps_without_inverse,
        no_inverse: outcome.no_inverse.map(|reason| reason.to_string()),
        secondary: options
            .secondary
            .iter()
            .map(|s| SecondaryJson { name: s.name(), parameters: s.values() })
            .collect(),
        start: &job.start,
        law_duration: law_duration(job),
        path_deviation: *deviation,
        other_configuration: way.offered(),
        reconfigured: matches!(way, Way::Reconfigured { .. }),
        reconfiguration_reason: match way {
            Way::Reconfigured { stalled } => Some(sentences::reason(stalled)),
            Way::Direct | Way::Offered { .. } => None,
        },
    }
}

/// Names of the actuated joints.
fn actuated_joints(job: &Job) -> Vec<&str> {
    let tree = job.robot.coordinates().iter().filter(|c| c.actuated).map(|c| c.name.as_str());
    let loop_closure = job.robot.loops().iter().filter(|l| l.actuated).map(|l| l.name.as_str());
    tree.chain(loop_closure).collect()
}

fn result_word(outcome: &MotionResult, way: &Way) -> &'static str {
    match (outcome.reached, way) {
        (true, _) if outcome.followed.is_some() => "twist followed",
        (false, _) if outcome.followed.is_some() => "twist not followed",
        (true, Way::Reconfigured { .. }) => "reached, after reconfiguration",
        (true, _) => "reached",
        (false, _) => "not reached",
    }
}

fn law_duration(job: &Job) -> Option<f64> {
    match &job.goal {
        Goal::Pose(_) | Goal::Twist(_) => None,
        Goal::Along(motion) => Some(motion.law().duration()),
        Goal::Joints(motion) => Some(motion.law().duration()),
        Goal::Waypoints(motion) => Some(motion.duration()),
    }
}

fn print(out: &mut dyn Write, job: &Job, result: &Result) -> anyhow::Result<()> {
    let Result { outcome, deviation, closure_error, way } = result;
    let last = &outcome.last;
    let [position_error, orientation_error] =
        errors(job.options.task, last.position_error, last.orientation_error);
    let deviation = deviation.map_or_else(String::new, |d| {
        let mut text = format!("{} m", output::number(d.position));
        if let Some(orientation) = d.orientation {
            text.push_str(&format!(", {} rad", output::number(orientation)));
        }
        text
    });
    output::pairs(
        out,
        [
            ("model", job.robot.name().to_owned()),
            ("frame", job.frame.clone()),
            ("controlled", job.controlled.clone()),
            (
                "by",
                if job.robot.is_closed() { actuated_joints(job).join(", ") } else { String::new() },
            ),
            ("result", result_word(outcome, way).to_owned()),
            (
                "reason",
                match way {
                    Way::Reconfigured { stalled } if outcome.reached => {
                        sentences::reconfigured(job, stalled)
                    }
                    _ if outcome.reached => sentences::without_inverse(outcome).trim().to_owned(),
                    _ => sentences::explanation(job, outcome, way.offered()),
                },
            ),
            ("steps", outcome.steps.to_string()),
            ("time [s]", output::number(outcome.time)),
            ("time law [s]", law_duration(job).map_or_else(String::new, output::number)),
            position_error,
            orientation_error,
            ("largest path deviation", deviation),
            ("largest lag [s]", lag(job, outcome)),
            (
                "loops open by at most",
                closure_error.map_or_else(String::new, |g| {
                    format!("{} m, {} rad", output::number(g.distance), output::number(g.angle))
                }),
            ),
            (
                "smallest singular value ratio",
                format!(
                    "{} (linear rows divided by {} m)",
                    output::number(outcome.min_singular_ratio),
                    output::number(job.options.length)
                ),
            ),
            ("inverse", inverse(job, outcome)),
            ("secondary", secondary(job)),
            ("limits met", sentences::limits_met(&job.robot, &outcome.limits_hit)),
            ("final q [rad or m]", output::entries(&outcome.q)),
        ],
    )?;
    Ok(())
}

/// The lag behind a moving target, where it exceeds a few steps.
fn lag(job: &Job, outcome: &MotionResult) -> String {
    let is_behind = outcome.largest_lag > 10.0 * job.options.dt;
    if is_behind { output::number(outcome.largest_lag) } else { String::new() }
}

/// The inverse, its pitch and its fallback.
fn inverse(job: &Job, outcome: &MotionResult) -> String {
    let options = &job.options;
    let mut text = inverse::name(&options.projection, &options.method).to_owned();
    if let Some(h) = options.projection.pitch() {
        let h = if h.is_infinite() { "infinity".to_owned() } else { output::number(h) };
        text.push_str(&format!(" (h = {h} m/rad)"));
    }
    if let Some(fallback) = &options.fallback {
        text.push_str(&format!(
            ", else {} ({} of {} steps)",
            inverse::name(fallback, &options.method),
            outcome.steps_without_inverse,
            outcome.steps + 1
        ));
    }
    text
}

fn secondary(job: &Job) -> String {
    if matches!(job.goal, Goal::Joints(_)) {
        return String::new();
    }
    let names: Vec<&str> = job.options.secondary.iter().map(|s| s.name()).collect();
    if names.is_empty() { "none".to_owned() } else { names.join(", ") }
}
