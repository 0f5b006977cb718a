//! From Python's keywords to the options of the servo, with the names of the command line.

use cylindroid::control::{
    SecondaryNullSpace, SecondaryTask, ServoGains, SpeedLimit, Task, TaskProjection,
};
use cylindroid::inverse::HyperbolicDamping;
use cylindroid::{Error, Mechanism, Method, ReferenceFrame, ServoOptions, Twist};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyString};

use crate::arrays::Numbers;
use crate::error::{Failure, Result};
use crate::inverse::MethodNumbers;
use crate::mechanism::reference_of;

/// The one that chooses nothing, as a fallback.
const PLAIN: &str = "truncated";

/// What a name means.
pub(crate) fn named<T: Copy>(what: &'static str, name: &str, known: &[(&str, T)]) -> Result<T> {
    match known.iter().find(|(known, _)| *known == name) {
        Some((_, meant)) => Ok(*meant),
        None => Err(Error::unknown(what, name, known.iter().map(|(known, _)| known)).into()),
    }
}

/// A number, or one for translations and one for rotations.
pub(crate) fn pair(name: &'static str, of: &Numbers<'_>, single: f64) -> Result<(f64, f64)> {
    match *of.values() {
        [a] => Ok((a, if single.is_nan() { a } else { single })),
        [a, b] => Ok((a, b)),
        _ => Err(Failure::option(
            name,
            format!("{} numbers", of.values().len()),
            "give one number, or one for translations and one for rotations",
        )),
    }
}

/// What chooses the inverse.
#[derive(Debug)]
pub(crate) struct InverseChoice<'a> {
    pub(crate) name: &'a str,
    pub(crate) numbers: MethodNumbers,
    pub(crate) h: Option<f64>,
    pub(crate) mu: Option<f64>,
    pub(crate) lam: Option<f64>,
    /// Rows are twists of the tool.
    pub(crate) give_up: Option<Vec<Twist>>,
    pub(crate) fallback: Option<&'a str>,
}

impl InverseChoice<'_> {
    /// Sets method, projection and fallback.
    pub(crate) fn apply(&self, options: &mut ServoOptions) -> Result<()> {
        let chooses = TaskProjection::NAMES.contains(&self.name);
        let method = if chooses {
            Method::default()
        } else {
            Method::named(self.name).map_err(|_| {
                let all = Method::ALL.iter().map(Method::name).chain(TaskProjection::NAMES);
                Error::unknown("inverse", self.name, all)
            })?
        };
        options.method = self.numbers.apply(method)?;
        if chooses {
            options.projection = self.projection(self.name)?;
        }
        options.fallback = match self.fallback {
            None => None,
            Some(name) if !chooses => {
                let reason = format!(
                    "the inverse '{}' always exists; a fallback is for {}",
                    self.name,
                    TaskProjection::NAMES.join(", ")
                );
                return Err(Failure::option("fallback", name, reason));
            }
            Some(PLAIN) => Some(TaskProjection::Orthogonal),
            Some(name) if TaskProjection::NAMES.contains(&name) => Some(self.projection(name)?),
            Some(name) => {
                let known = TaskProjection::NAMES.iter().chain(&[PLAIN]);
                return Err(Error::unknown("fallback", name, known).into());
            }
        };
        self.refuse_unused()
    }

    fn projection(&self, name: &str) -> Result<TaskProjection> {
        let needed = |option: &'static str, value: Option<f64>| {
            value.ok_or_else(|| {
                let reason = format!(
                    "the inverse '{name}' needs this number, in m/rad: of the order of the arm's \
                     length for h, 0.01 for mu and lam; ScrewSystem.choose_pitch advises"
                );
                Failure::option(option, "missing", reason)
            })
        };
        Ok(match name {
            "hyperbolic" => TaskProjection::Hyperbolic { h: needed("h", self.h)? },
            "hyperbolic-damped" => TaskProjection::DampedHyperbolic {
                h: needed("h", self.h)?,
                damping: HyperbolicDamping::Invariant { mu: needed("mu", self.mu)? },
            },
            "hyperbolic-gram" => TaskProjection::DampedHyperbolic {
                h: needed("h", self.h)?,
                damping: HyperbolicDamping::Gram { lambda: needed("lam", self.lam)? },
            },
            _ => TaskProjection::Oblique {
                complement: self.give_up.clone().unwrap_or_default(),
                reference: ReferenceFrame::Local,
            },
        })
    }

    /// Refuses numbers of inverses that were not asked for.
    fn refuse_unused(&self) -> Result<()> {
        let asked = |names: &[&str]| {
            names.contains(&self.name) || self.fallback.is_some_and(|f| names.contains(&f))
        };
        let numbers: [(&'static str, Option<f64>, &[&str]); 4] = [
            ("h", self.h, &TaskProjection::NAMES[..3]),
            ("mu", self.mu, &TaskProjection::NAMES[1..2]),
            ("lam", self.lam, &TaskProjection::NAMES[2..3]),
            ("give_up", self.give_up.as_ref().map(|g| g.len() as f64), &TaskProjection::NAMES[3..]),
        ];
        for (option, value, names) in numbers {
            if let Some(value) = value
                && !asked(names)
            {
                let reason = format!("only {} has it; choose one as inverse", names.join(", "));
                return Err(Failure::option(option, value.to_string(), reason));
            }
        }
        Ok(())
    }
}

/// The components of the motion that matter.
pub(crate) fn task(
    robot: &Mechanism,
    name: Option<&str>,
    axes: Option<&str>,
    default: Task,
) -> Result<Task> {
    let mut task = name.map_or(Ok(default), |name| Task::named(name, robot))?;
    task.axes = match axes {
        None => task.axes,
        // The error is taken at the tool, so the world's axes are meant.
        Some("world") => ReferenceFrame::LocalWorldAligned,
        Some(name) => reference_of(name)?,
    };
    Ok(task)
}

/// The secondary tasks: names, with gains or without.
pub(crate) fn secondary(
    wanted: Option<&Bound<'_, PyAny>>,
    posture: &[f64],
    robot: &Mechanism,
    options: &ServoOptions,
) -> Result<Vec<SecondaryTask>> {
    let named = |name: &str, gain: Option<f64>| -> Result<SecondaryTask> {
        let task = SecondaryTask::named(name, posture)?;
        Ok(gain.map_or(task.clone(), |gain| task.with_gain(gain)))
    };
    let Some(wanted) = wanted else {
        return Ok(options.default_secondary(robot)?);
    };
    if let Ok(name) = wanted.cast::<PyString>() {
        let name = name.to_cow()?;
        return if name == "none" { Ok(Vec::new()) } else { Ok(vec![named(&name, None)?]) };
    }
    if let Ok(gains) = wanted.cast::<PyDict>() {
        let each = gains
            .iter()
            .map(|(name, gain)| named(&name.extract::<String>()?, Some(gain.extract::<f64>()?)));
        return each.collect();
    }
    let words = "secondary is a name, a list of names, or a dict of gains by name";
    let names: Vec<String> = wanted.extract().map_err(|_| Failure::kind(words))?;
    names.iter().map(|name| named(name, None)).collect()
}

pub(crate) fn null_space(name: &str) -> Result<SecondaryNullSpace> {
    named(
        "null space",
        name,
        &[("exact", SecondaryNullSpace::Exact), ("retained", SecondaryNullSpace::Retained)],
    )
}

pub(crate) fn gain(of: &Numbers<'_>) -> Result<ServoGains> {
    let (position, orientation) = pair("gain", of, f64::NAN)?;
    Ok(ServoGains { position, orientation })
}

pub(crate) fn speed(of: &Numbers<'_>) -> Result<SpeedLimit> {
    let (linear, angular) = pair("speed", of, f64::INFINITY)?;
    Ok(SpeedLimit { linear, angular })
}

/// Twists as rows, or names of components of the tool's motion.
pub(crate) fn twists(name: &'static str, of: &Bound<'_, PyAny>) -> Result<Vec<Twist>> {
    if let Ok(names) = of.extract::<Vec<String>>() {
        let one = |name: &String| match Task::COMPONENTS.iter().position(|c| c == name) {
            Some(i) => Ok(Twist::from_array(std::array::from_fn(|k| f64::from(u8::from(k == i))))),
            None => Err(Error::unknown("component", name, Task::COMPONENTS).into()),
        };
        return names.iter().map(one).collect();
    }
    let numbers: Numbers<'_> = of.extract()?;
    match *numbers.shape() {
        [6] | [_, 6] => {
            let rows = numbers.values().as_chunks::<6>().0;
            Ok(rows.iter().map(|r| Twist::from_array(*r)).collect())
        }
        _ => Err(Failure::option(
            name,
            format!("{} numbers", numbers.values().len()),
            "give twists as rows of six, linear part first, or names like 'rz'",
        )),
    }
}
