//! Angles wrapped by full turns.
//!
//! Checked  tests::nearest_by_full_turns

use std::f64::consts::{PI, TAU};

/// The angle wrapped by full turns to the value closest to `near`.
pub(crate) fn nearest_turn(angle: f64, near: f64) -> f64 {
    let apart = near - angle;
    if apart.abs() <= PI { angle } else { angle + TAU * (apart / TAU).round() }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nearest_by_full_turns() {
        for near in [-20.0, -1.5, 0.0, 0.25, 7.0] {
            for apart in [-3.1, -1.0, 0.0, 0.5, 3.1] {
                assert_eq!(nearest_turn(near + apart, near), near + apart);
                for turns in [-3.0, -1.0, 1.0, 2.0] {
                    let wrapped = nearest_turn(near + apart + turns * TAU, near);
                    assert!((wrapped - near - apart).abs() < 1e-13, "{near} {apart} {turns}");
                }
            }
        }
    }
}
