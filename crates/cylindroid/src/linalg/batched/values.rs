//! Singular values by one-sided Jacobi rotations, batched.
//!
//! Formula  pairs of columns are rotated until all are orthogonal; their norms are the values
//! Shapes   A: rows x columns, of any proportion; a value for each column, in no order
//! Valid    any rank: values have an error of one rounding of the largest, or of their own where
//!          columns differ in scale alone
//! Why so   as in jacobi.rs. A lane whose columns are orthogonal is not rotated further, whatever
//!          the others still need
//! Checked  tests::agrees_with_single

use super::dot;
use crate::scalar::SimdFloat;
use crate::tolerance::JACOBI_ORTHOGONAL;

/// Sweeps at most: six are usual.
const SWEEPS: usize = 30;

/// Columns whose cosines are below the root of this before a sweep are orthogonal to rounding
/// after it.
const NEARLY: f64 = 0.25 * f64::EPSILON;

/// The singular values of columns of length `rows`; the columns are turned. `pairs` are all pairs
/// of columns, neighbours without a column in common: roots and quotients of several are then on
/// their way at a time.
#[inline(always)]
pub(crate) fn singular_values<R: SimdFloat>(
    columns: &mut [R],
    rows: usize,
    pairs: &[(usize, usize)],
    values: &mut [R],
) {
    // Once more for twists and for rows of seven joints, whose loops are then known.
    match rows {
        7 => of_length(columns, 7, pairs, values),
        6 => of_length(columns, 6, pairs, values),
        3 => of_length(columns, 3, pairs, values),
        _ => of_length(columns, rows, pairs, values),
    }
}

#[inline(always)]
fn of_length<R: SimdFloat>(
    columns: &mut [R],
    rows: usize,
    pairs: &[(usize, usize)],
    values: &mut [R],
) {
    let k = R::splat;
    let (zero, one) = (k(0.0), k(1.0));
    // Cosines whose square is larger are turned away: none, in lanes that have come to an end.
    let mut limit = k(JACOBI_ORTHOGONAL * JACOBI_ORTHOGONAL);
    for _ in 0..SWEEPS {
        // Squares of lengths are measured once a sweep, and kept up to date by the rotations.
        for (value, column) in values.iter_mut().zip(columns.chunks_exact(rows)) {
            *value = dot(column, column);
        }
        let mut oblique = zero;
        for &(i, j) in pairs {
            let (head, tail) = columns.split_at_mut(j * rows);
            let (a, b) = (&mut head[i * rows..][..rows], &mut tail[..rows]);
            let (aa, bb, ab) = (values[i], values[j], dot(a, b));
            let (square, product) = (ab * ab, aa * bb);
            oblique = R::select_lt(k(NEARLY) * product, square, one, oblique);
            // Towards the end most pairs are orthogonal in all lanes: nothing would change.
            if R::select_lt(limit * product, square, one, zero).all_abs_le(0.0) {
                continue;
            }
            let difference = bb - aa;
            let double = ab + ab;
            let h = difference.mul_add(difference, double * double).sqrt();
            let t = double.copysign(double * difference) / (difference.abs() + h);
            let t = R::select_lt(limit * product, square, t, zero);
            let c = one / t.mul_add(t, one).sqrt();
            let s = c * t;
            for (x, y) in a.iter_mut().zip(&mut *b) {
                let (p, q) = (*x, *y);
                *x = c.mul_add(p, -(s * q));
                *y = s.mul_add(p, c * q);
            }
            values[i] = (-t).mul_add(ab, aa).max(zero);
            values[j] = t.mul_add(ab, bb);
        }
        limit = R::select_lt(zero, oblique, limit, k(f64::MAX));
        if oblique.all_abs_le(0.0) {
            break;
        }
    }
    for (value, column) in values.iter_mut().zip(columns.chunks_exact(rows)) {
        *value = dot(column, column).sqrt();
    }
}

/// Largest first in each lane, by exchanges of neighbours: as many rounds as there are values.
#[inline(always)]
pub(crate) fn sort_descending<R: SimdFloat>(values: &mut [R]) {
    for round in 0..values.len() {
        for pair in values[round % 2..].chunks_exact_mut(2) {
            let [a, b] = [pair[0], pair[1]];
            pair[0] = R::select_lt(a, b, b, a);
            pair[1] = R::select_lt(a, b, a, b);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::tests::{Four, four, side_by_side};
    use super::*;
    use crate::linalg::batched::round_robin_pairs;
    use crate::linalg::{Matrix, Svd};
    use crate::scalar::Simd;

    #[test]
    fn agrees_with_single() {
        for (rows, cols) in [(3, 2), (6, 6), (6, 3), (14, 8), (2, 1), (5, 4)] {
            let mut a = four(rows, cols, 17);
            a[1] = Matrix::zeros(rows, cols);
            // Rank one, and columns of sizes far apart.
            a[2] = Matrix::from_fn(rows, cols, |i, j| (i + 1) as f64 * (j + 1) as f64);
            a[3] = Matrix::from_fn(rows, cols, |i, j| a[3][(i, j)] * 10.0_f64.powi(-3 * j as i32));
            let mut columns = side_by_side(&a);
            let mut values = vec![Four::splat(0.0); cols];
            singular_values(&mut columns, rows, &round_robin_pairs(cols), &mut values);
            for (l, a) in a.iter().enumerate() {
                let mut got: Vec<f64> = values.iter().map(|v| v.0[l]).collect();
                got.sort_by(|x, y| y.total_cmp(x));
                let svd = Svd::of(a);
                for (g, e) in got.iter().zip(svd.values()) {
                    let scale = if l == 3 { e } else { svd.value(0) };
                    assert!((g - e).abs() <= 1e-14 * scale, "{rows} x {cols}, {l}: {g} and {e}");
                }
                // The same alone.
                let mut alone: Vec<f64> = a.as_slice().to_vec();
                let mut own = vec![0.0; cols];
                singular_values(&mut alone, rows, &round_robin_pairs(cols), &mut own);
                let lane: Vec<f64> = values.iter().map(|v| v.0[l]).collect();
                assert_eq!(own, lane, "{rows} x {cols}, {l}");
            }
        }
    }
}
