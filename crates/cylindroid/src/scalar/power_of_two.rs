//! Scaling without rounding, so that squares neither overflow nor vanish.
//!
//! Checked  tests/it/manipulability/metrics.rs

use super::clamp;

/// The power of two below a size, within the normal numbers.
pub(crate) fn power_of_two(size: f64) -> f64 {
    // The exponent bits alone.
    let exponent = f64::from_bits(size.to_bits() & f64::INFINITY.to_bits());
    clamp(exponent, f64::MIN_POSITIVE, f64::MAX)
}
