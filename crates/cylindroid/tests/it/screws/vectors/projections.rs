//! Projectors of wrenches, and along another system.

use cylindroid::inverse::{self, HyperbolicOptions};
use cylindroid::screws::{ScrewOptions, ScrewSystem};
use cylindroid::spatial::Wrench;

use super::{number, operator, rates, reference, scaled_tolerance, twists};
use crate::support::{assert_close, assert_matrix};

#[test]
fn wrench_side() {
    for case in reference()["wrench_side"].as_array().unwrap() {
        let (j, h) = (twists(&case["J"]), number(&case["h"]));
        let system = ScrewSystem::of_columns(&j, &ScrewOptions::default()).unwrap();
        let projector = system.projector(h).unwrap();
        assert_matrix("P_h", &projector.matrix(), &operator(&case["P_h"]), 1e-12);
        let expected = operator(&case["Pstar_h"]);
        for c in 0..6 {
            let mut unit = [0.0; 6];
            unit[c] = 1.0;
            let image = projector.constraint(Wrench::from_array(unit)).to_array();
            assert_close("P*_h", &image, expected.column(c), 1e-12);
        }
        // The pseudoinverse of the annihilator's basis gives the same projector.
        let w = twists(&case["W_basis_of_annihilator"]);
        assert_matrix("W W+h", &(&w * &rates(&case["Wph"])), &expected, 1e-12);
    }
}

#[test]
fn oblique() {
    for case in reference()["general_projection"].as_array().unwrap() {
        let (j, z) = (twists(&case["J"]), twists(&case["Z"]));
        let expected = operator(&case["P"]);
        let tolerance = scaled_tolerance(&expected, 1e-12);
        let inverse = inverse::oblique(&j, &z, &HyperbolicOptions::default()).unwrap();
        assert!(inverse.exists);
        assert_matrix("J J+", &(&j * &inverse.matrix), &expected, tolerance);
        let [s, t] =
            [&j, &z].map(|m| ScrewSystem::of_columns(m, &ScrewOptions::default()).unwrap());
        assert_matrix("P", &s.projector_along(&t).unwrap().matrix(), &expected, tolerance);
    }
}
