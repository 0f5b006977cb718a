//! Zlatanov's six types of singularity, from counts.
//!
//! Formula  motions (q_a, q_p, u) of active joints, passive joints and output, against a regular
//!          configuration of the branch:
//!          RI   redundant input               (q_a != 0, u = 0)         r' above generic
//!          RO   redundant output              (q_a = 0, u != 0)         i' above generic
//!          II   impossible input              not every q_a is possible  h above generic
//!          IO   impossible output             u loses a dimension       s above generic
//!          RPM  redundant passive motion      (q_a = 0, u = 0)          idle above generic
//!          IIM  increased instantaneous mobility  dof above generic
//!          with k = columns - rank, p = k - idle and h = q_a - (p - i')
//! Valid    defined for mechanisms with as many inputs and outputs as degrees of freedom. There
//!          r' - s = i' - h and k - n = r' - s + idle leave 21 of the 64 combinations, each of at
//!          least two types. For others each type means: more than generic. An architecture
//!          singularity counts as RO and II in every configuration. Without a branch (structures)
//!          there is no generic count, and only IIM is decided
//! Why so   types I, II and III are defined by two Jacobians, which do not exist where passive
//!          motions depend on more than actuated joints and output
//! Source   Zlatanov, Fenton & Benhabib 1994 and 1995
//! Checked  tests/it/closure/zlatanov.rs

use std::fmt;

use super::generic_mobility::GenericMobility;
use crate::closure::mobility::counts::MobilityCounts;

/// A type of singularity in the classification of Zlatanov, Fenton & Benhabib.
///
/// Several occur together: of the 64 combinations, 21 are possible for mechanisms with as many
/// inputs and outputs as degrees of freedom.
///
/// Source: Zlatanov, Fenton & Benhabib 1994, 1995.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum ZlatanovType {
    /// RI: the actuated joints move with the reference link at rest.
    RedundantInput,
    /// RO: the reference link moves with the actuated joints at rest.
    RedundantOutput,
    /// II: the actuated joints cannot move with arbitrary velocities.
    ImpossibleInput,
    /// IO: the reference link cannot move with some velocities that are possible generically.
    ImpossibleOutput,
    /// RPM: passive joints move with actuated joints and reference link at rest.
    RedundantPassiveMotion,
    /// IIM: the instantaneous mobility exceeds that of regular configurations.
    IncreasedInstantaneousMobility,
}

impl ZlatanovType {
    /// All types.
    pub const ALL: [Self; 6] = [
        Self::RedundantInput,
        Self::RedundantOutput,
        Self::ImpossibleInput,
        Self::ImpossibleOutput,
        Self::RedundantPassiveMotion,
        Self::IncreasedInstantaneousMobility,
    ];

    /// Its abbreviation in the literature.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::RedundantInput => "RI",
            Self::RedundantOutput => "RO",
            Self::ImpossibleInput => "II",
            Self::ImpossibleOutput => "IO",
            Self::RedundantPassiveMotion => "RPM",
            Self::IncreasedInstantaneousMobility => "IIM",
        }
    }

    /// Those of a configuration with the counts `now`, against those of its branches, which may
    /// all lack actuation; `sizes`: number of actuated joints, and of all columns of the constraint.
    pub(crate) fn of(
        now: &MobilityCounts,
        GenericMobility { counts: generic, branches, .. }: &GenericMobility,
        unactuated: bool,
        sizes: [usize; 2],
    ) -> Vec<Self> {
        let lost = |counts: &MobilityCounts| counts.impossible_inputs(sizes);
        let least = branches.iter().map(lost).min().unwrap_or_else(|| lost(generic));
        let has = |of: &Self| match of {
            Self::RedundantInput => now.redundancy > generic.redundancy,
            Self::RedundantOutput => now.indeterminacy > generic.indeterminacy || unactuated,
            Self::ImpossibleInput => lost(now) > least || unactuated,
            Self::ImpossibleOutput => now.zero_torque > generic.zero_torque,
            Self::RedundantPassiveMotion => now.idle > generic.idle,
            Self::IncreasedInstantaneousMobility => now.rank < generic.rank,
        };
        Self::ALL.into_iter().filter(has).collect()
    }
}

impl fmt::Display for ZlatanovType {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::RedundantInput => "RI (redundant input)",
            Self::RedundantOutput => "RO (redundant output)",
            Self::ImpossibleInput => "II (impossible input)",
            Self::ImpossibleOutput => "IO (impossible output)",
            Self::RedundantPassiveMotion => "RPM (redundant passive motion)",
            Self::IncreasedInstantaneousMobility => "IIM (increased instantaneous mobility)",
        })
    }
}
