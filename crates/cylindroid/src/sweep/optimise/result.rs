//! The result of an optimisation.
//!
//! Checked  tests/sweep/optimise.rs

use super::options::DesignObjective;

/// Optimal designs.
#[derive(Debug, Clone, PartialEq)]
pub struct Optimum {
    /// The parameters that vary, in the order of the options, with their units.
    pub parameters: Vec<(String, String)>,
    /// The objectives, in the order of the options.
    pub objectives: Vec<DesignObjective>,
    /// The best design, or for several objectives the designs that no other one found dominates
    /// (is as good in all objectives and better in one), by their first objective, best first. Empty if
    /// no design has the indices.
    pub designs: Vec<OptimalDesign>,
    /// The refinements: of the best samples, first the best; for several objectives of the best sample
    /// of each objective for this objective, then of some samples along the front.
    pub refinements: Vec<Refinement>,
    /// Number of designs that were evaluated.
    pub evaluated: u64,
    /// Those of them without a mechanism: a value out of its range, loops that do not close.
    pub invalid: u64,
    /// Those with a mechanism, but without a finite index.
    pub without_index: u64,
    /// The reason of the first of these among the samples, otherwise among the refinements.
    pub reason: Option<String>,
}

/// A design that no other one found dominates.
#[derive(Debug, Clone, PartialEq)]
pub struct OptimalDesign {
    /// The parameters, in the units of the file.
    pub values: Vec<f64>,
    /// The indices, in the order of the objectives and the units of the columns.
    pub indices: Vec<f64>,
    /// False for a sampled design.
    pub refined: bool,
}

/// A refinement.
#[derive(Debug, Clone, PartialEq)]
pub struct Refinement {
    /// The parameters of the sample at which it starts.
    pub start: Vec<f64>,
    /// Its end: parameters.
    pub values: Vec<f64>,
    /// Indices there.
    pub indices: Vec<f64>,
    /// Designs that it evaluated.
    pub evaluated: u64,
    /// True if new simplices no longer improved it; false if the evaluations were spent.
    pub converged: bool,
}
