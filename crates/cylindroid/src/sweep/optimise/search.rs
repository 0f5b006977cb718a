//! The search: sampled designs, refinements of some of them, and what nothing dominates.
//!
//! Method   all samples; for one objective, the best of them are refined. For several, the best sample
//!          of each objective is refined for this objective (and a millionth of the others), then samples spread along the front of
//!          the samples (and fronts of what it leaves, where it is short) are, by the ratio of pareto.rs. The result is the front of all of them
//! Valid    any objectives. Optima are those found: nothing proves that there are no better ones; that
//!          refinements from several samples end in one design is evidence
//! Why so   samples make the search global and show where designs exist; a refinement is a function of
//!          its sample alone, so that neither threads nor other refinements change a digit. Parameters
//!          and objectives are taken by name, so that neither does the order of the options
//! Checked  tests/sweep/optimise.rs

use std::cell::RefCell;
use std::num::NonZeroUsize;

use super::super::Progress;
use super::super::workers::{Counted, Workers};
use super::indices::{Indices, Refusal};
use super::options::{DesignObjective, OptimisationOptions, Sense};
use super::pareto::{Extent, distinct, front, layers, spread};
use super::result::{OptimalDesign, Optimum, Refinement};
use super::simplex::minimise;
use crate::closure::ParametricModel;
use crate::error::{Error, Result};
use crate::kinematics::EndEffector;

/// A search for optimal designs, checked.
#[derive(Debug, Clone)]
pub struct Optimisation {
    indices: Indices,
    options: OptimisationOptions,
    /// The parameters of the options with their units.
    parameters: Vec<(String, String)>,
}

/// Designs that were evaluated.
#[derive(Debug, Clone, Default)]
struct Tally {
    evaluated: u64,
    invalid: u64,
    without_index: u64,
    reason: Option<String>,
}

/// A design with its costs.
#[derive(Debug, Clone)]
struct Found {
    x: Vec<f64>,
    costs: Vec<f64>,
}

/// A refinement: where it starts, and the objective, or the ratio if there is none.
struct Start<'a> {
    from: &'a Found,
    objective: Option<usize>,
}

impl Tally {
    fn add(&mut self, refusal: Option<Refusal>) {
        self.evaluated += 1;
        let reason = match refusal {
            None => return,
            Some(Refusal::Invalid(reason)) => {
                self.invalid += 1;
                reason
            }
            Some(Refusal::WithoutIndex(reason)) => {
                self.without_index += 1;
                reason
            }
        };
        self.reason.get_or_insert(reason);
    }

    fn merge(&mut self, other: Self) {
        self.evaluated += other.evaluated;
        self.invalid += other.invalid;
        self.without_index += other.without_index;
        self.reason = self.reason.take().or(other.reason);
    }
}

impl Optimisation {
    /// Checks all options.
    ///
    /// # Errors
    /// Those of [`Sweep::of_designs`](super::super::Sweep::of_designs); no objective, one named twice,
    /// an index that is no column of numbers, a range whose ends are exchanged, a parameter that both
    /// varies and belongs to the workspace, numbers of designs, starts or evaluations out of range.
    pub fn new(model: &ParametricModel, options: OptimisationOptions) -> Result<Self> {
        let indices = Indices::new(model, &options)?;
        let unit = |name: &String| {
            let own = model.parameters().iter().find(|p| p.name == *name);
            (name.clone(), own.map_or_else(String::new, |p| p.unit.clone()))
        };
        let parameters = options.ranges.iter().map(|range| unit(&range.name)).collect();
        Ok(Self { indices, options, parameters })
    }

    /// The indices of a design: values of the parameters, in the order of the options.
    ///
    /// # Errors
    /// Another number of values; [`Error::InvalidOption`] with the reason for a design without a
    /// mechanism or without a finite index.
    pub fn evaluate(&self, values: &[f64]) -> Result<Vec<f64>> {
        Error::check_len("values", self.options.ranges.len(), values.len())?;
        let of = |name: &String| self.options.ranges.iter().position(|r| r.name == *name);
        let order = self.indices.ranges.iter().filter_map(|range| of(&range.name));
        let own: Vec<f64> = order.map(|i| values[i]).collect();
        let costs = self.indices.costs(&own).map_err(|refusal| Error::InvalidOption {
            option: "values",
            value: format!("{values:?}"),
            reason: match refusal {
                Refusal::Invalid(reason) | Refusal::WithoutIndex(reason) => reason,
            },
        })?;
        Ok(self.indices_of(&costs))
    }

    /// The units of the indices, in the order of the objectives; "1" for numbers without one.
    #[must_use]
    pub fn units(&self) -> Vec<&str> {
        let unit = |objective| {
            let own = self.indices.objectives.iter().position(|o| o == objective);
            own.map_or("", |i| self.indices.unit(i))
        };
        self.options.objectives.iter().map(unit).collect()
    }

    /// The frame of poses and Jacobians of the nominal design.
    #[must_use]
    pub const fn end_effector(&self) -> EndEffector {
        self.indices.end_effector
    }

    /// Number of configurations of each design.
    #[must_use]
    pub const fn configurations(&self) -> u64 {
        self.indices.configurations()
    }

    /// Searches. `threads` and `observe` as in [`Sweep::write`](super::super::Sweep::write), with
    /// evaluated designs in place of rows; `None` if `observe` stopped the run. Results do not depend
    /// on the number of threads.
    ///
    /// # Errors
    /// None now; those of a computation.
    pub fn run(
        &self,
        threads: Option<NonZeroUsize>,
        mut observe: impl FnMut(&Progress) -> bool,
    ) -> Result<Option<Optimum>> {
        let mut workers = Workers::new(threads, &mut observe);
        let count = usize::try_from(self.indices.samples()).unwrap_or(usize::MAX);
        workers.begin(Counted { unit: "designs", all: self.designs_at_most(), at_most: true }, 0);
        let sampled = workers.run(count, |(): &mut (), design, watch| {
            let x = self.indices.sample(design as u64);
            let found = self.indices.costs(&self.indices.values(&x));
            watch.count(1);
            Ok((x, found))
        })?;
        let Some(sampled) = sampled else { return Ok(None) };
        let mut tally = Tally::default();
        let mut samples: Vec<Found> = Vec::new();
        for (x, found) in sampled {
            tally.add(found.as_ref().err().cloned());
            if let Ok(costs) = found {
                samples.push(Found { x, costs });
            }
        }
        let width = self.indices.objectives.len();
        let mut refined: Vec<(Found, Refinement)> = Vec::new();
        // First one objective at a time, then along the front.
        let mut single = Vec::new();
        for objective in 0..width {
            let count = if width == 1 { self.options.starts } else { self.options.starts.min(1) };
            let mut order: Vec<&Found> = samples.iter().collect();
            order.sort_by(|a, b| a.costs[objective].total_cmp(&b.costs[objective]));
            let starts = order.into_iter().take(count);
            single.extend(starts.map(|from| Start { from, objective: Some(objective) }));
        }
        let all: Vec<Vec<f64>> = samples.iter().map(|found| found.costs.clone()).collect();
        let extent = Extent::of(&all);
        let Some(ends) = self.refine(&mut workers, &single, &extent, &mut tally)? else {
            return Ok(None);
        };
        refined.extend(ends);
        if width > 1 {
            let near = layers(&all, self.options.starts);
            let own: Vec<Vec<f64>> = near.iter().map(|&i| all[i].clone()).collect();
            let both = own.iter().chain(refined.iter().map(|(end, _)| &end.costs));
            let extent = Extent::of(&both.cloned().collect::<Vec<_>>());
            let chosen = spread(&own, self.options.starts);
            let along: Vec<Start<'_>> = chosen
                .into_iter()
                .map(|i| Start { from: &samples[near[i]], objective: None })
                .collect();
            let Some(ends) = self.refine(&mut workers, &along, &extent, &mut tally)? else {
                return Ok(None);
            };
            refined.extend(ends);
        }
        Ok(Some(self.optimum(samples, refined, tally)))
    }

    /// Designs that are evaluated at most.
    fn designs_at_most(&self) -> u64 {
        let (starts, width) = (self.options.starts, self.indices.objectives.len());
        let refinements = if width > 1 { starts + width * starts.min(1) } else { starts };
        self.indices.samples() + refinements as u64 * self.options.evaluations
    }

    /// The ends of refinements.
    fn refine(
        &self,
        workers: &mut Workers<'_>,
        starts: &[Start<'_>],
        extent: &Extent,
        tally: &mut Tally,
    ) -> Result<Option<Vec<(Found, Refinement)>>> {
        let ends = workers.run(starts.len(), |(): &mut (), part, watch| {
            let Start { from, objective } = &starts[part];
            let cost = |costs: &[f64]| match objective {
                Some(i) if costs.len() == 1 => costs[*i],
                Some(i) => extent.mostly(*i, costs),
                None => extent.ratio(&from.costs, costs),
            };
            let own = RefCell::new(Tally::default());
            let of = |x: &[f64]| {
                if !watch.goes_on() {
                    return f64::INFINITY;
                }
                let found = self.indices.costs(&self.indices.values(x));
                watch.count(1);
                own.borrow_mut().add(found.as_ref().err().cloned());
                found.map_or(f64::INFINITY, |costs| cost(&costs))
            };
            let stop = || !watch.goes_on();
            let begin = (&from.x[..], cost(&from.costs));
            let end = minimise(&of, begin, self.options.evaluations, &stop);
            let values = self.indices.values(&end.x);
            let costs = self.indices.costs(&values).unwrap_or_else(|_| from.costs.clone());
            let refinement = Refinement {
                start: self.ordered(&from.x),
                values: self.ordered(&end.x),
                indices: self.indices_of(&costs),
                evaluated: end.evaluations,
                converged: end.converged,
            };
            Ok((Found { x: end.x, costs }, refinement, own.into_inner()))
        })?;
        let Some(ends) = ends else { return Ok(None) };
        let mut all = Vec::with_capacity(ends.len());
        for (found, refinement, own) in ends {
            tally.merge(own);
            all.push((found, refinement));
        }
        Ok(Some(all))
    }

    fn optimum(
        &self,
        samples: Vec<Found>,
        refined: Vec<(Found, Refinement)>,
        tally: Tally,
    ) -> Optimum {
        // Refined designs first, so that of equal ones they stay.
        let (ends, refinements): (Vec<Found>, Vec<Refinement>) = refined.into_iter().unzip();
        let count = ends.len();
        let all: Vec<Found> = ends.into_iter().chain(samples).collect();
        let costs: Vec<Vec<f64>> = all.iter().map(|found| found.costs.clone()).collect();
        let best = front(&costs);
        let own: Vec<Vec<f64>> = best.iter().map(|&i| costs[i].clone()).collect();
        let mut chosen: Vec<usize> = distinct(&own).into_iter().map(|i| best[i]).collect();
        let first = self.options.objectives.first();
        let first = self.indices.objectives.iter().position(|o| Some(o) == first).unwrap_or(0);
        chosen.sort_by(|&a, &b| costs[a][first].total_cmp(&costs[b][first]));
        let design = |i: usize| OptimalDesign {
            values: self.ordered(&all[i].x),
            indices: self.indices_of(&all[i].costs),
            refined: i < count,
        };
        Optimum {
            parameters: self.parameters.clone(),
            objectives: self.options.objectives.clone(),
            designs: chosen.into_iter().map(design).collect(),
            refinements,
            evaluated: tally.evaluated,
            invalid: tally.invalid,
            without_index: tally.without_index,
            reason: tally.reason,
        }
    }

    /// The values of a place in the unit cube, in the order of the options.
    fn ordered(&self, x: &[f64]) -> Vec<f64> {
        let values = self.indices.values(x);
        let own = &self.indices.ranges;
        let place = |name: &String| own.iter().position(|range| range.name == *name);
        let places = self.options.ranges.iter().filter_map(|range| place(&range.name));
        places.map(|i| values[i]).collect()
    }

    /// The indices of costs, in the order of the options.
    fn indices_of(&self, costs: &[f64]) -> Vec<f64> {
        let own = &self.indices.objectives;
        let of = |objective: &DesignObjective| {
            let cost = own.iter().position(|o| o == objective).map_or(f64::NAN, |i| costs[i]);
            match objective.sense {
                Sense::Minimise => cost,
                Sense::Maximise => -cost,
            }
        };
        self.options.objectives.iter().map(of).collect()
    }
}
