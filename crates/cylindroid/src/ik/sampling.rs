//! Random configurations from which the numerical solver starts again.
//!
//! Formula  uniform within the limits; angles that have none, or return to the same pose after a full
//!          turn, in [-pi, pi]; slides without limits, or with wide ones, within pi m of the initial
//!          guess, more if the targets are far from there. Near the initial guess: within 1 rad or
//!          1 m of it, slides also more
//! Units    m, rad
//! Checked  tests/it/ik_wide_limits.rs, tests/it/ik_long_slides.rs

use std::f64::consts::PI;

use super::convergence::stretch;
use super::solve::Solver;
use crate::scalar::{clamp, uniform};
use crate::tolerance::WIDEST_RANGE;

/// Largest perturbation of the initial guess for every second restart [rad, or m times `stretch`].
const PERTURBATION: f64 = 1.0;

impl Solver {
    /// A random configuration within the limits, anywhere or near the initial guess.
    pub(super) fn sample_configuration(&self, q: &mut [f64], near: bool, random: &mut u64) {
        self.sample_at_distance(q, near, self.from_goals, random);
    }

    /// The same for targets at this distance (m) from the initial guess.
    pub(super) fn sample_at_distance(
        &self,
        q: &mut [f64],
        near: bool,
        distance: f64,
        random: &mut u64,
    ) {
        let p = &self.problem;
        for (i, &c) in p.coordinates.iter().enumerate().filter(|(i, _)| !p.fixed[*i]) {
            let is_slide = p.mechanism.coordinates()[c].kind.is_length();
            let is_bounded = p.upper[i] - p.lower[i] <= WIDEST_RANGE && !p.turns[i];
            let unit = stretch(p.travel[i], distance);
            let (middle, spread) = match near {
                true => (self.preferred[c], PERTURBATION * unit),
                false if is_bounded => (0.0, f64::INFINITY),
                false => (if is_slide { self.start[c] } else { 0.0 }, PI * unit),
            };
            let (lower, upper) = (p.lower[i].max(middle - spread), p.upper[i].min(middle + spread));
            // Limits outside the sampling range leave one end of it.
            q[c] = clamp(lower + (upper - lower) * uniform(random), p.lower[i], p.upper[i]);
        }
    }
}
