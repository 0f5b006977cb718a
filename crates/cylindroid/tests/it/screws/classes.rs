//! The class of a system is found in any frame, basis and unit, with noise, and near boundaries
//! it is flagged.

use cylindroid::Matrix;
use cylindroid::screws::{Class, NoInverse, ScrewOptions, ScrewSystem};
use cylindroid::spatial::{Twist, Vec3};

use super::sample::{CLASSES, Form, Setting, matrix, spanning, system};
use crate::support::Random;

const NEVER: [(usize, Class); 12] = [
    (1, Class::Inf),
    (2, Class::IIB),
    (2, Class::IIC),
    (3, Class::IB3),
    (3, Class::IIB),
    (3, Class::IC),
    (3, Class::IIC),
    (3, Class::IID),
    (4, Class::IIB),
    (4, Class::IIC),
    (5, Class::Inf),
    (6, Class::Zero),
];

const fn setting(length: f64, offset: f64, noise: f64) -> Setting {
    Setting { length, offset, noise }
}

const SETTINGS: [Setting; 13] = [
    setting(1.0, 0.0, 0.0),
    setting(1e-3, 1.0, 0.0),
    setting(1e3, 1.0, 0.0),
    setting(1.0, 100.0, 0.0),
    setting(1.0, 1e4, 0.0),
    setting(1e-3, 1e4, 0.0),
    setting(1e3, 1e4, 0.0),
    setting(1.0, 1.0, 1e-12),
    setting(1e-3, 100.0, 1e-12),
    setting(1.0, 1.0, 1e-10),
    setting(1e3, 10.0, 1e-10),
    setting(1.0, 1.0, 1e-9),
    setting(1e-3, 10.0, 1e-9),
];

/// Errors of moduli over the error of the twists: the conditioning of the columns (10), of the
/// angular parts in the system (pitches and slopes to 2: squares of 1/0.4), and the way to the
/// centre where mixtures with translations put it. The largest of 6e5 systems was 3409.
const MODULI: f64 = 4e3;

fn every_class(rounds: usize, mut check: impl FnMut(&mut Random, &Form, &Setting, usize)) {
    for (s, setting) in SETTINGS.iter().enumerate() {
        for (c, (order, class)) in CLASSES.into_iter().enumerate() {
            let mut random = Random((1000 * s + c) as u64);
            for round in 0..rounds {
                let form = Form::random(&mut random, order, class);
                check(&mut random, &form, setting, round % 4);
            }
        }
    }
}

#[test]
fn every_class_in_every_frame() {
    let mut worst: f64 = 0.0;
    every_class(100, |random, form, setting, extra| {
        let (s, twists, _) = system(random, form, extra, setting);
        let name = format!("{form:?} {setting:?}: {s:?} of {twists:?}");
        assert_eq!((s.order(), s.class()), (form.order, form.class), "{name}");
        assert!(!s.is_ambiguous(), "{name}");
        let error = setting.error();
        assert!(s.residual() <= MODULI * error, "{name}");
        let found = s.normal_form();
        assert_eq!(found.pitches.len(), form.pitches.len(), "{name}");
        assert_eq!(found.slope.is_some(), form.slope.is_some(), "{name}");
        let pairs = found.pitches.iter().map(|h| h / setting.length).zip(form.pitches.iter());
        for (got, expected) in pairs.chain(found.slope.into_iter().zip(form.slope.iter())) {
            worst = worst.max((got - expected).abs() / error);
            assert!((got - expected).abs() <= MODULI * error, "{got} for {expected}, {name}");
        }
        // The normal form in the canonical frame is the system, or its reciprocal.
        let canonical = s.canonical_pose();
        for g in found.twists() {
            let g = canonical.adjoint(g);
            if form.order <= 3 {
                assert!(s.sine_to(g) <= MODULI * error, "{name}");
            }
        }
    });
    println!("moduli within {worst:.0} times the error of the twists");
}

/// At, near and away from the principal pitches.
#[test]
fn existence_at_and_away_from_principal_pitches() {
    every_class(10, |random, form, setting, extra| {
        let (s, ..) = system(random, form, extra, setting);
        let (unit, error) = (setting.length, setting.error());
        let never = NEVER.contains(&(form.order, form.class));
        assert_eq!(s.class().never_invertible(), never);
        let sign = if form.order > 3 { -1.0 } else { 1.0 };
        let mut principal: Vec<f64> = form.pitches.iter().map(|h| sign * h).collect();
        if never {
            principal.clear();
        }
        assert_eq!(s.principal_pitches().len(), principal.len());
        for screw in s.principal_screws() {
            // In the radical of its form: h-reciprocal to all of the system.
            let (twist, size) = (screw.twist(), unit.max(screw.axis.point.norm()));
            assert!(s.sine_to(twist) <= MODULI * error, "{form:?}");
            for other in s.basis() {
                let form = twist.pitch_form(other, screw.pitch);
                assert!(form.abs() <= MODULI * error.max(1e-15) * size, "{form} {s:?}");
            }
        }
        for &h in &principal {
            for at in [h, h + 1e-11] {
                let found = s.existence(at * unit);
                let Some(NoInverse::PrincipalPitch { pitch }) = found.reason else {
                    panic!("{form:?} h = {at}: {found:?}")
                };
                assert!(!found.exists && found.margin <= found.threshold);
                assert!((pitch - h * unit).abs() <= (MODULI * error + 1e-15) * unit);
                assert!(s.projector(at * unit).is_none());
            }
        }
        let tried = [
            -2.5,
            -1.0,
            -0.1,
            0.0,
            1e-3,
            0.37,
            1.4,
            2.2,
            50.0,
            -1e4,
            1e-2 + random.within(0.0, 1.0),
        ];
        for h in tried {
            let distance = principal.iter().map(|p| (p - h).abs()).fold(f64::INFINITY, f64::min);
            if distance < 1e-2 {
                continue;
            }
            let found = s.existence(h * unit);
            assert_eq!(found.exists, !never, "{form:?} h = {h}: {found:?}");
            assert_eq!(found.exists, found.reason.is_none());
            assert_eq!(found.exists, s.projector(h * unit).is_some());
            if never {
                let reason = NoInverse::Class { class: form.class, order: form.order };
                assert_eq!(found.reason, Some(reason));
            }
        }
        assert!(!s.existence(f64::NAN).exists && s.projector(f64::NAN).is_none());
    });
}

/// The same twists in millimetres.
fn in_millimetres(twists: &[Twist]) -> Vec<Twist> {
    twists.iter().map(|t| Twist { linear: t.linear * 1e3, ..*t }).collect()
}

#[test]
fn metres_and_millimetres() {
    every_class(5, |random, form, setting, extra| {
        let (s, twists, _) = system(random, form, extra, setting);
        let options = ScrewOptions { length: 1e3 * setting.length, ..setting.options() };
        let m = ScrewSystem::of(&in_millimetres(&twists), &options).unwrap();
        assert_eq!(
            (m.order(), m.class(), m.is_ambiguous()),
            (s.order(), s.class(), false),
            "{setting:?} {s:?} {m:?}"
        );
        for (a, b) in m.principal_pitches().iter().zip(s.principal_pitches()) {
            assert!((a / 1e3 - b).abs() <= MODULI * setting.error() * setting.length);
        }
        for h in [-1.3, 0.0, 0.7, 1e5] {
            let h = h * setting.length;
            assert_eq!(m.existence(1e3 * h).exists, s.existence(h).exists);
        }
    });
}

/// A system with a quantity q where that of a simpler class is zero, both classes.
struct Boundary {
    below: (usize, Class),
    above: (usize, Class),
    rows: fn(f64) -> Vec<[f64; 6]>,
}

const BOUNDARIES: [Boundary; 9] = [
    Boundary {
        below: (2, Class::IIA),
        above: (2, Class::IA),
        rows: |q| vec![[0.3 + q, 0.0, 0.0, 1.0, 0.0, 0.0], [0.0, 0.3, 0.0, 0.0, 1.0, 0.0]],
    },
    Boundary {
        below: (2, Class::IIB),
        above: (2, Class::IB),
        rows: |q| vec![[0.0, 0.0, 0.0, 1.0, 0.0, 0.0], [q, 1.0, 0.0, 0.0, 0.0, 0.0]],
    },
    Boundary {
        below: (1, Class::Inf),
        above: (1, Class::H),
        rows: |q| vec![[1.0, 0.0, 0.0, q, 0.0, 0.0]],
    },
    Boundary {
        below: (3, Class::IIA),
        above: (3, Class::IA2),
        rows: |q| {
            vec![
                [0.3 + q, 0.0, 0.0, 1.0, 0.0, 0.0],
                [0.0, 0.3, 0.0, 0.0, 1.0, 0.0],
                [0.0, 0.0, 0.3, 0.0, 0.0, 1.0],
            ]
        },
    },
    Boundary {
        below: (3, Class::IA2),
        above: (3, Class::IA1),
        rows: |q| {
            vec![
                [0.3 + q, 0.0, 0.0, 1.0, 0.0, 0.0],
                [0.0, 0.3, 0.0, 0.0, 1.0, 0.0],
                [0.0, 0.0, -0.4, 0.0, 0.0, 1.0],
            ]
        },
    },
    Boundary {
        below: (3, Class::IIB),
        above: (3, Class::IB3),
        rows: |q| {
            vec![
                [0.3 + q, 0.0, 0.0, 1.0, 0.0, 0.0],
                [0.0, 0.3, 0.0, 0.0, 1.0, 0.0],
                [0.0, 0.0, 1.0, 0.0, 0.0, 0.0],
            ]
        },
    },
    Boundary {
        below: (3, Class::IB3),
        above: (3, Class::IB0),
        rows: |q| {
            vec![
                [0.3, 0.0, 0.0, 1.0, 0.0, 0.0],
                [0.0, -0.4, 0.0, 0.0, 1.0, 0.0],
                [q, 0.0, 1.0, 0.0, 0.0, 0.0],
            ]
        },
    },
    Boundary {
        below: (3, Class::IIC),
        above: (3, Class::IC),
        rows: |q| {
            vec![
                [0.3, 0.0, 0.0, 1.0, 0.0, 0.0],
                [0.0, 1.0, 0.0, 0.0, 0.0, 0.0],
                [q, 0.0, 1.0, 0.0, 0.0, 0.0],
            ]
        },
    },
    Boundary {
        below: (3, Class::IID),
        above: (3, Class::IIC),
        rows: |q| {
            vec![
                [1.0, 0.0, 0.0, q, 0.0, 0.0],
                [0.0, 1.0, 0.0, 0.0, 0.0, 0.0],
                [0.0, 0.0, 1.0, 0.0, 0.0, 0.0],
            ]
        },
    },
];

/// Thresholds stand at 1e-8: a third of it and three times it are on one side each for all, and
/// flagged; so is 1e-6. What is clearly zero, or clearly not, is not.
#[test]
fn boundaries_of_classes() {
    let mut random = Random(77);
    for b in &BOUNDARIES {
        for (q, class, narrow) in [
            (0.0, Some(b.below), false),
            (3e-9, Some(b.below), true),
            (3e-8, Some(b.above), true),
            (1e-6, Some(b.above), true),
            (1e-2, Some(b.above), false),
        ] {
            for _ in 0..40 {
                let setting = Setting::PLAIN;
                let (k, pose) = ((b.rows)(q).len(), setting.pose(&mut random));
                let basis = (b.rows)(q);
                let extra = (random.next_u64() % 3) as usize;
                let twists = spanning(&mut random, &basis, k + extra, pose, &setting);
                let s = ScrewSystem::of(&twists, &setting.options()).unwrap();
                let millimetres = ScrewOptions::with_length(1e3);
                let m = ScrewSystem::of(&in_millimetres(&twists), &millimetres).unwrap();
                assert_eq!(s.is_ambiguous(), narrow, "{:?} {q}: {:?}", b.above, s.margins());
                assert_eq!(m.is_ambiguous(), narrow, "{:?} {q}: {:?}", b.above, m.margins());
                if let Some(class) = class {
                    assert_eq!((s.order(), s.class()), class, "{q}: {:?}", s.margins());
                    assert_eq!((m.order(), m.class()), class, "{q}: {:?}", m.margins());
                }
            }
        }
    }
}

/// The rank of nearly parallel axes at 1 m: 1e-12 is the threshold.
#[test]
fn boundaries_of_rank() {
    for (sine, order, narrow) in
        [(0.0, 1, false), (3e-13, 1, true), (3e-12, 2, true), (1e-10, 2, true), (1e-2, 2, false)]
    {
        let twists = [
            Twist { linear: Vec3::ZERO, angular: Vec3::Z },
            Twist { linear: Vec3::ZERO, angular: Vec3::new(sine, 0.0, 1.0) },
        ];
        let s = ScrewSystem::of(&twists, &ScrewOptions::default()).unwrap();
        assert_eq!((s.order(), s.is_ambiguous()), (order, narrow), "{sine}: {:?}", s.rank());
    }
}

#[test]
fn order_zero_and_six() {
    let mut random = Random(5);
    for twists in [vec![], vec![Twist::ZERO], vec![Twist::ZERO; 7]] {
        let s = ScrewSystem::of(&twists, &ScrewOptions::default()).unwrap();
        assert_eq!((s.order(), s.class(), s.is_ambiguous()), (0, Class::Zero, false));
        assert!(s.basis().is_empty() && s.principal_pitches().is_empty());
        assert!(!s.contains(Twist { linear: Vec3::X, angular: Vec3::ZERO }));
        assert!(s.contains(Twist::ZERO));
        for h in [0.0, -2.0, f64::INFINITY] {
            assert!(s.existence(h).exists);
            assert_eq!(s.projector(h).unwrap().matrix(), Matrix::zeros(6, 6));
        }
        assert_eq!(s.reciprocal().order(), 6);
    }
    for m in 6..9 {
        for offset in [1.0, 1e3] {
            let setting = Setting { offset, ..Setting::PLAIN };
            let twists = loop {
                let twists: Vec<_> = (0..m).map(|_| random.twist()).collect();
                let svd = cylindroid::linalg::Svd::of(&matrix(&twists));
                if svd.value(0) < 10.0 * svd.value(5) {
                    break twists;
                }
            };
            let pose = setting.pose(&mut random);
            let twists: Vec<_> = twists.into_iter().map(|t| pose.adjoint(t)).collect();
            let s = ScrewSystem::of(&twists, &ScrewOptions::default()).unwrap();
            assert_eq!((s.order(), s.class(), s.is_ambiguous()), (6, Class::Full, false));
            assert_eq!(s.reciprocal().order(), 0);
            assert!(s.contains(random.twist()));
            for h in [0.0, -2.0, f64::INFINITY] {
                assert!(s.existence(h).exists);
                let p = s.projector(h).unwrap().matrix();
                let size = (1.0 + offset) * (1.0 + offset);
                assert!(p.max_difference(&Matrix::identity(6)) < 1e-14 * size);
            }
        }
    }
}

/// Columns that are nothing, or rounding errors of the others, span nothing.
#[test]
fn columns_that_are_nothing() {
    let mut random = Random(6);
    for (order, class) in CLASSES {
        let form = Form::random(&mut random, order, class);
        let (_, mut twists, _) = system(&mut random, &form, 1, &Setting::PLAIN);
        twists.insert(1, Twist::ZERO);
        twists.insert(0, random.twist() * 1e-17);
        let s = ScrewSystem::of(&twists, &ScrewOptions::default()).unwrap();
        assert_eq!((s.order(), s.class(), s.is_ambiguous()), (order, class, false));
    }
}

#[test]
fn what_is_no_system() {
    let options = ScrewOptions::default();
    let good = [Twist { linear: Vec3::X, angular: Vec3::Z }];
    for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        for i in 0..6 {
            let mut t = [0.5; 6];
            t[i] = bad;
            let error = ScrewSystem::of(&[good[0], Twist::from_array(t)], &options).unwrap_err();
            assert!(error.to_string().contains("twist 2"), "{error}");
        }
        let center = Some(Vec3::X * bad);
        assert!(ScrewSystem::of(&good, &ScrewOptions { center, ..options }).is_err());
    }
    for length in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        let error = ScrewSystem::of(&good, &ScrewOptions { length, ..options }).unwrap_err();
        assert!(error.to_string().starts_with("length = "), "{error}");
    }
    for noise in [-1e-9, f64::NAN, 0.1, f64::INFINITY] {
        let error = ScrewSystem::of(&good, &ScrewOptions { noise, ..options }).unwrap_err();
        assert!(error.to_string().starts_with("noise = "), "{error}");
    }
    for rows in [0, 3, 7] {
        assert!(ScrewSystem::of_columns(&Matrix::zeros(rows, 2), &options).is_err());
    }
    assert_eq!(ScrewSystem::of_columns(&Matrix::zeros(6, 0), &options).unwrap().order(), 0);
    // Numbers at the ends of the range are no reason to panic.
    for size in [1e-300, 1e-150, 1e150, 1e300] {
        let twists = [good[0] * size, Twist { linear: Vec3::Y, angular: Vec3::X } * size];
        let s = ScrewSystem::of(&twists, &options).unwrap();
        assert_eq!((s.order(), s.class(), s.is_ambiguous()), (2, Class::IA, false), "{size}");
    }
}

/// What the existence of an inverse hangs on depends on the twists given by less than a factor of
/// two, whereas verdicts near a threshold are flagged over a factor of 1000: the centre is the same
/// or, for pitches beyond the length, one of a few.
#[test]
fn margins_do_not_depend_on_the_twists() {
    for (order, class) in CLASSES {
        let mut random = Random(99);
        for _ in 0..50 {
            let form = Form::random(&mut random, order, class);
            let pose = Setting::PLAIN.pose(&mut random);
            let [a, b] = [0, 1].map(|_| {
                let t = spanning(&mut random, &form.basis(), order, pose, &Setting::PLAIN);
                ScrewSystem::of(&t, &Setting::PLAIN.options()).unwrap()
            });
            for h in [-3.0, -0.7, 0.0, 0.33] {
                let (x, y) = (a.existence(h).margin, b.existence(h).margin);
                assert!((x - y).abs() <= 0.5 * x.max(y) + 1e-12, "{form:?} {h}: {x} {y}");
            }
        }
    }
}

/// Pitches that differ by less than the threshold: the deviation from the class of one pitch.
#[test]
fn residual_is_the_deviation_from_the_class() {
    for gap in [1e-9, 4e-9] {
        let screw = |e: Vec3, pitch: f64| Twist { linear: e * pitch, angular: e };
        let twists = [screw(Vec3::X, 1.0 + gap), screw(Vec3::Y, 1.0 - gap)];
        let s = ScrewSystem::of(&twists, &ScrewOptions::default()).unwrap();
        assert_eq!((s.class(), s.is_ambiguous()), (Class::IIA, true));
        // Each unit twist leaves the form by the angle of (gap, 0) to (1, 1), over two of them.
        assert!((s.residual() / (gap / 2.0_f64.sqrt()) - 1.0).abs() < 1e-6, "{}", s.residual());
    }
}

/// Two screws of one pitch and a translation across them: with an angular part of 5e-12, where the
/// centre is free to lie 200 lengths away, the pitches differ there by more than the threshold; in
/// any frame, order and size.
#[test]
fn a_class_that_hangs_on_a_free_centre_is_flagged() {
    let mut random = Random(7);
    let rotation = |angular: Vec3| Twist { linear: Vec3::ZERO, angular };
    for (turn, flagged) in [(0.0, false), (1e-13, false), (5e-12, true)] {
        let t = Twist { linear: Vec3::Z, angular: Vec3::Z * turn };
        let mut twists = [rotation(Vec3::X), rotation(Vec3::Y), t];
        for size in [1.0, -1e-3, 1e3] {
            let pose = Setting::PLAIN.pose(&mut random);
            twists.rotate_left(1);
            let moved = twists.map(|twist| pose.adjoint(twist * size));
            let s = ScrewSystem::of(&moved, &ScrewOptions::default()).unwrap();
            assert_eq!((s.class(), s.is_ambiguous()), (Class::IIB, flagged), "{turn} {pose:?}");
        }
    }
}
