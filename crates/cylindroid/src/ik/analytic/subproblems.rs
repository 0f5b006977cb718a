//! Paden-Kahan-type subproblems: rotation angles that satisfy linear conditions on rotated vectors.
//!
//! Formula  a cos q + b sin q = c: (cos, sin) = ((a, b) c +- (-b, a) h) / r^2, r^2 = a^2 + b^2,
//!          h^2 = r^2 - c^2;
//!          rotation of p about k onto p': q = atan2((k x p) . p', p . p' - (k . p)(k . p'));
//!          X x + Y y = d, x and y on unit circles: one row first if it contains only one of them,
//!          otherwise y = Y^-1 (d - X x), and |y| = 1 is a quartic in the tangent of half of x's
//!          angle, measured from the largest violation, so that no root is near infinity
//! Valid    any input. An undetermined angle is that of the initial guess, or the first verified of
//!          seven others, and is called free; a condition violated by rounding is satisfied as well
//!          as possible: results are candidates, to be verified by forward kinematics
//! Why so   the unknowns are sines and cosines, not angles: one arc tangent per angle is the only
//!          trigonometric function. Roots of the quartic are bracketed by those of its derivatives,
//!          which loses no double roots, whereas Ferrari's formulas lose digits
//! Source   Paden 1986; Elias & Wen 2025, IK-Geo, subproblems 1, 3, 4, 5, 6
//! Checked  tests/it/analytic/, src/ik/analytic/subproblems/tests.rs

use std::cell::Cell;
use std::f64::consts::FRAC_PI_4;

use crate::linalg::max_abs;
use crate::scalar::{Bracket, atan2, sin_cos};
use crate::spatial::Vec3;
use crate::tolerance::{FREE_TURN, NEARLY_SATISFIED, TANGENT_ROOT};

/// A free angle is tried at the initial guess, then at these eighths of a turn from it.
const EIGHTHS: [f64; 8] = [0.0, 1.0, -1.0, 2.0, -2.0, 3.0, -3.0, 4.0];

/// A rotation angle with its cosine and sine.
#[derive(Debug, Clone, Copy)]
pub(super) struct Angle {
    pub(super) cos: f64,
    pub(super) sin: f64,
    /// (rad)
    pub(super) angle: f64,
    /// True if the angle is undetermined.
    pub(super) free: bool,
    /// True for the second of the two angles of a linear condition, as in conditions nearby.
    pub(super) is_second: bool,
}

impl Angle {
    pub(super) const NONE: Self =
        Self { cos: 1.0, sin: 0.0, angle: 0.0, free: false, is_second: false };

    /// A free angle.
    fn free(angle: f64) -> Self {
        let (sin, cos) = sin_cos(angle);
        Self { cos, sin, angle, free: true, is_second: false }
    }

    /// From (cos, sin) of any length.
    #[inline]
    fn along(cos: f64, sin: f64) -> Self {
        Self::along_known(cos, sin, (cos * cos + sin * sin).sqrt())
    }

    /// The same for a known length.
    #[inline]
    fn along_known(cos: f64, sin: f64, length: f64) -> Self {
        let one_over = 1.0 / length;
        Self {
            cos: cos * one_over,
            sin: sin * one_over,
            angle: atan2(sin, cos),
            free: false,
            is_second: false,
        }
    }

    /// `v` rotated about the unit vector `k`.
    #[inline]
    pub(super) fn of(self, k: Vec3, v: Vec3) -> Vec3 {
        v * self.cos + k.cross(v) * self.sin + k * (k.dot(v) * (1.0 - self.cos))
    }

    /// `v` rotated back.
    #[inline]
    pub(super) fn back(self, k: Vec3, v: Vec3) -> Vec3 {
        Self { sin: -self.sin, ..self }.of(k, v)
    }
}

/// The angles that satisfy a condition, at most N.
#[derive(Debug, Clone, Copy)]
pub(super) struct Angles<const N: usize> {
    /// The angle of the initial guess, if the condition determines none beyond rounding.
    free: Option<f64>,
    list: [Angle; N],
    len: usize,
    /// Of a linear condition without a solution c / sqrt(a^2 + b^2), beyond -1 or 1.
    miss: f64,
}

impl<const N: usize> Angles<N> {
    const NONE: Self = Self { free: None, list: [Angle::NONE; N], len: 0, miss: 0.0 };

    fn push(&mut self, turn: Angle) {
        if self.len < N {
            self.list[self.len] = turn;
            self.len += 1;
        }
    }

    /// True if the condition determines no angle beyond rounding.
    pub(super) fn is_free(&self) -> bool {
        self.free.is_some()
    }

    /// Calls `f`, which returns whether one counts as a solution, for each angle; returns whether
    /// any did. Of free angles the first one suffices.
    #[inline]
    pub(super) fn any(&self, mut f: impl FnMut(Angle) -> bool) -> bool {
        if let Some(start) = self.free
            && EIGHTHS.iter().any(|i| f(Angle::free(start + i * FRAC_PI_4)))
        {
            return true;
        }
        let mut any = false;
        for turn in &self.list[..self.len] {
            any |= f(*turn);
        }
        any
    }
}

/// The linear conditions of a pose that have no solution: of each c / sqrt(a^2 + b^2), beyond -1 or
/// 1, and 0 of those that have one or are not reached.
#[derive(Debug, Default)]
pub(super) struct Misses([Cell<f64>; 7]);

impl Misses {
    /// Notes the first condition.
    fn of_first(&self, angles: Angles<2>) -> Angles<2> {
        self.noted(0, angles)
    }

    /// Notes the second condition after an angle of the first.
    fn of_second(&self, first: Angle, angles: Angles<2>) -> Angles<2> {
        self.noted(1 + usize::from(first.is_second), angles)
    }

    /// Notes the third condition after a pair of angles of the first two.
    pub(super) fn of_third(&self, [first, second]: [Angle; 2], angles: Angles<2>) -> Angles<2> {
        self.noted(3 + 2 * usize::from(first.is_second) + usize::from(second.is_second), angles)
    }

    fn noted(&self, place: usize, angles: Angles<2>) -> Angles<2> {
        self.0[place].set(angles.miss);
        angles
    }

    pub(super) fn to_array(&self) -> [f64; 7] {
        [0, 1, 2, 3, 4, 5, 6].map(|i: usize| self.0[i].get())
    }
}

/// `a cos q + b sin q = c`, coefficients of magnitude `scale`.
pub(super) fn linear([a, b]: [f64; 2], c: f64, scale: f64, start: f64) -> Angles<2> {
    let mut turns = Angles::NONE;
    let square = a * a + b * b;
    let least = FREE_TURN * scale;
    if square <= least * least && c.abs() <= least {
        turns.free = Some(start);
    }
    let height = square - c * c;
    if square == 0.0 || !(height >= -NEARLY_SATISFIED * square) {
        turns.miss = c / square.sqrt();
        return turns;
    }
    if height <= 0.0 {
        turns.push(Angle::along(a * c, b * c));
    } else {
        let h = height.sqrt();
        turns.push(Angle::along_known(a * c - b * h, b * c + a * h, square));
        turns.push(Angle {
            is_second: true,
            ..Angle::along_known(a * c + b * h, b * c - a * h, square)
        });
    }
    turns
}

/// The rotation about `k` that maps `p` onto `onto`, vectors of magnitude `scale`.
#[inline]
pub(super) fn onto(k: Vec3, p: Vec3, onto: Vec3, scale: f64, start: f64) -> Angles<2> {
    let mut turns = Angles::NONE;
    let perpendicular = p - k * k.dot(p);
    let least = FREE_TURN * scale;
    if perpendicular.dot(perpendicular) <= least * least {
        turns.free = Some(start);
    }
    let (cos, sin) = (perpendicular.dot(onto), k.cross(p).dot(onto));
    if cos != 0.0 || sin != 0.0 {
        turns.push(Angle::along(cos, sin));
    }
    turns
}

/// The unique rotation about `k` that maps `p`, perpendicular to `k`, onto `onto`.
#[inline]
pub(super) fn across(k: Vec3, p: Vec3, onto: Vec3) -> Angle {
    Angle::along(p.dot(onto), k.cross(p).dot(onto))
}

/// Coefficients of `w . R v = c[0] cos q + c[1] sin q + rest`, R the rotation about `k` by q.
#[inline]
pub(super) fn coefficients(w: Vec3, k: Vec3, v: Vec3) -> ([f64; 2], f64) {
    let rest = w.dot(k) * k.dot(v);
    ([w.dot(v) - rest, w.dot(k.cross(v))], rest)
}

/// The equation that contains only one of the angles.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Order {
    /// This row contains only x.
    FirstX(usize),
    /// This row contains only y.
    FirstY(usize),
    /// None: the equations are coupled.
    Together,
}

/// Two equations `x[i] . (cos, sin of one angle) + y[i] . (cos, sin of another) = d[i]`.
#[derive(Debug, Clone, Copy)]
pub(super) struct EquationPair {
    pub(super) x: [[f64; 2]; 2],
    pub(super) y: [[f64; 2]; 2],
    pub(super) d: [f64; 2],
    /// Magnitudes of the coefficients of each row.
    pub(super) scale: [f64; 2],
    /// Angles of the initial guess.
    pub(super) start: [f64; 2],
}

impl EquationPair {
    /// Calls `f` for all pairs of angles, as [`Angles::any`].
    pub(super) fn any(
        &self,
        order: Order,
        misses: &Misses,
        mut f: impl FnMut(Angle, Angle) -> bool,
    ) -> bool {
        let Self { x, y, d, start, .. } = *self;
        match order {
            Order::FirstX(i) => self.one_by_one(i, [x, y], start, misses, f),
            Order::FirstY(i) => {
                let start = [start[1], start[0]];
                self.one_by_one(i, [y, x], start, misses, |second, first| f(first, second))
            }
            Order::Together => {
                let [[a, b], [c, e]] = y;
                let determinant = a * e - b * c;
                let inverse = |v: [f64; 2]| {
                    [(e * v[0] - b * v[1]) / determinant, (a * v[1] - c * v[0]) / determinant]
                };
                let (p, q) = (inverse([x[0][0], x[1][0]]), inverse([x[0][1], x[1][1]]));
                let d = inverse(d);
                Ellipse { p, q, d }.on_circle(start[0]).any(|first| {
                    let y = |i: usize| d[i] - p[i] * first.cos - q[i] * first.sin;
                    f(first, Angle::along(y(0), y(1)))
                })
            }
        }
    }

    /// The angle of `a` from row i, which contains no other, then that of `b` from the other row.
    fn one_by_one(
        &self,
        i: usize,
        [a, b]: [[[f64; 2]; 2]; 2],
        start: [f64; 2],
        misses: &Misses,
        mut f: impl FnMut(Angle, Angle) -> bool,
    ) -> bool {
        let Self { d, scale, .. } = self;
        misses.of_first(linear(a[i], d[i], scale[i], start[0])).any(|first| {
            let i = 1 - i;
            let rest = d[i] - (a[i][0] * first.cos + a[i][1] * first.sin);
            let seconds = linear(b[i], rest, scale[i], start[1]);
            misses.of_second(first, seconds).any(|second| f(first, second))
        })
    }
}

/// The points `d - p cos x - q sin x`.
struct Ellipse {
    p: [f64; 2],
    q: [f64; 2],
    d: [f64; 2],
}

impl Ellipse {
    /// The angles x whose points have distance 1 from the origin.
    fn on_circle(&self, start: f64) -> Angles<7> {
        let Self { p, q, d } = *self;
        let dot = |a: [f64; 2], b: [f64; 2]| a[0] * b[0] + a[1] * b[1];
        let excess = |c: f64, s: f64| {
            let v = [0, 1].map(|i: usize| d[i] - p[i] * c - q[i] * s);
            dot(v, v) - 1.0
        };
        // The largest violation of the condition over eight points.
        let side = std::f64::consts::FRAC_1_SQRT_2;
        let axes = [(1.0, 0.0), (side, side), (0.0, 1.0), (-side, side)];
        let (mut worst, mut c, mut s) = (0.0, 1.0, 0.0);
        for (x, y) in axes.into_iter().flat_map(|(x, y)| [(x, y), (-x, -y)]) {
            if excess(x, y).abs() > worst {
                (worst, c, s) = (excess(x, y).abs(), x, y);
            }
        }
        let mut turns = Angles::NONE;
        if worst <= FREE_TURN {
            turns.free = Some(start);
            return turns;
        }
        // The opposite point is the zero of the angle: x = -(c, s) there.
        let (p, q) = (
            [0, 1].map(|i: usize| -c * p[i] - s * q[i]),
            [0, 1].map(|i: usize| s * p[i] - c * q[i]),
        );
        let (m11, m12, m22) = (dot(p, p), dot(p, q), dot(q, q));
        let (b1, b2, e) = (dot(p, d), dot(q, d), dot(d, d) - 1.0);
        let quartic = [
            m11 - 2.0 * b1 + e,
            4.0 * (m12 - b2),
            4.0 * m22 - 2.0 * m11 + 2.0 * e,
            -4.0 * (m12 + b2),
            m11 + 2.0 * b1 + e,
        ];
        real_roots(quartic, |t| {
            let (x, y) = (1.0 - t * t, 2.0 * t);
            turns.push(Angle::along(-c * x + s * y, -s * x - c * y));
        });
        turns
    }
}

/// Calls `f` with the real roots of `a[0] + a[1] t + ... + a[4] t^4`, and with extrema that are
/// zero to rounding. The leading coefficient is non-zero.
fn real_roots(a: [f64; 5], mut f: impl FnMut(f64)) {
    let bound = 1.0 + max_abs(&a[..4]) / a[4].abs();
    if !bound.is_finite() {
        return;
    }
    // Between neighbouring roots of its derivative a polynomial has at most one root.
    let (mut knots, mut count) = ([0.0; 5], 0);
    for degree in 1..=4 {
        // Coefficients of the derivative of this degree.
        let falling = |k: usize| (k + 1..=k + 4 - degree).map(|i| i as f64).product::<f64>();
        let p =
            |t: f64| (0..=degree).rev().fold(0.0, |v, k| v * t + falling(k) * a[k + 4 - degree]);
        let (mut roots, mut found) = ([0.0; 5], 0);
        for i in 0..=count {
            let low = if i == 0 { -bound } else { knots[i - 1] };
            let high = if i == count { bound } else { knots[i] };
            if let Some(root) = between(p, low, high) {
                roots[found] = root;
                found += 1;
            }
        }
        if degree == 4 {
            roots[..found].iter().for_each(|t| f(*t));
            for t in &knots[..count] {
                let size = (0..=4).rev().fold(0.0, |v, k| v * t.abs() + a[k].abs());
                if p(*t).abs() <= TANGENT_ROOT * size {
                    f(*t);
                }
            }
        }
        (knots, count) = (roots, found);
    }
}

/// The root of a monotonic function between `low` and `high`, if its sign changes there.
fn between(p: impl Fn(f64) -> f64, low: f64, high: f64) -> Option<f64> {
    let mut bracket = Bracket::new([low, high], [p(low), p(high)])?;
    for _ in 0..100 {
        let Some(t) = bracket.place() else { break };
        let moved = (t - bracket.last()).abs();
        bracket.narrow(t, p(t));
        if moved <= f64::EPSILON * t.abs() {
            break;
        }
    }
    Some(bracket.root())
}

#[cfg(test)]
mod tests;
