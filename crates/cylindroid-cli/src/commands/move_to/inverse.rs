//! From `--inverse` and its numbers to the options of the servo.

use cylindroid::control::TaskProjection;
use cylindroid::inverse::HyperbolicDamping;
use cylindroid::model::Mechanism;
use cylindroid::screws::{ScrewOptions, ScrewSystem};
use cylindroid::{Error, Method, ReferenceFrame, Result, ServoOptions, Twist};

use crate::args::InverseArgs;
use crate::output::number;

/// The one that chooses nothing, as a fallback.
const PLAIN: &str = "truncated";

/// Sets method, projection and fallback.
pub(crate) fn apply(
    args: &InverseArgs,
    start: &[f64],
    robot: &Mechanism,
    options: &mut ServoOptions,
) -> Result<()> {
    let chooses = TaskProjection::NAMES.contains(&args.inverse.as_str());
    let method = if chooses { Method::default() } else { named(&args.inverse)? };
    options.method = with_numbers(args, method, &args.inverse)?;
    let pitch = |name: &str| match args.h {
        Some(h) => Ok(h),
        None => Err(missing_pitch(name, start, robot, options)),
    };
    let wanted = match chooses {
        true => projection(args, &args.inverse, pitch)?,
        false => TaskProjection::Orthogonal,
    };
    let fallback = match args.fallback.as_deref() {
        None => None,
        Some(_) if !chooses => {
            return Err(Error::InvalidOption {
                option: "--fallback",
                value: args.fallback.clone().unwrap_or_default(),
                reason: format!(
                    "the inverse '{}' always exists; a fallback is for {}",
                    args.inverse,
                    TaskProjection::NAMES.join(", ")
                ),
            });
        }
        Some(PLAIN) => Some(TaskProjection::Orthogonal),
        Some(name) if TaskProjection::NAMES.contains(&name) => Some(projection(args, name, pitch)?),
        Some(name) => {
            return Err(Error::unknown(
                "fallback",
                name,
                TaskProjection::NAMES.iter().chain(&[PLAIN]),
            ));
        }
    };
    (options.projection, options.fallback) = (wanted, fallback);
    unused(args)
}

/// The name of the inverse that the options mean, as it was asked for.
pub(super) fn name(projection: &TaskProjection, method: &Method) -> &'static str {
    match projection {
        TaskProjection::Orthogonal => method.name(),
        _ => projection.name(),
    }
}

fn named(name: &str) -> Result<Method> {
    Method::named(name).map_err(|_| {
        let all = Method::ALL.iter().map(Method::name).chain(TaskProjection::NAMES);
        Error::unknown("inverse", name, all)
    })
}

fn projection(
    args: &InverseArgs,
    name: &str,
    pitch: impl Fn(&str) -> Result<f64>,
) -> Result<TaskProjection> {
    let needed = |option: &'static str, value: Option<f64>| {
        value.ok_or_else(|| Error::InvalidOption {
            option,
            value: "missing".to_owned(),
            reason: format!("the inverse '{name}' needs this number, in m/rad: try 0.01"),
        })
    };
    Ok(match name {
        "hyperbolic" => TaskProjection::Hyperbolic { h: pitch(name)? },
        "hyperbolic-damped" => TaskProjection::DampedHyperbolic {
            h: pitch(name)?,
            damping: HyperbolicDamping::Invariant { mu: needed("--mu", args.mu)? },
        },
        "hyperbolic-gram" => TaskProjection::DampedHyperbolic {
            h: pitch(name)?,
            damping: HyperbolicDamping::Gram { lambda: needed("--lambda", args.lambda)? },
        },
        _ => TaskProjection::Oblique {
            complement: args.give_up.iter().map(|m| Twist::from_array(m.0)).collect(),
            reference: ReferenceFrame::Local,
        },
    })
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

/// Refuses numbers of inverses that were not asked for.
fn unused(args: &InverseArgs) -> Result<()> {
    let asked = |names: &[&str]| {
        names.contains(&args.inverse.as_str())
            || args.fallback.as_deref().is_some_and(|f| names.contains(&f))
    };
    let refuse = |option: &'static str, value: String, names: &[&str]| Error::InvalidOption {
        option,
        value,
        reason: format!("only {} has it; choose one with --inverse", names.join(", ")),
    };
    let numbers: [(&'static str, Option<f64>, &[&str]); 3] = [
        ("--h", args.h, &TaskProjection::NAMES[..3]),
        ("--mu", args.mu, &TaskProjection::NAMES[1..2]),
        ("--lambda", args.lambda, &TaskProjection::NAMES[2..3]),
    ];
    for (option, value, names) in numbers {
        if let Some(value) = value
            && !asked(names)
        {
            return Err(refuse(option, value.to_string(), names));
        }
    }
    if !args.give_up.is_empty() && !asked(&TaskProjection::NAMES[3..]) {
        let given = format!("{} motions", args.give_up.len());
        return Err(refuse("--give-up", given, &TaskProjection::NAMES[3..]));
    }
    Ok(())
}

/// The inverse with the numbers that were given.
fn with_numbers(args: &InverseArgs, mut method: Method, name: &str) -> Result<Method> {
    let flag = |number: &str| format!("--{}", number.replace('_', "-"));
    let mut numbers = method.numbers_mut();
    let given = [
        ("--eps", args.eps),
        ("--damping", args.damping),
        ("--onset", args.onset),
        ("--filter", args.filter),
        ("--max-rate", args.max_rate),
        ("--shape", args.shape),
        ("--floor", args.floor),
    ];
    for (option, value) in given.into_iter().filter_map(|(o, v)| Some((o, v?))) {
        let Some((_, number)) = numbers.iter_mut().find(|(o, _)| flag(o) == option) else {
            let own: Vec<String> = numbers.iter().map(|(o, _)| flag(o)).collect();
            return Err(Error::InvalidOption {
                option,
                value: value.to_string(),
                reason: format!(
                    "the inverse '{name}' has no such number but {}; choose one with --inverse",
                    own.join(", ")
                ),
            });
        };
        **number = value;
    }
    Ok(method)
}
