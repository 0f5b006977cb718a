//! The quantities of a range of configurations, by the batches of the other modules.
//!
//! Shapes   rows in blocks of [`BLOCK`], small enough for the caches; results in columns
//! Why so   every batch gives a configuration the same numbers whatever its place, so the blocks
//!          change nothing, nor does the number of threads, each of which computes parts alone
//! Checked  tests/sweep/parts.rs, tests/sweep/quantities.rs

use std::ops::Range;
use std::slice::IterMut;

use super::capability::{Search, Voxels};
use super::clearances::Clearances;
use super::columns::append;
use super::measures::{measures, velocity_limits};
use super::options::{SweepOptions, VelocityMetric};
use super::payload::Payload;
use super::poses::{self, POSE};
use super::quantity::{PITCHES, Quantity};
use super::relative::Relative;
use super::singular_values::SingularValues;
use super::source::{Configurations, Source};
use super::table::{Column, Values, begin};
use crate::error::{Error, Result};
use crate::kinematics::{EndEffector, KinematicsBatch, ReferenceFrame};
use crate::linalg::Matrix;
use crate::manipulability::ManipulabilityBatch;
use crate::model::{Dimension, Mechanism};
use crate::screws::{ScrewOptions, ScrewSystem};
use crate::task::Task;

/// Rows computed at once.
const BLOCK: usize = 1024;

/// Computes rows.
#[derive(Debug, Clone)]
pub(super) struct Evaluator {
    pub(super) mechanism: Mechanism,
    pub(super) quantities: Vec<Quantity>,
    pub(super) end_effector: EndEffector,
    /// Components of the twist that measures see.
    pub(super) task: Vec<usize>,
    pub(super) length: f64,
    kinematics: KinematicsBatch,
    /// In place of them, of a frame seen from another.
    pub(super) relative: Option<Relative>,
    /// Of the Jacobian with linear rows over the length.
    scaled: SingularValues,
    yoshikawa: Volume,
    payload: Option<Payload>,
    measures: Option<ManipulabilityBatch>,
    pub(super) clearances: Option<Clearances>,
    /// Of a capability map.
    pub(super) search: Option<Search>,
}

/// How the product of the singular values in the metric is found.
#[derive(Debug, Clone)]
enum Volume {
    /// From the scaled ones: scaling rows of a wide matrix scales the product.
    Factor(f64),
    /// From others.
    Own(SingularValues),
}

impl Evaluator {
    pub(super) fn new(mechanism: &Mechanism, options: &SweepOptions) -> Result<Self> {
        let wants = |quantity| options.quantities.contains(&quantity);
        let (end_effector, length) = options.place(mechanism)?;
        Error::check_finite("direction", &options.direction.to_array())?;
        let relative = Relative::new(mechanism, options, end_effector)?;
        if mechanism.is_closed()
            && let Some(quantity) = options.quantities.iter().find(|q| !q.has_loops())
        {
            return Err(Error::InvalidOption {
                option: "quantities",
                value: quantity.name().to_owned(),
                reason: format!(
                    "'{}' is a closed chain, whose Jacobian depends on its loops; use measures",
                    mechanism.name()
                ),
            });
        }
        // Of poses, the task is also that of inverse kinematics, which takes others.
        let sees = options.quantities.iter().any(|q| q.sees_task());
        let of_poses = matches!(options.source, Source::Poses { .. });
        let task = components(mechanism, options.task.filter(|_| sees || !of_poses))?;
        let factor = |i: &usize| if *i < 3 { 1.0 / length } else { 1.0 };
        let rows: Vec<(usize, f64)> = task.iter().map(|i| (*i, factor(i))).collect();
        let scaled = SingularValues::new(rows.clone(), vec![1.0; mechanism.n()]);
        let yoshikawa = if wants(Quantity::Yoshikawa) {
            volume(mechanism, options.metric, rows, length)?
        } else {
            Volume::Factor(1.0)
        };
        let payload = if wants(Quantity::Payload) {
            Some(Payload::new(mechanism, end_effector, options.direction)?)
        } else {
            None
        };
        let measures = if wants(Quantity::Measures) {
            Some(measures(mechanism, options, (end_effector, &task), length)?)
        } else {
            None
        };
        let search = match &options.source {
            Source::Voxels(grid) => {
                let voxels = Voxels::new(mechanism, grid)?;
                Some(Search::new(mechanism, end_effector, (voxels, length))?)
            }
            _ => None,
        };
        Ok(Self {
            mechanism: mechanism.clone(),
            quantities: options.quantities.clone(),
            end_effector,
            task,
            length,
            kinematics: KinematicsBatch::new(mechanism, end_effector)?,
            relative,
            scaled,
            yoshikawa,
            payload,
            measures,
            clearances: Clearances::new(mechanism, options)?,
            search,
        })
    }

    /// Number of singular values.
    pub(super) fn values(&self) -> usize {
        self.scaled.len()
    }

    fn wants(&self, quantities: &[Quantity]) -> bool {
        quantities.iter().any(|q| self.quantities.contains(q))
    }

    /// The rows, in the columns of the sweep.
    pub(super) fn run(
        &self,
        from: &Configurations,
        columns: &[Column],
        rows: Range<u64>,
        out: &mut Vec<Values>,
    ) -> Result<()> {
        let n = self.mechanism.n();
        let all = usize::try_from(rows.end - rows.start).unwrap_or(0);
        begin(out, columns, all);
        let mut scratch = Scratch::new(self, all.min(BLOCK));
        let mut start = rows.start;
        while start < rows.end {
            let end = rows.end.min(start + BLOCK as u64);
            let count = usize::try_from(end - start).unwrap_or(0);
            scratch.count = count;
            let absent = from.write(start..end, &mut scratch.q[..count * n])?;
            let mut columns = out.iter_mut();
            if let Some(Values::Counts(index)) = columns.next() {
                index.extend(start..end);
            }
            put(&scratch.q[..count * n], n, n, &mut columns);
            if from.of_poses()
                && let Some(Values::Counts(reached)) = columns.next()
            {
                reached.extend(std::iter::repeat_n(1, count));
            }
            self.block(&mut scratch, start, &mut columns)?;
            let first = usize::try_from(start - rows.start).unwrap_or(0);
            for values in out.iter_mut().skip(1) {
                absent.iter().for_each(|row| values.blank(first + row));
            }
            start = end;
        }
        Ok(())
    }

    /// The quantities of these configurations, at most as many as `s` has memory for.
    pub(super) fn of_configurations(
        &self,
        s: &mut Scratch,
        q: &[f64],
        columns: &mut [Values],
    ) -> Result<()> {
        columns.iter_mut().for_each(|values| values.begin(q.len()));
        s.count = q.len() / self.mechanism.n();
        s.q[..q.len()].copy_from_slice(q);
        self.block(s, 0, &mut columns.iter_mut())
    }

    fn block(&self, s: &mut Scratch, start: u64, columns: &mut IterMut<'_, Values>) -> Result<()> {
        use Quantity as Q;
        let (n, count, k) = (self.mechanism.n(), s.count, self.values());
        let q = &s.q[..count * n];
        let poses = s.poses.get_mut(..count * POSE).unwrap_or_default();
        let jacobians = s.jacobians.get_mut(..count * 6 * n).unwrap_or_default();
        let reference = ReferenceFrame::LocalWorldAligned;
        match (&mut s.relative, poses.is_empty(), jacobians.is_empty()) {
            (_, true, true) => {}
            (Some(relative), ..) => relative.run(q, poses, jacobians)?,
            (None, false, true) => self.kinematics.poses_into(q, poses)?,
            (None, true, false) => self.kinematics.jacobians_into(q, reference, jacobians)?,
            (None, false, false) => {
                self.kinematics.poses_and_jacobians_into(q, reference, poses, jacobians)?;
            }
        }
        let jacobians: &[f64] = jacobians;
        let mut scaled = &mut s.scaled[..];
        if !scaled.is_empty() {
            scaled = &mut scaled[..count * k];
            self.scaled.run(jacobians, scaled);
        }
        for quantity in &self.quantities {
            match quantity {
                Q::Pose => {
                    poses::append(poses, &mut numbers(columns, 7));
                }
                Q::Jacobian => put(jacobians, 6 * n, 6 * n, columns),
                Q::SingularValues => put(scaled, k, k, columns),
                Q::SmallestSingularValue => {
                    extend(columns, scaled.chunks_exact(k).map(|v| v[k - 1]));
                }
                Q::Condition => extend(columns, scaled.chunks_exact(k).map(|v| v[0] / v[k - 1])),
                Q::Yoshikawa => match &self.yoshikawa {
                    Volume::Factor(factor) => {
                        let volume = |v: &[f64]| factor * v.iter().product::<f64>();
                        extend(columns, scaled.chunks_exact(k).map(volume));
                    }
                    Volume::Own(kernel) => {
                        let mut values = vec![0.0; count * kernel.len()];
                        kernel.run(jacobians, &mut values);
                        extend(columns, values.chunks_exact(k).map(|v| v.iter().product()));
                    }
                },
                Q::LimitDistance => {
                    extend(columns, q.chunks_exact(n).map(|q| self.limit_distance(q)));
                }
                Q::SelfDistance | Q::ObstacleDistance => {
                    if let Some(clearances) = &mut s.clearances {
                        let to_obstacles = *quantity == Q::ObstacleDistance;
                        let own = clearances.of(q, to_obstacles);
                        extend(columns, own.map_err(|error| at_row(error, start))?.into_iter());
                    }
                }
                Q::Payload => match &self.payload {
                    Some(payload) if payload.of_jacobian() => {
                        let rows = jacobians.chunks_exact(6 * n);
                        extend(columns, rows.map(|j| payload.at_jacobian(j)));
                    }
                    payload => {
                        let Some(payload) = payload else { continue };
                        let mut own = Vec::with_capacity(count);
                        for (i, q) in q.chunks_exact(n).enumerate() {
                            let found = payload.at(&self.mechanism, self.end_effector, q);
                            own.push(found.map_err(|error| at_row(error, start + i as u64))?);
                        }
                        extend(columns, own.into_iter());
                    }
                },
                Q::GibsonHunt => self.screws(jacobians, start, columns)?,
                Q::Measures => self.measure(q, start, columns)?,
            }
        }
        Ok(())
    }

    fn limit_distance(&self, q: &[f64]) -> f64 {
        let distance = |(c, x): (&crate::model::Coordinate, &f64)| {
            (x - c.limits.lower).min(c.limits.upper - x)
        };
        self.mechanism.coordinates().iter().zip(q).map(distance).fold(f64::INFINITY, f64::min)
    }

    fn screws(
        &self,
        jacobians: &[f64],
        start: u64,
        columns: &mut IterMut<'_, Values>,
    ) -> Result<()> {
        let n = self.mechanism.n();
        let options = ScrewOptions::with_length(self.length);
        let class = columns.next();
        let mut pitches = numbers(columns, PITCHES);
        let Some(Values::Texts(classes)) = class else { return Ok(()) };
        for (i, j) in jacobians.chunks_exact(6 * n).enumerate() {
            let matrix = Matrix::from_fn(6, n, |row, column| j[row * n + column]);
            let system = ScrewSystem::of_columns(&matrix, &options)
                .map_err(|error| at_row(error, start + i as u64))?;
            classes.push(system.class().name());
            let found = system.principal_pitches();
            for (i, column) in pitches.iter_mut().enumerate() {
                column.push(found.get(i).copied().unwrap_or(f64::NAN));
            }
        }
        Ok(())
    }

    fn measure(&self, q: &[f64], start: u64, columns: &mut IterMut<'_, Values>) -> Result<()> {
        const WIDTH: usize = ManipulabilityBatch::WIDTH;
        let Some(batch) = &self.measures else { return Ok(()) };
        let n = self.mechanism.n();
        let mut found = vec![0.0; q.len() / n * WIDTH];
        // Chunks that stay on this thread.
        let chunks = found.chunks_mut(ManipulabilityBatch::CHUNK * WIDTH);
        let rows = q.chunks(ManipulabilityBatch::CHUNK * n).enumerate();
        for ((i, q), out) in rows.zip(chunks) {
            let first = start + (i * ManipulabilityBatch::CHUNK) as u64;
            batch.analyse_into(q, out).map_err(|error| at_row(error, first))?;
        }
        for i in 0..WIDTH {
            let own = found.iter().skip(i).step_by(WIDTH).copied();
            match columns.next() {
                Some(Values::Numbers(column)) => column.extend(own),
                #[expect(
                    clippy::cast_possible_truncation,
                    clippy::cast_sign_loss,
                    reason = "small whole numbers"
                )]
                Some(Values::Counts(column)) => column.extend(own.map(|x| x as u64)),
                _ => {}
            }
        }
        Ok(())
    }
}

/// Memory of a block.
pub(super) struct Scratch {
    count: usize,
    q: Vec<f64>,
    poses: Vec<f64>,
    jacobians: Vec<f64>,
    scaled: Vec<f64>,
    relative: Option<Relative>,
    clearances: Option<Clearances>,
}

impl Scratch {
    pub(super) fn new(e: &Evaluator, rows: usize) -> Self {
        use Quantity as Q;
        let n = e.mechanism.n();
        let of_values = [Q::SingularValues, Q::SmallestSingularValue, Q::Condition];
        let scaled = e.wants(&of_values)
            || (e.wants(&[Q::Yoshikawa]) && matches!(e.yoshikawa, Volume::Factor(_)));
        let of_jacobian = e.payload.as_ref().is_some_and(Payload::of_jacobian);
        let jacobians =
            scaled || of_jacobian || e.wants(&[Q::Jacobian, Q::GibsonHunt, Q::Yoshikawa]);
        let size = |used: bool, each: usize| vec![0.0; if used { rows * each } else { 0 }];
        Self {
            count: 0,
            q: size(true, n),
            poses: size(e.wants(&[Q::Pose]), POSE),
            jacobians: size(jacobians, 6 * n),
            scaled: size(scaled, e.values()),
            relative: e.relative.clone(),
            clearances: e.clearances.clone(),
        }
    }
}

/// The first `width` numbers of rows of `stride`, into as many columns.
fn put(rows: &[f64], stride: usize, width: usize, columns: &mut IterMut<'_, Values>) {
    append(rows, stride, &mut numbers(columns, width));
}

/// Numbers into the next column.
fn extend(columns: &mut IterMut<'_, Values>, values: impl Iterator<Item = f64>) {
    if let Some(Values::Numbers(column)) = columns.next() {
        column.extend(values);
    }
}

/// The next `count` columns of numbers.
fn numbers<'a>(columns: &mut IterMut<'a, Values>, count: usize) -> Vec<&'a mut Vec<f64>> {
    let next = columns.by_ref().take(count);
    let own = next.filter_map(|values| match values {
        Values::Numbers(numbers) => Some(numbers),
        _ => None,
    });
    own.collect()
}

/// The components of the twist that are meant: rows of the Jacobian.
fn components(mechanism: &Mechanism, task: Option<Task>) -> Result<Vec<usize>> {
    let plane = mechanism.dimension() == Dimension::Planar;
    let possible = if plane { Task::PLANAR } else { Task::POSE };
    let refuse = |value: &str, reason: &str| {
        Err(Error::InvalidOption {
            option: "task",
            value: value.to_owned(),
            reason: reason.to_owned(),
        })
    };
    let task = task.unwrap_or(possible);
    task.check()?;
    if task.axes != ReferenceFrame::LocalWorldAligned {
        return refuse("local axes", "a sweep sees components in world axes");
    }
    let rows: Vec<usize> =
        (0..6).filter(|&i| task.components[i] && possible.components[i]).collect();
    if rows.is_empty() {
        return refuse("components out of the plane", "name at least one of x, y, rz");
    }
    Ok(rows)
}

fn volume(
    mechanism: &Mechanism,
    metric: VelocityMetric,
    scaled: Vec<(usize, f64)>,
    length: f64,
) -> Result<Volume> {
    let n = mechanism.n();
    let rows: Vec<(usize, f64)> = match metric {
        VelocityMetric::Unit => scaled.iter().map(|(i, _)| (*i, 1.0)).collect(),
        VelocityMetric::Length | VelocityMetric::Limits => scaled.clone(),
    };
    let mut columns = vec![1.0; n];
    let coordinates = mechanism.coordinates();
    if metric != VelocityMetric::Unit {
        for (factor, c) in columns.iter_mut().zip(coordinates) {
            *factor = if c.kind.is_length() { length } else { 1.0 };
        }
    }
    if metric == VelocityMetric::Limits {
        let names: Vec<String> = coordinates.iter().map(|c| c.name.clone()).collect();
        columns = velocity_limits(mechanism, &names)?;
    }
    if rows.len() <= n && columns.iter().all(|c| *c == 1.0) {
        let ratios = rows.iter().zip(&scaled).map(|(own, scaled)| own.1 / scaled.1);
        return Ok(Volume::Factor(ratios.product()));
    }
    Ok(Volume::Own(SingularValues::new(rows, columns)))
}

/// The row of an error within a block.
fn at_row(error: Error, row: u64) -> Error {
    match error {
        Error::NotFinite { what, value } => {
            Error::NotFinite { what: format!("{what} (rows from {row})"), value }
        }
        other => other,
    }
}
