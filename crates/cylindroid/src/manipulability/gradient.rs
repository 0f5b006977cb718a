//! Gradients of manipulability indices with respect to the configuration, along closed-loop
//! motions.
//!
//! Formula  the page of [`gradient`]; for a task T, T^T W_u T replaces W_u
//! Shapes   gradient: n entries, one for each coordinate
//! Units    of the index for each unit of q (of the unit rates of spherical and free joints)
//! Valid    where the counts of the relation are locally constant, and the metrics too. A closed
//!          chain has derivatives along its own motions alone; the gradient is then the one among
//!          them (orthogonal in units scaled by the characteristic length). A repeated smallest or
//!          largest efficiency has no gradient, which is reported; the volume has one
//! Error    of trees: rounding, dM is the Hessian. Of closed chains dM comes from four matrices at
//!          steps of `tolerance::MATRIX_STEP`, with an error of fourth order; the difference to
//!          the result of two of them, of second order, is returned as an upper estimate
//! Why so   the motion and the dual forces t are available; differences of the index itself would
//!          need loops closed again at every step and lose half the digits
//! Source   the derivative of a stationary value (Lagrange multipliers t); Yoshikawa 1985 for v
//! Checked  tests/it/manipulability/gradient.rs

use super::efficiency::{Direction, Manipulability};
use super::metrics::Metrics;
use crate::closure::{ClosedChain, Constraint, ContactForceSolver, MotionSpace, StaticLoad, Unit};
use crate::error::Result;
use crate::inverse::truncated;
use crate::kinematics::{ReferenceFrame, State};
use crate::linalg::{ColumnSpace, Matrix, Metric, Svd, Threshold};
use crate::model::FrameId;
use crate::tolerance::{CLOSURE_BLOCK, MATRIX_STEP, REPEATED};

/// A single number of a spectrum of motion.
#[doc(alias = "Yoshikawa")]
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum Measure {
    /// Product of the roots of all finite efficiencies: Yoshikawa's measure of a serial arm.
    Volume,
    /// Smallest finite efficiency.
    Smallest,
    /// Largest finite efficiency.
    Largest,
    /// Largest over smallest: the squared condition number of a serial arm.
    Anisotropy,
}

impl Measure {
    /// All of them.
    pub const ALL: [Self; 4] = [Self::Volume, Self::Smallest, Self::Largest, Self::Anisotropy];

    /// Its name in options and reports.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Volume => "volume",
            Self::Smallest => "smallest",
            Self::Largest => "largest",
            Self::Anisotropy => "anisotropy",
        }
    }
}

/// The derivative of a measure with respect to the configuration.
#[derive(Debug, Clone, PartialEq)]
pub enum Gradient {
    /// It exists.
    Exists {
        /// The measure.
        value: f64,
        /// Its gradient, an entry for each coordinate.
        gradient: Vec<f64>,
        /// Estimate from above of the error of a slope along a motion of scaled length one: zero
        /// for trees, where only rounding is left.
        error: f64,
    },
    /// Several efficiencies are equal: the measure has a kink.
    Repeated {
        /// The measure.
        value: f64,
        /// How many efficiencies meet.
        multiplicity: usize,
    },
    /// There is no finite efficiency.
    Nothing,
}

/// The motion to be measured.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Goal<'a> {
    /// The frame; the mechanism's reference by default.
    pub reference: Option<FrameId>,
    /// The task map, as of [`Relation::task`](crate::closure::Relation::task); the whole twist by
    /// default.
    pub task: Option<&'a Matrix>,
}

/// The gradient of a measure of the kinematic efficiencies, in constant metrics.
///
/// ```text
/// M x = 0,  x = (qd_a, qd_p, u),   M^T t = (-e W_q qd_a, 0, W_u u)
/// de = -2 t^T dM x / |qd_a|^2      serial arm: de = 2 u^T W_u dJ qd_a / |qd_a|^2
/// volume v = prod sqrt(e_i):       dv = v sum_i de_i / (2 e_i)
/// anisotropy a = e_1 / e_n:        da = a (de_1 / e_1 - de_n / e_n)
/// ```
///
/// An efficiency e is the stationary value of `|u|^2 / |qd_a|^2` among the motions x of the
/// constraint M, with Lagrange multipliers t; the derivative of a stationary value needs no
/// derivative of x. The gradient has n entries, in the unit of the measure for each unit of q. On a
/// closed chain it is the gradient along the motions that the loops allow. Measures with a repeated
/// smallest or largest efficiency have none ([`Gradient::Repeated`]).
///
/// Source: derivative of a stationary value; Yoshikawa 1985 for the volume.
///
/// ```
/// use cylindroid::manipulability::{Goal, Gradient, Measure, Metrics, gradient};
///
/// let arm = cylindroid::load("panda")?;
/// let state = arm.state(arm.home())?;
/// let uphill = gradient(&state, Goal::default(), &Metrics::UNIT, Measure::Volume)?;
/// assert!(matches!(uphill, Gradient::Exists { gradient, .. } if gradient.len() == 7));
/// # Ok::<(), cylindroid::Error>(())
/// ```
///
/// # Errors
/// As [`ClosedChain::of`], [`Relation::task`](crate::closure::Relation::task) and
/// [`Manipulability::of`].
pub fn gradient(
    state: &State,
    goal: Goal<'_>,
    metrics: &Metrics,
    measure: Measure,
) -> Result<Gradient> {
    let chain = ClosedChain::of(state, goal.reference, None)?;
    let motions = MotionSpace::of(&chain.constraint);
    let relation = match goal.task {
        Some(map) => motions.relation().task(map)?,
        None => motions.relation(),
    };
    let all = Manipulability::of(&relation, metrics)?.kinematic;
    let values = all.values();
    let (Some(first), Some(last)) = (values.first(), values.last()) else {
        return Ok(Gradient::Nothing);
    };
    let n = values.len();
    let value = match measure {
        Measure::Volume => all.volume(),
        Measure::Smallest => *last,
        Measure::Largest => *first,
        Measure::Anisotropy => first / last,
    };
    // Weights of the logarithmic derivatives of the efficiencies.
    let weights: Vec<f64> = (0..n)
        .map(|i| {
            let (top, bottom) = (f64::from(u8::from(i == 0)), f64::from(u8::from(i + 1 == n)));
            value
                * match measure {
                    Measure::Volume => 0.5,
                    Measure::Smallest => bottom,
                    Measure::Largest => top,
                    Measure::Anisotropy => top - bottom,
                }
        })
        .collect();
    let meet = |of: f64| values.iter().filter(|e| (*e / of - 1.0).abs() < REPEATED).count();
    let multiplicity = match measure {
        Measure::Volume => 1,
        Measure::Smallest => meet(*last),
        Measure::Largest => meet(*first),
        // One efficiency alone is as large as it is small, always.
        Measure::Anisotropy if n == 1 => 1,
        Measure::Anisotropy => meet(*first).max(meet(*last)),
    };
    if multiplicity > 1 {
        return Ok(Gradient::Repeated { value, multiplicity });
    }
    let behind = Behind::of(&chain.constraint, &motions, goal.task)?;
    let pairs: Vec<Stationary> = all
        .finite
        .iter()
        .zip(&weights)
        .filter(|(_, w)| **w != 0.0)
        .map(|(d, w)| Stationary::of(d, *w, &behind, metrics))
        .collect::<Result<_>>()?;
    let sum = |dm: &Matrix| -> f64 { pairs.iter().map(|p| p.slope(dm)).sum() };
    if !state.mechanism().is_closed() {
        let gradient = constraint_hessian(state, &chain).iter().map(sum).collect();
        return Ok(Gradient::Exists { value, gradient, error: 0.0 });
    }
    let tangent = tangent(state, &chain, &motions);
    let mut slopes = vec![0.0; tangent.cols()];
    let mut error: f64 = 0.0;
    for (j, slope) in slopes.iter_mut().enumerate() {
        let (coarse, fine) = along(state, &chain, tangent.column(j))?;
        *slope = sum(&fine);
        error = error.max((*slope - sum(&coarse)).abs());
    }
    // The slope along a column t_j of scaled length one is g . t_j with g = D^-2 T slopes.
    let length = chain.constraint.length();
    let scale = coordinate_scale(state, length);
    let gradient = tangent.mul_vec(&slopes).iter().zip(&scale).map(|(g, s)| g / (s * s)).collect();
    Ok(Gradient::Exists { value, gradient, error })
}

/// The origin of the directions: motions of all joints, and the forces at the contacts.
struct Behind<'a> {
    task: Option<&'a Matrix>,
    supports: ContactForceSolver<'a>,
    /// All motions, and their least combination that has given parts of actuated joints and object.
    basis: Matrix,
    least: Matrix,
}

impl<'a> Behind<'a> {
    fn of(
        constraint: &'a Constraint,
        motions: &MotionSpace,
        task: Option<&'a Matrix>,
    ) -> Result<Self> {
        let basis = motions.basis();
        let (a, n) = (motions.actuated(), basis.rows());
        let twists = basis.rows_between(a + motions.passive(), n);
        let seen = task.map_or_else(|| twists.clone(), |map| map * &twists);
        let both = Matrix::vstack(basis.cols(), &[&basis.rows_between(0, a), &seen]);
        let least = truncated(&both, CLOSURE_BLOCK)?.matrix;
        Ok(Self {
            task,
            supports: ContactForceSolver::of(constraint, motions, None)?,
            basis,
            least,
        })
    }
}

/// A direction with what its derivative needs.
struct Stationary {
    /// x = (q_a, q_p, u).
    motion: Vec<f64>,
    /// t.
    forces: Vec<f64>,
    /// -2 weight / (e |q_a|^2).
    factor: f64,
}

impl Stationary {
    fn of(
        direction: &Direction,
        weight: f64,
        behind: &Behind<'_>,
        metrics: &Metrics,
    ) -> Result<Self> {
        let efficiency = direction.pair.efficiency();
        let (q, u) = (&direction.joint, &direction.object);
        let input = direction.pair.input;
        let mut torques = metric_times(metrics.joint.as_ref(), q);
        torques.iter_mut().for_each(|x| *x *= efficiency);
        let mut wrench = metric_times(metrics.object.as_ref(), u);
        if let Some(map) = behind.task {
            wrench = map.transpose().mul_vec(&wrench);
        }
        wrench.iter_mut().for_each(|x| *x = -*x);
        let load = StaticLoad { torques: &torques, wrench: &wrench };
        let shares = behind.least.mul_vec(&[q.as_slice(), u].concat());
        Ok(Self {
            motion: behind.basis.mul_vec(&shares),
            forces: behind.supports.forces(load)?.forces,
            factor: -2.0 * weight / (efficiency * input * input),
        })
    }

    fn slope(&self, dm: &Matrix) -> f64 {
        self.factor * bilinear(&self.forces, |i, j| dm[(i, j)], &self.motion)
    }
}

/// `left^T A right`.
fn bilinear(left: &[f64], entry: impl Fn(usize, usize) -> f64, right: &[f64]) -> f64 {
    let mut sum = 0.0;
    for (j, r) in right.iter().enumerate() {
        let along: f64 = left.iter().enumerate().map(|(i, l)| l * entry(i, j)).sum();
        sum += r * along;
    }
    sum
}

/// The derivative of `ln(s_1 ... s_rank)` where a matrix with this decomposition changes by
/// `entry`: of Yoshikawa's measure in a control loop. Allocates nothing.
pub(crate) fn log_volume_slope(svd: &Svd, rank: usize, entry: impl Fn(usize, usize) -> f64) -> f64 {
    (0..rank).map(|i| bilinear(svd.u(i), &entry, svd.v(i)) / svd.value(i)).sum()
}

/// `W x`.
fn metric_times(metric: Option<&Metric>, x: &[f64]) -> Vec<f64> {
    let mut y = x.to_vec();
    if let Some(metric) = metric {
        metric.apply(&mut y);
    }
    y
}

/// How coordinates of the tree are scaled.
fn coordinate_scale(state: &State, length: f64) -> Vec<f64> {
    state.mechanism().coordinates().iter().map(|c| Unit::of(c.kind).size(length)).collect()
}

/// The motions of the tree's coordinates that keep the loops closed, orthonormal when scaled.
fn tangent(state: &State, chain: &ClosedChain, motions: &MotionSpace) -> Matrix {
    let scale = coordinate_scale(state, chain.constraint.length());
    let basis = motions.basis();
    let rates =
        Matrix::from_fn(scale.len(), basis.cols(), |i, j| basis[(chain.column(i), j)] / scale[i]);
    let unit = ColumnSpace::of(&rates, Threshold::Absolute(motions.tolerance())).basis();
    Matrix::from_fn(scale.len(), unit.cols(), |i, j| unit[(i, j)] * scale[i])
}

/// dM along rates of the tree's coordinates: from two matrices, and from four.
fn along(state: &State, chain: &ClosedChain, rates: &[f64]) -> Result<(Matrix, Matrix)> {
    let mechanism = state.mechanism();
    let matrix = |step: f64| -> Result<Matrix> {
        let q = mechanism.integrate(state.q(), rates, step)?;
        let length = Some(chain.constraint.length());
        Ok(ClosedChain::of(&mechanism.state(&q)?, Some(chain.reference), length)?
            .constraint
            .matrix())
    };
    let central = |step: f64| -> Result<Matrix> {
        let (more, less) = (matrix(step)?, matrix(-step)?);
        Ok(Matrix::from_fn(more.rows(), more.cols(), |i, j| {
            (more[(i, j)] - less[(i, j)]) / (2.0 * step)
        }))
    };
    let (wide, narrow) = (central(2.0 * MATRIX_STEP)?, central(MATRIX_STEP)?);
    let fine = Matrix::from_fn(wide.rows(), wide.cols(), |i, j| {
        (4.0 * narrow[(i, j)] - wide[(i, j)]) / 3.0
    });
    Ok((narrow, fine))
}

/// dM of a tree for each coordinate: the Hessian in the columns of actuated and passive joints.
fn constraint_hessian(state: &State, chain: &ClosedChain) -> Vec<Matrix> {
    let rows = state.mechanism().dimension().components();
    let of = |hessian: &Matrix| {
        let mut dm = Matrix::zeros(rows.len(), hessian.cols() + rows.len());
        for c in 0..hessian.cols() {
            let column = dm.column_mut(chain.column(c));
            column.iter_mut().zip(rows).for_each(|(x, &row)| *x = hessian[(row, c)]);
        }
        dm
    };
    let tip = state.tip(chain.reference);
    let hessian = tip.hessian(ReferenceFrame::LocalWorldAligned, state.mechanism().n());
    hessian.iter().map(of).collect()
}
