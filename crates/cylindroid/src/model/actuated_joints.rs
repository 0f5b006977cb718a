//! A mechanism with other actuated joints.
//!
//! Checked  tests/it/graph.rs

use std::collections::BTreeSet;
use std::sync::Arc;

use super::mechanism::{Data, Mechanism};
use crate::error::{Error, Result};

impl Mechanism {
    /// The same mechanism with these actuated joints and no others: names of joints of the tree, of
    /// their coordinates, or of loop joints. Coordinates keep their order.
    ///
    /// ```
    /// let five_bar = cylindroid::load("five-bar")?.with_actuated(&["q2", "q4"])?;
    /// assert_eq!(five_bar.actuated().collect::<Vec<_>>(), [1, 3]);
    /// # Ok::<(), cylindroid::Error>(())
    /// ```
    ///
    /// # Errors
    /// [`Error::UnknownName`] with the nearest names; [`Error::InvalidOption`] for a fixed joint, a
    /// mimic joint or one that is named twice.
    pub fn with_actuated<S: AsRef<str>>(&self, names: &[S]) -> Result<Self> {
        let data = &self.data;
        let mut joints = data.joints.clone();
        let mut coordinates = data.coordinates.clone();
        let mut loops = data.loops.clone();
        joints.iter_mut().for_each(|j| j.actuated = false);
        coordinates.iter_mut().for_each(|c| c.actuated = false);
        loops.iter_mut().for_each(|l| l.actuated = false);
        let mut named = BTreeSet::new();
        for name in names.iter().map(AsRef::as_ref) {
            let refuse = |reason: String| {
                Err(Error::InvalidOption { option: "actuated", value: name.to_owned(), reason })
            };
            if !named.insert(name) {
                return refuse("it is named twice; name each joint once".to_owned());
            }
            if let Some(joint) = joints.iter_mut().find(|j| j.name == name) {
                if let Some(mimic) = &joint.mimic {
                    return refuse(format!("it follows '{}'; name that joint", mimic.joint));
                }
                if joint.kind.dof() == 0 {
                    return refuse("it is fixed; name a movable joint".to_owned());
                }
                joint.actuated = true;
                coordinates[joint.coordinates.clone()].iter_mut().for_each(|c| c.actuated = true);
            } else if let Some(joint) = loops.iter_mut().find(|l| l.name == name) {
                if joint.kind.dof() == 0 {
                    return refuse("it is fixed; name a movable joint".to_owned());
                }
                joint.actuated = true;
            } else if let Some(coordinate) = coordinates.iter_mut().find(|c| c.name == name) {
                coordinate.actuated = true;
                joints[coordinate.joint].actuated = true;
            } else {
                let moving = data.joints.iter().filter(|j| j.kind.dof() > 0).map(|j| &j.name);
                let known = moving.chain(data.loops.iter().map(|l| &l.name));
                return Err(Error::unknown("joint", name, known));
            }
        }
        Ok(Self { data: Arc::new(Data { joints, coordinates, loops, ..Data::clone(data) }) })
    }
}
