//! What the commands share: style and exit code, the model, its configuration and its frame.

use std::process::ExitCode;

use cylindroid::model::Mechanism;
use cylindroid::{EndEffector, Error, Pose, Vec3};

use crate::args::{ConfigurationArgs, FrameArgs};

/// How a command prints.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Style {
    Table,
    Json,
}

/// Exit code of a yes (0) or a no (1).
pub(crate) fn answer(yes: bool) -> ExitCode {
    ExitCode::from(u8::from(!yes))
}

/// The model, driven by these joints where any are named.
pub(crate) fn load(model: &str, actuated: &[String]) -> cylindroid::Result<Mechanism> {
    let loaded = cylindroid::load(model)?;
    if actuated.is_empty() { Ok(loaded) } else { loaded.with_actuated(actuated) }
}

/// The configuration that is meant, of the right size and finite.
pub(crate) fn configuration(
    robot: &Mechanism,
    args: &ConfigurationArgs,
) -> cylindroid::Result<Vec<f64>> {
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
pub(crate) fn end_effector(robot: &Mechanism, args: &FrameArgs) -> cylindroid::Result<EndEffector> {
    let frame = match &args.frame {
        None => robot.tool(),
        Some(name) => robot.frame(name)?,
    };
    let tool = args.tool.map_or([0.0; 3], |t| t.0);
    Error::check_finite("--tool", &tool)?;
    Ok(EndEffector { frame, frame_from_tool: Pose::from_translation(Vec3::from_array(tool)) })
}

/// Joints of trees are all driven.
pub(crate) fn all_driven(robot: &Mechanism) -> Error {
    Error::InvalidOption {
        option: "--actuated",
        value: robot.name().to_owned(),
        reason: format!(
            "'{}' has no loops or contacts, so all joints are driven; leave the option out",
            robot.name()
        ),
    }
}
