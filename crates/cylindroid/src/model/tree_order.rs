//! Order of the spanning tree, and the default tool: the link at the end of its only moving branch.
//!
//! Checked  tests/it/model.rs

use std::collections::BTreeMap;

use super::builder::Builder;
use super::joint_spec::JointSpec;
use super::natural_order::Natural;
use crate::error::Result;

/// The root link and the joints, depth-first.
pub(super) struct TreeOrder {
    pub(super) root: usize,
    pub(super) joints: Vec<usize>,
}

impl Builder {
    /// The joints from the root, depth-first in the order given.
    pub(super) fn depth_first(&self, links: &BTreeMap<String, usize>) -> Result<TreeOrder> {
        let mut children: Vec<Vec<usize>> = vec![Vec::new(); self.links.len()];
        let mut parent_joint = vec![None; self.links.len()];
        for (j, joint) in self.joints.iter().enumerate() {
            children[links[&joint.parent]].push(j);
            parent_joint[links[&joint.child]] = Some(j);
        }
        let roots: Vec<usize> =
            (0..self.links.len()).filter(|&l| parent_joint[l].is_none()).collect();
        let root = match roots.as_slice() {
            [] => return self.refuse_cycle(links, &parent_joint, 0),
            [root] => *root,
            several => {
                let names: Vec<&str> =
                    several.iter().map(|&l| self.links[l].name.as_str()).collect();
                return self.refuse(
                    names[1],
                    format!(
                        "it falls into {} parts: links {} have no parent joint; connect them or \
                         remove all but one",
                        names.len(),
                        names.join(", ")
                    ),
                );
            }
        };
        let mut joints = Vec::with_capacity(self.joints.len());
        let mut visited = vec![false; self.links.len()];
        let mut stack = vec![root];
        while let Some(link) = stack.pop() {
            visited[link] = true;
            joints.extend(parent_joint[link]);
            stack.extend(children[link].iter().rev().map(|&j| links[&self.joints[j].child]));
        }
        match visited.iter().position(|v| !v) {
            None => Ok(TreeOrder { root, joints }),
            Some(unreached) => self.refuse_cycle(links, &parent_joint, unreached),
        }
    }

    /// Every link has a parent from here on: walks up until a link repeats, and names the cycle.
    fn refuse_cycle(
        &self,
        links: &BTreeMap<String, usize>,
        parent_joint: &[Option<usize>],
        start: usize,
    ) -> Result<TreeOrder> {
        let mut path = vec![start];
        let mut link = start;
        while let Some(j) = parent_joint[link] {
            link = links[&self.joints[j].parent];
            if let Some(first) = path.iter().position(|&l| l == link) {
                let mut names: Vec<&str> =
                    path[first..].iter().rev().map(|&l| self.links[l].name.as_str()).collect();
                names.push(names[0]);
                let culprit = &self.joints[j].name;
                return self.refuse(
                    culprit,
                    format!(
                        "its links form a cycle without a root: {}; a tree has one link that is \
                         no joint's child",
                        names.join(" -> ")
                    ),
                );
            }
            path.push(link);
        }
        self.refuse(&self.links[start].name, "it is not connected to the root")
    }
}

/// The default tool: from the root along the only moving branch until none or several continue (a
/// hand with fingers), then to the last link fixed there. If the root itself branches (humanoids,
/// hands), the end of the branch with the most moving joints.
pub(super) fn default_tool(
    order: &TreeOrder,
    joints: &[JointSpec],
    links: &BTreeMap<String, usize>,
    by_name: bool,
) -> usize {
    // Of links that are alike the last one counts, in the order given or by name.
    let mut ranks: Vec<usize> = (0..links.len()).collect();
    if by_name {
        let mut sorted: Vec<(&String, &usize)> = links.iter().collect();
        sorted.sort_by_key(|(name, _)| Natural(name));
        sorted.iter().enumerate().for_each(|(rank, (_, l))| ranks[**l] = rank);
    }
    let ends: Vec<(usize, usize)> =
        joints.iter().map(|j| (links[&j.parent], links[&j.child])).collect();
    let moves = |j: usize| joints[j].kind.dof() > 0;
    // For each link: the joints that leave it, and the moving joints below and above it.
    let mut children = vec![Vec::new(); links.len()];
    let mut above = vec![0; links.len()];
    for &j in &order.joints {
        let (parent, child) = ends[j];
        children[parent].push(j);
        above[child] = above[parent] + usize::from(moves(j));
    }
    let mut below = vec![0; links.len()];
    for &j in order.joints.iter().rev() {
        let (parent, child) = ends[j];
        below[parent] += below[child] + usize::from(moves(j));
    }
    let carries = |j: usize| moves(j) || below[ends[j].1] > 0;

    let mut link = order.root;
    let mut moved = false;
    loop {
        let mut branches = children[link].iter().copied().filter(|&j| carries(j));
        let (Some(only), None) = (branches.next(), branches.next()) else { break };
        moved |= moves(only);
        link = ends[only].1;
    }
    if !moved {
        let deepest = (0..above.len()).max_by_key(|&l| (above[l], ranks[l]));
        link = deepest.unwrap_or(order.root);
    }
    loop {
        let fixed = children[link].iter().enumerate().filter(|(_, j)| !carries(**j));
        let rank = |place: usize, l: usize| if by_name { ranks[l] } else { place };
        let last = fixed.max_by_key(|(place, j)| rank(*place, ends[**j].1));
        let Some((_, &joint)) = last else { return link };
        link = ends[joint].1;
    }
}
