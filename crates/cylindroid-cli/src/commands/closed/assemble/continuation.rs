//! `assemble --to`: prescribed coordinates go to their goal, the loops stay closed.

use std::io::Write;

use cylindroid::closure::{
    ContinuationOptions, ContinuationResult, PathEnd, PathSingularity, track_path,
};
use cylindroid::model::Dimension;
use serde::Serialize;

use super::job::{Job, open_by, q_line};
use crate::commands::closed::ClosureErrorJson;
use crate::commands::closed::singularity::motion_in_words;
use crate::commands::shared::Style;
use crate::exit::Exit;
use crate::output::{self, Align, ScrewJson, number};

#[derive(Debug, Serialize)]
struct ContinuationJson<'a> {
    model: &'a str,
    joint_names: &'a [&'a str],
    reached: bool,
    /// "reached", "singular", "limit", "open", "contradiction", "lost".
    end: String,
    explanation: String,
    /// Of the way, 0 to 1.
    fraction: f64,
    q: &'a [f64],
    closure_error: ClosureErrorJson,
    start: &'a [f64],
    /// Names and values that were asked for; prescribed ones at rest too.
    goal: Vec<GoalJson<'a>>,
    least_distance: f64,
    /// The coordinate at whose limit it ended.
    limit: Option<&'a str>,
    singularity: Option<SightJson<'a>>,
    path: Vec<PointJson<'a>>,
}

#[derive(Debug, Serialize)]
struct GoalJson<'a> {
    joint: &'a str,
    value: f64,
}

#[derive(Debug, Serialize)]
struct SightJson<'a> {
    /// "type-ii", "configuration-space", "passive".
    kind: &'static str,
    distance: f64,
    /// Of all coordinates, in the motion that is gained.
    joint_velocities: &'a [f64],
    /// Of the reference frame, linear first, at its origin, world axes.
    twist: [f64; 6],
    /// Seen from the world; null where the reference frame rests.
    screw: Option<ScrewJson>,
    /// The reference frame.
    frame: &'a str,
}

#[derive(Debug, Serialize)]
struct PointJson<'a> {
    fraction: f64,
    q: &'a [f64],
    /// To the next singularity; null where nothing can be lost.
    distance: f64,
}

/// The way that is asked for.
pub(super) struct Goal {
    pub(super) places: Vec<usize>,
    pub(super) values: Vec<f64>,
}

pub(super) fn run(
    job: &Job<'_>,
    goal: &Goal,
    least_distance: Option<f64>,
    style: Style,
    out: &mut dyn Write,
) -> anyhow::Result<Exit> {
    let mut options = ContinuationOptions::default();
    if let Some(least) = least_distance {
        options.least_distance = least;
    }
    let way = track_path(job.mechanism, &job.guess, &goal.places, &goal.values, options)?;
    match style {
        Style::Json => output::json(out, &describe(job, goal, options, &way))?,
        Style::Table => print(out, job, goal, &way)?,
    }
    Ok(Exit::answer(way.end == PathEnd::Reached))
}

fn start<'a>(job: &'a Job<'_>, way: &'a ContinuationResult) -> &'a [f64] {
    way.path.first().map_or(&job.guess, |p| &p.q)
}

fn describe<'a>(
    job: &'a Job<'_>,
    goal: &Goal,
    options: ContinuationOptions,
    way: &'a ContinuationResult,
) -> ContinuationJson<'a> {
    let asked = goal.places.iter().zip(&goal.values);
    let sight = match &way.end {
        PathEnd::Singular(s) => Some(SightJson {
            kind: s.kind.name(),
            distance: s.distance,
            joint_velocities: &s.joint_velocities,
            twist: s.twist.to_array(),
            screw: s.screw.as_ref().map(Into::into),
            frame: reference(job),
        }),
        _ => None,
    };
    let limit = match way.end {
        PathEnd::Limit { coordinate } => Some(job.names[coordinate]),
        _ => None,
    };
    ContinuationJson {
        model: job.mechanism.name(),
        joint_names: &job.names,
        reached: way.end == PathEnd::Reached,
        end: way.end.to_string(),
        explanation: explain(job, goal, way),
        fraction: way.fraction,
        q: &way.q,
        closure_error: way.closure_error.into(),
        start: start(job, way),
        goal: asked.map(|(&i, &value)| GoalJson { joint: job.names[i], value }).collect(),
        least_distance: options.least_distance,
        limit,
        singularity: sight,
        path: way
            .path
            .iter()
            .map(|p| PointJson { fraction: p.fraction, q: &p.q, distance: p.distance })
            .collect(),
    }
}

fn reference<'a>(job: &'a Job<'_>) -> &'a str {
    &job.mechanism.frame_of(job.mechanism.reference()).name
}

/// Why it ended and what to try.
fn explain(job: &Job<'_>, goal: &Goal, way: &ContinuationResult) -> String {
    let names = job.names_of(&goal.places).join(", ");
    match &way.end {
        PathEnd::Reached => format!("reached: {names} at the goal, in the same assembly mode"),
        PathEnd::Singular(s) => format!(
            "stopped before a singularity, {}: with {names} at rest {} (distance {}); choose \
             another path, or prescribe other coordinates",
            s.kind,
            gained(job, s),
            number(s.distance)
        ),
        PathEnd::Limit { coordinate } => {
            let l = &job.mechanism.coordinates()[*coordinate].limits;
            format!(
                "stopped at the position limit of {} ({} to {})",
                job.names[*coordinate],
                number(l.lower),
                number(l.upper)
            )
        }
        PathEnd::Open => format!(
            "the loops cannot be closed at the start with {names} prescribed: open by {}; give \
             another --q",
            open_by(way.closure_error)
        ),
        PathEnd::Contradiction => format!(
            "{names} contradict each other: no motion of the others keeps the loops closed; \
             prescribe fewer of them"
        ),
        PathEnd::StepTooSmall => {
            "the step became too small: neither a singularity nor a limit was met".to_owned()
        }
    }
}

fn gained(job: &Job<'_>, s: &PathSingularity) -> String {
    match s.screw {
        None => "the reference frame rests and other links gain a motion".to_owned(),
        Some(screw) => {
            let planar = job.mechanism.dimension() == Dimension::Planar;
            format!("the reference frame gains {}", motion_in_words(&screw, planar))
        }
    }
}

fn print(
    out: &mut dyn Write,
    job: &Job<'_>,
    goal: &Goal,
    way: &ContinuationResult,
) -> anyhow::Result<()> {
    let walked = way.path.iter().filter(|p| p.distance.is_finite() && way.fraction > 0.0);
    let nearest = walked.min_by(|a, b| a.distance.total_cmp(&b.distance));
    let nearest = nearest.map_or_else(String::new, |p| {
        format!("{} at {} of the path (0: singular)", number(p.distance), number(p.fraction))
    });
    output::pairs(
        out,
        [
            ("model", job.mechanism.name().to_owned()),
            ("result", explain(job, goal, way)),
            ("fraction of the path", number(way.fraction)),
            ("least distance", nearest),
            ("q", q_line(&way.q)),
        ],
    )?;
    writeln!(out)?;
    let columns = [
        ("coordinate", Align::Left),
        ("start", Align::Right),
        ("end", Align::Right),
        ("goal", Align::Right),
    ];
    let cell = |x: f64| output::entries(&[x]);
    let rows = job.names.iter().enumerate().map(|(i, name)| {
        let asked = goal.places.iter().position(|&p| p == i);
        let asked = asked.map_or_else(String::new, |k| cell(goal.values[k]));
        vec![(*name).to_owned(), cell(start(job, way)[i]), cell(way.q[i]), asked]
    });
    Ok(output::table(out, &columns, rows)?)
}
