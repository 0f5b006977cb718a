//! The bounds that a motion keeps to: of the arguments, or defaults.

use cylindroid::control::{CartesianBounds, JointDefaults, KinematicBounds, SpeedLimit};
use cylindroid::{Error, Result};

use crate::args::{LawName, MoveArgs, PathArgs};

/// Speeds on a path where none are given [m/s], [rad/s].
const PATH_SPEED: (f64, f64) = (0.25, 1.0);
/// Accelerations on a path where none are given [m/s^2], [rad/s^2].
const PATH_ACCELERATION: (f64, f64) = (1.0, 4.0);
/// Jerks on a path where none are given [m/s^3], [rad/s^3].
const PATH_JERK: (f64, f64) = (10.0, 40.0);

/// Linear and angular jerk of the time law.
fn jerks(path: &PathArgs) -> (f64, f64) {
    match path.law {
        LawName::Trapezoidal => (f64::INFINITY, f64::INFINITY),
        LawName::JerkLimited => {
            (path.jerk_linear.unwrap_or(PATH_JERK.0), path.jerk_angular.unwrap_or(PATH_JERK.1))
        }
    }
}

/// Refuses a jerk for a law that does not bound it.
pub(super) fn check_jerks(path: &PathArgs) -> Result<()> {
    let given = [("--jerk-linear", path.jerk_linear), ("--jerk-angular", path.jerk_angular)];
    let Some((option, value)) = given.into_iter().find_map(|(o, j)| Some((o, j?))) else {
        return Ok(());
    };
    if path.law == LawName::JerkLimited {
        return Ok(());
    }
    Err(Error::InvalidOption {
        option,
        value: value.to_string(),
        reason: "the trapezoidal law does not bound the jerk; add --law jerk-limited".to_owned(),
    })
}

/// Limits of joints that have none of their own in the model.
pub(super) fn joint_defaults(args: &MoveArgs) -> JointDefaults {
    let path = &args.path;
    let most = args.servo.jerk.unwrap_or(f64::INFINITY);
    let (jerk_linear, jerk_angular) = jerks(path);
    let finite = args.servo.acceleration.filter(|a| a.is_finite());
    let acceleration = |on_path: f64| finite.unwrap_or(on_path);
    JointDefaults {
        angle: KinematicBounds {
            velocity: PATH_SPEED.1,
            acceleration: acceleration(path.acceleration_angular.unwrap_or(PATH_ACCELERATION.1)),
            jerk: jerk_angular.min(most),
        },
        length: KinematicBounds {
            velocity: PATH_SPEED.0,
            acceleration: acceleration(path.acceleration_linear.unwrap_or(PATH_ACCELERATION.0)),
            jerk: jerk_linear.min(most),
        },
    }
}

/// The largest speeds of the tool on a path, also where it falls behind and catches up.
pub(super) fn speed_of(bounds: &CartesianBounds) -> SpeedLimit {
    SpeedLimit { linear: bounds.linear.velocity, angular: bounds.angular.velocity }
}

/// Bounds of the target on a path.
pub(super) fn path_bounds(args: &MoveArgs) -> CartesianBounds {
    let (path, speed) = (&args.path, args.servo.speed);
    let (jerk_linear, jerk_angular) = jerks(path);
    CartesianBounds {
        linear: KinematicBounds {
            velocity: speed.map_or(PATH_SPEED.0, |s| s.linear),
            acceleration: path.acceleration_linear.unwrap_or(PATH_ACCELERATION.0),
            jerk: jerk_linear,
        },
        angular: KinematicBounds {
            velocity: speed.and_then(|s| s.angular).unwrap_or(PATH_SPEED.1),
            acceleration: path.acceleration_angular.unwrap_or(PATH_ACCELERATION.1),
            jerk: jerk_angular,
        },
    }
}
