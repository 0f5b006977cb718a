//! Many configurations in one call are what the reports of one say, whatever their number and
//! place.

use cylindroid::closure::{
    ClosedChain, Mobility, MobilityCounts, MotionSpace, Singularities, assemble,
};
use cylindroid::manipulability::{BatchOptions, Manipulability, ManipulabilityBatch, Metrics};
use cylindroid::model::{CoordinateKind, JointKind, JointSpec, LoopJointSpec, Mimic};
use cylindroid::spatial::{Pose, Rotation, Vec3};
use cylindroid::{Error, Matrix, Mechanism, catalogue};

use crate::support::Random;

const WIDTH: usize = ManipulabilityBatch::WIDTH;

fn file(name: &str) -> Mechanism {
    cylindroid::load(&format!("tests/data/mechanisms/{name}.toml")).unwrap()
}

/// The reports of one configuration.
fn single(
    batch: &ManipulabilityBatch,
    mechanism: &Mechanism,
    q: &[f64],
    (metrics, task): (&Metrics, Option<&Matrix>),
) -> [f64; WIDTH] {
    let state = mechanism.state(q).unwrap();
    let length = batch.length();
    let chain = ClosedChain::of(&state, Some(batch.reference()), Some(length)).unwrap();
    let motions = MotionSpace::of(&chain.constraint);
    let relation = motions.relation();
    let relation = task.map_or_else(|| relation.clone(), |map| relation.task(map).unwrap());
    let dimensions = relation.dimensions();
    let m = Mobility::of(&chain.constraint);
    let found = Singularities::of(&motions, &relation, &batch.generic()).distances;
    let kinematic = Manipulability::of(&relation, metrics).unwrap().kinematic;
    let none = f64::NAN;
    [
        chain.closure_error.distance,
        chain.closure_error.angle,
        f64::from(u8::from(chain.closure_error.is_closed(length))),
        m.dof.dimension() as f64,
        dimensions.redundancy as f64,
        dimensions.indeterminacy as f64,
        dimensions.coordinate as f64,
        m.internal.dimension() as f64,
        dimensions.zero_torque as f64,
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
    for (i, name) in ManipulabilityBatch::COLUMNS.into_iter().enumerate() {
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
    let batch = ManipulabilityBatch::new(mechanism, options).unwrap();
    let rows = batch.analyse(q).unwrap();
    let n = mechanism.n();
    assert_eq!(rows.len(), q.len() / n * WIDTH);
    for (i, (q, row)) in q.chunks(n).zip(rows.chunks(WIDTH)).enumerate() {
        let about = (&options.metrics, options.task.as_ref());
        let expected = single(&batch, mechanism, q, about);
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

#[test]
fn agrees_in_other_metrics_frames_and_lengths() {
    let stewart = catalogue::load("stewart").unwrap();
    let q = postures(&stewart, 21, 0.3);
    let inertia = Matrix::from_fn(6, 6, |i, j| if i == j { 2.0 + i as f64 } else { 0.3 });
    let joints = Matrix::from_fn(6, 6, |i, j| if i == j { 1.0 + 0.1 * i as f64 } else { 0.05 });
    let metrics = Metrics::UNIT.with_object(&inertia).unwrap().with_joint(&joints).unwrap();
    let options = BatchOptions { metrics, length: Some(0.7), ..BatchOptions::default() };
    compare("own metrics", &stewart, &options, &q);
    let reference = Some(stewart.frame("rod3").unwrap());
    compare("rod", &stewart, &BatchOptions { reference, ..BatchOptions::default() }, &q);
    let two_arm = catalogue::load("two-arm").unwrap();
    let limits: Vec<f64> = (0..14).map(|i| 1.0 + 0.2 * f64::from(i)).collect();
    let metrics = Metrics::UNIT.with_velocity_limits(&limits).unwrap();
    let options = BatchOptions { metrics, ..BatchOptions::default() };
    compare("limits", &two_arm, &options, &postures(&two_arm, 13, 0.2));
    // Generic counts of one's own: every posture is then singular.
    let five_bar = catalogue::load("five-bar").unwrap();
    let batch = ManipulabilityBatch::new(&five_bar, &BatchOptions::default()).unwrap();
    let generic = Some(MobilityCounts { zero_torque: 0, ..batch.generic() });
    let options = BatchOptions { generic, ..BatchOptions::default() };
    compare("generic", &five_bar, &options, &postures(&five_bar, 9, 0.2));
}

/// Components and other maps of the twist; metrics are those of the task.
#[test]
fn agrees_for_tasks() {
    let rows = |rows: &[&[f64]]| Matrix::from_rows(rows).unwrap();
    let position = Matrix::from_fn(3, 6, |i, j| f64::from(u8::from(i == j)));
    let mixed = rows(&[&[1.0, 2.0, 0.0, 0.3, 0.0, 0.0], &[0.0, 1.0, -1.0, 0.0, 0.0, 4.0]]);
    let plane = rows(&[&[1.0, 0.0, 0.0], &[0.0, 1.0, 0.0]]);
    let with = |task: &Matrix| BatchOptions { task: Some(task.clone()), ..BatchOptions::default() };
    for name in ["panda", "ur5e", "youbot", "3r", "stewart", "delta", "two-arm"] {
        let mechanism = catalogue::load(name).unwrap();
        for task in [&position, &mixed] {
            let q = postures(&mechanism, 21, 0.4);
            compare(&format!("{name} of {} rows", task.rows()), &mechanism, &with(task), &q);
        }
    }
    let drives: [&[&str]; 5] =
        [&["q1", "q5"], &["q2", "q4"], &["q3"], &["q1", "q2", "q3"], &["q1"]];
    for driven in drives {
        let five_bar = catalogue::load("five-bar").unwrap().with_actuated(driven).unwrap();
        let q = postures(&five_bar, 31, 0.4);
        compare(&format!("five-bar {driven:?}"), &five_bar, &with(&plane), &q);
        compare("one", &five_bar, &with(&rows(&[&[1.0, 1.0, 0.5]])), &q);
    }
    let ur5e = catalogue::load("ur5e").unwrap();
    let joints = Matrix::from_fn(6, 6, |i, j| if i == j { 1.0 + 0.1 * i as f64 } else { 0.05 });
    let object = rows(&[&[2.0, 0.3], &[0.3, 1.0]]);
    let metrics = Metrics::UNIT.with_object(&object).unwrap().with_joint(&joints).unwrap();
    let options = BatchOptions { metrics, length: Some(0.7), ..with(&mixed) };
    compare("own metrics", &ur5e, &options, &postures(&ur5e, 21, 0.5));
}

/// A 3R arm loses motions of its point where it is straight; among all twists of space it lacks three
/// everywhere.
#[test]
fn tasks_have_their_own_singularities() {
    let arm = catalogue::load("3r").unwrap();
    let task = Matrix::from_fn(3, 6, |i, j| f64::from(u8::from(i == j)));
    let options = BatchOptions { task: Some(task), ..BatchOptions::default() };
    let batch = ManipulabilityBatch::new(&arm, &options).unwrap();
    assert_eq!((batch.generic().zero_torque, batch.generic().redundancy), (0, 0));
    let q = [[0.4, -0.5, 1.0], [0.4, -0.5, 0.0]].concat();
    let found = batch.analyse(&q).unwrap();
    let of =
        |row: usize, name: &str| found[row * WIDTH + ManipulabilityBatch::column(name).unwrap()];
    assert_eq!((of(0, "coordinate"), of(1, "coordinate")), (3.0, 2.0));
    assert_eq!((of(0, "zero_torque"), of(1, "zero_torque")), (0.0, 1.0));
    assert!(of(0, "type_i") > 0.05 && of(1, "type_i") == 0.0);
    let wrong = Matrix::from_fn(2, 6, |_, j| j as f64);
    let options = BatchOptions { task: Some(wrong), ..BatchOptions::default() };
    assert!(matches!(ManipulabilityBatch::new(&arm, &options), Err(Error::InvalidOption { .. })));
    let options = BatchOptions { task: Some(Matrix::identity(3)), ..BatchOptions::default() };
    assert!(matches!(ManipulabilityBatch::new(&arm, &options), Err(Error::Dimension { .. })));
}

/// A leg that is a screw, loop-closure joints of every kind that constrains rotations, and a mimic joint.
#[test]
fn agrees_for_closing_joints_of_all_kinds() {
    for (i, kind) in [
        JointKind::Fixed,
        JointKind::Revolute,
        JointKind::Prismatic,
        JointKind::Helical { pitch: 0.1 },
        JointKind::Cylindrical,
        JointKind::Universal { second: Vec3::new(0.2, 1.0, 0.1) },
        JointKind::Spherical,
        JointKind::Planar,
        JointKind::Free,
    ]
    .into_iter()
    .enumerate()
    {
        let mut random = Random(40 + i as u64);
        let mut b = Mechanism::builder("ring");
        let kinds = [
            JointKind::Revolute,
            JointKind::Helical { pitch: -0.2 },
            JointKind::Universal { second: Vec3::new(0.0, 1.0, 0.3) },
            JointKind::Prismatic,
            JointKind::Spherical,
        ];
        for (j, kind) in kinds.into_iter().enumerate() {
            b.joint(JointSpec {
                parent_from_joint: random.pose(),
                actuated: j != 2,
                reversed: i % 2 == 0,
                ..JointSpec::new(&format!("j{j}"), kind, &format!("l{j}"), &format!("l{}", j + 1))
            });
        }
        b.joint(JointSpec {
            mimic: Some(Mimic { joint: "j0".into(), multiplier: 0.7, offset: 0.1 }),
            parent_from_joint: random.pose(),
            ..JointSpec::new("follower", JointKind::Revolute, "l5", "l6")
        });
        let (a, of_a, of_b) = ("l1", random.pose(), random.pose());
        b.loop_joint(LoopJointSpec {
            link_a_from_joint: of_a,
            link_b_from_joint: of_b,
            axis: Vec3::new(0.1, -0.2, 1.0),
            ..LoopJointSpec::new("end", kind, a, "l6")
        });
        b.reference("l4");
        let mechanism = b.build().unwrap();
        let q: Vec<f64> = (0..13).flat_map(|_| random.q(&mechanism)).collect();
        compare(&format!("{kind:?}"), &mechanism, &BatchOptions::default(), &q);
    }
}

/// What a universal joint constrains is undetermined to rounding over the sine of its axes.
#[test]
fn agrees_where_the_axes_of_a_closing_joint_line_up() {
    let (first, second) = (Vec3::new(0.6, 0.0, 0.8), Vec3::new(0.0, 1.0, 0.0));
    let mut random = Random(51);
    let mut b = Mechanism::builder("ring");
    for (name, kind, [from, to]) in [
        ("crank", JointKind::Revolute, ["ground", "arm"]),
        ("ball", JointKind::Spherical, ["ground", "cylinder"]),
        ("slide", JointKind::Prismatic, ["cylinder", "rod"]),
    ] {
        b.joint(JointSpec {
            parent_from_joint: Pose::from_translation(random.vec3(1.0)),
            axis: if name == "slide" { Vec3::X } else { Vec3::Z },
            actuated: name == "crank",
            ..JointSpec::new(name, kind, from, to)
        });
    }
    b.loop_joint(LoopJointSpec {
        link_a_from_joint: Pose::from_translation(random.vec3(1.0)),
        link_b_from_joint: Pose::from_translation(random.vec3(1.0)),
        axis: first,
        ..LoopJointSpec::new("end", JointKind::Universal { second }, "arm", "rod")
    });
    b.reference("rod");
    let mechanism = b.build().unwrap();
    let goal = Rotation::exp(Vec3::Z * 0.4) * first;
    let across = second.cross(goal);
    let angle = across.norm().atan2(second.dot(goal));
    let mut q = Vec::new();
    for apart in [0.0, 1e-10, 1e-8, 5e-7, 0.2] {
        let turn = across * ((angle - apart) / across.norm());
        q.extend([0.4, turn.x, turn.y, turn.z, 0.3]);
    }
    compare("axes", &mechanism, &BatchOptions::default(), &q);
}

#[test]
fn singular_postures_among_others() {
    // Through the dead centre of a crank, and near it.
    let mechanism = file("five-bar-dead");
    let n = mechanism.n();
    let mut q = Vec::new();
    for step in [0.0, 1e-13, 1e-11, 1e-10, 3e-10, 1e-9, 3e-9, 1e-8, 1e-6, 1e-4, 1e-2] {
        let mut guess = mechanism.home().to_vec();
        guess[0] += step;
        q.extend(&guess);
        q.extend(assemble(&mechanism, &guess, &[0]).unwrap().q);
    }
    let batch = ManipulabilityBatch::new(&mechanism, &BatchOptions::default()).unwrap();
    compare("dead centre", &mechanism, &BatchOptions::default(), &q);
    let rows = batch.analyse(&q).unwrap();
    let type_i = ManipulabilityBatch::column("type_i").unwrap();
    assert_eq!(rows[type_i], 0.0);
    assert!(rows[rows.len() - WIDTH + type_i] > 1e-3, "{n}");
    // Arms stretched out, with the wrist singular, and at zero.
    for name in ["panda", "ur5e", "puma560"] {
        let arm = catalogue::load(name).unwrap();
        let mut q = vec![0.0; arm.n()];
        for i in 0..12 {
            let mut near = vec![0.0; arm.n()];
            near[i % arm.n()] = 10.0_f64.powi(-(i as i32));
            q.extend(near);
        }
        compare(name, &arm, &BatchOptions::default(), &q);
    }
}

#[test]
fn results_do_not_depend_on_threads_nor_on_neighbours() {
    for name in ["five-bar", "stewart", "two-arm"] {
        let mechanism = catalogue::load(name).unwrap();
        let batch = ManipulabilityBatch::new(&mechanism, &BatchOptions::default()).unwrap();
        let n = mechanism.n();
        let some = postures(&mechanism, 37, 0.3);
        let q = some.repeat(11);
        let run = |threads: usize| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            bits(&pool.install(|| batch.analyse(&q)).unwrap())
        };
        let one = run(1);
        for threads in [2, 4] {
            assert!(run(threads) == one, "{name}: {threads} threads");
        }
        for (i, q) in some.chunks(n).enumerate() {
            let alone = bits(&batch.analyse(q).unwrap());
            assert_eq!(alone, one[i * WIDTH..(i + 1) * WIDTH], "{name} {i}");
        }
    }
}

fn bits(x: &[f64]) -> Vec<u64> {
    x.iter().map(|x| x.to_bits()).collect()
}

#[test]
fn empty_and_wrong_batches() {
    let mechanism = catalogue::load("five-bar").unwrap();
    let batch = ManipulabilityBatch::new(&mechanism, &BatchOptions::default()).unwrap();
    assert_eq!((batch.n(), ManipulabilityBatch::COLUMNS.len()), (4, WIDTH));
    assert!(batch.analyse(&[]).unwrap().is_empty());
    let message = |e: Error| e.to_string();
    let e = message(batch.analyse(&[0.0; 5]).unwrap_err());
    assert_eq!(e, "q has 5 entries, expected 8 (4 for each configuration)");
    let mut q = [0.0; 12];
    q[9] = f64::NAN;
    assert_eq!(message(batch.analyse(&q).unwrap_err()), "q[2][1] (q2) is not finite: NaN");
    let e = message(batch.analyse_into(&[0.0; 8], &mut [0.0; 20]).unwrap_err());
    assert_eq!(e, "results has 20 entries, expected 38 (19 for each configuration)");
    // A box so far out that its constraint would overflow: the first of them is named.
    let two_arm = catalogue::load("two-arm").unwrap();
    let far = ManipulabilityBatch::new(&two_arm, &BatchOptions::default()).unwrap();
    let mut q = two_arm.home().repeat(400);
    for row in [390, 300, 140] {
        for (i, c) in two_arm.coordinates().iter().enumerate() {
            if c.kind == CoordinateKind::Position {
                q[row * two_arm.n() + i] = 1.7e308;
            }
        }
    }
    let e = message(far.analyse(&q).err().unwrap());
    assert!(e.starts_with("q[140][") && e.contains("= 1.7e308 is out of range"), "{e}");
    let wrong = Metrics::UNIT.with_object(&Matrix::identity(2)).unwrap();
    let options = BatchOptions { metrics: wrong, ..BatchOptions::default() };
    assert!(matches!(ManipulabilityBatch::new(&mechanism, &options), Err(Error::Dimension { .. })));
    let options = BatchOptions { length: Some(-1.0), ..BatchOptions::default() };
    assert!(matches!(
        ManipulabilityBatch::new(&mechanism, &options),
        Err(Error::InvalidOption { .. })
    ));
}
