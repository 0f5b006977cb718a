//! Poses of the tool: a configuration of each by inverse kinematics, alone or in any part.

use cylindroid::control::Task;
use cylindroid::ik::{Goal, IkOptions, solve};
use cylindroid::kinematics::EndEffector;
use cylindroid::spatial::Quaternion;
use cylindroid::sweep::{
    Axis, DesignSpace, Quantity, Source, Statistics, Sweep, SweepOptions, Values, WriteOptions,
};
use cylindroid::{Mechanism, Pose, Rotation, Vec3};

use crate::{bits, configurations, of, two_links};

const TOLERANCE: f64 = 1e-6;

fn counts<'a>(values: Option<&'a Values>, name: &str) -> &'a [u64] {
    match values {
        Some(Values::Counts(counts)) => counts,
        _ => panic!("{name}"),
    }
}

/// The default frame: of closed chains the reference.
fn pose(robot: &Mechanism, q: &[f64]) -> Pose {
    let frame = if robot.is_closed() { robot.reference() } else { robot.tool() };
    robot.state(q).unwrap().pose(frame).unwrap()
}

/// Poses of samples are reached, by the configurations that `ik::solve` gives, others are not, and
/// each row is the same alone.
#[test]
fn poses_of_samples_are_reached() {
    for name in ["panda", "ur5e", "3r", "five-bar"] {
        let robot = cylindroid::load(name).unwrap();
        let planar = Task::named("pose", &robot).unwrap();
        // A five-bar moves its object along x and y alone.
        let task = if name == "five-bar" { Task::POSITION } else { planar };
        let mut targets: Vec<Pose> = if robot.is_closed() {
            [[1.0, 1.5], [1.2, 1.8], [0.8, 1.6]]
                .map(|[x, y]| Pose::from_translation(Vec3::new(x, y, 0.0)))
                .to_vec()
        } else {
            let samples = of(&robot, Source::Samples { count: 12, seed: 5 }, &[]);
            let table = samples.table(0..12).unwrap();
            configurations(&robot, &table).iter().map(|q| pose(&robot, q)).collect()
        };
        let inside = targets.len();
        let far = targets[0].translation + Vec3::X * (10.0 * robot.reach());
        targets.insert(2, Pose { translation: far, ..targets[0] });
        let quantities = [Quantity::Pose, Quantity::LimitDistance];
        let source = Source::Poses { targets: targets.clone(), task };
        let sweep = of(&robot, source, &quantities);
        let rows = sweep.rows();
        assert_eq!(rows, targets.len() as u64);
        let table = sweep.table(0..rows).unwrap();
        let reached = counts(table.column("reached"), name);
        assert_eq!(reached.iter().sum::<u64>(), inside as u64, "{name}: {reached:?}");
        let margins = table.numbers("limit_distance").unwrap();
        for (row, q) in configurations(&robot, &table).iter().enumerate() {
            if row == 2 {
                assert!(reached[row] == 0 && q[0].is_nan() && margins[row].is_nan());
                continue;
            }
            assert!(margins[row] >= 0.0, "{name}, row {row}");
            let (found, target) = (pose(&robot, q), targets[row]);
            let distance = (found.translation - target.translation).norm();
            assert!(distance < TOLERANCE * robot.reach(), "{name}, row {row}: {distance}");
            if task == planar {
                let error = found.error_to(target);
                assert!(error.angular.norm() < TOLERANCE, "{name}, row {row}");
            }
            let frame = if robot.is_closed() { robot.reference() } else { robot.tool() };
            let options =
                IkOptions { position_tolerance: TOLERANCE * robot.reach(), ..IkOptions::default() };
            let single = solve(&robot, &[Goal::frame(frame, task, target)], &options).unwrap();
            assert_eq!(single.q, *q, "{name}, row {row}");
        }
        for row in (0..rows).rev() {
            let alone = sweep.table(row..row + 1).unwrap();
            for (alone, all) in bits(&alone).iter().zip(bits(&table)) {
                assert_eq!(alone[0], all[usize::try_from(row).unwrap()], "{name}, row {row}");
            }
        }
    }
}

/// The columns of a file: those that the quantity `pose` writes.
#[test]
fn rows_of_numbers_are_poses() {
    let robot = cylindroid::load("panda").unwrap();
    let samples = of(&robot, Source::Samples { count: 5, seed: 1 }, &[Quantity::Pose]);
    let table = samples.table(0..5).unwrap();
    let names = Source::pose_columns(Task::POSE);
    let columns: Vec<&[f64]> = names.iter().map(|name| table.numbers(name).unwrap()).collect();
    let rows: Vec<f64> = (0..5).flat_map(|i| columns.iter().map(move |c| c[i])).collect();
    // Quaternions of another length are the same rotation.
    let longer: Vec<f64> = rows
        .chunks(7)
        .flat_map(|row| {
            let factor = |(i, x): (usize, &f64)| if i < 3 { *x } else { -2.5 * x };
            row.iter().enumerate().map(factor).collect::<Vec<_>>()
        })
        .collect();
    let all = configurations(&robot, &table);
    for numbers in [rows, longer] {
        let Source::Poses { targets, .. } = Source::poses(&numbers, Task::POSE).unwrap() else {
            panic!()
        };
        for (target, q) in targets.iter().zip(&all) {
            let error = target.error_to(pose(&robot, q));
            assert!(error.linear.norm() + error.angular.norm() < 1e-12);
        }
    }
    assert_eq!(Source::pose_columns(Task::POSITION), ["x", "y", "z"]);
    let Source::Poses { targets, .. } = Source::poses(&[1.0, 2.0, 3.0], Task::POSITION).unwrap()
    else {
        panic!()
    };
    assert_eq!(targets, [Pose::from_translation(Vec3::new(1.0, 2.0, 3.0))]);
    for (numbers, told) in [
        (vec![0.0; 6], "a row has 7"),
        (vec![0.0; 7], "must be finite and not zero"),
        ([vec![0.0; 6], vec![1.0], vec![0.0; 2], vec![f64::NAN; 5]].concat(), "row 1 from 0, z"),
    ] {
        let error = Source::poses(&numbers, Task::POSE).unwrap_err().to_string();
        assert!(error.contains(told), "{error}");
    }
}

#[test]
fn what_inverse_kinematics_does_not_take_is_refused() {
    let new = |name: &str, source: Source| {
        let robot = cylindroid::load(name).unwrap();
        Sweep::new(&robot, SweepOptions { source, ..Default::default() })
    };
    let rotation = Quaternion { w: 1.0, x: 0.0, y: 0.0, z: 0.0 }.rotation().unwrap();
    let nan = Pose { rotation, translation: Vec3::new(0.0, f64::NAN, 0.0) };
    let error =
        new("panda", Source::Poses { targets: vec![Pose::IDENTITY, nan], task: Task::POSE });
    assert!(error.unwrap_err().to_string().contains("row 1"));
    let far = Pose { translation: Vec3::new(1e300, 0.0, 0.0), ..nan };
    let error = new("panda", Source::Poses { targets: vec![far], task: Task::POSE });
    assert!(error.unwrap_err().to_string().contains("row 0"));
    // Of an orientation of a platform one component alone.
    let mut task = Task::POSITION;
    task.components[3] = true;
    let error = new("stewart", Source::Poses { targets: vec![Pose::IDENTITY], task });
    assert!(error.is_err());
    let none = new("panda", Source::Poses { targets: vec![], task: Task::POSE }).unwrap();
    assert_eq!(none.rows(), 0);
    assert_eq!(none.table(0..0).unwrap().rows(), 0);
}

/// Longer links reach farther.
#[test]
fn designs_reach_other_poses() {
    let model = two_links();
    let far = |x: f64| Pose::from_translation(Vec3::new(x, 0.1, 0.0));
    let task = Task::named("position", model.nominal()).unwrap();
    let source = Source::Poses { targets: vec![far(0.3), far(0.7)], task };
    let over = vec![Axis { name: "link".to_owned(), from: 0.2, to: 0.4, count: 2 }];
    let options = SweepOptions { source, quantities: vec![], ..Default::default() };
    let sweep = Sweep::of_designs(&model, DesignSpace::Grid(over), options).unwrap();
    let table = sweep.table(0..4).unwrap();
    assert_eq!(counts(table.column("reached"), "reached"), [1, 0, 1, 1]);
}

/// A tool point is reached, of arms and of closed chains; the direction of the tool alone, for an arm
/// of five joints.
#[test]
fn tools_and_directions_are_reached() {
    for (name, task) in [("ur5e", Task::POSE), ("stewart", Task::POSE)] {
        let robot = cylindroid::load(name).unwrap();
        let frame = if robot.is_closed() { robot.reference() } else { robot.tool() };
        let frame_from_tool = Pose::from_translation(Vec3::new(0.1, 0.2, 0.3));
        let end_effector = EndEffector { frame, frame_from_tool };
        let target = pose(&robot, robot.home()) * frame_from_tool;
        let options = SweepOptions {
            source: Source::Poses { targets: vec![target], task },
            quantities: vec![Quantity::Pose],
            end_effector: Some(end_effector),
            ..Default::default()
        };
        let table = Sweep::new(&robot, options).unwrap().table(0..1).unwrap();
        assert_eq!(counts(table.column("reached"), name), [1], "{name}");
        let q = &configurations(&robot, &table)[0];
        let found = pose(&robot, q) * frame_from_tool;
        let error = found.error_to(target);
        assert!(error.linear.norm() + error.angular.norm() < 1e-5, "{name}");
        let x = table.numbers("x").unwrap()[0];
        assert!((x - target.translation.x).abs() < 1e-5, "{name}");
    }
    let robot = cylindroid::load("youbot").unwrap();
    let mut q = robot.home().to_vec();
    q.iter_mut().for_each(|x| *x += 0.1);
    let turned = Rotation::about(Vec3::Z, 1.0).unwrap();
    let target = pose(&robot, &q) * Pose::from_rotation(turned);
    let of = |task: Task, quantities: &[Quantity]| {
        let source = Source::Poses { targets: vec![target], task };
        let quantities = quantities.to_vec();
        let options = SweepOptions { source, quantities, task: Some(task), ..Default::default() };
        Sweep::new(&robot, options).map(|sweep| sweep.table(0..1).unwrap())
    };
    let pointing = of(Task::POINTING, &[Quantity::LimitDistance]).unwrap();
    assert_eq!(counts(pointing.column("reached"), "pointing"), [1]);
    assert!(of(Task::POINTING, &[Quantity::Condition]).is_err());
    assert!(of(Task::POSE, &[Quantity::Condition]).is_ok());
}

/// Counts of poses that are not reached take no part in statistics, and folders know their poses.
#[test]
fn rows_without_a_configuration_have_no_statistics() {
    let robot = cylindroid::load("ur5e").unwrap();
    let home = pose(&robot, robot.home());
    let far = Pose::from_translation(Vec3::X * 9.0);
    let source = |targets: Vec<Pose>| Source::Poses { targets, task: Task::POSE };
    let sweep =
        of(&robot, source(vec![far, home, far]), &[Quantity::Measures, Quantity::GibsonHunt]);
    let table = sweep.table(0..3).unwrap();
    for all in [sweep.statistics(None, |_| true).unwrap().unwrap(), sweep.statistics_of(&table)] {
        for (column, statistics) in all {
            let Statistics::Numbers { smallest, largest, not_finite, .. } = statistics else {
                let Statistics::Texts(names) = statistics else { panic!() };
                assert!(names.len() == 1 && names[0].1 == 1 && !names[0].0.is_empty());
                continue;
            };
            if column.name == "reached" {
                assert_eq!((smallest, largest, not_finite), (0.0, 1.0, 0));
            } else {
                assert!(not_finite >= 2 && !(smallest < largest), "{}", column.name);
            }
        }
    }
    let folder = tempfile::tempdir().unwrap();
    sweep.write(folder.path(), &WriteOptions::default(), |_| true).unwrap();
    let resume = WriteOptions { resume: true, ..WriteOptions::default() };
    sweep.write(folder.path(), &resume, |_| true).unwrap();
    let quantities = [Quantity::Measures, Quantity::GibsonHunt];
    let other = of(&robot, source(vec![home, home, far]), &quantities);
    let error = other.write(folder.path(), &resume, |_| true).unwrap_err().to_string();
    assert!(error.contains("configurations.poses_checksum"), "{error}");
}
