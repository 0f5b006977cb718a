//! Operation modes of closed chains and where they meet.

use cylindroid::Mechanism;
use cylindroid::closure::{ModeOptions, OperationModes, operation_modes};

use super::aligned::aligned;
use super::chains::{LINKAGES, Names, platform, seen_from_elsewhere};
use super::digest::{Digests, sum};
use crate::record::{Record, check};
use crate::robots::Random;

fn modes(record: &mut Record, found: &OperationModes) {
    record.counts(&[found.starts, found.closed, found.undecided]);
    record.number(found.unseen_probability());
    for m in &found.modes {
        let c = m.counts;
        record.counts(&[c.rank, c.idle, c.redundancy, c.indeterminacy, c.zero_torque]);
        record.counts(&[m.dimension, m.dof, m.order, m.found]);
        record.word(&(m.class.name(), &m.branches, m.through));
    }
    for meeting in &found.meetings {
        record.word(&(meeting.dof, meeting.counts.rank, meeting.others.len()));
        record.word(&meeting.modes);
        record.coarse(sum(meeting.configuration.iter().copied()));
    }
    for m in &found.modes {
        record.coarse(sum(m.configuration.iter().copied()));
    }
    for q in found.meetings.iter().flat_map(|m| &m.others) {
        record.coarse(sum(q.iter().copied()));
    }
    for q in found.meetings.iter().map(|m| &m.configuration) {
        record.number(sum(q.iter().copied()));
    }
}

fn search(random: &mut Random<'_>, record: &mut Record, m: &Mechanism) {
    let starts = if random.once_in(12) { 0 } else { 1 + random.below(6) };
    let frames = m.frames().len();
    let frame = m.frame(&m.frames()[random.below(frames)].name).unwrap();
    let reference = random.once_in(4).then_some(frame);
    let shift = if random.once_in(5) { 0.3 } else { 0.0 };
    let q: Vec<f64> = m.home().iter().map(|x| x + shift * random.within(-1.0, 1.0)).collect();
    let options = ModeOptions { starts, seed: random.below(100) as u64 };
    match operation_modes(m, &q, reference, options) {
        Ok(found) => modes(record, &found),
        Err(error) => record.text(error),
    }
}

fn views(file: &str, names: &[&str], cases: u64) {
    let names = Names::of(names);
    check(file, cases, |random, record| {
        let m = names.take(random);
        let m = if random.once_in(4) { m } else { seen_from_elsewhere(&m, random) };
        search(random, record, &m);
    });
}

#[test]
fn linkages() {
    views("mobility_modes_of_linkages", &LINKAGES, 60);
}

#[test]
fn robots() {
    views("mobility_modes_of_robots", &["3rrr", "watt", "upu_tsai", "upu_snu"], 4);
}

#[test]
fn random_chains() {
    check("mobility_modes_of_random_chains", 60, |random, record| {
        let m = if random.once_in(2) { aligned(random) } else { platform(random) };
        search(random, record, &m);
    });
}
