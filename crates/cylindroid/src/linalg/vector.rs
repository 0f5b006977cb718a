//! Products of vectors held as slices.

/// `a . b`
pub(crate) fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(x, y)| x * y).sum()
}

/// `|a|`, by the plain sum of squares: for numbers whose squares neither overflow nor vanish.
pub(crate) fn norm(a: &[f64]) -> f64 {
    dot(a, a).sqrt()
}
