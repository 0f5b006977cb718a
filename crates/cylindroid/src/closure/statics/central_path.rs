//! Combinations of symmetric matrices whose largest eigenvalue is least: the central path of a
//! semidefinite program.
//!
//! Formula  min lambda_max(sum w_r H_r + sum c_ij (a_i a_j^T + a_j a_i^T) / 2), w, c >= 0,
//!          sum w_r = 1; its dual: max t, <H_r, Z> >= t, a_i^T Z a_j >= 0, tr Z = 1, Z positive
//!          semidefinite. On the path w_r (<H_r, Z> - t) = c_ij a_i^T Z a_j = mu, and the
//!          combination is lambda 1 - mu Z^-1 with lambda - t = (r + s + m) mu
//! Shapes   H_r: m x m, r of them; a_i: m entries, s pairs of them; m <= 6
//! Units    none (scaled)
//! Valid    if some motion has a positive product with all a_i; weights are rounded to the precision
//!          of numbers over mu
//! Why so   each point of the path is the only one for its mu: it turns with the matrices, and does
//!          not depend on their order. Newton's method in the metric of the barrier never leaves
//!          its domain with steps of length below one
//! Source   Nesterov & Nemirovskii 1994; Vandenberghe & Boyd 1996
//! Checked  tests in this file

use crate::error::all_finite;
use crate::linalg::{Matrix, Qr, SymmetricEigen, dot, norm, solve_upper};

/// Decrease of mu from a point to the next.
const DECREASE: f64 = 0.25;
/// Newton steps to a point, at most; steps of this length, and below, are whole, and the last.
const STEPS: usize = 100;
const WHOLE: f64 = 0.25;
const LAST: f64 = 1e-6;

/// The way to the least largest eigenvalue.
pub(super) struct CentralPath<'a> {
    forms: &'a [Matrix],
    walls: &'a [Vec<f64>],
    mu: f64,
    /// L of Z = L L^T.
    factor: Matrix,
    /// t: no combination has a smaller largest eigenvalue.
    bound: f64,
}

/// A point of the path.
#[derive(Debug)]
pub(super) struct Centre {
    /// A weight for each form; they sum to 1.
    pub(super) weights: Vec<f64>,
    /// The combination, products of walls included.
    pub(super) combination: Matrix,
    /// By no more does the largest eigenvalue exceed the least one of all combinations
    /// (lambda - t).
    pub(super) gap: f64,
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
        let along = (1.0 + root * root).sqrt() - root;
        let factor = Matrix::from_fn(m, m, |i, j| {
            along * inside[i] * inside[j] / (size * size) + if i == j { root } else { 0.0 }
        });
        let factor = with_unit_trace(factor);
        let least = forms.iter().map(|h| trace(&transformed(h, &factor))).fold(f64::MAX, f64::min);
        Self { forms, walls, mu: 1.0, factor, bound: least - 1.0 }
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
        for _ in 0..STEPS {
            let length = self.newton();
            // Rounding ends the decrease too.
            if !(length > LAST) || (length < 1e-2 && length > 0.5 * last) {
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

    /// One step towards the point with the present mu; its length before it is shortened.
    fn newton(&mut self) -> f64 {
        let m = self.factor.rows();
        let rows = self.rows();
        let square = &self.factor.transpose() * &self.factor;
        let normal = packed(m, |i, j| square[(i, j)]);
        let n = normal.len();
        // Maximise t / mu + log det Z + sum log slack: the Hessian is -A^T A, the gradient A^T y.
        // With tr dZ = 0 all columns are large where all rows are.
        let free = Qr::plain(Matrix::from_fn(n, 1, |i, _| normal[i])).complement();
        let a = Matrix::from_fn(rows.len() + n, n, |i, j| match (rows.get(i), j + 1 == n) {
            (Some(row), true) => row.gradient[n],
            (Some(row), false) => dot(&row.gradient[..n], free.column(j)),
            (None, true) => 0.0,
            (None, false) => free[(i - rows.len(), j)],
        });
        let edges = self.forms.len();
        let slope: f64 = rows[..edges].iter().map(|row| -row.gradient[n]).sum();
        let share = (self.mu * slope).recip();
        let mut y = vec![0.0; rows.len() + n];
        y[..edges].fill(1.0 - share);
        let rest = &mut y[rows.len()..];
        rest.copy_from_slice(&packed(m, |i, j| if i == j { 1.0 } else { 0.0 }));
        for (i, row) in rows.iter().enumerate() {
            let share = if i < edges { share } else { 1.0 };
            rest.iter_mut().zip(&row.gradient).for_each(|(y, x)| *y += share * x);
        }
        let along = dot(rest, &normal) / dot(&normal, &normal);
        rest.iter_mut().zip(&normal).for_each(|(y, c)| *y -= along * c);
        let qr = Qr::pivoted(a);
        qr.apply_transposed(&mut y);
        let length = norm(&y[..n]);
        let mut solution = vec![0.0; n];
        for (x, i) in solve_upper(&qr.r(), &y[..n]).iter().zip(qr.order()) {
            solution[*i] = *x;
        }
        if !all_finite(&solution) {
            return 0.0;
        }
        let step = free.mul_vec(&solution[..n - 1]);
        let scale = if length > WHOLE { (1.0 + length).recip() } else { 1.0 };
        // 1 + X = U diag U^T, so that L U diag^(1/2) is the new root.
        let entry = |i: usize, j: usize| {
            let (i, j) = (i.min(j), i.max(j));
            let x = if j < m { scale * step[i * m - i * (i + 1) / 2 + j] } else { 0.0 };
            if i == j { 1.0 + x } else { x / 2.0_f64.sqrt() }
        };
        let change = std::array::from_fn(|i| std::array::from_fn(|j| entry(i, j)));
        let eigen = SymmetricEigen::<6>::of(change, m);
        let root = Matrix::from_fn(m, m, |i, j| eigen.vectors[j][i] * eigen.values[j].sqrt());
        self.factor = with_unit_trace(&self.factor * &root);
        self.bound += scale * solution[n - 1];
        length
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
        let count = u32::try_from(edges + self.pairs() + m).map_or(f64::INFINITY, f64::from);
        Centre { weights: weights[..edges].to_vec(), combination, gap: count * self.mu }
    }
}

fn trace(a: &Matrix) -> f64 {
    (0..a.rows()).map(|i| a[(i, i)]).sum()
}

/// L^T A L.
fn transformed(a: &Matrix, factor: &Matrix) -> Matrix {
    &(&factor.transpose() * a) * factor
}

fn transposed(factor: &Matrix, x: &[f64]) -> Vec<f64> {
    (0..factor.cols()).map(|j| dot(factor.column(j), x)).collect()
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

    fn largest(form: &Matrix) -> f64 {
        let m = form.rows();
        let entry = |i: usize, j: usize| if i < m && j < m { form[(i, j)] } else { 0.0 };
        let entries = std::array::from_fn(|i| std::array::from_fn(|j| entry(i, j)));
        SymmetricEigen::<6>::of(entries, m).values[0]
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
                let Centre { weights, combination, gap } = path.step();
                let bound = path.bound;
                assert!(
                    (weights.iter().sum::<f64>() - 1.0).abs() < 1e-12
                        && weights.len() == 1 + round % 7
                );
                assert!(weights.iter().all(|w| *w > 0.0));
                let value = largest(&combination);
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
}
