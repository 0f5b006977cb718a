//! A spanning tree of a graph of links and joints, and the joints that close its loops.
//!
//! Formula  Kruskal's algorithm: joints enter the tree in the order of their [`Rank`]; the tree is
//!          then traversed breadth-first from its roots
//! Valid    any graph. Joints that are not connected to a root are returned, never dropped
//! Why so   a spanning tree of minimum rank contains the largest possible number of actuated joints
//!          (matroid); a breadth-first search from the root does not, since its tree depends on the
//!          order of traversal. No rank depends on the order of the file, so no result does
//! Checked  tests/formats/closed_file.rs::spanning_*, tests/formats/order.rs

use std::collections::VecDeque;

use crate::model::JointKind;
use crate::model::natural_order::Natural;

/// The rank of a joint: smaller ones enter the tree first.
///
/// Mimic joints and the joints that they follow must have coordinates. Actuated joints should have
/// them, those with most coordinates first. Passive joints with many degrees of freedom are
/// preferred as loop joints, since they impose fewer constraints. Ties are broken by name.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Rank<'a> {
    class: u8,
    freedoms: usize,
    name: Natural<'a>,
}

/// The role of a joint in a mimic relation.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Coupling {
    None,
    /// Another joint follows it.
    Followed,
    /// It follows another one.
    Follows,
}

impl Coupling {
    pub(super) const fn of(follows: bool, followed: bool) -> Self {
        match (follows, followed) {
            (true, _) => Self::Follows,
            (false, true) => Self::Followed,
            (false, false) => Self::None,
        }
    }
}

impl<'a> Rank<'a> {
    pub(super) fn new(name: &'a str, kind: JointKind, coupling: Coupling, actuated: bool) -> Self {
        let (class, freedoms) = match (coupling, actuated) {
            (Coupling::Followed, _) => (0, 0),
            (Coupling::Follows, _) => (1, 0),
            (Coupling::None, true) => (2, 6 - kind.dof()),
            (Coupling::None, false) => (3, kind.dof()),
        };
        Self { class, freedoms, name: Natural(name) }
    }
}

/// A joint of the tree, seen from its root.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Branch {
    /// Index of the joint.
    pub(super) joint: usize,
    /// The end nearer to the root.
    pub(super) parent: usize,
    /// The other end.
    pub(super) child: usize,
    /// True if the joint is written from the child to the parent.
    pub(super) reversed: bool,
}

/// A spanning tree, and the joints outside it.
#[derive(Debug, Default)]
pub(super) struct SpanningTree {
    /// Parents before children.
    pub(super) tree: Vec<Branch>,
    /// Joints that close loops, in the order of the file.
    pub(super) loops: Vec<usize>,
    /// Joints that are not connected to a root, in the order of the file.
    pub(super) loose: Vec<usize>,
}

/// Connected components of the links (union-find).
#[derive(Debug, Clone)]
pub(super) struct Groups {
    parent: Vec<usize>,
}

impl Groups {
    pub(super) fn new(links: usize) -> Self {
        Self { parent: (0..links).collect() }
    }

    pub(super) fn of(&mut self, mut link: usize) -> usize {
        while self.parent[link] != link {
            self.parent[link] = self.parent[self.parent[link]];
            link = self.parent[link];
        }
        link
    }

    /// Merges two components; false if they were one already.
    pub(super) fn join(&mut self, a: usize, b: usize) -> bool {
        let (a, b) = (self.of(a), self.of(b));
        self.parent[a] = b;
        a != b
    }
}

/// Spans the graph of `links` links whose joint `j` connects `ends[j]`. The roots count as
/// connected with one another.
pub(super) fn spanning_tree(
    links: usize,
    ends: &[[usize; 2]],
    ranks: &[Rank<'_>],
    roots: &[usize],
) -> SpanningTree {
    let mut groups = Groups::new(links);
    for pair in roots.windows(2) {
        groups.join(pair[0], pair[1]);
    }
    let mut order: Vec<usize> = (0..ends.len()).collect();
    order.sort_by_key(|&j| ranks[j]);
    let mut in_tree = vec![false; ends.len()];
    for j in order {
        let [a, b] = ends[j];
        in_tree[j] = groups.join(a, b);
    }

    let mut at_link: Vec<Vec<usize>> = vec![Vec::new(); links];
    for (j, pair) in ends.iter().enumerate() {
        pair.iter().for_each(|&link| at_link[link].push(j));
    }
    let mut reached = vec![false; links];
    roots.iter().for_each(|&r| reached[r] = true);
    let mut queue: VecDeque<usize> = roots.iter().copied().collect();
    let mut span = SpanningTree::default();
    while let Some(parent) = queue.pop_front() {
        for &joint in at_link[parent].iter().filter(|&&j| in_tree[j]) {
            let [a, b] = ends[joint];
            let reversed = b == parent;
            let child = if reversed { a } else { b };
            if !std::mem::replace(&mut reached[child], true) {
                span.tree.push(Branch { joint, parent, child, reversed });
                queue.push_back(child);
            }
        }
    }
    for (j, [a, _]) in ends.iter().enumerate() {
        if !reached[*a] {
            span.loose.push(j);
        } else if !in_tree[j] {
            span.loops.push(j);
        }
    }
    span
}
