//! The error form of a twist and the pitches at which it vanishes.

use cylindroid::linalg::Matrix;
use cylindroid::screws::{ErrorFormZeros, Line, ScrewOptions, ScrewSystem, gram_determinant};
use cylindroid::spatial::{Twist, Vec3};

use crate::support::{Random, assert_matrix};

const PITCHES: [f64; 5] = [-2.0, -0.4, 0.1, 0.7, 3.0];

fn system(twists: &[Twist]) -> ScrewSystem {
    ScrewSystem::of(twists, &ScrewOptions::default()).unwrap()
}

fn matrix(twists: &[Twist]) -> Matrix {
    Matrix::from_fn(6, twists.len(), |i, j| twists[j].to_array()[i])
}

fn zeros(system: &ScrewSystem, twist: Twist) -> Vec<f64> {
    match system.error_form_zeros(twist).unwrap() {
        ErrorFormZeros::At(zeros) => zeros,
        other => panic!("{other:?}"),
    }
}

/// Phi_h det(J^T Q_h J) = det([J s]^T Q_h [J s]), the same in every frame, and zero at as many
/// pitches as the system with the twist has principal ones.
#[test]
fn it_is_a_quotient_of_determinants() {
    let mut random = Random(61);
    for count in 0..6 {
        for _ in 0..20 {
            let twists: Vec<Twist> = (0..count).map(|_| random.twist()).collect();
            let s = random.twist();
            let all = [&twists[..], &[s]].concat();
            let (here, pose) = (system(&twists), random.pose());
            let there = system(&twists.iter().map(|t| pose.adjoint(*t)).collect::<Vec<_>>());
            for h in PITCHES {
                let Some(form) = here.error_form(s, h) else { continue };
                if here.projector_norm(h) > 1e3 {
                    continue;
                }
                let below = gram_determinant(&matrix(&twists), h).unwrap();
                let above = gram_determinant(&matrix(&all), h).unwrap();
                let size = 1e-10 * (1.0 + below.abs() * form.abs());
                assert!((form * below - above).abs() < size, "{count}: {form} {below} {above}");
                let moved = there.error_form(pose.adjoint(s), h).unwrap();
                assert!((moved - form).abs() < 1e-7 * (1.0 + form.abs()), "{moved} {form}");
            }
            let found = zeros(&here, s);
            assert_eq!(found.len(), [1, 2, 3, 2, 1, 0][count], "{count}");
            for h in found {
                let (form, norm) = (here.error_form(s, h).unwrap(), here.projector_norm(h));
                assert!(
                    form.abs() < 1e-11 * (1.0 + norm * norm) * (1.0 + h.abs()),
                    "{count}: {form:e}"
                );
                let moved = zeros(&there, pose.adjoint(s));
                assert!(moved.iter().any(|z| (z - h).abs() < 1e-7 * (1.0 + h.abs())));
            }
        }
    }
}

/// No joint velocities near J+h s change the form to first order.
#[test]
fn it_is_stationary() {
    let mut random = Random(62);
    for _ in 0..50 {
        let twists: Vec<Twist> = (0..3).map(|_| random.twist()).collect();
        let (here, s) = (system(&twists), random.twist());
        let Some(projector) = here.projector(0.3).filter(|p| p.norm() < 1e2) else { continue };
        let form = here.error_form(s, 0.3).unwrap();
        for t in twists {
            let other = |step: f64| {
                let rest = s - projector.motion(s) - t * step;
                rest.pitch_form(rest, 0.3)
            };
            assert!((other(1e-3) - other(-1e-3)).abs() < 1e-9, "{form}");
            let curvature = (other(1e-3) - form) / 1e-6;
            assert!((curvature - t.pitch_form(t, 0.3)).abs() < 1e-6);
        }
    }
}

#[test]
fn members_have_no_error_and_some_systems_no_form() {
    let mut random = Random(63);
    let twists = [random.twist(), random.twist()];
    let member = twists[0] * 0.7 - twists[1] * 2.0;
    assert_eq!(system(&twists).error_form_zeros(member), Ok(ErrorFormZeros::Everywhere));
    assert_eq!(system(&twists).error_form_zeros(Twist::ZERO), Ok(ErrorFormZeros::Everywhere));

    let turn = |angular| Twist { linear: Vec3::ZERO, angular };
    let slide = |linear| Twist { linear, angular: Vec3::ZERO };
    let planar = system(&[slide(Vec3::X), slide(Vec3::Y), turn(Vec3::Z)]);
    assert_eq!(planar.error_form_zeros(random.twist()), Ok(ErrorFormZeros::Undefined));
    assert!(planar.error_form(random.twist(), 0.3).is_none());

    // A translation across the axis is isotropic in every form, and so is what is discarded of it.
    let revolute = system(&[turn(Vec3::Z)]);
    assert_eq!(revolute.error_form_zeros(slide(Vec3::X)), Ok(ErrorFormZeros::Everywhere));
    for h in PITCHES {
        assert!(revolute.error_form(slide(Vec3::X), h).unwrap().abs() < 1e-15);
    }
    // One along it is not: Phi_h = -(1/2)^2 / (0 - h).
    assert_eq!(zeros(&revolute, slide(Vec3::Z)), [0.0; 0]);
    for h in PITCHES {
        let form = revolute.error_form(slide(Vec3::Z), h).unwrap();
        assert!((form - 0.25 / h).abs() < 1e-12);
    }
    // At the pitch of the joint there is no form, although the quotient has a limit.
    assert_eq!(zeros(&revolute, turn(Vec3::X)), [0.0; 0]);
    // Without joints the error is the twist, which vanishes in the form of its own pitch.
    let screw = Twist { linear: Vec3::Y * 0.4, angular: Vec3::Y };
    assert!((zeros(&system(&[]), screw)[0] - 0.4).abs() < 1e-15);
    // Six joints leave no error.
    let six: Vec<Twist> = (0..6).map(|_| random.twist()).collect();
    assert_eq!(system(&six).error_form_zeros(screw), Ok(ErrorFormZeros::Everywhere));
    let bad = Twist { linear: Vec3::X * f64::NAN, angular: Vec3::Z };
    assert!(system(&six).error_form_zeros(bad).is_err());
}

/// P* = 1 - P^T: the wrenches that do no work on the system.
#[test]
fn the_projector_of_wrenches() {
    let mut random = Random(64);
    for count in 0..6 {
        let twists: Vec<Twist> = (0..count).map(|_| random.twist()).collect();
        let here = ScrewSystem::of(&twists, &ScrewOptions::with_length(0.3)).unwrap();
        let Some(projector) = here.projector(0.9) else { continue };
        let (p, wrenches) = (projector.matrix(), projector.constraint_matrix());
        let unit = |i: usize, j: usize| f64::from(u8::from(i == j));
        let expected = Matrix::from_fn(6, 6, |i, j| unit(i, j) - p[(j, i)]);
        assert_matrix("P*", &wrenches, &expected, 1e-10 * (1.0 + p.max_abs()));
        let work = &wrenches.transpose() * &matrix(&twists);
        assert!(work.max_abs() < 1e-9 * (1.0 + p.max_abs()));
    }
    let axis = Line { point: Vec3::X, direction: Vec3::Z };
    let one = system(&[axis.twist()]).projector(0.5).unwrap().constraint_matrix();
    assert!((&one * &one).max_difference(&one) < 1e-15);
}
