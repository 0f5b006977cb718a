//! The verdict: one value, so that its sentences cannot contradict each other.

use cylindroid::closure::{Diagnosis, LocalStructure, SingularityKind, Verdict, assemble};
use cylindroid::{Mechanism, catalogue};

use crate::support::Random;

/// What must hold between the statements of any verdict.
fn agrees(what: &str, found: &Diagnosis) {
    use LocalStructure::{Bifurcation, Cone, Regular, Rigid, Shaky, ShakyRigid, Unknown};
    let verdict: &Verdict = &found.verdict;
    let (k, finite, structure) = (verdict.dof(), verdict.finite_dof(), verdict.structure());
    let kinds = verdict.kinds();
    let folds = kinds.contains(&SingularityKind::ConfigurationSpace);
    let what = format!("{what}: {verdict:?}");
    // Configuration space regular <=> finite dof = first-order dof, on one branch.
    assert_eq!(finite.is_none(), structure == Unknown, "{what}");
    assert_eq!(folds, finite.is_some_and(|f| f < k), "{what}");
    assert_eq!(folds, structure.is_singular(), "{what}");
    assert_eq!(folds, found.distances.configuration_space == 0.0, "{what}");
    let branches = found.finite.branches.len();
    match structure {
        Unknown | Rigid | ShakyRigid => assert_eq!(branches, 0, "{what}"),
        Regular | Cone | Shaky => assert_eq!(branches, 1, "{what}"),
        Bifurcation => assert!(branches > 1, "{what}"),
        _ => panic!("{what}"),
    }
    assert_eq!(structure == Rigid, finite.is_some() && k == 0, "{what}");
    // Regular <=> no kind, and the sentence says so.
    assert_eq!(verdict.is_regular(), kinds.is_empty() && structure != Unknown, "{what}");
    let says = verdict.to_string();
    assert_eq!(says.starts_with("none"), verdict.is_regular(), "{says} {what}");
    assert!(!(says.starts_with("none") && verdict.motion().contains("shaky")), "{what}");
    // A distance is zero exactly at its singularity.
    let has = |list: &[SingularityKind]| kinds.iter().any(|k| list.contains(k));
    let d = found.distances;
    use SingularityKind::{Passive, TypeI, TypeII, TypeIII};
    assert_eq!(d.type_i == 0.0, has(&[TypeI, TypeIII]), "{what}");
    assert_eq!(d.type_ii == 0.0, has(&[TypeII, TypeIII]), "{what}");
    assert_eq!(d.passive == 0.0, has(&[Passive]), "{what}");
    // What all configurations have, this one has.
    for kind in verdict.everywhere() {
        assert!(kinds.contains(kind) || kinds.contains(&TypeIII), "{what}");
    }
}

#[test]
fn every_choice_of_actuators_has_one_verdict() {
    for name in ["four-bar", "five-bar", "3rrr", "watt", "delta"] {
        let m = catalogue::load(name).unwrap();
        let mut random = Random(3);
        for round in 0..24 {
            let (chosen, Ok(m)) = with_random_actuators(&m, &mut random) else { continue };
            let q = if round % 2 == 0 { m.home().to_vec() } else { elsewhere(&m, &mut random) };
            let found = Diagnosis::of(&m.state(&q).unwrap(), None, None).unwrap();
            agrees(&format!("{name} {chosen:?} {q:?}"), &found);
        }
    }
}

/// The mechanism with a random choice of actuated joints, by name, if it is accepted.
pub(super) fn with_random_actuators(
    m: &Mechanism,
    random: &mut Random,
) -> (Vec<String>, cylindroid::Result<Mechanism>) {
    let names = m.joints().iter().map(|j| j.name.clone());
    let chosen: Vec<String> = names.filter(|_| random.within(0.0, 1.0) < 0.4).collect();
    let with = m.with_actuated(&chosen);
    (chosen, with)
}

/// A closed configuration nearby, or an open one.
pub(super) fn elsewhere(m: &Mechanism, random: &mut Random) -> Vec<f64> {
    let guess: Vec<f64> = m.home().iter().map(|x| x + random.within(-0.5, 0.5)).collect();
    assemble(m, &guess, &[]).unwrap().q
}

#[test]
fn every_linkage_has_one_verdict() {
    let folders = ["tests/data/linkages", "tests/data/mechanisms", "src/model/catalogue"];
    for folder in folders {
        let path = format!("{}/{folder}", env!("CARGO_MANIFEST_DIR"));
        for file in std::fs::read_dir(path).unwrap().map(|f| f.unwrap().path()) {
            if file.extension().is_none_or(|e| e != "toml") {
                continue;
            }
            let file = file.to_str().unwrap();
            let m = cylindroid::load(file).unwrap();
            let found = Diagnosis::of(&m.state(m.home()).unwrap(), None, None).unwrap();
            agrees(file, &found);
        }
    }
}
