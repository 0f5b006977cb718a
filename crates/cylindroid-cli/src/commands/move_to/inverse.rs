//! From `--inverse` and its parameters to the options of the servo.

use cylindroid::control::{InverseSelection, NamedInverse, TaskProjection};
use cylindroid::model::Mechanism;
use cylindroid::screws::{ScrewOptions, ScrewSystem};
use cylindroid::{Error, Method, ReferenceFrame, Result, ServoOptions, Twist};

use crate::args::{InverseArgs, inverses};
use crate::output::number;

/// Sets method, projection and fallback.
pub(crate) fn apply(
    args: &InverseArgs,
    start: &[f64],
    robot: &Mechanism,
    options: &mut ServoOptions,
) -> Result<()> {
    let given = &args.parameters.0;
    if let Some(name) = lacks_pitch(args) {
        return Err(missing_pitch(name, start, robot, options));
    }
    let selection = InverseSelection {
        name: &args.inverse,
        parameters: given.iter().map(|(name, value)| (*name, *value)).collect(),
        complement: args.give_up.iter().map(|m| Twist::from_array(m.0)).collect(),
        fallback: args.fallback.as_deref(),
    };
    selection.apply(options).map_err(as_typed)
}

/// The name of the inverse that the options mean, as it was asked for.
pub(super) fn name(projection: &TaskProjection, method: &Method) -> &'static str {
    match projection {
        TaskProjection::Orthogonal => method.name(),
        _ => projection.name(),
    }
}

/// The inverse, or its fallback, that needs `--h` where none was given.
fn lacks_pitch(args: &InverseArgs) -> Option<&str> {
    if args.parameters.0.contains_key("h") {
        return None;
    }
    let needs_it = |name: &&str| {
        let mut found = NamedInverse::all().filter(|i| i.name == *name);
        found.any(|i| i.parameters.iter().any(|p| p.name == "h"))
    };
    [Some(args.inverse.as_str()), args.fallback.as_deref()].into_iter().flatten().find(needs_it)
}

/// Names options as they are typed.
fn as_typed(error: Error) -> Error {
    match error {
        Error::InvalidOption { option, value, reason } => {
            let option = match option {
                "give_up" => "--give-up",
                "fallback" => "--fallback",
                name => inverses::option(name).unwrap_or(name),
            };
            Error::InvalidOption { option, value, reason }
        }
        other => other,
    }
}

/// `--h` has no default, since it is a real choice; but there is advice.
fn missing_pitch(name: &str, start: &[f64], robot: &Mechanism, options: &ServoOptions) -> Error {
    let advice = || -> Result<String> {
        let j = robot.state(start)?.jacobian(options.end_effector, ReferenceFrame::World);
        let system = ScrewSystem::of_columns(&j, &ScrewOptions::with_length(options.length))?;
        let choice = system.choose_pitch();
        Ok(match choice.pitch {
            Some(h) => format!(
                "at the start --h {} keeps the projector smallest ({})",
                if h.is_infinite() { "inf".to_owned() } else { number(h) },
                number(choice.norm)
            ),
            None => "at the start there is no such inverse for any h".to_owned(),
        })
    };
    Error::InvalidOption {
        option: "--h",
        value: "missing".to_owned(),
        reason: format!(
            "the inverse '{name}' needs a pitch in m/rad, of the order of the arm's length; {}",
            advice().unwrap_or_default()
        ),
    }
}
