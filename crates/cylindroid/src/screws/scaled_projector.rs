//! Projectors in scaled coordinates, without allocation: computed by a control loop at every step.
//!
//! Formula  as in `projector.rs` and in `inverse/hyperbolic.rs`, with L = 1 and the centre at the
//!          origin of the coordinates
//! Shapes   P: 6 x 6 on [v / L; w]
//! Units    none; pitches in units of L
//! Valid    no allocation
//! Checked  tests/it/servo/projection.rs, tests/allocation/main.rs

use super::existence::NoInverse;
use super::projector::{coordinates, oblique_coordinates};
use super::span::{Span, dot, lowered};
use crate::linalg::SymmetricEigen;
use crate::tolerance::SCREW_CLASS;

/// A 6 x 6 matrix that takes a motion to the part that an arm takes on.
#[derive(Debug, Clone, Copy)]
pub(crate) struct ScaledProjector {
    rows: [[f64; 6]; 6],
}

impl ScaledProjector {
    /// P_h on the span of orthonormal `motions`; `h` in units of L. `None` where a matrix to be
    /// inverted is exactly singular.
    pub(crate) fn hyperbolic(motions: impl Iterator<Item = [f64; 6]>, h: f64) -> Option<Self> {
        let span = Span::of_independent(motions);
        coordinates(&span, h).map(|rows| Self::from_coordinates(&span, &rows))
    }

    /// The projector on `motions` along `given_up`.
    pub(crate) fn oblique(
        motions: impl Iterator<Item = [f64; 6]>,
        given_up: impl Iterator<Item = [f64; 6]>,
    ) -> Result<Self, NoInverse> {
        let (span, other) = (Span::of_independent(motions), Span::of_independent(given_up));
        let rows = oblique_coordinates(&span, &other, SCREW_CLASS)
            .ok_or(NoInverse::NotComplementary { order: span.k(), other: other.k() })?;
        Ok(Self::from_coordinates(&span, &rows))
    }

    /// `sum gain(g) y y^T Q_h` over the eigenvalues g of the Gram matrix of `twists`, y the
    /// combinations of the twists that belong to them; the eigenvalue that has no gain otherwise.
    pub(crate) fn damped(
        twists: impl Iterator<Item = [f64; 6]>,
        h: f64,
        gain: impl Fn(f64) -> Option<f64>,
    ) -> Result<Self, f64> {
        let mut t = [[0.0; 6]; 6];
        let mut k = 0;
        for x in twists.take(6) {
            t[k] = x;
            k += 1;
        }
        let mut gram = [[0.0; 6]; 6];
        for (row, a) in gram.iter_mut().zip(&t) {
            let a = lowered(a, h);
            for (x, b) in row.iter_mut().zip(&t) {
                *x = dot(&a, b);
            }
        }
        let eigen = SymmetricEigen::of(gram, k);
        let mut rows = [[0.0; 6]; 6];
        for (&g, vector) in eigen.values.iter().zip(&eigen.vectors).take(k) {
            let gain = gain(g).ok_or(g)?;
            let mut y = [0.0; 6];
            for (x, c) in t.iter().zip(vector) {
                y.iter_mut().zip(x).for_each(|(yi, xi)| *yi += c * xi);
            }
            let q = lowered(&y, h);
            for (row, yi) in rows.iter_mut().zip(y) {
                row.iter_mut().zip(q).for_each(|(p, qj)| *p += gain * yi * qj);
            }
        }
        Ok(Self { rows })
    }

    fn from_coordinates(span: &Span, coordinates: &[[f64; 6]; 6]) -> Self {
        let mut rows = [[0.0; 6]; 6];
        for (b, c) in span.vectors().iter().zip(coordinates) {
            for (row, bi) in rows.iter_mut().zip(b) {
                row.iter_mut().zip(c).for_each(|(p, ci)| *p += bi * ci);
            }
        }
        Self { rows }
    }

    /// `P x`
    pub(crate) fn apply(&self, x: &[f64; 6]) -> [f64; 6] {
        self.rows.map(|row| dot(&row, x))
    }

    /// Frobenius norm: at least the largest factor by which a motion is enlarged.
    pub(crate) fn norm(&self) -> f64 {
        self.rows.as_flattened().iter().map(|x| x * x).sum::<f64>().sqrt()
    }
}
