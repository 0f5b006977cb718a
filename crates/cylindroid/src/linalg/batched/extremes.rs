//! Extreme eigenvalues of symmetric positive semidefinite matrices, batched.
//!
//! Formula  A reduced to a tridiagonal T by Householder reflections; Laguerre iteration on det(T -
//!          t) from outside the spectrum, with pivots `p_i = d_i - t - e_{i-1}^2 / p_{i-1}`
//! Shapes   A: n x n, the lower triangle is read; d: n, e: n - 1
//! Valid    eigenvalues have an error of a few roundings of the largest, so the smallest has fewer
//!          relative digits
//! Fails    NaN where the iteration does not converge within [`MAX_STEPS`]
//! Why so   singular_values.rs has the same iteration for one matrix; here the matrix is squared,
//!          which costs digits of the small values and saves half the work. An eigenvalue that a
//!          step passed is confirmed by the signs of the pivots on both sides of it
//! Source   Wilkinson, The Algebraic Eigenvalue Problem, ch. 5 and 7
//! Checked  tests::agrees_with_single, tests::steps_are_few

use super::{add_times, dot, reflector};
use crate::scalar::SimdFloat;

/// Maximum number of Laguerre steps; seven are usual.
const MAX_STEPS: usize = 40;

/// Half of the accuracy of an eigenvalue, relative to a bound of the largest.
const ROUNDING: f64 = 2.0 * f64::EPSILON;

/// An eigenvalue is passed by rounding by at most this multiple of it.
const MAX_BACKTRACK: f64 = 20.0;

/// Adding and subtracting it rounds to an integer.
const ROUND: f64 = 6_755_399_441_055_744.0;

/// How near to a whole number what seems that many eigenvalues must come.
const NEAR_WHOLE: f64 = 0.05;

/// An end of the spectrum.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum End {
    Smallest,
    Largest,
}

/// Diagonal and squares of the off-diagonal of T; `a`, n x n, is used up, `product` holds n.
#[inline(always)]
pub(crate) fn tridiagonal<R: SimdFloat>(
    a: &mut [R],
    diagonal: &mut [R],
    squares: &mut [R],
    product: &mut [R],
) {
    let n = diagonal.len();
    for j in 0..n {
        let (head, rest) = a.split_at_mut((j + 1) * n);
        diagonal[j] = head[j * n + j];
        if j + 1 == n {
            break;
        }
        let v = &mut head[j * n + j + 1..];
        if j + 2 == n {
            squares[j] = v[0] * v[0];
            continue;
        }
        let (off, factor) = reflector(v);
        squares[j] = off * off;
        // p = factor A v, by the lower triangle alone.
        let p = &mut product[j + 1..n];
        p.fill(R::splat(0.0));
        times_symmetric(rest, n, v, p);
        for x in &mut *p {
            *x = *x * factor;
        }
        let half = R::splat(-0.5) * factor * dot(p, v);
        add_times(p, half, v);
        subtract_both(rest, n, v, p);
    }
}

/// `p <- p + A v`, A the lower triangle at the end of columns of length n; two columns at a time,
/// so that p and v are read half as often.
#[inline(always)]
fn times_symmetric<R: SimdFloat>(columns: &[R], n: usize, v: &[R], p: &mut [R]) {
    let m = v.len();
    let mut c = 0;
    while c + 1 < m {
        let a = &columns[(c + 1) * n - m + c..(c + 1) * n];
        let b = &columns[(c + 2) * n - m + c + 1..(c + 2) * n];
        let (x, y) = (v[c], v[c + 1]);
        let mut first = a[1].mul_add(y, a[0].mul_add(x, p[c]));
        let mut second = a[1].mul_add(x, b[0].mul_add(y, p[c + 1]));
        let rows = p[c + 2..].iter_mut().zip(&v[c + 2..]);
        for (((p, v), a), b) in rows.zip(&a[2..]).zip(&b[1..]) {
            *p = a.mul_add(x, b.mul_add(y, *p));
            first = a.mul_add(*v, first);
            second = b.mul_add(*v, second);
        }
        (p[c], p[c + 1]) = (first, second);
        c += 2;
    }
    if c < m {
        p[c] = columns[(c + 1) * n - 1].mul_add(v[c], p[c]);
    }
}

/// `A <- A - v p^T - p v^T` of the same triangle.
#[inline(always)]
fn subtract_both<R: SimdFloat>(columns: &mut [R], n: usize, v: &[R], p: &[R]) {
    let m = v.len();
    let mut c = 0;
    while c + 1 < m {
        let (head, tail) = columns.split_at_mut((c + 1) * n);
        let a = &mut head[(c + 1) * n - m + c..];
        let b = &mut tail[n - m + c + 1..n];
        let (va, pa, vb, pb) = (-v[c], -p[c], -v[c + 1], -p[c + 1]);
        a[0] = va.mul_add(p[c], pa.mul_add(v[c], a[0]));
        let rows = v[c + 1..].iter().zip(&p[c + 1..]);
        for (((v, p), a), b) in rows.zip(&mut a[1..]).zip(b) {
            *a = va.mul_add(*p, pa.mul_add(*v, *a));
            *b = vb.mul_add(*p, pb.mul_add(*v, *b));
        }
        c += 2;
    }
    if c < m {
        let last = &mut columns[(c + 1) * n - 1];
        *last = (-v[c]).mul_add(p[c] + p[c], *last);
    }
}

/// The eigenvalues at these ends.
#[inline(always)]
pub(crate) fn extreme_eigenvalues<R: SimdFloat, const E: usize>(
    diagonal: &[R],
    squares: &[R],
    ends: [End; E],
) -> [R; E] {
    extreme_eigenvalues_within::<R, E, MAX_STEPS>(diagonal, squares, ends)
}

/// [`extreme_eigenvalues`] in at most `N` Laguerre steps.
#[inline(always)]
fn extreme_eigenvalues_within<R: SimdFloat, const E: usize, const N: usize>(
    diagonal: &[R],
    squares: &[R],
    ends: [End; E],
) -> [R; E] {
    let k = R::splat;
    let (zero, one, half) = (k(0.0), k(1.0), k(0.5));
    let n = k(diagonal.len() as f64);
    let bound = bound(diagonal, squares);
    let noise = bound * k(ROUNDING);
    // Current and last iterate of each end on its side; how far to step back from beyond it.
    let (mut t, mut before, mut back) = ([zero; E], [zero; E], [noise; E]);
    for e in 0..E {
        if ends[e] == End::Largest {
            t[e] = bound * k(1.0 + 1e-12);
            back[e] = -noise;
        }
    }
    // How near to a whole number what seems that many values must come; 1 where rounding alone was
    // passed, 1 where all is done.
    let (mut near, mut passed, mut done) = ([k(NEAR_WHOLE); E], [zero; E], [zero; E]);
    for _ in 0..N {
        let slopes = logarithmic_derivatives(diagonal, squares, &t, &ends);
        let mut all = one;
        for e in 0..E {
            let Slopes { g, h, least } = slopes[e];
            let seem = g * g / h;
            let whole = (seem + k(ROUND)) - k(ROUND);
            let whole = R::select_lt(whole, one, one, whole);
            let several = R::select_lt((seem - whole).abs(), near[e], whole, one);
            let inner = (n - several) / several * n.mul_add(h, -(g * g));
            let step = n / (g + inner.max(zero).sqrt().copysign(g));
            let beyond = R::select_lt(zero, least, zero, one);
            // By rounding, or by taking several values for one?
            let rounding = R::select_lt(back[e].abs(), noise * k(MAX_BACKTRACK), beyond, zero);
            let again = R::select_lt(rounding, beyond, one, zero);
            let settled = R::select_lt(step.abs(), noise, one, passed[e]);
            let ends_here = R::select_lt(half, beyond, zero, settled);
            let forward = R::select_lt(half, passed[e], t[e], t[e] - step);
            let next = R::select_lt(half, beyond, t[e] - back[e], forward);
            let next = R::select_lt(half, again, before[e], next);
            before[e] = R::select_lt(half, beyond, before[e], t[e]);
            passed[e] = R::select_lt(half, beyond, rounding, passed[e]);
            near[e] = R::select_lt(half, again, near[e] * k(0.01), near[e]);
            let more = R::select_lt(half, beyond, back[e] * k(4.0), back[e]);
            back[e] = R::select_lt(half, again, noise.copysign(more), more);
            t[e] = R::select_lt(half, done[e], t[e], next);
            done[e] = ends_here.max(done[e]);
            all = R::select_lt(half, done[e], all, zero);
        }
        if (one - all).all_abs_le(0.0) {
            break;
        }
    }
    for e in 0..E {
        t[e] = R::select_lt(half, done[e], t[e], k(f64::NAN));
    }
    t
}

/// Gershgorin's bound of the largest eigenvalue.
#[inline(always)]
fn bound<R: SimdFloat>(diagonal: &[R], squares: &[R]) -> R {
    let mut bound = R::splat(0.0);
    let mut before = R::splat(0.0);
    for (i, d) in diagonal.iter().enumerate() {
        let after = match squares.get(i) {
            Some(s) => s.sqrt(),
            None => R::splat(0.0),
        };
        bound = bound.max(*d + before + after);
        before = after;
    }
    bound
}

/// First and second derivative by t of log |det(T - t)|, the second with the other sign; the least
/// of the pivots in the sense of the end: below zero where t has passed an eigenvalue.
#[derive(Debug, Clone, Copy)]
struct Slopes<R> {
    g: R,
    h: R,
    least: R,
}

#[inline(always)]
fn logarithmic_derivatives<R: SimdFloat, const E: usize>(
    diagonal: &[R],
    squares: &[R],
    t: &[R; E],
    ends: &[End; E],
) -> [Slopes<R>; E] {
    let k = R::splat;
    let (zero, one) = (k(0.0), k(1.0));
    let mut sums = [Slopes { g: zero, h: zero, least: k(f64::MAX) }; E];
    // Over the pivot before: the off-diagonal square; its first and second derivative.
    let mut last = [(zero, zero, zero); E];
    for (i, d) in diagonal.iter().enumerate() {
        for e in 0..E {
            let (weight, g, c) = last[e];
            let pivot = (*d - t[e]) - weight;
            let inverse = one / pivot;
            let first = weight.mul_add(g, -one) * inverse;
            let second = weight * (c - k(2.0) * g * g) * inverse;
            sums[e].g = sums[e].g + first;
            sums[e].h = sums[e].h + first.mul_add(first, -second);
            let signed = if ends[e] == End::Smallest { pivot } else { -pivot };
            // Not a number stays.
            sums[e].least = R::select_lt(sums[e].least, signed, sums[e].least, signed);
            let square = match squares.get(i) {
                Some(s) => *s,
                None => zero,
            };
            last[e] = (square * inverse, first, second);
        }
    }
    sums
}

#[cfg(test)]
mod tests {
    use super::super::tests::{four, side_by_side};
    use super::*;
    use crate::linalg::{Matrix, Svd};

    fn ends<R: SimdFloat>(squares: &mut [R], n: usize) -> [R; 2] {
        let zero = R::splat(0.0);
        let (mut d, mut e, mut p) = (vec![zero; n], vec![zero; n], vec![zero; n]);
        tridiagonal(squares, &mut d, &mut e[..n - 1], &mut p);
        extreme_eigenvalues(&d, &e[..n - 1], [End::Smallest, End::Largest])
    }

    #[test]
    fn agrees_with_single() {
        for round in 0..400 {
            let n = 1 + round % 21;
            let mut roots = four(n, n, round as u64);
            // All alike; two alike at either end; a small one.
            roots[1] = Matrix::identity(n);
            roots[2] = Matrix::diagonal(
                &(0..n).map(|i| (i.clamp(1, n.max(4) - 2)) as f64).collect::<Vec<_>>(),
            );
            roots[3].column_mut(0).iter_mut().for_each(|x| *x *= 1e-3);
            let squares = roots.clone().map(|a| &a * &a.transpose());
            let got = ends(&mut side_by_side(&squares), n);
            for (l, a) in roots.iter().enumerate() {
                let svd = Svd::of(a);
                let expected = [svd.value(n - 1).powi(2), svd.value(0).powi(2)];
                let got = got.map(|x| x.0[l]);
                let alone = ends(&mut squares[l].as_slice().to_vec(), n);
                for e in 0..2 {
                    assert_eq!(got[e].to_bits(), alone[e].to_bits(), "{round} {l}");
                    let error = (got[e] - expected[e]).abs() / expected[1];
                    assert!(error < 1e-14 * n as f64, "{round} {l}: {got:?} {expected:?}");
                }
            }
        }
    }

    /// A wrong fallback is only slower: the shares of matrices that need more than 8, 12 and 16 steps
    /// are bounded by those of the method.
    #[test]
    fn steps_are_few() {
        let rounds = 2000_u32;
        // Random, all alike, two alike at either end, a small one.
        let mut slow = [[0_u32; 3]; 4];
        for round in 0..rounds {
            let n = 1 + round as usize % 21;
            let mut roots = four(n, n, u64::from(round));
            roots[1] = Matrix::identity(n);
            roots[2] = Matrix::diagonal(
                &(0..n).map(|i| (i.clamp(1, n.max(4) - 2)) as f64).collect::<Vec<_>>(),
            );
            roots[3].column_mut(0).iter_mut().for_each(|x| *x *= 1e-3);
            for (slow, a) in slow.iter_mut().zip(&roots) {
                let mut square = (a * &a.transpose()).as_slice().to_vec();
                let (mut d, mut e, mut p) = (vec![0.0; n], vec![0.0; n], vec![0.0; n]);
                tridiagonal(&mut square, &mut d, &mut e[..n - 1], &mut p);
                let (e, ends) = (&e[..n - 1], [End::Smallest, End::Largest]);
                let more = [
                    extreme_eigenvalues_within::<f64, 2, 8>(&d, e, ends),
                    extreme_eigenvalues_within::<f64, 2, 12>(&d, e, ends),
                    extreme_eigenvalues_within::<f64, 2, 16>(&d, e, ends),
                ];
                for (slow, found) in slow.iter_mut().zip(more) {
                    *slow += u32::from(found.iter().any(|x| x.is_nan()));
                }
            }
        }
        let most = [[0.17, 0.01, 0.0], [0.0; 3], [0.15, 0.15, 0.0], [0.12, 0.01, 0.0]];
        for (few, most) in slow.as_flattened().iter().zip(most.as_flattened()) {
            assert!(f64::from(*few) <= most * f64::from(rounds), "{slow:?} of {rounds}");
        }
    }
}
