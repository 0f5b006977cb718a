//! Second-order rigidity: whether a first-order motion extends to second order, and whether
//! self-stress stabilises the configuration.
//!
//! Formula  second-order part of the reduced equation (`lyapunov_schmidt.rs`): g_w(x) = x^T H_w x
//!          for each self-stress w (R = coker C), from central differences of g at two distances,
//!          extrapolated. A motion x extends to second order if x^T H_w x = 0 for all w. Prestress
//!          stable: H_w is positive definite for some w; then no motion extends, and the second
//!          order proves that the configuration is rigid
//! Shapes   x: k, H_w: k x k
//! Units    none (scaled)
//! Valid    closed configurations. The definite H_w is searched as the point nearest to the origin
//!          of the convex hull of (x^T H_w x)_w, |x| = 1, by Gilbert's algorithm: a definite form is
//!          a proof (if it exists, it is found unless it is nearly singular). A motion that extends
//!          is searched from many starts: one found is a proof (to 1e-6), none found is not.
//!          Contacts are points of the second link on planes of the first and hold from both sides;
//!          `statics/grasp_mobility.rs` decides immobilisation by fingers that only push, with the
//!          curvature of both bodies
//! Why so   the definite form is a semidefinite program, for which the few self-stresses of a
//!          linkage need no solver
//! Source   Connelly & Whiteley 1996 (prestress stability implies second-order rigidity, and this
//!          rigidity); Gilbert 1966
//! Checked  tests/it/linkages/second_order.rs

use std::fmt;

use super::lyapunov_schmidt::LyapunovSchmidt;
use crate::error::Result;
use crate::inverse::damp;
use crate::linalg::{ColumnSpace, Matrix, Svd, Threshold, dot, norm};
use crate::scalar::clamp;
use crate::tolerance::SECOND_ORDER;

/// Distance of the differences [rad, or characteristic lengths].
const STEP: f64 = 1.0 / 128.0;
/// Maximum number of steps of Gilbert's algorithm, and of a search for a motion.
const MAX_STEPS: (usize, usize) = (2000, 60);
/// Number of starts of the search for a motion.
const STARTS: u64 = 32;
/// Smallest eigenvalue of a form of norm one that counts as definite [-].
const DEFINITE: f64 = 1e-4;

/// The rigidity of a configuration to second order.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum SecondOrderRigidity {
    /// Some self-stress stabilises every first-order motion: rigid, proved.
    PrestressStable,
    /// No first-order motion that extends to second order was found, and no self-stress that
    /// stabilises all of them: rigid if the search missed none.
    Rigid,
    /// A first-order motion extends to second order: higher orders decide.
    Flexible,
}

impl SecondOrderRigidity {
    /// Its name in reports.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::PrestressStable => "prestress stable",
            Self::Rigid => "second-order rigid",
            Self::Flexible => "second-order flexible",
        }
    }
}

impl fmt::Display for SecondOrderRigidity {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.name())
    }
}

/// The second order of the loop-closure equations at a configuration.
///
/// ```text
/// x extends to second order  <=>  x^T H_w x = 0 for every self-stress w
/// ```
///
/// Source: Connelly & Whiteley 1996.
#[derive(Debug, Clone, PartialEq)]
pub struct SecondOrder {
    /// The verdict.
    pub rigidity: SecondOrderRigidity,
    /// Number of linearly independent forms H_w.
    pub forms: usize,
    /// A first-order motion that extends to second order, as a column of rates of the coordinates
    /// of q; without columns if none was found.
    pub motion: Matrix,
}

impl SecondOrder {
    /// At the configuration of `reduction`; none if its steps do not converge, or if there is no
    /// first-order motion.
    pub(crate) fn of(reduction: &LyapunovSchmidt<'_>) -> Result<Option<Self>> {
        let k = reduction.motions();
        if k == 0 {
            return Ok(None);
        }
        let Some(forms) = forms(reduction)? else { return Ok(None) };
        let of = |rigidity, motion: Option<Vec<f64>>| {
            let x = motion.unwrap_or_default();
            let column = Matrix::from_fn(k, usize::from(!x.is_empty()), |i, _| x[i]);
            let motion = reduction.unscaled(&(reduction.kernel() * &column));
            Ok(Some(Self { rigidity, forms: forms.len(), motion }))
        };
        if let Some(x) = extension(reduction, &forms) {
            return of(SecondOrderRigidity::Flexible, Some(x));
        }
        if is_stabilised(&forms, reduction.direction(0)) {
            return of(SecondOrderRigidity::PrestressStable, None);
        }
        of(SecondOrderRigidity::Rigid, None)
    }
}

/// A basis of the forms H_w, orthonormal in the Frobenius product.
fn forms(reduction: &LyapunovSchmidt<'_>) -> Result<Option<Vec<Matrix>>> {
    let (k, s) = (reduction.motions(), reduction.dependent());
    let even = |x: &[f64], h: f64| -> Result<Option<Vec<f64>>> {
        let mut sum = vec![0.0; s];
        for side in [h, -h] {
            let along: Vec<f64> = x.iter().map(|x| side * x).collect();
            let Some(near) = reduction.step(&along)? else { return Ok(None) };
            sum.iter_mut().zip(&near.residual).for_each(|(sum, g)| *sum += g / (h * h));
        }
        Ok(Some(sum))
    };
    // x^T H x for each equation, without the fourth-order terms.
    let at = |x: &[f64]| -> Result<Option<Vec<f64>>> {
        let (Some(far), Some(near)) = (even(x, STEP)?, even(x, 0.5 * STEP)?) else {
            return Ok(None);
        };
        Ok(Some(near.iter().zip(&far).map(|(near, far)| (4.0 * near - far) / 3.0).collect()))
    };
    let unit = |entries: [usize; 2]| -> Vec<f64> {
        (0..k).map(|i| if entries.contains(&i) { 1.0 } else { 0.0 }).collect()
    };
    let mut diagonal = Vec::new();
    for i in 0..k {
        let Some(values) = at(&unit([i, i]))? else { return Ok(None) };
        diagonal.push(values);
    }
    // A row for each entry on and below the diagonal: products of columns are those of forms.
    let root = std::f64::consts::SQRT_2;
    let places: Vec<(usize, usize)> = (0..k).flat_map(|i| (0..=i).map(move |j| (i, j))).collect();
    let mut entries = Matrix::zeros(places.len(), s);
    for (row, &(i, j)) in places.iter().enumerate() {
        let values = if i == j {
            diagonal[i].clone()
        } else {
            let Some(sum) = at(&unit([i, j]))? else { return Ok(None) };
            let off = |w: usize| 0.5 * (sum[w] - diagonal[i][w] - diagonal[j][w]);
            (0..s).map(|w| root * off(w)).collect()
        };
        (0..s).for_each(|w| entries[(row, w)] = values[w]);
    }
    let rounding = 16.0 * reduction.tolerance() / (STEP * STEP);
    let space = ColumnSpace::of(&entries, Threshold::Absolute(SECOND_ORDER.max(rounding)));
    let basis = space.basis();
    let form = |w: usize| {
        let mut form = Matrix::zeros(k, k);
        for (row, &(i, j)) in places.iter().enumerate() {
            let entry = basis[(row, w)] / if i == j { 1.0 } else { root };
            (form[(i, j)], form[(j, i)]) = (entry, entry);
        }
        form
    };
    Ok(Some((0..basis.cols()).map(form).collect()))
}

/// x^T H x for all forms.
fn values(forms: &[Matrix], x: &[f64]) -> Vec<f64> {
    forms.iter().map(|form| dot(&form.mul_vec(x), x)).collect()
}

/// A unit vector on which all forms vanish, by damped Gauss-Newton on the sphere.
fn extension(reduction: &LyapunovSchmidt<'_>, forms: &[Matrix]) -> Option<Vec<f64>> {
    let k = reduction.motions();
    if forms.is_empty() {
        return Some(reduction.direction(0));
    }
    // One motion, or all forms: they do not vanish together.
    if k == 1 || forms.len() == k * (k + 1) / 2 {
        return None;
    }
    for start in 0..STARTS {
        let mut x = reduction.direction(start);
        let mut now = values(forms, &x);
        let mut damping = 1e-3;
        for _ in 0..MAX_STEPS.1 {
            if norm(&now) <= 1e-3 * SECOND_ORDER || damping > 1e6 {
                break;
            }
            let products: Vec<Vec<f64>> = forms.iter().map(|form| form.mul_vec(&x)).collect();
            let rates =
                Matrix::from_fn(forms.len(), k, |w, j| 2.0 * (products[w][j] - now[w] * x[j]));
            let svd = Svd::of(&rates);
            if !(svd.value(0) > 0.0) {
                break;
            }
            let l = damping * svd.value(0);
            let step = svd.apply_gains(&now, |_, s| damp(s, l));
            let next: Vec<f64> = x.iter().zip(&step).map(|(x, d)| x - d).collect();
            let size = norm(&next);
            let next: Vec<f64> = next.iter().map(|x| x / size).collect();
            let there = values(forms, &next);
            if norm(&there) < norm(&now) {
                (x, now) = (next, there);
                damping *= 0.1;
            } else {
                damping = 10.0 * damping.max(1e-6);
            }
        }
        if norm(&now) <= SECOND_ORDER {
            return Some(x);
        }
    }
    None
}

/// True if a combination of the forms is positive definite: the point p of the convex hull of the
/// values nearest to the origin, if it is not the origin, has p . values(x) >= |p|^2 for all x.
fn is_stabilised(forms: &[Matrix], start: Vec<f64>) -> bool {
    let k = start.len();
    let mut p = values(forms, &start);
    for _ in 0..MAX_STEPS.0 {
        let size = norm(&p);
        if size < DEFINITE {
            return false;
        }
        // The shift makes the smallest eigenvalue the smallest singular value.
        let combined = Matrix::from_fn(k, k, |i, j| {
            let entry: f64 = forms.iter().zip(&p).map(|(form, p)| p / size * form[(i, j)]).sum();
            if i == j { entry + 2.0 } else { entry }
        });
        let svd = Svd::of(&combined);
        if svd.value(k - 1) - 2.0 > DEFINITE {
            return true;
        }
        let lowest = values(forms, svd.u(k - 1));
        let towards: Vec<f64> = lowest.iter().zip(&p).map(|(l, p)| l - p).collect();
        let length = dot(&towards, &towards);
        if !(length > 0.0) {
            return false;
        }
        let share = clamp(-dot(&p, &towards) / length, 0.0, 1.0);
        p.iter_mut().zip(&towards).for_each(|(p, t)| *p += share * t);
    }
    false
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn definite_combinations_are_found() {
        let form = |a: f64, b: f64, c: f64| Matrix::from_rows(&[[a, b], [b, c]]).unwrap();
        let start = || vec![0.6, 0.8];
        // Hyperbolas that cross nowhere: rigid to second order, without a stabilising stress.
        let (one, other) = (form(1.0, 0.0, -1.0), form(0.0, 1.0, 0.0));
        assert!(!is_stabilised(&[one.clone(), other.clone()], start()));
        assert!(!is_stabilised(std::slice::from_ref(&one), start()));
        // With x^2, one of them is definite in combination.
        assert!(is_stabilised(&[one.clone(), form(1.0, 0.0, 0.0)], start()));
        assert!(is_stabilised(&[one, other, form(1.0, 0.0, 1.0)], start()));
        assert!(is_stabilised(&[form(-1.0, 0.3, -2.0)], start()));
        // Semidefinite: not stabilised.
        assert!(!is_stabilised(&[form(1.0, 0.0, 0.0)], start()));
    }
}
