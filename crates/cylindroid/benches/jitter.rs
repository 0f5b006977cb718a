//! How long a servo step takes, step by step: `cargo bench -p cylindroid --bench jitter`.
//!
//! A million steps in which the arm follows a target round a circle through the middle of its
//! workspace, each timed by itself: away from its limits with what it does besides, as in `move`, and
//! with nothing besides, which lets the redundant panda drift from round to round until a joint
//! stands at its limit and the motion is bent round it. What another program or the kernel takes away is in the largest times.
#![allow(missing_docs, clippy::unwrap_used)]

use std::time::Instant;

use cylindroid::{Pose, Servo, ServoOptions, Vec3, catalogue};

const STEPS: usize = 1_000_000;
/// Steps of a round.
const ROUND: f64 = 4_000.0;

fn main() {
    println!("ns a servo step, {STEPS} steps: median, 99.9 %, largest");
    for (name, besides) in [("panda", true), ("panda", false), ("ur5e", false)] {
        let robot = catalogue::load(name).unwrap();
        let mut options = ServoOptions::new(&robot);
        if besides {
            options.secondary = options.default_secondary(&robot).unwrap();
        }
        let mut servo = Servo::new(&robot, options).unwrap();
        let start = robot.state(robot.home()).unwrap().pose(robot.tool());
        let mut q = robot.home().to_vec();
        let mut times = Vec::with_capacity(STEPS);
        for step in 0..STEPS {
            let (sin, cos) = (step as f64 / ROUND * std::f64::consts::TAU).sin_cos();
            let translation = start.translation + Vec3::new(0.0, 0.1 * sin, 0.1 * cos - 0.1);
            let target = Pose { translation, ..start };
            let began = Instant::now();
            servo.step(&q, target).unwrap();
            times.push(began.elapsed().as_nanos());
            servo.advance(&mut q);
        }
        times.sort_unstable();
        println!(
            "{name:8}{:8}{:8}{:8}{}",
            times[STEPS / 2],
            times[STEPS / 1000 * 999],
            times[STEPS - 1],
            if besides { "  away from limits" } else { "" }
        );
    }
}
