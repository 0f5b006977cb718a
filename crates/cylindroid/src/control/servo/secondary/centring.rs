//! Joint centring: towards the middle of the joint limits.
//!
//! Formula  k ((q_min + q_max) / 2 - q)
//! Shapes   velocities of the n coordinates that move the end effector
//! Units    k in 1/s
//! Valid    coordinates with an infinite limit, rotation vectors and free bodies are left alone
//! Source   Liegeois 1977
//! Checked  tests/it/servo/secondary.rs::secondary_tasks_do_what_they_say

use super::Context;

/// Adds the velocities to `out`.
pub(super) fn add(context: &Context<'_>, gain: f64, out: &mut [f64]) {
    for (i, velocity) in out.iter_mut().enumerate() {
        let l = &context.coordinate(i).limits;
        let middle = 0.5 * (l.lower + l.upper);
        if middle.is_finite() && context.is_scalar(i) {
            *velocity += gain * (middle - context.chain.q()[i]);
        }
    }
}
