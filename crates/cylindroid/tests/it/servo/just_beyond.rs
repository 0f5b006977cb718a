//! Targets just beyond reach, and those that leave it: nearer than the length of the stretched arm, so that
//! no length proves them out of reach.

use cylindroid::control::{MotionTask, TaskObjective, TaskServo, TaskServoOptions};

use super::closed_edges::{Push, ToTheEdge, pushed, weakened};
use super::*;

const DIRECTIONS: [Vec3; 5] =
    [Vec3::X, Vec3::Y, Vec3::Z, Vec3::new(0.0, 0.0, -1.0), Vec3::new(0.48, -0.36, 0.8)];

/// With this acceleration limit of all joints; infinity for those of the catalogue.
fn arm(name: &str, acceleration: f64) -> Mechanism {
    match acceleration {
        f64::INFINITY => catalogue::load(name).unwrap(),
        _ => weakened(name, acceleration),
    }
}

/// From home, with steps of 10 ms; a moving target has a tenth of reach per second.
fn move_to(robot: &Mechanism, task: Task, push: Push, direction: Vec3, seconds: f64) -> ToTheEdge {
    let mut servo = servo(robot, |o| (o.dt, o.task) = (1e-2, task));
    pushed((&mut servo, robot.home()), push, direction, seconds)
}

/// The nearest place to one far away, and targets beyond it by shares of the reach.
fn targets_beyond(name: &str, task: Task, direction: Vec3) -> impl Iterator<Item = (f64, Vec3)> {
    let robot = arm(name, f64::INFINITY);
    let home = robot.state(robot.home()).unwrap().pose(robot.tool()).unwrap().translation;
    let far = home + direction * (2.0 * robot.reach());
    let edge = move_to(&robot, task, Push::Target, direction, 60.0).place;
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
                    let motion = move_to(&robot, task, Push::TargetAt(target), direction, 30.0);
                    let case = format!("{name} {direction:?} {beyond} {acceleration}: {motion:?}");
                    println!("{case}");
                    assert!(motion.stall.is_some() && motion.time < 16.0, "{case}");
                    assert!(motion.back < back, "{case}");
                }
            }
        }
    }
}

/// Near the edge a target just beyond it is near enough to be tracked. The servo took it for one in reach
/// and out of it by turns, and joints with self-motions chattered with up to 0.4 rad/s for ever.
#[test]
fn joints_rest_before_targets_just_beyond_reach() {
    for name in ["iiwa14", "panda"] {
        let down = Vec3::new(0.0, 0.0, -1.0);
        let (_, target) = targets_beyond(name, Task::POSITION, down).next().unwrap();
        for acceleration in [1.0, 5.0, 10.0, f64::INFINITY] {
            let robot = arm(name, acceleration);
            let push = Push::TargetAt(target);
            let motion = move_to(&robot, Task::POSITION, push, down, 30.0);
            let case = format!("{name} {acceleration}: {motion:?}");
            println!("{case}");
            assert!(motion.stall.is_some() && motion.speed < 1e-2, "{case}");
        }
    }
}

/// With short steps the velocities of weak joints that had just begun to move led away from the way in
/// every second step, and the joints crept with 0.01 rad/s: 0.6 m were left after 40 s.
#[test]
fn weak_joints_begin_their_way_with_short_steps() {
    let (_, target) = targets_beyond("panda", Task::POSITION, Vec3::Z).nth(1).unwrap();
    for (acceleration, dt) in [(0.5, 2e-3), (1.0, 2e-3), (0.5, 1e-3)] {
        let robot = arm("panda", acceleration);
        let mut servo = servo(&robot, |o| (o.dt, o.task) = (dt, Task::POSITION));
        let start = (&mut servo, robot.home());
        let motion = pushed(start, Push::TargetAt(target), Vec3::Z, 30.0);
        let case = format!("{acceleration} {dt}: {motion:?}");
        println!("{case}");
        assert!(motion.stall.is_some() && motion.time < 12.0, "{case}");
        assert!(motion.back < 1e-3, "{case}");
    }
}

/// Joints that braked for the nearest pose made little progress towards the target, and near a stretched
/// configuration they escaped to fold the arm: the tool moved back by up to 0.04 of its reach, after targets
/// that move away by 0.09.
#[test]
fn joints_that_brake_for_the_nearest_pose_do_not_escape() {
    for (direction, place, acceleration) in [
        (Vec3::Y, 0, 5.0),
        (Vec3::Y, 1, 1.0),
        (Vec3::Y, 1, 0.5),
        (Vec3::Z, 2, 10.0),
        (DIRECTIONS[4], 0, 0.5),
    ] {
        let (_, target) = targets_beyond("panda", Task::POSITION, direction).nth(place).unwrap();
        let robot = arm("panda", acceleration);
        let motion = move_to(&robot, Task::POSITION, Push::TargetAt(target), direction, 30.0);
        let case = format!("{direction:?} {place} {acceleration}: {motion:?}");
        println!("{case}");
        assert!(motion.stall.is_some() && motion.back < 1e-3 && motion.rise < 1e-3, "{case}");
    }
    for (task, direction, acceleration) in [
        (Task::POSITION, Vec3::Y, 5.0),
        (Task::POSITION, DIRECTIONS[4], 5.0),
        (Task::POSE, Vec3::Y, 1.0),
        (Task::POSE, Vec3::Y, 0.5),
    ] {
        let robot = arm("panda", acceleration);
        let motion = move_to(&robot, task, Push::MovingTarget, direction, 40.0);
        let case = format!("{direction:?} {acceleration}: {motion:?}");
        println!("{case}");
        assert!(motion.stall.is_some() && motion.back < 1e-3, "{case}");
    }
}

/// Targets that leave reach with a tenth of it per second: arms moved back by up to 0.06 of theirs.
#[test]
fn targets_that_leave_reach_are_not_swung_after() {
    for (name, task) in [("ur5e", Task::POSITION), ("ur5e", Task::POSE), ("puma560", Task::POSE)] {
        for acceleration in [0.5, 5.0, f64::INFINITY] {
            let robot = arm(name, acceleration);
            for direction in DIRECTIONS {
                let motion = move_to(&robot, task, Push::MovingTarget, direction, 40.0);
                let case = format!("{name} {direction:?} {acceleration}: {motion:?}");
                println!("{case}");
                assert!(motion.back < 0.02, "{case}");
            }
        }
    }
}

const ARMS: [&str; 4] = ["ur5e", "puma560", "iiwa14", "panda"];
const TASKS: [(&str, Task); 2] = [("position", Task::POSITION), ("pose", Task::POSE)];

/// Counts motions that move back by more than a thousandth of reach, those of which the whole scaled error
/// rises by so much, and those without a verdict in time, with the most that one moves back and rises, and
/// the longest one.
#[derive(Debug, Default)]
struct Counts {
    motions: usize,
    swinging: usize,
    rising: usize,
    late: usize,
    back: f64,
    rise: f64,
    time: f64,
}

impl Counts {
    /// Of the arm at several accelerations, in every direction, by these servos; 12 s for fixed targets and
    /// 40 s for targets that move away.
    fn of(name: &str, task: Task, moves: bool, servo: impl Fn(&Mechanism) -> Servo) -> Self {
        Self::of_motions(name, task, moves, |robot, push, direction| {
            let motion = pushed((&mut servo(robot), robot.home()), push, direction, 40.0);
            [motion.time, motion.back, motion.rise]
        })
    }

    /// The same of motions of any servo: their times (s), the ways back, the rises of the error.
    fn of_motions(
        name: &str,
        task: Task,
        moves: bool,
        motion: impl Fn(&Mechanism, Push, Vec3) -> [f64; 3],
    ) -> Self {
        let mut counts = Self::default();
        for direction in DIRECTIONS {
            let all: Vec<Push> = if moves {
                vec![Push::MovingTarget]
            } else {
                targets_beyond(name, task, direction).map(|(_, t)| Push::TargetAt(t)).collect()
            };
            for acceleration in [f64::INFINITY, 10.0, 5.0, 1.0, 0.5] {
                let robot = arm(name, acceleration);
                for push in &all {
                    let [time, back, rise] = motion(&robot, *push, direction);
                    counts.motions += 1;
                    counts.swinging += usize::from(back > 1e-3);
                    counts.rising += usize::from(rise > 1e-3);
                    counts.late += usize::from(time > if moves { 40.0 } else { 12.0 });
                    counts.back = counts.back.max(back);
                    counts.rise = counts.rise.max(rise);
                    counts.time = counts.time.max(time);
                }
            }
        }
        counts
    }

    fn print(&self, what: &str) {
        let Self { motions, swinging, rising, late, back, rise, time } = self;
        println!(
            "{what}: {motions} motions, {swinging} back by more than 1e-3 of reach (by {back:.4} at most), of {rising} \
             the error rises by more than 1e-3 (by {rise:.4} at most), {late} late, the last after {time:.1} s"
        );
    }
}

/// All arms, tasks, accelerations and steps.
#[test]
#[ignore = "a table of minutes in a release build"]
fn table_of_arms_at_the_edge() {
    for dt in [1e-2, 2e-3, 5e-4] {
        for (name, (kind, task)) in ARMS.iter().flat_map(|name| TASKS.map(|task| (name, task))) {
            for (what, moves) in [("just beyond", false), ("moving away", true)] {
                let of = |robot: &Mechanism| servo(robot, |o| (o.dt, o.task) = (dt, task));
                let counts = Counts::of(name, task, moves, of);
                counts.print(&format!("{name:8} {kind:8} {what}, {dt} s"));
            }
        }
    }
}

/// All inverses and arms, with steps of 10 ms.
#[test]
#[ignore = "a table of minutes in a release build"]
fn table_of_inverses_at_the_edge() {
    for (method, name) in Method::ALL.into_iter().flat_map(|m| ARMS.map(|name| (m, name))) {
        for (what, moves) in [("just beyond", false), ("moving away", true)] {
            let of = |robot: &Mechanism| servo(robot, |o| (o.dt, o.method) = (1e-2, method));
            let counts = Counts::of(name, Task::POSE, moves, of);
            counts.print(&format!("{:22} {name:8} {what}", method.name()));
        }
    }
}

/// A servo of many tasks whose only one is the pose of the tool, towards a place from home: time until its
/// verdict for good (s), the way back over the reach, and the rise of the scaled error.
fn by_tasks(robot: &Mechanism, task: Task, push: Push, direction: Vec3, keep: bool) -> [f64; 3] {
    let (dt, tool) = (1e-2, robot.tool());
    let home = robot.state(robot.home()).unwrap().pose(tool).unwrap();
    let reach = robot.reach();
    let objective = |place| TaskObjective::Frame {
        end_effector: tool.into(),
        components: task,
        target: Pose { translation: place, ..home }.into(),
    };
    let tasks = vec![MotionTask::new("hand", objective(home.translation))];
    let options = TaskServoOptions { dt, keep_directions: keep, ..TaskServoOptions::new(robot) };
    let length = options.length;
    let mut servo = TaskServo::new(robot, tasks, options).unwrap();
    let mut q = robot.home().to_vec();
    let (mut verdict, mut back, mut rise) = (f64::INFINITY, 0.0, 0.0);
    let (mut farthest, mut least) = (f64::NEG_INFINITY, f64::INFINITY);
    for i in 0..(40.0 / dt) as usize {
        let time = i as f64 * dt;
        let place = match push {
            Push::TargetAt(place) => place,
            _ => home.translation + direction * (0.1 * reach * time),
        };
        *servo.objective_mut("hand").unwrap() = objective(place);
        let status = servo.step(&q).unwrap();
        let at = robot.state(&q).unwrap().pose(tool).unwrap().translation;
        let report = &servo.reports()[0];
        let (error, angle) = (report.position_error, report.orientation_error);
        let way = match push {
            Push::TargetAt(_) => -error / reach,
            _ => (at - home.translation).dot(direction) / reach,
        };
        (farthest, back) = (farthest.max(way), f64::max(back, farthest - way));
        if matches!(push, Push::TargetAt(_)) {
            let scaled = (error / length).hypot(angle);
            (least, rise) = (least.min(scaled), f64::max(rise, scaled - least));
        }
        servo.advance(&mut q);
        match status {
            Status::Moving => verdict = f64::INFINITY,
            _ if verdict.is_infinite() => verdict = time,
            _ if time > verdict + 1.0 => break,
            _ => {}
        }
    }
    [verdict, back, rise]
}

/// Servos of many tasks come to rest there too. Those of weak joints swung by up to 1.5 of reach, and half
/// of all such motions rose by more than a thousandth.
#[test]
fn many_tasks_rest_just_beyond_reach() {
    for (name, task) in [("ur5e", Task::POSITION), ("puma560", Task::POSE), ("panda", Task::POSE)] {
        for (acceleration, keep) in [(0.5, true), (1.0, false), (10.0, true)] {
            let robot = arm(name, acceleration);
            for direction in [Vec3::Y, Vec3::new(0.0, 0.0, -1.0), DIRECTIONS[4]] {
                for (beyond, target) in targets_beyond(name, task, direction).take(3) {
                    let push = Push::TargetAt(target);
                    let [time, back, rise] = by_tasks(&robot, task, push, direction, keep);
                    let of = format!("{name} {direction:?} {beyond} {acceleration}");
                    let case = format!("{of}: {time:.1} s, back {back:.1e}, rise {rise:.1e}");
                    println!("{case}");
                    assert!(time < 20.0 && rise < 2e-3, "{case}");
                }
            }
        }
    }
}

/// Servos of many tasks, with steps of 10 ms.
#[test]
#[ignore = "a table of minutes in a release build"]
fn table_of_tasks_at_the_edge() {
    for keep in [true, false] {
        for (name, (kind, task)) in ARMS.iter().flat_map(|name| TASKS.map(|task| (name, task))) {
            for (what, moves) in [("just beyond", false), ("moving away", true)] {
                let counts = Counts::of_motions(name, task, moves, |robot, push, direction| {
                    by_tasks(robot, task, push, direction, keep)
                });
                let kept = if keep { "directions kept" } else { "least squares" };
                counts.print(&format!("{name:8} {kind:8} {what}, {kept}"));
            }
        }
    }
}
