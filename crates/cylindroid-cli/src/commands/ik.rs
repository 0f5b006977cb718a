//! `ik`: configurations that reach goals: frames, relative frames, the centre of mass, gaze.

mod goals;

use std::io::Write;

use cylindroid::ik::{
    Budget, FoundBy, Goal, IkOptions, MissReason, Solution, Solver, Task, solve, solve_distinct,
};
use cylindroid::{Error, Mechanism};
use serde::Serialize;

use self::goals::{GoalJson, Goals, controlled, first_frame, goals};
use super::target::errors;
use crate::args::IkArgs;
use crate::commands::distance::collision_model;
use crate::commands::shared::{Style, configuration, limited, load};
use crate::exit::Exit;
use crate::output::{self, Align, PoseJson, number};

#[derive(Debug, Serialize)]
struct IkJson<'a> {
    model: &'a str,
    /// Of the first goal, if it is a frame.
    #[serde(skip_serializing_if = "Option::is_none")]
    frame: Option<&'a str>,
    /// The tool point, in axes of the frame [m].
    #[serde(skip_serializing_if = "Option::is_none")]
    tool: Option<[f64; 3]>,
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
    /// All goals, if there are several or the one is no frame.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    goals: Vec<GoalJson<'a>>,
    /// The names of the half-spaces that tool points must not leave.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    half_spaces: Vec<&'a str>,
    /// The posture that solutions approach.
    #[serde(skip_serializing_if = "Option::is_none")]
    posture: Option<&'a [f64]>,
    #[serde(skip_serializing_if = "Option::is_none")]
    criterion: Option<CriterionJson>,
    /// All solutions.
    solutions: Vec<&'a [f64]>,
    start: &'a [f64],
    #[serde(skip_serializing_if = "Option::is_none")]
    target: Option<PoseJson>,
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
    /// "out of reach", "collision", "half-space", "limits" or "not proven".
    kind: &'static str,
    message: String,
    /// Coordinates outside whose limits there is a solution.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    joints: Vec<String>,
    /// Half-spaces outside of which there is a solution.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    half_spaces: Vec<String>,
    /// Two bodies that are too close, and their distance [m].
    #[serde(skip_serializing_if = "Option::is_none")]
    between: Option<[String; 2]>,
    #[serde(skip_serializing_if = "Option::is_none")]
    distance: Option<f64>,
}

/// What the solution makes as large as possible.
#[derive(Debug, Serialize)]
struct CriterionJson {
    name: &'static str,
    /// At `q` [-].
    value: f64,
}

impl CriterionJson {
    fn of(options: &IkOptions, found: &Solution) -> Option<Self> {
        let (criterion, value) = (options.criterion?, found.criterion?);
        Some(Self { name: criterion.name(), value })
    }
}

impl From<&MissReason> for ReasonJson {
    fn from(reason: &MissReason) -> Self {
        let mut json = Self { kind: reason.name(), message: reason.to_string(), ..Self::default() };
        match reason {
            MissReason::Limits { joints } => json.joints.clone_from(joints),
            MissReason::HalfSpaces { names } => json.half_spaces.clone_from(names),
            MissReason::Collision { between, distance } => {
                (json.between, json.distance) = (Some(between.clone()), Some(*distance));
            }
            _ => {}
        }
        json
    }
}

pub(crate) fn run(args: &IkArgs, style: Style, out: &mut dyn Write) -> anyhow::Result<Exit> {
    let robot = limited(load(&args.configuration.model, &[])?, &args.limits)?;
    let start = configuration(&robot, &args.configuration)?;
    let Goals { all: goals, description, half_spaces, posture, criterion } =
        goals(args, &robot, &start)?;
    let gap = args.avoidance.gap();
    let gap = gap.map_err(|option| {
        anyhow::anyhow!("{option} has no effect without --avoid or --obstacle")
    })?;
    let options = IkOptions {
        position_tolerance: args.tolerance_position,
        orientation_tolerance: args.tolerance_orientation,
        initial_guess: Some(start.clone()),
        nearest: args.nearest,
        posture,
        criterion,
        half_spaces,
        seed: args.seed,
        budget: Budget { iterations: args.iterations, time: None },
        ..IkOptions::default()
    };
    let joint_names = output::joint_names(&robot);
    let (found, analytic) = if robot.is_closed() {
        if gap.is_some() {
            let reason = "distances of bodies are kept by serial arms only";
            return Err(refused("--avoid", &robot, reason).into());
        }
        (closed_chain(&robot, &goals, &options, args.all)?, None)
    } else {
        let mut solver = Solver::new(&robot, &goals, &options)?;
        if let Some(gap) = gap {
            Error::check_finite("--gap", &[gap])?;
            solver.avoid(
                collision_model(
                    &robot,
                    &args.avoidance.collision,
                    args.configuration.model.srdf.as_deref(),
                )?,
                gap,
            )?;
        }
        let found = match args.all {
            None => vec![solver.solve(&goals)?],
            Some(count) => match solver.solve_distinct(&goals, count)? {
                none if none.is_empty() => vec![solver.solve(&goals)?],
                some => some,
            },
        };
        let analytic = solver.analytic().map(|analytic| AnalyticJson {
            structure: analytic.geometry().to_string(),
            locked: analytic.locked().iter().map(|&c| joint_names[c]).collect(),
        });
        (found, analytic)
    };
    let Some(first) = found.first() else { anyhow::bail!("no configuration was evaluated") };
    let first_frame = first_frame(&goals);
    let is_alone = goals.len() == 1 && first_frame.is_some();
    let several = goals.iter().filter(|_| !is_alone).map(|goal| GoalJson::of(goal, &robot));
    let report = IkJson {
        model: robot.name(),
        frame: first_frame
            .map(|(end_effector, _)| robot.frame_of(end_effector.frame).name.as_str()),
        tool: first_frame.map(|(e, _)| e.frame_from_tool.translation.to_array()),
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
        half_spaces: options.half_spaces.iter().map(|h| h.name.as_str()).collect(),
        posture: options.posture.as_deref(),
        criterion: CriterionJson::of(&options, first),
        solutions: found.iter().filter(|s| s.success).map(|s| s.q.as_slice()).collect(),
        start: &start,
        target: first_frame.map(|(_, target)| target.into()),
    };
    match style {
        Style::Json => output::json(out, &report)?,
        Style::Table => print(out, &report, (&description, controlled(&goals)), &found)?,
    }
    Ok(Exit::answer(first.success))
}

/// The solutions of a closed chain, or one failure.
fn closed_chain(
    robot: &Mechanism,
    goals: &[Goal],
    options: &IkOptions,
    count: Option<usize>,
) -> cylindroid::Result<Vec<Solution>> {
    if let Some(count) = count {
        let found = solve_distinct(robot, goals, options, count)?;
        if !found.is_empty() {
            return Ok(found);
        }
    }
    Ok(vec![solve(robot, goals, options)?])
}

fn refused(option: &'static str, robot: &Mechanism, reason: &str) -> Error {
    let value = format!("with loops of '{}'", robot.name());
    Error::InvalidOption { option, value, reason: reason.to_owned() }
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
            let order = match (&report.criterion, report.posture) {
                (Some(criterion), _) => format!("that of the largest {} first", criterion.name),
                (None, Some(_)) => "the closest to the posture first".to_owned(),
                (None, None) => "the closest to --q first".to_owned(),
            };
            format!("reached by {several} configurations, {order}")
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
        [] => report.frame.unwrap_or_default().to_owned(),
        several => {
            let mut names: Vec<&str> = several.iter().map(GoalJson::name).collect();
            names.dedup();
            names.join(", ")
        }
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
            (
                "maximised [-]",
                report.criterion.as_ref().map_or_else(String::new, |criterion| {
                    format!("{} {}", criterion.name, number(criterion.value))
                }),
            ),
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
