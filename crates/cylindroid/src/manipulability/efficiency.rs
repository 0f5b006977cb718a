//! Manipulability as efficiencies of motion and of force: pairs that never divide by zero.
//!
//! Formula  kinematic  R = min over u' of |u|^2 / min over q' of |q|^2, u' and q' moving freely
//!          force      the same for F, the wrenches and torques that do no work on R
//!          Whiten, take q orthogonal to r', u to i', make [Q; U] orthonormal; then
//!          [Q; U] = [X C; Y S] Z^T and the efficiencies are s_j^2 / c_j^2; in dual metrics those
//!          of forces are (-X S, Y C) in the same coordinates
//! Shapes   finite: c' of both kinds; kinematic: r' zeros, i' infinite; force: h zeros, s infinite
//! Units    `|u|^2 / |q|^2`, `|w|^2 / |tau|^2` in the metrics given
//! Frame    that of the object's twist
//! Valid    any relation, also where N and D of the paper's eq. 9 are both singular. Which
//!          directions are zero or infinite is decided by the relation, in scaled units, so no
//!          metric, however ill-conditioned, turns one into the other. With dual metrics the finite
//!          efficiencies of force are the inverses of the kinematic ones, largest for smallest
//!          (not equal, as section 4.3 says): debug builds check it against the forces alone.
//! Why so   eqs. 15 and 16 omit cross terms and depend on the basis, even on where a contact
//!          is drawn on its link; eq. 9 loses half the digits by squaring
//! Source   Bicchi & Prattichizzo 1998, sections 3 and 4, as corrected above
//! Checked  tests/it/manipulability/reference.rs (31 mechanisms to 1e-9 relative),
//!          tests/it/manipulability/serial.rs

use super::metrics::Metrics;
use crate::closure::{Relation, RelationBases};
use crate::error::Result;
use crate::linalg::{CsDecomposition, Matrix, Metric, Qr, dot, max_abs};
use crate::tolerance::{DUALITY, MAX_EFFICIENCY_SPREAD, MAX_METRIC_CONDITION};

/// A point (s : c) of the projective line, `s^2 + c^2 = 1`: output over input.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pair {
    /// s: size of the object's part.
    pub output: f64,
    /// c: size of the joints' part.
    pub input: f64,
}

impl Pair {
    /// `s^2 / c^2`, infinite for (1 : 0).
    #[must_use]
    pub fn efficiency(&self) -> f64 {
        let ratio = self.output / self.input;
        ratio * ratio
    }

    /// `atan(s / c)`, from 0 (zero efficiency) to pi / 2 (infinite).
    #[must_use]
    pub fn angle(&self) -> f64 {
        self.output.atan2(self.input)
    }
}

/// A principal direction: together its parts have length one in the metrics.
#[derive(Debug, Clone, PartialEq)]
pub struct Direction {
    /// Sizes of the parts.
    pub pair: Pair,
    /// Velocities (torques) of the actuated joints.
    pub joint: Vec<f64>,
    /// The corresponding twist (wrench).
    pub object: Vec<f64>,
}

/// All efficiencies of a kind.
#[derive(Debug, Clone, PartialEq)]
pub struct Spectrum {
    /// Largest first. Where efficiencies are equal only the span of their directions means
    /// anything.
    pub finite: Vec<Direction>,
    /// Joint motions (torques) with nothing at the object: orthonormal in the metric, q_a rows.
    pub zeros: Matrix,
    /// Object motions (wrenches) for nothing at the joints: orthonormal in the metric, d rows.
    pub infinite: Matrix,
}

impl Spectrum {
    /// The finite efficiencies, largest first.
    #[must_use]
    pub fn values(&self) -> Vec<f64> {
        self.finite.iter().map(|d| d.pair.efficiency()).collect()
    }

    /// Largest ratio of output to input over the smallest.
    fn spread(&self) -> f64 {
        let ratio = |d: &Direction| d.pair.output / d.pair.input;
        let ends = self.finite.first().zip(self.finite.last());
        ends.map_or(1.0, |(most, least)| ratio(most) / ratio(least))
    }

    /// The semi-axes of the ellipsoid of what comes out for an input of length one, a column
    /// each, the longest first.
    #[must_use]
    pub fn semi_axes(&self) -> Matrix {
        Matrix::from_fn(self.infinite.rows(), self.finite.len(), |i, j| {
            let direction = &self.finite[j];
            direction.object[i] / direction.pair.input
        })
    }

    pub(super) fn of(
        parts: RelationBases,
        joint: Option<&Metric>,
        object: Option<&Metric>,
    ) -> Self {
        let principal = Principal::of(parts, joint, object);
        Self {
            finite: principal.directions(joint, object),
            zeros: coloured(joint, principal.zeros),
            infinite: coloured(object, principal.infinite),
        }
    }
}

/// Principal directions in whitened coordinates.
struct Principal {
    cs: CsDecomposition,
    /// A common factor between the two spaces, taken out of the sines.
    balance: f64,
    zeros: Matrix,
    infinite: Matrix,
}

impl Principal {
    fn of(parts: RelationBases, joint: Option<&Metric>, object: Option<&Metric>) -> Self {
        let zeros = orthonormal(whitened(joint, parts.zero));
        let infinite = orthonormal(whitened(object, parts.infinite));
        let q = without(whitened(joint, parts.joint), &zeros);
        let mut u = without(whitened(object, parts.object), &infinite);
        // Taken out, the factor changes all efficiencies alike and costs no digits.
        let balance = if u.cols() == 0 { 1.0 } else { u.frobenius_norm() / q.frobenius_norm() };
        u.as_mut_slice().iter_mut().for_each(|x| *x /= balance);
        let stack = Matrix::vstack(q.cols(), &[&q, &u]);
        let cs = CsDecomposition::of(&orthonormal(stack), q.rows());
        Self { cs, balance, zeros, infinite }
    }

    fn pair(&self, j: usize) -> Pair {
        let (s, c) = (self.balance * self.cs.sines[j], self.cs.cosines[j]);
        let norm = s.hypot(c);
        Pair { output: s / norm, input: c / norm }
    }

    fn direction(&self, j: usize, pair: Pair, sign: f64) -> Direction {
        let times = |x: &[f64], size: f64| x.iter().map(|a| a * size).collect();
        Direction {
            pair,
            joint: times(self.cs.x.column(j), sign * pair.input),
            object: times(self.cs.y.column(j), pair.output),
        }
    }

    fn directions(&self, joint: Option<&Metric>, object: Option<&Metric>) -> Vec<Direction> {
        let of = |j| {
            let mut direction = self.direction(j, self.pair(j), 1.0);
            if let Some(metric) = joint {
                metric.unwhiten(&mut direction.joint);
            }
            if let Some(metric) = object {
                metric.unwhiten(&mut direction.object);
            }
            direction
        };
        (0..self.cs.len()).map(of).collect()
    }

    /// The directions (-X S, Y C) of the forces, largest efficiency first: in whitened coordinates
    /// the complement of (X C, Y S), with the metrics of motions given.
    fn dual_directions(&self, joint: Option<&Metric>, object: Option<&Metric>) -> Vec<Direction> {
        let of = |j| {
            let Pair { output, input } = self.pair(j);
            let mut direction = self.direction(j, Pair { output: input, input: output }, -1.0);
            if let Some(metric) = joint {
                metric.unwhiten_dual(&mut direction.joint);
            }
            if let Some(metric) = object {
                metric.unwhiten_dual(&mut direction.object);
            }
            direction
        };
        (0..self.cs.len()).rev().map(of).collect()
    }
}

/// The manipulability of a mechanism in one configuration: efficiencies of motion and force.
///
/// ```text
/// kinematic  min over u' |u|^2 / min over q' |qd_a|^2   over R = {(qd_a, u)}
/// force      min |w|^2 / min |tau|^2                   over F = {(tau, w)} = R^perp
/// [L_q Q; L_u U] orthonormal = [X C; Y S] Z^T,   efficiencies s_j^2 / c_j^2
/// ```
///
/// For a serial arm the kinematic efficiencies are the squares of the singular values of the
/// Jacobian. In dual metrics those of force are the reciprocals of those of motion. Units: of
/// `|u|^2 / |qd_a|^2` and `|w|^2 / |tau|^2` in the metrics given.
///
/// Source: Bicchi & Prattichizzo 1998, eqs. 9 and 14 to 17, corrected in the chapter
/// `docs/theory/closed-chains.md` of the book.
#[derive(Debug, Clone, PartialEq)]
pub struct Manipulability {
    /// Motions of the object for velocities of the actuated joints.
    pub kinematic: Spectrum,
    /// Wrenches on the object for torques of the actuated joints: zeros are internal torques,
    /// infinite ones wrenches that the structure resists.
    pub force: Spectrum,
}

impl Manipulability {
    /// Of a relation (of a task too, see [`Relation::task`]) in the given metrics.
    ///
    /// ```
    /// use cylindroid::Matrix;
    /// use cylindroid::closure::{Constraint, MotionSpace};
    /// use cylindroid::manipulability::{Manipulability, Metrics};
    ///
    /// let jacobian = Matrix::from_rows(&[[2.0, 0.0], [0.0, 1.0]]).unwrap();
    /// let relation = MotionSpace::of(&Constraint::serial(&jacobian)?).relation();
    /// let m = Manipulability::of(&relation, &Metrics::UNIT)?;
    /// assert!((m.kinematic.values()[0] - 4.0).abs() < 1e-12); // squared singular values
    /// # Ok::<(), cylindroid::Error>(())
    /// ```
    ///
    /// # Errors
    /// Metrics of the wrong size.
    pub fn of(relation: &Relation, metrics: &Metrics) -> Result<Self> {
        metrics.check(relation.joints(), relation.object())?;
        let (joint, object) = (metrics.joint.as_ref(), metrics.object.as_ref());
        let (torque, wrench) = (metrics.of_torque(), metrics.of_wrench());
        let (torque, wrench) = (torque.as_ref(), wrench.as_ref());
        let principal = Principal::of(relation.motions(), joint, object);
        let finite = principal.directions(joint, object);
        let force = if metrics.is_dual() {
            let (internal, structural) = relation.internal_and_structural();
            Spectrum {
                finite: principal.dual_directions(joint, object),
                zeros: coloured(torque, orthonormal(whitened(torque, internal))),
                infinite: coloured(wrench, orthonormal(whitened(wrench, structural))),
            }
        } else {
            Spectrum::of(relation.forces(), torque, wrench)
        };
        let kinematic = Spectrum {
            finite,
            zeros: coloured(joint, principal.zeros),
            infinite: coloured(object, principal.infinite),
        };
        let all = Self { kinematic, force };
        debug_assert!(
            !metrics.is_dual()
                || metrics.diagonal_ratio() > MAX_METRIC_CONDITION
                || all.kinematic.spread() > MAX_EFFICIENCY_SPREAD
                || all.is_dual_to(&Spectrum::of(relation.forces(), torque, wrench)),
            "forces are not dual: {all:?}"
        );
        Ok(all)
    }

    /// The force efficiencies against given torques: finite ones, and a zero for each internal
    /// torque.
    #[must_use]
    pub fn active_force(&self) -> Spectrum {
        let none = Matrix::zeros(self.force.infinite.rows(), 0);
        Spectrum { infinite: none, ..self.force.clone() }
    }

    /// The force efficiencies against given wrenches: finite ones, and an infinite one for each
    /// wrench that the structure resists.
    #[must_use]
    pub fn passive_force(&self) -> Spectrum {
        let none = Matrix::zeros(self.force.zeros.rows(), 0);
        Spectrum { zeros: none, ..self.force.clone() }
    }

    /// Efficiencies of force, found from the forces alone, are inverse to those of motion, up to
    /// what rounding does to the pairs.
    fn is_dual_to(&self, force: &Spectrum) -> bool {
        let motion = &self.kinematic.finite;
        motion.len() == force.finite.len()
            && motion.iter().zip(force.finite.iter().rev()).all(|(m, f)| {
                (m.pair.output - f.pair.input).abs() < DUALITY
                    && (m.pair.input - f.pair.output).abs() < DUALITY
            })
    }
}

fn whitened(metric: Option<&Metric>, mut a: Matrix) -> Matrix {
    if let Some(metric) = metric {
        metric.whiten_rows(&mut a);
    }
    a
}

fn coloured(metric: Option<&Metric>, mut a: Matrix) -> Matrix {
    if let Some(metric) = metric {
        for j in 0..a.cols() {
            metric.unwhiten(a.column_mut(j));
        }
    }
    a
}

/// An orthonormal basis of the span of independent columns.
fn orthonormal(mut a: Matrix) -> Matrix {
    if a.cols() == 0 {
        return a;
    }
    for j in 0..a.cols() {
        let column = a.column_mut(j);
        let size = max_abs(column);
        if size > 0.0 {
            column.iter_mut().for_each(|x| *x /= size);
        }
    }
    Qr::plain(a).basis()
}

/// The columns without their parts along an orthonormal basis; twice, as rounding asks.
fn without(mut a: Matrix, basis: &Matrix) -> Matrix {
    if basis.cols() == 0 {
        return a;
    }
    for _ in 0..2 {
        for j in 0..a.cols() {
            for l in 0..basis.cols() {
                let b = basis.column(l);
                let along = dot(a.column(j), b);
                a.column_mut(j).iter_mut().zip(b).for_each(|(x, y)| *x -= along * y);
            }
        }
    }
    a
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Weights from 1e-300 to 1e300 make columns of any length.
    #[test]
    fn a_basis_does_not_depend_on_the_lengths_of_the_columns() {
        let unit = |sizes: [f64; 2]| {
            let of = [[1.0, 2.0, 3.0], [-1.0, 0.5, 0.2]];
            orthonormal(Matrix::from_fn(3, 2, |i, j| sizes[j] * of[j][i]))
        };
        let expected = unit([1.0, 1.0]);
        for sizes in [[1e-200, 1.0], [1.0, 1e-200], [1e-300, 1e-300], [1e200, 1e-200]] {
            let basis = unit(sizes);
            for (a, b) in basis.as_slice().iter().zip(expected.as_slice()) {
                assert!((a - b).abs() < 1e-14, "{sizes:?}: {basis:?}");
            }
        }
    }
}
