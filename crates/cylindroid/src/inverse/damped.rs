//! Damped least squares: a constant damping in every direction.
//!
//! Formula  J^T (J J^T + l^2 1)^-1, gain_i = s_i / (s_i^2 + l^2)
//! Shapes   m x n -> n x m          Units  l in the unit of the singular values
//! Valid    any rank, l > 0; |qd| <= |v| / (2 l)
//! Why so   the simplest inverse without a jump; its price is an error everywhere, which a closed
//!          loop removes
//! Source   Nakamura & Hanafusa 1986; Wampler 1986
//! Checked  tests/it/inverse.rs::damped_*

use crate::linalg::Svd;

pub(super) fn gains(svd: &Svd, damping: f64, out: &mut [f64]) -> f64 {
    for (gain, s) in out.iter_mut().zip(svd.values()) {
        *gain = damp(s, damping);
    }
    damping
}

/// `s / (s^2 + l^2)`, in the form that squares neither; zero below the smallest normal number, also
/// without damping.
#[inline]
pub(crate) fn damp(s: f64, damping: f64) -> f64 {
    if s < f64::MIN_POSITIVE { 0.0 } else { 1.0 / (s + damping * (damping / s)) }
}
