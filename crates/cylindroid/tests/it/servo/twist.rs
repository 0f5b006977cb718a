//! Velocity mode: twists that are followed, the watchdog, verdicts at limits and edges.

use cylindroid::Twist;
use cylindroid::control::{TwistStatus, TwistStep, simulate_twist};

use super::*;

const DT: f64 = 2e-3;

fn linear(v: Vec3) -> Twist {
    Twist { linear: v, angular: Vec3::ZERO }
}

/// Follows a twist that is commanded in every step for `seconds`; the last step.
fn follow(servo: &mut Servo, q: &mut [f64], twist: Twist, seconds: f64) -> TwistStep {
    let mut last = None;
    for _ in 0..(seconds / DT) as usize {
        last = Some(servo.step_twist(q, Some(twist)).unwrap());
        servo.advance(q);
    }
    last.unwrap()
}

#[test]
fn a_twist_is_followed_in_world_axes() {
    for name in ["panda", "ur5e", "iiwa14"] {
        let robot = catalogue::load(name).unwrap();
        for axes in [ReferenceFrame::LocalWorldAligned, ReferenceFrame::Local] {
            let mut servo = servo(&robot, |o| {
                o.dt = DT;
                o.task.axes = axes;
            });
            let mut q = robot.home().to_vec();
            q.iter_mut().enumerate().for_each(|(i, x)| *x += 0.1 + 0.02 * i as f64);
            let start = robot.state(&q).unwrap().pose(robot.tool()).unwrap();
            let twist =
                Twist { linear: Vec3::new(0.02, -0.03, 0.05), angular: Vec3::new(0.1, 0.05, -0.1) };
            let now = follow(&mut servo, &mut q, twist, 0.5);
            assert_eq!(
                (now.status, now.timed_out, now.desired),
                (TwistStatus::Following, false, twist)
            );
            for (a, b) in now.achieved.to_array().iter().zip(twist.to_array()) {
                assert!((a - b).abs() < 1e-9, "{name}: {a} instead of {b}");
            }
            let end = robot.state(&q).unwrap().pose(robot.tool()).unwrap();
            let moved = end.translation - start.translation - twist.linear * 0.5;
            assert!(moved.norm() < 2e-3, "{name}: {moved:?}");
        }
    }
}

/// A command holds for the timeout; then the joints brake within their acceleration limits.
#[test]
fn the_watchdog_stops_the_arm() {
    let panda = catalogue::load("panda").unwrap();
    let mut servo = servo(&panda, |o| {
        (o.dt, o.command_timeout) = (DT, 0.05);
        o.secondary = vec![SecondaryTask::LimitAvoidance { gain: 0.5, margin: 0.2 }];
    });
    let mut q = panda.home().to_vec();
    let down = linear(-Vec3::Z * 0.2);
    assert_eq!(servo.step_twist(&q, None).unwrap().status, TwistStatus::AtRest);
    assert_eq!(follow(&mut servo, &mut q, down, 0.5).status, TwistStatus::Following);
    let held = (0.05 / DT) as usize;
    let (mut held_for, mut before) = (0, servo.joint_velocities().to_vec());
    let mut last = TwistStatus::Following;
    for _ in 0..200 {
        let now = servo.step_twist(&q, None).unwrap();
        held_for += usize::from(!now.timed_out);
        assert_eq!(now.desired, if now.timed_out { Twist::ZERO } else { down });
        for ((rate, before), c) in
            servo.joint_velocities().iter().zip(&before).zip(panda.coordinates())
        {
            assert!((rate - before).abs() <= c.limits.acceleration * DT * (1.0 + 1e-9));
        }
        before.copy_from_slice(servo.joint_velocities());
        servo.advance(&mut q);
        last = now.status;
    }
    assert!(held_for == held || held_for + 1 == held, "{held_for}");
    assert_eq!(last, TwistStatus::AtRest);
    assert!(servo.joint_velocities().iter().all(|rate| *rate == 0.0));
    // It goes on with the next command, and a reset forgets it.
    assert_eq!(follow(&mut servo, &mut q, down, 0.1).status, TwistStatus::Following);
    servo.reset();
    assert_eq!(servo.step_twist(&q, None).unwrap().desired, Twist::ZERO);
}

/// Without a command every joint brakes, those of self-motions too: a panda turned its elbow for
/// seconds.
#[test]
fn without_a_command_all_joints_brake() {
    let mut random = Random(31);
    for name in ["panda", "iiwa14", "ur5e", "youbot"] {
        let robot = catalogue::load(name).unwrap();
        for _ in 0..12 {
            let mut servo = servo(&robot, |o| (o.dt, o.command_timeout) = (DT, DT));
            let middle = |c: &cylindroid::model::Coordinate| {
                let (lower, upper) = (c.limits.lower.max(-3.0), c.limits.upper.min(3.0));
                lower + (upper - lower) * random.within(0.2, 0.8)
            };
            let mut q: Vec<f64> = robot.coordinates().iter().map(middle).collect();
            let twist = Twist { linear: random.vec3(0.2), angular: random.vec3(0.2) };
            follow(&mut servo, &mut q, twist, 0.4);
            servo.step_twist(&q, None).unwrap();
            let mut before = servo.joint_velocities().to_vec();
            // 20 rad/s^2 is the default ramp.
            let slowest = before
                .iter()
                .zip(robot.coordinates())
                .map(|(rate, c)| rate.abs() / c.limits.acceleration.min(20.0));
            let time = slowest.fold(0.0, f64::max);
            for _ in 0..(time / DT) as usize + 2 {
                servo.advance(&mut q);
                servo.step_twist(&q, None).unwrap();
                for (rate, before) in servo.joint_velocities().iter().zip(&before) {
                    assert!(rate.abs() <= before.abs(), "{name}: {rate} after {before}");
                }
                before.copy_from_slice(servo.joint_velocities());
            }
            assert!(before.iter().all(|rate| *rate == 0.0), "{name}: {before:?} after {time} s");
        }
    }
}

/// Drives that stand still are at rest, whatever noise the passive joints correct.
#[test]
fn closed_chains_brake_under_noise() {
    let mut random = Random(32);
    for name in ["stewart", "two-arm", "delta", "five-bar"] {
        let robot = catalogue::load(name).unwrap();
        let mut servo = servo(&robot, |o| (o.dt, o.command_timeout) = (DT, DT));
        let mut q = robot.home().to_vec();
        let mut status = TwistStatus::Following;
        for step in 0..300 {
            let noisy: Vec<f64> = q.iter().map(|x| x + random.within(-1e-4, 1e-4)).collect();
            let command = (step < 100).then_some(linear(Vec3::X * 0.02));
            status = servo.step_twist(&noisy, command).unwrap().status;
            servo.advance(&mut q);
        }
        assert_eq!(status, TwistStatus::AtRest, "{name}");
    }
}

#[test]
fn pushed_outwards_it_stalls_and_says_why() {
    // At the edge of the workspace: the arm is stretched.
    let ur5e = catalogue::load("ur5e").unwrap();
    for acceleration in [f64::INFINITY, 40.0] {
        let mut servo = servo(&ur5e, |o| (o.dt, o.acceleration) = (DT, Some(acceleration)));
        let mut q = vec![0.0, -1.0, 1.2, -0.4, 1.3, 0.2];
        let out = linear(
            ur5e.state(&q).unwrap().pose(ur5e.tool()).unwrap().translation.unit(1e-9).unwrap()
                * 0.2,
        );
        let now = follow(&mut servo, &mut q, out, 8.0);
        assert_eq!(now.status, TwistStatus::Stalled, "{acceleration}: {now:?}");
        assert!(matches!(servo.stall(), Stall::Singular { .. }), "{:?}", servo.stall());
        // The way back is open.
        let back = linear(out.linear * -1.0);
        let now = follow(&mut servo, &mut q, back, 0.1);
        assert_ne!(now.status, TwistStatus::Stalled, "{acceleration}");
    }
    // At a position limit.
    let lever = planar(1);
    let mut servo = servo(&lever, |o| (o.dt, o.task) = (DT, Task::POSITION));
    let mut q = vec![2.9];
    let spin = |q: &[f64]| linear(Vec3::new(-q[0].sin(), q[0].cos(), 0.0) * 0.3);
    let mut now = None;
    for _ in 0..1000 {
        now = Some(servo.step_twist(&q, Some(spin(&q))).unwrap());
        servo.advance(&mut q);
    }
    assert!(q[0] <= 3.0 && now.unwrap().status == TwistStatus::Stalled, "{q:?} {now:?}");
    assert_eq!(servo.stall(), Stall::Limits { coordinates: vec![0] });
    let robot = planar(2);
    // A direction that no joint can move.
    let mut q = vec![0.3, 0.9];
    let mut servo = self::servo(&robot, |o| (o.dt, o.task) = (DT, Task::POSE));
    let now = follow(&mut servo, &mut q, linear(Vec3::Z), 2.0);
    assert_eq!((now.status, q), (TwistStatus::Stalled, vec![0.3, 0.9]));
    assert!(matches!(servo.stall(), Stall::TooFewJoints { .. }), "{:?}", servo.stall());
}

/// Weak joints were pushed through the edge and came back by 0.07 m (iiwa14) and 0.05 m (youbot, whose five
/// joints follow no twist for long), again and again.
#[test]
fn pushed_outwards_weak_arms_do_not_swing() {
    for name in ["iiwa14", "youbot"] {
        for acceleration in [0.5, 2.0] {
            let robot = super::closed_edges::weakened(name, acceleration);
            for (start, axis) in [0, 1].into_iter().flat_map(|s| [Vec3::X, Vec3::Z].map(|a| (s, a)))
            {
                for axis in [axis, -axis] {
                    let turned = |i: usize| ((i * 7 + start * 13) as f64 * 0.618_034).fract() - 0.5;
                    let mut q: Vec<f64> = robot.home().to_vec();
                    for (i, (x, c)) in q.iter_mut().zip(robot.coordinates()).enumerate() {
                        *x += if start == 0 { 0.0 } else { 0.6 * turned(i) };
                        *x = x.min(c.limits.upper - 0.05).max(c.limits.lower + 0.05);
                    }
                    let mut servo = servo(&robot, |o| o.dt = 1e-2);
                    let place = |q: &[f64]| {
                        robot.state(q).unwrap().pose(robot.tool()).unwrap().translation.dot(axis)
                    };
                    let (mut farthest, mut back) = (place(&q), 0.0_f64);
                    for _ in 0..1200 {
                        servo.step_twist(&q, Some(linear(axis * 0.25))).unwrap();
                        servo.advance(&mut q);
                        farthest = farthest.max(place(&q));
                        back = back.max(farthest - place(&q));
                    }
                    println!("{name} {acceleration} {start} {axis:?}: {back:.5}");
                    assert!(back < 0.01, "{name} {acceleration} {start} {axis:?}: {back} m");
                }
            }
        }
    }
}

#[test]
fn closed_chains_follow_twists_too() {
    let five_bar = catalogue::load("five-bar").unwrap();
    let mut servo = servo(&five_bar, |o| {
        o.dt = DT;
        o.task = Task::named("x,y", &five_bar).unwrap();
    });
    let mut q = five_bar.home().to_vec();
    let twist = linear(Vec3::new(0.05, 0.1, 0.0));
    let now = follow(&mut servo, &mut q, twist, 0.4);
    assert_eq!(now.status, TwistStatus::Following);
    assert!((now.achieved - twist).linear.norm() < 1e-6, "{:?}", now.achieved);
}

/// A twist out of the plane of a planar chain moves nothing, and does not count as followed.
#[test]
fn twists_out_of_the_task_are_not_followed() {
    for name in ["five-bar", "3rrr"] {
        let robot = catalogue::load(name).unwrap();
        let mut servo = servo(&robot, |o| o.dt = DT);
        let now = servo.step_twist(robot.home(), Some(linear(Vec3::Z))).unwrap();
        assert_eq!((now.status, now.desired), (TwistStatus::AtRest, Twist::ZERO), "{name}");
        // However slow it is.
        let command = |time: f64, _: &[f64]| Ok((time < 0.1).then_some(linear(Vec3::Z * 1e-3)));
        let result = simulate_twist(&mut servo, robot.home(), 1.0, command, |_| ()).unwrap();
        assert_eq!((result.reached, result.followed), (false, Some(0.0)), "{name}");
    }
}

/// The share of a motion that joints at their largest velocities make is told; ramps take nothing of it.
#[test]
fn what_is_not_followed_is_told() {
    for name in ["panda", "ur5e", "stewart"] {
        let robot = catalogue::load(name).unwrap();
        let share = |speed: f64| {
            let mut servo = servo(&robot, |o| (o.dt, o.acceleration) = (DT, Some(10.0)));
            let twist = linear(Vec3::Z * -speed);
            let command = |time: f64, _: &[f64]| Ok((time < 0.5).then_some(twist));
            let result = simulate_twist(&mut servo, robot.home(), 10.0, command, |_| ()).unwrap();
            (result.reached, result.followed.unwrap())
        };
        let (reached, followed) = share(0.05);
        assert!(reached && (followed - 1.0).abs() < 0.01, "{name}: {followed}");
        let (reached, followed) = share(20.0);
        assert!(!reached && followed < 0.5, "{name}: {followed}");
    }
}

#[test]
fn a_broken_twist_is_refused() {
    let panda = catalogue::load("panda").unwrap();
    let mut servo = servo(&panda, |_| {});
    for twist in [linear(Vec3::X * f64::NAN), linear(Vec3::Y * f64::INFINITY)] {
        let error = servo.step_twist(panda.home(), Some(twist)).unwrap_err().to_string();
        assert!(error.contains("commanded twist"), "{error}");
    }
    // Its size, and not what it would make of the joint velocities.
    let said = "[0] = 1e308 is out of range: magnitudes up to 1e120 are accepted";
    let beyond = linear(Vec3::X * 1e308);
    let error = servo.step_twist(panda.home(), Some(beyond)).unwrap_err().to_string();
    assert_eq!(error, format!("commanded twist{said}"));
    let pose = panda.state(panda.home()).unwrap().pose(panda.tool()).unwrap();
    let target = Target { pose, feed_forward: beyond };
    let error = servo.step(panda.home(), target).unwrap_err().to_string();
    assert_eq!(error, format!("feed-forward twist{said}"));
    servo.step_twist(panda.home(), Some(linear(Vec3::X * -1e120))).unwrap();
    assert!(servo.joint_velocities().iter().all(|v| v.is_finite()));
    assert!(servo.step_twist(&[0.0; 3], None).is_err());
    let options = ServoOptions { command_timeout: 0.0, ..ServoOptions::new(&panda) };
    let error = Servo::new(&panda, options).unwrap_err().to_string();
    assert!(error.contains("command timeout"), "{error}");
}
