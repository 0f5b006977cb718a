//! Ellipsoids of velocity and force at the tool point.

use cylindroid::closure::{ClosedChain, MotionSpace, Unit};
use cylindroid::manipulability::{Manipulability, Metrics};
use cylindroid::{Matrix, Result, Twist, Vec3};
use serde::Serialize;

use super::super::session::Session;

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Ellipsoid {
    Velocity,
    AngularVelocity,
    ActiveForce,
    PassiveForce,
}

#[derive(Debug, Serialize)]
#[cfg_attr(test, derive(ts_rs::TS), ts(rename = "Ellipsoid"))]
pub(in super::super) struct EllipsoidJson {
    center: [f64; 3],
    axes: Vec<SemiAxisJson>,
    /// Of all semi-axes alike [m of drawing per unit].
    scale: f64,
    infinite: Vec<[f64; 3]>,
    unit: &'static str,
}

#[derive(Debug, Serialize)]
#[cfg_attr(test, derive(ts_rs::TS), ts(rename = "SemiAxis"))]
struct SemiAxisJson {
    vector: [f64; 3],
    size: f64,
}

/// The ellipsoid of velocities or forces for inputs of norm one, in the unit metrics of
/// `manipulability`; `None` if the output vanishes.
pub(super) fn ellipsoid(session: &Session, kind: Ellipsoid) -> Result<Option<EllipsoidJson>> {
    let (mechanism, state) = (session.mechanism(), session.state());
    let of = session.options().end_effector;
    let chain = ClosedChain::of(state, Some(of.frame), None)?;
    let components = mechanism.dimension().components();
    let center = state.pose(of)?.translation;
    let offset = center - state.pose(of.frame)?.translation;
    let angular = kind == Ellipsoid::AngularVelocity;
    let chosen: Vec<usize> = components.iter().copied().filter(|&c| (c >= 3) == angular).collect();
    // The twist of the tool point, from that of the frame.
    let map = Matrix::from_fn(chosen.len(), components.len(), |i, j| {
        let mut unit = [0.0; 6];
        unit[components[j]] = 1.0;
        Twist::from_array(unit).at_point(offset).to_array()[chosen[i]]
    });
    let relation = MotionSpace::of(&chain.constraint).relation().task(&map)?;
    let all = Manipulability::of(&relation, &Metrics::UNIT)?;
    let (spectrum, unit) = match kind {
        Ellipsoid::Velocity => (all.kinematic, "m/s"),
        Ellipsoid::AngularVelocity => (all.kinematic, "rad/s"),
        Ellipsoid::ActiveForce => (all.active_force(), "N"),
        Ellipsoid::PassiveForce => (all.passive_force(), "N"),
    };
    let vector = |column: &[f64]| {
        let mut all = [0.0; 3];
        chosen.iter().zip(column).for_each(|(&c, x)| all[c % 3] = *x);
        Vec3::from_array(all)
    };
    let reach = mechanism.reach();
    let sliding = chain.units.actuated.iter().all(|u| *u == Unit::Length);
    let semi_axes = spectrum.semi_axes();
    let semi_axes: Vec<Vec3> = (0..semi_axes.cols()).map(|j| vector(semi_axes.column(j))).collect();
    let largest = semi_axes.iter().map(|axis| axis.norm()).fold(0.0, f64::max);
    let scale = (SHARE * reach / usual(kind, sliding, reach)).min(LARGEST * reach / largest);
    let drawn =
        |axis: &Vec3| SemiAxisJson { vector: (*axis * scale).to_array(), size: axis.norm() };
    let axes: Vec<SemiAxisJson> = semi_axes.iter().map(drawn).collect();
    let infinite: Vec<[f64; 3]> = (0..spectrum.infinite.cols())
        .filter_map(|j| vector(spectrum.infinite.column(j)).unit(0.0))
        .map(Vec3::to_array)
        .collect();
    if axes.is_empty() && infinite.is_empty() {
        return Ok(None);
    }
    Ok(Some(EllipsoidJson { center: center.to_array(), axes, scale, infinite, unit }))
}

/// Drawn length of a semi-axis of typical size [reach].
const SHARE: f64 = 0.25;
/// Maximum drawn length [reach].
const LARGEST: f64 = 0.8;

/// Typical output at the end of an arm of this reach for unit joint velocities (torques).
fn usual(kind: Ellipsoid, sliding: bool, reach: f64) -> f64 {
    match (kind, sliding) {
        (Ellipsoid::Velocity, false) => reach,
        (Ellipsoid::Velocity | Ellipsoid::ActiveForce | Ellipsoid::PassiveForce, true)
        | (Ellipsoid::AngularVelocity, false) => 1.0,
        (Ellipsoid::AngularVelocity, true)
        | (Ellipsoid::ActiveForce | Ellipsoid::PassiveForce, false) => 1.0 / reach,
    }
}
