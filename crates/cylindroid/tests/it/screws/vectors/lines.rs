//! Lines in involution and their transversals; counterexamples to the paper.

use cylindroid::inverse::{self, HyperbolicDamping, HyperbolicOptions};
use cylindroid::screws::{Class, Line, NoInverse, Screw, ScrewOptions, involution, transversals};
use cylindroid::spatial::Vec3;
use serde_json::Value;

use super::{column, number, reference, twists};

fn lines_of(v: &Value) -> Vec<Line> {
    let m = twists(v);
    (0..m.cols()).map(|j| Screw::of(column(&m, j)).unwrap().axis).collect()
}

#[test]
fn lines() {
    for case in reference()["lines"].as_array().unwrap() {
        let name = case["name"].as_str().unwrap();
        let placed = case["frames"].as_array().unwrap().iter().map(|f| &f["lines"]);
        for lines in [&case["lines"]].into_iter().chain(placed) {
            let lines = lines_of(lines);
            let found = involution(&lines, &ScrewOptions::default()).unwrap();
            assert_eq!(found.system.order() as u64, case["rank"].as_u64().unwrap(), "{name}");
            assert_eq!(found.system.class().name(), case["class"].as_str().unwrap(), "{name}");
            assert_eq!(found.independent, case["independent"].as_bool().unwrap(), "{name}");
            assert_eq!(
                found.in_involution,
                case["involution_gram_criterion"].as_bool().unwrap(),
                "{name}"
            );
            let existence = found.system.existence(0.0);
            assert_eq!((found.margin, found.threshold), (existence.margin, existence.threshold));
            let radical = case["radical_dim"].as_u64().unwrap() as usize;
            assert_eq!(found.null_twists.len(), radical, "{name}");
            for z in &found.null_twists {
                assert!(found.system.sine_to(*z) < 1e-9, "{name}: null twist is of the span");
                let wrench = z.lowered(0.0);
                for line in &lines {
                    assert!(line.twist().power(wrench).abs() < 1e-9, "{name}: no torque");
                }
            }
            let t = &found.transversals;
            assert_eq!(*t, transversals(&lines, &ScrewOptions::default()).unwrap());
            match &case["transversals_real"] {
                Value::String(s) if s == "inf" => assert!(t.infinitely_many, "{name}"),
                Value::String(_) => {
                    assert!(!t.infinitely_many && t.lines.is_empty(), "{name}: {t:?}");
                    assert_eq!(t.at_infinity.len(), 1, "{name}");
                }
                count => {
                    assert!(!t.infinitely_many, "{name}");
                    assert_eq!(t.lines.len() as u64, count.as_u64().unwrap(), "{name}: {t:?}");
                }
            }
            for transversal in &t.lines {
                for line in &lines {
                    let meets = line.twist().klein(transversal.twist()).abs();
                    assert!(meets < 1e-7, "{name}: transversal misses a line by {meets}");
                }
            }
        }
    }
}

#[test]
fn counterexamples_to_the_paper() {
    let data = &reference()["counterexamples"];
    let options = ScrewOptions::default();
    // Theorem 3 (iii) needs the point of tangency to be of the system.
    let case = &data["thm3_iii"];
    let j = twists(&case["J"]);
    let z = twists(&Value::Array(
        case["z"].as_array().unwrap().iter().map(|x| Value::Array(vec![x.clone()])).collect(),
    ));
    let (s, z) = (column(&j, 0), column(&z, 0));
    assert_eq!((z.pitch_form(z, 0.0), s.pitch_form(z, 0.0)), (0.0, 0.0));
    assert_eq!(s.pitch_form(s, 0.0), number(&case["gram"]));
    assert!(inverse::hyperbolic(&j, 0.0).unwrap().exists);
    // Four independent lines in involution with one transversal, and with none.
    let one =
        involution(&lines_of(&data["m4_single_transversal_in_involution"]), &options).unwrap();
    assert!(one.in_involution && one.independent && one.transversals.double);
    assert_eq!(one.transversals.lines.len(), 1);
    let mut pitches = one.system.reciprocal().principal_pitches();
    pitches.sort_by(f64::total_cmp);
    assert!((pitches[0] + 0.4).abs() < 1e-12 && pitches[1].abs() < 1e-12, "{pitches:?}");
    let none = involution(&lines_of(&data["m4_no_transversal_in_involution"]), &options).unwrap();
    assert!(none.in_involution && none.independent && none.transversals.lines.is_empty());
    assert_eq!(none.system.class(), Class::IIB);
    assert!(none.null_screw.unwrap().is_translation());
    assert_eq!(none.wrench.unwrap().force, Vec3::ZERO);
    let five = involution(&lines_of(&data["m5_parallel_to_plane"]), &options).unwrap();
    assert!(five.in_involution && five.independent && five.null_screw.unwrap().is_translation());
    // A damped form that is singular although its damping is positive.
    let case = &data["damped_singular"];
    let damping = HyperbolicDamping::Gram { lambda: number(&case["Lambda"]) };
    let options = HyperbolicOptions { damping, ..HyperbolicOptions::default() };
    let found =
        inverse::hyperbolic_with(&twists(&case["J"]), number(&case["h"]), &options).unwrap();
    assert!(!found.exists);
    assert!(matches!(
        found.reason,
        Some(NoInverse::DampingMeetsEigenvalue { eigenvalue }) if (eigenvalue + 1.0).abs() < 1e-12
    ));
}
