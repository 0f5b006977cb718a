//! The options of an optimisation: which parameters, which indices, how long.
//!
//! Checked  tests/sweep/optimise.rs::wrong_options_are_refused

use super::super::axis::Axis;
use super::super::designs::ParameterRange;
use super::super::options::SweepOptions;
use super::super::source::Source;
use crate::error::{Error, Result};

/// What [`Optimisation`](super::Optimisation) does; [`Optimisation::new`](super::Optimisation::new)
/// checks all of it.
#[derive(Debug, Clone)]
pub struct OptimisationOptions {
    /// The parameters that vary, each within its range, both ends included.
    pub ranges: Vec<ParameterRange>,
    /// The indices; several of them give a Pareto front.
    pub objectives: Vec<DesignObjective>,
    /// Other parameters whose grid belongs to the workspace: each design is evaluated at each of its
    /// points, and a design without a mechanism at one of them is none. For closed chains whose file
    /// has the pose of the platform as parameters.
    pub workspace: Vec<Axis>,
    /// Number of sampled designs, points of a scrambled Sobol' sequence.
    pub designs: u64,
    /// How many of them are refined: the best, for several objectives some along the front.
    pub starts: usize,
    /// Designs that a refinement evaluates at most.
    pub evaluations: u64,
    /// Selects one of the sequences of designs.
    pub seed: u64,
    /// The configurations of each design, frame, task, metric and length; the quantities follow from
    /// the objectives.
    pub sweep: SweepOptions,
}

impl Default for OptimisationOptions {
    fn default() -> Self {
        Self {
            ranges: Vec::new(),
            objectives: Vec::new(),
            workspace: Vec::new(),
            designs: 64,
            starts: 4,
            evaluations: 2000,
            seed: 0,
            sweep: SweepOptions { source: Source::Home, ..SweepOptions::default() },
        }
    }
}

/// An index of a design: a column of a sweep over its configurations.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
pub struct DesignObjective {
    /// A column of numbers of one of the quantities, such as `condition`, `yoshikawa`, `anisotropy`
    /// or `type_ii`.
    pub index: String,
    /// The number of a design.
    pub statistic: Statistic,
    /// Whether smaller or larger is better.
    pub sense: Sense,
}

/// The number that a design has of all its configurations.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Statistic {
    /// The smallest.
    Smallest,
    /// The mean.
    Mean,
    /// The largest.
    Largest,
}

/// Whether smaller or larger is better.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Sense {
    /// Smaller is better.
    Minimise,
    /// Larger is better.
    Maximise,
}

impl Statistic {
    /// All of them.
    pub const ALL: [Self; 3] = [Self::Smallest, Self::Mean, Self::Largest];

    /// Its name: "smallest", "mean" or "largest".
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Smallest => "smallest",
            Self::Mean => "mean",
            Self::Largest => "largest",
        }
    }
}

impl Sense {
    /// Its name: "minimise" or "maximise".
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Minimise => "minimise",
            Self::Maximise => "maximise",
        }
    }
}

impl DesignObjective {
    /// `INDEX` or `INDEX:STATISTIC`, by default of the worst configuration: the largest of an index
    /// that is minimised, the smallest of one that is maximised.
    ///
    /// # Errors
    /// [`Error::UnknownName`] for another statistic.
    pub fn named(text: &str, sense: Sense) -> Result<Self> {
        let worst = match sense {
            Sense::Minimise => Statistic::Largest,
            Sense::Maximise => Statistic::Smallest,
        };
        let (index, statistic) = match text.split_once(':') {
            None => (text, worst),
            Some((index, name)) => {
                let found = Statistic::ALL.into_iter().find(|s| s.name() == name);
                let names = Statistic::ALL.map(Statistic::name);
                (index, found.ok_or_else(|| Error::unknown("statistic", name, names))?)
            }
        };
        Ok(Self { index: index.to_owned(), statistic, sense })
    }

    /// The index with its statistic: "condition:largest".
    #[must_use]
    pub fn name(&self) -> String {
        format!("{}:{}", self.index, self.statistic.name())
    }
}

impl OptimisationOptions {
    /// Returns an error for numbers that are out of range, and for objectives named twice.
    pub(super) fn check(&self) -> Result<()> {
        let refuse = |option: &'static str, value: String, reason: &str| {
            Err(Error::InvalidOption { option, value, reason: reason.to_owned() })
        };
        if self.objectives.is_empty() {
            return refuse("minimise", String::new(), "name one index at least");
        }
        for (i, objective) in self.objectives.iter().enumerate() {
            if self.objectives[..i].contains(objective) {
                return refuse(objective.sense.name(), objective.name(), "it is named twice");
            }
        }
        if self.designs == 0 || self.designs > MOST_DESIGNS {
            return refuse("designs", self.designs.to_string(), "1 to 2^24 are possible");
        }
        if self.starts > MOST_STARTS {
            return refuse("starts", self.starts.to_string(), "at most 4096 are possible");
        }
        if self.evaluations > MOST_EVALUATIONS {
            return refuse("evaluations", self.evaluations.to_string(), "at most 1e9 are possible");
        }
        for axis in &self.workspace {
            if self.ranges.iter().any(|range| range.name == axis.name) {
                let reason = "a parameter varies or belongs to the workspace, not both";
                return refuse("over", axis.name.clone(), reason);
            }
        }
        Ok(())
    }
}

/// Sampled designs, refinements and evaluations of each at most.
const MOST_DESIGNS: u64 = 1 << 24;
const MOST_STARTS: usize = 4096;
const MOST_EVALUATIONS: u64 = 1_000_000_000;
