//! Random restarts in parallel: four restarts at once, one in each lane of a SIMD register.
//!
//! Formula  levenberg_marquardt.rs
//! Shapes   four configurations of n coordinates; A: m x n by columns, each entry one number per
//!          lane
//! Valid    one goal of m components, at the end of a chain of revolute and prismatic joints with
//!          one coordinate each, m <= n <= [`MAX_COORDINATES`]
//! Why so   the fastest of four restarts needs fewer iterations than the next single one; four on
//!          every processor, so that solutions depend on it only by rounding
//! Checked  src/ik/levenberg_marquardt.rs (against single restarts), tests/it/ik.rs

use super::convergence::{
    DAMPING, Errors, MAX_STAGNATION, MAX_STEP, MIN_DAMPING, is_reached, stretch,
};
use super::options::IkOptions;
use crate::kinematics::Serial;
use crate::kinematics::serial_batched::{self, FrameAtTip, SinCos, tool_offset};
use crate::linalg::{DampedProblem, damped_by_rows};
use crate::scalar::{Array, SimdFloat};
#[cfg(target_arch = "x86_64")]
use crate::scalar::{Avx2, Lanes4};
use crate::spatial::{AlignedPose, Columns, Pose};
use crate::task::Task;

/// Restarts in a batch.
pub(super) const LANES: usize = 4;
/// Largest number of coordinates.
pub(super) const MAX_COORDINATES: usize = 12;

/// The problem shared by the restarts of a batch.
#[derive(Debug)]
pub(super) struct BatchedProblem<'a> {
    pub(super) serial: &'a Serial,
    pub(super) task: Task,
    pub(super) target: Pose,
    /// Components of the task, and the scale of their rows.
    pub(super) rows: &'a [(usize, f64)],
    pub(super) lower: &'a [f64],
    pub(super) upper: &'a [f64],
    /// Travel of slides (m), otherwise 0; true if one of them is longer than a step.
    pub(super) travel: &'a [f64],
    pub(super) has_long_slides: bool,
    /// Coordinates that keep their values.
    pub(super) fixed: &'a [bool],
    pub(super) options: &'a IkOptions,
    /// Iteration limit of each.
    pub(super) max_steps: usize,
    /// Continue until all have ended, not until the first solution.
    pub(super) until_all_end: bool,
}

/// One restart.
#[derive(Debug, Clone, Copy)]
pub(super) struct Restart {
    /// Initial guess, then the result.
    pub(super) q: [f64; MAX_COORDINATES],
    pub(super) errors: Errors,
    pub(super) steps: usize,
    best_error: f64,
    stagnation: usize,
    active: bool,
}

impl Restart {
    pub(super) fn at(q: [f64; MAX_COORDINATES]) -> Self {
        let errors = Errors { position: 0.0, orientation: 0.0, squared: 0.0 };
        Self { q, errors, steps: 0, best_error: f64::INFINITY, stagnation: 0, active: true }
    }

    pub(super) fn has_ended(&self) -> bool {
        !self.active
    }

    pub(super) fn has_reached(&self, options: &IkOptions) -> bool {
        !self.active && is_reached(self.errors, options)
    }

    fn ends_at(&self, step: usize) -> bool {
        !self.active && self.steps == step
    }

    /// Updates the state after a step: active, converged, or stagnating.
    fn update(&mut self, errors: Errors, step: usize, batched: &BatchedProblem<'_>) {
        (self.errors, self.steps) = (errors, step);
        if errors.squared < 0.25 * self.best_error {
            (self.best_error, self.stagnation) = (errors.squared, 0);
        } else {
            self.stagnation += 1;
        }
        let is_over = is_reached(errors, batched.options) || step >= batched.max_steps;
        self.active = !is_over && self.stagnation < MAX_STAGNATION && errors.squared.is_finite();
    }
}

/// Iterates from four initial guesses until one has converged, or all have ended.
pub(super) fn solve_batched(batched: &BatchedProblem<'_>, restarts: &mut [Restart; LANES]) {
    #[cfg(target_arch = "x86_64")]
    if let Some(cpu) = Avx2::detect() {
        #[allow(unsafe_code)] // the one way to call a function compiled for more than the baseline
        // SAFETY: the token proves that the processor has both features.
        unsafe {
            solve_avx2(cpu, batched, restarts);
        }
        return;
    }
    solve_with::<Array<LANES>>((), batched, restarts, serial_batched::forward);
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,fma")]
fn solve_avx2(cpu: Avx2, batched: &BatchedProblem<'_>, restarts: &mut [Restart; LANES]) {
    solve_with::<Lanes4>(cpu, batched, restarts, move |serial, turns, rows| {
        serial_batched::forward_avx2(cpu, serial, turns, rows)
    });
}

#[inline(always)]
pub(super) fn solve_with<R: SimdFloat>(
    _: R::Cpu,
    batched: &BatchedProblem<'_>,
    restarts: &mut [Restart; LANES],
    forward: impl Fn(&Serial, SinCos<'_, R>, &mut [R]) -> FrameAtTip<R>,
) {
    let zero = R::splat(0.0);
    let joints = batched.serial.joints();
    let n = joints.len();
    let mut q = [zero; MAX_COORDINATES];
    for (c, q) in q.iter_mut().enumerate().take(n) {
        *q = R::from_fn(|l| restarts[l].q[c]);
    }
    let (mut x, mut sines, mut cosines) =
        ([zero; MAX_COORDINATES], [zero; MAX_COORDINATES], [zero; MAX_COORDINATES]);
    let mut rows = [zero; 6 * MAX_COORDINATES];
    let (mut a, mut e, mut d) = ([zero; 6 * MAX_COORDINATES], [zero; 6], [zero; MAX_COORDINATES]);
    let mut units = [R::splat(1.0); MAX_COORDINATES];
    for step in 0.. {
        for (i, joint) in joints.iter().enumerate() {
            x[i] = q[joint.coordinate];
            cosines[i] = joint.angle(x[i]);
        }
        R::sines_cosines(&mut cosines[..n], &mut sines[..n], &mut rows[..n]);
        let turns = (&sines[..n], &cosines[..n]);
        let rows = &mut rows[..6 * n];
        let turned = forward(batched.serial, turns, rows);
        let tool = turned.tool(tool_offset(batched.serial, &x, rows));
        let mut squares = [0.0; LANES];
        evaluate(batched, tool, step, restarts, &mut e, &mut squares);
        if restarts.iter().any(|r| r.ends_at(step)) {
            for (c, q) in q.iter().enumerate().take(n) {
                let mut lanes = [0.0; LANES];
                q.store(&mut lanes);
                for (restart, x) in restarts.iter_mut().zip(lanes).filter(|(r, _)| r.ends_at(step))
                {
                    restart.q[c] = x;
                }
            }
        }
        let is_won = restarts.iter().any(|r| r.has_reached(batched.options));
        if restarts.iter().all(|r| !r.active) || (is_won && !batched.until_all_end) {
            return;
        }
        let m = batched.rows.len();
        rates(batched, &x, &turned, rows, &mut a[..m * n]);
        if batched.has_long_slides {
            for (c, (unit, travel)) in units.iter_mut().zip(batched.travel).enumerate() {
                *unit = R::from_fn(|l| stretch(*travel, restarts[l].errors.position));
                a[c * m..(c + 1) * m].iter_mut().for_each(|x| *x = *x * *unit);
            }
        }
        let damping = damping(&a[..m * n], R::load(&squares));
        let (a, e) = (&mut a[..m * n], &e[..m]);
        step_within(batched, (a, e), damping, &units[..n], &mut d[..n], &mut q[..n]);
    }
}

/// The scaled errors of each restart.
#[inline(always)]
fn evaluate<R: SimdFloat>(
    batched: &BatchedProblem<'_>,
    tool: Columns<[R; 3]>,
    step: usize,
    restarts: &mut [Restart; LANES],
    e: &mut [R; 6],
    squares: &mut [f64; LANES],
) {
    let mut columns = [[[0.0; LANES]; 3]; 4];
    for (axis, out) in [tool.x, tool.y, tool.z, tool.p].iter().zip(&mut columns) {
        for (x, out) in axis.iter().zip(out) {
            x.store(out);
        }
    }
    let mut all = [[0.0; LANES]; 6];
    for (l, restart) in restarts.iter_mut().enumerate().filter(|(_, r)| r.active) {
        let mut pose = AlignedPose::IDENTITY;
        for (axis, out) in columns.iter().zip([&mut pose.x, &mut pose.y, &mut pose.z, &mut pose.p])
        {
            for (x, out) in axis.iter().zip(out) {
                *out = x[l];
            }
        }
        let error = batched.task.error(pose.pose(), batched.target);
        let mut errors = Errors {
            position: error.linear.norm(),
            orientation: error.angular.norm(),
            squared: 0.0,
        };
        let error = error.to_array();
        for (&(i, scale), out) in batched.rows.iter().zip(&mut all) {
            out[l] = error[i] * scale;
            errors.squared += out[l] * out[l];
        }
        squares[l] = errors.squared;
        restart.update(errors, step, batched);
    }
    for (e, lanes) in e.iter_mut().zip(&all) {
        *e = R::load(lanes);
    }
}

/// The scaled Jacobian of the task components, by columns.
#[inline(always)]
fn rates<R: SimdFloat>(
    batched: &BatchedProblem<'_>,
    q: &[R],
    turned: &FrameAtTip<R>,
    rows: &mut [R],
    a: &mut [R],
) {
    let (joints, m) = (batched.serial.joints(), batched.rows.len());
    serial_batched::jacobian(batched.serial, batched.task.axes, q, turned, rows);
    for (&(row, scale), i) in batched.rows.iter().zip(0..) {
        let row = &rows[row * joints.len()..][..joints.len()];
        for (joint, x) in joints.iter().zip(row) {
            a[joint.coordinate * m + i] = *x * R::splat(scale);
        }
    }
}

#[inline(always)]
fn damping<R: SimdFloat>(a: &[R], squared: R) -> R {
    let mut size = R::splat(0.0);
    for x in a {
        size = x.mul_add(*x, size);
    }
    squared.mul_add(R::splat(DAMPING), size * R::splat(MIN_DAMPING))
}

/// One step of each restart; joints that would leave their limits are clamped: their columns in `a`
/// become zero. `d` is in these units.
#[inline(always)]
fn step_within<R: SimdFloat>(
    batched: &BatchedProblem<'_>,
    (a, e): (&mut [R], &[R]),
    damping: R,
    units: &[R],
    d: &mut [R],
    q: &mut [R],
) {
    let k = R::splat;
    let (zero, one) = (k(0.0), k(1.0));
    let (m, n) = (e.len(), q.len());
    let (mut gram, mut rest) = ([zero; 36], [zero; 6]);
    for _ in 0..=n {
        let problem = DampedProblem { a: &*a, e, clamped: batched.fixed, damping };
        let memory = (&mut gram[..m * m], &mut rest[..m]);
        // Repeated as a constant, so that the common size compiles to straight-line code.
        match m {
            6 => damped_by_rows(6, problem, memory, d),
            _ => damped_by_rows(m, problem, memory, d),
        };
        // 1 if the step would leave the limits, otherwise 0; zero columns never leave.
        let (mut out, mut any) = ([zero; MAX_COORDINATES], zero);
        for c in 0..n {
            let (lower, upper) = (k(batched.lower[c]), k(batched.upper[c]));
            let below = R::select_lt(lower, q[c], zero, R::select_lt(d[c], zero, one, zero));
            let above = R::select_lt(q[c], upper, zero, R::select_lt(zero, d[c], one, zero));
            out[c] = below + above;
            any = any + out[c];
        }
        if any.all_abs_le(0.0) {
            break;
        }
        for (column, out) in a.chunks_exact_mut(m).zip(out) {
            for x in column {
                *x = *x * (one - out);
            }
        }
    }
    let (mut most, mut sum) = (zero, zero);
    for d in &*d {
        most = most.max(d.abs());
        sum = sum + d.abs();
    }
    let cut = R::select_lt(k(MAX_STEP), most, k(MAX_STEP) / most, one);
    for c in 0..n {
        let there = cut.mul_add(d[c] * units[c], q[c]);
        let (lower, upper) = (k(batched.lower[c]), k(batched.upper[c]));
        let there = R::select_lt(there, lower, lower, R::select_lt(upper, there, upper, there));
        // Where the matrix is not positive definite there is no step.
        q[c] = R::select_lt(sum, k(f64::MAX), there, q[c]);
    }
}
