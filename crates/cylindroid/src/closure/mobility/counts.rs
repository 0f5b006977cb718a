//! Mobility counts: those of motions and wrenches that distinguish singular configurations.
//!
//! Checked  tests/it/closure/singularity.rs

use super::compression::Compression;
use super::motion_space::{MotionSpace, RowSelection};
use super::relation::{Relation, RelationDimensions};
use crate::closure::constraint::velocity_constraint::Constraint;
use crate::error::Result;
use crate::linalg::Matrix;

/// The rows of actuated joints and object: a motion that vanishes on them is idle.
pub(crate) const ACTUATED_AND_OBJECT: RowSelection =
    RowSelection { actuated: true, passive: false, object: true };

/// The counts that change at singularities.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct MobilityCounts {
    /// Rank of the constraint matrix.
    pub rank: usize,
    /// Motions of passive joints alone.
    pub idle: usize,
    /// Redundancy r' of the relation.
    pub redundancy: usize,
    /// Indeterminacy i' of the relation.
    pub indeterminacy: usize,
    /// Zero-torque wrenches s.
    pub zero_torque: usize,
}

impl MobilityCounts {
    /// At one configuration.
    ///
    /// ```
    /// use cylindroid::closure::{ClosedChain, MobilityCounts, MotionSpace};
    ///
    /// let five_bar = cylindroid::load("five-bar")?;
    /// let chain = ClosedChain::of(&five_bar.state(five_bar.home())?, None, None)?;
    /// let motions = MotionSpace::of(&chain.constraint);
    /// let counts = MobilityCounts::of(&motions, &motions.relation());
    /// assert_eq!((counts.idle, counts.redundancy, counts.indeterminacy), (0, 0, 0));
    /// // The counts of regular configurations are generic.
    /// assert_eq!(counts.generic(counts), counts);
    /// # Ok::<(), cylindroid::Error>(())
    /// ```
    #[must_use]
    pub fn of(motions: &MotionSpace, relation: &Relation) -> Self {
        let RelationDimensions { redundancy, indeterminacy, zero_torque, .. } =
            relation.dimensions();
        Self {
            rank: motions.cut().rank.rank,
            idle: motions.vanishing_on(ACTUATED_AND_OBJECT).cols(),
            redundancy,
            indeterminacy,
            zero_torque,
        }
    }

    /// The generic counts of two configurations: the larger rank and the smaller of every other
    /// count. Folded over random configurations, it yields the generic counts of the mechanism.
    ///
    /// ```
    /// use cylindroid::closure::MobilityCounts;
    ///
    /// // A singular configuration has lost a rank; the regular one is generic.
    /// let regular =
    ///     MobilityCounts { rank: 4, idle: 0, redundancy: 0, indeterminacy: 0, zero_torque: 0 };
    /// let singular = MobilityCounts { rank: 3, indeterminacy: 1, zero_torque: 1, ..regular };
    /// assert_eq!(singular.generic(regular), regular);
    /// ```
    #[must_use]
    pub fn generic(self, other: Self) -> Self {
        Self {
            rank: self.rank.max(other.rank),
            idle: self.idle.min(other.idle),
            redundancy: self.redundancy.min(other.redundancy),
            indeterminacy: self.indeterminacy.min(other.indeterminacy),
            zero_torque: self.zero_torque.min(other.zero_torque),
        }
    }

    /// The counts of a constraint from those of its compression.
    pub(crate) fn with_split_off(self, [actuated, passive]: [usize; 2]) -> Self {
        Self { redundancy: self.redundancy + actuated, idle: self.idle + passive, ..self }
    }

    /// At one configuration, whatever the number of joints, with singular values of the constraint
    /// at or below `threshold` times the largest counted as zero.
    pub(crate) fn of_constraint(constraint: &Constraint, threshold: f64) -> Self {
        let compression = Compression::of(constraint);
        let motions = MotionSpace::with_threshold(compression.constraint(constraint), threshold);
        Self::of(&motions, &motions.relation()).with_split_off(compression.split_off())
    }

    /// The same of the task `T u`.
    pub(crate) fn of_task(constraint: &Constraint, threshold: f64, task: &Matrix) -> Result<Self> {
        let compression = Compression::of(constraint);
        let motions = MotionSpace::with_threshold(compression.constraint(constraint), threshold);
        let relation = motions.relation().task(task)?;
        Ok(Self::of(&motions, &relation).with_split_off(compression.split_off()))
    }

    /// h: dimension by which the possible velocities of the actuated joints fall short of all.
    pub(crate) fn impossible_inputs(&self, [actuated, columns]: [usize; 2]) -> usize {
        let free = columns.saturating_sub(self.rank).saturating_sub(self.idle);
        actuated.saturating_sub(free.saturating_sub(self.indeterminacy))
    }

    /// True if the actuated joints depend on each other: they set fewer motions than their number
    /// and that of the motions permit. At regular configurations, a fault of the architecture.
    pub(crate) fn lack_actuation(&self, sizes: [usize; 2]) -> bool {
        self.indeterminacy > 0 && self.impossible_inputs(sizes) > 0
    }
}
