//! Lists of coordinates: those that are free, what a change of some of them does, limits.
//!
//! Units    changes have none: lengths are over the reach
//! Valid    any mechanism; numbers of balls and free bodies are not moved one by one
//! Checked  tests/it/closure/assembly.rs, tests/it/closure/modes.rs

use crate::closure::constraint::velocity_constraint::Unit;
use crate::error::{Error, Result};
use crate::linalg::Matrix;
use crate::model::{Mechanism, NodeKind};
use crate::scalar::clamp;
use crate::tolerance::AT_LIMIT;

/// The columns of some coordinates.
pub(crate) fn columns(rates: &Matrix, places: &[usize]) -> Matrix {
    Matrix::from_fn(rates.rows(), places.len(), |i, j| rates[(i, places[j])])
}

/// What a change of 1 means at coordinate `i` where lengths are over `length` (m or rad).
pub(crate) fn column_scale(mechanism: &Mechanism, i: usize, length: f64) -> f64 {
    Unit::of(mechanism.coordinates()[i].kind).size(length)
}

/// The same with lengths over the reach.
pub(crate) fn unit_of(mechanism: &Mechanism, i: usize) -> f64 {
    column_scale(mechanism, i, mechanism.reach())
}

/// The coordinates that are not held.
///
/// # Errors
/// A held place that is no coordinate; some coordinates of a spherical or free joint held and
/// others not: they have no meaning one by one.
pub(crate) fn free_places(mechanism: &Mechanism, held: &[usize]) -> Result<Vec<usize>> {
    let coordinates = mechanism.coordinates();
    let refuse =
        |value: String, reason: String| Err(Error::InvalidOption { option: "held", value, reason });
    if let Some(place) = held.iter().find(|&&i| i >= coordinates.len()) {
        let n = coordinates.len();
        return refuse(place.to_string(), format!("the mechanism has {n} coordinates"));
    }
    for node in mechanism.nodes() {
        if !matches!(node.kind, NodeKind::Spherical | NodeKind::Free) {
            continue;
        }
        let group = node.coordinate..node.coordinate + node.kind.dof();
        let kept = group.clone().filter(|i| held.contains(i)).count();
        if let (Some(place), true) =
            (group.clone().find(|i| held.contains(i)), kept > 0 && kept < group.len())
        {
            let names: Vec<&str> = group.map(|i| coordinates[i].name.as_str()).collect();
            return refuse(
                coordinates[place].name.clone(),
                format!("one joint turns by all of {}; hold all of them or none", names.join(", ")),
            );
        }
    }
    Ok((0..coordinates.len()).filter(|i| !held.contains(i)).collect())
}

/// `q` moved by a change without unit of the coordinates `places`; the others keep their numbers.
pub(crate) fn moved(
    mechanism: &Mechanism,
    q: &[f64],
    places: &[usize],
    change: &[f64],
) -> Vec<f64> {
    let mut rates = vec![0.0; mechanism.n()];
    for (&i, c) in places.iter().zip(change) {
        rates[i] = c * unit_of(mechanism, i);
    }
    let mut next = q.to_vec();
    mechanism.integrate_in_place(&mut next, &rates, 1.0);
    // A rotation vector that rests may come back rounded or turned once round.
    for (i, x) in next.iter_mut().enumerate() {
        if !places.contains(&i) {
            *x = q[i];
        }
    }
    next
}

/// Some coordinates cut to their position limits.
pub(crate) fn within_limits(mechanism: &Mechanism, mut q: Vec<f64>, places: &[usize]) -> Vec<f64> {
    for &i in places {
        let l = &mechanism.coordinates()[i].limits;
        q[i] = clamp(q[i], l.lower, l.upper);
    }
    q
}

/// Coordinates that stand at a position limit.
pub(crate) fn at_limit(mechanism: &Mechanism, q: &[f64]) -> Vec<usize> {
    let stands = |i: &usize| {
        let l = &mechanism.coordinates()[*i].limits;
        q[*i] - l.lower < AT_LIMIT || l.upper - q[*i] < AT_LIMIT
    };
    (0..mechanism.n()).filter(stands).collect()
}
