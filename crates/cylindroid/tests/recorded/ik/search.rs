//! The search: restarts, one by one and in batches, for all goals; half-spaces; reasons of misses.

use cylindroid::ik::{Goal, HalfSpace, IkOptions, Objective, Solver, Task, solve, solve_distinct};
use cylindroid::model::{JointKind, JointSpec, Limits, Mimic};
use cylindroid::{
    EndEffector, FrameId, Mechanism, Pose, ReferenceFrame, Rotation, State, Vec3, catalogue,
};

use super::arms::{general, seven, six};
use super::{beside, limits, note, note_all, note_result, options};
use crate::record::check;
use crate::robots::{Random, robot};

/// A frame of the mechanism, or a tool point beside it.
fn end_effector(random: &mut Random<'_>, robot: &Mechanism, size: f64) -> EndEffector {
    let frame = match random.below(3) {
        0 => robot.frame(&format!("l{}", 1 + random.below(2).min(robot.n() - 1))),
        _ => Ok(robot.tool()),
    };
    let mut end_effector: EndEffector = frame.unwrap_or(robot.tool()).into();
    if random.once_in(3) {
        end_effector.frame_from_tool = random.pose(0.3 * size);
    }
    end_effector
}

/// Some components, in the axes of the world or of the tool.
fn task(random: &mut Random<'_>) -> Task {
    let axes = [ReferenceFrame::Local, ReferenceFrame::LocalWorldAligned][random.below(2)];
    let named = [Task::POSE, Task::POSITION, Task::ORIENTATION, Task::POINTING, Task::PLANAR];
    let mut components = match random.below(6) {
        5 => std::array::from_fn(|_| random.once_in(2)),
        i => named[i].components,
    };
    if components == [false; 6] {
        components[random.below(6)] = true;
    }
    Task { components, axes }
}

/// A goal that a state reaches; in a few cases one beside it.
fn goal(random: &mut Random<'_>, state: &State, size: f64) -> Goal {
    let robot = state.mechanism();
    let own = end_effector(random, robot, size);
    let pose = state.pose(own).unwrap();
    let away = if random.once_in(4) { random.pose(0.5 * size) } else { Pose::IDENTITY };
    let objective = match random.below(8) {
        0 => {
            let reference = end_effector(random, robot, size);
            let target = state.pose(reference).unwrap().inverse() * pose * away;
            Objective::RelativeFrame {
                end_effector: own,
                reference,
                components: task(random),
                target,
            }
        }
        1 => {
            let axes = [[true; 3], [true, false, true], [false, true, false]][random.below(3)];
            let target = pose.translation * 0.5 + away.translation;
            Objective::CenterOfMass { axes, target }
        }
        2 => {
            let point = pose * away * (Vec3::Z * random.within(-size, 2.0 * size));
            Objective::Gaze { end_effector: own, point }
        }
        _ => {
            let target = pose * away;
            Objective::Frame { end_effector: own, components: task(random), target }
        }
    };
    let goal = Goal::from(objective);
    if random.once_in(2) { goal.with_weight(random.power(-1.0, 1.0)) } else { goal }
}

/// The same goal with another target.
fn moved(goal: &Goal, by: Pose) -> Goal {
    let mut goal = *goal;
    match &mut goal.objective {
        Objective::Frame { target, .. } | Objective::RelativeFrame { target, .. } => {
            *target = *target * by;
        }
        Objective::CenterOfMass { target: point, .. } | Objective::Gaze { point, .. } => {
            *point += by.translation;
        }
        _ => {}
    }
    goal
}

/// Trees of all joints of one coordinate, one to three goals; the same solver for targets that move.
#[test]
fn trees() {
    check("ik_trees", 260, |random, record| {
        let robot = robot(random, false);
        let state = robot.state(&random.configuration(&robot)).unwrap();
        let count = 1 + random.below(3);
        let goals: Vec<Goal> = (0..count).map(|_| goal(random, &state, 0.5)).collect();
        let mut options = options(random, &robot, 1.0);
        options.nearest = random.once_in(6);
        let mut solver = match Solver::new(&robot, &goals, &options) {
            Ok(solver) => solver,
            Err(error) => return record.word(&error.to_string()),
        };
        let found = solver.solve(&goals).unwrap();
        note(record, &found, 1.0);
        let by = random.pose(0.05);
        let mut next: Vec<Goal> = goals.iter().map(|goal| moved(goal, by)).collect();
        next[0].weight = random.power(-0.5, 0.5);
        solver.set_initial_guess(&found.q).unwrap();
        let found = solver.solve_distinct(&next, 2).unwrap();
        note_all(record, &found, 1.0);
    });
}

/// Chains of hinges and slides, whose restarts run in batches.
#[test]
fn chains() {
    check("ik_chains", 320, |random, record| {
        let (n, size) = (2 + random.below(12), random.power(-2.0, 2.0));
        let robot = general(random, n, size, true);
        let state = robot.state(&random.configuration(&robot)).unwrap();
        let target = state.pose(robot.tool()).unwrap();
        let components = if random.once_in(3) { task(random) } else { Task::POSE };
        let goal = Goal::frame(robot.tool(), components, target);
        let options = options(random, &robot, size);
        if random.once_in(3) {
            let found = solve_distinct(&robot, &[goal], &options, 2 + random.below(5)).unwrap();
            note_all(record, &found, size);
        } else {
            note(record, &solve(&robot, &[goal], &options).unwrap(), size);
        }
    });
}

/// Chains of six and seven hinges: the closed form first.
#[test]
fn closed_forms() {
    check("ik_closed_forms", 300, |random, record| {
        let size = random.power(-1.0, 1.0);
        let robot = if random.once_in(2) { six(random, size) } else { seven(random, size) };
        let mut q = random.configuration(&robot);
        if random.once_in(3) {
            q[random.below(robot.n())] = 0.0;
        }
        let mut target = robot.state(&q).unwrap().pose(robot.tool()).unwrap();
        if random.once_in(8) {
            target = target * random.pose(0.3 * size);
        }
        let mut options = options(random, &robot, size);
        options.budget.time = None;
        let goals = [Goal::pose(robot.tool(), target)];
        let mut solver = Solver::new(&robot, &goals, &options).unwrap();
        record.word(&solver.analytic().map(|a| a.locked().to_vec()));
        let count = random.below(12);
        if count > 1 {
            note_all(record, &solver.solve_distinct(&goals, count).unwrap(), size);
        } else {
            note(record, &solver.solve(&goals).unwrap(), size);
        }
    });
}

/// Ball joints, free bodies, planar and universal joints, screws.
#[test]
fn joints_of_several_coordinates() {
    check("ik_kinds", 240, |random, record| {
        let (n, size) = (1 + random.below(4), random.power(-1.0, 1.0));
        let robot = general(random, n, size, false);
        let q = random.configuration(&robot);
        let state = robot.state(&q).unwrap();
        let goals = [goal(random, &state, size)];
        let options = IkOptions { nearest: random.once_in(4), ..options(random, &robot, size) };
        note_result(record, solve(&robot, &goals, &options), size);
    });
}

/// A turntable that leads others by a ratio, and a screw: full turns that are back, and that are not.
fn geared(random: &mut Random<'_>) -> Mechanism {
    let mut builder = Mechanism::builder("geared");
    let ratio = [1.0, -1.0, 2.0, 0.5, 1.5][random.below(5)];
    let kinds = [JointKind::Revolute, JointKind::Revolute, JointKind::Helical { pitch: 0.05 }];
    for i in 0..4 {
        let leader = Mimic { joint: "q0".to_owned(), multiplier: ratio, offset: 0.3 };
        builder.joint(JointSpec {
            parent_from_joint: random.pose(0.4),
            axis: random.vec3(1.0),
            limits: limits(random),
            mimic: (i == 1).then_some(leader),
            ..JointSpec::new(
                &format!("q{i}"),
                if i == 1 { JointKind::Revolute } else { kinds[random.below(3)] },
                &format!("l{i}"),
                &format!("l{}", i + 1),
            )
        });
    }
    builder.frame("tip", "l4", random.pose(0.3)).tool("tip");
    builder.build().unwrap()
}

/// Distinct solutions up to full turns, and the nearest one.
#[test]
fn full_turns() {
    check("ik_full_turns", 160, |random, record| {
        let robot = geared(random);
        let state = robot.state(&random.configuration(&robot)).unwrap();
        let target = state.pose(robot.tool()).unwrap();
        let components = [Task::POSITION, Task::ORIENTATION][random.below(2)];
        let goals = [Goal::frame(robot.tool(), components, target)];
        let options = IkOptions { nearest: random.once_in(2), ..options(random, &robot, 0.5) };
        if options.nearest {
            note(record, &solve(&robot, &goals, &options).unwrap(), 1.0);
        }
        note_all(record, &solve_distinct(&robot, &goals, &options, 4).unwrap(), 1.0);
    });
}

/// Half-spaces through tool points of a configuration, or beside them.
fn half_spaces(random: &mut Random<'_>, state: &State, size: f64) -> Vec<HalfSpace> {
    let robot = state.mechanism();
    let count = 1 + random.below(2);
    let mut all: Vec<HalfSpace> = (0..count)
        .map(|i| {
            let end_effector = end_effector(random, robot, size);
            let normal = random.vec3(1.0);
            let inside = normal * (random.within(-0.1, 0.4) * size / normal.norm());
            let point = state.pose(end_effector).unwrap().translation - inside;
            HalfSpace { name: format!("plane {i}"), end_effector, point, normal }
        })
        .collect();
    if random.once_in(4) {
        let own: FrameId = robot.tool();
        let center = state.pose(own).unwrap() * random.pose(0.2 * size);
        let sides = Vec3::new(0.5, 0.3, 0.7) * size;
        all.extend(HalfSpace::inside_box("box", own.into(), center, sides));
    }
    all
}

#[test]
fn within_half_spaces() {
    check("ik_half_spaces", 260, |random, record| {
        let size = random.power(-1.0, 1.0);
        let robot = match random.below(3) {
            0 => seven(random, size),
            1 => six(random, size),
            _ => {
                let n = 3 + random.below(5);
                general(random, n, size, true)
            }
        };
        let q = random.configuration(&robot);
        let state = robot.state(&q).unwrap();
        let components = if random.once_in(2) { Task::POSE } else { task(random) };
        let goals = [Goal::frame(robot.tool(), components, state.pose(robot.tool()).unwrap())];
        let mut options = options(random, &robot, size);
        options.half_spaces = half_spaces(random, &state, size);
        options.nearest = random.once_in(3);
        options.fixed.clear();
        note_result(record, solve(&robot, &goals, &options), size);
    });
}

/// Targets beyond limits, beyond the chain and in no reach: the reasons.
#[test]
fn misses() {
    check("ik_misses", 240, |random, record| {
        let robot = match random.below(4) {
            0 => catalogue::load(["ur5e", "panda", "3r", "youbot"][random.below(4)]).unwrap(),
            1 => seven(random, 1.0),
            _ => {
                let n = 1 + random.below(7);
                general(random, n, 1.0, true)
            }
        };
        let wide = |_| random.within(-6.0, 6.0);
        let q: Vec<f64> = (0..robot.n()).map(wide).collect();
        let mut target = robot.state(&q).unwrap().pose(robot.tool()).unwrap();
        if random.once_in(3) {
            target.translation += random.vec3(3.0 * robot.reach());
        }
        let components = if random.once_in(2) { Task::POSE } else { task(random) };
        let goals = [Goal::frame(robot.tool(), components, target)];
        let mut options = options(random, &robot, 1.0);
        options.budget.iterations = options.budget.iterations.min(120);
        let found = solve(&robot, &goals, &options).unwrap();
        note(record, &found, 1.0);
        if random.once_in(8) {
            record.word(&found.reason.map(|reason| reason.to_string()));
        }
    });
}

/// Lengths about that of the chain, at which the proof that a target is out of reach begins.
#[test]
fn the_length_of_chains() {
    check("ik_reach", 100, |random, record| {
        let (n, size) = (1 + random.below(4), random.power(-2.0, 2.0));
        let robot = general(random, n, size, n % 2 == 0);
        let state = robot.state(&random.configuration(&robot)).unwrap();
        let pose = state.pose(robot.tool()).unwrap();
        let far = random.vec3(1.0) * (random.power(-1.0, 1.5) * size);
        let mut goal = Goal::frame(robot.tool(), task(random), Pose { translation: far, ..pose });
        let mut options = IkOptions { length: None, ..options(random, &robot, size) };
        let mut robot = robot;
        if random.once_in(4) {
            // Straight, turned about an axis that no joint has: as far as the chain is long.
            robot = catalogue::load("3r").unwrap();
            let straight = [random.within(-3.0, 3.0), 0.0, 0.0];
            let pose = robot.state(&straight).unwrap().pose(robot.tool()).unwrap();
            let shorter = pose.translation * random.power(-13.0, -9.0);
            let away = if random.once_in(2) { shorter } else { -shorter };
            let rotation = Rotation::exp(Vec3::X * 0.5) * pose.rotation;
            let target = Pose { rotation, translation: pose.translation + away };
            goal = Goal::pose(robot.tool(), target);
            (options.initial_guess, options.fixed) = (None, Vec::new());
        }
        let found = solve(&robot, &[goal], &options).unwrap();
        let way = found.out_of_reach.map(|(distance, length)| [distance / size, length / size]);
        record.word(&(found.success, way.is_some()));
        record.numbers(&way.unwrap_or_default());
        record.word(&found.restarts);
    });
}

/// A guess near the target, with wide tolerances: the steps one by one.
#[test]
fn few_steps() {
    check("ik_few_steps", 300, |random, record| {
        let (n, size) = (1 + random.below(9), random.power(-2.0, 2.0));
        let simple = !random.once_in(3);
        let robot = general(random, n, size, simple);
        let q = random.configuration(&robot);
        let far = random.power(-2.0, 0.3);
        let start = beside(random, &robot, &q, far);
        let state = robot.state(&q).unwrap();
        let count = 1 + random.below(2);
        let goals: Vec<Goal> = (0..count).map(|_| goal(random, &state, size)).collect();
        let mut options = options(random, &robot, size);
        options.initial_guess = Some(start);
        note_result(record, solve(&robot, &goals, &options), size);
    });
}

/// Slides of wide ranges, a wheel, and joints that move no goal.
#[test]
fn wide_ranges() {
    check("ik_wide_ranges", 80, |random, record| {
        let mut builder = Mechanism::builder("wide");
        for i in 0..4 {
            let kind = [JointKind::Prismatic, JointKind::Revolute][random.below(2)];
            let half = [0.5, 400.0, 600.0, 1e6][random.below(4)];
            let own = Limits { lower: -half, upper: half, ..Limits::NONE };
            let at = random.pose(0.5);
            builder.joint(JointSpec {
                parent_from_joint: at,
                axis: random.vec3(1.0),
                limits: own,
                ..JointSpec::new(&format!("q{i}"), kind, &format!("l{i}"), &format!("l{}", i + 1))
            });
        }
        builder.joint(JointSpec {
            limits: limits(random),
            ..JointSpec::new("other", JointKind::Revolute, "l1", "side")
        });
        builder.frame("tip", "l4", random.pose(0.3)).tool("tip");
        let robot = builder.build().unwrap();
        let q = random.configuration(&robot);
        let target = robot.state(&q).unwrap().pose(robot.tool()).unwrap();
        let goals = [Goal::frame(robot.tool(), task(random), target)];
        let mut options = options(random, &robot, 1.0);
        options.posture = random.once_in(3).then(|| random.configuration(&robot));
        note_all(record, &solve_distinct(&robot, &goals, &options, 3).unwrap(), 1.0);
        note(record, &solve(&robot, &goals, &options).unwrap(), 1.0);
    });
}
