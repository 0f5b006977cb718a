//! Joint weights from the masses of the model: each joint by the inertia that it moves.
//!
//! Formula  weight of joint i = M_ii(q) of the mass matrix, at the configuration of the step, at
//!          least [`LEAST_INERTIA`] of the largest one
//! Units    kg m^2 for angles, kg for lengths
//! Valid    mechanisms whose moving bodies have masses; in closed chains M is that of the spanning
//!          tree. The diagonal of M, not all of it: the limits of joints stay boxes in the weighted
//!          velocities
//! Why so   of joint velocities with the same twist those of least sum of M_ii qd_i^2: energy
//!          without the coupling of joints; allocates nothing
//! Source   Khatib 1987 for inertia as the weight of redundancy
//! Checked  tests/it/servo/inertia.rs, tests/allocation/main.rs

use super::coupled::Coupled;
use super::task_space::TaskSpace;
use crate::error::Result;
use crate::kinematics::{Chain, MassMatrix, State};
use crate::linalg::Matrix;
use crate::model::Mechanism;
use crate::tolerance::LEAST_INERTIA;

/// The evaluator of the weights.
#[derive(Debug, Clone)]
pub(super) struct InertiaWeights {
    state: State,
    evaluator: MassMatrix,
    mass: Matrix,
}

impl InertiaWeights {
    /// # Errors
    /// Moving bodies without a mass, by name.
    pub(super) fn new(mechanism: &Mechanism) -> Result<Self> {
        mechanism.check_masses()?;
        let n = mechanism.n();
        Ok(Self {
            state: mechanism.state(mechanism.home())?,
            evaluator: MassMatrix::new(mechanism),
            mass: Matrix::zeros(n, n),
        })
    }

    /// Sets the weights at `q`.
    pub(super) fn weigh(
        &mut self,
        q: &[f64],
        chain: &Chain,
        space: &mut TaskSpace,
        coupled: Option<&mut Coupled>,
    ) -> Result<()> {
        self.state.set(q)?;
        self.evaluator.evaluate(&self.state, &mut self.mass)?;
        let n = self.mass.rows();
        // Of masses [kg] and of moments of inertia [kg m^2], each by themselves.
        let mut largest = [f64::MIN_POSITIVE; 2];
        let coordinates = self.state.mechanism().coordinates();
        let kind = |c: usize| usize::from(coordinates[c].kind.is_length());
        for c in 0..n {
            largest[kind(c)] = largest[kind(c)].max(self.mass[(c, c)]);
        }
        let weight = |c: usize| self.mass[(c, c)].max(LEAST_INERTIA * largest[kind(c)]);
        for (column, &c) in space.columns.iter_mut().zip(chain.coordinates()) {
            if *column != 0.0 {
                *column = 1.0 / weight(c).sqrt();
            }
        }
        if let Some(coupled) = coupled {
            coupled.set_weights((0..n).map(weight))?;
        }
        Ok(())
    }
}
