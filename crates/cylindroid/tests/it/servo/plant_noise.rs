//! Noisy encoders behind a servo that knows the size of their errors: braking before position limits
//! stays within the limits of accelerations and jerks.

use cylindroid::catalogue;
use cylindroid::control::{
    LimitKind, MotionTask, Plant, Task, TaskObjective, TaskServo, TaskServoOptions,
};
use cylindroid::model::{JointLimits, Mechanism};
use cylindroid::{Servo, ServoOptions, Vec3};

use super::plant::{Drives, PLANTS, near_limits, options, tool};
use crate::support::Random;

const DT: f64 = 0.002;
const ACCELERATION: f64 = 10.0;

/// The largest shares of their limits that the commands of actuated joints take.
struct Commands<'a> {
    mechanism: &'a Mechanism,
    jerk: f64,
    /// Velocities and accelerations of the last step.
    last: Vec<[f64; 2]>,
    /// Steps in which a position limit bound a joint.
    stops: usize,
    hardest: f64,
    jerkiest: f64,
}

impl<'a> Commands<'a> {
    fn new(mechanism: &'a Mechanism, jerk: f64) -> Self {
        let last = vec![[0.0; 2]; mechanism.n()];
        Self { mechanism, jerk, last, stops: 0, hardest: 0.0, jerkiest: 0.0 }
    }

    /// The servo begins at rest.
    fn start(&mut self) {
        self.last.fill([0.0; 2]);
    }

    fn add(&mut self, rates: &[f64], met: impl Iterator<Item = (usize, LimitKind)>) {
        self.stops += met.filter(|(_, kind)| *kind == LimitKind::Position).count();
        for (i, rate) in rates.iter().enumerate() {
            let coordinate = &self.mechanism.coordinates()[i];
            if !coordinate.actuated {
                continue;
            }
            let or = |own: f64, other: f64| if own.is_finite() { own } else { other };
            let [before, acceleration] = self.last[i];
            let change = (rate - before) / DT;
            let most = or(coordinate.limits.acceleration, ACCELERATION);
            self.hardest = self.hardest.max(change.abs() / most);
            let most = or(coordinate.limits.jerk, self.jerk);
            self.jerkiest = self.jerkiest.max((change - acceleration).abs() / DT / most);
            self.last[i] = [*rate, change];
        }
    }

    fn assert_within(&self, what: &str) {
        let Self { stops, hardest, jerkiest, .. } = self;
        println!("{what}: {stops} stops, {hardest:.9} {jerkiest:.9}");
        assert!(*stops > 20, "{what}: {stops} stops");
        assert!(*hardest <= 1.0 + 1e-9, "{what}: {hardest}");
        assert!(*jerkiest <= 1.0 + 1e-6, "{what}: {jerkiest}");
    }
}

const NOISY: [Plant; 4] = [
    Plant { noise: 1e-3, ..Plant::IDEAL },
    Plant { noise: 1e-3, ..PLANTS[1] },
    Plant { noise: 1e-4, ..PLANTS[2] },
    Plant { noise: 1e-2, ..PLANTS[3] },
];

#[test]
fn noise_does_not_hasten_braking() {
    for (name, jerk) in [("panda", f64::INFINITY), ("panda", 500.0), ("iiwa14", f64::INFINITY)] {
        let mechanism = catalogue::load(name).unwrap();
        for plant in NOISY {
            let what = format!("{name} {jerk} {plant:?}");
            let mut options = options(&mechanism, DT);
            (options.plant, options.jerk) = (plant, jerk);
            options.acceleration = Some(ACCELERATION);
            let (mut random, mut commands) = (Random(7), Commands::new(&mechanism, jerk));
            for _ in 0..6 {
                let mut servo = Servo::new(&mechanism, options.clone()).unwrap();
                let mut drives = Drives::new(mechanism.home(), plant);
                commands.start();
                for _ in 0..3 {
                    let target = tool(&mechanism, &near_limits(&mechanism, &mut random));
                    for _ in 0..350 {
                        servo.step(&drives.measured(&mut random), target).unwrap();
                        commands.add(servo.joint_velocities(), servo.active_limits());
                        drives.pass(&mechanism, servo.joint_velocities(), DT);
                    }
                }
                assert!(drives.beyond <= 0.0, "{what}: {}", drives.beyond);
            }
            commands.assert_within(&what);
        }
    }
}

#[test]
fn noise_does_not_hasten_braking_of_tasks() {
    let mechanism = catalogue::load("panda").unwrap();
    for jerk in [f64::INFINITY, 500.0] {
        for plant in NOISY {
            let what = format!("{jerk} {plant:?}");
            let mut options = TaskServoOptions::new(&mechanism);
            (options.dt, options.plant) = (DT, plant);
            (options.acceleration, options.jerk) = (ACCELERATION, jerk);
            let (mut random, mut commands) = (Random(8), Commands::new(&mechanism, jerk));
            for _ in 0..6 {
                let target = tool(&mechanism, &near_limits(&mechanism, &mut random)).into();
                let end_effector = mechanism.tool().into();
                let hand = TaskObjective::Frame { end_effector, components: Task::POSE, target };
                let tasks = vec![MotionTask::new("hand", hand)];
                let mut servo = TaskServo::new(&mechanism, tasks, options.clone()).unwrap();
                let mut drives = Drives::new(mechanism.home(), plant);
                commands.start();
                for _ in 0..500 {
                    servo.step(&drives.measured(&mut random)).unwrap();
                    commands.add(servo.joint_velocities(), servo.active_limits());
                    drives.pass(&mechanism, servo.joint_velocities(), DT);
                }
                assert!(drives.beyond <= 0.0, "{what}: {}", drives.beyond);
            }
            commands.assert_within(&what);
        }
    }
}

/// In a closed chain the actuated joints, whose measured positions the loops share.
#[test]
fn noise_does_not_hasten_braking_of_loops() {
    let free = catalogue::load("five-bar").unwrap();
    let narrow = |i: usize| {
        let (name, home) = (free.coordinates()[i].name.clone(), free.home()[i]);
        let (lower, upper) = (Some(home - 0.1), Some(home + 0.1));
        (name, JointLimits { lower, upper, ..JointLimits::default() })
    };
    let mechanism = free.with_limits(&free.actuated().map(narrow).collect::<Vec<_>>()).unwrap();
    for noise in [1e-4, 1e-3] {
        let mut options = ServoOptions::new(&mechanism);
        options.plant.noise = noise;
        (options.dt, options.acceleration) = (DT, Some(ACCELERATION));
        let (mut random, mut commands) = (Random(9), Commands::new(&mechanism, f64::INFINITY));
        for _ in 0..20 {
            let mut servo = Servo::new(&mechanism, options.clone()).unwrap();
            let mut q = mechanism.home().to_vec();
            let mut target = mechanism.state(&q).unwrap().pose(mechanism.reference()).unwrap();
            let way = Vec3::new(random.within(-1.0, 1.0), random.within(-1.0, 1.0), 0.0);
            target.translation += way * (0.6 / way.norm());
            commands.start();
            for _ in 0..500 {
                let measured: Vec<f64> =
                    q.iter().map(|x| x + random.within(-noise, noise)).collect();
                servo.step(&measured, target).unwrap();
                commands.add(servo.joint_velocities(), servo.active_limits());
                servo.advance(&mut q);
                assert_eq!(mechanism.outside_limits(&q).count(), 0, "{noise}: {q:?}");
            }
        }
        commands.assert_within(&format!("five-bar {noise}"));
    }
}
