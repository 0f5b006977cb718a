//! `control::CartesianPath`: ends, derivatives, half turns, circles, deviation, bad input.

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use cylindroid::control::{AxisRotation, CartesianPath};
use cylindroid::{Error, Pose, Rotation, Twist, Vec3};
use proptest::prelude::*;

fn vector(size: f64) -> impl Strategy<Value = Vec3> {
    let range = -size..size;
    (range.clone(), range.clone(), range).prop_map(|(x, y, z)| Vec3::new(x, y, z))
}

fn any_pose() -> impl Strategy<Value = Pose> {
    (vector(1.8), vector(2.0))
        .prop_map(|(r, translation)| Pose { rotation: Rotation::exp(r), translation })
}

fn any_path() -> impl Strategy<Value = CartesianPath> {
    let line = (any_pose(), any_pose()).prop_map(|(a, b)| CartesianPath::line(a, b).unwrap());
    let circle = (any_pose(), vector(2.0), any_pose())
        .prop_filter_map("collinear", |(a, via, b)| CartesianPath::circle(a, via, b).ok());
    let turn = (any_pose(), vector(2.0), vector(1.0), -9.0..9.0).prop_map(
        |(from, centre, axis, angle)| {
            CartesianPath::rotation(from, AxisRotation { centre, axis, angle }).unwrap()
        },
    );
    prop_oneof![line, circle, turn]
}

fn close(a: Pose, b: Pose, tolerance: f64) -> bool {
    let error = a.error_to(b);
    error.linear.norm() <= tolerance && error.angular.norm() <= tolerance
}

/// The central difference of the pose: world axes, at the moving origin.
fn difference(path: &CartesianPath, s: f64, step: f64) -> Twist {
    path.pose(s - step).error_to(path.pose(s + step)) * (0.5 / step)
}

/// Distance to a path by trying many places.
fn brute_distance(path: &CartesianPath, p: Vec3) -> f64 {
    (0..=4000)
        .map(|i| (path.pose(f64::from(i) / 4000.0).translation - p).norm())
        .fold(f64::INFINITY, f64::min)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(1000))]

    #[test]
    fn line_is_straight_between_its_exact_ends(a in any_pose(), b in any_pose(), s in 0.0..1.0) {
        let path = CartesianPath::line(a, b).unwrap();
        for early in [0.0, -1.0, f64::NAN] {
            prop_assert_eq!(path.pose(early), a);
        }
        prop_assert_eq!(path.pose(1.0), b);
        prop_assert_eq!(path.pose(2.0), b);
        prop_assert!(close(path.pose(1.0 - f64::EPSILON), b, 1e-14));
        let d = b.translation - a.translation;
        let expected = a.translation + d * s;
        prop_assert!((path.pose(s).translation - expected).norm() < 1e-15 * 8.0);
        prop_assert_eq!(path.length(), d.norm());
        let angle = a.rotation.angle_to(b.rotation);
        prop_assert!((path.angle() - angle).abs() < 1e-14);
        let turned = a.rotation.angle_to(path.pose(s).rotation);
        prop_assert!((turned - s * angle).abs() < 1e-14, "{turned} {angle}");
    }

    #[test]
    fn derivative_is_that_of_the_pose(path in any_path(), s in 0.01..0.99) {
        let exact = path.derivative(s);
        // Two steps and their extrapolation: error of order step^4.
        let (coarse, fine) = (difference(&path, s, 2e-3), difference(&path, s, 1e-3));
        let error = (fine * 4.0 - coarse) * (1.0 / 3.0) - exact;
        let scale = 1.0 + path.length() + path.angle();
        prop_assert!(error.linear.norm() < 1e-8 * scale, "{error:?}");
        prop_assert!(error.angular.norm() < 1e-8 * scale, "{error:?}");
        prop_assert!((exact.linear.norm() - path.length()).abs() < 1e-12 * scale);
        prop_assert!((exact.angular.norm() - path.angle()).abs() < 1e-12 * scale);
    }

    #[test]
    fn circle_keeps_its_radius_and_meets_its_points(a in any_pose(), via in vector(2.0),
            b in any_pose(), s in 0.0..1.0) {
        let Ok(path) = CartesianPath::circle(a, via, b) else { return Ok(()) };
        let r = path.radius();
        prop_assume!(r < 100.0);
        prop_assert_eq!(path.pose(0.0), a);
        prop_assert_eq!(path.pose(1.0), b);
        prop_assert!(close(path.pose(1.0 - 1e-16), b, 1e-12 * (1.0 + r)));
        // A quarter turn on, the derivative points from the start to the centre.
        let phi = path.length() / r;
        let centre = a.translation + path.derivative(0.5 * PI / phi).linear * (1.0 / phi);
        if 0.5 * PI < phi {
            let distance = (path.pose(s).translation - centre).norm();
            prop_assert!((distance - r).abs() < 1e-12 * (1.0 + r), "{distance} {r}");
        }
        let at_via = path.deviation(Pose { translation: via, ..a });
        prop_assert!(at_via.position < 1e-12 * (1.0 + r), "{at_via:?}");
        prop_assert!(at_via.s > 0.0 && at_via.s < 1.0, "{at_via:?}");
        // Planar: every chord is normal to the axis.
        let normal = (via - a.translation).cross(b.translation - a.translation);
        let chord = path.pose(s).translation - a.translation;
        prop_assert!(chord.dot(normal).abs() < 1e-12 * (1.0 + r) * normal.norm().max(1e-3));
    }

    #[test]
    fn turn_is_the_rotation_about_its_line(from in any_pose(), centre in vector(2.0),
            axis in vector(1.0), angle in -20.0..20.0_f64, s in 0.0..=1.0) {
        let path = CartesianPath::rotation(from, AxisRotation { centre, axis, angle }).unwrap();
        let step = Rotation::about(axis, angle * s).unwrap();
        let expected = Pose {
            rotation: step * from.rotation,
            translation: centre + step * (from.translation - centre),
        };
        prop_assert!(close(path.pose(s), expected, 1e-13), "{:?}", path.pose(s));
        prop_assert!((path.angle() - angle.abs()).abs() < 1e-14 * 20.0);
        prop_assert!((path.length() - path.radius() * angle.abs()).abs() < 1e-12);
    }

    #[test]
    fn deviation_is_the_smallest_distance(path in any_path(), pose in any_pose()) {
        let deviation = path.deviation(pose);
        let brute = brute_distance(&path, pose.translation);
        prop_assert!(deviation.position <= brute + 1e-12 * (1.0 + brute), "{deviation:?} {brute}");
        let grid = path.length() / 4000.0;
        prop_assert!(brute <= deviation.position + grid, "{deviation:?} {brute}");
        let there = path.pose(deviation.s);
        prop_assert!((0.0..=1.0).contains(&deviation.s));
        prop_assert!((deviation.orientation - there.rotation.angle_to(pose.rotation)).abs() < 1e-13);
    }

    #[test]
    fn deviation_on_the_path_is_zero(path in any_path(), s in 0.0..=1.0) {
        prop_assume!(path.length() > 1e-3 && path.radius() > 1e-3);
        let on = path.deviation(path.pose(s));
        prop_assert!(on.position < 1e-13 * (1.0 + path.length()), "{on:?}");
        prop_assert!(on.orientation < 1e-9, "{on:?}");
    }

    /// Rounding does not choose the way round at half a turn.
    #[test]
    fn half_turn_goes_one_way(start in vector(1.8), axis in vector(1.0), noise in vector(1e-11)) {
        let from = Pose::from_rotation(Rotation::exp(start));
        let about = |axis| Rotation::about(axis, PI).unwrap();
        let axis = axis + Vec3::X * 0.1f64.copysign(axis.x);
        let middle = |rotation| {
            CartesianPath::line(from, Pose::from_rotation(rotation)).unwrap().pose(0.5).rotation
        };
        let clean = middle(about(axis) * from.rotation);
        for other in [
            about(-axis) * from.rotation,
            Rotation::exp(noise) * about(axis) * from.rotation,
        ] {
            prop_assert!(clean.angle_to(middle(other)) < 1e-9);
        }
        let forward = axis * axis.x.signum();
        let expected = Rotation::about(forward, FRAC_PI_2).unwrap() * from.rotation;
        prop_assert!(clean.angle_to(expected) < 1e-9);
    }

    #[test]
    fn rotation_on_the_spot_finds_the_nearest_orientation(pose in any_pose(), axis in vector(1.0),
            angle in -6.0..6.0_f64, measured in vector(1.8)) {
        let path =
            CartesianPath::rotation(pose, AxisRotation { centre: pose.translation, axis, angle }).unwrap();
        prop_assert!(path.length() < 1e-14);
        let rotation = Rotation::exp(measured) * pose.rotation;
        let found = path.deviation(Pose { rotation, ..pose });
        let brute = (0..=2000)
            .map(|i| path.pose(f64::from(i) / 2000.0).rotation.angle_to(rotation))
            .fold(f64::INFINITY, f64::min);
        prop_assert!(found.orientation <= brute + 1e-12, "{found:?} {brute}");
    }
}

#[test]
fn half_turns_on_both_sides_end_where_they_should() {
    for axis in [Vec3::X, -Vec3::Y, Vec3::Z, Vec3::new(-1.0, 2.0, 0.5)] {
        for off in [-1e-6, -2e-9, -1e-10, -1e-15, 0.0, 1e-15, 1e-10, 2e-9, 1e-6] {
            let to = Pose::from_rotation(Rotation::about(axis, PI + off).unwrap());
            let path = CartesianPath::line(Pose::IDENTITY, to).unwrap();
            assert!((path.angle() - PI).abs() < 1.1e-6);
            assert!(close(path.pose(1.0 - 1e-16), to, 1e-14), "{axis:?} {off}");
        }
    }
}

#[test]
fn full_turn_comes_back() {
    let start = Pose::from_translation(Vec3::new(1.0, 2.0, 3.0));
    for angle in [TAU, -TAU, 2.0 * TAU] {
        let turn = AxisRotation { centre: Vec3::new(0.0, 2.0, 0.0), axis: Vec3::Z * 5.0, angle };
        let path = CartesianPath::rotation(start, turn).unwrap();
        assert!((path.radius() - 1.0).abs() < 1e-15);
        assert!((path.length() - angle.abs()).abs() < 1e-14);
        assert!(close(path.pose(1.0), start, 2e-15));
        let quarter = path.pose(TAU / angle.abs() / 4.0);
        assert!((quarter.translation - Vec3::new(0.0, 2.0 + angle.signum(), 3.0)).norm() < 1e-15);
        for i in 0..=100 {
            let p = path.pose(f64::from(i) / 100.0).translation;
            assert!(((p - Vec3::new(0.0, 2.0, 3.0)).norm() - 1.0).abs() < 1e-14);
        }
    }
}

#[test]
fn paths_of_no_length_stay_and_are_never_nan() {
    let pose = Pose { rotation: Rotation::exp(Vec3::X), translation: Vec3::new(1.0, 2.0, 3.0) };
    let still = AxisRotation { centre: Vec3::ZERO, axis: Vec3::Y, angle: 0.0 };
    let nudge = Pose { translation: pose.translation + Vec3::X * 1e-12, ..pose };
    for (path, end) in [
        (CartesianPath::line(pose, pose).unwrap(), pose),
        (CartesianPath::rotation(pose, still).unwrap(), pose),
        (CartesianPath::line(pose, nudge).unwrap(), nudge),
    ] {
        for s in [-1.0, 0.0, 1e-300, 0.3, 0.7, 1.0, 9.0] {
            assert!(close(path.pose(s), end, 2e-12) && path.derivative(s).is_finite());
            assert!(path.deviation(path.pose(s)).position < 2e-12);
        }
        let off = path.deviation(Pose::IDENTITY);
        assert!((off.position - 14.0_f64.sqrt()).abs() < 1e-11 && (off.orientation - 1.0) < 1e-12);
    }
}

#[test]
fn deviation_beyond_the_ends_is_to_the_ends() {
    let at = |x, y, z| Pose::from_translation(Vec3::new(x, y, z));
    let line = CartesianPath::line(at(0.0, 0.0, 0.0), at(1.0, 0.0, 0.0)).unwrap();
    assert_eq!(line.deviation(at(4.0, 4.0, 0.0)).position, 5.0);
    assert_eq!(line.deviation(at(-3.0, 0.0, 4.0)).s, 0.0);
    assert_eq!(line.deviation(at(0.25, 0.0, 2.0)).s, 0.25);
    let arc = CartesianPath::circle(at(1.0, 0.0, 0.0), Vec3::new(0.6, 0.8, 0.0), at(0.0, 1.0, 0.0));
    let arc = arc.unwrap();
    assert!((arc.radius() - 1.0).abs() < 1e-15 && (arc.length() - FRAC_PI_2).abs() < 1e-15);
    assert_eq!(arc.deviation(at(1.0, -3.0, 0.0)).s, 0.0);
    assert_eq!(arc.deviation(at(-3.0, 1.0, 4.0)).position, 5.0);
    assert!(arc.deviation(at(f64::NAN, 0.0, 0.0)).position.is_nan());
}

#[test]
fn points_without_a_circle_are_refused_with_advice() {
    let at = |x, y, z| Pose::from_translation(Vec3::new(x, y, z));
    let (a, b) = (at(0.0, 0.0, 0.0), at(1.0, 1.0, 1.0));
    for (via, to) in [
        (Vec3::new(0.5, 0.5, 0.5), b),
        (Vec3::new(2.0, 2.0, 2.0), b),
        (Vec3::new(0.5, 0.5, 0.5 + 1e-7), b),
        (Vec3::ZERO, b),
        (b.translation, b),
        (b.translation, a),
        (Vec3::ZERO, a),
        (b.translation + Vec3::X * 1e-7, b),
        (Vec3::Y * 1e-7, b),
        (b.translation, Pose::from_translation(Vec3::Z * 1e-7)),
    ] {
        let message = CartesianPath::circle(a, via, to).unwrap_err().to_string();
        assert!(message.contains("no circle") && message.contains("use a line"), "{message}");
    }
    // Nearly on a line, but not quite; and a circle of a nanometre.
    assert!(CartesianPath::circle(a, Vec3::new(0.5, 0.5, 0.5 + 1e-5), b).is_ok());
    let tiny = CartesianPath::circle(a, Vec3::X * 1e-9, at(0.0, 1e-9, 0.0)).unwrap();
    assert!((tiny.radius() - 0.5e-9 * 2.0_f64.sqrt()).abs() < 1e-24);
}

#[test]
fn input_that_is_not_finite_is_refused() {
    let good = Pose::IDENTITY;
    let circle_via = Vec3::new(1.0, 1.0, 0.0);
    let turn = AxisRotation { centre: Vec3::X, axis: Vec3::Z, angle: 1.0 };
    for x in [f64::NAN, f64::INFINITY] {
        let v = Vec3::new(0.0, x, 0.0);
        let bad = Pose::from_translation(v);
        for result in [
            CartesianPath::line(bad, good),
            CartesianPath::line(good, bad),
            CartesianPath::circle(bad, circle_via, Pose::from_translation(Vec3::X)),
            CartesianPath::circle(good, v, Pose::from_translation(Vec3::X)),
            CartesianPath::circle(good, circle_via, bad),
            CartesianPath::rotation(bad, turn),
            CartesianPath::rotation(good, AxisRotation { centre: v, ..turn }),
            CartesianPath::rotation(good, AxisRotation { axis: v, ..turn }),
            CartesianPath::rotation(good, AxisRotation { angle: x, ..turn }),
        ] {
            assert!(matches!(result, Err(Error::NotFinite { .. })), "{result:?}");
        }
    }
    let error =
        CartesianPath::rotation(good, AxisRotation { axis: Vec3::ZERO, ..turn }).unwrap_err();
    assert!(error.to_string().contains("it has no direction"), "{error}");
}
