//! Classes, principal pitches, existence and projectors of all normal forms, and their frames.

use cylindroid::inverse;
use cylindroid::linalg::Matrix;
use cylindroid::screws::{ScrewOptions, ScrewSystem};
use cylindroid::spatial::{Mat3, Pose, Rotation, Twist, Vec3};

use super::{
    number, numbers, operator, plain, rates, reference, scaled_tolerance, twists, with_length,
};
use crate::support::assert_matrix;

#[test]
fn normal_forms() {
    for case in reference()["normal_forms"].as_array().unwrap() {
        let j = twists(&case["J"]);
        let length = number(&case["L"]);
        let name = format!("{} {} L = {length}", case["k"], case["class"]);
        let options = ScrewOptions::with_length(length);
        let system = ScrewSystem::of_columns(&j, &options).unwrap();
        assert_eq!(system.order() as u64, case["k"].as_u64().unwrap(), "{name}");
        assert_eq!(system.class().name(), case["class"].as_str().unwrap(), "{name}");
        assert!(!system.is_ambiguous(), "{name}: {:?}", system.margins());
        assert!(system.residual() < 1e-9, "{name}: {}", system.residual());
        let close = |got: &[f64], expected: &[f64]| {
            assert_eq!(got.len(), expected.len(), "{name}: {got:?} {expected:?}");
            for (g, e) in got.iter().zip(expected) {
                assert!((g - e).abs() < 1e-9 * length, "{name}: {got:?} {expected:?}");
            }
        };
        let form = system.normal_form();
        close(&form.pitches, &numbers(&case["nf_pitches"]));
        close(&system.principal_pitches(), &numbers(&case["principal_pitches"]));
        match case["p"].as_f64() {
            Some(p) => assert!((form.slope.unwrap() - p).abs() < 1e-9, "{name}"),
            None => assert!(form.slope.is_none(), "{name}"),
        }
        assert_eq!(
            system.class().never_invertible() && system.order() != 0,
            case["never"].as_bool().unwrap(),
            "{name}"
        );
        for screw in system.principal_screws() {
            let twist = screw.twist();
            assert!(system.sine_to(twist) < 1e-9, "{name}: principal screw is of the system");
            for other in system.basis() {
                let size = length.max(screw.axis.point.norm());
                let form = twist.pitch_form(other, screw.pitch);
                assert!(form.abs() < 1e-9 * size, "{name}: radical, {form}");
            }
        }
        for (h, exists) in case["exists"].as_object().unwrap() {
            let h: f64 = h.parse().unwrap();
            let existence = system.existence(h);
            assert_eq!(
                existence.exists,
                exists.as_bool().unwrap(),
                "{name} h = {h}: {existence:?}"
            );
            assert_eq!(existence.reason.is_none(), existence.exists, "{name}");
            let inverse = inverse::hyperbolic_with(&j, h, &with_length(length)).unwrap();
            assert_eq!((inverse.exists, inverse.reason), (existence.exists, existence.reason));
        }
        // At L and the origin: the entries of a projector have the units of their places.
        let unit = |m: &Matrix| {
            let s = |i: usize| if i < 3 { length } else { 1.0 };
            Matrix::from_fn(6, 6, |a, b| m[(a, b)] * s(b) / s(a))
        };
        if !case["P_h_0.37L"].is_null() {
            let h = 0.37 * length;
            let expected = unit(&operator(&case["P_h_0.37L"]));
            let got = unit(&system.projector(h).unwrap().matrix());
            assert_matrix(
                &format!("{name} P_h"),
                &got,
                &expected,
                scaled_tolerance(&expected, 1e-9),
            );
            let inverse = inverse::hyperbolic_with(&j, h, &with_length(length)).unwrap();
            let expected = rates(&case["Jph_0.37L"]);
            let relative = |m: &Matrix| {
                Matrix::from_fn(m.rows(), 6, |a, b| m[(a, b)] * if b < 3 { length } else { 1.0 })
            };
            let (got, expected) = (relative(&inverse.matrix), relative(&expected));
            assert_matrix(
                &format!("{name} J+h"),
                &got,
                &expected,
                scaled_tolerance(&expected, 1e-9),
            );
        }
        match system.projector(f64::INFINITY) {
            Some(p) => {
                let expected = unit(&operator(&case["P_inf"]));
                let got = unit(&p.matrix());
                let name = format!("{name} P_inf");
                assert_matrix(&name, &got, &expected, scaled_tolerance(&expected, 1e-9));
            }
            None => assert!(case["P_inf"].is_null(), "{name}"),
        }
        // The reciprocal system, and the span itself, as orthogonal projectors at the origin.
        let span = orthogonal(&system.basis(), length);
        let expected = operator(&case["projector_span"]);
        if length == 1.0 {
            assert_matrix(&name, &span, &expected, 1e-9);
            let reciprocal = orthogonal(&system.reciprocal().basis(), length);
            let expected = operator(&case["projector_reciprocal"]);
            assert_matrix(&name, &reciprocal, &expected, 1e-9);
        }
    }
}

/// The orthogonal projector on the span of twists, linear parts over `length`, at the origin.
fn orthogonal(basis: &[Twist], length: f64) -> Matrix {
    let scaled = Matrix::from_fn(6, basis.len(), |i, j| {
        basis[j].to_array()[i] / if i < 3 { length } else { 1.0 }
    });
    let plus = inverse::truncated(&scaled, 1e-9).unwrap().matrix;
    &scaled * &plus
}

/// The canonical frame of the reference, where it is determined up to symmetries: the normal form
/// placed there spans the same system as ours.
#[test]
fn canonical_frames() {
    for case in reference()["normal_forms"].as_array().unwrap() {
        let length = number(&case["L"]);
        let j = twists(&case["J"]);
        let system = ScrewSystem::of_columns(&j, &ScrewOptions::with_length(length)).unwrap();
        let r = plain(&case["frame_R"]);
        let t = numbers(&case["frame_t"]);
        let rows = [0, 1, 2].map(|i| [0, 1, 2].map(|k| r[(i, k)]));
        let theirs = Pose {
            rotation: Rotation::from_matrix(Mat3::from_rows(rows)).unwrap(),
            translation: Vec3::new(t[0], t[1], t[2]),
        };
        for pose in [theirs, system.canonical_pose()] {
            let placed: Vec<Twist> =
                system.normal_form().twists().into_iter().map(|g| pose.adjoint(g)).collect();
            let options =
                ScrewOptions { center: Some(system.center()), ..ScrewOptions::with_length(length) };
            let placed = ScrewSystem::of(&placed, &options).unwrap();
            let placed = if system.order() > 3 { placed.reciprocal() } else { placed };
            let sine = system.sine_to_system(&placed);
            assert!(sine < 1e-8, "{} {}: {sine}", case["k"], case["class"]);
        }
    }
}
