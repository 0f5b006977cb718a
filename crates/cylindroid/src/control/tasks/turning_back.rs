//! Where joints that brake come to rest, and the part of their motion along what tasks ask for: memory of
//! `braking_in_time.rs`.
//!
//! Formula  g = sum over rows  w u / L^2 (J q'),  u = K (e + t f) + f, f the feed-forward, with 1 in place
//!          of the length L for angles
//! Shapes   q': n; u: the rows of the level
//! Checked  tests/it/servo/task_braking.rs

use super::levels::TaskRows;
use super::motions::Motions;
use super::objective::Scratch;
use super::options::MotionTask;
use crate::control::servo::LoopMotions;
use crate::error::Result;
use crate::kinematics::State;
use crate::model::{Limits, Mechanism};
use crate::scalar::clamp;

/// Largest part of the way of a joint in a closed chain in one piece [rad, or lengths of the mechanism]:
/// the passive joints follow it.
const PIECE: f64 = 0.25;

/// Pieces at most; of a longer way nothing is known.
const MOST_PIECES: f64 = 32.0;

/// Where the joints come to rest, and workspace.
#[derive(Debug, Clone)]
pub(super) struct TurningBack {
    pub(super) state: State,
    pub(super) scratch: Scratch,
    /// Of each task.
    pub(super) rows: Vec<TaskRows>,
    pub(super) q: Vec<f64>,
    /// Of the joints that are tried [rad/s or m/s].
    pub(super) rates: Vec<f64>,
    /// Unknowns: of the solver, braked, and between them.
    pub(super) solved: Vec<f64>,
    pub(super) braked: Vec<f64>,
    pub(super) trial: Vec<f64>,
    loops: Option<Box<LoopsAhead>>,
}

/// What a closed chain needs besides.
#[derive(Debug, Clone)]
struct LoopsAhead {
    motions: LoopMotions,
    are_actuated: Vec<bool>,
    /// Of the joints with drives on their way, and of all of them in a piece of it.
    change: Vec<f64>,
    moved: Vec<f64>,
}

/// A motion along what the tasks of a level ask for.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Along {
    pub(super) part: f64,
    /// The square of the size of what they ask for.
    pub(super) square: f64,
}

impl Along {
    /// Adds a task whose target moves on for `later` seconds, with this weight.
    pub(super) fn add(
        &mut self,
        (task, rows): (&MotionTask, &TaskRows),
        rate: impl Fn(usize) -> f64,
        (weight, later, length): (f64, f64, f64),
    ) {
        for (r, (error, forward)) in rows.error.iter().zip(&rows.feed_forward).enumerate() {
            let asked = task.gain * (error + later * forward) + forward;
            let scaled = weight * asked * rows.unit(r, length).powi(2);
            let columns = 0..rows.jacobian.cols();
            self.part += scaled * columns.map(|j| rows.jacobian[(r, j)] * rate(j)).sum::<f64>();
            self.square += scaled * asked;
        }
    }
}

impl TurningBack {
    /// For joints with these limits; `None` where nothing turns back.
    pub(super) fn new(
        mechanism: &Mechanism,
        motions: &Motions,
        limits: &[Limits],
        tasks: &[MotionTask],
    ) -> Result<Option<Self>> {
        let mut moving = limits.iter().enumerate().filter(|(i, _)| motions.is_driven(*i));
        if !moving.any(|(_, l)| l.acceleration < f64::INFINITY || l.jerk < f64::INFINITY) {
            return Ok(None);
        }
        let (n, v, u) = (mechanism.n(), limits.len(), motions.unknowns());
        let needs_masses = tasks.iter().any(|task| task.objective.needs_masses());
        let loops = motions.loops().map(LoopsAhead::new).transpose()?;
        Ok(Some(Self {
            state: mechanism.state(mechanism.home())?,
            scratch: Scratch::new(mechanism, needs_masses),
            rows: tasks.iter().map(|task| TaskRows::new(&task.objective, n)).collect(),
            q: vec![0.0; n],
            rates: vec![0.0; v],
            solved: vec![0.0; u],
            braked: vec![0.0; u],
            trial: vec![0.0; u],
            loops: loops.map(Box::new),
        }))
    }

    /// Velocities between the braked ones and those of the solver.
    pub(super) fn mix(&mut self, share: f64) {
        let all = self.trial.iter_mut().zip(&self.braked).zip(&self.solved);
        all.for_each(|((trial, braked), solved)| *trial = braked + share * (solved - braked));
    }

    /// Moves the state on from `start` for this time with the velocities that are tried. Joints that meet
    /// a limit stop there, and the others go on. False where the loops cannot be followed so far.
    pub(super) fn go_on(&mut self, start: &State, limits: &[Limits], time: f64) -> Result<bool> {
        let Self { q, rates, .. } = self;
        if let Some(loops) = &mut self.loops {
            if !loops.go_on(start, limits, (rates, time))? {
                return Ok(false);
            }
            self.state.set(loops.motions.q())?;
            return Ok(true);
        }
        q.copy_from_slice(start.q());
        start.mechanism().integrate_in_place(q, rates, time);
        for (((q, rate), from), l) in q.iter_mut().zip(rates).zip(start.q()).zip(limits) {
            let inside = clamp(*q, l.lower.min(*from), l.upper.max(*from));
            if inside != *q {
                (*q, *rate) = (inside, 0.0);
            }
        }
        self.state.set(&self.q)?;
        Ok(true)
    }
}

impl LoopsAhead {
    fn new(motions: &LoopMotions) -> Result<Self> {
        let (v, are_actuated) = (motions.velocities(), motions.are_actuated());
        let motions = motions.loaded_copy()?;
        Ok(Self { motions, are_actuated, change: vec![0.0; v], moved: vec![0.0; v] })
    }

    /// The same of the drives, which the passive joints follow.
    fn go_on(
        &mut self,
        start: &State,
        limits: &[Limits],
        (rates, time): (&mut [f64], f64),
    ) -> Result<bool> {
        if !self.motions.set_closed(start.q())? {
            return Ok(false);
        }
        let mut most = 0.0_f64;
        let drives = self.change.iter_mut().zip(&mut *rates).zip(&self.are_actuated);
        for (i, ((change, rate), is_actuated)) in drives.enumerate() {
            if !is_actuated {
                (*change, *rate) = (0.0, 0.0);
                continue;
            }
            let from = start.q().get(i).copied().unwrap_or(0.0);
            let (lower, upper) = (limits[i].lower - from, limits[i].upper - from);
            *change = clamp(*rate * time, lower.min(0.0), upper.max(0.0));
            if *change != *rate * time {
                *rate = 0.0;
            }
            most = most.max(change.abs() / start.mechanism().unit_of(i));
        }
        let pieces = (most / PIECE).ceil();
        if !(pieces <= MOST_PIECES) {
            return Ok(false);
        }
        self.change.iter_mut().for_each(|change| *change /= pieces.max(1.0));
        for _ in 0..pieces as usize {
            if !self.motions.follow(&self.change, &mut self.moved)? {
                return Ok(false);
            }
        }
        self.change.copy_from_slice(rates);
        rates.fill(0.0);
        self.motions.add_following(&self.change, rates);
        Ok(true)
    }
}
