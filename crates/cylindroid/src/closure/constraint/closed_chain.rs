//! The constraint of a mechanism: from its loops, contacts and reference link to the matrices.
//!
//! Formula  for every loop joint and contact between links a and b, each held wrench h (a row):
//!          h . (J_b - J_a) q = 0, both bodies seen from the world; for a loop joint of one
//!          coordinate s also r . (J_b - J_a) q - s = 0, r the wrench that measures its rate;
//!          J_ref q - u = 0: the reference link carries the object's twist u
//! Shapes   t = held + measured + d rows; actuated and passive coordinates as columns; d = 3 in the
//!          plane (vx, vy, wz), else 6
//! Units    lengths over the characteristic length for every rank decision
//! Frame    u and its wrench: at the reference frame's origin, world axes
//! Valid    any mechanism; for a tree it is u = J q. The pose is taken as it is: rows are those of
//!          the two frames of a joint where they should coincide, see [`ClosedChain::closure_error`]
//! Why so   a spanning tree and rows for what closes it needs no contact forces of tree joints; the
//!          relation between actuated joints and object is the same wherever the loops are cut, and
//!          so is the hyperstatic degree
//! Source   Bicchi & Prattichizzo 1998, eq. 2, with several objects as passive columns
//! Checked  tests/it/closure/graph.rs

use super::constraint_rows::{constraint_rows, for_each_rate, rate_unit};
use super::loop_closure_error::LoopClosureError;
use super::velocity_constraint::{Constraint, ConstraintBlocks, Unit, Units};
use crate::error::Result;
use crate::kinematics::State;
use crate::linalg::Matrix;
use crate::model::{FrameId, LoopJoint, Mechanism};

/// A mechanism at a configuration as a constraint, with the names of what the columns are.
#[derive(Debug, Clone)]
pub struct ClosedChain {
    /// The matrices.
    pub constraint: Constraint,
    /// Names of the actuated coordinates, in the order of the columns.
    pub actuated: Vec<String>,
    /// Names of the passive coordinates.
    pub passive: Vec<String>,
    /// Units of rows and columns.
    pub units: Units,
    /// The frame whose motion is the goal.
    pub reference: FrameId,
    /// How far the loops are open: the largest distance (m) and angle (rad) by which what should
    /// be held is not.
    pub closure_error: LoopClosureError,
    /// Of every coordinate of the tree, then of loop joints: whether it is actuated, and its
    /// column among those of its sort.
    places: Vec<(bool, usize)>,
}

impl ClosedChain {
    /// The constraint of `state`, for the mechanism's reference frame or another, at its reach as
    /// characteristic length or another (m).
    ///
    /// # Errors
    /// A frame of another mechanism, a length that is not positive, an actuated loop joint of
    /// several coordinates.
    pub fn of(state: &State, reference: Option<FrameId>, length: Option<f64>) -> Result<Self> {
        let mechanism = state.mechanism();
        let reference = reference.unwrap_or_else(|| mechanism.reference());
        mechanism.check_frame(reference)?;
        let (rows, loops, closure_error) = constraint_rows(state)?;
        let columns = Columns::of(mechanism, &loops);
        let components = mechanism.dimension().components();
        let (held, d) = (rows.len(), components.len());
        let mut blocks = ConstraintBlocks {
            actuated: Matrix::zeros(held + d, columns.actuated.len()),
            passive: Matrix::zeros(held + d, columns.passive.len()),
            grasp: Matrix::zeros(d, held + d),
        };
        let mut add = |i: usize, coordinate: usize, rate: f64| {
            let (actuated, j) = columns.places[coordinate];
            let block = if actuated { &mut blocks.actuated } else { &mut blocks.passive };
            block[(i, j)] += rate;
        };
        for_each_rate(state, &rows, &mut add);
        for (i, row) in rows.iter().enumerate() {
            if let Some(k) = row.rate_of {
                add(i, mechanism.n() + k, -1.0);
            }
        }
        let target = state.tip(reference.into());
        target.for_each_column(target.world_from_tip.translation, |_, c, twist| {
            let twist = twist.to_array();
            for (i, &component) in components.iter().enumerate() {
                add(held + i, c, twist[component]);
            }
        });
        for i in 0..d {
            blocks.grasp[(i, held + i)] = 1.0;
        }
        let object: Vec<Unit> =
            components.iter().map(|&c| if c < 3 { Unit::Length } else { Unit::Angle }).collect();
        let units = Units {
            rows: rows.iter().map(|r| r.unit).chain(object.iter().copied()).collect(),
            actuated: columns.actuated_units,
            passive: columns.passive_units,
            object,
        };
        let constraint = Constraint::new(blocks)?
            .with_length(&units, length.unwrap_or_else(|| mechanism.reach()))?;
        Ok(Self {
            constraint,
            actuated: columns.actuated,
            passive: columns.passive,
            units,
            reference,
            closure_error,
            places: columns.places,
        })
    }

    /// The column of a coordinate of the mechanism (place in `q`) among those of actuated joints and,
    /// after them, of passive ones.
    pub(crate) fn column(&self, coordinate: usize) -> usize {
        let (actuated, place) = self.places[coordinate];
        if actuated { place } else { self.actuated.len() + place }
    }
}

/// The coordinates of the tree, then those of loop joints, as actuated and passive columns.
#[derive(Default)]
pub(crate) struct Columns {
    pub(crate) actuated: Vec<String>,
    passive: Vec<String>,
    pub(crate) actuated_units: Vec<Unit>,
    pub(crate) passive_units: Vec<Unit>,
    /// Of every coordinate: whether it is actuated, and its column among those of its sort.
    pub(crate) places: Vec<(bool, usize)>,
}

impl Columns {
    pub(crate) fn of(mechanism: &Mechanism, loops: &[&LoopJoint]) -> Self {
        let mut columns = Self::default();
        columns.places.reserve(mechanism.n() + loops.len());
        let mut add = |name: &String, unit: Unit, actuated: bool| {
            let (names, units) = if actuated {
                (&mut columns.actuated, &mut columns.actuated_units)
            } else {
                (&mut columns.passive, &mut columns.passive_units)
            };
            columns.places.push((actuated, names.len()));
            names.push(name.clone());
            units.push(unit);
        };
        for c in mechanism.coordinates() {
            add(&c.name, Unit::of(c.kind), c.actuated);
        }
        for l in loops {
            add(&l.name, rate_unit(l), l.actuated);
        }
        columns
    }
}
