//! The inverse of one Jacobian, by method, projection and length.

use super::*;
use cylindroid::control::{InverseChoice, InverseSelection, TaskProjection};
use cylindroid::{Matrix, inverse};

const FRAMES: [ReferenceFrame; 3] =
    [ReferenceFrame::Local, ReferenceFrame::World, ReferenceFrame::LocalWorldAligned];

fn bent(robot: &Mechanism) -> Vec<f64> {
    (0..robot.n()).map(|i| [0.4, 0.6, 0.9, 0.5, 0.7, 0.5, 0.3][i]).collect()
}

/// (S J)+ S for every method; the singular values are those of the scaled matrix.
#[test]
fn linear_rows_are_divided_by_the_length() {
    for name in ["ur5e", "panda", "youbot"] {
        let robot = catalogue::load(name).unwrap();
        let state = robot.state(&bent(&robot)).unwrap();
        for length in [0.2, 1.0, 3.0] {
            for method in Method::ALL {
                let projection = TaskProjection::Orthogonal;
                let choice = InverseChoice { method, projection, length };
                let found =
                    choice.inverse(&state, robot.tool(), ReferenceFrame::Local, None).unwrap();
                let j = state.jacobian(robot.tool(), ReferenceFrame::Local).unwrap();
                let s = |i: usize| if i < 3 { 1.0 / length } else { 1.0 };
                let scaled = Matrix::from_fn(6, robot.n(), |i, k| j[(i, k)] * s(i));
                let plain = method.inverse(&scaled).unwrap();
                assert_eq!(found.singular_values, plain.singular_values);
                for i in 0..robot.n() {
                    for k in 0..6 {
                        assert_eq!(found.matrix[(i, k)], plain.matrix[(i, k)] * s(k));
                    }
                }
            }
        }
    }
}

/// Joint velocities of hyperbolic and oblique inverses are the same in every frame.
#[test]
fn invariant_inverses_are_the_same_in_all_frames() {
    let robot = catalogue::load("youbot").unwrap();
    let state = robot.state(&bent(&robot)).unwrap();
    let pose = state.pose(robot.tool()).unwrap();
    let twist = Twist { linear: Vec3::new(0.1, 0.3, -0.2), angular: Vec3::new(0.2, -0.5, 0.1) };
    let given_up = Twist { linear: Vec3::new(0.3, 0.1, -0.2), angular: Vec3::new(0.5, 0.4, 0.1) };
    let oblique =
        TaskProjection::Oblique { complement: vec![given_up], reference: ReferenceFrame::Local };
    for projection in [TaskProjection::Hyperbolic { h: 0.1 }, oblique] {
        let choice = InverseChoice { method: Method::default(), projection, length: robot.reach() };
        let [local, world, aligned] = FRAMES.map(|frame| {
            let seen = match frame {
                ReferenceFrame::Local => twist,
                ReferenceFrame::World => pose.adjoint(twist),
                ReferenceFrame::LocalWorldAligned => pose.adjoint(twist).at_point(pose.translation),
            };
            let found = choice.inverse(&state, robot.tool(), frame, Some(seen)).unwrap();
            found.matrix.mul_vec(&seen.to_array())
        });
        crate::support::assert_close("world", &world, &local, 1e-10);
        crate::support::assert_close("aligned", &aligned, &local, 1e-10);
    }
}

/// The joint velocities of a closed chain keep its loops closed and move the reference as asked.
#[test]
fn loops_stay_closed() {
    for (name, free) in [("stewart", 6), ("delta", 3), ("five-bar", 2)] {
        let mechanism = catalogue::load(name).unwrap();
        let state = mechanism.state(mechanism.home()).unwrap();
        let reference = mechanism.reference();
        let frame = ReferenceFrame::LocalWorldAligned;
        let choice = InverseSelection { name: "truncated", ..Default::default() };
        let choice = choice.choice(mechanism.reach()).unwrap();
        let found = choice.inverse(&state, reference, frame, None).unwrap();
        assert_eq!((found.rank, found.matrix.rows()), (free, mechanism.n()), "{name}");
        let j = state.jacobian(reference, frame).unwrap();
        for axis in 0..6 {
            let twist: [f64; 6] = std::array::from_fn(|i| f64::from(u8::from(i == axis)));
            let velocities = found.matrix.mul_vec(&twist);
            // The link of the five-bar turns as it moves, so that what is realised is the nearest.
            let realised = j.mul_vec(&velocities);
            if axis < free && name != "five-bar" {
                crate::support::assert_close(name, &realised, &twist, 1e-9);
            }
            let again = j.mul_vec(&found.matrix.mul_vec(&realised));
            crate::support::assert_close(name, &again, &realised, 1e-9);
            let moved = mechanism.integrate(state.q(), &velocities, 1e-4).unwrap();
            let after = mechanism.state(&moved).unwrap();
            let error = cylindroid::closure::ClosedChain::of(&after, None, None).unwrap();
            assert!(error.closure_error.distance < 1e-7, "{name}: {:?}", error.closure_error);
        }
    }
}

#[test]
fn selections_are_checked() {
    let robot = catalogue::load("youbot").unwrap();
    let state = robot.state(&bent(&robot)).unwrap();
    let select = |name: &'static str, parameters: &[(&'static str, f64)], length| {
        let parameters = parameters.to_vec();
        InverseSelection { name, parameters, ..Default::default() }.choice(length)
    };
    assert!(select("hyperbole", &[], 1.0).is_err());
    assert!(select("hyperbolic", &[], 1.0).is_err());
    assert!(select("damped", &[("eps", 0.1)], 1.0).is_err());
    assert!(select("damped", &[], 0.0).is_err());
    let j = state.jacobian(robot.tool(), ReferenceFrame::World).unwrap();
    let found = select("hyperbolic", &[("h", 0.1)], 0.5).unwrap();
    let found = found.inverse(&state, robot.tool(), ReferenceFrame::World, None).unwrap();
    let plain = inverse::hyperbolic(&j, 0.1).unwrap();
    assert!(found.matrix.max_difference(&plain.matrix) < 1e-12);
    let none = select("hyperbolic", &[("h", 0.0)], 0.5).unwrap();
    let none = none.inverse(&state, robot.tool(), ReferenceFrame::World, None).unwrap();
    assert!(!none.exists && none.reason.is_some());
}
