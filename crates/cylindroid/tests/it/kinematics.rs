use cylindroid::kinematics::{Chain, OrientationRates, velocity_conversion};
use cylindroid::model::{JointKind, JointSpec};
use cylindroid::spatial::{Pose, Rotation, Rpy, Twist, Vec3, Xyz, Zyz, log};
use cylindroid::{EndEffector, Matrix, Mechanism, ReferenceFrame, catalogue};

use crate::support::{
    Random, assert_close, assert_matrix, planar, pose_entries, reversed_zoo, zoo,
};

const REFERENCES: [ReferenceFrame; 3] =
    [ReferenceFrame::Local, ReferenceFrame::World, ReferenceFrame::LocalWorldAligned];

pub(crate) fn robots() -> Vec<Mechanism> {
    let mut robots: Vec<Mechanism> =
        catalogue::names().iter().map(|n| catalogue::load(n).unwrap()).collect();
    robots.extend((1..=7).map(planar));
    robots.push(planar(30));
    robots.push(zoo());
    robots.push(reversed_zoo());
    robots
}

pub(crate) fn end_effector(robot: &Mechanism, random: &mut Random) -> EndEffector {
    EndEffector { frame: robot.tool(), frame_from_tool: random.pose() }
}

/// q moved by h along unit rate k, on the group where the coordinate is a rotation vector.
pub(crate) fn moved(robot: &Mechanism, q: &[f64], rates: &[f64], h: f64) -> Vec<f64> {
    robot.integrate(q, rates, h).unwrap()
}

pub(crate) fn unit(n: usize, k: usize) -> Vec<f64> {
    let mut e = vec![0.0; n];
    e[k] = 1.0;
    e
}

/// The twists of all joints are the columns that the Jacobians of their links have; a link has none
/// of a joint that does not move it.
#[test]
fn joint_twists_are_the_columns_of_all_jacobians() {
    let mut random = Random(37);
    for robot in robots() {
        let state = robot.state(&random.q(&robot)).unwrap();
        let mut twists = Matrix::from_fn(6, robot.n(), |_, _| f64::NAN);
        state.joint_twists_into(&mut twists).unwrap();
        for joint in robot.joints().iter().filter(|j| j.mimic.is_none()) {
            let link = robot.frame(&robot.links()[joint.child].name).unwrap();
            let jacobian = state.jacobian(link, ReferenceFrame::World).unwrap();
            for c in 0..robot.n() {
                let follows = |c| {
                    robot.joints().iter().any(|j| j.mimic.is_some() && j.coordinates.contains(&c))
                };
                let own = joint.coordinates.contains(&c);
                let column = jacobian.column(c);
                if own || (!follows(c) && column.iter().any(|x| *x != 0.0)) {
                    assert_eq!(column, twists.column(c), "{} {}", robot.name(), joint.name);
                }
            }
        }
    }
}

/// The Jacobian is the derivative of the pose, in each reference.
#[test]
fn jacobian_by_finite_differences() {
    let mut random = Random(31);
    let h = 1e-5;
    for robot in robots() {
        let tool = end_effector(&robot, &mut random);
        for _ in 0..5 {
            let q = random.q(&robot);
            let state = robot.state(&q).unwrap();
            let pose = state.pose(tool).unwrap();
            let pose_at = |rates: &[f64], h: f64| {
                robot.state(&moved(&robot, &q, rates, h)).unwrap().pose(tool).unwrap()
            };
            for k in 0..robot.n() {
                let e = unit(robot.n(), k);
                let (plus, minus) = (pose_at(&e, h), pose_at(&e, -h));
                let spatial =
                    (log(plus * pose.inverse()) - log(minus * pose.inverse())) * (0.5 / h);
                let scale = 1e-9 * (1.0 + robot.reach());
                for reference in REFERENCES {
                    let expected = match reference {
                        ReferenceFrame::World => spatial,
                        ReferenceFrame::LocalWorldAligned => spatial.at_point(pose.translation),
                        ReferenceFrame::Local => pose.inverse().adjoint(spatial),
                    };
                    let j = state.jacobian(tool, reference).unwrap();
                    let what = format!("{} {} column {k}", robot.name(), reference.name());
                    assert_close(&what, j.column(k), &expected.to_array(), scale);
                }
            }
        }
    }
}

/// J_world = Ad(world_from_tool) J_local, exactly; J rates = twist.
#[test]
fn references_are_related_by_the_adjoint() {
    let mut random = Random(32);
    for robot in robots() {
        let tool = end_effector(&robot, &mut random);
        let q = random.q(&robot);
        let rates = random.vector(robot.n());
        let state = robot.state(&q).unwrap();
        let pose = state.pose(tool).unwrap();
        let [local, world, aligned] = REFERENCES.map(|r| state.jacobian(tool, r).unwrap());
        let scale = 1e-13 * (1.0 + robot.reach());
        assert_matrix("Ad J_local", &(&velocity_conversion(pose) * &local), &world, scale);
        let turned = Pose::from_rotation(pose.rotation);
        assert_matrix("R J_local", &(&velocity_conversion(turned) * &local), &aligned, scale);
        for (j, reference) in [local, world, aligned].iter().zip(REFERENCES) {
            let twist = state.twist(&rates, tool, reference).unwrap();
            let scale = scale * robot.n() as f64;
            assert_close("J rates", &j.mul_vec(&rates), &twist.to_array(), scale);
        }
    }
}

/// The notes' construction: column 6 (turn) or 3 (slide) of the conversion from the joint's own
/// frame to the end effector's.
#[test]
fn jacobian_is_assembled_by_conversion() {
    let mut random = Random(33);
    for robot in crate::support::robots() {
        let q = random.q(&robot);
        let state = robot.state(&q).unwrap();
        let world_from_tool = state.pose(robot.tool()).unwrap();
        let mut assembled = Matrix::zeros(6, robot.n());
        for joint in robot.joints().iter().filter(|j| j.kind.dof() == 1) {
            let world_from_child =
                state.pose(robot.frame(&robot.links()[joint.child].name).unwrap()).unwrap();
            let along_z = Pose::from_rotation(Rotation::z_to(joint.axis).unwrap());
            let tool_from_joint = world_from_tool.inverse() * world_from_child * along_z;
            let v = velocity_conversion(tool_from_joint);
            let column = if joint.kind == JointKind::Prismatic { 2 } else { 5 };
            assembled.column_mut(joint.coordinates.start).copy_from_slice(v.column(column));
        }
        assert_matrix(
            robot.name(),
            &state.jacobian(robot.tool(), ReferenceFrame::Local).unwrap(),
            &assembled,
            1e-14,
        );
    }
}

#[test]
fn jacobian_dot_by_finite_differences() {
    let mut random = Random(34);
    let h = 1e-5;
    for robot in robots() {
        let tool = end_effector(&robot, &mut random);
        for _ in 0..3 {
            let (q, rates) = (random.q(&robot), random.vector(robot.n()));
            let state = robot.state(&q).unwrap();
            let at = |h: f64| robot.state(&moved(&robot, &q, &rates, h)).unwrap();
            let (plus, minus) = (at(h), at(-h));
            for reference in REFERENCES {
                let (a, b) = (
                    plus.jacobian(tool, reference).unwrap(),
                    minus.jacobian(tool, reference).unwrap(),
                );
                let difference =
                    Matrix::from_fn(6, robot.n(), |i, j| (a[(i, j)] - b[(i, j)]) * (0.5 / h));
                let dot = state.jacobian_dot(&rates, tool, reference).unwrap();
                let scale = 2e-9 * (1.0 + robot.reach()) * robot.n() as f64;
                let what = format!("{} {}", robot.name(), reference.name());
                assert_matrix(&what, &dot, &difference, scale);
            }
        }
    }
}

#[test]
fn hessian_by_finite_differences_and_sum() {
    let mut random = Random(35);
    let h = 1e-5;
    for robot in robots() {
        let tool = end_effector(&robot, &mut random);
        let (q, rates) = (random.q(&robot), random.vector(robot.n()));
        let state = robot.state(&q).unwrap();
        let n = robot.n();
        for reference in REFERENCES {
            let hessian = state.hessian(tool, reference).unwrap();
            assert_eq!(hessian.len(), n);
            let what = format!("{} {}", robot.name(), reference.name());
            for (k, exact) in hessian.iter().enumerate() {
                let e = unit(n, k);
                let at = |h: f64| {
                    robot
                        .state(&moved(&robot, &q, &e, h))
                        .unwrap()
                        .jacobian(tool, reference)
                        .unwrap()
                };
                let (a, b) = (at(h), at(-h));
                let difference = Matrix::from_fn(6, n, |i, j| (a[(i, j)] - b[(i, j)]) * (0.5 / h));
                assert_matrix(&what, exact, &difference, 2e-9 * (1.0 + robot.reach()));
            }
            let sum =
                Matrix::from_fn(6, n, |i, j| (0..n).map(|k| hessian[k][(i, j)] * rates[k]).sum());
            let dot = state.jacobian_dot(&rates, tool, reference).unwrap();
            assert_matrix(&what, &sum, &dot, 1e-12 * (1.0 + robot.reach()) * n as f64);
        }
    }
}

#[test]
fn analytical_jacobians_by_finite_differences() {
    let mut random = Random(36);
    let robot = catalogue::load("panda").unwrap();
    let h = 1e-6;
    use OrientationRates as Rates;
    for kind in [Rates::Rpy, Rates::Zyz, Rates::Xyz, Rates::RotationVector] {
        for _ in 0..20 {
            let q = random.q(&robot);
            let state = robot.state(&q).unwrap();
            let analytical = state.analytical_jacobian(robot.tool(), kind).unwrap();
            if analytical.determinant.abs() < 0.2
                || (kind == OrientationRates::RotationVector
                    && state.pose(robot.tool()).unwrap().rotation.log().norm() > 3.0)
            {
                continue;
            }
            assert!(analytical.exists);
            let coordinates = |q: &[f64]| {
                let pose = robot.state(q).unwrap().pose(robot.tool()).unwrap();
                let angles = match kind {
                    OrientationRates::Rpy => {
                        let a = Rpy::of(pose.rotation);
                        [a.roll, a.pitch, a.yaw]
                    }
                    OrientationRates::Zyz => {
                        let a = Zyz::of(pose.rotation);
                        [a.alpha, a.beta, a.gamma]
                    }
                    OrientationRates::Xyz => {
                        let a = Xyz::of(pose.rotation);
                        [a.alpha, a.beta, a.gamma]
                    }
                    OrientationRates::RotationVector => pose.rotation.log().to_array(),
                    other => panic!("{other:?} has no angles here"),
                };
                let p = pose.translation;
                [p.x, p.y, p.z, angles[0], angles[1], angles[2]]
            };
            for k in 0..7 {
                let e = unit(7, k);
                let (a, b) = (
                    coordinates(&moved(&robot, &q, &e, h)),
                    coordinates(&moved(&robot, &q, &e, -h)),
                );
                let difference: Vec<f64> = (0..6)
                    .map(|i| {
                        let d = a[i] - b[i];
                        (d - (d / std::f64::consts::TAU).round() * std::f64::consts::TAU)
                            * (0.5 / h)
                    })
                    .collect();
                assert_close(&format!("{kind:?}"), analytical.matrix.column(k), &difference, 2e-7);
            }
        }
    }
}

/// At gimbal lock the report says so and the numbers stay finite.
#[test]
fn analytical_jacobian_at_gimbal_lock() {
    let mut b = Mechanism::builder("wrist");
    let axes = [Vec3::Z, Vec3::Y, Vec3::X];
    for (i, axis) in axes.into_iter().enumerate() {
        b.joint(JointSpec {
            axis,
            ..JointSpec::new(
                &format!("q{i}"),
                JointKind::Revolute,
                &format!("l{i}"),
                &format!("l{}", i + 1),
            )
        });
    }
    let wrist = b.build().unwrap();
    let state = wrist.state(&[0.3, std::f64::consts::FRAC_PI_2, 0.2]).unwrap();
    let a = state.analytical_jacobian(wrist.tool(), OrientationRates::Rpy).unwrap();
    assert!(!a.exists && a.determinant.abs() < 1e-15 && a.matrix.is_finite());
    assert!(a.matrix.max_abs() < 2.0);
    let zyz = wrist.state(&[0.3, 0.0, 0.0]).unwrap();
    assert!(!zyz.analytical_jacobian(wrist.tool(), OrientationRates::Zyz).unwrap().exists);
}

/// A chain is the part of the state that moves one frame.
#[test]
fn chain_equals_state() {
    let mut random = Random(37);
    for robot in robots() {
        for frame in robot.frames() {
            let of = EndEffector {
                frame: robot.frame(&frame.name).unwrap(),
                frame_from_tool: random.pose(),
            };
            let q = random.q(&robot);
            let state = robot.state(&q).unwrap();
            let mut chain = Chain::new(&robot, of).unwrap();
            let pose = chain.set(&q);
            let scale = 1e-14 * (1.0 + robot.reach());
            assert_close(
                "pose",
                &pose_entries(pose),
                &pose_entries(state.pose(of).unwrap()),
                scale,
            );
            let mut j = Matrix::zeros(6, chain.n());
            for reference in REFERENCES {
                chain.jacobian_into(reference, &mut j);
                let full = state.jacobian(of, reference).unwrap();
                let mut rest = full.clone();
                for (k, &c) in chain.coordinates().iter().enumerate() {
                    assert_close("column", j.column(k), full.column(c), scale);
                    rest.column_mut(c).fill(0.0);
                }
                assert_eq!(rest.max_abs(), 0.0, "a column that moves the frame is missing");
            }
        }
    }
}

/// A mimic joint adds its multiplier times its own column to the joint it follows.
#[test]
fn mimic_joints_count_in_the_jacobian() {
    let build = |coupled: bool| {
        let mut b = Mechanism::builder("finger");
        b.joint(JointSpec::new("a", JointKind::Revolute, "palm", "first"));
        b.joint(JointSpec {
            parent_from_joint: Pose::from_translation(Vec3::X),
            mimic: coupled.then(|| cylindroid::model::Mimic {
                joint: "a".into(),
                multiplier: 0.7,
                offset: 0.1,
            }),
            ..JointSpec::new("b", JointKind::Revolute, "first", "second")
        });
        b.frame("tip", "second", Pose::from_translation(Vec3::X));
        b.build().unwrap()
    };
    let (coupled, free) = (build(true), build(false));
    assert_eq!((coupled.n(), free.n()), (1, 2));
    let q = 0.4;
    let (c, f) = (coupled.state(&[q]).unwrap(), free.state(&[q, 0.7 * q + 0.1]).unwrap());
    let tip = coupled.frame("tip").unwrap();
    assert_close(
        "pose",
        &pose_entries(c.pose(tip).unwrap()),
        &pose_entries(f.pose(tip).unwrap()),
        1e-15,
    );
    let (jc, jf) = (
        c.jacobian(tip, ReferenceFrame::World).unwrap(),
        f.jacobian(tip, ReferenceFrame::World).unwrap(),
    );
    let combined: Vec<f64> = (0..6).map(|i| jf[(i, 0)] + 0.7 * jf[(i, 1)]).collect();
    assert_close("column", jc.column(0), &combined, 1e-15);
}

/// Moving for a second in small steps is moving on the group.
#[test]
fn integrate_moves_free_and_spherical_joints_on_their_group() {
    let mut b = Mechanism::builder("body");
    b.joint(JointSpec::new("free", JointKind::Free, "world", "body"));
    let body = b.build().unwrap();
    let twist = Twist { linear: Vec3::new(0.3, -0.1, 0.2), angular: Vec3::new(1.0, -2.0, 0.5) };
    let q0 = [0.1, 0.2, 0.3, 0.5, -0.4, 0.9];
    let start = body.state(&q0).unwrap().pose(body.tool()).unwrap();
    let mut q = q0.to_vec();
    for _ in 0..1000 {
        q = body.integrate(&q, &twist.to_array(), 1e-3).unwrap();
    }
    let expected = start * cylindroid::spatial::exp(twist);
    assert_close(
        "pose",
        &pose_entries(body.state(&q).unwrap().pose(body.tool()).unwrap()),
        &pose_entries(expected),
        1e-12,
    );
    let j = body.state(&q).unwrap().jacobian(body.tool(), ReferenceFrame::Local).unwrap();
    assert_matrix("J", &j, &Matrix::identity(6), 1e-14);
}

#[test]
fn bad_q_is_refused_by_name_and_leaves_the_state() {
    let robot = catalogue::load("panda").unwrap();
    let error = robot.state(&[0.0; 6]).unwrap_err().to_string();
    assert!(
        error.contains("6 entries, expected 7") && error.contains(&robot.coordinates()[0].name),
        "{error}"
    );
    let mut state = robot.state(robot.home()).unwrap();
    let before = state.pose(robot.tool()).unwrap();
    let mut q = robot.home().to_vec();
    q[3] = f64::NAN;
    let error = state.set(&q).unwrap_err().to_string();
    assert!(error.contains(&robot.coordinates()[3].name) && error.contains("NaN"), "{error}");
    assert_eq!(state.pose(robot.tool()).unwrap(), before);
    let error = robot.frame("hand_tpc").unwrap_err().to_string();
    assert!(error.contains("nearest: hand_tcp"), "{error}");
}

/// The screw of a joint is its axis where it stands, whatever the links before it do.
#[test]
fn screws_of_joints() {
    let mut random = Random(77);
    let mut looked = 0;
    for robot in robots() {
        let q: Vec<f64> = (0..robot.n()).map(|_| random.within(-1.0, 1.0)).collect();
        let state = robot.state(&q).unwrap();
        let pose =
            |link: usize| state.pose(robot.frame(&robot.links()[link].name).unwrap()).unwrap();
        for (i, joint) in robot.joints().iter().enumerate() {
            let screws = state.joint_screws(i);
            assert_eq!(screws.len(), joint.coordinates.len(), "{}", joint.name);
            let frame = pose(joint.parent) * joint.parent_from_joint;
            let (p, axis) = (frame.translation, frame.rotation * joint.axis);
            let turn = Twist { linear: p.cross(axis), angular: axis };
            let slide = Twist { linear: axis, angular: Vec3::ZERO };
            let size = joint.mimic.as_ref().map_or(1.0, |m| m.multiplier);
            let expected = match joint.kind {
                JointKind::Revolute | JointKind::Continuous => turn,
                JointKind::Prismatic => slide,
                JointKind::Helical { pitch } => turn + slide * pitch,
                JointKind::Spherical => {
                    // About the child's axes, through its origin.
                    let at = frame.translation;
                    assert!(screws.iter().all(|s| (s.axis.nearest(at) - at).norm() < 1e-12));
                    continue;
                }
                _ => continue,
            } * size;
            looked += 1;
            let limit = 1e-12 * (1.0 + p.norm());
            assert_close(&joint.name, &screws[0].twist().to_array(), &expected.to_array(), limit);
        }
        assert!(state.joint_screws(robot.joints().len()).is_empty());
    }
    assert!(looked > 50, "{looked}");
}

/// Constraint wrenches of a loop-closure joint do no work in its screws, which are as many as its
/// degrees of freedom.
#[test]
fn screws_of_closing_joints() {
    let mut looked = 0;
    for name in catalogue::names() {
        let mechanism = catalogue::load(name).unwrap();
        let state = mechanism.state(mechanism.home()).unwrap();
        for (i, joint) in mechanism.loops().iter().enumerate() {
            let link = mechanism.frame(&mechanism.links()[joint.a].name).unwrap();
            let frame = state.pose(link).unwrap() * joint.link_a_from_joint;
            let screws = state.loop_screws(i);
            assert_eq!(screws.len(), joint.kind.dof(), "{}", joint.name);
            for wrench in joint.kind.constraint_wrenches(joint.axis, mechanism.dimension()) {
                let wrench = frame.coadjoint(wrench);
                for screw in &screws {
                    looked += 1;
                    assert!(screw.twist().power(wrench).abs() < 1e-12, "{name} {}", joint.name);
                }
            }
        }
        assert!(state.loop_screws(mechanism.loops().len()).is_empty());
    }
    assert!(looked > 20, "{looked}");
}
