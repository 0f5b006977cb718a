//! Hyperbolic projector coordinates on fixed-size arrays, without allocation: the arithmetic of
//! `inverse/hyperbolic_fixed.rs`.
//!
//! Checked  tests/it/hyperbolic.rs::independent_*, tests in this file

use super::projector::coordinates;
use super::span::{Scale, Span, angular, dot, join, linear};
use super::span_estimation::{ScrewOptions, six};
use crate::linalg::Matrix;
use crate::spatial::{Twist, Vec3};

/// Unit columns with less than this outside the span of those before them are looked at with
/// singular values [-].
const CLEAR_PIVOT: f64 = 1e-2;
/// Projectors larger than this are looked at with eigenvalues [-].
const CLEAR_SIZE: f64 = 1e3;

/// Writes J+h and says true; false where rank or existence are not clear at a glance, or an entry
/// is not finite. Judged at the centre of `scale`, or at the origin.
pub(crate) fn independent_coordinates(
    j: &Matrix,
    h: f64,
    scale: &ScrewOptions,
    out: &mut Matrix,
) -> bool {
    let m = j.cols();
    if m > 6 || scale.check().is_err() {
        return false;
    }
    let scale = Scale { center: scale.center.unwrap_or(Vec3::ZERO), length: scale.length };
    // R in the columns: x_j = sum_i r[j][i] b_i.
    let mut r = [[0.0; 6]; 6];
    let mut span = Span::ZERO;
    for (c, row) in r.iter_mut().enumerate().take(m) {
        let x = scale.apply(Twist::from_array(six(j.column(c))));
        let norm = dot(&x, &x).sqrt();
        let left = span.push(x.map(|a| a / norm));
        // NaN fails this too.
        if !(left > CLEAR_PIVOT) {
            return false;
        }
        for (entry, b) in row.iter_mut().zip(span.vectors()) {
            *entry = dot(b, &x);
        }
    }
    let Some(rows) = coordinates(&span, h / scale.length) else { return false };
    let size: f64 = rows.iter().take(m).map(|row| dot(row, row)).sum();
    if !(size < CLEAR_SIZE * CLEAR_SIZE) {
        return false;
    }
    // R y = rows, from below; then from scaled to given twists.
    let mut y = rows;
    for i in (0..m).rev() {
        for k in i + 1..m {
            let (factor, below) = (r[k][i], y[k]);
            y[i].iter_mut().zip(below).for_each(|(a, b)| *a -= factor * b);
        }
        y[i] = y[i].map(|a| a / r[i][i]);
    }
    for (i, y) in y.iter().enumerate().take(m) {
        let f = linear(y) * (1.0 / scale.length);
        let row = join(f, angular(y) + scale.center.cross(f));
        for (c, x) in row.into_iter().enumerate() {
            out[(i, c)] = x;
        }
    }
    true
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What is clear is answered here, and what is not, elsewhere.
    #[test]
    fn clear_cases_are_answered() {
        let at = |rows: [[f64; 6]; 3]| Matrix::from_fn(6, 3, |i, j| rows[j][i]);
        let scale = ScrewOptions::default();
        let mut out = Matrix::zeros(3, 6);
        let clear = at([
            [0.0, 0.0, 0.0, 0.0, 0.0, 1.0],
            [0.5, 0.0, 0.2, 0.0, 1.0, 0.0],
            [0.0, 1.0, 0.3, 0.6, 0.0, 0.8],
        ]);
        assert!(independent_coordinates(&clear, 0.3, &scale, &mut out));
        let close = (&out * &clear).max_difference(&Matrix::identity(3));
        assert!(close < 1e-14, "{close}");
        let dependent = at([
            [0.0, 0.0, 0.0, 0.0, 0.0, 1.0],
            [0.5, 0.0, 0.2, 0.0, 1.0, 0.0],
            [0.5, 0.0, 0.2, 0.0, 1.0, 1.0 + 1e-9],
        ]);
        assert!(!independent_coordinates(&dependent, 0.3, &scale, &mut out));
        let unknown = at([[f64::NAN; 6], [0.0; 6], [1.0; 6]]);
        assert!(!independent_coordinates(&unknown, 0.3, &scale, &mut out));
    }
}
