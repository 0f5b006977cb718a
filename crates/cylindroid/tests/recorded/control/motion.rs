//! Time laws and joint moves.

use cylindroid::control::{
    JointDefaults, JointMove, JointPath, JointSample, KinematicBounds, LawSample, TimeLaw,
};

use super::{any_robot, fail, sum};
use crate::record::{Record, check};
use crate::robots::Random;

const SHARES: [f64; 10] = [-0.1, 0.0, 0.03, 0.15, 0.31, 0.47, 0.62, 0.88, 1.0, 1.2];

fn bound(random: &mut Random<'_>) -> f64 {
    match random.below(6) {
        0 => f64::INFINITY,
        1 => 1.0,
        _ => random.power(-2.0, 2.0),
    }
}

/// Bounds that permit a motion, nearly always.
pub(super) fn bounds(random: &mut Random<'_>) -> KinematicBounds {
    let [velocity, acceleration, jerk] = [0; 3].map(|_| bound(random));
    let mut bounds = KinematicBounds { velocity, acceleration, jerk };
    if acceleration + jerk == f64::INFINITY && acceleration == jerk {
        bounds.acceleration = 2.0;
    }
    match random.below(60) {
        0 => bounds.velocity = 0.0,
        1 => bounds.acceleration = f64::NAN,
        2 => bounds.jerk = -1.0,
        3 => (bounds.acceleration, bounds.jerk) = (f64::INFINITY, f64::INFINITY),
        4 => bounds.velocity = 1e-300,
        _ => {}
    }
    bounds
}

/// A state of a law, with times over its duration and lengths over its distance.
fn of_state(law: &TimeLaw, state: LawSample) -> f64 {
    let (time, way) = (law.duration(), law.distance());
    let LawSample { position, velocity, acceleration, jerk } = state;
    if time == 0.0 || way == 0.0 {
        return sum(&[position, velocity, acceleration, jerk]);
    }
    sum(&[position, velocity * time, acceleration * time * time, jerk * time * time * time]) / way
}

pub(super) fn of_law(record: &mut Record, law: &TimeLaw) {
    let time = law.duration();
    record.number(time.ln());
    let KinematicBounds { velocity, acceleration, jerk } = law.extrema();
    let most = LawSample { position: 0.0, velocity, acceleration, jerk };
    let switches = law.switches();
    let last = sum(&switches) / if time > 0.0 { time } else { 1.0 };
    record.number(sum(&[of_state(law, most), last, law.distance()]));
    // Where the acceleration or the jerk jumps, rounding decides.
    let longer = |pair: &&[f64]| pair[1] - pair[0] > 1e-6 * time;
    let middles = switches.windows(2).filter(longer).map(|pair| 0.5 * (pair[0] + pair[1]));
    let states: Vec<f64> = middles.map(|t| of_state(law, law.at(t))).collect();
    let shares: Vec<f64> = SHARES.iter().map(|share| of_state(law, law.at(share * time))).collect();
    record.numbers(&[sum(&states), sum(&shares)]);
    record.word(&(law.at(f64::NAN) == LawSample::default(), law.at(0.0) == law.at(-1.0)));
}

fn distance(random: &mut Random<'_>) -> f64 {
    match random.below(10) {
        0 => 0.0,
        1 => 1.0,
        2 => -2.0,
        3 => random.power(-8.0, 8.0),
        4 => [f64::NAN, f64::INFINITY, 1e300, 1e-300][random.below(4)],
        5..7 => random.power(-2.0, 2.0),
        _ => -random.power(-2.0, 2.0),
    }
}

#[test]
fn laws() {
    check("control_laws_of_time", 60, |random, record| {
        let law = match TimeLaw::new(distance(random), bounds(random)) {
            Ok(law) => law,
            Err(error) => return fail(record, &error),
        };
        of_law(record, &law);
        let [same, less, longer] = [1.0, 0.9, 1.0 + random.power(-2.0, 1.0)].map(|share| {
            law.scaled_to_duration(
                share * law.duration() + f64::from(u8::from(law.duration() == 0.0)),
            )
        });
        record.word(&same.is_ok_and(|same| same == law));
        match less {
            Ok(less) => of_law(record, &less),
            Err(error) => fail(record, &error),
        }
        match longer {
            Ok(longer) => of_law(record, &longer),
            Err(error) => fail(record, &error),
        }
    });
}

pub(super) fn of_joint_move(record: &mut Record, motion: &JointMove) {
    of_law(record, motion.law());
    let n = motion.path().dof();
    let mut all = Vec::new();
    for share in [-0.2, 0.2, 0.45, 0.7, 1.1] {
        let (mut positions, mut velocities) = (vec![0.0; n], vec![0.0; n]);
        let out = JointSample { positions: &mut positions, velocities: &mut velocities };
        let time = share * motion.law().duration();
        let state = motion.sample_into(time, out).unwrap();
        all.extend([sum(&positions), sum(&velocities), state.velocity]);
    }
    record.numbers(&[sum(&all[..6]), sum(&all[6..])]);
}

/// Between any two configurations within limits, which may be equal; now and then outside of them.
fn along_limits(random: &mut Random<'_>, record: &mut Record) {
    let robot = any_robot(random);
    let (mut q, mut to) = (random.configuration(&robot), random.configuration(&robot));
    for i in 0..q.len() {
        if random.once_in(3) {
            to[i] = q[i];
        }
        if random.once_in(40) {
            q[i] += random.within(-5.0, 5.0);
        }
    }
    let defaults = JointDefaults { angle: bounds(random), length: bounds(random) };
    match JointMove::within_limits(&robot, &q, &to, &defaults) {
        Ok(motion) => {
            of_joint_move(record, &motion);
            let longer = 1.3 * motion.law().duration() + 0.1;
            of_joint_move(record, &motion.scaled_to_duration(longer).unwrap());
        }
        Err(error) => fail(record, &error),
    }
}

#[test]
fn joint_moves_within_limits() {
    check("control_joint_limits", 45, along_limits);
}

#[test]
fn joint_moves() {
    check("control_joint_moves", 45, |random, record| {
        let n = random.below(5);
        let mut ends = [0; 2].map(|_| (0..n).map(|_| random.within(-3.0, 3.0)).collect::<Vec<_>>());
        match random.below(8) {
            0 => ends[1] = ends[0].clone(),
            1 => ends[1].push(1.0),
            2 if n > 0 => ends[0][0] = f64::NAN,
            _ => {}
        }
        let path = match JointPath::new(&ends[0], &ends[1]) {
            Ok(path) => path,
            Err(error) => return fail(record, &error),
        };
        let (mut place, mut places) = (vec![0.0; n], Vec::new());
        for s in [f64::NAN, -1.0, 0.3, 0.5, 0.6, 2.0] {
            path.position_into(s, &mut place).unwrap();
            places.extend_from_slice(&place);
        }
        record.number(sum(&places) + sum(path.displacement()));
        record.word(&path.position_into(0.0, &mut vec![0.0; n + 1]).is_err());
        let count = if random.once_in(10) { n + 1 } else { n };
        let all: Vec<KinematicBounds> = (0..count).map(|_| bounds(random)).collect();
        match JointMove::new(path, &all) {
            Ok(motion) => of_joint_move(record, &motion),
            Err(error) => fail(record, &error),
        }
    });
}
