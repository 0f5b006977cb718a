//! Inertia of a mechanism as its actuated joints see it: a metric of their velocities.
//!
//! Formula  motions N y + Z z of the tree (y actuated, |D y| = |y|; z with the actuated joints at
//!          rest): M_y = min over z of the kinetic energy, W_q = D M_y D^T + b (1 - D D^T), b the
//!          mean of the eigenvalues of M_y
//! Shapes   a x a, in the order of [`ClosedChain::actuated`]
//! Units    kg, kg m, kg m^2: qd_a^T W_q qd_a is twice the kinetic energy
//! Valid    any mechanism whose moving bodies have masses. Of a serial arm it is the mass matrix.
//!          Actuated velocities that loops forbid occur in no motion: the second term only makes W_q
//!          positive definite
//! Why so   the motion that actuated joints start from rest has the least kinetic energy of all
//!          with their velocities (Kelvin): motions that they do not control follow freely
//! Source   Walker & Orin 1982 for the tree; Kelvin's theorem (Thomson & Tait 1867, section 312)
//! Checked  tests/it/mass_matrix.rs
//!
//! [`ClosedChain::actuated`]: crate::closure::ClosedChain::actuated

use super::metrics::Metrics;
use crate::closure::ActuationMap;
use crate::error::{Error, Result};
use crate::kinematics::State;
use crate::linalg::{Matrix, Metric};

/// The inertia of the whole mechanism as a metric of the velocities of the actuated joints: twice
/// the least kinetic energy with these velocities.
///
/// ```text
/// qd_a^T W_q qd_a = 2 min E_kin
/// ```
///
/// a x a, in the order of the actuated joints of
/// [`ClosedChain`](crate::closure::ClosedChain); for a serial arm the mass matrix
/// ([`State::mass_matrix`]). In closed chains it is that of the tree, on the motions that the loops
/// permit; motions that the actuated joints do not control follow with the least energy. On actuated
/// velocities that the loops forbid it is the mean of the others.
///
/// # Errors
/// Moving bodies without a mass, by name; motions without kinetic energy (masses or inertias of
/// zero); loops that permit no motion of the actuated joints; an actuated loop joint of several
/// coordinates.
pub fn actuated_inertia(state: &State) -> Result<Matrix> {
    let mechanism = state.mechanism();
    mechanism.check_masses()?;
    let mass = state.mass_matrix();
    let n = mechanism.n();
    let map = ActuationMap::of(state, &[], &[])?;
    let tree = |m: &Matrix| m.rows_between(0, n);
    let (driven, free) = (tree(&map.motions), tree(&map.uncontrolled));
    let product = |a: &Matrix, b: &Matrix| &(&a.transpose() * &mass) * b;
    let refuse = |_| Error::Model {
        model: mechanism.name().to_owned(),
        culprit: mechanism.name().to_owned(),
        message: "some motion has no kinetic energy: a mass or a moment of inertia in the file is \
                  zero; write its value, or give weights instead of the inertia"
            .to_owned(),
    };
    let mut reduced = product(&driven, &driven);
    if free.cols() > 0 {
        let own = Metric::new("inertia", &product(&free, &free)).map_err(refuse)?;
        let mut coupling = product(&driven, &free);
        own.solve_right(&mut coupling);
        let less = &coupling * &coupling.transpose();
        reduced = Matrix::from_fn(reduced.rows(), reduced.cols(), |i, j| {
            reduced[(i, j)] - 0.5 * (less[(i, j)] + less[(j, i)])
        });
    }
    Metric::new("inertia", &reduced).map_err(refuse)?;
    let d = map.actuated_rows();
    let p = reduced.cols();
    if p == 0 && d.rows() > 0 {
        return Err(Error::Model {
            model: mechanism.name().to_owned(),
            culprit: mechanism.name().to_owned(),
            message: "the loops permit no motion of the actuated joints, so they have no inertia; \
                      choose other actuated joints, or give weights"
                .to_owned(),
        });
    }
    let mean = (0..p).map(|i| reduced[(i, i)]).sum::<f64>() / p.max(1) as f64;
    let within = &(&d * &reduced) * &d.transpose();
    let projector = &d * &d.transpose();
    Ok(Matrix::from_fn(d.rows(), d.rows(), |i, j| {
        let outside = f64::from(u8::from(i == j)) - projector[(i, j)];
        0.5 * (within[(i, j)] + within[(j, i)]) + mean * outside
    }))
}

impl Metrics {
    /// With W_q the inertia of the whole mechanism at the state ([`actuated_inertia`]): velocities
    /// of the actuated joints are measured by twice the kinetic energy.
    ///
    /// # Errors
    /// As [`actuated_inertia`].
    pub fn with_joint_inertia(self, state: &State) -> Result<Self> {
        self.with_joint(&actuated_inertia(state)?)
    }
}
