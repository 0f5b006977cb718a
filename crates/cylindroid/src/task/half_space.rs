//! Half-spaces and boxes that tool points must not leave.
//!
//! Formula  d = n^T (p - p_0) / |n|, d' = n^T J_v q' / |n| >= -v(d), v the velocity from which the
//!          point stops within d
//! Units    m
//! Checked  tests/it/servo/task_kinds.rs::half_spaces_are_not_left

use super::check_pose;
use crate::error::{Error, Result};
use crate::kinematics::{EndEffector, ReferenceFrame, State};
use crate::linalg::Matrix;
use crate::model::Mechanism;
use crate::spatial::{Pose, Vec3};
use crate::tolerance::MAX_MAGNITUDE;

/// A half-space of the world that a tool point must not leave.
#[derive(Debug, Clone, PartialEq)]
#[doc(alias = "virtual wall")]
#[doc(alias = "workspace limit")]
pub struct HalfSpace {
    /// The name in reports.
    pub name: String,
    /// The frame and the tool point.
    pub end_effector: EndEffector,
    /// A point of the bounding plane, in the world (m).
    pub point: Vec3,
    /// A normal of that plane, of any length, towards the inside.
    pub normal: Vec3,
}

impl HalfSpace {
    /// The six half-spaces of a box around `center`, of this size (m) along its axes.
    ///
    /// ```
    /// use cylindroid::control::HalfSpace;
    /// use cylindroid::{Pose, Vec3};
    ///
    /// let panda = cylindroid::load("panda")?;
    /// let center = Pose::from_translation(Vec3::new(0.5, 0.0, 0.4));
    /// let walls = HalfSpace::inside_box("table", panda.tool().into(), center, Vec3::new(0.4, 0.6, 0.5));
    /// assert_eq!(walls[1].name, "table +x");
    /// assert!((walls[1].point.x - 0.7).abs() < 1e-15 && walls[1].normal.x == -1.0);
    /// # Ok::<(), cylindroid::Error>(())
    /// ```
    #[must_use]
    pub fn inside_box(
        name: &str,
        end_effector: EndEffector,
        center: Pose,
        size: Vec3,
    ) -> [Self; 6] {
        Self::sides_of_box(name, center, size).map(|(name, point, normal)| Self {
            name,
            end_effector,
            point,
            normal,
        })
    }

    /// Name, point and normal of the six half-spaces of a box.
    #[must_use]
    pub fn sides_of_box(name: &str, center: Pose, size: Vec3) -> [(String, Vec3, Vec3); 6] {
        let (names, size) = (["x", "y", "z"], size.to_array());
        std::array::from_fn(|i| {
            let (axis, sign) = (i / 2, if i % 2 == 0 { -1.0 } else { 1.0 });
            let mut direction = [0.0; 3];
            direction[axis] = sign;
            let outwards = center.rotation * Vec3::from_array(direction);
            let name = format!("{name} {}{}", if sign > 0.0 { '+' } else { '-' }, names[axis]);
            (name, center.translation + outwards * (0.5 * size[axis]), Vec3::ZERO - outwards)
        })
    }

    pub(crate) fn check(&self, mechanism: &Mechanism) -> Result<()> {
        mechanism.check_frame(self.end_effector.frame)?;
        let what = |part: &str| format!("{part} of the half-space '{}'", self.name);
        check_pose(&what("tool"), &self.end_effector.frame_from_tool)?;
        Error::check_within(&what("point"), &self.point.to_array(), MAX_MAGNITUDE)?;
        Error::check_finite(&what("normal"), &self.normal.to_array())?;
        if self.normal.norm() > 0.0 {
            return Ok(());
        }
        Err(Error::InvalidOption {
            option: "half_spaces",
            value: self.name.clone(),
            reason: "its normal is zero; give a direction towards the inside".to_owned(),
        })
    }

    /// The unit normal towards the inside.
    fn inwards(&self) -> Vec3 {
        self.normal * self.normal.norm().recip()
    }

    /// The distance inside (m, negative outside).
    pub(crate) fn room(&self, state: &State) -> f64 {
        self.inwards().dot(state.pose_of(self.end_effector).translation - self.point)
    }

    /// The gradient of the distance over the n coordinates; `jacobian` is memory, 6 x n.
    pub(crate) fn gradient_into(&self, state: &State, jacobian: &mut Matrix, gradient: &mut [f64]) {
        let normal = self.inwards();
        state.tip(self.end_effector).jacobian_into(ReferenceFrame::LocalWorldAligned, jacobian);
        for (j, g) in gradient.iter_mut().enumerate() {
            let column = jacobian.column(j);
            *g = normal.x * column[0] + normal.y * column[1] + normal.z * column[2];
        }
    }
}
