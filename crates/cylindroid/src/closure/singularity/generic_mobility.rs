//! Generic mobility: the counts of the branch of closed configurations on which a configuration
//! lies, at its regular configurations.
//!
//! Method   the branches through the configuration (`finite_mobility.rs`) are followed a finite
//!          way; of the counts there the largest rank and the smallest of every other count. If the
//!          loop equations are independent, or there are none, rays in generic directions are
//!          followed (`rays.rs`)
//! Valid    on an analytic branch the counts are those of its regular configurations everywhere but
//!          on a subset of lower dimension, which a generic direction meets with probability zero.
//!          Other assembly modes and operation modes do not count: an isolated rigid assembly says
//!          nothing about a mechanism that moves. Without a branch (structures, open loops) the
//!          counts are those of the configuration itself: see [`GenericMobility::others`]
//! Why so   counts of a single regular configuration would require it to be known; the
//!          Gruebler-Kutzbach count is wrong for overconstrained mechanisms
//! Checked  tests/it/closure/diagnosis.rs, tests/it/linkages/published.rs

use crate::closure::constraint::closed_chain::ClosedChain;
use crate::closure::constraint::velocity_constraint::Constraint;
use crate::closure::mobility::counts::MobilityCounts;
use crate::closure::mobility::finite_mobility::FiniteMobility;
use crate::error::Result;
use crate::kinematics::State;
use crate::linalg::Matrix;
use crate::model::FrameId;
use crate::tolerance::CLOSURE_RANK;

/// Generic counts of the branches through a configuration.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct GenericMobility {
    /// The counts: of all branches the largest rank and the smallest of every other count.
    pub counts: MobilityCounts,
    /// The counts of each branch, in the order of [`FiniteMobility::branches`].
    pub branches: Vec<MobilityCounts>,
    /// Number of other configurations that were counted.
    pub others: usize,
}

impl GenericMobility {
    /// For the branch of `state`, its mechanism's reference frame or another, with the
    /// characteristic length of the mechanism or another (m).
    ///
    /// ```
    /// use cylindroid::closure::GenericMobility;
    ///
    /// let stewart = cylindroid::load("stewart")?;
    /// let generic = GenericMobility::of(&stewart.state(stewart.home())?, None, None)?;
    /// assert_eq!(generic.counts.indeterminacy, 0);
    /// # Ok::<(), cylindroid::Error>(())
    /// ```
    ///
    /// ```
    /// use cylindroid::closure::GenericMobility;
    ///
    /// // A straight elbow is singular; generically the arm has rank 6.
    /// let arm = cylindroid::load("ur5e")?;
    /// let state = arm.state(&[0.0, -0.6, 0.0, 0.4, 1.0, 0.0])?;
    /// let generic = GenericMobility::of(&state, None, None)?;
    /// assert!(generic.others > 0 && generic.counts.zero_torque == 0);
    /// # Ok::<(), cylindroid::Error>(())
    /// ```
    ///
    /// # Errors
    /// As [`ClosedChain::of`].
    pub fn of(state: &State, reference: Option<FrameId>, length: Option<f64>) -> Result<Self> {
        let chain = ClosedChain::of(state, reference, length)?;
        let length = chain.constraint.length();
        let counts = MobilityCounts::of_constraint(&chain.constraint, CLOSURE_RANK);
        let finite = FiniteMobility::of(state, Some(length))?;
        Self::around(state, reference, length, counts, &finite)
    }

    /// Of the task `T u` of the reference frame's twist, an independent map.
    ///
    /// # Errors
    /// As [`Relation::task`](crate::closure::Relation::task).
    pub(crate) fn of_task(
        state: &State,
        reference: Option<FrameId>,
        length: f64,
        task: &Matrix,
    ) -> Result<Self> {
        let chain = ClosedChain::of(state, reference, Some(length))?;
        let counts = MobilityCounts::of_task(&chain.constraint, CLOSURE_RANK, task)?;
        let finite = FiniteMobility::of(state, Some(length))?;
        let of = |constraint: &Constraint, rank| MobilityCounts::of_task(constraint, rank, task);
        Self::on_branches(state, (reference, length), counts, &finite, of)
    }

    /// The same for a configuration whose counts and finite mobility are known.
    pub(crate) fn around(
        state: &State,
        reference: Option<FrameId>,
        length: f64,
        counts: MobilityCounts,
        finite: &FiniteMobility,
    ) -> Result<Self> {
        let of =
            |constraint: &Constraint, rank| Ok(MobilityCounts::of_constraint(constraint, rank));
        Self::on_branches(state, (reference, length), counts, finite, of)
    }

    fn on_branches(
        state: &State,
        (reference, length): (Option<FrameId>, f64),
        counts: MobilityCounts,
        finite: &FiniteMobility,
        of: impl Fn(&Constraint, f64) -> Result<MobilityCounts>,
    ) -> Result<Self> {
        let mechanism = state.mechanism();
        let at = |q: &[f64], rank: f64| -> Result<MobilityCounts> {
            let chain = ClosedChain::of(&mechanism.state(q)?, reference, Some(length))?;
            of(&chain.constraint, rank)
        };
        let mut generic = Self { counts, branches: Vec::new(), others: 0 };
        for branch in &finite.branches {
            let mut own: Option<MobilityCounts> = None;
            for q in branch.far(state, length)? {
                let there = at(&q, branch.rank)?;
                own = Some(own.map_or(there, |own| own.generic(there)));
                generic.others += 1;
            }
            generic.branches.push(own.unwrap_or(counts));
        }
        // Without those of the configuration: where branches meet, it may have fewer wrenches
        // without torque than each of them.
        let all = generic.branches.iter().copied().reduce(MobilityCounts::generic);
        generic.counts = all.unwrap_or(counts);
        Ok(generic)
    }
}
