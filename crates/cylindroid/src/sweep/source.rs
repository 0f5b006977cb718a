//! The configurations of a sweep: configuration i is a function of i alone.
//!
//! Formula  samples: lower + x (upper - lower), x the point i of sobol.rs; spherical joints and free
//!          bodies by quaternions uniform on the sphere. Grids: the last axis changes fastest
//! Shapes   q: rows x n, row-major
//! Units    rad, m
//! Valid    grids: mechanisms without loops, whose configurations are free; samples of closed chains are
//!          in closed_samples.rs. Samples: position limits on every slider; a joint without limits is
//!          sampled in [-pi, pi)
//! Source   Shoemake 1992 (uniform rotations)
//! Checked  tests/sweep/sampling.rs

use std::f64::consts::{PI, TAU};
use std::ops::Range;

use super::axis::{Axis, points};
use super::capability::{VoxelGrid, Voxels};
use super::closed_samples::ClosedSamples;
use super::pose_solutions::PoseSolutions;
use super::sobol::Sobol;
use crate::error::{Error, Result};
use crate::kinematics::EndEffector;
use crate::model::{Coordinate, CoordinateKind, Mechanism};
use crate::spatial::{Pose, Quaternion, Rotation, Vec3};
use crate::task::Task;
use crate::tolerance::MAX_MAGNITUDE;

/// The column of poses that are reached.
pub(super) const REACHED: &str = "reached";

/// The configurations of a sweep.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum Source {
    /// Scrambled Sobol' points within the position limits; joints without limits turn through
    /// [-pi, pi). Of a closed chain those of the actuated joints, with the others on the branch of
    /// home; a sample that no straight path of the actuated joints reaches has no numbers.
    Samples {
        /// Number of configurations.
        count: u64,
        /// Selects one of the scrambled sequences.
        seed: u64,
    },
    /// A grid over some coordinates; the last axis changes fastest.
    Grid {
        /// One for each coordinate of the grid.
        axes: Vec<Axis>,
        /// The other coordinates, n numbers (rad or m); home if empty.
        rest: Vec<f64>,
    },
    /// Home alone, for designs: of a closed chain it is closed in each of them.
    Home,
    /// These, one after the other, n numbers each (rad or m).
    Configurations(Vec<f64>),
    /// Poses of the tool, in world axes: of each a configuration that reaches it, by inverse kinematics
    /// from home, and whether there is one (`reached`); rows without one have NaN, counts of 0
    /// and empty names.
    Poses {
        /// One for each row.
        targets: Vec<Pose>,
        /// The components of the pose that count.
        task: Task,
    },
    /// A capability map: no configurations but points of a grid, and orientations of the tool that
    /// inverse kinematics is asked for there. Quantities are indices of which the best value over the
    /// solutions is found.
    Voxels(VoxelGrid),
}

impl Source {
    /// The columns of a file of poses: positions (m), with unit quaternions where rotations count.
    #[must_use]
    pub fn pose_columns(task: Task) -> &'static [&'static str] {
        let count = if task.components[3..].contains(&true) { 7 } else { 3 };
        &["x", "y", "z", "qw", "qx", "qy", "qz"][..count]
    }

    /// [`Source::Poses`] from rows of numbers in the columns of [`Source::pose_columns`]; quaternions of
    /// any length but zero.
    ///
    /// # Errors
    /// A row with another number of numbers, numbers that are not finite, a quaternion without a
    /// direction.
    pub fn poses(numbers: &[f64], task: Task) -> Result<Self> {
        let columns = Self::pose_columns(task).len();
        if !numbers.len().is_multiple_of(columns) {
            return Err(Error::InvalidOption {
                option: "poses",
                value: format!("{} numbers", numbers.len()),
                reason: format!("a row has {columns}: {}", Self::pose_columns(task).join(", ")),
            });
        }
        let pose = |(row, numbers): (usize, &[f64])| {
            for (x, column) in numbers.iter().zip(Self::pose_columns(task)) {
                Error::check_finite(&format!("poses, row {row} from 0, {column}"), &[*x])?;
            }
            let translation = Vec3::new(numbers[0], numbers[1], numbers[2]);
            let rotation = match numbers[3..] {
                [w, x, y, z] => {
                    Quaternion { w, x, y, z }.rotation().map_err(|_| Error::InvalidOption {
                        option: "poses",
                        value: format!("row {row} from 0, quaternion {w}, {x}, {y}, {z}"),
                        reason: "its length must be finite and not zero".to_owned(),
                    })?
                }
                _ => Rotation::IDENTITY,
            };
            Ok(Pose { rotation, translation })
        };
        let targets = numbers.chunks_exact(columns).enumerate().map(pose).collect::<Result<_>>()?;
        Ok(Self::Poses { targets, task })
    }
}

/// A source for a mechanism, checked.
#[derive(Debug, Clone)]
pub(super) struct Configurations {
    pub(super) rows: u64,
    pub(super) n: usize,
    kind: Kind,
}

#[derive(Debug, Clone)]
enum Kind {
    Samples {
        sobol: Sobol,
        ranges: Vec<[f64; 2]>,
        rotations: Vec<usize>,
    },
    Grid {
        axes: Vec<Axis>,
        places: Vec<usize>,
        rest: Vec<f64>,
    },
    Given(Vec<f64>),
    Closed(ClosedSamples),
    Poses(Box<PoseSolutions>),
    /// Points have no configurations of their own.
    Voxels,
}

impl Configurations {
    /// Of a source; the end effector is that of poses.
    pub(super) fn new(
        mechanism: &Mechanism,
        source: &Source,
        end_effector: EndEffector,
    ) -> Result<Self> {
        let n = mechanism.n();
        let free = |option: &'static str| match mechanism.is_closed() {
            false => Ok(()),
            true => Err(Error::InvalidOption {
                option,
                value: mechanism.name().to_owned(),
                reason: "its loops leave no free choice of all coordinates; give closed \
                         configurations (`assemble`) as a file or array"
                    .to_owned(),
            }),
        };
        let (rows, kind) = match source {
            Source::Samples { count, seed } => {
                check_count(*count)?;
                let kind = match mechanism.is_closed() {
                    true => {
                        let range = |c: usize| range(&mechanism.coordinates()[c]);
                        Kind::Closed(ClosedSamples::new(mechanism, *seed, range)?)
                    }
                    false => samples(mechanism, *seed)?,
                };
                (*count, kind)
            }
            Source::Grid { axes, rest } => {
                free("over")?;
                grid(mechanism, axes, rest)?
            }
            Source::Home => (1, Kind::Given(mechanism.home().to_vec())),
            Source::Configurations(q) => {
                let rows = mechanism.count_rows("configurations", q)?;
                mechanism.check_rows("configurations", q)?;
                (rows as u64, Kind::Given(q.clone()))
            }
            Source::Poses { targets, task } => {
                let poses = PoseSolutions::new(mechanism, end_effector, targets, *task)?;
                (poses.rows(), Kind::Poses(Box::new(poses)))
            }
            Source::Voxels(grid) => {
                free("reach")?;
                (Voxels::new(mechanism, grid)?.rows(), Kind::Voxels)
            }
        };
        Ok(Self { rows, n, kind })
    }

    /// True for poses, which may have none.
    pub(super) const fn of_poses(&self) -> bool {
        matches!(self.kind, Kind::Poses(_))
    }

    /// True for samples of a closed chain, which may have none.
    pub(super) const fn of_closed_samples(&self) -> bool {
        matches!(self.kind, Kind::Closed(_))
    }

    /// Those of `rows` into `out`. Samples of a closed chain and poses that have no configuration have
    /// home, and are returned.
    pub(super) fn write(&self, rows: Range<u64>, out: &mut [f64]) -> Result<Vec<usize>> {
        let n = self.n;
        match &self.kind {
            Kind::Voxels => {}
            Kind::Poses(poses) => return poses.write(rows, out),
            Kind::Closed(samples) => return Ok(samples.write(rows, out)),
            Kind::Given(q) => {
                let at = |row: u64| usize::try_from(row).unwrap_or(usize::MAX) * n;
                out.copy_from_slice(&q[at(rows.start)..at(rows.end)]);
            }
            Kind::Grid { axes, places, rest } => {
                for (row, q) in rows.zip(out.chunks_exact_mut(n)) {
                    q.copy_from_slice(rest);
                    let mut left = row;
                    for (axis, place) in axes.iter().zip(places).rev() {
                        q[*place] = axis.value(left % axis.count);
                        left /= axis.count;
                    }
                }
            }
            Kind::Samples { sobol, ranges, rotations } => {
                // Below 2^32, see `samples`.
                sobol.write(u32::try_from(rows.start).unwrap_or(u32::MAX), out);
                for q in out.chunks_exact_mut(n) {
                    for &c in rotations {
                        let point = [q[c], q[c + 1], q[c + 2]];
                        q[c..c + 3].copy_from_slice(&rotation_vector(point));
                    }
                    for (x, [lower, upper]) in q.iter_mut().zip(ranges) {
                        *x = lower + *x * (upper - lower);
                    }
                }
            }
        }
        Ok(Vec::new())
    }
}

fn refuse<T>(value: String, reason: String) -> Result<T> {
    Err(Error::InvalidOption { option: "samples", value, reason })
}

fn check_count(count: u64) -> Result<()> {
    if count == 0 || count > 1 << 32 {
        return refuse(count.to_string(), "1 to 2^32 are possible".to_owned());
    }
    Ok(())
}

/// The range of an angle or a length.
fn range(c: &Coordinate) -> Result<[f64; 2]> {
    let (lower, upper) = (c.limits.lower, c.limits.upper);
    match c.kind {
        _ if lower.is_finite() && upper.is_finite() => Ok([lower, upper]),
        CoordinateKind::Angle if lower.is_infinite() && upper.is_infinite() => Ok([-PI, PI]),
        _ => refuse(
            c.name.clone(),
            format!(
                "coordinate '{}' has no position limits on one side at least ({lower} to {upper} {}); \
                 give it some, or a file of configurations",
                c.name,
                c.kind.unit()
            ),
        ),
    }
}

fn samples(mechanism: &Mechanism, seed: u64) -> Result<Kind> {
    let n = mechanism.n();
    if n > Sobol::DIMENSIONS {
        let most = Sobol::DIMENSIONS;
        let reason = format!("{n} coordinates, and samples have at most {most}; give a file");
        return refuse(mechanism.name().to_owned(), reason);
    }
    let (mut ranges, mut rotations) = (Vec::with_capacity(n), Vec::new());
    for (i, c) in mechanism.coordinates().iter().enumerate() {
        let is_limited = c.limits.lower.is_finite() && c.limits.upper.is_finite();
        ranges.push(match c.kind {
            CoordinateKind::RotationVector if !is_limited => {
                // Three beside one another, of one joint.
                if rotations.last().is_none_or(|&r: &usize| i >= r + 3) {
                    rotations.push(i);
                }
                [0.0, 1.0]
            }
            _ => range(c)?,
        });
    }
    Ok(Kind::Samples { sobol: Sobol::new(n, seed), ranges, rotations })
}

/// The rotation vector of a rotation, uniform if the point of the unit cube is.
fn rotation_vector([a, b, c]: [f64; 3]) -> [f64; 3] {
    let (s, t) = ((1.0 - a).sqrt(), a.sqrt());
    let ((sin_b, cos_b), (sin_c, cos_c)) = ((TAU * b).sin_cos(), (TAU * c).sin_cos());
    let quaternion = Quaternion { w: t * cos_c, x: s * sin_b, y: s * cos_b, z: t * sin_c };
    quaternion.rotation().map_or([0.0; 3], |rotation| rotation.log().to_array())
}

fn grid(mechanism: &Mechanism, axes: &[Axis], rest: &[f64]) -> Result<(u64, Kind)> {
    let refuse = |value: String, reason: &str| {
        Err(Error::InvalidOption { option: "over", value, reason: reason.to_owned() })
    };
    if axes.is_empty() {
        return refuse(String::new(), "a grid has one axis at least");
    }
    let rows = points(axes)?;
    let rest = if rest.is_empty() { mechanism.home() } else { rest };
    mechanism.check_q("q", rest)?;
    let mut places = Vec::with_capacity(axes.len());
    for axis in axes {
        let names = mechanism.coordinates().iter().map(|c| &c.name);
        let place = names.clone().position(|name| *name == axis.name);
        let place = place.ok_or_else(|| Error::unknown("coordinate", &axis.name, names))?;
        if places.contains(&place) {
            return refuse(axis.name.clone(), "a coordinate can be one axis only");
        }
        Error::check_within(&axis.name, &[axis.from, axis.to], MAX_MAGNITUDE)?;
        places.push(place);
    }
    Ok((rows, Kind::Grid { axes: axes.to_vec(), places, rest: rest.to_vec() }))
}
