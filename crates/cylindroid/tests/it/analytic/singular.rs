//! Singular poses, poses out of reach, and axes that almost have a structure.

use std::f64::consts::{FRAC_PI_2, PI};

use cylindroid::ik::{Analytic, NotSolvable};
use cylindroid::model::Limits;
use cylindroid::{Pose, Vec3};

use super::arms::{arm, published, table, unit};
use super::law::{apart, condition, confirm};
use crate::support::Random;

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
            let target = robot.state(&q).unwrap().pose(robot.tool()).unwrap();
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
        let target = robot.state(&q).unwrap().pose(robot.tool()).unwrap();
        let answers = ik.solve(target, &[0.0; 6]).unwrap();
        assert!(answers.iter().all(|a| a.free == [false; 6]));
        assert!(answers.iter().any(|a| apart(&a.q, &q) < 1e-9), "{answers:?}");
    }
}

/// A wrist above the shoulder: the first joint is free. A stretched elbow: two solutions coincide.
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
        let target = robot.state(&q).unwrap().pose(robot.tool()).unwrap();
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
        let target = robot.state(&q).unwrap().pose(robot.tool()).unwrap();
        let answers = ik.solve(target, &start).unwrap();
        confirm(&robot, target, &answers);
        assert!(answers.iter().any(|a| apart(&a.q, &q) < 1e-5), "{q:?} {answers:?}");
    }
    let ur = &published()[0];
    let mut ik = Analytic::of(ur, ur.tool()).unwrap();
    for (place, value) in [(2, 0.0), (2, 1e-9), (2, PI), (4, PI)] {
        let mut q = [0.3, -1.0, 1.2, 0.4, 0.5, 0.6];
        q[place] = value;
        let target = ur.state(&q).unwrap().pose(ur.tool()).unwrap();
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
        let mut target = robot.state(&[0.1; 6]).unwrap().pose(robot.tool()).unwrap();
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
            let target = robot.state(&q).unwrap().pose(robot.tool()).unwrap();
            let answers = ik.solve(target, &q).unwrap();
            confirm(&robot, target, &answers);
            let found = answers.iter().any(|a| apart(&a.q, &q) < 1e-7);
            assert!(found || condition(&robot, &q) < 2e-2, "{q:?} {answers:?}");
        }
    }
    let (axes, tool) = puma(1e-3);
    let robot = arm(&axes, Pose::IDENTITY, tool, Limits::NONE);
    let why = Analytic::of(&robot, robot.tool()).unwrap_err();
    assert_eq!(why, NotSolvable::Axes);
    assert!(why.to_string().contains("neither"), "{why}");
}
