//! The goals of `ik`: the target of the arguments, tasks of frames, and those of a file.

use cylindroid::control::{MotionTask, TaskObjective, goals_of};
use cylindroid::ik::{Criterion, Goal, HalfSpace, Objective, Task};
use cylindroid::model::Mechanism;
use cylindroid::{EndEffector, Pose};
use serde::Serialize;

use crate::args::IkArgs;
use crate::commands::move_to;
use crate::commands::shared::reference_or_tool;
use crate::commands::target::{target_pose, task};
use crate::output::PoseJson;

/// Goals with their descriptions, and what restricts and prefers solutions.
pub(super) struct Goals {
    pub(super) all: Vec<Goal>,
    /// What they are, in words.
    pub(super) description: String,
    pub(super) half_spaces: Vec<HalfSpace>,
    pub(super) posture: Option<Vec<f64>>,
    pub(super) criterion: Option<Criterion>,
}

/// A goal in reports.
#[derive(Debug, Default, Serialize)]
pub(super) struct GoalJson<'a> {
    #[serde(rename = "type")]
    kind: &'static str,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) frame: Option<&'a str>,
    /// The frame from which a relative pose is seen.
    #[serde(skip_serializing_if = "Option::is_none")]
    reference: Option<&'a str>,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    components: Vec<&'static str>,
    #[serde(skip_serializing_if = "Option::is_none")]
    target: Option<PoseJson>,
    /// Of the centre of mass or the gaze [m].
    #[serde(skip_serializing_if = "Option::is_none")]
    point: Option<[f64; 3]>,
}

impl<'a> GoalJson<'a> {
    pub(super) fn of(goal: &Goal, robot: &'a Mechanism) -> Self {
        let components = names(components(goal));
        let name = |e: EndEffector| Some(robot.frame_of(e.frame).name.as_str());
        match goal.objective {
            Objective::Frame { end_effector, target, .. } => Self {
                kind: "frame",
                frame: name(end_effector),
                components,
                target: Some(target.into()),
                ..Self::default()
            },
            Objective::RelativeFrame { end_effector, reference, target, .. } => Self {
                kind: "relative_frame",
                frame: name(end_effector),
                reference: name(reference),
                components,
                target: Some(target.into()),
                ..Self::default()
            },
            Objective::CenterOfMass { target, .. } => Self {
                kind: "center_of_mass",
                components,
                point: Some(target.to_array()),
                ..Self::default()
            },
            Objective::Gaze { end_effector, point } => Self {
                kind: "gaze",
                frame: name(end_effector),
                point: Some(point.to_array()),
                ..Self::default()
            },
            _ => Self::default(),
        }
    }

    /// The name in tables.
    pub(super) fn name(&self) -> &'a str {
        self.frame.unwrap_or("centre of mass")
    }
}

/// The components of the errors of a goal; of gaze the rotations.
fn components(goal: &Goal) -> [bool; 6] {
    match goal.objective {
        Objective::Frame { components, .. } | Objective::RelativeFrame { components, .. } => {
            components.components
        }
        Objective::CenterOfMass { axes: [x, y, z], .. } => [x, y, z, false, false, false],
        _ => Task::ORIENTATION.components,
    }
}

fn names(components: [bool; 6]) -> Vec<&'static str> {
    let named = Task::COMPONENTS.into_iter().zip(components);
    named.filter(|(_, on)| *on).map(|(name, _)| name).collect()
}

/// The components of all goals together.
pub(super) fn controlled(goals: &[Goal]) -> Task {
    let any = |i: usize| goals.iter().any(|goal| components(goal)[i]);
    Task { components: std::array::from_fn(any), ..Task::POSE }
}

/// A goal of a file in words.
fn words(goal: &Goal, robot: &Mechanism) -> String {
    let name = |e: EndEffector| &robot.frame_of(e.frame).name;
    let parts = || names(components(goal)).join(", ");
    match goal.objective {
        Objective::RelativeFrame { end_effector, reference, .. } => {
            format!("{}: {} seen from {}", name(end_effector), parts(), name(reference))
        }
        Objective::CenterOfMass { .. } => format!("centre of mass: {}", parts()),
        Objective::Gaze { end_effector, .. } => format!("{}: gaze", name(end_effector)),
        Objective::Frame { end_effector, .. } => format!("{}: {}", name(end_effector), parts()),
        _ => String::new(),
    }
}

/// The target of the arguments, if there is one, those of frames, and those of the file.
pub(super) fn goals(args: &IkArgs, robot: &Mechanism, start: &[f64]) -> anyhow::Result<Goals> {
    let degrees = args.configuration.degrees;
    let given = &args.target;
    let frames = given.frame_tasks()?;
    let is_given = given.to.is_some()
        || given.rpy.is_some()
        || given.quaternion.is_some()
        || given.rotation_vector.is_some();
    let mut all = Vec::new();
    let mut parts = Vec::new();
    if is_given || (frames.is_empty() && args.tasks.is_none()) {
        let end_effector = reference_or_tool(robot, &args.frame)?;
        let (task, what) = task(given, None, robot)?;
        let from = robot.state(start)?.pose(end_effector)?;
        let other = ", with --task FRAME=X,Y,Z or with --tasks FILE.toml";
        let target = target_pose(given, from, degrees, other)?;
        all.push(Goal::frame(end_effector, task, target));
        parts.push(what);
    } else if args.frame.frame.is_some() || args.frame.tool.is_some() {
        let option = if args.frame.frame.is_some() { "--frame" } else { "--tool" };
        anyhow::bail!("{option}: there is no target for it; add --to or an orientation");
    }
    for frame in &frames {
        let task = if frame.rpy.is_some() { Task::POSE } else { Task::POSITION };
        all.push(Goal::frame(robot.frame(&frame.frame)?, task, frame.target(degrees)));
        let what = if frame.rpy.is_some() { "position and orientation" } else { "position only" };
        parts.push(what.to_owned());
    }
    let is_one = all.len() == 1 && args.tasks.is_none();
    for (goal, part) in all.iter().zip(&mut parts).filter(|_| !is_one) {
        if let Objective::Frame { end_effector, .. } = goal.objective {
            *part = format!("{}: {part}", robot.frame_of(end_effector.frame).name);
        }
    }
    let (mut half_spaces, mut posture, mut of_file) = (Vec::new(), None, None);
    if let Some(path) = &args.tasks {
        let usual = MotionTask::new("", TaskObjective::Posture { q: Vec::new() });
        let (tasks, walls) = move_to::load_tasks(path, &robot.state(start)?, &usual)?;
        let own = goals_of(&tasks)?;
        parts.extend(own.goals.iter().map(|goal| words(goal, robot)));
        all.extend(own.goals);
        (half_spaces, posture, of_file) = (walls, own.posture, own.criterion);
    }
    if all.is_empty() {
        anyhow::bail!("--tasks: there is neither a frame nor another goal in the file");
    }
    let criterion = match args.maximise.as_deref() {
        Some(_) if posture.is_some() || of_file.is_some() => {
            let other = if posture.is_some() { "posture" } else { "criterion" };
            anyhow::bail!("--maximise: the file of tasks has a {other}; give one of them")
        }
        Some(name) => Some(criterion(name, &all, robot)?),
        None => of_file,
    };
    Ok(Goals { all, description: parts.join("; "), half_spaces, posture, criterion })
}

/// The criterion of this name, of the first goal that is a frame; without one of the tool's pose.
fn criterion(name: &str, goals: &[Goal], robot: &Mechanism) -> cylindroid::Result<Criterion> {
    let frames = goals.iter().find_map(|goal| match goal.objective {
        Objective::Frame { end_effector, components, .. } => Some((end_effector, components)),
        _ => None,
    });
    let (end_effector, components) = frames.unwrap_or((robot.tool().into(), Task::POSE));
    Criterion::by_name(name, end_effector, components)
}

/// The frame, tool point and target of the first goal, if it is a frame.
pub(super) fn first_frame(goals: &[Goal]) -> Option<(EndEffector, Pose)> {
    match goals.first()?.objective {
        Objective::Frame { end_effector, target, .. } => Some((end_effector, target)),
        _ => None,
    }
}
