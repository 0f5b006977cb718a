//! Servos that take on the part of a motion that a form of twists, or the task, chooses.

use super::*;
use cylindroid::control::TaskProjection;
use cylindroid::inverse::{self, HyperbolicDamping, HyperbolicOptions};
use cylindroid::linalg::{ColumnSpace, Matrix, Metric, Threshold};
use cylindroid::screws::{Class, NoInverse, ScrewOptions};

const DEGREE: f64 = std::f64::consts::PI / 180.0;

/// The youBot with its tool so far below the horizontal (90: straight down).
fn pitched(degrees: f64) -> Vec<f64> {
    let total = (90.0 + degrees) * DEGREE;
    vec![0.4, 0.6, 0.9, total - 1.5, 0.2]
}

fn youbot() -> Mechanism {
    catalogue::load("youbot").unwrap()
}

/// The rates of one step for a small feed-forward twist, far from all limits.
fn rates(robot: &Mechanism, projection: TaskProjection, q: &[f64], twist: Twist) -> Vec<f64> {
    rates_with(robot, q, twist, |o| o.projection = projection)
}

fn rates_with(
    robot: &Mechanism,
    q: &[f64],
    twist: Twist,
    change: impl FnOnce(&mut ServoOptions),
) -> Vec<f64> {
    let mut servo = servo(robot, |o| {
        o.method = Method::Truncated { eps: 1e-9 };
        change(o);
    });
    let pose = robot.state(q).unwrap().pose(robot.tool()).unwrap();
    let step = servo.step(q, Target { pose, feed_forward: twist }).unwrap();
    assert_eq!(step.saturation.scale, 1.0);
    servo.joint_velocities().to_vec()
}

fn world_jacobian(robot: &Mechanism, q: &[f64]) -> Matrix {
    robot.state(q).unwrap().jacobian(robot.tool(), ReferenceFrame::World).unwrap()
}

fn assert_rates(got: &[f64], expected: &[f64]) {
    let size = expected.iter().fold(0.0, |m: f64, x| m.max(x.abs()));
    crate::support::assert_close("rates", got, expected, 1e-10 * size);
}

const TWIST: Twist =
    Twist { linear: Vec3::new(1e-3, 2e-3, -1e-3), angular: Vec3::new(3e-3, 1e-3, 2e-3) };

/// J+ P x is the inverse of `inverse/`, which knows nothing of servos, in another frame.
#[test]
fn rates_are_those_of_the_inverse() {
    let robot = youbot();
    let q = pitched(25.0);
    let j = world_jacobian(&robot, &q);
    let tool = robot.state(&q).unwrap().pose(robot.tool()).unwrap().translation;
    let seen = TWIST.at_point(-tool).to_array();
    let length = robot.reach();
    let scale = ScrewOptions::with_length(length);
    for h in [0.1, -0.3, 1.0, f64::INFINITY] {
        let expected = inverse::hyperbolic_with(
            &j,
            h,
            &HyperbolicOptions { scale, ..HyperbolicOptions::default() },
        )
        .unwrap();
        let got = rates(&robot, TaskProjection::Hyperbolic { h }, &q, TWIST);
        assert_rates(&got, &expected.matrix.mul_vec(&seen));
    }
    let weights = [1.0, 4.0, 2.0, 9.0, 1.0];
    for damping in
        [HyperbolicDamping::Invariant { mu: 0.02 }, HyperbolicDamping::Gram { lambda: 0.03 }]
    {
        let expected = inverse::hyperbolic_with(
            &j,
            0.1,
            &HyperbolicOptions {
                scale,
                joint_metric: Some(Metric::diagonal("weights", &weights).unwrap()),
                damping,
            },
        )
        .unwrap();
        let got = rates_with(&robot, &q, TWIST, |o| {
            o.projection = TaskProjection::DampedHyperbolic { h: 0.1, damping };
            o.joint_weights = weights.to_vec();
        });
        assert_rates(&got, &expected.matrix.mul_vec(&seen));
    }
    // Given up: rolling about the tool's own axis, in three ways to say it.
    let pose = robot.state(&q).unwrap().pose(robot.tool()).unwrap();
    let roll = Twist { linear: Vec3::ZERO, angular: Vec3::Y };
    let aligned = Twist { linear: Vec3::ZERO, angular: pose.rotation * Vec3::Y };
    let world = pose.adjoint(roll);
    let complement = Matrix::from_fn(6, 1, |i, _| world.to_array()[i]);
    let options = HyperbolicOptions { scale, ..HyperbolicOptions::default() };
    let expected = inverse::oblique(&j, &complement, &options).unwrap();
    for (twist, reference) in [
        (roll, ReferenceFrame::Local),
        (aligned, ReferenceFrame::LocalWorldAligned),
        (world, ReferenceFrame::World),
    ] {
        let projection = TaskProjection::Oblique { complement: vec![twist], reference };
        assert_rates(
            &rates(&robot, projection.clone(), &q, TWIST),
            &expected.matrix.mul_vec(&seen),
        );
        let local = rates_with(&robot, &q, TWIST, |o| {
            o.projection = projection;
            o.task.axes = ReferenceFrame::Local;
        });
        assert_rates(&local, &expected.matrix.mul_vec(&seen));
    }
}

/// The characteristic length, that makes Moore-Penrose rates what they are, changes nothing.
#[test]
fn rates_do_not_change_with_the_length() {
    let robot = youbot();
    let q = pitched(25.0);
    let with = |projection: TaskProjection, length: f64| {
        rates_with(&robot, &q, TWIST, |o| {
            (o.projection, o.length) = (projection, length);
            o.largest_projection = f64::INFINITY;
        })
    };
    let reference = with(TaskProjection::Hyperbolic { h: 0.1 }, 0.655);
    for length in [0.1, 1.0, 655.0] {
        assert_rates(&with(TaskProjection::Hyperbolic { h: 0.1 }, length), &reference);
        let (a, b) =
            (with(TaskProjection::Orthogonal, length), with(TaskProjection::Orthogonal, 0.655));
        let difference = a.iter().zip(&b).map(|(x, y)| (x - y).abs()).fold(0.0, f64::max);
        assert!(difference > 1e-5, "length {length}: {difference}");
    }
}

#[test]
fn youbot_converges_25_degrees_below_the_horizontal() {
    let robot = youbot();
    let target = robot.state(&pitched(25.0)).unwrap().pose(robot.tool()).unwrap();
    let start = [0.1, 0.5, 0.9, 0.3, -0.2];
    for projection in [
        TaskProjection::Hyperbolic { h: 0.1 },
        TaskProjection::Hyperbolic { h: 1.0 },
        TaskProjection::Hyperbolic { h: f64::INFINITY },
        TaskProjection::Orthogonal,
    ] {
        let mut servo = servo(&robot, |o| o.projection = projection.clone());
        let outcome = run_checked(&robot, &mut servo, &start, target);
        assert_eq!(outcome.last.status, Status::Reached, "{projection:?} {:?}", servo.stall());
        assert_eq!(servo.no_inverse(), None, "{projection:?}");
    }
}

/// Picking from above: no hyperbolic inverse for any pitch. The arm stops and says why, or falls
/// to what was named, and says that too.
#[test]
fn straight_down_there_is_none() {
    let robot = youbot();
    let down = pitched(90.0);
    let mut pose = robot.state(&down).unwrap().pose(robot.tool()).unwrap();
    pose.translation.z -= 0.03;
    let projection = TaskProjection::Hyperbolic { h: 0.1 };
    let mut alone = servo(&robot, |o| o.projection = projection.clone());
    let outcome = run_checked(&robot, &mut alone, &down, pose);
    assert_eq!(outcome.last.status, Status::Stalled);
    assert_eq!(alone.stall(), Stall::NoInverse(NoInverse::Class { class: Class::Inf, order: 5 }));
    assert!(alone.joint_velocities().iter().all(|r| *r == 0.0));
    assert_eq!((outcome.steps, outcome.steps_without_inverse), (0, 1));

    let falling_to = |fallback: TaskProjection| {
        servo(&robot, |o| {
            o.projection = projection.clone();
            o.fallback = Some(fallback);
        })
    };
    let mut plain = falling_to(TaskProjection::Orthogonal);
    let outcome = run_checked(&robot, &mut plain, &down, pose);
    assert_eq!(outcome.last.status, Status::Reached, "{:?}", plain.stall());
    assert!(outcome.no_inverse.is_some() && outcome.steps_without_inverse > 0);
    // The damped form does not translate along the twist that is reciprocal to all joints and to
    // itself: horizontally, in the plane of the arm.
    let damping = HyperbolicDamping::Invariant { mu: 1e-3 };
    let mut damped = falling_to(TaskProjection::DampedHyperbolic { h: 0.1, damping });
    run_checked(&robot, &mut damped, &down, pose);
    let Stall::Projected { direction } = damped.stall() else { panic!("{:?}", damped.stall()) };
    let radial = direction[0] * down[0].cos() + direction[1] * down[0].sin();
    assert!(radial.abs() > 0.99, "{direction:?}");
    // A fallback that does not exist either stops the arm too.
    let mut twice = falling_to(TaskProjection::Hyperbolic { h: 0.2 });
    assert_eq!(run(&mut twice, &down, pose).last.status, Status::Stalled);
}

/// One degree off the vertical the inverse exists and enlarges motions by more than a thousand.
#[test]
fn a_projection_may_be_too_large() {
    let robot = youbot();
    let q = pitched(89.0);
    let pose = robot.state(&q).unwrap().pose(robot.tool()).unwrap();
    let target = Target { pose, feed_forward: TWIST };
    let mut strict = servo(&robot, |o| o.projection = TaskProjection::Hyperbolic { h: 0.1 });
    assert_eq!(strict.step(&q, target).unwrap().status, Status::Stalled);
    let Stall::NoInverse(NoInverse::TooLarge { norm }) = strict.stall() else {
        panic!("{:?}", strict.stall())
    };
    assert!((1e3..1e4).contains(&norm), "{norm}");
    let mut bold = servo(&robot, |o| {
        o.projection = TaskProjection::Hyperbolic { h: 0.1 };
        o.largest_projection = f64::INFINITY;
    });
    bold.step(&q, target).unwrap();
    assert_eq!(bold.no_inverse(), None);
}

/// The size of the projector that decides: |P|, Frobenius, at the tool and over the length. With five
/// joints P = 1 - m n^T / (n . m), n normal to the motions and Q_h m = n, so that |P|^2 = 4 + (|m|
/// |n| / n . m)^2.
#[test]
fn size_of_a_projection() {
    let robot = youbot();
    for (degrees, h) in [(25.0, 0.1), (60.0, -0.3), (89.0, 0.1)] {
        let q = pitched(degrees);
        let state = robot.state(&q).unwrap();
        let (pose, length) = (state.pose(robot.tool()).unwrap(), robot.reach());
        let j = state.jacobian(robot.tool(), ReferenceFrame::LocalWorldAligned).unwrap();
        let scaled = Matrix::from_fn(6, 5, |i, c| j[(i, c)] / if i < 3 { length } else { 1.0 });
        let normal = ColumnSpace::of(&scaled, Threshold::Absolute(1e-9)).complement();
        let n: [f64; 6] = std::array::from_fn(|i| normal[(i, 0)]);
        let m: [f64; 6] =
            std::array::from_fn(
                |i| {
                    if i < 3 { n[i + 3] + 2.0 * h / length * n[i] } else { n[i - 3] }
                },
            );
        let dot = |a: &[f64; 6], b: &[f64; 6]| a.iter().zip(b).map(|(x, y)| x * y).sum::<f64>();
        let expected = (4.0 + dot(&m, &m) * dot(&n, &n) / dot(&m, &n).powi(2)).sqrt();
        for (factor, accepted) in [(0.999, false), (1.001, true)] {
            let mut servo = servo(&robot, |o| {
                o.projection = TaskProjection::Hyperbolic { h };
                o.largest_projection = factor * expected;
            });
            servo.step(&q, Target { pose, feed_forward: TWIST }).unwrap();
            assert_eq!(servo.no_inverse().is_none(), accepted, "{degrees} {expected}");
            if let Some(NoInverse::TooLarge { norm }) = servo.no_inverse() {
                assert!((norm / expected - 1.0).abs() < 1e-6, "{norm} {expected}");
            } else {
                assert!(accepted, "{:?}", servo.no_inverse());
            }
        }
    }
}

/// With six independent joints every projection is the identity.
#[test]
fn six_joints_take_on_everything() {
    let robot = catalogue::load("ur5e").unwrap();
    let q = [0.3, -1.2, 1.4, -0.9, 0.7, 0.2];
    let plain = rates(&robot, TaskProjection::Orthogonal, &q, TWIST);
    for projection in [
        TaskProjection::Hyperbolic { h: 0.2 },
        TaskProjection::Oblique { complement: vec![], reference: ReferenceFrame::Local },
    ] {
        assert_rates(&rates(&robot, projection, &q, TWIST), &plain);
    }
}

#[test]
fn bad_projections_are_refused() {
    let robot = youbot();
    let refused = |change: &dyn Fn(&mut ServoOptions)| {
        let mut options = ServoOptions::new(&robot);
        change(&mut options);
        Servo::new(&robot, options).unwrap_err().to_string()
    };
    let text = refused(&|o| o.projection = TaskProjection::Hyperbolic { h: f64::NAN });
    assert!(text.contains("pitch h"), "{text}");
    let text = refused(&|o| {
        o.projection = TaskProjection::Hyperbolic { h: 0.1 };
        o.task = Task::POSITION;
    });
    assert!(text.contains("whole poses"), "{text}");
    let text = refused(&|o| {
        let damping = HyperbolicDamping::Invariant { mu: -1.0 };
        o.fallback = Some(TaskProjection::DampedHyperbolic { h: 0.1, damping });
    });
    assert!(text.contains("mu"), "{text}");
    let text = refused(&|o| o.largest_projection = 0.0);
    assert!(text.contains("largest projection"), "{text}");
    let zero = TaskProjection::Oblique {
        complement: vec![Twist::ZERO; 7],
        reference: ReferenceFrame::Local,
    };
    let text = refused(&|o| o.projection = zero.clone());
    assert!(text.contains("six"), "{text}");
    // A complement that is a motion of the arm does not complete it.
    let q = pitched(25.0);
    let j = world_jacobian(&robot, &q);
    let own = Twist::from_array(j.column(0).try_into().unwrap());
    let own = TaskProjection::Oblique { complement: vec![own], reference: ReferenceFrame::World };
    let mut servo = servo(&robot, |o| o.projection = own);
    let pose = robot.state(&q).unwrap().pose(robot.tool()).unwrap();
    servo.step(&q, Target { pose, feed_forward: TWIST }).unwrap();
    assert_eq!(servo.stall(), Stall::NoInverse(NoInverse::NotComplementary { order: 5, other: 1 }));
}
