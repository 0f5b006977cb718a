//! Joint weights from the masses of the model.

use cylindroid::control::Task;
use cylindroid::model::{Inertial, JointKind, JointSpec, Link};
use cylindroid::spatial::{Mat3, Pose, Vec3};
use cylindroid::{Mechanism, Servo, ServoOptions};

/// A planar arm of four links with masses of their own, the first much heavier.
fn arm(masses: bool) -> Mechanism {
    let mut builder = Mechanism::builder("arm");
    builder.link(Link::named("ground"));
    for i in 0..4 {
        let inertial = Inertial {
            mass: if i == 0 { 50.0 } else { 1.0 },
            link_from_inertia: Pose::from_translation(Vec3::X * 0.2),
            inertia: Mat3::from_rows([[0.1, 0.0, 0.0], [0.0, 0.1, 0.0], [0.0, 0.0, 0.1]]),
        };
        let inertial = masses.then_some(inertial);
        builder.link(Link { inertial, ..Link::named(&format!("l{i}")) });
    }
    for i in 0..4 {
        let (parent, x) =
            if i == 0 { ("ground".into(), 0.0) } else { (format!("l{}", i - 1), 0.4) };
        builder.joint(JointSpec {
            parent_from_joint: Pose::from_translation(Vec3::X * x),
            ..JointSpec::new(&format!("q{i}"), JointKind::Revolute, &parent, &format!("l{i}"))
        });
    }
    builder.frame("tip", "l3", Pose::from_translation(Vec3::X * 0.4)).tool("tip");
    builder.build().unwrap()
}

fn servo(arm: &Mechanism, inertia: bool, weights: Vec<f64>) -> cylindroid::Result<Servo> {
    let options = ServoOptions {
        task: Task::POSITION,
        inertia_weights: inertia,
        joint_weights: weights,
        acceleration: Some(f64::INFINITY), // the first step is compared
        ..ServoOptions::new(arm)
    };
    Servo::new(arm, options)
}

/// Step by step, the velocities are those of a servo with the diagonal of the mass matrix at that
/// configuration as weights.
#[test]
fn weights_follow_the_configuration() {
    let arm = arm(true);
    let mut by_inertia = servo(&arm, true, vec![]).unwrap();
    for q in [[0.3, 0.8, -0.5, 0.9], [1.0, -0.7, 0.4, 0.2]] {
        let state = arm.state(&q).unwrap();
        let mass = state.mass_matrix();
        let start = state.pose(arm.tool()).unwrap();
        let target = Pose { translation: start.translation + Vec3::new(0.01, -0.02, 0.0), ..start };
        let weights = (0..4).map(|i| mass[(i, i)]).collect();
        let mut by_weights = servo(&arm, false, weights).unwrap();
        by_inertia.step(&q, target).unwrap();
        by_weights.step(&q, target).unwrap();
        let (a, b) = (by_inertia.joint_velocities(), by_weights.joint_velocities());
        assert!(a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-10), "{a:?} {b:?}");
        // Less, in the norm of the weights, than without them.
        let size = |v: &[f64]| -> f64 { (0..4).map(|i| mass[(i, i)] * v[i] * v[i]).sum() };
        let mut plain = servo(&arm, false, vec![]).unwrap();
        plain.step(&q, target).unwrap();
        assert!(size(a) < 0.9 * size(plain.joint_velocities()));
    }
}

#[test]
fn missing_masses_and_contradictions_are_refused() {
    let error = servo(&arm(false), true, vec![]).unwrap_err().to_string();
    assert!(error.contains("without mass") && error.contains("l0"), "{error}");
    let error = servo(&arm(true), true, vec![1.0; 4]).unwrap_err().to_string();
    assert!(error.contains("keep one"), "{error}");
}
