//! The examples of the paper, and a Jacobian without full rank.

use cylindroid::inverse::{self, HyperbolicDamping, HyperbolicOptions};
use cylindroid::screws::{Class, ErrorFormZeros, NoInverse, ScrewOptions, ScrewSystem};
use cylindroid::spatial::Vec3;

use super::{
    column, number, numbers, operator, plain, rates, reference, scaled_tolerance, swap, twists,
};
use crate::support::assert_matrix;

#[test]
fn examples_1_and_4() {
    let data = &reference()["example1_4"];
    let j = twists(&data["J"]);
    let system = ScrewSystem::of_columns(&j, &ScrewOptions::default()).unwrap();
    assert_eq!(system.class().name(), data["class"].as_str().unwrap());
    assert!((system.normal_form().slope.unwrap() - number(&data["p"])).abs() < 1e-12);
    assert!(system.principal_pitches()[0].abs() < 1e-14);
    let s = twists(&data["s"]);
    for case in data["cases"].as_array().unwrap() {
        let h = number(&case["h"]);
        let inverse = inverse::hyperbolic(&j, h).unwrap();
        assert!(inverse.exists && inverse.reason.is_none());
        let expected = rates(&case["Jph"]);
        assert_matrix("J+h", &inverse.matrix, &expected, 1e-12);
        assert_matrix("P_h", &(&j * &inverse.matrix), &operator(&case["P_h"]), 1e-12);
        let projector = system.projector(h).unwrap();
        assert_matrix("P_h", &projector.matrix(), &operator(&case["P_h"]), 1e-12);
        let v = &inverse.matrix * &s;
        assert_matrix("v", &v, &plain(&case["v_for_s"]), 1e-12);
        let rest = column(&s, 0) - column(&(&j * &v), 0);
        assert!((rest.pitch_form(rest, h) - number(&case["Phi_half"])).abs() < 1e-12);
        let error = system.error_form(column(&s, 0), h).unwrap();
        assert!((error - number(&case["Phi_half"])).abs() < 1e-12);

        let damped = inverse::hyperbolic_with(
            &j,
            h,
            &HyperbolicOptions {
                damping: HyperbolicDamping::Gram { lambda: 1.0 },
                ..HyperbolicOptions::default()
            },
        )
        .unwrap();
        let expected = rates(&case["damped_Lambda_I"]);
        assert_matrix("damped", &damped.matrix, &expected, scaled_tolerance(&expected, 1e-12));
    }
    // Phi_h = -9 (80 h^2 + 64 h - 25) / (1600 h).
    let ErrorFormZeros::At(zeros) = system.error_form_zeros(column(&s, 0)).unwrap() else {
        panic!("two zeros");
    };
    let root = 3.0 * 21_f64.sqrt();
    assert_eq!(zeros.len(), 2);
    assert!((zeros[0] - (-8.0 + root) / 20.0).abs() < 1e-13, "{zeros:?}");
    assert!((zeros[1] - (-8.0 - root) / 20.0).abs() < 1e-13, "{zeros:?}");
    // h = 0 is the principal pitch.
    assert!(system.error_form(column(&s, 0), 0.0).is_none());
    let none = inverse::hyperbolic(&j, 0.0).unwrap();
    assert!(!none.exists && none.matrix[(0, 0)].is_nan());
    assert!(
        matches!(none.reason, Some(NoInverse::PrincipalPitch { pitch }) if pitch.abs() < 1e-12)
    );
}

/// The symbolic entries, with the corrected one of row 3 and column 2.
#[test]
fn example_1_symbolic() {
    let j = twists(&reference()["example1_4"]["J"]);
    for h in [0.3, -0.7, 2.0, 11.0] {
        let m = inverse::hyperbolic(&j, h).unwrap().matrix;
        // In the order of the paper (angular first): entries (2,2) and (3,2).
        let entry = -(16.0 * h * h + 16.0 * h + 3.0) / (32.0 * h);
        assert!((m[(1, swap(1))] - entry).abs() < 1e-12);
        let corrected = (16.0 * h * h + 16.0 * h - 1.0) / (32.0 * h);
        assert!((m[(2, swap(1))] - corrected).abs() < 1e-12);
    }
}

#[test]
fn example_2() {
    for case in reference()["example2"]["cases"].as_array().unwrap() {
        let j = twists(&case["J"]);
        let inverse = inverse::hyperbolic(&j, number(&case["h"])).unwrap();
        assert!(inverse.exists);
        assert_matrix("J+h", &inverse.matrix, &rates(&case["Jph"]), 1e-12);
        assert_matrix("P_h", &(&j * &inverse.matrix), &operator(&case["P_h"]), 1e-12);
    }
}

/// The set of rates is {rates : J rates in S}, of dimension one; the image of S under the
/// pseudoinverse, which the paper gives, is all of R^3.
#[test]
fn example_3() {
    let data = &reference()["example3"];
    let j = twists(&data["J"]);
    let (x, q) = (numbers(&data["x"]), numbers(&data["q"]));
    let vec3 = |v: &[f64]| Vec3::new(v[0], v[1], v[2]);
    let found = inverse::point_direction(&j, vec3(&x), vec3(&q)).unwrap();
    let expected = numbers(&data["correct_solution_direction"]);
    let norm = expected.iter().map(|e| e * e).sum::<f64>().sqrt();
    let set: Vec<Vec<f64>> = found
        .along
        .iter()
        .cloned()
        .chain((0..found.still.cols()).map(|c| found.still.column(c).to_vec()))
        .collect();
    assert_eq!(set.len(), data["dim_correct"].as_u64().unwrap() as usize);
    let length = set[0].iter().map(|e| e * e).sum::<f64>().sqrt();
    let cosine: f64 = set[0].iter().zip(&expected).map(|(a, b)| a * b).sum();
    assert!((cosine.abs() - length * norm).abs() < 1e-12 * length * norm);

    let s = twists(&data["S_basis"]);
    let four = ScrewSystem::of_columns(&s, &ScrewOptions::default()).unwrap();
    assert_eq!((four.order(), four.class()), (4, Class::IIA));
    let image = &inverse::hyperbolic(&j, 1.0).unwrap().matrix * &s;
    assert_eq!(cylindroid::linalg::Svd::of(&image).machine_rank().rank, 3);
}

#[test]
fn rank_deficient() {
    for case in reference()["rank_deficient"].as_array().unwrap() {
        let j = twists(&case["J"]);
        let inverse = inverse::hyperbolic(&j, number(&case["h"])).unwrap();
        assert_eq!(inverse.rank, case["rank"].as_u64().unwrap() as usize);
        let expected = rates(&case["Jph"]);
        assert_matrix("J+h", &inverse.matrix, &expected, scaled_tolerance(&expected, 1e-12));
        let plain = inverse::truncated(&j, 1e-12).unwrap().matrix;
        let equal = plain.max_difference(&expected) < 1e-9;
        assert_eq!(equal, case["equals_moore_penrose"].as_bool().unwrap());
    }
}
