//! Kernels at fixed inputs, for counting their instructions: `cargo xtask instructions`.
//!
//! `instructions KERNEL CALLS` calls one kernel so many times and prints nothing; the difference
//! between two counts is what calls cost without what comes before them. Without arguments it
//! prints the names.
#![allow(missing_docs, clippy::unwrap_used, clippy::print_stdout)]

use cylindroid::closure::{ClosedChain, Mobility};
use cylindroid::ik::{Goal, IkOptions, Solver};
use cylindroid::kinematics::{Chain, KinematicsBatch};
use cylindroid::linalg::Svd;
use cylindroid::manipulability::{BatchOptions, ManipulabilityBatch};
use cylindroid::{Matrix, Mechanism, Pose, ReferenceFrame, Servo, ServoOptions, Vec3, catalogue};
use std::hint::black_box;

/// Calls a kernel so many times.
type Kernel = fn(usize);

/// Names and kernels.
const KERNELS: [(&str, Kernel); 9] = [
    ("forward_panda", forward),
    ("jacobian_panda", jacobian),
    ("batch_of_1000_panda", batch),
    ("servo_step_panda", servo_step),
    ("svd_6x7_cold", svd_cold),
    ("svd_6x7_warm", svd_warm),
    ("ik_panda", inverse_kinematics),
    ("mobility_five_bar", mobility),
    ("batch_of_128_stewart", many),
];

fn main() {
    let words: Vec<String> = std::env::args().skip(1).filter(|a| !a.starts_with('-')).collect();
    let [name, calls] = &words[..] else {
        KERNELS.iter().for_each(|(name, _)| println!("{name}"));
        return;
    };
    let (_, kernel) = KERNELS.iter().find(|(known, _)| known == name).unwrap();
    kernel(calls.parse().unwrap());
}

fn panda() -> Mechanism {
    catalogue::load("panda").unwrap()
}

/// Home and a configuration near it in turn, so that nothing can be kept from call to call.
fn configuration(robot: &Mechanism, i: usize) -> Vec<f64> {
    robot.home().iter().map(|x| x + 1e-3 * (i % 2) as f64).collect()
}

fn forward(calls: usize) {
    let robot = panda();
    let mut chain = Chain::new(&robot, robot.tool()).unwrap();
    let q = [configuration(&robot, 0), configuration(&robot, 1)];
    for i in 0..calls {
        black_box(chain.set(black_box(&q[i % 2])));
    }
}

fn jacobian(calls: usize) {
    let robot = panda();
    let mut chain = Chain::new(&robot, robot.tool()).unwrap();
    let mut j = Matrix::zeros(6, chain.n());
    let q = [configuration(&robot, 0), configuration(&robot, 1)];
    for i in 0..calls {
        black_box(chain.set(black_box(&q[i % 2])));
        chain.jacobian_into(ReferenceFrame::LocalWorldAligned, &mut j);
        black_box(&j);
    }
}

/// Poses and Jacobians of 1000 configurations.
fn batch(calls: usize) {
    let robot = panda();
    let batch = KinematicsBatch::new(&robot, robot.tool()).unwrap();
    let (mut poses, mut jacobians) = (vec![0.0; 1000 * 16], vec![0.0; 1000 * 6 * robot.n()]);
    let q: Vec<f64> = (0..1000).flat_map(|i| configuration(&robot, i)).collect();
    for _ in 0..calls {
        let reference = ReferenceFrame::LocalWorldAligned;
        batch.poses_and_jacobians_into(&q, reference, &mut poses, &mut jacobians).unwrap();
        black_box((&poses, &jacobians));
    }
}

/// Towards a target 14 cm away, as a control loop would go.
fn servo_step(calls: usize) {
    let robot = panda();
    let mut servo = Servo::new(&robot, ServoOptions::new(&robot)).unwrap();
    let mut q = robot.home().to_vec();
    let start = robot.state(&q).unwrap().pose(robot.tool()).unwrap();
    let translation = start.translation + Vec3::new(0.0, 0.1, 0.1);
    for _ in 0..calls {
        black_box(servo.step(&q, Pose { translation, ..start }).unwrap());
        servo.advance(&mut q);
    }
}

fn near_jacobians() -> [Matrix; 2] {
    let robot = panda();
    [0, 1].map(|i| {
        let state = robot.state(&configuration(&robot, i)).unwrap();
        state.jacobian(robot.tool(), ReferenceFrame::LocalWorldAligned).unwrap()
    })
}

fn svd_cold(calls: usize) {
    let j = near_jacobians();
    let mut svd = Svd::workspace(6, 7);
    for i in 0..calls {
        svd.decompose(black_box(&j[i % 2]));
        black_box(svd.value(0));
    }
}

fn svd_warm(calls: usize) {
    let j = near_jacobians();
    let mut svd = Svd::workspace(6, 7);
    for i in 0..calls {
        svd.decompose_warm(black_box(&j[i % 2]));
        black_box(svd.value(0));
    }
}

/// From home to one pose far from it, to 1e-5.
fn inverse_kinematics(calls: usize) {
    let robot = panda();
    let target =
        robot.state(&[1.1, -0.4, 0.6, -1.7, 0.9, 2.2, -0.5]).unwrap().pose(robot.tool()).unwrap();
    let goal = [Goal::pose(robot.tool(), target)];
    let options =
        IkOptions { position_tolerance: 1e-5, orientation_tolerance: 1e-5, ..IkOptions::default() };
    let mut solver = Solver::new(&robot, &goal, &options).unwrap();
    for _ in 0..calls {
        assert!(black_box(solver.solve(black_box(&goal)).unwrap()).success);
    }
}

/// Mobility and manipulability of 128 configurations near home, as numbers.
fn many(calls: usize) {
    let platform = catalogue::load("stewart").unwrap();
    let batch = ManipulabilityBatch::new(&platform, &BatchOptions::default()).unwrap();
    let q: Vec<f64> = (0..128).flat_map(|i| configuration(&platform, i)).collect();
    let mut out = vec![0.0; 128 * ManipulabilityBatch::WIDTH];
    for _ in 0..calls {
        batch.analyse_into(black_box(&q), &mut out).unwrap();
        black_box(&out);
    }
}

/// From joint positions to the mobility of the linkage.
fn mobility(calls: usize) {
    let linkage = catalogue::load("five-bar").unwrap();
    let mut state = linkage.state(linkage.home()).unwrap();
    for _ in 0..calls {
        state.set(black_box(linkage.home())).unwrap();
        let chain = ClosedChain::of(&state, None, None).unwrap();
        black_box(Mobility::of(&chain.constraint));
    }
}
