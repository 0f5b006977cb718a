//! Eigenvalues of small symmetric matrices.

use cylindroid::linalg::SymmetricEigen;

use crate::support::Random;

fn check(a: [[f64; 6]; 6], n: usize) -> SymmetricEigen<6> {
    let eigen = SymmetricEigen::of(a, n);
    let size = a.as_flattened().iter().fold(0.0, |m: f64, x| m.max(x.abs()));
    for i in 0..n {
        let v = eigen.vectors[i];
        for r in 0..n {
            let av: f64 = (0..n).map(|c| a[r.min(c)][r.max(c)] * v[c]).sum();
            let difference = (av - eigen.values[i] * v[r]).abs();
            assert!(difference <= 1e-14 * size, "A v = value v: {difference:.1e}");
        }
        for j in 0..n {
            let product: f64 = v.iter().zip(eigen.vectors[j]).map(|(a, b)| a * b).sum();
            assert!((product - f64::from(u8::from(i == j))).abs() < 1e-14, "orthonormal");
        }
    }
    assert!(eigen.values[..n].windows(2).all(|w| w[0] >= w[1]), "largest first");
    eigen
}

#[test]
fn values_and_vectors() {
    let mut random = Random(61);
    for round in 0_i32..600 {
        let n = usize::try_from(round % 7).unwrap();
        let scale = 10_f64.powi(round % 200 - 100);
        // What is below the diagonal is not read.
        let a = [[(); 6]; 6].map(|row| row.map(|()| scale * random.within(-1.0, 1.0)));
        check(a, n);
    }
}

/// Indefinite, singular, with equal values, and zero.
#[test]
fn special_matrices() {
    let mut klein = [[0.0; 6]; 6];
    for i in 0..3 {
        klein[i][i + 3] = 0.5;
    }
    let eigen = check(klein, 6);
    assert_eq!(eigen.values.map(|x| (x * 1e12).round() / 1e12), [0.5, 0.5, 0.5, -0.5, -0.5, -0.5]);
    assert_eq!(check([[0.0; 6]; 6], 6).values, [0.0; 6]);
    let ones = check([[1.0; 6]; 6], 4);
    assert!((ones.values[0] - 4.0).abs() < 1e-14 && ones.values[1].abs() < 1e-15);
    // Only the leading block is read.
    let mut framed = [[f64::NAN; 6]; 6];
    (framed[0][0], framed[0][1], framed[1][1]) = (2.0, 1.0, 2.0);
    let eigen = SymmetricEigen::of(framed, 2);
    assert!((eigen.values[0] - 3.0).abs() < 1e-15 && (eigen.values[1] - 1.0).abs() < 1e-15);
    // Small eigenvalues beside large ones keep their digits when the matrix is nearly diagonal.
    let mut graded = [[0.0; 6]; 6];
    (graded[0][0], graded[1][1], graded[0][1]) = (1.0, 1e-20, 1e-16);
    let small = SymmetricEigen::of(graded, 2).values[1];
    assert!((small - 1e-20).abs() < 1e-30, "{small:e}");
}
