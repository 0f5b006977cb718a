//! The sentence of `screws` on the involution of joint axes.

use cylindroid::Vec3;
use cylindroid::screws::{Involution, Transversals};

use crate::output::{self, number};

/// Whether the axes are in involution, and what that means.
pub(super) fn involution(i: &Involution) -> String {
    let lines = format!("{} of the twists are lines", i.lines);
    if !i.in_involution {
        return format!("no ({lines})");
    }
    let mut text = format!("yes ({lines}");
    if !i.independent {
        text.push_str(", dependent");
    }
    text.push(')');
    if let (Some(screw), Some(_)) = (&i.null_screw, &i.wrench) {
        if screw.is_translation() {
            text.push_str(&format!(
                "; a couple about {} needs no torque of these joints",
                direction(screw.axis.direction)
            ));
        } else {
            text.push_str(&format!(
                "; a wrench of pitch {} m/rad on the axis through {} along {} needs no torque of \
                 these joints",
                number(clean(screw.pitch)),
                output::entries(&screw.axis.point.to_array()),
                direction(screw.axis.direction)
            ));
        }
    }
    let Transversals { infinitely_many, lines, at_infinity, double } = &i.transversals;
    if *infinitely_many {
        text.push_str("; infinitely many lines meet all axes");
    } else if *double {
        text.push_str("; one line, counted twice, meets all axes");
    } else if !lines.is_empty() {
        let s = if lines.len() == 1 { " meets" } else { "s meet" };
        text.push_str(&format!("; {} line{s} all axes", lines.len()));
    } else if !at_infinity.is_empty() {
        text.push_str("; they meet one line at infinity: all are parallel to a plane");
    }
    text
}

fn direction(d: Vec3) -> String {
    format!("({})", output::entries(&d.to_array()))
}

/// Without the rounding of a zero.
pub(super) fn clean(x: f64) -> f64 {
    if x.abs() < 1e-12 { 0.0 } else { x }
}
