//! Transmission indices of parallel mechanisms: of motion and force from each actuator into its
//! limb, from the limb to the platform, and of constraint wrenches to the platform.
//!
//! Formula  index = |$_T o $| / max, o: power of a wrench with a twist
//!          input       $ = $_I,i, the twist of the actuated joint
//!          output      $ = $_O,i, the twist of the platform with all actuators locked but i
//!          constraint  $_C,i o $_D,i, the twist with all actuators locked and limb i without its
//!                      constraint wrench
//!          $_T,i: wrench of actuator i, reciprocal to the twists of its limb with i locked
//!          max: over all directions of a wrench of the same pitch p and force through the same
//!          point A: |f| |v_A + p w|, which is |f| |w| sqrt((p + p_$)^2 + d^2) with the pitch p_$ of
//!          the twist and the distance d of A from its axis; for a couple m: |m| |w|
//!          A: the point of the axis of $_T nearest to the centre of the joints by which the actuated
//!          link passes its motion on (input), of the limb's joints at the platform (output)
//!          local transmission index = the smallest of all inputs and outputs
//! Units    none: 0 to 1
//! Valid    two limbs or more, and as many actuated joints as degrees of freedom of the platform at
//!          regular configurations; each actuated joint in a limb. Independent of frame and scale.
//!          Where constraint wrenches leave $_T open, it is taken as in `limbs.rs`; its power with
//!          twists of the limb does not depend on the choice, the maximum does. For a limb with loops
//!          of its own the input index is defined if the actuated link itself carries $_T
//! Why so   the maximum is geometric: neither units nor the size of the twists enter
//! Source   Wang, Wu & Liu 2010 (input, output, local index); Chen & Angeles 2007 (the maximum and
//!          the point A); Liu, Chen & Nahon 2014 (constraints)
//! Checked  tests/it/closure/transmission.rs, tests in this file

use super::generic_mobility::GenericMobility;
use crate::closure::mobility::limb_motion::PlatformCoordinates;
use crate::closure::mobility::limbs::{Actuator, Limb, LimbScrews, span};
use crate::linalg::Matrix;
use crate::screws::Screw;
use crate::spatial::{Twist, Vec3, Wrench};
use crate::tolerance::CLOSURE_BLOCK;

/// The transmission indices of a mechanism at a configuration, from 0 to 1.
///
/// ```text
/// index = |$_T o $| / max |$_T o $|,  max = |f| |w| sqrt((p_T + p_$)^2 + d^2)
/// ```
///
/// An input index of 0 is a type I singularity, output indices of 0 a type II singularity, a
/// constraint index of 0 a constraint singularity.
///
/// Source: Wang, Wu & Liu 2010; Chen & Angeles 2007; Liu, Chen & Nahon 2014.
#[derive(Debug, Clone, PartialEq)]
pub struct Transmission {
    /// The indices of each actuator, in the order of the limbs.
    pub actuators: Vec<ActuatorTransmission>,
    /// The local transmission index: the smallest input or output index; `None` if one of them is
    /// not defined and the others are not zero.
    pub local: Option<f64>,
    /// The smallest index of constraint wrenches: 0 at constraint singularities. `None` without
    /// constraint wrenches, and elsewhere than at constraint singularities if they depend on each
    /// other (overconstrained mechanisms) or a limb has several.
    pub constraint: Option<f64>,
}

/// The transmission indices of an actuator.
#[derive(Debug, Clone, PartialEq)]
pub struct ActuatorTransmission {
    /// Its name.
    pub name: String,
    /// Its limb, an index into [`LimbScrews::limbs`].
    pub limb: usize,
    /// Its transmission wrench, as the screw of its axis (world axes; amplitude one); `None` if it
    /// transmits none beyond the constraint wrenches of its limb.
    pub wrench: Option<Screw>,
    /// The input transmission index; `None` for limbs with loops of their own whose actuated link
    /// does not carry the transmission wrench.
    pub input: Option<f64>,
    /// The output transmission index; `None` without transmission wrench.
    pub output: Option<f64>,
}

impl Transmission {
    /// For the limbs of a configuration and the generic counts of its branches; `None` where the
    /// indices are not defined: fewer than two limbs, no branch (a structure), or another number of
    /// actuated joints than of degrees of freedom of the platform.
    ///
    /// ```
    /// use cylindroid::closure::{GenericMobility, LimbScrews, Transmission};
    ///
    /// let stewart = cylindroid::load("stewart")?;
    /// let state = stewart.state(stewart.home())?;
    /// let limbs = LimbScrews::of(&state, None, None)?;
    /// let generic = GenericMobility::of(&state, None, None)?;
    /// let found = Transmission::of(&limbs, &generic).unwrap();
    /// // A cylinder between two points pushes along itself.
    /// assert!(found.actuators.iter().all(|a| a.input.unwrap() > 1.0 - 1e-12));
    /// assert!(found.local.unwrap() > 0.1);
    /// # Ok::<(), cylindroid::Error>(())
    /// ```
    #[must_use]
    pub fn of(screws: &LimbScrews, generic: &GenericMobility) -> Option<Self> {
        let platform = &screws.platform;
        let least = generic.branches.iter().map(|b| b.zero_torque).min()?;
        // More only if they are those of another mechanism.
        let freedoms = platform.d().checked_sub(least)?;
        let own: Vec<(usize, &Actuator)> = screws
            .limbs
            .iter()
            .enumerate()
            .flat_map(|(i, limb)| limb.space.actuators.iter().map(move |a| (i, a)))
            .collect();
        let count = screws.actuators;
        if screws.limbs.len() < 2 || count != freedoms || own.len() != count || count == 0 {
            return None;
        }
        let wrenches: Vec<Option<Matrix>> = own.iter().map(|(_, a)| column(a)).collect();
        let constraints: Vec<&Matrix> = screws.limbs.iter().map(|l| &l.space.constraint).collect();
        let all: Vec<&Matrix> =
            constraints.iter().copied().chain(wrenches.iter().flatten()).collect();
        let resisted = span(platform, &all).rank();
        let actuators: Vec<ActuatorTransmission> = own
            .iter()
            .enumerate()
            .map(|(i, (limb, actuator))| {
                let output = || {
                    let wrench = platform.wrench(actuator.wrench.as_deref()?);
                    if resisted < platform.d() {
                        return Some(0.0);
                    }
                    let others = wrenches.iter().enumerate().filter(|(j, _)| *j != i);
                    let others = others.filter_map(|(_, w)| w.as_ref());
                    let kept: Vec<&Matrix> = constraints.iter().copied().chain(others).collect();
                    let twist = released(platform, &kept)?;
                    let arm = screws.limbs[*limb].space.center - platform.origin;
                    Some(index(wrench, twist, arm, platform.length))
                };
                ActuatorTransmission {
                    name: actuator.name.clone(),
                    limb: *limb,
                    wrench: actuator.wrench.as_deref().and_then(|w| axis(platform, w)),
                    input: input(platform, actuator),
                    output: output(),
                }
            })
            .collect();
        let each = || actuators.iter().flat_map(|a| [a.input, a.output]);
        let least = each().flatten().fold(f64::INFINITY, f64::min);
        Some(Self {
            local: (least == 0.0 || each().all(|x| x.is_some())).then_some(least),
            constraint: constraint_index(screws, &constraints, &wrenches, freedoms),
            actuators,
        })
    }
}

fn column(actuator: &Actuator) -> Option<Matrix> {
    actuator.wrench.as_ref().map(|w| Matrix::from_fn(w.len(), 1, |i, _| w[i]))
}

/// The only twist reciprocal to all columns, at the reference point.
fn released(platform: &PlatformCoordinates, wrenches: &[&Matrix]) -> Option<Twist> {
    let left = span(platform, wrenches).complement();
    (left.cols() == 1).then(|| platform.twist(left.column(0)))
}

fn axis(platform: &PlatformCoordinates, wrench: &[f64]) -> Option<Screw> {
    let wrench = platform.wrench(wrench);
    let couple = wrench.force.norm() * platform.length <= CLOSURE_BLOCK * wrench.moment.norm();
    let wrench = wrench.at_point(-platform.origin);
    let force = if couple { Vec3::ZERO } else { wrench.force };
    let screw = Screw::of(Twist { linear: wrench.moment, angular: force })?;
    Some(Screw { amplitude: 1.0, ..screw })
}

/// 0 without transmission wrench.
fn input(platform: &PlatformCoordinates, actuator: &Actuator) -> Option<f64> {
    let Some(wrench) = actuator.wrench.as_deref() else { return Some(0.0) };
    let wrench = platform.wrench(wrench);
    let (power, twist) = (actuator.twist.power(wrench), actuator.twist);
    let (power, carried) = (power.abs(), actuator.power.abs());
    let size = power.max(carried);
    if size == 0.0 || (power - carried).abs() > CLOSURE_BLOCK.sqrt() * size {
        return None;
    }
    let arm = actuator.point? - platform.origin;
    Some(index(wrench, twist, arm, platform.length))
}

/// |power| over its maximum: wrench and twist at the reference point, `arm` from there to the centre
/// of the joints that transmit.
fn index(wrench: Wrench, twist: Twist, arm: Vec3, length: f64) -> f64 {
    let (f, m) = (wrench.force, wrench.moment);
    let turning = twist.angular;
    let largest = if f.norm() * length <= CLOSURE_BLOCK * m.norm() {
        m.norm() * turning.norm()
    } else {
        let size = f.dot(f);
        let foot = f.cross(m) * (1.0 / size);
        let point = foot + f * (f.dot(arm - foot) / size);
        let pitch = f.dot(m) / size;
        (twist.at_point(point).linear + turning * pitch).norm() * f.norm()
    };
    if largest > 0.0 { (twist.power(wrench).abs() / largest).min(1.0) } else { 0.0 }
}

fn constraint_index(
    screws: &LimbScrews,
    constraints: &[&Matrix],
    wrenches: &[Option<Matrix>],
    freedoms: usize,
) -> Option<f64> {
    let platform = &screws.platform;
    let rank = span(platform, constraints).rank();
    let needed = platform.d() - freedoms;
    if rank < needed {
        return Some(0.0);
    }
    let number: usize = constraints.iter().map(|c| c.cols()).sum();
    let several = constraints.iter().any(|c| c.cols() > 1);
    if number == 0 || number > needed || several {
        return None;
    }
    let of = |(i, limb): (usize, &Limb)| {
        let own = &limb.space.constraint;
        if own.cols() == 0 {
            return Some(f64::INFINITY);
        }
        let others = constraints.iter().enumerate().filter(|(j, _)| *j != i).map(|(_, c)| *c);
        let kept: Vec<&Matrix> = others.chain(wrenches.iter().flatten()).collect();
        let arm = limb.space.center - platform.origin;
        let twist = released(platform, &kept)?;
        Some(index(platform.wrench(own.column(0)), twist, arm, platform.length))
    };
    screws.limbs.iter().enumerate().map(of).try_fold(f64::INFINITY, |least, x| Some(least.min(x?)))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A force through the axis about which the body turns has no power, whatever its direction;
    /// one at a distance all of it, a couple the cosine.
    #[test]
    fn indices_of_a_force_and_of_a_couple() {
        let turn = Twist { linear: Vec3::ZERO, angular: Vec3::Z };
        for force in [Vec3::X, Vec3::Y, Vec3::Z, Vec3::new(0.3, -0.2, 0.7)] {
            let through = Wrench { force, moment: Vec3::ZERO };
            assert_eq!(index(through, turn, Vec3::ZERO, 1.0), 0.0);
        }
        let arm = Vec3::new(0.0, -2.0, 0.0);
        let beside = Wrench { force: Vec3::X, moment: arm.cross(Vec3::X) };
        assert!((index(beside, turn, arm, 1.0) - 1.0).abs() < 1e-15);
        let couple = Wrench { force: Vec3::ZERO, moment: Vec3::new(0.0, 3.0, 4.0) };
        assert!((index(couple, turn, arm, 1.0) - 0.8).abs() < 1e-15);
        assert_eq!(index(couple, Twist { angular: Vec3::ZERO, ..turn }, arm, 1.0), 0.0);
    }
}
