//! The depth of curved cores, from where an expanding polytope left it, and its points.
//!
//! Formula  depth = min over unit n of h(n) = n . s(n), s(n) the support point of the difference.
//!          Newton's method on the sphere: gradient g = s - h n, Hessian ds/dn - h 1 across n, by
//!          differences of support points; along -g where it is not positive. Only steps that
//!          decrease h are taken
//! Units    those of the difference
//! Valid    a local minimum; where h has edges, of cylinders and polytopes, it may end early, but
//!          never above the start
//! Fails    never
//! Source   Absil, Mahony & Sepulchre 2008 (Newton's method on manifolds)
//! Checked  tests/collision/ellipsoids.rs

use super::simplex::{Simplex, Vertex};
use crate::spatial::Vec3;
use crate::tolerance::{GJK_GAP, ZERO_SEPARATION};

/// Newton steps at most.
const STEPS: usize = 30;

/// Halvings of a step at most.
const HALVINGS: usize = 30;

/// Longest step (rad).
const LONGEST: f64 = 0.5;

/// Step of the differences of support points (rad).
const DIFFERENCE: f64 = 1e-5;

/// Steps to the nearest combination at most.
const MAX_MIXED: usize = 128;

/// A direction of least extent near a unit direction, and that extent.
pub(super) fn least_extent(mut support: impl FnMut(Vec3) -> Vec3, start: Vec3) -> (Vec3, f64) {
    let mut n = start;
    let mut s = support(n);
    for _ in 0..STEPS {
        let h = n.dot(s);
        let gradient = s - n * h;
        if !(gradient.norm() > GJK_GAP) {
            break;
        }
        let Some((newton, plain)) = steps(&mut support, n, gradient, h) else { break };
        let mut lower = |step: Vec3| {
            let longest = (LONGEST / step.norm()).min(1.0);
            (0..HALVINGS).find_map(|i| {
                let next = (n + step * (longest * 0.5_f64.powi(i as i32))).unit(ZERO_SEPARATION)?;
                let point = support(next);
                (next.dot(point) < h).then_some((next, point))
            })
        };
        let found = newton.and_then(&mut lower).or_else(|| lower(plain));
        let Some(next) = found else { break };
        (n, s) = next;
    }
    (n, n.dot(s))
}

/// Newton's step, if there is one, and one along the gradient, tangential to a unit direction.
fn steps(
    support: &mut impl FnMut(Vec3) -> Vec3,
    n: Vec3,
    gradient: Vec3,
    h: f64,
) -> Option<(Option<Vec3>, Vec3)> {
    let along = gradient.unit(f64::MIN_POSITIVE)?;
    let across = n.cross(along);
    let mut derivative =
        |e: Vec3| (support(n + e * DIFFERENCE) - support(n - e * DIFFERENCE)) * (0.5 / DIFFERENCE);
    let (first, second) = (derivative(along), derivative(across));
    let (a, c) = (along.dot(first) - h, across.dot(second) - h);
    let b = 0.5 * (along.dot(second) + across.dot(first));
    let determinant = a * c - b * b;
    let size = gradient.norm();
    let newton = (a > 0.0 && determinant > 0.0)
        .then(|| (along * -c + across * b) * (size / determinant))
        .filter(|step| step.is_finite() && step.norm() > 0.0);
    let plain = gradient * (-1.0 / (a.abs().max(c.abs()) + b.abs()).max(size));
    Some((newton, plain))
}

/// The points of a and b whose difference, a convex combination of vertices, is nearest to a target;
/// `None` without vertices.
pub(super) fn mixed(vertices: &[Vertex], target: Vec3) -> Option<(Vec3, Vec3)> {
    let moved = |v: &Vertex| Vertex { point: v.point - target, ..*v };
    let moved: Vec<Vertex> = vertices.iter().map(moved).collect();
    let least = |d: Vec3| {
        let all = moved.iter().copied();
        all.min_by(|a, b| a.point.dot(d).total_cmp(&b.point.dot(d)))
    };
    let all = moved.iter().copied();
    let first = all.min_by(|a, b| a.point.norm().total_cmp(&b.point.norm()))?;
    let mut simplex = Simplex::new(first);
    let mut nearest = first.point;
    let mut witnesses = simplex.witnesses();
    for _ in 0..MAX_MIXED {
        let distance = nearest.norm();
        let Some(next) = least(nearest).filter(|_| distance > 0.0) else { break };
        if nearest.dot(next.point) >= distance * (distance - GJK_GAP)
            || simplex.contains(next.point)
        {
            break;
        }
        match simplex.add(next) {
            Some(point) if point.norm() < distance => nearest = point,
            _ => break,
        }
        witnesses = simplex.witnesses();
    }
    Some(witnesses)
}
