//! Spans of twists in dimensionless coordinates: the arithmetic under screw systems.
//!
//! Formula  x = [v(c) / L; w], v(c) = v + w x c: velocity of the body at the centre c
//!          <a, b>_h / L = 1/2 (x_v . y_w + x_w . y_v) - (h / L) x_w . y_w
//! Shapes   basis of k <= 6 orthonormal vectors of 6
//! Units    c, L in m; x [rad/s]
//! Why so   lengths enter only as ratios to L and positions only relative to c, which moves with
//!          the frame: verdicts then depend neither on the frame nor on the unit
//! Checked  tests/it/screws/

use crate::linalg::{Matrix, Svd, SymmetricEigen};
use crate::spatial::{Twist, Vec3};
use crate::tolerance::{FREE_TRANSLATION, NEARLY_PARALLEL};

/// Centre and unit of length of a screw system.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Scale {
    pub(crate) center: Vec3,
    pub(crate) length: f64,
}

impl Scale {
    pub(crate) fn apply(&self, t: Twist) -> [f64; 6] {
        let t = t.at_point(self.center);
        let [a, b, c] = (t.linear * (1.0 / self.length)).to_array();
        let [d, e, f] = t.angular.to_array();
        [a, b, c, d, e, f]
    }

    pub(crate) fn undo(&self, x: &[f64; 6]) -> Twist {
        let t = Twist { linear: linear(x) * self.length, angular: angular(x) };
        t.at_point(-self.center)
    }
}

impl Scale {
    /// `A S` for a matrix A on scaled twists, S the map to them: a matrix on twists.
    pub(crate) fn after_scaling(&self, a: &Matrix) -> Matrix {
        let mut product = Matrix::zeros(a.rows(), 6);
        for j in 0..6 {
            let mut unit = [0.0; 6];
            unit[j] = 1.0;
            let column = self.apply(Twist::from_array(unit));
            a.mul_vec_into(&column, product.column_mut(j));
        }
        product
    }
}

pub(crate) fn linear(x: &[f64; 6]) -> Vec3 {
    Vec3::new(x[0], x[1], x[2])
}

pub(crate) fn angular(x: &[f64; 6]) -> Vec3 {
    Vec3::new(x[3], x[4], x[5])
}

pub(crate) fn join(linear: Vec3, angular: Vec3) -> [f64; 6] {
    [linear.x, linear.y, linear.z, angular.x, angular.y, angular.z]
}

pub(crate) fn dot(a: &[f64; 6], b: &[f64; 6]) -> f64 {
    a.iter().zip(b).map(|(x, y)| x * y).sum()
}

/// The size of a twist: the larger of its parts, the linear one over `length`.
pub(crate) fn size(t: Twist, length: f64) -> f64 {
    (t.linear.norm() / length).max(t.angular.norm())
}

pub(crate) fn over(t: Twist, a: f64) -> Twist {
    Twist::from_array(t.to_array().map(|x| x / a))
}

/// `Q_0 x`: one half of the linear and the angular part exchanged.
pub(crate) fn lowered(x: &[f64; 6], h: f64) -> [f64; 6] {
    if h.is_infinite() {
        return join(Vec3::ZERO, -angular(x));
    }
    join(angular(x) * 0.5, linear(x) * 0.5 - angular(x) * h)
}

/// A subspace with an orthonormal basis.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Span {
    k: usize,
    basis: [[f64; 6]; 6],
}

impl Span {
    pub(crate) const ZERO: Self = Self { k: 0, basis: [[0.0; 6]; 6] };

    /// The span of vectors that are independent; made orthonormal in their order.
    pub(crate) fn of_independent(vectors: impl IntoIterator<Item = [f64; 6]>) -> Self {
        let mut span = Self::ZERO;
        for x in vectors.into_iter().take(6) {
            span.push(x);
        }
        span
    }

    /// Adds the part of `x` outside the span, made a unit vector; says how long it was.
    pub(crate) fn push(&mut self, mut x: [f64; 6]) -> f64 {
        let whole = dot(&x, &x).sqrt();
        let mut norm = self.project_out(&mut x);
        let first = norm;
        if norm == 0.0 {
            return 0.0;
        }
        x = x.map(|a| a / norm);
        if norm < 0.7 * whole {
            // "Twice is enough": a second pass removes what rounding left of the first, where that
            // took away much.
            norm = self.project_out(&mut x);
            x = x.map(|a| a / norm);
        }
        self.basis[self.k] = x;
        self.k += 1;
        first
    }

    /// Adds a vector of any length if the sine of its angle to the span is above `threshold`, and
    /// says what it is.
    pub(crate) fn push_independent(&mut self, x: [f64; 6], threshold: f64) -> Option<f64> {
        let norm = dot(&x, &x).sqrt();
        let unit = x.map(|a| a / norm);
        let mut rest = unit;
        let sine = self.project_out(&mut rest);
        // NaN and the seventh vector fail this.
        if sine > threshold && self.k < 6 {
            self.push(unit);
            return Some(sine);
        }
        None
    }

    /// `x <- (1 - B B^T) x`; returns the length of the remainder.
    pub(crate) fn project_out(&self, x: &mut [f64; 6]) -> f64 {
        for b in self.vectors() {
            let along = dot(b, x);
            x.iter_mut().zip(b).for_each(|(xi, bi)| *xi -= along * bi);
        }
        dot(x, x).sqrt()
    }

    pub(crate) fn k(&self) -> usize {
        self.k
    }

    pub(crate) fn vectors(&self) -> &[[f64; 6]] {
        &self.basis[..self.k]
    }

    /// The basis turned by the right singular vectors of its angular block: angular parts are
    /// orthogonal, largest first.
    pub(crate) fn turned_by_angular_parts(&self) -> impl Iterator<Item = [f64; 6]> + '_ {
        // Rows of zeros make the block tall: the decomposition then has all right singular vectors.
        let block =
            Matrix::from_fn(6, self.k, |i, j| if i < 3 { self.basis[j][3 + i] } else { 0.0 });
        let svd = Svd::of(&block);
        (0..self.k).map(move |i| {
            let mut x = [0.0; 6];
            for (b, v) in self.vectors().iter().zip(svd.v(i)) {
                x.iter_mut().zip(b).for_each(|(xi, bi)| *xi += v * bi);
            }
            x
        })
    }

    /// Directions in which the origin of the twists may move without the span leaving itself, to
    /// rounding or to this angle: those of the translations that are symmetries of the system.
    pub(crate) fn free_translations(&self, angle: f64) -> impl Iterator<Item = Vec3> + use<> {
        let mut a = [[0.0; 3]; 3];
        for x in self.vectors() {
            let change = [Vec3::X, Vec3::Y, Vec3::Z].map(|e| {
                let mut y = join(angular(x).cross(e), Vec3::ZERO);
                self.project_out(&mut y);
                y
            });
            for i in 0..3 {
                for j in i..3 {
                    a[i][j] += dot(&change[i], &change[j]);
                }
            }
        }
        let eigen = SymmetricEigen::of(a, 3);
        let share = FREE_TRANSLATION.max(angle * angle);
        let free = (0..3).filter(move |&i| eigen.values[i] <= share * eigen.values[0]);
        free.map(move |i| Vec3::from_array(eigen.vectors[i]))
    }

    /// The largest angular part of a unit vector.
    pub(crate) fn largest_angular_part(&self) -> f64 {
        self.turned_by_angular_parts().next().map_or(0.0, |x| angular(&x).norm())
    }

    /// The orthogonal complement.
    pub(crate) fn complement(&self) -> Self {
        let mut all = *self;
        // Length squared of each unit vector's part outside the span.
        let mut left: [f64; 6] =
            std::array::from_fn(|i| 1.0 - self.vectors().iter().map(|b| b[i] * b[i]).sum::<f64>());
        while all.k < 6 {
            let most = (0..6).max_by(|&i, &j| left[i].total_cmp(&left[j])).unwrap_or(0);
            let mut unit = [0.0; 6];
            unit[most] = 1.0;
            all.push(unit);
            let newest = all.basis[all.k - 1];
            left.iter_mut().zip(newest).for_each(|(l, b)| *l -= b * b);
        }
        Self::of_independent(all.basis[self.k..].iter().copied())
    }

    /// The twists reciprocal to all of these: the complement with its parts exchanged.
    pub(crate) fn reciprocal(&self) -> Self {
        let complement = self.complement();
        let mut basis = complement.basis;
        for x in &mut basis {
            *x = join(angular(x), linear(x));
        }
        Self { k: complement.k, basis }
    }

    /// The Gram matrix `B^T Q_h B / L`, with `h` in units of L.
    pub(crate) fn gram(&self, h: f64) -> [[f64; 6]; 6] {
        let mut g = [[0.0; 6]; 6];
        for (row, a) in g.iter_mut().zip(self.vectors()) {
            let a = lowered(a, h);
            for (x, b) in row.iter_mut().zip(self.vectors()) {
                *x = dot(&a, b);
            }
        }
        g
    }

    /// Smallest singular value of the Gram matrix: zero where the system meets its own
    /// h-reciprocal system. 1 for the zero system, whose inverse always exists; 0 for NaN.
    pub(crate) fn gram_margin(&self, h: f64) -> f64 {
        if h.is_nan() {
            return 0.0;
        }
        let e = SymmetricEigen::of(self.gram(h), self.k);
        e.values[..self.k].iter().fold(1.0, |m: f64, x| m.min(x.abs()))
    }

    /// The sine of the largest angle by which this span leaves `other`.
    pub(crate) fn sine_to(&self, other: &Self) -> f64 {
        self.vectors()
            .iter()
            .map(|x| {
                let mut rest = *x;
                other.project_out(&mut rest);
                dot(&rest, &rest)
            })
            .sum::<f64>()
            .sqrt()
    }
}

/// True if the twist turns by more than `least` at the scale of `length`; otherwise it is a
/// translation.
pub(crate) fn turns(t: &Twist, length: f64, least: f64) -> bool {
    t.angular.norm() * length > least * t.linear.norm()
}

/// The point that minimises `sum |v_i + w_i x c|^2`, where it is determined; along directions
/// nearly parallel to all axes it stays at the point of one axis, since the exact minimum runs to
/// their far intersection and the axes become one there.
/// Twists that turn by no more than `least` at the scale of `length` are translations, and left
/// out.
pub(crate) fn least_squares_center(twists: &[Twist], length: f64, least: f64) -> Vec3 {
    let turning = || twists.iter().filter(|t| turns(t, length, least));
    let turn = |t: &Twist| t.angular.norm();
    let Some(most) = turning().max_by(|a, b| turn(a).total_cmp(&turn(b))) else {
        return Vec3::ZERO;
    };
    let unit = most.angular * (1.0 / turn(most));
    let start = unit.cross(most.linear * (1.0 / turn(most)));
    let mut a = [[0.0; 3]; 3];
    let mut b = Vec3::ZERO;
    for t in turning() {
        let (w, v) = (t.angular, t.at_point(start).linear);
        // |v + w x d|^2: normal matrix |w|^2 - w w^T, right side w x v.
        let wi = w.to_array();
        for i in 0..3 {
            for j in i..3 {
                a[i][j] += f64::from(u8::from(i == j)) * w.dot(w) - wi[i] * wi[j];
            }
        }
        b += w.cross(v);
    }
    let eigen = SymmetricEigen::of(a, 3);
    let mut c = start;
    for (value, vector) in eigen.values.iter().zip(eigen.vectors) {
        if *value > NEARLY_PARALLEL * eigen.values[0] {
            let e = Vec3::from_array(vector);
            c += e * (e.dot(b) / value);
        }
    }
    if c.is_finite() { c } else { Vec3::ZERO }
}
