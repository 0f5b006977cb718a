//! Combinations of symmetric matrices whose largest eigenvalue is least: the central path of a
//! semidefinite program.
//!
//! Formula  min lambda_max(sum w_r H_r + sum c_ij (a_i a_j^T + a_j a_i^T) / 2), w, c >= 0,
//!          sum w_r = 1; its dual: max t, <H_r, Z> >= t, a_i^T Z a_j >= 0, tr Z = 1, Z positive
//!          semidefinite. On the path w_r (<H_r, Z> - t) = c_ij a_i^T Z a_j = mu, the combination
//!          is lambda 1 - mu Z^-1, and lambda - t = (r + s + m) mu
//! Shapes   H_r: m x m, r of them; a_i: m entries, s pairs of them; m <= 6
//! Units    none (scaled)
//! Valid    if some motion has a positive product with all a_i; the relative error of weights is about
//!          1e-16 / mu
//! Why so   each point of the path is the only one for its mu: it turns with the matrices, and does
//!          not depend on their order
//! Source   Nesterov & Nemirovskii 1994; Vandenberghe & Boyd 1996
//! Checked  tests in this file

use crate::error::all_finite;
use crate::linalg::{Matrix, Qr, SymmetricEigen, dot, max_abs, norm, solve_upper};

/// The first mu, for forms of size one.
const FIRST: f64 = 0.25;
/// Ratio of mu at a point to that at the last.
const DECREASE: f64 = 0.25;
/// Newton steps to all points, at most: some dozens to a point where hundreds of pairs of walls are
/// nearly the same, usually less than ten.
const STEPS: usize = 600;
/// The length of a step in the metric of the barrier below which it is whole: the next one then has
/// about the square of it.
const WHOLE: f64 = 0.25;
/// The length of the last step to a point.
const LAST: f64 = 1e-6;
/// A step that rounding keeps from getting shorter is the last too, below this length.
const ROUNDED: f64 = 1e-2;
/// Share of the step to the end of the domain.
const INSIDE: f64 = 0.9;
/// Bisections of a longer step.
const BISECTIONS: usize = 40;

/// The way to the least largest eigenvalue.
pub(super) struct CentralPath<'a> {
    forms: &'a [Matrix],
    walls: &'a [Vec<f64>],
    mu: f64,
    /// L of Z = L L^T.
    factor: Matrix,
    /// t: no combination has a smaller largest eigenvalue.
    bound: f64,
    /// The last point was reached.
    reached: bool,
    /// Newton steps that are left.
    steps: usize,
}

/// A point of the path.
#[derive(Debug)]
pub(super) struct Centre {
    /// A weight for each form; they sum to 1.
    pub(super) weights: Vec<f64>,
    /// The combination, products of walls included.
    pub(super) combination: Matrix,
    /// By no more does its largest eigenvalue exceed the least one of all combinations.
    pub(super) gap: f64,
    /// False where the point was not reached: weights and gap are not those of the path.
    pub(super) reached: bool,
}

/// A constraint of the dual program in the metric of Z, relative to its slack.
struct Row {
    slack: f64,
    /// Its gradient with respect to L^-1 dZ L^-T, and to t.
    gradient: Vec<f64>,
}

impl<'a> CentralPath<'a> {
    /// From a motion inside of the walls.
    pub(super) fn new(forms: &'a [Matrix], walls: &'a [Vec<f64>], inside: &[f64]) -> Self {
        let m = inside.len();
        // Z = y y^T + s 1 with positive products of walls.
        let size = norm(inside);
        let share = walls.iter().enumerate().flat_map(|(i, a)| {
            walls[..i].iter().map(move |b| {
                let product = dot(a, inside) / size * (dot(b, inside) / size);
                if dot(a, b) < 0.0 { -0.5 * product / dot(a, b) } else { 1.0 }
            })
        });
        let root = share.fold(1.0, f64::min).sqrt();
        let along = if walls.is_empty() { 0.0 } else { (1.0 + root * root).sqrt() - root };
        let factor = with_unit_trace(Matrix::from_fn(m, m, |i, j| {
            along * inside[i] * inside[j] / (size * size) + if i == j { root } else { 0.0 }
        }));
        let least = forms.iter().map(|h| trace(&transformed(h, &factor))).fold(f64::MAX, f64::min);
        // About the slacks of the first point.
        let bound = least - FIRST * count(forms.len());
        Self { forms, walls, mu: FIRST / DECREASE, factor, bound, reached: false, steps: STEPS }
    }

    /// Z.
    pub(super) fn moments(&self) -> Matrix {
        &self.factor * &self.factor.transpose()
    }

    fn pairs(&self) -> usize {
        self.walls.len() * self.walls.len().saturating_sub(1) / 2
    }

    /// The next point.
    pub(super) fn step(&mut self) -> Centre {
        self.mu *= DECREASE;
        let mut last = f64::INFINITY;
        let mut along = std::mem::replace(&mut self.reached, false);
        while self.steps > 0 {
            self.steps -= 1;
            let Some(length) = self.newton(std::mem::take(&mut along)) else { break };
            if length < LAST || (length < ROUNDED && length > 0.5 * last) {
                self.reached = true;
                break;
            }
            last = length;
        }
        self.centre()
    }

    fn rows(&self) -> Vec<Row> {
        let m = self.factor.rows();
        let forms = self.forms.iter().map(|form| {
            let form = transformed(form, &self.factor);
            let slack = trace(&form) - self.bound;
            let mut gradient = packed(m, |i, j| form[(i, j)] / slack);
            gradient.push(-1.0 / slack);
            Row { slack, gradient }
        });
        let walls: Vec<Vec<f64>> = self.walls.iter().map(|a| transposed(&self.factor, a)).collect();
        let mut rows: Vec<Row> = forms.collect();
        for (i, a) in walls.iter().enumerate() {
            for b in &walls[..i] {
                let slack = dot(a, b);
                let product = |i, j| 0.5 * (a[i] * b[j] + a[j] * b[i]) / slack;
                let mut gradient = packed(m, product);
                gradient.push(0.0);
                rows.push(Row { slack, gradient });
            }
        }
        rows
    }

    /// One step towards the point with the present mu: its length, if it is finite. From the last point
    /// it leads along the path: its rate by mu is that by 1 / mu, which Newton's step follows, times
    /// the decrease of mu.
    fn newton(&mut self, along_path: bool) -> Option<f64> {
        let m = self.factor.rows();
        let edges = self.forms.len();
        let rows = self.rows();
        let square = &self.factor.transpose() * &self.factor;
        let normal = packed(m, |i, j| square[(i, j)]);
        let n = normal.len();
        // Maximise t / mu + log det Z + sum log slack: the Hessian is -A^T A, the gradient A^T y. The
        // trace is eliminated: all columns are then large where all rows are.
        let free = Qr::plain(Matrix::from_fn(n, 1, |i, _| normal[i])).complement();
        let slope: f64 = rows[..edges].iter().map(|row| -row.gradient[n]).sum();
        let share = (self.mu * slope).recip();
        let mut rest = packed(m, |i, j| if i == j { 1.0 } else { 0.0 });
        for (i, row) in rows.iter().enumerate() {
            let share = if i < edges { share } else { 1.0 };
            rest.iter_mut().zip(&row.gradient).for_each(|(y, x)| *y += share * x);
        }
        let along = dot(&rest, &normal) / dot(&normal, &normal);
        rest.iter_mut().zip(&normal).for_each(|(y, c)| *y -= along * c);
        // Large rows first: only then are the small ones exact (Cox & Higham 1998).
        let mut order: Vec<usize> = (0..rows.len()).collect();
        order.sort_by(|&i, &j| max_abs(&rows[j].gradient).total_cmp(&max_abs(&rows[i].gradient)));
        let a = Matrix::from_fn(rows.len() + n, n, |i, j| {
            let row = order.get(i).map(|i| &rows[*i].gradient);
            match (row, j + 1 == n) {
                (Some(row), true) => row[n],
                (Some(row), false) => dot(&row[..n], free.column(j)),
                (None, true) => 0.0,
                (None, false) => free[(i - rows.len(), j)],
            }
        });
        let mut y: Vec<f64> =
            order.iter().map(|i| if *i < edges { 1.0 - share } else { 0.0 }).collect();
        y.extend(rest);
        let qr = Qr::pivoted(a);
        qr.apply_transposed(&mut y);
        let length = norm(&y[..n]);
        let mut solution = vec![0.0; n];
        for (x, i) in solve_upper(&qr.r(), &y[..n]).iter().zip(qr.order()) {
            solution[*i] = *x;
        }
        if !all_finite(&solution) {
            return None;
        }
        let mut step = free.mul_vec(&solution[..n - 1]);
        step.push(solution[n - 1]);
        // Z becomes L (1 + scale X) L^T.
        let entry = |i: usize, j: usize| {
            let (i, j) = (i.min(j), i.max(j));
            let x = step[i * m - i * (i + 1) / 2 + j];
            if i == j { x } else { x / 2.0_f64.sqrt() }
        };
        let eigen = eigen(&Matrix::from_fn(m, m, entry));
        let scale = if length < WHOLE {
            1.0
        } else {
            let mut changes: Vec<f64> = rows.iter().map(|row| dot(&row.gradient, &step)).collect();
            changes.extend(&eigen.values[..m]);
            let largest = -changes.iter().copied().fold(-1.0, f64::min).recip();
            if along_path {
                f64::min(DECREASE, INSIDE * largest)
            } else {
                best_scale(step[n] / self.mu, &changes, largest)
            }
        };
        let root = Matrix::from_fn(m, m, |i, j| {
            eigen.vectors[j][i] * (1.0 + scale * eigen.values[j]).max(0.0).sqrt()
        });
        self.factor = with_unit_trace(&self.factor * &root);
        self.bound += scale * step[n];
        Some(length)
    }

    fn centre(&self) -> Centre {
        let m = self.factor.rows();
        let rows = self.rows();
        let edges = self.forms.len();
        // Rounding makes no weight negative.
        let share = |row: &Row| if row.slack > 0.0 { row.slack.recip() } else { 0.0 };
        let sum: f64 = rows[..edges].iter().map(share).sum();
        let weights: Vec<f64> = rows.iter().map(|row| share(row) / sum).collect();
        let mut combination = Matrix::zeros(m, m);
        let mut add = |weight: f64, entry: &dyn Fn(usize, usize) -> f64| {
            for j in 0..m {
                for i in 0..m {
                    combination[(i, j)] += weight * entry(i, j);
                }
            }
        };
        for (form, weight) in self.forms.iter().zip(&weights) {
            add(*weight, &|i, j| form[(i, j)]);
        }
        let mut products = weights[edges..].iter();
        for (i, a) in self.walls.iter().enumerate() {
            for (b, weight) in self.walls[..i].iter().zip(&mut products) {
                add(*weight, &|i, j| 0.5 * (a[i] * b[j] + a[j] * b[i]));
            }
        }
        let gap = count(edges + self.pairs() + m) * self.mu;
        Centre { weights: weights[..edges].to_vec(), combination, gap, reached: self.reached }
    }
}

fn count(n: usize) -> f64 {
    u32::try_from(n).map_or(f64::INFINITY, f64::from)
}

/// The share of a step, up to the largest in the domain, at which linear + sum log(1 + share change)
/// is largest.
fn best_scale(linear: f64, changes: &[f64], largest: f64) -> f64 {
    let (mut low, mut high) = (0.0, largest);
    for _ in 0..BISECTIONS {
        let middle = 0.5 * (low + high);
        let slope = changes.iter().map(|x| x / (1.0 + middle * x)).sum::<f64>() + linear;
        if slope > 0.0 {
            low = middle;
        } else {
            high = middle;
        }
    }
    low
}

/// Of a symmetric matrix, largest eigenvalue first.
pub(super) fn eigen(form: &Matrix) -> SymmetricEigen<6> {
    let m = form.rows();
    let entry = |i: usize, j: usize| if i < m && j < m { form[(i, j)] } else { 0.0 };
    SymmetricEigen::of(std::array::from_fn(|i| std::array::from_fn(|j| entry(i, j))), m)
}

fn trace(a: &Matrix) -> f64 {
    (0..a.rows()).map(|i| a[(i, i)]).sum()
}

/// L^T A L.
fn transformed(a: &Matrix, factor: &Matrix) -> Matrix {
    &(&factor.transpose() * a) * factor
}

/// L^T x.
fn transposed(factor: &Matrix, x: &[f64]) -> Vec<f64> {
    let mut y = vec![0.0; factor.cols()];
    factor.tr_mul_vec_into(x, &mut y);
    y
}

/// L with tr L L^T = 1.
fn with_unit_trace(factor: Matrix) -> Matrix {
    let size = factor.frobenius_norm();
    Matrix::from_fn(factor.rows(), factor.cols(), |i, j| factor[(i, j)] / size)
}

/// The upper triangle of a symmetric matrix, with the inner product of matrices.
fn packed(m: usize, entry: impl Fn(usize, usize) -> f64) -> Vec<f64> {
    let root = 2.0_f64.sqrt();
    let entry = &entry;
    let row = |i: usize| (i..m).map(move |j| if i == j { entry(i, j) } else { root * entry(i, j) });
    (0..m).flat_map(row).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scalar::uniform;

    struct Program {
        forms: Vec<Matrix>,
        walls: Vec<Vec<f64>>,
        inside: Vec<f64>,
    }

    fn random(seed: &mut u64, m: usize, edges: usize, walls: usize) -> Program {
        let mut next = || 2.0 * uniform(seed) - 1.0;
        let forms = (0..edges).map(|_| {
            let any = Matrix::from_fn(m, m, |_, _| next());
            Matrix::from_fn(m, m, |i, j| any[(i, j)] + any[(j, i)])
        });
        let forms = forms.collect();
        let inside: Vec<f64> = (0..m).map(|_| next()).collect();
        let wall = |_| {
            let any: Vec<f64> = (0..m).map(|_| next()).collect();
            let sign = dot(&any, &inside).signum();
            any.iter().map(|x| sign * x).collect()
        };
        let walls = (0..walls).map(wall).collect();
        Program { forms, walls, inside }
    }

    fn path(program: &Program) -> CentralPath<'_> {
        CentralPath::new(&program.forms, &program.walls, &program.inside)
    }

    /// Both programs are feasible, and their values differ by the gap: a proof that it is the optimum.
    #[test]
    fn both_values_meet() {
        let mut seed = 1994;
        for round in 0..60 {
            let m = 1 + round % 6;
            let program = random(&mut seed, m, 1 + round % 7, (round / 7) % 9);
            let mut path = path(&program);
            let mut last = f64::INFINITY;
            loop {
                let Centre { weights, combination, gap, reached } = path.step();
                assert!(reached, "{round} {gap}");
                let bound = path.bound;
                assert!(
                    (weights.iter().sum::<f64>() - 1.0).abs() < 1e-12
                        && weights.len() == 1 + round % 7
                );
                assert!(weights.iter().all(|w| *w > 0.0));
                let value = eigen(&combination).values[0];
                assert!(bound <= value + 1e-12, "{round}: {bound} {value}");
                assert!(value <= bound + gap + 1e-8, "{round}: {value} {bound} {gap}");
                // What is added to the forms is a combination of products of walls: their rates
                // along the moments are positive.
                let moments = path.moments();
                let product = |a: &Matrix| -> f64 {
                    (0..m).map(|j| dot(a.column(j), moments.column(j))).sum()
                };
                assert!((trace(&moments) - 1.0).abs() < 1e-12);
                assert!(program.forms.iter().all(|h| product(h) > bound - 1e-12));
                for (i, a) in program.walls.iter().enumerate() {
                    let rates = moments.mul_vec(a);
                    assert!(program.walls[..i].iter().all(|b| dot(&rates, b) > 0.0));
                }
                let mean = program.forms.iter().zip(&weights).map(|(h, w)| w * product(h));
                assert!(product(&combination) > mean.sum::<f64>() - 1e-12);
                assert!(gap < last);
                last = gap;
                if gap < 1e-6 {
                    break;
                }
            }
        }
    }

    /// w (-10, 1) + (1 - w) (1, -0.11) has its least largest entry where both are equal.
    #[test]
    fn two_forms() {
        let forms = [[-10.0, 1.0], [1.0, -0.11]].map(|d| Matrix::diagonal(&d));
        let mut path = CentralPath::new(&forms, &[], &[1.0, 0.0]);
        let mut centre = path.step();
        while centre.gap > 1e-9 {
            centre = path.step();
        }
        let expected = 1.11 / 12.11;
        assert!((centre.weights[0] - expected).abs() < 1e-8, "{centre:?}");
        assert!((path.bound - (1.0 - 11.0 * expected)).abs() < 1e-8, "{centre:?}");
    }

    /// Rotated and in another order, also from another motion inside: the same points.
    #[test]
    fn points_turn_with_the_matrices() {
        let mut seed = 7;
        for round in 0..40 {
            let m = 2 + round % 5;
            let program = random(&mut seed, m, 1 + round % 5, (round / 5) % 6);
            let turn = Qr::plain(Matrix::from_fn(m, m, |_, _| uniform(&mut seed) - 0.5)).basis();
            let turned = |h: &Matrix| transformed(h, &turn);
            let mut inside = transposed(&turn, &program.inside);
            let mut walls: Vec<Vec<f64>> =
                program.walls.iter().map(|a| transposed(&turn, a)).collect();
            for wall in &walls {
                let share = 0.1 * uniform(&mut seed);
                if walls.iter().all(|other| dot(other, wall) > 0.0) {
                    inside.iter_mut().zip(wall).for_each(|(y, a)| *y += share * a);
                }
            }
            walls.reverse();
            let other =
                Program { forms: program.forms.iter().rev().map(turned).collect(), walls, inside };
            let (mut here, mut there) = (path(&program), path(&other));
            for step in 0..11 {
                let (a, b) = (here.step(), there.step());
                let weights = a.weights.iter().zip(b.weights.iter().rev());
                let off = weights.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
                assert!(off < 1e-9, "{round} {step}: {off:e}");
                let off = turned(&a.combination).max_difference(&b.combination);
                assert!(off < 1e-8, "{round} {step}: {off:e}");
                assert!((here.bound - there.bound).abs() < 1e-10);
            }
        }
    }

    /// Hundreds of forms, in another basis and order.
    #[test]
    fn many_forms() {
        let mut seed = 11;
        let program = random(&mut seed, 5, 600, 0);
        let turn = Qr::plain(Matrix::from_fn(5, 5, |_, _| uniform(&mut seed) - 0.5)).basis();
        let turned = |h: &Matrix| transformed(h, &turn);
        let other = Program {
            forms: program.forms.iter().rev().map(turned).collect(),
            walls: Vec::new(),
            inside: (0..5).map(|_| uniform(&mut seed) - 0.5).collect(),
        };
        let (mut here, mut there) = (path(&program), path(&other));
        for step in 0..8 {
            let (a, b) = (here.step(), there.step());
            assert!(a.reached && b.reached, "{step}");
            let weights = a.weights.iter().zip(b.weights.iter().rev());
            let off = weights.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
            assert!(off < 1e-11, "{step}: {off:e}");
        }
    }

    /// Zero and equal forms, walls given twice, thin cones, walls of very different sizes: no number
    /// is a NaN, weights are shares, and a point that is reached has its gap.
    #[test]
    fn degenerate_programs() {
        let zero = Matrix::zeros(3, 3);
        let one = Matrix::identity(3);
        let mixed = Matrix::from_fn(3, 3, |i, j| {
            [[-1.0, 1.0, 0.0], [1.0, -1.0, 0.0], [0.0, 0.0, -1.0]][i][j]
        });
        let thin = |e: f64| vec![vec![e, 1.0, 0.0], vec![e, -1.0, 0.0]];
        let walls = [
            vec![],
            vec![vec![1.0, 0.0, 0.0]; 3],
            vec![vec![1e-6, 0.0, 0.0], vec![1.0, 1.0, 0.0], vec![1.0, -1.0, 1e3]],
            thin(1e-2),
            thin(1e-4),
            thin(1e-7),
            thin(1e-10),
        ];
        let x = [1.0, 0.0, 0.0];
        for (kind, walls) in walls.iter().enumerate() {
            for forms in [
                vec![zero.clone()],
                vec![one.clone(); 4],
                vec![zero.clone(), mixed.clone()],
                vec![mixed.clone()],
            ] {
                let mut path = CentralPath::new(&forms, walls, &x);
                for _ in 0..12 {
                    let Centre { weights, combination, gap, reached } = path.step();
                    assert!(weights.iter().all(|w| (0.0..=1.0).contains(w)), "{weights:?}");
                    assert!(combination.is_finite() && path.moments().is_finite());
                    let value = eigen(&combination).values[0];
                    let rounding = 1e-8 + 1e-14 * combination.frobenius_norm();
                    assert!(reached || kind > 4, "{walls:?} {forms:?}");
                    assert!(
                        !reached || value <= path.bound + gap + rounding,
                        "{walls:?} {forms:?} {value} {} {gap}",
                        path.bound
                    );
                    assert!(path.bound <= value + rounding, "{walls:?} {forms:?}");
                }
            }
        }
    }
}
