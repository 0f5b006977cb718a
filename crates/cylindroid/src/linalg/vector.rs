//! Dot products and norms of vectors given as slices.

/// `a . b`
pub(crate) fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(x, y)| x * y).sum()
}

/// `|a|`, by the plain sum of squares: for numbers whose squares neither overflow nor vanish.
pub(crate) fn norm(a: &[f64]) -> f64 {
    dot(a, a).sqrt()
}

/// The largest absolute number: NaN if any is NaN, zero if there is none.
#[inline]
pub(crate) fn max_abs(a: &[f64]) -> f64 {
    // `f64::max` drops NaN, a comparison that fails keeps it.
    // Bits of numbers without sign are in the order of the numbers, NaN last; four at a time,
    // as none waits for the other.
    let (fours, rest) = a.as_chunks::<4>();
    let mut most = [0; 4];
    for four in fours {
        for l in 0..4 {
            most[l] = most[l].max(four[l].abs().to_bits());
        }
    }
    let rest = rest.iter().map(|x| x.abs().to_bits());
    f64::from_bits(most.into_iter().chain(rest).max().unwrap_or(0))
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
