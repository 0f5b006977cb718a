//! Screws and lines: the geometry of one twist, and of two axes.
//!
//! Formula  the page of [`Screw`]
//! Units    points m, pitch m/rad, amplitude rad/s (m/s where the pitch is infinite)
//! Frame    that of the twist
//! Valid    every twist but zero; w = 0 is a screw of infinite pitch, whose axis has a direction
//!          but no place (the point is then zero)
//! Source   Ball 1900, chapters I and II; common normal: any text on line geometry
//! Checked  tests/it/screws/geometry.rs

use crate::spatial::{Rotation, Twist, Vec3};
use crate::tolerance::{COINCIDENT, ZERO_AXIS};

/// A directed line in space.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Line {
    /// A point on it (m).
    pub point: Vec3,
    /// Its direction, of unit length.
    pub direction: Vec3,
}

impl Line {
    /// The line through `point` along `direction` (any length); `None` if that has no direction.
    ///
    /// ```
    /// use cylindroid::Vec3;
    /// use cylindroid::screws::Line;
    ///
    /// let line = Line::through(Vec3::X, Vec3::new(0.0, 0.0, 2.0)).unwrap();
    /// assert_eq!(line.direction, Vec3::Z);
    /// assert_eq!(Line::through(Vec3::X, Vec3::ZERO), None);
    /// ```
    #[must_use]
    pub fn through(point: Vec3, direction: Vec3) -> Option<Self> {
        let direction = direction.unit(ZERO_AXIS)?;
        point.is_finite().then_some(Self { point, direction })
    }

    /// The rotation about the line at 1 rad/s: the twist of pitch zero.
    #[must_use]
    pub fn twist(&self) -> Twist {
        Twist { linear: self.point.cross(self.direction), angular: self.direction }
    }

    /// The point of the line nearest to `p`.
    ///
    /// ```
    /// use cylindroid::Vec3;
    /// use cylindroid::screws::Line;
    ///
    /// let line = Line { point: Vec3::X, direction: Vec3::Z };
    /// assert_eq!(line.nearest(Vec3::new(3.0, 0.0, 2.0)), Vec3::new(1.0, 0.0, 2.0));
    /// ```
    #[must_use]
    pub fn nearest(&self, p: Vec3) -> Vec3 {
        self.point + self.direction * self.direction.dot(p - self.point)
    }

    /// The shortest connection from this line to another.
    ///
    /// ```
    /// use cylindroid::Vec3;
    /// use cylindroid::screws::Line;
    ///
    /// let a = Line { point: Vec3::ZERO, direction: Vec3::X };
    /// let b = Line { point: Vec3::new(0.0, 0.0, 0.3), direction: Vec3::Y };
    /// let normal = a.common_normal(&b);
    /// assert!((normal.distance - 0.3).abs() < 1e-15);
    /// ```
    #[must_use]
    pub fn common_normal(&self, other: &Self) -> CommonNormal {
        let (a, b) = (self.direction, other.direction);
        let between = other.point - self.point;
        let Some(normal) = a.cross(b).unit(ZERO_AXIS) else {
            // Parallel lines have a normal everywhere: the one at this line's point.
            let foot = other.nearest(self.point);
            let across = foot - self.point;
            let across = across - a * a.dot(across);
            // What is no more than the rounding of the points has no direction.
            let direction = across
                .unit(COINCIDENT * (self.point.norm() + between.norm()))
                .or_else(|| Rotation::z_to(a).map(Rotation::x_axis))
                .unwrap_or(Vec3::X);
            return CommonNormal {
                from: self.point,
                to: foot,
                direction,
                distance: across.norm(),
                angle: if a.dot(b) > 0.0 { 0.0 } else { std::f64::consts::PI },
                unique: false,
            };
        };
        let height = between.dot(normal);
        let direction = if height < 0.0 { -normal } else { normal };
        // Along a to the plane that holds b and the normal, and the other way round.
        let sine = a.cross(b).dot(normal);
        let from = self.point + a * (between.cross(b).dot(normal) / sine);
        let to = other.point + b * (between.cross(a).dot(normal) / sine);
        CommonNormal {
            from,
            to,
            direction,
            distance: height.abs(),
            angle: a.cross(b).dot(direction).atan2(a.dot(b)),
            unique: true,
        }
    }

    /// The line through `point` that meets both `a` and `b` (or is parallel to one of them):
    /// run the point along a third line and the transversals of the three sweep their regulus.
    /// `None` where more than one line does, as when the point is on one of the two.
    ///
    /// ```
    /// use cylindroid::Vec3;
    /// use cylindroid::screws::Line;
    ///
    /// let a = Line { point: Vec3::ZERO, direction: Vec3::X };
    /// let b = Line { point: Vec3::Z, direction: Vec3::Y };
    /// let line = Line::transversal_through(Vec3::Z * 2.0 + Vec3::Y, &a, &b).unwrap();
    /// assert!(line.common_normal(&a).distance < 1e-15 && line.common_normal(&b).distance < 1e-15);
    /// ```
    #[must_use]
    pub fn transversal_through(point: Vec3, a: &Self, b: &Self) -> Option<Self> {
        let plane = |line: &Self| (line.nearest(point) - point).cross(line.direction).unit(0.0);
        Self::through(point, plane(a)?.cross(plane(b)?))
    }
}

/// The shortest connection of two lines.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CommonNormal {
    /// Its foot on the first line (m).
    pub from: Vec3,
    /// Its foot on the second line (m).
    pub to: Vec3,
    /// Unit vector from the first to the second; perpendicular to both where they intersect.
    pub direction: Vec3,
    /// Distance of the lines (m).
    pub distance: f64,
    /// Angle that rotates the first direction into the second about `direction`, in (-pi, pi].
    pub angle: f64,
    /// False for parallel lines, which have a common normal at every point.
    pub unique: bool,
}

/// A line with a pitch and an amplitude: the geometry of a twist.
///
/// ```text
/// axis through p = w x v / |w|^2 along w,   pitch h = w . v / |w|^2,   amplitude |w|
/// back: w = a n,  v = a (h n + p x n),   n the unit direction, a the amplitude
/// ```
///
/// In the frame of the twist [v; w]: p in m, h in m/rad.
///
/// Source: Ball 1900, chapters I and II.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Screw {
    /// The axis; its point is the one nearest to the origin. For an infinite pitch the point is
    /// zero and only the direction has a meaning.
    pub axis: Line,
    /// Advance along the axis by angle about it [m/rad]; infinite for a pure translation.
    pub pitch: f64,
    /// Angular speed [rad/s]; linear speed [m/s] for a pure translation. Not negative.
    pub amplitude: f64,
}

impl Screw {
    /// The screw of a twist; `None` for the zero twist, which has no axis, and for numbers that
    /// are not finite.
    ///
    /// ```
    /// use cylindroid::{Screw, Twist, Vec3};
    ///
    /// // A rotation about the vertical axis through (1, 0, 0), advancing 0.1 m per radian.
    /// let twist = Twist { linear: Vec3::new(0.0, -1.0, 0.1), angular: Vec3::Z };
    /// let screw = Screw::of(twist).unwrap();
    /// assert!((screw.pitch - 0.1).abs() < 1e-15);
    /// assert!((screw.axis.point - Vec3::X).norm() < 1e-15);
    /// ```
    #[must_use]
    pub fn of(twist: Twist) -> Option<Self> {
        if !twist.linear.norm().is_finite() || !twist.angular.norm().is_finite() {
            return None;
        }
        if let Some((direction, amplitude)) = polar(twist.angular) {
            let linear = over(twist.linear, amplitude);
            let (point, pitch) = (direction.cross(linear), direction.dot(linear));
            if point.is_finite() && pitch.is_finite() {
                return Some(Self { axis: Line { point, direction }, pitch, amplitude });
            }
        }
        let (direction, amplitude) = polar(twist.linear)?;
        Some(Self { axis: Line { point: Vec3::ZERO, direction }, pitch: f64::INFINITY, amplitude })
    }

    /// The twist of the screw.
    #[must_use]
    pub fn twist(&self) -> Twist {
        let Line { point, direction } = self.axis;
        if self.pitch.is_infinite() {
            return Twist { linear: direction * self.amplitude, angular: Vec3::ZERO };
        }
        Twist {
            linear: (direction * self.pitch + point.cross(direction)) * self.amplitude,
            angular: direction * self.amplitude,
        }
    }

    /// True if the pitch is infinite: a pure translation.
    #[must_use]
    pub fn is_translation(&self) -> bool {
        self.pitch.is_infinite()
    }
}

/// Direction and length, down to the smallest number that is not zero.
fn polar(x: Vec3) -> Option<(Vec3, f64)> {
    let largest = x.x.abs().max(x.y.abs()).max(x.z.abs());
    let x = over(x, largest);
    let direction = x.unit(0.0)?;
    Some((direction, largest * x.norm()))
}

/// A quotient, where the reciprocal of `a` may overflow.
fn over(x: Vec3, a: f64) -> Vec3 {
    Vec3::new(x.x / a, x.y / a, x.z / a)
}
