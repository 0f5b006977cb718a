//! The inverse of a session's servo: from the client's choice and parameters to the options of
//! `move`.

use std::collections::BTreeMap;

use cylindroid::control::NamedInverse;
use cylindroid::{Error, Method, Result, ServoOptions, State};
use serde::Serialize;

use super::messages::{Complaint, MethodChoice};
use crate::args::InverseArgs;
use crate::args::inverses::{NamedInverseArgs, Parameters};
use crate::commands::move_to::inverse;

/// The parameters of the inverse of this name except the pitch, with their defaults.
pub(super) fn damping(name: &str) -> BTreeMap<&'static str, f64> {
    let inverse = hyperbolic().find(|i| i.name == name);
    let own = inverse.into_iter().flat_map(|i| i.parameters).filter(|p| p.name != PITCH);
    own.map(|p| (p.name, p.default)).collect()
}

/// The parameter that chooses a hyperbolic inverse.
pub(super) const PITCH: &str = "h";

/// The hyperbolic inverses: those with a pitch.
pub(super) fn hyperbolic() -> impl Iterator<Item = NamedInverse> {
    NamedInverse::all().filter(|i| i.parameters.iter().any(|p| p.name == PITCH))
}

/// The inverse that the client chose, with the values of its parameters.
#[derive(Debug, Clone, Serialize)]
#[cfg_attr(test, derive(ts_rs::TS), ts(rename = "ChosenMethod"))]
pub(super) struct Chosen {
    name: String,
    parameters: BTreeMap<&'static str, f64>,
    h: Option<f64>,
    fallback: Option<String>,
}

impl Chosen {
    pub(super) fn plain(method: Method) -> Self {
        Self {
            name: method.name().to_owned(),
            parameters: method.values(),
            h: None,
            fallback: None,
        }
    }

    /// The message that chooses it.
    pub(super) fn choice(&self) -> MethodChoice {
        let Self { name, parameters, h, fallback } = self.clone();
        let parameters = parameters.into_iter().map(|(name, x)| (name.to_owned(), x)).collect();
        MethodChoice { name, parameters, h, fallback }
    }
}

/// The chosen inverse, and the servo options for it; `best_pitch` is called if a pitch is required
/// and not given.
pub(super) fn invert_by(
    choice: MethodChoice,
    state: &State,
    mut options: ServoOptions,
    best_pitch: impl FnOnce() -> Result<f64>,
) -> std::result::Result<(Chosen, ServoOptions), Complaint> {
    let at = |error| Complaint::of("method", &error);
    let MethodChoice { name, parameters: given, h, fallback } = choice;
    let chooses = hyperbolic().any(|i| i.name == name);
    let h = if chooses && h.is_none() { Some(best_pitch().map_err(at)?) } else { h };
    let mut all = damping(&name);
    all.extend(damping(fallback.as_deref().unwrap_or_default()));
    let mut all: BTreeMap<String, f64> =
        all.into_iter().map(|(name, x)| (name.to_owned(), x)).collect();
    all.extend(given);
    let args = arguments(&name, h, fallback.clone(), &all)?;
    inverse::apply(&args, state.q(), state.mechanism(), &mut options).map_err(at)?;
    let parameters = if chooses {
        let own = damping(&name).into_iter();
        own.map(|(name, x)| (name, all.get(name).copied().unwrap_or(x))).collect()
    } else {
        options.method.values()
    };
    Ok((Chosen { name, parameters, h, fallback }, options))
}

/// The equivalent options of `move`.
fn arguments(
    name: &str,
    h: Option<f64>,
    fallback: Option<String>,
    parameters: &BTreeMap<String, f64>,
) -> std::result::Result<InverseArgs, Complaint> {
    let mut given = BTreeMap::from_iter(h.map(|h| ("h", h)));
    for (name, value) in parameters {
        let all = || NamedInverse::all().flat_map(|i| i.parameters).map(|p| p.name);
        let Some(known) = all().find(|known| known == name) else {
            let error = Error::unknown("parameter of an inverse", name, all());
            return Err(Complaint::of("method.parameters", &error));
        };
        given.insert(known, *value);
    }
    let inverse = name.to_owned();
    let parameters = Parameters(given);
    let named = NamedInverseArgs { inverse: Some(inverse), parameters, give_up: Vec::new() };
    Ok(InverseArgs { named, fallback })
}
