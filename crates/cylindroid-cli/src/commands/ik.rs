//! `ik`: configurations that place a frame at a target.

use std::io::Write;
use std::process::ExitCode;

use cylindroid::ik::{Budget, FoundBy, Goal, IkOptions, Solution, Solver, Task};
use serde::Serialize;

use super::target::{errors, target_pose, task};
use crate::args::IkArgs;
use crate::commands::shared::{Style, answer, configuration, end_effector, limited};
use crate::output::{self, Align, PoseJson, number};

#[derive(Debug, Serialize)]
struct IkJson<'a> {
    model: &'a str,
    frame: &'a str,
    /// The tool point, in axes of the frame [m].
    tool: [f64; 3],
    joint_names: Vec<&'a str>,
    success: bool,
    /// The first solution; without success the closest configuration found.
    q: &'a [f64],
    position_error: f64,
    orientation_error: f64,
    /// "analytic" or "numerical".
    found_by: &'static str,
    /// The closed form for this frame.
    #[serde(skip_serializing_if = "Option::is_none")]
    analytic: Option<AnalyticJson<'a>>,
    iterations: usize,
    restarts: usize,
    /// Distance of the target from the first joint and length of the arm from there [m], if the
    /// target is provably out of reach.
    #[serde(skip_serializing_if = "Option::is_none")]
    out_of_reach: Option<ReachJson>,
    /// All solutions.
    solutions: Vec<&'a [f64]>,
    start: &'a [f64],
    target: PoseJson,
}

#[derive(Debug, Serialize)]
struct AnalyticJson<'a> {
    structure: String,
    /// Joints that are sampled over their range.
    locked: Vec<&'a str>,
}

#[derive(Debug, Serialize)]
struct ReachJson {
    distance: f64,
    length: f64,
}

pub(crate) fn run(args: &IkArgs, style: Style, out: &mut dyn Write) -> anyhow::Result<ExitCode> {
    let robot = limited(cylindroid::load(&args.configuration.model)?, &args.limits)?;
    let start = configuration(&robot, &args.configuration)?;
    let end_effector = end_effector(&robot, &args.frame)?;
    if args.target.has_frame_tasks() {
        anyhow::bail!(
            "--task: ik takes the components of one frame; several frames are tasks of move"
        );
    }
    let (task, what) = task(&args.target, None, &robot)?;
    let from = robot.state(&start)?.pose(end_effector);
    let target = target_pose(&args.target, from, args.configuration.degrees, "")?;
    let options = IkOptions {
        position_tolerance: args.tolerance_position,
        orientation_tolerance: args.tolerance_orientation,
        initial_guess: Some(start.clone()),
        nearest: args.nearest,
        seed: args.seed,
        budget: Budget { iterations: args.iterations, time: None },
        ..IkOptions::default()
    };
    let goals = [Goal { end_effector, target, task }];
    let mut solver = Solver::new(&robot, &goals, &options)?;
    let found = match args.all {
        None => vec![solver.solve(&goals)?],
        Some(count) => match solver.solve_distinct(&goals, count)? {
            none if none.is_empty() => vec![solver.solve(&goals)?],
            some => some,
        },
    };
    let joint_names = output::joint_names(&robot);
    let analytic = solver.analytic().map(|analytic| AnalyticJson {
        structure: analytic.geometry().to_string(),
        locked: analytic.locked().iter().map(|&c| joint_names[c]).collect(),
    });
    let Some(first) = found.first() else { anyhow::bail!("no configuration was evaluated") };
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
        restarts: first.restarts,
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
        (_, true, several) => {
            format!("reached by {several} configurations, the closest to --q first")
        }
        (Some(reach), ..) => format!(
            "out of reach: the target is {} m from the first joint, the arm {} m long from there; \
             the closest configuration follows",
            number(reach.distance),
            number(reach.length)
        ),
        (None, ..) => {
            "not reached within the iteration limit, which does not prove that no solution \
                       exists: raise --iterations, change --seed, or leave components free \
                       (--task); the closest configuration follows"
                .to_owned()
        }
    };
    let [position_error, orientation_error] =
        errors(task, report.position_error, report.orientation_error);
    output::pairs(
        out,
        [
            ("model", report.model.to_owned()),
            ("frame", report.frame.to_owned()),
            ("target", what.to_owned()),
            ("result", result),
            position_error,
            orientation_error,
            ("found by", found_by(report)),
            ("restarts", format!("{}, {} iterations", report.restarts, report.iterations)),
            ("q [rad or m]", output::entries(report.q)),
        ],
    )?;
    if found.len() > 1 {
        writeln!(out)?;
        let names = report.joint_names.iter().map(|name| (*name, Align::Right));
        let columns: Vec<_> = std::iter::once(("solution", Align::Left)).chain(names).collect();
        let rows = found.iter().enumerate().map(|(i, s)| {
            let entries = s.q.iter().map(|x| number(*x));
            std::iter::once((i + 1).to_string()).chain(entries).collect::<Vec<_>>()
        });
        output::table(out, &columns, rows)?;
    }
    Ok(())
}

/// Empty without a solution.
fn found_by(report: &IkJson<'_>) -> String {
    match &report.analytic {
        _ if !report.success => String::new(),
        Some(analytic) if report.found_by == FoundBy::Analytic.name() => {
            let locked = match analytic.locked.as_slice() {
                [] => String::new(),
                names => format!("; {} sampled", names.join(", ")),
            };
            format!("closed form ({}{locked})", analytic.structure)
        }
        _ => report.found_by.to_owned(),
    }
}
