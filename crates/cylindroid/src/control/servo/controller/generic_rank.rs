//! The rank of the task Jacobian at non-singular configurations.
//!
//! Valid    any mechanism; of a closed chain near its home configuration
//! Checked  tests/it/servo/stall.rs, tests/it/servo/object.rs

use super::super::coupled;
use super::Servo;
use crate::error::Result;
use crate::linalg::Svd;
use crate::tolerance::GENERIC_RANK;

/// Configurations sampled.
const GENERIC_CONFIGURATIONS: usize = 3;

impl Servo {
    /// The largest rank of the task Jacobian over a few generic configurations.
    pub(super) fn find_generic_rank(&mut self) -> usize {
        let n = self.mechanism.n();
        (1..=GENERIC_CONFIGURATIONS)
            .map(|sample| {
                // Irrational steps: no configuration is aligned with another or with the axes.
                let mut q: Vec<f64> =
                    (0..n).map(|i| 0.3 + ((sample * n + i) as f64 * 0.618_034).fract()).collect();
                for (x, c) in q.iter_mut().zip(self.mechanism.coordinates()) {
                    if c.limits.lower == c.limits.upper {
                        *x = c.limits.lower; // its only position
                    }
                }
                self.chain.set(&q);
                if let Some(inertia) = &mut self.inertia
                    && inertia.weigh(&q, &self.chain, &mut self.space, None).is_err()
                {
                    return 0;
                }
                self.space.load(&self.chain, &mut self.task);
                Svd::of(&self.task).rank(GENERIC_RANK).rank
            })
            .max()
            .unwrap_or(0)
    }

    /// The same for a closed chain, at configurations near home.
    pub(super) fn find_actuated_rank(&mut self) -> Result<usize> {
        let (mut rank, mut closed, mut free) = (0, 0, None);
        for sample in 0..=GENERIC_CONFIGURATIONS {
            let Some(q) = self.nearby_configuration(sample)? else { continue };
            closed += 1;
            self.load_configuration(&q)?;
            self.load_jacobian(&q)?;
            rank = rank.max(Svd::of(&self.task).rank(GENERIC_RANK).rank);
            match self.coupled.as_ref().and_then(|c| c.uncontrolled()) {
                Some(motion) if motion.share == 0.0 => free = Some(motion.clone()),
                _ => return Ok(rank),
            }
        }
        let Some(motion) = free.filter(|_| closed > 0) else {
            return Err(coupled::not_assembled(&self.mechanism));
        };
        Err(coupled::not_actuated(&self.mechanism, &motion, self.options.task))
    }
}
