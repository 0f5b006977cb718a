//! Secondary tasks and projectors.

use super::*;

/// The exact projector keeps the task undisturbed also where the inverse was truncated; the
/// retained one does not, as the theory says.
#[test]
fn secondary_motion_stays_in_the_null_space() {
    let robot = catalogue::load("panda").unwrap();
    let mut random = Random(41);
    let aligned_wrist = {
        let mut q = robot.home().to_vec();
        q[5] = 1e-4; // s_6 / s_1 about 1e-5: cut, yet not zero
        q
    };
    for q in [robot.home().to_vec(), aligned_wrist] {
        let state = robot.state(&q).unwrap();
        let j = state.jacobian(robot.tool(), ReferenceFrame::LocalWorldAligned).unwrap();
        for _ in 0..20 {
            let desired = random.vector(7);
            let mut servo = servo(&robot, |o| o.method = Method::Truncated { eps: 0.05 });
            servo.step_with(&q, state.pose(robot.tool()).unwrap(), &desired).unwrap();
            let rates = servo.joint_velocities().to_vec();
            let size: f64 = rates.iter().map(|r| r * r).sum::<f64>().sqrt();
            assert!(
                size > 0.0 || robot.coordinates().iter().any(|c| c.limits.acceleration.is_finite())
            );
            let moved = j.mul_vec(&rates).iter().map(|v| v * v).sum::<f64>().sqrt();
            assert!(moved <= 1e-12 * j.frobenius_norm() * size.max(1e-3), "{moved} of {size}");
        }
    }
}

#[test]
fn retained_projector_disturbs_the_task_where_directions_were_cut() {
    let robot = planar(3);
    // Stretched but for a little: the radial direction is cut.
    let q = [0.2, 1e-3, -2e-3];
    let state = robot.state(&q).unwrap();
    let j = state.jacobian(robot.tool(), ReferenceFrame::LocalWorldAligned).unwrap();
    let disturbance = |projector| {
        let mut servo = servo(&robot, |o| {
            o.task = Task::POSITION;
            o.method = Method::Truncated { eps: 0.1 };
            o.null_space = projector;
        });
        servo.step_with(&q, state.pose(robot.tool()).unwrap(), &[0.3, -1.0, 1.0]).unwrap();
        let v = j.mul_vec(servo.joint_velocities());
        v[0].hypot(v[1])
    };
    assert!(disturbance(SecondaryNullSpace::Exact) < 1e-13);
    assert!(disturbance(SecondaryNullSpace::Retained) > 1e-5);
}

#[test]
fn secondary_tasks_do_what_they_say() {
    let robot = catalogue::load("iiwa14").unwrap();
    let mut start = robot.home().to_vec();
    start[2] = 0.9;
    let pose = robot.state(&start).unwrap().pose(robot.tool()).unwrap();
    let after = |secondary: SecondaryTask| {
        let mut servo = servo(&robot, |o| {
            o.secondary = vec![secondary];
            o.tolerance = PoseTolerance { position: 1e-9, orientation: 1e-9 };
        });
        let mut q = start.clone();
        for _ in 0..20_000 {
            let step = servo.step(&q, pose).unwrap();
            assert!(step.position_error < 1e-4, "the task was disturbed");
            servo.advance(&mut q);
        }
        // At rest where the secondary task has no part left in the null space.
        assert!(
            servo.joint_velocities().iter().all(|r| r.abs() < 5e-3),
            "{:?}",
            servo.joint_velocities()
        );
        q
    };
    let distance =
        |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(x, y)| (x - y).powi(2)).sum::<f64>().sqrt();
    let posture = vec![0.0; 7];
    let q = after(SecondaryTask::Posture { q: posture.clone(), gain: 1.0 });
    assert!(distance(&q, &posture) < distance(&start, &posture) - 0.1);
    let q = after(SecondaryTask::Centring { gain: 1.0 });
    assert!(distance(&q, &[0.0; 7]) < distance(&start, &[0.0; 7]) - 0.1);
    let w = |q: &[f64]| {
        let j = robot
            .state(q)
            .unwrap()
            .jacobian(robot.tool(), ReferenceFrame::LocalWorldAligned)
            .unwrap();
        Svd::of(&j).values().product::<f64>()
    };
    let q = after(SecondaryTask::Manipulability { gain: 100.0 });
    assert!(w(&q) > 1.01 * w(&start), "{} from {}", w(&q), w(&start));
}

/// The gradient of the manipulability against central differences, through what the servo commands.
#[test]
fn secondary_manipulability_gradient_by_finite_differences() {
    let robot = planar(4);
    let q = [0.3, 0.7, -0.4, 1.1];
    let task = Task {
        components: [true, false, false, false, false, false],
        axes: ReferenceFrame::LocalWorldAligned,
    };
    let w = |q: &[f64]| {
        let j = robot
            .state(q)
            .unwrap()
            .jacobian(robot.tool(), ReferenceFrame::LocalWorldAligned)
            .unwrap();
        (0..4).map(|k| (j[(0, k)] / robot.reach()).powi(2)).sum::<f64>().sqrt()
    };
    let h = 1e-6;
    let mut gradient = [0.0; 4];
    for k in 0..4 {
        let (mut a, mut b) = (q, q);
        a[k] += h;
        b[k] -= h;
        gradient[k] = (w(&a) - w(&b)) / (2.0 * h);
    }
    let mut servo = servo(&robot, |o| {
        o.task = task;
        o.acceleration = Some(f64::INFINITY); // the first step is compared
        o.secondary = vec![SecondaryTask::Manipulability { gain: 1.0 }];
    });
    let state = robot.state(&q).unwrap();
    servo.step(&q, state.pose(robot.tool()).unwrap()).unwrap();
    // The gradient, projected on the null space of the one row.
    let j = state.jacobian(robot.tool(), ReferenceFrame::LocalWorldAligned).unwrap();
    let row: Vec<f64> = (0..4).map(|k| j[(0, k)]).collect();
    let norm2: f64 = row.iter().map(|x| x * x).sum();
    let along: f64 = row.iter().zip(gradient).map(|(r, g)| r * g).sum::<f64>() / norm2;
    for k in 0..4 {
        let expected = gradient[k] - along * row[k];
        assert!(
            (servo.joint_velocities()[k] - expected).abs() < 1e-9,
            "{} {expected}",
            servo.joint_velocities()[k]
        );
    }
}

/// A ball joint and a free body go to a posture the short way, from any attitude: in the null
/// space of a task that they do not disturb.
#[test]
fn secondary_posture_of_spherical_and_free_joints() {
    let mut random = Random(42);
    for (kind, reversed) in
        [(JointKind::Spherical, false), (JointKind::Spherical, true), (JointKind::Free, false)]
    {
        let mut b = Mechanism::builder("body");
        b.joint(JointSpec { reversed, ..JointSpec::new("body", kind, "ground", "a") });
        // Position alone of the joint's own origin: a ball joint is free to turn.
        b.joint(JointSpec {
            parent_from_joint: Pose::from_translation(Vec3::ZERO),
            ..JointSpec::new("slide", JointKind::Prismatic, "a", "tip")
        });
        let robot = b.build().unwrap();
        let n = robot.n();
        for _ in 0..20 {
            let (mut q, mut posture) = (vec![0.0; n], vec![0.0; n]);
            for x in [&mut q, &mut posture] {
                x[n - 4..n - 1].copy_from_slice(&random.rotation().log().to_array());
            }
            if kind == JointKind::Free {
                q[..3].copy_from_slice(&random.vec3(1.0).to_array());
                let here = robot.state(&q).unwrap().pose(robot.tool()).unwrap().translation;
                posture[..3].copy_from_slice(&here.to_array());
            }
            let pose = |q: &[f64]| robot.state(q).unwrap().pose(robot.tool()).unwrap();
            let target = pose(&q);
            let mut servo = servo(&robot, |o| {
                o.task = Task::POSITION;
                o.dt = 0.01;
                o.secondary = vec![SecondaryTask::Posture { q: posture.clone(), gain: 2.0 }];
            });
            let mut left = pose(&q).rotation.angle_to(pose(&posture).rotation);
            for _ in 0..1000 {
                let step = servo.step(&q, target).unwrap();
                assert!(step.position_error < 1e-9, "{step:?}");
                servo.advance(&mut q);
                let now = pose(&q).rotation.angle_to(pose(&posture).rotation);
                assert!(now <= left + 1e-12, "turns away: {left} rad, then {now}");
                left = now;
            }
            assert!(left < 1e-6, "{kind:?}: {left} rad left");
        }
    }
}

/// Several rows, scaled and weighted: the secondary velocity is the gradient of w = s_1 ... s_m of the scaled
/// Jacobian, in central differences, projected on its null space.
#[test]
fn secondary_manipulability_gradient_of_several_rows() {
    let robot = catalogue::load("iiwa14").unwrap();
    let mut random = Random(43);
    let weights: [f64; 7] = [1.0, 4.0, 0.5, 2.0, 1.0, 3.0, 0.25];
    for (round, task) in [Task::POSITION, Task::POSE, Task::POINTING].into_iter().enumerate() {
        for weighted in [false, true] {
            let weights = if weighted { weights.to_vec() } else { Vec::new() };
            let scale = |c: usize| weights.get(c).map_or(1.0, |w| 1.0 / w.sqrt());
            let q: Vec<f64> = random.vector(7).iter().map(|x| 0.4 + 0.5 * x).collect();
            let scaled = |q: &[f64]| {
                let j = robot.state(q).unwrap().jacobian(robot.tool(), task.axes).unwrap();
                let rows: Vec<usize> = (0..6).filter(|&i| task.components[i]).collect();
                Matrix::from_fn(rows.len(), 7, |i, c| {
                    let length = if rows[i] < 3 { robot.reach() } else { 1.0 };
                    j[(rows[i], c)] / length * scale(c)
                })
            };
            let w = |q: &[f64]| Svd::of(&scaled(q)).values().product::<f64>();
            let h = 1e-5;
            let mut expected: Vec<f64> = (0..7)
                .map(|k| {
                    let (mut a, mut b) = (q.clone(), q.clone());
                    a[k] += h;
                    b[k] -= h;
                    (w(&a) - w(&b)) / (2.0 * h) / scale(k)
                })
                .collect();
            RowSpace::exact(&Svd::of(&scaled(&q))).project_out(&mut expected);
            let mut servo = servo(&robot, |o| {
                o.task = task;
                o.acceleration = Some(f64::INFINITY); // the first step is compared
                o.joint_weights = weights.clone();
                o.secondary = vec![SecondaryTask::Manipulability { gain: 1.0 }];
            });
            servo.step(&q, robot.state(&q).unwrap().pose(robot.tool()).unwrap()).unwrap();
            let size = servo.joint_velocities().iter().fold(0.0_f64, |m, r| m.max(r.abs()));
            assert!(size > 1e-6, "{round}: nothing to compare in {size:e}");
            for (c, expected) in expected.iter().enumerate() {
                let (rate, expected) = (servo.joint_velocities()[c], expected * scale(c));
                assert!((rate - expected).abs() < 1e-9, "{round}, {c}: {rate} {expected}");
            }
        }
    }
}

/// A joint that the task does not need is pushed away from a limit nearer than the margin: fully at
/// the limit, half as fast half way into it, not at all beyond.
#[test]
fn secondary_limit_avoidance_pushes_by_the_room_that_is_left() {
    let mut b = Mechanism::builder("gantry");
    b.joint(JointSpec::new("slide", JointKind::Prismatic, "ground", "cart"));
    b.joint(JointSpec {
        limits: Limits { lower: -1.0, upper: 3.0, ..Limits::NONE },
        ..JointSpec::new("turn", JointKind::Revolute, "cart", "hook")
    });
    b.joint(JointSpec::new("swivel", JointKind::Continuous, "hook", "tip"));
    let robot = b.build().unwrap();
    let mut servo = servo(&robot, |o| {
        o.task = Task::POSITION;
        o.acceleration = Some(f64::INFINITY); // the first step is compared
        // 0.8 rad of the range of 4 rad
        o.secondary = vec![SecondaryTask::LimitAvoidance { gain: 0.5, margin: 0.2 }];
    });
    for (q, rate) in
        [(-1.0, 0.5), (-0.6, 0.25), (-0.2, 0.0), (1.0, 0.0), (2.2, 0.0), (2.8, -0.375), (3.0, -0.5)]
    {
        let q = [0.3, q, 2.0];
        servo.reset();
        servo.step(&q, robot.state(&q).unwrap().pose(robot.tool()).unwrap()).unwrap();
        assert!(
            (servo.joint_velocities()[1] - rate).abs() < 1e-12,
            "{q:?}: {:?}",
            servo.joint_velocities()
        );
        assert!(
            servo.joint_velocities()[0].abs() < 1e-12 && servo.joint_velocities()[2].abs() < 1e-12
        );
    }
}
