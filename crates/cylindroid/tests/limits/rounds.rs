//! One round: a robot, a servo, a start, targets that jump, pushes.

use cylindroid::closure::ActuationMap;
use cylindroid::collision::{CollisionModel, CollisionOptions, NearPair};
use cylindroid::control::{
    CollisionAvoidance, MotionTask, Task, TaskObjective, TaskServo, TaskServoOptions,
};
use cylindroid::model::{Geometry, JointLimits};
use cylindroid::{Mechanism, Pose, State};

use crate::one_task::{follows_targets, follows_twists};
use crate::robots::{ClampTo, Random, five_bar, of_catalogue, robot, spatial_loop};
use crate::watch::{Tally, Watch};

/// Steps of a round; few where a fuzzer chooses them.
pub(crate) const STEPS: u64 = if cfg!(fuzzing) { 60 } else { 500 };

/// Steps between two looks at all distances.
const LOOK: u64 = 5;

/// The servo of a round.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Kind {
    Catalogue,
    Random,
    Jerks,
    Closed,
    Tasks,
    Distances,
    ClosedDistances,
    SpatialDistances,
    Twists,
    Noise,
}

impl Kind {
    pub(crate) const ALL: [Self; 10] = [
        Self::Catalogue,
        Self::Random,
        Self::Jerks,
        Self::Closed,
        Self::Tasks,
        Self::Distances,
        Self::ClosedDistances,
        Self::SpatialDistances,
        Self::Twists,
        Self::Noise,
    ];

    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::Catalogue => "robots of the catalogue",
            Self::Random => "random robots",
            Self::Jerks => "limits of the jerk",
            Self::Closed => "closed chains",
            Self::Tasks => "many tasks",
            Self::Distances => "distances",
            Self::ClosedDistances => "distances of five-bars",
            Self::SpatialDistances => "distances of spatial loops",
            Self::Twists => "twists",
            Self::Noise => "noisy encoders",
        }
    }

    /// True if bodies of every robot of this kind are watched.
    pub(crate) fn watches_distances(self) -> bool {
        matches!(self, Self::Distances | Self::ClosedDistances | Self::SpatialDistances)
    }

    pub(crate) fn of(seed: u64) -> Self {
        match seed % 20 {
            0..4 => Self::Catalogue,
            4 => Self::Noise,
            5 | 6 => Self::Twists,
            7..12 => Self::Random,
            12..15 => Self::Jerks,
            15 => Self::Closed,
            16..18 => Self::Tasks,
            18 => Self::Distances,
            _ if seed / 20 % 2 == 1 => Self::ClosedDistances,
            _ => Self::SpatialDistances,
        }
    }
}

/// The round of this number.
pub(crate) fn run(kind: Kind, seed: u64) -> Tally {
    let mut random = Random::seeded(seed.wrapping_mul(0xd134_2543_de82_ef95));
    let mut tally = run_with(kind, &mut random);
    tally.violations.iter_mut().for_each(|v| *v = format!("round {seed}, {v}"));
    tally
}

/// The round that bytes describe; nothing is left or in contact.
///
/// # Panics
/// Otherwise.
pub(crate) fn check(bytes: &[u8]) {
    let mut random = Random::of_bytes(bytes);
    let kind = Kind::ALL[random.below(Kind::ALL.len())];
    let tally = run_with(kind, &mut random);
    assert!(tally.violations.is_empty(), "{}: {:?}", kind.name(), tally.violations);
}

pub(crate) fn run_with(kind: Kind, random: &mut Random<'_>) -> Tally {
    let mut tally = match kind {
        Kind::Catalogue | Kind::Closed => {
            let robot = of_catalogue(random, kind == Kind::Closed);
            follows_targets(&robot, 0.0, random)
        }
        Kind::Random => follows_targets(&robot(random, false), 0.0, random),
        Kind::Jerks => {
            let way = random.below(4);
            let robot = robot(random, way == 3);
            let robot = with_jerks(&robot, random);
            match way {
                0 | 1 => follows_targets(&robot, 0.0, random),
                2 => many_tasks(&robot, 0.0, random),
                _ => distances(&robot, random),
            }
        }
        Kind::Twists if random.once_in(4) => follows_twists(&of_catalogue(random, true), random),
        Kind::Twists => follows_twists(&robot(random, false), random),
        Kind::Tasks if random.once_in(5) => closed_tasks(random),
        Kind::Tasks => many_tasks(&robot(random, false), 0.0, random),
        Kind::Noise => noisy(random),
        Kind::Distances => distances(&robot(random, true), random),
        Kind::ClosedDistances => {
            let robot = five_bar(random);
            closed_distances(&robot, 0.02, random)
        }
        Kind::SpatialDistances => {
            let robot = spatial_loop(random);
            closed_distances(&robot, 1.0, random)
        }
    };
    tally.rounds = 1;
    tally
}

/// A robot whose servo knows how noisy its encoders are.
fn noisy(random: &mut Random<'_>) -> Tally {
    let robot = if random.once_in(3) { of_catalogue(random, false) } else { robot(random, false) };
    let robot = if random.once_in(3) { with_jerks(&robot, random) } else { robot };
    let noise = random.power(-6.0, -1.5);
    match random.below(3) {
        0 => many_tasks(&robot, noise, random),
        _ => follows_targets(&robot, noise, random),
    }
}

/// The same robot with limits of all jerks.
fn with_jerks(robot: &Mechanism, random: &mut Random<'_>) -> Mechanism {
    let limits = robot.coordinates().iter().map(|c| {
        let jerk = Some(random.power(0.0, 4.0));
        (c.name.as_str(), JointLimits { jerk, ..JointLimits::default() })
    });
    robot.with_limits(&limits.collect::<Vec<_>>()).unwrap()
}

/// A push changes velocities at once, which no jerk limit permits.
pub(crate) fn takes_pushes(robot: &Mechanism) -> bool {
    robot.coordinates().iter().all(|c| c.limits.jerk == f64::INFINITY)
}

/// Something moves the robot: anywhere within the limits, or a little.
pub(crate) fn push(robot: &Mechanism, q: &mut [f64], random: &mut Random<'_>) {
    let anywhere = random.configuration(robot);
    let share = if random.once_in(3) { 1.0 } else { random.power(-6.0, -1.0) };
    for ((x, to), c) in q.iter_mut().zip(anywhere).zip(robot.coordinates()) {
        *x = (*x + share * (to - *x)).clamp_to(c.limits.lower, c.limits.upper);
        // Beyond a limit, as measured positions are.
        if random.once_in(20) {
            *x += random.within(-1e-3, 1e-3);
        }
    }
}

/// A target near the pose, far away, beyond all numbers of robots, or the pose turned by a half.
pub(crate) fn target(of: Pose, random: &mut Random<'_>) -> Pose {
    match random.below(8) {
        0 => random.pose(1e6),
        1 => random.pose(1.0),
        2 => of * Pose { translation: cylindroid::Vec3::ZERO, ..random.pose(1.0) },
        3 => of,
        _ => {
            let size = random.power(-4.0, 0.0);
            Pose { translation: of.translation + random.vec3(size), ..of }
        }
    }
}

/// In closed chains the velocities of the actuated joints have limits.
pub(crate) fn closed_step(
    robot: &Mechanism,
    velocities: &[f64],
    q: &[f64],
    step: u64,
    tally: &mut Tally,
) {
    for ((c, v), x) in robot.coordinates().iter().zip(velocities).zip(q) {
        let is_fast = c.actuated && v.abs() > c.limits.velocity * (1.0 + 1e-9);
        if !v.is_finite() || !x.is_finite() || is_fast {
            let what = format!("step {step}: {} at {x:e} with {v:e}", c.name);
            tally.violations.push(what);
        }
    }
}

fn tasks(robot: &Mechanism, q: &[f64], random: &mut Random<'_>) -> Vec<MotionTask> {
    let state = robot.state(q).unwrap();
    let count = 1 + random.below(4);
    let frames = robot.frames().len();
    let task = |i: usize, random: &mut Random<'_>| {
        let frame = robot.frame(&robot.frames()[random.below(frames)].name).unwrap();
        let end_effector = frame.into();
        let components = [Task::POSE, Task::POSITION, Task::POINTING][random.below(3)];
        let objective = match random.below(6) {
            0 => TaskObjective::Gaze { end_effector, point: random.vec3(3.0) },
            1 => TaskObjective::Posture { q: random.configuration(robot) },
            2 => TaskObjective::CenterOfMass {
                axes: [true, true, false],
                target: random.vec3(1.0),
                velocity: cylindroid::Vec3::ZERO,
            },
            3 => TaskObjective::RelativeFrame {
                end_effector,
                reference: robot.tool().into(),
                components,
                target: random.pose(0.5),
            },
            _ => TaskObjective::Frame {
                end_effector,
                components,
                target: target(state.pose(frame).unwrap(), random).into(),
            },
        };
        MotionTask {
            weight: random.power(-2.0, 2.0),
            gain: random.power(-1.0, 1.5),
            ..MotionTask::new(&format!("{i}"), objective)
        }
        .at_level(random.below(3))
    };
    (0..count).map(|i| task(i, random)).collect()
}

fn many_tasks(robot: &Mechanism, noise: f64, random: &mut Random<'_>) -> Tally {
    let mut options = TaskServoOptions::new(robot);
    options.dt = random.power(-3.5, -1.8);
    options.acceleration = random.power(-1.0, 4.0);
    options.plant.noise = noise;
    let mut q = start(robot, noise, random);
    let (dt, acceleration) = (options.dt, options.acceleration);
    let Ok(servo) = TaskServo::new(robot, tasks(robot, &q, random), options) else {
        return Tally::default();
    };
    let mut watch = Watch::new(robot, dt, acceleration);
    task_servo(servo, noise, &mut q, &mut watch, random, |_, _| Ok(()))
}

/// Many tasks of a closed chain.
fn closed_tasks(random: &mut Random<'_>) -> Tally {
    let robot = of_catalogue(random, true);
    let mut options = TaskServoOptions::new(&robot);
    options.dt = random.power(-3.5, -2.3);
    options.acceleration = random.power(-1.0, 4.0);
    let mut q = robot.home().to_vec();
    match TaskServo::new(&robot, tasks(&robot, &q, random), options) {
        Ok(servo) => closed_servo(servo, &mut q, |_, _| Ok(())),
        Err(_) => Tally::default(),
    }
}

/// Steps of a servo of a closed chain: the velocities of its actuated joints have limits.
fn closed_servo(
    mut servo: TaskServo,
    q: &mut [f64],
    mut look: impl FnMut(u64, &[f64]) -> Result<(), String>,
) -> Tally {
    let robot = servo.mechanism().clone();
    let mut tally = Tally::default();
    for step in 0..STEPS {
        tally.steps += 1;
        // A loop that opened is an error.
        if servo.step(q).is_err() {
            tally.errors += 1;
            return tally;
        }
        servo.advance(q);
        tally.note(step, q);
        closed_step(&robot, servo.joint_velocities(), q, step, &mut tally);
        if let Err(what) = look(step, q) {
            tally.violations.push(what);
            return tally;
        }
    }
    tally
}

/// A start from which no measurement seems to lie beyond a limit.
pub(crate) fn start(robot: &Mechanism, noise: f64, random: &mut Random<'_>) -> Vec<f64> {
    let mut q = random.configuration(robot);
    for (x, c) in q.iter_mut().zip(robot.coordinates()).filter(|_| noise > 0.0) {
        let off = (3.0 * noise).min(0.5 * (c.limits.upper - c.limits.lower));
        *x = (*x).clamp_to(c.limits.lower + off, c.limits.upper - off);
    }
    q
}

/// What encoders say: off by up to the noise.
pub(crate) fn measured(q: &[f64], noise: f64, random: &mut Random<'_>) -> Vec<f64> {
    let mut off = || if noise > 0.0 { random.within(-noise, noise) } else { 0.0 };
    q.iter().map(|x| x + off()).collect()
}

/// Steps of a servo of many tasks; `look` is called after each with the step and the
/// configuration.
fn task_servo(
    mut servo: TaskServo,
    noise: f64,
    q: &mut [f64],
    watch: &mut Watch,
    random: &mut Random<'_>,
    mut look: impl FnMut(u64, &[f64]) -> Result<(), String>,
) -> Tally {
    let robot = servo.mechanism().clone();
    let mut tally = Tally::default();
    // A push may put bodies into one another: none where distances are watched.
    let pushes = servo.collision_model_mut().is_none() && takes_pushes(&robot) && noise == 0.0;
    for step in 0..STEPS {
        if pushes && random.once_in(250) {
            push(&robot, q, random);
            watch.push();
            tally.pushes += 1;
        }
        tally.steps += 1;
        if let Err(error) = servo.step(&measured(q, noise, random)) {
            tally.errors += 1;
            tally.violations.push(format!("step {step}: {error}"));
            return tally;
        }
        let before = q.to_vec();
        servo.advance(q);
        tally.note(step, q);
        let found = watch.step(&before, servo.joint_velocities(), q);
        match found.and_then(|at_limit| look(step, q).map(|()| at_limit)) {
            Ok(at_limit) => tally.at_limits += u64::from(at_limit),
            Err(what) => {
                tally.violations.push(format!("step {step}: {what}"));
                return tally;
            }
        }
    }
    tally
}

/// A robot with up to three obstacles, at most so far above and below the plane x-y.
fn among_obstacles(robot: &Mechanism, height: f64, random: &mut Random<'_>) -> CollisionModel {
    let options = CollisionOptions { samples: 20, ..CollisionOptions::default() };
    let mut model = CollisionModel::new(robot, &options).unwrap();
    for i in 0..1 + random.below(3) {
        let size = random.within(0.03, 0.2);
        let geometry = match random.below(4) {
            0 => Geometry::Box { size: cylindroid::Vec3::new(size, size, 2.0 * size) },
            1 => Geometry::Capsule { radius: size, length: size },
            2 => Geometry::Cylinder { radius: size, length: size },
            _ => Geometry::Sphere { radius: size },
        };
        let mut pose = random.pose(1.0);
        pose.translation.z *= height;
        model.add_obstacle(&format!("o{i}"), &geometry, pose).unwrap();
    }
    model
}

/// The least actuated share of all motions of a closed chain away from type II singularities [-].
const SHARE: f64 = 0.05;

/// The least distance that a servo is to keep (m).
const GAP: f64 = 0.005;

/// Looks at the distances of a motion: pairs that start apart stay apart.
struct Distances {
    model: CollisionModel,
    near: Vec<NearPair>,
    nearest: f64,
    below_gap: u64,
    looks: u64,
}

impl Distances {
    fn new(model: CollisionModel) -> Self {
        Self { model, near: Vec::new(), nearest: f64::INFINITY, below_gap: 0, looks: 0 }
    }

    /// All pairs have more than the gap.
    fn is_free(&mut self, state: &State) -> bool {
        self.model.near(state, 4.0 * GAP, &mut self.near).unwrap();
        self.near.is_empty()
    }

    fn look(&mut self, step: u64, state: &State) -> Result<(), String> {
        if !step.is_multiple_of(LOOK) {
            return Ok(());
        }
        self.looks += 1;
        self.model.near(state, GAP, &mut self.near).unwrap();
        let Some(least) = self.near.iter().min_by(|a, b| a.distance.total_cmp(&b.distance)) else {
            return Ok(());
        };
        self.below_gap += 1;
        self.nearest = least.distance.min(self.nearest);
        if least.distance < 0.0 {
            let names = self.model.names(least.pair);
            return Err(format!("step {step}: {names:?} at {:e} m", least.distance));
        }
        Ok(())
    }

    fn add_to(self, tally: &mut Tally) {
        (tally.looks, tally.below_gap) = (self.looks, self.below_gap);
        tally.nearest = self.nearest.is_finite().then_some(self.nearest);
    }
}

/// A robot among obstacles.
fn distances(robot: &Mechanism, random: &mut Random<'_>) -> Tally {
    let model = among_obstacles(robot, 1.0, random);
    let mut watched = Distances::new(model.clone());
    let mut q = Vec::new();
    let is_free = (0..30).any(|_| {
        q = random.configuration(robot);
        watched.is_free(&robot.state(&q).unwrap())
    });
    if !is_free {
        return Tally::default();
    }
    let mut options = TaskServoOptions::new(robot);
    options.dt = random.power(-3.3, -2.3);
    options.collisions = Some(CollisionAvoidance { model, gap: GAP, margin: 5.0 });
    let dt = options.dt;
    let Ok(servo) = TaskServo::new(robot, tasks(robot, &q, random), options) else {
        return Tally::default();
    };
    let mut watch = Watch::new(robot, dt, f64::INFINITY);
    let look = |step, q: &[f64]| watched.look(step, &robot.state(q).unwrap());
    let mut tally = task_servo(servo, 0.0, &mut q, &mut watch, random, look);
    watched.add_to(&mut tally);
    tally
}

/// A closed chain among obstacles, at most so far above and below the plane x-y.
fn closed_distances(robot: &Mechanism, height: f64, random: &mut Random<'_>) -> Tally {
    let model = among_obstacles(robot, height, random);
    let mut watched = Distances::new(model.clone());
    let mut q = robot.home().to_vec();
    if !watched.is_free(&robot.state(&q).unwrap()) {
        return Tally::default();
    }
    let mut options = TaskServoOptions::new(robot);
    options.dt = random.power(-3.3, -2.3);
    options.collisions = Some(CollisionAvoidance { model, gap: GAP, margin: 5.0 });
    let Ok(servo) = TaskServo::new(robot, tasks(robot, &q, random), options) else {
        return Tally::default();
    };
    let mut is_controlled = true;
    let look = |step, q: &[f64]| {
        let state = robot.state(q).unwrap();
        // From a type II singularity on the drives do not say where the passive joints go.
        let map = ActuationMap::of(&state, &[], &[]).unwrap();
        is_controlled &= map.uncontrolled.cols() == 0 && map.shares.iter().all(|s| *s >= SHARE);
        if is_controlled { watched.look(step, &state) } else { Ok(()) }
    };
    let mut tally = closed_servo(servo, &mut q, look);
    watched.add_to(&mut tally);
    tally
}
