//! Arguments of inverse kinematics: targets, tolerances, budget.

use cylindroid::Pose;
use cylindroid::control::{Task, TaskGoals, goals_of};
use cylindroid::ik::{Budget, Criterion, Goal, IkOptions, Objective};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::arrays::{Many, Numbers, pose_of};
use crate::coordinates::Coordinates;
use crate::error::{Failure, Result, entry};
use crate::mechanism::PyMechanism;
use crate::options;
use crate::tasks::{self, PyHalfSpace, PyMotionTask};

/// One pose or a stack of them.
fn poses(target: &Numbers<'_>) -> Result<Many<Pose>> {
    let [_, 4, 4] = *target.shape() else { return Ok(Many::One(target.pose("target")?)) };
    let rows = target.values().as_chunks::<4>().0;
    let one = |[a, b, c, d]: &[[f64; 4]; 4]| pose_of("target", [*a, *b, *c, *d]);
    let all = rows.as_chunks::<4>().0.iter().map(one);
    Ok(Many::All(all.collect::<Result<_>>()?))
}

/// The goal with another target, if it is a frame.
fn aimed_at(goal: &Goal, target: Pose) -> Goal {
    match goal.objective {
        Objective::Frame { end_effector, components, .. } => {
            Goal::frame(end_effector, components, target).with_weight(goal.weight)
        }
        _ => *goal,
    }
}

/// Target poses of one or several frames, and further goals.
pub(super) struct Targets {
    /// First one for each frame, whose targets are in `poses`.
    pub(super) goals: Vec<Goal>,
    /// The same number for each frame.
    poses: Vec<Many<Pose>>,
}

impl Targets {
    /// The number of problems; `None` for a single one.
    pub(super) fn count(&self) -> Option<usize> {
        self.poses.first().and_then(Many::count)
    }

    /// The goals of problem i.
    pub(super) fn at(&self, i: usize) -> Vec<Goal> {
        let aimed = |(goal, poses): (&Goal, &Many<Pose>)| aimed_at(goal, poses.as_slice()[i]);
        let others = &self.goals[self.poses.len()..];
        self.goals.iter().zip(&self.poses).map(aimed).chain(others.iter().copied()).collect()
    }
}

/// Arguments of both searches.
pub(super) struct Search<'a, 'py> {
    pub(super) frame: Option<&'a str>,
    pub(super) tool: Option<Numbers<'py>>,
    pub(super) task: Option<Bound<'py, PyAny>>,
    /// Factors by frame.
    pub(super) weights: Option<Bound<'py, PyDict>>,
    pub(super) task_axes: Option<&'a str>,
    pub(super) fixed: Option<Vec<String>>,
    pub(super) tasks: Option<Vec<Py<PyMotionTask>>>,
    pub(super) half_spaces: Option<Vec<Py<PyHalfSpace>>>,
    pub(super) posture: Option<Coordinates<'py>>,
    pub(super) maximise: Option<&'a str>,
    pub(super) tolerance_position: f64,
    pub(super) tolerance_orientation: f64,
    pub(super) seed: u64,
    pub(super) iterations: usize,
}

impl Search<'_, '_> {
    /// What the tasks ask for.
    fn goals(&self, mechanism: &PyMechanism) -> Result<TaskGoals> {
        let tasks = self.tasks.as_deref().unwrap_or_default();
        Ok(goals_of(&tasks::motion_tasks(&mechanism.inner, tasks)?)?)
    }

    pub(super) fn options(&self, mechanism: &PyMechanism) -> Result<IkOptions> {
        let posture =
            self.posture.as_ref().map(|q| q.vector(&mechanism.inner, "posture")).transpose()?;
        let of_tasks = self.goals(mechanism)?;
        let posture = match (posture, of_tasks.posture) {
            (Some(_), Some(_)) => {
                let reason = "there is a PostureTask as well; give one of them";
                return Err(Failure::option("posture", "two postures", reason));
            }
            (own, other) => own.map(<[f64]>::to_vec).or(other),
        };
        let criterion = match (self.maximise, of_tasks.criterion) {
            (Some(name), Some(_)) => {
                let reason = "there is a task for a criterion as well; give one of them";
                return Err(Failure::option("maximise", name, reason));
            }
            (Some(name), None) => Some(self.criterion(mechanism, name)?),
            (None, criterion) => criterion,
        };
        let half_spaces = self.half_spaces.as_deref().unwrap_or_default();
        Ok(IkOptions {
            posture,
            criterion,
            half_spaces: tasks::half_spaces(&mechanism.inner, half_spaces)?,
            position_tolerance: self.tolerance_position,
            orientation_tolerance: self.tolerance_orientation,
            fixed: mechanism.places(self.fixed.as_deref().unwrap_or_default())?,
            seed: self.seed,
            budget: Budget { iterations: self.iterations, time: None },
            ..IkOptions::default()
        })
    }

    /// The criterion of this name, of the frame and its components.
    fn criterion(&self, mechanism: &PyMechanism, name: &str) -> Result<Criterion> {
        let end_effector = mechanism.reference_or_tool(self.frame, self.tool.as_ref())?;
        let task = self.task.as_ref().filter(|task| task.cast::<PyDict>().is_err());
        let task: Option<String> = task.map(|task| entry("task", task)).transpose()?;
        let axes = task.is_some().then_some(self.task_axes).flatten();
        let components = options::task(&mechanism.inner, task.as_deref(), axes, Task::POSE)?;
        Ok(Criterion::by_name(name, end_effector, components)?)
    }

    /// Of the target and the tasks.
    pub(super) fn targets(
        &self,
        mechanism: &PyMechanism,
        target: Option<&Bound<'_, PyAny>>,
    ) -> Result<Targets> {
        let mut targets = match target {
            Some(target) => self.frames(mechanism, target)?,
            None => self.no_frames()?,
        };
        targets.goals.extend(self.goals(mechanism)?.goals);
        Ok(targets)
    }

    /// Without a target there is no argument that belongs to it, and there are tasks.
    fn no_frames(&self) -> Result<Targets> {
        let given = [
            ("frame", self.frame.is_some()),
            ("tool", self.tool.is_some()),
            ("task", self.task.is_some()),
            ("task_axes", self.task_axes.is_some()),
            ("weights", self.weights.is_some()),
        ];
        if let Some((option, _)) = given.into_iter().find(|(_, is_given)| *is_given) {
            let reason = "it belongs to target, which is missing";
            return Err(Failure::option(option, "without a target", reason));
        }
        if self.tasks.as_ref().is_none_or(Vec::is_empty) {
            let reason = "give a pose, a dict of poses by frame, or tasks";
            return Err(Failure::option("target", "None", reason));
        }
        Ok(Targets { goals: Vec::new(), poses: Vec::new() })
    }

    /// From poses of the frame, or a dict of poses by frame.
    fn frames(&self, mechanism: &PyMechanism, target: &Bound<'_, PyAny>) -> Result<Targets> {
        let by_name = self.task.as_ref().and_then(|task| task.cast::<PyDict>().ok());
        let goal = |frame: Option<&str>| -> Result<Goal> {
            let end_effector = mechanism.reference_or_tool(frame, self.tool.as_ref())?;
            let name: Option<String> = match (&self.task, by_name, frame) {
                (_, Some(tasks), Some(frame)) => {
                    tasks.get_item(frame)?.map(|name| entry("task", &name)).transpose()?
                }
                (Some(name), None, _) => Some(entry("task", name)?),
                _ => None,
            };
            let task =
                options::task(&mechanism.inner, name.as_deref(), self.task_axes, Task::POSE)?;
            let weight = match (&self.weights, frame) {
                (Some(weights), Some(frame)) => weights.get_item(frame)?,
                _ => None,
            };
            let weight = weight.map(|weight| entry("weights", &weight)).transpose()?;
            let goal = Goal::frame(end_effector, task, Pose::IDENTITY);
            Ok(goal.with_weight(weight.unwrap_or(1.0)))
        };
        let Ok(by_frame) = target.cast::<PyDict>() else {
            for (option, given) in [("task", by_name), ("weights", self.weights.as_ref())] {
                if given.is_some() {
                    let reason = "it names frames, and so must target";
                    return Err(Failure::option(option, "a dict", reason));
                }
            }
            let poses = poses(&entry("target", target)?)?;
            return Ok(Targets { goals: vec![goal(self.frame)?], poses: vec![poses] });
        };
        for (option, given) in [("task", by_name), ("weights", self.weights.as_ref())] {
            for frame in given.into_iter().flat_map(PyDictMethods::keys) {
                if !by_frame.contains(&frame)? {
                    let frame: String = entry(option, &frame)?;
                    return Err(Failure::option(
                        option,
                        frame,
                        "there is no target for this frame",
                    ));
                }
            }
        }
        if let Some(frame) = self.frame {
            let reason = "the dict of targets names the frames";
            return Err(Failure::option("frame", frame, reason));
        }
        if self.tool.is_some() {
            let reason = "a tool is fixed to one frame; with several give targets of the frames";
            return Err(Failure::option("tool", "with a dict of targets", reason));
        }
        let mut targets = Targets { goals: Vec::new(), poses: Vec::new() };
        for (frame, pose) in by_frame {
            targets.goals.push(goal(Some(&entry::<String>("target", &frame)?))?);
            targets.poses.push(poses(&entry("target", &pose)?)?);
        }
        let count = targets.count();
        if targets.poses.iter().any(|p| p.count() != count) {
            let reason = "give one for each frame, or as many for each";
            return Err(Failure::option("target", "poses of different numbers", reason));
        }
        Ok(targets)
    }
}
