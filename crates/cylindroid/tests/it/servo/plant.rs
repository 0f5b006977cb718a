//! Robots that lag, behind a servo that knows it: drives are simulated in small steps here.

use std::collections::VecDeque;

use cylindroid::catalogue;
use cylindroid::control::{
    MotionTask, Plant, Stall, Status, Task, TaskObjective, TaskServo, TaskServoOptions,
    TwistStatus, simulate,
};
use cylindroid::kinematics::EndEffector;
use cylindroid::model::{Inclusion, Mechanism};
use cylindroid::{Pose, Servo, ServoOptions, Twist, Vec3};

use crate::support::Random;

/// Steps of the simulation in a step of the servo.
const SUBSTEPS: usize = 50;

/// A robot behind drives of first order whose commands arrive late.
pub(super) struct Drives {
    pub(super) q: Vec<f64>,
    velocities: Vec<f64>,
    /// Commands and the time at which they arrive (s).
    commands: VecDeque<(f64, Vec<f64>)>,
    now: f64,
    plant: Plant,
    /// Largest distance beyond a position limit [rad or m].
    pub(super) beyond: f64,
    /// Largest velocity and acceleration beside its limit [-].
    fastest: f64,
}

impl Drives {
    pub(super) fn new(q: &[f64], plant: Plant) -> Self {
        let n = q.len();
        Self {
            q: q.to_vec(),
            velocities: vec![0.0; n],
            commands: VecDeque::from([(f64::NEG_INFINITY, vec![0.0; n])]),
            now: 0.0,
            plant,
            beyond: 0.0,
            fastest: 0.0,
        }
    }

    pub(super) fn measured(&self, random: &mut Random) -> Vec<f64> {
        let noise = self.plant.noise;
        self.q.iter().map(|x| x + random.within(-noise, noise)).collect()
    }

    /// Lets `dt` pass; within a substep the command is that of its middle.
    pub(super) fn pass(&mut self, mechanism: &Mechanism, command: &[f64], dt: f64) {
        self.commands.push_back((self.now + self.plant.delay, command.to_vec()));
        let h = dt / SUBSTEPS as f64;
        let kept = if self.plant.time_constant > 0.0 {
            (-h / self.plant.time_constant).exp()
        } else {
            0.0
        };
        for _ in 0..SUBSTEPS {
            let middle = self.now + 0.5 * h;
            while self.commands.len() > 1 && self.commands[1].0 <= middle {
                self.commands.pop_front();
            }
            let u = &self.commands[0].1;
            for (i, &u) in u.iter().enumerate() {
                let before = self.velocities[i];
                self.velocities[i] = u + kept * (before - u);
                // The exact integral of an exponential.
                self.q[i] += u * h + self.plant.time_constant * (before - self.velocities[i]);
                let l = mechanism.coordinates()[i].limits;
                self.beyond = self.beyond.max(self.q[i] - l.upper).max(l.lower - self.q[i]);
                self.fastest = self.fastest.max(self.velocities[i].abs() / l.velocity);
            }
            self.now += h;
        }
    }
}

pub(super) const PLANTS: [Plant; 4] = [
    Plant { delay: 0.001, time_constant: 0.010, noise: 0.0 },
    Plant { delay: 0.020, time_constant: 0.010, noise: 0.0 },
    Plant { delay: 0.0, time_constant: 0.060, noise: 0.0 },
    Plant { delay: 0.0332, time_constant: 0.0, noise: 0.0 },
];

pub(super) fn options(mechanism: &Mechanism, dt: f64) -> ServoOptions {
    let mut options = ServoOptions::new(mechanism);
    (options.dt, options.acceleration) = (dt, Some(10.0));
    options.tolerance.position = 1e-3;
    options.tolerance.orientation = 5e-3;
    options
}

pub(super) fn tool(mechanism: &Mechanism, q: &[f64]) -> Pose {
    mechanism.state(q).unwrap().pose(mechanism.tool()).unwrap()
}

/// Every joint within 2 % of its range of a limit.
pub(super) fn near_limits(mechanism: &Mechanism, random: &mut Random) -> Vec<f64> {
    mechanism
        .coordinates()
        .iter()
        .map(|c| {
            let (l, u) = (c.limits.lower.max(-3.0), c.limits.upper.min(3.0));
            let share = random.within(-0.02, 0.02);
            if random.within(0.0, 1.0) < 0.5 { l + share * (u - l) } else { u + share * (u - l) }
        })
        .collect()
}

/// Largest excess over position limits and share of velocity limits while the tool is sent to poses
/// of configurations at their limits.
fn worst(name: &str, dt: f64, real: Plant, known: Plant) -> (f64, f64) {
    let mechanism = catalogue::load(name).unwrap();
    let mut options = options(&mechanism, dt);
    options.plant = known;
    let mut random = Random(11);
    let (mut beyond, mut fastest) = (0.0_f64, 0.0_f64);
    for _ in 0..6 {
        let mut servo = Servo::new(&mechanism, options.clone()).unwrap();
        let mut drives = Drives::new(mechanism.home(), real);
        for _ in 0..3 {
            let target = tool(&mechanism, &near_limits(&mechanism, &mut random));
            for _ in 0..(0.7 / dt) as usize {
                let measured = drives.measured(&mut random);
                servo.step(&measured, target).unwrap();
                drives.pass(&mechanism, servo.joint_velocities(), dt);
            }
        }
        (beyond, fastest) = (beyond.max(drives.beyond), fastest.max(drives.fastest));
    }
    (beyond, fastest)
}

/// Joints keep their limits behind drives that the servo knows; behind ones that it takes for ideal
/// they leave them.
#[test]
fn limits_hold_behind_known_drives() {
    for name in ["panda", "iiwa14"] {
        let mut unknown = 0.0_f64;
        for plant in PLANTS {
            for dt in [0.002, 0.01] {
                let (beyond, fastest) = worst(name, dt, plant, plant);
                println!("{name} {dt} {plant:?}: {beyond:.2e} {fastest:.6}");
                assert!(beyond <= 1e-9, "{name}, {dt} s, {plant:?}: {beyond}");
                assert!(fastest <= 1.0 + 1e-9, "{name}, {dt} s, {plant:?}: {fastest}");
                let (b, _) = worst(name, dt, plant, Plant::IDEAL);
                println!("   unknown {b:.2e}");
                unknown = unknown.max(b);
            }
        }
        assert!(unknown > 3e-3, "{name}: {unknown}");
    }
}

/// Measurements off by up to the noise that the servo knows do not push a joint beyond its limits.
#[test]
fn noise_does_not_push_beyond_limits() {
    for noise in [1e-5, 1e-4, 1e-3] {
        let plant = Plant { noise, ..PLANTS[1] };
        let (beyond, _) = worst("panda", 0.002, plant, plant);
        let (unknown, _) = worst("panda", 0.002, plant, Plant { noise: 0.0, ..plant });
        println!("{noise}: {beyond:.2e}, unknown {unknown:.2e}");
        assert!(beyond <= 0.0, "{noise}: {beyond}");
    }
}

/// A pose is reached, and the robot is there when the servo says so.
#[test]
fn reached_is_said_of_the_robot() {
    for name in ["panda", "ur5e"] {
        let mechanism = catalogue::load(name).unwrap();
        for plant in PLANTS {
            let mut options = options(&mechanism, 0.002);
            options.plant = plant;
            let mut servo = Servo::new(&mechanism, options).unwrap();
            let mut drives = Drives::new(mechanism.home(), plant);
            let mut target = tool(&mechanism, mechanism.home());
            target.translation += Vec3::new(-0.1, 0.15, 0.05);
            let mut arrived = None;
            for step in 0..2000 {
                let pose = tool(&mechanism, &drives.q);
                let now = servo.step(&drives.q, target).unwrap();
                let far = (pose.translation - target.translation).norm();
                assert!((now.position_error - far).abs() < 1e-12, "{name}, {plant:?}");
                assert!((now.pose.translation - pose.translation).norm() < 1e-12);
                if now.status == Status::Reached {
                    assert!(far <= 1e-3);
                    arrived = arrived.or(Some(step));
                } else {
                    assert!(arrived.is_none(), "{name}, {plant:?}: left again");
                }
                drives.pass(&mechanism, servo.joint_velocities(), 0.002);
            }
            assert!(arrived.is_some_and(|step| step < 1500), "{name}, {plant:?}: {arrived:?}");
        }
    }
}

/// Beyond reach the arm comes to rest, as an ideal one does.
#[test]
fn the_edge_is_met_at_rest() {
    for name in ["panda", "ur5e", "iiwa14"] {
        let mechanism = catalogue::load(name).unwrap();
        for plant in PLANTS {
            for noise in [0.0, 1e-4] {
                let plant = Plant { noise, ..plant };
                let mut options = options(&mechanism, 0.01);
                options.plant = plant;
                let mut servo = Servo::new(&mechanism, options).unwrap();
                let mut drives = Drives::new(mechanism.home(), plant);
                let mut target = tool(&mechanism, mechanism.home());
                target.translation += Vec3::new(1.5, 0.3, 0.2);
                let mut random = Random(3);
                let mut status = Status::Moving;
                let (mut nearest, mut rest) = (f64::INFINITY, 0.0_f64);
                for step in 0..600 {
                    let measured = drives.measured(&mut random);
                    status = servo.step(&measured, target).unwrap().status;
                    drives.pass(&mechanism, servo.joint_velocities(), 0.01);
                    let far = (tool(&mechanism, &drives.q).translation - target.translation).norm();
                    nearest = nearest.min(far);
                    if step > 500 {
                        let most = drives.velocities.iter().fold(0.0_f64, |m, v| m.max(v.abs()));
                        rest = rest.max(most);
                    }
                }
                let far = (tool(&mechanism, &drives.q).translation - target.translation).norm();
                println!("{name} {plant:?}: {status:?} {:.2e} {rest:.2e}", far - nearest);
                assert_eq!(status, Status::Stalled, "{name}, {plant:?}");
                assert!(rest < 0.02, "{name}, {plant:?}: {rest}");
                assert!(far - nearest < 2e-3, "{name}, {plant:?}: {far} after {nearest}");
            }
        }
    }
}

/// A target that moves with a known twist is followed without the lag of the robot.
#[test]
fn known_lag_is_allowed_for() {
    let mechanism = catalogue::load("panda").unwrap();
    let start = tool(&mechanism, mechanism.home());
    let (radius, rate, dt) = (0.08, 1.5, 0.002);
    for plant in PLANTS {
        let mut options = options(&mechanism, dt);
        options.plant = plant;
        let mut servo = Servo::new(&mechanism, options).unwrap();
        let mut drives = Drives::new(mechanism.home(), plant);
        let mut worst = 0.0_f64;
        for step in 0..3000 {
            let angle = rate * dt * f64::from(step);
            let mut target = cylindroid::control::Target::from(start);
            target.pose.translation += Vec3::new(0.0, angle.sin(), angle.cos() - 1.0) * radius;
            target.feed_forward.linear =
                Vec3::new(0.0, angle.cos(), -angle.sin()) * (radius * rate);
            if step > 1500 {
                let far = tool(&mechanism, &drives.q).translation - target.pose.translation;
                worst = worst.max(far.norm());
            }
            servo.step(&drives.q, target).unwrap();
            drives.pass(&mechanism, servo.joint_velocities(), dt);
        }
        // The twist of the target turns during the lag: radius rate^2 lag / |gain + i rate|.
        let (lag, gain) = (plant.lag() + 0.5 * dt, 5.0_f64);
        let expected = radius * rate * rate * lag / gain.hypot(rate);
        println!("{plant:?} {worst:.2e} {expected:.2e}");
        assert!(worst < 1.1 * expected, "{plant:?}: {worst} of {expected}");
    }
}

/// Velocity mode, and its stop.
#[test]
fn twists_are_followed_and_stopped() {
    let mechanism = catalogue::load("panda").unwrap();
    for plant in PLANTS {
        let mut options = options(&mechanism, 0.002);
        options.plant = plant;
        let mut servo = Servo::new(&mechanism, options).unwrap();
        let mut drives = Drives::new(mechanism.home(), plant);
        let up = Twist { linear: Vec3::Z * 0.1, angular: Vec3::ZERO };
        let start = tool(&mechanism, &drives.q);
        let mut last = None;
        for step in 0..1000 {
            let command = (step < 500).then_some(up);
            let now = servo.step_twist(&drives.q, command).unwrap();
            assert_eq!(now.step.position_error, 0.0);
            drives.pass(&mechanism, servo.joint_velocities(), 0.002);
            last = Some(now);
        }
        let moved = tool(&mechanism, &drives.q).translation - start.translation;
        assert!((moved.z - 0.1 * 1.1).abs() < 0.01, "{plant:?}: {moved:?}");
        assert!(moved.x.hypot(moved.y) < 1e-3, "{plant:?}: {moved:?}");
        assert_eq!(last.unwrap().status, TwistStatus::AtRest);
    }
}

/// Legs of a Stewart platform keep their limits, measured alone.
#[test]
fn legs_keep_their_limits() {
    let mechanism = catalogue::load("stewart").unwrap();
    let legs: Vec<usize> = mechanism.actuated().collect();
    let mut unknown = 0.0_f64;
    for plant in PLANTS {
        for known in [plant, Plant::IDEAL] {
            let mut options = ServoOptions::new(&mechanism);
            (options.dt, options.acceleration, options.plant) = (0.01, Some(5.0), known);
            let mut servo = Servo::new(&mechanism, options).unwrap();
            let home = mechanism.home();
            let mut drives = Drives::new(home, plant);
            let mut target = mechanism.state(home).unwrap().pose(mechanism.reference()).unwrap();
            target.translation += Vec3::new(0.1, 0.1, 0.8);
            let mut beyond = f64::NEG_INFINITY;
            for _ in 0..400 {
                let measured: Vec<f64> = legs.iter().map(|&i| drives.q[i]).collect();
                servo.step_actuated(&measured, target).unwrap();
                drives.pass(&mechanism, servo.joint_velocities(), 0.01);
                for &i in &legs {
                    let l = mechanism.coordinates()[i].limits;
                    beyond = beyond.max(drives.q[i] - l.upper).max(l.lower - drives.q[i]);
                }
            }
            println!("{plant:?} {known:?}: {beyond:.2e}");
            if known == plant {
                assert!(beyond <= 1e-9, "{plant:?}: {beyond}");
                assert!(beyond > -1e-3, "{plant:?}: no leg met its limit");
            } else {
                unknown = unknown.max(beyond);
            }
        }
    }
    assert!(unknown > 3e-3, "{unknown}");
}

/// Drives of a closed chain: ideal ones, and ones whose commands lead to loops that are open.
pub(super) const BEHIND_LOOPS: [Plant; 4] = [
    Plant::IDEAL,
    Plant { time_constant: 0.05, ..Plant::IDEAL },
    Plant { delay: 0.05, ..Plant::IDEAL },
    Plant { delay: 0.03, time_constant: 0.05, noise: 1e-3 },
];

/// Closed chains that lag stop before a type II singularity as those that do not: the loops of the
/// configuration to which their commands lead are closed.
#[test]
fn loops_stop_before_singularities_behind_drives() {
    let mechanism = catalogue::load("five-bar").unwrap();
    let home = mechanism.home();
    let mut target = mechanism.state(home).unwrap().pose(mechanism.reference()).unwrap();
    for place in [Vec3::new(0.5, 2.2, 0.0), Vec3::new(0.3, 2.6, 0.0)] {
        target.translation = place;
        for plant in BEHIND_LOOPS {
            let mut options = ServoOptions::new(&mechanism);
            (options.dt, options.plant) = (0.002, plant);
            let mut servo = Servo::new(&mechanism, options).unwrap();
            let aim = |_| (target.into(), true);
            let result = simulate(&mut servo, home, 10.0, aim, |_| {}).unwrap();
            let stall = result.stall;
            assert!(matches!(stall, Some(Stall::TypeII { .. })), "{plant:?}: {stall:?}");
        }
    }
}

#[test]
fn wrong_plants_are_refused() {
    let mechanism = catalogue::load("panda").unwrap();
    for (plant, culprit) in [
        (Plant { delay: -0.001, ..Plant::IDEAL }, "delay"),
        (Plant { delay: 1.01, ..Plant::IDEAL }, "delay"),
        (Plant { time_constant: f64::NAN, ..Plant::IDEAL }, "time constant"),
        (Plant { noise: f64::INFINITY, ..Plant::IDEAL }, "noise"),
    ] {
        let mut options = options(&mechanism, 0.001);
        options.plant = plant;
        let error = Servo::new(&mechanism, options).unwrap_err().to_string();
        assert!(error.contains(culprit), "{error}");
    }
}

/// The simulated robot is the one of the small steps here.
#[test]
fn simulated_robots_lag_as_told() {
    let mechanism = catalogue::load("panda").unwrap();
    let mut target = tool(&mechanism, mechanism.home());
    target.translation += Vec3::new(-0.1, 0.15, 0.05);
    for plant in PLANTS {
        let mut options = options(&mechanism, 0.002);
        options.plant = plant;
        let mut servo = Servo::new(&mechanism, options).unwrap();
        let mut drives = Drives::new(mechanism.home(), plant);
        let mut worst = 0.0_f64;
        let aim = |_| (target.into(), true);
        let result = simulate(&mut servo, mechanism.home(), 5.0, aim, |sample| {
            let places = sample.q.iter().zip(&drives.q);
            worst = places.fold(worst, |w, (a, b)| w.max((a - b).abs()));
            drives.pass(&mechanism, sample.joint_velocities, 0.002);
        })
        .unwrap();
        assert!(result.reached, "{plant:?}");
        assert!(worst < 1e-9, "{plant:?}: {worst}");
        assert!(result.last.position_error <= 1e-3);
    }
}

/// Several tasks at once.
#[test]
fn tasks_keep_limits_too() {
    let mechanism = catalogue::load("panda").unwrap();
    let mut random = Random(5);
    let mut unknown = 0.0_f64;
    for plant in PLANTS {
        for known in [plant, Plant::IDEAL] {
            let mut options = TaskServoOptions::new(&mechanism);
            (options.dt, options.acceleration, options.plant) = (0.01, 10.0, known);
            let mut beyond = 0.0_f64;
            for _ in 0..3 {
                let of = |frame: EndEffector, way: Vec3| {
                    let pose = mechanism.state(mechanism.home()).unwrap().pose(frame).unwrap();
                    let target = Pose { translation: pose.translation + way, ..pose }.into();
                    TaskObjective::Frame { end_effector: frame, components: Task::POSE, target }
                };
                let mut way = || random.within(-0.8, 0.8);
                let hand = of(mechanism.tool().into(), Vec3::new(way(), way(), way()));
                let elbow =
                    of(mechanism.frame("link4").unwrap().into(), Vec3::new(way(), way(), way()));
                let tasks = vec![
                    MotionTask::new("hand", hand),
                    MotionTask::new("elbow", elbow).at_level(1),
                ];
                let mut servo = TaskServo::new(&mechanism, tasks, options.clone()).unwrap();
                let mut drives = Drives::new(mechanism.home(), plant);
                for _ in 0..200 {
                    servo.step(&drives.q).unwrap();
                    drives.pass(&mechanism, servo.joint_velocities(), 0.01);
                }
                beyond = beyond.max(drives.beyond);
            }
            if known == plant {
                assert!(beyond <= 1e-9, "{plant:?}: {beyond}");
            } else {
                unknown = unknown.max(beyond);
            }
        }
    }
    assert!(unknown > 3e-3, "{unknown}");
}

/// On a turned foundation the joints move alike.
#[test]
fn robots_that_lag_move_alike_on_any_foundation() {
    let panda = catalogue::load("panda").unwrap();
    let mut random = Random(4);
    let run = |mechanism: &Mechanism, foundation: Pose| {
        let mut options = options(mechanism, 0.002);
        options.plant = PLANTS[1];
        let mut servo = Servo::new(mechanism, options).unwrap();
        let mut drives = Drives::new(mechanism.home(), PLANTS[1]);
        let mut target = cylindroid::control::Target::from(tool(mechanism, mechanism.home()));
        target.pose.translation += foundation.rotation * Vec3::new(0.9, 0.3, -0.2);
        target.feed_forward.linear = foundation.rotation * Vec3::new(0.0, 0.05, 0.0);
        for _ in 0..600 {
            servo.step(&drives.q, target).unwrap();
            target.pose.translation += target.feed_forward.linear * 0.002;
            drives.pass(mechanism, servo.joint_velocities(), 0.002);
        }
        drives.q
    };
    let own = run(&panda, Pose::IDENTITY);
    for _ in 0..3 {
        let foundation = random.pose();
        let mut builder = Mechanism::builder("moved");
        let how = Inclusion {
            name: "",
            parent: "foundation",
            parent_from_root: foundation,
            free: false,
            start: panda.home(),
        };
        builder.include(&panda, how).unwrap();
        builder.tool(&panda.frame_of(panda.tool()).name);
        let moved = builder.build().unwrap();
        let q = run(&moved, foundation);
        let most = own.iter().zip(&q).fold(0.0_f64, |m, (a, b)| m.max((a - b).abs()));
        assert!(most < 1e-8, "{foundation:?}: {most}");
    }
}
