//! Finite mobility: the first-order motions that extend to finite motions of the mechanism.
//!
//! Formula  the closed configurations near q are the zeros of the reduced equation g(x), x in the
//!          first-order motions (see `lyapunov_schmidt.rs`). No g: the equations are independent,
//!          and every motion is finite (implicit function theorem). g zero along rays in generic
//!          directions, tracked a finite way (`rays.rs`): every motion is finite, the dependent
//!          equations stay dependent. g not zero for a single motion: rigid, since the zeros of an
//!          analytic function are isolated. Otherwise the zeros of g are searched (`branches.rs`)
//! Shapes   motions: n x dimension, rates of the coordinates of q
//! Units    rad, m; distances and residuals scaled by the characteristic length
//! Valid    closed configurations; position limits are ignored. Geometry given to fewer than ten
//!          digits makes dependent equations independent: the rank gap of `Mobility` shows this
//! Why so   a structure may move to first order and be rigid (shaky), a mechanism may have a
//!          negative Gruebler-Kutzbach count and move: neither first order nor counting can decide
//! Source   Kuznetsov 1991 (infinitesimal and finite mobility); Mueller 2002 (kinematic tangent
//!          cone)
//! Checked  tests/it/closure/finite.rs

use std::fmt;

use super::branches::branches;
use super::lyapunov_schmidt::LyapunovSchmidt;
use super::rays::Rays;
use super::second_order::SecondOrder;
use crate::error::Result;
use crate::kinematics::State;
use crate::linalg::{ColumnSpace, Matrix, Threshold};
use crate::tolerance::{
    CLEARLY_OPEN, CLOSURE_RANK, FINITE_STEP, TRACKED_AT_LEAST, WITHIN_BRANCHES,
};

/// Distance of the neighbours of a configuration, relative to the step: the mean of the spaces on
/// both sides differs from the space at the configuration by 1e-10 times its curvature.
const NEIGHBOUR_DISTANCE: f64 = 1e-3;

/// The evidence for a count of finite motions.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum MobilityEvidence {
    /// The loops are independent equations, or there is no first-order motion: proved.
    Independent,
    /// Some equations are dependent here, and stay so: the motions were tracked a finite way with
    /// the loops closed to rounding.
    Tracked,
    /// A single first-order motion along which the loops open: proved not to be finite.
    Opens,
    /// The closed configurations nearby were searched.
    Search,
    /// The loops are open, or no step converged.
    Unknown,
}

impl fmt::Display for MobilityEvidence {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Independent => "the loop equations are independent",
            Self::Tracked => "the motions were tracked with the loops closed",
            Self::Opens => "the loops open along the only motion",
            Self::Search => "from a search around the configuration",
            Self::Unknown => "not known",
        })
    }
}

/// A branch of closed configurations through the given one.
#[derive(Debug, Clone, PartialEq)]
pub struct Branch {
    /// Its finite degrees of freedom.
    pub dimension: usize,
    /// Motions along it: rates of the coordinates of q, orthonormal when scaled; more than its
    /// dimension if the branch is a cone with its apex here.
    pub motions: Matrix,
    /// Distance to which it was tracked with the loops closed to rounding [rad, or characteristic
    /// lengths].
    pub tracked: f64,
    /// Configurations on it, as far from this one as it was tracked; none if the loop equations are
    /// independent.
    pub configurations: Vec<Vec<f64>>,
    /// Relative threshold for ranks there.
    pub(crate) rank: f64,
}

impl Branch {
    /// Configurations on it, a finite way off `state`: where the loop equations are independent,
    /// the ends of rays.
    pub(crate) fn far(&self, state: &State, length: f64) -> Result<Vec<Vec<f64>>> {
        if !self.configurations.is_empty() {
            return Ok(self.configurations.clone());
        }
        let reduction = LyapunovSchmidt::of(state.mechanism(), state.q(), length, CLOSURE_RANK)?;
        Ok(Rays::of(&reduction)?.ends().cloned().collect())
    }
}

/// The finite mobility of a mechanism at a configuration.
///
/// ```text
/// closed configurations near q = zeros of the reduced equation g(x), x a first-order motion
/// ```
///
/// Without g, the loop equations are independent and every first-order motion is finite (implicit
/// function theorem); g zero at every step has the same consequence. Otherwise the zeros of g
/// (Lyapunov-Schmidt reduction) are searched; each branch of them is a finite motion.
///
/// Source: Kuznetsov 1991; Mueller 2002 (kinematic tangent cone).
#[derive(Debug, Clone, PartialEq)]
pub struct FiniteMobility {
    /// True if the loops are closed here; otherwise nothing is known.
    pub closed: bool,
    /// Number of first-order motions.
    pub infinitesimal: usize,
    /// Degrees of freedom of finite motion: those of the largest branch; `None` if unknown.
    pub finite: Option<usize>,
    /// The branches found, largest first; one at an ordinary configuration, none if it is rigid.
    /// Two or more: a bifurcation.
    pub branches: Vec<Branch>,
    /// First-order motions orthogonal to all branches, one column each: they do not extend to
    /// finite motions (shaky).
    pub shaky: Matrix,
    /// The evidence for `finite`.
    pub evidence: MobilityEvidence,
    /// False if branches may have been missed.
    pub certain: bool,
    /// Distance to which all motions were tracked, those of the largest branch if there are
    /// branches [rad, or characteristic lengths]; 0 if the loop equations are independent.
    pub tracked: f64,
    /// Largest loop residual on the way (scaled) [-]: rounding if all motions are finite.
    pub residual: f64,
    /// The power of the distance with which the loops open: 2 for most shaky structures. `None`
    /// for finite motions, and if it differs between directions.
    pub contact_order: Option<u32>,
    /// The second order; `None` if all first-order motions are finite, or if it is unknown.
    pub second_order: Option<SecondOrder>,
    neighbours: Vec<Vec<f64>>,
}

impl FiniteMobility {
    /// At a configuration, with the characteristic length of the mechanism or another (m).
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
    /// A length that is not of the size of the mechanism; more than 2000 coordinates.
    pub fn of(state: &State, length: Option<f64>) -> Result<Self> {
        let mechanism = state.mechanism();
        let length = mechanism.length_or(length)?;
        let reduction = LyapunovSchmidt::of(mechanism, state.q(), length, CLOSURE_RANK)?;
        let k = reduction.motions();
        let mut report = Self {
            closed: reduction.is_closed(),
            infinitesimal: k,
            finite: None,
            branches: Vec::new(),
            shaky: Matrix::zeros(mechanism.n(), 0),
            evidence: MobilityEvidence::Unknown,
            certain: false,
            tracked: 0.0,
            residual: 0.0,
            contact_order: None,
            second_order: None,
            neighbours: Vec::new(),
        };
        if !report.closed {
            return Ok(report);
        }
        if k == 0 || reduction.dependent() == 0 {
            report.whole(&reduction, MobilityEvidence::Independent, Vec::new())?;
            return Ok(report);
        }
        let rays = Rays::of(&reduction)?;
        (report.tracked, report.residual) = (rays.tracked, rays.residual);
        if rays.tracked == 0.0 {
            return Ok(report);
        }
        if rays.openness <= 1.0 {
            let ends = rays.ends().cloned().collect();
            report.whole(&reduction, MobilityEvidence::Tracked, ends)?;
            report.certain = rays.tracked >= TRACKED_AT_LEAST;
            return Ok(report);
        }
        report.contact_order = rays.power;
        report.second_order = SecondOrder::of(&reduction)?;
        if k == 1 {
            report.evidence = MobilityEvidence::Opens;
            report.certain = rays.openness > CLEARLY_OPEN;
            report.finite = Some(0);
            report.shaky = reduction.unscaled(reduction.kernel());
            return Ok(report);
        }
        let found = branches(mechanism, length, &reduction, rays.open_distance(&reduction))?;
        report.evidence = MobilityEvidence::Search;
        report.certain = found.complete;
        report.finite = Some(found.tangents.first().map_or(0, |t| t.dimension));
        report.tracked = found.tangents.first().map_or(0.0, |t| t.tracked);
        let mut tangents = Matrix::zeros(k, 0);
        for tangent in found.tangents {
            tangents = Matrix::hstack(k, &[&tangents, &tangent.directions]);
            report.branches.push(Branch {
                dimension: tangent.dimension,
                motions: reduction.unscaled(&(reduction.kernel() * &tangent.directions)),
                tracked: tangent.tracked,
                configurations: tangent.far,
                rank: tangent.rank,
            });
            if report.neighbours.is_empty() {
                report.neighbours = tangent.configurations;
            }
        }
        let outside = ColumnSpace::of(&tangents, Threshold::Absolute(WITHIN_BRANCHES)).complement();
        report.shaky = reduction.unscaled(&(reduction.kernel() * &outside));
        Ok(report)
    }

    /// True if every first-order motion is finite.
    #[must_use]
    pub fn is_ordinary(&self) -> bool {
        self.finite == Some(self.infinitesimal)
    }

    /// Closed configurations on both sides, along a motion that involves all degrees of freedom of
    /// the largest branch; fewer if they were not found.
    pub(crate) fn neighbours(&self) -> &[Vec<f64>] {
        &self.neighbours
    }

    fn whole(
        &mut self,
        reduction: &LyapunovSchmidt<'_>,
        evidence: MobilityEvidence,
        configurations: Vec<Vec<f64>>,
    ) -> Result<()> {
        let k = reduction.motions();
        (self.finite, self.evidence, self.certain) = (Some(k), evidence, true);
        if k == 0 {
            return Ok(());
        }
        let motions = reduction.unscaled(reduction.kernel());
        let tracked = self.tracked;
        self.branches.push(Branch {
            dimension: k,
            motions,
            tracked,
            configurations,
            rank: CLOSURE_RANK,
        });
        let x = reduction.direction(0);
        for side in [FINITE_STEP * NEIGHBOUR_DISTANCE, -FINITE_STEP * NEIGHBOUR_DISTANCE] {
            let x: Vec<f64> = x.iter().map(|x| side * x).collect();
            self.neighbours.extend(reduction.step(&x)?.map(|near| near.q));
        }
        Ok(())
    }
}
