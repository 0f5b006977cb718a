//! Laws of the projectors, of systems made from systems, and of the choice of a pitch.

use cylindroid::Matrix;
use cylindroid::linalg::{ColumnSpace, Svd, Threshold};
use cylindroid::screws::{Class, NoInverse, ScrewOptions, ScrewSystem};
use cylindroid::spatial::{Pose, Twist, Vec3, Wrench};

use super::laws::{Case, adjoint_matrix, cases, form_matrix};
use super::sample::{CLASSES, Form, Setting, matrix, system};
use crate::support::{Random, assert_matrix};

fn spanned(case: &Case) -> ScrewSystem {
    ScrewSystem::of_columns(&case.j, &ScrewOptions::default()).unwrap()
}

fn subtract(a: &Matrix, b: &Matrix) -> Matrix {
    Matrix::from_fn(a.rows(), a.cols(), |i, j| a[(i, j)] - b[(i, j)])
}

fn minus(b: &Matrix) -> Matrix {
    subtract(&Matrix::identity(6), b)
}

#[test]
fn projectors_of_twists() {
    cases(21, 30, |random, case| {
        let (s, h) = (spanned(case), case.h);
        assert_eq!(s.projector(h).is_none(), case.never, "{:?}", case.form);
        let Some(projector) = s.projector(h) else { return };
        let p = projector.matrix();
        let size = 1e-13 * (1.0 + p.frobenius_norm()).powi(2);
        assert_matrix("P P = P", &(&p * &p), &p, size);
        assert_matrix("P J = J", &(&p * &case.j), &case.j, size * case.j.frobenius_norm());
        let trace: f64 = (0..6).map(|i| p[(i, i)]).sum();
        assert!((trace - case.form.order as f64).abs() < size, "rank");
        // Along the h-reciprocal system, whose projector is the rest.
        let other = s.h_reciprocal(h);
        assert_eq!(other.order(), 6 - s.order());
        let k = matrix(&other.basis());
        let gram = &(&case.j.transpose() * &form_matrix(h)) * &k;
        let zero = Matrix::zeros(case.j.cols(), k.cols());
        assert_matrix("h-reciprocal", &gram, &zero, size * case.j.frobenius_norm());
        assert_matrix("P K = 0", &(&p * &k), &Matrix::zeros(6, k.cols()), size);
        let rest = other.projector(h).unwrap().matrix();
        assert_matrix("P + P(perp) = 1", &rest, &minus(&p), size * 10.0);
        let t = random.twist();
        let sum = projector.motion(t) + projector.rest(t) - t;
        assert!(sum.to_array().iter().all(|x| x.abs() <= 1e-15 * (1.0 + p.max_abs())));
    });
}

/// 1 - P^T: onto the wrenches that do no work on the system, in numbers that no frame changes.
#[test]
fn projectors_of_wrenches() {
    cases(22, 15, |random, case| {
        let Some(projector) = spanned(case).projector(case.h) else { return };
        let p = projector.matrix();
        let images: Vec<[f64; 6]> = (0..6)
            .map(|j| std::array::from_fn(|i| f64::from(u8::from(i == j))))
            .map(|unit| projector.constraint(Wrench::from_array(unit)).to_array())
            .collect();
        let dual = Matrix::from_fn(6, 6, |i, j| images[j][i]);
        let size = 1e-13 * (1.0 + p.frobenius_norm()).powi(2);
        assert_matrix("1 - P^T", &dual, &minus(&p).transpose(), size);
        assert_matrix("idempotent", &(&dual * &dual), &dual, size);
        let work = &case.j.transpose() * &dual;
        let zero = Matrix::zeros(case.j.cols(), 6);
        assert_matrix("no work", &work, &zero, size * case.j.frobenius_norm());
        // The power is shared out: the motion with what is dropped, the rest with what is kept.
        let (t, f) = (random.twist(), Wrench::from_array(random.twist().to_array()));
        let kept = projector.constraint(f);
        let power = projector.motion(t).power(f - kept) + projector.rest(t).power(kept);
        assert!((power - t.power(f)).abs() < size);
    });
}

#[test]
fn projectors_move_with_the_frame() {
    cases(23, 9, |random, case| {
        let s = spanned(case);
        for h in [case.h, f64::INFINITY] {
            let Some(p) = s.projector(h).map(|p| p.matrix()) else { continue };
            for far in [1.0, 1e3] {
                let pose = Pose { rotation: random.rotation(), translation: random.vec3(far) };
                let (there, back) = (adjoint_matrix(pose), adjoint_matrix(pose.inverse()));
                let moved =
                    ScrewSystem::of_columns(&(&there * &case.j), &ScrewOptions::default()).unwrap();
                let got = &(&back * &moved.projector(h).unwrap().matrix()) * &there;
                // The way there and back are entries of the size of the distance each.
                let size = 1e-13 * (1.0 + p.frobenius_norm()).powi(2) * (1.0 + far * far);
                assert_matrix("Ad^-1 P Ad", &got, &p, size);
            }
        }
    });
}

/// Type A: P_h = sum s_i s_i^T Q_h / (h_i - h) over the principal screws of amplitude one.
#[test]
fn spectral_form() {
    let mut random = Random(24);
    for (order, class) in CLASSES {
        if order > 3 || !matches!(class.name(), "h" | "IA" | "IIA" | "IA1" | "IA2") {
            continue;
        }
        for _ in 0..50 {
            let form = Form::random(&mut random, order, class);
            let (s, _, pose) = system(&mut random, &form, 2, &Setting::PLAIN);
            let h = 2.3 + random.within(0.0, 3.0);
            let mut expected = Matrix::zeros(6, 6);
            for row in form.rows() {
                let screw = Twist::from_array(row);
                let pitch = screw.linear.dot(screw.angular);
                let screw = matrix(&[pose.adjoint(screw)]);
                let term = &(&screw * &screw.transpose()) * &form_matrix(h);
                expected =
                    Matrix::from_fn(6, 6, |i, j| expected[(i, j)] + term[(i, j)] / (pitch - h));
            }
            let p = s.projector(h).unwrap().matrix();
            assert_matrix(class.name(), &p, &expected, 1e-12 * (1.0 + p.frobenius_norm()));
        }
    }
}

/// Order 5: P_h = 1 - z_h z^T Q_0 / (|w|^2 (h_z + h)), z the reciprocal screw and z_h = (w, v + 2 h w).
#[test]
fn closed_form_of_order_five() {
    let mut random = Random(25);
    for _ in 0..200 {
        let form = Form::random(&mut random, 5, Class::H);
        let (s, _, pose) = system(&mut random, &form, 1, &Setting::PLAIN);
        let z = pose.adjoint(Twist::from_array(form.rows()[0])) * random.within(0.5, 2.0);
        let h = 0.4 - form.pitches[0] + random.within(0.0, 3.0);
        let shifted = Twist { linear: z.linear + z.angular * (2.0 * h), ..z };
        let outer = &matrix(&[shifted]) * &(&matrix(&[z]).transpose() * &form_matrix(0.0));
        let factor = z.angular.dot(z.angular) * (form.pitches[0] + h);
        let expected = minus(&Matrix::from_fn(6, 6, |i, j| outer[(i, j)] / factor));
        let p = s.projector(h).unwrap().matrix();
        assert_matrix("P_h", &p, &expected, 1e-12 * (1.0 + p.frobenius_norm()));
    }
}

/// P_h comes to P_inf with 1/h where that exists, and grows without bound where it does not.
#[test]
fn infinite_pitch_is_the_limit() {
    cases(26, 12, |_, case| {
        let s = spanned(case);
        let existence = s.existence(f64::INFINITY);
        assert_eq!(existence.exists, s.projector(f64::NEG_INFINITY).is_some());
        let at = |h: f64| s.projector(h).map(|p| p.matrix());
        if let Some(limit) = at(f64::INFINITY) {
            assert!(existence.reason.is_none() && !case.never);
            let size = 1e-13 * (1.0 + limit.frobenius_norm()).powi(2);
            assert_matrix("P P = P", &(&limit * &limit), &limit, size);
            for h in [1e4, -1e4] {
                let [near, nearer] = [h, 10.0 * h].map(|h| at(h).unwrap().max_difference(&limit));
                assert!(nearer <= 0.11 * near + 1e-9, "{:?}: {near} {nearer}", case.form);
                assert!(near < 1e-2, "{:?}: {near}", case.form);
            }
        } else if case.never {
            assert!(matches!(existence.reason, Some(NoInverse::Class { .. })));
        } else {
            assert!(matches!(existence.reason, Some(NoInverse::NoLimit { .. })));
            let [near, nearer] = [1e3, 1e4].map(|h| at(h).unwrap().frobenius_norm());
            // Bounded for slope 0 alone, next to which are slopes where it is not.
            let grows = case.form.slope != Some(0.0);
            assert_eq!(nearer > 5.0 * near, grows, "{:?}: {near} {nearer}", case.form);
            assert_eq!(nearer < 1.1 * near, !grows, "{:?}: {near} {nearer}", case.form);
        }
    });
}

/// Of order five, P = 1 - m n^T / (n . m) with n normal to the system and Q_h m = n: the largest
/// factor is |m| |n| / |n . m|, at the centre and over the length.
#[test]
fn norm_of_order_five() {
    let mut random = Random(1613);
    for _ in 0..50 {
        let length = 10_f64.powf(random.within(-2.0, 2.0));
        let center = random.vec3(2.0 * length);
        let scaled = random.matrix(6, 5);
        let twists: Vec<Twist> = (0..5)
            .map(|j| {
                let x: [f64; 6] = std::array::from_fn(|i| scaled[(i, j)]);
                let t = Twist::from_array(x);
                Twist { linear: t.linear * length, ..t }.at_point(-center)
            })
            .collect();
        let options = ScrewOptions { center: Some(center), ..ScrewOptions::with_length(length) };
        let system = ScrewSystem::of(&twists, &options).unwrap();
        let normal = Twist::from_array(std::array::from_fn({
            let n = ColumnSpace::of(&scaled, Threshold::Absolute(1e-9)).complement();
            move |i| n[(i, 0)]
        }));
        let h = random.within(-2.0, 2.0);
        let along = Twist {
            linear: (normal.angular + normal.linear * (2.0 * h)) * 2.0,
            angular: normal.linear * 2.0,
        };
        let product = |a: Twist, b: Twist| a.linear.dot(b.linear) + a.angular.dot(b.angular);
        let [m, n] = [along, normal].map(|x| product(x, x).sqrt());
        let expected = m * n / product(along, normal).abs();
        let found = system.projector_norm(h * length);
        assert!((found / expected - 1.0).abs() < 1e-9, "{found} {expected}");
    }
}

#[test]
fn the_chosen_pitch_is_the_best() {
    cases(27, 9, |random, case| {
        let s = spanned(case);
        let choice = s.choose_pitch();
        assert_eq!(choice.pitch.is_none(), case.never, "{:?}", case.form);
        assert_eq!(choice.norm_at_infinity, s.projector_norm(f64::INFINITY));
        assert!(choice.curve.windows(2).all(|w| w[0].0 < w[1].0));
        // A thousandth of the length to ten lengths, of both signs, and zero.
        assert_eq!(choice.curve.len(), 2 * (4 * 24 + 1) + 1);
        for (h, norm) in &choice.curve {
            assert_eq!(*norm, s.projector_norm(*h));
            // Up to the millionth for which a round number is kept.
            assert!(choice.norm <= norm * (1.0 + 2e-6), "{:?} {h}: {norm}", case.form);
        }
        assert!(choice.norm <= choice.norm_at_infinity);
        // Between the pitches of the curve, too, and nearby.
        let near =
            choice.pitch.filter(|h| h.is_finite()).map_or(vec![], |h| vec![0.97 * h, 1.03 * h]);
        for h in (0..50).map(|_| random.within(-4.0, 4.0)).chain(near) {
            let norm = s.projector_norm(h);
            assert!(choice.norm <= norm * (1.0 + 2e-6), "{:?} {h}: {norm} {choice:?}", case.form);
        }
        match choice.pitch {
            Some(h) => assert_eq!(choice.norm, s.projector_norm(h)),
            None => assert_eq!(choice.norm, f64::INFINITY),
        }
        if !choice.attained {
            let h = choice.pitch.unwrap();
            assert!(h.is_finite() && choice.norm_at_infinity.is_infinite());
            assert!(s.projector_norm(2.0 * h) < choice.norm, "{:?} {h}", case.form);
        }
    });
    // Two directions of one pitch: nothing is as small as the limit. The limit of a rotation and a
    // translation that leans does not exist.
    let mut random = Random(28);
    for _ in 0..20 {
        let (a, ..) = system(
            &mut random,
            &Form { slope: Some(1.0), ..Form::random(&mut Random(1), 2, Class::IB) },
            0,
            &Setting::PLAIN,
        );
        let choice = a.choose_pitch();
        assert!(choice.pitch.unwrap().is_finite() && choice.attained);
        let form = Form { pitches: vec![0.0], ..Form::random(&mut Random(1), 3, Class::IIA) };
        let (b, ..) = system(&mut random, &form, 0, &Setting::PLAIN);
        let choice = b.choose_pitch();
        assert!(choice.pitch == Some(f64::INFINITY) && choice.attained);
    }
    // Example 2 of Donelan & Selig: |P_h| falls to 1 as |h| grows, and P_inf does not exist.
    let arm = [
        Twist { linear: Vec3::ZERO, angular: Vec3::Z },
        Twist { linear: Vec3::ZERO, angular: Vec3::X },
        Twist { linear: Vec3::Z * -0.4, angular: Vec3::X },
    ];
    let choice = ScrewSystem::of(&arm, &ScrewOptions::default()).unwrap().choose_pitch();
    assert!(!choice.attained && choice.norm_at_infinity.is_infinite());
}

/// A screw of pitch p has |P_h|^2 = 1 - p x + (1 + p^2) x^2 / 4 with x = 1 / (p - h), in units of the
/// length: 1 at x = 2 p / (1 + p^2), and sqrt(1 + p^2) in the limit.
#[test]
fn the_limit_is_chosen_where_it_is_as_small_to_a_millionth() {
    let choice = |p: f64| {
        let screw = Twist { linear: Vec3::Z * p, angular: Vec3::Z };
        let system = ScrewSystem::of(&[screw], &ScrewOptions::with_length(1.0)).unwrap();
        let choice = system.choose_pitch();
        let limit = (1.0 + p * p).sqrt();
        assert!((choice.norm_at_infinity - limit).abs() < 1e-12, "{choice:?}");
        choice
    };
    // 0.85 and 1.2 millionths above the smallest; a fifth and a quarter.
    for (p, is_limit) in [(1.3e-3, true), (1.55e-3, false), (0.66, false), (0.75, false)] {
        for p in [p, -p] {
            let found = choice(p);
            assert!(found.attained && found.norm < 1.0 + 1e-6, "{p}: {found:?}");
            let best = p - (1.0 + p * p) / (2.0 * p);
            match found.pitch {
                Some(f64::INFINITY) => assert!(is_limit, "{p}"),
                Some(h) => {
                    assert!(!is_limit && found.norm < 1.0 + 1e-9, "{p}: {h} {}", found.norm);
                    // The norm is flat there: its root of rounding.
                    let flat = 1e-4 * best.abs().max(1.0);
                    assert!((h - best).abs() < flat * best.abs().max(1.0), "{p}: {h} {best}");
                }
                None => panic!("{p}: {found:?}"),
            }
        }
    }
    // The whole space: all projectors are the identity, and none is smaller.
    let all: Vec<Twist> = (0..6)
        .map(|i| Twist::from_array(std::array::from_fn(|j| f64::from(u8::from(i == j)))))
        .collect();
    let whole = ScrewSystem::of(&all, &ScrewOptions::with_length(1.0)).unwrap().choose_pitch();
    assert!((whole.norm - 1.0).abs() < 1e-12 && whole.attained, "{whole:?}");
    assert_eq!(whole.pitch, Some(f64::INFINITY));
}

#[test]
fn reciprocal_of_reciprocal() {
    cases(29, 9, |random, case| {
        let s = spanned(case);
        let r = s.reciprocal();
        assert_eq!(r.order(), 6 - s.order());
        assert!(r.reciprocal().sine_to_system(&s) < 1e-13);
        assert!(s.sine_to_system(&r.reciprocal()) < 1e-13);
        for h in [case.h, -40.0] {
            let back = s.h_reciprocal(h).h_reciprocal(h);
            assert!(back.sine_to_system(&s) < 1e-12 * (1.0 + h * h), "{h}");
        }
        // Its wrenches do no work on the system.
        for z in r.basis() {
            let t =
                s.basis().into_iter().fold(Twist::ZERO, |t, b| t + b * random.within(-1.0, 1.0));
            assert!(t.power(z.lowered(0.0)).abs() < 1e-13 * (1.0 + s.center().norm()));
        }
        // The form at infinity sees the angular part alone.
        let turning = Matrix::from_fn(3, s.order(), |i, j| s.basis()[j].angular[i]);
        let dimension = Svd::of(&turning).values().filter(|x| *x > 1e-9).count();
        let at_infinity = s.h_reciprocal(f64::INFINITY);
        assert_eq!(at_infinity.order(), 6 - dimension, "{:?}", case.form);
        for z in at_infinity.basis() {
            for b in s.basis() {
                assert!(z.pitch_form(b, f64::INFINITY).abs() < 1e-13);
            }
        }
    });
}

/// dim (S + T) + dim (S n T) = dim S + dim T, with a known common part.
#[test]
fn sum_and_intersection() {
    let mut random = Random(30);
    let options = ScrewOptions::default();
    for common in 0..=6 {
        for only_a in 0..=6 - common {
            for only_b in 0..=6 - common {
                let c: Vec<Twist> = (0..common).map(|_| random.twist()).collect();
                let with = |n: usize, random: &mut Random| {
                    let own = (0..n).map(|_| random.twist());
                    let twists: Vec<Twist> = c.iter().copied().chain(own).collect();
                    ScrewSystem::of(&twists, &options).unwrap()
                };
                let (a, b) = (with(only_a, &mut random), with(only_b, &mut random));
                let (sum, both) = (a.sum(&b), a.intersection(&b));
                let expected = 6.min(common + only_a + only_b);
                let name = format!("{common} {only_a} {only_b}");
                assert_eq!(sum.order(), expected, "{name}");
                assert_eq!(both.order(), 2 * common + only_a + only_b - expected, "{name}");
                assert_eq!(b.sum(&a).order(), expected);
                assert_eq!(b.intersection(&a).order(), both.order());
                for t in &c {
                    assert!(a.contains(*t) && b.contains(*t) && both.contains(*t), "{name}");
                }
                for t in both.basis() {
                    assert!(a.sine_to(t) < 1e-9 && b.sine_to(t) < 1e-9, "{name}");
                }
                for t in a.basis().into_iter().chain(b.basis()) {
                    assert!(sum.sine_to(t) < 1e-9, "{name}");
                }
                let t = random.twist();
                assert_eq!(sum.contains(t), expected == 6, "{name}");
                // De Morgan.
                let dual = a.reciprocal().intersection(&b.reciprocal());
                assert_eq!(dual.order(), 6 - expected, "{name}");
                assert!(dual.sine_to_system(&sum.reciprocal()) < 1e-9, "{name}");
            }
        }
    }
}
