//! Joint-limit avoidance: away from limits nearer than a margin.
//!
//! Formula  k (1 - d / m) away from a limit at a distance d < m, m the margin times the range
//! Shapes   velocities of the n coordinates that move the end effector
//! Units    k in rad/s or m/s, the velocity at the limit
//! Valid    coordinates with an infinite limit, rotation vectors and free bodies are left alone
//! Checked  tests/it/servo/secondary.rs::secondary_limit_avoidance_*

use super::Context;
use crate::scalar::clamp;

/// Adds the velocities to `out`; `margin` is a share of the range.
pub(super) fn add(context: &Context<'_>, gain: f64, margin: f64, out: &mut [f64]) {
    for (i, velocity) in out.iter_mut().enumerate() {
        let l = &context.coordinate(i).limits;
        let near = margin * (l.upper - l.lower);
        if !(near.is_finite() && near > 0.0 && context.is_scalar(i)) {
            continue;
        }
        let q = context.chain.q()[i];
        let push = |distance: f64| clamp(1.0 - distance / near, 0.0, 1.0);
        *velocity += gain * (push(q - l.lower) - push(l.upper - q));
    }
}
