//! Singular values alone, without vectors: two-sided reflections to a bidiagonal matrix, then
//! shifted QR steps.
//!
//! Formula  A = U B V^T with B upper bidiagonal; QR steps on B^T B without forming it
//! Shapes   A: m x n, m >= n; n values
//! Valid    matrices of finite numbers whose squares neither overflow nor vanish. Values are right
//!          to rounding times the largest.
//! Fails    `None` where the steps do not come to an end (a zero on the diagonal): the caller has
//!          the Jacobi decomposition, which never does
//! Why so   ranks of closed chains need values of 18 x 18 matrices that are nearly always
//!          regular; with vectors, by Jacobi rotations, that is three times the work
//! Source   Golub & Van Loan, Matrix Computations, 4th ed., sections 5.4.8 and 8.6.3
//! Checked  tests/it/subspaces.rs (values against the Jacobi decomposition)

use super::matrix::Matrix;

/// QR steps for each value before giving up; two or three are usual.
const STEPS: usize = 12;

/// The singular values of `a`, largest first.
pub(super) fn singular_values(a: Matrix) -> Option<Vec<f64>> {
    let (d, e) = bidiagonal(a);
    let mut values = chase(d, e)?;
    values.iter_mut().for_each(|v| *v = v.abs());
    values.sort_unstable_by(|a, b| b.total_cmp(a));
    Some(values)
}

/// Diagonal and superdiagonal of B.
fn bidiagonal(mut a: Matrix) -> (Vec<f64>, Vec<f64>) {
    let (m, n) = (a.rows(), a.cols());
    let (mut d, mut e) = (vec![0.0; n], vec![0.0; n.saturating_sub(1)]);
    let mut row = vec![0.0; n];
    let mut product = vec![0.0; m];
    for j in 0..n {
        let (head, rest) = a.as_mut_slice().split_at_mut((j + 1) * m);
        let v = &mut head[j * m + j..];
        let (diagonal, factor) = reflector(v);
        d[j] = diagonal;
        for column in rest.chunks_exact_mut(m) {
            let column = &mut column[j..];
            let along = factor * dot(v, column);
            column.iter_mut().zip(&*v).for_each(|(x, v)| *x -= along * v);
        }
        if j + 1 == n {
            break;
        }
        // The row to the right, as a reflection of columns.
        let v = &mut row[j + 1..];
        for (v, column) in v.iter_mut().zip(rest.chunks_exact(m)) {
            *v = column[j];
        }
        let (above, factor) = reflector(v);
        e[j] = above;
        let y = &mut product[j + 1..];
        y.fill(0.0);
        for (v, column) in v.iter().zip(rest.chunks_exact(m)) {
            y.iter_mut().zip(&column[j + 1..]).for_each(|(y, x)| *y += v * x);
        }
        for (v, column) in v.iter().zip(rest.chunks_exact_mut(m)) {
            let share = factor * v;
            column[j + 1..].iter_mut().zip(&*y).for_each(|(x, y)| *x -= share * y);
        }
    }
    (d, e)
}

/// Turns `x` into the vector v of the reflection `1 - factor v v^T` that takes it to a multiple of
/// the first axis; gives the multiple and the factor.
fn reflector(x: &mut [f64]) -> (f64, f64) {
    let norm = dot(x, x).sqrt();
    if norm == 0.0 {
        return (0.0, 0.0);
    }
    let target = -norm.copysign(x[0]);
    x[0] -= target;
    (target, -1.0 / (target * x[0]))
}

/// QR steps on the bidiagonal matrix until it is diagonal.
fn chase(mut d: Vec<f64>, mut e: Vec<f64>) -> Option<Vec<f64>> {
    let mut hi = d.len().saturating_sub(1);
    let small = |d: &[f64], e: &[f64], i: usize| {
        !(e[i].abs() > 0.5 * f64::EPSILON * (d[i].abs() + d[i + 1].abs()))
    };
    for _ in 0..STEPS * d.len() {
        while hi > 0 && small(&d, &e, hi - 1) {
            hi -= 1;
        }
        if hi == 0 {
            break;
        }
        let mut lo = hi - 1;
        while lo > 0 && !small(&d, &e, lo - 1) {
            lo -= 1;
        }
        // Wilkinson's shift: the eigenvalue of the last 2 x 2 block of B^T B nearest to its corner.
        let above = if hi - 1 > lo { e[hi - 2] } else { 0.0 };
        let corner = d[hi] * d[hi] + e[hi - 1] * e[hi - 1];
        let before = d[hi - 1] * d[hi - 1] + above * above;
        let off = d[hi - 1] * e[hi - 1];
        let half = 0.5 * (before - corner);
        let root = half.hypot(off);
        let shift =
            if root > 0.0 { corner - off * off / (half + root.copysign(half)) } else { 0.0 };
        let (mut y, mut z) = (d[lo] * d[lo] - shift, d[lo] * e[lo]);
        for k in lo..hi {
            let (c, s, r) = rotation(y, z);
            if k > lo {
                e[k - 1] = r;
            }
            (y, e[k]) = (c * d[k] + s * e[k], c * e[k] - s * d[k]);
            (z, d[k + 1]) = (s * d[k + 1], c * d[k + 1]);
            let (c, s, r) = rotation(y, z);
            d[k] = r;
            (y, d[k + 1]) = (c * e[k] + s * d[k + 1], c * d[k + 1] - s * e[k]);
            e[k] = y;
            if k + 1 < hi {
                (z, e[k + 1]) = (s * e[k + 1], c * e[k + 1]);
            }
        }
    }
    (hi == 0 || d.is_empty()).then_some(d)
}

/// Cosine, sine and length of (y, z).
#[inline]
fn rotation(y: f64, z: f64) -> (f64, f64, f64) {
    let r = (y * y + z * z).sqrt();
    if r == 0.0 { (1.0, 0.0, 0.0) } else { (y / r, z / r, r) }
}

#[inline]
fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(x, y)| x * y).sum()
}
