//! The platform of a zone of joints, whose coordinates follow.
//!
//! Checked  tests/map/zone.rs

use super::options::MapOptions;
use super::problem::Problem;
use crate::error::Result;
use crate::linalg::{Matrix, Svd};
use crate::model::Mechanism;
use crate::tolerance::PLATFORM_SINGULAR;

/// The problem of a zone of joints. Where a coordinate of position that the mechanism chose is extreme
/// in the centre, as one of the handle of a door may be, another one takes its place if it can.
pub(super) fn problem_of_joints(mechanism: &Mechanism, options: MapOptions) -> Result<Problem> {
    let is_regular = |problem: &Problem| {
        let distance = |jacobian: &Matrix| {
            problem.type_one.distance(&Svd::of(&problem.type_one.block(jacobian)))
        };
        problem.jacobians().first().is_none_or(|start| distance(start) >= PLATFORM_SINGULAR)
    };
    let positions = |problem: &Problem| -> Vec<&'static str> {
        let is_held = |place: &usize| problem.held.iter().any(|(i, _)| i == place);
        let held = problem.components.iter().filter(|(_, place)| is_held(place));
        held.map(|(name, _)| *name).filter(|name| ["x", "y", "z"].contains(name)).collect()
    };
    let first = Problem::new(mechanism, &options)?;
    if is_regular(&first) {
        return Ok(first);
    }
    let chosen = positions(&first);
    for name in &chosen {
        if options.held.iter().any(|(named, _)| named == name) {
            continue;
        }
        let mut others = options.clone();
        others.held.push(((*name).to_owned(), None));
        let other = Problem::new(mechanism, &others)?;
        if positions(&other).len() == chosen.len() && is_regular(&other) {
            return Ok(other);
        }
    }
    Ok(first)
}
