//! Twists of the reference link: a basis of its motions, from which its screw system is computed.
//!
//! Formula  object columns of the coordinate and the indeterminate directions of the relation
//!          between actuated joints and object, moved from the origin of the frame to that of the
//!          world
//! Shapes   a twist for each independent motion, at most d (6, in the plane 3)
//! Units    m, rad
//! Frame    world, at the world origin
//! Valid    any mechanism; for a tree they span the columns of its Jacobian
//! Checked  tests/it/closure/graph.rs::motions_of_the_reference, ::twists_of_frames

use super::motion_space::MotionSpace;
use crate::closure::constraint::closed_chain::ClosedChain;
use crate::error::Result;
use crate::kinematics::{Chain, EndEffector, ReferenceFrame, State};
use crate::model::Dimension;
use crate::spatial::Twist;

/// Twists that span the motions of a frame: of a tree those of the joints that move it, a twist for
/// each coordinate; of a closed chain a basis of the motions that loops and contacts permit. At the
/// world origin, world axes.
///
/// ```
/// use cylindroid::closure::frame_twists;
///
/// // One leg of a delta robot has more freedoms than its platform, which only translates.
/// let delta = cylindroid::load("delta")?;
/// let twists = frame_twists(&delta.state(delta.home())?, delta.reference())?;
/// assert_eq!(twists.len(), 3);
/// # Ok::<(), cylindroid::Error>(())
/// ```
///
/// # Errors
/// As [`ClosedChain::of`].
pub fn frame_twists(state: &State, of: impl Into<EndEffector>) -> Result<Vec<Twist>> {
    let (mechanism, of) = (state.mechanism(), of.into());
    mechanism.check_frame(of.frame)?;
    if mechanism.is_closed() {
        return Ok(ClosedChain::of(state, Some(of.frame), None)?.reference_twists(state));
    }
    let jacobian = state.jacobian(of, ReferenceFrame::World)?;
    let twist = |&c: &usize| Twist::from_array(std::array::from_fn(|i| jacobian.column(c)[i]));
    Ok(Chain::of(mechanism, of).coordinates().iter().map(twist).collect())
}

impl ClosedChain {
    /// A basis of the motions of the reference link at `state`, for which this chain was made:
    /// twists at the world origin, world axes.
    ///
    /// ```
    /// use cylindroid::closure::ClosedChain;
    ///
    /// // Two actuated joints move the end point of a five-bar in the plane.
    /// let five_bar = cylindroid::load("five-bar")?;
    /// let state = five_bar.state(five_bar.home())?;
    /// let twists = ClosedChain::of(&state, None, None)?.reference_twists(&state);
    /// assert!(twists.len() == 2 && twists.iter().all(|twist| twist.linear.z == 0.0));
    /// # Ok::<(), cylindroid::Error>(())
    /// ```
    ///
    /// # Panics
    /// If the state is of another mechanism.
    #[must_use]
    pub fn reference_twists(&self, state: &State) -> Vec<Twist> {
        let parts = MotionSpace::of(&self.constraint).relation().motions();
        let planar = self.constraint.object() == Dimension::Planar.freedoms();
        let components = if planar { Dimension::Planar } else { Dimension::Spatial }.components();
        let origin = state.pose_of(self.reference).translation;
        let twist = |column: &[f64]| {
            let mut all = [0.0; 6];
            components.iter().zip(column).for_each(|(&i, x)| all[i] = *x);
            // The velocity of the body point at the world origin.
            Twist::from_array(all).at_point(-origin)
        };
        let columns = |m: &crate::linalg::Matrix| -> Vec<Twist> {
            (0..m.cols()).map(|j| twist(m.column(j))).collect()
        };
        [columns(&parts.object), columns(&parts.infinite)].concat()
    }
}
