//! Pieper's closed form: all joint angles of six revolute joints for a tool pose, for each
//! geometry.
//!
//! Formula  R = R1 R2 .. R6, p = R1 (p12 + R2 (p23 + R3 (p34 + ..))), p from axis 1 to axis 6.
//!          Axes 4, 5, 6 intersect, u = p45 = p56 = 0 (x angle 1, y angle 3):
//!          h2 . R1^T p - h2 . R3 p34 = h2 . (p12 + p23),
//!          2 p12 . R1^T p + 2 p23 . R3 p34 = p^2 + p12^2 - p23^2 - p34^2, then angle 2 from one
//!          vector, and the wrist: h4 . R5 h6 = h4 . R3^T R2^T R1^T R h6.
//!          Axes 2, 3, 4 parallel (x angle 1, y angle 5):
//!          h2 . R1^T p - h2 . R5 p56 = h2 . (p12 + p23 + p34 + p45),
//!          h2 . R1^T R h6 - h2 . R5 h6 = 0, then the angle 2 + 3 + 4 from one vector, and 2 and 3
//!          as the two links of a planar arm
//! Units    rad, m
//! Valid    as [`subproblems`](super::subproblems): up to eight candidates, one for each branch of
//!          shoulder, elbow and wrist, to be verified
//! Why so   angles from a vector nearly along their axis are individually ill-conditioned; the last
//!          angle is always computed from a vector perpendicular to its axis given all others, so
//!          that the sum is accurate even if neither angle is
//! Source   Elias & Wen 2025 (IK-Geo); Pieper 1968
//! Checked  tests/it/analytic/

use super::geometry::ArmParameters;
use super::subproblems::{Angle, EquationPair, Misses, across, coefficients, linear, onto};
use crate::spatial::{Mat3, Vec3};

/// A target pose, as rotation from zero and position, in the order in which the chain is read, and
/// the angles of the initial guess.
#[derive(Debug, Clone, Copy)]
pub(super) struct Target {
    pub(super) rotation: Mat3,
    pub(super) position: Vec3,
    pub(super) start: [f64; 6],
}

/// Calls `found` with the candidates; it returns whether one counts as a solution.
pub(super) fn meeting(
    g: &ArmParameters,
    aim: &Target,
    misses: &Misses,
    mut found: impl FnMut(&[Angle; 6]) -> bool,
) {
    let ArmParameters { h, p: [p01, p12, p23, p34, _, _, p6t], reach, .. } = *g;
    let start = aim.start;
    let p = aim.position - p01 - aim.rotation * p6t;
    let ([x1, x2], x_rest) = coefficients(h[1], -h[0], p);
    let ([y1, y2], y_rest) = coefficients(h[1], h[2], p34);
    let ([u1, u2], u_rest) = coefficients(p12, -h[0], p);
    let ([v1, v2], v_rest) = coefficients(p23, h[2], p34);
    let squares = p.dot(p) + p12.dot(p12) - p23.dot(p23) - p34.dot(p34);
    let pair = EquationPair {
        x: [[x1, x2], [u1, u2]],
        y: [[-y1, -y2], [v1, v2]],
        d: [h[1].dot(p12 + p23) - x_rest + y_rest, 0.5 * squares - u_rest - v_rest],
        scale: [reach, reach * reach],
        start: [start[0], start[2]],
    };
    let (wrist, wrist_rest) = coefficients(h[3], h[4], h[5]);
    let (pointing, sideways) = (aim.rotation * h[5], aim.rotation * g.side);
    pair.any(g.order, misses, |first, third| {
        let inner = p23 + third.of(h[2], p34);
        let outer = first.back(h[0], p) - p12;
        let (pointing, sideways) = (first.back(h[0], pointing), first.back(h[0], sideways));
        onto(h[1], inner, outer, reach, start[1]).any(|second| {
            let behind = |v| third.back(h[2], second.back(h[1], v));
            let (pointing, sideways) = (behind(pointing), behind(sideways));
            let fifths = linear(wrist, h[3].dot(pointing) - wrist_rest, 1.0, start[4]);
            misses.of_third([first, third], fifths).any(|fifth| {
                let from = fifth.of(h[4], h[5]);
                onto(h[3], from, pointing, 1.0, start[3]).any(|fourth| {
                    let seen = fifth.back(h[4], fourth.back(h[3], sideways));
                    let sixth = across(h[5], g.side, seen);
                    found(&[first, second, third, fourth, fifth, sixth])
                })
            })
        })
    });
}

/// The same for three parallel axes.
pub(super) fn parallel(
    g: &ArmParameters,
    aim: &Target,
    misses: &Misses,
    mut found: impl FnMut(&[Angle; 6]) -> bool,
) {
    let ArmParameters { h, p: [p01, p12, p23, p34, p45, p56, p6t], reach, .. } = *g;
    let (n, start) = (h[1], aim.start);
    let p = aim.position - p01 - aim.rotation * p6t;
    let (pointing, sideways) = (aim.rotation * h[5], aim.rotation * g.side);
    let ([x1, x2], x_rest) = coefficients(n, -h[0], p);
    let ([y1, y2], y_rest) = coefficients(n, h[4], p56);
    let ([u1, u2], u_rest) = coefficients(n, -h[0], pointing);
    let ([v1, v2], v_rest) = coefficients(n, h[4], h[5]);
    let pair = EquationPair {
        x: [[x1, x2], [u1, u2]],
        y: [[-y1, -y2], [-v1, -v2]],
        d: [n.dot(p12 + p23 + p34 + p45) - x_rest + y_rest, v_rest - u_rest],
        scale: [reach, 1.0],
        start: [start[0], start[4]],
    };
    // Both links are perpendicular to the parallel axes, to ALIGNED_AXES: the rest is its square.
    let (elbow, _) = coefficients(p23, n, p34);
    let links = p23.dot(p23) + p34.dot(p34);
    pair.any(g.order, misses, |first, fifth| {
        let shoulder = first.back(h[0], p) - p12;
        let mut arm = |whole: Angle, sixth: Angle| {
            let wrist = shoulder - whole.of(n, p45 + fifth.of(h[4], p56));
            let wrist = wrist - n * n.dot(wrist);
            let d = 0.5 * (wrist.dot(wrist) - links);
            let thirds = linear(elbow, d, reach * reach, start[2]);
            misses.of_third([first, fifth], thirds).any(|third| {
                let inner = p23 + third.of(n, p34);
                onto(n, inner, wrist, reach, start[1]).any(|second| {
                    let angle = whole.angle - second.angle - third.angle;
                    let fourth = Angle { angle, ..whole };
                    found(&[first, second, third, fourth, fifth, sixth])
                })
            })
        };
        let (pointing, sideways) = (first.back(h[0], pointing), first.back(h[0], sideways));
        let last = |whole: Angle| {
            let seen = fifth.back(h[4], whole.back(n, sideways));
            across(h[5], g.side, seen)
        };
        // The sum of the parallel angles; if only its sum with the last angle is determined, the
        // last is free.
        let wholes = onto(n, fifth.of(h[4], h[5]), pointing, 1.0, start[5]);
        let any = wholes.any(|turn| {
            if turn.free {
                let hand = turn.back(h[5], fifth.back(h[4], g.level));
                let seen = first.back(h[0], aim.rotation * hand);
                arm(across(n, g.level, seen), turn)
            } else {
                arm(turn, last(turn))
            }
        });
        if !any && wholes.is_free() {
            // The two links are too short or too long for those: the middle of their range.
            let level = |v: Vec3| v - n * n.dot(v);
            let (far, hand) = (level(shoulder), level(p45 + fifth.of(h[4], p56)));
            let range = |a: f64, b: f64| ((a - b).abs(), a + b);
            let (links, places) = (range(p23.norm(), p34.norm()), range(far.norm(), hand.norm()));
            let distance = 0.5 * (links.0.max(places.0) + links.1.min(places.1));
            let (amid, rest) = coefficients(far, n, hand);
            let squares = far.dot(far) + hand.dot(hand) - distance * distance;
            return linear(amid, 0.5 * squares - rest, reach * reach, 0.0)
                .any(|turn| arm(turn, Angle { free: true, ..last(turn) }));
        }
        any
    });
}
