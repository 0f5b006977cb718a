//! Files of tasks: one `[[task]]` table for each, and tables of half-spaces and boxes.

use std::collections::BTreeMap;
use std::ops::Range;
use std::path::Path;

use cylindroid::control::{HalfSpace, MotionTask, PoseTolerance, Target, Task, TaskObjective};
use cylindroid::model::read_regular_file;
use cylindroid::spatial::{Rpy, Twist};
use cylindroid::{EndEffector, Error, FileError, Mechanism, Pose, ReferenceFrame, State, Vec3};
use serde::Deserialize;
use toml::Spanned;

use crate::number_file::cannot_read;
use crate::values::Joints;

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct File {
    #[serde(default)]
    task: Vec<Spanned<Entry>>,
    #[serde(default)]
    half_space: Vec<Spanned<super::walls::Plane>>,
    #[serde(default, rename = "box")]
    boxes: Vec<Spanned<super::walls::Box>>,
}

/// The largest file of tasks (bytes): 1 MiB, thousands of tasks.
const LARGEST: u64 = 1 << 20;

/// All keys that a task can have.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Entry {
    #[serde(rename = "type")]
    kind: Option<String>,
    name: Option<String>,
    frame: Option<String>,
    reference: Option<String>,
    xyz: Option<[f64; 3]>,
    rpy: Option<[f64; 3]>,
    point: Option<[f64; 3]>,
    tool: Option<[f64; 3]>,
    components: Option<String>,
    axes: Option<String>,
    q: Option<Values>,
    velocities: Option<Values>,
    velocity: Option<[f64; 3]>,
    angular_velocity: Option<[f64; 3]>,
    margin: Option<f64>,
    level: Option<usize>,
    weight: Option<f64>,
    gain: Option<f64>,
    tolerance_position: Option<f64>,
    tolerance_orientation: Option<f64>,
}

/// A number for each coordinate, or for some by name.
#[derive(Debug, Clone, Deserialize)]
#[serde(untagged)]
enum Values {
    All(Vec<f64>),
    Some(BTreeMap<String, f64>),
}

impl From<Values> for Joints {
    fn from(values: Values) -> Self {
        match values {
            Values::All(all) => Self::All(all),
            Values::Some(some) => Self::Some(some.into_iter().collect()),
        }
    }
}

/// The types of tasks, each with the keys that it needs and others that it may have.
const KINDS: [(&str, &[&str], &[&str]); 8] = [
    (
        "frame",
        &["frame"],
        &[
            "xyz",
            "rpy",
            "velocity",
            "angular_velocity",
            "tool",
            "components",
            "axes",
            "level",
            "gain",
        ],
    ),
    (
        "relative_frame",
        &["frame", "reference"],
        &["xyz", "rpy", "tool", "components", "level", "gain"],
    ),
    ("center_of_mass", &["xyz"], &["velocity", "components", "level", "gain"]),
    ("gaze", &["frame", "point"], &["tool", "level", "gain"]),
    ("posture", &["q"], &["gain"]),
    ("joint_velocities", &["velocities"], &[]),
    ("manipulability", &["frame"], &["tool", "components", "gain"]),
    ("limit_avoidance", &[], &["margin", "gain"]),
];

impl Entry {
    /// The names of the keys that are given, except those that all tasks may have.
    fn keys(&self) -> Vec<&'static str> {
        let all = [
            ("frame", self.frame.is_some()),
            ("reference", self.reference.is_some()),
            ("xyz", self.xyz.is_some()),
            ("rpy", self.rpy.is_some()),
            ("point", self.point.is_some()),
            ("tool", self.tool.is_some()),
            ("components", self.components.is_some()),
            ("axes", self.axes.is_some()),
            ("q", self.q.is_some()),
            ("velocities", self.velocities.is_some()),
            ("velocity", self.velocity.is_some()),
            ("angular_velocity", self.angular_velocity.is_some()),
            ("margin", self.margin.is_some()),
            ("level", self.level.is_some()),
            ("gain", self.gain.is_some()),
        ];
        all.into_iter().filter(|(_, given)| *given).map(|(key, _)| key).collect()
    }

    /// The type, if its keys are those that are given.
    fn checked_kind(&self) -> anyhow::Result<&'static str> {
        let name = self.kind.as_deref().unwrap_or("frame");
        let Some((kind, needs, may)) = KINDS.into_iter().find(|(kind, ..)| *kind == name) else {
            return Err(Error::unknown("type of task", name, KINDS.map(|k| k.0)).into());
        };
        let keys = self.keys();
        if let Some(missing) = needs.iter().find(|key| !keys.contains(key)) {
            anyhow::bail!("a task of type {kind} needs the key '{missing}'");
        }
        if let Some(foreign) = keys.iter().find(|key| !needs.contains(key) && !may.contains(key)) {
            let own: Vec<&str> = needs.iter().chain(may).copied().collect();
            anyhow::bail!(
                "'{foreign}' does not belong to a task of type {kind}, which has {}",
                own.join(", ")
            );
        }
        Ok(kind)
    }

    fn end_effector(&self, robot: &Mechanism, name: Option<&str>) -> anyhow::Result<EndEffector> {
        let frame = robot.frame(name.unwrap_or_default())?;
        let tool = Vec3::from_array(self.tool.unwrap_or_default());
        Ok(EndEffector { frame, frame_from_tool: Pose::from_translation(tool) })
    }

    /// The target, with the parts that are not given as in `start`; and the components, by default
    /// those of the parts that are given.
    fn target(&self, start: Pose, robot: &Mechanism) -> anyhow::Result<(Pose, Task)> {
        let translation = self.xyz.map_or(start.translation, Vec3::from_array);
        let rotation = self
            .rpy
            .map_or(start.rotation, |[roll, pitch, yaw]| Rpy { roll, pitch, yaw }.rotation());
        let usual = match (self.xyz, self.rpy) {
            (Some(_), None) => "position",
            (None, Some(_)) => "orientation",
            _ => "pose",
        };
        let mut task = Task::named(self.components.as_deref().unwrap_or(usual), robot)?;
        match self.axes.as_deref() {
            None => {}
            Some("world") => task.axes = ReferenceFrame::LocalWorldAligned,
            Some("local") => task.axes = ReferenceFrame::Local,
            Some(name) => return Err(Error::unknown("axes", name, ["world", "local"]).into()),
        }
        Ok((Pose { rotation, translation }, task))
    }

    /// The objective and its usual name.
    fn objective(&self, start: &State) -> anyhow::Result<(TaskObjective, String)> {
        let robot = start.mechanism();
        let frame = || self.end_effector(robot, self.frame.as_deref());
        let of_frame = self.frame.clone().unwrap_or_default();
        Ok(match self.checked_kind()? {
            "frame" => {
                let end_effector = frame()?;
                let (pose, components) = self.target(start.pose(end_effector)?, robot)?;
                let twist = Twist {
                    linear: Vec3::from_array(self.velocity.unwrap_or_default()),
                    angular: Vec3::from_array(self.angular_velocity.unwrap_or_default()),
                };
                let target = Target { feed_forward: twist, ..Target::from(pose) };
                (TaskObjective::Frame { end_effector, components, target }, of_frame)
            }
            "relative_frame" => {
                let end_effector = frame()?;
                let name = self.reference.clone().unwrap_or_default();
                let reference = EndEffector::from(robot.frame(&name)?);
                let seen = start.pose(reference)?.inverse() * start.pose(end_effector)?;
                let (target, components) = self.target(seen, robot)?;
                (
                    TaskObjective::RelativeFrame { end_effector, reference, components, target },
                    format!("{of_frame} from {name}"),
                )
            }
            "center_of_mass" => {
                let components = self.components.as_deref().unwrap_or("x,y,z");
                let task = Task::named(components, robot)?;
                let [x, y, z, rotations @ ..] = task.components;
                if rotations.contains(&true) {
                    anyhow::bail!("the centre of mass has the components x, y and z");
                }
                let target = Vec3::from_array(self.xyz.unwrap_or_default());
                let (axes, velocity) = ([x, y, z], self.velocity.unwrap_or_default());
                let velocity = Vec3::from_array(velocity);
                (TaskObjective::CenterOfMass { axes, target, velocity }, "center_of_mass".into())
            }
            "gaze" => {
                let point = Vec3::from_array(self.point.unwrap_or_default());
                (TaskObjective::Gaze { end_effector: frame()?, point }, "gaze".to_owned())
            }
            "posture" => {
                let q = self.q.clone().map(Joints::from).unwrap_or(Joints::Home);
                (
                    TaskObjective::Posture { q: q.configuration(robot, None, false)? },
                    "posture".into(),
                )
            }
            "manipulability" => {
                let task = Task::named(self.components.as_deref().unwrap_or("pose"), robot)?;
                let objective =
                    TaskObjective::Manipulability { end_effector: frame()?, components: task };
                (objective, "manipulability".to_owned())
            }
            "limit_avoidance" => {
                let margin = self.margin.unwrap_or(0.1);
                (TaskObjective::LimitAvoidance { margin }, "limit_avoidance".to_owned())
            }
            _ => {
                let all = self.velocities.clone().map(Joints::from).unwrap_or(Joints::Zero);
                let velocities = all.velocities(robot, false)?;
                (TaskObjective::JointVelocities { velocities }, "joint_velocities".into())
            }
        })
    }

    /// The task, with the values of `usual` where none are given.
    fn task(&self, start: &State, usual: &MotionTask) -> anyhow::Result<MotionTask> {
        let (objective, name) = self.objective(start)?;
        // Gradients have gains of their own.
        let gain = match objective {
            TaskObjective::Manipulability { .. } | TaskObjective::LimitAvoidance { .. } => 1.0,
            _ => usual.gain,
        };
        let PoseTolerance { position, orientation } = usual.tolerance;
        Ok(MotionTask {
            level: self.level.unwrap_or(usual.level),
            weight: self.weight.unwrap_or(usual.weight),
            gain: self.gain.unwrap_or(gain),
            tolerance: PoseTolerance {
                position: self.tolerance_position.unwrap_or(position),
                orientation: self.tolerance_orientation.unwrap_or(orientation),
            },
            ..MotionTask::new(self.name.as_deref().unwrap_or(&name), objective)
        })
    }
}

/// The tasks and the half-spaces of a file.
pub(crate) fn load(
    path: &Path,
    start: &State,
    usual: &MotionTask,
) -> anyhow::Result<(Vec<MotionTask>, Vec<HalfSpace>)> {
    let text = String::from_utf8(read_regular_file(path, LARGEST)?)
        .map_err(|_| cannot_read(path, "it is not UTF-8"))?;
    let at = |span: Range<usize>, message: String| error(path, &text, span, message);
    let file: File = toml::from_str(&text)
        .map_err(|error| at(error.span().unwrap_or(0..0), error.message().to_owned()))?;
    if file.task.is_empty() && file.half_space.is_empty() && file.boxes.is_empty() {
        return Err(at(0..0, "there is no [[task]]".to_owned()).into());
    }
    let one = |entry: &Spanned<Entry>| {
        let task = entry.get_ref().task(start, usual);
        task.map_err(|error| at(entry.span(), format!("{error:#}")).into())
    };
    let tasks = file.task.iter().map(one).collect::<anyhow::Result<Vec<_>>>()?;
    let robot = start.mechanism();
    let mut walls = Vec::new();
    for plane in &file.half_space {
        let wall = plane.get_ref().half_space(robot);
        walls.push(wall.map_err(|error| at(plane.span(), error.to_string()))?);
    }
    for entry in &file.boxes {
        let six = entry.get_ref().half_spaces(robot);
        walls.extend(six.map_err(|error| at(entry.span(), error.to_string()))?);
    }
    Ok((tasks, walls))
}

fn error(path: &Path, text: &str, span: Range<usize>, message: String) -> Error {
    let before = &text[..text.floor_char_boundary(span.start)];
    let line_start = before.rfind('\n').map_or(0, |i| i + 1);
    Error::File(Box::new(FileError {
        format: "file of tasks",
        path: path.to_owned(),
        line: before.matches('\n').count() + 1,
        column: before[line_start..].chars().count() + 1,
        span,
        message,
        help: String::new(),
    }))
}
