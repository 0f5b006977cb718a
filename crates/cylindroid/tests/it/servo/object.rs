//! The object of a closed chain, driven through its drives.

use cylindroid::catalogue;
use cylindroid::closure::{ClosedChain, MotionSpace, RowSelection, assemble};
use cylindroid::control::{MotionResult, SecondaryTask, Stall, Task, simulate};
use cylindroid::model::Mechanism;
use cylindroid::{Pose, ReferenceFrame, Servo, ServoOptions, Vec3};

use crate::support::Random;

/// All closed chains of the catalogue.
fn closed_chains() -> impl Iterator<Item = Mechanism> {
    catalogue::names()
        .iter()
        .map(|name| catalogue::load(name).unwrap())
        .filter(Mechanism::is_closed)
}

fn gap(mechanism: &Mechanism, q: &[f64]) -> f64 {
    let chain = ClosedChain::of(&mechanism.state(q).unwrap(), None, None).unwrap();
    chain.closure_error.distance / mechanism.reach() + chain.closure_error.angle
}

/// A configuration in which the loops are closed, near home.
fn assembled(mechanism: &Mechanism, spread: f64, random: &mut Random) -> Vec<f64> {
    let guess: Vec<f64> =
        mechanism.home().iter().map(|x| x + random.within(-spread, spread)).collect();
    let found = assemble(mechanism, &guess, &[]).unwrap();
    assert!(found.closed, "{}", mechanism.name());
    found.q
}

/// From `start` towards `target`, loops closed all the way, limits of positions and rates kept.
fn ride(servo: &mut Servo, start: &[f64], target: Pose, seconds: f64) -> MotionResult {
    let mechanism = servo.mechanism().clone();
    let mut widest: f64 = 0.0;
    let outcome = simulate(
        servo,
        start,
        seconds,
        |_| (target.into(), true),
        |sample| {
            widest = widest.max(gap(&mechanism, sample.q));
            assert_eq!(mechanism.outside_limits(sample.q).next(), None);
            for (rate, c) in sample.joint_velocities.iter().zip(mechanism.coordinates()) {
                assert!(rate.abs() <= c.limits.velocity, "{}", c.name);
            }
        },
    )
    .unwrap();
    assert!(widest < 1e-9, "{}: open by {widest:e}", mechanism.name());
    outcome
}

/// From home to the pose of another assembly: it is reached.
#[test]
fn objects_reach_poses_with_loops_closed() {
    let mut random = Random(11);
    for mechanism in closed_chains() {
        let mut servo = Servo::new(&mechanism, ServoOptions::new(&mechanism)).unwrap();
        for _ in 0..2 {
            let start = assembled(&mechanism, 0.0, &mut random);
            let goal = assembled(&mechanism, 0.15, &mut random);
            let target = mechanism.state(&goal).unwrap().pose(mechanism.reference()).unwrap();
            servo.reset();
            let outcome = ride(&mut servo, &start, target, 10.0);
            assert!(outcome.reached, "{}: {outcome:?}", mechanism.name());
            let end = mechanism.state(&outcome.q).unwrap().pose(mechanism.reference()).unwrap();
            assert!((end.translation - target.translation).norm() <= 1e-4);
            assert!(end.rotation.angle_to(target.rotation) <= 1e-3);
        }
    }
}

/// The commanded rates keep the loops closed: what opens them is of second order in the step.
#[test]
fn rates_keep_loops_closed() {
    let mut random = Random(12);
    for mechanism in closed_chains() {
        let q = assembled(&mechanism, 0.1, &mut random);
        let target = mechanism
            .state(&assembled(&mechanism, 0.1, &mut random))
            .unwrap()
            .pose(mechanism.reference())
            .unwrap();
        let mut servo = Servo::new(&mechanism, ServoOptions::new(&mechanism)).unwrap();
        servo.step(&q, target).unwrap();
        assert!(
            servo.joint_velocities().iter().any(|r| r.abs() > 1e-2),
            "{:?}",
            servo.joint_velocities()
        );
        let before = gap(&mechanism, &q);
        let mut opened = [1e-3, 1e-4].map(|dt| {
            let moved = mechanism.integrate(&q, servo.joint_velocities(), dt).unwrap();
            gap(&mechanism, &moved)
        });
        opened.iter_mut().for_each(|gap| *gap = (*gap - before).max(1e-13));
        assert!(opened[1] < 0.012 * opened[0] + 1e-12, "{}: {opened:?}", mechanism.name());
    }
}

/// Loops that a measurement shows open are closed by the next step.
#[test]
fn drift_is_corrected() {
    for name in ["3rrr", "stewart", "two-arm"] {
        let mechanism = catalogue::load(name).unwrap();
        let mut random = Random(13);
        let mut q = assembled(&mechanism, 0.1, &mut random);
        let target = mechanism.state(&q).unwrap().pose(mechanism.reference()).unwrap();
        q.iter_mut().for_each(|x| *x += random.within(-1e-4, 1e-4));
        let mut servo = Servo::new(&mechanism, ServoOptions::new(&mechanism)).unwrap();
        let open = gap(&mechanism, &q);
        servo.step(&q, target).unwrap();
        let dt = servo.options().dt;
        q = mechanism.integrate(&q, servo.joint_velocities(), dt).unwrap();
        let left = gap(&mechanism, &q);
        // Speed limits of the arms may ask for more than one step.
        assert!(left < 0.5 * open, "{name}: {open:e} to {left:e}");
        // Open by far: not the work of a servo.
        q[0] += 0.5;
        let error = servo.step(&q, target).unwrap_err().to_string();
        assert!(error.contains("assemble"), "{error}");
    }
}

/// Of all driven rates with the same motion of the object those with the least weighted effort are
/// taken: they are orthogonal, in the weights, to every motion that leaves the object at rest.
#[test]
fn drives_move_with_the_least_weighted_effort() {
    let two_arm = catalogue::load("two-arm").unwrap();
    let weights: Vec<f64> = (0..two_arm.n()).map(|i| 0.5 + 0.3 * i as f64).collect();
    let mut random = Random(14);
    for weights in [Vec::new(), weights] {
        let mut options = ServoOptions::new(&two_arm);
        options.joint_weights.clone_from(&weights);
        let mut servo = Servo::new(&two_arm, options).unwrap();
        let q = assembled(&two_arm, 0.1, &mut random);
        let mut target = two_arm.state(&q).unwrap().pose(two_arm.reference()).unwrap();
        // Near enough for no limit to bite.
        target.translation.z += 1e-3;
        let step = servo.step(&q, target).unwrap();
        assert_eq!(step.saturation.scale, 1.0);

        let chain = ClosedChain::of(&two_arm.state(&q).unwrap(), None, None).unwrap();
        let object = RowSelection { actuated: false, passive: false, object: true };
        let at_rest = MotionSpace::of(&chain.constraint).vanishing_on(object);
        assert_eq!(at_rest.cols(), 2);
        let rates = servo.joint_velocities();
        let size = rates.iter().map(|r| r * r).sum::<f64>().sqrt();
        for j in 0..at_rest.cols() {
            let along: f64 = (0..two_arm.n())
                .map(|i| weights.get(i).unwrap_or(&1.0) * rates[i] * at_rest[(i, j)])
                .sum();
            assert!(along.abs() < 1e-9 * size, "{along:e} of {size:e}");
        }
        // And the object moves as it was asked to.
        let jacobian = two_arm
            .state(&q)
            .unwrap()
            .jacobian(two_arm.reference(), ReferenceFrame::LocalWorldAligned)
            .unwrap();
        let twist = jacobian.mul_vec(rates);
        assert!((twist[2] - 5e-3).abs() < 1e-9, "{twist:?}");
    }
}

/// The motions of the two arms with the box at rest are the null space: a secondary task moves joints
/// and not the box.
#[test]
fn redundancy_is_the_null_space() {
    let two_arm = catalogue::load("two-arm").unwrap();
    let mut options = ServoOptions::new(&two_arm);
    let q = assembled(&two_arm, 0.0, &mut Random(15));
    let posture: Vec<f64> = q.iter().map(|x| x + 0.3).collect();
    options.secondary = vec![SecondaryTask::Posture { q: posture, gain: 1.0 }];
    let mut servo = Servo::new(&two_arm, options).unwrap();
    let target = two_arm.state(&q).unwrap().pose(two_arm.reference()).unwrap();
    servo.step(&q, target).unwrap();
    let rates = servo.joint_velocities();
    assert!(rates.iter().any(|r| r.abs() > 1e-3), "{rates:?}");
    let twist = two_arm
        .state(&q)
        .unwrap()
        .jacobian(two_arm.reference(), ReferenceFrame::LocalWorldAligned)
        .unwrap()
        .mul_vec(rates);
    assert!(twist.iter().all(|x| x.abs() < 1e-7), "{twist:?}");
    // The gradient of a manipulability of the cut tree is refused by name.
    let mut options = ServoOptions::new(&two_arm);
    options.secondary = vec![SecondaryTask::Manipulability { gain: 1.0 }];
    let error = Servo::new(&two_arm, options).unwrap_err().to_string();
    assert!(error.contains("manipulability"), "{error}");
}

/// Targets out of reach: the servo ends with a cause, loops closed and limits kept.
#[test]
fn unreachable_poses_end_with_a_cause() {
    for mechanism in closed_chains() {
        let start = assembled(&mechanism, 0.0, &mut Random(16));
        for way in [Vec3::new(9.0, 0.0, 0.0), Vec3::new(0.0, -9.0, 0.0), Vec3::new(-9.0, 9.0, 0.0)]
        {
            let mut options = ServoOptions::new(&mechanism);
            options.dt = 5e-3;
            options.speed.linear = 0.5 * mechanism.reach();
            options.task = if options.task == Task::PLANAR {
                Task { components: [true, true, false, false, false, false], ..Task::POSE }
            } else {
                Task::POSITION
            };
            let mut servo = Servo::new(&mechanism, options).unwrap();
            let mut target = mechanism.state(&start).unwrap().pose(mechanism.reference()).unwrap();
            target.translation += way;
            let outcome = ride(&mut servo, &start, target, 30.0);
            assert!(!outcome.reached && outcome.stall.is_some(), "{}", mechanism.name());
        }
    }
}

/// Five-bar driven at its cranks: pushed to where the two links at its tip are in line, the tip
/// would snap either way. The servo stops before.
#[test]
fn the_servo_stops_before_a_motion_escapes_the_drives() {
    let five_bar = catalogue::load("five-bar").unwrap().with_actuated(&["q1", "q5"]).unwrap();
    let start = assembled(&five_bar, 0.0, &mut Random(17));
    let mut options = ServoOptions::new(&five_bar);
    options.task.components = [true, true, false, false, false, false];
    options.speed.linear = 1.0;
    options.acceleration = Some(f64::INFINITY);
    let mut servo = Servo::new(&five_bar, options).unwrap();
    let mut target = five_bar.state(&start).unwrap().pose(five_bar.reference()).unwrap();
    target.translation.y -= 2.0;
    let outcome = simulate(&mut servo, &start, 30.0, |_| (target.into(), true), |_| ()).unwrap();
    let Some(Stall::TypeII { share, direction }) = outcome.stall else {
        panic!("{outcome:?}");
    };
    assert!(share < 1e-2 && share > 5e-3, "{share}");
    assert!(servo.is_stopped() && servo.joint_velocities().iter().all(|r| *r == 0.0));
    // Links 2-3 and 3-4 are nearly in line, and have not passed it; the tip escapes across them.
    let state = five_bar.state(&outcome.q).unwrap();
    let at = |link: &str| state.pose(five_bar.frame(link).unwrap()).unwrap().translation;
    let (first, second) = (at("rod") - at("coupler"), at("rocker") - at("rod"));
    let bend = first.cross(second).z / (first.norm() * second.norm());
    let bend_at_home = -std::f64::consts::FRAC_1_SQRT_2;
    assert!(bend * bend_at_home > 0.0 && bend.abs() < 0.1, "{bend}");
    let along = direction[0] * first.x + direction[1] * first.y;
    assert!(along.abs() < 0.1, "{along}");
    // The other way is open.
    target.translation.y += 2.0;
    let back = simulate(&mut servo, &outcome.q, 30.0, |_| (target.into(), true), |_| ()).unwrap();
    assert!(back.reached, "{back:?}");
}

/// While joints gain speed under acceleration limits, rates keep the loops too, and the object is
/// there as soon as without loops.
#[test]
fn weak_joints_keep_loops_closed() {
    for (name, way) in [("five-bar", [0.03, -0.03, 0.0]), ("stewart", [0.1, 0.0, 0.1])] {
        let mechanism = catalogue::load(name).unwrap();
        let mut options = ServoOptions::new(&mechanism);
        options.acceleration = Some(0.5);
        options.task.components = [true, true, name == "stewart", false, false, false];
        let dt = options.dt;
        let mut servo = Servo::new(&mechanism, options).unwrap();
        let start = mechanism.home().to_vec();
        let mut target = mechanism.state(&start).unwrap().pose(mechanism.reference()).unwrap();
        target.translation += Vec3::from_array(way);
        let (mut before, mut widest) = (start.clone(), 0.0_f64);
        let outcome = simulate(
            &mut servo,
            &start,
            5.0,
            |_| (target.into(), true),
            |sample| {
                let moved = mechanism.integrate(&before, sample.joint_velocities, dt).unwrap();
                widest = widest.max(gap(&mechanism, &moved));
                before.copy_from_slice(sample.q);
            },
        )
        .unwrap();
        assert!(outcome.reached, "{name}: {outcome:?}");
        // Of second order in the step.
        assert!(widest < 1e-6, "{name}: {widest:e}");
    }
}

/// At a position limit of one joint the others slide along it; they do not stop and start.
#[test]
fn weak_joints_slide_along_limits() {
    let mechanism = catalogue::load("two-arm").unwrap();
    let mut options = ServoOptions::new(&mechanism);
    options.task = Task::POSITION;
    let mut servo = Servo::new(&mechanism, options).unwrap();
    let start = mechanism.home().to_vec();
    let mut target = mechanism.state(&start).unwrap().pose(mechanism.reference()).unwrap();
    target.translation = Vec3::new(0.05, 0.0, 0.05);
    let outcome = simulate(&mut servo, &start, 8.0, |_| (target.into(), true), |_| ()).unwrap();
    assert!(outcome.stall.is_some() && outcome.last.position_error < 0.415, "{outcome:?}");
}

/// Drives that do not hold the object make no servo.
#[test]
fn an_object_must_be_steered() {
    let five_bar = catalogue::load("five-bar").unwrap().with_actuated(&["q1"]).unwrap();
    let error = Servo::new(&five_bar, ServoOptions::new(&five_bar)).unwrap_err().to_string();
    assert!(error.contains("actuate more"), "{error}");
    let none = catalogue::load("stewart").unwrap().with_actuated::<&str>(&[]).unwrap();
    assert!(Servo::new(&none, ServoOptions::new(&none)).is_err());
}

/// A five-bar sent across its type II singularity stops before, whatever the step and the
/// accelerations: it used to jump across and lose its loops.
#[test]
fn no_step_jumps_across_a_type_ii_singularity() {
    let mechanism = catalogue::load("five-bar").unwrap();
    let q = assemble(&mechanism, mechanism.home(), &[]).unwrap().q;
    let mut stopped = 0;
    for (x, y) in [(-0.45, 0.9), (0.45, 0.9), (0.0, 1.0), (0.6, -1.2), (-1.0, 0.3)] {
        for dt in [1e-3, 2e-3, 1e-2] {
            for acceleration in [5.0, 10.0, 100.0, f64::INFINITY] {
                let mut options = ServoOptions::new(&mechanism);
                (options.dt, options.acceleration) = (dt, Some(acceleration));
                let end_effector = options.end_effector;
                let pose = mechanism.state(&q).unwrap().pose(end_effector).unwrap();
                let target = Pose { translation: pose.translation + Vec3::new(x, y, 0.0), ..pose };
                let mut servo = Servo::new(&mechanism, options).unwrap();
                let mut error = (target.translation - pose.translation).norm();
                let outcome = simulate(
                    &mut servo,
                    &q,
                    10.0,
                    |_| (target.into(), true),
                    |sample| {
                        let at = mechanism.state(sample.q).unwrap().pose(end_effector).unwrap();
                        let now = (target.translation - at.translation).norm();
                        // Nearer in every step, up to the braking of joints that were pushed.
                        assert!(now < error + 0.1, "({x}, {y}), dt {dt}, {acceleration}: {now}");
                        error = error.min(now);
                    },
                )
                .unwrap();
                assert!(gap(&mechanism, &outcome.q) < 1e-9);
                stopped += usize::from(matches!(outcome.stall, Some(Stall::TypeII { .. })));
            }
        }
    }
    assert!(stopped > 10, "{stopped}");
}

/// A rigid loop whose joints are all passive: nothing to drive.
#[test]
fn a_mechanism_without_actuated_joints_is_refused() {
    let text = r#"
        name = "triangle"
        dimension = 2
        reference = "b"
        [[joint]]
        name = "q1"
        type = "revolute"
        between = ["ground", "a"]
        origin = [0, 0]
        [[joint]]
        name = "q2"
        type = "revolute"
        between = ["a", "b"]
        origin = [0, 1]
        [[joint]]
        name = "q3"
        type = "revolute"
        between = ["b", "ground"]
        origin = [1, 0]
    "#;
    let triangle =
        cylindroid::model::formats::toml::parse(text, std::path::Path::new("triangle.toml"))
            .unwrap();
    let error = Servo::new(&triangle, ServoOptions::new(&triangle)).unwrap_err().to_string();
    assert!(error.contains("no joint of 'triangle' is actuated"), "{error}");
}
