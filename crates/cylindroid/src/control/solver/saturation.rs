//! Saturation: enforces bounds of joint velocities on a task and its secondary motion. The task is
//! scaled down first; if no scaling is feasible, its direction is changed.
//!
//! Formula  rates = M y within their bounds; M = 1 without loops. Secondary motion first:
//!          the largest share of it beside the whole task; then the largest s in [0, 1] with
//!          J y = s J y_0, y_0 the unbounded solution of the inverse, while joints at a bound are
//!          clamped one by one. Direction changed: min |J y - J y_0|^2 + d |y|^2 within the bounds,
//!          d = k min(|J y' - J y_0| / gain, |error|), y' the solution for d = 0
//! Shapes   J: m x a, y: a, M: rates x a
//! Cost     two passes over the joints where scaling both motions suffices; otherwise up to n
//!          decompositions of m x n, and two solutions of `active_set.rs` where the direction changes.
//!          No allocation
//! Why so   scaling preserves the direction, which users of straight-line paths rely on; the
//!          direction is changed only when no scaled motion is feasible. Where a part of the task is
//!          out of reach, its curvature outweighs weak directions: the least-squares motion would
//!          overshoot there and swing, d is a bound of that curvature
//! Source   Flacco, De Luca & Khatib 2015, algorithm 1 (saturation in the null space)
//! Checked  tests/it/servo/limits.rs::saturation_*, tests/it/servo/object.rs,
//!          src/control/solver/saturation/tests.rs

use curved::Curved;
pub(in crate::control) use curved::{Curvature, KnownWay, Path};
pub(in crate::control) use newton_step::NewtonStep;
pub(in crate::control) use problem::{FED_FORWARD, LEAST_DAMPING, Problem};

use super::active_set::{ActiveSet, Level, Objective, Precision};
use super::bounds::{LimitKind, VelocityBounds};
use super::inequalities::{Inequalities, crossings};
use crate::inverse::Method;
use crate::linalg::{Matrix, Svd, norm};

/// Below this scale the direction counts as infeasible and is changed [-].
pub(in crate::control) const MIN_SCALE: f64 = 0.05;

/// Damping for an error of one that is out of reach [-]: a tenth of the curvature of two equal links
/// that are nearly straight, for more of it slows the approach along other weak directions. Found by
/// experiment with arms and two arms at the edge of their reach.
pub(in crate::control) const CURVATURE: f64 = 0.05;

/// Share of the velocities, or of their changes, that a joint may reserve for the correction of loops
/// [-].
const CORRECTION: f64 = 0.1;

/// Saturation: the share of a task that the velocity bounds of the joints permit.
///
/// ```text
/// scaled              the largest s in [0, 1] with J q' = s x,  lower <= q' <= upper
/// direction changed   min |J q' - x|^2 + d |q'|^2,  lower <= q' <= upper
/// ```
///
/// Joints at a bound are clamped one by one while the others can still perform the task. The
/// direction changes only if no scaled motion is feasible, or if the target is out of reach of joints
/// with acceleration limits; d, a damping, grows with the error that is out of reach. In trees the
/// curvature of that error takes its place.
///
/// Source: Flacco, De Luca & Khatib 2015, algorithm 1 (saturation in the null space).
#[doc(alias = "bounded least squares")]
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Saturation {
    /// Scale of the realised task twist; 1 when no limit is active.
    pub scale: f64,
    /// True if the direction was changed: no scaled motion was feasible, or none ends at the target.
    pub direction_lost: bool,
}

impl Saturation {
    /// No limit is active.
    pub(in crate::control) const NONE: Self = Self { scale: 1.0, direction_lost: false };
}

/// Rates that follow from the motions of a closed chain, M y + c; c is beside the motion, not a part
/// of its budget.
#[derive(Debug, Clone)]
pub(in crate::control) struct Coupling {
    /// True for the rates of actuated joints.
    pub(in crate::control) is_actuated: Vec<bool>,
    /// M in weighted velocities, a columns.
    pub(in crate::control) motions: Matrix,
    /// c in weighted velocities, which closes the loops of the measured configuration within a step:
    /// of the passive joints, and of the actuated ones with those that follow them.
    pub(in crate::control) correction: Vec<f64>,
    pub(in crate::control) actuated_correction: Vec<f64>,
    /// The actuation y of the primary task, of the secondary ones, of the last step and of the
    /// result.
    pub(in crate::control) primary: Vec<f64>,
    pub(in crate::control) secondary: Vec<f64>,
    pub(in crate::control) last: Vec<f64>,
    pub(in crate::control) actuation: Vec<f64>,
}

impl Coupling {
    /// For these rates and this number of unknowns, at rest.
    pub(in crate::control) fn new(is_actuated: Vec<bool>, unknowns: usize) -> Self {
        let rates = is_actuated.len();
        Self {
            is_actuated,
            motions: Matrix::zeros(rates, unknowns),
            correction: vec![0.0; rates],
            actuated_correction: vec![0.0; rates],
            primary: vec![0.0; unknowns],
            secondary: vec![0.0; unknowns],
            last: vec![0.0; unknowns],
            actuation: vec![0.0; unknowns],
        }
    }

    /// `rates = M y`, without the loop-closure correction.
    pub(in crate::control) fn expand(&self, y: &[f64], rates: &mut [f64]) {
        self.motions.mul_vec_into(y, rates);
    }

    /// Adds the correction as far as the bounds of actuated joints leave room beside the motion:
    /// noise of the measured positions must not compete with it.
    pub(in crate::control) fn correct(&self, bounds: &[VelocityBounds], rates: &mut [f64]) {
        let mut share = 1.0_f64;
        let actuated =
            self.is_actuated.iter().zip(&self.actuated_correction).zip(&*rates).zip(bounds);
        for (((is_actuated, c), rate), bound) in actuated {
            if *is_actuated && *c != 0.0 {
                let room = if *c > 0.0 { bound.upper - rate } else { rate - bound.lower };
                let reserve = CORRECTION * 0.5 * (bound.upper - bound.lower);
                share = share.min(room.min(reserve).max(0.0) / c.abs());
            }
        }
        let both = self.correction.iter().zip(&self.actuated_correction);
        for ((rate, (c, d)), bound) in rates.iter_mut().zip(both).zip(bounds) {
            *rate = bound.clamp(*rate + c + share * d);
        }
    }

    /// Row `joint` of M times `pull`.
    pub(in crate::control) fn along(&self, joint: usize, pull: &[f64]) -> f64 {
        (0..self.motions.cols()).map(|j| self.motions[(joint, j)] * pull[j]).sum()
    }
}

/// Workspace of the saturation.
#[derive(Debug, Clone)]
pub(in crate::control) struct Saturator {
    set: ActiveSet,
    task: Level,
    /// d of the last changed direction.
    #[cfg(test)]
    damping: f64,
    curved: Box<Curved>,
    /// Zero rates.
    rest: Vec<f64>,
    /// Those that the secondary motion adds.
    more: Vec<f64>,
}

impl Saturator {
    /// For a task of m components: n joints of a tree, or n actuated motions on which `rates` rates
    /// of a closed chain depend.
    pub(in crate::control) fn new(m: usize, n: usize, rates: Option<usize>) -> Self {
        let inequalities = Inequalities::new(n, rates.is_none(), rates.unwrap_or(0));
        let rates = rates.unwrap_or(n);
        Self {
            set: ActiveSet::new(n, inequalities),
            task: Level::new(m, n),
            curved: Box::new(Curved::new(m, n)),
            #[cfg(test)]
            damping: 0.0,
            rest: vec![0.0; rates],
            more: vec![0.0; rates],
        }
    }

    /// Bounds the primary motion `rates` of a tree and its secondary motion.
    pub(in crate::control) fn apply(
        &mut self,
        p: Problem<'_>,
        secondary: &[f64],
        curvature: Option<(&mut dyn Curvature, Path)>,
        rates: &mut [f64],
    ) -> Saturation {
        self.more.copy_from_slice(secondary);
        let is_curved = matches!(curvature, Some((_, Path::Curved)));
        if !is_curved && let Some((saturation, ..)) = self.scale_down(&p, rates, None) {
            return saturation;
        }
        for (i, bound) in p.bounds.iter().enumerate() {
            self.set.inequalities.lower[i] = bound.lower;
            self.set.inequalities.upper[i] = bound.upper;
        }
        let Some(saturation) = self.solve(&p, p.last, rates, curvature) else {
            brake(p.last, p.bounds, rates);
            return Saturation { scale: 0.0, direction_lost: true };
        };
        // Rounding at the critical joint.
        for ((rate, y), bound) in rates.iter_mut().zip(self.set.point()).zip(p.bounds) {
            *rate = bound.clamp(*y);
        }
        saturation
    }

    /// Bounds the motions of a closed chain; `rates` are those of its primary motion.
    pub(in crate::control) fn apply_coupled(
        &mut self,
        p: Problem<'_>,
        coupling: &mut Coupling,
        curvature: Option<(&mut dyn Curvature, Path)>,
        rates: &mut [f64],
    ) -> Saturation {
        coupling.expand(&coupling.secondary, &mut self.more);
        let is_curved = matches!(curvature, Some((_, Path::Curved)));
        if !is_curved
            && let Some((saturation, primary, secondary)) =
                self.scale_down(&p, rates, Some(&coupling.primary))
        {
            let both = coupling.primary.iter().zip(&coupling.secondary);
            for (y, (a, b)) in coupling.actuation.iter_mut().zip(both) {
                *y = primary * a + secondary * b;
            }
            coupling.correct(p.bounds, rates);
            return saturation;
        }
        let inequalities = &mut self.set.inequalities;
        for (i, bound) in p.bounds.iter().enumerate() {
            inequalities.set_row(i, |j| coupling.motions[(i, j)]);
            inequalities.lower[i] = bound.lower;
            inequalities.upper[i] = bound.upper;
        }
        let found = self.solve(&p, &coupling.last, &coupling.primary, curvature);
        let Some(saturation) = found else {
            brake(p.last, p.bounds, rates);
            coupling.actuation.fill(0.0);
            return Saturation { scale: 0.0, direction_lost: true };
        };
        coupling.actuation.copy_from_slice(self.set.point());
        coupling.expand(&coupling.actuation, rates);
        coupling.correct(p.bounds, rates);
        saturation
    }

    /// Slows the last motion as far as the bounds permit, all joints together: to rest if they do.
    pub(in crate::control) fn brake(
        &mut self,
        p: &Problem<'_>,
        coupling: Option<&mut Coupling>,
        rates: &mut [f64],
    ) -> Saturation {
        match coupling {
            None => brake(p.last, p.bounds, rates),
            Some(coupling) => {
                coupling.expand(&coupling.last, rates);
                self.more.iter_mut().zip(&*rates).for_each(|(more, rate)| *more = -rate);
                let share = interval(rates, &self.more, p.bounds).map_or(1.0, |span| span.most);
                for (y, last) in coupling.actuation.iter_mut().zip(&coupling.last) {
                    *y = last * (1.0 - share);
                }
                coupling.expand(&coupling.actuation, rates);
                coupling.correct(p.bounds, rates);
            }
        }
        Saturation::NONE
    }

    /// The whole task with a share of the secondary motion, or a scaled task if accelerations alone
    /// bound it, with the shares of both; `None` if that is not enough.
    fn scale_down(
        &mut self,
        p: &Problem<'_>,
        rates: &mut [f64],
        primary: Option<&[f64]>,
    ) -> Option<(Saturation, f64, f64)> {
        let bounds = p.bounds;
        // The secondary motion is reduced first.
        if let Some(span) = interval(rates, &self.more, bounds) {
            for ((rate, z), bound) in rates.iter_mut().zip(&self.more).zip(bounds) {
                *rate = bound.clamp(*rate + span.most * z);
            }
            return Some((Saturation::NONE, 1.0, span.most));
        }
        // While joints accelerate, the twist is scaled and grows from step to step; only persistent
        // limits justify another distribution of the motion over the joints.
        let span = interval(&self.rest, rates, bounds)?;
        let accelerates = span.most > 0.0 && span.cause == LimitKind::Acceleration;
        if !accelerates {
            return None;
        }
        if span.most < MIN_SCALE {
            let primary = primary.unwrap_or(rates);
            p.j.mul_vec_into(primary, &mut self.task.target);
            if !p.is_sensible(primary, norm(&self.task.target)) {
                return None;
            }
        }
        for (rate, bound) in rates.iter_mut().zip(bounds) {
            *rate = bound.clamp(*rate * span.most);
        }
        let saturation = Saturation { scale: span.most, direction_lost: false };
        Some((saturation, span.most, 0.0))
    }

    /// The bounded unknowns, in the active set; `None` if the bounds contradict one another.
    fn solve(
        &mut self,
        p: &Problem<'_>,
        last: &[f64],
        primary: &[f64],
        curvature: Option<(&mut dyn Curvature, Path)>,
    ) -> Option<Saturation> {
        let whole = &mut self.task;
        whole.rows.as_mut_slice().copy_from_slice(p.j.as_slice());
        whole.rows.mul_vec_into(primary, &mut whole.target);
        let is_sensible = p.is_sensible(primary, norm(&whole.target));
        let at_position = |row: usize, sign: f64| {
            let bound = &p.bounds[row];
            let cause = if sign > 0.0 { bound.upper_cause } else { bound.lower_cause };
            cause == LimitKind::Position
        };
        let clamped = match curvature {
            Some((_, Path::Curved)) => None,
            _ => self.set.clamp_one_by_one(&mut self.task, Precision::STRAIGHT),
        };
        if let Some((scale, stop)) = clamped
            && (scale >= MIN_SCALE
                || (is_sensible && !stop.is_some_and(|(row, sign)| at_position(row, sign))))
        {
            return Some(Saturation { scale, direction_lost: false });
        }
        if !self.set.start(last) {
            return None;
        }
        match curvature {
            Some((curvature, _)) => {
                self.curved.solve(&mut self.set, &mut self.task, (p, last), curvature);
            }
            None => self.change_direction(p, last),
        }
        Some(Saturation { scale: 0.0, direction_lost: true })
    }

    /// The damped least-squares solution within the bounds, with a bound of the curvature; the active
    /// set stands at its start.
    fn change_direction(&mut self, p: &Problem<'_>, last: &[f64]) {
        let Self { set, task, .. } = self;
        let left = set.least_residual(task, Precision::STRAIGHT);
        let left = (left / p.gain).min(norm(p.error));
        let damping = (CURVATURE * left).max(LEAST_DAMPING);
        #[cfg(test)]
        {
            self.damping = damping;
        }
        set.start(last);
        set.minimise(Objective::Damped(task, damping), Precision::STRAIGHT);
    }
}

/// The last velocities, slowed together as far as the bounds permit.
pub(in crate::control) fn brake(last: &[f64], bounds: &[VelocityBounds], out: &mut [f64]) {
    // rates (1 - s): from the last ones to rest.
    out.iter_mut().zip(last).for_each(|(o, r)| *o = -r);
    let share = interval(last, out, bounds).map_or(1.0, |span| span.most);
    for ((o, r), bound) in out.iter_mut().zip(last).zip(bounds) {
        *o = bound.clamp(r * (1.0 - share));
    }
}

/// `out = V diag(gains) U^T x`
pub(in crate::control) fn solve(
    svd: &Svd,
    method: &Method,
    gains: &mut [f64],
    x: &[f64],
    out: &mut [f64],
) {
    method.gains(svd, x, gains);
    svd.apply_gains_into(x, gains, out);
}

/// The range of s in which `a + s b` is within the bounds.
#[derive(Debug, Clone, Copy)]
pub(in crate::control) struct Span {
    /// The largest s in [0, 1].
    pub(in crate::control) most: f64,
    /// The limit that sets it; velocity if none.
    pub(in crate::control) cause: LimitKind,
}

/// The largest s in [0, 1] for which `a + s b` is within the bounds; `None` if there is none.
pub(in crate::control) fn interval(
    a: &[f64],
    b: &[f64],
    bounds: &[VelocityBounds],
) -> Option<Span> {
    let mut least = 0.0_f64;
    let mut span = Span { most: 1.0, cause: LimitKind::Velocity };
    for ((a, b), bound) in a.iter().zip(b).zip(bounds) {
        let (enter, leave) = crossings((*a, *b), (bound.lower, bound.upper))?;
        least = least.max(enter);
        if leave < span.most {
            let cause = if *b > 0.0 { bound.upper_cause } else { bound.lower_cause };
            span = Span { most: leave, cause };
        }
    }
    (least <= span.most).then_some(span)
}

mod curved;
mod newton_step;
mod problem;
#[cfg(test)]
mod tests;
