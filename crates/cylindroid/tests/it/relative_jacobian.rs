//! Jacobians of frames relative to others that move.

use cylindroid::spatial::log;
use cylindroid::{EndEffector, ReferenceFrame, catalogue};

use crate::kinematics::{end_effector, moved, robots, unit};
use crate::support::{Random, assert_close, assert_matrix};

/// The derivative of base_from_tool, at the tool's origin in the axes of the base; the ordinary
/// Jacobian from a base at rest.
#[test]
fn by_finite_differences() {
    let (mut random, h) = (Random(33), 1e-5);
    for robot in robots() {
        let ids: Vec<_> = robot.frame_ids().collect();
        for _ in 0..5 {
            let tool = end_effector(&robot, &mut random);
            let frame = ids[(random.next_u64() % ids.len() as u64) as usize];
            let base = EndEffector { frame, frame_from_tool: random.pose() };
            let q = random.q(&robot);
            let seen = |q: &[f64]| {
                let state = robot.state(q).unwrap();
                state.pose(base).unwrap().inverse() * state.pose(tool).unwrap()
            };
            let (state, pose) = (robot.state(&q).unwrap(), seen(&q));
            let found = state.relative_jacobian(tool, base).unwrap();
            for k in 0..robot.n() {
                let at =
                    |h: f64| log(seen(&moved(&robot, &q, &unit(robot.n(), k), h)) * pose.inverse());
                let expected = ((at(h) - at(-h)) * (0.5 / h)).at_point(pose.translation);
                let what = format!("{} column {k}", robot.name());
                let scale = 1e-9 * (1.0 + robot.reach());
                assert_close(&what, found.column(k), &expected.to_array(), scale);
            }
            // Relative to itself nothing moves, exactly.
            let own = state.relative_jacobian(tool, robot.tool()).unwrap();
            assert!(own.as_slice().iter().all(|x| *x == 0.0), "{}", robot.name());
        }
    }
    // In a serial arm exactly zero for the joints that carry both.
    for arm in ["panda", "ur5e", "youbot", "3r"].map(|name| catalogue::load(name).unwrap()) {
        let state = arm.state(&random.q(&arm)).unwrap();
        for base in arm.frame_ids() {
            let carried = state.jacobian(base, ReferenceFrame::World).unwrap();
            let found = state.relative_jacobian(arm.tool(), base).unwrap();
            for k in 0..arm.n() {
                let is_carried = carried.column(k).iter().any(|x| *x != 0.0);
                let moves = found.column(k).iter().any(|x| *x != 0.0);
                assert!(is_carried != moves, "{} {base:?} column {k}", arm.name());
            }
        }
    }
    let arm = catalogue::load("ur5e").unwrap();
    let state = arm.state(arm.home()).unwrap();
    let root = arm.frame(&arm.links()[0].name).unwrap();
    let from_root = state.relative_jacobian(arm.tool(), root).unwrap();
    let expected = state.jacobian(arm.tool(), ReferenceFrame::LocalWorldAligned).unwrap();
    assert_matrix("from the root", &from_root, &expected, 1e-15);
}
