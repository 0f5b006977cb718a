//! Twists of the reference link: a basis of its motions, from which its screw system is computed.
//!
//! Formula  object columns of the coordinate and the indeterminate directions of the relation
//!          between actuated joints and object, moved from the origin of the frame to that of the
//!          world
//! Shapes   a twist for each independent motion, at most d (6, in the plane 3)
//! Units    m, rad
//! Frame    world, at the world origin
//! Valid    any mechanism; for a tree they span the columns of its Jacobian
//! Checked  tests/it/closure/graph.rs::motions_of_the_reference

use super::motion_space::MotionSpace;
use crate::closure::constraint::closed_chain::ClosedChain;
use crate::kinematics::State;
use crate::model::Dimension;
use crate::spatial::Twist;

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
    #[must_use]
    pub fn reference_twists(&self, state: &State) -> Vec<Twist> {
        let parts = MotionSpace::of(&self.constraint).relation().motions();
        let planar = self.constraint.object() == Dimension::Planar.freedoms();
        let components = if planar { Dimension::Planar } else { Dimension::Spatial }.components();
        let origin = state.pose(self.reference).translation;
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
