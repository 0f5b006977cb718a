//! Groups and states of an SRDF on a mechanism: the reduced mechanism of a group, the configuration
//! of a state.
//!
//! Valid    a group moves alone, the other joints fixed where they are. Its tool is the link that
//!          carries its end effector, otherwise the tip of its chain, otherwise what the reduced
//!          mechanism chooses
//! Checked  tests/formats/srdf.rs

use super::{EndEffector, Group, GroupState, Srdf};
use crate::error::{Error, Result};
use crate::model::{Joint, Mechanism};

impl Srdf {
    /// The mechanism of a group: its joints move, all others are fixed at their positions in `q`,
    /// which also becomes home.
    ///
    /// ```
    /// use cylindroid::model::formats::srdf;
    ///
    /// let panda = cylindroid::load("panda")?;
    /// let text = r#"<robot name="panda">
    ///     <group name="forearm"><chain base_link="link4" tip_link="link7"/></group>
    /// </robot>"#;
    /// let forearm = srdf::parse(text, "panda.srdf".as_ref())?.group("forearm", &panda, panda.home())?;
    /// assert_eq!(forearm.n(), 3);
    /// assert_eq!(forearm.frame_of(forearm.tool()).name, "link7");
    /// # Ok::<(), cylindroid::Error>(())
    /// ```
    ///
    /// # Errors
    /// [`Error::UnknownName`] for a group, joint or link that does not exist; [`Error::InvalidOption`]
    /// for groups that contain one another, and for chains whose tip is not on a branch of their base;
    /// those of [`Mechanism::with_fixed_joints`].
    pub fn group(&self, name: &str, mechanism: &Mechanism, q: &[f64]) -> Result<Mechanism> {
        let own = self.joints_of(name, mechanism)?;
        let others = mechanism.joints().iter().filter(|j| j.mimic.is_none() && j.kind.dof() > 0);
        let fixed: Vec<&str> =
            others.map(|j| j.name.as_str()).filter(|name| !own.contains(name)).collect();
        let mut reduced = mechanism.with_fixed_joints(&fixed, q)?;
        if let Some(tip) = self.tip(name, mechanism, &own)? {
            reduced = reduced.with_tool(tip)?;
        }
        Ok(reduced)
    }

    /// The movable joints of a group that follow no others, in the order of the mechanism.
    ///
    /// # Errors
    /// As [`Srdf::group`].
    pub fn joints_of<'m>(&self, name: &str, mechanism: &'m Mechanism) -> Result<Vec<&'m str>> {
        let joints = mechanism.joints();
        let mut chosen = vec![false; joints.len()];
        self.choose(name, mechanism, &mut chosen, &mut Vec::new())?;
        let moves = |j: &Joint| j.kind.dof() > 0 && j.mimic.is_none();
        let own = joints.iter().zip(chosen).filter(|(j, chosen)| *chosen && moves(j));
        Ok(own.map(|(j, _)| j.name.as_str()).collect())
    }

    /// The configuration of a state: its joints at their positions, the others as in `q`. Of states of
    /// several groups that have the same name, `group/name` is one, and `name` alone all of them.
    ///
    /// # Errors
    /// [`Error::UnknownName`] for a state or joint that does not exist; [`Error::Dimension`] for a
    /// position of another size.
    pub fn configuration(&self, name: &str, mechanism: &Mechanism, q: &[f64]) -> Result<Vec<f64>> {
        mechanism.check_q("q", q)?;
        let full = |s: &GroupState| s.group.as_ref().map(|group| format!("{group}/{}", s.name));
        let is_meant = |s: &&GroupState| s.name == name || full(s).is_some_and(|full| full == name);
        let mut states = self.states.iter().filter(is_meant).peekable();
        if states.peek().is_none() {
            let known = self.states.iter().map(|s| &s.name);
            return Err(Error::unknown("state", name, known));
        }
        let mut out = q.to_vec();
        for (joint, values) in states.flat_map(|s| &s.joints) {
            let Some(found) = mechanism.joints().iter().find(|j| j.name == *joint) else {
                let known = mechanism.joints().iter().map(|j| &j.name);
                return Err(Error::unknown("joint", joint, known));
            };
            // Followers move with their leaders; joints of other groups may be fixed.
            if found.mimic.is_none() && !found.coordinates.is_empty() {
                let what = format!("joint '{joint}' of state '{name}'");
                Error::check_len(&what, found.coordinates.len(), values.len())?;
                out[found.coordinates.clone()].copy_from_slice(values);
            }
        }
        Ok(out)
    }

    fn named(&self, name: &str) -> Result<&Group> {
        let found = self.groups.iter().find(|g| g.name == name);
        found.ok_or_else(|| Error::unknown("group", name, self.groups.iter().map(|g| &g.name)))
    }

    fn choose<'s>(
        &'s self,
        name: &str,
        mechanism: &Mechanism,
        chosen: &mut [bool],
        within: &mut Vec<&'s str>,
    ) -> Result<()> {
        let group = self.named(name)?;
        if within.contains(&group.name.as_str()) {
            return Err(Error::InvalidOption {
                option: "group",
                value: name.to_owned(),
                reason: format!("it contains itself: {} in {name}", within.join(" in ")),
            });
        }
        within.push(&group.name);
        for joint in &group.joints {
            chosen[joint_named(mechanism, joint)?] = true;
        }
        for link in &group.links {
            // The root has no joint.
            if let Some(i) = joint_above(mechanism, link_named(mechanism, link)?) {
                chosen[i] = true;
            }
        }
        for [base, tip] in &group.chains {
            let (base_link, mut at) = (link_named(mechanism, base)?, link_named(mechanism, tip)?);
            while at != base_link {
                let Some(i) = joint_above(mechanism, at) else {
                    return Err(Error::InvalidOption {
                        option: "group",
                        value: name.to_owned(),
                        reason: format!("its chain ends at '{tip}', which '{base}' does not carry"),
                    });
                };
                chosen[i] = true;
                at = mechanism.joints()[i].parent;
            }
        }
        for part in &group.groups {
            self.choose(part, mechanism, chosen, within)?;
        }
        within.pop();
        Ok(())
    }

    /// The frame of the tool of a group.
    fn tip<'s>(
        &'s self,
        name: &str,
        mechanism: &Mechanism,
        own: &[&str],
    ) -> Result<Option<&'s str>> {
        let is_carrier = |e: &&EndEffector| match &e.parent_group {
            Some(group) => group == name,
            None => true,
        };
        for carried in self.end_effectors.iter().filter(is_carrier) {
            let mut at = link_named(mechanism, &carried.parent_link)?;
            let named = carried.parent_group.is_some() || carried.group == name;
            // Otherwise the group whose last joint moves the link.
            while let Some(i) = joint_above(mechanism, at) {
                let joint = &mechanism.joints()[i];
                if own.contains(&joint.name.as_str()) {
                    return Ok(Some(&carried.parent_link));
                }
                if joint.kind.dof() > 0 && !named {
                    break;
                }
                at = joint.parent;
            }
        }
        Ok(match self.named(name)?.chains.as_slice() {
            [[_, tip]] => Some(tip),
            _ => None,
        })
    }
}

fn joint_named(mechanism: &Mechanism, name: &str) -> Result<usize> {
    let joints = mechanism.joints();
    let found = joints.iter().position(|j| j.name == name);
    found.ok_or_else(|| Error::unknown("joint", name, joints.iter().map(|j| &j.name)))
}

/// The link of a frame: links are frames, and other formats than URDF have more.
fn link_named(mechanism: &Mechanism, name: &str) -> Result<usize> {
    Ok(mechanism.frame_of(mechanism.frame(name)?).link)
}

fn joint_above(mechanism: &Mechanism, link: usize) -> Option<usize> {
    mechanism.joints().iter().position(|j| j.child == link)
}
