//! The trajectory of `move`, step by step, as CSV or JSON.

use std::io::{self, BufWriter, Write};
use std::path::Path;

use cylindroid::control::{LimitKind, TrajectorySample};
use cylindroid::{Error, Mechanism, Result};
use serde::Serialize;

use crate::{output, output_file};

/// A trajectory.
#[derive(Debug, Serialize)]
pub(crate) struct Trajectory {
    pub(crate) model: String,
    pub(crate) frame: String,
    pub(crate) joint_names: Vec<String>,
    /// "rad" or "m", for each joint.
    pub(crate) units: Vec<&'static str>,
    pub(crate) samples: Vec<Row>,
    #[serde(skip)]
    robot: Mechanism,
}

/// One sample.
#[derive(Debug, Serialize)]
pub(crate) struct Row {
    /// [s]
    pub(crate) time: f64,
    /// Before the step.
    pub(crate) q: Vec<f64>,
    /// Commanded by the step.
    pub(crate) joint_velocities: Vec<f64>,
    /// Of the tool in the world [m].
    pub(crate) position: [f64; 3],
    /// w, x, y, z
    pub(crate) quaternion: [f64; 4],
    /// [m]
    pub(crate) position_error: f64,
    /// [rad]
    pub(crate) orientation_error: f64,
    pub(crate) singular_ratio: f64,
    /// That bound a joint velocity of the step.
    pub(crate) limits: Vec<ActiveLimit>,
}

/// A limit that bounds a joint velocity.
#[derive(Debug, Clone, Serialize)]
pub(crate) struct ActiveLimit {
    joint: String,
    kind: &'static str,
}

impl ActiveLimit {
    pub(crate) fn of(robot: &Mechanism, (velocity, kind): (usize, LimitKind)) -> Self {
        Self { joint: robot.velocity_name(velocity).to_owned(), kind: kind.name() }
    }
}

/// The format of a file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Format {
    Csv,
    Json,
}

/// The format given by the extension of a file.
pub(crate) fn format_of(path: &Path) -> Result<Format> {
    match path.extension().and_then(|e| e.to_str()) {
        Some("csv") => Ok(Format::Csv),
        Some("json") => Ok(Format::Json),
        _ => Err(Error::InvalidOption {
            option: "--out",
            value: path.display().to_string(),
            reason: "the name must end in .csv or .json".to_owned(),
        }),
    }
}

impl Trajectory {
    pub(crate) fn new(robot: &Mechanism, frame: &str) -> Self {
        Self {
            model: robot.name().to_owned(),
            frame: frame.to_owned(),
            joint_names: output::joint_names(robot).into_iter().map(str::to_owned).collect(),
            units: robot.coordinates().iter().map(|c| c.kind.unit()).collect(),
            samples: Vec::new(),
            robot: robot.clone(),
        }
    }

    /// Removes all samples.
    pub(crate) fn clear(&mut self) {
        self.samples.clear();
    }

    pub(crate) fn push(&mut self, sample: &TrajectorySample<'_>) {
        let pose = sample.step.pose;
        let quaternion = pose.rotation.to_quaternion();
        self.samples.push(Row {
            time: sample.time,
            q: sample.q.to_vec(),
            joint_velocities: sample.joint_velocities.to_vec(),
            position: pose.translation.to_array(),
            quaternion: [quaternion.w, quaternion.x, quaternion.y, quaternion.z],
            position_error: sample.step.position_error,
            orientation_error: sample.step.orientation_error,
            singular_ratio: sample.step.singular_ratio,
            limits: sample.limits.iter().map(|l| ActiveLimit::of(&self.robot, *l)).collect(),
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
        let rest = ["x", "y", "z", "qw", "qx", "qy", "qz"];
        header.extend(rest.map(str::to_owned));
        let rest = ["position_error", "orientation_error", "singular_ratio", "limits"];
        header.extend(rest.map(str::to_owned));
        csv.write_record(&header)?;
        for row in &self.samples {
            let errors = [row.position_error, row.orientation_error, row.singular_ratio];
            let numbers = std::iter::once(&row.time)
                .chain(&row.q)
                .chain(&row.joint_velocities)
                .chain(&row.position)
                .chain(&row.quaternion)
                .chain(&errors);
            let limits = limits_cell(&row.limits);
            csv.write_record(numbers.map(f64::to_string).chain([limits]))?;
        }
        csv.flush()
    }
}

/// The names of the first columns: time, positions and velocities of the joints.
pub(crate) fn joint_columns(joint_names: &[String]) -> Vec<String> {
    let positions = joint_names.iter().map(|name| format!("q.{name}"));
    let velocities = joint_names.iter().map(|name| format!("velocity.{name}"));
    std::iter::once("time".to_owned()).chain(positions).chain(velocities).collect()
}

/// Limits in a cell: `shoulder velocity; elbow position`.
pub(crate) fn limits_cell(limits: &[ActiveLimit]) -> String {
    let words = limits.iter().map(|limit| format!("{} {}", limit.joint, limit.kind));
    words.collect::<Vec<_>>().join("; ")
}

/// Writes a file.
pub(crate) fn save(
    path: &Path,
    write: impl FnOnce(&mut dyn Write) -> io::Result<()>,
) -> Result<()> {
    let written = output_file::create(path).and_then(|file| {
        let mut file = BufWriter::new(file);
        write(&mut file)?;
        file.into_inner()?.finish()
    });
    written.map(drop).map_err(|error| cannot_write(path, &error))
}

/// The error of a file that cannot be written.
pub(crate) fn cannot_write(path: &Path, error: &dyn std::fmt::Display) -> Error {
    Error::Io { path: path.to_owned(), action: "write", message: error.to_string() }
}
