//! Elastic chains: the constraint of a mechanism whose joints and links deflect.
//!
//! Formula  elastic coordinates e with stiffness k: a coordinate of a joint with a stiffness along
//!          its motion, and for a compliance matrix C (at its frame, lengths scaled by l)
//!          C' = sum c_j v_j v_j^T the deflections along its eigenvectors, k_j = 1 / c_j. Each
//!          moves all that lies beyond its joint or link in the spanning tree; one of a loop joint
//!          or contact moves its second link relative to the first. The constraint is
//!          J_e e + J_p q_p - G^T u = 0
//! Shapes   t rows as of the [`ClosedChain`]; elastic coordinates, free passive coordinates
//! Units    k: N m/rad (N/m for lengths)
//! Valid    small deflections about an unloaded configuration. Actuated coordinates without a
//!          stiffness are locked and have no column, passive ones with a stiffness are springs
//! Why so   eigenvectors of a compliance that is zero in some directions leave these rigid: no
//!          large numbers stand for infinite ones
//! Source   virtual joint method: Pashkevich, Klimchik & Chablat 2011
//! Checked  tests/it/manipulability/stiffness.rs

use crate::closure::constraint::closed_chain::ClosedChain;
use crate::closure::constraint::constraint_rows::{
    ConstraintRow, constraint_rows, joints_with_rate,
};
use crate::closure::constraint::velocity_constraint::{Constraint, ConstraintBlocks, Unit, Units};
use crate::error::{Error, Result};
use crate::kinematics::State;
use crate::linalg::{Matrix, SymmetricEigen};
use crate::model::{ElasticBody, ElasticElement, ElasticKind, Elasticity, Mechanism};
use crate::spatial::{Pose, Twist, Vec3};
use crate::tolerance::RIGID;

/// A constraint whose first columns are elastic coordinates.
#[derive(Debug, Clone)]
pub(crate) struct ElasticChain {
    pub(crate) constraint: Constraint,
    pub(crate) units: Units,
    /// Of each elastic coordinate.
    pub(crate) stiffness: Vec<f64>,
    /// The parts in the order of the elasticity.
    pub(crate) parts: Vec<ElasticPart>,
}

/// The columns of an elastic part.
#[derive(Debug, Clone)]
pub(crate) struct ElasticPart {
    pub(crate) name: String,
    /// Its elastic coordinates.
    pub(crate) columns: std::ops::Range<usize>,
    /// The twist of each in the frame of the part; the unit vector of a coordinate of a joint.
    pub(crate) directions: Matrix,
}

impl ElasticChain {
    pub(crate) fn of(state: &State, chain: &ClosedChain, elasticity: &Elasticity) -> Result<Self> {
        let mechanism = state.mechanism();
        elasticity.check(mechanism)?;
        let own = &chain.constraint;
        let (a, p) = (own.actuated(), own.passive());
        let mut builder = Columns {
            state,
            chain,
            rows: constraint_rows(state)?.0,
            elastic: Vec::new(),
            units: Vec::new(),
            stiffness: Vec::new(),
        };
        let mut used = vec![false; a + p];
        let mut parts = Vec::new();
        for element in &elasticity.elements {
            let from = builder.elastic.len();
            let directions = match &element.kind {
                ElasticKind::Motion { stiffness } => {
                    let columns = motion_columns(mechanism, chain, &element.name);
                    for &column in &columns {
                        if std::mem::replace(&mut used[column], true) {
                            return Err(Error::InvalidOption {
                                option: "elasticity",
                                value: element.name.clone(),
                                reason: "two stiffnesses are given for one coordinate; keep one"
                                    .to_owned(),
                            });
                        }
                        builder.motion(column, *stiffness);
                    }
                    Matrix::identity(columns.len())
                }
                ElasticKind::Joint(body) => builder.joint(element, body),
                ElasticKind::Link(body) => builder.link(element, body),
            };
            let columns = from..builder.elastic.len();
            parts.push(ElasticPart { name: element.name.clone(), columns, directions });
        }
        let free: Vec<usize> = (a..a + p).filter(|&j| !used[j]).collect();
        let t = own.rows();
        let blocks = ConstraintBlocks {
            actuated: Matrix::from_fn(t, builder.elastic.len(), |i, j| builder.elastic[j][i]),
            passive: Matrix::from_fn(t, free.len(), |i, j| own.blocks().passive[(i, free[j] - a)]),
            grasp: own.blocks().grasp.clone(),
        };
        let units = Units {
            rows: chain.units.rows.clone(),
            actuated: builder.units,
            passive: free.iter().map(|&j| chain.units.passive[j - a]).collect(),
            object: chain.units.object.clone(),
        };
        let constraint = Constraint::new(blocks)?.with_length(&units, own.length())?;
        Ok(Self { constraint, units, stiffness: builder.stiffness, parts })
    }
}

/// Columns (actuated, then passive) of the coordinates of a joint, or of one coordinate.
fn motion_columns(mechanism: &Mechanism, chain: &ClosedChain, name: &str) -> Vec<usize> {
    if let Some(joint) = mechanism.joints().iter().find(|j| j.name == name) {
        return joint.coordinates.clone().map(|c| chain.column(c)).collect();
    }
    let rates = joints_with_rate(mechanism);
    let place = match rates.iter().position(|l| l.name == name) {
        Some(rate) => Some(mechanism.n() + rate),
        None => mechanism.coordinates().iter().position(|c| c.name == name),
    };
    place.into_iter().map(|c| chain.column(c)).collect()
}

/// Elastic columns while they are made.
struct Columns<'a> {
    state: &'a State,
    chain: &'a ClosedChain,
    rows: Vec<ConstraintRow>,
    elastic: Vec<Vec<f64>>,
    units: Vec<Unit>,
    stiffness: Vec<f64>,
}

impl Columns<'_> {
    fn motion(&mut self, column: usize, stiffness: f64) {
        let own = &self.chain.constraint;
        let a = own.actuated();
        let blocks = own.blocks();
        let (block, unit) = if column < a {
            (blocks.actuated.column(column), self.chain.units.actuated[column])
        } else {
            (blocks.passive.column(column - a), self.chain.units.passive[column - a])
        };
        self.elastic.push(block.to_vec());
        self.units.push(unit);
        self.stiffness.push(stiffness);
    }

    fn joint(&mut self, element: &ElasticElement, body: &ElasticBody) -> Matrix {
        let mechanism = self.state.mechanism();
        if let Some(joint) = mechanism.joints().iter().find(|j| j.name == element.name) {
            let frame = self.state.link_pose(joint.parent) * joint.parent_from_joint;
            return self.beyond(body, joint.child, frame);
        }
        let loops = mechanism.loops().iter().map(|l| (&l.name, l.a, l.link_a_from_joint));
        let contacts = mechanism.contacts().iter().map(|c| (&c.name, c.a, c.link_a_from_contact));
        let Some((pair, (_, a, link_from_joint))) =
            loops.chain(contacts).enumerate().find(|(_, (name, ..))| **name == element.name)
        else {
            return Matrix::zeros(0, 0); // checked before
        };
        let frame = self.state.link_pose(a) * link_from_joint;
        self.body(body, frame, |row| if row.pair == pair { -1.0 } else { 0.0 }, 0.0)
    }

    fn link(&mut self, element: &ElasticElement, body: &ElasticBody) -> Matrix {
        let links = self.state.mechanism().links();
        let link = links.iter().position(|l| l.name == element.name).unwrap_or(0);
        self.beyond(body, link, self.state.link_pose(link))
    }

    /// A deflection that moves everything from `link` on.
    fn beyond(&mut self, body: &ElasticBody, link: usize, frame: Pose) -> Matrix {
        let mechanism = self.state.mechanism();
        let mut moved = vec![false; mechanism.links().len()];
        moved[link] = true;
        for joint in mechanism.joints() {
            moved[joint.child] |= moved[joint.parent];
        }
        let sign = |link: usize| if moved[link] { 1.0 } else { 0.0 };
        let reference = sign(mechanism.frame_of(self.chain.reference).link);
        self.body(body, frame, |row| sign(row.b) - sign(row.a), reference)
    }

    /// The deflections of a compliance matrix at `frame` (or at its own), which move the second link
    /// of a row relative to the first by `sign`, and the reference link by `reference`.
    fn body(
        &mut self,
        body: &ElasticBody,
        frame: Pose,
        sign: impl Fn(&ConstraintRow) -> f64,
        reference: f64,
    ) -> Matrix {
        let mechanism = self.state.mechanism();
        let frame = match &body.frame {
            None => frame,
            Some((link, pose)) => {
                let place = mechanism.links().iter().position(|l| l.name == *link).unwrap_or(0);
                self.state.link_pose(place) * *pose
            }
        };
        let components = mechanism.dimension().components();
        let object = self.state.pose_of(self.chain.reference).translation;
        let (directions, stiffness) = self.principal(body);
        for (j, k) in stiffness.iter().enumerate() {
            let mut twist = [0.0; 6];
            components.iter().zip(directions.column(j)).for_each(|(&c, x)| twist[c] = *x);
            let local = Twist::from_array(twist);
            let (linear, angular) = (frame.rotation * local.linear, frame.rotation * local.angular);
            let at = |p: Vec3| Twist { linear, angular }.at_point(p - frame.translation);
            let mut column: Vec<f64> = self
                .rows
                .iter()
                .map(|row| match sign(row) {
                    0.0 => 0.0,
                    sign => sign * at(row.point).power(row.wrench),
                })
                .collect();
            let twist = at(object).to_array();
            column.extend(components.iter().map(|&c| reference * twist[c]));
            self.elastic.push(column);
            self.units.push(Unit::Angle);
            self.stiffness.push(*k);
        }
        directions
    }

    /// Principal twists of a compliance in scaled coordinates, and their stiffness.
    fn principal(&self, body: &ElasticBody) -> (Matrix, Vec<f64>) {
        let d = body.compliance.rows();
        let length = self.chain.constraint.length();
        let scale: Vec<f64> = self.chain.units.object.iter().map(|u| u.size(length)).collect();
        let mut scaled = [[0.0; 6]; 6];
        for (i, row) in scaled.iter_mut().enumerate().take(d) {
            for (j, entry) in row.iter_mut().enumerate().take(d) {
                *entry = body.compliance[(i, j)] / (scale[i] * scale[j]);
            }
        }
        let eigen = SymmetricEigen::of(scaled, d);
        let largest = eigen.values[0].max(0.0);
        let soft = eigen.values[..d].iter().take_while(|v| **v > RIGID * largest).count();
        let directions = Matrix::from_fn(d, soft, |i, j| scale[i] * eigen.vectors[j][i]);
        (directions, eigen.values[..soft].iter().map(|v| v.recip()).collect())
    }
}
