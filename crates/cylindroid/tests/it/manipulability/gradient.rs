//! Gradients of measures against differences of the measures themselves.

use cylindroid::closure::{ClosedChain, MotionSpace, assemble};
use cylindroid::manipulability::{Goal, Gradient, Manipulability, Measure, Metrics, gradient};
use cylindroid::model::{JointKind, JointSpec};
use cylindroid::spatial::{Pose, Vec3};
use cylindroid::{Matrix, Mechanism, catalogue};

use crate::support::{Random, assert_close, planar, reversed_zoo, robots, zoo};

fn value(m: &Mechanism, q: &[f64], goal: Goal<'_>, metrics: &Metrics, measure: Measure) -> f64 {
    let chain = ClosedChain::of(&m.state(q).unwrap(), goal.reference, None).unwrap();
    let mut relation = MotionSpace::of(&chain.constraint).relation();
    if let Some(map) = goal.task {
        relation = relation.task(map).unwrap();
    }
    let s = Manipulability::of(&relation, metrics).unwrap().kinematic;
    match measure {
        Measure::Volume => s.volume(),
        Measure::Smallest => s.smallest().unwrap(),
        Measure::Largest => s.largest().unwrap(),
        Measure::Anisotropy => s.anisotropy().unwrap(),
        other => panic!("{other:?} has no value here"),
    }
}

fn found(
    m: &Mechanism,
    q: &[f64],
    goal: Goal<'_>,
    metrics: &Metrics,
    measure: Measure,
) -> (f64, Vec<f64>, f64) {
    match gradient(&m.state(q).unwrap(), goal, metrics, measure).unwrap() {
        Gradient::Exists { value, gradient, error } => (value, gradient, error),
        other => panic!("{}: {measure:?} {other:?}", m.name()),
    }
}

/// Every serial arm of the catalogue and a tree with joints of all kinds, also in a task and in
/// metrics of its own.
#[test]
fn trees() {
    let mut random = Random(101);
    for m in robots().into_iter().chain([zoo(), reversed_zoo(), planar(3)]) {
        let q = random.q(&m);
        let d = if m.dimension().number() == 2 { 3 } else { 6 };
        let task = random.matrix(2, d);
        let weights: Vec<f64> = (0..d).map(|_| random.within(0.3, 3.0)).collect();
        let own = Metrics::UNIT.with_object(&Matrix::diagonal(&weights)).unwrap();
        for (goal, metrics) in [
            (Goal::default(), Metrics::UNIT),
            (Goal::default(), own.clone()),
            (Goal { task: Some(&task), ..Goal::default() }, own.for_task(&task).unwrap()),
        ] {
            for measure in Measure::ALL {
                let at = |q: &[f64]| value(&m, q, goal, &metrics, measure);
                let (here, gradient, error) = found(&m, &q, goal, &metrics, measure);
                assert!((here - at(&q)).abs() < 1e-12 * here && error == 0.0);
                for (k, g) in gradient.iter().enumerate() {
                    let mut rates = vec![0.0; m.n()];
                    rates[k] = 1.0;
                    let h = 1e-5;
                    let step = |h: f64| at(&m.integrate(&q, &rates, h).unwrap());
                    let difference = (step(h) - step(-h)) / (2.0 * h);
                    // Differences lose half the digits, more where the measure is steep.
                    let size = 1e-6 * here * (1.0 + (g / here).abs()).powi(2);
                    assert!(
                        (difference - g).abs() < size,
                        "{} {measure:?} {k}: {difference} {g}",
                        m.name()
                    );
                }
            }
        }
    }
}

/// Yoshikawa's two links: v = l1 l2 |sin q2|.
#[test]
fn two_links() {
    let m = planar(2);
    let task = Matrix::from_fn(2, 6, |i, j| f64::from(u8::from(i == j)));
    let goal = Goal { task: Some(&task), ..Goal::default() };
    for q2 in [0.4, 1.2, -2.0] {
        let (v, g, _) = found(&m, &[0.3, q2], goal, &Metrics::UNIT, Measure::Volume);
        assert!((v - q2.sin().abs()).abs() < 1e-14);
        assert_close("dv", &g, &[0.0, q2.cos() * q2.sin().signum()], 1e-13);
    }
}

/// Closed chains: the slope along every motion that keeps the loops, by closing them again at
/// both ends of a small step.
#[test]
fn closed_chains() {
    let mut random = Random(102);
    for name in ["four-bar", "five-bar", "3rrr", "stewart", "delta", "watt", "two-arm"] {
        let m = catalogue::load(name).unwrap();
        // Somewhere else than home.
        let guess: Vec<f64> = m.home().iter().map(|q| q + random.within(-0.05, 0.05)).collect();
        let start = assemble(&m, &guess, &[]).unwrap();
        assert!(start.closed, "{name}");
        let q = start.q;
        let goal = Goal::default();
        let length = m.reach();
        let chain = ClosedChain::of(&m.state(&q).unwrap(), None, None).unwrap();
        let metrics = Metrics::characteristic_length(&chain.units, length).unwrap();
        let basis = MotionSpace::of(&chain.constraint).basis();
        let columns: Vec<&String> = chain.actuated.iter().chain(&chain.passive).collect();
        for measure in Measure::ALL {
            let (here, gradient, error) = found(&m, &q, goal, &metrics, measure);
            assert!(error < 1e-5 * (1.0 + here), "{name} {measure:?}: {error}");
            for j in 0..basis.cols() {
                let rates: Vec<f64> = m
                    .coordinates()
                    .iter()
                    .map(|c| basis[(columns.iter().position(|n| **n == c.name).unwrap(), j)])
                    .collect();
                let slope: f64 = gradient.iter().zip(&rates).map(|(g, r)| g * r).sum();
                let h = 1e-4;
                let step = |h: f64| {
                    let there = m.integrate(&q, &rates, h).unwrap();
                    let closed = assemble(&m, &there, &[]).unwrap();
                    assert!(closed.closed);
                    value(&m, &closed.q, goal, &metrics, measure)
                };
                let difference = (step(h) - step(-h)) / (2.0 * h);
                assert!(
                    (difference - slope).abs() < 1e-5 * here * (1.0 + (slope / here).abs()),
                    "{name} {measure:?} {j}: {difference} {slope}"
                );
            }
        }
    }
}

/// At an isotropic pose the smallest efficiency has a kink, the volume none.
#[test]
fn repeated_efficiencies() {
    let mut b = Mechanism::builder("isotropic");
    let at = |x: f64| Pose::from_translation(Vec3::new(x, 0.0, 0.0));
    let second = JointSpec::new("q2", JointKind::Revolute, "upper", "lower");
    b.joint(JointSpec::new("q1", JointKind::Revolute, "ground", "upper"));
    b.joint(JointSpec { parent_from_joint: at(2.0_f64.sqrt()), ..second });
    b.frame("tip", "lower", at(1.0));
    b.tool("tip");
    let m = b.build().unwrap();
    let task = Matrix::from_fn(2, 6, |i, j| f64::from(u8::from(i == j)));
    let goal = Goal { task: Some(&task), ..Goal::default() };
    let q = [0.7, 0.75 * std::f64::consts::PI];
    let state = m.state(&q).unwrap();
    for measure in [Measure::Smallest, Measure::Largest, Measure::Anisotropy] {
        let Gradient::Repeated { multiplicity: 2, value } =
            gradient(&state, goal, &Metrics::UNIT, measure).unwrap()
        else {
            panic!("{measure:?}");
        };
        assert!((value - 1.0).abs() < 1e-12);
    }
    let (_, volume, _) = found(&m, &q, goal, &Metrics::UNIT, Measure::Volume);
    assert_close("dv", &volume, &[0.0, -1.0], 1e-12);
}

#[test]
fn nothing_to_measure() {
    let none = planar(2).with_actuated::<&str>(&[]).unwrap();
    let state = none.state(&[0.1, 0.2]).unwrap();
    for measure in Measure::ALL {
        let found = gradient(&state, Goal::default(), &Metrics::UNIT, measure).unwrap();
        assert_eq!(found, Gradient::Nothing);
    }
    let map = Matrix::zeros(1, 6);
    let goal = Goal { task: Some(&map), ..Goal::default() };
    assert!(gradient(&state, goal, &Metrics::UNIT, Measure::Volume).is_err());
}
