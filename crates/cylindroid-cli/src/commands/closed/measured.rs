//! What commands measure with: metrics, tasks and limits from the command line.

use cylindroid::closure::{Relation, row_compliance};
use cylindroid::linalg::{Interval, Metric};
use cylindroid::manipulability::Metrics;
use cylindroid::model::Limits;
use cylindroid::{Error, Matrix, Result, State};

use super::Posed;
use crate::args::{ManipulabilityArgs, MetricName};
use crate::number_file;
use crate::values::{ByName, Weights};

/// The components of the motion that matter.
pub(super) struct Task {
    pub(super) names: Vec<String>,
    pub(super) map: Matrix,
}

impl Task {
    /// The one that is asked for, if any.
    pub(super) fn new(posed: &Posed, args: &ManipulabilityArgs) -> Result<Option<Self>> {
        let components = posed.components();
        let d = components.len();
        if let Some(path) = &args.task_map {
            let map = number_file::matrix(path, d)?;
            if map.rows() == 0 {
                return Err(number_file::cannot_read(
                    path,
                    "it has no rows; a task has one at least",
                ));
            }
            let names = (1..=map.rows()).map(|i| format!("task {i}")).collect();
            return Ok(Some(Self { names, map }));
        }
        if args.task.is_empty() {
            return Ok(None);
        }
        let place = |name: &String| {
            let found = components.iter().position(|c| c == name);
            found.ok_or_else(|| Error::unknown("component", name, components))
        };
        let places: Vec<usize> = args.task.iter().map(place).collect::<Result<_>>()?;
        let map = Matrix::from_fn(places.len(), d, |i, j| f64::from(u8::from(places[i] == j)));
        Ok(Some(Self { names: args.task.clone(), map }))
    }
}

/// The metric that a user gave for these `names`, of the size that fits them.
pub(in crate::commands) fn metric(
    option: &'static str,
    weights: &Weights,
    names: &[impl AsRef<str>],
) -> Result<Metric> {
    let wrong = |got: usize| Error::Dimension {
        what: option.to_owned(),
        expected: names.len(),
        got,
        hint: format!(
            "in this order: {}",
            names.iter().map(AsRef::as_ref).collect::<Vec<_>>().join(", ")
        ),
    };
    match weights {
        Weights::Inertia => Err(Error::InvalidOption {
            option,
            value: "inertia".to_owned(),
            reason: "only velocities of actuated joints (--wq) are measured by the inertia of the \
                     mechanism; give weights, or for twists --metric inertia"
                .to_owned(),
        }),
        Weights::Diagonal(list) if list.len() == names.len() => Metric::diagonal(option, list),
        Weights::Diagonal(list) => Err(wrong(list.len())),
        Weights::File(path) => {
            let matrix = number_file::matrix(path, names.len())?;
            if matrix.rows() != names.len() {
                return Err(wrong(matrix.rows() * names.len()));
            }
            Metric::new(option, &matrix)
        }
    }
}

/// The metrics of the whole twist that `--metric` names.
pub(super) fn preset(posed: &Posed, args: &ManipulabilityArgs) -> Result<Metrics> {
    let chain = &posed.chain;
    let length = || Metrics::characteristic_length(&chain.units, chain.constraint.length());
    match args.metric {
        MetricName::Unit => Ok(Metrics::UNIT),
        MetricName::Length => length(),
        MetricName::Limits => {
            let limits = match &args.velocity_limits {
                Some(given) => given.0.clone(),
                None => of_model(posed, Quantity::Rate).map_err(|name| Error::InvalidOption {
                    option: "--metric",
                    value: "limits".to_owned(),
                    reason: format!(
                        "joint '{name}' has no velocity limit; give it one, or --velocity-limits, or \
                         use 'length'"
                    ),
                })?,
            };
            Error::check_len("--velocity-limits", chain.actuated.len(), limits.len())?;
            let slower: Vec<f64> = limits.iter().map(|l| l.upper.min(-l.lower)).collect();
            length()?.with_velocity_limits(&slower)
        }
        MetricName::Inertia => Metrics::UNIT.with_inertia(&posed.state()?, chain.reference),
    }
}

/// The metrics that are meant, for the task if there is one.
pub(super) fn metrics(
    posed: &Posed,
    args: &ManipulabilityArgs,
    task: Option<&Task>,
) -> Result<Metrics> {
    let mut metrics = preset(posed, args)?;
    // The unit metric of a task is that of its own numbers.
    if let (Some(task), true) = (task, args.metric != MetricName::Unit) {
        metrics = metrics.for_task(&task.map)?;
    }
    let components: Vec<String> = match task {
        Some(task) => task.names.clone(),
        None => posed.components().iter().map(|c| (*c).to_owned()).collect(),
    };
    let joints = &posed.chain.actuated;
    if let Some(w) = &args.wu {
        metrics.object = Some(metric("--wu", w, &components)?);
    }
    match &args.wq {
        None => {}
        Some(Weights::Inertia) => metrics = metrics.with_joint_inertia(&posed.state()?)?,
        Some(w) => metrics.joint = Some(metric("--wq", w, joints)?),
    }
    if let Some(w) = &args.ww {
        metrics.wrench = Some(metric("--ww", w, &components)?);
    }
    if let Some(w) = &args.wtau {
        metrics.torque = Some(metric("--wtau", w, joints)?);
    }
    Ok(metrics)
}

/// The metric of the forces of all rows, from weights of loop joints and contacts (1 by default).
pub(super) fn contact_metric(
    posed: &Posed,
    state: &State,
    weights: Option<&ByName>,
) -> Result<Metric> {
    let closings = posed.closings();
    if let Some(weights) = weights {
        weights.check("loop joint or contact", &closings)?;
    }
    let of = |name: &&str| weights.and_then(|w| w.of(name)).unwrap_or(1.0);
    let all: Vec<f64> = closings.iter().map(of).collect();
    row_compliance(state, &posed.chain, &all)
}

/// What actuators are limited in.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Quantity {
    Rate,
    Torque,
}

impl Quantity {
    /// The limits of the actuated joints: those of the command line, else the model's; in words
    /// what is missing.
    pub(super) fn limits(
        self,
        posed: &Posed,
        args: &ManipulabilityArgs,
    ) -> std::result::Result<Vec<Interval>, String> {
        let given = match self {
            Self::Rate => &args.velocity_limits,
            Self::Torque => &args.torque_limits,
        };
        if let Some(given) = given {
            return Ok(given.0.clone());
        }
        let (word, option) = match self {
            Self::Rate => ("velocity", "--velocity-limits"),
            Self::Torque => ("effort", "--torque-limits"),
        };
        of_model(posed, self)
            .map_err(|name| format!("joint '{name}' has no {word} limit; give {option}"))
    }
}

/// The limits of the model, or the first actuated joint without one.
fn of_model(posed: &Posed, quantity: Quantity) -> std::result::Result<Vec<Interval>, String> {
    let most = |l: Limits| match quantity {
        Quantity::Rate => l.velocity,
        Quantity::Torque => l.effort,
    };
    let limit = |name: &String| {
        let limit = posed.mechanism.limits_of(name).map(most);
        let finite = limit.filter(|l| l.is_finite() && *l > 0.0);
        finite.map(Interval::symmetric).ok_or_else(|| name.clone())
    };
    posed.chain.actuated.iter().map(limit).collect()
}

/// The relation of the task, or of the whole twist.
pub(super) fn of_task(relation: Relation, task: Option<&Task>) -> Result<Relation> {
    match task {
        Some(task) => relation.task(&task.map),
        None => Ok(relation),
    }
}
