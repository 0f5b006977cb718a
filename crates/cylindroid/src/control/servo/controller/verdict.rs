//! The reason of a stall.
//!
//! Formula  `stall.rs`; a motion of which a smaller share is possible than that from which it counts as
//!          followed (`following.rs`) is lost
//! Why so   a tool that is left behind for directions that a mechanism lacks still makes a few per cent of
//!          the motion in the others: no limit and no damping slows it
//! Checked  tests/it/servo/stall.rs, tests/it/servo/closed_edges.rs

use super::super::following::FOLLOWED;
use super::super::stall::{POSSIBLE, Stall, StallInputs, classify};
use super::Servo;
use crate::control::solver::bounds::LimitKind;

impl Servo {
    /// The reason why the last step made no progress towards the target.
    #[must_use]
    pub fn stall(&self) -> Stall {
        let motion = self.coupled.as_ref().and_then(|c| c.uncontrolled());
        if let Some(motion) = motion.filter(|_| self.approaches_type_ii) {
            let (share, direction) = (motion.share, motion.direction.clone());
            return Stall::TypeII { share, direction };
        }
        let mut inputs = StallInputs {
            possible: POSSIBLE,
            svd: &self.svd,
            gains: &self.gains,
            error: &self.error,
            projected_error: &self.projected_error,
            no_inverse: self.step_projection.reason().filter(|_| self.step_projection.is_stopped()),
            at_limit: &self.at_limit,
            distance: self.distance,
            length: self.length + self.offset_of_free_position(),
            generic_rank: self.generic_rank,
        };
        let stall = self.twist_stall(self.slowed_by_limits(classify(&inputs)));
        let moves = self.twist_follower.is_stalled || self.follower.is_moving();
        if stall != Stall::Slow || !moves {
            return stall;
        }
        inputs.possible = FOLLOWED;
        classify(&inputs)
    }

    /// A motion that only creeps on while joints stand at position limits is blocked by them.
    fn slowed_by_limits(&self, stall: Stall) -> Stall {
        let position = |(_, kind): &(usize, LimitKind)| *kind == LimitKind::Position;
        let coordinates: Vec<usize> =
            self.active_limits().filter(position).map(|(c, _)| c).collect();
        match stall {
            Stall::Slow if !coordinates.is_empty() => Stall::Limits { coordinates },
            other => other,
        }
    }
}
