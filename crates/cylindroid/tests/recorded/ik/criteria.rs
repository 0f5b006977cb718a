//! Criteria along the self-motion: manipulability, distance from joint limits.

use cylindroid::catalogue;
use cylindroid::ik::{Criterion, Goal, HalfSpace, Task, solve, solve_distinct};

use super::arms::{general, seven, six};
use super::{note, note_all, options};
use crate::record::check;
use crate::robots::Random;

fn criterion(random: &mut Random<'_>, robot: &cylindroid::Mechanism) -> Criterion {
    let components = [Task::POSE, Task::POSITION, Task::ORIENTATION, Task::POINTING];
    let components = components[random.below(4)];
    match random.below(3) {
        0 => Criterion::LimitAvoidance { margin: random.within(0.05, 0.5) },
        1 => {
            let name = Criterion::NAMES[random.below(2)];
            Criterion::by_name(name, robot.tool(), components).unwrap()
        }
        _ => {
            let frame = robot.frame(&format!("l{}", robot.joints().len() - random.below(2)));
            let end_effector = frame.unwrap_or(robot.tool()).into();
            Criterion::Manipulability { end_effector, components }
        }
    }
}

fn ascents(name: &str, cases: u64, of: impl Fn(&mut Random<'_>, f64) -> cylindroid::Mechanism) {
    check(name, cases, |random, record| {
        let size = random.power(-1.0, 1.0);
        let robot = of(random, size);
        let state = robot.state(&random.configuration(&robot)).unwrap();
        let target = state.pose(robot.tool()).unwrap();
        let components = [Task::POSITION, Task::PLANAR, Task::POSE][random.below(3)];
        let mut options = options(random, &robot, size);
        options.criterion = Some(criterion(random, &robot));
        if random.once_in(6) {
            let normal = random.vec3(1.0);
            let end_effector = robot.frame("l2").unwrap_or(robot.tool()).into();
            let point = state.pose(end_effector).unwrap().translation;
            let name = "plane".to_owned();
            options.half_spaces = vec![HalfSpace { name, end_effector, point, normal }];
        }
        let goals = [Goal::frame(robot.tool(), components, target)];
        if random.once_in(3) {
            note_all(record, &solve_distinct(&robot, &goals, &options, 4).unwrap(), size);
        } else {
            note(record, &solve(&robot, &goals, &options).unwrap(), size);
        }
    });
}

#[test]
fn of_general_chains() {
    ascents("ik_criteria", 160, |random, size| {
        let n = 2 + random.below(6);
        let simple = !random.once_in(4);
        general(random, n, size, simple)
    });
}

#[test]
fn of_closed_forms() {
    ascents("ik_criteria_closed_forms", 90, |random, size| match random.below(3) {
        0 => six(random, size),
        1 => seven(random, size),
        _ => catalogue::load(["panda", "iiwa14", "ur5e"][random.below(3)]).unwrap(),
    });
}
