//! Waypoints from a file.

use std::path::Path;

use cylindroid::control::{CartesianBounds, WaypointMove};
use cylindroid::spatial::Quaternion;
use cylindroid::{Error, Pose, Result, Vec3};

use crate::args::{LawName, PathArgs};
use crate::number_file::{self, Row};

/// The rows of a file.
#[derive(Debug)]
pub(super) struct Waypoints {
    /// Positions, orientations if there are any, and times if there are any.
    rows: Vec<(Option<f64>, Vec3, Option<Quaternion>)>,
    /// True if the rows have orientations.
    pub(super) orientations: bool,
}

impl Waypoints {
    pub(super) fn read(path: &Path) -> Result<Self> {
        let refuse = |reason: String| {
            let value = path.display().to_string();
            Err(Error::InvalidOption { option: "--waypoints", value, reason })
        };
        let all = number_file::rows(path)?;
        let Some(columns) = all.first().map(|row| row.numbers.len()) else {
            return refuse("it has no rows".to_owned());
        };
        let mut rows = Vec::with_capacity(all.len());
        for Row { place, numbers } in all {
            if numbers.len() != columns || ![3, 4, 7, 8].contains(&columns) {
                return refuse(format!(
                    "{place} has {} numbers; rows have 3 (x,y,z), 7 (x,y,z,qw,qx,qy,qz), or a time \
                     and these",
                    numbers.len()
                ));
            }
            let (time, rest) = match columns {
                4 | 8 => (Some(numbers[0]), &numbers[1..]),
                _ => (None, &numbers[..]),
            };
            let quaternion = match rest[3..] {
                [w, x, y, z] => Some(Quaternion { w, x, y, z }),
                _ => None,
            };
            rows.push((time, Vec3::new(rest[0], rest[1], rest[2]), quaternion));
        }
        Ok(Self { orientations: columns >= 7, rows })
    }

    /// The move from a pose through them; without orientations that of the start is kept. Times
    /// begin with the motion.
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
        for (_, translation, quaternion) in &self.rows {
            let rotation = match quaternion {
                None => from.rotation,
                Some(quaternion) => quaternion.rotation()?,
            };
            poses.push(Pose { rotation, translation: *translation });
        }
        let times: Option<Vec<f64>> =
            std::iter::once(Some(0.0)).chain(self.rows.iter().map(|row| row.0)).collect();
        match times {
            Some(times) => WaypointMove::timed(&poses, &times, bounds),
            None => WaypointMove::new(&poses, bounds),
        }
    }
}
