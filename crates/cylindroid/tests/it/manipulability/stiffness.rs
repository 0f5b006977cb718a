//! Stiffness and compliance against textbook formulas, equilibrium and other frames.

use cylindroid::closure::{ClosedChain, MotionSpace, joint_torques};
use cylindroid::manipulability::Stiffness;
use cylindroid::model::{
    Dimension, ElasticBody, ElasticKind, Elasticity, Inclusion, JointKind, JointSpec,
    LoopJointSpec, Mechanism,
};
use cylindroid::{Matrix, Pose, ReferenceFrame, Rotation, State, Twist, Vec3};

fn load(name: &str) -> Mechanism {
    cylindroid::load(name).unwrap()
}

fn legs(stiffness: impl Fn(usize) -> f64) -> Elasticity {
    let mut elasticity = Elasticity::default();
    for i in 1..=6 {
        elasticity.stiffness(&format!("leg{i}"), stiffness(i));
    }
    elasticity
}

/// Unequal stiffnesses of the six legs.
fn unequal(i: usize) -> f64 {
    1e6 * (1.0 + 0.3 * i as f64)
}

/// A platform off its home, loops closed.
fn displaced(stewart: &Mechanism) -> State {
    let mut q = stewart.home().to_vec();
    for (name, x) in [("leg1", 0.05), ("leg3", -0.04), ("leg4", 0.1)] {
        q[stewart.coordinates().iter().position(|c| c.name == name).unwrap()] += x;
    }
    let held: Vec<usize> = stewart.actuated().collect();
    let found = cylindroid::closure::assemble(stewart, &q, &held).unwrap();
    stewart.state(&found.q).unwrap()
}

/// The line of a sliding leg, as a unit wrench at a point.
fn leg_wrench(state: &State, name: &str, point: Vec3) -> [f64; 6] {
    let m = state.mechanism();
    let joint = m.joints().iter().find(|j| j.name == name).unwrap();
    let parent = m.frame(&m.links()[joint.parent].name).unwrap();
    let world_from_joint = state.pose(parent).unwrap() * joint.parent_from_joint;
    let force = world_from_joint.rotation * joint.axis;
    let moment = (world_from_joint.translation - point).cross(force);
    let (f, n) = (force.to_array(), moment.to_array());
    [f[0], f[1], f[2], n[0], n[1], n[2]]
}

fn close(what: &str, a: &Matrix, b: &Matrix, tolerance: f64) {
    let (difference, size) = (a.max_difference(b), b.max_abs());
    assert!(difference < tolerance * size, "{what}: {difference:e} of {size:e}\n{a:?}\n{b:?}");
}

/// Gosselin 1990: K = J^T k J, with the lines of the legs as the rows of J.
#[test]
fn legs_of_a_platform() {
    let stewart = load("stewart");
    for state in [stewart.state(stewart.home()).unwrap(), displaced(&stewart)] {
        let found = Stiffness::of(&state, None, None, &legs(unequal)).unwrap();
        let rows: Vec<[f64; 6]> =
            (1..=6).map(|i| leg_wrench(&state, &format!("leg{i}"), found.point)).collect();
        let expected = Matrix::from_fn(6, 6, |i, j| {
            (0..6).map(|l| unequal(l + 1) * rows[l][i] * rows[l][j]).sum()
        });
        let stiffness = found.stiffness.as_ref().unwrap();
        close("stiffness", stiffness, &expected, 1e-11);
        let compliance = found.compliance.as_ref().unwrap();
        close("inverse", &(stiffness * compliance), &Matrix::identity(6), 1e-9);
        let l = found.cholesky().unwrap();
        close("Cholesky", &(&l * &l.transpose()), &expected, 1e-11);
        assert!((0..6).all(|j| (0..j).all(|i| l[(i, j)] == 0.0)));
        assert_eq!(found.undetermined, 0);
    }
}

/// The elastic energy of the legs when the platform is displaced, leg by leg from the distances of
/// its anchors: its second differences are the stiffness.
#[test]
fn stiffness_is_the_second_derivative_of_the_energy() {
    let stewart = load("stewart");
    let state = displaced(&stewart);
    let found = Stiffness::of(&state, None, None, &legs(unequal)).unwrap();
    let anchors: Vec<(Vec3, Vec3)> = (1..=6)
        .map(|i| {
            let ends = ["u", "s"].map(|kind| {
                let name = format!("{kind}{i}");
                let m = state.mechanism();
                let pose =
                    |link: usize| state.pose(m.frame(&m.links()[link].name).unwrap()).unwrap();
                let tree = m.joints().iter().find(|j| j.name == name);
                let closing = m.loops().iter().find(|j| j.name == name);
                match (tree, closing) {
                    (Some(j), _) => (pose(j.parent) * j.parent_from_joint).translation,
                    (None, Some(j)) => (pose(j.a) * j.link_a_from_joint).translation,
                    (None, None) => panic!("{name}"),
                }
            });
            (ends[0], ends[1])
        })
        .collect();
    let energy = |twist: [f64; 6]| -> f64 {
        let t = Twist::from_array(twist);
        let turn = Rotation::exp(t.angular);
        let moved = |p: Vec3| found.point + t.linear + turn * (p - found.point);
        let legs = anchors.iter().enumerate();
        legs.map(|(i, (base, top))| {
            let longer = (moved(*top) - *base).norm() - (*top - *base).norm();
            0.5 * unequal(i + 1) * longer * longer
        })
        .sum()
    };
    let h = 1e-4;
    let second = Matrix::from_fn(6, 6, |i, j| {
        let at = |a: f64, b: f64| {
            let mut twist = [0.0; 6];
            twist[i] += a * h;
            twist[j] += b * h;
            energy(twist)
        };
        (at(1.0, 1.0) - at(1.0, -1.0) - at(-1.0, 1.0) + at(-1.0, -1.0)) / (4.0 * h * h)
    });
    close("second differences", found.stiffness.as_ref().unwrap(), &second, 1e-6);
}

/// A serial arm: the sum of the compliances of its joints and links, each moved to the tool.
#[test]
fn compliances_of_a_serial_arm_add_up() {
    let arm = load("panda");
    let q = [0.2, -0.4, 0.3, -1.9, 0.1, 1.6, 0.7];
    let state = arm.state(&q).unwrap();
    let mut elasticity = Elasticity::default();
    let tool = state.pose(arm.tool()).unwrap().translation;
    let jacobian = state.jacobian(arm.tool(), ReferenceFrame::LocalWorldAligned).unwrap();
    let mut expected = Matrix::zeros(6, 6);
    for (i, c) in arm.coordinates().iter().enumerate() {
        let k = 1e4 * (1.0 + i as f64);
        elasticity.stiffness(&c.name, k);
        let column = jacobian.column(i);
        expected = Matrix::from_fn(6, 6, |r, s| expected[(r, s)] + column[r] * column[s] / k);
    }
    // A bearing, and a link with coupled bending, in frames of their own.
    let bearing = Matrix::diagonal(&[1e-8, 2e-8, 1e-8, 3e-6, 4e-6, 0.0]);
    let mut beam = Matrix::diagonal(&[2e-9, 5e-7, 5e-7, 3e-6, 2e-5, 2e-5]);
    (beam[(1, 5)], beam[(5, 1)], beam[(2, 4)], beam[(4, 2)]) = (2e-6, 2e-6, -2e-6, -2e-6);
    let joint = &arm.joints()[2];
    elasticity.joint(&joint.name, bearing.clone());
    let link = arm.joints()[3].child;
    let place = Pose {
        rotation: Rotation::exp(Vec3::new(0.3, -0.2, 0.9)),
        translation: Vec3::new(0.05, 0.1, -0.2),
    };
    elasticity.link(&arm.links()[link].name, beam.clone(), place);
    let pose = |link: usize| state.pose(arm.frame(&arm.links()[link].name).unwrap()).unwrap();
    let frames = [pose(joint.parent) * joint.parent_from_joint, pose(link) * place];
    for (frame, c) in frames.into_iter().zip([bearing, beam]) {
        let map = Matrix::from_fn(6, 6, |i, j| {
            let mut unit = [0.0; 6];
            unit[j] = 1.0;
            let t = Twist::from_array(unit);
            let world =
                Twist { linear: frame.rotation * t.linear, angular: frame.rotation * t.angular };
            world.at_point(tool - frame.translation).to_array()[i]
        });
        let moved = &(&map * &c) * &map.transpose();
        expected = Matrix::from_fn(6, 6, |r, s| expected[(r, s)] + moved[(r, s)]);
    }
    let found = Stiffness::of(&state, None, None, &elasticity).unwrap();
    close("compliance", found.compliance.as_ref().unwrap(), &expected, 1e-10);
    // The load of the drives is -J^T w.
    let wrench = [10.0, -3.0, 5.0, 0.4, 0.2, -0.6];
    let deflection = found.deflection(&wrench).unwrap();
    for (i, torque) in deflection.torques.iter().enumerate() {
        let expected: f64 = -(0..6).map(|r| jacobian[(r, i)] * wrench[r]).sum::<f64>();
        assert!((torque - expected).abs() < 1e-9, "{torque} {expected}");
        let turned = -torque / (1e4 * (1.0 + i as f64));
        assert!((deflection.parts[i].deflection[0] - turned).abs() < 1e-12);
    }
}

/// The equilibrium of a loaded arm with elastic joints, found by Newton's method: for smaller and
/// smaller wrenches its displacement approaches C w.
#[test]
fn small_loads_deflect_by_the_compliance() {
    let arm = load("3r");
    let q0 = [0.4, 0.7, -0.9];
    let k = 200.0;
    let mut elasticity = Elasticity::default();
    for c in arm.coordinates() {
        elasticity.stiffness(&c.name, k);
    }
    let state = arm.state(&q0).unwrap();
    let found = Stiffness::of(&state, None, None, &elasticity).unwrap();
    let compliance = found.compliance.as_ref().unwrap();
    let d = compliance.rows();
    let direction = [3.0, -2.0, 1.5, 0.3, -0.4, 0.8];
    let mut last = f64::INFINITY;
    for size in [1e-1, 1e-2, 1e-3] {
        let mut q = q0.to_vec();
        for _ in 0..200 {
            let jacobian = arm
                .state(&q)
                .unwrap()
                .jacobian(arm.reference(), ReferenceFrame::LocalWorldAligned)
                .unwrap();
            for i in 0..3 {
                let load: f64 =
                    (0..6).map(|r| jacobian[(r, i)] * size * component(direction, d, r)).sum();
                q[i] = q0[i] + load / k;
            }
        }
        let moved = arm.state(&q).unwrap().pose(arm.reference()).unwrap().translation - found.point;
        let wrench: Vec<f64> = kept(d).iter().map(|&r| size * direction[r]).collect();
        let linear = compliance.mul_vec(&wrench);
        let error = (0..2).map(|i| (moved.to_array()[i] - linear[i]).abs()).fold(0.0, f64::max);
        let relative = error / size;
        assert!(relative < 0.2 * last, "{size}: {relative} after {last}");
        last = relative;
    }
    assert!(last < 1e-6);
}

fn kept(d: usize) -> &'static [usize] {
    if d == 3 { &[0, 1, 5] } else { &[0, 1, 2, 3, 4, 5] }
}

fn component(w: [f64; 6], d: usize, r: usize) -> f64 {
    if kept(d).contains(&r) { w[r] } else { 0.0 }
}

/// A cantilever: at its tip a force bends by L^3 / 3 E I, a moment rotates by L / E I.
#[test]
fn an_elastic_link_is_a_cantilever() {
    let (length, ei) = (0.8, 1200.0);
    let mut builder = Mechanism::builder("cantilever");
    builder.joint(JointSpec::new("hinge", JointKind::Revolute, "wall", "beam"));
    builder.frame("tip", "beam", Pose::from_translation(Vec3::X * length)).tool("tip");
    let beam = builder.build().unwrap();
    let (l2, l3) = (length * length, length.powi(3));
    let mut c = Matrix::zeros(6, 6);
    (c[(1, 1)], c[(5, 5)]) = (l3 / (3.0 * ei), length / ei);
    (c[(1, 5)], c[(5, 1)]) = (l2 / (2.0 * ei), l2 / (2.0 * ei));
    let mut elasticity = Elasticity::default();
    elasticity.link("beam", c.clone(), Pose::from_translation(Vec3::X * length));
    let state = beam.state(&[0.0]).unwrap();
    let found = Stiffness::of(&state, None, None, &elasticity).unwrap();
    close("compliance", found.compliance.as_ref().unwrap(), &c, 1e-12);
    // Four directions are rigid, the hinge is locked.
    assert_eq!((found.rigid.cols(), found.free.cols()), (4, 0));
    assert!(found.stiffness.is_none() && found.eigenscrews().is_none());
    let bent = found.deflection(&[0.0, 100.0, 0.0, 0.0, 0.0, 0.0]).unwrap();
    assert!((bent.twist[1] - 100.0 * l3 / (3.0 * ei)).abs() < 1e-12);
    assert!((bent.energy - 0.5 * 100.0 * bent.twist[1]).abs() < 1e-12);
    assert!((bent.torques[0] + 100.0 * length).abs() < 1e-10);
}

/// Elastic drives of a five-bar: the structure resists one wrench rigidly. With one drive fewer, a
/// motion is free.
#[test]
fn rigid_and_free_directions() {
    let five_bar = load("five-bar").with_actuated(&["q1", "q5"]).unwrap();
    let state = five_bar.state(five_bar.home()).unwrap();
    let mut elasticity = Elasticity::default();
    elasticity.stiffness("q1", 50.0).stiffness("q5", 80.0);
    let found = Stiffness::of(&state, None, None, &elasticity).unwrap();
    assert_eq!((found.rigid.cols(), found.free.cols()), (1, 0));
    assert!(found.stiffness.is_none());
    let compliance = found.compliance.as_ref().unwrap();
    let resisted = compliance.mul_vec(found.rigid.column(0));
    assert!(resisted.iter().all(|x| x.abs() < 1e-12), "{resisted:?}");
    // The drives carry the torques of rigid statics.
    let chain = ClosedChain::of(&state, None, None).unwrap();
    let relation = MotionSpace::of(&chain.constraint).relation();
    let wrench = [3.0, -1.0, 0.2];
    let rigid = joint_torques(&relation, &wrench, None).unwrap();
    let elastic = found.deflection(&wrench).unwrap();
    for (a, b) in elastic.torques.iter().zip(&rigid.torques) {
        assert!((a - b).abs() < 1e-10, "{a} {b}");
    }
    let work: f64 = elastic.twist.iter().zip(&wrench).map(|(u, w)| u * w).sum();
    assert!((work - 2.0 * elastic.energy).abs() < 1e-12);

    let one = load("five-bar").with_actuated(&["q1"]).unwrap();
    let state = one.state(one.home()).unwrap();
    let mut elasticity = Elasticity::default();
    elasticity.stiffness("q1", 50.0);
    let found = Stiffness::of(&state, None, None, &elasticity).unwrap();
    assert_eq!(found.free.cols(), 1);
    assert!(found.compliance.is_none() && found.cholesky().is_none());
    let elastic = found.deflection(&wrench).unwrap();
    assert!(elastic.unbalanced.iter().any(|x| x.abs() > 1e-3));
    // Neither is a twist with a deflection of the free motion taken out of nothing: what is left
    // does no work on it.
    let left: f64 = (0..3).map(|i| (wrench[i] - elastic.unbalanced[i]) * found.free[(i, 0)]).sum();
    assert!(left.abs() < 1e-12);
}

/// Bearings that give way determine the forces of an overconstrained loop.
#[test]
fn elastic_bearings_determine_hyperstatic_forces() {
    let z = |name: &str, a: &str, b: &str, at: [f64; 3]| JointSpec {
        parent_from_joint: Pose::from_translation(Vec3::from_array(at)),
        axis: Vec3::Z,
        actuated: name == "a",
        ..JointSpec::new(name, JointKind::Revolute, a, b)
    };
    let mut builder = Mechanism::builder("parallelogram");
    builder.joint(z("a", "ground", "crank", [0.0; 3]));
    builder.joint(z("b", "crank", "coupler", [0.0, 1.0, 0.0]));
    builder.joint(z("c", "coupler", "rocker", [2.0, 0.0, 0.0]));
    builder.loop_joint(LoopJointSpec {
        link_a_from_joint: Pose::from_translation(Vec3::new(0.0, -1.0, 0.0)),
        link_b_from_joint: Pose::from_translation(Vec3::new(2.0, 0.0, 0.0)),
        axis: Vec3::Z,
        ..LoopJointSpec::new("d", JointKind::Revolute, "rocker", "ground")
    });
    builder.frame("middle", "coupler", Pose::from_translation(Vec3::X)).tool("middle");
    let m = builder.build().unwrap();
    let state = m.state(m.home()).unwrap();
    let mut drive = Elasticity::default();
    drive.stiffness("a", 1e3);
    let rigid = Stiffness::of(&state, None, None, &drive).unwrap();
    assert_eq!(rigid.undetermined, 3);
    let mut elasticity = drive.clone();
    for name in ["a", "b", "c", "d"] {
        elasticity.joint(name, Matrix::diagonal(&[1e-6, 1e-6, 1e-6, 1e-5, 1e-5, 0.0]));
    }
    let found = Stiffness::of(&state, None, None, &elasticity).unwrap();
    assert_eq!((found.undetermined, found.rigid.cols(), found.free.cols()), (0, 0, 0));
    // By symmetry half of a load across the plane goes through either side.
    let under = found.deflection(&[0.0, 0.0, 10.0, 0.0, 0.0, 0.0]).unwrap();
    let force = under.forces[0].wrench.force.z;
    assert!((force.abs() - 5.0).abs() < 1e-9, "{force}");
    // Compliances of all four bearings matter: with two springs in parallel of two in series each,
    // along z, and the bending of the cranks.
    assert!(under.twist[2] > 10.0 * 1e-6, "{:?}", under.twist);
}

/// The stiffness of a moved platform is the moved stiffness, at any frame, and the characteristic
/// length has no influence.
#[test]
fn stiffness_moves_with_the_mechanism() {
    let stewart = load("stewart");
    let still = displaced(&stewart);
    let moved_by = Pose {
        rotation: Rotation::exp(Vec3::new(0.4, -1.1, 0.7)),
        translation: Vec3::new(3.0, -2.0, 1.0),
    };
    let mut builder = Mechanism::builder("moved");
    builder
        .include(
            &stewart,
            Inclusion {
                name: "p",
                parent: "world",
                parent_from_root: moved_by,
                free: false,
                start: stewart.home(),
            },
        )
        .unwrap();
    let reference = format!("p/{}", stewart.frame_of(stewart.reference()).name);
    builder.reference(&reference);
    let moved = builder.build().unwrap();
    let mut elasticity = legs(unequal);
    let top = stewart.loops()[0].name.clone();
    let spring = Matrix::diagonal(&[2e-8, 3e-8, 1e-8, 0.0, 0.0, 0.0]);
    elasticity.joint(&top, spring);
    let mut renamed = elasticity.clone();
    renamed.elements.iter_mut().for_each(|e| e.name = format!("p/{}", e.name));
    let a = Stiffness::of(&still, None, None, &elasticity).unwrap();
    let state = moved.state(still.q()).unwrap();
    for length in [None, Some(0.01), Some(40.0)] {
        let b = Stiffness::of(&state, None, length, &renamed).unwrap();
        let frame =
            Pose { rotation: Rotation::exp(Vec3::X), translation: Vec3::new(0.1, 0.5, 2.0) };
        let there = b.at(moved_by * frame).unwrap();
        close("moved", &there, &a.at(frame).unwrap(), 1e-9);
        let compliance = b.compliance_at(moved_by * frame).unwrap();
        close("moved compliance", &compliance, &a.compliance_at(frame).unwrap(), 1e-9);
        close("inverse", &(&there * &compliance), &Matrix::identity(6), 1e-8);
        let (x, y) = (a.eigenscrews().unwrap(), b.eigenscrews().unwrap());
        for (x, y) in x.screws.iter().zip(&y.screws) {
            assert!((x.eigenvalue - y.eigenvalue).abs() < 1e-8 * x.eigenvalue.abs(), "{x:?} {y:?}");
            let (x, y) = (x.screw().unwrap(), y.screw().unwrap());
            assert!((x.pitch - y.pitch).abs() < 1e-7, "{x:?} {y:?}");
        }
    }
}

/// K s = 2 l Q_0 s for each, three positive with positive pitch and three negative: a twist of 1 rad
/// gives l as a force on the same screw.
#[test]
fn eigenscrews_solve_their_equation() {
    let stewart = load("stewart");
    let found = Stiffness::of(&displaced(&stewart), None, None, &legs(unequal)).unwrap();
    let k = found.stiffness.as_ref().unwrap();
    let all = found.eigenscrews().unwrap().screws;
    assert_eq!(all.len(), 6);
    for (i, e) in all.iter().enumerate() {
        let pitch = e.screw().unwrap().pitch;
        assert_eq!((e.eigenvalue > 0.0, pitch > 0.0), (i < 3, i < 3));
        let s = e.twist.at_point(found.point).to_array();
        let wrench = k.mul_vec(&s);
        for j in 0..6 {
            let expected = e.eigenvalue * s[(j + 3) % 6];
            assert!((wrench[j] - expected).abs() < 1e-8 * k.max_abs(), "{i}: {wrench:?}");
        }
    }
    // The sum of the forces per angle is twice the trace of the coupling block.
    let coupling: f64 = (0..3).map(|i| k[(i, i + 3)]).sum();
    let sum: f64 = all.iter().map(|e| e.eigenvalue).sum();
    assert!((sum - 2.0 * coupling).abs() < 1e-8 * k.max_abs());
}

/// What an elasticity does not mean is refused, by name.
#[test]
fn faults_are_named() {
    let stewart = load("stewart");
    let state = stewart.state(stewart.home()).unwrap();
    let refused = |elasticity: &Elasticity| {
        Stiffness::of(&state, None, None, elasticity).unwrap_err().to_string()
    };
    let with = |name: &str, kind: ElasticKind| {
        let mut elasticity = Elasticity::default();
        elasticity.elements.push(cylindroid::model::ElasticElement { name: name.to_owned(), kind });
        elasticity
    };
    let matrix = |m: Matrix| ElasticBody { compliance: m, frame: None };
    assert!(refused(&Elasticity::default()).contains("nothing is elastic"));
    let unknown = with("leg7", ElasticKind::Motion { stiffness: 1.0 });
    assert!(refused(&unknown).contains("leg7"));
    let negative = with("leg1", ElasticKind::Motion { stiffness: -1.0 });
    assert!(refused(&negative).contains("positive"));
    let small = with("leg1", ElasticKind::Joint(matrix(Matrix::identity(3))));
    assert!(refused(&small).contains("6 x 6"));
    let indefinite = Matrix::diagonal(&[1e-6, -1e-6, 0.0, 0.0, 0.0, 0.0]);
    let indefinite = with("leg1", ElasticKind::Joint(matrix(indefinite)));
    assert!(refused(&indefinite).contains("semidefinite"));
    let root = stewart.links()[0].name.clone();
    let root = with(&root, ElasticKind::Link(matrix(Matrix::identity(6))));
    assert!(refused(&root).contains("root"));
    let mut twice = Elasticity::default();
    twice.stiffness("leg1", 1.0);
    twice.elements.push(twice.elements[0].clone());
    assert!(refused(&twice).contains("two stiffnesses"));
}

/// A plate on three legs with sliders, whose hinges at the plate are the drives: K is the sum of
/// `k_i J_i^T J_i` with the rates `J_i = w - n_i . (v + w x r_i) / l_i` of these hinges.
#[test]
fn drives_in_joints_that_close_loops() {
    let feet = [[0.0, 0.0], [2.0, -0.3], [0.7, 1.9]];
    let plate = [[0.6, 0.4], [1.3, 0.5], [0.8, 1.1]];
    let stiffness = [300.0, 50.0, 120.0];
    let mut builder = Mechanism::builder("plate");
    builder.dimension(Dimension::Planar);
    let joint = |name: String, kind, parent: &str, child: &str| JointSpec {
        actuated: false,
        ..JointSpec::new(&name, kind, parent, child)
    };
    builder.joint(joint("plate".to_owned(), JointKind::Planar, "ground", "plate"));
    let mut elasticity = Elasticity::default();
    let mut expected = Matrix::zeros(3, 3);
    for (i, (foot, end)) in feet.into_iter().zip(plate).enumerate() {
        let [x, y]: [f64; 2] = [end[0] - foot[0], end[1] - foot[1]];
        let (length, angle) = (x.hypot(y), y.atan2(x));
        let [barrel, rod] = ["barrel", "rod"].map(|name| format!("{name}{i}"));
        builder.joint(JointSpec {
            parent_from_joint: Pose {
                rotation: Rotation::about_z(angle),
                translation: Vec3::new(foot[0], foot[1], 0.0),
            },
            ..joint(format!("foot{i}"), JointKind::Revolute, "ground", &barrel)
        });
        builder.joint(JointSpec {
            parent_from_joint: Pose::from_translation(Vec3::X * length),
            axis: Vec3::X,
            ..joint(format!("slider{i}"), JointKind::Prismatic, &barrel, &rod)
        });
        let hinge = format!("hinge{i}");
        builder.loop_joint(LoopJointSpec {
            link_b_from_joint: Pose::from_translation(Vec3::new(end[0], end[1], 0.0)),
            actuated: true,
            ..LoopJointSpec::new(&hinge, JointKind::Revolute, &rod, "plate")
        });
        elasticity.stiffness(&hinge, stiffness[i]);
        // n = (-y, x) / l, w x r = w (-end_y, end_x)
        let across = [-y / length, x / length];
        let lever = across[1] * end[0] - across[0] * end[1];
        let rate = [-across[0] / length, -across[1] / length, 1.0 - lever / length];
        expected =
            Matrix::from_fn(3, 3, |r, c| expected[(r, c)] + stiffness[i] * rate[r] * rate[c]);
    }
    builder.frame("tool", "plate", Pose::IDENTITY).tool("tool");
    let m = builder.build().unwrap();
    let found = Stiffness::of(&m.state(m.home()).unwrap(), None, None, &elasticity).unwrap();
    close("stiffness", found.stiffness.as_ref().unwrap(), &expected, 1e-11);
}
