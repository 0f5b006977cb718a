//! Many configurations in one call are what the reports of one say, whatever their number and
//! place.

use cylindroid::closure::{ClosedChain, Mobility, Motions, Singularities, assemble};
use cylindroid::manipulability::{Batch, BatchOptions, Manipulability, Metrics};
use cylindroid::{Mechanism, catalogue};

use crate::support::Random;

const WIDTH: usize = Batch::WIDTH;

fn file(name: &str) -> Mechanism {
    cylindroid::load(&format!("tests/data/mechanisms/{name}.toml")).unwrap()
}

/// The reports of one configuration.
fn single(batch: &Batch, mechanism: &Mechanism, q: &[f64], metrics: &Metrics) -> [f64; WIDTH] {
    let state = mechanism.state(q).unwrap();
    let length = batch.length();
    let chain = ClosedChain::of(&state, Some(batch.reference()), Some(length)).unwrap();
    let motions = Motions::of(&chain.constraint);
    let relation = motions.relation();
    let m = Mobility::of(&chain.constraint);
    let found = Singularities::of(&motions, &relation, &batch.generic()).distances;
    let kinematic = Manipulability::of(&relation, metrics).unwrap().kinematic;
    let none = f64::NAN;
    [
        chain.gap.distance,
        chain.gap.angle,
        f64::from(u8::from(chain.gap.is_closed(length))),
        m.dof.dimension() as f64,
        m.relation.redundancy as f64,
        m.relation.indeterminacy as f64,
        m.relation.coordinate as f64,
        m.internal.dimension() as f64,
        m.zero_torque.dimension() as f64,
        m.hyperstatic.dimension() as f64,
        m.idle.dimension() as f64,
        found.type_i,
        found.type_ii,
        found.configuration_space,
        found.passive,
        kinematic.volume(),
        kinematic.largest().unwrap_or(none),
        kinematic.smallest().unwrap_or(none),
        kinematic.anisotropy().unwrap_or(none),
    ]
}

fn check(what: &str, got: &[f64], expected: &[f64; WIDTH], length: f64) {
    let distances = &expected[11..15];
    let least = distances.iter().filter(|d| **d > 0.0).fold(1.0, |m: f64, d| m.min(*d));
    for (i, name) in Batch::COLUMNS.into_iter().enumerate() {
        let (g, e) = (got[i], expected[i]);
        let tolerance = match i {
            0 | 1 => 1e-14 * (10.0 + length),
            2..11 => 0.0,
            11..15 => 1e-13 / least,
            _ => 1e-12 * e / least,
        };
        let same = g.to_bits() == e.to_bits() || g.is_nan() && e.is_nan();
        assert!(same || (g - e).abs() <= tolerance, "{what} {name}: {g} instead of {e}");
    }
}

/// Guesses around home, closed where they can be, and every fifth as it is.
fn postures(mechanism: &Mechanism, count: usize, spread: f64) -> Vec<f64> {
    let mut random = Random(3);
    let mut q = mechanism.home().to_vec();
    for i in 1..count {
        let guess: Vec<f64> =
            mechanism.home().iter().map(|x| x + spread * random.within(-1.0, 1.0)).collect();
        let closed = i % 5 != 0 && mechanism.is_closed();
        q.extend(if closed { assemble(mechanism, &guess, &[]).unwrap().q } else { guess });
    }
    q
}

fn compare(what: &str, mechanism: &Mechanism, options: &BatchOptions, q: &[f64]) {
    let batch = Batch::new(mechanism, options).unwrap();
    let rows = batch.analyse(q).unwrap();
    let n = mechanism.n();
    assert_eq!(rows.len(), q.len() / n * WIDTH);
    for (i, (q, row)) in q.chunks(n).zip(rows.chunks(WIDTH)).enumerate() {
        let expected = single(&batch, mechanism, q, &options.metrics);
        check(&format!("{what} {i}"), row, &expected, batch.length());
    }
}

#[test]
fn agrees_with_the_reports_of_one() {
    let drives: [(&str, &[&str]); 12] = [
        ("five-bar", &[]),
        ("five-bar", &["q1", "q5"]),
        ("five-bar", &["q2", "q4"]),
        ("five-bar", &["q1", "q2", "q3", "q4", "q5"]),
        ("five-bar", &["q3"]),
        ("stewart", &[]),
        ("stewart", &["leg1", "leg2", "leg3", "leg4", "leg5"]),
        ("two-arm", &[]),
        ("four-bar", &[]),
        ("3rrr", &[]),
        ("delta", &[]),
        ("watt", &[]),
    ];
    for (name, driven) in drives {
        let mechanism = catalogue::load(name).unwrap();
        let mechanism =
            if driven.is_empty() { mechanism } else { mechanism.with_actuated(driven).unwrap() };
        let q = postures(&mechanism, 41, 0.4);
        compare(&format!("{name} {driven:?}"), &mechanism, &BatchOptions::default(), &q);
    }
    for name in ["panda", "ur5e", "youbot", "3r"] {
        let arm = catalogue::load(name).unwrap();
        compare(name, &arm, &BatchOptions::default(), &postures(&arm, 21, 1.0));
    }
    for name in ["five-bar-dead", "five-bar-stretched", "folded-parallelogram", "spatial-four-bar"]
    {
        let mechanism = file(name);
        compare(name, &mechanism, &BatchOptions::default(), &postures(&mechanism, 21, 0.3));
    }
    for name in ["stewart-turned", "stretched-pair"] {
        let mechanism = file(name);
        compare(name, &mechanism, &BatchOptions::default(), &postures(&mechanism, 9, 0.1));
    }
    let grasp = cylindroid::load("../../docs/grasp.toml").unwrap();
    compare("grasp", &grasp, &BatchOptions::default(), &postures(&grasp, 21, 0.01));
}
