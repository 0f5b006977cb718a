//! The pencil of pitch conics of three-systems: points, kinds, the principal ones.

use cylindroid::screws::{
    Class, ConicKind, NormalForm, PitchConics, Screw, ScrewOptions, ScrewSystem,
};
use cylindroid::spatial::Twist;

use crate::support::Random;

fn system(random: &mut Random, class: Class, pitches: &[f64], slope: Option<f64>) -> ScrewSystem {
    let form = NormalForm { class, order: 3, pitches: pitches.to_vec(), slope };
    let pose = random.pose();
    let twists: Vec<Twist> = form.twists().into_iter().map(|t| pose.adjoint(t)).collect();
    let system = ScrewSystem::of(&twists, &ScrewOptions::default()).unwrap();
    assert_eq!(system.class(), class);
    system
}

fn pitch(conics: &PitchConics, x: [f64; 3]) -> Option<f64> {
    Screw::of(conics.twist(x)).filter(|s| !s.is_translation()).map(|s| s.pitch)
}

/// All points of a conic are screws of its pitch (or translations) of the system, and return their
/// own coordinates.
#[track_caller]
fn check(system: &ScrewSystem, h: f64, kind: ConicKind, curves: usize) {
    let conics = system.pitch_conics().unwrap();
    assert_eq!(conics.kind(h), kind, "{} at {h}", system.class());
    let points = conics.points(h, 24);
    assert_eq!(points.len(), curves, "{} at {h}", system.class());
    for x in points.iter().flatten() {
        let twist = conics.twist(*x);
        assert!(system.contains(twist));
        if twist.angular.norm() > 1e-6 {
            let found = pitch(&conics, *x).unwrap();
            assert!((found - h).abs() < 1e-7 / twist.angular.norm().powi(2), "{found} not {h}");
        }
        let back = conics.coordinates(twist).unwrap();
        let along: f64 = back.iter().zip(x).map(|(a, b)| a * b).sum();
        assert!((along.abs() - 1.0).abs() < 1e-10);
    }
}

/// Figure 1 of Donelan & Selig: two points, a pair of lines, real conics between them.
#[test]
fn class_ia1_has_two_points_and_a_pair_of_lines() {
    let mut random = Random(1701);
    for _ in 0..10 {
        let (a, b, c) =
            (random.within(0.4, 1.0), random.within(-0.2, 0.2), random.within(-1.0, -0.4));
        let system = system(&mut random, Class::IA1, &[a, b, c], None);
        check(&system, a, ConicKind::Point, 1);
        check(&system, b, ConicKind::LinePair, 2);
        check(&system, c, ConicKind::Point, 1);
        for h in [0.5 * (a + b), 0.5 * (b + c)] {
            check(&system, h, ConicKind::Regular, 1);
        }
        for h in [a + 0.1, c - 0.1] {
            check(&system, h, ConicKind::Empty, 0);
        }
        // No translation.
        assert_eq!(system.pitch_conics().unwrap().kind(f64::INFINITY), ConicKind::Empty);
        // The coordinates of the principal screws are those of the generators.
        let conics = system.pitch_conics().unwrap();
        for (i, screw) in system.principal_screws().iter().enumerate() {
            assert!(conics.coordinates(screw.twist()).unwrap()[i].abs() > 1.0 - 1e-9);
        }
    }
}

#[test]
fn other_classes() {
    let mut random = Random(1702);
    let ia2 = system(&mut random, Class::IA2, &[0.5, -0.2], None);
    check(&ia2, 0.5, ConicKind::Point, 1);
    check(&ia2, -0.2, ConicKind::DoubleLine, 1);
    check(&ia2, 0.0, ConicKind::Regular, 1);
    let iia = system(&mut random, Class::IIA, &[0.3], None);
    check(&iia, 0.3, ConicKind::Plane, 0);
    check(&iia, 0.2, ConicKind::Empty, 0);
    // Translations lie on every conic: the pencil of IB3 is of pairs of lines through one.
    let ib3 = system(&mut random, Class::IB3, &[0.4, -0.3], None);
    check(&ib3, 0.0, ConicKind::LinePair, 2);
    check(&ib3, 0.4, ConicKind::DoubleLine, 1);
    check(&ib3, 1.0, ConicKind::Point, 1);
    let ib0 = system(&mut random, Class::IB0, &[0.1], Some(0.5));
    check(&ib0, 0.1, ConicKind::LinePair, 2);
    check(&ib0, 0.7, ConicKind::Regular, 1);
    let iid = system(&mut random, Class::IID, &[], None);
    check(&iid, 0.0, ConicKind::Plane, 0);
    assert!(iid.reciprocal().pitch_conics().is_some());
    let two = ScrewSystem::of(&ia2.basis()[..2], &ScrewOptions::default()).unwrap();
    assert!(two.pitch_conics().is_none());
}
