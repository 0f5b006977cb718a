//! Collision models: pairs, near ones and their gradients, capsules around meshes, descents.

use std::fmt::Write as _;

use cylindroid::collision::{CollisionModel, CollisionOptions, MeshShape, NearPair};
use cylindroid::model::{
    Collision, ContactKind, ContactSpec, Geometry, JointKind, JointSpec, Limits, Link,
};
use cylindroid::{Mechanism, Pose, Vec3};

use super::shapes::{SHAPES, shape};
use super::sum;
use crate::record::{Record, check};
use crate::robots::{Random, five_bar, robot, spatial_loop};

const ALL: CollisionOptions = CollisionOptions {
    meshes: MeshShape::ConvexHull,
    disabled: Vec::new(),
    samples: 0,
    seed: 0,
    never_margin: 0.02,
};

fn some_robot(random: &mut Random<'_>) -> Mechanism {
    match random.below(4) {
        0 => five_bar(random),
        1 => spatial_loop(random),
        2 => tree(random),
        _ => robot(random, true),
    }
}

/// All kinds of joints and shapes, on branches, up to three shapes on a link.
fn tree(random: &mut Random<'_>) -> Mechanism {
    let mut builder = Mechanism::builder("tree");
    let size = random.power(-1.0, 1.0);
    let some = |random: &mut Random<'_>, name: &str| {
        let one = |random: &mut Random<'_>| {
            let kind = random.below(SHAPES);
            let bits = |random: &mut Random<'_>| [1, 1, 1, 3, 2][random.below(5)];
            Collision {
                geometry: shape(random, kind, size),
                link_from_shape: random.pose(0.2 * size),
                category: bits(random),
                mask: bits(random),
                ..Collision::default()
            }
        };
        let collisions = (0..random.below(3)).map(|_| one(random)).collect();
        Link { collisions, ..Link::named(name) }
    };
    let base = some(random, "l0");
    builder.link(base);
    for i in 1..3 + random.below(4) {
        let kind = kind(random);
        let (parent, name) = (format!("l{}", random.below(i)), format!("l{i}"));
        builder.joint(JointSpec {
            parent_from_joint: random.pose(0.5 * size),
            limits: limits(random, kind, size),
            axis: random.vec3(1.0),
            ..JointSpec::new(&format!("q{i}"), kind, &parent, &name)
        });
        let link = some(random, &name);
        builder.link(link);
    }
    if random.once_in(3) {
        builder.contact(ContactSpec::new("touch", ContactKind::PointFrictionless, "l0", "l2"));
    }
    if random.once_in(3) {
        builder.disable_collision("l2", "l1");
    }
    builder.build().unwrap()
}

fn kind(random: &mut Random<'_>) -> JointKind {
    match random.below(11) {
        0 => JointKind::Prismatic,
        1 => JointKind::Helical { pitch: random.within(-0.2, 0.2) },
        2 => JointKind::Continuous,
        3 => JointKind::Cylindrical,
        4 => JointKind::Universal { second: random.vec3(1.0) },
        5 => JointKind::Spherical,
        6 => JointKind::Planar,
        7 => JointKind::Free,
        8 => JointKind::Fixed,
        _ => JointKind::Revolute,
    }
}

/// On both sides, on one, on none.
fn limits(random: &mut Random<'_>, kind: JointKind, size: f64) -> Limits {
    let reach = if kind == JointKind::Prismatic { size } else { 1.5 };
    let mut end = |sign: f64| {
        if random.once_in(5) { sign * f64::INFINITY } else { sign * random.within(0.05, reach) }
    };
    match kind {
        JointKind::Revolute | JointKind::Prismatic | JointKind::Helical { .. } => {
            Limits { lower: end(-1.0), upper: end(1.0), ..Limits::NONE }
        }
        _ => Limits::NONE,
    }
}

fn of_pairs(record: &mut Record, model: &CollisionModel) {
    record.word(&(model.bodies().len(), model.ignored().len(), model.pairs().len()));
    let numbers = model.pairs().iter().flat_map(|p| [p.a as f64, p.b as f64]);
    record.number(sum(&numbers.collect::<Vec<_>>()));
}

/// Distances first: points and normals are not unique everywhere.
fn of_near(record: &mut Record, model: &CollisionModel, near: &[NearPair], size: f64) {
    let numbers: Vec<f64> = near.iter().map(|n| n.pair as f64).collect();
    let distances: Vec<f64> = near.iter().map(|n| n.distance / size).collect();
    let obstacles = near.iter().filter(|n| n.link_b.is_none()).count();
    let names: usize = near.iter().flat_map(|n| model.names(n.pair)).map(str::len).sum();
    record.word(&(near.len(), obstacles, names));
    record.number(sum(&[sum(&numbers), sum(&distances)]));
}

/// Watched pairs of models whose shapes may always or never touch.
#[test]
fn watched_pairs() {
    check("algebra_watched", 130, |random, record| {
        let robot = some_robot(random);
        let names: Vec<String> = robot.links().iter().map(|l| l.name.clone()).collect();
        let mut one = || match random.below(names.len() + 1) {
            0 => "nothing".to_owned(),
            i => names[i - 1].clone(),
        };
        let disabled = vec![[one(), one()], [one(), one()]];
        of_pairs(record, &CollisionModel::new(&robot, &ALL).unwrap());
        let options = CollisionOptions {
            disabled,
            samples: [1, 3, 20, 60][random.below(4)],
            seed: random.below(9) as u64,
            never_margin: [0.0, 0.02, 0.1, -0.05][random.below(4)],
            ..ALL
        };
        let model = CollisionModel::new(&robot, &options).unwrap();
        of_pairs(record, &model);
        record.word(&model.ignored().iter().map(|i| i.why.len()).sum::<usize>());
    });
}

/// Two shapes at the ends of a chain.
fn ends(random: &mut Random<'_>) -> Mechanism {
    let mut builder = Mechanism::builder("ends");
    let size = random.power(-0.5, 0.5);
    let count = 2 + random.below(3);
    for i in 0..=count {
        let mut link = Link::named(&format!("l{i}"));
        if i == 0 || i == count {
            let kind = random.below(6);
            let geometry = shape(random, kind, size);
            link.collisions.push(Collision { geometry, ..Collision::default() });
        }
        builder.link(link);
    }
    for i in 0..count {
        let kind = match kind(random) {
            JointKind::Free | JointKind::Fixed => JointKind::Revolute,
            JointKind::Planar if random.once_in(2) => JointKind::Prismatic,
            other => other,
        };
        builder.joint(JointSpec {
            parent_from_joint: random.pose(0.5 * size),
            limits: limits(random, kind, size),
            axis: random.vec3(1.0),
            ..JointSpec::new(&format!("q{i}"), kind, &format!("l{i}"), &format!("l{}", i + 1))
        });
    }
    builder.build().unwrap()
}

/// The least margin at which a pair is kept, by halving: where samples and the descent end.
#[test]
fn descents() {
    check("algebra_descents", 400, |random, record| {
        let robot = ends(random);
        let (samples, seed) = (1 + random.below(3), random.below(100) as u64);
        let kept = |never_margin| {
            let options = CollisionOptions { samples, seed, never_margin, ..ALL };
            !CollisionModel::new(&robot, &options).unwrap().pairs().is_empty()
        };
        let (mut low, mut high) = (-1.0, 3.0);
        for _ in 0..20 {
            let middle = 0.5 * (low + high);
            if kept(middle) { high = middle } else { low = middle }
        }
        record.number(high);
    });
}

#[test]
fn near_pairs_and_gradients() {
    check("algebra_near", 120, |random, record| {
        let robot = some_robot(random);
        let mut model = CollisionModel::new(&robot, &ALL).unwrap();
        let size = robot.reach().max(0.1);
        for i in 0..random.below(4) {
            let kind = random.below(SHAPES);
            let obstacle = shape(random, kind, size);
            let place = random.pose(size);
            model.add_obstacle(&format!("o{i}"), &obstacle, place).unwrap();
        }
        let state = robot.state(&random.configuration(&robot)).unwrap();
        let mut near = Vec::new();
        for margin in [f64::INFINITY, 0.3 * size, 0.0] {
            model.near(&state, margin, &mut near).unwrap();
            of_near(record, &model, &near, size);
        }
        model.near(&state, f64::INFINITY, &mut near).unwrap();
        for pairs in near.chunks(3).take(2) {
            let slopes = pairs.iter().map(|pair| sum(&model.gradient(&state, pair)));
            record.number(sum(&slopes.collect::<Vec<_>>()));
        }
    });
}

/// Obstacles come, move and go; what is refused.
#[test]
fn obstacles() {
    check("algebra_obstacles", 50, |random, record| {
        let robot = some_robot(random);
        let mut model = CollisionModel::new(&robot, &ALL).unwrap();
        let size = robot.reach().max(0.1);
        let state = robot.state(&random.configuration(&robot)).unwrap();
        let (mut near, mut distances) = (Vec::new(), Vec::new());
        for _ in 0..6 {
            let name = ["a", "b", "c"][random.below(3)];
            let kind = random.below(SHAPES);
            let mut place = random.pose(size);
            if random.once_in(12) {
                place.translation.x = f64::NAN;
            }
            let done = match random.below(4) {
                0 => model.remove_obstacle(name),
                1 => model.move_obstacle(name, place),
                _ => model.add_obstacle(name, &shape(random, kind, size), place),
            };
            let message = done.err().map_or(0, |e| e.to_string().len());
            let names: String = model.obstacles().collect();
            record.word(&(message, names, model.pairs().len()));
            model.near(&state, f64::INFINITY, &mut near).unwrap();
            let numbers: Vec<f64> = near.iter().map(|n| n.distance / size).collect();
            distances.push(sum(&numbers));
        }
        record.number(sum(&distances));
        record.word(&model.near(&state, f64::NAN, &mut near).is_err());
        let margin = [f64::NAN, f64::INFINITY, 1e9][random.below(3)];
        let bad = CollisionOptions { never_margin: margin, ..ALL };
        record.word(&CollisionModel::new(&robot, &bad).is_err());
    });
}

/// Points of a link: of a capsule, a box, a plane, a line, a ball, few, anyhow.
fn cloud(random: &mut Random<'_>, size: f64) -> Vec<Vec3> {
    let (kind, place) = (random.below(8), random.pose(size));
    let count = [1, 2, 3, 4, 8, 20, 60][random.below(7)];
    let side = |bit: usize| if bit == 0 { -1.0 } else { 1.0 };
    let points = (0..count).map(|i| {
        let any = random.vec3(1.0);
        let unit = any.unit(1e-3).unwrap_or(Vec3::X);
        let local = match kind {
            0 => unit * 0.3 + Vec3::Z * side(i % 2),
            1 => Vec3::new(side(i & 1), 0.5 * side(i & 2), 0.3 * side(i & 4)),
            2 => Vec3::new(any.x, any.y, 0.0),
            3 => Vec3::X * any.x,
            4 => unit,
            5 => Vec3::new(any.x, 0.2 * any.y, 0.1 * any.z),
            6 => Vec3::new((i % 3) as f64, (i / 3 % 3) as f64, (i / 9) as f64),
            _ => any,
        };
        if kind == 1 || kind == 6 { local * size } else { place * (local * size) }
    });
    points.collect()
}

/// A slide whose cart has this mesh.
fn with_mesh(points: &[Vec3], folder: &std::path::Path, scale: Vec3) -> Mechanism {
    let path = folder.join("mesh.obj");
    let text = points.iter().fold(String::new(), |mut text, p| {
        writeln!(text, "v {:?} {:?} {:?}", p.x, p.y, p.z).unwrap();
        text
    });
    std::fs::write(&path, text).unwrap();
    let mut builder = Mechanism::builder("slide");
    let geometry = Geometry::Mesh { uri: "mesh.obj".to_owned(), path: Some(path), scale };
    let collision = Collision { geometry, ..Collision::default() };
    builder.link(Link { collisions: vec![collision], ..Link::named("cart") });
    builder.joint(JointSpec::new("x", JointKind::Prismatic, "rail", "cart"));
    builder.build().unwrap()
}

/// Distances of a capsule from points around it: its size, place and direction.
#[test]
fn capsules_around_meshes() {
    let folder = tempfile::tempdir().unwrap();
    check("algebra_capsules", 200, |random, record| {
        let size = random.power(-2.0, 1.0);
        let scale =
            if random.once_in(2) { Vec3::new(1.0, -2.0, 0.5) } else { Vec3::new(1.0, 1.0, 1.0) };
        let robot = with_mesh(&cloud(random, size), folder.path(), scale);
        for meshes in [MeshShape::Capsule, MeshShape::ConvexHull] {
            let mut model =
                CollisionModel::new(&robot, &CollisionOptions { meshes, ..ALL }).unwrap();
            record.word(&(model.ignored().len(), meshes.name().len()));
            for (i, end) in [Vec3::X, Vec3::Y, Vec3::Z, -Vec3::X - Vec3::Z].into_iter().enumerate()
            {
                let point = Geometry::Sphere { radius: 0.0 };
                let at = Pose::from_translation(end * (6.0 * size));
                model.add_obstacle(&format!("p{i}"), &point, at).unwrap();
            }
            let mut near = Vec::new();
            model.near(&robot.state(&[0.0]).unwrap(), f64::INFINITY, &mut near).unwrap();
            let distances: Vec<f64> = near.iter().map(|n| n.distance / size).collect();
            record.number(sum(&distances));
        }
    });
}

/// The least distances of samples.
#[cfg(feature = "sweep")]
#[test]
fn clearances() {
    use cylindroid::sweep::{Quantity, Source, Sweep, SweepOptions};
    check("algebra_clearances", 70, |random, record| {
        let robot = robot(random, true);
        let mut model = CollisionModel::new(&robot, &ALL).unwrap();
        for i in 0..1 + random.below(2) {
            let kind = random.below(SHAPES);
            let (obstacle, place) = (shape(random, kind, 0.5), random.pose(1.0));
            model.add_obstacle(&format!("o{i}"), &obstacle, place).unwrap();
        }
        let options = SweepOptions {
            source: Source::Samples { count: 8, seed: random.below(50) as u64 },
            quantities: vec![Quantity::SelfDistance, Quantity::ObstacleDistance],
            collision: Some(model),
            ..SweepOptions::default()
        };
        let table = Sweep::new(&robot, options).unwrap().table(0..8).unwrap();
        for name in ["self_distance", "obstacle_distance"] {
            record.number(sum(table.numbers(name).unwrap()));
        }
    });
}
