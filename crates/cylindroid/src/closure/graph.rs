//! The constraint of a mechanism: from its loops, contacts and reference link to the matrices.
//!
//! Formula  for every closing joint and contact between links a and b, each held wrench h (a row):
//!          h . (J_b - J_a) q = 0, both bodies seen from the world; for a closing joint of one
//!          coordinate s also r . (J_b - J_a) q - s = 0, r the wrench that measures its rate;
//!          J_ref q - u = 0: the reference link carries the object's twist u
//! Shapes   t = held + measured + d rows; driven and passive coordinates as columns; d = 3 in the
//!          plane (vx, vy, wz), else 6
//! Units    lengths over the characteristic length for every rank decision
//! Frame    u and its wrench: at the reference frame's origin, world axes
//! Valid    any mechanism; for a tree it is u = J q. The pose is taken as it is: rows are those of
//!          the two frames of a joint where they should coincide, see [`ClosedChain::gap`]
//! Why so   a spanning tree and rows for what closes it needs no contact forces of tree joints; the
//!          relation between driven joints and object is the same wherever the loops are cut, and
//!          so is the hyperstatic degree
//! Source   Bicchi & Prattichizzo 1998, eq. 2, with several objects as passive columns
//! Checked  tests/it/closure/graph.rs

use super::constraint::{Blocks, Constraint, Unit, Units};
use crate::error::{Error, Result};
use crate::kinematics::State;
use crate::linalg::Matrix;
use crate::model::{Dimension, FrameId, JointKind, LoopJoint, Mechanism};
use crate::spatial::{Pose, Vec3, Wrench};
use crate::tolerance::CLOSED;

/// A mechanism at a configuration as a constraint, with the names of what the columns are.
#[derive(Debug, Clone)]
pub struct ClosedChain {
    /// The matrices.
    pub constraint: Constraint,
    /// Names of the driven coordinates, in the order of the columns.
    pub actuated: Vec<String>,
    /// Names of the passive coordinates.
    pub passive: Vec<String>,
    /// Units of rows and columns.
    pub units: Units,
    /// The frame whose motion is the goal.
    pub reference: FrameId,
    /// How far the loops are open: the largest distance (m) and angle (rad) by which what should
    /// be held is not.
    pub gap: Gap,
    /// Of every coordinate of the tree, then of closing joints: whether it is driven, and its
    /// column among those of its sort.
    places: Vec<(bool, usize)>,
}

/// How far loops and contacts are from being closed.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Gap {
    /// Along held directions (m).
    pub distance: f64,
    /// About held directions (rad).
    pub angle: f64,
}

impl Gap {
    /// Of the loops and contacts of `state`.
    ///
    /// # Errors
    /// A driven closing joint of several coordinates.
    pub fn of(state: &State) -> Result<Self> {
        Ok(rows(state)?.2)
    }

    /// True up to `tolerance::CLOSED` of a length (m), mostly the reach, and in angle.
    #[must_use]
    pub fn is_closed(self, length: f64) -> bool {
        self.distance <= CLOSED * length && self.angle <= CLOSED
    }
}

/// A relative motion that is restricted, in world axes at the world's origin.
pub(super) struct Row {
    /// What is measured of the motion of `b` relative to `a`.
    pub(super) wrench: Wrench,
    /// Place of its joint or contact: closing joints, then contacts.
    pub(super) pair: usize,
    a: usize,
    b: usize,
    pub(super) unit: Unit,
    /// Place among the coordinates of closing joints where it is their rate.
    pub(super) rate_of: Option<usize>,
    /// By how much what should be held is not (m or rad); its rate is `wrench . (J_b - J_a) q`
    /// where it is zero.
    pub(super) residual: f64,
}

impl ClosedChain {
    /// The constraint of `state`, for the mechanism's reference frame or another, at its reach as
    /// characteristic length or another (m).
    ///
    /// # Errors
    /// A frame of another mechanism, a length that is not positive, a driven closing joint of
    /// several coordinates.
    pub fn of(state: &State, reference: Option<FrameId>, length: Option<f64>) -> Result<Self> {
        let mechanism = state.mechanism();
        let reference = reference.unwrap_or_else(|| mechanism.reference());
        mechanism.check_frame(reference)?;
        let (rows, loops, gap) = rows(state)?;
        let columns = Columns::of(mechanism, &loops);
        let components = mechanism.dimension().components();
        let (held, d) = (rows.len(), components.len());
        let mut blocks = Blocks {
            actuated: Matrix::zeros(held + d, columns.actuated.len()),
            passive: Matrix::zeros(held + d, columns.passive.len()),
            grasp: Matrix::zeros(d, held + d),
        };
        let mut add = |i: usize, coordinate: usize, rate: f64| {
            let (driven, j) = columns.places[coordinate];
            let block = if driven { &mut blocks.actuated } else { &mut blocks.passive };
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
            gap,
            places: columns.places,
        })
    }

    /// The column of a coordinate of the mechanism (place in `q`) among those of driven joints and,
    /// after them, of passive ones.
    pub(crate) fn column(&self, coordinate: usize) -> usize {
        let (driven, place) = self.places[coordinate];
        if driven { place } else { self.actuated.len() + place }
    }
}

/// The coordinates of the tree, then those of closing joints, as driven and passive columns.
#[derive(Default)]
struct Columns {
    actuated: Vec<String>,
    passive: Vec<String>,
    actuated_units: Vec<Unit>,
    passive_units: Vec<Unit>,
    /// Of every coordinate: whether it is driven, and its column among those of its sort.
    places: Vec<(bool, usize)>,
}

impl Columns {
    fn of(mechanism: &Mechanism, loops: &[&LoopJoint]) -> Self {
        let mut columns = Self::default();
        columns.places.reserve(mechanism.n() + loops.len());
        let mut add = |name: &String, unit: Unit, driven: bool| {
            let (names, units) = if driven {
                (&mut columns.actuated, &mut columns.actuated_units)
            } else {
                (&mut columns.passive, &mut columns.passive_units)
            };
            columns.places.push((driven, names.len()));
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

/// What the rate of a closing joint of one coordinate measures.
pub(super) fn rate_unit(joint: &LoopJoint) -> Unit {
    if joint.kind == JointKind::Prismatic { Unit::Length } else { Unit::Angle }
}

/// Calls `f(row, coordinate, rate)` for every coordinate of the tree that opens a row, the place of
/// the row among `rows` and its rate by that coordinate. A coordinate may come several times (mimic
/// joints): its rates add up.
pub(super) fn for_each_rate(state: &State, rows: &[Row], mut f: impl FnMut(usize, usize, f64)) {
    let mechanism = state.mechanism();
    // The rows of a pair stand together: its two links are walked once, and up to where they meet,
    // since what moves both does not open the pair.
    let mut from = 0;
    for pair in rows.chunk_by(|x, y| (x.a, x.b) == (y.a, y.b)) {
        let tip = |link| state.tip(mechanism.link_frame(link).into());
        let (a, b) = (tip(pair[0].a), tip(pair[0].b));
        let common = a.common_slot(&b);
        for (link, sign) in [(a, -1.0), (b, 1.0)] {
            link.for_each_column_above(common, Vec3::ZERO, |_, c, twist| {
                for (i, row) in pair.iter().enumerate() {
                    f(from + i, c, sign * twist.power(row.wrench));
                }
            });
        }
        from += pair.len();
    }
}

impl Row {
    /// The residual with lengths over `length`.
    pub(super) fn scaled_residual(&self, length: f64) -> f64 {
        self.residual / self.unit.size(length)
    }
}

/// Rows of all closing joints and contacts, the closing joints that have a rate, and the gap.
pub(super) fn rows(state: &State) -> Result<(Vec<Row>, Vec<&LoopJoint>, Gap)> {
    let mechanism = state.mechanism();
    let dimension = mechanism.dimension();
    let pose = |link| state.pose(mechanism.link_frame(link));
    let (mut rows, mut rated) = (Vec::new(), Vec::new());
    for (place, joint) in mechanism.loops().iter().enumerate() {
        let pair = Pair::new(
            place,
            [joint.a, joint.b],
            pose(joint.a) * joint.link_a_from_joint,
            pose(joint.b) * joint.link_b_from_joint,
        );
        let mut held = joint.kind.held(joint.axis, dimension);
        if let (JointKind::Universal { second }, Dimension::Spatial) = (joint.kind, dimension) {
            held.pop();
            rows.extend(pair.crossed(joint.axis, second));
        }
        rows.extend(pair.rows(&held));
        let along = joint.axis;
        let measure = match joint.kind {
            JointKind::Revolute | JointKind::Continuous | JointKind::Helical { .. } => {
                Some(Wrench { force: Vec3::ZERO, moment: along })
            }
            JointKind::Prismatic => Some(Wrench { force: along, moment: Vec3::ZERO }),
            _ => None,
        };
        match measure {
            Some(w) => {
                rows.push(Row { rate_of: Some(rated.len()), residual: 0.0, ..pair.row(w) });
                rated.push(joint);
            }
            None if joint.actuated => {
                return Err(Error::Model {
                    model: mechanism.name().to_owned(),
                    culprit: joint.name.clone(),
                    message: format!(
                        "joint '{}' closes a loop, is {} and driven; a motor needs a joint of one \
                         coordinate: drive another, or write it as joints in a row",
                        joint.name,
                        joint.kind.name()
                    ),
                });
            }
            None => {}
        }
    }
    for (place, contact) in mechanism.contacts().iter().enumerate() {
        let pair = Pair::new(
            mechanism.loops().len() + place,
            [contact.a, contact.b],
            pose(contact.a) * contact.link_a_from_contact,
            pose(contact.b) * contact.link_b_from_contact,
        );
        rows.extend(pair.rows(&contact.kind.held(dimension)));
    }
    let mut gap = Gap::default();
    for row in &rows {
        let widest = match row.unit {
            Unit::Length => &mut gap.distance,
            Unit::Angle => &mut gap.angle,
        };
        *widest = widest.max(row.residual.abs());
    }
    Ok((rows, rated, gap))
}

/// The two frames of a closing joint or contact.
struct Pair {
    place: usize,
    ends: [usize; 2],
    world_from_a: Pose,
    world_from_b: Pose,
    /// Where the second frame is, and how it is turned, seen from the first.
    offset: Vec3,
    turn: Vec3,
}

impl Pair {
    fn new(place: usize, ends: [usize; 2], world_from_a: Pose, world_from_b: Pose) -> Self {
        let a_from_b = world_from_a.inverse() * world_from_b;
        let (offset, turn) = (a_from_b.translation, a_from_b.rotation.log());
        Self { place, ends, world_from_a, world_from_b, offset, turn }
    }

    /// The rows of all that is held. Where two moments are, they hold the direction of the axis
    /// across them, and residuals about them are those of the shortest turn of that axis: rates of
    /// the whole turn would be right only where the joint is at zero.
    fn rows(&self, held: &[Wrench]) -> Vec<Row> {
        let moments: Vec<Vec3> =
            held.iter().filter(|w| w.force == Vec3::ZERO).map(|w| w.moment).collect();
        let mut rows: Vec<Row> = held.iter().map(|w| self.row(*w)).collect();
        if let [first, second] = moments[..] {
            let axis = first.cross(second);
            let turned = self.world_from_a.rotation.inverse() * (self.world_from_b.rotation * axis);
            let across = axis.cross(turned);
            if let Some(about) = across.unit(0.0) {
                let tilt = about * across.norm().atan2(axis.dot(turned));
                for (row, w) in rows.iter_mut().zip(held).filter(|(_, w)| w.force == Vec3::ZERO) {
                    row.residual = w.moment.dot(tilt);
                }
            }
        }
        rows
    }

    /// What holds `held`, a wrench in the first frame: forces act where the second one is.
    fn row(&self, held: Wrench) -> Row {
        let at = Pose {
            rotation: self.world_from_a.rotation,
            translation: self.world_from_b.translation,
        };
        Row {
            wrench: at.coadjoint(held),
            pair: self.place,
            a: self.ends[0],
            b: self.ends[1],
            unit: if held.force == Vec3::ZERO { Unit::Angle } else { Unit::Length },
            rate_of: None,
            residual: held.force.dot(self.offset) + held.moment.dot(self.turn),
        }
    }

    /// The moment of a universal joint: normal to an axis of either body, wherever they have
    /// turned, whose angle is held.
    fn crossed(&self, first: Vec3, second: Vec3) -> Option<Row> {
        let turned = self.world_from_a.rotation.inverse() * (self.world_from_b.rotation * second);
        let across = first.cross(turned);
        let normal = across.unit(0.0)?;
        let residual = (first.dot(second) - first.dot(turned)) / across.norm();
        Some(Row { residual, ..self.row(Wrench { force: Vec3::ZERO, moment: normal }) })
    }
}
