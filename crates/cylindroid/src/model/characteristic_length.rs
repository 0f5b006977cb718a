//! Characteristic length of a mechanism: the length that stands beside one radian.
//!
//! Formula  features f at home: the axis lines of revolute, helical and cylindrical joints; the
//!          centres of universal and spherical joints; contact points; the reference point. Their
//!          centre c minimises the sum of their squared distances, `sum (1 - d d^T) (c - p) = 0`
//!          (d = 0 for points); L = 2 max distance from c
//! Units    m
//! Valid    any mechanism. Where all features meet in a point (a spherical wrist) or there is none
//!          (slides alone), the origins of the joint frames replace them, then the longest travel
//!          of a slide, then 1 m: no length of the mechanism enters its equations then
//! Why so   distances between lines and points are those of the mechanism, whatever the origin and
//!          the axes of the world, the order of the joints and the point on an axis at which a file
//!          draws a joint; the reference point makes the centre unique
//! Checked  tests/it/linkages/length.rs

use std::sync::Arc;

use super::joint::{JointKind, JointLocus};
use super::mechanism::Mechanism;
use crate::spatial::{Pose, Vec3};
use crate::tolerance::{COMMON_POINT, POSITION_ROUNDING};

/// A line, or a point where the direction is missing.
struct Feature {
    /// A joint has two frames, one on each link: they coincide unless a loop is open.
    weight: f64,
    point: Vec3,
    direction: Option<Vec3>,
}

impl Feature {
    /// The vector from the line or point to `x`, normal to the line.
    fn to(&self, x: Vec3) -> Vec3 {
        let from = x - self.point;
        self.direction.map_or(from, |d| from - d * d.dot(from))
    }
}

impl Mechanism {
    /// Characteristic length (m), which divides lengths wherever they stand beside angles: the
    /// extent of the mechanism at home. It does not depend on the frame, the order of the joints
    /// or the points at which their axes are drawn, and is proportional to the mechanism.
    ///
    /// ```text
    /// L = 2 max |distance of f from c|,   c minimises sum |distance of f from c|^2
    /// ```
    ///
    /// over the features f: axes of revolute, helical and cylindrical joints, centres of universal
    /// and spherical joints, contact points, and the reference point. Where they all meet in one
    /// point, or there are only slides: the same over the origins of the joints, otherwise the
    /// longest travel, otherwise 1 m.
    ///
    /// ```
    /// let arm = cylindroid::load("3r")?;
    /// assert!(arm.reach() > 0.0);
    /// # Ok::<(), cylindroid::Error>(())
    /// ```
    #[doc(alias = "characteristic length")]
    #[must_use]
    pub fn reach(&self) -> f64 {
        self.data.reach
    }

    /// Unit of the change of a coordinate: [`Mechanism::reach`] for lengths, otherwise 1, also for loop
    /// joints, whose places follow those of the coordinates.
    pub(crate) fn unit_of(&self, place: usize) -> f64 {
        match self.coordinates().get(place) {
            Some(c) if c.kind.is_length() => self.reach(),
            _ => 1.0,
        }
    }

    /// Largest distance of a joint from the origin of the world, at home (m).
    pub(crate) fn far_from_origin(&self) -> f64 {
        self.data.far
    }

    /// The same mechanism with the lengths of another one, of which it is an extension.
    pub(crate) fn with_lengths_of(mut self, other: &Self) -> Self {
        let data = Arc::make_mut(&mut self.data);
        (data.reach, data.far) = (other.data.reach, other.data.far);
        self
    }

    /// The same mechanism with its characteristic length, which depends on its home.
    pub(super) fn measured(mut self) -> Self {
        let [reach, far] = self.lengths();
        let data = Arc::make_mut(&mut self.data);
        (data.reach, data.far) = (reach, far);
        self
    }

    /// The characteristic length of this mechanism, see the module, and the largest distance of a
    /// joint from the origin of the world at home (m), whose rounding all positions have.
    fn lengths(&self) -> [f64; 2] {
        let links = self.link_poses(self.home());
        let reference = self.frame_of(self.reference());
        let reference = links[reference.link] * reference.link_from_frame.translation;
        // Relative to the reference: the world's origin may be far away.
        let at = |pose: Pose| Pose { translation: pose.translation - reference, ..pose };
        let mut features = vec![Feature { weight: 1.0, point: Vec3::ZERO, direction: None }];
        let mut origins = vec![Vec3::ZERO];
        let mut joint = |frame: Pose, kind: JointKind, axis: Vec3| {
            origins.push(frame.translation);
            let direction = match kind.locus() {
                JointLocus::Nowhere => return,
                JointLocus::Center => None,
                JointLocus::Axis => Some(frame.rotation * axis),
            };
            features.push(Feature { weight: 0.5, point: frame.translation, direction });
        };
        for j in self.joints() {
            // Free bodies have no place.
            if !matches!(j.kind, JointKind::Free | JointKind::Fixed) {
                joint(at(links[j.parent] * j.parent_from_joint), j.kind, j.axis);
                joint(at(links[j.child] * j.joint_from_child.inverse()), j.kind, j.axis);
            }
        }
        for l in self.loops() {
            joint(at(links[l.a] * l.link_a_from_joint), l.kind, l.axis);
            joint(at(links[l.b] * l.link_b_from_joint), l.kind, l.axis);
        }
        for c in self.contacts() {
            for frame in [links[c.a] * c.link_a_from_contact, links[c.b] * c.link_b_from_contact] {
                let point = at(frame).translation;
                features.push(Feature { weight: 0.5, point, direction: None });
                origins.push(point);
            }
        }
        let far = origins.iter().fold(0.0, |far: f64, p| far.max((*p + reference).norm()));
        let rounding = POSITION_ROUNDING * far;
        let points: Vec<Feature> = origins
            .into_iter()
            .map(|point| Feature { weight: 1.0, point, direction: None })
            .collect();
        let (lines, points) = (extent(&features), extent(&points));
        let travels = self.coordinates().iter().filter(|c| c.kind.is_length());
        let travel = travels
            .map(|c| c.limits.upper - c.limits.lower)
            .filter(|travel| travel.is_finite())
            .fold(0.0, f64::max);
        let length =
            [(lines, rounding.max(COMMON_POINT * points)), (points, rounding), (travel, 0.0)]
                .into_iter()
                .find(|(length, least)| length > least)
                .map_or(1.0, |(length, _)| length);
        [length, far]
    }
}

/// Twice the largest distance of the features from their centre; the first is a point.
fn extent(features: &[Feature]) -> f64 {
    // M c = b with M = sum (1 - d d^T), of eigenvalues at least 1.
    let mut columns = [Vec3::ZERO; 3];
    let mut b = Vec3::ZERO;
    for f in features {
        for (column, axis) in columns.iter_mut().zip([Vec3::X, Vec3::Y, Vec3::Z]) {
            *column += f.direction.map_or(axis, |d| axis - d * d.dot(axis)) * f.weight;
        }
        b -= f.to(Vec3::ZERO) * f.weight;
    }
    let [x, y, z] = columns;
    let normal = y.cross(z);
    let center =
        Vec3::new(b.dot(normal), x.dot(b.cross(z)), x.dot(y.cross(b))) * (1.0 / x.dot(normal));
    2.0 * features.iter().fold(0.0, |far: f64, f| far.max(f.to(center).norm()))
}
