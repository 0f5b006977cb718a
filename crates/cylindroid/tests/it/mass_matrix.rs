//! Mass matrices against kinetic energy, single links, other frames and loops.

use cylindroid::closure::{ActuationMap, ClosedChain, MotionSpace};
use cylindroid::kinematics::MassMatrix;
use cylindroid::manipulability::{Manipulability, Metrics, actuated_inertia, body_inertia};
use cylindroid::model::{Inertial, JointKind, JointSpec, Link, LoopJointSpec, Mimic};
use cylindroid::spatial::{Mat3, Pose, Vec3};
use cylindroid::{Matrix, Mechanism, ReferenceFrame, State};

use crate::support::{Random, assert_matrix, reversed_zoo, zoo};

fn inertial(random: &mut Random) -> Inertial {
    let a = random.matrix(3, 3);
    let gram = &a * &a.transpose();
    let entry = |i: usize, j: usize| gram[(i, j)] + if i == j { 0.1 } else { 0.0 };
    Inertial {
        mass: random.within(0.5, 3.0),
        link_from_inertia: random.pose(),
        inertia: Mat3::from_rows(std::array::from_fn(|i| std::array::from_fn(|j| entry(i, j)))),
    }
}

/// The same mechanism with masses drawn at random on all links.
fn heavy(mechanism: &Mechanism, seed: u64) -> Mechanism {
    let mut random = Random(seed);
    let mut builder = Mechanism::builder("heavy");
    for link in mechanism.links() {
        builder.link(Link { inertial: Some(inertial(&mut random)), ..link.clone() });
    }
    for joint in mechanism.joints() {
        let name = |i: usize| mechanism.links()[i].name.clone();
        builder.joint(JointSpec {
            name: joint.name.clone(),
            kind: joint.kind,
            parent: name(joint.parent),
            child: name(joint.child),
            parent_from_joint: joint.parent_from_joint,
            joint_from_child: joint.joint_from_child,
            axis: joint.axis,
            reversed: joint.reversed,
            limits: joint.limits,
            mimic: joint.mimic.clone(),
            actuated: joint.actuated,
            armature: joint.armature,
        });
    }
    builder.build().unwrap()
}

/// The sum of J^T W J over all links, with the inertia of each at its own frame.
fn sum_of_links(state: &State) -> Matrix {
    let m = state.mechanism();
    let mut sum = Matrix::zeros(m.n(), m.n());
    let mut counted: Vec<Matrix> = Vec::new();
    for link in m.links() {
        let frame = m.frame(&link.name).unwrap();
        let Some(w) = body_inertia(state, frame).unwrap() else { continue };
        // A body counts once, with all links that are fixed to each other.
        let jacobian = state.jacobian(frame, ReferenceFrame::LocalWorldAligned).unwrap();
        let one = &(&jacobian.transpose() * &w) * &jacobian;
        let same = |other: &Matrix| one.max_difference(other) < 1e-9 * one.max_abs();
        if counted.iter().any(same) {
            continue;
        }
        sum = Matrix::from_fn(m.n(), m.n(), |i, j| sum[(i, j)] + one[(i, j)]);
        counted.push(one);
    }
    sum
}

/// Joints of every kind, mimic and reversed ones included: M is the sum over links, and positive
/// definite.
#[test]
fn joints_of_every_kind() {
    let mut random = Random(2024);
    for (seed, mechanism) in [(1, zoo()), (2, reversed_zoo())] {
        let m = heavy(&mechanism, seed);
        let mut evaluator = MassMatrix::new(&m);
        let mut out = Matrix::zeros(m.n(), m.n());
        for _ in 0..5 {
            let state = m.state(&random.q(&m)).unwrap();
            evaluator.evaluate(&state, &mut out).unwrap();
            assert_matrix("links", &out, &sum_of_links(&state), 1e-10 * out.max_abs());
            assert_eq!(out.max_difference(&out.transpose()), 0.0);
            let qd = random.vector(m.n());
            let energy: f64 = out.mul_vec(&qd).iter().zip(&qd).map(|(p, v)| p * v).sum();
            assert!(energy > 0.0);
            assert_eq!(out, state.mass_matrix());
        }
    }
}

#[test]
fn a_wrong_shape_or_another_mechanism_is_an_error() {
    let (zoo, arm) = (zoo(), cylindroid::load("ur5e").unwrap());
    let mut evaluator = MassMatrix::new(&zoo);
    let state = zoo.state(zoo.home()).unwrap();
    let error = evaluator.evaluate(&state, &mut Matrix::zeros(zoo.n(), 1)).unwrap_err();
    assert!(error.to_string().contains("columns of the mass matrix"), "{error}");
    let foreign = arm.state(arm.home()).unwrap();
    let error = evaluator.evaluate(&foreign, &mut Matrix::zeros(arm.n(), arm.n())).unwrap_err();
    assert!(error.to_string().contains("bodies of the state"), "{error}");
}

/// Kinetic energy by finite differences of the positions of three point masses on each link.
#[test]
fn kinetic_energy_by_finite_differences() {
    let mut random = Random(77);
    let arm = heavy(&cylindroid::load("panda").unwrap(), 3);
    let q = random.q(&arm);
    let qd = random.vector(arm.n());
    let h = 1e-5;
    let at = |s: f64| {
        let moved: Vec<f64> = q.iter().zip(&qd).map(|(q, v)| q + s * v).collect();
        arm.state(&moved).unwrap()
    };
    let (before, after) = (at(-h), at(h));
    let mut energy = 0.0;
    for link in arm.links() {
        let inertial = link.inertial.unwrap();
        let frame = arm.frame(&link.name).unwrap();
        let pose = |state: &State| state.pose(frame).unwrap() * inertial.link_from_inertia;
        let (a, b, here) = (pose(&before), pose(&after), pose(&at(0.0)));
        let v = (b.translation - a.translation) * (0.5 / h);
        let omega = (b.rotation * a.rotation.inverse()).log() * (0.5 / h);
        let local = here.rotation.inverse() * omega;
        energy += 0.5 * inertial.mass * v.dot(v) + 0.5 * local.dot(inertial.inertia * local);
    }
    let mass = at(0.0).mass_matrix();
    let expected: f64 = mass.mul_vec(&qd).iter().zip(&qd).map(|(p, v)| 0.5 * p * v).sum();
    assert!((energy - expected).abs() < 1e-7 * expected, "{energy} {expected}");
}

/// Of a serial arm the inertia of the actuated joints is the mass matrix; links without mass are
/// named, with the way out.
#[test]
fn serial_arms_and_missing_masses() {
    let arm = heavy(&cylindroid::load("ur5e").unwrap(), 9);
    let state = arm.state(&[0.3, -1.1, 1.4, 0.2, 1.0, 0.4]).unwrap();
    let mass = state.mass_matrix();
    assert_matrix("serial", &actuated_inertia(&state).unwrap(), &mass, 1e-12 * mass.max_abs());
    let bare = cylindroid::load("ur5e").unwrap();
    let state = bare.state(bare.home()).unwrap();
    let error = actuated_inertia(&state).unwrap_err().to_string();
    for word in ["without mass", bare.massless_bodies()[0], "[[link]]", "<inertial>"] {
        assert!(error.contains(word), "{word}: {error}");
    }
    // All moving bodies, and no link that is fixed to the ground.
    assert_eq!(bare.massless_bodies().len(), 6);
}

/// A four-bar with masses: a joint at ground, a coupler, a rocker.
fn four_bar(actuated: [bool; 3]) -> Mechanism {
    let mut random = Random(31);
    let mut builder = Mechanism::builder("four-bar");
    builder.link(Link::named("ground"));
    for name in ["crank", "coupler", "rocker"] {
        builder.link(Link { inertial: Some(inertial(&mut random)), ..Link::named(name) });
    }
    let joints = [
        ("a", "ground", "crank", Vec3::ZERO),
        ("b", "crank", "coupler", Vec3::Y),
        ("c", "coupler", "rocker", Vec3::X * 2.0),
    ];
    for ((name, a, b, at), actuated) in joints.into_iter().zip(actuated) {
        builder.joint(JointSpec {
            parent_from_joint: Pose::from_translation(at),
            actuated,
            ..JointSpec::new(name, JointKind::Revolute, a, b)
        });
    }
    builder.loop_joint(LoopJointSpec {
        link_a_from_joint: Pose::from_translation(Vec3::new(0.5, -1.5, 0.0)),
        link_b_from_joint: Pose::from_translation(Vec3::new(2.5, -0.5, 0.0)),
        ..LoopJointSpec::new("d", JointKind::Revolute, "rocker", "ground")
    });
    builder.build().unwrap()
}

/// In a loop: twice the kinetic energy of the motion for one actuated velocity. Redundant actuation
/// gives the same energy on the motions that the loop permits.
#[test]
fn loops_project_the_mass_matrix() {
    for actuated in [[true, false, false], [false, true, false], [true, true, false], [true; 3]] {
        let m = four_bar(actuated);
        let state = m.state(m.home()).unwrap();
        let map = ActuationMap::of(&state, &[], &[]).unwrap();
        assert_eq!(map.motions.cols(), 1);
        let qd = &map.motions.column(0)[..m.n()];
        let mass = state.mass_matrix();
        let twice: f64 = mass.mul_vec(qd).iter().zip(qd).map(|(p, v)| p * v).sum();
        let w = actuated_inertia(&state).unwrap();
        let active: Vec<f64> = m.actuated().map(|i| qd[i]).collect();
        let seen: f64 = w.mul_vec(&active).iter().zip(&active).map(|(p, v)| p * v).sum();
        assert!((seen - twice).abs() < 1e-10 * twice, "{actuated:?}: {seen} {twice}");
    }
}

/// A passive joint follows: of all motions with the actuated velocity, the one of least energy.
#[test]
fn motions_without_control_follow_with_least_energy() {
    let mut random = Random(8);
    let mut builder = Mechanism::builder("pendulums");
    builder.link(Link::named("ground"));
    for name in ["first", "second"] {
        builder.link(Link { inertial: Some(inertial(&mut random)), ..Link::named(name) });
    }
    builder.joint(JointSpec::new("driven", JointKind::Revolute, "ground", "first"));
    builder.joint(JointSpec {
        parent_from_joint: Pose::from_translation(Vec3::X),
        actuated: false,
        ..JointSpec::new("free", JointKind::Revolute, "first", "second")
    });
    let m = builder.build().unwrap();
    let state = m.state(&[0.2, 0.9]).unwrap();
    let mass = state.mass_matrix();
    let expected = mass[(0, 0)] - mass[(0, 1)] * mass[(0, 1)] / mass[(1, 1)];
    let found = actuated_inertia(&state).unwrap();
    assert!((found[(0, 0)] - expected).abs() < 1e-12 * mass[(0, 0)], "{found:?} {expected}");
}

/// Manipulability in the metric of inertia: the world and its frame have no influence, and the
/// efficiencies are the eigenvalues of W_u J M^-1 J^T.
#[test]
fn inertia_measures_manipulability() {
    let arm = heavy(&cylindroid::load("ur5e").unwrap(), 4);
    let state = arm.state(&[0.3, -1.1, 1.4, 0.2, 1.0, 0.4]).unwrap();
    let chain = ClosedChain::of(&state, None, None).unwrap();
    let relation = MotionSpace::of(&chain.constraint).relation();
    let metrics = Metrics::UNIT.with_joint_inertia(&state).unwrap();
    let found = Manipulability::of(&relation, &metrics).unwrap().kinematic;
    let jacobian = state.jacobian(arm.reference(), ReferenceFrame::LocalWorldAligned).unwrap();
    // The trace of J M^-1 J^T is the sum of the efficiencies.
    let mut whitened = jacobian.clone();
    metrics.joint.as_ref().unwrap().solve_right(&mut whitened);
    let trace = whitened.frobenius_norm().powi(2);
    let sum: f64 = found.values().iter().sum();
    assert!((sum - trace).abs() < 1e-9 * trace, "{sum} {trace}");
}

/// An armature stands on the diagonal, that of a mimic joint times the square of its ratio.
#[test]
fn armatures_add_to_the_diagonal() {
    let mut builder = Mechanism::builder("geared");
    let joint = |name: &str, parent: &str, child: &str, armature: f64| JointSpec {
        armature,
        ..JointSpec::new(name, JointKind::Revolute, parent, child)
    };
    let follower = Mimic { joint: "b".to_owned(), multiplier: -3.0, offset: 1.0 };
    builder.joint(joint("a", "ground", "1", 0.5));
    builder.joint(joint("b", "1", "2", 0.25));
    builder.joint(JointSpec { mimic: Some(follower), ..joint("c", "2", "3", 2.0) });
    let m = builder.build().unwrap();
    let mass_matrix = m.state(&[0.1, 0.2]).unwrap().mass_matrix();
    let expected = Matrix::from_rows(&[vec![0.5, 0.0], vec![0.0, 0.25 + 9.0 * 2.0]]).unwrap();
    assert_matrix("geared", &mass_matrix, &expected, 1e-15);
    let mut wrong = Mechanism::builder("wrong");
    wrong.joint(joint("a", "ground", "1", -1.0));
    assert!(wrong.build().unwrap_err().to_string().contains("armature of joint 'a' is -1"));
}
