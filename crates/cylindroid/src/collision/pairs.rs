//! The pairs of shapes that can collide: not of one rigid body, not of neighbours.
//!
//! Valid    neighbours are rigid bodies that a joint of the tree or of a loop connects, other than a
//!          free one, and the two bodies of a contact
//! Why so   rigid bodies, not links: a flange that is fixed to a link is no neighbour but a part of it
//! Checked  tests/collision/pairs.rs

use super::body::Body;
use super::convex::Core;
use super::scene::Pair;
use crate::error::{Error, Result};
use crate::model::{Ignored, JointKind, Mechanism};

/// Pairs of shapes at most, before those that always or never touch are dropped; the rest takes 16
/// bytes each, and a bound of its distance in every search.
const MOST_CANDIDATES: usize = 4_000_000;

/// All pairs of shapes of links that can move relative to one another and are neither neighbours
/// nor disabled; disabled pairs of unknown links are logged.
///
/// # Errors
/// More than [`MOST_CANDIDATES`].
pub(super) fn candidates(
    mechanism: &Mechanism,
    bodies: &[Body],
    disabled: &[[String; 2]],
    ignored: &mut Vec<Ignored>,
) -> Result<Vec<Pair>> {
    let link = |name: &String| mechanism.links().iter().position(|l| l.name == *name);
    let by_file = mechanism.disabled_collisions().iter().map(|&[a, b]| ordered(a, b));
    let mut apart: Vec<(usize, usize)> = by_file.collect();
    for [a, b] in disabled {
        match (link(a), link(b)) {
            (Some(a), Some(b)) => apart.push(ordered(a, b)),
            (found, _) => ignored.push(Ignored {
                line: 0,
                what: format!("disabled collision of '{a}' and '{b}'"),
                why: format!("there is no link '{}'", if found.is_none() { a } else { b }),
            }),
        }
    }
    apart.sort_unstable();
    // The slot of the body is that of its last joint; a joint of several coordinates has more slots.
    let slot = |link: usize| mechanism.frames()[link].slot;
    let tree = mechanism.joints().iter().map(|j| (j.kind, j.parent, j.child));
    let loops = mechanism.loops().iter().map(|l| (l.kind, l.a, l.b));
    let joined = tree.chain(loops).filter(|(kind, ..)| *kind != JointKind::Free);
    let joined = joined.map(|(_, a, b)| (a, b));
    let touching = mechanism.contacts().iter().map(|c| (c.a, c.b));
    let mut neighbours: Vec<(usize, usize)> =
        joined.chain(touching).map(|(a, b)| ordered(slot(a), slot(b))).collect();
    neighbours.sort_unstable();

    let is_half_space = |body: &Body| matches!(body.convex.core, Core::HalfSpace);
    let mut pairs = Vec::new();
    for (a, first) in bodies.iter().enumerate() {
        for (b, second) in bodies.iter().enumerate().skip(a + 1) {
            let links = first.link.zip(second.link).map(|(a, b)| ordered(a, b));
            let rigid = first.slot == second.slot;
            let near = neighbours.binary_search(&ordered(first.slot, second.slot)).is_ok();
            let off = links.is_some_and(|l| apart.binary_search(&l).is_ok());
            let planes = is_half_space(first) && is_half_space(second);
            let ignore = (first.category & second.mask) | (second.category & first.mask) == 0;
            if rigid || near || off || planes || ignore {
                continue;
            }
            check_count(pairs.len() + 1, bodies.len())?;
            pairs.push(Pair { a, b });
        }
    }
    Ok(pairs)
}

/// Returns an error for more pairs than [`MOST_CANDIDATES`].
pub(super) fn check_count(pairs: usize, shapes: usize) -> Result<()> {
    if pairs <= MOST_CANDIDATES {
        return Ok(());
    }
    Err(Error::InvalidOption {
        option: "collision model",
        value: format!("{shapes} shapes"),
        reason: format!(
            "more than {MOST_CANDIDATES} pairs of them could collide; merge shapes, give fewer links a \
             collision shape, or disable pairs in an SRDF"
        ),
    })
}

fn ordered(a: usize, b: usize) -> (usize, usize) {
    (a.min(b), a.max(b))
}
