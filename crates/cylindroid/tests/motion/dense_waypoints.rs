//! Moves through many waypoints: as quick as the curve that they sample, for any number of them;
//! moves through few are no slower than with one speed on each segment.

use std::f64::consts::{FRAC_PI_2, TAU};

use cylindroid::control::{CartesianBounds, KinematicBounds, WaypointMove};
use cylindroid::{Pose, Rotation, Twist, Vec3};

fn bounds(linear: f64, angular: f64) -> CartesianBounds {
    let of =
        |velocity, acceleration| KinematicBounds { velocity, acceleration, jerk: f64::INFINITY };
    CartesianBounds { linear: of(linear, 1.0), angular: of(angular, 4.0) }
}

/// A full circle, sampled in equal steps.
fn circle(radius: f64, count: u32) -> Vec<Pose> {
    let at = |i| f64::from(i) * TAU / f64::from(count);
    let pose = |i| Pose::from_translation(Vec3::new(at(i).cos(), at(i).sin(), 0.0) * radius);
    (0..=count).map(pose).collect()
}

/// Largest speeds and accelerations, by differences of twists.
#[derive(Debug, Default)]
struct Largest {
    linear: [f64; 2],
    angular: [f64; 2],
}

fn largest(motion: &WaypointMove, steps: u32) -> Largest {
    let h = motion.duration() / f64::from(steps);
    let mut most = Largest::default();
    let mut before = Twist::ZERO;
    for i in 0..=steps {
        let twist = motion.at(f64::from(i) * h).1;
        let rate = (twist - before) * (1.0 / h);
        for (most, now, rate) in [
            (&mut most.linear, twist.linear, rate.linear),
            (&mut most.angular, twist.angular, rate.angular),
        ] {
            *most = [most[0].max(now.norm()), most[1].max(rate.norm())];
        }
        before = twist;
    }
    most
}

fn check(motion: &WaypointMove, bounds: CartesianBounds, steps: u32) {
    let most = largest(motion, steps);
    for (most, bounds) in [(most.linear, bounds.linear), (most.angular, bounds.angular)] {
        assert!(most[0] <= bounds.velocity * (1.0 + 1e-9), "{most:?}");
        assert!(most[1] <= bounds.acceleration * (1.0 + 1e-6), "{most:?}");
    }
}

/// A deterministic number in [-1, 1).
fn random(seed: &mut u64) -> f64 {
    *seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
    (*seed >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
}

fn vec3(seed: &mut u64) -> Vec3 {
    Vec3::new(random(seed), random(seed), random(seed))
}

fn polygon(count: usize, size: f64, seed: &mut u64) -> Vec<Pose> {
    let mut at = Vec3::ZERO;
    let mut turn = Rotation::IDENTITY;
    let mut pose = |_| {
        let step = if random(seed) < -0.5 { 0.03 } else { 1.0 };
        at += vec3(seed) * (size * step);
        turn = Rotation::exp(vec3(seed) * step) * turn;
        Pose { translation: at, rotation: turn }
    };
    (0..count).map(&mut pose).collect()
}

/// Speed v on a circle of radius R: at most sqrt(a R), and the bound.
#[test]
fn a_circle_takes_the_time_of_the_curve() {
    for (radius, speed) in [(0.05, f64::INFINITY), (0.05, 0.25), (0.1, 0.25), (0.3, 0.25)] {
        let top = f64::sqrt(radius).min(speed);
        // The way at this speed, and a little more than the ramps at both ends.
        let least = TAU * radius / top;
        let (mut times, limits) = (Vec::new(), bounds(speed, 1.0));
        for count in [50, 200, 2000, 20_000] {
            let poses = circle(radius, count);
            let motion = WaypointMove::new(&poses, limits).unwrap();
            check(&motion, limits, 100_000);
            // At its speed in the middle, at rest at the ends.
            let middle = motion.at(0.5 * motion.duration()).1.linear.norm();
            assert!((middle / top - 1.0).abs() < 5e-3, "{radius} {count}: {middle}");
            assert_eq!((motion.at(0.0).0, motion.at(99.0).0), (poses[0], poses[count as usize]));
            let time = motion.duration();
            assert!(time > least && time < least + 1.4 * top, "{radius} {count}: {time}");
            // The curve is followed to the height of its arcs.
            let arc = radius * (TAU / f64::from(count)).powi(2) / 8.0;
            // Of 50 points, one speed on each segment may be quicker, with wider blends.
            assert!(count == 50 || motion.largest_deviation() <= 1.001 * arc, "{radius} {count}");
            times.push(time);
        }
        for time in &times {
            assert!((time / times[3] - 1.0).abs() < 0.01, "{times:?}");
        }
    }
    // Half a million points, of which neighbours are repetitions.
    let motion = WaypointMove::new(&circle(0.05, 500_000), bounds(0.25, 1.0)).unwrap();
    let coarse = WaypointMove::new(&circle(0.05, 2000), bounds(0.25, 1.0)).unwrap();
    assert!((motion.duration() / coarse.duration() - 1.0).abs() < 1e-2);
}

/// On a line points change nothing, wherever they are; on a turn about an axis likewise.
#[test]
fn points_on_a_line_change_nothing() {
    let mut seed = 3;
    for count in [1, 10, 1000] {
        let mut shares: Vec<f64> = (0..count).map(|_| 0.5 + 0.5 * random(&mut seed)).collect();
        shares.extend([0.0, 1.0]);
        shares.sort_by(f64::total_cmp);
        for (way, turn) in [(Vec3::X, 0.0), (Vec3::ZERO, 1.5), (Vec3::Z * 0.4, 2.0)] {
            let at = |share: &f64| Pose {
                translation: way * *share,
                rotation: Rotation::about_z(turn * share),
            };
            let poses: Vec<Pose> = shares.iter().map(at).collect();
            let motion = WaypointMove::new(&poses, bounds(0.5, 1.0)).unwrap();
            let line = WaypointMove::new(&[at(&0.0), at(&1.0)], bounds(0.5, 1.0)).unwrap();
            assert!((motion.duration() / line.duration() - 1.0).abs() < 1e-9);
            for k in 0..=100 {
                let t = f64::from(k) * 0.01 * line.duration();
                let off = motion.at(t).0.error_to(line.at(t).0);
                assert!(off.linear.norm() + off.angular.norm() < 1e-7, "{off:?}");
            }
        }
    }
}

/// Long lines joined by arcs of many points: lines at full speed, arcs at theirs.
#[test]
fn lines_and_dense_arcs_have_speeds_of_their_own() {
    let rounded = |count: u32| {
        let arc = (0..=count).map(|i| {
            let (sin, cos) = (FRAC_PI_2 * f64::from(i) / f64::from(count)).sin_cos();
            Vec3::new(1.0 + 0.02 * sin, 0.02 * (1.0 - cos), 0.0)
        });
        let ends = [Vec3::ZERO, Vec3::new(1.02, 1.0, 0.0)];
        let all = std::iter::once(ends[0]).chain(arc).chain([ends[1]]);
        all.map(Pose::from_translation).collect::<Vec<_>>()
    };
    let motions =
        [10, 100, 1000].map(|n| WaypointMove::new(&rounded(n), bounds(0.5, 1.0)).unwrap());
    for motion in &motions {
        check(motion, bounds(0.5, 1.0), 100_000);
        // From rest to 0.5 m/s, down to sqrt(a R) = 0.14, through the arc, and back.
        let (top, arc) = (0.5, 0.02_f64.sqrt());
        let line = 2.0 * top - arc + (1.0 - (2.0 * top * top - arc * arc) / 2.0) / top;
        let whole = 2.0 * line + 0.02 * FRAC_PI_2 / arc;
        assert!((motion.duration() / whole - 1.0).abs() < 0.02, "{} {whole}", motion.duration());
    }
}

/// Random polygons: within the bounds, and no slower than with one speed on each segment.
#[test]
fn polygons_are_no_slower_than_with_one_speed_on_each_segment() {
    let mut seed = 7;
    let mut ratios = Vec::new();
    for round in 0..400 {
        let size = 10.0_f64.powf(-1.0 + random(&mut seed));
        let poses = polygon(3 + round % 9, size, &mut seed);
        for (with, limits) in [(true, bounds(0.5, 1.0)), (false, bounds(0.5, 1.0))] {
            let of =
                |pose: &Pose| if with { *pose } else { Pose::from_translation(pose.translation) };
            let poses: Vec<Pose> = poses.iter().map(of).collect();
            let motion = WaypointMove::new(&poses, limits).unwrap();
            if round % 10 == 0 {
                check(&motion, limits, 20_000);
            }
            let before = of_one_speed(&poses, limits);
            let ratio = motion.duration() / before;
            assert!(ratio < 1.0 + 1e-6, "{round}: {} {before}", motion.duration());
            ratios.push(ratio);
        }
    }
    ratios.sort_by(f64::total_cmp);
    assert!(ratios[10] < 0.999, "{}", ratios[10]);
}

/// The duration of the move with one speed on each segment: segments that are too short for their
/// blends are lengthened until they are not (s).
fn of_one_speed(poses: &[Pose], limits: CartesianBounds) -> f64 {
    let ways: Vec<Twist> = poses.windows(2).map(|pair| pair[0].error_to(pair[1])).collect();
    let longest = |way: Twist, linear: f64, angular: f64| {
        (way.linear.norm() / linear).max(way.angular.norm() / angular)
    };
    let full = |way: &Twist| longest(*way, limits.linear.velocity, limits.angular.velocity);
    let mut times: Vec<f64> = ways.iter().map(full).collect();
    for _ in 0..200 {
        let blends: Vec<f64> = (0..=ways.len())
            .map(|i| {
                let twist = |i: usize| ways.get(i).map_or(Twist::ZERO, |w| *w * (1.0 / times[i]));
                let before = if i > 0 { twist(i - 1) } else { Twist::ZERO };
                let cross = before.angular.cross(twist(i).angular).norm();
                let widened = 4.0 / (4.0 - 0.75 * cross).max(1.0);
                longest(twist(i) - before, 1.0, 4.0 / widened)
            })
            .collect();
        let mut is_settled = true;
        for (i, time) in times.iter_mut().enumerate() {
            let needed = 0.5 * (blends[i] + blends[i + 1]);
            if needed > *time * (1.0 + 1e-12) {
                *time = (needed * *time).sqrt().max(*time * 1.001);
                is_settled = false;
            }
        }
        if is_settled {
            return times.iter().sum::<f64>() + 0.5 * (blends[0] + blends[ways.len()]);
        }
    }
    f64::INFINITY
}

/// Moved, turned, scaled in length and in time, and from the end to the start, it is the same motion.
#[test]
fn moves_rotations_scales_and_the_order_change_nothing() {
    let mut seed = 11;
    let limits = bounds(0.5, 1.0);
    let shift = Pose {
        translation: Vec3::new(1.0, -2.0, 0.5),
        rotation: Rotation::exp(Vec3::new(0.3, 1.0, -0.5)),
    };
    let faster = |bounds: KinematicBounds, length: f64, rate: f64| KinematicBounds {
        velocity: bounds.velocity * length * rate,
        acceleration: bounds.acceleration * length * rate * rate,
        ..bounds
    };
    for round in 0..60 {
        let (dense, arcs) = (circle(0.05, 40), polygon(12, 0.2, &mut seed));
        let poses = if round % 3 == 0 { [&arcs[..], &dense].concat() } else { arcs };
        let motion = WaypointMove::new(&poses, limits).unwrap();
        let total = motion.duration();
        let moved: Vec<Pose> = poses.iter().map(|pose| shift * *pose).collect();
        let moved = WaypointMove::new(&moved, limits).unwrap();
        let longer = |pose: &Pose| Pose { translation: pose.translation * 10.0, ..*pose };
        let longer: Vec<Pose> = poses.iter().map(longer).collect();
        let scaled = CartesianBounds {
            linear: faster(limits.linear, 10.0, 3.0),
            angular: faster(limits.angular, 1.0, 3.0),
        };
        let scaled = WaypointMove::new(&longer, scaled).unwrap();
        let reversed: Vec<Pose> = poses.iter().rev().copied().collect();
        let reversed = WaypointMove::new(&reversed, limits).unwrap();
        for k in 0..=200 {
            let t = total * f64::from(k) / 200.0;
            let (pose, twist) = motion.at(t);
            let (there, turned) = moved.at(t);
            let off = (shift * pose).error_to(there);
            assert!(off.linear.norm() + off.angular.norm() < 1e-7, "moved {round} {t}: {off:?}");
            let off = shift.rotation * twist.linear - turned.linear;
            assert!(off.norm() < 1e-6, "moved {round} {t}: {off:?}");
            let (there, _) = scaled.at(t / 3.0);
            let off = (there.translation * 0.1 - pose.translation).norm();
            assert!(off < 1e-7, "scaled {round} {t}: {off}");
            let (there, back) = reversed.at(total - t);
            let off = there.error_to(pose).linear.norm();
            assert!(off < 1e-7, "reversed {round} {t}: {off}");
            let off = (back.linear + twist.linear).norm();
            assert!(off < 1e-6, "reversed {round} {t}: {off}");
        }
    }
}

/// Rotations alone, whose axes turn: within the bound wherever |w0 x w1| is at most that.
#[test]
fn dense_rotations_keep_their_bounds() {
    let limits = bounds(1.0, 3.0);
    for count in [60, 600, 6000] {
        // A tool axis that goes round a cone.
        let pose = |i: i32| {
            let around = Rotation::about_z(TAU * f64::from(i) / f64::from(count));
            let tilt = Rotation::exp(Vec3::X * 0.3);
            Pose { translation: Vec3::ZERO, rotation: around * tilt * around.inverse() }
        };
        let poses: Vec<Pose> = (0..=count).map(pose).collect();
        let motion = WaypointMove::new(&poses, limits).unwrap();
        check(&motion, limits, 50_000);
        assert!(motion.duration() < 2.5, "{count}: {}", motion.duration());
    }
}
