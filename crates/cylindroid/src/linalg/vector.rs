//! Dot products and norms of vectors given as slices.

/// `a . b`
pub(crate) fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(x, y)| x * y).sum()
}

/// `|a|`, by the plain sum of squares: for numbers whose squares neither overflow nor vanish.
pub(crate) fn norm(a: &[f64]) -> f64 {
    dot(a, a).sqrt()
}

/// `a . b` in four independent partial sums, which the processor vectorises.
#[inline]
pub(super) fn dot_unrolled(a: &[f64], b: &[f64]) -> f64 {
    const LANES: usize = 4;
    let (a, a_rest) = a.as_chunks::<LANES>();
    let (b, b_rest) = b.as_chunks::<LANES>();
    let mut sum = [0.0; LANES];
    for (x, y) in a.iter().zip(b) {
        for l in 0..LANES {
            sum[l] += x[l] * y[l];
        }
    }
    let rest: f64 = a_rest.iter().zip(b_rest).map(|(x, y)| x * y).sum();
    (sum[0] + sum[2]) + (sum[1] + sum[3]) + rest
}
