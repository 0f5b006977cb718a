//! Ellipsoids of motion and of force, and how few components see them: projection and section.
//!
//! Formula  E = {A x + B y : |x| <= 1}; projection {T u : u in E}, section {v : T^T v in E}, T the
//!          rows of the chosen components; A and B are reduced to principal semi-axes and an
//!          orthonormal basis of the unbounded directions
//! Shapes   A: d x k, B: d x i; k' semi-axes and i' directions of the chosen components
//! Units    of the components; each component has its own scale inside, so that ranks depend on
//!          units only where a component is below 1e-9 of the largest: it counts as at rest
//! Valid    any spectrum, also flat and unbounded ellipsoids; a section of a flat one may be zero
//! Why so   the projection leaves the other components free and the section fixes them at zero, so
//!          the two are different ellipses; a figure must name the one that it draws. Duality
//!          exchanges them: the projection of the velocity ellipsoid is the polar of the section of
//!          the force ellipsoid
//! Source   Yoshikawa 1985; Bicchi & Prattichizzo 1998, section 3
//! Checked  tests/it/manipulability/ellipsoid.rs

use super::efficiency::Spectrum;
use crate::closure::check_components;
use crate::error::Result;
use crate::linalg::{ColumnSpace, Matrix, Qr, Svd, Threshold};
use crate::tolerance::CLOSURE_BLOCK;

/// How an ellipsoid of many components is seen in a few of them.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum EllipsoidView {
    /// Its shadow: the other components are free.
    #[default]
    Projection,
    /// Its cut: the other components are zero.
    Section,
}

impl EllipsoidView {
    /// All of them.
    pub const ALL: [Self; 2] = [Self::Projection, Self::Section];

    /// Its name: `projection` or `section`.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Projection => "projection",
            Self::Section => "section",
        }
    }
}

/// The outputs (twists or wrenches) for inputs of norm at most one.
///
/// ```text
/// E = {A x + B y : |x| <= 1, y arbitrary}
/// ```
///
/// The columns of A are orthogonal and those of B orthonormal in the coordinates of the components,
/// whatever the metric of the efficiencies; A is orthogonal to B.
#[derive(Debug, Clone, PartialEq)]
pub struct Ellipsoid {
    /// Principal semi-axes A, a column each, longest first; fewer than components if it is flat.
    pub semi_axes: Matrix,
    /// Directions B without bound, a column each.
    pub unbounded: Matrix,
}

impl Ellipsoid {
    /// Of a spectrum: of joint velocities or torques of norm one.
    ///
    /// ```
    /// use cylindroid::Matrix;
    /// use cylindroid::closure::{Constraint, MotionSpace};
    /// use cylindroid::manipulability::{Ellipsoid, Manipulability, Metrics};
    ///
    /// // x = y + q_2 / 2, y = q_1: an oblique ellipse.
    /// let jacobian = Matrix::from_rows(&[[1.0, 0.5], [1.0, 0.0]]).unwrap();
    /// let relation = MotionSpace::of(&Constraint::serial(&jacobian)?).relation();
    /// let velocity = Ellipsoid::of(&Manipulability::of(&relation, &Metrics::UNIT)?.kinematic);
    /// let length = |e: Ellipsoid| e.semi_axes[(0, 0)].abs();
    /// // With y free x reaches sqrt(5) / 2, with y = 0 only 1 / 2.
    /// assert!((length(velocity.projection(&[0])?) - 1.25_f64.sqrt()).abs() < 1e-15);
    /// assert!((length(velocity.section(&[0])?) - 0.5).abs() < 1e-15);
    /// # Ok::<(), cylindroid::Error>(())
    /// ```
    #[must_use]
    pub fn of(spectrum: &Spectrum) -> Self {
        let all = Scaled::of(&spectrum.semi_axes(), &spectrum.infinite);
        all.principal(&all.axes, &all.endless, &all.every())
    }

    /// Number of components.
    #[must_use]
    pub fn components(&self) -> usize {
        self.semi_axes.rows()
    }

    /// The ellipsoid in these components, seen as named.
    ///
    /// # Errors
    /// As [`Ellipsoid::projection`].
    pub fn seen(&self, view: EllipsoidView, components: &[usize]) -> Result<Self> {
        match view {
            EllipsoidView::Projection => self.projection(components),
            EllipsoidView::Section => self.section(components),
        }
    }

    /// The projection (shadow) on some components: what they can be if the others are free.
    ///
    /// # Errors
    /// A component that does not exist, or is given twice; none.
    #[doc(alias = "shadow")]
    pub fn projection(&self, components: &[usize]) -> Result<Self> {
        check_components(components, self.components())?;
        let all = Scaled::of(&self.semi_axes, &self.unbounded);
        let axes = rows(&all.axes, components);
        Ok(all.principal(&axes, &rows(&all.endless, components), components))
    }

    /// The section (cut) by some components: what they can be if the others are zero.
    ///
    /// # Errors
    /// As [`Ellipsoid::projection`].
    #[doc(alias = "intersection")]
    pub fn section(&self, components: &[usize]) -> Result<Self> {
        check_components(components, self.components())?;
        let all = Scaled::of(&self.semi_axes, &self.unbounded);
        let others: Vec<usize> =
            all.every().into_iter().filter(|i| !components.contains(i)).collect();
        if others.is_empty() {
            return self.projection(components);
        }
        // Others: C_A x + C_B y = 0. First the x for which there is a y, then the y.
        let (by_x, by_y) = (rows(&all.axes, &others), rows(&all.endless, &others));
        let threshold = Threshold::Absolute(CLOSURE_BLOCK);
        let reached = ColumnSpace::of(&by_y, threshold);
        let missed =
            if by_y.cols() == 0 { Matrix::identity(others.len()) } else { reached.complement() };
        let x = kernel(&(&missed.transpose() * &by_x), threshold);
        let demand = &by_x * &x;
        let mut axes = &rows(&all.axes, components) * &x;
        let kept = rows(&all.endless, components);
        if by_y.cols() > 0 && x.cols() > 0 {
            let svd = Svd::of(&by_y);
            for j in 0..x.cols() {
                let answer = svd.solve(demand.column(j), reached.rank());
                let moved = kept.mul_vec(&answer);
                axes.column_mut(j).iter_mut().zip(moved).for_each(|(a, m)| *a -= m);
            }
        }
        let endless = &kept * &kernel(&by_y, threshold);
        Ok(all.principal(&axes, &endless, components))
    }
}

/// The columns of both parts with every component divided by its largest value: ranks are then
/// independent of units.
struct Scaled {
    /// Of size one.
    axes: Matrix,
    /// Orthonormal.
    endless: Matrix,
    /// Of each component; zero for one that never moves.
    size: Vec<f64>,
    /// Of the semi-axes.
    factor: f64,
}

impl Scaled {
    fn of(axes: &Matrix, endless: &Matrix) -> Self {
        let largest = |a: &Matrix| if a.max_abs() > 0.0 { a.max_abs() } else { 1.0 };
        let (of_axes, of_endless) = (largest(axes), largest(endless));
        let row = |a: &Matrix, i: usize, by: f64| {
            (0..a.cols()).fold(0.0, |m: f64, j| m.max(a[(i, j)].abs() / by))
        };
        let size: Vec<f64> = (0..axes.rows())
            .map(|i| row(axes, i, of_axes).max(row(endless, i, of_endless)))
            .map(|size| if size > CLOSURE_BLOCK { size } else { 0.0 })
            .collect();
        let scaled = |a: &Matrix, by: f64| {
            Matrix::from_fn(a.rows(), a.cols(), |i, j| {
                if size[i] > 0.0 { a[(i, j)] / (size[i] * by) } else { 0.0 }
            })
        };
        let endless = scaled(endless, of_endless);
        let endless = if endless.cols() > 0 { Qr::plain(endless).basis() } else { endless };
        Self { axes: scaled(axes, of_axes), endless, size, factor: of_axes }
    }

    fn every(&self) -> Vec<usize> {
        (0..self.size.len()).collect()
    }

    /// The parts, given in scaled coordinates of some components, in principal form.
    fn principal(&self, axes: &Matrix, endless: &Matrix, components: &[usize]) -> Ellipsoid {
        let d = components.len();
        let size: Vec<f64> = components.iter().map(|&i| self.size[i]).collect();
        let unscaled =
            |a: &Matrix, by: f64| Matrix::from_fn(d, a.cols(), |i, j| a[(i, j)] * size[i] * by);
        let threshold = Threshold::Absolute(CLOSURE_BLOCK);
        let mut unbounded = Matrix::zeros(d, 0);
        if endless.cols() > 0 {
            let space = ColumnSpace::of(endless, threshold);
            if space.rank() > 0 {
                unbounded = Qr::plain(unscaled(&space.basis(), 1.0)).basis();
            }
        }
        // The part of the semi-axes across the unbounded directions.
        let mut across = unscaled(axes, self.factor);
        let along = &unbounded * &(&unbounded.transpose() * &across);
        across.as_mut_slice().iter_mut().zip(along.as_slice()).for_each(|(a, b)| *a -= b);
        if across.cols() == 0 {
            return Ellipsoid { semi_axes: across, unbounded };
        }
        let scaled = Matrix::from_fn(d, across.cols(), |i, j| {
            if size[i] > 0.0 { across[(i, j)] / (size[i] * self.factor) } else { 0.0 }
        });
        let rank = ColumnSpace::of(&scaled, threshold).rank();
        let svd = Svd::of(&across);
        let semi_axes = Matrix::from_fn(d, rank, |i, j| svd.u(j)[i] * svd.value(j));
        Ellipsoid { semi_axes, unbounded }
    }
}

fn rows(a: &Matrix, chosen: &[usize]) -> Matrix {
    Matrix::from_fn(chosen.len(), a.cols(), |i, j| a[(chosen[i], j)])
}

/// The kernel of a matrix of size one at most, orthonormal.
fn kernel(a: &Matrix, threshold: Threshold) -> Matrix {
    if a.rows() == 0 || a.cols() == 0 {
        return Matrix::identity(a.cols());
    }
    ColumnSpace::of(&a.transpose(), threshold).complement()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// In other units of the semi-axes, also of a component that moves by directions without an end.
    #[test]
    fn scaled_columns_do_not_depend_on_units() {
        let endless = Matrix::from_fn(3, 1, |i, _| [0.0, 0.6, 0.8][i]);
        let of = |unit: f64| {
            let sizes = [[1.0, 0.0], [0.2, 2.0], [0.5, 0.0]];
            Scaled::of(&Matrix::from_fn(3, 2, |i, j| unit * sizes[i][j]), &endless)
        };
        let expected = of(1.0);
        for unit in [1e-9, 1e-3, 1e9] {
            let scaled = of(unit);
            for (a, b) in scaled.axes.as_slice().iter().zip(expected.axes.as_slice()) {
                assert!((a - b).abs() < 1e-14, "{unit}: {:?}", scaled.axes);
            }
            assert!((scaled.factor / expected.factor / unit - 1.0).abs() < 1e-14, "{unit}");
        }
    }
}
