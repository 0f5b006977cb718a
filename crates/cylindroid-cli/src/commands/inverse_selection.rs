//! From `--inverse`, its parameters and `--give-up` to a selection of the library.

use std::collections::BTreeMap;

use cylindroid::closure::frame_twists;
use cylindroid::control::{InverseSelection, NamedInverse};
use cylindroid::screws::{ScrewOptions, ScrewSystem};
use cylindroid::{EndEffector, Error, Result, State, Twist};

use crate::args::inverses::{self, NamedInverseArgs};
use crate::output::number;

/// The inverse of the arguments.
pub(crate) fn selection<'a>(
    args: &'a NamedInverseArgs,
    fallback: Option<&'a str>,
) -> InverseSelection<'a> {
    let given = &args.parameters.0;
    InverseSelection {
        name: args.name(),
        parameters: given.iter().map(|(name, value)| (*name, *value)).collect(),
        complement: args.give_up.iter().map(|m| Twist::from_array(m.0)).collect(),
        fallback,
    }
}

/// All parameters of the chosen inverse: those given, and the defaults of the others.
pub(crate) fn parameters_in_effect(args: &NamedInverseArgs) -> Result<BTreeMap<&'static str, f64>> {
    let given = &args.parameters.0;
    let own = NamedInverse::named(args.name())?.parameters.iter();
    Ok(own.map(|p| (p.name, given.get(p.name).copied().unwrap_or(p.default))).collect())
}

/// Names options as they are typed.
pub(crate) fn as_typed(error: Error) -> Error {
    match error {
        Error::InvalidOption { option, value, reason } => {
            let option = match option {
                "give_up" => "--give-up",
                "fallback" => "--fallback",
                "length" => "--length",
                name => inverses::option(name).unwrap_or(name),
            };
            Error::InvalidOption { option, value, reason }
        }
        other => other,
    }
}

/// Refuses an inverse, or a fallback, that needs `--h` where none was given, with advice for this
/// tool at this state (`place` in words).
pub(crate) fn check_pitch(
    args: &NamedInverseArgs,
    fallback: Option<&str>,
    place: &str,
    (state, tool, length): (&State, EndEffector, f64),
) -> Result<()> {
    if args.parameters.0.contains_key("h") {
        return Ok(());
    }
    let needs_it = |name: &&str| {
        let mut found = NamedInverse::all().filter(|i| i.name == *name);
        found.any(|i| i.parameters.iter().any(|p| p.name == "h"))
    };
    let Some(name) = [Some(args.name()), fallback].into_iter().flatten().find(needs_it) else {
        return Ok(());
    };
    let advice = || -> Result<String> {
        let twists = frame_twists(state, tool)?;
        let system = ScrewSystem::of(&twists, &ScrewOptions::with_length(length))?;
        let choice = system.choose_pitch();
        Ok(match choice.pitch {
            Some(h) => format!(
                "{place} --h {} keeps the projector smallest ({})",
                if h.is_infinite() { "inf".to_owned() } else { number(h) },
                number(choice.norm)
            ),
            None => format!("{place} there is no such inverse for any h"),
        })
    };
    // `--h` has no default, since it is a real choice; but there is advice.
    Err(Error::InvalidOption {
        option: "--h",
        value: String::new(),
        reason: format!(
            "the inverse '{name}' needs a pitch in m/rad, of the order of the arm's length; {}",
            advice().unwrap_or_default()
        ),
    })
}
