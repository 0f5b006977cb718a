//! A servo step allocates nothing, with any inverse and any secondary task, also where limits bite,
//! and in closed chains away from type II singularities.
#![allow(missing_docs, unsafe_code, clippy::unwrap_used)]

mod tasks;

use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;

use cylindroid::closure::assemble;
use cylindroid::collision::{CollisionModel, CollisionOptions};
use cylindroid::control::{
    Admittance, AdmittanceGain, HybridController, HybridInput, MotionTask, Plant, SecondaryTask,
    ServoGains, SharedController, SharedInput, Task, TaskObjective, TaskProjection, TaskServo,
    TaskServoOptions,
};
use cylindroid::ik::Analytic;
use cylindroid::inverse::{HyperbolicDamping, Method};
use cylindroid::kinematics::{Chain, EndEffector, KinematicsBatch};
use cylindroid::model::{Collision, Geometry, Inertial, JointKind, JointSpec, Link};
use cylindroid::screws::{Complement, Projector, ScrewOptions};
use cylindroid::spatial::Mat3;
use cylindroid::{
    Matrix, Mechanism, Pose, ReferenceFrame, Rotation, Servo, ServoOptions, Twist, Vec3, catalogue,
};

struct Counting;

thread_local! {
    /// Of this thread alone: the test harness allocates on its own.
    static ALLOCATIONS: Cell<usize> = const { Cell::new(0) };
}

fn note() {
    ALLOCATIONS.with(|n| n.set(n.get() + 1));
}

// SAFETY: hands every call to the system's allocator unchanged; it only counts.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        note();
        // SAFETY: the caller keeps the contract of `alloc`.
        unsafe { System.alloc(layout) }
    }

    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        // SAFETY: the caller keeps the contract of `dealloc`.
        unsafe { System.dealloc(pointer, layout) }
    }

    unsafe fn realloc(&self, pointer: *mut u8, layout: Layout, size: usize) -> *mut u8 {
        note();
        // SAFETY: the caller keeps the contract of `realloc`.
        unsafe { System.realloc(pointer, layout, size) }
    }
}

#[global_allocator]
static ALLOCATOR: Counting = Counting;

#[test]
fn hot_paths_allocate_nothing() {
    for name in catalogue::names() {
        let robot = catalogue::load(name).unwrap();
        let home = robot.home().to_vec();
        let start = robot.state(&home).unwrap().pose(robot.tool()).unwrap();

        let mut state = robot.state(&home).unwrap();
        let mut chain = Chain::new(&robot, robot.tool()).unwrap();
        let mut j = Matrix::zeros(6, robot.n());
        let mut narrow = Matrix::zeros(6, chain.n());
        let counted = count(|| {
            for _ in 0..100 {
                state.set(&home).unwrap();
                state.jacobian_into(robot.tool(), ReferenceFrame::World, &mut j).unwrap();
                chain.set(&home);
                chain.jacobian_into(ReferenceFrame::Local, &mut narrow);
            }
        });
        assert_eq!(counted, 0, "{name}: kinematics");
        if robot.is_closed() {
            continue;
        }

        for method in Method::ALL {
            for task in [Task::POSE, Task::POSITION] {
                let options = ServoOptions {
                    method,
                    task,
                    // So fast that velocity, acceleration and position limits all bite.
                    gain: ServoGains { position: 100.0, orientation: 100.0 },
                    secondary: SecondaryTask::all(&home).to_vec(),
                    ..ServoOptions::new(&robot)
                };
                let mut servo = Servo::new(&robot, options).unwrap();
                let target =
                    Pose { translation: start.translation + Vec3::new(0.3, 0.8, -0.9), ..start };
                let mut q = home.clone();
                let (mut scaled, mut changed) = (0, 0);
                let counted = count(|| {
                    for _ in 0..1500 {
                        let step = servo.step(&q, target).unwrap();
                        scaled += usize::from(step.saturation.scale < 1.0);
                        changed += usize::from(step.saturation.direction_lost);
                        servo.advance(&mut q);
                    }
                });
                assert_eq!(counted, 0, "{name}, {}: {counted} allocations", method.name());
                // Selectively damped rates stay below the limits of some arms by themselves.
                let slow = matches!(method, Method::SelectivelyDamped { .. });
                assert!(scaled + changed > 0 || slow, "{name}: no limit was met");
            }
        }
        if *name == "youbot" {
            projections(&robot, start);
        }
    }
}

/// Out of singular configurations, where the linearised task is lost.
#[test]
fn escapes_allocate_nothing() {
    let ur5e = catalogue::load("ur5e").unwrap();
    let mut q = vec![0.0, -1.2, 0.0, -0.4, 1.2, 0.3];
    let target = ur5e.state(&[0.1, -1.2, 0.8, -0.6, 1.1, 0.3]).unwrap().pose(ur5e.tool()).unwrap();
    let mut servo = Servo::new(&ur5e, ServoOptions::new(&ur5e)).unwrap();
    let (mut changed, mut left) = (0, f64::INFINITY);
    let counted = count(|| {
        for _ in 0..3000 {
            let step = servo.step(&q, target).unwrap();
            servo.advance(&mut q);
            changed += usize::from(step.saturation.direction_lost);
            left = step.position_error;
        }
    });
    assert_eq!(counted, 0);
    assert!(changed > 0 && left < 1e-3, "{changed} {left}");
}

fn frame(end_effector: EndEffector, components: Task, target: Pose) -> TaskObjective {
    TaskObjective::Frame { end_effector, components, target: target.into() }
}

/// Behind drives that lag, with limits of the jerk: towards a target and along a twist, of one task and of several, and of a
/// closed chain with redundant sensors.
#[test]
fn robots_that_lag_allocate_nothing() {
    let plant = Plant { delay: 0.02, time_constant: 0.01, noise: 1e-4 };
    let panda = catalogue::load("panda").unwrap();
    let start = panda.state(panda.home()).unwrap().pose(panda.tool()).unwrap();
    let target = Pose { translation: start.translation + Vec3::new(0.3, 0.8, -0.9), ..start };
    let options = ServoOptions { plant, jerk: 200.0, ..ServoOptions::new(&panda) };
    let mut servo = Servo::new(&panda, options).unwrap();
    let hand = frame(panda.tool().into(), Task::POSE, target);
    let options = TaskServoOptions { plant, jerk: 200.0, ..TaskServoOptions::new(&panda) };
    let mut tasks = TaskServo::new(&panda, vec![MotionTask::new("hand", hand)], options).unwrap();
    let twist = Twist { linear: Vec3::new(0.0, 0.1, 0.1), angular: Vec3::Z * 0.1 };
    let (mut q, mut p) = (panda.home().to_vec(), panda.home().to_vec());
    let counted = count(|| {
        for round in 0..1500 {
            match round % 3 {
                0 => servo.step_twist(&q, Some(twist)).unwrap().step,
                _ => servo.step(&q, target).unwrap(),
            };
            servo.advance(&mut q);
            tasks.step(&p).unwrap();
            tasks.advance(&mut p);
        }
    });
    assert_eq!(counted, 0);

    let five_bar = catalogue::load("five-bar").unwrap();
    let options = ServoOptions { plant, acceleration: Some(5.0), ..ServoOptions::new(&five_bar) };
    let mut servo = Servo::new(&five_bar, options).unwrap();
    let q = assemble(&five_bar, five_bar.home(), &[]).unwrap().q;
    servo.start_from(&q).unwrap();
    let pose = five_bar.state(&q).unwrap().pose(five_bar.reference()).unwrap();
    let actuated: Vec<f64> = five_bar.actuated().map(|i| q[i]).collect();
    let passive = (0..five_bar.n()).find(|&i| !five_bar.coordinates()[i].actuated).unwrap();
    let sensors = [(passive, q[passive] + 1e-5)];
    servo.step_measured(&actuated, &sensors, pose).unwrap(); // memory for the sensors
    let counted = count(|| {
        for _ in 0..100 {
            servo.step_measured(&actuated, &sensors, pose).unwrap();
            servo.step_twist_measured(&actuated, &sensors, Some(twist)).unwrap();
        }
    });
    assert_eq!(counted, 0);
}

/// Closed chains, with limits that bite, from all joints and from the actuated ones alone.
#[test]
fn closed_chains_allocate_nothing() {
    for name in catalogue::names() {
        let mechanism = catalogue::load(name).unwrap();
        if !mechanism.is_closed() {
            continue;
        }
        let home = assemble(&mechanism, mechanism.home(), &[]).unwrap().q;
        let start = mechanism.state(&home).unwrap().pose(mechanism.reference()).unwrap();
        // Manipulability is for trees.
        let mut secondary = SecondaryTask::all(&home).to_vec();
        secondary.retain(|s| !matches!(s, SecondaryTask::Manipulability { .. }));
        for secondary in [Vec::new(), secondary] {
            let options = ServoOptions {
                task: Task::POSITION,
                gain: ServoGains { position: 100.0, orientation: 100.0 },
                acceleration: Some(5.0),
                secondary,
                ..ServoOptions::new(&mechanism)
            };
            let mut servo = Servo::new(&mechanism, options).unwrap();
            servo.start_from(&home).unwrap();
            // A 3-RPS rises and does not shift.
            let along = if *name == "3rps" { Vec3::Z } else { Vec3::X };
            let translation = start.translation + along * (0.02 * mechanism.reach());
            let target = Pose { translation, ..start };
            let mut q = home.clone();
            let (mut scaled, mut counted) = (0, 0);
            for round in 0..600 {
                let actuated: Vec<f64> = mechanism.actuated().map(|i| q[i]).collect();
                counted += count(|| {
                    let step = match round % 2 {
                        0 => servo.step(&q, target).unwrap(),
                        _ => servo.step_actuated(&actuated, target).unwrap(),
                    };
                    scaled += usize::from(step.saturation.scale < 1.0);
                });
                servo.advance(&mut q);
            }
            let linear = along * (0.02 * mechanism.reach());
            let twist = Twist { linear, angular: Vec3::ZERO };
            for round in 0..100 {
                let actuated: Vec<f64> = mechanism.actuated().map(|i| q[i]).collect();
                let command = (round < 50 && round % 10 == 0).then_some(twist);
                counted += count(|| {
                    servo.step_twist_actuated(&actuated, command).unwrap();
                });
                servo.advance(&mut q);
            }
            assert_eq!(counted, 0, "{name}: {counted} allocations");
            assert!(scaled > 0, "{name}: no limit was met");
        }
    }
}

/// Batches of arms that are whole mechanisms, on one thread, without rows left over.
#[test]
fn batches_allocate_nothing() {
    for name in ["panda", "ur5e", "youbot", "3r"] {
        let robot = catalogue::load(name).unwrap();
        let (n, batch) = (robot.n(), KinematicsBatch::new(&robot, robot.tool()).unwrap());
        for rows in [8, 16, KinematicsBatch::CHUNK] {
            let q = robot.home().repeat(rows);
            let (mut poses, mut jacobians) = (vec![0.0; rows * 16], vec![0.0; rows * 6 * n]);
            let counted = count(|| {
                batch.poses_into(&q, &mut poses).unwrap();
                let (poses, jacobians) = (&mut poses[..], &mut jacobians[..]);
                batch
                    .poses_and_jacobians_into(&q, ReferenceFrame::Local, poses, jacobians)
                    .unwrap();
            });
            assert_eq!(counted, 0, "{name}: {rows} rows");
        }
    }
}

/// All answers by formulas.
#[test]
fn formulas_allocate_nothing() {
    for (name, locked) in [("ur5e", &[][..]), ("puma560", &[]), ("panda", &[6])] {
        let robot = catalogue::load(name).unwrap();
        let mut ik = Analytic::with_locked(&robot, robot.tool(), locked).unwrap();
        let mut start = robot.home().to_vec();
        let target = robot.state(&start).unwrap().pose(robot.tool()).unwrap();
        let mut answers = 0;
        let counted = count(|| {
            for _ in 0..100 {
                locked.iter().for_each(|&c| start[c] += 0.01);
                answers += ik.solve(target, &start).unwrap().len();
            }
        });
        assert!(counted == 0 && answers > 100, "{name}: {counted} allocations, {answers} answers");
    }
}

/// Weights by inertia, with the mass matrix of every step.
#[test]
fn inertia_allocates_nothing() {
    let mut builder = Mechanism::builder("arm");
    let inertial = Inertial {
        mass: 2.0,
        link_from_inertia: Pose::from_translation(Vec3::X * 0.2),
        inertia: Mat3::from_rows([[0.1, 0.0, 0.0], [0.0, 0.2, 0.0], [0.0, 0.0, 0.3]]),
    };
    for i in 0..4 {
        let [parent, child] = [i, i + 1].map(|k| format!("l{k}"));
        builder.link(Link { inertial: Some(inertial), ..Link::named(&child) });
        builder.joint(JointSpec {
            parent_from_joint: Pose::from_translation(Vec3::X * 0.4),
            ..JointSpec::new(&format!("q{i}"), JointKind::Revolute, &parent, &child)
        });
    }
    let arm = builder.build().unwrap();
    let options =
        ServoOptions { inertia_weights: true, task: Task::POSITION, ..ServoOptions::new(&arm) };
    let mut servo = Servo::new(&arm, options).unwrap();
    let mut q = vec![0.3, 0.8, -0.5, 0.9];
    let start = arm.state(&q).unwrap().pose(arm.tool()).unwrap();
    let target = Pose { translation: start.translation + Vec3::new(0.01, 0.02, 0.0), ..start };
    let mut moved = 0.0;
    let counted = count(|| {
        for _ in 0..200 {
            servo.step(&q, target).unwrap();
            servo.advance(&mut q);
            moved += servo.joint_velocities()[1].abs();
        }
    });
    assert!(counted == 0 && moved > 0.0, "{counted} allocations");
}

/// Five joints: every projection does something.
fn projections(robot: &Mechanism, start: Pose) {
    let give_up = Twist { linear: Vec3::ZERO, angular: Vec3::X };
    let damped = |damping| TaskProjection::DampedHyperbolic { h: 0.1, damping };
    for projection in [
        TaskProjection::Hyperbolic { h: 0.1 },
        TaskProjection::Hyperbolic { h: f64::INFINITY },
        damped(HyperbolicDamping::Invariant { mu: 0.01 }),
        damped(HyperbolicDamping::Gram { lambda: 0.01 }),
        TaskProjection::Oblique { complement: vec![give_up], reference: ReferenceFrame::Local },
    ] {
        let name = format!("{projection:?}");
        let options = ServoOptions { projection, ..ServoOptions::new(robot) };
        let mut servo = Servo::new(robot, options).unwrap();
        let target = Pose { translation: start.translation + Vec3::new(0.01, 0.02, 0.0), ..start };
        let mut q = robot.home().to_vec();
        let counted = count(|| {
            for _ in 0..200 {
                servo.step(&q, target).unwrap();
                servo.advance(&mut q);
            }
        });
        assert_eq!(counted, 0, "{name}");
        assert_eq!(servo.no_inverse(), None, "{name}");
    }
}

#[test]
fn control_laws_allocate_nothing() {
    let turn = |angular| Twist { linear: Vec3::ZERO, angular };
    let slide = |linear| Twist { linear, angular: Vec3::ZERO };
    let free = [slide(Vec3::X), slide(Vec3::Y), turn(Vec3::X), turn(Vec3::Y), turn(Vec3::Z)];
    let normal = [slide(Vec3::Z)];
    let admittance =
        Admittance::at(Vec3::ZERO, AdmittanceGain { force: 1e-3, moment: 0.0 }).unwrap();
    let (hybrid, shared) =
        (HybridController::new(5.0, admittance).unwrap(), SharedController::new(5.0).unwrap());
    let options = ScrewOptions::with_length(0.5);
    for along in [
        Complement::Twists(&normal),
        Complement::Reciprocal { h: 0.2 },
        Complement::Reciprocal { h: f64::INFINITY },
    ] {
        let counted = count(|| {
            for _ in 0..100 {
                let p = Projector::of(&free, along, &options).unwrap().unwrap();
                hybrid.command(&p, &HybridInput::default()).unwrap();
                shared.command(&p, &SharedInput::default()).unwrap();
            }
        });
        assert_eq!(counted, 0, "{along:?}");
    }
}

/// Shapes of all kinds, apart and with overlapping cores, once the scratch memory has its size.
#[test]
fn distances_allocate_nothing() {
    let mut builder = Mechanism::builder("slide");
    let point = |k: i32| Vec3::new((0.7 * f64::from(k)).sin(), (1.1 * f64::from(k)).cos(), 0.1);
    let shapes = [
        Geometry::Sphere { radius: 0.1 },
        Geometry::Capsule { radius: 0.1, length: 0.4 },
        Geometry::Box { size: Vec3::new(0.2, 0.3, 0.4) },
        Geometry::Cylinder { radius: 0.2, length: 0.4 },
        Geometry::ConvexHull {
            points: (0..60).map(|k| point(k) * 0.2 + Vec3::Z * (0.01 * f64::from(k))).collect(),
        },
        Geometry::HalfSpace,
    ];
    for geometry in &shapes[..5] {
        builder.collision("cart", Collision { geometry: geometry.clone(), ..Collision::default() });
    }
    builder.joint(JointSpec::new("x", JointKind::Prismatic, "rail", "cart"));
    let robot = builder.build().unwrap();
    let mut model = CollisionModel::new(&robot, &CollisionOptions::default()).unwrap();
    let names: Vec<String> = (0..shapes.len()).map(|i| format!("obstacle {i}")).collect();
    let place = |i: usize| Pose {
        rotation: Rotation::exp(Vec3::new(0.3, 0.2, -0.4) * (1 + i) as f64),
        translation: Vec3::new(0.11, 0.05, 0.7),
    };
    for (i, (name, shape)) in names.iter().zip(&shapes).enumerate() {
        model.add_obstacle(name, shape, place(i)).unwrap();
    }
    let mut state = robot.state(&[0.0]).unwrap();
    let (mut near, mut row) = (Vec::new(), vec![0.0; 1]);
    let (mut overlapping, mut counted) = (0, 0);
    for _ in 0..2 {
        // The second time, all memory is there.
        counted = count(|| {
            for step in 0..200 {
                state.set(&[0.01 * f64::from(step)]).unwrap();
                for (i, name) in names.iter().enumerate() {
                    model.move_obstacle(name, place(i)).unwrap();
                }
                model.near(&state, f64::INFINITY, &mut near).unwrap();
                for pair in &near {
                    overlapping += usize::from(pair.distance < 0.0);
                    model.gradient_into(&state, pair, &mut row);
                }
            }
        });
    }
    assert!(overlapping > 1000, "{overlapping}");
    assert_eq!(counted, 0);
}

fn count(f: impl FnOnce()) -> usize {
    let before = ALLOCATIONS.with(Cell::get);
    f();
    ALLOCATIONS.with(Cell::get) - before
}
