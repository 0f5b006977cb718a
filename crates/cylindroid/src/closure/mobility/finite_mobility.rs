//! Finite mobility: which of the motions to first order a mechanism can really make.
//!
//! Formula  the closed configurations near q are the zeros of g(x), x in the motions to first order (see
//!          `lyapunov_schmidt.rs`). No g: the equations are independent, and every motion exists (implicit
//!          function theorem). g zero at every step: every motion exists, the other equations are
//!          superfluous there too. Otherwise the zeros of g are looked for (`branches.rs`)
//! Shapes   motions: n x dimension, rates of the coordinates of q
//! Units    rad, m; steps and residuals scaled by the characteristic length
//! Valid    closed configurations; position limits are residual out. Geometry given to less than ten digits
//!          makes a superfluous equation an independent one: the rank gap of `Mobility` says so
//! Why so   a structure may be loose to first order and rigid (shaky), a mechanism may have a
//!          negative Grubler count and move: neither first order nor counting can tell
//! Source   Kuznetsov 1991 (infinitesimal and finite mobility); Mueller 2002 (kinematic tangent
//!          cone)
//! Checked  tests/it/closure/finite.rs

use std::fmt;

use super::branches::{branches, direction};
use super::lyapunov_schmidt::LyapunovSchmidt;
use crate::error::{Error, Result};
use crate::kinematics::State;
use crate::linalg::{ColumnSpace, Matrix, Threshold};
use crate::tolerance::{CLOSURE_RANK, FINITE_STEP, WITHIN_BRANCHES};

/// How often a step that Newton's method does not follow is halved.
const HALVINGS: usize = 8;
/// How much nearer than the step the configurations beside a configuration are: spaces there, the mean of both
/// sides, are those here but for 1e-10 times their curvature.
const BESIDE: f64 = 1e-3;

/// What a count of finite motions rests on.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum MobilityEvidence {
    /// The loops are independent equations, or nothing moves even to first order: proved.
    Independent,
    /// Some equations are superfluous here, and after steps in all directions as well.
    Steps,
    /// Not every step can be followed; the closed configurations around were looked for.
    Search,
    /// The loops are open in this configuration, or no step could be followed: nothing is known.
    Unknown,
}

impl fmt::Display for MobilityEvidence {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Independent => "the loops are independent",
            Self::Steps => "loops close after steps in every direction",
            Self::Search => "from a search around the pose",
            Self::Unknown => "not known",
        })
    }
}

/// A set of closed configurations through the configuration in question.
#[derive(Debug, Clone, PartialEq)]
pub struct Branch {
    /// Its finite degrees of freedom.
    pub dimension: usize,
    /// Motions along it: rates of the coordinates of q, orthonormal when scaled; more than its
    /// dimension where the branch is a cone with its tip here.
    pub motions: Matrix,
}

/// How a mechanism can move from a configuration beyond first order.
#[derive(Debug, Clone, PartialEq)]
pub struct FiniteMobility {
    /// Motions to first order.
    pub infinitesimal: usize,
    /// Degrees of freedom of finite motion: those of the largest branch.
    pub finite: Option<usize>,
    /// The branches found, largest first; one where the configuration is ordinary, none where it is
    /// rigid. Two and more: the mechanism can go different ways from here.
    pub branches: Vec<Branch>,
    /// Motions to first order across all branches, a column each: the mechanism gives there and
    /// does not move (shaky).
    pub shaky: Matrix,
    /// What it rests on.
    pub evidence: MobilityEvidence,
    /// False where another method should confirm it: branches may have been missed.
    pub certain: bool,
    /// Size of the steps [rad, or characteristic lengths]; 0 where none was needed.
    pub step: f64,
    /// By how much the worst step is residual open (scaled) [-]: rounding where all can be followed.
    pub left_open: f64,
    beside: Vec<Vec<f64>>,
}

impl FiniteMobility {
    /// Of a configuration, at the mechanism's reach as characteristic length or another (m).
    ///
    /// ```
    /// use cylindroid::closure::FiniteMobility;
    ///
    /// let delta = cylindroid::load("delta")?;
    /// let mobility = FiniteMobility::of(&delta.state(delta.home())?, None)?;
    /// assert_eq!(mobility.finite, Some(3));
    /// # Ok::<(), cylindroid::Error>(())
    /// ```
    ///
    /// # Errors
    /// A length that is not positive and finite.
    pub fn of(state: &State, length: Option<f64>) -> Result<Self> {
        let mechanism = state.mechanism();
        let length = length.unwrap_or_else(|| mechanism.reach());
        Error::check_positive("length", length)?;
        let reduction = LyapunovSchmidt::of(mechanism, state.q(), length, CLOSURE_RANK)?;
        let k = reduction.motions();
        let mut report = Self {
            infinitesimal: k,
            finite: None,
            branches: Vec::new(),
            shaky: Matrix::zeros(mechanism.n(), 0),
            evidence: MobilityEvidence::Unknown,
            certain: false,
            step: 0.0,
            left_open: 0.0,
            beside: Vec::new(),
        };
        if !reduction.is_closed() {
            return Ok(report);
        }
        if k == 0 || reduction.superfluous() == 0 {
            report.whole(&reduction, MobilityEvidence::Independent)?;
            return Ok(report);
        }
        let Some((step, left_open)) = open_after_steps(&reduction)? else { return Ok(report) };
        (report.step, report.left_open) = (step, left_open);
        if left_open <= reduction.tolerance() {
            report.whole(&reduction, MobilityEvidence::Steps)?;
            return Ok(report);
        }
        let found = branches(mechanism, length, &reduction, step)?;
        report.evidence = MobilityEvidence::Search;
        report.certain = found.complete;
        report.finite = Some(found.tangents.first().map_or(0, |t| t.dimension));
        let mut tangents = Matrix::zeros(k, 0);
        for tangent in found.tangents {
            tangents = Matrix::hstack(k, &[&tangents, &tangent.directions]);
            report.branches.push(Branch {
                dimension: tangent.dimension,
                motions: reduction.unscaled(&(reduction.kernel() * &tangent.directions)),
            });
            if report.beside.is_empty() {
                report.beside = tangent.configurations;
            }
        }
        let outside = ColumnSpace::of(&tangents, Threshold::Absolute(WITHIN_BRANCHES)).complement();
        report.shaky = reduction.unscaled(&(reduction.kernel() * &outside));
        Ok(report)
    }

    /// True where first order tells all: every motion exists.
    #[must_use]
    pub fn is_ordinary(&self) -> bool {
        self.finite == Some(self.infinitesimal)
    }

    /// Closed configurations a little to both sides along a motion in which all degrees of freedom of the
    /// largest branch take part; fewer where they could not be found.
    pub(crate) fn beside(&self) -> &[Vec<f64>] {
        &self.beside
    }

    fn whole(&mut self, reduction: &LyapunovSchmidt<'_>, evidence: MobilityEvidence) -> Result<()> {
        let k = reduction.motions();
        (self.finite, self.evidence, self.certain) = (Some(k), evidence, true);
        if k == 0 {
            return Ok(());
        }
        let motions = reduction.unscaled(reduction.kernel());
        self.branches.push(Branch { dimension: k, motions });
        let x = direction(k, &mut 4);
        for side in [FINITE_STEP * BESIDE, -FINITE_STEP * BESIDE] {
            let x: Vec<f64> = x.iter().map(|x| side * x).collect();
            self.beside.extend(reduction.step(&x)?.map(|near| near.q));
        }
        Ok(())
    }
}

/// The step that Newton's method follows in every direction tried, and the worst error residual.
fn open_after_steps(reduction: &LyapunovSchmidt<'_>) -> Result<Option<(f64, f64)>> {
    let k = reduction.motions();
    let mut step = FINITE_STEP;
    'shorter: for _ in 0..=HALVINGS {
        let mut random = 5;
        let mut worst: f64 = 0.0;
        for _ in 0..(2 * k + 6).min(24) {
            let x: Vec<f64> = direction(k, &mut random).iter().map(|x| step * x).collect();
            let Some(near) = reduction.step(&x)? else {
                step *= 0.5;
                continue 'shorter;
            };
            worst = worst.max(near.error());
        }
        return Ok(Some((step, worst)));
    }
    Ok(None)
}
