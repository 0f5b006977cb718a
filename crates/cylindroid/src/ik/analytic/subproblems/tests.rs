//! Roots of quartics, turns that are known.

use std::f64::consts::{FRAC_PI_2, PI};

use super::{EquationPair, Misses, Order, linear, onto, real_roots};
use crate::scalar::{nearest_turn, uniform};
use crate::spatial::{Rotation, Vec3};

#[test]
fn roots_are_found() {
    // Roots of (t - a)(t - b)(t - c)(t - d), including double roots.
    let mut worst: f64 = 0.0;
    for [a, b, c, d] in [
        [-2.0, -0.5, 0.25, 3.0],
        [1.0, 1.0, -1.0, 2.0],
        [0.0, 0.0, 0.0, 1.0],
        [0.3, 0.3, -0.7, -0.7],
    ] {
        let mut p = [1.0, 0.0, 0.0, 0.0, 0.0];
        for (n, root) in [a, b, c, d].into_iter().enumerate() {
            for k in (0..=n + 1).rev() {
                p[k] = if k > 0 { p[k - 1] } else { 0.0 } - root * p[k];
            }
        }
        let mut found = Vec::new();
        real_roots(p, |t| found.push(t));
        for root in [a, b, c, d] {
            let near = found.iter().map(|t| (t - root).abs()).fold(1.0, f64::min);
            assert!(near < 1e-5, "{root} in {found:?}");
        }
        for t in found {
            let near = [a, b, c, d].map(|r| (t - r).abs()).into_iter().fold(1.0, f64::min);
            worst = worst.max(near);
        }
    }
    assert!(worst < 1e-4, "{worst}");
    let mut none = 0;
    real_roots([1.0, 0.0, 1.0, 0.0, 1.0], |_| none += 1);
    assert_eq!(none, 0);
    real_roots([f64::NAN, 0.0, 1.0, 0.0, 1.0], |_| none += 1);
    assert_eq!(none, 0);
}

/// The remainder at a double root is a rounding, compared with the size of the terms.
#[test]
fn double_roots_are_found_wherever_they_are() {
    let mut state = 7_u64;
    let mut random = || 6.0 * uniform(&mut state) - 3.0;
    for _ in 0..2000 {
        // (t - r)^2 ((t - s)^2 + h^2)
        let (r, s, h) = (random(), random(), 1.0 + random().abs());
        let (double, rest) = ([r * r, -2.0 * r, 1.0], [s * s + h * h, -2.0 * s, 1.0]);
        let mut p = [0.0; 5];
        for (i, a) in double.iter().enumerate() {
            rest.iter().enumerate().for_each(|(j, b)| p[i + j] += a * b);
        }
        let mut found = Vec::new();
        real_roots(p, |t| found.push(t));
        let near = found.iter().map(|t| (t - r).abs()).fold(1.0, f64::min);
        assert!(near < 1e-5, "{r} in {found:?}, with {s} and {h}");
    }
}

/// Free angles are reported, infeasible ones are not found.
#[test]
fn conditions_on_one_turn() {
    let of = |ab: [f64; 2], c: f64| {
        let mut all = Vec::new();
        linear(ab, c, 1.0, 0.7).any(|t| {
            all.push((t.angle, t.free));
            false
        });
        all
    };
    let free = of([0.0, 0.0], 0.0);
    assert!(free.len() == 8 && free[0] == (0.7, true) && free.iter().all(|f| f.1));
    assert!(of([0.0, 0.0], 0.1).is_empty());
    assert!(of([1.0, 0.0], 1.1).is_empty());
    assert_eq!(of([1.0, 0.0], 1.0), [(0.0, false)]);
    let two = of([3.0, 4.0], 2.0);
    assert_eq!(two.len(), 2);
    for (angle, _) in two {
        assert!((3.0 * angle.cos() + 4.0 * angle.sin() - 2.0).abs() < 1e-14);
    }
}

/// A known pair of angles is recovered for every order.
#[test]
fn conditions_on_two_turns() {
    let mut state = 5_u64;
    let mut random = || 2.0 * uniform(&mut state) - 1.0;
    for i in 0..3000 {
        let mut pair = EquationPair {
            x: [[random(), random()], [random(), random()]],
            y: [[random(), random()], [random(), random()]],
            d: [0.0; 2],
            scale: [1.0; 2],
            start: [0.0; 2],
        };
        let order = [Order::FirstX(0), Order::FirstY(1), Order::Together][i % 3];
        match order {
            Order::FirstX(i) => pair.y[i] = [0.0; 2],
            Order::FirstY(i) => pair.x[i] = [0.0; 2],
            Order::Together => {}
        }
        let (a, b) = (3.0 * random(), 3.0 * random());
        let dot = |v: [f64; 2], q: f64| v[0] * q.cos() + v[1] * q.sin();
        pair.d = [0, 1].map(|i: usize| dot(pair.x[i], a) + dot(pair.y[i], b));
        let mut near: f64 = 9.0;
        pair.any(order, &Misses::default(), |first, second| {
            near = near.min((first.angle - a).abs() + (second.angle - b).abs());
            false
        });
        assert!(near < 1e-5, "{order:?}: {near} {pair:?}");
    }
}

/// Turns by right angles are found as others are, where a sine or a cosine is exactly 0 or 1.
#[test]
fn a_turn_maps_a_vector_onto_another() {
    let mut state = 11_u64;
    let mut random = || 2.0 * uniform(&mut state) - 1.0;
    let right = [0.0, 1.0, 2.0, -1.0].map(|quarters| quarters * FRAC_PI_2);
    let others = [0; 20].map(|_| 3.0 * random());
    for turn in right.into_iter().chain(others) {
        for (axis, vector) in
            [(Vec3::Z, Vec3::X), (Vec3::X, Vec3::Y), (Vec3::Y, Vec3::new(1.0, 0.5, 0.0))]
        {
            let image = match turn {
                0.0 => vector,
                _ => Rotation::about(axis, turn).unwrap() * vector,
            };
            let mut found = Vec::new();
            onto(axis, vector, image, 1.0, 0.7).any(|angle| {
                found.push((angle.angle, angle.free));
                false
            });
            assert_eq!(found.len(), 1, "{turn}: {found:?}");
            let apart = nearest_turn(found[0].0 - turn, 0.0);
            assert!(apart.abs() < 1e-14 && !found[0].1, "{turn}: {found:?}");
        }
    }
    // Exactly, without a rounding.
    for (image, turn) in [(Vec3::X, 0.0), (Vec3::Y, 0.5), (-Vec3::X, 1.0), (-Vec3::Y, -0.5)] {
        let mut found = Vec::new();
        onto(Vec3::Z, Vec3::X, image, 1.0, 0.7).any(|angle| {
            found.push(angle.angle);
            false
        });
        assert_eq!(found.len(), 1, "{image:?}: {found:?}");
        let apart = nearest_turn(found[0] - PI * turn, 0.0);
        assert!(apart.abs() < 1e-14, "{image:?}: {found:?}");
    }
}
