//! The hyperbolic pseudoinverse as control loops take it.

use cylindroid::inverse::{HyperbolicOptions, hyperbolic_into, hyperbolic_with};
use cylindroid::linalg::Matrix;
use cylindroid::screws::ScrewOptions;
use cylindroid::spatial::Vec3;

use crate::support::{Random, assert_matrix};

/// The short way gives what the long way gives, and the same verdict where it hands over.
#[test]
fn independent_columns_as_any() {
    let mut random = Random(41);
    for round in 0..400 {
        let m = 1 + round % 6;
        let mut j = random.matrix(6, m);
        if round % 7 == 0 && m > 1 {
            // A dependent column.
            let first = j.column(0).to_vec();
            j.column_mut(m - 1).copy_from_slice(&first);
        }
        let h = random.within(-2.0, 2.0);
        let center = (round % 3 == 0).then(|| random.vec3(3.0));
        let scale = ScrewOptions { center, ..ScrewOptions::with_length(random.within(0.1, 10.0)) };
        let mut short = Matrix::zeros(m, 6);
        let none = hyperbolic_into(&j, h, &scale, &mut short).unwrap();
        let options = HyperbolicOptions { scale, ..HyperbolicOptions::default() };
        let long = hyperbolic_with(&j, h, &options).unwrap();
        assert_eq!(none, long.reason, "round {round}");
        if none.is_none() {
            let size = long.matrix.max_abs();
            assert_matrix("J+h", &short, &long.matrix, 1e-11 * size * size.max(1.0));
        }
    }
}

#[test]
fn independent_bad_input_is_refused() {
    let scale = ScrewOptions::default();
    let mut out = Matrix::zeros(2, 6);
    let two = Matrix::from_fn(6, 2, |i, j| f64::from(u8::from(i == 3 + j)));
    assert!(hyperbolic_into(&two, f64::NAN, &scale, &mut out).is_err());
    assert!(hyperbolic_into(&two, 0.1, &scale, &mut Matrix::zeros(3, 6)).is_err());
    assert!(hyperbolic_into(&two, 0.1, &ScrewOptions::with_length(0.0), &mut out).is_err());
    let far = ScrewOptions { center: Some(Vec3::X * f64::NAN), ..scale };
    assert!(hyperbolic_into(&two, 0.1, &far, &mut out).is_err());
    let mut nan = two.clone();
    nan[(0, 0)] = f64::NAN;
    assert!(hyperbolic_into(&nan, 0.1, &scale, &mut out).is_err());
    let five = Matrix::zeros(5, 2);
    assert!(hyperbolic_into(&five, 0.1, &scale, &mut out).is_err());
    // Two axes through a point: pitch zero is theirs.
    let none = hyperbolic_into(&two, 0.0, &scale, &mut out).unwrap();
    assert!(none.is_some() && out[(0, 0)].is_nan());
}
