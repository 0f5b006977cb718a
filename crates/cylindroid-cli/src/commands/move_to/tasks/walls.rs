//! Tables of half-spaces and boxes in files of tasks.

use cylindroid::control::HalfSpace;
use cylindroid::spatial::Rpy;
use cylindroid::{EndEffector, Error, Mechanism, Pose, Result, Vec3};
use serde::Deserialize;

/// `[[half_space]]`: a frame stays on the side of a plane to which the normal points.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Plane {
    name: Option<String>,
    frame: String,
    point: [f64; 3],
    normal: [f64; 3],
    #[serde(default)]
    tool: [f64; 3],
}

/// `[[box]]`: a frame stays inside a box.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Box {
    name: Option<String>,
    frame: String,
    center: [f64; 3],
    size: [f64; 3],
    #[serde(default)]
    rpy: [f64; 3],
    #[serde(default)]
    tool: [f64; 3],
}

fn end_effector(robot: &Mechanism, frame: &str, tool: [f64; 3]) -> Result<EndEffector> {
    let frame_from_tool = Pose::from_translation(Vec3::from_array(tool));
    Ok(EndEffector { frame: robot.frame(frame)?, frame_from_tool })
}

impl Plane {
    pub(super) fn half_space(&self, robot: &Mechanism) -> Result<HalfSpace> {
        Ok(HalfSpace {
            name: self.name.clone().unwrap_or_else(|| format!("half-space of {}", self.frame)),
            end_effector: end_effector(robot, &self.frame, self.tool)?,
            point: Vec3::from_array(self.point),
            normal: Vec3::from_array(self.normal),
        })
    }
}

impl Box {
    pub(super) fn half_spaces(&self, robot: &Mechanism) -> Result<[HalfSpace; 6]> {
        let end_effector = end_effector(robot, &self.frame, self.tool)?;
        let [roll, pitch, yaw] = self.rpy;
        let rotation = Rpy { roll, pitch, yaw }.rotation();
        let center = Pose { rotation, translation: Vec3::from_array(self.center) };
        self.size.iter().try_for_each(|side| Error::check_positive("side of a box", *side))?;
        let name = self.name.clone().unwrap_or_else(|| format!("box of {}", self.frame));
        let size = Vec3::from_array(self.size);
        Ok(HalfSpace::inside_box(&name, end_effector, center, size))
    }
}
