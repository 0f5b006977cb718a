//! The inverses near singularities: figure eights of the tool, targets beyond reach, random motions.

use super::escape::{out_and_back, within};
use super::*;

/// Error of the position and changes of the joint velocities over figure eights.
#[derive(Debug, Default)]
struct Figures {
    /// Mean of the errors (m).
    mean: f64,
    /// Mean of the largest errors (m).
    largest: f64,
    /// Sum of the changes of all joint velocities, mean over the figures [rad/s].
    changes: f64,
}

/// Two rounds of a figure eight of 16 cm by 8 cm, each in 6 s, with a fixed orientation; all but the
/// first second counts.
fn figure_eight(servo: &mut Servo, q: &mut [f64], axes: (Vec3, Vec3)) -> Figures {
    let (dt, w, size) = (servo.options().dt, std::f64::consts::TAU / 6.0, 0.08);
    let pose = servo.mechanism().state(q).unwrap().pose(servo.mechanism().tool()).unwrap();
    let mut before = vec![0.0; servo.mechanism().n()];
    let steps = (12.0 / dt) as usize;
    let mut figures = Figures::default();
    for i in 0..steps {
        let time = i as f64 * dt;
        let (a, b) = axes;
        let (x, y) = (size * (w * time).sin(), 0.5 * size * (2.0 * w * time).sin());
        let (v, u) = (size * w * (w * time).cos(), size * w * (2.0 * w * time).cos());
        let target = Target {
            pose: Pose { translation: pose.translation + a * x + b * y, ..pose },
            feed_forward: Twist { linear: a * v + b * u, angular: Vec3::ZERO },
        };
        let error = servo.step(q, target).unwrap().position_error;
        servo.advance(q);
        if time > 1.0 {
            figures.largest = figures.largest.max(error);
            figures.mean += error / (steps as f64 * 11.0 / 12.0);
        }
        figures.changes += change(servo, &mut before);
    }
    figures
}

/// Sum of the changes of the joint velocities in a step [rad/s].
fn change(servo: &Servo, before: &mut [f64]) -> f64 {
    let pairs = servo.joint_velocities().iter().zip(before);
    pairs.map(|(now, before)| (now - std::mem::replace(before, *now)).abs()).sum()
}

/// The measurement behind the default method of a servo: targets that leave reach and come back, and random
/// targets within the limits by the servo alone.
#[test]
#[ignore = "a minute in a release build; the table of docs/guide/inverses.md"]
fn inverses_of_servos() {
    for method in Method::ALL {
        let (mut returned, mut arrived, mut time) = (0, 0, 0.0);
        let [mut away, mut straight] = [0.0; 2];
        for name in ["panda", "ur5e", "iiwa14", "puma560", "youbot"] {
            let robot = catalogue::load(name).unwrap();
            let mut options = ServoOptions { dt: 4e-3, method, ..ServoOptions::new(&robot) };
            options.secondary = options.default_secondary(&robot).unwrap();
            let mut random = Random(191);
            for k in 0..60 {
                let mut q = within(&robot, &mut random);
                let pose = robot.state(&q).unwrap().pose(robot.tool()).unwrap();
                let direction = [Vec3::X, Vec3::Y, Vec3::Z][k / 2 % 3] * [1.0, -1.0][k % 2];
                let mut servo = Servo::new(&robot, options.clone()).unwrap();
                let mut before = vec![0.0; robot.n()];
                let (is_back, _) = out_and_back(&mut servo, &mut q, pose, direction, |servo| {
                    away += change(servo, &mut before);
                });
                returned += usize::from(is_back);
            }
            for _ in 0..150 {
                let mut q = random.q(&robot);
                let target = robot.state(&random.q(&robot)).unwrap().pose(robot.tool()).unwrap();
                let mut servo = Servo::new(&robot, options.clone()).unwrap();
                let mut before = vec![0.0; robot.n()];
                for i in 1..=7500 {
                    let step = servo.step(&q, target).unwrap();
                    servo.advance(&mut q);
                    straight += change(&servo, &mut before);
                    if step.status == Status::Reached {
                        (arrived, time) = (arrived + 1, time + f64::from(i) * options.dt);
                    }
                    if step.status != Status::Moving {
                        break;
                    }
                }
            }
        }
        println!(
            "{:24} back {returned} of 300, changes {:3.0} rad/s; arrived {arrived} of 750 after \
             {:.2} s, changes {:2.0} rad/s",
            method.name(),
            away / 300.0,
            time / f64::from(arrived),
            straight / 750.0
        );
    }
}

/// From random configurations with a singular ratio about 0.01. Every inverse but the slow one stays
/// within a few centimetres in the mean, and damped ones change the joint velocities less.
#[test]
fn inverses_near_singularities() {
    let arms = ["panda", "ur5e", "iiwa14", "puma560"];
    let mut changes = Vec::new();
    for method in Method::ALL {
        let mut all = Figures::default();
        for name in arms {
            let robot = catalogue::load(name).unwrap();
            let mut options = ServoOptions { dt: 4e-3, method, ..ServoOptions::new(&robot) };
            options.secondary = options.default_secondary(&robot).unwrap();
            let mut servo = Servo::new(&robot, options).unwrap();
            let (mut random, mut runs) = (Random(23), 0);
            let mut sum = Figures::default();
            while runs < 10 {
                let mut q = random.q(&robot);
                let ratio = servo.condition(&q).unwrap().singular_ratio;
                if !(5e-3..2e-2).contains(&ratio) {
                    continue;
                }
                runs += 1;
                let axes = [(Vec3::X, Vec3::Y), (Vec3::Y, Vec3::Z), (Vec3::Z, Vec3::X)][runs % 3];
                servo.reset();
                let figures = figure_eight(&mut servo, &mut q, axes);
                sum.mean += figures.mean / 10.0;
                sum.largest += figures.largest / 10.0;
                sum.changes += figures.changes / 10.0;
            }
            println!(
                "{:24} {name:8} mean error {:5.1} mm, largest {:5.1} mm, changes {:4.0} rad/s",
                method.name(),
                1e3 * sum.mean,
                1e3 * sum.largest,
                sum.changes
            );
            all.mean += sum.mean / 4.0;
            all.largest += sum.largest / 4.0;
            all.changes += sum.changes / 4.0;
        }
        println!(
            "{:24} all      mean error {:5.1} mm, largest {:5.1} mm, changes {:4.0} rad/s",
            method.name(),
            1e3 * all.mean,
            1e3 * all.largest,
            all.changes
        );
        let slow = matches!(method, Method::SelectivelyDamped { .. });
        assert!(slow || all.mean < 0.05, "{}: {all:?}", method.name());
        changes.push((method, all.changes));
    }
    let of = |name: &str| changes.iter().find(|(m, _)| m.name() == name).unwrap().1;
    assert!(of("variable-damping") < of("truncated"));
}
