//! Zlatanov's types: published configurations, and the combinations that are possible.

use std::collections::BTreeSet;

use cylindroid::closure::{Diagnosis, ZlatanovType};
use cylindroid::{Mechanism, catalogue};

use super::verdict::{elsewhere, with_random_actuators};
use crate::support::Random;

fn types(m: &Mechanism, q: &[f64]) -> Vec<&'static str> {
    let found = Diagnosis::of(&m.state(q).unwrap(), None, None).unwrap();
    found.verdict.zlatanov().iter().map(|t| t.name()).collect()
}

fn linkage(name: &str) -> Mechanism {
    let file = format!("{}/tests/data/linkages/{name}.toml", env!("CARGO_MANIFEST_DIR"));
    cylindroid::load(&file).unwrap()
}

/// All combinations that the two identities leave, regular configurations included.
fn possible() -> BTreeSet<Vec<&'static str>> {
    let mut all = BTreeSet::new();
    let few = 0..4_i32;
    for (r, s, i, idle) in few.clone().flat_map(|r| {
        let few = few.clone();
        few.clone().flat_map(move |s| {
            let few = few.clone();
            few.clone().flat_map(move |i| few.clone().map(move |idle| (r, s, i, idle)))
        })
    }) {
        // r' - s = i' - h, dof - n = r' - s + idle.
        let (h, more) = (i - r + s, r - s + idle);
        if h < 0 || more < 0 {
            continue;
        }
        let has = [r > 0, i > 0, h > 0, s > 0, idle > 0, more > 0];
        let types = ZlatanovType::ALL.iter().zip(has).filter(|(_, has)| *has);
        all.insert(types.map(|(t, _)| t.name()).collect());
    }
    all
}

#[test]
fn of_64_combinations_21_are_possible() {
    let all = possible();
    assert_eq!(all.len(), 22);
    assert!(all.iter().all(|types| types.len() != 1), "each is of two types at least");
}

#[test]
fn published_singularities_have_their_types() {
    for (name, expected) in [
        ("rrr_regular", &[][..]),
        // Three concurrent coupler lines: the platform rotates about their point.
        ("rrr_RO_concurrent", &["RO", "II"]),
        ("fichter_1.200", &[]),
        ("fichter_1.571", &["RO", "II"]),
        ("arch_similar", &["RO", "II"]),
        ("fb_dead_crank", &["RI", "IO"]),
        ("fb_dead_rocker", &["RO", "II"]),
        ("orthoglide", &[]),
        ("agile_eye_home", &[]),
        // The two axes of a gimbal in line with the leg.
        ("ups_gimbal", &["II", "IO", "RPM"]),
    ] {
        let m = linkage(name);
        let found = types(&m, m.home());
        assert_eq!(found, expected, "{name}");
    }
    for name in ["rrr_IIM_all_stretched_concurrent", "sarrus_folded", "kinematotropic_meet"] {
        let m = linkage(name);
        assert!(types(&m, m.home()).contains(&"IIM"), "{name}");
    }
}

/// At random closed configurations with random actuators, as many as degrees of freedom.
#[test]
fn only_possible_combinations_occur() {
    let possible = possible();
    let mut seen = BTreeSet::new();
    let mut check = |what: &str, m: &Mechanism, q: &[f64]| {
        let found = Diagnosis::of(&m.state(q).unwrap(), None, None).unwrap();
        let actuators = m.actuated().count() + m.loops().iter().filter(|l| l.actuated).count();
        let generic = &found.generic.counts;
        if found.finite.branches.len() != 1
            || found.finite.branches[0].dimension != actuators
            || generic.redundancy + generic.idle > 0
        {
            return;
        }
        let types: Vec<&str> = found.verdict.zlatanov().iter().map(|t| t.name()).collect();
        assert!(possible.contains(&types), "{what}: {types:?} {:?}", found.verdict);
        assert!(
            found.generic.counts.indeterminacy > 0
                || found.verdict.kinds().is_empty() == types.is_empty(),
            "{what}: {types:?}"
        );
        seen.insert(types);
    };
    let mut random = Random(5);
    for name in ["four-bar", "five-bar", "3rrr", "watt", "delta"] {
        let m = catalogue::load(name).unwrap();
        for round in 0..12 {
            let (chosen, Ok(m)) = with_random_actuators(&m, &mut random) else { continue };
            let q = if round % 2 == 0 { m.home().to_vec() } else { elsewhere(&m, &mut random) };
            check(&format!("{name} {chosen:?} {q:?}"), &m, &q);
        }
    }
    for name in
        ["rrr_RO_concurrent", "fichter_1.571", "fb_dead_crank", "fb_dead_rocker", "ups_gimbal"]
    {
        let m = linkage(name);
        check(name, &m, m.home());
    }
    assert!(seen.len() > 3, "{seen:?}");
}
