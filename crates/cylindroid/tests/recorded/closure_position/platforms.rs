//! Inverse kinematics of closed chains: assemblies with the components of a pose prescribed.

use cylindroid::closure::assemble;
use cylindroid::ik::{Budget, Goal, IkOptions, Solution, Task, solve, solve_distinct};
use cylindroid::spatial::Rotation;
use cylindroid::{EndEffector, Mechanism, Pose, ReferenceFrame, Vec3};

use super::{near_home, record_error, some_chain, weighted};
use crate::record::{Record, check};
use crate::robots::Random;

fn record_solution(record: &mut Record, found: &Solution) {
    record.word(&(found.success, found.restarts));
    record.word(&found.reason);
    record.numbers(&[found.position_error, found.orientation_error]);
    record.number(weighted(&found.q));
    record.word(&found.iterations);
}

fn task(random: &mut Random<'_>) -> Task {
    let axes = [ReferenceFrame::Local, ReferenceFrame::LocalWorldAligned][random.below(2)];
    let all = [true, true, true];
    let rotations = [
        all,
        all,
        [false; 3],
        [false, true, true],
        [true, false, true],
        [true, true, false],
        [true, false, false],
        [false, false, true],
    ];
    let slides = [all, [true, true, false], [false, true, true], [false; 3]];
    let ([x, y, z], [rx, ry, rz]) = (slides[random.below(4)], rotations[random.below(8)]);
    Task { components: [x, y, z, rx, ry, rz], axes }
}

/// The pose of the tool at an assembly near home, or another one nearby.
fn target(random: &mut Random<'_>, mechanism: &Mechanism, tool: EndEffector) -> Pose {
    let guess = near_home(random, mechanism, -0.3);
    let reached = !random.once_in(4);
    let found = assemble(mechanism, &guess, &[]).ok().filter(|found| found.closed && reached);
    let q = found.map_or_else(|| mechanism.home().to_vec(), |found| found.q);
    let here = mechanism.state(&q).unwrap().pose(tool.frame).unwrap() * tool.frame_from_tool;
    if reached {
        return here;
    }
    let size = random.power(-3.0, -0.3);
    let turn = Rotation::exp(random.vec3(size));
    Pose {
        rotation: turn * here.rotation,
        translation: here.translation + random.vec3(size * mechanism.reach()),
    }
}

#[test]
fn inverse_kinematics_of_platforms() {
    check("position_platforms", 50, |random, record| {
        let mechanism = some_chain(random);
        let frame_from_tool = if random.once_in(2) {
            Pose::IDENTITY
        } else {
            Pose { translation: Vec3::X * 0.1, ..random.pose(0.0) }
        };
        let tool = EndEffector { frame: mechanism.reference(), frame_from_tool };
        let target = target(random, &mechanism, tool);
        let goal = [Goal::frame(tool, task(random), target)];
        let options = IkOptions {
            seed: random.below(100) as u64,
            budget: Budget { iterations: 200 * (1 + random.below(4)), time: None },
            ..IkOptions::default()
        };
        if random.once_in(2) {
            match solve(&mechanism, &goal, &options) {
                Ok(found) => record_solution(record, &found),
                Err(error) => record_error(record, &error),
            }
            return;
        }
        match solve_distinct(&mechanism, &goal, &options, 4) {
            Ok(found) => {
                record.word(&found.len());
                found.iter().for_each(|one| record_solution(record, one));
            }
            Err(error) => record_error(record, &error),
        }
    });
}
