//! Order of the spanning tree, and the default tool: the link at the end of its only moving branch.
//!
//! Checked  tests/it/model.rs

use std::collections::BTreeMap;

use super::joint_spec::JointSpec;
use super::natural_order::Natural;

/// The root link and the joints, depth-first.
pub(super) struct TreeOrder {
    pub(super) root: usize,
    pub(super) joints: Vec<usize>,
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
