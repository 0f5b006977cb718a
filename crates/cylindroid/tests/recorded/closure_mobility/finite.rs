//! Finite mobility: branches, rigidity of second order, and how far motions are tracked.

use cylindroid::Mechanism;
use cylindroid::closure::{Branch, FiniteMobility, SecondOrder, assemble};

use super::aligned::{aligned, barred, flat_ring, parallel_ring, planar_loops, spherical_ring};
use super::chains::{LINKAGES, Names, ROBOTS, platform, seen_from_elsewhere};
use super::digest::{Digests, entries, span, sum};
use crate::record::{Record, check};
use crate::robots::Random;

fn second_order(record: &mut Record, second: &SecondOrder) {
    record.text(second.rigidity);
    record.word(&(second.forms, second.motion.cols()));
    record.coarse(span(&second.motion));
}

fn far(branch: &Branch) -> f64 {
    sum(branch.configurations.iter().map(|q| sum(q.iter().copied())))
}

pub(super) fn finite_mobility(record: &mut Record, found: &FiniteMobility) {
    record.word(&(found.closed, found.infinitesimal, found.finite, found.certain));
    record.word(&(found.evidence, found.is_ordinary(), found.contact_order));
    record.word(&found.branches.iter().map(|b| b.dimension).collect::<Vec<_>>());
    record.word(&(found.shaky.cols(), found.shaky.rows()));
    record.number(found.tracked);
    record.size(if found.residual > 1e-11 { found.residual } else { 0.0 });
    record.coarse(span(&found.shaky));
    if let Some(second) = &found.second_order {
        second_order(record, second);
    }
    for branch in &found.branches {
        record.coarse(branch.tracked);
        record.word(&(branch.motions.cols(), branch.configurations.len()));
        record.coarse(span(&branch.motions));
        record.coarse(far(branch));
    }
    for branch in &found.branches {
        record.numbers(&[branch.tracked, span(&branch.motions), far(branch)]);
    }
    record.numbers(&[span(&found.shaky), entries(&found.shaky)]);
}

fn at_home(random: &mut Random<'_>, record: &mut Record, m: &Mechanism) {
    let length = match random.below(6) {
        // Steps of slides are too long, and are halved, or turns are.
        0 => Some(random.power(-3.0, 3.0) * m.reach()),
        1..3 => Some(random.power(-0.5, 0.5) * m.reach()),
        _ => None,
    };
    let found = FiniteMobility::of(&m.state(m.home()).unwrap(), length);
    finite_mobility(record, &found.unwrap());
}

fn views(file: &str, names: &[&str], cases: u64) {
    let names = Names::of(names);
    check(file, cases, |random, record| {
        let m = names.take(random);
        let m = if random.once_in(4) { m } else { seen_from_elsewhere(&m, random) };
        at_home(random, record, &m);
    });
}

#[test]
fn linkages() {
    views("mobility_finite_linkages", &LINKAGES, 50);
}

#[test]
fn robots() {
    views("mobility_finite_robots", &ROBOTS, 17);
}

#[test]
fn rings() {
    check("mobility_finite_rings", 85, |random, record| {
        let m = match random.below(5) {
            0 => spherical_ring(random),
            1 => planar_loops(random),
            2 => parallel_ring(random),
            _ => flat_ring(random),
        };
        at_home(random, record, &m);
    });
}

#[test]
fn aligned_hinges() {
    check("mobility_finite_aligned", 45, |random, record| {
        let m = if random.once_in(2) { barred(random) } else { aligned(random) };
        at_home(random, record, &m);
    });
}

#[test]
fn platforms() {
    check("mobility_finite_platforms", 40, |random, record| {
        let m = platform(random);
        let guess: Vec<f64> = m.home().iter().map(|x| x + random.within(-0.1, 0.1)).collect();
        let q = match random.below(3) {
            0 => m.home().to_vec(),
            1 if random.once_in(8) => guess,
            _ => assemble(&m, &guess, &[]).unwrap().q,
        };
        let length = if random.once_in(16) { Some(random.within(-1.0, 0.0)) } else { None };
        match FiniteMobility::of(&m.state(&q).unwrap(), length) {
            Ok(found) => finite_mobility(record, &found),
            Err(error) => record.text(error),
        }
    });
}
