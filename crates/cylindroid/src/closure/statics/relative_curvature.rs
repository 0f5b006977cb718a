//! Relative curvature forms of a grasp: whether equilibrium forces block all free motions, or a
//! free motion opens all gaps.
//!
//! Formula  H_r = sum f_ri d_i'' on the free motions y, for each edge f_r of the equilibrium forces.
//!          Blocked if sum a_r H_r is negative definite for some a >= 0; y opens the gaps if
//!          y^T H_r y > 0 for all r
//! Shapes   H_r: m x m, m <= 6
//! Units    none (scaled)
//! Valid    motions in the cone W y >= 0, W of the contacts that press in no equilibrium: products of
//!          two of their rows are added to the forms with positive weights. Whether a combination
//!          with them is below -SECOND_ORDER is decided (`central_path.rs`); with more than four
//!          walls, or several forms, none may be although all motions are blocked. The motion that
//!          opens the gaps most is searched, and may be missed
//! Why so   for each motion forces of its own may suffice, but a common form is a proof
//! Source   Rimon & Burdick 1998, part II; Connelly & Whiteley 1996 (prestress stability);
//!          products of walls: Diananda 1962, Martin & Jacobson 1981 (copositive forms)
//! Checked  tests/it/closure/grasp_mobility/equilibria.rs, tests in this file

use super::central_path::{CentralPath, eigen};
use super::nearest_point::nearest_point;
use super::separating_direction::separating_direction;
use crate::linalg::{Matrix, SymmetricEigen, dot, norm};
use crate::scalar::uniform;
use crate::tolerance::{CANCELLED, EQUAL_CURVATURES, SECOND_ORDER};

/// The path ends this near to the least largest eigenvalue.
const GAP: f64 = 0.1 * SECOND_ORDER;
/// Rounding of an eigenvalue, relative to the combination: products of walls may be large.
const ROUNDING: f64 = 16.0 * f64::EPSILON;
/// Sums of principal motions that are tried, with all signs.
const TRIED: usize = 8;
/// The best motions, which are improved.
const IMPROVED: usize = 8;
/// Steps of an ascent, at most.
const STEPS: usize = 100;
/// Forms and walls this near to the least one take part in it.
const NEAR: f64 = 0.1;
/// Nearer ones by this factor after a failure.
const NEARER: f64 = 0.2;
/// The ascent ends with these.
const NEAREST: f64 = 1e-9;
/// The shortest step, relative to what is near: shorter ones lead nowhere.
const SHORTEST: f64 = 1e-3;
/// The least rise of a step, relative to that which the slope promises.
const RISE: f64 = 0.1;

/// The forms of a grasp on its free motions.
pub(super) struct RelativeCurvature {
    /// H_r for each edge of the equilibrium forces.
    pub(super) forms: Vec<Matrix>,
    /// Rates of the other gaps.
    pub(super) walls: Vec<Vec<f64>>,
    /// Number of free motions.
    pub(super) motions: usize,
}

/// A combination of the forms.
pub(super) struct Combination {
    /// A weight for each edge; they sum to 1. Equal ones, unless these do not block all motions
    /// without products of walls and those of a point of the central path do: the first such point.
    pub(super) weights: Vec<f64>,
    /// True if it blocks all motions within the walls.
    pub(super) blocks: bool,
    /// Second moments of motions along which no combination is negative in the mean: Z.
    open: Option<Matrix>,
}

impl RelativeCurvature {
    /// Eigenvalues, largest first, and eigenvectors of a combination of the forms.
    pub(super) fn eigen(&self, weights: &[f64]) -> SymmetricEigen<6> {
        eigen(&self.combined(weights))
    }

    fn combined(&self, weights: &[f64]) -> Matrix {
        let m = self.motions;
        let pairs = || self.forms.iter().zip(weights);
        Matrix::from_fn(m, m, |i, j| pairs().map(|(form, w)| w * form[(i, j)]).sum())
    }

    /// A motion inside of all walls; any one without walls.
    fn inside(&self) -> Option<Vec<f64>> {
        if self.walls.is_empty() {
            return Some((0..self.motions).map(|i| if i == 0 { 1.0 } else { 0.0 }).collect());
        }
        separating_direction(&self.walls)
    }

    /// The combination that blocks all motions, if there is one.
    pub(super) fn blocking(&self) -> Combination {
        let m = self.motions;
        let edges = self.forms.len();
        let even = vec![1.0 / f64::from(u32::try_from(edges).unwrap_or(u32::MAX)); edges];
        let blocks = self.eigen(&even).values[..m].first().is_none_or(|v| *v < -SECOND_ORDER);
        let mut combination = Combination { weights: even, blocks, open: None };
        if blocks || (edges == 1 && self.walls.len() < 2) {
            return combination;
        }
        let Some(inside) = self.inside() else { return combination };
        let mut path = CentralPath::new(&self.forms, &self.walls, &inside);
        loop {
            let centre = path.step();
            if !centre.reached {
                break;
            }
            let rounding = ROUNDING * centre.combination.frobenius_norm();
            if eigen(&centre.combination).values[0] < -SECOND_ORDER - rounding {
                combination.weights = centre.weights;
                combination.blocks = true;
                return combination;
            }
            if !(centre.gap > GAP) {
                break;
            }
        }
        combination.open = Some(path.moments());
        combination
    }

    /// The unit motion found along which the least of all forms and walls is largest, with that
    /// value: positive where it opens all gaps.
    pub(super) fn opening(&self, combination: &Combination) -> Option<(f64, Vec<f64>)> {
        let starts = self.starts(combination).into_iter().filter_map(unit);
        let mut tried: Vec<(f64, Vec<f64>)> = starts.map(|y| (self.least(&y), y)).collect();
        tried.sort_by(|a, b| b.0.total_cmp(&a.0));
        tried.truncate(IMPROVED);
        let improved = tried.into_iter().map(|(value, y)| self.improved(value, y));
        improved.max_by(|a, b| a.0.total_cmp(&b.0))
    }

    /// Motions to begin with, which turn with the forms: principal motions of the combination and of
    /// the open motions, and sums of these with all signs, since those of eigenvectors are arbitrary.
    fn starts(&self, combination: &Combination) -> Vec<Vec<f64>> {
        let m = self.motions;
        let own = self.principal(&self.combined(&combination.weights));
        let open = combination.open.as_ref().map(|open| self.principal(open));
        let inside = self.inside().filter(|_| !self.walls.is_empty());
        let mut starts: Vec<Vec<f64>> = inside.into_iter().collect();
        for (_, axis) in own.iter().chain(open.iter().flatten()) {
            starts.extend([1.0, -1.0].map(|sign| axis.iter().map(|x| sign * x).collect()));
        }
        let axes = open.as_ref().unwrap_or(&own);
        let size = |value: f64| if open.is_some() { value.max(0.0).sqrt() } else { 1.0 };
        let mut seed = 0;
        for round in 0..TRIED {
            let scaled = round % 2 == 0;
            let share = |axis: &(f64, Vec<f64>)| {
                uniform(&mut seed) * if scaled { size(axis.0) } else { 1.0 }
            };
            let shares: Vec<f64> = axes.iter().map(share).collect();
            for signs in 0..1_usize << m {
                let share = |k: usize| if (signs >> k) & 1 == 0 { shares[k] } else { -shares[k] };
                let entry = |i: usize| (0..m).map(|k| share(k) * axes[k].1[i]).sum();
                starts.push((0..m).map(entry).collect());
            }
        }
        starts
    }

    /// Eigenvalues and eigenvectors of a form; of those with equal eigenvalues the principal motions
    /// of the sum of the squares of all forms, as these turn with the grasp.
    fn principal(&self, form: &Matrix) -> Vec<(f64, Vec<f64>)> {
        let m = self.motions;
        let found = eigen(form);
        let mut axes = Vec::new();
        while axes.len() < m {
            let from = axes.len();
            let equal = |value: &&f64| (found.values[from] - **value).abs() <= EQUAL_CURVATURES;
            let to = from + found.values[from..m].iter().take_while(equal).count().max(1);
            let own = Matrix::from_fn(m, to - from, |i, k| found.vectors[from + k][i]);
            let products: Vec<Matrix> = self.forms.iter().map(|form| form * &own).collect();
            let all = Matrix::vstack(to - from, &products.iter().collect::<Vec<_>>());
            let sum = &all.transpose() * &all;
            let turn = eigen(&sum);
            axes.extend(
                (from..to)
                    .map(|k| (found.values[k], own.mul_vec(&turn.vectors[k - from][..to - from]))),
            );
        }
        axes
    }

    /// The motion at the end of an ascent of the least of all forms and walls, with its value.
    fn improved(&self, mut value: f64, mut y: Vec<f64>) -> (f64, Vec<f64>) {
        let mut near = NEAR;
        let mut last = 0.5;
        for _ in 0..STEPS {
            let found = self.ascent(&y, value + near).and_then(|(slope, along)| {
                let lengths =
                    std::iter::successors(Some(f64::min(2.0 * last, 1.0)), |s| Some(0.5 * s));
                lengths.take_while(|length| *length > SHORTEST * near).find_map(|length| {
                    let moved = y.iter().zip(&along).map(|(y, a)| y + length * a).collect();
                    let moved = unit(moved)?;
                    let reached = self.least(&moved);
                    (reached > value + RISE * length * slope).then_some((length, reached, moved))
                })
            });
            if let Some(found) = found {
                (last, value, y) = found;
            } else {
                near *= NEARER;
                last = near;
                if near < NEAREST {
                    break;
                }
            }
        }
        (value, y)
    }

    /// The unit direction along which the forms and walls up to a level rise most steeply, with the
    /// least of their slopes: the nearest point of the hull of their gradients on the sphere.
    fn ascent(&self, y: &[f64], level: f64) -> Option<(f64, [f64; 6])> {
        let mut gradients: Vec<[f64; 6]> = Vec::new();
        let mut add = |value: f64, gradient: &[f64]| {
            if value <= level {
                let along = dot(gradient, y);
                let mut tangent = [0.0; 6];
                tangent.iter_mut().zip(gradient).zip(y).for_each(|((t, g), y)| *t = g - along * y);
                gradients.push(tangent);
            }
        };
        for form in &self.forms {
            let product = form.mul_vec(y);
            add(dot(&product, y), &product.iter().map(|x| 2.0 * x).collect::<Vec<f64>>());
        }
        self.walls.iter().for_each(|wall| add(dot(wall, y), wall));
        let size = gradients.iter().map(|gradient| norm(gradient)).fold(0.0, f64::max);
        let found = nearest_point(y.len(), size, |n| {
            let farthest = gradients.iter().max_by(|a, b| dot(*a, n).total_cmp(&dot(*b, n)));
            farthest.copied().unwrap_or_default()
        });
        (found.lower > 0.0).then(|| (found.lower, found.away.map(|x| -x)))
    }

    /// Smallest of all forms and walls at a unit motion.
    fn least(&self, y: &[f64]) -> f64 {
        let forms = self.forms.iter().map(|form| dot(&form.mul_vec(y), y));
        forms.chain(self.walls.iter().map(|wall| dot(wall, y))).fold(f64::INFINITY, f64::min)
    }
}

fn unit(y: Vec<f64>) -> Option<Vec<f64>> {
    let size = norm(&y);
    (size > CANCELLED).then(|| y.iter().map(|y| y / size).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn found(forms: &[[[f64; 2]; 2]], walls: &[[f64; 2]]) -> (bool, bool) {
        let of = |rows: &[[f64; 2]]| Matrix::from_fn(rows.len(), 2, |i, j| rows[i][j]);
        let forms = forms.iter().map(|form| of(form)).collect();
        let walls = walls.iter().map(|wall| wall.to_vec()).collect();
        let curvature = RelativeCurvature { forms, walls, motions: 2 };
        let combination = curvature.blocking();
        assert!((combination.weights.iter().sum::<f64>() - 1.0).abs() < 1e-12);
        let opening = curvature.opening(&combination);
        let opens = opening.is_some_and(|(value, y)| {
            assert_eq!(curvature.least(&y), value);
            value > SECOND_ORDER
        });
        (combination.blocks, opens)
    }

    #[test]
    fn forms_are_combined() {
        let diagonal = |a: f64, b: f64| [[a, 0.0], [0.0, b]];
        assert_eq!(found(&[diagonal(-1.0, -0.1)], &[]), (true, false));
        assert_eq!(found(&[diagonal(-1.0, 0.1)], &[]), (false, true));
        assert_eq!(found(&[diagonal(-1.0, 0.0)], &[]), (false, false));
        // Weights between 0.1 / 1.1 and 1 / 10, which halves miss.
        let (one, other) = (diagonal(-10.0, 1.0), diagonal(1.0, -0.11));
        assert_eq!(found(&[one, other], &[]), (true, false));
        assert_eq!(found(&[one, diagonal(1.0, -0.09)], &[]), (false, true));
        // Three forms, of which any two open along some motion.
        let turned = |degrees: f64| {
            let (s, c) = f64::to_radians(2.0 * degrees).sin_cos();
            [[0.9 * c - 0.5, 0.9 * s], [0.9 * s, -0.9 * c - 0.5]]
        };
        let three = [turned(0.0), turned(60.0), turned(120.0)];
        assert_eq!(found(&three, &[]), (true, false));
        assert_eq!(found(&three[..2], &[]), (true, false));
    }

    /// Forms whose mean is a multiple of one, in other bases and another order: the same motion opens
    /// them most, and verdicts agree.
    #[test]
    fn openings_turn_with_the_forms() {
        let (mut seed, mut open) = (3, 0);
        for round in 0..30 {
            let (m, edges) = (3 + round % 3, 6 + round % 5);
            let mut next = || 2.0 * uniform(&mut seed) - 1.0;
            let any: Vec<Matrix> =
                (0..edges).map(|_| Matrix::from_fn(m, m, |_, _| 0.3 * next())).collect();
            let mean = |i: usize, j: usize| {
                let sum: f64 = any.iter().map(|a| a[(i, j)] + a[(j, i)]).sum();
                sum / f64::from(u32::try_from(edges).unwrap())
            };
            let shift = 0.2 * next();
            let forms: Vec<Matrix> = any
                .iter()
                .map(|a| {
                    let one = |i, j| if i == j { shift } else { 0.0 };
                    Matrix::from_fn(m, m, |i, j| a[(i, j)] + a[(j, i)] - mean(i, j) + one(i, j))
                })
                .collect();
            let mut values = Vec::new();
            for basis in 0..3 {
                let turn = crate::linalg::Qr::plain(Matrix::from_fn(m, m, |_, _| next())).basis();
                let mut forms: Vec<Matrix> =
                    forms.iter().map(|h| &(&turn.transpose() * h) * &turn).collect();
                forms.rotate_left(basis);
                let curvature = RelativeCurvature { forms, walls: Vec::new(), motions: m };
                let combination = curvature.blocking();
                let opening = curvature.opening(&combination).unwrap().0;
                values.push(if combination.blocks { f64::NEG_INFINITY } else { opening });
            }
            open += usize::from(values[0] > SECOND_ORDER);
            if values.iter().all(|value| *value == f64::NEG_INFINITY) {
                continue;
            }
            let off = values.iter().map(|v| (v - values[0]).abs()).fold(0.0, f64::max);
            assert!(off < 1e-7, "{round}: {values:?}");
        }
        assert!(open > 5, "{open}");
    }

    /// x y is negative outside of the walls and positive within, or the other way round.
    #[test]
    fn walls_count() {
        let product = |s: f64| [[-0.1, s], [s, -0.1]];
        let corner = [[1.0, 0.0], [0.0, 1.0]];
        assert_eq!(found(&[product(1.0)], &corner), (false, true));
        assert_eq!(found(&[product(-1.0)], &corner), (true, false));
        assert_eq!(found(&[product(-1.0)], &corner[..1]), (false, true));
    }
}
