//! The loci of a map: curves on which a mode is singular or a limit is met, over two axes.
//!
//! Method   seeds of type I and of limits: the last configurations of ways that were blocked; of type
//!          II: neighbours whose distances differ in sign. Each seed is refined by Newton's method; a
//!          seed on a known curve is dropped, otherwise its curve is followed to both ends
//! Valid    mechanisms in which nothing is left free. Curves shorter than a cell may be missed. Curves of
//!          type I belong to the modes that meet there; those of type II and of limits end where the
//!          mode ends
//! Why so   contours of a grid have the error of its cells; points on them here have that of rounding.
//!          Curves of one family are compared with one another, those of several are not: threads share
//!          the families
//! Checked  tests/map/five_bar.rs, tests/map/planar_platform.rs, tests/map/threads.rs

use super::super::workers::{Counted, Watch, Workers};
use super::flood::{Blocked, Flooded};
use super::grid::Grid;
use super::problem::Problem;
use super::result::{Locus, LocusKind};
use crate::closure::{Curve, CurveDomain, CurveTracer, Obstruction, SignedSingularity, Vanishing};
use crate::error::Result;
use crate::sweep::Axis;
use crate::tolerance::LOCUS_AT_REST;

/// A family of curves: what vanishes, and where they are looked for.
struct Family<'a> {
    vanishing: Vanishing,
    kind: LocusKind,
    limit: Option<String>,
    /// The distance to singularities whose sign a curve keeps, if it ends with its mode.
    side: Option<(SignedSingularity, f64)>,
    /// Modes and configurations near curves.
    seeds: Vec<(usize, &'a [f64])>,
}

impl Family<'_> {
    /// Its curves; some of them if the observer has stopped the workers.
    fn loci(&self, problem: &Problem, axes: &[Axis], watch: Watch<'_>) -> Result<Vec<Locus>> {
        let mut tracer = CurveTracer::new(
            problem.equations.clone(),
            self.vanishing.clone(),
            CurveDomain {
                bounds: problem.axes.iter().zip(axes).map(|(&i, a)| (i, a.from, a.to)).collect(),
                side: self.side.clone(),
            },
            (problem.unknown.clone(), problem.unknown_rank),
        );
        let mut curves: Vec<(Curve, Vec<usize>)> = Vec::new();
        for &(mode, guess) in &self.seeds {
            if !watch.goes_on() {
                break;
            }
            watch.count(1);
            let Some(seed) = tracer.refine(guess)? else { continue };
            if let Some((_, modes)) = curves.iter_mut().find(|(curve, _)| curve.passes(&seed)) {
                if !modes.contains(&mode) {
                    modes.push(mode);
                }
                continue;
            }
            let curve = tracer.trace(&seed, &|| watch.goes_on())?;
            if curve.points.len() > 1 {
                curves.push((curve, vec![mode]));
            }
        }
        let n = problem.platform.n();
        let mut loci = Vec::with_capacity(curves.len());
        for (curve, modes) in curves {
            let middle = &curve.points[curve.points.len() / 2];
            let motion = tracer.motion(middle)?;
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
        Ok(loci)
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

/// All loci; none if the observer stops the workers.
pub(super) fn loci(
    problem: &Problem,
    grid: &Grid,
    axes: &[Axis],
    modes: &[Flooded],
    workers: &mut Workers<'_>,
) -> Result<Vec<Locus>> {
    let families = families(problem, grid, modes);
    let seeds: u64 = families.iter().map(|family| family.seeds.len() as u64).sum();
    workers.begin(Counted { unit: "seeds", all: seeds, at_most: false }, 0);
    let found = workers.run(families.len(), |(): &mut (), family, watch| {
        families[family].loci(problem, axes, watch)
    })?;
    Ok(found.into_iter().flatten().flatten().collect())
}

/// Those of type I, in which modes meet, then of each mode those of type II and of limits.
fn families<'a>(problem: &Problem, grid: &Grid, modes: &'a [Flooded]) -> Vec<Family<'a>> {
    let mut families = Vec::new();
    if problem.type_one.is_signed() {
        let of_mode = |(number, mode): (usize, &'a Flooded)| {
            let singular = mode.blocked.iter().filter(|b| b.why == Obstruction::Singular);
            singular.map(move |b| (number, &b.q[..]))
        };
        families.push(Family {
            vanishing: Vanishing::Singularity(problem.type_one.clone()),
            kind: LocusKind::TypeOne,
            limit: None,
            side: None,
            seeds: modes.iter().enumerate().flat_map(of_mode).collect(),
        });
    }
    let coordinates = problem.platform.mechanism.coordinates();
    let met = |i: usize, q: f64| {
        let l = &coordinates[i].limits;
        if (q - l.lower).abs() < (q - l.upper).abs() { l.lower } else { l.upper }
    };
    for (number, mode) in modes.iter().enumerate() {
        let sign = mode.type_one.iter().find(|s| s.is_finite()).map_or(1.0, |s| s.signum());
        let side = problem.type_one.is_signed().then(|| (problem.type_one.clone(), sign));
        if problem.type_two.is_signed() {
            let seeds = sign_changes(grid, mode).into_iter();
            families.push(Family {
                vanishing: Vanishing::Singularity(problem.type_two.clone()),
                kind: LocusKind::TypeTwo,
                limit: None,
                side: side.clone(),
                seeds: seeds.filter_map(|cell| Some((number, mode.at(cell)?))).collect(),
            });
        }
        let mut limits: Vec<(usize, f64)> = Vec::new();
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
            let here = |b: &&Blocked| {
                b.why == Obstruction::Limit(coordinate) && met(coordinate, b.q[coordinate]) == value
            };
            let seeds = mode.blocked.iter().filter(here).map(|b| (number, &b.q[..]));
            families.push(Family {
                vanishing: Vanishing::Limit { coordinate, value },
                kind: LocusKind::Limit,
                limit: Some(coordinates[coordinate].name.clone()),
                side: side.clone(),
                seeds: seeds.collect(),
            });
        }
    }
    families
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
