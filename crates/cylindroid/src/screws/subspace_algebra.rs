//! Algebra of screw systems: reciprocal, sum, intersection, membership.
//!
//! Formula  S^perp = {r : <r, s>_0 = 0}, S^{perp h} = {(w, v + 2 h w) : (w, v) in S^perp};
//!          S + T by the rank of both bases, S n T by the null vectors of the part of S outside T
//! Shapes   orders k and 6 - k; dim (S + T) + dim (S n T) = dim S + dim T
//! Units    h in m/rad; sines without unit, at the centre and length of the first system
//! Source   Donelan & Selig, section 4 (the h-reciprocal system from the reciprocal one: corollary
//!          4 with the sign that ordinary reciprocity needs)
//! Checked  tests/it/screws/laws.rs

use super::span::{Span, angular, join, linear};
use super::span_estimation::six;
use super::system::ScrewSystem;
use crate::linalg::{Matrix, Rank, Svd};

impl ScrewSystem {
    /// All twists reciprocal to these, of order 6 - k: wrenches on their screws do no work.
    ///
    /// ```
    /// use cylindroid::screws::{Line, ScrewOptions, ScrewSystem};
    /// use cylindroid::Vec3;
    ///
    /// let revolute = Line { point: Vec3::ZERO, direction: Vec3::Z };
    /// let system = ScrewSystem::of(&[revolute.twist()], &ScrewOptions::default())?;
    /// // Five independent wrenches do no work on a single rotation.
    /// assert_eq!(system.reciprocal().order(), 5);
    /// # Ok::<(), cylindroid::Error>(())
    /// ```
    #[doc(alias = "constraint wrenches")]
    #[must_use]
    pub fn reciprocal(&self) -> Self {
        self.derived(self.span.reciprocal())
    }

    /// The h-reciprocal system: all twists a with `<a, s>_h = 0` for every s of the system.
    ///
    /// ```text
    /// S^{perp h} = {(v + 2 h w, w) : (v, w) in S^perp}
    /// ```
    ///
    /// `h` in m/rad: every pitch of the reciprocal system rises by 2 h. For an infinite pitch, the
    /// twists whose angular part is orthogonal to every angular part of the system, of order 6 -
    /// dim or more. Source: Donelan & Selig, eq. 10.
    #[must_use]
    pub fn h_reciprocal(&self, h: f64) -> Self {
        if h.is_infinite() {
            let turning = self.form_at_infinity();
            return self.derived(turning);
        }
        let h = h / self.scale.length;
        let reciprocal = self.span.reciprocal();
        let shifted = reciprocal
            .vectors()
            .iter()
            .map(|x| join(linear(x) + angular(x) * (2.0 * h), angular(x)));
        self.derived(Span::of_independent(shifted))
    }

    /// The twists that are reciprocal to the system in the form at infinity.
    fn form_at_infinity(&self) -> Span {
        let mut across = Matrix::zeros(6, self.span.k());
        for (j, x) in self.span.vectors().iter().enumerate() {
            across.column_mut(j)[3..].copy_from_slice(&x[3..]);
        }
        let svd = Svd::of(&across);
        let kept = (0..svd.len()).filter(|&i| svd.value(i) > self.tolerance.class);
        Span::of_independent(kept.map(|i| six(svd.u(i)))).complement()
    }

    /// All twists that are sums of one of each.
    ///
    /// ```
    /// use cylindroid::screws::{ScrewOptions, ScrewSystem};
    /// use cylindroid::{Twist, Vec3};
    ///
    /// let slide = |linear| Twist { linear, angular: Vec3::ZERO };
    /// let along = |linear| ScrewSystem::of(&[slide(linear)], &ScrewOptions::default());
    /// let plane = along(Vec3::X)?.sum(&along(Vec3::Y)?);
    /// assert!(plane.order() == 2 && plane.sine_to(slide(Vec3::X - Vec3::Y)) < 1e-15);
    /// # Ok::<(), cylindroid::Error>(())
    /// ```
    #[must_use]
    pub fn sum(&self, other: &Self) -> Self {
        let both =
            self.span.vectors().iter().copied().chain(self.rescaled(other).vectors().to_vec());
        let columns: Vec<[f64; 6]> = both.collect();
        let svd = Svd::of(&Matrix::from_fn(6, columns.len(), |i, j| columns[j][i]));
        let threshold = self.joint_tolerance(other);
        let k = (0..svd.len()).filter(|&i| svd.value(i) > threshold).count();
        let span = Span::of_independent((0..k).map(|i| six(svd.u(i))));
        self.derived(span)
    }

    /// All twists that are in both.
    ///
    /// ```
    /// use cylindroid::screws::{Line, ScrewOptions, ScrewSystem};
    /// use cylindroid::Vec3;
    ///
    /// let options = ScrewOptions::default();
    /// let axis = |direction| Line { point: Vec3::ZERO, direction }.twist();
    /// let a = ScrewSystem::of(&[axis(Vec3::X), axis(Vec3::Y)], &options)?;
    /// let b = ScrewSystem::of(&[axis(Vec3::Y), axis(Vec3::Z)], &options)?;
    /// assert_eq!((a.sum(&b).order(), a.intersection(&b).order()), (3, 1));
    /// # Ok::<(), cylindroid::Error>(())
    /// ```
    #[must_use]
    pub fn intersection(&self, other: &Self) -> Self {
        let theirs = self.rescaled(other);
        let k = self.span.k();
        if k == 0 || theirs.k() == 0 {
            return self.derived(Span::ZERO);
        }
        // What of this basis is outside the other: its null vectors are in both.
        // A row of zeros makes the matrix tall: the decomposition then has all of them.
        let mut outside = Matrix::zeros(7, k);
        for (j, x) in self.span.vectors().iter().enumerate() {
            let mut rest = *x;
            theirs.project_out(&mut rest);
            outside.column_mut(j)[..6].copy_from_slice(&rest);
        }
        let svd = Svd::of(&outside);
        let threshold = self.joint_tolerance(other);
        let common = (0..k).filter(|&i| svd.value(i) <= threshold).map(|i| {
            let mut x = [0.0; 6];
            for (b, v) in self.span.vectors().iter().zip(svd.v(i)) {
                x.iter_mut().zip(b).for_each(|(xi, bi)| *xi += v * bi);
            }
            x
        });
        self.derived(Span::of_independent(common))
    }

    /// The sine of the largest angle between a twist of this system and the other: zero if this
    /// one lies in the other.
    ///
    /// ```
    /// use cylindroid::screws::{ScrewOptions, ScrewSystem};
    /// use cylindroid::{Twist, Vec3};
    ///
    /// let slide = |linear| Twist { linear, angular: Vec3::ZERO };
    /// let options = ScrewOptions::default();
    /// let line = ScrewSystem::of(&[slide(Vec3::X)], &options)?;
    /// let plane = ScrewSystem::of(&[slide(Vec3::X), slide(Vec3::Y)], &options)?;
    /// // The line lies in the plane, the plane not in the line.
    /// assert!(line.sine_to_system(&plane) < 1e-15 && plane.sine_to_system(&line) > 1.0 - 1e-15);
    /// # Ok::<(), cylindroid::Error>(())
    /// ```
    #[must_use]
    pub fn sine_to_system(&self, other: &Self) -> f64 {
        self.span.sine_to(&self.rescaled(other)).min(1.0)
    }

    /// The other's span in the scale of this one.
    pub(super) fn rescaled(&self, other: &Self) -> Span {
        if other.scale == self.scale {
            return other.span;
        }
        Span::of_independent(other.basis().into_iter().map(|t| self.scale.apply(t)))
    }

    pub(super) fn joint_tolerance(&self, other: &Self) -> f64 {
        self.tolerance.class.max(other.tolerance.class)
    }

    /// A system made from this one, as exactly known as this one.
    fn derived(&self, span: Span) -> Self {
        let rank = Rank { rank: span.k(), threshold: self.rank().threshold, gap: self.rank().gap };
        Self::classified(span, self.scale, self.tolerance, rank)
    }
}
