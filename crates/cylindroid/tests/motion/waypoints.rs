//! Moves through waypoints: bounds, blends, times.

use cylindroid::control::{CartesianBounds, KinematicBounds, WaypointMove};
use cylindroid::{Pose, Rotation, Vec3};

const BOUNDS: CartesianBounds = CartesianBounds {
    linear: KinematicBounds { velocity: 0.5, acceleration: 1.0, jerk: f64::INFINITY },
    angular: KinematicBounds { velocity: 1.0, acceleration: 4.0, jerk: f64::INFINITY },
};

fn poses() -> Vec<Pose> {
    let at = |x: f64, y: f64, z: f64, turn: Vec3| Pose {
        translation: Vec3::new(x, y, z),
        rotation: Rotation::exp(turn),
    };
    vec![
        at(0.0, 0.0, 0.0, Vec3::ZERO),
        at(0.4, 0.0, 0.1, Vec3::X * 0.5),
        at(0.4, 0.3, 0.1, Vec3::new(0.5, 1.5, 0.0)),
        at(0.39, 0.31, 0.1, Vec3::new(0.5, 1.5, 0.1)), // close together: slowed down
        at(0.0, 0.3, 0.5, Vec3::Z),
    ]
}

/// Twists are the derivatives of poses, continuous, and within the bounds.
fn check(motion: &WaypointMove, bounds: CartesianBounds) {
    let (steps, total) = (20_000, motion.duration());
    let h = total / f64::from(steps);
    let (mut before, mut twist_before) = motion.at(0.0);
    for step in 1..=steps {
        let t = f64::from(step) * h;
        let (pose, twist) = motion.at(t);
        let moved = before.error_to(pose) * (1.0 / h);
        let mean = (twist + twist_before) * 0.5;
        // Where a blend begins or ends within the step, the mean is off by a h / 8 at most.
        let kink = |a: f64| 0.125 * a * h * (1.0 + 1e-3) + 1e-9;
        let off = moved - mean;
        assert!(off.linear.norm() <= kink(bounds.linear.acceleration), "{t}: {off:?}");
        assert!(off.angular.norm() <= kink(bounds.angular.acceleration), "{t}: {off:?}");
        let change = (twist - twist_before) * (1.0 / h);
        assert!(change.linear.norm() <= bounds.linear.acceleration * (1.0 + 1e-6), "{t}");
        assert!(change.angular.norm() <= bounds.angular.acceleration * (1.0 + 1e-6), "{t}");
        assert!(twist.linear.norm() <= bounds.linear.velocity * (1.0 + 1e-9), "{t}");
        assert!(twist.angular.norm() <= bounds.angular.velocity * (1.0 + 1e-9), "{t}");
        (before, twist_before) = (pose, twist);
    }
}

#[test]
fn speeds_and_accelerations_stay_within_their_bounds() {
    let poses = poses();
    let motion = WaypointMove::new(&poses, BOUNDS).unwrap();
    check(&motion, BOUNDS);
    assert_eq!(motion.at(-1.0).0, poses[0]);
    assert_eq!(motion.at(motion.duration()).0, poses[4]);
    // Every waypoint is passed as near as the blends say.
    for pose in &poses {
        let near = (0..=20_000)
            .map(|i| motion.at(motion.duration() * f64::from(i) / 2e4).0)
            .map(|at| (at.translation - pose.translation).norm())
            .fold(f64::INFINITY, f64::min);
        assert!(near <= motion.largest_deviation() + 1e-6, "{near}");
    }
    // The target of a servo leads to the next pose.
    let target = motion.target(1.0, 0.01);
    let way = target.pose.error_to(motion.at(1.01).0) * 100.0;
    assert_eq!(target.feed_forward, way);
    // A first pose given twice changes nothing.
    let twice = [&poses[..1], &poses].concat();
    assert_eq!(WaypointMove::new(&twice, BOUNDS).unwrap(), motion);
}

#[test]
fn times_are_met() {
    let poses = poses();
    let times = [1.0, 3.0, 5.0, 5.5, 8.0];
    let motion = WaypointMove::timed(&poses, &times, BOUNDS).unwrap();
    assert!((motion.duration() - 7.0).abs() < 1e-12, "{}", motion.duration());
    let free = KinematicBounds { velocity: f64::INFINITY, ..BOUNDS.linear };
    let any = KinematicBounds { velocity: f64::INFINITY, ..BOUNDS.angular };
    check(&motion, CartesianBounds { linear: free, angular: any });
    for (pose, time) in poses.iter().zip(times) {
        let off = (motion.at(time - 1.0).0.translation - pose.translation).norm();
        assert!(off <= motion.largest_deviation() + 1e-12, "{off}");
    }
    // A line alone: half of the way at half of the time.
    let line = WaypointMove::timed(&poses[..2], &[0.0, 2.0], BOUNDS).unwrap();
    let half = (poses[0].translation + poses[1].translation) * 0.5;
    assert!((line.at(1.0).0.translation - half).norm() < 1e-12);
    assert!((line.duration() - 2.0).abs() < 1e-12);
    check(&line, CartesianBounds { linear: free, angular: any });
}

#[test]
fn impossible_waypoints_are_refused() {
    let poses = poses();
    let timed = |times: &[f64]| WaypointMove::timed(&poses, times, BOUNDS);
    for (times, expected) in [
        (&[0.0, 2.0, 2.0, 3.0, 4.0][..], "must increase"),
        (&[0.0, 0.5, 2.0, 3.0, 6.0], "0 s to 0.5 s"),
        (&[0.0, 2.0, 4.0, 4.1, 6.0], "4 s to 4.1 s"),
        (&[0.0, 2.0, 4.0, 5.0, 5.5], "5 s to 5.5 s"),
        (&[0.0, 1.0], "5"),
        (&[0.0, 1.0, 2.0, f64::NAN, 5.0], "times of the waypoints"),
    ] {
        let error = timed(times).unwrap_err().to_string();
        assert!(error.contains(expected), "'{expected}' not in: {error}");
    }
    let error = WaypointMove::new(&poses[..1], BOUNDS).unwrap_err().to_string();
    assert!(error.contains("a start and an end"), "{error}");
    let jerk = KinematicBounds { jerk: 10.0, ..BOUNDS.linear };
    let error = WaypointMove::new(&poses, CartesianBounds { linear: jerk, ..BOUNDS });
    assert!(error.unwrap_err().to_string().contains("jerk"));
    let broken = Pose::from_translation(Vec3::X * f64::NAN);
    assert!(WaypointMove::new(&[poses[0], broken], BOUNDS).is_err());
}
