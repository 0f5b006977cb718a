//! Four attempts side by side, one in each lane of a register.
//!
//! Formula  attempt.rs
//! Shapes   four postures of n coordinates; A: m x n by columns, each entry a number of lanes
//! Valid    one goal of m components, at the end of a chain of hinges and slides that have a
//!          coordinate each, m <= n <= [`MOST`]
//! Why so   the first of four to reach needs fewer steps than the next one would; four on every
//!          processor, so that answers depend on it by rounding alone
//! Checked  tests in this file (against single attempts), tests/it/ik.rs

use super::attempt::{DAMPING, Errors, LARGEST_STEP, LEAST_DAMPING, PATIENCE, is_reached};
use super::damped::{Wanted, by_rows};
use super::goal::Goal;
use super::options::IkOptions;
use crate::kinematics::Serial;
use crate::kinematics::serial_batched::{self, FrameAtTip, SinCos, tool_offset};
use crate::scalar::{Array, SimdFloat};
#[cfg(target_arch = "x86_64")]
use crate::scalar::{Lanes4, has_avx2};
use crate::spatial::{AlignedPose, Columns};

/// Attempts side by side.
pub(super) const LANES: usize = 4;
/// Coordinates at the most.
pub(super) const MOST: usize = 12;

/// What all of them work at.
#[derive(Debug)]
pub(super) struct Course<'a> {
    pub(super) serial: &'a Serial,
    pub(super) goal: &'a Goal,
    /// Components that matter, and the scale of their rows.
    pub(super) rows: &'a [(usize, f64)],
    pub(super) lower: &'a [f64],
    pub(super) upper: &'a [f64],
    /// Coordinates that keep their values.
    pub(super) fixed: &'a [bool],
    pub(super) options: &'a IkOptions,
    /// Steps of each at the most.
    pub(super) most: usize,
    /// To the end of all, not of the first that reaches.
    pub(super) all: bool,
}

/// One of them.
#[derive(Debug, Clone, Copy)]
pub(super) struct Runner {
    /// Where it starts, then where it came to.
    pub(super) q: [f64; MOST],
    pub(super) errors: Errors,
    pub(super) steps: usize,
    mark: f64,
    since: usize,
    runs: bool,
}

impl Runner {
    pub(super) fn at(q: [f64; MOST]) -> Self {
        let errors = Errors { position: 0.0, orientation: 0.0, squared: 0.0 };
        Self { q, errors, steps: 0, mark: f64::INFINITY, since: 0, runs: true }
    }

    pub(super) fn has_ended(&self) -> bool {
        !self.runs
    }

    pub(super) fn has_reached(&self, options: &IkOptions) -> bool {
        !self.runs && is_reached(self.errors, options)
    }

    fn ends_at(&self, step: usize) -> bool {
        !self.runs && self.steps == step
    }

    /// After a step: goes on, or has reached, or makes no progress.
    fn judge(&mut self, errors: Errors, step: usize, course: &Course<'_>) {
        (self.errors, self.steps) = (errors, step);
        if errors.squared < 0.25 * self.mark {
            (self.mark, self.since) = (errors.squared, 0);
        } else {
            self.since += 1;
        }
        let is_over = is_reached(errors, course.options) || step >= course.most;
        self.runs = !is_over && self.since < PATIENCE && errors.squared.is_finite();
    }
}

/// From four postures until one has reached, or each is at an end.
pub(super) fn race(course: &Course<'_>, runners: &mut [Runner; LANES]) {
    #[cfg(target_arch = "x86_64")]
    if has_avx2() {
        #[allow(unsafe_code)] // the one way to call a function compiled for more than the baseline
        // SAFETY: the processor has both features, as just asked.
        unsafe {
            race_avx2(course, runners);
        }
        return;
    }
    race_with::<Array<LANES>>(course, runners, serial_batched::forward);
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,fma")]
fn race_avx2(course: &Course<'_>, runners: &mut [Runner; LANES]) {
    race_with::<Lanes4>(course, runners, |serial, turns, rows| {
        serial_batched::forward_avx2(serial, turns, rows)
    });
}

#[inline(always)]
fn race_with<R: SimdFloat>(
    course: &Course<'_>,
    runners: &mut [Runner; LANES],
    forward: impl Fn(&Serial, SinCos<'_, R>, &mut [R]) -> FrameAtTip<R>,
) {
    let zero = R::splat(0.0);
    let joints = course.serial.joints();
    let n = joints.len();
    let mut q = [zero; MOST];
    for (c, q) in q.iter_mut().enumerate().take(n) {
        *q = R::from_fn(|l| runners[l].q[c]);
    }
    let (mut x, mut sines, mut cosines) = ([zero; MOST], [zero; MOST], [zero; MOST]);
    let mut rows = [zero; 6 * MOST];
    let (mut a, mut e, mut d) = ([zero; 6 * MOST], [zero; 6], [zero; MOST]);
    for step in 0.. {
        for (i, joint) in joints.iter().enumerate() {
            x[i] = q[joint.coordinate];
            cosines[i] = joint.angle(x[i]);
        }
        R::sines_cosines(&mut cosines[..n], &mut sines[..n], &mut rows[..n]);
        let turns = (&sines[..n], &cosines[..n]);
        let rows = &mut rows[..6 * n];
        let turned = forward(course.serial, turns, rows);
        let tool = turned.tool(tool_offset(course.serial, &x, rows));
        let mut squares = [0.0; LANES];
        look(course, tool, step, runners, &mut e, &mut squares);
        if runners.iter().any(|r| r.ends_at(step)) {
            for (c, q) in q.iter().enumerate().take(n) {
                let mut lanes = [0.0; LANES];
                q.store(&mut lanes);
                for (runner, x) in runners.iter_mut().zip(lanes).filter(|(r, _)| r.ends_at(step)) {
                    runner.q[c] = x;
                }
            }
        }
        let is_won = runners.iter().any(|r| r.has_reached(course.options));
        if runners.iter().all(|r| !r.runs) || (is_won && !course.all) {
            return;
        }
        let m = course.rows.len();
        rates(course, &x, &turned, rows, &mut a[..m * n]);
        let damping = damping(&a[..m * n], R::load(&squares));
        step_within(course, &mut a[..m * n], &e[..m], damping, &mut d[..n], &mut q[..n]);
    }
}

/// The errors of each, scaled.
#[inline(always)]
fn look<R: SimdFloat>(
    course: &Course<'_>,
    tool: Columns<[R; 3]>,
    step: usize,
    runners: &mut [Runner; LANES],
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
    for (l, runner) in runners.iter_mut().enumerate().filter(|(_, r)| r.runs) {
        let mut pose = AlignedPose::IDENTITY;
        for (axis, out) in columns.iter().zip([&mut pose.x, &mut pose.y, &mut pose.z, &mut pose.p])
        {
            for (x, out) in axis.iter().zip(out) {
                *out = x[l];
            }
        }
        let error = course.goal.task.error(pose.pose(), course.goal.target);
        let mut errors = Errors {
            position: error.linear.norm(),
            orientation: error.angular.norm(),
            squared: 0.0,
        };
        let error = error.to_array();
        for (&(i, scale), out) in course.rows.iter().zip(&mut all) {
            out[l] = error[i] * scale;
            errors.squared += out[l] * out[l];
        }
        squares[l] = errors.squared;
        runner.judge(errors, step, course);
    }
    for (e, lanes) in e.iter_mut().zip(&all) {
        *e = R::load(lanes);
    }
}

/// The scaled rates of the components that matter, by columns.
#[inline(always)]
fn rates<R: SimdFloat>(
    course: &Course<'_>,
    q: &[R],
    turned: &FrameAtTip<R>,
    rows: &mut [R],
    a: &mut [R],
) {
    let (joints, m) = (course.serial.joints(), course.rows.len());
    serial_batched::jacobian(course.serial, course.goal.task.axes, q, turned, rows);
    for (&(row, scale), i) in course.rows.iter().zip(0..) {
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
    squared.mul_add(R::splat(DAMPING), size * R::splat(LEAST_DAMPING))
}

/// One step of each; what would leave its limits is held, and counts as zero in `a`.
#[inline(always)]
fn step_within<R: SimdFloat>(
    course: &Course<'_>,
    a: &mut [R],
    e: &[R],
    damping: R,
    d: &mut [R],
    q: &mut [R],
) {
    let k = R::splat;
    let (zero, one) = (k(0.0), k(1.0));
    let (m, n) = (e.len(), q.len());
    let (mut gram, mut rest) = ([zero; 36], [zero; 6]);
    for _ in 0..=n {
        let wanted = Wanted { a: &*a, e, held: course.fixed, damping };
        let memory = (&mut gram[..m * m], &mut rest[..m]);
        // Said once more as a constant, the common size compiles to straight code.
        match m {
            6 => by_rows(6, wanted, memory, d),
            _ => by_rows(m, wanted, memory, d),
        };
        // 1 where the step would lead out, else 0; of a column that is zero it leads nowhere.
        let (mut out, mut any) = ([zero; MOST], zero);
        for c in 0..n {
            let (lower, upper) = (k(course.lower[c]), k(course.upper[c]));
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
    let cut = R::select_lt(k(LARGEST_STEP), most, k(LARGEST_STEP) / most, one);
    for c in 0..n {
        let there = cut.mul_add(d[c], q[c]);
        let (lower, upper) = (k(course.lower[c]), k(course.upper[c]));
        let there = R::select_lt(there, lower, lower, R::select_lt(upper, there, upper, there));
        // Where the matrix is not positive definite there is no step.
        q[c] = R::select_lt(sum, k(f64::MAX), there, q[c]);
    }
}

#[cfg(test)]
mod tests {
    use super::super::attempt::Problem;
    use super::super::goal::Task;
    use super::*;
    use crate::kinematics::ReferenceFrame;
    use crate::model::catalogue;
    use crate::scalar::uniform;

    /// Each is the attempt that it would be alone, but for rounding, which some feel: what it
    /// claims to reach is reached within the limits, and nearly all come to the same end.
    #[test]
    fn runners_are_single_attempts() {
        let mut random = 5;
        for (name, task) in [
            ("panda", Task::POSE),
            ("panda", Task::POSITION),
            ("iiwa14", Task { axes: ReferenceFrame::Local, ..Task::POSE }),
            ("ur5e", Task::POSE),
            ("3r", Task::PLANAR),
        ] {
            let robot = catalogue::load(name).unwrap();
            let options = IkOptions::default();
            let limits = |c: usize| robot.coordinates()[c].limits;
            let mut draw = || -> Vec<f64> {
                let mut spread = |(l, u): (f64, f64)| l + (u - l) * uniform(&mut random);
                (0..robot.n())
                    .map(|c| spread((limits(c).lower.max(-3.0), limits(c).upper.min(3.0))))
                    .collect()
            };
            let (mut same, mut reached, mut total) = (0, 0, 0);
            for round in 0..40 {
                let target = robot.state(&draw()).unwrap().pose(robot.tool());
                let goal = Goal { task, ..Goal::pose(robot.tool(), target) };
                let mut problem = Problem::new(&robot, &[goal], &options);
                let seeds: [Vec<f64>; LANES] = std::array::from_fn(|_| draw());
                let all = round % 2 == 0;
                let mut runners = seeds.each_ref().map(|seed| {
                    let mut q = [0.0; MOST];
                    q[..seed.len()].copy_from_slice(seed);
                    Runner::at(q)
                });
                let course = Course { most: 60, all, ..problem.course(&options).unwrap() };
                if round % 4 < 2 {
                    race(&course, &mut runners);
                } else {
                    race_with::<Array<LANES>>(&course, &mut runners, serial_batched::forward);
                }
                assert!(!all || runners.iter().all(Runner::has_ended));
                for (mut q, runner) in seeds.into_iter().zip(&runners) {
                    if !runner.has_ended() {
                        continue;
                    }
                    let (errors, steps) = problem.run(&mut q, &options, 60);
                    let there = &runner.q[..robot.n()];
                    let is_there = is_reached(errors, &options);
                    let apart = q.iter().zip(there).fold(0.0_f64, |m, (a, b)| m.max((a - b).abs()));
                    let is_same = steps == runner.steps && is_there == runner.has_reached(&options);
                    same += usize::from(is_same && (apart < 1e-6 || !is_there));
                    total += 1;
                    if runner.has_reached(&options) {
                        let errors = problem.look(there);
                        assert!(errors.position < 1.001 * options.position_tolerance, "{name}");
                        assert!(
                            errors.orientation < 1.001 * options.orientation_tolerance,
                            "{name}"
                        );
                        assert!(robot.outside_limits(there).next().is_none());
                        reached += 1;
                    }
                }
            }
            assert!(
                10 * same >= 9 * total && 4 * reached > total,
                "{name}: {same} {reached} {total}"
            );
        }
    }

    /// Coordinates that keep their values keep them.
    #[test]
    fn fixed_coordinates_rest() {
        let robot = catalogue::load("panda").unwrap();
        let options = IkOptions { fixed: vec![2], ..IkOptions::default() };
        let mut q = robot.home().to_vec();
        q[2] = 0.3;
        q[3] -= 0.4;
        let goal = Goal::pose(robot.tool(), robot.state(&q).unwrap().pose(robot.tool()));
        let problem = Problem::new(&robot, &[goal], &options);
        let mut start = [0.0; MOST];
        start[..7].copy_from_slice(robot.home());
        start[2] = 0.3;
        let mut runners = [Runner::at(start); LANES];
        race(&Course { most: 60, all: true, ..problem.course(&options).unwrap() }, &mut runners);
        assert!(runners.iter().all(|r| r.q[2] == 0.3 && r.has_reached(&options)));
    }
}
