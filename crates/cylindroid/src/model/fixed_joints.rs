//! A mechanism with some of its joints fixed: the reduced model of a group of joints, and its tool.
//!
//! Formula  parent_from_joint' = parent_from_joint transform(q), see `joint_transform.rs`
//! Why so   a copy through the builder, with the joints folded away, so that everything downstream
//!          sees fewer coordinates; limits of no width would keep them as unknowns everywhere
//! Source   `buildReducedModel` of Pinocchio
//! Checked  tests/it/fixed_joints.rs

use std::sync::Arc;

use super::builder::Builder;
use super::elasticity::ElasticKind;
use super::include::Inclusion;
use super::joint::JointKind;
use super::mechanism::Mechanism;
use super::tool_choice::ToolChoice;
use crate::error::{Error, Result};
use crate::spatial::Pose;

impl Mechanism {
    /// The same mechanism with these joints of the tree fixed at their positions in `q`, and with them
    /// the joints that follow them. The other positions of `q` become home; the loops of a closed chain
    /// are closed there if they are at `q`.
    ///
    /// ```
    /// // The arm of a Panda whose fourth joint is locked.
    /// let panda = cylindroid::load("panda")?;
    /// let name = panda.coordinates()[3].name.clone();
    /// let locked = panda.with_fixed_joints(&[&name], panda.home())?;
    /// assert_eq!(locked.n(), panda.n() - 1);
    /// let at_home = |robot: &cylindroid::Mechanism| Ok::<_, cylindroid::Error>(
    ///     robot.state(robot.home())?.pose(robot.tool())?,
    /// );
    /// let way = at_home(&panda)?.translation - at_home(&locked)?.translation;
    /// assert!(way.norm() < 1e-15);
    /// # Ok::<(), cylindroid::Error>(())
    /// ```
    ///
    /// # Errors
    /// [`Error::UnknownName`] with the nearest names; [`Error::InvalidOption`] for a joint that follows
    /// another one or closes a loop; those of [`Mechanism::check_q`].
    #[doc(alias = "buildReducedModel")]
    pub fn with_fixed_joints<S: AsRef<str>>(&self, names: &[S], q: &[f64]) -> Result<Self> {
        self.check_q("q", q)?;
        let mut fixed = vec![false; self.joints().len()];
        for name in names.iter().map(AsRef::as_ref) {
            fixed[self.fixable(name)?] = true;
        }
        // Followers after those that they follow, in any order of the tree.
        for (i, joint) in self.joints().iter().enumerate() {
            let followed = |j: &usize| self.joints()[*j].coordinates == joint.coordinates;
            let own = joint.coordinates.len() == 1 && joint.mimic.is_some();
            if own && (0..fixed.len()).filter(|j| fixed[*j]).any(|j| followed(&j)) {
                fixed[i] = true;
            }
        }
        let mut builder = self.copied(q)?;
        let motions = self.joint_motions(q);
        for ((spec, motion), fixed) in builder.joints.iter_mut().zip(&motions).zip(&fixed) {
            if *fixed {
                spec.parent_from_joint = spec.parent_from_joint * *motion;
                (spec.kind, spec.mimic, spec.reversed) = (JointKind::Fixed, None, false);
                builder.starts.remove(&spec.name);
            }
        }
        let moves = |name: &str| {
            let of = |i: &usize| self.coordinates()[*i].name == name;
            let mut own = self.joints().iter().zip(&fixed).filter(|(_, fixed)| **fixed);
            !own.any(|(joint, _)| joint.name == name || joint.coordinates.clone().any(|i| of(&i)))
        };
        builder.elasticity.elements.retain(|element| match element.kind {
            ElasticKind::Motion { .. } => moves(&element.name),
            _ => true,
        });
        builder.build()
    }

    /// The same mechanism with this frame as the tool, and as the reference if the tool was it.
    ///
    /// ```
    /// let panda = cylindroid::load("panda")?.with_tool("link4")?;
    /// assert_eq!(panda.frame_of(panda.tool()).name, "link4");
    /// # Ok::<(), cylindroid::Error>(())
    /// ```
    ///
    /// # Errors
    /// [`Error::UnknownName`](crate::Error::UnknownName) with the nearest names.
    pub fn with_tool(&self, frame: &str) -> Result<Self> {
        let tool = self.frame(frame)?;
        let mut data = (*self.data).clone();
        if data.reference == data.tool {
            data.reference = tool;
        }
        (data.tool, data.tool_choice) = (tool, ToolChoice::Named);
        Ok(Self { data: Arc::new(data) }.measured())
    }

    /// The index of a joint of this name that can be fixed.
    fn fixable(&self, name: &str) -> Result<usize> {
        let refuse = |reason: String| {
            Err(Error::InvalidOption { option: "fixed joints", value: name.to_owned(), reason })
        };
        if let Some(i) = self.joints().iter().position(|j| j.name == name) {
            return match &self.joints()[i].mimic {
                Some(mimic) => refuse(format!("it follows '{}'; name that joint", mimic.joint)),
                None => Ok(i),
            };
        }
        if self.loops().iter().any(|l| l.name == name) {
            return refuse("it closes a loop and has no coordinate; fix joints of the tree".into());
        }
        if let Some(c) = self.coordinates().iter().find(|c| c.name == name) {
            let joint = &self.joints()[c.joint].name;
            return refuse(format!("it is a coordinate of joint '{joint}'; name the joint"));
        }
        let moving = self.joints().iter().filter(|j| j.kind.dof() > 0 && j.mimic.is_none());
        Err(Error::unknown("joint", name, moving.map(|j| &j.name)))
    }

    /// A builder with all parts of this mechanism, joints in its order; home is `q`.
    pub(crate) fn copied(&self, q: &[f64]) -> Result<Builder> {
        let root = self.root();
        let mut builder = Self::builder(self.name());
        builder.dimension(self.dimension());
        let how = Inclusion {
            name: "",
            parent: &self.links()[root].name,
            parent_from_root: Pose::IDENTITY,
            free: false,
            start: q,
        };
        builder.include(self, how)?;
        builder.links = self.links().to_vec();
        let name = |id| &self.frame_of(id).name;
        builder.tool(name(self.tool())).reference(name(self.reference()));
        *builder.report() = self.report().clone();
        Ok(builder)
    }
}
