//! `ik`: configurations that place a frame at a target.

use std::io::Write;
use std::process::ExitCode;

use cylindroid::Error;
use cylindroid::ik::{Budget, FoundBy, Goal, IkOptions, MissReason, Solution, Solver, Task};
use cylindroid::model::Mechanism;
use serde::Serialize;

use super::target::{errors, target_pose, task};
use crate::args::IkArgs;
use crate::commands::distance::collision_model;
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
    /// The reason for a miss.
    #[serde(skip_serializing_if = "Option::is_none")]
    reason: Option<ReasonJson>,
    /// Least distance of bodies [m], if distances are kept.
    #[serde(skip_serializing_if = "Option::is_none")]
    gap: Option<f64>,
    /// All frames with their targets, if there are several.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    goals: Vec<GoalJson<'a>>,
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

/// The reason for a miss, in words and as data.
#[derive(Debug, Default, Serialize)]
struct ReasonJson {
    /// "out of reach", "collision", "limits" or "not proven".
    kind: &'static str,
    message: String,
    /// Coordinates outside whose limits there is a solution.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    joints: Vec<String>,
    /// Two bodies that are too close, and their distance [m].
    #[serde(skip_serializing_if = "Option::is_none")]
    between: Option<[String; 2]>,
    #[serde(skip_serializing_if = "Option::is_none")]
    distance: Option<f64>,
}

impl From<&MissReason> for ReasonJson {
    fn from(reason: &MissReason) -> Self {
        let mut json = Self { kind: reason.name(), message: reason.to_string(), ..Self::default() };
        match reason {
            MissReason::Limits { joints } => json.joints.clone_from(joints),
            MissReason::Collision { between, distance } => {
                (json.between, json.distance) = (Some(between.clone()), Some(*distance));
            }
            _ => {}
        }
        json
    }
}

/// A frame and its target.
#[derive(Debug, Serialize)]
struct GoalJson<'a> {
    frame: &'a str,
    components: Vec<&'static str>,
    target: PoseJson,
}

/// The target of the arguments, if there is one, and those of frames; with the first in words.
fn goals(args: &IkArgs, robot: &Mechanism, start: &[f64]) -> anyhow::Result<(Vec<Goal>, String)> {
    let degrees = args.configuration.degrees;
    let given = &args.target;
    let frames = given.frame_tasks()?;
    let is_given = given.to.is_some()
        || given.rpy.is_some()
        || given.quaternion.is_some()
        || given.rotation_vector.is_some();
    let mut goals = Vec::new();
    let mut words = Vec::new();
    if is_given || frames.is_empty() {
        let end_effector = end_effector(robot, &args.frame)?;
        let (task, what) = task(given, None, robot)?;
        let from = robot.state(start)?.pose(end_effector);
        let target = target_pose(given, from, degrees, ", or with --task FRAME=X,Y,Z")?;
        goals.push(Goal { task, ..Goal::pose(end_effector, target) });
        words.push(what);
    } else if args.frame.frame.is_some() || args.frame.tool.is_some() {
        let option = if args.frame.frame.is_some() { "--frame" } else { "--tool" };
        anyhow::bail!("{option}: there is no target for it; add --to or an orientation");
    }
    for frame in &frames {
        let task = if frame.rpy.is_some() { Task::POSE } else { Task::POSITION };
        let goal = Goal::pose(robot.frame(&frame.frame)?, frame.target(degrees));
        goals.push(Goal { task, ..goal });
        let what = if frame.rpy.is_some() { "position and orientation" } else { "position only" };
        words.push(what.to_owned());
    }
    if let ([_], [what]) = (goals.as_slice(), words.as_slice()) {
        let what = what.clone();
        return Ok((goals, what));
    }
    let name = |goal: &Goal| robot.frame_of(goal.end_effector.frame).name.clone();
    let all = goals.iter().zip(&words).map(|(goal, what)| format!("{}: {what}", name(goal)));
    let what = all.collect::<Vec<_>>().join("; ");
    Ok((goals, what))
}

pub(crate) fn run(args: &IkArgs, style: Style, out: &mut dyn Write) -> anyhow::Result<ExitCode> {
    let robot = limited(cylindroid::load(&args.configuration.model)?, &args.limits)?;
    let start = configuration(&robot, &args.configuration)?;
    let (goals, what) = goals(args, &robot, &start)?;
    let gap = args.avoidance.gap();
    let gap = gap.map_err(|option| {
        anyhow::anyhow!("{option} has no effect without --avoid or --obstacle")
    })?;
    let options = IkOptions {
        position_tolerance: args.tolerance_position,
        orientation_tolerance: args.tolerance_orientation,
        initial_guess: Some(start.clone()),
        nearest: args.nearest,
        seed: args.seed,
        budget: Budget { iterations: args.iterations, time: None },
        ..IkOptions::default()
    };
    let mut solver = Solver::new(&robot, &goals, &options)?;
    if let Some(gap) = gap {
        Error::check_finite("--gap", &[gap])?;
        solver.avoid(collision_model(&robot, &args.avoidance.collision)?, gap)?;
    }
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
    let frame_of = |goal: &Goal| robot.frame_of(goal.end_effector.frame).name.as_str();
    let several = goals.iter().filter(|_| goals.len() > 1).map(|goal| GoalJson {
        frame: frame_of(goal),
        components: components(goal.task),
        target: goal.target.into(),
    });
    let Goal { end_effector, target, .. } = goals[0];
    let report = IkJson {
        model: robot.name(),
        frame: frame_of(&goals[0]),
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
        reason: first.reason.as_ref().map(ReasonJson::from),
        gap,
        goals: several.collect(),
        solutions: found.iter().filter(|s| s.success).map(|s| s.q.as_slice()).collect(),
        start: &start,
        target: target.into(),
    };
    match style {
        Style::Json => output::json(out, &report)?,
        Style::Table => print(out, &report, (&what, controlled(&goals)), &found)?,
    }
    Ok(answer(first.success))
}

/// The names of the components of a task.
fn components(task: Task) -> Vec<&'static str> {
    let named = Task::COMPONENTS.into_iter().zip(task.components);
    named.filter(|(_, on)| *on).map(|(name, _)| name).collect()
}

/// The components of all goals together.
fn controlled(goals: &[Goal]) -> Task {
    let any = |i: usize| goals.iter().any(|goal| goal.task.components[i]);
    Task { components: std::array::from_fn(any), ..Task::POSE }
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
        (None, ..) => match &report.reason {
            Some(reason) if reason.kind != MissReason::NotProven.name() => {
                format!("not reached: {}; this configuration follows", reason.message)
            }
            _ => "not reached within the iteration limit, which does not prove that no solution \
                  exists: raise --iterations, change --seed, or leave components free (--task); the \
                  closest configuration follows"
                .to_owned(),
        },
    };
    let frames = match report.goals.as_slice() {
        [] => report.frame.to_owned(),
        several => several.iter().map(|goal| goal.frame).collect::<Vec<_>>().join(", "),
    };
    let [position_error, orientation_error] =
        errors(task, report.position_error, report.orientation_error);
    output::pairs(
        out,
        [
            ("model", report.model.to_owned()),
            ("frame", frames),
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
