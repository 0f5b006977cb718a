//! Subsets of coordinates: the free ones, changes of some of them, position limits.
//!
//! Units    changes have none: lengths are divided by the characteristic length
//! Valid    any mechanism; rotation vectors and free bodies are changed as a whole
//! Checked  tests/it/closure/assembly.rs, tests/it/closure/modes.rs

use crate::closure::constraint::velocity_constraint::Unit;
use crate::error::{Error, Result};
use crate::linalg::{Matrix, norm};
use crate::model::{CoordinateKind, Mechanism, NodeKind};
use crate::scalar::clamp;
use crate::tolerance::AT_LIMIT;

/// Selected columns of a Jacobian.
pub(crate) fn columns(rates: &Matrix, places: &[usize]) -> Matrix {
    Matrix::from_fn(rates.rows(), places.len(), |i, j| rates[(i, places[j])])
}

/// The change of coordinate `i` (m or rad) per unit of its scaled change, for the characteristic
/// length `length`.
pub(crate) fn column_scale(mechanism: &Mechanism, i: usize, length: f64) -> f64 {
    Unit::of(mechanism.coordinates()[i].kind).size(length)
}

/// The same with the characteristic length of the mechanism.
pub(crate) fn unit_of(mechanism: &Mechanism, i: usize) -> f64 {
    column_scale(mechanism, i, mechanism.reach())
}

/// The coordinates that are not prescribed.
///
/// # Errors
/// A prescribed index that is no coordinate; some but not all coordinates of a spherical or free
/// joint: they have no meaning one by one.
pub(crate) fn free_places(mechanism: &Mechanism, prescribed: &[usize]) -> Result<Vec<usize>> {
    let coordinates = mechanism.coordinates();
    let refuse = |value: String, reason: String| {
        Err(Error::InvalidOption { option: "prescribed", value, reason })
    };
    if let Some(place) = prescribed.iter().find(|&&i| i >= coordinates.len()) {
        let n = coordinates.len();
        return refuse(place.to_string(), format!("the mechanism has {n} coordinates"));
    }
    for node in mechanism.nodes() {
        if !matches!(node.kind, NodeKind::Spherical | NodeKind::Free) {
            continue;
        }
        let group = node.coordinate..node.coordinate + node.kind.dof();
        let kept = group.clone().filter(|i| prescribed.contains(i)).count();
        if let (Some(place), true) =
            (group.clone().find(|i| prescribed.contains(i)), kept > 0 && kept < group.len())
        {
            let names: Vec<&str> = group.map(|i| coordinates[i].name.as_str()).collect();
            return refuse(
                coordinates[place].name.clone(),
                format!(
                    "one joint has all of {} as coordinates; prescribe all of them or none",
                    names.join(", ")
                ),
            );
        }
    }
    Ok((0..coordinates.len()).filter(|i| !prescribed.contains(i)).collect())
}

/// `q` with a scaled change of the coordinates `places`; the others keep their values.
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
    // An unchanged rotation vector may come back rounded, or as an equivalent one.
    for (i, x) in next.iter_mut().enumerate() {
        if !places.contains(&i) {
            *x = q[i];
        }
    }
    next
}

/// The largest scaled change of a coordinate; of the components of a vector the root of their mean
/// square, which does not depend on the axes.
pub(crate) fn largest_change(mechanism: &Mechanism, places: &[usize], change: &[f64]) -> f64 {
    let vector = |&i: &usize| {
        let c = &mechanism.coordinates()[i];
        (c.kind != CoordinateKind::Angle).then_some((c.joint, c.kind))
    };
    let (mut largest, mut rest) = (0.0_f64, change);
    for group in places.chunk_by(|a, b| vector(a).is_some() && vector(a) == vector(b)) {
        let (own, others) = rest.split_at(group.len());
        largest = largest.max(norm(own) / (own.len() as f64).sqrt());
        rest = others;
    }
    largest
}

/// Some coordinates clamped to their position limits.
pub(crate) fn within_limits(mechanism: &Mechanism, mut q: Vec<f64>, places: &[usize]) -> Vec<f64> {
    for &i in places {
        let l = &mechanism.coordinates()[i].limits;
        q[i] = clamp(q[i], l.lower, l.upper);
    }
    q
}

/// Coordinates at a position limit or beyond it.
pub(crate) fn at_limit(mechanism: &Mechanism, q: &[f64]) -> Vec<usize> {
    let is_at_limit = |i: &usize| {
        let l = &mechanism.coordinates()[*i].limits;
        let near = AT_LIMIT * mechanism.unit_of(*i);
        q[*i] - l.lower < near || l.upper - q[*i] < near
    };
    (0..mechanism.n()).filter(is_at_limit).collect()
}
