//! Drives the tool of a robot to a pose and says how it went: the library's shortest way.
//!
//! `cargo run --release -p cylindroid --example 01_move_to_a_pose -- path/to/robot.urdf`
#![allow(clippy::print_stdout)]

use cylindroid::control::{Target, simulate};
use cylindroid::{Pose, Servo, ServoOptions, Vec3};

fn main() -> cylindroid::Result<()> {
    let model = std::env::args().nth(1).unwrap_or_else(|| "panda".to_owned());
    let robot = cylindroid::load(&model)?;

    // Ten centimetres down from where the tool is at home.
    let start = robot.state(robot.home())?.pose(robot.tool())?;
    let target = Pose { translation: start.translation + Vec3::new(0.0, 0.0, -0.1), ..start };

    let mut servo = Servo::new(&robot, ServoOptions::new(&robot))?;
    let outcome =
        simulate(&mut servo, robot.home(), 10.0, |_| (Target::from(target), true), |_| {})?;

    println!("reached: {} after {:.3} s", outcome.reached, outcome.time);
    println!("position error: {:.1e} m", outcome.last.position_error);
    println!("smallest singular value ratio on the way: {:.3}", outcome.min_singular_ratio);
    if let Some(stall) = outcome.stall {
        println!("stalled: {stall:?}");
    }
    Ok(())
}
