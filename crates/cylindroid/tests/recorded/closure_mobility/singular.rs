//! Diagnosis: verdicts, kinds and types of singularities, screws lost and gained, twists of frames.

use cylindroid::closure::{
    ClosedChain, Diagnosis, GenericMobility, MobilityCounts, assemble, frame_twists,
};
use cylindroid::manipulability::{BatchOptions, ManipulabilityBatch};
use cylindroid::model::FrameId;
use cylindroid::screws::{ScrewOptions, ScrewSystem};
use cylindroid::spatial::Twist;
use cylindroid::{Matrix, Mechanism};

use super::aligned::{aligned, barred, flat_ring, planar_loops, spherical_ring};
use super::chains::{LINKAGES, Names, ROBOTS, platform, seen_from_elsewhere, with_other_actuators};
use super::digest::{Digests, sum};
use super::parallel::{long_chain, parallel};
use crate::record::{Record, check};
use crate::robots::{self, Random};

fn counts(record: &mut Record, c: &MobilityCounts) {
    record.counts(&[c.rank, c.idle, c.redundancy, c.indeterminacy, c.zero_torque]);
}

fn generic(record: &mut Record, found: &GenericMobility) {
    counts(record, &found.counts);
    record.counts(&[found.others]);
    found.branches.iter().for_each(|c| counts(record, c));
}

fn diagnosis(record: &mut Record, found: &Diagnosis) {
    let verdict = &found.verdict;
    // The words of some: they are long.
    let in_words = found.counts.rank.is_multiple_of(3);
    record.text(verdict.structure().name());
    if in_words {
        record.text(verdict);
        record.text(verdict.motion());
        verdict.zlatanov().iter().for_each(|of| record.text(of));
    }
    record.word(&(verdict.dof(), verdict.finite_dof(), verdict.is_certain()));
    record.word(&(verdict.is_regular(), verdict.structure().is_singular()));
    for kind in verdict.kinds().iter().chain(verdict.everywhere()) {
        record.text(kind.name());
    }
    for of in verdict.zlatanov() {
        record.text(of.name());
    }
    counts(record, &found.counts);
    generic(record, &found.generic);
    record.word(&(&found.redundant, &found.idle, found.separated));
    record.counts(&[found.blocked.len(), found.lost.len(), found.gained.len()]);
    let d = found.distances;
    for distance in [d.type_i, d.type_ii, d.configuration_space, d.passive] {
        record.number(if distance.is_finite() { distance } else { 3.0 });
    }
    for screws in [&found.blocked, &found.gained, &found.lost] {
        for screw in screws {
            record.coarse(sum([screw.axis.direction.x, screw.axis.direction.y, screw.pitch]));
        }
        screws.iter().for_each(|screw| record.screw(screw));
    }
}

fn at(random: &mut Random<'_>, record: &mut Record, m: &Mechanism, q: &[f64]) {
    let state = m.state(q).unwrap();
    let length = if random.once_in(2) { Some(random.power(-0.5, 0.5) * m.reach()) } else { None };
    let frames = m.frames().len();
    let frame = m.frame(&m.frames()[random.below(frames)].name).unwrap();
    let reference = random.once_in(3).then_some(frame);
    match Diagnosis::of(&state, reference, length) {
        Ok(found) => diagnosis(record, &found),
        Err(error) => record.text(error),
    }
}

/// Near the home configuration, closed; or there.
fn place(random: &mut Random<'_>, m: &Mechanism) -> Vec<f64> {
    if random.once_in(2) {
        return m.home().to_vec();
    }
    let guess: Vec<f64> = m.home().iter().map(|x| x + random.within(-0.4, 0.4)).collect();
    if random.once_in(12) { guess } else { assemble(m, &guess, &[]).unwrap().q }
}

fn views(file: &str, names: &[&str], cases: u64) {
    let names = Names::of(names);
    check(file, cases, |random, record| {
        let m = names.take(random);
        let m = if random.once_in(4) { m } else { seen_from_elsewhere(&m, random) };
        let m = if random.once_in(2) { m } else { with_other_actuators(&m, random) };
        let q = place(random, &m);
        at(random, record, &m, &q);
    });
}

#[test]
fn linkages() {
    views("mobility_diagnosis_of_linkages", &LINKAGES, 65);
}

#[test]
fn robots_of_closed_chains() {
    views("mobility_diagnosis_of_robots", &ROBOTS, 17);
}

#[test]
fn rings() {
    check("mobility_diagnosis_of_rings", 36, |random, record| {
        let m = if random.once_in(4) { spherical_ring(random) } else { flat_ring(random) };
        let m = if random.once_in(2) { m } else { with_other_actuators(&m, random) };
        at(random, record, &m, m.home());
    });
}

#[test]
fn aligned_hinges() {
    check("mobility_diagnosis_of_aligned_hinges", 20, |random, record| {
        let m = if random.once_in(3) { barred(random) } else { aligned(random) };
        at(random, record, &m, m.home());
    });
}

#[test]
fn platforms() {
    check("mobility_diagnosis_of_platforms", 50, |random, record| {
        let m = if random.once_in(2) { parallel(random) } else { platform(random) };
        let m = if random.once_in(2) { m } else { with_other_actuators(&m, random) };
        let q = place(random, &m);
        at(random, record, &m, &q);
    });
}

/// Trees, at zero and elsewhere: elbows straight, and chains of few joints.
#[test]
fn arms() {
    check("mobility_diagnosis_of_arms", 40, |random, record| {
        let m = if random.once_in(3) {
            robots::of_catalogue(random, false)
        } else {
            robots::robot(random, false)
        };
        let mut q = random.configuration(&m);
        let limits: Vec<(f64, f64)> =
            m.coordinates().iter().map(|c| (c.limits.lower, c.limits.upper)).collect();
        for (x, (lower, upper)) in q.iter_mut().zip(limits) {
            if random.once_in(2) {
                *x = 0.0_f64.max(lower).min(upper);
            }
        }
        at(random, record, &m, &q);
    });
}

/// Arms and loops of so many joints that their constraint is compressed.
#[test]
fn long_chains() {
    check("mobility_diagnosis_of_long_chains", 12, |random, record| {
        let m = long_chain(random);
        let found = Diagnosis::of(&m.state(m.home()).unwrap(), None, None).unwrap();
        record.text(&found.verdict);
        record.text(found.verdict.motion());
        counts(record, &found.counts);
        generic(record, &found.generic);
        record.counts(&[found.redundant.len(), found.idle.len(), found.blocked.len()]);
        let d = found.distances;
        record.numbers(&[d.type_i, d.type_ii, d.configuration_space, d.passive]);
        let screws = [&found.blocked, &found.gained, &found.lost];
        screws.into_iter().flatten().for_each(|screw| record.screw(screw));
        record.text(found.redundant.iter().chain(&found.idle).take(4).cloned().collect::<String>());
    });
}

fn twists(record: &mut Record, twists: &[Twist], length: f64) {
    record.word(&twists.len());
    let system = ScrewSystem::of(twists, &ScrewOptions::with_length(length)).unwrap();
    record.system(&system);
}

/// Generic counts of one or two components of the motion.
fn of_task(random: &mut Random<'_>, record: &mut Record, m: &Mechanism, frame: FrameId) {
    let (d, rows) = (m.dimension().freedoms(), 1 + random.below(2));
    let map = Matrix::from_fn(rows, d, |_, _| random.within(-1.0, 1.0));
    let options = BatchOptions { reference: Some(frame), task: Some(map), ..Default::default() };
    match ManipulabilityBatch::new(m, &options) {
        Ok(batch) => counts(record, &batch.generic()),
        Err(error) => record.text(error),
    }
}

#[test]
fn twists_of_frames() {
    check("mobility_twists_of_frames", 50, |random, record| {
        let m = match random.below(4) {
            0 => robots::robot(random, false),
            1 => planar_loops(random),
            _ => platform(random),
        };
        let frames = m.frames().len();
        let frame = m.frame(&m.frames()[random.below(frames)].name).unwrap();
        let q = if m.is_closed() { m.home().to_vec() } else { random.configuration(&m) };
        let state = m.state(&q).unwrap();
        let of_frame = frame_twists(&state, frame).unwrap();
        twists(record, &of_frame, m.reach());
        let chain = ClosedChain::of(&state, Some(frame), None).unwrap();
        let of_reference = chain.reference_twists(&state);
        twists(record, &of_reference, m.reach());
        generic(record, &GenericMobility::of(&state, Some(frame), None).unwrap());
        of_task(random, record, &m, frame);
        let both = of_frame.iter().chain(&of_reference);
        record.number(sum(both.flat_map(|t| t.to_array())));
    });
}
