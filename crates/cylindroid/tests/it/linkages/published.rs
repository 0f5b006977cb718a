//! The verdicts of the literature.

use cylindroid::closure::{Diagnosis, FiniteMobility, LocalStructure, SingularityKind};

use super::{folder, names, parsed, text};

fn letter(kind: SingularityKind) -> &'static str {
    match kind {
        SingularityKind::TypeI => "I",
        SingularityKind::TypeII => "II",
        SingularityKind::TypeIII => "III",
        SingularityKind::ConfigurationSpace => "C",
        SingularityKind::Passive => "P",
        _ => "?",
    }
}

#[test]
fn verdicts_are_those_that_are_published() {
    let file = std::fs::read_to_string(folder().join("expected.json")).unwrap();
    let expected: serde_json::Value = serde_json::from_str(&file).unwrap();
    let cases = expected["cases"].as_object().unwrap();
    assert_eq!(names(), cases.keys().cloned().collect::<Vec<_>>());
    for (name, case) in cases {
        let m = parsed(&text(name), name);
        let found = Diagnosis::of(&m.state(m.home()).unwrap(), None, None).unwrap();
        let verdict = &found.verdict;
        let what = format!("{name} ({}): {verdict:?}", case["source"]);
        assert_eq!(Some(verdict.dof() as u64), case["dof"].as_u64(), "{what}");
        let finite = verdict.finite_dof().map(|f| f as u64);
        assert_eq!(finite, case["finite_dof"].as_u64(), "{what}");
        let kinds: Vec<&str> = verdict.kinds().into_iter().map(letter).collect();
        match case["singularity"].as_str().unwrap() {
            "regular" => assert!(verdict.is_regular(), "{what}"),
            "not stated" => {}
            "configuration space regular" => assert!(!kinds.contains(&"C"), "{what}"),
            "singular everywhere (architecture), type II" => {
                assert_eq!(kinds, ["II"], "{what}");
                assert_eq!(verdict.everywhere(), [SingularityKind::TypeII], "{what}");
                assert!(found.distances.type_ii == 0.0, "{what}");
            }
            // Where branches meet, the counts exceed those of the branches in other respects too.
            "C" if name == "six_parallel" => {
                // The rods stay parallel: shaky in every configuration.
                assert_eq!(kinds, ["C"], "{what}");
                assert_eq!(verdict.everywhere(), [SingularityKind::ConfigurationSpace], "{what}");
            }
            "C" => assert!(kinds.contains(&"C") && !verdict.is_regular(), "{what}"),
            all => {
                let mut all: Vec<&str> = all.split(' ').collect();
                let mut kinds = kinds.clone();
                all.sort_unstable();
                kinds.sort_unstable();
                assert_eq!(kinds, all, "{what}");
            }
        }
    }
}

/// How the closed configurations lie around those that are no regular points.
#[test]
fn singular_points_of_configuration_spaces() {
    use LocalStructure::{Bifurcation, Shaky, ShakyRigid};
    for (name, structure, branches, order) in [
        ("cascade0", ShakyRigid, &[][..], Some(2)),
        ("cascade2", ShakyRigid, &[], Some(8)),
        ("cheb_slider", ShakyRigid, &[], None),
        ("watt_slider_0.500", ShakyRigid, &[], Some(5)),
        ("k33_conic", ShakyRigid, &[], None),
        ("kite_ext", Bifurcation, &[1, 1], None),
        ("sarrus_folded", Bifurcation, &[2, 1], None),
        ("kinematotropic_meet", Bifurcation, &[2, 1], None),
        ("six_parallel", Shaky, &[2], None),
    ] {
        let m = parsed(&text(name), name);
        let found = Diagnosis::of(&m.state(m.home()).unwrap(), None, None).unwrap();
        let dimensions: Vec<usize> = found.finite.branches.iter().map(|b| b.dimension).collect();
        assert_eq!(found.verdict.structure(), structure, "{name}: {:?}", found.finite);
        assert_eq!(dimensions, branches, "{name}");
        if order.is_some() {
            assert_eq!(found.finite.contact_order, order, "{name}");
        }
    }
}

/// Branches are listed largest first, and what is said of the whole is said of the first.
#[test]
fn branches_are_listed_largest_first() {
    for name in ["sarrus_folded", "kinematotropic_meet"] {
        let m = parsed(&text(name), name);
        let found = FiniteMobility::of(&m.state(m.home()).unwrap(), None).unwrap();
        let dimensions: Vec<usize> = found.branches.iter().map(|b| b.dimension).collect();
        assert_eq!(dimensions, [2, 1], "{name}");
        assert_eq!(found.finite, Some(found.branches[0].dimension), "{name}");
        assert_eq!(found.tracked, found.branches[0].tracked, "{name}");
        for branch in &found.branches {
            assert_eq!(branch.motions.cols(), branch.dimension, "{name}");
            let there = m.state(&branch.configurations[0]).unwrap();
            let mobility = FiniteMobility::of(&there, None).unwrap();
            assert_eq!(mobility.finite, Some(branch.dimension), "{name}");
        }
    }
}
