//! Inverses of Jacobians: one file per method, one report for all.
//!
//! Every method here replaces `1 / s_i` in the pseudoinverse `V diag(1 / s) U^T` by a gain that
//! stays finite as `s_i` goes to zero. The share `s_i * gain_i` of a task motion along `u_i` is
//! realised: 1 in regular directions, 0 in cut ones; below one half a direction counts as dropped.
//!
//! ```
//! use cylindroid::{Matrix, inverse};
//!
//! let j = Matrix::from_rows(&[[1.0, 0.0, 0.0], [0.0, 1e-9, 0.0]]).unwrap();
//! let inverse = inverse::truncated(&j, 1e-3)?;
//! assert_eq!(inverse.rank, 1);
//! assert_eq!(inverse.dropped[0].direction, [0.0, 1.0]);
//! # Ok::<(), cylindroid::Error>(())
//! ```

mod batch;
mod damped;
mod filtered;
mod hyperbolic;
mod independent;
mod numerical_filtering;
mod point_direction;
mod report;
mod selectively_damped;
pub(crate) mod truncated;
mod variable_damping;
mod weighted;

pub use batch::{Batch, Inverses};
pub(crate) use damped::damp;
pub use hyperbolic::{HyperbolicDamping, HyperbolicOptions, hyperbolic, hyperbolic_with, oblique};
pub use independent::hyperbolic_into;
pub use point_direction::{PointDirection, point_direction};
pub(crate) use report::is_kept;
pub use report::{Dropped, Inverse};
pub use weighted::Weights;

use crate::error::{Error, Result};
use crate::linalg::{Matrix, Svd};
use crate::tolerance;

/// A way to invert a Jacobian near its singularities.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Method {
    /// Cuts singular values at or below `eps` times the largest. Exact elsewhere; jumps there.
    Truncated {
        /// Relative threshold [-], in [0, 1).
        eps: f64,
    },
    /// `J^T (J J^T + damping^2)^-1`: smooth everywhere, exact nowhere.
    Damped {
        /// Damping, in the unit of the singular values.
        damping: f64,
    },
    /// Damping that rises from zero as the smallest singular value falls below the onset.
    VariableDamping {
        /// Onset relative to the largest singular value [-].
        onset: f64,
        /// Damping at the singularity, in the unit of the singular values.
        damping: f64,
    },
    /// A little damping everywhere near a singularity, much along the weakest direction.
    NumericalFiltering {
        /// Onset relative to the largest singular value [-].
        onset: f64,
        /// Damping of all directions at the singularity, in the unit of the singular values.
        damping: f64,
        /// Further damping of the weakest direction, in the unit of the singular values.
        filter: f64,
    },
    /// Each direction slowed by as much as its joint rates need.
    SelectivelyDamped {
        /// Largest rate of any joint [rad/s, or m/s for sliding joints].
        max_rate: f64,
    },
    /// Singular values replaced by a smooth function that never falls below the floor.
    SingularValueFiltering {
        /// Shape nu of the filter: larger is closer to the exact inverse away from zero [-].
        shape: f64,
        /// Smallest filtered singular value, in the unit of the singular values.
        floor: f64,
    },
}

impl Default for Method {
    fn default() -> Self {
        Self::Truncated { eps: tolerance::TRUNCATION }
    }
}

impl Method {
    /// Every method with its default numbers, for singular values scaled by the reach.
    pub const ALL: [Self; 6] = [
        Self::Truncated { eps: tolerance::TRUNCATION },
        Self::Damped { damping: tolerance::DAMPING },
        Self::VariableDamping { onset: tolerance::DAMPING_ONSET, damping: tolerance::DAMPING },
        Self::NumericalFiltering {
            onset: tolerance::DAMPING_ONSET,
            damping: 0.1 * tolerance::DAMPING,
            filter: tolerance::DAMPING,
        },
        Self::SelectivelyDamped { max_rate: std::f64::consts::FRAC_PI_4 },
        Self::SingularValueFiltering { shape: 10.0, floor: tolerance::DAMPING },
    ];

    /// Its name in options and reports.
    #[must_use]
    pub const fn name(&self) -> &'static str {
        match self {
            Self::Truncated { .. } => "truncated",
            Self::Damped { .. } => "damped",
            Self::VariableDamping { .. } => "variable-damping",
            Self::NumericalFiltering { .. } => "numerical-filtering",
            Self::SelectivelyDamped { .. } => "selectively-damped",
            Self::SingularValueFiltering { .. } => "singular-value-filtering",
        }
    }

    /// The method of this name with its default numbers.
    ///
    /// # Errors
    /// [`Error::UnknownName`] with the nearest names.
    pub fn named(name: &str) -> Result<Self> {
        Self::ALL
            .into_iter()
            .find(|m| m.name() == name)
            .ok_or_else(|| Error::unknown("inverse", name, Self::ALL.iter().map(Self::name)))
    }

    /// The numbers of the method by their names, to be set.
    ///
    /// ```
    /// let mut method = cylindroid::Method::named("truncated")?;
    /// for (name, number) in method.numbers_mut() {
    ///     assert_eq!(name, "eps");
    ///     *number = 1e-6;
    /// }
    /// assert_eq!(method, cylindroid::Method::Truncated { eps: 1e-6 });
    /// # Ok::<(), cylindroid::Error>(())
    /// ```
    pub fn numbers_mut(&mut self) -> Vec<(&'static str, &mut f64)> {
        match self {
            Self::Truncated { eps } => vec![("eps", eps)],
            Self::Damped { damping } => vec![("damping", damping)],
            Self::VariableDamping { onset, damping } => {
                vec![("onset", onset), ("damping", damping)]
            }
            Self::NumericalFiltering { onset, damping, filter } => {
                vec![("onset", onset), ("damping", damping), ("filter", filter)]
            }
            Self::SelectivelyDamped { max_rate } => vec![("max_rate", max_rate)],
            Self::SingularValueFiltering { shape, floor } => {
                vec![("shape", shape), ("floor", floor)]
            }
        }
    }

    /// Refuses numbers outside the domain of the method.
    ///
    /// # Errors
    /// [`Error::InvalidOption`] with the option and its value.
    pub fn check(&self) -> Result<()> {
        let positive = Error::check_positive;
        match *self {
            Self::Truncated { eps } => within("eps", eps, 0.0, 1.0),
            Self::Damped { damping } => positive("damping", damping),
            Self::VariableDamping { onset, damping } => {
                within("onset", onset, 0.0, 1.0)?;
                positive("damping", damping)
            }
            Self::NumericalFiltering { onset, damping, filter } => {
                within("onset", onset, 0.0, 1.0)?;
                positive("damping", damping)?;
                positive("filter", filter)
            }
            Self::SelectivelyDamped { max_rate } => positive("max_rate", max_rate),
            Self::SingularValueFiltering { shape, floor } => {
                positive("shape", shape)?;
                positive("floor", floor)
            }
        }
    }

    /// Writes the gain of each direction and returns the singular value below which a direction
    /// counts as dropped. `task` is the motion to be inverted, which only selectively damped
    /// least squares looks at. No allocation.
    pub(crate) fn gains(&self, svd: &Svd, task: &[f64], out: &mut [f64]) -> f64 {
        match *self {
            Self::Truncated { eps } => truncated::gains(svd, eps, out),
            Self::Damped { damping } => damped::gains(svd, damping, out),
            Self::VariableDamping { onset, damping } => {
                variable_damping::gains(svd, onset, damping, out)
            }
            Self::NumericalFiltering { onset, damping, filter } => numerical_filtering::gains(
                svd,
                numerical_filtering::Filter { onset, damping, weakest: filter },
                out,
            ),
            Self::SelectivelyDamped { max_rate } => {
                selectively_damped::gains(svd, max_rate, task, out)
            }
            Self::SingularValueFiltering { shape, floor } => {
                filtered::gains(svd, shape, floor, out)
            }
        }
    }

    /// The inverse of `j` (m x n) with its report. The gains of selectively damped least squares
    /// depend on the motion: here they hold for unit motions along every direction, see
    /// [`selectively_damped`] for a given one.
    ///
    /// # Errors
    /// A matrix with NaN or infinity; numbers outside the method's domain.
    pub fn inverse(&self, j: &Matrix) -> Result<Inverse> {
        Inverse::compute(*self, j, &[], &Weights::NONE)
    }
}

/// The truncated pseudoinverse: singular values `s_i <= eps * s_1` are cut, as in
/// `numpy.linalg.pinv(J, eps)`.
///
/// # Errors
/// A matrix with NaN or infinity; `eps` outside [0, 1).
pub fn truncated(j: &Matrix, eps: f64) -> Result<Inverse> {
    Method::Truncated { eps }.inverse(j)
}

/// The damped least-squares inverse `J^T (J J^T + damping^2)^-1`.
///
/// # Errors
/// A matrix with NaN or infinity; damping that is not positive.
pub fn damped(j: &Matrix, damping: f64) -> Result<Inverse> {
    Method::Damped { damping }.inverse(j)
}

/// The selectively damped inverse for the motion `task` (m entries): joint rates are
/// `matrix * task`, none above `max_rate`.
///
/// # Errors
/// A matrix or task with NaN or infinity, a task of the wrong size, a rate that is not positive.
pub fn selectively_damped(j: &Matrix, task: &[f64], max_rate: f64) -> Result<Inverse> {
    Error::check_len("task", j.rows(), task.len())?;
    Error::check_finite("task", task)?;
    Inverse::compute(Method::SelectivelyDamped { max_rate }, j, task, &Weights::NONE)
}

/// Any method in the metrics of joints and task: minimises the weighted rates among the motions
/// that make the weighted task error smallest.
///
/// # Errors
/// As [`Method::inverse`]; metrics of the wrong size.
pub fn weighted(j: &Matrix, method: Method, weights: &Weights) -> Result<Inverse> {
    Inverse::compute(method, j, &[], weights)
}

fn within(option: &'static str, value: f64, lower: f64, below: f64) -> Result<()> {
    if value >= lower && value < below {
        return Ok(());
    }
    Err(Error::InvalidOption {
        option,
        value: value.to_string(),
        reason: format!("it must be at least {lower} and below {below}"),
    })
}
