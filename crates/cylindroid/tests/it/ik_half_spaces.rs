//! Inverse kinematics inside of half-spaces and boxes.

use cylindroid::ik::{Goal, HalfSpace, IkOptions, MissReason, Solver, Task, solve};
use cylindroid::model::Mechanism;
use cylindroid::{EndEffector, Pose, Vec3, catalogue};

use crate::servo::two_armed;
use crate::support::Random;

fn plane(name: &str, end_effector: impl Into<EndEffector>, point: Vec3, normal: Vec3) -> HalfSpace {
    HalfSpace { name: name.to_owned(), end_effector: end_effector.into(), point, normal }
}

/// The least distance inside (m).
fn room(robot: &Mechanism, half_spaces: &[HalfSpace], q: &[f64]) -> f64 {
    let state = robot.state(q).unwrap();
    let rooms = half_spaces.iter().map(|h| {
        let inwards = h.normal * h.normal.norm().recip();
        inwards.dot(state.pose(h.end_effector).unwrap().translation - h.point)
    });
    rooms.fold(f64::INFINITY, f64::min)
}

/// The elbow of a panda on one side of a plane, on which it is not without: reached wherever a known
/// configuration reaches it, in closed form and by the iteration.
#[test]
fn solutions_lie_inside() {
    let panda = catalogue::load("panda").unwrap();
    let (elbow, tool) = (panda.frame("link4").unwrap(), panda.tool());
    let mut random = Random(3);
    let (mut outside, mut total) = (0, 0);
    for task in [Task::POSE, Task::POSITION] {
        for _ in 0..60 {
            let q = random.q(&panda);
            let state = panda.state(&q).unwrap();
            let normal = random.vec3(1.0);
            let inside = state.pose(elbow).unwrap().translation - normal * (0.02 / normal.norm());
            let half_spaces = vec![plane("elbow", elbow, inside, normal)];
            let goals = [Goal::frame(tool, task, state.pose(tool).unwrap())];
            let free = solve(&panda, &goals, &IkOptions::default()).unwrap();
            outside += usize::from(room(&panda, &half_spaces, &free.q) < 0.0);
            let options = IkOptions { half_spaces, ..IkOptions::default() };
            let found = solve(&panda, &goals, &options).unwrap();
            assert!(found.success, "{found:?}");
            assert!(room(&panda, &options.half_spaces, &found.q) >= -options.position_tolerance);
            assert!(found.position_error <= options.position_tolerance);
            assert_eq!(panda.outside_limits(&found.q).next(), None);
            total += 1;
        }
    }
    assert!(10 * outside > total, "{outside} of {total} are outside without half-spaces");
}

/// Of six joints all solutions are known: of those the ones inside remain.
#[test]
fn closed_forms_are_filtered() {
    let ur5e = catalogue::load("ur5e").unwrap();
    let elbow = ur5e.frame("link3").unwrap();
    let target = ur5e.state(&[0.3, -1.1, 1.4, 0.2, 1.0, 0.4]).unwrap().pose(ur5e.tool()).unwrap();
    let goals = [Goal::pose(ur5e.tool(), target)];
    let mut all = Solver::new(&ur5e, &goals, &IkOptions::default()).unwrap();
    let all = all.solve_distinct(&goals, 8).unwrap();
    let half_spaces = vec![plane("table", elbow, Vec3::Z * 0.3, Vec3::Z)];
    let expected = all.iter().filter(|s| room(&ur5e, &half_spaces, &s.q) >= 0.0).count();
    assert!(all.len() == 8 && expected > 0 && expected < 8, "{expected} of {}", all.len());
    let options = IkOptions { half_spaces, ..IkOptions::default() };
    let mut solver = Solver::new(&ur5e, &goals, &options).unwrap();
    assert_eq!(solver.solve_distinct(&goals, 8).unwrap().len(), expected);
}

/// A box about a hand, whose goal is only a height; the other arm stays in a half-space, too.
#[test]
fn boxes_hold_hands() {
    let robot = two_armed();
    let [left, right] = ["left_6_link", "right_6_link"].map(|name| robot.frame(name).unwrap());
    let mut random = Random(5);
    for _ in 0..20 {
        let q: Vec<f64> = (0..robot.n()).map(|_| random.within(-1.2, 1.2)).collect();
        let state = robot.state(&q).unwrap();
        let height = Task::named("z", &robot).unwrap();
        let goals = [Goal::frame(left, height, state.pose(left).unwrap())];
        let center = Pose { rotation: random.rotation(), ..state.pose(left).unwrap() };
        let mut half_spaces =
            HalfSpace::inside_box("box", left.into(), center, Vec3::new(0.2, 0.1, 0.3)).to_vec();
        half_spaces.push(plane("right", right, state.pose(right).unwrap().translation, Vec3::Y));
        let options = IkOptions { half_spaces, ..IkOptions::default() };
        let found = solve(&robot, &goals, &options).unwrap();
        assert!(found.success, "{found:?}");
        assert!(room(&robot, &options.half_spaces, &found.q) >= -options.position_tolerance);
    }
}

/// The closest solution inside is at the boundary where the closest one is outside, and no farther
/// than any of 60 others.
#[test]
fn closest_solutions_inside() {
    let panda = catalogue::load("panda").unwrap();
    let elbow = panda.frame("link4").unwrap();
    let mut random = Random(14);
    let (mut outside, mut farther, mut total) = (0, 0, 0);
    for _ in 0..30 {
        let q = random.q(&panda);
        let state = panda.state(&q).unwrap();
        let goals = [Goal::pose(panda.tool(), state.pose(panda.tool()).unwrap())];
        let normal = random.vec3(1.0);
        let half_spaces =
            vec![plane("elbow", elbow, state.pose(elbow).unwrap().translation, normal)];
        let start = random.q(&panda);
        let options =
            IkOptions { nearest: true, initial_guess: Some(start.clone()), ..IkOptions::default() };
        let far = |q: &[f64]| {
            let squares = q.iter().zip(&start).map(|(a, b)| (a - b) * (a - b));
            squares.sum::<f64>().sqrt()
        };
        let free = solve(&panda, &goals, &options).unwrap();
        let is_inside = room(&panda, &half_spaces, &free.q) >= 0.0;
        let options = IkOptions { half_spaces, ..options };
        let found = solve(&panda, &goals, &options).unwrap();
        assert!(found.success, "{found:?}");
        if is_inside {
            assert!(far(&found.q) < far(&free.q) + 1e-3, "{found:?} {free:?}");
        } else {
            outside += 1;
        }
        let mut solver = Solver::new(&panda, &goals, &options).unwrap();
        let others = solver.solve_distinct(&goals, 60).unwrap();
        let best = others.iter().map(|s| far(&s.q)).fold(f64::INFINITY, f64::min);
        farther += usize::from(far(&found.q) > best + 1e-3);
        total += 1;
    }
    println!("{outside} of {total} at the boundary, {farther} farther");
    assert!(4 * outside > total, "{outside} of {total}");
    assert!(farther == 0, "{farther} of {total}");
}

#[test]
fn misses_name_the_half_space() {
    let panda = catalogue::load("panda").unwrap();
    let hand = panda.state(panda.home()).unwrap().pose(panda.tool()).unwrap();
    let goals = [Goal::pose(panda.tool(), hand)];
    let wall = plane("wall", panda.tool(), hand.translation + Vec3::X * 0.05, Vec3::X);
    let floor = plane("floor", panda.tool(), Vec3::ZERO, Vec3::Z);
    let options = IkOptions { half_spaces: vec![floor, wall], ..IkOptions::default() };
    let found = solve(&panda, &goals, &options).unwrap();
    let reason = found.reason.clone().unwrap();
    assert_eq!(reason, MissReason::HalfSpaces { names: vec!["wall".to_owned()] });
    assert_eq!(reason.name(), "half-space");
    assert!(reason.to_string().contains("wall"), "{reason}");
    assert!(!found.success && found.position_error > 0.01, "{found:?}");
    // Far away, distance comes first.
    let far = Goal::pose(panda.tool(), Pose::from_translation(Vec3::X * 9.0));
    let found = solve(&panda, &[far], &options).unwrap();
    assert!(matches!(found.reason, Some(MissReason::OutOfReach { .. })), "{found:?}");
    // A target on the boundary is inside.
    let wall = plane("wall", panda.tool(), hand.translation, Vec3::X);
    let options = IkOptions { half_spaces: vec![wall], ..IkOptions::default() };
    assert!(solve(&panda, &goals, &options).unwrap().success);
    let none = plane("flat", panda.tool(), Vec3::ZERO, Vec3::ZERO);
    let options = IkOptions { half_spaces: vec![none], ..IkOptions::default() };
    let error = solve(&panda, &goals, &options).unwrap_err().to_string();
    assert!(error.contains("flat"), "{error}");
}
