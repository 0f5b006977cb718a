//! Variable damping: none in regular poses, rising as the smallest singular value falls.
//!
//! Formula  l^2 = 0 if s_m >= e, else (1 - (s_m / e)^2) l_max^2, e = onset s_1;
//!          gain_i = s_i / (s_i^2 + l^2)
//! Shapes   m x n -> n x m          Units  onset [-], l_max in the unit of the singular values
//! Valid    any rank; continuous in J; gain at most about 1 / (2 l_max) at rank loss
//! Source   Maciejewski & Klein 1988; Chiaverini 1997, eq. 20
//! Checked  tests/it/inverse.rs::variable_damping_is_the_formula

use super::damped::damp;
use crate::linalg::Svd;

pub(super) fn gains(svd: &Svd, onset: f64, damping: f64, out: &mut [f64]) -> f64 {
    let damping = fraction(svd, onset).sqrt() * damping;
    for (gain, s) in out.iter_mut().zip(svd.values()) {
        *gain = damp(s, damping);
    }
    damping
}

/// The share of the full damping: 0 in regular poses, 1 at rank loss.
pub(super) fn fraction(svd: &Svd, onset: f64) -> f64 {
    if svd.is_empty() {
        return 0.0;
    }
    let (largest, smallest) = (svd.value(0), svd.value(svd.len() - 1));
    let e = onset * largest;
    if smallest >= e {
        if largest == 0.0 { 1.0 } else { 0.0 }
    } else {
        1.0 - (smallest / e).powi(2)
    }
}
