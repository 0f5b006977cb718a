//! Constraint rows: the wrenches constrained by loop joints and contacts, at a configuration.
//!
//! Formula  h . (J_b - J_a) q for every constraint wrench h between links a and b, and its residual
//! Shapes   a row for each constraint wrench, and one for the rate of a loop joint of one
//!          coordinate
//! Units    m, rad
//! Frame    world axes, wrenches at the second frame of their pair: moments about a far origin would
//!          cancel to rounding
//! Source   `closed_chain.rs`; the wrenches: `model/constraint_wrenches.rs`
//! Checked  tests/it/closure/graph.rs

use super::loop_closure_error::LoopClosureError;
use super::velocity_constraint::Unit;
use crate::error::{Error, Result};
use crate::kinematics::State;
use crate::model::{Dimension, JointKind, LoopJoint, Mechanism};
use crate::spatial::{Pose, Vec3, Wrench};

/// A row: a constrained relative motion of two links, in world axes.
#[derive(Debug, Clone)]
pub(crate) struct ConstraintRow {
    /// The wrench whose power with the motion of `b` relative to `a` is measured, at `point`.
    pub(crate) wrench: Wrench,
    /// The point (m) at which it acts, the same for all rows of a pair.
    pub(crate) point: Vec3,
    /// Index of its joint or contact: loop joints first, then contacts.
    pub(crate) pair: usize,
    pub(crate) a: usize,
    pub(crate) b: usize,
    pub(crate) unit: Unit,
    /// Index among the loop joints of one coordinate, if the row measures the rate of one.
    pub(crate) rate_of: Option<usize>,
    /// Violation of the constraint (m or rad); its derivative is `wrench . (J_b - J_a) q` where it
    /// vanishes.
    pub(crate) residual: f64,
}

/// The unit of the rate of a loop joint of one coordinate.
pub(crate) fn rate_unit(joint: &LoopJoint) -> Unit {
    if joint.kind == JointKind::Prismatic { Unit::Length } else { Unit::Angle }
}

/// Calls `f(row, coordinate, rate)` for every coordinate of the tree that changes a row, with the
/// index of the row in `rows` and its rate per unit of the coordinate. A coordinate may occur
/// several times (mimic joints): its rates add up.
pub(crate) fn for_each_rate(
    state: &State,
    rows: &[ConstraintRow],
    mut f: impl FnMut(usize, usize, f64),
) {
    let mechanism = state.mechanism();
    // The rows of a pair are adjacent. Both links are walked once, up to their common ancestor:
    // motions of that ancestor do not change the row.
    let mut from = 0;
    for pair in rows.chunk_by(|x, y| x.pair == y.pair) {
        let tip = |link| state.tip(mechanism.link_frame(link));
        let (a, b) = (tip(pair[0].a), tip(pair[0].b));
        let common = a.common_slot(&b);
        for (link, sign) in [(a, -1.0), (b, 1.0)] {
            link.for_each_column_above(common, pair[0].point, |_, c, twist| {
                for (i, row) in pair.iter().enumerate() {
                    f(from + i, c, sign * twist.power(row.wrench));
                }
            });
        }
        from += pair.len();
    }
}

impl ConstraintRow {
    /// The residual, with lengths divided by `length`.
    pub(crate) fn scaled_residual(&self, length: f64) -> f64 {
        self.residual / self.unit.size(length)
    }
}

/// The constraints of a loop joint or contact, independent of the configuration.
#[derive(Debug, Clone)]
pub(crate) struct PairConstraints {
    /// Indices of its two links.
    pub(crate) ends: [usize; 2],
    /// Its frames on them.
    pub(crate) frames: [Pose; 2],
    /// Constraint wrenches in the first frame, except the moment of a universal joint.
    pub(crate) wrenches: Vec<Wrench>,
    /// The axes of a universal joint, in the frames of its first and its second link.
    pub(crate) crossed: Option<[Vec3; 2]>,
    /// The wrench that measures the rate of a loop joint of one coordinate.
    pub(crate) measure: Option<Wrench>,
}

/// The constraints of all loop joints, then of all contacts.
pub(crate) fn pair_constraints(
    mechanism: &Mechanism,
) -> impl Iterator<Item = Result<PairConstraints>> {
    let dimension = mechanism.dimension();
    let loops = mechanism.loops().iter().map(move |joint| {
        let measure = measure(joint);
        if measure.is_none() && joint.actuated {
            return Err(Error::Model {
                model: mechanism.name().to_owned(),
                culprit: joint.name.clone(),
                message: format!(
                    "loop joint '{}' is {} and actuated; only joints of one coordinate can be \
                     actuated loop joints: actuate another joint, or model it as joints in series",
                    joint.name,
                    joint.kind.name()
                ),
            });
        }
        let mut wrenches = joint.kind.constraint_wrenches(joint.axis, dimension);
        let mut crossed = None;
        if let (JointKind::Universal { second }, Dimension::Spatial) = (joint.kind, dimension) {
            wrenches.pop();
            crossed = Some([joint.axis, second]);
        }
        Ok(PairConstraints {
            ends: [joint.a, joint.b],
            frames: [joint.link_a_from_joint, joint.link_b_from_joint],
            wrenches,
            crossed,
            measure,
        })
    });
    let contacts = mechanism.contacts().iter().map(move |contact| {
        Ok(PairConstraints {
            ends: [contact.a, contact.b],
            frames: [contact.link_a_from_contact, contact.link_b_from_contact],
            wrenches: contact.kind.constraint_wrenches(dimension),
            crossed: None,
            measure: None,
        })
    });
    loops.chain(contacts)
}

/// The wrench that measures the rate of a loop joint of one coordinate.
fn measure(joint: &LoopJoint) -> Option<Wrench> {
    match joint.kind {
        JointKind::Revolute | JointKind::Continuous | JointKind::Helical { .. } => {
            Some(Wrench { force: Vec3::ZERO, moment: joint.axis })
        }
        JointKind::Prismatic => Some(Wrench { force: joint.axis, moment: Vec3::ZERO }),
        _ => None,
    }
}

/// The loop joints of one coordinate.
pub(crate) fn joints_with_rate(mechanism: &Mechanism) -> Vec<&LoopJoint> {
    mechanism.loops().iter().filter(|joint| measure(joint).is_some()).collect()
}

/// The rows of all loop joints and contacts, the loop joints of one coordinate, and the
/// loop-closure error.
pub(crate) fn constraint_rows(
    state: &State,
) -> Result<(Vec<ConstraintRow>, Vec<&LoopJoint>, LoopClosureError)> {
    let mechanism = state.mechanism();
    let (mut rows, mut rates) = (Vec::new(), 0);
    for (place, constraints) in pair_constraints(mechanism).enumerate() {
        constraints?.load(place, state, &mut rates, &mut rows);
    }
    let closure_error = closure_error(&rows);
    Ok((rows, joints_with_rate(mechanism), closure_error))
}

fn closure_error(rows: &[ConstraintRow]) -> LoopClosureError {
    let mut closure_error = LoopClosureError::default();
    rows.iter().for_each(|row| closure_error.widen(row.unit, row.residual));
    closure_error
}

impl PairConstraints {
    /// Adds the rows of this pair, the one in `place`; `rates` counts the loop joints of one
    /// coordinate.
    fn load(&self, place: usize, state: &State, rates: &mut usize, rows: &mut Vec<ConstraintRow>) {
        let [a, b] = self.ends;
        let on = [state.link_pose(a) * self.frames[0], state.link_pose(b) * self.frames[1]];
        let pair = KinematicPair::new(place, self.ends, on);
        rows.extend(self.crossed.and_then(|[first, second]| pair.crossed(first, second)));
        rows.extend(pair.rows(&self.wrenches));
        if let Some(w) = self.measure {
            rows.push(ConstraintRow { rate_of: Some(*rates), ..pair.row(w) });
            *rates += 1;
        }
    }
}

/// The constraints of all loop joints and contacts of a mechanism, for rows at many configurations.
#[derive(Debug, Clone)]
pub(crate) struct ConstraintRows {
    pairs: Vec<PairConstraints>,
}

impl ConstraintRows {
    /// # Errors
    /// An actuated loop joint of several coordinates.
    pub(crate) fn of(mechanism: &Mechanism) -> Result<Self> {
        Ok(Self { pairs: pair_constraints(mechanism).collect::<Result<_>>()? })
    }

    /// Largest number of rows of each loop joint and contact; universal joints with both axes along
    /// one line have fewer.
    pub(crate) fn most_rows(&self) -> impl Iterator<Item = usize> + '_ {
        self.pairs.iter().map(|p| {
            p.wrenches.len() + usize::from(p.crossed.is_some()) + usize::from(p.measure.is_some())
        })
    }

    /// The rows at a configuration, without allocation where `rows` has the room, and the
    /// loop-closure error.
    pub(crate) fn load(&self, state: &State, rows: &mut Vec<ConstraintRow>) -> LoopClosureError {
        rows.clear();
        let mut rates = 0;
        for (place, constraints) in self.pairs.iter().enumerate() {
            constraints.load(place, state, &mut rates, rows);
        }
        closure_error(rows)
    }
}

/// A kinematic pair at a configuration: the two frames of a loop joint or contact.
pub(crate) struct KinematicPair {
    place: usize,
    ends: [usize; 2],
    world_from_a: Pose,
    world_from_b: Pose,
    /// Position and rotation vector of the second frame, in the first.
    offset: Vec3,
    turn: Vec3,
}

impl KinematicPair {
    pub(crate) fn new(
        place: usize,
        ends: [usize; 2],
        [world_from_a, world_from_b]: [Pose; 2],
    ) -> Self {
        let a_from_b = world_from_a.inverse() * world_from_b;
        let (offset, turn) = (a_from_b.translation, a_from_b.rotation.log());
        Self { place, ends, world_from_a, world_from_b, offset, turn }
    }

    /// The rows of these constraint wrenches, with residuals.
    pub(crate) fn rows(&self, wrenches: &[Wrench]) -> impl Iterator<Item = ConstraintRow> {
        let tilt = self.tilt(wrenches);
        wrenches
            .iter()
            .map(move |w| ConstraintRow { residual: self.residual(*w, tilt), ..self.row(*w) })
    }

    /// The loop-closure error along and about the constraint wrenches.
    pub(crate) fn closure_error(&self, wrenches: &[Wrench]) -> LoopClosureError {
        let tilt = self.tilt(wrenches);
        let mut closure_error = LoopClosureError::default();
        wrenches.iter().for_each(|w| closure_error.widen(unit(*w), self.residual(*w, tilt)));
        closure_error
    }

    /// Two constrained moments constrain the direction of the axis normal to both: their residuals
    /// are components of the shortest rotation of that axis. Components of the whole rotation
    /// vector would have the right derivative at the zero of the joint only.
    fn tilt(&self, wrenches: &[Wrench]) -> Option<Vec3> {
        let mut moments = wrenches.iter().filter(|w| unit(**w) == Unit::Angle).map(|w| w.moment);
        let (Some(first), Some(second), None) = (moments.next(), moments.next(), moments.next())
        else {
            return None;
        };
        let axis = first.cross(second);
        let turned = self.world_from_a.rotation.inverse() * (self.world_from_b.rotation * axis);
        let across = axis.cross(turned);
        Some(across.unit(0.0)? * across.norm().atan2(axis.dot(turned)))
    }

    fn residual(&self, wrench: Wrench, tilt: Option<Vec3>) -> f64 {
        match (unit(wrench), tilt) {
            (Unit::Angle, Some(tilt)) => wrench.moment.dot(tilt),
            _ => wrench.force.dot(self.offset) + wrench.moment.dot(self.turn),
        }
    }

    /// The row of a wrench given in the first frame, as if the pair were closed: forces act at the
    /// second frame.
    fn row(&self, wrench: Wrench) -> ConstraintRow {
        let axes = self.world_from_a.rotation;
        ConstraintRow {
            wrench: Wrench { force: axes * wrench.force, moment: axes * wrench.moment },
            point: self.world_from_b.translation,
            pair: self.place,
            a: self.ends[0],
            b: self.ends[1],
            unit: unit(wrench),
            rate_of: None,
            residual: 0.0,
        }
    }

    /// The moment row of a universal joint: normal to the axis of each body at any rotation; the
    /// angle between the axes is constrained.
    fn crossed(&self, first: Vec3, second: Vec3) -> Option<ConstraintRow> {
        let turned = self.world_from_a.rotation.inverse() * (self.world_from_b.rotation * second);
        let across = first.cross(turned);
        let normal = across.unit(0.0)?;
        let residual = (first.dot(second) - first.dot(turned)) / across.norm();
        Some(ConstraintRow { residual, ..self.row(Wrench { force: Vec3::ZERO, moment: normal }) })
    }
}

/// The unit of the residual of a wrench: length if there is a force.
pub(crate) fn unit(wrench: Wrench) -> Unit {
    if wrench.force == Vec3::ZERO { Unit::Angle } else { Unit::Length }
}

impl LoopClosureError {
    /// The loop-closure error of the loops and contacts of `state`.
    ///
    /// ```
    /// use cylindroid::closure::LoopClosureError;
    ///
    /// let five_bar = cylindroid::load("five-bar")?;
    /// let open = LoopClosureError::of(&five_bar.state(&[0.1, 0.0, 0.0, 0.0])?)?;
    /// assert!(open.distance > 0.01 && !open.is_closed(five_bar.reach()));
    /// # Ok::<(), cylindroid::Error>(())
    /// ```
    ///
    /// # Errors
    /// An actuated loop joint of several coordinates.
    pub fn of(state: &State) -> Result<Self> {
        Ok(constraint_rows(state)?.2)
    }
}
