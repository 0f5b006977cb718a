//! What the builder refuses, and what limits mean.

use cylindroid::model::{JointKind, JointSpec, Limits, Mimic};
use cylindroid::{Error, Mechanism, Vec3};

/// The mechanism of these joints, one after the other.
fn build(joints: impl IntoIterator<Item = JointSpec>) -> Result<Mechanism, Error> {
    let mut b = Mechanism::builder("test");
    for joint in joints {
        b.joint(joint);
    }
    b.build()
}

#[test]
fn position_limits_of_rotation_vectors_are_refused() {
    for kind in [JointKind::Spherical, JointKind::Free] {
        for (lower, upper) in [(-1.0, 1.0), (-1.0, f64::INFINITY), (f64::NEG_INFINITY, 1.0)] {
            let limits = Limits { lower, upper, ..Limits::NONE };
            let joint = JointSpec { limits, ..JointSpec::new("ball", kind, "a", "b") };
            let error = build([joint]).unwrap_err().to_string();
            assert!(error.contains("'ball'") && error.contains("in series"), "{error}");
        }
        // Rates are what they say, so their limits are kept.
        let limits = Limits { velocity: 1.0, acceleration: 2.0, ..Limits::NONE };
        let joint = JointSpec { limits, ..JointSpec::new("ball", kind, "a", "b") };
        assert_eq!(build([joint]).unwrap().coordinates()[0].limits, limits);
    }
}

#[test]
fn limits_leave_a_finite_position() {
    for end in [f64::INFINITY, f64::NEG_INFINITY] {
        let limits = Limits { lower: end, upper: end, ..Limits::NONE };
        let joint = JointSpec { limits, ..JointSpec::new("far", JointKind::Revolute, "a", "b") };
        let error = build([joint]).unwrap_err().to_string();
        assert!(error.contains("'far'") && error.contains("every finite position"), "{error}");
    }
    // Also where a follower would leave none: it is noted, and the limits of the leader hold.
    let follower = JointSpec {
        mimic: Some(Mimic { joint: "leader".into(), multiplier: 1e-200, offset: 0.0 }),
        limits: Limits { lower: 1e115, upper: f64::INFINITY, ..Limits::NONE },
        ..JointSpec::new("follower", JointKind::Revolute, "b", "c")
    };
    let leader = JointSpec::new("leader", JointKind::Revolute, "a", "b");
    let m = build([leader, follower]).unwrap();
    assert_eq!((m.coordinates()[0].limits, m.home()), (Limits::NONE, &[0.0][..]));
    assert!(m.report().ignored[0].what.contains("follower"), "{:?}", m.report());
}

#[test]
fn axes_of_any_length_are_parallel_or_not() {
    let universal = |axis, second| {
        let kind = JointKind::Universal { second };
        build([JointSpec { axis, ..JointSpec::new("cross", kind, "a", "b") }])
    };
    assert!(universal(Vec3::X * 1e-6, Vec3::Y * 1e-6).is_ok());
    let error = universal(Vec3::X * 1e6, Vec3::new(1e6, 1e-4, 0.0)).unwrap_err().to_string();
    assert!(error.contains("'cross'") && error.contains("parallel"), "{error}");
}
