//! Arguments of inverse kinematics: targets, tolerances, budget.

use cylindroid::Pose;
use cylindroid::control::Task;
use cylindroid::ik::{Budget, Goal, IkOptions};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::arrays::{Many, Numbers};
use crate::error::{Failure, Result, entry};
use crate::mechanism::PyMechanism;
use crate::options;

/// One pose or a stack of them.
fn poses(target: &Numbers<'_>) -> Result<Many<Pose>> {
    let [_, 4, 4] = *target.shape() else { return Ok(Many::One(target.pose("target")?)) };
    let rows = target.values().as_chunks::<4>().0;
    let one = |[a, b, c, d]: &[[f64; 4]; 4]| Pose::from_matrix([*a, *b, *c, *d]);
    let all = rows.as_chunks::<4>().0.iter().map(one);
    Ok(Many::All(all.collect::<cylindroid::Result<_>>()?))
}

/// Target poses of one or several frames.
pub(super) struct Targets {
    /// One for each frame; their targets are in `poses`.
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
        let aimed =
            |(goal, poses): (&Goal, &Many<Pose>)| Goal { target: poses.as_slice()[i], ..*goal };
        self.goals.iter().zip(&self.poses).map(aimed).collect()
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
    pub(super) tolerance_position: f64,
    pub(super) tolerance_orientation: f64,
    pub(super) seed: u64,
    pub(super) iterations: usize,
}

impl Search<'_, '_> {
    pub(super) fn options(&self, mechanism: &PyMechanism) -> Result<IkOptions> {
        Ok(IkOptions {
            position_tolerance: self.tolerance_position,
            orientation_tolerance: self.tolerance_orientation,
            fixed: mechanism.places(self.fixed.as_deref().unwrap_or_default())?,
            seed: self.seed,
            budget: Budget { iterations: self.iterations, time: None },
            ..IkOptions::default()
        })
    }

    /// From poses of the frame, or a dict of poses by frame.
    pub(super) fn targets(
        &self,
        mechanism: &PyMechanism,
        target: &Bound<'_, PyAny>,
    ) -> Result<Targets> {
        let by_name = self.task.as_ref().and_then(|task| task.cast::<PyDict>().ok());
        let goal = |frame: Option<&str>| -> Result<Goal> {
            let end_effector = mechanism.end_effector(frame, self.tool.as_ref())?;
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
            let goal = Goal::pose(end_effector, Pose::IDENTITY);
            Ok(Goal { task, weight: weight.unwrap_or(1.0), ..goal })
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
