//! Rank of the rates of loops and contacts.
//!
//! Formula  singular values at or below eps max(s_1, 1) count as zero
//! Units    none: rows and columns of lengths are divided by the characteristic length, so that a joint
//!          turns or moves a link at a rate of 1
//! Valid    rates scaled so. Thresholds of the whole constraint, with the twist of the reference beside
//!          the loops (`motion_space.rs`), are relative to its largest singular value, which is 1 at
//!          least: the same verdicts
//! Why so   all rates may cancel around a loop, as those of hinges on one axis and of parallel slides
//!          do: relative to the largest, which then is rounding, rounding would have full rank
//! Checked  tests/it/closure/cancelling_rates.rs

use crate::linalg::{ColumnSpace, Matrix, Svd, rank_threshold};

/// The size that singular values of rates are compared with: the largest of them, but that of a joint
/// before its rates cancel at least.
pub(crate) fn rate_size(largest: f64) -> f64 {
    largest.max(1.0)
}

/// The rank of rates.
pub(crate) fn rate_rank(rates: &Svd, eps: f64) -> usize {
    let longer = rates.rows().max(rates.cols());
    let threshold = rank_threshold(eps, longer, rate_size(rates.largest()));
    rates.values().take_while(|s| *s > threshold).count()
}

/// The row space of rates, and its complement: the motions that all rates permit.
pub(crate) fn rate_space(rates: &Matrix, eps: f64) -> ColumnSpace {
    ColumnSpace::cut_beside(rates.transpose(), eps, rate_size(0.0))
}
