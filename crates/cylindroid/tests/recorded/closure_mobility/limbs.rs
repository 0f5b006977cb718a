//! Screw systems of limbs and transmission indices.

use cylindroid::Mechanism;
use cylindroid::closure::{GenericMobility, LimbScrews, Transmission, assemble};

use super::aligned::aligned;
use super::chains::{LINKAGES, Names, ROBOTS, platform, seen_from_elsewhere, with_other_actuators};
use super::digest::Digests;
use super::parallel::parallel;
use crate::record::{Record, check};
use crate::robots::{self, Random};

fn transmission(record: &mut Record, found: &Transmission) {
    let index = |x: Option<f64>| x.unwrap_or(-1.0);
    record.numbers(&[index(found.local), index(found.constraint)]);
    for a in &found.actuators {
        record.text(format!("{},{},{}", a.name, a.limb, a.wrench.is_some()));
        record.numbers(&[index(a.input), index(a.output)]);
    }
}

fn limbs(random: &mut Random<'_>, record: &mut Record, m: &Mechanism) {
    let guess: Vec<f64> = m.home().iter().map(|x| x + random.within(-0.2, 0.2)).collect();
    let q = if random.once_in(2) { m.home().to_vec() } else { assemble(m, &guess, &[]).unwrap().q };
    let state = m.state(&q).unwrap();
    let length = if random.once_in(2) { Some(random.power(-0.5, 0.5) * m.reach()) } else { None };
    let frames = m.frames().len();
    let frame = m.frame(&m.frames()[random.below(frames)].name).unwrap();
    let reference = random.once_in(3).then_some(frame);
    let found = LimbScrews::of(&state, reference, length).unwrap();
    record.counts(&[found.limbs.len()]);
    for limb in &found.limbs {
        record.text(format!(
            "{}:{}:{}",
            limb.serial,
            limb.joints.join(","),
            limb.actuated.join(",")
        ));
        record.counts(&[limb.twists.order(), limb.constraint.order(), limb.actuation.order()]);
    }
    record.system(&found.twists);
    record.system(&found.constraint);
    let generic = GenericMobility::of(&state, reference, length).unwrap();
    let indices = Transmission::of(&found, &generic);
    match &indices {
        Some(found) => transmission(record, found),
        None => record.text("no transmission"),
    }
    for limb in &found.limbs {
        [&limb.twists, &limb.constraint, &limb.actuation].iter().for_each(|s| record.system(s));
    }
    let actuators = indices.iter().flat_map(|t| &t.actuators);
    actuators.filter_map(|a| a.wrench.as_ref()).for_each(|w| record.screw(w));
}

fn views(file: &str, names: &[&str], cases: u64) {
    let names = Names::of(names);
    check(file, cases, |random, record| {
        let m = names.take(random);
        let m = if random.once_in(4) { m } else { seen_from_elsewhere(&m, random) };
        let m = if random.below(3) > 0 { m } else { with_other_actuators(&m, random) };
        limbs(random, record, &m);
    });
}

#[test]
fn linkages() {
    views("mobility_limbs_of_linkages", &LINKAGES, 30);
}

#[test]
fn robots() {
    views("mobility_limbs_of_robots", &ROBOTS, 20);
}

#[test]
fn platforms() {
    check("mobility_limbs_of_platforms", 50, |random, record| {
        let m = match random.below(6) {
            0 => aligned(random),
            1 => platform(random),
            2 => robots::robot(random, false),
            _ => parallel(random),
        };
        limbs(random, record, &m);
    });
}
