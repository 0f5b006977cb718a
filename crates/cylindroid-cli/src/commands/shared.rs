//! Shared by the commands: output style, model, configuration and frame.

use cylindroid::model::Mechanism;
use cylindroid::model::formats::srdf;
use cylindroid::model::formats::toml::with_limits_of_file;
use cylindroid::tolerance::MAX_MAGNITUDE;
use cylindroid::{EndEffector, Error, ParametricModel, Pose, Vec3};

use crate::args::{ConfigurationArgs, FrameArgs, LimitsArgs, ModelArgs};
use crate::values::Assignment;

/// Output style of a command.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Style {
    Table,
    Json,
}

/// Loads the model, with these joints actuated if any are named.
pub(crate) fn load(model: &ModelArgs, actuated: &[String]) -> cylindroid::Result<Mechanism> {
    let values: Vec<(&str, f64)> = model.parameter.iter().map(Assignment::pair).collect();
    let mut loaded = cylindroid::load_with_parameters(&model.name, &values)?;
    // Read even if nothing of it is needed, so that its faults are seen.
    let srdf = model.srdf.as_deref().map(srdf::load).transpose()?;
    if let (Some(srdf), Some(group)) = (srdf, &model.group) {
        loaded = srdf.group(group, &loaded, loaded.home())?;
    }
    if actuated.is_empty() { Ok(loaded) } else { loaded.with_actuated(actuated) }
}

/// The mechanism file of the model, for other values of its parameters.
pub(crate) fn parametric(model: &ModelArgs) -> cylindroid::Result<ParametricModel> {
    if let Some(group) = &model.group {
        return Err(Error::InvalidOption {
            option: "--group",
            value: group.clone(),
            reason: "the other joints rest at the home of one design; omit it where designs vary"
                .to_owned(),
        });
    }
    model.srdf.as_deref().map(srdf::load).transpose()?;
    let values: Vec<(&str, f64)> = model.parameter.iter().map(Assignment::pair).collect();
    ParametricModel::read(&model.name, &values)
}

/// Refuses a value of --parameter for one that varies, which would be ignored.
pub(crate) fn check_varied(
    model: &ModelArgs,
    varied: impl IntoIterator<Item: AsRef<str>>,
) -> cylindroid::Result<()> {
    let is_given = |name: &str| model.parameter.iter().any(|given| given.pair().0 == name);
    match varied.into_iter().find(|name| is_given(name.as_ref())) {
        None => Ok(()),
        Some(name) => Err(Error::InvalidOption {
            option: "--parameter",
            value: name.as_ref().to_owned(),
            reason: "a parameter has a value or varies; leave it out here, or in --vary and --over"
                .to_owned(),
        }),
    }
}

/// The model with the limits of a file, if one is named.
pub(crate) fn limited(robot: Mechanism, args: &LimitsArgs) -> cylindroid::Result<Mechanism> {
    match &args.limits {
        None => Ok(robot),
        Some(file) => with_limits_of_file(&robot, file),
    }
}

/// The configuration of the arguments; its size and values are checked.
pub(crate) fn configuration(
    robot: &Mechanism,
    args: &ConfigurationArgs,
) -> cylindroid::Result<Vec<f64>> {
    let q = args.q.configuration(robot, args.model.srdf.as_deref(), args.degrees)?;
    robot.check_q("--q", &q)?;
    Ok(q)
}

/// Rejects a configuration outside the position limits.
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

/// The frame and tool point of the arguments.
pub(crate) fn end_effector(robot: &Mechanism, args: &FrameArgs) -> cylindroid::Result<EndEffector> {
    let frame = match &args.frame {
        None => robot.tool(),
        Some(name) => robot.frame(name)?,
    };
    let tool = args.tool.map_or([0.0; 3], |t| t.0);
    Error::check_within("--tool", &tool, MAX_MAGNITUDE)?;
    Ok(EndEffector { frame, frame_from_tool: Pose::from_translation(Vec3::from_array(tool)) })
}

/// The same, by default the reference of a closed chain.
pub(crate) fn reference_or_tool(
    robot: &Mechanism,
    args: &FrameArgs,
) -> cylindroid::Result<EndEffector> {
    let end_effector = end_effector(robot, args)?;
    if args.frame.is_none() && robot.is_closed() {
        return Ok(EndEffector { frame: robot.reference(), ..end_effector });
    }
    Ok(end_effector)
}

/// The error for `--actuated` with a tree, whose joints are all actuated.
pub(crate) fn all_actuated(robot: &Mechanism) -> Error {
    Error::InvalidOption {
        option: "--actuated",
        value: robot.name().to_owned(),
        reason: format!(
            "'{}' has no loops or contacts, so all joints are actuated; omit --actuated",
            robot.name()
        ),
    }
}
