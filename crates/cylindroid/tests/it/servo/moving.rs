//! Moving targets: the lag, and stalls of a tool that no longer follows.

use super::*;

const DT: f64 = 4e-3;

fn start(name: &str, acceleration: f64) -> (Mechanism, Servo, Vec<f64>, Pose) {
    let robot = catalogue::load(name).unwrap();
    let servo = servo(&robot, |o| (o.dt, o.acceleration) = (DT, Some(acceleration)));
    let mut q = robot.home().to_vec();
    q.iter_mut().enumerate().for_each(|(i, x)| *x += 0.1 + 0.02 * i as f64);
    let pose = robot.state(&q).unwrap().pose(robot.tool()).unwrap();
    (robot, servo, q, pose)
}

/// Without feed-forward the tool is behind by 1 / gain, with it by a step at most.
#[test]
fn the_lag_is_that_of_the_gain() {
    let (_, mut servo, mut q, pose) = start("panda", 20.0);
    let velocity = Vec3::new(0.0, 0.05, 0.02);
    for feed_forward in [Vec3::ZERO, velocity] {
        let mut lag = f64::NAN;
        servo.reset();
        let from = servo.mechanism().state(&q).unwrap().pose(servo.mechanism().tool()).unwrap();
        for i in 0..500 {
            let translation = from.translation + velocity * (f64::from(i) * DT);
            let feed_forward = Twist { linear: feed_forward, angular: Vec3::ZERO };
            let target = Target { pose: Pose { translation, ..pose }, feed_forward };
            lag = servo.step(&q, target).unwrap().lag;
            servo.advance(&mut q);
        }
        let expected = if feed_forward == Vec3::ZERO { 0.2 } else { 0.0 };
        assert!((lag - expected).abs() < 2.0 * DT, "{lag} s, not {expected} s");
    }
    // A fixed target has no lag.
    for _ in 0..300 {
        servo.step(&q, pose).unwrap();
    }
    assert_eq!(servo.step(&q, pose).unwrap().lag, 0.0);
}

/// A target that moves away for ever is followed to the edge of reach; there the stall is named,
/// although the target moves on, and the tool follows again when it comes back.
#[test]
fn a_target_that_leaves_is_a_stall() {
    for (name, acceleration) in
        ["ur5e", "panda"].iter().flat_map(|n| [f64::INFINITY, 20.0, 2.0].map(|a| (n, a)))
    {
        let (_, mut servo, mut q, pose) = start(name, acceleration);
        let out = pose.translation.unit(1e-9).unwrap();
        let place = |time: f64| {
            let way = if time < 25.0 { 0.1 * time } else { (2.5 - 0.5 * (time - 25.0)).max(0.0) };
            Pose { translation: pose.translation + out * way, ..pose }
        };
        let (mut last, mut stalled_at) = (Status::Moving, f64::NAN);
        for i in 0..(40.0 / DT) as usize {
            let time = i as f64 * DT;
            last = servo.step(&q, place(time)).unwrap().status;
            servo.advance(&mut q);
            if last == Status::Stalled && stalled_at.is_nan() {
                stalled_at = time;
            }
            if (24.0..25.0).contains(&time) {
                let case = format!("{name} at {acceleration} rad/s^2, {time} s");
                assert_eq!(last, Status::Stalled, "{case}");
                assert!(matches!(servo.stall(), Stall::OutOfReach { .. }), "{case}");
            }
        }
        assert!((2.0..20.0).contains(&stalled_at), "{name} {acceleration}: {stalled_at}");
        assert_eq!(last, Status::Reached, "{name} {acceleration}");
    }
}

/// A target that is too fast is followed as near as the limits permit, and so is one that circles
/// beyond reach: the tool is behind, but it moves.
#[test]
fn a_target_that_is_too_fast_is_no_stall() {
    let (_, mut servo, mut q, pose) = start("ur5e", 20.0);
    let mut largest = 0.0_f64;
    let circle = |time: f64, radius: f64, speed: f64| {
        let angle = speed * time / radius;
        Vec3::new(angle.cos() - 1.0, angle.sin(), 0.0) * radius
    };
    for i in 0..(6.0 / DT) as usize {
        let translation = pose.translation + circle(i as f64 * DT, 0.15, 1.0);
        let step = servo.step(&q, Pose { translation, ..pose }).unwrap();
        servo.advance(&mut q);
        assert_ne!(step.status, Status::Stalled, "{i}");
        largest = largest.max(step.lag);
    }
    assert!(largest > 0.02, "{largest}");
    // Around the base, twice as far away as the arm is long.
    for i in 0..(10.0 / DT) as usize {
        let angle = 0.2 * i as f64 * DT;
        let translation = Vec3::new(2.0 * angle.cos(), 2.0 * angle.sin(), 0.3);
        let step = servo.step(&q, Pose { translation, ..pose }).unwrap();
        servo.advance(&mut q);
        assert!(i < 1000 || step.status == Status::Moving, "{i}: {:?}", servo.stall());
    }
}

/// A twist that is fed forward beside the present pose stalls at the edge as in velocity mode.
#[test]
fn a_twist_outwards_is_a_stall() {
    for acceleration in [f64::INFINITY, 20.0, 2.0, 0.5] {
        let (robot, mut servo, mut q, pose) = start("ur5e", acceleration);
        let linear = pose.translation.unit(1e-9).unwrap() * 0.2;
        let mut status = Status::Moving;
        for _ in 0..(15.0 / DT) as usize {
            let pose = robot.state(&q).unwrap().pose(robot.tool()).unwrap();
            let feed_forward = Twist { linear, angular: Vec3::ZERO };
            status = servo.step(&q, Target { pose, feed_forward }).unwrap().status;
            servo.advance(&mut q);
        }
        assert_eq!(status, Status::Stalled, "{acceleration}");
        assert!(matches!(servo.stall(), Stall::Singular { .. }), "{:?}", servo.stall());
    }
}

/// A target that circles beyond reach is followed along the edge, at its angle.
#[test]
fn a_tool_at_the_edge_keeps_pace() {
    let robot = planar(2);
    for gain in [2.0, 5.0] {
        let mut servo = servo(&robot, |o| {
            (o.dt, o.acceleration, o.task) = (DT, Some(20.0), Task::POSITION);
            o.gain = ServoGains { position: gain, orientation: gain };
        });
        let (mut q, speed) = (vec![-1.2, 0.4], 0.3);
        for i in 0..(7.0 / DT) as usize {
            let time = i as f64 * DT;
            let angle = -1.0 + speed * time;
            let out = Vec3::new(angle.cos(), angle.sin(), 0.0) * 2.2;
            let feed_forward = Twist { linear: Vec3::Z.cross(out) * speed, angular: Vec3::ZERO };
            let target = Target { pose: Pose::from_translation(out), feed_forward };
            servo.step(&q, target).unwrap();
            let at = robot.state(&q).unwrap().pose(robot.tool()).unwrap().translation;
            servo.advance(&mut q);
            let behind = angle - at.y.atan2(at.x);
            assert!(time < 3.0 || behind.abs() < 0.02, "{gain} {time} s: {behind} rad");
        }
    }
}
