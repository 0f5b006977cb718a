//! `control::CartesianMove` and `control::JointMove`: bounds of every part, feed-forward, ends.

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use cylindroid::control::{
    AxisRotation, CartesianBounds, CartesianMove, CartesianPath, JointDefaults, JointMove,
    JointPath, JointSample, KinematicBounds,
};
use cylindroid::model::{JointKind, JointSpec, Limits, Mechanism};
use cylindroid::{Error, Pose, Rotation, Vec3};
use proptest::prelude::*;

const INF: f64 = f64::INFINITY;
const LINEAR: KinematicBounds = KinematicBounds { velocity: 0.5, acceleration: 2.0, jerk: 20.0 };
const ANGULAR: KinematicBounds = KinematicBounds { velocity: 1.5, acceleration: 6.0, jerk: 60.0 };
const BOUNDS: CartesianBounds = CartesianBounds { linear: LINEAR, angular: ANGULAR };

fn log_uniform(low: f64, high: f64) -> impl Strategy<Value = f64> {
    (low..high).prop_map(|e| 10f64.powf(e))
}

fn any_bounds() -> impl Strategy<Value = KinematicBounds> {
    let jerk = prop_oneof![3 => log_uniform(-2.0, 3.0), 1 => Just(INF)];
    let velocity = prop_oneof![5 => log_uniform(-2.0, 1.0), 1 => Just(INF)];
    (velocity, log_uniform(-2.0, 2.0), jerk)
        .prop_map(|(velocity, acceleration, jerk)| KinematicBounds { velocity, acceleration, jerk })
}

/// The largest norms of velocity, acceleration and jerk that finite differences find.
fn largest(value: impl Fn(f64) -> Vec3, duration: f64) -> [f64; 3] {
    let step = 1e-3 * duration;
    let mut found = [0.0_f64; 3];
    for i in 0..500 {
        let t = (f64::from(i) + 0.5) / 500.0 * duration;
        let [before, here, after] = [t - step, t, t + step].map(&value);
        let acceleration = (after - before) * (0.5 / step);
        let jerk = (after - here * 2.0 + before) * (1.0 / (step * step));
        for (most, v) in found.iter_mut().zip([here, acceleration, jerk]) {
            *most = most.max(v.norm());
        }
    }
    found
}

fn within(found: [f64; 3], bounds: KinematicBounds) -> bool {
    found[0] <= bounds.velocity * (1.0 + 1e-12)
        && found[1] <= bounds.acceleration * (1.0 + 1e-9)
        && found[2] <= bounds.jerk * (1.0 + 1e-6)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(300))]

    /// Differences are means of the true values, so they cannot exceed what these do not exceed.
    #[test]
    fn cartesian_arc_keeps_every_bound(radius in log_uniform(-3.0, 1.0),
            angle in log_uniform(-2.0, 1.5), linear in any_bounds(), angular in any_bounds()) {
        let start = Pose::from_translation(Vec3::X * radius);
        let turn = AxisRotation { centre: Vec3::ZERO, axis: Vec3::Z, angle };
        let path = CartesianPath::rotation(start, turn).unwrap();
        let motion = CartesianMove::new(path, CartesianBounds { linear, angular }).unwrap();
        let end = motion.law().duration();
        let found = largest(|t| motion.at(t).twist.linear, end);
        prop_assert!(within(found, linear), "{found:?} {linear:?}");
        let found = largest(|t| motion.at(t).twist.angular, end);
        prop_assert!(within(found, angular), "{found:?} {angular:?}");
    }

    #[test]
    fn cartesian_line_is_as_fast_as_its_slowest_part(length in log_uniform(-4.0, 1.0),
            angle in 1e-3..3.0_f64, linear in any_bounds(), angular in any_bounds()) {
        let to = Pose {
            rotation: Rotation::exp(Vec3::Y * angle),
            translation: Vec3::Z * length,
        };
        let path = CartesianPath::line(Pose::IDENTITY, to).unwrap();
        let motion = CartesianMove::new(path, CartesianBounds { linear, angular }).unwrap();
        let end = motion.law().duration();
        prop_assert!(within(largest(|t| motion.at(t).twist.linear, end), linear));
        prop_assert!(within(largest(|t| motion.at(t).twist.angular, end), angular));
        let alone = |distance, bounds| {
            cylindroid::control::TimeLaw::new(distance, bounds).unwrap().duration()
        };
        let slowest = alone(length, linear).max(alone(angle, angular));
        prop_assert!(end >= slowest * (1.0 - 1e-12), "{end} {slowest}");
    }

    #[test]
    fn cartesian_feed_forward_is_the_rate_of_the_pose(share in 0.02..0.98, half_turn in any::<bool>()) {
        let angle = if half_turn { PI } else { 0.7 };
        let from = Pose {
            rotation: Rotation::exp(Vec3::new(0.3, -0.2, 0.9)),
            translation: Vec3::new(0.4, 0.1, 0.2),
        };
        let to = Pose {
            rotation: Rotation::exp(Vec3::Y * angle) * from.rotation,
            translation: Vec3::new(-0.3, 0.5, 0.6),
        };
        for path in [
            CartesianPath::line(from, to).unwrap(),
            CartesianPath::circle(from, Vec3::new(0.0, 0.6, 0.2), to).unwrap(),
        ] {
            let motion = CartesianMove::new(path, BOUNDS).unwrap();
            let (t, step) = (share * motion.law().duration(), 1e-5);
            let sample = motion.at(t);
            let rate = motion.at(t - step).pose.error_to(motion.at(t + step).pose) * (0.5 / step);
            let error = rate - sample.twist;
            prop_assert!(error.linear.norm() < 1e-8 && error.angular.norm() < 1e-8, "{error:?}");
            let deviation = motion.path().deviation(sample.pose);
            prop_assert!(deviation.position < 1e-14 && deviation.orientation < 1e-13);
        }
    }

    #[test]
    fn joint_bounds_hold_and_one_joint_leads(
            joints in prop::collection::vec((-3.0..3.0_f64, -3.0..3.0_f64, any_bounds()), 1..8),
            share in 0.0..1.0) {
        let from: Vec<f64> = joints.iter().map(|j| j.0).collect();
        let to: Vec<f64> = joints.iter().map(|j| j.1).collect();
        let bounds: Vec<KinematicBounds> = joints.iter().map(|j| j.2).collect();
        let motion = JointMove::new(JointPath::new(&from, &to).unwrap(), &bounds).unwrap();
        let peaks = motion.law().extrema();
        let [mut v, mut a, mut j] = [0.0_f64; 3];
        for (d, bound) in motion.path().displacement().iter().zip(&bounds) {
            v = v.max(peaks.velocity * d.abs() / bound.velocity);
            a = a.max(peaks.acceleration * d.abs() / bound.acceleration);
            j = j.max(peaks.jerk * d.abs() / bound.jerk);
        }
        for reached in [v, a, j] {
            prop_assert!(reached <= 1.0 + 1e-13, "{v} {a} {j}");
        }
        prop_assert!(v.max(a).max(j) > 1.0 - 1e-12, "some bound is reached: {v} {a} {j}");

        let n = joints.len();
        let (mut q, mut qd) = (vec![0.0; n], vec![0.0; n]);
        let t = share * motion.law().duration();
        let s = motion
            .sample_into(t, JointSample { positions: &mut q, velocities: &mut qd })
            .unwrap();
        for i in 0..n {
            let (low, high) = (from[i].min(to[i]), from[i].max(to[i]));
            prop_assert!((low..=high).contains(&q[i]));
            prop_assert!((q[i] - from[i] - s.position * (to[i] - from[i])).abs() < 1e-14);
            prop_assert!(qd[i].abs() <= bounds[i].velocity * (1.0 + 1e-13));
        }
    }
}

#[test]
fn cartesian_arc_that_is_short_or_slow_moves_like_a_line() {
    let start = Pose::from_translation(Vec3::X);
    let linear_only = |linear| CartesianBounds {
        linear,
        angular: KinematicBounds { velocity: INF, acceleration: INF, jerk: 1e12 },
    };
    for jerk in [20.0, INF] {
        let bounds = KinematicBounds { jerk, ..LINEAR };
        for (angle, bounds) in
            [(1e-4, bounds), (FRAC_PI_2, KinematicBounds { velocity: 1e-3, ..bounds })]
        {
            let turn = AxisRotation { centre: Vec3::ZERO, axis: Vec3::Z, angle };
            let arc = CartesianPath::rotation(start, turn).unwrap();
            let to = Pose::from_translation(Vec3::new(1.0 + arc.length(), 0.0, 0.0));
            let line = CartesianPath::line(start, to).unwrap();
            let time =
                |path| CartesianMove::new(path, linear_only(bounds)).unwrap().law().duration();
            let (arc, line) = (time(arc), time(line));
            assert!(arc >= line * (1.0 - 1e-12) && arc < line * (1.0 + 1e-3), "{arc} {line}");
        }
    }
}

#[test]
fn cartesian_circle_speed_is_limited_by_the_centripetal_acceleration() {
    let start = Pose::from_translation(Vec3::X);
    let turn = AxisRotation { centre: Vec3::ZERO, axis: Vec3::Z, angle: TAU };
    let path = CartesianPath::rotation(start, turn).unwrap();
    let fast = KinematicBounds { velocity: 100.0, acceleration: 2.0, jerk: INF };
    let free = KinematicBounds { velocity: INF, acceleration: 1e6, jerk: INF };
    let motion = CartesianMove::new(path, CartesianBounds { linear: fast, angular: free }).unwrap();
    // u^2 / r = a / sqrt 2, so that a / sqrt 2 is left along the path.
    let speed = motion.law().extrema().velocity * TAU;
    assert!((speed - (2.0 * 0.5_f64.sqrt()).sqrt()).abs() < 1e-14, "{speed}");
    let along = motion.law().extrema().acceleration * TAU;
    assert!((along - 2.0_f64.sqrt()).abs() < 1e-14, "{along}");
}

#[test]
fn cartesian_move_of_no_length_takes_no_time() {
    let pose = Pose { rotation: Rotation::exp(Vec3::X), translation: Vec3::new(1.0, 2.0, 3.0) };
    let spin = |angle| AxisRotation { centre: pose.translation, axis: Vec3::Z, angle };
    for path in [
        CartesianPath::line(pose, pose).unwrap(),
        CartesianPath::rotation(pose, spin(0.0)).unwrap(),
    ] {
        let motion = CartesianMove::new(path, BOUNDS).unwrap();
        assert_eq!(motion.law().duration(), 0.0);
        for motion in [motion, motion.scaled_to_duration(2.0).unwrap()] {
            for t in [-1.0, 0.0, 1.0, 5.0, f64::NAN] {
                let sample = motion.at(t);
                assert_eq!(sample.pose.translation, pose.translation);
                assert!(sample.pose.rotation.angle_to(pose.rotation) < 1e-15);
                assert!(sample.twist.linear.norm() == 0.0 && sample.twist.angular.norm() == 0.0);
            }
        }
    }
    // A picometre, and a turn on the spot, take their time.
    let nudge =
        Pose { translation: pose.translation, ..pose } * Pose::from_translation(Vec3::X * 1e-12);
    let motion = CartesianMove::new(CartesianPath::line(pose, nudge).unwrap(), BOUNDS).unwrap();
    let length = motion.path().length();
    let expected = 4.0 * (length / (2.0 * LINEAR.jerk)).cbrt();
    assert!((motion.law().duration() - expected).abs() < 1e-12 * expected);
    assert_eq!(motion.at(INF).pose, nudge);
    let motion =
        CartesianMove::new(CartesianPath::rotation(pose, spin(3.0)).unwrap(), BOUNDS).unwrap();
    let expected = 3.0 / 1.5 + 1.5 / 6.0 + 6.0 / 60.0;
    assert!((motion.law().duration() - expected).abs() < 1e-14);
}

#[test]
fn cartesian_stretched_move_ends_together() {
    let to = Pose::from_translation(Vec3::X);
    let motion =
        CartesianMove::new(CartesianPath::line(Pose::IDENTITY, to).unwrap(), BOUNDS).unwrap();
    let slow = motion.scaled_to_duration(7.0).unwrap();
    assert_eq!(slow.law().duration(), 7.0);
    assert!(slow.at(6.9999).s.position < 1.0);
    assert_eq!(slow.at(7.0).pose, to);
    assert!(motion.scaled_to_duration(0.1).is_err());
}

#[test]
fn cartesian_bad_bounds_are_refused_even_of_a_part_that_rests() {
    let path = CartesianPath::line(Pose::IDENTITY, Pose::from_translation(Vec3::X)).unwrap();
    for bad in [0.0, -1.0, f64::NAN] {
        let linear = KinematicBounds { velocity: bad, ..LINEAR };
        let error = CartesianMove::new(path, CartesianBounds { linear, ..BOUNDS }).unwrap_err();
        assert!(error.to_string().contains("the linear part"), "{error}");
        let angular = KinematicBounds { jerk: bad, ..ANGULAR };
        let error = CartesianMove::new(path, CartesianBounds { angular, ..BOUNDS }).unwrap_err();
        assert!(error.to_string().contains("the angular part"), "{error}");
    }
}

#[test]
fn joint_move_ends_exactly_and_rests_where_nothing_moves() {
    let (from, to) = ([0.1, -2.0, 0.7], [0.3, 1.0 / 3.0, 0.7]);
    let path = JointPath::new(&from, &to).unwrap();
    let motion = JointMove::new(path, &[LINEAR; 3]).unwrap();
    let (mut q, mut qd) = ([0.0; 3], [1.0; 3]);
    for (t, expected) in [(-1.0, from), (0.0, from), (motion.law().duration(), to), (INF, to)] {
        motion.sample_into(t, JointSample { positions: &mut q, velocities: &mut qd }).unwrap();
        assert_eq!(q, expected);
        assert_eq!(qd, [0.0; 3]);
    }
    // The longest way leads: the time is that of joint 1 alone.
    let alone = JointMove::new(JointPath::new(&from[1..2], &to[1..2]).unwrap(), &[LINEAR]).unwrap();
    assert!((motion.law().duration() - alone.law().duration()).abs() < 1e-14);
    let slow = motion.scaled_to_duration(60.0).unwrap();
    slow.sample_into(30.0, JointSample { positions: &mut q, velocities: &mut qd }).unwrap();
    assert!((q[0] - 0.2).abs() < 1e-15 && q[2] == 0.7 && qd[2] == 0.0);

    for still in [&from[..], &[]] {
        let path = JointPath::new(still, still).unwrap();
        let motion = JointMove::new(path, &vec![LINEAR; still.len()]).unwrap();
        assert_eq!(motion.law().duration(), 0.0);
        let n = still.len();
        let sample = JointSample { positions: &mut q[..n], velocities: &mut qd[..n] };
        motion.sample_into(0.0, sample).unwrap();
        assert_eq!(&q[..n], still);
        assert!(qd[..n].iter().all(|v| *v == 0.0));
    }
}

#[test]
fn joint_bad_input_is_named() {
    let message = |e: Error| e.to_string();
    let error = JointPath::new(&[0.0], &[0.0, 1.0]).unwrap_err();
    assert!(matches!(error, Error::Dimension { expected: 1, got: 2, .. }), "{error}");
    for bad in [f64::NAN, INF] {
        let error = message(JointPath::new(&[0.0, bad], &[0.0, 1.0]).unwrap_err());
        assert!(error.contains("start of the joint path[1]"), "{error}");
        let error = message(JointPath::new(&[0.0, 1.0], &[bad, 1.0]).unwrap_err());
        assert!(error.contains("end of the joint path[0]"), "{error}");
    }
    assert!(JointPath::new(&[-1e308], &[1e308]).is_err(), "the difference overflows");

    let path = JointPath::new(&[0.0, 0.0], &[1.0, 0.0]).unwrap();
    assert!(matches!(JointMove::new(path.clone(), &[LINEAR]), Err(Error::Dimension { .. })));
    for bad in [0.0, -1.0, f64::NAN] {
        let bounds = [LINEAR, KinematicBounds { acceleration: bad, ..LINEAR }];
        let error = message(JointMove::new(path.clone(), &bounds).unwrap_err());
        assert!(error.contains("acceleration bound") && error.contains("joint 1"), "{error}");
    }
    let motion = JointMove::new(path, &[LINEAR; 2]).unwrap();
    for (n, m) in [(1, 2), (2, 3)] {
        let (mut q, mut qd) = (vec![7.0; n], vec![7.0; m]);
        let sample = JointSample { positions: &mut q, velocities: &mut qd };
        assert!(matches!(motion.sample_into(0.5, sample), Err(Error::Dimension { .. })));
        assert!(q.iter().chain(&qd).all(|x| *x == 7.0), "nothing is written");
    }
}

/// Both ends within the limits, joints that rest not asked for theirs, the culprit by its name.
#[test]
fn joint_limits_of_a_mechanism() {
    let mut b = Mechanism::builder("arm");
    for (i, name) in ["shoulder", "elbow"].into_iter().enumerate() {
        let velocity = if name == "elbow" { 0.0 } else { 2.0 };
        b.joint(JointSpec {
            limits: Limits { lower: -1.0, upper: 1.0, velocity, ..Limits::NONE },
            ..JointSpec::new(name, JointKind::Revolute, &format!("l{i}"), &format!("l{}", i + 1))
        });
    }
    let arm = b.build().unwrap();
    let defaults = JointDefaults { angle: LINEAR, length: LINEAR };
    let between = |q: [f64; 2], to: [f64; 2]| JointMove::within_limits(&arm, &q, &to, &defaults);
    assert!(between([0.0, 0.5], [1.0, 0.5]).is_ok(), "the elbow rests, and may");
    for (q, to, says) in [
        ([1.1, 0.0], [0.0, 0.0], "start of the joint move = shoulder at 1.1 rad"),
        ([0.0, 0.0], [0.0, -2.0], "end of the joint move = elbow at -2 rad"),
        ([0.0, 0.0], [0.0, 0.5], "joint 'elbow'"),
    ] {
        let error = between(q, to).unwrap_err().to_string();
        assert!(error.contains(says), "{error}");
    }
}
