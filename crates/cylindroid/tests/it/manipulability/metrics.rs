//! Metrics: duals, presets, lopsided ones, refusals.

use cylindroid::Matrix;
use cylindroid::closure::{Constraint, Motions, Relation, Unit};
use cylindroid::linalg::Metric;
use cylindroid::manipulability::{Manipulability, Metrics};

use crate::closure::case::{case, cases};
use crate::support::{Random, assert_close};

fn relation(name: &str) -> Relation {
    Motions::of(&case(name).constraint()).relation()
}

fn spd(random: &mut Random, n: usize) -> Matrix {
    let a = random.matrix(n, n);
    let aat = &a * &a.transpose();
    Matrix::from_fn(n, n, |i, l| aat[(i, l)] + if i == l { 0.5 } else { 0.0 })
}

/// Given as such, the dual metrics give the same as none.
#[test]
fn dual_metrics_given_are_the_default() {
    let mut random = Random(85);
    for case in cases().iter().filter(|c| c.task.is_none()) {
        let relation = Motions::of(&case.constraint()).relation();
        let wu = Metric::new("Wu", &spd(&mut random, relation.object())).unwrap();
        let wq = Metric::new("Wq", &spd(&mut random, relation.joints())).unwrap();
        let explicit = Metrics {
            wrench: Some(wu.dual()),
            torque: Some(wq.dual()),
            object: Some(wu.clone()),
            joint: Some(wq.clone()),
        };
        let default = Metrics { object: Some(wu), joint: Some(wq), ..Metrics::UNIT };
        let of = |metrics| Manipulability::of(&relation, metrics).unwrap();
        let (one, two) = (of(&explicit), of(&default));
        assert_eq!(one.force.values(), two.force.values());
        for (k, f) in two.kinematic.values().iter().zip(two.force.values().iter().rev()) {
            assert!((k * f - 1.0).abs() < 1e-9, "{}: {k} {f}", case.name);
        }
    }
}

/// Torques measured ten times larger make forces a hundredth as efficient, motions the same.
#[test]
fn force_metrics_of_their_own() {
    let relation = relation("fivebar_sec5_case_c");
    let plain = Manipulability::of(&relation, &Metrics::UNIT).unwrap();
    let torque = Metric::diagonal("Wtau", &[100.0; 5]).unwrap();
    let own = Metrics { torque: Some(torque), ..Metrics::UNIT };
    let m = Manipulability::of(&relation, &own).unwrap();
    assert_eq!(m.kinematic, plain.kinematic);
    let hundredth: Vec<f64> = plain.force.values().iter().map(|f| f / 100.0).collect();
    assert_close("force", &m.force.values(), &hundredth, 1e-14);
    assert_eq!((m.force.zeros.cols(), m.force.infinite.cols()), (3, 1));
}

/// Rate limits: the ellipsoid touches what the limits allow along a single joint.
#[test]
fn limits_measure() {
    let relation = Motions::of(&Constraint::serial(&Matrix::identity(2)).unwrap()).relation();
    let metrics = Metrics::UNIT
        .with_rate_limits(&[2.0, 0.5])
        .unwrap()
        .with_torque_limits(&[3.0, 7.0])
        .unwrap();
    assert!(!metrics.is_dual());
    let m = Manipulability::of(&relation, &metrics).unwrap();
    assert_close("rates", &m.kinematic.values(), &[4.0, 0.25], 1e-14);
    assert_close("forces", &m.force.values(), &[49.0, 9.0], 1e-12);
    for limits in [[1.0, 0.0], [1.0, f64::INFINITY], [f64::NAN, 1.0]] {
        let error = Metrics::UNIT.with_rate_limits(&limits).unwrap_err().to_string();
        assert!(error.starts_with("rate limit = "), "{error}");
    }
}

/// A characteristic length makes the efficiencies free of the unit.
#[test]
fn characteristic_length_takes_the_unit_out() {
    let units = [Unit::Length, Unit::Length, Unit::Angle];
    let case = case("fivebar_sec5_case_a");
    let values = |factor: f64| {
        let case = case.moved(cylindroid::Pose::IDENTITY, factor);
        let relation = Motions::of(&case.constraint()).relation();
        let metrics =
            Metrics::characteristic_length(&units, &[Unit::Angle; 2], 1.7 * factor).unwrap();
        Manipulability::of(&relation, &metrics).unwrap().kinematic.values()
    };
    assert_close("in mm", &values(1e3), &values(1.0), 1e-12);
    assert!(Metrics::characteristic_length(&units, &[], 0.0).is_err());
}

/// Metrics that differ by 24 orders of magnitude change sizes, never kinds.
#[test]
fn lopsided_metrics() {
    for case in cases().iter().filter(|c| c.task.is_none()) {
        let relation = Motions::of(&case.constraint()).relation();
        for factor in [1e-24, 1e24] {
            let object = Metric::diagonal("Wu", &vec![factor; relation.object()]).unwrap();
            let metrics = Metrics { object: Some(object), ..Metrics::UNIT };
            let m = Manipulability::of(&relation, &metrics).unwrap();
            let unit = Manipulability::of(&relation, &Metrics::UNIT).unwrap();
            assert_eq!(m.kinematic.zeros.cols(), unit.kinematic.zeros.cols());
            let ratio: Vec<f64> = m
                .kinematic
                .values()
                .iter()
                .zip(unit.kinematic.values())
                .map(|(a, b)| a / (b * factor))
                .collect();
            assert_close(&case.name, &ratio, &vec![1.0; ratio.len()], 1e-10);
        }
        for size in [1e8, 1e30, 1e150] {
            let mixed: Vec<f64> = (0..relation.object())
                .map(|i| if i % 2 == 0 { 1.0 / size } else { size })
                .collect();
            let object = Metric::diagonal("Wu", &mixed).unwrap();
            let metrics = Metrics { object: Some(object), ..Metrics::UNIT };
            let m = Manipulability::of(&relation, &metrics).unwrap();
            assert_eq!(m.kinematic.finite.len(), relation.dimensions().coordinate);
            if size < 1e9 {
                let values = m.kinematic.values();
                assert!(values.iter().all(|e| e.is_finite() && *e > 0.0), "{}", case.name);
            }
        }
    }
}

#[test]
fn metrics_of_the_wrong_size() {
    let relation = relation("fivebar_sec5_case_a");
    let two = Some(Metric::diagonal("w", &[1.0, 1.0]).unwrap());
    let three = Some(Metric::diagonal("w", &[1.0; 3]).unwrap());
    for (metrics, name) in [
        (Metrics { object: two.clone(), ..Metrics::UNIT }, "Wu has 2 entries, expected 3"),
        (Metrics { joint: three.clone(), ..Metrics::UNIT }, "Wq has 3 entries, expected 2"),
        (Metrics { wrench: two, ..Metrics::UNIT }, "Ww"),
        (Metrics { torque: three, ..Metrics::UNIT }, "Wtau"),
    ] {
        let error = Manipulability::of(&relation, &metrics).unwrap_err().to_string();
        assert!(error.starts_with(name), "{error}");
    }
    assert!(Metrics::dual(&Matrix::diagonal(&[1.0, 0.0]), &Matrix::identity(2)).is_err());
}
