//! Relative curvature forms of a grasp: whether equilibrium forces block all free motions, or a
//! free motion opens all gaps.
//!
//! Formula  H_r = sum f_ri d_i'' on the free motions y, for each edge f_r of the equilibrium forces.
//!          Blocked if sum a_r H_r is negative definite for some a >= 0; y opens the gaps if
//!          y^T H_r y > 0 for all r
//! Shapes   H_r: m x m, m <= 6
//! Units    none (scaled)
//! Valid    motions in the cone W y >= 0, W of the contacts that press in no equilibrium: products of
//!          two of their rows are added to the forms with positive weights. Whether one form, or two
//!          without walls, block all motions is decided exactly; for more, forces that do are
//!          searched, and so is the motion that opens the gaps most: both may be missed
//! Why so   for each motion forces of its own may suffice, but a common form is a proof
//! Source   Rimon & Burdick 1998, part II; Connelly & Whiteley 1996 (prestress stability)
//! Checked  tests/it/closure/grasp_mobility/mod.rs

use super::separating_direction::separating_direction;
use crate::linalg::{Matrix, SymmetricEigen, dot, norm};
use crate::scalar::uniform;
use crate::tolerance::{CANCELLED, SECOND_ORDER};

/// Steps of the search for weights, of the search for two, and random motions tried.
/// No form leaves the combination for good: its weight may grow again.
const LEAST_WEIGHT: f64 = 1e-30;
const STEPS: u32 = 500;
const HALVINGS: usize = 80;
const TRIED: usize = 200;

/// The forms of a grasp on its free motions.
pub(super) struct RelativeCurvature {
    /// H_r for each edge of the equilibrium forces.
    pub(super) forms: Vec<Matrix>,
    /// Rates of the other gaps.
    pub(super) walls: Matrix,
}

/// A combination of the forms.
pub(super) struct Combination {
    /// A weight for each edge; they sum to 1.
    pub(super) weights: Vec<f64>,
    /// Largest eigenvalue, with the products of the walls.
    pub(super) largest: f64,
}

impl RelativeCurvature {
    fn motions(&self) -> usize {
        self.walls.cols()
    }

    /// Eigenvalues, largest first, and eigenvectors of a combination of the forms.
    pub(super) fn eigen(&self, weights: &[f64]) -> SymmetricEigen<6> {
        eigen(&self.forms, weights, self.motions())
    }

    /// The combination with the least largest eigenvalue found; the first negative one is enough.
    pub(super) fn blocking(&self) -> Combination {
        let m = self.motions();
        let mut all = self.forms.clone();
        for i in 0..self.walls.rows() {
            for j in 0..i {
                all.push(Matrix::from_fn(m, m, |a, b| {
                    let product = |a, b| self.walls[(i, a)] * self.walls[(j, b)];
                    0.5 * (product(a, b) + product(b, a))
                }));
            }
        }
        let edges = self.forms.len();
        // Weights of the edges sum to one; those of the products of walls come on top.
        let at = |weights: &[f64]| -> Combination {
            let sum: f64 = weights[..edges].iter().sum();
            let scaled: Vec<f64> = weights.iter().map(|w| w / sum).collect();
            let largest = eigen(&all, &scaled, m).values[0];
            Combination { weights: scaled[..edges].to_vec(), largest }
        };
        let even = |count: usize| {
            let share = 1.0 / f64::from(u32::try_from(count).unwrap_or(u32::MAX));
            (0..all.len()).map(|i| if i < count { share } else { 0.0 }).collect::<Vec<f64>>()
        };
        let mut best = at(&even(edges));
        let keep = |found: Combination, best: &mut Combination| {
            if found.largest < best.largest {
                *best = found;
            }
            best.largest < -SECOND_ORDER
        };
        if best.largest < -SECOND_ORDER || all.len() == 1 {
            return best;
        }
        if all.len() == 2 && edges == 2 {
            // The largest eigenvalue is convex in the weight.
            let (mut low, mut high) = (0.0, 1.0);
            for _ in 0..HALVINGS {
                let third = (high - low) / 3.0;
                let at = |w: f64| at(&[w, 1.0 - w]);
                let (left, right) = (at(low + third), at(high - third));
                if left.largest < right.largest {
                    high -= third;
                } else {
                    low += third;
                }
                if keep(left, &mut best) || keep(right, &mut best) {
                    break;
                }
            }
            return best;
        }
        let mut weights = even(all.len());
        for step in 1..=STEPS {
            let worst = eigen(&all, &weights, m).vectors[0];
            let values: Vec<f64> =
                all.iter().map(|form| dot(&form.mul_vec(&worst[..m]), &worst[..m])).collect();
            let size = norm(&values);
            if !(size > 0.0) {
                break;
            }
            let rate = 1.0 / f64::from(step).sqrt();
            let steps = weights.iter_mut().zip(&values);
            steps.for_each(|(w, value)| *w = (*w * (-rate * value / size).exp()).max(LEAST_WEIGHT));
            let sum: f64 = weights.iter().sum();
            weights.iter_mut().for_each(|w| *w /= sum);
            if keep(at(&weights), &mut best) {
                break;
            }
        }
        best
    }

    /// The unit motion found along which the least of all forms and walls is largest, with that
    /// value: positive where it opens all gaps.
    pub(super) fn opening(&self, combination: &Combination) -> Option<(f64, Vec<f64>)> {
        let m = self.motions();
        let edges = self.forms.len();
        let one = |r: usize| (0..edges).map(|i| if i == r { 1.0 } else { 0.0 }).collect();
        let mut starts: Vec<Vec<f64>> = Vec::new();
        for weights in (0..edges).map(one).chain([combination.weights.clone()]) {
            let found = self.eigen(&weights);
            for vector in &found.vectors[..m] {
                starts.push(vector[..m].to_vec());
                starts.push(vector[..m].iter().map(|x| -x).collect());
            }
        }
        let walls: Vec<Vec<f64>> = self.walls.to_rows();
        starts.extend(separating_direction(&walls));
        let count = starts.len();
        for i in 0..count {
            for j in 0..i {
                starts.push(starts[i].iter().zip(&starts[j]).map(|(a, b)| a + b).collect());
            }
        }
        let mut seed = 0;
        let mut random = || 2.0 * uniform(&mut seed) - 1.0;
        starts.extend((0..TRIED).map(|_| (0..m).map(|_| random()).collect()));
        let mut best: Option<(f64, Vec<f64>)> = None;
        let improve = |y: Vec<f64>, best: &mut Option<(f64, Vec<f64>)>| {
            let size = norm(&y);
            if size > CANCELLED {
                let y: Vec<f64> = y.iter().map(|y| y / size).collect();
                let value = self.least(&y);
                if best.as_ref().is_none_or(|b| value > b.0) {
                    *best = Some((value, y));
                    return true;
                }
            }
            false
        };
        for start in starts {
            improve(start, &mut best);
        }
        // Steps of a random search, smaller after each failure.
        let mut step = 0.3;
        for _ in 0..TRIED {
            let Some((_, y)) = &best else { break };
            let next = y.iter().map(|y| y + step * random()).collect();
            step *= if improve(next, &mut best) { 1.5 } else { 0.93 };
        }
        best
    }

    /// Smallest of all forms and walls at a unit motion.
    fn least(&self, y: &[f64]) -> f64 {
        let forms = self.forms.iter().map(|form| dot(&form.mul_vec(y), y));
        forms.chain(self.walls.mul_vec(y)).fold(f64::INFINITY, f64::min)
    }
}

fn eigen(forms: &[Matrix], weights: &[f64], m: usize) -> SymmetricEigen<6> {
    let entry = |i: usize, j: usize| -> f64 {
        if i >= m || j >= m {
            return 0.0;
        }
        forms.iter().zip(weights).map(|(form, w)| w * form[(i, j)]).sum()
    };
    SymmetricEigen::of(std::array::from_fn(|i| std::array::from_fn(|j| entry(i, j))), m)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn found(forms: &[[[f64; 2]; 2]], walls: &[[f64; 2]]) -> (bool, bool) {
        let of = |rows: &[[f64; 2]]| Matrix::from_fn(rows.len(), 2, |i, j| rows[i][j]);
        let forms = forms.iter().map(|form| of(form)).collect();
        let curvature = RelativeCurvature { forms, walls: of(walls) };
        let combination = curvature.blocking();
        assert!((combination.weights.iter().sum::<f64>() - 1.0).abs() < 1e-12);
        let opening = curvature.opening(&combination);
        let opens = opening.is_some_and(|(value, y)| {
            assert_eq!(curvature.least(&y), value);
            value > SECOND_ORDER
        });
        (combination.largest < -SECOND_ORDER, opens)
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
