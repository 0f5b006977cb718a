//! The motions of a platform with one limb only.
//!
//! Formula  for every loop joint and contact of the limb between links a and b and each of its
//!          constraint wrenches h: h . (T_b - T_a) = 0; a link beyond the platform in the spanning
//!          tree has the twist T + J q, another J q; the platform itself T - J q = 0. q: coordinates
//!          of the limb and rates of its actuated loop joints, T: twist of the platform
//! Shapes   T: d entries (vx, vy, wz in the plane, 6 in space), the last ones of a motion
//! Units    divided by the characteristic length; T . w is a power divided by it
//! Frame    T and wrenches at the reference point, world axes
//! Why so   the same rows as those of the whole mechanism, so that planar joints, contacts, mimic
//!          joints and loops within a limb need no rules of their own
//! Checked  tests/it/closure/limbs.rs

use super::limb_graph::{EdgeKind, LimbEdges};
use crate::closure::constraint::constraint_rows::{ConstraintRow, joints_with_rate, rate_unit};
use crate::closure::constraint::velocity_constraint::Unit;
use crate::kinematics::State;
use crate::linalg::{ColumnSpace, Matrix, Threshold};
use crate::model::{FrameId, Mechanism};
use crate::spatial::{Twist, Vec3, Wrench};
use crate::tolerance::{CLOSURE_BLOCK, CLOSURE_RANK, KERNEL_ROUNDING};

/// Twists and wrenches as scaled columns at the reference point.
#[derive(Debug, Clone)]
pub(crate) struct PlatformCoordinates {
    pub(crate) frame: FrameId,
    /// The reference point.
    pub(crate) origin: Vec3,
    pub(crate) length: f64,
    pub(crate) components: &'static [usize],
}

impl PlatformCoordinates {
    pub(crate) fn of(mechanism: &Mechanism, state: &State, frame: FrameId, length: f64) -> Self {
        let origin = state.pose_of(frame).translation;
        Self { frame, origin, length, components: mechanism.dimension().components() }
    }

    pub(crate) fn d(&self) -> usize {
        self.components.len()
    }

    fn six(&self, column: &[f64], [linear, angular]: [f64; 2]) -> [f64; 6] {
        let mut all = [0.0; 6];
        for (&i, x) in self.components.iter().zip(column) {
            all[i] = x * if i < 3 { linear } else { angular };
        }
        all
    }

    /// At the reference point.
    pub(crate) fn twist(&self, column: &[f64]) -> Twist {
        Twist::from_array(self.six(column, [self.length, 1.0]))
    }

    /// At the reference point.
    pub(crate) fn wrench(&self, column: &[f64]) -> Wrench {
        Wrench::from_array(self.six(column, [1.0, self.length]))
    }

    /// The scaled entries of a wrench at the reference point.
    pub(crate) fn column(&self, wrench: Wrench) -> Vec<f64> {
        let all = wrench.to_array();
        let size = |i: usize| if i < 3 { 1.0 } else { self.length };
        self.components.iter().map(|&i| all[i] / size(i)).collect()
    }

    /// The columns of `space` less their parts in `other`, all taken at the point `at`.
    pub(crate) fn orthogonal_at(&self, at: Vec3, space: &Matrix, other: &Matrix) -> Matrix {
        let arm = at - self.origin;
        let moved = |m: &Matrix, arm: Vec3| {
            let columns: Vec<Vec<f64>> = (0..m.cols())
                .map(|j| self.column(self.wrench(m.column(j)).at_point(arm)))
                .collect();
            Matrix::from_fn(self.d(), m.cols(), |i, j| columns[j][i])
        };
        let there = ColumnSpace::of(&moved(other, arm), Threshold::Relative(CLOSURE_RANK)).basis();
        let space = moved(space, arm);
        let shares = &there.transpose() * &space;
        let inside = &there * &shares;
        let outside =
            Matrix::from_fn(self.d(), space.cols(), |i, j| space[(i, j)] - inside[(i, j)]);
        moved(&outside, -arm)
    }
}

/// A coordinate of a limb, or the rate of one of its loop joints.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct LimbColumn {
    pub(crate) edge: EdgeKind,
    pub(crate) name: String,
    pub(crate) actuated: bool,
    /// Index into q, or n + index among loop joints with a rate.
    place: usize,
    pub(crate) size: f64,
}

/// The velocity constraint of a limb with its platform.
#[derive(Debug, Clone)]
pub(crate) struct LimbConstraint {
    pub(crate) columns: Vec<LimbColumn>,
    /// Scaled; the columns of T last.
    matrix: Matrix,
    d: usize,
    /// True if no loop of the limb itself constrains its coordinates.
    open: bool,
}

impl LimbConstraint {
    pub(crate) fn of(
        state: &State,
        limb: &LimbEdges,
        rows: &[ConstraintRow],
        platform: &PlatformCoordinates,
    ) -> Self {
        let mechanism = state.mechanism();
        let columns = columns(mechanism, limb, platform.length);
        let own: Vec<&ConstraintRow> = rows.iter().filter(|r| holds(mechanism, limb, r)).collect();
        let carries = limb.edges.iter().any(|e| match e.kind {
            EdgeKind::Joint(_) => e.bodies[1] == limb.platform,
            _ => false,
        });
        let (d, k) = (platform.d(), columns.len());
        let mut matrix = Matrix::zeros(own.len() + if carries { d } else { 0 }, k + d);
        let column_of = |place: usize| columns.iter().position(|c| c.place == place);
        let target = state.tip(platform.frame);
        for (i, row) in own.iter().enumerate() {
            let size = row.unit.size(platform.length);
            for (link, sign) in [(row.a, -1.0), (row.b, 1.0)] {
                let tip = state.tip(mechanism.link_frame(link));
                let beyond = tip.common_slot(&target) == limb.platform;
                let end = if beyond { limb.platform } else { 0 };
                tip.for_each_column_above(end, row.point, |_, c, twist| {
                    if let Some(j) = column_of(c) {
                        matrix[(i, j)] += sign * twist.power(row.wrench) * columns[j].size / size;
                    }
                });
                let moves = if beyond { d } else { 0 };
                for t in 0..moves {
                    let mut unit = vec![0.0; d];
                    unit[t] = 1.0;
                    let twist = platform.twist(&unit).at_point(row.point - platform.origin);
                    matrix[(i, k + t)] += sign * twist.power(row.wrench) / size;
                }
            }
            if let Some(j) = row.rate_of.and_then(|rate| column_of(mechanism.n() + rate)) {
                matrix[(i, j)] -= columns[j].size / size;
            }
        }
        if carries {
            target.for_each_column(platform.origin, |_, c, twist| {
                let (Some(j), twist) = (column_of(c), twist.to_array()) else { return };
                for (t, &i) in platform.components.iter().enumerate() {
                    let size = if i < 3 { platform.length } else { 1.0 };
                    matrix[(own.len() + t, j)] -= twist[i] * columns[j].size / size;
                }
            });
            (0..d).for_each(|t| matrix[(own.len() + t, k + t)] = 1.0);
        }
        Self { columns, matrix, d, open: own.is_empty() && carries }
    }

    /// The twists of the platform with the columns `locked` at rest, orthonormal, and the motions
    /// that they come from.
    pub(crate) fn twists(&self, locked: &dyn Fn(usize) -> bool) -> LimbMotion {
        let k = self.columns.len();
        let free: Vec<usize> = (0..k + self.d).filter(|&j| j >= k || !locked(j)).collect();
        let transposed =
            Matrix::from_fn(free.len(), self.matrix.rows(), |i, j| self.matrix[(j, free[i])]);
        if self.open {
            // Without loops the coordinates are independent: no kernel of all joints is needed.
            let columns =
                Matrix::from_fn(self.d, free.len() - self.d, |i, j| -self.matrix[(i, free[j])]);
            let basis = ColumnSpace::of(&columns, Threshold::Relative(CLOSURE_RANK)).basis();
            return LimbMotion { basis, twists: columns, rates: None };
        }
        let space = ColumnSpace::of(&transposed, Threshold::Relative(CLOSURE_RANK));
        let kernel = space.complement();
        let kept = space.values().get(space.rank().wrapping_sub(1)).copied();
        let largest = space.values().first().copied().unwrap_or(1.0);
        let conditioning = kept.map_or(1.0, |kept| largest / kept);
        let tolerance = CLOSURE_BLOCK.max(KERNEL_ROUNDING * conditioning);
        let from = free.len() - self.d;
        let twists = kernel.rows_between(from, free.len());
        let basis = ColumnSpace::of(&twists, Threshold::Absolute(tolerance)).basis();
        let place = |c: usize| free.iter().position(|&j| j == c);
        let rates = (0..k).map(|c| match place(c) {
            Some(i) => (0..kernel.cols()).map(|j| kernel[(i, j)] * self.columns[c].size).collect(),
            None => vec![0.0; kernel.cols()],
        });
        LimbMotion { rates: Some(rates.collect()), basis, twists }
    }
}

/// The motions of a platform with one limb.
#[derive(Debug, Clone)]
pub(crate) struct LimbMotion {
    /// Twists of the platform, orthonormal.
    pub(crate) basis: Matrix,
    /// Twists of the platform for each motion,
    pub(crate) twists: Matrix,
    /// and for each column of the limb its rate in each motion; `None` if motion j is a scaled unit
    /// rate of column j alone.
    pub(crate) rates: Option<Vec<Vec<f64>>>,
}

fn columns(mechanism: &Mechanism, limb: &LimbEdges, length: f64) -> Vec<LimbColumn> {
    let rated = joints_with_rate(mechanism);
    let mut all: Vec<LimbColumn> = Vec::new();
    for edge in &limb.edges {
        match edge.kind {
            EdgeKind::Joint(i) => {
                let joint = &mechanism.joints()[i];
                for c in joint.coordinates.clone().filter(|_| joint.mimic.is_none()) {
                    let coordinate = &mechanism.coordinates()[c];
                    all.push(LimbColumn {
                        edge: edge.kind,
                        name: coordinate.name.clone(),
                        actuated: coordinate.actuated,
                        place: c,
                        size: Unit::of(coordinate.kind).size(length),
                    });
                }
            }
            EdgeKind::Loop(i) => {
                let joint = &mechanism.loops()[i];
                if let Some(rate) = rated.iter().position(|l| l.name == joint.name) {
                    all.push(LimbColumn {
                        edge: edge.kind,
                        name: joint.name.clone(),
                        actuated: joint.actuated,
                        place: mechanism.n() + rate,
                        size: rate_unit(joint).size(length),
                    });
                }
            }
            EdgeKind::Contact(_) => {}
        }
    }
    all
}

/// True if the row is one of a loop joint or contact of the limb.
fn holds(mechanism: &Mechanism, limb: &LimbEdges, row: &ConstraintRow) -> bool {
    let loops = mechanism.loops().len();
    let kind = if row.pair < loops {
        EdgeKind::Loop(row.pair)
    } else {
        EdgeKind::Contact(row.pair - loops)
    };
    limb.edges.iter().any(|e| e.kind == kind)
}
