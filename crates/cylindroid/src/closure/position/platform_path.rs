//! Steps of the platform between two poses on one branch of its inverse kinematics.
//!
//! Formula  predictor and corrector of `predictor_corrector.rs` with the platform's components
//!          prescribed; a step is accepted if |J_f' - J_f| <= (s + s') / 2 in the Frobenius norm,
//!          otherwise halved
//! Units    none: lengths are divided by the characteristic length
//! Valid    as there: by Weyl's inequality no configuration is passed in which the platform at rest
//!          leaves the joints a motion (type I); singularities of type II are passed
//! Why so   the tracker decides ranks and allocates for every path; a map has a million short ones of
//!          one mechanism, whose rank is known
//! Checked  tests/map/five_bar.rs, tests/map/planar_platform.rs

use super::coordinates::{largest_change, moved, within_limits};
use super::loop_equations::LoopEquations;
use super::signed_singularity::SignedSingularity;
use crate::error::{Result, all_finite};
use crate::linalg::{Matrix, Svd, norm};
use crate::model::Mechanism;
use crate::tolerance::{CORRECTION_ROUNDING, LOOP_ROUNDING, PLATFORM_SINGULAR};

/// Maximum number of corrector steps.
const MAX_CORRECTIONS: usize = 20;
/// Shortest step, as a fraction of the way.
const SHORTEST: f64 = 1e-9;
/// Maximum number of steps of a way, rejected ones included.
const MAX_STEPS: usize = 400;
/// Largest change of a coordinate in one step [rad, or characteristic lengths].
const LONGEST: f64 = 0.5;
/// A corrector that gains less than this factor gets the Jacobian of its own place.
const GAIN: f64 = 0.05;

/// A configuration with closed loops.
#[derive(Debug, Clone)]
pub(crate) struct PathNode {
    pub(crate) q: Vec<f64>,
    /// The Jacobian of the loops, all coordinates.
    by_prescribed: Matrix,
    pub(crate) by_free: Matrix,
    pub(crate) svd: Svd,
}

/// Why the way to a pose ended before it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Obstruction {
    /// A singularity of type I, or the branch ends.
    Singular,
    /// This coordinate would leave its limits.
    Limit(usize),
}

/// Moves the platform of one mechanism.
#[derive(Debug, Clone)]
pub(crate) struct PlatformPath {
    pub(crate) equations: LoopEquations,
    mechanism: Mechanism,
    /// The components that move.
    moving: Vec<usize>,
    pub(crate) by_free: SignedSingularity,
    by_moving: SignedSingularity,
}

impl PlatformPath {
    /// `moving`: the prescribed coordinates that change; `by_free`: the block of the free ones.
    pub(crate) fn new(
        equations: LoopEquations,
        moving: Vec<usize>,
        by_free: SignedSingularity,
    ) -> Self {
        let loops = equations.loop_rows();
        let by_moving = SignedSingularity::new(0..loops, moving.clone(), &[]);
        let mechanism = equations.mechanism().clone();
        Self { equations, mechanism, moving, by_free, by_moving }
    }

    /// The node at a configuration.
    pub(crate) fn node(&mut self, q: &[f64]) -> Result<PathNode> {
        self.equations.set(q)?;
        Ok(self.here(q.to_vec()))
    }

    fn here(&self, q: Vec<f64>) -> PathNode {
        let by_free = self.by_free.block(&self.equations.jacobian);
        let by_prescribed = self.by_moving.block(&self.equations.jacobian);
        PathNode { q, by_prescribed, svd: Svd::of(&by_free), by_free }
    }

    /// Moves to these values of the moving components: the node there, or the last one before the
    /// obstruction.
    pub(crate) fn go(
        &mut self,
        from: &PathNode,
        goal: &[f64],
    ) -> Result<std::result::Result<PathNode, (PathNode, Obstruction)>> {
        let units: Vec<f64> = self.moving.iter().map(|&i| self.equations.unit(i)).collect();
        let begin: Vec<f64> = self.moving.iter().map(|&i| from.q[i]).collect();
        let direction: Vec<f64> = begin
            .iter()
            .zip(goal)
            .zip(&units)
            .map(|((from, to), unit)| (to - from) / unit)
            .collect();
        let mut here = from.clone();
        let (mut fraction, mut step) = (0.0, 1.0_f64);
        for _ in 0..MAX_STEPS {
            let tangent = self.tangent(&here, &direction);
            let speed = largest_change(&self.mechanism, &self.by_free.columns, &tangent);
            step = step.min(LONGEST / speed.max(f64::MIN_POSITIVE)).min(1.0 - fraction);
            let obstruction = loop {
                let to = if step >= 1.0 - fraction { 1.0 } else { fraction + step };
                let change: Vec<f64> = tangent.iter().map(|x| step * x).collect();
                let mut guess = moved(&self.mechanism, &here.q, &self.by_free.columns, &change);
                for (k, &i) in self.moving.iter().enumerate() {
                    guess[i] =
                        if to >= 1.0 { goal[k] } else { begin[k] + to * (goal[k] - begin[k]) };
                }
                let predicted = norm(&change) + step * norm(&direction);
                match self.accepted(&here, guess, predicted)? {
                    Ok(next) => {
                        (here, fraction) = (next, to);
                        break None;
                    }
                    Err(why) => {
                        step *= 0.5;
                        if step < SHORTEST {
                            break Some(why);
                        }
                    }
                }
            };
            if let Some(why) = obstruction {
                return Ok(Err((here, why)));
            }
            if fraction >= 1.0 {
                return Ok(Ok(here));
            }
            if self.by_free.distance(&here.svd) < PLATFORM_SINGULAR {
                return Ok(Err((here, Obstruction::Singular)));
            }
            step *= 2.0;
        }
        Ok(Err((here, Obstruction::Singular)))
    }

    /// f', of least norm.
    fn tangent(&self, here: &PathNode, direction: &[f64]) -> Vec<f64> {
        let opened = here.by_prescribed.mul_vec(direction);
        let mut follow = here.svd.solve(&opened, self.by_free.rank);
        follow.iter_mut().for_each(|x| *x = -*x);
        follow
    }

    /// The corrected guess, if it is certainly on the branch and within limits.
    fn accepted(
        &mut self,
        here: &PathNode,
        guess: Vec<f64>,
        predicted: f64,
    ) -> Result<std::result::Result<PathNode, Obstruction>> {
        let Some((there, corrected)) = self.corrected(here, guess)? else {
            return Ok(Err(Obstruction::Singular));
        };
        let turned = there
            .by_free
            .as_slice()
            .iter()
            .zip(here.by_free.as_slice())
            .map(|(a, b)| (a - b) * (a - b))
            .sum::<f64>()
            .sqrt();
        let smallest = |svd: &Svd| match self.by_free.rank {
            0 => f64::INFINITY,
            rank => svd.value(rank - 1),
        };
        if corrected > 0.5 * predicted + CORRECTION_ROUNDING
            || turned > 0.5 * (smallest(&here.svd) + smallest(&there.svd))
        {
            return Ok(Err(Obstruction::Singular));
        }
        let beyond: Vec<usize> = self.mechanism.outside_limits(&there.q).collect();
        let coordinates = self.mechanism.coordinates();
        if let Some(&i) = beyond.iter().find(|&&i| coordinates[i].limits.exclude(there.q[i])) {
            return Ok(Err(Obstruction::Limit(i)));
        }
        if beyond.is_empty() {
            return Ok(Ok(there));
        }
        let q = within_limits(&self.mechanism, there.q, &beyond);
        Ok(Ok(self.node(&q)?))
    }

    /// Newton corrector with the platform fixed: the node and its distance from the guess. The
    /// Jacobian of the start serves as long as it converges.
    fn corrected(&mut self, here: &PathNode, guess: Vec<f64>) -> Result<Option<(PathNode, f64)>> {
        let mut q = guess;
        self.equations.set(&q)?;
        let mut own: Option<Svd> = None;
        let mut moved_by = 0.0;
        let mut open = self.equations.residual_norm();
        for _ in 0..MAX_CORRECTIONS {
            if open <= LOOP_ROUNDING {
                break;
            }
            let svd = own.as_ref().unwrap_or(&here.svd);
            let mut change = svd.solve(&self.equations.residuals, self.by_free.rank);
            change.iter_mut().for_each(|x| *x = -*x);
            let next = moved(&self.mechanism, &q, &self.by_free.columns, &change);
            if !all_finite(&next) {
                return Ok(None);
            }
            self.equations.set(&next)?;
            let now = self.equations.residual_norm();
            if !(now < 0.5 * open) {
                // Back to the better of the two.
                self.equations.set(&q)?;
                if own.is_some() || self.equations.is_closed {
                    break;
                }
                own = Some(Svd::of(&self.by_free.block(&self.equations.jacobian)));
                continue;
            }
            moved_by += norm(&change);
            if now > GAIN * open {
                own = Some(Svd::of(&self.by_free.block(&self.equations.jacobian)));
            }
            (q, open) = (next, now);
        }
        Ok(self.equations.is_closed.then(|| (self.here(q), moved_by)))
    }
}
