//! Options of `move` that the motion asked for would not use: refused, not ignored.

use crate::args::{LawName, MoveArgs};

/// Returns an error for the first of them; waypoints have times if `is_timed`.
pub(super) fn refuse(args: &MoveArgs, is_timed: bool) -> anyhow::Result<()> {
    let (path, servo) = (&args.path, &args.servo);
    let is_joint_move = path.joint_to.is_some();
    let is_path = path.line || path.via.is_some() || path.waypoints.is_some() || is_joint_move;
    let paths = "--line, --via, --waypoints or --joint-to";
    let without = [
        ("--duration", path.duration.is_some() && path.twist.is_none(), "--twist"),
        ("--law", path.law == LawName::JerkLimited && !is_path, "--line, --via or --joint-to"),
        ("--acceleration-linear", path.acceleration_linear.is_some() && !is_path, paths),
        ("--acceleration-angular", path.acceleration_angular.is_some() && !is_path, paths),
    ];
    if let Some((option, _, needed)) = without.into_iter().find(|(_, is_idle, _)| *is_idle) {
        anyhow::bail!("{option} has no effect without {needed}");
    }
    if servo.speed.is_some() && is_timed {
        anyhow::bail!(
            "--speed has no effect on --waypoints with times, from which speeds follow: omit it, or \
             leave the times out of the file"
        );
    }
    if servo.speed.is_some() && is_joint_move {
        anyhow::bail!(
            "--speed has no effect on --joint-to: omit it, or bound the velocities of joints with \
             --limits"
        );
    }
    let of_servos = [
        ("--gain", servo.gain.is_some()),
        ("--tolerance-position", servo.tolerance_position.is_some()),
        ("--tolerance-orientation", servo.tolerance_orientation.is_some()),
        ("--secondary", !servo.secondary.is_empty()),
        ("--inverse", args.inverse.named.is_given()),
        ("--fallback", args.inverse.fallback.is_some()),
    ];
    let given = of_servos.into_iter().find(|(_, is_given)| *is_given);
    if let Some((option, _)) = given.filter(|_| is_joint_move) {
        anyhow::bail!(
            "{option} has no effect on --joint-to, which moves joints straight: omit it, or move to \
             a pose (--to, --rpy)"
        );
    }
    let plant = servo.plant();
    let behind = [
        ("--delay", plant.delay),
        ("--time-constant", plant.time_constant),
        ("--noise", plant.noise),
    ];
    let given = behind.into_iter().find(|(_, value)| *value != 0.0);
    if let Some((option, _)) = given.filter(|_| is_joint_move) {
        anyhow::bail!(
            "{option} has no effect on --joint-to, which moves the joints of an ideal robot: omit \
             it, or move to a pose (--to, --rpy)"
        );
    }
    Ok(())
}
