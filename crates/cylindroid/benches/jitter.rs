//! Times of single servo steps: `cargo bench -p cylindroid --bench jitter [-- NAMES]`, and of the loop with
//! deadlines: `cargo bench -p cylindroid --bench jitter -- --deadlines SECONDS [NAMES]`.
//!
//! Each step is timed separately and acts on the configuration after the one before: the servo of one
//! frame on a circle through the middle of its workspace, with the default secondary tasks, as in
//! `move`, and with none, which lets the redundant panda drift from round to round until a joint
//! reaches its limit; on a circle beyond its reach, where limits bound every step; servos of many
//! tasks, among obstacles, of a humanoid and of closed chains. Interruptions by other programs or the
//! kernel show in the largest times.
//!
//! With deadlines each servo runs at 1 kHz for so many seconds, woken up at absolute times, with
//! SCHED_FIFO and locked memory where the system grants them: latency of waking up, time of the step,
//! and how many commands came later than a period, as in examples/05_real_time_loop.rs.
#![allow(missing_docs, clippy::unwrap_used)]

use std::f64::consts::TAU;
use std::fmt::Write;
use std::time::{Duration, Instant};

use cylindroid::closure::assemble;
use cylindroid::collision::{CollisionModel, CollisionOptions};
use cylindroid::control::{
    CollisionAvoidance, MotionTask, Task, TaskObjective, TaskServo, TaskServoOptions,
};
use cylindroid::model::formats::toml;
use cylindroid::model::{
    Collision, Geometry, Inclusion, Inertial, JointKind, JointSpec, Limits, Link,
};
use cylindroid::spatial::Mat3;
use cylindroid::{Mechanism, Pose, Rotation, Servo, ServoOptions, Vec3, catalogue};

#[path = "../examples/real_time/mod.rs"]
mod real_time;

/// Steps of a round.
const ROUND: f64 = 4_000.0;

/// Takes the step of this number, and returns its time.
type Stepper = Box<dyn FnMut(usize) -> Duration>;

/// What runs, its number of steps, and the steps.
type Scenario = (&'static str, usize, fn() -> Stepper);

const SCENARIOS: [Scenario; 12] = [
    ("panda, away from limits", 1_000_000, || circle("panda", true, 0.1)),
    ("panda", 1_000_000, || circle("panda", false, 0.1)),
    ("ur5e", 1_000_000, || circle("ur5e", false, 0.1)),
    ("panda, out of reach", 200_000, || circle("panda", true, 1.2)),
    ("panda, many tasks", 200_000, || panda_of_tasks(0)),
    ("panda, 2 obstacles", 200_000, || panda_of_tasks(2)),
    ("panda, 500 pairs", 50_000, panda_of_spheres),
    ("humanoid", 50_000, || humanoid(true)),
    ("humanoid, one level", 50_000, || humanoid(false)),
    ("stewart, many tasks", 100_000, stewart_of_tasks),
    ("stewart", 100_000, || object("stewart")),
    ("32 loops", 2_000, || object("")),
];

fn main() {
    // Cargo passes `--bench`.
    let mut arguments = std::env::args().skip(1).filter(|a| a != "--bench");
    let (mut names, mut seconds) = (Vec::new(), None);
    while let Some(argument) = arguments.next() {
        match argument.as_str() {
            "--deadlines" => {
                seconds = arguments.next().and_then(|n| n.parse::<u32>().ok());
                if seconds.is_none() {
                    eprintln!("error: --deadlines needs a number of seconds");
                    std::process::exit(2);
                }
            }
            name => names.push(name.to_owned()),
        }
    }
    let is_named = |name: &str| names.is_empty() || names.iter().any(|n| name.contains(n.as_str()));
    let chosen = SCENARIOS.iter().filter(|(name, ..)| is_named(name));
    if let Some(seconds) = seconds {
        real_time::become_real_time();
        for (name, _, prepare) in chosen {
            println!("\n{name}, {seconds} s at 1 kHz");
            let mut step = prepare();
            let cycle = |cycle| Ok::<_, std::convert::Infallible>(step(cycle));
            let cycles = seconds as usize * 1000;
            real_time::at_deadlines(Duration::from_millis(1), cycles, cycle).unwrap().print();
        }
        return;
    }
    println!("us a servo step    steps   median   99.9 %  largest");
    for (name, steps, prepare) in chosen {
        let mut step = prepare();
        let mut times: Vec<u128> = (0..*steps).map(|i| step(i).as_nanos()).collect();
        times.sort_unstable();
        let at = |place: usize| times[place] as f64 * 1e-3;
        let (median, most) = (at(steps / 2), at(steps - 1));
        println!("{name:24}{steps:8}{median:9.2}{:9.2}{most:9.1}", at(steps / 1000 * 999));
    }
}

/// A point of the circle in the plane of y and z, of this radius (m).
fn around(start: Pose, radius: f64, step: usize) -> Pose {
    let (sin, cos) = (step as f64 / ROUND * TAU).sin_cos();
    let way = Vec3::new(0.0, radius * sin, radius * (cos - 1.0));
    Pose { translation: start.translation + way, ..start }
}

fn circle(name: &str, besides: bool, radius: f64) -> Stepper {
    let robot = catalogue::load(name).unwrap();
    let mut options = ServoOptions::new(&robot);
    if besides {
        options.secondary = options.default_secondary(&robot).unwrap();
    }
    let mut servo = Servo::new(&robot, options).unwrap();
    let start = robot.state(robot.home()).unwrap().pose(robot.tool()).unwrap();
    let mut q = robot.home().to_vec();
    Box::new(move |step| {
        let target = around(start, radius, step);
        let began = Instant::now();
        servo.step(&q, target).unwrap();
        let time = began.elapsed();
        servo.advance(&mut q);
        time
    })
}

/// The object of a closed chain from side to side; of a chain of loops without a name.
fn object(name: &str) -> Stepper {
    let mechanism = match name {
        "" => chain_of_loops(32),
        _ => catalogue::load(name).unwrap(),
    };
    let mut servo = Servo::new(&mechanism, ServoOptions::new(&mechanism)).unwrap();
    let mut q = assemble(&mechanism, mechanism.home(), &[]).unwrap().q;
    let end_effector = servo.options().end_effector;
    let start = mechanism.state(&q).unwrap().pose(end_effector).unwrap();
    Box::new(move |step| {
        let way = Vec3::X * (0.02 * (step as f64 / 500.0 * TAU).sin());
        let target = Pose { translation: start.translation + way, ..start };
        let began = Instant::now();
        servo.step(&q, target).unwrap();
        let time = began.elapsed();
        servo.advance(&mut q);
        time
    })
}

/// Parallelograms in series: each turns by its own actuated joint.
fn chain_of_loops(loops: usize) -> Mechanism {
    let mut text = format!("name = \"loops\"\ndimension = 2\nreference = \"c{loops}\"\n");
    let mut joint = |name: &str, a: &str, b: &str, at: [f64; 2], actuated: bool| {
        write!(
            text,
            "[[joint]]\nname = \"{name}\"\ntype = \"revolute\"\nbetween = [\"{a}\", \"{b}\"]\n\
             origin = [{}, {}]\nactuated = {actuated}\n",
            at[0], at[1]
        )
        .unwrap();
    };
    for i in 0..loops {
        let below = if i == 0 { "ground".to_owned() } else { format!("c{i}") };
        let (left, right, above) = (format!("l{i}"), format!("r{i}"), format!("c{}", i + 1));
        let (y, up) = (0.1 * i as f64, 0.1 * (i + 1) as f64);
        joint(&format!("q{i}"), &below, &left, [0.0, y], true);
        joint(&format!("a{i}"), &left, &above, [0.02, up], false);
        joint(&format!("b{i}"), &below, &right, [0.1, y], false);
        joint(&format!("d{i}"), &right, &above, [0.11, up], false);
    }
    toml::parse(&text, std::path::Path::new("loops.toml")).unwrap()
}

fn frame(robot: &Mechanism, name: &str, components: Task, q: &[f64]) -> MotionTask {
    let frame = robot.frame(name).unwrap();
    let target = robot.state(q).unwrap().pose(frame).unwrap().into();
    let objective = TaskObjective::Frame { end_effector: frame.into(), components, target };
    MotionTask::new(name, objective)
}

/// Steps of a servo whose first task goes round.
fn run(mut servo: TaskServo, mut q: Vec<f64>, radius: f64) -> Stepper {
    let name = servo.tasks()[0].name.clone();
    let TaskObjective::Frame { target: start, .. } = servo.tasks()[0].objective else {
        unreachable!("the first task is that of a frame")
    };
    Box::new(move |step| {
        if let Ok(TaskObjective::Frame { target, .. }) = servo.objective_mut(&name) {
            *target = around(start.pose, radius, step).into();
        }
        let began = Instant::now();
        servo.step(&q).unwrap();
        let time = began.elapsed();
        servo.advance(&mut q);
        time
    })
}

/// A panda with spheres on each of its eight links.
fn with_spheres(count: usize) -> Mechanism {
    let panda = catalogue::load("panda").unwrap();
    let mut builder = Mechanism::builder("panda of spheres");
    let how = Inclusion {
        name: "",
        parent: &panda.links()[0].name,
        parent_from_root: Pose::IDENTITY,
        free: false,
        start: panda.home(),
    };
    builder.include(&panda, how).unwrap();
    for link in &panda.links()[..8] {
        for k in 0..count {
            let at = Vec3::new(0.0, 0.02 * k as f64, -0.05 * k as f64);
            builder.collision(
                &link.name,
                Collision {
                    geometry: Geometry::Sphere { radius: 0.05 },
                    link_from_shape: Pose::from_translation(at),
                    ..Collision::default()
                },
            );
        }
    }
    builder.tool("hand_tcp");
    builder.build().unwrap()
}

/// Spheres around, the first ones in the way of the hand.
fn avoidance(robot: &Mechanism, obstacles: usize, margin: f64) -> CollisionAvoidance {
    let mut model = CollisionModel::new(robot, &CollisionOptions::default()).unwrap();
    for k in 0..obstacles {
        let turn = Rotation::about_z(k as f64);
        let pose = Pose::from_translation(turn * Vec3::new(0.6, 0.0, 0.1 * k as f64));
        model.add_obstacle(&format!("ball {k}"), &Geometry::Sphere { radius: 0.05 }, pose).unwrap();
    }
    CollisionAvoidance { model, gap: 0.01, margin }
}

fn panda_of_tasks(obstacles: usize) -> Stepper {
    let robot = with_spheres(1);
    let q = catalogue::load("panda").unwrap().home().to_vec();
    let posture = MotionTask::new("posture", TaskObjective::Posture { q: q.clone() });
    let tasks = vec![frame(&robot, "hand_tcp", Task::POSE, &q), posture];
    let mut options = TaskServoOptions::new(&robot);
    options.collisions = (obstacles > 0).then(|| avoidance(&robot, obstacles, 0.3));
    run(TaskServo::new(&robot, tasks, options).unwrap(), q, 0.1)
}

fn panda_of_spheres() -> Stepper {
    let robot = with_spheres(4);
    let q = catalogue::load("panda").unwrap().home().to_vec();
    let posture = MotionTask::new("posture", TaskObjective::Posture { q: q.clone() });
    let tasks = vec![frame(&robot, "hand_tcp", Task::POSE, &q), posture];
    let mut options = TaskServoOptions::new(&robot);
    options.collisions = Some(avoidance(&robot, 6, 2.0));
    run(TaskServo::new(&robot, tasks, options).unwrap(), q, 0.1)
}

/// A free body with legs of six joints, a waist of three and arms of seven: 35 coordinates, as a G1.
fn walker() -> Mechanism {
    let mut builder = Mechanism::builder("walker");
    let limits =
        Limits { lower: -2.5, upper: 2.5, velocity: 10.0, acceleration: 200.0, ..Limits::NONE };
    let mut add = |name: &str, kind: JointKind, parent: &str, axis: Vec3, at: Vec3| {
        let inertial = Inertial {
            mass: 1.5,
            link_from_inertia: Pose::from_translation(Vec3::Z * -0.05),
            inertia: Mat3::ZERO,
        };
        builder.link(Link { inertial: Some(inertial), ..Link::named(name) });
        let own = if kind == JointKind::Free { Limits::NONE } else { limits };
        builder.joint(JointSpec {
            axis,
            limits: own,
            parent_from_joint: Pose::from_translation(at),
            ..JointSpec::new(&format!("to_{name}"), kind, parent, name)
        });
    };
    add("pelvis", JointKind::Free, "world", Vec3::Z, Vec3::Z * 0.8);
    let (x, y, z) = (Vec3::X, Vec3::Y, Vec3::Z);
    let chain = |add: &mut dyn FnMut(&str, JointKind, &str, Vec3, Vec3),
                 name: &str,
                 root: &str,
                 (first, step): (Vec3, Vec3),
                 axes: &[Vec3]| {
        let mut parent = root.to_owned();
        for (i, axis) in axes.iter().enumerate() {
            let link = format!("{name}{i}");
            add(&link, JointKind::Revolute, &parent, *axis, if i == 0 { first } else { step });
            parent = link;
        }
    };
    for (side, sign) in [("left", 1.0), ("right", -1.0)] {
        let leg = (y * (0.1 * sign), z * -0.12);
        chain(&mut add, &format!("{side}_leg"), "pelvis", leg, &[y, x, z, y, y, x]);
    }
    chain(&mut add, "waist", "pelvis", (z * 0.1, z * 0.1), &[z, x, y]);
    for (side, sign) in [("left", 1.0), ("right", -1.0)] {
        let arm = (y * (0.15 * sign) + z * 0.2, z * -0.1);
        chain(&mut add, &format!("{side}_arm"), "waist2", arm, &[y, x, z, y, z, y, x]);
    }
    builder.build().unwrap()
}

/// Hands and feet at poses, the centre of mass above the feet, a posture; the hands below the feet, or
/// all but the posture on one level.
fn humanoid(by_levels: bool) -> Stepper {
    let robot = walker();
    let bend = |i: usize| if i < 6 { 0.0 } else { 0.4 * f64::from(1 - 2 * (i as i32 % 2)) };
    let q: Vec<f64> = (0..robot.n()).map(bend).collect();
    let frames = ["left_arm6", "right_arm6", "left_leg5", "right_leg5"];
    let level = |name: &&str| usize::from(by_levels && name.contains("arm"));
    let mut tasks: Vec<MotionTask> =
        frames.iter().map(|f| frame(&robot, f, Task::POSE, &q).at_level(level(f))).collect();
    let mut masses = cylindroid::kinematics::MassMatrix::new(&robot);
    let state = robot.state(&q).unwrap();
    let mut jacobian = cylindroid::Matrix::zeros(3, robot.n());
    let target = masses.center_of_mass(&state, &mut jacobian).unwrap().1;
    let objective =
        TaskObjective::CenterOfMass { axes: [true, true, false], target, velocity: Vec3::ZERO };
    tasks.push(MotionTask::new("center", objective));
    tasks.push(MotionTask::new("posture", TaskObjective::Posture { q: q.clone() }));
    run(TaskServo::new(&robot, tasks, TaskServoOptions::new(&robot)).unwrap(), q, 0.03)
}

fn stewart_of_tasks() -> Stepper {
    let robot = catalogue::load("stewart").unwrap();
    let q = assemble(&robot, robot.home(), &[]).unwrap().q;
    let tasks = vec![frame(&robot, "platform", Task::POSE, &q)];
    run(TaskServo::new(&robot, tasks, TaskServoOptions::new(&robot)).unwrap(), q, 0.02)
}
