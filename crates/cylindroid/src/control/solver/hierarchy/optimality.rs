//! The solver against its own conditions of optimality, on problems that bytes describe.
//!
//! Formula  f(y) - f* <= max -f'(y) d over the steps d within the bounds that leave the levels before
//!          as they are (the gap of Frank & Wolfe): a linear program, solved by another method than
//!          the active set
//! Valid    steps of at most `FAR` in each unknown; rows that bind to less than 1e-12 count as kept; bounds
//!          of rows and values of levels to `ROUNDING` of the farthest point so far; levels keep their
//!          rows but for `DEPENDENT` of the motion, and leave what singular values below
//!          `Precision::STRAIGHT` could gain. Bounds that higher levels hold count as kept: that each is
//!          needed is checked apart, by what its level would gain without it. After levels whose rank,
//!          alone or with these bounds, is not clear (`UNCLEAR`), and at points where the bounds that bind
//!          nearly depend on one another (`AMPLIFIED`), points are feasible and keep the levels, but need
//!          not be the best: directions are known to a rounding divided by the singular value. Such
//!          problems are counted and few
//! Why so   a referee in a fuzzer must be fast and must not share decisions with the solver but for what
//!          these lines say: what counts as dependent and as weak, and which bounds are held. Only
//!          directions that the kept rows lose to rounding are tried. A level that leaves a weak
//!          direction is the optimum of rows that differ a little: there the bounds that it holds are
//!          no consequence of its rows
//! Source   Jaggi 2013, eq. 2
//! Checked  src/control/solver/hierarchy/findings.rs::findings_stay_mended

use super::super::active_set::{ActiveSet, DEPENDENT, FEASIBLE, Level, Precision, Weak, Whole};
use super::super::saturation::LEAST_DAMPING;
use super::ScaledLevel;
use super::problem::{Problem, Random};
use crate::linalg::{
    BoundedLinearProgram, ColumnSpace, Interval, Matrix, Objective, Threshold, norm,
};

/// Steps in each unknown.
const FAR: f64 = 4.0;

/// The largest gap, relative to one, the square of the target and the slope: rows that depend on
/// others up to 1e-10 hold directions to 1e-6.
const GAP: f64 = 1e-6;

/// Rounding of a row times the point, relative to its terms.
const ROUNDING: f64 = 1e-12;

/// Weak directions are left out of targets as servos do: otherwise points are so far away that only
/// their roundings would be seen.
const WEAK_LEVEL: Weak =
    Weak { below: 1e-3, none: Precision::STRAIGHT.rank, curvature: 1.0, least: LEAST_DAMPING };

/// The rank of levels is unclear where a singular value lies between these shares of the largest.
const UNCLEAR: [f64; 2] = [1e-13, 1e-5];

/// Beyond this amplification of roundings the bounds that bind decide nothing.
const AMPLIFIED: f64 = 1e5;

/// Singular values that are lost to rounding.
const LOST: f64 = 1e-14;

/// Multipliers below this share of the gradient that weak directions leave are not needed.
const WEAK: f64 = 0.1;

/// A bound that is held without need may be left by this share of the steps.
const AWAY: f64 = 1e-2;

/// A row of a level that was solved: its value there must stay.
#[derive(Debug, Clone)]
struct Kept {
    row: Vec<f64>,
    value: f64,
    /// Of the rows of its level.
    scale: f64,
    at: Vec<f64>,
}

/// What is checked of each point.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Checks {
    /// Bounds and levels before are kept.
    Kept,
    /// That, and no other point is better.
    Optimal,
}

/// Solves the problem that the bytes describe, level by level, and checks every point. The first byte
/// chooses between numbers that make all ranks clear and any: a search that is guided finds ranks and
/// corners that roundings decide, where no referee knows the optimum. False if numbers of the first kind
/// left a rank unclear, and with it optima that were not looked at.
pub(crate) fn check(bytes: &[u8]) -> bool {
    let (first, rest) = bytes.split_first().unwrap_or((&0, &[]));
    if first % 2 == 0 {
        return check_random(Random::coarse_of_bytes(rest), Checks::Optimal, |_| {});
    }
    check_random(Random::of_bytes(rest), Checks::Kept, |_| {});
    true
}

/// The same for a problem of any numbers after a change, optima included; true if those of all levels
/// were looked at.
#[cfg(test)]
pub(super) fn check_changed(bytes: &[u8], change: impl Fn(&mut Problem)) -> bool {
    check_random(Random::of_bytes(bytes), Checks::Optimal, change)
}

fn check_random(mut random: Random<'_>, checks: Checks, change: impl Fn(&mut Problem)) -> bool {
    let scaled = random.below(3) == 0;
    let mut problem = Problem::random(&mut random);
    change(&mut problem);
    if scaled {
        check_scaled(&mut problem, &mut random, checks);
        return true;
    }
    check_levels(&problem, &mut random, checks)
}

fn check_levels(problem: &Problem, random: &mut Random<'_>, checks: Checks) -> bool {
    let mut set = problem.active_set();
    let guess: Vec<f64> = (0..problem.n).map(|_| 3.0 * random.signed()).collect();
    assert!(set.start(&guess), "no feasible point found");
    let mut farthest = norm(set.point());
    check_kept(problem, &[], &set, farthest);
    if checks == Checks::Optimal {
        check_nearest(&Steps::beside(problem, &[], &[], &set), &guess, "start");
    }
    let (mut kept, mut held): (Vec<Kept>, Vec<usize>) = (Vec::new(), Vec::new());
    let mut is_clear = checks == Checks::Optimal;
    for (a, b) in &problem.levels {
        let mut level = Level::new(a.rows(), problem.n);
        level.rows = a.clone();
        let share = [1.0, 0.03][random.below(2)];
        level.target = b.iter().map(|x| share * x).collect();
        let freely = random.below(2) == 0;
        if !freely || set.solve_freely(&mut level, WEAK_LEVEL.below) != Whole::Performed {
            if !set.is_clear(&mut level, WEAK_LEVEL.below) {
                set.reduce_target(&mut level, WEAK_LEVEL, |_| 1.0, std::iter::empty());
            }
            set.solve(&mut level, Precision::STRAIGHT);
        }
        farthest = farthest.max(norm(set.point()));
        check_kept(problem, &kept, &set, farthest);
        let left = level.left(set.point()).to_vec();
        let along: Vec<f64> = a.transpose().mul_vec(&left);
        // Gradients of points far away are as large as their rounding, multipliers larger.
        let rows = a.frobenius_norm();
        let steps = Steps::beside(problem, &kept, &held, &set);
        let amplification = steps.amplification();
        is_clear &= amplification <= AMPLIFIED;
        let left_by_rounding = ROUNDING * rows * norm(set.point()) * amplification;
        // Singular values that take no part.
        let left_by_rank = Precision::STRAIGHT.rank * norm(&left);
        let far = FAR * (problem.n as f64).sqrt();
        let slack = slack(norm(&level.target)) + far * rows * (left_by_rounding + left_by_rank);
        if is_clear {
            check_gain(&steps, &along, slack, "level");
        }
        let now: Vec<usize> = (0..problem.rows.len()).filter(|i| set.holds(*i)).collect();
        let of_level = a.mul_vec(set.point()).into_iter().enumerate().map(|(i, value)| Kept {
            row: (0..problem.n).map(|j| a[(i, j)]).collect(),
            value,
            scale: rows,
            at: set.point().to_vec(),
        });
        let after: Vec<Kept> = kept.iter().cloned().chain(of_level).collect();
        let steps_after = Steps::beside(problem, &after, &held, &set);
        is_clear &= has_clear_rank(&after, &now, problem);
        if is_clear {
            for row in now.iter().copied().filter(|row| !held.contains(row)) {
                check_needed(row, &steps, &along, &steps_after);
            }
        }
        (kept, held) = (after, now);
    }
    let goal: Vec<f64> = (0..problem.n).map(|_| random.signed()).collect();
    set.approach(&goal, Precision::STRAIGHT);
    check_kept(problem, &kept, &set, farthest.max(norm(set.point())));
    let steps = Steps::beside(problem, &kept, &held, &set);
    is_clear &= steps.amplification() <= AMPLIFIED;
    if is_clear {
        check_nearest(&steps, &goal, "approach");
    }
    is_clear
}

/// False if a singular value of the kept rows, alone or with the bounds that are held, is neither zero nor
/// clearly more.
fn has_clear_rank(kept: &[Kept], held: &[usize], problem: &Problem) -> bool {
    let levels: Vec<&[f64]> = kept.iter().map(|kept| kept.row.as_slice()).collect();
    let bounds = held.iter().map(|&i| problem.rows[i].as_slice());
    let all: Vec<&[f64]> = levels.iter().copied().chain(bounds).collect();
    [levels, all].into_iter().all(|rows| {
        let space = space(&rows, problem.n);
        let [none, whole] = UNCLEAR.map(|share| share * space.largest());
        !space.values().iter().any(|s| *s > none && *s < whole)
    })
}

/// A bound that is newly held is one beyond which the level, whose negative gradient is `along`, would
/// gain clearly more for each unit than the weak directions that it leaves, or one that its rows hold
/// anyway.
fn check_needed(row: usize, steps: &Steps<'_>, along: &[f64], after: &Steps<'_>) {
    let normal = &steps.problem.rows[row];
    let (inwards, size) = (steps.inwards(row), norm(normal));
    let without = Steps { without: Some(row), ..steps.clone() };
    let (gain, step) = without.best(along);
    let more = gain - steps.gain(along);
    let beyond = -inwards * product(normal, &step).0 / size;
    let least = WEAK * steps.left_free(along) + ROUNDING * norm(along);
    if beyond > 1e-9 && more > least * beyond {
        return;
    }
    let away: Vec<f64> = normal.iter().map(|x| inwards * x / size).collect();
    let most = after.gain(&away);
    let far = FAR * (along.len() as f64).sqrt();
    assert!(most <= AWAY * far, "bound {row} is held without need: {most:e} away, gain {more:e}");
}

/// A target that a motion without limits reaches: its direction is kept, at the largest scale.
fn check_scaled(problem: &mut Problem, random: &mut Random<'_>, checks: Checks) {
    // Rest is permitted, as for a robot.
    for (l, u) in problem.lower.iter_mut().zip(&mut problem.upper) {
        (*l, *u) = (l.min(0.0), u.max(0.0));
    }
    let a = problem.levels[0].0.clone();
    let through: Vec<f64> = (0..problem.n).map(|_| 2.0 * random.signed()).collect();
    let target = a.mul_vec(&through);
    let size = norm(&target);
    let mut set = problem.active_set();
    assert!(set.start(&vec![0.0; problem.n]), "rest is not found");
    let mut level = ScaledLevel::new(vec![0], a.rows(), problem.n);
    level.whole.rows = a.clone();
    level.whole.target.copy_from_slice(&target);
    set.solve_scaled(&mut level, Precision::EXACT, |_, _| false);
    check_kept(problem, &[], &set, norm(set.point()));
    let scale = level.scales[0];
    let left: Vec<f64> =
        a.mul_vec(set.point()).iter().zip(&target).map(|(x, b)| x - scale * b).collect();
    // Weak directions are kept to `DEPENDENT` of the motion.
    let rounding = (ROUNDING + DEPENDENT) * a.frobenius_norm() * norm(set.point());
    assert!(norm(&left) < 1e-9 * (1.0 + size) + rounding, "the direction of {target:?} is lost");
    if checks == Checks::Kept || size < 1e-6 || scale >= 1.0 - 1e-9 {
        return;
    }
    let along = a.transpose().mul_vec(&target).iter().map(|x| x / size).collect::<Vec<f64>>();
    let across = |k: usize| {
        (0..problem.n).map(|j| a[(k, j)] - target[k] / size * along[j]).collect::<Vec<f64>>()
    };
    let at = |k: usize| Kept { row: across(k), value: 0.0, scale: 0.0, at: Vec::new() };
    let across: Vec<Kept> = (0..a.rows()).map(at).collect();
    let steps = Steps::beside(problem, &across, &[], &set);
    check_gain(&steps, &along, slack(size), "scaled");
}

/// Levels before keep their values, and all bounds are kept, to the rounding of the farthest point.
fn check_kept(problem: &Problem, kept: &[Kept], set: &ActiveSet, farthest: f64) {
    let y = set.point();
    assert!(y.iter().all(|x| x.is_finite()), "{y:?}");
    let rows = problem.rows.iter().zip(problem.lower.iter().zip(&problem.upper));
    for (row, (lower, upper)) in rows {
        let now = product(row, y).0;
        let excess = (now - upper).max(lower - now);
        let bound = lower.abs().min(upper.abs());
        let slack = 10.0 * FEASIBLE * (1.0 + bound + norm(row)) + ROUNDING * norm(row) * farthest;
        assert!(excess <= slack, "{row:?} beyond its bound by {excess:e}");
    }
    for Kept { row, value, scale, at } in kept {
        let (now, size) = product(row, y);
        let moved: Vec<f64> = y.iter().zip(at).map(|(y, at)| y - at).collect();
        let rounding = ROUNDING * (size + norm(row) * farthest);
        let slack = 1e-9 * (1.0 + value.abs()) + rounding + DEPENDENT * scale * norm(&moved);
        assert!((now - value).abs() <= slack, "a level moved from {value:e} to {now:e}");
    }
}

/// `row . y`, and the size of its terms.
fn product(row: &[f64], y: &[f64]) -> (f64, f64) {
    let terms = row.iter().zip(y).map(|(a, y)| a * y);
    (terms.clone().sum(), terms.map(f64::abs).sum())
}

/// The nearest point to a goal.
fn check_nearest(steps: &Steps<'_>, goal: &[f64], what: &str) {
    let along: Vec<f64> = goal.iter().zip(steps.y).map(|(g, y)| g - y).collect();
    let far = FAR * (along.len() as f64).sqrt();
    let left_by_rounding = ROUNDING * norm(steps.y) * steps.amplification();
    check_gain(steps, &along, slack(norm(goal)) + far * left_by_rounding, what);
}

/// The largest gap for a target of this size, besides a share of the slope.
fn slack(size: f64) -> f64 {
    GAP * (1.0 + size * size)
}

/// No step gains more than `slack` along the negative gradient, and a share of the slope.
fn check_gain(steps: &Steps<'_>, along: &[f64], slack: f64, what: &str) {
    let most = steps.gain(along);
    let slope = FAR * (along.len() as f64).sqrt() * norm(along);
    assert!(most <= slack + GAP * slope, "{what}: a step gains {most:e} of {slope:e}");
}

/// True if a step within these bounds of a row stands at one of them.
fn binds(bounds: &Interval, row: &[f64], y: &[f64]) -> bool {
    bounds.upper.min(-bounds.lower) <= 10.0 * FEASIBLE * (norm(row) + norm(y))
}

/// The space of these rows of n entries.
fn space(rows: &[&[f64]], n: usize) -> ColumnSpace {
    ColumnSpace::of(&Matrix::from_fn(n, rows.len(), |j, i| rows[i][j]), Threshold::Relative(LOST))
}

/// The steps from a point that leave some rows as they are, within the bounds.
#[derive(Clone)]
struct Steps<'a> {
    problem: &'a Problem,
    y: &'a [f64],
    kept: Vec<&'a [f64]>,
    /// A row whose bounds do not count.
    without: Option<usize>,
}

impl<'a> Steps<'a> {
    /// Beside the rows of levels and the bounds that are held.
    fn beside(problem: &'a Problem, kept: &'a [Kept], held: &[usize], set: &'a ActiveSet) -> Self {
        let held = held.iter().map(|&i| problem.rows[i].as_slice());
        let kept = kept.iter().map(|kept| kept.row.as_slice()).chain(held).collect();
        Self { problem, y: set.point(), kept, without: None }
    }

    /// The bounds of the steps in each row.
    fn bounds(&self) -> impl Iterator<Item = (&'a [f64], Interval)> {
        let far = FAR * (self.y.len() as f64).sqrt();
        let ends = self.problem.lower.iter().zip(&self.problem.upper);
        self.problem.rows.iter().zip(ends).enumerate().map(move |(i, (row, (l, u)))| {
            let (value, far) = (product(row, self.y).0, far * norm(row));
            let free = Interval::symmetric(far);
            let lower = (l - value).min(0.0).max(-far);
            let upper = (u - value).max(0.0).min(far);
            let own = if self.without == Some(i) { free } else { Interval { lower, upper } };
            (row.as_slice(), own)
        })
    }

    /// The sign of steps from the nearer bound of a row.
    fn inwards(&self, row: usize) -> f64 {
        let value = product(&self.problem.rows[row], self.y).0;
        let (below, above) = (value - self.problem.lower[row], self.problem.upper[row] - value);
        if below < above { 1.0 } else { -1.0 }
    }

    /// The directions that these rows leave free, but for those lost to rounding.
    fn free(&self, kept: &[&[f64]]) -> Matrix {
        space(kept, self.y.len()).complement()
    }

    /// The rows kept, and the bounds that bind.
    fn binding(&self) -> Vec<&'a [f64]> {
        let bounds = self.bounds().filter(|(row, b)| binds(b, row, self.y)).map(|bound| bound.0);
        self.kept.iter().copied().chain(bounds).collect()
    }

    /// The size of the part of `along` that these rows leave free.
    fn left_free(&self, along: &[f64]) -> f64 {
        norm(&self.free(&self.binding()).transpose().mul_vec(along))
    }

    /// By how much roundings of a gradient grow in the multipliers of these rows.
    fn amplification(&self) -> f64 {
        let space = space(&self.binding(), self.y.len());
        let least = space.values().iter().copied().filter(|s| *s > UNCLEAR[0] * space.largest());
        space.largest() / least.fold(space.largest(), f64::min).max(f64::MIN_POSITIVE)
    }

    /// The most that a step gains along a direction.
    fn gain(&self, along: &[f64]) -> f64 {
        self.best(along).0
    }

    /// The most that a step gains along a direction, and that step.
    fn best(&self, along: &[f64]) -> (f64, Vec<f64>) {
        let n = self.y.len();
        let (equal, rows): (Vec<_>, Vec<_>) =
            self.bounds().partition(|(_, b)| b.upper - b.lower < 1e-12);
        let mut kept: Vec<&[f64]> =
            self.kept.iter().copied().chain(equal.iter().map(|b| b.0)).collect();
        let mut free = self.free(&kept);
        // Rows that bind and depend on these but for `DEPENDENT` stop the solver.
        let stops = |(row, b): &&(&[f64], Interval)| {
            let outside = norm(&free.transpose().mul_vec(row));
            binds(b, row, self.y) && outside <= 10.0 * DEPENDENT * norm(row)
        };
        let stopping: Vec<&[f64]> = rows.iter().filter(stops).map(|b| b.0).collect();
        if !stopping.is_empty() {
            kept.extend(stopping);
            free = self.free(&kept);
        }
        let m = free.cols();
        if m == 0 {
            return (0.0, vec![0.0; n]);
        }
        let units = Matrix::identity(n);
        let each = (0..n).map(|i| (units.column(i), Interval::symmetric(FAR)));
        let rows: Vec<(&[f64], Interval)> = rows.into_iter().chain(each).collect();
        let on_free =
            |row: &[f64], k: usize| row.iter().zip(free.column(k)).map(|(a, b)| a * b).sum();
        let a = Matrix::from_fn(rows.len(), m, |i, k| on_free(rows[i].0, k));
        let bounds: Vec<Interval> = rows.iter().map(|row| row.1).collect();
        let first: Vec<f64> = (0..m).map(|k| on_free(along, k)).collect();
        let step = BoundedLinearProgram::new(&a, &bounds)
            .maximize(Objective { first: &first, second: &vec![0.0; m] });
        let gain = first.iter().zip(&step).map(|(a, b)| a * b).sum();
        (gain, free.mul_vec(&step))
    }
}
