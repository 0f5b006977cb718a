//! Signatures of pitch forms on screw systems.

use cylindroid::screws::{Class, ScrewOptions, ScrewSystem, Signature};
use cylindroid::spatial::{Twist, Vec3};

use super::sample::{CLASSES, Form, Setting, spanning};
use crate::support::Random;

/// The dimension of the twists of a class that are reciprocal to all of it at every pitch.
fn always_reciprocal(class: Class) -> usize {
    match class {
        Class::Inf | Class::IB3 | Class::IC | Class::IIB => 1,
        Class::IIC => 2,
        Class::IID => 3,
        _ => 0,
    }
}

/// Zeros of the determinant of the regular part, with their multiplicities, of the system itself.
fn pitches(form: &Form) -> Vec<f64> {
    let p = |i: usize| form.pitches[i.min(form.pitches.len() - 1)];
    let small = if form.order > 3 { 6 - form.order } else { form.order };
    let of_form = match (small, form.class) {
        (_, Class::H) | (2, Class::IIB) | (3, Class::IB0 | Class::IIC) => vec![p(0)],
        (2, Class::IA | Class::IIA) | (3, Class::IB3 | Class::IIB) => vec![p(0), p(1)],
        (3, Class::IA1 | Class::IA2 | Class::IIA) => vec![p(0), p(1), p(2)],
        _ => vec![],
    };
    if form.order > 3 { of_form.iter().map(|h| -h).collect() } else { of_form }
}

fn expected(form: &Form, h: f64) -> Signature {
    let (all, zero) = (pitches(form), always_reciprocal(form.class));
    let pairs = (form.order - zero - all.len()) / 2;
    Signature {
        positive: pairs + all.iter().filter(|p| **p > h).count(),
        negative: pairs + all.iter().filter(|p| **p < h).count(),
        zero: zero + all.iter().filter(|p| **p == h).count(),
    }
}

fn in_random_frames(mut check: impl FnMut(&Form, &ScrewSystem, f64)) {
    let mut random = Random(171);
    for (order, class) in CLASSES {
        for _ in 0..10 {
            let form = Form::random(&mut random, order, class);
            let pose = Setting::PLAIN.pose(&mut random);
            let twists = spanning(&mut random, &form.basis(), order, pose, &Setting::PLAIN);
            let system = ScrewSystem::of(&twists, &ScrewOptions::default()).unwrap();
            assert_eq!(system.order(), order);
            let mut tried = pitches(&form);
            tried.extend([-3.0, 0.0, 3.0, random.within(-1.0, 1.0)]);
            tried.iter().for_each(|&h| check(&form, &system, h));
        }
    }
}

/// c + #{h_i > h}, c + #{h_i < h}, z + #{h_i = h}.
#[test]
fn signs_of_every_class() {
    in_random_frames(|form, system, h| {
        assert_eq!(system.signature(h), expected(form, h), "{form:?} at {h}");
    });
}

#[test]
fn signatures_of_reciprocal_systems_add_up_to_three() {
    in_random_frames(|form, system, h| {
        let (a, b) = (system.signature(h), system.reciprocal().signature(-h));
        assert_eq!(a.zero, b.zero, "{form:?}");
        assert_eq!((a.positive + b.positive + a.zero, a.negative + b.negative + a.zero), (3, 3));
        assert_eq!(system.h_reciprocal(h).signature(h), b, "{form:?}");
    });
}

#[test]
fn the_form_is_regular_where_the_inverse_exists() {
    in_random_frames(|form, system, h| {
        assert_eq!(system.signature(h).is_regular(), system.existence(h).exists, "{form:?}");
    });
}

#[test]
fn signatures_of_no_pitch_and_no_system() {
    let slide = Twist { linear: Vec3::X, angular: Vec3::ZERO };
    let system = ScrewSystem::of(&[slide], &ScrewOptions::default()).unwrap();
    for h in [f64::NAN, f64::INFINITY, 0.3] {
        assert_eq!(system.signature(h), Signature { positive: 0, negative: 0, zero: 1 });
    }
    let none = ScrewSystem::of(&[], &ScrewOptions::default()).unwrap();
    assert_eq!(none.signature(0.0), Signature::default());
    assert_eq!(Signature { positive: 2, negative: 1, zero: 0 }.to_string(), "(2, 1, 0)");
}

/// A tenth of the distance to a principal pitch: ten times the projector, for every class that has
/// one, also where pitches coincide.
#[test]
fn poles_are_simple() {
    let mut random = Random(178);
    for (order, class) in CLASSES
        .into_iter()
        .filter(|(_, class)| always_reciprocal(*class) == 0 && *class != Class::IB)
    {
        let form = Form::random(&mut random, order, class);
        let pose = Setting::PLAIN.pose(&mut random);
        let twists = spanning(&mut random, &form.basis(), order, pose, &Setting::PLAIN);
        let system = ScrewSystem::of(&twists, &ScrewOptions::default()).unwrap();
        for h in pitches(&form) {
            let norm = |d: f64| system.projector_norm(h + d);
            let ratio = norm(1e-5) / norm(1e-4);
            assert!((ratio - 10.0).abs() < 0.1, "{form:?}: {ratio}");
        }
    }
}
