//! What `manipulability` computes.

use cylindroid::closure::{MotionSpace, Relation, TransmittedWrench, transmitted_wrenches};
use cylindroid::linalg::{Interval, Metric};
use cylindroid::manipulability::{
    EllipsoidView, Goal, Gradient, Manipulability, Measure, Metrics, Polytope, Spectrum,
    force_polytope, force_range, gradient, internal_force_manipulability, velocity_polytope,
    velocity_range,
};
use cylindroid::{Error, Result};

use super::Posed;
use super::measured::{self, Quantity, Task};
use crate::args::{ManipulabilityArgs, MeasureName, MetricName};
use crate::plot::ellipses::PlaneShapes;

/// What was found.
pub(super) struct Found {
    pub(super) posed: Posed,
    /// Names of the components of twist and wrench, or of the task.
    pub(super) components: Vec<String>,
    pub(super) metric: &'static str,
    /// Options that replace a part of it.
    pub(super) own: Vec<&'static str>,
    pub(super) efficiencies: Manipulability,
    /// Of internal forces: torques and forces of rows.
    pub(super) internal: InternalForces,
    /// Of velocity and of force, or why not.
    pub(super) polytopes: Option<[Reached; 2]>,
    pub(super) gradient: Option<(Measure, Gradient)>,
    /// Between the actuated joints and the components.
    pub(super) relation: Relation,
    /// True if the components are those of a task.
    pub(super) task: bool,
    /// With --plot.
    pub(super) drawn: Option<(EllipsoidView, Vec<PlaneShapes>)>,
}

/// What limits allow, or in words what is missing.
pub(super) type Reached = std::result::Result<Bounded, String>;

/// Efficiencies of internal forces, with the wrenches in loops and contacts of each direction and of
/// each hyperstatic force.
pub(super) struct InternalForces {
    pub(super) spectrum: Spectrum,
    pub(super) forces: Vec<Vec<TransmittedWrench>>,
    pub(super) hyperstatic: Vec<Vec<TransmittedWrench>>,
}

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
    let internal = internal_forces(&posed, args, &metrics)?;
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
    let is_task = task.is_some();
    let components = match task {
        Some(task) => task.names,
        None => posed.components().iter().map(|c| (*c).to_owned()).collect(),
    };
    let given = [
        ("wu", args.wu.is_some()),
        ("wq", args.wq.is_some()),
        ("ww", args.ww.is_some()),
        ("wtau", args.wtau.is_some()),
        ("wt", args.wt.is_some()),
    ];
    let own = given.into_iter().filter(|g| g.1).map(|g| g.0).collect();
    let metric = args.metric.name();
    Ok(Found {
        posed,
        components,
        metric,
        own,
        efficiencies,
        internal,
        polytopes,
        gradient,
        relation,
        task: is_task,
        drawn: None,
    })
}

fn internal_forces(
    posed: &Posed,
    args: &ManipulabilityArgs,
    metrics: &Metrics,
) -> Result<InternalForces> {
    let (state, chain) = (posed.state()?, &posed.chain);
    let force = match &args.wt {
        None if args.metric == MetricName::Unit => None,
        given => Some(measured::contact_metric(posed, &state, given.as_ref())?),
    };
    let torque = metrics.torque.clone().or_else(|| metrics.joint.as_ref().map(Metric::dual));
    let spectrum =
        internal_force_manipulability(&chain.constraint, torque.as_ref(), force.as_ref())?;
    let wrenches = |t: &[f64]| transmitted_wrenches(&state, chain, t);
    let forces = spectrum.finite.iter().map(|d| wrenches(&d.object)).collect::<Result<_>>()?;
    let columns = (0..spectrum.infinite.cols()).map(|j| wrenches(spectrum.infinite.column(j)));
    let hyperstatic = columns.collect::<Result<_>>()?;
    Ok(InternalForces { spectrum, forces, hyperstatic })
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
