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

/// Each segment has its own speed; where they are equal, that of the bounds.
#[test]
fn segments_have_speeds_of_their_own() {
    let poses = poses();
    let free = KinematicBounds { velocity: f64::INFINITY, ..BOUNDS.linear };
    let free = CartesianBounds { linear: free, ..BOUNDS };
    let speeds = [0.3, 0.1, 0.5, 0.2];
    let motion = WaypointMove::with_speeds(&poses, &speeds, free).unwrap();
    check(&motion, BOUNDS);
    // A segment is run at its speed, or slower where it rotates or blends; blends lie in between.
    let most = |motion: &WaypointMove, from: f64, to: f64| {
        let at = |k: i32| from + (to - from) * f64::from(k) * 1e-3;
        (0..=1000).map(|k| motion.at(at(k)).1.linear.norm()).fold(0.0, f64::max)
    };
    assert!(most(&motion, 0.0, motion.duration()) <= 0.3 * (1.0 + 1e-9));
    let slowest = 0.3 / speeds[1];
    assert!(motion.duration() > slowest, "{}", motion.duration());
    let same = WaypointMove::with_speeds(&poses, &[0.5; 4], free).unwrap();
    assert!(
        (same.duration() - WaypointMove::new(&poses, BOUNDS).unwrap().duration()).abs() < 1e-12
    );
    // The bound of all counts too.
    let bounded = WaypointMove::with_speeds(&poses, &[f64::INFINITY; 4], BOUNDS).unwrap();
    assert_eq!(bounded, WaypointMove::new(&poses, BOUNDS).unwrap());
    // On a straight line: slow in the middle.
    let line: Vec<Pose> = (0..4).map(|i| Pose::from_translation(Vec3::X * f64::from(i))).collect();
    let motion = WaypointMove::with_speeds(&line, &[0.5, 0.1, 0.5], free).unwrap();
    let middle = motion.duration() * 0.5;
    assert!((most(&motion, middle - 4.0, middle + 4.0) - 0.1).abs() < 1e-9);
    assert!((most(&motion, 0.0, 2.0) - 0.5).abs() < 1e-9);
    // On short ways too, on which the speed of the others is not reached.
    let short: Vec<Pose> =
        line.iter().map(|p| Pose::from_translation(p.translation * 0.05)).collect();
    let motion = WaypointMove::with_speeds(&short, &[0.1, 0.5, 0.1], free).unwrap();
    let [begin, end] = [0.25, 0.75].map(|share| share * motion.duration());
    assert!(most(&motion, 0.0, begin) <= 0.1 * (1.0 + 1e-9), "{}", most(&motion, 0.0, begin));
    assert!(most(&motion, end, motion.duration()) <= 0.1 * (1.0 + 1e-9));
    assert!(most(&motion, begin, end) > 0.11, "{}", most(&motion, begin, end));
    // A turn in place has the angular speed of the bounds.
    let turned = Pose { rotation: Rotation::about_z(1.5), ..poses[0] };
    let [slow, fast] =
        [1e-3, 1e3].map(|v| WaypointMove::with_speeds(&[poses[0], turned], &[v], free).unwrap());
    assert!((slow.duration() - 1.75).abs() < 1e-9 && (fast.duration() - 1.75).abs() < 1e-9);
    // The speed of a repeated pose is left out with it; that of its row counts for the next one.
    let twice = [&poses[..2], &poses[1..]].concat();
    let left_out = WaypointMove::with_speeds(&twice, &[0.3, 1e-3, 0.1, 0.5, 0.2], free).unwrap();
    assert_eq!(left_out, WaypointMove::with_speeds(&poses, &speeds, free).unwrap());
    for (speeds, expected) in [
        (&[0.1, 0.2, 0.3][..], "speeds of the waypoints"),
        (&[0.1, -0.2, 0.3, 0.4], "-0.2 m/s from waypoint 1 to 2"),
        (&[0.1, 0.2, f64::NAN, 0.4], "from waypoint 2 to 3"),
        (&[0.1, 0.2, 0.3, 0.0], "0 m/s from waypoint 3 to 4"),
    ] {
        let error = WaypointMove::with_speeds(&poses, speeds, free).unwrap_err().to_string();
        assert!(error.contains(expected), "'{expected}' not in: {error}");
    }
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
    // In the shortest time it accelerates on half of the way and brakes on the other; not in less.
    let ends = [Pose::IDENTITY, Pose::from_translation(Vec3::X)];
    let shortest = WaypointMove::timed(&ends, &[0.0, 2.0], BOUNDS).unwrap();
    assert!((shortest.at(1.0).1.linear.norm() - 1.0).abs() < 1e-12);
    assert!(WaypointMove::timed(&ends, &[0.0, 2.0 * (1.0 - 1e-6)], BOUNDS).is_err());
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
