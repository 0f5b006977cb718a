//! Finite input gives finite results up to the range that is stated, and an error beyond; frames of
//! other mechanisms are errors.

use cylindroid::closure::{ModeOptions, frame_twists, operation_modes};
use cylindroid::control::{Servo, ServoOptions};
use cylindroid::ik::{Analytic, Budget, Goal, IkOptions, NotSolvable, Objective, solve};
use cylindroid::kinematics::{Chain, KinematicsBatch, OrientationRates};
use cylindroid::manipulability::{BatchOptions, ManipulabilityBatch, body_inertia};
use cylindroid::model::{Inertial, JointKind, JointSpec, Limits, Link};
use cylindroid::spatial::Mat3;
use cylindroid::tolerance::MAX_MAGNITUDE;
use cylindroid::{Error, Matrix, Mechanism, Pose, ReferenceFrame, Vec3, catalogue};

use crate::support::zoo;

/// Slides and rotations in series, each as far as the range allows.
fn far(places: f64) -> Result<Mechanism, Error> {
    let mut builder = Mechanism::builder("far");
    let kinds = [JointKind::Prismatic, JointKind::Revolute, JointKind::Helical { pitch: places }];
    for (i, kind) in kinds.into_iter().cycle().take(6).enumerate() {
        let (parent, child) = (format!("l{i}"), format!("l{}", i + 1));
        builder.joint(JointSpec {
            parent_from_joint: Pose::from_translation(Vec3::new(places, -places, places)),
            ..JointSpec::new(&format!("q{i}"), kind, &parent, &child)
        });
    }
    builder.build()
}

#[test]
fn kinematics_are_finite_up_to_the_range() {
    let edge = MAX_MAGNITUDE;
    for robot in [far(edge).unwrap(), zoo(), catalogue::load("panda").unwrap()] {
        let q = vec![edge; robot.n()];
        let state = robot.state(&q).unwrap();
        for frame in robot.frame_ids() {
            assert!(state.pose(frame).unwrap().is_finite(), "{}", robot.name());
            let jacobian = state.jacobian(frame, ReferenceFrame::World).unwrap();
            assert!(jacobian.as_slice().iter().all(|x| x.is_finite()), "{}", robot.name());
        }
        let next = robot.integrate(&q, &q, 1e-3).unwrap();
        assert!(next.iter().all(|x| x.is_finite()), "{next:?}");
        let next = robot.integrate(&q, &vec![1.0; robot.n()], edge).unwrap();
        assert!(next.iter().all(|x| x.is_finite()), "{next:?}");
        let beyond = robot.integrate(&q, &q, edge).unwrap_err().to_string();
        assert!(beyond.starts_with("dt * rates[0] (") && beyond.contains("1e240"), "{beyond}");
    }
}

#[test]
fn numbers_beyond_the_range_are_refused_by_name() {
    let robot = catalogue::load("panda").unwrap();
    let name = &robot.coordinates()[2].name;
    for beyond in [f64::MAX, -f64::MAX, 1e160, -1.1e120] {
        let mut q = robot.home().to_vec();
        q[2] = beyond;
        let error = robot.state(&q).unwrap_err();
        assert!(matches!(error, Error::OutOfRange { value, .. } if value == beyond), "{error}");
        assert!(error.to_string().starts_with(&format!("q[2] ({name}) = ")), "{error}");
        let mut state = robot.state(robot.home()).unwrap();
        assert!(state.set(&q).is_err() && state.q() == robot.home());
        let rates = robot.integrate(robot.home(), &q, 1e-3).unwrap_err().to_string();
        assert!(rates.starts_with(&format!("rates[2] ({name}) = ")), "{rates}");
        let dt = robot.integrate(robot.home(), robot.home(), beyond).unwrap_err().to_string();
        assert!(dt.starts_with("dt[0] = ") && dt.contains("magnitudes up to 1e120"), "{dt}");
        let rows = [robot.home(), &q].concat();
        let error = robot.check_rows("q", &rows).unwrap_err().to_string();
        assert!(error.starts_with(&format!("q[1][2] ({name}) = ")), "{error}");
        let mut matrix = Pose::IDENTITY.to_matrix();
        matrix[0][3] = beyond;
        assert!(matches!(Pose::from_matrix(matrix), Err(Error::OutOfRange { .. })));
    }
    let message = far(1e121).unwrap_err().to_string();
    assert!(message.contains("'q0'") && message.contains("1e121, out of range"), "{message}");
    let mut builder = Mechanism::builder("wide");
    builder.joint(JointSpec {
        limits: Limits { velocity: 1.8e300, ..Limits::NONE },
        ..JointSpec::new("turn", JointKind::Revolute, "a", "b")
    });
    let message = builder.build().unwrap_err().to_string();
    assert!(message.contains("limit of joint 'turn' is 1.8e300"), "{message}");
}

/// Of servos, of inverse kinematics and of closed forms: within the range they are out of reach, beyond
/// it an error.
#[test]
fn targets_are_as_far_as_the_range() {
    for name in ["panda", "puma560", "3rps"] {
        let robot = catalogue::load(name).unwrap();
        let tool = robot.tool();
        for far in [0.9 * MAX_MAGNITUDE, -1.1 * MAX_MAGNITUDE, 1e308] {
            let point = Vec3::new(0.1, far, 0.2);
            let target = Pose::from_translation(point);
            let centre = Objective::CenterOfMass { axes: [true; 3], target: point };
            let options =
                IkOptions { budget: Budget { iterations: 5, time: None }, ..IkOptions::default() };
            let mut servo = Servo::new(&robot, ServoOptions::new(&robot)).unwrap();
            let mut all = vec![
                servo.step(robot.home(), target).err(),
                solve(&robot, &[Goal::pose(tool, target)], &options).err(),
                solve(&robot, &[centre.into()], &options).err(),
            ];
            if let Ok(mut analytic) = Analytic::of(&robot, tool) {
                all.push(analytic.solve(target, robot.home()).err());
            }
            for error in all {
                let told = error.map(|e| e.to_string());
                let is_refused = told.as_ref().is_some_and(|t| {
                    t.starts_with("target") && t.contains("magnitudes up to 1e120")
                });
                assert_eq!(is_refused, far.abs() > MAX_MAGNITUDE, "{name} {far:e}: {told:?}");
            }
        }
    }
}

/// Poses, Jacobians, twists and measures of a frame, chains, batches and closed forms.
#[test]
fn frames_of_other_mechanisms_are_errors() {
    let [panda, ur5e, five_bar] =
        ["panda", "ur5e", "five-bar"].map(|name| catalogue::load(name).unwrap());
    let state = panda.state(panda.home()).unwrap();
    let foreign = ur5e.tool();
    let local = ReferenceFrame::Local;
    let messages = [
        state.twist(&[0.0; 7], foreign, local).unwrap_err(),
        state.jacobian_dot(&[0.0; 7], foreign, local).unwrap_err(),
        state.pose(foreign).unwrap_err(),
        state.jacobian(foreign, local).unwrap_err(),
        state.jacobian_into(foreign, local, &mut Matrix::zeros(6, 7)).unwrap_err(),
        state.hessian(foreign, local).unwrap_err(),
        state.relative_jacobian(panda.tool(), foreign).unwrap_err(),
        state.relative_jacobian(foreign, panda.tool()).unwrap_err(),
        state.analytical_jacobian(foreign, OrientationRates::RotationVector).unwrap_err(),
        Chain::new(&panda, foreign).unwrap_err(),
        KinematicsBatch::new(&panda, foreign).unwrap_err(),
        body_inertia(&state, foreign).unwrap_err(),
        frame_twists(&state, foreign).unwrap_err(),
        operation_modes(&five_bar, five_bar.home(), Some(foreign), ModeOptions::default())
            .unwrap_err(),
        ManipulabilityBatch::new(
            &five_bar,
            &BatchOptions { reference: Some(foreign), ..BatchOptions::default() },
        )
        .unwrap_err(),
    ];
    for error in messages {
        assert!(error.to_string().contains("another mechanism"), "{error}");
    }
    assert_eq!(Analytic::of(&panda, foreign).unwrap_err(), NotSolvable::Foreign);
    let locked = Analytic::with_locked(&panda, foreign, &[6]);
    assert_eq!(locked.unwrap_err(), NotSolvable::Foreign);
    // A matrix of another size.
    let error = state.jacobian_into(panda.tool(), local, &mut Matrix::zeros(6, 6)).unwrap_err();
    assert!(error.to_string().contains("columns of the Jacobian"), "{error}");
}

#[test]
fn masses_are_within_the_range() {
    let built = |inertial: Inertial| {
        let mut builder = Mechanism::builder("bob");
        builder.joint(JointSpec::new("q", JointKind::Revolute, "base", "bob"));
        builder.link(Link { inertial: Some(inertial), ..Link::named("bob") });
        builder.build()
    };
    let good = Inertial { mass: 2.0, link_from_inertia: Pose::IDENTITY, inertia: Mat3::ZERO };
    assert!(built(good).is_ok() && built(Inertial { mass: 0.0, ..good }).is_ok());
    let far = Pose::from_translation(Vec3::X * 1e300);
    for bad in [
        Inertial { mass: -1.0, ..good },
        Inertial { mass: f64::NAN, ..good },
        Inertial { mass: 1e300, ..good },
        Inertial { inertia: Mat3::from_rows([[f64::INFINITY; 3]; 3]), ..good },
        Inertial { link_from_inertia: far, ..good },
    ] {
        let error = built(bad).unwrap_err().to_string();
        assert!(error.contains("link 'bob'"), "{error}");
    }
}
