//! Characteristic length of a mechanism: the length that stands beside one radian.
//!
//! Formula  features f at home: the axis lines of revolute, helical and cylindrical joints; the
//!          centres of universal and spherical joints; contact points; the reference point. Their
//!          centre c minimises the sum of their squared distances, `sum (1 - d d^T) (c - p) = 0`
//!          (d = 0 for points); L = 2 max distance from c
//! Units    m
//! Valid    any mechanism; lengths below MIN_LENGTH are roundings and count as zero. Where all features
//!          meet in a point (a spherical wrist) or there is none (slides alone), the origins of the joint frames replace them, then the longest travel
//!          of a slide, then 1 m: no length of the mechanism enters its equations then
//! Fails    if a length is not zero, none is as long as MIN_LENGTH, and the longest is not what a
//!          rounding of a metre leaves (ROUNDED_LENGTHS): pan and tilt by `cos(pi / 2)` are a mechanism
//!          without lengths
//! Why so   distances between lines and points are those of the mechanism, whatever the origin and
//!          the axes of the world, the order of the joints and the point on an axis at which a file
//!          draws a joint; the reference point makes the centre unique
//! Checked  tests/it/linkages/length.rs

use std::sync::Arc;

use super::joint::{JointKind, JointLocus};
use super::link::Geometry;
use super::mechanism::Mechanism;
use crate::error::{Error, Result, number_text};
use crate::spatial::{Pose, Vec3};
use crate::tolerance::{
    COMMON_POINT, LENGTH_RATIO, MAX_MAGNITUDE, MIN_LENGTH, POSITION_ROUNDING, ROUNDED_LENGTHS,
};

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

    /// The characteristic length of the mechanism, or another one of similar size (m).
    ///
    /// # Errors
    /// [`Error::InvalidOption`] for one that is not within a factor of [`LENGTH_RATIO`].
    pub(crate) fn length_or(&self, length: Option<f64>) -> Result<f64> {
        let own = self.reach();
        let Some(length) = length else { return Ok(own) };
        if (own / LENGTH_RATIO..=own * LENGTH_RATIO).contains(&length) {
            return Ok(length);
        }
        Err(Error::InvalidOption {
            option: "length",
            value: number_text(length),
            reason: format!(
                "that of '{}' is {own} m: another must be within a factor of {LENGTH_RATIO:e} of it, \
                 or ranks would be those of roundings",
                self.name()
            ),
        })
    }

    /// Unit of the change of a coordinate: [`Mechanism::reach`] for lengths, otherwise 1. The places of
    /// actuated loop joints follow those of the coordinates.
    pub(crate) fn unit_of(&self, place: usize) -> f64 {
        let is_length = match self.coordinates().get(place) {
            Some(c) => c.kind.is_length(),
            None => {
                let mut joints = self.loops().iter().filter(|l| l.actuated);
                let joint = joints.nth(place - self.n());
                joint.is_some_and(|l| l.kind == JointKind::Prismatic)
            }
        };
        if is_length { self.reach() } else { 1.0 }
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
        let rounding = MIN_LENGTH.max(POSITION_ROUNDING * far);
        let points: Vec<Feature> = origins
            .into_iter()
            .map(|point| Feature { weight: 1.0, point, direction: None })
            .collect();
        let (lines, points) = (extent(&features), extent(&points));
        let travel = self.travels().fold(0.0, f64::max);
        let length = [
            (lines, rounding.max(COMMON_POINT * points)),
            (points, rounding),
            (travel, MIN_LENGTH),
        ]
        .into_iter()
        .find(|(length, least)| length > least)
        .map_or(1.0, |(length, _)| length);
        [length, far]
    }

    /// Those of slides between two limits (m).
    fn travels(&self) -> impl Iterator<Item = f64> {
        let slides = self.coordinates().iter().filter(|c| c.kind.is_length());
        slides.map(|c| c.limits.upper - c.limits.lower).filter(|travel| travel.is_finite())
    }

    /// Refuses a mechanism that has lengths, all of them below [`MIN_LENGTH`]; short ones beside others
    /// are roundings, and so are [`ROUNDED_LENGTHS`].
    pub(super) fn check_size(&self) -> Result<()> {
        let joints = self.joints().iter().flat_map(|j| [j.parent_from_joint, j.joint_from_child]);
        let loops = self.loops().iter().flat_map(|l| [l.link_a_from_joint, l.link_b_from_joint]);
        let contacts = self.contacts().iter();
        let contacts = contacts.flat_map(|c| [c.link_a_from_contact, c.link_b_from_contact]);
        let frames = self.frames().iter().map(|f| f.link_from_frame);
        let places = joints.chain(loops).chain(contacts).chain(frames);
        let pitches = self.joints().iter().map(|j| match j.kind {
            JointKind::Helical { pitch } => pitch.abs(),
            _ => 0.0,
        });
        let shapes = self.links().iter().map(|link| {
            let collisions = link.collisions.iter().map(|c| (&c.geometry, c.link_from_shape));
            let visuals = link.visuals.iter().map(|v| (&v.geometry, v.link_from_shape));
            let sizes = collisions.chain(visuals).map(|(shape, at)| size(shape).max(reach_of(at)));
            let mass = link.inertial.map_or(0.0, |i| reach_of(i.link_from_inertia));
            sizes.fold(mass, f64::max)
        });
        let lengths = places.map(reach_of).chain(self.travels()).chain(pitches).chain(shapes);
        let longest = lengths.fold(0.0, f64::max);
        let [least, most] = ROUNDED_LENGTHS;
        let is_rounding = longest >= least && longest <= most;
        if longest == 0.0 || longest >= MIN_LENGTH || is_rounding {
            return Ok(());
        }
        Err(Error::Model {
            model: self.name().to_owned(),
            culprit: String::new(),
            message: format!(
                "its longest length is {longest:e} m, out of range: those of mechanisms from \
                 {MIN_LENGTH:e} m to {MAX_MAGNITUDE:e} m are accepted; use another unit of length, or \
                 write 0 for roundings"
            ),
        })
    }
}

fn reach_of(pose: Pose) -> f64 {
    largest(pose.translation)
}

/// Largest coordinate: squares of short lengths would be zero.
fn largest(x: Vec3) -> f64 {
    x.to_array().iter().fold(0.0, |most, x| x.abs().max(most))
}

/// A length of a shape (m), zero only if it has no extent.
fn size(shape: &Geometry) -> f64 {
    match shape {
        Geometry::Box { size } => largest(*size),
        Geometry::Ellipsoid { radii } => largest(*radii),
        Geometry::Cylinder { radius, length } | Geometry::Capsule { radius, length } => {
            radius.abs().max(length.abs())
        }
        Geometry::Sphere { radius } => radius.abs(),
        Geometry::ConvexHull { points } => points.iter().map(|p| largest(*p)).fold(0.0, f64::max),
        // Of any size.
        Geometry::HalfSpace | Geometry::Mesh { .. } => 1.0,
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
