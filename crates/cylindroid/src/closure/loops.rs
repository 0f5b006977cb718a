//! The loops of a mechanism at a configuration, as numbers without unit: by how much they are open,
//! and how every coordinate opens them.
//!
//! Formula  r(q), and J with dr = J dq where r = 0
//! Shapes   r: held rows, J: held rows x n; a list of coordinates picks its columns
//! Units    rows of lengths over the reach or another length, columns of lengths times it
//! Valid    any mechanism; a tree has no rows. Limits and motors of closing joints do not enter:
//!          these joints have no coordinate
//! Source   the rows: `graph.rs`
//! Checked  tests/it/closure/assembly.rs

use super::constraint::Unit;
use super::graph::{Gap, Row, link_jacobians, rows};
use crate::error::{Error, Result};
use crate::linalg::Matrix;
use crate::model::{Mechanism, Motion};
use crate::tolerance::{AT_LIMIT, CLOSED};

/// Residuals of all loops and contacts, and their rates by all coordinates.
#[derive(Debug, Clone)]
pub(super) struct Loops {
    pub(super) residuals: Vec<f64>,
    pub(super) rates: Matrix,
    pub(super) gap: Gap,
    /// |r|
    pub(super) error: f64,
    closed: bool,
}

impl Loops {
    /// Lengths over the reach.
    pub(super) fn at(mechanism: &Mechanism, q: &[f64]) -> Result<Self> {
        Self::with_length(mechanism, q, mechanism.reach())
    }

    /// Lengths over another characteristic length (m).
    pub(super) fn with_length(mechanism: &Mechanism, q: &[f64], length: f64) -> Result<Self> {
        let state = mechanism.state(q)?;
        let (all, _, gap) = rows(&state)?;
        let held: Vec<&Row> = all.iter().filter(|row| row.rate_of.is_none()).collect();
        let scale = |row: &Row| if row.unit == Unit::Length { 1.0 / length } else { 1.0 };
        let residuals: Vec<f64> = held.iter().map(|row| row.residual * scale(row)).collect();
        let links = if held.is_empty() { Vec::new() } else { link_jacobians(&state)? };
        let rates = Matrix::from_fn(held.len(), mechanism.n(), |i, j| {
            held[i].rate(&links, j) * scale(held[i]) * column_scale(mechanism, j, length)
        });
        let error = residuals.iter().map(|r| r * r).sum::<f64>().sqrt();
        let closed = gap.distance <= CLOSED * length && gap.angle <= CLOSED;
        Ok(Self { residuals, rates, gap, error, closed })
    }

    /// True if every loop and contact is closed to [`CLOSED`].
    pub(super) fn is_closed(&self) -> bool {
        self.closed
    }

    /// The columns of some coordinates.
    pub(super) fn rates_by(&self, places: &[usize]) -> Matrix {
        Matrix::from_fn(self.rates.rows(), places.len(), |i, j| self.rates[(i, places[j])])
    }
}

/// What a change of 1 means at coordinate `i` (m or rad), lengths over the reach.
pub(super) fn unit_of(mechanism: &Mechanism, i: usize) -> f64 {
    column_scale(mechanism, i, mechanism.reach())
}

/// The same, lengths over `length` (m).
pub(super) fn column_scale(mechanism: &Mechanism, i: usize, length: f64) -> f64 {
    if mechanism.coordinates()[i].kind.unit() == "m" { length } else { 1.0 }
}

/// The coordinates that are not held.
///
/// # Errors
/// A held place that is no coordinate; some coordinates of a spherical or free joint held and
/// others not: they have no meaning one by one.
pub(super) fn free_places(mechanism: &Mechanism, held: &[usize]) -> Result<Vec<usize>> {
    let coordinates = mechanism.coordinates();
    let refuse =
        |value: String, reason: String| Err(Error::InvalidOption { option: "held", value, reason });
    if let Some(place) = held.iter().find(|&&i| i >= coordinates.len()) {
        let n = coordinates.len();
        return refuse(place.to_string(), format!("the mechanism has {n} coordinates"));
    }
    for node in mechanism.nodes() {
        if !matches!(node.motion, Motion::Spherical | Motion::Free) {
            continue;
        }
        let group = node.coordinate..node.coordinate + node.motion.dof();
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
pub(super) fn moved(
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

/// Coordinates that stand at a position limit.
pub(super) fn at_limit(mechanism: &Mechanism, q: &[f64]) -> Vec<usize> {
    let stands = |i: &usize| {
        let l = &mechanism.coordinates()[*i].limits;
        q[*i] - l.lower < AT_LIMIT || l.upper - q[*i] < AT_LIMIT
    };
    (0..mechanism.n()).filter(stands).collect()
}
