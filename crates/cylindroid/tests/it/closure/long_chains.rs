//! Mechanisms with many more joints than constraints: the compressed analysis is the plain one.

use cylindroid::closure::{
    ClosedChain, Constraint, ConstraintBlocks, Diagnosis, FiniteMobility, Mobility, MotionSpace,
    Subspace,
};
use cylindroid::control::{MotionTask, TaskObjective, TaskServo, TaskServoOptions};
use cylindroid::ik::{Goal, IkOptions, Solver};
use cylindroid::model::{JointKind, JointSpec, LoopJointSpec};
use cylindroid::spatial::{Pose, Rotation, Vec3};
use cylindroid::{Error, Matrix, Mechanism, ReferenceFrame, Servo, ServoOptions};

use crate::support::Random;

/// A chain of `n` joints; every third passive, every eighth spherical if asked for; closed by a
/// spherical joint to ground if asked for.
fn chain(n: usize, passive: bool, spherical: bool, closed: bool) -> Mechanism {
    let mut random = Random(5);
    let mut b = Mechanism::builder("chain");
    let mut tip = Pose::IDENTITY;
    for i in 0..n {
        let mut any = |size: f64| {
            let mut x = || random.within(-size, size);
            Vec3::new(x(), x(), x())
        };
        let place = Pose { rotation: Rotation::exp(any(1.5)), translation: any(0.3) };
        tip = tip * place;
        let kind = if spherical && i % 8 == 3 { JointKind::Spherical } else { JointKind::Revolute };
        let parent = if i == 0 { "ground".to_owned() } else { format!("l{i}") };
        b.joint(JointSpec {
            parent_from_joint: place,
            actuated: !(passive && i % 3 == 1),
            ..JointSpec::new(&format!("q{i}"), kind, &parent, &format!("l{}", i + 1))
        });
    }
    if closed {
        b.loop_joint(LoopJointSpec {
            link_b_from_joint: tip,
            ..LoopJointSpec::new("loop", JointKind::Spherical, &format!("l{n}"), "ground")
        });
        b.reference("l40");
    }
    b.build().unwrap()
}

/// The largest entry of the part of `one` outside the span of `other`, both orthonormalised.
fn outside(one: &Matrix, other: &Matrix) -> f64 {
    use cylindroid::linalg::{ColumnSpace, Threshold};
    let [a, b] = [one, other].map(|m| ColumnSpace::of(m, Threshold::Relative(1e-9)).basis());
    let along = &b * &(&b.transpose() * &a);
    let rest = Matrix::from_fn(a.rows(), a.cols(), |i, j| a[(i, j)] - along[(i, j)]);
    rest.max_abs()
}

#[test]
fn compressed_reports_are_the_plain_ones() {
    for (n, passive, spherical, closed) in [
        (80, false, false, false),
        (100, true, false, false),
        (75, true, true, false),
        (120, true, true, true),
        (260, true, false, true),
    ] {
        let what = format!("{n} passive {passive} spherical {spherical} closed {closed}");
        let m = chain(n, passive, spherical, closed);
        let state = m.state(m.home()).unwrap();
        let constraint = ClosedChain::of(&state, None, None).unwrap().constraint;
        let motions = MotionSpace::of(&constraint);
        let plain = Mobility::from_parts(&constraint, &motions, &motions.relation());
        let found = Mobility::of(&constraint);
        assert_eq!(found.relation, plain.relation, "{what}");
        assert_eq!(found.gruebler_kutzbach, plain.gruebler_kutzbach, "{what}");
        let spaces = |m: &Mobility| -> Vec<Subspace> {
            [
                &m.dof,
                &m.redundancy,
                &m.indeterminacy,
                &m.coordinate,
                &m.coordinate_kinds.passive,
                &m.coordinate_kinds.object,
                &m.coordinate_kinds.both,
                &m.mixed,
                &m.idle,
                &m.uncontrollable_object_motions,
                &m.internal,
                &m.zero_torque,
                &m.hyperstatic,
            ]
            .map(Clone::clone)
            .to_vec()
        };
        for (i, (a, b)) in spaces(&found).iter().zip(&spaces(&plain)).enumerate() {
            assert_eq!(a.dimension(), b.dimension(), "{what}: space {i}");
            assert_eq!(a.basis.rows(), b.basis.rows(), "{what}: space {i}");
            assert!(outside(&a.basis, &b.basis) < 1e-8, "{what}: space {i}");
        }
        for (a, b) in found.joints.iter().zip(&plain.joints) {
            assert!((a.share - b.share).abs() < 1e-9, "{what}: {a:?} {b:?}");
            let same = (a.moves, a.free_of_actuators, a.idle);
            assert_eq!(same, (b.moves, b.free_of_actuators, b.idle), "{what}");
        }
    }
}

/// Straight, a chain of a thousand joints is singular: pulled along its line no torque resists.
#[test]
fn a_thousand_joints_have_a_verdict() {
    let mut b = Mechanism::builder("straight");
    for i in 0..1000 {
        let parent = if i == 0 { "ground".to_owned() } else { format!("l{i}") };
        let x = if i == 0 { 0.0 } else { 0.1 };
        b.joint(JointSpec {
            parent_from_joint: Pose::from_translation(Vec3::X * x),
            axis: [Vec3::Z, Vec3::Y][i % 2],
            actuated: true,
            ..JointSpec::new(&format!("q{i}"), JointKind::Revolute, &parent, &format!("l{}", i + 1))
        });
    }
    let m = b.build().unwrap();
    let found = Diagnosis::of(&m.state(m.home()).unwrap(), None, None).unwrap();
    assert_eq!((found.verdict.dof(), found.verdict.finite_dof()), (1000, Some(1000)));
    // The line: neither a pull along it nor a turn about it is felt.
    assert_eq!((found.counts.zero_torque, found.generic.counts.zero_torque), (2, 0));
    assert_eq!(found.blocked.len(), 2);
    assert!(found.redundant.len() > 900, "{}", found.redundant.len());
}

/// Dense matrices of long chains are refused before they are made; Jacobians are not.
#[test]
fn more_joints_than_are_analysed() {
    for n in [1994, 1995] {
        let m = chain(n, true, false, true);
        let state = m.state(m.home()).unwrap();
        let fits = n + 6 <= 2000;
        let says = |error: Error| {
            let text = error.to_string();
            assert!(text.contains("2001 columns cannot be used: at most 2000"), "{text}");
        };
        match ClosedChain::of(&state, None, None) {
            Ok(found) => assert_eq!((fits, found.actuated.len() + found.passive.len()), (true, n)),
            Err(error) => says(error),
        }
        assert_eq!(ClosedChain::of(&state, None, None).is_ok(), fits);
        let wide = ConstraintBlocks {
            actuated: Matrix::zeros(1, n),
            passive: Matrix::zeros(1, 0),
            grasp: Matrix::zeros(6, 1),
        };
        match Constraint::new(wide) {
            Ok(_) => assert!(fits),
            Err(error) => says(error),
        }
        let jacobian = state.jacobian(m.tool(), ReferenceFrame::World).unwrap();
        assert_eq!(jacobian.cols(), n);
    }
    let m = chain(2001, false, false, false);
    let state = m.state(m.home()).unwrap();
    for error in
        [FiniteMobility::of(&state, None).map(drop), Diagnosis::of(&state, None, None).map(drop)]
    {
        let text = error.unwrap_err().to_string();
        assert!(text.contains("at most 2000") && text.contains("fixed joints"), "{text}");
    }
}

/// Servos and inverse kinematics have dense matrices of the coordinates that move a frame.
#[test]
fn more_joints_than_are_controlled() {
    let m = chain(2001, false, false, false);
    let options = TaskServoOptions::new(&m);
    let posture = TaskObjective::Posture { q: m.home().to_vec() };
    let target = m.state(m.home()).unwrap().pose(m.tool()).unwrap();
    for error in [
        Servo::new(&m, ServoOptions::new(&m)).map(drop),
        TaskServo::new(&m, vec![MotionTask::new("rest", posture)], options).map(drop),
        Solver::new(&m, &[Goal::pose(m.tool(), target)], &IkOptions::default()).map(drop),
    ] {
        let text = error.unwrap_err().to_string();
        assert!(
            text.contains("2001 coordinates that move") && text.contains("at most 2000"),
            "{text}"
        );
    }
    // A frame that few joints move.
    let near = m.frame(&m.links()[3].name).unwrap();
    let few = ServoOptions { end_effector: near.into(), ..ServoOptions::new(&m) };
    assert!(Servo::new(&m, few).is_ok());
}
