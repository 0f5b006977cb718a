//! The laws that every step must obey, and the figures of many rounds.

use std::fmt;

use cylindroid::Mechanism;
use cylindroid::model::Limits;

/// What many rounds amounted to.
#[derive(Debug, Default)]
pub(crate) struct Tally {
    pub(crate) rounds: u64,
    pub(crate) steps: u64,
    pub(crate) pushes: u64,
    /// Steps in which a coordinate was at a bound of its position.
    pub(crate) at_limits: u64,
    /// Steps after which the distances of all bodies were looked at.
    pub(crate) looks: u64,
    /// Those in which a watched pair of bodies was nearer than the gap.
    pub(crate) below_gap: u64,
    /// The least distance of bodies that started apart (m).
    pub(crate) nearest: Option<f64>,
    /// Steps that ended in an error.
    pub(crate) errors: u64,
    /// Configurations of a round after 1, 2, 4, ... steps.
    pub(crate) passed: Vec<f64>,
    pub(crate) violations: Vec<String>,
}

impl Tally {
    pub(crate) fn panicked(seed: u64) -> Self {
        let violations = vec![format!("round {seed} panics")];
        Self { rounds: 1, violations, ..Self::default() }
    }

    pub(crate) fn note(&mut self, step: u64, q: &[f64]) {
        if (step + 1).is_power_of_two() {
            self.passed.extend_from_slice(q);
        }
    }

    pub(crate) fn add(&mut self, other: Self) {
        self.rounds += other.rounds;
        self.steps += other.steps;
        self.pushes += other.pushes;
        self.at_limits += other.at_limits;
        self.looks += other.looks;
        self.below_gap += other.below_gap;
        self.errors += other.errors;
        self.nearest = [self.nearest, other.nearest].into_iter().flatten().reduce(f64::min);
        self.violations.extend(other.violations);
    }
}

impl fmt::Display for Tally {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { rounds, steps, pushes, at_limits, looks, below_gap, errors, .. } = self;
        write!(
            f,
            "{rounds} rounds, {steps} steps, {pushes} pushes, {at_limits} steps at a position \
             limit, {errors} errors"
        )?;
        if *looks > 0 {
            write!(f, ", {looks} looks at distances, {below_gap} below the gap")?;
        }
        if let Some(nearest) = self.nearest {
            write!(f, ", least distance {nearest:.2e} m")?;
        }
        write!(f, ", {} violations", self.violations.len())
    }
}

/// Watches the coordinates of one round.
pub(crate) struct Watch {
    limits: Vec<Limits>,
    names: Vec<String>,
    dt: f64,
    before: Vec<f64>,
    /// The velocity before that.
    earlier: Vec<f64>,
    /// True from a push until the joint could stop within its acceleration again.
    pushed: Vec<bool>,
}

impl Watch {
    /// `acceleration` holds where the model has no limit.
    pub(crate) fn new(robot: &Mechanism, dt: f64, acceleration: f64) -> Self {
        let limits = robot.coordinates().iter().map(|c| {
            let a = c.limits.acceleration;
            Limits { acceleration: if a.is_finite() { a } else { acceleration }, ..c.limits }
        });
        let n = robot.n();
        Self {
            limits: limits.collect(),
            names: robot.coordinates().iter().map(|c| c.name.clone()).collect(),
            dt,
            before: vec![0.0; n],
            earlier: vec![0.0; n],
            // A start near a limit is as good as a push: at rest it is not.
            pushed: vec![false; n],
        }
    }

    /// The configuration was changed by something other than the servo.
    pub(crate) fn push(&mut self) {
        self.pushed.fill(true);
    }

    /// Checks the step from `q` with these joint velocities to `next`; true if a coordinate is at a
    /// bound.
    pub(crate) fn step(
        &mut self,
        q: &[f64],
        velocities: &[f64],
        next: &[f64],
    ) -> Result<bool, String> {
        let mut at_limit = false;
        for (i, l) in self.limits.iter().enumerate() {
            let (x, v, y, before) = (q[i], velocities[i], next[i], self.before[i]);
            let fail = |what: &str, by: f64| {
                let name = &self.names[i];
                Err(format!(
                    "{name}: {what} by {by:.1e} (q {x:e}, velocity {v:e}, last {before:e}, {l:?})"
                ))
            };
            if !(v.is_finite() && y.is_finite()) {
                return fail("not finite", f64::NAN);
            }
            let outside = |x: f64| (l.lower - x).max(x - l.upper).max(0.0);
            // A state outside moves no further out.
            if outside(y) > outside(x) {
                return fail("position", outside(y) - outside(x));
            }
            at_limit |= y == l.lower || y == l.upper;
            let excess = v.abs() - l.velocity * (1.0 + 1e-12);
            if excess > 0.0 {
                return fail("velocity", excess);
            }
            // A position has no more digits than f64: their rounding, over dt, is in the velocity.
            let rounding = 16.0 * f64::EPSILON * (1.0 + x.abs()) / self.dt + 1e-15 * v.abs();
            let excess = (v - before).abs() - l.acceleration * self.dt * (1.0 + 1e-12);
            if excess > rounding && !self.pushed[i] {
                return fail("acceleration", excess);
            }
            let bend = (v - 2.0 * before + self.earlier[i]).abs() / self.dt;
            let excess = bend - l.jerk * self.dt * (1.0 + 1e-9);
            if excess > 4.0 * rounding / self.dt {
                return fail("jerk", excess / self.dt);
            }
            if self.pushed[i] && self.can_stop(i, v, y) {
                self.pushed[i] = false;
            }
            (self.earlier[i], self.before[i]) = (before, v);
        }
        Ok(at_limit)
    }

    /// True if a joint that moved with `v` to `y` stops before its limits by its acceleration.
    fn can_stop(&self, i: usize, v: f64, y: f64) -> bool {
        let l = &self.limits[i];
        let room = if v > 0.0 { l.upper - y } else { y - l.lower };
        let step = l.acceleration * self.dt;
        if v == 0.0 || step == f64::INFINITY {
            return room >= 0.0;
        }
        // v dt was gone already; v - step, v - 2 step, ... remain.
        let steps = (v.abs() / step).floor();
        let rest = self.dt * (steps * v.abs() - step * steps * (steps + 1.0) / 2.0);
        step > 0.0 && rest <= room
    }
}
