//! Inverses when the reference point of the twist is moved.

use super::*;
use cylindroid::control::{InverseChoice, TaskProjection};
use cylindroid::inverse::HyperbolicDamping;
use cylindroid::{EndEffector, inverse};

const POINT: Vec3 = Vec3::new(0.5, -0.2, 0.4);
const ASKED: Twist =
    Twist { linear: Vec3::new(0.1, -0.05, 0.02), angular: Vec3::new(0.2, 0.1, -0.3) };

fn choice(robot: &Mechanism, method: Method, projection: TaskProjection) -> InverseChoice {
    InverseChoice { method, projection, length: robot.reach() }
}

fn bent(robot: &Mechanism) -> Vec<f64> {
    (0..robot.n()).map(|i| [0.4, 0.6, 0.9, 0.4, 0.7, 0.5, 0.3][i]).collect()
}

fn asked(
    choice: &InverseChoice,
    robot: &Mechanism,
) -> cylindroid::control::ReferencePointComparison {
    let state = robot.state(&bent(robot)).unwrap();
    choice.at_two_points(&state, robot.tool().into(), ASKED, POINT).unwrap()
}

/// Of an arm of five joints Moore-Penrose and damping change their minds, hyperbolic inverses not.
#[test]
fn only_invariant_inverses_keep_their_rates() {
    let robot = catalogue::load("youbot").unwrap();
    for method in Method::ALL {
        let found = asked(&choice(&robot, method, TaskProjection::Orthogonal), &robot);
        assert!(!found.invariant && found.difference > Some(1e-3), "{}: {found:?}", method.name());
    }
    let damping = HyperbolicDamping::Invariant { mu: 0.01 };
    let given_up = |reference| TaskProjection::Oblique {
        complement: vec![Twist {
            linear: Vec3::new(0.3, 0.1, -0.2),
            angular: Vec3::new(0.5, 0.4, 0.1),
        }],
        reference,
    };
    for projection in [
        TaskProjection::Hyperbolic { h: 0.1 },
        TaskProjection::Hyperbolic { h: -0.3 },
        TaskProjection::DampedHyperbolic { h: 0.1, damping },
        given_up(ReferenceFrame::Local),
        given_up(ReferenceFrame::World),
        given_up(ReferenceFrame::LocalWorldAligned),
    ] {
        let found = asked(&choice(&robot, Method::default(), projection.clone()), &robot);
        assert!(found.invariant, "{projection:?}: {found:?}");
        let done = [&found.at_tool, &found.at_point].map(|at| at.achieved.unwrap().to_array());
        crate::support::assert_close("done", &done[0], &done[1], 1e-9);
    }
}

/// Where nothing is given up there is nothing to weigh; damping gives something up.
#[test]
fn arms_that_can_do_all_keep_their_rates_without_damping() {
    for name in ["panda", "ur5e"] {
        let robot = catalogue::load(name).unwrap();
        let exact = choice(&robot, Method::Truncated { eps: 1e-9 }, TaskProjection::Orthogonal);
        let found = asked(&exact, &robot);
        assert!(found.invariant, "{name}: {found:?}");
        let done = found.at_tool.achieved.unwrap();
        crate::support::assert_close(name, &done.to_array(), &ASKED.to_array(), 1e-9);
        let damped = Method::Damped { damping: 0.1 };
        let damped = choice(&robot, damped, TaskProjection::Orthogonal);
        let state = robot.state(&bent(&robot)).unwrap();
        // However slow or fast it is.
        for size in [1e-6, 1.0, 1e6] {
            let compare = |choice: &InverseChoice| {
                choice.at_two_points(&state, robot.tool().into(), ASKED * size, POINT).unwrap()
            };
            assert!(compare(&exact).invariant && !compare(&damped).invariant, "{name} {size}");
        }
    }
}

/// At the tool they are the rates of the servo; at the point those of the inverse by hand.
#[test]
fn rates_are_those_of_servo_and_inverse() {
    let robot = catalogue::load("youbot").unwrap();
    let q = bent(&robot);
    let state = robot.state(&q).unwrap();
    let pose = state.pose(robot.tool()).unwrap();
    for projection in [TaskProjection::Orthogonal, TaskProjection::Hyperbolic { h: 0.1 }] {
        let method = Method::Truncated { eps: 1e-9 };
        let found = asked(&choice(&robot, method, projection.clone()), &robot);
        let mut servo = servo(&robot, |o| (o.method, o.projection) = (method, projection));
        // Slow enough for every limit.
        let feed_forward = ASKED * 1e-2;
        servo.step(&q, Target { pose, feed_forward }).unwrap();
        let rates: Vec<f64> = servo.joint_velocities().iter().map(|x| 1e2 * x).collect();
        crate::support::assert_close(
            "rates",
            found.at_tool.joint_velocities.as_ref().unwrap(),
            &rates,
            1e-9,
        );
    }
    let tool = EndEffector {
        frame: robot.tool(),
        frame_from_tool: pose.inverse() * Pose { translation: POINT, ..pose },
    };
    let j = state.jacobian(tool, ReferenceFrame::LocalWorldAligned).unwrap();
    let length = robot.reach();
    let scale = |i: usize| if i < 3 { 1.0 / length } else { 1.0 };
    let scaled = Matrix::from_fn(6, 5, |i, k| scale(i) * j[(i, k)]);
    let twist = ASKED.at_point(POINT - pose.translation).to_array();
    let twist: Vec<f64> = twist.iter().enumerate().map(|(i, x)| scale(i) * x).collect();
    let by_hand = inverse::damped(&scaled, 0.05).unwrap().matrix.mul_vec(&twist);
    let method = Method::Damped { damping: 0.05 };
    let found = asked(&choice(&robot, method, TaskProjection::Orthogonal), &robot);
    crate::support::assert_close(
        "rates",
        &found.at_point.joint_velocities.unwrap(),
        &by_hand,
        1e-12,
    );
}

#[test]
fn what_does_not_exist_says_why() {
    // Parallel axes: a planar arm has no hyperbolic inverse of any finite pitch.
    let robot = planar(3);
    let state = robot.state(&bent(&robot)).unwrap();
    let none = choice(&robot, Method::default(), TaskProjection::Hyperbolic { h: 0.1 });
    let found = none.at_two_points(&state, robot.tool().into(), ASKED, POINT).unwrap();
    assert!(found.at_tool.joint_velocities.is_none() && found.at_tool.reason.is_some());
    assert!(found.difference.is_none() && !found.invariant);
    let linkage = catalogue::load("four-bar").unwrap();
    let state = linkage.state(linkage.home()).unwrap();
    let plain = choice(&linkage, Method::default(), TaskProjection::Orthogonal);
    assert!(plain.at_two_points(&state, linkage.tool().into(), ASKED, POINT).is_err());
    let state = robot.state(&bent(&robot)).unwrap();
    let plain = choice(&robot, Method::default(), TaskProjection::Orthogonal);
    let nowhere = Vec3::new(f64::NAN, 0.0, 0.0);
    assert!(plain.at_two_points(&state, robot.tool().into(), ASKED, nowhere).is_err());
}
