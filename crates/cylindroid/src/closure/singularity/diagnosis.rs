//! Diagnosis of a configuration: its singularities, with the motions lost and gained as screws.
//!
//! Formula  type I    blocked: zero-torque wrenches (ran R)^perp beyond the generic ones;
//!                    lost: the twists that do work on them and are orthogonal to ran R (scaled)
//!          type II   gained: twists of the object with the actuated joints at rest, beyond the
//!          generic ones
//!          passive   idle motions beyond the generic ones
//!          configuration space: the branches of [`FiniteMobility`]
//! Shapes   screws of amplitude one, as many as the count exceeds the generic one
//! Units    points m, pitches m/rad
//! Frame    world
//! Valid    if the generic count is zero, the whole space exceeds it, and blocked wrenches and
//!          gained twists do not depend on point, length or frame. Otherwise the generic part is
//!          the limit of that of closed configurations on both sides, along a motion that involves
//!          all degrees of freedom, and the excess is orthogonal to the limit (scaled, at the
//!          reference point): accurate to 1e-6, and dependent on that choice. If no such
//!          configurations are found, the whole space is returned, and [`Diagnosis::separated`] is
//!          false. Lost twists always depend on point and length: only the wrench that blocks them
//!          is geometric
//! Why so   several screws are returned as the principal screws of their system, which do not
//!          depend on a basis; a system without principal screws, by twists that span it
//! Source   Gosselin & Angeles 1990; Zlatanov et al. 1995; Ball 1900 for the principal screws
//! Checked  tests/it/closure/diagnosis.rs

use super::generic_mobility::GenericMobility;
use super::singularity_types::SingularityDistances;
use super::verdict::Verdict;
use crate::closure::constraint::closed_chain::ClosedChain;
use crate::closure::constraint::velocity_constraint::Unit;
use crate::closure::mobility::compression::Compression;
use crate::closure::mobility::counts::MobilityCounts;
use crate::closure::mobility::finite_mobility::FiniteMobility;
use crate::closure::mobility::motion_space::{MotionSpace, RowSelection};
use crate::closure::mobility::relation::Relation;
use crate::error::Result;
use crate::kinematics::State;
use crate::linalg::{ColumnSpace, Matrix, Qr, Svd, Threshold, norm};
use crate::model::FrameId;
use crate::screws::{Line, Screw, ScrewOptions, ScrewSystem};
use crate::spatial::{Twist, Vec3, Wrench};
use crate::tolerance::{CLOSURE_BLOCK, GENERIC_LIMIT, JOINT_AT_REST};

/// The singularities of a configuration, with the screws lost and gained.
///
/// ```text
/// blocked  zero-torque wrenches (ran R)^perp beyond the generic ones
/// lost     the twists that do work on them and are orthogonal to ran R (scaled)
/// gained   twists of the object with the actuated joints at rest, beyond the generic ones
/// ```
///
/// R is the relation between actuated joints and object. Screws of amplitude one, in world axes
/// (points m, pitches m/rad). Blocked wrenches and gained twists do not depend on point, length or
/// frame if the generic count is zero; lost twists always depend on point and length.
///
/// Source: Gosselin & Angeles 1990; Zlatanov et al. 1995.
#[derive(Debug, Clone, PartialEq)]
pub struct Diagnosis {
    /// The kinds, and the mobility.
    pub verdict: Verdict,
    /// The distances to singularities.
    pub distances: SingularityDistances,
    /// The counts of this configuration.
    pub counts: MobilityCounts,
    /// The generic counts.
    pub generic: GenericMobility,
    /// The finite mobility.
    pub finite: FiniteMobility,
    /// Wrenches in equilibrium without torque at this configuration but not generically, as the
    /// screws of their axes (pitch: moment over force; infinite for a couple).
    pub blocked: Vec<Screw>,
    /// Lost motions of the reference frame.
    pub lost: Vec<Screw>,
    /// Gained motions of the reference frame, which the actuated joints do not control.
    pub gained: Vec<Screw>,
    /// Actuated joints that move with the reference frame at rest, at this configuration but not
    /// generically.
    pub redundant: Vec<String>,
    /// Passive coordinates that move alone, at this configuration but not generically.
    pub idle: Vec<String>,
    /// False if the generic part could not be separated from the excess.
    pub separated: bool,
}

impl Diagnosis {
    /// At a configuration, for the mechanism's reference frame or another, with its characteristic
    /// length or another (m).
    ///
    /// ```
    /// use cylindroid::closure::{Diagnosis, SingularityKind};
    ///
    /// // The elbow straight: a 6R arm cannot move along the line from wrist to shoulder.
    /// let arm = cylindroid::load("ur5e")?;
    /// let found = Diagnosis::of(&arm.state(&[0.0, -0.6, 0.0, 0.4, 1.0, 0.0])?, None, None)?;
    /// assert_eq!(found.verdict.kinds(), [SingularityKind::TypeI]);
    /// assert_eq!(found.blocked.len(), 1);
    /// # Ok::<(), cylindroid::Error>(())
    /// ```
    ///
    /// # Errors
    /// As [`ClosedChain::of`].
    pub fn of(state: &State, reference: Option<FrameId>, length: Option<f64>) -> Result<Self> {
        let mechanism = state.mechanism();
        let here = Configuration::of(state, reference, length)?;
        let length = here.chain.constraint.length();
        let counts = here.counts();
        let finite = FiniteMobility::of(state, Some(length))?;
        let generic = GenericMobility::around(state, reference, length, counts, &finite)?;
        let verdict = Verdict::of(&counts, &finite, &generic, here.sizes());
        let distances = SingularityDistances::of(&counts, &here.motions, &here.relation)
            .against(verdict.excess());
        let beside: Vec<Configuration> = finite
            .neighbours()
            .iter()
            .map(|q| Configuration::of(&mechanism.state(q)?, reference, Some(length)))
            .collect::<Result<_>>()?;
        let mut separated = true;
        let mut beyond = |space: &dyn Fn(&Configuration) -> Matrix, now: usize, generic: usize| {
            let (part, clear) = if now > generic {
                beyond(&space(&here), &beside, space, generic)
            } else {
                (Matrix::zeros(0, 0), true)
            };
            separated &= clear;
            part
        };
        let s = generic.counts;
        let blocked = beyond(&Configuration::zero_torque, counts.zero_torque, s.zero_torque);
        let gained = beyond(&Configuration::indeterminate, counts.indeterminacy, s.indeterminacy);
        let mut unfelt = |actuated, now: usize, generic: usize, names: &[String]| {
            let (shares, clear) = unfelt(&here, &beside, actuated, [now, generic]);
            separated &= clear;
            let shares = here.of_joints(actuated, &shares);
            let moves = shares.iter().zip(names).filter(|(share, _)| **share > JOINT_AT_REST);
            moves.map(|(_, name)| name.clone()).collect()
        };
        let redundant = unfelt(true, counts.redundancy, s.redundancy, &here.chain.actuated);
        let idle = unfelt(false, counts.idle, s.idle, &here.chain.passive);
        let point = state.pose_of(here.chain.reference).translation;
        let accuracy = |generic: usize| if generic == 0 { CLOSURE_BLOCK } else { GENERIC_LIMIT };
        let (of_wrenches, of_gains) = (accuracy(s.zero_torque), accuracy(s.indeterminacy));
        let wrenches = here.columns(&blocked, |d, x| x / d).map(|x| ray(wrench(&x, point)));
        let lost = here.columns(&blocked, |d, x| x * d).map(|x| twist(&x, point));
        let gains = here.columns(&gained, |d, x| x * d).map(|x| twist(&x, point));
        Ok(Self {
            blocked: screws(&wrenches.collect::<Vec<_>>(), length, of_wrenches)?,
            lost: screws(&lost.collect::<Vec<_>>(), length, of_wrenches)?,
            gained: screws(&gains.collect::<Vec<_>>(), length, of_gains)?,
            redundant,
            idle,
            verdict,
            distances,
            counts,
            generic,
            finite,
            separated,
        })
    }
}

/// A configuration with its spaces, orthonormal in scaled units.
struct Configuration {
    chain: ClosedChain,
    compression: Compression,
    motions: MotionSpace,
    relation: Relation,
}

impl Configuration {
    fn of(state: &State, reference: Option<FrameId>, length: Option<f64>) -> Result<Self> {
        let chain = ClosedChain::of(state, reference, length)?;
        let compression = Compression::of(&chain.constraint);
        let motions = MotionSpace::of(compression.constraint(&chain.constraint));
        let relation = motions.relation();
        Ok(Self { chain, compression, motions, relation })
    }

    fn counts(&self) -> MobilityCounts {
        let counts = MobilityCounts::of(&self.motions, &self.relation);
        counts.with_split_off(self.compression.split_off())
    }

    /// Number of actuated joints, and of all columns of the constraint.
    fn sizes(&self) -> [usize; 2] {
        let constraint = &self.chain.constraint;
        let actuated = constraint.actuated();
        [actuated, actuated + constraint.passive() + constraint.object()]
    }

    /// The scaled motions of actuated (or passive) joints that are orthogonal to the redundant (or
    /// idle) ones.
    fn felt(&self, actuated: bool) -> Matrix {
        let inner = self.compression.constraint(&self.chain.constraint);
        let a = inner.actuated();
        let own = if actuated {
            let inverse: Vec<f64> = inner.column_scale()[..a].iter().map(|s| 1.0 / s).collect();
            self.relation.motions().zero.scale_rows(&inverse)
        } else {
            let still = RowSelection { actuated: true, passive: false, object: true };
            let idle = self.motions.kernel() * &self.motions.vanishing_coefficients(still).0;
            idle.rows_between(a, a + inner.passive())
        };
        let space = ColumnSpace::of(&own, Threshold::Absolute(CLOSURE_BLOCK));
        self.compression.orthogonal_to(actuated, space.basis())
    }

    /// The share of the joint of each column: that of a single component of a vector, of a ball
    /// joint say, depends on the axes.
    fn of_joints(&self, actuated: bool, shares: &[f64]) -> Vec<f64> {
        let constraint = &self.chain.constraint;
        let first = if actuated { 0 } else { constraint.actuated() };
        let joint = |i: usize| constraint.vector_of(first + i);
        let share = |i| norm(&shares[joint(i).start - first..joint(i).end - first]);
        (0..shares.len()).map(share).collect()
    }

    fn size(&self, unit: Unit) -> f64 {
        unit.size(self.chain.constraint.length())
    }

    /// Orthonormal scaled columns of twists (wrenches if `dual`) or rates.
    fn scaled(&self, columns: &Matrix, units: &[Unit], dual: bool) -> Matrix {
        let scaled = Matrix::from_fn(columns.rows(), columns.cols(), |i, j| {
            let size = self.size(units[i]);
            columns[(i, j)] * if dual { size } else { 1.0 / size }
        });
        ColumnSpace::of(&scaled, Threshold::Absolute(CLOSURE_BLOCK)).basis()
    }

    fn zero_torque(&self) -> Matrix {
        self.scaled(&self.relation.forces().infinite, &self.chain.units.object, true)
    }

    fn indeterminate(&self) -> Matrix {
        self.scaled(&self.relation.motions().infinite, &self.chain.units.object, false)
    }

    /// The columns with every entry multiplied by its scale.
    fn columns<'a>(
        &'a self,
        space: &'a Matrix,
        put: impl Fn(f64, f64) -> f64 + 'a,
    ) -> impl Iterator<Item = Vec<f64>> + 'a {
        let units = &self.chain.units.object;
        (0..space.cols()).map(move |j| {
            space.column(j).iter().zip(units).map(|(x, u)| put(self.size(*u), *x)).collect()
        })
    }
}

/// For each actuated (or passive) joint, its share in the redundant (or idle) motions that exceed
/// the generic ones: those that are felt nearby and not here. False if they could not be separated
/// from the generic ones. `now` and `generic`: numbers of such motions.
fn unfelt(
    here: &Configuration,
    beside: &[Configuration],
    actuated: bool,
    [now, generic]: [usize; 2],
) -> (Vec<f64>, bool) {
    let felt = here.felt(actuated);
    let rows = 0..felt.rows();
    if now <= generic {
        return (vec![0.0; rows.len()], true);
    }
    let near: Vec<Matrix> = beside.iter().map(|c| c.felt(actuated)).collect();
    let near: Vec<&Matrix> = near.iter().filter(|m| m.cols() + generic == m.rows()).collect();
    if generic == 0 || near.is_empty() {
        let all = rows.map(|i| (1.0 - felt.row_norm(i).powi(2)).max(0.0).sqrt());
        return (all.collect(), generic == 0);
    }
    let near = Matrix::hstack(felt.rows(), &near);
    let along = &felt * &(&felt.transpose() * &near);
    let rest =
        Svd::of(&Matrix::from_fn(near.rows(), near.cols(), |i, j| near[(i, j)] - along[(i, j)]));
    let extra = (now - generic).min(rest.len());
    let share = |i: usize| (0..extra).map(|j| rest.u(j)[i].powi(2)).sum::<f64>().sqrt();
    (rows.map(share).collect(), true)
}

/// The part of `now` orthogonal to the limit of the neighbouring spaces, and true if the limit was
/// found.
fn beyond(
    now: &Matrix,
    beside: &[Configuration],
    space: &dyn Fn(&Configuration) -> Matrix,
    generic: usize,
) -> (Matrix, bool) {
    let extra = now.cols().saturating_sub(generic);
    if extra == 0 {
        return (Matrix::zeros(now.rows(), 0), true);
    }
    let near: Vec<Matrix> = beside.iter().map(space).filter(|s| s.cols() == generic).collect();
    if generic == 0 {
        return (now.clone(), true);
    }
    if near.is_empty() {
        return (now.clone(), false);
    }
    let near = Matrix::hstack(now.rows(), &near.iter().collect::<Vec<_>>());
    let limit = Svd::of(&(&now.transpose() * &near));
    let kept = Matrix::from_fn(now.cols(), generic, |i, j| limit.u(j)[i]);
    (now * &Qr::plain(kept).complement(), true)
}

/// The entries of a planar object (x, y, rotation) as six.
fn six(x: &[f64]) -> [f64; 6] {
    match x {
        [x, y, turn] => [*x, *y, 0.0, 0.0, 0.0, *turn],
        _ => std::array::from_fn(|i| x.get(i).copied().unwrap_or(0.0)),
    }
}

/// At the world origin, for `x` at `point`.
fn twist(x: &[f64], point: Vec3) -> Twist {
    Twist::from_array(six(x)).at_point(-point)
}

fn wrench(x: &[f64], point: Vec3) -> Wrench {
    Wrench::from_array(six(x)).at_point(-point)
}

/// A wrench as the twist of the same screw: force becomes angular, moment linear velocity.
fn ray(wrench: Wrench) -> Twist {
    Twist { linear: wrench.moment, angular: wrench.force }
}

/// A single twist as its screw, several as the principal screws of their system; of amplitude one,
/// along the direction whose largest component is positive.
fn screws(twists: &[Twist], length: f64, accuracy: f64) -> Result<Vec<Screw>> {
    let of = |twist: Twist| {
        // An angular velocity within the error of the twist counts as zero.
        let turns = twist.angular.norm() * length > accuracy * twist.linear.norm();
        let twist = if turns { twist } else { Twist { angular: Vec3::ZERO, ..twist } };
        let screw = Screw::of(twist)?;
        let d = screw.axis.direction;
        let largest = [d.x, d.y, d.z].into_iter().fold(0.0, |most: f64, x| {
            if x.abs() > most.abs() * (1.0 + accuracy) { x } else { most }
        });
        let axis = Line { direction: if largest < 0.0 { -d } else { d }, ..screw.axis };
        Some(Screw { axis, amplitude: 1.0, ..screw })
    };
    let twists = match twists {
        [] | [_] => twists.to_vec(),
        _ => {
            let options = ScrewOptions { noise: accuracy, ..ScrewOptions::with_length(length) };
            let system = ScrewSystem::of(twists, &options)?;
            let principal = system.principal_screws();
            if principal.len() == twists.len() {
                principal.iter().map(Screw::twist).collect()
            } else {
                system.basis()
            }
        }
    };
    Ok(twists.into_iter().filter_map(of).collect())
}
