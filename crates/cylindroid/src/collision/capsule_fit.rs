//! A small capsule around points.
//!
//! Formula  for an axis direction u: the smallest circle around the points seen along u gives axis and
//!          radius r; with t the height and d the distance from the axis, the ends of the segment are
//!          min (t + sqrt(r^2 - d^2)) and max (t - sqrt(r^2 - d^2)). The direction of least volume is
//!          found by pattern search from the three axes of the box and the principal axes
//! Units    m
//! Valid    any points; contains all of them to rounding, for which the radius is enlarged by 1e-12
//!          of itself
//! Why so   containment is exact for every direction, so that the search decides only about size; a
//!          fit by least squares would leave parts of the link outside
//! Source   smallest circle: Welzl 1991, in its move-to-front form
//! Checked  tests in this file

use crate::linalg::SymmetricEigen;
use crate::spatial::{Pose, Rotation, Vec3};
use crate::tolerance::{CAPSULE_ENLARGED, ZERO_AXIS};

/// A capsule along z of its pose.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Capsule {
    pub(super) pose: Pose,
    pub(super) half: f64,
    pub(super) radius: f64,
}

impl Capsule {
    fn volume(&self) -> f64 {
        let square = std::f64::consts::PI * self.radius * self.radius;
        square * (2.0 * self.half + 4.0 / 3.0 * self.radius)
    }
}

/// Halvings of the step of the pattern search (rad), from half a radian.
const HALVINGS: i32 = 16;

/// The smallest capsule that the search finds.
pub(super) fn around(points: &[Vec3]) -> Capsule {
    let mut best = along(points, Vec3::Z);
    let mut direction = Vec3::Z;
    let mut consider = |u: Vec3, direction: &mut Vec3| {
        let found = along(points, u);
        let better = found.volume() < best.volume();
        if better {
            (best, *direction) = (found, u);
        }
        better
    };
    for axis in [Vec3::X, Vec3::Y].into_iter().chain(principal_axes(points)) {
        consider(axis, &mut direction);
    }
    for halving in 1..=HALVINGS {
        let step = 0.5_f64.powi(halving);
        let mut rounds = 0;
        loop {
            let frame = Rotation::z_to(direction).unwrap_or_default();
            let mut moved = false;
            for across in [frame.x_axis(), -frame.x_axis(), frame.y_axis(), -frame.y_axis()] {
                if let Some(u) = (direction + across * step).unit(ZERO_AXIS) {
                    moved |= consider(u, &mut direction);
                }
            }
            rounds += 1;
            if !moved || rounds == 8 {
                break;
            }
        }
    }
    best
}

/// The eigenvectors of the covariance.
fn principal_axes(points: &[Vec3]) -> Vec<Vec3> {
    let count = points.len().max(1) as f64;
    let mean = points.iter().fold(Vec3::ZERO, |sum, p| sum + *p) * (1.0 / count);
    let mut covariance = [[0.0; 3]; 3];
    for p in points {
        let d = (*p - mean).to_array();
        for (row, x) in covariance.iter_mut().zip(d) {
            row.iter_mut().zip(d).for_each(|(entry, y)| *entry += x * y / count);
        }
    }
    let eigen = SymmetricEigen::of(covariance, 3);
    eigen.vectors.into_iter().filter_map(|v| Vec3::from_array(v).unit(ZERO_AXIS)).collect()
}

/// The capsule of least radius along a unit direction.
fn along(points: &[Vec3], u: Vec3) -> Capsule {
    let rotation = Rotation::z_to(u).unwrap_or_default();
    let local = |p: &Vec3| rotation.inverse() * *p;
    let flat: Vec<[f64; 2]> = points.iter().map(local).map(|p| [p.x, p.y]).collect();
    let ([x, y], radius) = smallest_circle(flat);
    let radius = radius * (1.0 + CAPSULE_ENLARGED);
    let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
    for p in points.iter().map(local) {
        let d = [p.x - x, p.y - y];
        let cap = (radius * radius - d[0] * d[0] - d[1] * d[1]).max(0.0).sqrt();
        (low, high) = (low.min(p.z + cap), high.max(p.z - cap));
    }
    // Where one ball is enough, the segment has no length.
    let half = (0.5 * (high - low)).max(0.0);
    let center = rotation * Vec3::new(x, y, 0.5 * (low + high));
    Capsule { pose: Pose { rotation, translation: center }, half, radius }
}

/// Centre and radius of the smallest circle around points.
fn smallest_circle(mut points: Vec<[f64; 2]>) -> ([f64; 2], f64) {
    type Circle = ([f64; 2], f64);
    let distance = |a: [f64; 2], b: [f64; 2]| (a[0] - b[0]).hypot(a[1] - b[1]);
    let outside = |c: Circle, p: [f64; 2]| distance(c.0, p) > c.1 * (1.0 + CAPSULE_ENLARGED);
    let of_two = |a: [f64; 2], b: [f64; 2]| {
        let center = [0.5 * (a[0] + b[0]), 0.5 * (a[1] + b[1])];
        (center, distance(center, a).max(distance(center, b)))
    };
    let of_three = |a: [f64; 2], b: [f64; 2], c: [f64; 2]| -> Option<Circle> {
        let (bx, by, cx, cy) = (b[0] - a[0], b[1] - a[1], c[0] - a[0], c[1] - a[1]);
        let twice = 2.0 * (bx * cy - by * cx);
        if twice == 0.0 {
            return None;
        }
        let (bb, cc) = (bx * bx + by * by, cx * cx + cy * cy);
        let center = [a[0] + (cy * bb - by * cc) / twice, a[1] + (bx * cc - cx * bb) / twice];
        let radius = [a, b, c].into_iter().map(|p| distance(center, p)).fold(0.0, f64::max);
        radius.is_finite().then_some((center, radius))
    };
    let Some(&first) = points.first() else { return ([0.0; 2], 0.0) };
    let mut circle = (first, 0.0);
    for i in 1..points.len() {
        let p = points[i];
        if !outside(circle, p) {
            continue;
        }
        circle = (p, 0.0);
        for j in 0..i {
            let q = points[j];
            if !outside(circle, q) {
                continue;
            }
            circle = of_two(p, q);
            for &r in &points[..j] {
                if outside(circle, r) {
                    circle = of_three(p, q, r).unwrap_or(circle);
                }
            }
        }
        points[..=i].rotate_right(1);
    }
    // Nearly collinear points cost digits: every point is inside in any case.
    let radius = points.iter().map(|p| distance(circle.0, *p)).fold(circle.1, f64::max);
    (circle.0, radius)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scalar::uniform;

    fn contains(capsule: &Capsule, p: Vec3) -> bool {
        let local = capsule.pose.inverse() * p;
        let nearest = crate::scalar::clamp(local.z, -capsule.half, capsule.half);
        (local - Vec3::Z * nearest).norm() <= capsule.radius * (1.0 + 1e-11)
    }

    #[test]
    fn a_sampled_capsule_is_found_again() {
        let mut seed = 3;
        let pose = Pose {
            rotation: Rotation::exp(Vec3::new(0.4, -0.9, 0.2)),
            translation: Vec3::new(0.3, 1.0, -2.0),
        };
        let mut points = Vec::new();
        while points.len() < 3000 {
            let d = Vec3::from_array(std::array::from_fn(|_| 2.0 * uniform(&mut seed) - 1.0));
            let side = if d.z < 0.0 { -0.25 } else { 0.25 };
            points.push(pose * (d * (0.07 / d.norm()) + Vec3::Z * side));
        }
        let found = around(&points);
        assert!(points.iter().all(|p| contains(&found, *p)));
        let exact = Capsule { pose, half: 0.25, radius: 0.07 };
        assert!(found.volume() < exact.volume() * 1.005, "{}", found.volume() / exact.volume());
    }

    #[test]
    fn few_and_flat_points() {
        let x = Vec3::X;
        for points in [vec![x], vec![x, x * 3.0], vec![x, Vec3::Y, Vec3::ZERO], vec![x, x, x]] {
            let found = around(&points);
            assert!(found.volume().is_finite() && found.radius >= 0.0);
            assert!(
                points.iter().all(|p| contains(&found, *p)
                    || (found.pose.inverse() * *p).norm() < 1e-12 + found.half)
            );
        }
    }

    /// Flights of stairs, along none of the axes from which the search starts: no direction beside
    /// the one that is found is better.
    #[test]
    fn directions_beside_that_of_the_search_are_no_better() {
        let mut seed = 11;
        let mut worst = 0.0_f64;
        for round in 0..200 {
            let turn = Rotation::exp(Vec3::from_array(std::array::from_fn(|_| {
                4.0 * uniform(&mut seed) - 2.0
            })));
            // Of unequal weight along the long side, so that the principal axes lean.
            let count = 6 + round % 20;
            let points: Vec<Vec3> = (0..count)
                .map(|_| {
                    let [x, y, z] = std::array::from_fn(|_| uniform(&mut seed));
                    turn * Vec3::new(x * x, 0.6 * y + 0.5 * x, 0.3 * z * z)
                })
                .collect();
            let found = around(&points);
            let axis = found.pose.rotation * Vec3::Z;
            let frame = Rotation::z_to(axis).unwrap();
            for k in 0..16 {
                let (sin, cos) = (f64::from(k) * std::f64::consts::TAU / 16.0).sin_cos();
                let across = frame.x_axis() * cos + frame.y_axis() * sin;
                let beside = along(&points, (axis + across * 1e-3).unit(ZERO_AXIS).unwrap());
                worst = worst.max(1.0 - beside.volume() / found.volume());
            }
        }
        assert!(worst < 1e-3, "{worst}");
    }
}
