//! Whether a target that the search of the nearest pose does not reach is in reach of another
//! configuration: then the joints need not stop at this one.
//!
//! Formula  the search of `nearest_pose.rs` from starts that are drawn within the limits, some of its steps
//!          in each step of the servo; a configuration that reaches the target is kept while it does
//! Valid    a target counts as out of reach once `STARTS` starts have not reached it; before that, until one
//!          does, where the joints are too fast to stop at the nearest pose, and where the target was in
//!          reach and moved away
//! Why so   a local minimum of the error is no edge of the workspace: towards a target in reach the
//!          straight path and escapes lead past many that the search ends in
//! Checked  tests/it/servo/just_beyond.rs, tests/it/servo/edge.rs, tests/it/servo/reconfiguration.rs

use super::nearest_pose::{NearestPose, Surroundings};
use crate::scalar::uniform;
use crate::spatial::Pose;

/// Starts without success after which a target is out of reach [-].
const STARTS: u32 = 10;
/// Steps of the servo for a start [-].
const STEPS_OF_A_START: u32 = 8;
/// Joints of the longest chain that is searched [-]: a step takes a time that grows with their cube.
const MOST_JOINTS: usize = 64;

/// The search from other configurations.
#[derive(Debug, Clone)]
pub(super) struct Elsewhere {
    search: NearestPose,
    random: u64,
    /// Steps of the servo for the present start.
    steps: u32,
    /// Starts without success since the last one with.
    failures: u32,
    /// True where the last target was in reach.
    was_in_reach: bool,
    /// True once the motion ends at the nearest pose before the starts have failed, until one reaches the
    /// target.
    ends_here: bool,
}

impl Elsewhere {
    /// `None` for long chains, whose targets are out of reach only where their length proves it.
    pub(super) fn new(search: &NearestPose) -> Option<Self> {
        (search.joints() <= MOST_JOINTS).then(|| Self {
            search: search.clone(),
            random: 0,
            steps: 0,
            failures: 0,
            was_in_reach: false,
            ends_here: false,
        })
    }

    /// Forgets the last results.
    pub(super) const fn reset(&mut self) {
        (self.random, self.steps, self.failures) = (0, 0, 0);
        (self.was_in_reach, self.ends_here) = (false, false);
    }

    /// The target is in reach.
    pub(super) const fn note_in_reach(&mut self) {
        (self.steps, self.failures) = (0, 0);
        (self.was_in_reach, self.ends_here) = (true, false);
    }

    /// The target is not in reach of this configuration; `is_overrun` where the joints are too fast to stop at
    /// the nearest pose.
    pub(super) const fn note_out_of_reach(&mut self, is_overrun: bool) {
        self.ends_here |= is_overrun || self.was_in_reach;
        self.was_in_reach = false;
    }

    /// Tries the next start, or goes on with the last one; errors up to `met` are those of poses in reach.
    pub(super) fn move_on(&mut self, target: Pose, met: f64, around: &mut Surroundings<'_>) {
        if self.steps == 0 {
            let random = &mut self.random;
            let draw = |[lower, upper]: [f64; 2]| lower + (upper - lower) * uniform(random);
            self.search.start(around.limits, draw);
        }
        self.steps += 1;
        self.search.move_on(target, met, around);
        if self.search.left() <= met {
            (self.steps, self.failures, self.ends_here) = (1, 0, false);
        } else if self.search.has_arrived() || self.steps >= STEPS_OF_A_START {
            (self.steps, self.failures) = (0, self.failures.saturating_add(1));
        }
    }

    /// True once no start reached the target, or the motion ends here in any case.
    pub(super) const fn is_the_end(&self) -> bool {
        self.failures >= STARTS || self.ends_here
    }
}
