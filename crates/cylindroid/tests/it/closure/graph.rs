//! From mechanisms to constraints: exact values, counts, wherever the loops are cut.

use cylindroid::closure::{ClosedChain, Mobility, MotionSpace, frame_twists};
use cylindroid::linalg::Svd;
use cylindroid::manipulability::{Manipulability, Metrics};
use cylindroid::model::{ContactKind, ContactSpec, JointKind, JointSpec, LoopJointSpec};
use cylindroid::{Error, Mechanism, ReferenceFrame, catalogue};

use crate::support::{Random, robots};

fn chain(mechanism: &Mechanism) -> ClosedChain {
    let state = mechanism.state(mechanism.home()).unwrap();
    ClosedChain::of(&state, None, Some(1.0)).unwrap()
}

fn kinematic(chain: &ClosedChain) -> Vec<f64> {
    let relation = MotionSpace::of(&chain.constraint).relation();
    Manipulability::of(&relation, &Metrics::UNIT).unwrap().kinematic.values()
}

/// dof, redundancy, indeterminacy, internal, zero_torque, hyperstatic, idle.
fn counts(chain: &ClosedChain) -> [usize; 7] {
    let m = Mobility::of(&chain.constraint);
    [
        m.dof.dimension(),
        m.relation.redundancy,
        m.relation.indeterminacy,
        m.internal.dimension(),
        m.zero_torque.dimension(),
        m.hyperstatic.dimension(),
        m.idle.dimension(),
    ]
}

/// Section 5 of Bicchi & Prattichizzo 1998, geometry recovered: cases a, b and c.
#[test]
fn five_bar_exact() {
    let five_bar = catalogue::load("five-bar").unwrap();
    let (a, b, c) = (41_f64.sqrt(), 97_f64.sqrt(), 3_f64.sqrt());
    for (actuated, expected, internal) in [
        (&["q1", "q5"][..], [7.0 + a, 7.0 - a], 0),
        (&["q2", "q4"], [(15.0 + b) / 16.0, (15.0 - b) / 16.0], 0),
        (&["q1", "q2", "q3", "q4", "q5"], [0.4 + 2.0 * c / 15.0, 0.4 - 2.0 * c / 15.0], 3),
    ] {
        let chain = chain(&five_bar.with_actuated(actuated).unwrap());
        assert!(chain.closure_error.distance < 1e-15 && chain.closure_error.angle < 1e-15);
        assert_eq!(chain.actuated.len(), actuated.len());
        let got = kinematic(&chain);
        assert_eq!(got.len(), 2);
        for (g, e) in got.iter().zip(expected) {
            assert!((g - e).abs() < 1e-12 * e, "{actuated:?}: {g} instead of {e}");
        }
        assert_eq!(counts(&chain), [2, 0, 0, internal, 1, 0, 0], "{actuated:?}");
    }
}

#[test]
fn counts_of_the_catalogue() {
    for (name, expected) in [
        ("four-bar", [1, 0, 0, 0, 2, 0, 0]),
        ("3rrr", [3, 0, 0, 0, 0, 0, 0]),
        ("3rps", [3, 0, 0, 0, 3, 0, 0]),
        ("stewart", [6, 0, 0, 0, 0, 0, 0]),
        ("watt", [1, 0, 0, 0, 2, 0, 0]),
        ("two-arm", [8, 2, 0, 6, 0, 0, 0]),
    ] {
        let chain = chain(&catalogue::load(name).unwrap());
        assert!(
            chain.closure_error.distance < 1e-12 && chain.closure_error.angle < 1e-12,
            "{name}: {:?}",
            chain.closure_error
        );
        assert_eq!(counts(&chain), expected, "{name}");
    }
    let delta = counts(&chain(&catalogue::load("delta").unwrap()));
    assert_eq!((delta[0] - delta[6], delta[4]), (3, 3), "delta: {delta:?}");
}

/// A tree is u = J q: the efficiencies are the squares of the singular values.
#[test]
fn trees_are_serial() {
    let mut random = Random(51);
    for robot in robots() {
        let state = robot.state(&random.q(&robot)).unwrap();
        let chain = ClosedChain::of(&state, Some(robot.tool()), Some(1.0)).unwrap();
        let got = kinematic(&chain);
        let j = state.jacobian(robot.tool(), ReferenceFrame::LocalWorldAligned).unwrap();
        let svd = Svd::of(&j);
        let expected: Vec<f64> = svd.values().filter(|s| *s > 1e-9).map(|s| s * s).collect();
        assert_eq!(got.len(), expected.len(), "{}", robot.name());
        for (g, e) in got.iter().zip(&expected) {
            assert!((g - e).abs() < 1e-9 * expected[0], "{}: {g} {e}", robot.name());
        }
    }
}

/// A spatial four-bar with parallel axes: one motion, three forces too many, wherever it is cut
/// and whether its last joint is a joint or a firm grasp.
#[test]
fn a_spatial_four_bar_is_hyperstatic() {
    use cylindroid::spatial::{Pose, Vec3};
    let at = |x: f64, y: f64| Pose::from_translation(Vec3::new(x, y, 0.0));
    let build = |closing: JointKind| {
        let mut b = Mechanism::builder("four-bar");
        let mut joint = |name: &str, parent: &str, child: &str, place: Pose| {
            b.joint(JointSpec {
                parent_from_joint: place,
                actuated: name == "q1",
                ..JointSpec::new(name, JointKind::Revolute, parent, child)
            });
        };
        joint("q1", "ground", "crank", at(0.0, 0.0));
        joint("q2", "crank", "coupler", at(0.0, 1.0));
        joint("q3", "coupler", "rocker", at(2.0, 0.5));
        b.loop_joint(LoopJointSpec {
            link_a_from_joint: at(0.0, -1.5),
            link_b_from_joint: at(2.0, 0.0),
            ..LoopJointSpec::new("q4", closing, "rocker", "ground")
        });
        b.reference("coupler");
        b.build().unwrap()
    };
    let four_bar = build(JointKind::Revolute);
    assert_eq!(counts(&chain(&four_bar)), [1, 0, 0, 0, 5, 3, 0]);
    // A ball joint leaves out the moments that were too many, but for one.
    let ball = build(JointKind::Spherical);
    assert_eq!(counts(&chain(&ball))[..1], [1]);
    assert_eq!(counts(&chain(&ball))[5], 1);
}

#[test]
fn loops_that_are_open_say_by_how_much() {
    let five_bar = catalogue::load("five-bar").unwrap();
    let mut q = five_bar.home().to_vec();
    q[0] += 0.1;
    let state = five_bar.state(&q).unwrap();
    let open = ClosedChain::of(&state, None, None).unwrap();
    assert!(open.closure_error.distance > 0.05, "{:?}", open.closure_error);
}

#[test]
fn bad_requests_are_refused() {
    let mut b = Mechanism::builder("ball loop");
    b.joint(JointSpec::new("q1", JointKind::Revolute, "ground", "a"));
    b.joint(JointSpec::new("q2", JointKind::Revolute, "a", "b"));
    b.loop_joint(LoopJointSpec {
        actuated: true,
        ..LoopJointSpec::new("ball", JointKind::Spherical, "b", "ground")
    });
    let m = b.build().unwrap();
    let refused = ClosedChain::of(&m.state(m.home()).unwrap(), None, None).unwrap_err();
    let Error::Model { culprit, message, .. } = refused else { panic!("{refused}") };
    assert!(culprit == "ball" && message.contains("one coordinate"), "{message}");
    let state = m.state(m.home()).unwrap();
    assert!(ClosedChain::of(&state, None, Some(0.0)).is_err());
    let other = catalogue::load("panda").unwrap();
    assert!(ClosedChain::of(&state, Some(other.tool()), None).is_err());
    // A contact alone makes a chain too: a hand that touches the ground.
    let mut b = Mechanism::builder("finger");
    b.joint(JointSpec::new("q1", JointKind::Revolute, "ground", "finger"));
    b.contact(ContactSpec::new("tip", ContactKind::HardFinger, "finger", "ground"));
    let finger = b.build().unwrap();
    let chain = ClosedChain::of(&finger.state(&[0.0]).unwrap(), None, None).unwrap();
    assert_eq!(Mobility::of(&chain.constraint).dof.dimension(), 1, "it turns about the point");
}

/// In a closed chain as many as the frame has degrees of freedom, not those of one leg; in a tree
/// the columns of the Jacobian.
#[test]
fn twists_of_frames() {
    for (name, dof) in [
        ("four-bar", 1),
        ("five-bar", 2),
        ("3rrr", 3),
        ("delta", 3),
        ("stewart", 6),
        ("watt", 1),
        ("two-arm", 6),
    ] {
        let m = catalogue::load(name).unwrap();
        let state = m.state(m.home()).unwrap();
        let twists = frame_twists(&state, m.reference()).unwrap();
        assert_eq!(twists.len(), dof, "{name}");
        // A delta's platform does not rotate.
        if name == "delta" {
            assert!(twists.iter().all(|t| t.angular.norm() < 1e-12));
        }
    }
    let robot = catalogue::load("ur5e").unwrap();
    let state = robot.state(&[0.1, -0.4, 0.7, 0.2, 0.9, -0.3]).unwrap();
    let j = state.jacobian(robot.tool(), ReferenceFrame::World).unwrap();
    let twists = frame_twists(&state, robot.tool()).unwrap();
    assert_eq!(twists.len(), 6);
    twists.iter().enumerate().for_each(|(c, t)| assert_eq!(j.column(c), t.to_array()));
}

/// Of a tree what its Jacobian spans; of a linkage the way that its reference really goes.
#[test]
fn motions_of_the_reference() {
    use cylindroid::closure::{ContinuationOptions, track_path};
    use cylindroid::screws::{Screw, ScrewOptions, ScrewSystem};
    use cylindroid::spatial::log;

    let options = ScrewOptions::with_length(1.0);
    for name in ["panda", "youbot", "3r"] {
        let robot = catalogue::load(name).unwrap();
        let q: Vec<f64> = (0..robot.n()).map(|i| 0.3 + 0.4 * i as f64).collect();
        let state = robot.state(&q).unwrap();
        let chain = ClosedChain::of(&state, None, None).unwrap();
        let system = ScrewSystem::of(&chain.reference_twists(&state), &options).unwrap();
        let j = state.jacobian(robot.reference(), ReferenceFrame::World).unwrap();
        let columns = ScrewSystem::of_columns(&j, &options).unwrap();
        assert_eq!(system.order(), columns.order(), "{name}");
        assert!(system.sine_to_system(&columns) < 1e-9, "{name}");
    }

    let linkage = catalogue::load("four-bar").unwrap();
    let start =
        track_path(&linkage, &[0.0; 3], &[0], &[0.4], ContinuationOptions::default()).unwrap().q;
    let state = linkage.state(&start).unwrap();
    let chain = ClosedChain::of(&state, None, None).unwrap();
    let [twist] = chain.reference_twists(&state)[..] else { panic!("one motion") };
    let h = 1e-5;
    let pose = |to: f64| {
        let way =
            track_path(&linkage, &start, &[0], &[to], ContinuationOptions::default()).unwrap();
        linkage.state(&way.q).unwrap().pose(linkage.reference()).unwrap()
    };
    let moved = log(pose(0.4 + h) * pose(0.4 - h).inverse());
    let (a, b) = (Screw::of(moved).unwrap(), Screw::of(twist).unwrap());
    // The centre of rotation, and that it is a rotation.
    assert!((a.axis.point - b.axis.point).norm() < 1e-6, "{a:?} and {b:?}");
    assert!(a.pitch.abs() < 1e-6 && b.pitch.abs() < 1e-12);
    let stewart = catalogue::load("stewart").unwrap();
    let state = stewart.state(stewart.home()).unwrap();
    assert_eq!(ClosedChain::of(&state, None, None).unwrap().reference_twists(&state).len(), 6);
}
