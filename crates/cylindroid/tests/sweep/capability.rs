//! Capability maps: arms whose workspace is known, forward samples, other frames, units and orders.

use std::f64::consts::{PI, TAU};
use std::fmt::Write;
use std::path::Path;

use cylindroid::ik::Task;
use cylindroid::model::{Mechanism, formats};
use cylindroid::sweep::{
    Axis, DesignSpace, Quantity, Source, Sweep, SweepOptions, Table, VoxelGrid, WriteOptions,
};
use cylindroid::{Pose, Rotation, Vec3};

use crate::{bits, configurations, two_links};

fn axis(name: &str, from: f64, to: f64, count: u64) -> Axis {
    Axis { name: name.to_owned(), from, to, count }
}

fn options(grid: VoxelGrid, quantities: &[Quantity]) -> SweepOptions {
    SweepOptions {
        source: Source::Voxels(grid),
        quantities: quantities.to_vec(),
        part_rows: 7,
        ..SweepOptions::default()
    }
}

fn map(robot: &Mechanism, grid: VoxelGrid, quantities: &[Quantity]) -> Table {
    let sweep = Sweep::new(robot, options(grid, quantities)).unwrap();
    sweep.table(0..sweep.rows()).unwrap()
}

fn counts<'a>(table: &'a Table, name: &str) -> &'a [u64] {
    match table.column(name).unwrap() {
        cylindroid::sweep::Values::Counts(counts) => counts,
        _ => panic!("{name}"),
    }
}

/// A planar arm of revolute joints along x, each link of its length; joints in the order `order`.
fn planar(lengths: &[f64], order: &[usize]) -> String {
    let mut text = "dimension = 2\ntool = \"tip\"\n".to_owned();
    let last = lengths.len();
    for &i in order {
        let x: f64 = lengths[..i].iter().sum();
        let parent = if i == 0 { "ground".to_owned() } else { format!("link{i}") };
        let child = i + 1;
        writeln!(text, "[[joint]]\nname = \"q{child}\"\ntype = \"revolute\"").unwrap();
        writeln!(text, "between = [\"{parent}\", \"link{child}\"]\norigin = [{x}, 0]").unwrap();
    }
    let x = lengths[last - 1];
    writeln!(text, "[[frame]]\nname = \"tip\"\nlink = \"link{last}\"\nxyz = [{x}, 0, 0]").unwrap();
    text
}

fn parsed(text: &str) -> Mechanism {
    formats::toml::parse(text, Path::new("arm.toml")).unwrap()
}

/// The tip of two links reaches a ring, and its measure there is that of the elbow.
#[test]
fn two_links_reach_a_ring() {
    let (a, b) = (0.5, 0.3);
    let robot = parsed(&planar(&[a, b], &[0, 1]));
    let grid = VoxelGrid {
        axes: vec![axis("x", -0.9, 0.9, 25), axis("y", -0.9, 0.9, 25)],
        directions: 0,
        ..VoxelGrid::default()
    };
    let components = [true, true, false, false, false, false];
    let options = SweepOptions {
        task: Some(Task { components, ..Task::POSE }),
        ..options(grid, &[Quantity::Yoshikawa])
    };
    let sweep = Sweep::new(&robot, options).unwrap();
    let table = sweep.table(0..sweep.rows()).unwrap();
    let [x, y, share, best] =
        ["x", "y", "reachability", "best_yoshikawa"].map(|name| table.numbers(name).unwrap());
    let mut reached = 0;
    for i in 0..table.rows() {
        let r = x[i].hypot(y[i]);
        assert!((r - 0.2).abs() > 1e-4 && (r - 0.8).abs() > 1e-4, "a point on the boundary");
        let inside = r > a - b && r < a + b;
        assert_eq!(share[i], f64::from(u8::from(inside)), "{} {}", x[i], y[i]);
        assert_eq!(counts(&table, "directions")[i], u64::from(inside));
        assert_eq!(best[i].is_nan(), !inside);
        if inside {
            let cos = (r * r - a * a - b * b) / (2.0 * a * b);
            let measure = a * b * (1.0 - cos * cos).sqrt();
            assert!((best[i] - measure).abs() < 1e-5, "{} {measure}", best[i]);
            reached += 1;
        }
    }
    assert!(reached > 100);
}

/// Three links reach an angle where the wrist lies in the ring of the first two.
#[test]
fn three_links_reach_angles_of_their_wrist() {
    let [a, b, c] = [0.5, 0.4, 0.25];
    let robot = parsed(&planar(&[a, b, c], &[0, 1, 2]));
    let directions = 24;
    let grid = VoxelGrid {
        axes: vec![axis("x", -1.2, 1.2, 13), axis("y", 0.05, 1.2, 7)],
        directions,
        ..VoxelGrid::default()
    };
    let table = map(&robot, grid, &[]);
    let [x, y] = ["x", "y"].map(|name| table.numbers(name).unwrap());
    let (mut some, mut all) = (0, 0);
    for i in 0..table.rows() {
        let wrist = |k: u64| {
            let angle = TAU * k as f64 / directions as f64;
            (x[i] - c * angle.cos()).hypot(y[i] - c * angle.sin())
        };
        let radii: Vec<f64> = (0..directions).map(wrist).collect();
        assert!(radii.iter().all(|r| (r - 0.1).abs() > 1e-5 && (r - 0.9).abs() > 1e-5));
        let expected = radii.iter().filter(|r| (a - b..a + b).contains(*r)).count() as u64;
        assert_eq!(counts(&table, "directions")[i], expected, "{} {}", x[i], y[i]);
        assert_eq!(counts(&table, "orientations")[i], expected);
        let share = table.numbers("reachability").unwrap()[i];
        assert!((share - expected as f64 / directions as f64).abs() < 1e-15);
        some += u64::from(expected > 0 && expected < directions);
        all += u64::from(expected == directions);
    }
    assert!(some > 5 && all > 5);
}

/// A grid of one point and one orientation, that of `pose`.
fn alone(pose: Pose, rolls: u64) -> VoxelGrid {
    // The only direction of a sphere is along x, turned from z about y.
    let from_grid = Rotation::about(Vec3::Y, -0.5 * PI).unwrap();
    VoxelGrid {
        axes: vec![axis("x", 0.0, 0.0, 1)],
        world_from_grid: Pose { rotation: pose.rotation * from_grid, ..pose },
        directions: 1,
        rolls,
    }
}

/// Each pose of a forward sample is reached, at its point and with its orientation.
#[test]
fn forward_samples_are_reached() {
    for (model, count) in [("ur5e", 150), ("puma560", 150), ("panda", 150), ("iiwa14", 60)] {
        let robot = cylindroid::load(model).unwrap();
        let samples = crate::of(&robot, Source::Samples { count, seed: 3 }, &[]);
        let mut missed = 0;
        for q in configurations(&robot, &samples.table(0..count).unwrap()) {
            let pose = robot.state(&q).unwrap().pose(robot.tool()).unwrap();
            let table = map(&robot, alone(pose, 1), &[]);
            missed += 1 - counts(&table, "orientations")[0];
        }
        assert_eq!(missed, 0, "{model}");
    }
}

/// Without a closed form, for positions and for directions of five joints.
#[test]
fn samples_of_other_arms_are_reached() {
    let arm = cylindroid::load("3r").unwrap();
    let youbot = cylindroid::load("youbot").unwrap();
    for (robot, rolls, directions) in [(&arm, 0, 0), (&youbot, 0, 1)] {
        let samples = crate::of(robot, Source::Samples { count: 40, seed: 5 }, &[]);
        for q in configurations(robot, &samples.table(0..40).unwrap()) {
            let pose = robot.state(&q).unwrap().pose(robot.tool()).unwrap();
            let grid = VoxelGrid { directions, ..alone(pose, rolls) };
            assert_eq!(map(robot, grid, &[]).numbers("reachability").unwrap(), [1.0]);
        }
    }
}

/// Directions that the closed form reaches with some roll are found by the numerical solver too; the
/// best distance to a limit is that of one of the solutions of inverse kinematics.
#[test]
fn methods_agree() {
    let robot = cylindroid::load("puma560").unwrap();
    let axes = vec![axis("x", -0.7, 0.7, 4), axis("y", 0.2, 0.2, 1), axis("z", -0.3, 0.6, 3)];
    let grid =
        |rolls| VoxelGrid { axes: axes.clone(), directions: 16, rolls, ..VoxelGrid::default() };
    let (rolls, free) = (map(&robot, grid(24), &[]), map(&robot, grid(0), &[]));
    let mut apart = 0;
    for (some, any) in counts(&rolls, "directions").iter().zip(counts(&free, "directions")) {
        assert!(any >= some, "{any} {some}");
        apart += any - some;
    }
    assert!(counts(&rolls, "directions").iter().sum::<u64>() > 40 && apart < 16, "{apart}");

    let q = [0.3, 0.5, -2.0, 0.4, 0.6, 0.2];
    let pose = robot.state(&q).unwrap().pose(robot.tool()).unwrap();
    let table = map(&robot, alone(pose, 1), &[Quantity::LimitDistance, Quantity::Condition]);
    let goals = [cylindroid::ik::Goal::pose(robot.tool(), pose)];
    let solutions = cylindroid::ik::solve_distinct(&robot, &goals, &Default::default(), 8).unwrap();
    let all: Vec<f64> = solutions.iter().flat_map(|s| s.q.clone()).collect();
    let quantities = [Quantity::LimitDistance, Quantity::Condition];
    let own = crate::of(&robot, Source::Configurations(all), &quantities);
    let own = own.table(0..own.rows()).unwrap();
    let most = |name: &str| own.numbers(name).unwrap().iter().fold(f64::MIN, |a, b| a.max(*b));
    let least = |name: &str| own.numbers(name).unwrap().iter().fold(f64::MAX, |a, b| a.min(*b));
    assert!(own.rows() > 1);
    let best = |name: &str| table.numbers(name).unwrap()[0];
    assert!((best("best_limit_distance") - most("limit_distance")).abs() < 1e-8);
    assert!((best("best_condition") / least("condition") - 1.0).abs() < 1e-8);
}

/// An arm with a spherical wrist, all lengths times `scale`, joints in the order `order`.
fn spatial(scale: f64, order: [usize; 6]) -> String {
    const JOINTS: [([f64; 3], [u8; 3], f64); 6] = [
        ([0.0, 0.0, 0.0], [0, 0, 1], 2.5),
        ([0.1, 0.0, 0.4], [0, 1, 0], 1.8),
        ([0.5, 0.0, 0.4], [0, 1, 0], 2.2),
        ([0.9, 0.05, 0.4], [1, 0, 0], 2.9),
        ([0.9, 0.05, 0.4], [0, 1, 0], 1.9),
        ([0.9, 0.05, 0.4], [1, 0, 0], 3.0),
    ];
    let mut text = "tool = \"tip\"\n".to_owned();
    for i in order {
        let (origin, axis, limit) = JOINTS[i];
        let origin = origin.map(|x| x * scale);
        let parent = if i == 0 { "ground".to_owned() } else { format!("link{i}") };
        let child = i + 1;
        writeln!(text, "[[joint]]\nname = \"q{child}\"\ntype = \"revolute\"").unwrap();
        writeln!(text, "between = [\"{parent}\", \"link{child}\"]").unwrap();
        writeln!(text, "origin = {origin:?}\naxis = {axis:?}").unwrap();
        writeln!(text, "limits = {{ lower = -{limit}, upper = {limit} }}").unwrap();
    }
    let x = 0.1 * scale;
    writeln!(text, "[[frame]]\nname = \"tip\"\nlink = \"link6\"\nxyz = [{x}, 0, 0]").unwrap();
    text
}

/// Moved, turned, scaled and with joints in another order, with the grid alike: the same map.
#[test]
fn frames_units_and_orders_change_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let base = "base = { xyz = [3, -2, 0.5], rpy = [0.4, -0.3, 1.1] }";
    let included = |name: &str, text: &str, base: &str| {
        let (file, outer) = (format!("{name}.toml"), format!("{name}-outer.toml"));
        std::fs::write(folder.path().join(&file), text).unwrap();
        let plane = if text.contains("dimension = 2") { "dimension = 2\n" } else { "" };
        let robot = format!("[[robot]]\nname = \"arm\"\nmodel = \"{file}\"\n{base}\n");
        let text = format!("{plane}tool = \"arm/tip\"\n{robot}");
        std::fs::write(folder.path().join(&outer), text).unwrap();
        cylindroid::load(folder.path().join(&outer).to_str().unwrap()).unwrap()
    };
    let quantities = [Quantity::SmallestSingularValue, Quantity::LimitDistance];
    let of = |robot: &Mechanism, scale: f64, at: Pose| {
        let axes = ["x", "y", "z"].map(|name| axis(name, -0.7 * scale, 0.9 * scale, 3));
        let axes = axes[..if robot.n() == 3 { 2 } else { 3 }].to_vec();
        let grid = VoxelGrid { axes, world_from_grid: at, directions: 20, rolls: 6 };
        map(robot, grid, &quantities)
    };
    let same = |a: &Table, b: &Table| {
        for name in ["directions", "orientations"] {
            assert_eq!(counts(a, name), counts(b, name), "{name}");
        }
        for name in ["best_smallest_singular_value", "best_limit_distance"] {
            for (x, y) in a.numbers(name).unwrap().iter().zip(b.numbers(name).unwrap()) {
                let alike = (x - y).abs() < 1e-6 || x == y || x.is_nan() && y.is_nan();
                assert!(alike, "{name}: {x} {y}");
            }
        }
    };
    let plain = included("plain", &spatial(1.0, [0, 1, 2, 3, 4, 5]), "");
    let expected = of(&plain, 1.0, Pose::IDENTITY);
    assert!(counts(&expected, "orientations").iter().sum::<u64>() > 300);
    let rotation = cylindroid::spatial::Rpy { roll: 0.4, pitch: -0.3, yaw: 1.1 }.rotation();
    let at = Pose { rotation, translation: Vec3::new(3.0, -2.0, 0.5) };
    let other = included("other", &spatial(2.5, [4, 2, 5, 0, 3, 1]), base);
    same(&expected, &of(&other, 2.5, at));
    let elsewhere = of(&other, 2.5, Pose::IDENTITY);
    assert!(counts(&elsewhere, "orientations") != counts(&expected, "orientations"));

    // In the plane, by the numerical solver.
    let plain = included("arm", &planar(&[0.5, 0.4, 0.25], &[0, 1, 2]), "");
    let expected = of(&plain, 1.0, Pose::IDENTITY);
    let at = Pose { rotation: Rotation::about_z(0.7), translation: Vec3::new(1.0, -2.0, 0.0) };
    let base = "base = { xyz = [1, -2, 0], rpy = [0, 0, 0.7] }";
    let other = included("turned", &planar(&[1.25, 1.0, 0.625], &[2, 0, 1]), base);
    let found = of(&other, 2.5, at);
    assert_eq!(counts(&expected, "orientations"), counts(&found, "orientations"));
    assert!(counts(&expected, "orientations").iter().sum::<u64>() > 50);
}

/// Each point is a function of its index: in any pieces, for any number of threads, after a stop.
#[test]
fn points_are_functions_of_their_index() {
    for model in ["puma560", "panda", "3r"] {
        let robot = cylindroid::load(model).unwrap();
        let (directions, rolls) = if model == "3r" { (0, 0) } else { (5, 3) };
        let axes = vec![axis("z", 0.1, 0.7, 3), axis("x", -0.6, 0.5, 4), axis("y", -0.2, 0.3, 2)];
        let grid = VoxelGrid { axes, directions, rolls, ..VoxelGrid::default() };
        let sweep = Sweep::new(&robot, options(grid, &[Quantity::Yoshikawa])).unwrap();
        let whole = sweep.table(0..24).unwrap();
        assert_eq!(whole.numbers("z").unwrap()[..4], [0.1, 0.4, 0.7, 0.1]);
        assert_eq!(whole.numbers("y").unwrap()[..4], [-0.2, -0.2, -0.2, 0.3]);
        let expected = bits(&whole);
        for row in (0..24).rev() {
            let one = bits(&sweep.table(row..row + 1).unwrap());
            let place = usize::try_from(row).unwrap();
            assert!(one.iter().zip(&expected).all(|(one, all)| one[0] == all[place]), "{model}");
        }
        let folder = tempfile::tempdir().unwrap();
        let parts = |name: &str| -> Vec<Vec<u8>> {
            let file = |i: usize| folder.path().join(name).join(Sweep::part_name(i));
            (0..sweep.parts()).map(|i| std::fs::read(file(i)).unwrap()).collect()
        };
        for threads in [1, 3] {
            let write = WriteOptions { threads: threads.try_into().ok(), resume: false };
            sweep.write(&folder.path().join(threads.to_string()), &write, |_| true).unwrap();
        }
        let stopped = folder.path().join("stopped");
        let alone = WriteOptions { threads: 1.try_into().ok(), resume: false };
        let summary = sweep.write(&stopped, &alone, |_| false).unwrap();
        assert!(!summary.complete);
        sweep.write(&stopped, &WriteOptions { resume: true, ..alone }, |_| true).unwrap();
        assert!(parts("1") == parts("3") && parts("1") == parts("stopped"));
    }
}

/// Longer links reach more of a grid.
#[test]
fn designs_have_maps() {
    let model = two_links();
    let grid = VoxelGrid {
        axes: vec![axis("x", -0.95, 0.95, 9), axis("y", -0.95, 0.95, 9)],
        directions: 0,
        ..VoxelGrid::default()
    };
    let space = DesignSpace::Grid(vec![axis("link", 0.2, 0.4, 3)]);
    let sweep = Sweep::of_designs(&model, space, options(grid, &[])).unwrap();
    let table = sweep.table(0..sweep.rows()).unwrap();
    let [x, y, link] = ["x", "y", "link"].map(|name| table.numbers(name).unwrap());
    for i in 0..table.rows() {
        let inside = x[i].hypot(y[i]) < 2.0 * link[i];
        assert_eq!(counts(&table, "directions")[i], u64::from(inside), "{} {}", x[i], y[i]);
    }
}

#[test]
fn wrong_maps_are_refused() {
    let refused = |model: &str, grid: VoxelGrid, quantities: &[Quantity]| {
        let robot = cylindroid::load(model).unwrap();
        Sweep::new(&robot, options(grid, quantities)).unwrap_err().to_string()
    };
    let of = |directions, rolls| VoxelGrid {
        axes: vec![axis("x", 0.0, 1.0, 2)],
        directions,
        rolls,
        ..VoxelGrid::default()
    };
    let said = |text: String, part: &str| assert!(text.contains(part), "{text}");
    said(refused("ur5e", VoxelGrid::default(), &[]), "name at least one of x, y, z");
    let named = VoxelGrid { axes: vec![axis("roll", 0.0, 1.0, 2)], ..VoxelGrid::default() };
    said(refused("ur5e", named, &[]), "no axis named 'roll'");
    let twice = VoxelGrid { axes: vec![axis("x", 0.0, 1.0, 2); 2], ..VoxelGrid::default() };
    said(refused("ur5e", twice, &[]), "only once");
    let empty = VoxelGrid { axes: vec![axis("x", 0.0, 1.0, 0)], ..VoxelGrid::default() };
    said(refused("ur5e", empty, &[]), "one value at least");
    let broken = VoxelGrid { axes: vec![axis("x", f64::NAN, 1.0, 2)], ..VoxelGrid::default() };
    said(refused("ur5e", broken, &[]), "x");
    said(refused("ur5e", of(10_001, 1), &[]), "10 000");
    said(refused("ur5e", of(5000, 100), &[]), "100 000");
    said(refused("ur5e", of(5, 5), &[Quantity::Pose]), "best value of yoshikawa");
    said(refused("youbot", of(5, 5), &[]), "0 asks for directions alone");
    said(refused("3r", of(5, 5), &[]), "0 asks for positions alone");
    said(refused("stewart", of(5, 5), &[]), "loops");
}
