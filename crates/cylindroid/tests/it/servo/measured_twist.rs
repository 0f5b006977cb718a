//! Velocity mode of closed chains whose drives alone are measured.

use cylindroid::closure::assemble;
use cylindroid::control::TwistStatus;
use cylindroid::model::CoordinateKind;

use super::*;

const DT: f64 = 2e-3;

/// Chains of the catalogue with a twist that they can follow.
fn motions() -> [(&'static str, Task, Twist); 3] {
    let linear = |v| Twist { linear: v, angular: Vec3::ZERO };
    let turning =
        Twist { linear: Vec3::new(0.03, -0.02, 0.02), angular: Vec3::new(0.05, 0.0, 0.1) };
    [
        ("stewart", Task::POSE, turning),
        ("five-bar", Task::POSITION, linear(Vec3::new(0.1, 0.05, 0.0))),
        ("delta", Task::POSITION, linear(Vec3::new(0.03, 0.02, -0.02))),
    ]
}

fn prepared(name: &str, task: Task) -> (Mechanism, Servo, Vec<f64>) {
    let mechanism = catalogue::load(name).unwrap();
    let q = assemble(&mechanism, mechanism.home(), &[]).unwrap().q;
    let mut servo = servo(&mechanism, |o| {
        (o.dt, o.command_timeout, o.acceleration) = (DT, 0.05, Some(5.0));
        o.task = task;
    });
    servo.start_from(&q).unwrap();
    (mechanism, servo, q)
}

fn object(mechanism: &Mechanism, q: &[f64]) -> Pose {
    mechanism.state(q).unwrap().pose(mechanism.reference()).unwrap()
}

/// The object follows the twist, and stops when the commands cease, with noise on the encoders and
/// without.
#[test]
fn drives_follow_twists() {
    for (name, task, twist) in motions() {
        for noise in [0.0, 1e-5, 1e-4] {
            let (mechanism, mut servo, mut q) = prepared(name, task);
            let start = object(&mechanism, &q);
            let mut random = Random(33);
            let mut read = |q: &[f64]| -> Vec<f64> {
                mechanism.actuated().map(|i| q[i] + random.within(-noise, noise)).collect()
            };
            let near = 3.0 * noise * mechanism.reach();
            for step in 0..400 {
                // A message every 20 ms.
                let command = (step % 10 == 0).then_some(twist);
                let now = servo.step_twist_actuated(&read(&q), command).unwrap();
                assert_eq!((now.desired, now.timed_out), (twist, false), "{name}");
                assert_eq!(now.status, TwistStatus::Following, "{name} {noise} {step}");
                if step > 100 {
                    let off = now.achieved - twist;
                    assert!(off.linear.norm() < 1e-9 + near / DT * 1e-2, "{name}: {off:?}");
                }
                servo.advance(&mut q);
                // The tracked configuration is the true one.
                let error = object(&mechanism, servo.configuration()).error_to(now.step.pose);
                assert!(error.linear.norm() < 1e-9, "{name}: {error:?}");
            }
            let moved = start.error_to(object(&mechanism, &q));
            let off = moved.linear - twist.linear * (400.0 * DT);
            // The ramp from rest, and the noise.
            assert!(off.norm() < 4e-3 * mechanism.reach() + 2.0 * near, "{name} {noise}: {off:?}");
            let mut last = TwistStatus::Following;
            for step in 0..200 {
                let now = servo.step_twist_actuated(&read(&q), None).unwrap();
                assert_eq!(now.timed_out, step >= 16, "{name} {step}");
                last = now.status;
                servo.advance(&mut q);
            }
            assert_eq!(last, TwistStatus::AtRest, "{name} {noise}");
        }
    }
}

/// Without noise the commands are those of full measurements; sensors that agree change nothing.
#[test]
fn drives_and_sensors_command_as_full_measurements_do() {
    for (name, task, twist) in motions() {
        let (mechanism, mut own, mut q) = prepared(name, task);
        let (mut full, mut more) = (own.clone(), own.clone());
        let is_read = |i: &usize| {
            let c = &mechanism.coordinates()[*i];
            !c.actuated && matches!(c.kind, CoordinateKind::Angle | CoordinateKind::Length)
        };
        let passive = (0..mechanism.n()).find(is_read).unwrap();
        for step in 0..300 {
            let drives: Vec<f64> = mechanism.actuated().map(|i| q[i]).collect();
            let command = (step < 200).then_some(twist);
            let now = own.step_twist_actuated(&drives, command).unwrap();
            let there = full.step_twist(&q, command).unwrap();
            let beside =
                more.step_twist_measured(&drives, &[(passive, q[passive])], command).unwrap();
            assert_eq!((now.status, beside.status), (there.status, there.status), "{name} {step}");
            for other in [&full, &more] {
                for (a, b) in own.joint_velocities().iter().zip(other.joint_velocities()) {
                    assert!((a - b).abs() < 1e-6, "{name} {step}: {a} {b}");
                }
            }
            own.advance(&mut q);
        }
        let drives: Vec<f64> = mechanism.actuated().map(|i| q[i]).collect();
        let driven = mechanism.actuated().next().unwrap();
        let error = more.step_twist_measured(&drives, &[(driven, 0.0)], None).unwrap_err();
        assert!(error.to_string().contains("sensors"), "{error}");
    }
}

/// Positions that no closed configuration nearby has are an error in words of the drives, after which
/// the servo goes on; before the branches meet, it stops and says so.
#[test]
fn a_lost_branch_is_reported() {
    let (five_bar, mut servo, mut q) = prepared("five-bar", Task::POSITION);
    let drives = |q: &[f64]| -> Vec<f64> { five_bar.actuated().map(|i| q[i]).collect() };
    let twist = Twist { linear: Vec3::new(0.1, 0.05, 0.0), angular: Vec3::ZERO };
    for _ in 0..50 {
        servo.step_twist_actuated(&drives(&q), Some(twist)).unwrap();
        servo.advance(&mut q);
    }
    let here = drives(&q);
    let before = servo.joint_velocities().to_vec();
    let apart = [here[0] + 1.0, here[1] - 1.0];
    let error = servo.step_twist_actuated(&apart, Some(twist)).unwrap_err().to_string();
    let said = ["actuated positions = '", "in the last configuration", "loops open by", "five-bar"];
    assert!(said.iter().all(|words| error.contains(words)), "{error}");
    assert_eq!(servo.joint_velocities(), before);
    for (wrong, expected) in
        [(vec![here[0]], "actuated positions"), (vec![here[0], f64::NAN], "actuated positions")]
    {
        let error = servo.step_twist_actuated(&wrong, None).unwrap_err().to_string();
        assert!(error.contains(expected), "{error}");
    }
    let broken = Twist { linear: Vec3::X * f64::NAN, angular: Vec3::ZERO };
    let error = servo.step_twist_actuated(&here, Some(broken)).unwrap_err().to_string();
    assert!(error.contains("commanded twist"), "{error}");
    let now = servo.step_twist_actuated(&here, None).unwrap();
    assert_eq!((now.status, now.desired), (TwistStatus::Following, twist));

    // In every direction of the plane, towards the places where both assemblies meet too: no
    // measurement loses the branch, and where it stalls the reason is that of full measurements.
    let mut reasons = Vec::new();
    for k in 0..8 {
        let along = Rotation::about_z(f64::from(k) * std::f64::consts::FRAC_PI_4) * Vec3::X;
        let twist = Twist { linear: along * 0.3, angular: Vec3::ZERO };
        let ends = [true, false].map(|alone| {
            let (mechanism, mut servo, mut q) = prepared("five-bar", Task::POSITION);
            let mut status = TwistStatus::Following;
            for _ in 0..6000 {
                let drives: Vec<f64> = mechanism.actuated().map(|i| q[i]).collect();
                let now = if alone {
                    servo.step_twist_actuated(&drives, Some(twist))
                } else {
                    servo.step_twist(&q, Some(twist))
                };
                status = now.unwrap().status;
                servo.advance(&mut q);
            }
            (status == TwistStatus::Stalled).then(|| servo.stall().name())
        });
        assert_eq!(ends[0], ends[1], "{k}");
        reasons.extend(ends[0]);
    }
    assert!(reasons.len() > 4 && reasons.contains(&"type-ii"), "{reasons:?}");
}
