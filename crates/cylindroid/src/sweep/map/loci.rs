//! The loci of a map: curves on which a mode is singular or a limit is met, over two axes.
//!
//! Method   seeds of type I and of limits: the last configurations of ways that were blocked; of type
//!          II: neighbours whose distances differ in sign. Each seed is refined by Newton's method; a
//!          seed on a known curve is dropped, otherwise its curve is followed to both ends
//! Valid    mechanisms in which nothing is left free. Curves shorter than a cell may be missed. Curves of
//!          type I belong to the modes that meet there; those of type II and of limits end where the
//!          mode ends
//! Why so   contours of a grid have the error of its cells; points on them here have that of rounding
//! Checked  tests/map/five_bar.rs, tests/map/planar_platform.rs

use super::flood::Flooded;
use super::grid::Grid;
use super::problem::Problem;
use super::result::{Locus, LocusKind};
use crate::closure::{Curve, CurveDomain, CurveTracer, Obstruction, Vanishing};
use crate::error::Result;
use crate::sweep::Axis;
use crate::tolerance::LOCUS_AT_REST;

/// A family of curves: what vanishes, and the mode if they end with it.
struct Family {
    tracer: CurveTracer,
    kind: LocusKind,
    limit: Option<String>,
    curves: Vec<Curve>,
    /// Modes of each curve.
    modes: Vec<Vec<usize>>,
}

impl Family {
    fn add(&mut self, mode: usize, guess: &[f64]) -> Result<()> {
        let Some(seed) = self.tracer.refine(guess)? else { return Ok(()) };
        let known = self.curves.iter().position(|curve| curve.passes(&seed));
        if let Some(known) = known {
            if !self.modes[known].contains(&mode) {
                self.modes[known].push(mode);
            }
            return Ok(());
        }
        let curve = self.tracer.trace(&seed)?;
        if curve.points.len() > 1 {
            self.curves.push(curve);
            self.modes.push(vec![mode]);
        }
        Ok(())
    }

    fn finish(mut self, problem: &Problem, loci: &mut Vec<Locus>) -> Result<()> {
        let n = problem.platform.n();
        for (curve, modes) in self.curves.into_iter().zip(self.modes) {
            let middle = &curve.points[curve.points.len() / 2];
            let motion = self.tracer.motion(middle)?;
            let kind = kind_of(problem, self.kind, &motion);
            let on_axes = |q: &Vec<f64>| problem.axes.iter().map(|&i| q[i]).collect();
            loci.push(Locus {
                kind,
                limit: self.limit.clone(),
                modes,
                closed: curve.closed,
                points: curve.points.iter().map(on_axes).collect(),
                q: curve.points.iter().map(|q| q[..n].to_vec()).collect(),
            });
        }
        Ok(())
    }
}

/// What happens at a singularity of type I or II with this motion: only passive joints may move.
pub(super) fn kind_of(problem: &Problem, kind: LocusKind, motion: &[f64]) -> LocusKind {
    let n = problem.platform.n();
    let coordinates = problem.platform.mechanism.coordinates();
    let moves = |i: usize| motion[i].abs() > LOCUS_AT_REST;
    match kind {
        LocusKind::TypeOne if !(0..n).any(|i| coordinates[i].actuated && moves(i)) => {
            LocusKind::Passive
        }
        LocusKind::TypeTwo if !(n..motion.len()).any(moves) => LocusKind::Passive,
        kind => kind,
    }
}

/// All loci.
pub(super) fn loci(
    problem: &Problem,
    grid: &Grid,
    axes: &[Axis],
    modes: &[Flooded],
) -> Result<Vec<Locus>> {
    let mut loci = Vec::new();
    let family = |vanishing, kind, limit| Family {
        tracer: CurveTracer::new(
            problem.equations.clone(),
            vanishing,
            CurveDomain {
                bounds: problem.axes.iter().zip(axes).map(|(&i, a)| (i, a.from, a.to)).collect(),
                side: None,
            },
            (problem.unknown.clone(), problem.unknown_rank),
        ),
        kind,
        limit,
        curves: Vec::new(),
        modes: Vec::new(),
    };
    if problem.type_one.is_signed() {
        let vanishing = Vanishing::Singularity(problem.type_one.clone());
        let mut curves = family(vanishing, LocusKind::TypeOne, None);
        for (number, mode) in modes.iter().enumerate() {
            for blocked in mode.blocked.iter().filter(|b| b.why == Obstruction::Singular) {
                curves.add(number, &blocked.q)?;
            }
        }
        curves.finish(problem, &mut loci)?;
    }
    for (number, mode) in modes.iter().enumerate() {
        let sign = mode.type_one.iter().find(|s| s.is_finite()).map_or(1.0, |s| s.signum());
        let side = problem.type_one.is_signed().then(|| (problem.type_one.clone(), sign));
        if problem.type_two.is_signed() {
            let vanishing = Vanishing::Singularity(problem.type_two.clone());
            let mut curves = family(vanishing, LocusKind::TypeTwo, None);
            curves.tracer.set_side(side.clone());
            for seed in sign_changes(grid, mode) {
                let Some(q) = mode.at(seed) else { continue };
                curves.add(number, q)?;
            }
            curves.finish(problem, &mut loci)?;
        }
        let mut limits: Vec<(usize, f64)> = Vec::new();
        let coordinates = problem.platform.mechanism.coordinates();
        let met = |i: usize, q: f64| {
            let l = &coordinates[i].limits;
            if (q - l.lower).abs() < (q - l.upper).abs() { l.lower } else { l.upper }
        };
        for blocked in &mode.blocked {
            if let Obstruction::Limit(i) = blocked.why {
                let limit = (i, met(i, blocked.q[i]));
                if !limits.contains(&limit) {
                    limits.push(limit);
                }
            }
        }
        limits.sort_by(|a, b| a.0.cmp(&b.0).then(a.1.total_cmp(&b.1)));
        for (coordinate, value) in limits {
            let name = coordinates[coordinate].name.clone();
            let vanishing = Vanishing::Limit { coordinate, value };
            let mut curves = family(vanishing, LocusKind::Limit, Some(name));
            curves.tracer.set_side(side.clone());
            let here = |q: &[f64], why| {
                why == Obstruction::Limit(coordinate) && met(coordinate, q[coordinate]) == value
            };
            for blocked in mode.blocked.iter().filter(|b| here(&b.q, b.why)) {
                curves.add(number, &blocked.q)?;
            }
            curves.finish(problem, &mut loci)?;
        }
    }
    Ok(loci)
}

/// Of neighbours in which the distance to type II differs in sign the cell nearer to zero.
fn sign_changes(grid: &Grid, mode: &Flooded) -> Vec<usize> {
    let mut all = Vec::new();
    for cell in (0..grid.cells()).filter(|&cell| mode.reached[cell]) {
        for next in grid.neighbours(cell).into_iter().filter(|&next| next > cell) {
            let (a, b) = (mode.type_two[cell], mode.type_two[next]);
            if mode.reached[next] && a * b < 0.0 {
                all.push(if a.abs() < b.abs() { cell } else { next });
            }
        }
    }
    all
}
