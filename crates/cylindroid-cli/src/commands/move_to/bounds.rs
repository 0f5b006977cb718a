//! The bounds that a motion keeps to: of the arguments, or defaults.

use cylindroid::control::{CartesianBounds, JointDefaults, KinematicBounds};

use crate::args::{LawName, MoveArgs};

/// Speeds on a path where none are given [m/s], [rad/s].
const PATH_SPEED: (f64, f64) = (0.25, 1.0);

/// What joints keep to that have no limits of their own in the model.
pub(super) fn joint_defaults(args: &MoveArgs) -> JointDefaults {
    let path = &args.path;
    let jerk = |value: f64| match path.law {
        LawName::Trapezoidal => f64::INFINITY,
        LawName::JerkLimited => value,
    };
    let acceleration = |on_path: f64| args.servo.acceleration.unwrap_or(on_path);
    JointDefaults {
        angle: KinematicBounds {
            velocity: PATH_SPEED.1,
            acceleration: acceleration(path.acceleration_angular),
            jerk: jerk(path.jerk_angular),
        },
        length: KinematicBounds {
            velocity: PATH_SPEED.0,
            acceleration: acceleration(path.acceleration_linear),
            jerk: jerk(path.jerk_linear),
        },
    }
}

pub(super) fn path_bounds(args: &MoveArgs) -> CartesianBounds {
    let (path, speed) = (&args.path, args.servo.speed);
    let jerk = |value: f64| match path.law {
        LawName::Trapezoidal => f64::INFINITY,
        LawName::JerkLimited => value,
    };
    CartesianBounds {
        linear: KinematicBounds {
            velocity: speed.map_or(PATH_SPEED.0, |s| s.linear),
            acceleration: path.acceleration_linear,
            jerk: jerk(path.jerk_linear),
        },
        angular: KinematicBounds {
            velocity: speed.and_then(|s| s.angular).unwrap_or(PATH_SPEED.1),
            acceleration: path.acceleration_angular,
            jerk: jerk(path.jerk_angular),
        },
    }
}
