//! Closed chains: from loop joints, contacts and the reference link of a mechanism to its
//! constraint.
//!
//! Formula  for every loop joint and contact between links a and b, a row for each constraint
//!          wrench h: h . (J_b - J_a) q = 0, both velocities in the world; for a loop joint of one
//!          coordinate s also r . (J_b - J_a) q - s = 0, with r the wrench that measures its rate;
//!          J_ref q - u = 0 for the twist u of the reference link (the object)
//! Shapes   t = constraint wrenches + rates + d rows; actuated and passive coordinates as columns;
//!          d = 3 in the plane (vx, vy, wz), 6 in space
//! Units    lengths are divided by the characteristic length for every rank decision
//! Frame    u and its wrench: at the origin of the reference frame, world axes
//! Valid    any mechanism; for a tree it is u = J q. Loops are not closed here: the rows are those
//!          of the two frames of a joint as they are, see [`ClosedChain::closure_error`]
//! Why so   a spanning tree with rows for its loop joints needs no contact forces of tree joints;
//!          the relation between actuated joints and object does not depend on the choice of loop
//!          joints, nor does the degree of hyperstaticity
//! Source   Bicchi & Prattichizzo 1998, eq. 2, with further objects as passive columns
//! Checked  tests/it/closure/graph.rs

use std::ops::Range;

use super::constraint_rows::{constraint_rows, for_each_rate, rate_unit};
use super::loop_closure_error::LoopClosureError;
use super::velocity_constraint::{Constraint, ConstraintBlocks, Unit, Units, check_size};
use crate::error::Result;
use crate::kinematics::State;
use crate::linalg::Matrix;
use crate::model::{FrameId, JointKind, LoopJoint, Mechanism};

/// The velocity constraint of a mechanism at a configuration, with the names of its columns.
#[derive(Debug, Clone)]
pub struct ClosedChain {
    /// The constraint.
    pub constraint: Constraint,
    /// Names of the actuated coordinates, in the order of the columns.
    pub actuated: Vec<String>,
    /// Names of the passive coordinates.
    pub passive: Vec<String>,
    /// Units of rows and columns.
    pub units: Units,
    /// The frame whose motion is the goal (the object).
    pub reference: FrameId,
    /// The loop-closure error of the configuration.
    pub closure_error: LoopClosureError,
    /// For every coordinate of the tree, then for loop joints: whether it is actuated, and its
    /// column among those of its kind.
    places: Vec<(bool, usize)>,
}

impl ClosedChain {
    /// The constraint at `state`, for the mechanism's reference frame or another, with its
    /// characteristic length or another (m).
    ///
    /// ```
    /// use cylindroid::closure::{ClosedChain, MotionSpace};
    ///
    /// let stewart = cylindroid::load("stewart")?;
    /// let chain = ClosedChain::of(&stewart.state(stewart.home())?, None, None)?;
    /// assert_eq!((chain.actuated.len(), chain.passive.len()), (6, 15));
    /// assert_eq!(MotionSpace::of(&chain.constraint).dof(), 6);
    /// # Ok::<(), cylindroid::Error>(())
    /// ```
    ///
    /// # Errors
    /// A frame of another mechanism, a length that is not of the size of the mechanism, an actuated
    /// loop joint of several coordinates; more than 2000 columns, or 12 000 rows.
    pub fn of(state: &State, reference: Option<FrameId>, length: Option<f64>) -> Result<Self> {
        let mechanism = state.mechanism();
        let reference = reference.unwrap_or_else(|| mechanism.reference());
        mechanism.check_frame(reference)?;
        let (rows, loops, closure_error) = constraint_rows(state)?;
        let columns = Columns::of(mechanism, &loops);
        let components = mechanism.dimension().components();
        let (constraints, d) = (rows.len(), components.len());
        check_size(constraints + d, columns.places.len() + d)?;
        let mut blocks = ConstraintBlocks {
            actuated: Matrix::zeros(constraints + d, columns.actuated.len()),
            passive: Matrix::zeros(constraints + d, columns.passive.len()),
            grasp: Matrix::zeros(d, constraints + d),
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
        let target = state.tip(reference);
        target.for_each_column(target.world_from_tip.translation, |_, c, twist| {
            let twist = twist.to_array();
            for (i, &component) in components.iter().enumerate() {
                add(constraints + i, c, twist[component]);
            }
        });
        for i in 0..d {
            blocks.grasp[(i, constraints + i)] = 1.0;
        }
        let object: Vec<Unit> =
            components.iter().map(|&c| if c < 3 { Unit::Length } else { Unit::Angle }).collect();
        let vectors = columns.vectors(mechanism);
        let units = Units {
            rows: rows.iter().map(|r| r.unit).chain(object.iter().copied()).collect(),
            actuated: columns.actuated_units,
            passive: columns.passive_units,
            object,
        };
        let constraint = Constraint::new(blocks)?
            .with_length(&units, mechanism.length_or(length)?)?
            .with_vectors(vectors);
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

    /// The column of a coordinate (index into `q`): actuated columns first, then passive ones.
    pub(crate) fn column(&self, coordinate: usize) -> usize {
        let (actuated, place) = self.places[coordinate];
        if actuated { place } else { self.actuated.len() + place }
    }
}

/// The coordinates of the tree, then the rates of loop joints, as actuated and passive columns.
#[derive(Default)]
pub(crate) struct Columns {
    pub(crate) actuated: Vec<String>,
    passive: Vec<String>,
    pub(crate) actuated_units: Vec<Unit>,
    pub(crate) passive_units: Vec<Unit>,
    /// For every coordinate: whether it is actuated, and its column among those of its kind.
    pub(crate) places: Vec<(bool, usize)>,
}

impl Columns {
    /// The columns of rotation vectors, positions of free bodies, and displacements in a plane. Where
    /// some components are actuated, these are a vector, and the others are another.
    fn vectors(&self, mechanism: &Mechanism) -> Vec<Range<usize>> {
        let of_kind = |coordinates: &[(bool, usize)], actuated: bool| {
            let mut own = coordinates.iter().filter(|(a, _)| *a == actuated);
            let before = if actuated { 0 } else { self.actuated.len() };
            let first = before + own.next()?.1;
            Some(first..first + 1 + own.count())
        };
        let joints = mechanism.joints().iter().filter(|j| j.mimic.is_none());
        let groups = joints.flat_map(|joint| {
            let sizes: &[usize] = match joint.kind {
                JointKind::Spherical => &[3],
                JointKind::Free => &[3, 3],
                JointKind::Planar => &[2],
                _ => &[],
            };
            let mut from = joint.coordinates.start;
            sizes.iter().map(move |size| {
                from += size;
                (from - size, *size)
            })
        });
        let groups = groups.map(|(c, size)| &self.places[c..c + size]);
        groups.flat_map(|g| [of_kind(g, true), of_kind(g, false)].into_iter().flatten()).collect()
    }

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
