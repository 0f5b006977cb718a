//! Closed chains and arms pushed beyond their workspace: with any acceleration limits they come to rest
//! there once, and say why.

use cylindroid::closure::assemble;
use cylindroid::control::TwistStatus;
use cylindroid::model::{Dimension, JointLimits};

use super::*;

/// What pushes outwards.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Push {
    /// A target twice the length of the mechanism away.
    Target,
    /// A target at this place.
    TargetAt(Vec3),
    /// A target that moves away with a tenth of that length per second.
    MovingTarget,
    /// A twist of this speed.
    Twist,
    /// The same fed forward beside the present pose.
    FedForward,
}

impl Push {
    const ALL: [Self; 4] = [Self::Target, Self::MovingTarget, Self::Twist, Self::FedForward];
}

/// A motion to the edge of the workspace; lengths are over that of the mechanism.
#[derive(Debug)]
pub(super) struct ToTheEdge {
    /// Time until the stall is named, or the target reached, for good (s).
    pub(super) time: f64,
    /// Motion of the position backwards, over the reach.
    pub(super) back: f64,
    /// By how much the scaled error rises in all, towards targets at rest: that of a pose may fall while the
    /// position gives way to the orientation.
    pub(super) rise: f64,
    /// Reversals of more than 1e-4.
    turns: usize,
    pub(super) stall: Option<Stall>,
    /// Where it began, and where it is at this time.
    ends: [Vec<f64>; 2],
    /// Where the end effector is at last.
    pub(super) place: Vec3,
    /// The largest speed of a joint at last [rad/s or m/s].
    pub(super) speed: f64,
}

impl ToTheEdge {
    /// The least time in which drives with these limits come from rest at one end to rest at the other,
    /// each for itself (s).
    fn least_time(&self, robot: &Mechanism, acceleration: f64) -> f64 {
        let drives = robot.coordinates().iter().enumerate().filter(|(_, c)| c.actuated);
        drives.fold(0.0, |most: f64, (i, c)| {
            let way = (self.ends[1][i] - self.ends[0][i]).abs();
            let to_speed = c.limits.velocity / acceleration;
            let time = match way < c.limits.velocity * to_speed {
                true => 2.0 * (way / acceleration).sqrt(),
                false => way / c.limits.velocity + to_speed,
            };
            most.max(time)
        })
    }
}

/// A model of the catalogue whose actuated joints have this acceleration limit.
pub(super) fn weakened(name: &str, acceleration: f64) -> Mechanism {
    let robot = catalogue::load(name).unwrap();
    let weak = JointLimits { acceleration: Some(acceleration), ..JointLimits::default() };
    let is_actuated = |i: usize| robot.coordinates().iter().any(|c| c.joint == i && c.actuated);
    let joints = robot.joints().iter().enumerate();
    let joints = joints.filter(|(i, joint)| is_actuated(*i) && joint.mimic.is_none());
    let limits: Vec<_> = joints.map(|(_, joint)| (joint.name.clone(), weak)).collect();
    robot.with_limits(&limits).unwrap()
}

/// From an assembled configuration near `start`, positions alone, `seconds` at most.
fn to_the_edge(
    (robot, start): (&Mechanism, &[f64]),
    push: Push,
    direction: Vec3,
    dt: f64,
    seconds: f64,
) -> ToTheEdge {
    let planar = servo(robot, |_| ()).options().task == Task::PLANAR;
    let components = [true, true, !planar, false, false, false];
    let task = Task { components, ..Task::POSE };
    pushed((&mut servo(robot, |o| (o.dt, o.task) = (dt, task)), start), push, direction, seconds)
}

/// The same by any servo, until a verdict has held for a second.
pub(super) fn pushed(
    (servo, start): (&mut Servo, &[f64]),
    push: Push,
    direction: Vec3,
    seconds: f64,
) -> ToTheEdge {
    let robot = &servo.mechanism().clone();
    let ServoOptions { dt, end_effector, length, .. } = *servo.options();
    let mut q =
        if robot.is_closed() { assemble(robot, start, &[]).unwrap().q } else { start.into() };
    let home = robot.state(&q).unwrap().pose(end_effector).unwrap();
    let (reach, speed) = (robot.reach(), direction * (0.1 * robot.reach()));
    let ends = [q.clone(), q.clone()];
    let (time, place) = (f64::INFINITY, home.translation);
    let mut motion =
        ToTheEdge { time, back: 0.0, rise: 0.0, turns: 0, stall: None, ends, place, speed: 0.0 };
    let (mut last, mut extreme, mut forwards) = (f64::NEG_INFINITY, f64::NEG_INFINITY, 1.0);
    let mut last_error = f64::INFINITY;
    for i in 0..(seconds / dt) as usize {
        let time = i as f64 * dt;
        let twist = Twist { linear: speed, angular: Vec3::ZERO };
        let at = |place: Vec3| Pose { translation: place, ..home };
        let (pose, [error, angle], status) = if push == Push::Twist {
            let step = servo.step_twist(&q, Some(twist)).unwrap();
            let is_stalled = step.status == TwistStatus::Stalled;
            (step.step.pose, [0.0; 2], if is_stalled { Status::Stalled } else { Status::Moving })
        } else {
            let target = match push {
                Push::Target => at(home.translation + direction * (2.0 * reach)).into(),
                Push::TargetAt(place) => at(place).into(),
                Push::MovingTarget => at(home.translation + speed * time).into(),
                Push::Twist | Push::FedForward => {
                    let pose = robot.state(&q).unwrap().pose(end_effector).unwrap();
                    Target { pose, feed_forward: twist }
                }
            };
            let step = servo.step(&q, target).unwrap();
            (step.pose, [step.position_error, step.orientation_error], step.status)
        };
        servo.advance(&mut q);
        let is_fixed = matches!(push, Push::Target | Push::TargetAt(_));
        let way = match is_fixed {
            true => -error / reach,
            false => (pose.translation - home.translation).dot(direction) / reach,
        };
        motion.back += if last.is_finite() { (last - way).max(0.0) } else { 0.0 };
        if is_fixed {
            let scaled = (error / length).hypot(angle);
            motion.rise += (scaled - last_error).max(0.0);
            last_error = scaled;
        }
        motion.place = pose.translation;
        let speeds = servo.joint_velocities().iter().map(|rate| rate.abs());
        motion.speed = speeds.fold(0.0, f64::max);
        last = way;
        if i == 0 || forwards * (way - extreme) > 0.0 {
            extreme = way;
        } else if forwards * (extreme - way) > 1e-4 {
            (extreme, forwards) = (way, -forwards);
            motion.turns += 1;
        }
        let is_verdict = match is_fixed {
            true => status != Status::Moving,
            false => status == Status::Stalled,
        };
        if !is_verdict {
            (motion.time, motion.stall) = (f64::INFINITY, None);
        } else if motion.time.is_infinite() {
            motion.time = time;
            motion.stall = (status == Status::Stalled).then(|| servo.stall());
            motion.ends[1].clone_from(&q);
        } else if time > motion.time + 1.0 {
            break;
        }
    }
    motion
}

fn directions(robot: &Mechanism) -> [Vec3; 5] {
    let [x, y, z] = [Vec3::X, Vec3::Y, Vec3::Z];
    match robot.dimension() {
        Dimension::Planar => [x, -x, y, -y, Vec3::new(0.6, 0.8, 0.0)],
        Dimension::Spatial => [x, y, z, -z, Vec3::new(0.48, -0.36, 0.8)],
    }
}

const CLOSED: [&str; 6] = ["five-bar", "3rrr", "stewart", "delta", "3rps", "two-arm"];

/// For the weakest and the strongest drives, with less than a millimetre backwards for each metre of
/// the mechanism.
#[test]
fn closed_chains_come_to_rest_at_the_edge_of_their_workspace() {
    for (name, place, push) in [
        ("five-bar", 0, Push::Target),
        ("five-bar", 0, Push::Twist),
        ("3rrr", 3, Push::Target),
        ("3rrr", 3, Push::Twist),
        ("3rrr", 3, Push::FedForward),
        ("delta", 2, Push::Target),
        ("delta", 2, Push::Twist),
        ("delta", 2, Push::MovingTarget),
        ("stewart", 4, Push::Target),
        ("two-arm", 0, Push::Twist),
    ] {
        for acceleration in [0.5, 5.0, 40.0, f64::INFINITY] {
            let robot = weakened(name, acceleration);
            let direction = directions(&robot)[place];
            let motion = to_the_edge((&robot, robot.home()), push, direction, 1e-2, 30.0);
            let case = format!("{name} {direction:?} {push:?} at {acceleration}: {motion:?}");
            println!("{case}");
            assert!(motion.stall.is_some() && motion.time < 20.0, "{case}");
            assert!(motion.turns <= 4 && motion.back < 1e-3, "{case}");
        }
    }
}

/// Pushed along x with its link held upright a five-bar stops where its two drives have no such motion:
/// the reason is that there are two, not that it is slow.
#[test]
fn a_five_bar_pushed_along_x_has_too_few_joints() {
    for acceleration in [0.5, 5.0, f64::INFINITY] {
        let robot = weakened("five-bar", acceleration);
        for push in [Push::Twist, Push::FedForward] {
            let mut servo = servo(&robot, |o| o.dt = 1e-2);
            let motion = pushed((&mut servo, robot.home()), push, Vec3::X, 30.0);
            let case = format!("{push:?} at {acceleration}: {motion:?}");
            let Some(Stall::TooFewJoints { rank: 2, task: 3, direction }) = &motion.stall else {
                panic!("{case}")
            };
            assert!(motion.time < 20.0 && direction[0].abs() > 0.9, "{case}");
        }
    }
}

/// Their self-motions do not swing on the way, which held it up for 13 to 22 s.
#[test]
fn two_arms_take_the_way_to_the_nearest_pose_straight() {
    let robot = weakened("two-arm", 0.5);
    for direction in directions(&robot) {
        let motion = to_the_edge((&robot, robot.home()), Push::Target, direction, 1e-2, 30.0);
        println!("{direction:?}: {motion:?}");
        assert!(motion.stall.is_some() && motion.time < 12.0, "{direction:?}: {motion:?}");
        assert!(motion.turns == 0 && motion.back < 1e-3, "{direction:?}: {motion:?}");
    }
}

/// A position alone leaves self-motions: with them a panda took up to 32 s, and an iiwa14 more than 40.
#[test]
fn arms_take_the_way_to_the_nearest_position_straight() {
    for (name, seconds) in [("ur5e", 10.0), ("iiwa14", 15.0), ("panda", 8.0), ("puma560", 7.0)] {
        for acceleration in [0.5, 5.0, f64::INFINITY] {
            let robot = weakened(name, acceleration);
            for direction in directions(&robot) {
                let start = (&robot, robot.home());
                let motion = to_the_edge(start, Push::Target, direction, 1e-2, 30.0);
                let case = format!("{name} {direction:?} at {acceleration}: {motion:?}");
                println!("{case}");
                assert!(motion.stall.is_some() && motion.time < seconds, "{case}");
                assert!(motion.back < 1e-3 && motion.turns <= 4, "{case}");
            }
        }
    }
}

/// Twists along the line from the base through the tool, at weak joints and strong ones.
#[test]
fn arms_pushed_outwards_by_a_twist_come_to_rest() {
    for name in ["panda", "ur5e", "iiwa14", "puma560", "youbot", "3r"] {
        for acceleration in [0.5, 2.0, 10.0] {
            let robot = weakened(name, acceleration);
            let start: Vec<f64> =
                robot.home().iter().zip(0..).map(|(x, i)| x + 0.1 + 0.02 * f64::from(i)).collect();
            let pose = robot.state(&start).unwrap().pose(robot.tool()).unwrap();
            let direction = pose.translation.unit(1e-9).unwrap();
            for push in [Push::Twist, Push::FedForward] {
                let motion = to_the_edge((&robot, &start), push, direction, 1e-2, 30.0);
                let case = format!("{name} {push:?} at {acceleration} rad/s^2: {motion:?}");
                println!("{case}");
                assert!(motion.stall.is_some(), "{case}");
                assert!(motion.turns <= 4 && motion.back < 1e-3, "{case}");
            }
        }
    }
}

/// All closed chains, pushes, directions and accelerations: a line for each motion that moves back, names
/// no stall, or takes more than 1.5 times as long as without acceleration limits; and how many of these
/// take also more than 1.5 times as long as drives need at least, with what the motion without acceleration
/// limits takes beyond that (to settle, and to be sure of the stall).
#[test]
#[ignore = "a table of minutes"]
fn table_of_closed_chains_at_the_edge() {
    let pushes = CLOSED.iter().flat_map(|n| Push::ALL.map(|p| (n, p)));
    for (dt, (name, push)) in
        [1e-2, 2e-3, 5e-4].iter().flat_map(|dt| pushes.clone().map(move |p| (dt, p)))
    {
        let (mut motions, mut counts) = (0, [0; 4]);
        for direction in directions(&catalogue::load(name).unwrap()) {
            let (mut free, mut beyond) = (f64::INFINITY, 0.0);
            for acceleration in [f64::INFINITY, 40.0, 10.0, 5.0, 1.0, 0.5] {
                let robot = weakened(name, acceleration);
                let motion = to_the_edge((&robot, robot.home()), push, direction, *dt, 40.0);
                if acceleration == f64::INFINITY {
                    free = motion.time;
                    beyond = free - motion.least_time(&robot, acceleration);
                }
                let least = motion.least_time(&robot, acceleration) + beyond;
                let slow = motion.time > 1.5 * free;
                let needless = motion.time > 1.5 * free.max(least);
                let faults = [motion.back > 1e-3, motion.stall.is_none(), slow, needless];
                motions += 1;
                counts
                    .iter_mut()
                    .zip(faults)
                    .for_each(|(count, fault)| *count += usize::from(fault));
                if faults.contains(&true) {
                    let stall = motion.stall.as_ref().map_or("none", Stall::name);
                    println!(
                        "{name} {push:?} {direction:?}, {acceleration} rad/s^2, {dt} s: {:.2} s ({free:.2} s, \
                         at least {least:.2} s), {:.5} back, {} turns, {stall}",
                        motion.time, motion.back, motion.turns
                    );
                }
            }
        }
        let [back, silent, slow, needless] = counts;
        println!(
            "{name} {push:?}, {dt} s: of {motions} motions {back} move back by more than 1e-3, {silent} name \
             no stall, {slow} take longer, {needless} of them also than drives need"
        );
    }
}
