//! Singular poses of closed chains: which counts differ from their generic values, what motion is
//! lost or gained, and how far the next loss is.
//!
//! Formula  type I    zero-torque wrenches s or redundancy r' above generic: the object loses
//!          type II   indeterminacy i' above generic: the object gains, the actuators do not hold it
//!          type III  both
//!          configuration space  rank of [J_a J_p -G^T] below generic, k above
//!          passive   idle motions above generic
//! Units    distances have none: the smallest s and c among the finite pairs of the relation
//!          (sines of angles in units scaled by the characteristic length, at the object's
//!          reference point), the smallest value of the kernel without passive joints, and the
//!          smallest singular value kept of the scaled constraint over the largest. The last
//!          depends on where contacts are drawn; that each is zero does not depend on anything.
//! Valid    relative to generic counts, which [`MobilityCounts::generic`] takes from several poses
//!          (`GenericMobility` finds them for a mechanism, `Diagnosis` names what is lost and gained): a
//!          mechanism may hold wrenches by its structure, or spin idly, in every pose
//! Source   Gosselin & Angeles 1990 (I, II, III); Park & Kim 1999 and Zlatanov et al. 1995
//!          (configuration space, passive)
//! Checked  tests/it/closure/singularity.rs

use crate::closure::mobility::counts::{ACTUATED_AND_OBJECT, MobilityCounts};
use crate::closure::mobility::motion_space::MotionSpace;
use crate::closure::mobility::relation::Relation;
use crate::closure::singularity_kind::SingularityKind;
use crate::linalg::Matrix;

/// How far a pose is from losing what it has: 0 at a singularity, at most 1 elsewhere [-].
/// Infinite where there is nothing to lose.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SingularityDistances {
    /// To the loss of a motion of the object.
    pub type_i: f64,
    /// To a motion of the object that the actuated joints do not hold.
    pub type_ii: f64,
    /// To the loss of rank of the constraint.
    pub configuration_space: f64,
    /// To a motion of passive joints alone.
    pub passive: f64,
}

/// What is singular about a pose.
#[derive(Debug, Clone, PartialEq)]
pub struct Singularities {
    /// The kinds, in the order of [`SingularityKind`]; empty for a regular pose.
    pub kinds: Vec<SingularityKind>,
    /// Wrenches held without torque, a column each: those beyond the generic number block the
    /// lost motions.
    pub blocked: Matrix,
    /// Motions of the object with the actuated joints at rest: those beyond the generic number are
    /// gained.
    pub gained: Matrix,
    /// How far the pose is from each kind.
    pub distances: SingularityDistances,
}

/// What a pose has that is not generic.
struct Beyond {
    loses: bool,
    gains: bool,
    folds: bool,
    idles: bool,
}

impl Beyond {
    fn of(now: &MobilityCounts, generic: &MobilityCounts) -> Self {
        Self {
            loses: now.zero_torque > generic.zero_torque || now.redundancy > generic.redundancy,
            gains: now.indeterminacy > generic.indeterminacy,
            folds: now.rank < generic.rank,
            idles: now.idle > generic.idle,
        }
    }

    fn kinds(&self) -> Vec<SingularityKind> {
        let first = match (self.loses, self.gains) {
            (true, true) => Some(SingularityKind::TypeIII),
            (true, false) => Some(SingularityKind::TypeI),
            (false, true) => Some(SingularityKind::TypeII),
            (false, false) => None,
        };
        let folds = self.folds.then_some(SingularityKind::ConfigurationSpace);
        let idles = self.idles.then_some(SingularityKind::Passive);
        first.into_iter().chain(folds).chain(idles).collect()
    }
}

impl SingularityDistances {
    /// Those of a pose with these counts: 0 to each kind that it is.
    pub(crate) fn against(self, now: &MobilityCounts, generic: &MobilityCounts) -> Self {
        let Beyond { loses, gains, folds, idles } = Beyond::of(now, generic);
        let or_zero = |singular: bool, x: f64| if singular { 0.0 } else { x };
        Self {
            type_i: or_zero(loses, self.type_i),
            type_ii: or_zero(gains, self.type_ii),
            configuration_space: or_zero(folds, self.configuration_space),
            passive: or_zero(idles, self.passive),
        }
    }
}

impl Singularities {
    /// Of a pose, against the generic counts of its mechanism.
    #[must_use]
    pub fn of(motions: &MotionSpace, relation: &Relation, generic: &MobilityCounts) -> Self {
        Self::with_counts(&MobilityCounts::of(motions, relation), motions, relation, generic)
    }

    /// The same for a pose whose own counts are known.
    pub(crate) fn with_counts(
        now: &MobilityCounts,
        motions: &MotionSpace,
        relation: &Relation,
        generic: &MobilityCounts,
    ) -> Self {
        let pairs = relation.finite_pairs();
        let none = f64::INFINITY;
        let here = SingularityDistances {
            type_i: pairs.last().map_or(none, |p| p.0),
            type_ii: pairs.first().map_or(none, |p| p.1),
            configuration_space: if now.rank > 0 { motions.regularity() } else { none },
            passive: motions.still(ACTUATED_AND_OBJECT).1.kept,
        };
        Self {
            kinds: Beyond::of(now, generic).kinds(),
            blocked: relation.forces().infinite,
            gained: relation.motions().infinite,
            distances: here.against(now, generic),
        }
    }

    /// True for a pose that is regular in all respects.
    #[must_use]
    pub fn is_regular(&self) -> bool {
        self.kinds.is_empty()
    }
}
