//! A hard real-time loop at 1 kHz: real-time scheduling and locked memory where the system permits
//! them, absolute deadlines, nothing allocated; at the end the worst times, in microseconds.
//! `cargo run --release -p cylindroid --example 05_real_time_loop -- 60` runs it for a minute (ten seconds without a
//! number). `real_time/mod.rs` has the deadlines; `cargo bench -p cylindroid --bench jitter -- --deadlines 60` runs
//! other servos in the same loop.
#![allow(clippy::print_stdout)]

mod real_time;

use std::time::{Duration, Instant};

use cylindroid::{Servo, ServoOptions, Twist, Vec3, control::Target};

const PERIOD: Duration = Duration::from_millis(1);

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let seconds: u32 = std::env::args().nth(1).map_or(Ok(10), |n| n.parse())?;
    real_time::become_real_time();
    control(seconds)?.print();
    Ok(())
}

/// Follows a circle.
fn control(seconds: u32) -> cylindroid::Result<real_time::Times> {
    let robot = cylindroid::load("panda")?;
    let options = ServoOptions { dt: PERIOD.as_secs_f64(), ..ServoOptions::new(&robot) };
    let mut servo = Servo::new(&robot, options)?;
    let mut q = robot.home().to_vec();
    let start = robot.state(&q)?.pose(robot.tool())?;
    servo.step(&q, start)?;
    servo.reset();

    real_time::at_deadlines(PERIOD, seconds as usize * 1000, |cycle| {
        let began = Instant::now();
        let (sin, cos) = (cycle as f64 * 1e-3 * 2.0).sin_cos();
        let mut target = Target::from(start);
        target.pose.translation += Vec3::new(0.0, sin, cos - 1.0) * 0.05;
        let linear = Vec3::new(0.0, cos, -sin) * 0.1;
        target.feed_forward = Twist { linear, angular: Vec3::ZERO };
        servo.step(&q, target)?; // from the robot's encoders: q
        let step = began.elapsed();
        servo.advance(&mut q); // to the robot's motors: servo.joint_velocities()
        Ok(step)
    })
}
