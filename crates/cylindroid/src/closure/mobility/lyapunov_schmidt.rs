//! Lyapunov-Schmidt reduction of the loop-closure equations at a closed configuration.
//!
//! Formula  loops f(q) = 0 with Jacobian C = df/dq of rank r; K = ker C, N = (ker C)^perp, P = ran
//!          C, R = (ran C)^perp. For every small x the equation P^T f(q0 + K x + N y) = 0 has one
//!          solution y(x); the reduced equation is g(x) = R^T f = 0, with g(0) = 0, dg(0) = 0. Near
//!          q0 the closed configurations are the zeros of g
//! Shapes   K: n x k, N: n x r, P: t x r, R: t x (t - r); x: k, g: t - r
//! Units    none: scaled as in `loop_closure.rs`
//! Valid    steps x that Newton's method can follow; the caller shortens those that fail. Position
//!          limits are ignored
//! Why so   the loops resist to first order only along N, so a step along K is never undone by
//!          closing them; least squares over all coordinates would slide back to where the loops
//!          close and report success
//! Source   Golubitsky & Schaeffer 1985, chapter VII
//! Checked  tests/it/closure/finite.rs

use crate::closure::constraint::rate_rank::rate_space;
use crate::closure::constraint::velocity_constraint::check_size;
use crate::closure::position::coordinates::column_scale;
use crate::closure::position::initial_guesses::by_name;
use crate::closure::position::loop_closure::LoopClosure;
use crate::error::Result;
use crate::linalg::{Matrix, Qr, norm};
use crate::model::Mechanism;
use crate::tolerance::{LOOP_ROUNDING, POSITION_ROUNDING};

/// Maximum number of Newton steps: four are usual.
const MAX_STEPS: usize = 30;

/// Steps below the tolerance at most: entries without rounding, at round coordinates, would converge on
/// slowly far below it.
const POLISHED: usize = 2;

/// The reduction at a configuration, with the spaces of its first order.
pub(crate) struct LyapunovSchmidt<'a> {
    mechanism: &'a Mechanism,
    length: f64,
    /// For each coordinate: rate = scale * scaled rate.
    scale: Vec<f64>,
    q: Vec<f64>,
    free: Vec<usize>,
    kernel: Matrix,
    complement: Matrix,
    range: Matrix,
    cokernel: Matrix,
    at_start: Vec<f64>,
    tolerance: f64,
    dropped: f64,
    closed: bool,
}

/// A nearby configuration in which all loops are closed except for the residual g.
pub(crate) struct ReducedPoint {
    pub(crate) q: Vec<f64>,
    /// g.
    pub(crate) residual: Vec<f64>,
    /// dg/dx, (t - r) x k.
    pub(crate) rates: Matrix,
}

impl ReducedPoint {
    pub(crate) fn error(&self) -> f64 {
        norm(&self.residual)
    }
}

impl<'a> LyapunovSchmidt<'a> {
    /// At the configuration `q`, with the threshold of `rate_rank.rs` for singular values of C.
    pub(crate) fn of(
        mechanism: &'a Mechanism,
        q: &[f64],
        length: f64,
        threshold: f64,
    ) -> Result<Self> {
        let free: Vec<usize> = (0..mechanism.n()).collect();
        check_size(0, free.len())?;
        let start = LoopClosure::at(mechanism, q, &free, length)?;
        let rows = rate_space(&start.jacobian, threshold);
        let (kernel, complement) = (rows.complement(), rows.basis());
        // The range as the image of N: of the same rank, whatever the threshold cut off.
        let image = Qr::plain(&start.jacobian * &complement);
        let (range, cokernel) = (image.basis(), image.complement());
        let at_start = cokernel.transpose().mul_vec(&start.residuals);
        let far = mechanism.far_from_origin() / length;
        let rounding = LOOP_ROUNDING.max(POSITION_ROUNDING * far);
        let tolerance = rounding.max(10.0 * start.residual_norm);
        let dropped = rows.cut().dropped;
        let (q, closed) = (q.to_vec(), start.is_closed(length));
        let scale = free.iter().map(|&i| column_scale(mechanism, i, length)).collect();
        Ok(Self {
            mechanism,
            length,
            scale,
            q,
            free,
            kernel,
            complement,
            range,
            cokernel,
            at_start,
            tolerance,
            dropped,
            closed,
        })
    }

    /// True if the loops of the configuration are closed.
    pub(crate) fn is_closed(&self) -> bool {
        self.closed
    }

    /// Number k of motions to first order.
    pub(crate) fn motions(&self) -> usize {
        self.kernel.cols()
    }

    /// Number t - r of equations that depend on the others to first order.
    pub(crate) fn dependent(&self) -> usize {
        self.cokernel.cols()
    }

    /// True if there are no loops: every motion is a motion.
    pub(crate) fn is_unconstrained(&self) -> bool {
        self.range.rows() == 0
    }

    /// K, scaled.
    pub(crate) fn kernel(&self) -> &Matrix {
        &self.kernel
    }

    /// The residual below which g counts as zero: rounding, and the residual of the start.
    pub(crate) fn tolerance(&self) -> f64 {
        self.tolerance
    }

    /// The same at the distance `s`: singular values that count as zero open the loops in
    /// proportion to it.
    pub(crate) fn tolerance_at(&self, s: f64) -> f64 {
        self.tolerance + 10.0 * self.dropped * s
    }

    /// A random unit vector of first-order motions, k entries: the same motion whatever the order
    /// of the coordinates and the basis K, since its components belong to their names.
    pub(crate) fn direction(&self, number: u64) -> Vec<f64> {
        let random: Vec<f64> =
            self.mechanism.coordinates().iter().map(|c| by_name(&c.name, number)).collect();
        let x = self.kernel.transpose().mul_vec(&random);
        let size = norm(&x);
        let even = 1.0 / (x.len() as f64).sqrt();
        x.iter().map(|x| if size > 0.0 { x / size } else { even }).collect()
    }

    /// Scaled rates in the units of the coordinates.
    pub(crate) fn unscaled(&self, rates: &Matrix) -> Matrix {
        rates.clone().scale_rows(&self.scale)
    }

    fn moved(&self, q: &[f64], scaled: &[f64]) -> Vec<f64> {
        let rates: Vec<f64> = scaled.iter().zip(&self.scale).map(|(x, s)| x * s).collect();
        let mut q = q.to_vec();
        self.mechanism.integrate_in_place(&mut q, &rates, 1.0);
        q
    }

    /// The configuration at `x`; none if Newton's method does not converge.
    pub(crate) fn step(&self, x: &[f64]) -> Result<Option<ReducedPoint>> {
        self.step_from(&self.q, x)
    }

    /// The configuration that is further by `x` than `from`, where P^T f = 0; none if Newton's
    /// method does not converge.
    pub(crate) fn step_from(&self, from: &[f64], x: &[f64]) -> Result<Option<ReducedPoint>> {
        let mut q = self.moved(from, &self.kernel.mul_vec(x));
        let (mut last, mut within) = (f64::INFINITY, 0);
        for _ in 0..MAX_STEPS {
            let now = LoopClosure::at(self.mechanism, &q, &self.free, self.length)?;
            let open = self.range.transpose().mul_vec(&now.residuals);
            let error = norm(&open);
            let complement =
                Qr::plain(&self.range.transpose() * &(&now.jacobian * &self.complement));
            within += usize::from(error <= self.tolerance);
            let is_settled = !(error < 0.5 * last) || within > POLISHED;
            if error <= self.tolerance && is_settled || error == 0.0 {
                let along = &now.jacobian * &self.kernel;
                let follow = complement.solve(&self.range.transpose() * &along);
                let swept = &now.jacobian * &(&self.complement * &follow);
                let rates = &self.cokernel.transpose()
                    * &Matrix::from_fn(along.rows(), along.cols(), |i, j| {
                        along[(i, j)] - swept[(i, j)]
                    });
                let mut residual = self.cokernel.transpose().mul_vec(&now.residuals);
                residual.iter_mut().zip(&self.at_start).for_each(|(l, s)| *l -= s);
                return Ok(rates.is_finite().then_some(ReducedPoint { q, residual, rates }));
            }
            // NaN is no progress.
            if !(error < 2.0 * last) {
                return Ok(None);
            }
            last = error;
            let mut back = complement.solve(Matrix::from_fn(open.len(), 1, |i, _| -open[i]));
            // NaN is too far.
            if !(back.max_abs() <= 1.0) {
                return Ok(None);
            }
            q = self.moved(&q, &self.complement.mul_vec(back.column_mut(0)));
        }
        Ok(None)
    }
}
