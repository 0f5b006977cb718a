//! The gradient of a distance.
//!
//! Formula  row_j = normal . (column_j of b at point_b - column_j of a at point_a), linear parts of
//!          the Jacobians; joints that move both bodies have no share
//! Shapes   n entries, for joint velocities
//! Units    m/s for each unit of joint velocity
//! Valid    where closest points and normal are unique; elsewhere the gradient of one branch
//! Why so   at closest points the sliding of the points along both surfaces is across the normal,
//!          so that only the velocities of the bodies remain
//! Source   Faverjon & Tournassoud 1987
//! Checked  tests/collision/gradient.rs

use super::scene::NearPair;
use crate::kinematics::{State, Tip};
use crate::spatial::Pose;

/// The gradient of the distance of a pair over all coordinates, into `row` (n entries).
pub(super) fn gradient_into(state: &State, near: &NearPair, row: &mut [f64]) {
    row.fill(0.0);
    for_each_column(state, near, |c, rate| row[c] += rate);
}

/// The same, and true for the coordinates that move the bodies relative to one another.
pub(super) fn gradient_and_moving_into(
    state: &State,
    near: &NearPair,
    row: &mut [f64],
    moving: &mut [bool],
) {
    row.fill(0.0);
    moving.fill(false);
    for_each_column(state, near, |c, rate| {
        row[c] += rate;
        moving[c] = true;
    });
}

/// Calls `f` with each coordinate that moves one of the bodies and not the other, and the rate at which
/// that body's closest point moves away from the other body.
fn for_each_column(state: &State, near: &NearPair, mut f: impl FnMut(usize, f64)) {
    let mechanism = state.mechanism();
    let tip = |link: Option<usize>| {
        link.map(|l| Tip {
            nodes: mechanism.nodes(),
            slots: state.slots(),
            slot: mechanism.frames()[l].slot,
            world_from_tip: Pose::IDENTITY, // its columns are taken at the closest point
        })
    };
    let (a, b) = (tip(near.link_a), tip(near.link_b));
    let shared = a.as_ref().zip(b.as_ref()).map_or(0, |(a, b)| a.common_slot(b));
    for (tip, point, normal) in [(a, near.point_a, -near.normal), (b, near.point_b, near.normal)] {
        let Some(tip) = tip else { continue };
        tip.for_each_column_above(shared, point, |_, c, t| f(c, normal.dot(t.linear)));
    }
}
