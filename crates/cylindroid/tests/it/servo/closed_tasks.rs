//! Many tasks of a closed chain: the same motions as its servo of one task, priorities among tasks of
//! object and joints, noise, and stops before type II singularities.

use cylindroid::closure::{ClosedChain, assemble};
use cylindroid::control::{MotionTask, StoppedBy, TaskObjective, TaskServo, TaskServoOptions};

use super::plant::BEHIND_LOOPS;
use super::*;

fn closed_chains() -> impl Iterator<Item = Mechanism> {
    let all = catalogue::names().iter().map(|name| catalogue::load(name).unwrap());
    all.filter(Mechanism::is_closed)
}

fn assembled(mechanism: &Mechanism, spread: f64, random: &mut Random) -> Vec<f64> {
    let guess: Vec<f64> =
        mechanism.home().iter().map(|x| x + random.within(-spread, spread)).collect();
    let found = assemble(mechanism, &guess, &[]).unwrap();
    assert!(found.closed, "{}", mechanism.name());
    found.q
}

/// How far the loops are open.
fn gap(mechanism: &Mechanism, q: &[f64]) -> f64 {
    let chain = ClosedChain::of(&mechanism.state(q).unwrap(), None, None).unwrap();
    chain.closure_error.distance / mechanism.reach() + chain.closure_error.angle
}

fn object(mechanism: &Mechanism, target: Pose) -> MotionTask {
    let defaults = ServoOptions::new(mechanism);
    MotionTask::new(
        "object",
        TaskObjective::Frame {
            end_effector: defaults.end_effector,
            components: defaults.task,
            target: target.into(),
        },
    )
}

/// One task far from limits gives the joint velocities of the servo of one task.
#[test]
fn one_task_is_the_servo_of_the_object() {
    let mut random = Random(5);
    for mechanism in closed_chains() {
        let q = assembled(&mechanism, 0.1, &mut random);
        let goal = assembled(&mechanism, 0.1, &mut random);
        let at = |q: &[f64]| {
            mechanism.state(q).unwrap().pose(ServoOptions::new(&mechanism).end_effector).unwrap()
        };
        let target = Pose {
            translation: at(&q).translation + (at(&goal).translation - at(&q).translation) * 1e-3,
            ..at(&q)
        };
        let mut one = Servo::new(&mechanism, ServoOptions::new(&mechanism)).unwrap();
        one.step(&q, target).unwrap();
        let options = TaskServoOptions::new(&mechanism);
        let mut many =
            TaskServo::new(&mechanism, vec![object(&mechanism, target)], options).unwrap();
        many.step(&q).unwrap();
        let size = one.joint_velocities().iter().fold(0.0_f64, |a, b| a.max(b.abs()));
        assert!(size > 1e-6, "{}", mechanism.name());
        for (a, b) in one.joint_velocities().iter().zip(many.joint_velocities()) {
            assert!((a - b).abs() < 1e-6 * size, "{}: {a} {b}", mechanism.name());
        }
    }
}

/// Objects reach poses with their loops closed and no limit left, measured with noise or without.
#[test]
fn objects_reach_poses_with_loops_closed_and_noise() {
    let mut random = Random(6);
    for mechanism in closed_chains() {
        for noise in [0.0, 1e-4] {
            let start = assembled(&mechanism, 0.0, &mut random);
            let goal = assembled(&mechanism, 0.12, &mut random);
            let end_effector = ServoOptions::new(&mechanism).end_effector;
            let target = mechanism.state(&goal).unwrap().pose(end_effector).unwrap();
            let mut options = TaskServoOptions::new(&mechanism);
            (options.dt, options.acceleration) = (2e-3, 5.0);
            let tasks = vec![object(&mechanism, target)];
            let mut servo = TaskServo::new(&mechanism, tasks, options).unwrap();
            let mut q = start;
            for _ in 0..4000 {
                let measured: Vec<f64> =
                    q.iter().map(|x| x + noise * random.within(-1.0, 1.0)).collect();
                servo.step(&measured).unwrap();
                servo.advance(&mut q);
                assert!(gap(&mechanism, &q) < 1e-9, "{}", mechanism.name());
                for (rate, c) in servo.joint_velocities().iter().zip(mechanism.coordinates()) {
                    assert!(rate.abs() <= c.limits.velocity, "{}", c.name);
                }
            }
            let left = mechanism.state(&q).unwrap().pose(end_effector).unwrap().error_to(target);
            let left = left.linear.norm() / mechanism.reach() + left.angular.norm();
            assert!(left < 1e-4 + 10.0 * noise, "{}, noise {noise}: {left:e}", mechanism.name());
        }
    }
}

/// Behind drives that lag, the loops of the configuration to which commands lead are closed: the
/// object stops before a type II singularity as that of an ideal robot does.
#[test]
fn loops_stop_before_singularities_behind_drives() {
    let mechanism = catalogue::load("five-bar").unwrap();
    let mut target =
        mechanism.state(mechanism.home()).unwrap().pose(mechanism.reference()).unwrap();
    for place in [Vec3::new(0.5, 2.2, 0.0), Vec3::new(0.3, 2.6, 0.0)] {
        target.translation = place;
        for plant in BEHIND_LOOPS {
            let mut options = TaskServoOptions::new(&mechanism);
            (options.dt, options.plant) = (0.002, plant);
            let tasks = vec![object(&mechanism, target)];
            let mut servo = TaskServo::new(&mechanism, tasks, options).unwrap();
            let result = servo.simulate(mechanism.home(), 10.0, |_, _, _| {});
            let result = result.unwrap_or_else(|error| panic!("{plant:?}: {error}"));
            assert_eq!(result.status, Status::Stalled, "{plant:?}, {place:?}");
            // Beside it passive joints are fast under noise, up to their limits.
            if plant.noise == 0.0 {
                let stopped_by = result.reports[0].stopped_by;
                assert_eq!(stopped_by, Some(StoppedBy::TypeII), "{plant:?}, {place:?}");
            }
        }
    }
}

/// Two arms hold an object: its position first, then an elbow, with what the object leaves free.
#[test]
fn lower_levels_do_not_move_the_object() {
    let mechanism = catalogue::load("two-arm").unwrap();
    let q = mechanism.home().to_vec();
    let q = assemble(&mechanism, &q, &[]).unwrap().q;
    let state = mechanism.state(&q).unwrap();
    let end_effector = ServoOptions::new(&mechanism).end_effector;
    let target = state.pose(end_effector).unwrap();
    let position = |target| {
        MotionTask::new(
            "object",
            TaskObjective::Frame { end_effector, components: Task::POSITION, target },
        )
    };
    let link = mechanism.links()[mechanism.coordinates()[2].joint + 1].name.clone();
    let elbow = mechanism.frame(&link).unwrap();
    let shifted = state.pose(elbow).unwrap().translation + Vec3::new(0.03, 0.05, 0.02);
    let elbow = MotionTask::new(
        "elbow",
        TaskObjective::Frame {
            end_effector: elbow.into(),
            components: Task::POSITION,
            target: Pose { translation: shifted, ..state.pose(elbow).unwrap() }.into(),
        },
    );
    let tasks = vec![position(target.into()), elbow.at_level(1)];
    let mut servo = TaskServo::new(&mechanism, tasks, TaskServoOptions::new(&mechanism)).unwrap();
    let result = servo.simulate(&q, 10.0, |_, q, _| {
        let pose = mechanism.state(q).unwrap().pose(end_effector).unwrap();
        // A curve in steps of a millisecond.
        assert!((pose.translation - target.translation).norm() < 1e-4);
    });
    let result = result.unwrap();
    assert!(result.reports[0].position_error < 1e-6);
    assert!(result.reports[1].position_error < 0.06, "{:?}", result.reports);
}

/// A five-bar whose coupler is sent where its distal links would be aligned stops before.
#[test]
fn it_stops_before_type_ii_singularities() {
    let mechanism = catalogue::load("five-bar").unwrap();
    let q = assemble(&mechanism, mechanism.home(), &[]).unwrap().q;
    let end_effector = ServoOptions::new(&mechanism).end_effector;
    let pose = mechanism.state(&q).unwrap().pose(end_effector).unwrap();
    let (mut stopped, mut single) = (false, false);
    for direction in [Vec3::Y, Vec3::ZERO - Vec3::Y] {
        let target = Pose { translation: pose.translation + direction * 3.0, ..pose };
        let tasks = vec![object(&mechanism, target)];
        let options = TaskServoOptions::new(&mechanism);
        let mut servo = TaskServo::new(&mechanism, tasks, options).unwrap();
        let result = servo.simulate(&q, 20.0, |_, _, _| ()).unwrap();
        stopped |= result.reports[0].stopped_by == Some(StoppedBy::TypeII);
        assert!(gap(&mechanism, &result.q) < 1e-9);
        let mut one = Servo::new(&mechanism, ServoOptions::new(&mechanism)).unwrap();
        let end =
            cylindroid::control::simulate(&mut one, &q, 20.0, |_| (target.into(), true), |_| ());
        single |= matches!(end.unwrap().stall, Some(cylindroid::control::Stall::TypeII { .. }));
    }
    assert_eq!(stopped, single);
    assert!(stopped);
}
