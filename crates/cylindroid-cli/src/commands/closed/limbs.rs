//! What `mobility` says about limbs: their screw systems and transmission indices.

use std::io::Write;

use cylindroid::closure::{Diagnosis, Limb, LimbScrews, Transmission};
use cylindroid::screws::ScrewSystem;
use serde::Serialize;

use super::{Posed, list};
use crate::output::{self, Align, ScrewJson, number};

/// The limbs of a configuration, with their transmission indices.
pub(super) struct Limbs {
    screws: LimbScrews,
    transmission: Option<Transmission>,
}

#[derive(Debug, Serialize)]
pub(super) struct LimbJson {
    joints: Vec<String>,
    actuated: Vec<String>,
    /// False if it has loops of its own.
    serial: bool,
    twists: SystemJson,
    constraint: SystemJson,
    actuation: SystemJson,
}

#[derive(Debug, Serialize)]
struct SystemJson {
    order: usize,
    class: &'static str,
    ambiguous: bool,
    principal_screws: Vec<ScrewJson>,
}

#[derive(Debug, Serialize)]
pub(super) struct TransmissionJson {
    local: Option<f64>,
    constraint: Option<f64>,
    actuators: Vec<ActuatorJson>,
}

#[derive(Debug, Serialize)]
struct ActuatorJson {
    joint: String,
    /// Index into `limbs`.
    limb: usize,
    input: Option<f64>,
    output: Option<f64>,
    wrench: Option<ScrewJson>,
}

impl From<&ScrewSystem> for SystemJson {
    fn from(system: &ScrewSystem) -> Self {
        Self {
            order: system.order(),
            class: system.class().name(),
            ambiguous: system.is_ambiguous(),
            principal_screws: system.principal_screws().iter().map(Into::into).collect(),
        }
    }
}

impl From<&Limb> for LimbJson {
    fn from(limb: &Limb) -> Self {
        Self {
            joints: limb.joints.clone(),
            actuated: limb.actuated.clone(),
            serial: limb.serial,
            twists: (&limb.twists).into(),
            constraint: (&limb.constraint).into(),
            actuation: (&limb.actuation).into(),
        }
    }
}

impl Limbs {
    pub(super) fn of(posed: &Posed, found: &Diagnosis) -> cylindroid::Result<Self> {
        let chain = &posed.chain;
        let length = chain.constraint.length();
        let screws = LimbScrews::of(&posed.state()?, Some(chain.reference), Some(length))?;
        let transmission = Transmission::of(&screws, &found.generic);
        Ok(Self { screws, transmission })
    }

    pub(super) fn json(&self) -> Vec<LimbJson> {
        self.screws.limbs.iter().map(Into::into).collect()
    }

    pub(super) fn transmission(&self) -> Option<TransmissionJson> {
        self.transmission.as_ref().map(|t| TransmissionJson {
            local: t.local,
            constraint: t.constraint,
            actuators: t
                .actuators
                .iter()
                .map(|a| ActuatorJson {
                    joint: a.name.clone(),
                    limb: a.limb,
                    input: a.input,
                    output: a.output,
                    wrench: a.wrench.as_ref().map(Into::into),
                })
                .collect(),
        })
    }

    /// The table of limbs, where there are several.
    pub(super) fn print(&self, out: &mut dyn Write) -> anyhow::Result<()> {
        let limbs = &self.screws.limbs;
        if limbs.len() < 2 {
            return Ok(());
        }
        writeln!(out)?;
        let columns = [
            ("limb", Align::Left),
            ("connectivity", Align::Right),
            ("twists", Align::Left),
            ("constraint wrenches", Align::Left),
            ("actuation wrenches", Align::Left),
            ("input index", Align::Right),
            ("output index", Align::Right),
        ];
        let rows = limbs.iter().enumerate().map(|(i, limb)| {
            let own = |of: &dyn Fn(&cylindroid::closure::ActuatorTransmission) -> Option<f64>| {
                let all = self.transmission.iter().flat_map(|t| &t.actuators);
                let own = all.filter(|a| a.limb == i);
                own.map(|a| of(a).map_or("-".to_owned(), number)).collect::<Vec<_>>().join(", ")
            };
            let joints = &limb.joints;
            let name = match &joints[..] {
                [first, .., last] if limb.serial => format!("{first} to {last}"),
                [first, others @ ..] if !limb.serial => {
                    format!("{first} and {} more joints", others.len())
                }
                _ => list(joints),
            };
            vec![
                name,
                limb.twists.order().to_string(),
                system(&limb.twists),
                system(&limb.constraint),
                system(&limb.actuation),
                own(&|a| a.input),
                own(&|a| a.output),
            ]
        });
        output::table(out, &columns, rows)?;
        if let Some(t) = &self.transmission {
            writeln!(out)?;
            let index = |x: Option<f64>, zero: &str| match x {
                None => String::new(),
                Some(0.0) => zero.to_owned(),
                Some(x) => number(x),
            };
            output::pairs(
                out,
                [
                    ("local transmission index", index(t.local, "0 (type I or II singularity)")),
                    (
                        "constraint transmission index",
                        index(t.constraint, "0 (constraint singularity)"),
                    ),
                ],
            )?;
        }
        Ok(())
    }
}

/// Order and Gibson-Hunt class.
fn system(of: &ScrewSystem) -> String {
    match of.order() {
        0 => "none".to_owned(),
        6 => "6, all".to_owned(),
        order => format!("{order}, {}", of.class()),
    }
}
