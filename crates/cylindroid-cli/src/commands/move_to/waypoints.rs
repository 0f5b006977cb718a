//! Waypoints from a file.

use std::path::{Path, PathBuf};

use cylindroid::control::{CartesianBounds, WaypointMove};
use cylindroid::spatial::{Quaternion, Rpy};
use cylindroid::{Error, Pose, Result, Rotation, Vec3};

use super::waypoint_columns::{Columns, Orientation};
use crate::args::{LawName, PathArgs};
use crate::number_file::{self, Row};

/// The rows of a file.
#[derive(Debug)]
pub(super) struct Waypoints {
    path: PathBuf,
    rows: Vec<Waypoint>,
    /// True if the rows have orientations.
    pub(super) orientations: bool,
}

#[derive(Debug)]
struct Waypoint {
    time: Option<f64>,
    /// On the way to it (m/s).
    speed: Option<f64>,
    position: Vec3,
    rotation: Option<Rotation>,
}

impl Waypoints {
    /// Roll, pitch and yaw in degrees if `degrees`.
    pub(super) fn read(path: &Path, degrees: bool) -> Result<Self> {
        let refuse = |reason: String| refused(path, reason);
        let (names, all) = number_file::named_rows(path)?;
        let Some(first) = all.first() else {
            return Err(refuse("it has no rows".to_owned()));
        };
        let columns = match &names {
            Some(names) => Columns::named(names).map_err(refuse)?,
            None => {
                Columns::of_count(first.numbers.len()).ok_or_else(|| refuse(count(first, None)))?
            }
        };
        let mut rows = Vec::with_capacity(all.len());
        let mut before = 0.0;
        for row in &all {
            if row.numbers.len() != columns.count() {
                return Err(refuse(count(row, names.as_deref())));
            }
            let waypoint = columns.waypoint(row, degrees).map_err(refuse)?;
            if let Some(time) = waypoint.time {
                if time <= before {
                    let of = if rows.is_empty() { "the start" } else { "the row before" };
                    let place = &row.place;
                    return Err(refuse(format!(
                        "{place}: the time {time} s must be after that of {of}, {before} s"
                    )));
                }
                before = time;
            }
            rows.push(waypoint);
        }
        let orientations = !matches!(columns.orientation, Orientation::Kept);
        Ok(Self { path: path.to_owned(), rows, orientations })
    }

    /// True if the rows have times.
    pub(super) fn are_timed(&self) -> bool {
        self.rows.iter().any(|row| row.time.is_some())
    }

    /// True if the rows have speeds.
    pub(super) fn have_speeds(&self) -> bool {
        self.rows.iter().any(|row| row.speed.is_some())
    }

    /// The move from a pose through them; without orientations that of the start is kept. Times
    /// begin with the motion; a speed is that from the row before, or from the start, to its row.
    pub(super) fn motion(
        &self,
        from: Pose,
        bounds: CartesianBounds,
        args: &PathArgs,
    ) -> Result<WaypointMove> {
        if args.law == LawName::JerkLimited {
            return Err(Error::InvalidOption {
                option: "--law",
                value: "jerk-limited".to_owned(),
                reason: "moves through waypoints have constant accelerations in their blends; \
                         leave it out"
                    .to_owned(),
            });
        }
        let mut poses = vec![from];
        poses.extend(self.rows.iter().map(|row| Pose {
            rotation: row.rotation.unwrap_or(from.rotation),
            translation: row.position,
        }));
        let times: Option<Vec<f64>> =
            std::iter::once(Some(0.0)).chain(self.rows.iter().map(|row| row.time)).collect();
        let speeds: Option<Vec<f64>> = self.rows.iter().map(|row| row.speed).collect();
        let motion = match (times, speeds) {
            (Some(times), _) => WaypointMove::timed(&poses, &times, bounds),
            (None, Some(speeds)) => WaypointMove::with_speeds(&poses, &speeds, bounds),
            (None, None) => WaypointMove::new(&poses, bounds),
        };
        motion.map_err(|error| match error {
            Error::InvalidOption {
                option: option @ ("waypoints" | "times of the waypoints"),
                value,
                reason,
            } => refused(&self.path, format!("{option} {value}: {reason}")),
            other => other,
        })
    }
}

impl Columns {
    fn waypoint(&self, row: &Row, degrees: bool) -> std::result::Result<Waypoint, String> {
        let Row { place, numbers } = row;
        if let Some(i) = numbers.iter().position(|x| !x.is_finite()) {
            let (name, x) = (self.name(i), numbers[i]);
            return Err(format!("{place}, column {} ({name}): {x} is not finite", i + 1));
        }
        let speed = self.speed.map(|i| (i, numbers[i]));
        if let Some((i, speed)) = speed.filter(|(_, speed)| *speed <= 0.0) {
            return Err(format!("{place}, column {} (speed): {speed} m/s must be positive", i + 1));
        }
        let rotation = match self.orientation {
            Orientation::Kept => None,
            Orientation::Quaternion(columns) => {
                let [w, x, y, z] = columns.map(|i| numbers[i]);
                let rotation = Quaternion { w, x, y, z }.rotation();
                Some(rotation.map_err(|error| format!("{place}: {error}"))?)
            }
            Orientation::RollPitchYaw(columns) => {
                let si = |x: f64| if degrees { x.to_radians() } else { x };
                let [roll, pitch, yaw] = columns.map(|i| si(numbers[i]));
                Some(Rpy { roll, pitch, yaw }.rotation())
            }
        };
        Ok(Waypoint {
            time: self.time.map(|i| numbers[i]),
            speed: speed.map(|(_, speed)| speed),
            position: Vec3::from_array(self.position.map(|i| numbers[i])),
            rotation,
        })
    }
}

/// Says that a row has another count of numbers than it should.
fn count(row: &Row, names: Option<&[String]>) -> String {
    let expected = match names {
        Some(names) => format!("the header names {} ({})", names.len(), names.join(",")),
        None => "rows have 3 (x,y,z), 7 (x,y,z,qw,qx,qy,qz), or a time and these, or a header \
                 that names their columns"
            .to_owned(),
    };
    format!("{} has {} numbers; {expected}", row.place, row.numbers.len())
}

fn refused(path: &Path, reason: String) -> Error {
    Error::InvalidOption { option: "--waypoints", value: path.display().to_string(), reason }
}
