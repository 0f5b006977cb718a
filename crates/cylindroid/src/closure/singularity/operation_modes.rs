//! Operation modes: the components of the set of closed configurations, each with its dimension
//! and its generic counts, and the configurations in which they meet.
//!
//! Method   the branches through the given configuration, followed a finite way
//!          (`finite_mobility.rs`), and assemblies from random restarts, each with the finite
//!          mobility there. Two configurations belong to one mode if dimension, counts and the
//!          class of the motions of the reference frame agree; isolated assemblies, if they
//!          coincide (`configuration_signature.rs`). Walks along the modes find where they meet
//!          others (`crossings.rs`), and modes that no restart found
//! Units    none: lengths are divided by the characteristic length
//! Valid    certain: every configuration that is listed has its loops closed and the counts of its
//!          mode, and modes that differ in dimension or counts share no component, since these are
//!          constant on an analytic branch but for a subset of lower dimension. Not certain: modes
//!          may be missed, and one mode may comprise several components, since agreement of the
//!          data does not connect them (the assembly modes of a linkage are one operation mode).
//!          Meetings may be missed: walks along each mode (`crossings.rs`) find those that lie across
//!          their way. An
//!          assembly from a restart whose rank is not clear, or that has several first-order
//!          motions but no branch, is counted as undecided: where the loops are singular, an
//!          assembly is not accurate enough
//! Why so   a decomposition of the ideal of the loop equations would decide connection over the
//!          complex numbers, and takes hours for a 3-UPU; its real components still have to be
//!          sampled
//! Source   Fanghella, Galletti & Giannotti 2006 (kinematotropic linkages); Walter & Husty 2008
//!          (the operation modes of a 3-UPU)
//! Checked  tests/it/linkages/modes.rs

use std::cmp::Reverse;

use super::crossings::crossings;
use super::generic_mobility::GenericMobility;
use crate::closure::constraint::closed_chain::ClosedChain;
use crate::closure::mobility::counts::MobilityCounts;
use crate::closure::mobility::finite_mobility::{FiniteMobility, MobilityEvidence};
use crate::closure::mobility::motion_space::MotionSpace;
use crate::closure::position::assembly::assemble;
use crate::closure::position::assembly_modes::{ModeOptions, check_starts};
use crate::closure::position::configuration_signature::{
    Landmarks, link_poses, signature_distance,
};
use crate::closure::position::initial_guesses::random;
use crate::closure::position::loop_closure::LoopClosure;
use crate::error::Result;
use crate::kinematics::State;
use crate::model::{FrameId, Mechanism};
use crate::screws::{Class, ScrewOptions, ScrewSystem};
use crate::spatial::Vec3;
use crate::tolerance::{CLEAR_SAMPLE, SAME_ASSEMBLY, SAME_SHAKY};

/// Maximum number of modes to walk along, and of meetings to search.
const MAX_WALKED: usize = 16;
const MAX_MEETINGS: usize = 32;

/// An operation mode.
#[derive(Debug, Clone, PartialEq)]
pub struct OperationMode {
    /// Its finite degrees of freedom: 0 for an isolated assembly.
    pub dimension: usize,
    /// First-order degrees of freedom at its configurations; more than the dimension if all of them
    /// are singular.
    pub dof: usize,
    /// Its generic counts.
    pub counts: MobilityCounts,
    /// Dimension of the motions of the reference frame at `configuration`.
    pub order: usize,
    /// The Gibson-Hunt class of these motions.
    pub class: Class,
    /// A configuration of it.
    pub configuration: Vec<f64>,
    /// Number of starts that led to it; 0 if only a meeting did.
    pub found: usize,
    /// The branches through the given configuration that belong to it: indices into
    /// [`FiniteMobility::branches`].
    pub branches: Vec<usize>,
    /// True if the given configuration lies on it.
    pub through: bool,
}

/// A configuration in which branches meet.
#[derive(Debug, Clone, PartialEq)]
pub struct ModeMeeting {
    /// The configuration.
    pub configuration: Vec<f64>,
    /// The modes of the branches that meet: an index into [`OperationModes::modes`] for each
    /// branch.
    pub modes: Vec<usize>,
    /// First-order degrees of freedom there, more than the dimension of any of the modes.
    pub dof: usize,
    /// The counts there: what exceeds those of a mode is gained.
    pub counts: MobilityCounts,
    /// Other configurations that were found in which branches of the same modes meet, with the same
    /// counts: further points of a set of meetings, or isolated ones.
    pub others: Vec<Vec<f64>>,
}

/// The result of a search for operation modes.
#[derive(Debug, Clone, PartialEq)]
pub struct OperationModes {
    /// The modes found, those of largest dimension first. There may be others.
    pub modes: Vec<OperationMode>,
    /// The configurations found in which branches meet, the given one first if it is one: at
    /// restarts, and on walks along each mode.
    pub meetings: Vec<ModeMeeting>,
    /// Number of starts.
    pub starts: usize,
    /// Number of starts from which the loops closed.
    pub closed: usize,
    /// Number of these whose mode could not be decided.
    pub undecided: usize,
}

impl OperationModes {
    /// Good-Turing estimate of the probability that another closing start finds a new mode: the
    /// fraction of closing starts whose mode was found only once. 1 if no start closed.
    #[must_use]
    pub fn unseen_probability(&self) -> f64 {
        if self.closed == 0 {
            return 1.0;
        }
        self.modes.iter().filter(|m| m.found == 1).count() as f64 / self.closed as f64
    }
}

/// Searches for the operation modes of `mechanism`: on the branches through the configuration `q`
/// and from random restarts. The motions are those of its reference frame or of another; `q` is
/// assembled first if its loops are open.
///
/// Two configurations belong to one mode if dimension, generic counts and Gibson-Hunt class agree:
/// modes with different dimension or counts are different components for certain, but a mode may
/// comprise several components, and modes may be missed.
///
/// ```
/// use cylindroid::closure::{ModeOptions, operation_modes};
///
/// let five_bar = cylindroid::load("five-bar")?;
/// let options = ModeOptions { starts: 8, ..ModeOptions::default() };
/// let found = operation_modes(&five_bar, five_bar.home(), None, options)?;
/// assert_eq!(found.modes.len(), 1);
/// assert_eq!(found.modes[0].dimension, 2);
/// # Ok::<(), cylindroid::Error>(())
/// ```
///
/// # Errors
/// A configuration of the wrong size or with non-finite values; zero starts; a frame of another
/// mechanism.
#[doc(alias = "kinematotropic")]
#[doc(alias = "configuration space components")]
pub fn operation_modes(
    mechanism: &Mechanism,
    q: &[f64],
    reference: Option<FrameId>,
    options: ModeOptions,
) -> Result<OperationModes> {
    check_starts(options)?;
    reference.map_or(Ok(()), |frame| mechanism.check_frame(frame))?;
    let all: Vec<usize> = (0..mechanism.n()).collect();
    let landmarks = Landmarks::of(mechanism);
    let places = landmarks.at(&link_poses(&mechanism.state(q)?));
    let length = mechanism.reach();
    let mut search = Search {
        mechanism,
        reference,
        length,
        landmarks,
        given: places,
        modes: Vec::new(),
        meetings: Vec::new(),
        meeting_places: Vec::new(),
        undecided: 0,
    };
    let mut closed = 0;
    for start in 0..options.starts {
        let given = start == 0;
        if given && LoopClosure::of(mechanism, q)?.is_closed(length) {
            closed += 1;
            search.add(q, Origin::Given)?;
            continue;
        }
        let guess = if given {
            q.to_vec()
        } else {
            random(mechanism, q, &all, [options.seed, start as u64])
        };
        let found = assemble(mechanism, &guess, &[])?;
        if found.closed {
            closed += 1;
            let at_limit = !found.at_limit.is_empty();
            let origin = if given { Origin::Given } else { Origin::Restart { at_limit } };
            search.add(&found.q, origin)?;
        }
    }
    search.walk()?;
    let undecided = search.undecided;
    let (modes, meetings) = search.sorted();
    Ok(OperationModes { modes, meetings, starts: options.starts, closed, undecided })
}

/// A mode, and the signature of an isolated assembly with its distance from the given one.
struct Known {
    mode: OperationMode,
    places: Vec<Vec3>,
    distance: f64,
}

struct Search<'a> {
    mechanism: &'a Mechanism,
    reference: Option<FrameId>,
    length: f64,
    landmarks: Landmarks,
    given: Vec<Vec3>,
    modes: Vec<Known>,
    meetings: Vec<ModeMeeting>,
    /// The signatures of the meetings.
    meeting_places: Vec<Vec<Vec3>>,
    undecided: usize,
}

/// Where a configuration comes from.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Origin {
    /// The given one, or the assembly next to it.
    Given,
    /// A random restart; at a limit counts may not be generic.
    Restart { at_limit: bool },
    /// A walk along a mode.
    Walk,
}

/// A configuration with its counts.
struct Sample {
    state: State,
    chain: ClosedChain,
    motions: MotionSpace,
    counts: MobilityCounts,
}

impl Search<'_> {
    fn sample(&self, q: &[f64]) -> Result<Sample> {
        let state = self.mechanism.state(q)?;
        let chain = ClosedChain::of(&state, self.reference, Some(self.length))?;
        let motions = MotionSpace::of(&chain.constraint);
        let counts = MobilityCounts::of(&motions, &motions.relation());
        Ok(Sample { state, chain, motions, counts })
    }

    /// Walks along every mode, also along those that walks find.
    fn walk(&mut self) -> Result<()> {
        let (mut next, mut walked) = (0, 0);
        while next < self.modes.len() && walked < MAX_WALKED {
            let mode = &self.modes[next].mode;
            next += 1;
            if mode.dimension == 0 || mode.dof > mode.dimension {
                continue;
            }
            walked += 1;
            for q in crossings(self.mechanism, &mode.configuration.clone(), self.length)? {
                let places = self.landmarks.at(&link_poses(&self.mechanism.state(&q)?));
                let same =
                    |known: &Vec<Vec3>| signature_distance(&places, known, |_| true) <= SAME_SHAKY;
                if self.meeting_places.len() < MAX_MEETINGS && !self.meeting_places.iter().any(same)
                {
                    self.add(&q, Origin::Walk)?;
                }
            }
        }
        Ok(())
    }

    /// The modes through the closed configuration `q`.
    fn add(&mut self, q: &[f64], origin: Origin) -> Result<()> {
        let given = origin == Origin::Given;
        let restart = matches!(origin, Origin::Restart { .. });
        let here = self.sample(q)?;
        let finite = FiniteMobility::of(&here.state, Some(self.length))?;
        let clear = here.counts.rank == 0 || here.motions.regularity() > CLEAR_SAMPLE;
        let clear = clear && here.motions.dof() == finite.infinitesimal;
        let searched = finite.branches.is_empty() && finite.evidence == MobilityEvidence::Search;
        if origin == Origin::Walk && finite.branches.len() < 2 {
            return Ok(()); // nothing is known to meet there
        }
        if finite.finite.is_none() || restart && (!clear || searched) {
            self.undecided += 1;
            return Ok(());
        }
        if finite.branches.is_empty() {
            self.add_isolated(here, given)?;
            return Ok(());
        }
        if finite.is_ordinary() && origin == (Origin::Restart { at_limit: false }) {
            self.add_branch(here, (finite.infinitesimal, None), origin)?;
            return Ok(());
        }
        let generic = GenericMobility::around(
            &here.state,
            self.reference,
            self.length,
            here.counts,
            &finite,
        )?;
        let mut samples = Vec::new();
        for (i, branch) in finite.branches.iter().enumerate() {
            let far = branch.far(&here.state, self.length)?;
            let Some(far) = far.first() else {
                self.undecided += usize::from(origin != Origin::Walk);
                return Ok(());
            };
            let mut there = self.sample(far)?;
            there.counts = generic.branches[i];
            samples.push((there, (branch.dimension, Some(i))));
        }
        let contradicts = |(there, (dimension, _)): &(Sample, (usize, Option<usize>))| {
            there.motions.dof() < *dimension
        };
        if origin == Origin::Walk && samples.iter().any(contradicts) {
            return Ok(()); // not accurate enough to tell the branches apart
        }
        let mut modes = Vec::new();
        for (there, branch) in samples {
            modes.push(self.add_branch(there, branch, origin)?);
        }
        // One start each.
        for (i, mode) in modes.iter().enumerate() {
            if modes[..i].contains(mode) && origin != Origin::Walk {
                self.modes[*mode].mode.found -= 1;
            }
        }
        let (configuration, dof, counts) = (q.to_vec(), here.motions.dof(), here.counts);
        if modes.len() > 1 {
            self.meeting_places.push(self.landmarks.at(&link_poses(&here.state)));
            let others = Vec::new();
            self.meet(ModeMeeting { configuration, modes, dof, counts, others });
        }
        Ok(())
    }

    fn meet(&mut self, meeting: ModeMeeting) {
        let sorted = |m: &ModeMeeting| {
            let mut modes = m.modes.clone();
            modes.sort_unstable();
            modes
        };
        let modes = sorted(&meeting);
        let same = |m: &&mut ModeMeeting| m.counts == meeting.counts && sorted(m) == modes;
        match self.meetings.iter_mut().find(same) {
            Some(known) => known.others.push(meeting.configuration),
            None => self.meetings.push(meeting),
        }
    }

    fn mode(&self, at: &Sample, dimension: usize) -> Result<OperationMode> {
        let twists = at.chain.reference_twists(&at.state);
        let system = ScrewSystem::of(&twists, &ScrewOptions::with_length(self.length))?;
        Ok(OperationMode {
            dimension,
            dof: at.motions.dof(),
            counts: at.counts,
            order: system.order(),
            class: system.class(),
            configuration: at.state.q().to_vec(),
            found: 1,
            branches: Vec::new(),
            through: false,
        })
    }

    fn add_branch(
        &mut self,
        at: Sample,
        (dimension, branch): (usize, Option<usize>),
        origin: Origin,
    ) -> Result<usize> {
        let found = usize::from(origin != Origin::Walk);
        let mode = OperationMode { found, ..self.mode(&at, dimension)? };
        let same = |known: &Known| {
            let m = &known.mode;
            m.dimension == dimension
                && m.counts == mode.counts
                && (m.order, m.class) == (mode.order, mode.class)
        };
        let place = match self.modes.iter().position(same) {
            Some(place) => {
                self.modes[place].mode.found += found;
                place
            }
            None => {
                self.modes.push(Known { mode, places: Vec::new(), distance: 0.0 });
                self.modes.len() - 1
            }
        };
        if origin == Origin::Given {
            let mode = &mut self.modes[place].mode;
            mode.through = true;
            mode.branches.extend(branch);
        }
        Ok(place)
    }

    fn add_isolated(&mut self, at: Sample, given: bool) -> Result<()> {
        let mode = OperationMode { through: given, ..self.mode(&at, 0)? };
        let places = self.landmarks.at(&link_poses(&at.state));
        let distance = signature_distance(&places, &self.given, |_| true);
        let same = |known: &&mut Known| {
            let shaky = mode.dof > 0 || known.mode.dof > 0;
            let tolerance = if shaky { SAME_SHAKY } else { SAME_ASSEMBLY };
            known.mode.dimension == 0
                && signature_distance(&places, &known.places, |_| true) <= tolerance
        };
        match self.modes.iter_mut().find(same) {
            Some(known) => known.mode.found += 1,
            None => self.modes.push(Known { mode, places, distance }),
        }
        Ok(())
    }

    /// Independent of the order in which the modes were found.
    fn sorted(self) -> (Vec<OperationMode>, Vec<ModeMeeting>) {
        let mut order: Vec<usize> = (0..self.modes.len()).collect();
        order.sort_by(|&a, &b| {
            let key = |i: usize| {
                let m = &self.modes[i].mode;
                let c = m.counts;
                let counts = [c.idle, c.redundancy, c.indeterminacy, c.zero_torque];
                (Reverse(m.dimension), Reverse(c.rank), counts, m.order, m.class.name())
            };
            let distance = |i: usize| self.modes[i].distance;
            key(a).cmp(&key(b)).then(distance(a).total_cmp(&distance(b)))
        });
        let mut meetings = self.meetings;
        for meeting in &mut meetings {
            for mode in &mut meeting.modes {
                *mode = order.iter().position(|m| m == mode).unwrap_or(*mode);
            }
        }
        let mut modes: Vec<Option<OperationMode>> =
            self.modes.into_iter().map(|known| Some(known.mode)).collect();
        (order.iter().filter_map(|&i| modes[i].take()).collect(), meetings)
    }
}
