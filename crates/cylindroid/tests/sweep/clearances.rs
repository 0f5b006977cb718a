//! Distances to collision: those of the collision model, in any part; what is refused.

use std::path::Path;

use cylindroid::collision::{CollisionModel, CollisionOptions};
use cylindroid::model::Geometry;
use cylindroid::sweep::{
    DesignSpace, ParameterRange, Quantity, Source, Sweep, SweepOptions, VoxelGrid, WriteOptions,
};
use cylindroid::{Mechanism, ParametricModel, Pose, Result, Vec3};

use crate::{configurations, of};

const BOTH: [Quantity; 2] = [Quantity::SelfDistance, Quantity::ObstacleDistance];

fn cell() -> Mechanism {
    cylindroid::load(concat!(env!("CARGO_MANIFEST_DIR"), "/../../docs/cell.toml")).unwrap()
}

/// Its shapes with a ball and a box, some of whose pairs penetrate one another.
fn scene(robot: &Mechanism) -> CollisionModel {
    let mut model = CollisionModel::new(robot, &CollisionOptions::default()).unwrap();
    for (name, shape, at) in [
        ("ball", Geometry::Sphere { radius: 0.1 }, Vec3::new(0.5, 0.0, 0.4)),
        ("box", Geometry::Box { size: Vec3::new(0.2, 0.4, 0.3) }, Vec3::new(-0.4, 0.3, 0.5)),
    ] {
        model.add_obstacle(name, &shape, Pose::from_translation(at)).unwrap();
    }
    model
}

fn options(collision: CollisionModel, count: u64) -> SweepOptions {
    SweepOptions {
        source: Source::Samples { count, seed: 4 },
        quantities: BOTH.to_vec(),
        collision: Some(collision),
        part_rows: 50,
        ..SweepOptions::default()
    }
}

#[test]
fn distances_are_those_of_the_collision_model() {
    let robot = cell();
    let mut model = scene(&robot);
    let sweep = Sweep::new(&robot, options(model.clone(), 500)).unwrap();
    let table = sweep.table(0..500).unwrap();
    let columns = ["self_distance", "obstacle_distance"].map(|name| table.numbers(name).unwrap());
    let (mut near, mut inside) = (Vec::new(), [0; 2]);
    for (row, q) in configurations(&robot, &table).iter().enumerate() {
        model.near(&robot.state(q).unwrap(), f64::INFINITY, &mut near).unwrap();
        for (kind, column) in columns.iter().enumerate() {
            let own = near.iter().filter(|pair| pair.link_b.is_none() == (kind == 1));
            let smallest = own.map(|pair| pair.distance).fold(f64::INFINITY, f64::min);
            assert_eq!(column[row].to_bits(), smallest.to_bits(), "row {row}");
            inside[kind] += usize::from(smallest < 0.0);
        }
    }
    assert!(inside.iter().all(|count| (5..495).contains(count)), "{inside:?}");
    crate::parts::in_any_order(&sweep);
    // Without obstacles the shapes of the links need no option.
    let alone = of(&robot, Source::Samples { count: 500, seed: 4 }, &BOTH[..1]);
    let alone = alone.table(0..500).unwrap();
    assert_eq!(alone.numbers("self_distance"), table.numbers("self_distance"));
}

/// Of designs with their own shapes, and of the points of a grid.
#[test]
fn distances_are_indices() {
    let text = "tool = 'tip'\n[parameters]\nlength = { value = 0.5, lower = 0.1, upper = 2.0 }\n\
        [[joint]]\nname = 'a'\ntype = 'revolute'\nbetween = ['ground', 'one']\norigin = [0, 0, 0]\n\
        axis = [0, 1, 0]\nlimits = { lower = -1, upper = 1 }\n\
        [[joint]]\nname = 'b'\ntype = 'revolute'\nbetween = ['one', 'two']\naxis = [0, 1, 0]\n\
        origin = ['length', 0, 0]\nlimits = { lower = -1, upper = 1 }\n\
        [[frame]]\nname = 'tip'\nlink = 'two'\nxyz = ['length', 0, 0]\n\
        [[collision]]\nlink = 'two'\nshape = 'sphere'\nradius = 0.05\nxyz = ['length', 0, 0]\n\
        [[collision]]\nlink = 'ground'\nshape = 'half_space'\nxyz = [0, 0, -0.5]\n";
    let model = ParametricModel::of_text(text, Path::new("arm.toml"), &[]).unwrap();
    let ranges = vec![ParameterRange { name: "length".to_owned(), from: 0.1, to: 0.9 }];
    let options = SweepOptions {
        source: Source::Configurations(vec![0.5, 0.0]),
        quantities: vec![Quantity::SelfDistance],
        ..SweepOptions::default()
    };
    let space = DesignSpace::Samples { ranges, count: 20, seed: 1 };
    let sweep = Sweep::of_designs(&model, space.clone(), options.clone()).unwrap();
    let table = sweep.table(0..20).unwrap();
    let lengths = table.numbers("length").unwrap();
    for (length, found) in lengths.iter().zip(table.numbers("self_distance").unwrap()) {
        let expected = 0.5 - 0.05 - 2.0 * length * 0.5_f64.sin();
        assert!((found - expected).abs() < 1e-12, "{length}: {found} for {expected}");
    }
    let arm = model.nominal();
    let given = CollisionModel::new(arm, &CollisionOptions::default()).unwrap();
    let given = SweepOptions { collision: Some(given), ..options.clone() };
    let error = Sweep::of_designs(&model, space, given).unwrap_err().to_string();
    assert!(error.contains("those of one design"), "{error}");

    // At a point of a grid the largest of its solutions, at one out of reach none.
    let axis = cylindroid::sweep::Axis { name: "x".to_owned(), from: 0.4, to: 4.0, count: 2 };
    let grid = VoxelGrid {
        axes: vec![axis],
        world_from_grid: Pose::from_translation(Vec3::Z * 0.4),
        directions: 4,
        rolls: 2,
    };
    let cell = cell();
    let table = of(&cell, Source::Voxels(grid), &BOTH[..1]).table(0..2).unwrap();
    let best = table.numbers("best_self_distance").unwrap();
    assert!(best[0] > 0.0 && best[0] < 1.0 && best[1].is_nan(), "{best:?}");
}

/// On the branch of home, those of the collision model; a sample without a path has none.
#[test]
fn distances_of_closed_chains() {
    let joint = |name: &str, links: [&str; 2], at: [f64; 2], more: &str| {
        let ([a, b], [x, z]) = (links, at);
        format!(
            "[[joint]]\nname = '{name}'\ntype = 'revolute'\nbetween = ['{a}', '{b}']\n\
             origin = [{x:?}, 0, {z:?}]\naxis = [0, 1, 0]\n{more}\n"
        )
    };
    let ball = |link: &str, x: f64, z: f64| {
        format!(
            "[[collision]]\nlink = '{link}'\nshape = 'sphere'\nradius = 0.1\nxyz = [{x}, 0, {z}]\n"
        )
    };
    let text = [
        "reference = 'coupler'\n".to_owned(),
        joint("a", ["ground", "crank"], [0.0, 0.0], "actuated = true"),
        joint("b", ["crank", "coupler"], [0.0, 1.3], ""),
        joint("c", ["coupler", "rocker"], [2.5, 1.5], ""),
        joint("d", ["ground", "rocker"], [2.0, 0.0], ""),
        ball("coupler", 1.2, 0.5),
        ball("crank", 0.0, 0.4),
        "[[collision]]\nlink = 'ground'\nshape = 'half_space'\nxyz = [0, 0, -0.1]\n".to_owned(),
    ]
    .concat();
    let model = ParametricModel::of_text(&text, Path::new("four-bar.toml"), &[]).unwrap();
    let robot = model.nominal();
    assert!(robot.is_closed());
    let mut shapes = CollisionModel::new(robot, &CollisionOptions::default()).unwrap();
    let at = Pose::from_translation(Vec3::new(0.5, 0.0, 2.0));
    shapes.add_obstacle("ball", &Geometry::Sphere { radius: 0.2 }, at).unwrap();
    let sweep = Sweep::new(robot, options(shapes.clone(), 120)).unwrap();
    let table = sweep.table(0..120).unwrap();
    let columns = ["self_distance", "obstacle_distance"].map(|name| table.numbers(name).unwrap());
    let (mut near, mut found) = (Vec::new(), 0);
    for (row, q) in configurations(robot, &table).iter().enumerate() {
        if q[0].is_nan() {
            assert!(columns.iter().all(|column| column[row].is_nan()));
            continue;
        }
        found += 1;
        shapes.near(&robot.state(q).unwrap(), f64::INFINITY, &mut near).unwrap();
        for (kind, column) in columns.iter().enumerate() {
            let own = near.iter().filter(|pair| pair.link_b.is_none() == (kind == 1));
            let smallest = own.map(|pair| pair.distance).fold(f64::INFINITY, f64::min);
            assert_eq!(column[row].to_bits(), smallest.to_bits(), "row {row}");
            assert!(smallest.is_finite());
        }
    }
    assert!((10..110).contains(&found), "{found} of 120");
}

#[test]
fn folders_know_their_shapes() {
    let robot = cell();
    let folder = tempfile::tempdir().unwrap();
    let write = |model: CollisionModel, resume| -> Result<_> {
        let sweep = Sweep::new(&robot, options(model, 100))?;
        sweep.write(folder.path(), &WriteOptions { threads: None, resume }, |_| true)
    };
    write(scene(&robot), false).unwrap();
    assert_eq!(write(scene(&robot), true).unwrap().computed, 0);
    let mut moved = scene(&robot);
    moved.move_obstacle("ball", Pose::from_translation(Vec3::new(0.5, 0.0, 0.41))).unwrap();
    let error = write(moved, true).unwrap_err().to_string();
    assert!(error.contains("collision.checksum is"), "{error}");
}

#[test]
fn missing_shapes_are_told() {
    let refused = |robot: &Mechanism, quantity: Quantity, collision: Option<CollisionModel>| {
        let options = SweepOptions {
            source: Source::Home,
            quantities: vec![quantity],
            collision,
            ..SweepOptions::default()
        };
        Sweep::new(robot, options).unwrap_err().to_string()
    };
    let (robot, bare) = (cell(), cylindroid::load("panda").unwrap());
    let error = refused(&bare, Quantity::SelfDistance, None);
    assert!(error.contains("self_distance") && error.contains("no link has a collision shape"));
    let error = refused(&robot, Quantity::ObstacleDistance, None);
    assert!(error.contains("obstacle_distance") && error.contains("there is no obstacle"));
    let error = refused(&bare, Quantity::SelfDistance, Some(scene(&robot)));
    assert!(error.contains("collision") && error.contains("those of 'cell'"), "{error}");
}
