//! The robot behind a servo: its drives lag, its bus delays, its encoders are noisy.
//!
//! Formula  predicted configuration z = q + r: r the way that the drives still cover on the commands
//!          given so far, r = integral of the commands of the last D seconds + T w; w the velocity
//!          of the drives, T w' = u(t - D) - w, u the commands
//!          Then z(next) = z + u dt: z moves as an ideal robot does, and q is a mean of earlier z
//!          with positive weights. Limits of positions, velocities and accelerations that z obeys
//!          are obeyed by q
//! Loops    passive joints do not follow their commands: where z opens the loops it is assembled
//!          (`loop_motions.rs`)
//! Noise    z is estimated: a share dt / (dt + `FILTER_TIME`) of what the measurement says beyond the
//!          last estimate moved by u dt, while that is within twice the noise; otherwise all of it.
//!          Limits of positions hold for an interval that contains the true z, the last one moved by
//!          u dt and cut by the measured z and the noise to both sides: its ends come no nearer to a
//!          limit than u dt takes them, so that braking in time stays possible. They keep the noise
//!          from the limits, for other drives; where measurement and command contradict one
//!          another, they move as z does
//! Units    s, rad or m
//! Valid    drives of first order with a gain of one; others as far as they resemble them. No
//!          allocation in steps
//! Source   Smith, Closer control of loops with dead time, Chem. Eng. Progress 53 (1957), 217-219
//! Checked  tests/it/servo/plant.rs, tests/it/servo/plant_noise.rs

use crate::error::{Error, Result};
use crate::model::{CoordinateKind, Limits, Mechanism};
use crate::scalar::uniform;
use crate::tolerance::LIMIT_ROUNDING;

/// Time constant of the estimate of the configuration under noise (s).
const FILTER_TIME: f64 = 0.02;
/// Steps that a delay lasts at most: memory for all of them is reserved at the start.
const MAX_DELAY: f64 = 1000.0;

/// Longest time constant, in steps: slower drives do not move within any motion.
const MAX_TIME_CONSTANT: f64 = 1e6;

/// How a robot follows the commands of a servo: with [`Plant::IDEAL`], at once and exactly.
///
/// The servo steers the configuration to which the commands given so far lead, so that braking
/// begins in time: joints of a robot with this delay, this time constant and errors of measurement
/// up to `noise` keep their limits as those of an ideal robot do.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Plant {
    /// Time from a measurement until the drives receive the command computed from it (s).
    pub delay: f64,
    /// Time constant with which the drives follow their commands, positions or velocities (s).
    pub time_constant: f64,
    /// Largest error of measured positions [rad or m]: joints keep this distance from their
    /// position limits, wherever the measurements may place them.
    pub noise: f64,
}

impl Plant {
    /// Neither delay nor lag nor noise.
    pub const IDEAL: Self = Self { delay: 0.0, time_constant: 0.0, noise: 0.0 };

    /// Time by which the robot is behind its commands at constant velocity (s).
    #[must_use]
    pub fn lag(&self) -> f64 {
        self.delay + self.time_constant
    }

    /// Tightens the position limits of a joint by the noise.
    pub(in crate::control) fn keep_off(&self, limits: &mut Limits) {
        let least = 0.5 * (limits.upper - limits.lower);
        let off = self.noise.min(least);
        if off > 0.0 {
            (limits.lower, limits.upper) = (limits.lower + off, limits.upper - off);
        }
    }

    /// Checks the values for steps of `dt` (s).
    ///
    /// # Errors
    /// [`Error::InvalidOption`] for negative, infinite or NaN values, for a delay of more than 1000
    /// steps, and for a time constant of more than a million.
    pub fn check(&self, dt: f64) -> Result<()> {
        for (option, value) in
            [("delay", self.delay), ("time constant", self.time_constant), ("noise", self.noise)]
        {
            if !(value >= 0.0 && value.is_finite()) {
                return Err(Error::InvalidOption {
                    option,
                    value: value.to_string(),
                    reason: "it must be finite and not negative".to_owned(),
                });
            }
        }
        if self.delay > MAX_DELAY * dt {
            return Err(Error::InvalidOption {
                option: "delay",
                value: self.delay.to_string(),
                reason: format!("it must be at most {MAX_DELAY} steps, {} s", MAX_DELAY * dt),
            });
        }
        if self.time_constant > MAX_TIME_CONSTANT * dt {
            return Err(Error::InvalidOption {
                option: "time constant",
                value: self.time_constant.to_string(),
                reason: format!(
                    "it must be at most {MAX_TIME_CONSTANT:e} steps, {} s",
                    MAX_TIME_CONSTANT * dt
                ),
            });
        }
        Ok(())
    }
}

/// The commands that a robot has not carried out yet, and the configuration to which they lead.
#[derive(Debug, Clone)]
pub(in crate::control) struct Predictor {
    plant: Plant,
    dt: f64,
    /// Commands that the drives have not received: rows of n velocities, the oldest first from
    /// `oldest` on.
    waiting: Vec<f64>,
    oldest: usize,
    /// Time for which the oldest row still waits (s).
    rest: f64,
    /// Velocities of the drives [rad/s or m/s].
    drives: Vec<f64>,
    /// The way that the drives still cover, r [rad or m].
    way: Vec<f64>,
    measured: Vec<f64>,
    /// The predicted configuration.
    q: Vec<f64>,
    /// The last one, moved by the last command.
    expected: Vec<f64>,
    /// Between these the true one lies, as far as measurements and commands tell; the last ones,
    /// moved by the last command.
    range: Vec<[f64; 2]>,
    expected_range: Vec<[f64; 2]>,
    /// True if a command was given since the robot was at rest.
    is_started: bool,
    /// Coordinates that add: others are measured, not estimated.
    is_scalar: Vec<bool>,
}

impl Predictor {
    /// Of a robot at rest; `None` for an ideal one.
    pub(in crate::control) fn new(mechanism: &Mechanism, plant: Plant, dt: f64) -> Option<Self> {
        if plant == Plant::IDEAL {
            return None;
        }
        let n = mechanism.n();
        let rows = (plant.delay / dt).ceil();
        let is_scalar: Vec<bool> = mechanism
            .coordinates()
            .iter()
            .map(|c| matches!(c.kind, CoordinateKind::Angle | CoordinateKind::Length))
            .collect();
        Some(Self {
            plant,
            dt,
            waiting: vec![0.0; n * rows as usize],
            oldest: 0,
            rest: plant.delay - (rows - 1.0).max(0.0) * dt,
            drives: vec![0.0; n],
            way: vec![0.0; n],
            measured: vec![0.0; n],
            q: vec![0.0; n],
            expected: vec![0.0; n],
            range: vec![[0.0; 2]; n],
            expected_range: vec![[0.0; 2]; n],
            is_started: false,
            is_scalar,
        })
    }

    pub(in crate::control) fn plant(&self) -> Plant {
        self.plant
    }

    /// The robot is at rest again.
    pub(in crate::control) fn reset(&mut self) {
        self.waiting.fill(0.0);
        self.drives.fill(0.0);
        self.way.fill(0.0);
        self.is_started = false;
    }

    /// Stores a measured configuration.
    pub(in crate::control) fn note(&mut self, measured: &[f64]) {
        self.measured.copy_from_slice(measured);
    }

    pub(in crate::control) fn measured(&self) -> &[f64] {
        &self.measured
    }

    /// The configuration to which the commands given so far lead, from the measured one: [`Self::q`].
    /// `close` closes its loops, given with the measured one.
    pub(in crate::control) fn predict(
        &mut self,
        mechanism: &Mechanism,
        close: impl FnOnce(&mut [f64], &[f64]) -> Result<()>,
    ) -> Result<()> {
        self.q.copy_from_slice(&self.measured);
        mechanism.integrate_in_place(&mut self.q, &self.way, 1.0);
        if self.plant.noise > 0.0 {
            self.estimate();
        }
        close(&mut self.q, &self.measured)
    }

    /// Estimates the predicted configuration, given as it is measured, and its range.
    fn estimate(&mut self) {
        let noise = self.plant.noise;
        let share = self.dt / (self.dt + FILTER_TIME);
        let last = self.expected.iter().zip(&self.expected_range).zip(&self.is_scalar);
        for ((q, range), ((expected, moved), is_scalar)) in
            self.q.iter_mut().zip(&mut self.range).zip(last)
        {
            let measured = [*q - noise, *q + noise];
            *range = measured;
            let news = *q - expected;
            if self.is_started && *is_scalar && news.abs() <= 2.0 * noise {
                *range = cut(*moved, measured, share);
                *q = expected + share * news;
            }
        }
    }

    /// The predicted configuration.
    pub(in crate::control) fn q(&self) -> &[f64] {
        &self.q
    }

    /// Sets the position limits of these coordinates such that the predicted configuration is within
    /// them where all that may be the true one keep the noise from those of the model.
    pub(in crate::control) fn keep_off(
        &self,
        mechanism: &Mechanism,
        coordinates: impl Iterator<Item = usize>,
        limits: &mut [Limits],
    ) {
        let noise = self.plant.noise;
        if noise == 0.0 {
            return;
        }
        // Those of actuated loop joints, beyond n, stay.
        for (i, own) in coordinates.take_while(|i| *i < mechanism.n()).zip(limits) {
            let coordinate = &mechanism.coordinates()[i];
            let Limits { lower, upper, .. } = coordinate.limits;
            // Passive joints follow the loops, not their commands: their limits stay.
            let is_driven = !mechanism.is_closed() || coordinate.actuated;
            // Narrower ones lock the joint.
            if self.is_scalar[i] && is_driven && upper - lower > 2.0 * noise {
                // For drives that are not quite the known ones.
                let off = noise.min(0.5 * (upper - lower) - noise);
                let [least, most] = self.range[i];
                own.lower = lower + off + (self.q[i] - least);
                own.upper = upper - off - (most - self.q[i]);
            }
        }
    }

    /// Records the velocities commanded at the predicted configuration.
    pub(in crate::control) fn record(&mut self, mechanism: &Mechanism, commanded: &[f64]) {
        let n = self.drives.len();
        let (dt, rows) = (self.dt, self.waiting.len().checked_div(n).unwrap_or(0));
        self.expected.copy_from_slice(&self.q);
        mechanism.integrate_in_place(&mut self.expected, commanded, dt);
        for ((moved, range), velocity) in
            self.expected_range.iter_mut().zip(&self.range).zip(commanded)
        {
            *moved = range.map(|end| end + velocity * dt);
        }
        self.is_started = true;
        // In the next step the oldest row is in effect for the rest of its time, then the one after.
        let time = self.plant.time_constant;
        let kept = |seconds: f64| if time > 0.0 { (-seconds / time).exp() } else { 0.0 };
        let (first, second) = match rows {
            0 => (0.0, kept(dt)),
            _ => (kept(self.rest), kept(dt - self.rest)),
        };
        for (i, &command) in commanded.iter().enumerate() {
            let at = |row: usize| match (self.oldest + row) % rows.max(1) {
                _ if row == rows => command,
                row => self.waiting[row * n + i],
            };
            let mut speed = self.drives[i];
            if rows > 0 {
                speed = at(0) + first * (speed - at(0));
            }
            let next = at(rows.min(1));
            if rows == 0 || self.rest < dt {
                speed = next + second * (speed - next);
            }
            // The rows that wait in the next step: all but the oldest, and the new one.
            let later: f64 = (2..=rows).map(at).sum();
            self.way[i] = time * speed + later * dt + if rows > 0 { self.rest * next } else { 0.0 };
            self.drives[i] = speed;
        }
        if rows > 0 {
            self.waiting[self.oldest * n..][..n].copy_from_slice(commanded);
            self.oldest = (self.oldest + 1) % rows;
        }
    }
}

/// What two intervals have in common; if that is nothing, beside rounding, the first moved by a share
/// towards the second.
fn cut(expected: [f64; 2], measured: [f64; 2], share: f64) -> [f64; 2] {
    let [least, most] = [expected[0].max(measured[0]), expected[1].min(measured[1])];
    if least <= most + LIMIT_ROUNDING * (1.0 + most.abs()) {
        return [least.min(most), least.max(most)];
    }
    [0, 1].map(|end| expected[end] + share * (measured[end] - expected[end]))
}

/// A robot behind the drives of a plant, in a simulation.
#[derive(Debug)]
pub(in crate::control) struct SimulatedRobot {
    /// The configuration, and the one to which the commands lead.
    q: Vec<f64>,
    led_to: Vec<f64>,
    measured: Vec<f64>,
    drives: Option<Predictor>,
    noise: f64,
    /// Of the random numbers.
    seed: u64,
}

impl SimulatedRobot {
    /// At rest at a configuration, whose size is checked by the first step.
    pub(in crate::control) fn new(mechanism: &Mechanism, q: &[f64], plant: Plant, dt: f64) -> Self {
        Self {
            q: q.to_vec(),
            led_to: q.to_vec(),
            measured: q.to_vec(),
            drives: Predictor::new(mechanism, plant, dt),
            noise: plant.noise,
            seed: 1,
        }
    }

    pub(in crate::control) fn q(&self) -> &[f64] {
        &self.q
    }

    pub(in crate::control) fn into_q(self) -> Vec<f64> {
        self.q
    }

    /// The configuration with evenly distributed errors up to the noise.
    pub(in crate::control) fn measure(&mut self) -> &[f64] {
        self.measured.copy_from_slice(&self.q);
        if self.noise > 0.0 {
            for x in &mut self.measured {
                *x += self.noise * (2.0 * uniform(&mut self.seed) - 1.0);
            }
        }
        &self.measured
    }

    /// Lets the time of a step pass; `close` assembles the loops.
    pub(in crate::control) fn follow(
        &mut self,
        mechanism: &Mechanism,
        commanded: &[f64],
        dt: f64,
        close: impl Fn(&mut [f64]),
    ) {
        mechanism.integrate_in_place(&mut self.led_to, commanded, dt);
        close(&mut self.led_to);
        self.q.copy_from_slice(&self.led_to);
        if let Some(drives) = &mut self.drives {
            drives.record(mechanism, commanded);
            mechanism.integrate_in_place(&mut self.q, &drives.way, -1.0);
            close(&mut self.q);
        }
    }
}
