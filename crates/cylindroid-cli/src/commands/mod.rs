//! One file per command: arguments in, text or JSON out, an exit code.

pub(crate) mod closed;
mod fk;
mod ik;
pub(crate) mod info;
mod jacobian;
mod models;
pub(crate) mod move_to;
pub(crate) mod screws;
mod target;
mod view;

use std::io::Write;
use std::process::ExitCode;

use cylindroid::model::Mechanism;
use cylindroid::{EndEffector, Error, Pose, Vec3};

use crate::args::{Cli, Command, ConfigurationArgs, FrameArgs};

/// How a command prints.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Style {
    Table,
    Json,
}

/// Runs the command of a command line.
pub(crate) fn run(cli: &Cli, out: &mut dyn Write) -> anyhow::Result<ExitCode> {
    let style = if cli.json { Style::Json } else { Style::Table };
    match &cli.command {
        Command::Models => models::run(style, out),
        Command::Info(args) => info::run(args, style, out),
        Command::Fk(args) => fk::run(args, style, out),
        Command::Jacobian(args) => jacobian::run(args, style, out),
        Command::Ik(args) => ik::run(args, style, out),
        Command::Move(args) => move_to::run(args, style, out),
        Command::Screws(args) => screws::run(args, style, out),
        Command::Assemble(args) => closed::assemble::run(args, style, out),
        Command::Mobility(args) => closed::mobility::run(args, style, out),
        Command::Manipulability(args) => closed::manipulability::run(args, style, out),
        Command::Statics(args) => closed::statics::run(args, style, out),
        Command::Grasp(args) => closed::grasp::run(args, style, out),
        Command::View(args) => view::run(args, style, out),
    }
}

/// Exit code of a yes (0) or a no (1).
fn answer(yes: bool) -> ExitCode {
    ExitCode::from(u8::from(!yes))
}

/// The model, driven by these joints where any are named.
fn load(model: &str, actuated: &[String]) -> cylindroid::Result<Mechanism> {
    let loaded = cylindroid::load(model)?;
    if actuated.is_empty() { Ok(loaded) } else { loaded.with_actuated(actuated) }
}

/// The configuration that is meant, of the right size and finite.
fn configuration(robot: &Mechanism, args: &ConfigurationArgs) -> cylindroid::Result<Vec<f64>> {
    let q = args.q.configuration(robot, args.degrees)?;
    robot.check_q("--q", &q)?;
    Ok(q)
}

/// Refuses a configuration outside the position limits.
pub(crate) fn within_limits(
    robot: &Mechanism,
    option: &'static str,
    q: &[f64],
) -> cylindroid::Result<()> {
    let Some(i) = robot.outside_limits(q).next() else { return Ok(()) };
    let c = &robot.coordinates()[i];
    let (lower, upper, unit) = (c.limits.lower, c.limits.upper, c.kind.unit());
    Err(Error::InvalidOption {
        option,
        value: format!("{} at {} {unit}", c.name, q[i]),
        reason: format!("its limits are {lower} and {upper} {unit}"),
    })
}

/// The frame and tool point that are meant.
fn end_effector(robot: &Mechanism, args: &FrameArgs) -> cylindroid::Result<EndEffector> {
    let frame = match &args.frame {
        None => robot.tool(),
        Some(name) => robot.frame(name)?,
    };
    let tool = args.tool.map_or([0.0; 3], |t| t.0);
    Error::check_finite("--tool", &tool)?;
    Ok(EndEffector { frame, frame_from_tool: Pose::from_translation(Vec3::from_array(tool)) })
}

/// Joints of trees are all driven.
fn all_driven(robot: &Mechanism) -> Error {
    Error::InvalidOption {
        option: "--actuated",
        value: robot.name().to_owned(),
        reason: format!(
            "'{}' has no loops or contacts, so all joints are driven; leave the option out",
            robot.name()
        ),
    }
}
