//! Working modes of closed chains.

use cylindroid::closure::assemble;
use cylindroid::ik::{Budget, Goal, IkOptions, MissReason, Solution, Task, solve, solve_distinct};
use cylindroid::model::JointLimits;
use cylindroid::{Mechanism, ReferenceFrame, catalogue};

use super::sum;
use crate::record::{Record, check};
use crate::robots::{Random, five_bar, spatial_loop};

/// Limits about home for some joints of one coordinate.
fn limited(random: &mut Random<'_>, robot: Mechanism) -> Mechanism {
    let mut all = Vec::new();
    for (x, c) in robot.home().iter().zip(robot.coordinates()) {
        if !random.once_in(3) {
            continue;
        }
        let (lower, upper) = (x - random.power(-1.5, 0.5), x + random.power(-1.5, 0.5));
        let (lower, upper) = (lower.max(c.limits.lower), upper.min(c.limits.upper));
        let own = JointLimits { lower: Some(lower), upper: Some(upper), ..JointLimits::default() };
        all.push((c.name.clone(), own));
    }
    let narrow = robot.with_limits(&all);
    narrow.unwrap_or(robot)
}

fn task(random: &mut Random<'_>) -> Task {
    let components = match random.below(9) {
        0 => [true, true, true, false, true, true],
        1 => [true, true, true, true, false, true],
        2 => [true, true, false, true, true, false],
        3 => [true, false, true, false, false, false],
        4 => [false, false, false, true, true, true],
        5 => [true, true, false, false, false, true],
        6 => [true, true, true, false, false, true],
        7 => [true; 6],
        _ => [true, true, true, false, false, false],
    };
    let axes = [ReferenceFrame::Local, ReferenceFrame::LocalWorldAligned][random.below(2)];
    Task { components, axes }
}

/// Errors before configurations, and the steps, which depend on rounding, at last.
fn note_mode(record: &mut Record, found: &Solution) {
    let name = found.reason.as_ref().map_or("mode", MissReason::name);
    record.word(&name);
    record.word(&found.restarts);
    if let Some(MissReason::Limits { joints }) = &found.reason {
        record.word(&joints.concat());
    }
    record.numbers(&[found.position_error + 0.3 * found.orientation_error, sum(&found.q)]);
    record.word(&found.iterations);
}

fn modes(
    (name, cases): (&str, u64),
    budget: [usize; 4],
    of: impl Fn(&mut Random<'_>) -> Mechanism,
) {
    check(name, cases, |random, record| {
        let robot = of(random);
        let narrow = if random.once_in(2) { limited(random, robot.clone()) } else { robot.clone() };
        // An assembly beside home, moved a little in a few cases.
        let near: Vec<f64> = robot.home().iter().map(|x| x + random.within(-0.4, 0.4)).collect();
        let assembly = assemble(&robot, &near, &[]).unwrap();
        let frame = robot.reference();
        let mut target = robot.state(&assembly.q).unwrap().pose(frame).unwrap();
        if random.once_in(4) {
            target = target * random.pose(0.1);
        }
        let goals = [Goal::frame(frame, task(random), target)];
        let home = robot.home();
        let options = IkOptions {
            nearest: random.once_in(4),
            position_tolerance: random.power(-9.0, -4.0),
            orientation_tolerance: random.power(-9.0, -4.0),
            posture: random
                .once_in(4)
                .then(|| home.iter().map(|x| x + random.within(-1.0, 1.0)).collect()),
            fixed: if random.once_in(5) { vec![random.below(robot.n())] } else { Vec::new() },
            initial_guess: random.once_in(2).then_some(near),
            seed: random.below(100) as u64,
            budget: Budget { iterations: budget[random.below(4)], time: None },
            ..IkOptions::default()
        };
        match random.below(3) {
            0 => match solve_distinct(&narrow, &goals, &options, 1 + random.below(5)) {
                Ok(found) => found.iter().for_each(|one| note_mode(record, one)),
                Err(error) => record.word(&error.to_string().split('=').next()),
            },
            _ => match solve(&narrow, &goals, &options) {
                Ok(found) => note_mode(record, &found),
                Err(error) => record.word(&error.to_string().split('=').next()),
            },
        }
    });
}

#[test]
fn of_five_bars() {
    modes(("ik_five_bars", 120), [100, 1000, 1700, 3000], five_bar);
}

#[test]
fn of_spatial_loops() {
    modes(("ik_spatial_loops", 40), [100, 300, 500, 900], spatial_loop);
}

#[test]
fn of_the_catalogue() {
    modes(("ik_closed_catalogue", 60), [100, 300, 500, 1100], |random| {
        let names = ["3rrr", "five-bar", "four-bar", "watt"];
        catalogue::load(names[random.below(4)]).unwrap()
    });
}

#[test]
fn of_spatial_platforms() {
    modes(("ik_spatial_platforms", 16), [100, 100, 200, 300], |random| {
        catalogue::load(["3rps", "delta", "stewart"][random.below(3)]).unwrap()
    });
}
