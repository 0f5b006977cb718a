//! Inverse kinematics of closed chains against closed forms: five-bar, 3-RPR, Stewart platform, Delta.

use std::f64::consts::{PI, TAU};

use cylindroid::closure::LoopClosureError;
use cylindroid::ik::{Goal, IkOptions, MissReason, Solution, Solver, Task, solve, solve_distinct};
use cylindroid::{Mechanism, Pose, ReferenceFrame, Rotation, Vec3, catalogue};

use crate::robots::{circles, five_bar, place, three_rpr};
use crate::support::Random;

const XY: Task = Task {
    components: [true, true, false, false, false, false],
    axes: ReferenceFrame::LocalWorldAligned,
};

fn at(x: f64, y: f64) -> Pose {
    Pose::from_translation(Vec3::new(x, y, 0.0))
}

/// All solutions, each with loops closed, at the target and within limits.
fn all(mechanism: &Mechanism, task: Task, target: Pose, count: usize) -> Vec<Solution> {
    let goal = Goal::frame(mechanism.reference(), task, target);
    let found = solve_distinct(mechanism, &[goal], &IkOptions::default(), count).unwrap();
    for solution in &found {
        let state = mechanism.state(&solution.q).unwrap();
        let error = LoopClosureError::of(&state).unwrap();
        assert!(error.is_closed(mechanism.reach()) && solution.success);
        assert!(mechanism.outside_limits(&solution.q).next().is_none());
        let error = task.error(state.pose(mechanism.reference()).unwrap(), target);
        assert!(error.linear.norm() < 1e-9 && error.angular.norm() < 1e-9, "{error:?}");
        assert!(solution.position_error <= 1e-9 && solution.reason.is_none());
    }
    found
}

/// Angles between -pi and pi.
fn wrapped(angle: f64) -> f64 {
    angle - TAU * (angle / TAU).round()
}

/// Two dyads: every point has two elbows on each side, or none.
#[test]
fn five_bar_has_four_working_modes() {
    let mechanism = five_bar();
    let (a, b, root) = ([0.0, 0.0], [2.0, 0.0], 2.0_f64.sqrt());
    let [q1, q5] = ["q1", "q5"].map(|name| place(&mechanism, name));
    let mut random = Random(4);
    let mut reached = [0; 2];
    for _ in 0..40 {
        let p = [random.within(-2.0, 3.0), random.within(-2.0, 2.5)];
        // Crank 2 and coupler 1 on one side, rocker 1 and rod sqrt 2 on the other.
        let (left, right) = (circles(a, 2.0, p, 1.0), circles(b, 1.0, p, root));
        let found = all(&mechanism, XY, at(p[0], p[1]), 20);
        let (Some(left), Some(right)) = (left, right) else {
            assert!(found.is_empty(), "{p:?} is out of reach");
            reached[0] += 1;
            continue;
        };
        reached[1] += 1;
        assert_eq!(found.len(), 4, "{p:?}");
        for elbow in left {
            for knee in right {
                // At home the crank is upright, the rocker too.
                let expected = [
                    elbow[1].atan2(elbow[0]) - 0.5 * PI,
                    (knee[1] - b[1]).atan2(knee[0] - b[0]) - 0.5 * PI,
                ];
                let fits = |s: &&Solution| {
                    let apart = [s.q[q1] - expected[0], s.q[q5] - expected[1]];
                    apart.iter().all(|x| wrapped(*x).abs() < 1e-7)
                };
                assert_eq!(found.iter().filter(fits).count(), 1, "{p:?} {expected:?}");
            }
        }
    }
    assert!(reached.iter().all(|n| *n > 5), "{reached:?}");
}

/// Of the working modes the one nearest to the posture comes first.
#[test]
fn a_posture_chooses_the_working_mode() {
    let mechanism = five_bar();
    let target = at(0.9, 1.1);
    let found = all(&mechanism, XY, target, 20);
    assert_eq!(found.len(), 4);
    for near in &found {
        let posture = near.q.iter().map(|x| x + 0.05).collect();
        let options = IkOptions { posture: Some(posture), ..IkOptions::default() };
        let goal = Goal::frame(mechanism.reference(), XY, target);
        let first = &solve_distinct(&mechanism, &[goal], &options, 20).unwrap()[0];
        let apart = first.q.iter().zip(&near.q).map(|(a, b)| (a - b).abs());
        assert!(apart.fold(0.0, f64::max) < 1e-7, "{:?} instead of {:?}", first.q, near.q);
    }
}

/// The legs of a 3-RPR are as long as the distance of their ends.
#[test]
fn legs_of_a_planar_platform() {
    let base = [[-1.0, -0.8], [1.2, -0.7], [0.1, 1.3]];
    let platform = [[-0.4, -0.2], [0.5, -0.3], [0.1, 0.4]];
    let mechanism = three_rpr(base, platform, "limits = { lower = -0.6, upper = 1.5 }");
    let mut random = Random(9);
    for _ in 0..15 {
        let (p, turn) =
            ([random.within(-0.4, 0.4), random.within(-0.4, 0.4)], random.within(-0.5, 0.5));
        let target = Pose { rotation: Rotation::about_z(turn), ..at(p[0], p[1]) };
        let found = all(&mechanism, Task::PLANAR, target, 8);
        assert_eq!(found.len(), 1);
        for i in 0..3 {
            let leg = place(&mechanism, &format!("leg{i}"));
            let [bx, by] = platform[i];
            let home = (bx - base[i][0]).hypot(by - base[i][1]);
            let end = target * Vec3::new(bx, by, 0.0);
            let length = (end.x - base[i][0]).hypot(end.y - base[i][1]);
            assert!((found[0].q[leg] - (length - home)).abs() < 1e-9);
        }
    }
}

/// Leg lengths of a Stewart platform, from the centres of its joints at home.
#[test]
fn legs_of_a_stewart_platform() {
    let mechanism = catalogue::load("stewart").unwrap();
    let home = mechanism.state(mechanism.home()).unwrap();
    let pose = |q: &[f64], frame: &str| {
        mechanism.state(q).unwrap().pose(mechanism.frame(frame).unwrap()).unwrap()
    };
    let reference = mechanism.reference();
    let mut random = Random(2);
    for _ in 0..6 {
        let turn = Rotation::exp(random.vec3(0.15));
        let target = Pose { rotation: turn, translation: Vec3::Z * 1.02 + random.vec3(0.05) };
        let found = all(&mechanism, Task::POSE, target, 1);
        assert_eq!(found.len(), 1);
        for i in 1..=6 {
            // The cylinder's frame is at its universal joint, the rod's at the slide: the ball of
            // home moves with the platform.
            let base =
                home.pose(mechanism.frame(&format!("cylinder{i}")).unwrap()).unwrap().translation;
            let ball = pose(mechanism.home(), &format!("rod{i}")).translation;
            let moved = target * (home.pose(reference).unwrap().inverse() * ball);
            let stretched = (moved - base).norm() - (ball - base).norm();
            let leg = place(&mechanism, &format!("leg{i}"));
            assert!(
                (found[0].q[leg] - stretched).abs() < 1e-9,
                "{stretched} {:?}",
                found[0].q[leg]
            );
        }
    }
}

/// A Delta's platform keeps its orientation; every arm has two elbows, of which limits leave one.
#[test]
fn arms_of_a_delta() {
    let mechanism = catalogue::load("delta").unwrap();
    let state = mechanism.state(mechanism.home()).unwrap();
    let home = state.pose(mechanism.reference()).unwrap();
    let at_home = |frame: &str| state.pose(mechanism.frame(frame).unwrap()).unwrap().translation;
    let arms = ["arm1", "arm2", "arm3"].map(|name| place(&mechanism, name));
    let mut random = Random(6);
    for _ in 0..4 {
        let target = Pose { translation: home.translation + random.vec3(0.06), ..home };
        let found = all(&mechanism, Task::POSITION, target, 1);
        assert_eq!(found.len(), 1);
        let state = mechanism.state(&found[0].q).unwrap();
        assert!(state.pose(mechanism.reference()).unwrap().rotation.angle_to(home.rotation) < 1e-9);
        for (k, arm) in arms.into_iter().enumerate() {
            // Arms 0.3 at radius 0.2, rods 0.5 to radius 0.05 of the platform: between the rods of a
            // pair.
            let angle = TAU / 3.0 * k as f64;
            let radial = Vec3::new(angle.cos(), angle.sin(), 0.0);
            let [one, two] = ["a", "b"].map(|rod| at_home(&format!("rod{}{rod}", k + 1)));
            let arm_at_home = (one + two) * 0.5 - radial * 0.2;
            assert!((arm_at_home.norm() - 0.3).abs() < 1e-9);
            let up = arm_at_home.z.atan2(arm_at_home.dot(radial)) - found[0].q[arm];
            let elbow = radial * (0.2 + 0.3 * up.cos()) + Vec3::Z * (0.3 * up.sin());
            let end = target.translation + radial * 0.05;
            assert!(((end - elbow).norm() - 0.5).abs() < 1e-9, "{k}: {}", (end - elbow).norm());
        }
    }
}

/// The nearest solution of the guess comes first, prescribed coordinates keep their values.
#[test]
fn guesses_and_fixed_coordinates() {
    let mechanism = five_bar();
    let goal = |x, y| [Goal::frame(mechanism.reference(), XY, at(x, y))];
    let modes = all(&mechanism, XY, at(0.9, 1.8), 4);
    for mode in &modes {
        let options = IkOptions {
            initial_guess: Some(mode.q.iter().map(|x| x + 0.01).collect()),
            nearest: true,
            ..IkOptions::default()
        };
        let found = solve(&mechanism, &goal(0.9, 1.8), &options).unwrap();
        assert!(found.q.iter().zip(&mode.q).all(|(a, b)| (a - b).abs() < 1e-6));
        // With the crank fixed there are two elbows less.
        let fixed = IkOptions {
            fixed: vec![place(&mechanism, "q1")],
            initial_guess: Some(mode.q.clone()),
            ..IkOptions::default()
        };
        let kept = solve_distinct(&mechanism, &goal(0.9, 1.8), &fixed, 9).unwrap();
        assert_eq!(kept.len(), 2);
        assert!(solve(&mechanism, &goal(0.9, 1.7), &fixed).unwrap().reason.is_some());
    }
}

/// Limits are named where they are the reason, also where they prove the target out of reach; inside of
/// the reach of each chain nothing is proven.
#[test]
fn misses_have_a_reason() {
    let base = [[-1.0, -0.8], [1.2, -0.7], [0.1, 1.3]];
    let platform = [[-0.4, -0.2], [0.5, -0.3], [0.1, 0.4]];
    let short = three_rpr(base, platform, "limits = { lower = -0.1, upper = 0.1 }");
    let goal = [Goal::frame(short.reference(), Task::PLANAR, at(0.5, 0.0))];
    let miss = solve(&short, &goal, &IkOptions::default()).unwrap();
    assert!(!miss.success && miss.position_error > 0.05);
    assert!(miss.out_of_reach.is_some_and(|(distance, length)| distance > length));
    let Some(MissReason::Limits { joints }) = &miss.reason else { panic!("{:?}", miss.reason) };
    assert!(joints.iter().any(|j| j == "leg0"), "{joints:?}");
    let state = short.state(&miss.q).unwrap();
    assert!(LoopClosureError::of(&state).unwrap().is_closed(short.reach()));

    let five_bar = five_bar();
    let goal = [Goal::frame(five_bar.reference(), XY, at(9.0, 0.0))];
    let miss = solve(&five_bar, &goal, &IkOptions::default()).unwrap();
    assert!(matches!(miss.reason, Some(MissReason::OutOfReach { .. })), "{:?}", miss.reason);
    // In the hole around the base of the crank.
    let goal = [Goal::frame(five_bar.reference(), XY, at(0.1, 0.1))];
    let miss = solve(&five_bar, &goal, &IkOptions::default()).unwrap();
    assert_eq!(miss.reason, Some(MissReason::NotProven));
}

/// One free rotation: the platform of a Stewart platform turns about its own axis, or the world's.
#[test]
fn one_component_may_be_free() {
    let mechanism = catalogue::load("stewart").unwrap();
    let tilt = Rotation::exp(Vec3::new(0.1, -0.05, 0.0));
    let target = Pose { rotation: tilt, translation: Vec3::new(0.02, 0.03, 1.05) };
    all(&mechanism, Task::POINTING, target, 1);
    let world = Task { axes: ReferenceFrame::LocalWorldAligned, ..Task::POINTING };
    assert_eq!(all(&mechanism, world, target, 1).len(), 1);
    let slide = Task { components: [true, false, true, true, true, true], ..Task::POSE };
    assert_eq!(all(&mechanism, slide, target, 1).len(), 1);
}

#[test]
fn goals_that_have_no_answer_are_refused() {
    let stewart = catalogue::load("stewart").unwrap();
    let frame = stewart.reference();
    let options = IkOptions::default();
    let refused = |goals: &[Goal]| solve(&stewart, goals, &options).unwrap_err().to_string();
    assert!(refused(&[]).contains("goals"));
    let pose = Goal::pose(frame, Pose::IDENTITY);
    assert!(refused(&[pose, pose]).contains("takes one frame"));
    assert!(refused(&[Goal::gaze(frame, Vec3::X)]).contains("takes one frame"));
    let one = Task { components: [true, true, true, true, false, false], ..Task::POSE };
    assert!(refused(&[Goal::frame(frame, one, Pose::IDENTITY)]).contains("two or none"));
    let error = Solver::new(&stewart, &[pose], &options).unwrap_err().to_string();
    assert!(error.contains("ik::solve"), "{error}");
    let other = catalogue::load("panda").unwrap().tool();
    assert!(solve(&stewart, &[Goal::pose(other, Pose::IDENTITY)], &options).is_err());
}

/// The joints of the tree that carry a frame are its longest reach, whatever the loops.
#[test]
fn targets_beyond_the_chain_of_a_frame_need_no_search() {
    let options = IkOptions::default();
    for name in ["five-bar", "delta", "3rrr"] {
        let mechanism = catalogue::load(name).unwrap();
        let home = mechanism.state(mechanism.home()).unwrap();
        let mut proven = 0;
        for frame in mechanism.frame_ids() {
            let at = home.pose(frame).unwrap();
            for task in [Task::POSE, XY, Task::POSITION, Task::POINTING] {
                let near = solve(&mechanism, &[Goal::frame(frame, task, at)], &options).unwrap();
                assert!(near.success && near.out_of_reach.is_none(), "{name}");
                let far = Pose { translation: at.translation + Vec3::X * 50.0, ..at };
                let goal = Goal::frame(frame, task, far);
                let missed = solve(&mechanism, &[goal], &options).unwrap();
                assert!(!missed.success, "{name}");
                let Some((distance, length)) = missed.out_of_reach else {
                    continue;
                };
                assert!(distance > length && distance > 40.0 && length < 10.0, "{name}");
                assert!(missed.restarts == 0 && missed.q.len() == mechanism.n());
                let proof = MissReason::OutOfReach { distance, length };
                let reason = missed.reason.unwrap();
                assert!(reason == proof || reason.name() == "limits", "{name}: {reason}");
                proven += 1;
            }
        }
        assert!(proven > 3, "{name}: {proven}");
    }
    // The legs of a Stewart platform are long enough without their limits alone.
    let stewart = catalogue::load("stewart").unwrap();
    let goal = Goal::frame(stewart.frame("rod5").unwrap(), Task::POSITION, at(3.0, 0.0));
    let missed = solve(&stewart, &[goal], &options).unwrap();
    assert!(missed.out_of_reach.is_some() && missed.restarts == 0 && !missed.success);
    // A slide in the plane: its height counts for nothing.
    let planar = catalogue::load("3rrr").unwrap();
    let frame = planar.reference();
    let mut at = planar.state(planar.home()).unwrap().pose(frame).unwrap();
    at.translation.z = 50.0;
    let goal = Goal::frame(frame, Task::POSITION, at);
    let found = solve(&planar, &[goal], &options).unwrap();
    assert!(found.reason.is_none_or(|reason| !matches!(reason, MissReason::OutOfReach { .. })));
}
