//! Linear inequalities on the unknowns of a step: bounds of each unknown, and further rows.
//!
//! Formula  lower_i <= g_i^T y <= upper_i, where the first rows may be those of the unit matrix
//! Shapes   y: n; further rows: n x r, one column each
//! Units    of the unknowns: scaled joint velocities, or actuated motions of a closed chain
//! Valid    infinite and equal bounds
//! Checked  src/control/solver/hierarchy/tests.rs

use crate::linalg::{Matrix, dot, norm};

/// The rows and their bounds.
#[derive(Debug, Clone)]
pub(in crate::control) struct Inequalities {
    /// Number of unit rows: 0 or n.
    boxed: usize,
    /// The further rows, one column each.
    normals: Matrix,
    lengths: Vec<f64>,
    pub(in crate::control) lower: Vec<f64>,
    pub(in crate::control) upper: Vec<f64>,
}

impl Inequalities {
    /// Without bounds: n unit rows if `boxed`, then `more` rows of zeros.
    pub(in crate::control) fn new(n: usize, boxed: bool, more: usize) -> Self {
        let boxed = if boxed { n } else { 0 };
        Self {
            boxed,
            normals: Matrix::zeros(n, more),
            lengths: vec![0.0; more],
            lower: vec![f64::NEG_INFINITY; boxed + more],
            upper: vec![f64::INFINITY; boxed + more],
        }
    }

    /// Number of rows.
    pub(super) fn len(&self) -> usize {
        self.lower.len()
    }

    /// Number of unit rows.
    pub(super) fn boxed(&self) -> usize {
        self.boxed
    }

    /// Sets the further row `place` (counted after the unit rows).
    pub(in crate::control) fn set_row(&mut self, place: usize, entry: impl Fn(usize) -> f64) {
        let column = self.normals.column_mut(place);
        column.iter_mut().enumerate().for_each(|(j, x)| *x = entry(j));
        self.lengths[place] = norm(column);
    }

    /// True if no motion satisfies or violates the row: all entries are zero.
    pub(super) fn is_empty(&self, i: usize) -> bool {
        i >= self.boxed && self.lengths[i - self.boxed] == 0.0
    }

    /// `g_i^T y`
    #[inline]
    pub(in crate::control) fn value(&self, i: usize, y: &[f64]) -> f64 {
        if i < self.boxed { y[i] } else { dot(self.normals.column(i - self.boxed), y) }
    }

    /// |g_i|
    #[inline]
    pub(in crate::control) fn length(&self, i: usize) -> f64 {
        if i < self.boxed { 1.0 } else { self.lengths[i - self.boxed] }
    }

    /// Moves y into the bounds of the unit rows.
    pub(in crate::control) fn clamp_to_box(&self, y: &mut [f64]) {
        for (i, y) in y.iter_mut().enumerate().take(self.boxed) {
            let (excess, sign) = self.excess(i, *y);
            if excess > 0.0 {
                *y = self.bound(i, sign);
            }
        }
    }

    /// Writes `sign * g_i`.
    pub(super) fn write(&self, i: usize, sign: f64, out: &mut [f64]) {
        if i < self.boxed {
            out.fill(0.0);
            out[i] = sign;
        } else {
            out.iter_mut()
                .zip(self.normals.column(i - self.boxed))
                .for_each(|(o, g)| *o = sign * g);
        }
    }

    /// The largest share of y in [0, 1] that is within all bounds; `None` if none is.
    pub(in crate::control) fn share_within(&self, y: &[f64]) -> Option<f64> {
        let (mut least, mut most) = (0.0_f64, 1.0_f64);
        for i in 0..self.len() {
            let value = self.value(i, y);
            let (enter, leave) = crossings((0.0, value), (self.lower[i], self.upper[i]))?;
            (least, most) = (least.max(enter), most.min(leave));
        }
        (least <= most).then_some(most)
    }

    /// True if the row permits one value only.
    pub(super) fn is_equality(&self, i: usize) -> bool {
        self.lower[i] == self.upper[i]
    }

    /// Distance by which a value of row `i` is beyond its bounds, and the sign of that bound; 0
    /// within.
    pub(super) fn excess(&self, i: usize, value: f64) -> (f64, f64) {
        if value > self.upper[i] {
            (value - self.upper[i], 1.0)
        } else if value < self.lower[i] {
            (self.lower[i] - value, -1.0)
        } else {
            (0.0, 1.0)
        }
    }

    /// The bound of row `i` on the side of `sign`.
    pub(super) fn bound(&self, i: usize, sign: f64) -> f64 {
        if sign > 0.0 { self.upper[i] } else { self.lower[i] }
    }
}

/// The ends of the range of s in which `a + s b` is within the bounds; `None` if b is 0 and a beyond them.
pub(in crate::control) fn crossings(
    (a, b): (f64, f64),
    (lower, upper): (f64, f64),
) -> Option<(f64, f64)> {
    if b == 0.0 {
        return (lower <= a && a <= upper).then_some((f64::NEG_INFINITY, f64::INFINITY));
    }
    let (below, above) = ((lower - a) / b, (upper - a) / b);
    Some(if b > 0.0 { (below, above) } else { (above, below) })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_share_within_is_the_largest() {
        let mut set = Inequalities::new(2, true, 0);
        (set.lower, set.upper) = (vec![-1.0, -2.0], vec![1.0, 2.0]);
        assert_eq!(set.share_within(&[2.0, 1.0]), Some(0.5));
        assert_eq!(set.share_within(&[-0.5, 1.0]), Some(1.0));
        assert_eq!(set.share_within(&[0.0, 8.0]), Some(0.25));
        // A velocity that cannot end at once.
        set.lower[0] = 0.5;
        assert_eq!(set.share_within(&[2.0, 1.0]), Some(0.5));
        assert_eq!(set.share_within(&[0.0, 1.0]), None);
        assert_eq!(set.share_within(&[-1.0, 1.0]), None);
        assert_eq!(set.share_within(&[0.9, 9.0]), None);
    }
}
