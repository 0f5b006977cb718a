//! The report of `move` with several tasks: the table and the JSON object.

use std::io::Write;

use cylindroid::control::{LimitKind, MotionTask, Status, StoppedBy, TaskMotionResult, TaskReport};
use serde::Serialize;

use super::job::TaskJob;
use crate::commands::shared::Style;
use crate::output::{self, Align};

#[derive(Debug, Serialize)]
struct TasksJson<'a> {
    model: &'a str,
    joint_names: Vec<&'a str>,
    reached: bool,
    /// "reached", "limits", "distance", "priorities", "slow", "time-limit".
    reason: &'static str,
    explanation: String,
    q: &'a [f64],
    /// The largest of the tasks that are not postures or joint velocities [m].
    position_error: f64,
    /// [rad]
    orientation_error: f64,
    steps: usize,
    time: f64,
    limits_hit: Vec<LimitJson<'a>>,
    tasks: Vec<TaskJson<'a>>,
    /// With --avoid.
    #[serde(skip_serializing_if = "Option::is_none")]
    distances: Option<DistancesJson<'a>>,
    start: &'a [f64],
}

#[derive(Debug, Serialize)]
struct TaskJson<'a> {
    name: &'a str,
    level: Option<usize>,
    weight: f64,
    status: &'static str,
    position_error: f64,
    orientation_error: f64,
    scale: f64,
    left_out: f64,
    limit: Option<LimitJson<'a>>,
    pair: Option<[&'a str; 2]>,
    /// The half-space that stops it.
    half_space: Option<&'a str>,
}

#[derive(Debug, Serialize)]
struct LimitJson<'a> {
    joint: &'a str,
    kind: &'static str,
}

#[derive(Debug, Serialize)]
struct DistancesJson<'a> {
    /// [m]
    gap: f64,
    margin: f64,
    obstacles: Vec<&'a str>,
    /// Number of watched pairs.
    pairs: usize,
    /// The nearest that two bodies came; null if none came nearer than the margin.
    nearest: Option<NearestJson<'a>>,
}

#[derive(Debug, Serialize)]
struct NearestJson<'a> {
    a: &'a str,
    b: &'a str,
    distance: f64,
}

/// A job with its result.
#[derive(Debug)]
pub(super) struct Report<'a> {
    pub(super) job: &'a TaskJob,
    pub(super) result: &'a TaskMotionResult,
}

impl<'a> Report<'a> {
    pub(super) fn write(&self, style: Style, out: &mut dyn Write) -> anyhow::Result<()> {
        match style {
            Style::Json => output::json(out, &self.json()),
            Style::Table => self.print(out),
        }
    }

    fn tasks(&self) -> impl Iterator<Item = (&'a MotionTask, &'a TaskReport)> {
        self.job.servo.tasks().iter().zip(&self.result.reports)
    }

    /// Names of a pair of bodies.
    fn pair(&self, index: usize) -> [&'a str; 2] {
        self.job.servo.collision_model().map_or([""; 2], |model| model.names(index))
    }

    fn joint(&self, index: usize) -> &'a str {
        self.job.robot.velocity_name(index)
    }

    fn half_space(&self, index: usize) -> &'a str {
        &self.job.servo.half_spaces()[index].name
    }

    fn limit(&self, (index, kind): (usize, LimitKind)) -> LimitJson<'a> {
        LimitJson { joint: self.joint(index), kind: kind.name() }
    }

    /// The limit or the pair that stops a task.
    fn stopped_by(&self, report: &TaskReport) -> String {
        match report.stopped_by {
            None => String::new(),
            Some(StoppedBy::Limit { coordinate, kind }) => {
                format!("{} limit of {}", kind.name(), self.joint(coordinate))
            }
            Some(StoppedBy::Distance { pair }) => {
                let [a, b] = self.pair(pair);
                format!("distance of {a} and {b}")
            }
            Some(StoppedBy::HalfSpace { index }) => {
                format!("half-space '{}'", self.half_space(index))
            }
            Some(StoppedBy::TypeII) => "type II singularity that is near".to_owned(),
        }
    }

    /// The first task that keeps the motion from being reached.
    fn open(&self) -> Option<(&'a MotionTask, &'a TaskReport)> {
        if self.result.status == Status::Reached {
            return None;
        }
        let has_rows = self.tasks().any(|(task, _)| !task.objective.is_of_lowest_level());
        self.tasks().find(|(task, report)| {
            report.status != Status::Reached && !(has_rows && task.objective.is_of_lowest_level())
        })
    }

    fn reason(&self) -> &'static str {
        let Some((_, open)) = self.open() else { return "reached" };
        if self.result.reports.iter().any(|r| r.status == Status::Moving) {
            return "time-limit";
        }
        match open.stopped_by {
            Some(StoppedBy::Limit { .. }) => "limits",
            Some(StoppedBy::Distance { .. }) => "distance",
            Some(StoppedBy::HalfSpace { .. }) => "half-space",
            Some(StoppedBy::TypeII) => "type-ii",
            None if open.left_out > 0.5 => "priorities",
            None => "slow",
        }
    }

    fn explanation(&self) -> String {
        let Some((task, open)) = self.open() else { return String::new() };
        let name = &task.name;
        match self.reason() {
            "time-limit" => format!("'{name}' was still moving at the time limit (--time-limit)"),
            "priorities" => format!(
                "'{name}' has {} of the velocity of its level: other tasks of this level or higher \
                 ones contradict it, or the configuration is singular",
                output::number(1.0 - open.left_out)
            ),
            "slow" => format!("'{name}' makes no progress; no limit stops it"),
            _ => format!("'{name}' is stopped by the {}", self.stopped_by(open)),
        }
    }

    fn largest(&self, of: impl Fn(&TaskReport) -> f64) -> f64 {
        let counted = self.tasks().filter(|(task, _)| !task.objective.is_of_lowest_level());
        counted.map(|(_, report)| of(report)).fold(0.0, f64::max)
    }

    fn json(&self) -> TasksJson<'a> {
        let (job, result) = (self.job, self.result);
        let tasks = self.tasks().map(|(task, report)| TaskJson {
            name: &task.name,
            level: (!task.objective.is_of_lowest_level()).then_some(task.level),
            weight: task.weight,
            status: report.status.name(),
            position_error: report.position_error,
            orientation_error: report.orientation_error,
            scale: report.scale,
            left_out: report.left_out,
            limit: match report.stopped_by {
                Some(StoppedBy::Limit { coordinate, kind }) => Some(self.limit((coordinate, kind))),
                _ => None,
            },
            pair: match report.stopped_by {
                Some(StoppedBy::Distance { pair }) => Some(self.pair(pair)),
                _ => None,
            },
            half_space: match report.stopped_by {
                Some(StoppedBy::HalfSpace { index }) => Some(self.half_space(index)),
                _ => None,
            },
        });
        let model = job.servo.collision_model();
        let distances = job.distances.zip(model).map(|((gap, margin), model)| DistancesJson {
            gap,
            margin,
            obstacles: model.obstacles().collect(),
            pairs: model.pairs().len(),
            nearest: result.nearest.map(|near| {
                let [a, b] = self.pair(near.pair);
                NearestJson { a, b, distance: near.distance }
            }),
        });
        TasksJson {
            model: job.robot.name(),
            joint_names: output::joint_names(&job.robot),
            reached: result.status == Status::Reached,
            reason: self.reason(),
            explanation: self.explanation(),
            q: &result.q,
            position_error: self.largest(|r| r.position_error),
            orientation_error: self.largest(|r| r.orientation_error),
            steps: result.steps,
            time: result.time,
            limits_hit: result.limits_hit.iter().map(|hit| self.limit(*hit)).collect(),
            tasks: tasks.collect(),
            distances,
            start: &job.start,
        }
    }

    fn print(&self, out: &mut dyn Write) -> anyhow::Result<()> {
        let (job, result) = (self.job, self.result);
        let reached = result.status == Status::Reached;
        let nearest = match (job.distances, result.nearest) {
            (None, _) => String::new(),
            (Some((_, margin)), None) => format!("none within {} m", output::number(margin)),
            (Some(_), Some(near)) => {
                let [a, b] = self.pair(near.pair);
                format!("{a} and {b} at {} m", output::number(near.distance))
            }
        };
        output::pairs(
            out,
            [
                ("model", job.robot.name().to_owned()),
                ("result", if reached { "reached" } else { "not reached" }.to_owned()),
                ("reason", self.explanation()),
                ("steps", result.steps.to_string()),
                ("time [s]", output::number(result.time)),
                ("nearest bodies", nearest),
                ("limits met", super::super::sentences::limits_met(&job.robot, &result.limits_hit)),
                ("final q [rad or m]", output::entries(&result.q)),
            ],
        )?;
        let columns = [
            ("task", Align::Left),
            ("level", Align::Right),
            ("status", Align::Left),
            ("error [m]", Align::Right),
            ("error [rad]", Align::Right),
            ("left out", Align::Right),
            ("stopped by", Align::Left),
        ];
        let rows = self.tasks().map(|(task, report)| {
            let is_lowest = task.objective.is_of_lowest_level();
            vec![
                task.name.clone(),
                if is_lowest { "lowest".to_owned() } else { task.level.to_string() },
                report.status.name().to_owned(),
                output::number(report.position_error),
                output::number(report.orientation_error),
                output::number(output::without_rounding(report.left_out)),
                self.stopped_by(report),
            ]
        });
        writeln!(out)?;
        Ok(output::table(out, &columns, rows)?)
    }
}
