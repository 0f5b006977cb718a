//! The frames of the robot as transforms: links in their parents, named frames on their links.

use cylindroid::{FrameId, Mechanism, Result, State};

use crate::messages::{Header, Quaternion, TFMessage, Time, Transform, TransformStamped, Vector3};

/// Parent and child of every frame but the root.
pub(crate) struct Frames(Vec<[(FrameId, String); 2]>);

impl Frames {
    pub(crate) fn new(robot: &Mechanism) -> Self {
        let ids: Vec<FrameId> = robot.frame_ids().collect();
        let name = |i: usize| (ids[i], robot.frames()[i].name.clone());
        // The frames of the links come first.
        let links = robot.joints().iter().map(|joint| [name(joint.parent), name(joint.child)]);
        let on_links =
            (robot.links().len()..ids.len()).map(|i| [name(robot.frames()[i].link), name(i)]);
        Self(links.chain(on_links).collect())
    }

    /// The transforms at this state.
    pub(crate) fn at(&self, state: &State, stamp: &Time) -> Result<TFMessage> {
        let transform = |[(parent, parent_name), (child, child_name)]: &[(FrameId, String); 2]| {
            let pose = state.pose(*parent)?.inverse() * state.pose(*child)?;
            let (p, q) = (pose.translation, pose.rotation.to_quaternion());
            Ok(TransformStamped {
                header: Header { stamp: stamp.clone(), frame_id: parent_name.clone() },
                child_frame_id: child_name.clone(),
                transform: Transform {
                    translation: Vector3 { x: p.x, y: p.y, z: p.z },
                    rotation: Quaternion { x: q.x, y: q.y, z: q.z, w: q.w },
                },
            })
        };
        Ok(TFMessage { transforms: self.0.iter().map(transform).collect::<Result<_>>()? })
    }
}
