//! The characteristic length: of every mechanism, whatever the frame, order and drawn points.

use cylindroid::closure::{Diagnosis, FiniteMobility, LimbScrews};
use cylindroid::ik::{Goal, IkOptions, solve};
use cylindroid::linalg::Svd;
use cylindroid::model::{Geometry, JointKind, JointSpec, Limits, Visual};
use cylindroid::screws::ScrewOptions;
use cylindroid::spatial::{Pose, Rotation, Twist, Vec3};
use cylindroid::{Error, Mechanism, ReferenceFrame, ScrewSystem, ServoOptions, catalogue};

use crate::support::assert_close;

/// Of one joint between ground and a link, whose frame is at `tip`.
fn single(kind: JointKind, base: Vec3, tip: Vec3, limits: Limits) -> f64 {
    let mut b = Mechanism::builder("single");
    b.joint(JointSpec {
        parent_from_joint: Pose::from_translation(base),
        limits,
        ..JointSpec::new("q1", kind, "ground", "link")
    });
    b.frame("tip", "link", Pose::from_translation(tip)).reference("tip");
    b.build().unwrap().reach()
}

#[test]
fn every_mechanism_has_one() {
    let far = Vec3::new(70.0, -50.0, 20.0);
    let tip = Vec3::new(0.3, 0.4, 0.7);
    for base in [Vec3::ZERO, far] {
        // One axis: the distance from it to the reference, whatever the height.
        let one = single(JointKind::Revolute, base, tip, Limits::NONE);
        assert_close("one axis", &[one], &[0.5], 1e-12);
        // On the axis: the distance along it, from where the joint is drawn.
        let along = single(JointKind::Revolute, base, Vec3::Z, Limits::NONE);
        assert_close("on the axis", &[along], &[4.0 / 3.0], 1e-12);
        // A slide: the reference and the origins of its frames.
        let slide = single(JointKind::Prismatic, base, tip, Limits::NONE);
        assert!(slide > 0.5 && slide < 2.0, "{slide}");
        // A slide at the reference: its travel.
        let travel = Limits { lower: -0.1, upper: 0.4, ..Limits::NONE };
        let slide = single(JointKind::Prismatic, base, Vec3::ZERO, travel);
        assert_close("travel", &[slide], &[0.5], 1e-15);
        // A sphere about the reference: no length.
        let sphere = single(JointKind::Spherical, base, Vec3::ZERO, Limits::NONE);
        assert!(sphere == 1.0, "{sphere}");
    }
    // A floating base does not add its place.
    let mut b = Mechanism::builder("floating");
    b.joint(JointSpec {
        parent_from_joint: Pose::from_translation(far),
        ..JointSpec::new("root", JointKind::Free, "world", "base")
    });
    b.joint(JointSpec {
        parent_from_joint: Pose::from_translation(Vec3::X),
        ..JointSpec::new("q1", JointKind::Revolute, "base", "link")
    });
    b.frame("tip", "link", Pose::from_translation(tip)).reference("tip");
    assert_close("floating", &[b.build().unwrap().reach()], &[0.5], 1e-12);
    for name in catalogue::names() {
        let length = catalogue::load(name).unwrap().reach();
        assert!(length > 0.1 && length < 10.0, "{name}: {length}");
    }
}

/// The point on an axis at which a joint is drawn says nothing about the mechanism.
#[test]
fn it_does_not_depend_on_the_drawn_points() {
    let of = |slid: f64| {
        let mut b = Mechanism::builder("slid");
        let tilt = Rotation::about(Vec3::X, 0.4).unwrap();
        let first = Pose { rotation: tilt, translation: Vec3::new(0.2, 0.1, 0.0) };
        let along = |z: f64| Pose::from_translation(Vec3::Z * z);
        b.joint(JointSpec {
            parent_from_joint: first * along(slid),
            joint_from_child: along(-slid),
            ..JointSpec::new("q1", JointKind::Revolute, "ground", "a")
        });
        b.joint(JointSpec {
            parent_from_joint: Pose::from_translation(Vec3::X) * along(2.0 * slid),
            joint_from_child: along(-2.0 * slid),
            ..JointSpec::new("q2", JointKind::Revolute, "a", "b")
        });
        b.frame("tip", "b", Pose::from_translation(Vec3::Y)).reference("tip");
        b.build().unwrap().reach()
    };
    assert_close("slid", &[of(0.3), of(-5.0)], &[of(0.0), of(0.0)], 1e-12);
}

/// Two axes that meet but for a rounding, with a tool at this distance.
fn pan_and_tilt(rounding: f64, tool: f64) -> cylindroid::Result<Mechanism> {
    let mut b = Mechanism::builder("head");
    for (name, parent, child, axis) in [("pan", "base", "a", Vec3::Z), ("tilt", "a", "b", Vec3::Y)]
    {
        b.joint(JointSpec {
            axis,
            parent_from_joint: Pose::from_translation(Vec3::X * rounding),
            ..JointSpec::new(name, JointKind::Revolute, parent, child)
        });
    }
    b.frame("camera", "b", Pose::from_translation(Vec3::X * tool)).reference("b");
    b.build()
}

#[test]
fn roundings_are_no_lengths() {
    for rounding in [0.0, 6.1e-17, 1e-30, 1e-300, 5e-324] {
        let head = pan_and_tilt(rounding, 0.1).unwrap();
        assert!(head.reach() == 1.0, "{rounding:e}: {}", head.reach());
        let camera = head.with_tool("camera").unwrap().reach();
        assert!(camera > 0.05 && camera < 0.5, "{rounding:e}: {camera}");
    }
    assert!(pan_and_tilt(0.0, 0.0).unwrap().reach() == 1.0);
}

/// What sums and sines of metres leave is no length either where there is no other; a report of the
/// extent is that of a mechanism without lengths.
#[test]
fn roundings_alone_are_no_lengths() {
    let half_turn = std::f64::consts::PI;
    let residues = [
        (0.5 * half_turn).cos(),
        0.3 * half_turn.sin(),
        0.1 + 0.2 - 0.3,
        1.0 - 0.9 - 0.1,
        1e-15,
        -1e-17,
    ];
    for residue in residues {
        let plain = pan_and_tilt(0.0, 0.0).unwrap();
        for (rounding, tool) in [(residue, 0.0), (0.0, residue), (residue, residue)] {
            let head = pan_and_tilt(rounding, tool).unwrap();
            assert!(head.reach() == 1.0, "{residue:e}: {}", head.reach());
            let q = [0.3, -0.4];
            let turn = |m: &Mechanism| {
                let state = m.state(&q).unwrap();
                let jacobian = state.jacobian(m.tool(), ReferenceFrame::World).unwrap();
                Svd::of(&jacobian).rank(1e-9).rank
            };
            assert_eq!(turn(&head), turn(&plain), "{residue:e}");
        }
    }
}

/// Lengths that are all too short are those of another unit.
#[test]
fn mechanisms_without_a_size_are_refused() {
    for (rounding, tool) in [(1.1e-15, 0.0), (1e-30, 2e-30), (0.0, 5e-324), (0.0, -9e-13)] {
        let error = pan_and_tilt(rounding, tool).unwrap_err();
        let longest = format!("longest length is {:e} m", f64::max(rounding, tool.abs()));
        let message = error.to_string();
        assert!(message.contains("'head'") && message.contains(&longest), "{message}");
    }
    // A shape is a length too.
    let mut b = Mechanism::builder("ball");
    b.joint(JointSpec {
        parent_from_joint: Pose::from_translation(Vec3::X * 6.1e-14),
        ..JointSpec::new("turn", JointKind::Revolute, "base", "ball")
    });
    assert!(b.clone().build().is_err());
    let geometry = Geometry::Sphere { radius: 0.1 };
    b.collision("ball", Visual { geometry, ..Visual::default() });
    assert!(b.build().is_ok());
    // Nanometres work.
    let small = pan_and_tilt(1e-9, 1e-9).unwrap().reach();
    assert!(small > 0.5e-9 && small < 4e-9, "{small}");
}

/// Ranks are those of the mechanism at all lengths of about its size; others are refused, as are
/// lengths that no mechanism has.
#[test]
fn lengths_of_another_size_are_refused() {
    for name in catalogue::names() {
        let m = catalogue::load(name).unwrap();
        let state = m.state(m.home()).unwrap();
        let of = |length: f64| {
            let diagnosis = Diagnosis::of(&state, None, Some(length))?;
            let finite = FiniteMobility::of(&state, Some(length))?;
            Ok((diagnosis.counts, finite.infinitesimal))
        };
        let own = of(m.reach()).unwrap();
        for factor in [1.1e-5, 1e-3, 0.1, 7.0, 1e3, 0.9e5] {
            assert_eq!(of(factor * m.reach()).unwrap(), own, "{name}, {factor:e}");
        }
        for length in [0.9e-5 * m.reach(), 1.1e5 * m.reach(), 1e300, 1e-300, 0.0, -1.0, f64::NAN] {
            let refused: cylindroid::Result<_> = of(length);
            let Error::InvalidOption { option: "length", reason, .. } = refused.unwrap_err() else {
                panic!("{name}, {length}")
            };
            assert!(reason.contains(name), "{reason}");
            assert!(LimbScrews::of(&state, None, Some(length)).is_err(), "{name}, {length}");
            let options = IkOptions { length: Some(length), ..IkOptions::default() };
            if !m.is_closed() {
                let target = state.pose(m.tool()).unwrap();
                assert!(solve(&m, &[Goal::pose(m.tool(), target)], &options).is_err(), "{name}");
                let options = ServoOptions { length, ..ServoOptions::new(&m) };
                assert!(options.check(&m).is_err(), "{name}, {length}");
            }
        }
    }
    let twist = Twist { linear: Vec3::X, angular: Vec3::Z };
    for length in [0.9e-12, 1.1e120, f64::INFINITY, f64::NAN, 0.0, -1.0] {
        let refused = ScrewSystem::of(&[twist], &ScrewOptions::with_length(length)).unwrap_err();
        assert!(matches!(refused, Error::InvalidOption { option: "length", .. }), "{refused}");
    }
    let center = Some(Vec3::new(0.0, 0.0, 1.1e120));
    let far = ScrewOptions { center, ..ScrewOptions::default() };
    let refused = ScrewSystem::of(&[twist], &far).unwrap_err();
    assert!(matches!(refused, Error::OutOfRange { .. }), "{refused}");
}
