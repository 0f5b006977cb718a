//! The solver against Clarabel, and scaled directions against linear programs.

use clarabel::algebra::CscMatrix;
use clarabel::solver::{
    DefaultSettings, DefaultSolver, IPSolver, NonnegativeConeT, SolverStatus, SupportedConeT,
    ZeroConeT,
};

use super::super::active_set::{DampedLevel, FEASIBLE, Level, Precision, Weak, Whole};
use super::ScaledLevel;
use super::problem::{Problem, Random};
use crate::linalg::{Matrix, Svd, dot, norm};

impl Problem {
    fn assert_feasible(&self, y: &[f64], what: &str) {
        for (i, row) in self.rows.iter().enumerate() {
            let value: f64 = row.iter().zip(y).map(|(a, b)| a * b).sum();
            for (excess, bound) in
                [(value - self.upper[i], self.upper[i]), (self.lower[i] - value, self.lower[i])]
            {
                let slack = 10.0 * FEASIBLE * (1.0 + bound.abs() + norm(row));
                assert!(!(excess > slack), "{what}: row {i} beyond its bound by {excess}");
            }
        }
    }

    /// The least |A y - b| of a level with `kept` rows of higher levels at their values, by
    /// Clarabel; `None` if it gives up.
    fn referee(
        &self,
        level: usize,
        kept: &[(Vec<f64>, f64)],
        linear: Option<&[f64]>,
    ) -> Option<Vec<f64>> {
        let n = self.n;
        let (a, b) = &self.levels[level];
        // |A y - b|^2 / 2 as 1/2 y^T P y + q^T y
        let p = match linear {
            None => {
                Matrix::from_fn(n, n, |i, j| (0..a.rows()).map(|k| a[(k, i)] * a[(k, j)]).sum())
            }
            Some(_) => Matrix::zeros(n, n),
        };
        let q: Vec<f64> = match linear {
            None => (0..n).map(|j| -(0..a.rows()).map(|k| a[(k, j)] * b[k]).sum::<f64>()).collect(),
            Some(q) => q.to_vec(),
        };
        let mut equal: Vec<(Vec<f64>, f64)> = kept.to_vec();
        let mut less: Vec<(Vec<f64>, f64)> = Vec::new();
        for (i, row) in self.rows.iter().enumerate() {
            let minus: Vec<f64> = row.iter().map(|x| -x).collect();
            if self.lower[i] == self.upper[i] {
                equal.push((row.clone(), self.upper[i]));
                continue;
            }
            if self.upper[i].is_finite() {
                less.push((row.clone(), self.upper[i]));
            }
            if self.lower[i].is_finite() {
                less.push((minus, -self.lower[i]));
            }
        }
        let all: Vec<&(Vec<f64>, f64)> = equal.iter().chain(&less).collect();
        let dense = |rows: usize, f: &dyn Fn(usize, usize) -> f64| {
            let (mut colptr, mut rowval, mut values) = (vec![0], Vec::new(), Vec::new());
            for j in 0..n {
                for i in 0..rows {
                    let x = f(i, j);
                    if x != 0.0 {
                        rowval.push(i);
                        values.push(x);
                    }
                }
                colptr.push(rowval.len());
            }
            CscMatrix::new(rows, n, colptr, rowval, values)
        };
        let upper = dense(n, &|i, j| if i <= j { p[(i, j)] } else { 0.0 });
        let rows = dense(all.len(), &|i, j| all[i].0[j]);
        let rest: Vec<f64> = all.iter().map(|(_, b)| *b).collect();
        let cones: Vec<SupportedConeT<f64>> =
            vec![ZeroConeT(equal.len()), NonnegativeConeT(less.len())];
        let settings = DefaultSettings {
            verbose: false,
            tol_gap_abs: 1e-13,
            tol_gap_rel: 1e-13,
            tol_feas: 1e-12,
            max_iter: 200,
            ..DefaultSettings::default()
        };
        let mut solver = DefaultSolver::new(&upper, &q, &rows, &rest, &cones, settings).ok()?;
        solver.solve();
        let good = matches!(
            solver.solution.status,
            SolverStatus::Solved | SolverStatus::AlmostSolved | SolverStatus::InsufficientProgress
        );
        good.then(|| solver.solution.x.clone())
    }
}

fn residual(a: &Matrix, b: &[f64], y: &[f64]) -> f64 {
    norm(&a.mul_vec(y).iter().zip(b).map(|(x, b)| x - b).collect::<Vec<_>>())
}

/// Violation of everything that binds a point of the referee: it is no optimum if it is large.
fn violation(problem: &Problem, kept: &[(Vec<f64>, f64)], y: &[f64]) -> f64 {
    let value = |row: &[f64]| -> f64 { row.iter().zip(y).map(|(a, b)| a * b).sum() };
    let rows = problem.rows.iter().zip(problem.lower.iter().zip(&problem.upper));
    let rows = rows.map(|(row, (l, u))| (value(row) - u).max(l - value(row)));
    let kept = kept.iter().map(|(row, b)| (value(row) - b).abs());
    rows.chain(kept).fold(0.0, f64::max)
}

/// Level by level the same optimum as Clarabel: never worse than its point by more than 1e-9, where
/// that point keeps to its rows, and feasible itself.
#[test]
fn levels_are_the_optima_of_clarabel() {
    let mut random = Random::seeded(11);
    let (mut compared, mut better) = (0, 0);
    let mut rounds = 0;
    for round in 0..10_000 {
        let problem = Problem::random(&mut random);
        let mut set = problem.active_set();
        let guess: Vec<f64> = (0..problem.n).map(|_| 3.0 * random.signed()).collect();
        assert!(set.start(&guess), "round {round}: no feasible point found");
        problem.assert_feasible(set.point(), "start");
        let mut kept: Vec<(Vec<f64>, f64)> = Vec::new();
        for (k, (a, b)) in problem.levels.iter().enumerate() {
            let mut level = Level::new(a.rows(), problem.n);
            level.rows = a.clone();
            level.target.copy_from_slice(b);
            set.solve(&mut level, Precision::EXACT);
            problem.assert_feasible(set.point(), "level");
            let own = residual(a, b, set.point());
            // One problem in ten has a referee; all keep what came before.
            for (row, value) in &kept {
                let now: f64 = row.iter().zip(set.point()).map(|(a, b)| a * b).sum();
                assert!((now - value).abs() < 1e-9 * (1.0 + value.abs()), "round {round}");
            }
            if let Some(other) = problem.referee(k, &kept, None) {
                let off = violation(&problem, &kept, &other);
                let theirs = residual(a, b, &other);
                if off < 1e-10 {
                    compared += 1;
                    assert!(
                        own <= theirs + 1e-9 * (1.0 + theirs) + 100.0 * off,
                        "round {round}, level {k}: {own} against {theirs}, off {off}"
                    );
                    better += usize::from(own < theirs - 1e-9);
                }
            }
            let now = a.mul_vec(set.point());
            kept.extend(
                (0..a.rows()).map(|i| ((0..problem.n).map(|j| a[(i, j)]).collect(), now[i])),
            );
        }
        rounds = rounds.max(set.rounds());
    }
    println!(
        "{compared} levels compared, {better} better than the referee, {rounds} rounds at most"
    );
    assert!(compared > 10_000, "{compared}");
}

/// A damped level keeps its rows and nothing else: what comes after it is the optimum of Clarabel with
/// these rows alone, also where the damped motion stood at inequalities.
#[test]
fn damped_levels_keep_their_rows_alone() {
    let mut random = Random::seeded(13);
    let (mut compared, mut left) = (0, 0);
    for round in 0..2000 {
        let mut problem = Problem::random(&mut random);
        let n = problem.n;
        let desired: Vec<f64> = (0..n).map(|_| random.signed()).collect();
        problem.levels.truncate(1);
        problem.levels.push((Matrix::identity(n), desired.clone()));
        let mut set = problem.active_set();
        assert!(set.start(&vec![0.0; n]), "round {round}");
        let (a, b) = &problem.levels[0];
        let mut level = DampedLevel::new(a.rows(), n);
        level.level.rows = a.clone();
        level.level.target.copy_from_slice(b);
        level.damp_alike(0.1);
        let mut stops = Vec::new();
        set.solve_damped(&mut level, Precision::EXACT, |(row, _)| stops.push(row));
        let damped = set.point().to_vec();
        let values = a.mul_vec(&damped);
        let kept: Vec<(Vec<f64>, f64)> = a.to_rows().into_iter().zip(values).collect();
        set.approach(&desired, Precision::EXACT);
        problem.assert_feasible(set.point(), "after the damped level");
        for (row, value) in &kept {
            let now: f64 = row.iter().zip(set.point()).map(|(a, b)| a * b).sum();
            assert!((now - value).abs() < 1e-9 * (1.0 + value.abs()), "round {round}");
        }
        let Some(other) = problem.referee(1, &kept, None) else { continue };
        if violation(&problem, &kept, &other) > 1e-9 {
            continue;
        }
        compared += 1;
        let distance = |y: &[f64]| residual(&Matrix::identity(n), &desired, y);
        let (own, theirs) = (distance(set.point()), distance(&other));
        assert!(own < theirs + 1e-7 * (1.0 + theirs), "round {round}: {own} and {theirs}");
        let value = |y: &[f64], row: usize| -> f64 {
            problem.rows[row].iter().zip(y).map(|(a, b)| a * b).sum()
        };
        let moved = |row: &usize| (value(set.point(), *row) - value(&damped, *row)).abs() > 1e-6;
        left += u32::from(stops.iter().any(moved));
    }
    assert!(compared > 500 && left > 50, "{compared} compared, {left} left inequalities");
}

/// The least residual of a level, after others, leaves the point, the inequalities that hold it and
/// the solution that follows as they are.
#[test]
fn least_residuals_change_nothing() {
    let mut random = Random::seeded(19);
    let mut held = 0;
    for round in 0..1000 {
        let problem = Problem::random(&mut random);
        let n = problem.n;
        let Some(((a, b), higher)) = problem.levels.split_last() else { continue };
        let run = |looks: bool| {
            let mut set = problem.active_set();
            assert!(set.start(&vec![0.4; n]), "round {round}");
            for (a, b) in higher {
                let mut level = Level::new(a.rows(), n);
                level.rows = a.clone();
                level.target.copy_from_slice(b);
                set.solve(&mut level, Precision::EXACT);
            }
            let mut level = DampedLevel::new(a.rows(), n);
            level.level.rows = a.clone();
            level.level.target.copy_from_slice(b);
            level.damp_alike(0.01);
            let (before, was_held) = (set.point().to_vec(), set.is_at_bound());
            let mut least = None;
            if looks {
                let left = set.least_left(&mut level.level, Precision::EXACT).to_vec();
                least = Some(norm(&left));
                assert_eq!(set.point(), before, "round {round}");
                assert_eq!(set.is_at_bound(), was_held, "round {round}");
            }
            set.solve_damped(&mut level, Precision::EXACT, |_| {});
            let own = residual(a, b, set.point());
            assert!(least.is_none_or(|least| least < own + 1e-9), "round {round}");
            (set.point().to_vec(), was_held)
        };
        let ((one, is_held), (other, _)) = (run(true), run(false));
        let difference: Vec<f64> = one.iter().zip(&other).map(|(x, y)| x - y).collect();
        assert!(norm(&difference) < 1e-9 * (1.0 + norm(&other)), "round {round}");
        held += u32::from(is_held);
    }
    assert!(held > 100, "{held}");
}

/// Targets without what their rows contradict, by an elimination where the rank is clear: the
/// filter of the singular vectors, for rows of all ranks and with weights.
#[test]
fn targets_are_reduced_to_what_their_rows_permit() {
    let mut random = Random::seeded(23);
    for round in 0..1000 {
        let (n, m) = (2 + random.below(7), 2 + random.below(7));
        let rank = 1 + random.below(m.min(n));
        let [left, right] =
            [(m, rank), (rank, n)].map(|(r, c)| Matrix::from_fn(r, c, |_, _| random.signed()));
        let mut level = Level::new(m, n);
        level.rows = &left * &right;
        let target: Vec<f64> = (0..m).map(|_| random.signed()).collect();
        level.target.copy_from_slice(&target);
        let problem =
            Problem { n, boxed: false, rows: vec![], lower: vec![], upper: vec![], levels: vec![] };
        let mut set = problem.active_set();
        assert!(set.start(&vec![0.0; n]));
        let svd = Svd::of(&level.rows);
        // No direction is weak: only what no motion does is left out.
        let weak = Weak { below: 1e-9, none: 1e-9, curvature: 0.05, least: 1e-6 };
        let weights = [(0..1, 1.0), (1..m, if round % 2 == 0 { 10.0 } else { 1.0 })];
        let missing = set.reduce_target(&mut level, weak, |_| 1.0, weights.into_iter());
        let mut expected = vec![0.0; m];
        for i in 0..svd.rank(1e-9).rank {
            let part = dot(svd.u(i), &target);
            expected.iter_mut().zip(svd.u(i)).for_each(|(x, u)| *x += part * u);
        }
        let rest: Vec<f64> = target.iter().zip(&expected).map(|(b, x)| b - x).collect();
        assert!((missing - norm(&rest)).abs() < 1e-9, "round {round}: {missing}");
        for (x, e) in level.target.iter().zip(&expected) {
            assert!((x - e).abs() < 1e-8, "round {round}, {m} x {n}, rank {rank}: {x} {e}");
        }
    }
}

/// Directions are damped by the positive part of their curvature: the optimum of Clarabel for rows that
/// say the same.
#[test]
fn curved_levels_are_the_optima_of_clarabel() {
    let mut random = Random::seeded(17);
    let (mut compared, damping) = (0, 1e-3_f64);
    for round in 0..2000 {
        let mut problem = Problem::random(&mut random);
        let n = problem.n;
        problem.levels.truncate(1);
        // C = Q diag(c) Q, Q a reflection.
        let v: Vec<f64> = (0..n).map(|_| random.signed()).collect();
        let square: f64 = v.iter().map(|x| x * x).sum();
        let q =
            Matrix::from_fn(n, n, |i, j| f64::from(u8::from(i == j)) - 2.0 * v[i] * v[j] / square);
        let c: Vec<f64> = (0..n).map(|_| 3.0 * random.signed()).collect();
        let mut set = problem.active_set();
        assert!(set.start(&vec![0.0; n]), "round {round}");
        let (a, b) = problem.levels[0].clone();
        let m = a.rows();
        let mut level = DampedLevel::new(m, n);
        level.level.rows = a.clone();
        level.level.target.copy_from_slice(&b);
        level.curvature =
            Matrix::from_fn(n, n, |i, j| (0..n).map(|k| q[(i, k)] * c[k] * q[(k, j)]).sum());
        let both_signs = round % 2 == 1;
        level.damp(damping, both_signs);
        set.solve_damped(&mut level, Precision::EXACT, |_| {});
        problem.assert_feasible(set.point(), "curved level");
        let rows =
            Matrix::from_fn(m + 2 * n, n, |i, j| match (i.checked_sub(m), i.checked_sub(m + n)) {
                (None, _) => a[(i, j)],
                (Some(k), None) => {
                    if both_signs { c[k].abs() } else { c[k].max(0.0) }.sqrt() * q[(k, j)]
                }
                (_, Some(k)) => damping.sqrt() * f64::from(u8::from(k == j)),
            });
        let target = [&b[..], &vec![0.0; 2 * n]].concat();
        problem.levels.push((rows.clone(), target.clone()));
        let Some(other) = problem.referee(1, &[], None) else { continue };
        if violation(&problem, &[], &other) > 1e-10 {
            continue;
        }
        compared += 1;
        let (own, theirs) =
            (residual(&rows, &target, set.point()), residual(&rows, &target, &other));
        assert!(own <= theirs + 1e-8 * (1.0 + theirs), "round {round}: {own} and {theirs}");
    }
    assert!(compared > 1000, "{compared}");
}

/// The nearest point of the polyhedron is nearer than any other point found.
#[test]
fn the_start_is_the_nearest_feasible_point() {
    let mut random = Random::seeded(5);
    for round in 0..500 {
        let mut problem = Problem::random(&mut random);
        let guess: Vec<f64> = (0..problem.n).map(|_| 3.0 * random.signed()).collect();
        problem.boxed = false;
        problem.levels = vec![(Matrix::identity(problem.n), guess.clone())];
        let mut set = problem.active_set();
        assert!(set.start(&guess));
        if let Some(other) = problem.referee(0, &[], None)
            && violation(&problem, &[], &other) < 1e-10
        {
            let far = |y: &[f64]| residual(&problem.levels[0].0, &guess, y);
            assert!(far(set.point()) <= far(&other) + 1e-8, "round {round}");
        }
    }
}

/// A scaled level keeps its direction exactly, at the largest scale of a linear program.
#[test]
fn scaled_levels_keep_their_direction() {
    let mut random = Random::seeded(23);
    let (mut straight, mut compared) = (0, 0);
    for round in 0..2000 {
        let mut problem = Problem::random(&mut random);
        // Rest is permitted, as for a robot.
        for (l, u) in problem.lower.iter_mut().zip(&mut problem.upper) {
            (*l, *u) = (l.min(0.0), u.max(0.0));
        }
        let (a, mut b) = problem.levels[0].clone();
        let through: Vec<f64> = (0..problem.n).map(|_| 2.0 * random.signed()).collect();
        b.copy_from_slice(&a.mul_vec(&through)); // a motion that exists without limits
        let size = norm(&b);
        let mut set = problem.active_set();
        assert!(set.start(&vec![0.0; problem.n]));
        let mut level = ScaledLevel::new(vec![0], a.rows(), problem.n);
        level.whole.rows = a.clone();
        level.whole.target.copy_from_slice(&b);
        set.solve_scaled(&mut level, Precision::EXACT, |_, _| false);
        let scale = level.scales[0];
        problem.assert_feasible(set.point(), "scaled");
        assert!(level.are_straight[0], "round {round}");
        let scaled: Vec<f64> = b.iter().map(|b| scale * b).collect();
        assert!(residual(&a, &scaled, set.point()) < 1e-9 * (1.0 + size), "round {round}");
        straight += 1;
        if size < 1e-6 || scale >= 1.0 - 1e-12 {
            continue;
        }
        // max s: along the target, nothing across it.
        let along: Vec<f64> =
            (0..problem.n).map(|j| (0..a.rows()).map(|k| a[(k, j)] * b[k] / size).sum()).collect();
        let across: Vec<(Vec<f64>, f64)> = (0..a.rows())
            .map(|k| ((0..problem.n).map(|j| a[(k, j)] - b[k] / size * along[j]).collect(), 0.0))
            .collect();
        let minus: Vec<f64> = along.iter().map(|x| -x).collect();
        if let Some(other) = problem.referee(0, &across, Some(&minus))
            && violation(&problem, &across, &other) < 1e-10
        {
            compared += 1;
            let theirs: f64 =
                along.iter().zip(&other).map(|(a, y)| a * y).sum::<f64>().min(size) / size;
            assert!((scale - theirs).abs() < 1e-7, "round {round}: {scale}, {theirs}");
        }
    }
    assert!(straight == 2000 && compared > 300, "{straight}, {compared}");
}

/// A level that is performed as a whole, inequalities at their bounds or not, leaves the same motions
/// to the next as one that is minimised: after the last all points agree.
#[test]
fn free_levels_are_those_of_the_active_set() {
    let mut random = Random::seeded(29);
    let (mut free, mut other, mut beside_bounds) = (0, 0, 0);
    for _ in 0..4000 {
        let problem = Problem::random(&mut random);
        let mut by_rows = problem.active_set();
        if !by_rows.start(&vec![0.0; problem.n]) {
            continue;
        }
        let mut by_svd = by_rows.clone();
        for (a, b) in &problem.levels {
            let mut level = Level::new(a.rows(), problem.n);
            level.rows = a.clone();
            // Small enough to be within the bounds at times.
            level.target = b.iter().map(|x| 0.03 * x).collect();
            let mut same = level.clone();
            if by_rows.solve_freely(&mut level, 1e-3) != Whole::Performed {
                other += 1;
                by_rows.solve(&mut level, Precision::EXACT);
            } else {
                free += 1;
                beside_bounds += usize::from(by_rows.is_at_bound());
            }
            by_svd.solve(&mut same, Precision::EXACT);
            // Levels are unique, points that lower levels may move are not.
            let [these, those] = [&by_rows, &by_svd].map(|set| a.mul_vec(set.point()));
            for (x, y) in these.iter().zip(&those) {
                assert!((x - y).abs() < 1e-9, "{these:?} {those:?}");
            }
            problem.assert_feasible(by_rows.point(), "free");
        }
        let goal: Vec<f64> = (0..problem.n).map(|_| random.signed()).collect();
        by_rows.approach(&goal, Precision::EXACT);
        by_svd.approach(&goal, Precision::EXACT);
        for (x, y) in by_rows.point().iter().zip(by_svd.point()) {
            assert!((x - y).abs() < 1e-8, "{:?} {:?}", by_rows.point(), by_svd.point());
        }
    }
    let counts = format!("{free} free, {beside_bounds} of them at bounds, {other} others");
    assert!(free > 300 && other > 3000 && beside_bounds > 100, "{counts}");
}
