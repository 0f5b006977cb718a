//! The linear relation between actuated joints and object, and its dual: the forces that do no work
//! on it.
//!
//! Formula  R = {(q_a, u)}: rows q_a and u of the kernel, orthonormalised, CS decomposition [X C; Y
//!          S] Z^T; F = {(tau, w): tau^T q_a + w^T u = 0 on R} = R^perp, with the columns (-X S, Y
//!          C), h = (dom R)^perp and s = (ran R)^perp
//! Shapes   q_a and d rows, p = r' + i' + c' columns; F has q_a + d - p
//! Units    scaled by the characteristic length inside, those of the constraint outside
//! Frame    that of the object's twist; the wrench is taken at the same point
//! Valid    any constraint, including hyperstatic ones: only contact forces are undetermined there,
//!          not joint torques and wrenches
//! Why so   the paper's bases (eqs. 5 and 8) are not unique if passive joints or the object can
//!          compensate a motion of the actuated joints, and its eqs. 15 and 16 depend on the
//!          choice; the relation is unique
//! Source   Bicchi & Prattichizzo 1998, sections 2 to 4; virtual work for F
//! Checked  tests/it/closure/reference.rs, tests/it/closure/laws.rs

use std::ops::RangeInclusive;

use crate::closure::constraint::velocity_constraint::check_finite;
use crate::error::{Error, Result};
use crate::linalg::{
    ColumnSpace, CsDecomposition, Cut, Matrix, PairKind, Qr, Threshold, dot, max_abs, solve_upper,
};
use crate::scalar::power_of_two;
use crate::tolerance::{CLOSURE_BLOCK, MAX_MAGNITUDE};

/// What the largest entry of a row of a task map can be: its square is a number.
const TASK_ROWS: RangeInclusive<f64> = 1.0 / MAX_MAGNITUDE..=MAX_MAGNITUDE;

/// The counts of a relation.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct RelationDimensions {
    /// p: independent pairs of a joint motion and an object motion.
    pub relation: usize,
    /// c': motions of the object that require the actuated joints.
    pub coordinate: usize,
    /// r': motions of the actuated joints with the object at rest.
    pub redundancy: usize,
    /// i': motions of the object with the actuated joints at rest.
    pub indeterminacy: usize,
    /// h: joint torques in equilibrium without a wrench on the object (active internal forces).
    pub internal: usize,
    /// s: wrenches on the object in equilibrium without joint torques (structural forces).
    pub zero_torque: usize,
}

/// Bases of a relation by kind, in the units of the constraint. For the dual relation, rates are
/// torques and twists are wrenches.
#[derive(Debug, Clone, PartialEq)]
pub struct RelationBases {
    /// Joint motions without object motion, a column each.
    pub zero: Matrix,
    /// Object motions without joint motion.
    pub infinite: Matrix,
    /// Joint motions of the coordinate directions,
    pub joint: Matrix,
    /// and the corresponding object motions, column by column.
    pub object: Matrix,
}

/// Transforms between scaled and given coordinates of the object.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct ObjectScale {
    /// u = twist * u'.
    twist: Matrix,
    /// w = wrench * w', its inverse transpose.
    wrench: Matrix,
}

impl ObjectScale {
    pub(crate) fn diagonal(scale: &[f64]) -> Self {
        let (twist, mut wrench) = (Matrix::diagonal(scale), Matrix::diagonal(scale));
        (0..scale.len()).for_each(|i| wrench[(i, i)] = 1.0 / scale[i]);
        Self { twist, wrench }
    }
}

/// The linear relation between actuated joints and object: what the velocity constraint leaves of
/// them when the passive joints are forgotten.
///
/// ```text
/// R = {(qd_a, u) : J_a qd_a + J_p qd_p = G^T u for some qd_p},   basis [Q; U], dimension p
/// c' = rk Q + rk U - p,   r' = p - rk U,   i' = p - rk Q
/// F = {(tau, w) : tau . qd_a + w . u = 0 on R} = R^perp,   h = q_a - rk Q,   s = d - rk U
/// ```
///
/// `qd_a` has q_a entries, `u` d; the wrench `w` is taken at the object's reference point. F is
/// exact for hyperstatic systems too.
///
/// Source: Bicchi & Prattichizzo 1998, sections 2 to 4, without their choice of bases; the chapter
/// `docs/theory/closed-chains.md` of the book.
#[derive(Debug, Clone)]
pub struct Relation {
    joint_scale: Vec<f64>,
    scale: ObjectScale,
    cs: CsDecomposition,
    /// The directions in order: i' infinite, c' finite, r' zero.
    infinite: usize,
    zero: usize,
    tolerance: f64,
    rank: Cut,
    joint_rank: Cut,
    object_rank: Cut,
}

impl Relation {
    /// From the span of the columns of `span` (scaled), actuated joints first.
    pub(crate) fn from_scaled(
        span: Matrix,
        joint_scale: Vec<f64>,
        scale: ObjectScale,
        tolerance: f64,
    ) -> Self {
        let space = ColumnSpace::cut_of(span, Threshold::Absolute(tolerance));
        let cs = CsDecomposition::of(&space.basis(), joint_scale.len());
        let count = |kind| (0..cs.len()).filter(|&j| cs.kind(j, tolerance) == kind).count();
        Self {
            infinite: count(PairKind::Infinite),
            zero: count(PairKind::Zero),
            rank: space.cut(),
            joint_rank: cs.first_rank(tolerance),
            object_rank: cs.second_rank(tolerance),
            joint_scale,
            scale,
            cs,
            tolerance,
        }
    }

    /// Number of actuated joints.
    #[must_use]
    pub fn joints(&self) -> usize {
        self.joint_scale.len()
    }

    /// Size of the object's twist, or of the task.
    #[must_use]
    pub fn object(&self) -> usize {
        self.scale.twist.rows()
    }

    /// The counts.
    #[must_use]
    pub fn dimensions(&self) -> RelationDimensions {
        let p = self.cs.len();
        RelationDimensions {
            relation: p,
            coordinate: p - self.infinite - self.zero,
            redundancy: self.zero,
            indeterminacy: self.infinite,
            internal: self.joints() - (p - self.infinite),
            zero_torque: self.object() - (p - self.zero),
        }
    }

    /// The finite directions as pairs (s, c) in scaled units, in descending order of s: sine and
    /// cosine of the angle between the direction and the joint space. The smallest s is the
    /// distance to a configuration where the object loses a motion, the smallest c to one where it
    /// gains one.
    #[must_use]
    pub fn finite_pairs(&self) -> Vec<(f64, f64)> {
        self.finite().map(|j| (self.cs.sines[j], self.cs.cosines[j])).collect()
    }

    /// The ranks of all columns, of the joint rows and of the object rows.
    #[must_use]
    pub fn cuts(&self) -> [Cut; 3] {
        [self.rank, self.joint_rank, self.object_rank]
    }

    /// The motions by kind, in the units of the constraint.
    #[must_use]
    pub fn motions(&self) -> RelationBases {
        self.parts(&Kinds {
            zero: self.zero_columns(&self.cs.x),
            infinite: self.cs.y.columns_between(0, self.infinite),
            joint: self.finite_columns(&self.cs.x, |j| self.cs.cosines[j]),
            object: self.finite_columns(&self.cs.y, |j| self.cs.sines[j]),
            dual: false,
        })
    }

    /// The forces by kind: internal torques, zero-torque wrenches, and torques with the wrenches
    /// that they balance.
    #[must_use]
    pub fn forces(&self) -> RelationBases {
        self.parts(&Kinds {
            zero: self.internal_scaled(),
            infinite: self.zero_torque_scaled(),
            joint: self.finite_columns(&self.cs.x, |j| -self.cs.sines[j]),
            object: self.finite_columns(&self.cs.y, |j| self.cs.cosines[j]),
            dual: true,
        })
    }

    /// Internal torques and zero-torque wrenches only, see [`Relation::forces`].
    pub(crate) fn internal_and_structural(&self) -> (Matrix, Matrix) {
        let (mut torques, wrenches) = (self.internal_scaled(), self.zero_torque_scaled());
        for j in 0..torques.cols() {
            torques.column_mut(j).iter_mut().zip(&self.joint_scale).for_each(|(t, s)| *t /= s);
        }
        (torques, &self.scale.wrench * &wrenches)
    }

    /// The relation between actuated joints and the task `T u`.
    ///
    /// # Errors
    /// A map whose number of columns is not the size of u, with linearly dependent rows, NaN or
    /// infinity, or with a row whose largest entry is out of range.
    pub fn task(&self, map: &Matrix) -> Result<Self> {
        Error::check_len("columns of the task map", self.object(), map.cols())?;
        check_finite("task map", map)?;
        // In scaled coordinates T' = R^T Q^T; Q^T u' are the scaled coordinates of the task, so
        // that the result is independent of its units and of the lengths of its rows.
        let m = map.rows();
        for i in 0..m {
            let size = (0..map.cols()).map(|j| map[(i, j)].abs()).fold(0.0, f64::max);
            if size > 0.0 && !TASK_ROWS.contains(&size) {
                return Err(Error::InvalidOption {
                    option: "task",
                    value: format!("row {} of the map", i + 1),
                    reason: format!(
                        "its largest entry is {size:e}; from {:e} to {:e} are accepted",
                        TASK_ROWS.start(),
                        TASK_ROWS.end()
                    ),
                });
            }
        }
        let scaled = (map * &self.scale.twist).transpose();
        // Powers of two change no digit, and squares neither overflow nor vanish.
        let sizes: Vec<f64> = (0..m).map(|j| power_of_two(max_abs(scaled.column(j)))).collect();
        let rows = Matrix::from_fn(scaled.rows(), m, |i, j| scaled[(i, j)] / sizes[j]);
        let rank = ColumnSpace::of(&rows, Threshold::Relative(CLOSURE_BLOCK)).rank();
        if rank < m {
            return Err(Error::InvalidOption {
                option: "task",
                value: format!("{m} x {} map of rank {rank}", map.cols()),
                reason: "its rows must be linearly independent; remove the dependent ones"
                    .to_owned(),
            });
        }
        let qr = Qr::plain(rows);
        let mut r = qr.r();
        for (j, size) in sizes.iter().enumerate() {
            r.column_mut(j).iter_mut().for_each(|x| *x *= size);
        }
        let reduce = qr.basis();
        let mut wrench = Matrix::identity(m);
        for j in 0..m {
            let column = solve_upper(&r, wrench.column(j));
            wrench.column_mut(j).copy_from_slice(&column);
        }
        let columns = self.cs.len();
        let weighted = |a: &Matrix, size: &[f64]| {
            Matrix::from_fn(a.rows(), columns, |i, j| a[(i, j)] * size[j])
        };
        let joint = weighted(&self.cs.x, &self.cs.cosines);
        let object = &reduce.transpose() * &weighted(&self.cs.y, &self.cs.sines);
        Ok(Self::from_scaled(
            Matrix::vstack(columns, &[&joint, &object]),
            self.joint_scale.clone(),
            ObjectScale { wrench, twist: r.transpose() },
            self.tolerance,
        ))
    }

    /// The relation between actuated joints and some components of the object's twist while the
    /// other components are zero, as if a guide blocked them: the section of the motions. Its
    /// forces are the projection of the wrenches, since the guide takes the other components.
    ///
    /// ```text
    /// {(qd_a, v) : (qd_a, u) in R,  u_i = v_i for the components,  u_j = 0 for the others}
    /// ```
    ///
    /// [`Relation::task`] leaves the other components free instead.
    ///
    /// # Errors
    /// A component that does not exist, or is given twice; none.
    pub fn section(&self, components: &[usize]) -> Result<Self> {
        check_components(components, self.object())?;
        let columns = self.cs.len();
        let twist = &self.scale.twist;
        let size: Vec<f64> = (0..self.object()).map(|i| twist.row_norm(i)).collect();
        let object = Matrix::from_fn(self.object(), columns, |i, j| {
            let along = |l| twist[(i, l)] * self.cs.y[(l, j)];
            (0..twist.cols()).map(along).sum::<f64>() * self.cs.sines[j] / size[i]
        });
        let rows = |chosen: &[usize]| {
            Matrix::from_fn(chosen.len(), columns, |i, j| object[(chosen[i], j)])
        };
        let others: Vec<usize> = (0..self.object()).filter(|i| !components.contains(i)).collect();
        let blocked = rows(&others).transpose();
        let permitted = ColumnSpace::of(&blocked, Threshold::Absolute(self.tolerance)).complement();
        let joint =
            Matrix::from_fn(self.joints(), columns, |i, j| self.cs.x[(i, j)] * self.cs.cosines[j]);
        let span = Matrix::vstack(
            permitted.cols(),
            &[&(&joint * &permitted), &(&rows(components) * &permitted)],
        );
        let scale: Vec<f64> = components.iter().map(|&i| size[i]).collect();
        Ok(Self::from_scaled(
            span,
            self.joint_scale.clone(),
            ObjectScale::diagonal(&scale),
            self.tolerance,
        ))
    }

    fn finite(&self) -> std::ops::Range<usize> {
        self.infinite..self.cs.len() - self.zero
    }

    fn zero_columns(&self, x: &Matrix) -> Matrix {
        x.columns_between(self.cs.len() - self.zero, self.cs.len())
    }

    fn finite_columns(&self, a: &Matrix, size: impl Fn(usize) -> f64) -> Matrix {
        let from = self.infinite;
        Matrix::from_fn(a.rows(), self.finite().len(), |i, j| a[(i, from + j)] * size(from + j))
    }

    /// The complement of all attainable joint velocities.
    fn internal_scaled(&self) -> Matrix {
        complement(self.cs.x.columns_between(self.infinite, self.cs.len()))
    }

    /// The complement of all attainable twists.
    fn zero_torque_scaled(&self) -> Matrix {
        complement(self.cs.y.columns_between(0, self.cs.len() - self.zero))
    }

    /// Joint torques of least scaled norm that balance the wrench, and the parts of the wrench that
    /// are balanced by the structure and not at all (all in the units of the constraint).
    pub(crate) fn balance(&self, wrench: &[f64]) -> DualRelation {
        // w' = A^T w, since w^T u = w'^T u'.
        let scaled = self.scale.twist.transpose().mul_vec(wrench);
        let along = |j: usize| dot(self.cs.y.column(j), &scaled);
        let mut torque = vec![0.0; self.joints()];
        for j in self.finite() {
            let share = -along(j) * self.cs.sines[j] / self.cs.cosines[j];
            torque.iter_mut().zip(self.cs.x.column(j)).for_each(|(t, x)| *t += share * x);
        }
        torque.iter_mut().zip(&self.joint_scale).for_each(|(t, s)| *t /= s);
        let mut unbalanced = vec![0.0; self.object()];
        let mut structural = scaled.clone();
        for j in 0..self.cs.len() - self.zero {
            let (share, y) = (along(j), self.cs.y.column(j));
            structural.iter_mut().zip(y).for_each(|(s, y)| *s -= share * y);
            if j < self.infinite {
                unbalanced.iter_mut().zip(y).for_each(|(l, y)| *l += share * y);
            }
        }
        if self.dimensions().zero_torque == 0 {
            structural.fill(0.0); // only rounding is left
        }
        DualRelation {
            torques: torque,
            structural: self.scale.wrench.mul_vec(&structural),
            unbalanced: self.scale.wrench.mul_vec(&unbalanced),
        }
    }

    fn parts(&self, kinds: &Kinds) -> RelationBases {
        let joint = |a: &Matrix| {
            Matrix::from_fn(a.rows(), a.cols(), |i, j| {
                let s = self.joint_scale[i];
                if kinds.dual { a[(i, j)] / s } else { a[(i, j)] * s }
            })
        };
        let object = if kinds.dual { &self.scale.wrench } else { &self.scale.twist };
        RelationBases {
            zero: joint(&kinds.zero),
            infinite: object * &kinds.infinite,
            joint: joint(&kinds.joint),
            object: object * &kinds.object,
        }
    }
}

/// Refuses components that do not exist or are given twice.
pub(crate) fn check_components(components: &[usize], of: usize) -> Result<()> {
    let twice = |i: usize| components[..i].contains(&components[i]);
    let reason = match components.iter().position(|c| *c >= of) {
        Some(i) => format!("component {} does not exist; there are {of}", components[i]),
        None if components.is_empty() => "choose one component at least".to_owned(),
        None if (0..components.len()).any(twice) => "a component is given twice".to_owned(),
        None => return Ok(()),
    };
    Err(Error::InvalidOption { option: "components", value: format!("{components:?}"), reason })
}

/// The equilibrium of a wrench.
pub(crate) struct DualRelation {
    pub(crate) torques: Vec<f64>,
    pub(crate) structural: Vec<f64>,
    pub(crate) unbalanced: Vec<f64>,
}

/// The orthogonal complement of independent columns.
fn complement(columns: Matrix) -> Matrix {
    if columns.cols() == columns.rows() {
        return Matrix::zeros(columns.rows(), 0);
    }
    Qr::plain(columns).complement()
}

/// Bases by kind in scaled coordinates.
struct Kinds {
    zero: Matrix,
    infinite: Matrix,
    joint: Matrix,
    object: Matrix,
    dual: bool,
}

impl RelationBases {
    /// All columns of the relation, joints above the object: infinite, finite, zero.
    #[must_use]
    pub fn basis(&self) -> Matrix {
        let (joints, object) = (self.joint.rows(), self.object.rows());
        let (zero, infinite) = (self.zero.cols(), self.infinite.cols());
        let above =
            Matrix::hstack(joints, &[&Matrix::zeros(joints, infinite), &self.joint, &self.zero]);
        let below =
            Matrix::hstack(object, &[&self.infinite, &self.object, &Matrix::zeros(object, zero)]);
        Matrix::vstack(above.cols(), &[&above, &below])
    }
}
