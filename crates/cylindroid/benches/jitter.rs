//! Times of single servo steps: `cargo bench -p cylindroid --bench jitter`.
//!
//! A million steps in which the arm follows a target around a circle through the middle of its
//! workspace, each timed separately: with the default secondary tasks, as in `move`, and with none,
//! which lets the redundant panda drift from round to round until a joint reaches its limit and the
//! direction of the motion is changed. Interruptions by other programs or the kernel show in the
//! largest times.
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
