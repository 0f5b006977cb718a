//! Measured configurations of closed chains: noise on all joints, and actuated joints alone.

use cylindroid::catalogue;
use cylindroid::closure::assemble;
use cylindroid::control::{Status, Task};
use cylindroid::model::{CoordinateKind, Mechanism};
use cylindroid::{Pose, Servo, ServoOptions, Vec3};

use crate::support::Random;

/// Closed chains of the catalogue with a motion that they can make.
const MOTIONS: [(&str, Vec3); 5] = [
    ("five-bar", Vec3::new(0.2, 0.0, 0.0)),
    ("3rrr", Vec3::new(0.02, 0.01, 0.0)),
    ("stewart", Vec3::new(0.05, 0.0, 0.0)),
    ("delta", Vec3::new(0.05, 0.0, 0.0)),
    ("two-arm", Vec3::new(0.05, 0.0, 0.0)),
];

const DT: f64 = 0.002;

fn options(mechanism: &Mechanism, acceleration: f64) -> ServoOptions {
    let mut options = ServoOptions::new(mechanism);
    options.task = Task::POSITION;
    options.dt = DT;
    options.acceleration = Some(acceleration);
    options.tolerance.position = 1e-3;
    options
}

fn pose(mechanism: &Mechanism, q: &[f64]) -> Pose {
    mechanism.state(q).unwrap().pose(mechanism.reference()).unwrap()
}

/// Seconds until the object stays within `near` (m) of the target, on an ideal robot whose encoders
/// have this noise (rad or m).
fn time_to_arrive(name: &str, offset: Vec3, acceleration: f64, noise: f64, near: f64) -> f64 {
    let mechanism = catalogue::load(name).unwrap();
    let mut servo = Servo::new(&mechanism, options(&mechanism, acceleration)).unwrap();
    let mut q = assemble(&mechanism, mechanism.home(), &[]).unwrap().q;
    let mut target = pose(&mechanism, &q);
    target.translation += offset;
    let mut random = Random(5);
    let mut last_far = 0.0;
    for step in 0..2500 {
        let measured: Vec<f64> = q.iter().map(|x| x + random.within(-noise, noise)).collect();
        servo.step(&measured, target).unwrap();
        servo.advance(&mut q);
        let error = (pose(&mechanism, &q).translation - target.translation).norm();
        if error > near {
            last_far = DT * f64::from(step);
        }
    }
    last_far
}

/// With noise on every encoder the object arrives to the size of the noise, in the time without
/// noise and a quarter.
#[test]
fn noise_does_not_stop_closed_chains() {
    for (name, offset) in MOTIONS {
        let reach = catalogue::load(name).unwrap().reach();
        for acceleration in [f64::INFINITY, 5.0] {
            for noise in [1e-5, 1e-4, 1e-3] {
                let near = 1e-3_f64.max(3.0 * noise * reach);
                let ideal = time_to_arrive(name, offset, acceleration, 0.0, near);
                let noisy = time_to_arrive(name, offset, acceleration, noise, near);
                assert!(
                    noisy <= 1.25 * ideal + 0.05,
                    "{name}, noise {noise:e}, acceleration {acceleration}: {noisy} s, {ideal} s"
                );
                assert!(ideal < 4.0, "{name}: {ideal} s");
            }
        }
    }
}

/// From the actuated joints alone: the target is reached, the passive joints are those of the
/// mechanism, and the commands are those of full measurements.
#[test]
fn the_actuated_joints_suffice() {
    for (name, offset) in MOTIONS {
        let mechanism = catalogue::load(name).unwrap();
        let home = assemble(&mechanism, mechanism.home(), &[]).unwrap().q;
        let actuated: Vec<usize> = mechanism.actuated().collect();
        let mut target = pose(&mechanism, &home);
        target.translation += offset;
        let mut full = Servo::new(&mechanism, options(&mechanism, 5.0)).unwrap();
        let mut own = full.clone();
        own.start_from(&home).unwrap();
        let mut q = home.clone();
        let mut status = Status::Moving;
        for _ in 0..2500 {
            let measured: Vec<f64> = actuated.iter().map(|&i| q[i]).collect();
            status = own.step_actuated(&measured, target).unwrap().status;
            full.step(&q, target).unwrap();
            for (a, b) in own.joint_velocities().iter().zip(full.joint_velocities()) {
                assert!((a - b).abs() < 1e-6, "{name}: {a} {b}");
            }
            for (a, b) in own.configuration().iter().zip(&q) {
                assert!((a - b).abs() < 1e-8, "{name}: {a} {b}");
            }
            own.advance(&mut q);
        }
        assert_eq!(status, Status::Reached, "{name}");
    }
}

/// Where each joint brakes by itself, the passive ones move otherwise than commanded: they are tracked
/// all the same, beside limits of drives and up to a type II singularity.
#[test]
fn braking_drives_are_tracked() {
    for (name, acceleration, jerk, offset) in [
        ("delta", 6.26, 102.9, Vec3::new(-0.0955, 0.1845, -0.3163)),
        ("3rrr", 1.5, f64::INFINITY, Vec3::new(-0.03, 0.91, 0.0)),
    ] {
        let mechanism = catalogue::load(name).unwrap();
        let mut options = ServoOptions::new(&mechanism);
        (options.dt, options.acceleration, options.jerk) = (0.01, Some(acceleration), jerk);
        let mut full = Servo::new(&mechanism, options).unwrap();
        let mut own = full.clone();
        let mut q = mechanism.home().to_vec();
        let mut target = pose(&mechanism, &q);
        target.translation += offset;
        let mut has_stalled = false;
        for i in 0..400 {
            let measured: Vec<f64> = mechanism.actuated().map(|i| q[i]).collect();
            let step = full.step(&q, target).unwrap();
            let tracked = own.step_actuated(&measured, target);
            let tracked = tracked.unwrap_or_else(|error| panic!("{name}, step {i}: {error}"));
            assert_eq!(tracked.status, step.status, "{name}, step {i}");
            for (a, b) in own.configuration().iter().zip(&q) {
                assert!((a - b).abs() < 1e-6, "{name}, step {i}: {a} {b}");
            }
            has_stalled |= step.status == Status::Stalled;
            full.advance(&mut q);
        }
        assert!(has_stalled, "{name}");
    }
}

/// Positions of actuated joints that no closed configuration has are an error that says so, and the
/// servo goes on with the next ones.
#[test]
fn impossible_measurements_are_named() {
    let five_bar = catalogue::load("five-bar").unwrap();
    let mut servo = Servo::new(&five_bar, options(&five_bar, 5.0)).unwrap();
    let target = pose(&five_bar, five_bar.home());
    let home: Vec<f64> = five_bar.actuated().map(|i| five_bar.home()[i]).collect();
    servo.step_actuated(&home, target).unwrap();
    let error = servo.step_actuated(&home[..1], target).unwrap_err().to_string();
    assert!(error.contains("actuated positions"), "{error}");
    let error = servo.step_actuated(&[home[0] + 1.0, home[1] - 1.0], target).unwrap_err();
    let error = error.to_string();
    assert!(error.contains("loops open by"), "{error}");
    let said = ["actuated positions = '", "in the last configuration", "five-bar", "start_from"];
    assert!(said.iter().all(|words| error.contains(words)), "{error}");
    assert!(!error.contains("q = loops"), "{error}");
    let error = servo.step_actuated(&[f64::NAN, home[1]], target).unwrap_err();
    assert!(error.to_string().contains("actuated positions"), "{error}");
    servo.step_actuated(&home, target).unwrap();
}

/// Passive joints that are measured too lower the error of the object; wrong ones are named.
#[test]
fn redundant_sensors_lower_the_noise() {
    for (name, task) in [("five-bar", Task::POSITION), ("stewart", Task::POSE)] {
        let mechanism = catalogue::load(name).unwrap();
        let q = assemble(&mechanism, mechanism.home(), &[]).unwrap().q;
        let target = pose(&mechanism, &q);
        let scalar = |i: &usize| {
            let c = &mechanism.coordinates()[*i];
            !c.actuated && matches!(c.kind, CoordinateKind::Angle | CoordinateKind::Length)
        };
        let passive: Vec<usize> = (0..mechanism.n()).filter(scalar).collect();
        assert!(!passive.is_empty(), "{name}");
        let mut random = Random(8);
        let mut estimated = |with: bool| {
            let mut options = options(&mechanism, 5.0);
            options.task = task;
            let mut servo = Servo::new(&mechanism, options).unwrap();
            servo.start_from(&q).unwrap();
            let mut square = 0.0;
            for _ in 0..400 {
                let mut read = |i: usize| q[i] + random.within(-1e-4, 1e-4);
                let actuated: Vec<f64> = mechanism.actuated().map(&mut read).collect();
                let sensors: Vec<(usize, f64)> =
                    passive.iter().filter(|_| with).map(|&i| (i, read(i))).collect();
                servo.step_measured(&actuated, &sensors, target).unwrap();
                let here = pose(&mechanism, servo.configuration());
                let off = here.error_to(target);
                square += off.linear.dot(off.linear) + off.angular.dot(off.angular);
            }
            (square / 400.0).sqrt()
        };
        let (alone, both) = (estimated(false), estimated(true));
        println!("{name}: {alone:.2e} {both:.2e}");
        assert!(both < 0.9 * alone, "{name}: {both} beside {alone}");

        // Without noise nothing changes.
        let mut servo = Servo::new(&mechanism, options(&mechanism, 5.0)).unwrap();
        servo.start_from(&q).unwrap();
        let actuated: Vec<f64> = mechanism.actuated().map(|i| q[i]).collect();
        let sensors: Vec<(usize, f64)> = passive.iter().map(|&i| (i, q[i])).collect();
        servo.step_measured(&actuated, &sensors, target).unwrap();
        for (a, b) in servo.configuration().iter().zip(&q) {
            assert!((a - b).abs() < 1e-9, "{name}");
        }
        // In any order.
        let read: Vec<(usize, f64)> =
            passive.iter().map(|&i| (i, q[i] + random.within(-1e-4, 1e-4))).collect();
        let reversed: Vec<(usize, f64)> = read.iter().rev().copied().collect();
        let [one, other] = [read, reversed].map(|sensors| {
            servo.start_from(&q).unwrap();
            servo.step_measured(&actuated, &sensors, target).unwrap();
            servo.configuration().to_vec()
        });
        assert_eq!(one, other, "{name}");
        let driven = mechanism.actuated().next().unwrap();
        for wrong in [driven, mechanism.n()] {
            let error = servo.step_measured(&actuated, &[(wrong, 0.0)], target).unwrap_err();
            let error = error.to_string();
            assert!(error.contains("sensors"), "{error}");
            let name = mechanism.coordinates().get(wrong).map(|c| format!("'{}'", c.name));
            assert!(name.is_none_or(|name| error.contains(&name)), "{error}");
        }
        let error = servo.step_measured(&actuated, &[(passive[0], f64::NAN)], target).unwrap_err();
        let name = &mechanism.coordinates()[passive[0]].name;
        assert!(error.to_string().contains(name), "{error}");
    }
}
