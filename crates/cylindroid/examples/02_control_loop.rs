//! A control loop as a robot's driver writes it: one call a cycle, nothing allocated.
#![allow(clippy::print_stdout)]

use cylindroid::control::{SecondaryTask, Status, Target};
use cylindroid::inverse::Method;
use cylindroid::{Servo, ServoOptions, Twist, Vec3};

fn main() -> cylindroid::Result<()> {
    let robot = cylindroid::load("panda")?;
    let options = ServoOptions {
        dt: 1e-3,
        method: Method::VariableDamping { onset: 0.05, damping: 0.02 },
        secondary: vec![SecondaryTask::LimitAvoidance { gain: 0.5, margin: 0.2 }],
        ..ServoOptions::new(&robot)
    };
    let mut servo = Servo::new(&robot, options)?;

    let mut q = robot.home().to_vec(); // from the robot's encoders
    let start = robot.state(&q)?.pose(robot.tool())?;
    let velocity = Vec3::new(0.0, 0.1, 0.0); // a conveyor, m/s
    for cycle in 0..2000 {
        let t = f64::from(cycle) * 1e-3;
        let mut pose = start;
        pose.translation += velocity * t;
        let feed_forward = Twist { linear: velocity, angular: Vec3::ZERO };
        let step = servo.step(&q, Target { pose, feed_forward })?;
        if step.status == Status::Stalled {
            println!("stalled at {t:.3} s: {:?}", servo.stall());
            break;
        }
        servo.advance(&mut q); // to the robot's motors: servo.joint_velocities()
        if cycle % 500 == 0 {
            println!("{t:.1} s: {:.2e} m behind", step.position_error);
        }
    }
    Ok(())
}
