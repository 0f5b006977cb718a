//! The columns against the analysis of one configuration.

use cylindroid::closure::{ClosedChain, MotionSpace};
use cylindroid::ik::Task;
use cylindroid::linalg::Svd;
use cylindroid::manipulability::{BatchOptions, Manipulability, ManipulabilityBatch, Metrics};
use cylindroid::screws::{Class, ScrewOptions};
use cylindroid::sweep::{
    Quantity, Source, Statistics, Sweep, SweepOptions, Values, VelocityMetric,
};
use cylindroid::{Matrix, ReferenceFrame, ScrewSystem, Vec3};

use crate::{configurations, of, samples};

#[test]
fn poses_and_jacobians_are_those_of_a_state() {
    for model in ["panda", "ur5e", "youbot", "3r"] {
        let robot = cylindroid::load(model).unwrap();
        let sweep = samples(model, 300, &[Quantity::Pose, Quantity::Jacobian]);
        let table = sweep.table(0..300).unwrap();
        for (i, q) in configurations(&robot, &table).iter().enumerate() {
            let state = robot.state(q).unwrap();
            let pose = state.pose(robot.tool()).unwrap();
            let at = |name: &str| table.numbers(name).unwrap()[i];
            let quaternion = pose.rotation.to_quaternion();
            let (t, r) = (pose.translation, quaternion);
            let expected = [t.x, t.y, t.z, r.w, r.x, r.y, r.z];
            for (name, x) in ["x", "y", "z", "qw", "qx", "qy", "qz"].iter().zip(expected) {
                assert!((at(name) - x).abs() < 1e-13, "{model} {name}");
            }
            let j = state.jacobian(robot.tool(), ReferenceFrame::LocalWorldAligned).unwrap();
            for (row, name) in ["vx", "vy", "vz", "wx", "wy", "wz"].iter().enumerate() {
                for (column, c) in robot.coordinates().iter().enumerate() {
                    let found = at(&format!("jacobian_{name}_{}", c.name));
                    assert!((found - j[(row, column)]).abs() < 1e-13, "{model} {name} {}", c.name);
                }
            }
        }
    }
}

#[test]
fn singular_values_and_what_follows_from_them() {
    let quantities = [
        Quantity::SingularValues,
        Quantity::SmallestSingularValue,
        Quantity::Condition,
        Quantity::Yoshikawa,
        Quantity::LimitDistance,
    ];
    for model in ["panda", "ur5e", "youbot", "3r"] {
        let robot = cylindroid::load(model).unwrap();
        let planar = robot.dimension() == cylindroid::model::Dimension::Planar;
        let rows: &[usize] = if planar { &[0, 1, 5] } else { &[0, 1, 2, 3, 4, 5] };
        let table = samples(model, 203, &quantities).table(0..203).unwrap();
        for (i, q) in configurations(&robot, &table).iter().enumerate() {
            let at = |name: &str| table.numbers(name).unwrap()[i];
            let state = robot.state(q).unwrap();
            let j = state.jacobian(robot.tool(), ReferenceFrame::LocalWorldAligned).unwrap();
            let of = |length: f64| {
                let scale = |r: usize| if r < 3 { 1.0 / length } else { 1.0 };
                Svd::of(&Matrix::from_fn(rows.len(), robot.n(), |r, c| {
                    scale(rows[r]) * j[(rows[r], c)]
                }))
            };
            let scaled: Vec<f64> = of(robot.reach()).values().collect();
            for (k, x) in scaled.iter().enumerate() {
                let found = at(&format!("singular_value_{}", k + 1));
                assert!((found - x).abs() < 1e-13 * scaled[0], "{model}: {found} for {x}");
            }
            let (first, last) = (scaled[0], scaled[scaled.len() - 1]);
            assert!((at("smallest_singular_value") - last).abs() < 1e-13 * first);
            assert!((1.0 / at("condition") - last / first).abs() < 1e-13);
            let volume: f64 = of(1.0).values().product();
            assert!((at("yoshikawa") - volume).abs() < 1e-12, "{model}");
            let limits = robot.coordinates().iter().map(|c| c.limits).zip(q);
            let distance =
                limits.map(|(l, x)| (x - l.lower).min(l.upper - x)).fold(f64::INFINITY, f64::min);
            assert_eq!(at("limit_distance"), distance);
        }
    }
}

/// Yoshikawa's measure of a task in a metric is that of `manipulability`.
#[test]
fn tasks_and_metrics_are_those_of_manipulability() {
    let robot = cylindroid::load("panda").unwrap();
    for metric in VelocityMetric::ALL {
        for task in [Some("position"), Some("z, rx"), None] {
            let options = SweepOptions {
                source: Source::Samples { count: 40, seed: 1 },
                quantities: vec![Quantity::Yoshikawa],
                task: task.map(|name| Task::named(name, &robot).unwrap()),
                metric,
                ..Default::default()
            };
            let table = Sweep::new(&robot, options).unwrap().table(0..40).unwrap();
            for (i, q) in configurations(&robot, &table).iter().enumerate() {
                let state = robot.state(q).unwrap();
                let chain = ClosedChain::of(&state, Some(robot.tool()), None).unwrap();
                let relation = MotionSpace::of(&chain.constraint).relation();
                let length = chain.constraint.length();
                let scaled = || Metrics::characteristic_length(&chain.units, length).unwrap();
                let limits: Vec<f64> =
                    robot.coordinates().iter().map(|c| c.limits.velocity).collect();
                let mut metrics = match metric {
                    VelocityMetric::Length => scaled(),
                    VelocityMetric::Limits => scaled().with_velocity_limits(&limits).unwrap(),
                    _ => Metrics::UNIT,
                };
                let mut relation = relation;
                if let Some(name) = task {
                    let components = Task::named(name, &robot).unwrap().components;
                    let rows: Vec<usize> = (0..6).filter(|i| components[*i]).collect();
                    let map =
                        Matrix::from_fn(rows.len(), 6, |i, j| f64::from(u8::from(rows[i] == j)));
                    relation = relation.task(&map).unwrap();
                    if metric != VelocityMetric::Unit {
                        metrics = metrics.for_task(&map).unwrap();
                    }
                }
                let expected = Manipulability::of(&relation, &metrics).unwrap().kinematic.volume();
                let found = table.numbers("yoshikawa").unwrap()[i];
                let place = format!("{} {task:?}", metric.name());
                assert!((found - expected).abs() < 1e-11 * expected, "{place}: {found}");
            }
        }
    }
}

/// What a sweep computes where no quantities are named.
#[test]
fn usual_quantities() {
    let usual = |model| Quantity::usual(&cylindroid::load(model).unwrap());
    let names: Vec<&str> = usual("panda").iter().map(|q| q.name()).collect();
    let all = ["pose", "yoshikawa", "smallest_singular_value", "limit_distance", "gibson_hunt"];
    assert_eq!(names, all);
    assert_eq!(usual("five-bar"), [Quantity::Pose, Quantity::Measures]);
    // A regular arm of seven joints moves in all directions.
    let table = samples("panda", 20, usual("panda")).table(0..20).unwrap();
    let Some(Values::Texts(classes)) = table.column("gibson_hunt") else { panic!() };
    assert!(classes.iter().all(|found| *found == Class::Full.name()), "{classes:?}");
}

#[test]
fn screw_systems_are_those_of_screws() {
    for model in ["youbot", "3r", "ur5e", "panda"] {
        let robot = cylindroid::load(model).unwrap();
        let table = samples(model, 50, &[Quantity::GibsonHunt]).table(0..50).unwrap();
        let Some(Values::Texts(classes)) = table.column("gibson_hunt") else { panic!() };
        for (i, q) in configurations(&robot, &table).iter().enumerate() {
            let state = robot.state(q).unwrap();
            let j = state.jacobian(robot.tool(), ReferenceFrame::LocalWorldAligned).unwrap();
            let options = ScrewOptions::with_length(robot.reach());
            let system = ScrewSystem::of_columns(&j, &options).unwrap();
            assert_eq!(classes[i], system.class().name());
            let pitches = system.principal_pitches();
            for k in 0..3 {
                let found = table.numbers(&format!("principal_pitch_{}", k + 1)).unwrap()[i];
                match pitches.get(k) {
                    Some(h) => assert!((found - h).abs() < 1e-9, "{model}: {found} for {h}"),
                    None => assert!(found.is_nan()),
                }
            }
        }
    }
}

#[test]
fn measures_are_those_of_the_batch() {
    let stewart = cylindroid::load("stewart").unwrap();
    let q = [stewart.home(), stewart.home(), stewart.home()].concat();
    let batch = ManipulabilityBatch::new(&stewart, &BatchOptions::default()).unwrap();
    let expected = batch.analyse(&q).unwrap();
    let table = of(&stewart, Source::Configurations(q), &[Quantity::Measures]).table(0..3).unwrap();
    for (k, name) in ManipulabilityBatch::COLUMNS.iter().enumerate() {
        let own = expected.iter().skip(k).step_by(ManipulabilityBatch::WIDTH);
        match table.column(name).unwrap() {
            Values::Counts(counts) => assert!(own.zip(counts).all(|(x, c)| *x == *c as f64)),
            Values::Numbers(numbers) => {
                assert!(own.zip(numbers).all(|(x, y)| x.to_bits() == y.to_bits()), "{name}");
            }
            _ => panic!(),
        }
    }
}

/// Of a task, and in the plane.
#[test]
fn measures_of_a_task_are_those_of_the_batch() {
    for (model, task, rows) in [
        ("3r", Task::POSITION, &[0, 1, 2][..]),
        (
            "panda",
            Task { components: [true, false, false, false, false, true], ..Task::POSE },
            &[0, 5],
        ),
        (
            "five-bar",
            Task { components: [false, true, false, false, false, true], ..Task::POSE },
            &[1, 2],
        ),
    ] {
        let robot = cylindroid::load(model).unwrap();
        let size = if robot.is_closed() { 3 } else { 6 };
        let map = Matrix::from_fn(rows.len(), size, |i, j| f64::from(u8::from(rows[i] == j)));
        let length = robot.reach();
        let state = robot.state(robot.home()).unwrap();
        let units = ClosedChain::of(&state, None, Some(length)).unwrap().units;
        for metric in [VelocityMetric::Unit, VelocityMetric::Length] {
            let metrics = match metric {
                VelocityMetric::Unit => Metrics::UNIT,
                _ => {
                    let whole = Metrics::characteristic_length(&units, length).unwrap();
                    whole.for_task(&map).unwrap()
                }
            };
            let reference = if robot.is_closed() { robot.reference() } else { robot.tool() };
            let options = BatchOptions {
                reference: Some(reference),
                metrics,
                task: Some(map.clone()),
                ..BatchOptions::default()
            };
            let batch = ManipulabilityBatch::new(&robot, &options).unwrap();
            let source = Source::Configurations(robot.home().to_vec());
            let quantities = vec![Quantity::Measures];
            let task = Some(task);
            let options = SweepOptions { source, quantities, task, metric, ..Default::default() };
            let table = Sweep::new(&robot, options).unwrap().table(0..1).unwrap();
            let expected = batch.analyse(robot.home()).unwrap();
            for (name, x) in ManipulabilityBatch::COLUMNS.iter().zip(expected) {
                match table.column(name).unwrap() {
                    Values::Counts(counts) => assert!(counts[0] as f64 == x, "{model} {name}"),
                    Values::Numbers(own) => {
                        assert!(own[0].to_bits() == x.to_bits(), "{model} {name}");
                    }
                    _ => panic!(),
                }
            }
        }
    }
}

#[test]
fn statistics_are_those_of_the_table() {
    let robot = cylindroid::load("youbot").unwrap();
    let options = SweepOptions {
        source: Source::Samples { count: 1000, seed: 2 },
        quantities: vec![Quantity::Yoshikawa, Quantity::GibsonHunt],
        part_rows: 61, // not a multiple of the lanes of sums
        ..Default::default()
    };
    let sweep = Sweep::new(&robot, options).unwrap();
    let table = sweep.table(0..1000).unwrap();
    let found = sweep.statistics(None, |_| true).unwrap().unwrap();
    let alone = sweep.statistics(1.try_into().ok(), |_| true).unwrap().unwrap();
    // In words, which compare what is not a number too.
    assert_eq!(format!("{found:?}"), format!("{alone:?}"));
    assert_eq!(found.len(), table.columns.len() - 1);
    for (column, statistics) in found {
        match statistics {
            Statistics::Texts(names) => {
                assert_eq!(names.iter().map(|n| n.1).sum::<u64>(), 1000);
            }
            Statistics::Numbers { smallest, mean, largest, not_finite } => {
                let own: Vec<f64> = (table.numbers(&column.name).unwrap().iter().copied())
                    .filter(|x| x.is_finite())
                    .collect();
                assert_eq!(not_finite, 1000 - own.len() as u64, "{}", column.name);
                if own.is_empty() {
                    assert!(mean.is_nan());
                    continue;
                }
                let sum: f64 = own.iter().sum();
                assert!((mean - sum / own.len() as f64).abs() < 1e-12 * largest.abs().max(1.0));
                assert_eq!(smallest, own.iter().copied().fold(f64::INFINITY, f64::min));
                assert_eq!(largest, own.iter().copied().fold(f64::NEG_INFINITY, f64::max));
            }
            _ => panic!(),
        }
    }
    assert!(sweep.statistics(None, |_| false).unwrap().is_none());
}

#[test]
fn quantities_that_do_not_exist_are_refused() {
    let refused = |model: &str, options: SweepOptions| {
        let robot = cylindroid::load(model).unwrap();
        let source = Source::Configurations(robot.home().to_vec());
        Sweep::new(&robot, SweepOptions { source, ..options }).unwrap_err().to_string()
    };
    let with = |quantities: &[Quantity]| SweepOptions {
        quantities: quantities.to_vec(),
        ..Default::default()
    };
    let two = with(&[Quantity::Pose, Quantity::Pose]);
    assert!(refused("panda", two).contains("named twice"));
    assert!(refused("five-bar", with(&[Quantity::Yoshikawa])).contains("use measures"));
    let with_task = |task: Task| SweepOptions { task: Some(task), ..Default::default() };
    let local = Task { axes: ReferenceFrame::Local, ..Task::POSITION };
    assert!(refused("panda", with_task(local)).contains("world axes"));
    let none = Task { components: [false; 6], ..Task::POSE };
    assert!(refused("panda", with_task(none)).contains("at least one"));
    let length = SweepOptions { length: Some(0.0), ..Default::default() };
    assert!(refused("panda", length).contains("within a factor of 1e5"));
    let direction = SweepOptions { direction: Vec3::new(0.0, f64::NAN, 1.0), ..Default::default() };
    assert!(refused("panda", direction).starts_with("direction[1]"));
    let metric = VelocityMetric::Limits;
    let limits = SweepOptions { metric, ..with(&[Quantity::Yoshikawa]) };
    assert!(refused("puma560", limits).contains("no velocity limit"));
    assert!(Quantity::named("yoshikava").unwrap_err().to_string().contains("yoshikawa"));
}
