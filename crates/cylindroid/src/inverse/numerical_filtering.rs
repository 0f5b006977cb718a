//! Numerical filtering: the weakest direction is damped strongly, the others hardly.
//!
//! Formula  J^T (J J^T + l^2 1 + b^2 u_m u_m^T)^-1 with l, b scaled by the variable-damping law;
//!          gain_i = s_i / (s_i^2 + l^2 + [i = m] b^2)
//! Shapes   m x n -> n x m          Units  onset [-]; l, b in the unit of the singular values
//! Valid    any rank; l > 0 keeps a second vanishing direction finite
//! Why so   damping all directions disturbs the motions that are still possible
//! Source   Maciejewski & Klein 1988; Chiaverini 1997, eq. 21
//! Checked  tests/it/inverse.rs::numerical_filtering_is_the_formula

use super::damped::damp;
use super::variable_damping::fraction;
use crate::linalg::Svd;

/// The numbers of the method.
#[derive(Debug, Clone, Copy)]
pub(super) struct Filter {
    pub(super) onset: f64,
    pub(super) damping: f64,
    pub(super) weakest: f64,
}

pub(super) fn gains(svd: &Svd, filter: Filter, out: &mut [f64]) -> f64 {
    let share = fraction(svd, filter.onset).sqrt();
    let all = share * filter.damping;
    let weakest = share * filter.damping.hypot(filter.weakest);
    let last = svd.len().saturating_sub(1);
    for (i, (gain, s)) in out.iter_mut().zip(svd.values()).enumerate() {
        *gain = damp(s, if i == last { weakest } else { all });
    }
    weakest
}
