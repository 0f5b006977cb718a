//! The arguments of `move` for several tasks and for distances to other bodies.

use std::path::PathBuf;
use std::str::FromStr;

use clap::Args;
use cylindroid::spatial::Rpy;
use cylindroid::{Pose, Rotation, Vec3};

use super::CollisionArgs;
use crate::values::List;

#[derive(Debug, Args)]
#[command(next_help_heading = "Several tasks")]
pub(crate) struct TasksArgs {
    /// File of tasks with priorities and weights, see below
    #[arg(long, value_name = "FILE.toml")]
    pub(crate) tasks: Option<PathBuf>,

    /// Keep links at a distance from each other and from obstacles
    #[arg(long)]
    pub(crate) avoid: bool,

    /// Least distance that --avoid keeps [m] [default: 0.01]
    #[arg(long, value_name = "M", allow_hyphen_values = true)]
    pub(crate) gap: Option<f64>,

    /// Only pairs closer than this count in --avoid [m] [default: 0.3]
    #[arg(long, value_name = "M", allow_hyphen_values = true)]
    pub(crate) margin: Option<f64>,

    /// Where limits or distances stop a task, least squares of what is missed in place of a motion
    /// that is shortened and keeps its direction: smaller errors, off the line
    #[arg(long)]
    pub(crate) least_squares: bool,

    #[command(flatten)]
    pub(crate) collision: CollisionArgs,
}

impl TasksArgs {
    /// True if distances are to be kept.
    pub(crate) fn avoids(&self) -> bool {
        self.avoid || !self.collision.obstacle.is_empty()
    }

    /// An option that has no effect without distances to keep, if one is given.
    pub(crate) fn without_effect(&self) -> Option<&'static str> {
        let given = [
            ("--gap", self.gap.is_some()),
            ("--margin", self.margin.is_some()),
            ("--meshes", self.collision.meshes.is_some()),
            ("--samples", self.collision.samples.is_some()),
        ];
        let found = given.into_iter().find(|(_, is_given)| *is_given && !self.avoids());
        found.map(|(option, _)| option)
    }
}

/// A task of a frame as an argument: `hand=0.4,0.1,0.5` or `hand=0.4,0.1,0.5,3.14,0,0`.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct FrameTaskArg {
    pub(crate) frame: String,
    pub(crate) position: Vec3,
    /// Roll, pitch, yaw; the orientation is free without them.
    pub(crate) rpy: Option<[f64; 3]>,
}

impl FromStr for FrameTaskArg {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let help = "write FRAME=X,Y,Z or FRAME=X,Y,Z,ROLL,PITCH,YAW";
        let (frame, numbers) = text.split_once('=').ok_or(help)?;
        let List(numbers) = numbers.parse()?;
        let (position, rpy) = match numbers[..] {
            [x, y, z] => (Vec3::new(x, y, z), None),
            [x, y, z, roll, pitch, yaw] => (Vec3::new(x, y, z), Some([roll, pitch, yaw])),
            _ => return Err(format!("{} numbers given; {help}", numbers.len())),
        };
        if frame.trim().is_empty() {
            return Err(help.to_owned());
        }
        Ok(Self { frame: frame.trim().to_owned(), position, rpy })
    }
}

impl FrameTaskArg {
    /// The target; angles are in degrees if `degrees` is set.
    pub(crate) fn target(&self, degrees: bool) -> Pose {
        let si = |x: f64| if degrees { x.to_radians() } else { x };
        let rotation = self.rpy.map_or(Rotation::IDENTITY, |rpy| {
            let [roll, pitch, yaw] = rpy.map(si);
            Rpy { roll, pitch, yaw }.rotation()
        });
        Pose { rotation, translation: self.position }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tasks_have_a_frame_and_a_target() {
        let task: FrameTaskArg = "a hand=0.4,-0.1,0.5".parse().unwrap();
        assert_eq!((task.frame.as_str(), task.rpy), ("a hand", None));
        assert_eq!(task.target(false), Pose::from_translation(Vec3::new(0.4, -0.1, 0.5)));
        let task: FrameTaskArg = "hand=0,0,1,0,0,90".parse().unwrap();
        let quarter = Vec3::Z * std::f64::consts::FRAC_PI_2;
        assert!((task.target(true).rotation.log() - quarter).norm() < 1e-15);
        for (broken, word) in
            [("=1,2,3", "FRAME"), ("hand=1,2", "2 numbers"), ("hand=a,b,c", "number")]
        {
            assert!(broken.parse::<FrameTaskArg>().unwrap_err().contains(word), "{broken}");
        }
    }
}
