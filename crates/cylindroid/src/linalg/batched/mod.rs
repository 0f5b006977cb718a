//! Batched decompositions: several small matrices of one shape, one in each SIMD lane, with the
//! same steps in the same order whatever their entries.
//!
//! Shapes   columns one after the other, each entry a number of lanes
//! Valid    finite entries whose squares neither overflow nor underflow
//! Fails    lane by lane: non-finite entries, or iterations that do not converge, give non-finite
//!          results; the other lanes are not affected, to the bit
//! Why so   no pivoting, since lanes would need different pivots. The caller must detect rank loss
//!          in the results and pass that lane to a decomposition with pivoting
//! Checked  src/linalg/batched/*.rs::agrees_with_single

mod extremes;
mod reflections;
mod values;

pub(crate) use extremes::{End, extreme_eigenvalues, tridiagonal};
pub(crate) use reflections::{Reflections, divide_by_upper};
pub(crate) use values::{singular_values, sort_descending};

pub(crate) use super::jacobi::round_robin_pairs;
use crate::scalar::SimdFloat;

/// Scalar product of vectors of one length.
#[inline(always)]
pub(crate) fn dot<R: SimdFloat>(a: &[R], b: &[R]) -> R {
    // Two sums, since each product depends on the previous one of its sum.
    let mut sums = [R::splat(0.0); 2];
    let (a, a_rest) = a.as_chunks::<2>();
    let (b, b_rest) = b.as_chunks::<2>();
    for (x, y) in a.iter().zip(b) {
        sums[0] = x[0].mul_add(y[0], sums[0]);
        sums[1] = x[1].mul_add(y[1], sums[1]);
    }
    for (x, y) in a_rest.iter().zip(b_rest) {
        sums[0] = x.mul_add(*y, sums[0]);
    }
    sums[0] + sums[1]
}

/// `y <- y + s x`
#[inline(always)]
fn add_times<R: SimdFloat>(y: &mut [R], s: R, x: &[R]) {
    for (y, x) in y.iter_mut().zip(x) {
        *y = s.mul_add(*x, *y);
    }
}

/// Turns `x` into the vector v of the reflection `1 - factor v v^T` that takes it to a multiple of
/// the first axis; gives the multiple and the factor. A zero stays.
#[inline(always)]
fn reflector<R: SimdFloat>(x: &mut [R]) -> (R, R) {
    let zero = R::splat(0.0);
    let square = dot(x, x);
    let target = -square.sqrt().copysign(x[0]);
    x[0] = x[0] - target;
    let factor = R::splat(-1.0) / (target * x[0]);
    (target, R::select_lt(zero, square, factor, zero))
}

/// `x <- (1 - factor v v^T) x` of entries `from..` of columns of length n, four at a time: their
/// sums are independent, and v is read once.
#[inline(always)]
fn reflect<R: SimdFloat>(columns: &mut [R], n: usize, from: usize, v: &[R], factor: R) {
    let m = v.len();
    let mut fours = columns.chunks_exact_mut(4 * n);
    for four in &mut fours {
        let (one, rest) = four.split_at_mut(n);
        let (two, rest) = rest.split_at_mut(n);
        let (three, four) = rest.split_at_mut(n);
        let (one, two) = (&mut one[from..][..m], &mut two[from..][..m]);
        let (three, four) = (&mut three[from..][..m], &mut four[from..][..m]);
        let mut along = [R::splat(0.0); 4];
        for i in 0..m {
            along[0] = one[i].mul_add(v[i], along[0]);
            along[1] = two[i].mul_add(v[i], along[1]);
            along[2] = three[i].mul_add(v[i], along[2]);
            along[3] = four[i].mul_add(v[i], along[3]);
        }
        for x in &mut along {
            *x = -(factor * *x);
        }
        for i in 0..m {
            one[i] = along[0].mul_add(v[i], one[i]);
            two[i] = along[1].mul_add(v[i], two[i]);
            three[i] = along[2].mul_add(v[i], three[i]);
            four[i] = along[3].mul_add(v[i], four[i]);
        }
    }
    for column in fours.into_remainder().chunks_exact_mut(n) {
        let x = &mut column[from..][..m];
        let along = factor * dot(v, x);
        add_times(x, -along, v);
    }
}

#[cfg(test)]
pub(super) mod tests {
    use crate::linalg::Matrix;
    use crate::scalar::{Array, Simd, uniform};

    pub(crate) type Four = Array<4>;

    /// Four matrices of numbers in [-1, 1).
    pub(crate) fn four(rows: usize, cols: usize, seed: u64) -> [Matrix; 4] {
        let mut state = seed;
        std::array::from_fn(|_| Matrix::from_fn(rows, cols, |_, _| 2.0 * uniform(&mut state) - 1.0))
    }

    pub(crate) fn side_by_side(four: &[Matrix; 4]) -> Vec<Four> {
        (0..four[0].as_slice().len()).map(|i| Four::from_fn(|l| four[l].as_slice()[i])).collect()
    }
}
