//! Badly scaled mechanisms: drawn in millimetres, with links of very different lengths, with very
//! many joints. Every answer is defined, and the counts are those of the mechanism.

use cylindroid::closure::{ClosedChain, Mobility, MotionSpace, Singularities, assemble};
use cylindroid::manipulability::{Manipulability, Metrics};
use cylindroid::model::Dimension;
use cylindroid::screws::Line;
use cylindroid::spatial::Vec3;
use cylindroid::{Mechanism, catalogue};

use super::rings::ring;

/// Hinges at these points of the plane, all but the last four actuated.
fn hinges(points: &[(f64, f64)], dimension: Dimension) -> Mechanism {
    let axis = |(x, y): &(f64, f64)| Line { point: Vec3::new(*x, *y, 0.0), direction: Vec3::Z };
    let axes: Vec<Line> = points.iter().map(axis).collect();
    let actuated: Vec<String> = (1..points.len() - 3).map(|i| format!("q{i}")).collect();
    ring("ring", &axes, dimension).with_actuated(&actuated).unwrap()
}

/// dof, hyperstatic, redundancy, indeterminacy, internal, zero_torque.
fn counts(m: &Mechanism) -> [usize; 6] {
    let state = m.state(m.home()).unwrap();
    let chain = ClosedChain::of(&state, None, None).unwrap();
    let motions = MotionSpace::of(&chain.constraint);
    let relation = motions.relation();
    let mobility = Mobility::from_parts(&chain.constraint, &motions, &relation);
    let all = Manipulability::of(&relation, &Metrics::UNIT).unwrap();
    assert!(all.kinematic.values().iter().all(|e| e.is_finite() && *e > 0.0));
    assert_eq!(all.kinematic.finite.len(), mobility.relation.coordinate);
    let generic = cylindroid::closure::MobilityCounts::of(&motions, &relation);
    assert!(Singularities::of(&motions, &relation, &generic).is_regular());
    assert!(mobility.joints.iter().all(|j| (0.0..=1.0).contains(&j.share)));
    [
        mobility.dof.dimension(),
        mobility.hyperstatic.dimension(),
        mobility.relation.redundancy,
        mobility.relation.indeterminacy,
        mobility.internal.dimension(),
        mobility.zero_torque.dimension(),
    ]
}

/// The same five-bar as large as a town, and as small as a cell.
#[test]
fn size_does_not_matter() {
    let shape = [(0.0, 0.0), (0.0, 2.0), (1.0, 2.0), (2.0, 1.0), (2.0, 0.0)];
    let expected = counts(&hinges(&shape, Dimension::Planar));
    assert_eq!(expected[..2], [2, 0]);
    let expected_in_space = counts(&hinges(&shape, Dimension::Spatial));
    assert_eq!(expected_in_space[..2], [2, 3]);
    for factor in [1e3, 1e-3, 1e6, 1e-6, 1e100] {
        let points = shape.map(|(x, y)| (factor * x, factor * y));
        assert_eq!(counts(&hinges(&points, Dimension::Planar)), expected, "{factor}");
        assert_eq!(counts(&hinges(&points, Dimension::Spatial)), expected_in_space, "{factor}");
    }
}

/// A crank of a thousandth, a millionth of the other links, and one that is no longer than the
/// threshold: from there on its hinges are one.
#[test]
fn tiny_links() {
    let four_bar =
        |crank: f64| hinges(&[(0.0, 0.0), (0.0, crank), (1.0, 1.0), (1.5, 0.0)], Dimension::Planar);
    for crank in [1e-3, 1e-6, 1e-7] {
        assert_eq!(counts(&four_bar(crank))[0], 1, "{crank}");
    }
    for crank in [1e-9, 1e-12, 1e-300, 0.0] {
        let m = four_bar(crank);
        let chain = ClosedChain::of(&m.state(m.home()).unwrap(), None, None).unwrap();
        let mobility = Mobility::of(&chain.constraint);
        assert_eq!(mobility.dof.dimension(), 1, "{crank}");
    }
}

/// A hundred hinges in a ring: 97 motions of the plane, in space three constraints too many.
#[test]
fn a_hundred_joints() {
    let points: Vec<(f64, f64)> = (0..100)
        .map(|i| {
            let (sin, cos) = (f64::from(i) * 0.0628 - 1.57).sin_cos();
            (2.0 * cos, 2.0 + (2.0 + 0.3 * f64::from(i % 3)) * sin)
        })
        .collect();
    for (dimension, hyperstatic) in [(Dimension::Planar, 0), (Dimension::Spatial, 3)] {
        let m = hinges(&points, dimension);
        assert_eq!(m.n(), 99);
        let [dof, too_many, ..] = counts(&m);
        assert_eq!((dof, too_many), (97, hyperstatic), "{dimension:?}");
    }
    // Bent open, it is closed again near by.
    let m = hinges(&points, Dimension::Planar);
    let guess: Vec<f64> = m.home().iter().enumerate().map(|(i, q)| q + 1e-3 * i as f64).collect();
    assert!(assemble(&m, &guess, &[0, 1, 2]).unwrap().closed);
}

/// The characteristic length is the user's, and need not fit.
#[test]
fn any_length() {
    for name in ["five-bar", "stewart", "two-arm"] {
        let m = catalogue::load(name).unwrap();
        let state = m.state(m.home()).unwrap();
        let of = |length| ClosedChain::of(&state, None, Some(length));
        let expected = Mobility::of(&of(1.0).unwrap().constraint).relation;
        for length in [1e-3, 1e3] {
            assert_eq!(Mobility::of(&of(length).unwrap().constraint).relation, expected, "{name}");
        }
        for length in [1e-30, 1e30, 1e-300, 1e300] {
            // Angles or lengths alone are left: counts of the one or the other, no panic.
            if let Ok(chain) = of(length) {
                let mobility = Mobility::of(&chain.constraint);
                assert!(mobility.dof.basis.is_finite(), "{name} {length}");
            }
        }
    }
}
