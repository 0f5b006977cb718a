//! Assembly modes: the isolated configurations in which the loops close for given values of the
//! prescribed coordinates.
//!
//! Formula  assemblies from the guess and from random restarts within limits; two are the same mode
//!          if all joints and the reference frame coincide (`configuration_signature.rs`)
//! Units    none: lengths are divided by the characteristic length
//! Valid    any mechanism. Modes may be missed: they are found by random sampling, rarely if their
//!          basin of attraction is small. The Good-Turing estimate (fraction of modes found exactly
//!          once) estimates the probability that the next closing start yields a new one
//!          ([`AssemblyModes::unseen_probability`]). If the prescribed coordinates leave a
//!          self-motion, assemblies form continua: they are distinguished by the landmarks that no
//!          self-motion moves, and one is listed for all that agree there
//! Why so   elimination yields all roots, but needs a derivation for every kind of mechanism and
//!          ignores limits; polynomial homotopies track complex roots by the thousand
//! Source   Good 1953 for the estimate; a trial step distinguishes a self-motion from a double root
//! Checked  tests/it/closure/modes.rs

use std::f64::consts::TAU;

use super::assembly::{Assembly, assemble};
use super::configuration_signature::{Landmarks, link_poses, max_displacement, signature_distance};
use super::coordinates::{at_limit, columns, free_places, largest_change, moved, within_limits};
use super::initial_guesses::{by_name, random};
use super::loop_closure::LoopClosure;
use crate::closure::constraint::rate_rank::rate_space;
use crate::closure::constraint::velocity_constraint::kernel_tolerance;
use crate::error::{Error, Result};
use crate::linalg::Matrix;
use crate::model::{CoordinateKind, JointKind, Mechanism};
use crate::spatial::Vec3;
use crate::tolerance::{CLOSURE_RANK, SAME_ASSEMBLY, TRIAL_MOVED};

/// Length of the trial step along a self-motion [rad, or characteristic lengths].
const TRIAL: f64 = 0.05;

/// Options of the search for assembly modes or operation modes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ModeOptions {
    /// Number of starts, the guess included; at least 1.
    pub starts: usize,
    /// Seed of the random restarts: the same on every machine.
    pub seed: u64,
}

impl Default for ModeOptions {
    fn default() -> Self {
        Self { starts: 64, seed: 0 }
    }
}

/// An assembly mode.
#[derive(Debug, Clone, PartialEq)]
pub struct Mode {
    /// The assembly, with angles wrapped to within pi of the guess where limits permit; for a
    /// continuum, the one nearest to the guess that was found.
    pub assembly: Assembly,
    /// Number of starts that led to it.
    pub found: usize,
    /// Distance from the guess: the largest displacement of a joint over the characteristic length,
    /// or the largest chord between unit axes [-].
    pub distance: f64,
    /// Degrees of freedom that the prescribed coordinates leave: zero for an isolated assembly.
    pub self_motion_dof: usize,
}

/// The result of a search for assembly modes.
#[derive(Debug, Clone, PartialEq)]
pub struct AssemblyModes {
    /// The modes found, nearest to the guess first. There may be others.
    pub modes: Vec<Mode>,
    /// The assembly from the guess, closed or not.
    pub first: Assembly,
    /// Number of starts.
    pub starts: usize,
    /// Number of starts from which the loops closed.
    pub closed: usize,
}

impl AssemblyModes {
    /// The largest number of degrees of freedom that the prescribed coordinates leave, over all
    /// modes.
    #[must_use]
    pub fn self_motion_dof(&self) -> usize {
        self.modes.iter().map(|m| m.self_motion_dof).max().unwrap_or(0)
    }

    /// Good-Turing estimate of the probability that another closing start finds a new mode: n_1 /
    /// N, with N closing starts and n_1 modes found only once (Good 1953). 1 if no start closed.
    #[must_use]
    #[doc(alias = "Good-Turing")]
    pub fn unseen_probability(&self) -> f64 {
        if self.closed == 0 {
            return 1.0;
        }
        let once = self.modes.iter().filter(|m| m.found == 1).count();
        once as f64 / self.closed as f64
    }
}

/// Searches for the assembly modes of `mechanism` with the `prescribed` coordinates (indices into
/// `q`) at their values in `guess`: assemblies from the guess and from random restarts within
/// limits.
///
/// Two assemblies are the same mode if all joints and the reference frame coincide. If the
/// prescribed coordinates leave a self-motion, assemblies form continua, and one is listed for all
/// with the same landmarks that no self-motion moves. Modes may be missed, rarely found if their
/// basin of attraction is small: [`AssemblyModes::unseen_probability`] estimates how probably.
///
/// ```
/// use cylindroid::closure::{ModeOptions, assembly_modes};
///
/// // A four-bar with its crank prescribed: elbow up or elbow down.
/// let four_bar = cylindroid::load("four-bar")?;
/// let found = assembly_modes(&four_bar, &[0.3, 0.0, 0.0], &[0], ModeOptions::default())?;
/// assert_eq!(found.modes.len(), 2);
/// # Ok::<(), cylindroid::Error>(())
/// ```
///
/// # Errors
/// As [`crate::closure::assemble`]; zero starts.
pub fn assembly_modes(
    mechanism: &Mechanism,
    guess: &[f64],
    prescribed: &[usize],
    options: ModeOptions,
) -> Result<AssemblyModes> {
    assembly_modes_while(mechanism, guess, prescribed, options, || true)
}

/// The same as long as `go_on` is true, which is asked before each start: from those made until then.
pub(crate) fn assembly_modes_while(
    mechanism: &Mechanism,
    guess: &[f64],
    prescribed: &[usize],
    options: ModeOptions,
    go_on: impl Fn() -> bool,
) -> Result<AssemblyModes> {
    check_starts(options)?;
    let first = assemble(mechanism, guess, prescribed)?;
    let free = free_places(mechanism, prescribed)?;
    let landmarks = Landmarks::of(mechanism);
    let mut search = Search { mechanism, prescribed, free: &free, landmarks, modes: Vec::new() };
    let guessed = search.places(guess)?;
    let (mut closed, mut starts) = (0, 0);
    while starts < options.starts && go_on() {
        let found = if starts == 0 {
            first.clone()
        } else {
            let restart = [options.seed, starts as u64];
            assemble(mechanism, &random(mechanism, guess, &free, restart), prescribed)?
        };
        if found.closed {
            closed += 1;
            search.add(wrapped_near(mechanism, guess, &free, found), &guessed)?;
        }
        starts += 1;
    }
    let mut modes: Vec<Mode> = search.modes.into_iter().map(|seen| seen.mode).collect();
    modes.sort_by(|a, b| a.distance.total_cmp(&b.distance));
    Ok(AssemblyModes { modes, first, starts, closed })
}

pub(crate) fn check_starts(options: ModeOptions) -> Result<()> {
    if options.starts > 0 {
        return Ok(());
    }
    Err(Error::InvalidOption {
        option: "starts",
        value: "0".to_owned(),
        reason: "the guess is the first start, so at least 1 is needed".to_owned(),
    })
}

struct Search<'a> {
    mechanism: &'a Mechanism,
    prescribed: &'a [usize],
    free: &'a [usize],
    landmarks: Landmarks,
    modes: Vec<KnownMode>,
}

/// A mode with its signature, and the landmarks that no self-motion moves.
struct KnownMode {
    mode: Mode,
    places: Vec<Vec3>,
    resting: Vec<bool>,
}

impl Search<'_> {
    fn places(&self, q: &[f64]) -> Result<Vec<Vec3>> {
        Ok(self.landmarks.at(&link_poses(&self.mechanism.state(q)?)))
    }

    fn add(&mut self, assembly: Assembly, guessed: &[Vec3]) -> Result<()> {
        let places = self.places(&assembly.q)?;
        let distance = signature_distance(&places, guessed, |_| true);
        let isolated = |seen: &&mut KnownMode| {
            seen.mode.self_motion_dof == 0
                && signature_distance(&places, &seen.places, |_| true) <= SAME_ASSEMBLY
        };
        if let Some(known) = self.modes.iter_mut().find(isolated) {
            known.mode.found += 1;
            return Ok(());
        }
        let (self_motion_dof, resting) = self.self_motions(&assembly.q)?;
        let same = |seen: &&mut KnownMode| {
            let both = |i: usize| seen.resting[i] && resting[i];
            seen.mode.self_motion_dof == self_motion_dof
                && signature_distance(&places, &seen.places, both) <= SAME_ASSEMBLY
        };
        if let Some(known) = self.modes.iter_mut().find(same) {
            known.mode.found += 1;
            if distance < known.mode.distance {
                known.mode = Mode { assembly, distance, ..known.mode.clone() };
                known.places = places;
            }
        } else {
            let mode = Mode { assembly, found: 1, distance, self_motion_dof };
            self.modes.push(KnownMode { mode, places, resting });
        }
        Ok(())
    }

    /// Degrees of freedom left at an assembly, and the landmarks that they do not move.
    fn self_motions(&self, q: &[f64]) -> Result<(usize, Vec<bool>)> {
        let mechanism = self.mechanism;
        let isolated = (0, vec![true; self.landmarks.len()]);
        let (kernel, _) = self.motions(q)?;
        if kernel.cols() == 0 {
            return Ok(isolated);
        }
        let before = link_poses(&mechanism.state(q)?);
        // A motion that does not depend on the basis.
        let names = self.free.iter().map(|&i| &mechanism.coordinates()[i].name);
        let weights: Vec<f64> = names.map(|name| by_name(name, 0)).collect();
        let along = kernel.mul_vec(&kernel.transpose().mul_vec(&weights));
        let most = largest_change(mechanism, self.free, &along);
        for step in [TRIAL / most, -TRIAL / most] {
            let change: Vec<f64> = along.iter().map(|x| step * x).collect();
            let guess =
                within_limits(mechanism, moved(mechanism, q, self.free, &change), self.free);
            let near = assemble(mechanism, &guess, self.prescribed)?;
            let state = mechanism.state(&near.q)?;
            if near.closed
                && max_displacement(&link_poses(&state), &before, mechanism) > TRIAL_MOVED
            {
                let (kernel, tolerance) = self.motions(&near.q)?;
                let resting = self.landmarks.resting(&state, self.free, &kernel, tolerance);
                return Ok((kernel.cols(), resting));
            }
        }
        Ok(isolated) // infinitesimal: a double root, or between limits
    }

    /// The motions of free coordinates that keep the loops closed, one column each (orthonormal,
    /// scaled), and the tolerance below which their entries count as zero.
    fn motions(&self, q: &[f64]) -> Result<(Matrix, f64)> {
        let rates = columns(&LoopClosure::of(self.mechanism, q)?.jacobian, self.free);
        let space = rate_space(&rates, CLOSURE_RANK);
        Ok((space.complement(), kernel_tolerance(&space)))
    }
}

/// The same assembly with angles shifted by full turns towards the guess, where limits permit and
/// no other joint depends on the value.
fn wrapped_near(
    mechanism: &Mechanism,
    guess: &[f64],
    free: &[usize],
    mut assembly: Assembly,
) -> Assembly {
    for &i in free {
        let coordinate = &mechanism.coordinates()[i];
        let joint = &mechanism.joints()[coordinate.joint];
        let read = mechanism
            .joints()
            .iter()
            .any(|j| j.mimic.as_ref().is_some_and(|mimic| mimic.joint == joint.name));
        let advances = matches!(joint.kind, JointKind::Helical { .. });
        if coordinate.kind != CoordinateKind::Angle || read || advances {
            continue;
        }
        let turns = ((assembly.q[i] - guess[i]) / TAU).round();
        let near = assembly.q[i] - turns * TAU;
        if turns != 0.0 && near >= coordinate.limits.lower && near <= coordinate.limits.upper {
            assembly.q[i] = near;
        }
    }
    assembly.at_limit = at_limit(mechanism, &assembly.q);
    assembly
}
