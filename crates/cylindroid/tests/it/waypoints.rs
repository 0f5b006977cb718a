//! Moves through waypoints at the ends of what they are given: speeds without a bound, times that
//! overflow, crowded waypoints, no period.

use cylindroid::control::{
    CartesianBounds, CartesianMove, CartesianPath, KinematicBounds, WaypointMove,
};
use cylindroid::{Pose, Rotation, Vec3};

fn bounds(linear: f64, angular: f64) -> CartesianBounds {
    let of =
        |velocity, acceleration| KinematicBounds { velocity, acceleration, jerk: f64::INFINITY };
    CartesianBounds { linear: of(linear, 1.0), angular: of(angular, 4.0) }
}

fn corner() -> [Pose; 3] {
    [Vec3::ZERO, Vec3::X * 0.3, Vec3::new(0.3, 0.2, 0.1)].map(Pose::from_translation)
}

/// The largest linear and angular acceleration, by differences of twists.
fn accelerations(motion: &WaypointMove) -> [f64; 2] {
    let h = motion.duration() / 4000.0;
    (0..4000).fold([0.0_f64; 2], |[linear, angular], i| {
        let (before, after) = (motion.at(f64::from(i) * h).1, motion.at(f64::from(i + 1) * h).1);
        let rate = (after - before) * (1.0 / h);
        [linear.max(rate.linear.norm()), angular.max(rate.angular.norm())]
    })
}

/// Accelerations are kept, and the move is about as fast as with a bound that is never met.
#[test]
fn without_a_bound_of_the_speed_accelerations_are_kept() {
    let mut turning = corner();
    turning[2].rotation = Rotation::about_z(1.2);
    let about = turning.map(|pose| Pose { translation: Vec3::ZERO, ..pose });
    for poses in [&corner()[..], &corner()[..2], &turning, &about] {
        let fast = WaypointMove::new(poses, bounds(1e6, 1e6)).unwrap();
        for (linear, angular) in [(f64::INFINITY, f64::INFINITY), (1e300, 1e300)] {
            let motion = WaypointMove::new(poses, bounds(linear, angular)).unwrap();
            let ratio = motion.duration() / fast.duration();
            assert!((0.8..1.25).contains(&ratio), "{linear}: {ratio}");
            let [a, alpha] = accelerations(&motion);
            assert!(a < 1.0 + 1e-6 && alpha < 4.0 + 1e-6, "{a} {alpha}");
        }
    }
    // From rest to rest over a distance d: 2 sqrt(d / a).
    let line = WaypointMove::new(&corner()[..2], bounds(f64::INFINITY, 1.0)).unwrap();
    assert!((line.duration() - 2.0 * 0.3_f64.sqrt()).abs() < 1e-6, "{}", line.duration());
    let still = WaypointMove::new(&[corner()[0]; 3], bounds(f64::INFINITY, f64::INFINITY)).unwrap();
    assert_eq!(still.duration(), 0.0);
}

/// Times without an end take their time; what overflows is refused.
#[test]
fn huge_times_and_distances_are_moves_or_errors() {
    let poses = corner();
    let timed = |times: &[f64]| WaypointMove::timed(&poses, times, bounds(1.0, 1.0));
    for scale in [1e7, 1e154, 1e300] {
        let motion = timed(&[0.0, scale, 2.0 * scale]).unwrap();
        assert!((motion.duration() / scale - 2.0).abs() < 1e-12, "{}", motion.duration());
        let half = motion.at(0.5 * scale).0.translation;
        assert!((half - Vec3::X * 0.15).norm() < 1e-6, "{half:?}");
        assert!(motion.target(0.0, 1e-3).feed_forward.is_finite());
    }
    let error = timed(&[-1e308, 1e308, 1.5e308]).unwrap_err().to_string();
    assert!(error.contains("is not finite"), "{error}");
    let far = [corner()[0], Pose::from_translation(Vec3::X * 1e308)];
    let error = WaypointMove::new(&far, bounds(0.1, 1.0)).unwrap_err().to_string();
    assert!(error.contains("orders of magnitude"), "{error}");
}

/// Waypoints far denser than the way of a ramp are no obstacle, in less than a second.
#[test]
fn crowded_waypoints_are_followed() {
    let circle = |count: u32| {
        let at = |i| f64::from(i) * std::f64::consts::TAU / f64::from(count);
        let pose = |i| Pose::from_translation(Vec3::new(at(i).cos(), at(i).sin(), 0.0) * 0.05);
        let poses: Vec<Pose> = (0..count).map(pose).collect();
        let motion = WaypointMove::new(&poses, bounds(0.25, 1.0)).unwrap();
        assert_eq!(motion.at(f64::INFINITY).0, poses[poses.len() - 1]);
        motion.duration()
    };
    let [few, many] = [circle(200), circle(500_000)];
    assert!(few < 1.8 && (many / few - 1.0).abs() < 0.01, "{few} {many}");
}

/// Steps below the tolerance add up: the move follows them, and ends where they end.
#[test]
fn small_steps_are_no_repetitions() {
    let way = (0..=400).map(|i| 4e-7 * f64::from(200 - i32::abs(200 - i)));
    let poses: Vec<Pose> = way.map(|x| Pose::from_translation(Vec3::X * x)).collect();
    let motion = WaypointMove::new(&poses, bounds(0.25, 1.0)).unwrap();
    let most = (0..1000).map(|k| motion.duration() * 1e-3 * f64::from(k));
    let most = most.map(|t| motion.at(t).0.translation.x).fold(0.0, f64::max);
    assert!(most > 7e-5, "{most}");
    assert_eq!(motion.at(f64::INFINITY).0, poses[400]);
}

/// Without a next step the target has the twist of the move.
#[test]
fn a_target_without_a_period_is_finite() {
    let poses = corner();
    let motion = WaypointMove::new(&poses, bounds(0.2, 1.0)).unwrap();
    let path = CartesianPath::line(poses[0], poses[1]).unwrap();
    let line = CartesianMove::new(path, bounds(0.2, 1.0)).unwrap();
    for t in [0.0, 0.1, 0.9] {
        for dt in [0.0, -0.0, f64::NAN] {
            assert_eq!(motion.target(t, dt).feed_forward, motion.at(t).1);
            assert_eq!(line.target(t, dt).feed_forward, line.at(t).twist);
        }
        let near = motion.target(t, 1e-6).feed_forward;
        assert!((near - motion.at(t).1).linear.norm() < 1e-5);
    }
}
