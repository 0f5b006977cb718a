//! What the commands on closed chains share: the mechanism at its configuration as a constraint.

pub(super) mod assemble;
pub(super) mod grasp;
mod immobilisation;
mod limbs;
pub(crate) mod manipulability;
pub(super) mod measured;
pub(crate) mod mobility;
mod operation_modes;
pub(crate) mod singularity;
pub(super) mod statics;
mod stiffness;
mod transmitted_wrench;

use cylindroid::closure::{ClosedChain, LoopClosureError};
use cylindroid::model::{FrameId, Mechanism};
use cylindroid::{Error, Result, State};
use serde::Serialize;

use crate::args::ClosedArgs;
use crate::commands::shared::{configuration, load};
use crate::output::{self, number};
use crate::values::components;

/// A mechanism, its configuration and its constraint there.
pub(crate) struct Posed {
    mechanism: Mechanism,
    q: Vec<f64>,
    chain: ClosedChain,
}

impl Posed {
    fn new(args: &ClosedArgs) -> Result<Self> {
        let mechanism = load(&args.configuration.model, &args.actuated)?;
        let q = configuration(&mechanism, &args.configuration)?;
        let frame = args.frame.as_deref().map(|name| mechanism.frame(name)).transpose()?;
        if let Some(length) = args.length {
            Error::check_positive("--length", length)?;
        }
        Self::at(mechanism, q, frame, args.length)
    }

    pub(crate) fn at(
        mechanism: Mechanism,
        q: Vec<f64>,
        frame: Option<FrameId>,
        length: Option<f64>,
    ) -> Result<Self> {
        let chain = ClosedChain::of(&mechanism.state(&q)?, frame, length)?;
        Ok(Self { mechanism, q, chain })
    }

    fn state(&self) -> Result<State> {
        self.mechanism.state(&self.q)
    }

    fn frame(&self) -> &str {
        &self.mechanism.frame_of(self.chain.reference).name
    }

    /// Names of the loop joints, then of the contacts.
    fn closings(&self) -> Vec<&str> {
        let loops = self.mechanism.loops().iter().map(|l| l.name.as_str());
        loops.chain(self.mechanism.contacts().iter().map(|c| c.name.as_str())).collect()
    }

    /// Names of the components of the reference's twist.
    fn components(&self) -> &'static [&'static str] {
        components(self.chain.constraint.object())
    }

    /// The lines that say what is looked at.
    fn heading(&self) -> Vec<(&'static str, String)> {
        let closure_error = self.chain.closure_error;
        let open = !closure_error.is_closed(self.chain.constraint.length());
        vec![
            ("model", self.mechanism.name().to_owned()),
            ("reference frame", self.frame().to_owned()),
            ("q [rad or m]", q_in_words(&self.q)),
            ("note", output::outside_note(&output::outside_limits(&self.mechanism, &self.q))),
            ("actuated", list(&self.chain.actuated)),
            ("passive", list(&self.chain.passive)),
            (
                "loops are open by",
                if open {
                    format!(
                        "{} m, {} rad: the report assumes closed loops (`assemble`)",
                        number(closure_error.distance),
                        number(closure_error.angle)
                    )
                } else {
                    String::new()
                },
            ),
        ]
    }
}

/// In full where there is something to read.
fn q_in_words(q: &[f64]) -> String {
    if q.len() > 1 && q.iter().all(|x| *x == 0.0) {
        return format!("all {} at zero", q.len());
    }
    output::entries(q)
}

fn list(names: &[String]) -> String {
    if names.is_empty() { "none".to_owned() } else { names.join(", ") }
}

/// What both commands say first.
#[derive(Debug, Serialize)]
struct HeadJson<'a> {
    model: &'a str,
    /// The reference.
    frame: &'a str,
    q: &'a [f64],
    outside_limits: Vec<&'a str>,
    actuated: &'a [String],
    passive: &'a [String],
    /// How far loops are from closed.
    closure_error: ClosureErrorJson,
    /// Characteristic length [m].
    length: f64,
}

/// By how much loops are open.
#[derive(Debug, Serialize)]
pub(crate) struct ClosureErrorJson {
    /// [m]
    distance: f64,
    /// [rad]
    angle: f64,
}

impl From<LoopClosureError> for ClosureErrorJson {
    fn from(closure_error: LoopClosureError) -> Self {
        Self { distance: closure_error.distance, angle: closure_error.angle }
    }
}

impl<'a> From<&'a Posed> for HeadJson<'a> {
    fn from(posed: &'a Posed) -> Self {
        let chain = &posed.chain;
        Self {
            model: posed.mechanism.name(),
            frame: posed.frame(),
            q: &posed.q,
            outside_limits: output::outside_limits(&posed.mechanism, &posed.q),
            actuated: &chain.actuated,
            passive: &chain.passive,
            closure_error: chain.closure_error.into(),
            length: chain.constraint.length(),
        }
    }
}

/// Whether a search may have missed modes. `found`: number of starts that led to each.
fn further_modes(found: impl Iterator<Item = usize>, unseen: f64) -> String {
    let found: Vec<usize> = found.collect();
    let once = found.iter().filter(|n| **n == 1).count();
    match (found.len(), once) {
        (0, _) => String::new(),
        (_, 0) => "possible, but every mode was found more than once".to_owned(),
        _ => format!(
            "likely: {once} found only once; a further closing start finds a new mode with \
             probability {}",
            number(unseen)
        ),
    }
}
