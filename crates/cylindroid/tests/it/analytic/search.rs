//! Seven joints, arms without a structure, and the search that takes formulas where it can.

use std::f64::consts::PI;

use cylindroid::ik::{Analytic, FoundBy, Goal, IkOptions, NotSolvable, Solver, solve_distinct};
use cylindroid::model::{JointKind, JointSpec, Limits};
use cylindroid::{Mechanism, Pose, Rotation, Vec3, catalogue};

use super::arms::{arm, unit};
use super::law::apart;
use crate::support::{Random, unlimited};

/// Seven joints are six where one is locked, at any value.
#[test]
fn seven_joints_with_one_held() {
    let mut random = Random(80);
    let cases = [
        ("iiwa14", 2, "spherical wrist, "),
        ("iiwa14", 6, "spherical shoulder, "),
        ("panda", 6, "spherical shoulder, axes 5 and 6 meet"),
    ];
    for (name, locked, words) in cases {
        let robot = unlimited(&catalogue::load(name).unwrap());
        let mut ik = Analytic::with_locked(&robot, robot.tool(), &[locked]).unwrap();
        assert!(ik.geometry().to_string().starts_with(words), "{}", ik.geometry());
        for _ in 0..500 {
            let q: Vec<f64> = random.vector(7).iter().map(|x| 3.0 * x).collect();
            let target = robot.state(&q).unwrap().pose(robot.tool()).unwrap();
            let mut start = random.vector(7);
            start[locked] = q[locked];
            let answers = ik.solve(target, &start).unwrap();
            let mut near = 9.0_f64;
            for answer in answers.iter() {
                let mut whole = start.clone();
                ik.coordinates().iter().zip(answer.q).for_each(|(&c, x)| whole[c] = x);
                let error =
                    robot.state(&whole).unwrap().pose(robot.tool()).unwrap().error_to(target);
                assert!(error.linear.norm() < 2e-10 && error.angular.norm() < 1e-10);
                near = near.min(apart(&whole, &q));
            }
            assert!(near < 1e-6, "{name}: {near:e} {q:?} {answers:?}");
        }
    }
}

/// Six revolute joints with a closed form, and a seventh joint that carries a tool off its axis.
fn with_a_joint_beyond(seventh: JointKind, is_wrist_last: bool) -> Mechanism {
    let mut builder = Mechanism::builder("seven");
    // A spherical wrist, or the same read from the tool: a spherical shoulder.
    let places = if is_wrist_last {
        [
            (Vec3::new(0.0, 0.0, 0.3), Vec3::Z),
            (Vec3::new(0.1, 0.0, 0.1), Vec3::Y),
            (Vec3::new(0.0, 0.0, 0.4), Vec3::Y),
            (Vec3::new(0.3, 0.0, 0.05), Vec3::X),
            (Vec3::ZERO, Vec3::Y),
            (Vec3::ZERO, Vec3::X),
        ]
    } else {
        [
            (Vec3::new(0.0, 0.1, 0.3), Vec3::Z),
            (Vec3::ZERO, Vec3::Y),
            (Vec3::ZERO, Vec3::Z),
            (Vec3::new(0.05, 0.0, 0.4), Vec3::Y),
            (Vec3::new(-0.05, 0.0, 0.3), Vec3::Z),
            (Vec3::new(0.0, 0.0, 0.1), Vec3::Y),
        ]
    };
    let seventh = (Vec3::new(0.02, 0.05, 0.1), Vec3::new(0.3, -0.2, 1.0), seventh);
    let six = places.map(|(at, axis)| (at, axis, JointKind::Revolute));
    for (i, (at, axis, kind)) in six.into_iter().chain([seventh]).enumerate() {
        builder.joint(JointSpec {
            parent_from_joint: Pose::from_translation(at),
            axis,
            ..JointSpec::new(&format!("q{i}"), kind, &format!("l{i}"), &format!("l{}", i + 1))
        });
    }
    let tool = Pose {
        rotation: Rotation::exp(Vec3::new(0.3, 1.0, -0.4)),
        translation: Vec3::new(0.1, -0.2, 0.3),
    };
    builder.frame("tip", "l7", tool).tool("tip");
    builder.build().unwrap()
}

/// A joint beyond the six moves a tool that is off its axis: no answer is missing, and none depends on
/// those before it.
#[test]
fn a_locked_joint_beyond_the_six() {
    let mut random = Random(81);
    for (kind, is_wrist_last) in [
        (JointKind::Revolute, true),
        (JointKind::Revolute, false),
        (JointKind::Prismatic, true),
        (JointKind::Prismatic, false),
    ] {
        let robot = with_a_joint_beyond(kind, is_wrist_last);
        let new = || Analytic::with_locked(&robot, robot.tool(), &[6]).unwrap();
        let mut ik = new();
        let words = if is_wrist_last { "spherical wrist" } else { "spherical shoulder" };
        assert!(ik.geometry().to_string().starts_with(words), "{}", ik.geometry());
        for i in 0..100 {
            let q: Vec<f64> = random.vector(7).iter().map(|x| 3.0 * x).collect();
            let target = robot.state(&q).unwrap().pose(robot.tool()).unwrap();
            if i % 10 == 0 && kind == JointKind::Prismatic {
                // Far away no pose is reached.
                let mut far = q.clone();
                far[6] = 1e100;
                assert!(ik.solve(target, &far).unwrap().is_empty());
            }
            let answers = ik.solve(target, &q).unwrap();
            let found = answers.iter().any(|answer| apart(&answer.q, &q[..6]) < 1e-6);
            assert!(found, "{words}, {kind:?}: {q:?} {answers:?}");
            assert_eq!(new().solve(target, &q).unwrap(), answers, "{words}, {kind:?}: {q:?}");
        }
    }
}

#[test]
fn why_not() {
    let of = |name: &str| {
        let robot = catalogue::load(name).unwrap();
        Analytic::of(&robot, robot.tool()).unwrap_err()
    };
    assert_eq!(of("panda"), NotSolvable::Joints(7));
    assert_eq!(of("youbot"), NotSolvable::Joints(5));
    assert_eq!(of("two-arm"), NotSolvable::Loops);
    assert!(of("panda").to_string().contains('7'));
    let mut random = Random(81);
    let axes: Vec<_> = (0..6).map(|_| (unit(&mut random), random.vec3(0.5))).collect();
    let skew = arm(&axes, Pose::IDENTITY, Pose::IDENTITY, Limits::NONE);
    assert_eq!(Analytic::of(&skew, skew.tool()).unwrap_err(), NotSolvable::Axes);
    let mut b = Mechanism::builder("slides");
    for i in 0..6 {
        let kind = if i == 3 { JointKind::Prismatic } else { JointKind::Revolute };
        let (parent, child) = (format!("l{i}"), format!("l{}", i + 1));
        b.joint(JointSpec::new(&format!("q{i}"), kind, &parent, &child));
    }
    let slides = b.build().unwrap();
    assert_eq!(Analytic::of(&slides, slides.tool()).unwrap_err(), NotSolvable::Kind);
    let ur5e = catalogue::load("ur5e").unwrap();
    let mut ik = Analytic::of(&ur5e, ur5e.tool()).unwrap();
    assert!(ik.solve(Pose::IDENTITY, &[0.0; 5]).is_err());
    assert!(ik.solve(Pose::IDENTITY, &[f64::NAN; 6]).is_err());
    let nan = Pose::from_translation(Vec3::new(f64::NAN, 0.0, 0.0));
    assert!(ik.solve(nan, &[0.0; 6]).is_err());
    let far = |size: f64| Pose::from_translation(Vec3::new(size, size, 0.0));
    assert!(ik.solve(far(1e119), &[1e300; 6]).unwrap().is_empty());
    assert!(ik.solve(far(1e121), &[0.0; 6]).is_err());
}

/// The search takes formulas where there are some, and says so.
#[test]
fn the_search_uses_formulas() {
    let mut random = Random(82);
    for (name, structure) in [
        ("ur5e", Some("parallel axes 2, 3 and 4, axes 5 and 6 meet")),
        ("puma560", Some("spherical wrist, parallel axes 2 and 3")),
        ("panda", Some("spherical shoulder, axes 5 and 6 meet")),
        ("iiwa14", Some("spherical wrist, axes 1 and 2 meet")),
        ("youbot", None),
    ] {
        let robot = catalogue::load(name).unwrap();
        let mut by_formulas = 0;
        for nearest in [false, true] {
            let mut solver = None;
            for _ in 0..50 {
                let known = random.q(&robot);
                let target = robot.state(&known).unwrap().pose(robot.tool()).unwrap();
                let goals = [Goal::pose(robot.tool(), target)];
                let start: Vec<f64> = known.iter().map(|x| x + random.within(-0.3, 0.3)).collect();
                let options = IkOptions {
                    nearest,
                    initial_guess: Some(start.clone()),
                    ..IkOptions::default()
                };
                let solver =
                    solver.get_or_insert_with(|| Solver::new(&robot, &goals, &options).unwrap());
                assert_eq!(
                    solver.analytic().map(|a| a.geometry().to_string()).as_deref(),
                    structure
                );
                solver.set_initial_guess(&start).unwrap();
                let found = solver.solve(&goals).unwrap();
                assert!(found.success && robot.outside_limits(&found.q).next().is_none());
                let formulas = found.found_by == FoundBy::Analytic;
                by_formulas += usize::from(formulas);
                assert!(structure.is_some() || !formulas);
                if robot.n() == 6 && formulas {
                    assert_eq!(found.restarts, 1);
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
    let target = puma.state(&q).unwrap().pose(puma.tool()).unwrap();
    let free = unlimited(&puma);
    let mut ik = Analytic::of(&free, free.tool()).unwrap();
    assert!(!ik.solve(target, &q).unwrap().is_empty());
    let goals = [Goal::pose(puma.tool(), target)];
    let found = solve_distinct(&puma, &goals, &IkOptions::default(), 8).unwrap();
    let alone = cylindroid::ik::solve(&puma, &goals, &IkOptions::default()).unwrap();
    assert_eq!(found.is_empty(), !alone.success);
    assert!(alone.success || alone.restarts < 60, "{alone:?}");
}

/// Of seven joints none is locked whose value the target decides, though its formulas be there: the
/// elbow of an arm with a shoulder that is no ball by less than half a millimetre, as that of the
/// iiwa14 in published files.
#[test]
fn an_elbow_is_not_held() {
    let at = |x: f64, z: f64| Vec3::new(x, 0.0, z);
    let aside = -0.000_436_24;
    let axes = [
        (Vec3::Z, at(0.0, 0.0)),
        (Vec3::Y, at(aside, 0.36)),
        (Vec3::Z, at(aside, 0.36)),
        (-Vec3::Y, at(0.0, 0.78)),
        (Vec3::Z, at(0.0, 0.78)),
        (Vec3::Y, at(0.0, 1.18)),
        (Vec3::Z, at(0.0, 1.18)),
    ];
    let limits = Limits { lower: -2.5, upper: 2.5, ..Limits::NONE };
    let robot = arm(&axes, Pose::IDENTITY, Pose::from_translation(at(0.0, 1.306)), limits);
    assert!(Analytic::with_locked(&robot, robot.tool(), &[3]).is_ok());
    let mut random = Random(83);
    let mut goal = || {
        [Goal::pose(
            robot.tool(),
            robot.state(&random.q(&robot)).unwrap().pose(robot.tool()).unwrap(),
        )]
    };
    let mut solver = Solver::new(&robot, &goal(), &IkOptions::default()).unwrap();
    assert!(solver.analytic().is_some_and(|a| a.locked() != [3]));
    let found: Vec<_> = (0..200).map(|_| solver.solve(&goal()).unwrap()).collect();
    assert!(found.iter().all(|f| f.success));
    let by_formulas = found.iter().filter(|f| f.found_by == FoundBy::Analytic).count();
    assert!(by_formulas > 150, "{by_formulas}");
}
