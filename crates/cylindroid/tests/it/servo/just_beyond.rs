//! Targets just beyond reach, and those that leave it: nearer than the length of the stretched arm, so that
//! no length proves them out of reach.

use super::closed_edges::weakened;
use super::*;

/// A motion; lengths are over the reach of the arm.
#[derive(Debug)]
struct ToTheEdge {
    /// Time until the verdict is given for good (s).
    time: f64,
    /// Motion backwards.
    back: f64,
    end: Vec3,
    status: Status,
}

/// Targets of a motion.
#[derive(Debug, Clone, Copy)]
enum Targets {
    At(Vec3),
    /// From home with this velocity.
    Moving(Vec3),
}

const DIRECTIONS: [Vec3; 5] =
    [Vec3::X, Vec3::Y, Vec3::Z, Vec3::new(0.0, 0.0, -1.0), Vec3::new(0.48, -0.36, 0.8)];

/// With this acceleration limit of all joints; infinity for those of the catalogue.
fn arm(name: &str, acceleration: f64) -> Mechanism {
    match acceleration {
        f64::INFINITY => catalogue::load(name).unwrap(),
        _ => weakened(name, acceleration),
    }
}

/// From home, until a verdict has held for a second, `seconds` at most.
fn move_to(robot: &Mechanism, task: Task, targets: Targets, seconds: f64) -> ToTheEdge {
    let mut servo = servo(robot, |o| (o.dt, o.task) = (1e-2, task));
    let mut q = robot.home().to_vec();
    let home = robot.state(&q).unwrap().pose(robot.tool()).unwrap();
    let (dt, reach) = (servo.options().dt, robot.reach());
    let mut motion =
        ToTheEdge { time: f64::INFINITY, back: 0.0, end: Vec3::ZERO, status: Status::Moving };
    let mut last = f64::NEG_INFINITY;
    for i in 0..(seconds / dt) as usize {
        let time = i as f64 * dt;
        let place = match targets {
            Targets::At(place) => place,
            Targets::Moving(velocity) => home.translation + velocity * time,
        };
        let step = servo.step(&q, Pose { translation: place, ..home }).unwrap();
        servo.advance(&mut q);
        let way = match targets {
            Targets::At(_) => -step.position_error,
            Targets::Moving(v) => (step.pose.translation - home.translation).dot(v) / v.norm(),
        };
        motion.back += f64::max(0.0, last - way) / reach;
        (last, motion.end, motion.status) = (way, step.pose.translation, step.status);
        let is_verdict = match targets {
            Targets::At(_) => step.status != Status::Moving,
            Targets::Moving(_) => step.status == Status::Stalled,
        };
        motion.time = if is_verdict { motion.time.min(time) } else { f64::INFINITY };
        if time > motion.time + 1.0 {
            break;
        }
    }
    motion
}

/// The nearest place to one far away, and targets beyond it by shares of the reach.
fn targets_beyond(name: &str, task: Task, direction: Vec3) -> impl Iterator<Item = (f64, Vec3)> {
    let robot = arm(name, f64::INFINITY);
    let home = robot.state(robot.home()).unwrap().pose(robot.tool()).unwrap().translation;
    let far = home + direction * (2.0 * robot.reach());
    let edge = move_to(&robot, task, Targets::At(far), 60.0).end;
    let (outwards, reach) = ((far - edge).unit(1e-9).unwrap(), robot.reach());
    [0.002, 0.01, 0.03, 0.1].map(|beyond| (beyond, edge + outwards * (beyond * reach))).into_iter()
}

/// A ur5e moved back by up to 1.9 of its reach, and took up to 39 s; a youbot by 0.7, an iiwa14 by 1.0. The
/// bounds leave room for roundings of other processors, on which the ways of weak joints depend.
#[test]
fn targets_just_beyond_reach_are_approached_once() {
    let cases = [("ur5e", Task::POSITION, 1e-3), ("ur5e", Task::POSE, 0.05)];
    let more = [("puma560", Task::POSITION, 5e-3), ("iiwa14", Task::POSE, 0.15)];
    // Five joints: no target of a pose is met.
    let fewer = [("youbot", Task::POSE, 5e-3)];
    for (name, task, back) in cases.into_iter().chain(more).chain(fewer) {
        for acceleration in [0.5, 5.0, f64::INFINITY] {
            let robot = arm(name, acceleration);
            for direction in DIRECTIONS {
                for (beyond, target) in targets_beyond(name, task, direction) {
                    let motion = move_to(&robot, task, Targets::At(target), 30.0);
                    let case = format!("{name} {direction:?} {beyond} {acceleration}: {motion:?}");
                    println!("{case}");
                    assert!(motion.status == Status::Stalled && motion.time < 16.0, "{case}");
                    assert!(motion.back < back, "{case}");
                }
            }
        }
    }
}

/// Targets that leave reach with a tenth of it per second: arms moved back by up to 0.06 of theirs.
#[test]
fn targets_that_leave_reach_are_not_swung_after() {
    for (name, task) in [("ur5e", Task::POSITION), ("ur5e", Task::POSE), ("puma560", Task::POSE)] {
        for acceleration in [0.5, 5.0, f64::INFINITY] {
            let robot = arm(name, acceleration);
            for direction in DIRECTIONS {
                let targets = Targets::Moving(direction * (0.1 * robot.reach()));
                let motion = move_to(&robot, task, targets, 40.0);
                let case = format!("{name} {direction:?} {acceleration}: {motion:?}");
                println!("{case}");
                assert!(motion.back < 0.02, "{case}");
            }
        }
    }
}

/// All arms, tasks and accelerations: how many motions move back by more than a thousandth of reach or
/// take more than 12 s, the most that one moves back, and the longest one.
#[test]
#[ignore = "a table of half a minute in a release build"]
fn table_of_arms_at_the_edge() {
    for name in ["ur5e", "puma560", "iiwa14", "panda"] {
        for (kind, task) in [("position", Task::POSITION), ("pose", Task::POSE)] {
            for moves in [false, true] {
                let (mut motions, mut swinging, mut slow) = (0, 0, 0);
                let (mut back, mut time) = (0.0_f64, 0.0_f64);
                for direction in DIRECTIONS {
                    let speed = direction * (0.1 * arm(name, f64::INFINITY).reach());
                    let all: Vec<Targets> = if moves {
                        vec![Targets::Moving(speed)]
                    } else {
                        targets_beyond(name, task, direction).map(|(_, t)| Targets::At(t)).collect()
                    };
                    for acceleration in [f64::INFINITY, 10.0, 5.0, 1.0, 0.5] {
                        let robot = arm(name, acceleration);
                        for targets in &all {
                            let motion = move_to(&robot, task, *targets, 40.0);
                            motions += 1;
                            swinging += u32::from(motion.back > 1e-3);
                            slow += u32::from(motion.time > if moves { 40.0 } else { 12.0 });
                            back = back.max(motion.back);
                            time = time.max(motion.time);
                        }
                    }
                }
                let what = if moves { "moving away" } else { "just beyond" };
                println!(
                    "{name:8} {kind:8} {what}: {motions} motions, {swinging} back by more than 1e-3 of \
                     reach (by {back:.4} at most), {slow} late, the last after {time:.1} s"
                );
            }
        }
    }
}
