//! The equations of a map: which components of the platform are axes, held or free, and what is
//! singular where.
//!
//! Formula  type I: the loops lose rank over all coordinates but axes and held components; type II:
//!          over passive joints and platform, with the drives held
//! Valid    any mechanism. Components that nobody names are held if the mechanism can choose them: if
//!          the loops keep their generic rank without the column of the component
//! Checked  tests/map/five_bar.rs, tests/map/options.rs

use super::options::MapOptions;
use crate::closure::{
    LoopEquations, Platform, PlatformChain, PlatformRotation, SignedSingularity, assemble,
    perturbed, rate_rank,
};
use crate::error::{Error, Result};
use crate::linalg::{Matrix, Svd};
use crate::model::Mechanism;
use crate::spatial::Pose;
use crate::tolerance::{CLOSURE_RANK, LOCUS_MET};

/// Configurations near the start at which ranks are taken, and their distance [rad, or
/// characteristic lengths].
const NEIGHBOURS: u64 = 4;
const NEIGHBOUR_DISTANCE: f64 = 0.05;

/// A map's mechanism with its coordinates sorted.
#[derive(Debug, Clone)]
pub(super) struct Problem {
    pub(super) platform: Platform,
    /// Components and their coordinates.
    pub(super) components: Vec<(&'static str, usize)>,
    /// The start, assembled, with platform coordinates.
    pub(super) start: Vec<f64>,
    /// Coordinates of the axes.
    pub(super) axes: Vec<usize>,
    /// Held coordinates and their values.
    pub(super) held: Vec<(usize, f64)>,
    /// All coordinates but those held.
    pub(super) unknown: Vec<usize>,
    /// Generic rank of the loops over them.
    pub(super) unknown_rank: usize,
    pub(super) type_one: SignedSingularity,
    pub(super) type_two: SignedSingularity,
    pub(super) equations: LoopEquations,
    /// At the start and nearby.
    jacobians: Vec<Matrix>,
}

impl Problem {
    pub(super) fn new(mechanism: &Mechanism, options: &MapOptions) -> Result<Self> {
        let default = if mechanism.is_closed() { mechanism.reference() } else { mechanism.tool() };
        let end_effector = options.end_effector.unwrap_or(default.into());
        let given = options.start.clone().unwrap_or_else(|| mechanism.home().to_vec());
        mechanism.check_q("start", &given)?;
        let q = if mechanism.is_closed() { assemble(mechanism, &given, &[])?.q } else { given };
        let chain = |rotation| PlatformChain {
            world_from_zero: Pose::IDENTITY,
            slides: [true; 3],
            rotation,
        };
        let by_angles = Platform::of(mechanism, end_effector, chain(PlatformRotation::Angles))?;
        let names = by_angles.components();
        let [axes, fixed, free] = sorted(&names, options)?;
        let n = by_angles.n();
        let mut start = by_angles.extended(&q)?;
        for (k, value) in &fixed {
            start[n + k] = value.unwrap_or(start[n + k]);
        }
        let mut held: Vec<usize> = fixed.iter().map(|(k, _)| *k).collect();
        let axes: Vec<usize> = axes.into_iter().map(|(k, _)| k).collect();
        // Components that the mechanism can choose keep their values.
        let jacobians = samples(&by_angles.mechanism, &by_angles.extended(&q)?)?;
        let rank_without = |gone: &[usize]| {
            let kept: Vec<usize> =
                (0..start.len()).filter(|i| !gone.contains(&i.wrapping_sub(n))).collect();
            (rank(&jacobians, &kept), kept.len())
        };
        for k in 0..names.len() {
            if axes.contains(&k) || held.contains(&k) || free.iter().any(|(f, _)| *f == k) {
                continue;
            }
            let gone: Vec<usize> = axes.iter().chain(&held).copied().collect();
            let more: Vec<usize> = gone.iter().copied().chain([k]).collect();
            let ((rank, count), (rank_then, _)) = (rank_without(&gone), rank_without(&more));
            if count > rank && rank_then == rank {
                held.push(k);
            }
        }
        // Without angles among them, a rotation vector has no singular pitch.
        let rotates = axes.iter().chain(&held).any(|&k| k >= 3);
        let platform = if rotates || names.len() < 6 {
            by_angles
        } else {
            Platform::of(mechanism, end_effector, chain(PlatformRotation::Free))?
        };
        // Rounding of the start is no value.
        let clean = |x: f64| if x.abs() < LOCUS_MET { 0.0 } else { x };
        let values: Vec<f64> = held.iter().map(|k| clean(start[n + k])).collect();
        let start = platform.extended(&q)?;
        let jacobians = samples(&platform.mechanism, &start)?;
        let prescribed: Vec<usize> = axes.iter().chain(&held).map(|k| n + k).collect();
        let held: Vec<(usize, f64)> = held.iter().map(|k| n + k).zip(values).collect();
        let of = |keep: &dyn Fn(usize) -> bool| (0..start.len()).filter(|&i| keep(i)).collect();
        let unknown: Vec<usize> = of(&|i| !held.iter().any(|(h, _)| *h == i));
        let equations = LoopEquations::of(&platform.mechanism)?;
        let loops = equations.loop_rows();
        let all = equations.jacobian.rows();
        let coordinates = platform.mechanism.coordinates();
        let passive = of(&|i| !coordinates[i].actuated);
        let components = platform.components().into_iter().zip(n..).collect();
        Ok(Self {
            components,
            axes: axes.iter().map(|k| n + k).collect(),
            type_one: SignedSingularity::new(
                0..loops,
                of(&|i| !prescribed.contains(&i)),
                &jacobians,
            ),
            type_two: SignedSingularity::new(0..all, passive, &jacobians),
            unknown_rank: loop_rank(&jacobians, loops, &unknown),
            held,
            unknown,
            start,
            platform,
            equations,
            jacobians,
        })
    }

    /// All prescribed coordinates: axes, then held ones.
    pub(super) fn prescribed(&self) -> Vec<usize> {
        self.axes.iter().copied().chain(self.held.iter().map(|(i, _)| *i)).collect()
    }

    /// Jacobians at the start and nearby, where loops close.
    pub(super) fn jacobians(&self) -> &[Matrix] {
        &self.jacobians
    }

    /// Generic rank of the loops over some coordinates.
    pub(super) fn loop_rank(&self, unknown: &[usize]) -> usize {
        loop_rank(&self.jacobians, self.equations.loop_rows(), unknown)
    }

    /// Motions that the prescribed components leave.
    pub(super) fn free_motions(&self) -> usize {
        self.type_one.columns.len() - self.type_one.rank
    }
}

/// A component by its place, with its value if it has one.
type Component = (usize, Option<f64>);

/// The axes, the components held by name, and those free by name.
fn sorted(names: &[&'static str], options: &MapOptions) -> Result<[Vec<Component>; 3]> {
    let place = |name: &String| {
        let place = names.iter().position(|known| known == name);
        place.ok_or_else(|| Error::unknown("component of the platform", name, names))
    };
    let mut seen = Vec::new();
    let mut once = |name: &String, option: &'static str| -> Result<usize> {
        let k = place(name)?;
        if seen.contains(&k) {
            let reason = "a component is an axis, held or free once".to_owned();
            return Err(Error::InvalidOption { option, value: name.clone(), reason });
        }
        seen.push(k);
        Ok(k)
    };
    let [mut axes, mut held, mut free] = [const { Vec::new() }; 3];
    for axis in &options.axes {
        axes.push((once(&axis.name, "over")?, None));
    }
    for (name, value) in &options.held {
        let k = once(name, if value.is_some() { "at" } else { "free" })?;
        if let Some(value) = value {
            Error::check_within(name, &[*value], crate::tolerance::MAX_MAGNITUDE)?;
            held.push((k, Some(*value)));
        } else {
            free.push((k, None));
        }
    }
    Ok([axes, held, free])
}

/// Jacobians at the start and nearby, where loops close.
fn samples(mechanism: &Mechanism, start: &[f64]) -> Result<Vec<Matrix>> {
    let mut equations = LoopEquations::of(mechanism)?;
    equations.set(start)?;
    let mut all = vec![equations.jacobian.clone()];
    for number in 0..NEIGHBOURS {
        let guess = perturbed(mechanism, start, NEIGHBOUR_DISTANCE, number);
        let near = assemble(mechanism, &guess, &[])?;
        if near.closed {
            equations.set(&near.q)?;
            all.push(equations.jacobian.clone());
        }
    }
    Ok(all)
}

fn loop_rank(jacobians: &[Matrix], loops: usize, kept: &[usize]) -> usize {
    let of_loops: Vec<Matrix> = jacobians.iter().map(|j| j.rows_between(0, loops)).collect();
    rank(&of_loops, kept)
}

/// The largest rank of some columns.
fn rank(jacobians: &[Matrix], kept: &[usize]) -> usize {
    let of = |j: &Matrix| {
        let block = Matrix::from_fn(j.rows(), kept.len(), |i, k| j[(i, kept[k])]);
        rate_rank(&Svd::of(&block), CLOSURE_RANK)
    };
    jacobians.iter().map(of).max().unwrap_or(0)
}
