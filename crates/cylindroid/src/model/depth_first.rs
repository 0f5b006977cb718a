//! The joints of a mechanism depth-first, and what keeps them from being a tree.
//!
//! Checked  tests/it/model.rs, tests/formats/broken.rs

use std::collections::BTreeMap;

use super::builder::Builder;
use super::tree_order::TreeOrder;
use crate::error::Result;

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
                        shorten(&names, ", ")
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
        let mut places = vec![None; self.links.len()];
        places[start] = Some(0);
        let mut link = start;
        while let Some(j) = parent_joint[link] {
            link = links[&self.joints[j].parent];
            if let Some(first) = places[link] {
                let mut names: Vec<&str> =
                    path[first..].iter().rev().map(|&l| self.links[l].name.as_str()).collect();
                names.push(names[0]);
                let culprit = &self.joints[j].name;
                return self.refuse(
                    culprit,
                    format!(
                        "its links form a cycle without a root: {}; a tree has one link that is \
                         no joint's child",
                        shorten(&names, " -> ")
                    ),
                );
            }
            places[link] = Some(path.len());
            path.push(link);
        }
        self.refuse(&self.links[start].name, "it is not connected to the root")
    }
}

/// Names for a message, at most ten of them.
fn shorten(names: &[&str], between: &str) -> String {
    match names {
        [first @ .., last] if first.len() > 9 => {
            format!("{}{between}...{between}{last}", first[..9].join(between))
        }
        _ => names.join(between),
    }
}
