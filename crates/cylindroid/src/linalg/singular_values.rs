//! Singular values without vectors, by bidiagonalisation: implicit QR steps for all of them,
//! Laguerre iteration for the largest and the smallest alone.
//!
//! Formula  A = U B V^T with B upper bidiagonal; QR steps on B^T B without forming it; Laguerre
//!          iteration on det(B^T B - t) from outside the spectrum
//! Shapes   A: m x n, m >= n; n values
//! Valid    finite matrices whose squares neither overflow nor underflow. Values have an error of
//!          one rounding of the largest.
//! Fails    `None` where the iteration does not converge (a zero on the diagonal): the caller has
//!          the Jacobi decomposition, which always does
//! Why so   ranks of closed chains need values of 18 x 18 matrices that are nearly always regular;
//!          with vectors, by Jacobi rotations, that is three times the work. A rank needs the two
//!          extreme values: a fifth of the time of the QR steps, which are latency-bound. A library
//!          (faer) was slower on the sizes used: see ARCHITECTURE.md
//! Source   Golub & Van Loan, Matrix Computations, 4th ed., sections 5.4.8 and 8.6.3; Wilkinson,
//!          The Algebraic Eigenvalue Problem, ch. 7 (Laguerre); Dhillon & Parlett 2004 (the pivots
//!          of B^T B - t without forming it)
//! Checked  tests::extremes_are_those_of_the_decomposition, tests::steps_are_few,
//!          tests/it/subspaces.rs

use super::matrix::Matrix;
use super::vector::dot_unrolled as dot;
use crate::error::all_finite;
use crate::scalar::clamp;

/// Maximum number of QR steps for each value; two or three are usual.
const STEPS: usize = 12;

/// Up to this many values, all of them are faster than the two extreme ones alone.
const SMALL: usize = 3;

/// Maximum number of Laguerre steps; six are usual.
const MAX_STEPS: usize = 40;

/// The singular values of `a`, largest first.
pub(super) fn singular_values(a: Matrix) -> Option<Vec<f64>> {
    singular_values_within::<STEPS>(a)
}

/// [`singular_values`] in at most `N` QR steps for each value.
fn singular_values_within<const N: usize>(a: Matrix) -> Option<Vec<f64>> {
    let (d, e) = bidiagonal(a);
    let mut values = chase::<N>(d, e)?;
    values.iter_mut().for_each(|v| *v = v.abs());
    values.sort_unstable_by(|a, b| b.total_cmp(a));
    Some(values)
}

/// The largest and the smallest singular value of `a`, without those between; `None` where the
/// steps do not settle.
pub(super) fn extreme_singular_values(a: Matrix) -> Option<[f64; 2]> {
    extreme_singular_values_within::<MAX_STEPS>(a)
}

/// [`extreme_singular_values`] in at most `N` Laguerre steps for each.
fn extreme_singular_values_within<const N: usize>(a: Matrix) -> Option<[f64; 2]> {
    if a.cols() <= SMALL {
        let values = singular_values(a)?;
        return Some([*values.first()?, *values.last()?]);
    }
    let (mut d, mut e) = bidiagonal(a);
    d.iter_mut().chain(&mut e).for_each(|x| *x *= *x);
    if !all_finite(&d) || !all_finite(&e) {
        return None;
    }
    // Gershgorin's bound for the largest value of B^T B.
    let above = |i: usize| if i == 0 { 0.0 } else { e[i - 1] };
    let right = |i: usize| (d[i] * e.get(i).copied().unwrap_or(0.0)).sqrt();
    let left = |i: usize| if i == 0 { 0.0 } else { right(i - 1) };
    let bound = (0..d.len()).map(|i| d[i] + above(i) + right(i) + left(i)).fold(0.0, f64::max);
    let largest = extreme::<N>(&d, &e, bound * (1.0 + 1e-12))?;
    let smallest = extreme::<N>(&d, &e, 0.0)?;
    Some([largest.sqrt(), smallest.sqrt()])
}

/// The eigenvalue of B^T B nearest to `start`, which lies outside all of them, by Laguerre's steps:
/// they come near it with the third power of the distance and would never pass it. Where several
/// values seem one, the first steps are those to a multiple one, and may pass it; then the way back
/// is sought in steps that grow from rounding.
fn extreme<const N: usize>(d: &[f64], e: &[f64], start: f64) -> Option<f64> {
    const ROUNDING: f64 = 4.0 * f64::EPSILON;
    let n = d.len() as f64;
    let side = if start > 0.0 { -1.0 } else { 1.0 };
    // `passed` is the nearest place known to be too far, `back` the last step from one.
    let (mut t, mut before, mut back) = (start, start, 0.0_f64);
    let mut passed = None;
    // How near to a whole number what seems that many values must come.
    let mut near_whole = 0.05;
    for _ in 0..N {
        let Some((g, h)) = logarithmic_derivatives(d, e, t, side) else {
            if t == start {
                return t.is_finite().then_some(t);
            }
            passed = Some(t);
            near_whole *= if back == 0.0 { 0.01 } else { 1.0 };
            back = (30.0 * back).max(ROUNDING * t);
            let near = t - side * back;
            t = if side * (near - before) > 0.0 { near } else { 0.5 * (t + before) };
            continue;
        };
        (before, back) = (t, 0.0);
        let seem = g * g / h;
        let whole = clamp(seem.round(), 1.0, n);
        let m = if (seem - whole).abs() < near_whole { whole } else { 1.0 };
        let root = ((n - m) / m * (n * h - g * g)).max(0.0).sqrt();
        let step = n / (g + root.copysign(g));
        t -= step;
        if step.abs() <= 0.5 * ROUNDING * t {
            return Some(t);
        }
        if let Some(passed) = passed {
            if side * (passed - before) <= 2.0 * ROUNDING * before {
                return Some(before);
            }
            if side * (passed - t) <= 0.0 {
                t = 0.5 * (before + passed);
            }
        }
    }
    None
}

/// First and second derivative by t of log |det(B^T B - t)|, the second with the other sign; `None`
/// where t is not on that side of all eigenvalues.
///
/// `B^T B - t = L D L^T` has `D_i = d_i^2 + s_i`, `s_1 = -t`, `s_{i+1} = (e_i^2 / D_i) s_i - t`;
/// the derivatives are the sums of those of `log |D_i|`.
fn logarithmic_derivatives(d: &[f64], e: &[f64], t: f64, side: f64) -> Option<(f64, f64)> {
    // s, its first and its second derivative.
    let (mut s, mut s1, mut s2) = (-t, -1.0, 0.0);
    let (mut g_sum, mut h_sum) = (0.0, 0.0);
    for (i, &q) in d.iter().enumerate() {
        let pivot = q + s;
        if !(side * pivot > 0.0) {
            return None;
        }
        let inverse = 1.0 / pivot;
        let g = s1 * inverse;
        let h = g * g - s2 * inverse;
        g_sum += g;
        h_sum += h;
        if let Some(e) = e.get(i) {
            let p = e * inverse;
            let turned = s1 - s * g;
            (s, s1, s2) = (p * s - t, p * turned - 1.0, p * (s2 - s1 * g + s * h - g * turned));
        }
    }
    Some((g_sum, h_sum))
}

/// Diagonal and superdiagonal of B.
fn bidiagonal(mut a: Matrix) -> (Vec<f64>, Vec<f64>) {
    let (m, n) = (a.rows(), a.cols());
    let (mut d, mut e) = (vec![0.0; n], vec![0.0; n.saturating_sub(1)]);
    let mut scratch = vec![0.0; n + m];
    let (row, product) = scratch.split_at_mut(n);
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
fn chase<const N: usize>(mut d: Vec<f64>, mut e: Vec<f64>) -> Option<Vec<f64>> {
    let mut hi = d.len().saturating_sub(1);
    let small = |d: &[f64], e: &[f64], i: usize| {
        !(e[i].abs() > 0.5 * f64::EPSILON * (d[i].abs() + d[i + 1].abs()))
    };
    for _ in 0..N * d.len() {
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::linalg::Svd;

    fn check(what: &str, diagonal: &[f64], above: &[f64], settled: bool) {
        let n = diagonal.len();
        let b = Matrix::from_fn(n, n, |i, j| match j.checked_sub(i) {
            Some(0) => diagonal[i],
            Some(1) => above[i],
            _ => 0.0,
        });
        let svd = Svd::of(&b);
        let expected = [svd.value(0), svd.value(n - 1)];
        let Some(got) = extreme_singular_values(b) else {
            assert!(!settled, "{what}: {diagonal:?} {above:?}");
            return;
        };
        for (g, e) in got.iter().zip(expected) {
            assert!(
                (g - e).abs() <= 8e-15 * expected[0],
                "{what}: {got:?} instead of {expected:?}"
            );
        }
    }

    /// Against the Jacobi decomposition: values all over the place, clusters of any width, zeros.
    #[test]
    fn extremes_are_those_of_the_decomposition() {
        let mut seed = 1_u64;
        let mut random = || {
            seed = seed
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1_442_695_040_888_963_407);
            (seed >> 33) as f64 / f64::from(1_u32 << 30) - 1.0
        };
        for round in 0..2000 {
            let n = 1 + round % 21;
            let width = 10.0_f64.powi(-(round as i32 / 21 % 17));
            let spread: Vec<f64> = (0..n).map(|_| random()).collect();
            let small: Vec<f64> = (1..n).map(|_| width * random()).collect();
            check("spread", &spread, &small, true);
            let narrow: Vec<f64> = (0..n).map(|_| 0.7 * (1.0 + width * random())).collect();
            check("one cluster", &narrow, &small, false);
            let two: Vec<f64> =
                (0..n).map(|i| (1.0 + (i % 2) as f64) * (1.0 + width * random())).collect();
            check("two clusters", &two, &small, false);
            let graded: Vec<f64> = (0..n).map(|_| 10.0_f64.powf(8.0 * random() - 8.0)).collect();
            let above: Vec<f64> = (1..n).map(|i| graded[i] * random()).collect();
            check("graded", &graded, &above, true);
        }
        check("double", &[1.0; 6], &[0.0; 5], true);
        check("singular", &[1.0, 0.0, 2.0, 1.0], &[0.5; 3], true);
        check("nothing", &[0.0; 4], &[0.0; 3], true);
        assert!(extreme_singular_values(Matrix::diagonal(&[1.0, 2.0, f64::NAN, 1.0])).is_none());
    }

    /// c y + s z = r, -s y + c z = 0; nothing is not turned.
    #[test]
    fn rotations_annul_the_second() {
        for (y, z) in [(3.0, 4.0), (-3.0, 4.0), (0.0, -2.0), (2.0, 0.0)] {
            let (c, s, r) = rotation(y, z);
            assert!((c * y + s * z - r).abs() < 1e-15 && (c * z - s * y).abs() < 1e-15);
            assert!((c * c + s * s - 1.0).abs() < 1e-15);
        }
        assert_eq!(rotation(0.0, 0.0), (1.0, 0.0, 0.0));
    }

    /// A wrong fallback is only slower: the shares of matrices that need more steps are bounded by
    /// those of the method, and three QR steps for each value are enough for all.
    #[test]
    fn steps_are_few() {
        let mut seed = 1_u64;
        let mut random = || 2.0 * crate::scalar::uniform(&mut seed) - 1.0;
        let rounds = 4000_u32;
        // For each kind those that need more than 8, 14 and 24 steps.
        let mut slow = [[0_u32; 3]; 4];
        for round in 0..rounds {
            let n = 4 + round as usize % 18;
            let width = 10.0_f64.powi(-(round as i32 / 21 % 17));
            let spread: Vec<f64> = (0..n).map(|_| random()).collect();
            let small: Vec<f64> = (1..n).map(|_| width * random()).collect();
            let cluster: Vec<f64> = (0..n).map(|_| 0.7 * (1.0 + width * random())).collect();
            let two: Vec<f64> =
                (0..n).map(|i| (1.0 + (i % 2) as f64) * (1.0 + width * random())).collect();
            let graded: Vec<f64> = (0..n).map(|_| 10.0_f64.powf(8.0 * random() - 8.0)).collect();
            let above: Vec<f64> = (1..n).map(|i| graded[i] * random()).collect();
            let kinds = [(&spread, &small), (&graded, &above), (&cluster, &small), (&two, &small)];
            for (slow, (diagonal, above)) in slow.iter_mut().zip(kinds) {
                let b = Matrix::from_fn(n, n, |i, j| match j.checked_sub(i) {
                    Some(0) => diagonal[i],
                    Some(1) => above[i],
                    _ => 0.0,
                });
                assert!(singular_values_within::<3>(b.clone()).is_some(), "{diagonal:?} {above:?}");
                let more = [
                    extreme_singular_values_within::<8>(b.clone()),
                    extreme_singular_values_within::<14>(b.clone()),
                    extreme_singular_values_within::<24>(b),
                ];
                for (slow, found) in slow.iter_mut().zip(more) {
                    *slow += u32::from(found.is_none());
                }
            }
        }
        let most = [[0.14, 0.14, 0.0], [0.07, 0.07, 0.001], [0.75, 0.4, 0.005], [0.95, 0.8, 0.35]];
        for (few, most) in slow.as_flattened().iter().zip(most.as_flattened()) {
            assert!(f64::from(*few) <= most * f64::from(rounds), "{slow:?} of {rounds}");
        }
    }
}
