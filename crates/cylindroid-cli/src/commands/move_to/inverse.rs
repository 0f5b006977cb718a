//! From `--inverse` and its parameters to the options of the servo.

use cylindroid::control::TaskProjection;
use cylindroid::model::Mechanism;
use cylindroid::{Method, Result, ServoOptions};

use crate::args::InverseArgs;
use crate::commands::inverse_selection::{as_typed, check_pitch, selection};

/// Sets method, projection and fallback.
pub(crate) fn apply(
    args: &InverseArgs,
    start: &[f64],
    robot: &Mechanism,
    options: &mut ServoOptions,
) -> Result<()> {
    let fallback = args.fallback.as_deref();
    let state = robot.state(start)?;
    let tool = (&state, options.end_effector, options.length);
    check_pitch(&args.named, fallback, "at the start", tool)?;
    selection(&args.named, fallback).apply(options).map_err(as_typed)
}

/// The name of the inverse that the options mean, as it was asked for.
pub(super) fn name(projection: &TaskProjection, method: &Method) -> &'static str {
    match projection {
        TaskProjection::Orthogonal => method.name(),
        _ => projection.name(),
    }
}
