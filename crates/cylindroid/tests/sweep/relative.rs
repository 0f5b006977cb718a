//! Two arms together: quantities of one hand as seen from the other.

use std::fs;
use std::path::Path;

use cylindroid::ik::Task;
use cylindroid::linalg::Svd;
use cylindroid::sweep::{
    Axis, DesignSpace, ParameterRange, Quantity, Source, Sweep, SweepOptions, Table, Values,
    VelocityMetric, VoxelGrid, WriteOptions,
};
use cylindroid::{Matrix, Mechanism, ParametricModel, Pose};
use serde_json::Value;

use crate::parts::in_any_order;
use crate::{bits, configurations};

const TWO_ARMS: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../docs/two-arms.toml");
const OF_JACOBIAN: [Quantity; 6] = [
    Quantity::Jacobian,
    Quantity::SingularValues,
    Quantity::SmallestSingularValue,
    Quantity::Condition,
    Quantity::Yoshikawa,
    Quantity::GibsonHunt,
];

fn two_arms() -> Mechanism {
    cylindroid::load(TWO_ARMS).unwrap()
}

/// Of a frame as seen from another.
fn seen(robot: &Mechanism, [frame, base]: [&str; 2], quantities: &[Quantity]) -> SweepOptions {
    SweepOptions {
        source: Source::Samples { count: 200, seed: 6 },
        quantities: quantities.to_vec(),
        end_effector: Some(robot.frame(frame).unwrap().into()),
        relative_to: Some(robot.frame(base).unwrap()),
        part_rows: 31,
        ..SweepOptions::default()
    }
}

fn table(robot: &Mechanism, options: SweepOptions) -> Table {
    let sweep = Sweep::new(robot, options).unwrap();
    sweep.table(0..sweep.rows()).unwrap()
}

const HANDS: [&str; 2] = ["left/hand_tcp", "right/hand_tcp"];

/// Poses and Jacobians to the bit, measures with any task and metric.
#[test]
fn columns_are_those_of_relative_jacobians() {
    let robot = two_arms();
    let limits: Vec<f64> = robot.coordinates().iter().map(|c| c.limits.velocity).collect();
    let [tool, base] = HANDS.map(|name| robot.frame(name).unwrap());
    for (task, metric) in [
        (None, VelocityMetric::Unit),
        (None, VelocityMetric::Limits),
        (Some("position"), VelocityMetric::Length),
        (Some("z,rx"), VelocityMetric::Unit),
    ] {
        let task = task.map(|name| Task::named(name, &robot).unwrap());
        let quantities = [&[Quantity::Pose, Quantity::LimitDistance], &OF_JACOBIAN[..]].concat();
        let options =
            SweepOptions { task, metric, length: Some(0.4), ..seen(&robot, HANDS, &quantities) };
        let found = table(&robot, options.clone());
        let components = task.unwrap_or(Task::POSE).components;
        let rows: Vec<usize> = (0..6).filter(|i| components[*i]).collect();
        let scaled = |j: &Matrix, factor: &dyn Fn(usize) -> f64, columns: &[f64]| {
            Svd::of(&Matrix::from_fn(rows.len(), j.cols(), |i, k| {
                j[(rows[i], k)] * factor(rows[i]) * columns[k]
            }))
        };
        let over_length = |row: usize| if row < 3 { 1.0 / 0.4 } else { 1.0 };
        let column = |name: &str| found.numbers(name).unwrap();
        for (i, q) in configurations(&robot, &found).iter().enumerate() {
            let state = robot.state(q).unwrap();
            let jacobian = state.relative_jacobian(tool, base).unwrap();
            for (row, name) in ["vx", "vy", "vz", "wx", "wy", "wz"].iter().enumerate() {
                for (k, c) in robot.coordinates().iter().enumerate() {
                    let own = column(&format!("jacobian_{name}_{}", c.name))[i];
                    assert_eq!(own.to_bits(), jacobian[(row, k)].to_bits());
                }
            }
            // The torso carries both.
            assert!(jacobian.column(0).iter().all(|x| *x == 0.0));
            let pose: Pose = state.pose(base).unwrap().inverse() * state.pose(tool).unwrap();
            let at = ["x", "y", "z"].map(|name| column(name)[i]);
            assert_eq!(at, pose.translation.to_array());
            let quaternion = ["qw", "qx", "qy", "qz"].map(|name| column(name)[i]);
            let own = pose.rotation.to_quaternion();
            let own = [own.w, own.x, own.y, own.z];
            assert!(quaternion.iter().zip(own).all(|(a, b)| (a - b).abs() < 1e-14));

            let svd = scaled(&jacobian, &over_length, &vec![1.0; robot.n()]);
            let values: Vec<f64> = svd.values().collect();
            for (k, value) in values.iter().enumerate() {
                let own = column(&format!("singular_value_{}", k + 1))[i];
                assert!((own - value).abs() < 1e-13 * values[0], "{own} {value}");
            }
            let last = values[values.len() - 1];
            assert!((column("smallest_singular_value")[i] - last).abs() < 1e-13 * values[0]);
            let condition = column("condition")[i] * last / values[0];
            assert!((condition - 1.0).abs() < 1e-9, "{condition}");
            let own = match metric {
                VelocityMetric::Unit => scaled(&jacobian, &|_| 1.0, &vec![1.0; robot.n()]),
                VelocityMetric::Limits => scaled(&jacobian, &over_length, &limits),
                _ => svd,
            };
            let volume: f64 = own.values().product();
            assert!((column("yoshikawa")[i] - volume).abs() < 1e-10 * volume.max(1e-3));
        }
        // Distances of joints are those without another frame.
        let alone = SweepOptions { relative_to: None, ..options };
        assert_eq!(table(&robot, alone).numbers("limit_distance"), found.numbers("limit_distance"));
    }
}

#[test]
fn parts_threads_and_folders_change_nothing() {
    let robot = two_arms();
    let quantities = [&[Quantity::Pose], &OF_JACOBIAN[..]].concat();
    let sweep = Sweep::new(&robot, seen(&robot, HANDS, &quantities)).unwrap();
    assert_eq!(sweep.relative_to(), Some(robot.frame(HANDS[1]).unwrap()));
    in_any_order(&sweep);
    let folder = tempfile::tempdir().unwrap();
    let expected = bits(&sweep.table(0..200).unwrap());
    let contents = |folder: &Path| {
        let name = |part: usize| folder.join(Sweep::part_name(part));
        let parts = (0..sweep.parts()).map(|part| fs::read(name(part)).unwrap());
        (parts.collect::<Vec<_>>(), fs::read_to_string(folder.join("manifest.json")).unwrap())
    };
    let mut all = Vec::new();
    for threads in [1, 2, 8] {
        let found = sweep.collect(threads.try_into().ok(), |_| true).unwrap().unwrap();
        assert_eq!(bits(&found), expected);
        let own = folder.path().join(threads.to_string());
        let options = WriteOptions { threads: threads.try_into().ok(), resume: false };
        sweep.write(&own, &options, |_| true).unwrap();
        all.push(contents(&own));
    }
    assert!(all[0] == all[1] && all[1] == all[2]);
    // The manifest says from where the frame is seen.
    let manifest: Value = serde_json::from_str(&all[0].1).unwrap();
    assert_eq!(manifest["recipe"]["frame"], HANDS[0]);
    assert_eq!(manifest["recipe"]["relative_to"], HANDS[1]);
    assert!(all[0].1.contains("relative_to_from_frame"), "{}", all[0].1);
    assert!(!all[0].1.contains("world_from_frame"));

    // Stopped and resumed the same, with another base refused.
    let own = folder.path().join("stopped");
    let mut calls = 0;
    let stop = |_: &cylindroid::sweep::Progress| {
        calls += 1;
        calls < 3
    };
    let first = WriteOptions { threads: 1.try_into().ok(), resume: false };
    assert!(!sweep.write(&own, &first, stop).unwrap().complete);
    let resume = WriteOptions { threads: None, resume: true };
    for (base, now) in [(Some("right/link4"), r#""right/link4""#), (None, "null")] {
        let relative_to = base.map(|name| robot.frame(name).unwrap());
        let other = SweepOptions { relative_to, ..seen(&robot, HANDS, &quantities) };
        let error = Sweep::new(&robot, other).unwrap().write(&own, &resume, |_| true);
        let error = error.unwrap_err().to_string();
        let difference = format!(r#"relative_to is "right/hand_tcp" there and {now} now"#);
        assert!(error.contains(&difference), "{error}");
    }
    assert!(sweep.write(&own, &resume, |_| true).unwrap().complete);
    assert!(contents(&own) == all[0]);
}

/// Where the torso stands changes nothing.
#[test]
fn the_world_does_not_count() {
    let robot = two_arms();
    let text = format!(
        "[[robot]]\nname = 'moved'\nmodel = {TWO_ARMS:?}\n\
         base = {{ xyz = [3, -2, 0.7], rpy = [0.4, -1.1, 2.3] }}\n"
    );
    let moved = ParametricModel::of_text(&text, Path::new("moved.toml"), &[]).unwrap();
    let moved = moved.nominal();
    let quantities = [&[Quantity::Pose], &OF_JACOBIAN[..]].concat();
    let of = |robot: &Mechanism, names| {
        let options = SweepOptions { length: Some(0.5), ..seen(robot, names, &quantities) };
        table(robot, options)
    };
    let (a, b) = (of(&robot, HANDS), of(moved, ["moved/left/hand_tcp", "moved/right/hand_tcp"]));
    assert_eq!(a.column("gibson_hunt"), b.column("gibson_hunt"));
    for (column, (a, b)) in a.columns.iter().zip(a.values.iter().zip(&b.values)) {
        let (Values::Numbers(a), Values::Numbers(b)) = (a, b) else { continue };
        for (a, b) in a.iter().zip(b) {
            let near = (a - b).abs() <= 1e-9 * a.abs().max(1.0);
            assert!(near || a.is_nan() && b.is_nan(), "{} {a} {b}", column.name);
        }
    }
}

/// The twist of one hand seen from the other is that of the other seen from the first, reversed and at
/// another point: the measure of the whole twist, the singular values of the angular velocity and the
/// screw system are those of both.
#[test]
fn hands_are_exchanged() {
    let robot = two_arms();
    let of = |frames: [&str; 2], task: Option<&str>| {
        let task = task.map(|name| Task::named(name, &robot).unwrap());
        table(&robot, SweepOptions { task, ..seen(&robot, frames, &OF_JACOBIAN) })
    };
    let exchanged = [HANDS[1], HANDS[0]];
    let same = |names: &[&str], task: Option<&str>| {
        let (a, b) = (of(HANDS, task), of(exchanged, task));
        for name in names {
            let (a, b) = (a.numbers(name).unwrap(), b.numbers(name).unwrap());
            let near = |(a, b): (&f64, &f64)| (a - b).abs() <= 1e-10 * a.abs().max(1e-2);
            assert!(a.iter().zip(b).all(near), "{name}");
        }
        assert_eq!(a.column("gibson_hunt"), b.column("gibson_hunt"));
    };
    same(&["yoshikawa"], None);
    same(&["singular_value_1", "singular_value_3", "condition", "yoshikawa"], Some("orientation"));
}

/// Of some components, or with fewer joints than components, the point and the axes count.
#[test]
fn exchanged_hands_differ_in_tasks() {
    let differ = |robot: &Mechanism, [tool, base]: [&str; 2], task: Option<&str>| {
        let task = task.map(|name| Task::named(name, robot).unwrap());
        let of = |frames| {
            let options = SweepOptions { task, ..seen(robot, frames, &[Quantity::Yoshikawa]) };
            table(robot, options)
        };
        let (a, b) = (of([tool, base]), of([base, tool]));
        let (a, b) = (a.numbers("yoshikawa").unwrap(), b.numbers("yoshikawa").unwrap());
        let far = a.iter().zip(b).filter(|(a, b)| (**a - **b).abs() > 1e-3 * a.abs()).count();
        assert!(far > 150, "{far}");
    };
    let robot = two_arms();
    differ(&robot, HANDS, Some("z,rx"));
    differ(&robot, HANDS, Some("position"));
    differ(&cylindroid::load("panda").unwrap(), ["hand_tcp", "link4"], Some("position"));
}

/// Joints that carry both frames leave fewer than components: the values are those of a sweep whose frame
/// these joints move alone.
#[test]
fn missing_ranks_are_exact() {
    let robot = cylindroid::load("panda").unwrap();
    for (frames, moving) in [
        (["hand_tcp", "link4"], 3),
        (["link4", "hand_tcp"], 3),
        (["hand_tcp", "link2"], 5),
        (["link5", "link1"], 4),
        (["link3", "link2"], 1),
    ] {
        let found = table(&robot, seen(&robot, frames, &OF_JACOBIAN));
        let of = |name: &str| found.numbers(name).unwrap();
        let infinite = of("condition").iter().all(|x| *x == f64::INFINITY);
        assert!(infinite && of("yoshikawa").iter().all(|x| *x == 0.0), "{frames:?}");
        assert!(of("smallest_singular_value").iter().all(|x| *x == 0.0), "{frames:?}");
        for k in 1..=6 {
            let values = of(&format!("singular_value_{k}"));
            assert!(k <= moving || values.iter().all(|x| *x == 0.0), "{frames:?} {k}");
        }
        assert!(of("singular_value_1").iter().all(|x| *x > 0.1), "{frames:?}");
    }
    // Without another frame the same.
    let plain =
        SweepOptions { relative_to: None, ..seen(&robot, ["link4", "link1"], &OF_JACOBIAN) };
    let found = table(&robot, plain);
    assert!(found.numbers("condition").unwrap().iter().all(|x| *x == f64::INFINITY));
    assert!(found.numbers("yoshikawa").unwrap().iter().all(|x| *x == 0.0));
}

/// Two arms of two links in the plane, with the length of a link.
fn planar() -> ParametricModel {
    let mut text = "dimension = 2\ntool = 'a_tip'\n[parameters]\nlink = 0.3\n".to_owned();
    for arm in ["a", "b"] {
        let sign = if arm == "a" { 1 } else { -1 };
        let at = |links: i32| format!("['{} * link', 'link']", sign * links);
        for (joint, parent, links) in [(1, "ground".to_owned(), 1), (2, format!("{arm}1"), 2)] {
            text += &format!(
                "[[joint]]\nname = 'q{arm}{joint}'\ntype = 'revolute'\n\
                 between = ['{parent}', '{arm}{joint}']\norigin = {}\n\
                 limits = {{ lower = -2, upper = 2.5 }}\n",
                at(links)
            );
        }
        text += &format!(
            "[[frame]]\nname = '{arm}_tip'\nlink = '{arm}2'\nxyz = ['{sign} * link', 0, 0]\n\
             [[frame]]\nname = '{arm}_tilted'\nlink = '{arm}2'\nxyz = [0, 0, 0]\nrpy = [0.5, 0, 0]\n"
        );
    }
    ParametricModel::of_text(&text, Path::new("arms.toml"), &[]).unwrap()
}

/// Of arms of any size the same, but for the unit; each design has its own frames.
#[test]
fn designs_and_scales() {
    let model = planar();
    let robot = model.nominal();
    let ranges = vec![ParameterRange { name: "link".to_owned(), from: 0.1, to: 9.0 }];
    let space = DesignSpace::Samples { ranges, count: 12, seed: 3 };
    let angles = [("qa1", 0.4), ("qa2", 0.9), ("qb1", -0.3), ("qb2", 1.1)];
    let angle = |name: &str| angles.iter().find(|(own, _)| *own == name).unwrap().1;
    let q = robot.coordinates().iter().map(|c| angle(&c.name)).collect();
    let source = Source::Configurations(q);
    let quantities = [Quantity::Pose, Quantity::SingularValues, Quantity::Yoshikawa];
    let options = SweepOptions { source, ..seen(robot, ["a_tip", "b_tip"], &quantities) };
    let one = table(robot, options.clone());
    // The distance of the tips by hand: two chains of complex numbers.
    let chain = |sign: f64, q: [f64; 2]| {
        let arm = |angle: f64| [sign * 0.3 * angle.cos(), sign * 0.3 * angle.sin()];
        let (first, second) = (arm(q[0]), arm(q[0] + q[1]));
        [sign * 0.3 + first[0] + second[0], 0.3 + first[1] + second[1]]
    };
    let (a, b) = (chain(1.0, [0.4, 0.9]), chain(-1.0, [-0.3, 1.1]));
    let distance = (a[0] - b[0]).hypot(a[1] - b[1]);
    let of = |name: &str| one.numbers(name).unwrap()[0];
    assert!((of("x").hypot(of("y")) - distance).abs() < 1e-14);
    // Relative angles in the plane move all four joints: no zeros.
    assert!(of("singular_value_3") > 0.0 && one.numbers("singular_value_4").is_none());

    let sweep = Sweep::of_designs(&model, space, options).unwrap();
    let designs = sweep.table(0..12).unwrap();
    let lengths = designs.numbers("link").unwrap();
    for (name, power) in
        [("singular_value_1", 0), ("singular_value_3", 0), ("yoshikawa", 2), ("x", 1)]
    {
        for (length, found) in lengths.iter().zip(designs.numbers(name).unwrap()) {
            let expected = of(name) * (length / 0.3).powi(power);
            assert!((found - expected).abs() < 1e-12 * expected.abs().max(1.0), "{name} {length}");
        }
    }
}

/// Of closed chains, poses.
#[test]
fn links_of_closed_chains() {
    let robot = cylindroid::load("five-bar").unwrap();
    let names: Vec<&str> = robot.links().iter().map(|l| l.name.as_str()).collect();
    let [tool, base] = [names[1], names[2]].map(|name| robot.frame(name).unwrap());
    let options = SweepOptions {
        source: Source::Samples { count: 20, seed: 1 },
        ..seen(&robot, [names[1], names[2]], &[Quantity::Pose])
    };
    let found = table(&robot, options);
    for (i, q) in configurations(&robot, &found).iter().enumerate() {
        if q[0].is_nan() {
            continue;
        }
        let state = robot.state(q).unwrap();
        let pose = state.pose(base).unwrap().inverse() * state.pose(tool).unwrap();
        let at = ["x", "y", "z"].map(|name| found.numbers(name).unwrap()[i]);
        assert_eq!(at, pose.translation.to_array());
    }
}

#[test]
fn what_has_no_other_frame_is_refused() {
    let robot = two_arms();
    let refused = |options: SweepOptions| Sweep::new(&robot, options).unwrap_err().to_string();
    for quantity in [Quantity::Measures, Quantity::Payload] {
        let error = refused(seen(&robot, HANDS, &[Quantity::Pose, quantity]));
        let named =
            error.contains("relative_to = right/hand_tcp") && error.contains(quantity.name());
        assert!(named && error.contains("name other quantities"), "{error}");
    }
    let axis = Axis { name: "x".to_owned(), from: 0.0, to: 1.0, count: 2 };
    let grid =
        VoxelGrid { axes: vec![axis], world_from_grid: Pose::IDENTITY, directions: 4, rolls: 1 };
    let with = |source: Source| SweepOptions { source, ..seen(&robot, HANDS, &[]) };
    let error = refused(with(Source::Voxels(grid)));
    assert!(error.contains("relative_to") && error.contains("capability map"), "{error}");
    let poses = Source::Poses { targets: vec![Pose::IDENTITY], task: Task::POSE };
    let error = refused(with(poses));
    assert!(error.contains("relative_to") && error.contains("poses"), "{error}");
    // Components of the plane are no others of a frame that is tilted.
    let model = planar();
    let tilted = |quantity| seen(model.nominal(), ["a_tip", "b_tilted"], &[quantity]);
    let error = Sweep::new(model.nominal(), tilted(Quantity::Condition)).unwrap_err().to_string();
    assert!(error.contains("relative_to = b_tilted") && error.contains("the plane"), "{error}");
    assert!(Sweep::new(model.nominal(), tilted(Quantity::Pose)).is_ok());
    let other = cylindroid::load("panda").unwrap();
    let foreign = SweepOptions {
        relative_to: Some(other.frame("link4").unwrap()),
        ..seen(&robot, HANDS, &[])
    };
    assert!(Sweep::new(&robot, foreign).is_err());
}
