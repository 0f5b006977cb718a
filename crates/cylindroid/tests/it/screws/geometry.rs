//! Screws, lines, common normals and transversals.

use std::f64::consts::PI;

use cylindroid::screws::{CommonNormal, Line, Screw};
use cylindroid::spatial::{Pose, Rotation, Twist, Vec3};

use crate::support::Random;

fn line(random: &mut Random, far: f64) -> Line {
    Line::through(random.vec3(far), random.vec3(1.0)).unwrap()
}

fn moved(pose: Pose, l: &Line) -> Line {
    Line { point: pose * l.point, direction: pose.rotation * l.direction }
}

#[track_caller]
fn assert_near(got: Vec3, expected: Vec3, tolerance: f64) {
    let distance = (got - expected).norm();
    assert!(distance <= tolerance, "{got:?} instead of {expected:?}: {distance:.1e}");
}

#[test]
fn a_twist_is_its_screw() {
    let mut random = Random(1);
    for size in [1.0, 1e-150, 1e150] {
        // Angular parts from ordinary to the edge of a translation, axes from near to far.
        for turn in [1.0, 1e-6, 1e-12, 1e-100, 1e6, 1e100] {
            for _ in 0..20 {
                let t = random.twist() * size;
                let t = Twist { angular: t.angular * turn, ..t };
                let screw = Screw::of(t).unwrap();
                assert!((screw.axis.direction.norm() - 1.0).abs() < 1e-15);
                assert!(!screw.is_translation() && screw.amplitude > 0.0);
                let near = screw.axis.point.dot(screw.axis.direction);
                assert!(near.abs() <= 1e-15 * screw.axis.point.norm(), "nearest to the origin");
                let back = screw.twist() - t;
                assert!(back.linear.norm() <= 1e-15 * t.linear.norm(), "{t:?} {back:?}");
                assert!(back.angular.norm() <= 1e-15 * t.angular.norm(), "{t:?} {back:?}");
            }
        }
    }
}

#[test]
fn a_screw_is_its_twist() {
    let mut random = Random(2);
    for far in [0.0, 1.0, 1e6, 1e12] {
        for _ in 0..100 {
            let axis = line(&mut random, far);
            let axis = Line { point: axis.nearest(Vec3::ZERO), ..axis };
            let (pitch, amplitude) = (random.within(-2.0, 2.0), random.within(1e-3, 1e3));
            let screw = Screw { axis, pitch, amplitude };
            let found = Screw::of(screw.twist()).unwrap();
            assert_near(found.axis.direction, axis.direction, 1e-15);
            assert_near(found.axis.point, axis.point, 1e-15 * (2.0 + far));
            // w . v of a moment arm of this length.
            assert!((found.pitch - pitch).abs() <= 1e-15 * (4.0 + far), "{far}");
            assert!((found.amplitude - amplitude).abs() <= 1e-15 * amplitude);
        }
    }
}

#[test]
fn a_translation_has_no_place() {
    for size in [1.0, 1e-320, 1e-150, 1e150, 5e307] {
        let t = Twist { linear: Vec3::new(0.0, -size, 0.0), angular: Vec3::ZERO };
        let screw = Screw::of(t).unwrap();
        assert!(screw.is_translation());
        assert_eq!((screw.axis.point, screw.axis.direction), (Vec3::ZERO, -Vec3::Y));
        assert_eq!((screw.amplitude, screw.twist()), (size, t));
    }
}

#[test]
fn the_edge_of_the_numbers() {
    assert_eq!(Screw::of(Twist::ZERO), None);
    for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        for i in 0..6 {
            let mut t = [1.0; 6];
            t[i] = bad;
            assert_eq!(Screw::of(Twist::from_array(t)), None);
        }
    }
    // A rotation of a size that has no inverse, and an axis beyond the largest number.
    let t = Twist { linear: Vec3::ZERO, angular: Vec3::Z * 1e-320 };
    let screw = Screw::of(t).unwrap();
    assert_eq!((screw.axis.direction, screw.pitch, screw.twist()), (Vec3::Z, 0.0, t));
    let t = Twist { linear: Vec3::X, angular: Vec3::Z * 1e-320 };
    let screw = Screw::of(t).unwrap();
    assert!(screw.is_translation());
    assert_eq!(screw.twist().linear, t.linear);
    // Of the axis and the pitch one alone is beyond it.
    let (across, along) = (Vec3::new(1.0, -1.0, 0.0), Vec3::new(1.0, 1.0, 0.0));
    for linear in [across, along] {
        let t = Twist { linear: linear * 1e308, angular: along * 0.4 };
        let screw = Screw::of(t).unwrap();
        assert!(screw.is_translation() && screw.axis.point == Vec3::ZERO, "{screw:?}");
        let off = (screw.twist().linear - t.linear).norm();
        assert!(off <= 1e-15 * t.linear.norm(), "{screw:?}");
    }
}

/// What a common normal is, whatever computes it.
#[track_caller]
fn assert_normal(a: &Line, b: &Line, n: &CommonNormal, tolerance: f64) {
    assert!((n.direction.norm() - 1.0).abs() < 1e-14);
    assert!(n.distance >= 0.0 && n.angle > -PI && n.angle <= PI);
    assert_near(a.nearest(n.from), n.from, tolerance);
    assert_near(b.nearest(n.to), n.to, tolerance);
    assert_near(n.to - n.from, n.direction * n.distance, tolerance);
    // Across both to the angle that rounding leaves.
    assert!(n.direction.dot(a.direction).abs() < 1e-9, "{n:?}");
    assert!(n.direction.dot(b.direction).abs() < 1e-9, "{n:?}");
    let turned = Rotation::about(n.direction, n.angle).unwrap() * a.direction;
    assert_near(turned, b.direction, 1e-9);
}

/// Two lines at a given distance and angle, in a random frame.
fn pair(random: &mut Random, distance: f64, angle: f64, far: f64) -> (Line, Line) {
    let pose = Pose { rotation: random.rotation(), translation: random.vec3(far) };
    let b = Line {
        point: Vec3::X * distance,
        direction: Rotation::about(Vec3::X, angle).unwrap() * Vec3::Z,
    };
    let a = Line { point: Vec3::ZERO, direction: Vec3::Z };
    let slide = |l: Line, by: f64| Line { point: l.point + l.direction * by, ..l };
    let (a, b) = (slide(a, random.within(-3.0, 3.0)), slide(b, random.within(-3.0, 3.0)));
    (moved(pose, &a), moved(pose, &b))
}

#[test]
fn common_normal_of_skew_lines() {
    let mut random = Random(3);
    for far in [1.0, 1e4] {
        for distance in [0.0, 1e-6, 1.0, 100.0] {
            for angle in [0.5 * PI, 1.0, -2.0, 3.0, 1e-4, -1e-4, PI - 1e-4] {
                for _ in 0..10 {
                    let (a, b) = pair(&mut random, distance, angle, far);
                    let n = a.common_normal(&b);
                    // The normal turns by the rounding over the sine, its feet run along the lines
                    // by that times the distance over the sine.
                    let sine = f64::sin(angle).abs();
                    let rounding = 1e-14 * (1.0 + far + distance / sine) / sine;
                    assert_normal(&a, &b, &n, rounding);
                    assert!(n.unique);
                    assert!((n.distance - distance).abs() <= rounding, "{n:?}");
                    let sign = if distance > 0.0 { 1.0 } else { n.angle.signum() * angle.signum() };
                    assert!((n.angle - sign * angle).abs() < 1e-9, "{angle} {n:?}");
                    // Seen from the other line: the same segment, the same angle.
                    let back = b.common_normal(&a);
                    assert_near(back.from, n.to, rounding);
                    assert_near(back.to, n.from, rounding);
                    // Seen from another frame.
                    let pose = random.pose();
                    let m = moved(pose, &a).common_normal(&moved(pose, &b));
                    assert_near(m.from, pose * n.from, rounding);
                    assert_near(m.to, pose * n.to, rounding);
                    if distance > 0.1 {
                        assert!((back.angle - n.angle).abs() < 1e-9);
                        assert!((m.angle - n.angle).abs() < 1e-9);
                    }
                }
            }
        }
    }
}

#[test]
fn common_normal_of_parallel_lines() {
    let mut random = Random(4);
    for distance in [0.0, 1e-10, 1e-6, 1.0, 1e3] {
        for angle in [0.0, PI] {
            for _ in 0..30 {
                let (a, b) = pair(&mut random, distance, angle, 1.0);
                let n = a.common_normal(&b);
                let rounding = 1e-14 * (1.0 + distance);
                assert_normal(&a, &b, &n, rounding);
                assert!(!n.unique);
                assert_eq!(n.from, a.point);
                assert!((n.distance - distance).abs() <= rounding, "{n:?}");
                assert_eq!(n.angle, angle);
            }
        }
    }
    let z = Line { point: Vec3::ZERO, direction: Vec3::Z };
    let n = z.common_normal(&z);
    assert_eq!((n.from, n.to, n.distance, n.angle), (Vec3::ZERO, Vec3::ZERO, 0.0, 0.0));
    assert_eq!(n.direction.dot(Vec3::Z), 0.0);
}

#[test]
fn lines_need_a_direction() {
    assert_eq!(Line::through(Vec3::ZERO, Vec3::ZERO), None);
    assert_eq!(Line::through(Vec3::X * f64::NAN, Vec3::X), None);
    assert_eq!(Line::through(Vec3::X, Vec3::X * f64::INFINITY), None);
    let l = Line::through(Vec3::X, Vec3::Y * 1e100).unwrap();
    assert_eq!(l.direction, Vec3::Y);
    assert_eq!(Line::through(Vec3::X * 1e100, Vec3::Y).unwrap().twist().klein(l.twist()), 0.0);
}

/// Two lines meet iff their twists are reciprocal.
#[test]
fn a_transversal_meets_both_lines() {
    let mut random = Random(5);
    for _ in 0..300 {
        let (a, b, p) = (line(&mut random, 1.0), line(&mut random, 1.0), random.vec3(1.0));
        let t = Line::transversal_through(p, &a, &b).unwrap();
        assert_near(t.nearest(p), p, 1e-15);
        for l in [&a, &b] {
            assert!(t.twist().klein(l.twist()).abs() < 1e-13);
            let n = t.common_normal(l);
            assert!(n.distance < 1e-13 && n.unique, "{n:?}");
        }
        // Through two points of the lines there is no choice.
        let (on_a, on_b) = (a.point + a.direction, b.point - b.direction);
        let middle = (on_a + on_b) * 0.5;
        let t = Line::transversal_through(middle, &a, &b).unwrap();
        let through = (on_b - on_a).unit(0.0).unwrap();
        assert!(t.direction.cross(through).norm() < 1e-10);
    }
}

#[test]
fn a_transversal_that_is_not_determined() {
    let x = Line { point: Vec3::ZERO, direction: Vec3::X };
    let y = Line { point: Vec3::Z, direction: Vec3::Y };
    assert_eq!(Line::transversal_through(Vec3::X * 3.0, &x, &y), None, "on a line");
    let crossing = Line { point: Vec3::ZERO, direction: Vec3::Y };
    let in_plane = Vec3::new(1.0, 2.0, 0.0);
    assert_eq!(Line::transversal_through(in_plane, &x, &crossing), None, "in their plane");
    // Parallel to one of the two: met at infinity.
    let t = Line::transversal_through(Vec3::new(0.0, 0.0, 2.0), &x, &Line { point: Vec3::Z, ..y });
    assert_eq!(t.unwrap().direction.cross(Vec3::Z), Vec3::ZERO);
    let t = Line::transversal_through(Vec3::Z, &x, &Line { point: Vec3::Y + Vec3::Z * 2.0, ..x });
    assert_eq!(t.unwrap().direction.cross(Vec3::X), Vec3::ZERO);
}
