//! Paths of a frame in space: straight lines, arcs and rotations over s in [0, 1].
//!
//! Formula  the page of [`CartesianPath`]; y = n cross x
//! Units    lengths m, angles rad, s dimensionless; twists per unit of s
//! Valid    any finite poses, lengths and angles down to zero; s outside [0, 1] is clamped, and
//!          at 0 and 1 the poses are the given ones exactly. At an angle of pi, within
//!          `tolerance::HALF_TURN`, the axis whose first non-zero component is positive
//! Fails    on non-finite input, on three collinear points, on an axis of length 0
//! Why so   position and orientation are interpolated separately, so a straight line stays
//!          straight; the screw motion exp(s log(...)) would curve it. |dp/ds| and |r| are
//!          constant, so that one scalar time law bounds the whole move
//! Source   Siciliano et al. 2009, section 4.3 (path primitives, angle and axis)
//! Checked  tests/motion/paths.rs

use std::f64::consts::{PI, TAU};

use crate::error::{Error, Result};
use crate::scalar::{clamp, sin_cos};
use crate::spatial::{Pose, Rotation, Twist, Vec3};
use crate::tolerance::{COLLINEAR, HALF_TURN, POSITION, ZERO_AXIS};

/// A path of a frame in space, `world_from_tool` over s in [0, 1].
///
/// ```text
/// line  p = p0 + s d
/// arc   p = p0 + y sin(phi s) - 2 x sin^2(phi s / 2)
/// R = exp(s r) R0
/// ```
///
/// x leads from the centre of the arc to its start p0, y is normal to it in the plane of the arc, r
/// is the rotation vector from start to end in world axes. Lengths in m, angles in rad. Position
/// and orientation are interpolated separately, so that a straight line stays straight.
///
/// Source: Siciliano et al. 2009, section 4.3.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CartesianPath {
    start: Pose,
    end: Pose,
    curve: Curve,
    /// Rotation from the start to the end, world axes; beyond pi only for `rotation`.
    rotation: Vec3,
}

#[derive(Debug, Clone, Copy, PartialEq)]
enum Curve {
    /// From start to end (m).
    Line { displacement: Vec3 },
    /// `x` from the centre to the start, `y` perpendicular to it in the sense of the motion, both
    /// of the length of the radius (m); angle >= 0 (rad).
    Arc { x: Vec3, y: Vec3, angle: f64 },
}

/// A rotation about a fixed axis.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AxisRotation {
    /// A point on the axis, world axes (m).
    pub centre: Vec3,
    /// Direction of the axis, world axes; any non-zero length [-].
    pub axis: Vec3,
    /// Angle, right-handed about the axis; more than one revolution is permitted (rad).
    pub angle: f64,
}

/// Deviation of a pose from a path.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PathDeviation {
    /// Distance to the path (m).
    pub position: f64,
    /// Angle to the path's orientation at `s`, in [0, pi] (rad).
    pub orientation: f64,
    /// The closest point of the path, in [0, 1]; the first of several.
    pub s: f64,
}

impl CartesianPath {
    /// The straight line between two poses, rotating about a constant axis by at most pi.
    ///
    /// ```
    /// use cylindroid::control::CartesianPath;
    /// use cylindroid::{Pose, Rotation, Vec3};
    ///
    /// let to = Pose { rotation: Rotation::about_z(1.0), translation: Vec3::X };
    /// let path = CartesianPath::line(Pose::IDENTITY, to)?;
    /// let half = path.pose(0.5);
    /// assert_eq!(half.translation, Vec3::X * 0.5);
    /// assert!(half.rotation.angle_to(Rotation::about_z(0.5)) < 1e-15);
    /// assert_eq!(path.derivative(0.5).linear, Vec3::X); // m per unit of s
    /// // 0.1 m beside the path.
    /// let deviation = path.deviation(Pose { translation: Vec3::new(0.5, 0.1, 0.0), ..half });
    /// assert!((deviation.position - 0.1).abs() < 1e-15 && (deviation.s - 0.5).abs() < 1e-15);
    /// # Ok::<(), cylindroid::Error>(())
    /// ```
    ///
    /// # Errors
    /// A pose that is not finite.
    pub fn line(from: Pose, to: Pose) -> Result<Self> {
        let curve = Curve::Line { displacement: to.translation - from.translation };
        Self::between(from, to, curve)
    }

    /// The arc from `from` through the point `via` (m) to `to`, rotating about a constant axis from
    /// the first orientation to the last by at most pi.
    ///
    /// ```
    /// use cylindroid::control::CartesianPath;
    /// use cylindroid::{Pose, Vec3};
    ///
    /// // Half a circle of radius 1 m.
    /// let (from, to) = (Pose::from_translation(Vec3::X), Pose::from_translation(-Vec3::X));
    /// let path = CartesianPath::circle(from, Vec3::Y, to)?;
    /// assert!((path.length() - std::f64::consts::PI).abs() < 1e-14);
    /// assert!((path.pose(0.5).translation - Vec3::Y).norm() < 1e-15);
    /// # Ok::<(), cylindroid::Error>(())
    /// ```
    ///
    /// # Errors
    /// Non-finite input; three collinear points (the height of the triangle is below
    /// `tolerance::COLLINEAR` of its longest side) or coincident ones, for which a line is meant.
    pub fn circle(from: Pose, via: Vec3, to: Pose) -> Result<Self> {
        let (a, b) = (via - from.translation, to.translation - from.translation);
        if !(from.is_finite() && to.is_finite() && a.is_finite() && b.is_finite()) {
            return Err(not_finite());
        }
        // Scaled by the longest side, so that nothing overflows or vanishes.
        let size = a.norm().max(b.norm()).max((b - a).norm());
        let scale = 1.0 / size.max(f64::MIN_POSITIVE);
        let (u, v) = (a * scale, b * scale);
        let normal = u.cross(v);
        let Some(n) = normal.unit(COLLINEAR) else {
            return Err(Error::InvalidOption {
                option: "via point of a circle",
                value: format!("({}, {}, {})", via.x, via.y, via.z),
                reason: "start, via and end lie on one line or coincide, so no circle goes \
                         through them; use a line, or a rotation for a full circle"
                    .to_owned(),
            });
        };
        let centre = normal.cross(u) * v.dot(v) + v.cross(normal) * u.dot(u);
        let x = centre * (-0.5 * size / normal.dot(normal));
        let y = n.cross(x);
        let last = b + x;
        let angle = positive(last.dot(y).atan2(last.dot(x)));
        Self::between(from, to, Curve::Arc { x, y, angle })
    }

    /// The arc of a rotation about a fixed axis, with the orientation rotating along.
    ///
    /// ```
    /// use cylindroid::control::{CartesianPath, AxisRotation};
    /// use cylindroid::{Pose, Vec3};
    /// let start = Pose::from_translation(Vec3::new(1.0, 0.0, 0.5));
    /// let turn = AxisRotation { centre: Vec3::ZERO, axis: Vec3::Z, angle: std::f64::consts::TAU };
    /// let circle = CartesianPath::rotation(start, turn)?;
    /// assert_eq!(circle.length(), std::f64::consts::TAU);
    /// assert!((circle.pose(0.25).translation - Vec3::new(0.0, 1.0, 0.5)).norm() < 1e-15);
    /// # Ok::<(), cylindroid::Error>(())
    /// ```
    ///
    /// # Errors
    /// Non-finite input; an axis shorter than `tolerance::ZERO_AXIS`.
    pub fn rotation(from: Pose, turn: AxisRotation) -> Result<Self> {
        let AxisRotation { centre, axis, angle } = turn;
        if !(axis.is_finite() && angle.is_finite()) {
            return Err(not_finite());
        }
        let Some(n) = axis.unit(ZERO_AXIS) else {
            return Err(Error::InvalidOption {
                option: "axis of a rotation",
                value: format!("({}, {}, {})", axis.x, axis.y, axis.z),
                reason: "it has no direction; give a vector of length near 1".to_owned(),
            });
        };
        let offset = from.translation - centre;
        let x = offset - n * n.dot(offset);
        let y = n.cross(x) * angle.signum();
        let curve = Curve::Arc { x, y, angle: angle.abs() };
        let rotation = n * angle;
        let end = Pose {
            rotation: Rotation::exp(rotation) * from.rotation,
            translation: from.translation + curve.offset(1.0),
        };
        Self { start: from, end, curve, rotation }.checked()
    }

    fn between(start: Pose, end: Pose, curve: Curve) -> Result<Self> {
        let rotation = rotation_between(start.rotation, end.rotation);
        Self { start, end, curve, rotation }.checked()
    }

    fn checked(self) -> Result<Self> {
        let finite = self.start.is_finite()
            && self.end.is_finite()
            && self.length().is_finite()
            && self.angle().is_finite();
        if finite { Ok(self) } else { Err(not_finite()) }
    }

    /// Length of the path of the origin (m).
    #[must_use]
    pub fn length(&self) -> f64 {
        match self.curve {
            Curve::Line { displacement } => displacement.norm(),
            Curve::Arc { x, angle, .. } => x.norm() * angle,
        }
    }

    /// Angle of the whole rotation, about one axis (rad).
    #[must_use]
    pub fn angle(&self) -> f64 {
        self.rotation.norm()
    }

    /// Radius of the arc (m); infinite for a line.
    #[must_use]
    pub fn radius(&self) -> f64 {
        match self.curve {
            Curve::Line { .. } => f64::INFINITY,
            Curve::Arc { x, .. } => x.norm(),
        }
    }

    /// The pose at `s`, clamped to [0, 1]; NaN counts as 0.
    #[must_use]
    pub fn pose(&self, s: f64) -> Pose {
        if s.is_nan() || s <= 0.0 {
            return self.start;
        }
        if s >= 1.0 {
            return self.end;
        }
        let translation = match self.curve {
            // From the closer end: rounding does not overshoot the ends.
            Curve::Line { displacement } if s > 0.5 => {
                self.end.translation - displacement * (1.0 - s)
            }
            curve => self.start.translation + curve.offset(s),
        };
        Pose { rotation: Rotation::exp(self.rotation * s) * self.start.rotation, translation }
    }

    /// `d pose / ds` at `s` (clamped as in [`Self::pose`]): world axes, the linear part at the
    /// moving origin (m), the angular part (rad), both per unit of s and of constant length.
    #[must_use]
    pub fn derivative(&self, s: f64) -> Twist {
        let linear = match self.curve {
            Curve::Line { displacement } => displacement,
            Curve::Arc { x, y, angle } => {
                let (sin, cos) = sin_cos(angle * within(s));
                (y * cos - x * sin) * angle
            }
        };
        Twist { linear, angular: self.rotation }
    }

    /// The deviation of a measured pose from this path: the distance to the closest point of the
    /// segment or arc, and the angle to the path's orientation there.
    ///
    /// On a path shorter than `tolerance::POSITION`, a pure rotation, the closest orientation is
    /// used instead. For a non-finite pose, position and orientation are NaN.
    #[must_use]
    pub fn deviation(&self, pose: Pose) -> PathDeviation {
        if !pose.is_finite() {
            return PathDeviation { position: f64::NAN, orientation: f64::NAN, s: 0.0 };
        }
        let s = within(if self.length() > POSITION {
            self.nearest_position(pose.translation)
        } else {
            self.nearest_orientation(pose.rotation)
        });
        let error = self.pose(s).error_to(pose);
        PathDeviation { position: error.linear.norm(), orientation: error.angular.norm(), s }
    }

    fn nearest_position(&self, p: Vec3) -> f64 {
        let offset = p - self.start.translation;
        match self.curve {
            Curve::Line { displacement } => {
                offset.dot(displacement) / displacement.dot(displacement)
            }
            Curve::Arc { x, y, angle } => {
                let from_centre = offset + x;
                let at = positive(from_centre.dot(y).atan2(from_centre.dot(x)));
                let at_end = (p - self.end.translation).norm() < offset.norm();
                nearest(at, angle, at_end)
            }
        }
    }

    /// With q = (w, v) the measured rotation from the start, the angle of exp(-theta n) q is
    /// smallest for tan(theta / 2) = v.n / w.
    fn nearest_orientation(&self, rotation: Rotation) -> f64 {
        let Some(n) = self.rotation.unit(0.0) else { return 0.0 };
        let q = (rotation * self.start.rotation.inverse()).to_quaternion();
        let at = positive(2.0 * Vec3::new(q.x, q.y, q.z).dot(n).atan2(q.w));
        let at_end = self.end.rotation.angle_to(rotation) < self.start.rotation.angle_to(rotation);
        nearest(at, self.angle(), at_end)
    }
}

impl Curve {
    /// Displacement from the start to `s` (m).
    fn offset(self, s: f64) -> Vec3 {
        match self {
            Self::Line { displacement } => displacement * s,
            Self::Arc { x, y, angle } => {
                let half = sin_cos(0.5 * angle * s).0;
                y * sin_cos(angle * s).0 - x * (2.0 * half * half)
            }
        }
    }
}

/// `at / whole`, or the closer end if the angle `at` exceeds `whole`.
fn nearest(at: f64, whole: f64, at_end: bool) -> f64 {
    if at <= whole && whole > 0.0 {
        at / whole
    } else if at_end {
        1.0
    } else {
        0.0
    }
}

/// `s` in [0, 1], 0 for NaN.
pub(super) fn within(s: f64) -> f64 {
    if s.is_nan() { 0.0 } else { clamp(s, 0.0, 1.0) }
}

/// An angle of [-pi, pi] (or of [-2 pi, 2 pi]) in [0, 2 pi].
fn positive(angle: f64) -> f64 {
    if angle < 0.0 { angle + TAU } else { angle }
}

/// The rotation vector from one orientation to another, world axes; near an angle of pi, where
/// rounding would select one of the two directions, always the same one.
fn rotation_between(from: Rotation, to: Rotation) -> Vec3 {
    let vector = (to * from.inverse()).log();
    let angle = vector.norm();
    if PI - angle > HALF_TURN {
        return vector;
    }
    let axis = vector * (1.0 / angle);
    let first = axis.to_array().into_iter().find(|c| c.abs() > HALF_TURN);
    if first.is_some_and(|c| c < 0.0) { axis * (angle - TAU) } else { vector }
}

fn not_finite() -> Error {
    Error::NotFinite { what: "a pose, point or angle of the path".to_owned(), value: f64::NAN }
}
