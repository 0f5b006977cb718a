//! Closed-form solutions for the solver: all solutions for six revolute joints, and for seven those
//! with one joint locked, whose value is sampled over its range.
//!
//! Valid    one goal that is a complete pose. Of seven revolute joints one is locked at its initial
//!          value, then at values spread over its limits: each feasible value gives up to eight
//!          solutions
//! Why so   one sample costs a microsecond or two, a restart of the numerical solver ten times as
//!          much
//! Checked  tests/it/ik.rs, tests/it/analytic/

use std::f64::consts::PI;

use super::analytic::{Analytic, AnalyticSolutions};
use super::goal::{Goal, Objective};
use super::options::IkOptions;
use crate::error::Result;
use crate::kinematics::{Chain, ReferenceFrame};
use crate::linalg::{Matrix, Svd};
use crate::model::Mechanism;
use crate::scalar::uniform;
use crate::spatial::Pose;
use crate::task::Task;

/// Samples of the locked joint before the numerical solver takes over.
pub(super) const REDUNDANCY_SAMPLES: usize = 16;
/// Steps of this share of a range are evenly spread for any number of samples: the golden ratio.
const SHARE: f64 = 0.618_033_988_749_894_9;
/// Relative cost of a sample whose equations do not decouple.
const QUARTIC: f64 = 2.5;
/// Configurations at which the self-motion is evaluated.
const LOOKS: usize = 8;

/// Solutions that remain after the closed form.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Remaining {
    /// Further solutions may exist.
    Possible,
    /// The samples of the closed form miss none but short branches.
    Unlikely,
    /// None, up to tolerances: there is no solution, or all were found.
    None,
}

/// The closed form for the goal of a solver.
#[derive(Debug, Clone)]
pub(super) struct ClosedForm {
    pub(super) analytic: Analytic,
    /// The locked joint of seven, with the range of its values.
    locked: Option<(usize, [f64; 2])>,
    /// Its limits.
    limits: [f64; 2],
}

impl ClosedForm {
    /// `None` if there is no closed form.
    pub(super) fn of(mechanism: &Mechanism, goals: &[Goal], options: &IkOptions) -> Option<Self> {
        let [Goal { objective: Objective::Frame { end_effector, components, .. }, .. }] = *goals
        else {
            return None;
        };
        if components.components != Task::POSE.components {
            return None;
        }
        let chain = Chain::of(mechanism, end_effector);
        let all = chain.coordinates();
        let free: Vec<_> = (0..all.len()).filter(|&i| !options.fixed.contains(&all[i])).collect();
        let with_locked =
            |locked: &[usize]| Analytic::with_locked(mechanism, end_effector, locked).ok();
        if free.len() != 7 {
            return Some(Self {
                analytic: with_locked(&options.fixed)?,
                locked: None,
                limits: [0.0; 2],
            });
        }
        let mut best: Option<(f64, Self)> = None;
        for (&i, moves) in free.iter().zip(self_motion(mechanism, chain.clone(), &free)) {
            let c = all[i];
            let Some(analytic) = with_locked(&[&options.fixed[..], &[c]].concat()) else {
                continue;
            };
            let value = moves / if analytic.geometry().splits() { 1.0 } else { QUARTIC };
            if best.as_ref().is_none_or(|(most, _)| value > *most) {
                let limits = mechanism.coordinates()[c].limits;
                let upper = limits.upper.min(PI);
                let range = [limits.lower.max(upper - 2.0 * PI), upper];
                let limits = [limits.lower, limits.upper];
                best = Some((value, Self { analytic, locked: Some((c, range)), limits }));
            }
        }
        best.map(|(_, formulas)| formulas)
    }

    /// True if it gives all solutions.
    pub(super) fn are_all(&self) -> bool {
        self.locked.is_none()
    }

    /// The locked joint of seven with the range of values that its limits permit, a full turn at
    /// most, about its initial value.
    pub(super) fn range_about(&self, start: &[f64]) -> Option<(usize, [f64; 2])> {
        let (c, _) = self.locked?;
        let [lower, upper] = self.limits;
        let range = if upper - lower <= 2.0 * PI {
            [lower, upper]
        } else {
            let lower = (start[c] - PI).max(lower).min(upper - 2.0 * PI);
            [lower, lower + 2.0 * PI]
        };
        Some((c, range))
    }

    /// Solutions; for seven joints those of the i-th sample of the locked joint, which is written
    /// to `start`.
    pub(super) fn solve(
        &mut self,
        target: Pose,
        start: &mut [f64],
        i: usize,
    ) -> Result<AnalyticSolutions> {
        if let Some((c, [lower, upper])) = self.locked
            && i > 0
        {
            start[c] = lower + (upper - lower) * (SHARE * i as f64).fract();
        }
        self.analytic.solve(target, start)
    }
}

/// Mean participation of each of seven joints in the self-motion, over some configurations. A joint
/// that hardly participates, such as an elbow between two spherical joints, is determined by the
/// target; with it locked, no solution remains.
fn self_motion(mechanism: &Mechanism, mut chain: Chain, free: &[usize]) -> [f64; 7] {
    let mut q = mechanism.home().to_vec();
    let mut all = Matrix::zeros(6, chain.n());
    let (mut svd, mut random, mut sum) = (Svd::workspace(6, 7), 0, [0.0; 7]);
    for _ in 0..LOOKS {
        for &i in free {
            let c = chain.coordinates()[i];
            let limits = mechanism.coordinates()[c].limits;
            let (lower, upper) = (limits.lower.max(-PI), limits.upper.min(PI));
            q[c] = lower + (upper - lower) * uniform(&mut random);
        }
        chain.set(&q);
        chain.jacobian_into(ReferenceFrame::LocalWorldAligned, &mut all);
        svd.decompose(&Matrix::from_fn(6, 7, |i, j| all[(i, free[j])]));
        for (j, sum) in sum.iter_mut().enumerate() {
            let elsewhere: f64 = (0..6).map(|i| svd.v(i)[j].powi(2)).sum();
            *sum += (1.0 - elsewhere).max(0.0).sqrt() / LOOKS as f64;
        }
    }
    sum
}
