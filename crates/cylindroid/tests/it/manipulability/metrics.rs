//! Metrics: duals, presets, lopsided ones, refusals.

use cylindroid::Matrix;
use cylindroid::closure::{Constraint, MotionSpace, Relation, Unit, Units};
use cylindroid::linalg::Metric;
use cylindroid::manipulability::{Manipulability, Metrics, body_inertia};
use cylindroid::model::{Dimension, Inertial, JointKind, JointSpec, Link};
use cylindroid::spatial::{Mat3, Pose, Vec3};
use cylindroid::{Mechanism, ReferenceFrame};

use crate::closure::case::{case, cases};
use crate::support::{Random, assert_close};

fn relation(name: &str) -> Relation {
    MotionSpace::of(&case(name).constraint()).relation()
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
        let relation = MotionSpace::of(&case.constraint()).relation();
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
    let relation = MotionSpace::of(&Constraint::serial(&Matrix::identity(2)).unwrap()).relation();
    let metrics = Metrics::UNIT
        .with_velocity_limits(&[2.0, 0.5])
        .unwrap()
        .with_torque_limits(&[3.0, 7.0])
        .unwrap();
    assert!(!metrics.is_dual());
    // The duals given by themselves are those in effect without them.
    let dual = Metrics { torque: metrics.joint.as_ref().map(Metric::dual), ..metrics.clone() };
    assert!(dual.is_dual());
    let m = Manipulability::of(&relation, &metrics).unwrap();
    assert_close("rates", &m.kinematic.values(), &[4.0, 0.25], 1e-14);
    assert_close("forces", &m.force.values(), &[49.0, 9.0], 1e-12);
    for limits in [[1.0, 0.0], [1.0, f64::INFINITY], [f64::NAN, 1.0]] {
        let error = Metrics::UNIT.with_velocity_limits(&limits).unwrap_err().to_string();
        assert!(error.starts_with("velocity limit = "), "{error}");
        assert!(error.contains("limits used as a metric must be positive and finite"), "{error}");
    }
}

/// A characteristic length makes the efficiencies free of the unit.
#[test]
fn characteristic_length_takes_the_unit_out() {
    let units = Units {
        rows: vec![],
        actuated: vec![Unit::Angle; 2],
        passive: vec![],
        object: vec![Unit::Length, Unit::Length, Unit::Angle],
    };
    let case = case("fivebar_sec5_case_a");
    let values = |factor: f64| {
        let case = case.moved(cylindroid::Pose::IDENTITY, factor);
        let relation = MotionSpace::of(&case.constraint()).relation();
        let metrics = Metrics::characteristic_length(&units, 1.7 * factor).unwrap();
        Manipulability::of(&relation, &metrics).unwrap().kinematic.values()
    };
    assert_close("in mm", &values(1e3), &values(1.0), 1e-12);
    for length in [0.0, -1.0, f64::NAN, f64::INFINITY, 1e-200, 1e200] {
        assert!(Metrics::characteristic_length(&units, length).is_err());
    }
}

/// Metrics that differ by 24 orders of magnitude change sizes, never kinds.
#[test]
fn lopsided_metrics() {
    for case in cases().iter().filter(|c| c.task.is_none()) {
        let relation = MotionSpace::of(&case.constraint()).relation();
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
        // So do those whose roots have no square.
        for factor in [1e-320, 1e-310, 1e308] {
            let object = Metric::diagonal("Wu", &vec![factor; relation.object()]).unwrap();
            let metrics = Metrics { object: Some(object), ..Metrics::UNIT };
            let m = Manipulability::of(&relation, &metrics).unwrap();
            let unit = Manipulability::of(&relation, &Metrics::UNIT).unwrap();
            assert_eq!(m.kinematic.zeros.cols(), unit.kinematic.zeros.cols(), "{factor:e}");
            assert_eq!(m.kinematic.finite.len(), unit.kinematic.finite.len(), "{factor:e}");
            let mut numbers = m.kinematic.zeros.as_slice().iter();
            assert!(numbers.all(|x| x.is_finite()), "{factor:e} {}", case.name);
            for (a, b) in m.kinematic.values().iter().zip(unit.kinematic.values()) {
                // Of 1e-320 three digits are left; efficiencies beyond the largest number are infinite.
                let (scaled, digits) = (b * factor, if factor < 1e-315 { 1e-2 } else { 1e-10 });
                let is_close = (a - scaled).abs() <= digits * scaled || *a == scaled;
                assert!(is_close, "{factor:e} {}: {a:e} for {scaled:e}", case.name);
            }
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
    let semi = Matrix::diagonal(&[1.0, 0.0]);
    assert!(Metrics::UNIT.with_object(&semi).is_err() && Metrics::UNIT.with_joint(&semi).is_err());
    assert!(Metrics::UNIT.with_wrench(&semi).is_err() && Metrics::UNIT.with_torque(&semi).is_err());
}

/// A metric carried to a task measures images by the least behind them, forces by what they are;
/// for components of a diagonal metric these are its entries.
#[test]
fn metrics_of_tasks() {
    let mut random = Random(97);
    let relation = relation("fivebar_sec5_case_c");
    let w = spd(&mut random, 3);
    let map = random.matrix(2, 3);
    let metrics = Metrics::UNIT.with_object(&w).unwrap();
    let task = metrics.for_task(&map).unwrap();
    let own = metrics.with_wrench(&w).unwrap().for_task(&map).unwrap();
    let (least, of_force) = (task.object.unwrap(), own.wrench.unwrap());
    for _ in 0..20 {
        // Of all x + kernel the least has the length of the image.
        let x = random.vector(3);
        let mut y = map.mul_vec(&x);
        least.whiten(&mut y);
        let mut whole = x.clone();
        Metric::new("w", &w).unwrap().whiten(&mut whole);
        let norm = |v: &[f64]| v.iter().map(|a| a * a).sum::<f64>();
        assert!(norm(&y) <= norm(&whole) * (1.0 + 1e-12));
        let mut f = random.vector(2);
        let mut wrench = map.transpose().mul_vec(&f);
        of_force.whiten(&mut f);
        Metric::new("w", &w).unwrap().whiten(&mut wrench);
        assert!((norm(&f) - norm(&wrench)).abs() < 1e-12);
    }
    // And least it is: x = W^-1 T^T (T W^-1 T^T)^-1 y attains it, so that duals agree.
    let diagonal = Metrics::UNIT.with_object(&Matrix::diagonal(&[4.0, 9.0, 16.0])).unwrap();
    let pick = Matrix::from_rows(&[[0.0, 0.0, 1.0], [1.0, 0.0, 0.0]]).unwrap();
    let picked = diagonal.for_task(&pick).unwrap().object.unwrap();
    assert_eq!(picked, Metric::diagonal("w", &[16.0, 4.0]).unwrap());
    let all = Manipulability::of(&relation, &diagonal).unwrap();
    let same = relation.task(&Matrix::identity(3)).unwrap();
    let same =
        Manipulability::of(&same, &diagonal.for_task(&Matrix::identity(3)).unwrap()).unwrap();
    assert_close("identity", &same.kinematic.values(), &all.kinematic.values(), 1e-12);
    for bad in [Matrix::zeros(2, 3), Matrix::identity(2), Matrix::zeros(4, 3)] {
        assert!(diagonal.for_task(&bad).is_err());
    }
}

/// A link of 2 kg on a hinge, its centre of mass off the axis; a plate screwed to it counts too.
fn massive(dimension: Dimension) -> Mechanism {
    let inertial = |mass, center| {
        Some(Inertial {
            mass,
            link_from_inertia: Pose::from_translation(center),
            inertia: Mat3::from_rows([[0.3, 0.0, 0.0], [0.0, 0.4, 0.0], [0.0, 0.0, 0.5]]),
        })
    };
    let mut b = Mechanism::builder("massive");
    b.dimension(dimension);
    b.link(Link { inertial: inertial(2.0, Vec3::new(0.1, -0.2, 0.0)), ..Link::named("arm") });
    b.link(Link { inertial: inertial(1.0, Vec3::new(0.0, 0.3, 0.0)), ..Link::named("plate") });
    b.joint(JointSpec::new("turn", JointKind::Revolute, "ground", "arm"));
    b.joint(JointSpec {
        parent_from_joint: Pose::from_translation(Vec3::new(0.5, 0.0, 0.0)),
        ..JointSpec::new("screw", JointKind::Fixed, "arm", "plate")
    });
    b.build().unwrap()
}

/// `u^T W u` is twice the energy of both links, their own turning included.
#[test]
fn inertia_is_kinetic_energy() {
    let mut random = Random(98);
    let m = massive(Dimension::Spatial);
    let state = m.state(&[0.7]).unwrap();
    let frame = m.frame("plate").unwrap();
    let w = body_inertia(&state, frame).unwrap().unwrap();
    for _ in 0..10 {
        let u = random.twist();
        let pose = state.pose(frame).unwrap();
        let mut twice = 0.0;
        for link in ["arm", "plate"] {
            let id = m.frame(link).unwrap();
            let inertial = m.links()[m.frame_of(id).link].inertial.unwrap();
            let at = state.pose(id).unwrap() * inertial.link_from_inertia;
            let v = u.linear + u.angular.cross(at.translation - pose.translation);
            let turn = at.rotation.inverse() * u.angular;
            twice += inertial.mass * v.dot(v) + turn.dot(inertial.inertia * turn);
        }
        let array = u.to_array();
        let energy: f64 = w.mul_vec(&array).iter().zip(array).map(|(a, b)| a * b).sum();
        assert!((energy - twice).abs() < 1e-12 * twice);
    }
    // As a metric: the efficiency of the turning joint is its moment of inertia about the axis.
    let j = state.jacobian(frame, ReferenceFrame::LocalWorldAligned).unwrap();
    let relation = MotionSpace::of(&Constraint::serial(&j).unwrap()).relation();
    let metrics = Metrics::UNIT.with_inertia(&state, frame).unwrap();
    let value = Manipulability::of(&relation, &metrics).unwrap().kinematic.values()[0];
    let about = 0.5 + 0.5 + 2.0 * (0.01 + 0.04) + (0.25 + 0.09);
    assert!((value - about).abs() < 1e-12, "{value} {about}");
    let plane = massive(Dimension::Planar);
    let w =
        body_inertia(&plane.state(&[0.7]).unwrap(), plane.frame("arm").unwrap()).unwrap().unwrap();
    assert_eq!((w.rows(), w[(0, 0)]), (3, 3.0));
    assert!((w[(2, 2)] - about).abs() < 1e-12);
}

#[test]
fn inertia_that_is_not_there() {
    let m = crate::support::planar(2);
    let state = m.state(&[0.0, 0.0]).unwrap();
    let frame = m.frame("link2").unwrap();
    assert!(body_inertia(&state, frame).unwrap().is_none());
    let error = Metrics::UNIT.with_inertia(&state, frame).unwrap_err().to_string();
    assert!(error.contains("link 'link2' has no mass"), "{error}");
}

/// Units of the task change efficiencies by their square, also far from one; rows whose squares are no
/// numbers are refused.
#[test]
fn sizes_of_tasks() {
    let relation = relation("fivebar_sec5_case_c");
    let map = |size: f64| {
        let entry = |i: usize, j: usize| if i == j { size * [1.0, 0.5][i] } else { 0.1 * size };
        Matrix::from_fn(2, relation.object(), entry)
    };
    let of = |size: f64| {
        let task = relation.task(&map(size))?;
        Manipulability::of(&task, &Metrics::UNIT.for_task(&map(size))?)
    };
    let unit = |size: f64| Manipulability::of(&relation.task(&map(size)).unwrap(), &Metrics::UNIT);
    // In the metric of the smallest twists units do not count; in that of the numbers they do.
    let (one, plain) = (of(1.0).unwrap(), unit(1.0).unwrap());
    for size in [1e-118, 1e-70, 1e-9, 1e9, 1e70, 1e118] {
        assert_close(
            "kinematic",
            &of(size).unwrap().kinematic.values(),
            &one.kinematic.values(),
            1e-9,
        );
        let scaled: Vec<f64> =
            unit(size).unwrap().kinematic.values().iter().map(|v| v / size / size).collect();
        assert_close("scaled", &scaled, &plain.kinematic.values(), 1e-9);
    }
    for size in [5e-319, 5e-300, 1e-121, 1e121, 1e200, 1e300] {
        let error = of(size).unwrap_err().to_string();
        assert!(error.contains("row 1 of the map") && error.contains("1e-120 to 1e120"), "{error}");
    }
}
