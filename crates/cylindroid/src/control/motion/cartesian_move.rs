//! Cartesian moves: a path in space and the fastest time law on it that keeps every bound.
//!
//! Formula  the law runs s from 0 to 1. Line of length L: s' <= v/L, s'' <= a/L, s''' <= j/L.
//!          Rotation by the angle A about one axis: the same with A. The tighter bound applies to
//!          s. Arc of radius r and length L, u = L s' the speed, alpha = L s'', eta = L s''':
//!          |acceleration|^2 = alpha^2 + (u^2/r)^2 |jerk|^2 = (eta - u^3/r^2)^2 + (3 u alpha/r)^2 u
//!          <= min(v, sqrt(a min(r/sqrt 2, L)), cbrt(j min(r, L)^2 / 4)) alpha <= min(sqrt(a^2 -
//!          (u^2/r)^2), j r / (3 sqrt 2 u)) eta <= sqrt(j^2 - (3 u alpha/r)^2) - u^3/r^2
//! Units    linear bounds m/s, m/s^2, m/s^3; angular rad/s, rad/s^2, rad/s^3
//! Valid    any path; zero length and angle give duration zero. Time-optimal on
//!          lines and in rotations; conservative on arcs: speed, acceleration and
//!          jerk are never exceeded, even where all three are largest at once
//! Fails    on bounds that `TimeLaw` rejects (all are checked, even those of a part at rest)
//! Why so   with constants alpha and eta the law stays the closed form of `TimeLaw`; the
//!          time-optimal arc needs a numeric phase plane and gains, where no jerk is bounded, at
//!          most 2^(1/4) = 1.19 in the speed and sqrt 2 in the acceleration. The terms with L
//!          do not slow it down, as no law is faster over L, and treat a short arc like a line
//! Source   own derivation from the Frenet formulas; Siciliano et al. 2009, section 4.3
//! Checked  tests/motion/moves.rs::cartesian_*

use std::f64::consts::FRAC_1_SQRT_2;

use super::path::CartesianPath;
use super::time_law::{KinematicBounds, LawSample, TimeLaw};
use crate::control::servo::Target;
use crate::error::Result;
use crate::spatial::{Pose, Twist};

/// Bounds of a move in space; the linear ones bound the norms at the moving origin.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CartesianBounds {
    /// Of the origin [m/s, m/s^2, m/s^3].
    pub linear: KinematicBounds,
    /// Of the orientation [rad/s, rad/s^2, rad/s^3].
    pub angular: KinematicBounds,
}

/// A frame moving along a path.
///
/// ```text
/// line of length L:      s' <= v / L,  s'' <= a / L,  s''' <= j / L
/// rotation by angle A:   the same with A and the angular bounds
/// arc of radius r, u = L s', alpha = L s'', eta = L s''':
///     |acceleration|^2 = alpha^2 + (u^2 / r)^2
///     |jerk|^2 = (eta - u^3 / r^2)^2 + (3 u alpha / r)^2
/// ```
///
/// One time law s from 0 to 1 within the tighter of both bounds. Time-optimal on lines and in
/// rotations, conservative on arcs.
///
/// ```
/// use cylindroid::control::{KinematicBounds, CartesianBounds, CartesianMove, CartesianPath};
/// use cylindroid::{Pose, Vec3};
/// let target = Pose::from_translation(Vec3::new(0.0, 0.0, 0.5));
/// let path = CartesianPath::line(Pose::IDENTITY, target)?;
/// let bounds = CartesianBounds {
///     linear: KinematicBounds { velocity: 0.25, acceleration: 1.0, jerk: 10.0 },
///     angular: KinematicBounds { velocity: 1.0, acceleration: 4.0, jerk: 40.0 },
/// };
/// let motion = CartesianMove::new(path, bounds)?;
/// let halfway = motion.at(0.5 * motion.law().duration());
/// assert!((halfway.twist.linear.z - 0.25).abs() < 1e-15);
/// # Ok::<(), cylindroid::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CartesianMove {
    path: CartesianPath,
    law: TimeLaw,
}

/// The state of a Cartesian move.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CartesianSample {
    /// `world_from_tool`.
    pub pose: Pose,
    /// The feed-forward: world axes, linear part that of the moving origin [m/s, rad/s].
    pub twist: Twist,
    /// The path coordinate s and its derivatives [1, 1/s, 1/s^2, 1/s^3].
    pub s: LawSample,
}

impl CartesianMove {
    /// The move along `path` within `bounds`.
    ///
    /// # Errors
    /// Bounds that are NaN, zero or negative, or that leave both acceleration and jerk infinite.
    pub fn new(path: CartesianPath, bounds: CartesianBounds) -> Result<Self> {
        bounds.linear.check("the linear part")?;
        bounds.angular.check("the angular part")?;
        let (length, radius) = (path.length(), path.radius());
        let linear = if length > 0.0 && radius.is_finite() {
            on_arc(bounds.linear, Arc { radius, length })
        } else {
            bounds.linear
        };
        let tightest = linear.over(length).tightest(bounds.angular.over(path.angle()));
        Ok(Self { path, law: TimeLaw::along(tightest)? })
    }

    /// The same move slowed down to end at `duration` (s).
    ///
    /// # Errors
    /// A duration shorter than that of the move, or not finite.
    pub fn scaled_to_duration(self, duration: f64) -> Result<Self> {
        Ok(Self { law: self.law.scaled_to_duration(duration)?, ..self })
    }

    /// The path.
    #[must_use]
    pub fn path(&self) -> &CartesianPath {
        &self.path
    }

    /// The law of the path coordinate, from 0 to 1.
    #[must_use]
    pub fn law(&self) -> &TimeLaw {
        &self.law
    }

    /// The state at time `t` (s); at rest at the start before 0 and at the end after the duration.
    #[must_use]
    pub fn at(&self, t: f64) -> CartesianSample {
        let s = self.law.at(t);
        let twist = self.path.derivative(s.position) * s.velocity;
        CartesianSample { pose: self.path.pose(s.position), twist, s }
    }

    /// The target of a servo of period `dt` (s) at time `t` (s): the present pose, and the constant
    /// twist that leads to the pose of the next step. The twist at `t` itself would leave the servo
    /// behind by acceleration * dt / (2 gain); it is that of the target without a next step (`dt`
    /// zero or NaN).
    #[must_use]
    pub fn target(&self, t: f64, dt: f64) -> Target {
        let (CartesianSample { pose, twist, .. }, rate) = (self.at(t), 1.0 / dt);
        if !rate.is_finite() {
            return Target { pose, feed_forward: twist };
        }
        Target { pose, feed_forward: pose.error_to(self.at(t + dt).pose) * rate }
    }
}

struct Arc {
    radius: f64,
    length: f64,
}

/// The bounds of speed, tangential acceleration and its rate on an arc (see the header).
fn on_arc(bounds: KinematicBounds, arc: Arc) -> KinematicBounds {
    let (KinematicBounds { velocity: v, acceleration: a, jerk: j }, r) = (bounds, arc.radius);
    let reach = arc.length.min(r);
    let u = v
        .min((a * arc.length.min(FRAC_1_SQRT_2 * r)).sqrt())
        .min((0.25 * j).cbrt() * reach.cbrt() * reach.cbrt());
    // Ratios of one part to the whole bound: 0 if the bound is infinite.
    let centripetal = (u / r) * (u / a);
    let alpha =
        (a * (1.0 - centripetal * centripetal).sqrt()).min(FRAC_1_SQRT_2 / 3.0 * j * (r / u));
    let across = 3.0 * (u / j) * (alpha / r);
    let along = (u / j) * (u / r) * (u / r);
    let eta = j * ((1.0 - across * across).sqrt() - along);
    KinematicBounds { velocity: u, acceleration: alpha, jerk: eta }
}
