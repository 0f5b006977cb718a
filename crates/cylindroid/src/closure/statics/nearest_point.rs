//! The point of a convex body nearest to the origin, from the body's farthest points along directions.
//!
//! Formula  x = the nearest point of conv{p_i}, the points p_i found so far; the next one is farthest
//!          along -x. The distance is at most |x| and at least min p . x / |x|
//! Shapes   x, p_i: d entries
//! Units    those of the body
//! Valid    any convex body; few points carry x at a time, at most d + 1
//! Why so   a hull has no facet between the origin and the nearest point where that is a corner
//! Source   Wolfe 1976
//! Checked  tests in this file, tests/it/closure/open_grasps.rs

use super::smallest_support::Vector;
use crate::error::all_finite;
use crate::linalg::{Matrix, Qr, dot, norm, solve_upper};
use crate::tolerance::HULL;

/// Maximum number of points that are asked for.
const MAX_POINTS: usize = 2000;

/// The distance of a body from the origin.
#[derive(Debug, Clone, Copy)]
pub(super) struct NearestPoint {
    /// The nearest point found, whose norm is an upper bound of the distance.
    pub(super) point: Vector,
    /// Lower bound of the distance.
    pub(super) lower: f64,
    /// The unit direction along which the body is at least that far from the origin, on its other side.
    pub(super) away: Vector,
}

/// Of the body with these farthest points along directions, whose entries beyond `d` are zero; its size
/// is the largest norm of its points. The search ends when both bounds agree to [`HULL`] of it.
pub(super) fn nearest_point(
    d: usize,
    size: f64,
    farthest: impl Fn(&Vector) -> Vector,
) -> NearestPoint {
    let mut points = vec![farthest(&[1.0, 0.0, 0.0, 0.0, 0.0, 0.0])];
    let mut weights = vec![1.0];
    let mut found = NearestPoint { point: points[0], lower: 0.0, away: [0.0; 6] };
    for _ in 0..MAX_POINTS {
        let x = found.point;
        let distance = norm(&x);
        if !(distance > HULL * size) {
            break;
        }
        let away = x.map(|x| -x / distance);
        let next = farthest(&away);
        let least = -dot(&next, &away);
        if least > found.lower {
            (found.lower, found.away) = (least, away);
        }
        if !(distance - least > HULL * size) {
            break;
        }
        points.push(next);
        weights.push(0.0);
        if !settle(d, &mut points, &mut weights) {
            break;
        }
        let sum = combined(&points, &weights);
        if !(norm(&sum) < distance) {
            break;
        }
        found.point = sum;
    }
    found.lower = found.lower.min(norm(&found.point));
    found
}

fn combined(points: &[Vector], weights: &[f64]) -> Vector {
    std::array::from_fn(|i| points.iter().zip(weights).map(|(p, w)| w * p[i]).sum())
}

/// Moves the weights to the nearest point of the hull of the points, without those that do not carry
/// it; false where rounding leaves no answer.
fn settle(d: usize, points: &mut Vec<Vector>, weights: &mut Vec<f64>) -> bool {
    while points.len() > 1 {
        if points.len() > d + 1 {
            return false;
        }
        // The nearest point of the affine span: p_0 + D b.
        let (first, sides) = (points[0], points.len() - 1);
        let qr = Qr::plain(Matrix::from_fn(d, sides, |i, j| points[j + 1][i] - first[i]));
        let mut rest: Vec<f64> = first[..d].iter().map(|x| -x).collect();
        qr.apply_transposed(&mut rest);
        let shares = solve_upper(&qr.r(), &rest[..sides]);
        let mut goal = vec![1.0 - shares.iter().sum::<f64>()];
        goal.extend(shares);
        if !all_finite(&goal) {
            return false;
        }
        // As far as no weight is negative.
        let step =
            |i: usize| if weights[i] > 0.0 { weights[i] / (weights[i] - goal[i]) } else { 0.0 };
        let limits = (0..goal.len()).filter(|&i| goal[i] <= 0.0).map(|i| (step(i), i));
        let Some((step, i)) = limits.min_by(|a, b| a.0.total_cmp(&b.0)) else {
            *weights = goal;
            return true;
        };
        weights.iter_mut().zip(&goal).for_each(|(w, g)| *w = (*w + step * (g - *w)).max(0.0));
        weights.remove(i);
        points.remove(i);
    }
    *weights = vec![1.0];
    true
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scalar::uniform;

    /// A ball, and the hull of points: the farthest one along a direction.
    #[test]
    fn balls_and_corners() {
        let mut random = 17;
        for d in 2..=6 {
            for _ in 0..20 {
                let mut center = [0.0; 6];
                center[..d].fill_with(|| 4.0 * uniform(&mut random) - 2.0);
                let far = norm(&center);
                let radius = 0.5 * far;
                let ball = |n: &Vector| -> Vector {
                    std::array::from_fn(|i| center[i] + radius * n[i] / norm(n))
                };
                let found = nearest_point(d, far, ball);
                let distance = far - radius;
                assert!((norm(&found.point) - distance).abs() < 1e-8 * far, "{d}: {found:?}");
                assert!(found.lower <= distance + 1e-15 && found.lower > distance - 1e-8 * far);
                // Around the origin: no distance.
                let around = |n: &Vector| -> Vector {
                    std::array::from_fn(|i| center[i] + 2.0 * far * n[i] / norm(n))
                };
                let none = nearest_point(d, far, around);
                assert!(norm(&none.point) < 1e-8 * far && none.lower == 0.0, "{d}: {none:?}");
            }
        }
        let nearest = |corners: &[Vector]| {
            nearest_point(3, 2.0, |n| {
                let best = corners.iter().max_by(|a, b| dot(*a, n).total_cmp(&dot(*b, n)));
                *best.unwrap()
            })
        };
        let corner = |x, y, z| [x, y, z, 0.0, 0.0, 0.0];
        // A corner, an edge, a side; flat sets.
        let apex = nearest(&[corner(1.0, 0.0, 1.0), corner(1.0, 0.0, 2.0)]);
        assert!((norm(&apex.point) - 2.0_f64.sqrt()).abs() < 1e-15, "{apex:?}");
        let edge = nearest(&[corner(1.0, -1.0, 0.0), corner(1.0, 2.0, 0.0), corner(3.0, 0.0, 0.0)]);
        let off: Vector = std::array::from_fn(|i| edge.point[i] - corner(1.0, 0.0, 0.0)[i]);
        assert!(norm(&off) < 1e-15, "{edge:?}");
        let side = [corner(1.0, 0.0, 0.0), corner(0.0, 1.0, 0.0), corner(0.0, 0.0, 1.0)];
        let side = nearest(&side);
        assert!((norm(&side.point) - 3.0_f64.sqrt().recip()).abs() < 1e-15, "{side:?}");
        assert!((side.lower - 3.0_f64.sqrt().recip()).abs() < 1e-15, "{side:?}");
    }
}
