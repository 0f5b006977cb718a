//! What `manipulability` computes.

use cylindroid::closure::{MotionSpace, Relation};
use cylindroid::linalg::Interval;
use cylindroid::manipulability::{
    Goal, Gradient, Manipulability, Measure, Polytope, force_polytope, force_range, gradient,
    velocity_polytope, velocity_range,
};
use cylindroid::{Error, Result};

use super::Posed;
use super::measured::{self, Quantity, Task};
use crate::args::{ManipulabilityArgs, MeasureName};

/// What was found.
pub(super) struct Found {
    pub(super) posed: Posed,
    /// Names of the components of twist and wrench, or of the task.
    pub(super) components: Vec<String>,
    pub(super) metric: &'static str,
    /// Options that replace a part of it.
    pub(super) own: Vec<&'static str>,
    pub(super) efficiencies: Manipulability,
    /// Of velocity and of force, or why not.
    pub(super) polytopes: Option<[Reached; 2]>,
    pub(super) gradient: Option<(Measure, Gradient)>,
}

/// What limits allow, or in words what is missing.
pub(super) type Reached = std::result::Result<Bounded, String>;

/// What is reached within the limits of the actuators.
pub(super) struct Bounded {
    pub(super) limits: Vec<Interval>,
    pub(super) range: Vec<Interval>,
    /// Up to three components.
    pub(super) polytope: Option<Polytope>,
}

pub(super) fn find(posed: Posed, args: &ManipulabilityArgs) -> Result<Found> {
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
