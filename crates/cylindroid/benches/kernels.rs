//! How long the parts of a control step take: `cargo bench -p cylindroid`.
#![allow(missing_docs, clippy::unwrap_used)]

use std::f64::consts::PI;

use cylindroid::closure::{
    ClosedChain, Constraint, ConstraintBlocks, Mobility, MotionSpace, assemble,
};
use cylindroid::ik::{Analytic, Goal, IkOptions, Solver};
use cylindroid::inverse::{self, Method};
use cylindroid::kinematics::{Chain, KinematicsBatch};
use cylindroid::linalg::Svd;
use cylindroid::manipulability::{BatchOptions, Manipulability, ManipulabilityBatch, Metrics};
use cylindroid::model::Coordinate;
use cylindroid::screws::{ScrewOptions, ScrewSystem};
use cylindroid::{Matrix, Mechanism, Pose, ReferenceFrame, Servo, ServoOptions, catalogue};
use divan::counter::ItemsCount;
use divan::{Bencher, black_box};

fn main() {
    divan::main();
}

const ROBOTS: [&str; 3] = ["panda", "ur5e", "youbot"];

fn robot(name: &str) -> Mechanism {
    catalogue::load(name).unwrap()
}

/// Home and a pose near it, alternating so that nothing can be kept from call to call.
fn poses(robot: &Mechanism) -> [Vec<f64>; 2] {
    let home = robot.home().to_vec();
    let near = home.iter().map(|x| x + 1e-3).collect();
    [home, near]
}

#[divan::bench(args = ROBOTS)]
fn forward_kinematics(bencher: Bencher<'_, '_>, name: &str) {
    let robot = robot(name);
    let mut chain = Chain::new(&robot, robot.tool()).unwrap();
    let q = poses(&robot);
    let mut i = 0;
    bencher.bench_local(|| {
        i ^= 1;
        black_box(chain.set(black_box(&q[i])))
    });
}

#[divan::bench(args = ROBOTS)]
fn forward_kinematics_and_jacobian(bencher: Bencher<'_, '_>, name: &str) {
    let robot = robot(name);
    let mut chain = Chain::new(&robot, robot.tool()).unwrap();
    let mut j = Matrix::zeros(6, chain.n());
    let q = poses(&robot);
    let mut i = 0;
    bencher.bench_local(|| {
        i ^= 1;
        chain.set(black_box(&q[i]));
        chain.jacobian_into(ReferenceFrame::LocalWorldAligned, &mut j);
        black_box(&j);
    });
}

/// Poses and Jacobians of 100 000 configurations on one thread, into memory that is there; the time
/// is that of one configuration.
#[divan::bench(args = ROBOTS)]
fn batch_of_jacobians(bencher: Bencher<'_, '_>, name: &str) {
    const COUNT: usize = 100_000;
    let robot = robot(name);
    let batch = KinematicsBatch::new(&robot, robot.tool()).unwrap();
    let n = robot.n();
    let q: Vec<f64> = (0..COUNT * n).map(|i| (i * 7919 % 6283) as f64 * 1e-3 - 3.1).collect();
    let mut poses = vec![0.0; COUNT * 16];
    let mut jacobians = vec![0.0; COUNT * 6 * n];
    let alone = rayon::ThreadPoolBuilder::new().num_threads(1).build().unwrap();
    bencher.counter(ItemsCount::new(COUNT)).bench_local(|| {
        alone.install(|| {
            let reference = ReferenceFrame::LocalWorldAligned;
            batch.poses_and_jacobians_into(&q, reference, &mut poses, &mut jacobians).unwrap();
        });
    });
}

/// The whole tree through the checked interface.
#[divan::bench(args = ROBOTS)]
fn state_and_jacobian(bencher: Bencher<'_, '_>, name: &str) {
    let robot = robot(name);
    let mut state = robot.state(robot.home()).unwrap();
    let mut j = Matrix::zeros(6, robot.n());
    let q = poses(&robot);
    let mut i = 0;
    bencher.bench_local(|| {
        i ^= 1;
        state.set(black_box(&q[i])).unwrap();
        state.jacobian_into(robot.tool(), ReferenceFrame::LocalWorldAligned, &mut j).unwrap();
        black_box(&j);
    });
}

#[divan::bench]
fn hessian_panda(bencher: Bencher<'_, '_>) {
    let robot = robot("panda");
    let mut chain = Chain::new(&robot, robot.tool()).unwrap();
    chain.set(robot.home());
    let mut h = vec![Matrix::zeros(6, 7); 7];
    bencher.bench_local(|| {
        chain.hessian_into(ReferenceFrame::LocalWorldAligned, &mut h);
        black_box(&h);
    });
}

fn panda_jacobian() -> Matrix {
    let robot = robot("panda");
    robot
        .state(robot.home())
        .unwrap()
        .jacobian(robot.tool(), ReferenceFrame::LocalWorldAligned)
        .unwrap()
}

#[divan::bench]
fn svd_6x7_cold(bencher: Bencher<'_, '_>) {
    let j = panda_jacobian();
    let mut svd = Svd::workspace(6, 7);
    bencher.bench_local(|| {
        svd.decompose(black_box(&j));
        black_box(svd.value(0))
    });
}

#[divan::bench]
fn svd_6x7_warm(bencher: Bencher<'_, '_>) {
    let j = panda_jacobian();
    let mut near = j.clone();
    near[(0, 0)] += 1e-4;
    let mut svd = Svd::workspace(6, 7);
    let mut i = 0;
    bencher.bench_local(|| {
        i ^= 1;
        svd.decompose_warm(black_box(if i == 0 { &j } else { &near }));
        black_box(svd.value(0))
    });
}

/// With the report, which allocates.
#[divan::bench(args = Method::ALL.map(|m| m.name()))]
fn inverse_6x7(bencher: Bencher<'_, '_>, name: &str) {
    let j = panda_jacobian();
    let method = Method::named(name).unwrap();
    bencher.bench_local(|| black_box(method.inverse(black_box(&j)).unwrap()));
}

/// Inverses of 10 000 Jacobians of a panda on one thread; the time is that of one.
#[divan::bench(args = Method::ALL.map(|m| m.name()))]
fn batch_of_inverses_6x7(bencher: Bencher<'_, '_>, name: &str) {
    const COUNT: usize = 10_000;
    let robot = robot("panda");
    let n = robot.n();
    let q: Vec<f64> = (0..COUNT * n).map(|i| (i * 7919 % 6283) as f64 * 1e-3 - 3.1).collect();
    let jacobians = KinematicsBatch::new(&robot, robot.tool())
        .unwrap()
        .jacobians(&q, ReferenceFrame::LocalWorldAligned)
        .unwrap();
    let batch = inverse::InverseBatch::new(Method::named(name).unwrap(), 6, n).unwrap();
    let alone = rayon::ThreadPoolBuilder::new().num_threads(1).build().unwrap();
    bencher.counter(ItemsCount::new(COUNT)).bench_local(|| {
        alone.install(|| black_box(batch.inverses(black_box(&jacobians)).unwrap()))
    });
}

/// Kinematics, Jacobian, inverse, null space, limits: a whole step along a motion of 20 cm.
#[divan::bench(args = Method::ALL.map(|m| m.name()))]
fn servo_step_panda(bencher: Bencher<'_, '_>, name: &str) {
    servo_step(bencher, "panda", name);
}

#[divan::bench(args = ["truncated"])]
fn servo_step_ur5e(bencher: Bencher<'_, '_>, name: &str) {
    servo_step(bencher, "ur5e", name);
}

fn servo_step(bencher: Bencher<'_, '_>, robot_name: &str, method: &str) {
    let robot = robot(robot_name);
    let options =
        ServoOptions { method: Method::named(method).unwrap(), ..ServoOptions::new(&robot) };
    let mut servo = Servo::new(&robot, options).unwrap();
    let start = robot.state(robot.home()).unwrap().pose(robot.tool()).unwrap();
    let target = |dz: f64| Pose {
        translation: start.translation + cylindroid::Vec3::new(0.0, 0.1, dz),
        ..start
    };
    let targets = [target(-0.1), target(0.1)];
    let mut q = robot.home().to_vec();
    let mut step = 0_usize;
    bencher.bench_local(|| {
        step += 1;
        let done = servo.step(&q, targets[(step / 500) & 1]).unwrap();
        servo.advance(&mut q);
        black_box(done)
    });
}

/// Twists of a three-joint and a five-joint arm, and of nothing in particular.
fn jacobians() -> [(Matrix, &'static str); 2] {
    let of = |name: &str, q: &[f64]| {
        let robot = robot(name);
        robot.state(q).unwrap().jacobian(robot.tool(), ReferenceFrame::World).unwrap()
    };
    [(of("3r", &[0.3, 0.5, -1.1]), "3r"), (of("youbot", &[0.4, 0.6, 0.9, 0.5, 0.2]), "youbot")]
}

/// Class, pitches, frame and margins from nothing.
#[divan::bench(args = ["3r", "youbot"])]
fn screw_system(bencher: Bencher<'_, '_>, name: &str) {
    let (j, _) = jacobians().into_iter().find(|j| j.1 == name).unwrap();
    let options = ScrewOptions::with_length(0.7);
    bencher.bench_local(|| {
        let system = ScrewSystem::of_columns(black_box(&j), &options).unwrap();
        black_box((system.class(), system.principal_pitches()))
    });
}

/// In a control loop: no report, no allocation.
#[divan::bench(args = ["3r", "youbot"])]
fn hyperbolic_inverse(bencher: Bencher<'_, '_>, name: &str) {
    let (j, _) = jacobians().into_iter().find(|j| j.1 == name).unwrap();
    let scale = ScrewOptions::with_length(0.7);
    let mut out = Matrix::zeros(j.cols(), 6);
    bencher.bench_local(|| {
        let none = inverse::hyperbolic_into(black_box(&j), 0.1, &scale, &mut out).unwrap();
        black_box((none.is_none(), &out));
    });
}

/// With its report.
#[divan::bench(args = ["3r", "youbot"])]
fn hyperbolic_inverse_with_report(bencher: Bencher<'_, '_>, name: &str) {
    let (j, _) = jacobians().into_iter().find(|j| j.1 == name).unwrap();
    bencher.bench_local(|| black_box(inverse::hyperbolic(black_box(&j), 0.1).unwrap()));
}

/// Closed chains by name and size: constraint rows, actuated joints, passive columns, object.
const CHAINS: [(&str, [usize; 4]); 3] =
    [("five-bar", [6, 2, 3, 3]), ("stewart", [18, 6, 12, 6]), ("two-arm", [12, 14, 0, 6])];

/// A constraint as large as that of the named mechanism, limb after limb, entries of size one.
fn chain(name: &str) -> Constraint {
    let [t, a, p, d] = CHAINS.iter().find(|c| c.0 == name).unwrap().1;
    let limbs = if name == "stewart" { 6 } else { 2 };
    let entry = |i: usize, j: usize| ((1 + i * 31 + j * 17 + i * j * 7) as f64).sin();
    let limb = |i: usize, of: usize| i * limbs / of.max(1);
    let joints = |n: usize, salt: usize| {
        Matrix::from_fn(
            t,
            n,
            |i, j| {
                if limb(i, t) == limb(j, n) { entry(i, j + salt) } else { 0.0 }
            },
        )
    };
    Constraint::new(ConstraintBlocks {
        actuated: joints(a, 0),
        passive: joints(p, 40),
        grasp: Matrix::from_fn(d, t, |i, j| entry(j, i + 80)),
    })
    .unwrap()
}

#[divan::bench(args = CHAINS.map(|c| c.0))]
fn closed_chain_relation(bencher: Bencher<'_, '_>, name: &str) {
    let constraint = chain(name);
    bencher.bench_local(|| black_box(MotionSpace::of(black_box(&constraint)).relation()));
}

#[divan::bench(args = CHAINS.map(|c| c.0))]
fn closed_chain_mobility(bencher: Bencher<'_, '_>, name: &str) {
    let constraint = chain(name);
    bencher.bench_local(|| black_box(Mobility::of(black_box(&constraint))));
}

#[divan::bench(args = CHAINS.map(|c| c.0))]
fn closed_chain_manipulability(bencher: Bencher<'_, '_>, name: &str) {
    let relation = MotionSpace::of(&chain(name)).relation();
    bencher.bench_local(|| {
        black_box(Manipulability::of(black_box(&relation), &Metrics::UNIT).unwrap())
    });
}

/// Mechanisms of the catalogue with loops and contacts.
const MECHANISMS: [&str; 3] = ["five-bar", "stewart", "two-arm"];

/// From joint positions to the constraint.
#[divan::bench(args = MECHANISMS)]
fn mechanism_constraint(bencher: Bencher<'_, '_>, name: &str) {
    let mechanism = robot(name);
    let mut state = mechanism.state(mechanism.home()).unwrap();
    bencher.bench_local(|| {
        state.set(black_box(mechanism.home())).unwrap();
        black_box(ClosedChain::of(&state, None, None).unwrap())
    });
}

/// From the constraint to the mobility report and the three spectra.
#[divan::bench(args = MECHANISMS)]
fn mechanism_report(bencher: Bencher<'_, '_>, name: &str) {
    let mechanism = robot(name);
    let state = mechanism.state(mechanism.home()).unwrap();
    let constraint = ClosedChain::of(&state, None, None).unwrap().constraint;
    bencher.bench_local(|| black_box(report(black_box(&constraint))));
}

/// All of it, from joint positions.
#[divan::bench(args = MECHANISMS)]
fn mechanism_mobility_and_manipulability(bencher: Bencher<'_, '_>, name: &str) {
    let mechanism = robot(name);
    let mut state = mechanism.state(mechanism.home()).unwrap();
    bencher.bench_local(|| {
        state.set(black_box(mechanism.home())).unwrap();
        let chain = ClosedChain::of(&state, None, None).unwrap();
        black_box(report(&chain.constraint))
    });
}

fn report(constraint: &Constraint) -> (Mobility, Manipulability) {
    let motions = MotionSpace::of(constraint);
    let relation = motions.relation();
    let mobility = Mobility::from_parts(constraint, &motions, &relation);
    (mobility, Manipulability::of(&relation, &Metrics::UNIT).unwrap())
}

/// The numbers of both for 4096 configurations around home on one thread, into memory that is
/// there; the time is that of one configuration.
#[divan::bench(args = MECHANISMS)]
fn batch_of_mobility_and_manipulability(bencher: Bencher<'_, '_>, name: &str) {
    const COUNT: usize = 4096;
    let mechanism = robot(name);
    let batch = ManipulabilityBatch::new(&mechanism, &BatchOptions::default()).unwrap();
    // As many closed configurations as are found quickly, repeated.
    let mut closed = Vec::new();
    for i in 0..64 {
        let guess: Vec<f64> =
            (0..mechanism.n()).map(|j| mechanism.home()[j] + 0.2 * drift(i * 31 + j)).collect();
        closed.extend(assemble(&mechanism, &guess, &[]).unwrap().q);
    }
    let q = closed.repeat(COUNT / 64);
    let mut out = vec![0.0; COUNT * ManipulabilityBatch::WIDTH];
    let alone = rayon::ThreadPoolBuilder::new().num_threads(1).build().unwrap();
    bencher.counter(ItemsCount::new(COUNT)).bench_local(|| {
        alone.install(|| batch.analyse_into(black_box(&q), &mut out).unwrap());
    });
}

/// In [-1, 1], without pattern.
fn drift(i: usize) -> f64 {
    (i as f64 * 12.9898).sin()
}

/// A step of a servo that moves the object of a closed chain.
#[divan::bench(args = ["five-bar", "stewart", "two-arm"])]
fn object_servo_step(bencher: Bencher<'_, '_>, name: &str) {
    let mechanism = robot(name);
    let mut servo = Servo::new(&mechanism, ServoOptions::new(&mechanism)).unwrap();
    let q = assemble(&mechanism, mechanism.home(), &[]).unwrap().q;
    let here = mechanism.state(&q).unwrap().pose(mechanism.reference()).unwrap();
    let mut i = 0.0;
    bencher.bench_local(|| {
        i = 1.0 - i;
        let mut target = here;
        target.translation.x += 1e-3 * i;
        black_box(servo.step(&q, target).unwrap());
    });
}

/// Configurations drawn within the limits, or half a turn where they are wider.
fn drawn(robot: &Mechanism) -> impl FnMut() -> Vec<f64> + '_ {
    let mut state = 9_u64;
    let mut one = move |c: &Coordinate| {
        state =
            state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        let share = (state >> 11) as f64 / (1_u64 << 53) as f64;
        let (lower, upper) = (c.limits.lower.max(-PI), c.limits.upper.min(PI));
        lower + (upper - lower) * share
    };
    move || robot.coordinates().iter().map(&mut one).collect()
}

/// All answers for random reachable targets by formulas, in turn.
#[divan::bench(args = ["ur5e", "puma560"], sample_count = 2000)]
fn inverse_kinematics_by_formulas(bencher: Bencher<'_, '_>, name: &str) {
    let robot = robot(name);
    let mut draw = drawn(&robot);
    let tasks: Vec<(Vec<f64>, Pose)> = (0..2000)
        .map(|_| (draw(), robot.state(&draw()).unwrap().pose(robot.tool()).unwrap()))
        .collect();
    let mut ik = Analytic::of(&robot, robot.tool()).unwrap();
    let mut i = 0;
    bencher.bench_local(|| {
        i = (i + 1) % tasks.len();
        black_box(ik.solve(tasks[i].1, &tasks[i].0).unwrap())
    });
}

/// Random reachable targets to 1e-5 from random starts, in turn.
#[divan::bench(args = ["panda", "ur5e", "iiwa14", "puma560"], sample_count = 2000)]
fn inverse_kinematics(bencher: Bencher<'_, '_>, name: &str) {
    let robot = robot(name);
    let mut draw = drawn(&robot);
    let tasks: Vec<(Vec<f64>, Goal)> = (0..2000)
        .map(|_| {
            let target = robot.state(&draw()).unwrap().pose(robot.tool()).unwrap();
            (draw(), Goal::pose(robot.tool(), target))
        })
        .collect();
    let options =
        IkOptions { position_tolerance: 1e-5, orientation_tolerance: 1e-5, ..IkOptions::default() };
    let mut solver = Solver::new(&robot, &[tasks[0].1], &options).unwrap();
    let mut i = 0;
    bencher.bench_local(|| {
        i = (i + 1) % tasks.len();
        solver.set_initial_guess(&tasks[i].0).unwrap();
        let found = solver.solve(&[tasks[i].1]).unwrap();
        assert!(found.success);
        black_box(found)
    });
}
