//! The binary `cylindroid-ros2`: parses, runs the node, returns the exit code.
#![allow(clippy::print_stderr)] // it talks to a person

use std::path::PathBuf;
use std::process::ExitCode;

use clap::Parser;
use cylindroid_ros2::node;
use cylindroid_ros2::parameters::Parameters;

const EXAMPLES: &str = "\
Examples:
  cylindroid-ros2 panda --interface lo --domain 7
  cylindroid-ros2 arm.urdf --frame tool0 --command velocities --rate 500
  cylindroid-ros2 --file servo.toml        (the robot from the topic robot_description)

Every option is also a key of the file (with _ for -), which the command line overrides. Exit \
codes: 0 after Ctrl-C, 2 an error.";

/// A ROS 2 node that follows poses and twists with the tool of a robot, within the limits of all
/// joints.
///
/// It reads joint states and publishes commands for ros2_control; topics, messages and the watchdog
/// are those of MoveIt Servo. SI units and radians.
#[derive(Debug, Parser)]
#[command(name = "cylindroid-ros2", version, after_help = EXAMPLES, max_term_width = 100)]
struct Cli {
    #[command(flatten)]
    parameters: Parameters,

    /// A TOML file of parameters
    #[arg(long, value_name = "FILE")]
    file: Option<PathBuf>,
}

fn main() -> ExitCode {
    let cli = Cli::parse();
    match cli.parameters.over_file(cli.file.as_deref()).and_then(|p| node::run(&p.config()?)) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {error:#}");
            ExitCode::from(2)
        }
    }
}
