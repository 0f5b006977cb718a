//! Inverse kinematics by formulas against forward kinematics, and against the search.

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use cylindroid::ik::{
    Analytic, FoundBy, Goal, IkOptions, NoStructure, Posture, Solver, solve_several,
};
use cylindroid::model::{JointKind, JointSpec, Limits};
use cylindroid::{Mechanism, Pose, Rotation, Vec3, catalogue};

use crate::support::{Random, unlimited};

/// An arm from its axes at zero: directions and points in the base, the tool in the base.
fn arm(axes: &[(Vec3, Vec3)], base: Pose, tool: Pose, limits: Limits) -> Mechanism {
    let mut b = Mechanism::builder("arm");
    let mut before = base.inverse();
    for (i, (direction, point)) in axes.iter().enumerate() {
        let here = Pose::from_translation(*point);
        b.joint(JointSpec {
            parent_from_joint: before.inverse() * here,
            axis: *direction,
            limits,
            ..JointSpec::new(
                &format!("q{}", i + 1),
                JointKind::Revolute,
                &format!("l{i}"),
                &format!("l{}", i + 1),
            )
        });
        before = here;
    }
    b.frame("tip", &format!("l{}", axes.len()), before.inverse() * tool);
    b.tool("tip");
    b.build().unwrap()
}

/// Axes of rows (alpha, a, d) of a standard Denavit-Hartenberg table, and the tool.
fn table(rows: &[[f64; 3]; 6]) -> ([(Vec3, Vec3); 6], Pose) {
    let mut here = Pose::IDENTITY;
    let axes = rows.map(|[alpha, a, d]| {
        let axis = (here.rotation.z_axis(), here.translation);
        let turn = Rotation::about(Vec3::X, alpha).unwrap();
        here = here * Pose { rotation: turn, translation: Vec3::new(a, 0.0, d) };
        axis
    });
    (axes, here)
}

fn unit(random: &mut Random) -> Vec3 {
    random.vec3(1.0).unit(0.1).unwrap_or(Vec3::X)
}

/// A random arm whose axes have a structure, by its name.
fn random_arm(name: &str, random: &mut Random) -> Mechanism {
    let mut h: [Vec3; 6] = std::array::from_fn(|_| unit(random));
    let mut o: [Vec3; 6] = std::array::from_fn(|_| random.vec3(0.5));
    let reversed = name.contains("shoulder") || name.contains("3, 4 and 5");
    if name.contains("spherical") {
        (o[4], o[5]) = (o[3], o[3]);
    } else {
        (h[2], h[3]) = (h[1], -h[1]);
    }
    let pair = |name: &str| -> Option<(usize, usize)> {
        let digits: Vec<usize> = name
            .split(", ")
            .last()?
            .chars()
            .filter_map(|c| c.to_digit(10))
            .map(|d| d as usize)
            .collect();
        let [a, b] = digits[..] else { return None };
        Some(if reversed { (6 - b, 6 - a) } else { (a - 1, b - 1) })
    };
    if let Some((a, b)) = pair(name).filter(|_| name.contains("meet")) {
        o[b] = o[a];
    } else if let Some((a, b)) = pair(name).filter(|_| name.contains("spherical")) {
        h[b] = h[a];
    }
    if reversed {
        h.reverse();
        o.reverse();
    }
    let axes: Vec<_> = h.into_iter().zip(o).collect();
    arm(&axes, random.pose(), random.pose(), Limits::NONE)
}

const STRUCTURES: [&str; 14] = [
    "spherical wrist, parallel axes 2 and 3",
    "spherical wrist, parallel axes 1 and 2",
    "spherical wrist, axes 2 and 3 meet",
    "spherical wrist, axes 1 and 2 meet",
    "spherical wrist",
    "spherical shoulder, parallel axes 4 and 5",
    "spherical shoulder, parallel axes 5 and 6",
    "spherical shoulder, axes 4 and 5 meet",
    "spherical shoulder, axes 5 and 6 meet",
    "spherical shoulder",
    "parallel axes 2, 3 and 4, axes 5 and 6 meet",
    "parallel axes 2, 3 and 4",
    "parallel axes 3, 4 and 5, axes 1 and 2 meet",
    "parallel axes 3, 4 and 5",
];

/// UR5 and UR10: parameters for calculations of kinematics and dynamics, Universal Robots.
fn ur(a: [f64; 2], d: [f64; 4]) -> ([(Vec3, Vec3); 6], Pose) {
    table(&[
        [FRAC_PI_2, 0.0, d[0]],
        [0.0, a[0], 0.0],
        [0.0, a[1], 0.0],
        [FRAC_PI_2, 0.0, d[1]],
        [-FRAC_PI_2, 0.0, d[2]],
        [0.0, 0.0, d[3]],
    ])
}

fn published() -> Vec<Mechanism> {
    let mut all: Vec<Mechanism> =
        ["ur5e", "puma560"].map(|name| unlimited(&catalogue::load(name).unwrap())).into();
    let ur5 = ur([-0.425, -0.392_25], [0.089_159, 0.109_15, 0.094_65, 0.0823]);
    let ur10 = ur([-0.612, -0.5723], [0.1273, 0.163_941, 0.1157, 0.0922]);
    for (axes, tool) in [ur5, ur10] {
        all.push(arm(&axes, Pose::IDENTITY, tool, Limits::NONE));
    }
    all
}

/// Differences modulo whole turns, the largest.
fn apart(a: &[f64], b: &[f64]) -> f64 {
    let one = |(a, b): (&f64, &f64)| ((a - b) - TAU * ((a - b) / TAU).round()).abs();
    a.iter().zip(b).map(one).fold(0.0, f64::max)
}

/// Forward kinematics says the same, to 1e-10 in both parts.
fn confirm(robot: &Mechanism, target: Pose, answers: &[Posture]) {
    for answer in answers {
        let error = robot.state(&answer.q).unwrap().pose(robot.tool()).error_to(target);
        let far = (error.linear.norm(), error.angular.norm());
        assert!(far.0 < 1e-10 * robot.reach() && far.1 < 1e-10, "{far:?} {answer:?}");
        assert!(answer.q.iter().all(|x| x.is_finite()));
    }
    for (i, a) in answers.iter().enumerate() {
        assert!(answers[..i].iter().all(|b| apart(&a.q, &b.q) > 1e-7), "{answers:?}");
    }
}

/// The smallest over the largest singular value, lengths over the reach.
fn condition(robot: &Mechanism, q: &[f64]) -> f64 {
    let mut j =
        robot.state(q).unwrap().jacobian(robot.tool(), cylindroid::Reference::LocalWorldAligned);
    for c in 0..6 {
        (0..3).for_each(|r| j[(r, c)] /= robot.reach());
    }
    let svd = cylindroid::linalg::Svd::of(&j);
    svd.value(5) / svd.value(0)
}

/// The posture that made the target is among the answers.
fn known_postures_are_found(robot: &Mechanism, random: &mut Random, count: usize) -> usize {
    let mut ik = Analytic::of(robot, robot.tool()).unwrap();
    let mut most = 0;
    for _ in 0..count {
        let q = random.vector(6).iter().map(|x| PI * x).collect::<Vec<_>>();
        let target = robot.state(&q).unwrap().pose(robot.tool());
        let start = random.vector(6);
        let answers = ik.solve(target, &start).unwrap();
        confirm(robot, target, &answers);
        let near = answers.iter().map(|a| apart(&a.q, &q)).fold(9.0, f64::min);
        // An angle is known to the error of the pose over the conditioning.
        let condition = condition(robot, &q);
        assert!(
            near < 1e-9 + 1e-12 / condition || condition < 1e-7,
            "{}: {near:e} at {condition:e}, {answers:?}, {q:?}",
            ik.structure()
        );
        most = most.max(answers.len());
    }
    most
}

#[test]
fn published_arms() {
    let mut random = Random(71);
    let names = [
        "parallel axes 2, 3 and 4, axes 5 and 6 meet",
        "spherical wrist, parallel axes 2 and 3",
        "parallel axes 2, 3 and 4, axes 5 and 6 meet",
        "parallel axes 2, 3 and 4, axes 5 and 6 meet",
    ];
    for (robot, name) in published().iter().zip(names) {
        let ik = Analytic::of(robot, robot.tool()).unwrap();
        assert!(ik.structure().to_string() == name && ik.is_exact(), "{}", ik.structure());
        assert_eq!(known_postures_are_found(robot, &mut random, 2000), 8);
    }
}

#[test]
fn random_arms_of_every_structure() {
    let mut random = Random(72);
    for name in STRUCTURES {
        for _ in 0..20 {
            let robot = random_arm(name, &mut random);
            let ik = Analytic::of(&robot, robot.tool()).unwrap();
            assert!(
                ik.structure().to_string() == name && ik.is_exact(),
                "{} {name}",
                ik.structure()
            );
            known_postures_are_found(&robot, &mut random, 100);
        }
    }
}

/// Where the pose leaves a joint free it keeps the value of the start, and the answer says so.
#[test]
fn a_straight_wrist_leaves_a_joint_free() {
    let mut random = Random(73);
    // The joint that is free, and the one that is zero.
    for (robot, free, zero) in published().iter().zip([5, 3, 5, 5]).map(|(r, f)| (r, f, 4)) {
        let mut ik = Analytic::of(robot, robot.tool()).unwrap();
        let mut kept = 0;
        for i in 0..200 {
            let mut q = random.vector(6).iter().map(|x| 3.0 * x).collect::<Vec<_>>();
            // At it, and so near that rounding tells no difference.
            q[zero] = [0.0, 1e-13, -1e-12][i % 3];
            let target = robot.state(&q).unwrap().pose(robot.tool());
            let start = random.vector(6);
            let answers = ik.solve(target, &start).unwrap();
            confirm(robot, target, &answers);
            let own = answers.iter().find(|a| apart(&a.q[..1], &q[..1]) < 1e-5 && a.free[free]);
            let own = own.unwrap_or_else(|| panic!("{}: {q:?} {answers:?}", robot.name()));
            kept += usize::from((own.q[free] - start[free]).abs() < 1e-12);
            // At the start itself the answer is the start.
            let answers = ik.solve(target, &q).unwrap();
            assert!(answers.iter().any(|a| apart(&a.q, &q) < 1e-6), "{q:?} {answers:?}");
        }
        // Links of a UR arm may be too short for another turn of the wrist, a wrist that meets never.
        assert!(kept == 200 || (free == 5 && kept > 100), "{kept}");
        // A thousandth away nothing is free.
        let mut q = [0.3, -1.0, 1.2, 0.4, 0.5, 0.6];
        q[zero] = 1e-3;
        let target = robot.state(&q).unwrap().pose(robot.tool());
        let answers = ik.solve(target, &[0.0; 6]).unwrap();
        assert!(answers.iter().all(|a| a.free == [false; 6]));
        assert!(answers.iter().any(|a| apart(&a.q, &q) < 1e-9), "{answers:?}");
    }
}

/// A wrist above the shoulder: the first joint is free. A stretched elbow: two postures are one.
#[test]
fn shoulder_and_elbow() {
    let mut random = Random(74);
    let (axes, tool) = table(&[
        [FRAC_PI_2, 0.0, 0.0],
        [0.0, 0.5, 0.0],
        [FRAC_PI_2, 0.0, 0.0],
        [-FRAC_PI_2, 0.0, 0.4],
        [FRAC_PI_2, 0.0, 0.0],
        [0.0, 0.0, 0.1],
    ]);
    let robot = arm(&axes, random.pose(), tool, Limits::NONE);
    let mut ik = Analytic::of(&robot, robot.tool()).unwrap();
    for _ in 0..200 {
        let mut q = random.vector(6).iter().map(|x| 3.0 * x).collect::<Vec<_>>();
        // In the plane of the arm the wrist is at angle q2 + b from the first axis' normal.
        let b = (-0.4 * q[2].cos()).atan2(0.5 + 0.4 * q[2].sin());
        q[1] = FRAC_PI_2 - b;
        let target = robot.state(&q).unwrap().pose(robot.tool());
        let start = random.vector(6);
        let answers = ik.solve(target, &start).unwrap();
        confirm(&robot, target, &answers);
        assert!(answers.iter().any(|a| a.free[0]), "{q:?} {answers:?}");
        for a in answers.iter().filter(|a| a.free[0]) {
            assert!((a.q[0] - start[0]).abs() < 1e-12);
        }
        let answers = ik.solve(target, &q).unwrap();
        assert!(answers.iter().any(|a| apart(&a.q, &q) < 1e-6), "{q:?} {answers:?}");
        // Stretched: the arm's two links in line.
        q[2] = FRAC_PI_2;
        q[1] = 0.7;
        let target = robot.state(&q).unwrap().pose(robot.tool());
        let answers = ik.solve(target, &start).unwrap();
        confirm(&robot, target, &answers);
        assert!(answers.iter().any(|a| apart(&a.q, &q) < 1e-5), "{q:?} {answers:?}");
    }
    let ur = &published()[0];
    let mut ik = Analytic::of(ur, ur.tool()).unwrap();
    for (place, value) in [(2, 0.0), (2, 1e-9), (2, PI), (4, PI)] {
        let mut q = [0.3, -1.0, 1.2, 0.4, 0.5, 0.6];
        q[place] = value;
        let target = ur.state(&q).unwrap().pose(ur.tool());
        let answers = ik.solve(target, &q).unwrap();
        confirm(ur, target, &answers);
        assert!(answers.iter().any(|a| apart(&a.q, &q) < 1e-5), "{q:?} {answers:?}");
    }
}

#[test]
fn out_of_reach_has_no_answer() {
    let mut random = Random(75);
    for robot in published() {
        let mut ik = Analytic::of(&robot, robot.tool()).unwrap();
        for _ in 0..100 {
            let mut target = random.pose();
            target.translation = unit(&mut random) * (1.5 * robot.reach());
            assert!(ik.solve(target, &[0.0; 6]).unwrap().is_empty());
        }
        // Within the column that the arm's own offset keeps free.
        let mut target = robot.state(&[0.1; 6]).unwrap().pose(robot.tool());
        let wrist = target.translation + target.rotation * Vec3::new(0.0, 0.0, -0.0996);
        target.translation += Vec3::new(-wrist.x, -wrist.y, 0.0);
        if robot.name() == "ur5e" {
            assert!(ik.solve(target, &[0.0; 6]).unwrap().is_empty());
        }
    }
}

/// Axes of files that print few digits are made good; axes that pass each other have no structure.
#[test]
fn nearly_a_structure() {
    let mut random = Random(76);
    let turn = FRAC_PI_2 + 3.7e-6; // printed as 1.5708
    let puma = |offset: f64| {
        table(&[
            [turn, 0.0, 0.0],
            [0.0, 0.4318, 0.0],
            [-turn, 0.0203, 0.15005],
            [turn, 0.0, 0.4318],
            [-turn, offset, 0.0],
            [0.0, 0.0, 0.1],
        ])
    };
    let ur = table(&[
        [turn, 0.0, 0.1625],
        [1e-6, -0.425, 0.0],
        [0.0, -0.3922, 0.0],
        [turn, 0.0, 0.1333],
        [-turn, 0.0, 0.0997],
        [0.0, 0.0, 0.0996],
    ]);
    for (axes, tool) in [puma(1e-6), ur] {
        let robot = arm(&axes, random.pose(), tool, Limits::NONE);
        let mut ik = Analytic::of(&robot, robot.tool()).unwrap();
        assert!(!ik.is_exact());
        for _ in 0..500 {
            let q = random.vector(6).iter().map(|x| PI * x).collect::<Vec<_>>();
            let target = robot.state(&q).unwrap().pose(robot.tool());
            let answers = ik.solve(target, &q).unwrap();
            confirm(&robot, target, &answers);
            let found = answers.iter().any(|a| apart(&a.q, &q) < 1e-7);
            assert!(found || condition(&robot, &q) < 2e-2, "{q:?} {answers:?}");
        }
    }
    let (axes, tool) = puma(1e-3);
    let robot = arm(&axes, Pose::IDENTITY, tool, Limits::NONE);
    let why = Analytic::of(&robot, robot.tool()).unwrap_err();
    assert_eq!(why, NoStructure::Axes);
    assert!(why.to_string().contains("neither"), "{why}");
}

/// Where base and tool sit changes nothing.
#[test]
fn frames_change_nothing() {
    let mut random = Random(77);
    for name in STRUCTURES {
        let robot = random_arm(name, &mut random);
        let axes: Vec<(Vec3, Vec3)> = (0..6)
            .map(|i| {
                let pose = robot
                    .state(&[0.0; 6])
                    .unwrap()
                    .pose(robot.frame(&format!("l{}", i + 1)).unwrap());
                (pose.rotation * robot.joints()[i].axis, pose.translation)
            })
            .collect();
        let plain = arm(&axes, Pose::IDENTITY, Pose::IDENTITY, Limits::NONE);
        let (base, tool) = (random.pose(), random.pose());
        let moved = arm(&axes, base, tool, Limits::NONE);
        let structure = |robot: &Mechanism| Analytic::of(robot, robot.tool()).unwrap().structure();
        assert_eq!(structure(&plain), structure(&moved));
        let q: Vec<f64> = random.vector(6);
        let solve = |robot: &Mechanism| {
            let target = robot.state(&q).unwrap().pose(robot.tool());
            Analytic::of(robot, robot.tool()).unwrap().solve(target, &[0.0; 6]).unwrap()
        };
        let (a, b) = (solve(&plain), solve(&moved));
        assert_eq!(a.len(), b.len(), "{name}");
        for one in a.iter() {
            assert!(b.iter().any(|other| apart(&one.q, &other.q) < 1e-6), "{name}: {a:?} {b:?}");
        }
    }
}

/// As many as a search finds that knows nothing of structures. (Two goals that are one keep it from
/// the formulas.)
#[test]
fn as_many_as_a_long_search_finds() {
    let mut random = Random(78);
    let (mut robots, mut compared) = (published(), 0);
    robots.extend(STRUCTURES.map(|name| random_arm(name, &mut random)));
    for robot in robots {
        let mut ik = Analytic::of(&robot, robot.tool()).unwrap();
        for _ in 0..4 {
            let q = random.vector(6).iter().map(|x| PI * x).collect::<Vec<_>>();
            let target = robot.state(&q).unwrap().pose(robot.tool());
            let goal = Goal::pose(robot.tool(), target);
            let answers = ik.solve(target, &q).unwrap();
            confirm(&robot, target, &answers);
            // Beside singular postures a search takes many for answers.
            if answers.iter().any(|a| condition(&robot, &a.q) < 3e-3) {
                continue;
            }
            compared += 1;
            let options = IkOptions {
                position_tolerance: 1e-9,
                orientation_tolerance: 1e-9,
                ..IkOptions::default()
            };
            let found = solve_several(&robot, &[goal, goal], &options, 20).unwrap();
            assert_eq!(found.len(), answers.len(), "{}", ik.structure());
            for one in &found {
                assert!(answers.iter().any(|a| apart(&a.q, &one.q) < 1e-3), "{one:?} {answers:?}");
            }
        }
    }
    assert!(compared > 20, "{compared}");
}

/// Limits are kept to the last bit, angles come in the turn nearest to the start, and other turns
/// are there for the asking.
#[test]
fn limits_and_whole_turns() {
    let mut random = Random(79);
    for name in ["ur5e", "puma560"] {
        let robot = catalogue::load(name).unwrap();
        let mut ik = Analytic::of(&robot, robot.tool()).unwrap();
        let limits: Vec<Limits> = robot.coordinates().iter().map(|c| c.limits).collect();
        for i in 0..300 {
            let mut q = random.q(&robot);
            if i % 2 == 0 {
                q[i / 2 % 6] =
                    if i % 4 == 0 { limits[i / 2 % 6].lower } else { limits[i / 2 % 6].upper };
            }
            let target = robot.state(&q).unwrap().pose(robot.tool());
            let start: Vec<f64> = random.vector(6).iter().map(|x| 8.0 * x).collect();
            let answers = ik.solve(target, &start).unwrap();
            confirm(&robot, target, &answers);
            // A wrist at a limit of two turns is straight, and the known posture one of many.
            let found = answers.iter().any(|a| apart(&a.q, &q) < 1e-6 || a.free != [false; 6]);
            assert!(found, "{q:?} {answers:?}");
            for answer in answers.iter() {
                assert_eq!(robot.outside_limits(&answer.q).next(), None);
                let all = ik.with_whole_turns(answer);
                assert!(all.contains(&answer.q), "{answer:?} {all:?}");
                let turns = |i: usize| ((limits[i].upper - limits[i].lower) / TAU + 1.0) as usize;
                assert!(all.len() <= (0..6).map(turns).product());
                let far = |q: &[f64; 6]| -> f64 {
                    q.iter().zip(&start).map(|(a, b)| (a - b).powi(2)).sum()
                };
                for other in &all {
                    assert_eq!(robot.outside_limits(other).next(), None);
                    assert!(apart(other, &answer.q) < 1e-9);
                    assert!(far(other) >= far(&answer.q) - 1e-6, "{start:?} {other:?} {answer:?}");
                }
            }
        }
    }
    let robot = catalogue::load("ur5e").unwrap();
    let ik = Analytic::of(&robot, robot.tool()).unwrap();
    let answer = Posture {
        q: [0.3, -1.1, 1.4, 0.2, 1.0, 0.4],
        free: [false; 6],
        position_error: 0.0,
        orientation_error: 0.0,
    };
    assert_eq!(ik.with_whole_turns(&answer).len(), 32);
}

/// Seven joints are six where one is held, at any value.
#[test]
fn seven_joints_with_one_held() {
    let mut random = Random(80);
    let cases = [
        ("iiwa14", 2, "spherical wrist, "),
        ("iiwa14", 6, "spherical shoulder, "),
        ("panda", 6, "spherical shoulder, axes 5 and 6 meet"),
    ];
    for (name, held, words) in cases {
        let robot = unlimited(&catalogue::load(name).unwrap());
        let mut ik = Analytic::holding(&robot, robot.tool(), &[held]).unwrap();
        assert!(ik.structure().to_string().starts_with(words), "{}", ik.structure());
        for _ in 0..500 {
            let q: Vec<f64> = random.vector(7).iter().map(|x| 3.0 * x).collect();
            let target = robot.state(&q).unwrap().pose(robot.tool());
            let mut start = random.vector(7);
            start[held] = q[held];
            let answers = ik.solve(target, &start).unwrap();
            let mut near = 9.0_f64;
            for answer in answers.iter() {
                let mut whole = start.clone();
                ik.coordinates().iter().zip(answer.q).for_each(|(&c, x)| whole[c] = x);
                let error = robot.state(&whole).unwrap().pose(robot.tool()).error_to(target);
                assert!(error.linear.norm() < 2e-10 && error.angular.norm() < 1e-10);
                near = near.min(apart(&whole, &q));
            }
            assert!(near < 1e-6, "{name}: {near:e} {q:?} {answers:?}");
        }
    }
}

#[test]
fn why_not() {
    let of = |name: &str| {
        let robot = catalogue::load(name).unwrap();
        Analytic::of(&robot, robot.tool()).unwrap_err()
    };
    assert_eq!(of("panda"), NoStructure::Joints(7));
    assert_eq!(of("youbot"), NoStructure::Joints(5));
    assert_eq!(of("two-arm"), NoStructure::Loops);
    assert!(of("panda").to_string().contains('7'));
    let mut random = Random(81);
    let axes: Vec<_> = (0..6).map(|_| (unit(&mut random), random.vec3(0.5))).collect();
    let skew = arm(&axes, Pose::IDENTITY, Pose::IDENTITY, Limits::NONE);
    assert_eq!(Analytic::of(&skew, skew.tool()).unwrap_err(), NoStructure::Axes);
    let mut b = Mechanism::builder("slides");
    for i in 0..6 {
        let kind = if i == 3 { JointKind::Prismatic } else { JointKind::Revolute };
        let (parent, child) = (format!("l{i}"), format!("l{}", i + 1));
        b.joint(JointSpec::new(&format!("q{i}"), kind, &parent, &child));
    }
    let slides = b.build().unwrap();
    assert_eq!(Analytic::of(&slides, slides.tool()).unwrap_err(), NoStructure::Kind);
    let ur5e = catalogue::load("ur5e").unwrap();
    let mut ik = Analytic::of(&ur5e, ur5e.tool()).unwrap();
    assert!(ik.solve(Pose::IDENTITY, &[0.0; 5]).is_err());
    assert!(ik.solve(Pose::IDENTITY, &[f64::NAN; 6]).is_err());
    let nan = Pose::from_translation(Vec3::new(f64::NAN, 0.0, 0.0));
    assert!(ik.solve(nan, &[0.0; 6]).is_err());
    let far = Pose::from_translation(Vec3::new(1e300, 1e300, 0.0));
    assert!(ik.solve(far, &[1e300; 6]).unwrap().is_empty());
}

/// The search takes formulas where there are some, and says so.
#[test]
fn the_search_uses_formulas() {
    let mut random = Random(82);
    for (name, structure) in [
        ("ur5e", Some("parallel axes 2, 3 and 4, axes 5 and 6 meet")),
        ("puma560", Some("spherical wrist, parallel axes 2 and 3")),
        ("panda", Some("spherical shoulder, axes 5 and 6 meet")),
        ("iiwa14", Some("spherical shoulder, axes 4 and 5 meet")),
        ("youbot", None),
    ] {
        let robot = catalogue::load(name).unwrap();
        let mut by_formulas = 0;
        for nearest in [false, true] {
            let mut solver = None;
            for _ in 0..50 {
                let known = random.q(&robot);
                let target = robot.state(&known).unwrap().pose(robot.tool());
                let goals = [Goal::pose(robot.tool(), target)];
                let start: Vec<f64> = known.iter().map(|x| x + random.within(-0.3, 0.3)).collect();
                let options =
                    IkOptions { nearest, start: Some(start.clone()), ..IkOptions::default() };
                let solver =
                    solver.get_or_insert_with(|| Solver::new(&robot, &goals, &options).unwrap());
                assert_eq!(
                    solver.analytic().map(|a| a.structure().to_string()).as_deref(),
                    structure
                );
                solver.start_at(&start).unwrap();
                let found = solver.solve(&goals).unwrap();
                assert!(found.success && robot.outside_limits(&found.q).next().is_none());
                let formulas = found.found_by == FoundBy::Analytic;
                by_formulas += usize::from(formulas);
                assert!(structure.is_some() || !formulas);
                if robot.n() == 6 && formulas {
                    assert_eq!(found.attempts, 1);
                    assert!(found.position_error < 1e-9 && found.orientation_error < 1e-9);
                }
            }
        }
        let least = if structure.is_none() {
            0
        } else if robot.n() == 6 {
            95
        } else {
            40
        };
        assert!(by_formulas >= least, "{name}: {by_formulas}");
    }
    // What limits exclude is given up soon.
    let puma = catalogue::load("puma560").unwrap();
    let mut q = puma.home().to_vec();
    q[0] = PI;
    q[2] = -0.5;
    let target = puma.state(&q).unwrap().pose(puma.tool());
    let free = unlimited(&puma);
    let mut ik = Analytic::of(&free, free.tool()).unwrap();
    assert!(!ik.solve(target, &q).unwrap().is_empty());
    let goals = [Goal::pose(puma.tool(), target)];
    let found = solve_several(&puma, &goals, &IkOptions::default(), 8).unwrap();
    let alone = cylindroid::ik::solve(&puma, &goals, &IkOptions::default()).unwrap();
    assert_eq!(found.is_empty(), !alone.success);
    assert!(alone.success || alone.attempts < 60, "{alone:?}");
}
