//! The solver against its own conditions of optimality, on problems that bytes describe.
//!
//! Formula  f(y) - f* <= max -f'(y) d over the steps d within the bounds that leave the levels before
//!          as they are (the gap of Frank & Wolfe): a linear program, solved by another method than
//!          the active set
//! Valid    steps of at most `FAR` in each unknown; rows that bind to less than 1e-12 count as kept;
//!          points far away, where rows without bounds nearly depend on others, to their rounding;
//!          bounds of rows to `ROUNDING` of the point; levels keep their rows but for `DEPENDENT` of the
//!          motion, and leave what singular values below `Precision::STRAIGHT` could gain; after
//!          levels whose ranks, with the bounds that bind, are not clear (`UNCLEAR`) points are feasible
//!          and keep the levels, but need not be the best: gradients, the squares of singular values,
//!          decide which bounds a level needs. The solver says which bounds it holds: one that it
//!          holds wrongly, and that makes ranks unclear, is not seen. Such problems are counted and few
//! Why so   a referee in a fuzzer must be fast and must not share decisions of ranks with the solver:
//!          only directions that the kept rows lose to rounding are tried
//! Source   Jaggi 2013, eq. 2
//! Checked  src/control/solver/hierarchy/tests.rs::findings_stay_mended

use super::super::active_set::{ActiveSet, DEPENDENT, FEASIBLE, Level, Precision, Whole};
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

/// The rank of levels is unclear where a singular value lies between these shares of the largest: it is
/// more than rounding, its square, by which gradients change, is not.
const UNCLEAR: [f64; 2] = [1e-13, 1e-5];

/// A row of a level that was solved: its value there must stay.
struct Kept {
    row: Vec<f64>,
    value: f64,
    /// Of the rows of its level.
    scale: f64,
    at: Vec<f64>,
}

/// Solves the problem that the bytes describe, level by level, and checks every point.
#[cfg(fuzzing)]
pub(crate) fn check(bytes: &[u8]) {
    check_changed(bytes, |_| {});
}

/// The same for the problem after a change; true if the optima of all levels were looked at.
pub(super) fn check_changed(bytes: &[u8], change: impl Fn(&mut Problem)) -> bool {
    let mut random = Random::of_bytes(bytes);
    let scaled = random.below(3) == 0;
    let mut problem = Problem::random(&mut random);
    change(&mut problem);
    if scaled {
        check_scaled(&mut problem, &mut random);
        return true;
    }
    check_levels(&problem, &mut random)
}

fn check_levels(problem: &Problem, random: &mut Random<'_>) -> bool {
    let mut set = problem.active_set();
    let guess: Vec<f64> = (0..problem.n).map(|_| 3.0 * random.signed()).collect();
    assert!(set.start(&guess), "no feasible point found");
    check_kept(problem, &[], &set);
    check_nearest(problem, &[], &set, &guess, "start");
    let mut kept: Vec<Kept> = Vec::new();
    let mut is_clear = true;
    for (a, b) in &problem.levels {
        let mut level = Level::new(a.rows(), problem.n);
        level.rows = a.clone();
        let share = [1.0, 0.03][random.below(2)];
        level.target = b.iter().map(|x| share * x).collect();
        let freely = random.below(2) == 0;
        if !freely || set.solve_freely(&mut level, 1e-3) != Whole::Performed {
            set.solve(&mut level, Precision::STRAIGHT);
        }
        check_kept(problem, &kept, &set);
        let left = level.left(set.point()).to_vec();
        let along: Vec<f64> = a.transpose().mul_vec(&left);
        // Gradients of points far away are as large as their rounding.
        let rows = a.frobenius_norm();
        let left_by_rounding = ROUNDING * rows * norm(set.point());
        // Singular values that take no part.
        let left_by_rank = Precision::STRAIGHT.rank * norm(&left);
        let far = FAR * (problem.n as f64).sqrt();
        let slack = slack(norm(&level.target)) + far * rows * (left_by_rounding + left_by_rank);
        if is_clear {
            check_gain(problem, &kept, &set, &along, slack, "level");
        }
        kept.extend(a.mul_vec(set.point()).into_iter().enumerate().map(|(i, value)| Kept {
            row: (0..problem.n).map(|j| a[(i, j)]).collect(),
            value,
            scale: rows,
            at: set.point().to_vec(),
        }));
        is_clear &= has_clear_rank(problem, &kept, &set);
    }
    let goal: Vec<f64> = (0..problem.n).map(|_| random.signed()).collect();
    set.approach(&goal, Precision::STRAIGHT);
    check_kept(problem, &kept, &set);
    if is_clear {
        check_nearest(problem, &kept, &set, &goal, "approach");
    }
    is_clear
}

/// False if a singular value of the kept rows, alone, with the bounds that are held or with those that
/// bind, is neither zero nor clearly more.
fn has_clear_rank(problem: &Problem, kept: &[Kept], set: &ActiveSet) -> bool {
    let bounds = problem.rows.iter().zip(problem.lower.iter().zip(&problem.upper));
    let binds = |row: &[f64], lower: f64, upper: f64| {
        let (now, size) = product(row, set.point());
        (now - lower).min(upper - now) <= 10.0 * FEASIBLE * (1.0 + size)
    };
    let binding = bounds.enumerate().filter(|(_, (row, (l, u)))| binds(row, **l, **u));
    let (held, others): (Vec<_>, Vec<_>) = binding.partition(|(i, _)| set.holds(*i));
    let bounds = held.iter().chain(&others).map(|(_, (row, _))| *row);
    let rows: Vec<&Vec<f64>> = kept.iter().map(|kept| &kept.row).chain(bounds).collect();
    [kept.len(), kept.len() + held.len(), rows.len()].into_iter().all(|m| {
        let normals = Matrix::from_fn(problem.n, m, |j, i| rows[i][j]);
        let space = ColumnSpace::of(&normals, Threshold::Relative(UNCLEAR[0]));
        let [none, whole] = UNCLEAR.map(|share| share * space.largest());
        !space.values().iter().any(|s| *s > none && *s < whole)
    })
}

/// A target that a motion without limits reaches: its direction is kept, at the largest scale.
fn check_scaled(problem: &mut Problem, random: &mut Random<'_>) {
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
    check_kept(problem, &[], &set);
    let scale = level.scales[0];
    let left: Vec<f64> =
        a.mul_vec(set.point()).iter().zip(&target).map(|(x, b)| x - scale * b).collect();
    let rounding = ROUNDING * a.frobenius_norm() * norm(set.point());
    assert!(norm(&left) < 1e-9 * (1.0 + size) + rounding, "the direction of {target:?} is lost");
    if size < 1e-6 || scale >= 1.0 - 1e-9 {
        return;
    }
    let along = a.transpose().mul_vec(&target).iter().map(|x| x / size).collect::<Vec<f64>>();
    let across = |k: usize| {
        (0..problem.n).map(|j| a[(k, j)] - target[k] / size * along[j]).collect::<Vec<f64>>()
    };
    let at = |k: usize| Kept { row: across(k), value: 0.0, scale: 0.0, at: Vec::new() };
    let across: Vec<Kept> = (0..a.rows()).map(at).collect();
    check_gain(problem, &across, &set, &along, slack(size), "scaled");
}

/// Levels before keep their values, and all bounds are kept.
fn check_kept(problem: &Problem, kept: &[Kept], set: &ActiveSet) {
    let y = set.point();
    assert!(y.iter().all(|x| x.is_finite()), "{y:?}");
    let rows = problem.rows.iter().zip(problem.lower.iter().zip(&problem.upper));
    for (row, (lower, upper)) in rows {
        let now = product(row, y).0;
        let excess = (now - upper).max(lower - now);
        let bound = lower.abs().min(upper.abs());
        let slack = 10.0 * FEASIBLE * (1.0 + bound + norm(row)) + ROUNDING * norm(row) * norm(y);
        assert!(excess <= slack, "{row:?} beyond its bound by {excess:e}");
    }
    for Kept { row, value, scale, at } in kept {
        let (now, size) = product(row, y);
        let moved: Vec<f64> = y.iter().zip(at).map(|(y, at)| y - at).collect();
        let slack = 1e-9 * (1.0 + value.abs()) + ROUNDING * size + DEPENDENT * scale * norm(&moved);
        assert!((now - value).abs() <= slack, "a level moved from {value:e} to {now:e}");
    }
}

/// `row . y`, and the size of its terms.
fn product(row: &[f64], y: &[f64]) -> (f64, f64) {
    let terms = row.iter().zip(y).map(|(a, y)| a * y);
    (terms.clone().sum(), terms.map(f64::abs).sum())
}

/// The nearest point to a goal.
fn check_nearest(problem: &Problem, kept: &[Kept], set: &ActiveSet, goal: &[f64], what: &str) {
    let along: Vec<f64> = goal.iter().zip(set.point()).map(|(g, y)| g - y).collect();
    check_gain(problem, kept, set, &along, slack(norm(goal)), what);
}

/// The largest gap for a target of this size, besides a share of the slope.
fn slack(size: f64) -> f64 {
    GAP * (1.0 + size * size)
}

/// No step gains more than `slack` along the negative gradient, and a share of the slope.
fn check_gain(
    problem: &Problem,
    kept: &[Kept],
    set: &ActiveSet,
    along: &[f64],
    slack: f64,
    what: &str,
) {
    let most = gain(problem, kept, set.point(), along);
    let slope = FAR * (problem.n as f64).sqrt() * norm(along);
    assert!(most <= slack + GAP * slope, "{what}: a step gains {most:e} of {slope:e}");
}

/// The most that a step within the bounds and beside the kept rows gains along a direction.
fn gain(problem: &Problem, kept: &[Kept], y: &[f64], along: &[f64]) -> f64 {
    let n = problem.n;
    let mut kept: Vec<&[f64]> = kept.iter().map(|kept| kept.row.as_slice()).collect();
    let mut rows: Vec<(&[f64], Interval)> = Vec::new();
    for (row, (l, u)) in problem.rows.iter().zip(problem.lower.iter().zip(&problem.upper)) {
        let value = product(row, y).0;
        let far = FAR * norm(row) * (n as f64).sqrt();
        let lower = (l - value).min(0.0).max(-far);
        let upper = (u - value).max(0.0).min(far);
        if upper - lower < 1e-12 {
            kept.push(row);
        } else {
            rows.push((row, Interval { lower, upper }));
        }
    }
    let normals = Matrix::from_fn(n, kept.len(), |j, i| kept[i][j]);
    let free = ColumnSpace::of(&normals, Threshold::Relative(1e-14)).complement();
    let m = free.cols();
    if m == 0 {
        return 0.0;
    }
    let units = Matrix::identity(n);
    let each = (0..n).map(|i| (units.column(i), Interval::symmetric(FAR)));
    let rows: Vec<(&[f64], Interval)> = rows.into_iter().chain(each).collect();
    let on_free = |row: &[f64], k: usize| row.iter().zip(free.column(k)).map(|(a, b)| a * b).sum();
    let a = Matrix::from_fn(rows.len(), m, |i, k| on_free(rows[i].0, k));
    let bounds: Vec<Interval> = rows.iter().map(|row| row.1).collect();
    let first: Vec<f64> = (0..m).map(|k| on_free(along, k)).collect();
    let step = BoundedLinearProgram::new(&a, &bounds)
        .maximize(Objective { first: &first, second: &vec![0.0; m] });
    first.iter().zip(&step).map(|(a, b)| a * b).sum()
}
