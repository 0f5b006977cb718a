//! `manipulability`: efficiencies of motion and force, indices, polytopes, gradients.

mod configurations;
mod report;

use std::io::Write;
use std::process::ExitCode;

use cylindroid::closure::{MotionSpace, Relation};
use cylindroid::linalg::Interval;
use cylindroid::manipulability::{
    Goal, Gradient, Manipulability, Measure, Polytope, force_polytope, force_range, gradient,
    velocity_polytope, velocity_range,
};
use cylindroid::{Error, Result};
use serde_json::value::RawValue;

use super::Posed;
use super::measured::{self, Quantity, Task};
use crate::args::{ManipulabilityArgs, MeasureName};
use crate::commands::shared::Style;
use crate::plot;

/// What was found.
struct Found {
    posed: Posed,
    /// Names of the components of twist and wrench, or of the task.
    components: Vec<String>,
    metric: &'static str,
    /// Options that replace a part of it.
    own: Vec<&'static str>,
    efficiencies: Manipulability,
    /// Of velocity and of force, or why not.
    polytopes: Option<[Reached; 2]>,
    gradient: Option<(Measure, Gradient)>,
}

/// What limits allow, or in words what is missing.
type Reached = std::result::Result<Bounded, String>;

/// What is reached within limits of the drives.
struct Bounded {
    limits: Vec<Interval>,
    range: Vec<Interval>,
    /// Up to three components.
    polytope: Option<Polytope>,
}

pub(crate) fn run(
    args: &ManipulabilityArgs,
    style: Style,
    out: &mut dyn Write,
) -> anyhow::Result<ExitCode> {
    if let Some(path) = &args.configurations {
        return configurations::run(path, args, style, out);
    }
    if let Some(path) = &args.plot {
        plot::check(path)?;
    }
    let found = find(Posed::new(&args.closed)?, args)?;
    if let Some(path) = &args.plot {
        let [rates, torques] = [Quantity::Rate, Quantity::Torque];
        let drawing = plot::ellipses::Drawing {
            state: &found.posed.state()?,
            chain: &found.posed.chain,
            metrics: &measured::metrics(&found.posed, args, None)?,
            metric: found.metric,
            velocity_limits: rates.limits(&found.posed, args).ok(),
            torque_limits: torques.limits(&found.posed, args).ok(),
        };
        plot::ellipses::draw(&drawing, path)?;
    }
    report::write(&found, style, out)?;
    Ok(ExitCode::SUCCESS)
}

/// The object of `--json`; `args` say everything but the posture.
pub(crate) fn report(posed: Posed, args: &ManipulabilityArgs) -> anyhow::Result<Box<RawValue>> {
    report::raw(&find(posed, args)?)
}

fn find(posed: Posed, args: &ManipulabilityArgs) -> Result<Found> {
    let task = Task::new(&posed, args)?;
    let metrics = measured::metrics(&posed, args, task.as_ref())?;
    let relation = MotionSpace::of(&posed.chain.constraint).relation();
    let relation = measured::of_task(relation, task.as_ref())?;
    let efficiencies = Manipulability::of(&relation, &metrics)?;
    let asked = args.polytope || args.velocity_limits.is_some() || args.torque_limits.is_some();
    let polytopes = if asked { Some(polytopes(&posed, &relation, args)?) } else { None };
    let gradient = match args.gradient {
        None => None,
        Some(name) => {
            let measure = match name {
                MeasureName::Volume => Measure::Volume,
                MeasureName::Smallest => Measure::Smallest,
                MeasureName::Largest => Measure::Largest,
                MeasureName::Anisotropy => Measure::Anisotropy,
            };
            let goal = Goal {
                reference: Some(posed.chain.reference),
                task: task.as_ref().map(|t| &t.map),
            };
            Some((measure, gradient(&posed.state()?, goal, &metrics, measure)?))
        }
    };
    let components = match task {
        Some(task) => task.names,
        None => posed.components().iter().map(|c| (*c).to_owned()).collect(),
    };
    let given = [
        ("wu", args.wu.is_some()),
        ("wq", args.wq.is_some()),
        ("ww", args.ww.is_some()),
        ("wtau", args.wtau.is_some()),
    ];
    let own = given.into_iter().filter(|g| g.1).map(|g| g.0).collect();
    let metric = args.metric.name();
    Ok(Found { posed, components, metric, own, efficiencies, polytopes, gradient })
}

fn polytopes(
    posed: &Posed,
    relation: &Relation,
    args: &ManipulabilityArgs,
) -> Result<[Reached; 2]> {
    /// Most components of which corners are looked for.
    const MOST: usize = 3;
    let solid = relation.object() <= MOST;
    let bounded = |quantity: Quantity| -> Result<Reached> {
        let limits = match quantity.limits(posed, args) {
            Ok(limits) => limits,
            Err(missing) => return Ok(Err(missing)),
        };
        let (polytope, range) = match quantity {
            Quantity::Rate => (
                if solid { Some(velocity_polytope(relation, &limits)?) } else { None },
                velocity_range(relation, &limits)?,
            ),
            Quantity::Torque => (
                if solid { Some(force_polytope(relation, &limits)?) } else { None },
                force_range(relation, &limits)?,
            ),
        };
        Ok(Ok(Bounded { limits, range, polytope }))
    };
    let both = [bounded(Quantity::Rate)?, bounded(Quantity::Torque)?];
    if let [Err(rates), Err(torques)] = &both {
        return Err(Error::InvalidOption {
            option: "--polytope",
            value: posed.mechanism.name().to_owned(),
            reason: format!("{rates}; {torques}"),
        });
    }
    Ok(both)
}
