//! Mobility and manipulability of a mechanism at many configurations (batched).
//!
//! Formula  mobility.rs, singularity.rs, relation.rs and efficiency.rs, without bases
//! Shapes   q: N x n, results: N rows of [`ManipulabilityBatch::COLUMNS`]; row-major, n of the
//!          mechanism
//! Units    loop-closure errors m and rad; counts and distances none; indices those of the metrics
//! Frame    the reference frame's origin, world axes; a task is a map of the twist there
//! Valid    any mechanism. Where a distance to a singularity is below [`CLEAR_DISTANCE`], where an
//!          axis or a loop is near the boundary of a verdict, and where regular configurations are
//!          hyperstatic, idle or not fixed by the actuators, the configuration is passed to the
//!          analysis of one: counts are always the same as there. Distances differ from it by at
//!          most 1e-13 over the smallest of them, indices by 1e-12 relative over it, times the
//!          condition of the metrics
//! Why so   plots over a workspace need numbers only: without bases there is a tenth of the work,
//!          and without pivoting four configurations take the same path, one in each lane of a
//!          register. Every configuration is independent of its place and of the number of threads
//! Checked  tests/it/manipulability/batch.rs

use std::ops::Range;

use super::closed_chain_batched::{Found, Kernel};
use super::efficiency::Manipulability;
use super::metrics::Metrics;
use crate::closure::{
    BatchedConstraintPlan, ClosedChain, Excess, GenericMobility, LoopClosureError, MobilityCounts,
    MotionSpace, SingularityDistances,
};
use crate::error::{Error, Result};
use crate::kinematics::State;
use crate::linalg::{Matrix, Qr, run_all};
use crate::model::{FrameId, Mechanism};
use crate::tolerance::{CLEAR_DISTANCE, CLOSED, NEGLIGIBLE_SHARE};

/// Options of a [`ManipulabilityBatch`].
#[derive(Debug, Clone, Default)]
pub struct BatchOptions {
    /// The frame whose motion is the goal: the mechanism's reference by default.
    pub reference: Option<FrameId>,
    /// Characteristic length (m): that of the mechanism by default.
    pub length: Option<f64>,
    /// Metrics of twists (of the task, if there is one) and joint velocities. Those of wrenches and
    /// torques are not used: the indices are those of motion.
    pub metrics: Metrics,
    /// The task `T u`, with independent rows, whose motions are counted and measured: the whole twist
    /// by default. The distances to singularities of type I and II are then those of the task, the
    /// others remain those of the mechanism.
    pub task: Option<Matrix>,
    /// Counts at regular configurations, which identify singular ones: searched for from the home
    /// configuration by default ([`GenericMobility::of`]). With a task they are those of the task.
    pub generic: Option<MobilityCounts>,
}

/// Mobility and manipulability of a mechanism for many configurations in one call.
///
/// Calls with more than [`ManipulabilityBatch::CHUNK`] configurations use the threads of rayon
/// (`RAYON_NUM_THREADS`, or `ThreadPool::install` around the call); results do not depend on how
/// many there are.
///
/// ```
/// use cylindroid::manipulability::{ManipulabilityBatch, BatchOptions};
///
/// let stewart = cylindroid::load("stewart")?;
/// let batch = ManipulabilityBatch::new(&stewart, &BatchOptions::default())?;
/// let q = [stewart.home(), stewart.home()].concat();
/// let rows = batch.analyse(&q)?;
/// let dof = ManipulabilityBatch::column("dof").unwrap();
/// assert_eq!(rows[ManipulabilityBatch::WIDTH + dof], 6.0);
/// # Ok::<(), cylindroid::Error>(())
/// ```
#[derive(Debug, Clone)]
pub struct ManipulabilityBatch {
    mechanism: Mechanism,
    reference: FrameId,
    length: f64,
    metrics: Metrics,
    task: Option<Matrix>,
    generic: MobilityCounts,
    kernel: Option<Kernel>,
}

/// Results of one configuration, in the order of [`ManipulabilityBatch::COLUMNS`].
type Row = [f64; ManipulabilityBatch::WIDTH];

impl ManipulabilityBatch {
    /// Configurations that one thread takes at once, some tenths of a millisecond of work: calls
    /// with no more stay on the thread of the caller.
    pub const CHUNK: usize = 128;

    /// Numbers of a result.
    pub const WIDTH: usize = Self::COLUMNS.len();

    /// The names of the numbers of a result, those of the reports of one configuration:
    /// - how far the loops are open (m, rad), and 1 where they are closed, else 0,
    /// - the counts of mobility, from `redundancy` to `zero_torque` of the relation between
    ///   actuated joints and reference,
    /// - the distances to singularities of each kind, 0 at one and infinite where there is nothing
    ///   to lose,
    /// - the kinematic index: product of the roots of the finite efficiencies, largest and
    ///   smallest of them and their ratio; these three are not numbers where none is finite.
    pub const COLUMNS: [&'static str; 19] = [
        "closure_distance",
        "closure_angle",
        "closed",
        "dof",
        "redundancy",
        "indeterminacy",
        "coordinate",
        "internal",
        "zero_torque",
        "hyperstatic",
        "idle",
        "type_i",
        "type_ii",
        "configuration_space",
        "passive",
        "volume",
        "largest",
        "smallest",
        "anisotropy",
    ];

    /// The places of the whole numbers among them.
    pub const COUNTS: Range<usize> = 2..11;

    /// The place of a number in a result.
    #[must_use]
    pub fn column(name: &str) -> Option<usize> {
        Self::COLUMNS.iter().position(|c| *c == name)
    }

    /// For a mechanism.
    ///
    /// # Errors
    /// As [`ClosedChain::of`] and [`Relation::task`](crate::closure::Relation::task); metrics of the
    /// wrong size.
    pub fn new(mechanism: &Mechanism, options: &BatchOptions) -> Result<Self> {
        let BatchOptions { reference, length, ref metrics, ref task, generic } = *options;
        let home = mechanism.state(mechanism.home())?;
        let chain = ClosedChain::of(&home, reference, length)?;
        let constraint = &chain.constraint;
        let (length, reference) = (constraint.length(), chain.reference);
        let joints = constraint.actuated();
        let object = match task {
            // Refuses maps that are no tasks, whatever the generic counts come from.
            Some(map) => MotionSpace::of(constraint).relation().task(map)?.object(),
            None => constraint.object(),
        };
        metrics.check(joints, object)?;
        let generic = match (generic, task) {
            (Some(counts), _) => counts,
            (None, None) => GenericMobility::of(&home, Some(reference), Some(length))?.counts,
            (None, Some(map)) => {
                GenericMobility::of_task(&home, Some(reference), length, map)?.counts
            }
        };
        let plan = BatchedConstraintPlan::of(mechanism, reference, length)?;
        let clear = generic.rank == constraint.rows()
            && generic.idle == 0
            && generic.indeterminacy == 0
            && joints > 0;
        let factor = |mut scale: Matrix, metric: Option<&crate::linalg::Metric>| {
            if let Some(metric) = metric {
                metric.whiten_rows(&mut scale);
            }
            scale
        };
        let of_joints = factor(Matrix::diagonal(&plan.actuated_scale), metrics.joint.as_ref());
        let scale = Matrix::diagonal(&plan.object_scale);
        // T u = R^T Q^T u', as for one configuration (relation.rs).
        let (scale, rows) = match task {
            None => (scale, None),
            Some(map) => {
                let qr = Qr::plain((map * &scale).transpose());
                (qr.r().transpose(), Some(qr.basis().transpose()))
            }
        };
        let of_object = factor(scale, metrics.object.as_ref());
        let kernel = if clear { Kernel::new(plan, (rows, of_object), of_joints) } else { None };
        let (mechanism, metrics, task) = (mechanism.clone(), metrics.clone(), task.clone());
        Ok(Self { mechanism, reference, length, metrics, task, generic, kernel })
    }

    /// Numbers of a configuration: those of the mechanism.
    #[must_use]
    pub fn n(&self) -> usize {
        self.mechanism.n()
    }

    /// The frame whose motion is measured.
    #[must_use]
    pub fn reference(&self) -> FrameId {
        self.reference
    }

    /// The characteristic length (m).
    #[must_use]
    pub fn length(&self) -> f64 {
        self.length
    }

    /// What regular configurations have, of the task if there is one.
    #[must_use]
    pub fn generic(&self) -> MobilityCounts {
        self.generic
    }

    /// The numbers of each configuration, N x [`ManipulabilityBatch::WIDTH`].
    ///
    /// # Errors
    /// A `q` that is not a whole number of configurations, or with a non-finite entry, or
    /// so large that the constraint is not.
    pub fn analyse(&self, q: &[f64]) -> Result<Vec<f64>> {
        let mut out = vec![0.0; self.mechanism.count_rows("q", q)? * Self::WIDTH];
        self.analyse_into(q, &mut out)?;
        Ok(out)
    }

    /// [`ManipulabilityBatch::analyse`] into `out`. Of a mechanism without coordinates, which has
    /// one configuration, it is written as often as `out` has room.
    ///
    /// # Errors
    /// As there; an `out` of another size.
    pub fn analyse_into(&self, q: &[f64], out: &mut [f64]) -> Result<()> {
        let n = self.mechanism.n();
        let count = match n {
            0 => out.len() / Self::WIDTH,
            _ => self.mechanism.count_rows("q", q)?,
        };
        self.mechanism.check_rows("q", q)?;
        if out.len() != count * Self::WIDTH {
            return Err(Error::rows("results", count * Self::WIDTH, out.len(), Self::WIDTH));
        }
        if n == 0 {
            let mut rows = out.chunks_exact_mut(Self::WIDTH);
            let Some(first) = rows.next() else { return Ok(()) };
            first.copy_from_slice(&self.single(&[], &mut None)?);
            rows.for_each(|row| row.copy_from_slice(first));
            return Ok(());
        }
        let q = q.chunks(Self::CHUNK * n).enumerate();
        let chunks: Vec<_> = q.zip(out.chunks_mut(Self::CHUNK * Self::WIDTH)).collect();
        let run =
            |((i, q), out): ((usize, &[f64]), &mut [f64])| self.chunk(i * Self::CHUNK, q, out);
        if chunks.len() > 1 {
            // The first error of all, whoever comes first.
            return run_all(chunks, run).into_iter().collect();
        }
        chunks.into_iter().try_for_each(run)
    }

    /// On one thread; `first` is the place of the first configuration.
    fn chunk(&self, first: usize, q: &[f64], out: &mut [f64]) -> Result<()> {
        let n = self.mechanism.n();
        let mut numbers = Vec::new();
        let mut width = 0;
        if let Some(kernel) = &self.kernel {
            width = kernel.width();
            numbers.resize(q.len() / n * width, 0.0);
            kernel.run(q, n, &mut numbers);
        }
        let mut state: Option<State> = None;
        for (i, (q, out)) in q.chunks(n).zip(out.chunks_mut(Self::WIDTH)).enumerate() {
            let clear = self.kernel.as_ref().and_then(|kernel| {
                self.clear(kernel, kernel.read(&numbers[i * width..(i + 1) * width]))
            });
            let row = match clear {
                Some(row) => row,
                None => self.single(q, &mut state).map_err(|e| at_row(e, first + i))?,
            };
            out.copy_from_slice(&row);
        }
        Ok(())
    }

    /// By the analysis of one configuration; `state` is kept for the next.
    fn single(&self, q: &[f64], state: &mut Option<State>) -> Result<Row> {
        let state = match state {
            Some(state) => {
                state.set(q)?;
                state
            }
            None => state.insert(self.mechanism.state(q)?),
        };
        let chain = ClosedChain::of(state, Some(self.reference), Some(self.length))?;
        let motions = MotionSpace::of(&chain.constraint);
        let relation = match &self.task {
            None => motions.relation(),
            Some(map) => motions.relation().task(map)?,
        };
        let counts = MobilityCounts::of(&motions, &relation);
        let unactuated = self.generic.lack_actuation(motions.sizes());
        let excess = Excess::of(&counts, &self.generic, unactuated);
        let dimensions = relation.dimensions();
        let spectrum = Manipulability::of(&relation, &self.metrics)?.kinematic;
        let none = f64::NAN;
        Ok(row(&Numbers {
            closure_error: chain.closure_error,
            closed: chain.closure_error.is_closed(self.length),
            dof: motions.dof(),
            coordinate: dimensions.coordinate,
            internal: dimensions.internal,
            hyperstatic: motions.hyperstatic(),
            counts,
            distances: SingularityDistances::of(&counts, &motions, &relation).against(excess),
            volume: spectrum.volume(),
            largest: spectrum.largest().unwrap_or(none),
            smallest: spectrum.smallest().unwrap_or(none),
        }))
    }

    /// From the result of the kernel, where no count is ambiguous.
    fn clear(&self, kernel: &Kernel, found: Found<'_>) -> Option<Row> {
        let plan = kernel.plan();
        let closure_error = LoopClosureError { distance: found.distance, angle: found.angle };
        let near = |x: f64, limit: f64| (x - limit).abs() < 1e-3 * limit;
        if !found.usable
            || near(closure_error.distance, CLOSED * self.length)
            || near(closure_error.angle, CLOSED)
        {
            return None;
        }
        if !(found.regularity > CLEAR_DISTANCE && found.share > CLEAR_DISTANCE) {
            return None;
        }
        // Sines of the pairs: the distance to rank loss, and the largest.
        let whole = |sigma: f64| (1.0 + sigma * sigma).sqrt();
        let sine = |sigma: f64| sigma / whole(sigma);
        let (mut coordinate, mut least, mut most) = (0, f64::INFINITY, 0.0_f64);
        for &sigma in found.scaled {
            if sine(sigma) > CLEAR_DISTANCE {
                (coordinate, least, most) = (coordinate + 1, least.min(sigma), most.max(sigma));
            } else if !(sigma <= NEGLIGIBLE_SHARE) {
                return None;
            }
        }
        let cosine = 1.0 / whole(most);
        // The motions that a task does not see are as clear, for all of them were divided alike.
        let all_clear = found.whole.iter().all(|sigma| 1.0 / whole(*sigma) > CLEAR_DISTANCE);
        if coordinate == 0 || !all_clear {
            return None;
        }
        let (volume, smallest, largest) = measured(found.measured, coordinate)?;
        let dof = kernel.dof();
        let counts = MobilityCounts {
            rank: plan.constraint_rows() + plan.object(),
            idle: 0,
            redundancy: dof - coordinate,
            indeterminacy: 0,
            zero_torque: kernel.object() - coordinate,
        };
        let here = SingularityDistances {
            type_i: sine(least),
            type_ii: cosine,
            configuration_space: found.regularity,
            passive: found.share,
        };
        Some(row(&Numbers {
            closure_error,
            closed: closure_error.is_closed(self.length),
            dof,
            coordinate,
            internal: plan.actuated() - dof,
            hyperstatic: 0,
            counts,
            // Without indeterminacy the actuators are independent.
            distances: here.against(Excess::of(&counts, &self.generic, false)),
            volume,
            largest,
            smallest,
        }))
    }
}

/// Volume, smallest and largest efficiency of the non-zero singular values;
/// `None` where they cannot be told apart.
fn measured(values: &[f64], count: usize) -> Option<(f64, f64, f64)> {
    /// Ratio of the smallest kept to the largest discarded value.
    const APART: f64 = 1e3;
    /// Components of a twist.
    const MOST: usize = 6;
    let mut sorted = [0.0; MOST];
    let sorted = sorted.get_mut(..values.len())?;
    sorted.copy_from_slice(values);
    sorted.sort_unstable_by(|a, b| b.total_cmp(a));
    let (kept, others) = sorted.split_at(count);
    let (largest, smallest) = (*kept.first()?, *kept.last()?);
    let rest = others.first().copied().unwrap_or(0.0);
    (largest.is_finite() && smallest > APART * rest).then_some(())?;
    Some((kept.iter().product(), smallest * smallest, largest * largest))
}

/// Configurations so far out that the constraint overflows.
fn at_row(error: Error, row: usize) -> Error {
    match error {
        Error::NotFinite { what, value } => {
            Error::NotFinite { what: format!("{what} at q[{row}]"), value }
        }
        other => other,
    }
}

struct Numbers {
    closure_error: LoopClosureError,
    closed: bool,
    dof: usize,
    coordinate: usize,
    internal: usize,
    hyperstatic: usize,
    counts: MobilityCounts,
    distances: SingularityDistances,
    volume: f64,
    largest: f64,
    smallest: f64,
}

fn row(n: &Numbers) -> Row {
    let MobilityCounts { idle, redundancy, indeterminacy, zero_torque, .. } = n.counts;
    let count = |n: usize| n as f64;
    [
        n.closure_error.distance,
        n.closure_error.angle,
        f64::from(u8::from(n.closed)),
        count(n.dof),
        count(redundancy),
        count(indeterminacy),
        count(n.coordinate),
        count(n.internal),
        count(zero_torque),
        count(n.hyperstatic),
        count(idle),
        n.distances.type_i,
        n.distances.type_ii,
        n.distances.configuration_space,
        n.distances.passive,
        n.volume,
        n.largest,
        n.smallest,
        n.largest / n.smallest,
    ]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::closure::assemble;
    use crate::model::catalogue;
    use crate::scalar::uniform;

    /// What is regular does not ask the analysis of one.
    #[test]
    fn ordinary_postures_are_clear() {
        for name in ["five-bar", "stewart", "two-arm", "four-bar", "3rrr", "delta", "watt", "panda"]
        {
            let mechanism = catalogue::load(name).unwrap();
            let batch = ManipulabilityBatch::new(&mechanism, &BatchOptions::default()).unwrap();
            let kernel = batch.kernel.as_ref().unwrap();
            let mut random = 4;
            let mut q = mechanism.home().to_vec();
            for _ in 1..100 {
                let guess: Vec<f64> =
                    mechanism.home().iter().map(|x| x + uniform(&mut random) - 0.5).collect();
                q.extend(assemble(&mechanism, &guess, &[]).unwrap().q);
            }
            let width = kernel.width();
            let mut numbers = vec![0.0; 100 * width];
            kernel.run(&q, mechanism.n(), &mut numbers);
            let clear = |n: &&[f64]| batch.clear(kernel, kernel.read(n)).is_some();
            let count = numbers.chunks(width).filter(clear).count();
            assert!(count > 95, "{name}: {count} of 100");
        }
    }

    #[test]
    fn values_that_cannot_be_told_apart_are_refused() {
        assert_eq!(measured(&[2.0, 1e-3, 4.0], 2), Some((8.0, 4.0, 16.0)));
        assert_eq!(measured(&[2.0, 3e-3, 4.0], 2), None);
        assert_eq!(measured(&[2.0, f64::INFINITY], 2), None);
        assert_eq!(measured(&[f64::NAN, 2.0], 2), None);
    }
}
