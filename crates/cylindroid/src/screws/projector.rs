//! Frame-invariant projectors of twists onto a screw system, and their action on wrenches.
//!
//! Formula  P_h = B (B^T Q_h B)^-1 B^T Q_h, along the h-reciprocal system
//!          P_inf = lim P_h for |h| -> inf: for systems without translations (order <= 3) the fit
//!          of the angular part alone; for order >= 3 with a reciprocal system R without
//!          translations 1 - [R_w; 0] (R_w^T R_w)^-1 R^T Pi: keeps the angular part, corrects the
//!          linear part along the reciprocal axes
//!          along any complement Z: P = B (K^T B)^-1 K^T, K a basis of Z's annihilator (eq. 26)
//!          on wrenches 1 - P^T: onto the wrenches that do no work on the system
//! Shapes   B: 6 x k; P: 6 x 6
//! Units    h in m/rad
//! Valid    P_h exists where B^T Q_h B is regular; for orders 4 and 5 it is computed from the
//!          reciprocal system, where the matrix to be inverted is 2 x 2 or 1 x 1:
//!          P_h = 1 - Q_h^-1 N (N^T Q_h^-1 N)^-1 N^T, N the orthogonal complement
//! Why so   the existence is decided by the smallest singular value of B^T Q_{h/L} B, not by the
//!          name of the class, which is discontinuous
//! Source   Donelan & Selig, sections 4 and 6.3, eq. (26); P* of the wrenches is 1 - P^T there,
//!          so that no second inverse is needed
//! Checked  tests/it/screws/laws.rs, tests/it/screws/vectors/

use super::span::{Scale, Span, angular, dot, join, linear, lowered};
use super::system::ScrewSystem;
use crate::linalg::{Matrix, Svd, SymmetricEigen};
use crate::spatial::{Twist, Vec3, Wrench};

/// A projector on a screw system, along another.
#[derive(Debug, Clone, PartialEq)]
pub struct Projector {
    pub(super) scale: Scale,
    pub(super) span: Span,
    /// Row i: the coordinate of the projection along the i-th basis vector.
    pub(super) coordinates: [[f64; 6]; 6],
}

impl Projector {
    /// The part of a twist that lies in the system.
    ///
    /// ```
    /// use cylindroid::screws::{Complement, Projector, ScrewOptions};
    /// use cylindroid::{Twist, Vec3};
    ///
    /// // A revolute joint about z; along the 0.1-reciprocal twists.
    /// let revolute = Twist { linear: Vec3::ZERO, angular: Vec3::Z };
    /// let along = Complement::Reciprocal { h: 0.1 };
    /// let projector = Projector::of(&[revolute], along, &ScrewOptions::default())?.unwrap();
    /// let twist = Twist { linear: Vec3::X, angular: Vec3::Z };
    /// assert_eq!(projector.motion(twist), revolute);
    /// assert_eq!(projector.rest(twist), Twist { linear: Vec3::X, angular: Vec3::ZERO });
    /// # Ok::<(), cylindroid::Error>(())
    /// ```
    #[must_use]
    pub fn motion(&self, twist: Twist) -> Twist {
        let x = self.scale.apply(twist);
        let mut y = [0.0; 6];
        for (b, c) in self.span.vectors().iter().zip(&self.coordinates) {
            let along = dot(c, &x);
            y.iter_mut().zip(b).for_each(|(yi, bi)| *yi += along * bi);
        }
        self.scale.undo(&y)
    }

    /// The rest of the twist: the part that the projector discards.
    #[must_use]
    pub fn rest(&self, twist: Twist) -> Twist {
        twist - self.motion(twist)
    }

    /// The part of a wrench that does no work on the system: P* of the wrenches. The discarded part
    /// does no work on the twists that [`Projector::motion`] discards.
    ///
    /// ```
    /// use cylindroid::screws::{Complement, Projector, ScrewOptions};
    /// use cylindroid::{Twist, Vec3, Wrench};
    ///
    /// // What a revolute joint about z can resist: all but a moment about z.
    /// let revolute = Twist { linear: Vec3::ZERO, angular: Vec3::Z };
    /// let along = Complement::Reciprocal { h: 0.1 };
    /// let projector = Projector::of(&[revolute], along, &ScrewOptions::default())?.unwrap();
    /// let wrench = Wrench { force: Vec3::Y, moment: Vec3::new(0.0, 2.0, 3.0) };
    /// assert!(revolute.power(projector.constraint(wrench)).abs() < 1e-15);
    /// # Ok::<(), cylindroid::Error>(())
    /// ```
    #[must_use]
    pub fn constraint(&self, wrench: Wrench) -> Wrench {
        let w = wrench.at_point(self.scale.center);
        let y = join(w.force * self.scale.length, w.moment);
        let mut z = y;
        for (b, c) in self.span.vectors().iter().zip(&self.coordinates) {
            let along = dot(b, &y);
            z.iter_mut().zip(c).for_each(|(zi, ci)| *zi -= along * ci);
        }
        Wrench { force: linear(&z) * (1.0 / self.scale.length), moment: angular(&z) }
            .at_point(-self.scale.center)
    }

    /// The 6 x 6 matrix on twists (linear part first) in the frame of the system.
    #[must_use]
    pub fn matrix(&self) -> Matrix {
        let mut p = Matrix::zeros(6, 6);
        for j in 0..6 {
            let mut unit = [0.0; 6];
            unit[j] = 1.0;
            p.column_mut(j).copy_from_slice(&self.motion(Twist::from_array(unit)).to_array());
        }
        p
    }

    /// P*: the 6 x 6 matrix of [`Projector::constraint`] on wrenches (force first) in the frame of
    /// the system.
    ///
    /// ```text
    /// P* = 1 - P^T
    /// ```
    ///
    /// ```
    /// use cylindroid::screws::{Line, ScrewOptions, ScrewSystem};
    /// use cylindroid::Vec3;
    ///
    /// // No wrench that remains has a moment about the axis of a revolute joint along z.
    /// let revolute = Line { point: Vec3::ZERO, direction: Vec3::Z };
    /// let system = ScrewSystem::of(&[revolute.twist()], &ScrewOptions::default())?;
    /// let remaining = system.projector(0.1).unwrap().constraint_matrix();
    /// assert!((0..6).all(|column| remaining[(5, column)].abs() < 1e-15));
    /// # Ok::<(), cylindroid::Error>(())
    /// ```
    #[must_use]
    pub fn constraint_matrix(&self) -> Matrix {
        let mut p = Matrix::zeros(6, 6);
        for j in 0..6 {
            let mut unit = [0.0; 6];
            unit[j] = 1.0;
            let image = self.constraint(Wrench::from_array(unit));
            p.column_mut(j).copy_from_slice(&image.to_array());
        }
        p
    }

    /// The largest factor by which a twist is enlarged, at the centre and length of the system: 1
    /// for an orthogonal projector, large where the two systems nearly intersect.
    #[must_use]
    pub fn norm(&self) -> f64 {
        let k = self.span.k();
        if k == 0 {
            return 0.0;
        }
        Svd::of(&Matrix::from_fn(6, k, |i, j| self.coordinates[j][i])).value(0)
    }

    /// Row i times a twist: the coordinate of its projection along basis vector i (k x 6).
    pub(crate) fn coordinate_matrix(&self) -> Matrix {
        let k = self.span.k();
        self.scale.after_scaling(&Matrix::from_fn(k, 6, |i, j| self.coordinates[i][j]))
    }

    /// Twists that are dropped, as many as the system lacks to six.
    pub(crate) fn kernel(&self) -> Vec<Twist> {
        let rows = self.coordinates.iter().take(self.span.k()).copied();
        let kernel = Span::of_independent(rows).complement();
        kernel.vectors().iter().map(|x| self.scale.undo(x)).collect()
    }
}

/// Rows `i` such that row i times x is the coordinate along basis vector i of P_h x; `None` where
/// a matrix to be inverted is singular in floating point. `h` in units of L, or infinite.
pub(crate) fn coordinates(span: &Span, h: f64) -> Option<[[f64; 6]; 6]> {
    let k = span.k();
    let mut rows = [[0.0; 6]; 6];
    if k == 6 {
        rows.copy_from_slice(span.vectors());
        return Some(rows);
    }
    if k <= 3 && (h.is_finite() || !has_translations(span)) {
        for (row, b) in rows.iter_mut().zip(span.vectors()) {
            *row = lowered(b, h);
        }
        let mut gram = span.gram(h);
        solve(&mut gram, &mut rows, k)?;
        return Some(rows);
    }
    if h.is_infinite() && k < 3 {
        return None;
    }
    // From the complement: the discarded part is Q_h^-1 N times the coordinates below.
    let normal = span.complement();
    let n = normal.k();
    let raised = |x: &[f64; 6]| {
        if h.is_infinite() {
            join(linear(x), Vec3::ZERO)
        } else {
            join(angular(x) * 2.0 + linear(x) * (4.0 * h), linear(x) * 2.0)
        }
    };
    let mut dropped: [[f64; 6]; 6] = [[0.0; 6]; 6];
    let mut small = [[0.0; 6]; 6];
    for (i, x) in normal.vectors().iter().enumerate() {
        dropped[i] = raised(x);
        for (j, y) in normal.vectors().iter().enumerate() {
            small[i][j] = dot(&dropped[i], y);
        }
    }
    // small is symmetric: (N^T Q^-1 N)^-1 N^T.
    let mut kept = [[0.0; 6]; 6];
    kept[..n].copy_from_slice(normal.vectors());
    solve(&mut small, &mut kept, n)?;
    for (row, b) in rows.iter_mut().zip(span.vectors()) {
        // b^T (1 - D K) with D the columns of the discarded part.
        *row = *b;
        for (d, k) in dropped.iter().zip(&kept).take(n) {
            let along = dot(b, d);
            row.iter_mut().zip(k).for_each(|(r, ki)| *r -= along * ki);
        }
    }
    Some(rows)
}

/// Rows `i` such that row i times x is the coordinate along basis vector i of the part of x in
/// `span`, the rest being in `other`; `None` if the two do not split the space, to `tolerance`.
pub(crate) fn oblique_coordinates(
    span: &Span,
    other: &Span,
    tolerance: f64,
) -> Option<[[f64; 6]; 6]> {
    let k = span.k();
    if k + other.k() != 6 {
        return None;
    }
    let annihilator = other.complement();
    let mut rows = [[0.0; 6]; 6];
    rows[..k].copy_from_slice(annihilator.vectors());
    let mut cosines = [[0.0; 6]; 6];
    for (row, a) in cosines.iter_mut().zip(annihilator.vectors()) {
        for (x, b) in row.iter_mut().zip(span.vectors()) {
            *x = dot(a, b);
        }
    }
    solve(&mut cosines, &mut rows, k)?;
    // The rows are as long as one over the sine of the smallest angle between the two.
    let size: f64 = rows.iter().take(k).map(|row| dot(row, row)).sum();
    (size.sqrt() * tolerance < 1.0).then_some(rows)
}

fn has_translations(span: &Span) -> bool {
    let mut a = [[0.0; 6]; 6];
    for (i, x) in span.vectors().iter().enumerate() {
        for (j, y) in span.vectors().iter().enumerate() {
            a[i][j] = angular(x).dot(angular(y));
        }
    }
    let k = span.k();
    // Squares of sines: rounding leaves eps of a zero.
    k > 0 && SymmetricEigen::of(a, k).values[k - 1] <= 16.0 * f64::EPSILON
}

/// `rows <- a^-1 rows` for the leading n x n block, by elimination with pivots; `None` if a pivot
/// is zero.
pub(crate) fn solve(a: &mut [[f64; 6]; 6], rows: &mut [[f64; 6]; 6], n: usize) -> Option<()> {
    for p in 0..n {
        let pivot = (p..n).max_by(|&i, &j| a[i][p].abs().total_cmp(&a[j][p].abs()))?;
        a.swap(p, pivot);
        rows.swap(p, pivot);
        let (diagonal, top, row) = (a[p][p], a[p], rows[p]);
        if diagonal == 0.0 || !diagonal.is_finite() {
            return None;
        }
        for i in p + 1..n {
            let factor = a[i][p] / diagonal;
            for j in p..n {
                a[i][j] -= factor * top[j];
            }
            rows[i].iter_mut().zip(row).for_each(|(x, y)| *x -= factor * y);
        }
    }
    for p in (0..n).rev() {
        let mut row = rows[p];
        for j in p + 1..n {
            let below = rows[j];
            row.iter_mut().zip(below).for_each(|(x, y)| *x -= a[p][j] * y);
        }
        rows[p] = row.map(|x| x / a[p][p]);
    }
    Some(())
}

impl ScrewSystem {
    /// The projector on this system along its h-reciprocal system; `None` where
    /// [`ScrewSystem::existence`] says that there is none.
    ///
    /// ```text
    /// P_h = J (J^T Q_h J)^-1 J^T Q_h for any basis J,   h_i the principal pitches:
    /// P_h = sum_i s_i s_i^T Q_h / (h_i - h) for type A and order <= 3, |w_i| = 1
    /// ```
    ///
    /// `h` in m/rad, infinite for the limit. Frame: that of the system. Source: Donelan & Selig,
    /// section 6.1; the sum is not in the paper.
    ///
    /// ```
    /// use cylindroid::screws::{Line, ScrewOptions, ScrewSystem};
    /// use cylindroid::Vec3;
    ///
    /// let revolute = Line { point: Vec3::ZERO, direction: Vec3::Z };
    /// let system = ScrewSystem::of(&[revolute.twist()], &ScrewOptions::default())?;
    /// let projector = system.projector(0.1).unwrap();
    /// let kept = projector.motion(revolute.twist());
    /// assert!((kept.angular - Vec3::Z).norm() < 1e-15);
    /// # Ok::<(), cylindroid::Error>(())
    /// ```
    #[must_use]
    pub fn projector(&self, h: f64) -> Option<Projector> {
        if !self.existence(h).exists {
            return None;
        }
        let coordinates = coordinates(&self.span, h / self.scale.length)?;
        Some(Projector { scale: self.scale, span: self.span, coordinates })
    }

    /// The oblique projector on this system along `complement`; `None` if the two do not split the
    /// space of twists: their orders do not add up to six, or they meet.
    ///
    /// ```text
    /// P = J (K^T J)^-1 K^T,   K: wrenches that do no work on `complement`
    /// ```
    ///
    /// Source: Donelan & Selig, eq. 26.
    #[must_use]
    pub fn projector_along(&self, complement: &Self) -> Option<Projector> {
        let theirs = self.rescaled(complement);
        let coordinates =
            oblique_coordinates(&self.span, &theirs, self.joint_tolerance(complement))?;
        Some(Projector { scale: self.scale, span: self.span, coordinates })
    }
}
