//! What the builder refuses, and what limits mean.

use cylindroid::model::{JointKind, JointSpec, Limits};
use cylindroid::{Error, Mechanism};

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
            assert!(error.contains("'ball'") && error.contains("in a row"), "{error}");
        }
        // Rates are what they say, so their limits are kept.
        let limits = Limits { velocity: 1.0, acceleration: 2.0, ..Limits::NONE };
        let joint = JointSpec { limits, ..JointSpec::new("ball", kind, "a", "b") };
        assert_eq!(build([joint]).unwrap().coordinates()[0].limits, limits);
    }
}
