//! Manipulability of internal forces: contact forces that the actuated joints exert on each other
//! through the object, without a wrench on it.
//!
//! Formula  T = {(tau, t): G t = 0, J_p^T t = 0, tau = -J_a^T t}; efficiency
//!          min over t' of |t|^2 / |tau|^2, t' the hyperstatic forces
//! Shapes   tau: q_a; t: a force for each row of the constraint; h finite efficiencies, and an
//!          infinite one for each hyperstatic force
//! Units    `|t|^2 / |tau|^2` in the metrics given
//! Frame    t in the frames of the rows, exerted by the object on the limbs
//! Valid    any constraint. The number h, and which torques squeeze, do not depend on the joints
//!          that are written as contacts; the forces t are those in these contacts
//! Why so   footnote 5 of the paper leaves the case out. Its zero efficiencies of active force
//!          are torques that nothing outside feels; their output is the internal force
//! Source   Bicchi & Prattichizzo 1998, footnote 5 and eq. 12; Prattichizzo & Bicchi 1997 for the
//!          contact forces of internal torques
//! Checked  tests/it/manipulability/internal_force.rs

use super::efficiency::Spectrum;
use crate::closure::{Constraint, internal_force_relation};
use crate::error::{Error, Result};
use crate::linalg::Metric;

/// The efficiencies of internal forces: contact forces squared over torques squared, for torques of
/// the actuated joints that no wrench on the object balances.
///
/// ```text
/// G t = 0,   J_p^T t = 0,   tau = -J_a^T t;   min over t' |t + t'|^2 / |tau|^2,   G t' = 0, J^T t' = 0
/// ```
///
/// In the result, `joint` are torques, `object` contact forces t (an entry for each row of the
/// constraint), `infinite` the hyperstatic forces, which need no torques; there are no zeros. The
/// ellipsoid of contact forces for torques of length one has the columns of
/// [`Spectrum::semi_axes`] as axes. `torque` is the metric W_tau, `force` that of the contact
/// forces: a compliance ([`row_compliance`](crate::closure::row_compliance)) measures them by twice
/// their elastic energy. Without one the norm is that of the entries [N, N m].
///
/// Source: Bicchi & Prattichizzo 1998, footnote 5.
///
/// ```
/// use cylindroid::closure::ClosedChain;
/// use cylindroid::manipulability::internal_force_manipulability;
///
/// // Two arms of seven joints squeeze their common object in six ways.
/// let arms = cylindroid::load("two-arm")?;
/// let chain = ClosedChain::of(&arms.state(arms.home())?, None, None)?;
/// let squeeze = internal_force_manipulability(&chain.constraint, None, None)?;
/// assert_eq!((squeeze.finite.len(), squeeze.infinite.cols()), (6, 0));
/// # Ok::<(), cylindroid::Error>(())
/// ```
///
/// # Errors
/// Metrics of the wrong size.
pub fn internal_force_manipulability(
    constraint: &Constraint,
    torque: Option<&Metric>,
    force: Option<&Metric>,
) -> Result<Spectrum> {
    if let Some(metric) = torque {
        Error::check_len("Wtau", constraint.actuated(), metric.len())?;
    }
    if let Some(metric) = force {
        Error::check_len("Wt", constraint.rows(), metric.len())?;
    }
    Ok(Spectrum::of(internal_force_relation(constraint).motions(), torque, force))
}
