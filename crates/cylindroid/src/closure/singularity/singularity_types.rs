//! Type I, II and III singularities of closed chains: counts that differ from their generic values,
//! and distances to singularities.
//!
//! Formula  the pages of [`Singularities`] and [`SingularityDistances`]
//! Units    distances have none: the smallest s and c among the finite pairs of the relation (sines
//!          of angles in units scaled by the characteristic length, at the reference point of the
//!          object), the smallest singular value of the kernel without passive joints, and the
//!          smallest singular value kept of the scaled constraint over the largest. The last
//!          depends on the choice of contact frames; that each is zero does not depend on any
//!          choice
//! Valid    relative to generic counts, which [`MobilityCounts::generic`] takes from several
//!          configurations (`GenericMobility` finds them for a mechanism, `Diagnosis` names the
//!          motions lost and gained): a mechanism may have zero-torque wrenches or idle motions at
//!          every configuration
//! Source   Gosselin & Angeles 1990 (I, II, III); Park & Kim 1999 and Zlatanov et al. 1995
//!          (configuration space, passive)
//! Checked  tests/it/closure/singularity.rs

use crate::closure::mobility::counts::{ACTUATED_AND_OBJECT, MobilityCounts};
use crate::closure::mobility::motion_space::MotionSpace;
use crate::closure::mobility::relation::Relation;
use crate::closure::singularity_kind::SingularityKind;
use crate::linalg::Matrix;

/// Distances of a configuration to singularities: 0 at a singularity, at most 1 elsewhere [-].
/// Infinite if there is no motion or rank to lose.
///
/// ```text
/// type I   min s_j       type II  min c_j      s_j, c_j the finite pairs of the relation
/// passive  smallest singular value of the kernel without passive joints
/// configuration space  smallest singular value kept of [J_a J_p -G^T] over the largest
/// ```
///
/// Without unit: s_j and c_j are the sine and cosine of the angle between a direction and the joint
/// space ([`Relation::finite_pairs`]), with lengths divided by the characteristic length, at the
/// reference point of the object. Their zeros do not depend on point, length or contact frames;
/// other values do.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SingularityDistances {
    /// To type I, the loss of a motion of the object.
    pub type_i: f64,
    /// To type II, an uncontrolled motion of the object.
    pub type_ii: f64,
    /// To the loss of rank of the constraint.
    pub configuration_space: f64,
    /// To a motion of passive joints alone.
    pub passive: f64,
}

/// The singularities of a configuration.
///
/// ```text
/// type I               s or r' above generic: the object loses a motion
/// type II              i' above generic: the object gains a motion that is not controlled
/// type III             both
/// configuration space  rank [J_a J_p -G^T] below generic
/// passive              idle motions above generic
/// ```
///
/// s is the number of zero-torque wrenches, r' the redundancy and i' the indeterminacy of the
/// relation between actuated joints and object ([`MobilityCounts`]). All are relative to the
/// generic counts ([`GenericMobility`](crate::closure::GenericMobility)): a mechanism may have
/// zero-torque wrenches or idle motions at every configuration.
/// [`Diagnosis`](crate::closure::Diagnosis) gives the motions lost and gained as screws.
///
/// Source: Gosselin & Angeles 1990 (I, II, III); Park & Kim 1999 and Zlatanov et al. 1995
/// (configuration space, passive).
#[derive(Debug, Clone, PartialEq)]
pub struct Singularities {
    /// The kinds, in the order of [`SingularityKind`]; empty for a regular configuration.
    pub kinds: Vec<SingularityKind>,
    /// Zero-torque wrenches, one column each: those beyond the generic number block the lost
    /// motions.
    pub blocked: Matrix,
    /// Motions of the object with the actuated joints at rest: those beyond the generic number are
    /// gained.
    pub gained: Matrix,
    /// The distance to each kind.
    pub distances: SingularityDistances,
}

/// The counts that exceed their generic values.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Excess {
    pub(crate) loses: bool,
    pub(crate) gains: bool,
    pub(crate) folds: bool,
    pub(crate) idles: bool,
}

impl Excess {
    /// `unactuated`: [`MobilityCounts::lack_actuation`] of the branch.
    pub(crate) fn of(now: &MobilityCounts, generic: &MobilityCounts, unactuated: bool) -> Self {
        Self {
            loses: now.zero_torque > generic.zero_torque || now.redundancy > generic.redundancy,
            gains: now.indeterminacy > generic.indeterminacy || unactuated,
            folds: now.rank < generic.rank,
            idles: now.idle > generic.idle,
        }
    }

    pub(crate) fn kinds(self) -> Vec<SingularityKind> {
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
    /// To the next loss or gain, whether or not there is one here already.
    pub(crate) fn of(now: &MobilityCounts, motions: &MotionSpace, relation: &Relation) -> Self {
        let pairs = relation.finite_pairs();
        let none = f64::INFINITY;
        Self {
            type_i: pairs.last().map_or(none, |p| p.0),
            type_ii: pairs.first().map_or(none, |p| p.1),
            configuration_space: if now.rank > 0 { motions.regularity() } else { none },
            passive: motions.vanishing_coefficients(ACTUATED_AND_OBJECT).1.kept,
        }
    }

    /// These distances, 0 to each kind that the configuration has.
    pub(crate) fn against(self, excess: Excess) -> Self {
        let Excess { loses, gains, folds, idles } = excess;
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
    /// At a configuration, against the generic counts of its mechanism.
    ///
    /// ```
    /// use cylindroid::closure::{ClosedChain, GenericMobility, MotionSpace, Singularities};
    ///
    /// let five_bar = cylindroid::load("five-bar")?;
    /// let state = five_bar.state(five_bar.home())?;
    /// let motions = MotionSpace::of(&ClosedChain::of(&state, None, None)?.constraint);
    /// let generic = GenericMobility::of(&state, None, None)?.counts;
    /// let found = Singularities::of(&motions, &motions.relation(), &generic);
    /// assert!(found.is_regular() && found.distances.type_ii > 0.0);
    /// # Ok::<(), cylindroid::Error>(())
    /// ```
    #[must_use]
    pub fn of(motions: &MotionSpace, relation: &Relation, generic: &MobilityCounts) -> Self {
        let now = MobilityCounts::of(motions, relation);
        let excess = Excess::of(&now, generic, false);
        Self {
            kinds: excess.kinds(),
            blocked: relation.forces().infinite,
            gained: relation.motions().infinite,
            distances: SingularityDistances::of(&now, motions, relation).against(excess),
        }
    }

    /// True for a regular configuration.
    #[must_use]
    pub fn is_regular(&self) -> bool {
        self.kinds.is_empty()
    }
}
