//! Batched mobility counts and indices of a closed chain: the kernel of
//! [`super::ManipulabilityBatch`], with one configuration in each SIMD lane.
//!
//! Formula  rows [C; J] of closed_chain_batched.rs in closure, scaled; C^T = Q [L^T; 0], K the last
//!          columns of Q; K_a, the actuated rows of K, = Q_a R_a; sigma_i the singular values of
//!          J K R_a^-1, which takes actuated joint velocities of length one to the twist: pairs
//!          (s, c) = (sigma, 1) / hypot;
//!          those of M = [C 0; J -1] from the eigenvalues of M M^T = [L 0; J Q -1][..]^T; the least
//!          share of actuators and object in a motion from the pencil of K_a^T K_a + J_K^T J_K and
//!          1 + J_K^T J_K. Of a task sigma_i of T J K R_a^-1 as well, T with orthonormal rows
//! Shapes   C: t x m, J: d x m, K: m x k, k = m - t, T: e x d, e = d without a task
//! Units    none
//! Valid    independent rows of C, actuated joint velocities that determine the motion: any other
//!          case shows as a number near zero, or as NaN, and the batch then calls the single
//!          analysis
//! Why so   a basis K orthonormal to rounding needs no pivoting as long as the rows are
//!          independent, so lanes stay together
//! Checked  tests::lanes_agree_with_plain_numbers, tests/it/manipulability/batch.rs

use crate::closure::BatchedConstraintPlan;
use crate::kinematics::tree_batched::Frame;
use crate::linalg::Matrix;
use crate::linalg::batched::{
    End, Reflections, divide_by_upper, dot, extreme_eigenvalues, round_robin_pairs,
    singular_values, tridiagonal,
};
use crate::scalar::{Array, SimdFloat};
#[cfg(target_arch = "x86_64")]
use crate::scalar::{Avx2, Lanes4};
use crate::spatial::AlignedPose;

/// Numbers before the singular values.
const HEADER: usize = 6;

/// The part that is independent of the configuration.
#[derive(Debug, Clone)]
pub(super) struct Kernel {
    plan: Box<BatchedConstraintPlan>,
    /// T, of a task.
    task: Option<Matrix>,
    /// `L_u^T D_u` and `L_q^T D_q`: from scaled coordinates to those in which metrics are one.
    object: Matrix,
    joint: Matrix,
    /// The second where it is a multiple of the identity.
    alike: Option<f64>,
    /// All pairs of singular values, and those of the whole twist.
    pairs: Vec<(usize, usize)>,
    whole_pairs: Vec<(usize, usize)>,
}

/// Results of the kernel for a configuration.
#[derive(Debug, Clone, Copy)]
pub(super) struct Found<'a> {
    /// Loop-closure errors (m, rad).
    pub(super) distance: f64,
    pub(super) angle: f64,
    /// False where the other results are invalid.
    pub(super) usable: bool,
    /// Smallest over largest singular value of the constraint.
    pub(super) regularity: f64,
    /// The least share of actuators and object in a motion.
    pub(super) share: f64,
    /// Singular values from actuated joint velocities to the twist or task, scaled, and in the
    /// metrics; in no order.
    pub(super) scaled: &'a [f64],
    pub(super) measured: &'a [f64],
    /// Those to the whole twist, scaled.
    pub(super) whole: &'a [f64],
}

impl Kernel {
    /// With the rows of a task and the metrics as factors; `None` where motions of the loops leave
    /// nothing to decide, or are more than the actuators could set.
    pub(super) fn new(
        plan: BatchedConstraintPlan,
        (task, object): (Option<Matrix>, Matrix),
        joint: Matrix,
    ) -> Option<Self> {
        let k = plan.columns().checked_sub(plan.constraint_rows())?;
        if k == 0 || k > plan.actuated() {
            return None;
        }
        let first = joint[(0, 0)];
        let same = Matrix::diagonal(&vec![first; joint.rows()]);
        let alike = (joint == same).then_some(first);
        let pairs = round_robin_pairs(k.min(object.rows()));
        let whole_pairs = round_robin_pairs(k.min(plan.object()));
        Some(Self { plan: Box::new(plan), task, object, joint, alike, pairs, whole_pairs })
    }

    /// Degrees of freedom k.
    pub(super) fn dof(&self) -> usize {
        self.plan.columns() - self.plan.constraint_rows()
    }

    /// The plan.
    pub(super) fn plan(&self) -> &BatchedConstraintPlan {
        &self.plan
    }

    /// Size e of the twist or task.
    pub(super) fn object(&self) -> usize {
        self.object.rows()
    }

    /// Number of singular values.
    fn values(&self) -> usize {
        self.dof().min(self.object())
    }

    /// Number of those of the whole twist, if they are others.
    fn whole_values(&self) -> usize {
        if self.task.is_some() { self.dof().min(self.plan.object()) } else { 0 }
    }

    /// Numbers for each configuration.
    pub(super) fn width(&self) -> usize {
        HEADER + 2 * self.values() + self.whole_values()
    }

    /// The numbers of a configuration, read.
    pub(super) fn read<'a>(&self, numbers: &'a [f64]) -> Found<'a> {
        let (scaled, others) = numbers[HEADER..].split_at(self.values());
        let (measured, whole) = others.split_at(self.values());
        let whole = if self.task.is_some() { whole } else { scaled };
        Found {
            whole,
            distance: numbers[0],
            angle: numbers[1],
            usable: numbers[2] > 0.0,
            regularity: (numbers[3] / numbers[4]).sqrt(),
            share: numbers[5].sqrt(),
            scaled,
            measured,
        }
    }

    /// The numbers of all configurations, as many at once as the processor can; `n` numbers each in
    /// `q`.
    pub(super) fn run(&self, q: &[f64], n: usize, out: &mut [f64]) {
        #[cfg(target_arch = "x86_64")]
        if let Some(cpu) = Avx2::detect() {
            #[allow(unsafe_code)] // the one way to call a function compiled for more
            // SAFETY: the token proves that the processor has both features.
            unsafe {
                self.run_avx2(cpu, q, n, out);
            }
            return;
        }
        self.run_with::<Array<4>>((), q, n, out);
    }

    #[cfg(target_arch = "x86_64")]
    #[target_feature(enable = "avx2,fma")]
    fn run_avx2(&self, cpu: Avx2, q: &[f64], n: usize, out: &mut [f64]) {
        self.run_with::<Lanes4>(cpu, q, n, out);
    }

    #[inline(always)]
    fn run_with<R: SimdFloat>(&self, _: R::Cpu, q: &[f64], n: usize, out: &mut [f64]) {
        let width = self.width();
        let mut scratch = Scratch::of(self, n);
        let blocks = q.chunks(R::LANES * n).zip(out.chunks_mut(R::LANES * width));
        for (q, out) in blocks {
            // Lanes that are left over repeat the last configuration.
            let rows = q.len() / n;
            for (c, x) in scratch.q.iter_mut().enumerate() {
                *x = R::from_fn(|l| q[l.min(rows - 1) * n + c]);
            }
            self.analyse(&mut scratch);
            if rows == R::LANES {
                R::scatter(&scratch.numbers, out, width);
            } else {
                let mut all = vec![0.0; R::LANES * width];
                R::scatter(&scratch.numbers, &mut all, width);
                out.copy_from_slice(&all[..rows * width]);
            }
        }
    }

    #[inline(always)]
    fn analyse<R: SimdFloat>(&self, s: &mut Scratch<R>) {
        let plan = &*self.plan;
        let (t, d, m, a) = (plan.constraint_rows(), plan.object(), plan.columns(), plan.actuated());
        let (k, values) = (self.dof(), self.values());
        let written = plan.write(&s.q, &mut s.frames, &mut s.rows);
        let mut loops = Reflections {
            n: m,
            columns: &mut s.rows,
            diagonal: &mut s.diagonal,
            factors: &mut s.factors,
        };
        loops.run();
        loops.complement(&mut s.kernel);
        for (i, x) in s.diagonal.iter().enumerate() {
            s.rows[i * m + i] = *x;
        }
        // J K, a row for each component.
        for (own, row) in s.twists.chunks_exact_mut(k).zip(s.rows[t * m..].chunks_exact(m)) {
            own.copy_from_slice(&row[t..]);
        }
        for (own, column) in s.actuated.chunks_exact_mut(a).zip(s.kernel.chunks_exact(m)) {
            own.copy_from_slice(&column[..a]);
        }
        let share = self.least_share(s);
        s.ratios.copy_from_slice(&s.twists);
        s.divide_by_actuated(a);
        let e = self.object();
        if let Some(task) = &self.task {
            columns_of(&s.ratios, k, &mut s.columns, d);
            let whole = &mut s.numbers[HEADER + 2 * values..];
            singular_values(&mut s.columns, k.max(d), &self.whole_pairs, whole);
            for rows in [&mut s.twists, &mut s.ratios] {
                times(task, 1.0, rows, k, &mut s.columns[..e * k]);
                rows[..e * k].copy_from_slice(&s.columns[..e * k]);
            }
        }
        let (twists, columns) = (&s.twists[..e * k], &mut s.columns[..e * k]);
        let scaled = HEADER..HEADER + values;
        columns_of(&s.ratios[..e * k], k, columns, e);
        singular_values(columns, k.max(e), &self.pairs, &mut s.numbers[scaled]);
        // In the metrics. What is orthogonal in one is so nearly in the other: where it can be, the
        // columns that were turned are the start.
        if let (Some(alike), true) = (self.alike, k <= e) {
            let ratios = &mut s.ratios[..e * k];
            for (own, column) in ratios.chunks_exact_mut(e).zip(columns.chunks_exact(e)) {
                times(&self.object, 1.0 / alike, column, 1, own);
            }
            columns.copy_from_slice(ratios);
        } else if let Some(alike) = self.alike {
            times(&self.object, 1.0 / alike, &s.ratios[..e * k], k, columns);
        } else {
            times(&self.object, 1.0, twists, k, &mut s.ratios[..e * k]);
            for (own, column) in s.actuated.chunks_exact_mut(a).zip(s.kernel.chunks_exact(m)) {
                times(&self.joint, 1.0, &column[..a], 1, own);
            }
            s.divide_by_actuated(a);
            columns_of(&s.ratios[..e * k], k, &mut s.columns[..e * k], e);
        }
        let measured = HEADER + values..HEADER + 2 * values;
        singular_values(&mut s.columns[..e * k], k.max(e), &self.pairs, &mut s.numbers[measured]);
        let [smallest, largest] = self.extremes(s);
        let numbers = [written.distance, written.angle, written.usable, smallest, largest, share];
        s.numbers[..HEADER].copy_from_slice(&numbers);
    }

    /// The ends of the spectrum of M M^T.
    #[inline(always)]
    fn extremes<R: SimdFloat>(&self, s: &mut Scratch<R>) -> [R; 2] {
        let (t, m) = (self.plan.constraint_rows(), self.plan.columns());
        let size = t + self.plan.object();
        for j in 0..size {
            // L has j + 1 numbers in a row, J Q all.
            let length = if j < t { j + 1 } else { m };
            let own = &s.rows[j * m..j * m + length];
            for i in j..size {
                s.gram[j * size + i] = dot(own, &s.rows[i * m..i * m + length]);
            }
            if j >= t {
                s.gram[j * size + j] = s.gram[j * size + j] + R::splat(1.0);
            }
        }
        let (spectrum, squares) = (&mut s.spectrum[..size], &mut s.squares[..size - 1]);
        tridiagonal(&mut s.gram, spectrum, squares, &mut s.product[..size]);
        extreme_eigenvalues(spectrum, squares, [End::Smallest, End::Largest])
    }

    /// The square of the least share of actuators and object in a motion.
    #[inline(always)]
    fn least_share<R: SimdFloat>(&self, s: &mut Scratch<R>) -> R {
        let one = R::splat(1.0);
        let (k, a) = (self.dof(), self.plan.actuated());
        if a == self.plan.columns() {
            return one;
        }
        // The upper factor of 1 + J_K^T J_K in place, column by column.
        columns_into(&s.twists, k, &mut s.columns);
        let d = self.plan.object();
        for j in 0..k {
            let own = &s.columns[j * d..(j + 1) * d];
            for i in 0..=j {
                let product = dot(&s.columns[i * d..(i + 1) * d], own);
                s.weight[j * k + i] = product;
                let actuated =
                    dot(&s.actuated[i * a..(i + 1) * a], &s.actuated[j * a..(j + 1) * a]);
                let both = product + actuated;
                (s.shares[j * k + i], s.shares[i * k + j]) = (both, both);
            }
            s.weight[j * k + j] = s.weight[j * k + j] + one;
        }
        for j in 0..k {
            let (before, own) = s.weight.split_at_mut(j * k);
            for i in 0..j {
                let sum = dot(&before[i * k..i * k + i], &own[..i]);
                own[i] = (own[i] - sum) * s.roots[i];
            }
            let rest = (own[j] - dot(&own[..j], &own[..j])).sqrt();
            s.roots[j] = one / rest;
            s.weight_diagonal[j] = rest;
        }
        divide_by_upper(&mut s.shares, &s.weight, k, &s.weight_diagonal);
        for j in 0..k {
            for i in 0..j {
                s.shares.swap(j * k + i, i * k + j);
            }
        }
        divide_by_upper(&mut s.shares, &s.weight, k, &s.weight_diagonal);
        let squares = &mut s.squares[..k - 1];
        tridiagonal(&mut s.shares, &mut s.spectrum[..k], squares, &mut s.product[..k]);
        let [least] = extreme_eigenvalues(&s.spectrum[..k], squares, [End::Smallest]);
        least
    }
}

/// Memory of one thread.
#[derive(Debug)]
struct Scratch<R> {
    q: Vec<R>,
    frames: Vec<Frame<R>>,
    /// [C; J], later [L; J Q].
    rows: Vec<R>,
    diagonal: Vec<R>,
    factors: Vec<R>,
    kernel: Vec<R>,
    actuated: Vec<R>,
    actuated_diagonal: Vec<R>,
    actuated_factors: Vec<R>,
    /// J K, and J K R^-1: rows.
    twists: Vec<R>,
    ratios: Vec<R>,
    columns: Vec<R>,
    weight: Vec<R>,
    weight_diagonal: Vec<R>,
    roots: Vec<R>,
    shares: Vec<R>,
    gram: Vec<R>,
    spectrum: Vec<R>,
    squares: Vec<R>,
    product: Vec<R>,
    numbers: Vec<R>,
}

impl<R: SimdFloat> Scratch<R> {
    /// Ratios over the triangle of the actuated joint velocities, which are `a` rows.
    #[inline(always)]
    fn divide_by_actuated(&mut self, a: usize) {
        let mut upper = Reflections {
            n: a,
            columns: &mut self.actuated,
            diagonal: &mut self.actuated_diagonal,
            factors: &mut self.actuated_factors,
        };
        upper.run();
        divide_by_upper(&mut self.ratios, &self.actuated, a, &self.actuated_diagonal);
    }

    fn of(kernel: &Kernel, n: usize) -> Self {
        let plan = &*kernel.plan;
        let (t, d, m, a) = (plan.constraint_rows(), plan.object(), plan.columns(), plan.actuated());
        let (k, size) = (kernel.dof(), t + d);
        let zeros = |count: usize| vec![R::splat(0.0); count];
        Self {
            q: zeros(n),
            frames: vec![Frame::load(&AlignedPose::IDENTITY); plan.frames()],
            rows: zeros(size * m),
            diagonal: zeros(t),
            factors: zeros(t),
            kernel: zeros(m * k),
            actuated: zeros(a * k),
            actuated_diagonal: zeros(k),
            actuated_factors: zeros(k),
            twists: zeros(d * k),
            ratios: zeros(d * k),
            columns: zeros(d * k),
            weight: zeros(k * k),
            weight_diagonal: zeros(k),
            roots: zeros(k),
            shares: zeros(k * k),
            gram: zeros(size * size),
            spectrum: zeros(size.max(k)),
            squares: zeros(size.max(k) - 1),
            product: zeros(size.max(k)),
            numbers: zeros(kernel.width()),
        }
    }
}

/// Rows of k numbers as columns.
#[inline(always)]
fn columns_into<R: SimdFloat>(rows: &[R], k: usize, columns: &mut [R]) {
    let d = rows.len() / k;
    for (i, row) in rows.chunks_exact(k).enumerate() {
        for (j, x) in row.iter().enumerate() {
            columns[j * d + i] = *x;
        }
    }
}

/// The longer of rows and columns of a matrix of d rows of k numbers.
#[inline(always)]
fn columns_of<R: SimdFloat>(rows: &[R], k: usize, columns: &mut [R], d: usize) {
    if k > d {
        columns.copy_from_slice(rows);
    } else {
        columns_into(rows, k, columns);
    }
}

/// `factor * m` times rows of k numbers.
#[inline(always)]
fn times<R: SimdFloat>(m: &Matrix, factor: f64, rows: &[R], k: usize, out: &mut [R]) {
    for (i, out) in out.chunks_exact_mut(k).enumerate() {
        out.fill(R::splat(0.0));
        for (j, row) in rows.chunks_exact(k).enumerate() {
            let entry = m[(i, j)] * factor;
            if entry != 0.0 {
                for (x, y) in out.iter_mut().zip(row) {
                    *x = R::splat(entry).mul_add(*y, *x);
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::catalogue;
    use crate::scalar::uniform;

    /// Arrays are plain numbers to the bit, registers to rounding over the distances of these
    /// configurations.
    #[test]
    fn lanes_agree_with_plain_numbers() {
        for name in ["five-bar", "stewart", "two-arm", "ur5e"] {
            let mechanism = catalogue::load(name).unwrap();
            let plan =
                BatchedConstraintPlan::of(&mechanism, mechanism.reference(), mechanism.reach())
                    .unwrap();
            let of = |scale: &[f64]| Matrix::diagonal(scale);
            let (object, joint) = (of(&plan.object_scale), of(&plan.actuated_scale));
            let kernel = Kernel::new(plan, (None, object), joint).unwrap();
            let (n, count) = (mechanism.n(), 11);
            let mut random = 8;
            let q: Vec<f64> = (0..count)
                .flat_map(|_| mechanism.home())
                .map(|x| x + 0.4 * uniform(&mut random) - 0.2)
                .collect();
            let mut plain = vec![0.0; count * kernel.width()];
            let (mut array, mut best) = (plain.clone(), plain.clone());
            kernel.run_with::<f64>((), &q, n, &mut plain);
            kernel.run_with::<Array<4>>((), &q, n, &mut array);
            kernel.run(&q, n, &mut best);
            assert_eq!(plain, array, "{name}");
            for (i, (p, b)) in plain.iter().zip(&best).enumerate() {
                let close = (p - b).abs() <= 1e-12 * (1.0 + p.abs());
                assert!(close, "{name} {i}: {p} and {b}");
            }
        }
    }

    #[test]
    fn a_task_leaves_the_singular_values_of_the_whole_twist() {
        for name in ["five-bar", "stewart", "ur5e"] {
            let mechanism = catalogue::load(name).unwrap();
            let plan =
                BatchedConstraintPlan::of(&mechanism, mechanism.reference(), mechanism.reach())
                    .unwrap();
            let scale = |scale: &[f64]| Matrix::diagonal(scale);
            let (object, joint) = (scale(&plan.object_scale), scale(&plan.actuated_scale));
            let task = Matrix::from_fn(2, plan.object(), |i, j| f64::from(u8::from(i == j)));
            let of_task = (Some(task), Matrix::identity(2));
            let of_task = Kernel::new(plan.clone(), of_task, joint.clone()).unwrap();
            let of_twist = Kernel::new(plan, (None, object), joint).unwrap();
            let values = |kernel: &Kernel| {
                let mut numbers = vec![0.0; kernel.width()];
                kernel.run(mechanism.home(), mechanism.n(), &mut numbers);
                let mut whole = kernel.read(&numbers).whole.to_vec();
                whole.sort_by(f64::total_cmp);
                whole
            };
            for (x, y) in values(&of_task).iter().zip(values(&of_twist)) {
                assert!((x - y).abs() <= 1e-12 * y, "{name}: {x} and {y}");
            }
        }
    }
}
