//! Spatial inertia of a body about a point: the metric of twists that is twice their kinetic
//! energy.
//!
//! Formula  the page of [`body_inertia`], summed over all links that are fixed to each other
//! Shapes   6 x 6; 3 x 3 in the plane (x, y and the rotation about z)
//! Units    kg, kg m, kg m^2: `u^T W u` is twice the kinetic energy [J]
//! Frame    at the origin of the frame, world axes, as the object's twist
//! Valid    any mechanism; links without a mass in the file do not contribute
//! Source   Featherstone, Rigid Body Dynamics Algorithms, 2008, eq. 2.63 (linear first here)
//! Checked  tests/it/manipulability/metrics.rs::inertia_*

use crate::error::Result;
use crate::kinematics::State;
use crate::linalg::Matrix;
use crate::model::FrameId;
use crate::spatial::Mat3;

/// The inertia of the body that carries `frame`, about the frame's origin in world axes; `None` if
/// the file gives it no mass.
///
/// ```text
/// W = [m 1, -m S(c); m S(c), I_c - m S(c)^2],   u^T W u = 2 E_kin
/// ```
///
/// 6 x 6, linear part first (3 x 3 in the plane: x, y and the rotation about z), in kg, kg m and
/// kg m^2; c from the origin to the centre of mass, I_c the inertia about it, S the matrix of the
/// vector product.
///
/// Source: Featherstone 2008, eq. 2.63.
///
/// ```
/// use cylindroid::manipulability::body_inertia;
///
/// // The catalogue gives no masses to the links of a four-bar.
/// let mechanism = cylindroid::load("four-bar")?;
/// let state = mechanism.state(mechanism.home())?;
/// assert!(body_inertia(&state, mechanism.reference())?.is_none());
/// # Ok::<(), cylindroid::Error>(())
/// ```
///
/// # Errors
/// A frame of another mechanism.
pub fn body_inertia(state: &State, frame: FrameId) -> Result<Option<Matrix>> {
    let mechanism = state.mechanism();
    mechanism.check_frame(frame)?;
    let slot = mechanism.frame_of(frame).slot;
    let origin = state.pose_of(frame).translation;
    let mut sum = Matrix::zeros(6, 6);
    let mut total = 0.0;
    for (i, link) in mechanism.links().iter().enumerate() {
        let link_frame = mechanism.link_frame(i);
        let carried = mechanism.frame_of(link_frame).slot == slot;
        let (Some(inertial), true) = (&link.inertial, carried) else { continue };
        let world_from_inertia = state.pose_of(link_frame) * inertial.link_from_inertia;
        let mass = inertial.mass;
        let arm = Mat3::skew(world_from_inertia.translation - origin);
        let turn = world_from_inertia.rotation.matrix();
        let about = turn * inertial.inertia * turn.transpose() - arm * arm * mass;
        let entry = |m: Mat3, i: usize, j: usize| m.cols[j][i];
        for i in 0..3 {
            sum[(i, i)] += mass;
            for j in 0..3 {
                sum[(i, 3 + j)] -= mass * entry(arm, i, j);
                sum[(3 + i, j)] += mass * entry(arm, i, j);
                sum[(3 + i, 3 + j)] += entry(about, i, j);
            }
        }
        total += mass;
    }
    if !(total > 0.0) {
        return Ok(None);
    }
    let kept = mechanism.dimension().components();
    Ok(Some(Matrix::from_fn(kept.len(), kept.len(), |i, j| sum[(kept[i], kept[j])])))
}
