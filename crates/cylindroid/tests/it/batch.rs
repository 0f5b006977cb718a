//! Many configurations in one call are what single calls give, whatever their number and place.

use cylindroid::kinematics::{Chain, KinematicsBatch};
use cylindroid::model::{JointKind, JointSpec, Limits, Mimic};
use cylindroid::spatial::{Pose, Rotation, Vec3};
use cylindroid::{EndEffector, Error, Matrix, Mechanism, ReferenceFrame, catalogue};

use crate::support::{Random, assert_close, planar, reversed_zoo, zoo};

const REFERENCES: [ReferenceFrame; 3] =
    [ReferenceFrame::Local, ReferenceFrame::World, ReferenceFrame::LocalWorldAligned];

/// Serial chains of all joints that turn and slide: axes anyhow, nearly parallel, perpendicular and
/// parallel, a coordinate that two joints read and one that none of the chain reads.
fn chains() -> Vec<Mechanism> {
    let mut random = Random(11);
    let kinds = [
        JointKind::Revolute,
        JointKind::Prismatic,
        JointKind::Helical { pitch: 0.07 },
        JointKind::Revolute,
        JointKind::Continuous,
        JointKind::Cylindrical,
        JointKind::Revolute,
        JointKind::Revolute,
        JointKind::Prismatic,
        JointKind::Revolute,
    ];
    let mut build = |name: &str, tilts: &[f64]| {
        let mut b = Mechanism::builder(name);
        for (i, kind) in kinds.into_iter().enumerate() {
            let rotation = match tilts.get(i % tilts.len().max(1)) {
                Some(&tilt) => {
                    Rotation::exp(Vec3::new(0.0, 0.0, 0.4)) * Rotation::exp(Vec3::X * tilt)
                }
                None => random.rotation(),
            };
            b.joint(JointSpec {
                parent_from_joint: Pose { rotation, translation: random.vec3(0.4) },
                axis: Vec3::Z,
                limits: Limits { lower: -2.0, upper: 2.0, ..Limits::NONE },
                ..JointSpec::new(&format!("j{i}"), kind, &format!("l{i}"), &format!("l{}", i + 1))
            });
        }
        b.joint(JointSpec {
            mimic: Some(Mimic { joint: "j2".into(), multiplier: -1.7, offset: 0.2 }),
            parent_from_joint: random.pose(),
            ..JointSpec::new("follower", JointKind::Revolute, "l10", "l11")
        });
        b.joint(JointSpec::new("aside", JointKind::Prismatic, "l4", "side"));
        b.frame("tip", "l11", random.pose());
        b.build().unwrap()
    };
    let right = std::f64::consts::FRAC_PI_2;
    vec![
        build("anyhow", &[]),
        build("nearly parallel", &[1e-9, 1e-15, 0.0, 3e-5]),
        build("on a grid", &[right, 0.0, -right, std::f64::consts::PI]),
    ]
}

fn robots() -> Vec<(Mechanism, EndEffector)> {
    let mut random = Random(12);
    let mut robots: Vec<Mechanism> =
        catalogue::names().iter().map(|n| catalogue::load(n).unwrap()).collect();
    robots.extend([planar(1), planar(2), planar(9), planar(30), zoo(), reversed_zoo()]);
    // Tools anyhow, along the last axis, turned about it, and the other way up.
    let about_z = Rotation::exp(Vec3::Z * 0.7);
    let upside_down = about_z * Rotation::exp(Vec3::X * std::f64::consts::PI);
    let aside = Vec3::new(0.3, -0.2, 0.1);
    let mut with_tools = |robot: Mechanism| {
        let frame = robot.tool();
        let tools = [
            random.pose(),
            Pose::IDENTITY,
            Pose { rotation: about_z, translation: aside },
            Pose { rotation: upside_down, translation: aside },
        ];
        tools.map(|frame_from_tool| (robot.clone(), EndEffector { frame, frame_from_tool }))
    };
    let mut robots: Vec<_> = robots.into_iter().flat_map(&mut with_tools).collect();
    robots.extend(chains().into_iter().map(|robot| {
        let tip = robot.frame("tip").unwrap();
        (robot, tip.into())
    }));
    robots
}

fn draw(robot: &Mechanism, count: usize, seed: u64) -> Vec<f64> {
    let mut random = Random(seed);
    (0..count).flat_map(|_| random.q(robot)).collect()
}

/// Poses and Jacobians of a batch are those of a state, in every reference.
#[test]
fn agrees_with_single_calls() {
    for (robot, of) in robots() {
        let (n, batch) = (robot.n(), KinematicsBatch::new(&robot, of).unwrap());
        let scale = 1e-13 * (1.0 + robot.reach());
        // Whole blocks of lanes, and what is left over.
        for count in [1, 3, 4, 8, 13] {
            let q = draw(&robot, count, 5);
            let poses = batch.poses(&q).unwrap();
            for reference in REFERENCES {
                let jacobians = batch.jacobians(&q, reference).unwrap();
                let (mut both_p, mut both_j) =
                    (vec![f64::NAN; poses.len()], vec![f64::NAN; jacobians.len()]);
                batch.poses_and_jacobians_into(&q, reference, &mut both_p, &mut both_j).unwrap();
                assert!(both_p == poses && both_j == jacobians, "{} in one go", robot.name());
                for i in 0..count {
                    let state = robot.state(&q[i * n..(i + 1) * n]).unwrap();
                    let what = format!("{} {reference:?} of {i} of {count}", robot.name());
                    let rows = state.pose(of).unwrap().to_matrix();
                    assert_close(&what, &poses[i * 16..(i + 1) * 16], rows.as_flattened(), scale);
                    let j = state.jacobian(of, reference).unwrap();
                    let j: Vec<f64> = (0..6 * n).map(|k| j[(k / n, k % n)]).collect();
                    assert_close(&what, &jacobians[i * 6 * n..(i + 1) * 6 * n], &j, scale);
                }
            }
        }
    }
}

/// A chain gives the same as the whole tree, whose kernel is another one.
#[test]
fn chains_agree_with_trees() {
    for (robot, of) in robots() {
        let mut chain = Chain::new(&robot, of).unwrap();
        let mut local = Matrix::zeros(6, chain.n());
        for q in draw(&robot, 20, 6).chunks(robot.n()) {
            let state = robot.state(q).unwrap();
            let (a, b) = (chain.set(q).to_matrix(), state.pose(of).unwrap().to_matrix());
            let scale = 1e-13 * (1.0 + robot.reach());
            assert_close(robot.name(), a.as_flattened(), b.as_flattened(), scale);
            for reference in REFERENCES {
                chain.jacobian_into(reference, &mut local);
                let whole = state.jacobian(of, reference).unwrap();
                for (k, &c) in chain.coordinates().iter().enumerate() {
                    assert_close(robot.name(), local.column(k), whole.column(c), scale);
                }
            }
        }
    }
}

/// As near to single calls as is promised, also after many turns and where one joint turns by a
/// multiple of another.
#[test]
fn rounds_as_single_calls() {
    let mut b = Mechanism::builder("follower");
    let link = Pose { translation: Vec3::X, ..Pose::IDENTITY };
    b.joint(JointSpec::new("leader", JointKind::Continuous, "base", "a"));
    b.joint(JointSpec {
        parent_from_joint: link,
        mimic: Some(Mimic { joint: "leader".into(), multiplier: -1.7, offset: 0.2 }),
        ..JointSpec::new("follower", JointKind::Continuous, "a", "b")
    });
    b.frame("tip", "b", link);
    let mut robots = vec![b.build().unwrap()];
    robots.extend(catalogue::names().iter().map(|n| catalogue::load(n).unwrap()));
    let mut random = Random(13);
    for robot in robots {
        let (n, of) = (robot.n(), robot.tool());
        let (batch, mut chain) =
            (KinematicsBatch::new(&robot, of).unwrap(), Chain::new(&robot, of).unwrap());
        if chain.n() != n {
            continue;
        }
        let q: Vec<f64> = random.vector(200 * n).iter().map(|x| 100.0 * x).collect();
        let scale = 16.0 * f64::EPSILON * (1.0 + robot.reach());
        let (poses, mut local) = (batch.poses(&q).unwrap(), Matrix::zeros(6, n));
        for reference in REFERENCES {
            let jacobians = batch.jacobians(&q, reference).unwrap();
            for (i, q) in q.chunks(n).enumerate() {
                let pose = chain.set(q).to_matrix();
                assert_close(robot.name(), &poses[i * 16..][..16], pose.as_flattened(), scale);
                chain.jacobian_into(reference, &mut local);
                let rows: Vec<f64> = (0..6 * n).map(|k| local[(k / n, k % n)]).collect();
                assert_close(robot.name(), &jacobians[i * 6 * n..][..6 * n], &rows, scale);
            }
        }
    }
}

/// A million rows: with 1, 2 and 8 threads the same to the bit, and what single calls give.
#[test]
fn a_million_rows_are_those_of_single_calls() {
    let of_arm = |name: &&str| {
        let robot = catalogue::load(name).unwrap();
        Chain::new(&robot, robot.tool()).unwrap().n() == robot.n() && robot.n() > 0
    };
    let names: Vec<&str> = catalogue::names().iter().copied().filter(of_arm).collect();
    let count = 1_000_000_usize.div_ceil(names.len());
    for name in &names {
        let robot = catalogue::load(name).unwrap();
        let (n, of) = (robot.n(), robot.tool());
        let (batch, mut chain) =
            (KinematicsBatch::new(&robot, of).unwrap(), Chain::new(&robot, of).unwrap());
        let q = draw(&robot, count, 14);
        let with = |threads: usize| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            let (mut poses, mut jacobians) = (vec![0.0; 16 * count], vec![0.0; 6 * n * count]);
            let reference = ReferenceFrame::LocalWorldAligned;
            pool.install(|| {
                batch.poses_and_jacobians_into(&q, reference, &mut poses, &mut jacobians).unwrap();
            });
            (poses, jacobians)
        };
        let (poses, jacobians) = with(1);
        for threads in [2, 8] {
            let other = with(threads);
            assert!((&poses, &jacobians) == (&other.0, &other.1), "{name} {threads}");
        }
        let tolerance = 32.0 * f64::EPSILON * (1.0 + robot.reach());
        let mut local = Matrix::zeros(6, n);
        for (i, q) in q.chunks(n).enumerate() {
            let pose = chain.set(q).to_matrix();
            assert_close(name, &poses[i * 16..][..16], pose.as_flattened(), tolerance);
            chain.jacobian_into(ReferenceFrame::LocalWorldAligned, &mut local);
            let own = &jacobians[i * 6 * n..][..6 * n];
            let difference =
                (0..6 * n).map(|k| (own[k] - local[(k / n, k % n)]).abs()).fold(0.0, f64::max);
            assert!(difference <= tolerance, "{name} {i}: {difference:e}");
        }
    }
}

/// Bit for bit the same with one thread or three, at any place in the batch.
#[test]
fn does_not_depend_on_threads_or_places() {
    let robot = catalogue::load("panda").unwrap();
    let (n, batch) = (robot.n(), KinematicsBatch::new(&robot, robot.tool()).unwrap());
    let count = 10_001;
    let q = draw(&robot, count, 7);
    let of = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| batch.jacobians(&q, ReferenceFrame::Local).unwrap())
    };
    let (one, three) = (of(1), of(3));
    assert!(one == three);
    for i in [0, 4095, 4096, 5001, count - 1] {
        let alone = batch.jacobians(&q[i * n..(i + 1) * n], ReferenceFrame::Local).unwrap();
        assert!(alone == one[i * 6 * n..(i + 1) * 6 * n], "{i}");
    }
}

#[test]
fn refuses_what_does_not_fit() {
    let robot = catalogue::load("panda").unwrap();
    let batch = KinematicsBatch::new(&robot, robot.tool()).unwrap();
    assert!(batch.poses(&[]).unwrap().is_empty());
    let error = batch.poses(&[0.0; 15]).unwrap_err().to_string();
    assert_eq!(error, "q has 15 entries, expected 21 (7 for each configuration)");
    let mut q = vec![0.0; 14];
    q[9] = f64::NAN;
    let error = batch.poses(&q).unwrap_err().to_string();
    assert!(error.contains("panda_joint3") && error.contains("NaN"), "{error}");
    q[9] = 0.0;
    let error = batch.poses_into(&q, &mut [0.0; 16]).unwrap_err();
    assert!(matches!(&error, Error::Dimension { expected: 32, got: 16, .. }), "{error}");
    let error = batch.jacobians_into(&q, ReferenceFrame::Local, &mut [0.0; 85]).unwrap_err();
    assert!(matches!(&error, Error::Dimension { expected: 84, got: 85, .. }), "{error}");
}

/// A mechanism without joints has no configurations to count.
#[test]
fn nothing_moves() {
    let mut b = Mechanism::builder("table");
    b.joint(JointSpec::new("bolt", JointKind::Fixed, "floor", "table"));
    let table = b.build().unwrap();
    let batch = KinematicsBatch::new(&table, table.tool()).unwrap();
    assert!(batch.poses(&[]).unwrap().is_empty());
    assert!(batch.poses(&[1.0]).is_err());
}

/// An end effector that no joint moves stays where it is, with a Jacobian of zeros.
#[test]
fn the_ground_does_not_move() {
    let robot = catalogue::load("panda").unwrap();
    let batch = KinematicsBatch::new(&robot, robot.frame(&robot.links()[0].name).unwrap()).unwrap();
    let q = draw(&robot, 3, 8);
    assert!(batch.jacobians(&q, ReferenceFrame::World).unwrap().iter().all(|x| *x == 0.0));
    let identity = Pose::IDENTITY.to_matrix();
    assert!(batch.poses(&q).unwrap().chunks(16).all(|p| p == identity.as_flattened()));
}
