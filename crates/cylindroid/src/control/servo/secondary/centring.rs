//! Joint centring: towards the middle of the joint limits.
//!
//! Formula  s k ((q_min + q_max) / 2 - q), s the largest share at which all joints can stop there
//!          (`approach.rs`)
//! Shapes   velocities of the n coordinates that move the end effector
//! Units    k in 1/s
//! Valid    coordinates with an infinite limit, rotation vectors and free bodies are left alone
//! Source   Liegeois 1977
//! Checked  tests/it/servo/secondary.rs::secondary_tasks_do_what_they_say

use super::Context;

/// Adds the velocities to `out`.
pub(super) fn add(context: &Context<'_>, gain: f64, out: &mut [f64]) {
    let way = |i: usize| {
        let l = &context.coordinate(i).limits;
        let middle = 0.5 * (l.lower + l.upper);
        let has_goal = middle.is_finite() && context.is_scalar(i);
        if has_goal { middle - context.chain.q()[i] } else { 0.0 }
    };
    let shares = (0..out.len()).map(|i| context.share_of_gain(i, way(i), gain));
    let share = shares.fold(1.0, f64::min);
    for (i, velocity) in out.iter_mut().enumerate() {
        *velocity += share * gain * way(i);
    }
}
