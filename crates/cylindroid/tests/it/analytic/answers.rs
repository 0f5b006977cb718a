//! All answers there are: of published arms and of every structure, whatever the frames, within
//! limits.

use std::f64::consts::{PI, TAU};

use cylindroid::ik::{Analytic, AnalyticSolution, Goal, IkOptions, solve_distinct};
use cylindroid::model::Limits;
use cylindroid::{Mechanism, Pose, Vec3, catalogue};

use super::arms::{STRUCTURES, arm, published, random_arm, unit, ur};
use super::law::{apart, condition, confirm, known_postures_are_found};
use crate::support::Random;

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
        assert!(ik.geometry().to_string() == name && ik.is_exact(), "{}", ik.geometry());
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
            assert!(ik.geometry().to_string() == name && ik.is_exact(), "{} {name}", ik.geometry());
            known_postures_are_found(&robot, &mut random, 100);
        }
    }
}

/// Nor does the unit of length, for arms with three parallel axes.
#[test]
fn units_change_nothing() {
    let mut random = Random(74);
    for k in 0..6 {
        let (mut axes, mut tool) = ur([-0.425, -0.392_25], [0.089_159, 0.109_15, 0.094_65, 0.0823]);
        if k > 0 {
            axes = std::array::from_fn(|_| (unit(&mut random), random.vec3(0.5)));
            (axes[2].0, axes[3].0) = (axes[1].0, -axes[1].0);
            tool = random.pose();
        }
        let arms = [1.0, 1e-6, 1e6].map(|scale| {
            let axes = axes.map(|(direction, point)| (direction, point * scale));
            let tool = Pose { translation: tool.translation * scale, ..tool };
            arm(&axes, Pose::IDENTITY, tool, Limits::NONE)
        });
        for _ in 0..20 {
            let (q, start) = (random.vector(6), random.vector(6));
            let [own, others @ ..] = arms.each_ref().map(|robot| {
                let target = robot.state(&q).unwrap().pose(robot.tool()).unwrap();
                let mut ik = Analytic::of(robot, robot.tool()).unwrap();
                let answers = ik.solve(target, &start).unwrap();
                confirm(robot, target, &answers);
                answers
            });
            for answers in others {
                assert_eq!(answers.len(), own.len(), "{k} {q:?}");
                for answer in answers.iter() {
                    let near =
                        own.iter().any(|a| apart(&a.q, &answer.q) < 1e-5 && a.free == answer.free);
                    assert!(near, "{k} {q:?}: {answer:?}");
                }
            }
        }
    }
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
                    .pose(robot.frame(&format!("l{}", i + 1)).unwrap())
                    .unwrap();
                (pose.rotation * robot.joints()[i].axis, pose.translation)
            })
            .collect();
        let plain = arm(&axes, Pose::IDENTITY, Pose::IDENTITY, Limits::NONE);
        let (base, tool) = (random.pose(), random.pose());
        let moved = arm(&axes, base, tool, Limits::NONE);
        let structure = |robot: &Mechanism| Analytic::of(robot, robot.tool()).unwrap().geometry();
        assert_eq!(structure(&plain), structure(&moved));
        let q: Vec<f64> = random.vector(6);
        let solve = |robot: &Mechanism| {
            let target = robot.state(&q).unwrap().pose(robot.tool()).unwrap();
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
            let target = robot.state(&q).unwrap().pose(robot.tool()).unwrap();
            let goal = Goal::pose(robot.tool(), target);
            let answers = ik.solve(target, &q).unwrap();
            confirm(&robot, target, &answers);
            // Beside singular configurations a search takes many for answers.
            if answers.iter().any(|a| condition(&robot, &a.q) < 3e-3) {
                continue;
            }
            compared += 1;
            let options = IkOptions {
                position_tolerance: 1e-9,
                orientation_tolerance: 1e-9,
                ..IkOptions::default()
            };
            let found = solve_distinct(&robot, &[goal, goal], &options, 20).unwrap();
            assert_eq!(found.len(), answers.len(), "{}", ik.geometry());
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
            let target = robot.state(&q).unwrap().pose(robot.tool()).unwrap();
            let start: Vec<f64> = random.vector(6).iter().map(|x| 8.0 * x).collect();
            let answers = ik.solve(target, &start).unwrap();
            confirm(&robot, target, &answers);
            // A wrist at a limit of two turns is straight, and the known configuration one of many.
            let found = answers.iter().any(|a| apart(&a.q, &q) < 1e-6 || a.free != [false; 6]);
            assert!(found, "{q:?} {answers:?}");
            for answer in answers.iter() {
                assert_eq!(robot.outside_limits(&answer.q).next(), None);
                let all = ik.with_full_turns(answer);
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
    let answer = AnalyticSolution {
        q: [0.3, -1.1, 1.4, 0.2, 1.0, 0.4],
        free: [false; 6],
        position_error: 0.0,
        orientation_error: 0.0,
    };
    assert_eq!(ik.with_full_turns(&answer).len(), 32);
}
