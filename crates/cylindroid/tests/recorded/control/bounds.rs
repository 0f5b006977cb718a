//! Bounds of the velocities of a joint, step by step.

use cylindroid::control::{JointState, VelocityBounds};
use cylindroid::model::Limits;

use super::sum;
use crate::record::{Record, check};
use crate::robots::Random;

fn limits(random: &mut Random<'_>, has_jerk: bool) -> Limits {
    let mut limits = Limits {
        lower: -random.power(-1.5, 1.0),
        upper: random.power(-1.5, 1.0),
        velocity: random.power(-1.0, 1.0),
        acceleration: random.power(-1.0, 2.0),
        jerk: if has_jerk { random.power(-1.0, 3.5) } else { f64::INFINITY },
        ..Limits::NONE
    };
    match random.below(12) {
        0 => limits.lower = f64::NEG_INFINITY,
        1 => limits.upper = f64::INFINITY,
        2 => limits.velocity = f64::INFINITY,
        3 => limits.acceleration = f64::INFINITY,
        4 => limits.acceleration = 0.0,
        5 => (limits.lower, limits.upper) = (0.25, 0.25),
        6 => (limits.lower, limits.upper) = (1e4, 1e4 + 3.0),
        7 => (limits.acceleration, limits.velocity) = (1.0, 2.0),
        _ => {}
    }
    limits
}

/// Within the limits, at one of them, or beyond it.
fn position(limits: &Limits, random: &mut Random<'_>) -> f64 {
    let (lower, upper) = (limits.lower.max(-10.0), limits.upper.min(10_010.0));
    match random.below(8) {
        0 => lower,
        1 => upper,
        2 => upper + random.power(-6.0, -1.0),
        3 => lower - random.power(-6.0, -1.0),
        4 => upper - random.power(-6.0, -1.0),
        5 => lower + random.power(-6.0, -1.0),
        _ => random.within(lower, upper),
    }
}

/// The next velocity: an end of the bounds, one inside, or a push.
fn next_velocity(bounds: &VelocityBounds, random: &mut Random<'_>) -> f64 {
    let any = 3.0 * random.within(-1.0, 1.0);
    match random.below(8) {
        0..3 => bounds.clamp(1e6),
        3..5 => bounds.clamp(-1e6),
        5 => bounds.clamp(0.0),
        6 => any,
        _ => bounds.clamp(any),
    }
}

fn ends(has_jerk: bool, steps: usize, random: &mut Random<'_>, record: &mut Record) {
    let limits = limits(random, has_jerk);
    let dt = random.power(-3.5, -0.7);
    let (velocity, acceleration) = match random.below(3) {
        0 => (0.0, 0.0),
        _ => (random.within(-2.0, 2.0), random.within(-3.0, 3.0)),
    };
    let mut now = JointState { position: position(&limits, random), velocity, acceleration };
    for _ in 0..steps {
        let bounds = VelocityBounds::next(&limits, now, dt);
        let velocity = next_velocity(&bounds, random);
        let probe = random.within(-2.0, 2.0);
        let met = [velocity, bounds.lower, bounds.upper, probe].map(|v| bounds.met(v));
        let met = met.map(|kind| kind.map_or("-", |kind| &kind.name()[..1])).concat();
        let causes = [bounds.lower_cause, bounds.upper_cause].map(|c| &c.name()[..1]).concat();
        record.word(&format!("{met}{causes}{}", u8::from(bounds.contains(probe))));
        // Changes of velocities are small.
        let ends = [bounds.lower, bounds.upper, velocity, bounds.clamp(probe)];
        record.number(sum(&ends.map(|end| (end - now.velocity) / dt)));
        let acceleration = (velocity - now.velocity) / dt;
        now = JointState { position: now.position + velocity * dt, velocity, acceleration };
    }
}

#[test]
fn accelerations() {
    check("control_bounds", 75, |random, record| ends(false, 5, random, record));
}

#[test]
fn jerks() {
    check("control_bounds_jerk", 50, |random, record| ends(true, 6, random, record));
}
