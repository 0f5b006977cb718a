//! `ik`: configurations that put a frame at a target.

use std::io::Write;
use std::process::ExitCode;

use cylindroid::ik::{Budget, FoundBy, Goal, IkOptions, Solution, Solver, Task};
use serde::Serialize;

use super::target::{errors, target_pose, task};
use super::{Style, answer, configuration, end_effector};
use crate::args::IkArgs;
use crate::output::{self, Align, PoseJson, number};

#[derive(Debug, Serialize)]
struct IkJson<'a> {
    model: &'a str,
    frame: &'a str,
    /// The tool point, in axes of the frame [m].
    tool: [f64; 3],
    joint_names: Vec<&'a str>,
    success: bool,
    /// The first answer; without success the nearest posture that was found.
    q: &'a [f64],
    position_error: f64,
    orientation_error: f64,
    /// "analytic" or "search".
    found_by: &'static str,
    /// The formulas that there are for this frame.
    #[serde(skip_serializing_if = "Option::is_none")]
    analytic: Option<AnalyticJson<'a>>,
    iterations: usize,
    attempts: usize,
    /// How far the target is from the first joint and how long the arm is from there [m], where
    /// that proves that nothing reaches.
    #[serde(skip_serializing_if = "Option::is_none")]
    out_of_reach: Option<ReachJson>,
    /// All answers.
    solutions: Vec<&'a [f64]>,
    start: &'a [f64],
    target: PoseJson,
}

#[derive(Debug, Serialize)]
struct AnalyticJson<'a> {
    structure: String,
    /// Joints that are held at one value after another.
    held: Vec<&'a str>,
}

#[derive(Debug, Serialize)]
struct ReachJson {
    distance: f64,
    length: f64,
}

pub(crate) fn run(args: &IkArgs, style: Style, out: &mut dyn Write) -> anyhow::Result<ExitCode> {
    let robot = cylindroid::load(&args.posture.model)?;
    let start = configuration(&robot, &args.posture)?;
    let end_effector = end_effector(&robot, &args.frame)?;
    let (task, what) = task(&args.target, &robot)?;
    let from = robot.state(&start)?.pose(end_effector);
    let target = target_pose(&args.target, from, args.posture.degrees, "")?;
    let options = IkOptions {
        position_tolerance: args.tolerance_position,
        orientation_tolerance: args.tolerance_orientation,
        start: Some(start.clone()),
        nearest: args.nearest,
        seed: args.seed,
        budget: Budget { iterations: args.iterations, time: None },
        ..IkOptions::default()
    };
    let goals = [Goal { end_effector, target, task }];
    let mut solver = Solver::new(&robot, &goals, &options)?;
    let found = match args.all {
        None => vec![solver.solve(&goals)?],
        Some(count) => match solver.solve_several(&goals, count)? {
            none if none.is_empty() => vec![solver.solve(&goals)?],
            some => some,
        },
    };
    let joint_names = output::joint_names(&robot);
    let analytic = solver.analytic().map(|analytic| AnalyticJson {
        structure: analytic.structure().to_string(),
        held: analytic.held().iter().map(|&c| joint_names[c]).collect(),
    });
    let Some(first) = found.first() else { anyhow::bail!("no posture was looked at") };
    let frame = robot.frame_of(end_effector.frame).name.as_str();
    let report = IkJson {
        model: robot.name(),
        frame,
        tool: end_effector.frame_from_tool.translation.to_array(),
        joint_names,
        success: first.success,
        q: &first.q,
        position_error: first.position_error,
        orientation_error: first.orientation_error,
        found_by: first.found_by.name(),
        analytic,
        iterations: first.iterations,
        attempts: first.attempts,
        out_of_reach: first.out_of_reach.map(|(distance, length)| ReachJson { distance, length }),
        solutions: found.iter().filter(|s| s.success).map(|s| s.q.as_slice()).collect(),
        start: &start,
        target: target.into(),
    };
    match style {
        Style::Json => output::json(out, &report)?,
        Style::Table => print(out, &report, (&what, task), &found)?,
    }
    Ok(answer(first.success))
}

fn print(
    out: &mut dyn Write,
    report: &IkJson<'_>,
    (what, task): (&str, Task),
    found: &[Solution],
) -> anyhow::Result<()> {
    let result = match (&report.out_of_reach, report.success, found.len()) {
        (_, true, 1) => "reached".to_owned(),
        (_, true, several) => format!("reached by {several} postures, the nearest to --q first"),
        (Some(reach), ..) => format!(
            "out of reach: the target is {} m from the first joint, the arm {} m long from there; \
             the nearest posture follows",
            number(reach.distance),
            number(reach.length)
        ),
        (None, ..) => "not reached in so many attempts, which proves nothing: try more \
                       (--iterations), another --seed, or leave components free (--task); the \
                       nearest posture follows"
            .to_owned(),
    };
    let [position_error, orientation_error] =
        errors(task, report.position_error, report.orientation_error);
    output::pairs(
        out,
        [
            ("model", report.model.to_owned()),
            ("frame", report.frame.to_owned()),
            ("asked for", what.to_owned()),
            ("result", result),
            position_error,
            orientation_error,
            ("found by", found_by(report)),
            ("attempts", format!("{}, {} steps", report.attempts, report.iterations)),
            ("q [rad or m]", output::entries(report.q)),
        ],
    )?;
    if found.len() > 1 {
        writeln!(out)?;
        let names = report.joint_names.iter().map(|name| (*name, Align::Right));
        let columns: Vec<_> = std::iter::once(("answer", Align::Left)).chain(names).collect();
        let rows = found.iter().enumerate().map(|(i, s)| {
            let entries = s.q.iter().map(|x| number(*x));
            std::iter::once((i + 1).to_string()).chain(entries).collect::<Vec<_>>()
        });
        output::table(out, &columns, rows)?;
    }
    Ok(())
}

/// Empty without an answer.
fn found_by(report: &IkJson<'_>) -> String {
    match &report.analytic {
        _ if !report.success => String::new(),
        Some(analytic) if report.found_by == FoundBy::Analytic.name() => {
            let held = match analytic.held.as_slice() {
                [] => String::new(),
                names => format!("; {} held", names.join(", ")),
            };
            format!("formulas ({}{held})", analytic.structure)
        }
        _ => report.found_by.to_owned(),
    }
}
