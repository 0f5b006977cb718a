//! The inverse of a session's servo: from what a client chooses to the options of `move`.

use std::collections::BTreeMap;

use cylindroid::{Error, Method, Result, ServoOptions, State};
use serde::Serialize;

use super::messages::{Complaint, MethodChoice};
use super::scene::{damping, hyperbolic, numbers};
use crate::args::InverseArgs;
use crate::commands::move_to::inverse;

/// The inverse as it was asked for, with the numbers that it got.
#[derive(Debug, Clone, Serialize)]
pub(super) struct Chosen {
    name: String,
    numbers: BTreeMap<&'static str, f64>,
    h: Option<f64>,
    fallback: Option<String>,
}

impl Chosen {
    pub(super) fn plain(method: Method) -> Self {
        Self { name: method.name().to_owned(), numbers: numbers(method), h: None, fallback: None }
    }
}

/// What is chosen, and the options that say so; `best_pitch` is asked where a pitch is needed and
/// none is given.
pub(super) fn invert_by(
    choice: MethodChoice,
    state: &State,
    mut options: ServoOptions,
    best_pitch: impl FnOnce() -> Result<f64>,
) -> std::result::Result<(Chosen, ServoOptions), Complaint> {
    let at = |error| Complaint::of("method", &error);
    let MethodChoice { name, numbers: given, h, fallback } = choice;
    let chooses = hyperbolic().any(|n| n == name);
    let h = if chooses && h.is_none() { Some(best_pitch().map_err(at)?) } else { h };
    let mut all = damping(&name);
    all.extend(damping(fallback.as_deref().unwrap_or_default()));
    let mut all: BTreeMap<String, f64> =
        all.into_iter().map(|(number, x)| (number.to_owned(), x)).collect();
    all.extend(given);
    let args = arguments(&name, h, fallback.clone(), &all)?;
    inverse::apply(&args, state.q(), state.mechanism(), &mut options).map_err(at)?;
    let numbers = if chooses {
        let own = damping(&name).into_iter();
        own.map(|(number, x)| (number, all.get(number).copied().unwrap_or(x))).collect()
    } else {
        numbers(options.method)
    };
    Ok((Chosen { name, numbers, h, fallback }, options))
}

/// The options of `move` that say the same.
fn arguments(
    name: &str,
    h: Option<f64>,
    fallback: Option<String>,
    numbers: &BTreeMap<String, f64>,
) -> std::result::Result<InverseArgs, Complaint> {
    let mut args = InverseArgs {
        inverse: name.to_owned(),
        eps: None,
        damping: None,
        onset: None,
        filter: None,
        max_rate: None,
        shape: None,
        floor: None,
        h,
        mu: None,
        lambda: None,
        give_up: Vec::new(),
        fallback,
    };
    for (number, value) in numbers {
        let place = match number.as_str() {
            "eps" => &mut args.eps,
            "damping" => &mut args.damping,
            "onset" => &mut args.onset,
            "filter" => &mut args.filter,
            "max_rate" => &mut args.max_rate,
            "shape" => &mut args.shape,
            "floor" => &mut args.floor,
            "mu" => &mut args.mu,
            "lambda" => &mut args.lambda,
            _ => {
                let all =
                    Method::ALL.into_iter().flat_map(|m| super::scene::numbers(m).into_keys());
                let error =
                    Error::unknown("number of an inverse", number, all.chain(["mu", "lambda"]));
                return Err(Complaint::of("method.numbers", &error));
            }
        };
        *place = Some(*value);
    }
    Ok(args)
}
