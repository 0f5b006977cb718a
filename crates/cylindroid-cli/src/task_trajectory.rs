//! The trajectory of `move` with several tasks, step by step, as CSV or JSON.

use std::io::{self, Write};
use std::path::Path;

use cylindroid::control::{TaskObjective, TaskServo};
use cylindroid::{EndEffector, Mechanism, Result, State};
use serde::Serialize;

use crate::output;
use crate::trajectory::{ActiveLimit, Format, joint_columns, limits_cell, save};

/// A trajectory of several tasks.
#[derive(Debug, Serialize)]
pub(crate) struct TaskTrajectory {
    pub(crate) model: String,
    pub(crate) joint_names: Vec<String>,
    /// "rad" or "m", for each joint.
    pub(crate) units: Vec<&'static str>,
    /// Names of the tasks, in the order of the samples.
    pub(crate) tasks: Vec<String>,
    pub(crate) samples: Vec<TaskRow>,
    #[serde(skip)]
    end_effectors: Vec<Option<EndEffector>>,
    /// False for postures and velocities, which have no direction to scale.
    #[serde(skip)]
    pub(crate) are_scaled: Vec<bool>,
    #[serde(skip)]
    pub(crate) avoids: bool,
    #[serde(skip)]
    state: State,
}

/// One sample.
#[derive(Debug, Serialize)]
pub(crate) struct TaskRow {
    /// [s]
    pub(crate) time: f64,
    /// Before the step.
    pub(crate) q: Vec<f64>,
    /// Commanded by the step.
    pub(crate) joint_velocities: Vec<f64>,
    pub(crate) tasks: Vec<TaskSample>,
    /// Of the nearest pair of bodies [m]; null beyond the margin, and where no distances are kept.
    pub(crate) nearest: Option<f64>,
    /// That bound a joint velocity of the step.
    pub(crate) limits: Vec<ActiveLimit>,
}

/// A task in a sample.
#[derive(Debug, Serialize)]
pub(crate) struct TaskSample {
    /// Of the frame in the world [m]; null for tasks of no frame.
    position: Option<[f64; 3]>,
    /// w, x, y, z
    quaternion: Option<[f64; 4]>,
    /// [m]
    pub(crate) position_error: f64,
    /// [rad]
    pub(crate) orientation_error: f64,
    /// Share of its velocity that is realised [-].
    pub(crate) scale: f64,
}

/// The frame whose pose is recorded.
fn end_effector(objective: &TaskObjective) -> Option<EndEffector> {
    match objective {
        TaskObjective::Frame { end_effector, .. }
        | TaskObjective::RelativeFrame { end_effector, .. }
        | TaskObjective::Gaze { end_effector, .. }
        | TaskObjective::Manipulability { end_effector, .. } => Some(*end_effector),
        _ => None,
    }
}

impl TaskTrajectory {
    pub(crate) fn new(robot: &Mechanism, servo: &TaskServo) -> Result<Self> {
        Ok(Self {
            model: robot.name().to_owned(),
            joint_names: output::joint_names(robot).into_iter().map(str::to_owned).collect(),
            units: robot.coordinates().iter().map(|c| c.kind.unit()).collect(),
            tasks: servo.tasks().iter().map(|task| task.name.clone()).collect(),
            samples: Vec::new(),
            end_effectors: servo.tasks().iter().map(|t| end_effector(&t.objective)).collect(),
            are_scaled: servo
                .tasks()
                .iter()
                .map(|task| !task.objective.is_of_lowest_level())
                .collect(),
            avoids: servo.collision_model().is_some(),
            state: robot.state(robot.home())?,
        })
    }

    /// Adds the sample of a step from `q`.
    pub(crate) fn push(&mut self, time: f64, q: &[f64], servo: &TaskServo) {
        // The servo stepped from this configuration.
        if self.state.set(q).is_err() {
            return;
        }
        let tasks = servo.reports().iter().zip(&self.end_effectors).map(|(report, of)| {
            let pose = of.and_then(|of| self.state.pose(of).ok());
            TaskSample {
                position: pose.map(|pose| pose.translation.to_array()),
                quaternion: pose.map(|pose| {
                    let quaternion = pose.rotation.to_quaternion();
                    [quaternion.w, quaternion.x, quaternion.y, quaternion.z]
                }),
                position_error: report.position_error,
                orientation_error: report.orientation_error,
                scale: report.scale,
            }
        });
        self.samples.push(TaskRow {
            time,
            q: q.to_vec(),
            joint_velocities: servo.joint_velocities().to_vec(),
            tasks: tasks.collect(),
            nearest: servo.near().iter().map(|near| near.distance).reduce(f64::min),
            limits: servo.active_limits().map(|l| ActiveLimit::of(servo.mechanism(), l)).collect(),
        });
    }

    /// Writes all samples.
    pub(crate) fn write(&self, path: &Path, format: Format) -> Result<()> {
        save(path, |file| match format {
            Format::Csv => self.write_csv(file),
            Format::Json => Ok(serde_json::to_writer(file, self)?),
        })
    }

    fn write_csv(&self, file: &mut dyn Write) -> io::Result<()> {
        let mut csv = csv::Writer::from_writer(file);
        let mut header = joint_columns(&self.joint_names);
        for (name, frame) in self.tasks.iter().zip(&self.end_effectors) {
            if frame.is_some() {
                let pose = ["x", "y", "z", "qw", "qx", "qy", "qz"];
                header.extend(pose.map(|part| format!("{name}.{part}")));
            }
            let rest = ["position_error", "orientation_error", "scale"];
            header.extend(rest.map(|part| format!("{name}.{part}")));
        }
        if self.avoids {
            header.push("nearest".to_owned());
        }
        header.push("limits".to_owned());
        csv.write_record(&header)?;
        for row in &self.samples {
            let mut numbers = vec![row.time];
            numbers.extend(row.q.iter().chain(&row.joint_velocities));
            for task in &row.tasks {
                numbers
                    .extend(task.position.iter().flatten().chain(task.quaternion.iter().flatten()));
                numbers.extend([task.position_error, task.orientation_error, task.scale]);
            }
            let nearest = self.avoids.then(|| row.nearest.map_or(String::new(), |x| x.to_string()));
            let limits = limits_cell(&row.limits);
            let cells = numbers.iter().map(f64::to_string).chain(nearest).chain([limits]);
            csv.write_record(cells)?;
        }
        csv.flush()
    }
}
